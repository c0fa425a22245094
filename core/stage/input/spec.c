#include "stage/input/spec.h"

#include <stdlib.h>
#include <string.h>

/* A path to a library ("./x.so:...") is a plugin too. */
bool spec_read(plugin_spec *out, const char *text)
{
    size_t plugin_length = strcspn(text, ":,");
    const char *rest = text + plugin_length;
    const char *address = *rest == ':' ? rest + 1 : "";
    size_t address_length = strcspn(address, ",");
    const char *params = *rest == ':' ? address + address_length : rest;
    if (*params == ',')
        params += 1;
    out->plugin = strndup(text, plugin_length);
    out->address = strndup(address, address_length);
    out->params = strdup(params);
    return out->plugin && out->address && out->params && plugin_length > 0;
}

void spec_finish(plugin_spec *spec)
{
    free(spec->plugin);
    free(spec->address);
    free(spec->params);
}
