/* Painted weights in rig files, and edits of a rig in memory: what is written is read again, what
 * is not ours is kept, what makes no sense is refused with its place. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "face/bind.h"
#include "face/rig_edit.h"
#include "rig_help.h"

#include <math.h>
#include <unistd.h>

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/marotte_paint_XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static const char *in_folder(const char *name)
{
    static char path[4][160];
    static int next;
    next = (next + 1) % 4;
    (void)snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void put(const char *name, const char *text)
{
    error err = {""};
    must(file_write(in_folder(name), text, strlen(text), &err), &err);
}

static rig read_rig(const char *name)
{
    rig r;
    error err = {""};
    must(rig_read(&r, in_folder(name), &err), &err);
    return r;
}

/* The text that the rig is written as. */
static void written(char *out, size_t capacity, const rig *r, const char *name)
{
    error err = {""};
    file_bytes bytes;
    must(rig_write(r, in_folder(name), &err), &err);
    must(file_read(&bytes, in_folder(name), capacity - 1, &err), &err);
    memcpy(out, bytes.data, bytes.size + 1);
    file_bytes_finish(&bytes);
}

#define BONES                                                                                      \
    "\"bones\": [{\"name\": \"skull\"}, {\"name\": \"jaw\", \"hinge\": {\"left\": [50, 0, 0], "    \
    "\"right\": [-50, 0, 0]}}]"
static const char head[] =
    "{\n"
    "  \"marotte_rig\": 1,\n"
    "  \"mesh\": \"m.obj\",\n"
    "  \"bones\": [\n"
    "    {\"name\": \"skull\"},\n"
    "    {\"name\": \"jaw\", \"hinge\": {\"left\": [50, 0, 0], \"right\": [-50, 0, 0]}}\n"
    "  ],\n"
    "  \"regions\": [\n"
    "    {\"bone\": \"skull\", \"weight\": 1, \"select\": {\"vertices\": [20]}, \"why\": "
    "\"top\"},\n"
    "    {\"name\": \"chin\", \"bone\": \"jaw\", \"weight\": 1, \"select\": {\"painted\": "
    "\"low\"}, "
    "\"who\": \"Ana\"}\n"
    "  ],\n"
    "  \"contacts\": [\n"
    "    {\"name\": \"a.l\", \"vertex\": 4, \"mirror\": \"a.r\", \"felt\": true},\n"
    "    {\"name\": \"a.r\", \"vertex\": 0, \"mirror\": \"a.l\"}\n"
    "  ],\n"
    "  \"poses\": [\n"
    "    {\"name\": \"open\", \"pulls\": {\"a.l\": [0, 1, 0], \"a.r\": [0, 1, 0]}}\n"
    "  ],\n"
    "  \"contact_sets\": {\n"
    "    \"all\": [\"a.l\", \"a.r\"]\n"
    "  },\n"
    "  \"paints\": {\n"
    "    \"low\": [\"2:40ff80\", \"7-14:ff\"],\n"
    "    \"spare\": [\"1:10\"]\n"
    "  }\n"
    "}\n";

/* ---- the format ---- */

static void paint_is_a_share_of_each_vertex(void **state)
{
    (void)state;
    error err = {""};
    float share[SHEET_VERTICES];
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    mesh m = make_sheet();
    topology t = make_topology(&m);
    must(bind_select(share, &r.region[1].select, &m, &t, &err), &err);
    assert_true(share[1] <= 0.0f);
    assert_true(fabsf(share[2] - 64.0f / 255.0f) < 1e-6f);
    assert_true(share[3] >= 1.0f);
    assert_true(fabsf(share[4] - 128.0f / 255.0f) < 1e-6f);
    assert_true(share[6] <= 0.0f && share[7] >= 1.0f && share[14] >= 1.0f && share[15] <= 0.0f);
    topology_destroy(&t);
    mesh_destroy(&m);
    rig_destroy(&r);
}

