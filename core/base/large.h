/* base/large.h - memory for arrays that a loop walks from end to end: aligned to a cache line, and
 * from some megabytes on laid on large pages where the system has them, so that a walk seldom waits
 * for an address. [any] */
#ifndef MAROTTE_BASE_LARGE_H
#define MAROTTE_BASE_LARGE_H
#include <stddef.h>

enum { LARGE_ALIGNMENT = 64 };

/* Not set to anything; free() gives it back. NULL: no memory. */
void *large_alloc(size_t bytes);

#endif
