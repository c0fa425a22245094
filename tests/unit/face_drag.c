/* A face that is dragged sample by sample while its bones move: absolute poses, no drift. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/face_scene.h"

static const csrbf_settings settings = {.radius = 30.0};

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void make(face_scene *s)
{
    error err = {""};
    scene_init(s);
    must(scene_finish(s, &err), &err);
}

static vec3 drag_one(const face_scene *s, vec3 from, vec3 to, const float *dof)
{
    error err = {""};
    shape_step step;
    double reached[3];
    const double a[3] = {from.x, from.y, from.z}, b[3] = {to.x, to.y, to.z};
    must(face_drag(s->face, &settings, a, b, 1, dof, reached, &step, &err), &err);
    assert_true(step.min_determinant > 0.0);
    return (vec3){reached[0], reached[1], reached[2]};
}

static void opening_and_closing_a_thousand_times_wears_nothing(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    shape_step step;
    float dof[MRT_MAX_DOFS] = {0};
    points kept;
    make(&s);
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    vec3 chin = scene_rest(&s, s.contact[CHIN].vertex);
    (void)drag_one(&s, chin, vec3_add(chin, (vec3){2, -3, 4}), dof);
    points_copy(&kept, face_shown(s.face));
    for (int i = 0; i < 1000; ++i) {
        dof[0] = 0.05f * (float)(1 + i % 10);
        must(face_drag(s.face, &settings, NULL, NULL, 0, dof, NULL, &step, &err), &err);
        assert_true(scene_greatest_difference(&kept, face_shown(s.face)) > 1.0);
        dof[0] = 0.0f;
        must(face_drag(s.face, &settings, NULL, NULL, 0, dof, NULL, &step, &err), &err);
    }
    assert_true(scene_same_bits(&kept, face_shown(s.face)));
    points_destroy(&kept);
    face_destroy(s.face);
}

static void the_vertex_under_a_tip_goes_along_in_any_pose(void **state)
{
    (void)state;
    static face_scene s;
    float dof[MRT_MAX_DOFS] = {0};
    make(&s);
    uint32_t chin = s.contact[CHIN].vertex;
    for (int i = 0; i < 30; ++i) { /* the jaw opens under the tip meanwhile */
        dof[scene_dof(&s, "jaw.open")] = 0.01f * (float)i;
        vec3 from = scene_shown(&s, chin), to = vec3_add(from, (vec3){0.1, -0.3, 0.2});
        vec3 reached = drag_one(&s, from, to, dof);
        assert_true(scene_distance(reached, to) == 0.0);
        assert_true(scene_distance(scene_shown(&s, chin), to) < 2e-4);
    }
    rigid pose[SCENE_BONES];
    bones_pose(pose, face_bones(s.face), dof);
    vec3 tooth = rigid_apply(&pose[JAW], scene_rest(&s, SCENE_LOWER_TEETH));
    assert_true(scene_distance(scene_shown(&s, SCENE_LOWER_TEETH), tooth) < 2e-5);
    assert_true(scene_distance(scene_shown(&s, SCENE_UPPER_TEETH),
                               scene_rest(&s, SCENE_UPPER_TEETH)) == 0.0);
    face_destroy(s.face);
}

/* Skin at the border of jaw and skull is moved by both fields, and lands as well. */
static void borders_are_dragged_whole(void **state)
{
    (void)state;
    static face_scene s;
    float dof[MRT_MAX_DOFS] = {0};
    make(&s);
    uint32_t corner = s.contact[CORNER].vertex;
    vec3 from = scene_shown(&s, corner), to = vec3_add(from, (vec3){3, 1, 0});
    (void)drag_one(&s, from, to, dof);
    assert_true(scene_distance(scene_shown(&s, corner), to) < 1e-4);
    vec3 lip = scene_rest(&s, scene_at(0, 0));
    assert_true(scene_distance(scene_shown(&s, scene_at(0, 0)), lip) < 1.0);
    face_destroy(s.face);
}

