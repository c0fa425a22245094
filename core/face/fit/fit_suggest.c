#include "face/fit.h"

#include "face/fit/fit_side.h"
#include "face/weights/weights_nearest.h"
#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- candidates: vertices of skin that are visible from outside, spread evenly, in mirrored pairs
 * or on the midline ---- */

typedef struct candidates {
    uint32_t *vertex; /* vertex_count */
    uint32_t *first;  /* unit_count + 1: unit u is vertex[first[u]] .. vertex[first[u + 1] - 1]: one
                         vertex on the midline, or two that mirror each other */
    uint32_t vertex_count, unit_count;
} candidates;

/* Tolerances as shares of the skin's width: of a mirrored vertex, and of a midline vertex from the
 * plane. */
#define MIRROR_TOLERANCE  0.01
#define MIDLINE_TOLERANCE 0.005

typedef struct choosing {
    const mesh *mesh;
    const uint8_t *is_skin;
    nearest *skin;
    double middle_x, width, reach_mm;
    uint32_t *half; /* vertices of skin on the midline or left of it */
    double *far;    /* squared distance of each from the nearest chosen one */
    const double *interest;
    uint32_t half_count;
} choosing;

static bool is_midline(const choosing *c, uint32_t v)
{
    return fabs(mesh_position(c->mesh, v).x - c->middle_x) <= MIDLINE_TOLERANCE * c->width;
}

/* Returns UINT32_MAX if no vertex is near enough. */
static uint32_t mirrored(const choosing *c, uint32_t v)
{
    vec3 to = mesh_position(c->mesh, v);
    to.x = 2 * c->middle_x - to.x;
    uint32_t other = nearest_find(c->skin, (float[3]){(float)to.x, (float)to.y, (float)to.z});
    if (other == UINT32_MAX || other == v)
        return UINT32_MAX;
    double off = vec3_length(vec3_sub(mesh_position(c->mesh, other), to));
    return off <= MIRROR_TOLERANCE * c->width ? other : UINT32_MAX;
}

static vec3 normal_of(const mesh *m, uint32_t vertex)
{
    vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *corner = m->triangle + 3 * (size_t)i;
        if (corner[0] != vertex && corner[1] != vertex && corner[2] != vertex)
            continue;
        vec3 a = mesh_position(m, corner[0]);
        sum = vec3_add(sum, vec3_cross(vec3_sub(mesh_position(m, corner[1]), a),
                                       vec3_sub(mesh_position(m, corner[2]), a)));
    }
    return vec3_normalised(sum, (vec3){0, 0, 1});
}

/* Returns where the ray meets the triangle, in lengths of direction (Moeller and Trumbore 1997).
 * Returns a negative number if it misses. */
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
    vec3 from = mesh_position(m, vertex), normal = normal_of(m, vertex);
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *corner = m->triangle + 3 * (size_t)i;
        if (corner[0] == vertex || corner[1] == vertex || corner[2] == vertex)
            continue;
        double at = ray_meets(from, normal, mesh_position(m, corner[0]),
                              mesh_position(m, corner[1]), mesh_position(m, corner[2]));
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
        low = fmin(low, mesh_position(c->mesh, v).x);
        high = fmax(high, mesh_position(c->mesh, v).x);
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
        bool is_left = mesh_position(c->mesh, v).x > c->middle_x + MIDLINE_TOLERANCE * c->width;
        if (!is_left && !is_midline(c, v))
            continue;
        c->far[c->half_count] = HUGE_VAL;
        c->half[c->half_count++] = v;
    }
}

static void note_chosen(choosing *c, uint32_t chosen)
{
    vec3 at = mesh_position(c->mesh, chosen);
    for (uint32_t i = 0; i < c->half_count; i++) {
        vec3 d = vec3_sub(mesh_position(c->mesh, c->half[i]), at);
        c->far[i] = fmin(c->far[i], vec3_dot(d, d));
    }
}

/* Returns the vertex that is furthest from all chosen ones, weighted by interest. The first one is
 * that of the greatest interest. */
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

static void add_unit(candidates *out, const choosing *c, uint32_t v)
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

static void candidates_destroy(candidates *c)
{
    free(c->vertex);
    free(c->first);
    *c = (candidates){0};
}

