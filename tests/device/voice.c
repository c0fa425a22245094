/* The plugin org.marotte.voice on a pipe, and on a microphone of ALSA's that a file stands for. */
#define _XOPEN_SOURCE 700
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "input_host.h"

#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RATE = 48000, HOP = RATE / 100 };
static const int64_t s_ns = 1000000000;

typedef struct room {
    input_host *host;
    char folder[64], pipe[96];
    int writer;
} room;

static int set_up(void **state)
{
    room *r = calloc(1, sizeof *r);
    snprintf(r->folder, sizeof r->folder, "/tmp/marotte_voice_XXXXXX");
    assert_non_null(mkdtemp(r->folder));
    snprintf(r->pipe, sizeof r->pipe, "%s/pipe", r->folder);
    assert_int_equal(mkfifo(r->pipe, 0600), 0);
    r->writer = open(r->pipe, O_RDWR | O_NONBLOCK);
    r->host = input_host_create(BUILD_DIR "/plugins/voice.so");
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
    return 0;
}

/* 10 ms of a tone of that amplitude, full scale being 1. */
static void hum(int16_t out[HOP], double amplitude)
{
    for (int i = 0; i < HOP; ++i)
        out[i] = (int16_t)lrint(32767.0 * amplitude * sin(6.283185307179586 * i * 20.0 / HOP));
}

static void say(room *r, double amplitude)
{
    int16_t sound[HOP];
    hum(sound, amplitude);
    assert_int_equal(write(r->writer, sound, sizeof sound), sizeof sound);
}

static float hear(room *r)
{
    mrt_sample sample;
    assert_int_equal(input_host_read(r->host, 60 * s_ns, &sample), MRT_OK);
    assert_int_equal(sample.count, 1);
    return sample.value[0];
}

static void a_tone_has_its_level(void **state)
{
    /* a sine's root mean square is 3.01 dB below its peak */
    static const double amplitude[] = {1.0, 0.1, 0.01, 0.0, 1e-4};
    static const double expected[] = {1.0 - 3.01 / 60.0, 1.0 - 23.01 / 60.0, 1.0 - 43.01 / 60.0,
                                      0.0, 0.0};
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (int i = 0; i < 5; ++i) {
        float last = -1.0f;
        for (int k = 0; k < 3; ++k) {
            say(r, amplitude[i]);
            last = hear(r);
        }
        assert_float_equal(last, expected[i], 2e-3);
    }
}

static void times_go_on_by_the_sound_and_never_lie_ahead(void **state)
{
    room *r = *state;
    mrt_sample before = {0}, now;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (int i = 0; i < 4; ++i)
        say(r, 0.5);
    for (uint32_t i = 0; i < 4; ++i) {
        assert_int_equal(input_host_read(r->host, 60 * s_ns, &now), MRT_OK);
        assert_true(now.time_ns <= input_host_now_ns(&r->host->host));
        assert_int_equal(now.sequence, before.sequence + (i > 0));
        assert_true(now.time_ns >= before.time_ns);
        before = now;
    }
}

static void a_frame_may_come_in_halves(void **state)
{
    room *r = *state;
    int16_t sound[HOP];
    mrt_sample sample;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    hum(sound, 1.0);
    for (int k = 0; k < 3; ++k) {
        assert_int_equal(write(r->writer, sound, 301), 301);
        assert_int_equal(input_host_read(r->host, 0, &sample), MRT_TIMEOUT);
        assert_int_equal(write(r->writer, (char *)sound + 301, sizeof sound - 301),
                         sizeof sound - 301);
        sample.value[0] = hear(r);
    }
    assert_float_equal(sample.value[0], 1.0f - 3.01f / 60.0f, 2e-3f);
}

static void silence_in_the_pipe_is_waited_for_and_no_longer(void **state)
{
    room *r = *state;
    mrt_sample sample;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    int64_t begin_ns = input_host_now_ns(&r->host->host);
    assert_int_equal(input_host_read(r->host, s_ns / 50, &sample), MRT_TIMEOUT);
    assert_true(input_host_now_ns(&r->host->host) - begin_ns >= s_ns / 50);
}

/* ALSA's own "file" stands for a microphone, the real library reads it. */
static void a_microphone_of_alsas_is_heard_by_its_name(void **state)
{
    room *r = *state;
    char path[2][96];
    int16_t sound[HOP];
    if (access("/usr/share/alsa/alsa.conf", R_OK) != 0)
        skip();
    snprintf(path[0], sizeof path[0], "%s/alsa.conf", r->folder);
    snprintf(path[1], sizeof path[1], "%s/sound", r->folder);
    FILE *config = fopen(path[0], "w"), *recorded = fopen(path[1], "w");
    fprintf(config,
            "</usr/share/alsa/alsa.conf>\n"
            "pcm.talk { type file slave.pcm null file /dev/null infile \"%s\" format raw }\n",
            path[1]);
    hum(sound, 0.1);
    for (int i = 0; i < 50; ++i)
        fwrite(sound, sizeof sound, 1, recorded);
    fclose(config);
    fclose(recorded);
    setenv("ALSA_CONFIG_PATH", path[0], 1);
    mrt_result result = input_host_open(r->host, "talk");
    if (result == MRT_ERR_IO && strstr(r->host->last_text, "libasound2-dev"))
        skip(); /* built without it */
    assert_int_equal(result, MRT_OK);
    (void)hear(r);
    for (int i = 0; i < 20; ++i)
        assert_float_equal(hear(r), 1.0f - 23.01f / 60.0f, 2e-3f);
    unlink(path[0]);
    unlink(path[1]);
}

static void what_cannot_be_heard_is_refused_with_advice(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->folder), MRT_ERR_IO);
    assert_non_null(strstr(r->host->last_text, "mkfifo"));
    assert_int_equal(input_host_open(r->host, "no_such_microphone"), MRT_ERR_IO);
    assert_non_null(strstr(r->host->last_text, "no_such_microphone"));
    assert_int_equal(r->host->said[MRT_LOG_ERROR], 2);
}

#define ROOM_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_tone_has_its_level),
        ROOM_TEST(times_go_on_by_the_sound_and_never_lie_ahead),
        ROOM_TEST(a_frame_may_come_in_halves),
        ROOM_TEST(silence_in_the_pipe_is_waited_for_and_no_longer),
        ROOM_TEST(a_microphone_of_alsas_is_heard_by_its_name),
        ROOM_TEST(what_cannot_be_heard_is_refused_with_advice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
