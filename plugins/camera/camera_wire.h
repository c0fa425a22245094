/* plugins/camera/camera_wire.h - bytes from a browser, taken apart: the head of an HTTP request, a
 * WebSocket frame (RFC 6455), a message of the page. Whoever sent them is not trusted. Pure
 * functions; no allocation. */
#ifndef MAROTTE_CAMERA_WIRE_H
#define MAROTTE_CAMERA_WIRE_H
#include <marotte/plugin.h>

enum {
    CAMERA_HEAD_MAX = 4096,    /* of a request */
    CAMERA_MESSAGE_MAX = 1024, /* of a WebSocket frame's payload */
    CAMERA_TOKEN = 32          /* letters: 128 bits in hexadecimal */
};
#define CAMERA_PROTOCOL "marotte.camera.1"

/* ---- HTTP ---- */

typedef struct camera_request {
    char path[192], host[64], origin[96];
    char key[32];              /* Sec-WebSocket-Key; "": none that is well formed */
    bool has_host, has_origin; /* said, if empty */
    bool is_socket;            /* it asks for a WebSocket, version 13, in our protocol */
} camera_request;

/* > 0: how many bytes the head is long; 0: it is not whole yet; < 0: less the status to answer. */
int camera_request_parse(camera_request *out, const void *bytes, size_t size);
/* Which file it may have: 200 and its name, "" for the page, in the request; 101 for the WebSocket;
 * or 403, 404. The host and, where there is one, the origin must be ours to the letter. */
int camera_request_judge(const camera_request *request, uint16_t port, const char *token,
                         const char **out_name);
/* Sec-WebSocket-Accept; 29 letters with the 0. */
enum { CAMERA_ACCEPT = 29 };
void camera_accept_key(const char *key, char out[CAMERA_ACCEPT]);

/* ---- WebSocket ---- */

enum { CAMERA_TEXT = 1, CAMERA_BINARY = 2, CAMERA_CLOSE = 8, CAMERA_PING = 9, CAMERA_PONG = 10 };
typedef struct camera_frame {
    int opcode;
    const unsigned char *payload; /* in the bytes that were given, unmasked there */
    size_t size;
} camera_frame;

/* > 0: how many bytes the frame is long; 0: it is not whole yet; < 0: less the code to close with:
 * a client must mask, and nothing of ours is cut into pieces or longer than CAMERA_MESSAGE_MAX. */
int camera_frame_parse(camera_frame *out, void *bytes, size_t size);
/* A frame to the page; out: size + 4 bytes. Returns its size. size <= 65535. */
size_t camera_frame_write(unsigned char *out, int opcode, const void *payload, size_t size);

/* ---- messages of the page: binary, little-endian ----
 * 1 frame: u32 sequence, f64 capture time in ms of the page's clock, u8 hands 0..2, and of each: u8
 *          side (MRT_LEFT ...), f32 score 0..1, 21 x 3 f32 world landmarks of MediaPipe in m, 21 x
 *          2 f32 in the picture 0..1 (of a headset: 0)
 * 2 ping:  f64 time in ms of the page's clock, as it is sent
 * 3 pong, to the page: that f64, i64 ns of ours */

enum { CAMERA_HANDS_MAX = 2 };
enum { CAMERA_NOTHING = 0, CAMERA_SEEN = 1, CAMERA_ASKED = 2, CAMERA_ANSWER = 3 };

typedef struct camera_hand {
    mrt_landmarks seen; /* mm, in the face frame of whoever looks into the camera */
    float score;
} camera_hand;

typedef struct camera_message {
    int kind;          /* CAMERA_SEEN, CAMERA_ASKED */
    uint32_t sequence; /* CAMERA_SEEN */
    int64_t time_ns;   /* of the page's clock */
    double time_ms;    /* the same, as it was sent */
    uint32_t hand_count;
    camera_hand hand[CAMERA_HANDS_MAX];
} camera_message;

/* False: it is none of these, or has a number that cannot be. */
bool camera_message_parse(camera_message *out, const void *bytes, size_t size);
enum { CAMERA_ANSWER_SIZE = 17 };
void camera_answer_write(unsigned char out[CAMERA_ANSWER_SIZE], double time_ms, int64_t time_ns);

#endif
