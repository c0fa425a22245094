/* What is read from a rig file, and what is refused with which words. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "rig_help.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static const char whole[] =
    "{\"marotte_rig\": 1, \"name\": \"head\", \"mesh\": \"head.glb\", \"unit\": \"m\","
    " \"mesh_vertices\": 25, \"mesh_hash\": \"00000000000000ff\","
    " \"bones\": [{\"name\": \"skull\"},"
    "  {\"name\": \"jaw\", \"hinge\": {\"left\": [0.06, 0.01, 0], \"right\": [-0.06, 0.01, 0]},"
    "   \"open_deg\": [-2, 30], \"lateral_mm\": 9, \"incisor\": [0, -0.05, 0.08]},"
    "  {\"name\": \"eye.l\", \"ball\": {\"centre\": [0.03, 0.06, 0.07], \"radius_mm\": 12},"
    "   \"turns\": [{\"name\": \"yaw\", \"axis\": [0, 2, 0], \"deg\": [-35, 35]},"
    "    {\"name\": \"pitch\", \"axis\": [-1, 0, 0], \"deg\": [-25, 20]}]}],"
    " \"regions\": [{\"bone\": \"skull\", \"rigid\": true, \"select\": {\"attribute\": \"_S\"}},"
    "  {\"bone\": \"jaw\", \"weight\": 0.5, \"mobility\": 1,"
    "   \"select\": {\"vertices\": [3, \"7-9\"]}}],"
    " \"contacts\": [{\"name\": \"lip.l\", \"vertex\": 4, \"mirror\": \"lip.r\"},"
    "  {\"name\": \"lip.r\", \"vertex\": 5, \"bone\": \"jaw\", \"mirror\": \"lip.l\"}],"
    " \"contact_sets\": {\"few\": [\"lip.r\"]},"
    " \"skull_proxy\": [{\"ellipsoid\": {\"centre\": [0, 0.05, 0], \"radii\": [0.07, 0.09, 0.08],"
    "  \"bone\": \"skull\"}}],"
    " \"poses\": [{\"name\": \"talk\", \"part\": \"mouth\", \"dofs\": {\"jaw.open\": 15, "
    "\"jaw.lateral\": 2,"
    "  \"eye.l.yaw\": -10}, \"pulls\": {\"lip.l\": [0, 0.002, 0]}}],"
    " \"solver\": {\"kernel\": \"wendland_c4\", \"radius_mm\": 60, \"polynomial\": \"constant\"}}";

static void lengths_are_mm_and_angles_rad_whatever_the_unit(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    assert_int_equal(rig_from(&r, whole, &err), MRT_OK);
    assert_near(r.bone[1].hinge_left.x, 60.0, 1e-9);
    assert_near(r.bone[1].open_min_rad, -2.0 * 0.017453292519943295, 1e-12);
    assert_near(r.bone[1].lateral_mm, 9.0, 0.0);
    assert_near(r.bone[1].forward_mm, 8.0, 0.0); /* an adult's, where nothing is said */
    assert_true(r.bone[1].has_incisor);
    assert_near(r.bone[2].centre.y, 60.0, 1e-9);
    assert_near(r.bone[2].turn[0].axis.y, 1.0, 0.0);
    assert_near(r.proxy[0].radii.y, 90.0, 1e-9);
    assert_near(r.pose[0].dof_value[0], 15.0 * 0.017453292519943295, 1e-12);
    assert_near(r.pose[0].dof_value[1], 2.0, 0.0);
    assert_near(r.pose[0].pull_mm[0].y, 2.0, 1e-9);
    assert_int_equal(r.pose[0].part, POSE_MOUTH);
    rig_destroy(&r);
}

static void names_become_indices(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    assert_int_equal(rig_from(&r, whole, &err), MRT_OK);
    assert_int_equal(r.bone_count, 3);
    assert_int_equal(r.bone[0].parent, RIG_NONE);
    assert_int_equal(r.bone[1].parent, 0);
    assert_int_equal(r.bone[2].parent, 0);
    assert_int_equal(r.region[1].bone, 1);
    assert_int_equal(r.region[1].select.first[1], 7);
    assert_int_equal(r.region[1].select.last[1], 9);
    assert_int_equal(r.contact[0].mirror, 1);
    assert_int_equal(r.contact[0].bone, RIG_NONE);
    assert_int_equal(r.contact[1].bone, 1);
    assert_int_equal(rig_find_contact_set(&r, "few")->contact[0], 1);
    assert_int_equal(rig_find_contact(&r, "nobody"), RIG_NONE);
    assert_int_equal(r.solver.kernel, CSRBF_WENDLAND_C4);
    assert_int_equal(r.mesh_hash, 255);
    assert_null(r.note);
    rig_destroy(&r);
}

