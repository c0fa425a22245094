#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "puppet_face.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>

static void puppet_is_a_face_of_15000_to_21000_vertices(void **state)
{
    (void)state;
    file_bytes bytes;
    error err = {0};
    assert_true(file_read(&bytes, PUPPET, 1500000, &err) >= 0);
    file_bytes_finish(&bytes);
    assert_in_range(face.vertex_count, 15000, 21000);
    float low[3], high[3];
    mesh_bounds(&face, low, high);
    assert_in_range((int)(high[1] - low[1]), 280, 321);
    assert_float_equal(low[1], -156.0f, 1e-3f);
}

static void puppet_has_its_parts(void **state)
{
    (void)state;
    static const char *const NAME[] = {
        "skin",
        "skin.lips",
        "nose",
        "mouth_bag",
        "teeth_upper",
        "teeth_upper.gum",
        "teeth_lower",
        "teeth_lower.gum",
        "tongue",
        "hair",
        "collar.wool",
        "eye.l",
        "eye.r",
        "eye.l.iris",
        "eye.r.iris",
        "eye.l.pupil",
        "eye.r.pupil",
        "lid_upper.l",
        "lid_upper.r",
        "lid_lower.l",
        "lid_lower.r",
        "lid_upper.l.lash",
        "lid_upper.r.lash",
        "lid_lower.l.lash",
        "lid_lower.r.lash",
        "brow.l",
        "brow.r",
        "ear.l",
        "ear.r",
    };
    size_t count = sizeof NAME / sizeof *NAME;
    assert_int_equal(face.part_count, count);
    assert_int_equal(face.material_count, count);
    for (size_t i = 0; i < count; ++i)
        assert_true(part_named(NAME[i])->triangle_count > 0);
}

typedef struct placed { /* a vertex and the parts that use it, left and right exchanged or not */
    float x, y, z;
    uint64_t parts;
} placed;

static int compare_placed(const void *a, const void *b)
{
    const placed *p = a, *q = b;
    const float d[3] = {p->x - q->x, p->y - q->y, p->z - q->z};
    for (int k = 0; k < 3; ++k)
        if (d[k] < 0.0f || d[k] > 0.0f)
            return d[k] < 0.0f ? -1 : 1;
    return (p->parts > q->parts) - (p->parts < q->parts);
}

/* The part of the other side, or the part itself. */
static uint32_t mirror_of(uint32_t part)
{
    char name[64];
    (void)snprintf(name, sizeof name, "%s", face.material[face.part[part].material].name);
    for (char *side = strchr(name, '.'); side; side = strchr(side + 1, '.')) {
        if ((side[1] != 'l' && side[1] != 'r') || (side[2] != '\0' && side[2] != '.'))
            continue;
        side[1] = side[1] == 'l' ? 'r' : 'l';
        return (uint32_t)(part_named(name) - face.part);
    }
    return part;
}

static void puppet_is_symmetric_in_x_with_its_parts(void **state)
{
    (void)state;
    placed *here = calloc(face.vertex_count, sizeof *here);
    placed *there = calloc(face.vertex_count, sizeof *there);
    assert_non_null(here);
    assert_non_null(there);
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        const float *p = face.position + 3 * (size_t)v;
        here[v] = (placed){p[0], p[1], p[2], 0};
        there[v] = (placed){-p[0], p[1], p[2], 0};
    }
    for (uint32_t i = 0; i < face.part_count; ++i) {
        uint64_t bit = UINT64_C(1) << i, image = UINT64_C(1) << mirror_of(i);
        const mesh_part *part = &face.part[i];
        for (size_t k = 0; k < 3 * (size_t)part->triangle_count; ++k) {
            uint32_t v = face.triangle[3 * (size_t)part->first_triangle + k];
            here[v].parts |= bit;
            there[v].parts |= image;
        }
    }
    qsort(here, face.vertex_count, sizeof *here, compare_placed);
    qsort(there, face.vertex_count, sizeof *there, compare_placed);
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        assert_int_equal(compare_placed(&here[v], &there[v]), 0);
    free(here);
    free(there);
}

/* Open are the neck, and felt where it sits on the skin: two ears and five locks of hair. */
static void puppet_is_manifold_and_open_only_where_meant(void **state)
{
    (void)state;
    assert_int_equal(net.rejected_count, 0);
    assert_int_equal(net.isolated_vertex_count, 0);
    /* skin with lips, nose and bag, 2 rows of teeth, tongue, 2 balls, 4 lids, 2 brows, 2 ears,
     * 5 locks, the collar */
    assert_int_equal(net.component_count, 20);
    assert_int_equal(net.border_loop_count, 8);
    uint8_t *skin = vertices_of("skin"), *hair = vertices_of("hair");
    int neck_count = 0, hair_count = 0;
    for (uint32_t i = 0; i < net.border_loop_count; ++i) {
        uint32_t first = net.border_vertex[net.border_loop_start[i]];
        hair_count += hair[first];
        neck_count += skin[first];
        for (uint32_t k = net.border_loop_start[i]; k < net.border_loop_start[i + 1]; ++k)
            if (skin[net.border_vertex[k]])
                assert_float_equal(point_of(net.border_vertex[k]).y, -150.0, 1e-3);
    }
    assert_int_equal(neck_count, 1);
    assert_int_equal(hair_count, 5);
    free(skin);
    free(hair);
}

