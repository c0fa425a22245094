#define _GNU_SOURCE /* for the affinity of threads */
#include "base/cpu.h"

#include <sched.h>

#if defined(__linux__)
uint32_t cpu_count(void)
{
    cpu_set_t may;
    if (sched_getaffinity(0, sizeof may, &may) != 0)
        return 1;
    int count = CPU_COUNT(&may);
    return count > 0 ? (uint32_t)count : 1;
}

int cpu_now(void)
{
    return sched_getcpu();
}

void cpu_keep_off(const pthread_t *thread, uint32_t count, int cpu)
{
    cpu_set_t may;
    if (cpu < 0 || cpu >= CPU_SETSIZE || sched_getaffinity(0, sizeof may, &may) != 0)
        return;
    CPU_CLR((size_t)cpu, &may);
    if (CPU_COUNT(&may) == 0)
        return;
    for (uint32_t i = 0; i < count; ++i)
        (void)pthread_setaffinity_np(thread[i], sizeof may, &may); /* a failure is ignored */
}
#else
uint32_t cpu_count(void)
{
    return 1;
}

int cpu_now(void)
{
    return CPU_UNKNOWN;
}

void cpu_keep_off(const pthread_t *thread, uint32_t count, int cpu)
{
    (void)thread;
    (void)count;
    (void)cpu;
}
#endif
