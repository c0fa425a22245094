#include "osc_place.h"

#include <stdio.h>
#include <string.h>

bool osc_place_parse(osc_place *out, const char *address)
{
    *out = (osc_place){.host = "127.0.0.1", .port = OSC_PORT};
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
           udp_place_parse(out->host, &out->port, address, (size_t)(end - address));
}
