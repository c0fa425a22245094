/* base/large.h - memory for arrays that a loop reads from end to end. It is aligned to a cache
 * line. Arrays of several megabytes use large pages if the system has them, which avoids TLB
 * misses. [any] */
#ifndef MAROTTE_BASE_LARGE_H
#define MAROTTE_BASE_LARGE_H
#include <stddef.h>

enum { LARGE_ALIGNMENT = 64 };

/* Allocates uninitialised memory. NULL: no memory. */
void *large_alloc(size_t bytes);
void large_free(void *array); /* accepts NULL */

#endif
