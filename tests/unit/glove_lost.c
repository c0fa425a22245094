/* What is no CyberGlove, or one no longer: it is named, given up in time, never spun at. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "glove_bench.h"

static void a_device_that_is_no_glove_is_named_by_what_it_says(void **state)
{
    bench *b = *state;
    b->talker.habit = TALKER_OTHER_DEVICE;
    assert_int_equal(open_talker(b), MRT_ERR_UNSUPPORTED);
    assert_error_says(b, "not a CyberGlove");
    assert_error_says(b, "4f 4b 0d 0a");
}

static void a_silent_device_is_given_up_in_time(void **state)
{
    bench *b = *state;
    b->talker.habit = TALKER_SILENT;
    int64_t start_ns = now_ns();
    assert_int_equal(open_talker(b), MRT_ERR_IO);
    assert_true(now_ns() - start_ns < 700 * MS); /* 6 s, a tenth, and what is left over */
    assert_error_says(b, "no answer at 115200 baud");
}

static void a_glove_that_goes_while_it_is_asked_is_said_to_have_gone(void **state)
{
    bench *b = *state;
    b->talker.habit = TALKER_HANGS_UP_ON_S;
    assert_int_equal(open_talker(b), MRT_ERR_IO);
    assert_error_says(b, "disappeared");
}

static void a_cable_that_is_pulled_is_an_error_once_and_never_a_spin(void **state)
{
    bench *b = *state;
    b->talker.hang_up_after = 20;
    assert_opens(b);
    mrt_sample sample;
    mrt_result result = MRT_OK;
    for (int i = 0; i < 100 && result >= 0; ++i)
        result = read_within(b, 50 * MS, &sample);
    assert_int_equal(result, MRT_ERR_IO);
    assert_error_says(b, "unplugged");
    int64_t before_ns = now_ns();
    for (int i = 0; i < 5; ++i)
        assert_int_equal(read_within(b, 20 * MS, &sample), MRT_ERR_IO);
    assert_int_equal(now_ns() - before_ns, 100 * MS); /* each has waited */
    assert_int_equal(b->log_count[MRT_LOG_ERROR], 1);
}

static void a_glove_that_falls_silent_is_asked_again_and_then_lost(void **state)
{
    bench *b = *state;
    b->talker.silent_after = 10;
    assert_opens(b);
    mrt_sample sample;
    mrt_result result = MRT_OK;
    int64_t start_ns = now_ns();
    for (int i = 0; i < 100 && result >= 0; ++i)
        result = read_within(b, 20 * MS, &sample);
    assert_int_equal(result, MRT_ERR_IO);
    assert_error_says(b, "stopped sending");
    int64_t took_ns = now_ns() - start_ns;
    assert_true(took_ns > 150 * MS && took_ns < 600 * MS);
}

static void a_silence_that_ends_when_it_is_asked_again_goes_on(void **state)
{
    bench *b = *state;
    b->talker.silent_after = 10;
    assert_opens(b);
    mrt_sample sample;
    mrt_result result = MRT_OK;
    for (int i = 0; i < 100 && result == MRT_OK; ++i)
        result = read_within(b, 30 * MS, &sample);
    assert_int_equal(result, MRT_TIMEOUT);
    b->talker.silent_after = 0;
    assert_reads(b, &sample);
    assert_int_equal(b->log_count[MRT_LOG_ERROR], 0);
}

static void a_glove_that_is_stuck_is_restarted(void **state)
{
    bench *b = *state;
    b->talker.habit = TALKER_STUCK;
    assert_opens(b);
    assert_int_equal(b->talker.restarts, 1);
    mrt_sample sample;
    assert_reads(b, &sample);
}

static void a_glove_out_of_its_box_is_lost_and_said(void **state)
{
    bench *b = *state;
    assert_opens(b);
    mrt_sample sample;
    assert_reads(b, &sample);
    b->talker.is_out_of_box = true;
    mrt_result result = MRT_OK;
    int read_count = 0;
    for (int i = 0; i < 100 && result >= 0; ++i) {
        result = read_within(b, 20 * MS, &sample);
        read_count += result == MRT_OK;
    }
    assert_int_equal(result, MRT_ERR_IO);
    assert_error_says(b, "not plugged into its box");
    assert_true(read_count < 20); /* of before, and one of doubt */
}

static void a_glove_out_of_its_box_is_not_opened(void **state)
{
    bench *b = *state;
    b->talker.is_out_of_box = true;
    assert_int_equal(open_talker(b), MRT_ERR_IO);
    assert_error_says(b, "not plugged into it");
    assert_int_equal(b->log_count[MRT_LOG_WARNING], 0);
    b->params[MODE] = 2;
    assert_int_equal(open_talker(b), MRT_ERR_IO);
    assert_error_says(b, "not plugged into it");
    b->talker.is_out_of_box = false;
    mrt_sample sample;
    assert_opens(b);
    assert_reads(b, &sample);
}

/* Sensor 0 counts the records in base 250. */
static void garbage_that_ends_when_it_is_asked_again_is_counted_as_lost(void **state)
{
    bench *b = *state;
    assert_opens(b);
    mrt_sample sample, last = {0};
    for (int i = 0; i < 10; ++i)
        assert_reads(b, &last);
    b->talker.babbles = true;
    mrt_result result = MRT_OK;
    while (b->talker.babbles && (result = read_within(b, 20 * MS, &sample)) >= 0)
        if (result == MRT_OK)
            last = sample;
    assert_true(result >= 0);
    assert_reads(b, &sample);
    int missing = ((int)sample.value[0] - (int)last.value[0] + 250) % 250 - 1;
    int told = (int)(sample.sequence - last.sequence) - 1;
    assert_true(missing > 5);
    assert_true(told >= missing - 3 && told <= missing + 1); /* what was flushed nobody counts */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        GLOVE_TEST(a_device_that_is_no_glove_is_named_by_what_it_says),
        GLOVE_TEST(a_silent_device_is_given_up_in_time),
        GLOVE_TEST(a_glove_that_goes_while_it_is_asked_is_said_to_have_gone),
        GLOVE_TEST(a_cable_that_is_pulled_is_an_error_once_and_never_a_spin),
        GLOVE_TEST(a_glove_that_falls_silent_is_asked_again_and_then_lost),
        GLOVE_TEST(a_silence_that_ends_when_it_is_asked_again_goes_on),
        GLOVE_TEST(a_glove_that_is_stuck_is_restarted),
        GLOVE_TEST(a_glove_out_of_its_box_is_lost_and_said),
        GLOVE_TEST(a_glove_out_of_its_box_is_not_opened),
        GLOVE_TEST(garbage_that_ends_when_it_is_asked_again_is_counted_as_lost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