/* is_skin: vertex_count of m: allowed vertices. interest: vertex_count, > 0: twice the interest
 * halves the distance between candidates. Makes at most unit_capacity units. The plane of symmetry
 * is x = the middle of the skin. A vertex is hidden if the mesh is less than reach_mm in front of
 * it, along its normal: inside a mouth, a nostril or a lid. */
static mrt_result candidates_create(candidates *out, const mesh *m, const uint8_t *is_skin,
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
    *out = (candidates){.vertex = malloc((2 * (size_t)unit_capacity + 1) * sizeof(uint32_t)),
                        .first = calloc(unit_capacity + (size_t)2, sizeof(uint32_t))};
    mrt_result result = MRT_OK;
    if (c.skin == NULL || c.half == NULL || c.far == NULL || out->vertex == NULL ||
        out->first == NULL)
        result = error_set(err, MRT_ERR_MEMORY, "no memory to look for contacts");
    else if (measure_skin(&c))
        collect_half(&c);
    /* Many vertices are hidden, so twice as many are examined as are wanted. */
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
        candidates_destroy(out);
    return result;
}

/* ---- the best choice of candidates ---- */

enum { SAMPLES_MOST = 4000, UNITS_MOST = 200, EXCHANGES = 3 };

/* Contacts closer than this part of the radius disturb each other. */
#define SPACING      (1.0 / 6)
#define RIDGE        1e-4
#define MOBILE_LEAST 0.5f

typedef struct suggesting {
    const mesh *targets;
    const binding *binding;
    const bones *bones;
    csrbf_settings settings;
    candidates candidates;
    double *kernel; /* candidates by candidates */
    fit_gram full;  /* one kernel per candidate and bone */
    float *dof;     /* target_count by MRT_MAX_DOFS: the poses found so far */
    uint32_t *choice;
    double *share, *pull;
    uint32_t choice_count, choice_capacity;
} suggesting;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to suggest contacts");
}

static float share_of(const suggesting *s, uint32_t bone, uint32_t vertex)
{
    return s->binding->weight[(size_t)bone * s->binding->vertex_count + vertex];
}

/* ---- effect of the candidates on the skin ---- */

/* A sample of the skin's vertices, followed by the candidates. */
typedef struct sample {
    uint32_t *vertex; /* skin_count */
    uint32_t skin_count, count;
    points_order order;
    points points;
    float *row; /* padded_count: kernel of one candidate */
} sample;

static void sample_destroy(sample *p)
{
    points_destroy(&p->points);
    points_order_destroy(&p->order);
    free(p->vertex);
    free(p->row);
}

/* Samples the skin at every n-th vertex. */
static mrt_result sample_create(sample *out, const suggesting *s, const mesh *m,
                                const uint8_t *is_skin, error *err)
{
    uint32_t skin_count = 0, skin_index = 0, extra = s->candidates.vertex_count;
    for (uint32_t v = 0; v < m->vertex_count; v++)
        skin_count += is_skin[v];
    uint32_t stride = skin_count / SAMPLES_MOST + 1;
    *out = (sample){.vertex = malloc((skin_count / stride + (size_t)2) * sizeof(uint32_t))};
    float *xyz = malloc((skin_count / stride + (size_t)extra + 2) * 3 * sizeof *xyz);
    mrt_result result = out->vertex != NULL && xyz != NULL ? MRT_OK : no_memory(err);
    for (uint32_t v = 0; result == MRT_OK && v < m->vertex_count; v++)
        if (is_skin[v] && skin_index++ % stride == 0)
            out->vertex[out->skin_count++] = v;
    out->count = out->skin_count + extra;
    for (uint32_t i = 0; result == MRT_OK && i < out->count; i++) {
        uint32_t v =
            i < out->skin_count ? out->vertex[i] : s->candidates.vertex[i - out->skin_count];
        memcpy(xyz + 3 * (size_t)i, m->position + 3 * (size_t)v, 3 * sizeof *xyz);
    }
    if (result == MRT_OK)
        result = points_order_create(&out->order, xyz, out->count, err);
    if (result == MRT_OK)
        result = points_create(&out->points, &out->order, xyz, err);
    if (result == MRT_OK) {
        out->row = malloc((size_t)out->points.padded_count * sizeof *out->row);
        result = out->row != NULL ? MRT_OK : no_memory(err);
    }
    free(xyz);
    if (result != MRT_OK)
        sample_destroy(out);
    return result;
}

