/* hand/virtualhand_text.h - the text of a VirtualHand 1.x calibration, taken apart strictly: what
 * it says, not what that means. Inside the room. Pure. */
#ifndef MAROTTE_HAND_VIRTUALHAND_TEXT_H
#define MAROTTE_HAND_VIRTUALHAND_TEXT_H
#include "base/error.h"
#include "base/rigid.h"

enum { VIRTUALHAND_FINGERS = 6, VIRTUALHAND_JOINTS = 4 }; /* thumb .. little, wrist */

typedef struct virtualhand_gain {
    bool given;
    int32_t offset; /* 0..255 */
    double gain;    /* rad per count */
} virtualhand_gain;

typedef struct virtualhand_text {
    virtualhand_gain gain[VIRTUALHAND_FINGERS][VIRTUALHAND_JOINTS];
    bool has_geometry;
    uint32_t side;                                          /* with geometry: MRT_LEFT, MRT_RIGHT */
    uint32_t fingers, joints;                               /* with geometry */
    vec3 joint_cm[VIRTUALHAND_FINGERS][VIRTUALHAND_JOINTS]; /* origin wrist */
} virtualhand_text;

/* Errors name the line and what was expected there. */
CHECKED mrt_result virtualhand_text_parse(virtualhand_text *out, const void *bytes, size_t size,
                                          const char *name, error *err);

#endif
