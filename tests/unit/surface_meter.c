/* The surface's judge: what a person would see of a sheet that is stretched, bent, turned over. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh/surface_meter.h"

#include <math.h>
#include <string.h>

enum { SIDE = 11, VERTICES = SIDE * SIDE, TRIANGLES = 2 * (SIDE - 1) * (SIDE - 1) };

/* A sheet of squares of 1 mm in the plane z = 0, each of two triangles. */
typedef struct sheet {
    float x[VERTICES], y[VERTICES], z[VERTICES];
    uint32_t triangle[TRIANGLES * 3];
    surface_meter *surface;
} sheet;

static uint32_t at(uint32_t column, uint32_t row)
{
    return row * SIDE + column;
}

static void sheet_create(sheet *s)
{
    uint32_t *t = s->triangle;
    for (uint32_t i = 0; i < VERTICES; ++i) {
        s->x[i] = (float)(i % SIDE);
        s->y[i] = (float)(i / SIDE);
        s->z[i] = 0.0f;
    }
    for (uint32_t row = 0; row + 1 < SIDE; ++row)
        for (uint32_t column = 0; column + 1 < SIDE; ++column) {
            const uint32_t corner[6] = {at(column, row),         at(column + 1, row),
                                        at(column + 1, row + 1), at(column, row),
                                        at(column + 1, row + 1), at(column, row + 1)};
            memcpy(t, corner, sizeof corner);
            t += 6;
        }
    const float *const rest[3] = {s->x, s->y, s->z};
    assert_true(surface_meter_create(&s->surface, rest, VERTICES, s->triangle, TRIANGLES, NULL) >=
                0);
}

static surface_state judged(const sheet *s)
{
    const float *const now[3] = {s->x, s->y, s->z};
    surface_state out;
    surface_meter_measure(s->surface, &out, now);
    return out;
}

static void a_sheet_at_rest_or_moved_as_a_whole_is_as_it_was(void **state)
{
    (void)state;
    static sheet s;
    sheet_create(&s);
    surface_state now = judged(&s);
    assert_true(fabs(now.stretch - 1.0) < 1e-6 && now.bend_deg < 0.1);
    assert_int_equal(now.bent_count + now.inside_out_count, 0);
    for (uint32_t i = 0; i < VERTICES; ++i) { /* turned over as a whole: nothing of it is hurt */
        s.z[i] = 40.0f;
        s.x[i] = -s.x[i];
    }
    for (uint32_t i = 0; i < VERTICES; ++i)
        s.y[i] = s.y[i] + 7.0f;
    now = judged(&s);
    assert_true(fabs(now.stretch - 1.0) < 1e-6 && now.bend_deg < 0.1);
    assert_int_equal(now.bent_count + now.inside_out_count, 0);
    surface_meter_destroy(s.surface);
}

static void a_sheet_pulled_to_three_times_its_length_is_stretched_three_times(void **state)
{
    (void)state;
    static sheet s;
    sheet_create(&s);
    for (uint32_t i = 0; i < VERTICES; ++i)
        s.x[i] *= 3.0f;
    assert_true(fabs(judged(&s).stretch - 3.0) < 1e-5);
    surface_meter_destroy(s.surface);
}

/* Along its middle row, by 150 degrees. */
static void a_sheet_bent_along_a_row_is_bent_at_that_row(void **state)
{
    (void)state;
    static sheet s;
    sheet_create(&s);
    const double angle = 150.0 / 180.0 * 3.14159265358979;
    for (uint32_t i = 0; i < VERTICES; ++i) {
        float beyond = s.y[i] - 5.0f;
        if (!(beyond > 0.0f))
            continue;
        s.y[i] = 5.0f + beyond * (float)cos(angle);
        s.z[i] = beyond * (float)sin(angle);
    }
    surface_state now = judged(&s);
    assert_true(fabs(now.bend_deg - 150.0) < 0.1);
    assert_int_equal(now.bent_count, SIDE - 1);
    assert_int_equal(now.inside_out_count, 0);
    surface_meter_destroy(s.surface);
}

