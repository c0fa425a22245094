#include "hand/virtualhand.h"

#include "base/file.h"
#include "base/text.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The contents of the text, before interpretation. */
enum { VIRTUALHAND_FINGERS = 6, VIRTUALHAND_JOINTS = 4 }; /* thumb .. little, and the wrist */

typedef struct virtualhand_gain {
    bool given;
    int32_t offset; /* 0..255 */
    double gain;    /* rad per count */
} virtualhand_gain;

typedef struct virtualhand_text {
    virtualhand_gain gain[VIRTUALHAND_FINGERS][VIRTUALHAND_JOINTS];
    bool has_geometry;
    uint32_t side;            /* from the geometry: MRT_LEFT, MRT_RIGHT */
    uint32_t fingers, joints; /* from the geometry */
    vec3 joint_cm[VIRTUALHAND_FINGERS][VIRTUALHAND_JOINTS]; /* origin wrist */
} virtualhand_text;

/* ---- reading the text ---- */

static const double CENTIMETRES_MAX = 1000.0, GAIN_MAX = 1e3;
enum { NUMBERS_MAX = 4, SHOWN_TEXT = 48 };

typedef struct virtualhand_reader {
    text_view rest;
    uint32_t line_number;
    const char *name;
    bool has_calibration, has_geometry;
    virtualhand_text *out;
    error *err;
} virtualhand_reader;

static mrt_result unexpected(const virtualhand_reader *self, text_view line, const char *expected)
{
    char shown[SHOWN_TEXT];
    text_copy(shown, sizeof shown, line);
    return error_set(self->err, MRT_ERR_FORMAT, "%.120s: line %u: expected %s, found \"%s\"",
                     self->name, self->line_number, expected, shown);
}

static mrt_result ended(const virtualhand_reader *self, const char *expected)
{
    return error_set(self->err, MRT_ERR_FORMAT, "%.120s: line %u: the file ends, expected %s",
                     self->name, self->line_number, expected);
}

static bool begins_with(text_view line, const char *words)
{
    size_t length = strlen(words);
    return (size_t)(line.end - line.at) >= length && memcmp(line.at, words, length) == 0;
}

/* Reads the next line that is neither empty nor a comment, trimmed. Returns false at the end. */
static bool next_line(virtualhand_reader *self, text_view *out)
{
    while (text_next_line(&self->rest, out)) {
        self->line_number += 1;
        *out = text_trim(*out);
        if (out->at != out->end && *out->at != '!')
            return true;
    }
    return false;
}

/* Reads `least` to `most` numbers; the line must contain nothing else. */
static bool read_numbers(text_view line, double *out, int least, int most)
{
    text_view word;
    int count = 0;
    while (text_next_word(&line, &word)) {
        if (count == most || !text_double(word, &out[count]))
            return false;
        count += 1;
    }
    return count >= least;
}

static mrt_result expect_numbers(virtualhand_reader *self, double *out, int least, int most,
                                 double cap, const char *expected)
{
    text_view line;
    double number[NUMBERS_MAX] = {0};
    if (!next_line(self, &line))
        return ended(self, expected);
    if (!read_numbers(line, number, least, most))
        return unexpected(self, line, expected);
    for (int i = 0; i < most; ++i) {
        if (!(number[i] >= -cap && number[i] <= cap))
            return unexpected(self, line, expected);
        out[i] = number[i];
    }
    return MRT_OK;
}

static bool read_whole(double number, int32_t low, int32_t high, int32_t *out)
{
    if (!(number >= low && number <= high) || number - (double)(int32_t)number != 0.0)
        return false;
    *out = (int32_t)number;
    return true;
}

/* ---- GLOVE CALIBRATION ---- */

static mrt_result read_joint(virtualhand_reader *self, uint32_t finger, int32_t joint)
{
    static const char expected[] = "\"joint offset gain gesture\", joints 0 to 3 in order";
    double number[NUMBERS_MAX] = {0};
    text_view line;
    int32_t index, offset;
    if (!next_line(self, &line))
        return ended(self, expected);
    if (!read_numbers(line, number, 3, 4) || !read_whole(number[0], joint, joint, &index) ||
        !read_whole(number[1], -32768, 65535, &offset))
        return unexpected(self, line, expected);
    if (!(number[2] >= -GAIN_MAX && number[2] <= GAIN_MAX))
        return unexpected(self, line, "a gain in rad per count");
    /* VirtualHand stores the lowest byte of the offset. */
    self->out->gain[finger][joint] =
        (virtualhand_gain){.given = true, .offset = offset & 0xff, .gain = number[2]};
    return MRT_OK;
}

