/* ui/cli/command.h - what the program's commands share: one file per command, one table entry each.
 * Exit codes: 0 done, 1 failed, 2 wrong usage. One clear line on stderr names what failed. [main]
 */
#ifndef MAROTTE_UI_COMMAND_H
#define MAROTTE_UI_COMMAND_H
#include "cli/facts.h"

#include <stddef.h>

enum { COMMAND_DONE = 0, COMMAND_FAILED = 1, COMMAND_USAGE = 2 };

typedef struct command {
    const char *name;      /* "deform" */
    const char *summary;   /* for the list of commands: one line */
    const char *help;      /* the --help text, ended by \n; NULL: print_help */
    const char *more_help; /* a list below it; NULL: none */
    const char *examples;  /* below both, as command_print_examples takes them; NULL: none */
    int (*print_help)(int argc, char **argv); /* returns the exit code */
    int (*run)(int argc, char **argv); /* argv[0] is the command's name; --help is handled before */
} command;

/* Command lines without "marotte", each ended by \n. */
void command_print_examples(const char *lines);

extern const command command_bench, command_camera, command_calibrate, command_deform,
    command_devices, command_paper, command_perform, command_plugin, command_rig, command_stage,
    command_take;

/* Whether the first argument is an option of the stage, a show (also one that is to be created), or
 * another file that the stage opens. */
bool stage_is_meant(const char *first);

/* What the person typed, "marotte perform --face moai ...": words quoted where a shell needs it, of
 * long paths the last folders. */
void command_typed(char *out, size_t capacity);

/* What may stand on a command line, and where in the command's options what it says is put. */
typedef enum command_option_kind {
    COMMAND_FLAG = 0, /* a bool, which becomes true; no value follows */
    COMMAND_GIVEN,    /* a const char *, which becomes ""; no value follows */
    COMMAND_TEXT,     /* a const char *: the value as it stands */
    COMMAND_NUMBER,   /* a double, least .. most */
    COMMAND_WHOLE,    /* a uint32_t, least .. most */
    COMMAND_READ,     /* whatever `read` makes of the value */
    COMMAND_WORD      /* the first word that is no option; of the next row of this kind the second,
                         and so on; all may be missing. A const char *, or what `read` makes of it */
} command_option_kind;
typedef int command_option_read(void *to, const command *self, const char *name, const char *text);
typedef struct command_option {
    const char *name; /* without the two dashes; NULL ends the table */
    command_option_kind kind;
    size_t offset; /* of the member, from where the options begin */
    double least, most;
    command_option_read *read; /* COMMAND_DONE: understood */
} command_option;
enum { COMMAND_OPTIONS_MAX = 40 };

/* Reads a command line. What the table does not have is wrong usage, and said. */
int command_options(void *options, const command *self, const command_option *table, int argc,
                    char **argv);

/* For COMMAND_READ in several commands. */
command_option_read command_read_unit, /* double, mm: "cm" */
    command_read_axis,                 /* mesh_axis: "-z" */
    command_read_face,                 /* char *, to be freed: a file, or "puppet"; once only */
    command_read_spec,                 /* plugin_spec: PLUGIN[:ADDRESS][,key=value]; once only */
    command_read_look;                 /* video_look: --size, --view, --background, --look */

/* Print "marotte NAME: text" on stderr and return the exit code. */
__attribute__((format(printf, 2, 3))) int command_usage(const command *self, const char *format,
                                                        ...);
int command_failed(const command *self, const error *err);
/* Ends a command: prints its facts, or why it failed. Frees the facts. */
int command_end(const command *self, facts *told, mrt_result result, const error *err);

#endif
