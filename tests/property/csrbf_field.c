/* What must hold for a displacement field whatever the controls: 200 random scenes, every kernel
 * and polynomial in turn. Limits are relative to the largest displacement unless said otherwise;
 * they are those of the theory's table, where the prototype measured 1e-16 to 1e-12. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf/saddle.h"
#include "property/csrbf_check.h"

/* ---- exact ones ---- */

static void check_zero(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene still = *s;
    memset(still.g, 0, sizeof still.g);
    solve(&still);
    still.point[0][0] = -0.0;
    positions moved;
    memcpy(moved.at, still.point, sizeof moved.at);
    csrbf_move_f64(solver, moved.at[0], SCENE_POINTS);
    assert_memory_equal(moved.at, still.point, sizeof moved.at);
}

static void zero_displacements_are_the_identity(void **state)
{
    (void)state;
    for_scenes(check_zero, true, true, true, true);
}

static void check_outside(const scene *s, uint64_t *seed)
{
    (void)seed;
    int outside = 0;
    positions d = displacements(s);
    for (int i = 0; i < SCENE_POINTS; ++i) {
        bool inside = false;
        for (uint32_t k = 0; k < s->tip_count; ++k)
            inside |= scene_distance(s->point[i], s->tip[k]) < s->settings.radius;
        outside += !inside;
        for (int axis = 0; axis < 3 && !inside; ++axis)
            assert_true(d.at[i][axis] == 0.0);
    }
    assert_true(outside > 0);
}

static void deform_outside_support_is_identity(void **state)
{
    (void)state;
    for_scenes(check_outside, true, false, false, true);
}

static void check_order(const scene *s, uint64_t *seed)
{
    scene shuffled = *s;
    for (uint32_t i = s->tip_count; i-- > 1;) {
        uint32_t j = (uint32_t)(scene_next(seed) % (i + 1));
        for (int axis = 0; axis < 3; ++axis) {
            double tip = shuffled.tip[i][axis], g = shuffled.g[i][axis];
            shuffled.tip[i][axis] = shuffled.tip[j][axis];
            shuffled.g[i][axis] = shuffled.g[j][axis];
            shuffled.tip[j][axis] = tip;
            shuffled.g[j][axis] = g;
        }
    }
    positions a = displacements(s), b = displacements(&shuffled);
    assert_memory_equal(&a, &b, sizeof a);
}

static void order_of_controls_changes_no_bit(void **state)
{
    (void)state;
    for_scenes(check_order, true, true, true, true);
}

static void scale_all(scene *s, double factor)
{
    s->settings.radius *= factor;
    for (int axis = 0; axis < 3; ++axis) {
        for (uint32_t i = 0; i < s->tip_count; ++i) {
            s->tip[i][axis] *= factor;
            s->g[i][axis] *= factor;
        }
        for (int i = 0; i < SCENE_POINTS; ++i)
            s->point[i][axis] *= factor;
    }
}

