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

static void sort_controls(merge *m, order_item *scratch, const double *centre)
{
    uint32_t count = m->control_count;
    for (uint32_t i = 0; i < count; ++i) {
        scratch[i].row = i;
        memcpy(scratch[i].at, centre + (size_t)3 * i, sizeof scratch[i].at);
    }
    order_sort(scratch, scratch + count, count);
    for (uint32_t i = 0; i < count; ++i)
        m->sorted[i] = scratch[i].row;
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

static void join_close(merge *m, const order_item *item, double distance)
{
    double limit = distance * distance;
    for (uint32_t i = 0; i < m->control_count; ++i) {
        m->group[i] = i;
        for (uint32_t j = 0; j < i; ++j) {
            double dx = item[i].at[0] - item[j].at[0];
            double dy = item[i].at[1] - item[j].at[1];
            double dz = item[i].at[2] - item[j].at[2];
            if (dx * dx + dy * dy + dz * dz > limit)
                continue;
            uint32_t a = root_of(m->group, i), b = root_of(m->group, j);
            if (a < b)
                m->group[b] = a;
            else
                m->group[a] = b;
        }
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
    sort_controls(m, scratch, centre);
    join_close(m, scratch, distance);
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
