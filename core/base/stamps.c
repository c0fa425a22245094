#include "base/stamps.h"

#include "base/clock.h"

#include <stdlib.h>
#include <string.h>

mrt_result stamps_create(stamps *out, uint32_t count, error *err)
{
    *out = (stamps){.count = count, .now = 1};
    out->at = malloc(((size_t)count + 1) * sizeof *out->at);
    if (!out->at)
        return error_set(err, MRT_ERR_MEMORY, "no memory to track %u parts", count);
    out->source = (stamps_source){out->at, clock_now_ns()};
    stamps_mark_all(out);
    return MRT_OK;
}

void stamps_destroy(stamps *s)
{
    if (!s)
        return;
    free(s->at);
    *s = (stamps){0};
}

void stamps_copy(stamps *out, const stamps *from)
{
    memcpy(out->at, from->at, from->count * sizeof *out->at);
    out->now = from->now;
    out->source = from->source;
}

void stamps_begin(stamps *s)
{
    s->now += 1;
}

void stamps_mark(stamps *s, uint32_t part)
{
    s->at[part] = s->now;
}

void stamps_mark_all(stamps *s)
{
    for (uint32_t part = 0; part < s->count; ++part)
        s->at[part] = s->now;
}

static bool is_of(const stamps_reader *r, const stamps *s)
{
    return r->source.address == s->source.address && r->source.born_ns == s->source.born_ns;
}

bool stamps_is_new(const stamps_reader *r, const stamps *s, uint32_t part)
{
    return !is_of(r, s) || s->at[part] > r->seen;
}

bool stamps_may_have_changes(const stamps_reader *r, const stamps *s)
{
    return !is_of(r, s) || s->now > r->seen;
}

void stamps_read(stamps_reader *r, const stamps *s)
{
    *r = (stamps_reader){s->source, s->now};
}
