/* tests/unit/mesh_frame.c - the unit and the axes of a mesh file: what a person says holds, what
 * the skeleton or the shape clearly says is found and told, and all else stays as it is. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/mesh_file.h"
#include "io/read/mesh_frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const mesh_frame gltf = {.mm_per_unit = 1000.0, .up = MESH_AXIS_Y, .forward = MESH_AXIS_Z};
static const mesh_frame in_mm = {.mm_per_unit = 1.0}, stl = {.up = MESH_AXIS_Z};

/* The Moai, 300 mm high, as a mesh in mm, to be turned and scaled. */
static mesh read_moai(void)
{
    mesh m;
    error err = {""};
    if (mesh_file_read(&m, SOURCE_DIR "/rigs/moai/moai.glb", NULL, &err) < 0)
        fail_msg("%s", err.text);
    m.up = m.forward = MESH_AXIS_AUTO;
    return m;
}

/* Into a file's coordinates: rows say where the file has the mesh's x, y and z. */
static void put_into(mesh *m, const int axis[3], const float sign[3], float scale)
{
    for (float *p = m->position, *end = p + (size_t)m->vertex_count * 3; p < end; p += 3) {
        const float from[3] = {p[0], p[1], p[2]};
        for (int i = 0; i < 3; ++i)
            p[axis[i]] = scale * sign[i] * from[i];
    }
}

static void assert_same_shape(const mesh *a, const mesh *b, double tolerance_mm)
{
    for (size_t i = 0; i < (size_t)a->vertex_count * 3; ++i)
        if (!(fabs((double)a->position[i] - (double)b->position[i]) <= tolerance_mm))
            fail_msg("vertex %zu is elsewhere", i / 3);
}

static void a_head_with_z_upwards_is_turned(void **state)
{
    (void)state;
    mesh original = read_moai(), m = read_moai();
    error err;
    put_into(&m, (const int[]){0, 2, 1}, (const float[]){1, 1, -1}, 0.001f); /* y -> z, z -> -y */
    assert_int_equal(mesh_frame_apply(&m, &(mesh_frame){0}, &(mesh_frame){0}, &err), MRT_OK);
    assert_int_equal(m.up, MESH_AXIS_Z);
    assert_int_equal(m.forward, MESH_AXIS_MINUS_Y);
    assert_same_shape(&original, &m, 0.001);
    assert_non_null(strstr(m.note, "up z, forward -y (from its shape)"));
    assert_non_null(strstr(m.note, "assumed unit: m, which makes the height 300 mm"));
    mesh_destroy(&m);
    mesh_destroy(&original);
}

static void a_head_that_looks_away_is_turned_round(void **state)
{
    (void)state;
    mesh original = read_moai(), m = read_moai();
    error err;
    put_into(&m, (const int[]){0, 1, 2}, (const float[]){-1, 1, -1}, 0.1f);
    assert_int_equal(mesh_frame_apply(&m, &(mesh_frame){0}, &(mesh_frame){0}, &err), MRT_OK);
    assert_int_equal(m.forward, MESH_AXIS_MINUS_Z);
    assert_same_shape(&original, &m, 0.001);
    mesh_destroy(&m);
    mesh_destroy(&original);
}

static void a_head_that_looks_aside_is_turned(void **state)
{
    (void)state;
    static const struct {
        int axis[3];
        float sign[3];
        mesh_axis up, forward;
    } row[] = {{{2, 1, 0}, {-1, 1, 1}, MESH_AXIS_Y, MESH_AXIS_X},
               {{2, 1, 0}, {1, 1, -1}, MESH_AXIS_Y, MESH_AXIS_MINUS_X},
               {{0, 2, 1}, {-1, 1, 1}, MESH_AXIS_Z, MESH_AXIS_Y}};
    for (size_t i = 0; i < sizeof row / sizeof *row; ++i) {
        mesh original = read_moai(), m = read_moai();
        error err;
        put_into(&m, row[i].axis, row[i].sign, 0.1f);
        assert_int_equal(mesh_frame_apply(&m, &(mesh_frame){0}, &(mesh_frame){0}, &err), MRT_OK);
        assert_int_equal(m.up, row[i].up);
        assert_int_equal(m.forward, row[i].forward);
        assert_same_shape(&original, &m, 0.001);
        mesh_destroy(&m);
        mesh_destroy(&original);
    }
}

