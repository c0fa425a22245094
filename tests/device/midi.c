/* The plugin org.marotte.midi with a pipe, with a pseudo terminal in a device's place, and with
 * ALSA's sequencer, or a double of it (sequencer_double.c) where the kernel has none. By the
 * virtual clock but for the terminal, whose bytes the system carries across when it has time. */
#define _XOPEN_SOURCE 700
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "input_host.h"
#include "virtual_clock.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

static const int64_t ms_ns = 1000000, s_ns = 1000000000;

typedef struct room {
    input_host *host;
    char folder[64], pipe[96];
    int writer;
    mrt_sample last;
} room;

static int set_up(void **state)
{
    room *r = calloc(1, sizeof *r);
    virtual_clock_take(NULL, 1000 * s_ns);
    snprintf(r->folder, sizeof r->folder, "/tmp/marotte_midi_XXXXXX");
    assert_non_null(mkdtemp(r->folder));
    snprintf(r->pipe, sizeof r->pipe, "%s/pipe", r->folder);
    assert_int_equal(mkfifo(r->pipe, 0600), 0);
    r->writer = open(r->pipe, O_RDWR | O_NONBLOCK);
    r->host = input_host_create(BUILD_DIR "/plugins/midi.so");
    snprintf(r->host->settings, sizeof r->host->settings, "%s", r->folder);
    *state = r;
    return 0;
}

static int tear_down(void **state)
{
    room *r = *state;
    input_host_destroy(r->host);
    close(r->writer);
    unlink(r->pipe);
    rmdir(r->folder);
    free(r);
    virtual_clock_give_back();
    return 0;
}

static void send_bytes(int to, const uint8_t *bytes, size_t size)
{
    assert_int_equal(write(to, bytes, size), size);
}

#define SEND(to, ...)                                                                              \
    do {                                                                                           \
        const uint8_t bytes_[] = {__VA_ARGS__};                                                    \
        send_bytes(to, bytes_, sizeof bytes_);                                                     \
    } while (0)

static float value_of(room *r, const char *name)
{
    int channel = input_host_channel(r->host, name);
    if (channel < 0)
        fail_msg("there is no channel %s", name);
    return r->last.value[channel];
}

static mrt_result read_one(room *r, int64_t within_ns)
{
    return input_host_read(r->host, within_ns, &r->last);
}

static void restart(room *r, const char *address)
{
    r->host->input->close(r->host->plugin);
    assert_int_equal(input_host_open(r->host, address), MRT_OK);
}

/* ---- a pipe ---- */

static void faders_through_a_pipe_are_channels(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    assert_int_equal(read_one(r, 10 * ms_ns), MRT_TIMEOUT); /* nobody has moved anything */
    int64_t before_ns = input_host_now_ns(&r->host->host);
    SEND(r->writer, 0xb0, 7, 127, 0xe2, 0, 64, 1, 64);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "cc.7"), 1, 0);
    assert_float_equal(value_of(r, "cc.8"), 0, 0);
    assert_true(r->last.time_ns >= before_ns &&
                r->last.time_ns <= input_host_now_ns(&r->host->host));
    assert_int_equal(r->last.sequence, 0);
    /* the second bend came in the same bunch: a sample of its own */
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "bend.3"), 2 * 8193 / 16383.0f - 1, 1e-6f);
    assert_int_equal(r->last.sequence, 1);
    /* the writer goes, another one comes: the pipe goes on */
    close(r->writer);
    assert_int_equal(read_one(r, 10 * ms_ns), MRT_TIMEOUT);
    r->writer = open(r->pipe, O_RDWR | O_NONBLOCK);
    SEND(r->writer, 0xb0, 7, 0);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "cc.7"), 0, 0);
}

static void what_does_not_change_is_said_again(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    SEND(r->writer, 0xb0, 7, 127);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    int64_t first_ns = r->last.time_ns;
    assert_int_equal(read_one(r, 2 * s_ns), MRT_OK);
    assert_true(r->last.time_ns - first_ns >= s_ns);
    assert_float_equal(value_of(r, "cc.7"), 1, 0);
}

static void pass_a_millisecond(void)
{
    const struct timespec span = {.tv_nsec = 1000000};
    nanosleep(&span, NULL);
}

