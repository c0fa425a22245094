/* No performance folds or tears: near it less is given, continuously, and it is said. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/face_scene.h"

enum { STEPS = 200 };
#define DEEP 24.0 /* mm */

static const csrbf_settings settings = {.radius = 30.0};
static const csrbf_settings without = {.radius = 30.0, .stretch_most = -1.0};

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

static void hold_at(const face_scene *s, const csrbf_settings *with, const uint32_t vertex[3],
                    double start[3][3])
{
    face_control control[3];
    error err = {""};
    for (uint32_t k = 0; k < 3; ++k) {
        control[k] = (face_control){.start = scene_rest(s, vertex[k])};
        start[k][0] = control[k].start.x;
        start[k][1] = control[k].start.y;
        start[k][2] = control[k].start.z;
    }
    must(face_engage(s->face, with, control, 3, &err), &err);
}

/* Two places 10 mm apart on the cheek, and one far away on the brow. */
static void hold(const face_scene *s, const csrbf_settings *with, double start[3][3])
{
    const uint32_t vertex[3] = {scene_at(10, 5), scene_at(14, 5), scene_at(-14, 18)};
    hold_at(s, with, vertex, start);
}

/* The two go towards each other by so much, and the third up by 3. */
static void squeeze(const face_scene *s, double start[3][3], double by)
{
    double end[3][3];
    error err = {""};
    memcpy(end, start, sizeof end);
    end[0][0] += by;
    end[1][0] -= by;
    end[2][1] += 3.0;
    must(face_pull(s->face, end[0], NULL, &err), &err);
}

static void two_that_pull_through_each_other_fold_nothing(void **state)
{
    (void)state;
    static face_scene s;
    double start[3][3];
    make(&s);
    hold(&s, &without, start);
    squeeze(&s, start, 12.0);
    assert_true(face_measure_surface(s.face).min_determinant <= 0.0); /* it would */
    assert_true(face_measure_surface(s.face).held_back_mm <= 0.0);
    hold(&s, &without, start);
    face_reset(s.face);
    hold(&s, &settings, start);
    for (int i = 0; i <= STEPS; ++i) {
        squeeze(&s, start, 0.2 * i);
        face_surface now = face_measure_surface(s.face);
        assert_true(now.min_determinant > 0.0);
        assert_int_equal(now.skin.bent_count + now.skin.inside_out_count, 0);
    }
    assert_true(face_measure_surface(s.face).held_back_mm > 20.0);
    squeeze(&s, start, 12.0);
    /* who is far away and pulls alone is not held back with them */
    vec3 brow = scene_shown(&s, scene_at(-14, 18)), rest = scene_rest(&s, scene_at(-14, 18));
    print_message("far away: %.3f mm of 3\n", brow.y - rest.y);
    assert_true(fabs(brow.y - rest.y - 3.0) < 0.3);
    face_destroy(s.face);
}

static void what_does_not_fold_keeps_its_bits(void **state)
{
    (void)state;
    static face_scene s, t;
    double start[3][3];
    make(&s);
    make(&t);
    hold(&s, &settings, start);
    hold(&t, &without, start);
    squeeze(&s, start, 1.0);
    squeeze(&t, start, 1.0);
    assert_true(face_measure_surface(s.face).held_back_mm <= 0.0);
    assert_true(scene_same_bits(face_shown(s.face), face_shown(t.face)));
    face_destroy(s.face);
    face_destroy(t.face);
}

/* Ends that move by 0.02 mm a step: nothing on the face moves by more than a few times that. */
static void it_gives_less_without_a_jump(void **state)
{
    (void)state;
    static face_scene s;
    double start[3][3], worst = 0.0;
    error err = {""};
    points before;
    make(&s);
    must(points_create(&before, face_order(s.face), s.mesh.position, &err), &err);
    hold(&s, &settings, start);
    for (int i = 0; i <= 10 * STEPS; ++i) {
        squeeze(&s, start, 0.02 * i);
        if (i > 0)
            worst = fmax(worst, scene_greatest_difference(&before, face_shown(s.face)));
        points_copy(&before, face_shown(s.face));
    }
    assert_true(worst > 0.01 && worst < 0.2);
    points_destroy(&before);
    face_destroy(s.face);
}