static void what_is_read_and_written_is_the_same_text(void **state)
{
    (void)state;
    char text[4096];
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json"), copy;
    error err = {""};
    must(rig_copy(&copy, &r, &err), &err);
    rig_destroy(&r);
    written(text, sizeof text, &copy, "out.rig.json");
    assert_string_equal(text, head);
    rig_destroy(&copy);
}

static void what_is_painted_anew_is_read_again(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    uint8_t value[SHEET_VERTICES] = {0}, again[SHEET_VERTICES];
    for (uint32_t v = 3; v < SHEET_VERTICES; ++v)
        value[v] = v < 12 ? 200 : (uint8_t)(v * 7);
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    must(rig_edit_paint(&r, 1, value, SHEET_VERTICES, &err), &err);
    assert_string_equal(r.region[1].select.name, "low");
    written(text, sizeof text, &r, "out.rig.json");
    assert_non_null(strstr(text, "\"3-11:c8\""));
    assert_non_null(strstr(text, "\"spare\": [\"1:10\"]"));
    rig_destroy(&r);
    r = read_rig("out.rig.json");
    rig_edit_values(again, &r, 1, SHEET_VERTICES);
    assert_memory_equal(value, again, sizeof value);
    rig_destroy(&r);
}

static void what_is_whole_is_written_as_vertices_and_its_paint_goes(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    uint8_t value[SHEET_VERTICES] = {0};
    memset(value + 5, 255, 5);
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    must(rig_edit_paint(&r, 1, value, SHEET_VERTICES, &err), &err);
    assert_int_equal(r.region[1].select.kind, SELECT_VERTICES);
    written(text, sizeof text, &r, "out.rig.json");
    assert_non_null(strstr(text, "\"select\": {\"vertices\": [\"5-9\"]}, \"who\": \"Ana\""));
    assert_null(strstr(text, "\"low\""));
    assert_non_null(strstr(text, "\"spare\""));
    rig_destroy(&r);
}

static void paint_goes_with_the_region_whose_pieces_lie_in_it(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    put("a.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", " BONES ", \"regions\": "
                      "[{\"bone\": \"skull\", \"weight\": 1, \"select\": {\"vertices\": [0]}}, "
                      "{\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"all\": "
                      "[{\"pieces_inside\": {\"not\": {\"painted\": \"low\"}}}]}}], "
                      "\"paints\": {\"low\": [\"2:40\"], \"spare\": [\"1:10\"]}}");
    rig r = read_rig("a.rig.json");
    must(rig_edit_remove_region(&r, 1, &err), &err);
    written(text, sizeof text, &r, "out.rig.json");
    assert_null(strstr(text, "\"low\""));
    assert_non_null(strstr(text, "\"spare\""));
    rig_destroy(&r);
}

static void two_paints_never_share_a_name(void **state)
{
    (void)state;
    error err = {""};
    uint8_t value[SHEET_VERTICES] = {0};
    value[3] = 9;
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    uint32_t index;
    rig_edit_region_values says = {1, false, 0.5, (double)NAN};
    must(rig_edit_add_region(&r, "low", &says, &index, &err), &err);
    must(rig_edit_paint(&r, index, value, SHEET_VERTICES, &err), &err);
    must(rig_edit_name_region(&r, 0, "spare", &err), &err);
    must(rig_edit_paint(&r, 0, value, SHEET_VERTICES, &err), &err);
    assert_string_equal(r.region[index].select.name, "low 2");
    assert_string_equal(r.region[0].select.name, "spare 2");
    rig_destroy(&r);
}

static void included_paint_is_written_with_the_rest(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    uint8_t value[SHEET_VERTICES] = {0};
    value[3] = 9;
    put("a.rig.json", head);
    put("b.rig.json", "{\"marotte_rig\": 1, \"include\": \"a.rig.json\", \"mesh\": \"m.obj\"}");
    rig r = read_rig("b.rig.json");
    must(rig_edit_paint(&r, 1, value, SHEET_VERTICES, &err), &err);
    written(text, sizeof text, &r, "c.rig.json");
    assert_null(strstr(text, "\"include\""));
    assert_non_null(strstr(text, "\"low\": [\"3:09\"]"));
    assert_non_null(strstr(text, "\"spare\""));
    rig_destroy(&r);
    r = read_rig("c.rig.json");
    assert_int_equal(r.region[1].select.range_count, 1);
    assert_int_equal(r.region[1].select.value[0], 9);
    rig_destroy(&r);
}

