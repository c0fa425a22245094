/* stage/said.h - remembers which texts have been said, so that what repeats is said once. Holds so
 * many texts and then takes every further one for a repetition: bounded, whatever it is given. One
 * thread at a time. */
#ifndef MAROTTE_STAGE_SAID_H
#define MAROTTE_STAGE_SAID_H
#include <stdbool.h>
#include <stdint.h>

enum { SAID_MAX = 16 };
typedef struct said {
    uint64_t hash[SAID_MAX];
    uint32_t count;
} said;

void said_reset(said *self);
/* Remembers the text; true: it was said before, or there have been too many. */
bool said_before(said *self, const char *text);

#endif
