/* face/pieces.h - the connected pieces of a surface. Inside the room. [main] */
#ifndef MAROTTE_FACE_PIECES_H
#define MAROTTE_FACE_PIECES_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* out_piece: vertex_count; *out_count for vertices of no accepted triangle. */
CHECKED mrt_result pieces_find(uint32_t *out_piece, uint32_t *out_count, const mesh *m,
                               const topology *t, error *err);

#endif