/* Writes the kernel of each candidate at all rows of the sample. */
static mrt_result find_kernels(float *out, const suggesting *s, const mesh *m, sample *p,
                               error *err)
{
    csrbf_solver *solver = csrbf_solver_create(1);
    mrt_result result = solver != NULL ? MRT_OK : no_memory(err);
    for (uint32_t c = 0; result == MRT_OK && c < s->candidates.vertex_count; c++) {
        const float *at = m->position + 3 * (size_t)s->candidates.vertex[c];
        double centre[3] = {(double)at[0], (double)at[1], (double)at[2]};
        result = csrbf_factor(solver, &s->settings, centre, NULL, 1, err);
        if (result != MRT_OK)
            break;
        csrbf_responses(solver, p->row, p->points.padded_count, &p->points);
        for (uint32_t i = 0; i < p->count; i++)
            out[(size_t)c * p->count + i] = p->row[p->order.slot_of_file[i]];
    }
    csrbf_solver_destroy(solver);
    return result;
}

static void add_columns(suggesting *s)
{
    for (uint32_t bone = 0; bone < s->binding->bone_count; bone++)
        for (uint32_t c = 0; c < s->candidates.vertex_count; c++)
            if (share_of(s, bone, s->candidates.vertex[c]) > FIT_SHARE_LEAST)
                fit_gram_add_column(&s->full, bone, c);
}

static void add_vertex(suggesting *s, const mesh *m, const sample *p, const float *kernel,
                       uint32_t i, double *value, double *offset)
{
    size_t v = p->vertex[i];
    double mobility = (double)s->binding->mobility[v];
    for (uint32_t j = 0; j < s->full.column_count; j++) {
        const fit_column *c = &s->full.column[j];
        value[j] = (double)share_of(s, c->bone, (uint32_t)v);
        if (c->control != RIG_NONE)
            value[j] *= mobility * (double)kernel[(size_t)c->control * p->count + i];
        else if (c->axis < 3)
            value[j] *= (double)m->position[3 * v + c->axis];
    }
    for (size_t t = 0; t < s->targets->target_count; t++)
        for (size_t a = 0; a < 3; a++)
            offset[3 * t + a] = (double)s->targets->target[t].offset[3 * v + a];
    fit_gram_add_vertex(&s->full, value, offset);
}

static mrt_result sum_up(suggesting *s, const mesh *m, sample *p, error *err)
{
    uint32_t count = s->candidates.vertex_count;
    float *kernel = malloc(((size_t)count * p->count + 1) * sizeof *kernel);
    double *value = malloc((s->full.column_count + (size_t)1) * sizeof *value);
    double *offset = malloc((3 * (size_t)s->targets->target_count + 1) * sizeof *offset);
    mrt_result result = kernel != NULL && value != NULL && offset != NULL ? MRT_OK : no_memory(err);
    if (result == MRT_OK)
        result = find_kernels(kernel, s, m, p, err);
    for (uint32_t i = 0; result == MRT_OK && i < p->skin_count; i++)
        add_vertex(s, m, p, kernel, i, value, offset);
    for (uint32_t a = 0; result == MRT_OK && a < count; a++)
        for (uint32_t b = 0; b < count; b++)
            s->kernel[(size_t)a * count + b] =
                (double)kernel[(size_t)a * p->count + p->skin_count + b];
    fit_gram_finish(&s->full);
    free(kernel);
    free(value);
    free(offset);
    return result;
}

static mrt_result create_full(suggesting *s, const mesh *m, const uint8_t *is_skin, error *err)
{
    uint32_t count = s->candidates.vertex_count;
    s->kernel = malloc(((size_t)count * count + 1) * sizeof *s->kernel);
    mrt_result result = s->kernel != NULL ? MRT_OK : no_memory(err);
    if (result == MRT_OK)
        result = fit_gram_create(&s->full, s->bones, count, count * s->binding->bone_count,
                                 s->targets->target_count, err);
    if (result != MRT_OK)
        return result;
    add_columns(s);
    sample p = {0};
    result = fit_gram_begin(&s->full, err);
    if (result == MRT_OK)
        result = sample_create(&p, s, m, is_skin, err);
    if (result == MRT_OK)
        result = sum_up(s, m, &p, err);
    sample_destroy(&p);
    return result;
}

/* ---- rating a choice ---- */

