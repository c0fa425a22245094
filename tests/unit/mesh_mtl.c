/* tests/unit/mesh_mtl.c - how an OBJ head looks: its materials, the pictures beside it; what is
 * missing, damaged or outside is told in one sentence, and the head is there all the same. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "io/mesh_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SEEDS SOURCE_DIR "/tests/fuzz/seeds/image/" /* one byte, then the picture */
#define HEAD                                                                                       \
    "v 0 0 0\nv 100 0 0\nv 100 200 0\nv 0 200 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"                 \
    "usemtl skin\nf 1/1 2/2 3/3 4/4\n"

static char folder[64];

static void run(const char *command)
{
    char line[512];
    (void)snprintf(line, sizeof line, "cd %s && %s", folder, command);
    assert_int_equal(system(line), 0);
}

static void put(const char *name, const char *text)
{
    char path[512];
    error err = {""};
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    if (file_write(path, text, strlen(text), &err) < 0)
        fail_msg("%s", err.text);
}

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "/tmp/marotte-mtl-XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    run("mkdir head head/tex head/mat");
    run("tail -c +2 " SEEDS "a.png >head/skin.png");
    run("cp head/skin.png head/tex/my\\ skin.png && cp head/skin.png outside.png");
    run("tail -c +2 " SEEDS "a.jpg >head/tex/skin.jpg");
    return setenv("MAROTTE_MESHLOAD", BUILD_DIR "/marotte-meshload", 1);
}

static int tear_down(void **state)
{
    (void)state;
    run("rm -r ../${PWD##*/}");
    return unsetenv("MAROTTE_FILE_FOLDERS");
}

static mesh read_head(const char *text)
{
    mesh m;
    error err = {""};
    char path[128];
    put("head/head.obj", text);
    (void)snprintf(path, sizeof path, "%s/head/head.obj", folder);
    if (mesh_file_read(&m, path, &(mesh_frame){.mm_per_unit = 1.0}, &err) < 0)
        fail_msg("%s", err.text);
    return m;
}

/* A head with one material of these statements. */
static mesh read_with(const char *statements)
{
    char text[1024];
    (void)snprintf(text, sizeof text, "newmtl skin\n%s\n", statements);
    put("head/head.mtl", text);
    return read_head("mtllib head.mtl\n" HEAD);
}

static void expect_note(const mesh *m, const char *says)
{
    if (!m->note || !strstr(m->note, says))
        fail_msg("\"%s\" does not say \"%s\"", m->note ? m->note : "", says);
}

static void a_material_has_the_colours_that_its_file_says(void **state)
{
    (void)state;
    mesh m = read_with("Ns 96\nKa 1 1 1\nKd 0.5 0.25 2\nKe 0 0.5 1\nillum 2\nd 0.75");
    const mesh_material *look = &m.material[0];
    assert_string_equal(look->name, "skin");
    assert_true(look->base_colour[0] == 0.5f && look->base_colour[1] == 0.25f);
    assert_true(look->base_colour[2] == 1.0f && look->base_colour[3] == 0.75f);
    assert_true(look->emission_colour[1] == 0.5f && look->emission_colour[2] == 1.0f);
    assert_int_equal(look->alpha, MESH_ALPHA_BLEND);
    assert_false(look->is_single_sided);
    assert_false(look->has_roughness);
    assert_int_equal(m.image_count, 0);
    mesh_destroy(&m);
}

static void how_clear_it_is_has_two_words(void **state)
{
    (void)state;
    static const struct {
        const char *says;
        float alpha;
    } cases[] = {{"Tr 0.25", 0.75f},    {"d 1\nTr 1", 1.0f}, {"Tr 1\nd 0.5", 0.5f},
                 {"d -halo 0.5", 0.5f}, {"Tr 1", 1.0f},      {"d 0", 0.0f},
                 {"d 7", 1.0f},         {"", 1.0f}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        mesh m = read_with(cases[i].says);
        assert_true(m.material[0].base_colour[3] == cases[i].alpha);
        assert_int_equal(m.material[0].alpha,
                         cases[i].alpha < 1.0f ? MESH_ALPHA_BLEND : MESH_ALPHA_OPAQUE);
        mesh_destroy(&m);
    }
}