static void puppet_has_no_slivers(void **state)
{
    (void)state;
    uint32_t thin_count = 0;
    for (uint32_t t = 0; t < face.triangle_count; ++t)
        for (uint32_t k = 0; k < 3; ++k) {
            vec3 u = vec3_sub(corner_of(t, (k + 1) % 3), corner_of(t, k));
            vec3 v = vec3_sub(corner_of(t, (k + 2) % 3), corner_of(t, k));
            double twice_area = vec3_length(vec3_cross(u, v));
            double angle_deg = atan2(twice_area, vec3_dot(u, v)) * 57.29577951308232;
            assert_true(twice_area > 0.04);
            assert_true(angle_deg > 6.0);
            thin_count += angle_deg < 12.0;
        }
    assert_true(thin_count < face.triangle_count / 100);
}

/* Of all parts whose names begin so; what is open is open towards `base`. */
static double volume_mm3(const char *beginning, vec3 base)
{
    double volume = 0.0;
    for (uint32_t i = 0; i < face.part_count; ++i) {
        const mesh_part *part = &face.part[i];
        if (strncmp(face.material[part->material].name, beginning, strlen(beginning)) != 0)
            continue;
        for (uint32_t k = 0; k < part->triangle_count; ++k) {
            vec3 p[3];
            for (uint32_t c = 0; c < 3; ++c)
                p[c] = vec3_sub(corner_of(part->first_triangle + k, c), base);
            volume += vec3_dot(p[0], vec3_cross(p[1], p[2])) / 6.0;
        }
    }
    return volume;
}

static void puppet_faces_outwards(void **state)
{
    (void)state;
    static const char *const CLOSED[] = {"teeth_upper", "teeth_lower", "tongue",      "eye.l",
                                         "eye.r",       "lid_upper.l", "lid_upper.r", "lid_lower.l",
                                         "lid_lower.r", "brow.l",      "brow.r",      "collar"};
    for (size_t i = 0; i < sizeof CLOSED / sizeof *CLOSED; ++i)
        assert_true(volume_mm3(CLOSED[i], (vec3){0, 0, 0}) > 2000.0);
    assert_true(volume_mm3("ear.l", (vec3){88, 14, -18}) > 2000.0);
    assert_true(volume_mm3("ear.r", (vec3){-88, 14, -18}) > 2000.0);
    assert_true(volume_mm3("hair", (vec3){0, 128, -12}) > 2000.0);
    /* The flesh between skin and bag, which is concave: about a ball of 100 mm. */
    const vec3 neck = {0.0, -150.0, 0.0};
    double flesh = volume_mm3("skin", neck) + volume_mm3("nose", neck);
    double bag = volume_mm3("mouth_bag", (vec3){0, -38, 88});
    assert_true(bag < -150e3 && bag > -600e3);
    assert_true(flesh > 3e6 && flesh < 6e6);
}

static int segment_meets(vec3 a, vec3 b, const vec3 t[3])
{
    vec3 along = vec3_sub(b, a), u = vec3_sub(t[1], t[0]), v = vec3_sub(t[2], t[0]);
    vec3 p = vec3_cross(along, v), from = vec3_sub(a, t[0]), q = vec3_cross(from, u);
    double det = vec3_dot(u, p);
    if (fabs(det) < 1e-12)
        return 0;
    double s = vec3_dot(from, p) / det, r = vec3_dot(along, q) / det, at = vec3_dot(v, q) / det;
    return s >= 0.0 && r >= 0.0 && s + r <= 1.0 && at >= 0.0 && at <= 1.0;
}

static int triangles_meet(uint32_t one, uint32_t other)
{
    vec3 a[3], b[3];
    for (uint32_t k = 0; k < 3; ++k) {
        a[k] = corner_of(one, k);
        b[k] = corner_of(other, k);
        for (uint32_t j = 0; j < 3; ++j)
            if (face.triangle[3 * (size_t)one + k] == face.triangle[3 * (size_t)other + j])
                return 0;
    }
    for (int k = 0; k < 3; ++k)
        if (segment_meets(a[k], a[(k + 1) % 3], b) || segment_meets(b[k], b[(k + 1) % 3], a))
            return 1;
    return 0;
}

typedef struct extent {
    double low[3], high[3];
    uint32_t triangle;
} extent;

static int compare_extents(const void *a, const void *b)
{
    double p = ((const extent *)a)->low[1], q = ((const extent *)b)->low[1];
    return (p > q) - (p < q);
}

