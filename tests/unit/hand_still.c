/* hand/still.h: whether a hand holds still. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/still.h"

static const int64_t SPAN_NS = 500000000, PERIOD_NS = 10000000; /* 100 Hz */
enum { ALL = (1 << MRT_ANGLES) - 1 };

static void add(still_window *window, int channel, float value, int64_t time_ns)
{
    float values[MRT_ANGLES] = {0};
    values[channel] = value;
    still_add(window, values, time_ns);
}

static void window_is_full_once_its_span_was_seen(void **state)
{
    (void)state;
    still_window window;
    still_init(&window, SPAN_NS, ALL);
    assert_false(still_measure(&window).is_full);
    for (int i = 0; i < 49; ++i)
        add(&window, 0, 0, i * PERIOD_NS);
    assert_false(still_measure(&window).is_full);
    add(&window, 0, 0, 49 * PERIOD_NS);
    assert_true(still_measure(&window).is_full);
}

/* +1 and -1 in turn: the standard deviation is 1. */
static void deviation_names_the_worst_channel_that_counts(void **state)
{
    (void)state;
    still_window window;
    still_init(&window, SPAN_NS, ALL & ~(1u << 7));
    for (int i = 0; i < 50; ++i) {
        float values[MRT_ANGLES] = {0};
        values[3] = i % 2 ? 1.0f : -1.0f;
        values[5] = i % 2 ? 10.5f : 9.5f;
        values[7] = i % 2 ? 100.0f : -100.0f;
        still_add(&window, values, i * PERIOD_NS);
    }
    still_state measured = still_measure(&window);
    assert_float_equal(measured.worst, 1.0, 1e-9);
    assert_int_equal(measured.worst_channel, 3);
    float mean[MRT_ANGLES];
    still_mean(&window, mean);
    assert_float_equal(mean[5], 10.0f, 1e-6);
    assert_true(mean[7] == 0.0f);
}

static void what_is_older_than_the_span_is_forgotten(void **state)
{
    (void)state;
    still_window window;
    still_init(&window, SPAN_NS, ALL);
    for (int i = 0; i < 200; ++i)
        add(&window, 2, i < 100 ? (float)(i * 3) : 7.0f, i * PERIOD_NS);
    still_state measured = still_measure(&window);
    assert_true(measured.is_full && measured.worst == 0.0);
}

static void share_is_the_time_since_the_last_movement(void **state)
{
    (void)state;
    still_window window;
    still_init(&window, SPAN_NS, ALL & ~(1u << 7));
    assert_float_equal(still_share(&window, 1.0), 0.0, 1e-9);
    for (int i = 0; i < 200; ++i) { /* moves by 3 a sample, then holds within 0.1 */
        float values[MRT_ANGLES] = {0};
        values[2] = i < 100 ? (float)(i * 3) : 297.0f + (i % 2 ? 0.1f : -0.1f);
        values[7] = i % 2 ? 100.0f : -100.0f; /* does not count */
        still_add(&window, values, i * PERIOD_NS);
        if (i == 99)
            assert_true(still_share(&window, 0.5) < 0.05);
        if (i == 124)
            assert_float_equal(still_share(&window, 0.5), 0.5, 0.06);
    }
    assert_float_equal(still_share(&window, 0.5), 1.0, 1e-9);
    assert_float_equal(still_share(&window, 0.05), 0.0, 0.05);
}

static void a_gap_or_a_step_backwards_starts_anew(void **state)
{
    (void)state;
    still_window window;
    still_init(&window, SPAN_NS, ALL);
    for (int i = 0; i < 60; ++i)
        add(&window, 0, 0, i * PERIOD_NS);
    add(&window, 0, 0, 59 * PERIOD_NS + 250000001);
    assert_int_equal(window.count, 1);
    add(&window, 0, 0, INT64_MIN);
    add(&window, 0, 0, INT64_MAX);
    assert_int_equal(window.count, 1);
}

static void fast_samples_still_fill_the_span(void **state)
{
    (void)state;
    still_window window;
    still_init(&window, SPAN_NS, ALL);
    for (int i = 0; i < 2000; ++i)
        add(&window, 0, (float)i, i * 1000000LL); /* 1 kHz */
    assert_true(still_measure(&window).is_full);
    assert_true(window.count <= STILL_SAMPLES && window.count > STILL_SAMPLES / 2);
}

static void median_ignores_a_glitch(void **state)
{
    (void)state;
    still_window window;
    float median[MRT_ANGLES];
    still_init(&window, SPAN_NS, ALL);
    still_median(&window, median);
    assert_true(median[0] == 0.0f);
    const float value[6] = {12, 11, 255, 10, 1, 13};
    for (int i = 0; i < 5; ++i)
        add(&window, 4, value[i], i * PERIOD_NS);
    still_median(&window, median);
    assert_true(median[4] == 11.0f);
    add(&window, 4, value[5], 5 * PERIOD_NS);
    still_median(&window, median);
    assert_true(median[4] == 11.5f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(window_is_full_once_its_span_was_seen),
        cmocka_unit_test(deviation_names_the_worst_channel_that_counts),
        cmocka_unit_test(what_is_older_than_the_span_is_forgotten),
        cmocka_unit_test(share_is_the_time_since_the_last_movement),
        cmocka_unit_test(a_gap_or_a_step_backwards_starts_anew),
        cmocka_unit_test(fast_samples_still_fill_the_span),
        cmocka_unit_test(median_ignores_a_glitch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
