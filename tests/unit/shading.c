/* Normals of a surface that moves by blocks: against those of all triangles, bit for bit, and
 * against exact ones. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf/csrbf.h"
#include "mesh/normals.h"
#include "mesh/shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 4096 };

typedef struct sheet { /* vertices in blocks, triangles, and all that is asked of them */
    uint32_t vertex_count, triangle_count, block_count;
    float at[3][MOST], whole[3][MOST];
    uint32_t triangle[4 * MOST][3];
    uint8_t carrier[MOST / SHADING_BLOCK];
    rigid pose[1];
    stamps written;
    shading *shading;
} sheet;

static sheet s;

static double number(uint64_t *seed)
{
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u); /* SplitMix64 (Steele, Lea, Flood 2014) */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void begin(uint32_t vertex_count, uint32_t triangle_count)
{
    memset(&s, 0, sizeof s);
    s.vertex_count = vertex_count;
    s.triangle_count = triangle_count;
    s.block_count = (vertex_count + SHADING_BLOCK - 1) / SHADING_BLOCK;
    s.pose[0] = rigid_identity();
    memset(s.carrier, SHADING_LOOSE, sizeof s.carrier);
}

static void create(void)
{
    error err = {""};
    const float *const rest[3] = {s.at[0], s.at[1], s.at[2]};
    if (shading_create(&s.shading, rest, s.vertex_count, s.triangle[0], s.triangle_count, NULL,
                       &err) < 0 ||
        stamps_create(&s.written, s.block_count, &err) < 0)
        fail_msg("%s", err.text);
}

static void end(void)
{
    shading_destroy(s.shading);
    stamps_destroy(&s.written);
}

static void update(void)
{
    const shading_shape now = {.at = {s.at[0], s.at[1], s.at[2]},
                               .written = &s.written,
                               .carrier = s.carrier,
                               .pose = s.pose};
    shading_update(s.shading, &now);
}

static void shade_whole(void)
{
    normals_smooth(s.whole[0], s.whole[1], s.whole[2], s.at[0], s.at[1], s.at[2], s.vertex_count,
                   s.triangle[0], s.triangle_count);
}

static void expect_bits(void)
{
    shade_whole();
    for (uint32_t axis = 0; axis < 3; ++axis)
        assert_memory_equal(shading_normal(s.shading, axis), s.whole[axis],
                            s.vertex_count * sizeof(float));
}

/* Triangles that know no order, some without area, some vertices without triangles. */
static void tangle(uint64_t *seed)
{
    uint32_t hub = (uint32_t)(number(seed) * s.vertex_count);
    for (uint32_t v = 0; v < s.vertex_count; ++v)
        for (int axis = 0; axis < 3; ++axis)
            s.at[axis][v] = (float)(100.0 * number(seed) - 50.0);
    for (uint32_t t = 0; t < s.triangle_count; ++t)
        for (int k = 0; k < 3; ++k) {
            double far = 0.7 * s.vertex_count * number(seed);
            double near = (double)t / s.triangle_count * s.vertex_count * 0.7 + 20.0 * number(seed);
            double choice = number(seed);
            uint32_t v = (uint32_t)(choice < 0.1 ? far : near);
            s.triangle[t][k] = choice > 0.95 ? hub : v % s.vertex_count;
        }
}

static void move_some_blocks(uint64_t *seed)
{
    stamps_begin(&s.written);
    for (uint32_t block = 0; block < s.block_count; ++block) {
        if (number(seed) < 0.7)
            continue;
        stamps_mark(&s.written, block);
        for (uint32_t v = block * SHADING_BLOCK;
             v < (block + 1) * SHADING_BLOCK && v < s.vertex_count; ++v)
            for (int axis = 0; axis < 3; ++axis)
                s.at[axis][v] += (float)(4.0 * number(seed) - 2.0);
    }
}

static void bits_are_those_of_all_triangles(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 63, 64, 65, 128, 700, 4000};
    uint64_t seed = 5;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; ++i) {
        begin(counts[i], 2 * counts[i]);
        tangle(&seed);
        create();
        update();
        expect_bits();
        for (int frame = 0; frame < 20; ++frame) {
            move_some_blocks(&seed);
            update();
            expect_bits();
        }
        end();
    }
}

