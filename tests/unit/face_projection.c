/* Skin slides over the skull and never enters it; and the meter that finds turned skin. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/face_scene.h"

static const csrbf_settings settings = {.radius = 30.0, .stretch_most = -1.0};

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* A skull behind the upper half of the sheet, a chin bone behind the lower one. */
static void make(face_scene *s, uint32_t proxy_count)
{
    error err = {""};
    scene_init(s);
    s->proxy[0] = (rig_proxy){.bone = SKULL, .centre = {0, 30, 20}, .radii = {70, 60, 48}};
    s->proxy[1] = (rig_proxy){.bone = JAW, .centre = {0, -30, 40}, .radii = {30, 20, 30}};
    s->rig.proxy_count = proxy_count;
    must(scene_finish(s, &err), &err);
}

/* Height over a proxy in its scaled space, of a place in its bone's frame. */
static double height(const rig_proxy *p, vec3 x)
{
    vec3 q = {(x.x - p->centre.x) / p->radii.x, (x.y - p->centre.y) / p->radii.y,
              (x.z - p->centre.z) / p->radii.z};
    return vec3_length(q) - 1.0;
}

/* What the height of a vertex at rest may sink to: 0.4 of it, but 2 mm at most. */
static double lowest(const rig_proxy *p, vec3 rest)
{
    double h = height(p, rest);
    return fmin(0.4 * h, 2.0 * (1.0 + h) / scene_distance(rest, p->centre));
}

/* The brow pushed straight back; returns how far behind its rest place it is. */
static double push_brow(face_scene *s, double way)
{
    error err = {""};
    double end[SCENE_CONTACTS][3];
    face_reset(s->face);
    must(scene_hold(s, &settings, end, &err), &err);
    end[BROW][2] -= way;
    must(face_pull(s->face, end[0], NULL, &err), &err);
    uint32_t v = s->contact[BROW].vertex;
    return scene_rest(s, v).z - scene_shown(s, v).z;
}

static void skin_stops_at_the_skull_smoothly(void **state)
{
    (void)state;
    static face_scene s;
    make(&s, 1);
    uint32_t brow = s.contact[BROW].vertex;
    double end = lowest(&s.proxy[0], scene_rest(&s, brow)), last = 0.0, last_step = 0.25;
    for (double way = 0.0; way <= 40.0; way += 0.25) {
        double sunk = push_brow(&s, way), step = sunk - last;
        double now = height(&s.proxy[0], scene_shown(&s, brow));
        assert_true(now >= end - 1e-5);
        assert_true(sunk <= way + 1e-5);
        if (way > 0.25)
            assert_true(fabs(step - last_step) < 0.02); /* no kink: that would be 0.25 */
        last = sunk;
        last_step = step;
    }
    const face_meter *meter = face_metered(s.face);
    assert_true(meter->penetration_mm > 10.0 && meter->projected_count > 20);
    assert_false(face_columns_now(s.face).is_exact);
    assert_true(face_penetration_mm(s.face) < 1e-3);
    assert_true(fabs(height(&s.proxy[0], scene_shown(&s, brow)) - end) < 1e-5);
    face_destroy(s.face);
}

static void skin_that_does_not_sink_is_left_alone(void **state)
{
    (void)state;
    static face_scene with, without;
    error err = {""};
    make(&with, 2);
    make(&without, 0);
    must(face_pull(with.face, NULL, NULL, &err), &err);
    assert_true(scene_same_bits(face_shown(with.face), face_rest(with.face)));
    assert_int_equal(face_metered(with.face)->projected_count, 0);
    const face_control brow = {scene_rest(&with, with.contact[BROW].vertex), 1 + BROW};
    const double end[3] = {brow.start.x, brow.start.y, brow.start.z + 5.0};
    must(face_engage(with.face, &settings, &brow, 1, &err), &err);
    must(face_engage(without.face, &settings, &brow, 1, &err), &err);
    must(face_pull(with.face, end, NULL, &err), &err);
    must(face_pull(without.face, end, NULL, &err), &err);
    assert_true(scene_greatest_difference(face_shown(with.face), face_rest(with.face)) > 4.9);
    assert_true(scene_same_bits(face_shown(with.face), face_shown(without.face)));
    assert_true(face_columns_now(with.face).is_exact);
    face_destroy(with.face);
    face_destroy(without.face);
}

/* The chin bone opens with the jaw: what is pushed into it stops there, in any pose. */
/* More than 5 mm from the bone there is nothing to feel. */
static void skin_far_from_the_skull_moves_freely(void **state)
{
    (void)state;
    static face_scene s;
    make(&s, 1);
    for (double way = 0.0; way <= 1.5; way += 0.25) {
        assert_true(fabs(push_brow(&s, way) - way) < 1e-5);
        assert_true(face_columns_now(s.face).is_exact);
    }
    face_destroy(s.face);
}

