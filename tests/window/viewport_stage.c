/* The mouse and the virtual hand on a real stage: from events to vertices. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "window/panels/panels.h"
#include "window/viewport/viewport.h"
#include "window/scene.h"

static scene s;

static const live_view *view_now(void)
{
    return app_view(s.app);
}

static const viewport_stroke *stroke_at(float x, float y)
{
    scene_move(&s, x, y);
    scene_settle(&s);
    return viewport_stroke_now(app_viewport(s.app));
}

/* From the front the slope of the pointer's ray is linear in where it is on the screen. */
typedef struct lens {
    double eye[3], across, across_step, up, up_step; /* slopes at 0, and by the point */
} lens;

static lens find_lens(void)
{
    const float x[2] = {200, 400}, y[2] = {150, 300};
    double across[2], up[2];
    lens l = {.eye = {0}};
    for (int i = 0; i < 2; ++i) {
        const viewport_stroke *stroke = stroke_at(x[i], y[i]);
        across[i] = (double)stroke->ray[0] / -(double)stroke->ray[2];
        up[i] = (double)stroke->ray[1] / -(double)stroke->ray[2];
        for (int k = 0; k < 3; ++k)
            l.eye[k] = (double)stroke->eye[k];
    }
    l.across_step = (across[1] - across[0]) / (double)(x[1] - x[0]);
    l.up_step = (up[1] - up[0]) / (double)(y[1] - y[0]);
    l.across = across[0] - (double)x[0] * l.across_step;
    l.up = up[0] - (double)y[0] * l.up_step;
    return l;
}

static void screen_of(const lens *l, vec3 at, float *out_x, float *out_y)
{
    double depth = l->eye[2] - at.z;
    *out_x = (float)round(((at.x - l->eye[0]) / depth - l->across) / l->across_step);
    *out_y = (float)round(((at.y - l->eye[1]) / depth - l->up) / l->up_step);
}

static uint32_t contact_named(const char *name)
{
    const mrt_face *about = view_now()->about;
    for (uint32_t i = 0; i < about->contact_count; ++i)
        if (strcmp(about->contacts[i].name, name) == 0)
            return i;
    fail_msg("the puppet has no contact %s", name);
    return 0;
}

static float dof_now(const char *name)
{
    const mrt_face *about = view_now()->about;
    for (uint32_t i = 0; i < about->dof_count; ++i)
        if (strcmp(about->dofs[i].name, name) == 0)
            return view_now()->meter.dof[i];
    fail_msg("the puppet has no %s", name);
    return 0.0f;
}

typedef struct wait_for {
    uint32_t contact;
    vec3 at;          /* mm */
    double within_mm; /* of it; < 0: further away than that */
    const char *dof;
    float more, less; /* than the other */
} wait_for;

static bool contact_is_there(scene *of, void *data)
{
    const wait_for *w = data;
    double away = vec3_length(vec3_sub(app_view(of->app)->contact[w->contact], w->at));
    return w->within_mm >= 0.0 ? away <= w->within_mm : away >= -w->within_mm;
}

static bool dof_is_so(scene *of, void *data)
{
    const wait_for *w = data;
    (void)of;
    float value = dof_now(w->dof);
    return value > w->more && value < w->less;
}

static void a_drag_on_the_mouth_corner_moves_it_by_the_drag(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    uint32_t corner = contact_named("mouth.corner.l");
    vec3 rest = view_now()->contact[corner];
    const lens l = find_lens();
    float x, y;
    screen_of(&l, rest, &x, &y);
    assert_int_equal(stroke_at(x, y)->contact, corner + 1);
    scene_button(&s, 0, true);
    scene_settle(&s);
    (void)stroke_at(x + 22, y - 16);
    double depth = l.eye[2] - rest.z;
    vec3 way = {22.0 * l.across_step * depth, -16.0 * l.up_step * depth, 0.0};
    wait_for there = {
        .contact = corner, .at = vec3_add(rest, way), .within_mm = 0.1 * vec3_length(way)};
    assert_true(scene_until(&s, contact_is_there, &there));
    scene_look(&s, "viewport_drag");
    scene_let_cut(&s, "No takes yet");
    scene_check_words(&s);
    scene_button(&s, 0, false);
    scene_settle(&s);
    wait_for back = {.contact = corner, .at = rest, .within_mm = 0.5};
    assert_true(scene_until(&s, contact_is_there, &back)); /* lightly pulled: it springs back */
    scene_close(&s);
}

