/* A CyberGlove that works: its channels, its rates, its ports. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "glove_bench.h"

#include <errno.h>
#include <sys/file.h>

/* ---- gloves ---- */

static void a_glove_of_22_sensors_gives_22_channels_in_order(void **state)
{
    bench *b = *state;
    assert_opens(b);
    uint32_t count;
    const mrt_channel *channel = b->input->channels(b->plugin, &count);
    assert_int_equal(count, 22);
    for (uint32_t i = 0; i < count; ++i) {
        assert_int_equal(channel[i].semantic, MRT_CH_ANGLE + i);
        assert_int_equal(channel[i].hand, MRT_RIGHT);
        assert_string_equal(channel[i].unit, "count");
        assert_float_equal(channel[i].min, 1, 0);
        assert_float_equal(channel[i].max, 255, 0);
    }
    assert_string_equal(channel[0].name, "right.thumb.roll");
    assert_string_equal(channel[21].name, "right.wrist.yaw");
    mrt_sample sample, last = {0};
    for (uint32_t i = 0; i < 50; ++i) {
        assert_reads(b, &sample);
        assert_int_equal(sample.sequence, i);
        assert_int_equal(sample.count, 22);
        assert_true(sample.time_ns >= last.time_ns && sample.time_ns <= now_ns());
        assert_float_equal(sample.value[21], 31, 0);
        if (i > 0)
            assert_int_equal(((int)sample.value[0] - (int)last.value[0] + 250) % 250, 1);
        last = sample;
    }
    assert_true(now_ns() - last.time_ns < 50 * MS);
}

static void a_left_glove_of_18_sensors_lacks_the_distal_joints(void **state)
{
    bench *b = *state;
    b->talker.sensors = 18;
    b->talker.is_left = true;
    assert_opens(b);
    static const uint32_t sensor[18] = {0,  1,  2,  3,  4,  5,  7,  8,  10,
                                        11, 12, 14, 15, 16, 18, 19, 20, 21};
    uint32_t count;
    const mrt_channel *channel = b->input->channels(b->plugin, &count);
    assert_int_equal(count, 18);
    for (uint32_t i = 0; i < count; ++i) {
        assert_int_equal(channel[i].semantic, MRT_CH_ANGLE + sensor[i]);
        assert_int_equal(channel[i].hand, MRT_LEFT);
    }
    assert_string_equal(channel[6].name, "left.middle.mpj");
    mrt_sample sample;
    assert_reads(b, &sample);
    assert_int_equal(sample.count, 18);
}

static void a_glove_that_refuses_time_stamps_and_rates_streams_all_the_same(void **state)
{
    bench *b = *state;
    b->talker.refuses = true;
    assert_opens(b);
    mrt_sample sample, last = {0};
    for (int i = 0; i < 30; ++i) {
        assert_reads(b, &sample);
        assert_true(sample.time_ns >= last.time_ns && sample.time_ns <= now_ns());
        last = sample;
    }
    assert_true(b->log_count[MRT_LOG_INFO] >= 2);
    b->params[STAMPS] = 1;
    assert_int_equal(open_talker(b), MRT_ERR_UNSUPPORTED);
    assert_error_says(b, "time stamps");
}

static void a_status_byte_that_nobody_asked_for_is_understood(void **state)
{
    bench *b = *state;
    b->talker.refuses = true;
    b->talker.has_status_unasked = true;
    b->params[SWITCH] = 2;
    assert_opens(b);
    uint32_t count;
    const mrt_channel *channel = b->input->channels(b->plugin, &count);
    assert_int_equal(count, 23);
    assert_int_equal(channel[22].semantic, MRT_CH_PEDAL + 1);
    mrt_sample sample;
    assert_reads(b, &sample);
    assert_float_equal(sample.value[22], 0, 0);
}

static void a_slow_rate_that_is_refused_is_polled(void **state)
{
    bench *b = *state;
    b->talker.refuses = true;
    b->params[RATE] = 40;
    assert_opens(b);
    mrt_sample sample;
    assert_reads(b, &sample);
    int64_t start_ns = now_ns();
    for (int i = 0; i < 10; ++i)
        assert_reads(b, &sample);
    int64_t took_ns = now_ns() - start_ns;
    assert_true(took_ns > 230 * MS && took_ns < 400 * MS);
    assert_true(b->talker.asked_polled >= 11);
}

