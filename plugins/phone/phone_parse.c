#include "phone_parse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const phone_name[PHONE_VALUES] = {
    "eyeBlinkLeft",
    "eyeLookDownLeft",
    "eyeLookInLeft",
    "eyeLookOutLeft",
    "eyeLookUpLeft",
    "eyeSquintLeft",
    "eyeWideLeft",
    "eyeBlinkRight",
    "eyeLookDownRight",
    "eyeLookInRight",
    "eyeLookOutRight",
    "eyeLookUpRight",
    "eyeSquintRight",
    "eyeWideRight",
    "jawForward",
    "jawLeft",
    "jawRight",
    "jawOpen",
    "mouthClose",
    "mouthFunnel",
    "mouthPucker",
    "mouthLeft",
    "mouthRight",
    "mouthSmileLeft",
    "mouthSmileRight",
    "mouthFrownLeft",
    "mouthFrownRight",
    "mouthDimpleLeft",
    "mouthDimpleRight",
    "mouthStretchLeft",
    "mouthStretchRight",
    "mouthRollLower",
    "mouthRollUpper",
    "mouthShrugLower",
    "mouthShrugUpper",
    "mouthPressLeft",
    "mouthPressRight",
    "mouthLowerDownLeft",
    "mouthLowerDownRight",
    "mouthUpperUpLeft",
    "mouthUpperUpRight",
    "browDownLeft",
    "browDownRight",
    "browInnerUp",
    "browOuterUpLeft",
    "browOuterUpRight",
    "cheekPuff",
    "cheekSquintLeft",
    "cheekSquintRight",
    "noseSneerLeft",
    "noseSneerRight",
    "tongueOut",
    "headYaw",
    "headPitch",
    "headRoll",
    "leftEyeYaw",
    "leftEyePitch",
    "leftEyeRoll",
    "rightEyeYaw",
    "rightEyePitch",
    "rightEyeRoll",
};

/* Of the values. */
enum {
    EYE_BLINK_LEFT = 0,
    EYE_WIDE_LEFT = 6,
    EYE_BLINK_RIGHT = 7,
    EYE_WIDE_RIGHT = 13,
    JAW_LEFT = 15,
    JAW_OPEN = 17,
    MOUTH_PUCKER = 20,
    MOUTH_LEFT = 21,
    MOUTH_SMILE_LEFT = 23,
    MOUTH_FROWN_LEFT = 25,
    MOUTH_STRETCH_LEFT = 29,
    BROW_DOWN_LEFT = 41,
    BROW_INNER_UP = 43,
    BROW_OUTER_UP_LEFT = 44,
    HEAD = 52,
    LEFT_EYE = 55,
    RIGHT_EYE = 58
};

static const float pi = 3.14159265f;

/* Returns false if the value is not finite: then the whole frame is rejected. */
static bool put(phone_frame *out, int index, float value)
{
    const float low = index < PHONE_SHAPES ? 0.0f : -pi, high = index < PHONE_SHAPES ? 1.0f : pi;
    if (!isfinite(value))
        return false;
    out->value[index] = value < low ? low : value > high ? high : value;
    out->is_told[index] = true;
    return true;
}

/* ---- Live Link Face: big-endian, texts with a length prefix ---- */

typedef struct reader {
    const uint8_t *at;
    size_t left;
} reader;

static bool take_word(reader *from, uint32_t *out)
{
    if (from->left < 4)
        return false;
    *out = (uint32_t)from->at[0] << 24 | (uint32_t)from->at[1] << 16 | (uint32_t)from->at[2] << 8 |
           from->at[3];
    from->at += 4;
    from->left -= 4;
    return true;
}

static bool take_float(reader *from, float *out)
{
    uint32_t word;
    if (!take_word(from, &word))
        return false;
    memcpy(out, &word, sizeof *out);
    return true;
}

static bool skip_text(reader *from)
{
    uint32_t size;
    if (!take_word(from, &size) || size > from->left)
        return false;
    from->at += size;
    from->left -= size;
    return true;
}

static bool take_time(reader *from, phone_frame *out)
{
    uint32_t frame, rate, per;
    float part;
    if (!take_word(from, &frame) || !take_float(from, &part) || !take_word(from, &rate) ||
        !take_word(from, &per))
        return false;
    out->has_time = rate > 0 && per > 0 && per <= rate && rate <= INT32_MAX && frame <= INT32_MAX &&
                    part >= 0.0f && part <= 1.0f;
    if (out->has_time)
        out->time_s = ((double)frame + (double)part) * per / rate;
    return true;
}

