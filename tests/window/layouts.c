/* Where the panels are, in the real window: moved, floated, hidden; the three layouts; what is kept
 * of them for a show, and what comes of a damaged file. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/scene.h"

static arrangement *now(scene *s)
{
    return &app_looks_of(s->app)->layouts.now;
}

static panel_place place_of(scene *s, app_panel of)
{
    return now(s)->panel[of].place;
}

static float middle_of(scene *s, const char *text)
{
    const ui_word *word = scene_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    return word->where.x + 0.5f * word->where.width;
}

static void right_click_word(scene *s, const char *text)
{
    const ui_word *word = scene_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    scene_click_with(s, word->where.x + 4.0f, word->where.y + 6.0f, 1);
}

static void drag_word(scene *s, const char *text, float x, float y)
{
    const ui_word *word = scene_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    scene_drag(s, word->where.x + 4.0f, word->where.y + 6.0f, x, y, 8);
}

static void panels_are_moved_floated_and_hidden(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_RIGHT);
    right_click_word(&s, "Mapping");
    scene_click_word(&s, "Move panel left");
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_LEFT);
    assert_true(middle_of(&s, "Mapping") < 330.0f);
    drag_word(&s, "Engine", 10.0f, 200.0f); /* beside it */
    assert_int_equal(place_of(&s, APP_ENGINE), PLACE_LEFT);
    assert_true(middle_of(&s, "Engine") < 330.0f);
    drag_word(&s, "Engine", middle_of(&s, "Mapping"), scene_word(&s, "Mapping")->where.y + 6.0f);
    assert_true(middle_of(&s, "Engine") < middle_of(&s, "Mapping")); /* before it */
    scene_look(&s, "layouts_left");
    scene_check_words(&s);

    drag_word(&s, "Log", 620.0f, 200.0f); /* over the face */
    assert_int_equal(place_of(&s, APP_LOG), PLACE_FLOATING);
    const float x = middle_of(&s, "Log");
    drag_word(&s, "Log", 720.0f, 240.0f);
    assert_true(middle_of(&s, "Log") > x + 60.0f);
    assert_int_equal(place_of(&s, APP_LOG), PLACE_FLOATING);
    scene_look(&s, "layouts_floating");
    const ui_rectangle before = now(&s)->panel[APP_LOG].floated;
    scene_drag(&s, before.x + before.width - 4.0f, before.y + before.height - 4.0f,
               before.x + before.width + 46.0f, before.y + before.height + 26.0f, 5);
    assert_float_equal(now(&s)->panel[APP_LOG].floated.width, before.width + 50.0f, 1.5f);
    scene_click(&s, now(&s)->panel[APP_LOG].floated.x + before.width + 50.0f - 16.0f,
                before.y + 15.0f); /* its cross */
    assert_int_equal(place_of(&s, APP_LOG), PLACE_HIDDEN);
    assert_null(scene_word(&s, "Log"));
    scene_do(&s, ACTION_PANEL_LOG); /* its key shows it again */
    assert_non_null(scene_word(&s, "Log"));
    assert_int_equal(place_of(&s, APP_LOG), PLACE_RIGHT);

    scene_do(&s, ACTION_PANEL_FLOAT);
    assert_int_equal(place_of(&s, APP_LOG), PLACE_FLOATING);
    drag_word(&s, "Log", 1275.0f, 300.0f); /* it docks at the side */
    assert_int_equal(place_of(&s, APP_LOG), PLACE_RIGHT);
    scene_do(&s, ACTION_PANEL_HIDE);
    assert_int_equal(place_of(&s, APP_LOG), PLACE_HIDDEN);
    right_click_word(&s, "Perform");
    scene_click_word(&s, "Show Log");
    assert_int_equal(place_of(&s, APP_LOG), PLACE_RIGHT);
    scene_close(&s);
}

static void a_dock_without_panels_gives_its_room_to_the_face(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    for (int i = ACTION_PANEL_DEVICES; i < ACTION_PANEL_DEVICES + (int)APP_PANELS; ++i) {
        scene_do(&s, (action)i);
        scene_do(&s, ACTION_PANEL_HIDE);
    }
    assert_null(scene_word(&s, "Devices"));
    assert_true(middle_of(&s, "Perform") > 1000.0f);
    scene_look(&s, "layouts_no_dock");
    scene_check_words(&s);
    scene_do(&s, ACTION_LAYOUT_RESET);
    assert_non_null(scene_word(&s, "Devices"));
    assert_true(middle_of(&s, "Perform") < 950.0f);
    scene_close(&s);
}

