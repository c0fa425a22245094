/* pedal/system.h - what Linux knows about a USB device without anybody opening it: its name, the
 * report descriptor that the kernel has read, who may use it, who does. Leaves out everything that
 * needs the device's answer (usb.h). [main] [input]: reads small files of /sys and /proc. */
#ifndef PLUGINS_PEDAL_SYSTEM_H
#define PLUGINS_PEDAL_SYSTEM_H
#include "usb.h"

enum { SYSTEM_NAME = 64 };

/* The name that the maker gave it; "" when it has none. */
void system_product(char out[SYSTEM_NAME], const char *path);
/* Of one interface; 0: the kernel's HID driver does not have it. */
size_t system_descriptor(const char *path, uint8_t interface_number, uint8_t *out, size_t capacity);

/* Whether this user may read and write the node. */
bool system_may_open(const usb_device *device);
/* Whether some program, and not a driver of the kernel, has claimed the interface. */
bool system_is_claimed(const char *path, uint8_t interface_number);

/* ---- what the person can do about a device that cannot be used, in one sentence ---- */

enum { ADVICE_TEXT = 384 };

void advice_denied(char out[ADVICE_TEXT], const usb_device *device);
void advice_busy(char out[ADVICE_TEXT], const usb_device *device);
void advice_unknown(char out[ADVICE_TEXT], const usb_device *device);
void advice_no_endpoint(char out[ADVICE_TEXT], const usb_device *device);

#endif