static bool invert(double *out, const double *matrix, uint32_t count, double *work)
{
    memcpy(work, matrix, (size_t)count * count * sizeof *work);
    memset(out, 0, (size_t)count * count * sizeof *out);
    for (size_t i = 0; i < count; i++)
        out[i * count + i] = 1;
    for (size_t i = 0; i < count; i++) {
        if (!(work[i * count + i] > 1e-9))
            return false;
        double pivot = 1 / work[i * count + i];
        for (size_t j = 0; j < count; j++) {
            work[i * count + j] *= pivot;
            out[i * count + j] *= pivot;
        }
        for (size_t k = 0; k < count; k++) {
            double factor = k != i ? work[k * count + i] : 0;
            for (size_t j = 0; j < count && factor != 0; j++) {
                work[k * count + j] -= factor * work[i * count + j];
                out[k * count + j] -= factor * out[i * count + j];
            }
        }
    }
    return true;
}

/* Sets s->share: for each bone the inverse of the kernel matrix of the choices in its field. */
static bool interpolate(suggesting *s)
{
    uint32_t width = s->choice_count, count = s->candidates.vertex_count;
    size_t square = (size_t)width * width;
    double *matrix = malloc((3 * square + 1) * sizeof *matrix);
    if (matrix == NULL)
        return false;
    double *inverse = matrix + square, *work = inverse + square;
    bool is_regular = true;
    for (uint32_t bone = 0; is_regular && bone < s->binding->bone_count; bone++) {
        uint32_t member[MRT_MAX_VECTORS], members = 0;
        for (uint32_t i = 0; i < width; i++)
            if (share_of(s, bone, s->candidates.vertex[s->choice[i]]) > FIT_SHARE_LEAST)
                member[members++] = i;
        for (size_t i = 0; i < members; i++)
            for (size_t j = 0; j < members; j++)
                matrix[i * members + j] =
                    s->kernel[(size_t)s->choice[member[i]] * count + s->choice[member[j]]];
        is_regular = invert(inverse, matrix, members, work);
        double *share = s->share + bone * square;
        memset(share, 0, square * sizeof *share);
        for (size_t i = 0; i < members; i++)
            for (size_t j = 0; j < members; j++)
                share[(size_t)member[i] * width + member[j]] = inverse[i * members + j];
    }
    free(matrix);
    return is_regular;
}

typedef enum pose_search { POSES_FIXED, POSES_SOLVED } pose_search;

/* Computes the mean relative residual of the choice over the targets; infinite if it cannot be
 * solved. */
static mrt_result rate(suggesting *s, double *out, pose_search search, error *err)
{
    *out = HUGE_VAL;
    if (!interpolate(s))
        return MRT_OK;
    fit_gram reduced = {0};
    fit_solver solver = {0};
    mrt_result result =
        fit_gram_reduce(&reduced, &s->full, s->choice, s->choice_count, s->share, err);
    if (result == MRT_OK)
        result = fit_solver_create(&solver, s->bones, &reduced, RIDGE, err);
    double sum = 0;
    for (uint32_t t = 0; result == MRT_OK && t < s->targets->target_count; t++) {
        float *dof = s->dof + (size_t)t * MRT_MAX_DOFS;
        if (!(reduced.energy[t] > 0))
            continue;
        double missed = search == POSES_SOLVED ? fit_solve_pose(&solver, s->pull, dof, t)
                                               : fit_solve_pulls(&solver, s->pull, dof, t);
        sum += sqrt(missed / reduced.energy[t]);
    }
    if (result == MRT_OK)
        *out = sum / s->targets->target_count;
    fit_solver_destroy(&solver);
    fit_gram_destroy(&reduced);
    return result;
}

/* ---- the search ---- */

static bool are_close(const suggesting *s, const mesh *m, uint32_t a, uint32_t b)
{
    double least = SPACING * s->settings.radius, square = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        double d = (double)m->position[3 * (size_t)s->candidates.vertex[a] + axis] -
                   (double)m->position[3 * (size_t)s->candidates.vertex[b] + axis];
        square += d * d;
    }
    return square < least * least;
}

