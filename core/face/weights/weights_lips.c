#include "face/weights/weights_lips.h"
#include "mesh/position.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double ends_apart =
    0.06; /* of the width: greatest distance between the ends of the rims */
static const double straight_least =
    0.3; /* least width over the length of a rim; below it is a ring */
static const double crossed_most =
    0.04;                        /* of the width: greatest depth of the upper rim below the lower */
static const double reach = 1.5; /* of the width: reach of the lips along the surface */
static const double end_density = 0.6; /* stations are 1 - this as far apart at the corners */
static const double side_begins = 0.2, side_ends = 0.8;

typedef struct rim {
    const char *key;
    const uint32_t *vertex;
    uint32_t count;
} rim;

__attribute__((format(printf, 2, 3))) static bool refuse(bind_lips *out, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vsnprintf(out->why_not, sizeof out->why_not, format, args);
    va_end(args);
    return false;
}

static vec3 at_vertex(const mesh *m, const rim *of, uint32_t i)
{
    return mesh_position(m, of->vertex[i]);
}

/* ---- checks of the rims ---- */

static bool check_vertices(bind_lips *out, const rim *of, const mesh *m)
{
    for (uint32_t i = 0; i < of->count; ++i)
        if (of->vertex[i] >= m->vertex_count)
            return refuse(out, "%s[%u]: vertex %u does not exist, the mesh has %u vertices",
                          of->key, i, of->vertex[i], m->vertex_count);
    return true;
}

/* Checks that each point occurs once. The rims may share their ends. */
static bool check_doubled(bind_lips *out, const rim *a, const rim *b, const mesh *m)
{
    for (uint32_t i = 0; i < a->count; ++i)
        for (uint32_t j = a == b ? i + 1 : 0; j < b->count; ++j) {
            bool is_end =
                a != b && ((i == 0 && j == 0) || (i == a->count - 1 && j == b->count - 1));
            if (!is_end && mesh_point(m, a->vertex[i]) == mesh_point(m, b->vertex[j]))
                return refuse(out,
                              "%s[%u] and %s[%u] are the same point; a rim must lead once from "
                              "corner to corner",
                              a->key, i, b->key, j);
        }
    return true;
}

static mrt_result check_piece(bind_lips *out, const rim *of, const rim *upper, const mesh *m,
                              const topology *t, bool *out_is_good, error *err)
{
    uint32_t *piece = malloc(((size_t)m->vertex_count + 1) * sizeof *piece), count;
    mrt_result result = piece ? topology_pieces(piece, &count, m, t, err)
                              : error_set(err, MRT_ERR_MEMORY, "no memory for the mouth");
    for (uint32_t i = 0; result >= 0 && *out_is_good && i < of->count; ++i)
        if (piece[of->vertex[i]] != piece[upper->vertex[0]])
            *out_is_good = refuse(out,
                                  "%s[%u]: vertex %u is on another piece of surface than upper[0]; "
                                  "both rims must be on one piece",
                                  of->key, i, of->vertex[i]);
    free(piece);
    return result;
}

static double length_of(const mesh *m, const rim *of)
{
    double sum = 0.0;
    for (uint32_t i = 1; i < of->count; ++i)
        sum += vec3_length(vec3_sub(at_vertex(m, of, i), at_vertex(m, of, i - 1)));
    return sum;
}

/* Sets across, up and width_mm. */
static bool find_axes(bind_lips *out, const rim *upper, const rim *lower, const mesh *m)
{
    vec3 right = vec3_scale(vec3_add(at_vertex(m, upper, 0), at_vertex(m, lower, 0)), 0.5);
    vec3 left = vec3_scale(
        vec3_add(at_vertex(m, upper, upper->count - 1), at_vertex(m, lower, lower->count - 1)),
        0.5);
    vec3 way = vec3_sub(left, right);
    out->width_mm = vec3_length(way);
    double longer = fmax(length_of(m, upper), length_of(m, lower));
    if (!(out->width_mm > straight_least * longer))
        return refuse(out,
                      "the rims form a ring, %.1f mm long with ends %.1f mm apart; a rim must lead "
                      "from one corner of the mouth to the other",
                      longer, out->width_mm);
    out->across = vec3_scale(way, 1.0 / out->width_mm);
    vec3 up = {0.0, 1.0, 0.0};
    up = vec3_sub(up, vec3_scale(out->across, out->across.y));
    if (!(out->across.x > 0.5))
        return refuse(out, "the rims do not lead from the subject's right corner (x < 0) to the "
                           "left one; reverse their lists");
    out->up = vec3_normalised(up, (vec3){0, 1, 0});
    for (int end = 0; end < 2; ++end) {
        vec3 a = at_vertex(m, upper, end ? upper->count - 1 : 0);
        vec3 b = at_vertex(m, lower, end ? lower->count - 1 : 0);
        double apart = vec3_length(vec3_sub(a, b));
        if (apart > ends_apart * out->width_mm)
            return refuse(out,
                          "the %s ends of the rims are %.1f mm apart; both must end at the corner "
                          "of the mouth",
                          end ? "left" : "right", apart);
    }
    return true;
}

