/* Finds the rims of a mouth. Planes x = c cut the face into columns. In each column the surface is
 * a line, which is followed from the upper lip to the lower one. A slit is a pocket of that line: a
 * long way between two places that are close together. The neck of the pocket is the pair (i, j)
 * with the greatest
 *   way(i, j) - steep |p_i - p_j|.
 * There the lips face each other. If they are apart, it is the lowest line of the upper lip and the
 * highest of the lower one. If they touch, it is the foremost line. Columns go outwards from the
 * middle of the mouth until the pocket ends in the corners. If the surface ends at the lips, as in
 * a mouth without a bag, the way across the hole counts as long. The rims are the chains of edges
 * that follow the necks most closely, from corner to corner. */
#include "face/rig/rig_rims.h"

#include "base/arrays.h"
#include "mesh/position.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 256, WAY_MAX = 3000, BISECTIONS = 8 };

/* The second value is for the corners, where lips part at a wider angle. */
static const double steep[] = {6.0, 3.0};
static const double column_step = 0.012; /* of the half width of the face */
/* Shares of the reach, the height from the nose down to the chin: */
static const double way_step = 0.006;     /* greatest distance between two points of a way */
static const double lip_height = 0.05;    /* start of a column beyond the crests of the lips */
static const double hole_way = 0.3;       /* length of the way across a hole */
static const double pocket_least = 0.06;  /* least size of the greatest pocket of a slit */
static const double corner_pocket = 0.01; /* pocket size below which a pocket ends */
static const double jump_most = 0.05;     /* greatest jump from one column to the next */
static const double width_least = 0.12;   /* of the half width: least width of a slit */
static const double path_width = 0.02;    /* of the slit's width: how closely chains follow necks */
static const double off_most =
    0.10; /* of the slit's width: greatest distance of a rim from its necks */
static const double corner_near =
    0.12; /* of the slit's width: greatest distance of a corner's vertex */

typedef struct crossing { /* point where a plane cuts an edge of the surface, or near it */
    uint32_t point[2];
    double y, z;
} crossing;

typedef struct segment { /* part of a triangle in the plane */
    crossing end[2];
    uint32_t next[2]; /* segment on the other side of that edge; RIG_NONE for a border */
} segment;

typedef struct edge_end { /* end of a segment, for sorting by edge */
    uint32_t point[2], segment, end;
} edge_end;

typedef struct neck {
    double x, pocket;
    crossing upper, lower;
} neck;

typedef struct finding {
    const rig_anatomy *a;
    const mesh *m;
    const topology *t;
    char *why_not;
    double reach_mm, half_mm;           /* half_mm: half the width of the face */
    uint32_t *triangle, triangle_count; /* triangles around the mouth */
    segment *segment;
    edge_end *end;
    uint32_t segment_count;
    crossing *way;
    double *way_mm;
    neck *neck; /* from right to left */
    uint32_t neck_count;
    double width_mm;
    double *off[2]; /* vertex_count: distance along the surface from the upper and lower ends of the
                       necks */
    double *cost;
    uint32_t *before, *heap, *place;
    arrays arrays; /* owner of the arrays above */
} finding;

__attribute__((format(printf, 2, 3))) static bool refuse(finding *f, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vsnprintf(f->why_not, BIND_FAULT, format, args);
    va_end(args);
    return false;
}

/* ---- columns ---- */

static bool allocate(finding *f)
{
    arrays *a = &f->arrays;
    const size_t vertices = f->m->vertex_count, triangles = f->m->triangle_count;
    f->triangle = arrays_add(a, triangles, sizeof *f->triangle);
    f->segment = arrays_add(a, triangles, sizeof *f->segment);
    f->end = arrays_add(a, 2 * triangles, sizeof *f->end);
    f->way = arrays_add(a, WAY_MAX, sizeof *f->way);
    f->way_mm = arrays_add(a, WAY_MAX, sizeof *f->way_mm);
    f->neck = arrays_add(a, COLUMNS_MAX, sizeof *f->neck);
    for (int lip = 0; lip < 2; ++lip)
        f->off[lip] = arrays_add(a, vertices, sizeof *f->off[lip]);
    f->cost = arrays_add(a, vertices, sizeof *f->cost);
    f->before = arrays_add(a, vertices, sizeof *f->before);
    f->heap = arrays_add(a, vertices, sizeof *f->heap);
    f->place = arrays_add(a, vertices, sizeof *f->place);
    return !a->failed;
}

