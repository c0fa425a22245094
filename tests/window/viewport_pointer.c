/* What the pointer does in the viewport, by scripted events. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/overlay.h"
#include "viewport_stand.h"

#include <math.h>
#include <string.h>

#define assert_near(a, b, tolerance)                                                               \
    assert_true(fabs((double)(a) - (double)(b)) <= (double)(tolerance))

enum {
    WIDTH = 640,
    HEIGHT = 480,
    COARSE = 4 /* points a pixel: that it is drawn is looked at, not how */
};
static const char puppet[] = "rigs/puppet/puppet.rig.json";

static viewport_stand s;

static void place_of(const char *contact, float out[3])
{
    vec3 at = s.view.contact[stand_contact(&s, contact)];
    out[0] = (float)at.x;
    out[1] = (float)at.y;
    out[2] = (float)at.z;
}

static void screen_of(const char *contact, float *x, float *y)
{
    float at[3];
    place_of(contact, at);
    stand_place(&s, at, x, y);
}

static const stand_told *last_told(void)
{
    assert_true(s.told_count > 0);
    return &s.told[s.told_count - 1];
}

static void open_plain(void)
{
    stand_open(&s, puppet, WIDTH, HEIGHT, 1.0f);
}

static void open_coarse(void)
{
    stand_open(&s, puppet, WIDTH / COARSE, HEIGHT / COARSE, 1.0f / COARSE);
}

static void an_idle_viewport_draws_nothing(void **state)
{
    (void)state;
    open_coarse();
    stand_show(&s);
    stand_frames(&s, 2);
    uint64_t drawn = viewport_drawn(s.viewport);
    assert_true(drawn > 0);
    stand_frames(&s, 20);
    s.view.number += 1; /* the stage publishes the same shape again */
    stand_frames(&s, 5);
    stand_move(&s, 320, 240); /* the pointer alone draws nothing anew */
    assert_int_equal(viewport_drawn(s.viewport), drawn);
    stand_pull(&s, "chin", 0, -6, 2);
    stand_frame(&s);
    assert_int_equal(viewport_drawn(s.viewport), drawn + 1);
    s.looks.shows_contacts = true;
    stand_frames(&s, 3);
    assert_int_equal(viewport_drawn(s.viewport), drawn + 2);
    stand_close(&s);
}

static void a_drag_moves_the_mouth_corner_by_itself(void **state)
{
    (void)state;
    open_plain();
    s.pulls = true;
    float before[3], after[3], x, y, px[2];
    uint32_t contact = stand_contact(&s, "mouth.corner.l");
    place_of("mouth.corner.l", before);
    stand_place(&s, before, &x, &y);
    stand_move(&s, x + 3, y - 2);
    stand_button(&s, 0, true);
    assert_int_equal(s.told[0].grip, POINTER_PULLS);
    const mrt_vec3 rest = s.view.about->contacts[contact].rest;
    assert_true(s.told[0].rest[0] == rest.x && s.told[0].rest[1] == rest.y);
    for (int i = 0; i < 3; ++i)
        assert_near(s.told[0].at[i], before[i], 1e-4); /* nothing jumps */
    s.view.pull.vector[0].contact = contact + 1;
    stand_move(&s, x + 13, y - 9); /* further, and the skin would be too near to a fold */
    memcpy(after, last_told()->at, sizeof after);
    stand_place(&s, after, &px[0], &px[1]);
    assert_near(px[0], x + 10, 0.1);
    assert_near(px[1], y - 7, 0.1);
    assert_near(after[2], before[2], 1e-3); /* from the front: in the plane of the screen */
    vec3 shown = s.view.contact[contact];
    assert_near(shown.x, after[0], 1.0);
    assert_near(shown.y, after[1], 1.0);
    stand_button(&s, 0, false);
    assert_int_equal(last_told()->grip, POINTER_AWAY);
    assert_false(last_told()->stays);
    stand_close(&s);
}

static void a_mirror_mirrors_what_is_grasped_and_where_it_goes(void **state)
{
    (void)state;
    open_plain();
    s.looks.is_mirrored = true;
    stand_frames(&s, 2);
    float before[3], x, y;
    place_of("mouth.corner.l", before);
    stand_place(&s, before, &x, &y);
    assert_true(x < WIDTH / 2); /* the subject's left: left in a mirror */
    stand_move(&s, x, y);
    const viewport_stroke *stroke = viewport_stroke_now(s.viewport);
    assert_int_equal(stroke->contact, stand_contact(&s, "mouth.corner.l") + 1);
    stand_button(&s, 0, true);
    stand_move(&s, x - 20, y);
    assert_true(last_told()->at[0] > before[0] + 3.0f); /* outwards is outwards */
    stand_button(&s, 0, false);
    stand_close(&s);
}

