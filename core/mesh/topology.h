/* mesh/topology.h - connections in a mesh: neighbours, borders, and triangles that do not fit a
 * manifold. It describes points of the surface: the first vertex of a point (mesh.point) has its
 * data, and the other vertices have empty rows. Built by io/openmesh.h; plain arrays for all users.
 * Read-only on any thread. */
#ifndef MAROTTE_MESH_TOPOLOGY_H
#define MAROTTE_MESH_TOPOLOGY_H
#include "mesh/mesh.h"

typedef struct topology {
    uint32_t vertex_count;
    uint32_t *neighbour_start;   /* vertex_count + 1: row starts into neighbour */
    uint32_t *neighbour;         /* ascending within a row; only over accepted triangles */
    uint8_t *on_border;          /* vertex_count: 1 on an open edge */
    uint32_t *border_loop_start; /* border_loop_count + 1 */
    uint32_t *border_vertex;     /* loops, each in order along the border */
    uint32_t border_loop_count;
    uint32_t *rejected_triangle; /* triangles that are degenerate or not manifold, ascending */
    uint32_t rejected_count;
    uint32_t isolated_vertex_count; /* number of empty rows */
    uint32_t component_count;       /* connected parts, without isolated vertices */
} topology;

void topology_destroy(topology *t); /* accepts NULL and a zeroed struct */
/* Makes a deep copy; on error `out` is zeroed. [any] */
CHECKED mrt_result topology_copy(topology *out, const topology *t, error *err);

/* Numbers the connected pieces of the surface. out_piece: vertex_count; *out_count for vertices
 * without an accepted triangle. */
CHECKED mrt_result topology_pieces(uint32_t *out_piece, uint32_t *out_count, const mesh *m,
                                   const topology *t, error *err);

#endif
