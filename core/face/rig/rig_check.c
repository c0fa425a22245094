#include "face/rig_check.h"

#include "base/arrays.h"
#include "face/bones.h"
#include "face/rig/rig_document.h"
#include "face/rig/rig_anatomy.h"
#include "face/rig/rig_poses.h"
#include "mesh/position.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct checking {
    const rig *r;
    const mesh *m;
    const topology *t;
    const binding *binding;  /* or NULL */
    const bind_marks *marks; /* NULL if they could not be made */
    const rig_head *head;    /* NULL if no profile was found */
    double radius_mm;        /* from the rig, or a quarter of the height */
    rig_findings *out;
    bool is_out_of_memory;
} checking;

/* ---- findings ---- */

static rig_finding *add_finding(checking *c)
{
    rig_findings *out = c->out;
    if (out->count == out->capacity) {
        uint32_t capacity = out->capacity * 2 + 16;
        rig_finding *grown = realloc(out->item, capacity * sizeof *grown);
        if (!grown) {
            c->is_out_of_memory = true;
            return NULL;
        }
        out->item = grown;
        out->capacity = capacity;
    }
    out->count += 1;
    return &out->item[out->count - 1];
}

__attribute__((format(printf, 4, 5))) static void report(checking *c, rig_severity severity,
                                                         const char *path, const char *format, ...)
{
    rig_finding *finding = add_finding(c);
    if (!finding)
        return;
    finding->severity = severity;
    (void)snprintf(finding->path, sizeof finding->path, "%s", path);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(finding->text, sizeof finding->text, format, arguments);
    va_end(arguments);
}

/* Splits "base.rig.json: $.bones[1]: text" into a path and a text. */
static void find_error(checking *c, const error *err)
{
    const char *path_start = strchr(err->text, '$');
    const char *colon = path_start ? strstr(path_start, ": ") : NULL;
    if (!colon) {
        report(c, RIG_ERROR, "$", "%s", err->text);
        return;
    }
    char path[128];
    (void)snprintf(path, sizeof path, "%.*s", (int)(colon - err->text), err->text);
    report(c, RIG_ERROR, path, "%s", colon + 2);
}

static void sort_by_severity(rig_findings *findings)
{
    for (uint32_t i = 1; i < findings->count; ++i) { /* stable; the lists are short */
        rig_finding moved = findings->item[i];
        uint32_t at = i;
        for (; at > 0 && findings->item[at - 1].severity < moved.severity; --at)
            findings->item[at] = findings->item[at - 1];
        findings->item[at] = moved;
    }
}

void rig_findings_finish(rig_findings *findings)
{
    free(findings->item);
    *findings = (rig_findings){0};
}

uint32_t rig_findings_count(const rig_findings *findings, rig_severity severity)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < findings->count; ++i)
        count += findings->item[i].severity == severity;
    return count;
}

enum { HOLES_SHOWN = 6, PARTS_SHOWN = 12 };

/* ---- size and identity ---- */

static void check_size(checking *c)
{
    float low[3], high[3];
    mesh m = *c->m; /* the mesh in the frame that this rig gives it */
    bind_focus(&m, c->r, c->t);
    mesh_focus(&m, low, high);
    double height_mm = (double)high[1] - (double)low[1];
    if (height_mm >= 100.0 && height_mm <= 1000.0)
        report(c, RIG_NOTE, "$.unit", "the mesh is %.0f mm high", height_mm);
    else
        report(c, RIG_WARNING, "$.unit",
               "the mesh is %.4g mm high, but a head is 100 to 1000 mm; check the unit", height_mm);
}

static void check_mesh_hash(checking *c)
{
    if (c->r->mesh_hash == 0)
        return;
    uint64_t hash = rig_mesh_hash(c->m->vertex_count, c->m->triangle, c->m->triangle_count);
    if (hash != c->r->mesh_hash)
        report(c, RIG_NOTE, "$.mesh_hash",
               "the rig was made for another mesh: the triangles changed (hash now %016llx); check "
               "the picture of marotte rig show, then correct or remove mesh_hash",
               (unsigned long long)hash);
}

static void check_symmetry(checking *c)
{
    const double reach_mm = 0.5;
    double middle_x = c->head ? c->head->middle_x : 0.0;
    uint32_t count, example;
    if (!rig_mirror_count_alone(&count, &example, c->m, NULL, middle_x, reach_mm)) {
        c->is_out_of_memory = true;
        return;
    }
    if (count > 0)
        report(c, RIG_NOTE, "$.mesh",
               "%u of %u vertices (the first is %u) have no mirror image within %.1f mm across the "
               "plane x = %.2f mm",
               count, c->m->vertex_count, example, reach_mm, middle_x);
}

/* ---- connected pieces ---- */

typedef struct pieces {
    arrays arrays;       /* owner of the arrays below */
    uint32_t *of_vertex; /* vertex_count: index of the piece */
    bool *is_marked;     /* count: a region marks at least one vertex of the piece */
    bool *is_open;
    double *volume; /* count, mm^3 */
    uint32_t *size;
    uint32_t count;
} pieces;

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
    uint32_t *stack = arrays_add(&p->arrays, room, sizeof *stack);
    p->of_vertex = arrays_add(&p->arrays, room, sizeof *p->of_vertex);
    if (p->arrays.failed)
        return false;
    memset(p->of_vertex, 0xff, room * sizeof *p->of_vertex);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        if (mesh_point(m, v) != v)
            p->of_vertex[v] = p->of_vertex[mesh_point(m, v)];
        if (p->of_vertex[v] != UINT32_MAX)
            continue;
        flood(p, stack, v, t);
        p->count += 1;
    }
    return true;
}

