/* pedal/address.h - which of the devices that are plugged in is meant: "" (the first known pedal),
 * "usb:05f3:00ff" (the first of that kind), "usb:1-2.3" (whatever is in that socket). A device that
 * was found once is found again by its socket. Leaves out USB itself. Pure. */
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

/* False: the text is none of the three. */
bool address_parse(address *out, const char *text);

/* Orders sockets as people count: "1-2" before "1-10", a hub's sockets after the hub's own. */
int address_compare_paths(const char *a, const char *b);

/* The device that an instance has had: only that one will do when it comes back. */
typedef struct address_binding {
    bool is_bound;
    uint16_t vendor, product;
    char path[ADDRESS_PATH];
} address_binding;

/* Whether the device in socket `path` may be opened. `is_known`: as a pedal. */
bool address_matches(const address *wanted, const address_binding *binding, const char *path,
                     uint16_t vendor, uint16_t product, bool is_known);

#endif
