/* base/installed.h - where the program's own files are: relative to the program, so that what was
 * installed may be moved. The build folder looks like an installation. [main] */
#ifndef MAROTTE_BASE_INSTALLED_H
#define MAROTTE_BASE_INSTALLED_H
#include "base/error.h"
#include "base/suggest.h"

#include <stdbool.h>

enum { INSTALLED_LENGTH = 4096 };

/* The running program. False: nobody knows. */
bool installed_program(char out[INSTALLED_LENGTH]);
/* What a plugin's build has to be told: the folder that include/marotte/plugin.h and the package
 * files are in, without links. False: the header is not installed. */
bool installed_prefix(char out[INSTALLED_LENGTH]);

/* Files that come with marotte and have a name: "puppet" is rigs/puppet/puppet.rig.json. */
typedef enum installed_kind {
    INSTALLED_FACE = 0,  /* --face puppet */
    INSTALLED_PATCH,     /* --patch faders */
    INSTALLED_RECORDING, /* --input log:demo */
    INSTALLED_KINDS
} installed_kind;

/* The path that a person means: a file, or the name of an installed one. A file of that name in the
 * working directory wins, and what is neither is returned as it is. A copy for the caller to free;
 * NULL: no memory. */
char *installed_path(installed_kind kind, const char *given);
/* An error for what is neither a file nor such a name, if it looks like a name (no '/'): it lists
 * the installed ones, and the nearest name. */
CHECKED mrt_result installed_check(installed_kind kind, const char *given, error *err);
/* For a message about a file that is missing: the nearest installed name or file, as a question
 * (base/suggest.h), and the installed names. */
suggest_text installed_suggest(installed_kind kind, const char *given);
/* A file that comes with marotte beside its rigs: "demo_hand.csv". False: it is not there. */
bool installed_data(char out[INSTALLED_LENGTH], const char *file);

#endif