/* As some programs write glTF: it stands as it is, for that is what the format prescribes. */
static void gltf_on_its_back_stands(void **state)
{
    (void)state;
    mesh m = read_moai();
    error err;
    put_into(&m, (const int[]){0, 2, 1}, (const float[]){1, 1, -1}, 0.001f);
    assert_int_equal(mesh_frame_apply(&m, &(mesh_frame){0}, &gltf, &err), MRT_OK);
    assert_int_equal(m.up, MESH_AXIS_Y);
    assert_int_equal(m.forward, MESH_AXIS_Z);
    mesh_destroy(&m);
}

static void stl_has_z_up(void **state)
{
    (void)state;
    static const struct {
        int axis[3];
        float sign[3];
        mesh_axis forward;
    } row[] = {{{0, 2, 1}, {1, 1, -1}, MESH_AXIS_MINUS_Y},
               {{0, 2, 1}, {-1, 1, 1}, MESH_AXIS_Y},
               {{1, 2, 0}, {1, 1, 1}, MESH_AXIS_X},
               {{1, 2, 0}, {-1, 1, -1}, MESH_AXIS_MINUS_X}};
    for (size_t i = 0; i < sizeof row / sizeof *row; ++i) {
        mesh original = read_moai(), m = read_moai();
        error err;
        put_into(&m, row[i].axis, row[i].sign, 1.0f);
        assert_int_equal(mesh_frame_apply(&m, &(mesh_frame){0}, &stl, &err), MRT_OK);
        assert_int_equal(m.up, MESH_AXIS_Z);
        assert_int_equal(m.forward, row[i].forward);
        assert_same_shape(&original, &m, 0.001);
        mesh_destroy(&m);
        mesh_destroy(&original);
    }
}

static void what_is_said_holds(void **state)
{
    (void)state;
    mesh original = read_moai(), m = read_moai();
    error err = {""};
    put_into(&m, (const int[]){2, 0, 1}, (const float[]){1, 1, 1}, 4.0f); /* x up, y forward */
    const mesh_frame said = {.mm_per_unit = 0.25, .up = MESH_AXIS_X, .forward = MESH_AXIS_Y};
    free(m.note);
    m.note = NULL;
    assert_int_equal(mesh_frame_apply(&m, &said, &gltf, &err), MRT_OK);
    assert_same_shape(&original, &m, 0.001);
    assert_true(m.mm_per_unit == 0.25);
    assert_null(m.note);
    const mesh_frame line = {.mm_per_unit = 0.25, .up = MESH_AXIS_X, .forward = MESH_AXIS_MINUS_X};
    assert_true(mesh_frame_apply(&m, &line, &gltf, &err) < 0);
    assert_non_null(strstr(err.text, "--up x and --forward -x are on one line"));
    mesh_destroy(&m);
    mesh_destroy(&original);
}

static void one_axis_brings_the_other(void **state)
{
    (void)state;
    static const struct {
        mesh_frame said;
        mesh_axis up, forward;
    } cases[] = {{{.up = MESH_AXIS_Z}, MESH_AXIS_Z, MESH_AXIS_MINUS_Y},
                 {{.up = MESH_AXIS_Y}, MESH_AXIS_Y, MESH_AXIS_Z},
                 {{.forward = MESH_AXIS_MINUS_Y}, MESH_AXIS_Z, MESH_AXIS_MINUS_Y},
                 {{.forward = MESH_AXIS_X}, MESH_AXIS_Y, MESH_AXIS_X}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        mesh m = read_moai();
        error err;
        assert_int_equal(mesh_frame_apply(&m, &cases[i].said, &in_mm, &err), MRT_OK);
        assert_int_equal(m.up, cases[i].up);
        assert_int_equal(m.forward, cases[i].forward);
        mesh_destroy(&m);
    }
}

