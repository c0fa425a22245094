/* plugins/devices/udp.h - UDP sockets that never wait longer than they are told; who of several
 * senders counts; datagrams to one place. Sockets are the system's file numbers; -1 is none. Any
 * thread, but one at a time for one owner or sender. Shared by inputs and face outputs. */
#ifndef MAROTTE_DEVICES_UDP_H
#define MAROTTE_DEVICES_UDP_H
#include "trace.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { UDP_HOST = 128, UDP_REASON = 320 };

/* [HOST:]PORT, HOST a name, an IPv4 or a bracketed IPv6 address. False: it is no such text. Without
 * a host out_host stays as it is. */
bool udp_address_parse(char out_host[UDP_HOST], uint16_t *out_port, const char *text,
                       size_t length);

typedef struct udp_peer {
    uint8_t ip[16]; /* IPv4 as ::ffff:a.b.c.d */
    uint16_t port;
} udp_peer;

/* The address of a host; may ask a name server. False: out_reason says why. */
bool udp_peer_find(udp_peer *out, const char *host, uint16_t port, char out_reason[UDP_REASON]);
enum { UDP_PEER_TEXT = 56 };
void udp_peer_text(const udp_peer *peer, char *out, size_t capacity); /* "10.0.0.2:4711" */

/* A socket that receives at an address of this computer, in numbers. -1: out_reason says why, and
 * what to do. */
int udp_bind(const char *host, uint16_t port, char out_reason[UDP_REASON]);
/* A socket that sends there; may ask a name server. */
int udp_connect(const char *host, uint16_t port, char out_reason[UDP_REASON]);
void udp_close(int socket);

enum { UDP_NOTHING = 0, UDP_FAILED = -1 };
/* One datagram's size, from 1 on; UDP_NOTHING: none before deadline_ns (device_clock_ns). */
int64_t udp_receive(int socket, void *out, size_t capacity, udp_peer *out_peer,
                    int64_t deadline_ns);
/* Sends without waiting. 0 or an errno; ECONNREFUSED: it was sent, but at an earlier datagram's end
 * nobody listened. */
int udp_send(int socket, const void *bytes, size_t size);
/* The same from a socket that receives. */
int udp_send_to(int socket, const udp_peer *to, const void *bytes, size_t size);
/* From now on the system keeps what it learns about datagrams that were sent from this socket:
 * udp_failure is an errno and where that datagram went, one at a time; 0: nothing more. */
void udp_keep_failures(int socket);
int udp_failure(int socket, udp_peer *out_to);

/* ---- near: this computer, and the networks that it is in itself ---- */

typedef struct udp_net {
    uint8_t ip[16], mask[16]; /* of one of this computer's addresses, as udp_peer's */
} udp_net;

bool udp_peer_is_in(const udp_peer *peer, const udp_net *net, size_t count); /* any; pure */
bool udp_peer_is_near(const udp_peer *peer);
bool udp_is_own(const udp_peer *peer); /* an address of this computer */

/* ---- who may send one thing (a face, the angles of a hand, the pedals): of two senders at a time
 * the first, until it has been silent for a second; pure ---- */

typedef struct udp_owner {
    bool known, established, former_known;
    udp_peer peer, former;
    int64_t heard_ns, former_heard_ns;
} udp_owner;

/* Whether what the peer sends now counts; if so it has been heard. */
bool udp_owner_admits(udp_owner *owner, const udp_peer *peer, int64_t now_ns);
/* As above, but a program that sends once and is gone, as `oscsend` does, holds nothing: a sender
 * is established when it has sent twice within the second. */
bool udp_owner_admits_single(udp_owner *owner, const udp_peer *peer, int64_t now_ns);
/* Whether the peer is the one that counts, without hearing it. */
bool udp_owner_is(const udp_owner *owner, const udp_peer *peer);
void udp_owner_release(udp_owner *owner);

/* ---- datagrams to one place, for face outputs: opened, sent without waiting, and what that tells
 * about the other side ---- */

typedef struct udp_sender {
    const mrt_host *host;
    int socket; /* -1: closed */
    char host_name[UDP_HOST];
    uint16_t port;
    int64_t refused_ns; /* when nobody listened last; 0: never */
    trace trace;
} udp_sender;

void udp_sender_init(udp_sender *self, const mrt_host *host);
/* address: [HOST:]PORT; "": that port of this computer. source: for MAROTTE_TRACE. Says why not. */
mrt_result udp_sender_open(udp_sender *self, const char *address, uint16_t port,
                           const char *source);
/* MRT_OK; MRT_TIMEOUT: sent, but in the last second that computer has said that nobody listens;
 * MRT_ERR_IO, said: the network is gone. */
mrt_result udp_sender_send(udp_sender *self, const void *bytes, size_t size);
void udp_sender_close(udp_sender *self); /* again is fine */

#endif