/* ---- stations ---- */

static double across_of(const bind_lips *lips, vec3 from, vec3 at)
{
    return vec3_dot(lips->across, vec3_sub(at, from));
}

/* Returns the first place on the rim at `part` (0..1) of its extent across, from its first
 * vertex. */
static bind_station station_at(const bind_lips *lips, const mesh *m, const rim *of, double part)
{
    vec3 from = at_vertex(m, of, 0);
    double whole = across_of(lips, from, at_vertex(m, of, of->count - 1)), wanted = part * whole;
    for (uint32_t i = 1; i < of->count; ++i) {
        double a = across_of(lips, from, at_vertex(m, of, i - 1));
        double b = across_of(lips, from, at_vertex(m, of, i));
        if (b < wanted && i < of->count - 1)
            continue;
        double along = b > a ? (wanted - a) / (b - a) : 1.0;
        along = along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along;
        return (bind_station){{of->vertex[i - 1], of->vertex[i]}, along};
    }
    return (bind_station){{of->vertex[0], of->vertex[0]}, 0.0};
}

vec3 bind_station_position(const bind_station *station, const mesh *m)
{
    vec3 a = mesh_position(m, station->vertex[0]), b = mesh_position(m, station->vertex[1]);
    return vec3_add(vec3_scale(a, 1.0 - station->along), vec3_scale(b, station->along));
}

static bool pair_rims(bind_lips *out, const rim *upper, const rim *lower, const mesh *m)
{
    /* Twice as many stations as vertices: on coarse rims, stations between vertices bring the edges
     * closer. */
    uint32_t count = 2 * (upper->count > lower->count ? upper->count : lower->count);
    count = count < LIPS_STATIONS_MAX ? count : LIPS_STATIONS_MAX;
    for (uint32_t i = 0; i < count; ++i) {
        double even = (double)i / (count - 1), ease = even * even * (3.0 - 2.0 * even);
        double part = even + end_density * (ease - even);
        out->upper[i] = station_at(out, m, upper, part);
        out->lower[i] = station_at(out, m, lower, part);
        vec3 gap = vec3_sub(bind_station_position(&out->upper[i], m),
                            bind_station_position(&out->lower[i], m));
        double open = vec3_dot(gap, out->up);
        if (open < -crossed_most * out->width_mm)
            return refuse(out,
                          "the upper rim is %.1f mm below the lower one, %.0f %% of the way along "
                          "the slit; the rims cross, or are exchanged",
                          -open, 100.0 * part);
    }
    out->station_count = count;
    return true;
}

/* ---- vertices that move with a rim ---- */

static bool find_distances(double *out, const rim *of, double reach_mm, const mesh *m,
                           const topology *t)
{
    bind_start *start = calloc(of->count, sizeof *start);
    for (uint32_t i = 0; start && i < of->count; ++i)
        start[i].vertex = of->vertex[i];
    bool is_done = start && bind_distances(out, start, of->count, reach_mm, m, t);
    free(start);
    return is_done;
}

/* Returns 1 on the first rim, 0 on the other one, smooth between. */
static float share_of(double from_own_mm, double from_other_mm)
{
    if (!isfinite(from_own_mm))
        return 0.0f;
    if (!isfinite(from_other_mm))
        return 1.0f;
    double sum = from_own_mm + from_other_mm, part = sum > 0.0 ? from_other_mm / sum : 0.5;
    double t = (part - side_begins) / (side_ends - side_begins);
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    return (float)(t * t * (3.0 - 2.0 * t));
}

static mrt_result find_sides(bind_lips *out, const rim *upper, const rim *lower, const mesh *m,
                             const topology *t, error *err)
{
    double *above = malloc(((size_t)m->vertex_count + 1) * sizeof *above);
    double *below = malloc(((size_t)m->vertex_count + 1) * sizeof *below);
    double reach_mm = reach * out->width_mm;
    bool is_done = above && below && find_distances(above, upper, reach_mm, m, t) &&
                   find_distances(below, lower, reach_mm, m, t);
    for (uint32_t v = 0; is_done && v < m->vertex_count; ++v) {
        out->of_upper[v] = share_of(above[v], below[v]);
        out->of_lower[v] = share_of(below[v], above[v]);
    }
    free(above);
    free(below);
    return is_done ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the mouth");
}

