/* The camera of the viewport in a person's hand. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/overlay.h"
#include "window/viewport/camera.h"

#include <math.h>

#define assert_near(a, b, tolerance)                                                               \
    assert_true(fabs((double)(a) - (double)(b)) <= (double)(tolerance))

static const float low[3] = {-100, -150, -120}, high[3] = {100, 150, 110};
static const uint32_t rectangle[4] = {0, 0, 800, 600};

static viewport_camera at_home(void)
{
    viewport_camera c;
    viewport_camera_init(&c, low, high, 800.0f / 600.0f);
    return c;
}

static void the_face_follows_the_pointer_in_an_orbit(void **state)
{
    (void)state;
    viewport_camera c = at_home();
    const float nose[3] = {0, 0, 110};
    float before[2], after[2];
    assert_true(draw_project(before, &c.now, rectangle, nose));
    viewport_camera_orbit(&c, 30, 20);
    assert_true(draw_project(after, &c.now, rectangle, nose));
    assert_true(after[0] > before[0] + 5.0f && after[1] > before[1] + 5.0f);
    viewport_camera_orbit(&c, 0, 1e6f);
    assert_true(c.now.pitch_rad < 1.5f); /* never over the top */
    for (int i = 0; i < 1000; ++i)
        viewport_camera_orbit(&c, 77, 0);
    assert_true(fabsf(c.now.yaw_rad) < 3.15f);
}

static void a_pan_moves_the_face_by_as_many_points(void **state)
{
    (void)state;
    viewport_camera c = at_home();
    viewport_camera_orbit(&c, 40, 30);
    const float *place = c.home.target;
    float before[2], after[2];
    assert_true(draw_project(before, &c.now, rectangle, place));
    viewport_camera_pan(&c, 31, -17, 600);
    assert_true(draw_project(after, &c.now, rectangle, place));
    assert_near(after[0] - before[0], 31, 0.1);
    assert_near(after[1] - before[1], -17, 0.1);
    viewport_camera_pan(&c, 1e6f, 0, 600); /* the face cannot be lost */
    assert_true(fabsf(c.now.target[0] - c.home.target[0]) < c.home.distance_mm);
    viewport_camera_pan(&c, 5, 5, 0);
}

static void a_zoom_keeps_what_is_under_the_pointer(void **state)
{
    (void)state;
    viewport_camera c = at_home();
    viewport_camera_orbit(&c, 25, 5);
    const float pointer[2] = {520, 210};
    float under[3], after[2];
    assert_true(draw_unproject(under, &c.now, rectangle, pointer, c.now.target));
    float distance = c.now.distance_mm;
    viewport_camera_zoom(&c, 4, rectangle, pointer);
    assert_true(c.now.distance_mm < 0.7f * distance);
    assert_true(draw_project(after, &c.now, rectangle, under));
    assert_near(after[0], pointer[0], 0.2);
    assert_near(after[1], pointer[1], 0.2);
    viewport_camera_zoom(&c, 1000, rectangle, pointer);
    assert_true(c.now.distance_mm > 1.0f);
    viewport_camera_zoom(&c, -1000, rectangle, pointer);
    assert_true(c.now.distance_mm <= 5.1f * c.home.distance_mm);
}

static void glide(viewport_camera *c)
{
    for (int i = 0; i < 13; ++i)
        viewport_camera_update(c, 1.0 / 60.0);
    assert_true(c->glided_s < 0.0);
}

static void views_are_glided_to_and_asked_again_from_the_other_side(void **state)
{
    (void)state;
    viewport_camera c = at_home();
    viewport_camera_glide(&c, VIEWPORT_SIDE);
    viewport_camera_update(&c, 0.1);
    assert_near(c.now.yaw_rad, 0.5 * 1.5708, 0.01); /* half way in half the time */
    glide(&c);
    assert_near(c.now.yaw_rad, 1.5708, 1e-4);
    viewport_camera_glide(&c, VIEWPORT_SIDE);
    glide(&c);
    assert_near(c.now.yaw_rad, -1.5708, 1e-4);
    viewport_camera_glide(&c, VIEWPORT_FRONT);
    glide(&c);
    assert_near(c.now.yaw_rad, 0.0, 1e-4);
}

static void a_glide_takes_the_short_way_round(void **state)
{
    (void)state;
    viewport_camera c = at_home();
    c.now.yaw_rad = 3.0f;
    viewport_camera_glide(&c, VIEWPORT_SIDE);
    viewport_camera_glide(&c, VIEWPORT_SIDE); /* the other: -90 degrees, by way of 180 */
    viewport_camera_update(&c, 0.1);
    assert_true(cosf(c.now.yaw_rad) < -0.3f);
}

static void frame_brings_the_whole_face_back(void **state)
{
    (void)state;
    viewport_camera c = at_home();
    const float corner[2] = {700, 500};
    viewport_camera_orbit(&c, 60, 10);
    viewport_camera_zoom(&c, 9, rectangle, corner);
    float yaw = c.now.yaw_rad;
    viewport_camera_frame(&c);
    glide(&c);
    assert_near(c.now.distance_mm, c.home.distance_mm, 0.1);
    assert_near(c.now.target[0], c.home.target[0], 0.01);
    assert_near(c.now.yaw_rad, yaw, 1e-5); /* from where it stood */
}

static void what_is_kept_fits_another_face(void **state)
{
    (void)state;
    viewport_camera c = at_home(), other;
    const float small_low[3] = {-10, -15, -12}, small_high[3] = {10, 15, 11};
    const float corner[2] = {300, 200};
    viewport_camera_orbit(&c, 33, 12);
    viewport_camera_zoom(&c, 3, rectangle, corner);
    const draw_camera_view kept = viewport_camera_keep(&c);
    viewport_camera_init(&other, small_low, small_high, 800.0f / 600.0f);
    viewport_camera_recall(&other, &kept);
    assert_near(other.now.distance_mm, 0.1 * (double)c.now.distance_mm, 0.1);
    const draw_camera_view again = viewport_camera_keep(&other);
    for (int i = 0; i < DRAW_VIEW_NUMBERS; ++i)
        assert_near(kept.number[i], again.number[i], 1e-4);
}

static void nonsense_that_was_kept_is_home(void **state)
{
    (void)state;
    viewport_camera c = at_home();
    const draw_camera_view nonsense[] = {{{NAN, 0, 1, 0, 0, 0}},
                                         {{0, 0, 0, 0, 0, 0}},
                                         {{0, 0, -1, 0, 0, 0}},
                                         {{0, 0, 1, INFINITY, 0, 0}}};
    for (int i = 0; i < 4; ++i) {
        viewport_camera_recall(&c, &nonsense[i]);
        assert_near(c.now.distance_mm, c.home.distance_mm, 0.0);
        assert_near(c.now.yaw_rad, 0.0, 0.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_face_follows_the_pointer_in_an_orbit),
        cmocka_unit_test(a_pan_moves_the_face_by_as_many_points),
        cmocka_unit_test(a_zoom_keeps_what_is_under_the_pointer),
        cmocka_unit_test(views_are_glided_to_and_asked_again_from_the_other_side),
        cmocka_unit_test(a_glide_takes_the_short_way_round),
        cmocka_unit_test(frame_brings_the_whole_face_back),
        cmocka_unit_test(what_is_kept_fits_another_face),
        cmocka_unit_test(nonsense_that_was_kept_is_home),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
