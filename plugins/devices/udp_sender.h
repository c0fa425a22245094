/* plugins/devices/udp_sender.h - datagrams to one place, for face outputs: opened, sent without
 * waiting, and what that tells about the other side. One thread at a time. */
#ifndef MAROTTE_DEVICES_UDP_SENDER_H
#define MAROTTE_DEVICES_UDP_SENDER_H
#include "trace.h"
#include "udp.h"

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
