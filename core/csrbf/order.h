/* csrbf/order.h - canonical orders of a set of points: along a Morton curve through the cube that
 * encloses them, which keeps neighbours close; or along their longest axis, which keeps the
 * envelope of their matrix small. Ties by x, y, z, then by row. The same set gives the same
 * sequence however it was numbered. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_ORDER_H
#define MAROTTE_CSRBF_ORDER_H
#include <stdint.h>

typedef struct order_item {
    uint64_t key;
    double at[3]; /* finite */
    uint32_t row;
} order_item;

/* Sort the items by their `at` and `row`; the keys are computed here. scratch: count. The second
 * returns the axis that it took. */
void order_sort(order_item *item, order_item *scratch, uint32_t count);
int order_sort_along(order_item *item, order_item *scratch, uint32_t count);

#endif