/* A skeleton knows better than the shape. Left is towards -x: so the face looks to -z. */
static void add_joint(mesh *m, const char *name, const float at[3])
{
    mesh_joint *grown = realloc(m->joint, (m->joint_count + 1) * sizeof *grown);
    assert_non_null(grown);
    m->joint = grown;
    grown[m->joint_count++] = (mesh_joint){
        strdup(name), strdup(""), MESH_NO_JOINT, {1, 0, 0, at[0], 0, 1, 0, at[1], 0, 0, 1, at[2]}};
}

static void a_skeleton_says_where_a_face_looks(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        float at[3];
    } joints[] = {{"mixamorig:Hips", {0, 100, 0}},
                  {"mixamorig:Head", {0, 250, 0}},
                  {"mixamorig:LeftArm", {-60, 200, 0}},
                  {"mixamorig:RightArm", {60, 200, 0}},
                  {"eye.L", {-3, 250, -8}},
                  {"eye.R", {3, 250, -8}},
                  {"rotor", {0, 0, 0}}};
    enum { JOINTS = sizeof joints / sizeof *joints };
    mesh original = read_moai(), m = read_moai();
    error err;
    for (uint32_t i = 0; i < JOINTS; ++i)
        add_joint(&m, joints[i].name, joints[i].at);
    assert_int_equal(mesh_frame_apply(&m, &(mesh_frame){0}, &in_mm, &err), MRT_OK);
    assert_int_equal(m.up, MESH_AXIS_Y);
    assert_int_equal(m.forward, MESH_AXIS_MINUS_Z);
    assert_non_null(strstr(m.note, "from its skeleton"));
    assert_true(m.joint[2].rest[3] == 60.0f && m.joint[4].rest[11] == 8.0f);
    assert_true(m.position[0] == -original.position[0] && m.position[2] == -original.position[2]);
    mesh_destroy(&m);
    mesh_destroy(&original);
}

static void heads_and_bodies_get_a_height(void **state)
{
    (void)state;
    static const struct {
        float scale[3]; /* of the Moai's box, 130 x 300 x 139 mm */
        double format_mm, expected_mm;
    } cases[] = {{{1, 1, 1}, 1.0, 300},                    /* as it is */
                 {{0.01f, 0.01f, 0.01f}, 1000.0, 300},     /* 3 units in glTF: a head of one unit */
                 {{0.1f, 0.1f, 0.1f}, 1000.0, 300},        /* 30 units in glTF: cm */
                 {{0.001f, 0.001f, 0.001f}, 0.0, 300},     /* m */
                 {{0.004f, 0.006f, 0.002f}, 1000.0, 1800}, /* a body */
                 {{0.4f, 0.6f, 0.2f}, 0.0, 1800},          /* in cm */
                 {{0.0001f, 0.0001f, 0.0001f}, 1000.0, 300}}; /* 0.03 units: nothing */
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        mesh m = read_moai();
        error err;
        float low[3], high[3];
        for (size_t v = 0; v < (size_t)m.vertex_count * 3; ++v)
            m.position[v] *= cases[i].scale[v % 3];
        const mesh_frame upright = {.up = MESH_AXIS_Y, .forward = MESH_AXIS_Z};
        assert_int_equal(
            mesh_frame_apply(&m, &upright, &(mesh_frame){.mm_per_unit = cases[i].format_mm}, &err),
            MRT_OK);
        mesh_bounds(&m, low, high);
        double height_mm = (double)high[1] - (double)low[1];
        if (!(fabs(height_mm - cases[i].expected_mm) < 0.05 * cases[i].expected_mm))
            fail_msg("case %zu: %g mm high", i, height_mm);
        mesh_destroy(&m);
    }
}

/* Two people in one file are wider than tall, and no head for that. */
static void a_skeleton_says_that_it_is_a_body(void **state)
{
    (void)state;
    static const float scale[3] = {0.02f, 0.006f, 0.02f}; /* 2.6 x 1.8 x 2.8 m */
    mesh m = read_moai();
    error err;
    float low[3], high[3];
    for (size_t v = 0; v < (size_t)m.vertex_count * 3; ++v)
        m.position[v] *= scale[v % 3];
    mesh_bounds(&m, low, high);
    const float height = high[1] - low[1];
    add_joint(&m, "Hips", (const float[3]){0, low[1] + 0.5f * height, 0});
    add_joint(&m, "Head", (const float[3]){0, low[1] + 0.9f * height, 0});
    const mesh_frame upright = {.up = MESH_AXIS_Y, .forward = MESH_AXIS_Z};
    assert_int_equal(mesh_frame_apply(&m, &upright, &gltf, &err), MRT_OK);
    assert_true(m.mm_per_unit == 1000.0);
    assert_false(m.is_unit_guessed);
    mesh_destroy(&m);
}

