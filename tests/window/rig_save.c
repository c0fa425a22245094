/* The rig in the whole window: painted while the stage performs, saved by its key, undone by its
 * key, asked about at the end, offered again at the next start. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"
#include "face/rig.h"
#include "window/panels/panels.h"
#include "window/viewport/viewport.h"

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    char command[512];
    strcpy(folder, "/tmp/marotte_rig_XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    (void)snprintf(command, sizeof command, "cp %s/rigs/puppet/puppet.* %s/", SOURCE_DIR, folder);
    return system(command);
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static void open_puppet(scene *s, bool is_again)
{
    static char face_path[128], kept[128];
    (void)snprintf(face_path, sizeof face_path, "%s/puppet.rig.json", folder);
    (void)snprintf(kept, sizeof kept, "%s/window.json", folder);
    const scene_options options = {.width_px = 1280,
                                   .height_px = 720,
                                   .scale = 1.0f,
                                   .face = face_path,
                                   .settings_path = kept};
    if (is_again)
        scene_open_again(s, &options);
    else
        scene_open_with(s, &options);
    scene_let_cut(s, "No takes yet"); /* of the timeline, where it is low */
}

static bool has_rig_panel(scene *s, void *data)
{
    (void)data;
    return scene_word(s, "Regions") != NULL;
}

static bool stage_has_paint(scene *s, void *data)
{
    const rig *r = app_face(s->app)->rig;
    (void)data;
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (r->region[i].name && strcmp(r->region[i].name, "painted skull") == 0)
            return true;
    return false;
}

static bool stage_has_none(scene *s, void *data)
{
    return !stage_has_paint(s, data);
}

static bool is_unsaved(scene *s, void *data)
{
    (void)data;
    return app_unsaved_now(s->app) != NULL;
}

static bool is_saved(scene *s, void *data)
{
    return !is_unsaved(s, data);
}

/* Over the middle of the picture's face. */
static void paint(scene *s)
{
    scene_key(s, UI_KEY_F1 + 3, 0);
    assert_true(scene_until(s, has_rig_panel, NULL));
    scene_frames(s, 30);
    scene_click_word(s, "Paint");
    float x = 0.33f * s->width, y = 0.40f * s->height;
    scene_drag(s, x, y, x + 60.0f, y + 20.0f, 6);
    assert_true(scene_until(s, is_unsaved, NULL));
}

static rig read_saved(void)
{
    char path[128];
    error err = {""};
    rig r;
    (void)snprintf(path, sizeof path, "%s/puppet.rig.json", folder);
    if (rig_read(&r, path, &err) < 0)
        fail_msg("%s", err.text);
    return r;
}

static void what_is_painted_is_performed_undone_and_saved(void **state)
{
    scene s;
    (void)state;
    open_puppet(&s, false);
    uint64_t inputs = live_input_count(app_live(s.app));
    paint(&s);
    assert_true(scene_until(&s, stage_has_paint, NULL));
    assert_int_equal(live_input_count(app_live(s.app)), inputs);
    scene_look(&s, "rig_window");
    scene_check_words(&s);
    scene_key(&s, 'Z', UI_CONTROL);
    assert_true(scene_until(&s, stage_has_none, NULL));
    scene_key(&s, 'Z', UI_CONTROL | UI_SHIFT);
    assert_true(scene_until(&s, stage_has_paint, NULL));
    scene_key(&s, 'S', UI_CONTROL);
    assert_true(scene_until(&s, is_saved, NULL));
    rig r = read_saved();
    assert_string_equal(r.region[r.region_count - 1].name, "painted skull");
    rig_destroy(&r);
    scene_close(&s);
}

static bool has_face_at(scene *s, void *path)
{
    return strcmp(app_face_path(s->app), path) == 0;
}

