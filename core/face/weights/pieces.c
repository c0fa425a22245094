#include "face/weights/pieces.h"

#include <stdlib.h>

static void flood(uint32_t *piece, uint32_t *stack, uint32_t number, uint32_t from,
                  const topology *t)
{
    uint32_t depth = 0;
    stack[depth++] = from;
    piece[from] = number;
    while (depth > 0) {
        uint32_t v = stack[--depth];
        for (size_t e = t->neighbour_start[v]; e < t->neighbour_start[v + 1]; e++) {
            uint32_t other = t->neighbour[e];
            if (piece[other] != UINT32_MAX)
                continue;
            piece[other] = number;
            stack[depth++] = other;
        }
    }
}

mrt_result pieces_find(uint32_t *out_piece, uint32_t *out_count, const mesh *m, const topology *t,
                       error *err)
{
    uint32_t *stack = malloc((t->vertex_count + (size_t)1) * sizeof *stack);
    if (stack == NULL)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the pieces of %u vertices",
                         t->vertex_count);
    *out_count = 0;
    for (uint32_t v = 0; v < t->vertex_count; v++)
        out_piece[v] = UINT32_MAX;
    for (uint32_t v = 0; v < t->vertex_count; v++)
        if (out_piece[v] == UINT32_MAX && t->neighbour_start[v] < t->neighbour_start[v + 1])
            flood(out_piece, stack, (*out_count)++, v, t);
    for (uint32_t v = 0; v < t->vertex_count; v++)
        if (mesh_point(m, v) != v)
            out_piece[v] = out_piece[mesh_point(m, v)];
        else if (out_piece[v] == UINT32_MAX)
            out_piece[v] = *out_count;
    free(stack);
    return MRT_OK;
}
