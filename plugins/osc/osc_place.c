#include "osc_place.h"

#include <stdio.h>
#include <string.h>

static bool parse_port(uint16_t *out, const char *text, size_t length)
{
    uint32_t port = 0;
    if (length == 0 || length > 5)
        return false;
    for (size_t i = 0; i < length; ++i) {
        if (text[i] < '0' || text[i] > '9')
            return false;
        port = port * 10 + (uint32_t)(text[i] - '0');
    }
    *out = (uint16_t)port;
    return port >= 1 && port <= 65535;
}

static bool parse_host(char *out, const char *text, size_t length)
{
    if (length >= 2 && text[0] == '[' && text[length - 1] == ']') {
        text += 1;
        length -= 2;
    } else if (memchr(text, ':', length)) {
        return false; /* IPv6 without brackets: which part is the port? */
    }
    if (length == 0 || length >= OSC_HOST_LENGTH)
        return false;
    memcpy(out, text, length);
    out[length] = '\0';
    if (strcmp(out, "localhost") == 0)
        snprintf(out, OSC_HOST_LENGTH, "127.0.0.1");
    return osc_table_is_text(out, OSC_HOST_LENGTH);
}

/* The last ':' before `end`; NULL: there is none. */
static const char *last_colon(const char *text, const char *end)
{
    while (end > text)
        if (*--end == ':')
            return end;
    return NULL;
}

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
    if (end == address)
        return true;
    const char *colon = last_colon(address, end);
    const char *port = colon ? colon + 1 : address;
    if (!parse_port(&out->port, port, (size_t)(end - port)))
        return false;
    return !colon || parse_host(out->host, address, (size_t)(colon - address));
}
