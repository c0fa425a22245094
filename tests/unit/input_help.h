/* input_help.h - what the tests of inputs share: the flaky device, and inputs that are waited for
 * instead of slept for. Include after cmocka.h. */
#ifndef TESTS_UNIT_INPUT_HELP_H
#define TESTS_UNIT_INPUT_HELP_H
#include "base/clock.h"
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct flaky_library {
    plugin_list list;
    const mrt_plugin_type *type;
    log_queue *log;
} flaky_library;

static int flaky_load(void **state)
{
    static flaky_library library;
    char path[1024];
    error err = {""};
    library = (flaky_library){.log = log_queue_create()};
    snprintf(path, sizeof path, "%s/tests/plugin/flaky.so", BUILD_DIR);
    if (!library.log || plugin_list_add(&library.list, path, &err) < 0 ||
        plugin_list_find(&library.list, "flaky", MRT_INPUT, &library.type, &err) < 0) {
        print_message("%s\n", err.text);
        return -1;
    }
    *state = &library;
    return 0;
}

static int flaky_unload(void **state)
{
    flaky_library *library = *state;
    plugin_list_destroy(&library->list);
    log_queue_destroy(library->log);
    return 0;
}

/* An input of the flaky device that is tried again every 2 ms. */
static input *flaky_input(const flaky_library *library, const char *address, const char *params)
{
    error err = {""};
    input *in = NULL;
    if (input_create(&in, library->type, address, params, CLOCK_REAL, library->log, &err) < 0)
        print_message("%s\n", err.text);
    assert_non_null(in);
    input_set_patience_ns(in, 2 * NS_PER_MS, 2 * NS_PER_MS);
    return in;
}

static inline int file_count(void)
{
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    assert_non_null(folder);
    while (readdir(folder))
        count += 1;
    closedir(folder);
    return count;
}

#endif
