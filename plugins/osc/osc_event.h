/* plugins/osc/osc_event.h - meaning of one OSC message about hands, pedals or a forwarded source,
 * fully validated; writing of the messages with which one marotte forwards samples to another; and
 * conversion of VMC's finger bones to angles. README.md documents every message. Pure except for
 * liblo's allocations; any thread. */
#ifndef MAROTTE_OSC_EVENT_H
#define MAROTTE_OSC_EVENT_H
#include "osc_wire.h"

#include <marotte/plugin.h>

/* ---- finger bones of the VMC protocol as the angles of a glove ----
 * The rotation of a bone is relative to the VRM T-pose in Unity's left-handed axes: +y up, +z
 * forward, the palms down, the right fingers along +x and the left ones along -x, thumbs level and
 * half way between the fingers and +z. In these axes a right finger bends about -z and turns to the
 * thumb's side about -y. A right thumb bends about +y, and its base moves across the palm about +x.
 * A left hand is mirrored (x and the turns about y and z change sign). Used: wrist flexion and
 * deviation, flexion of every joint, the knuckles' spread, the base of the thumb (across and
 * aside). Not used: positions, twists of fingers and wrist. */

enum {
    OSC_VMC_THUMB = 0,
    OSC_VMC_INDEX,
    OSC_VMC_MIDDLE,
    OSC_VMC_RING,
    OSC_VMC_LITTLE,
    OSC_VMC_HAND
};
typedef struct osc_vmc_bone {
    uint32_t side;   /* MRT_LEFT, MRT_RIGHT */
    uint32_t finger; /* OSC_VMC_* */
    uint32_t joint;  /* 0 Proximal, 1 Intermediate, 2 Distal; 0 for the hand; OSC_VMC_METACARPAL for
                        a thumb until the naming is known */
} osc_vmc_bone;
enum { OSC_VMC_METACARPAL = 3 };

/* Parses "LeftIndexProximal", "RightHand"; case-sensitive. Returns false for other bones. */
bool osc_vmc_bone_find(osc_vmc_bone *out, const char *name);

/* State of a hand from its bones: the sensors' angles, and the direction of each knuckle. */
typedef struct osc_vmc_pose {
    double aside_rad[4]; /* index..little: turn to the thumb's side */
    bool is_vrm1;        /* the thumb's bones have the names Metacarpal, Proximal, Distal */
} osc_vmc_pose;

/* Resolves a thumb bone's joint to 0..2. VRM 1 uses Metacarpal for the thumb's Proximal, and
 * Proximal for its Intermediate; the received names show which version the sender uses. */
void osc_vmc_settle(osc_vmc_pose *pose, osc_vmc_bone *bone);

/* Applies a bone's rotation. xyzw: length not near 0. Writes the elements of angle_rad (MRT_ANGLES)
 * that depend on the bone. */
void osc_vmc_apply(osc_vmc_pose *pose, const osc_vmc_bone *bone, const float *xyzw,
                   float *angle_rad);

/* ---- the channels of one source, as one marotte sends them to another ----
 * /marotte/1/channels  s source, i version, then for each channel
 *                      s name, s unit, i semantic, i hand, f min, f max
 * /marotte/1/sample    s source, i version, i sequence, h time_ns, h sent_ns, f value ...
 * /marotte/1/end       s source, i version */

enum { OSC_SOURCE_LENGTH = 96, OSC_NAME_LENGTH = 64, OSC_UNIT_LENGTH = 16 };

typedef struct osc_table {
    char source[OSC_SOURCE_LENGTH];
    int32_t version; /* changes with the channels, and when the sequence restarts */
    uint32_t count;
    mrt_channel channel[MRT_MAX_CHANNELS]; /* name and unit point into this struct: copy with
                                              osc_table_copy, not with = */
    char name[MRT_MAX_CHANNELS][OSC_NAME_LENGTH], unit[MRT_MAX_CHANNELS][OSC_UNIT_LENGTH];
} osc_table;

/* Fills the table. Returns false, without a change, if a text is missing, too long or not
 * printable, or if a count or number is out of range. */
bool osc_table_set(osc_table *out, const char *source, int32_t version, const mrt_channel *channels,
                   uint32_t count);
void osc_table_copy(osc_table *out, const osc_table *from);
/* Returns true if the channels are equal in all their properties. */
bool osc_table_has(const osc_table *table, const mrt_channel *channels, uint32_t count);
/* Returns true for printable text: ASCII or bytes of UTF-8, shorter than `capacity`. */
bool osc_table_is_text(const char *text, size_t capacity);

/* Returns the packet's size; 0 if out of memory or space. */
size_t osc_table_write(const osc_table *table, void *out, size_t capacity);
size_t osc_table_write_sample(const osc_table *table, const mrt_sample *sample, int64_t sent_ns,
                              void *out, size_t capacity);
size_t osc_table_write_end(const osc_table *table, void *out, size_t capacity);

/* ---- reading a message ---- */

typedef enum osc_event_kind {
    OSC_EVENT_NONE = 0, /* known but not used, like most of VMC */
    OSC_EVENT_ANGLES,   /* side; `count` values from sensor `first` on, rad */
    OSC_EVENT_WRIST,    /* side; 7 values */
    OSC_EVENT_PEDAL,    /* `first` 0..3; 1 value, 0 up .. 1 down */
    OSC_EVENT_BONE,     /* bone; 4 values, a quaternion x y z w */
    OSC_EVENT_FRAME,    /* end of a frame of bones */
    OSC_EVENT_CONTROL,  /* `first` of the controls; 1 value, 0..1 */
    OSC_EVENT_CHANNELS, /* table */
    OSC_EVENT_SAMPLE,   /* source, version, sequence, time_ns, sent_ns; `count` values */
    OSC_EVENT_END       /* source, version */
} osc_event_kind;

/* Limit of the times of senders' clocks, so that differences do not overflow. */
static const int64_t OSC_TIME_MAX_NS = INT64_C(1) << 61;

/* Controls: MIDI controllers 0 to 31, then the keys A to Z. */
enum { OSC_CONTROLLERS = 32, OSC_KEYS = 26, OSC_CONTROLS = OSC_CONTROLLERS + OSC_KEYS };

typedef struct osc_event {
    osc_event_kind kind;
    uint32_t side, first, count;
    float value[MRT_MAX_CHANNELS];
    osc_vmc_bone bone;
    int64_t tag_ns; /* of its bundle, or OSC_NO_TIME */
    char source[OSC_SOURCE_LENGTH];
    int32_t version;
    uint32_t sequence;
    int64_t time_ns, sent_ns; /* sender's clock; sent_ns >= time_ns */
    osc_table table;
    const char *expected; /* expected form of a faulty message; a literal */
} osc_event;

/* Reads a message. On a fault `expected` describes the correct form. */
osc_fault osc_event_read(osc_event *out, const osc_message *message);

#endif
