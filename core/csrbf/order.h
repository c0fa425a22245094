/* csrbf/order.h - the canonical order of a set of points: along a Morton curve through the cube
 * that encloses them, ties by x, y, z, then by row. The same set gives the same sequence however
 * it was numbered. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_ORDER_H
#define MAROTTE_CSRBF_ORDER_H
#include <stdint.h>

typedef struct order_item {
    uint64_t key;
    double at[3]; /* finite */
    uint32_t row;
} order_item;

/* Sorts the items by their `at` and `row`; the keys are computed here. scratch: count. */
void order_sort(order_item *item, order_item *scratch, uint32_t count);

#endif