static void with_shift_it_stays_until_a_double_click(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    uint32_t chin = contact_named("chin");
    scene_stillness still = {0};
    vec3 rest = view_now()->contact[chin];
    const lens l = find_lens();
    float x, y;
    screen_of(&l, rest, &x, &y);
    (void)stroke_at(x, y);
    scene_button(&s, 0, true);
    scene_settle(&s);
    (void)stroke_at(x, y + 15);
    scene_hold_key(&s, UI_KEY_SHIFT, true);
    scene_settle(&s);
    scene_button(&s, 0, false);
    scene_settle(&s);
    scene_hold_key(&s, UI_KEY_SHIFT, false);
    assert_true(scene_until(&s, scene_is_still, &still));
    vec3 stays = view_now()->contact[chin];
    assert_true(vec3_length(vec3_sub(stays, rest)) > 3.0);
    screen_of(&l, stays, &x, &y);
    assert_int_equal(stroke_at(x, y)->contact, chin + 1);
    for (int click = 0; click < 2; ++click) {
        scene_button(&s, 0, true);
        scene_frame(&s);
        scene_button(&s, 0, false);
        scene_frame(&s);
    }
    wait_for back = {.contact = chin, .at = rest, .within_mm = 0.5};
    assert_true(scene_until(&s, contact_is_there, &back));
    scene_close(&s);
}

/* ---- what stays is undone ---- */

typedef struct face_rows {
    float *row;
    size_t size;
} face_rows;

static face_rows face_now(void)
{
    const size_t size = (size_t)view_now()->vertex_count * 3 * sizeof(float);
    face_rows out = {malloc(size), size};
    assert_non_null(out.row);
    memcpy(out.row, view_now()->position, size);
    return out;
}

static bool is_face(scene *of, void *data)
{
    const face_rows *wanted = data;
    return memcmp(app_view(of->app)->position, wanted->row, wanted->size) == 0;
}

static face_rows pull_with(uint32_t modifiers, float x, float y)
{
    scene_stillness still = {0};
    scene_modifiers(&s, modifiers, true);
    scene_drag(&s, x, y, x + 20.0f, y + 25.0f, 12);
    scene_modifiers(&s, modifiers, false);
    assert_true(scene_until(&s, scene_is_still, &still));
    return face_now();
}

static void expect_face(const face_rows *wanted, const char *when)
{
    if (scene_until(&s, is_face, (void *)(uintptr_t)wanted))
        return;
    float most = 0.0f;
    for (size_t i = 0; i < wanted->size / sizeof(float); ++i)
        most = fmaxf(most, fabsf(view_now()->position[i] - wanted->row[i]));
    fail_msg("%s: another face, by %g mm", when, (double)most);
}

static void pulls_and_clay_are_undone_and_done_again_bit_for_bit(void **state)
{
    (void)state;
    enum { PULLS = 4 };
    static const uint32_t modifiers[PULLS] = {UI_SHIFT, UI_CONTROL, UI_SHIFT, UI_CONTROL};
    static const char *const words[PULLS] = {"pull of", "clay", "pull of", "clay"};
    face_rows shown[PULLS + 1];
    scene_open(&s, 1280, 720, 1.0f);
    shown[0] = face_now();
    for (uint32_t i = 0; i < PULLS; ++i) {
        shown[i + 1] = pull_with(modifiers[i], 440.0f + 15.0f * (float)i, 260.0f);
        assert_false(is_face(&s, &shown[i]));
    }
    assert_non_null(scene_word(&s, "Held pulls. Press N to clear them"));
    scene_do(&s, ACTION_NEUTRAL);
    expect_face(&shown[0], "cleared");
    assert_null(scene_word(&s, "Held pulls. Press N to clear them"));
    scene_do(&s, ACTION_UNDO);
    expect_face(&shown[PULLS], "clearing undone");
    assert_non_null(scene_word_with(&s, "undone: release"));
    for (uint32_t i = PULLS; i > 0; --i) {
        scene_do(&s, ACTION_UNDO);
        expect_face(&shown[i - 1], "undone");
        assert_non_null(scene_word_with(&s, words[i - 1]));
        if (i == 3)
            scene_look(&s, "viewport_undone");
    }
    assert_null(scene_word(&s, "Held pulls. Press N to clear them"));
    for (uint32_t i = 1; i <= PULLS; ++i) {
        scene_do(&s, ACTION_REDO);
        expect_face(&shown[i], "redone");
    }
    assert_non_null(scene_word(&s, "Held pulls. Press N to clear them"));
    for (uint32_t i = 0; i <= PULLS; ++i)
        free(shown[i].row);
    scene_close(&s);
}