static void the_eight_heads_stand_and_look_ahead(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        mesh_axis forward;
        double height_mm;
    } heads[] = {
        {"rpm_arkit.glb", MESH_AXIS_Z, 1865}, {"girl.glb", MESH_AXIS_Z, 1819},
        {"reyn_head.glb", MESH_AXIS_Z, 273},  {"bust.gltf", MESH_AXIS_Z, 188},
        {"suzanne.glb", MESH_AXIS_Z, 300},    {"leeperry_draco.glb", MESH_AXIS_Z, 300},
        {"homer.obj", MESH_AXIS_Z, 840},      {"cryptovoxels.vrm", MESH_AXIS_MINUS_Z, 1490}};
    const char *shared = getenv("MAROTTE_SHARED");
    for (size_t i = 0; i < sizeof heads / sizeof *heads; ++i) {
        char path[1024];
        (void)snprintf(path, sizeof path, "%s/data/heads/%s",
                       shared ? shared : SOURCE_DIR "/../shared", heads[i].name);
        if (access(path, R_OK) != 0) {
            print_message("SKIPPED: %s is not there\n", path);
            skip();
        }
        mesh m;
        error err = {""};
        if (mesh_file_read(&m, path, NULL, &err) < 0)
            fail_msg("%s", err.text);
        float low[3], high[3];
        mesh_bounds(&m, low, high);
        double height_mm = (double)high[1] - (double)low[1];
        if (m.up != MESH_AXIS_Y || m.forward != heads[i].forward ||
            !(fabs(height_mm - heads[i].height_mm) < 0.05 * heads[i].height_mm))
            fail_msg("%s: up %s, forward %s, %g mm high", heads[i].name, mesh_axis_name(m.up),
                     mesh_axis_name(m.forward), height_mm);
        mesh_destroy(&m);
    }
}

static void words_are_read(void **state)
{
    (void)state;
    double mm;
    mesh_axis axis;
    assert_true(mesh_unit_parse(&mm, "cm") && mm == 10.0);
    assert_true(mesh_unit_parse(&mm, "25.4") && mm == 25.4);
    assert_false(mesh_unit_parse(&mm, "inch") || mesh_unit_parse(&mm, "0") ||
                 mesh_unit_parse(&mm, "-1") || mesh_unit_parse(&mm, "nan"));
    assert_true(mesh_axis_parse(&axis, "-y") && axis == MESH_AXIS_MINUS_Y);
    assert_true(mesh_axis_parse(&axis, "+z") && axis == MESH_AXIS_Z);
    assert_false(mesh_axis_parse(&axis, "w") || mesh_axis_parse(&axis, "") ||
                 mesh_axis_parse(&axis, "+"));
}

int main(void)
{
    (void)setenv("MAROTTE_MESHLOAD", BUILD_DIR "/marotte-meshload", 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_head_with_z_upwards_is_turned),
        cmocka_unit_test(a_head_that_looks_away_is_turned_round),
        cmocka_unit_test(a_head_that_looks_aside_is_turned),
        cmocka_unit_test(gltf_on_its_back_stands),
        cmocka_unit_test(stl_has_z_up),
        cmocka_unit_test(what_is_said_holds),
        cmocka_unit_test(one_axis_brings_the_other),
        cmocka_unit_test(a_skeleton_says_where_a_face_looks),
        cmocka_unit_test(heads_and_bodies_get_a_height),
        cmocka_unit_test(a_skeleton_says_that_it_is_a_body),
        cmocka_unit_test(the_eight_heads_stand_and_look_ahead),
        cmocka_unit_test(words_are_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
