#include "face/bind.h"
#include "base/arrays.h"
#include "face/weights/weights_laplace.h"
#include "face/weights/weights_lips.h"
#include "face/weights/weights_nearest.h"
#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fill ripples a little on the far side of the face. This is subtracted from every filled
 * weight, so that a bone does not move unrelated vertices. */
#define RIPPLE 0.004f

typedef struct weights {
    arrays arrays; /* owner of the arrays below */
    const bind_marks *marks, *painted;
    const rig *rig;
    const mesh *mesh;
    uint32_t *component; /* vertex_count: piece; component_count for isolated vertices */
    uint32_t component_count;
    uint8_t *is_given, *is_free, *is_settled; /* vertex_count each */
    uint8_t *has_mark;                        /* component_count + 1 */
    laplace laplace;
} weights;

static mrt_result no_memory(const mesh *m, error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the weights of %u vertices",
                     m->vertex_count);
}

/* ---- given values ---- */

static float unit_range(float x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static uint32_t root_bone(const rig *r)
{
    for (uint32_t b = 0; b < r->bone_count; b++)
        if (r->bone[b].parent == RIG_NONE)
            return b;
    return 0;
}

/* Returns the nearest bone above `bone` that this vertex has no mark for, or RIG_NONE. */
static uint32_t unmarked_parent(const rig *r, const bool *is_marked, uint32_t bone)
{
    for (uint32_t step = 0; step < r->bone_count; step++) {
        bone = r->bone[bone].parent;
        if (bone >= r->bone_count)
            return RIG_NONE;
        if (!is_marked[bone])
            return bone;
    }
    return RIG_NONE;
}

/* Completes the weights marked at a vertex to a sum of 1. The rest goes to the parent of the bone
 * with the greatest mark. Returns false if nothing is marked, or only that no bone moves it. */
static bool settle_vertex(const weights *w, const bind_marks *marks, float *share, uint32_t v)
{
    const rig *r = w->rig;
    uint32_t count = w->mesh->vertex_count, most = RIG_NONE;
    bool is_marked[RIG_BONES_MAX] = {false};
    float sum = 0;
    for (uint32_t b = 0; b < r->bone_count; b++) {
        float mark = marks->weight[(size_t)b * count + v];
        is_marked[b] = !isnan(mark);
        share[b] = is_marked[b] ? unit_range(mark) : 0;
        sum += share[b];
        if (is_marked[b] && (most == RIG_NONE || share[b] > share[most]))
            most = b;
    }
    uint32_t holder = marks->rigid_bone[v];
    if (holder < r->bone_count) {
        memset(share, 0, r->bone_count * sizeof *share);
        share[holder] = 1;
        return true;
    }
    if (most == RIG_NONE)
        return false;
    uint32_t parent = unmarked_parent(r, is_marked, most);
    if (sum < 1 && parent != RIG_NONE) {
        share[parent] += 1 - sum;
        sum = 1;
    }
    if (!(sum > 0))
        return false;
    for (uint32_t b = 0; b < r->bone_count; b++)
        share[b] /= sum;
    return true;
}

static void read_weights(weights *w, float *weight)
{
    uint32_t count = w->mesh->vertex_count;
    for (uint32_t v = 0; v < count; v++) {
        float share[RIG_BONES_MAX] = {0};
        w->is_given[v] = settle_vertex(w, w->marks, share, v);
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            weight[(size_t)b * count + v] = share[b];
    }
}

/* Copies the value of the first vertex of each point to its other vertices. */
static void spread(const weights *w, float *value, uint32_t column_count)
{
    size_t count = w->mesh->vertex_count;
    for (uint32_t c = 0; c < column_count && w->mesh->point; c++)
        for (uint32_t v = 0; v < count; v++)
            value[c * count + v] = value[c * count + w->mesh->point[v]];
}

/* Makes contacts without a mobility mark movable. Otherwise most rigs could not move. */
static void read_mobility(weights *w, float *mobility)
{
    uint32_t count = w->mesh->vertex_count;
    for (uint32_t v = 0; v < count; v++) {
        float mark = w->marks->mobility[v];
        bool is_rigid = w->marks->rigid_bone[v] < w->rig->bone_count;
        w->is_given[v] = is_rigid || !isnan(mark);
        mobility[v] = is_rigid || isnan(mark) ? 0 : unit_range(mark);
    }
    for (uint32_t c = 0; c < w->rig->contact_count; c++) {
        uint32_t v = w->rig->contact[c].vertex;
        if (v >= count || w->is_given[v])
            continue;
        v = mesh_point(w->mesh, v);
        w->is_given[v] = 1;
        mobility[v] = 1;
    }
    spread(w, mobility, 1);
    for (uint32_t v = 0; v < count; v++)
        w->is_given[v] = w->is_given[mesh_point(w->mesh, v)];
}

/* ---- filled values ---- */

/* Finds the free vertices: not given, on a piece of surface with given ones. Returns false if
 * nothing is given. */
static bool find_free(weights *w)
{
    bool is_any_given = false;
    memset(w->has_mark, 0, w->component_count + (size_t)1);
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++)
        if (w->is_given[v]) {
            is_any_given = true;
            if (w->component[v] < w->component_count)
                w->has_mark[w->component[v]] = 1;
        }
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++) {
        w->is_settled[v] = w->is_given[v] || w->has_mark[w->component[v]];
        w->is_free[v] = w->is_settled[v] && !w->is_given[v] && mesh_point(w->mesh, v) == v;
    }
    return is_any_given;
}

