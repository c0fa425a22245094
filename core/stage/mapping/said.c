#include "stage/said.h"

void said_reset(said *self)
{
    self->count = 0;
}

/* FNV-1a */
static uint64_t hash_of(const char *text)
{
    uint64_t hash = 14695981039346656037u;
    for (; *text; ++text)
        hash = (hash ^ (unsigned char)*text) * 1099511628211u;
    return hash;
}

bool said_before(said *self, const char *text)
{
    uint64_t hash = hash_of(text);
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->hash[i] == hash)
            return true;
    if (self->count == SAID_MAX)
        return true;
    self->hash[self->count++] = hash;
    return false;
}
