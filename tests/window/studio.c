/* The studio without a window: what is recorded, played and exported. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "studio_room.h"
#include "window/studio_export.h"

#include <sys/stat.h>

/* ---- recording ---- */

static void a_take_that_ends_is_chosen_and_the_stage_stays_live(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    assert_int_equal(count_takes(r.studio), 1);
    assert_non_null(studio_take(r.studio));
    assert_true(studio_take(r.studio)->duration_ns > 200 * NS_PER_MS);
    assert_int_equal(studio_view(r.studio)->mode, LIVE_PERFORMS);
    close_room(&r);
}

static void a_take_that_is_recorded_is_in_the_list_while_it_grows(void **state)
{
    room r;
    const studio_take_line *line;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    assert_true(until(&r, is_recording));
    assert_int_equal(studio_takes(r.studio, &line), 1);
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
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    studio_destroy(r.studio);
    const studio_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    const studio_take_line *line;
    assert_int_equal(studio_takes(r.studio, &line), 1);
    assert_true(line[0].duration_ns > 200 * NS_PER_MS);
    close_room(&r);
}

static void what_nobody_recorded_can_be_kept(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    studio_do(r.studio, ACTION_KEEP);
    assert_true(until(&r, has_ended));
    assert_int_equal(count_takes(r.studio), 1);
    assert_true(was_said(r.studio, "kept the last"));
    close_room(&r);
}

static bool has_two_takes(studio *of)
{
    return count_takes(of) == 2;
}

/* Whole, both of them, and as long as they were. */
static bool has_two_whole_takes(studio *of)
{
    const studio_take_line *line;
    return studio_takes(of, &line) == 2 && !line[0].is_recording && !line[1].is_recording &&
           line[0].duration_ns > 200 * NS_PER_MS && line[1].duration_ns > 200 * NS_PER_MS;
}

static void keeping_while_recording_leaves_the_recording_alone(void **state)
{
    room r;
    const studio_take_line *line;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    studio_do(r.studio, ACTION_KEEP);
    assert_true(until(&r, has_two_takes));
    assert_true(until(&r, is_recording));
    (void)studio_takes(r.studio, &line);
    assert_true(line[0].is_recording);
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, has_two_whole_takes));
    close_room(&r);
}

static bool has_a_third_beside_whole_ones(studio *of)
{
    const studio_take_line *line;
    const uint32_t count = studio_takes(of, &line);
    assert_false(line[0].is_recording || line[1].is_recording);
    return count == 3;
}

static void what_is_performed_over_a_take_leaves_others_in_the_list(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    studio_do(r.studio, ACTION_KEEP);
    assert_true(until(&r, has_two_whole_takes));
    studio_do(r.studio, ACTION_TAKE_BEFORE);
    assert_true(until(&r, shows_take));
    studio_do(r.studio, ACTION_RECORD);
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
    studio_do(r.studio, ACTION_PLAY);
    assert_true(until(&r, shows_take));
    assert_true(live_transport(studio_live(r.studio))->is_playing);
    studio_do(r.studio, ACTION_PLAY);
    assert_false(live_transport(studio_live(r.studio))->is_playing);
    studio_do(r.studio, ACTION_STOP);
    assert_int_equal(live_place(studio_live(r.studio)).at_ns, 0);
    studio_do(r.studio, ACTION_FRAME_FORWARD);
    assert_true(live_place(studio_live(r.studio)).at_ns > 0);
    studio_do(r.studio, ACTION_FASTER);
    assert_float_equal(live_transport(studio_live(r.studio))->speed, 1.5, 1e-9);
    studio_do(r.studio, ACTION_LOOP);
    assert_true(live_transport(studio_live(r.studio))->is_looping);
    studio_do(r.studio, ACTION_LIVE);
    assert_int_equal(live_shown_take(studio_live(r.studio)), 0);
    close_room(&r);
}