static void bound_filled(const weights *w, float *value)
{
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++)
        if (w->is_free[v])
            value[v] = unit_range((value[v] - RIPPLE) / (1 - 2 * RIPPLE));
}

static void share_out_filled(const weights *w, float *weight)
{
    uint32_t count = w->mesh->vertex_count, root = root_bone(w->rig);
    for (uint32_t v = 0; v < count; v++) {
        if (!w->is_free[v])
            continue;
        float sum = 0;
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            sum += weight[(size_t)b * count + v];
        if (!(sum > 0)) {
            weight[(size_t)root * count + v] = 1;
            continue;
        }
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            weight[(size_t)b * count + v] /= sum;
    }
}

/* Clamps the fill afterwards. Exact bounds (Jacobson and others 2011) cost an optimisation for each
 * bone and change little. */
static void normalise_filled(const weights *w, float *weight)
{
    for (uint32_t b = 0; b < w->rig->bone_count; b++)
        bound_filled(w, weight + (size_t)b * w->mesh->vertex_count);
    share_out_filled(w, weight);
}

/* ---- pieces without a mark, which follow others: lashes, brows, the tear film ---- */

/* Reach of the roots of a piece, as a share of the way from its nearest to its furthest vertex. */
#define ROOTS 0.25

typedef struct following {
    arrays arrays; /* owner of the arrays below */
    const weights *w;
    uint8_t *is_leader;   /* vertex_count: scratch */
    int32_t *vote;        /* component_count + 1: > 0 if it follows rigid vertices */
    double *least, *most; /* component_count + 1: squared distances from the leaders */
    uint32_t *on_rigid;   /* vertex_count: nearest rigid leader; out_leader has the others */
} following;

static double distance_squared(const mesh *m, size_t v, size_t other)
{
    double sum = 0;
    if (other == UINT32_MAX)
        return HUGE_VAL;
    for (size_t a = 0; a < 3; a++) {
        double d = (double)m->position[3 * v + a] - (double)m->position[3 * other + a];
        sum += d * d;
    }
    return sum;
}

typedef enum kind { SOFT, RIGID } kind;

static mrt_result find_nearest(following *f, uint32_t *out, kind of, error *err)
{
    const weights *w = f->w;
    const mesh *m = w->mesh;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        kind is = w->marks->rigid_bone[v] != UINT32_MAX ? RIGID : SOFT;
        f->is_leader[v] = w->is_settled[v] && is == of;
    }
    nearest *n = nearest_create(m->position, f->is_leader, m->vertex_count);
    if (n == NULL)
        return no_memory(m, err);
    for (uint32_t v = 0; v < m->vertex_count; v++)
        out[v] = w->is_settled[v] ? UINT32_MAX : nearest_find(n, m->position + 3 * (size_t)v);
    nearest_destroy(n);
    return MRT_OK;
}

static void choose_kind(following *f, uint32_t *leader)
{
    const weights *w = f->w;
    const mesh *m = w->mesh;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        if (w->is_settled[v])
            continue;
        bool is_rigid = distance_squared(m, v, f->on_rigid[v]) < distance_squared(m, v, leader[v]);
        f->vote[w->component[v]] += is_rigid ? 1 : -1;
    }
    for (uint32_t v = 0; v < m->vertex_count; v++)
        if (leader[v] == UINT32_MAX ||
            (f->vote[w->component[v]] > 0 && f->on_rigid[v] != UINT32_MAX))
            leader[v] = f->on_rigid[v];
}

