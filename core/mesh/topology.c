#include "mesh/topology.h"

#include "base/arrays.h"

#include <stdlib.h>

void topology_destroy(topology *t)
{
    if (!t)
        return;
    free(t->neighbour_start);
    free(t->neighbour);
    free(t->on_border);
    free(t->border_loop_start);
    free(t->border_vertex);
    free(t->rejected_triangle);
    *t = (topology){0};
}

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

mrt_result topology_pieces(uint32_t *out_piece, uint32_t *out_count, const mesh *m,
                           const topology *t, error *err)
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

mrt_result topology_copy(topology *out, const topology *t, error *err)
{
    copying c = {0};
    size_t count = t->vertex_count, loops = t->border_loop_count;
    *out = *t;
    out->neighbour_start =
        copy_array(&c, t->neighbour_start, count + 1, sizeof *t->neighbour_start);
    size_t links = t->neighbour_start ? t->neighbour_start[count] : 0;
    out->neighbour = copy_array(&c, t->neighbour, links, sizeof *t->neighbour);
    out->on_border = copy_array(&c, t->on_border, count, sizeof *t->on_border);
    out->border_loop_start =
        copy_array(&c, t->border_loop_start, loops + 1, sizeof *t->border_loop_start);
    size_t border = t->border_loop_start ? t->border_loop_start[loops] : 0;
    out->border_vertex = copy_array(&c, t->border_vertex, border, sizeof *t->border_vertex);
    out->rejected_triangle =
        copy_array(&c, t->rejected_triangle, t->rejected_count, sizeof *t->rejected_triangle);
    if (!c.failed)
        return MRT_OK;
    topology_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for the topology of the mesh");
}
