/* plugins/camera/camera_port.h - one TCP port of 127.0.0.1: it serves the page and what the page
 * loads, and hears the page's WebSocket. Several inputs of one program may have the same port (a
 * left hand and a right one) and share it; whichever of them waits works for all. There is no
 * thread: bytes come and go while some input reads. The list of open ports is the one thing in this
 * plugin that is shared between instances. */
#ifndef MAROTTE_CAMERA_PORT_H
#define MAROTTE_CAMERA_PORT_H
#include "camera_wire.h"

enum { CAMERA_PORT_USUAL = 9130, CAMERA_REASON = 256, CAMERA_PATH = 1024, CAMERA_ADDRESS = 96 };

/* A file of the page, in the program itself. */
typedef struct camera_file {
    const char *name; /* "page.js"; "" is the page */
    const char *type; /* MIME */
    const unsigned char *data;
    size_t size;
} camera_file;
extern const camera_file camera_page[]; /* ends with name NULL */

/* What the page saw at one moment. */
typedef struct camera_frame {
    int64_t time_ns; /* when the picture was taken, device_clock_ns */
    uint32_t lost;   /* before it, as nobody read them */
    uint32_t hand_count;
    camera_hand hand[CAMERA_HANDS_MAX];
} camera_frame;

enum { CAMERA_QUEUE = 32 };
/* What one input has heard; while joined, under the port's lock. */
typedef struct camera_listener {
    struct camera_listener *next;
    uint32_t hands_wanted;
    camera_frame item[CAMERA_QUEUE]; /* ring */
    uint32_t first, count, lost;
} camera_listener;

typedef struct camera_port camera_port;

/* token: CAMERA_TOKEN letters. package: the folder of @mediapipe/hands, there or not. NULL:
 * out_reason says why. With MAROTTE_TRACE (trace.h) the page's messages are written down; `host` is
 * told if that cannot be. */
camera_port *camera_port_open(uint16_t port, const char *token, const char *package,
                              const mrt_host *host, char *out_reason);
/* The last one closes it. NULL is fine. */
void camera_port_close(camera_port *port);

void camera_port_join(camera_port *port, camera_listener *listener);
void camera_port_leave(camera_port *port, camera_listener *listener);

/* Works until the listener has heard something, or until the deadline (device_clock_ns), never past
 * it. False: the socket failed. `host` is told who comes and goes. */
bool camera_port_wait(camera_port *port, const camera_listener *listener, int64_t deadline_ns,
                      const mrt_host *host);
/* The oldest that was heard; false: nothing. */
bool camera_port_pop(camera_port *port, camera_listener *listener, camera_frame *out);

/* "http://127.0.0.1:9130/TOKEN/" */
void camera_port_address(uint16_t port, const char *token, char out[CAMERA_ADDRESS]);

#endif
