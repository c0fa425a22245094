/* For every eye and habit: text size, light and dark, colours for those who see no red or no green,
 * keys of one's own; and nothing is cut, from a small window to a large one. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/scene.h"

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const demo_inputs[] = {demo};

static void open_scene(scene *s, uint32_t width_px, uint32_t height_px, float scale)
{
    const scene_options options = {.width_px = width_px,
                                   .height_px = height_px,
                                   .scale = scale,
                                   .inputs = demo_inputs,
                                   .input_count = 1};
    scene_open_with(s, &options);
    scene_let_cut(s, "demo_hand"); /* names of devices and files may be longer than their room */
    scene_let_cut(s, SOURCE_DIR);
    scene_let_cut(s, "/tmp");
}

static float height_of(scene *s, const char *text)
{
    const ui_word *word = scene_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    return word ? word->where.height : 0.0f;
}

static void choose(scene *s, const char *now, const char *wanted)
{
    scene_click_word(s, now);
    scene_click_word(s, wanted);
    scene_settle(s);
}

/* ---- eyes ---- */

static void text_is_as_large_as_one_wants_it_and_stays_so(void **state)
{
    scene s;
    char path[128];
    (void)state;
    open_scene(&s, 1600, 1000, 1.0f);
    (void)snprintf(path, sizeof path, "%s/settings.json", s.folder);
    const scene_options kept = {.settings_path = path};
    scene_open_again(&s, &kept);
    const float before_px = height_of(&s, "Devices") * workspace_scale(s.workspace);
    scene_do(&s, ACTION_HELP);
    choose(&s, "Text 100 %", "Text 150 %");
    scene_check_words(&s);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    const float after_px = height_of(&s, "Devices") * workspace_scale(s.workspace);
    assert_float_equal(after_px, 1.5f * before_px, 1.2f);
    scene_look(&s, "habits_text_150");
    scene_check_words(&s);
    /* A click meets what is seen. */
    scene_click_word(&s, "Engine");
    assert_int_equal(app_looks_of(s.app)->layouts.now.current, APP_ENGINE);
    scene_frames(&s, 60);
    assert_float_equal(settings_number(app_settings(s.app), "window.width", 0.0), 1600.0, 0.0);
    scene_open_again(&s, &kept);
    assert_float_equal(app_looks_of(s.app)->text_size, 1.5f, 0.0f);
    assert_float_equal(height_of(&s, "Devices") * workspace_scale(s.workspace), after_px, 1.2f);
    scene_close(&s);
}

/* Bytes of a picture of the window as it is drawn now: nothing at all has a few thousand. */
static int64_t drawn_bytes(scene *s, const char *name)
{
    char path[512];
    struct stat status = {0};
    scene_picture(s, name);
    (void)snprintf(path, sizeof path, "%s/out/%s.png", BUILD_DIR, name);
    assert_int_equal(stat(path, &status), 0);
    return (int64_t)status.st_size;
}

/* The help's letters, then the whole stage, drawn before and after: with fewer of them, too. */
static void all_of_it_is_drawn_in_another_size(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_HELP);
    const int64_t keys = drawn_bytes(&s, "habits_keys_100");
    app_looks_of(s.app)->text_size = 1.25f;
    scene_frames(&s, 3);
    assert_true(drawn_bytes(&s, "habits_keys_125") > keys / 2);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_frames(&s, 3);
    assert_true(drawn_bytes(&s, "habits_stage_125") > keys);
    app_looks_of(s.app)->text_size = 1.0f;
    scene_frames(&s, 3);
    assert_true(drawn_bytes(&s, "habits_stage_100") > keys);
    scene_close(&s);
}

static void a_small_window_keeps_room_for_its_panels(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 880, 550, 1.0f);
    app_looks_of(s.app)->text_size = 2.0f;
    scene_frames(&s, 3);
    assert_float_equal(workspace_scale(s.workspace), 1.1f, 0.001f);
    scene_do(&s, ACTION_HELP);
    assert_non_null(scene_word(&s, "Limited to 110 % here"));
    scene_look(&s, "habits_no_room");
    scene_check_words(&s);
    const ui_word *size = scene_word(&s, "Text 200 %");
    assert_non_null(size);
    scene_move(&s, size->where.x + 4.0f, size->where.y + 4.0f);
    scene_frames(&s, 60);
    assert_non_null(scene_word_with(&s, "Enlarge the"));
    scene_close(&s);
}

static const action pages[] = {ACTION_PANEL_DEVICES, ACTION_PANEL_MAPPING, ACTION_PANEL_RIG,
                               ACTION_PANEL_ENGINE,  ACTION_PANEL_LOG,     ACTION_PANEL_PATCH,
                               ACTION_PANEL_OUTPUT,  ACTION_PANEL_SCENE,   ACTION_PANEL_HAND,
                               ACTION_PANEL_POSES,   ACTION_HELP,          ACTION_OPEN};
enum { PAGES = sizeof pages / sizeof pages[0] };

