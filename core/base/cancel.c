#include "base/cancel.h"

#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <unistd.h>

enum { FORCED_EXIT_CODE = 130 }; /* exit code of a shell after Ctrl-C */

static _Atomic bool asked;
static cancel_patience patience_now;
static void (*also_call)(void);

static void force(int number)
{
    (void)number;
    _exit(FORCED_EXIT_CODE);
}

static void on_signal(int number)
{
    (void)number;
    atomic_store(&asked, true);
    if (patience_now == CANCEL_A_SECOND)
        (void)alarm(1);
    if (also_call)
        also_call();
}

void cancel_on_signals(cancel_patience patience, void (*also)(void))
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction late = {.sa_handler = force}, ask = {.sa_handler = on_signal}, before;
    patience_now = patience;
    also_call = also;
    sigemptyset(&late.sa_mask);
    sigemptyset(&ask.sa_mask);
    ask.sa_flags = (int)SA_RESETHAND;
    if (patience == CANCEL_A_SECOND)
        sigaction(SIGALRM, &late, NULL);
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; ++i)
        if (signals[i] != SIGHUP || /* with nohup the program outlives the terminal */
            (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN))
            sigaction(signals[i], &ask, NULL);
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