static void a_surface_without_triangles_looks_along_z(void **state)
{
    (void)state;
    begin(70, 0);
    create();
    update();
    expect_bits();
    assert_true(shading_normal(s.shading, 2)[69] == 1.0f);
    end();
}

static void a_hub_of_thousands_of_triangles_is_shaded(void **state)
{
    (void)state;
    begin(MOST, MOST - 2);
    uint64_t seed = 9;
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        double turn = 6.283 * v / s.vertex_count;
        s.at[0][v] = (float)cos(turn);
        s.at[1][v] = (float)sin(turn);
        s.at[2][v] = (float)number(&seed);
    }
    for (uint32_t t = 0; t < s.triangle_count; ++t) {
        const uint32_t corner[3] = {77, t, t + 1};
        memcpy(s.triangle[t], corner, sizeof corner);
    }
    create();
    update();
    expect_bits();
    move_some_blocks(&seed);
    update();
    expect_bits();
    end();
}

/* ---- a bowl of 100 mm ---- */

enum { SIDE = 61, CONTROLS = 5 };

static double height(double x, double y)
{
    return (x * x + y * y) / 200.0;
}

static void make_bowl(void)
{
    begin(SIDE * SIDE, 2 * (SIDE - 1) * (SIDE - 1));
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        double x = 1.6 * (v % SIDE) - 48.0, y = 1.6 * (v / SIDE) - 48.0;
        s.at[0][v] = (float)x;
        s.at[1][v] = (float)y;
        s.at[2][v] = (float)height(x, y);
    }
    uint32_t(*t)[3] = s.triangle;
    for (uint32_t row = 0; row + 1 < SIDE; ++row)
        for (uint32_t i = 0; i + 1 < SIDE; ++i, t += 2) {
            uint32_t a = row * SIDE + i;
            const uint32_t quad[2][3] = {{a, a + 1, a + SIDE + 1}, {a, a + SIDE + 1, a + SIDE}};
            memcpy(t, quad, sizeof quad);
        }
    create();
}

static uint32_t count_written(const stamps_reader *seen)
{
    uint32_t count = 0;
    for (uint32_t block = 0; block < s.block_count; ++block)
        count += stamps_is_new(seen, shading_written(s.shading), block);
    return count;
}

static void only_what_touches_a_written_block_is_written(void **state)
{
    (void)state;
    stamps_reader seen = {.seen = 0};
    make_bowl();
    update();
    stamps_read(&seen, shading_written(s.shading));
    stamps_begin(&s.written); /* a frame in which nothing moved */
    update();
    assert_int_equal(count_written(&seen), 0);
    stamps_begin(&s.written);
    stamps_mark(&s.written, 30); /* vertices 1920 to 1983: rows 31 and 32, in part */
    s.at[2][1950] += 1.0f;
    update();
    assert_in_range(count_written(&seen), 2, 5);
    expect_bits();
    end();
}

static double degrees_between(const double a[3], uint32_t v)
{
    double dot = 0.0, size = 0.0;
    for (uint32_t axis = 0; axis < 3; ++axis) {
        dot += a[axis] * (double)shading_normal(s.shading, axis)[v];
        size += a[axis] * a[axis];
    }
    return acos(fmin(1.0, dot / sqrt(size))) * 57.29577951308232;
}