static void undriven_jaws_stay_and_what_is_let_go_stays(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    shape_step step;
    double end[SCENE_CONTACTS][3];
    points kept;
    make(&s);
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    must(scene_hold(&s, &settings, end, &err), &err);
    for (uint32_t i = 0; i < SCENE_CONTACTS; ++i)
        end[i][1] -= i == CHIN || i == LOWER_LIP || i >= JAW_LEFT ? 15.0 : 0.5;
    must(face_pull(s.face, end[0], NULL, &err), &err);
    assert_true(face_metered(s.face)->dof[0] > 0.1f);
    points_copy(&kept, face_shown(s.face));
    must(face_drag(s.face, &settings, NULL, NULL, 0, NULL, NULL, &step, &err), &err);
    assert_true(scene_greatest_difference(&kept, face_shown(s.face)) < 1e-4);
    must(scene_hold(&s, &settings, end, &err), &err);
    must(face_pull(s.face, end[0], NULL, &err), &err);
    assert_true(scene_greatest_difference(&kept, face_shown(s.face)) < 1e-4);
    points_destroy(&kept);
    face_destroy(s.face);
}

static void a_leak_eases_the_skin_but_not_the_bones(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    shape_step step;
    float dof[MRT_MAX_DOFS] = {0.25f};
    make(&s);
    uint32_t chin = s.contact[CHIN].vertex;
    must(face_drag(s.face, &settings, NULL, NULL, 0, dof, NULL, &step, &err), &err);
    vec3 posed = scene_shown(&s, chin);
    (void)drag_one(&s, posed, vec3_add(posed, (vec3){0, 0, 4}), dof);
    face_leak(s.face, 10.0, 0.1); /* half the way */
    assert_true(scene_distance(scene_shown(&s, chin), vec3_add(posed, (vec3){0, 0, 2})) < 1e-3);
    for (int i = 0; i < 60; ++i)
        face_leak(s.face, 10.0, 0.1);
    assert_true(scene_distance(scene_shown(&s, chin), posed) < 1e-3);
    face_leak(s.face, (double)NAN, 0.1);
    assert_true(scene_distance(scene_shown(&s, chin), posed) < 1e-3);
    face_destroy(s.face);
}

static void a_refused_drag_moves_nothing(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    shape_step step;
    float dof[MRT_MAX_DOFS] = {0.25f};
    const double from[3] = {0, -25, 80}, bad[3] = {0, (double)NAN, 80}, to[3] = {0, -26, 80};
    const csrbf_settings wrong = {.radius = 0.0};
    points kept;
    make(&s);
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    must(face_pull(s.face, NULL, dof, &err), &err);
    points_copy(&kept, face_shown(s.face));
    dof[0] = 0.5f;
    assert_int_equal(face_drag(s.face, &settings, from, bad, 1, dof, NULL, &step, &err),
                     MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "control 0"));
    assert_int_equal(face_drag(s.face, &wrong, from, to, 1, dof, NULL, &step, &err),
                     MRT_ERR_ARGUMENT);
    assert_int_equal(
        face_drag(s.face, &settings, from, to, MRT_MAX_VECTORS + 1, dof, NULL, &step, &err),
        MRT_ERR_ARGUMENT);
    assert_true(scene_greatest_difference(&kept, face_shown(s.face)) < 2e-5);
    points_destroy(&kept);
    face_destroy(s.face);
}

static void the_gate_looks_at_the_base_while_engaged(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    const float dof[MRT_MAX_DOFS] = {0.5f};
    const double near_lip[3] = {0, 0, 90}, below[3] = {0, -95, 60};
    make(&s);
    assert_true(face_is_near(s.face, near_lip, 1, 6.0));
    assert_false(face_is_near(s.face, near_lip, 1, 4.0));
    must(face_pull(s.face, NULL, dof, &err), &err);
    assert_true(face_is_near(s.face, below, 1, 20.0));
    must(scene_hold(&s, &settings, end, &err), &err);
    assert_false(face_is_near(s.face, below, 1, 20.0));
    face_destroy(s.face);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_and_closing_a_thousand_times_wears_nothing),
        cmocka_unit_test(the_vertex_under_a_tip_goes_along_in_any_pose),
        cmocka_unit_test(borders_are_dragged_whole),
        cmocka_unit_test(undriven_jaws_stay_and_what_is_let_go_stays),
        cmocka_unit_test(a_leak_eases_the_skin_but_not_the_bones),
        cmocka_unit_test(a_refused_drag_moves_nothing),
        cmocka_unit_test(the_gate_looks_at_the_base_while_engaged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
