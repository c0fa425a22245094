/* check/child/trap.h - catches what a plugin may not do where it is: allocate, lock, open, send,
 * ask for the time, wait, start something. The program defines these functions of libc itself, so
 * that the plugin's calls, and those of the libraries that it uses, come here first; outside a
 * trapped call they go on unchanged. Does not see system calls made without libc, nor what other
 * threads of the plugin do. glibc. */
#ifndef MAROTTE_CHECK_CHILD_TRAP_H
#define MAROTTE_CHECK_CHILD_TRAP_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum trap_kind {
    TRAP_ALLOCATION = 0,
    TRAP_LOCK,
    TRAP_FILE,
    TRAP_NETWORK,
    TRAP_CLOCK,
    TRAP_SLEEP,
    TRAP_PROCESS,
    TRAP_HOST, /* a host service that is not for this thread: told by host.c */
    TRAP_KINDS
} trap_kind;
enum { TRAP_ALL = (1 << TRAP_KINDS) - 1 };

/* From now on, on this thread, kinds (1 << TRAP_*) are caught. What would wait does not. */
void trap_enter(uint32_t kinds);
void trap_leave(void);
/* What the host does for the plugin is not the plugin's doing: returns what trap_resume wants. */
uint32_t trap_pause(void);
void trap_resume(uint32_t kinds);

/* A function of that kind is being called: trap_libc.c, host.c. */
void trap_note(trap_kind kind, const char *function);
/* Whether that kind is being caught now: what would wait must not. */
bool trap_catches(trap_kind kind);

/* Which function was caught first since the last call of this for that kind, and from where:
 * "malloc() in grow+0x12 (a.so+0x1152)"; false: none. */
bool trap_caught(trap_kind kind, char *out, size_t capacity);

/* Bytes of the heap in use. */
size_t trap_heap_bytes(void);

#endif
