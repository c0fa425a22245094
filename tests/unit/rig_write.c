/* Rig files written back, and files that include others. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "rig_help.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/marotte_rig_XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static const char *const files[] = {
    "a.rig.json",  "b.rig.json",           "c.rig.json",  "out.rig.json", "d0.rig.json",
    "d1.rig.json", "d2.rig.json",          "d3.rig.json", "d4.rig.json",  "d5.rig.json",
    "d6.rig.json", "d7.rig.json",          "d8.rig.json", "d9.rig.json",  "sub/s.rig.json",
    "sub/m.obj",   "sub/below/b.rig.json", "head.glb"};

static const char *in_folder(const char *name)
{
    static char path[4][160];
    static int next;
    next = (next + 1) % 4;
    (void)snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static int remove_folder(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; ++i)
        (void)unlink(in_folder(files[i]));
    (void)rmdir(in_folder("sub/below"));
    (void)rmdir(in_folder("sub"));
    return rmdir(folder);
}

static void put(const char *name, const char *text)
{
    error err;
    assert_int_equal(file_write(in_folder(name), text, strlen(text), &err), MRT_OK);
}

static void get(char *out, size_t capacity, const char *name)
{
    file_bytes bytes;
    error err;
    assert_int_equal(file_read(&bytes, in_folder(name), capacity - 1, &err), MRT_OK);
    memcpy(out, bytes.data, bytes.size + 1);
    file_bytes_finish(&bytes);
}

static rig read_rig(const char *name)
{
    rig r;
    error err = {""};
    if (rig_read(&r, in_folder(name), &err) != MRT_OK)
        fail_msg("%s", err.text);
    return r;
}

static const char head[] =
    "{\n"
    "  \"marotte_rig\": 1,\n"
    "  \"mesh\": \"head.glb\",\n"
    "  \"unit\": \"m\",\n"
    "  \"author\": {\"name\": \"Ana\", \"since\": 1987},\n"
    "  \"bones\": [\n"
    "    {\"name\": \"skull\"},\n"
    "    {\"name\": \"jaw\", \"hinge\": {\"left\": [0.061, 0.1, 0], \"right\": [-0.061, 0.1, 0]}, "
    "\"open_deg\": [0, 31], \"rust\": true}\n"
    "  ],\n"
    "  \"regions\": [\n"
    "    {\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"box\": {\"low\": [-0.1, -0.1, -0.1], "
    "\"high\": [0.1, 0.3, 0.7]}}, \"why\": \"chin\"}\n"
    "  ],\n"
    "  \"contacts\": [\n"
    "    {\"name\": \"a.l\", \"vertex\": 4, \"mirror\": \"a.r\"},\n"
    "    {\"name\": \"a.r\", \"bone\": \"auto\", \"vertex\": 5, \"mirror\": \"a.l\"}\n"
    "  ],\n"
    "  \"poses\": [\n"
    "    {\"name\": \"open\", \"part\": \"mouth\", \"dofs\": {\"jaw.open\": 15.5}, \"pulls\": "
    "{\"a.l\": [0, 0.0123, "
    "0]}}\n"
    "  ],\n"
    "  \"solver\": {\"radius_mm\": 60}\n"
    "}\n";

static void what_is_read_and_written_is_the_same_text(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    assert_int_equal(rig_write(&r, in_folder("out.rig.json"), &err), MRT_OK);
    rig_destroy(&r);
    get(text, sizeof text, "out.rig.json");
    assert_string_equal(text, head);
}

static void only_what_changed_changes(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    r.contact[1].vertex = 77;
    r.contact[1].bone = 1;
    r.bone[1].open_max_rad = 30.0 * 0.017453292519943295;
    r.region[0].select.b.z = 650.0;
    r.pose[0].dof_value[0] = 0.1;
    r.pose[0].part = POSE_WHOLE;
    r.solver.polynomial = CSRBF_LINEAR;
    assert_int_equal(rig_write(&r, in_folder("out.rig.json"), &err), MRT_OK);
    rig_destroy(&r);
    get(text, sizeof text, "out.rig.json");
    assert_non_null(strstr(text, "{\"name\": \"a.r\", \"bone\": \"jaw\", \"vertex\": 77, "
                                 "\"mirror\": \"a.l\"}"));
    assert_non_null(strstr(text, "\"open_deg\": [0, 30], \"rust\": true"));
    assert_non_null(strstr(text, "\"high\": [0.1, 0.3, 0.65]}}, \"why\": \"chin\""));
    assert_non_null(strstr(text, "\"left\": [0.061, 0.1, 0]"));
    assert_non_null(strstr(text, "{\"radius_mm\": 60, \"polynomial\": \"linear\"}"));
    assert_non_null(strstr(text, "\"author\": {\"name\": \"Ana\", \"since\": 1987}"));
    rig again = read_rig("out.rig.json");
    assert_true(fabs(again.pose[0].dof_value[0] - 0.1) < 1e-12);
    assert_null(strstr(text, "\"part\""));
    rig_destroy(&again);
}

static void elsewhere_the_mesh_is_named_and_must_be_allowed(void **state)
{
    (void)state;
    char text[4096], directory[128];
    rig again;
    error err = {""};
    (void)snprintf(directory, sizeof directory, "%s/sub", folder);
    assert_int_equal(mkdir(directory, 0700), 0);
    put("a.rig.json", head);
    rig r = read_rig("a.rig.json");
    assert_int_equal(rig_write(&r, in_folder("sub/s.rig.json"), &err), MRT_OK);
    rig_destroy(&r);
    get(text, sizeof text, "sub/s.rig.json");
    assert_non_null(strstr(text, "\"mesh\": \"../head.glb\""));
    assert_true(rig_read(&again, in_folder("sub/s.rig.json"), &err) < 0);
    assert_non_null(strstr(err.text, "s.rig.json: $.mesh: "));
    assert_non_null(strstr(err.text, "MAROTTE_FILE_FOLDERS="));
    assert_null(again.document);
    assert_int_equal(rig_read_trusted(&again, in_folder("sub/s.rig.json"), &err), MRT_OK);
    assert_non_null(strstr(again.mesh_path, "/sub/../head.glb"));
    rig_destroy(&again);
    put("head.glb", "x");
    char list[160];
    (void)snprintf(list, sizeof list, "/nowhere:%s", folder);
    assert_int_equal(setenv("MAROTTE_FILE_FOLDERS", list, 1), 0);
    mrt_result allowed = rig_read(&again, in_folder("sub/s.rig.json"), &err);
    assert_int_equal(unsetenv("MAROTTE_FILE_FOLDERS"), 0);
    assert_int_equal(allowed, MRT_OK);
    rig_destroy(&again);
}

static void assert_beyond_folder(const char *key, const char *name)
{
    rig r;
    error err = {""};
    char text[512];
    (void)snprintf(text, sizeof text, "{\"marotte_rig\": 1, %s\"%s\": \"%s\"}",
                   strcmp(key, "mesh") == 0 ? "" : "\"mesh\": \"m.obj\", ", key, name);
    put("sub/s.rig.json", text);
    if (rig_read(&r, in_folder("sub/s.rig.json"), &err) >= 0)
        fail_msg("%s: %s is read", key, name);
    if (!strstr(err.text, "is not in the folder of the file that names it"))
        fail_msg("%s: %s: %s", key, name, err.text);
}

static void what_a_rig_names_lies_in_its_folder_or_below(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    char outside[160], link[160];
    (void)mkdir(in_folder("sub"), 0700);
    (void)mkdir(in_folder("sub/below"), 0700);
    put("head.glb", "x");
    put("a.rig.json", head);
    (void)snprintf(outside, sizeof outside, "%s", in_folder("a.rig.json"));
    (void)snprintf(link, sizeof link, "%s", in_folder("sub/link"));
    for (int i = 0; i < 2; ++i) {
        const char *key = i ? "include" : "mesh";
        assert_beyond_folder(key, outside);
        assert_beyond_folder(key, "../a.rig.json");
        assert_beyond_folder(key, "../gone");
        assert_beyond_folder(key, "below/../../a.rig.json");
        assert_beyond_folder(key, "/etc/hostname");
        assert_int_equal(symlink(outside, link), 0); /* as an archive may bring one */
        assert_beyond_folder(key, "link");
        assert_int_equal(unlink(link), 0);
    }
    /* An included file may climb, but not out of the rig's own folder. */
    put("sub/m.obj", "x");
    put("sub/below/b.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"../m.obj\"}");
    put("sub/s.rig.json", "{\"marotte_rig\": 1, \"include\": \"below/b.rig.json\"}");
    if (rig_read(&r, in_folder("sub/s.rig.json"), &err) < 0)
        fail_msg("%s", err.text);
    rig_destroy(&r);
    put("sub/below/b.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"../../head.glb\"}");
    assert_true(rig_read(&r, in_folder("sub/s.rig.json"), &err) < 0);
    assert_non_null(strstr(err.text, "below/b.rig.json: $.mesh: "));
}

