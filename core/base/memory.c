#include "base/memory.h"

#include <malloc.h>
#include <stdio.h>
#include <unistd.h>

enum { LARGE_BYTES = 128 << 10, SPARE_BYTES = 128 << 10, SPARE_AT_START_BYTES = 16 << 20 };

uint64_t memory_resident(void)
{
    unsigned long long total = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return 0;
    int read = fscanf(file, "%llu %llu", &total, &resident);
    fclose(file);
    long page = sysconf(_SC_PAGESIZE);
    return read == 2 && page > 0 ? resident * (unsigned long long)page : 0;
}

void memory_set_up(void)
{
#ifdef M_MMAP_THRESHOLD /* glibc raises it with use unless it is set */
    (void)mallopt(M_MMAP_THRESHOLD, LARGE_BYTES);
    (void)mallopt(M_TRIM_THRESHOLD, SPARE_AT_START_BYTES);
#endif
}

void memory_started(void)
{
#ifdef M_TRIM_THRESHOLD
    (void)mallopt(M_TRIM_THRESHOLD, SPARE_BYTES);
#endif
}

uint64_t memory_in_use(void)
{
#ifdef __GLIBC__
    const struct mallinfo2 all = mallinfo2();
    return (uint64_t)all.uordblks + all.hblkhd;
#else
    return 0;
#endif
}

void memory_give_back(void)
{
#ifdef __GLIBC__
    (void)malloc_trim(0);
#endif
}