static void a_thousand_moves_a_second_are_a_thousand_samples(void **state)
{
    room *r = *state;
    enum { MOVES = 3000 };
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (uint32_t i = 0; i < MOVES; ++i) {
        int64_t moved_ns = input_host_now_ns(&r->host->host);
        SEND(r->writer, 0xe0, i & 127, (uint8_t)(i >> 7 & 127));
        assert_int_equal(read_one(r, ms_ns / 2), MRT_OK);
        assert_int_equal(r->last.sequence, i);
        /* each value, in order, at its own time */
        assert_float_equal(value_of(r, "bend.1"), 2.0f * (float)i / 16383.0f - 1, 1e-6f);
        assert_true(r->last.time_ns >= moved_ns && r->last.time_ns <= moved_ns + ms_ns);
        pass_a_millisecond();
    }
    assert_int_equal(read_one(r, 20 * ms_ns), MRT_TIMEOUT);
}

/* As much as the pipe takes each millisecond, for four seconds: nothing grows, no read outlasts its
 * deadline, and the last word counts. */
static void a_flood_of_noise_is_thinned_out(void **state)
{
    room *r = *state;
    enum { CHUNKS = 4000 };
    uint8_t bytes[4096];
    uint32_t seed = 7, count = 0, late = 0;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    int64_t begin_ns = input_host_now_ns(&r->host->host);
    for (int chunk = 0; chunk < CHUNKS; ++chunk) {
        for (size_t k = 0; k < sizeof bytes; ++k) {
            seed = seed * 1664525 + 1013904223;
            bytes[k] = (uint8_t)(seed >> 24);
        }
        (void)!write(r->writer, bytes, sizeof bytes);
        mrt_result result;
        while ((result = read_one(r, 0)) == MRT_OK) {
            for (uint32_t i = 0; i < r->last.count; ++i)
                assert_true(isfinite(r->last.value[i]));
            count += 1;
            late += input_host_now_ns(NULL) - r->last.time_ns > 500 * ms_ns;
        }
        assert_int_equal(result, MRT_TIMEOUT);
        pass_a_millisecond();
    }
    double took_s = (double)(input_host_now_ns(NULL) - begin_ns) / 1e9;
    printf("%u samples in %.1f s\n", count, took_s);
    assert_true(count < 1500 + 2200 * took_s);
    assert_int_equal(late, 0);
    while (read_one(r, 10 * ms_ns) == MRT_OK)
        ;
    SEND(r->writer, 0xf7, 0xb0, 7, 100, 0xb0, 7, 127);
    while (read_one(r, 100 * ms_ns) == MRT_OK)
        ;
    assert_float_equal(value_of(r, "cc.7"), 1, 0);
}

/* ---- what a device has ---- */

static void a_new_control_becomes_a_channel(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    assert_int_equal(input_host_channel(r->host, "cc.81"), -1);
    SEND(r->writer, 0xb0, 81, 64, 0x91, 36, 100);
    int64_t until_ns = input_host_now_ns(NULL) + 2 * s_ns;
    while (r->host->restart_count == 0 && input_host_now_ns(NULL) < until_ns)
        (void)read_one(r, 50 * ms_ns);
    assert_int_equal(r->host->restart_count, 1); /* both in one go */
    SEND(r->writer, 0xb0, 81, 127);              /* nothing is missed meanwhile */
    restart(r, r->pipe);
    while (read_one(r, 50 * ms_ns) == MRT_OK)
        ;
    assert_float_equal(value_of(r, "cc.81"), 1, 0);
    assert_float_equal(value_of(r, "ch2.note.36"), 100 / 127.0f, 1e-6f);
    /* forgotten when the person says so */
    input_host_set(r->host, "forget", 1);
    (void)read_one(r, 0);
    input_host_set(r->host, "forget", 0);
    restart(r, r->pipe);
    assert_int_equal(input_host_channel(r->host, "cc.81"), -1);
}

static void channels_are_told_anew_only_so_often(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (uint8_t i = 0; i < 8; ++i) {
        SEND(r->writer, 0xb0, 80 + i, 64);
        int before = r->host->restart_count;
        int64_t until_ns = input_host_now_ns(NULL) + 500 * ms_ns;
        while (r->host->restart_count == before && input_host_now_ns(NULL) < until_ns)
            (void)read_one(r, 20 * ms_ns);
        if (r->host->restart_count > before)
            restart(r, r->pipe);
    }
    assert_int_equal(r->host->restart_count, 5); /* a host bears 8 tables of one input */
    assert_non_null(strstr(r->host->last_text, "opened again"));
}