static void paint_that_many_regions_use_is_paid_out_of_the_budget(void **state)
{
    (void)state;
    enum { VALUES = 1 << 20, USES = 200 };
    static char text[2 * VALUES + USES * 64 + 1024];
    rig r;
    error err = {""};
    size_t at = (size_t)snprintf(text, sizeof text,
                                 "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"paints\": "
                                 "{\"p\": [\"0:");
    memset(text + at, '0', 2 * VALUES);
    at += 2 * VALUES;
    at += (size_t)snprintf(text + at, 256,
                           "\"]}, \"regions\": [{\"mobility\": 1, \"select\": "
                           "{\"any\": [");
    for (int i = 0; i < USES; ++i)
        at += (size_t)snprintf(text + at, 32, "%s{\"painted\": \"p\"}", i ? "," : "");
    (void)snprintf(text + at, 32, "]}}]}");
    assert_int_equal(rig_from(&r, text, &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "$.paints.p: it needs more than"));
}

static void paint_that_makes_no_sense_is_refused_with_its_place(void **state)
{
    (void)state;
    static const char *const wrong[] = {"\"5\"",
                                        "\"5:f\"",
                                        "\"5:FF\"",
                                        "\"9-5:ff\"",
                                        "\"5-9:ffff\"",
                                        "\"-5:ff\"",
                                        "\"5-6-7:ff\"",
                                        "\"5:\"",
                                        "\"2147483647:ff\"",
                                        "7",
                                        "\"1:ff\", \"1:ff\"",
                                        "\"2147483646:ffff\""};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
        char text[1024];
        rig r;
        error err = {""};
        (void)snprintf(text, sizeof text,
                       BONES ", \"regions\": [{\"bone\": \"jaw\", \"weight\": 1, \"select\": "
                             "{\"painted\": \"x\"}}], \"paints\": {\"x\": [%s]}",
                       wrong[i]);
        if (rig_with(&r, text, &err) >= 0)
            fail_msg("%s was taken", wrong[i]);
        if (!strstr(err.text, "$.paints.x["))
            fail_msg("%s: %s", wrong[i], err.text);
    }
}

static void paint_that_is_not_there_is_named(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    assert_true(rig_with(&r,
                         BONES ", \"regions\": [{\"bone\": \"jaw\", \"weight\": 1, \"select\": "
                               "{\"painted\": \"gone\"}}]",
                         &err) < 0);
    assert_non_null(strstr(err.text, "$.regions[0].select.painted: the rig has no paint \"gone\""));
}

static void paint_beyond_the_mesh_is_found(void **state)
{
    (void)state;
    rig r;
    float share[SHEET_VERTICES];
    error err = {""};
    must(rig_with(&r,
                  BONES ", \"regions\": [{\"bone\": \"jaw\", \"weight\": 1, \"select\": "
                        "{\"painted\": \"x\"}}], \"paints\": {\"x\": [\"24:10ff\"]}",
                  &err),
         &err);
    mesh m = make_sheet();
    topology t = make_topology(&m);
    assert_true(bind_select(share, &r.region[0].select, &m, &t, &err) < 0);
    assert_non_null(strstr(err.text, "vertex 25, but the mesh has 25"));
    topology_destroy(&t);
    mesh_destroy(&m);
    rig_destroy(&r);
}

/* ---- edits ---- */

static void regions_take_what_is_not_ours_with_them(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    must(rig_edit_move_region(&r, 1, 0, &err), &err);
    assert_string_equal(r.region[0].select.path, "$.regions[0].select");
    must(rig_edit_name_region(&r, 1, "top", &err), &err);
    must(rig_edit_name_region(&r, 0, "", &err), &err);
    written(text, sizeof text, &r, "out.rig.json");
    const char *first = strstr(text, "\"who\": \"Ana\""),
               *second = strstr(text, "\"why\": \"top\"");
    assert_true(first && second && first < second);
    assert_non_null(strstr(text, "\"name\": \"top\""));
    assert_null(strstr(text, "\"name\": \"chin\""));
    rig_destroy(&r);
    r = read_rig("out.rig.json");
    assert_string_equal(r.region[1].name, "top");
    rig_destroy(&r);
}

