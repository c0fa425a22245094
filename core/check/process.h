/* check/process.h - one case in a process of its own: started, listened to, ended when it takes too
 * long. Inside the room. One thread. */
#ifndef MAROTTE_CHECK_PROCESS_H
#define MAROTTE_CHECK_PROCESS_H
#include "base/error.h"
#include "check/wire.h"

#include <limits.h>
#include <sys/types.h>

typedef struct check_words {
    const char *program, *library, *case_name;
    uint32_t type;
    uint64_t seed;                              /* below 2^63 */
    const char *input_address, *output_address; /* NULL: none */
    uint32_t padding; /* bytes that shift its stack: everything lies elsewhere */
} check_words;

typedef struct check_process {
    pid_t pid; /* 0: none is running */
    int fd;
    int64_t deadline_ns;
    size_t used;
    char line[WIRE_LINE + 1];
    bool has_ended; /* it told its end */
    bool was_late;  /* it was ended here */
    int status;     /* of waitpid, once it is over */
} check_process;

/* The program that runs cases: $MAROTTE_PLUGINCHECK, beside this program, or in the build folder.
 */
CHECKED mrt_result check_program_find(char out[PATH_MAX], error *err);

CHECKED mrt_result check_process_start(check_process *out, const check_words *words, error *err);

/* A line: kind, name, text. */
typedef void check_on_line(void *data, char kind, const char *name, const char *text);
/* Waits until one of them says something or is over, at most 0.2 s; false: none is running. One
 * that is over has pid 0 afterwards. on_line is given data[i] for running[i]. */
bool check_process_listen(check_process *running, uint32_t count, check_on_line *on_line,
                          void *const *data);
/* Ends what still runs. */
void check_process_finish(check_process *self);

#endif
