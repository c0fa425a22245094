#include "mesh/cut.h"

#include "base/arrays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RINGS = 6, NOT_THERE = -1 };
/* Dimensions of the bag as shares of the mouth's width: depth, height above and below,
 * narrowing. */
static const double bag_depth = 0.6, bag_height = 0.22, bag_narrowing = 0.25;
static const float dark[4] = {0.025f, 0.008f, 0.007f, 1.0f};

typedef enum fan_side { SIDE_UNKNOWN = 0, SIDE_UPPER, SIDE_LOWER } fan_side;

typedef struct cutting {
    arrays arrays; /* the arrays below */
    mesh *m;
    uint32_t *chain, count;   /* points, from the subject's right to the left */
    float (*unmoved)[3];      /* positions of the chain in the file */
    int32_t *chain_index;     /* vertex_count: index of a point in the chain; NOT_THERE */
    uint32_t *fan, fan_count; /* triangles at the inner points of the chain */
    uint8_t *side;            /* of each triangle of the fan */
    uint32_t *twin; /* vertex_count: lower lip's vertex for one of the chain; UINT32_MAX */
    uint32_t *from; /* for each new vertex: the vertex that it is copied from */
    uint32_t *host; /* for each: an earlier vertex that is the same point; UINT32_MAX: none */
    float *deep;    /* for each: 0 at the lips .. 1 at the back of the bag */
    float (*at)[3]; /* position of each */
    uint32_t (*bag)[3], bag_count;
    uint32_t old_count, new_count;
} cutting;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to cut a mouth");
}

/* ---- the chain ---- */

static const float *position_of(const cutting *c, uint32_t vertex)
{
    return vertex < c->old_count ? c->m->position + (size_t)vertex * 3
                                 : c->at[vertex - c->old_count];
}

static mrt_result copy_chain(cutting *c, const uint32_t *chain, uint32_t count, error *err)
{
    for (uint32_t i = 0; i < count; ++i)
        if (chain[i] >= c->m->vertex_count)
            return error_set(err, MRT_ERR_FORMAT, "vertex %u of %u", chain[i], c->m->vertex_count);
    bool is_turned = position_of(c, chain[0])[0] > position_of(c, chain[count - 1])[0];
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t point = mesh_point(c->m, chain[is_turned ? count - 1 - i : i]);
        if (c->chain_index[point] != NOT_THERE)
            return error_set(err, MRT_ERR_FORMAT, "vertex %u appears twice", point);
        c->chain_index[point] = (int32_t)i;
        c->chain[i] = point;
    }
    c->count = count;
    return MRT_OK;
}

static int32_t chain_index_of(const cutting *c, uint32_t vertex)
{
    return c->chain_index[mesh_point(c->m, vertex)];
}

static bool is_inner(const cutting *c, int32_t chain_index)
{
    return chain_index > 0 && chain_index < (int32_t)c->count - 1;
}

static const uint32_t *corners_of(const cutting *c, uint32_t fan)
{
    return c->m->triangle + (size_t)c->fan[fan] * 3;
}

/* Seen from outside, a counter-clockwise triangle above goes along the chain, one below against
 * it. */
static mrt_result find_fan(cutting *c, error *err)
{
    for (uint32_t t = 0; t < c->m->triangle_count; ++t) {
        const uint32_t *corner = c->m->triangle + (size_t)t * 3;
        fan_side side = SIDE_UNKNOWN;
        bool is_of_fan = false;
        for (size_t i = 0; i < 3; ++i) {
            int32_t a = chain_index_of(c, corner[i]), b = chain_index_of(c, corner[(i + 1) % 3]);
            is_of_fan = is_of_fan || is_inner(c, a);
            if (a == NOT_THERE || b == NOT_THERE || (a != b + 1 && b != a + 1))
                continue;
            side = b > a ? SIDE_UPPER : SIDE_LOWER;
        }
        if (!is_of_fan)
            continue;
        c->fan[c->fan_count] = t;
        c->side[c->fan_count++] = (uint8_t)side;
    }
    for (uint32_t i = 0; i + 1 < c->count; ++i) {
        uint32_t uses[3] = {0};
        for (uint32_t k = 0; k < c->fan_count; ++k) {
            const uint32_t *corner = corners_of(c, k);
            bool has[2] = {false, false};
            for (int n = 0; n < 3; ++n)
                for (int e = 0; e < 2; ++e)
                    has[e] = has[e] || chain_index_of(c, corner[n]) == (int32_t)i + e;
            uses[c->side[k]] += has[0] && has[1];
        }
        if (uses[SIDE_UPPER] != 1 || uses[SIDE_LOWER] != 1)
            return error_set(err, MRT_ERR_FORMAT,
                             "vertices %u and %u are not joined by an edge of two triangles",
                             c->chain[i], c->chain[i + 1]);
    }
    return MRT_OK;
}

