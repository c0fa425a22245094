/* What is asked of an isolated mapping's process, and what happens when that fails. */
#include "stage/mapping/isolate_state.h"

#include <math.h>
#include <stdio.h>

bool isolate_call_runs(const mrt_plugin *self)
{
    return atomic_load(&self->phase) == ISOLATE_RUNNING;
}

/* ---- failing ---- */

void isolate_call_fail(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *held,
                       const char *reason)
{
    static const mrt_frame nothing = {0};
    isolate_fallback_begin(&self->fallback, frame ? frame : &nothing, held);
    (void)snprintf(self->reason, sizeof self->reason, "%s", reason);
    self->owed = 0;
    atomic_store(&self->phase, ISOLATE_FAILED);
    isolate_keeper_wake(self);
}

mrt_pull isolate_call_idle(void)
{
    mrt_pull out = {0};
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        out.dof[i] = NAN;
    return out;
}

/* ---- asking ---- */

mrt_result isolate_call_put(mrt_plugin *self, uint32_t kind, int64_t until_ns)
{
    self->has_saved = false;
    self->owed = kind;
    self->asked_cpu_ns = isolate_link_cpu_ns(&self->link);
    self->asked_ns = clock_now_ns();
    isolate_link_ask(&self->link, kind);
    mrt_result result = isolate_link_wait_until_ns(&self->link, until_ns);
    if (result == MRT_OK)
        self->owed = 0;
    return result;
}

mrt_result isolate_call_settle(mrt_plugin *self, int64_t until_ns)
{
    mrt_result result = self->owed ? isolate_link_wait_until_ns(&self->link, until_ns) : MRT_OK;
    if (result == MRT_OK)
        self->owed = 0;
    if (result != MRT_OK || !self->is_to_reset)
        return result;
    self->is_to_reset = false;
    return isolate_call_put(self, ISOLATE_RESET, until_ns);
}

mrt_result isolate_call_settled(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    mrt_result result = isolate_call_settle(self, until_ns);
    if (result == MRT_OK)
        result = isolate_call_put(self, kind, until_ns);
    isolate_link_drain(&self->link, self->host);
    return result;
}

mrt_result isolate_call_ask(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    mrt_pull idle = isolate_call_idle();
    if (!isolate_call_runs(self))
        return MRT_ERR_UNSUPPORTED;
    mrt_result result = isolate_call_settled(self, kind, patience_ns);
    if (result == MRT_OK)
        return self->link.block->result;
    const mrt_pull *held = self->has_held ? &self->held : &idle;
    isolate_call_fail(self, NULL, held, result == MRT_ERR_IO ? "ended" : "did not answer");
    return MRT_ERR_IO;
}
