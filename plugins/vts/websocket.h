/* vts/websocket.h - client of one WebSocket (RFC 6455) for text messages, over TCP to a nearby
 * program. Never waits. Leaves out TLS, extensions and the content of the messages. One thread. */
#ifndef MAROTTE_VTS_WEBSOCKET_H
#define MAROTTE_VTS_WEBSOCKET_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { WEBSOCKET_MESSAGE = 1 << 20 }; /* bytes of a text at most, either way */

typedef enum websocket_state {
    WEBSOCKET_CLOSED = 0,
    WEBSOCKET_CONNECTING,
    WEBSOCKET_UPGRADING, /* upgrade to WebSocket requested */
    WEBSOCKET_OPEN
} websocket_state;

typedef struct websocket {
    websocket_state state;
    int fd;                       /* -1 */
    char host[128], expected[29]; /* Sec-WebSocket-Accept */
    uint16_t port;
    unsigned char *in, *out; /* WEBSOCKET_MESSAGE + 64 each */
    char *text;              /* the text last returned */
    size_t in_size, out_size;
    uint64_t seed;
} websocket;

bool websocket_init(websocket *self); /* false: no memory */
void websocket_finish(websocket *self);
/* Starts to connect. Returns false if that fails immediately. */
bool websocket_connect(websocket *self, const char *host, uint16_t port);
/* Reads and writes as far as possible without waiting. Returns false if the connection is
 * closed. */
bool websocket_step(websocket *self);
/* Returns true if all texts were handed to the system. */
bool websocket_is_idle(const websocket *self);
/* Queues a text. Returns false if the connection is not open, the text is too long, or the
 * buffer is full. */
bool websocket_send(websocket *self, const char *text, size_t size);
/* Returns the next text, 0-ended and valid until the next call; NULL: none now. Closes the
 * connection on a protocol error. */
const char *websocket_receive(websocket *self);
void websocket_close(websocket *self);

#endif
