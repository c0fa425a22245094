/* pedal/descriptor.h - reads a HID report descriptor: which numbers a device's input reports hold,
 * where, and what they mean (HID 1.11, section 6.2.2); which of them are pedals, and how far each
 * is down in a report. Strict, and bounded in time and memory: the bytes come from a device that
 * nobody has checked. Pure. */
#ifndef PLUGINS_PEDAL_DESCRIPTOR_H
#define PLUGINS_PEDAL_DESCRIPTOR_H
#include "layouts.h"

#include <marotte/plugin.h>

/* ---- report descriptors ---- */

enum {
    DESCRIPTOR_FIELDS = 128,
    DESCRIPTOR_BYTES = 4096,        /* of a descriptor, at most */
    DESCRIPTOR_REPORT_BYTES = 1024, /* of a report, at most */
    DESCRIPTOR_REASON = 160
};

typedef struct descriptor_field {
    uint8_t report_id; /* 0: reports have no number */
    uint16_t bit;      /* of its lowest bit, from the report's first byte (its number, if any) */
    uint8_t width;     /* bits, 1..32 */
    uint16_t count;    /* 1; an array: so many slots of `width` bits that hold usages */
    bool is_array, is_signed, is_relative;
    int32_t low, high;    /* logical range, low < high */
    uint16_t page, usage; /* usage: of an array, of its value `low` */
} descriptor_field;

typedef struct descriptor {
    uint32_t field_count;
    descriptor_field field[DESCRIPTOR_FIELDS]; /* in report order; those after the last left out */
} descriptor;

/* Constant and too wide fields are left out. On failure `reason` says what is wrong where. */
mrt_result descriptor_parse(descriptor *out, const uint8_t *bytes, size_t size,
                            char reason[DESCRIPTOR_REASON]);

/* ---- the pedals among them: buttons, then axes ---- */

/* Fills switches of `out` from the descriptor, at most LAYOUT_SWITCHES, after out->axis_skip axes
 * are passed over; all else of `out` stays. With axis_skip or with an accelerator, brake or clutch
 * axes come first, because that is what such a device is for. False: nothing looks like a pedal. */
bool describe_switches(layout *out, const descriptor *from);

/* Where a keyboard lists its keys: fills key_report_id, key_at and key_count. False: no keyboard.
 */
bool describe_keys(layout *out, const descriptor *from);

/* A number that a foot moves smoothly, rather than switches. */
bool describe_is_axis(const descriptor_field *field);

/* True: a joystick or something with buttons, but neither keyboard nor mouse. */
bool describe_may_be_pedal(const descriptor *from);

/* ---- reports ---- */

/* Writes 0 up .. 1 down of the switches that the report speaks of; the others keep their value.
 * False: it speaks of none, because it is too short, of another kind or a keyboard's error. */
bool decode_report(const layout *of, const uint8_t *bytes, size_t size,
                   float value[LAYOUT_SWITCHES]);

/* The number in `width` (1..32) bits from `bit` on; false: the report ends before. */
bool decode_number(const uint8_t *bytes, size_t size, uint32_t bit, uint32_t width, bool is_signed,
                   int64_t *out);

#endif