static void find_roots(following *f, uint8_t *is_root, const uint32_t *leader)
{
    const weights *w = f->w;
    const mesh *m = w->mesh;
    for (uint32_t c = 0; c <= w->component_count; c++)
        f->least[c] = HUGE_VAL;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        uint32_t c = w->component[v];
        if (leader[v] == UINT32_MAX)
            continue;
        f->least[c] = fmin(f->least[c], distance_squared(m, v, leader[v]));
        f->most[c] = fmax(f->most[c], distance_squared(m, v, leader[v]));
    }
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        uint32_t c = w->component[v];
        double least = sqrt(f->least[c]), most = sqrt(f->most[c]);
        double reach = least + ROOTS * (most - least);
        is_root[v] = leader[v] != UINT32_MAX &&
                     (c == w->component_count ||
                      distance_squared(m, v, leader[v]) <= reach * reach * (1 + 1e-12));
    }
}

/* Finds the vertices that pieces without a mark follow. A piece follows either rigid or
 * other vertices, whichever are nearer to more of its vertices. A lash must not follow the
 * eyeball at one end and the lid at the other. out_leader (vertex_count): the nearest settled
 * vertex of that kind; UINT32_MAX for settled vertices, and if nothing is settled. is_given: 1 for
 * the roots, the vertices close to their leaders. The rest of the piece follows the roots, so the
 * tip of a lash follows the lid, not the brow that it points at. */
static mrt_result find_leaders(weights *w, uint32_t *out_leader, error *err)
{
    following f = {.w = w};
    arrays *a = &f.arrays;
    size_t vertices = w->mesh->vertex_count, components = w->component_count + (size_t)1;
    f.is_leader = arrays_add(a, vertices, 1);
    f.vote = arrays_add(a, components, sizeof *f.vote);
    f.least = arrays_add(a, components, sizeof *f.least);
    f.most = arrays_add(a, components, sizeof *f.most);
    f.on_rigid = arrays_add(a, vertices, sizeof *f.on_rigid);
    mrt_result result = a->failed ? no_memory(w->mesh, err) : MRT_OK;
    if (result == MRT_OK)
        result = find_nearest(&f, out_leader, SOFT, err);
    if (result == MRT_OK)
        result = find_nearest(&f, f.on_rigid, RIGID, err);
    if (result == MRT_OK) {
        choose_kind(&f, out_leader);
        find_roots(&f, w->is_given, out_leader);
    }
    arrays_free(a);
    return result;
}

/* ---- filling ---- */

/* Gives pieces without a mark the values of their leaders at the roots, and fills the rest of each
 * piece from there. value: column_count by vertex_count. Sets is_free to the filled vertices. */
static mrt_result fill_followers(weights *w, float *value, uint32_t column_count, error *err)
{
    size_t count = w->mesh->vertex_count;
    uint32_t *leader = malloc((count + 1) * sizeof *leader);
    if (leader == NULL)
        return no_memory(w->mesh, err);
    spread(w, value, column_count);
    mrt_result result = find_leaders(w, leader, err);
    for (size_t v = 0; result == MRT_OK && v < count; v++) {
        w->is_free[v] =
            !w->is_settled[v] && !w->is_given[v] && mesh_point(w->mesh, (uint32_t)v) == v;
        for (uint32_t c = 0; c < column_count && w->is_given[v]; c++)
            value[c * count + v] = value[c * count + leader[v]];
    }
    free(leader);
    if (result == MRT_OK)
        result = laplace_fill(&w->laplace, value, column_count, w->is_free, w->is_given, err);
    return result;
}

static mrt_result fill_weights(weights *w, float *weight, error *err)
{
    uint32_t count = w->mesh->vertex_count;
    read_weights(w, weight);
    if (!find_free(w)) {
        float *root = weight + (size_t)root_bone(w->rig) * count;
        for (uint32_t v = 0; v < count; v++)
            root[v] = 1;
        return MRT_OK;
    }
    mrt_result result =
        laplace_fill(&w->laplace, weight, w->rig->bone_count, w->is_free, w->is_given, err);
    if (result != MRT_OK)
        return result;
    normalise_filled(w, weight);
    result = fill_followers(w, weight, w->rig->bone_count, err);
    if (result == MRT_OK)
        normalise_filled(w, weight);
    return result;
}