static void mesh_path_is_beside_the_rig(void **state)
{
    (void)state;
    static const char text[] = "{\"marotte_rig\": 1, \"mesh\": \"meshes/m.obj\"}";
    rig r;
    error err = {""};
    assert_int_equal(rig_parse(&r, text, strlen(text), "rigs/a/a.rig.json", &err), MRT_OK);
    assert_string_equal(r.mesh_path, "rigs/a/meshes/m.obj");
    assert_string_equal(r.name, "a");
    assert_int_equal(r.bone_count, 1); /* a skull, where no bone is said */
    assert_string_equal(r.bone[0].name, "skull");
    rig_destroy(&r);
}

static void selectors_nest(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    assert_int_equal(
        rig_with(&r,
                 "\"unit\": \"cm\", \"regions\": [{\"mobility\": 0.25, \"select\": {\"all\": ["
                 "{\"not\": {\"group\": \"teeth*\"}},"
                 "{\"any\": [{\"box\": {\"low\": [0,0,0], \"high\": [1,2,3]}},"
                 "{\"ellipsoid\": {\"centre\": [0,0,0], \"radii\": [1,1,1]}},"
                 "{\"half_space\": {\"point\": [0,1,0], \"normal\": [0,1,0]}},"
                 "{\"within\": {\"mm\": 12, \"of\": 3}}]}]}}]",
                 &err),
        MRT_OK);
    const rig_select *any = &r.region[0].select.child[1];
    assert_int_equal(r.region[0].bone, RIG_NONE);
    assert_int_equal(r.region[0].select.child[0].child[0].kind, SELECT_GROUP);
    assert_near(any->child[0].b.z, 30.0, 1e-12); /* cm */
    assert_near(any->child[2].b.y, 1.0, 0.0);    /* a direction has no unit */
    assert_near(any->child[3].within_mm, 12.0, 0.0);
    assert_string_equal(any->child[3].path, "$.regions[0].select.all[1].any[3]");
    rig_destroy(&r);
}

static void unknown_keys_are_listed_and_do_no_harm(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    assert_int_equal(rig_with(&r,
                              "\"colour\": 3, \"bones\": [{\"name\": \"skull\", \"mass\": 2}],"
                              "\"contacts\": [{\"name\": \"a\", \"vertex\": 0, \"why\": null}]",
                              &err),
                     MRT_OK);
    assert_non_null(strstr(r.note, "$.colour: "));
    assert_non_null(strstr(r.note, "$.bones[0].mass: "));
    assert_non_null(strstr(r.note, "$.contacts[0].why: "));
    rig_destroy(&r);
}

/* The message names the file and the place, and says something that helps. */
static void assert_refused(const char *body, const char *place, const char *words)
{
    rig r;
    error err = {""};
    char start[160];
    assert_true(rig_with(&r, body, &err) < 0);
    (void)snprintf(start, sizeof start, "head.rig.json: %s: ", place);
    if (strncmp(err.text, start, strlen(start)) != 0 || !strstr(err.text, words))
        fail_msg("%s\n  expected %s... %s", err.text, start, words);
    assert_null(r.document);
}

static void bones_that_cannot_move_are_refused(void **state)
{
    (void)state;
#define JAW(more)                                                                                  \
    "\"bones\": [{\"name\": \"skull\"}, {\"name\": \"jaw\", \"hinge\": {\"left\": [60, 0, 0], "    \
    "\"right\": [-60, 0, 0]}, " more "}]"
    assert_refused("\"bones\": [{\"name\": \"skull\"}, {\"name\": \"jaw\", \"hinge\": {\"left\": "
                   "[5, 1, 1], \"right\": [5, 1, 1]}}]",
                   "$.bones[1].hinge", "no axis");
    assert_refused(JAW("\"open_deg\": [32, 0]"), "$.bones[1].open_deg", "reversed");
    assert_refused(JAW("\"open_deg\": [5, 32]"), "$.bones[1].open_deg", "does not include 0");
    assert_refused(JAW("\"open_deg\": 32"), "$.bones[1].open_deg", "two angles");
    assert_refused(JAW("\"ball\": {\"centre\": [0,0,0]}"), "$.bones[1]", "both a hinge and a ball");
    assert_refused(JAW("\"parent\": \"neck\""), "$.bones[1].parent", "list parents first");
    assert_refused("\"bones\": [{\"name\": \"e\", \"ball\": {\"centre\": [0,0,0]}, \"turns\": "
                   "[{\"name\": \"yaw\", \"axis\": [0,0,0], \"deg\": [-1,1]}]}]",
                   "$.bones[0].turns[0].axis", "length 0");
    assert_refused("\"bones\": [{\"name\": \"a\"}, {\"name\": \"a\"}]", "$.bones[1]",
                   "already used by");
#undef JAW
}

