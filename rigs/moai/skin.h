/* rigs/moai/skin.h - a triangulated surface whose edges can be split, collapsed and flipped:
 * half-edges in flat arrays, three per triangle. Closed, or open along borders. Every operation
 * keeps the surface a manifold. Leaves out the shape. Pure. [any] */
#ifndef MAROTTE_RIGS_MOAI_SKIN_H
#define MAROTTE_RIGS_MOAI_SKIN_H
#include "base/error.h"
#include "base/rigid.h"
#include "mirror.h"

enum { SKIN_NONE = -1, SKIN_RING = 32 };

/* Constraints of a point when it moves. An edge is part of a line if both ends hold the same bit
 * (and, with SKIN_LEVEL, have the same height). Edits follow lines and never cross them. */
enum {
    SKIN_FREE = 0,
    SKIN_MIDDLE = MIRROR_MIDDLE, /* stays at x = 0: the border where the two halves meet */
    SKIN_LEVEL = 2,              /* keeps its height */
    SKIN_CORNER = 4,             /* keeps x and y: the end of a line */
    SKIN_LINES = SKIN_MIDDLE | SKIN_LEVEL
};

typedef struct skin {
    vec3 *point;     /* vertex_count, mm */
    uint8_t *hold;   /* vertex_count, SKIN_* bits */
    int32_t *edge;   /* vertex_count: a half-edge that leaves it; SKIN_NONE for a dead vertex */
    int32_t *origin; /* half-edges, 3 per triangle: start vertex; SKIN_NONE for a dead triangle */
    int32_t *twin;   /* half-edges: the opposite one; SKIN_NONE on a border */
    int32_t vertex_count, triangle_count;       /* including dead ones */
    int32_t vertex_capacity, triangle_capacity; /* of the arrays */
    int32_t live_triangle_count;
} skin;

/* Creates an empty skin that can grow up to the capacities. */
CHECKED mrt_result skin_create(skin *out, int32_t vertex_capacity, int32_t triangle_capacity,
                               error *err);
void skin_destroy(skin *s); /* accepts NULL and zeroed */

/* Both return an error if the skin is full. A triangle is counter-clockwise from outside. */
CHECKED mrt_result skin_add_point(skin *s, vec3 point, uint8_t hold, error *err);
CHECKED mrt_result skin_add_triangle(skin *s, int32_t a, int32_t b, int32_t c, error *err);
/* Finds the twins after all triangles were added. Returns an error if the surface is not an
 * oriented manifold. */
CHECKED mrt_result skin_join(skin *s, error *err);

static inline int32_t skin_next(int32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

static inline int32_t skin_previous(int32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

static inline int32_t skin_target(const skin *s, int32_t h)
{
    return s->origin[skin_next(h)];
}

/* Returns true once per edge: for the half-edge on a border, or the lower one of two. */
static inline int skin_is_edge(const skin *s, int32_t h)
{
    return s->origin[h] != SKIN_NONE && (s->twin[h] == SKIN_NONE || h < s->twin[h]);
}

/* Returns the kind of line that two neighbours share, or SKIN_FREE. */
static inline int skin_common_line(const skin *s, int32_t a, int32_t b)
{
    int line = s->hold[a] & s->hold[b] & SKIN_LINES;
    return s->point[a].y == s->point[b].y ? line : line & ~SKIN_LEVEL;
}

/* Lists the half-edges that leave a vertex, counter-clockwise; on a border it starts there. Returns
 * their number, or SKIN_RING + 1 if out_edge is too small. */
int32_t skin_leaving(const skin *s, int32_t vertex, int32_t out_edge[SKIN_RING]);
/* Lists the vertices around a vertex in the same way. */
int32_t skin_neighbours(const skin *s, int32_t vertex, int32_t out_vertex[SKIN_RING]);

/* Splits an edge. Returns the new vertex, or SKIN_NONE if the skin is full. */
int32_t skin_split(skin *s, int32_t h, vec3 point);
/* Flips an edge to join the two opposite corners. Returns 0 if this is not allowed. */
int skin_flip(skin *s, int32_t h);
/* Returns whether the edge may collapse to its target without harm to the manifold or to a line. */
int skin_may_collapse(const skin *s, int32_t h);
/* Collapses the edge: its origin dies, its target stays. Call only if skin_may_collapse is true. */
void skin_collapse(skin *s, int32_t h);
/* Removes dead elements; the others keep their order. */
void skin_compact(skin *s);

/* Not a unit vector: the length is twice the triangle's area. */
vec3 skin_triangle_normal(const skin *s, int32_t triangle);

#endif
