/* pedal/descriptor.h - reads a HID report descriptor: which numbers a device's input reports hold,
 * where, and what they mean (HID 1.11, section 6.2.2). Strict, and bounded in time and memory: the
 * bytes come from a device that nobody has checked. Leaves out which of them are pedals
 * (describe.h). Pure. */
#ifndef MAROTTE_PLUGINS_PEDAL_DESCRIPTOR_H
#define MAROTTE_PLUGINS_PEDAL_DESCRIPTOR_H
#include <marotte/plugin.h>

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
    uint16_t count;    /* 1; an array: so many places of `width` bits that hold usages */
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

#endif
