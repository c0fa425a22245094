#include "osc_event.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- finger bones of VMC ---- */

/* Sensor order of plugin.h. */
enum {
    THUMB_ROLL = 0,
    THUMB_MPJ = 1,
    THUMB_IJ = 2,
    THUMB_ABDUCTION = 3,
    MIDDLE_INDEX_SPREAD = 10,
    RING_MIDDLE_SPREAD = 14,
    LITTLE_RING_SPREAD = 18,
    WRIST_PITCH = 20,
    WRIST_YAW = 21
};
static const int finger_mpj[4] = {4, 7, 11, 15}; /* index..little; PIJ and DIJ follow */
static const char *const finger_name[5] = {"Thumb", "Index", "Middle", "Ring", "Little"};
static const char *const joint_name[3] = {"Proximal", "Intermediate", "Distal"};

static const double half_turn_rad = 3.14159265358979323846;
/* In the T-pose the thumb is at 45 degrees to the fingers. In marotte's skeleton (core/hand) a
 * thumb abduction of 0 is at 0.15 rad. */
static const double thumb_rest_rad = 3.14159265358979323846 / 4 - 0.15;

/* Removes the word from the front of the text. */
static bool skip_word(const char **text, const char *word)
{
    size_t length = strlen(word);
    if (strncmp(*text, word, length) != 0)
        return false;
    *text += length;
    return true;
}

bool osc_vmc_bone_find(osc_vmc_bone *out, const char *name)
{
    if (skip_word(&name, "Left"))
        out->side = MRT_LEFT;
    else if (skip_word(&name, "Right"))
        out->side = MRT_RIGHT;
    else
        return false;
    out->joint = 0;
    out->finger = OSC_VMC_HAND;
    if (strcmp(name, "Hand") == 0)
        return true;
    for (out->finger = 0; out->finger < 5; ++out->finger)
        if (skip_word(&name, finger_name[out->finger]))
            break;
    if (out->finger == 5)
        return false;
    out->joint = OSC_VMC_METACARPAL;
    if (out->finger == OSC_VMC_THUMB && strcmp(name, "Metacarpal") == 0)
        return true;
    for (out->joint = 0; out->joint < 3; ++out->joint)
        if (strcmp(name, joint_name[out->joint]) == 0)
            return true;
    return false;
}

void osc_vmc_settle(osc_vmc_pose *pose, osc_vmc_bone *bone)
{
    if (bone->finger != OSC_VMC_THUMB)
        return;
    if (bone->joint == OSC_VMC_METACARPAL)
        pose->is_vrm1 = true;
    else if (bone->joint == 1)
        pose->is_vrm1 = false;
    if (bone->joint == OSC_VMC_METACARPAL)
        bone->joint = 0;
    else if (bone->joint == 0 && pose->is_vrm1)
        bone->joint = 1;
}

/* Returns the rotation about one axis in a quaternion, -pi..pi: twice the angle of its part along
 * the axis against w. In a product of a rotation about this axis and one about another axis, in
 * either order, this is the former. */
static double turn_about(double along, double w)
{
    double turn_rad = 2 * atan2(along, w);
    if (turn_rad > half_turn_rad)
        turn_rad -= 2 * half_turn_rad;
    if (turn_rad < -half_turn_rad)
        turn_rad += 2 * half_turn_rad;
    return turn_rad;
}

/* Rotations of a bone, as for a right hand. */
typedef struct turns {
    double flexion_rad;      /* fingers and wrist: flexion to the palm */
    double aside_rad;        /* to the thumb's side */
    double across_rad;       /* base of the thumb: rotation across the palm */
    double thumb_inward_rad; /* thumb: flexion to the fingers */
} turns;

static turns turns_of(uint32_t side, const float *xyzw)
{
    double mirror = side == MRT_RIGHT ? 1 : -1, w = (double)xyzw[3];
    double x = (double)xyzw[0], y = mirror * (double)xyzw[1], z = mirror * (double)xyzw[2];
    return (turns){.flexion_rad = -turn_about(z, w),
                   .aside_rad = -turn_about(y, w),
                   .across_rad = turn_about(x, w),
                   .thumb_inward_rad = turn_about(y, w)};
}

