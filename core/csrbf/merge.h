/* csrbf/merge.h - puts controls in canonical order and joins those that coincide: connected
 * components of "not further apart than a distance". Of a component only the members of its
 * highest class count; it stands at their mean, and moves by the mean of their displacements.
 * The order: the skull, then the jaw, then the tips, so that what a factor says of pins does not
 * depend on tips; of each class few along a Morton curve, and many along their longest axis: for
 * centres all over a head the factorisation then has half as much to do as along the curve, and two
 * thirds of what it has after reverse Cuthill-McKee.
 * Inside the room; the memory is its only state. */
#ifndef MAROTTE_CSRBF_MERGE_H
#define MAROTTE_CSRBF_MERGE_H
#include "csrbf/csrbf.h"
#include "csrbf/order.h"

typedef struct merge {
    uint32_t control_count, group_count;
    uint32_t *sorted; /* control_count: the controls in canonical order */
    uint32_t *group;  /* of each control; groups are in canonical order too */
    double *share;    /* of each control in its group's mean: 1 / members that count, or 0 */
} merge;

bool merge_create(merge *out, uint32_t control_capacity); /* false: no memory */
void merge_destroy(merge *m);

/* centre: count by 3, finite. class: count, or NULL. scratch: three times count. */
void merge_find(merge *m, order_item *scratch, const double *centre, const csrbf_class *class,
                uint32_t count, double distance);
/* Means of the controls' rows of 3: out is group_count by stride, its further columns are 0. */
void merge_means(const merge *m, double *out, uint32_t stride, const double *value);

#endif
