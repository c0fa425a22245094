/* The float32 paths over the random scenes: against the field in double, and the meters. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "property/csrbf_check.h"

typedef struct floats {
    points_order order;
    points in, out;
    float row[SCENE_POINTS][3];
} floats;

static void floats_create(floats *f, const scene *s)
{
    error err = {""};
    for (int i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            f->row[i][axis] = (float)s->point[i][axis];
    if (points_order_create(&f->order, f->row[0], SCENE_POINTS, &err) < 0 ||
        points_create(&f->in, &f->order, f->row[0], &err) < 0 ||
        points_create(&f->out, &f->order, f->row[0], &err) < 0)
        fail_msg("%s", err.text);
}

static void floats_destroy(floats *f)
{
    points_destroy(&f->in);
    points_destroy(&f->out);
    points_order_destroy(&f->order);
}

static double float_limit(const scene *s)
{
    return 1e-5 * (csrbf_diagnose(solver).alpha_sum + s->largest_g) + 4.0 * 0x1p-24 * 3.0;
}

static void check_float(const scene *s, uint64_t *seed)
{
    (void)seed;
    floats f;
    floats_create(&f, s);
    positions d = displacements(s);
    (void)csrbf_move(solver, &f.out, &f.in);
    points_to_rows(f.row[0], &f.out, &f.order);
    double limit = float_limit(s);
    for (int i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            double expected = s->point[i][axis] + d.at[i][axis];
            assert_true(fabs((double)f.row[i][axis] - expected) <= limit);
            if (d.at[i][axis] == 0.0)
                assert_true((double)f.row[i][axis] == s->point[i][axis]);
        }
    floats_destroy(&f);
}

static void float_evaluation_is_close_to_double(void **state)
{
    (void)state;
    for_scenes(check_float, true, true, true, true);
}

static void check_responses(const scene *s, uint64_t *seed)
{
    (void)seed;
    static float response[SCENE_TIPS][2 * POINTS_BLOCK];
    floats f;
    floats_create(&f, s);
    positions d = displacements(s);
    csrbf_responses(solver, response[0], 2 * POINTS_BLOCK, &f.in);
    double limit = float_limit(s);
    for (uint32_t slot = 0; slot < SCENE_POINTS; ++slot) {
        uint32_t point = f.order.file_of_slot[slot];
        double ones = 0.0, place[3] = {0.0};
        for (int axis = 0; axis < 3; ++axis) {
            double moved = 0.0;
            for (uint32_t k = 0; k < s->tip_count; ++k) {
                moved += (double)response[k][slot] * s->g[k][axis];
                place[axis] += (double)response[k][slot] * s->tip[k][axis];
            }
            assert_true(fabs(moved - d.at[point][axis]) <= limit);
        }
        for (uint32_t k = 0; k < s->tip_count; ++k)
            ones += (double)response[k][slot];
        csrbf_polynomial polynomial = s->settings.polynomial;
        if (polynomial == CSRBF_CONSTANT || polynomial == CSRBF_LINEAR)
            assert_true(fabs(ones - 1.0) <= 1e-5);
        for (int axis = 0; axis < 3 && polynomial == CSRBF_LINEAR; ++axis)
            assert_true(fabs(place[axis] - s->point[point][axis]) <= 2e-5);
    }
    floats_destroy(&f);
}

static void unit_responses_add_up_to_the_field(void **state)
{
    (void)state;
    for_scenes(check_responses, true, true, true, true);
}

/* The slope over space is never above the bound, nor the determinant below (1 - slope)^3. */
static void check_meters(const scene *s, uint64_t *seed)
{
    (void)seed;
    floats f;
    floats_create(&f, s);
    solve(s);
    double slope = csrbf_max_slope(solver, &f.in);
    double bound = csrbf_diagnose(solver).slope_bound;
    double determinant = csrbf_min_determinant(solver, &f.in);
    assert_true(slope > 0.0 && slope <= bound * (1.0 + 1e-5));
    if (slope < 1.0 && s->settings.kernel != CSRBF_WENDLAND_C0)
        assert_true(determinant >= (1.0 - slope) * (1.0 - slope) * (1.0 - slope) - 1e-5);
    floats_destroy(&f);
}

static void the_slope_bound_holds_at_every_point(void **state)
{
    (void)state;
    for_scenes(check_meters, true, true, true, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(float_evaluation_is_close_to_double),
        cmocka_unit_test(unit_responses_add_up_to_the_field),
        cmocka_unit_test(the_slope_bound_holds_at_every_point),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