static bool is_vertex_marked(const checking *c, uint32_t vertex)
{
    for (uint32_t b = 0; b < c->r->bone_count; ++b)
        if (!isnan(c->marks->weight[(size_t)b * c->m->vertex_count + vertex]))
            return true;
    return false;
}

/* Returns six times the volume between the triangle and a point near the piece. */
static double wedge(const mesh *m, uint32_t triangle, vec3 from)
{
    vec3 p[3];
    for (size_t i = 0; i < 3; ++i)
        p[i] = vec3_sub(mesh_position(m, m->triangle[(size_t)triangle * 3 + i]), from);
    return vec3_dot(p[0], vec3_cross(p[1], p[2]));
}

static void measure_pieces(pieces *p, const checking *c)
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

static bool pieces_make(pieces *p, const checking *c)
{
    *p = (pieces){0};
    if (!label_pieces(p, c->m, c->t))
        return false;
    p->is_marked = arrays_add(&p->arrays, p->count, sizeof *p->is_marked);
    p->is_open = arrays_add(&p->arrays, p->count, sizeof *p->is_open);
    p->volume = arrays_add(&p->arrays, p->count, sizeof *p->volume);
    p->size = arrays_add(&p->arrays, p->count, sizeof *p->size);
    if (p->arrays.failed)
        return false;
    measure_pieces(p, c);
    return true;
}

/* ---- findings about pieces ---- */

static bool is_rigid_name(const char *name)
{
    static const char *const words[] = {"teeth", "tooth", "eye", "gum"};
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i)
        if (strstr(name, words[i]))
            return true;
    return false;
}

static uint32_t count_unmarked(const checking *c, const pieces *p, const mesh_part *part)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < part->triangle_count; ++i) {
        size_t corner = ((size_t)part->first_triangle + i) * 3;
        count += !p->is_marked[p->of_vertex[c->m->triangle[corner]]];
    }
    return count;
}

static void check_unmarked(checking *c, const pieces *p)
{
    uint32_t shown = 0;
    for (uint32_t i = 0; c->r->bone_count > 1 && i < c->m->part_count; ++i) {
        const mesh_part *part = &c->m->part[i];
        uint32_t count = count_unmarked(c, p, part);
        if (count == 0 || shown == PARTS_SHOWN)
            continue;
        shown += 1;
        report(c, is_rigid_name(part->name) ? RIG_WARNING : RIG_NOTE, "$.regions",
               "no region marks %s of part \"%s\" (%u triangles): it follows the nearest marked "
               "surface",
               count == part->triangle_count ? "anything" : "all pieces", part->name, count);
    }
}

static double height_of(const mesh *m)
{
    float low[3], high[3];
    mesh_bounds(m, low, high);
    return (double)high[1] - (double)low[1];
}

/* A point of the surface, with its cell in a grid that is much finer than the triangles. */
typedef struct cell_point {
    int64_t cell[3];
    uint32_t vertex;
} cell_point;

static int by_cell(const void *left, const void *right)
{
    const cell_point *a = left, *b = right;
    for (int i = 0; i < 3; ++i)
        if (a->cell[i] != b->cell[i])
            return a->cell[i] < b->cell[i] ? -1 : 1;
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

/* Returns how much the bone weights of two vertices differ, 0..1. */
static double apart(const checking *c, uint32_t v, uint32_t w)
{
    const binding *b = c->binding;
    double sum = 0.0;
    for (size_t bone = 0; bone < b->bone_count; ++bone)
        sum += fabs((double)b->weight[bone * b->vertex_count + v] -
                    (double)b->weight[bone * b->vertex_count + w]);
    return 0.5 * sum;
}

/* Warns where two pieces touch but move differently, for example a head and its neck. Rigid
 * vertices are left out, because they may move away from the skin. */
static void check_parting(checking *c, const pieces *p)
{
    enum { FEW = 4 }; /* points; fewer can touch by chance */
    const double parts_from = 0.05;
    float low[3], high[3];
    uint32_t count = 0, found = 0, example[2] = {0, 0};
    mesh_bounds(c->m, low, high);
    const double cell_mm = fmax(1e-5 * height_of(c->m), 1e-9);
    cell_point *at =
        c->binding && c->marks ? malloc(((size_t)c->m->vertex_count + 1) * sizeof *at) : NULL;
    for (uint32_t v = 0; at && v < c->m->vertex_count; ++v) {
        if (mesh_point(c->m, v) != v || p->of_vertex[v] >= p->count ||
            c->marks->rigid_bone[v] != RIG_NONE)
            continue;
        for (size_t i = 0; i < 3; ++i)
            at[count].cell[i] = (int64_t)floor(
                ((double)c->m->position[3 * (size_t)v + i] - (double)low[i]) / cell_mm + 0.5);
        at[count++].vertex = v;
    }
    if (at)
        qsort(at, count, sizeof *at, by_cell);
    for (uint32_t i = 1; at && i < count; ++i) {
        uint32_t v = at[i - 1].vertex, w = at[i].vertex;
        if (memcmp(at[i - 1].cell, at[i].cell, sizeof at->cell) != 0 ||
            p->of_vertex[v] == p->of_vertex[w] || !(apart(c, v, w) > parts_from))
            continue;
        if (found++ == 0) {
            example[0] = v;
            example[1] = w;
        }
    }
    if (found >= FEW)
        report(
            c, RIG_WARNING, "$.regions",
            "pieces of the mesh touch at %u places but follow different bones (first at vertices "
            "%u and %u), so gaps open there; give both pieces the same weight, or join them",
            found, example[0], example[1]);
    free(at);
}

static uint32_t largest_piece(const pieces *p)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < p->count; ++i)
        if (p->size[i] > p->size[best])
            best = i;
    return best;
}

