/* plugins/osc/osc_socket.h - UDP sockets that never wait longer than they are told. Sockets are the
 * system's file numbers; -1 is none. Any thread. */
#ifndef MAROTTE_OSC_SOCKET_H
#define MAROTTE_OSC_SOCKET_H
#include "osc_owner.h"
#include "osc_place.h"

enum { OSC_REASON = 320 };

/* A socket that receives at the place's host (an address of this computer) and port. -1: out_reason
 * says why, and what to do. */
int osc_socket_bind(const osc_place *place, char *out_reason);
/* A socket that sends there; may ask a name server. */
int osc_socket_connect(const osc_place *place, char *out_reason);
void osc_socket_close(int socket);

enum { OSC_SOCKET_NOTHING = 0, OSC_SOCKET_FAILED = -1 };
/* One datagram's size, from 1 on; OSC_SOCKET_NOTHING: none before deadline_ns (osc_clock_ns). */
int64_t osc_socket_receive(int socket, void *out, size_t capacity, osc_peer *out_peer,
                           int64_t deadline_ns);
/* Sends without waiting. 0 or an errno; ECONNREFUSED: it was sent, but at an earlier datagram's end
 * nobody listened. */
int osc_socket_send(int socket, const void *bytes, size_t size);

#endif
