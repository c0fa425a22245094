#include "check/child/trap.h"
#include "check/child/place.h"

#include <malloc.h>
#include <stdio.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_SANITIZED_HEAP 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HAS_SANITIZED_HEAP 1
#endif
#endif

typedef struct trap_hit {
    const char *function; /* NULL: nothing was caught */
    place where;
} trap_hit;

static trap_hit hits[TRAP_KINDS];
static _Thread_local uint32_t trapped;

void trap_enter(uint32_t kinds)
{
    trapped = kinds;
}

void trap_leave(void)
{
    trapped = 0;
}

uint32_t trap_pause(void)
{
    uint32_t kinds = trapped;
    trapped = 0;
    return kinds;
}

void trap_resume(uint32_t kinds)
{
    trapped = kinds;
}

void trap_note(trap_kind kind, const char *function)
{
    uint32_t kinds = trapped;
    if (!(kinds & (1u << kind)) || hits[kind].function)
        return;
    trapped = 0; /* looking at the stack is not the plugin's doing */
    hits[kind].function = function;
    place_take(&hits[kind].where);
    trapped = kinds;
}

bool trap_catches(trap_kind kind)
{
    return trapped & (1u << kind);
}

bool trap_caught(trap_kind kind, char *out, size_t capacity)
{
    char where[256];
    if (!hits[kind].function)
        return false;
    (void)place_name(&hits[kind].where, where, sizeof where);
    (void)snprintf(out, capacity, "%s() in %s", hits[kind].function, where);
    hits[kind].function = NULL;
    return true;
}

#ifdef HAS_SANITIZED_HEAP
size_t __sanitizer_get_current_allocated_bytes(void);
size_t trap_heap_bytes(void)
{
    return __sanitizer_get_current_allocated_bytes();
}
#else
size_t trap_heap_bytes(void)
{
    struct mallinfo2 use = mallinfo2();
    return use.uordblks + use.hblkhd;
}
#endif
