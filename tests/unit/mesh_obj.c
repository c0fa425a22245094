#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/mesh_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define QUAD     "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"

static mesh read_good(const char *text)
{
    mesh m;
    error err = {""};
    if (obj_parse(&m, text, strlen(text), NULL, MESH_VERTICES_ALL, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(mesh_validate(&m, &err), MRT_OK);
    return m;
}

static void assert_refused(const char *text, size_t size, const char *reason)
{
    mesh m;
    error err = {""};
    if (obj_parse(&m, text, size, NULL, MESH_VERTICES_ALL, &err) >= 0)
        fail_msg("accepted: %s", text);
    assert_null(m.position);
    if (!strstr(err.text, reason))
        fail_msg("\"%s\" does not say \"%s\"", err.text, reason);
}

static void assert_triangles(const mesh *m, const uint32_t *expected, uint32_t count)
{
    assert_int_equal(m->triangle_count, count);
    assert_memory_equal(m->triangle, expected, count * 3 * sizeof *expected);
}

static void every_form_of_corner_is_read(void **state)
{
    (void)state;
    static const char *const faces[] = {
        "f 1 2 3\n",    "f 1/1 2/2 3/3\n", "f 1//1 2//1 3//1\n", "f 1/1/1 2/2/2 3/3/3\n",
        "f -3 -2 -1\n", "f +1 2 3\r\n",    "f 1 2 \\\n 3\n",     "  f\t1 2 3",
        "f 1/ 2/ 3/\n", "f 1// 2// 3//\n", "f 1/1/ 2/2/ 3//\n",  "f 1/1 2/ 3\n"};
    static const uint32_t expected[] = {0, 1, 2};
    for (size_t i = 0; i < sizeof faces / sizeof *faces; ++i) {
        char text[256];
        (void)snprintf(text, sizeof text, "%s%s", TRIANGLE, faces[i]);
        mesh m = read_good(text);
        assert_int_equal(m.vertex_count, 3);
        assert_triangles(&m, expected, 1);
        mesh_destroy(&m);
    }
}

static void vertices_keep_their_order_and_number(void **state)
{
    (void)state;
    mesh m = read_good("v 5 0 0\nv 1.5 -2e1 .25\nv 5 0 0\nv 7 7 7\nf 3 2 1\n");
    assert_int_equal(m.vertex_count, 4);
    assert_true(m.position[3] == 1.5f && m.position[4] == -20.0f && m.position[5] == 0.25f);
    static const uint32_t expected[] = {2, 1, 0};
    assert_triangles(&m, expected, 1);
    mesh_destroy(&m);
}

static void weights_after_a_vertex_are_passed_over(void **state)
{
    (void)state;
    mesh m = read_good("v 0 0 0 1\nv 1 0 0 nan\nv 0 1 0 0.5\nf 1 2 3\n");
    assert_int_equal(m.vertex_count, 3);
    assert_null(m.colour);
    assert_null(m.note);
    mesh_destroy(&m);
}

static void colours_after_a_vertex_are_read(void **state)
{
    (void)state;
    mesh m = read_good("v 0 0 0 1 0 0\nv 1 0 0 0 0.50196 -1\nv 0 1 0 0 0 2 0.5\nf 1 2 3\n");
    assert_non_null(m.colour);
    assert_true(m.colour[0] == 1.0f && m.colour[1] == 0.0f && m.colour[3] == 1.0f);
    assert_true(m.colour[5] > 0.2158f && m.colour[5] < 0.2160f); /* sRGB 128, in linear light */
    assert_true(m.colour[6] == 0.0f && m.colour[10] == 1.0f && m.colour[11] == 1.0f);
    assert_null(m.note);
    mesh_destroy(&m);
}

static void vertices_without_a_colour_are_white(void **state)
{
    (void)state;
    static const float expected[16] = {1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    mesh m = read_good("v 0 0 0\nv 1 0 0 0 0 1\nv 0 1 0 0 NaN -nan(ind)\nv 1 1 0\nf 1 2 3\n");
    assert_memory_equal(m.colour, expected, sizeof expected);
    assert_non_null(strstr(m.note, "2 vertices have no colour and are white"));
    assert_non_null(strstr(m.note, "the colours of 1 vertices are not numbers"));
    mesh_destroy(&m);
}

static void a_vertex_that_is_split_keeps_its_colour(void **state)
{
    (void)state;
    mesh m = read_good("mtllib head.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\n"
                       "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 3/3\nf 3/4 2/2 1/1\n");
    assert_int_equal(m.vertex_count, 4);
    assert_int_equal(m.point[3], 2);
    assert_memory_equal(m.colour + 12, m.colour + 8, 4 * sizeof(float));
    assert_true(m.colour[14] == 1.0f && m.colour[12] == 0.0f);
    mesh_destroy(&m);
}

static void quads_are_cut_along_the_shorter_diagonal(void **state)
{
    (void)state;
    mesh m = read_good("v 0 0 0\nv 1 0 0\nv 5 5 0\nv 0 1 0\nf 1 2 3 4\n");
    static const uint32_t shorter[] = {0, 1, 3, 1, 2, 3};
    assert_triangles(&m, shorter, 2);
    mesh_destroy(&m);
    m = read_good(QUAD "f 1 2 3 4\n"); /* equal diagonals: the first */
    static const uint32_t equal[] = {0, 1, 2, 0, 2, 3};
    assert_triangles(&m, equal, 2);
    mesh_destroy(&m);
}

static void polygons_become_fans_with_a_note(void **state)
{
    (void)state;
    mesh m = read_good(QUAD "v -1 0.5 0\nf 1 2 3 4 5\n");
    static const uint32_t fan[] = {0, 1, 2, 0, 2, 3, 0, 3, 4};
    assert_triangles(&m, fan, 3);
    assert_non_null(strstr(m.note, "1 faces of more than 4 corners"));
    mesh_destroy(&m);
}

static void groups_and_materials_become_parts_in_order_of_appearance(void **state)
{
    (void)state;
    mesh m = read_good(QUAD "usemtl skin\ng face\nf 1 2 3\ng teeth\nf 1 2 4\ng face\nf 2 3 4\n"
                            "usemtl lip\nf 3 4 1\n");
    static const uint32_t expected[] = {0, 1, 2, 1, 2, 3, 0, 1, 3, 2, 3, 0};
    assert_triangles(&m, expected, 4);
    assert_int_equal(m.part_count, 3);
    assert_string_equal(m.part[0].name, "face");
    assert_int_equal(m.part[0].triangle_count, 2);
    assert_string_equal(m.part[1].name, "teeth");
    assert_int_equal(m.part[1].first_triangle, 2);
    assert_int_equal(m.part[1].first_vertex, 0);
    assert_int_equal(m.part[1].vertex_count, 4);
    assert_string_equal(m.part[2].name, "face");
    assert_string_equal(m.material[m.part[0].material].name, "skin");
    assert_string_equal(m.material[m.part[2].material].name, "lip");
    mesh_destroy(&m);
}

static void names_are_clean_utf8(void **state)
{
    (void)state;
    mesh m = read_good(TRIANGLE "o m\xc3\xbcnd \xff\x01 x\nf 1 2 3\n");
    assert_string_equal(m.part[0].name, "m\xc3\xbcnd ?? x");
    mesh_destroy(&m);
}

static void unknown_statements_are_counted(void **state)
{
    (void)state;
    mesh m =
        read_good("# comment\n" TRIANGLE "vt 0 0\nvn 0 0 1\ns off\ncurv 0 1\nl 1 2\nf 1 2 3\n");
    assert_non_null(strstr(m.note, "2 statements were skipped, the first is \"curv\""));
    mesh_destroy(&m);
}

static void degenerate_and_non_manifold_faces_are_kept(void **state)
{
    (void)state;
    mesh m = read_good(QUAD "v 1 1 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 1 2\n");
    assert_int_equal(m.vertex_count, 5);
    assert_int_equal(m.triangle_count, 4);
    assert_non_null(strstr(m.note, "1 triangles use a vertex twice"));
    mesh_destroy(&m);
}

/* Two triangles that share an edge on the surface, and lie apart in the picture. */
#define SEAM                                                                                       \
    QUAD "vt 0 0\nvt 1 0\nvt 1 1\nvt 0.25 0.5\nvt 0.5 0.75\n"                                      \
         "f 1/1 2/2 3/3\nf 1/4 3/-1 4\n"

static void without_materials_vertices_stay_as_they_are(void **state)
{
    (void)state;
    mesh m = read_good(SEAM);
    static const uint32_t expected[] = {0, 1, 2, 0, 2, 3};
    assert_int_equal(m.vertex_count, 4);
    assert_triangles(&m, expected, 2);
    assert_null(m.uv);
    assert_null(m.point);
    assert_null(m.note);
    mesh_destroy(&m);
}

static void a_vertex_at_two_places_of_a_picture_is_split_behind_all_others(void **state)
{
    (void)state;
    mesh m = read_good("mtllib head.mtl\n" SEAM "v 9 9 9\nf 1/4 3/5 5/1\n");
    static const uint32_t triangles[] = {0, 1, 2, 5, 6, 3, 5, 6, 4};
    static const float uv[] = {0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 0.25f, 0.5f, 0.5f, 0.25f};
    static const uint32_t point[] = {0, 1, 2, 3, 4, 0, 2};
    assert_int_equal(m.vertex_count, 7);
    assert_triangles(&m, triangles, 3);
    assert_memory_equal(m.uv, uv, sizeof uv);
    assert_memory_equal(m.point, point, sizeof point);
    for (size_t v = 0; v < 7; ++v)
        assert_memory_equal(m.position + 3 * v, m.position + (size_t)3 * point[v],
                            3 * sizeof(float));
    mesh_destroy(&m);
}

/* As before pictures were read. */
static void as_written_nothing_is_split(void **state)
{
    (void)state;
    static const char text[] = "mtllib head.mtl\n" SEAM;
    mesh plain = read_good(SEAM), m;
    error err = {""};
    assert_int_equal(obj_parse(&m, text, strlen(text), NULL, MESH_VERTICES_AS_WRITTEN, &err),
                     MRT_OK);
    assert_int_equal(m.vertex_count, plain.vertex_count);
    assert_memory_equal(m.position, plain.position, 12 * sizeof(float));
    assert_triangles(&m, plain.triangle, 2);
    assert_null(m.uv);
    assert_null(m.point);
    mesh_destroy(&m);
    mesh_destroy(&plain);
}

static void the_same_place_twice_in_the_file_is_one(void **state)
{
    (void)state;
    mesh m = read_good("mtllib head.mtl\n" QUAD
                       "vt 0.5 0.5\nvt 0.5 0.5\nf 1/1 2/1 3/1\nf 1/2 3/2 4/2\n");
    assert_int_equal(m.vertex_count, 4);
    assert_true(m.uv[0] == 0.5f && m.uv[7] == 0.5f);
    assert_null(m.point);
    mesh_destroy(&m);
}

static void coordinates_that_are_not_there_cost_nothing_but_themselves(void **state)
{
    (void)state;
    mesh m = read_good("mtllib head.mtl\n" QUAD "vt nan 0\nvt 0.5\nvt 0.25 0.25 0\n"
                       "f 1/1 2/99 3/-99\nf 1/2 3/3 4\n");
    assert_int_equal(m.vertex_count, 4);
    assert_true(m.uv[0] == 0.5f && m.uv[1] == 1.0f && m.uv[4] == 0.25f && m.uv[5] == 0.75f);
    assert_true(m.uv[2] == 0.0f && m.uv[6] == 0.0f);
    assert_non_null(strstr(m.note, "3 corners refer to missing texture coordinates"));
    mesh_destroy(&m);
}

/* One vertex in the middle of very many corners, each at another place. */
static void many_places_of_one_vertex_are_read_in_bounded_time(void **state)
{
    (void)state;
    enum { CORNERS = 200000 };
    char *text = malloc((size_t)CORNERS * 48 + 256);
    assert_non_null(text);
    int used = sprintf(text, "mtllib a\n%svt 0 0\n", TRIANGLE);
    for (int i = 0; i < CORNERS; ++i)
        used += sprintf(text + used, "vt %d 1\nf 1/-1 2/1 3/1\n", i);
    mesh m;
    error err = {""};
    assert_int_equal(obj_parse(&m, text, (size_t)used, NULL, MESH_VERTICES_ALL, &err), MRT_OK);
    assert_int_equal(m.vertex_count, 3 + CORNERS - 1);
    mesh_destroy(&m);
    free(text);
}

static void malformed_text_is_refused_by_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *reason;
    } bad[] = {{"", "no vertices"},
               {"\x7f\x45\x4c\x46 junk \x01\x02\n", "no vertices"},
               {TRIANGLE, "3 vertices but no faces"},
               {"v 0 0 nan\n", "line 1: a finite number was expected, \"nan\" was found"},
               {"v 0 0 inf\n", "line 1: a finite number"},
               {"v 0 0 1e39\n", "line 1: a finite number"},
               {"v 0 0 1e999\n", "line 1: a finite number"},
               {"v 0 zero 0\n", "line 1: a finite number was expected, \"zero\""},
               {"v 0 0x10 0\n", "line 1: a finite number"},
               {"v 0 0\n", "line 1: a vertex has 2 numbers"},
               {"v 0 0 0 1 2 3 4 5\n", "line 1: a vertex of at most 7"},
               {TRIANGLE "f 0 1 2\n", "line 4: a face uses vertex 0"},
               {TRIANGLE "f 1 2 4\n", "line 4: a face uses vertex 4, but 3"},
               {TRIANGLE "f 1 2 -4\n", "line 4: a face uses vertex -4"},
               {TRIANGLE "f 1 2 999999999999\n", "line 4: a face uses vertex 999999999999"},
               {TRIANGLE "f 1 2 99999999999999999999\n", "line 4: a corner"},
               {TRIANGLE "f /1/ 2 3\n", "line 4: a corner as v"},
               {TRIANGLE "f 1/// 2 3\n", "line 4: a corner as v"},
               {TRIANGLE "f / 2 3\n", "line 4: a corner as v"},
               {"v 0 0 0 1 2 red\n", "line 1: a finite number was expected, \"red\""},
               {"v 0 0 0 1 2 nanometre\n", "line 1: a finite number"},
               {TRIANGLE "f 1/a 2 3\n", "line 4: a corner as v"},
               {TRIANGLE "f 1/1/1/1 2 3\n", "line 4: a corner as v"},
               {TRIANGLE "f 1 2.0 3\n", "line 4: a corner as v"},
               {TRIANGLE "f 1 2\n", "line 4: a face has 2 corners"},
               {TRIANGLE "f\n", "line 4: a face has 0 corners"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_refused(bad[i].text, strlen(bad[i].text), bad[i].reason);
}

static void a_line_beyond_the_cap_is_refused(void **state)
{
    (void)state;
    size_t size = (size_t)2 << 20;
    char *text = malloc(size);
    assert_non_null(text);
    memset(text, '1', size);
    assert_refused(text, size, "line 1: the line is longer");
    free(text);
}

static void many_groups_are_refused_in_bounded_time(void **state)
{
    (void)state;
    enum { GROUPS = 70000, LENGTH = 24 };
    char *text = malloc((size_t)GROUPS * LENGTH + 64);
    assert_non_null(text);
    size_t size = (size_t)sprintf(text, TRIANGLE);
    for (int i = 0; i < GROUPS; ++i)
        size += (size_t)sprintf(text + size, "g %d\nf 1 2 3\n", i);
    assert_refused(text, size, "more than 65536 groups");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_of_corner_is_read),
        cmocka_unit_test(vertices_keep_their_order_and_number),
        cmocka_unit_test(weights_after_a_vertex_are_passed_over),
        cmocka_unit_test(colours_after_a_vertex_are_read),
        cmocka_unit_test(vertices_without_a_colour_are_white),
        cmocka_unit_test(a_vertex_that_is_split_keeps_its_colour),
        cmocka_unit_test(quads_are_cut_along_the_shorter_diagonal),
        cmocka_unit_test(polygons_become_fans_with_a_note),
        cmocka_unit_test(groups_and_materials_become_parts_in_order_of_appearance),
        cmocka_unit_test(names_are_clean_utf8),
        cmocka_unit_test(unknown_statements_are_counted),
        cmocka_unit_test(degenerate_and_non_manifold_faces_are_kept),
        cmocka_unit_test(without_materials_vertices_stay_as_they_are),
        cmocka_unit_test(a_vertex_at_two_places_of_a_picture_is_split_behind_all_others),
        cmocka_unit_test(as_written_nothing_is_split),
        cmocka_unit_test(the_same_place_twice_in_the_file_is_one),
        cmocka_unit_test(coordinates_that_are_not_there_cost_nothing_but_themselves),
        cmocka_unit_test(many_places_of_one_vertex_are_read_in_bounded_time),
        cmocka_unit_test(malformed_text_is_refused_by_line),
        cmocka_unit_test(a_line_beyond_the_cap_is_refused),
        cmocka_unit_test(many_groups_are_refused_in_bounded_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
