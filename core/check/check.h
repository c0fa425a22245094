/* check/check.h - checks whether a plugin follows the contract of plugin.h: all rules, each case in
 * a separate process with a time limit, and each failure with its rule and an explanation. Never
 * loads the plugin into this process. Leaves out the presentation (ui/cli/plugin.c). [main], or any
 * thread that may block. */
#ifndef MAROTTE_CHECK_CHECK_H
#define MAROTTE_CHECK_CHECK_H
#include "base/error.h"
#include "check/rules.h"

typedef enum check_verdict {
    CHECK_NOT_CONCERNED = 0, /* the plugin does not have the interface of the rule */
    CHECK_SKIPPED,           /* could not be judged; the text has the reason */
    CHECK_OK,
    CHECK_FAILED
} check_verdict;

enum { CHECK_TEXT = 960, CHECK_ID = 128, CHECK_TYPES_MAX = 16 };
typedef struct check_finding {
    check_verdict verdict;
    char text[CHECK_TEXT]; /* finding; "" if there is none */
} check_finding;
typedef struct check_subject { /* the library, or one of its types */
    char id[CHECK_ID];         /* "org.marotte.anchored"; "" for the library */
    uint32_t concerns;         /* CONCERNS_* */
    check_finding finding[RULE_COUNT];
} check_subject;
typedef struct check_report {
    check_subject *library; /* type_count + 1 elements: the library, then its types */
    uint32_t type_count, failed_count, ok_count, skipped_count;
    double wall_s;
} check_report;

typedef struct check_settings {
    uint64_t seed;              /* of all random numbers; below 2^63 */
    const char *input_address;  /* address for an input to open; NULL: "", the first found */
    const char *output_address; /* address for an output to send to; NULL: none */
    uint32_t jobs;              /* number of processes at a time; 0: number of processors */
    void (*on_progress)(void *data, uint32_t done, uint32_t count); /* may be NULL */
    void *data;
} check_settings;

/* Returns MRT_OK if the plugin was checked, with any result. Returns an error if it could not be
 * checked. */
CHECKED mrt_result check_run(check_report *out, const char *path, const check_settings *settings,
                             error *err);
void check_report_finish(check_report *report); /* accepts a zeroed struct */

/* Checks the plugin in a fraction of a second: it loads, its tables are valid, it can be created
 * and activated, and 300 frames of a mapping follow the rules. The error names the broken rule. */
CHECKED mrt_result check_quick(const char *path, error *err);

#endif
