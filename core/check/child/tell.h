/* check/child/tell.h - reports the findings of a case to the parent, line by line (wire.h),
 * immediately: a reported line is kept even if the plugin crashes the process. Only the first
 * failure of each rule counts. One thread. */
#ifndef MAROTTE_CHECK_CHILD_TELL_H
#define MAROTTE_CHECK_CHILD_TELL_H
#include "check/rules.h"

void tell_to(int fd);

/* Sets the current action, for the report of a crash: "process() of a random walk". blamed: rule
 * that is broken if the call does not return; RULE_COUNT: run.crash, run.hang or run.exit. */
__attribute__((format(printf, 2, 3))) void tell_doing(check_rule blamed, const char *format, ...);
const char *tell_what(void);
check_rule tell_blamed(void);

__attribute__((format(printf, 2, 3))) void tell_failed(check_rule rule, const char *format, ...);
bool tell_has_failed(check_rule rule);
bool tell_has_failed_any(void);
/* Reports that the rule was judged without a finding; the text may be "". */
__attribute__((format(printf, 2, 3))) void tell_ok(check_rule rule, const char *format, ...);
__attribute__((format(printf, 2, 3))) void tell_skipped(check_rule rule, const char *format, ...);
/* Reports a value to the parent. */
__attribute__((format(printf, 2, 3))) void tell_fact(const char *name, const char *format, ...);
/* Reports the end of the case. */
void tell_end(void);
/* Reports that the plugin ended the process, for the blamed rule, or else for `rule`. */
void tell_down(check_rule rule, const char *how);

#endif
