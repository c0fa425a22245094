#include "face/weights/weights_follow.h"

#include "face/weights/weights_nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far from the nearest to the furthest vertex of a piece its roots reach. */
#define ROOTS 0.25

typedef struct following {
    const follow_scene *scene;
    uint8_t *is_leader;   /* vertex_count: scratch */
    int32_t *vote;        /* component_count + 1: > 0: it follows what is rigid */
    double *least, *most; /* component_count + 1: squared distances from the leaders */
    uint32_t *on_rigid;   /* vertex_count; the nearest that is not rigid is in out_leader */
} following;

static double distance_squared(const follow_scene *scene, size_t v, size_t other)
{
    double sum = 0;
    if (other == UINT32_MAX)
        return HUGE_VAL;
    for (size_t a = 0; a < 3; a++) {
        double d = (double)scene->position[3 * v + a] - (double)scene->position[3 * other + a];
        sum += d * d;
    }
    return sum;
}

typedef enum kind { SOFT, RIGID } kind;

static mrt_result find_nearest(following *f, uint32_t *out, kind of, error *err)
{
    const follow_scene *scene = f->scene;
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        kind is = scene->rigid_bone[v] != UINT32_MAX ? RIGID : SOFT;
        f->is_leader[v] = scene->is_settled[v] && is == of;
    }
    nearest *n = nearest_create(scene->position, f->is_leader, scene->vertex_count);
    if (n == NULL)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the weights of %u vertices",
                         scene->vertex_count);
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        out[v] =
            scene->is_settled[v] ? UINT32_MAX : nearest_find(n, scene->position + 3 * (size_t)v);
    nearest_destroy(n);
    return MRT_OK;
}

static void choose_kind(following *f, uint32_t *leader)
{
    const follow_scene *scene = f->scene;
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        if (scene->is_settled[v])
            continue;
        bool is_rigid =
            distance_squared(scene, v, f->on_rigid[v]) < distance_squared(scene, v, leader[v]);
        f->vote[scene->component[v]] += is_rigid ? 1 : -1;
    }
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        if (leader[v] == UINT32_MAX ||
            (f->vote[scene->component[v]] > 0 && f->on_rigid[v] != UINT32_MAX))
            leader[v] = f->on_rigid[v];
}

static void find_roots(following *f, uint8_t *is_root, const uint32_t *leader)
{
    const follow_scene *scene = f->scene;
    for (uint32_t c = 0; c <= scene->component_count; c++)
        f->least[c] = HUGE_VAL;
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        uint32_t c = scene->component[v];
        if (leader[v] == UINT32_MAX)
            continue;
        f->least[c] = fmin(f->least[c], distance_squared(scene, v, leader[v]));
        f->most[c] = fmax(f->most[c], distance_squared(scene, v, leader[v]));
    }
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        uint32_t c = scene->component[v];
        double least = sqrt(f->least[c]), most = sqrt(f->most[c]);
        double reach = least + ROOTS * (most - least);
        is_root[v] = leader[v] != UINT32_MAX &&
                     (c == scene->component_count ||
                      distance_squared(scene, v, leader[v]) <= reach * reach * (1 + 1e-12));
    }
}

static mrt_result allocate(following *f, error *err)
{
    size_t vertices = f->scene->vertex_count + (size_t)1;
    size_t components = f->scene->component_count + (size_t)1;
    f->is_leader = malloc(vertices);
    f->vote = calloc(components, sizeof *f->vote);
    f->least = calloc(components, sizeof *f->least);
    f->most = calloc(components, sizeof *f->most);
    f->on_rigid = malloc(vertices * sizeof *f->on_rigid);
    if (f->is_leader != NULL && f->vote != NULL && f->least != NULL && f->most != NULL &&
        f->on_rigid != NULL)
        return MRT_OK;
    return error_set(err, MRT_ERR_MEMORY, "no memory for the weights of %u vertices",
                     f->scene->vertex_count);
}

mrt_result follow_find(uint32_t *out_leader, uint8_t *out_is_root, const follow_scene *scene,
                       error *err)
{
    following f = {.scene = scene};
    mrt_result result = allocate(&f, err);
    if (result == MRT_OK)
        result = find_nearest(&f, out_leader, SOFT, err);
    if (result == MRT_OK)
        result = find_nearest(&f, f.on_rigid, RIGID, err);
    if (result == MRT_OK) {
        choose_kind(&f, out_leader);
        find_roots(&f, out_is_root, out_leader);
    }
    free(f.is_leader);
    free(f.vote);
    free(f.least);
    free(f.most);
    free(f.on_rigid);
    return result;
}
