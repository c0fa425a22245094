/* plugins/osc/osc_dispatcher.h - passes the packets of one port to its listeners. A source is an
 * input that another marotte forwards. A listener is the state of one open input: a bounded queue
 * of samples, and the hand and pedals that messages describe in parts. The dispatcher counts
 * faults. It uses no socket and no clock: packets, peers and times (device_clock_ns) are arguments.
 * Not thread-safe: the port guards it. Only osc_wire allocates. */
#ifndef MAROTTE_OSC_DISPATCHER_H
#define MAROTTE_OSC_DISPATCHER_H
#include "device_io.h"
#include "osc_event.h"
#include "udp.h"

/* ---- a source that another marotte forwards: late and duplicate samples are detected by their
 * sequence ---- */

typedef struct osc_source {
    char name[OSC_SOURCE_LENGTH]; /* "": unused */
    udp_owner owner;
    bool has_table, started;
    osc_table table;
    uint32_t sequence; /* of the newest sample */
    clock_map clock;   /* from the sender's clock to ours */
    int64_t time_ns;   /* time of the newest sample, our clock */
    int64_t heard_ns;  /* our clock */
} osc_source;

/* ---- a listener: to one forwarded source, unchanged, or to the simple messages of one hand
 * ---- */

/* Channels of a listener to simple messages. */
typedef enum osc_content {
    OSC_CONTENT_PEDALS = 0, /* 22 angles, 4 pedals */
    OSC_CONTENT_WRIST,      /* 22 angles, position and orientation of the wrist */
    OSC_CONTENT_PEDALS_ONLY,
    OSC_CONTENT_CONTROLS /* MIDI controllers and keys from VMC messages */
} osc_content;

typedef struct osc_item {
    int64_t time_ns;
    uint32_t step; /* increase of the sequence; 1: no loss; 0: not a sample, but a release of the
                      pedals */
    float value[MRT_MAX_CHANNELS];
} osc_item;

enum { OSC_QUEUE_ITEMS = 256 };

typedef struct osc_listener {
    struct osc_listener *next; /* the port's list */

    bool is_forwarded;
    char wanted[OSC_SOURCE_LENGTH]; /* forwarded: wanted source; "": any; "log" also matches "log
                                       demo" */
    char bound[OSC_SOURCE_LENGTH];  /* forwarded: source found; "": none yet */
    uint32_t side;                  /* simple: hand */
    osc_content content;
    osc_table table; /* channels; count 0 while unknown */

    float angle[MRT_ANGLES], wrist[7], pedal[MRT_MAX_PEDALS];
    float control[OSC_CONTROLS];
    osc_vmc_pose pose;
    /* Bones arrive in several datagrams. They become a sample when a message ends the frame, when a
     * bone arrives again, or at frame_due_ns at the latest. */
    uint32_t frame_bones; /* bits of the bones received; 0: none */
    int64_t frame_ns, frame_due_ns, frame_tag_ns;
    udp_owner angle_owner, wrist_owner, pedal_owner, control_owner;
    clock_map clock; /* for senders with time tags */
    int64_t tag_ns;  /* of the current packet */
    bool is_touched; /* changed by the current packet */

    bool has_heard, has_sample;
    int64_t heard_ns, pedal_heard_ns; /* time of the last accepted message */
    bool is_adopted; /* it began with simple messages, and follows a source that was forwarded */
    bool has_ended;  /* forwarded: the sender announced its end */
    bool has_other_channels;        /* forwarded: they differ from `table` */
    osc_item item[OSC_QUEUE_ITEMS]; /* ring */
    uint32_t first, count;
} osc_listener;

void osc_listener_start_simple(osc_listener *self, uint32_t side, osc_content content);
void osc_listener_start_forwarded(osc_listener *self, const char *wanted);
/* Clears the queue and the losses but keeps the channels and the bound source: for a listener whose
 * sender was lost. */
void osc_listener_reset(osc_listener *self);

/* Returns the latest time at which the received bones become a frame; INT64_MAX: no bones. */
int64_t osc_listener_frame_due_ns(const osc_listener *self);
/* Ends the frame if it is due. */
void osc_listener_close_frame_if_due(osc_listener *self, int64_t now_ns);

/* Returns true if the listener wants this forwarded source. */
bool osc_listener_wants(const osc_listener *self, const char *source);
/* Removes the oldest item. Returns false if the queue is empty. A full queue drops its oldest item,
 * and the step of the next one counts it. */
bool osc_listener_pop(osc_listener *self, osc_item *out);
/* Releases the pedals until the next message. */
void osc_listener_release_pedals(osc_listener *self);

/* ---- the dispatcher ---- */

enum { OSC_SOURCES_MAX = 16 };

typedef struct osc_dispatcher {
    osc_source source[OSC_SOURCES_MAX];
    osc_listener *listeners;
    uint32_t fault_count[OSC_FAULT_KINDS];
    uint32_t late_count, double_count, untold_count; /* samples that were dropped */

    osc_event event; /* state of the packet being processed, with the following fields */
    const udp_peer *peer;
    int64_t now_ns;
    const mrt_host *host; /* logs the first fault of each kind */
} osc_dispatcher;

void osc_dispatcher_start(osc_dispatcher *self);
/* Adds a listener. One that joins late gets the current state of its source. */
void osc_dispatcher_join(osc_dispatcher *self, osc_listener *listener, int64_t now_ns);
void osc_dispatcher_leave(osc_dispatcher *self, osc_listener *listener);
/* Processes one packet; does not change `bytes`. Uses only host->log. */
void osc_dispatcher_process(osc_dispatcher *self, void *bytes, size_t size, const udp_peer *peer,
                            int64_t now_ns, const mrt_host *host);
/* Lists the forwarded sources that are not silent: "cyberglove ttyUSB0, pedal"; "": none. */
void osc_dispatcher_name_sources(const osc_dispatcher *self, int64_t now_ns, char *out,
                                 size_t capacity);

#endif
