/* Only what is new is drawn; so the whole window is clicked through, and after each step what lies
 * on the screen is compared with the same frame drawn anew: no pixel may differ. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "base/file.h"
#include "window/scene.h"

static void keep_picture(const scene *s, file_bytes *out, const char *name)
{
    char path[160];
    error err = {0};
    (void)snprintf(path, sizeof path, "%s/%s.png", s->folder, name);
    if (window_picture(s->window, path, &err) < 0 || file_read(out, path, 64 << 20, &err) < 0)
        fail_msg("%s", err.text);
}

/* The frames of a step, and the last of them as it was left on the screen. */
static void check(scene *s, const char *what)
{
    file_bytes shown, anew;
    scene_look(s, what);
    keep_picture(s, &shown, "shown");
    window_hidden_draw_again(s->window, s->ui);
    keep_picture(s, &anew, "anew");
    const bool is_same = shown.size == anew.size && memcmp(shown.data, anew.data, shown.size) == 0;
    file_bytes_finish(&shown);
    file_bytes_finish(&anew);
    if (!is_same) {
        char command[300];
        (void)snprintf(command, sizeof command, "cp %s/shown.png %s/anew.png /tmp", s->folder,
                       s->folder);
        if (system(command) == 0)
            fail_msg("%s: something on the screen is stale (/tmp/shown.png, /tmp/anew.png)", what);
    }
}

static void press(scene *s, uint32_t key, uint32_t modifiers, const char *what)
{
    scene_key(s, key, modifiers);
    check(s, what);
}

/* Over all of the window, along a line that meets tabs, buttons, the face, the timeline. */
static void hover(scene *s)
{
    for (uint32_t i = 0; i <= 24; ++i) {
        scene_move(s, s->width * (float)i / 24.0f, s->height * (float)(i * 7 % 24) / 24.0f);
        scene_frames(s, 2);
        if (i % 3 == 0)
            check(s, "hovered");
    }
    scene_frames(s, 45); /* a hint comes */
    check(s, "hinted");
    scene_move(s, -10000.0f, -10000.0f);
}

static void open_drawn(scene *s, float scale, const char *const *inputs, uint32_t input_count)
{
    const scene_options options = {.width_px = 960,
                                   .height_px = 600,
                                   .scale = scale,
                                   .inputs = inputs,
                                   .input_count = input_count,
                                   .is_drawn = true};
    scene_open_with(s, &options);
    check(s, "opened");
}

static void panels_menus_and_hints_leave_nothing_behind(void **state)
{
    (void)state;
    scene s;
    open_drawn(&s, 1.0f, NULL, 0);
    hover(&s);
    for (int panel = ACTION_PANEL_DEVICES; panel < ACTION_PANEL_DEVICES + (int)APP_PANELS;
         ++panel) {
        app_do(s.app, (action)panel);
        scene_frames(&s, 3);
        check(&s, "panel");
    }
    press(&s, '/', UI_SHIFT, "help");
    press(&s, UI_KEY_ESCAPE, 0, "help ends");
    app_do(s.app, ACTION_OPEN);
    scene_frames(&s, 4);
    check(&s, "question");
    press(&s, UI_KEY_ESCAPE, 0, "question ends");
    app_do(s.app, ACTION_TIMELINE);
    scene_frames(&s, 2);
    check(&s, "no timeline");
    app_do(s.app, ACTION_TIMELINE);
    app_do(s.app, ACTION_SHOW_CONTACTS);
    scene_frames(&s, 2);
    check(&s, "contacts");
    app_do(s.app, ACTION_SHOW_CARD);
    scene_frames(&s, 3);
    check(&s, "card");
    scene_close(&s);
}

static void looks_and_sizes_leave_nothing_behind(void **state)
{
    (void)state;
    scene s;
    open_drawn(&s, 1.0f, NULL, 0);
    app_looks *looks = app_looks_of(s.app);
    looks->theme.is_light = true;
    scene_frames(&s, 3);
    check(&s, "light");
    looks->text_size = 1.25f;
    scene_frames(&s, 3);
    check(&s, "large");
    looks->layouts.now.width[PLACE_RIGHT] = 380.0f;
    scene_frames(&s, 3);
    check(&s, "wide dock");
    looks->is_mirrored = true;
    scene_frames(&s, 2);
    check(&s, "mirrored");
    app_do(s.app, ACTION_VIEW_SIDE);
    for (int i = 0; i < 6; ++i) {
        scene_frames(&s, 3);
        check(&s, "glide");
    }
    scene_drag(&s, 200.0f, 250.0f, 300.0f, 270.0f, 6);
    check(&s, "dragged");
    looks->is_face_only = true;
    scene_frames(&s, 2);
    check(&s, "face only");
    window_hidden_put_away(s.window, true);
    looks->is_face_only = false;
    scene_frames(&s, 3);
    window_hidden_put_away(s.window, false);
    scene_frames(&s, 1);
    check(&s, "shown again");
    scene_close(&s);
}

static bool is_recording(scene *s, void *data)
{
    return app_status(s->app)->is_recording == *(bool *)data;
}

static bool is_chosen(scene *s, void *data)
{
    const char *why;
    (void)data;
    if (app_can(s->app, ACTION_PLAY, &why))
        return true;
    if (app_can(s->app, ACTION_TAKE_BEFORE, &why)) /* once the take is in the list */
        app_do(s->app, ACTION_TAKE_BEFORE);
    return false;
}

static void a_hand_a_take_and_the_playhead_leave_nothing_behind(void **state)
{
    (void)state;
    char text[512];
    scene s;
    bool yes = true, no = false;
    (void)snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,start=2,loop=1",
                   SOURCE_DIR);
    const char *const inputs[] = {text};
    open_drawn(&s, 1.13f, inputs, 1); /* clips end between two pixels */
    app_do(s.app, ACTION_RECORD);
    assert_true(scene_until(&s, is_recording, &yes));
    for (int i = 0; i < 6; ++i) {
        scene_frames(&s, 4);
        check(&s, "recording");
    }
    app_do(s.app, ACTION_RECORD);
    assert_true(scene_until(&s, is_recording, &no));
    check(&s, "recorded");
    assert_true(scene_until(&s, is_chosen, NULL));
    check(&s, "chosen");
    app_do(s.app, ACTION_PLAY);
    for (int i = 0; i < 6; ++i) {
        scene_frames(&s, 4);
        check(&s, "playing");
    }
    app_do(s.app, ACTION_STOP);
    scene_frames(&s, 3);
    check(&s, "stopped");
    scene_click_with(&s, 400.0f, 540.0f, 1);
    check(&s, "menu");
    press(&s, UI_KEY_ESCAPE, 0, "menu ends");
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(panels_menus_and_hints_leave_nothing_behind),
        cmocka_unit_test(looks_and_sizes_leave_nothing_behind),
        cmocka_unit_test(a_hand_a_take_and_the_playhead_leave_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
