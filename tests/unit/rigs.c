#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/mesh_file.h"
#include "io/openmesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mesh read_mesh(const char *path)
{
    mesh m;
    error err = {0};
    if (mesh_file_read(&m, path, NULL, &err) < 0)
        fail_msg("%s", err.text);
    return m;
}

static mesh read_moai(void)
{
    return read_mesh(SOURCE_DIR "/rigs/moai/moai.glb");
}

static topology topology_of(const mesh *m)
{
    topology t;
    error err = {0};
    if (openmesh_topology(&t, m, &err) < 0)
        fail_msg("%s", err.text);
    return t;
}

typedef struct triangle_shape {
    double area_mm2, smallest_angle_deg;
    double volume_mm3; /* of the pyramid to the origin, below 0 if it is seen from the inside */
} triangle_shape;

static void corner_of(const mesh *m, uint32_t triangle, int corner, double out[3])
{
    const float *p = m->position + 3 * (size_t)m->triangle[3 * (size_t)triangle + (size_t)corner];
    for (int k = 0; k < 3; ++k)
        out[k] = (double)p[k];
}

static void cross_of(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot_of(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static triangle_shape shape_of(const mesh *m, uint32_t triangle)
{
    double p[3][3], normal[3], cross[3];
    triangle_shape out = {.smallest_angle_deg = 180.0};
    for (int k = 0; k < 3; ++k)
        corner_of(m, triangle, k, p[k]);
    for (int k = 0; k < 3; ++k) {
        double u[3], v[3];
        for (int axis = 0; axis < 3; ++axis) {
            u[axis] = p[(k + 1) % 3][axis] - p[k][axis];
            v[axis] = p[(k + 2) % 3][axis] - p[k][axis];
        }
        cross_of(u, v, normal);
        double twice_area = sqrt(dot_of(normal, normal));
        double angle_deg = atan2(twice_area, dot_of(u, v)) * 57.29577951308232;
        out.area_mm2 = 0.5 * twice_area;
        out.smallest_angle_deg = fmin(out.smallest_angle_deg, angle_deg);
    }
    cross_of(p[1], p[2], cross);
    out.volume_mm3 = dot_of(p[0], cross) / 6.0;
    return out;
}

static void moai_has_the_papers_7152_triangles(void **state)
{
    (void)state;
    mesh m = read_moai();
    assert_int_equal(m.triangle_count, 7152);
    assert_int_equal(m.vertex_count, 3578);
    mesh_destroy(&m);
}

static void moai_is_one_closed_manifold_without_handles(void **state)
{
    (void)state;
    mesh m = read_moai();
    topology t = topology_of(&m);
    assert_int_equal(t.rejected_count, 0);
    assert_int_equal(t.border_loop_count, 0);
    assert_int_equal(t.isolated_vertex_count, 0);
    assert_int_equal(t.component_count, 1);
    uint32_t edge_count = t.neighbour_start[t.vertex_count] / 2;
    assert_int_equal((int64_t)m.vertex_count - edge_count + m.triangle_count, 2);
    topology_destroy(&t);
    mesh_destroy(&m);
}

static void moai_is_300_mm_high_and_looks_along_z(void **state)
{
    (void)state;
    mesh m = read_moai();
    float low[3], high[3];
    mesh_bounds(&m, low, high);
    assert_float_equal(high[1] - low[1], 300.0f, 3.0f);
    assert_float_equal(low[0] + high[0], 0.0f, 1e-4f);
    /* The point furthest out along +z is the tip of the nose: on the middle, below the eyes. */
    uint32_t tip = 0;
    for (uint32_t v = 1; v < m.vertex_count; ++v)
        if (m.position[3 * (size_t)v + 2] > m.position[3 * (size_t)tip + 2])
            tip = v;
    assert_float_equal(m.position[3 * (size_t)tip], 0.0f, 20.0f);
    assert_float_equal(m.position[3 * (size_t)tip + 1], -18.0f, 12.0f);
    mesh_destroy(&m);
}

static int compare_points(const void *a, const void *b)
{
    const float *p = a, *q = b;
    for (int k = 0; k < 3; ++k)
        if (p[k] < q[k] || p[k] > q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Exact: the mirror image is the same numbers but for the sign of x. */
static void moai_is_symmetric_in_x(void **state)
{
    (void)state;
    mesh m = read_moai();
    size_t size = (size_t)m.vertex_count * 3 * sizeof(float);
    float *point = malloc(size), *image = malloc(size);
    assert_non_null(point);
    assert_non_null(image);
    for (size_t i = 0; i < (size_t)m.vertex_count * 3; ++i) {
        point[i] = m.position[i];
        image[i] = i % 3 == 0 ? -m.position[i] : m.position[i];
    }
    qsort(point, m.vertex_count, 3 * sizeof(float), compare_points);
    qsort(image, m.vertex_count, 3 * sizeof(float), compare_points);
    for (size_t i = 0; i < (size_t)m.vertex_count * 3; ++i)
        assert_float_equal(point[i], image[i], 0.0f);
    free(point);
    free(image);
    mesh_destroy(&m);
}

static void moai_faces_outwards_with_a_heads_volume(void **state)
{
    (void)state;
    mesh m = read_moai();
    double volume_mm3 = 0.0;
    for (uint32_t t = 0; t < m.triangle_count; ++t)
        volume_mm3 += shape_of(&m, t).volume_mm3;
    /* Its box is 126 by 300 by 138 mm. */
    assert_true(volume_mm3 > 0.4 * 126 * 300 * 138);
    assert_true(volume_mm3 < 0.8 * 126 * 300 * 138);
    mesh_destroy(&m);
}

static void moai_has_no_thin_triangles(void **state)
{
    (void)state;
    mesh m = read_moai();
    uint32_t thin_count = 0;
    for (uint32_t t = 0; t < m.triangle_count; ++t) {
        triangle_shape shape = shape_of(&m, t);
        assert_true(shape.smallest_angle_deg > 15.0);
        assert_true(shape.area_mm2 > 0.8);
        thin_count += shape.smallest_angle_deg < 25.0;
    }
    assert_true(thin_count < m.triangle_count / 40);
    mesh_destroy(&m);
}

/* Of the triangles whose first corner lies between the two. */
static double mean_area_mm2(const mesh *m, double low_z, double high_z)
{
    double sum = 0.0;
    uint32_t count = 0;
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        double p[3];
        corner_of(m, t, 0, p);
        if (p[2] < low_z || p[2] > high_z)
            continue;
        sum += shape_of(m, t).area_mm2;
        ++count;
    }
    return count ? sum / count : 0.0;
}

static void moai_is_denser_in_the_face_than_behind(void **state)
{
    (void)state;
    mesh m = read_moai();
    double face = mean_area_mm2(&m, 30.0, 100.0), back = mean_area_mm2(&m, -100.0, -45.0);
    assert_true(face < 16.0);
    assert_true(back > 5.0 * face);
    mesh_destroy(&m);
}

typedef struct pull {
    double at[3], by[3];
} pull;

/* One control vector under a Wendland C2 function of a quarter of the head's height. */
static void pull_by(mesh *m, const pull *p)
{
    const double radius_mm = 75.0;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        float *at = m->position + 3 * (size_t)v;
        double offset[3];
        for (int k = 0; k < 3; ++k)
            offset[k] = (double)at[k] - p->at[k];
        double r = sqrt(dot_of(offset, offset)) / radius_mm, s = 1.0 - r;
        for (int k = 0; k < 3 && s > 0.0; ++k)
            at[k] += (float)(s * s * s * s * (4.0 * r + 1.0) * p->by[k]);
    }
}

static void normal_of(const mesh *m, uint32_t triangle, double out[3])
{
    double p[3][3], u[3], v[3];
    for (int k = 0; k < 3; ++k)
        corner_of(m, triangle, k, p[k]);
    for (int k = 0; k < 3; ++k) {
        u[k] = p[1][k] - p[0][k];
        v[k] = p[2][k] - p[0][k];
    }
    cross_of(u, v, out);
}

static void moai_keeps_its_triangles_when_it_is_performed(void **state)
{
    (void)state;
    static const pull PULLS[] = {
        {{25, 72, 58}, {0, 25, 5}},   /* brow up */
        {{0, -100, 60}, {0, -25, 0}}, /* chin down */
        {{0, -60, 60}, {0, -15, 0}},  /* lower lip down */
        {{45, -20, 20}, {15, 10, 10}} /* cheek out */,
        {{27, -54, 52}, {20, 10, -5}} /* corner of the mouth */,
    };
    for (size_t i = 0; i < sizeof PULLS / sizeof PULLS[0]; ++i) {
        mesh rest = read_moai(), pulled = read_moai();
        pull_by(&pulled, &PULLS[i]);
        for (uint32_t t = 0; t < rest.triangle_count; ++t) {
            double before[3], after[3];
            normal_of(&rest, t, before);
            normal_of(&pulled, t, after);
            assert_true(dot_of(before, after) > 0.0);
            assert_true(shape_of(&pulled, t).smallest_angle_deg > 12.0);
        }
        mesh_destroy(&rest);
        mesh_destroy(&pulled);
    }
}

static int joins_along_lips(const mesh *m, uint32_t vertex, float height_mm)
{
    const float *p = m->position + 3 * (size_t)vertex;
    return fabsf(p[1] - height_mm) < 1e-3f && p[2] > 50.0f && fabsf(p[0]) < 27.5f;
}

/* Up from the height or down from it: the side on which the triangle lies, 0 for both. */
static int side_of(const mesh *m, uint32_t triangle, float height_mm)
{
    int above = 0, below = 0;
    for (int k = 0; k < 3; ++k) {
        float y = m->position[3 * (size_t)m->triangle[3 * (size_t)triangle + (size_t)k] + 1];
        above |= y > height_mm + 1e-3f;
        below |= y < height_mm - 1e-3f;
    }
    return above - below;
}

typedef struct lip_point {
    float at[3];
    int above, below; /* triangles of the vertex there */
} lip_point;

static int compare_lip_points(const void *a, const void *b)
{
    const lip_point *p = a, *q = b;
    return (p->at[0] > q->at[0]) - (p->at[0] < q->at[0]);
}

/* The lips part along one height: from corner to corner each point is there twice, once as a vertex
 * of the upper lip and once, at the same place, as one of the lower: no gap, and nothing that would
 * tear when the mouth opens. */
static void moai_lips_meet_without_a_gap_and_part(void **state)
{
    (void)state;
    enum { POINTS_MAX = 128 };
    const float height_mm = -54.0f;
    static lip_point point[POINTS_MAX];
    uint32_t count = 0, corner_count = 0;
    mesh m = read_moai();
    for (uint32_t v = 0; v < m.vertex_count; ++v) {
        if (!joins_along_lips(&m, v, height_mm))
            continue;
        assert_true(count < POINTS_MAX);
        lip_point *p = &point[count++];
        memcpy(p->at, m.position + 3 * (size_t)v, sizeof p->at);
        p->above = p->below = 0;
        for (uint32_t i = 0; i < 3 * m.triangle_count; ++i)
            if (m.triangle[i] == v) {
                p->above += side_of(&m, i / 3, height_mm) > 0;
                p->below += side_of(&m, i / 3, height_mm) < 0;
            }
    }
    qsort(point, count, sizeof *point, compare_lip_points);
    assert_true(count >= 2 * 11 + 2);
    assert_true(point[0].at[0] < -20.0f);
    for (uint32_t i = 0; i < count; ++i) {
        if (point[i].above && point[i].below) {
            assert_true(i == 0 || i == count - 1);
            ++corner_count;
            continue;
        }
        uint32_t other = i % 2 ? i + 1 : i - 1; /* behind the first corner, in pairs */
        assert_memory_equal(point[i].at, point[other].at, sizeof point[i].at);
        assert_true(!point[i].above == !point[other].below);
    }
    assert_int_equal(corner_count, 2);
    mesh_destroy(&m);
}

/* Behind the slit, inside the stone, dark. */
static void moai_has_a_mouth_of_its_own(void **state)
{
    (void)state;
    mesh m = read_moai();
    assert_int_equal(m.part_count, 2);
    assert_string_equal(m.part[1].name, "mouth");
    const mesh_material *dark = &m.material[m.part[1].material];
    assert_true(dark->base_colour[0] < 0.05f * m.material[0].base_colour[0] + 0.005f);
    float low[3] = {1e3f, 1e3f, 1e3f}, high[3] = {-1e3f, -1e3f, -1e3f};
    for (uint32_t i = 3 * m.part[1].first_triangle;
         i < 3 * (m.part[1].first_triangle + m.part[1].triangle_count); ++i)
        for (int k = 0; k < 3; ++k) {
            float x = m.position[3 * (size_t)m.triangle[i] + (size_t)k];
            low[k] = fminf(low[k], x);
            high[k] = fmaxf(high[k], x);
        }
    assert_true(high[2] < 56.0f && low[2] < 30.0f); /* behind the lips, and deep */
    assert_true(high[1] > -44.0f && low[1] < -64.0f);
    assert_true(low[0] > -32.0f && high[0] < 32.0f);
    mesh_destroy(&m);
}

static void moai_is_of_stone(void **state)
{
    (void)state;
    mesh m = read_moai();
    assert_string_equal(m.part[0].name, "stone");
    assert_string_equal(m.material[0].name, "stone");
    assert_true(m.part[0].triangle_count > 0.9 * m.triangle_count);
    for (uint32_t i = 0; i < m.material_count; ++i) {
        assert_float_equal(m.material[i].roughness, 0.95f, 1e-6f);
        assert_float_equal(m.material[i].metallic, 0.0f, 1e-6f);
    }
    mesh_destroy(&m);
}

static void check_plane(const char *name, uint32_t vertex_count, uint32_t triangle_count)
{
    char path[1024];
    (void)snprintf(path, sizeof path, BUILD_DIR "/rigs/plane/%s.ply", name);
    mesh m;
    error err = {0};
    if (mesh_file_read(&m, path, &(mesh_frame){.mm_per_unit = 1.0}, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(m.vertex_count, vertex_count);
    assert_int_equal(m.triangle_count, triangle_count);
    float low[3], high[3];
    mesh_bounds(&m, low, high);
    for (int axis = 0; axis < 3; ++axis) {
        float half_mm = axis == 2 ? 0.0f : 33.06f;
        assert_float_equal(low[axis], -half_mm, 1e-5f);
        assert_float_equal(high[axis], half_mm, 1e-5f);
    }
    /* Every triangle is one part in triangle_count of the square, seen from +z. */
    double area_mm2 = 66.12 * 66.12 / triangle_count;
    for (uint32_t t = 0; t < m.triangle_count; ++t) {
        double p[3][3];
        for (int k = 0; k < 3; ++k)
            corner_of(&m, t, k, p[k]);
        double signed_mm2 = 0.5 * ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) -
                                   (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]));
        assert_true(fabs(signed_mm2 - area_mm2) < 1e-4 * area_mm2);
    }
    topology t = topology_of(&m);
    assert_int_equal(t.rejected_count, 0);
    assert_int_equal(t.isolated_vertex_count, 0);
    assert_int_equal(t.component_count, 1);
    assert_int_equal(t.border_loop_count, 1);
    topology_destroy(&t);
    mesh_destroy(&m);
}

static void planes_are_the_papers_grids(void **state)
{
    (void)state;
    check_plane("plane_2048", 33 * 33, 2048);
    check_plane("plane_8192", 65 * 65, 8192);
    check_plane("plane_32768", 129 * 129, 32768);
}

static void largest_plane_has_a_vertex_in_every_quad(void **state)
{
    (void)state;
    check_plane("plane_65536", 33025, 65536);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moai_has_the_papers_7152_triangles),
        cmocka_unit_test(moai_is_one_closed_manifold_without_handles),
        cmocka_unit_test(moai_is_300_mm_high_and_looks_along_z),
        cmocka_unit_test(moai_is_symmetric_in_x),
        cmocka_unit_test(moai_faces_outwards_with_a_heads_volume),
        cmocka_unit_test(moai_has_no_thin_triangles),
        cmocka_unit_test(moai_is_denser_in_the_face_than_behind),
        cmocka_unit_test(moai_keeps_its_triangles_when_it_is_performed),
        cmocka_unit_test(moai_lips_meet_without_a_gap_and_part),
        cmocka_unit_test(moai_has_a_mouth_of_its_own),
        cmocka_unit_test(moai_is_of_stone),
        cmocka_unit_test(planes_are_the_papers_grids),
        cmocka_unit_test(largest_plane_has_a_vertex_in_every_quad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
