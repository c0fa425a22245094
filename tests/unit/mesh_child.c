#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/mesh_file.h"
#include "io/read/mesh_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char directory[64], mesh_path[128], program_path[128];

static int make_files(void **state)
{
    (void)state;
    (void)snprintf(directory, sizeof directory, "/tmp/marotte-test-XXXXXX");
    if (!mkdtemp(directory))
        return -1;
    (void)snprintf(mesh_path, sizeof mesh_path, "%s/a.stl", directory);
    (void)snprintf(program_path, sizeof program_path, "%s/child", directory);
    return setenv("MAROTTE_MESHLOAD", BUILD_DIR "/marotte-meshload", 1);
}

static int remove_files(void **state)
{
    (void)state;
    (void)unlink(mesh_path);
    (void)unlink(program_path);
    return rmdir(directory);
}

static void write_file(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* Three triangles of a binary STL on one edge, 200 mm high: no manifold. */
static size_t write_stl(unsigned char out[512])
{
    static const float corner[3][9] = {{0, 0, 0, 100, 0, 0, 0, 200, 0},
                                       {0, 0, 0, 0, 200, 0, -100, 0, 0},
                                       {0, 0, 0, 0, 200, 0, 0, 0, 100}};
    memset(out, 0, 512);
    out[80] = 3;
    for (size_t t = 0; t < 3; ++t)
        memcpy(out + 84 + t * 50 + 12, corner[t], sizeof corner[t]);
    return 84 + 3 * 50;
}

static void assert_refused(const char *reason)
{
    mesh m;
    error err = {""};
    assert_true(mesh_file_read(&m, mesh_path, NULL, &err) < 0);
    assert_null(m.position);
    if (strncmp(err.text, mesh_path, strlen(mesh_path)) != 0 || !strstr(err.text, reason))
        fail_msg("\"%s\" does not say \"%s\"", err.text, reason);
}

static void an_stl_comes_back_without_doubled_vertices(void **state)
{
    (void)state;
    unsigned char data[512];
    size_t size = write_stl(data);
    mesh m;
    error err = {""};
    write_file(mesh_path, data, size);
    if (mesh_file_read(&m, mesh_path, NULL, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(m.vertex_count, 5);
    assert_int_equal(m.triangle_count, 3);
    assert_true(m.position[3] == 100.0f && m.mm_per_unit == 1.0);
    assert_non_null(strstr(m.note, "up z, forward -y (from its shape)")); /* as of STL */
    assert_non_null(strstr(m.note, "which makes the height"));
    mesh_destroy(&m);
}

static void damaged_stl_files_are_refused(void **state)
{
    (void)state;
    unsigned char data[512];
    (void)write_stl(data);
    write_file(mesh_path, data, 120);
    assert_refused("it has no vertices");
    write_file(mesh_path, "solid x\nfacet junk\n", 19);
    assert_refused("");
}

/* Children that misbehave, as shell scripts. */
static void children_that_misbehave_are_reported(void **state)
{
    (void)state;
    static const struct {
        const char *script, *reason;
    } children[] = {{"kill -SEGV $$", "its reader crashed (Segmentation fault)"},
                    {"kill -ABRT $$", "its reader crashed (Aborted)"},
                    {"kill -XCPU $$", "used up its processor time"},
                    {"exit 1", "the reader did not finish"},
                    {"printf MRTMESH1", "the reader did not finish"},
                    {"printf 'MRTFAIL1bad\\nluck'", "bad?luck"},
                    {"printf 'MRTMESH1\\377\\377\\377\\177\\1\\0\\0\\0\\0\\0\\0\\0'",
                     "the reader did not finish"}};
    write_file(mesh_path, "solid x\n", 8);
    assert_int_equal(setenv("MAROTTE_MESHLOAD", program_path, 1), 0);
    for (size_t i = 0; i < sizeof children / sizeof *children; ++i) {
        char script[128];
        int length = snprintf(script, sizeof script, "#!/bin/sh\n%s\n", children[i].script);
        (void)unlink(program_path);
        write_file(program_path, script, (size_t)length);
        assert_int_equal(chmod(program_path, 0700), 0);
        assert_refused(children[i].reason);
    }
    assert_int_equal(setenv("MAROTTE_MESHLOAD", "/nowhere/marotte-meshload", 1), 0);
    assert_refused("MAROTTE_MESHLOAD names \"/nowhere/marotte-meshload\"");
    assert_int_equal(setenv("MAROTTE_MESHLOAD", BUILD_DIR "/marotte-meshload", 1), 0);
}

static void the_child_is_found_without_being_named(void **state)
{
    (void)state;
    unsigned char data[512];
    size_t size = write_stl(data);
    mesh m;
    error err = {""};
    write_file(mesh_path, data, size);
    assert_int_equal(unsetenv("MAROTTE_MESHLOAD"), 0);
    if (mesh_file_read(&m, mesh_path, NULL, &err) < 0)
        fail_msg("%s", err.text);
    mesh_destroy(&m);
    assert_int_equal(setenv("MAROTTE_MESHLOAD", BUILD_DIR "/marotte-meshload", 1), 0);
}

static void what_the_wire_carries_is_checked(void **state)
{
    (void)state;
    mesh m, back;
    error err = {""};
    char *bytes = NULL;
    size_t size = 0;
    assert_int_equal(mesh_create(&m, 3, 1, &err), MRT_OK);
    m.position[3] = m.position[7] = 1.5f;
    m.triangle[1] = 1;
    m.triangle[2] = 2;
    mesh_note(&m, "seen");
    FILE *stream = open_memstream(&bytes, &size);
    assert_non_null(stream);
    mesh_wire_write(stream, &m);
    assert_int_equal(fclose(stream), 0);
    assert_int_equal(mesh_wire_parse(&back, bytes, size, &err), MRT_OK);
    assert_memory_equal(back.position, m.position, 36);
    assert_memory_equal(back.triangle, m.triangle, 12);
    assert_string_equal(back.note, "seen\n");
    mesh_destroy(&back);
    for (size_t cut = 0; cut < size; ++cut)
        assert_true(mesh_wire_parse(&back, bytes, cut, &err) < 0);
    bytes[20 + 36] = 3; /* a triangle with vertex 3 of 3 */
    assert_true(mesh_wire_parse(&back, bytes, size, &err) < 0);
    assert_null(back.position);
    free(bytes);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_stl_comes_back_without_doubled_vertices),
        cmocka_unit_test(damaged_stl_files_are_refused),
        cmocka_unit_test(children_that_misbehave_are_reported),
        cmocka_unit_test(the_child_is_found_without_being_named),
        cmocka_unit_test(what_the_wire_carries_is_checked),
    };
    return cmocka_run_group_tests(tests, make_files, remove_files);
}
