#include "base/large.h"

#include "base/os.h"

#include <stdint.h>

/* For smaller arrays, the unused part of the last page would cost more than large pages gain. */
static const size_t large_from = (size_t)8 << 20;
static const size_t page = (size_t)2 << 20;

static size_t up_to(size_t bytes, size_t step)
{
    return bytes > SIZE_MAX - step ? 0 : (bytes + step - 1) / step * step;
}

void *large_alloc(size_t bytes)
{
    size_t step = bytes < large_from ? (size_t)LARGE_ALIGNMENT : page;
    size_t whole = up_to(bytes > 0 ? bytes : 1, step);
    void *found = whole > 0 ? os_aligned_alloc(step, whole) : NULL;
    if (found && step == page)
        os_use_large_pages(found, whole);
    return found;
}

void large_free(void *array)
{
    os_aligned_free(array);
}
