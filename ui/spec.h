/* spec.h - "PLUGIN:ADDRESS,key=value,..." on a command line, taken apart. [main] */
#ifndef MAROTTE_UI_SPEC_H
#define MAROTTE_UI_SPEC_H
#include <stdbool.h>

typedef struct plugin_spec {
    char *plugin, *address, *params; /* owned; "" where there is none */
} plugin_spec;

/* False: it names no plugin, or there is no memory. To be finished either way. */
bool spec_read(plugin_spec *out, const char *text);
void spec_finish(plugin_spec *spec); /* zeroed is fine */

#endif