static void a_device_that_falls_silent_lets_its_notes_go(void **state)
{
    room *r = *state;
    input_host_set(r->host, "pedals", 1);
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    SEND(r->writer, 0xb0, 64, 127, 0xfe);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "cc.64"), 1, 0);
    int64_t began_ns = r->last.time_ns;
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "cc.64"), 0, 0);
    assert_true(r->last.time_ns - began_ns > 300 * ms_ns);
    assert_int_equal(r->host->said[MRT_LOG_WARNING], 1);
}

/* ---- a device: a pseudo terminal, which has two ends too ---- */

typedef struct line {
    int device; /* our end */
    char path[64];
} line;

static line open_line(void)
{
    virtual_clock_give_back();
    line of = {.device = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)};
    assert_true(of.device >= 0 && grantpt(of.device) == 0 && unlockpt(of.device) == 0);
    snprintf(of.path, sizeof of.path, "%s", ptsname(of.device));
    return of;
}

/* Reads the input until its motors have said so much, or more. */
static size_t read_motors(room *r, const line *of, uint8_t *out, size_t capacity, size_t wanted)
{
    int64_t end_ns = input_host_now_ns(NULL) + 60 * s_ns;
    size_t size = 0;
    while (size < wanted && input_host_now_ns(NULL) < end_ns) {
        (void)read_one(r, 20 * ms_ns);
        ssize_t more = read(of->device, out + size, capacity - size);
        size += more > 0 ? (size_t)more : 0;
    }
    return size;
}

static void motor_faders_get_their_value_back(void **state)
{
    room *r = *state;
    line of = open_line();
    uint8_t back[256];
    input_host_set(r->host, "motor", 1);
    assert_int_equal(input_host_open(r->host, of.path), MRT_OK);
    /* 0x03 and 0x0d would end a terminal's line or program */
    SEND(of.device, 0xe0, 0x03, 0x0d, 0xb0, 7, 0x03, 0x90, 60, 1);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "cc.7"), 3 / 127.0f, 1e-6f);
    const uint8_t expected[] = {0xe0, 0x03, 0x0d, 0xb0, 7, 0x03}; /* a note has no motor */
    size_t size = read_motors(r, &of, back, sizeof back, sizeof expected);
    assert_int_equal(size, sizeof expected);
    assert_memory_equal(back, expected, sizeof expected);
    /* what comes back from another program's motor is not sent round and round */
    send_bytes(of.device, expected, sizeof expected);
    (void)read_one(r, 100 * ms_ns);
    (void)read_one(r, 100 * ms_ns);
    assert_int_equal(read(of.device, back, sizeof back), -1);
    /* of many moves the newest goes back */
    for (int i = 0; i < 100; ++i)
        SEND(of.device, 0xb0, 8, (uint8_t)i);
    const uint8_t newest[] = {0xb0, 8, 99};
    for (size = 0; size < 3 || memcmp(back + size - 3, newest, 3) != 0;) {
        size_t more = read_motors(r, &of, back + size, sizeof back - size, 3);
        assert_true(more > 0);
        size += more;
    }
    assert_true(size < 150);
    close(of.device);
}

static void a_device_that_goes_is_lost_and_found_again(void **state)
{
    room *r = *state;
    line of = open_line();
    char link[128];
    input_host_set(r->host, "pedals", 1);
    snprintf(link, sizeof link, "%s/device", r->folder);
    assert_int_equal(symlink(of.path, link), 0);
    assert_int_equal(input_host_open(r->host, link), MRT_OK);
    SEND(of.device, 0xb0, 7, 127, 64, 127);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    close(of.device);
    assert_int_equal(read_one(r, s_ns), MRT_OK); /* pedals go up first */
    assert_float_equal(value_of(r, "cc.64"), 0, 0);
    assert_float_equal(value_of(r, "cc.7"), 1, 0);
    assert_int_equal(read_one(r, s_ns), MRT_ERR_IO);
    assert_int_equal(read_one(r, s_ns), MRT_ERR_IO);
    assert_int_equal(r->host->said[MRT_LOG_ERROR], 1);
    r->host->input->close(r->host->plugin);
    unlink(link);
    assert_int_equal(input_host_open(r->host, link), MRT_ERR_IO);
    assert_non_null(strstr(r->host->last_text, "plug it in"));
    of = open_line();
    assert_int_equal(symlink(of.path, link), 0);
    assert_int_equal(input_host_open(r->host, link), MRT_OK);
    uint32_t sequence = r->last.sequence;
    SEND(of.device, 0xb0, 8, 127);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_true(r->last.sequence > sequence);
    assert_float_equal(value_of(r, "cc.7"), 1, 0); /* where it was left */
    unlink(link);
    close(of.device);
}

