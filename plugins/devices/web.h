/* plugins/devices/web.h - the bytes of a small server of this program's, taken apart and put
 * together: the head of an HTTP request, WebSocket frames (RFC 6455). Whoever sent them is not
 * trusted. Pure functions; no allocation. Leaves out who may ask (the camera's page, the remote
 * control) and sockets. */
#ifndef MAROTTE_DEVICES_WEB_H
#define MAROTTE_DEVICES_WEB_H
#include <stdbool.h>
#include <stddef.h>

enum {
    WEB_HEAD_MAX = 4096,   /* of a request */
    WEB_MESSAGE_MAX = 1024 /* of a WebSocket frame's payload */
};

/* ---- HTTP ---- */

typedef struct web_request {
    char path[192], host[64], origin[96];
    char key[32];              /* Sec-WebSocket-Key; "": none that is well formed */
    bool has_host, has_origin; /* said, if empty */
    bool is_socket;            /* it asks for a WebSocket, version 13, in the protocol */
} web_request;

/* protocol: that a WebSocket must offer; NULL: any or none.
 * > 0: how many bytes the head is long; 0: it is not whole yet; < 0: less the status to answer. */
int web_request_parse(web_request *out, const void *bytes, size_t size, const char *protocol);
/* Sec-WebSocket-Accept; 29 letters with the 0. */
enum { WEB_ACCEPT = 29 };
void web_accept_key(const char *key, char out[WEB_ACCEPT]);

/* ---- WebSocket ---- */

enum { WEB_TEXT = 1, WEB_BINARY = 2, WEB_CLOSE = 8, WEB_PING = 9, WEB_PONG = 10 };
typedef struct web_frame {
    int opcode;
    const unsigned char *payload; /* in the bytes that were given, unmasked there */
    size_t size;
} web_frame;

/* > 0: how many bytes the frame is long; 0: it is not whole yet; < 0: less the code to close with:
 * a client must mask, and nothing of ours is cut into pieces or longer than WEB_MESSAGE_MAX. */
int web_frame_parse(web_frame *out, void *bytes, size_t size);
/* A frame to the page; out: size + 4 bytes. Returns its size. size <= 65535. */
size_t web_frame_write(unsigned char *out, int opcode, const void *payload, size_t size);

#endif
