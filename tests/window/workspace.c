/* The whole window: what is on it, what keys and clicks do, what stays readable. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/scene.h"

#include <png.h>

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const demo_inputs[] = {demo};

static void open_with_hand(scene *s, uint32_t width_px, uint32_t height_px, float scale)
{
    const scene_options options = {.width_px = width_px,
                                   .height_px = height_px,
                                   .scale = scale,
                                   .inputs = demo_inputs,
                                   .input_count = 1};
    scene_open_with(s, &options);
}

/* ---- conditions ---- */

static bool has_samples(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->sample_count > 50;
}

static bool is_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->recorded_ns > 500 * NS_PER_MS;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return !app_status(s->app)->is_recording && app_take_id(s->app) != 0;
}

/* A take is opened beside the frame thread. */
static bool shows_take_1(scene *s, void *data)
{
    (void)data;
    return scene_word(s, "Take 1") != NULL;
}

static bool has_moved(scene *s, void *data)
{
    const float *rest = data;
    const live_view *view = app_view(s->app);
    float most = 0.0f;
    for (uint32_t i = 0; i < 3 * view->vertex_count; ++i)
        most = fmaxf(most, fabsf(view->position[i] - rest[i]));
    return most > 2.0f;
}

static void record_a_take(scene *s)
{
    assert_true(scene_until(s, has_samples, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, is_recorded, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_take, NULL));
}

/* ---- what is seen ---- */

static void the_first_face_is_drawn_with_all_around_it(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_frames(&s, 5);
    assert_non_null(scene_word(&s, "Live"));
    assert_non_null(scene_word(&s, "night"));
    assert_non_null(scene_word(&s, "puppet"));
    scene_picture(&s, "workspace");
    scene_close(&s);
}

/* Names and times of takes, texts of devices: they may be longer than there is room. */
static void let_names_be_cut(scene *s)
{
    scene_let_cut(s, "demo_hand");
    scene_let_cut(s, SOURCE_DIR);
    scene_let_cut(s, "/tmp");
}

static void look_at_everything(scene *s, const char *prefix)
{
    static const action views[] = {ACTION_PANEL_DEVICES, ACTION_PANEL_MAPPING, ACTION_PANEL_RIG,
                                   ACTION_PANEL_ENGINE,  ACTION_PANEL_LOG,     ACTION_HELP,
                                   ACTION_FACE_ONLY,     ACTION_TIMELINE,      ACTION_OPEN,
                                   ACTION_EXPORT};
    uint32_t faults = 0;
    const bool is_large = s->width * workspace_scale(s->workspace) > 1280.0f;
    for (size_t i = 0; i < sizeof views / sizeof views[0]; ++i) {
        char name[96];
        const bool is_dialog = views[i] == ACTION_OPEN || views[i] == ACTION_EXPORT;
        const bool is_toggle = views[i] >= ACTION_VIEW_FRONT && !is_dialog &&
                               (views[i] < ACTION_PANEL_DEVICES || views[i] > ACTION_PANEL_LOG);
        scene_do(s, views[i]);
        scene_frames(s, 3);
        (void)snprintf(name, sizeof name, "%s_%s", prefix, action_of(views[i])->name);
        if (!is_large && !getenv("MAROTTE_PICTURES"))
            scene_draw(s);
        else /* drawn once is enough: it takes its time */
            scene_look(s, name);
        const uint32_t here = scene_word_faults(s);
        if (here)
            print_message("^ in %s\n", name);
        faults += here;
        if (is_toggle)
            scene_do(s, views[i]);
        if (is_dialog)
            scene_key(s, UI_KEY_ESCAPE, 0);
    }
    if (faults)
        fail_msg("%u faults of words", faults);
}

static void every_part_can_be_read_at_1280_by_720(void **state)
{
    scene s;
    (void)state;
    open_with_hand(&s, 1280, 720, 1.0f);
    let_names_be_cut(&s);
    record_a_take(&s);
    look_at_everything(&s, "workspace_1280");
    scene_close(&s);
}

static void every_part_can_be_read_at_2560_by_1440(void **state)
{
    scene s;
    (void)state;
    open_with_hand(&s, 2560, 1440, 2.0f);
    let_names_be_cut(&s);
    record_a_take(&s);
    look_at_everything(&s, "workspace_2560");
    scene_close(&s);
}