/* ---- creation ---- */

static bool allocate(bind_lips *out, uint32_t vertex_count)
{
    out->upper = calloc(LIPS_STATIONS_MAX, sizeof *out->upper);
    out->lower = calloc(LIPS_STATIONS_MAX, sizeof *out->lower);
    out->of_upper = calloc((size_t)vertex_count + 1, sizeof *out->of_upper);
    out->of_lower = calloc((size_t)vertex_count + 1, sizeof *out->of_lower);
    return out->upper && out->lower && out->of_upper && out->of_lower;
}

static mrt_result find_stations(bind_lips *out, const rim *upper, const rim *lower, const mesh *m,
                                const topology *t, error *err)
{
    bool is_good = check_vertices(out, upper, m) && check_vertices(out, lower, m) &&
                   check_doubled(out, upper, upper, m) && check_doubled(out, lower, lower, m) &&
                   check_doubled(out, upper, lower, m);
    mrt_result result = MRT_OK;
    if (is_good)
        result = check_piece(out, upper, upper, m, t, &is_good, err);
    if (result >= 0 && is_good)
        result = check_piece(out, lower, upper, m, t, &is_good, err);
    if (result >= 0 && is_good && find_axes(out, upper, lower, m))
        (void)pair_rims(out, upper, lower, m);
    return result;
}

/* Returns an empty rim if the rig declares none. */
static rim rim_of(const char *key, const uint32_t *vertex, uint32_t count)
{
    return (rim){key, vertex, vertex ? count : 0};
}

mrt_result bind_lips_find(bind_lips *out, const rig *r, const mesh *m, const topology *t,
                          error *err)
{
    const rim upper = rim_of("upper", r->mouth.upper, r->mouth.upper_count);
    const rim lower = rim_of("lower", r->mouth.lower, r->mouth.lower_count);
    *out = (bind_lips){0};
    if (r->mouth.fault)
        (void)refuse(out, "%s", r->mouth.fault);
    if (upper.count == 0 || lower.count == 0)
        return MRT_OK;
    if (!allocate(out, m->vertex_count))
        return error_set(err, MRT_ERR_MEMORY, "no memory for the mouth of %u vertices",
                         m->vertex_count);
    mrt_result result = find_stations(out, &upper, &lower, m, t, err);
    return result < 0 || out->station_count == 0 ? result
                                                 : find_sides(out, &upper, &lower, m, t, err);
}

mrt_result bind_lips_fault(char out[BIND_FAULT], const rig *r, const mesh *m, const topology *t,
                           error *err)
{
    const rim upper = rim_of("upper", r->mouth.upper, r->mouth.upper_count);
    const rim lower = rim_of("lower", r->mouth.lower, r->mouth.lower_count);
    bind_station station[2][LIPS_STATIONS_MAX];
    bind_lips lips = {.upper = station[0], .lower = station[1]};
    mrt_result result = MRT_OK;
    if (r->mouth.fault)
        (void)refuse(&lips, "%s", r->mouth.fault);
    if (upper.count > 0 && lower.count > 0)
        result = find_stations(&lips, &upper, &lower, m, t, err);
    memcpy(out, lips.why_not, BIND_FAULT);
    return result;
}

static void *copy_of(const void *from, size_t size)
{
    void *out = malloc(size + 1);
    if (out)
        memcpy(out, from, size);
    return out;
}

bool bind_lips_copy(bind_lips *out, const bind_lips *from, uint32_t vertex_count)
{
    *out = *from;
    if (!from->upper)
        return true;
    out->upper = copy_of(from->upper, LIPS_STATIONS_MAX * sizeof *out->upper);
    out->lower = copy_of(from->lower, LIPS_STATIONS_MAX * sizeof *out->lower);
    out->of_upper = copy_of(from->of_upper, vertex_count * sizeof *out->of_upper);
    out->of_lower = copy_of(from->of_lower, vertex_count * sizeof *out->of_lower);
    return out->upper && out->lower && out->of_upper && out->of_lower;
}

void bind_lips_finish(bind_lips *lips)
{
    free(lips->upper);
    free(lips->lower);
    free(lips->of_upper);
    free(lips->of_lower);
    *lips = (bind_lips){0};
}
