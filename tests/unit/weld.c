#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh/weld.h"

#include <stdlib.h>
#include <string.h>

/* Two squares, each of two triangles, that meet along x = 1; the right one has vertices of its
 * own, 4 to 7. */
static const float squares[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                    {1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 1, 0}};
static const uint32_t of_squares[12] = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6};

static mesh mesh_of(const float *position, uint32_t vertex_count, const uint32_t *triangle,
                    uint32_t triangle_count)
{
    mesh m;
    error err = {""};
    assert_int_equal(mesh_create(&m, vertex_count, triangle_count, &err), MRT_OK);
    memcpy(m.position, position, (size_t)vertex_count * 3 * sizeof *position);
    memcpy(m.triangle, triangle, (size_t)triangle_count * 3 * sizeof *triangle);
    return m;
}

static void weld(mesh *m)
{
    error err = {""};
    if (mesh_weld(m, &err) < 0)
        fail_msg("%s", err.text);
}

static void a_surface_goes_on_across_a_seam(void **state)
{
    (void)state;
    mesh m = mesh_of(squares[0], 8, of_squares, 4);
    weld(&m);
    static const uint32_t expected[] = {0, 1, 2, 3, 1, 5, 3, 7};
    assert_memory_equal(m.point, expected, sizeof expected);
    assert_memory_equal(m.smooth, expected, sizeof expected);
    mesh_destroy(&m);
}

static void what_is_nearly_at_one_place_gets_one_position_bit_for_bit(void **state)
{
    (void)state;
    mesh m = mesh_of(squares[0], 8, of_squares, 4);
    m.position[4 * 3] += 1e-6f;
    m.position[6 * 3 + 1] -= 1e-6f;
    weld(&m);
    assert_int_equal(mesh_point(&m, 4), 1);
    assert_memory_equal(m.position + 12, m.position + 3, 3 * sizeof(float));
    assert_memory_equal(m.position + 18, m.position + 9, 3 * sizeof(float));
    mesh_destroy(&m);
}

static void what_touches_at_a_corner_alone_stays_apart(void **state)
{
    (void)state;
    mesh m = mesh_of(squares[0], 8, of_squares, 4);
    m.position[6 * 3] = 1.5f;
    weld(&m);
    assert_int_equal(mesh_point(&m, 4), 4);
    assert_int_equal(mesh_point(&m, 6), 6);
    mesh_destroy(&m);
}

/* The upper lip from (0, 0, 0) to the front, facing down, and the lower below it, facing up: they
 * touch at the back, y = z = 0. lift: how far the fronts are apart. */
static mesh lips(float lift)
{
    const float position[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, lift, 1},  {1, lift, 1},
                                  {0, 0, 0}, {1, 0, 0}, {0, -lift, 1}, {1, -lift, 1}};
    static const uint32_t triangle[12] = {0, 1, 3, 0, 3, 2, 5, 4, 6, 5, 6, 7};
    return mesh_of(position[0], 8, triangle, 4);
}

static void lips_that_touch_stay_apart(void **state)
{
    (void)state;
    for (float lift = 0.0f; lift < 0.35f; lift += 0.1f) {
        mesh m = lips(lift);
        weld(&m);
        assert_int_equal(mesh_point(&m, 4), 4);
        assert_int_equal(mesh_point(&m, 5), 5);
        mesh_destroy(&m);
    }
}

/* The same turned inside out: the rim of an ear. */
/* A grid of 10 by 4 squares with a slit along its middle row, from column 1 to 9; both sides have
 * vertices of their own between the ends. */
static mesh slit(void)
{
    enum { WIDE = 11, HIGH = 5, SHEET = WIDE * HIGH, INNER = WIDE - 4 };
    float position[SHEET + INNER][3];
    uint32_t triangle[10 * 4 * 2][3], count = 0;
    for (uint32_t v = 0; v < SHEET + INNER; ++v) {
        uint32_t column = v < SHEET ? v % WIDE : v - SHEET + 2, row = v < SHEET ? v / WIDE : 2;
        position[v][0] = (float)column;
        position[v][1] = (float)row;
        position[v][2] = 0.0f;
    }
    for (uint32_t row = 0; row < HIGH - 1; ++row)
        for (uint32_t column = 0; column < WIDE - 1; ++column) {
            uint32_t a = row * WIDE + column, top[2] = {a + WIDE, a + WIDE + 1};
            for (uint32_t k = 0; row == 1 && k < 2; ++k)
                if (column + k >= 2 && column + k < 2 + INNER)
                    top[k] = SHEET + column + k - 2;
            memcpy(triangle[count++], (const uint32_t[3]){a, a + 1, top[1]}, sizeof *triangle);
            memcpy(triangle[count++], (const uint32_t[3]){a, top[1], top[0]}, sizeof *triangle);
        }
    mesh m = mesh_of(position[0], SHEET + INNER, triangle[0], count);
    m.uv = calloc((size_t)m.vertex_count * 2, sizeof *m.uv);
    assert_non_null(m.uv);
    return m;
}

static void a_slit_with_nothing_behind_it_stays_open(void **state)
{
    (void)state;
    mesh m = slit();
    weld(&m);
    for (uint32_t v = 0; v < 7; ++v)
        assert_int_equal(mesh_point(&m, 55 + v), 55 + v);
    mesh_destroy(&m);
}

