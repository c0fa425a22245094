/* base/program.h - where the programs are that marotte starts beside itself. Leaves out starting
 * them. [main], or any thread that may block. */
#ifndef MAROTTE_BASE_PROGRAM_H
#define MAROTTE_BASE_PROGRAM_H
#include "base/error.h"

#include <limits.h>

/* The program `name`: where the environment's `variable` says, else beside the running program,
 * else in build_dir. purpose, for the error: "it examines plugins". */
CHECKED mrt_result program_find(char out[PATH_MAX], const char *name, const char *variable,
                                const char *build_dir, const char *purpose, error *err);

#endif