static bool is_crowded(const suggesting *s, uint32_t unit, const mesh *m)
{
    uint32_t first = s->candidates.first[unit], end = s->candidates.first[unit + 1];
    for (uint32_t i = first; i < end; i++)
        for (uint32_t k = 0; k < s->choice_count; k++)
            if (are_close(s, m, i, s->choice[k]))
                return true;
    return end - first == 2 && are_close(s, m, first, first + 1);
}

static void push_unit(suggesting *s, uint32_t unit)
{
    for (uint32_t i = s->candidates.first[unit]; i < s->candidates.first[unit + 1]; i++)
        s->choice[s->choice_count++] = i;
}

/* Adds the unit that helps most. size: number of contacts of the unit, or 0 for any. *out_unit is
 * UINT32_MAX if none fits. */
static mrt_result add_best(suggesting *s, uint32_t *out_unit, double *out_rating, uint32_t size,
                           const mesh *m, error *err)
{
    uint32_t before = s->choice_count;
    *out_unit = UINT32_MAX;
    *out_rating = HUGE_VAL;
    for (uint32_t u = 0; u < s->candidates.unit_count; u++) {
        uint32_t length = s->candidates.first[u + 1] - s->candidates.first[u];
        if ((size != 0 && length != size) || before + length > s->choice_capacity ||
            is_crowded(s, u, m))
            continue;
        double rating;
        push_unit(s, u);
        mrt_result result = rate(s, &rating, POSES_FIXED, err);
        s->choice_count = before;
        if (result != MRT_OK)
            return result;
        if (rating < *out_rating) {
            *out_rating = rating;
            *out_unit = u;
        }
    }
    if (*out_unit != UINT32_MAX)
        push_unit(s, *out_unit);
    return MRT_OK;
}

static uint32_t unit_of(const candidates *c, uint32_t candidate)
{
    uint32_t unit = 0;
    while (c->first[unit + 1] <= candidate)
        unit++;
    return unit;
}

/* Replaces each unit in turn by the best one of its size. */
static mrt_result exchange(suggesting *s, const mesh *m, error *err)
{
    for (uint32_t taken = 0; taken < s->choice_count;) {
        uint32_t unit = unit_of(&s->candidates, s->choice[0]), added;
        uint32_t length = s->candidates.first[unit + 1] - s->candidates.first[unit];
        s->choice_count -= length;
        memmove(s->choice, s->choice + length, s->choice_count * sizeof *s->choice);
        double rating;
        mrt_result result = add_best(s, &added, &rating, length, m, err);
        if (result != MRT_OK)
            return result;
        if (added == UINT32_MAX)
            push_unit(s, unit);
        taken += length;
    }
    double rating;
    return rate(s, &rating, POSES_SOLVED, err);
}

static mrt_result search(suggesting *s, const mesh *m, error *err)
{
    double rating;
    mrt_result result = rate(s, &rating, POSES_SOLVED, err);
    while (result == MRT_OK && s->choice_count < s->choice_capacity) {
        uint32_t unit;
        result = add_best(s, &unit, &rating, 0, m, err);
        if (result != MRT_OK || unit == UINT32_MAX)
            break;
        result = rate(s, &rating, POSES_SOLVED, err);
    }
    for (int pass = 0; result == MRT_OK && pass < EXCHANGES; pass++)
        result = exchange(s, m, err);
    return result;
}

/* ---- suggesting contacts ---- */

static double travel_of(const mesh_target *target, size_t v)
{
    const float *offset = target->offset + 3 * v;
    return fabs((double)offset[0]) + fabs((double)offset[1]) + fabs((double)offset[2]);
}

/* Sets the interest, from 1/4 to 1. Contacts are most useful where the targets move the face
 * most. */
static void find_interest(double *out, const suggesting *s, uint32_t vertex_count)
{
    for (uint32_t v = 0; v < vertex_count; v++)
        out[v] = 0.25;
    for (uint32_t t = 0; t < s->targets->target_count; t++) {
        const mesh_target *target = &s->targets->target[t];
        double most = 0;
        for (uint32_t v = 0; v < vertex_count; v++)
            if (s->binding->mobility[v] >= MOBILE_LEAST)
                most = fmax(most, travel_of(target, v));
        for (uint32_t v = 0; most > 0 && v < vertex_count; v++)
            out[v] = fmax(out[v], fmin(travel_of(target, v) / most, 1));
    }
}

/* Marks vertices that can carry a contact: mobile ones on the largest piece of surface, not lashes
 * and brows. */
