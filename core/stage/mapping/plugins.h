/* stage/mapping/plugins.h - which plugins there are: shared libraries found in the folders of the
 * path list, loaded, checked, and never unloaded. One that cannot be used says why and is skipped.
 * [main]; read-only afterwards. */
#ifndef MAROTTE_STAGE_PLUGINS_H
#define MAROTTE_STAGE_PLUGINS_H
#include "base/error.h"

typedef struct plugin_entry {
    const mrt_plugin_type *type;
    const char *path; /* of the library */
} plugin_entry;

typedef struct plugin_refusal {
    char *path, *reason;
} plugin_refusal;

typedef struct plugin_list {
    plugin_entry *entry;     /* in the order of the path list; the first of an id wins */
    plugin_refusal *refusal; /* what was not loaded, and what a second one of an id is hidden by */
    char **library_path;
    uint32_t entry_count, refusal_count, library_count;
} plugin_list;

/* Looks into $MAROTTE_PLUGIN_PATH (folders with ':' between), the user's data folder, the installed
 * folder (found from the running program: an installation may be moved), and the folder `plugins`
 * beside the program. Missing folders are no error. */
CHECKED mrt_result plugin_list_load(plugin_list *out, error *err);
/* Adds one library. A refused one is an error that says why. */
CHECKED mrt_result plugin_list_add(plugin_list *list, const char *path, error *err);
void plugin_list_destroy(plugin_list *list);

/* By id ("org.marotte.log"), by the last part of the id ("log"), or by the path of a library that
 * is loaded for it ("./wave.so": the first type with that interface). The error names what there
 * is. */
CHECKED mrt_result plugin_list_find(plugin_list *list, const char *name, const char *interface_id,
                                    const mrt_plugin_type **out_type, error *err);

/* The functions of an interface, or NULL. */
const void *plugin_interface(const mrt_plugin_type *type, const char *interface_id);

/* The path of the library that a type of the list came from; NULL: none of the list. */
const char *plugin_list_path_of(const plugin_list *list, const mrt_plugin_type *type);
/* Whether a library comes with the program: it lies in the installed folder, or in `plugins` beside
 * the program. */
bool plugin_is_shipped(const char *library);

/* Checks one type against the rules of plugin.h that can be seen without running it. */
CHECKED mrt_result plugin_type_check(const mrt_plugin_type *type, error *err);

#endif
