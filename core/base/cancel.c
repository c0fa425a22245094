#include "base/cancel.h"

#include "base/os.h"

#include <stdatomic.h>
#include <stddef.h>

enum { FORCED_EXIT_CODE = 130 }; /* exit code of a shell after Ctrl-C */

static _Atomic bool asked;
static cancel_patience patience_now;
static void (*also_call)(void);

static void on_stop(void)
{
    atomic_store(&asked, true);
    if (patience_now == CANCEL_A_SECOND)
        os_end_after(1);
    if (also_call)
        also_call();
}

void cancel_on_signals(cancel_patience patience, void (*also)(void))
{
    patience_now = patience;
    also_call = also;
    os_on_stop(on_stop, FORCED_EXIT_CODE);
}

void cancel_request(void)
{
    atomic_store(&asked, true);
}

bool cancel_is_requested(void)
{
    return atomic_load(&asked);
}

_Atomic bool *cancel_flag(void)
{
    return &asked;
}

mrt_result cancel_check(error *err)
{
    return cancel_is_requested() ? error_set(err, MRT_ERR_IO, "stopped") : MRT_OK;
}