/* Warns about closed pieces that face inwards. An open piece has no inside; only the head
 * itself is checked although it may be open. */
static void check_inside_out(checking *c, const pieces *p)
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
        report(c, RIG_WARNING, "$.mesh",
               "the surface of the head faces inwards; flip its normals in the modelling program");
    if (closed > 0)
        report(c, RIG_WARNING, "$.mesh",
               "%u closed piece%s (one has vertex %u) face%s inwards; flip the normals in the "
               "modelling program",
               closed, closed == 1 ? "" : "s", example, closed == 1 ? "s" : "");
}

/* ---- holes ---- */

typedef struct hole {
    double length_mm;
    vec3 centre;
    uint32_t vertex_count;
} hole;

static hole measure_hole(const checking *c, uint32_t loop)
{
    const topology *t = c->t;
    uint32_t first = t->border_loop_start[loop], end = t->border_loop_start[loop + 1];
    hole out = {.vertex_count = end - first};
    for (uint32_t i = first; i < end; ++i) {
        vec3 a = mesh_position(c->m, t->border_vertex[i]);
        vec3 b = mesh_position(c->m, t->border_vertex[i + 1 < end ? i + 1 : first]);
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

static void check_holes(checking *c)
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
        report(c, RIG_NOTE, "$.mesh",
               "an open border of %u vertices, %.0f mm long, around (%.0f, %.0f, %.0f) mm",
               all[i].vertex_count, all[i].length_mm, all[i].centre.x, all[i].centre.y,
               all[i].centre.z);
    if (count > HOLES_SHOWN)
        report(c, RIG_NOTE, "$.mesh", "and %u shorter open borders", count - HOLES_SHOWN);
    free(all);
}

/* Checks for unmarked pieces, surfaces that face inwards and holes. */
static void check_surface(checking *c)
{
    pieces p;
    if (pieces_make(&p, c)) {
        if (c->marks) {
            check_unmarked(c, &p);
            check_parting(c, &p);
        }
        check_inside_out(c, &p);
    } else {
        c->is_out_of_memory = true;
    }
    arrays_free(&p.arrays);
    check_holes(c);
    if (c->t->rejected_count > 0)
        report(c, RIG_NOTE, "$.mesh",
               "%u triangles (the first is %u) are degenerate, or share an edge with more than one "
               "other triangle: weights do not spread over them",
               c->t->rejected_count, c->t->rejected_triangle[0]);
}

enum { FEW_CONTACTS = 8 }; /* fewer contacts may be far apart on purpose */
static const double twin_reach_mm = 1e-4, mirror_reach_mm = 2.0, still = 0.02;

/* ---- seams ---- */

/* Compares the marks of two vertices. A free vertex differs from a marked one, since they move
 * differently. */
static bool marks_differ(const bind_marks *marks, const rig *r, const mesh *m, uint32_t a,
                         uint32_t b)
{
    if (marks->rigid_bone[a] != marks->rigid_bone[b])
        return true;
    for (uint32_t bone = 0; bone < r->bone_count; ++bone) {
        const float *row = marks->weight + (size_t)bone * m->vertex_count;
        if (isnan(row[a]) != isnan(row[b]) || (!isnan(row[a]) && fabsf(row[a] - row[b]) > 0.02f))
            return true;
    }
    return false;
}

static bool weights_differ(const binding *b, uint32_t first, uint32_t second)
{
    for (uint32_t bone = 0; bone < b->bone_count; ++bone) {
        const float *row = b->weight + (size_t)bone * b->vertex_count;
        if (fabsf(row[first] - row[second]) > 0.02f)
            return true;
    }
    return false;
}

static bool are_twins(const mesh *m, uint32_t a, uint32_t b)
{
    vec3 d = vec3_sub(mesh_position(m, a), mesh_position(m, b));
    return vec3_dot(d, d) < twin_reach_mm * twin_reach_mm;
}

static mrt_result check_seams(const rig *r, const mesh *m, const bind_marks *marks,
                              const binding *b, error *err)
{
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        const rig_contact *contact = &r->contact[i];
        for (uint32_t v = 0; contact->bone == RIG_NONE && v < m->vertex_count; ++v) {
            if (v == contact->vertex || !are_twins(m, v, contact->vertex))
                continue;
            if (b ? !weights_differ(b, v, contact->vertex)
                  : !marks_differ(marks, r, m, v, contact->vertex))
                continue;
            json_path path = rig_entry_path(r, RIG_CONTACTS, i);
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s.vertex: the contact \"%s\" is on a seam: vertices %u and %u are "
                             "at the same place but follow different bones; choose a vertex away "
                             "from the seam, or set its bone",
                             path.text, contact->name, contact->vertex, v);
        }
    }
    return MRT_OK;
}

/* ---- mirrors ---- */

