/* A face performed from its base: what a control does and what it leaves alone, that nothing jumps,
 * and that the columns say all. mm. */
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

static void make(face_scene *s)
{
    error err = {""};
    scene_init(s);
    must(scene_finish(s, &err), &err);
}

static void expect_at(const face_scene *s, uint32_t vertex, const double at[3], double limit)
{
    vec3 shown = scene_shown(s, vertex);
    double miss = scene_distance(shown, (vec3){at[0], at[1], at[2]});
    if (!(miss <= limit))
        fail_msg("vertex %u at (%g, %g, %g), %g mm from its end", vertex, shown.x, shown.y, shown.z,
                 miss);
}

static float *driven(float dof[MRT_MAX_DOFS])
{
    memset(dof, 0, MRT_MAX_DOFS * sizeof *dof);
    return dof;
}

/* A pose in which every bone has moved. */
static void mixed_pose(const face_scene *s, float dof[MRT_MAX_DOFS])
{
    driven(dof);
    dof[scene_dof(s, "jaw.open")] = 0.35f;
    dof[scene_dof(s, "jaw.lateral")] = 3.0f;
    dof[scene_dof(s, "jaw.forward")] = 2.0f;
    dof[scene_dof(s, "eye.yaw")] = 0.3f;
    dof[scene_dof(s, "lid.close")] = 0.3f;
}

static void expect_rigid(const face_scene *s, uint32_t first, uint32_t count, const rigid *motion)
{
    for (uint32_t v = first; v < first + count; ++v)
        assert_true(scene_distance(scene_shown(s, v), rigid_apply(motion, scene_rest(s, v))) <
                    2e-5);
}

static void expect_still(const face_scene *s, uint32_t first, uint32_t count)
{
    for (uint32_t v = first; v < first + count; ++v)
        assert_true(scene_distance(scene_shown(s, v), scene_rest(s, v)) == 0.0);
}

static void contacts_are_as_a_plugin_sees_them(void **state)
{
    (void)state;
    static face_scene s;
    uint32_t count = 0;
    make(&s);
    const mrt_contact *contact = face_contacts(s.face, &count);
    assert_int_equal(count, SCENE_CONTACTS);
    assert_string_equal(contact[LOWER_LIP].name, "lip.lower");
    assert_string_equal(contact[LOWER_LIP].bone, "jaw");
    assert_string_equal(contact[UPPER_LIP].bone, "skull");
    assert_true(contact[CHIN].rest.y == -25.0f && contact[CHIN].normal.z == 1.0f);
    face_destroy(s.face);
}

static void rest_gives_the_rest_face_bit_for_bit(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    float dof[MRT_MAX_DOFS];
    make(&s);
    must(face_pull(s.face, NULL, NULL, &err), &err);
    assert_true(scene_same_bits(face_shown(s.face), face_rest(s.face)));
    must(scene_hold(&s, &settings, end, &err), &err);
    must(face_pull(s.face, end[0], NULL, &err), &err);
    assert_true(scene_same_bits(face_shown(s.face), face_rest(s.face)));
    must(face_pull(s.face, end[0], driven(dof), &err), &err);
    assert_true(scene_same_bits(face_shown(s.face), face_rest(s.face)));
    assert_true(face_metered(s.face)->slope_bound == 0.0);
    assert_true(face_columns_now(s.face).is_exact);
    face_destroy(s.face);
}

/* 5 mm up with the upper lip, then 5 mm down with the lower one. */
static void lips_part_and_do_not_drag_each_other(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    for (int side = 0; side < 2; ++side) {
        double end[SCENE_CONTACTS][3], other = 0.0;
        float dof[MRT_MAX_DOFS];
        uint32_t pulled = side == 0 ? UPPER_LIP : LOWER_LIP;
        make(&s);
        must(scene_hold(&s, &settings, end, &err), &err);
        end[pulled][1] += side == 0 ? 5.0 : -5.0;
        must(face_pull(s.face, end[0], driven(dof), &err), &err);
        expect_at(&s, s.contact[pulled].vertex, end[pulled], 1e-5);
        for (int column = 1 - SCENE_SLIT; column < SCENE_SLIT; ++column) {
            uint32_t v = side == 0 ? scene_below(column, 0) : scene_at(column, 0);
            other = fmax(other, scene_distance(scene_shown(&s, v), scene_rest(&s, v)));
        }
        print_message("the other lip moves %.3g mm\n", other);
        assert_true(other < 0.1);
        expect_still(&s, SCENE_UPPER_TEETH, SCENE_VERTICES - SCENE_UPPER_TEETH);
        face_destroy(s.face);
    }
}

