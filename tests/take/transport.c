/* stage/playback/transport.h: where one is on a timeline. */
#include "stage/playback/transport.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const int64_t S = 1000000000;

static void it_stands_until_it_plays_and_stops_at_the_end(void **state)
{
    (void)state;
    transport t;
    transport_init(&t, 10 * S);
    assert_int_equal(transport_at(&t, 100 * S).at_ns, 0);
    transport_play(&t, 100 * S);
    assert_int_equal(transport_at(&t, 104 * S + 7).at_ns, 4 * S + 7);
    assert_false(transport_at(&t, 104 * S).has_stopped);
    assert_int_equal(transport_at(&t, 120 * S).at_ns, 10 * S);
    assert_true(transport_at(&t, 120 * S).has_stopped);
    transport_play(&t, 121 * S); /* again, from the start */
    assert_int_equal(transport_at(&t, 122 * S).at_ns, 1 * S);
}

static void no_change_makes_it_jump(void **state)
{
    (void)state;
    transport t;
    int64_t clock = 0;
    transport_init(&t, 1000 * S);
    transport_play(&t, clock);
    uint32_t seed = 7;
    for (int i = 0; i < 2000; ++i) {
        seed = seed * 1664525u + 1013904223u;
        clock += (int64_t)(seed >> 4);
        int64_t before = transport_at(&t, clock).at_ns;
        switch (seed % 4) {
        case 0:
            assert_true(transport_set_speed(&t, clock, 0.1 + (double)(seed % 390) / 100.0));
            break;
        case 1:
            transport_pause(&t, clock);
            break;
        case 2:
            if (!transport_at(&t, clock).has_stopped)
                transport_play(&t, clock);
            break;
        default:
            transport_end_loop(&t, clock);
        }
        assert_int_equal(transport_at(&t, clock).at_ns, before);
    }
}

static void speeds_outside_a_tenth_to_four_are_refused(void **state)
{
    (void)state;
    transport t;
    transport_init(&t, S);
    assert_false(transport_set_speed(&t, 0, 0.09));
    assert_false(transport_set_speed(&t, 0, 4.1));
    assert_true(transport_set_speed(&t, 0, 0.1));
    transport_play(&t, 0);
    assert_int_equal(transport_at(&t, S).at_ns, S / 10);
}

/* Whoever stands at the range's end and plays wants to hear the range. */
static void a_loop_that_is_played_from_its_end_begins_at_its_start(void **state)
{
    (void)state;
    transport t;
    transport_init(&t, 10 * S);
    assert_true(transport_set_loop(&t, 0, 2 * S, 5 * S));
    transport_seek(&t, 0, 5 * S);
    transport_play(&t, 0);
    assert_int_equal(transport_at(&t, S).at_ns, 3 * S);
    assert_int_equal(transport_at(&t, 4 * S).at_ns, 3 * S);
}

static void a_loop_goes_back_exactly_and_counts_its_passes(void **state)
{
    (void)state;
    transport t;
    transport_init(&t, 10 * S);
    assert_false(transport_set_loop(&t, 0, 3 * S, 3 * S));
    assert_true(transport_set_loop(&t, 0, 2 * S, 5 * S));
    transport_play(&t, 0);
    assert_int_equal(transport_at(&t, 5 * S - 1).at_ns, 5 * S - 1);
    assert_int_equal(transport_at(&t, 5 * S).at_ns, 2 * S);
    assert_int_equal(transport_at(&t, 5 * S).pass, 1);
    assert_int_equal(transport_at(&t, 12 * S + 5).at_ns, 3 * S + 5);
    assert_int_equal(transport_at(&t, 12 * S + 5).pass, 3);
    transport_set_speed(&t, 12 * S, 2.0);
    assert_int_equal(transport_at(&t, 13 * S).at_ns, 2 * S);
    assert_int_equal(transport_at(&t, 13 * S).pass, 4);
}

static void steps_stop_on_the_starts_of_frames(void **state)
{
    (void)state;
    timecode_rate rate;
    error err = {""};
    transport t;
    assert_int_equal(timecode_rate_of(&rate, 29.97, &err), MRT_OK);
    transport_init(&t, 100 * S);
    transport_seek(&t, 0, 50 * S);
    transport_play(&t, 0);
    transport_step_frames(&t, S / 2, rate, 1);
    assert_false(t.is_playing);
    int64_t at = transport_at(&t, 9 * S).at_ns;
    assert_int_equal(at, timecode_time_ns(rate, timecode_frame(rate, 50 * S + S / 2) + 1));
    transport_step_frames(&t, 9 * S, rate, -1);
    assert_true(transport_at(&t, 9 * S).at_ns < at);
    transport_step_frames(&t, 9 * S, rate, -100000);
    assert_int_equal(transport_at(&t, 9 * S).at_ns, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_stands_until_it_plays_and_stops_at_the_end),
        cmocka_unit_test(no_change_makes_it_jump),
        cmocka_unit_test(speeds_outside_a_tenth_to_four_are_refused),
        cmocka_unit_test(a_loop_goes_back_exactly_and_counts_its_passes),
        cmocka_unit_test(a_loop_that_is_played_from_its_end_begins_at_its_start),
        cmocka_unit_test(steps_stop_on_the_starts_of_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
