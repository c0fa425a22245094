#include "base/clock.h"
#include "stage/live/live_state.h"

/* How long [main] sleeps at a time while the frame thread is busy. */
static const int64_t patience_ns = 50 * NS_PER_MS;

static void obey(live *self, live_order *order)
{
    order->result = order->run(&self->stage, order->data, order->err);
}

mrt_result live_ask(live *self, live_order_run *run, void *data, error *err)
{
    live_order order = {.run = run, .data = data, .err = err};
    if (!self->has_thread) {
        obey(self, &order);
        return order.result;
    }
    atomic_store(&self->order, &order);
    wake_signal(player_wake(self->stage.loop));
    for (;;) {
        uint32_t seen = wake_seen(&self->answered);
        if (!atomic_load(&self->order))
            return order.result;
        wake_wait_until_ns(&self->answered, seen, clock_now_ns() + patience_ns);
    }
}

void live_obey(live *self)
{
    live_order *order = atomic_load(&self->order);
    if (!order)
        return;
    obey(self, order);
    atomic_store(&self->order, NULL); /* it is [main]'s again */
    wake_signal(&self->answered);
}
