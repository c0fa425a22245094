#include "base/memory.h"

#include "base/os.h"

#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

enum {
    LARGE_BYTES = 128 << 10,
    SPARE_BYTES = 128 << 10,
    LARGE_AT_START_BYTES = 4 << 20, /* larger rings stay untouched: calloc maps them */
    HEAP_AT_START_BYTES = 128 << 20,
    HUGE_PAGE_BYTES = 2 << 20
};

uint64_t memory_resident(void)
{
    return os_resident_bytes();
}

/* Extends the heap once to HEAP_AT_START_BYTES of address space, and requests huge pages there.
 * A page fault costs several microseconds, and 65 MiB are 16 000 small pages but only 33 huge
 * ones. */
#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)
static void reserve_heap(void)
{
    const uintptr_t at = (uintptr_t)malloc(HUGE_PAGE_BYTES), end = (uintptr_t)sbrk(0);
    const uintptr_t first = (at + HUGE_PAGE_BYTES - 1) / HUGE_PAGE_BYTES * HUGE_PAGE_BYTES;
    if (at && first < end && end - at <= (uintptr_t)HEAP_AT_START_BYTES + 2 * HUGE_PAGE_BYTES)
        (void)madvise((void *)first, end - first, MADV_HUGEPAGE); /* else it stays on small pages */
    free((void *)at);
}
#endif

void memory_set_up(void)
{
#ifdef M_MMAP_THRESHOLD /* otherwise glibc raises the threshold over time */
    (void)mallopt(M_ARENA_MAX, 1);
    (void)mallopt(M_MMAP_THRESHOLD, LARGE_AT_START_BYTES);
    (void)mallopt(M_TRIM_THRESHOLD, HEAP_AT_START_BYTES);
    (void)mallopt(M_TOP_PAD, HEAP_AT_START_BYTES);
#endif
#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)
    reserve_heap();
#endif
}

void memory_started(void)
{
#ifdef M_TRIM_THRESHOLD
    (void)mallopt(M_MMAP_THRESHOLD, LARGE_BYTES);
    (void)mallopt(M_TRIM_THRESHOLD, SPARE_BYTES);
    (void)mallopt(M_TOP_PAD, SPARE_BYTES);
#endif
}

uint64_t memory_in_use(void)
{
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
    const struct mallinfo2 all = mallinfo2();
    return (uint64_t)all.uordblks + all.hblkhd;
#elif defined(__GLIBC__) /* counts modulo 4 GiB */
    const struct mallinfo all = mallinfo();
    return (uint64_t)(unsigned)all.uordblks + (unsigned)all.hblkhd;
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
