/* plugins/devices/udp.h - UDP sockets that never wait longer than they are told. Sockets are the
 * system's file numbers; -1 is none. Any thread. Shared by input plugins. */
#ifndef MAROTTE_DEVICES_UDP_H
#define MAROTTE_DEVICES_UDP_H
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

bool udp_peer_equals(const udp_peer *a, const udp_peer *b);
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
/* The same from a socket that receives, to an address in numbers. */
int udp_send_to(int socket, const char *host, uint16_t port, const void *bytes, size_t size);

#endif
