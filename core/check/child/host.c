#include "check/child/host.h"
#include "base/clock.h"
#include "check/child/trap.h"

#include <stdio.h>
#include <string.h>

static const int64_t overshoot_ns = 3700000;

static void host_log(const mrt_host *plugin, int32_t level, const char *text)
{
    host *self = plugin->data;
    if (level < MRT_LOG_WARNING || !text)
        return;
    uint32_t kinds = trap_pause();
    self->error_count += 1;
    (void)snprintf(self->said, sizeof self->said, "%s", text);
    trap_resume(kinds);
}

int64_t host_now_ns(const host *self)
{
    return self->clock == HOST_REAL || self->clock == HOST_STOPPING ? clock_now_ns() : self->now_ns;
}

static int64_t plugin_now_ns(const mrt_host *plugin)
{
    trap_note(TRAP_HOST, "host->now_ns");
    uint32_t kinds = trap_pause();
    int64_t now_ns = host_now_ns(plugin->data);
    trap_resume(kinds);
    return now_ns;
}

static int64_t plugin_wait_until_ns(const mrt_host *plugin, int64_t time_ns)
{
    host *self = plugin->data;
    trap_note(TRAP_HOST, "host->wait_until_ns");
    uint32_t kinds = trap_pause();
    self->wait_count += 1;
    if (time_ns > self->latest_ask_ns)
        self->latest_ask_ns = time_ns;
    if (self->clock == HOST_REAL)
        clock_sleep_until_ns(time_ns);
    if (self->clock == HOST_JUMPING && time_ns > self->now_ns)
        self->now_ns = time_ns;
    if (self->clock == HOST_LATE && time_ns > self->now_ns)
        self->now_ns = time_ns > INT64_MAX - overshoot_ns ? time_ns : time_ns + overshoot_ns;
    int64_t now_ns = host_now_ns(self);
    trap_resume(kinds);
    return now_ns;
}

static void plugin_request_restart(const mrt_host *plugin)
{
    (void)plugin;
}

static const void *plugin_service(const mrt_host *plugin, const char *id)
{
    (void)plugin;
    (void)id;
    trap_note(TRAP_HOST, "host->service");
    return NULL;
}

void host_init(host *out, host_clock clock, int64_t start_ns)
{
    *out = (host){.clock = clock, .now_ns = start_ns};
    out->plugin = (mrt_host){
        out, host_log, plugin_now_ns, plugin_wait_until_ns, plugin_request_restart, plugin_service};
}

const char *host_words(const host *self, char out[300])
{
    (void)snprintf(out, 300, "%s%s", self->said[0] ? ": " : "", self->said);
    return out;
}
