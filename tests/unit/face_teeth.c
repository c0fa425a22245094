/* The puppet's jaw may be driven anywhere: its lower teeth never enter the upper ones. The distance
 * to the upper teeth is kept on a lattice, signed by the triangle that is nearest. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/bones.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POSES = 21 };
static const double pitch = 0.5, margin = 2.0; /* of the lattice; how far it reaches */

typedef struct lattice {
    vec3 low;
    int count[3];
    double *distance; /* signed; INFINITY where the teeth are further than the margin */
    double *facing;   /* how squarely the nearest triangle is faced, 0..1: settles ties */
} lattice;

static vec3 position(const mesh *m, uint32_t vertex)
{
    const float *at = m->position + (size_t)3 * vertex;
    return (vec3){(double)at[0], (double)at[1], (double)at[2]};
}

static bool is_named(const mesh_part *part, const char *prefix)
{
    return strncmp(part->name, prefix, strlen(prefix)) == 0;
}

static vec3 on_segment(vec3 p, vec3 a, vec3 b)
{
    vec3 way = vec3_sub(b, a);
    double t = vec3_dot(vec3_sub(p, a), way) / fmax(vec3_dot(way, way), 1e-30);
    return vec3_add(a, vec3_scale(way, fmin(fmax(t, 0.0), 1.0)));
}

static vec3 nearest_on_triangle(vec3 p, const vec3 corner[3], vec3 normal)
{
    vec3 best = vec3_sub(p, vec3_scale(normal, vec3_dot(vec3_sub(p, corner[0]), normal)));
    double least = (double)INFINITY;
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
        vec3 a = corner[i], b = corner[(i + 1) % 3];
        vec3 side = vec3_cross(normal, vec3_sub(b, a));
        inside = inside && vec3_dot(vec3_sub(best, a), side) >= 0.0;
    }
    for (int i = 0; i < 3 && !inside; ++i) {
        vec3 q = on_segment(p, corner[i], corner[(i + 1) % 3]);
        double distance = vec3_length(vec3_sub(p, q));
        best = distance < least ? q : best;
        least = fmin(least, distance);
    }
    return best;
}

static void note_node(lattice *l, size_t node, vec3 p, const vec3 corner[3], vec3 normal)
{
    vec3 away = vec3_sub(p, nearest_on_triangle(p, corner, normal));
    double distance = vec3_length(away), side = vec3_dot(away, normal);
    double facing = fabs(side) / fmax(distance, 1e-12), known = fabs(l->distance[node]);
    if (distance > known + 1e-9 || (distance > known - 1e-9 && facing <= l->facing[node]))
        return;
    l->distance[node] = side < 0.0 ? -distance : distance;
    l->facing[node] = facing;
}

static int node_below(const lattice *l, double x, double low, int axis)
{
    int i = (int)floor((x - low) / pitch);
    return i < 0 ? 0 : (i > l->count[axis] - 1 ? l->count[axis] - 1 : i);
}

static void note_triangle(lattice *l, const vec3 corner[3])
{
    vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    if (!(vec3_length(normal) > 1e-12))
        return;
    normal = vec3_normalised(normal, normal);
    vec3 low = corner[0], high = corner[0];
    for (int i = 1; i < 3; ++i) {
        low = (vec3){fmin(low.x, corner[i].x), fmin(low.y, corner[i].y), fmin(low.z, corner[i].z)};
        high =
            (vec3){fmax(high.x, corner[i].x), fmax(high.y, corner[i].y), fmax(high.z, corner[i].z)};
    }
    for (int i = node_below(l, low.x - margin, l->low.x, 0);
         i <= node_below(l, high.x + margin, l->low.x, 0); ++i)
        for (int j = node_below(l, low.y - margin, l->low.y, 1);
             j <= node_below(l, high.y + margin, l->low.y, 1); ++j)
            for (int k = node_below(l, low.z - margin, l->low.z, 2);
                 k <= node_below(l, high.z + margin, l->low.z, 2); ++k) {
                vec3 p = {l->low.x + pitch * i, l->low.y + pitch * j, l->low.z + pitch * k};
                size_t node = ((size_t)i * (size_t)l->count[1] + (size_t)j) * (size_t)l->count[2];
                note_node(l, node + (size_t)k, p, corner, normal);
            }
}