static void pictures_lie_on_it_as_it_says(void **state)
{
    (void)state;
    mesh m = read_with("Kd 0.1 0.1 0.1\n"
                       "map_Kd -blendu on -s 2 4 1 -o 0.5 0.25 -clamp on -mm 0 1 tex/my skin.png\n"
                       "map_Ke tex\\skin.jpg\nnorm -bm 0.5 ./skin.png");
    const mesh_material *look = &m.material[0];
    assert_null(strstr(m.note ? m.note : "", "picture"));
    assert_int_equal(m.image_count, 3);
    assert_string_equal(m.image[look->base.image - 1].name, "tex/my skin.png");
    assert_string_equal(m.image[look->emission.image - 1].name, "tex/skin.jpg");
    assert_int_equal(m.image[look->base.image - 1].width, 24);
    assert_non_null(m.image[look->emission.image - 1].rgba);
    /* u' = 2 u + 0.5; from above: v' = 4 v + (1 - 4 - 0.25) */
    static const float uv_transform[6] = {2, 0, 0.5f, 0, 4, -3.25f};
    assert_memory_equal(look->base.uv_transform, uv_transform, sizeof uv_transform);
    assert_int_equal(look->base.wrap[0], MESH_WRAP_CLAMP);
    assert_int_equal(look->emission.wrap[1], MESH_WRAP_REPEAT);
    assert_true(look->base_colour[0] == 1.0f && look->emission_colour[0] == 1.0f);
    assert_true(look->normal.image && look->normal_scale == 0.5f);
    static const float uv[8] = {0, 1, 1, 1, 1, 0, 0, 0};
    assert_memory_equal(m.uv, uv, sizeof uv);
    mesh_destroy(&m);
}

static void a_picture_of_its_own_alpha_is_cut_out(void **state)
{
    (void)state;
    mesh m = read_with("d 0.5\nmap_Kd skin.png\nmap_d skin.png");
    assert_int_equal(m.material[0].alpha, MESH_ALPHA_MASK);
    assert_true(m.material[0].base_colour[3] == 1.0f);
    assert_int_equal(m.image_count, 1);
    mesh_destroy(&m);
    m = read_with("map_Kd skin.png\nmap_d tex/skin.jpg");
    assert_int_equal(m.material[0].alpha, MESH_ALPHA_OPAQUE);
    expect_note(&m, "the picture \"tex/skin.jpg\" is not drawn: transparency");
    mesh_destroy(&m);
}

static void names_of_other_disks_are_looked_for_beside(void **state)
{
    (void)state;
    static const char *const names[] = {"C:\\work\\head\\skin.png", "/home/her/skin.png",
                                        "D:/x/skin.png", ".\\skin.png"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        char says[128];
        (void)snprintf(says, sizeof says, "map_Kd %s", names[i]);
        mesh m = read_with(says);
        assert_string_equal(m.image[0].name, "skin.png");
        assert_non_null(m.image[0].rgba);
        mesh_destroy(&m);
    }
}

static void materials_in_a_folder_name_pictures_from_there(void **state)
{
    (void)state;
    put("head/mat/my skin.mtl", "newmtl skin\nmap_kd ../tex/skin.jpg\n");
    mesh m = read_head("mtllib mat/my skin.mtl\n" HEAD);
    assert_string_equal(m.image[m.material[0].base.image - 1].name, "tex/skin.jpg");
    mesh_destroy(&m);
    put("head/a.mtl", "newmtl eye\nKd 0 0 0\n");
    put("head/b.mtl", "newmtl skin\nKd 1 0 0\nnewmtl skin\nKd 0 1 0\n");
    m = read_head("mtllib a.mtl b.mtl\n" HEAD "usemtl eye\nf 1 2 3\n");
    assert_true(m.material[0].base_colour[1] == 1.0f && m.material[0].base_colour[0] == 0.0f);
    assert_true(m.material[1].base_colour[0] == 0.0f);
    mesh_destroy(&m);
}

static void what_is_missing_or_outside_is_told(void **state)
{
    (void)state;
    static const struct {
        const char *says, *note;
    } cases[] = {{"map_Kd gone.png", "the picture \"gone.png\" is not drawn: "},
                 {"map_Kd ../outside.png", "is not in the folder of the file that names it"},
                 {"map_Kd /etc/passwd", "the picture \"passwd\" is not drawn: "},
                 {"map_Kd http://a/b.png", "only files beside"},
                 {"map_Kd link.png", "is not in the folder of the file that names it"},
                 {"map_Kd tex", "the picture \"tex\" is not drawn: "},
                 {"map_Kd head.obj", "not PNG, JPEG or WebP"},
                 {"map_Kd cut.png", "the picture \"cut.png\" is not drawn: the PNG is damaged"},
                 {"map_Kd \x1b[31m.png", "the picture \"?[31m.png\" is not drawn: "},
                 {"map_Kd -s 1", "1 lines of its materials are invalid"},
                 {"Kd red\nd x\nKe", "3 lines of its materials are invalid"}};
    run("ln -sf ../outside.png head/link.png && head -c 60 head/skin.png >head/cut.png");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        mesh m = read_with(cases[i].says);
        expect_note(&m, cases[i].note);
        assert_int_equal(m.vertex_count, 4);
        assert_null(m.image_count ? m.image[0].rgba : NULL);
        mesh_destroy(&m);
    }
    /* Unless the person says so. */
    assert_int_equal(setenv("MAROTTE_FILE_FOLDERS", folder, 1), 0);
    mesh m = read_with("map_Kd ../outside.png");
    assert_non_null(m.image[0].rgba);
    mesh_destroy(&m);
    assert_int_equal(unsetenv("MAROTTE_FILE_FOLDERS"), 0);
}

