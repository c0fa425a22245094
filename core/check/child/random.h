/* check/child/random.h - numbers that look random, the same for the same seed everywhere. Pure. */
#ifndef MAROTTE_CHECK_CHILD_RANDOM_H
#define MAROTTE_CHECK_CHILD_RANDOM_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

uint64_t random_next(uint64_t *state);
double random_unit(uint64_t *state); /* [0, 1) */
double random_between(uint64_t *state, double low, double high);
uint32_t random_below(uint64_t *state, uint32_t count); /* count > 0 */
bool random_one_in(uint64_t *state, uint32_t count);
void random_bytes(uint64_t *state, void *out, size_t size);

#endif
