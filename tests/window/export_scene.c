/* The export dialog in the whole window: what is there already is asked about, what goes on says
 * how far it is and can be cancelled. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/file.h"
#include "scene.h"

static bool has_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->recorded_ns > NS_PER_S;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return app_take(s->app) != NULL && !app_status(s->app)->is_recording;
}

static bool are_exports(scene *s, void *data)
{
    return app_exports_going(s->app) == *(uint32_t *)data;
}

static void open_with_a_hand(scene *s)
{
    static char hand[512];
    static const char *const inputs[] = {hand};
    (void)snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    const scene_options options = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = inputs, .input_count = 1};
    scene_open_with(s, &options);
    scene_let_cut(s, "/tmp/");
    scene_let_cut(s, "demo_hand");
}

static void record_a_take(scene *s)
{
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_recorded, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_take, NULL));
}

static void open_with_a_take(scene *s)
{
    open_with_a_hand(s);
    record_a_take(s);
}

static void ask_for_an_export(scene *s, const char *format)
{
    scene_do(s, ACTION_EXPORT);
    scene_click_word(s, "glTF, for Blender, Unity, Unreal (.glb)");
    scene_click_word(s, format);
    scene_click_word(s, "Export");
}

static void what_is_there_is_replaced_when_asked_twice(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Table (.csv)");
    assert_true(scene_until(&s, are_exports, &none));
    scene_do(&s, ACTION_EXPORT);
    scene_click_word(&s, "Export");
    assert_int_equal(app_exports_going(s.app), 0);
    assert_non_null(scene_word_with(&s, "is there already"));
    scene_picture(&s, "export_replaces");
    scene_check_words(&s);
    scene_click_word(&s, "Export");
    assert_null(scene_word(&s, "Cancel"));
    assert_true(scene_until(&s, are_exports, &none));
    scene_close(&s);
}

static void what_goes_on_is_seen_and_cancelled(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Pictures, a folder of PNG");
    assert_int_equal(app_exports_going(s.app), 1);
    const ui_word *word = scene_word_with(&s, "Exporting");
    assert_non_null(word);
    scene_click(&s, word->where.x + 4.0f, word->where.y + 4.0f);
    scene_picture(&s, "export_goes_on");
    scene_check_words(&s);
    scene_click_word(&s, "Cancel");
    assert_true(scene_until(&s, are_exports, &none));
    scene_frames(&s, 3);
    assert_null(scene_word_with(&s, "Exporting"));
    assert_null(scene_word(&s, "Exports"));
    scene_close(&s);
}

static bool is_over(scene *s, void *data)
{
    (void)data;
    return s->is_over;
}

/* Nothing is lost by going home: the program says what goes on, and waits when it is told to. */
static void quitting_asks_about_an_export_that_goes_on(void **state)
{
    (void)state;
    scene s;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Pictures, a folder of PNG");
    assert_int_equal(app_exports_going(s.app), 1);
    scene_do(&s, ACTION_QUIT);
    scene_frames(&s, 3);
    assert_false(s.is_over);
    assert_non_null(scene_word(&s, "An export goes on"));
    scene_picture(&s, "export_quits");
    scene_check_words(&s);
    scene_click_word(&s, "Stay");
    scene_frames(&s, 3);
    assert_null(scene_word(&s, "An export goes on"));
    assert_int_equal(app_exports_going(s.app), 1);
    scene_do(&s, ACTION_QUIT);
    scene_frames(&s, 3);
    scene_click_word(&s, "Quit when done");
    scene_frames(&s, 3);
    assert_false(s.is_over);
    scene_click_word(&s, "Cancel"); /* the export: it is done with so */
    assert_true(scene_until(&s, is_over, NULL));
    scene_close(&s);
}

static void an_export_is_given_up_with_the_program(void **state)
{
    (void)state;
    scene s;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Pictures, a folder of PNG");
    scene_do(&s, ACTION_QUIT);
    scene_frames(&s, 3);
    scene_click_word(&s, "Give up and quit");
    assert_true(scene_until(&s, is_over, NULL));
    scene_close(&s);
}

static bool has_in_file(const char *path, const char *word)
{
    error err = {0};
    file_bytes got;
    bool has = false;
    if (file_read(&got, path, 1 << 30, &err) < 0)
        fail_msg("%s", err.text);
    for (size_t i = 0; i + strlen(word) <= got.size && !has; ++i)
        has = memcmp(got.data + i, word, strlen(word)) == 0;
    file_bytes_finish(&got);
    return has;
}

/* A pinch of clay before, and the curves of what is performed then have their names. */
static void clay_leaves_the_curves_their_names(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0;
    char path[160];
    open_with_a_hand(&s);
    scene_frames(&s, 30);
    scene_modifiers(&s, UI_CONTROL, true);
    scene_drag(&s, 460.0f, 260.0f, 480.0f, 300.0f, 12);
    scene_modifiers(&s, UI_CONTROL, false);
    scene_frames(&s, 30);
    assert_non_null(scene_word(&s, "Held: N clears it"));
    scene_picture(&s, "export_clay");
    record_a_take(&s);
    scene_do(&s, ACTION_EXPORT);
    scene_click_word(&s, "Export");
    assert_true(scene_until(&s, are_exports, &none));
    (void)snprintf(path, sizeof path, "%s/night_1.glb", s.folder);
    assert_true(has_in_file(path, "jaw.open"));
    assert_true(has_in_file(path, "mouth.corner.l"));
    assert_false(has_in_file(path, "component1"));
    scene_do(&s, ACTION_LIVE);
    scene_do(&s, ACTION_NEUTRAL);
    scene_frames(&s, 3);
    assert_null(scene_word(&s, "Held: N clears it"));
    scene_modifiers(&s, UI_SHIFT, true);
    scene_drag(&s, 460.0f, 260.0f, 480.0f, 300.0f, 12);
    scene_modifiers(&s, UI_SHIFT, false);
    scene_click_word(&s, "Held: N clears it"); /* so does a click */
    assert_null(scene_word(&s, "Held: N clears it"));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clay_leaves_the_curves_their_names),
        cmocka_unit_test(what_is_there_is_replaced_when_asked_twice),
        cmocka_unit_test(what_goes_on_is_seen_and_cancelled),
        cmocka_unit_test(quitting_asks_about_an_export_that_goes_on),
        cmocka_unit_test(an_export_is_given_up_with_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
