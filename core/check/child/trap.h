/* check/child/trap.h - detects forbidden actions of a plugin and their place in its code:
 * functions of libc that it must not call on the current thread, and calls that do not return.
 * Linux, glibc. */
#ifndef MAROTTE_CHECK_CHILD_TRAP_H
#define MAROTTE_CHECK_CHILD_TRAP_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- the place in the plugin ---- */

/* Call it after dlopen: finds the addresses of the library. Without it every place is unknown. */
void call_stack_set_library(const char *library_path);

enum { CALL_STACK_FRAMES = 32 };
typedef struct call_stack {
    void *frame[CALL_STACK_FRAMES]; /* return addresses, the innermost first */
    int count;
} call_stack;

/* ---- forbidden calls ---- */

typedef enum trap_kind {
    TRAP_ALLOCATION = 0,
    TRAP_LOCK,
    TRAP_FILE,
    TRAP_NETWORK,
    TRAP_CLOCK,
    TRAP_SLEEP,
    TRAP_PROCESS,
    TRAP_HOST, /* a host service that is forbidden on this thread; reported by fixture.c */
    TRAP_KINDS
} trap_kind;
enum { TRAP_ALL = (1 << TRAP_KINDS) - 1 };

/* Sets the kinds of calls (1 << TRAP_*; 0: none) that are caught on this thread. Functions that
 * would wait return immediately then. Returns the previous kinds, so that the host can disable
 * catching for its own calls. */
uint32_t trap_set(uint32_t kinds);

/* Records a call of a function of that kind: called by trap_libc.c and fixture.c. */
void trap_note(trap_kind kind, const char *function);
/* Returns whether that kind is caught now, so that a waiting function must return. */
bool trap_catches(trap_kind kind);

/* Describes the first caught call of that kind since the last call of this function: "malloc() in
 * grow+0x12 (a.so+0x1152)". Returns false if there was none. */
bool trap_caught(trap_kind kind, char *out, size_t capacity);

/* Returns the bytes of the heap in use. */
size_t trap_heap_bytes(void);

/* ---- calls that do not return ---- */

/* Starts the limits: `limit_s` of wall time for the case, 10 s of CPU time for one call, and 1 s
 * for a call on the frame thread. */
void watch_begin(unsigned limit_s);
/* Ends the limits, at the end of the case. */
void watch_end(void);

/* Call them around each call on the frame thread. */
void watch_frame_enter(void);
void watch_frame_leave(void);
/* Call it before any other call. */
void watch_next(void);

#endif
