/* pedal/pedal.h - one instance of the plugin, shared by the files that open (opening.c), read
 * (pedal.c), list (listing.c) and teach (teach.c). */
#ifndef MAROTTE_PLUGINS_PEDAL_PEDAL_H
#define MAROTTE_PLUGINS_PEDAL_PEDAL_H
#include "address.h"
#include "debounce.h"
#include "descriptor.h"
#include "layouts.h"
#include "learn.h"
#include "trace.h"
#include "usb.h"

#include <marotte/plugin.h>

/* In the order of the table of parameters. */
enum {
    PARAM_FIRST = 0,
    PARAM_SWITCH, /* LAYOUT_SWITCHES of them */
    PARAM_INVERT = PARAM_SWITCH + LAYOUT_SWITCHES,
    PARAM_DEBOUNCE,
    PARAM_LEARN,
    PARAM_COUNT
};

enum { PEDAL_ADDRESS = 192, PEDAL_TEXT = 512 };

struct mrt_plugin {
    const mrt_host *host;
    usb *usb; /* NULL until first needed */
    trace trace;

    char address[PEDAL_ADDRESS]; /* as opened, "" too */
    address_binding binding;     /* the device that this address has meant */
    usb_seen device;             /* that is open, or was last */
    char name[LAYOUT_NAME];

    bool is_open, has_lesson_due; /* the button was pressed in the call of open */
    double opened_with[PARAM_COUNT];
    layout layout;
    uint32_t analogue; /* bit n: switch n */
    descriptor fields; /* field_count 0: not known */
    uint32_t channel_count;
    mrt_channel channels[LAYOUT_SWITCHES];
    char channel_names[LAYOUT_SWITCHES][LAYOUT_SWITCH_NAME];

    float value[LAYOUT_SWITCHES]; /* as reported last */
    debounce debounce;
    usb_report report; /* that waits for what is due before it */
    bool has_report;
    bool is_lost, has_released, has_told_loss, has_asked_to_restart;
    int64_t last_time_ns, repeat_due_ns;
    uint32_t sequence;

    learn learn;
};

__attribute__((format(printf, 3, 4))) void pedal_say(const mrt_plugin *self, int32_t level,
                                                     const char *format, ...);
/* False: no memory, or no USB; said. */
bool pedal_has_usb(mrt_plugin *self);

#endif