static void each_layout_keeps_its_own_changes(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_LAYOUT_RIG);
    assert_false(now(&s)->has_timeline);
    assert_non_null(scene_word(&s, "Regions"));
    assert_true(middle_of(&s, "Mapping") < 330.0f); /* both at once */
    scene_look(&s, "layouts_rig");
    scene_check_words(&s);
    scene_do(&s, ACTION_PANEL_POSES);
    scene_do(&s, ACTION_PANEL_HIDE);
    scene_click_word(&s, "Edit");
    assert_int_equal(app_looks_of(s.app)->layouts.of, LAYOUT_EDIT);
    assert_true(now(&s)->has_timeline);
    assert_int_equal(place_of(&s, APP_POSES), PLACE_RIGHT);
    scene_look(&s, "layouts_edit");
    scene_check_words(&s);
    scene_do(&s, ACTION_LAYOUT_RIG);
    assert_int_equal(place_of(&s, APP_POSES), PLACE_HIDDEN);
    scene_do(&s, ACTION_LAYOUT_RESET);
    assert_int_equal(place_of(&s, APP_POSES), PLACE_LEFT);
    scene_close(&s);
}

/* ---- what is kept ---- */

static void open_other_show(scene *s, const char *name)
{
    char path[128];
    (void)snprintf(path, sizeof path, "%s/%s", s->folder, name);
    assert_int_equal(app_open_show(s->app, path), MRT_OK);
    scene_frames(s, 3);
}

static bool is_open(scene *s, void *data)
{
    return app_show(s->app) && strcmp(show_path(app_show(s->app)), data) == 0;
}

static void a_show_is_opened_again_with_its_layout(void **state)
{
    scene s;
    char kept[128], night[96];
    (void)state;
    const scene_options plain = {.width_px = 1280, .height_px = 720, .scale = 1.0f};
    scene_prepare(&s, &plain);
    (void)snprintf(kept, sizeof kept, "%s/window.json", s.folder);
    scene_options options = plain;
    options.settings_path = kept;
    scene_open_again(&s, &options);
    scene_do(&s, ACTION_PANEL_MAPPING);
    scene_do(&s, ACTION_PANEL_LEFT);
    open_other_show(&s, "day.marotte"); /* of another show nothing moves here */
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_RIGHT);
    scene_do(&s, ACTION_LAYOUT_EDIT);
    (void)snprintf(night, sizeof night, "%s", s.show);
    assert_int_equal(app_open_show(s.app, night), MRT_OK);
    scene_frames(&s, 3);
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_LEFT);
    assert_int_equal(app_looks_of(s.app)->layouts.of, LAYOUT_PERFORM);
    scene_open_again(&s, &options);
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_LEFT);
    assert_true(middle_of(&s, "Mapping") < 330.0f);

    char copy[128];
    error err = {0};
    (void)snprintf(copy, sizeof copy, "%s/copy.marotte", s.folder);
    assert_int_equal(app_save_show_as(s.app, copy, &err), MRT_OK);
    assert_true(scene_until(&s, is_open, copy)); /* a copy looks like the original */
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_LEFT);

    app_do(s.app, ACTION_LAYOUT_KEEP); /* for new shows */
    open_other_show(&s, "new.marotte");
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_LEFT);
    open_other_show(&s, "day.marotte");
    assert_int_equal(app_looks_of(s.app)->layouts.of, LAYOUT_EDIT);

    scene_end(&s);
    assert_int_equal(unlink(kept), 0); /* the settings are lost */
    s.app = NULL;
    scene_open_again(&s, &options);
    assert_int_equal(place_of(&s, APP_MAPPING), PLACE_RIGHT);
    assert_non_null(scene_word(&s, "Devices"));
    scene_close(&s);
}

/* ---- nonsense, and small screens ---- */

static bool is_inside(ui_rectangle box, float width, float height)
{
    return box.x >= 0.0f && box.y >= 0.0f && box.width >= 0.0f && box.height >= 0.0f &&
           box.x + box.width <= width + 0.5f && box.y + box.height <= height + 0.5f;
}