static void check_side(checking *c, uint32_t index, const json_path *path)
{
    const rig_contact *contact = &c->r->contact[index];
    size_t length = strlen(contact->name);
    const char *end = length > 2 ? contact->name + length - 2 : "";
    double x = mesh_position(c->m, contact->vertex).x;
    x -= c->head ? c->head->middle_x : 0.0;
    bool is_left = strcmp(end, ".l") == 0, is_right = strcmp(end, ".r") == 0;
    if ((is_left && x < 0.0) || (is_right && x > 0.0))
        report(c, RIG_WARNING, path->text,
               "\"%s\" is on the wrong side, at x = %.1f mm: +x is the subject's left",
               contact->name, x);
    if ((is_left || is_right) && contact->mirror == RIG_NONE)
        report(c, RIG_NOTE, path->text, "\"%s\" has no mirror", contact->name);
}

static void check_mirror(checking *c, uint32_t index, const json_path *path)
{
    const rig_contact *contact = &c->r->contact[index];
    if (contact->mirror == RIG_NONE || contact->mirror < index)
        return;
    const rig_contact *other = &c->r->contact[contact->mirror];
    double middle_x = c->head ? c->head->middle_x : 0.0, distance_mm;
    vec3 image = mesh_position(c->m, contact->vertex);
    image.x = 2.0 * middle_x - image.x;
    double off_mm = vec3_length(vec3_sub(image, mesh_position(c->m, other->vertex)));
    if (off_mm <= mirror_reach_mm)
        return;
    uint32_t better = rig_mirror_of(c->m, NULL, contact->vertex, middle_x, &distance_mm);
    report(c, RIG_WARNING, path->text,
           "\"%s\" and \"%s\" are %.1f mm from being mirror images; vertex %u would be %.1f mm off",
           contact->name, other->name, off_mm, better, distance_mm);
}

/* ---- reach ---- */

static void check_mobility(checking *c, uint32_t index, const json_path *path)
{
    const rig_contact *contact = &c->r->contact[index];
    uint32_t rigid_bone = c->marks->rigid_bone[contact->vertex];
    if (rigid_bone != RIG_NONE) {
        report(c, RIG_WARNING, path->text,
               "\"%s\" cannot be pulled: vertex %u is rigid on \"%s\"; choose a vertex on the skin",
               contact->name, contact->vertex, c->r->bone[rigid_bone].name);
        return;
    }
    float mobility =
        c->binding ? c->binding->mobility[contact->vertex] : c->marks->mobility[contact->vertex];
    if ((double)mobility < still)
        report(c, RIG_WARNING, path->text,
               "\"%s\" can hardly be pulled: the mobility of vertex %u is %.3f; choose a vertex "
               "further from the rigid regions",
               contact->name, contact->vertex, (double)mobility);
}

static double distance_between(const checking *c, uint32_t a, uint32_t b)
{
    return vec3_length(vec3_sub(mesh_position(c->m, c->r->contact[a].vertex),
                                mesh_position(c->m, c->r->contact[b].vertex)));
}

static void check_spacing(checking *c)
{
    double sum = 0.0;
    uint32_t count = c->r->contact_count;
    for (uint32_t i = 0; i < count; ++i) {
        double nearest = (double)INFINITY;
        for (uint32_t j = 0; j < count; ++j) {
            if (j == i)
                continue;
            double mm = distance_between(c, i, j);
            nearest = fmin(nearest, mm);
            if (j < i || mm >= 1e-3 * c->radius_mm)
                continue;
            json_path path = rig_entry_path(c->r, RIG_CONTACTS, j);
            report(c, RIG_WARNING, path.text,
                   "\"%s\" is %.3g mm from \"%s\": contacts closer than 1/1000 of the radius count "
                   "as one",
                   c->r->contact[j].name, mm, c->r->contact[i].name);
        }
        sum += nearest;
    }
    if (count < FEW_CONTACTS || c->radius_mm >= 2.0 * sum / count)
        return;
    report(c, RIG_WARNING, "$.solver.radius_mm",
           "the radius of %.1f mm is less than twice the mean distance of %.1f mm between "
           "contacts, so the skin dips between them; use about %.0f mm",
           c->radius_mm, sum / count, ceil(2.0 * sum / count));
}

static bool is_above(const checking *c, uint32_t contact, uint32_t other)
{
    return mesh_position(c->m, c->r->contact[contact].vertex).y >
           mesh_position(c->m, c->r->contact[other].vertex).y;
}

/* Checks the order of contacts from the tip of the nose down to the chin. */
static void check_lips(checking *c)
{
    static const char *const down[] = {"nose.tip", "lip.upper.mid", "lip.lower.mid", "chin"};
    uint32_t above = RIG_NONE;
    for (int i = 0; i < 4; ++i) {
        const uint32_t contact = rig_find_contact(c->r, down[i]);
        if (contact == RIG_NONE)
            continue;
        if (above != RIG_NONE && !is_above(c, above, contact))
            report(c, RIG_WARNING, "$.contacts",
                   "\"%s\" does not lie below \"%s\": is the mouth between nose and chin?", down[i],
                   c->r->contact[above].name);
        above = contact;
    }
}

static void check_contacts(checking *c)
{
    check_lips(c);
    for (uint32_t i = 0; i < c->r->contact_count; ++i) {
        json_path path = rig_entry_path(c->r, RIG_CONTACTS, i);
        check_side(c, i, &path);
        check_mirror(c, i, &path);
        check_mobility(c, i, &path);
    }
    check_spacing(c);
    if (c->r->contact_count == 0)
        report(c, RIG_WARNING, "$.contacts",
               "the rig has no contacts: no point of the face can be pulled by name");
}

/* ---- the jaw ---- */

static const double degree_per_radian = 57.29577951308232;

