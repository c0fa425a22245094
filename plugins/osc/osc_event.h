/* plugins/osc/osc_event.h - one OSC message as what it says about hands, pedals or a forwarded
 * source; checked in full, so that who uses it need not. README.md documents every message. Pure.
 */
#ifndef MAROTTE_OSC_EVENT_H
#define MAROTTE_OSC_EVENT_H
#include "osc_table.h"
#include "osc_wire.h"
#include "osc_vmc.h"
#include "osc_wire.h"

typedef enum osc_event_kind {
    OSC_EVENT_NONE = 0, /* known and of no use here, as most of VMC */
    OSC_EVENT_ANGLES,   /* side; `count` values from sensor `first` on, rad */
    OSC_EVENT_WRIST,    /* side; 7 values */
    OSC_EVENT_PEDAL,    /* `first` 0..3; 1 value, 0 up .. 1 down */
    OSC_EVENT_BONE,     /* bone; 4 values, a quaternion x y z w */
    OSC_EVENT_FRAME,    /* the bones of a frame have all been told */
    OSC_EVENT_CONTROL,  /* `first` of the controls; 1 value, 0..1 */
    OSC_EVENT_CHANNELS, /* table */
    OSC_EVENT_SAMPLE,   /* source, version, sequence, time_ns, sent_ns; `count` values */
    OSC_EVENT_END       /* source, version */
} osc_event_kind;

/* Times of senders' clocks are within +-this, so that no difference overflows. */
static const int64_t OSC_TIME_MAX_NS = INT64_C(1) << 61;

/* Controls: MIDI controllers 0 to 31, then the keys A to Z. */
enum { OSC_CONTROLLERS = 32, OSC_KEYS = 26, OSC_CONTROLS = OSC_CONTROLLERS + OSC_KEYS };

typedef struct osc_event {
    osc_event_kind kind;
    uint32_t side, first, count;
    float value[MRT_MAX_CHANNELS];
    osc_vmc_bone bone;
    int64_t tag_ns; /* of its bundle, or OSC_NO_TIME */
    char source[OSC_SOURCE_LENGTH];
    int32_t version;
    uint32_t sequence;
    int64_t time_ns, sent_ns; /* sender's clock; sent_ns >= time_ns */
    osc_table table;
    const char *expected; /* what a faulty message should have been; a literal */
} osc_event;

/* On a fault `expected` says what would have been right. */
osc_fault osc_event_read(osc_event *out, const osc_message *message);

#endif
