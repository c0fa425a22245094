#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_gltf_reader.h"
#include "export_scene.h"

static char folder[256], path[300];

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "face.glb");
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder);
}

/* Angle between two directions, in degrees. */
static double angle_deg(const double *a, const double *b)
{
    double dot = 0.0, aa = 0.0, bb = 0.0;
    for (int i = 0; i < 3; ++i) {
        dot += a[i] * b[i];
        aa += a[i] * a[i];
        bb += b[i] * b[i];
    }
    return acos(fmin(1.0, dot / sqrt(aa * bb))) * 57.29577951308232;
}

static void shape_normals(double *out, const mesh *m, const float *shape)
{
    memset(out, 0, (size_t)m->vertex_count * 3 * sizeof *out);
    for (size_t i = 0; i < (size_t)m->triangle_count * 3; i += 3) {
        const uint32_t *t = m->triangle + i;
        double e[2][3];
        for (size_t k = 0; k < 6; ++k)
            e[k / 3][k % 3] =
                (double)shape[t[1 + k / 3] * 3 + k % 3] - (double)shape[t[0] * 3 + k % 3];
        for (size_t k = 0; k < 9; ++k) {
            size_t axis = k % 3, b = (axis + 1) % 3, c = (axis + 2) % 3;
            out[t[k / 3] * 3 + axis] += e[0][b] * e[1][c] - e[0][c] * e[1][b];
        }
    }
}

/* Greatest angle between the normals that the file shows at a key, with or without its normal
 * targets, and those of the true shape. */
static double normal_error_deg(const clip *c, const glb_face *face, uint32_t key, int with_targets)
{
    error err;
    const mesh *m = clip_mesh(c);
    float *shape = malloc(face->vertex_count * 3 * sizeof *shape);
    double *wanted = malloc(face->vertex_count * 3 * sizeof *wanted), greatest = 0.0;
    assert_int_equal(clip_read(c, key, shape, &err), MRT_OK);
    shape_normals(wanted, m, shape);
    for (size_t v = 0; v < face->vertex_count; ++v) {
        double n[3];
        for (size_t axis = 0; axis < 3; ++axis) {
            n[axis] = (double)face->normal[v * 3 + axis];
            for (size_t j = 0; with_targets && j < face->target_count; ++j)
                n[axis] += (double)face->weight[key * face->target_count + j] *
                           (double)face->target_normal[j][v * 3 + axis];
        }
        greatest = fmax(greatest, angle_deg(n, wanted + v * 3));
    }
    free(shape);
    free(wanted);
    return greatest;
}

/* A normal turns, it does not grow: its targets are perpendicular to it. */
static void expect_turns_only(const glb_face *face)
{
    for (size_t j = 0; j < face->target_count; ++j)
        for (size_t v = 0; v < face->vertex_count; ++v) {
            double dot = 0.0;
            for (size_t i = v * 3; i < v * 3 + 3; ++i) {
                dot += (double)face->normal[i] * (double)face->target_normal[j][i];
            }
            assert_true(fabs(dot) <= 1e-4); /* per metre, against turns of up to 50 */
        }
}

static void normals_follow_small_motions_to_first_order(void **state)
{
    (void)state;
    error err = {""};
    mesh m = scene_sheet(24);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    double displacement[SCENE_CONTROLS * 3] = {1.0, -0.5, 2.0, 0.5, 1.0, -1.5, -1.0, 0.3, 1.0};
    assert_int_equal(clip_add_anchored(c, displacement, &err), MRT_OK);
    if (gltf_write(path, c, NULL, NULL, NULL, &err) != MRT_OK)
        fail_msg("%s", err.text);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    double still = normal_error_deg(c, &face, 0, 0), followed = normal_error_deg(c, &face, 0, 1);
    assert_true(still > 2.0);
    assert_true(followed < 0.1 * still);
    expect_turns_only(&face);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void a_surface_without_area_has_the_normal_z(void **state)
{
    (void)state;
    error err = {""};
    mesh m;
    assert_int_equal(mesh_create(&m, 3, 1, &err), MRT_OK); /* all at the origin */
    m.triangle[1] = 1;
    m.triangle[2] = 2;
    m.target = calloc(1, sizeof *m.target);
    m.target_count = 1;
    scene_name(&m.target[0].name, "open");
    m.target[0].offset = calloc(9, sizeof(float));
    m.target[0].offset[3] = 10.0f;
    if (gltf_write_mesh(path, &m, &err) != MRT_OK)
        fail_msg("%s", err.text);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    for (size_t i = 0; i < 9; ++i) {
        assert_true(face.normal[i] == (i % 3 == 2 ? 1.0f : 0.0f));
        assert_true(face.target_normal[0][i] == 0.0f);
    }
    glb_face_finish(&face);
    glb_close(&g);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_follow_small_motions_to_first_order),
        cmocka_unit_test(a_surface_without_area_has_the_normal_z)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