/* Whichever frames were before: what is known of them only says where not to look. */
static void what_is_given_depends_on_the_frame_alone(void **state)
{
    (void)state;
    static face_scene s, fresh;
    double start[3][3], end[3][3];
    uint32_t held = 0, seed = 7;
    float dof[MRT_MAX_DOFS] = {0.0f};
    error err = {""};
    make(&s);
    hold(&s, &settings, start);
    make(&fresh);
    for (int i = 0; i < 60; ++i) {
        memcpy(end, start, sizeof end);
        for (size_t k = 0; k < 9; ++k) {
            seed = seed * 1664525u + 1013904223u;
            end[k / 3][k % 3] += (double)(seed >> 8) / 16777216.0 * 16.0 - 8.0;
        }
        dof[0] = i % 3 == 0 ? 0.0f : 0.006f * (float)i; /* the jaw */
        must(face_pull(s.face, end[0], dof, &err), &err);
        face_reset(fresh.face);
        hold(&fresh, &settings, start);
        must(face_pull(fresh.face, end[0], dof, &err), &err);
        assert_true(scene_same_bits(face_shown(s.face), face_shown(fresh.face)));
        held += face_measure_surface(s.face).held_back_mm > 0.0;
    }
    print_message("held back in %u of 60\n", held);
    assert_true(held > 10 && held < 50);
    face_destroy(s.face);
    face_destroy(fresh.face);
}

/* A jaw that hangs open tilts the skin beside the lips already: pulls may tilt it so much less. */
static void what_bones_have_tilted_is_not_turned_over(void **state)
{
    (void)state;
    static face_scene s;
    double start[3][3], end[3][3], least_alone = 1.0, least = 1.0;
    uint32_t seed = 11, bent = 0;
    error err = {""};
    make(&s);
    const uint32_t vertex[3] = {scene_at(6, -2), scene_at(9, 1), scene_at(-7, -3)};
    for (int i = 0; i < 300; ++i) {
        float dof[MRT_MAX_DOFS] = {0.0f};
        dof[0] = 0.05f * (float)(i % 9);
        dof[1] = (float)(i % 5) - 2.0f;
        face_reset(s.face);
        must(face_pull(s.face, NULL, dof, &err), &err);
        least_alone = fmin(least_alone, face_measure_surface(s.face).min_determinant);
        bent += face_measure_surface(s.face).skin.bent_count;
        hold_at(&s, &settings, vertex, start);
        memcpy(end, start, sizeof end);
        for (size_t k = 0; k < 9; ++k) {
            seed = seed * 1664525u + 1013904223u;
            end[k / 3][k % 3] += (double)(seed >> 8) / 16777216.0 * 60.0 - 30.0;
        }
        face_reset(s.face);
        hold_at(&s, &settings, vertex, start);
        must(face_pull(s.face, end[0], dof, &err), &err);
        least = fmin(least, face_measure_surface(s.face).min_determinant);
        bent += face_measure_surface(s.face).skin.bent_count;
    }
    print_message("least determinant %.3f, by the bones alone %.3f, %u edges bent\n", least,
                  least_alone, bent);
    assert_true(least_alone > 0.3 && least_alone < 0.7);
    assert_true(least > 0.0);
    assert_int_equal(bent, 0);
    face_destroy(s.face);
}

/* The mesh alone, of which the field is one of space. */
static void make_bare(face_scene *s)
{
    error err = {""};
    scene_init(s);
    must(face_create(&s->face, NULL, &s->mesh, NULL, MRT_MAX_VECTORS, &err), &err);
}

/* Two places before the upper teeth, and one far away. */
static void hold_lip(const face_scene *s, const csrbf_settings *with, double start[3][3])
{
    const uint32_t vertex[3] = {scene_at(-3, 2), scene_at(3, 2), scene_at(-14, 18)};
    hold_at(s, with, vertex, start);
}

/* The two go inwards by so much. */
static void push(const face_scene *s, double start[3][3], double by)
{
    double end[3][3];
    error err = {""};
    memcpy(end, start, sizeof end);
    end[0][2] -= by;
    end[1][2] -= by;
    must(face_pull(s->face, end[0], NULL, &err), &err);
}

/* What lies behind the skin is run over by it: no triangle of either is squeezed. */
static void space_folds_nowhere_beside_the_skin(void **state)
{
    (void)state;
    static face_scene s;
    double start[3][3], worst = 0.0, least = 1.0;
    error err = {""};
    points before;
    make_bare(&s);
    hold_lip(&s, &without, start);
    push(&s, start, DEEP);
    face_surface asked = face_measure_surface(s.face);
    assert_true(asked.min_determinant <= 0.0); /* it would */
    face_reset(s.face);
    must(points_create(&before, face_order(s.face), s.mesh.position, &err), &err);
    hold_lip(&s, &settings, start);
    for (int i = 0; i <= 10 * STEPS; ++i) {
        push(&s, start, DEEP * i / (10.0 * STEPS));
        least = fmin(least, face_measure_surface(s.face).min_determinant);
        if (i > 0)
            worst = fmax(worst, scene_greatest_difference(&before, face_shown(s.face)));
        points_copy(&before, face_shown(s.face));
    }
    print_message("least determinant %.4f, greatest step %.4f mm, held back %.2f mm\n", least,
                  worst, face_measure_surface(s.face).held_back_mm);
    assert_true(least > 0.04);
    assert_true(face_measure_surface(s.face).held_back_mm > 0.1);
    assert_true(worst > 0.001 && worst < 2.0 * DEEP / (10.0 * STEPS));
    points_destroy(&before);
    face_destroy(s.face);
}

