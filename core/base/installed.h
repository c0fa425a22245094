/* base/installed.h - where the program's own files are: relative to the program, so that what was
 * installed may be moved. The build folder looks like an installation. [main] */
#ifndef MAROTTE_BASE_INSTALLED_H
#define MAROTTE_BASE_INSTALLED_H
#include <stdbool.h>

enum { INSTALLED_LENGTH = 4096 };

/* The running program. False: nobody knows. */
bool installed_program(char out[INSTALLED_LENGTH]);
/* What a plugin's build has to be told: the folder that include/marotte/plugin.h and the package
 * files are in, without links. False: the header is not installed. */
bool installed_prefix(char out[INSTALLED_LENGTH]);

/* What --face means: a file, or the name of a rig that comes with marotte ("puppet"). A file of
 * that name wins, and what is neither is given back as it is. A copy for the caller to free; NULL:
 * no memory. */
char *installed_face(const char *given);
/* What --patch means, likewise: a file, or the name of a patch that comes with marotte ("faders").
 */
char *installed_patch(const char *given);
/* A file that comes with marotte beside its rigs: "demo_hand.csv". False: it is not there. */
bool installed_data(char out[INSTALLED_LENGTH], const char *file);

#endif
