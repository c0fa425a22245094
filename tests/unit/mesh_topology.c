#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/openmesh.h"

#include <string.h>

/* Topology looks at triangles only: the vertices are somewhere. */
static topology topology_of(const uint32_t *triangle, uint32_t triangle_count,
                            uint32_t vertex_count)
{
    mesh m;
    topology out;
    error err = {""};
    assert_int_equal(mesh_create(&m, vertex_count, triangle_count, &err), MRT_OK);
    memcpy(m.triangle, triangle, (size_t)triangle_count * 3 * sizeof *triangle);
    for (uint32_t v = 0; v < vertex_count; ++v)
        m.position[(size_t)v * 3] = (float)v;
    if (openmesh_topology(&out, &m, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(out.vertex_count, vertex_count);
    mesh_destroy(&m);
    return out;
}

static void assert_neighbours(const topology *t, uint32_t vertex, const uint32_t *expected,
                              uint32_t count)
{
    assert_int_equal(t->neighbour_start[vertex + 1] - t->neighbour_start[vertex], count);
    assert_memory_equal(t->neighbour + t->neighbour_start[vertex], expected,
                        count * sizeof *expected);
}

static void a_cube_is_closed(void **state)
{
    (void)state;
    static const uint32_t cube[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    static const uint32_t of_0[] = {1, 2, 4}, of_1[] = {0, 2, 3, 4, 5};
    topology t = topology_of(cube, 12, 8);
    assert_int_equal(t.rejected_count, 0);
    assert_int_equal(t.border_loop_count, 0);
    assert_int_equal(t.component_count, 1);
    assert_int_equal(t.isolated_vertex_count, 0);
    assert_int_equal(t.neighbour_start[8], 36);
    assert_neighbours(&t, 0, of_0, 3);
    assert_neighbours(&t, 1, of_1, 5);
    for (int v = 0; v < 8; ++v)
        assert_int_equal(t.on_border[v], 0);
    topology_destroy(&t);
}

static void a_strip_has_one_border_around_it(void **state)
{
    (void)state;
    static const uint32_t strip[] = {0, 1, 2, 2, 1, 3, 2, 3, 4};
    static const uint32_t of_2[] = {0, 1, 3, 4};
    /* Against the faces: the border's half-edges have the surface on their other side. */
    static const uint32_t around[] = {0, 2, 4, 3, 1};
    topology t = topology_of(strip, 3, 6);
    assert_int_equal(t.border_loop_count, 1);
    assert_int_equal(t.border_loop_start[0], 0);
    assert_int_equal(t.border_loop_start[1], 5);
    uint32_t start = 0;
    while (t.border_vertex[start] != 0)
        start += 1;
    for (uint32_t i = 0; i < 5; ++i)
        assert_int_equal(t.border_vertex[(start + i) % 5], around[i]);
    for (int v = 0; v < 6; ++v)
        assert_int_equal(t.on_border[v], v < 5);
    assert_neighbours(&t, 2, of_2, 4);
    assert_int_equal(t.isolated_vertex_count, 1);
    assert_int_equal(t.component_count, 1);
    topology_destroy(&t);
}

static void a_tube_has_two_borders(void **state)
{
    (void)state;
    static const uint32_t tube[] = {0, 1, 3, 1, 4, 3, 1, 2, 4, 2, 5, 4, 2, 0, 5, 0, 3, 5};
    topology t = topology_of(tube, 6, 6);
    assert_int_equal(t.border_loop_count, 2);
    assert_int_equal(t.border_loop_start[1], 3);
    assert_int_equal(t.border_loop_start[2], 6);
    topology_destroy(&t);
}

static void the_third_triangle_on_an_edge_is_rejected(void **state)
{
    (void)state;
    static const uint32_t fan[] = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    topology t = topology_of(fan, 3, 5);
    assert_int_equal(t.rejected_count, 1);
    assert_int_equal(t.rejected_triangle[0], 2);
    assert_int_equal(t.isolated_vertex_count, 1);
    assert_int_equal(t.neighbour_start[5], 10);
    topology_destroy(&t);
}

static void degenerate_and_flipped_triangles_are_rejected_in_order(void **state)
{
    (void)state;
    static const uint32_t mixed[] = {0, 0, 1, 0, 1, 2, 1, 2, 1, 0, 1, 3, 4, 4, 4};
    static const uint32_t rejected[] = {0, 2, 3, 4};
    topology t = topology_of(mixed, 5, 5);
    assert_int_equal(t.rejected_count, 4);
    assert_memory_equal(t.rejected_triangle, rejected, sizeof rejected);
    assert_int_equal(t.component_count, 1);
    assert_int_equal(t.isolated_vertex_count, 2);
    topology_destroy(&t);
}

static void a_bowtie_is_one_component_with_every_neighbour(void **state)
{
    (void)state;
    static const uint32_t bowtie[] = {0, 1, 2, 0, 3, 4};
    static const uint32_t of_0[] = {1, 2, 3, 4}, of_3[] = {0, 4};
    topology t = topology_of(bowtie, 2, 5);
    assert_int_equal(t.rejected_count, 0);
    assert_neighbours(&t, 0, of_0, 4);
    assert_neighbours(&t, 3, of_3, 2);
    assert_int_equal(t.component_count, 1);
    assert_int_equal(t.border_loop_start[t.border_loop_count], 6);
    topology_destroy(&t);
}

static void separate_surfaces_are_counted(void **state)
{
    (void)state;
    static const uint32_t two[] = {0, 1, 2, 3, 4, 5};
    topology t = topology_of(two, 2, 7);
    assert_int_equal(t.component_count, 2);
    assert_int_equal(t.border_loop_count, 2);
    assert_int_equal(t.isolated_vertex_count, 1);
    topology_destroy(&t);
}

static void a_mesh_without_triangles_is_all_isolated(void **state)
{
    (void)state;
    static const uint32_t none[] = {0};
    topology t = topology_of(none, 0, 3);
    assert_int_equal(t.isolated_vertex_count, 3);
    assert_int_equal(t.component_count, 0);
    topology_destroy(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cube_is_closed),
        cmocka_unit_test(a_strip_has_one_border_around_it),
        cmocka_unit_test(a_tube_has_two_borders),
        cmocka_unit_test(the_third_triangle_on_an_edge_is_rejected),
        cmocka_unit_test(degenerate_and_flipped_triangles_are_rejected_in_order),
        cmocka_unit_test(a_bowtie_is_one_component_with_every_neighbour),
        cmocka_unit_test(separate_surfaces_are_counted),
        cmocka_unit_test(a_mesh_without_triangles_is_all_isolated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