static void skin_is_pulled_where_it_is_touched(void **state)
{
    (void)state;
    open_plain();
    float x, y, px, py;
    screen_of("nose.tip", &x, &y);
    x = floorf(x);      /* pointers are on whole pixels */
    y = floorf(y) - 60; /* between the eyes: no contact is near */
    stand_move(&s, x, y);
    const viewport_stroke *stroke = viewport_stroke_now(s.viewport);
    assert_true(stroke->is_on_face);
    assert_int_equal(stroke->contact, 0);
    stand_button(&s, 0, true);
    stand_place(&s, last_told()->at, &px, &py);
    assert_near(px, x, 0.1);
    assert_near(py, y, 0.1);
    for (int i = 0; i < 3; ++i)
        assert_near(last_told()->rest[i], last_told()->at[i], 0.05); /* at rest they are the same */
    stand_button(&s, 0, false);
    stand_close(&s);
}

static void control_kneads_and_shift_lets_it_stay(void **state)
{
    (void)state;
    open_plain();
    float x, y;
    screen_of("chin", &x, &y);
    stand_move(&s, x, y);
    stand_key(&s, UI_KEY_CONTROL, true);
    stand_button(&s, 0, true);
    assert_int_equal(last_told()->grip, POINTER_KNEADS);
    stand_key(&s, UI_KEY_CONTROL, false);
    stand_move(&s, x + 4, y);
    assert_int_equal(last_told()->grip, POINTER_KNEADS); /* as it began */
    stand_button(&s, 0, false);
    stand_frames(&s, 30); /* no double click */
    stand_button(&s, 0, true);
    stand_key(&s, UI_KEY_SHIFT, true);
    stand_button(&s, 0, false);
    assert_int_equal(last_told()->grip, POINTER_AWAY);
    assert_true(last_told()->stays);
    stand_key(&s, UI_KEY_SHIFT, false);
    stand_close(&s);
}

static void the_wheel_moves_what_is_held_towards_the_viewer(void **state)
{
    (void)state;
    open_coarse();
    float x, y;
    screen_of("chin", &x, &y);
    stand_move(&s, x, y);
    stand_button(&s, 0, true);
    float before = last_told()->at[2];
    stand_wheel(&s, 3);
    assert_true(last_told()->at[2] > before + 2.0f);
    stand_wheel(&s, -3);
    assert_near(last_told()->at[2], before, 0.01);
    stand_button(&s, 0, false);
    stand_show(&s);
    stand_frames(&s, 2);
    uint64_t drawn = viewport_drawn(s.viewport);
    stand_wheel(&s, 1); /* now it zooms */
    assert_true(viewport_drawn(s.viewport) > drawn);
    stand_close(&s);
}

static void alt_and_the_wheel_change_the_reach(void **state)
{
    (void)state;
    open_plain();
    float x, y;
    screen_of("chin", &x, &y);
    stand_move(&s, x, y);
    stand_key(&s, UI_KEY_ALT, true);
    stand_wheel(&s, 2);
    stand_key(&s, UI_KEY_ALT, false);
    stand_button(&s, 0, true);
    assert_near(last_told()->radius_mm, s.view.solver.radius * 1.12 * 1.12, 0.01);
    stand_button(&s, 0, false);
    stand_close(&s);
}

static void a_double_click_on_a_contact_lets_go_of_all(void **state)
{
    (void)state;
    open_plain();
    float x, y;
    screen_of("chin", &x, &y);
    stand_move(&s, x, y);
    stand_button(&s, 0, true);
    stand_button(&s, 0, false);
    stand_button(&s, 0, true);
    assert_int_equal(last_told()->grip, POINTER_RELEASE_ALL);
    uint32_t told = s.told_count;
    stand_move(&s, x + 30, y);
    stand_button(&s, 0, false);
    assert_int_equal(s.told_count, told); /* and it takes hold of nothing */
    stand_close(&s);
}

static void right_drag_orbits_and_the_face_follows_the_pointer(void **state)
{
    (void)state;
    open_plain();
    float x, y;
    stand_drag(&s, 1, 320, 240, 380, 240);
    screen_of("nose.tip", &x, &y);
    stand_move(&s, x + 30, y); /* the nose went to the right, with the pointer */
    float nose[3];
    place_of("nose.tip", nose);
    const viewport_stroke *stroke = viewport_stroke_now(s.viewport);
    assert_true(stroke->is_on_face);
    assert_true(stroke->forward[0] > 0.1f); /* the eye is at the subject's right */
    assert_int_equal(s.told_count, 0);
    stand_close(&s);
}