static void apply_thumb(uint32_t joint, const turns *made, float *angle_rad)
{
    if (joint == 0) {
        angle_rad[THUMB_ROLL] = (float)made->across_rad;
        angle_rad[THUMB_ABDUCTION] = (float)(thumb_rest_rad - made->thumb_inward_rad);
    } else {
        angle_rad[joint == 1 ? THUMB_MPJ : THUMB_IJ] = (float)made->thumb_inward_rad;
    }
}

static void apply_spreads(const osc_vmc_pose *pose, float *angle_rad)
{
    const double *aside_rad = pose->aside_rad;
    angle_rad[MIDDLE_INDEX_SPREAD] = (float)(aside_rad[0] - aside_rad[1]);
    angle_rad[RING_MIDDLE_SPREAD] = (float)(aside_rad[1] - aside_rad[2]);
    angle_rad[LITTLE_RING_SPREAD] = (float)(aside_rad[2] - aside_rad[3]);
}

void osc_vmc_apply(osc_vmc_pose *pose, const osc_vmc_bone *bone, const float *xyzw,
                   float *angle_rad)
{
    turns made = turns_of(bone->side, xyzw);
    if (bone->finger == OSC_VMC_HAND) {
        angle_rad[WRIST_PITCH] = (float)made.flexion_rad;
        angle_rad[WRIST_YAW] = (float)made.aside_rad;
        return;
    }
    if (bone->finger == OSC_VMC_THUMB) {
        apply_thumb(bone->joint, &made, angle_rad);
        return;
    }
    uint32_t finger = bone->finger - OSC_VMC_INDEX;
    angle_rad[finger_mpj[finger] + (int)bone->joint] = (float)made.flexion_rad;
    if (bone->joint > 0)
        return;
    pose->aside_rad[finger] = made.aside_rad;
    apply_spreads(pose, angle_rad);
}

/* ---- the channels of a source ---- */

bool osc_table_is_text(const char *text, size_t capacity)
{
    if (!text)
        return false;
    size_t length = 0;
    for (; text[length] != '\0'; ++length)
        if ((unsigned char)text[length] < 0x20 || text[length] == 0x7f || length + 1 >= capacity)
            return false;
    return true;
}

static bool is_channel(const mrt_channel *channel)
{
    return osc_table_is_text(channel->name, OSC_NAME_LENGTH) &&
           osc_table_is_text(channel->unit, OSC_UNIT_LENGTH) && channel->hand <= MRT_NO_HAND &&
           channel->semantic <= INT32_MAX && isfinite(channel->min) && isfinite(channel->max);
}

static void point_to_own_texts(osc_table *table)
{
    for (uint32_t i = 0; i < table->count; ++i) {
        table->channel[i].name = table->name[i];
        table->channel[i].unit = table->unit[i];
    }
}

bool osc_table_set(osc_table *out, const char *source, int32_t version, const mrt_channel *channels,
                   uint32_t count)
{
    if (!osc_table_is_text(source, OSC_SOURCE_LENGTH) || source[0] == '\0' || !channels ||
        count == 0 || count > MRT_MAX_CHANNELS)
        return false;
    for (uint32_t i = 0; i < count; ++i)
        if (!is_channel(&channels[i]))
            return false;
    memset(out, 0, sizeof *out);
    snprintf(out->source, sizeof out->source, "%s", source);
    out->version = version;
    out->count = count;
    for (uint32_t i = 0; i < count; ++i) {
        out->channel[i] = channels[i];
        snprintf(out->name[i], OSC_NAME_LENGTH, "%s", channels[i].name);
        snprintf(out->unit[i], OSC_UNIT_LENGTH, "%s", channels[i].unit);
    }
    point_to_own_texts(out);
    return true;
}

void osc_table_copy(osc_table *out, const osc_table *from)
{
    *out = *from;
    point_to_own_texts(out);
}

