/* phone/phone_parse.h - datagrams of programs that watch a person's face become one table of 61
 * named values: the shapes of ARKit, the head and the eyes, in the order of Live Link Face. Knows
 * Live Link Face, iFacialMocap (both versions of its text) and OpenSeeFace by how they begin.
 * Leaves out who sends. Pure; no allocation. Left and right are the person's own. */
#ifndef PLUGINS_PHONE_PARSE_H
#define PLUGINS_PHONE_PARSE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PHONE_SHAPES = 52, PHONE_VALUES = 61, PHONE_DATAGRAM = 65536 };
/* "eyeBlinkLeft" .. "tongueOut": 0..1; then yaw, pitch and roll of head, left and right eye: rad */
extern const char *const phone_name[PHONE_VALUES];

typedef enum phone_protocol {
    PHONE_NONE = 0, /* it is nothing that is known here, or damaged */
    PHONE_LIVE_LINK,
    PHONE_IFACIALMOCAP,
    PHONE_OPENSEEFACE
} phone_protocol;

/* The two orders of jawLeft, jawRight and mouthLeft, mouthRight among Live Link's 61. */
typedef enum phone_laterals { PHONE_LEFT_FIRST = 0, PHONE_RIGHT_FIRST } phone_laterals;

typedef struct phone_frame {
    bool has_face; /* false: nobody is seen */
    bool has_time;
    double time_s;              /* by the sender's clock */
    bool is_told[PHONE_VALUES]; /* the others are 0 */
    float value[PHONE_VALUES];  /* finite, within their range */
} phone_frame;

phone_protocol phone_parse(phone_frame *out, const void *bytes, size_t size,
                           phone_laterals laterals);

#endif
