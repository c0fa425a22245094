/* stage/input/spec.h - "PLUGIN:ADDRESS,key=value,..." as people write it, taken apart. [any] */
#ifndef MAROTTE_STAGE_SPEC_H
#define MAROTTE_STAGE_SPEC_H
#include <stdbool.h>

typedef struct plugin_spec {
    char *plugin, *address, *params; /* owned; "" where there is none */
} plugin_spec;

/* False: it names no plugin, or there is no memory. To be finished either way. */
bool spec_read(plugin_spec *out, const char *text);
void spec_finish(plugin_spec *spec); /* zeroed is fine */

#endif
