#include "mesh/topology.h"

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