static mrt_result read_finger(virtualhand_reader *self, text_view line)
{
    static const char expected[] = "\"FINGER 0:\" to \"FINGER 5:\", each once";
    text_view rest = line, word;
    (void)text_next_word(&rest, &word); /* the word FINGER */
    int64_t finger;
    if (!text_next_word(&rest, &word) || word.end == word.at || word.end[-1] != ':')
        return unexpected(self, line, expected);
    word.end -= 1;
    if (!text_int(word, &finger) || finger < 0 || finger >= VIRTUALHAND_FINGERS ||
        text_next_word(&rest, &word) || self->out->gain[finger][0].given)
        return unexpected(self, line, expected);
    for (int32_t joint = 0; joint < VIRTUALHAND_JOINTS; ++joint) {
        mrt_result result = read_joint(self, (uint32_t)finger, joint);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

/* ---- 3D HAND GEOMETRY ---- */

static mrt_result read_side(virtualhand_reader *self)
{
    static const char expected[] = "\"RIGHT HAND.\" or \"LEFT HAND.\"";
    text_view line;
    if (!next_line(self, &line))
        return ended(self, expected);
    bool is_right = begins_with(line, "RIGHT HAND");
    if (!is_right && !begins_with(line, "LEFT HAND"))
        return unexpected(self, line, expected);
    self->out->side = is_right ? MRT_RIGHT : MRT_LEFT;
    return MRT_OK;
}

static mrt_result read_counts(virtualhand_reader *self)
{
    static const char expected[] =
        "fingers (5 or 6), joints (2 to 4), thumb roll and hand roll in degrees";
    double number[NUMBERS_MAX] = {0};
    mrt_result result = expect_numbers(self, number, 4, 4, 1e4, expected);
    if (result < 0)
        return result;
    int32_t fingers, joints;
    if (!read_whole(number[0], 5, VIRTUALHAND_FINGERS, &fingers) ||
        !read_whole(number[1], 2, VIRTUALHAND_JOINTS, &joints))
        return error_set(self->err, MRT_ERR_FORMAT,
                         "%.120s: line %u: expected %s, found %g fingers and %g joints", self->name,
                         self->line_number, expected, number[0], number[1]);
    self->out->fingers = (uint32_t)fingers;
    self->out->joints = (uint32_t)joints;
    return MRT_OK;
}

static mrt_result read_shape(virtualhand_reader *self, uint32_t finger)
{
    double number[NUMBERS_MAX] = {0};
    mrt_result result = expect_numbers(self, number, 1, 1, 1e6, "a finger's colour, one number");
    for (uint32_t joint = 0; joint < self->out->joints && result >= 0; ++joint) {
        result =
            expect_numbers(self, number, 4, 4, CENTIMETRES_MAX, "a joint's \"x y z radius\" in cm");
        self->out->joint_cm[finger][joint] = (vec3){number[0], number[1], number[2]};
    }
    return result;
}

static mrt_result read_geometry(virtualhand_reader *self)
{
    double number[NUMBERS_MAX] = {0};
    mrt_result result = read_side(self);
    if (result >= 0)
        result = expect_numbers(self, number, 3, 3, CENTIMETRES_MAX, "the wrist's \"x y z\" in cm");
    if (result >= 0)
        result = read_counts(self);
    for (uint32_t finger = 0; result >= 0 && finger < self->out->fingers; ++finger)
        result = read_shape(self, finger);
    self->out->has_geometry = result >= 0;
    return result;
}

/* ---- the file ---- */

/* The geometry is followed by the pisiform, five points of the forearm and two axes of the thumb,
 * which marotte does not use. */
static bool is_point(text_view line)
{
    double number[NUMBERS_MAX] = {0};
    return read_numbers(line, number, 3, 3);
}

static mrt_result read_part(virtualhand_reader *self, text_view line)
{
    if (begins_with(line, "GLOVE CALIBRATION")) {
        if (self->has_calibration)
            return unexpected(self, line, "one GLOVE CALIBRATION only");
        self->has_calibration = true;
        return MRT_OK;
    }
    if (begins_with(line, "3D HAND GEOMETRY")) {
        if (self->has_geometry)
            return unexpected(self, line, "one 3D HAND GEOMETRY only");
        self->has_geometry = true;
        return read_geometry(self);
    }
    if (self->has_calibration && begins_with(line, "FINGER "))
        return read_finger(self, line);
    if (self->has_geometry && is_point(line))
        return MRT_OK;
    return unexpected(self, line,
                      "GLOVE CALIBRATION, FINGER k:, 3D HAND GEOMETRY or a comment with '!'");
}

static mrt_result read_version(virtualhand_reader *self)
{
    text_view line = {self->rest.at, self->rest.at};
    (void)text_next_line(&self->rest, &line);
    self->line_number = 1;
    if (begins_with(line, "VHv"))
        return MRT_OK;
    char shown[SHOWN_TEXT];
    text_copy(shown, sizeof shown, text_trim(line));
    return error_set(
        self->err, MRT_ERR_UNSUPPORTED,
        "%.120s: line 1: expected \"VHv...\", found \"%s\": this is not a VirtualHand 1.x text "
        "calibration. Files of the Device Configuration Utility (VirtualHand 2) have an "
        "unpublished layout and cannot be imported: calibrate with marotte calibrate --input",
        self->name, shown);
}

static mrt_result check_complete(const virtualhand_reader *self)
{
    for (int finger = 0; finger < VIRTUALHAND_FINGERS; ++finger)
        if (!self->out->gain[finger][0].given)
            return error_set(self->err, MRT_ERR_FORMAT,
                             "%.120s: FINGER %d is missing%s: expected FINGER 0 to 5 after GLOVE "
                             "CALIBRATION",
                             self->name, finger,
                             self->has_calibration ? "" : ", and so is GLOVE CALIBRATION");
    return MRT_OK;
}

/* Errors name the line and the expected contents. */
static mrt_result parse_text(virtualhand_text *out, const void *bytes, size_t size,
                             const char *name, error *err)
{
    memset(out, 0, sizeof *out);
    virtualhand_reader self = {
        .rest = text_view_of(bytes, size), .name = name, .out = out, .err = err};
    mrt_result result = read_version(&self);
    text_view line;
    while (result >= 0 && next_line(&self, &line))
        result = read_part(&self, line);
    return result < 0 ? result : check_complete(&self);
}

/* ---- interpretation ---- */

/* Gloves have 0.003 to 0.027 rad a count (hardware.md 2.1). A gain far outside was never
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

/* VirtualHand stores the gain of the middle-index spread with the index finger, which has no spread
 * sensor itself. The number of the middle finger is not used. */
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

/* Returns false if this sensor was never calibrated. */
static bool import_sensor(const virtualhand_text *text, int sensor, calibration_file *out)
{
    const sensor_facts *facts = &sensor_table[sensor];
    calibration_sensor *made = &out->sensor[sensor];
    struct entry entry = entry_of[sensor];
    double gain = gain_of(text, sensor), zero = (double)facts->zero;
    made->neutral_rad = facts->neutral_rad;
    bool is_usable = is_plausible(gain);
    if (!is_usable && is_distal(sensor))
        return false; /* the glove lacks this sensor, so the joint is estimated */
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
        calibration_file_note(out, "%s: %s: a gain of %g rad per count is impossible: %s", name,
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

/* Returns the length from the wrist along the joints of the middle finger to its tip. */
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
        calibration_file_note(out,
                              "%s: a hand of %.0f mm is impossible, so its length is left "
                              "out",
                              name, length);
}

mrt_result virtualhand_parse(calibration_file *out, const void *bytes, size_t size,
                             const char *name, uint32_t side, error *err)
{
    virtualhand_text text;
    calibration_file_init(out, side <= MRT_RIGHT ? side : MRT_RIGHT);
    mrt_result result = parse_text(&text, bytes, size, name, err);
    if (result < 0)
        return result;
    if (!text.has_geometry && side > MRT_RIGHT)
        return error_set(err, MRT_ERR_FORMAT,
                         "%.120s: the file has no 3D HAND GEOMETRY, so the side of the hand is "
                         "unknown. Use --hand left or --hand right",
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
