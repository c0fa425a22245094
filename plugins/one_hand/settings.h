/* one_hand/settings.h - the parameters of the mapping and their indices in mrt_frame.params. Ids
 * never change. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_SETTINGS_H
#define MAROTTE_PLUGINS_ONE_HAND_SETTINGS_H
#include <marotte/plugin.h>

/* All but the last are modes of earlier versions, kept for their takes. */
enum { MODE_CLASSIC = 0, MODE_MASK, MODE_WALDO, MODE_SPEAKING, MODE_COUNT };
enum { DEVICE_AUTOMATIC = 0 }; /* then 1 + device_kind */
enum { HAND_EITHER = 0, HAND_LEFT, HAND_RIGHT };
enum { NEUTRAL_AT_ENGAGE = 0, NEUTRAL_STORED };
enum { LAYER_MOUTH = 0, LAYER_BROWS, LAYER_HEAD, LAYER_COUNT };

/* Movements of the face, in the performer's words; each has one gain and one range. */
enum {
    AXIS_JAW = 0,
    AXIS_LOWER_LIP,
    AXIS_ROUND,
    AXIS_WIDTH,
    AXIS_SMILE,
    AXIS_TONGUE,
    AXIS_BROWS,
    AXIS_LIDS,
    AXIS_GAZE,
    AXIS_TILT,
    AXIS_HEAD,
    AXIS_COUNT
};

/* Names of the faces that a hand can perform, NULL-ended. An expression is both a mouth and an
 * upper half. */
enum { FACE_NAMES = 53 };
extern const char *const face_names[FACE_NAMES + 1];

/* In table order. mm are mm on a face whose pupils are 63 mm apart. */
enum {
    SET_MODE = 0,
    SET_HAND,
    SET_DEVICE,
    SET_PRESS,
    SET_GAIN,
    SET_RANGE = SET_GAIN + AXIS_COUNT,
    SET_AXES_END = SET_RANGE + AXIS_COUNT - 1,
    SET_ANSWERED_FACE,
    SET_ANSWER,
    SET_UNDO_ANSWER,
    SET_FORGET_ANSWER,
    SET_FORGET_ANSWERS,
    SET_INTENSITY,
    SET_SIZE,
    SET_REACH,
    SET_LEVER,

    SET_NEUTRAL_FROM,
    SET_NEUTRAL_SAMPLES,

    SET_ANCHOR_PEDAL,
    SET_HOLD_PEDAL,
    SET_LAYER_PEDAL,
    SET_INTENSITY_PEDAL,
    SET_ANCHOR,
    SET_REVERT,
    SET_TO_NEUTRAL,
    SET_HOLD,
    SET_HOLD_REGION,
    SET_DOUBLE_TAP,
    SET_REATTACH,
    SET_NEUTRAL_TIME,

    SET_LAYER,
    SET_OTHER_LAYER,
    SET_NEXT_LAYER,

    SET_JAW_ROLL,
    SET_JAW_MPJ,
    SET_JAW_IJ,
    SET_JAW_GAIN,
    SET_JAW_DEAD,
    SET_JAW_RANGE,
    SET_JAW_KNEE_TRAVEL,
    SET_JAW_KNEE_GAPE,
    SET_ASIDE_FOLLOW,
    SET_ASIDE_GAIN,
    SET_ASIDE_DEAD,
    SET_ASIDE_RANGE,

    SET_BROW_GAIN,
    SET_BROW_DEAD,
    SET_BROW_UP,
    SET_BROW_DOWN,
    SET_BROW_FOREHEAD,
    SET_TILT_GAIN,
    SET_TILT_DEAD,
    SET_TILT_RANGE,

    SET_BLINK,
    SET_BLINK_SPEED,
    SET_BLINK_STROKE,
    SET_BLINK_CLOSE,
    SET_BLINK_OPEN,
    SET_DROOP_GAIN,
    SET_DROOP_DEAD,
    SET_DROOP_RANGE,
    SET_DROOP_TIME,
    SET_LOWER_LID,

    SET_CORNER_GAIN,
    SET_CORNER_DEAD,
    SET_CORNER_SMILE,
    SET_CORNER_FROWN,
    SET_CORNER_CHEEK,
    SET_SMIRK_GAIN,
    SET_SMIRK_DEAD,
    SET_SMIRK_RANGE,

    SET_WIDE_GAIN,
    SET_NARROW_GAIN,
    SET_WIDTH_DEAD,
    SET_WIDE_RANGE,
    SET_NARROW_RANGE,
    SET_PROTRUSION,

    SET_SNEER_GAIN,
    SET_SNEER_DEAD,
    SET_SNEER_RANGE,
    SET_LIP_GAIN,
    SET_LIP_DEAD,
    SET_LIP_RANGE,
    SET_LIP_HEAD,

    SET_HEAD_GAIN,
    SET_HEAD_DEAD,
    SET_HEAD_NOD,
    SET_HEAD_TURN,
    SET_HEAD_EYES,

    SET_MASK_THUMB,
    SET_MASK_INDEX,
    SET_MASK_MIDDLE,
    SET_MASK_RING,
    SET_MASK_LITTLE,
    SET_MASK_PALM,
    SET_MASK_DEAD,
    SET_MASK_BROW_ASIDE,

    SET_ARC_THUMB,
    SET_ARC_INDEX,
    SET_ARC_SPREAD,
    SET_ARC_LITTLE,
    SET_ARC_WRIST,
    SET_ARC_DEAD,
    SET_ARC_FORWARD,
    SET_ARC_GAZE_YAW,
    SET_ARC_GAZE_PITCH,

    SET_COUNT
};
extern const mrt_param settings[SET_COUNT];

#endif
