/* hand/gap.h - when the samples of a hand have broken off. [any] */
#ifndef MAROTTE_HAND_GAP_H
#define MAROTTE_HAND_GAP_H
#include <stdbool.h>
#include <stdint.h>

/* After a longer silence what was before says nothing about now. */
#define HAND_GAP_NS 250000000LL

/* A step backwards in time is as much a break as a silence. */
static inline bool hand_is_gap(int64_t last_ns, int64_t time_ns)
{
    return time_ns < last_ns || (uint64_t)time_ns - (uint64_t)last_ns > (uint64_t)HAND_GAP_NS;
}

#endif
