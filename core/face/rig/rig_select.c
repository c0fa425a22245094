#include "face/bind.h"

#include "base/budget.h"
#include "face/rig/rig_document.h"
#include "mesh/position.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIST_TEXT = 400 };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to apply the rig to the mesh");
}

/* ---- distances along the surface (Dijkstra 1959) ---- */

typedef struct waiting { /* a vertex to visit */
    double distance;
    uint32_t vertex;
} waiting;

typedef struct heap { /* nearest item first; ties by vertex */
    waiting *item;
    size_t count;
} heap;

static bool comes_first(waiting a, waiting b)
{
    return a.distance < b.distance || (!(a.distance > b.distance) && a.vertex < b.vertex);
}

static void heap_push(heap *h, waiting item)
{
    size_t at = h->count;
    h->count += 1;
    for (; at > 0 && comes_first(item, h->item[(at - 1) / 2]); at = (at - 1) / 2)
        h->item[at] = h->item[(at - 1) / 2];
    h->item[at] = item;
}

static waiting heap_pop(heap *h)
{
    waiting first = h->item[0];
    h->count -= 1;
    waiting last = h->item[h->count];
    size_t at = 0;
    for (;;) {
        size_t child = 2 * at + 1;
        if (child >= h->count)
            break;
        if (child + 1 < h->count && comes_first(h->item[child + 1], h->item[child]))
            child += 1;
        if (!comes_first(h->item[child], last))
            break;
        h->item[at] = h->item[child];
        at = child;
    }
    h->item[at] = last;
    return first;
}

static double edge_length(const mesh *m, uint32_t a, uint32_t b)
{
    const float *p = m->position + (size_t)a * 3, *q = m->position + (size_t)b * 3;
    double x = (double)p[0] - (double)q[0], y = (double)p[1] - (double)q[1];
    double z = (double)p[2] - (double)q[2];
    return sqrt(x * x + y * y + z * z);
}

typedef struct walk { /* reusable; a walk costs only what it reaches */
    const mesh *m;
    const topology *t;
    heap h;
    double *distance;  /* vertex_count; infinite for vertices not reached */
    uint32_t *reached; /* the vertices reached */
    size_t reached_count;
} walk;

static bool walk_init(walk *out, const mesh *m, const topology *t, double *distance,
                      uint32_t start_count)
{
    /* Each edge pushes at most once in each direction. */
    size_t push_max = t->neighbour_start[t->vertex_count] + start_count + 1u;
    *out = (walk){.m = m, .t = t, .distance = distance};
    out->h.item = malloc(push_max * sizeof *out->h.item);
    out->reached = malloc(((size_t)m->vertex_count + 1) * sizeof *out->reached);
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        distance[v] = (double)INFINITY;
    return out->h.item && out->reached;
}

static void walk_finish(walk *w)
{
    free(w->h.item);
    free(w->reached);
}

/* Stores a distance if it is shorter than the known one. */
static void reach(walk *w, uint32_t vertex, double distance, double reach_mm)
{
    if (distance > reach_mm || !(distance < w->distance[vertex]))
        return;
    if (isinf(w->distance[vertex]))
        w->reached[w->reached_count++] = vertex;
    w->distance[vertex] = distance;
    heap_push(&w->h, (waiting){distance, vertex});
}

static void walk_on(walk *w, double reach_mm)
{
    const topology *t = w->t;
    while (w->h.count > 0) {
        waiting at = heap_pop(&w->h);
        if (at.distance > w->distance[at.vertex])
            continue;
        for (uint32_t i = t->neighbour_start[at.vertex]; i < t->neighbour_start[at.vertex + 1];
             ++i) {
            uint32_t next = t->neighbour[i];
            reach(w, next, at.distance + edge_length(w->m, at.vertex, next), reach_mm);
        }
    }
}

static void walk_reset(walk *w)
{
    for (size_t i = 0; i < w->reached_count; ++i)
        w->distance[w->reached[i]] = (double)INFINITY;
    w->reached_count = 0;
}

