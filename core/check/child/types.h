/* check/child/types.h - the library under examination: loaded, and what its tables say. */
#ifndef MAROTTE_CHECK_CHILD_TYPES_H
#define MAROTTE_CHECK_CHILD_TYPES_H
#include <marotte/plugin.h>

enum { TYPES_MAX = 16, TYPES_PARAMS_MAX = 1024, TYPES_INTERFACES_MAX = 64 };

typedef struct types {
    uint32_t count;
    const mrt_plugin_type *type[TYPES_MAX];
} types;

/* False: told (library.load, library.symbol, library.abi). */
bool types_load(types *out, const char *path);

const void *types_interface(const mrt_plugin_type *type, const char *id);
uint32_t types_concerns(const mrt_plugin_type *type); /* CONCERNS_* of rules.h */

/* A sum over the tables and all that they point to. */
uint64_t types_sum(const mrt_plugin_type *type);

#endif