static void what_a_lid_cannot_follow_is_refused(void **state)
{
    (void)state;
#define LID(follows)                                                                               \
    "\"bones\": [{\"name\": \"skull\"}, {\"name\": \"eye\", \"ball\": {\"centre\": [0,0,0]}, "     \
    "\"turns\": [{\"name\": \"pitch\", \"axis\": [1,0,0], \"deg\": [-9,9]}]}, {\"name\": "         \
    "\"lid\", "                                                                                    \
    "\"ball\": {\"centre\": [0,0,0]}, \"turns\": [{\"name\": \"close\", \"axis\": [1,0,0], "       \
    "\"deg\": [-9,9], \"follows\": " follows "}]}, {\"name\": \"lash\", \"ball\": {\"centre\": "   \
    "[0,0,0]}, \"turns\": [{\"name\": \"bend\", \"axis\": [1,0,0], \"deg\": [-9,9], "              \
    "\"follows\": {\"dof\": \"lid.close\", \"share\": 0.5}}]}]"
#define AT "$.bones[2].turns[0].follows"
    assert_refused(LID("0.5"), AT, "an object with dof and share");
    assert_refused(LID("{\"share\": 0.5}"), AT ".dof", "eye.l.pitch");
    assert_refused(LID("{\"dof\": \"eye.pitch\"}"), AT ".share", "number");
    assert_refused(LID("{\"dof\": \"eye.pitch\", \"share\": 2}"), AT ".share", "1");
    assert_refused(LID("{\"dof\": \"nose.pitch\", \"share\": 0.5}"), AT ".dof", "listed before");
    assert_refused(LID("{\"dof\": \"lash.bend\", \"share\": 0.5}"), AT ".dof", "listed before");
    assert_refused(LID("{\"dof\": \"lid.close\", \"share\": 0.5}"), AT ".dof", "of the same bone");
    assert_refused(LID("{\"dof\": \"eye.pitch\", \"share\": 0.5}"),
                   "$.bones[3].turns[0].follows.dof", "follows another turn itself");
#undef AT
#undef LID
}

static void springs_that_cannot_swing_are_refused(void **state)
{
    (void)state;
#define HAIR(spring)                                                                               \
    "\"bones\": [{\"name\": \"skull\"}, {\"name\": \"hair\", \"ball\": {\"centre\": [0,0,0]}, "    \
    "\"turns\": [{\"name\": \"nod\", \"axis\": [1,0,0], \"deg\": [-20,20]}], \"spring\": " spring  \
    "}]"
#define AT "$.bones[1].spring"
    assert_refused(HAIR("3"), AT, "tip and frequency_hz");
    assert_refused(HAIR("{\"frequency_hz\": 3}"), AT ".tip", "three numbers");
    assert_refused(HAIR("{\"tip\": [0,9,0]}"), AT ".frequency_hz", "from 0.2 to 20");
    assert_refused(HAIR("{\"tip\": [0,9,0], \"frequency_hz\": 0}"), AT ".frequency_hz",
                   "from 0.2 to 20");
    assert_refused(HAIR("{\"tip\": [0,9,0], \"frequency_hz\": 3, \"damping\": -1}"), AT ".damping",
                   "from 0.02 to 4");
    assert_refused(HAIR("{\"tip\": [0,9,0], \"frequency_hz\": 3, \"inertia\": 2}"), AT ".inertia",
                   "from 0 to 1");
    assert_refused(HAIR("{\"tip\": [0,9,0], \"frequency_hz\": 3, \"gravity\": \"g\"}"),
                   AT ".gravity", "from 0 to 1");
    assert_refused(HAIR("{\"tip\": [0,0,0], \"frequency_hz\": 3}"), AT ".tip", "no length");
    assert_refused("\"bones\": [{\"name\": \"skull\"}, {\"name\": \"hat\", \"spring\": {\"tip\": "
                   "[0,9,0], \"frequency_hz\": 3}}]",
                   AT, "only a bone with a ball");
    assert_refused("\"springs\": 2", "$.springs", "from 0 to 1");
#undef AT
#undef HAIR
}