static void a_contact_keeps_its_links_under_another_name(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    must(rig_edit_name_contact(&r, 0, "b.l", &err), &err);
    written(text, sizeof text, &r, "out.rig.json");
    assert_non_null(strstr(text, "{\"name\": \"b.l\", \"vertex\": 4, \"mirror\": \"a.r\", "
                                 "\"felt\": true}"));
    assert_non_null(strstr(text, "\"mirror\": \"b.l\""));
    assert_non_null(strstr(text, "\"all\": [\"b.l\", \"a.r\"]"));
    assert_null(strstr(text, "a.l"));
    rig_destroy(&r);
    r = read_rig("out.rig.json");
    assert_int_equal(r.pose[0].pull_count, 2);
    rig_destroy(&r);
}

static void a_contact_that_goes_leaves_no_links(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    must(rig_edit_remove_contact(&r, 0, &err), &err);
    assert_int_equal(r.contact[0].mirror, RIG_NONE);
    written(text, sizeof text, &r, "out.rig.json");
    assert_null(strstr(text, "a.l"));
    rig_destroy(&r);
    r = read_rig("out.rig.json");
    assert_int_equal(r.contact_count, 1);
    assert_int_equal(r.pose[0].pull_count, 1);
    assert_int_equal(r.pose[0].pull_contact[0], 0);
    assert_int_equal(r.contact_set[0].contact_count, 1);
    rig_destroy(&r);
}

static void a_contact_is_mirrored_by_its_name(void **state)
{
    (void)state;
    error err = {""};
    uint32_t index;
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    must(rig_edit_add_contact(&r, "brow.l", 8, &index, &err), &err);
    must(rig_edit_mirror_contact(&r, index, 6, &err), &err);
    uint32_t other = rig_find_contact(&r, "brow.r");
    assert_int_equal(r.contact[other].vertex, 6);
    assert_int_equal(r.contact[other].mirror, index);
    assert_int_equal(r.contact[index].mirror, other);
    must(rig_edit_add_contact(&r, "chin", 2, &index, &err), &err);
    assert_true(rig_edit_mirror_contact(&r, index, 6, &err) < 0);
    assert_non_null(strstr(err.text, "chin.l"));
    assert_true(rig_edit_add_contact(&r, "chin", 2, &index, &err) < 0);
    assert_true(rig_edit_name_contact(&r, index, "", &err) < 0);
    assert_true(rig_edit_name_contact(&r, index, "a\nb", &err) < 0);
    rig_destroy(&r);
}

static void regions_say_only_what_a_file_may_say(void **state)
{
    (void)state;
    error err = {""};
    uint32_t index;
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    const double none = (double)NAN;
    const rig_edit_region_values wrong[] = {{RIG_NONE, false, 1.0, none}, {0, true, 1.0, none},
                                            {0, false, none, none},       {0, false, 1.5, none},
                                            {9, false, 1.0, none},        {0, false, none, -0.1}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i)
        assert_true(rig_edit_set_region(&r, 0, &wrong[i], &err) < 0);
    assert_true(rig_edit_add_region(&r, "chin", &(rig_edit_region_values){0, true, none, none},
                                    &index, &err) < 0);
    assert_int_equal(r.region_count, 2);
    assert_true(rig_edit_remove_region(&r, 2, &err) < 0);
    rig_destroy(&r);
}

