/* check/child/tell.h - what a case found out, line by line to the parent (wire.h), at once: a line
 * that was told stays told when the plugin takes the process down. Of each rule the first failure
 * counts. One thread. */
#ifndef MAROTTE_CHECK_CHILD_TELL_H
#define MAROTTE_CHECK_CHILD_TELL_H
#include "check/rules.h"

void tell_to(int fd);

/* What is being done, for whoever reads why it crashed: "process() of a random walk". `blamed`: the
 * rule that is broken if it does not come back; RULE_COUNT: run.crash, run.hang or run.exit. */
__attribute__((format(printf, 2, 3))) void tell_doing(check_rule blamed, const char *format, ...);
const char *tell_what(void);
check_rule tell_blamed(void);

__attribute__((format(printf, 2, 3))) void tell_failed(check_rule rule, const char *format, ...);
bool tell_has_failed(check_rule rule);
bool tell_has_failed_any(void);
/* Judged, and nothing was found; the text may be "". */
__attribute__((format(printf, 2, 3))) void tell_ok(check_rule rule, const char *format, ...);
__attribute__((format(printf, 2, 3))) void tell_skipped(check_rule rule, const char *format, ...);
/* Something that the parent wants to know. */
__attribute__((format(printf, 2, 3))) void tell_fact(const char *name, const char *format, ...);
/* The case came to its end. */
void tell_end(void);
/* The plugin took the process down: told for the rule that is blamed, or else for `rule`. */
void tell_down(check_rule rule, const char *how);

#endif
