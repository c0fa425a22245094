/* Which vertices selectors mean, and what regions make of them. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/bind.h"
#include "rig_help.h"

#include <math.h>

/* ---- selectors ---- */

static mrt_result select_on(float *out, const mesh *m, const char *select, error *err)
{
    char body[1024];
    (void)snprintf(body, sizeof body, "\"regions\": [{\"mobility\": 1, \"select\": %s}]", select);
    rig r;
    if (rig_with(&r, body, err) != MRT_OK)
        fail_msg("%s", err->text);
    topology t = make_topology(m);
    mrt_result result = bind_select(out, &r.region[0].select, m, &t, err);
    topology_destroy(&t);
    rig_destroy(&r);
    return result;
}

/* `picture`: the sheet's rows from the top, '#' where selected. */
static void assert_selects(const char *select, const char *picture)
{
    mesh m = make_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    if (select_on(out, &m, select, &err) != MRT_OK)
        fail_msg("%s", err.text);
    for (int row = 0; row < SHEET_SIDE; ++row)
        for (int column = 0; column < SHEET_SIDE; ++column) {
            float share = out[(SHEET_SIDE - 1 - row) * SHEET_SIDE + column];
            float expected = picture[row * SHEET_SIDE + column] == '#' ? 1.0f : 0.0f;
            if (share < expected || share > expected)
                fail_msg("%s: row %d column %d is %g", select, row, column, (double)share);
        }
    mesh_destroy(&m);
}

static void shapes_select_what_is_in_them(void **state)
{
    (void)state;
    assert_selects("{\"vertices\": [0, \"6-8\"]}", "....."
                                                   "....."
                                                   "....."
                                                   ".###."
                                                   "#....");
    assert_selects("{\"box\": {\"low\": [-10, 0, -1], \"high\": [10, 15, 1]}}", "....."
                                                                                ".###."
                                                                                ".###."
                                                                                "....."
                                                                                ".....");
    assert_selects("{\"ellipsoid\": {\"centre\": [0, 0, 0], \"radii\": [20, 10, 1]}}", "....."
                                                                                       "..#.."
                                                                                       "#####"
                                                                                       "..#.."
                                                                                       ".....");
    assert_selects("{\"half_space\": {\"point\": [0, 0, 0], \"normal\": [1, 1, 0]}}", "#####"
                                                                                      ".####"
                                                                                      "..###"
                                                                                      "...##"
                                                                                      "....#");
}

static void joined_selectors_are_least_and_greatest(void **state)
{
    (void)state;
    assert_selects("{\"all\": [{\"vertices\": [\"0-14\"]}, {\"vertices\": [\"5-24\"]}]}", "....."
                                                                                          "....."
                                                                                          "#####"
                                                                                          "#####"
                                                                                          ".....");
    assert_selects("{\"any\": [{\"vertices\": [0]}, {\"not\": {\"vertices\": [\"0-23\"]}}]}",
                   "....#"
                   "....."
                   "....."
                   "....."
                   "#....");
}

/* Edges are 10 mm, and 14.1 mm along the diagonal that each cell has. */
static void within_measures_along_edges(void **state)
{
    (void)state;
    assert_selects("{\"within\": {\"mm\": 10, \"of\": 12}}", "....."
                                                             "..#.."
                                                             ".###."
                                                             "..#.."
                                                             ".....");
    assert_selects("{\"within\": {\"mm\": 14.2, \"of\": 12}}", "....."
                                                               "..##."
                                                               ".###."
                                                               ".##.."
                                                               ".....");
    assert_selects("{\"within\": {\"mm\": 0, \"of\": 3}}", "....."
                                                           "....."
                                                           "....."
                                                           "....."
                                                           "...#.");
}

static void within_does_not_cross_a_slit(void **state)
{
    (void)state;
    mesh m = make_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    m.triangle_count -= 16; /* the upper two rows of cells: vertices 15..24 are alone */
    m.part[0].triangle_count = m.triangle_count;
    assert_int_equal(select_on(out, &m, "{\"within\": {\"mm\": 1000, \"of\": 12}}", &err), MRT_OK);
    assert_true(out[14] > 0.5f && out[17] < 0.5f);
    mesh_destroy(&m);
}

