/* pedal/descriptor.h - parser of HID report descriptors: which numbers a device's input reports
 * contain, their position and meaning (HID 1.11, section 6.2.2); which of them are pedals, and how
 * far each pedal is down in a report. Strict, and bounded in time and memory, because the bytes
 * come from an untrusted device. Pure. */
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
    uint16_t bit; /* position of its lowest bit, from the report's first byte (including its number,
                     if any) */
    uint8_t width;  /* bits, 1..32 */
    uint16_t count; /* 1; for an array: number of slots of `width` bits that contain usages */
    bool is_array, is_signed, is_relative;
    int32_t low, high;    /* logical range, low < high */
    uint16_t page, usage; /* usage: for an array, the usage of the value `low` */
} descriptor_field;

typedef struct descriptor {
    uint32_t field_count;
    descriptor_field field[DESCRIPTOR_FIELDS]; /* in report order, limited to the maximum */
} descriptor;

/* Parses a descriptor without constant and too wide fields. On failure `reason` names the error and
 * its position. */
mrt_result descriptor_parse(descriptor *out, const uint8_t *bytes, size_t size,
                            char reason[DESCRIPTOR_REASON]);

/* ---- the pedals among them: buttons, then axes ---- */

/* Fills the switches of `out` from the descriptor, at most LAYOUT_SWITCHES, after skipping
 * out->axis_skip axes. Does not change other fields of `out`. With axis_skip or with an
 * accelerator, brake or clutch, axes come first, because they are the purpose of such a device.
 * Returns false if nothing looks like a pedal. */
bool describe_switches(layout *out, const descriptor *from);

/* Finds a keyboard's list of keys and fills key_report_id, key_at and key_count. Returns false if
 * it is not a keyboard. */
bool describe_keys(layout *out, const descriptor *from);

/* Returns true for an axis: a number that a foot moves continuously. */
bool describe_is_axis(const descriptor_field *field);

/* Returns true for a joystick or a device with buttons that is neither keyboard nor mouse. */
bool describe_may_be_pedal(const descriptor *from);

/* ---- reports ---- */

/* Writes 0 up .. 1 down for the switches in the report; other switches keep their value. Returns
 * false if the report has no switches: too short, of another kind, or a keyboard's error. */
bool decode_report(const layout *of, const uint8_t *bytes, size_t size,
                   float value[LAYOUT_SWITCHES]);

/* Reads the number of `width` (1..32) bits at `bit`. Returns false if the report is too short. */
bool decode_number(const uint8_t *bytes, size_t size, uint32_t bit, uint32_t width, bool is_signed,
                   int64_t *out);

#endif
