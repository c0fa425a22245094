#include "base/slot.h"

enum { FRESH = 4, INDEX = 3 };

void slot_init(publish_slot *slot)
{
    slot->front = 0;
    atomic_init(&slot->middle, 1);
    slot->back = 2;
}

uint32_t slot_back(const publish_slot *slot)
{
    return slot->back;
}

void slot_publish(publish_slot *slot)
{
    slot->back =
        INDEX & atomic_exchange_explicit(&slot->middle, slot->back | FRESH, memory_order_acq_rel);
}

bool slot_receive(publish_slot *slot)
{
    if (!(atomic_load_explicit(&slot->middle, memory_order_relaxed) & FRESH))
        return false;
    slot->front =
        INDEX & atomic_exchange_explicit(&slot->middle, slot->front, memory_order_acq_rel);
    return true;
}

uint32_t slot_front(const publish_slot *slot)
{
    return slot->front;
}