static mrt_result fill_mobility(weights *w, float *mobility, error *err)
{
    uint32_t count = w->mesh->vertex_count;
    read_mobility(w, mobility);
    bool is_any_mobile = false;
    for (uint32_t v = 0; v < count; v++)
        is_any_mobile = is_any_mobile || (w->is_given[v] && mobility[v] > 0);
    if (!find_free(w) || !is_any_mobile) {
        for (uint32_t v = 0; v < count; v++)
            if (!w->is_given[v])
                mobility[v] = 1;
        return MRT_OK;
    }
    mrt_result result = laplace_fill(&w->laplace, mobility, 1, w->is_free, w->is_given, err);
    if (result != MRT_OK)
        return result;
    bound_filled(w, mobility);
    result = fill_followers(w, mobility, 1, err);
    if (result == MRT_OK)
        bound_filled(w, mobility);
    return result;
}

/* ---- painted values ---- */

static bool differs(float a, float b)
{
    return isnan(a) ? !isnan(b) : a != b;
}

static bool paints_weight(const weights *w, uint32_t v)
{
    uint32_t count = w->mesh->vertex_count;
    bool is_other = w->painted->rigid_bone[v] != w->marks->rigid_bone[v];
    for (uint32_t b = 0; b < w->rig->bone_count; b++)
        is_other = is_other || differs(w->painted->weight[(size_t)b * count + v],
                                       w->marks->weight[(size_t)b * count + v]);
    return is_other;
}

static bool paints_mobility(const weights *w, uint32_t v)
{
    return w->painted->rigid_bone[v] != w->marks->rigid_bone[v] ||
           differs(w->painted->mobility[v], w->marks->mobility[v]);
}

/* Adds changes to vertices that are given or free. */
static void add_changes(const weights *w, float *value, const float *change, uint32_t column_count)
{
    size_t count = w->mesh->vertex_count;
    for (size_t i = 0; i < column_count * count; i++)
        if (w->is_settled[i % count])
            value[i] = unit_range(value[i] + change[i]);
}

/* Sets `change`, which must be zeroed, to the differences that paint makes to `weight`. Returns
 * false if nothing is painted. */
static bool read_painted_weights(weights *w, float *change, const float *weight)
{
    uint32_t count = w->mesh->vertex_count;
    bool is_any = false;
    for (uint32_t v = 0; v < count; v++) {
        float share[RIG_BONES_MAX] = {0};
        w->is_given[v] = settle_vertex(w, w->marks, share, v);
        if (!paints_weight(w, v) || !settle_vertex(w, w->painted, share, v))
            continue;
        w->is_given[v] = is_any = true;
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            change[(size_t)b * count + v] = share[b] - weight[(size_t)b * count + v];
    }
    return is_any;
}

static bool read_painted_mobility(weights *w, float *change, const float *mobility)
{
    bool is_any = false;
    read_mobility(w, change);
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++) {
        float mark = w->painted->mobility[v];
        bool is_rigid = w->painted->rigid_bone[v] < w->rig->bone_count;
        change[v] = 0;
        if (!paints_mobility(w, v) || (!is_rigid && isnan(mark)))
            continue;
        w->is_given[v] = is_any = true;
        change[v] = (is_rigid ? 0 : unit_range(mark)) - mobility[v];
    }
    return is_any;
}

static mrt_result fade_changes(weights *w, float *value, float *change, uint32_t column_count,
                               error *err)
{
    (void)find_free(w);
    mrt_result result =
        laplace_fade(&w->laplace, change, column_count, w->is_free, w->is_given, err);
    if (result == MRT_OK)
        add_changes(w, value, change, column_count);
    return result;
}

/* Pieces that follow others use the painted values. */
static mrt_result paint_weights(weights *w, float *weight, float *change, error *err)
{
    if (!read_painted_weights(w, change, weight))
        return MRT_OK;
    mrt_result result = fade_changes(w, weight, change, w->rig->bone_count, err);
    if (result != MRT_OK)
        return result;
    share_out_filled(w, weight);
    result = fill_followers(w, weight, w->rig->bone_count, err);
    if (result == MRT_OK)
        normalise_filled(w, weight);
    return result;
}

static mrt_result paint_mobility(weights *w, float *mobility, float *change, error *err)
{
    if (!read_painted_mobility(w, change, mobility))
        return MRT_OK;
    mrt_result result = fade_changes(w, mobility, change, 1, err);
    if (result == MRT_OK)
        result = fill_followers(w, mobility, 1, err);
    if (result == MRT_OK)
        bound_filled(w, mobility);
    return result;
}