static mrt_result check_hinge(const rig *r, error *err)
{
    uint32_t jaw = rig_find_jaw(r);
    if (jaw == RIG_NONE || r->bone[jaw].hinge_left.x > r->bone[jaw].hinge_right.x)
        return MRT_OK;
    json_path path = rig_entry_path(r, RIG_BONES, jaw);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s.hinge: left is at x = %.1f mm and right at %.1f mm; exchange them, since "
                     "+x is the subject's left",
                     path.text, r->bone[jaw].hinge_left.x, r->bone[jaw].hinge_right.x);
}

/* Checks the axis against the usual place in human heads (theory 4.2), with a margin for
 * puppets. The height is a share of the way from chin to top, the depth a share of the way from
 * back to nose. */
static void check_axis(checking *c, const rig_bone *jaw, const json_path *path)
{
    const rig_head *head = c->head;
    vec3 middle = vec3_scale(vec3_add(jaw->hinge_left, jaw->hinge_right), 0.5);
    double up = (middle.y - head->chin.y) / (head->top_y - head->chin.y);
    double forward = (middle.z - head->back_z) / (head->nose.z - head->back_z);
    bool is_usual = up > 0.22 && up < 0.55 && forward > 0.35 && forward < 0.68;
    report(
        c, is_usual ? RIG_NOTE : RIG_WARNING, path->text,
        "the axis is at %.2f of the way from chin to top and %.2f of the way from back to front%s",
        up, forward,
        is_usual ? "" : "; usual are 0.25 to 0.45 and 0.45 to 0.6, just in front of the ears");
    double aside = middle.x - head->middle_x;
    if (fabs(aside) > 2.0)
        report(c, RIG_WARNING, path->text,
               "the middle of the axis is %.1f mm away from the symmetry plane", aside);
}

/* Finds the front edge of the jaw's rigid vertices: the foremost one. */
static bool find_incisor(vec3 *out, const checking *c, uint32_t jaw)
{
    bool found = c->r->bone[jaw].has_incisor;
    *out = c->r->bone[jaw].incisor;
    for (uint32_t v = 0; c->marks && !c->r->bone[jaw].has_incisor && v < c->m->vertex_count; ++v) {
        vec3 p = mesh_position(c->m, v);
        if (c->marks->rigid_bone[v] != jaw || (found && p.z <= out->z))
            continue;
        *out = p;
        found = true;
    }
    return found;
}

static void check_opening(checking *c, uint32_t jaw, const json_path *path)
{
    vec3 incisor;
    bones b;
    error err = {""};
    if (!find_incisor(&incisor, c, jaw)) {
        report(c, RIG_NOTE, path->text,
               "the jaw has no rigid vertex and the rig sets no \"incisor\": millimetres of jaw "
               "motion are measured at an estimated point");
        return;
    }
    if (bones_init(&b, c->r, incisor, &err) < 0) {
        report(c, RIG_ERROR, path->text, "%s", err.text);
        return;
    }
    const rig_bone *bone = &c->r->bone[jaw];
    rigid motion = bones_jaw(&b, bone->open_max_rad, 0.0, 0.0);
    double gap_mm = vec3_length(vec3_sub(rigid_apply(&motion, incisor), incisor));
    double head_mm = c->head ? c->head->top_y - c->head->chin.y : 225.0;
    double usual_mm = 50.0 * head_mm / 225.0;
    bool is_usual = gap_mm > 0.6 * usual_mm && gap_mm < 1.5 * usual_mm;
    report(c, is_usual ? RIG_NOTE : RIG_WARNING, path->text,
           "fully open (%.0f degrees) the incisors are %.1f mm apart%s%.0f mm would be usual for a "
           "head of %.0f mm",
           bone->open_max_rad * degree_per_radian, gap_mm, is_usual ? "; about " : "; ", usual_mm,
           head_mm);
}

static void check_teeth(checking *c, const rig_bone *jaw, const json_path *path)
{
    const uint32_t upper = rig_find_contact(c->r, "lip.upper.mid"),
                   lower = rig_find_contact(c->r, "lip.lower.mid");
    if (!jaw->has_incisor || upper == RIG_NONE || lower == RIG_NONE)
        return;
    const double lips_z = fmax(mesh_position(c->m, c->r->contact[upper].vertex).z,
                               mesh_position(c->m, c->r->contact[lower].vertex).z);
    if (jaw->incisor.z > lips_z)
        report(c, RIG_WARNING, path->text,
               "the lower front teeth (\"incisor\") lie %.1f mm before the lips; move them behind",
               jaw->incisor.z - lips_z);
}

static void check_moved(checking *c, uint32_t jaw, const json_path *path)
{
    const uint32_t count = c->m->vertex_count;
    float most = 0.0f;
    for (uint32_t v = 0; c->binding && v < count; ++v)
        most = fmaxf(most, c->binding->weight[(size_t)jaw * count + v]);
    if (c->binding && most < 0.5f)
        report(c, RIG_WARNING, path->text,
               "the jaw moves no skin; add a region of its bone on the chin and the lower lip");
}

static void check_jaw(checking *c)
{
    uint32_t jaw = rig_find_jaw(c->r);
    if (jaw == RIG_NONE) {
        report(c, RIG_NOTE, "$.bones", "no bone has a \"hinge\": the mouth does not open");
        return;
    }
    json_path path = rig_entry_path(c->r, RIG_BONES, jaw);
    if (c->head)
        check_axis(c, &c->r->bone[jaw], &path);
    check_opening(c, jaw, &path);
    check_teeth(c, &c->r->bone[jaw], &path);
    check_moved(c, jaw, &path);
}

/* ---- loose parts ---- */