static void check_power_of_two(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene larger = *s;
    scale_all(&larger, 4.0);
    positions a = displacements(s), b = displacements(&larger);
    for (int i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            a.at[i][axis] *= 4.0;
    assert_memory_equal(&a, &b, sizeof a);
}

static void scaling_by_four_changes_no_bit(void **state)
{
    (void)state;
    for_scenes(check_power_of_two, true, true, true, true);
}

static void check_sign_and_double(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene opposite = *s, doubled = *s;
    for (uint32_t i = 0; i < s->tip_count; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            opposite.g[i][axis] = -s->g[i][axis];
            doubled.g[i][axis] = 2.0 * s->g[i][axis];
        }
    /* At the origin nothing is rounded off when the displacement is added. */
    memset(opposite.point, 0, sizeof opposite.point);
    memset(doubled.point, 0, sizeof doubled.point);
    scene origin = *s;
    memset(origin.point, 0, sizeof origin.point);
    positions a = displacements(&origin), b = displacements(&opposite), c = displacements(&doubled);
    for (int axis = 0; axis < 3; ++axis) {
        assert_true(a.at[0][axis] == -b.at[0][axis]);
        assert_true(2.0 * a.at[0][axis] == c.at[0][axis]);
    }
}

static void turning_round_and_doubling_are_exact(void **state)
{
    (void)state;
    for_scenes(check_sign_and_double, true, true, true, true);
}

/* ---- interpolation ---- */

static void check_targets(const scene *s, uint64_t *seed)
{
    (void)seed;
    double x[SCENE_TIPS][3];
    memcpy(x, s->tip, sizeof x);
    solve(s);
    csrbf_move_f64(solver, x[0], s->tip_count);
    for (uint32_t i = 0; i < s->tip_count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            assert_true(fabs(x[i][axis] - s->tip[i][axis] - s->g[i][axis]) <= 1e-12);
}

static void solve_reproduces_control_targets(void **state)
{
    (void)state;
    for_scenes(check_targets, true, true, true, true);
}

static void check_new_centre(const scene *s, uint64_t *seed)
{
    positions before = displacements(s);
    scene more = *s;
    uint32_t added = more.tip_count++;
    do
        for (int axis = 0; axis < 3; ++axis)
            more.tip[added][axis] = scene_number(seed, 1.25);
    while (!scene_is_spread(&more, added));
    memcpy(more.g[added], more.tip[added], sizeof more.g[added]);
    csrbf_move_f64(solver, more.g[added], 1);
    for (int axis = 0; axis < 3; ++axis)
        more.g[added][axis] -= more.tip[added][axis];
    positions after = displacements(&more);
    expect_close(&before, &after, 1e-10 * s->largest_g);
}

static void a_centre_that_agrees_changes_nothing(void **state)
{
    (void)state;
    for_scenes(check_new_centre, true, true, true, false);
}

static void check_duplicate(const scene *s, uint64_t *seed)
{
    scene more = *s;
    uint32_t added = more.tip_count++, twin = (uint32_t)(scene_next(seed) % added);
    memcpy(more.tip[added], more.tip[twin], sizeof more.tip[added]);
    memcpy(more.g[added], more.g[twin], sizeof more.g[added]);
    positions a = displacements(s), b = displacements(&more);
    assert_memory_equal(&a, &b, sizeof a);
    assert_false(csrbf_diagnose(solver).merged_apart);
    assert_int_equal(csrbf_diagnose(solver).centre_count, s->tip_count);
}

static void a_centre_twice_is_that_centre(void **state)
{
    (void)state;
    for_scenes(check_duplicate, true, true, true, true);
}

static void check_isolated(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene more = *s;
    uint32_t added = more.tip_count++;
    more.tip[added][0] = 10.0;
    more.g[added][1] = 1.0;
    positions a = displacements(s), b = displacements(&more);
    expect_close(&a, &b, 1e-12);
}

static void a_tip_out_of_reach_has_no_effect(void **state)
{
    (void)state;
    for_scenes(check_isolated, true, false, false, false);
}

/* ---- symmetry ---- */

static void rotate_row(double row[3], double cosine, double sine)
{
    double x = cosine * row[0] - sine * row[1], y = sine * row[0] + cosine * row[1];
    row[0] = cosine * x - sine * row[2];
    row[2] = sine * x + cosine * row[2];
    row[1] = y;
}

static void check_rotation(const scene *s, uint64_t *seed)
{
    double angle = scene_number(seed, 3.0), cosine = cos(angle), sine = sin(angle);
    scene turned = *s;
    positions a = displacements(s);
    for (uint32_t i = 0; i < s->tip_count; ++i) {
        rotate_row(turned.tip[i], cosine, sine);
        rotate_row(turned.g[i], cosine, sine);
    }
    for (int i = 0; i < SCENE_POINTS; ++i) {
        rotate_row(turned.point[i], cosine, sine);
        rotate_row(a.at[i], cosine, sine);
    }
    positions b = displacements(&turned);
    expect_close(&a, &b, 1e-10 * s->largest_g);
}

static void turning_everything_turns_the_field(void **state)
{
    (void)state;
    for_scenes(check_rotation, true, true, true, true);
}

static void check_translation(const scene *s, uint64_t *seed)
{
    scene moved = *s;
    for (int axis = 0; axis < 3; ++axis) {
        double t = scene_number(seed, 5.0);
        for (uint32_t i = 0; i < s->tip_count; ++i)
            moved.tip[i][axis] += t;
        for (int i = 0; i < SCENE_POINTS; ++i)
            moved.point[i][axis] += t;
    }
    positions a = displacements(s), b = displacements(&moved);
    expect_close(&a, &b, 1e-9 * s->largest_g);
}

static void moving_everything_moves_the_field(void **state)
{
    (void)state;
    for_scenes(check_translation, true, true, true, true);
}

static void check_mirror(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene mirrored = *s;
    for (uint32_t i = 0; i < s->tip_count; ++i) {
        mirrored.tip[i][0] = -s->tip[i][0];
        mirrored.g[i][0] = -s->g[i][0];
    }
    positions a = displacements(s);
    for (int i = 0; i < SCENE_POINTS; ++i) {
        mirrored.point[i][0] = -s->point[i][0];
        a.at[i][0] = -a.at[i][0];
    }
    positions b = displacements(&mirrored);
    /* Not bit for bit: the canonical order of the mirrored controls is another one. */
    expect_close(&a, &b, 1e-12);
}

static void a_mirrored_scene_gives_the_mirrored_field(void **state)
{
    (void)state;
    for_scenes(check_mirror, true, true, true, true);
}

static void turn_axes(double row[3])
{
    double x = row[0];
    row[0] = row[1];
    row[1] = row[2];
    row[2] = x;
}

static void check_scale_and_axes(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene other = *s;
    scale_all(&other, 3.7);
    positions a = displacements(s);
    for (uint32_t i = 0; i < s->tip_count; ++i) {
        turn_axes(other.tip[i]);
        turn_axes(other.g[i]);
    }
    for (int i = 0; i < SCENE_POINTS; ++i) {
        turn_axes(other.point[i]);
        turn_axes(a.at[i]);
        for (int axis = 0; axis < 3; ++axis)
            a.at[i][axis] *= 3.7;
    }
    positions b = displacements(&other);
    expect_close(&a, &b, 1e-10 * s->largest_g);
}

static void unit_and_axes_do_not_matter(void **state)
{
    (void)state;
    for_scenes(check_scale_and_axes, true, true, true, true);
}

static void check_linear(const scene *s, uint64_t *seed)
{
    scene other = *s, both = *s;
    for (uint32_t i = 0; i < s->tip_count; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            other.g[i][axis] = scene_number(seed, 0.25);
            both.g[i][axis] = 2.0 * s->g[i][axis] - 3.0 * other.g[i][axis];
        }
    positions a = displacements(s), b = displacements(&other), c = displacements(&both);
    for (int i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            a.at[i][axis] = 2.0 * a.at[i][axis] - 3.0 * b.at[i][axis];
    expect_close(&a, &c, 1e-10 * s->largest_g);
}

static void the_field_is_linear_in_the_displacements(void **state)
{
    (void)state;
    for_scenes(check_linear, true, true, true, true);
}

/* ---- polynomials ---- */

static void check_uniform(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene same = *s;
    positions expected;
    for (uint32_t i = 0; i < s->tip_count; ++i)
        memcpy(same.g[i], s->g[0], sizeof same.g[i]);
    for (int i = 0; i < SCENE_POINTS; ++i)
        memcpy(expected.at[i], s->g[0], sizeof expected.at[i]);
    positions d = displacements(&same);
    expect_close(&d, &expected, 1e-11 * s->largest_g);
}

static void uniform_displacements_move_everything_alike(void **state)
{
    (void)state;
    for_scenes(check_uniform, false, true, true, false);
}

static void check_affine(const scene *s, uint64_t *seed)
{
    double m[3][4];
    scene affine = *s;
    positions expected;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 4; ++b)
            m[a][b] = scene_number(seed, 0.5);
    for (int a = 0; a < 3; ++a) {
        for (uint32_t i = 0; i < s->tip_count; ++i)
            affine.g[i][a] =
                m[a][0] * s->tip[i][0] + m[a][1] * s->tip[i][1] + m[a][2] * s->tip[i][2] + m[a][3];
        for (int i = 0; i < SCENE_POINTS; ++i)
            expected.at[i][a] = m[a][0] * s->point[i][0] + m[a][1] * s->point[i][1] +
                                m[a][2] * s->point[i][2] + m[a][3];
    }
    positions d = displacements(&affine);
    expect_close(&d, &expected, 1e-10);
}

static void affine_displacements_are_reproduced(void **state)
{
    (void)state;
    for_scenes(check_affine, false, false, true, false);
}

static void check_four(const scene *s, uint64_t *seed)
{
    (void)seed;
    scene four = *s;
    four.tip_count = 4;
    solve(&four);
    assert_int_equal(csrbf_diagnose(solver).polynomial_terms, 4);
    assert_true(csrbf_diagnose(solver).alpha_sum <= 1e-12);
}

static void four_controls_and_a_linear_polynomial_are_affine(void **state)
{
    (void)state;
    for_scenes(check_four, false, false, true, false);
}

/* P^T alpha = 0, and the field as the sum of unit responses, on the system itself. */
static void check_system(const scene *s, uint64_t *seed)
{
    (void)seed;
    error err = {""};
    saddle system;
    order_item scratch[3 * SCENE_TIPS];
    double rhs[SCENE_TIPS * ENVELOPE_FEW], alpha[SCENE_TIPS * ENVELOPE_MANY];
    double beta[4][ENVELOPE_MANY], sum = 0.0;
    assert_true(saddle_create(&system, SCENE_TIPS));
    if (saddle_factor(&system, &system, scratch, &s->settings, s->tip[0], NULL, s->tip_count,
                      &err) < 0 ||
        saddle_solve(&system, rhs, s->g[0], &err) < 0)
        fail_msg("%s", err.text);
    const field *f = &system.field;
    for (uint32_t i = 0; i < 3 * f->centre_count; ++i)
        sum += fabs(f->alpha[i]);
    for (uint32_t term = 0; term < f->term_count; ++term)
        for (int axis = 0; axis < 3; ++axis) {
            double side = 0.0;
            for (uint32_t i = 0; i < f->centre_count; ++i)
                side += system.basis[ENVELOPE_FEW * i + term] * f->alpha[3 * i + (uint32_t)axis];
            assert_true(fabs(side) <= 1e-13 * sum);
        }
    saddle_solve_units(&system, 0, alpha, beta);
    for (uint32_t i = 0; i < f->centre_count; ++i)
        for (uint32_t axis = 0; axis < 3; ++axis) {
            double value = 0.0;
            for (uint32_t k = 0; k < s->tip_count; ++k)
                value += alpha[ENVELOPE_MANY * i + system.merge.group[k]] * s->g[k][axis];
            assert_true(fabs(value - f->alpha[3 * i + axis]) <= 1e-11 * sum);
        }
    saddle_destroy(&system);
}

static void the_side_condition_holds_and_units_add_up(void **state)
{
    (void)state;
    for_scenes(check_system, true, true, true, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zero_displacements_are_the_identity),
        cmocka_unit_test(deform_outside_support_is_identity),
        cmocka_unit_test(order_of_controls_changes_no_bit),
        cmocka_unit_test(scaling_by_four_changes_no_bit),
        cmocka_unit_test(turning_round_and_doubling_are_exact),
        cmocka_unit_test(solve_reproduces_control_targets),
        cmocka_unit_test(a_centre_that_agrees_changes_nothing),
        cmocka_unit_test(a_centre_twice_is_that_centre),
        cmocka_unit_test(a_tip_out_of_reach_has_no_effect),
        cmocka_unit_test(turning_everything_turns_the_field),
        cmocka_unit_test(moving_everything_moves_the_field),
        cmocka_unit_test(a_mirrored_scene_gives_the_mirrored_field),
        cmocka_unit_test(unit_and_axes_do_not_matter),
        cmocka_unit_test(the_field_is_linear_in_the_displacements),
        cmocka_unit_test(uniform_displacements_move_everything_alike),
        cmocka_unit_test(affine_displacements_are_reproduced),
        cmocka_unit_test(four_controls_and_a_linear_polynomial_are_affine),
        cmocka_unit_test(the_side_condition_holds_and_units_add_up),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
