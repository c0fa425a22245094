/* vts/websocket.h - the client's end of one WebSocket (RFC 6455) that carries texts, over TCP to a
 * program that is near: nothing here waits. Leaves out TLS, extensions and what is said. One
 * thread.
 */
#ifndef MAROTTE_VTS_WEBSOCKET_H
#define MAROTTE_VTS_WEBSOCKET_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { WEBSOCKET_MESSAGE = 1 << 20 }; /* bytes of a text at most, either way */

typedef enum websocket_state {
    WEBSOCKET_CLOSED = 0,
    WEBSOCKET_CONNECTING,
    WEBSOCKET_UPGRADING, /* it was asked to be a WebSocket */
    WEBSOCKET_OPEN
} websocket_state;

typedef struct websocket {
    websocket_state state;
    int fd;                       /* -1 */
    char host[128], expected[29]; /* Sec-WebSocket-Accept */
    uint16_t port;
    unsigned char *in, *out; /* WEBSOCKET_MESSAGE + 64 each */
    char *text;              /* of the one that was taken */
    size_t in_size, out_size;
    uint64_t seed;
} websocket;

bool websocket_init(websocket *self); /* false: no memory */
void websocket_finish(websocket *self);
/* Begins; false: not even that. */
bool websocket_connect(websocket *self, const char *host, uint16_t port);
/* Goes on with whatever can be done now. False: it was closed, by whomever. */
bool websocket_go_on(websocket *self);
/* Whether all that was said is on its way. */
bool websocket_is_idle(const websocket *self);
/* False: there is no room now. */
bool websocket_say(websocket *self, const char *text, size_t size);
/* The next text, 0-ended, until the next call; NULL: none now. Closes where the protocol is broken.
 */
const char *websocket_take(websocket *self);
void websocket_close(websocket *self);

#endif
