/* base/cancel.h - the user's request to stop: Ctrl-C, SIGTERM, or a closed terminal. The request
 * stays set until the program ends. A second signal has its default effect and ends the program.
 * Leaves out the reaction: recording code keeps what exists, reading code leaves nothing
 * incomplete. [any] */
#ifndef MAROTTE_BASE_CANCEL_H
#define MAROTTE_BASE_CANCEL_H
#include "base/error.h"

#include <stdbool.h>

typedef enum cancel_patience {
    CANCEL_WAITS = 0, /* data is being saved, which may take any time */
    CANCEL_A_SECOND   /* after one second the program is ended */
} cancel_patience;

/* [main] Makes signals set the request. `also` (NULL: none) is called in the signal handler, to
 * wake waiting threads. */
void cancel_on_signals(cancel_patience patience, void (*also)(void));
void cancel_request(void); /* sets the request without a signal: the key q */
bool cancel_is_requested(void);
_Atomic bool *cancel_flag(void); /* the flag itself, for code that polls or sets it */
/* Returns MRT_ERR_IO, "stopped", after a request. */
CHECKED mrt_result cancel_check(error *err);

#endif
