/* base/memory.h - how much memory the program has. Any thread. */
#ifndef MAROTTE_BASE_MEMORY_H
#define MAROTTE_BASE_MEMORY_H
#include <stdint.h>

/* Bytes of it that are in the machine's memory now; 0: the system does not say. */
uint64_t memory_resident(void);
/* Until memory_started the heap is one arena on huge pages, and gives little back: mapping memory
 * page by page was a third of a start. Once, first of all. */
void memory_set_up(void);
/* Called after the start. Large blocks return to the system when they are freed, so that
 * memory_resident is the memory in use. */
void memory_started(void);
/* Bytes that the program has asked for and not freed; 0: the system does not say. */
uint64_t memory_in_use(void);
/* What was freed between small things goes back too. It takes some milliseconds: after something
 * large has gone, and not on the frame thread. */
void memory_give_back(void);

#endif
