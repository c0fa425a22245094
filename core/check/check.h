/* check/check.h - whether a plugin keeps the contract of plugin.h: every rule, each case in a
 * process of its own with a time limit, each failure named and explained. Never loads the plugin
 * into this process. Leaves out what people see of it (ui/cli/plugin.c). [main], or any thread
 * that may block. */
#ifndef MAROTTE_CHECK_CHECK_H
#define MAROTTE_CHECK_CHECK_H
#include "base/error.h"
#include "check/rules.h"

typedef enum check_verdict {
    CHECK_NOT_CONCERNED = 0, /* the rule is of an interface that it does not answer */
    CHECK_SKIPPED,           /* it could not be judged; the text says why */
    CHECK_OK,
    CHECK_FAILED
} check_verdict;

enum { CHECK_TEXT = 960, CHECK_ID = 128, CHECK_TYPES_MAX = 16 };
typedef struct check_finding {
    check_verdict verdict;
    char text[CHECK_TEXT]; /* what was found; "" */
} check_finding;
typedef struct check_subject { /* the library, or one of its types */
    char id[CHECK_ID];         /* "org.marotte.anchored"; of the library: "" */
    uint32_t concerns;         /* CONCERNS_* */
    check_finding finding[RULE_COUNT];
} check_subject;
typedef struct check_report {
    check_subject *library; /* type_count + 1 of them: the library, then its types */
    uint32_t type_count, failed_count, ok_count, skipped_count;
    double wall_s;
} check_report;

typedef struct check_settings {
    uint64_t seed;              /* of all that is random; below 2^63 */
    const char *input_address;  /* what an input is to open; NULL: "", the first found */
    const char *output_address; /* where an output is to send; NULL: nowhere */
    uint32_t jobs;              /* processes at a time; 0: as many as there are processors */
    void (*on_progress)(void *data, uint32_t done, uint32_t count); /* may be NULL */
    void *data;
} check_settings;

/* MRT_OK: it was examined, whatever was found. An error: it could not be. */
CHECKED mrt_result check_run(check_report *out, const char *path, const check_settings *settings,
                             error *err);
void check_report_finish(check_report *report); /* accepts zeroed */

/* A fraction of a second: it loads, its tables are right, it can be made, activated, and 300 frames
 * of a mapping keep the rules. An error names the rule that is broken. */
CHECKED mrt_result check_quick(const char *path, error *err);

#endif
