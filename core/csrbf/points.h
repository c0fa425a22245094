/* csrbf/points.h - the vertices that the engine deforms: structure of arrays, 64-byte aligned,
 * padded to blocks of 64 vertices. They are in Morton order, so that a block is small in space and
 * can be skipped by its bounds. The three streams are staggered so that they never collide in a
 * cache set. Slots beyond `count` repeat the last vertex. [frame] all except create/destroy: no
 * allocation. */
#ifndef MAROTTE_CSRBF_POINTS_H
#define MAROTTE_CSRBF_POINTS_H
#include "base/error.h"
#include "base/rigid.h"

#include <stdint.h>

enum { POINTS_BLOCK = 64 };
/* Larger coordinates, displacements and radii are rejected: their squares must fit in float. */
#define POINTS_REACH 1e15f

typedef struct points_bounds {
    float low[3], high[3];
} points_bounds;

typedef struct points {
    float *x, *y, *z;     /* padded_count each */
    points_bounds *block; /* block_count; points_update_bounds updates them */
    uint32_t count, padded_count, block_count;
} points;

/* The slot in the engine's order for each vertex of a file, and the inverse. */
typedef struct points_order {
    uint32_t *file_of_slot; /* count */
    uint32_t *slot_of_file; /* count */
    uint32_t count;
} points_order;

/* Computes the Morton order of the rows of xyz (count by 3), ties by x, y, z, then row. So the same
 * set of points gives the same order. Rejects coordinates that are not finite and within
 * POINTS_REACH. */
CHECKED mrt_result points_order_create(points_order *out, const float *xyz, uint32_t count,
                                       error *err);
void points_order_destroy(points_order *order);

/* Copies the rows of xyz in the given order. Rejects the same coordinates as
 * points_order_create. */
CHECKED mrt_result points_create(points *out, const points_order *order, const float *xyz,
                                 error *err);
void points_destroy(points *p);

/* Both must have the same count. */
void points_copy(points *out, const points *from);
void points_copy_block(points *out, const points *from, uint32_t block);
/* Writes the vertices back as rows (count by 3) in the file's order. */
void points_to_rows(float *out_xyz, const points *p, const points_order *order);
void points_update_bounds(points *p);
void points_update_block(points *p, uint32_t block); /* the same for one block */
/* Returns the vertex in a slot. */
void points_at(double out[3], const points *p, size_t slot);
static inline vec3 points_position(const points *p, size_t slot)
{
    return (vec3){(double)p->x[slot], (double)p->y[slot], (double)p->z[slot]};
}
/* Returns the slot of the vertex nearest to `at`; of several the lowest. */
uint32_t points_nearest(const points *p, vec3 at);
/* Sets out to x, y, z and returns it. */
const float *const *points_streams(const points *p, const float *out[3]);
/* Computes the bounds of all vertices from those of the blocks. */
points_bounds points_extent(const points *p);
/* Returns whether all coordinates are finite and within POINTS_REACH. */
bool points_are_usable(const points *p);
/* Returns the squared distance from the point `at` to the box; 0 inside. */
double points_bounds_distance_squared(const points_bounds *bounds, const double at[3]);

/* ---- canonical orders of a set of points; internal to csrbf ---- */

/* One order follows a Morton curve through the enclosing cube, which keeps neighbours close. The
 * other follows the longest axis, which keeps the envelope of their matrix small. Ties by x, y, z,
 * then by row: the same set gives the same sequence for any numbering. */
typedef struct order_item {
    uint64_t key;
    double at[3]; /* finite */
    uint32_t row;
} order_item;

/* Sort the items by `at` and `row`; the keys are computed here. scratch: count. The second function
 * returns the axis that it used. */
void order_sort(order_item *item, order_item *scratch, uint32_t count);
int order_sort_along(order_item *item, order_item *scratch, uint32_t count);

#endif