bool bind_distances(double *out_distance, const bind_start *start, uint32_t start_count,
                    double reach_mm, const mesh *m, const topology *t)
{
    walk w;
    bool has_memory = walk_init(&w, m, t, out_distance, start_count);
    for (uint32_t i = 0; has_memory && i < start_count; ++i)
        reach(&w, mesh_point(m, start[i].vertex), start[i].distance_mm, reach_mm);
    if (has_memory)
        walk_on(&w, reach_mm);
    for (uint32_t v = 0; has_memory && v < m->vertex_count; ++v)
        out_distance[v] = out_distance[mesh_point(m, v)];
    walk_finish(&w);
    return has_memory;
}

/* ---- selectors ---- */

typedef struct selecting {
    const mesh *m;
    const topology *t;
    budget budget;
    walk walk; /* created for the first selector that needs it */
    double *distance;
    int32_t *cover; /* vertex_count + 1: number of ranges that begin minus those that have ended */
    uint32_t *piece, piece_count; /* piece: vertex_count, created likewise; the index piece_count
                                     means no surface */
} selecting;

static selecting selecting_on(const mesh *m, const topology *t)
{
    size_t size = 12 * ((size_t)m->vertex_count + m->triangle_count);
    return (selecting){.m = m, .t = t, .budget = budget_of(BUDGET_SELECTORS, size)};
}

static void selecting_finish(selecting *s)
{
    walk_finish(&s->walk);
    free(s->distance);
    free(s->cover);
    free(s->piece);
}

static const char *path_of(const rig_select *select)
{
    return select->path ? select->path : "select";
}

static mrt_result charge_budget(selecting *s, const rig_select *select, uint64_t steps, error *err)
{
    mrt_result result = budget_spend_work(&s->budget, steps, err);
    if (result < 0)
        error_prefix(err, path_of(select));
    return result;
}

/* Selects all vertices of a point if one of them is selected. */
static void spread(float *out, const mesh *m)
{
    for (uint32_t v = 0; m->point && v < m->vertex_count; ++v)
        out[m->point[v]] = fmaxf(out[m->point[v]], out[v]);
    for (uint32_t v = 0; m->point && v < m->vertex_count; ++v)
        out[v] = out[m->point[v]];
}

/* ---- by number ---- */

/* Ranges may overlap often, since each costs only its two ends. */
static mrt_result select_vertices(float *out, const rig_select *select, selecting *s, error *err)
{
    const uint32_t vertex_count = s->m->vertex_count;
    mrt_result result = charge_budget(s, select, select->range_count, err);
    if (result < 0)
        return result;
    if (!s->cover)
        s->cover = malloc(((size_t)vertex_count + 1) * sizeof *s->cover);
    if (!s->cover)
        return no_memory(err);
    memset(s->cover, 0, ((size_t)vertex_count + 1) * sizeof *s->cover);
    for (uint32_t i = 0; i < select->range_count; ++i) {
        if (select->last[i] >= vertex_count)
            return error_set(
                err, MRT_ERR_ARGUMENT,
                "%s.vertices[%u]: vertex %u does not exist, the mesh has %u vertices; choose again",
                path_of(select), i, select->last[i], vertex_count);
        s->cover[select->first[i]] += 1;
        s->cover[select->last[i] + 1] -= 1;
    }
    int32_t open = 0;
    for (uint32_t v = 0; v < vertex_count; ++v) {
        open += s->cover[v];
        out[v] = open > 0 ? 1.0f : 0.0f;
    }
    return MRT_OK;
}

static mrt_result select_painted(float *out, const rig_select *select, const mesh *m, error *err)
{
    for (uint32_t i = 0; i < select->range_count; ++i) {
        if (select->last[i] >= m->vertex_count)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s.painted: \"%s\" is painted at vertex %u, but the mesh has %u "
                             "vertices; use the mesh that was painted, or paint again",
                             path_of(select), select->name, select->last[i], m->vertex_count);
        for (uint32_t v = select->first[i]; v <= select->last[i]; ++v)
            out[v] = (float)select->value[i] / 255.0f;
    }
    return MRT_OK;
}

/* ---- by name ---- */

