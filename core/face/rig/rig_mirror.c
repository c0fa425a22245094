#include "face/rig/rig_mirror.h"

#include <math.h>
#include <stdlib.h>

typedef struct placed {
    double y;
    uint32_t vertex;
} placed;

vec3 rig_mirror_position(const mesh *m, uint32_t vertex)
{
    const float *p = m->position + (size_t)vertex * 3;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static int compare_placed(const void *left, const void *right)
{
    const placed *a = left, *b = right;
    if (a->y < b->y || a->y > b->y)
        return a->y < b->y ? -1 : 1;
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

static size_t first_at_least(const placed *sorted, size_t count, double y)
{
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (sorted[middle].y < y)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static vec3 mirrored(vec3 p, double middle_x)
{
    return (vec3){2.0 * middle_x - p.x, p.y, p.z};
}

static bool has_partner(const placed *sorted, const mesh *m, vec3 image, double reach_mm)
{
    for (size_t i = first_at_least(sorted, m->vertex_count, image.y - reach_mm);
         i < m->vertex_count && sorted[i].y <= image.y + reach_mm; ++i) {
        vec3 d = vec3_sub(rig_mirror_position(m, sorted[i].vertex), image);
        if (vec3_dot(d, d) <= reach_mm * reach_mm)
            return true;
    }
    return false;
}

bool rig_mirror_count_alone(uint32_t *out_count, uint32_t *out_example, const mesh *m,
                            double middle_x, double reach_mm)
{
    *out_count = 0;
    *out_example = 0;
    placed *sorted = malloc(((size_t)m->vertex_count + 1) * sizeof *sorted);
    if (!sorted)
        return false;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        sorted[v] = (placed){rig_mirror_position(m, v).y, v};
    qsort(sorted, m->vertex_count, sizeof *sorted, compare_placed);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        if (has_partner(sorted, m, mirrored(rig_mirror_position(m, v), middle_x), reach_mm))
            continue;
        if (*out_count == 0)
            *out_example = v;
        *out_count += 1;
    }
    free(sorted);
    return true;
}

uint32_t rig_mirror_of(const mesh *m, uint32_t vertex, double middle_x, double *out_distance_mm)
{
    vec3 image = mirrored(rig_mirror_position(m, vertex), middle_x);
    uint32_t best = vertex;
    double best_square = (double)INFINITY;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        vec3 d = vec3_sub(rig_mirror_position(m, v), image);
        double square = vec3_dot(d, d);
        if (square < best_square) {
            best_square = square;
            best = v;
        }
    }
    *out_distance_mm = sqrt(best_square);
    return best;
}
