/* mesh/surface_meter.h - judges a surface that was deformed against what it was at rest, by its
 * edges and triangles alone, whatever moved it: how far its edges are stretched, how far they are
 * bent, which triangles are turned inside out. Leaves out what moved it, and why. [frame] all but
 * create and destroy: no allocation. */
#ifndef MAROTTE_MESH_SURFACE_METER_H
#define MAROTTE_MESH_SURFACE_METER_H
#include "base/error.h"

typedef struct surface_meter surface_meter;

/* x, y, z: vertex_count each, at rest; triangle: triangle_count by 3. Triangles without an area at
 * rest are left out, and so are edges far shorter than the others. Nothing of it is needed any
 * more. */
CHECKED mrt_result surface_meter_create(surface_meter **out, const float *const rest[3],
                                        uint32_t vertex_count, const uint32_t *triangle,
                                        uint32_t triangle_count, error *err);
void surface_meter_destroy(surface_meter *self); /* NULL is fine */

/* at: as `rest`, in a shape that the surface is made to take too: what is stretched and bent there
 * is no fault of who brings it there, and counts as what is at rest, for surface_meter_measure. */
CHECKED mrt_result surface_meter_learn(surface_meter *self, const float *const at[3], error *err);

/* An edge is bent by the angle between the normals of its two triangles. Sharp creases that a mesh
 * has at rest may be a little sharper. */
#define SURFACE_BENT_DEG   120.0
#define SURFACE_CREASE_DEG 30.0

typedef struct surface_state {
    double stretch;      /* of the edge that is stretched most: its length over that at rest, or
                            in a shape that was learnt */
    double bend_deg;     /* of the edge that is bent most: beyond what it is there */
    uint32_t bent_count; /* edges bent by more than SURFACE_BENT_DEG, but not at rest, and by more
                            than SURFACE_CREASE_DEG beyond what they are at rest */
    uint32_t inside_out_count; /* triangles bent by more than 90 degrees at two edges or more, but
                                  not at rest: they point against those around them */
} surface_state;

/* How far the sharpest edge of a triangle is bent at rest; 0 for one that was left out. Its number
 * is that at create. */
double surface_meter_bent_at_rest(const surface_meter *self, uint32_t triangle);

/* x, y, z: vertex_count each, finite. */
void surface_meter_measure(surface_meter *self, surface_state *out, const float *const at[3]);

enum { SURFACE_BLOCK = 64 };

/* What a surface is kept within. */
typedef struct surface_limits {
    double stretch;  /* of an edge, times its length at rest */
    double bend_deg; /* of an edge; or SURFACE_CREASE_DEG beyond what it is at rest */
    double area;     /* of a triangle, times that at rest: at least */
} surface_limits;

/* How much of a step (before -> after) each vertex may take so that no limit is passed, as a part
 * of 1 in `share` (vertex_count): the nearer an edge or triangle of it is to a limit, the less of
 * what brings it nearer; all of it where the step leads away, or stays far. is_changed: of each
 * SURFACE_BLOCK vertices, 0 where the step moves none. Returns the least share. Each share is a
 * continuous function of both shapes. What is beyond its limit already may not go further. */
float surface_meter_yield(surface_meter *self, const surface_limits *limits,
                          const float *const before[3], const float *const after[3],
                          const uint8_t *is_changed, float *share);

/* out: 1 for each block of vertices that surface_meter_yield reads; what it was for the others. */
void surface_meter_reads(const surface_meter *self, const uint8_t *is_changed, uint8_t *out);

/* The corners of a triangle and, across each of its edges, the third one of its neighbour; at a
 * border one of its own. Its number is that at create. False: it was left out. */
bool surface_meter_around(const surface_meter *self, uint32_t triangle, uint32_t out[6]);
/* Of the edges of these triangles (as above) the greatest bend after, 1 being limits->bend_deg (or
 * a crease's limit); of an edge that was beyond it before, times its bend before. Reads what lies
 * around these triangles alone. */
double surface_meter_bend(const surface_meter *self, const surface_limits *limits,
                          const uint32_t *triangle, uint32_t count, const float *const before[3],
                          const float *const after[3]);

#endif