static mrt_result paint(weights *w, binding *out, error *err)
{
    size_t count = (size_t)w->mesh->vertex_count * w->rig->bone_count;
    float *change = calloc(count + 1, sizeof *change);
    if (change == NULL)
        return no_memory(w->mesh, err);
    mrt_result result = paint_weights(w, out->weight, change, err);
    if (result == MRT_OK)
        result = paint_mobility(w, out->mobility, change, err);
    free(change);
    return result;
}

/* Fills the NaNs of bare marks over the surface into out->weight and out->mobility, which are
 * allocated. The fill is smooth also around single marks (weights_laplace.h). At a marked vertex
 * the rest to a sum of 1 goes to the parent of the bone with the greatest mark. Pieces of the
 * surface without any mark follow the nearest vertices in space. A contact without a
 * mobility mark has mobility 1. Without any mobility above 0, everything that is not marked has 1.
 * Then vertices that `painted` (NULL: none) marks differently get these values. The change fades
 * out within a few edges (laplace_fade). So a soft stroke over filled skin changes nothing beyond
 * it. */
static mrt_result fill(binding *out, const bind_marks *bare, const bind_marks *painted,
                       const rig *r, const mesh *m, const topology *t, error *err)
{
    if (r->bone_count == 0 || r->bone_count > RIG_BONES_MAX || t->vertex_count != m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "weights need 1 to %d bones (here %u) and the mesh's own topology",
                         RIG_BONES_MAX, r->bone_count);
    weights w = {.marks = bare, .painted = painted, .rig = r, .mesh = m};
    w.component = arrays_add(&w.arrays, m->vertex_count, sizeof *w.component);
    w.is_given = arrays_add(&w.arrays, m->vertex_count, 1);
    w.is_free = arrays_add(&w.arrays, m->vertex_count, 1);
    w.is_settled = arrays_add(&w.arrays, m->vertex_count, 1);
    w.has_mark = arrays_add(&w.arrays, m->vertex_count, 1);
    mrt_result result = w.arrays.failed ? no_memory(m, err) : MRT_OK;
    if (result == MRT_OK)
        result = topology_pieces(w.component, &w.component_count, m, t, err);
    if (result == MRT_OK)
        result = laplace_create(&w.laplace, m, t, err);
    if (result == MRT_OK)
        result = fill_weights(&w, out->weight, err);
    if (result == MRT_OK)
        result = fill_mobility(&w, out->mobility, err);
    if (result == MRT_OK && painted != NULL)
        result = paint(&w, out, err);
    if (result == MRT_OK) {
        spread(&w, out->weight, r->bone_count);
        spread(&w, out->mobility, 1);
    }
    laplace_destroy(&w.laplace);
    arrays_free(&w.arrays);
    return result;
}

/* ---- the binding ---- */

static mrt_result allocate(binding *out, uint32_t bone_count, uint32_t vertex_count,
                           uint32_t contact_count, error *err)
{
    *out = (binding){
        .vertex_count = vertex_count,
        .bone_count = bone_count,
        .weight = calloc((size_t)bone_count * vertex_count + 1, sizeof(float)),
        .mobility = calloc(vertex_count + (size_t)1, sizeof(float)),
        .contact_position = calloc(contact_count + (size_t)1, sizeof(vec3)),
        .contact_normal = calloc(contact_count + (size_t)1, sizeof(vec3)),
    };
    if (out->weight != NULL && out->mobility != NULL && out->contact_position != NULL &&
        out->contact_normal != NULL)
        return MRT_OK;
    binding_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory to bind %u bones to %u vertices", bone_count,
                     vertex_count);
}

static bool is_corner(const mesh *m, const uint32_t *corner, uint32_t point)
{
    return mesh_point(m, corner[0]) == point || mesh_point(m, corner[1]) == point ||
           mesh_point(m, corner[2]) == point;
}

/* Returns the normal of the triangles at the vertex's point, weighted by area. */
static vec3 normal_at(const mesh *m, uint32_t vertex)
{
    vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *corner = m->triangle + 3 * (size_t)i;
        if (!is_corner(m, corner, mesh_point(m, vertex)))
            continue;
        vec3 a = mesh_position(m, corner[0]);
        sum = vec3_add(sum, vec3_cross(vec3_sub(mesh_position(m, corner[1]), a),
                                       vec3_sub(mesh_position(m, corner[2]), a)));
    }
    return vec3_normalised(sum, (vec3){0, 0, 1});
}