/* A '*' at the end of the pattern matches any rest. */
static bool matches(const char *pattern, const char *name)
{
    size_t length = strlen(pattern);
    if (length > 0 && pattern[length - 1] == '*')
        return strncmp(pattern, name, length - 1) == 0;
    return strcmp(pattern, name) == 0;
}

static void list_name(char list[LIST_TEXT], const char *name)
{
    size_t used = strlen(list);
    if (name[0] && used + strlen(name) + 8 < LIST_TEXT)
        (void)snprintf(list + used, LIST_TEXT - used, "%s%s", used ? ", " : "", name);
}

static mrt_result select_group(float *out, const rig_select *select, const mesh *m, error *err)
{
    bool found = false;
    for (uint32_t i = 0; i < m->part_count; ++i) {
        const mesh_part *part = &m->part[i];
        if (!matches(select->name, part->name) &&
            !matches(select->name, m->material[part->material].name))
            continue;
        found = true;
        const uint32_t *corner = m->triangle + (size_t)part->first_triangle * 3;
        for (size_t k = 0; k < (size_t)part->triangle_count * 3; ++k)
            out[corner[k]] = 1.0f;
    }
    if (found)
        return MRT_OK;
    char list[LIST_TEXT] = "";
    for (uint32_t i = 0; i < m->part_count; ++i)
        list_name(list, m->part[i].name);
    for (uint32_t i = 0; i < m->material_count; ++i)
        list_name(list, m->material[i].name);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s.group: the mesh has no part or material \"%s\"; "
                     "it has: %s",
                     path_of(select), select->name, list[0] ? list : "no names");
}

static mrt_result select_attribute(float *out, const rig_select *select, const mesh *m, error *err)
{
    for (uint32_t i = 0; i < m->attribute_count; ++i) {
        const mesh_attribute *attribute = &m->attribute[i];
        if (strcmp(attribute->name, select->name) != 0)
            continue;
        for (uint32_t v = 0; v < m->vertex_count; ++v) {
            float value = attribute->value[(size_t)v * attribute->component_count];
            out[v] = value > 0.0f ? fminf(value, 1.0f) : 0.0f;
        }
        return MRT_OK;
    }
    char list[LIST_TEXT] = "";
    for (uint32_t i = 0; i < m->attribute_count; ++i)
        list_name(list, m->attribute[i].name);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s.attribute: the mesh has no vertex attribute \"%s\" (it has: %s); in glTF "
                     "files the names of painted weights begin with _",
                     path_of(select), select->name, list[0] ? list : "none");
}

/* ---- by position ---- */

static bool is_in_box(vec3 p, vec3 low, vec3 high)
{
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z &&
           p.z <= high.z;
}

static bool is_in_ellipsoid(vec3 p, vec3 centre, vec3 radii)
{
    vec3 d = vec3_sub(p, centre);
    vec3 q = {d.x / radii.x, d.y / radii.y, d.z / radii.z};
    return vec3_dot(q, q) <= 1.0;
}

static void select_shape(float *out, const rig_select *select, const mesh *m)
{
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        vec3 p = mesh_position(m, v);
        bool is_in = select->kind == SELECT_BOX ? is_in_box(p, select->a, select->b)
                     : select->kind == SELECT_ELLIPSOID
                         ? is_in_ellipsoid(p, select->a, select->b)
                         : vec3_dot(vec3_sub(p, select->a), select->b) >= 0.0;
        out[v] = is_in ? 1.0f : 0.0f;
    }
}

static mrt_result select_within(float *out, const rig_select *select, selecting *s, error *err)
{
    enum { STEPS_PER_VERTEX = 32 };
    const mesh *m = s->m;
    if (select->vertex >= m->vertex_count)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "%s.within.of: vertex %u does not exist, the mesh has %u vertices; choose again",
            path_of(select), select->vertex, m->vertex_count);
    if (!s->distance) {
        s->distance = malloc(((size_t)m->vertex_count + 1) * sizeof *s->distance);
        if (!s->distance || !walk_init(&s->walk, m, s->t, s->distance, 1))
            return no_memory(err);
    }
    walk *w = &s->walk;
    reach(w, mesh_point(m, select->vertex), 0.0, select->within_mm);
    walk_on(w, select->within_mm);
    for (size_t i = 0; i < w->reached_count; ++i)
        out[w->reached[i]] = 1.0f;
    uint64_t steps = (uint64_t)w->reached_count * STEPS_PER_VERTEX;
    walk_reset(w);
    return charge_budget(s, select, steps, err);
}

