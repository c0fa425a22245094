#include "draw/seams.h"

#include <math.h>
#include <stdlib.h>

typedef struct place {
    float at[3];
    uint32_t vertex;
} place;

static int compare_places(const void *left, const void *right)
{
    const place *a = left, *b = right;
    for (int i = 0; i < 3; ++i)
        if (a->at[i] != b->at[i])
            return a->at[i] < b->at[i] ? -1 : 1;
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

static bool same_place(const place *a, const place *b)
{
    return a->at[0] == b->at[0] && a->at[1] == b->at[1] && a->at[2] == b->at[2];
}

static float cosine(const float *normal, uint32_t a, uint32_t b)
{
    const float *u = normal + (size_t)a * 3, *v = normal + (size_t)b * 3;
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Pairs the vertices of one place with the first of them that faces the same way. Few leaders:
 * they differ by the least angle from each other. */
static void pair_place(seams *out, const place *places, uint32_t count, const float *normal,
                       float least_cosine)
{
    enum { LEADERS_MAX = 32 };
    uint32_t leader[LEADERS_MAX], leader_count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t k = 0;
        while (k < leader_count && cosine(normal, leader[k], places[i].vertex) < least_cosine)
            ++k;
        if (k < leader_count) {
            out->vertex[out->pair_count] = places[i].vertex;
            out->leader[out->pair_count++] = leader[k];
        } else if (leader_count < LEADERS_MAX) {
            leader[leader_count++] = places[i].vertex;
        }
    }
}

mrt_result seams_init(seams *out, const float *position, const float *normal, uint32_t vertex_count,
                      float least_cosine, error *err)
{
    *out = (seams){0};
    place *places = malloc(((size_t)vertex_count + 1) * sizeof *places);
    out->vertex = malloc(((size_t)vertex_count + 1) * sizeof *out->vertex);
    out->leader = malloc(((size_t)vertex_count + 1) * sizeof *out->leader);
    if (!places || !out->vertex || !out->leader) {
        free(places);
        seams_finish(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory to join the seams of the mesh");
    }
    for (uint32_t v = 0; v < vertex_count; ++v) {
        const float *p = position + (size_t)v * 3;
        places[v] = (place){{p[0], p[1], p[2]}, v};
    }
    qsort(places, vertex_count, sizeof *places, compare_places);
    for (uint32_t first = 0, next; first < vertex_count; first = next) {
        for (next = first + 1; next < vertex_count && same_place(&places[first], &places[next]);)
            ++next;
        if (next - first > 1)
            pair_place(out, places + first, next - first, normal, least_cosine);
    }
    free(places);
    return MRT_OK;
}

void seams_finish(seams *s)
{
    free(s->vertex);
    free(s->leader);
    *s = (seams){0};
}

void seams_join(const seams *s, float *nx, float *ny, float *nz)
{
    for (uint32_t i = 0; i < s->pair_count; ++i) {
        uint32_t v = s->vertex[i], leader = s->leader[i];
        nx[leader] += nx[v];
        ny[leader] += ny[v];
        nz[leader] += nz[v];
    }
    for (uint32_t i = 0; i < s->pair_count; ++i) {
        uint32_t leader = s->leader[i];
        float square = nx[leader] * nx[leader] + ny[leader] * ny[leader] + nz[leader] * nz[leader];
        float inverse = square > 1e-12f ? 1.0f / sqrtf(square) : 0.0f;
        nx[leader] *= inverse;
        ny[leader] *= inverse;
        nz[leader] *= inverse;
    }
    for (uint32_t i = 0; i < s->pair_count; ++i) {
        uint32_t v = s->vertex[i], leader = s->leader[i];
        nx[v] = nx[leader];
        ny[v] = ny[leader];
        nz[v] = nz[leader];
    }
}