static mesh make_named_sheet(void)
{
    mesh m = make_sheet();
    m.part = realloc(m.part, 2 * sizeof *m.part);
    if (!m.part)
        abort();
    free(m.part[0].name);
    m.part[0] = (mesh_part){.name = strdup("lip_upper"), .triangle_count = 8, .vertex_count = 10};
    m.part[1] = (mesh_part){.name = strdup("skin"),
                            .first_triangle = 8,
                            .triangle_count = 24,
                            .first_vertex = 5,
                            .vertex_count = 20};
    m.part_count = 2;
    free(m.material[0].name);
    m.material[0].name = strdup("felt");
    m.attribute = calloc(1, sizeof *m.attribute);
    if (!m.attribute)
        abort();
    m.attribute[0] = (mesh_attribute){
        .name = strdup("_JAW"), .component_count = 1, .value = calloc(SHEET_VERTICES, 4)};
    m.attribute_count = 1;
    m.attribute[0].value[3] = 0.25f;
    m.attribute[0].value[4] = 7.0f;
    m.attribute[0].value[5] = -1.0f;
    return m;
}

/* A wide sheet, and a region of `count` times `one`, joined in lists of 200. */
static mrt_result select_many(float *out, const char *one, int count, error *err)
{
    enum { SIDE = 200, TEXT = 1 << 20 };
    mesh m;
    rig r;
    char *text = malloc(TEXT);
    assert_non_null(text);
    size_t at = (size_t)snprintf(text, TEXT,
                                 "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", "
                                 "\"regions\": [{\"mobility\": 1, \"select\": "
                                 "{\"any\": [{\"any\": [");
    for (int i = 0; i < count; ++i)
        at += (size_t)snprintf(text + at, TEXT - at, "%s%s",
                               i == 0         ? ""
                               : i % 200 == 0 ? "]}, {\"any\": ["
                                              : ", ",
                               one);
    (void)snprintf(text + at, TEXT - at, "]}]}}]}");
    assert_int_equal(mesh_create(&m, SIDE * SIDE, (SIDE - 1) * (SIDE - 1), err), MRT_OK);
    for (uint32_t v = 0; v < SIDE * SIDE; ++v) {
        m.position[v * 3 + 0] = (float)(v % SIDE);
        m.position[v * 3 + 1] = (float)(v / SIDE);
    }
    for (uint32_t i = 0; i < m.triangle_count; ++i) {
        const uint32_t a = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
        const uint32_t triangle[3] = {a, a + 1, a + SIDE};
        memcpy(m.triangle + (size_t)i * 3, triangle, sizeof triangle);
    }
    topology t = make_topology(&m);
    mrt_result result = rig_from(&r, text, err);
    if (result < 0)
        fail_msg("%s", err->text);
    free(text);
    float *share = calloc(SIDE * SIDE, sizeof *share);
    assert_non_null(share);
    result = bind_select(share, &r.region[0].select, &m, &t, err);
    memcpy(out, share, SHEET_VERTICES * sizeof *out);
    free(share);
    topology_destroy(&t);
    mesh_destroy(&m);
    rig_destroy(&r);
    return result;
}

static void selectors_that_would_stall_the_program_are_refused_with_their_place(void **state)
{
    (void)state;
    float out[SHEET_VERTICES];
    error err = {""};
    /* A face's worth of them is no matter, however wide. */
    assert_int_equal(select_many(out, "{\"within\": {\"mm\": 5, \"of\": 3}}", 1000, &err), MRT_OK);
    assert_true(out[8] > 0.5f && out[9] < 0.5f);
    assert_int_equal(select_many(out, "{\"within\": {\"mm\": 1e6, \"of\": 3}}", 20, &err), MRT_OK);
    assert_int_equal(select_many(out, "{\"not\": {\"vertices\": [1]}}", 1000, &err), MRT_OK);
    assert_true(out[0] > 0.5f);
    assert_int_equal(select_many(out, "{\"within\": {\"mm\": 1e6, \"of\": 3}}", 2000, &err),
                     MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "$.regions[0].select.any[0].any["));
    assert_non_null(strstr(err.text, "steps of work, the limit for a rig on a mesh of"));
}

