/* The functions of a face that run in a frame allocate nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/allocation_count.h"
#include "unit/face_scene.h"

static void frames_allocate_nothing(void **state)
{
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED) {
        print_message("SKIPPED: the sanitizer has an allocator of its own\n");
        skip();
    }
    static face_scene s;
    error err = {""};
    const csrbf_settings settings = {.radius = 30.0}, wrong = {.radius = -1.0};
    double end[SCENE_CONTACTS][3], to[SCENE_CONTACTS][3], reached[SCENE_CONTACTS][3];
    float dof[MRT_MAX_DOFS] = {0.3f, 2.0f, 1.0f, 0.2f, 0.1f, 0.2f};
    shape_step step;
    mrt_result results[7];
    scene_init(&s);
    s.proxy[0] = (rig_proxy){.bone = SKULL, .centre = {0, 30, 20}, .radii = {70, 60, 48}};
    s.rig.proxy_count = 1;
    allocation_count = 0;
    assert_int_equal(scene_finish(&s, &err), MRT_OK);
    assert_true(allocation_count > 20); /* the counting works */
    allocation_count = 0;
    results[0] = scene_hold(&s, &settings, end, &err);
    memcpy(to, end, sizeof to);
    to[BROW][2] -= 12.0;
    results[1] = face_pull(s.face, to[0], NULL, &err);
    bool projected = face_metered(s.face)->projected_count > 0;
    results[2] = face_pull(s.face, to[0], dof, &err);
    double determinant = face_min_determinant(s.face), depth = face_penetration_mm(s.face);
    face_commit(s.face);
    results[3] = scene_hold(&s, &settings, end, &err);
    results[4] = scene_hold(&s, &wrong, end, &err);
    for (uint32_t i = 0; i < SCENE_CONTACTS; ++i) {
        memcpy(to[i], end[i], sizeof to[i]);
        to[i][1] += 1.0;
    }
    results[5] =
        face_drag(s.face, &settings, end[0], to[0], SCENE_CONTACTS, dof, reached[0], &step, &err);
    face_leak(s.face, 1.0, 0.01);
    bool near = face_is_near(s.face, to[0], SCENE_CONTACTS, 20.0);
    to[0][0] = (double)NAN;
    results[6] =
        face_drag(s.face, &settings, end[0], to[0], SCENE_CONTACTS, dof, NULL, &step, &err);
    face_reset(s.face);
    size_t counted = allocation_count;
    assert_int_equal(counted, 0);
    for (int i = 0; i < 7; ++i)
        assert_int_equal(results[i], i == 4 || i == 6 ? MRT_ERR_ARGUMENT : MRT_OK);
    assert_true(projected && near && depth >= 0.0 && isfinite(determinant));
    face_destroy(s.face);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames_allocate_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