/* One vertex beyond the far side of its ring: what is around it is turned over. */
static void a_vertex_pushed_through_its_ring_turns_triangles_inside_out(void **state)
{
    (void)state;
    static sheet s;
    sheet_create(&s);
    s.x[at(5, 5)] += 2.5f;
    surface_state now = judged(&s);
    assert_true(now.inside_out_count > 0 && now.bent_count > 0);
    assert_true(now.bend_deg > 170.0);
    surface_meter_destroy(s.surface);
}

/* A crease that the mesh has at rest is none that a performance made. */
static void what_is_bent_at_rest_does_not_count(void **state)
{
    (void)state;
    static sheet s;
    sheet_create(&s);
    surface_meter_destroy(s.surface);
    for (uint32_t i = 0; i < VERTICES; ++i) {
        s.z[i] = s.y[i] > 5.0f ? s.y[i] - 5.0f : 0.0f;
        s.y[i] = s.y[i] > 5.0f ? 5.0f - 0.2f * (s.y[i] - 5.0f) : s.y[i];
    }
    const float *const rest[3] = {s.x, s.y, s.z};
    assert_true(surface_meter_create(&s.surface, rest, VERTICES, s.triangle, TRIANGLES, NULL) >= 0);
    surface_state now = judged(&s);
    assert_true(now.bend_deg < 0.1);
    assert_int_equal(now.bent_count + now.inside_out_count, 0);
    surface_meter_destroy(s.surface);
}

/* A shape draws the sheet to three times its length and folds it along a row by 150 degrees. */
static void what_a_shape_makes_counts_as_what_is_at_rest(void **state)
{
    (void)state;
    static sheet s, rest;
    const double turn = 150.0 * 3.14159265358979323846 / 180.0;
    sheet_create(&s);
    sheet_create(&rest);
    for (uint32_t i = 0; i < VERTICES; ++i) {
        double beyond = fmax((double)s.y[i] - 5.0, 0.0);
        s.x[i] *= 3.0f;
        s.y[i] = (float)(fmin((double)s.y[i], 5.0) + beyond * cos(turn));
        s.z[i] = (float)(beyond * sin(turn));
    }
    surface_state now = judged(&s);
    assert_true(now.bent_count > 0 && now.stretch > 2.9 && now.bend_deg > 149.0);
    const float *const made[3] = {s.x, s.y, s.z};
    assert_true(surface_meter_learn(s.surface, made, NULL) >= 0);
    now = judged(&s);
    assert_true(now.stretch < 1.0001 && now.bend_deg < 0.1);
    assert_int_equal(now.bent_count + now.inside_out_count, 0);
    for (uint32_t i = 0; i < VERTICES; ++i)
        s.x[i] *= 2.0f;
    now = judged(&s);
    assert_true(now.stretch > 1.9 && now.stretch < 2.0001);
    memcpy(s.x, rest.x, sizeof s.x);
    memcpy(s.y, rest.y, sizeof s.y);
    memcpy(s.z, rest.z, sizeof s.z);
    now = judged(&s);
    assert_true(now.stretch < 1.0001 && now.bend_deg < 0.1);
    surface_meter_destroy(s.surface);
    surface_meter_destroy(rest.surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sheet_at_rest_or_moved_as_a_whole_is_as_it_was),
        cmocka_unit_test(a_sheet_pulled_to_three_times_its_length_is_stretched_three_times),
        cmocka_unit_test(a_sheet_bent_along_a_row_is_bent_at_that_row),
        cmocka_unit_test(a_vertex_pushed_through_its_ring_turns_triangles_inside_out),
        cmocka_unit_test(what_is_bent_at_rest_does_not_count),
        cmocka_unit_test(what_a_shape_makes_counts_as_what_is_at_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