static void the_switch_is_the_pedal_that_was_chosen_and_goes_up_when_the_glove_goes(void **state)
{
    bench *b = *state;
    b->params[SWITCH] = 3;
    assert_opens(b);
    mrt_sample sample;
    assert_reads(b, &sample);
    assert_float_equal(sample.value[22], 0, 0);
    b->talker.status = 0x83;
    for (int i = 0; i < 100 && sample.value[22] < 0.5f; ++i)
        assert_reads(b, &sample);
    assert_float_equal(sample.value[22], 1, 0);
    b->talker.hang_up_after = 1;
    while (sample.value[22] > 0.5f)
        assert_reads(b, &sample);
    assert_int_equal(b->log_count[MRT_LOG_ERROR], 0); /* it comes with the error */
    assert_int_equal(read_within(b, 50 * MS, &sample), MRT_ERR_IO);
    assert_error_says(b, "unplugged");
}

static void words_are_counts_with_fractions(void **state)
{
    bench *b = *state;
    b->params[STREAM] = 1;
    assert_opens(b);
    uint32_t count;
    const mrt_channel *channel = b->input->channels(b->plugin, &count);
    assert_int_equal(count, 22);
    mrt_sample sample;
    assert_reads(b, &sample);
    for (uint32_t i = 0; i < count; ++i) {
        assert_float_equal(sample.value[i], (float)(1001 + i) / 16.0f, 1e-6f);
        assert_true(channel[i].min <= sample.value[i] && sample.value[i] <= channel[i].max);
    }
}

static void a_wireless_glove_is_read_over_tcp_and_its_loss_is_noticed(void **state)
{
    bench *b = *state;
    char address[96];
    virtual_clock_give_back(); /* it lives by a thread of its own */
    b->params[PATIENCE] = 10;
    talker_start_tcp(&b->talker);
    b->has_talker = true;
    snprintf(address, sizeof address, "tcp:%s", b->talker.path);
    if (b->input->open(b->plugin, address, b->params) != MRT_OK)
        fail_msg("%s", b->last_error);
    mrt_device device;
    assert_true(b->devices->current(b->plugin, &device));
    assert_string_equal(device.address, address);
    mrt_sample sample;
    mrt_result result = MRT_TIMEOUT;
    while (result == MRT_TIMEOUT)
        result = read_within(b, 50 * MS, &sample);
    b->talker.hang_up_after =
        b->talker.sent + 21; /* the one that was read may not be counted yet */
    int read_count = 0;
    for (; result >= 0; read_count += result == MRT_OK)
        result = read_within(b, 50 * MS, &sample);
    assert_int_equal(result, MRT_ERR_IO);
    assert_true(read_count >= 20);
    assert_error_says(b, "unplugged");
}

/* ---- ports ---- */

static void what_is_no_serial_port_is_refused(void **state)
{
    bench *b = *state;
    assert_int_equal(open_path(b, "/dev/null"), MRT_ERR_UNSUPPORTED);
    assert_error_says(b, "not a serial port");
    assert_int_equal(open_path(b, "/dev/does-not-exist"), MRT_ERR_IO);
    assert_error_says(b, "does not exist");
    assert_int_equal(b->input->open(b->plugin, "ttyUSB0", b->params), MRT_ERR_ARGUMENT);
    assert_error_says(b, "expected serial:");
}

