/* The plugin org.marotte.phone on real sockets of this computer: faces as phones send them. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "input_host.h"
#include "virtual_clock.h"
#include "phone_datagrams.h"

#include <arpa/inet.h>
#include <math.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

static const int64_t ms_ns = 1000000, s_ns = 1000000000;

typedef struct room {
    input_host *host;
    int phone, other; /* sockets that send */
    uint16_t port;    /* that marotte listens to */
    const char *to;   /* address of this computer that they send to */
    char address[64];
    mrt_sample last;
} room;

static int open_socket(uint16_t *out_port)
{
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t size = sizeof at;
    assert_true(fd >= 0 && bind(fd, (struct sockaddr *)&at, sizeof at) == 0 &&
                getsockname(fd, (struct sockaddr *)&at, &size) == 0);
    *out_port = ntohs(at.sin_port);
    return fd;
}

static int set_up(void **state)
{
    room *r = calloc(1, sizeof *r);
    virtual_clock_take(NULL, 1000 * s_ns);
    uint16_t own;
    close(open_socket(&r->port)); /* was free a moment ago */
    r->phone = open_socket(&own);
    r->other = open_socket(&own);
    r->to = "127.0.0.1";
    r->host = input_host_create(BUILD_DIR "/plugins/phone.so");
    snprintf(r->address, sizeof r->address, "%u", (unsigned)r->port);
    *state = r;
    return 0;
}

static int tear_down(void **state)
{
    room *r = *state;
    input_host_destroy(r->host);
    close(r->phone);
    close(r->other);
    free(r);
    virtual_clock_give_back();
    return 0;
}

static void send_bytes(const room *r, int from, const void *bytes, size_t size)
{
    struct sockaddr_in to = {
        .sin_family = AF_INET, .sin_port = htons(r->port), .sin_addr = {inet_addr(r->to)}};
    assert_int_equal(sendto(from, bytes, size, 0, (struct sockaddr *)&to, sizeof to), size);
}

static void send_face(const room *r, int from, uint32_t frame, float jaw)
{
    datagram sent;
    float value[61] = {0};
    value[17] = jaw;
    value[21] = 0.25f;
    put_live_link(&sent, frame, 0, value);
    send_bytes(r, from, sent.bytes, sent.size);
}

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

static void a_phone_is_61_channels(void **state)
{
    room *r = *state;
    uint32_t count;
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    (void)r->host->input->channels(r->host->plugin, &count);
    assert_int_equal(count, 61);
    assert_int_equal(read_one(r, 10 * ms_ns), MRT_TIMEOUT);
    int64_t last_ns = 0;
    for (uint32_t i = 0; i < 120; ++i) {
        int64_t before_ns = input_host_now_ns(NULL);
        send_face(r, r->phone, 1000 + i, (float)i / 120);
        assert_int_equal(read_one(r, s_ns), MRT_OK);
        assert_float_equal(value_of(r, "jawOpen"), (float)i / 120, 0);
        assert_float_equal(value_of(r, "mouthLeft"), 0.25f, 0);
        assert_int_equal(r->last.sequence, i);
        /* by the phone's clock, which is then ahead: frames come as fast as they can here */
        assert_true(r->last.time_ns >= last_ns && r->last.time_ns <= input_host_now_ns(NULL));
        assert_true(i > 0 || r->last.time_ns >= before_ns - ms_ns);
        last_ns = r->last.time_ns;
    }
    input_host_set(r->host, "laterals", 1);
    send_face(r, r->phone, 1200, 0);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "mouthRight"), 0.25f, 0);
    assert_float_equal(value_of(r, "mouthLeft"), 0, 0);
}

static void nobody_before_the_phone_holds_the_face(void **state)
{
    room *r = *state;
    datagram sent;
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    begin_live_link(&sent, 5, 0);
    send_bytes(r, r->phone, sent.bytes, sent.size);
    assert_int_equal(read_one(r, 20 * ms_ns), MRT_TIMEOUT);
    assert_int_equal(r->host->said[MRT_LOG_WARNING], 0);
}