/* Returns whether two triangles of the fan share an edge at an inner point, other than edges of the
 * chain. */
static bool are_beside(const cutting *c, uint32_t a, uint32_t b)
{
    const uint32_t *p = corners_of(c, a), *q = corners_of(c, b);
    uint32_t shared[3], count = 0;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            if (mesh_point(c->m, p[i]) == mesh_point(c->m, q[k]) && count < 3)
                shared[count++] = p[i];
    if (count != 2)
        return false;
    int32_t from = chain_index_of(c, shared[0]), to = chain_index_of(c, shared[1]);
    bool is_of_chain = from != NOT_THERE && to != NOT_THERE && abs(from - to) == 1;
    return !is_of_chain && (is_inner(c, from) || is_inner(c, to));
}

static mrt_result find_sides(cutting *c, error *err)
{
    for (bool grows = true; grows;) {
        grows = false;
        for (uint32_t a = 0; a < c->fan_count; ++a)
            for (uint32_t b = 0; c->side[a] != SIDE_UNKNOWN && b < c->fan_count; ++b) {
                if (c->side[b] == c->side[a] || !are_beside(c, a, b))
                    continue;
                if (c->side[b] != SIDE_UNKNOWN)
                    return error_set(err, MRT_ERR_FORMAT,
                                     "the surface around vertex %u continues from the upper lip "
                                     "to the lower one",
                                     corners_of(c, a)[0]);
                c->side[b] = c->side[a];
                grows = true;
            }
    }
    return MRT_OK;
}

/* ---- a straight edge of the lips ---- */

/* Computes the normal of a triangle of the fan, twice its area long: as the file has it, or with
 * the point `moved` of the chain at another place. */
static void triangle_normal(double out[3], const cutting *c, uint32_t fan, int32_t moved,
                            const double *at)
{
    double p[3][3];
    for (int i = 0; i < 3; ++i) {
        const uint32_t vertex = corners_of(c, fan)[i];
        const int32_t index = chain_index_of(c, vertex);
        for (int axis = 0; axis < 3; ++axis)
            p[i][axis] = at && index == moved        ? at[axis]
                         : !at && index != NOT_THERE ? (double)c->unmoved[index][axis]
                                                     : (double)position_of(c, vertex)[axis];
    }
    for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3, n = (i + 2) % 3;
        out[i] =
            (p[1][k] - p[0][k]) * (p[2][n] - p[0][n]) - (p[1][n] - p[0][n]) * (p[2][k] - p[0][k]);
    }
}

/* Returns whether the triangles around a point of the chain keep their side, and half of their area
 * in the file, if it moves. */
static bool may_move(const cutting *c, int32_t index, const double to[3])
{
    for (uint32_t k = 0; k < c->fan_count; ++k) {
        const uint32_t *corner = corners_of(c, k);
        double before[3], after[3], along = 0.0, size = 0.0;
        if (chain_index_of(c, corner[0]) != index && chain_index_of(c, corner[1]) != index &&
            chain_index_of(c, corner[2]) != index)
            continue;
        triangle_normal(before, c, k, NOT_THERE, NULL);
        triangle_normal(after, c, k, index, to);
        for (int axis = 0; axis < 3; ++axis) {
            along += before[axis] * after[axis];
            size += before[axis] * before[axis];
        }
        if (!(along >= 0.5 * size))
            return false;
    }
    return true;
}

static void move_point(cutting *c, int32_t index, const double to[3])
{
    for (uint32_t k = 0; k < c->fan_count; ++k)
        for (int i = 0; i < 3; ++i) {
            const uint32_t vertex = corners_of(c, k)[i];
            for (size_t axis = 0; chain_index_of(c, vertex) == index && axis < 3; ++axis)
                c->m->position[(size_t)vertex * 3 + axis] = (float)to[axis];
        }
}

/* Moves the points of the chain towards the line between their neighbours, where the surface allows
 * it: the edges of the mesh zigzag, and lips must not. */