static void check_on_screen(const arrangement *self, float width, float height)
{
    arrangement_rectangles at;
    bool is_there[APP_PANELS] = {false};
    arrangement_lay_out(self, width, height, &at);
    assert_true(is_inside(at.face, width, height));
    assert_true(at.face.width >= 0.25f * width);
    assert_true(is_inside(at.timeline, width, height));
    const arrangement_dock *both[] = {&at.left, &at.right};
    for (size_t d = 0; d < 2; ++d) {
        assert_true(is_inside(both[d]->where, width, height));
        assert_int_equal(both[d]->count > 0, both[d]->where.width > 0.0f);
        for (uint32_t i = 0; i < both[d]->count; ++i) {
            assert_false(is_there[both[d]->panel[i]]);
            is_there[both[d]->panel[i]] = true;
        }
    }
    for (uint32_t i = 0; i < at.floating_count; ++i) {
        assert_true(is_inside(at.floating[i].where, width, height));
        is_there[at.floating[i].panel] = true;
    }
    for (uint32_t i = 0; i < APP_PANELS; ++i)
        assert_int_equal(is_there[i], self->panel[i].place != PLACE_HIDDEN);
}

static void any_text_gives_panels_on_the_screen(void **state)
{
    static const char *const word[] = {
        "left",    "right", "float", "hidden", "timeline", "no_timeline", "current", "devices",
        "mapping", "rig*",  "log",   "poses*", "scene*",   "hand",        "1e9",     "-40",
        "nan",     "12000", "300",   "0",      "*",        "\xff",        "gone"};
    static const float sizes[][2] = {
        {800.0f, 500.0f}, {1280.0f, 720.0f}, {1920.0f, 1080.0f}, {640.0f, 480.0f}};
    uint32_t random = 1;
    (void)state;
    for (int run = 0; run < 2000; ++run) {
        char text[ARRANGEMENT_TEXT] = "", again[ARRANGEMENT_TEXT];
        arrangement self, read;
        for (int i = 0; i < 30; ++i) {
            random = random * 1664525u + 1013904223u;
            (void)strcat(strcat(text, word[(random >> 8) % (sizeof word / sizeof word[0])]), " ");
        }
        arrangement_read(&self, (app_layout)(run % LAYOUTS), text);
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i)
            check_on_screen(&self, sizes[i][0], sizes[i][1]);
        arrangement_write(&self, text);
        arrangement_read(&read, (app_layout)(run % LAYOUTS), text);
        arrangement_write(&read, again);
        assert_string_equal(again, text);
    }
}

static void nonsense_in_the_settings_opens_as_usual(void **state)
{
    static const char nonsense[] =
        "{\"looks\": {}, \"layouts\": {\"shows\": {\"new\": {\"perform\": "
        "\"timeline 1e30 float 9000 9000 20 20 devices right -4 left left nobody**\", "
        "\"layout\": \"sideways\", \"edit\": 7}, \"s\": []}, \"recent\": \"x\"}}";
    scene s;
    char kept[128];
    (void)state;
    const scene_options plain = {.width_px = 800, .height_px = 500, .scale = 1.0f};
    scene_prepare(&s, &plain);
    (void)snprintf(kept, sizeof kept, "%s/window.json", s.folder);
    FILE *file = fopen(kept, "w");
    assert_non_null(file);
    assert_true(fputs(nonsense, file) >= 0);
    assert_int_equal(fclose(file), 0);
    scene_options options = plain;
    options.settings_path = kept;
    scene_open_again(&s, &options);
    assert_int_equal(place_of(&s, APP_DEVICES), PLACE_FLOATING); /* far away, and drawn here */
    assert_in_range((int)middle_of(&s, "Devices"), 300, 800);
    scene_look(&s, "layouts_nonsense");
    scene_do(&s, ACTION_LAYOUT_EDIT);
    assert_int_equal(place_of(&s, APP_DEVICES), PLACE_RIGHT);
    scene_do(&s, ACTION_LAYOUT_RIG); /* two docks do not fit: all tabs in one */
    assert_true(middle_of(&s, "Mapping") > 400.0f);
    scene_do(&s, ACTION_PANEL_MAPPING);
    assert_non_null(scene_word(&s, "Preset"));
    scene_look(&s, "layouts_narrow");
    scene_check_words(&s);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_text_gives_panels_on_the_screen),
        cmocka_unit_test(panels_are_moved_floated_and_hidden),
        cmocka_unit_test(a_dock_without_panels_gives_its_room_to_the_face),
        cmocka_unit_test(each_layout_keeps_its_own_changes),
        cmocka_unit_test(a_show_is_opened_again_with_its_layout),
        cmocka_unit_test(nonsense_in_the_settings_opens_as_usual),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