static void what_is_no_device_is_refused_with_advice(void **state)
{
    room *r = *state;
    char file[128];
    snprintf(file, sizeof file, "%s/file", r->folder);
    int made = open(file, O_CREAT | O_WRONLY, 0600);
    close(made);
    assert_int_equal(input_host_open(r->host, file), MRT_ERR_IO);
    assert_non_null(strstr(r->host->last_text, "mkfifo"));
    unlink(file);
    assert_int_equal(input_host_open(r->host, file), MRT_ERR_IO);
    assert_non_null(strstr(r->host->last_text, "plug it in"));
    assert_int_equal(input_host_open(r->host, r->folder), MRT_ERR_IO);
    setenv("MAROTTE_TEST_NO_SEQUENCER", "1", 1); /* of the double */
    if (access("/dev/snd/seq", F_OK) != 0) {
        assert_int_equal(input_host_open(r->host, "nanoKONTROL2"), MRT_ERR_IO);
        assert_non_null(strstr(r->host->last_text, "no MIDI sequencer"));
    }
    unsetenv("MAROTTE_TEST_NO_SEQUENCER");
    mrt_sample none;
    assert_int_equal(input_host_read(r->host, 0, &none), MRT_ERR_IO);
}

/* ---- the sequencer ---- */

#ifdef MIDI_HAS_ALSA
#include <alsa/asoundlib.h>

static snd_seq_t *make_program(const char *name, int *out_port)
{
    snd_seq_t *seq;
    if (access("/dev/snd/seq", R_OK | W_OK) != 0 ||
        snd_seq_open(&seq, "default", SND_SEQ_OPEN_DUPLEX, SND_SEQ_NONBLOCK) < 0)
        return NULL;
    snd_seq_set_client_name(seq, name);
    *out_port =
        snd_seq_create_simple_port(seq, "out",
                                   SND_SEQ_PORT_CAP_READ | SND_SEQ_PORT_CAP_SUBS_READ |
                                       SND_SEQ_PORT_CAP_WRITE | SND_SEQ_PORT_CAP_SUBS_WRITE,
                                   SND_SEQ_PORT_TYPE_MIDI_GENERIC | SND_SEQ_PORT_TYPE_HARDWARE);
    return seq;
}

static void send_controller(snd_seq_t *seq, int port, int number, int value)
{
    snd_seq_event_t event;
    snd_seq_ev_clear(&event);
    snd_seq_ev_set_source(&event, (unsigned char)port);
    snd_seq_ev_set_subs(&event);
    snd_seq_ev_set_direct(&event);
    event.type = SND_SEQ_EVENT_CONTROLLER;
    event.data.control.param = (unsigned)number;
    event.data.control.value = value;
    assert_true(snd_seq_event_output_direct(seq, &event) >= 0);
}