static const double loose_most = 0.5; /* share of the vertices of the face and head */

static bool is_moved(const rig *r, uint32_t bone)
{
    for (; bone != RIG_NONE; bone = r->bone[bone].parent)
        if (r->bone[bone].kind == BONE_JAW || r->bone[bone].turn_count > 0)
            return true;
    return false;
}

/* Returns the share of the vertices that the bone, and the bones that ride on it, carry. */
static double share_carried(const checking *c, uint32_t bone)
{
    const binding *b = c->binding;
    uint32_t count = 0;
    for (uint32_t v = 0; v < b->vertex_count; ++v) {
        double share = 0.0;
        for (uint32_t i = 0; i < b->bone_count; ++i) {
            uint32_t on = i;
            while (on != RIG_NONE && on != bone)
                on = c->r->bone[on].parent;
            if (on == bone)
                share += (double)b->weight[(size_t)i * b->vertex_count + v];
        }
        count += share > 0.5;
    }
    return b->vertex_count > 0 ? (double)count / b->vertex_count : 0.0;
}

static void check_springs(checking *c)
{
    for (uint32_t i = 0; i < c->r->bone_count; ++i) {
        const rig_bone *bone = &c->r->bone[i];
        const json_path path = rig_entry_path(c->r, RIG_BONES, i);
        const vec3 arm = vec3_sub(bone->spring.tip, bone->centre);
        bool swings = false;
        if (!(bone->spring.frequency_hz > 0.0))
            continue;
        for (uint32_t k = 0; k < bone->turn_count; ++k)
            swings |= vec3_length(vec3_cross(bone->turn[k].axis, arm)) > 0.05 * vec3_length(arm);
        if (!swings)
            report(c, RIG_WARNING, path.text,
                   "\"%s\" does not swing: its turns go about the line from its centre to its tip; "
                   "choose axes across that line",
                   bone->name);
        if (bone->parent == RIG_NONE)
            report(c, RIG_WARNING, path.text,
                   "\"%s\" does not swing: no bone carries it; set \"parent\" to the bone that it "
                   "hangs on",
                   bone->name);
        else if (!is_moved(c->r, bone->parent))
            report(c, RIG_NOTE, path.text,
                   "\"%s\" does not swing: \"%s\", which carries it, cannot turn", bone->name,
                   c->r->bone[bone->parent].name);
        const double share = c->binding ? share_carried(c, i) : 0.0;
        if (share > loose_most)
            report(c, RIG_WARNING, path.text,
                   "\"%s\" swings, but it carries %.0f %% of the mesh; mark only the loose part "
                   "with it",
                   bone->name, 100.0 * share);
    }
}

/* ---- poses ---- */

static void check_pulls(checking *c, const rig_pose *pose, const char *path, double head_mm)
{
    double longest = 0.0;
    uint32_t which = 0;
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        double mm = vec3_length(pose->pull_mm[i]);
        if (mm <= longest)
            continue;
        longest = mm;
        which = pose->pull_contact[i];
    }
    if (longest > head_mm)
        report(c, RIG_WARNING, path,
               "\"%s\" is pulled by %.0f mm, more than the height of the head (%.0f mm); pulls are "
               "in mm, whatever the unit of the rig",
               c->r->contact[which].name, longest, head_mm);
    else if (pose->pull_count > 0 && longest < 1e-3 * head_mm)
        report(c, RIG_WARNING, path,
               "the pose \"%s\" pulls no contact by more than %.2g mm: are these metres? Pulls "
               "are in mm, whatever the unit of the rig",
               pose->name, longest);
}

/* True for the turns of a bone, which are angles; lateral and forward of a jaw are in mm. */
static bool is_turn(const rig *r, const char *dof)
{
    const char *dot = strrchr(dof, '.');
    for (uint32_t b = 0; dot && b < r->bone_count; ++b)
        if (strlen(r->bone[b].name) == (size_t)(dot - dof) &&
            strncmp(r->bone[b].name, dof, (size_t)(dot - dof)) == 0)
            return r->bone[b].kind == BONE_BALL || strcmp(dot, ".open") == 0;
    return false;
}

/* Returns 0 if the pose turns no bone. */
static double furthest_turn_deg(const rig *r, const rig_pose *pose)
{
    double most_deg = 0.0;
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        if (is_turn(r, pose->dof_name[i]))
            most_deg = fmax(most_deg, fabs(pose->dof_value[i]) * degree_per_radian);
    return most_deg;
}

/* Warns only if no pose turns a bone far. Small turns beside large ones in other poses are
 * intended. */
static void check_turns(checking *c, const rig_pose *pose, const char *path)
{
    double most_deg = furthest_turn_deg(c->r, pose), of_all_deg = 0.0;
    for (uint32_t i = 0; i < c->r->pose_count; ++i)
        of_all_deg = fmax(of_all_deg, furthest_turn_deg(c->r, &c->r->pose[i]));
    if (most_deg > 0.0 && of_all_deg < 1.6)
        report(c, RIG_WARNING, path,
               "no bone turns by more than %.2g degrees: are these radians? Turns are in degrees",
               most_deg);
}

/* Warns about a pose of one half of the face that names something of the other half, since then
 * sums of poses are not exact. */