static void controls_land_on_their_ends_whatever_the_pose(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    float dof[MRT_MAX_DOFS];
    double end[SCENE_CONTACTS][3];
    make(&s);
    must(scene_hold(&s, &settings, end, &err), &err);
    for (uint32_t i = 0; i < SCENE_CONTACTS; ++i) {
        end[i][0] += 1.0 + 0.5 * i;
        end[i][1] += 2.0 - 0.25 * i * i;
        end[i][2] += 0.75 * (i % 3);
    }
    for (int open = 0; open < 2; ++open) {
        if (open)
            mixed_pose(&s, dof);
        else
            driven(dof);
        must(face_pull(s.face, end[0], dof, &err), &err);
        for (uint32_t i = 0; i < SCENE_CONTACTS; ++i)
            expect_at(&s, s.contact[i].vertex, end[i], 1e-4);
    }
    assert_int_equal(face_metered(s.face)->dropped_count, 0);
    face_destroy(s.face);
}

static void bones_move_their_parts_rigidly(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    float dof[MRT_MAX_DOFS];
    rigid pose[SCENE_BONES];
    make(&s);
    mixed_pose(&s, dof);
    must(face_pull(s.face, NULL, dof, &err), &err);
    bones_pose(pose, face_bones(s.face), dof);
    expect_rigid(&s, SCENE_LOWER_TEETH, 2 * SCENE_TEETH, &pose[JAW]);
    expect_rigid(&s, SCENE_EYE, 6, &pose[EYE]);
    expect_still(&s, SCENE_UPPER_TEETH, 2 * SCENE_TEETH);
    expect_still(&s, scene_at(0, 0), 1);
    assert_true(scene_shown(&s, scene_below(0, 0)).y < -25.0);
    assert_true(face_metered(s.face)->dof[0] == 0.35f);
    face_destroy(s.face);
}

static void undriven_jaws_follow_the_controls_that_ride_on_them(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    make(&s);
    must(scene_hold(&s, &settings, end, &err), &err);
    rigid open = bones_jaw(face_bones(s.face), 0.25, 2.0, 1.0);
    const uint32_t riders[] = {LOWER_LIP, CHIN, JAW_LEFT, JAW_RIGHT};
    for (uint32_t i = 0; i < 4; ++i) {
        vec3 to = rigid_apply(&open, scene_rest(&s, s.contact[riders[i]].vertex));
        end[riders[i]][0] = to.x;
        end[riders[i]][1] = to.y;
        end[riders[i]][2] = to.z;
    }
    must(face_pull(s.face, end[0], NULL, &err), &err);
    const float *dof = face_metered(s.face)->dof;
    assert_true(fabs((double)dof[0] - 0.25) < 1e-3 && fabs((double)dof[1] - 2.0) < 1e-2 &&
                fabs((double)dof[2] - 1.0) < 1e-1);
    expect_rigid(&s, SCENE_LOWER_TEETH, 2, &open);
    /* Brows alone do not open it, and without riders it stays as it is. */
    face_control brow = {scene_shown(&s, s.contact[BROW].vertex), 1 + BROW};
    must(face_engage(s.face, &settings, &brow, 1, &err), &err);
    points kept;
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    points_copy(&kept, face_shown(s.face));
    const double to[3] = {brow.start.x, brow.start.y, brow.start.z};
    must(face_pull(s.face, to, NULL, &err), &err);
    assert_true(scene_greatest_difference(&kept, face_shown(s.face)) < 1e-4);
    points_destroy(&kept);
    face_destroy(s.face);
}