static bool is_same_channel(const mrt_channel *a, const mrt_channel *b)
{
    return a->semantic == b->semantic && a->hand == b->hand && a->min == b->min &&
           a->max == b->max && strcmp(a->name, b->name) == 0 && strcmp(a->unit, b->unit) == 0;
}

bool osc_table_has(const osc_table *table, const mrt_channel *channels, uint32_t count)
{
    if (table->count != count)
        return false;
    for (uint32_t i = 0; i < count; ++i)
        if (!channels[i].name || !channels[i].unit ||
            !is_same_channel(&table->channel[i], &channels[i]))
            return false;
    return true;
}

size_t osc_table_write(const osc_table *table, void *out, size_t capacity)
{
    osc_builder builder = osc_builder_start();
    osc_builder_text(&builder, table->source);
    osc_builder_int32(&builder, table->version);
    for (uint32_t i = 0; i < table->count; ++i) {
        const mrt_channel *channel = &table->channel[i];
        osc_builder_text(&builder, channel->name);
        osc_builder_text(&builder, channel->unit);
        osc_builder_int32(&builder, (int32_t)channel->semantic);
        osc_builder_int32(&builder, (int32_t)channel->hand);
        osc_builder_float(&builder, channel->min);
        osc_builder_float(&builder, channel->max);
    }
    return osc_builder_finish(&builder, "/marotte/1/channels", out, capacity);
}

size_t osc_table_write_sample(const osc_table *table, const mrt_sample *sample, int64_t sent_ns,
                              void *out, size_t capacity)
{
    osc_builder builder = osc_builder_start();
    osc_builder_text(&builder, table->source);
    osc_builder_int32(&builder, table->version);
    int32_t sequence;
    memcpy(&sequence, &sample->sequence, sizeof sequence);
    osc_builder_int32(&builder, sequence);
    osc_builder_int64(&builder, sample->time_ns);
    osc_builder_int64(&builder, sent_ns);
    for (uint32_t i = 0; i < sample->count; ++i)
        osc_builder_float(&builder, sample->value[i]);
    return osc_builder_finish(&builder, "/marotte/1/sample", out, capacity);
}

size_t osc_table_write_end(const osc_table *table, void *out, size_t capacity)
{
    osc_builder builder = osc_builder_start();
    osc_builder_text(&builder, table->source);
    osc_builder_int32(&builder, table->version);
    return osc_builder_finish(&builder, "/marotte/1/end", out, capacity);
}

/* ---- reading ---- */

/* Two turns, in either direction: a larger value is not a joint's angle, but probably degrees. */
static const double angle_max_rad = 2 * 3.14159265358979323846;
static const double distance_max_mm = 100000;

static osc_fault refuse(osc_event *out, osc_fault fault, const char *expected)
{
    out->kind = OSC_EVENT_NONE;
    out->expected = expected;
    return fault;
}

/* Reads numbers of any type, starting at argument `from`. */
static bool read_numbers(osc_event *out, const osc_message *message, uint32_t from, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        double number;
        if (!osc_message_number(message, from + i, &number))
            return false;
        out->value[i] = (float)number;
    }
    out->count = count;
    return true;
}

static bool are_within(const float *value, uint32_t count, double max)
{
    for (uint32_t i = 0; i < count; ++i)
        if (!(fabs((double)value[i]) <= max))
            return false;
    return true;
}

/* Returns true for a valid rotation: finite, and of a length near 1. */
static bool is_quaternion(const float *xyzw)
{
    double squared = 0;
    for (int i = 0; i < 4; ++i)
        squared += (double)xyzw[i] * (double)xyzw[i];
    return squared > 0.25 && squared < 4;
}

/* ---- hands and pedals ---- */

static osc_fault read_angles(osc_event *out, const osc_message *message)
{
    if (message->count != MRT_ANGLES || !read_numbers(out, message, 0, MRT_ANGLES))
        return refuse(out, OSC_FAULT_TYPES,
                      "expected 22 numbers: rad, in the order of the sensors");
    if (!are_within(out->value, out->count, angle_max_rad))
        return refuse(out, OSC_FAULT_VALUE, "expected angles in rad, finite and within +-6.28");
    out->kind = OSC_EVENT_ANGLES;
    out->first = 0;
    return OSC_FAULT_NONE;
}