/* Each of them is a run over the mesh if it is done one vertex after the other. */
static void a_hundred_thousand_ranges_of_all_vertices_are_one(void **state)
{
    (void)state;
    enum { RANGES = 100000 };
    static char text[RANGES * 10 + 256];
    size_t at = (size_t)snprintf(text, sizeof text,
                                 "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", "
                                 "\"regions\": [{\"mobility\": 1, \"select\": "
                                 "{\"vertices\": [3");
    for (int i = 0; i < RANGES; ++i)
        at += (size_t)snprintf(text + at, 16, ",\"5-%d\"", 6 + i % 10);
    (void)snprintf(text + at, 16, "]}}]}");
    rig r;
    error err = {""};
    float out[SHEET_VERTICES];
    if (rig_from(&r, text, &err) < 0)
        fail_msg("%s", err.text);
    mesh m = make_sheet();
    topology t = make_topology(&m);
    assert_int_equal(bind_select(out, &r.region[0].select, &m, &t, &err), MRT_OK);
    for (int v = 0; v < SHEET_VERTICES; ++v)
        assert_true((out[v] > 0.5f) == (v == 3 || (v >= 5 && v <= 15)));
    topology_destroy(&t);
    mesh_destroy(&m);
    rig_destroy(&r);
}

static void groups_match_parts_and_materials(void **state)
{
    (void)state;
    mesh m = make_named_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    assert_int_equal(select_on(out, &m, "{\"group\": \"lip*\"}", &err), MRT_OK);
    assert_true(out[9] > 0.5f && out[10] < 0.5f);
    assert_int_equal(select_on(out, &m, "{\"group\": \"felt\"}", &err), MRT_OK);
    assert_true(out[0] > 0.5f && out[24] > 0.5f);
    assert_true(select_on(out, &m, "{\"group\": \"lip\"}", &err) < 0);
    assert_non_null(strstr(err.text, "$.regions[0].select.group: the mesh has no part or material "
                                     "\"lip\"; it has: lip_upper, skin, felt"));
    mesh_destroy(&m);
}

static void attributes_give_shares(void **state)
{
    (void)state;
    mesh m = make_named_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    assert_int_equal(select_on(out, &m, "{\"attribute\": \"_JAW\"}", &err), MRT_OK);
    assert_true(fabsf(out[3] - 0.25f) < 1e-7f && fabsf(out[4] - 1.0f) < 1e-7f && out[5] <= 0.0f);
    assert_true(select_on(out, &m, "{\"attribute\": \"_CHIN\"}", &err) < 0);
    assert_non_null(strstr(err.text, "no vertex attribute \"_CHIN\" (it has: _JAW)"));
    mesh_destroy(&m);
}

/* The sheet without its middle column of cells: two pieces. */
static mesh make_torn_sheet(void)
{
    mesh m = make_sheet();
    uint32_t kept = 0;
    for (uint32_t i = 0; i < m.triangle_count; ++i) {
        const uint32_t *corner = m.triangle + (size_t)i * 3;
        if (corner[0] % SHEET_SIDE == 2)
            continue;
        memmove(m.triangle + (size_t)kept++ * 3, corner, 3 * sizeof *corner);
    }
    m.triangle_count = m.part[0].triangle_count = kept;
    return m;
}

static void pieces_are_found_by_a_vertex_and_by_where_they_lie(void **state)
{
    (void)state;
    mesh m = make_torn_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    assert_int_equal(select_on(out, &m, "{\"piece\": 8}", &err), MRT_OK);
    for (uint32_t v = 0; v < SHEET_VERTICES; ++v)
        assert_true((out[v] > 0.5f) == (v % SHEET_SIDE > 2));
    assert_int_equal(select_on(out, &m,
                               "{\"pieces_inside\": {\"box\": {\"low\": [-30, -30, -1], "
                               "\"high\": [15, 30, 1]}}}",
                               &err),
                     MRT_OK);
    for (uint32_t v = 0; v < SHEET_VERTICES; ++v)
        assert_true((out[v] > 0.5f) == (v % SHEET_SIDE <= 2));
    assert_true(select_on(out, &m, "{\"piece\": 25}", &err) < 0);
    assert_non_null(
        strstr(err.text, "select.piece: vertex 25 does not exist, the mesh has 25 vertices"));
    mesh_destroy(&m);
}

