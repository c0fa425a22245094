#include "face/rig/rig_check_parts.h"

#include "face/rig/rig_mirror.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HOLES_SHOWN = 6, PARTS_SHOWN = 12 };

/* ---- size and identity ---- */

void rig_check_size(rig_checking *c)
{
    float low[3], high[3];
    mesh_bounds(c->m, low, high);
    double height_mm = (double)high[1] - (double)low[1];
    if (height_mm >= 100.0 && height_mm <= 1000.0)
        rig_find(c, RIG_NOTE, "$.unit", "the mesh is %.0f mm high", height_mm);
    else
        rig_find(c, RIG_WARNING, "$.unit",
                 "the mesh is %.3g mm high; a head is 100 to 1000 mm: is the unit right?",
                 height_mm);
}

void rig_check_mesh_hash(rig_checking *c)
{
    if (c->r->mesh_hash == 0)
        return;
    uint64_t hash = rig_mesh_hash(c->m->vertex_count, c->m->triangle, c->m->triangle_count);
    if (hash != c->r->mesh_hash)
        rig_find(c, RIG_NOTE, "$.mesh_hash",
                 "the mesh is not the one that the rig was made for: its triangles changed "
                 "(%016llx now); look at the picture of marotte rig show, then correct or remove "
                 "mesh_hash",
                 (unsigned long long)hash);
}

void rig_check_symmetry(rig_checking *c)
{
    const double reach_mm = 0.5;
    double middle_x = c->head ? c->head->middle_x : 0.0;
    uint32_t count, example;
    if (!rig_mirror_count_alone(&count, &example, c->m, middle_x, reach_mm)) {
        c->is_out_of_memory = true;
        return;
    }
    if (count > 0)
        rig_find(c, RIG_NOTE, "$.mesh",
                 "%u of %u vertices, %u the first, have no mirror image within %.1f mm of the "
                 "plane x = %.2f mm",
                 count, c->m->vertex_count, example, reach_mm, middle_x);
}

/* ---- connected pieces ---- */

typedef struct pieces {
    uint32_t *of_vertex; /* vertex_count */
    bool *is_marked;     /* count: a region speaks of one of its vertices */
    bool *is_open;
    double *volume; /* count, mm^3 */
    uint32_t *size;
    uint32_t count;
} pieces;

static void pieces_finish(pieces *p)
{
    free(p->of_vertex);
    free(p->is_marked);
    free(p->is_open);
    free(p->volume);
    free(p->size);
}

static void flood(pieces *p, uint32_t *stack, uint32_t from, const topology *t)
{
    uint32_t waiting = 0;
    stack[waiting++] = from;
    p->of_vertex[from] = p->count;
    while (waiting > 0) {
        uint32_t v = stack[--waiting];
        for (uint32_t i = t->neighbour_start[v]; i < t->neighbour_start[v + 1]; ++i) {
            uint32_t next = t->neighbour[i];
            if (p->of_vertex[next] != UINT32_MAX)
                continue;
            p->of_vertex[next] = p->count;
            stack[waiting++] = next;
        }
    }
}

static bool label_pieces(pieces *p, const mesh *m, const topology *t)
{
    size_t room = (size_t)m->vertex_count + 1;
    uint32_t *stack = malloc(room * sizeof *stack);
    p->of_vertex = malloc(room * sizeof *p->of_vertex);
    if (!stack || !p->of_vertex) {
        free(stack);
        return false;
    }
    memset(p->of_vertex, 0xff, room * sizeof *p->of_vertex);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        if (p->of_vertex[v] != UINT32_MAX)
            continue;
        flood(p, stack, v, t);
        p->count += 1;
    }
    free(stack);
    return true;
}

static bool is_vertex_marked(const rig_checking *c, uint32_t vertex)
{
    for (uint32_t b = 0; b < c->r->bone_count; ++b)
        if (!isnan(c->marks->weight[(size_t)b * c->m->vertex_count + vertex]))
            return true;
    return false;
}

/* Six times the volume between the triangle and a point near the piece. */
static double wedge(const mesh *m, uint32_t triangle, vec3 from)
{
    vec3 p[3];
    for (size_t i = 0; i < 3; ++i)
        p[i] = vec3_sub(rig_mirror_position(m, m->triangle[(size_t)triangle * 3 + i]), from);
    return vec3_dot(p[0], vec3_cross(p[1], p[2]));
}

static void measure_pieces(pieces *p, const rig_checking *c)
{
    float low[3], high[3];
    mesh_bounds(c->m, low, high);
    vec3 centre = {0.5 * ((double)low[0] + (double)high[0]),
                   0.5 * ((double)low[1] + (double)high[1]),
                   0.5 * ((double)low[2] + (double)high[2])};
    for (uint32_t v = 0; v < c->m->vertex_count; ++v) {
        uint32_t piece = p->of_vertex[v];
        p->size[piece] += 1;
        p->is_open[piece] = p->is_open[piece] || c->t->on_border[v];
        p->is_marked[piece] = p->is_marked[piece] || (c->marks && is_vertex_marked(c, v));
    }
    for (uint32_t i = 0; i < c->m->triangle_count; ++i)
        p->volume[p->of_vertex[c->m->triangle[(size_t)i * 3]]] += wedge(c->m, i, centre) / 6.0;
}