static void wrong_regions_are_refused(void **state)
{
    (void)state;
    assert_refused("\"regions\": [{\"bone\": \"chin\", \"weight\": 1, \"select\": {}}]",
                   "$.regions[0].bone", "no bone \"chin\"");
    assert_refused("\"regions\": [{\"bone\": \"skull\", \"select\": {\"group\": \"a\"}}]",
                   "$.regions[0]", "sets nothing");
    assert_refused("\"regions\": [{\"bone\": \"skull\", \"rigid\": true, \"mobility\": 1, "
                   "\"select\": {\"group\": \"a\"}}]",
                   "$.regions[0]", "a rigid region cannot");
    assert_refused("\"regions\": [{\"bone\": \"skull\", \"weight\": 2, \"select\": {}}]",
                   "$.regions[0].weight", "from 0 to 1");
    assert_refused("\"regions\": [{\"mobility\": 1, \"select\": {}}]", "$.regions[0].select",
                   "one of vertices, group");
    assert_refused("\"regions\": [{\"mobility\": 1, \"select\": {\"group\": \"a\", \"box\": 1}}]",
                   "$.regions[0].select", "combine them with");
    assert_refused("\"regions\": [{\"mobility\": 1, \"select\": {\"vertices\": [\"9-2\"]}}]",
                   "$.regions[0].select.vertices[0]", "a range like");
    assert_refused("\"regions\": [{\"mobility\": 1, \"select\": {\"vertices\": [-4]}}]",
                   "$.regions[0].select.vertices[0]", "from 0");
}

static void wrong_contacts_are_refused(void **state)
{
    (void)state;
    assert_refused("\"contacts\": [{\"name\": \"a\", \"vertex\": 1, \"mirror\": \"b\"}]",
                   "$.contacts[0].mirror", "no contact \"b\"");
    assert_refused("\"contacts\": [{\"name\": \"a\", \"vertex\": 1, \"mirror\": \"b\"}, "
                   "{\"name\": \"b\", \"vertex\": 2}]",
                   "$.contacts[0].mirror", "does not point back");
    assert_refused("\"contacts\": [{\"name\": \"a\", \"vertex\": 1.5}]", "$.contacts[0].vertex",
                   "a vertex number");
    assert_refused("\"contacts\": [{\"name\": \"\", \"vertex\": 1}]", "$.contacts[0].name",
                   "a name like");
    assert_refused("\"contact_sets\": {\"x\": [\"a\"]}", "$.contact_sets.x[0]", "no contact \"a\"");
    assert_refused("\"poses\": [{\"name\": \"p\", \"pulls\": {\"a\": [0,0,0]}}]",
                   "$.poses[0].pulls.a", "no contact \"a\"");
    assert_refused("\"poses\": [{\"name\": \"p\", \"dofs\": {\"jaw.open\": 3}}]",
                   "$.poses[0].dofs[\"jaw.open\"]", "unknown degree of freedom");
    assert_refused("\"poses\": [{\"name\": \"p\", \"part\": \"nose\"}]", "$.poses[0].part",
                   "\"mouth\" or \"upper\"");
    assert_refused("\"poses\": [{\"name\": \"p\", \"part\": 1}]", "$.poses[0].part",
                   "\"mouth\" or \"upper\"");
}

static void wrong_settings_are_refused(void **state)
{
    (void)state;
    assert_refused("\"unit\": \"inch\"", "$.unit", "\"mm\", \"cm\" or \"m\"");
    assert_refused("\"solver\": {\"kernel\": \"gauss\"}", "$.solver.kernel", "wendland_c2");
    assert_refused("\"solver\": {\"radius_mm\": 0}", "$.solver.radius_mm", "a number from");
    assert_refused("\"mesh_hash\": \"12\"", "$.mesh_hash", "16 digits");
    assert_refused("\"include\": \"other.rig.json\"", "$.include", "cannot include");
}

static void what_is_no_rig_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {{"", "is not JSON"},
                 {"[1]", "expected an object"},
                 {"{\"mesh\": \"a\"}", "this is not a rig file"},
                 {"{\"marotte_rig\": 0, \"mesh\": \"a\"}", "expected 1"},
                 {"{\"marotte_rig\": 1}", "$.mesh: expected the file name"},
                 {"{\"marotte_rig\": 1,\n \"mesh\": \"a\" \"b\"}", "line 2"},
                 {"{\"marotte_rig\": 1, \"marotte_rig\": 1, \"mesh\": \"a\"}", "uplicate"},
                 {"{\"marotte_rig\": 1, \"mesh\": \"a\\u0000b\"}", "is not JSON"},
                 {"{\"marotte_rig\": 1, \"mesh\": \"a\\nb\"}", "no control characters"},
                 {"{\"marotte_rig\": 1, \"mesh\": \"a\", \"name\": \"\\u009b31m\"}",
                  "no control characters"},
                 {"{\"marotte_rig\": 1, \"mesh\": \"a\", \"contact_sets\": {\"\\u001b]0;x\": []}}",
                  "expected a key of 1 to 63"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        rig r;
        error err = {""};
        assert_true(rig_from(&r, cases[i].text, &err) < 0);
        if (!strstr(err.text, cases[i].words) || strchr(err.text, '\n'))
            fail_msg("%s: %s", cases[i].text, err.text);
    }
}

