/* ui/cli/command.h - shared by the program's commands: one file and one table entry each. Exit
 * codes: 0 done, 1 failed, 2 wrong usage. One clear line on stderr names what failed. [main] */
#ifndef MAROTTE_UI_COMMAND_H
#define MAROTTE_UI_COMMAND_H
#include "cli/facts.h"

#include <stddef.h>

enum { COMMAND_DONE = 0, COMMAND_FAILED = 1, COMMAND_USAGE = 2 };

struct command_option;
/* A subcommand, "rig check". */
typedef struct command_part {
    const char *name, *summary;           /* "check", "layer add" */
    const struct command_option *options; /* its table */
    int (*run)(int argc, char **argv);    /* argv[0]: the name; NULL: the command finds it itself */
} command_part;

typedef struct command {
    const char *name;      /* "deform" */
    const char *summary;   /* one line for the list of commands */
    const char *help;      /* the --help text, ends with \n; NULL: print_help */
    const char *more_help; /* a list below the help; NULL: none */
    const char *examples;  /* examples below both, for command_print_examples; NULL: none */
    int (*print_help)(int argc, char **argv); /* returns the exit code */
    int (*run)(int argc, char **argv);        /* argv[0]: the name; --help is handled before */
    const struct command_option *options;     /* its table; NULL: it has subcommands */
    /* Describes the subcommand at that place of a list. `options` has room for COMMAND_OPTIONS_MAX
     * rows of a table that is made for it. Returns false after the last one. */
    bool (*part)(command_part *out, struct command_option *options, size_t place);
} command;

/* Prints command lines without "marotte". Each line ends with \n. */
void command_print_examples(const char *lines);

extern const command command_bench, command_camera, command_calibrate, command_deform,
    command_devices, command_paper, command_perform, command_plugin, command_rig, command_stage,
    command_take;

/* Returns whether the first argument is for the stage: an option of the stage, a show (existing or
 * to be created), or another file that the stage opens. */
bool stage_accepts_argument(const char *first);

/* Writes the command line as the user typed it, "marotte perform --face moai ...". Quotes words
 * that a shell would change, and shortens long paths to their last folders. */
void command_line_text(char *out, size_t capacity);

/* Kinds of arguments on a command line, and the type of the member that receives the value. */
typedef enum command_option_kind {
    COMMAND_FLAG = 0, /* a bool, set to true; no value follows */
    COMMAND_GIVEN,    /* a const char *, set to ""; no value follows */
    COMMAND_TEXT,     /* a const char *: the value, unchanged */
    COMMAND_NUMBER,   /* a double, least .. most */
    COMMAND_WHOLE,    /* a uint32_t, least .. most */
    COMMAND_READ,     /* the type that `read` writes */
    COMMAND_WORD /* a word without dashes: the first row of this kind receives the first word, the
                    second row the second word, and so on. All are optional. A const char *, or the
                    type that `read` writes */
} command_option_kind;
typedef int command_option_read(void *to, const command *self, const char *name, const char *text);
typedef struct command_option {
    const char *name; /* without the two dashes; NULL ends the table */
    command_option_kind kind;
    size_t offset; /* of the member, from the start of the options struct */
    double least, most;
    command_option_read *read; /* returns COMMAND_DONE if it accepts the value */
} command_option;
enum { COMMAND_OPTIONS_MAX = 40 };

/* Reads a command line. Reports an argument that is not in the table, as wrong usage. */
int command_options(void *options, const command *self, const command_option *table, int argc,
                    char **argv);

/* `read` functions that several commands use. */
command_option_read command_read_unit, /* double, mm: "cm" */
    command_read_axis,                 /* mesh_axis: "-z" */
    command_read_face, /* char *, the caller frees it: a file, or "puppet"; at most once */
    command_read_spec, /* plugin_spec: PLUGIN[:ADDRESS][,key=value]; at most once */
    command_read_look; /* video_look: --size, --view, --background, --look */

/* Print "marotte NAME: text" on stderr and return the exit code. */
__attribute__((format(printf, 2, 3))) int command_usage(const command *self, const char *format,
                                                        ...);
int command_failed(const command *self, const error *err);
/* Ends a command: prints its facts, or the error if result < 0. Frees the facts. */
int command_end(const command *self, facts *told, mrt_result result, const error *err);

#endif
