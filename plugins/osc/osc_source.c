#include "osc_source.h"

#include <string.h>

/* A sample that is older by less is a late datagram; by more, the sender counts anew. */
enum { LATE_MAX = 1000, GAP_MAX = 1000000 };

static void forget(osc_source *source)
{
    source->has_table = false;
    source->started = false;
    clock_map_reset(&source->clock);
}

bool osc_source_admits(osc_source *source, const udp_peer *peer, int64_t now_ns)
{
    bool is_new = !udp_owner_is(&source->owner, peer);
    if (!udp_owner_admits(&source->owner, peer, now_ns))
        return false;
    if (is_new)
        forget(source);
    source->heard_ns = now_ns;
    return true;
}

void osc_source_take_table(osc_source *source, const osc_table *table)
{
    if (source->has_table && source->table.version == table->version &&
        osc_table_has(&source->table, table->channel, table->count))
        return;
    source->started = false;
    source->has_table = true;
    osc_table_copy(&source->table, table);
}

/* The sender's delay before sending is known exactly; only the way here is mapped. */
static int64_t measured_ns(osc_source *source, const osc_event *event, int64_t arrival_ns)
{
    int64_t sent_ns = clock_map_to_host(&source->clock, event->sent_ns, arrival_ns);
    int64_t time_ns = sent_ns - (event->sent_ns - event->time_ns);
    if (source->started && time_ns < source->time_ns)
        time_ns = source->time_ns;
    return time_ns;
}

osc_source_news osc_source_take_sample(osc_source *source, const osc_event *event,
                                       int64_t arrival_ns, uint32_t *out_step, int64_t *out_time_ns)
{
    if (!source->has_table || source->table.version != event->version)
        return OSC_SOURCE_UNTOLD;
    if (source->table.count != event->count)
        return OSC_SOURCE_MISSHAPEN;
    uint32_t ahead = event->sequence - source->sequence, behind = 0u - ahead;
    *out_step = 1;
    *out_time_ns = source->time_ns;
    if (source->started && ahead == 0)
        return OSC_SOURCE_DOUBLE;
    if (source->started && behind <= LATE_MAX)
        return OSC_SOURCE_LATE;
    if (source->started && ahead <= GAP_MAX)
        *out_step = ahead;
    source->time_ns = *out_time_ns = measured_ns(source, event, arrival_ns);
    source->sequence = event->sequence;
    source->started = true;
    return OSC_SOURCE_NEXT;
}

void osc_source_end(osc_source *source)
{
    udp_owner_release(&source->owner);
    forget(source);
}
