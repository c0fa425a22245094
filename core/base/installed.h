/* base/installed.h - locations of the program's own files, relative to the program, so that an
 * installation can be moved. The build folder has the same layout as an installation. [main] */
#ifndef MAROTTE_BASE_INSTALLED_H
#define MAROTTE_BASE_INSTALLED_H
#include "base/error.h"
#include "base/suggest.h"

#include <stdbool.h>

enum { INSTALLED_LENGTH = 4096 };

/* Returns the path of the running program. False: unknown. */
bool installed_program(char out[INSTALLED_LENGTH]);
/* Returns the folder for building plugins, with links resolved: it contains
 * include/marotte/plugin.h and the package files. False: the header is not installed. */
bool installed_prefix(char out[INSTALLED_LENGTH]);

/* Kinds of files that come with marotte and have a short name: "puppet" is
 * rigs/puppet/puppet.rig.json. */
typedef enum installed_kind {
    INSTALLED_FACE = 0,  /* --face puppet */
    INSTALLED_PATCH,     /* --patch faders */
    INSTALLED_RECORDING, /* --input log:demo */
    INSTALLED_KINDS
} installed_kind;

/* Returns the path of a file, or of the installed file with that name. A file in the working
 * directory takes precedence. If neither exists, returns the given text. The caller frees the copy;
 * NULL: no memory. */
char *installed_path(installed_kind kind, const char *given);
/* Returns the path of a face that a show or the settings keep. If it came with an installation that
 * was moved or replaced, the same face of this installation. Else the given path. The caller frees
 * the copy; NULL: no memory. */
char *installed_kept_face(const char *path);
/* Fails if `given` looks like a short name (no '/'), but is neither a file nor an installed name.
 * The error lists the installed names, and the most similar one. */
CHECKED mrt_result installed_check(installed_kind kind, const char *given, error *err);
/* Returns a suggestion for a message about a missing file: the most similar installed name or file
 * as a question (base/suggest.h), and the installed names. */
suggest_text installed_suggest(installed_kind kind, const char *given);
/* Finds a file that is installed beside the rigs: "demo_hand.csv". False: not found. */
bool installed_data(char out[INSTALLED_LENGTH], const char *file);

#endif
