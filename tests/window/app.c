/* The application without a window: what is recorded and played. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "app_fixture.h"

/* ---- recording ---- */

static void a_take_that_ends_is_chosen_and_the_stage_stays_live(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    assert_int_equal(count_takes(r.app), 1);
    assert_non_null(app_take(r.app));
    assert_true(app_take(r.app)->duration_ns > 200 * NS_PER_MS);
    assert_int_equal(app_view(r.app)->mode, LIVE_PERFORMS);
    close_room(&r);
}

static void a_take_that_is_recorded_is_in_the_list_while_it_grows(void **state)
{
    room r;
    const app_take_line *line;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    app_do(r.app, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    assert_true(until(&r, is_recording));
    assert_int_equal(app_takes(r.app, &line), 1);
    assert_true(line[0].is_recording);
    assert_true(line[0].duration_ns > 0);
    close_room(&r);
}

static void closing_while_recording_keeps_the_take(void **state)
{
    room r;
    error err = {0};
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    app_do(r.app, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    app_destroy(r.app);
    const app_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    const app_take_line *line;
    assert_int_equal(app_takes(r.app, &line), 1);
    assert_true(line[0].duration_ns > 200 * NS_PER_MS);
    close_room(&r);
}

static void what_nobody_recorded_can_be_kept(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    app_do(r.app, ACTION_KEEP);
    assert_true(until(&r, has_ended));
    assert_int_equal(count_takes(r.app), 1);
    assert_true(was_said(r.app, "kept "));
    close_room(&r);
}

static bool has_two_takes(app *of)
{
    return count_takes(of) == 2;
}

/* Whole, both of them, and as long as they were. */
static bool has_two_whole_takes(app *of)
{
    const app_take_line *line;
    return app_takes(of, &line) == 2 && !line[0].is_recording && !line[1].is_recording &&
           line[0].duration_ns > 200 * NS_PER_MS && line[1].duration_ns > 200 * NS_PER_MS;
}

static void keeping_while_recording_leaves_the_recording_alone(void **state)
{
    room r;
    const app_take_line *line;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    app_do(r.app, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    app_do(r.app, ACTION_KEEP);
    assert_true(until(&r, has_two_takes));
    assert_true(until(&r, is_recording));
    (void)app_takes(r.app, &line);
    assert_true(line[0].is_recording);
    app_do(r.app, ACTION_RECORD);
    assert_true(until(&r, has_two_whole_takes));
    close_room(&r);
}

static bool has_a_third_beside_whole_ones(app *of)
{
    const app_take_line *line;
    const uint32_t count = app_takes(of, &line);
    assert_false(line[0].is_recording || line[1].is_recording);
    return count == 3;
}

static void what_is_performed_over_a_take_leaves_others_in_the_list(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    app_do(r.app, ACTION_KEEP);
    assert_true(until(&r, has_two_whole_takes));
    app_do(r.app, ACTION_TAKE_BEFORE);
    assert_true(until(&r, shows_take));
    app_do(r.app, ACTION_RECORD);
    assert_true(until(&r, has_a_third_beside_whole_ones));
    close_room(&r);
}

/* ---- playing ---- */

static void space_shows_the_chosen_take_and_plays_it(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    app_do(r.app, ACTION_PLAY);
    assert_true(until(&r, shows_take));
    assert_true(live_transport(app_live(r.app))->is_playing);
    app_do(r.app, ACTION_PLAY);
    assert_false(live_transport(app_live(r.app))->is_playing);
    app_do(r.app, ACTION_STOP);
    assert_int_equal(live_position(app_live(r.app)).at_ns, 0);
    app_do(r.app, ACTION_FRAME_FORWARD);
    assert_true(live_position(app_live(r.app)).at_ns > 0);
    app_do(r.app, ACTION_FASTER);
    assert_float_equal(live_transport(app_live(r.app))->speed, 1.5, 1e-9);
    app_do(r.app, ACTION_LOOP);
    assert_true(live_transport(app_live(r.app))->is_looping);
    app_do(r.app, ACTION_LIVE);
    assert_int_equal(live_shown_take(app_live(r.app)), 0);
    close_room(&r);
}

static bool performs_over(app *of)
{
    return app_view(of)->is_recording_over && app_view(of)->at_ns > 150 * NS_PER_MS;
}

static bool has_two_layers(app *of)
{
    return app_take(of) && app_take(of)->layer_count == 2;
}

static void what_is_performed_over_a_take_becomes_a_layer_in_one_step(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t id = app_take_id(r.app);
    assert_int_equal(app_take(r.app)->layer_count, 1);
    assert_int_equal(app_choose_take(r.app, id), MRT_OK);
    assert_true(until(&r, shows_take));
    app_do(r.app, ACTION_RECORD);
    assert_true(until(&r, performs_over));
    app_do(r.app, ACTION_RECORD);
    assert_true(until(&r, has_two_layers));
    assert_int_equal(app_take_id(r.app), id);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(app_take(r.app)->layer_count, 1);
    app_do(r.app, ACTION_REDO);
    assert_int_equal(app_take(r.app)->layer_count, 2);
    close_room(&r);
}

static void what_cannot_be_done_says_why(void **state)
{
    room r;
    const char *why = NULL;
    (void)state;
    open_room(&r, false);
    assert_false(app_can(r.app, ACTION_PLAY, &why));
    assert_string_equal(why, "no take is selected");
    assert_false(app_can(r.app, ACTION_SPLIT, &why));
    assert_false(app_can(r.app, ACTION_UNDO, &why));
    assert_string_equal(why, "nothing to undo");
    app_do(r.app, ACTION_UNDO);
    assert_true(was_said(r.app, "nothing to undo"));
    assert_true(app_can(r.app, ACTION_HELP, &why));
    assert_string_equal(why, "");
    close_room(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_take_that_ends_is_chosen_and_the_stage_stays_live),
        cmocka_unit_test(a_take_that_is_recorded_is_in_the_list_while_it_grows),
        cmocka_unit_test(closing_while_recording_keeps_the_take),
        cmocka_unit_test(what_nobody_recorded_can_be_kept),
        cmocka_unit_test(keeping_while_recording_leaves_the_recording_alone),
        cmocka_unit_test(what_is_performed_over_a_take_leaves_others_in_the_list),
        cmocka_unit_test(space_shows_the_chosen_take_and_plays_it),
        cmocka_unit_test(what_is_performed_over_a_take_becomes_a_layer_in_one_step),
        cmocka_unit_test(what_cannot_be_done_says_why),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