static void under_another_name_it_goes_on_there_and_undo_too(void **state)
{
    scene s;
    char path[128];
    error err = {""};
    rig r;
    (void)state;
    open_puppet(&s, false);
    rig before = read_saved();
    paint(&s);
    assert_true(scene_until(&s, stage_has_paint, NULL));
    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT);
    assert_true(ui_has_dialog(s.ui));
    scene_look(&s, "rig_save_as");
    scene_check_words(&s);
    (void)snprintf(path, sizeof path, "%s/puppet 2.rig.json", folder);
    assert_non_null(scene_word(&s, path)); /* the first name that is free */
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_false(ui_has_dialog(s.ui));
    assert_true(scene_until(&s, has_face_at, path));
    assert_true(scene_until(&s, is_saved, NULL));
    assert_true(rig_read(&r, path, &err) >= 0);
    assert_string_equal(r.region[r.region_count - 1].name, "painted skull");
    rig_destroy(&r);
    r = read_saved();
    assert_int_equal(r.region_count, before.region_count); /* the old one is as it was */
    rig_destroy(&r);
    scene_frames(&s, 30);
    scene_key(&s, 'Z', UI_CONTROL);
    assert_true(scene_until(&s, stage_has_none, NULL));
    assert_true(scene_until(&s, is_unsaved, NULL));

    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT); /* one that is there: asked for twice */
    scene_key(&s, 'A', UI_CONTROL);
    scene_type(&s, "puppet");
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_non_null(scene_word_with(&s, "already exists"));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_true(is_unsaved(&s, NULL));

    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT); /* away from its mesh: refused */
    scene_key(&s, 'A', UI_CONTROL);
    scene_type(&s, "/tmp/marotte_elsewhere/x");
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_non_null(scene_word_with(&s, "in the folder of its mesh or in a folder above it"));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_string_equal(app_face_path(s.app), path);
    rig_destroy(&before);
    scene_close(&s);
}

static bool has_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->recorded_ns > NS_PER_S / 2;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return app_take(s->app) != NULL && !app_status(s->app)->is_recording;
}

static bool was_said(scene *s, const char *part)
{
    const news_list *news = app_news(s->app);
    const uint32_t count = news_list_count(news);
    return count > 0 && strstr(news_list_at(news, count - 1)->text, part);
}

/* What is done to a take beside the rig is in front; what was done before is not. */
static void undo_in_the_rig_stops_before_what_was_done_to_takes(void **state)
{
    scene s;
    (void)state;
    open_puppet(&s, false);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_recorded, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, NULL));
    scene_do(&s, ACTION_RATE_4);
    paint(&s);
    assert_true(scene_until(&s, stage_has_paint, NULL));
    scene_key(&s, 'Z', UI_CONTROL);
    assert_true(scene_until(&s, stage_has_none, NULL));
    assert_true(was_said(&s, "undone: rig: "));
    scene_key(&s, 'Z', UI_CONTROL);
    assert_int_equal(app_take(s.app)->rating, 4);
    assert_true(was_said(&s, "Leave the panel Rig"));
    scene_look(&s, "rig_undo_stops");
    scene_do(&s, ACTION_RATE_2);
    scene_key(&s, 'Z', UI_CONTROL);
    assert_int_equal(app_take(s.app)->rating, 4);
    scene_key(&s, 'Z', UI_CONTROL);
    assert_int_equal(app_take(s.app)->rating, 4);
    scene_do(&s, ACTION_PANEL_DEVICES);
    scene_key(&s, 'Z', UI_CONTROL);
    assert_int_equal(app_take(s.app)->rating, 0);
    assert_true(was_said(&s, "undone: "));
    scene_close(&s);
}

static void what_is_not_saved_is_asked_about_and_offered_again(void **state)
{
    scene s;
    (void)state;
    open_puppet(&s, false);
    paint(&s);
    assert_true(scene_until(&s, stage_has_paint, NULL));
    scene_key(&s, 'Q', UI_CONTROL);
    scene_frames(&s, 5);
    assert_false(s.is_over);
    scene_look(&s, "rig_quit");
    scene_check_words(&s);
    open_puppet(&s, true); /* as when it is killed: nothing was answered */
    scene_key(&s, UI_KEY_F1 + 3, 0);
    assert_true(scene_until(&s, has_rig_panel, NULL));
    scene_look(&s, "rig_offer");
    scene_check_words(&s);
    scene_click_word(&s, "Restore");
    assert_true(scene_until(&s, is_unsaved, NULL));
    scene_key(&s, 'S', UI_CONTROL);
    assert_true(scene_until(&s, is_saved, NULL));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_is_painted_is_performed_undone_and_saved, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(under_another_name_it_goes_on_there_and_undo_too,
                                        make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(undo_in_the_rig_stops_before_what_was_done_to_takes,
                                        make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_is_not_saved_is_asked_about_and_offered_again,
                                        make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