static void hold_until(uint32_t key, const char *dof, float more, float less)
{
    scene_hold_key(&s, key, true);
    wait_for w = {.dof = dof, .more = more, .less = less};
    if (!scene_until(&s, dof_is_so, &w))
        fail_msg("%s is %g, which is not between %g and %g", dof, (double)dof_now(dof),
                 (double)more, (double)less);
}

static void the_keys_move_a_hand_that_moves_the_face(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    uint32_t brow = contact_named("brow.mid.l"), corner = contact_named("mouth.corner.l");
    vec3 brow_rest = view_now()->contact[brow], corner_rest = view_now()->contact[corner];
    scene_do(&s, ACTION_HAND_KEYS);
    assert_true(app_has_hand_keys(s.app));
    scene_frames(&s, 60); /* the mapping takes the resting hand for its neutral pose */
    assert_int_equal(live_input_count(app_live(s.app)), 1);
    assert_true(vec3_length(vec3_sub(view_now()->contact[brow], brow_rest)) < 0.5);

    hold_until(' ', "jaw.open", 0.25f, 9.0f); /* the thumb drops: the mouth opens */
    scene_look(&s, "viewport_hand_keys");
    scene_let_cut(&s, "No takes yet");
    scene_check_words(&s);
    scene_hold_key(&s, ' ', false);
    wait_for closed = {.dof = "jaw.open", .more = -9.0f, .less = 0.03f};
    assert_true(scene_until(&s, dof_is_so, &closed));

    scene_hold_key(&s, 'U', true); /* the index finger lifts: brows */
    wait_for lifted = {.contact = brow, .at = brow_rest, .within_mm = -4.0};
    assert_true(scene_until(&s, contact_is_there, &lifted));
    scene_hold_key(&s, 'U', false);

    scene_hold_key(&s, 'O', true); /* ring and little finger lift: a smile */
    scene_hold_key(&s, 'P', true);
    wait_for smiles = {.contact = corner, .at = corner_rest, .within_mm = -4.0};
    assert_true(scene_until(&s, contact_is_there, &smiles));
    scene_hold_key(&s, 'O', false);
    scene_hold_key(&s, 'P', false);

    hold_until('K', "lid_upper.l.close", 0.2f, 9.0f); /* the middle finger: lids, quick or slow */
    scene_hold_key(&s, 'K', false);
    bool is_mirrored = app_looks_of(s.app)->is_mirrored; /* right is the picture's */
    hold_until(UI_KEY_RIGHT, "skull.turn", is_mirrored ? -9.0f : 0.1f, is_mirrored ? -0.1f : 9.0f);
    scene_hold_key(&s, UI_KEY_RIGHT, false);

    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_false(app_has_hand_keys(s.app));
    wait_for rests = {.contact = corner, .at = corner_rest, .within_mm = 1.0};
    assert_true(scene_until(&s, contact_is_there, &rests));
    scene_close(&s);
}

static void a_window_that_closes_while_a_take_is_recorded_with_it_keeps_the_take(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_HAND_KEYS);
    scene_frames(&s, 40);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_do(&s, ACTION_RECORD);
    scene_frames(&s, 30);
    assert_true(app_status(s.app)->is_recording);
    scene_close(&s); /* and nothing is left that the stage still reads */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_drag_on_the_mouth_corner_moves_it_by_the_drag),
        cmocka_unit_test(with_shift_it_stays_until_a_double_click),
        cmocka_unit_test(pulls_and_clay_are_undone_and_done_again_bit_for_bit),
        cmocka_unit_test(the_keys_move_a_hand_that_moves_the_face),
        cmocka_unit_test(a_window_that_closes_while_a_take_is_recorded_with_it_keeps_the_take),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