static bool performs_over(studio *of)
{
    return studio_view(of)->is_recording_over && studio_view(of)->at_ns > 150 * NS_PER_MS;
}

static bool has_two_layers(studio *of)
{
    return studio_take(of) && studio_take(of)->layer_count == 2;
}

static void what_is_performed_over_a_take_becomes_a_layer_in_one_step(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t id = studio_take_id(r.studio);
    assert_int_equal(studio_take(r.studio)->layer_count, 1);
    assert_int_equal(studio_choose_take(r.studio, id), MRT_OK);
    assert_true(until(&r, shows_take));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, performs_over));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, has_two_layers));
    assert_int_equal(studio_take_id(r.studio), id);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(studio_take(r.studio)->layer_count, 1);
    studio_do(r.studio, ACTION_REDO);
    assert_int_equal(studio_take(r.studio)->layer_count, 2);
    close_room(&r);
}

static void what_cannot_be_done_says_why(void **state)
{
    room r;
    const char *why = NULL;
    (void)state;
    open_room(&r, false);
    assert_false(studio_can(r.studio, ACTION_PLAY, &why));
    assert_string_equal(why, "no take is chosen");
    assert_false(studio_can(r.studio, ACTION_SPLIT, &why));
    assert_false(studio_can(r.studio, ACTION_UNDO, &why));
    assert_string_equal(why, "there is nothing to undo");
    studio_do(r.studio, ACTION_UNDO);
    assert_true(was_said(r.studio, "nothing to undo"));
    assert_true(studio_can(r.studio, ACTION_HELP, &why));
    assert_string_equal(why, "");
    close_room(&r);
}

/* ---- export ---- */

static bool exports_are_over(studio *of)
{
    return studio_exports_going(of) == 0;
}

static void a_take_is_exported_beside_the_stage(void **state)
{
    room r;
    export_wish wish = {.fps = 25.0};
    struct stat info;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    (void)snprintf(wish.file, sizeof wish.file, "%s/take.pc2", r.folder);
    assert_int_equal(studio_export_take(r.studio, &wish), MRT_OK);
    assert_true(until(&r, exports_are_over));
    if (stat(wish.file, &info) != 0) {
        const news_list *news = studio_news(r.studio);
        fail_msg("%s", news_list_at(news, news_list_count(news) - 1)->text);
    }
    assert_true(was_said(r.studio, "exported"));
    (void)snprintf(wish.file, sizeof wish.file, "%s/take.nonsense", r.folder);
    assert_int_equal(studio_export_take(r.studio, &wish), MRT_OK);
    assert_true(until(&r, exports_are_over));
    assert_true(was_said(r.studio, "was not exported"));
    close_room(&r);
}

static bool export_is_told(studio *of)
{
    return studio_exports_going(of) == 0 || studio_export_now(of, 0).done > 0.0;
}

static void an_export_says_how_far_it_is_and_is_cancelled(void **state)
{
    room r;
    export_wish wish = {.fps = 60.0};
    struct stat info;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    (void)snprintf(wish.file, sizeof wish.file, "%s/pictures/", r.folder);
    assert_int_equal(studio_export_take(r.studio, &wish), MRT_OK);
    assert_int_equal(studio_exports_going(r.studio), 1);
    assert_string_equal(studio_export_now(r.studio, 0).file, wish.file);
    assert_true(until(&r, export_is_told));
    if (studio_exports_going(r.studio) == 0) { /* nothing can be drawn here */
        close_room(&r);
        skip();
    }
    assert_string_equal(studio_export_now(r.studio, 0).doing, "performing");
    studio_cancel_export(r.studio, 0);
    assert_true(until(&r, exports_are_over));
    assert_true(was_said(r.studio, "was cancelled"));
    assert_int_not_equal(stat(wish.file, &info), 0);
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
        cmocka_unit_test(a_take_is_exported_beside_the_stage),
        cmocka_unit_test(an_export_says_how_far_it_is_and_is_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
