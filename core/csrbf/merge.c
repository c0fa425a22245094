#include "csrbf/merge.h"

#include <stdlib.h>
#include <string.h>

bool merge_create(merge *out, uint32_t control_capacity)
{
    size_t room = (size_t)control_capacity + 1;
    *out = (merge){0};
    out->sorted = calloc(room, sizeof *out->sorted);
    out->group = calloc(room, sizeof *out->group);
    out->share = calloc(room, sizeof *out->share);
    if (out->sorted && out->group && out->share)
        return true;
    merge_destroy(out);
    return false;
}

void merge_destroy(merge *m)
{
    if (!m)
        return;
    free(m->sorted);
    free(m->group);
    free(m->share);
    *m = (merge){0};
}

/* Those of one class, from item[first] on; returns where they end. */
static uint32_t sort_class(order_item *item, uint32_t first, const merge *m, const double *centre,
                           const csrbf_class *class, csrbf_class wanted)
{
    uint32_t end = first;
    for (uint32_t control = 0; control < m->control_count; ++control)
        if ((class ? class[control] : CSRBF_TIP) == wanted) {
            item[end].row = control;
            memcpy(item[end].at, centre + (size_t)3 * control, sizeof item[end].at);
            ++end;
        }
    order_item *scratch = item + m->control_count;
    if (end - first <= MRT_MAX_VECTORS) /* as many as a mapping can pull at */
        order_sort(item + first, scratch, end - first);
    else
        order_sort_along(item + first, scratch, end - first);
    return end;
}

static void sort_controls(merge *m, order_item *item, const double *centre,
                          const csrbf_class *class)
{
    uint32_t end = sort_class(item, 0, m, centre, class, CSRBF_SKULL);
    end = sort_class(item, end, m, centre, class, CSRBF_JAW);
    end = sort_class(item, end, m, centre, class, CSRBF_TIP);
    for (uint32_t i = 0; i < end; ++i)
        m->sorted[i] = item[i].row;
}

/* While components are joined, group[] holds for each place in the order an earlier place of its
 * component; the component's root holds itself. */
static uint32_t root_of(uint32_t *group, uint32_t place)
{
    while (group[place] != place) {
        group[place] = group[group[place]];
        place = group[place];
    }
    return place;
}

static void join(uint32_t *group, uint32_t place, uint32_t other)
{
    uint32_t a = root_of(group, place), b = root_of(group, other);
    if (a < b)
        group[b] = a;
    else
        group[a] = b;
}

static bool is_close(const order_item *a, const order_item *b, double limit)
{
    double dx = a->at[0] - b->at[0], dy = a->at[1] - b->at[1], dz = a->at[2] - b->at[2];
    return dx * dx + dy * dy + dz * dz <= limit;
}

/* Looks along the longest axis: of each one backwards, as far as any can be close. */
static void join_close(merge *m, const order_item *item, order_item *scratch, double distance)
{
    const double limit = distance * distance;
    for (uint32_t place = 0; place < m->control_count; ++place) {
        m->group[place] = place;
        scratch[place] = item[place];
        scratch[place].row = place;
    }
    int axis = order_sort_along(scratch, scratch + m->control_count, m->control_count);
    for (uint32_t i = 0; i < m->control_count; ++i)
        for (uint32_t k = i; k-- > 0;) {
            double way = scratch[i].at[axis] - scratch[k].at[axis];
            if (way * way > limit)
                break;
            if (is_close(&scratch[i], &scratch[k], limit))
                join(m->group, scratch[i].row, scratch[k].row);
        }
}

/* Group numbers by the place of their roots; item[].key becomes the group of each control. */
static void number_groups(merge *m, order_item *item)
{
    m->group_count = 0;
    for (uint32_t i = 0; i < m->control_count; ++i)
        if (root_of(m->group, i) == i)
            item[i].key = m->group_count++;
        else
            item[i].key = item[root_of(m->group, i)].key;
    for (uint32_t i = 0; i < m->control_count; ++i)
        m->group[item[i].row] = (uint32_t)item[i].key;
}

static void share_out(merge *m, order_item *scratch, const csrbf_class *class)
{
    /* Of each group g: scratch[g].row its highest class, scratch[g].key its members of it. */
    for (uint32_t g = 0; g < m->group_count; ++g)
        scratch[g] = (order_item){0};
    for (uint32_t control = 0; control < m->control_count; ++control) {
        order_item *group = &scratch[m->group[control]];
        uint32_t rank = class ? (uint32_t) class[control] : 0;
        if (rank > group->row)
            *group = (order_item){.row = rank};
        group->key += rank == group->row;
    }
    for (uint32_t control = 0; control < m->control_count; ++control) {
        const order_item *group = &scratch[m->group[control]];
        uint32_t rank = class ? (uint32_t) class[control] : 0;
        m->share[control] = rank == group->row ? 1.0 / (double)group->key : 0.0;
    }
}

void merge_find(merge *m, order_item *scratch, const double *centre, const csrbf_class *class,
                uint32_t count, double distance)
{
    m->control_count = count;
    sort_controls(m, scratch, centre, class);
    join_close(m, scratch, scratch + count, distance);
    number_groups(m, scratch);
    share_out(m, scratch, class);
}

void merge_means(const merge *m, double *out, uint32_t stride, const double *value)
{
    memset(out, 0, (size_t)m->group_count * stride * sizeof *out);
    for (uint32_t i = 0; i < m->control_count; ++i) {
        uint32_t control = m->sorted[i];
        double *mean = out + (size_t)m->group[control] * stride;
        for (size_t axis = 0; axis < 3; ++axis)
            mean[axis] += value[(size_t)3 * control + axis] * m->share[control];
    }
}