/* ---- by the skin of the file ---- */

static uint32_t find_joint(const mesh *m, const char *name)
{
    uint32_t joint = 0;
    while (joint < m->joint_count && strcmp(m->joint[joint].name, name) != 0)
        ++joint;
    return joint;
}

static mrt_result select_joint(float *out, const rig_select *select, selecting *s, error *err)
{
    const mesh *m = s->m;
    uint32_t root = find_joint(m, select->name);
    if (root == m->joint_count || !m->skin_joint) {
        char list[LIST_TEXT] = "";
        for (uint32_t i = 0; i < m->joint_count; ++i)
            list_name(list, m->joint[i].name);
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s.joint: the skin of the mesh has no joint \"%s\"; it has: %s",
                         path_of(select), select->name, list[0] ? list : "none");
    }
    uint8_t *is_below = calloc((size_t)m->joint_count + 1, 1);
    if (!is_below)
        return no_memory(err);
    is_below[root] = 1;
    for (uint32_t i = root + 1; i < m->joint_count; ++i)
        is_below[i] = m->joint[i].parent < i && is_below[m->joint[i].parent];
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        for (size_t k = (size_t)v * MESH_SKIN_WIDTH, end = k + MESH_SKIN_WIDTH; k < end; ++k)
            out[v] += is_below[m->skin_joint[k]] ? m->skin_weight[k] : 0.0f;
        out[v] = fminf(out[v], 1.0f);
    }
    free(is_below);
    return charge_budget(s, select, m->vertex_count, err);
}

/* ---- combined ---- */

static mrt_result select_one(float *out, const rig_select *select, selecting *s, error *err);

static mrt_result select_joined(float *out, const rig_select *select, selecting *s, error *err)
{
    const uint32_t vertex_count = s->m->vertex_count;
    bool is_all = select->kind == SELECT_ALL;
    float *one = malloc(((size_t)vertex_count + 1) * sizeof *one);
    if (!one)
        return no_memory(err);
    for (uint32_t v = 0; v < vertex_count; ++v)
        out[v] = is_all ? 1.0f : 0.0f;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < select->child_count; ++i) {
        result = select_one(one, &select->child[i], s, err);
        for (uint32_t v = 0; result >= 0 && v < vertex_count; ++v)
            out[v] = is_all ? fminf(out[v], one[v]) : fmaxf(out[v], one[v]);
    }
    free(one);
    return result;
}

static mrt_result select_not(float *out, const rig_select *select, selecting *s, error *err)
{
    mrt_result result = select_one(out, &select->child[0], s, err);
    for (uint32_t v = 0; result >= 0 && v < s->m->vertex_count; ++v)
        out[v] = 1.0f - out[v];
    return result;
}

/* ---- by piece ---- */

static mrt_result find_pieces(selecting *s, error *err)
{
    if (s->piece)
        return MRT_OK;
    s->piece = malloc(((size_t)s->m->vertex_count + 1) * sizeof *s->piece);
    return s->piece ? topology_pieces(s->piece, &s->piece_count, s->m, s->t, err) : no_memory(err);
}

static mrt_result select_piece(float *out, const rig_select *select, selecting *s, error *err)
{
    const uint32_t count = s->m->vertex_count;
    if (select->vertex >= count)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "%s.piece: vertex %u does not exist, the mesh has %u vertices; choose again",
            path_of(select), select->vertex, count);
    mrt_result result = find_pieces(s, err);
    for (uint32_t v = 0; result >= 0 && v < count; ++v)
        out[v] = s->piece[v] == s->piece[select->vertex] ? 1.0f : 0.0f;
    return result;
}

