/* Anchored frames: the sum that they are, and what is not even read. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/isa.h"
#include "csrbf/columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VERTICES = 1400, BLOCKS = (VERTICES + POINTS_BLOCK - 1) / POINTS_BLOCK, MANY = 205 };

static float vertex[VERTICES][3];

typedef struct stand {
    points_order order;
    points base, out, expected;
    columns columns;
    double weight[MANY][3];
} stand;

static uint32_t next(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static float part(uint32_t *seed)
{
    return (float)next(seed) * 0x1p-24f;
}

static int fill(void **state)
{
    (void)state;
    uint32_t seed = 3;
    for (int i = 0; i < VERTICES; ++i)
        for (int axis = 0; axis < 3; ++axis)
            vertex[i][axis] = 100.0f * part(&seed) - 50.0f;
    return 0;
}

/* Each column has values in some blocks: one of five, by chance; column 7 in none. */
static void raise_stand(stand *s, uint32_t count)
{
    error err = {""};
    uint32_t seed = count;
    if (points_order_create(&s->order, vertex[0], VERTICES, &err) < 0 ||
        points_create(&s->base, &s->order, vertex[0], &err) < 0 ||
        points_create(&s->out, &s->order, vertex[0], &err) < 0 ||
        points_create(&s->expected, &s->order, vertex[0], &err) < 0 ||
        columns_create(&s->columns, &s->base, count, &err) < 0)
        fail_msg("%s", err.text);
    for (uint32_t k = 0; k < count; ++k) {
        float *row = columns_row(&s->columns, k);
        for (uint32_t block = 0; block < BLOCKS; ++block) {
            bool is_there = k != 7 && next(&seed) % 5 == 0;
            for (int i = 0; i < POINTS_BLOCK; ++i)
                row[block * POINTS_BLOCK + (uint32_t)i] =
                    is_there && next(&seed) % 3 ? part(&seed) - 0.3f : 0.0f;
        }
    }
    columns_note(&s->columns, count);
}

static void strike_stand(stand *s)
{
    points_order_destroy(&s->order);
    points_destroy(&s->base);
    points_destroy(&s->out);
    points_destroy(&s->expected);
    columns_destroy(&s->columns);
}

/* `live` of the columns weigh something. */
static void draw_weights(stand *s, uint32_t live, uint32_t *seed)
{
    memset(s->weight, 0, sizeof s->weight);
    for (uint32_t i = 0; i < live; ++i) {
        double *g = s->weight[next(seed) % s->columns.count];
        g[next(seed) % 3] = 4.0 * (double)part(seed) - 2.0;
        g[2] = (double)part(seed);
    }
}

/* As it is written down: columns ascending, one vertex after the other. */
static void sum_plainly(points *out, const stand *s)
{
    const float *const from[3] = {s->base.x, s->base.y, s->base.z};
    float *const to[3] = {out->x, out->y, out->z};
    for (uint32_t v = 0; v < s->base.padded_count; ++v)
        for (int axis = 0; axis < 3; ++axis) {
            float sum = 0.0f;
            for (uint32_t k = 0; k < s->columns.count; ++k) {
                volatile float product = columns_row(&s->columns, k)[v] * (float)s->weight[k][axis];
                sum += product;
            }
            to[axis][v] = sum == 0.0f ? from[axis][v] : from[axis][v] + sum;
        }
    points_update_bounds(out);
}

static void expect_same_bits(const points *a, const points *b)
{
    size_t size = a->padded_count * sizeof(float);
    assert_memory_equal(a->x, b->x, size);
    assert_memory_equal(a->y, b->y, size);
    assert_memory_equal(a->z, b->z, size);
    assert_memory_equal(a->block, b->block, a->block_count * sizeof *a->block);
}

/* From none to all of them, and back, in an order of their own. */
static const uint32_t live_counts[] = {3, 0, 1, MANY, 2, 2, 40, 0, 0, 1, 9, 10 * MANY, 5};
enum { FRAMES = sizeof live_counts / sizeof *live_counts };