static bool parse_live_link(phone_frame *out, reader from, phone_laterals laterals)
{
    const int swap = laterals == PHONE_RIGHT_FIRST ? 1 : 0;
    from.at += 1;
    from.left -= 1;
    if (!skip_text(&from) || !skip_text(&from) || !take_time(&from, out))
        return false;
    if (from.left == 0) /* ends here while no face is tracked */
        return true;
    if (from.left != 1 + 4 * PHONE_VALUES || from.at[0] != PHONE_VALUES)
        return false;
    from.at += 1;
    from.left -= 1;
    for (int i = 0; i < PHONE_VALUES; ++i) {
        const bool is_lateral =
            i == JAW_LEFT || i == JAW_LEFT + 1 || i == MOUTH_LEFT || i == MOUTH_LEFT + 1;
        float value;
        /* each pair begins at an odd index */
        int index = !is_lateral || !swap ? i : i % 2 == 1 ? i + 1 : i - 1;
        if (!take_float(&from, &value) || !put(out, index, value))
            return false;
    }
    out->has_face = true;
    return true;
}

/* ---- iFacialMocap: text ---- */

typedef struct text {
    const char *at;
    size_t size;
} text;

/* Returns the text before the next `stop`, or the rest. */
static text cut(text *rest, char stop)
{
    const char *found = rest->size > 0 ? memchr(rest->at, stop, rest->size) : NULL;
    text part = {rest->at, found ? (size_t)(found - rest->at) : rest->size};
    size_t used = part.size + (found != NULL);
    rest->at += used;
    rest->size -= used;
    return part;
}

static bool read_number(text from, float *out)
{
    char copy[32];
    char *end;
    if (from.size == 0 || from.size >= sizeof copy)
        return false;
    memcpy(copy, from.at, from.size);
    copy[from.size] = '\0';
    if (strspn(copy, "+-.0123456789eE") != from.size)
        return false;
    *out = strtof(copy, &end);
    return *end == '\0' && isfinite(*out);
}

static bool is_text(text a, const char *b)
{
    return a.size == strlen(b) && memcmp(a.at, b, a.size) == 0;
}

/* "mouthSmile_L" is mouthSmileLeft. Returns -1 for an unknown name. */
static int find_shape(text name)
{
    char full[40];
    if (name.size < 3 || name.size + 8 > sizeof full)
        return -1;
    memcpy(full, name.at, name.size);
    full[name.size] = '\0';
    if (full[name.size - 2] == '_')
        memcpy(full + name.size - 2, full[name.size - 1] == 'L' ? "Left" : "Right",
               full[name.size - 1] == 'L' ? 5 : 6);
    for (int i = 0; i < PHONE_SHAPES; ++i)
        if (strcmp(full, phone_name[i]) == 0)
            return i;
    return -1;
}

/* Reads pitch, yaw, roll in degrees; ignores further numbers. */
static bool take_turn(phone_frame *out, int first, text numbers)
{
    static const int order[3] = {1, 0, 2}; /* the table has yaw first */
    for (int i = 0; i < 3; ++i) {
        float degrees;
        if (!read_number(cut(&numbers, ','), &degrees) ||
            !put(out, first + order[i], degrees * (pi / 180.0f)))
            return false;
    }
    return true;
}

static bool take_part(phone_frame *out, text part)
{
    text value = part;
    if (part.size > 0 && part.at[0] == '=')
        value = part = (text){part.at + 1, part.size - 1};
    if (part.size > 0 && memchr(part.at, '#', part.size)) {
        const text name = cut(&value, '#');
        const int first = is_text(name, "head")       ? HEAD
                          : is_text(name, "leftEye")  ? LEFT_EYE
                          : is_text(name, "rightEye") ? RIGHT_EYE
                                                      : -1;
        return first < 0 || take_turn(out, first, value);
    }
    const char separator = part.size > 0 && memchr(part.at, '&', part.size) ? '&' : '-';
    const text name = cut(&value, separator);
    const int index = find_shape(name);
    float number;
    if (is_text(name, "trackingStatus") && is_text(value, "0"))
        out->has_face = false;
    return index < 0 || (read_number(value, &number) && put(out, index, number / 100.0f));
}

static bool parse_ifacialmocap(phone_frame *out, const char *bytes, size_t size)
{
    text rest = {bytes, size};
    out->has_face = true;
    while (rest.size > 0)
        if (!take_part(out, cut(&rest, '|')))
            return false;
    for (int i = 0; i < PHONE_VALUES; ++i)
        if (out->is_told[i])
            return true;
    return false;
}

/* ---- OpenSeeFace: little-endian, fixed size per face ---- */

enum {
    FACE_BYTES = 1785,
    AT_WIDTH = 12, /* width and height of the picture */
    AT_OPEN = 20,  /* right, left */
    AT_HAS_3D = 28,
    AT_EULER = 49,
    AT_FEATURES = 1729
};

