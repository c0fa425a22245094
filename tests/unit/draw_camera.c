/* Where points of the face come to lie in the picture; no graphics needed. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/camera.h"
#include "draw_help.h"

#include <math.h>

typedef struct point4 {
    double x, y, z, w;
} point4;

static point4 transform(const matrix4 *m, double x, double y, double z)
{
    double in[4] = {x, y, z, 1.0}, out[4] = {0};
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            out[row] += (double)m->m[column * 4 + row] * in[column];
    return (point4){out[0] / out[3], out[1] / out[3], out[2] / out[3], out[3]};
}

static void framing_contains_the_box_from_front_and_side(void **state)
{
    (void)state;
    static const struct {
        float low[3], high[3], aspect;
    } cases[] = {{{-80, -130, -110}, {80, 130, 100}, 0.6f},
                 {{-80, -130, -110}, {80, 130, 100}, 1.78f},
                 {{-300, -10, -5}, {300, 10, 5}, 0.6f},
                 {{500, 500, 500}, {501, 540, 501}, 1.0f},
                 {{-50, -50, 0}, {50, 50, 0}, 1.0f}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const float *low = cases[i].low, *high = cases[i].high, centre[3] = {0};
        draw_camera camera = draw_camera_framing(low, high, cases[i].aspect);
        for (int side = 0; side < 2; ++side) {
            camera.yaw_rad = (float)side * 1.5707963f;
            matrix4 m = camera_projection(&camera, cases[i].aspect, centre, 1000.0f);
            double widest = 0.0;
            for (int corner = 0; corner < 8; ++corner) {
                point4 p = transform(&m, (double)(corner & 1 ? high : low)[0],
                                     (double)(corner & 2 ? high : low)[1],
                                     (double)(corner & 4 ? high : low)[2]);
                assert_true(p.w > 0.0);
                assert_true(fabs(p.x) < 0.95 && fabs(p.y) < 0.95);
                widest = fmax(widest, fmax(fabs(p.x), fabs(p.y)));
            }
            if (side == 0) /* with air, but not lost in it */
                assert_true(widest > 0.3);
        }
    }
}

static void target_is_in_the_middle_from_everywhere(void **state)
{
    (void)state;
    draw_camera camera = {{10, 20, 30}, 500, 0, 0, 0.5f};
    const float centre[3] = {10, 20, 30};
    for (int i = 0; i < 36; ++i) {
        camera.yaw_rad = (float)i * 0.7f;
        camera.pitch_rad = (float)i * 0.31f;
        matrix4 m = camera_projection(&camera, 1.3f, centre, 100);
        point4 p = transform(&m, 10, 20, 30);
        assert_true(fabs(p.x) < 1e-5 && fabs(p.y) < 1e-5);
        assert_near(p.w, 500.0, 0.01);
    }
}

static void yaw_looks_from_the_subjects_left_and_pitch_from_above(void **state)
{
    (void)state;
    draw_camera camera = {{0, 0, 0}, 500, 0.5f, 0.3f, 0.5f};
    float eye[3];
    camera_eye(&camera, eye);
    assert_near(eye[0], 500.0 * sin(0.5) * cos(0.3), 1e-3);
    assert_near(eye[1], 500.0 * sin(0.3), 1e-3);
    assert_near(eye[2], 500.0 * cos(0.5) * cos(0.3), 1e-3);
    camera.yaw_rad = camera.pitch_rad = 0.0f;
    const float centre[3] = {0};
    matrix4 m = camera_projection(&camera, 1.0f, centre, 100);
    assert_true(transform(&m, 50, 0, 0).x > 0.1); /* the subject's left is on the right */
    assert_true(transform(&m, 0, 50, 0).y > 0.1);
    assert_true(transform(&m, 0, 0, 50).z < transform(&m, 0, 0, -50).z);
}

static void depth_covers_the_ball(void **state)
{
    (void)state;
    draw_camera camera = {{0, 0, 0}, 500, 0, 0, 0.5f};
    const float centre[3] = {0, 0, 40};
    matrix4 m = camera_projection(&camera, 1.0f, centre, 90);
    assert_true(transform(&m, 0, 0, 130).z > -1.0 && transform(&m, 0, 0, 130).z < -0.9);
    assert_true(transform(&m, 0, 0, -50).z < 1.0 && transform(&m, 0, 0, -50).z > 0.9);
}

static void light_projection_maps_the_ball_into_the_cube(void **state)
{
    (void)state;
    static const float directions[3][3] = {{0, 1, 0}, {0.6f, 0, 0.8f}, {-0.48f, -0.6f, 0.64f}};
    const float centre[3] = {7, -3, 100};
    for (int i = 0; i < 3; ++i) {
        const float *d = directions[i];
        matrix4 m = camera_light_projection(d, centre, 50);
        matrix4 texture = camera_to_texture(&m);
        point4 middle = transform(&m, 7, -3, 100);
        point4 nearest = transform(&m, 7.0 + 50.0 * (double)d[0], -3.0 + 50.0 * (double)d[1],
                                   100.0 + 50.0 * (double)d[2]);
        assert_true(fabs(middle.x) + fabs(middle.y) + fabs(middle.z) < 1e-4);
        assert_near(nearest.z, -1.0, 1e-4);
        assert_true(fabs(nearest.x) + fabs(nearest.y) < 1e-4);
        assert_near(transform(&texture, 7, -3, 100).x, 0.5, 1e-4);
        assert_near(transform(&texture, 7, -3, 100).z, 0.5, 1e-4);
    }
}

static void nonsense_cameras_become_finite(void **state)
{
    (void)state;
    const float nothing[3] = {NAN, INFINITY, -INFINITY}, point[3] = {3, 4, 5};
    draw_camera wild = {{NAN, INFINITY, 1}, NAN, INFINITY, NAN, -4.0f};
    draw_camera safe = camera_made_safe(&wild);
    assert_true(isfinite(safe.target[0]) && isfinite(safe.target[1]) && isfinite(safe.yaw_rad));
    assert_true(safe.distance_mm > 0.0f && safe.field_of_view_rad > 0.0f);
    draw_camera framed = draw_camera_framing(nothing, nothing, NAN);
    assert_true(isfinite(framed.distance_mm) && framed.distance_mm > 0.0f);
    framed = draw_camera_framing(point, point, 1.0f);
    assert_true(isfinite(framed.distance_mm) && framed.distance_mm > 0.0f);
    assert_near(framed.target[2], 5.0, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(framing_contains_the_box_from_front_and_side),
        cmocka_unit_test(target_is_in_the_middle_from_everywhere),
        cmocka_unit_test(yaw_looks_from_the_subjects_left_and_pitch_from_above),
        cmocka_unit_test(depth_covers_the_ball),
        cmocka_unit_test(light_projection_maps_the_ball_into_the_cube),
        cmocka_unit_test(nonsense_cameras_become_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