static void time_that_goes_back_a_little_is_an_overtaken_datagram(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    send_face(r, r->phone, 1000, 0.5f);
    send_face(r, r->phone, 999, 0.25f);
    send_face(r, r->phone, 1001, 0.75f);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 0.5f, 0);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 0.75f, 0);
    int64_t last_ns = r->last.time_ns;
    send_face(r, r->phone, 3, 1); /* the app was started again */
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 1, 0);
    assert_true(r->last.time_ns >= last_ns);
}

static void noise_is_said_once_and_changes_nothing(void **state)
{
    room *r = *state;
    uint32_t seed = 3;
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    for (int i = 0; i < 20000; ++i) {
        uint8_t bytes[2000];
        size_t size = 1 + (seed >> 8) % (sizeof bytes - 1);
        for (size_t k = 0; k < size; ++k)
            bytes[k] = (uint8_t)((seed = seed * 1664525 + 1013904223) >> 24);
        bytes[0] = i % 2 ? 6 : bytes[0];
        send_bytes(r, i % 3 ? r->phone : r->other, bytes, size);
        mrt_result result = read_one(r, 0);
        assert_true(result == MRT_TIMEOUT);
    }
    send_bytes(r, r->phone, "", 0);
    while (read_one(r, 5 * ms_ns) == MRT_OK)
        ;
    assert_int_equal(r->host->said[MRT_LOG_WARNING], 1);
    send_face(r, r->phone, 1000, 0.5f);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 0.5f, 0);
}

static void of_two_phones_the_first_is_heard(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    send_face(r, r->phone, 998, 0.5f); /* who sends once holds nothing: scripts do */
    send_face(r, r->phone, 999, 0.5f);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    for (uint32_t i = 0; i < 3; ++i) {
        send_face(r, r->phone, 1000 + i, 0.5f);
        send_face(r, r->other, 9000 + i, 1);
        assert_int_equal(read_one(r, s_ns), MRT_OK);
        assert_float_equal(value_of(r, "jawOpen"), 0.5f, 0);
    }
    assert_int_equal(read_one(r, 10 * ms_ns), MRT_TIMEOUT);
    assert_int_equal(r->host->said[MRT_LOG_WARNING], 1);
    assert_non_null(strstr(r->host->last_text, "open a second input on another port"));
    const struct timespec span = {.tv_sec = 1, .tv_nsec = 100000000};
    nanosleep(&span, NULL); /* the first one is silent: the other one performs */
    send_face(r, r->other, 9100, 1);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 1, 0);
}

/* iFacialMocap waits to be asked, at the port at which it answers. What is sent to an address of
 * this computer comes back to marotte itself, as a broadcast does, and is no face. */
static void a_phone_that_waits_is_asked(void **state)
{
    room *r = *state;
    char trace[] = "/tmp/marotte_phone_XXXXXX", line[1024] = "", hex[256] = "";
    static const char greeting[] =
        "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719|sendDataVersion=v2";
    for (size_t i = 0; greeting[i]; ++i)
        snprintf(hex + 3 * i, sizeof hex - 3 * i, " %02x", (unsigned)greeting[i]);
    close(mkstemp(trace));
    setenv("MAROTTE_TRACE", trace, 1);
    assert_int_equal(input_host_open(r->host, "127.0.0.2:49983x"), MRT_ERR_ARGUMENT);
    snprintf(r->address, sizeof r->address, "127.0.0.2:%u", (unsigned)r->port);
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    unsetenv("MAROTTE_TRACE");
    assert_int_equal(read_one(r, 800 * ms_ns), MRT_TIMEOUT);
    assert_int_equal(read_one(r, 800 * ms_ns), MRT_TIMEOUT); /* asked at once, and after 1 s */
    assert_int_equal(r->host->said[MRT_LOG_WARNING], 0);
    FILE *traced = fopen(trace, "r");
    int sent = 0, received = 0;
    while (fgets(line, sizeof line, traced)) {
        sent += strstr(line, " phone >") && strstr(line, hex);
        received += strstr(line, " phone <") && strstr(line, hex);
    }
    fclose(traced);
    unlink(trace);
    assert_int_equal(sent, 2);
    assert_int_equal(received, 2);
    r->to = "127.0.0.2";
    static const char face[] = "jawOpen&50|eyeBlink_L&100|trackingStatus&1|=head#10,0,0,0,0,0|";
    send_bytes(r, r->phone, face, sizeof face - 1);
    assert_int_equal(read_one(r, 500 * ms_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 0.5f, 1e-6f);
    assert_float_equal(value_of(r, "headPitch"), 0.1745329f, 1e-6f);
    /* what a datagram does not tell stays */
    send_bytes(r, r->phone, "jawOpen-20|", 11);
    assert_int_equal(read_one(r, 500 * ms_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 0.2f, 1e-6f);
    assert_float_equal(value_of(r, "eyeBlinkLeft"), 1, 0);
}

static void at_an_own_address_only_that_one_is_listened_to(void **state)
{
    room *r = *state;
    snprintf(r->address, sizeof r->address, "127.0.0.2:%u", (unsigned)r->port);
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    send_face(r, r->phone, 1000, 0.5f);
    assert_int_equal(read_one(r, 20 * ms_ns), MRT_TIMEOUT);
    r->to = "127.0.0.2";
    send_face(r, r->phone, 1001, 0.75f);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "jawOpen"), 0.75f, 0);
}

