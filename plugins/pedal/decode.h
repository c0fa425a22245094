/* pedal/decode.h - from the bytes of a report to how far each switch is down. Leaves out time: a
 * report says what is now. Pure. */
#ifndef MAROTTE_PLUGINS_PEDAL_DECODE_H
#define MAROTTE_PLUGINS_PEDAL_DECODE_H
#include "layouts.h"

/* Writes 0 up .. 1 down of the switches that the report speaks of; the others keep their value.
 * False: it speaks of none, because it is too short, of another kind or a keyboard's error. */
bool decode_report(const layout *of, const uint8_t *bytes, size_t size,
                   float value[LAYOUT_SWITCHES]);

/* The number in `width` (1..32) bits from `bit` on; false: the report ends before. */
bool decode_number(const uint8_t *bytes, size_t size, uint32_t bit, uint32_t width, bool is_signed,
                   int64_t *out);

#endif
