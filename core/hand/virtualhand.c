#include "hand/virtualhand.h"

#include "base/file.h"
#include "hand/calibration_line.h"
#include "hand/sensor.h"
#include "hand/virtualhand_text.h"

#include <math.h>
#include <string.h>

/* Gloves have 0.003 to 0.027 rad a count (hardware.md 2.1). What is far from that was never
 * calibrated: VirtualHand's placeholder is 0.4. */
static const double GAIN_LEAST = 0.0005, GAIN_MOST = 0.1;
enum { JOINT_SPREAD = 3, FINGER_INDEX = 1, FINGER_MIDDLE = 2 };

/* Finger and joint of each sensor: the bits of the glove's sensor mask (hardware.md 1.3). */
static const struct entry {
    uint8_t finger, joint;
} entry_of[MRT_ANGLES] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 0}, {1, 1}, {1, 2}, {2, 0},
                          {2, 1}, {2, 2}, {2, 3}, {3, 0}, {3, 1}, {3, 2}, {3, 3}, {4, 0},
                          {4, 1}, {4, 2}, {4, 3}, {5, 0}, {5, 1}, {5, 2}};

static bool is_plausible(double gain)
{
    return fabs(gain) >= GAIN_LEAST && fabs(gain) <= GAIN_MOST;
}

/* VirtualHand keeps the gain of the middle-index spread with the index finger, which has no such
 * sensor of its own; the middle finger's is another number. */
static double gain_of(const virtualhand_text *text, int sensor)
{
    struct entry entry = entry_of[sensor];
    double own = text->gain[entry.finger][entry.joint].gain;
    double beside = text->gain[FINGER_INDEX][JOINT_SPREAD].gain;
    bool is_middle_spread = entry.finger == FINGER_MIDDLE && entry.joint == JOINT_SPREAD;
    return is_middle_spread && is_plausible(beside) ? beside : own;
}

static bool is_distal(int sensor)
{
    for (int finger = 0; finger < SENSOR_DISTAL_COUNT; ++finger)
        if (sensor_distal[finger] == sensor)
            return true;
    return false;
}

/* False: this sensor was never calibrated. */
static bool import_sensor(const virtualhand_text *text, int sensor, calibration_file *out)
{
    const sensor_facts *facts = &sensor_table[sensor];
    calibration_sensor *made = &out->sensor[sensor];
    struct entry entry = entry_of[sensor];
    double gain = gain_of(text, sensor), zero = (double)facts->zero;
    made->neutral_rad = facts->neutral_rad;
    bool is_usable = is_plausible(gain);
    if (!is_usable && is_distal(sensor))
        return false; /* a glove without it: the joint is estimated */
    if (is_usable) {
        made->source = CALIBRATION_IMPORTED;
        zero = (double)text->gain[entry.finger][entry.joint].offset;
        gain = copysign(gain, (double)facts->gain);
    } else {
        gain = (double)facts->gain;
    }
    made->table = calibration_line(sensor, gain, zero, (double)facts->rad_at_zero);
    return is_usable;
}

static mrt_result import_sensors(const virtualhand_text *text, const char *name,
                                 calibration_file *out, error *err)
{
    int imported = 0;
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        if (import_sensor(text, sensor, out)) {
            imported += 1;
            continue;
        }
        calibration_file_note(out, "%s: %s: a gain of %g rad per count is none: %s", name,
                              sensor_table[sensor].name, gain_of(text, sensor),
                              is_distal(sensor) ? "the joint is estimated" : "shipped default");
    }
    if (imported == 0)
        return error_set(
            err, MRT_ERR_FORMAT,
            "%.120s: no sensor has a gain that a glove can have (0.0005 to 0.1 rad per "
            "count): this hand was never calibrated",
            name);
    return MRT_OK;
}

/* From the wrist along the joints of the middle finger to its tip. */
static double length_mm(const virtualhand_text *text)
{
    vec3 at = {0, 0, 0};
    double length_cm = 0;
    for (uint32_t joint = 0; joint < text->joints; ++joint) {
        vec3 next = text->joint_cm[FINGER_MIDDLE][joint];
        length_cm += vec3_length(vec3_sub(next, at));
        at = next;
    }
    return 10.0 * length_cm;
}

static void import_length(const virtualhand_text *text, const char *name, calibration_file *out)
{
    double length = length_mm(text);
    if (length >= HAND_LENGTH_MIN_MM && length <= HAND_LENGTH_MAX_MM)
        out->hand_length_mm = length;
    else
        calibration_file_note(out, "%s: a hand of %.0f mm is none: its length is left open", name,
                              length);
}

mrt_result virtualhand_parse(calibration_file *out, const void *bytes, size_t size,
                             const char *name, uint32_t side, error *err)
{
    virtualhand_text text;
    calibration_file_init(out, side <= MRT_RIGHT ? side : MRT_RIGHT);
    mrt_result result = virtualhand_text_parse(&text, bytes, size, name, err);
    if (result < 0)
        return result;
    if (!text.has_geometry && side > MRT_RIGHT)
        return error_set(err, MRT_ERR_FORMAT,
                         "%.120s: there is no 3D HAND GEOMETRY to say whose hand it is: say --hand "
                         "left or --hand right",
                         name);
    if (text.has_geometry) {
        out->side = text.side;
        import_length(&text, name, out);
    }
    result = import_sensors(&text, name, out, err);
    if (result < 0)
        calibration_file_init(out, MRT_RIGHT);
    return result;
}

mrt_result virtualhand_read(calibration_file *out, const char *path, uint32_t side, error *err)
{
    file_bytes bytes;
    calibration_file_init(out, MRT_RIGHT);
    mrt_result result = file_read(&bytes, path, CALIBRATION_FILE_CAP, err);
    if (result < 0)
        return result;
    result = virtualhand_parse(out, bytes.data, bytes.size, path, side, err);
    file_bytes_finish(&bytes);
    return result;
}