static void joints_give_the_shares_of_what_hangs_on_them(void **state)
{
    (void)state;
    mesh m = make_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    m.joint = calloc(3, sizeof *m.joint);
    m.joint_count = 3;
    m.joint[0] = (mesh_joint){.name = strdup("Hips"), .role = strdup(""), .parent = MESH_NO_JOINT};
    m.joint[1] = (mesh_joint){.name = strdup("Head"), .role = strdup(""), .parent = 0};
    m.joint[2] = (mesh_joint){.name = strdup("LeftEye"), .role = strdup(""), .parent = 1};
    m.skin_joint = calloc((size_t)SHEET_VERTICES * MESH_SKIN_WIDTH, sizeof *m.skin_joint);
    m.skin_weight = calloc((size_t)SHEET_VERTICES * MESH_SKIN_WIDTH, sizeof *m.skin_weight);
    m.skin_joint[0] = 1; /* vertex 0: half Head, a quarter each of the eye and the hips */
    m.skin_joint[1] = 2;
    m.skin_weight[0] = 0.5f;
    m.skin_weight[1] = m.skin_weight[2] = 0.25f;
    assert_int_equal(select_on(out, &m, "{\"joint\": \"Head\"}", &err), MRT_OK);
    assert_true(out[0] > 0.7499f && out[0] < 0.7501f && out[1] < 0.5f);
    assert_int_equal(select_on(out, &m, "{\"joint\": \"LeftEye\"}", &err), MRT_OK);
    assert_true(out[0] > 0.2499f && out[0] < 0.2501f);
    assert_true(select_on(out, &m, "{\"joint\": \"Jaw\"}", &err) < 0);
    assert_non_null(strstr(err.text, "has no joint \"Jaw\"; it has: Hips, Head, LeftEye"));
    mesh_destroy(&m);
}

/* Two parts that meet along a seam: the point belongs to both. */
static void a_point_is_selected_as_a_whole(void **state)
{
    (void)state;
    mesh m = make_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    m.point = calloc(SHEET_VERTICES, sizeof *m.point);
    m.smooth = calloc(SHEET_VERTICES, sizeof *m.smooth);
    for (uint32_t v = 0; v < SHEET_VERTICES; ++v)
        m.point[v] = m.smooth[v] = v == 13 ? 12 : v;
    assert_int_equal(select_on(out, &m, "{\"vertices\": [13]}", &err), MRT_OK);
    assert_true(out[12] > 0.5f && out[13] > 0.5f && out[14] < 0.5f);
    assert_int_equal(select_on(out, &m, "{\"not\": {\"vertices\": [12]}}", &err), MRT_OK);
    assert_true(out[12] < 0.5f && out[13] < 0.5f && out[14] > 0.5f);
    mesh_destroy(&m);
}

static void vertices_that_are_not_there_are_refused(void **state)
{
    (void)state;
    mesh m = make_sheet();
    float out[SHEET_VERTICES];
    error err = {""};
    assert_true(select_on(out, &m, "{\"vertices\": [\"20-25\"]}", &err) < 0);
    assert_non_null(strstr(err.text, "vertex 25 does not exist, the mesh has 25 vertices"));
    assert_true(select_on(out, &m, "{\"within\": {\"mm\": 1, \"of\": 25}}", &err) < 0);
    assert_non_null(strstr(err.text, "$.regions[0].select.within.of"));
    mesh_destroy(&m);
}

/* ---- regions ---- */

#define TWO_BONES "\"bones\": [{\"name\": \"skull\"}, {\"name\": \"jaw\"}], \"regions\": "

static mrt_result mark(bind_marks *out, const char *regions, error *err)
{
    char body[1024];
    (void)snprintf(body, sizeof body, TWO_BONES "[%s]", regions);
    rig r;
    if (rig_with(&r, body, err) != MRT_OK)
        fail_msg("%s", err->text);
    mesh m = make_sheet();
    topology t = make_topology(&m);
    mrt_result result = bind_marks_create(out, &r, &m, &t, err);
    topology_destroy(&t);
    mesh_destroy(&m);
    rig_destroy(&r);
    return result;
}

static void assert_weights(const bind_marks *marks, uint32_t vertex, float skull, float jaw)
{
    float found[] = {marks->weight[vertex], marks->weight[SHEET_VERTICES + vertex]};
    const float expected[] = {skull, jaw};
    for (int i = 0; i < 2; ++i)
        if (isnan(expected[i]) ? !isnan(found[i]) : !(fabsf(found[i] - expected[i]) < 1e-6f))
            fail_msg("vertex %u, bone %d: %g, expected %g", vertex, i, (double)found[i],
                     (double)expected[i]);
}

