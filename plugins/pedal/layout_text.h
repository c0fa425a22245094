/* pedal/layout_text.h - a layout as text that a person can read and mend; the format is at the top
 * of layout_text.c. The reader is strict: what it does not know it refuses, with the line. Pure. */
#ifndef MAROTTE_PLUGINS_PEDAL_LAYOUT_TEXT_H
#define MAROTTE_PLUGINS_PEDAL_LAYOUT_TEXT_H
#include "layouts.h"

#include <marotte/plugin.h>

enum { LAYOUT_TEXT_BYTES = 4096, LAYOUT_TEXT_REASON = 200 };

/* On failure `out` is zeroed and `reason` names the line and what was expected. */
mrt_result layout_text_parse(layout *out, const char *bytes, size_t size,
                             char reason[LAYOUT_TEXT_REASON]);
/* Writes the text with its end of string; returns its length, which is less than the capacity. */
size_t layout_text_print(char out[LAYOUT_TEXT_BYTES], const layout *from);

#endif