/* Every page; each fault is told. */
static uint32_t walk(scene *s, const char *name)
{
    uint32_t faults = 0;
    for (size_t i = 0; i < PAGES; ++i) {
        char picture[96];
        scene_do(s, pages[i]);
        scene_frames(s, 3);
        (void)snprintf(picture, sizeof picture, "habits_%s_%s", name, action_of(pages[i])->name);
        scene_look(s, picture);
        const uint32_t here = scene_word_faults(s);
        if (here)
            print_message("^ in %s\n", picture);
        faults += here;
        if (pages[i] == ACTION_HELP || pages[i] == ACTION_OPEN)
            scene_key(s, UI_KEY_ESCAPE, 0);
    }
    return faults;
}

static void every_page_can_be_read(uint32_t width_px, uint32_t height_px, float scale, theme look,
                                   const char *name)
{
    scene s;
    open_scene(&s, width_px, height_px, scale);
    app_looks_of(s.app)->theme = look;
    const uint32_t faults = walk(&s, name);
    scene_close(&s);
    if (faults)
        fail_msg("%u faults of words", faults);
}

static void nothing_is_cut_in_a_small_window(void **state)
{
    (void)state;
    every_page_can_be_read(800, 500, 1.0f, (theme){0}, "small");
}

static void nothing_is_cut_in_a_light_window_of_usual_size(void **state)
{
    (void)state;
    every_page_can_be_read(1280, 720, 1.0f, (theme){.is_light = true}, "light");
}

static void nothing_is_cut_in_a_large_window_with_safe_colours(void **state)
{
    (void)state;
    every_page_can_be_read(3840, 2160, 2.0f, (theme){.is_colour_safe = true}, "large");
}

static void light_and_safe_colours_are_a_click_each(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_HELP);
    const uint32_t dark = scene_word(&s, "Keys")->ground;
    scene_click_word(&s, "Light");
    assert_true(app_looks_of(s.app)->theme.is_light);
    const uint32_t light = scene_word(&s, "Keys")->ground;
    assert_true(scene_contrast(light, 0x000000ffu) > 4.0f * scene_contrast(dark, 0x000000ffu));
    scene_click_word(&s, "Colour-safe");
    assert_true(app_looks_of(s.app)->theme.is_colour_safe);
    scene_check_words(&s);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_look(&s, "habits_light_safe");
    scene_check_words(&s);
    scene_close(&s);
}

/* ---- habits ---- */

static bool is_recording(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording;
}

static bool has_samples(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->sample_count > 50;
}

static void a_key_is_changed_by_a_click_and_a_key(void **state)
{
    scene s;
    char path[128];
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    (void)snprintf(path, sizeof path, "%s/settings.json", s.folder);
    const scene_options kept = {.settings_path = path, .inputs = demo_inputs, .input_count = 1};
    scene_open_again(&s, &kept);
    scene_do(&s, ACTION_HELP);
    scene_click_word(&s, "Record");
    assert_non_null(scene_word_with(&s, "Record: press the new key"));
    scene_look(&s, "habits_key_waits");
    scene_key(&s, 'M', 0); /* somebody else's: it says whose */
    assert_non_null(scene_word_with(&s, "M is used by \"Add marker\""));
    assert_int_equal(key_map_action(&app_looks_of(s.app)->keys, (key_chord){'M', 0}), ACTION_MARK);
    scene_key(&s, 'Q', UI_SHIFT); /* free */
    assert_non_null(scene_word(&s, "Shift+Q"));
    scene_click_word(&s, "Add marker");
    scene_key(&s, 'K', 0);
    scene_key(&s, 'K', 0); /* once more takes it */
    const key_map *keys = &app_looks_of(s.app)->keys;
    assert_int_equal(key_map_action(keys, (key_chord){'K', 0}), ACTION_MARK);
    assert_int_equal(key_map_of(keys, ACTION_KEEP).key, UI_KEY_NONE);
    scene_click_word(&s, "Live");
    scene_key(&s, UI_KEY_ENTER, 0); /* not to be had */
    assert_non_null(scene_word_with(&s, "Enter confirms"));
    scene_key(&s, UI_KEY_ESCAPE, 0); /* leaves it as it was, and the page open */
    assert_int_equal(key_map_of(keys, ACTION_LIVE).key, 'L');
    assert_true(app_looks_of(s.app)->is_helping);
    scene_check_words(&s);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_false(app_looks_of(s.app)->is_helping);

    scene_open_again(&s, &kept); /* it was kept */
    assert_true(scene_until(&s, has_samples, NULL));
    scene_key(&s, 'R', 0);
    scene_frames(&s, 5);
    assert_false(app_status(s.app)->is_recording);
    scene_key(&s, 'Q', UI_SHIFT);
    assert_true(scene_until(&s, is_recording, NULL));
    scene_key(&s, 'Q', UI_SHIFT);
    scene_do(&s, ACTION_HELP);
    scene_click_word(&s, "Reset keys");
    assert_int_equal(key_map_of(&app_looks_of(s.app)->keys, ACTION_RECORD).key, 'R');
    assert_null(scene_word(&s, "Reset keys"));
    scene_close(&s);
}

