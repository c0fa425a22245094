/* base/cpu.h - the CPUs that this process may use, and where its threads run. Where the system does
 * not say, there is one CPU and threads run where they like. [any] */
#ifndef MAROTTE_BASE_CPU_H
#define MAROTTE_BASE_CPU_H
#include <pthread.h>
#include <stdint.h>

enum { CPU_UNKNOWN = -1 };

uint32_t cpu_count(void); /* that the calling thread may use; >= 1 */
int cpu_now(void);        /* of the calling thread; it may be on another one already */
/* Lets the threads run on every CPU that the calling thread may use, but not on this one; if that
 * leaves none, where they like. */
void cpu_keep_off(const pthread_t *thread, uint32_t count, int cpu);

#endif
