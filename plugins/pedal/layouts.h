/* pedal/layouts.h - what is known about foot pedals: which USB device it is, where it reports, and
 * which part of a report is which switch. Leaves out how a report is read (descriptor.h) and how a
 * layout comes about that is not in the table (descriptor.h, learn.h). Its text is
 * for a person to read and mend; what was learnt is kept in the user's configuration folder.
 */
#ifndef PLUGINS_PEDAL_LAYOUTS_H
#define PLUGINS_PEDAL_LAYOUTS_H
#include <marotte/plugin.h>
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
    LAYOUT_FIELD = 0, /* a number at a fixed offset in the report: a bit, a byte, an axis */
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

/* ---- as text ---- */

enum { LAYOUT_TEXT_BYTES = 4096, LAYOUT_TEXT_REASON = 200 };

/* On failure `out` is zeroed and `reason` names the line and what was expected. */
mrt_result layout_text_parse(layout *out, const char *bytes, size_t size,
                             char reason[LAYOUT_TEXT_REASON]);
/* Writes the text with its end of string; returns its length, which is less than the capacity. */
size_t layout_text_print(char out[LAYOUT_TEXT_BYTES], const layout *from);

/* ---- kept: marotte/pedals/05f3_00ff.layout below $XDG_CONFIG_HOME or ~/.config ---- */

enum { LAYOUT_FILE_PATH = 512, LAYOUT_FILE_REASON = LAYOUT_TEXT_REASON + LAYOUT_FILE_PATH + 64 };

/* False: neither XDG_CONFIG_HOME nor HOME names a folder. */
bool layout_file_path(char out[LAYOUT_FILE_PATH], uint16_t vendor, uint16_t product);
/* MRT_OK; MRT_END: there is none; < 0: `reason` says why it cannot be used. */
mrt_result layout_file_load(layout *out, uint16_t vendor, uint16_t product,
                            char reason[LAYOUT_FILE_REASON]);
/* Makes the folders; what was there before stays until the new file is whole. */
mrt_result layout_file_store(const layout *from, char reason[LAYOUT_FILE_REASON]);

#endif
