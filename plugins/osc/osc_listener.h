/* plugins/osc/osc_listener.h - what one open input has heard: samples in a bounded queue, and the
 * state of the hand and pedals that messages tell piece by piece. Listens either to one forwarded
 * source, as it is, or to the simple messages of one hand. Knows no socket and no clock but the
 * times it is told (device_clock_ns). Not thread-safe: the port guards it. No allocation. */
#ifndef MAROTTE_OSC_LISTENER_H
#define MAROTTE_OSC_LISTENER_H
#include "osc_source.h"

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

/* ---- simple messages: one call an event, then one for the packet ---- */
/* False: another sender has this. */
bool osc_listener_take(osc_listener *self, const osc_event *event, const udp_peer *peer,
                       int64_t now_ns);
void osc_listener_end_packet(osc_listener *self, int64_t now_ns);

/* When the bones that have come are a frame at the latest; INT64_MAX: none have. */
int64_t osc_listener_frame_due_ns(const osc_listener *self);
/* Makes it one if it is due. */
void osc_listener_close_frame_if_due(osc_listener *self, int64_t now_ns);

/* ---- a forwarded source ---- */
bool osc_listener_wants(const osc_listener *self, const char *source);
void osc_listener_take_table(osc_listener *self, const osc_source *source);
void osc_listener_take_sample(osc_listener *self, const osc_event *event, uint32_t step,
                              int64_t time_ns, int64_t now_ns);
void osc_listener_take_sign_of_life(osc_listener *self, int64_t now_ns);
void osc_listener_take_end(osc_listener *self, int64_t now_ns);

/* The oldest item; false: none. When the queue is full the oldest goes, and the next one's step
 * says so. */
bool osc_listener_pop(osc_listener *self, osc_item *out);
/* The pedals are up until a message says otherwise. */
void osc_listener_release_pedals(osc_listener *self);

#endif