static void choose_triangles(finding *f)
{
    const rig_head *head = &f->a->head;
    for (uint32_t i = 0; i < f->m->triangle_count; ++i) {
        const uint32_t *corner = f->m->triangle + (size_t)i * 3;
        bool is_near = false, is_face = true;
        for (int k = 0; k < 3; ++k) {
            vec3 p = mesh_position(f->m, corner[k]);
            is_face = is_face && f->a->is_face[corner[k]];
            is_near = is_near || (fabs(p.x - head->middle_x) < 1.3 * f->half_mm &&
                                  p.y < head->nose.y && p.y > head->chin.y - 0.3 * f->reach_mm &&
                                  p.z > head->back_z + 0.25 * (head->nose.z - head->back_z));
        }
        if (is_near && is_face)
            f->triangle[f->triangle_count++] = i;
    }
}

static crossing cross(const mesh *m, uint32_t a, uint32_t b, double x)
{
    uint32_t low = mesh_point(m, a), high = mesh_point(m, b);
    if (low > high) {
        uint32_t kept = low;
        low = high;
        high = kept;
    }
    vec3 p = mesh_position(m, low), q = mesh_position(m, high);
    double t = p.x != q.x ? (x - p.x) / (q.x - p.x) : 0.0;
    return (crossing){{low, high}, p.y + t * (q.y - p.y), p.z + t * (q.z - p.z)};
}

static int compare_ends(const void *a, const void *b)
{
    const edge_end *p = a, *q = b;
    for (int i = 0; i < 2; ++i)
        if (p->point[i] != q->point[i])
            return p->point[i] < q->point[i] ? -1 : 1;
    return p->segment < q->segment ? -1 : p->segment > q->segment;
}

static void link_segments(finding *f)
{
    const uint32_t count = 2 * f->segment_count;
    qsort(f->end, count, sizeof *f->end, compare_ends);
    for (uint32_t i = 0; i < count; ++i) {
        edge_end *p = &f->end[i], *q = p + 1;
        if (i + 1 == count || p->point[0] != q->point[0] || p->point[1] != q->point[1])
            continue;
        f->segment[p->segment].next[p->end] = q->segment;
        f->segment[q->segment].next[q->end] = p->segment;
        i += 1;
    }
}

static void cut_column(finding *f, double x)
{
    f->segment_count = 0;
    for (uint32_t i = 0; i < f->triangle_count; ++i) {
        const uint32_t *corner = f->m->triangle + (size_t)f->triangle[i] * 3;
        segment s = {.next = {RIG_NONE, RIG_NONE}};
        int count = 0;
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = corner[k], b = corner[(k + 1) % 3];
            if ((mesh_position(f->m, a).x >= x) != (mesh_position(f->m, b).x >= x))
                s.end[count++] = cross(f->m, a, b, x);
        }
        if (count != 2)
            continue;
        for (uint32_t k = 0; k < 2; ++k)
            f->end[2 * f->segment_count + k] =
                (edge_end){{s.end[k].point[0], s.end[k].point[1]}, f->segment_count, k};
        f->segment[f->segment_count++] = s;
    }
    link_segments(f);
}

/* Returns the foremost segment at a height, or RIG_NONE. */
static uint32_t segment_in_front(const finding *f, double y)
{
    uint32_t best = RIG_NONE;
    double front = -(double)INFINITY;
    for (uint32_t i = 0; i < f->segment_count; ++i) {
        const crossing *p = &f->segment[i].end[0], *q = &f->segment[i].end[1];
        if ((p->y > y) == (q->y > y))
            continue;
        double z = p->z + (q->z - p->z) * (y - p->y) / (q->y - p->y);
        if (z > front) {
            front = z;
            best = i;
        }
    }
    return best;
}

static bool is_same_edge(const crossing *a, const crossing *b)
{
    return a->point[0] == b->point[0] && a->point[1] == b->point[1];
}

static double apart(const crossing *a, const crossing *b)
{
    const double y = a->y - b->y, z = a->z - b->z;
    return sqrt(y * y + z * z);
}