static void beside_the_face_the_left_button_orbits(void **state)
{
    (void)state;
    open_coarse();
    stand_show(&s);
    stand_frames(&s, 2);
    uint64_t drawn = viewport_drawn(s.viewport);
    stand_drag(&s, 0, 20, 20, 60, 20);
    assert_true(viewport_drawn(s.viewport) > drawn);
    assert_int_equal(s.told_count, 0);
    stand_close(&s);
}

static void views_are_reached_in_a_fifth_of_a_second(void **state)
{
    (void)state;
    open_coarse();
    s.asked[ACTION_VIEW_SIDE] = true;
    stand_frames(&s, 6);
    assert_true(viewport_stroke_now(s.viewport)->forward[0] < -0.05f); /* on its way */
    assert_true(viewport_stroke_now(s.viewport)->forward[0] > -0.999f);
    stand_frames(&s, 8);
    assert_near(viewport_stroke_now(s.viewport)->forward[0], -1.0, 1e-4); /* from its left */
    stand_show(&s);
    stand_frames(&s, 2);
    uint64_t drawn = viewport_drawn(s.viewport);
    stand_frames(&s, 3);
    assert_int_equal(viewport_drawn(s.viewport), drawn);
    s.asked[ACTION_VIEW_FRONT] = true;
    stand_frames(&s, 14);
    assert_near(viewport_stroke_now(s.viewport)->forward[2], -1.0, 1e-4);
    stand_close(&s);
}

static void a_take_that_is_shown_is_not_pulled(void **state)
{
    (void)state;
    open_plain();
    s.view.mode = LIVE_SHOWS;
    float x, y;
    screen_of("chin", &x, &y);
    stand_drag(&s, 0, x, y, x + 30, y);
    assert_int_equal(s.told_count, 0);
    stand_close(&s);
}

static void whoever_paints_is_given_the_pointer(void **state)
{
    (void)state;
    open_plain();
    float x, y;
    screen_of("chin", &x, &y);
    viewport_set_use(s.viewport, VIEWPORT_PAINTS, 12.0f);
    stand_move(&s, x, y);
    stand_button(&s, 0, true);
    const viewport_stroke *stroke = viewport_stroke_now(s.viewport);
    assert_true(stroke->is_on_face && stroke->is_pressed);
    uint32_t vertex = s.file.rig->contact[stand_contact(&s, "chin")].vertex;
    for (int i = 0; i < 3; ++i) {
        assert_near(stroke->rest[i], s.file.mesh.position[(size_t)vertex * 3 + (size_t)i], 3.0);
        float way = stroke->at[i] - stroke->eye[i];
        assert_true(way * stroke->ray[i] >= -0.5f); /* the ray goes to what it meets */
    }
    stand_move(&s, x + 6, y);
    assert_true(viewport_stroke_now(s.viewport)->is_dragging);
    stand_button(&s, 0, false);
    assert_true(viewport_stroke_now(s.viewport)->is_released);
    stand_frame(&s);
    assert_false(viewport_stroke_now(s.viewport)->is_released);
    assert_int_equal(s.told_count, 0);
    stand_close(&s);
}

static void the_camera_is_kept(void **state)
{
    (void)state;
    open_plain();
    stand_drag(&s, 1, 320, 240, 260, 200);
    float before[3];
    memcpy(before, viewport_stroke_now(s.viewport)->forward, sizeof before);
    assert_true(fabsf(before[0]) > 0.1f);
    stand_reopen(&s);
    for (int i = 0; i < 3; ++i)
        assert_near(viewport_stroke_now(s.viewport)->forward[i], before[i], 1e-5);
    stand_close(&s);
}