static void tcp_addresses_are_checked(void **state)
{
    bench *b = *state;
    static const char *const bad[] = {"tcp:",
                                      "tcp:1.2.3.4",
                                      "tcp:1.2.3.4:",
                                      "tcp:glove.local:80",
                                      "tcp:1.2.3.4:999999",
                                      "tcp:[]:80",
                                      "tcp:127.0.0.1:0",
                                      "tcp:127.0.0.1:65536"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_int_equal(b->input->open(b->plugin, bad[i], b->params), MRT_ERR_ARGUMENT);
    assert_int_equal(b->input->open(b->plugin, "tcp:127.0.0.1:1", b->params), MRT_ERR_IO);
    assert_error_says(b, "no connection");
}

static void a_port_that_another_program_has_locked_is_busy(void **state)
{
    bench *b = *state;
    talker_start(&b->talker);
    b->has_talker = true;
    int other = open(b->talker.path, O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(other >= 0);
    assert_int_equal(flock(other, LOCK_EX | LOCK_NB), 0);
    assert_int_equal(open_talker(b), MRT_ERR_IO);
    assert_error_says(b, "in use by");
    assert_error_says(b,
                      "marotte itself"); /* it also made the terminal: nobody else may be named */
    close(other);
    assert_opens(b);
}

static void a_host_that_stops_is_obeyed_while_opening(void **state)
{
    bench *b = *state;
    b->talker.habit = TALKER_SILENT;
    b->params[PATIENCE] = 1;
    b->stopping = true;
    int64_t start_ns = now_ns();
    assert_int_equal(open_talker(b), MRT_ERR_IO);
    assert_true(now_ns() - start_ns < 300 * MS);
}

static void it_can_be_opened_again_and_again(void **state)
{
    bench *b = *state;
    mrt_sample sample;
    for (int i = 0; i < 5; ++i) {
        assert_opens(b);
        assert_reads(b, &sample);
        assert_int_equal(sample.sequence, 0);
        b->input->close(b->plugin);
    }
    b->input->close(b->plugin);
    assert_int_equal(read_within(b, 0, &sample), MRT_END);
}

static void closing_stops_the_glove_and_gives_the_port_back_as_it_was(void **state)
{
    bench *b = *state;
    talker_start(&b->talker);
    b->has_talker = true;
    struct termios before, after;
    assert_int_equal(tcgetattr(b->talker.slave, &before), 0);
    before.c_lflag |= ECHO;
    assert_int_equal(tcsetattr(b->talker.slave, TCSANOW, &before), 0);
    assert_opens(b);
    assert_int_equal(tcgetattr(b->talker.slave, &after), 0);
    assert_false(after.c_lflag & ECHO);
    b->input->close(b->plugin);
    assert_int_equal(tcgetattr(b->talker.slave, &after), 0);
    assert_true(after.c_lflag & ECHO);
    int64_t limit_ns = now_ns() + 500 * MS;
    while (b->talker.streams && now_ns() < limit_ns)
        host_wait_until_ns(&b->host, now_ns() + MS);
    assert_false(b->talker.streams);
}

static void the_device_that_is_open_is_named(void **state)
{
    bench *b = *state;
    mrt_device device, expected = {.state = MRT_DEVICE_READY};
    assert_false(b->devices->current(b->plugin, &device));
    assert_opens(b);
    assert_true(b->devices->current(b->plugin, &device));
    assert_string_equal(device.name, "CyberGlove, right hand, 22 sensors");
    snprintf(expected.address, sizeof expected.address, "serial:%s", b->talker.path);
    assert_string_equal(device.address, expected.address);
    assert_int_equal(device.state, MRT_DEVICE_READY);
    (void)b->devices->list(b->plugin, NULL, 0);
}

static void a_changed_parameter_asks_for_a_restart_once(void **state)
{
    bench *b = *state;
    assert_opens(b);
    mrt_sample sample;
    assert_reads(b, &sample);
    b->params[HAND] = 1;
    assert_reads(b, &sample);
    assert_reads(b, &sample);
    assert_int_equal(b->restarts, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        GLOVE_TEST(a_glove_of_22_sensors_gives_22_channels_in_order),
        GLOVE_TEST(a_left_glove_of_18_sensors_lacks_the_distal_joints),
        GLOVE_TEST(a_glove_that_refuses_time_stamps_and_rates_streams_all_the_same),
        GLOVE_TEST(a_status_byte_that_nobody_asked_for_is_understood),
        GLOVE_TEST(a_slow_rate_that_is_refused_is_polled),
        GLOVE_TEST(the_switch_is_the_pedal_that_was_chosen_and_goes_up_when_the_glove_goes),
        GLOVE_TEST(words_are_counts_with_fractions),
        GLOVE_TEST(a_wireless_glove_is_read_over_tcp_and_its_loss_is_noticed),
        GLOVE_TEST(what_is_no_serial_port_is_refused),
        GLOVE_TEST(tcp_addresses_are_checked),
        GLOVE_TEST(a_port_that_another_program_has_locked_is_busy),
        GLOVE_TEST(a_host_that_stops_is_obeyed_while_opening),
        GLOVE_TEST(it_can_be_opened_again_and_again),
        GLOVE_TEST(closing_stops_the_glove_and_gives_the_port_back_as_it_was),
        GLOVE_TEST(the_device_that_is_open_is_named),
        GLOVE_TEST(a_changed_parameter_asks_for_a_restart_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
