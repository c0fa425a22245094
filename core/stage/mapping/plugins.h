/* stage/mapping/plugins.h - which plugins there are: shared libraries found in the folders of the
 * path list, loaded, checked, and never unloaded. One that cannot be used says why and is skipped.
 * Only [main] adds to a list; any thread may read it meanwhile: what is in it never moves. */
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

typedef struct plugin_list { /* zeroed: empty; each has room for PLUGIN_LIST_MAX */
    plugin_entry *entry;     /* in the order of the path list; the first of an id wins */
    plugin_entry *hidden;    /* another of that id was there before */
    plugin_refusal *refusal; /* what was not loaded, and what is hidden */
    _Atomic uint32_t entry_count, hidden_count, refusal_count;
} plugin_list;

/* Looks into $MAROTTE_PLUGIN_PATH (folders with ':' between), the user's data folder, the installed
 * folder (found from the running program: an installation may be moved), and the folder `plugins`
 * beside the program. Missing folders are no error. What is in the list already comes first. */
CHECKED mrt_result plugin_list_load(plugin_list *list, error *err);
/* Adds one library. A refused one is an error that says why. */
CHECKED mrt_result plugin_list_add(plugin_list *list, const char *path, error *err);
void plugin_list_destroy(plugin_list *list);

/* [any] By id ("org.marotte.log") or by the last part of the id ("log"), among what is loaded: for
 * whatever a show, a setting or the network says. It cannot load: no text is a path to it. The
 * error names what there is. */
CHECKED mrt_result plugin_list_find(const plugin_list *list, const char *name,
                                    const char *interface_id, const mrt_plugin_type **out_type,
                                    error *err);

/* [main] For what the person has just written, and nothing else (tests/house/borders.sh): as
 * plugin_list_find, and the path of a library ("wave.so", "build/wave.so") loads it;
 * "wave.so/tide" names one of several types with that interface. */
CHECKED mrt_result plugin_list_choose(plugin_list *list, const char *words,
                                      const char *interface_id, const mrt_plugin_type **out_type,
                                      error *err);
/* The same for "PLUGIN[:ADDRESS][,key=value]": out_spec is that text with the id of the type
 * instead of a path, for plugin_list_find. To be freed. */
CHECKED mrt_result plugin_list_choose_spec(plugin_list *list, const char *spec,
                                           const char *interface_id, char **out_spec, error *err);

/* The functions of an interface, or NULL. */
const void *plugin_interface(const mrt_plugin_type *type, const char *interface_id);

/* The path of the library that a type of the list came from; NULL: none of the list. */
const char *plugin_list_path_of(const plugin_list *list, const mrt_plugin_type *type);
/* Whether a library comes with the program: it lies in the installed folder, or in `plugins` beside
 * the program. */
bool plugin_is_shipped(const char *library);

/* "cyberglove" of "org.marotte.cyberglove": what names it before an address. */
const char *plugin_short_name(const mrt_plugin_type *type);

/* Whether lists for people show it. False: it only serves the takes that were recorded with it. */
bool plugin_is_offered(const mrt_plugin_type *type);

/* Checks one type against the rules of plugin.h that can be seen without running it. */
CHECKED mrt_result plugin_type_check(const mrt_plugin_type *type, error *err);

/* ---- one library: nothing else in marotte loads a plugin's. What is wrong is said without the
 * path. [main], or any thread that may block ---- */

/* Refuses what is not a regular file (dlopen waits for ever on a pipe) and libraries whose segments
 * lie beyond the file's end (their missing pages kill the program when they are touched). What is
 * wrong otherwise is left to dlopen to say. */
CHECKED mrt_result plugin_library_check(const char *path, error *err);
/* Loads it, by its path alone: never by a search. Its types, at least one, ended by NULL; NULL and
 * why. It is never unloaded: what has run stays. */
const mrt_plugin_type *const *plugin_library_open(const char *path, error *err);

/* Which file lies at a path: it was rebuilt when this has changed. Zeroed: none. */
typedef struct plugin_library_stamp {
    int64_t time_ns, size;
    uint64_t file;
} plugin_library_stamp;
plugin_library_stamp plugin_library_stamp_of(const char *path); /* NULL: none */
bool plugin_library_is_same(const plugin_library_stamp *a, const plugin_library_stamp *b);

/* ---- "PLUGIN:ADDRESS,key=value,..." as people write it, taken apart [any] ---- */

typedef struct plugin_spec {
    char *plugin, *address, *params; /* owned; "" where there is none */
} plugin_spec;

/* False: it names no plugin, or there is no memory. To be finished either way. */
bool plugin_spec_read(plugin_spec *out, const char *text);
void plugin_spec_finish(plugin_spec *spec); /* zeroed is fine */

#endif
