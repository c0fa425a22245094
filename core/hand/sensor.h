/* hand/sensor.h - the 22 sensors of a glove in the order of plugin.h (MRT_CH_ANGLE): their names,
 * the values of an average glove, and the range of each joint. Constants. */
#ifndef MAROTTE_HAND_SENSOR_H
#define MAROTTE_HAND_SENSOR_H
#include <marotte/plugin.h>

enum {
    SENSOR_THUMB_ROLL = 0,
    SENSOR_THUMB_MPJ = 1,
    SENSOR_THUMB_IJ = 2,
    SENSOR_THUMB_ABDUCTION = 3,
    SENSOR_INDEX_MPJ = 4,
    SENSOR_MIDDLE_MPJ = 7,
    SENSOR_MIDDLE_INDEX_SPREAD = 10,
    SENSOR_RING_MPJ = 11,
    SENSOR_RING_MIDDLE_SPREAD = 14,
    SENSOR_LITTLE_MPJ = 15,
    SENSOR_LITTLE_RING_SPREAD = 18,
    SENSOR_ARCH = 19,
    SENSOR_WRIST_PITCH = 20,
    SENSOR_WRIST_YAW = 21,
    SENSOR_NONE = -1
};

typedef enum sensor_kind {
    SENSOR_ROLL = 0, /* of the thumb's base */
    SENSOR_KNUCKLE,  /* MPJ, also of the thumb */
    SENSOR_MIDDLE_JOINT,
    SENSOR_END_JOINT, /* DIJ, and the thumb's IJ */
    SENSOR_SPREAD,
    SENSOR_PALM,
    SENSOR_WRIST
} sensor_kind;

/* Angles as in hand.h. */
typedef struct sensor_facts {
    const char *name;  /* "index.mpj": in files and logs */
    const char *label; /* "index knuckle": for people */
    sensor_kind kind;
    int finger; /* 0 thumb .. 4 little; a spread belongs to the outer finger; -1: palm and wrist */
    /* For an average glove with 8-bit counts: rad = gain * (raw - zero) + rad_at_zero. */
    float gain, zero, rad_at_zero;
    float low_deg, high_deg; /* clinical range */
    float neutral_rad;       /* relaxed, ready to talk: as at rest in the demo recording */
} sensor_facts;

extern const sensor_facts sensor_table[MRT_ANGLES];

/* Returns the index in sensor order; -1: unknown name. */
int sensor_find(const char *name);

/* The distal joints, index to little, which an 18-sensor glove does not have. */
enum { SENSOR_DISTAL_COUNT = 4 };
extern const int sensor_distal[SENSOR_DISTAL_COUNT];
/* The middle joints of the same fingers. */
extern const int sensor_middle[SENSOR_DISTAL_COUNT];

#endif
