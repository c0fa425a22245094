/* plugins/cyberglove against the emulated glove: samples carry the time at which they were
 * measured, though the line delivers them late and in bunches. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "glove_session.h"

enum { RATE_HZ = 150, MEASURED_S = 3 };

/* The error once the clocks have met, which takes the first second. Where nobody has told the rate,
 * it is learned from bunches first. */
enum { SETTLED_S = 1, LEARNED_S = 3 };

static glove_spread late_error_of(const char *const *options, const char *params, uint32_t from_s,
                                  int64_t late_ns)
{
    glove_session s;
    glove_truth truth;
    session_begin(&s, options);
    session_open(&s, params);
    virtual_clock_be_late(late_ns);
    assert_true(session_take(&s, (from_s + MEASURED_S) * RATE_HZ, 20));
    session_read_truth(&s, &truth);
    for (uint32_t i = 1; i < s.count; ++i)
        assert_true(s.sample[i].time_ns >= s.sample[i - 1].time_ns);
    glove_spread spread = session_time_error(&s, &truth, from_s * RATE_HZ);
    print_message("  sample time error: mean %.3f, SD %.3f, %.3f .. %.3f ms\n", spread.mean,
                  spread.deviation, spread.least, spread.greatest);
    glove_truth_finish(&truth);
    session_end(&s);
    return spread;
}

static glove_spread error_of(const char *const *options, const char *params, uint32_t from_s)
{
    return late_error_of(options, params, from_s, 0);
}

static void stamped_samples_are_timed_to_half_a_millisecond(void **state)
{
    (void)state;
    glove_spread spread = error_of(OPTIONS("--numbered"), "", SETTLED_S);
    assert_true(spread.deviation < 0.5);
    assert_true(spread.mean > -1.0 && spread.mean < 5.0); /* 2.6 ms on the wire */
}

static void bunches_of_16_ms_do_not_show_with_stamps(void **state)
{
    (void)state;
    glove_spread spread = error_of(OPTIONS("--numbered", "--latency-ms", "16"), "", SETTLED_S);
    assert_true(spread.deviation < 0.5);
    assert_true(spread.mean > -1.0 && spread.mean < 12.0);
    spread = error_of(OPTIONS("--numbered", "--latency-ms", "16", "--packet-bytes", "62"), "",
                      SETTLED_S);
    assert_true(spread.deviation < 0.5);
}

static void a_glove_clock_that_is_fast_is_followed(void **state)
{
    (void)state;
    glove_spread spread = error_of(OPTIONS("--numbered", "--drift-ppm", "80"), "", SETTLED_S);
    assert_true(spread.deviation < 0.5);
}

/* It reads late, by up to three records. */
static void a_busy_machine_does_not_show_with_stamps(void **state)
{
    (void)state;
    glove_spread spread = late_error_of(OPTIONS("--numbered"), "", SETTLED_S, 20 * NS_PER_MS);
    assert_true(spread.deviation < 0.5);
    assert_true(spread.mean > -1.0 && spread.mean < 5.0);
}

/* Without stamps the rate is all there is: the bunches are spread over it. */
static void bunches_without_stamps_are_spread(void **state)
{
    (void)state;
    glove_spread spread =
        error_of(OPTIONS("--numbered", "--latency-ms", "16"), "time_stamps=off", SETTLED_S);
    assert_true(spread.deviation < 2.5); /* 4.7 ms if taken as they come */
    spread =
        error_of(OPTIONS("--numbered", "--flavour", "cg2", "--latency-ms", "16"), "", LEARNED_S);
    assert_true(spread.deviation < 2.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stamped_samples_are_timed_to_half_a_millisecond),
        cmocka_unit_test(bunches_of_16_ms_do_not_show_with_stamps),
        cmocka_unit_test(a_glove_clock_that_is_fast_is_followed),
        cmocka_unit_test(a_busy_machine_does_not_show_with_stamps),
        cmocka_unit_test(bunches_without_stamps_are_spread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