static void make_lattice(lattice *out, const mesh *m)
{
    float low[3], high[3];
    mesh_bounds(m, low, high);
    *out = (lattice){.low = {(double)low[0], (double)low[1], (double)low[2]}};
    for (int axis = 0; axis < 3; ++axis)
        out->count[axis] = (int)((double)(high[axis] - low[axis]) / pitch) + 2;
    size_t nodes = (size_t)out->count[0] * (size_t)out->count[1] * (size_t)out->count[2];
    out->distance = malloc(nodes * sizeof *out->distance);
    out->facing = calloc(nodes, sizeof *out->facing);
    assert_true(out->distance && out->facing);
    for (size_t i = 0; i < nodes; ++i)
        out->distance[i] = (double)INFINITY;
    for (uint32_t p = 0; p < m->part_count; ++p)
        for (uint32_t t = 0; t < m->part[p].triangle_count; ++t) {
            const uint32_t *row = m->triangle + (size_t)3 * (m->part[p].first_triangle + t);
            const vec3 corner[3] = {position(m, row[0]), position(m, row[1]), position(m, row[2])};
            if (is_named(&m->part[p], "teeth_upper"))
                note_triangle(out, corner);
        }
}

/* How deep a place is inside; 0: outside. */
static double depth_at(const lattice *l, vec3 p)
{
    double at[3] = {(p.x - l->low.x) / pitch, (p.y - l->low.y) / pitch, (p.z - l->low.z) / pitch};
    double sum = 0.0;
    int cell[3];
    for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = (int)floor(at[axis]);
        if (cell[axis] < 0 || cell[axis] + 1 >= l->count[axis])
            return 0.0;
    }
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        size_t node = 0;
        for (int axis = 0; axis < 3; ++axis) {
            int up = corner >> axis & 1;
            double part = at[axis] - cell[axis];
            weight *= up ? part : 1.0 - part;
            node = node * (size_t)l->count[axis] + (size_t)(cell[axis] + up);
        }
        sum += weight * fmin(l->distance[node], 100.0);
    }
    return sum < 0.0 ? -sum : 0.0;
}

static uint8_t *mark_lower(const mesh *m)
{
    uint8_t *is_lower = calloc(m->vertex_count, 1);
    assert_non_null(is_lower);
    for (uint32_t p = 0; p < m->part_count; ++p)
        for (size_t i = 0; i < (size_t)3 * m->part[p].triangle_count; ++i)
            if (is_named(&m->part[p], "teeth_lower"))
                is_lower[m->triangle[(size_t)3 * m->part[p].first_triangle + i]] = 1;
    return is_lower;
}

static double deepest(const lattice *l, const mesh *m, const uint8_t *is_lower, const rigid *jaw)
{
    double most = 0.0;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        if (is_lower[v])
            most = fmax(most, depth_at(l, rigid_apply(jaw, position(m, v))));
    return most;
}

static void lower_teeth_never_enter_the_upper_ones(void **state)
{
    (void)state;
    error err = {""};
    face_file file;
    lattice l;
    bones b;
    double most = 0.0;
    if (face_file_read(&file, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                       &err) < 0 ||
        bones_init(&b, file.rig, (vec3){0, 0, 0}, &err) < 0)
        fail_msg("%s", err.text);
    make_lattice(&l, &file.mesh);
    uint8_t *is_lower = mark_lower(&file.mesh);
    /* The check itself: shoved up by 6 mm they do enter. */
    rigid up = rigid_identity();
    up.t = (vec3){0, 6, 0};
    assert_true(deepest(&l, &file.mesh, is_lower, &up) > 0.5);
    const bones_dof *dof = b.dof + b.first_dof[b.jaw];
    for (int i = 0; i < POSES; ++i)
        for (int j = 0; j < POSES; ++j)
            for (int k = 0; k < POSES; ++k) {
                float value[MRT_MAX_DOFS] = {0}, *jaw = value + b.first_dof[b.jaw];
                rigid pose[RIG_BONES_MAX];
                const int step[3] = {i, j, k};
                for (int d = 0; d < 3; ++d)
                    jaw[d] = dof[d].min +
                             (dof[d].max - dof[d].min) * (float)step[d] / (float)(POSES - 1);
                bones_pose(pose, &b, value);
                most = fmax(most, deepest(&l, &file.mesh, is_lower, &pose[b.jaw]));
            }
    print_message("deepest in %d poses: %.3f mm\n", POSES * POSES * POSES, most);
    assert_true(most <= 0.2);
    free(is_lower);
    free(l.distance);
    free(l.facing);
    face_file_destroy(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lower_teeth_never_enter_the_upper_ones)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
