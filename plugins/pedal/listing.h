/* pedal/listing.h - which pedals are plugged in, and what keeps one from being used. Opens none. */
#ifndef MAROTTE_PLUGINS_PEDAL_LISTING_H
#define MAROTTE_PLUGINS_PEDAL_LISTING_H
#include "pedal.h"

uint32_t listing_list(mrt_plugin *self, mrt_device *out, uint32_t capacity); /* [main] */
bool listing_current(mrt_plugin *self, mrt_device *out);                     /* [main] [input] */

#endif
