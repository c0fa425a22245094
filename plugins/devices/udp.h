/* plugins/devices/udp.h - UDP sockets that never wait longer than their deadline; the choice
 * between several senders; datagrams to one receiver. A socket is the system's file descriptor; -1:
 * none. Any thread, but one at a time for one owner or sender. Shared by inputs and face
 * outputs. */
#ifndef MAROTTE_DEVICES_UDP_H
#define MAROTTE_DEVICES_UDP_H
#include "trace.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { UDP_HOST = 128, UDP_REASON = 320 };

/* Parses [HOST:]PORT, HOST a name, an IPv4 or a bracketed IPv6 address. Returns false for any other
 * text. Without a host, out_host is unchanged. */
bool udp_address_parse(char out_host[UDP_HOST], uint16_t *out_port, const char *text,
                       size_t length);

typedef struct udp_peer {
    uint8_t ip[16]; /* IPv4 as ::ffff:a.b.c.d */
    uint16_t port;
} udp_peer;

/* Finds the address of a host; may query a name server. Returns false on failure, with the reason
 * in out_reason. */
bool udp_peer_resolve(udp_peer *out, const char *host, uint16_t port, char out_reason[UDP_REASON]);
enum { UDP_PEER_TEXT = 56 };
void udp_peer_text(const udp_peer *peer, char *out, size_t capacity); /* "10.0.0.2:4711" */

/* Opens a socket that receives on a numeric address of this computer. Returns -1 on failure, with
 * the reason and the advice in out_reason. */
int udp_bind(const char *host, uint16_t port, char out_reason[UDP_REASON]);
/* Opens a socket that sends there; may query a name server. */
int udp_connect(const char *host, uint16_t port, char out_reason[UDP_REASON]);
void udp_close(int socket);

enum { UDP_NOTHING = 0, UDP_FAILED = -1 };
/* Receives one datagram. Returns its size, at least 1; UDP_NOTHING if none arrived before
 * deadline_ns (device_clock_ns). */
int64_t udp_receive(int socket, void *out, size_t capacity, udp_peer *out_peer,
                    int64_t deadline_ns);
/* Sends without waiting. Returns 0 or an errno. ECONNREFUSED: it was sent, but an earlier datagram
 * had no listener. */
int udp_send(int socket, const void *bytes, size_t size);
/* The same, from a socket that receives. */
int udp_send_to(int socket, const udp_peer *to, const void *bytes, size_t size);
/* Makes the system keep its error reports for datagrams sent from this socket. udp_failure returns
 * them one at a time: an errno and the datagram's destination; 0: no more reports. */
void udp_keep_failures(int socket);
int udp_failure(int socket, udp_peer *out_to);

/* ---- near: this computer, and the networks it is connected to ---- */

typedef struct udp_net {
    uint8_t ip[16], mask[16]; /* of one of this computer's addresses, in the format of udp_peer */
} udp_net;

bool udp_peer_is_in(const udp_peer *peer, const udp_net *net, size_t count); /* any; pure */
bool udp_peer_is_near(const udp_peer *peer);
bool udp_is_own(const udp_peer *peer); /* an address of this computer */

/* ---- owner of one kind of data (a face, the angles of a hand, the pedals): of two senders the
 * first one, until it is silent for a second; pure ---- */

typedef struct udp_owner {
    bool known, established, former_known;
    udp_peer peer, former;
    int64_t heard_ns, former_heard_ns;
} udp_owner;

/* Returns true if the peer's data is used, and records its arrival. */
bool udp_owner_admits(udp_owner *owner, const udp_peer *peer, int64_t now_ns);
/* Like udp_owner_admits, but a program that sends once and exits, such as `oscsend`, does not block
 * others. A sender is established when it has sent twice within the second. */
bool udp_owner_admits_single(udp_owner *owner, const udp_peer *peer, int64_t now_ns);
/* Returns true if the peer is the owner. Does not record an arrival. */
bool udp_owner_is(const udp_owner *owner, const udp_peer *peer);
void udp_owner_release(udp_owner *owner);

/* ---- datagrams to one receiver, for face outputs: sent without waiting, with the errors that the
 * system reports about the receiver ---- */

typedef struct udp_sender {
    const mrt_host *host;
    int socket; /* -1: closed */
    char host_name[UDP_HOST];
    uint16_t port;
    int64_t refused_ns; /* last time that no program listened; 0: never */
    trace trace;
} udp_sender;

void udp_sender_init(udp_sender *self, const mrt_host *host);
/* address: [HOST:]PORT; "": that port of this computer. source: for MAROTTE_TRACE. Logs the reason
 * on failure. */
mrt_result udp_sender_open(udp_sender *self, const char *address, uint16_t port,
                           const char *source);
/* Returns MRT_OK; MRT_TIMEOUT: sent, but in the last second the receiving computer reported that no
 * program listens; MRT_ERR_IO, which is logged: the network failed. */
mrt_result udp_sender_send(udp_sender *self, const void *bytes, size_t size);
void udp_sender_close(udp_sender *self); /* can be called twice */

#endif
