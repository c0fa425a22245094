/* A mouth that is cut into a surface: its edges are smoother than the mesh's, and no triangle is
 * crushed. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh/cut.h"
#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 12, COLUMNS = 20, CHAIN = 2 * COLUMNS - 8 };

static uint32_t vertex_at(uint32_t row, uint32_t column)
{
    return row * COLUMNS + column;
}

/* A plate of triangles that looks along +z: 10 mm an edge, every second row half an edge further.
 */
static mesh make_plate(void)
{
    mesh m = {.position = calloc((size_t)3 * ROWS * COLUMNS, sizeof *m.position),
              .triangle = calloc((size_t)6 * ROWS * COLUMNS, sizeof *m.triangle),
              .part = calloc(1, sizeof *m.part),
              .material = calloc(1, sizeof *m.material),
              .mm_per_unit = 1.0};
    assert_true(m.position && m.triangle && m.part && m.material);
    m.material[m.material_count++] = mesh_material_grey();
    m.material[0].name = strdup("skin");
    for (uint32_t row = 0; row < ROWS; ++row)
        for (uint32_t i = 0; i < COLUMNS; ++i) {
            float *p = m.position + (size_t)3 * m.vertex_count++;
            p[0] = 10.0f * (float)i + (row % 2 ? 5.0f : 0.0f);
            p[1] = 8.66f * (float)row;
        }
    for (uint32_t row = 0; row + 1 < ROWS; ++row)
        for (uint32_t i = 0; i + 1 < COLUMNS; ++i) {
            const uint32_t a = vertex_at(row, i), b = vertex_at(row, i + 1),
                           c = vertex_at(row + 1, i), d = vertex_at(row + 1, i + 1);
            const uint32_t even[6] = {a, b, c, b, d, c}, odd[6] = {a, d, c, a, b, d};
            memcpy(m.triangle + (size_t)3 * m.triangle_count, row % 2 ? odd : even, sizeof even);
            m.triangle_count += 2;
        }
    m.part[m.part_count++] = (mesh_part){
        .name = strdup("skin"), .triangle_count = m.triangle_count, .vertex_count = m.vertex_count};
    return m;
}

static double area_of(const mesh *m, uint32_t triangle) /* mm^2; negative: it faces -z */
{
    const uint32_t *corner = m->triangle + (size_t)3 * triangle;
    const vec3 a = mesh_position(m, corner[0]);
    const vec3 u = vec3_sub(mesh_position(m, corner[1]), a),
               v = vec3_sub(mesh_position(m, corner[2]), a);
    return 0.5 * (u.x * v.y - u.y * v.x);
}

static double zigzag_mm(const mesh *m,
                        const uint32_t *chain) /* greatest bend of the inner points */
{
    double most = 0.0;
    for (int i = 3; i < CHAIN - 3; ++i) {
        const double beside =
            0.5 * (mesh_position(m, chain[i - 1]).y + mesh_position(m, chain[i + 1]).y);
        most = fmax(most, fabs(mesh_position(m, chain[i]).y - beside));
    }
    return most;
}

/* The worst chain: all triangles between the two rows have three of its points, and shrink. */
static void the_edge_of_a_cut_mouth_is_smoother_than_the_mesh(void **state)
{
    (void)state;
    error err = {""};
    mesh m = make_plate();
    uint32_t chain[CHAIN];
    for (uint32_t i = 0; i < CHAIN; ++i) /* up and down between two rows */
        chain[i] = vertex_at(4 + i % 2, 2 + i / 2);
    const uint32_t triangles = m.triangle_count;
    const double zigzag = zigzag_mm(&m, chain), area = area_of(&m, 0);
    if (mesh_cut_mouth(&m, chain, CHAIN, &err) < 0)
        fail_msg("%s", err.text);
    print_message("zigzag %.2f mm, cut %.2f mm\n", zigzag, zigzag_mm(&m, chain));
    assert_true(zigzag_mm(&m, chain) < 0.55 * zigzag);
    for (uint32_t t = 0; t < triangles; ++t) /* none is turned over, none is crushed */
        assert_true(area_of(&m, t) > 0.45 * area);
    assert_true(mesh_validate(&m, &err) >= 0);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_edge_of_a_cut_mouth_is_smoother_than_the_mesh)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