/* Appends points along a segment, without its first end. Returns their number. */
static uint32_t add_points(crossing *out, uint32_t room, const finding *f, const crossing *from,
                           const crossing *to)
{
    const double steps = ceil(apart(from, to) / (way_step * f->reach_mm));
    const uint32_t count = !(steps > 1.0) ? 1 : steps < (double)room ? (uint32_t)steps : room;
    for (uint32_t i = 1; i <= count; ++i) {
        const double t = (double)i / count;
        out[i - 1] = t < 0.5 ? *from : *to;
        out[i - 1].y = from->y + t * (to->y - from->y);
        out[i - 1].z = from->z + t * (to->z - from->z);
    }
    return count;
}

/* Appends the way that starts at a segment and leaves it downwards (-1) or upwards (1), up to the
 * segment `to`. Returns the number of points; *out_is_there: `to` was reached. */
static uint32_t walk(crossing *out, uint32_t room, bool *out_is_there, const finding *f,
                     uint32_t from, double sign, uint32_t to)
{
    const segment *s = &f->segment[from];
    uint32_t count = 0, at = from;
    uint32_t end = sign * (s->end[1].y - s->end[0].y) > 0.0 ? 1 : 0;
    *out_is_there = false;
    while (count < room) {
        const crossing *left = &f->segment[at].end[end];
        count += add_points(out + count, room - count, f, &f->segment[at].end[1 - end], left);
        uint32_t next = f->segment[at].next[end];
        if (next == RIG_NONE || next == from)
            return count;
        if (next == to) {
            *out_is_there = true;
            return count;
        }
        end = is_same_edge(&f->segment[next].end[0], left) ? 1 : 0;
        at = next;
    }
    return count;
}

/* Follows the surface from one lip to the other. Returns the number of points, or 0 if no line
 * leads there. *out_hole: the way crosses a hole after that point; RIG_NONE if it crosses none. */
static uint32_t find_way(finding *f, double upper_y, double lower_y, uint32_t *out_hole)
{
    uint32_t above = segment_in_front(f, upper_y), below = segment_in_front(f, lower_y);
    bool is_there;
    *out_hole = RIG_NONE;
    if (above == RIG_NONE || below == RIG_NONE || above == below)
        return 0;
    uint32_t down = walk(f->way, WAY_MAX / 2, &is_there, f, above, -1.0, below);
    if (is_there)
        return down;
    uint32_t up = walk(f->way + down, WAY_MAX / 2, &is_there, f, below, 1.0, above);
    if (down >= WAY_MAX / 2 || up >= WAY_MAX / 2)
        return 0;
    for (uint32_t i = 0; i < up / 2; ++i) {
        crossing kept = f->way[down + i];
        f->way[down + i] = f->way[down + up - 1 - i];
        f->way[down + up - 1 - i] = kept;
    }
    *out_hole = down - 1;
    return down + up;
}

/* Sets the neck of the pocket in the way. Its pocket is 0 if there is none. */
static void find_pair(neck *out, const finding *f, uint32_t count, double x, double steepness)
{
    *out = (neck){.x = x};
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t j = i + 1; j < count; ++j) {
            double way = f->way_mm[j] - f->way_mm[i];
            if (way <= out->pocket)
                continue;
            double pocket = way - steepness * apart(&f->way[i], &f->way[j]);
            if (pocket > out->pocket) {
                out->pocket = pocket;
                out->upper = f->way[i];
                out->lower = f->way[j];
            }
        }
}

/* Finds the neck of the column at x, between two heights. Returns false if no pocket is larger than
 * `least_mm`. */
static bool find_neck(neck *out, finding *f, double x, double upper_y, double lower_y,
                      double least_mm)
{
    uint32_t hole;
    cut_column(f, x);
    const uint32_t count = find_way(f, upper_y, lower_y, &hole);
    f->way_mm[0] = 0.0;
    for (uint32_t i = 1; i < count; ++i) {
        double step = apart(&f->way[i], &f->way[i - 1]);
        if (hole == i - 1)
            step = hole_way * f->reach_mm + steep[0] * step;
        f->way_mm[i] = f->way_mm[i - 1] + step;
    }
    for (size_t k = 0; k < sizeof steep / sizeof *steep; ++k) {
        find_pair(out, f, count, x, steep[k]);
        if (out->pocket > least_mm)
            return true;
    }
    return false;
}

/* ---- outwards from the middle ---- */

static double height_of(const neck *n)
{
    return 0.5 * (n->upper.y + n->lower.y);
}

