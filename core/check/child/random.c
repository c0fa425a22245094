#include "check/child/random.h"

/* splitmix64 (S. Vigna). */
uint64_t random_next(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

double random_unit(uint64_t *state)
{
    return (double)(random_next(state) >> 11) * 0x1p-53;
}

double random_between(uint64_t *state, double low, double high)
{
    return low + (high - low) * random_unit(state);
}

uint32_t random_below(uint64_t *state, uint32_t count)
{
    return (uint32_t)(random_next(state) >> 32) % count;
}

bool random_one_in(uint64_t *state, uint32_t count)
{
    return random_below(state, count) == 0;
}

void random_bytes(uint64_t *state, void *out, size_t size)
{
    unsigned char *bytes = out;
    for (size_t i = 0; i < size; ++i)
        bytes[i] = (unsigned char)(random_next(state) >> 56);
}