static void keys_of_a_file_that_makes_no_sense_are_as_brought(void **state)
{
    settings *kept;
    error err = {0};
    char note[256];
    key_map keys;
    (void)state;
    assert_true(settings_open(&kept, "", note, sizeof note, &err) >= 0);
    settings_set_text(kept, "keys.record", "Hyper+R");
    settings_set_text(kept, "keys.keep", "Esc");
    settings_set_text(kept, "keys.mark", "L");    /* the program's own of Live: the file is right */
    settings_set_text(kept, "keys.neutral", "L"); /* the first of two has it */
    settings_set_text(kept, "keys.rezero", "");
    settings_set_number(kept, "keys.play", 7.0);
    key_map_read(&keys, kept);
    assert_int_equal(key_map_of(&keys, ACTION_RECORD).key, 'R');
    assert_int_equal(key_map_of(&keys, ACTION_KEEP).key, 'K');
    assert_int_equal(key_map_of(&keys, ACTION_MARK).key, 'L');
    assert_int_equal(key_map_of(&keys, ACTION_LIVE).key, UI_KEY_NONE);
    assert_int_equal(key_map_of(&keys, ACTION_NEUTRAL).key, 'N');
    assert_int_equal(key_map_of(&keys, ACTION_REZERO).key, UI_KEY_NONE);
    assert_int_equal(key_map_of(&keys, ACTION_PLAY).key, ' ');
    settings_close(kept);
}

static void no_two_actions_have_one_key(void **state)
{
    static const key_map brought; /* zeroed */
    (void)state;
    for (uint32_t i = 1; i < ACTION_COUNT; ++i)
        if (key_map_of(&brought, (action)i).key != UI_KEY_NONE)
            assert_int_equal(key_map_action(&brought, key_map_of(&brought, (action)i)), i);
}

/* ---- hints ---- */

/* Whose label says all, wherever it stands. */
static bool says_all(const char *label)
{
    static const char *const plain[] = {"Cancel", "Close", "Done", "Open", "OK"};
    for (size_t i = 0; i < sizeof plain / sizeof plain[0]; ++i)
        if (strncmp(label, plain[i], strlen(plain[i])) == 0 && strchr("#", label[strlen(plain[i])]))
            return true;
    return false;
}

static uint32_t tell_unhinted(scene *s, const char *where)
{
    const ui_control *control;
    uint32_t missing = 0;
    scene_settle(s);
    const uint32_t count = ui_controls(s->ui, &control);
    for (uint32_t i = 0; i < count; ++i)
        if (!control[i].has_hint && !says_all(control[i].label)) {
            print_error("%s: \"%s\" has no tooltip\n", where, control[i].label);
            missing += 1;
        }
    assert_true(count > 0);
    return missing;
}

static void every_control_says_what_it_does(void **state)
{
    static const char *const panels[] = {"Devices", "Mapping", "Rig",  "Engine",
                                         "Log",     "Patch",   "Send", "Scene"};
    static const char *const rig_tabs[] = {"Parts", "Paint", "Check"};
    static const char *const mapping_tabs[] = {"Pedals", "Learn", "Parameters"};
    scene s;
    uint32_t missing = 0;
    (void)state;
    open_scene(&s, 2000, 3000, 1.0f); /* as high as all of it */
    for (size_t i = 0; i < sizeof panels / sizeof panels[0]; ++i) {
        scene_click_word(&s, panels[i]);
        missing += tell_unhinted(&s, panels[i]);
        for (size_t k = 0; k < 3 && strcmp(panels[i], "Mapping") == 0; ++k) {
            scene_click_word(&s, mapping_tabs[k]);
            missing += tell_unhinted(&s, mapping_tabs[k]);
        }
        for (size_t k = 0; k < 3 && strcmp(panels[i], "Rig") == 0; ++k) {
            if (!scene_word(&s, rig_tabs[k]))
                continue;
            scene_click_word(&s, rig_tabs[k]);
            missing += tell_unhinted(&s, rig_tabs[k]);
        }
    }
    scene_do(&s, ACTION_HELP);
    missing += tell_unhinted(&s, "help");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_do(&s, ACTION_OPEN);
    missing += tell_unhinted(&s, "open");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_int_equal(missing, 0);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_is_as_large_as_one_wants_it_and_stays_so),
        cmocka_unit_test(all_of_it_is_drawn_in_another_size),
        cmocka_unit_test(a_small_window_keeps_room_for_its_panels),
        cmocka_unit_test(nothing_is_cut_in_a_small_window),
        cmocka_unit_test(nothing_is_cut_in_a_light_window_of_usual_size),
        cmocka_unit_test(nothing_is_cut_in_a_large_window_with_safe_colours),
        cmocka_unit_test(light_and_safe_colours_are_a_click_each),
        cmocka_unit_test(a_key_is_changed_by_a_click_and_a_key),
        cmocka_unit_test(keys_of_a_file_that_makes_no_sense_are_as_brought),
        cmocka_unit_test(no_two_actions_have_one_key),
        cmocka_unit_test(every_control_says_what_it_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
