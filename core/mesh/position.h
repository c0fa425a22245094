/* mesh/position.h - the position of a vertex as a vector. Pure. [any] */
#ifndef MAROTTE_MESH_POSITION_H
#define MAROTTE_MESH_POSITION_H
#include "base/rigid.h"
#include "mesh/mesh.h"

static inline vec3 mesh_position(const mesh *m, uint32_t vertex) /* mm */
{
    const float *at = m->position + 3 * (size_t)vertex;
    return (vec3){(double)at[0], (double)at[1], (double)at[2]};
}

#endif
