#include "check/child/watch.h"
#include "check/child/place.h"
#include "check/child/tell.h"
#include "check/child/trap.h"

#include <marotte/plugin.h>

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

enum { STACK_BYTES = 1 << 16, TICKS_MAX = 20, FRAME_TICKS_MAX = 2 };
static const struct itimerval tick = {{0, 500000}, {0, 500000}}; /* of CPU time */

static unsigned char stack[STACK_BYTES];
static volatile sig_atomic_t is_over, is_in_frame, ticks;

/* The process is lost and nothing else runs: what is not safe in a handler elsewhere is worth the
 * risk here, the parent copes with a child that says nothing. */
static void go_down(check_rule rule, const char *how)
{
    char where[256], text[512];
    place at;
    trap_leave();
    place_take(&at);
    (void)place_name(&at, where, sizeof where);
    (void)snprintf(text, sizeof text, "%s in %s", how, where);
    is_over = 1;
    tell_down(rule, text);
    _exit(1);
}

static void on_crash(int signal_number)
{
    go_down(RULE_RUN_CRASH, strsignal(signal_number));
}

static void on_tick(int signal_number)
{
    (void)signal_number;
    ticks += 1;
    if (is_in_frame && ticks > FRAME_TICKS_MAX)
        go_down(RULE_RUN_HANG, "more than 1 s of processor time");
    if (ticks > TICKS_MAX)
        go_down(RULE_RUN_HANG, "more than 10 s of processor time");
}

static void on_alarm(int signal_number)
{
    (void)signal_number;
    go_down(RULE_RUN_HANG, "no end");
}

static void on_exit_called(void)
{
    if (!is_over)
        go_down(RULE_RUN_EXIT, "the process was ended");
}

/* What a sanitizer finds ends in on_crash. Without sanitizers nobody asks. */
MRT_EXPORT const char *__asan_default_options(void);
MRT_EXPORT const char *__ubsan_default_options(void);

const char *__asan_default_options(void)
{
    return "abort_on_error=1";
}

const char *__ubsan_default_options(void)
{
    return "abort_on_error=1";
}

static void handle(int signal_number, void (*handler)(int))
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    action.sa_flags = SA_ONSTACK | SA_RESTART;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(signal_number, &action, NULL);
}

void watch_begin(unsigned limit_s)
{
    static const int crashes[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGSYS};
    stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    (void)sigaltstack(&other, NULL);
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; ++i)
        handle(crashes[i], on_crash);
    handle(SIGPROF, on_tick);
    handle(SIGALRM, on_alarm);
    (void)atexit(on_exit_called);
    (void)setitimer(ITIMER_PROF, &tick, NULL);
    (void)alarm(limit_s);
}

void watch_end(void)
{
    is_over = 1;
}

void watch_frame_enter(void)
{
    ticks = 0;
    is_in_frame = 1;
}

void watch_frame_leave(void)
{
    is_in_frame = 0;
    ticks = 0;
}

void watch_next(void)
{
    ticks = 0;
}