static void use(isa which)
{
    setenv("MAROTTE_ISA", isa_name(which), 1);
}

static void frames_are_the_plain_sum_on_every_instruction_set(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 10, 64, 65, MANY};
    for (int which = 0; which < ISA_COUNT; ++which)
        for (size_t c = 0; c < sizeof counts / sizeof *counts; ++c) {
            stand s;
            uint32_t seed = 11;
            if (!isa_is_here((isa)which))
                continue;
            use((isa)which);
            raise_stand(&s, counts[c]);
            for (int frame = 0; frame < FRAMES; ++frame) {
                draw_weights(&s, live_counts[frame], &seed);
                sum_plainly(&s.expected, &s);
                columns_move(&s.columns, &s.out, &s.base, s.weight[0]);
                expect_same_bits(&s.out, &s.expected);
            }
            strike_stand(&s);
        }
}

/* Around the caches: too large a mesh for a test is not needed. */
static void frames_that_are_far_have_the_same_bits(void **state)
{
    (void)state;
    for (int which = 0; which < ISA_COUNT; ++which) {
        stand s;
        uint32_t seed = 13;
        if (!isa_is_here((isa)which))
            continue;
        use((isa)which);
        raise_stand(&s, 24);
        s.columns.far_from_bytes = 0;
        for (int frame = 0; frame < FRAMES; ++frame) {
            draw_weights(&s, live_counts[frame], &seed);
            sum_plainly(&s.expected, &s);
            columns_move(&s.columns, &s.out, &s.base, s.weight[0]);
            expect_same_bits(&s.out, &s.expected);
        }
        strike_stand(&s);
    }
}

static void what_a_frame_moves_is_known_in_bytes(void **state)
{
    (void)state;
    stand s;
    uint32_t filled = 0;
    raise_stand(&s, 10);
    memset(s.weight, 0, sizeof s.weight);
    columns_weigh(&s.columns, s.weight[0], 10);
    assert_int_equal(s.columns.weights.bytes, (size_t)6 * sizeof(float) * s.base.padded_count);
    s.weight[4][1] = 1.0;
    columns_weigh(&s.columns, s.weight[0], 10);
    for (uint32_t block = 0; block < BLOCKS; ++block) {
        uint32_t others = 0;
        for (uint32_t i = 0; i < POINTS_BLOCK; ++i)
            others += columns_row(&s.columns, 4)[block * POINTS_BLOCK + i] != 0.0f;
        filled += others > 0;
    }
    assert_true(filled > 0);
    assert_int_equal(s.columns.weights.bytes, ((size_t)6 * BLOCKS + filled) * POINTS_BLOCK * 4);
    strike_stand(&s);
}

/* Not even read: what is in them cannot be seen in the result. */
static void columns_without_weight_are_left_out(void **state)
{
    (void)state;
    stand s;
    uint32_t seed = 4;
    raise_stand(&s, MANY);
    draw_weights(&s, 6, &seed);
    sum_plainly(&s.expected, &s);
    for (uint32_t k = 0; k < MANY; ++k) {
        float *row = columns_row(&s.columns, k);
        const double *g = s.weight[k];
        bool weighs = g[0] != 0.0 || g[1] != 0.0 || g[2] != 0.0;
        for (uint32_t v = 0; !weighs && v < s.base.padded_count; ++v)
            row[v] = (float)NAN;
    }
    columns_move(&s.columns, &s.out, &s.base, s.weight[0]);
    expect_same_bits(&s.out, &s.expected);
    strike_stand(&s);
}

