/* plugins/osc/osc_source.h - what is known of one source that another marotte forwards: its
 * channels, who sends it, which sample came last, and how the sender's clock stands to ours. Late
 * and double samples are found by their sequence. Pure. */
#ifndef MAROTTE_OSC_SOURCE_H
#define MAROTTE_OSC_SOURCE_H
#include "clock_map.h"
#include "osc_event.h"
#include "udp_owner.h"

typedef struct osc_source {
    char name[OSC_SOURCE_LENGTH]; /* "": unused */
    udp_owner owner;
    bool has_table, started;
    osc_table table;
    uint32_t sequence; /* of the newest sample */
    clock_map clock;   /* the sender's to ours */
    int64_t time_ns;   /* of the newest sample, our clock */
    int64_t heard_ns;  /* our clock */
} osc_source;

/* Whether this peer may speak for the source; a new one starts it afresh. */
bool osc_source_admits(osc_source *source, const udp_peer *peer, int64_t now_ns);
void osc_source_take_table(osc_source *source, const osc_table *table);

typedef enum osc_source_news {
    OSC_SOURCE_NEXT = 0, /* a newer sample */
    OSC_SOURCE_LATE,     /* older than one that came */
    OSC_SOURCE_DOUBLE,   /* the newest once more */
    OSC_SOURCE_UNTOLD,   /* its channels have not been told yet */
    OSC_SOURCE_MISSHAPEN /* another number of values than channels */
} osc_source_news;

/* Where the sample stands among those that came. out_step: by how much its sequence is ahead (1:
 * none was lost); out_time_ns: when it was measured, our clock. Both for OSC_SOURCE_NEXT; for
 * _DOUBLE out_time_ns alone. */
osc_source_news osc_source_take_sample(osc_source *source, const osc_event *event,
                                       int64_t arrival_ns, uint32_t *out_step,
                                       int64_t *out_time_ns);
void osc_source_end(osc_source *source); /* the sender said that it stops */

#endif
