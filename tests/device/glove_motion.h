/* device/glove_motion.h - what the hand in the emulated glove does, as raw sensor bytes at a time:
 * a sweep of every sensor, or a recording. A recording's angles become bytes by inverting the
 * default calibration of hand/hand.h, rounded and kept within 1..255, so that a glove played to a
 * program without a calibration shows the recorded hand. Recordings are interpolated between their
 * records and start again at their end. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_MOTION_H
#define MAROTTE_TESTS_DEVICE_GLOVE_MOTION_H
#include "base/error.h"

#include "glove_box.h"

typedef struct glove_motion {
    size_t record_count; /* 0: the sweep */
    int64_t *time_ns;
    float *angle_rad; /* record_count by GLOVE_SENSORS */
    bool is_still;    /* the first record, or the middle of the sweep, for ever */
} glove_motion;

/* what: "sweep", "still", or the path of a recording that the log plugin reads. */
CHECKED mrt_result glove_motion_open(glove_motion *out, const char *what, error *err);
void glove_motion_finish(glove_motion *motion); /* accepts a zeroed one */

/* out_sensor: GLOVE_SENSORS bytes, 1..255. */
void glove_motion_at(const glove_motion *motion, int64_t time_ns, uint8_t *out_sensor);

/* Puts the number into two sensors that a face hardly shows, palm arch and wrist yaw, in base 254:
 * each of 64516 successive records is then like no other. And reads it again, from the channels of
 * a sample; -1: these sensors are not sent. */
void glove_motion_number(uint8_t *sensor, uint32_t number);
int32_t glove_motion_number_in(const mrt_channel *channel, const mrt_sample *sample);

#endif