static void a_narrow_window_is_readable_too(void **state)
{
    scene s;
    (void)state;
    open_with_hand(&s, 960, 600, 1.0f);
    let_names_be_cut(&s);
    record_a_take(&s);
    scene_do(&s, ACTION_PLAY);
    scene_frames(&s, 2);
    scene_look(&s, "workspace_960");
    scene_check_words(&s);
    scene_close(&s);
}

/* ---- what is done ---- */

static void a_corner_of_the_mouth_is_dragged_with_the_mouse(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    const live_view *view = app_view(s.app);
    float *rest = malloc((size_t)view->vertex_count * 3 * sizeof *rest);
    assert_non_null(rest);
    memcpy(rest, view->position, (size_t)view->vertex_count * 3 * sizeof *rest);
    scene_move(&s, 544, 319);
    scene_settle(&s);
    scene_button(&s, 0, true);
    scene_frames(&s, 2);
    for (uint32_t i = 1; i <= 10; ++i) {
        scene_move(&s, 544 + 3.0f * (float)i, 319 - 3.0f * (float)i);
        scene_frame(&s);
    }
    assert_true(scene_until(&s, has_moved, rest));
    scene_look(&s, "workspace_pulled");
    scene_button(&s, 0, false);
    scene_settle(&s);
    free(rest);
    scene_close(&s);
}

static void record_is_told_large_and_the_take_is_chosen(void **state)
{
    scene s;
    (void)state;
    open_with_hand(&s, 1280, 720, 1.0f);
    assert_true(scene_until(&s, has_samples, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recorded, NULL));
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "Recording take 1"));
    assert_null(scene_word(&s, "Live"));
    scene_look(&s, "workspace_recording");
    scene_do(&s, ACTION_FACE_ONLY);
    scene_look(&s, "workspace_recording_face_only");
    assert_null(scene_word(&s, "Devices"));
    scene_do(&s, ACTION_FACE_ONLY);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, NULL));
    scene_do(&s, ACTION_PLAY);
    assert_true(scene_until(&s, shows_take_1, NULL));
    scene_look(&s, "workspace_take");
    scene_close(&s);
}

static void keys_do_nothing_while_something_is_typed(void **state)
{
    scene s;
    (void)state;
    open_with_hand(&s, 1280, 720, 1.0f);
    assert_true(scene_until(&s, has_samples, NULL));
    scene_click_word(&s, "path of a log file");
    assert_true(ui_is_typing(s.ui));
    scene_key(&s, 'R', 0);
    scene_type(&s, "r?");
    assert_false(app_status(s.app)->is_recording);
    assert_false(app_looks_of(s.app)->is_helping);
    scene_key(&s, UI_KEY_ENTER, 0);
    scene_key(&s, '/', UI_SHIFT);
    assert_true(app_looks_of(s.app)->is_helping);
    scene_close(&s);
}

static void a_question_mark_of_any_keyboard_opens_the_help(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_type(&s, "?");
    assert_true(app_looks_of(s.app)->is_helping);
    scene_type(&s, "?");
    assert_false(app_looks_of(s.app)->is_helping);
    scene_close(&s);
}

static void the_keyboard_is_a_hand_until_escape(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_HAND_KEYS);
    assert_true(app_has_hand_keys(s.app));
    scene_key(&s, 'R', 0);
    scene_key(&s, 'X', 0);
    assert_false(app_status(s.app)->is_recording);
    scene_do(&s, ACTION_PANEL_LOG);
    assert_int_equal(app_looks_of(s.app)->layouts.now.current, APP_LOG);
    scene_look(&s, "workspace_hand_keys");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_false(app_has_hand_keys(s.app));
    scene_close(&s);
}

static void an_error_stays_until_it_is_clicked(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    news_list *news = app_news(s.app);
    news_list_add(news, MRT_LOG_INFO, "stage", "all is well");
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "all is well"));
    for (uint32_t i = 0; i < 7 * 60; ++i) { /* hidden frames are 1/60 s each, however long they
                                               take: only the news is updated */
        scene_frame(&s);
        if (!scene_word(&s, "all is well"))
            break;
    }
    assert_null(scene_word(&s, "all is well"));
    news_list_add(news, MRT_LOG_WARNING, "stage", "it is written by another program");
    news_list_add(news, MRT_LOG_INFO, "stage", "a face was opened");
    news_list_add(news, MRT_LOG_INFO, "a plugin", "27 contacts"); /* the newest says no more */
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "it is written by another program"));
    news_list_add(news, MRT_LOG_INFO, "stage", "all is well again");
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "all is well again"));
    news_list_add(news, MRT_LOG_WARNING, "org.example.hands", "did not answer");
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "hands: did not answer"));
    news_list_add(news, MRT_LOG_ERROR, "stage", "the disk is gone again");
    scene_frames(&s, 2);
    news_list_add(news, MRT_LOG_INFO, "stage", "calm");
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "the disk is gone again"));
    scene_look(&s, "workspace_error");
    scene_frames(&s, 200); /* long enough to be read: what went well later takes its place */
    assert_non_null(scene_word(&s, "the disk is gone again"));
    news_list_add(news, MRT_LOG_INFO, "stage", "the disk is back");
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "the disk is back"));
    news_list_add(news, MRT_LOG_ERROR, "stage", "the disk is gone again");
    scene_frames(&s, 2);
    scene_click_word(&s, "the disk is gone again");
    assert_null(scene_word(&s, "the disk is gone again"));
    scene_close(&s);
}

