/* plugins/osc/osc_wire.h - OSC 1.0 packets as messages, and messages as packets: the one place that
 * knows liblo. Nobody has checked the bytes. Leaves out what messages mean (osc_event.h) and
 * sockets (udp.h: liblo's own servers cannot listen on one address alone, wait with a deadline or
 * send without waiting). Any thread. */
#ifndef MAROTTE_OSC_WIRE_H
#define MAROTTE_OSC_WIRE_H
#include "udp.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What can be wrong with what others send. Each kind is counted, and said once. */
typedef enum osc_fault {
    OSC_FAULT_NONE = 0,
    OSC_FAULT_PACKET,  /* no OSC */
    OSC_FAULT_SIZE,    /* OSC, but more of it than anybody sends */
    OSC_FAULT_ADDRESS, /* a message that nobody here knows */
    OSC_FAULT_TYPES,   /* arguments of other types, or another number of them */
    OSC_FAULT_VALUE,   /* not finite, or out of range */
    OSC_FAULT_SENDER,  /* two senders for one thing */
    OSC_FAULT_SOURCES, /* more sources than there is room for */
    OSC_FAULT_KINDS
} osc_fault;

enum {
    OSC_PACKET_MAX = 65536, /* bytes; more than a UDP datagram holds */
    OSC_ARGUMENTS_MAX = 256,
    OSC_MESSAGES_MAX = 512, /* of one packet */
    OSC_DEPTH_MAX = 4       /* of bundles within bundles */
};

/* The time tag of a message that has none, or that is "immediately". */
static const int64_t OSC_NO_TIME = INT64_MIN;

typedef struct osc_message { /* valid during the call that hands it over */
    const char *address;     /* 0-ended; begins with '/' */
    const char *types;       /* 0-ended, without the comma; one letter an argument */
    uint32_t count;          /* of arguments */
    int64_t tag_ns;          /* the bundle's time tag as ns since 1970, or OSC_NO_TIME */
    void **argument;         /* liblo's */
} osc_message;

typedef void osc_wire_take(void *context, const osc_message *message);

/* Hands over each message of the packet in its order. The first fault ends it; messages before it
 * have been handed over. Allocates for each message. `bytes` are not changed. */
osc_fault osc_wire_read(void *bytes, size_t size, osc_wire_take *take, void *context);

/* The argument, if it is of exactly this type. */
bool osc_message_int32(const osc_message *message, uint32_t index, int32_t *out);
bool osc_message_int64(const osc_message *message, uint32_t index, int64_t *out);
bool osc_message_float(const osc_message *message, uint32_t index, float *out);
const char *osc_message_text(const osc_message *message, uint32_t index); /* NULL: it is none */
/* A number of any type (i h f d), or true and false as 1 and 0. */
bool osc_message_number(const osc_message *message, uint32_t index, double *out);

/* Writes one message; arguments are added in order. */
typedef struct osc_builder {
    void *message;
    bool failed;
} osc_builder;
osc_builder osc_builder_start(void);
void osc_builder_int32(osc_builder *builder, int32_t value);
void osc_builder_int64(osc_builder *builder, int64_t value);
void osc_builder_float(osc_builder *builder, float value);
void osc_builder_text(osc_builder *builder, const char *text);
/* Ends it whatever happens; returns the packet's size, 0: no memory or more than `capacity`. */
size_t osc_builder_finish(osc_builder *builder, const char *address, void *out, size_t capacity);

/* ---- messages to one place, in bundles that fit a datagram of any network. One thread at a time
 * for one sender ---- */

enum { OSC_BUNDLE_MAX = 1400 }; /* bytes: under an Ethernet frame's 1 500 with its headers */

typedef struct osc_sender {
    udp_sender to; /* opened and closed as such */
    unsigned char bundle[OSC_BUNDLE_MAX];
    size_t size; /* 0: no bundle is begun */
    uint64_t tag;
    mrt_result worst; /* of the bundles of this frame */
} osc_sender;

/* A frame begins; utc_ns: of its bundles' time tags, ns since 1970; OSC_NO_TIME: immediately. */
void osc_sender_begin(osc_sender *self, int64_t utc_ns);
/* Ends the message. A bundle that it does not fit into is sent before it. */
void osc_sender_add(osc_sender *self, osc_builder *message, const char *address);
/* Sends what is left: as udp_sender_send, the worst of the frame. */
mrt_result osc_sender_end(osc_sender *self);

#endif