typedef struct heights { /* begin and end of columns, above and below the last neck */
    double above, below;
} heights;

static heights heights_of(const finding *f)
{
    const rig_head *head = &f->a->head;
    return (heights){fmax(head->lip_upper_y - head->mouth_y, 0.0) + lip_height * f->reach_mm,
                     fmax(head->mouth_y - head->lip_lower_y, 0.0) + lip_height * f->reach_mm};
}

/* Finds the neck next to another one, if the slit continues there. */
static bool find_next(neck *out, finding *f, double x, const neck *from)
{
    const heights h = heights_of(f);
    const double jump_mm = jump_most * f->reach_mm;
    return find_neck(out, f, x, height_of(from) + h.above, height_of(from) - h.below,
                     corner_pocket * f->reach_mm) &&
           apart(&out->upper, &from->upper) < jump_mm && apart(&out->lower, &from->lower) < jump_mm;
}

static bool find_first(neck *out, finding *f)
{
    const rig_head *head = &f->a->head;
    const heights h = heights_of(f);
    static const double beside[] = {0.0, 0.04, -0.04, 0.08, -0.08};
    for (size_t i = 0; i < sizeof beside / sizeof *beside; ++i)
        if (find_neck(out, f, head->middle_x + (beside[i] + 1e-4) * f->half_mm,
                      head->mouth_y + h.above, head->mouth_y - h.below, pocket_least * f->reach_mm))
            return true;
    return refuse(f, "the surface is closed between the upper lip and the lower one");
}

/* Appends necks from `first` outwards to the corner. Returns their number. */
static uint32_t follow_slit(neck *out, uint32_t room, finding *f, const neck *first, double sign)
{
    const double step_mm = column_step * f->half_mm;
    const neck *last = first;
    uint32_t count = 0;
    double gone = 0.0;
    while (count + 1 < room) {
        if (!find_next(&out[count], f, last->x + sign * step_mm, last)) {
            gone = last->x + sign * step_mm;
            break;
        }
        last = &out[count++];
    }
    double there = last->x;
    for (int i = 0; i < BISECTIONS && count + 1 < room; ++i) {
        neck tried;
        double x = 0.5 * (there + gone);
        if (find_next(&tried, f, x, last)) {
            there = x;
            out[count] = tried;
        } else
            gone = x;
    }
    return count + (there != last->x);
}

static bool find_necks(finding *f)
{
    const rig_head *head = &f->a->head;
    neck first;
    if (!find_first(&first, f))
        return false;
    uint32_t right = follow_slit(f->neck, COLUMNS_MAX / 2 - 1, f, &first, -1.0);
    for (uint32_t i = 0; i < right / 2; ++i) {
        neck kept = f->neck[i];
        f->neck[i] = f->neck[right - 1 - i];
        f->neck[right - 1 - i] = kept;
    }
    f->neck[right] = first;
    uint32_t left = follow_slit(f->neck + right + 1, COLUMNS_MAX / 2 - 1, f, &first, 1.0);
    f->neck_count = right + 1 + left;
    f->width_mm = f->neck[f->neck_count - 1].x - f->neck[0].x;
    if (f->width_mm < width_least * f->half_mm)
        return refuse(f, "the slit between the lips is only %.1f mm wide", f->width_mm);
    if (f->neck[0].x > head->middle_x || f->neck[f->neck_count - 1].x < head->middle_x)
        return refuse(f, "the slit between the lips is on one side of the face");
    return true;
}

/* ---- chains of edges ---- */

static vec3 position_of(const crossing *c, double x)
{
    return (vec3){x, c->y, c->z};
}

static bool measure_off(finding *f, int lip)
{
    bind_start *start = calloc((size_t)2 * f->neck_count, sizeof *start);
    for (uint32_t i = 0; start && i < f->neck_count; ++i) {
        const neck *n = &f->neck[i];
        const crossing *c = lip == 0 ? &n->upper : &n->lower;
        for (uint32_t k = 0; k < 2; ++k) {
            vec3 apart = vec3_sub(mesh_position(f->m, c->point[k]), position_of(c, n->x));
            start[2 * i + k] = (bind_start){c->point[k], vec3_length(apart)};
        }
    }
    bool is_done = start && bind_distances(f->off[lip], start, 2 * f->neck_count, 2.0 * f->width_mm,
                                           f->m, f->t);
    free(start);
    return is_done;
}