static void check_part(checking *c, const rig_pose *pose, const rig_pose_part *part,
                       const char *path)
{
    const char *other = NULL;
    for (uint32_t i = 0; i < pose->pull_count && !other; ++i)
        if (part[pose->pull_contact[i]] != pose->part)
            other = c->r->contact[pose->pull_contact[i]].name;
    for (uint32_t i = 0; i < pose->dof_count && !other; ++i)
        if (rig_poses_dof_part(pose->dof_name[i]) != pose->part)
            other = pose->dof_name[i];
    if (other)
        report(c, RIG_WARNING, path,
               "\"%s\" does not belong to the part \"%s\": poses of the two halves then influence "
               "each other; remove it, or remove \"part\"",
               other, rig_pose_part_name[pose->part]);
}

static void check_parts(checking *c)
{
    const uint32_t count = c->r->contact_count;
    vec3 *at = calloc(count + (size_t)1, sizeof *at);
    rig_pose_part *part = calloc(count + (size_t)1, sizeof *part);
    c->is_out_of_memory = c->is_out_of_memory || !at || !part;
    for (uint32_t i = 0; at && i < count; ++i)
        if (c->r->contact[i].vertex < c->m->vertex_count)
            at[i] = mesh_position(c->m, c->r->contact[i].vertex);
    if (at && part)
        rig_poses_contact_parts(part, c->r, at);
    for (uint32_t i = 0; at && part && i < c->r->pose_count; ++i) {
        json_path path = rig_entry_path(c->r, RIG_POSES, i);
        if (c->r->pose[i].part != POSE_WHOLE)
            check_part(c, &c->r->pose[i], part, path.text);
    }
    free(at);
    free(part);
}

static void check_mouth(checking *c)
{
    char fault[BIND_FAULT];
    c->is_out_of_memory = c->is_out_of_memory || bind_lips_fault(fault, c->r, c->m, c->t, NULL) < 0;
    if (!c->is_out_of_memory && fault[0])
        report(c, RIG_WARNING, "$.mouth",
               "%s; the face can be performed, but its lips cannot be sealed", fault);
}

static void check_poses(checking *c)
{
    double head_mm = c->head ? c->head->top_y - c->head->chin.y : 225.0;
    for (uint32_t i = 0; i < c->r->pose_count; ++i) {
        json_path path = rig_entry_path(c->r, RIG_POSES, i);
        check_pulls(c, &c->r->pose[i], path.text, head_mm);
        check_turns(c, &c->r->pose[i], path.text);
    }
    check_parts(c);
}

/* ---- poses as performed ---- */

static const double lips_mm = 12.0; /* distance from a contact of the lips */

/* Returns for each vertex of the file: 1 for skin, 2 for skin of the lips, else 0. */
static uint8_t *find_skin(const checking *c)
{
    uint8_t *out = calloc((size_t)c->m->vertex_count + 1, sizeof *out);
    for (uint32_t v = 0; out && v < c->m->vertex_count; ++v)
        out[v] = c->binding->mobility[v] > 0.0f;
    for (uint32_t i = 0; out && i < c->r->contact_count; ++i) {
        const char *name = c->r->contact[i].name;
        if (strncmp(name, "lip.", 4) != 0 && strncmp(name, "mouth.", 6) != 0)
            continue;
        const vec3 at = mesh_position(c->m, c->r->contact[i].vertex);
        for (uint32_t v = 0; v < c->m->vertex_count; ++v)
            if (out[v] && vec3_length(vec3_sub(mesh_position(c->m, v), at)) <= lips_mm)
                out[v] = 2;
    }
    return out;
}

/* Measures how far vertices are apart in a and b, in mm, at most: over all skin, and over the lips
 * alone. */
static void measure_apart(double out_mm[2], const checking *c, const uint8_t *skin, const float *a,
                          const float *b)
{
    out_mm[0] = out_mm[1] = 0.0;
    for (size_t v = 0; v < c->m->vertex_count; ++v) {
        const vec3 way = {(double)(a[3 * v] - b[3 * v]), (double)(a[3 * v + 1] - b[3 * v + 1]),
                          (double)(a[3 * v + 2] - b[3 * v + 2])};
        const double mm = skin[v] ? vec3_length(way) : 0.0;
        out_mm[0] = fmax(out_mm[0], mm);
        out_mm[1] = skin[v] == 2 ? fmax(out_mm[1], mm) : out_mm[1];
    }
}

typedef struct comparing {
    checking *c;
    rig_poses_stage *stage;
    uint8_t *skin;
    float *asked; /* vertex_count by 3: the pose without any limit */
    double worst_mm[2];
    uint32_t worst[2]; /* indices of poses */
} comparing;

/* Compares a pose with the limits of the rig and without them. The limits hold back skin that
 * would fold. */
static mrt_result compare_performed(comparing *k, uint32_t pose, error *err)
{
    static const double most_mm = 0.5;
    double apart_mm[2];
    csrbf_settings solver = k->stage->solver;
    solver.stretch_most = k->c->r->solver.stretch_most;
    mrt_result result = rig_poses_show_on(k->stage->face, &k->stage->rig, pose, &solver, err);
    if (result < 0)
        return result;
    points_to_rows(k->stage->position, face_shown(k->stage->face), face_order(k->stage->face));
    measure_apart(apart_mm, k->c, k->skin, k->asked, k->stage->position);
    json_path path = rig_entry_path(k->c->r, RIG_POSES, pose);
    if (apart_mm[0] > most_mm)
        report(k->c, RIG_WARNING, path.text,
               "\"%s\" is held back by up to %.2f mm (lips %.2f mm), because the skin would fold "
               "or tear; pull by less, or also pull the contacts beside it",
               k->c->r->pose[pose].name, apart_mm[0], apart_mm[1]);
    return MRT_OK;
}