static osc_fault read_joint(osc_event *out, const osc_message *message)
{
    int32_t first;
    if (message->count < 2 || message->count > 1 + MRT_ANGLES ||
        !osc_message_int32(message, 0, &first) ||
        !read_numbers(out, message, 1, message->count - 1))
        return refuse(out, OSC_FAULT_TYPES,
                      "expected a sensor number (0 to 21), then angles in rad");
    if (first < 0 || first >= MRT_ANGLES || (uint32_t)first + out->count > MRT_ANGLES)
        return refuse(out, OSC_FAULT_VALUE, "expected sensors 0 to 21");
    if (!are_within(out->value, out->count, angle_max_rad))
        return refuse(out, OSC_FAULT_VALUE, "expected angles in rad, finite and within +-6.28");
    out->kind = OSC_EVENT_ANGLES;
    out->first = (uint32_t)first;
    return OSC_FAULT_NONE;
}

static osc_fault read_wrist(osc_event *out, const osc_message *message)
{
    if (message->count != 7 || !read_numbers(out, message, 0, 7))
        return refuse(out, OSC_FAULT_TYPES, "expected 7 numbers: x y z in mm, qx qy qz qw");
    if (!are_within(out->value, 3, distance_max_mm) || !is_quaternion(out->value + 3))
        return refuse(out, OSC_FAULT_VALUE,
                      "expected x y z in mm within 100 m, and a quaternion of length 1");
    out->kind = OSC_EVENT_WRIST;
    return OSC_FAULT_NONE;
}

static osc_fault read_pedal(osc_event *out, const osc_message *message)
{
    int32_t number;
    if (message->count != 2 || !osc_message_int32(message, 0, &number) ||
        !read_numbers(out, message, 1, 1))
        return refuse(out, OSC_FAULT_TYPES,
                      "expected a pedal number (1 to 4), then 0 (up) to 1 (down)");
    if (number < 1 || number > MRT_MAX_PEDALS || !(out->value[0] >= 0 && out->value[0] <= 1))
        return refuse(out, OSC_FAULT_VALUE, "expected pedal 1 to 4, and 0 (up) to 1 (down)");
    out->kind = OSC_EVENT_PEDAL;
    out->first = (uint32_t)number - 1;
    return OSC_FAULT_NONE;
}

/* ---- VMC ---- */

static osc_fault read_bone(osc_event *out, const osc_message *message)
{
    const char *name = osc_message_text(message, 0);
    if (!name || message->count != 8 || !read_numbers(out, message, 1, 7))
        return refuse(out, OSC_FAULT_TYPES,
                      "expected the bone's name and 7 numbers: position, quaternion x y z w");
    if (!osc_vmc_bone_find(&out->bone, name))
        return OSC_FAULT_NONE; /* drop the position, keep the rotation */
    memmove(out->value, out->value + 3, 4 * sizeof *out->value);
    if (!is_quaternion(out->value))
        return refuse(out, OSC_FAULT_VALUE, "expected a quaternion of length 1");
    out->kind = OSC_EVENT_BONE;
    out->side = out->bone.side;
    out->count = 4;
    return OSC_FAULT_NONE;
}

static osc_fault give_control(osc_event *out, uint32_t control, float value)
{
    out->kind = OSC_EVENT_CONTROL;
    out->first = control;
    out->count = 1;
    out->value[0] = value;
    return OSC_FAULT_NONE;
}

/* Ignores controllers without a channel, and other keys. */
static osc_fault read_controller(osc_event *out, const osc_message *message)
{
    int32_t number;
    if (message->count != 2 || !osc_message_int32(message, 0, &number) ||
        !read_numbers(out, message, 1, 1))
        return refuse(out, OSC_FAULT_TYPES, "expected a controller number and its value");
    if (!(out->value[0] >= 0 && out->value[0] <= 1))
        return refuse(out, OSC_FAULT_VALUE, "expected a value from 0 to 1");
    if (number < 0 || number >= OSC_CONTROLLERS)
        return OSC_FAULT_NONE;
    return give_control(out, (uint32_t)number, out->value[0]);
}

