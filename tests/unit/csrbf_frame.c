/* The functions of the engine that run in a frame allocate nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/pool.h"
#include "csrbf/shape.h"
#include "unit/allocation_count.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 40, VERTICES = SIDE * SIDE, TIPS = 5 };

static const double tip[TIPS][3] = {
    {-1, -1, 0}, {1, -1, 0.25}, {1, 1, -0.25}, {-1, 1, 0}, {0, 0, 0.5}};
static const double pull[TIPS][3] = {
    {0.25, 0, 0}, {0, 0.25, 0}, {0, 0, 0.5}, {-0.25, 0, 0.125}, {0.125, 0.25, 0}};

static void frames_allocate_nothing(void **state)
{
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED) {
        print_message("SKIPPED: the sanitizer has an allocator of its own\n");
        skip();
    }
    static float row[VERTICES][3];
    error err = {""};
    shape s;
    double to[TIPS][3], reached[TIPS][3];
    for (int i = 0; i < VERTICES; ++i) {
        row[i][0] = (float)(4.0 * (i % SIDE) / SIDE - 2.0);
        row[i][1] = (float)(4.0 * (i / SIDE) / SIDE - 2.0);
    }
    for (int i = 0; i < TIPS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            to[i][axis] = tip[i][axis] + pull[i][axis];
    setenv("MAROTTE_THREADS", "3", 1);
    pool_share_from(0.0);
    const uint64_t shared_before = pool_state_now().shared_count;
    allocation_count = 0;
    assert_int_equal(shape_create(&s, row[0], VERTICES, TIPS, &err), MRT_OK);
    assert_true(allocation_count > 10); /* the counting works */
    for (int kernel = CSRBF_WENDLAND_C2; kernel <= CSRBF_WENDLAND_C6; ++kernel)
        for (int polynomial = CSRBF_NONE; polynomial <= CSRBF_WINDOWED; ++polynomial) {
            csrbf_settings settings = {.kernel = (csrbf_kernel)kernel,
                                       .polynomial = (csrbf_polynomial)polynomial,
                                       .radius = 1.5};
            shape_step step;
            mrt_result results[4];
            allocation_count = 0;
            results[0] = shape_engage(&s, &settings, tip[0], TIPS, &err);
            results[1] = shape_pull(&s, pull[0], &err);
            double bound = shape_slope_bound(&s, pull[0]);
            double determinant = shape_min_determinant(&s, pull[0]);
            shape_commit(&s);
            results[2] = shape_drag(&s, &settings, tip[0], to[0], TIPS, reached[0], &step, &err);
            shape_leak(&s, 1.0, 0.01);
            bool near = shape_is_near(&s.shown, tip[0], TIPS, 1.5);
            to[0][0] = (double)NAN;
            results[3] = shape_drag(&s, &settings, tip[0], to[0], TIPS, NULL, &step, &err);
            to[0][0] = tip[0][0] + pull[0][0];
            shape_reset(&s);
            size_t counted = allocation_count;
            assert_int_equal(counted, 0);
            assert_true(results[0] == MRT_OK && results[1] == MRT_OK && results[2] == MRT_OK);
            assert_true(results[3] == MRT_ERR_ARGUMENT);
            assert_true(bound > 0.0 && determinant < 1.0 && near);
        }
    assert_true(pool_state_now().shared_count > shared_before); /* threads took part */
    shape_destroy(&s);
    pool_share_from(POOL_WORTH_NS);
    unsetenv("MAROTTE_THREADS");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames_allocate_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
