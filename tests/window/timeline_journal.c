/* What the inputs did lately, what of it is kept, and how long takes are called. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "window/timeline/timeline.h"

static const mrt_channel channels[2] = {{"a", "rad", 1, 1, 0, 2}, {"b", "rad", 2, 1, 0, 2}};

static void note(timeline_journal *j, int64_t at_ms, float value)
{
    mrt_sample sample = {.count = 2, .value = {value, value}};
    timeline_journal_note(j, 0, at_ms * NS_PER_MS, &sample, channels);
}

static float read(const timeline_journal *j, int64_t from_ms, int64_t to_ms)
{
    return timeline_journal_read(j, 0, from_ms * NS_PER_MS, to_ms * NS_PER_MS);
}

static void movement_is_seen_when_it_was_and_stillness_is_not(void **state)
{
    (void)state;
    timeline_journal *j = timeline_journal_create();
    assert_non_null(j);
    for (int64_t ms = 0; ms < 5000; ms += 16)
        note(j, ms, ms >= 2000 && ms < 3000 ? (float)ms * 1e-3f : ms < 2000 ? 2.0f : 3.0f);
    assert_float_equal(read(j, 0, 1900), 0.0f, 1e-6f);
    assert_true(read(j, 2000, 3000) > 0.3f);
    assert_float_equal(read(j, 3200, 5000), 0.0f, 1e-6f);
    assert_float_equal(read(j, 9000, 9900), 0.0f, 1e-6f);
    timeline_journal_destroy(j);
}

static void it_keeps_half_an_hour_and_forgets_what_is_older(void **state)
{
    (void)state;
    timeline_journal *j = timeline_journal_create();
    assert_non_null(j);
    note(j, 0, 0.0f);
    note(j, 50, 1.0f);
    note(j, 1799000, 1.0f);
    assert_true(read(j, 0, 100) > 0.5f);
    note(j, 1801000, 1.0f);
    assert_float_equal(read(j, 0, 100), 0.0f, 1e-6f);
    note(j, 99000000, 1.0f); /* a day later */
    assert_float_equal(read(j, 0, 99000000), 0.0f, 1e-6f);
    timeline_journal_destroy(j);
}

static void values_that_are_no_numbers_are_no_movement(void **state)
{
    (void)state;
    timeline_journal *j = timeline_journal_create();
    assert_non_null(j);
    note(j, 0, 0.0f);
    note(j, 10, 0.0f / (float)(j == NULL)); /* NaN */
    note(j, 20, 0.0f);
    assert_float_equal(read(j, 0, 100), 0.0f, 1e-6f);
    timeline_journal_destroy(j);
}

static bool keeps(int64_t from_ns, int64_t to_ns, int64_t kept_from_ns, int64_t kept_to_ns)
{
    const int64_t s = NS_PER_S, now_ns = 1000 * s;
    from_ns += now_ns;
    to_ns += now_ns;
    return timeline_keep_span(&from_ns, &to_ns, now_ns, 60 * s) &&
           from_ns == now_ns + kept_from_ns && to_ns == now_ns + kept_to_ns;
}

static void a_span_that_is_swiped_is_kept(void **state)
{
    (void)state;
    const int64_t s = NS_PER_S;
    assert_true(keeps(-20 * s, -5 * s, -20 * s, -5 * s));
    assert_true(keeps(-5 * s, -20 * s, -20 * s, -5 * s));
    assert_true(keeps(-20 * s, 3 * s, -20 * s, 0));
    assert_true(keeps(-90 * s, -5 * s, -60 * s, -5 * s));
    int64_t from_ns = 20 * s, to_ns = 20 * s + 1000;
    assert_false(timeline_keep_span(&from_ns, &to_ns, 1000 * s, 1800 * s));
}

static void durations_are_short(void **state)
{
    (void)state;
    static const struct {
        int64_t ns;
        const char *text;
    } cases[] = {{0, "0.0 s"},
                 {3440 * NS_PER_MS, "3.4 s"},
                 {19990 * NS_PER_MS, "20.0 s"},
                 {59999 * NS_PER_MS, "1:00"},
                 {60 * NS_PER_S, "1:00"},
                 {3599 * NS_PER_S, "59:59"},
                 {3723 * NS_PER_S, "1:02:03"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[24];
        timeline_takes_duration(text, sizeof text, cases[i].ns);
        assert_string_equal(text, cases[i].text);
    }
}

static void words_are_found_in_title_and_note_in_any_case(void **state)
{
    (void)state;
    app_take_line line = {.title = "1/a 3 Night Ride", .note = "breath before the line"};
    assert_true(timeline_takes_matches(&line, ""));
    assert_true(timeline_takes_matches(&line, "ride BREATH"));
    assert_false(timeline_takes_matches(&line, "ride breathe"));
}

/* Also when it gets another place in the list, and when more come and go than there are lanes. */
static void a_history_is_that_of_its_input(void **state)
{
    (void)state;
    timeline_journal *j = timeline_journal_create();
    assert_non_null(j);
    note(j, 0, 0.0f);
    note(j, 50, 1.0f);
    assert_true(read(j, 0, 100) > 0.0f);
    mrt_sample still = {.count = 1};
    for (uint64_t other = 1; other < 3 * JOURNAL_LANES; ++other) {
        timeline_journal_note(j, other, (100 + 100 * (int64_t)other) * NS_PER_MS, &still, channels);
        assert_true(timeline_journal_read(j, other, 0, 100 * NS_PER_MS) <= 0.0f);
        assert_true(other >= JOURNAL_LANES || read(j, 0, 100) > 0.0f);
    }
    timeline_journal_destroy(j);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(movement_is_seen_when_it_was_and_stillness_is_not),
        cmocka_unit_test(it_keeps_half_an_hour_and_forgets_what_is_older),
        cmocka_unit_test(values_that_are_no_numbers_are_no_movement),
        cmocka_unit_test(a_history_is_that_of_its_input),
        cmocka_unit_test(a_span_that_is_swiped_is_kept),
        cmocka_unit_test(durations_are_short),
        cmocka_unit_test(words_are_found_in_title_and_note_in_any_case),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
