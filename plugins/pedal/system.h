/* pedal/system.h - information that Linux has about a USB device without opening it: its name, the
 * report descriptor read by the kernel, permissions, and the program that uses it. Leaves out
 * everything that needs an answer of the device (usb.h). [main] [input]: reads small files of /sys
 * and /proc. */
#ifndef PLUGINS_PEDAL_SYSTEM_H
#define PLUGINS_PEDAL_SYSTEM_H
#include "usb.h"

enum { SYSTEM_NAME = 64 };

/* Reads the product name; "" if it has none. */
void system_product(char out[SYSTEM_NAME], const char *path);
/* Reads the report descriptor of one interface. Returns 0 if the kernel's HID driver does not use
 * it. */
size_t system_descriptor(const char *path, uint8_t interface_number, uint8_t *out, size_t capacity);

/* Returns true if this user may read and write the node. */
bool system_can_open(const usb_device *device);
/* Returns true if a program, not a kernel driver, has claimed the interface. */
bool system_is_claimed(const char *path, uint8_t interface_number);

/* ---- advice for a device that cannot be used, in one line ---- */

enum { ADVICE_TEXT = 384 };

void advice_denied(char out[ADVICE_TEXT], const usb_device *device);
void advice_busy(char out[ADVICE_TEXT], const usb_device *device);
void advice_unknown(char out[ADVICE_TEXT], const usb_device *device);
void advice_no_endpoint(char out[ADVICE_TEXT], const usb_device *device);

#endif