static const char puppet[] = "{\"marotte_rig\": 1, \"include\": \"a.rig.json\", \"unit\": \"mm\",\n"
                             " \"bones\": [{\"name\": \"jaw\", \"hinge\": {\"left\": [50, 0, 0], "
                             "\"right\": [-50, 0, 0]}}],\n"
                             " \"contacts\": [{\"name\": \"b\", \"vertex\": 9}]}\n";

static void own_entries_follow_and_override_included_ones(void **state)
{
    (void)state;
    put("a.rig.json", head);
    put("b.rig.json", puppet);
    rig r = read_rig("b.rig.json");
    assert_int_equal(r.bone_count, 2);
    assert_true(fabs(r.bone[1].hinge_left.x - 50.0) < 1e-12); /* its own file's mm */
    assert_true(fabs(r.region[0].select.b.y - 300.0) < 1e-9); /* the other's m */
    assert_int_equal(r.contact_count, 3);
    assert_string_equal(r.contact[0].name, "a.l");
    assert_string_equal(r.contact[2].name, "b");
    assert_true(fabs(r.solver.radius - 60.0) < 1e-12);
    assert_non_null(strstr(r.mesh_path, "head.glb"));
    rig_destroy(&r);
}

static void an_including_rig_is_written_as_one_file(void **state)
{
    (void)state;
    char text[4096];
    error err = {""};
    put("a.rig.json", head);
    put("b.rig.json", puppet);
    rig r = read_rig("b.rig.json");
    r.region[0].weight = 0.5;
    r.contact[0].vertex = 44;
    assert_int_equal(rig_write(&r, in_folder("out.rig.json"), &err), MRT_OK);
    rig_destroy(&r);
    get(text, sizeof text, "out.rig.json");
    assert_null(strstr(text, "\"include\""));
    assert_non_null(strstr(text, "\"author\""));
    rig again = read_rig("out.rig.json");
    assert_true(fabs(again.region[0].weight - 0.5) < 1e-12);
    assert_true(fabs(again.region[0].select.b.y - 300.0) < 1e-9);
    assert_true(fabs(again.bone[1].hinge_left.x - 50.0) < 1e-12);
    assert_true(fabs(again.solver.radius - 60.0) < 1e-12);
    assert_int_equal(again.contact[0].vertex, 44);
    assert_int_equal(again.contact_count, 3);
    rig_destroy(&again);
}