static void parts_are_the_whole(void **state)
{
    (void)state;
    stand s;
    uint32_t seed = 8;
    raise_stand(&s, MANY);
    for (int frame = 0; frame < FRAMES; ++frame) {
        draw_weights(&s, live_counts[frame], &seed);
        columns_move(&s.columns, &s.expected, &s.base, s.weight[0]);
        columns_weigh(&s.columns, s.weight[0], MANY);
        for (uint32_t first = 0; first < BLOCKS; first += 5)
            columns_move_blocks(&s.columns, &s.out, &s.base, first,
                                first + 5 < BLOCKS ? first + 5 : BLOCKS);
        expect_same_bits(&s.out, &s.expected);
    }
    strike_stand(&s);
}

static void columns_beyond_the_weights_given_weigh_nothing(void **state)
{
    (void)state;
    stand s;
    uint32_t seed = 2;
    raise_stand(&s, MANY);
    draw_weights(&s, 10 * MANY, &seed);
    columns_weigh(&s.columns, s.weight[0], MANY);
    columns_weigh(&s.columns, s.weight[0], 70);
    columns_move_blocks(&s.columns, &s.out, &s.base, 0, BLOCKS);
    memset(s.weight[70], 0, sizeof s.weight - 70 * sizeof *s.weight);
    sum_plainly(&s.expected, &s);
    expect_same_bits(&s.out, &s.expected);
    strike_stand(&s);
}

static void no_columns_are_the_base(void **state)
{
    (void)state;
    stand s;
    raise_stand(&s, 3);
    columns_note(&s.columns, 0);
    columns_move(&s.columns, &s.out, &s.base, NULL);
    expect_same_bits(&s.out, &s.base);
    strike_stand(&s);
}

static void one_vertex_and_room_for_none_are_columns_too(void **state)
{
    (void)state;
    static const float alone[3] = {1.0f, 2.0f, 3.0f};
    error err = {""};
    points_order order;
    points base, out;
    columns c;
    const double weight[3] = {0.5, 0.0, -1.0};
    for (uint32_t capacity = 0; capacity < 2; ++capacity) {
        assert_int_equal(points_order_create(&order, alone, 1, &err), MRT_OK);
        assert_int_equal(points_create(&base, &order, alone, &err), MRT_OK);
        assert_int_equal(points_create(&out, &order, alone, &err), MRT_OK);
        assert_int_equal(columns_create(&c, &base, capacity, &err), MRT_OK);
        for (uint32_t i = 0; i < capacity * POINTS_BLOCK; ++i)
            columns_row(&c, 0)[i] = 2.0f;
        columns_note(&c, capacity);
        columns_move(&c, &out, &base, weight);
        assert_true(out.x[0] == 1.0f + 1.0f * (float)capacity && out.y[0] == 2.0f);
        assert_true(out.z[0] == 3.0f - 2.0f * (float)capacity);
        columns_destroy(&c);
        points_destroy(&out);
        points_destroy(&base);
        points_order_destroy(&order);
    }
}

static void more_columns_than_there_can_be_are_refused(void **state)
{
    (void)state;
    error err = {""};
    stand s;
    columns c;
    raise_stand(&s, 1);
    assert_int_equal(columns_create(&c, &s.base, COLUMNS_CAPACITY + 1, &err), MRT_ERR_MEMORY);
    assert_string_equal(err.text, "no memory for 65536 columns of 1400 vertices");
    assert_null(c.value);
    strike_stand(&s);
}

static int restore(void **state)
{
    (void)state;
    unsetenv("MAROTTE_ISA");
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(frames_are_the_plain_sum_on_every_instruction_set, restore),
        cmocka_unit_test_teardown(frames_that_are_far_have_the_same_bits, restore),
        cmocka_unit_test(what_a_frame_moves_is_known_in_bytes),
        cmocka_unit_test(columns_without_weight_are_left_out),
        cmocka_unit_test(parts_are_the_whole),
        cmocka_unit_test(columns_beyond_the_weights_given_weigh_nothing),
        cmocka_unit_test(no_columns_are_the_base),
        cmocka_unit_test(one_vertex_and_room_for_none_are_columns_too),
        cmocka_unit_test(more_columns_than_there_can_be_are_refused),
    };
    return cmocka_run_group_tests(tests, fill, NULL);
}
