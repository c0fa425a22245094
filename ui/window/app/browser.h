/* window/app/browser.h - shows a page in the user's own browser: by xdg-open, or by what
 * $MAROTTE_BROWSER names. [main], or where marked any thread that may block. */
#ifndef MAROTTE_UI_WINDOW_APP_BROWSER_H
#define MAROTTE_UI_WINDOW_APP_BROWSER_H
#include "base/error.h"

#include <sys/types.h>

/* Starts the program that shows the address (http or file), and does not wait. The caller reaps the
 * process. */
CHECKED mrt_result browser_start(pid_t *out, const char *address, error *err);
/* Whether the process succeeded, from the status that it ended with. */
CHECKED mrt_result browser_ended(int status, const char *address, error *err);
/* [worker] Starts it and waits up to two seconds for a failure. */
CHECKED mrt_result browser_show(const char *address, error *err);

#endif