static void proxies_ride_on_their_bones(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    make(&s, 2);
    for (int open = 0; open <= 4; ++open) {
        float dof[MRT_MAX_DOFS] = {0.1f * (float)open};
        rigid pose[SCENE_BONES];
        face_reset(s.face);
        must(face_pull(s.face, NULL, dof, &err), &err);
        must(scene_hold(&s, &settings, end, &err), &err);
        end[CHIN][2] -= 30.0;
        must(face_pull(s.face, end[0], dof, &err), &err);
        bones_pose(pose, face_bones(s.face), dof);
        rigid back = rigid_inverse(&pose[JAW]);
        uint32_t v = s.contact[CHIN].vertex;
        double rest = height(&s.proxy[1], scene_rest(&s, v));
        double now = height(&s.proxy[1], rigid_apply(&back, scene_shown(&s, v)));
        assert_true(now >= lowest(&s.proxy[1], scene_rest(&s, v)) - 1e-5);
        assert_true(now < rest);
        assert_true(face_penetration_mm(s.face) < 1e-2);
    }
    face_destroy(s.face);
}

static void overlapping_proxies_keep_skin_out_of_both(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    scene_init(&s);
    s.proxy[0] = (rig_proxy){.bone = SKULL, .centre = {10, 40, 40}, .radii = {40, 40, 38}};
    s.proxy[1] = (rig_proxy){.bone = SKULL, .centre = {40, 50, 30}, .radii = {35, 40, 30}};
    s.rig.proxy_count = 2;
    must(scene_finish(&s, &err), &err);
    must(scene_hold(&s, &settings, end, &err), &err);
    end[BROW][2] -= 35.0;
    end[BROW][0] -= 5.0;
    must(face_pull(s.face, end[0], NULL, &err), &err);
    assert_true(face_metered(s.face)->penetration_mm > 5.0);
    assert_true(face_penetration_mm(s.face) < 0.05);
    face_destroy(s.face);
}

/* Anchored again in a pushed pose, the face stays where it is. */
static void engaging_in_a_projected_pose_does_not_jump(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    points kept;
    make(&s, 2);
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    (void)push_brow(&s, 20.0);
    points_copy(&kept, face_shown(s.face));
    face_commit(s.face);
    must(face_pull(s.face, NULL, NULL, &err), &err);
    assert_true(scene_greatest_difference(&kept, face_shown(s.face)) < 1e-4);
    must(scene_hold(&s, &settings, end, &err), &err);
    must(face_pull(s.face, end[0], NULL, &err), &err);
    assert_true(scene_greatest_difference(&kept, face_shown(s.face)) < 1e-4);
    points_destroy(&kept);
    face_destroy(s.face);
}

static void proxies_that_are_none_are_refused(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    scene_init(&s);
    s.proxy[0] = (rig_proxy){.bone = SKULL, .centre = {0, 0, 0}, .radii = {10, 0, 10}};
    s.rig.proxy_count = 1;
    assert_int_equal(scene_finish(&s, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "skull_proxy 0"));
    s.rig.proxy_count = 33;
    assert_int_equal(scene_finish(&s, &err), MRT_ERR_UNSUPPORTED);
}

/* ---- folds ---- */

static void gentle_faces_do_not_fold(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    const float dof[MRT_MAX_DOFS] = {0.3f};
    make(&s, 0);
    must(face_pull(s.face, NULL, NULL, &err), &err);
    assert_true(fabs(face_min_determinant(s.face) - 1.0) < 1e-12);
    must(scene_hold(&s, &settings, end, &err), &err);
    end[CHEEK][0] += 4.0;
    end[BROW][1] += 4.0;
    must(face_pull(s.face, end[0], NULL, &err), &err);
    double determinant = face_min_determinant(s.face);
    assert_true(determinant > 0.3 && determinant < 1.0);
    face_reset(s.face);
    must(face_pull(s.face, NULL, dof, &err), &err);
    determinant = face_min_determinant(s.face);
    assert_true(determinant > 0.3 && determinant < 1.0);
    face_destroy(s.face);
}

/* Pulled over its neighbours, skin is turned over. */
static void turned_skin_is_found(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    make(&s, 0);
    must(scene_hold(&s, &settings, end, &err), &err);
    end[CHEEK][0] += 24.0;
    end[CHEEK][2] += 2.0;
    must(face_pull(s.face, end[0], NULL, &err), &err);
    assert_true(face_metered(s.face)->slope_bound > 1.0);
    assert_true(face_min_determinant(s.face) <= 0.0);
    face_destroy(s.face);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(skin_stops_at_the_skull_smoothly),
        cmocka_unit_test(skin_that_does_not_sink_is_left_alone),
        cmocka_unit_test(skin_far_from_the_skull_moves_freely),
        cmocka_unit_test(proxies_ride_on_their_bones),
        cmocka_unit_test(overlapping_proxies_keep_skin_out_of_both),
        cmocka_unit_test(engaging_in_a_projected_pose_does_not_jump),
        cmocka_unit_test(proxies_that_are_none_are_refused),
        cmocka_unit_test(gentle_faces_do_not_fold),
        cmocka_unit_test(turned_skin_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
