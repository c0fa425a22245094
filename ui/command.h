/* ui/command.h - what the program's commands share: one file per command, one table entry each.
 * Exit codes: 0 done, 1 failed, 2 wrong usage. One clear line on stderr names what failed. [main]
 */
#ifndef MAROTTE_UI_COMMAND_H
#define MAROTTE_UI_COMMAND_H
#include "base/error.h"

#include <getopt.h>
#include <stddef.h>

enum { COMMAND_DONE = 0, COMMAND_FAILED = 1, COMMAND_USAGE = 2 };

typedef struct command {
    const char *name;                  /* "deform" */
    const char *summary;               /* for the list of commands: one line */
    const char *help;                  /* the whole --help text, ended by \n; NULL: run says it */
    const char *more_help;             /* a list below it; NULL: none */
    int (*run)(int argc, char **argv); /* argv[0] is the command's name; --help is handled before */
} command;

extern const command command_bench, command_camera, command_calibrate, command_deform,
    command_devices, command_paper, command_perform, command_plugin, command_rig, command_stage,
    command_take;

/* Whether the first argument is a show or an option of the stage, and no command. */
bool stage_is_meant(const char *first);

/* What the person typed, "marotte perform --face moai ...": words quoted where a shell needs it, of
 * long paths the last folders. */
void command_typed(char *out, size_t capacity);

/* An option, and where in the command's options what it says is put. */
typedef enum command_option_kind {
    COMMAND_FLAG = 0, /* a bool, which becomes true; no value follows */
    COMMAND_TEXT,     /* a const char *: the value as it stands */
    COMMAND_NUMBER,   /* a double, least .. most */
    COMMAND_WHOLE,    /* a uint32_t, least .. most */
    COMMAND_READ      /* whatever `read` makes of the value */
} command_option_kind;
typedef int command_option_read(void *to, const command *self, const char *name, const char *text);
typedef struct command_option {
    const char *name; /* without the two dashes; NULL ends the table */
    command_option_kind kind;
    size_t offset; /* of the member, from where the options begin */
    double least, most;
    command_option_read *read; /* COMMAND_DONE: understood */
} command_option;
enum { COMMAND_OPTIONS_MAX = 40, COMMAND_OPTION_FIRST = 256 };

/* The table for getopt_long, whose answer is then COMMAND_OPTION_FIRST and on, and what such an
 * answer does to the options. */
void command_options_list(struct option out[COMMAND_OPTIONS_MAX], const command_option *table);
int command_option_put(void *options, const command *self, const command_option *which,
                       const char *text);
/* Reads a command line of options alone. Anything else is wrong usage, and said. */
int command_options(void *options, const command *self, const command_option *table, int argc,
                    char **argv);

/* Print "marotte NAME: text" on stderr and return the exit code. */
__attribute__((format(printf, 2, 3))) int command_usage(const command *self, const char *format,
                                                        ...);
int command_failed(const command *self, const error *err);

#endif
