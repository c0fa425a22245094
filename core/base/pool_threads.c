/* How many threads the pool may have. */
#include "base/cpu.h"
#include "base/pool.h"

#include <stdlib.h>
#include <string.h>

enum { USUAL_MAX = 4 };

static uint32_t usual_count(void)
{
    uint32_t cpus = cpu_count();
    return cpus < USUAL_MAX ? cpus : USUAL_MAX;
}

mrt_result pool_choose(uint32_t *out, const char *word, error *err)
{
    *out = usual_count();
    if (!word || word[0] == '\0')
        return MRT_OK;
    size_t digits = strspn(word, "0123456789");
    unsigned long count = digits > 0 && digits <= 2 ? strtoul(word, NULL, 10) : 0;
    if (word[digits] != '\0' || count < 1 || count > POOL_THREADS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "MAROTTE_THREADS=%.40s: expected a number of threads from 1 to %d, or "
                         "nothing for the usual number (%u here)",
                         word, (int)POOL_THREADS_MAX, *out);
    *out = (uint32_t)count;
    return MRT_OK;
}

uint32_t pool_threads(void)
{
    uint32_t count;
    return pool_choose(&count, getenv("MAROTTE_THREADS"), NULL) < 0 ? usual_count() : count;
}

mrt_result pool_check(error *err)
{
    uint32_t count;
    return pool_choose(&count, getenv("MAROTTE_THREADS"), err);
}
