/* pedal/advice.h - what the person can do about a device that cannot be used, in one sentence. Says
 * it the same way when devices are listed and when one is opened. */
#ifndef MAROTTE_PLUGINS_PEDAL_ADVICE_H
#define MAROTTE_PLUGINS_PEDAL_ADVICE_H
#include "usb.h"

enum { ADVICE_TEXT = 384 };

void advice_denied(char out[ADVICE_TEXT], const usb_seen *device);
void advice_busy(char out[ADVICE_TEXT], const usb_seen *device);
void advice_unknown(char out[ADVICE_TEXT], const usb_seen *device);
void advice_no_endpoint(char out[ADVICE_TEXT], const usb_seen *device);

#endif
