#include "glove_motion.h"

#include "hand/hand.h"
#include "log_parse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RAW_MIN = 1, RAW_MAX = 255, NUMBER_BASE = 254, LOW_SENSOR = 19, HIGH_SENSOR = 21 };

static uint8_t raw_of(const hand_table *table, float angle_rad)
{
    float gain = (table->rad[1] - table->rad[0]) / (table->raw[1] - table->raw[0]);
    float raw = table->raw[0] + (angle_rad - table->rad[0]) / gain;
    return (uint8_t)lroundf(fminf(fmaxf(raw, RAW_MIN), RAW_MAX));
}

/* A log need not have the distal joints: they are then those that the hand would have. */
static void fill_angles(float *out, const log_data *log, size_t record)
{
    hand_calibration identity;
    float measured[MRT_ANGLES] = {0};
    hand_calibration_identity(&identity);
    memset(identity.has_distal, 0, sizeof identity.has_distal);
    for (uint32_t i = 0; i < log->channel_count; ++i) {
        uint32_t angle = log->channel[i].semantic - MRT_CH_ANGLE;
        if (angle < MRT_ANGLES)
            measured[angle] = log->value[record * log->channel_count + i];
        for (uint32_t finger = 0; finger < 4; ++finger)
            if (angle == (finger == 0 ? 6 : 5 + 4 * finger))
                identity.has_distal[finger] = true;
    }
    hand_calibrate(&identity, measured, out);
}

static mrt_result take_log(glove_motion *out, const log_data *log, const char *path, error *err)
{
    for (uint32_t i = 0; i < log->channel_count; ++i)
        if (strcmp(log->channel[i].unit, "rad") != 0 &&
            log->channel[i].semantic - MRT_CH_ANGLE < MRT_ANGLES)
            return error_set(err, MRT_ERR_FORMAT, "%s: %s is in %s, a motion wants rad", path,
                             log->channel[i].name, log->channel[i].unit);
    out->time_ns = calloc(log->record_count, sizeof *out->time_ns);
    out->angle_rad = calloc(log->record_count, GLOVE_SENSORS * sizeof *out->angle_rad);
    if (!out->time_ns || !out->angle_rad)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    out->record_count = log->record_count;
    memcpy(out->time_ns, log->time_ns, log->record_count * sizeof *out->time_ns);
    for (size_t i = 0; i < log->record_count; ++i)
        fill_angles(out->angle_rad + i * GLOVE_SENSORS, log, i);
    return MRT_OK;
}

mrt_result glove_motion_open(glove_motion *out, const char *what, error *err)
{
    *out = (glove_motion){0};
    out->is_still = strcmp(what, "still") == 0;
    if (out->is_still || strcmp(what, "sweep") == 0)
        return MRT_OK;
    char reason[LOG_REASON];
    log_file file;
    mrt_result result = log_file_read(&file, what, reason);
    if (result < 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", what, reason);
    log_data log;
    result = log_parse(&log, file.data, file.size, MRT_RIGHT, reason);
    free(file.data);
    if (result < 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: %s", what, reason);
    else
        result = take_log(out, &log, what, err);
    log_data_finish(&log);
    if (result < 0)
        glove_motion_finish(out);
    return result;
}

void glove_motion_finish(glove_motion *motion)
{
    free(motion->time_ns);
    free(motion->angle_rad);
    *motion = (glove_motion){0};
}

/* Up and down over the whole range, each sensor at a pace of its own. */
static void sweep_at(int64_t time_ns, uint8_t *out)
{
    enum { SPAN = RAW_MAX - RAW_MIN };
    for (int64_t i = 0; i < GLOVE_SENSORS; ++i) {
        int64_t way = time_ns / 1000000 * (4 + i) / 40 + 12 * i;
        int64_t at = way % (2 * SPAN);
        out[i] = (uint8_t)(RAW_MIN + (at <= SPAN ? at : 2 * SPAN - at));
    }
}

static size_t record_before(const glove_motion *motion, int64_t time_ns)
{
    size_t low = 0, high = motion->record_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (motion->time_ns[middle] <= time_ns)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void glove_motion_at(const glove_motion *motion, int64_t time_ns, uint8_t *out_sensor)
{
    if (motion->is_still)
        time_ns = 0;
    if (motion->record_count == 0) {
        sweep_at(time_ns, out_sensor);
        return;
    }
    int64_t length_ns = motion->time_ns[motion->record_count - 1];
    int64_t at_ns = length_ns > 0 ? time_ns % length_ns : 0;
    size_t before = record_before(motion, at_ns);
    size_t after = before + 1 < motion->record_count ? before + 1 : before;
    int64_t gap_ns = motion->time_ns[after] - motion->time_ns[before];
    float part = gap_ns > 0 ? (float)(at_ns - motion->time_ns[before]) / (float)gap_ns : 0.0f;
    hand_calibration calibration;
    hand_calibration_default(&calibration);
    for (size_t i = 0; i < GLOVE_SENSORS; ++i) {
        float a = motion->angle_rad[before * GLOVE_SENSORS + i];
        float b = motion->angle_rad[after * GLOVE_SENSORS + i];
        out_sensor[i] = raw_of(&calibration.sensor[i], a + part * (b - a));
    }
}

void glove_motion_number(uint8_t *sensor, uint32_t number)
{
    sensor[LOW_SENSOR] = (uint8_t)(1 + number % NUMBER_BASE);
    sensor[HIGH_SENSOR] = (uint8_t)(1 + number / NUMBER_BASE % NUMBER_BASE);
}

int32_t glove_motion_number_in(const mrt_channel *channel, const mrt_sample *sample)
{
    int32_t low = -1, high = -1;
    for (uint32_t i = 0; i < sample->count; ++i) {
        if (channel[i].semantic == MRT_CH_ANGLE + LOW_SENSOR)
            low = (int32_t)sample->value[i] - 1;
        if (channel[i].semantic == MRT_CH_ANGLE + HIGH_SENSOR)
            high = (int32_t)sample->value[i] - 1;
    }
    return low < 0 || high < 0 ? -1 : high * NUMBER_BASE + low;
}
