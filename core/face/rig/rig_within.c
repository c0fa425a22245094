#include "face/rig/rig_within.h"

#include <math.h>
#include <stdlib.h>

typedef struct waiting { /* to be visited */
    double distance;
    uint32_t vertex;
} waiting;

typedef struct heap { /* the nearest first; ties by vertex */
    waiting *item;
    size_t count;
} heap;

static bool comes_first(waiting a, waiting b)
{
    return a.distance < b.distance || (!(a.distance > b.distance) && a.vertex < b.vertex);
}

static void heap_push(heap *h, waiting item)
{
    size_t at = h->count;
    h->count += 1;
    for (; at > 0 && comes_first(item, h->item[(at - 1) / 2]); at = (at - 1) / 2)
        h->item[at] = h->item[(at - 1) / 2];
    h->item[at] = item;
}

static waiting heap_pop(heap *h)
{
    waiting first = h->item[0];
    h->count -= 1;
    waiting last = h->item[h->count];
    size_t at = 0;
    for (;;) {
        size_t child = 2 * at + 1;
        if (child >= h->count)
            break;
        if (child + 1 < h->count && comes_first(h->item[child + 1], h->item[child]))
            child += 1;
        if (!comes_first(h->item[child], last))
            break;
        h->item[at] = h->item[child];
        at = child;
    }
    h->item[at] = last;
    return first;
}

static double edge_length(const mesh *m, uint32_t a, uint32_t b)
{
    const float *p = m->position + (size_t)a * 3, *q = m->position + (size_t)b * 3;
    double x = (double)p[0] - (double)q[0], y = (double)p[1] - (double)q[1];
    double z = (double)p[2] - (double)q[2];
    return sqrt(x * x + y * y + z * z);
}

/* A nearer way to a vertex, if it is one. */
static void reach(heap *h, double *out_distance, uint32_t vertex, double distance, double reach_mm)
{
    if (distance > reach_mm || !(distance < out_distance[vertex]))
        return;
    out_distance[vertex] = distance;
    heap_push(h, (waiting){distance, vertex});
}

bool rig_within_starts(double *out_distance, const rig_start *start, uint32_t start_count,
                       double reach_mm, const mesh *m, const topology *t, const uint32_t *twin)
{
    /* Each edge and twin pushes at most once in each direction. */
    size_t push_max = t->neighbour_start[t->vertex_count] + (twin ? t->vertex_count : 0u);
    heap h = {.item = malloc((push_max + start_count + 1) * sizeof *h.item)};
    if (!h.item)
        return false;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        out_distance[v] = (double)INFINITY;
    for (uint32_t i = 0; i < start_count; ++i)
        reach(&h, out_distance, start[i].vertex, start[i].distance_mm, reach_mm);
    while (h.count > 0) {
        waiting at = heap_pop(&h);
        if (at.distance > out_distance[at.vertex])
            continue;
        for (uint32_t i = t->neighbour_start[at.vertex]; i < t->neighbour_start[at.vertex + 1];
             ++i) {
            uint32_t next = t->neighbour[i];
            reach(&h, out_distance, next, at.distance + edge_length(m, at.vertex, next), reach_mm);
        }
        if (twin)
            reach(&h, out_distance, twin[at.vertex], at.distance, reach_mm);
    }
    free(h.item);
    return true;
}

bool rig_within(double *out_distance, uint32_t from, double reach_mm, const mesh *m,
                const topology *t)
{
    rig_start start = {from, 0.0};
    return rig_within_starts(out_distance, &start, 1, reach_mm, m, t, NULL);
}
