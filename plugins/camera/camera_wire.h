/* plugins/camera/camera_wire.h - checks of the browser's requests, and the parser of the page's
 * messages. The sender is not trusted. Pure functions; no allocation. Leaves out HTTP and WebSocket
 * (web.h). */
#ifndef MAROTTE_CAMERA_WIRE_H
#define MAROTTE_CAMERA_WIRE_H
#include "web.h"

#include <marotte/plugin.h>

enum { CAMERA_TOKEN = 32 /* letters: 128 bits in hexadecimal */ };
#define CAMERA_PROTOCOL "marotte.camera.1"

/* Decides on a request. Returns 200 and the file's name, "" for the page; 101 for the WebSocket; or
 * 403, 404. The host must be exactly ours, and so must the origin if present. */
int camera_request_judge(const web_request *request, uint16_t port, const char *token,
                         const char **out_name);

/* ---- messages of the page: binary, little-endian ----
 * 1 frame: u32 sequence, f64 capture time in ms of the page's clock, u8 hands 0..2, and of each: u8
 *          side (MRT_LEFT ...), f32 score 0..1, 21 x 3 f32 world landmarks of MediaPipe in m, 21 x
 *          2 f32 in the picture 0..1 (of a headset: 0)
 * 2 ping:  f64 time in ms of the page's clock, as it is sent
 * 3 pong, to the page: that f64, i64 ns of ours */

enum { CAMERA_HANDS_MAX = 2 };
enum { CAMERA_NOTHING = 0, CAMERA_SEEN = 1, CAMERA_ASKED = 2, CAMERA_ANSWER = 3 };

typedef struct camera_hand {
    mrt_landmarks seen; /* mm, in the face frame of a person looking into the camera */
    float score;
} camera_hand;

typedef struct camera_message {
    int kind;          /* CAMERA_SEEN, CAMERA_ASKED */
    uint32_t sequence; /* CAMERA_SEEN */
    int64_t time_ns;   /* of the page's clock */
    double time_ms;    /* the same, unchanged as received */
    uint32_t hand_count;
    camera_hand hand[CAMERA_HANDS_MAX];
} camera_message;

/* Returns false for an unknown message or an impossible number. */
bool camera_message_parse(camera_message *out, const void *bytes, size_t size);
enum { CAMERA_ANSWER_SIZE = 17 };
void camera_answer_write(unsigned char out[CAMERA_ANSWER_SIZE], double time_ms, int64_t time_ns);

#endif
