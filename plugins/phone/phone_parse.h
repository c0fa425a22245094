/* phone/phone_parse.h - parser of the datagrams of face trackers: converts them to one table of 61
 * named values (the shapes of ARKit, the head and the eyes, in the order of Live Link Face).
 * Detects Live Link Face, iFacialMocap (both versions of its text) and OpenSeeFace by their first
 * bytes. Leaves out the sender. Pure; no allocation. Left and right are the performer's own. */
#ifndef PLUGINS_PHONE_PARSE_H
#define PLUGINS_PHONE_PARSE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PHONE_SHAPES = 52, PHONE_VALUES = 61, PHONE_DATAGRAM = 65536 };
/* "eyeBlinkLeft" .. "tongueOut": 0..1; then yaw, pitch and roll of head, left and right eye: rad */
extern const char *const phone_name[PHONE_VALUES];

typedef enum phone_protocol {
    PHONE_NONE = 0, /* unknown or damaged */
    PHONE_LIVE_LINK,
    PHONE_IFACIALMOCAP,
    PHONE_OPENSEEFACE
} phone_protocol;

/* The two orders of jawLeft, jawRight and mouthLeft, mouthRight among Live Link's 61. */
typedef enum phone_laterals { PHONE_LEFT_FIRST = 0, PHONE_RIGHT_FIRST } phone_laterals;

typedef struct phone_frame {
    bool has_face; /* false: no face is tracked */
    bool has_time;
    double time_s;              /* by the sender's clock */
    bool is_told[PHONE_VALUES]; /* the others are 0 */
    float value[PHONE_VALUES];  /* finite, within their range */
} phone_frame;

phone_protocol phone_parse(phone_frame *out, const void *bytes, size_t size,
                           phone_laterals laterals);

#endif