enum {
    FEATURE_EYE = 0,       /* left, right: -1 closed, 0 open, 1 wide */
    FEATURE_BROW_LEFT = 3, /* down, up */
    FEATURE_BROW_RIGHT = 6,
    FEATURE_CORNER_LEFT = 8, /* of the mouth: down, up */
    FEATURE_CORNER_RIGHT = 10,
    FEATURE_MOUTH_OPEN = 12,
    FEATURE_MOUTH_WIDE = 13,
    FEATURES = 14
};

static uint64_t little(const uint8_t *at, int size)
{
    uint64_t word = 0;
    for (int i = size - 1; i >= 0; --i)
        word = word << 8 | at[i];
    return word;
}

static float little_float(const uint8_t *at)
{
    const uint32_t word = (uint32_t)little(at, 4);
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* Degrees to rad, within half a turn. */
static float turn_of(float degrees)
{
    return remainderf(degrees, 360.0f) * (pi / 180.0f);
}

static bool put_side(phone_frame *out, const float *feature, int side, float is_open)
{
    const float brow = feature[side ? FEATURE_BROW_RIGHT : FEATURE_BROW_LEFT];
    const float corner = feature[side ? FEATURE_CORNER_RIGHT : FEATURE_CORNER_LEFT];
    return put(out, side ? EYE_BLINK_RIGHT : EYE_BLINK_LEFT, 1.0f - is_open) &&
           put(out, side ? EYE_WIDE_RIGHT : EYE_WIDE_LEFT, feature[FEATURE_EYE + side]) &&
           put(out, BROW_OUTER_UP_LEFT + side, brow) && put(out, BROW_DOWN_LEFT + side, -brow) &&
           put(out, MOUTH_SMILE_LEFT + side, corner) &&
           put(out, MOUTH_FROWN_LEFT + side, -corner) &&
           put(out, MOUTH_STRETCH_LEFT + side, feature[FEATURE_MOUTH_WIDE]);
}

/* Any 1785 bytes could be a face: rejects values that a camera cannot produce. */
static bool is_sane(const uint8_t *bytes)
{
    const float width = little_float(bytes + AT_WIDTH), height = little_float(bytes + AT_WIDTH + 4);
    if (!(width >= 1.0f && width <= 65536.0f && height >= 1.0f && height <= 65536.0f))
        return false;
    for (int i = 0; i < 3; ++i)
        if (!(fabsf(little_float(bytes + AT_EULER + 4 * i)) <= 3600.0f))
            return false;
    for (int i = 0; i < FEATURES; ++i)
        if (!(fabsf(little_float(bytes + AT_FEATURES + 4 * i)) <= 1000.0f))
            return false;
    return true;
}

/* Reads the first of several faces. Maps its features to the nearest shapes of ARKit. */
static bool parse_openseeface(phone_frame *out, const uint8_t *bytes)
{
    const uint64_t time = little(bytes, 8);
    float feature[FEATURES];
    memcpy(&out->time_s, &time, sizeof out->time_s);
    out->has_time = isfinite(out->time_s) && fabs(out->time_s) < 9e9;
    if (!is_sane(bytes))
        return false;
    if (bytes[AT_HAS_3D] == 0)
        return true;
    for (int i = 0; i < FEATURES; ++i)
        feature[i] = little_float(bytes + AT_FEATURES + 4 * i);
    const uint8_t *euler = bytes + AT_EULER;
    out->has_face = true;
    return put_side(out, feature, 0, little_float(bytes + AT_OPEN + 4)) &&
           put_side(out, feature, 1, little_float(bytes + AT_OPEN)) &&
           put(out, BROW_INNER_UP,
               0.5f * (feature[FEATURE_BROW_LEFT] + feature[FEATURE_BROW_RIGHT])) &&
           put(out, JAW_OPEN, feature[FEATURE_MOUTH_OPEN]) &&
           put(out, MOUTH_PUCKER, -feature[FEATURE_MOUTH_WIDE]) &&
           put(out, HEAD, turn_of(little_float(euler + 4))) &&
           put(out, HEAD + 1, -turn_of(little_float(euler) + 180.0f)) &&
           put(out, HEAD + 2, turn_of(little_float(euler + 8) - 90.0f));
}

phone_protocol phone_parse(phone_frame *out, const void *bytes, size_t size,
                           phone_laterals laterals)
{
    static const uint8_t live_link_version = 6;
    const uint8_t *first = bytes;
    memset(out, 0, sizeof *out);
    if (size > 0 && first[0] == live_link_version)
        return parse_live_link(out, (reader){first, size}, laterals) ? PHONE_LIVE_LINK : PHONE_NONE;
    if (size > 0 && size % FACE_BYTES == 0 && !memchr(bytes, '|', size < 64 ? size : 64))
        return parse_openseeface(out, first) ? PHONE_OPENSEEFACE : PHONE_NONE;
    return parse_ifacialmocap(out, bytes, size) ? PHONE_IFACIALMOCAP : PHONE_NONE;
}
