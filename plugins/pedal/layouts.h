/* pedal/layouts.h - what is known about foot pedals: which USB device it is, where it reports, and
 * which part of a report is which switch. Leaves out how a report is read (decode.h) and how a
 * layout comes about that is not in the table (describe.h, learn.h). Const data and plain structs.
 */
#ifndef MAROTTE_PLUGINS_PEDAL_LAYOUTS_H
#define MAROTTE_PLUGINS_PEDAL_LAYOUTS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    LAYOUT_SWITCHES = 4, /* as many as marotte has pedals */
    LAYOUT_KEYS = 2,     /* either of them is the switch */
    LAYOUT_HEAD = 2,
    LAYOUT_NAME = 64,
    LAYOUT_SWITCH_NAME = 24,
    LAYOUT_ANY = 255 /* interface: the first that fits */
};

typedef enum layout_source {
    LAYOUT_OF_NOTHING = 0, /* not known at all */
    LAYOUT_OF_TABLE,
    LAYOUT_OF_DESCRIPTOR, /* switches are those that the device's report descriptor names */
    LAYOUT_OF_LEARNING
} layout_source;

typedef enum layout_switch_kind {
    LAYOUT_FIELD = 0, /* a number at a fixed place of the report: a bit, a byte, an axis */
    LAYOUT_KEY        /* a key in a keyboard's list of keys that are down */
} layout_switch_kind;

typedef struct layout_switch {
    char name[LAYOUT_SWITCH_NAME]; /* "left" */
    layout_switch_kind kind;
    uint8_t report_id; /* the report's first byte; 0: reports have no number */
    uint16_t bit;      /* field: its lowest bit, counted from the report's first byte */
    uint8_t width;     /* field: bits, 1..32, little-endian */
    bool is_signed;
    int32_t up, down;         /* field: the values that mean 0 and 1; never equal */
    uint8_t key[LAYOUT_KEYS]; /* key: usages of HID page 7; 0: none */
} layout_switch;

typedef struct layout {
    layout_source source;
    uint16_t vendor, product;
    char name[LAYOUT_NAME];
    uint8_t interface_number; /* or LAYOUT_ANY */
    uint8_t endpoint;         /* with its direction bit, 0x81; 0: the first that fits */
    uint8_t head[LAYOUT_HEAD], head_count;    /* a report begins with these, or says nothing */
    uint8_t key_report_id, key_at, key_count; /* bytes of the list of keys that are down */
    bool any_key;                             /* the first switch is down with any key */
    uint8_t axis_skip; /* described: so many axes before the pedals, such as a wheel */
    uint8_t switch_count;
    layout_switch switches[LAYOUT_SWITCHES];
} layout;

/* NULL: not in the table. */
const layout *layouts_find(uint16_t vendor, uint16_t product);
/* The whole table, for tests and for whoever lists what would be found. */
const layout *layouts_table(size_t *out_count);

/* More than up and down: passed on as it is, without debouncing. */
bool layout_is_analogue(const layout_switch *s);

#endif