static void straighten(cutting *c)
{
    enum { ROUNDS = 8 };
    for (uint32_t i = 0; i < c->count; ++i)
        memcpy(c->unmoved[i], position_of(c, c->chain[i]), sizeof c->unmoved[i]);
    for (int round = 0; round < ROUNDS; ++round)
        for (int32_t i = 1; i < (int32_t)c->count - 1; ++i) {
            const float *a = position_of(c, c->chain[i - 1]), *p = position_of(c, c->chain[i]),
                        *b = position_of(c, c->chain[i + 1]);
            double to[3];
            for (int axis = 0; axis < 3; ++axis)
                to[axis] = 0.5 * (double)p[axis] + 0.25 * ((double)a[axis] + (double)b[axis]);
            if (may_move(c, i, to))
                move_point(c, i, to);
        }
}

/* ---- new vertices and triangles ---- */

static uint32_t add_vertex(cutting *c, uint32_t like, uint32_t host, double deep,
                           const double at[3])
{
    uint32_t i = c->new_count++;
    c->from[i] = like;
    c->host[i] = host;
    c->deep[i] = (float)deep;
    for (int axis = 0; axis < 3; ++axis)
        c->at[i][axis] = (float)at[axis];
    return c->old_count + i;
}

static uint32_t add_copy(cutting *c, uint32_t like, uint32_t host)
{
    const float *p = position_of(c, like);
    return add_vertex(c, like, host, 0.0,
                      (const double[3]){(double)p[0], (double)p[1], (double)p[2]});
}

/* Returns the vertex of the lower lip for a vertex. The twin of a point itself is made first. */
static uint32_t twin_of(cutting *c, uint32_t vertex)
{
    uint32_t point = mesh_point(c->m, vertex);
    if (c->twin[point] == UINT32_MAX)
        c->twin[point] = add_copy(c, point, UINT32_MAX);
    if (c->twin[vertex] == UINT32_MAX)
        c->twin[vertex] = add_copy(c, vertex, c->twin[point]);
    return c->twin[vertex];
}

/* Gives the triangles of the lower side the vertices of the lower lip. */
static void part_lips(cutting *c)
{
    for (uint32_t k = 0; k < c->fan_count; ++k) {
        uint32_t *corner = c->m->triangle + (size_t)c->fan[k] * 3;
        for (int i = 0; c->side[k] == SIDE_LOWER && i < 3; ++i)
            if (is_inner(c, chain_index_of(c, corner[i])))
                corner[i] = twin_of(c, corner[i]);
    }
}

static void add_triangle(cutting *c, uint32_t a, uint32_t b, uint32_t d)
{
    uint32_t *corner = c->bag[c->bag_count++];
    corner[0] = a;
    corner[1] = b;
    corner[2] = d;
}

/* Builds the bag. Seen from the mouth, its rings go along the upper lip and back along the lower
 * one. */
static void hang_bag(cutting *c, uint32_t *ring, uint32_t *next)
{
    const uint32_t n = c->count, loop = 2 * (n - 1);
    const float *right = position_of(c, c->chain[0]), *left = position_of(c, c->chain[n - 1]);
    const double width = (double)left[0] - (double)right[0];
    const double middle = 0.5 * ((double)left[0] + (double)right[0]);
    for (uint32_t i = 0; i < loop; ++i) {
        uint32_t lip = i < n ? c->chain[i] : twin_of(c, c->chain[loop - i]);
        ring[i] = add_copy(c, i < n ? lip : c->chain[loop - i], lip); /* shown as an edge */
    }
    for (int r = 1; r <= RINGS; ++r) {
        double deep = (double)r / RINGS, high = 4.0 * deep * (1.0 - deep) + 0.35 * deep;
        for (uint32_t i = 0; i < loop; ++i) {
            uint32_t lip = i < n ? c->chain[i] : c->chain[loop - i];
            const float *p = position_of(c, lip);
            double off = 2.0 * ((double)p[0] - middle) / width, up = i < n ? 1.0 : -1.0;
            double at[3] = {(double)p[0] - bag_narrowing * deep * ((double)p[0] - middle),
                            (double)p[1] +
                                up * high * bag_height * width * fmax(1.0 - off * off, 0.0),
                            (double)p[2] - deep * bag_depth * width};
            next[i] = add_vertex(c, lip, UINT32_MAX, deep, at);
        }
        for (uint32_t i = 0; i < loop; ++i) {
            uint32_t k = (i + 1) % loop;
            add_triangle(c, ring[k], ring[i], next[i]);
            add_triangle(c, ring[k], next[i], next[k]);
        }
        memcpy(ring, next, loop * sizeof *ring);
    }
    double centre[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < loop; ++i)
        for (int axis = 0; axis < 3; ++axis)
            centre[axis] += (double)position_of(c, ring[i])[axis] / loop;
    uint32_t back = add_vertex(c, c->chain[n / 2], UINT32_MAX, 1.0, centre);
    for (uint32_t i = 0; i < loop; ++i)
        add_triangle(c, ring[(i + 1) % loop], ring[i], back);
}

