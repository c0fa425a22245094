/* stage/mapping/library.h - one shared library with plugins in it: whether its file can be given to
 * dlopen without harm, and the types in it. Nothing else in marotte loads a plugin's library. What
 * is wrong is said without the path. [main], or any thread that may block. */
#ifndef MAROTTE_STAGE_MAPPING_LIBRARY_H
#define MAROTTE_STAGE_MAPPING_LIBRARY_H
#include "base/error.h"

/* Refuses what is not a regular file (dlopen waits for ever on a pipe) and libraries whose segments
 * lie beyond the file's end (their missing pages kill the program when they are touched). What is
 * wrong otherwise is left to dlopen to say. */
CHECKED mrt_result library_check_file(const char *path, error *err);

/* Loads it, by its path alone: never by a search. Its types, at least one, ended by NULL; NULL and
 * why. It is never unloaded: what has run stays. */
const mrt_plugin_type *const *library_open(const char *path, error *err);

#endif