static osc_fault read_key(osc_event *out, const osc_message *message)
{
    int32_t is_down;
    const char *name = osc_message_text(message, 1);
    if (message->count != 3 || !osc_message_int32(message, 0, &is_down) || !name)
        return refuse(out, OSC_FAULT_TYPES, "expected 1 (down) or 0, a key's name and its code");
    const char letter = (char)(name[0] >= 'a' && name[0] <= 'z' ? name[0] - 'a' + 'A' : name[0]);
    if (letter < 'A' || letter > 'Z' || name[1] != '\0')
        return OSC_FAULT_NONE;
    return give_control(out, OSC_CONTROLLERS + (uint32_t)(letter - 'A'), is_down != 0 ? 1 : 0);
}

static osc_fault read_frame(osc_event *out, const osc_message *message)
{
    (void)message;
    out->kind = OSC_EVENT_FRAME;
    return OSC_FAULT_NONE;
}

/* ---- from one marotte to another ---- */

static osc_fault read_source(osc_event *out, const osc_message *message)
{
    const char *source = osc_message_text(message, 0);
    if (!source || !osc_message_int32(message, 1, &out->version))
        return refuse(out, OSC_FAULT_TYPES, "expected a source's name and a version");
    if (source[0] == '\0' || !osc_table_is_text(source, OSC_SOURCE_LENGTH))
        return refuse(out, OSC_FAULT_VALUE, "expected a source's name of 1 to 95 letters");
    snprintf(out->source, sizeof out->source, "%s", source);
    return OSC_FAULT_NONE;
}

enum { CHANNEL_ARGUMENTS = 6 };

static bool read_channel(mrt_channel *out, const osc_message *message, uint32_t from)
{
    int32_t semantic = 0, hand = 0;
    *out = (mrt_channel){.name = osc_message_text(message, from),
                         .unit = osc_message_text(message, from + 1)};
    bool complete = out->name && out->unit && osc_message_int32(message, from + 2, &semantic) &&
                    osc_message_int32(message, from + 3, &hand) &&
                    osc_message_float(message, from + 4, &out->min) &&
                    osc_message_float(message, from + 5, &out->max);
    /* A negative number becomes one that is out of range. */
    out->semantic = (uint32_t)semantic;
    out->hand = (uint32_t)hand;
    return complete;
}

static osc_fault read_channels(osc_event *out, const osc_message *message)
{
    osc_fault fault = read_source(out, message);
    if (fault != OSC_FAULT_NONE)
        return fault;
    uint32_t count = (message->count - 2) / CHANNEL_ARGUMENTS;
    mrt_channel channel[MRT_MAX_CHANNELS];
    static const char *const expected =
        "expected name, unit, semantic, hand, min, max for each of 1 to 64 channels";
    if (count == 0 || count > MRT_MAX_CHANNELS || (message->count - 2) % CHANNEL_ARGUMENTS != 0)
        return refuse(out, OSC_FAULT_TYPES, expected);
    for (uint32_t i = 0; i < count; ++i)
        if (!read_channel(&channel[i], message, 2 + i * CHANNEL_ARGUMENTS))
            return refuse(out, OSC_FAULT_TYPES, expected);
    if (!osc_table_set(&out->table, out->source, out->version, channel, count))
        return refuse(out, OSC_FAULT_VALUE, expected);
    out->kind = OSC_EVENT_CHANNELS;
    return OSC_FAULT_NONE;
}

static bool is_time(int64_t time_ns)
{
    return time_ns >= -OSC_TIME_MAX_NS && time_ns <= OSC_TIME_MAX_NS;
}