static mrt_result select_pieces_inside(float *out, const rig_select *select, selecting *s,
                                       error *err)
{
    mrt_result result = find_pieces(s, err);
    uint8_t *is_out = result < 0 ? NULL : calloc((size_t)s->piece_count + 1, 1);
    if (!is_out)
        return result < 0 ? result : no_memory(err);
    result = select_one(out, &select->child[0], s, err);
    is_out[s->piece_count] = 1;
    for (uint32_t v = 0; result >= 0 && v < s->m->vertex_count; ++v)
        is_out[s->piece[v]] |= out[v] < 0.5f;
    for (uint32_t v = 0; result >= 0 && v < s->m->vertex_count; ++v)
        out[v] = is_out[s->piece[v]] ? 0.0f : 1.0f;
    free(is_out);
    return result;
}

/* Evaluates a selector that names vertices. The others name a region of space or combine
 * selectors. */
static mrt_result select_by_vertex(float *out, const rig_select *select, selecting *s, error *err)
{
    const mesh *m = s->m;
    mrt_result result = MRT_OK;
    switch (select->kind) {
    case SELECT_VERTICES:
        result = select_vertices(out, select, s, err);
        break;
    case SELECT_GROUP:
        result = charge_budget(s, select, m->part_count, err);
        if (result >= 0)
            result = select_group(out, select, m, err);
        break;
    case SELECT_ATTRIBUTE:
        result = select_attribute(out, select, m, err);
        break;
    case SELECT_PAINTED:
        result = charge_budget(s, select, select->range_count, err);
        if (result >= 0)
            result = select_painted(out, select, m, err);
        break;
    case SELECT_JOINT:
        result = select_joint(out, select, s, err);
        break;
    case SELECT_PIECE:
        result = select_piece(out, select, s, err);
        break;
    default:
        result = select_within(out, select, s, err);
        break;
    }
    if (result >= 0)
        spread(out, m);
    return result;
}

static mrt_result select_one(float *out, const rig_select *select, selecting *s, error *err)
{
    const mesh *m = s->m;
    mrt_result result = charge_budget(s, select, m->vertex_count / 4u + 1, err);
    if (result < 0)
        return result;
    memset(out, 0, (size_t)m->vertex_count * sizeof *out);
    switch (select->kind) {
    case SELECT_NOTHING:
        break;
    case SELECT_VERTICES:
    case SELECT_GROUP:
    case SELECT_ATTRIBUTE:
    case SELECT_PAINTED:
    case SELECT_WITHIN:
    case SELECT_PIECE:
    case SELECT_JOINT:
        return select_by_vertex(out, select, s, err);
    case SELECT_BOX:
    case SELECT_ELLIPSOID:
    case SELECT_HALF_SPACE:
        select_shape(out, select, m);
        break;
    case SELECT_ALL:
    case SELECT_ANY:
        return select_joined(out, select, s, err);
    case SELECT_NOT:
        return select_not(out, select, s, err);
    case SELECT_PIECES_INSIDE:
        return select_pieces_inside(out, select, s, err);
    }
    return MRT_OK;
}

mrt_result bind_select(float *out, const rig_select *select, const mesh *m, const topology *t,
                       error *err)
{
    selecting s = selecting_on(m, t);
    mrt_result result = select_one(out, select, &s, err);
    selecting_finish(&s);
    return result;
}

/* ---- marks set by the regions ---- */

typedef struct marking {
    bind_marks *marks;
    const rig *r;
    const mesh *m;
    selecting selecting;
    float *selected;        /* vertex_count: weights of the current region */
    uint32_t *rigid_region; /* vertex_count: region that made the vertex rigid */
} marking;

static float *weight_at(const marking *k, uint32_t bone, uint32_t vertex)
{
    return &k->marks->weight[(size_t)bone * k->m->vertex_count + vertex];
}

/* Sets a weight. Other bones keep their shares, or share the room that the new one leaves. A share
 * of 1 sets all others to 0. */
static void mark_weight(const marking *k, uint32_t vertex, uint32_t bone, float weight)
{
    float others = 0.0f, room = 1.0f - weight;
    *weight_at(k, bone, vertex) = weight;
    for (uint32_t b = 0; b < k->r->bone_count; ++b)
        if (b != bone && !isnan(*weight_at(k, b, vertex)))
            others += *weight_at(k, b, vertex);
    for (uint32_t b = 0; b < k->r->bone_count; ++b) {
        float *other = weight_at(k, b, vertex);
        if (b == bone)
            continue;
        if (room <= 0.0f)
            *other = 0.0f;
        else if (!isnan(*other) && others > room)
            *other *= room / others;
    }
}

