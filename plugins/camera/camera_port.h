/* plugins/camera/camera_port.h - one TCP port of 127.0.0.1 that serves the page and its files, and
 * receives the page's WebSocket messages. Several inputs of one program (a left and a right hand)
 * can share a port. The plugin has no thread: the input that waits handles the sockets for all
 * inputs of its port. The list of open ports is the only state that instances of this plugin
 * share. */
#ifndef MAROTTE_CAMERA_PORT_H
#define MAROTTE_CAMERA_PORT_H
#include "camera_wire.h"

enum { CAMERA_PORT_USUAL = 9130, CAMERA_REASON = 256, CAMERA_PATH = 1024, CAMERA_ADDRESS = 96 };

/* file of the page, embedded in the program */
typedef struct camera_file {
    const char *name; /* "page.js"; "" is the page */
    const char *type; /* MIME */
    const unsigned char *data;
    size_t size;
} camera_file;
extern const camera_file camera_page[]; /* ends with name NULL */

/* hands in one picture of the page */
typedef struct camera_frame {
    int64_t time_ns; /* when the picture was taken, device_clock_ns */
    uint32_t lost;   /* frames dropped before this one because the queue was full */
    uint32_t hand_count;
    camera_hand hand[CAMERA_HANDS_MAX];
} camera_frame;

enum { CAMERA_QUEUE = 32 };
/* Received frames of one input. While joined, the port's lock guards it. */
typedef struct camera_listener {
    struct camera_listener *next;
    uint32_t hands_wanted;
    camera_frame item[CAMERA_QUEUE]; /* ring */
    uint32_t first, count, lost;
} camera_listener;

typedef struct camera_port camera_port;

/* token: CAMERA_TOKEN letters. package: folder of @mediapipe/hands, which may be missing. Returns
 * NULL on failure, with the reason in out_reason. With MAROTTE_TRACE (trace.h) the page's messages
 * are logged; a failure of that is logged through `host`. */
camera_port *camera_port_open(uint16_t port, const char *token, const char *package,
                              const mrt_host *host, char *out_reason);
/* Closes the port when its last user closes it. Accepts NULL. */
void camera_port_close(camera_port *port);

void camera_port_join(camera_port *port, camera_listener *listener);
void camera_port_leave(camera_port *port, camera_listener *listener);

/* Handles the sockets until the listener has a frame, or until the deadline (device_clock_ns),
 * never longer. Returns false if the socket failed. Logs each connection and disconnection of a
 * page through `host`. */
bool camera_port_wait(camera_port *port, const camera_listener *listener, int64_t deadline_ns,
                      const mrt_host *host);
/* Removes the oldest frame. Returns false if there is none. */
bool camera_port_pop(camera_port *port, camera_listener *listener, camera_frame *out);

/* "http://127.0.0.1:9130/TOKEN/" */
void camera_port_address(uint16_t port, const char *token, char out[CAMERA_ADDRESS]);

#endif
