/* stage/mapping/plugins.h - the list of plugins: shared libraries in the folders of the path list
 * are loaded and checked, and never unloaded. A library that cannot be used is skipped, and the
 * list stores the reason. Only [main] adds to a list. Any thread may read it at the same time,
 * because its entries never move. */
#ifndef MAROTTE_STAGE_PLUGINS_H
#define MAROTTE_STAGE_PLUGINS_H
#include "base/error.h"

#include <stdatomic.h>

enum { PLUGIN_LIST_MAX = 1024 };

typedef struct plugin_entry {
    const mrt_plugin_type *type;
    char *path; /* of the library */
} plugin_entry;

typedef struct plugin_refusal {
    char *path, *reason;
} plugin_refusal;

typedef struct plugin_list { /* zeroed: empty; each array has room for PLUGIN_LIST_MAX */
    plugin_entry *entry;     /* in the order of the path list; the first type of an id is used */
    plugin_entry *hidden;    /* types whose id was already in the list */
    plugin_refusal *refusal; /* libraries and types that were not loaded or are hidden */
    _Atomic uint32_t entry_count, hidden_count, refusal_count;
} plugin_list;

/* Adds the plugins in $MAROTTE_PLUGIN_PATH (folders separated by ':'), the user's data folder, the
 * installed folder, and the folder `plugins` beside the program. The installed folder is found from
 * the running program, so an installation can be moved. Missing folders are ignored. Earlier
 * entries of the list have priority. */
CHECKED mrt_result plugin_list_load(plugin_list *list, error *err);
/* Adds one library. Returns an error with the reason if it is refused. */
CHECKED mrt_result plugin_list_add(plugin_list *list, const char *path, error *err);
void plugin_list_destroy(plugin_list *list);

/* [any] Finds a loaded type by its id ("org.marotte.log") or the last part of the id ("log"). For
 * names from a show, a setting or the network. It never loads a library, and never treats a name as
 * a path. The error lists the loaded plugins. */
CHECKED mrt_result plugin_list_find(const plugin_list *list, const char *name,
                                    const char *interface_id, const mrt_plugin_type **out_type,
                                    error *err);

/* [main] Only for text that the user has just written (tests/house/borders.sh). Like
 * plugin_list_find, but the path of a library ("wave.so", "build/wave.so") loads it. "wave.so/tide"
 * selects one of several types with that interface. */
CHECKED mrt_result plugin_list_choose(plugin_list *list, const char *words,
                                      const char *interface_id, const mrt_plugin_type **out_type,
                                      error *err);
/* Same for "PLUGIN[:ADDRESS][,key=value]". out_spec is the text with the id of the type instead of
 * a path, for plugin_list_find. The caller frees it. */
CHECKED mrt_result plugin_list_choose_spec(plugin_list *list, const char *spec,
                                           const char *interface_id, char **out_spec, error *err);

/* Returns the functions of an interface. NULL: the type does not have it. */
const void *plugin_interface(const mrt_plugin_type *type, const char *interface_id);

/* Returns the path of the library of a type. NULL: the type is not in the list. */
const char *plugin_list_path_of(const plugin_list *list, const mrt_plugin_type *type);
/* Returns whether a library is shipped with the program: it is in the installed folder or in
 * `plugins` beside the program. */
bool plugin_is_shipped(const char *library);

/* Returns "cyberglove" for "org.marotte.cyberglove": the name before an address. */
const char *plugin_short_name(const mrt_plugin_type *type);

/* Returns whether lists for users show the type. False: it exists only for takes that were recorded
 * with it. */
bool plugin_is_offered(const mrt_plugin_type *type);

/* Checks a type against the rules of plugin.h that can be checked without running it. */
CHECKED mrt_result plugin_type_check(const mrt_plugin_type *type, error *err);

/* ---- one library: the only code in marotte that loads plugins. Errors do not contain the path.
 * [main], or any thread that may block ---- */

/* Refuses files that are not regular (dlopen would wait forever for a pipe), and truncated
 * libraries (access to the missing pages would crash the program). dlopen reports all other
 * errors. */
CHECKED mrt_result plugin_library_check(const char *path, error *err);
/* Loads a library by its path, never by a search. Returns its types, at least one, ended by NULL.
 * On failure it returns NULL and sets err. A library is never unloaded. */
const mrt_plugin_type *const *plugin_library_open(const char *path, error *err);

/* Identifies the file at a path. A changed stamp means that the library was rebuilt. Zeroed: no
 * file. */
typedef struct plugin_library_stamp {
    int64_t time_ns, size;
    uint64_t file;
} plugin_library_stamp;
plugin_library_stamp plugin_library_stamp_of(const char *path); /* NULL: none */
bool plugin_library_is_same(const plugin_library_stamp *a, const plugin_library_stamp *b);

/* ---- parser for "PLUGIN:ADDRESS,key=value,..." as users write it [any] ---- */

typedef struct plugin_spec {
    char *plugin, *address, *params; /* owned; "": missing */
} plugin_spec;

/* Returns false without a plugin name or if memory is out. Call plugin_spec_finish in every
 * case. */
bool plugin_spec_read(plugin_spec *out, const char *text);
void plugin_spec_finish(plugin_spec *spec); /* accepts a zeroed struct */

#endif