/* 192.0.2.1 is nobody's: RFC 5737. */
static void of_a_named_phone_nobody_else_is_heard(void **state)
{
    room *r = *state;
    snprintf(r->address, sizeof r->address, "192.0.2.1:%u", (unsigned)r->port);
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    for (uint32_t i = 0; i < 3; ++i) {
        send_face(r, r->phone, 1000 + i, 0.5f);
        assert_int_equal(read_one(r, 20 * ms_ns), MRT_TIMEOUT);
    }
    assert_non_null(strstr(r->host->last_text, "127.0.0.1"));
    assert_non_null(strstr(r->host->last_text, "ignored a second face"));
    snprintf(r->address, sizeof r->address, "0.0.0.0:%u", (unsigned)r->port);
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    send_face(r, r->phone, 1010, 0.5f);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
}

static void openseeface_is_a_face_too(void **state)
{
    room *r = *state;
    datagram sent = {.size = 0};
    openseeface_face face = {
        .time_s = 1.7e9, .right_open = 1, .left_open = 0, .has_3d = 1, .euler = {180, 0, 90}};
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    put_openseeface(&sent, &face);
    send_bytes(r, r->phone, sent.bytes, sent.size);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value_of(r, "eyeBlinkLeft"), 1, 0);
    assert_float_equal(value_of(r, "eyeBlinkRight"), 0, 0);
}

static void a_port_in_use_is_one_calm_line(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->address), MRT_OK);
    input_host *second = input_host_create(BUILD_DIR "/plugins/phone.so");
    assert_int_equal(input_host_open(second, r->address), MRT_ERR_IO);
    assert_int_equal(second->said[MRT_LOG_ERROR], 1);
    assert_non_null(strstr(second->last_text, "another"));
    static const char *const bad[] = {"x", "0", "65536", "1.2.3.4:", ":11111", "/nowhere"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_int_equal(input_host_open(second, bad[i]), MRT_ERR_ARGUMENT);
    input_host_destroy(second);
}

#define ROOM_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_phone_is_61_channels),
        ROOM_TEST(nobody_before_the_phone_holds_the_face),
        ROOM_TEST(time_that_goes_back_a_little_is_an_overtaken_datagram),
        ROOM_TEST(noise_is_said_once_and_changes_nothing),
        ROOM_TEST(of_two_phones_the_first_is_heard),
        ROOM_TEST(a_phone_that_waits_is_asked),
        ROOM_TEST(at_an_own_address_only_that_one_is_listened_to),
        ROOM_TEST(of_a_named_phone_nobody_else_is_heard),
        ROOM_TEST(openseeface_is_a_face_too),
        ROOM_TEST(a_port_in_use_is_one_calm_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
