/* plugins/osc/osc_dispatcher.h - what packets that come in at one port say, handed to who listens
 * there. A source is what another marotte forwards; a listener is what one open input has heard:
 * samples in a bounded queue, and the state of the hand and pedals that messages tell piece by
 * piece. The dispatcher counts what was wrong. Knows no socket and no clock: packets, peers and
 * times (device_clock_ns) are told. Not thread-safe: the port guards it. No allocation but
 * osc_wire's. */
#ifndef MAROTTE_OSC_DISPATCHER_H
#define MAROTTE_OSC_DISPATCHER_H
#include "device_io.h"
#include "osc_event.h"
#include "udp.h"

/* ---- a source that another marotte forwards: late and double samples are found by their sequence
 * ---- */

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

/* ---- a listener: to one forwarded source, as it is, or to the simple messages of one hand ---- */

/* What a listener to simple messages gives as channels. */
typedef enum osc_content {
    OSC_CONTENT_PEDALS = 0, /* 22 angles, 4 pedals */
    OSC_CONTENT_WRIST,      /* 22 angles, position and orientation of the wrist */
    OSC_CONTENT_PEDALS_ONLY,
    OSC_CONTENT_CONTROLS /* MIDI controllers and keys, as VMC tells them */
} osc_content;

typedef struct osc_item {
    int64_t time_ns;
    uint32_t step; /* of the sequence, 1: nothing lost before it; 0: no sample, the pedals go up */
    float value[MRT_MAX_CHANNELS];
} osc_item;

enum { OSC_QUEUE_ITEMS = 256 };

typedef struct osc_listener {
    struct osc_listener *next; /* the port's list */

    bool is_forwarded;
    char wanted[OSC_SOURCE_LENGTH]; /* forwarded: which source; "" any, "log" also "log demo" */
    char bound[OSC_SOURCE_LENGTH];  /* forwarded: the one found; "" none yet */
    uint32_t side;                  /* simple: whose hand */
    osc_content content;
    osc_table table; /* channels; count 0 while not known */

    float angle[MRT_ANGLES], wrist[7], pedal[MRT_MAX_PEDALS];
    float control[OSC_CONTROLS];
    osc_vmc_pose pose;
    /* Bones come in several datagrams: a sample is made of them when the frame is told to be over,
     * a bone comes again, or no later than frame_due_ns. */
    uint32_t frame_bones; /* which of them have come; 0: none */
    int64_t frame_ns, frame_due_ns, frame_tag_ns;
    udp_owner angle_owner, wrist_owner, pedal_owner, control_owner;
    clock_map clock; /* of senders who tag bundles with the time */
    int64_t tag_ns;  /* of the packet being taken */
    bool is_touched; /* by the packet being taken */

    bool has_heard, has_sample;
    int64_t heard_ns, pedal_heard_ns; /* the last time anything counted */
    bool has_ended;                   /* forwarded: the sender said that it stops */
    bool has_other_channels;          /* forwarded: they are not those of `table` any more */
    osc_item item[OSC_QUEUE_ITEMS];   /* ring */
    uint32_t first, count;
} osc_listener;

void osc_listener_start_simple(osc_listener *self, uint32_t side, osc_content content);
void osc_listener_start_forwarded(osc_listener *self, const char *wanted);
/* Forgets what is in the queue and what was lost, keeps channels and the bound source: for a
 * listener whose sender went away. */
void osc_listener_rearm(osc_listener *self);

/* When the bones that have come are a frame at the latest; INT64_MAX: none have. */
int64_t osc_listener_frame_due_ns(const osc_listener *self);
/* Makes it one if it is due. */
void osc_listener_close_frame_if_due(osc_listener *self, int64_t now_ns);

/* Whether it wants this source of another marotte. */
bool osc_listener_wants(const osc_listener *self, const char *source);
/* The oldest item; false: none. When the queue is full the oldest goes, and the next one's step
 * says so. */
bool osc_listener_pop(osc_listener *self, osc_item *out);
/* The pedals are up until a message says otherwise. */
void osc_listener_release_pedals(osc_listener *self);

/* ---- the dispatcher ---- */

enum { OSC_SOURCES_MAX = 16 };

typedef struct osc_dispatcher {
    osc_source source[OSC_SOURCES_MAX];
    osc_listener *listeners;
    uint32_t fault_count[OSC_FAULT_KINDS];
    uint32_t late_count, double_count, untold_count; /* samples that were dropped */

    osc_event event; /* of the packet being taken, and what follows */
    const udp_peer *peer;
    int64_t now_ns;
    const mrt_host *host; /* to whom the first fault of each kind is said */
} osc_dispatcher;

void osc_dispatcher_start(osc_dispatcher *self);
/* A listener that joins late learns what is known of the source that it wants. */
void osc_dispatcher_join(osc_dispatcher *self, osc_listener *listener, int64_t now_ns);
void osc_dispatcher_leave(osc_dispatcher *self, osc_listener *listener);
/* Takes one packet; `bytes` are not changed. Only host->log is used. */
void osc_dispatcher_take(osc_dispatcher *self, void *bytes, size_t size, const udp_peer *peer,
                         int64_t now_ns, const mrt_host *host);
/* "cyberglove ttyUSB0, pedal": who is forwarded here and not silent; "" nobody. */
void osc_dispatcher_name_sources(const osc_dispatcher *self, int64_t now_ns, char *out,
                                 size_t capacity);

#endif
