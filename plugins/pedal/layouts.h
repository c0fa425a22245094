/* pedal/layouts.h - table of known foot pedals: the USB device, the endpoint of its reports, and
 * the part of a report that is each switch. Leaves out reading reports (descriptor.h) and creating
 * a layout that is not in the table (descriptor.h, learn.h). Users can read and edit a layout's
 * text; a learned layout is stored in the user's configuration folder. */
#ifndef PLUGINS_PEDAL_LAYOUTS_H
#define PLUGINS_PEDAL_LAYOUTS_H
#include <marotte/plugin.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    LAYOUT_SWITCHES = 4, /* number of marotte's pedals */
    LAYOUT_KEYS = 2,     /* alternative keys of one switch */
    LAYOUT_HEAD = 2,
    LAYOUT_NAME = 64,
    LAYOUT_SWITCH_NAME = 24,
    LAYOUT_ANY = 255 /* interface: the first that fits */
};

typedef enum layout_source {
    LAYOUT_OF_NOTHING = 0, /* not known at all */
    LAYOUT_OF_TABLE,
    LAYOUT_OF_DESCRIPTOR, /* switches from the device's report descriptor */
    LAYOUT_OF_LEARNING
} layout_source;

typedef enum layout_switch_kind {
    LAYOUT_FIELD = 0, /* a number at a fixed offset in the report: a bit, a byte, an axis */
    LAYOUT_KEY        /* a key in a keyboard's list of pressed keys */
} layout_switch_kind;

typedef struct layout_switch {
    char name[LAYOUT_SWITCH_NAME]; /* "left" */
    layout_switch_kind kind;
    uint8_t report_id; /* the report's first byte; 0: reports have no number */
    uint16_t bit;      /* field: its lowest bit, counted from the report's first byte */
    uint8_t width;     /* field: bits, 1..32, little-endian */
    bool is_signed;
    int32_t up, down;         /* field: the values for 0 and 1; never equal */
    uint8_t key[LAYOUT_KEYS]; /* key: usages of HID page 7; 0: none */
} layout_switch;

typedef struct layout {
    layout_source source;
    uint16_t vendor, product;
    char name[LAYOUT_NAME];
    uint8_t interface_number; /* or LAYOUT_ANY */
    uint8_t endpoint;         /* with its direction bit, 0x81; 0: the first that matches */
    uint8_t head[LAYOUT_HEAD], head_count;    /* first bytes of a report; others are ignored */
    uint8_t key_report_id, key_at, key_count; /* position of the list of pressed keys, in bytes */
    bool any_key;                             /* any key is the first switch */
    uint8_t axis_skip; /* described: number of axes before the pedals, such as a wheel */
    uint8_t switch_count;
    layout_switch switches[LAYOUT_SWITCHES];
} layout;

/* NULL: not in the table. */
const layout *layouts_find(uint16_t vendor, uint16_t product);
/* Returns the whole table, for tests and listings. */
const layout *layouts_table(size_t *out_count);

/* Returns true for a switch with more than two values, which is not debounced. */
bool layout_is_analogue(const layout_switch *s);

/* ---- as text ---- */

enum { LAYOUT_TEXT_BYTES = 4096, LAYOUT_TEXT_REASON = 200 };

/* Parses the text. On failure `out` is zeroed, and `reason` names the line and what was
 * expected. */
mrt_result layout_text_parse(layout *out, const char *bytes, size_t size,
                             char reason[LAYOUT_TEXT_REASON]);
/* Writes the text, 0-ended. Returns its length, which is less than the capacity. */
size_t layout_text_print(char out[LAYOUT_TEXT_BYTES], const layout *from);

/* ---- stored in marotte/pedals/05f3_00ff.layout, in $XDG_CONFIG_HOME or ~/.config ---- */

enum { LAYOUT_FILE_PATH = 512, LAYOUT_FILE_REASON = LAYOUT_TEXT_REASON + LAYOUT_FILE_PATH + 64 };

/* Returns false if neither XDG_CONFIG_HOME nor HOME names a folder. */
bool layout_file_path(char out[LAYOUT_FILE_PATH], uint16_t vendor, uint16_t product);
/* Returns MRT_OK; MRT_END: no file; < 0: unusable, with the reason in `reason`. */
mrt_result layout_file_load(layout *out, uint16_t vendor, uint16_t product,
                            char reason[LAYOUT_FILE_REASON]);
/* Creates the folders. The old file stays until the new one is complete. */
mrt_result layout_file_store(const layout *from, char reason[LAYOUT_FILE_REASON]);

#endif