/* ---- changing the mesh ---- */

static bool grow(void *array, size_t count, size_t more, size_t item_size)
{
    void **at = array;
    void *larger = *at ? realloc(*at, (count + more + 1) * item_size) : NULL;
    if (larger)
        *at = larger;
    return !*at || larger;
}

static bool grow_all(mesh *m, size_t more, size_t triangles)
{
    size_t n = m->vertex_count;
    bool grown =
        grow(&m->position, 3 * n, 3 * more, sizeof *m->position) &&
        grow(&m->normal, 3 * n, 3 * more, sizeof *m->normal) &&
        grow(&m->point, n, more, sizeof *m->point) &&
        grow(&m->smooth, n, more, sizeof *m->smooth) &&
        grow(&m->uv, 2 * n, 2 * more, sizeof *m->uv) &&
        grow(&m->colour, 4 * n, 4 * more, sizeof *m->colour) &&
        grow(&m->skin_joint, MESH_SKIN_WIDTH * n, MESH_SKIN_WIDTH * more, sizeof *m->skin_joint) &&
        grow(&m->skin_weight, MESH_SKIN_WIDTH * n, MESH_SKIN_WIDTH * more,
             sizeof *m->skin_weight) &&
        grow(&m->triangle, 3 * (size_t)m->triangle_count, 3 * triangles, sizeof *m->triangle) &&
        grow(&m->part, m->part_count, 1, sizeof *m->part) &&
        grow(&m->material, m->material_count, 1, sizeof *m->material);
    for (uint32_t i = 0; grown && i < m->target_count; ++i)
        grown = grow(&m->target[i].offset, 3 * n, 3 * more, sizeof *m->target[i].offset);
    for (uint32_t i = 0; grown && i < m->attribute_count; ++i) {
        size_t width = m->attribute[i].component_count;
        grown = grow(&m->attribute[i].value, width * n, width * more, sizeof(float));
    }
    return grown;
}

static void copy_row(float *array, size_t width, size_t to, size_t from)
{
    if (array)
        memcpy(array + width * to, array + width * from, width * sizeof *array);
}

/* Copies the vertex that it comes from. In the bag, vertices that are deeper move less with the
 * lips. */
static void write_vertex(const cutting *c, uint32_t i)
{
    mesh *m = c->m;
    size_t to = (size_t)c->old_count + i, from = c->from[i];
    const float deep = c->deep[i];
    copy_row(m->normal, 3, to, from);
    copy_row(m->uv, 2, to, from);
    copy_row(m->skin_weight, MESH_SKIN_WIDTH, to, from);
    if (m->skin_joint)
        memcpy(m->skin_joint + MESH_SKIN_WIDTH * to, m->skin_joint + MESH_SKIN_WIDTH * from,
               MESH_SKIN_WIDTH * sizeof *m->skin_joint);
    memcpy(m->position + 3 * to, c->at[i], sizeof c->at[i]);
    copy_row(m->colour, 4, to, from);
    for (size_t k = 0; m->colour && deep > 0.0f && k < 4; ++k)
        m->colour[4 * to + k] = 1.0f;
    for (uint32_t k = 0; k < m->attribute_count; ++k)
        copy_row(m->attribute[k].value, m->attribute[k].component_count, to, from);
    for (uint32_t k = 0; k < m->target_count; ++k)
        for (size_t axis = 0; axis < 3; ++axis)
            m->target[k].offset[3 * to + axis] =
                (1.0f - deep) * m->target[k].offset[3 * from + axis];
    m->point[to] = c->host[i] == UINT32_MAX ? (uint32_t)to : m->point[c->host[i]];
    m->smooth[to] = (uint32_t)to;
    uint32_t smooth = m->smooth[from]; /* if the upper lip's vertex is smooth, so is its twin */
    if (c->twin[from] == to && smooth != from && c->twin[smooth] < to)
        m->smooth[to] = c->twin[smooth];
}

/* Makes every vertex a separate point, if the mesh has no points yet. */
static bool make_points(mesh *m)
{
    if (m->point)
        return true;
    m->point = malloc(((size_t)m->vertex_count + 1) * sizeof *m->point);
    m->smooth = malloc(((size_t)m->vertex_count + 1) * sizeof *m->smooth);
    for (uint32_t v = 0; m->point && m->smooth && v < m->vertex_count; ++v)
        m->point[v] = m->smooth[v] = v;
    if (m->point && m->smooth)
        return true;
    free(m->point);
    free(m->smooth);
    m->point = m->smooth = NULL;
    return false;
}