/* Of the bowl after the field, by differences in double. */
static void exact_normal(double out[3], const csrbf_solver *solver, double x, double y)
{
    const double h = 1e-4;
    double at[4][3] = {{x - h, y, height(x - h, y)},
                       {x + h, y, height(x + h, y)},
                       {x, y - h, height(x, y - h)},
                       {x, y + h, height(x, y + h)}};
    double u[3], v[3];
    csrbf_move_f64(solver, at[0], 4);
    for (int axis = 0; axis < 3; ++axis) {
        u[axis] = at[1][axis] - at[0][axis];
        v[axis] = at[3][axis] - at[2][axis];
    }
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

static csrbf_solver *pull_bowl(void)
{
    error err = {""};
    const csrbf_settings settings = {.radius = 40.0};
    double start[CONTROLS][3], way[CONTROLS][3];
    csrbf_solver *solver = csrbf_solver_create(CONTROLS);
    for (int k = 0; k < CONTROLS; ++k) {
        start[k][0] = 24.0 * (k % 3 - 1);
        start[k][1] = 30.0 * (int)(k / 3) - 11.0;
        start[k][2] = height(start[k][0], start[k][1]);
        way[k][0] = 2.0 - k;
        way[k][1] = 0.7 * k - 2.0;
        way[k][2] = k % 2 ? 7.0 : -5.0;
    }
    assert_non_null(solver);
    if (csrbf_factor(solver, &settings, start[0], NULL, CONTROLS, &err) < 0 ||
        csrbf_solve(solver, way[0], &err) < 0)
        fail_msg("%s", err.text);
    return solver;
}

static void within_a_degree_of_exact_normals(void **state)
{
    (void)state;
    make_bowl();
    csrbf_solver *solver = pull_bowl();
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        double at[3] = {(double)s.at[0][v], (double)s.at[1][v], (double)s.at[2][v]};
        csrbf_move_f64(solver, at, 1);
        for (int axis = 0; axis < 3; ++axis)
            s.at[axis][v] = (float)at[axis];
    }
    stamps_begin(&s.written);
    stamps_mark_all(&s.written);
    update();
    double worst = 0.0, turned = 0.0;
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        uint32_t i = v % SIDE, row = v / SIDE;
        double exact[3], x = 1.6 * i - 48.0, y = 1.6 * row - 48.0;
        const double rest[3] = {-x / 100.0, -y / 100.0, 1.0};
        if (i == 0 || row == 0 || i == SIDE - 1 || row == SIDE - 1)
            continue; /* a border has triangles on one side only */
        exact_normal(exact, solver, x, y);
        worst = fmax(worst, degrees_between(exact, v));
        turned = fmax(turned, degrees_between(rest, v));
    }
    assert_true(worst < 1.0);
    assert_true(turned > 15.0);
    csrbf_solver_destroy(solver);
    end();
}

static void what_is_carried_turns_with_its_bone(void **state)
{
    (void)state;
    make_bowl();
    update();
    s.pose[0] = rigid_turn((vec3){0, 10, -50}, (vec3){0.6, 0.0, 0.8}, 0.7);
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        vec3 at = {(double)s.at[0][v], (double)s.at[1][v], (double)s.at[2][v]};
        at = rigid_apply(&s.pose[0], at);
        s.at[0][v] = (float)at.x;
        s.at[1][v] = (float)at.y;
        s.at[2][v] = (float)at.z;
    }
    memset(s.carrier, 0, s.block_count);
    s.carrier[20] = SHADING_LOOSE;
    stamps_begin(&s.written);
    stamps_mark_all(&s.written);
    update();
    shade_whole();
    uint32_t other_bits = 0;
    for (uint32_t v = 0; v < s.vertex_count; ++v) {
        const double whole[3] = {(double)s.whole[0][v], (double)s.whole[1][v],
                                 (double)s.whole[2][v]};
        bool is_same = true;
        for (uint32_t axis = 0; axis < 3; ++axis)
            is_same &= !(fabsf(shading_normal(s.shading, axis)[v] - s.whole[axis][v]) > 0.0f);
        other_bits += !is_same;
        assert_true(degrees_between(whole, v) < 0.05);
        if (v / SHADING_BLOCK == 20)
            assert_true(is_same);
    }
    assert_true(other_bits > 0); /* it was turned, not found anew */
    end();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bits_are_those_of_all_triangles),
        cmocka_unit_test(a_surface_without_triangles_looks_along_z),
        cmocka_unit_test(a_hub_of_thousands_of_triangles_is_shaded),
        cmocka_unit_test(only_what_touches_a_written_block_is_written),
        cmocka_unit_test(within_a_degree_of_exact_normals),
        cmocka_unit_test(what_is_carried_turns_with_its_bone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
