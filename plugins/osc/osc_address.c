#include "osc_address.h"

#include <stdio.h>
#include <string.h>

bool osc_address_parse(osc_address *out, const char *address)
{
    *out = (osc_address){.host = "127.0.0.1", .port = OSC_PORT};
    if (!address)
        return true;
    if (strncmp(address, "udp:", 4) == 0)
        address += 4;
    const char *end = address + strcspn(address, "/");
    if (*end == '/') {
        out->has_source = true;
        if (!osc_table_is_text(end + 1, OSC_SOURCE_LENGTH))
            return false;
        snprintf(out->source, sizeof out->source, "%s", end + 1);
    }
    return end == address ||
           udp_address_parse(out->host, &out->port, address, (size_t)(end - address));
}
