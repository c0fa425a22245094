/* pedal/teach.h - learn mode as the person meets it: what to do next is said through the log, each
 * line beginning with "learn:"; the last one with "learn: done" or "learn: given up". What is
 * learnt is stored, and used from then on. Leaves out how switches are told apart (learn.h).
 * [input] */
#ifndef MAROTTE_PLUGINS_PEDAL_TEACH_H
#define MAROTTE_PLUGINS_PEDAL_TEACH_H
#include "pedal.h"

void teach_begin(mrt_plugin *self, int64_t now_ns);
void teach_report(mrt_plugin *self, const usb_report *report);
void teach_tick(mrt_plugin *self, int64_t now_ns); /* call it at learn.until_ns at the latest */
void teach_lose(mrt_plugin *self);                 /* the device is gone */

#endif