static bool pieces_make(pieces *p, const rig_checking *c)
{
    *p = (pieces){0};
    if (!label_pieces(p, c->m, c->t))
        return false;
    size_t room = (size_t)p->count + 1;
    p->is_marked = calloc(room, sizeof *p->is_marked);
    p->is_open = calloc(room, sizeof *p->is_open);
    p->volume = calloc(room, sizeof *p->volume);
    p->size = calloc(room, sizeof *p->size);
    if (!p->is_marked || !p->is_open || !p->volume || !p->size)
        return false;
    measure_pieces(p, c);
    return true;
}

/* ---- what is said of them ---- */

static bool sounds_rigid(const char *name)
{
    static const char *const words[] = {"teeth", "tooth", "eye", "gum"};
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i)
        if (strstr(name, words[i]))
            return true;
    return false;
}

static uint32_t count_unmarked(const rig_checking *c, const pieces *p, const mesh_part *part)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < part->triangle_count; ++i) {
        size_t corner = ((size_t)part->first_triangle + i) * 3;
        count += !p->is_marked[p->of_vertex[c->m->triangle[corner]]];
    }
    return count;
}

static void check_unmarked(rig_checking *c, const pieces *p)
{
    uint32_t shown = 0;
    for (uint32_t i = 0; c->r->bone_count > 1 && i < c->m->part_count; ++i) {
        const mesh_part *part = &c->m->part[i];
        uint32_t count = count_unmarked(c, p, part);
        if (count == 0 || shown == PARTS_SHOWN)
            continue;
        shown += 1;
        rig_find(c, sounds_rigid(part->name) ? RIG_WARNING : RIG_NOTE, "$.regions",
                 "no region marks %s of part \"%s\" (%u triangles): it rides on the nearest "
                 "surface that is marked",
                 count == part->triangle_count ? "anything" : "all pieces", part->name, count);
    }
}

static uint32_t largest_piece(const pieces *p)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < p->count; ++i)
        if (p->size[i] > p->size[best])
            best = i;
    return best;
}

/* Open pieces have no inside, but for the head itself. */
static void check_inside_out(rig_checking *c, const pieces *p)
{
    uint32_t head = largest_piece(p), closed = 0, example = 0;
    for (uint32_t v = c->m->vertex_count; v-- > 0;) {
        uint32_t piece = p->of_vertex[v];
        if (piece != head && !p->is_open[piece] && p->volume[piece] < 0.0)
            example = v;
    }
    for (uint32_t i = 0; i < p->count; ++i)
        closed += i != head && !p->is_open[i] && p->volume[i] < 0.0;
    if (p->count > 0 && p->volume[head] < 0.0)
        rig_find(c, RIG_WARNING, "$.mesh",
                 "the surface of the head faces inwards; flip its normals where it was modelled");
    if (closed > 0)
        rig_find(c, RIG_WARNING, "$.mesh",
                 "%u closed piece%s (one has vertex %u) face%s inwards; flip the normals where it "
                 "was modelled",
                 closed, closed == 1 ? "" : "s", example, closed == 1 ? "s" : "");
}

/* ---- holes ---- */

typedef struct hole {
    double length_mm;
    vec3 centre;
    uint32_t vertex_count;
} hole;

static hole measure_hole(const rig_checking *c, uint32_t loop)
{
    const topology *t = c->t;
    uint32_t first = t->border_loop_start[loop], end = t->border_loop_start[loop + 1];
    hole out = {.vertex_count = end - first};
    for (uint32_t i = first; i < end; ++i) {
        vec3 a = rig_mirror_position(c->m, t->border_vertex[i]);
        vec3 b = rig_mirror_position(c->m, t->border_vertex[i + 1 < end ? i + 1 : first]);
        out.length_mm += vec3_length(vec3_sub(a, b));
        out.centre = vec3_add(out.centre, vec3_scale(a, 1.0 / (end - first)));
    }
    return out;
}

static int compare_holes(const void *left, const void *right)
{
    const hole *a = left, *b = right;
    return a->length_mm > b->length_mm ? -1 : a->length_mm < b->length_mm;
}

static void check_holes(rig_checking *c)
{
    uint32_t count = c->t->border_loop_count;
    hole *all = malloc(((size_t)count + 1) * sizeof *all);
    if (!all) {
        c->is_out_of_memory = true;
        return;
    }
    for (uint32_t i = 0; i < count; ++i)
        all[i] = measure_hole(c, i);
    qsort(all, count, sizeof *all, compare_holes);
    for (uint32_t i = 0; i < count && i < HOLES_SHOWN; ++i)
        rig_find(c, RIG_NOTE, "$.mesh",
                 "an open border of %u vertices, %.0f mm long, around (%.0f, %.0f, %.0f) mm",
                 all[i].vertex_count, all[i].length_mm, all[i].centre.x, all[i].centre.y,
                 all[i].centre.z);
    if (count > HOLES_SHOWN)
        rig_find(c, RIG_NOTE, "$.mesh", "and %u shorter open borders", count - HOLES_SHOWN);
    free(all);
}

void rig_check_surface(rig_checking *c)
{
    pieces p;
    if (pieces_make(&p, c)) {
        if (c->marks)
            check_unmarked(c, &p);
        check_inside_out(c, &p);
    } else {
        c->is_out_of_memory = true;
    }
    pieces_finish(&p);
    check_holes(c);
    if (c->t->rejected_count > 0)
        rig_find(c, RIG_NOTE, "$.mesh",
                 "%u triangles, %u the first, are degenerate or where more than two meet at an "
                 "edge: weights do not spread over them",
                 c->t->rejected_count, c->t->rejected_triangle[0]);
}