static void write_part(cutting *c, char *name, char *material_name)
{
    mesh *m = c->m;
    mesh_material *look = &m->material[m->material_count];
    *look = mesh_material_grey();
    look->name = material_name;
    memcpy(look->base_colour, dark, sizeof dark);
    uint32_t low = UINT32_MAX, high = 0;
    for (uint32_t i = 0; i < c->bag_count; ++i)
        for (int k = 0; k < 3; ++k) {
            low = c->bag[i][k] < low ? c->bag[i][k] : low;
            high = c->bag[i][k] > high ? c->bag[i][k] : high;
        }
    m->part[m->part_count++] = (mesh_part){.name = name,
                                           .material = m->material_count++,
                                           .first_triangle = m->triangle_count,
                                           .triangle_count = c->bag_count,
                                           .first_vertex = low,
                                           .vertex_count = high - low + 1};
    memcpy(m->triangle + (size_t)m->triangle_count * 3, c->bag, c->bag_count * sizeof *c->bag);
    m->triangle_count += c->bag_count;
}

static mrt_result allocate(cutting *c, uint32_t count, error *err)
{
    arrays *a = &c->arrays;
    size_t vertices = c->m->vertex_count, triangles = c->m->triangle_count;
    c->chain = arrays_add(a, count, sizeof *c->chain);
    c->unmoved = arrays_add(a, count, sizeof *c->unmoved);
    c->chain_index = arrays_add(a, vertices, sizeof *c->chain_index);
    c->twin = arrays_add(a, vertices, sizeof *c->twin);
    c->fan = arrays_add(a, triangles, sizeof *c->fan);
    c->side = arrays_add(a, triangles, sizeof *c->side);
    if (a->failed)
        return no_memory(err);
    memset(c->chain_index, 0xff, vertices * sizeof *c->chain_index);
    memset(c->twin, 0xff, vertices * sizeof *c->twin);
    return MRT_OK;
}

static mrt_result open_mouth(cutting *c, error *err)
{
    /* Upper limit: all corners of the lower side, twins for the bag, the rings of the bag and its
     * end. */
    const size_t loop = 2 * (size_t)c->count, triangles = (2 * RINGS + 1) * loop;
    const size_t vertices = (size_t)6 * c->fan_count + (RINGS + 2) * loop + 1;
    arrays *a = &c->arrays;
    uint32_t *ring = arrays_add(a, 2 * loop, sizeof *ring);
    char *name = strdup("mouth"), *material_name = strdup("mouth");
    c->from = arrays_add(a, vertices, sizeof *c->from);
    c->host = arrays_add(a, vertices, sizeof *c->host);
    c->deep = arrays_add(a, vertices, sizeof *c->deep);
    c->at = arrays_add(a, vertices, sizeof *c->at);
    c->bag = arrays_add(a, triangles, sizeof *c->bag);
    if (a->failed || !name || !material_name || !make_points(c->m) ||
        !grow_all(c->m, vertices, triangles)) {
        free(name);
        free(material_name);
        return no_memory(err);
    }
    straighten(c);
    part_lips(c);
    hang_bag(c, ring, ring + loop);
    for (uint32_t i = 0; i < c->new_count; ++i)
        write_vertex(c, i);
    c->m->vertex_count += c->new_count;
    write_part(c, name, material_name);
    free(c->m->path);
    c->m->path = NULL;
    mesh_note(c->m, "mouth: opened along %u edges, with a bag of %u triangles behind it",
              c->count - 1, c->bag_count);
    return MRT_OK;
}

mrt_result mesh_cut_mouth(mesh *m, const uint32_t *chain, uint32_t count, error *err)
{
    cutting c = {.m = m, .old_count = m->vertex_count};
    mrt_result result =
        count < 4 || count > MESH_CUT_MAX
            ? error_set(err, MRT_ERR_FORMAT, "a mouth of %u vertices: expected 4 to %d", count,
                        MESH_CUT_MAX)
            : allocate(&c, count, err);
    if (result >= 0)
        result = copy_chain(&c, chain, count, err);
    if (result >= 0)
        result = find_fan(&c, err);
    if (result >= 0)
        result = find_sides(&c, err);
    if (result >= 0)
        result = open_mouth(&c, err);
    arrays_free(&c.arrays);
    return result;
}