static void a_face_that_stands_in_is_shown_and_picked(void **state)
{
    (void)state;
    open_plain();
    static float moved[3 * 21000];
    uint32_t count = s.file.mesh.vertex_count;
    assert_true(count <= 21000);
    memcpy(moved, s.view.position, (size_t)count * 3 * sizeof *moved);
    for (uint32_t v = 0; v < count; ++v)
        moved[v * 3] += 60.0f;
    float x, y, chin[3];
    place_of("chin", chin);
    viewport_stand_in(s.viewport, moved, s.view.normal);
    chin[0] += 60.0f;
    stand_place(&s, chin, &x, &y);
    stand_move(&s, x, y);
    const viewport_stroke *stroke = viewport_stroke_now(s.viewport);
    assert_true(stroke->is_on_face);
    assert_int_equal(stroke->contact, stand_contact(&s, "chin") + 1);
    assert_near(stroke->rest[0], 0.0, 1.0);
    assert_near(stroke->at[0], 60.0, 1.0);
    stand_drag(&s, 0, x, y, x + 9, y); /* it is nobody's to pull */
    assert_int_equal(s.told_count, 0);
    viewport_stand_in(s.viewport, NULL, NULL);
    stand_frames(&s, 2);
    assert_true(viewport_stroke_now(s.viewport)->at[0] < 60.0f);
    stand_close(&s);
}

static bool says_it_is_less_sharp(void)
{
    const ui_word *words;
    const uint32_t count = ui_words(s.ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strstr(words[i].text, "Drawing is slow: "))
            return true;
    return false;
}

/* How often it is drawn once nothing moves any more. */
static uint64_t drawn_after_an_orbit(double dt_s)
{
    stand_open_slow(&s, puppet, WIDTH / COARSE, HEIGHT / COARSE, 1.0f / COARSE, dt_s);
    stand_show(&s);
    ui_note_words(s.ui, true);
    stand_move(&s, 320, 240);
    stand_button(&s, 1, true);
    for (int i = 0; i < 10; ++i)
        stand_move(&s, 320 + 6 * (float)i, 240);
    assert_int_equal(says_it_is_less_sharp(), dt_s > 0.04);
    stand_button(&s, 1, false);
    stand_frame(&s);
    uint64_t before = viewport_drawn(s.viewport);
    stand_frames(&s, 40);
    uint64_t after = viewport_drawn(s.viewport);
    assert_false(says_it_is_less_sharp());
    stand_close(&s);
    return after - before;
}

static void a_slow_renderer_gets_fewer_pixels_until_all_is_still(void **state)
{
    (void)state;
    assert_int_equal(drawn_after_an_orbit(1.0 / 60.0), 0);
    assert_int_equal(drawn_after_an_orbit(0.070), 1); /* once more, with all pixels */
}

static void a_whole_performance_in_a_small_window_does_no_harm(void **state)
{
    (void)state;
    stand_open(&s, puppet, 8, 6, 1.0f);
    stand_show(&s);
    s.looks = (app_looks){.shows_hands = true,
                          .shows_vectors = true,
                          .shows_supports = true,
                          .shows_contacts = true,
                          .shows_jaw = true,
                          .heat = APP_HEAT_STRAIN};
    stand_pull(&s, "chin", 0, -6, 2);
    stand_drag(&s, 0, 4, 3, 6, 5);
    stand_wheel(&s, 40);
    stand_wheel(&s, -80);
    s.where = (ui_rectangle){0, 0, 1, 1};
    stand_frames(&s, 2);
    assert_true(viewport_output(s.viewport, VIEWPORT_WINDOW, 64, 48) != 0);
    assert_true(viewport_output(s.viewport, VIEWPORT_STREAM, 0, 48) == 0);
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_idle_viewport_draws_nothing),
        cmocka_unit_test(a_drag_moves_the_mouth_corner_by_itself),
        cmocka_unit_test(a_mirror_mirrors_what_is_grasped_and_where_it_goes),
        cmocka_unit_test(skin_is_pulled_where_it_is_touched),
        cmocka_unit_test(control_kneads_and_shift_lets_it_stay),
        cmocka_unit_test(the_wheel_moves_what_is_held_towards_the_viewer),
        cmocka_unit_test(alt_and_the_wheel_change_the_reach),
        cmocka_unit_test(a_double_click_on_a_contact_lets_go_of_all),
        cmocka_unit_test(right_drag_orbits_and_the_face_follows_the_pointer),
        cmocka_unit_test(beside_the_face_the_left_button_orbits),
        cmocka_unit_test(views_are_reached_in_a_fifth_of_a_second),
        cmocka_unit_test(a_take_that_is_shown_is_not_pulled),
        cmocka_unit_test(whoever_paints_is_given_the_pointer),
        cmocka_unit_test(the_camera_is_kept),
        cmocka_unit_test(a_face_that_stands_in_is_shown_and_picked),
        cmocka_unit_test(a_slow_renderer_gets_fewer_pixels_until_all_is_still),
        cmocka_unit_test(a_whole_performance_in_a_small_window_does_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