/* In poses, with pulls, derived jaws and other controls than before. */
static void neither_engaging_nor_committing_makes_the_face_jump(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    float dof[MRT_MAX_DOFS];
    double worst = 0.0, end[SCENE_CONTACTS][3];
    points kept;
    make(&s);
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    for (int round = 0; round < 12; ++round) {
        const float *drive = round % 3 == 2 ? NULL : dof;
        mixed_pose(&s, dof);
        dof[0] = 0.05f * (float)round;
        must(scene_hold(&s, &settings, end, &err), &err);
        for (uint32_t i = 0; i < SCENE_CONTACTS; ++i)
            end[i][i % 3] += 0.25 * (i + 1.0) * (round % 2 ? 1.0 : -0.5);
        must(face_pull(s.face, end[0], drive, &err), &err);
        points_copy(&kept, face_shown(s.face));
        if (round % 4 == 1) {
            face_commit(s.face);
            must(face_pull(s.face, NULL, drive, &err), &err);
        } else {
            must(scene_hold(&s, &settings, end, &err), &err);
            must(face_pull(s.face, end[0], drive, &err), &err);
        }
        worst = fmax(worst, scene_greatest_difference(&kept, face_shown(s.face)));
    }
    print_message("largest jump: %.2g mm\n", worst);
    assert_true(worst < 1e-4);
    expect_still(&s, SCENE_UPPER_TEETH, 2 * SCENE_TEETH);
    points_destroy(&kept);
    face_destroy(s.face);
}

/* Teeth and eyes come back to the bit, however often the face was taken anew in a pose. */
static void engagements_wear_nothing_away(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    float dof[MRT_MAX_DOFS];
    double end[SCENE_CONTACTS][3];
    make(&s);
    mixed_pose(&s, dof);
    for (int round = 0; round < 100; ++round) {
        must(face_pull(s.face, NULL, dof, &err), &err);
        must(scene_hold(&s, &settings, end, &err), &err);
        end[BROW][1] += 0.1;
        must(face_pull(s.face, end[0], dof, &err), &err);
        face_commit(s.face);
    }
    must(face_pull(s.face, NULL, driven(dof), &err), &err);
    expect_still(&s, SCENE_UPPER_TEETH, SCENE_VERTICES - SCENE_UPPER_TEETH);
    assert_true(scene_shown(&s, s.contact[BROW].vertex).y > 55.0);
    face_reset(s.face);
    assert_true(scene_same_bits(face_shown(s.face), face_rest(s.face)));
    face_destroy(s.face);
}

static void the_columns_say_all_that_is_shown(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    float dof[MRT_MAX_DOFS];
    double end[SCENE_CONTACTS][3];
    make(&s);
    must(scene_hold(&s, &settings, end, &err), &err);
    uint32_t engagement = face_columns_now(s.face).engagement;
    end[CHEEK][0] += 4.0;
    end[CHIN][1] -= 3.0;
    mixed_pose(&s, dof);
    must(face_pull(s.face, end[0], dof, &err), &err);
    face_columns c = face_columns_now(s.face);
    assert_true(c.is_exact && c.engagement == engagement);
    assert_true(c.count >= SCENE_CONTACTS + 4 * 3);
    for (uint32_t v = 0; v < c.base->count; ++v) {
        float sum[3] = {0.0f, 0.0f, 0.0f};
        for (uint32_t j = 0; j < c.count; ++j)
            for (int axis = 0; axis < 3; ++axis)
                sum[axis] += c.column[j * c.stride + v] * (float)c.weight[3 * j + (uint32_t)axis];
        const points *p = face_shown(s.face);
        assert_true(c.base->x[v] + sum[0] == p->x[v] && c.base->y[v] + sum[1] == p->y[v] &&
                    c.base->z[v] + sum[2] == p->z[v]);
    }
    face_commit(s.face);
    assert_true(face_columns_now(s.face).engagement > engagement);
    face_destroy(s.face);
}

static void frames_do_not_depend_on_the_frames_before(void **state)
{
    (void)state;
    static face_scene a, b;
    error err = {""};
    float dof[MRT_MAX_DOFS];
    double end[SCENE_CONTACTS][3], other[SCENE_CONTACTS][3];
    make(&a);
    make(&b);
    must(scene_hold(&a, &settings, end, &err), &err);
    must(scene_hold(&b, &settings, end, &err), &err);
    memcpy(other, end, sizeof end);
    other[CHIN][1] -= 20.0;
    end[CORNER][0] += 6.0;
    end[CHIN][1] -= 8.0;
    must(face_pull(a.face, other[0], NULL, &err), &err);
    mixed_pose(&a, dof);
    must(face_pull(a.face, other[0], dof, &err), &err);
    must(face_pull(a.face, end[0], NULL, &err), &err);
    must(face_pull(b.face, end[0], NULL, &err), &err);
    assert_true(scene_same_bits(face_shown(a.face), face_shown(b.face)));
    face_destroy(a.face);
    face_destroy(b.face);
}