static extent extent_of(uint32_t triangle)
{
    extent out = {{(double)INFINITY, (double)INFINITY, (double)INFINITY},
                  {-(double)INFINITY, -(double)INFINITY, -(double)INFINITY},
                  triangle};
    for (uint32_t k = 0; k < 3; ++k) {
        vec3 p = corner_of(triangle, k);
        const double at[3] = {p.x, p.y, p.z};
        for (int axis = 0; axis < 3; ++axis) {
            out.low[axis] = fmin(out.low[axis], at[axis]);
            out.high[axis] = fmax(out.high[axis], at[axis]);
        }
    }
    return out;
}

static int are_apart(const extent *a, const extent *b)
{
    for (int axis = 0; axis < 3; ++axis)
        if (a->low[axis] > b->high[axis] || b->low[axis] > a->high[axis])
            return 1;
    return 0;
}

static void no_triangle_cuts_another_at_rest(void **state)
{
    (void)state;
    extent *all = calloc(face.triangle_count, sizeof *all);
    assert_non_null(all);
    for (uint32_t t = 0; t < face.triangle_count; ++t)
        all[t] = extent_of(t);
    qsort(all, face.triangle_count, sizeof *all, compare_extents);
    for (uint32_t i = 0; i < face.triangle_count; ++i)
        for (uint32_t k = i + 1; k < face.triangle_count && all[k].low[1] <= all[i].high[1]; ++k)
            if (!are_apart(&all[i], &all[k]))
                assert_false(triangles_meet(all[i].triangle, all[k].triangle));
    free(all);
}

static int are_joined(uint32_t a, uint32_t b)
{
    for (uint32_t k = net.neighbour_start[a]; k < net.neighbour_start[a + 1]; ++k)
        if (net.neighbour[k] == b)
            return 1;
    return 0;
}

static uint32_t vertex_in(const json_t *chain, size_t i)
{
    return (uint32_t)json_integer_value(json_array_get(chain, i));
}

static void check_chain(const json_t *chain)
{
    size_t count = json_array_size(chain);
    for (size_t i = 0; i + 1 < count; ++i) {
        assert_true(are_joined(vertex_in(chain, i), vertex_in(chain, i + 1)));
        assert_true(point_of(vertex_in(chain, i)).x < point_of(vertex_in(chain, i + 1)).x);
    }
    for (size_t i = 0; i < count; ++i) {
        vec3 p = point_of(vertex_in(chain, i)), q = point_of(vertex_in(chain, count - 1 - i));
        assert_true(distance(p, (vec3){-q.x, q.y, q.z}) < 1e-6);
    }
}

/* The rims that the rig names: each from the right corner to the left one, facing each other. */
static void lips_meet_at_rest_from_corner_to_corner(void **state)
{
    (void)state;
    json_t *rig = json_load_file(SOURCE_DIR "/rigs/puppet/puppet.rig.json", 0, NULL);
    const json_t *mouth = json_object_get(rig, "mouth");
    const json_t *upper = json_object_get(mouth, "upper"), *lower = json_object_get(mouth, "lower");
    size_t count = json_array_size(upper);
    assert_int_equal(count, 37);
    assert_int_equal(json_array_size(lower), count);
    check_chain(upper);
    check_chain(lower);
    assert_int_equal(vertex_in(upper, 0), vertex_in(lower, 0));
    assert_int_equal(vertex_in(upper, count - 1), vertex_in(lower, count - 1));
    for (size_t i = 1; i + 1 < count; ++i) {
        uint32_t above = vertex_in(upper, i), below = vertex_in(lower, i);
        vec3 p = point_of(above), q = point_of(below);
        assert_false(are_joined(above, below));
        assert_true(p.y > q.y && distance(p, q) < 0.2);
        assert_true(fabs(p.x - q.x) < 0.2);
    }
    json_decref(rig);
}

static void puppet_is_what_its_program_writes(void **state)
{
    (void)state;
    const char *path = BUILD_DIR "/tests/unit/puppet_again.glb";
    char command[4096];
    (void)snprintf(command, sizeof command, "'%s' '%s'", BUILD_DIR "/rigs/puppet/generate_puppet",
                   path);
    assert_int_equal(system(command), 0);
    file_bytes committed, again;
    error err = {0};
    assert_true(file_read(&committed, PUPPET, 1500000, &err) >= 0);
    assert_true(file_read(&again, path, 1500000, &err) >= 0);
    assert_int_equal(committed.size, again.size);
    assert_memory_equal(committed.data, again.data, again.size);
    file_bytes_finish(&committed);
    file_bytes_finish(&again);
    (void)remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(puppet_is_a_face_of_15000_to_21000_vertices),
        cmocka_unit_test(puppet_has_its_parts),
        cmocka_unit_test(puppet_is_symmetric_in_x_with_its_parts),
        cmocka_unit_test(puppet_is_manifold_and_open_only_where_meant),
        cmocka_unit_test(puppet_has_no_slivers),
        cmocka_unit_test(puppet_faces_outwards),
        cmocka_unit_test(no_triangle_cuts_another_at_rest),
        cmocka_unit_test(lips_meet_at_rest_from_corner_to_corner),
        cmocka_unit_test(puppet_is_what_its_program_writes),
    };
    return cmocka_run_group_tests(tests, read_puppet, forget_puppet);
}