static mrt_result mark_candidates(uint8_t *is_candidate, const suggesting *s, const mesh *m,
                                  const topology *t, error *err)
{
    size_t room = t->vertex_count + (size_t)2;
    uint32_t *piece = malloc(room * sizeof *piece), *size = calloc(room, sizeof *size);
    uint32_t count = 0, largest = 0;
    mrt_result result =
        piece != NULL && size != NULL ? topology_pieces(piece, &count, m, t, err) : no_memory(err);
    for (uint32_t v = 0; result == MRT_OK && v < t->vertex_count; v++)
        size[piece[v]]++;
    for (uint32_t c = 0; result == MRT_OK && c < count; c++)
        largest = size[c] > size[largest] ? c : largest;
    for (uint32_t v = 0; result == MRT_OK && v < t->vertex_count; v++)
        is_candidate[v] = piece[v] == largest && s->binding->mobility[v] >= MOBILE_LEAST;
    free(piece);
    free(size);
    return result;
}

static mrt_result prepare(suggesting *s, uint32_t count, const mesh *m, const topology *t,
                          error *err)
{
    uint8_t *is_skin = calloc(m->vertex_count + (size_t)1, 1);
    uint8_t *is_candidate = calloc(m->vertex_count + (size_t)1, 1);
    double *interest = malloc((m->vertex_count + (size_t)1) * sizeof *interest);
    s->dof = calloc((size_t)s->targets->target_count * MRT_MAX_DOFS + 1, sizeof *s->dof);
    s->choice = malloc((count + (size_t)1) * sizeof *s->choice);
    s->share = malloc(((size_t)s->binding->bone_count * count * count + 1) * sizeof *s->share);
    s->pull = malloc((3 * (size_t)count + 1) * sizeof *s->pull);
    mrt_result result = MRT_OK;
    if (is_skin == NULL || is_candidate == NULL || interest == NULL || s->dof == NULL ||
        s->choice == NULL || s->share == NULL || s->pull == NULL)
        result = no_memory(err);
    for (uint32_t v = 0; result == MRT_OK && v < m->vertex_count; v++)
        is_skin[v] = s->binding->mobility[v] > 0;
    if (result == MRT_OK)
        result = mark_candidates(is_candidate, s, m, t, err);
    if (result == MRT_OK)
        find_interest(interest, s, m->vertex_count);
    if (result == MRT_OK)
        result = candidates_create(&s->candidates, m, is_candidate, interest, UNITS_MOST,
                                   s->settings.radius, err);
    if (result == MRT_OK)
        result = create_full(s, m, is_skin, err);
    free(is_skin);
    free(is_candidate);
    free(interest);
    return result;
}

mrt_result fit_suggest(uint32_t *out_vertex, uint32_t *out_count, uint32_t count, const rig *r,
                       const mesh *m, const topology *t, const mesh *targets,
                       const csrbf_settings *settings, error *err)
{
    *out_count = 0;
    if (targets->vertex_count != m->vertex_count || targets->target_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "contacts can only be suggested from morph targets on the rig's own mesh "
                         "of %u vertices; the file has %u targets on %u vertices",
                         m->vertex_count, targets->target_count, targets->vertex_count);
    if (count == 0 || count > MRT_MAX_VECTORS)
        return error_set(err, MRT_ERR_ARGUMENT, "1 to %d contacts can be suggested, not %u",
                         MRT_MAX_VECTORS, count);
    suggesting s = {
        .targets = targets, .settings = fit_side_settings(r, settings), .choice_capacity = count};
    s.settings.polynomial = CSRBF_NONE;
    s.settings.ridge = 0;
    face *f = NULL;
    mrt_result result = face_create(&f, r, m, t, 1, err);
    if (result == MRT_OK) {
        s.binding = face_binding(f);
        s.bones = face_bones(f);
        result = prepare(&s, count, m, t, err);
    }
    if (result == MRT_OK)
        result = search(&s, m, err);
    for (uint32_t i = 0; result == MRT_OK && i < s.choice_count; i++)
        out_vertex[(*out_count)++] = s.candidates.vertex[s.choice[i]];
    candidates_destroy(&s.candidates);
    fit_gram_destroy(&s.full);
    free(s.kernel);
    free(s.dof);
    free(s.choice);
    free(s.share);
    free(s.pull);
    face_destroy(f);
    return result;
}