static void a_window_that_was_maximised_is_kept_as_such(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_frames(&s, 60);
    assert_float_equal(settings_number(app_settings(s.app), "window.maximised", -1.0), 0.0, 0.0);
    assert_float_equal(settings_number(app_settings(s.app), "window.width", 0.0), 1280.0, 0.0);
    settings_set_number(app_settings(s.app), "window.width", 900.0);
    window_maximise(s.window);
    scene_frames(&s, 60);
    assert_float_equal(settings_number(app_settings(s.app), "window.maximised", -1.0), 1.0, 0.0);
    /* the size to come back to */
    assert_float_equal(settings_number(app_settings(s.app), "window.width", 0.0), 900.0, 0.0);
    scene_close(&s);
}

static void the_edges_of_timeline_and_dock_are_dragged(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    const float before = app_looks_of(s.app)->layouts.now.timeline_height;
    const float y = 720.0f - before;
    scene_drag(&s, 500, y, 500, y - 60, 6);
    assert_float_equal(app_looks_of(s.app)->layouts.now.timeline_height, before + 60.0f, 1.5f);
    scene_drag(&s, 500, y - 60, 500, 715, 6);
    scene_frames(&s, 2);
    scene_look(&s, "workspace_low_timeline");
    scene_drag(&s, 950, 300, 800, 300, 6);
    assert_float_equal(app_looks_of(s.app)->layouts.now.width[PLACE_RIGHT], 480.0f, 1.5f);
    scene_look(&s, "workspace_wide_dock");
    scene_check_words(&s);
    scene_close(&s);
}

static void a_face_and_a_show_are_opened_by_their_names_in_the_bar(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_click_word(&s, "puppet");
    scene_look(&s, "workspace_open_face");
    assert_non_null(scene_word(&s, "come with marotte"));
    scene_click_word(&s, "../");
    scene_click_word(&s, "moai/");
    scene_click_word(&s, "moai.rig.json");
    scene_key(&s, UI_KEY_ENTER, 0);
    scene_frames(&s, 3);
    assert_non_null(strstr(app_face_path(s.app), "moai.rig.json"));
    scene_look(&s, "workspace_moai");
    scene_click_word(&s, "moai");
    scene_click_word(&s, "puppet");
    scene_frames(&s, 3);
    assert_non_null(strstr(app_face_path(s.app), "puppet.rig.json"));
    scene_click_word(&s, "night");
    scene_type(&s, "second"); /* the first field has the focus */
    assert_non_null(scene_word(&s, "Create"));
    scene_key(&s, UI_KEY_ENTER, 0);
    scene_frames(&s, 3);
    assert_non_null(strstr(show_path(app_show(s.app)), "/second.marotte"));
    assert_non_null(scene_word(&s, "second"));
    scene_close(&s);
}

/* ---- leaving ---- */

typedef struct work {
    int saved, left;
    bool fails;
} work;

static mrt_result save_work(void *owner, error *err)
{
    work *w = owner;
    w->saved += 1;
    return w->fails ? error_set(err, MRT_ERR_IO, "the disk is full") : MRT_OK;
}

static void leave_work(void *owner)
{
    ((work *)owner)->left += 1;
}

static void work_that_is_not_saved_is_asked_about(void **state)
{
    scene s;
    work w = {.fails = true};
    const app_unsaved unsaved = {&w, "the rig puppet.rig.json", save_work, leave_work};
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    app_set_unsaved(s.app, &unsaved);
    scene_do(&s, ACTION_QUIT);
    scene_frames(&s, 2);
    scene_look(&s, "workspace_unsaved");
    assert_false(s.is_over);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_false(s.is_over);
    assert_false(app_wants_to_quit(s.app));
    scene_do(&s, ACTION_QUIT);
    scene_click_word(&s, "Stay");
    assert_false(s.is_over);
    scene_do(&s, ACTION_QUIT);
    scene_click_word(&s, "Save");
    assert_int_equal(w.saved, 1);
    assert_false(s.is_over);
    w.fails = false;
    scene_do(&s, ACTION_QUIT);
    scene_click_word(&s, "Don't save");
    assert_int_equal(w.left, 1);
    assert_true(s.is_over);
    app_set_unsaved(s.app, NULL);
    scene_close(&s);
}