static void a_head_without_its_materials_is_grey(void **state)
{
    (void)state;
    static const struct {
        const char *names, *note;
    } cases[] = {{"gone.mtl", "its materials \"gone.mtl\" cannot be read, so it is grey: "},
                 {"../outside.mtl", "is not in the folder of the file that names it"},
                 {"", "that is not a file name"},
                 {"head.mtl", "1 of its materials are not in any material file, the first is "
                              "\"skin\": they are grey"}};
    put("head/head.mtl", "newmtl Skin\nKd 1 0 0\n");
    put("outside.mtl", "newmtl skin\nKd 1 0 0\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[512];
        (void)snprintf(text, sizeof text, "mtllib %s\n" HEAD, cases[i].names);
        mesh m = read_head(text);
        expect_note(&m, cases[i].note);
        assert_true(m.material[0].base_colour[0] == 0.6f);
        mesh_destroy(&m);
    }
}

/* Seams, also where the surface folds back sharply, stay one surface. */
static void split_vertices_are_one_point(void **state)
{
    (void)state;
    put("head/head.mtl", "newmtl skin\nmap_Kd skin.png\n");
    mesh m = read_head("mtllib head.mtl\nv 0 0 0\nv 0 100 0\nv 100 50 1\nv 100 50 -1\n"
                       "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\nvt 0.25 0.5\n"
                       "usemtl skin\nf 1/1 3/2 2/3\nf 1/4 2/5 4/6\n");
    assert_int_equal(m.vertex_count, 6);
    static const uint32_t point[] = {0, 1, 2, 3, 0, 1};
    assert_memory_equal(m.point, point, sizeof point);
    assert_memory_equal(m.smooth, point, sizeof point);
    mesh_destroy(&m);
}

static void pictures_without_a_place_are_told(void **state)
{
    (void)state;
    static const char seam[] = "mtllib head.mtl\nv 0 0 0\nv 100 0 0\nv 100 200 0\nv 0 200 0\n"
                               "vt 0 0\nvt 1 0\nvt 1 1\nusemtl skin\n"
                               "f 1/1 2/2 3/3\nf 1/2 3/3 4/1\n";
    error err = {""};
    char path[128];
    (void)snprintf(path, sizeof path, "%s/head/head.obj", folder);
    put("head/head.mtl", "newmtl skin\nKd 1 0 0\nmap_Kd skin.png\n");
    mesh m = read_head("mtllib head.mtl\nv 0 0 0\nv 1 0 0\nv 0 9 0\nusemtl skin\nf 1 2 3\n");
    expect_note(&m, "its pictures are not drawn: it has no texture coordinates");
    assert_true(m.image_count == 0 && m.material[0].base_colour[1] == 0.0f);
    mesh_destroy(&m);
    m = read_head(seam);
    assert_int_equal(m.vertex_count, 5);
    mesh_destroy(&m);
    /* A rig that was made before. */
    const mesh_frame known = {.mm_per_unit = 1.0, .vertices = MESH_VERTICES_AS_WRITTEN};
    assert_int_equal(mesh_file_read(&m, path, &known, &err), MRT_OK);
    assert_int_equal(m.vertex_count, 4);
    expect_note(&m, "they need more vertices than the rig was made for");
    mesh_destroy(&m);
}

static mrt_result list(void *self, const char *name, error *err)
{
    (void)err;
    strcat(strcat(self, name), ";");
    return MRT_OK;
}

static void what_belongs_to_it_is_told(void **state)
{
    (void)state;
    static const char text[] = "mtllib head.mtl\nmtllib gone.mtl\n" HEAD;
    char directory[128], told[256] = "";
    error err = {""};
    mesh m = read_with("map_Kd C:\\skin.png\nmap_Ke gone.png\nmap_d ../outside.png");
    mesh_destroy(&m);
    (void)snprintf(directory, sizeof directory, "%s/head/", folder);
    assert_int_equal(obj_files(text, strlen(text), directory, list, told, &err), MRT_OK);
    assert_string_equal(told, "head.mtl;skin.png;");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_material_has_the_colours_that_its_file_says),
        cmocka_unit_test(how_clear_it_is_has_two_words),
        cmocka_unit_test(pictures_lie_on_it_as_it_says),
        cmocka_unit_test(a_picture_of_its_own_alpha_is_cut_out),
        cmocka_unit_test(names_of_other_disks_are_looked_for_beside),
        cmocka_unit_test(materials_in_a_folder_name_pictures_from_there),
        cmocka_unit_test(what_is_missing_or_outside_is_told),
        cmocka_unit_test(a_head_without_its_materials_is_grey),
        cmocka_unit_test(split_vertices_are_one_point),
        cmocka_unit_test(pictures_without_a_place_are_told),
        cmocka_unit_test(what_belongs_to_it_is_told),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
