/* plugins/osc/osc_address.h - the address of an input or output as the user writes it:
 * [udp:][HOST:]PORT[/SOURCE], HOST a name, an IPv4 or a bracketed IPv6 address. "" is the port 9105
 * of this computer. Pure. */
#ifndef MAROTTE_OSC_ADDRESS_H
#define MAROTTE_OSC_ADDRESS_H
#include "osc_table.h"
#include "udp.h"

#include <stdbool.h>

enum { OSC_PORT = 9105 };

typedef struct osc_address {
    char host[UDP_HOST]; /* without brackets; 127.0.0.1 when none was given */
    uint16_t port;       /* 1..65535 */
    bool has_source;     /* there was a '/' */
    char source[OSC_SOURCE_LENGTH];
} osc_address;

/* False: it is no such address. */
bool osc_address_parse(osc_address *out, const char *address);

#endif
