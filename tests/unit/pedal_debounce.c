/* pedal/learn.h: one edge for a chatter, and the first one at once. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "learn.h"

static const int64_t MS = 1000000;
static const int64_t WINDOW = 8 * 1000000;

static bool take(debounce *d, float first, int64_t time_ms)
{
    const float value[DEBOUNCE_SWITCHES] = {first};
    return debounce_update(d, value, 0, time_ms * MS, WINDOW);
}

static void the_first_edge_passes_at_once(void **state)
{
    (void)state;
    debounce d;
    debounce_reset(&d);
    assert_false(take(&d, 0, 1));
    assert_true(take(&d, 1, 2));
    assert_float_equal(d.shown[0], 1, 0);
    assert_true(debounce_due_ns(&d) == INT64_MAX);
}

static void chatter_after_a_press_is_not_shown(void **state)
{
    (void)state;
    debounce d;
    debounce_reset(&d);
    assert_true(take(&d, 1, 0));
    for (int64_t ms = 1; ms < 8; ++ms) {
        assert_false(take(&d, (float)(ms % 2 == 0), ms));
        assert_float_equal(d.shown[0], 1, 0);
    }
    assert_true(debounce_due_ns(&d) == 8 * MS);
    assert_false(take(&d, 1, 7)); /* it was only chatter */
    assert_true(debounce_due_ns(&d) == INT64_MAX);
    assert_false(debounce_settle(&d, 8 * MS, WINDOW));
}

static void a_tap_shorter_than_the_window_is_let_go_at_its_end(void **state)
{
    (void)state;
    debounce d;
    debounce_reset(&d);
    assert_true(take(&d, 1, 100));
    assert_false(take(&d, 0, 103));
    assert_false(debounce_settle(&d, 108 * MS - 1, WINDOW));
    assert_true(debounce_settle(&d, 108 * MS, WINDOW));
    assert_float_equal(d.shown[0], 0, 0);
    assert_false(take(&d, 1, 112)); /* and this edge has a window too */
    assert_true(debounce_due_ns(&d) == 116 * MS);
}

static void an_edge_after_the_window_passes_at_once(void **state)
{
    (void)state;
    debounce d;
    debounce_reset(&d);
    assert_true(take(&d, 1, 0));
    assert_true(take(&d, 0, 8));
    assert_true(take(&d, 1, 16));
}

static void switches_do_not_wait_for_each_other(void **state)
{
    (void)state;
    debounce d;
    debounce_reset(&d);
    const float first[] = {1, 0, 0, 0}, both[] = {0, 1, 0, 0};
    assert_true(debounce_update(&d, first, 0, 0, WINDOW));
    assert_true(debounce_update(&d, both, 0, 3 * MS, WINDOW));
    assert_float_equal(d.shown[0], 1, 0);
    assert_float_equal(d.shown[1], 1, 0);
    assert_true(debounce_due_ns(&d) == 8 * MS);
}

static void analogue_pedals_are_not_held_back(void **state)
{
    (void)state;
    debounce d;
    debounce_reset(&d);
    for (int i = 1; i <= 10; ++i) {
        const float value[] = {0, (float)i / 10, 0, 0};
        assert_true(debounce_update(&d, value, 2, i * MS, WINDOW));
        assert_float_equal(d.shown[1], value[1], 0);
        assert_true(debounce_due_ns(&d) == INT64_MAX);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_edge_passes_at_once),
        cmocka_unit_test(chatter_after_a_press_is_not_shown),
        cmocka_unit_test(a_tap_shorter_than_the_window_is_let_go_at_its_end),
        cmocka_unit_test(an_edge_after_the_window_passes_at_once),
        cmocka_unit_test(switches_do_not_wait_for_each_other),
        cmocka_unit_test(analogue_pedals_are_not_held_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
