/* Life in the window: on in a new show, its switches and strengths in the panel Poses, undo, and
 * its lane on the timeline. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "window/scene.h"

#include "window/app/kept_life.h"

static kept_life *life_of(scene *s)
{
    return app_life(s->app);
}

static double apart_mm(const live_view *a, const float *rows)
{
    double most = 0.0;
    for (size_t i = 0; i < (size_t)a->vertex_count * 3; ++i)
        most = fmax(most, fabs((double)a->position[i] - (double)rows[i]));
    return most;
}

typedef struct moment {
    float *rows;
    double moved_mm;
} moment;

static bool has_moved(scene *s, void *data)
{
    const moment *m = data;
    return apart_mm(app_view(s->app), m->rows) > m->moved_mm;
}

static moment moment_of(scene *s)
{
    const live_view *view = app_view(s->app);
    const size_t size = (size_t)view->vertex_count * 3 * sizeof(float);
    moment out = {.rows = malloc(size), .moved_mm = 0.3};
    assert_non_null(out.rows);
    memcpy(out.rows, view->position, size);
    return out;
}

static void open_alive(scene *s, bool lives)
{
    scene_options options = {
        .width_px = 1400, .height_px = 900, .scale = 1.0f, .mapping = "anchored", .lives = lives};
    scene_prepare(s, &options);
    scene_open_again(s, &options);
}

static bool is_on(scene *s)
{
    bool is_any = false;
    for (int i = 0; i < LIFE_KINDS; ++i)
        is_any |= kept_life_now(life_of(s))->is_on[i];
    return is_any;
}

static void a_new_show_lives_and_an_old_one_keeps_its_switches(void **state)
{
    (void)state;
    scene s;
    open_alive(&s, true);
    const uint32_t seed = kept_life_now(life_of(&s))->seed;
    for (int i = 0; i < LIFE_KINDS; ++i)
        assert_true(kept_life_now(life_of(&s))->is_on[i]);
    moment m = moment_of(&s);
    assert_true(scene_until(&s, has_moved, &m));
    free(m.rows);
    assert_non_null(scene_word(&s, "Try a demo hand")); /* life is no device */
    life_settings to = *kept_life_now(life_of(&s));
    to.is_on[LIFE_GAZE] = false;
    to.strength[LIFE_BREATH] = 0.25;
    kept_life_change(life_of(&s), &to, "test");
    scene_frames(&s, 3);
    const scene_options again = {
        .width_px = 1400, .height_px = 900, .scale = 1.0f, .mapping = "anchored", .lives = true};
    scene_open_again(&s, &again);
    const life_settings *now = kept_life_now(life_of(&s));
    assert_true(now->is_on[LIFE_BLINK] && !now->is_on[LIFE_GAZE]);
    assert_true(fabs(now->strength[LIFE_BREATH] - 0.25) < 1e-6);
    assert_int_equal(now->seed, seed);
    scene_close(&s);
}

static void without_the_option_the_face_keeps_still(void **state)
{
    (void)state;
    scene s;
    open_alive(&s, false);
    assert_false(is_on(&s));
    assert_int_equal(live_input_count(app_live(s.app)), 0);
    scene_close(&s);
}

static void switches_and_strengths_are_undone(void **state)
{
    (void)state;
    scene s;
    open_alive(&s, true);
    scene_do(&s, ACTION_PANEL_POSES);
    scene_frames(&s, 3);
    scene_click_word(&s, "Life");
    scene_frames(&s, 2);
    scene_click_word(&s, "Blinks");
    scene_frames(&s, 2);
    assert_false(kept_life_now(life_of(&s))->is_on[LIFE_BLINK]);
    assert_true(kept_life_now(life_of(&s))->is_on[LIFE_GAZE]);
    scene_do(&s, ACTION_UNDO);
    scene_frames(&s, 2);
    assert_true(kept_life_now(life_of(&s))->is_on[LIFE_BLINK]);
    scene_do(&s, ACTION_LIFE); /* all at once */
    scene_frames(&s, 2);
    assert_false(is_on(&s));
    scene_do(&s, ACTION_UNDO);
    scene_frames(&s, 2);
    assert_true(is_on(&s));
    scene_do(&s, ACTION_REDO);
    scene_frames(&s, 2);
    assert_false(is_on(&s));
    scene_close(&s);
}

static bool is_recording(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording && app_status(s->app)->recorded_ns > NS_PER_S;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return !app_status(s->app)->is_recording && app_take(s->app) &&
           !app_take(s->app)->is_recording && app_take(s->app)->layer_count > 0;
}

static int32_t layer_named(scene *s, const char *name)
{
    const take *t = app_take(s->app);
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        if (strcmp(t->layer[i].name, name) == 0)
            return (int32_t)i;
    return -1;
}

static void life_is_a_lane_of_the_take(void **state)
{
    (void)state;
    scene s;
    open_alive(&s, true);
    moment m = moment_of(&s);
    assert_true(scene_until(&s, has_moved, &m));
    free(m.rows);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recording, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, NULL));
    scene_frames(&s, 30);
    const int32_t lane = layer_named(&s, "life");
    assert_true(lane > 0);
    assert_non_null(scene_word(&s, "life"));
    edit e;
    edit_init(&e, EDIT_LAYER_MUTE);
    e.layer = app_take(s.app)->layer[lane].id;
    e.is_muted = true;
    assert_true(app_edit(s.app, &e) >= 0);
    assert_true(app_take(s.app)->layer[lane].is_muted);
    edit_init(&e, EDIT_LAYER_REMOVE);
    e.layer = app_take(s.app)->layer[lane].id;
    assert_true(app_edit(s.app, &e) >= 0);
    assert_int_equal(layer_named(&s, "life"), -1);
    scene_do(&s, ACTION_UNDO);
    scene_do(&s, ACTION_UNDO);
    assert_false(app_take(s.app)->layer[lane].is_muted);
    assert_int_equal(layer_named(&s, "life"), lane);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_show_lives_and_an_old_one_keeps_its_switches),
        cmocka_unit_test(without_the_option_the_face_keeps_still),
        cmocka_unit_test(switches_and_strengths_are_undone),
        cmocka_unit_test(life_is_a_lane_of_the_take),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