static void the_jaw_keeps_an_axis_and_limits(void **state)
{
    (void)state;
    error err = {""};
    rig_edit_jaw jaw;
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    rig_edit_jaw_of(&jaw, &r, 1);
    jaw.left.y = 12.5;
    jaw.has_incisor = true;
    jaw.incisor = (vec3){0.0, -40.0, 70.0};
    must(rig_edit_set_jaw(&r, 1, &jaw, &err), &err);
    rig_edit_jaw wrong = jaw;
    wrong.left.x = -60.0;
    assert_true(rig_edit_set_jaw(&r, 1, &wrong, &err) < 0);
    wrong = jaw;
    wrong.open_max_rad = (double)NAN;
    assert_true(rig_edit_set_jaw(&r, 1, &wrong, &err) < 0);
    assert_true(rig_edit_set_jaw(&r, 0, &jaw, &err) < 0);
    must(rig_write(&r, in_folder("out.rig.json"), &err), &err);
    rig_destroy(&r);
    r = read_rig("out.rig.json");
    assert_true(fabs(r.bone[1].hinge_left.y - 12.5) < 1e-9);
    assert_true(r.bone[1].has_incisor && fabs(r.bone[1].incisor.z - 70.0) < 1e-9);
    rig_destroy(&r);
}

static void places_in_messages_are_found_again(void **state)
{
    (void)state;
    uint32_t index;
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    assert_int_equal(rig_edit_kind_at(&r, "$.regions[1].select", &index), RIG_EDIT_REGION);
    assert_int_equal(index, 1);
    assert_int_equal(rig_edit_kind_at(&r, "$.contacts[0]", &index), RIG_EDIT_CONTACT);
    assert_int_equal(index, 0);
    assert_int_equal(rig_edit_kind_at(&r, "$.bones[1].hinge", &index), RIG_EDIT_BONE);
    assert_int_equal(rig_edit_kind_at(&r, "$.regions[12]", &index), RIG_EDIT_OTHER);
    assert_int_equal(rig_edit_kind_at(&r, "$", &index), RIG_EDIT_OTHER);
    rig_destroy(&r);
}

static void selectors_are_described(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    char words[200];
    must(rig_with(&r,
                  BONES
                  ", \"regions\": [{\"bone\": \"jaw\", \"rigid\": true, \"select\": {\"all\": "
                  "[{\"group\": \"skin\"}, {\"not\": {\"within\": {\"mm\": 30, \"of\": 4}}}, "
                  "{\"any\": [{\"attribute\": \"_A\"}, {\"vertices\": [\"3-5\"]}]}]}}]",
                  &err),
         &err);
    rig_edit_describe(&r.region[0].select, words, sizeof words);
    assert_string_equal(words, "part skin, not within 30 mm of vertex 4, (attribute _A or "
                               "3 vertices)");
    rig_edit_describe(&r.region[0].select, words, 12);
    assert_string_equal(words, "part skin, ");
    rig_destroy(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paint_is_a_share_of_each_vertex),
        cmocka_unit_test(what_is_read_and_written_is_the_same_text),
        cmocka_unit_test(what_is_painted_anew_is_read_again),
        cmocka_unit_test(what_is_whole_is_written_as_vertices_and_its_paint_goes),
        cmocka_unit_test(paint_goes_with_the_region_whose_pieces_lie_in_it),
        cmocka_unit_test(two_paints_never_share_a_name),
        cmocka_unit_test(included_paint_is_written_with_the_rest),
        cmocka_unit_test(paint_that_many_regions_use_is_paid_out_of_the_budget),
        cmocka_unit_test(paint_that_makes_no_sense_is_refused_with_its_place),
        cmocka_unit_test(paint_that_is_not_there_is_named),
        cmocka_unit_test(paint_beyond_the_mesh_is_found),
        cmocka_unit_test(regions_take_what_is_not_ours_with_them),
        cmocka_unit_test(a_contact_keeps_its_links_under_another_name),
        cmocka_unit_test(a_contact_that_goes_leaves_no_links),
        cmocka_unit_test(a_contact_is_mirrored_by_its_name),
        cmocka_unit_test(regions_say_only_what_a_file_may_say),
        cmocka_unit_test(the_jaw_keeps_an_axis_and_limits),
        cmocka_unit_test(places_in_messages_are_found_again),
        cmocka_unit_test(selectors_are_described),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
