/* check/child/trap.h - catches what a plugin does that it may not: where in it something happened;
 * functions of libc that it may not call where it is; calls that do not come back. Linux, glibc. */
#ifndef MAROTTE_CHECK_CHILD_TRAP_H
#define MAROTTE_CHECK_CHILD_TRAP_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- where it happened ---- */

/* After dlopen: finds where the library lies in memory. Without it every place is unknown. */
void call_stack_set_library(const char *library_path);

enum { CALL_STACK_FRAMES = 32 };
typedef struct call_stack {
    void *frame[CALL_STACK_FRAMES]; /* return addresses, the innermost first */
    int count;
} call_stack;

/* ---- what it may not call ---- */

typedef enum trap_kind {
    TRAP_ALLOCATION = 0,
    TRAP_LOCK,
    TRAP_FILE,
    TRAP_NETWORK,
    TRAP_CLOCK,
    TRAP_SLEEP,
    TRAP_PROCESS,
    TRAP_HOST, /* a host service that is not for this thread: told by fixture.c */
    TRAP_KINDS
} trap_kind;
enum { TRAP_ALL = (1 << TRAP_KINDS) - 1 };

/* From now on, on this thread, kinds (1 << TRAP_*; 0: none) are caught, and what would wait does
 * not. Returns those that were caught before, for what the host does for the plugin and is not the
 * plugin's doing. */
uint32_t trap_set(uint32_t kinds);

/* A function of that kind is being called: trap_libc.c, fixture.c. */
void trap_note(trap_kind kind, const char *function);
/* Whether that kind is being caught now: what would wait must not. */
bool trap_catches(trap_kind kind);

/* Which function was caught first since the last call of this for that kind, and from where:
 * "malloc() in grow+0x12 (a.so+0x1152)"; false: none. */
bool trap_caught(trap_kind kind, char *out, size_t capacity);

/* Bytes of the heap in use. */
size_t trap_heap_bytes(void);

/* ---- what does not come back ---- */

/* From now on. The case may take `limit_s` of wall time, a single call 10 s of CPU time, and a call
 * on the frame thread 1 s. */
void watch_begin(unsigned limit_s);
/* The case came to its end. */
void watch_end(void);

/* Around each call on the frame thread. */
void watch_frame_enter(void);
void watch_frame_leave(void);
/* Before any other call. */
void watch_next(void);

#endif
