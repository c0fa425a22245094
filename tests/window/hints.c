/* What is written over the face and beside the pointer lies where it is in nobody's way, and says
 * what can be done. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const demo_inputs[] = {demo};
static const char taken[] = "A take is shown. Press L to go back to the live hands";

static bool has_samples(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->sample_count > 60;
}

static bool is_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording && app_status(s->app)->recorded_ns > 300 * NS_PER_MS;
}

static bool is_chosen(scene *s, void *data)
{
    (void)data;
    return !app_status(s->app)->is_recording && app_take_id(s->app) != 0;
}

static bool is_shown(scene *s, void *data)
{
    (void)data;
    return app_view(s->app)->mode == LIVE_SHOWS;
}

static bool has_other_take(scene *s, void *data)
{
    const int64_t *other_than = data;
    const int64_t chosen = app_take_id(s->app);
    return !app_status(s->app)->is_recording && chosen != 0 && chosen != *other_than;
}

static void record(scene *s)
{
    assert_true(scene_until(s, has_samples, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, is_recorded, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, is_chosen, NULL));
}

static void open_with_take(scene *s, uint32_t width_px, uint32_t height_px, float scale)
{
    const scene_options options = {.width_px = width_px,
                                   .height_px = height_px,
                                   .scale = scale,
                                   .inputs = demo_inputs,
                                   .input_count = 1};
    scene_open_with(s, &options);
    scene_let_cut(s, "demo_hand");
    record(s);
}

/* The middle of the picture of the face, with the timeline below and the panels beside it. */
static void point_at_face(scene *s)
{
    scene_move(s, 0.37f * s->width, 0.45f * s->height);
    scene_settle(s);
}

static void that_a_take_is_shown_is_said_at_the_edge_not_on_the_face(void **state)
{
    static const uint32_t size[2][2] = {{1280, 720}, {2560, 1440}};
    (void)state;
    for (uint32_t k = 0; k < 2; ++k) {
        scene s;
        open_with_take(&s, size[k][0], size[k][1], (float)(k + 1));
        assert_int_equal(app_choose_take(s.app, app_take_id(s.app)), MRT_OK);
        assert_true(scene_until(&s, is_shown, NULL));
        point_at_face(&s);
        const ui_word *word = scene_word(&s, taken);
        assert_non_null(word);
        assert_true(word->where.y + word->where.height < 0.15f * s.height);
        scene_look(&s, k == 0 ? "hints_taken" : "hints_taken_2x");
        scene_check_words(&s);
        scene_close(&s);
    }
}

static void page_up_goes_up_the_list_of_takes(void **state)
{
    scene s;
    (void)state;
    open_with_take(&s, 1280, 720, 1.0f);
    int64_t first = app_take_id(s.app);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recorded, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_other_take, &first));
    const int64_t second = app_take_id(s.app);
    const ui_word *upper = scene_word(&s, "2"), *lower = scene_word(&s, "1");
    assert_true(upper && lower && upper->where.y < lower->where.y); /* the newest on top */
    scene_key(&s, UI_KEY_PAGE_DOWN, 0);
    assert_int_equal(app_take_id(s.app), first);
    scene_key(&s, UI_KEY_PAGE_UP, 0);
    assert_int_equal(app_take_id(s.app), second);
    scene_close(&s);
}

static bool says(scene *s, void *data)
{
    return scene_word_with(s, data) != NULL;
}

static void a_take_is_duplicated_by_its_menu_and_by_its_key(void **state)
{
    scene s;
    const app_take_line *line;
    char words[] = "duplicate take 1";
    (void)state;
    open_with_take(&s, 1280, 720, 1.0f);
    const ui_word *word = scene_word(&s, "1");
    assert_non_null(word);
    scene_click_with(&s, word->where.x + 3.0f, word->where.y + 5.0f, 1);
    assert_non_null(scene_word(&s, "Duplicate"));
    scene_look(&s, "hints_duplicate");
    scene_check_words(&s);
    scene_click_word(&s, "Duplicate");
    assert_int_equal(app_takes(s.app, &line), 2);
    scene_key(&s, 'D', UI_CONTROL);
    assert_int_equal(app_takes(s.app, &line), 3);
    scene_do(&s, ACTION_UNDO);
    scene_do(&s, ACTION_UNDO);
    const ui_word *edits = scene_word(&s, "History"); /* redo is the sign before it */
    assert_non_null(edits);
    scene_move(&s, edits->where.x - 28.0f, edits->where.y + 6.0f);
    assert_true(scene_until(&s, says, words));
    scene_close(&s);
}

static void long_news_are_broken_in_two_and_can_be_read(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    news_list_add(app_news(s.app), MRT_LOG_WARNING, "pedal usb:1-2",
                  "VEC USB Footpedal at usb:1-2 went away (No such device (it may have been "
                  "disconnected)): plug it in again; the pose is held, and it is looked for");
    scene_frames(&s, 3);
    const ui_word *first = scene_word_with(&s, "VEC USB Footpedal"),
                  *second = scene_word_with(&s, "looked for");
    assert_true(first && second && first != second);
    assert_true(second->where.y > first->where.y + 10.0f);
    scene_look(&s, "hints_news");
    scene_check_words(&s);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(that_a_take_is_shown_is_said_at_the_edge_not_on_the_face),
        cmocka_unit_test(page_up_goes_up_the_list_of_takes),
        cmocka_unit_test(a_take_is_duplicated_by_its_menu_and_by_its_key),
        cmocka_unit_test(long_news_are_broken_in_two_and_can_be_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