static osc_fault read_sample(osc_event *out, const osc_message *message)
{
    enum { HEAD = 5 };
    osc_fault fault = read_source(out, message);
    if (fault != OSC_FAULT_NONE)
        return fault;
    int32_t sequence;
    if (!osc_message_int32(message, 2, &sequence) ||
        !osc_message_int64(message, 3, &out->time_ns) ||
        !osc_message_int64(message, 4, &out->sent_ns) || message->count <= HEAD ||
        message->count > HEAD + MRT_MAX_CHANNELS)
        return refuse(out, OSC_FAULT_TYPES,
                      "expected source, version, sequence, two times, 1 to 64 values");
    out->count = message->count - HEAD;
    for (uint32_t i = 0; i < out->count; ++i)
        if (!osc_message_float(message, HEAD + i, &out->value[i]))
            return refuse(out, OSC_FAULT_TYPES, "expected values of type f");
    if (!is_time(out->time_ns) || !is_time(out->sent_ns) || out->sent_ns < out->time_ns ||
        !are_within(out->value, out->count, (double)FLT_MAX))
        return refuse(out, OSC_FAULT_VALUE,
                      "expected finite values, and a send time that is not before the measurement");
    out->sequence = (uint32_t)sequence;
    out->kind = OSC_EVENT_SAMPLE;
    return OSC_FAULT_NONE;
}

static osc_fault read_end(osc_event *out, const osc_message *message)
{
    osc_fault fault = read_source(out, message);
    if (fault == OSC_FAULT_NONE)
        out->kind = OSC_EVENT_END;
    return fault;
}

/* ---- any message ---- */

static const struct {
    const char *address;
    uint32_t side;
    osc_fault (*read)(osc_event *out, const osc_message *message);
} messages[] = {
    {"/marotte/1/sample", MRT_NO_HAND, read_sample},
    {"/marotte/1/channels", MRT_NO_HAND, read_channels},
    {"/marotte/1/end", MRT_NO_HAND, read_end},
    {"/marotte/hand/left/angles", MRT_LEFT, read_angles},
    {"/marotte/hand/left/joint", MRT_LEFT, read_joint},
    {"/marotte/hand/left/wrist", MRT_LEFT, read_wrist},
    {"/marotte/hand/right/angles", MRT_RIGHT, read_angles},
    {"/marotte/hand/right/joint", MRT_RIGHT, read_joint},
    {"/marotte/hand/right/wrist", MRT_RIGHT, read_wrist},
    {"/marotte/pedal", MRT_NO_HAND, read_pedal},
    {"/VMC/Ext/Bone/Pos", MRT_NO_HAND, read_bone},
    {"/VMC/Ext/Midi/CC/Val", MRT_NO_HAND, read_controller},
    {"/VMC/Ext/Key", MRT_NO_HAND, read_key},
    {"/VMC/Ext/T", MRT_NO_HAND, read_frame},
    {"/VMC/Ext/OK", MRT_NO_HAND, read_frame},
};

/* Expected message for an unknown address, by its prefix. NULL: ignore it. */
static const struct {
    const char *prefix, *expected;
} others[] = {
    {"/VMC/", NULL},
    {"/marotte/hand/left/", "expected angles, joint or wrist of a hand"},
    {"/marotte/hand/right/", "expected angles, joint or wrist of a hand"},
    {"/marotte/hand/", "expected left or right after /marotte/hand/"},
    {"/marotte/", "this version of marotte does not support this message"},
    {"", "not a message of marotte or VMC"},
};

osc_fault osc_event_read(osc_event *out, const osc_message *message)
{
    out->kind = OSC_EVENT_NONE;
    out->side = MRT_NO_HAND;
    out->first = out->count = 0;
    out->tag_ns = message->tag_ns;
    out->expected = "";
    for (size_t i = 0; i < sizeof messages / sizeof *messages; ++i)
        if (strcmp(message->address, messages[i].address) == 0) {
            out->side = messages[i].side;
            return messages[i].read(out, message);
        }
    size_t i = 0;
    while (strncmp(message->address, others[i].prefix, strlen(others[i].prefix)) != 0)
        ++i;
    return others[i].expected ? refuse(out, OSC_FAULT_ADDRESS, others[i].expected) : OSC_FAULT_NONE;
}