static void without_unsaved_work_the_window_closes_at_once(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_QUIT);
    assert_true(s.is_over);
    scene_close(&s);
}

/* ---- the output ---- */

static void the_output_shows_the_face_alone_and_mirrored(void **state)
{
    scene s;
    error err = {0};
    uint32_t width, height;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_OUTPUT);
    scene_frames(&s, 3);
    assert_true(window_has_output(s.window));
    window_output_size(s.window, &width, &height);
    assert_int_equal(width, 1280);
    assert_int_equal(window_hidden_output_picture(s.window, BUILD_DIR "/out/output.png", &err),
                     MRT_OK);
    scene_do(&s, ACTION_OUTPUT_MIRROR);
    scene_frames(&s, 3);
    assert_int_equal(
        window_hidden_output_picture(s.window, BUILD_DIR "/out/output_mirrored.png", &err), MRT_OK);
    scene_do(&s, ACTION_OUTPUT);
    assert_false(window_has_output(s.window));
    scene_close(&s);
}

static void the_output_is_clear_where_the_face_is_not(void **state)
{
    scene s;
    error err = {0};
    app_picture wanted = {.background = "transparent", .is_on_top = true};
    png_image image = {.version = PNG_IMAGE_VERSION};
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    app_set_picture(s.app, &wanted);
    scene_do(&s, ACTION_OUTPUT);
    scene_frames(&s, 3);
    assert_int_equal(window_hidden_output_picture(s.window, BUILD_DIR "/out/clear.png", &err),
                     MRT_OK);
    assert_true(png_image_begin_read_from_file(&image, BUILD_DIR "/out/clear.png"));
    image.format = PNG_FORMAT_RGBA;
    uint8_t *rgba = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(rgba);
    assert_true(png_image_finish_read(&image, NULL, rgba, 0, NULL));
    uint32_t partly = 0;
    for (size_t i = 0; i < (size_t)image.width * image.height; ++i) {
        const uint8_t *at = rgba + 4 * i;
        for (int k = 0; k < 3; ++k) /* premultiplied */
            assert_true(at[k] <= at[3] + 1);
        partly += at[3] > 0 && at[3] < 255;
    }
    assert_int_equal(rgba[3], 0);
    assert_int_equal(rgba[4 * ((size_t)image.height / 2 * image.width + image.width / 2) + 3], 255);
    assert_true(partly > 100); /* its edge is smooth */
    free(rgba);
    (void)snprintf(wanted.background, sizeof wanted.background, "%s", "#00b140");
    app_set_picture(s.app, &wanted);
    scene_frames(&s, 3);
    assert_true(window_has_output(s.window)); /* opened anew */
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_face_is_drawn_with_all_around_it),
        cmocka_unit_test(every_part_can_be_read_at_1280_by_720),
        cmocka_unit_test(every_part_can_be_read_at_2560_by_1440),
        cmocka_unit_test(a_narrow_window_is_readable_too),
        cmocka_unit_test(a_corner_of_the_mouth_is_dragged_with_the_mouse),
        cmocka_unit_test(record_is_told_large_and_the_take_is_chosen),
        cmocka_unit_test(keys_do_nothing_while_something_is_typed),
        cmocka_unit_test(a_question_mark_of_any_keyboard_opens_the_help),
        cmocka_unit_test(the_keyboard_is_a_hand_until_escape),
        cmocka_unit_test(an_error_stays_until_it_is_clicked),
        cmocka_unit_test(a_window_that_was_maximised_is_kept_as_such),
        cmocka_unit_test(the_edges_of_timeline_and_dock_are_dragged),
        cmocka_unit_test(a_face_and_a_show_are_opened_by_their_names_in_the_bar),
        cmocka_unit_test(work_that_is_not_saved_is_asked_about),
        cmocka_unit_test(without_unsaved_work_the_window_closes_at_once),
        cmocka_unit_test(the_output_shows_the_face_alone_and_mirrored),
        cmocka_unit_test(the_output_is_clear_where_the_face_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