static void immovable_places_are_not_pulled(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    make(&s);
    uint32_t edge = scene_at(SCENE_HALF, 0);
    face_control control = {scene_rest(&s, edge), 0};
    const double end[3] = {control.start.x, control.start.y, control.start.z + 10.0};
    must(face_engage(s.face, &settings, &control, 1, &err), &err);
    must(face_pull(s.face, end, NULL, &err), &err);
    assert_int_equal(face_metered(s.face)->dropped_count, 1);
    assert_true(scene_same_bits(face_shown(s.face), face_rest(s.face)));
    face_commit(s.face);
    assert_int_equal(face_metered(s.face)->dropped_count, 0);
    face_destroy(s.face);
}

static void what_is_refused_changes_nothing(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    float dof[MRT_MAX_DOFS];
    double end[SCENE_CONTACTS][3];
    points kept;
    make(&s);
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    must(scene_hold(&s, &settings, end, &err), &err);
    end[CHIN][1] -= 4.0;
    mixed_pose(&s, dof);
    must(face_pull(s.face, end[0], dof, &err), &err);
    points_copy(&kept, face_shown(s.face));
    double bad[SCENE_CONTACTS][3];
    memcpy(bad, end, sizeof end);
    bad[CHEEK][2] = (double)NAN;
    assert_int_equal(face_pull(s.face, bad[0], dof, &err), MRT_ERR_ARGUMENT);
    assert_string_equal(err.text, "control 4: its end nan is not within +-1e+15");
    dof[0] = INFINITY;
    assert_int_equal(face_pull(s.face, end[0], dof, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "jaw.open"));
    mixed_pose(&s, dof);
    face_control control = {{0, 0, (double)INFINITY}, 0};
    assert_int_equal(face_engage(s.face, &settings, &control, 1, &err), MRT_ERR_ARGUMENT);
    control = (face_control){{0, 0, 0}, SCENE_CONTACTS + 1};
    assert_int_equal(face_engage(s.face, &settings, &control, 1, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "has contact 9, but the face has only 8"));
    control = (face_control){{0, 0, 85}, 0};
    csrbf_settings wrong = {.radius = -1.0};
    assert_int_equal(face_engage(s.face, &wrong, &control, 1, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(face_engage(s.face, &settings, &control, MRT_MAX_VECTORS + 1, &err),
                     MRT_ERR_ARGUMENT);
    assert_true(scene_same_bits(face_shown(s.face), &kept));
    must(face_pull(s.face, end[0], dof, &err), &err);
    assert_true(scene_same_bits(face_shown(s.face), &kept));
    points_destroy(&kept);
    face_destroy(s.face);
}

static void bindings_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    binding b;
    scene_init(&s);
    scene_bind(&s, &b);
    b.weight[SCENE_VERTICES + 7] = (float)NAN;
    assert_int_equal(face_create_bound(&s.face, &s.rig, &s.mesh, &b, 4, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "bone 1, vertex 7: weight nan"));
    assert_null(s.face);
    assert_null(b.weight);
    scene_bind(&s, &b);
    b.vertex_count -= 1;
    assert_int_equal(face_create_bound(&s.face, &s.rig, &s.mesh, &b, 4, &err), MRT_ERR_ARGUMENT);
    scene_bind(&s, &b);
    s.contact[CHEEK].vertex = SCENE_VERTICES;
    assert_int_equal(face_create_bound(&s.face, &s.rig, &s.mesh, &b, 4, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "contact cheek.l"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_are_as_a_plugin_sees_them),
        cmocka_unit_test(rest_gives_the_rest_face_bit_for_bit),
        cmocka_unit_test(lips_part_and_do_not_drag_each_other),
        cmocka_unit_test(controls_land_on_their_ends_whatever_the_pose),
        cmocka_unit_test(bones_move_their_parts_rigidly),
        cmocka_unit_test(undriven_jaws_follow_the_controls_that_ride_on_them),
        cmocka_unit_test(neither_engaging_nor_committing_makes_the_face_jump),
        cmocka_unit_test(engagements_wear_nothing_away),
        cmocka_unit_test(the_columns_say_all_that_is_shown),
        cmocka_unit_test(frames_do_not_depend_on_the_frames_before),
        cmocka_unit_test(immovable_places_are_not_pulled),
        cmocka_unit_test(what_is_refused_changes_nothing),
        cmocka_unit_test(bindings_that_do_not_fit_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
