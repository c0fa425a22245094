/* base/cpu.h - the CPUs that this process may use, and the affinity of its threads. If the system
 * does not report them, one CPU is assumed and threads run anywhere. [any] */
#ifndef MAROTTE_BASE_CPU_H
#define MAROTTE_BASE_CPU_H
#include <pthread.h>
#include <stdint.h>

enum { CPU_UNKNOWN = -1 };

uint32_t cpu_count(void); /* number of CPUs for the calling thread; >= 1 */
int cpu_now(void);        /* CPU of the calling thread; it may change at any time */
/* Lets the threads run on all CPUs of the calling thread except this one. If there are no others,
 * they run on any. */
void cpu_keep_off(const pthread_t *thread, uint32_t count, int cpu);

#endif
