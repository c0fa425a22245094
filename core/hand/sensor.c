#include "hand/sensor.h"

#include <string.h>

/* Gains: mean over the gloves of research/hardware.md 2.1. Two rows differ from the suggestion of
 * that page. Its thumb roll is 0 for a resting thumb; ours is 0 for a thumb in the plane of the
 * palm, which rests 0.6 rad in front of it. Its wrist pitch has the sign of a table in which
 * flexion is negative. Ranges: hardware.md 2.3, clinical (knuckles extend by 30 to 45 degrees, the
 * other joints by 0) and widest spreads. The range of the thumb's roll is that of its base joint,
 * 80 degrees; that of the arch is from the one glove that was measured. */
const sensor_facts sensor_table[MRT_ANGLES] = {
    {"thumb.roll", "thumb roll", SENSOR_ROLL, 0, 0.0160f, 74, 0.6f, 0, 80, 1.44f},
    {"thumb.mpj", "thumb knuckle", SENSOR_KNUCKLE, 0, 0.0142f, 80, 0, 0, 50, 0.15f},
    {"thumb.ij", "thumb end joint", SENSOR_END_JOINT, 0, 0.0185f, 100, 0, 0, 80, 0.20f},
    {"thumb.abd", "thumb spread", SENSOR_SPREAD, 0, -0.0090f, 200, 0, 0, 53, 0.34f},
    {"index.mpj", "index knuckle", SENSOR_KNUCKLE, 1, 0.0200f, 90, 0, -45, 90, 0.61f},
    {"index.pij", "index finger, middle joint", SENSOR_MIDDLE_JOINT, 1, 0.0140f, 65, 0, 0, 100,
     0.53f},
    {"index.dij", "index finger, end joint", SENSOR_END_JOINT, 1, 0.0140f, 80, 0, 0, 80, 0.0f},
    {"middle.mpj", "middle knuckle", SENSOR_KNUCKLE, 2, 0.0200f, 90, 0, -45, 90, 0.67f},
    {"middle.pij", "middle finger, middle joint", SENSOR_MIDDLE_JOINT, 2, 0.0140f, 65, 0, 0, 100,
     0.60f},
    {"middle.dij", "middle finger, end joint", SENSOR_END_JOINT, 2, 0.0140f, 80, 0, 0, 80, 0.01f},
    {"middle.abd", "middle-index spread", SENSOR_SPREAD, 2, -0.0060f, 150, 0, 0, 17, -0.04f},
    {"ring.mpj", "ring knuckle", SENSOR_KNUCKLE, 3, 0.0200f, 90, 0, -45, 90, 0.72f},
    {"ring.pij", "ring finger, middle joint", SENSOR_MIDDLE_JOINT, 3, 0.0140f, 65, 0, 0, 100,
     0.64f},
    {"ring.dij", "ring finger, end joint", SENSOR_END_JOINT, 3, 0.0140f, 80, 0, 0, 80, 0.02f},
    {"ring.abd", "ring-middle spread", SENSOR_SPREAD, 3, -0.0060f, 150, 0, 0, 14, -0.05f},
    {"little.mpj", "little knuckle", SENSOR_KNUCKLE, 4, 0.0200f, 90, 0, -45, 90, 0.70f},
    {"little.pij", "little finger, middle joint", SENSOR_MIDDLE_JOINT, 4, 0.0140f, 65, 0, 0, 100,
     0.60f},
    {"little.dij", "little finger, end joint", SENSOR_END_JOINT, 4, 0.0140f, 80, 0, 0, 80, 0.01f},
    {"little.abd", "little-ring spread", SENSOR_SPREAD, 4, -0.0060f, 150, 0, 0, 32, -0.04f},
    {"palm.arch", "palm arch", SENSOR_PALM, -1, 0.0090f, 103, 0, 0, 40, 0.12f},
    {"wrist.pitch", "wrist pitch", SENSOR_WRIST, -1, 0.0148f, 134, 0, -70, 80, -0.08f},
    {"wrist.yaw", "wrist yaw", SENSOR_WRIST, -1, -0.0068f, 90, 0, -30, 20, 0.0f},
};

const int sensor_distal[SENSOR_DISTAL_COUNT] = {6, 9, 13, 17};
const int sensor_middle[SENSOR_DISTAL_COUNT] = {5, 8, 12, 16};

int sensor_find(const char *name)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (strcmp(sensor_table[i].name, name) == 0)
            return i;
    return -1;
}
