#include "relax.h"

/* The share of spreading evenly against staying on the planes of the form. */
static const double SMOOTHING = 0.1;

/* The tangent plane of the shape at the foot of a point near it. */
static relax_plane plane_at(const form *shape, vec3 p, double area)
{
    vec3 slope = form_gradient(shape, p);
    double square = vec3_dot(slope, slope);
    double step = square > 0.01 ? shape->distance(p) / square : 0.0;
    return (relax_plane){.point = vec3_sub(p, vec3_scale(slope, step)),
                         .normal = vec3_normalised(slope, (vec3){0, 0, 1}),
                         .area = area};
}

/* Three planes for each live triangle, towards its corners: half-edge h has that at its origin. */
static void measure_planes(relax_plane *out, const skin *s, const form *shape)
{
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h) {
        if (s->origin[h] == SKIN_NONE)
            continue;
        vec3 near = s->point[s->origin[h]];
        vec3 far = form_middle(s->point[skin_target(s, h)], s->point[s->origin[skin_previous(h)]]);
        vec3 p = vec3_add(vec3_scale(near, 2.0 / 3.0), vec3_scale(far, 1.0 / 3.0));
        out[h] = plane_at(shape, p, vec3_length(skin_triangle_normal(s, h / 3)) / 6.0);
    }
}

/* The mean of the neighbours on the vertex's own line; 0: it is no line's inner point. */
static int line_middle(const skin *s, int32_t vertex, vec3 *out)
{
    int32_t around[SKIN_RING];
    int32_t count = skin_neighbours(s, vertex, around), found = 0;
    vec3 sum = {0, 0, 0};
    for (int32_t i = 0; i < count; ++i)
        if (skin_common_line(s, around[i], vertex)) {
            sum = vec3_add(sum, s->point[around[i]]);
            ++found;
        }
    *out = vec3_scale(sum, 0.5);
    return found == 2;
}

/* The mean of the triangles around, each weighed by how much too large it is. */
static vec3 fan_middle(const skin *s, const form *shape, const relax_plane *planes, int32_t vertex)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    vec3 sum = {0, 0, 0};
    double weights = 0.0;
    for (int32_t i = 0; i < count; ++i) {
        const relax_plane *p = &planes[edge[i] - edge[i] % 3];
        vec3 centre = vec3_scale(vec3_add(vec3_add(p[0].point, p[1].point), p[2].point), 1.0 / 3.0);
        double size = form_wanted_mm(shape, centre);
        double weight = p->area / (size * size) + 1e-6;
        sum = vec3_add(sum, vec3_scale(centre, weight));
        weights += weight;
    }
    return vec3_scale(sum, 1.0 / weights);
}

static vec3 smoothing_target(const skin *s, const form *shape, const relax_plane *planes,
                             int32_t vertex)
{
    vec3 out;
    int hold = s->hold[vertex];
    if (hold & SKIN_CORNER || (hold & SKIN_LINES) == SKIN_LINES)
        return s->point[vertex];
    if (hold & SKIN_LINES)
        return line_middle(s, vertex, &out) ? out : s->point[vertex];
    return fan_middle(s, shape, planes, vertex);
}

/* Solves the symmetric positive 3 by 3 system in place, without pivots. */
static vec3 solve3(double m[3][3], double r[3])
{
    for (int i = 0; i < 3; ++i)
        for (int k = i + 1; k < 3; ++k) {
            double factor = m[k][i] / m[i][i];
            for (int j = i; j < 3; ++j)
                m[k][j] -= factor * m[i][j];
            r[k] -= factor * r[i];
        }
    double z = r[2] / m[2][2];
    double y = (r[1] - m[1][2] * z) / m[1][1];
    return (vec3){(r[0] - m[0][1] * y - m[0][2] * z) / m[0][0], y, z};
}

static void hold_axis(double m[3][3], double r[3], int axis)
{
    for (int k = 0; k < 3; ++k)
        m[axis][k] = m[k][axis] = 0.0;
    m[axis][axis] = 1.0;
    r[axis] = 0.0;
}

/* The least squares of distances to planes, for a move from `at`. */
static void add_plane(double m[3][3], double r[3], const relax_plane *p, vec3 at)
{
    const double n[3] = {p->normal.x, p->normal.y, p->normal.z};
    double offset = vec3_dot(vec3_sub(p->point, at), p->normal);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            m[row][column] += p->area * n[row] * n[column];
        r[row] += p->area * n[row] * offset;
    }
}

/* The move that brings the vertex nearest to the planes around it (so into a crease, if there is
 * one) and, where they leave it free, to the smoothing target. */
static vec3 best_move(const skin *s, const form *shape, const relax_plane *planes, int32_t vertex)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    vec3 at = s->point[vertex];
    double m[3][3] = {{0}}, r[3] = {0}, weights = 0.0;
    for (int32_t i = 0; i < 3 * count; ++i) {
        const relax_plane *p = &planes[edge[i / 3] - edge[i / 3] % 3 + i % 3];
        add_plane(m, r, p, at);
        weights += p->area;
    }
    vec3 pull = vec3_sub(smoothing_target(s, shape, planes, vertex), at);
    const double wish[3] = {pull.x, pull.y, pull.z};
    double share = SMOOTHING * weights + 1e-12;
    for (int k = 0; k < 3; ++k) {
        m[k][k] += share;
        r[k] += share * wish[k];
    }
    vec3 allowed = form_masked((vec3){1, 1, 1}, s->hold[vertex]);
    if (allowed.x == 0.0)
        hold_axis(m, r, 0);
    if (allowed.y == 0.0)
        hold_axis(m, r, 1);
    return solve3(m, r);
}

/* Whether all triangles around keep their side when the vertex moves. */
static int move_is_safe(const skin *s, int32_t vertex, vec3 to)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    for (int32_t i = 0; i < count; ++i) {
        vec3 b = s->point[skin_target(s, edge[i])];
        vec3 c = s->point[s->origin[skin_previous(edge[i])]];
        vec3 before = skin_triangle_normal(s, edge[i] / 3);
        vec3 after = vec3_cross(vec3_sub(b, to), vec3_sub(c, to));
        double lengths = vec3_length(before) * vec3_length(after);
        if (vec3_dot(before, after) < RELAX_TURN_COSINE * lengths)
            return 0;
    }
    return 1;
}

void relax_round(skin *s, const form *shape, relax_plane *planes)
{
    measure_planes(planes, s, shape);
    for (int32_t v = 0; v < s->vertex_count; ++v) {
        if (s->edge[v] == SKIN_NONE)
            continue;
        double reach = 0.5 * form_wanted_mm(shape, s->point[v]);
        vec3 move = best_move(s, shape, planes, v);
        double length = vec3_length(move);
        if (length > reach)
            move = vec3_scale(move, reach / length);
        vec3 to = form_projected(shape, vec3_add(s->point[v], move), s->hold[v], reach);
        for (int turn = 0; turn < 3 && !move_is_safe(s, v, to); ++turn)
            to = form_middle(s->point[v], to);
        if (move_is_safe(s, v, to))
            s->point[v] = to;
    }
}
