#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/angle.h"
#include "base/file.h"
#include "base/rigid.h"
#include "io/mesh_file.h"
#include "io/openmesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PUPPET SOURCE_DIR "/rigs/puppet/puppet.glb"

/* The measures of rigs/README.md, mm. */
static const vec3 EYE = {37.5, 68.0, 62.0};
static const vec3 HINGE = {68.0, -24.0, -8.0};

static mesh face;
static topology net;

static int read_puppet(void **state)
{
    (void)state;
    error err = {0};
    if (mesh_file_read(&face, PUPPET, MESH_UNIT_AUTO, &err) < 0 ||
        openmesh_topology(&net, &face, &err) < 0) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

static int forget_puppet(void **state)
{
    (void)state;
    topology_destroy(&net);
    mesh_destroy(&face);
    return 0;
}

static vec3 point_of(uint32_t vertex)
{
    const float *p = face.position + 3 * (size_t)vertex;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static vec3 corner_of(uint32_t triangle, uint32_t corner)
{
    return point_of(face.triangle[3 * (size_t)triangle + corner]);
}

static double distance(vec3 a, vec3 b)
{
    return vec3_length(vec3_sub(a, b));
}

/* Readers keep the names of materials: each part has one of its own. */
static const mesh_part *part_named(const char *name)
{
    for (uint32_t i = 0; i < face.part_count; ++i)
        if (strcmp(face.material[face.part[i].material].name, name) == 0)
            return &face.part[i];
    fail_msg("no part \"%s\"", name);
    return NULL;
}

/* 1 for each vertex of the part; for the caller to free. */
static uint8_t *vertices_of(const char *name)
{
    const mesh_part *part = part_named(name);
    uint8_t *used = calloc(face.vertex_count, 1);
    assert_non_null(used);
    for (size_t i = 0; i < 3 * (size_t)part->triangle_count; ++i)
        used[face.triangle[3 * (size_t)part->first_triangle + i]] = 1;
    return used;
}

static const float *attribute_named(const char *name)
{
    for (uint32_t i = 0; i < face.attribute_count; ++i)
        if (strcmp(face.attribute[i].name, name) == 0)
            return face.attribute[i].value;
    fail_msg("no attribute \"%s\"", name);
    return NULL;
}

static void puppet_is_a_face_of_15000_to_20000_vertices(void **state)
{
    (void)state;
    file_bytes bytes;
    error err = {0};
    assert_true(file_read(&bytes, PUPPET, 1500000, &err) >= 0);
    file_bytes_finish(&bytes);
    assert_in_range(face.vertex_count, 15000, 20000);
    float low[3], high[3];
    mesh_bounds(&face, low, high);
    assert_in_range((int)(high[1] - low[1]), 280, 320);
    assert_float_equal(low[1], -150.0f, 1e-3f);
}

static void puppet_has_its_parts(void **state)
{
    (void)state;
    static const char *const NAME[] = {
        "skin",        "nose",        "mouth_bag",   "teeth_upper", "teeth_upper.gum",
        "teeth_lower", "hair",        "tongue",      "eye.l",       "teeth_lower.gum",
        "eye.r",       "eye.l.iris",  "eye.r.iris",  "eye.l.pupil", "eye.r.pupil",
        "lid_upper.l", "lid_upper.r", "lid_lower.l", "lid_lower.r", "brow.l",
        "brow.r",      "ear.l",       "ear.r",
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
    char *side = strstr(name, ".l");
    if (!side)
        side = strstr(name, ".r");
    if (!side || (side[2] != '\0' && side[2] != '.'))
        return part;
    side[1] = side[1] == 'l' ? 'r' : 'l';
    return (uint32_t)(part_named(name) - face.part);
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
    /* skin with nose and bag, 2 rows of teeth, tongue, 2 balls, 4 lids, 2 brows, 2 ears, 5 locks */
    assert_int_equal(net.component_count, 19);
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

static void bag_hangs_on_the_inner_edge_of_the_lips(void **state)
{
    (void)state;
    uint8_t *skin = vertices_of("skin"), *bag = vertices_of("mouth_bag");
    int shared_count = 0;
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        shared_count += skin[v] && bag[v];
    assert_int_equal(shared_count, 84);
    free(skin);
    free(bag);
}

static uint32_t skin_nearest(vec3 wanted)
{
    uint8_t *skin = vertices_of("skin");
    uint32_t best = 0;
    double least_mm = INFINITY;
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        if (skin[v] && distance(point_of(v), wanted) < least_mm) {
            least_mm = distance(point_of(v), wanted);
            best = v;
        }
    free(skin);
    return best;
}

/* Along edges; Bellman and Ford's, as far as it changes anything. */
static double way_mm(uint32_t from, uint32_t to)
{
    double *way = malloc(face.vertex_count * sizeof *way);
    assert_non_null(way);
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        way[v] = v == from ? 0.0 : 1e30;
    for (int is_changed = 1; is_changed;) {
        is_changed = 0;
        for (uint32_t v = 0; v < face.vertex_count; ++v)
            for (uint32_t k = net.neighbour_start[v]; k < net.neighbour_start[v + 1]; ++k) {
                double through =
                    way[net.neighbour[k]] + distance(point_of(v), point_of(net.neighbour[k]));
                if (through < way[v]) {
                    way[v] = through;
                    is_changed = 1;
                }
            }
    }
    double out = way[to];
    free(way);
    return out;
}

static void lips_are_close_but_joined_only_by_long_ways(void **state)
{
    (void)state;
    uint32_t upper = skin_nearest((vec3){0.0, -36.5, 93.5});
    uint32_t lower = skin_nearest((vec3){0.0, -39.5, 93.5});
    assert_true(distance(point_of(upper), point_of(lower)) < 4.0);
    assert_true(way_mm(upper, lower) > 100.0);
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
            assert_true(angle_deg > 3.5);
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
                                         "lid_lower.r", "brow.l",      "brow.r"};
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

static void check_shell(const char *name, double low_mm, double high_mm)
{
    uint8_t *used = vertices_of(name);
    int is_left = strstr(name, ".l") != NULL;
    vec3 centre = {is_left ? EYE.x : -EYE.x, EYE.y, EYE.z};
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        double from_mm = distance(point_of(v), centre);
        assert_true(!used[v] || (from_mm > low_mm - 0.1 && from_mm < high_mm + 0.1));
    }
    free(used);
}

static void lids_are_shells_around_the_balls(void **state)
{
    (void)state;
    check_shell("eye.l", 25.0, 25.0);
    check_shell("eye.r.iris", 25.0, 25.0);
    check_shell("eye.l.pupil", 25.0, 25.0);
    check_shell("lid_upper.l", 25.9, 27.6);
    check_shell("lid_upper.r", 25.9, 27.6);
    check_shell("lid_lower.l", 25.9, 27.6);
    check_shell("lid_lower.r", 25.9, 27.6);
}

/* How far a lid's edge stands above the middle of the left ball, seen from the side. */
static double edge_deg(const char *name, double sign)
{
    uint8_t *used = vertices_of(name);
    double edge = 180.0;
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        vec3 from = vec3_sub(point_of(v), EYE);
        if (used[v] && fabs(from.x) < 5.0)
            edge = fmin(edge, sign * atan2(from.y, from.z) * 57.29577951308232);
    }
    free(used);
    return sign * edge;
}

/* The upper lid by 50 degrees, the lower one by 20. */
static void lids_meet_when_they_close(void **state)
{
    (void)state;
    double upper = edge_deg("lid_upper.l", 1.0), lower = edge_deg("lid_lower.l", -1.0);
    assert_true(upper > 30.0 && lower < -25.0);
    assert_true(upper - 50.0 <= lower + 20.0);
    assert_true(upper - 45.0 > lower + 20.0);
}

/* After a turn of the jaw about the hinge, a slide and a shift. */
static double clearance_mm(double open_deg, vec3 shift)
{
    static const char *const ROW[2][2] = {{"teeth_upper", "teeth_upper.gum"},
                                          {"teeth_lower", "teeth_lower.gum"}};
    rigid jaw = rigid_turn(HINGE, (vec3){1, 0, 0}, open_deg * (ANGLE_PI / 180.0));
    double upper = INFINITY, lower = -INFINITY;
    for (int row = 0; row < 2; ++row)
        for (int i = 0; i < 2; ++i) {
            uint8_t *used = vertices_of(ROW[row][i]);
            for (uint32_t v = 0; v < face.vertex_count; ++v) {
                if (!used[v])
                    continue;
                if (row == 0)
                    upper = fmin(upper, point_of(v).y);
                else
                    lower = fmax(lower, vec3_add(rigid_apply(&jaw, point_of(v)), shift).y);
            }
            free(used);
        }
    return upper - lower;
}

/* A level plane stays between the rows: no motion sideways or forwards can bring them together. */
static void lower_teeth_clear_the_upper_ones(void **state)
{
    (void)state;
    for (double open_deg = 0.0; open_deg <= 32.0; open_deg += 4.0)
        for (double side_mm = -10.0; side_mm <= 10.0; side_mm += 5.0)
            for (double forward_mm = 0.0; forward_mm <= 8.0; forward_mm += 4.0)
                assert_true(clearance_mm(open_deg, (vec3){side_mm, 0.0, forward_mm}) > 2.0);
}

static void incisors_part_by_45_to_55_mm(void **state)
{
    (void)state;
    uint8_t *lower = vertices_of("teeth_lower");
    vec3 incisor = {0, -1000, 0};
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        if (lower[v] && fabs(point_of(v).x) < 1e-3 && point_of(v).y > incisor.y)
            incisor = point_of(v);
    free(lower);
    rigid jaw = rigid_turn(HINGE, (vec3){1, 0, 0}, 32.0 * (ANGLE_PI / 180.0));
    double moved_mm = distance(incisor, rigid_apply(&jaw, incisor));
    assert_true(moved_mm > 45.0 && moved_mm < 55.0);
}

static void bones_are_marked_apart(void **state)
{
    (void)state;
    const float *skull = attribute_named("_SKULL"), *jaw = attribute_named("_JAW");
    uint8_t *lower = vertices_of("teeth_lower"), *upper = vertices_of("teeth_upper");
    uint8_t *skin = vertices_of("skin");
    int chin_count = 0, cranium_count = 0;
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        assert_true(skull[v] == 0.0f || skull[v] == 1.0f);
        assert_true(jaw[v] == 0.0f || jaw[v] == 1.0f);
        assert_true(skull[v] * jaw[v] == 0.0f);
        assert_true(!lower[v] || jaw[v] == 1.0f);
        assert_true(!upper[v] || skull[v] == 1.0f);
        assert_true(!net.on_border[v] || !skin[v] || skull[v] == 1.0f);
        chin_count += skin[v] && jaw[v] > 0.5f;
        cranium_count += skin[v] && skull[v] > 0.5f;
    }
    assert_in_range(chin_count, 200, 2000);
    assert_in_range(cranium_count, 2000, 7000);
    free(lower);
    free(upper);
    free(skin);
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
    extent out = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, triangle};
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
        cmocka_unit_test(puppet_is_a_face_of_15000_to_20000_vertices),
        cmocka_unit_test(puppet_has_its_parts),
        cmocka_unit_test(puppet_is_symmetric_in_x_with_its_parts),
        cmocka_unit_test(puppet_is_manifold_and_open_only_where_meant),
        cmocka_unit_test(bag_hangs_on_the_inner_edge_of_the_lips),
        cmocka_unit_test(lips_are_close_but_joined_only_by_long_ways),
        cmocka_unit_test(puppet_has_no_slivers),
        cmocka_unit_test(puppet_faces_outwards),
        cmocka_unit_test(lids_are_shells_around_the_balls),
        cmocka_unit_test(lids_meet_when_they_close),
        cmocka_unit_test(lower_teeth_clear_the_upper_ones),
        cmocka_unit_test(incisors_part_by_45_to_55_mm),
        cmocka_unit_test(bones_are_marked_apart),
        cmocka_unit_test(no_triangle_cuts_another_at_rest),
        cmocka_unit_test(puppet_is_what_its_program_writes),
    };
    return cmocka_run_group_tests(tests, read_puppet, forget_puppet);
}
