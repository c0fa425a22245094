/* When a frame is due, and which frame handles an event. Pure: the test gives the time. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "base/clock.h"
#include "window/gui/pace.h"

static void an_event_that_ends_a_rest_waits_for_the_next_frame(void **state)
{
    (void)state;
    pace of;
    pace_init(&of);
    assert_false(pace_begin(&of, PACE_SETTLING, false, 1 * NS_PER_S));
    assert_true(pace_begin(&of, PACE_EVENT, true, 2 * NS_PER_S));
    assert_false(pace_begin(&of, PACE_EVENT, false, 2 * NS_PER_S + NS_PER_MS));
}

static void a_slow_window_handles_the_events_of_each_frame(void **state)
{
    (void)state;
    const int64_t frame_ns = 200 * NS_PER_MS;
    pace of;
    pace_init(&of);
    assert_false(pace_begin(&of, PACE_SETTLING, false, frame_ns));
    for (int64_t frame = 2; frame < 10; ++frame) /* the pointer moves during each frame */
        assert_false(pace_begin(&of, PACE_EVENT, false, frame * frame_ns));
}

static void a_window_at_rest_looks_twice_a_second(void **state)
{
    (void)state;
    pace of;
    pace_init(&of);
    (void)pace_begin(&of, PACE_LOOK, true, NS_PER_S);
    assert_int_equal(pace_due(&of, NS_PER_S + 499 * NS_PER_MS, false), PACE_NOT_DUE);
    assert_int_equal(pace_due(&of, NS_PER_S + 500 * NS_PER_MS, false), PACE_LOOK);
    pace_ask(&of, NS_PER_S + 100 * NS_PER_MS);
    assert_int_equal(pace_until_ns(&of), NS_PER_S + 100 * NS_PER_MS);
    assert_int_equal(pace_due(&of, NS_PER_S + 100 * NS_PER_MS, false), PACE_ASKED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_event_that_ends_a_rest_waits_for_the_next_frame),
        cmocka_unit_test(a_slow_window_handles_the_events_of_each_frame),
        cmocka_unit_test(a_window_at_rest_looks_twice_a_second),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
