#include "face/fit/fit_candidates.h"

#include "base/rigid.h"
#include "face/weights/weights_nearest.h"
#include "mesh/place.h"

#include <math.h>
#include <stdlib.h>

/* How far, in parts of the skin's width, a mirrored vertex may be off, and a vertex on the midline
 * from the plane. */
#define MIRROR_TOLERANCE  0.01
#define MIDLINE_TOLERANCE 0.005

typedef struct choosing {
    const mesh *mesh;
    const uint8_t *is_skin;
    nearest *skin;
    double middle_x, width, reach_mm;
    uint32_t *half; /* skin on the midline or left of it */
    double *far;    /* of each: squared distance to the nearest chosen */
    const double *interest;
    uint32_t half_count;
} choosing;

static bool is_midline(const choosing *c, uint32_t v)
{
    return fabs(mesh_place(c->mesh, v).x - c->middle_x) <= MIDLINE_TOLERANCE * c->width;
}

/* UINT32_MAX: none near enough. */
static uint32_t mirrored(const choosing *c, uint32_t v)
{
    vec3 to = mesh_place(c->mesh, v);
    to.x = 2 * c->middle_x - to.x;
    uint32_t other = nearest_find(c->skin, (float[3]){(float)to.x, (float)to.y, (float)to.z});
    if (other == UINT32_MAX || other == v)
        return UINT32_MAX;
    double off = vec3_length(vec3_sub(mesh_place(c->mesh, other), to));
    return off <= MIRROR_TOLERANCE * c->width ? other : UINT32_MAX;
}

static vec3 normal_of(const mesh *m, uint32_t vertex)
{
    vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *corner = m->triangle + 3 * (size_t)i;
        if (corner[0] != vertex && corner[1] != vertex && corner[2] != vertex)
            continue;
        vec3 a = mesh_place(m, corner[0]);
        sum = vec3_add(sum, vec3_cross(vec3_sub(mesh_place(m, corner[1]), a),
                                       vec3_sub(mesh_place(m, corner[2]), a)));
    }
    return vec3_normalised(sum, (vec3){0, 0, 1});
}

/* Where the ray meets the triangle (Moeller and Trumbore 1997), in lengths of direction; negative:
 * nowhere. */
static double ray_meets(vec3 from, vec3 direction, vec3 a, vec3 b, vec3 c)
{
    vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), p = vec3_cross(direction, ac);
    double determinant = vec3_dot(ab, p);
    if (fabs(determinant) < 1e-12)
        return -1;
    vec3 to = vec3_sub(from, a), q = vec3_cross(to, ab);
    double u = vec3_dot(to, p) / determinant, v = vec3_dot(direction, q) / determinant;
    if (u < 0 || v < 0 || u + v > 1)
        return -1;
    return vec3_dot(ac, q) / determinant;
}

static bool is_hidden(const choosing *c, uint32_t vertex)
{
    const mesh *m = c->mesh;
    vec3 from = mesh_place(m, vertex), normal = normal_of(m, vertex);
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *corner = m->triangle + 3 * (size_t)i;
        if (corner[0] == vertex || corner[1] == vertex || corner[2] == vertex)
            continue;
        double at = ray_meets(from, normal, mesh_place(m, corner[0]), mesh_place(m, corner[1]),
                              mesh_place(m, corner[2]));
        if (at > 1e-3 && at < c->reach_mm)
            return true;
    }
    return false;
}

static bool measure_skin(choosing *c)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (uint32_t v = 0; v < c->mesh->vertex_count; v++) {
        if (!c->is_skin[v])
            continue;
        low = fmin(low, mesh_place(c->mesh, v).x);
        high = fmax(high, mesh_place(c->mesh, v).x);
    }
    c->middle_x = (low + high) / 2;
    c->width = high - low;
    return high > low;
}

static void collect_half(choosing *c)
{
    for (uint32_t v = 0; v < c->mesh->vertex_count; v++) {
        if (!c->is_skin[v])
            continue;
        bool is_left = mesh_place(c->mesh, v).x > c->middle_x + MIDLINE_TOLERANCE * c->width;
        if (!is_left && !is_midline(c, v))
            continue;
        c->far[c->half_count] = HUGE_VAL;
        c->half[c->half_count++] = v;
    }
}

static void note_chosen(choosing *c, uint32_t chosen)
{
    vec3 at = mesh_place(c->mesh, chosen);
    for (uint32_t i = 0; i < c->half_count; i++) {
        vec3 d = vec3_sub(mesh_place(c->mesh, c->half[i]), at);
        c->far[i] = fmin(c->far[i], vec3_dot(d, d));
    }
}

/* The one furthest from all that were chosen, measured in its interest; to begin with, the one of
 * most interest. */
static uint32_t next_furthest(const choosing *c, bool is_first)
{
    uint32_t best = UINT32_MAX;
    double most = -HUGE_VAL;
    for (uint32_t i = 0; i < c->half_count; i++) {
        double interest = c->interest[c->half[i]];
        double merit = is_first ? interest : c->far[i] * interest * interest;
        if (c->far[i] > 0 && merit > most) {
            most = merit;
            best = i;
        }
    }
    return best;
}

static void add_unit(fit_candidates *out, const choosing *c, uint32_t v)
{
    bool is_single = is_midline(c, v);
    uint32_t other = is_single ? UINT32_MAX : mirrored(c, v);
    if ((!is_single && other == UINT32_MAX) || is_hidden(c, v))
        return;
    out->vertex[out->vertex_count++] = v;
    if (!is_single)
        out->vertex[out->vertex_count++] = other;
    out->first[++out->unit_count] = out->vertex_count;
}

mrt_result fit_candidates_create(fit_candidates *out, const mesh *m, const uint8_t *is_skin,
                                 const double *interest, uint32_t unit_capacity, double reach_mm,
                                 error *err)
{
    size_t room = m->vertex_count + (size_t)1;
    choosing c = {.mesh = m,
                  .is_skin = is_skin,
                  .interest = interest,
                  .reach_mm = reach_mm,
                  .skin = nearest_create(m->position, is_skin, m->vertex_count),
                  .half = malloc(room * sizeof *c.half),
                  .far = malloc(room * sizeof *c.far)};
    *out = (fit_candidates){.vertex = malloc((2 * (size_t)unit_capacity + 1) * sizeof(uint32_t)),
                            .first = calloc(unit_capacity + (size_t)2, sizeof(uint32_t))};
    mrt_result result = MRT_OK;
    if (c.skin == NULL || c.half == NULL || c.far == NULL || out->vertex == NULL ||
        out->first == NULL)
        result = error_set(err, MRT_ERR_MEMORY, "no memory to look for contacts");
    else if (measure_skin(&c))
        collect_half(&c);
    /* Many lie hidden: twice as many are looked at as are wanted. */
    for (uint32_t i = 0;
         result == MRT_OK && i < 2 * unit_capacity && out->unit_count < unit_capacity; i++) {
        uint32_t next = next_furthest(&c, i == 0);
        if (next == UINT32_MAX)
            break;
        note_chosen(&c, c.half[next]);
        add_unit(out, &c, c.half[next]);
    }
    nearest_destroy(c.skin);
    free(c.half);
    free(c.far);
    if (result != MRT_OK)
        fit_candidates_destroy(out);
    return result;
}

void fit_candidates_destroy(fit_candidates *c)
{
    free(c->vertex);
    free(c->first);
    *c = (fit_candidates){0};
}