static mrt_result set_contact_positions(binding *out, const rig *r, const mesh *m, error *err)
{
    for (uint32_t c = 0; c < r->contact_count; c++) {
        uint32_t vertex = r->contact[c].vertex;
        if (vertex >= m->vertex_count)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s: $.contacts[%u].vertex: %u does not exist, the mesh has %u "
                             "vertices; choose another vertex for \"%s\"",
                             r->path != NULL ? r->path : "rig", c, vertex, m->vertex_count,
                             r->contact[c].name);
        out->contact_position[c] = mesh_position(m, vertex);
        out->contact_normal[c] = normal_at(m, vertex);
    }
    return MRT_OK;
}

/* Gives a contact that names its bone weight 1 on it. */
static void hold_contacts(bind_marks *marks, const rig *r, const mesh *m)
{
    for (uint32_t c = 0; c < r->contact_count; c++) {
        const rig_contact *contact = &r->contact[c];
        if (contact->bone == RIG_NONE || marks->rigid_bone[contact->vertex] != RIG_NONE)
            continue;
        uint32_t point = mesh_point(m, contact->vertex);
        for (uint32_t v = point; v < (m->point ? m->vertex_count : point + 1); v++)
            for (uint32_t b = 0; b < r->bone_count && mesh_point(m, v) == point; b++)
                marks->weight[(size_t)b * m->vertex_count + v] = b == contact->bone ? 1 : 0;
    }
}

static bool is_painted(const rig *r)
{
    for (uint32_t i = 0; i < r->region_count; i++)
        if (rig_region_is_paint(&r->region[i]))
            return true;
    return false;
}

static mrt_result bind_everything_free(binding *out, const mesh *m, error *err)
{
    mrt_result result = allocate(out, 1, m->vertex_count, 0, err);
    for (uint32_t v = 0; result == MRT_OK && v < m->vertex_count; v++)
        out->weight[v] = out->mobility[v] = 1;
    return result;
}

mrt_result binding_create(binding *out, const rig *r, const mesh *m, const topology *t, error *err)
{
    *out = (binding){0};
    if (r == NULL)
        return bind_everything_free(out, m, err);
    mrt_result result = allocate(out, r->bone_count, m->vertex_count, r->contact_count, err);
    if (result != MRT_OK)
        return result;
    bind_marks marks = {0}, bare = {0};
    const bool paints = is_painted(r);
    result = set_contact_positions(out, r, m, err);
    if (result == MRT_OK)
        result = bind_marks_create(&marks, r, m, t, err);
    if (result == MRT_OK && paints)
        result = bind_marks_create_bare(&bare, r, m, t, err);
    if (result == MRT_OK)
        hold_contacts(&marks, r, m);
    if (result == MRT_OK && paints)
        hold_contacts(&bare, r, m);
    if (result == MRT_OK)
        result = fill(out, paints ? &bare : &marks, paints ? &marks : NULL, r, m, t, err);
    if (result == MRT_OK)
        result = bind_lips_find(&out->lips, r, m, t, err);
    bind_marks_destroy(&marks);
    bind_marks_destroy(&bare);
    if (result != MRT_OK)
        binding_destroy(out);
    return result;
}

static void *copy_of(const void *from, size_t size)
{
    void *out = from ? malloc(size + 1) : NULL;
    if (out)
        memcpy(out, from, size);
    return out;
}

mrt_result binding_copy(binding *out, const binding *b, uint32_t contact_count, error *err)
{
    size_t count = b->vertex_count, contacts = contact_count * sizeof(vec3);
    *out = *b;
    out->weight = copy_of(b->weight, count * b->bone_count * sizeof *b->weight);
    out->mobility = copy_of(b->mobility, count * sizeof *b->mobility);
    out->contact_position = copy_of(b->contact_position, contacts);
    out->contact_normal = copy_of(b->contact_normal, contacts);
    bool has_lips = bind_lips_copy(&out->lips, &b->lips, b->vertex_count);
    if (out->weight && out->mobility && (out->contact_position || !b->contact_position) &&
        (out->contact_normal || !b->contact_normal) && has_lips)
        return MRT_OK;
    binding_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory to bind %u bones to %u vertices",
                     b->bone_count, b->vertex_count);
}

void binding_destroy(binding *b)
{
    free(b->weight);
    free(b->mobility);
    free(b->contact_position);
    free(b->contact_normal);
    bind_lips_finish(&b->lips);
    *b = (binding){0};
}