/* Finds the vertex where both lips meet, at the end of the necks. */
static uint32_t find_corner(const finding *f, const neck *at)
{
    const vec3 upper = position_of(&at->upper, at->x), lower = position_of(&at->lower, at->x);
    const vec3 middle = vec3_scale(vec3_add(upper, lower), 0.5);
    uint32_t best = RIG_NONE;
    double least = (double)INFINITY;
    for (uint32_t v = 0; v < f->m->vertex_count; ++v) {
        if (mesh_point(f->m, v) != v || !f->a->is_face[v])
            continue;
        double mm = vec3_length(vec3_sub(mesh_position(f->m, v), middle));
        double upper_mm = f->off[0][v], lower_mm = f->off[1][v];
        double far = upper_mm + lower_mm + 0.5 * fabs(upper_mm - lower_mm) + 2.0 * mm;
        if (mm < corner_near * f->width_mm && far < least) {
            least = far;
            best = v;
        }
    }
    return best;
}

static double edge_cost(const finding *f, int lip, uint32_t a, uint32_t b)
{
    double off = (f->off[lip][a] + f->off[lip][b]) / (path_width * f->width_mm);
    return vec3_length(vec3_sub(mesh_position(f->m, a), mesh_position(f->m, b))) *
           (1.0 + off * off);
}

/* A binary heap of points by their cost. place: 1 + index in the heap; 0 if not in it. */
static void heap_move(finding *f, uint32_t at, uint32_t point)
{
    f->heap[at] = point;
    f->place[point] = at + 1;
}

