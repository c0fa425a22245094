/* mesh/surface_meter.h - compares a deformed surface with its rest shape, only by its edges and
 * triangles: stretch of edges, bend of edges, triangles that are inside out. Leaves out the cause
 * of the deformation. [frame] all except create and destroy: no allocation. */
#ifndef MAROTTE_MESH_SURFACE_METER_H
#define MAROTTE_MESH_SURFACE_METER_H
#include "base/error.h"

typedef struct surface_meter surface_meter;

/* x, y, z: vertex_count each, at rest; triangle: triangle_count by 3. Triangles without area at
 * rest are left out, and so are edges that are much shorter than the others. The arguments may be
 * freed after creation. */
CHECKED mrt_result surface_meter_create(surface_meter **out, const float *const rest[3],
                                        uint32_t vertex_count, const uint32_t *triangle,
                                        uint32_t triangle_count, error *err);
void surface_meter_destroy(surface_meter *self); /* accepts NULL */

/* Learns an intended shape; at: as `rest`. surface_meter_measure treats its stretch and bends like
 * those at rest, because the performance did not cause them. */
CHECKED mrt_result surface_meter_learn(surface_meter *self, const float *const at[3], error *err);

/* The bend of an edge is the angle between the normals of its two triangles. Creases that are sharp
 * at rest may become a little sharper. */
#define SURFACE_BENT_DEG   120.0
#define SURFACE_CREASE_DEG 30.0

typedef struct surface_state {
    double stretch;      /* longest edge, relative to rest or to a learnt shape */
    double bend_deg;     /* of the most bent edge: relative to its bend there */
    uint32_t bent_count; /* edges bent by more than SURFACE_BENT_DEG, but not at rest, and by more
                            than SURFACE_CREASE_DEG beyond their bend at rest */
    uint32_t inside_out_count; /* triangles bent by more than 90 degrees at two or more edges, but
                                  not at rest: they point against their neighbours */
} surface_state;

/* Returns the bend at rest of the sharpest edge of a triangle; 0 for one that was left out.
 * triangle: its number at creation. */
double surface_meter_bent_at_rest(const surface_meter *self, uint32_t triangle);

/* x, y, z: vertex_count each, finite. */
void surface_meter_measure(surface_meter *self, surface_state *out, const float *const at[3]);

enum { SURFACE_BLOCK = 64 };

/* Limits for a surface. */
typedef struct surface_limits {
    double stretch;  /* of an edge, relative to rest */
    double bend_deg; /* of an edge; for creases SURFACE_CREASE_DEG beyond their bend at rest */
    double area;     /* minimum, relative to rest */
} surface_limits;

/* Computes how much of a step (before -> after) each vertex may take without passing a limit, as a
 * share of 1 in `share` (vertex_count). The nearer its edges and triangles are to a limit, the
 * smaller the share of motion towards it. Motion away from the limits, or far from them, has the
 * share 1. Edges and triangles beyond their limit may not go further. is_changed: for each
 * SURFACE_BLOCK vertices, 0 if the step does not move them. Returns the least share. Each share is
 * a continuous function of both shapes. */
float surface_meter_yield(surface_meter *self, const surface_limits *limits,
                          const float *const before[3], const float *const after[3],
                          const uint8_t *is_changed, float *share);

/* out: 1 for each block of vertices that surface_meter_yield reads; others are unchanged. */
void surface_meter_reads(const surface_meter *self, const uint8_t *is_changed, uint8_t *out);

/* Returns the corners of a triangle and, across each of its edges, the third corner of the
 * neighbour; at a border a corner of its own. triangle: its number at creation. False: it was left
 * out. */
bool surface_meter_around(const surface_meter *self, uint32_t triangle, uint32_t out[6]);
/* Returns the greatest bend after the step, over the edges of these triangles: 1 is
 * limits->bend_deg (or the limit of a crease). For an edge beyond its limit before, it is relative
 * to its bend before. Reads only the surroundings of these triangles. */
double surface_meter_bend(const surface_meter *self, const surface_limits *limits,
                          const uint32_t *triangle, uint32_t count, const float *const before[3],
                          const float *const after[3]);

#endif
