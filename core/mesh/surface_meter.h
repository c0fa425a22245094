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

/* An edge is bent by the angle between the normals of its two triangles. */
#define SURFACE_BENT_DEG 120.0

typedef struct surface_state {
    double stretch;      /* of the edge that is stretched most: its length over that at rest */
    double bend_deg;     /* of the edge that is bent most: beyond what it is at rest */
    uint32_t bent_count; /* edges bent by more than SURFACE_BENT_DEG, but not at rest */
    uint32_t inside_out_count; /* triangles bent by more than 90 degrees at two edges or more, but
                                  not at rest: they point against those around them */
} surface_state;

/* x, y, z: vertex_count each, finite. */
void surface_meter_measure(surface_meter *self, surface_state *out, const float *const at[3]);

#endif