static void a_file_included_twice_is_read_once(void **state)
{
    (void)state;
    put("a.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"what\": 1, \"regions\": "
                      "[{\"mobility\": 1, \"select\": {\"group\": \"g\"}}]}");
    put("b.rig.json", "{\"marotte_rig\": 1, \"include\": \"./a.rig.json\"}");
    put("c.rig.json", "{\"marotte_rig\": 1, \"include\": [\"a.rig.json\", \"b.rig.json\", "
                      "\"a.rig.json\"]}");
    rig r = read_rig("c.rig.json");
    assert_int_equal(r.region_count, 1);
    const char *note = strstr(r.note, "$.what");
    assert_non_null(note);
    assert_null(strstr(note + 1, "$.what"));
    rig_destroy(&r);
}

static void included_files_are_paid_out_of_one_budget(void **state)
{
    (void)state;
    enum { VALUES = 1500000 };
    static char many[2 * VALUES + 64];
    rig r;
    error err = {""};
    int start = snprintf(many, 64, "{\"marotte_rig\": 1, \"many\": [");
    for (int i = 0; i < VALUES; ++i)
        memcpy(many + start + 2 * i, "0,", 2);
    strcpy(many + start + 2 * VALUES, "0]}");
    for (int i = 0; i < 3; ++i) {
        char name[32];
        (void)snprintf(name, sizeof name, "d%d.rig.json", i);
        put(name, many);
    }
    put("a.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"include\": [\"d0.rig.json\", "
                      "\"d0.rig.json\", \"d1.rig.json\"]}");
    r = read_rig("a.rig.json");
    rig_destroy(&r);
    put("a.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"include\": [\"d0.rig.json\", "
                      "\"d1.rig.json\", \"d2.rig.json\"]}");
    assert_int_equal(rig_read(&r, in_folder("a.rig.json"), &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "d2.rig.json: it needs more than"));
    assert_non_null(strstr(err.text, "bytes of memory, the limit for a rig of"));
}

