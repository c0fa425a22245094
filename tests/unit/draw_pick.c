/* From a pixel to the face and back. No context is needed. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/overlay.h"
#include "draw_help.h"

#include <string.h>

static const uint32_t rectangle[4] = {40, 30, 640, 480};
static const draw_camera cameras[] = {{{0, 0, 0}, 800, 0, 0, 0.5f},
                                      {{10, -20, 5}, 400, 0.7f, 0.3f, 0.6f},
                                      {{0, 30, 0}, 1500, -2.1f, -0.5f, 0.3f}};
enum { CAMERAS = sizeof cameras / sizeof *cameras };

/* How much a place of a ball around 0 faces the eye: 1 wholly, 0 it is on the outline. */
static double facing(const draw_camera *camera, const float at[3])
{
    double yaw = (double)camera->yaw_rad, pitch = (double)camera->pitch_rad;
    const double back[3] = {sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch)};
    double along = 0.0, to_eye = 0.0, size = 0.0;
    for (int i = 0; i < 3; ++i) {
        double way =
            (double)camera->target[i] + (double)camera->distance_mm * back[i] - (double)at[i];
        along += way * (double)at[i];
        to_eye += way * way;
        size += (double)at[i] * (double)at[i];
    }
    return along / sqrt(to_eye * size);
}

static void pick_hits_the_vertex_that_project_says(void **state)
{
    (void)state;
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    uint32_t tried = 0;
    for (int c = 0; c < CAMERAS; ++c)
        for (uint32_t v = 0; v < m.vertex_count; v += 7) {
            const float *at = m.position + v * 3;
            float pixel[2];
            draw_hit hit;
            if (facing(&cameras[c], at) < 0.15)
                continue;
            assert_true(draw_project(pixel, &cameras[c], rectangle, at));
            assert_true(draw_pick(&hit, &m, m.position, &cameras[c], rectangle, pixel));
            for (int i = 0; i < 3; ++i)
                assert_near(hit.at[i], at[i], 0.1);
            ++tried;
        }
    assert_true(tried > 150);
    mesh_destroy(&m);
}

static void a_hit_says_where_in_the_triangle(void **state)
{
    (void)state;
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    const float pixel[2] = {301.0f, 217.0f};
    draw_hit hit;
    assert_true(draw_pick(&hit, &m, m.position, &cameras[0], rectangle, pixel));
    assert_near(hit.share[0] + hit.share[1] + hit.share[2], 1.0, 1e-5);
    float length = 0.0f, out = 0.0f, distance = 0.0f;
    const float eye[3] = {0, 0, 800};
    for (int i = 0; i < 3; ++i) {
        float at = 0.0f;
        assert_int_equal(hit.vertex[i], m.triangle[hit.triangle * 3 + (uint32_t)i]);
        for (int corner = 0; corner < 3; ++corner) {
            assert_true(hit.share[corner] >= 0.0f);
            at += hit.share[corner] * m.position[hit.vertex[corner] * 3 + (uint32_t)i];
        }
        assert_near(at, hit.at[i], 1e-2);
        length += hit.normal[i] * hit.normal[i];
        out += hit.normal[i] * (eye[i] - hit.at[i]);
        distance += (eye[i] - hit.at[i]) * (eye[i] - hit.at[i]);
    }
    assert_near(length, 1.0, 1e-5);
    assert_true(out > 0.0f);
    assert_near(hit.distance_mm, sqrtf(distance), 1e-2);
    float again[2];
    assert_true(draw_project(again, &cameras[0], rectangle, hit.at));
    assert_near(again[0], pixel[0], 0.01);
    assert_near(again[1], pixel[1], 0.01);
    mesh_destroy(&m);
}

static void the_nearest_triangle_is_hit(void **state)
{
    (void)state;
    const ball balls[2] = {{{0, 0, -150}, 100}, {{0, 0, 150}, 50}};
    mesh m = shapes_balls(balls, 2);
    const float middle[2] = {360.0f, 270.0f}, beside[2] = {360.0f + 80.0f, 270.0f};
    draw_hit hit;
    assert_true(draw_pick(&hit, &m, m.position, &cameras[0], rectangle, middle));
    assert_near(hit.at[2], 200.0, 0.5);
    assert_true(draw_pick(&hit, &m, m.position, &cameras[0], rectangle, beside));
    assert_true(hit.at[2] < 0.0f);
    mesh_destroy(&m);
}

