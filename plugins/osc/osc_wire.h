/* plugins/osc/osc_wire.h - conversion between OSC 1.0 packets and messages; the only file that uses
 * liblo. The bytes are not trusted. Leaves out the meaning of messages (osc_event.h) and sockets
 * (udp.h: liblo's own servers cannot listen on one address only, wait with a deadline or send
 * without waiting). Any thread. */
#ifndef MAROTTE_OSC_WIRE_H
#define MAROTTE_OSC_WIRE_H
#include "udp.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Faults in received messages. Each kind is counted, and logged once. */
typedef enum osc_fault {
    OSC_FAULT_NONE = 0,
    OSC_FAULT_PACKET,  /* no OSC */
    OSC_FAULT_SIZE,    /* valid OSC, but too large */
    OSC_FAULT_ADDRESS, /* unknown message */
    OSC_FAULT_TYPES,   /* wrong types or number of arguments */
    OSC_FAULT_VALUE,   /* not finite, or out of range */
    OSC_FAULT_SENDER,  /* two senders of the same data */
    OSC_FAULT_SOURCES, /* too many sources */
    OSC_FAULT_KINDS
} osc_fault;

enum {
    OSC_PACKET_MAX = 65536, /* bytes; more than a UDP datagram holds */
    OSC_ARGUMENTS_MAX = 256,
    OSC_MESSAGES_MAX = 512, /* of one packet */
    OSC_DEPTH_MAX = 4       /* depth of nested bundles */
};

/* Time tag of a message without one, or with "immediately". */
static const int64_t OSC_NO_TIME = INT64_MIN;

typedef struct osc_message { /* valid during the callback */
    const char *address;     /* 0-ended; begins with '/' */
    const char *types;       /* 0-ended, without the comma; one letter per argument */
    uint32_t count;          /* of arguments */
    int64_t tag_ns;          /* the bundle's time tag as ns since 1970, or OSC_NO_TIME */
    void **argument;         /* liblo's */
} osc_message;

typedef void osc_wire_take(void *context, const osc_message *message);

/* Calls back for each message of the packet in order. Stops at the first fault, after the messages
 * before it. Allocates for each message. Does not change `bytes`. */
osc_fault osc_wire_read(void *bytes, size_t size, osc_wire_take *take, void *context);

/* Reads the argument if it has exactly this type. */
bool osc_message_int32(const osc_message *message, uint32_t index, int32_t *out);
bool osc_message_int64(const osc_message *message, uint32_t index, int64_t *out);
bool osc_message_float(const osc_message *message, uint32_t index, float *out);
const char *osc_message_text(const osc_message *message, uint32_t index); /* NULL: it is none */
/* Reads a number of any type (i h f d), or true and false as 1 and 0. */
bool osc_message_number(const osc_message *message, uint32_t index, double *out);

/* Builder of one message; arguments are added in order. */
typedef struct osc_builder {
    void *message;
    bool failed;
} osc_builder;
osc_builder osc_builder_start(void);
void osc_builder_int32(osc_builder *builder, int32_t value);
void osc_builder_int64(osc_builder *builder, int64_t value);
void osc_builder_float(osc_builder *builder, float value);
void osc_builder_text(osc_builder *builder, const char *text);
/* Finishes the builder in any case. Returns the packet's size; 0 if out of memory or larger than
 * `capacity`. */
size_t osc_builder_finish(osc_builder *builder, const char *address, void *out, size_t capacity);

/* ---- messages to one receiver, in bundles that fit a datagram of any network. One thread at a
 * time for one sender ---- */

enum { OSC_BUNDLE_MAX = 1400 }; /* bytes: under an Ethernet frame's 1 500 with its headers */

typedef struct osc_sender {
    udp_sender to; /* opened and closed by the caller */
    unsigned char bundle[OSC_BUNDLE_MAX];
    size_t size; /* 0: no open bundle */
    uint64_t tag;
    mrt_result worst; /* of the bundles of this frame */
} osc_sender;

/* Begins a frame. utc_ns: time tag of its bundles, ns since 1970; OSC_NO_TIME: immediately. */
void osc_sender_begin(osc_sender *self, int64_t utc_ns);
/* Adds the finished message. Sends the current bundle first if the message does not fit. */
void osc_sender_add(osc_sender *self, osc_builder *message, const char *address);
/* Sends the last bundle. Returns the worst result of the frame, like udp_sender_send. */
mrt_result osc_sender_end(osc_sender *self);

#endif