static void heap_rise(finding *f, uint32_t at)
{
    const uint32_t point = f->heap[at];
    while (at > 0 && f->cost[f->heap[(at - 1) / 2]] > f->cost[point]) {
        heap_move(f, at, f->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    heap_move(f, at, point);
}

static uint32_t heap_pop(finding *f, uint32_t *count)
{
    const uint32_t first = f->heap[0], last = f->heap[--*count];
    uint32_t at = 0;
    f->place[first] = 0;
    while (2 * at + 1 < *count) {
        uint32_t child = 2 * at + 1;
        if (child + 1 < *count && f->cost[f->heap[child + 1]] < f->cost[f->heap[child]])
            child += 1;
        if (f->cost[f->heap[child]] >= f->cost[last])
            break;
        heap_move(f, at, f->heap[child]);
        at = child;
    }
    if (*count > 0)
        heap_move(f, at, last);
    return first;
}

static bool is_in_corner(const finding *f, uint32_t point)
{
    const double x = mesh_position(f->m, point).x, near_mm = corner_near * f->width_mm;
    return x < f->neck[0].x + near_mm || x > f->neck[f->neck_count - 1].x - near_mm;
}

/* In the corners both lips are the same. */
static bool is_of_lip(const finding *f, int lip, uint32_t point)
{
    return f->off[lip][point] <= f->off[1 - lip][point] || is_in_corner(f, point);
}

/* Finds the shortest path from one corner to the other along one lip (Dijkstra). Writes it
 * backwards from `to`. Returns the number of points, or 0 if there is no path. */
static uint32_t find_chain(uint32_t *out, finding *f, int lip, uint32_t from, uint32_t to)
{
    uint32_t count = 0, length = 0;
    for (uint32_t v = 0; v < f->m->vertex_count; ++v) {
        f->cost[v] = (double)INFINITY;
        f->before[v] = RIG_NONE;
        f->place[v] = 0;
    }
    f->cost[from] = 0.0;
    heap_move(f, count++, from);
    while (count > 0) {
        const uint32_t at = heap_pop(f, &count);
        if (at == to)
            break;
        for (uint32_t k = f->t->neighbour_start[at]; k < f->t->neighbour_start[at + 1]; ++k) {
            const uint32_t next = f->t->neighbour[k];
            if (next != to && !is_of_lip(f, lip, next))
                continue;
            const double through = f->cost[at] + edge_cost(f, lip, at, next);
            if (!(through < f->cost[next]))
                continue;
            f->cost[next] = through;
            f->before[next] = at;
            if (f->place[next] == 0)
                heap_move(f, count++, next);
            heap_rise(f, f->place[next] - 1);
        }
    }
    if (!isfinite(f->cost[to]))
        return 0;
    for (uint32_t v = to; v != RIG_NONE && length < RIG_RIM_MOST; v = f->before[v])
        out[length++] = v;
    return length;
}

static mrt_result find_rims(rig_mouth *out, finding *f, error *err)
{
    static const char *const lip_name[] = {"upper", "lower"};
    uint32_t **const rim[] = {&out->upper, &out->lower};
    uint32_t *const count[] = {&out->upper_count, &out->lower_count};
    if (!measure_off(f, 0) || !measure_off(f, 1))
        return error_set(err, MRT_ERR_MEMORY, "no memory for the rims of the mouth");
    const uint32_t right = find_corner(f, &f->neck[0]);
    const uint32_t left = find_corner(f, &f->neck[f->neck_count - 1]);
    if (right == RIG_NONE || left == RIG_NONE || right == left) {
        (void)refuse(f, "the mesh has no vertices at the corners of the slit between the lips");
        return MRT_OK;
    }
    for (int lip = 0; lip < 2; ++lip) {
        *rim[lip] = malloc(RIG_RIM_MOST * sizeof **rim[lip]);
        if (!*rim[lip])
            return error_set(err, MRT_ERR_MEMORY, "no memory for the rims of the mouth");
        *count[lip] = find_chain(*rim[lip], f, lip, left, right);
        double off_mm = 0.0;
        for (uint32_t i = 0; i < *count[lip]; ++i)
            if (!is_in_corner(f, (*rim[lip])[i]))
                off_mm = fmax(off_mm, f->off[lip][(*rim[lip])[i]]);
        if (*count[lip] < RIG_RIM_LEAST || *count[lip] == RIG_RIM_MOST ||
            off_mm > off_most * f->width_mm) {
            (void)refuse(
                f, "the mesh is too coarse at the %s lip: its edges do not follow the lip closely",
                lip_name[lip]);
            return MRT_OK;
        }
    }
    return MRT_OK;
}

mrt_result rig_rims_find(rig_mouth *out, char why_not[BIND_FAULT], const rig_anatomy *a,
                         const mesh *m, const topology *t, error *err)
{
    finding f = {.a = a,
                 .m = m,
                 .t = t,
                 .why_not = why_not,
                 .reach_mm = a->head.nose.y - a->head.chin.y,
                 .half_mm = a->head.half_width};
    mrt_result result = MRT_OK;
    *out = (rig_mouth){.upper_share = RIG_UPPER_SHARE};
    why_not[0] = '\0';
    if (!allocate(&f))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the rims of the mouth");
    if (result >= 0) {
        choose_triangles(&f);
        if (find_necks(&f))
            result = find_rims(out, &f, err);
    }
    arrays_free(&f.arrays);
    if (result >= 0 && !why_not[0])
        return MRT_OK;
    free(out->upper);
    free(out->lower);
    *out = (rig_mouth){0};
    return result;
}

/* Returns the other point at the same place: the one on the lower lip, stored after the vertices of
 * the file. */
static uint32_t twin_of(const mesh *m, uint32_t point)
{
    for (uint32_t v = m->vertex_count; v-- > point + 1;)
        if (mesh_point(m, v) == v &&
            memcmp(m->position + 3 * (size_t)v, m->position + 3 * (size_t)point,
                   3 * sizeof *m->position) == 0)
            return v;
    return point;
}

mrt_result rig_rims_of_cut(rig_mouth *out, const uint32_t *chain, uint32_t count, const mesh *m,
                           error *err)
{
    *out = (rig_mouth){.upper = malloc(count * sizeof *out->upper),
                       .lower = malloc(count * sizeof *out->lower),
                       .upper_count = count,
                       .lower_count = count,
                       .upper_share = RIG_UPPER_SHARE};
    if (!out->upper || !out->lower) {
        free(out->upper);
        free(out->lower);
        *out = (rig_mouth){0};
        return error_set(err, MRT_ERR_MEMORY, "no memory for the rims of the mouth");
    }
    const bool is_turned = mesh_position(m, chain[0]).x > mesh_position(m, chain[count - 1]).x;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t point = mesh_point(m, chain[is_turned ? count - 1 - i : i]);
        out->upper[i] = point;
        out->lower[i] = i == 0 || i == count - 1 ? point : twin_of(m, point);
    }
    return MRT_OK;
}