static mrt_result refuse_overlap(const marking *k, uint32_t region, uint32_t vertex, error *err)
{
    uint32_t first = k->rigid_region[vertex];
    json_path a = rig_entry_path(k->r, RIG_REGIONS, first),
              b = rig_entry_path(k->r, RIG_REGIONS, region);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: overlaps %s: vertex %u would be rigid on \"%s\" and on \"%s\"; remove it "
                     "from one of them",
                     b.text, a.text, vertex, k->r->bone[k->r->region[region].bone].name,
                     k->r->bone[k->r->region[first].bone].name);
}

static mrt_result mark_rigid(const marking *k, uint32_t region, uint32_t vertex, error *err)
{
    uint32_t bone = k->r->region[region].bone;
    uint32_t *rigid_bone = &k->marks->rigid_bone[vertex];
    if (*rigid_bone != RIG_NONE && *rigid_bone != bone)
        return refuse_overlap(k, region, vertex, err);
    if (*rigid_bone == RIG_NONE)
        k->rigid_region[vertex] = region;
    *rigid_bone = bone;
    return MRT_OK;
}

static mrt_result mark_region(marking *k, uint32_t index, error *err)
{
    const rig_region *region = &k->r->region[index];
    mrt_result result = select_one(k->selected, &region->select, &k->selecting, err);
    if (result >= 0)
        result = charge_budget(&k->selecting, &region->select,
                               (uint64_t)k->m->vertex_count * k->r->bone_count / 4u, err);
    for (uint32_t v = 0; result >= 0 && v < k->m->vertex_count; ++v) {
        float share = k->selected[v];
        if (region->is_rigid) {
            if (share >= 0.5f)
                result = mark_rigid(k, index, v, err);
            continue;
        }
        if (!(share > 0.0f))
            continue;
        if (!isnan(region->weight))
            mark_weight(k, v, region->bone, share * (float)region->weight);
        if (!isnan(region->mobility))
            k->marks->mobility[v] = share * (float)region->mobility;
    }
    return result;
}

static void apply_rigid(const marking *k)
{
    for (uint32_t v = 0; v < k->m->vertex_count; ++v) {
        if (k->marks->rigid_bone[v] == RIG_NONE)
            continue;
        mark_weight(k, v, k->marks->rigid_bone[v], 1.0f);
        k->marks->mobility[v] = 0.0f;
    }
}

static mrt_result check_bones_have_vertices(const marking *k, error *err)
{
    for (uint32_t b = 0; k->r->bone_count > 1 && b < k->r->bone_count; ++b) {
        bool found = false;
        for (uint32_t v = 0; !found && v < k->m->vertex_count; ++v)
            found = *weight_at(k, b, v) > 0.0f;
        if (found)
            continue;
        json_path path = rig_entry_path(k->r, RIG_BONES, b);
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: no vertex belongs to the bone \"%s\"; add a region for it to "
                         "$.regions, or remove the bone",
                         path.text, k->r->bone[b].name);
    }
    return MRT_OK;
}

static mrt_result check_vertices(const rig *r, const mesh *m, error *err)
{
    if (r->mesh_vertex_count != 0 && r->mesh_vertex_count != m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "$.mesh_vertices: the rig was made for a mesh of %u vertices, but this "
                         "one has %u; use that mesh, or draft a rig with marotte rig new",
                         r->mesh_vertex_count, m->vertex_count);
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        if (r->contact[i].vertex < m->vertex_count)
            continue;
        json_path path = rig_entry_path(r, RIG_CONTACTS, i);
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "%s.vertex: vertex %u does not exist, the mesh has %u vertices; choose again",
            path.text, r->contact[i].vertex, m->vertex_count);
    }
    return MRT_OK;
}