static void later_regions_win_and_rigid_ones_over_all(void **state)
{
    (void)state;
    bind_marks marks;
    error err = {""};
    assert_int_equal(mark(&marks,
                          "{\"bone\": \"skull\", \"rigid\": true, \"select\": {\"vertices\": [0]}},"
                          "{\"bone\": \"skull\", \"weight\": 1, \"mobility\": 1,"
                          " \"select\": {\"vertices\": [1, 2]}},"
                          "{\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"vertices\": [0, 2]}},"
                          "{\"mobility\": 0.5, \"select\": {\"vertices\": [2]}}",
                          &err),
                     MRT_OK);
    assert_weights(&marks, 0, 1.0f, 0.0f);
    assert_weights(&marks, 1, 1.0f, 0.0f);
    assert_weights(&marks, 2, 0.0f, 1.0f);
    assert_weights(&marks, 3, NAN, NAN);
    assert_int_equal(marks.rigid_bone[0], 0);
    assert_int_equal(marks.rigid_bone[1], RIG_NONE);
    assert_true(marks.mobility[0] <= 0.0f);
    assert_true(fabsf(marks.mobility[1] - 1.0f) < 1e-6f);
    assert_true(fabsf(marks.mobility[2] - 0.5f) < 1e-6f);
    assert_true(isnan(marks.mobility[3]));
    bind_marks_destroy(&marks);
}

static void shares_make_room_for_later_ones(void **state)
{
    (void)state;
    bind_marks marks;
    error err = {""};
    assert_int_equal(
        mark(&marks,
             "{\"bone\": \"skull\", \"weight\": 0.8, \"select\": {\"vertices\": [0, 1, 2]}},"
             "{\"bone\": \"jaw\", \"weight\": 0.1, \"select\": {\"vertices\": [1]}},"
             "{\"bone\": \"jaw\", \"weight\": 0.6, \"select\": {\"vertices\": [2]}}",
             &err),
        MRT_OK);
    assert_weights(&marks, 0, 0.8f, NAN);
    assert_weights(&marks, 1, 0.8f, 0.1f);
    assert_weights(&marks, 2, 0.4f, 0.6f);
    bind_marks_destroy(&marks);
}

static void overlapping_rigid_regions_are_refused(void **state)
{
    (void)state;
    bind_marks marks;
    error err = {""};
    assert_true(
        mark(&marks,
             "{\"bone\": \"skull\", \"rigid\": true, \"select\": {\"vertices\": [\"0-9\"]}},"
             "{\"bone\": \"jaw\", \"rigid\": true, \"select\": {\"vertices\": [\"7-20\"]}}",
             &err) < 0);
    assert_string_equal(err.text, "$.regions[1]: overlaps $.regions[0]: vertex 7 would be rigid on "
                                  "\"jaw\" and on \"skull\"; remove it from one of them");
    assert_null(marks.weight);
}

static void a_bone_without_vertices_is_refused(void **state)
{
    (void)state;
    bind_marks marks;
    error err = {""};
    assert_true(mark(&marks,
                     "{\"bone\": \"skull\", \"rigid\": true, \"select\": {\"vertices\": [1]}},"
                     "{\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"vertices\": [1]}}",
                     &err) < 0);
    assert_non_null(strstr(err.text, "$.bones[1]: no vertex belongs to the bone \"jaw\""));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_select_what_is_in_them),
        cmocka_unit_test(joined_selectors_are_least_and_greatest),
        cmocka_unit_test(within_measures_along_edges),
        cmocka_unit_test(within_does_not_cross_a_slit),
        cmocka_unit_test(selectors_that_would_stall_the_program_are_refused_with_their_place),
        cmocka_unit_test(a_hundred_thousand_ranges_of_all_vertices_are_one),
        cmocka_unit_test(groups_match_parts_and_materials),
        cmocka_unit_test(attributes_give_shares),
        cmocka_unit_test(pieces_are_found_by_a_vertex_and_by_where_they_lie),
        cmocka_unit_test(joints_give_the_shares_of_what_hangs_on_them),
        cmocka_unit_test(a_point_is_selected_as_a_whole),
        cmocka_unit_test(vertices_that_are_not_there_are_refused),
        cmocka_unit_test(later_regions_win_and_rigid_ones_over_all),
        cmocka_unit_test(shares_make_room_for_later_ones),
        cmocka_unit_test(overlapping_rigid_regions_are_refused),
        cmocka_unit_test(a_bone_without_vertices_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
