/* pedal/address.h - the address of a pedal: "" (the first known pedal), "usb:05f3:00ff" (the first
 * with this vendor and product), "usb:1-2.3" (the device at that USB port). A device found once is
 * found again by its USB port. Leaves out USB itself. Pure. */
#ifndef MAROTTE_PLUGINS_PEDAL_ADDRESS_H
#define MAROTTE_PLUGINS_PEDAL_ADDRESS_H
#include <stdbool.h>
#include <stdint.h>

/* "255-" and seven ports of up to three digits with their points. */
enum { ADDRESS_PATH = 36 };

typedef enum address_kind { ADDRESS_ANY = 0, ADDRESS_KIND, ADDRESS_PORT } address_kind;
typedef struct address {
    address_kind kind;
    uint16_t vendor, product; /* ADDRESS_KIND */
    char path[ADDRESS_PATH];  /* ADDRESS_PORT: "1-2.3" */
} address;

/* Returns false if the text is none of the three. */
bool address_parse(address *out, const char *text);

/* Compares USB ports by number: "1-2" before "1-10", the ports of a hub after the hub itself. */
int address_compare_paths(const char *a, const char *b);

/* The device that an instance was bound to. Only this device is opened again. */
typedef struct address_binding {
    bool is_bound;
    uint16_t vendor, product;
    char path[ADDRESS_PATH];
} address_binding;

/* Returns true if the device at USB port `path` may be opened. is_known: it is a known pedal. */
bool address_matches(const address *wanted, const address_binding *binding, const char *path,
                     uint16_t vendor, uint16_t product, bool is_known);

#endif
