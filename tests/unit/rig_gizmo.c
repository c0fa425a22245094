/* Places in space that are taken hold of. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "window/rig/gizmo.h"

#include <math.h>
#include <string.h>

/* From 500 mm before the face, straight back; a point is 0.6 mm at its depth. */
static rig_ray ray_at(double x, double y)
{
    const vec3 eye = {0.0, 0.0, 500.0}, back = {0.0, 0.0, -1.0};
    vec3 way = vec3_sub((vec3){x, y, 0.0}, eye);
    return (rig_ray){eye, vec3_normalised(way, back), back, 0.6 / 500.0};
}

static void the_nearest_place_within_reach_is_meant(void **state)
{
    (void)state;
    const vec3 place[] = {{60.0, 0.0, 0.0}, {66.0, 0.0, 0.0}, {-60.0, 0.0, 0.0}};
    rig_ray ray = ray_at(64.0, 0.0);
    assert_int_equal(rig_gizmo_nearest(&ray, place, 3, 10.0), 1);
    ray = ray_at(61.0, 2.0);
    assert_int_equal(rig_gizmo_nearest(&ray, place, 3, 10.0), 0);
    ray = ray_at(0.0, 0.0);
    assert_int_equal(rig_gizmo_nearest(&ray, place, 3, 10.0), RIG_NONE);
    ray.ray = (vec3){0.0, 0.0, 1.0}; /* behind the eye */
    assert_int_equal(rig_gizmo_nearest(&ray, place, 3, 1e9), RIG_NONE);
}

static void a_place_is_dragged_in_the_plane_that_faces_the_eye(void **state)
{
    (void)state;
    vec3 out;
    rig_ray ray = ray_at(50.0, -20.0);
    assert_true(rig_gizmo_reach(&out, &ray, (vec3){0.0, 0.0, -100.0}));
    assert_true(fabs(out.z + 100.0) < 1e-9);
    assert_true(fabs(out.x - 50.0 * 600.0 / 500.0) < 1e-9);
    assert_true(fabs(out.y + 20.0 * 600.0 / 500.0) < 1e-9);
    assert_false(rig_gizmo_reach(&out, &ray, (vec3){0.0, 0.0, 700.0}));
}

static void both_ends_of_the_axis_move_as_in_a_mirror(void **state)
{
    (void)state;
    rig_edit_jaw jaw = {.left = {68, -24, -8}, .right = {-68, -24, -8}, .open_max_rad = 0.5};
    rig_gizmo_move(&jaw, RIG_HANDLE_RIGHT, (vec3){-70.0, -20.0, -5.0}, true, 1.0);
    assert_true(fabs(jaw.left.x - 72.0) < 1e-12 && fabs(jaw.left.y + 20.0) < 1e-12);
    rig_gizmo_move(&jaw, RIG_HANDLE_LEFT, (vec3){60.0, 0.0, 0.0}, false, 1.0);
    assert_true(fabs(jaw.right.x + 70.0) < 1e-12);
    assert_false(jaw.has_incisor);
    rig_gizmo_move(&jaw, RIG_HANDLE_INCISOR, (vec3){4.0, -46.0, 76.0}, true, 1.0);
    assert_true(jaw.has_incisor && fabs(jaw.incisor.x - 1.0) < 1e-12);
}

static void the_way_of_the_teeth_goes_down_and_back(void **state)
{
    (void)state;
    rig_edit_jaw jaw = {.left = {68, -24, -8},
                        .right = {-68, -24, -8},
                        .incisor = {0, -46.5, 76},
                        .has_incisor = true,
                        .open_max_rad = 0.5};
    overlay_item item[RIG_GIZMO_ITEMS];
    uint32_t count = rig_gizmo_draw(item, &jaw, RIG_HANDLES);
    float lowest = 0.0f, z = 0.0f;
    assert_true(count > 10 && count <= RIG_GIZMO_ITEMS);
    for (uint32_t i = 0; i < count; ++i)
        if (item[i].kind == OVERLAY_LINE && item[i].to[1] < lowest) {
            lowest = item[i].to[1];
            z = item[i].to[2];
        }
    assert_true(lowest < -70.0f && z < 76.0f);
    jaw.has_incisor = false;
    assert_true(rig_gizmo_draw(item, &jaw, RIG_HANDLES) < count);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_place_within_reach_is_meant),
        cmocka_unit_test(a_place_is_dragged_in_the_plane_that_faces_the_eye),
        cmocka_unit_test(both_ends_of_the_axis_move_as_in_a_mirror),
        cmocka_unit_test(the_way_of_the_teeth_goes_down_and_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
