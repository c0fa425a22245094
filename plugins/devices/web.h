/* plugins/devices/web.h - the wire format of a small server: the head of an HTTP request and
 * WebSocket frames (RFC 6455), parsed and written. The sender is not trusted. Pure functions; no
 * allocation. Leaves out access control (the camera's page, the remote control) and sockets. */
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
    char key[32];              /* Sec-WebSocket-Key; "": missing or not well formed */
    bool has_host, has_origin; /* present, even if empty */
    bool is_socket;            /* requests a WebSocket, version 13, with the protocol */
} web_request;

/* Parses a request. protocol: required in a WebSocket request; NULL: any or none. Returns the
 * length of the head; 0 if it is incomplete; < 0: minus the status to answer with. */
int web_request_parse(web_request *out, const void *bytes, size_t size, const char *protocol);
/* Sec-WebSocket-Accept; 29 letters with the 0. */
enum { WEB_ACCEPT = 29 };
void web_accept_key(const char *key, char out[WEB_ACCEPT]);

/* ---- WebSocket ---- */

enum { WEB_TEXT = 1, WEB_BINARY = 2, WEB_CLOSE = 8, WEB_PING = 9, WEB_PONG = 10 };
typedef struct web_frame {
    int opcode;
    const unsigned char *payload; /* within the given bytes, unmasked in place */
    size_t size;
} web_frame;

/* Returns the length of the frame; 0 if it is incomplete; < 0: minus the code to close with. A
 * client must mask its frames. Fragments and frames longer than WEB_MESSAGE_MAX are rejected. */
int web_frame_parse(web_frame *out, void *bytes, size_t size);
/* Writes a frame to the page and returns its size. out: size + 4 bytes. size <= 65535. */
size_t web_frame_write(unsigned char *out, int opcode, const void *payload, size_t size);

#endif
