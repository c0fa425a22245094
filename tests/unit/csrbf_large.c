/* Five million vertices: an anchored frame, a live one and direct evaluation, against the
 * field in double at some of them. What too few and too far means to the engine: csrbf_lanes.c. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf/shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SIDE = 2240, VERTICES = SIDE * SIDE, CONTROLS = 3, EVERY = 4999, SKIPPED = 77 };
static const double start[CONTROLS][3] = {{-30.0, 0.0, 0.0}, {25.0, 20.0, 0.0}, {25.0, 26.0, 0.0}};
static const double pull[CONTROLS][3] = {{1.0, 0.0, 3.0}, {0.0, -1.0, 2.0}, {0.5, 0.5, -2.0}};

static bool is_short_of_memory(void)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return true; /* its shadow takes several times as much */
#else
    const uint64_t needed_bytes = (uint64_t)1 << 30;
    long pages = -1, size = sysconf(_SC_PAGESIZE);
#ifdef _SC_AVPHYS_PAGES
    pages = sysconf(_SC_AVPHYS_PAGES);
#endif
    return pages < 0 || (uint64_t)pages * (uint64_t)size < needed_bytes;
#endif
}

/* A sheet of 100 mm. */
static float *make_sheet(void)
{
    float *row = malloc((size_t)3 * VERTICES * sizeof *row);
    assert_non_null(row);
    for (size_t i = 0; i < VERTICES; ++i) {
        row[3 * i] = 100.0f * ((float)(i % SIDE) / SIDE - 0.5f);
        row[3 * i + 1] = 100.0f * ((float)(i / SIDE) / SIDE - 0.5f);
        row[3 * i + 2] = 0.0f;
    }
    return row;
}

/* Furthest that the shape shown is from the field in double. */
static double off_by(const shape *s)
{
    double furthest = 0.0;
    for (size_t slot = 0; slot < s->shown.count; slot += EVERY) {
        double expected[3], found[3];
        points_at(expected, &s->base, slot);
        points_at(found, &s->shown, slot);
        csrbf_move_f64(s->solver, expected, 1);
        for (int axis = 0; axis < 3; ++axis)
            furthest = fmax(furthest, fabs(expected[axis] - found[axis]));
    }
    return furthest;
}

static void a_very_large_mesh_is_performed(void **state)
{
    (void)state;
    const csrbf_settings settings = {.radius = 12.0};
    error err = {""};
    shape s;
    float *row = make_sheet();
    if (shape_create(&s, row, VERTICES, CONTROLS, &err) < 0 ||
        shape_engage(&s, &settings, start[0], CONTROLS, &err) < 0 ||
        shape_pull(&s, pull[0], &err) < 0 || csrbf_solve(s.solver, pull[0], &err) < 0)
        fail_msg("%s", err.text);
    assert_true(off_by(&s) < 3e-5); /* mm */

    assert_true(csrbf_move(s.solver, &s.shown, &s.base) > 1000);
    assert_true(off_by(&s) < 3e-5);
    shape_destroy(&s);
    free(row);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_very_large_mesh_is_performed)};
    if (is_short_of_memory()) {
        printf("SKIPPED: five million vertices want 1 GiB of free memory, and no sanitizer\n");
        return SKIPPED;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