static mrt_result allocate(marking *k, error *err)
{
    size_t count = (size_t)k->m->vertex_count + 1;
    bind_marks *marks = k->marks;
    marks->rigid_bone = malloc(count * sizeof *marks->rigid_bone);
    marks->weight = malloc(count * k->r->bone_count * sizeof *marks->weight);
    marks->mobility = malloc(count * sizeof *marks->mobility);
    k->selected = malloc(count * sizeof *k->selected);
    k->rigid_region = malloc(count * sizeof *k->rigid_region);
    if (!marks->rigid_bone || !marks->weight || !marks->mobility || !k->selected ||
        !k->rigid_region)
        return no_memory(err);
    for (size_t i = 0; i < (size_t)k->m->vertex_count * k->r->bone_count; ++i)
        marks->weight[i] = NAN;
    for (uint32_t v = 0; v < k->m->vertex_count; ++v) {
        marks->rigid_bone[v] = RIG_NONE;
        marks->mobility[v] = NAN;
    }
    return MRT_OK;
}

typedef enum marks_of { OF_ALL = 0, OF_BARE } marks_of;

static mrt_result create(bind_marks *out, marks_of which, const rig *r, const mesh *m,
                         const topology *t, error *err)
{
    marking k = {.marks = out, .r = r, .m = m, .selecting = selecting_on(m, t)};
    *out = (bind_marks){0};
    mrt_result result = check_vertices(r, m, err);
    if (result >= 0)
        result = allocate(&k, err);
    for (uint32_t i = 0; result >= 0 && i < r->region_count; ++i)
        if (which == OF_ALL || !rig_region_is_paint(&r->region[i]))
            result = mark_region(&k, i, err);
    if (result >= 0)
        apply_rigid(&k);
    if (result >= 0 && which == OF_ALL)
        result = check_bones_have_vertices(&k, err);
    selecting_finish(&k.selecting);
    free(k.selected);
    free(k.rigid_region);
    if (result < 0)
        bind_marks_destroy(out);
    return result;
}

mrt_result bind_marks_create(bind_marks *out, const rig *r, const mesh *m, const topology *t,
                             error *err)
{
    return create(out, OF_ALL, r, m, t, err);
}

mrt_result bind_marks_create_bare(bind_marks *out, const rig *r, const mesh *m, const topology *t,
                                  error *err)
{
    return create(out, OF_BARE, r, m, t, err);
}

void bind_marks_destroy(bind_marks *marks)
{
    if (!marks)
        return;
    free(marks->rigid_bone);
    free(marks->weight);
    free(marks->mobility);
    *marks = (bind_marks){0};
}

static void add_to_focus(mesh *m, const float at[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        float low = m->has_focus ? m->focus_low[axis] : at[axis];
        float high = m->has_focus ? m->focus_high[axis] : at[axis];
        m->focus_low[axis] = fminf(low, at[axis]);
        m->focus_high[axis] = fmaxf(high, at[axis]);
    }
    m->has_focus = true;
}

/* Cuts the focus off below the face where hair hangs down by more than half of the face's height:
 * hands are laid on the box, and would pull the hair. */
static void cut_off_hair(mesh *m, const bind_marks *marks)
{
    float low = INFINITY, high = -INFINITY;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const float y = m->position[(size_t)v * 3 + 1];
        if (!(marks->mobility[v] > 0.5f)) /* NaN: free, but not marked as the face */
            continue;
        low = fminf(low, y);
        high = fmaxf(high, y);
    }
    if (low <= high && m->focus_low[1] < low - 0.5f * (high - low))
        m->focus_low[1] = low - 0.5f * (high - low);
}

void bind_focus(mesh *m, const rig *r, const topology *t)
{
    uint32_t skull = rig_find_bone(r, "skull"), body;
    bind_marks marks;
    m->has_focus = false;
    if (skull == RIG_NONE || (body = r->bone[skull].parent) == RIG_NONE ||
        bind_marks_create(&marks, r, m, t, NULL) < 0)
        return;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        if (marks.rigid_bone[v] != body &&
            !(marks.weight[(size_t)body * m->vertex_count + v] >= 0.5f))
            add_to_focus(m, m->position + (size_t)v * 3);
    if (m->has_focus)
        cut_off_hair(m, &marks);
    bind_marks_destroy(&marks);
}
