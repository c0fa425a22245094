/* pedal/opening.h - from an address to a pedal that reports: which device, what is known of it, its
 * channels; and, where it cannot be had, one sentence about what to do. [main] [input] */
#ifndef MAROTTE_PLUGINS_PEDAL_OPENING_H
#define MAROTTE_PLUGINS_PEDAL_OPENING_H
#include "pedal.h"

/* What is known of a device: what was learnt, else the table. Source LAYOUT_OF_NOTHING: nothing.
 * A file of a layout that cannot be used is passed over; `complaint` (LAYOUT_FILE_REASON, or NULL)
 * says why, else "". */
layout opening_known_layout(const usb_seen *device, char *complaint);
/* The endpoint at which a layout is to be read; NULL: there is none. */
const usb_endpoint *opening_endpoint(const layout *known, const usb_seen *device);

mrt_result opening_open(mrt_plugin *self, const char *text, const double *params);
void opening_close(mrt_plugin *self);

#endif
