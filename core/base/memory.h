/* base/memory.h - memory use of the program. [any] */
#ifndef MAROTTE_BASE_MEMORY_H
#define MAROTTE_BASE_MEMORY_H
#include <stdint.h>

/* Bytes in physical memory now; 0: the system does not report it. */
uint64_t memory_resident(void);
/* Until memory_started, the heap is one arena on huge pages that returns little memory to the
 * system. Mapping page by page took a third of the start. Call it once, before anything else. */
void memory_set_up(void);
/* Call it after the start. From then on large blocks return to the system when they are freed, so
 * that memory_resident is the memory in use. */
void memory_started(void);
/* Bytes allocated and not freed; 0: the system does not report it. */
uint64_t memory_in_use(void);
/* Also returns freed memory between small blocks. It takes some milliseconds: call it after freeing
 * something large, and not on the frame thread. */
void memory_give_back(void);

#endif