static void ports_of_the_sequencer_come_and_go(void **state)
{
    room *r = *state;
    int port = 0;
    snd_seq_t *seq = make_program("marotte test faders", &port);
    if (!seq) {
        printf("SKIPPED: /dev/snd/seq is not here\n");
        skip();
    }
    input_host_set(r->host, "motor", 1);
    assert_int_equal(input_host_open(r->host, "test faders"), MRT_OK);
    send_controller(seq, port, 7, 127);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "cc.7"), 1, 0);
    for (int i = 0; i < 1000; ++i) {
        send_controller(seq, port, 8, i & 127);
        assert_int_equal(read_one(r, s_ns), MRT_OK);
        assert_float_equal(value_of(r, "cc.8"), (float)(i & 127) / 127.0f, 1e-6f);
    }
    (void)read_one(r, 50 * ms_ns);
    snd_seq_event_t *back = NULL;
    assert_true(snd_seq_event_input(seq, &back) >= 0); /* the motor's */
    snd_seq_close(seq);
    assert_int_equal(read_one(r, s_ns), MRT_ERR_IO);
    r->host->input->close(r->host->plugin);
    assert_int_equal(input_host_open(r->host, "test faders"), MRT_ERR_IO);
    seq = make_program("marotte test faders", &port);
    assert_int_equal(input_host_open(r->host, "test faders"), MRT_OK);
    send_controller(seq, port, 7, 64);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "cc.7"), 64 / 127.0f, 1e-6f);
    /* a second input hears the same port: it is shared */
    input_host *other = input_host_create(BUILD_DIR "/plugins/midi.so");
    assert_int_equal(input_host_open(other, "test faders"), MRT_OK);
    send_controller(seq, port, 7, 0);
    mrt_sample same;
    assert_int_equal(input_host_read(other, s_ns, &same), MRT_OK);
    input_host_destroy(other);
    snd_seq_close(seq);
}

static bool is_the_kernels(const char *name)
{
    mrt_device found[8];
    input_host *host = input_host_create(BUILD_DIR "/plugins/midi.so");
    uint32_t count = host->devices->list(host->plugin, found, 8);
    bool is_one = false;
    for (uint32_t i = 0; i < count && i < 8; ++i)
        is_one |= strcmp(found[i].name, name) == 0;
    input_host_destroy(host);
    return is_one;
}

/* Opened without a name while nothing is plugged in: the device that comes is the one. */
static void the_first_device_that_is_plugged_in_is_heard(void **state)
{
    room *r = *state;
    int port = 0, program_port = 0;
    snd_seq_t *program = make_program("marotte test program", &program_port);
    if (!program)
        skip();
    assert_int_equal(input_host_open(r->host, ""), MRT_OK);
    send_controller(program, program_port, 7, 127); /* not asked for: it is no device */
    assert_int_equal(read_one(r, 20 * ms_ns), MRT_TIMEOUT);
    snd_seq_t *seq = make_program("device nanoKONTROL2", &port);
    if (!is_the_kernels("device nanoKONTROL2")) { /* a real sequencer: programs make no devices */
        snd_seq_close(seq);
        snd_seq_close(program);
        skip();
    }
    for (int times = 0; times < 2; ++times) {
        const float expected = (float)(127 - times) / 127.0f;
        do { /* until it is heard of; what was there before it went is said again */
            (void)read_one(r, 20 * ms_ns);
            send_controller(seq, port, 7, 127 - times);
            assert_int_equal(read_one(r, s_ns), MRT_OK);
        } while (fabsf(value_of(r, "cc.7") - expected) > 1e-6f);
        snd_seq_close(seq);
        mrt_result result = MRT_OK;
        while (result == MRT_OK)
            result = read_one(r, s_ns);
        assert_int_equal(result, MRT_ERR_IO);
        r->host->input->close(r->host->plugin);
        assert_int_equal(input_host_open(r->host, ""), MRT_OK); /* as the host does */
        seq = make_program("device nanoKONTROL2", &port);
    }
    snd_seq_close(seq);
    snd_seq_close(program);
}
#endif

#define ROOM_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(faders_through_a_pipe_are_channels),
        ROOM_TEST(what_does_not_change_is_said_again),
        ROOM_TEST(a_thousand_moves_a_second_are_a_thousand_samples),
        ROOM_TEST(a_flood_of_noise_is_thinned_out),
        ROOM_TEST(a_new_control_becomes_a_channel),
        ROOM_TEST(channels_are_told_anew_only_so_often),
        ROOM_TEST(a_device_that_falls_silent_lets_its_notes_go),
        ROOM_TEST(motor_faders_get_their_value_back),
        ROOM_TEST(a_device_that_goes_is_lost_and_found_again),
        ROOM_TEST(what_is_no_device_is_refused_with_advice),
#ifdef MIDI_HAS_ALSA
        ROOM_TEST(ports_of_the_sequencer_come_and_go),
        ROOM_TEST(the_first_device_that_is_plugged_in_is_heard),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