static void errors_in_included_files_name_them(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    put("a.rig.json", "{\"marotte_rig\": 1, \"bones\": [{\"name\": 3}]}");
    put("b.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"include\": [\"a.rig.json\"]}");
    assert_true(rig_read(&r, in_folder("b.rig.json"), &err) < 0);
    assert_non_null(strstr(err.text, "b.rig.json: a.rig.json: $.bones[0].name: expected"));
    put("b.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"include\": \"gone.rig.json\"}");
    assert_true(rig_read(&r, in_folder("b.rig.json"), &err) < 0);
    assert_non_null(strstr(err.text, "$.include: "));
    assert_non_null(strstr(err.text, "gone.rig.json: No such file"));
}

static void cyclic_includes_are_refused_with_the_chain(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    put("a.rig.json", "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"include\": \"b.rig.json\"}");
    put("b.rig.json", "{\"marotte_rig\": 1, \"include\": \"c.rig.json\"}");
    put("c.rig.json", "{\"marotte_rig\": 1, \"include\": [\"./a.rig.json\"]}");
    assert_true(rig_read(&r, in_folder("a.rig.json"), &err) < 0);
    assert_non_null(strstr(err.text, "a.rig.json includes b.rig.json includes c.rig.json includes "
                                     "a.rig.json"));
    assert_non_null(strstr(err.text, "remove one"));
}

static void includes_deeper_than_eight_are_refused(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    for (int i = 0; i <= 9; ++i) {
        char name[32], text[128];
        (void)snprintf(name, sizeof name, "d%d.rig.json", i);
        (void)snprintf(text, sizeof text,
                       i < 9 ? "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", \"include\": "
                               "\"d%d.rig.json\"}"
                             : "{\"marotte_rig\": 1, \"name\": \"last%d\"}",
                       i + 1);
        put(name, text);
    }
    assert_true(rig_read(&r, in_folder("d0.rig.json"), &err) < 0);
    assert_non_null(strstr(err.text, "more than 8 levels of includes"));
    assert_int_equal(rig_read(&r, in_folder("d1.rig.json"), &err), MRT_OK);
    rig_destroy(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_read_and_written_is_the_same_text),
        cmocka_unit_test(only_what_changed_changes),
        cmocka_unit_test(elsewhere_the_mesh_is_named_and_must_be_allowed),
        cmocka_unit_test(what_a_rig_names_lies_in_its_folder_or_below),
        cmocka_unit_test(own_entries_follow_and_override_included_ones),
        cmocka_unit_test(an_including_rig_is_written_as_one_file),
        cmocka_unit_test(a_file_included_twice_is_read_once),
        cmocka_unit_test(included_files_are_paid_out_of_one_budget),
        cmocka_unit_test(errors_in_included_files_name_them),
        cmocka_unit_test(cyclic_includes_are_refused_with_the_chain),
        cmocka_unit_test(includes_deeper_than_eight_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
