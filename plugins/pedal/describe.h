/* pedal/describe.h - the pedals among what a report descriptor names: buttons, then axes. Leaves
 * out how a descriptor is read (descriptor.h). Pure. */
#ifndef MAROTTE_PLUGINS_PEDAL_DESCRIBE_H
#define MAROTTE_PLUGINS_PEDAL_DESCRIBE_H
#include "descriptor.h"
#include "layouts.h"

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

#endif
