/* core/show/take.h: copies own what they hold, and time through a warp is exact. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show/take.h"

#include <stdlib.h>
#include <string.h>

static void warp_of_one_point_shifts(void **state)
{
    (void)state;
    take_warp_point point = {.at_ns = 2000, .source_ns = 500};
    take_clip clip = {.warp_count = 1, .warp = &point};
    assert_int_equal(take_warp_to_source(&clip, 2000), 500);
    assert_int_equal(take_warp_to_source(&clip, 0), -1500);
    assert_int_equal(take_warp_to_timeline(&clip, 501), 2001);
}

static void warp_goes_on_at_its_end_slopes(void **state)
{
    (void)state;
    take_warp_point point[] = {{0, 0}, {100, 200}, {200, 250}};
    take_clip clip = {.warp_count = 3, .warp = point};
    assert_int_equal(take_warp_to_source(&clip, -10), -20);
    assert_int_equal(take_warp_to_source(&clip, 50), 100);
    assert_int_equal(take_warp_to_source(&clip, 100), 200);
    assert_int_equal(take_warp_to_source(&clip, 150), 225);
    assert_int_equal(take_warp_to_source(&clip, 300), 300);
    assert_int_equal(take_warp_to_timeline(&clip, -20), -10);
    assert_int_equal(take_warp_to_timeline(&clip, 300), 300);
}

static void source_is_rounded_down_and_timeline_up(void **state)
{
    (void)state;
    take_warp_point point[] = {{0, 0}, {3, 2}};
    take_clip clip = {.warp_count = 2, .warp = point};
    assert_int_equal(take_warp_to_source(&clip, 1), 0);
    assert_int_equal(take_warp_to_source(&clip, 2), 1);
    assert_int_equal(take_warp_to_source(&clip, -1), -1);
    assert_int_equal(take_warp_to_timeline(&clip, 1), 2);
    assert_int_equal(take_warp_to_timeline(&clip, -1), -1);
}

/* The first instant that shows a sample: there it has been reached, and one ns earlier it has not.
 */
static void timeline_is_the_first_instant_of_a_source_time(void **state)
{
    (void)state;
    const int64_t hour_ns = 3600 * (int64_t)1000000000;
    take_warp_point point[] = {{-5, -7}, {1000003, 700001}, {8 * hour_ns, 9 * hour_ns + 1}};
    take_clip clip = {.warp_count = 3, .warp = point};
    uint64_t random = 7;
    for (int i = 0; i < 20000; ++i) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        int64_t source_ns = (int64_t)(random >> 17) % (12 * hour_ns) - hour_ns;
        int64_t at_ns = take_warp_to_timeline(&clip, source_ns);
        assert_true(take_warp_to_source(&clip, at_ns) >= source_ns);
        assert_true(take_warp_to_source(&clip, at_ns - 1) < source_ns);
    }
}

static void warp_saturates_instead_of_overflowing(void **state)
{
    (void)state;
    take_warp_point point[] = {{0, 0}, {1, INT64_MAX}};
    take_clip clip = {.warp_count = 2, .warp = point};
    assert_int_equal(take_warp_to_source(&clip, 1), INT64_MAX);
    assert_int_equal(take_warp_to_source(&clip, INT64_MAX), INT64_MAX);
    assert_int_equal(take_warp_to_source(&clip, INT64_MIN), INT64_MIN);
    assert_int_equal(take_warp_to_timeline(&clip, INT64_MAX), 1);
}

static void copy_shares_nothing(void **state)
{
    (void)state;
    take t = {.id = 7, .layer_count = 1, .marker_count = 1};
    t.marker = calloc(1, sizeof *t.marker);
    t.layer = calloc(1, sizeof *t.layer);
    t.layer->own_count = 1;
    t.layer->own = calloc(1, sizeof *t.layer->own);
    strcpy(t.layer->own[0], "jaw.*");
    t.layer->clip_count = 1;
    t.layer->clip = calloc(1, sizeof *t.layer->clip);
    t.layer->clip->warp_count = 1;
    t.layer->clip->warp = calloc(1, sizeof *t.layer->clip->warp);
    t.layer->clip->warp->source_ns = 11;
    take copy;
    assert_int_equal(take_copy(&copy, &t, NULL), MRT_OK);
    take_finish(&t);
    take_finish(&t);
    assert_int_equal(copy.id, 7);
    assert_string_equal(copy.layer[0].own[0], "jaw.*");
    assert_int_equal(copy.layer[0].clip[0].warp[0].source_ns, 11);
    take_finish(&copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(warp_of_one_point_shifts),
        cmocka_unit_test(warp_goes_on_at_its_end_slopes),
        cmocka_unit_test(source_is_rounded_down_and_timeline_up),
        cmocka_unit_test(timeline_is_the_first_instant_of_a_source_time),
        cmocka_unit_test(warp_saturates_instead_of_overflowing),
        cmocka_unit_test(copy_shares_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
