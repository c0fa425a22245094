/* mesh/shading_state.h - what shading is made of. Inside shading*.c. */
#ifndef MAROTTE_MESH_SHADING_STATE_H
#define MAROTTE_MESH_SHADING_STATE_H
#include "mesh/shading.h"

/* So many triangles of a vertex are added up by table; nearly all vertices have no more. */
enum { SHADING_FEW = 6, SHADING_TABLED = 8, SHADING_CROSSES = SHADING_BLOCK * SHADING_TABLED };

typedef struct shading_row { /* x, y, z, and a fourth so that it fits a vector */
    _Alignas(16) float at[4];
} shading_row;

/* The triangles of a vertex as indices into those of its block, ascending as in the mesh; the
 * block's triangle_count where there are no more: a triangle without area. */
typedef struct shading_table {
    uint16_t triangle[SHADING_BLOCK][SHADING_TABLED];
} shading_table;

typedef struct shading_more { /* a triangle beyond a vertex's table, in their order */
    uint32_t lane, corner[3];
} shading_more;

typedef struct shading_neighbour {
    uint32_t block;
    uint64_t lanes; /* bits: the vertices of this block that share a triangle with that one */
} shading_neighbour;

typedef struct shading_block {
    uint32_t first_triangle, triangle_count;
    uint32_t first_more, more_count;
    uint32_t first_neighbour, neighbour_count;
    uint64_t flat; /* bits: vertices that have no normal at rest */
} shading_block;

struct shading {
    uint32_t vertex_count, block_count;
    shading_block *block;
    shading_table *table;         /* block_count */
    uint32_t *corner;             /* by 3: slots of the triangles of all blocks */
    shading_more *more;           /* of all blocks */
    shading_neighbour *neighbour; /* of all blocks */
    shading_row *place;           /* a row for each slot: where it is */
    float *normal[3], *rest[3];   /* block_count whole blocks each */
    uint8_t *is_new;              /* block_count: scratch of an update */
    uint8_t *is_placed;           /* block_count: `place` has it as it is now */
    stamps_reader seen;
    stamps written;
};

/* ---- shading.c ---- */

/* The normals of `lanes` of a block, at least, from its triangles where self->place has them. */
void shading_gather(shading *self, uint32_t block, uint64_t lanes);
/* Bits: the vertices of a block of which no triangle has an area there. */
uint64_t shading_flat(const shading *self, uint32_t block);

#endif