static mrt_result compare_named(comparing *k, uint32_t pose, error *err)
{
    double apart_mm[2];
    mrt_result result = rig_poses_show_named(k->stage, pose, err);
    if (result < 0)
        return result;
    measure_apart(apart_mm, k->c, k->skin, k->asked, k->stage->position);
    for (int i = 0; i < 2; ++i)
        if (apart_mm[i] > k->worst_mm[i]) {
            k->worst_mm[i] = apart_mm[i];
            k->worst[i] = pose;
        }
    return MRT_OK;
}

static mrt_result compare_poses(comparing *k, error *err)
{
    const rig *r = k->c->r;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < r->pose_count && result >= 0; ++i) {
        result = rig_poses_show(k->stage, i, err);
        memcpy(k->asked, k->stage->position, (size_t)3 * k->c->m->vertex_count * sizeof *k->asked);
        if (result >= 0)
            result = compare_performed(k, i, err);
        if (result >= 0)
            result = compare_named(k, i, err);
    }
    if (result >= 0)
        report(k->c, RIG_NOTE, "$.poses",
               "poses hold all %u contacts. With only the named ones held, the skin differs by at "
               "most %.2f mm (\"%s\"), the lips by %.2f mm (\"%s\")",
               r->contact_count, k->worst_mm[0], r->pose[k->worst[0]].name, k->worst_mm[1],
               r->pose[k->worst[1]].name);
    return result;
}

mrt_result rig_check_poses(rig_findings *out, const rig *r, const mesh *m, const topology *t,
                           const binding *b, error *err)
{
    checking c = {.r = r, .m = m, .t = t, .binding = b, .out = out};
    rig_poses_stage stage;
    if (r->pose_count == 0 || r->contact_count == 0)
        return MRT_OK;
    if (r->contact_count > MRT_MAX_VECTORS) {
        report(&c, RIG_NOTE, "$.contacts",
               "the rig has %u contacts, but at most %d can be held together: a pose holds only "
               "the contacts that it names",
               r->contact_count, MRT_MAX_VECTORS);
        return MRT_OK;
    }
    mrt_result result = rig_poses_stage_init(&stage, r, m, t, err);
    if (result < 0)
        return result;
    comparing k = {.c = &c, .stage = &stage, .skin = find_skin(&c)};
    k.asked = malloc((size_t)3 * m->vertex_count * sizeof *k.asked + 1);
    result = k.skin && k.asked && !c.is_out_of_memory
                 ? compare_poses(&k, err)
                 : error_set(err, MRT_ERR_MEMORY, "no memory to check the rig");
    free(k.skin);
    free(k.asked);
    rig_poses_stage_finish(&stage);
    sort_by_severity(out);
    return result;
}

/* ---- errors that make a rig unusable ---- */

mrt_result rig_validate(const rig *r, const mesh *m, const topology *t, error *err)
{
    bind_marks marks;
    mrt_result result = bind_marks_create(&marks, r, m, t, err);
    if (result < 0)
        return result;
    result = check_hinge(r, err);
    if (result >= 0)
        result = check_seams(r, m, &marks, NULL, err);
    bind_marks_destroy(&marks);
    return result;
}

/* ---- everything ---- */

static void note_lines(checking *c, const char *note)
{
    while (note && *note) {
        size_t length = strcspn(note, "\n");
        const char *colon = strstr(note, ": ");
        if (note[0] == '$' && colon && (size_t)(colon - note) < length) {
            char path[128];
            (void)snprintf(path, sizeof path, "%.*s", (int)(colon - note), note);
            report(c, RIG_NOTE, path, "%.*s", (int)(length - (size_t)(colon + 2 - note)),
                   colon + 2);
        } else {
            report(c, RIG_NOTE, "$", "%.*s", (int)length, note);
        }
        note += length + (note[length] == '\n');
    }
}

static void check_unusable(checking *c, bind_marks *marks)
{
    error err = {""};
    if (bind_marks_create(marks, c->r, c->m, c->t, &err) < 0)
        find_error(c, &err);
    else
        c->marks = marks;
    if (check_hinge(c->r, &err) < 0)
        find_error(c, &err);
    if (c->marks && check_seams(c->r, c->m, c->marks, c->binding, &err) < 0)
        find_error(c, &err);
}

mrt_result rig_check(rig_findings *out, const rig *r, const mesh *m, const topology *t,
                     const binding *b, error *err)
{
    bind_marks marks = {0};
    rig_anatomy anatomy = {0};
    *out = (rig_findings){0};
    checking c = {.r = r, .m = m, .t = t, .binding = b, .out = out};
    c.radius_mm = r->solver.radius > 0.0 ? r->solver.radius : 0.25 * height_of(m);
    if (rig_anatomy_find(&anatomy, m, t, NULL) >= 0 && anatomy.has_face)
        c.head = &anatomy.head;
    check_unusable(&c, &marks);
    check_size(&c);
    check_mesh_hash(&c);
    check_symmetry(&c);
    check_surface(&c);
    if (c.marks)
        check_contacts(&c);
    check_jaw(&c);
    check_springs(&c);
    check_mouth(&c);
    check_poses(&c);
    if (!c.marks)
        report(&c, RIG_NOTE, "$.regions",
               "contacts and parts are checked after the errors are corrected");
    note_lines(&c, r->note);
    bind_marks_destroy(&marks);
    rig_anatomy_finish(&anatomy);
    sort_by_severity(out);
    return c.is_out_of_memory ? error_set(err, MRT_ERR_MEMORY, "no memory to check the rig")
                              : MRT_OK;
}
