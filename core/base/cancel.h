/* base/cancel.h - that whoever sits in front of the program wants what goes on to end: Ctrl-C,
 * SIGTERM, or the terminal was closed. It is asked once, and stands until the program ends; a
 * second signal ends the program as it would have without. Leaves out what "end" means: who records
 * keeps what there is, who reads leaves nothing half done. [any] */
#ifndef MAROTTE_BASE_CANCEL_H
#define MAROTTE_BASE_CANCEL_H
#include "base/error.h"

#include <stdbool.h>

typedef enum cancel_patience {
    CANCEL_WAITS = 0, /* something is being kept: it may take as long as it takes */
    CANCEL_A_SECOND   /* after that the program ends wherever it is */
} cancel_patience;

/* [main] From now on signals ask. `also` (NULL: nothing) is called in the signal handler, to wake
 * whoever waits. */
void cancel_on_signals(cancel_patience patience, void (*also)(void));
void cancel_ask(void); /* the same without a signal: the key q */
bool cancel_is_asked(void);
_Atomic bool *cancel_flag(void); /* the same, for those who look at a flag or set it */
/* MRT_ERR_IO, "stopped", when it is asked. */
CHECKED mrt_result cancel_check(error *err);

#endif
