#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh_gltf_document.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static char directory[64];

static int make_directory(void **state)
{
    (void)state;
    (void)snprintf(directory, sizeof directory, "/tmp/marotte-test-XXXXXX");
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    (void)state;
    return rmdir(directory);
}

typedef struct attempt {
    mrt_result result;
    mesh m;
    error err;
    char path[128];
} attempt;

/* Writes a file, reads it, removes it. */
static attempt read_bytes(const char *name, const void *data, size_t size, double unit_mm)
{
    attempt a = {.result = MRT_OK};
    (void)snprintf(a.path, sizeof a.path, "%s/%s", directory, name);
    FILE *file = fopen(a.path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    a.result = mesh_file_read(&a.m, a.path, &(mesh_frame){.mm_per_unit = unit_mm}, &a.err);
    (void)unlink(a.path);
    return a;
}

static attempt read_text(const char *name, const char *text, double unit_mm)
{
    return read_bytes(name, text, strlen(text), unit_mm);
}

static void assert_read(attempt *a, uint32_t vertex_count)
{
    if (a->result < 0)
        fail_msg("%s", a->err.text);
    assert_int_equal(a->m.vertex_count, vertex_count);
    mesh_destroy(&a->m);
}

static void assert_refused(const attempt *a, const char *reason)
{
    char expected[256];
    (void)snprintf(expected, sizeof expected, "%s: %s", a->path, reason);
    assert_true(a->result < 0);
    assert_null(a->m.position);
    if (strncmp(a->err.text, expected, strlen(expected)) != 0)
        fail_msg("\"%s\" does not start with \"%s\"", a->err.text, expected);
}

#define OBJ "v 0 0 0\nv 1 0 0\nv 0 %s 0\nf 1 2 3\n"
#define OFF "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
#define PLY                                                                                        \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"                \
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"       \
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"

static void the_content_decides_before_the_name(void **state)
{
    (void)state;
    attempt a = read_text("a.off", PLY, 1);
    assert_read(&a, 3);
    a = read_text("b", "# comment\n" OFF, 1);
    assert_read(&a, 3);
    a = read_text("c.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1);
    assert_read(&a, 3);
    document d = document_glb(DOCUMENT_DATA DOCUMENT_HEAD);
    a = read_bytes("d.obj", d.bytes, d.size, 0);
    assert_read(&a, 4);
    d = document_gltf(DOCUMENT_HEAD);
    a = read_bytes("e", d.bytes, d.size, 0);
    assert_read(&a, 4);
}

/* Two squares that meet along x = 100, each with vertices of its own there. */
static void seams_are_one_point_when_a_file_was_read(void **state)
{
    (void)state;
    attempt a = read_text("seam.obj",
                          "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\n"
                          "v 100 0 0\nv 200 0 0\nv 200 100 0\nv 100 100 0\n"
                          "f 1 2 3 4\nf 5 6 7 8\n",
                          1.0);
    if (a.result < 0)
        fail_msg("%s", a.err.text);
    assert_int_equal(mesh_point(&a.m, 4), 1);
    assert_int_equal(mesh_point(&a.m, 7), 2);
    assert_int_equal(mesh_point(&a.m, 5), 5);
    mesh_destroy(&a.m);
}

static void gltf_is_metres_with_its_targets(void **state)
{
    (void)state;
    document d = document_glb(DOCUMENT_DATA DOCUMENT_HEAD);
    attempt a = read_bytes("a.glb", d.bytes, d.size, 0);
    assert_int_equal(a.result, MRT_OK);
    assert_true(a.m.mm_per_unit == 1000.0);
    assert_true(a.m.position[3] == 1000.0f);
    assert_true(a.m.target[0].offset[5] == 500.0f);
    assert_true(a.m.attribute[0].value[3] == 1.0f);
    mesh_destroy(&a.m);
    a = read_bytes("a.glb", d.bytes, d.size, 10);
    assert_true(a.m.mm_per_unit == 10.0 && a.m.position[3] == 10.0f);
    mesh_destroy(&a.m);
}

static void the_unit_is_guessed_from_the_height(void **state)
{
    (void)state;
    static const struct {
        const char *height, *note;
        double mm_per_unit;
    } cases[] = {{"0.25", "assumed unit: m, which makes the height 250 mm", 1000.0},
                 {"25", "assumed unit: cm, which makes the height 250 mm", 10.0},
                 {"250", "assumed unit: mm, which makes the height 250 mm", 1.0},
                 {"700", "assumed unit: mm", 1.0},
                 {"1", "Assumed unit: 300 mm", 300.0},
                 {"2", "does not fit a head", 150.0},
                 {"0.001", "does not fit a head in mm, cm or m", 300000.0},
                 {"5", "which makes the height 300 mm", 60.0},
                 {"5000", "not fit a head", 0.06}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[128];
        (void)snprintf(text, sizeof text, OBJ, cases[i].height);
        attempt a = read_text("a.obj", text, 0);
        assert_int_equal(a.result, MRT_OK);
        assert_true(fabs(a.m.mm_per_unit / cases[i].mm_per_unit - 1.0) < 1e-9);
        assert_true(fabs((double)a.m.position[3] / cases[i].mm_per_unit - 1.0) < 1e-6);
        assert_non_null(strstr(a.m.note, cases[i].note));
        mesh_destroy(&a.m);
    }
    char text[128];
    (void)snprintf(text, sizeof text, OBJ, "5");
    attempt a = read_text("a.obj", text, 1000);
    assert_true(a.m.mm_per_unit == 1000.0 && a.m.position[7] == 5000.0f);
    assert_null(a.m.note);
    mesh_destroy(&a.m);
}

static void errors_start_with_the_path(void **state)
{
    (void)state;
    attempt a = read_text("a.obj", "v 0 0 zero\n", 0);
    assert_refused(&a, "line 1: a finite number");
    a = read_text("a.obj", "", 0);
    assert_refused(&a, "the file is empty");
    a = read_text("a.fbx", "Kaydara", 0);
    assert_refused(&a, "unknown mesh format");
    a = read_text("face.glb", "\x89PNG\r\n", 0);
    assert_refused(&a, "not a mesh file: a PNG picture");
    a = read_text("a.glb", "<!DOCTYPE html>", 0);
    assert_refused(&a, "not a mesh file: a web page");
    a = read_text("a.fbx", "Kaydara FBX Binary", 0);
    assert_refused(&a, "not a mesh file: an FBX file");
    a = read_text("a.glb", "glTF", 0);
    assert_refused(&a, "the .glb ends within its header");
    a = read_text("a.obj", "v 0 0 0\nv 3e38 0 0\nv 0 1 0\nf 1 2 3\n", 1000);
    assert_refused(&a, "vertex 1 is not finite");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_content_decides_before_the_name),
        cmocka_unit_test(seams_are_one_point_when_a_file_was_read),
        cmocka_unit_test(gltf_is_metres_with_its_targets),
        cmocka_unit_test(the_unit_is_guessed_from_the_height),
        cmocka_unit_test(errors_start_with_the_path),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
