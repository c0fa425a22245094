/* base/memory.h - how much memory the program has. Any thread. */
#ifndef MAROTTE_BASE_MEMORY_H
#define MAROTTE_BASE_MEMORY_H
#include <stdint.h>

/* Bytes of it that are in the machine's memory now; 0: the system does not say. */
uint64_t memory_resident(void);
/* What is freed goes back to the system when it is large, so that memory_resident tells what is in
 * use. Once, at the start. */
void memory_give_back(void);

#endif
