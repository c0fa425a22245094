/* Packed columns: how far they are from the columns, and what is left alone. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/isa.h"
#include "csrbf/columns_packed.h"
#include "csrbf/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VERTICES = 1000, CONTROLS = 11 };

static float vertex[VERTICES][3];
static double start[CONTROLS][3], pull[CONTROLS][3];

typedef struct stand {
    shape shape;
    columns_packed packed;
    points shown;
} stand;

static int fill(void **state)
{
    (void)state;
    uint32_t seed = 1;
    for (int i = 0; i < VERTICES; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            seed = seed * 1664525u + 1013904223u;
            vertex[i][axis] = (float)(seed >> 16) * 100.0f / 65536.0f;
        }
    for (int k = 0; k < CONTROLS; ++k)
        for (int axis = 0; axis < 3; ++axis) {
            start[k][axis] = (double)vertex[80 * k][axis];
            pull[k][axis] = 1.0 + 0.5 * k - axis;
        }
    return 0;
}

static void raise_stand(stand *s, double radius)
{
    error err = {""};
    const csrbf_settings settings = {.radius = radius};
    if (shape_create(&s->shape, vertex[0], VERTICES, CONTROLS, &err) < 0 ||
        points_create(&s->shown, &s->shape.order, vertex[0], &err) < 0 ||
        columns_packed_create(&s->packed, &s->shape.response, &err) < 0 ||
        shape_engage(&s->shape, &settings, start[0], CONTROLS, &err) < 0)
        fail_msg("%s", err.text);
    columns_packed_take(&s->packed, &s->shape.response);
}

static void strike_stand(stand *s)
{
    columns_packed_destroy(&s->packed);
    points_destroy(&s->shown);
    shape_destroy(&s->shape);
}

static double largest_of(const columns *c, uint32_t column)
{
    double largest = 0.0;
    for (size_t i = 0; i < (size_t)c->block_count * POINTS_BLOCK; ++i)
        largest = fmax(largest, fabs((double)columns_row(c, column)[i]));
    return largest;
}

static void packed_frames_are_half_a_step_of_each_column_off(void **state)
{
    (void)state;
    stand s;
    raise_stand(&s, 60.0);
    const columns *c = &s.shape.response;
    columns_move(&s.shape.response, &s.shape.shown, &s.shape.base, pull[0]);
    columns_packed_move(&s.packed, c, &s.shown, &s.shape.base, pull[0]);
    for (int axis = 0; axis < 3; ++axis) {
        const float *const exact[] = {s.shape.shown.x, s.shape.shown.y, s.shape.shown.z};
        const float *const packed[] = {s.shown.x, s.shown.y, s.shown.z};
        double limit = 1e-4, worst = 0.0; /* mm: rounding of float at 100 mm */
        for (uint32_t k = 0; k < CONTROLS; ++k)
            limit += largest_of(c, k) * fabs(pull[k][axis]) / 65534.0;
        for (uint32_t i = 0; i < s.shown.padded_count; ++i)
            worst = fmax(worst, fabs((double)exact[axis][i] - (double)packed[axis][i]));
        assert_true(worst <= limit);
        assert_true(worst > 0.0); /* they are two ways, not one */
    }
    strike_stand(&s);
}

static void what_no_column_moves_keeps_its_bits(void **state)
{
    (void)state;
    stand s;
    raise_stand(&s, 12.0);
    columns_packed_move(&s.packed, &s.shape.response, &s.shown, &s.shape.base, pull[0]);
    uint32_t still = 0;
    for (uint32_t i = 0; i < s.shown.padded_count; ++i) {
        bool reached = false;
        for (uint32_t k = 0; k < CONTROLS; ++k)
            reached = reached || columns_row(&s.shape.response, k)[i] != 0.0f;
        if (reached)
            continue;
        assert_memory_equal(&s.shown.x[i], &s.shape.base.x[i], sizeof(float));
        assert_memory_equal(&s.shown.z[i], &s.shape.base.z[i], sizeof(float));
        ++still;
    }
    assert_true(still > 100);
    strike_stand(&s);
}

static void every_instruction_set_gives_the_same_bits(void **state)
{
    (void)state;
    static float expected[VERTICES][3], found[VERTICES][3];
    for (int i = 0; i < ISA_COUNT; ++i) {
        stand s;
        if (!isa_is_here((isa)i))
            continue;
        setenv("MAROTTE_ISA", isa_name((isa)i), 1);
        raise_stand(&s, 60.0);
        columns_packed_move(&s.packed, &s.shape.response, &s.shown, &s.shape.base, pull[0]);
        points_to_rows(found[0], &s.shown, &s.shape.order);
        if (i == ISA_GENERIC)
            memcpy(expected, found, sizeof found);
        assert_memory_equal(expected, found, sizeof found);
        strike_stand(&s);
    }
    unsetenv("MAROTTE_ISA");
}

static void no_columns_are_the_base(void **state)
{
    (void)state;
    stand s;
    raise_stand(&s, 60.0);
    columns_note(&s.shape.response, 0);
    columns_packed_take(&s.packed, &s.shape.response);
    columns_packed_move(&s.packed, &s.shape.response, &s.shown, &s.shape.base, NULL);
    assert_memory_equal(s.shown.x, s.shape.base.x, s.shown.padded_count * sizeof(float));
    strike_stand(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packed_frames_are_half_a_step_of_each_column_off),
        cmocka_unit_test(what_no_column_moves_keeps_its_bits),
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(no_columns_are_the_base),
    };
    return cmocka_run_group_tests(tests, fill, NULL);
}
