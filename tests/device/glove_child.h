/* device/glove_child.h - runs the glove emulator beside a test, with a folder of its own for the
 * link to its terminal and for its ground truth. It ends when the test does, whatever happens. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_CHILD_H
#define MAROTTE_TESTS_DEVICE_GLOVE_CHILD_H
#include "base/error.h"

#include <sys/types.h>

typedef struct glove_child {
    pid_t pid; /* 0: not running */
    int to, from;
    char folder[64], link[96], truth[96];
    char address[112]; /* for the plugin: "serial:" and the link */
} glove_child;

/* The folder and the names in it alone. */
CHECKED mrt_result glove_child_prepare(glove_child *out, error *err);
/* Starts `program` with options, NULL-ended, and waits until the terminal is there. When the system
 * has no pseudo terminals the result is MRT_ERR_UNSUPPORTED: skip. */
CHECKED mrt_result glove_child_start(glove_child *out, const char *program,
                                     const char *const *options, error *err);
/* "unplug", "plug", "silent", "speak". */
void glove_child_say(glove_child *child, const char *word);
/* Waits for the start of another life, at most a minute. */
CHECKED mrt_result glove_child_wait_ready(glove_child *child, error *err);
/* Ends it; the ground truth is then complete and stays until glove_child_finish. False: it ended in
 * another way than asked. */
bool glove_child_stop(glove_child *child);
void glove_child_finish(glove_child *child); /* stops it and removes the folder; accepts zeroed */

#endif