static vec3 drag_one(const face_scene *s, const csrbf_settings *with, vec3 from, vec3 to)
{
    error err = {""};
    shape_step step;
    double reached[3];
    const double a[3] = {from.x, from.y, from.z}, b[3] = {to.x, to.y, to.z};
    must(face_drag(s->face, with, a, b, 1, NULL, reached, &step, &err), &err);
    assert_true(step.min_determinant > 0.0);
    return (vec3){reached[0], reached[1], reached[2]};
}

/* A tip that pulls 200 mm out of the cheek: the mesh is stretched as far as it may be, and the tip
 * stays with it. */
static double pull_out(face_scene *s, const csrbf_settings *with)
{
    vec3 tip = scene_rest(s, scene_at(10, 5));
    double held = 0.0;
    make(s);
    for (int i = 1; i <= STEPS; ++i) {
        vec3 to = vec3_add(scene_rest(s, scene_at(10, 5)), (vec3){0, 0, (double)i});
        tip = drag_one(s, with, tip, to);
        held = fmax(held, face_measure_surface(s->face).held_back_mm);
    }
    return held;
}

static void clay_gives_less_instead_of_tearing(void **state)
{
    (void)state;
    static face_scene s;
    csrbf_settings with = settings;
    for (double most = 3.0; most < 9.0; most += 2.5) {
        with.stretch_most = most;
        make(&s);
        face_destroy(s.face);
        double held = pull_out(&s, &with);
        face_surface now = face_measure_surface(s.face);
        assert_true(now.skin.stretch <= most + 1e-4);
        assert_true(now.skin.stretch > 0.8 * most);
        assert_int_equal(now.skin.bent_count + now.skin.inside_out_count, 0);
        assert_true(held > 5.0);
        face_destroy(s.face);
    }
    make(&s);
    face_destroy(s.face);
    (void)pull_out(&s, &without);
    assert_true(face_measure_surface(s.face).skin.stretch > 9.0); /* it would */
    face_destroy(s.face);
}

/* A tip that drives the skin into a knob of the skull, and on: it comes to lie on it, and crumples
 * there though the clay itself is whole. */
static void clay_on_the_skull_is_not_crumpled(void **state)
{
    (void)state;
    static face_scene s;
    const csrbf_settings with = {.radius = 40.0};
    error err = {""};
    double way = 0.0;
    scene_init(&s);
    s.proxy[0] = (rig_proxy){.bone = SKULL, .centre = {0, 10, 60}, .radii = {20, 20, 20}};
    s.rig.proxy_count = 1;
    must(scene_finish(&s, &err), &err);
    vec3 from = scene_rest(&s, scene_at(3, 6)), tip = from;
    for (int step = 1; step <= STEPS; ++step) {
        tip =
            drag_one(&s, &with, tip, vec3_add(from, (vec3){-0.1 * step, 0.1 * step, -0.3 * step}));
        face_surface now = face_measure_surface(s.face);
        assert_int_equal(now.skin.bent_count + now.skin.inside_out_count, 0);
        way = fmax(way, vec3_length(vec3_sub(scene_shown(&s, scene_at(3, 6)), from)));
    }
    print_message("the skin went %.1f mm, %.1f mm held back\n", way,
                  face_measure_surface(s.face).held_back_mm);
    assert_true(way > 5.0 && face_measure_surface(s.face).held_back_mm > 5.0);
    face_destroy(s.face);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_that_pull_through_each_other_fold_nothing),
        cmocka_unit_test(what_does_not_fold_keeps_its_bits),
        cmocka_unit_test(what_bones_have_tilted_is_not_turned_over),
        cmocka_unit_test(it_gives_less_without_a_jump),
        cmocka_unit_test(what_is_given_depends_on_the_frame_alone),
        cmocka_unit_test(space_folds_nowhere_beside_the_skin),
        cmocka_unit_test(clay_gives_less_instead_of_tearing),
        cmocka_unit_test(clay_on_the_skull_is_not_crumpled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
