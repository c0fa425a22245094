/* ui/command.h - what the program's commands share: one file per command, one table entry each.
 * Exit codes: 0 done, 1 failed, 2 wrong usage. One clear line on stderr names what failed. [main]
 */
#ifndef MAROTTE_UI_COMMAND_H
#define MAROTTE_UI_COMMAND_H
#include "base/error.h"

#include <getopt.h>

enum { COMMAND_DONE = 0, COMMAND_FAILED = 1, COMMAND_USAGE = 2 };

typedef struct command {
    const char *name;                  /* "deform" */
    const char *summary;               /* for the list of commands: one line */
    const char *help;                  /* the whole --help text, ended by \n; NULL: run says it */
    const char *more_help;             /* a list below it; NULL: none */
    int (*run)(int argc, char **argv); /* argv[0] is the command's name; --help is handled before */
} command;

extern const command command_bench, command_camera, command_calibrate, command_deform,
    command_devices, command_paper, command_perform, command_plugin, command_rig, command_take;

/* What the person typed, "marotte perform --face moai ...": words quoted where a shell needs it, of
 * long paths the last folders. */
void command_typed(char *out, size_t capacity);

/* Reads a command line of options alone, each with `read`, which says COMMAND_DONE for one that it
 * understood. Anything else is wrong usage, and said. */
typedef int command_read_option(void *data, const command *self, int option, const char *value);
int command_options(const command *self, int argc, char **argv, const struct option *table,
                    command_read_option *read, void *data);

/* Print "marotte NAME: text" on stderr and return the exit code. */
__attribute__((format(printf, 2, 3))) int command_usage(const command *self, const char *format,
                                                        ...);
int command_failed(const command *self, const error *err);

#endif