static void what_faces_away_is_not_hit(void **state)
{
    (void)state;
    mesh m = shapes_wall(100, 0);
    const float middle[2] = {361.0f, 268.0f};
    draw_camera behind = cameras[0];
    behind.yaw_rad = 3.14159f;
    draw_hit hit;
    assert_true(draw_pick(&hit, &m, m.position, &cameras[0], rectangle, middle));
    assert_false(draw_pick(&hit, &m, m.position, &behind, rectangle, middle));
    mesh_destroy(&m);
}

static void the_shape_as_shown_is_hit(void **state)
{
    (void)state;
    mesh m = shapes_wall(50, 0);
    float shown[12];
    memcpy(shown, m.position, sizeof shown);
    for (int v = 0; v < 4; ++v)
        shown[v * 3] += 120.0f;
    const float place[3] = {130, 5, 0};
    float pixel[2];
    draw_hit hit;
    assert_true(draw_project(pixel, &cameras[0], rectangle, place));
    assert_false(draw_pick(&hit, &m, m.position, &cameras[0], rectangle, pixel));
    assert_true(draw_pick(&hit, &m, shown, &cameras[0], rectangle, pixel));
    assert_near(hit.at[0], 130.0, 0.01);
    mesh_destroy(&m);
}

static void nonsense_is_no_hit(void **state)
{
    (void)state;
    mesh m = shapes_wall(50, 0);
    float broken[12];
    for (int i = 0; i < 12; ++i)
        broken[i] = NAN;
    const float middle[2] = {360.0f, 270.0f}, nowhere[2] = {NAN, 270.0f}, far[2] = {1e9f, 0.0f};
    const uint32_t flat[4] = {0, 0, 0, 480};
    draw_camera absurd = {{NAN, 0, 0}, -1, INFINITY, 0, 9};
    float out[3];
    draw_hit hit;
    assert_false(draw_pick(&hit, &m, broken, &cameras[0], rectangle, middle));
    assert_false(draw_pick(&hit, &m, m.position, &cameras[0], rectangle, nowhere));
    assert_false(draw_pick(&hit, &m, m.position, &cameras[0], rectangle, far));
    assert_false(draw_pick(&hit, &m, m.position, &cameras[0], flat, middle));
    (void)draw_pick(&hit, &m, m.position, &absurd, rectangle, middle);
    assert_false(draw_unproject(out, &cameras[0], flat, middle, m.position));
    const float behind[3] = {0, 0, 900};
    assert_false(draw_unproject(out, &cameras[0], rectangle, middle, behind));
    mesh_destroy(&m);
}

static void unproject_inverts_project(void **state)
{
    (void)state;
    const float places[][3] = {{0, 0, 0}, {50, -30, 80}, {-90, 70, -40}};
    for (int c = 0; c < CAMERAS; ++c)
        for (int p = 0; p < 3; ++p) {
            float pixel[2], back[3];
            assert_true(draw_project(pixel, &cameras[c], rectangle, places[p]));
            assert_true(draw_unproject(back, &cameras[c], rectangle, pixel, places[p]));
            for (int i = 0; i < 3; ++i)
                assert_near(back[i], places[p][i], 0.01);
        }
}

static void unproject_stays_in_the_plane_that_faces_the_camera(void **state)
{
    (void)state;
    const float through[3] = {20, 10, 90};
    for (int c = 0; c < CAMERAS; ++c) {
        float pixel[2], moved[3], again[2];
        assert_true(draw_project(pixel, &cameras[c], rectangle, through));
        pixel[0] += 37.0f;
        pixel[1] -= 21.0f;
        assert_true(draw_unproject(moved, &cameras[c], rectangle, pixel, through));
        assert_true(draw_project(again, &cameras[c], rectangle, moved));
        assert_near(again[0], pixel[0], 0.02);
        assert_near(again[1], pixel[1], 0.02);
        double yaw = (double)cameras[c].yaw_rad, pitch = (double)cameras[c].pitch_rad;
        const double back[3] = {sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch)};
        double along = 0.0;
        for (int i = 0; i < 3; ++i)
            along += ((double)moved[i] - (double)through[i]) * back[i];
        assert_near(along, 0.0, 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pick_hits_the_vertex_that_project_says),
        cmocka_unit_test(a_hit_says_where_in_the_triangle),
        cmocka_unit_test(the_nearest_triangle_is_hit),
        cmocka_unit_test(what_faces_away_is_not_hit),
        cmocka_unit_test(the_shape_as_shown_is_hit),
        cmocka_unit_test(nonsense_is_no_hit),
        cmocka_unit_test(unproject_inverts_project),
        cmocka_unit_test(unproject_stays_in_the_plane_that_faces_the_camera),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