/* The same places with other texture coordinates below, as a seam has them. */
static void a_seam_that_ends_in_the_surface_is_none(void **state)
{
    (void)state;
    mesh m = slit();
    for (uint32_t v = 55; v < 62; ++v)
        m.uv[2 * (size_t)v] = 0.5f;
    weld(&m);
    for (uint32_t v = 0; v < 7; ++v)
        assert_int_equal(mesh_point(&m, 55 + v), 24 + v);
    mesh_destroy(&m);
}

static void a_sharp_rim_is_one_edge(void **state)
{
    (void)state;
    mesh m = lips(0.1f);
    for (size_t t = 0; t < 4; ++t) {
        uint32_t swap = m.triangle[3 * t];
        m.triangle[3 * t] = m.triangle[3 * t + 1];
        m.triangle[3 * t + 1] = swap;
    }
    weld(&m);
    assert_int_equal(mesh_point(&m, 4), 0);
    assert_int_equal(mesh_point(&m, 5), 1);
    mesh_destroy(&m);
}

/* Where the skin and a brow on it end at one edge the skin goes on. */
static void the_straightest_pair_is_joined(void **state)
{
    (void)state;
    float position[12][3];
    uint32_t triangle[18];
    memcpy(position, squares, sizeof squares);
    memcpy(position[8], (const float[4][3]){{1, 0, 0}, {1, 0, 1}, {1, 1, 0}, {1, 1, 1}},
           4 * sizeof *position);
    memcpy(triangle, of_squares, sizeof of_squares);
    memcpy(triangle + 12, (const uint32_t[6]){8, 9, 11, 8, 11, 10}, 6 * sizeof *triangle);
    mesh m = mesh_of(position[0], 12, triangle, 6);
    weld(&m);
    assert_int_equal(mesh_point(&m, 4), 1);
    assert_int_equal(mesh_point(&m, 8), 8);
    mesh_destroy(&m);
}

static void hard_edges_are_one_point_with_two_normals(void **state)
{
    (void)state;
    mesh m = mesh_of(squares[0], 8, of_squares, 4);
    m.normal = calloc(24, sizeof *m.normal);
    assert_non_null(m.normal);
    for (size_t v = 0; v < 8; ++v)
        m.normal[3 * v + (v < 4 ? 2 : 1)] = 1.0f;
    m.normal[3 * 6 + 1] = 0.0f;
    m.normal[3 * 6 + 2] = 1.0f; /* its seam is of the texture alone */
    weld(&m);
    assert_int_equal(mesh_point(&m, 4), 1);
    assert_int_equal(m.smooth[4], 4);
    assert_int_equal(m.smooth[6], 3);
    mesh_destroy(&m);
}

static void a_target_moves_one_point_as_one(void **state)
{
    (void)state;
    mesh m = mesh_of(squares[0], 8, of_squares, 4);
    m.target = calloc(1, sizeof *m.target);
    m.target_count = 1;
    m.target[0] = (mesh_target){.name = strdup("smile"), .offset = calloc(24, sizeof(float))};
    m.target[0].offset[3 * 1] = 5.0f;
    m.target[0].offset[3 * 4] = 4.0f;
    weld(&m);
    assert_true(m.target[0].offset[3 * 4] == 5.0f);
    mesh_destroy(&m);
}

/* What a hostile file may ask for: a hundred thousand vertices at one place. */
static void a_crowd_at_one_place_costs_no_more_than_others(void **state)
{
    (void)state;
    enum { TRIANGLES = 100000 };
    mesh m;
    error err = {""};
    assert_int_equal(mesh_create(&m, 3 * TRIANGLES, TRIANGLES, &err), MRT_OK);
    for (uint32_t i = 0; i < 3 * TRIANGLES; ++i)
        m.triangle[i] = i;
    for (uint32_t t = 0; t < TRIANGLES; ++t) { /* a fan: its middle is there each time */
        m.position[9 * t + 3] = (float)t;
        m.position[9 * t + 6] = (float)t + 1.0f;
        m.position[9 * t + 7] = m.position[9 * t + 4] = 1.0f;
    }
    weld(&m);
    for (uint32_t t = 1; t < TRIANGLES; ++t)
        assert_int_equal(mesh_point(&m, 3 * t), 0);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_goes_on_across_a_seam),
        cmocka_unit_test(what_is_nearly_at_one_place_gets_one_position_bit_for_bit),
        cmocka_unit_test(what_touches_at_a_corner_alone_stays_apart),
        cmocka_unit_test(lips_that_touch_stay_apart),
        cmocka_unit_test(a_slit_with_nothing_behind_it_stays_open),
        cmocka_unit_test(a_seam_that_ends_in_the_surface_is_none),
        cmocka_unit_test(a_sharp_rim_is_one_edge),
        cmocka_unit_test(the_straightest_pair_is_joined),
        cmocka_unit_test(hard_edges_are_one_point_with_two_normals),
        cmocka_unit_test(a_target_moves_one_point_as_one),
        cmocka_unit_test(a_crowd_at_one_place_costs_no_more_than_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