/* {"not": {"not": ...}} thirteen times. */
static void deep_selectors_are_refused(void **state)
{
    (void)state;
    char body[2048] = "\"regions\": [{\"mobility\": 1, \"select\": ";
    for (int i = 0; i < 13; ++i)
        strcat(body, "{\"not\": ");
    strcat(body, "{\"group\": \"a\"}");
    for (int i = 0; i < 13; ++i)
        strcat(body, "}");
    strcat(body, "}]");
    rig r;
    error err = {""};
    assert_int_equal(rig_with(&r, body, &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "12 deep"));
}

static void the_frame_of_the_mesh_is_read_and_written(void **state)
{
    (void)state;
    rig r, back;
    error err = {""};
    assert_int_equal(
        rig_with(&r, "\"mesh_unit\": 160, \"mesh_up\": \"z\", \"mesh_forward\": \"-y\"", &err),
        MRT_OK);
    assert_true(r.frame.mm_per_unit == 160.0 && r.frame.up == MESH_AXIS_Z &&
                r.frame.forward == MESH_AXIS_MINUS_Y);
    char path[] = "/tmp/marotte-test-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(close(fd), 0);
    r.frame.mm_per_unit = 38.0;
    assert_int_equal(rig_write(&r, path, &err), MRT_OK);
    assert_int_equal(rig_read_trusted(&back, path, &err), MRT_OK);
    assert_true(back.frame.mm_per_unit == 38.0 && back.frame.up == MESH_AXIS_Z &&
                back.frame.forward == MESH_AXIS_MINUS_Y);
    (void)unlink(path);
    rig_destroy(&back);
    rig_destroy(&r);
    assert_int_equal(rig_with(&r, "\"mesh_unit\": \"cm\"", &err), MRT_OK);
    assert_true(r.frame.mm_per_unit == 10.0 && r.frame.up == MESH_AXIS_AUTO);
    rig_destroy(&r);
    assert_refused("\"mesh_unit\": 0", "$.mesh_unit", "a number of mm");
    assert_refused("\"mesh_unit\": \"inch\"", "$.mesh_unit", "a number of mm");
    assert_refused("\"mesh_up\": \"w\"", "$.mesh_up", "\"-z\"");
    assert_refused("\"mesh_forward\": 3", "$.mesh_forward", "\"-z\"");
}

static void hash_tells_meshes_apart(void **state)
{
    (void)state;
    static const uint32_t triangle[] = {0, 1, 2, 0, 2, 3}, turned[] = {0, 1, 2, 0, 3, 2};
    /* FNV-1a of the words 1, 0, 0, 0 in little-endian bytes, computed apart. */
    uint64_t one = 14695981039346656037u;
    const uint8_t bytes[] = {1, 0, 0, 0};
    for (int i = 0; i < 4; ++i)
        one = (one ^ bytes[i]) * 1099511628211u;
    assert_true(rig_mesh_hash(1, NULL, 0) == one);
    assert_true(rig_mesh_hash(4, triangle, 2) != rig_mesh_hash(4, turned, 2));
    assert_true(rig_mesh_hash(4, triangle, 2) != rig_mesh_hash(5, triangle, 2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_are_mm_and_angles_rad_whatever_the_unit),
        cmocka_unit_test(names_become_indices),
        cmocka_unit_test(mesh_path_is_beside_the_rig),
        cmocka_unit_test(selectors_nest),
        cmocka_unit_test(unknown_keys_are_listed_and_do_no_harm),
        cmocka_unit_test(bones_that_cannot_move_are_refused),
        cmocka_unit_test(what_a_lid_cannot_follow_is_refused),
        cmocka_unit_test(springs_that_cannot_swing_are_refused),
        cmocka_unit_test(wrong_regions_are_refused),
        cmocka_unit_test(wrong_contacts_are_refused),
        cmocka_unit_test(wrong_settings_are_refused),
        cmocka_unit_test(what_is_no_rig_is_refused),
        cmocka_unit_test(deep_selectors_are_refused),
        cmocka_unit_test(the_frame_of_the_mesh_is_read_and_written),
        cmocka_unit_test(hash_tells_meshes_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
