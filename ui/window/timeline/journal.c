#include "window/timeline/journal.h"

#include "base/clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SEEN_SHARE  16.0f /* of a range in a bin, times this: as high as a input_lane is */
#define SHORTEST_NS 200000000LL
#define NOW_NS      300000000LL /* so near to now is now */

typedef struct input_lane {
    bool is_known, has_last;
    uint64_t of;
    int64_t bin; /* the newest; those before it are whole */
    uint32_t count;
    float last[MRT_MAX_CHANNELS];
    float moved[JOURNAL_BINS];
} input_lane;

struct timeline_journal {
    input_lane lanes[JOURNAL_LANES];
};

timeline_journal *timeline_journal_create(void)
{
    return calloc(1, sizeof(timeline_journal));
}

void timeline_journal_destroy(timeline_journal *self)
{
    free(self);
}

/* ---- written ---- */

/* Up to a bin, those that nobody saw are still. */
static void go_on(input_lane *l, int64_t bin)
{
    if (!l->is_known || bin - l->bin >= JOURNAL_BINS) {
        memset(l->moved, 0, sizeof l->moved);
        l->bin = bin;
        l->is_known = true;
    }
    while (l->bin < bin) {
        l->bin += 1;
        l->moved[l->bin % JOURNAL_BINS] = 0.0f;
    }
}

static float movement(const input_lane *l, const mrt_sample *sample, const mrt_channel *channel)
{
    float sum = 0.0f;
    uint32_t counted = 0;
    for (uint32_t i = 0; i < l->count; ++i) {
        float range = channel[i].max - channel[i].min;
        if (!(range > 0.0f) || !isfinite(sample->value[i]) || !isfinite(l->last[i]))
            continue;
        sum += fabsf(sample->value[i] - l->last[i]) / range;
        counted += 1;
    }
    return counted ? sum / (float)counted : 0.0f;
}

static const input_lane *find(const timeline_journal *self, uint64_t of)
{
    for (uint32_t i = 0; i < JOURNAL_LANES; ++i)
        if (self->lanes[i].is_known && self->lanes[i].of == of)
            return &self->lanes[i];
    return NULL;
}

static input_lane *begin_lane(timeline_journal *self, uint64_t of)
{
    input_lane *out = &self->lanes[0];
    for (uint32_t i = 1; i < JOURNAL_LANES && out->is_known; ++i)
        if (!self->lanes[i].is_known || self->lanes[i].bin < out->bin)
            out = &self->lanes[i];
    out->is_known = out->has_last = false;
    out->of = of;
    return out;
}

void timeline_journal_note(timeline_journal *self, uint64_t of, int64_t now_ns,
                           const mrt_sample *sample, const mrt_channel *channel)
{
    if (now_ns < 0)
        return;
    const input_lane *known = find(self, of);
    input_lane *l = known ? &self->lanes[known - self->lanes] : begin_lane(self, of);
    go_on(l, now_ns / JOURNAL_BIN_NS);
    uint32_t count = sample->count < MRT_MAX_CHANNELS ? sample->count : MRT_MAX_CHANNELS;
    if (l->has_last && l->count == count)
        l->moved[l->bin % JOURNAL_BINS] += movement(l, sample, channel);
    memcpy(l->last, sample->value, count * sizeof *l->last);
    l->count = count;
    l->has_last = true;
}

/* ---- read ---- */

float timeline_journal_read(const timeline_journal *self, uint64_t of, int64_t from_ns,
                            int64_t to_ns)
{
    const input_lane *l = find(self, of);
    int64_t from = from_ns / JOURNAL_BIN_NS, to = (to_ns - 1) / JOURNAL_BIN_NS;
    float most = 0.0f;
    if (!l || to_ns <= 0)
        return 0.0f;
    if (from <= l->bin - JOURNAL_BINS)
        from = l->bin - JOURNAL_BINS + 1;
    if (to > l->bin)
        to = l->bin;
    for (int64_t bin = from < 0 ? 0 : from; bin <= to; ++bin)
        most = fmaxf(most, l->moved[bin % JOURNAL_BINS]);
    return sqrtf(fminf(most * SEEN_SHARE, 1.0f));
}

/* ---- kept ---- */

bool timeline_keep_span(int64_t *io_from_ns, int64_t *io_to_ns, int64_t now_ns, int64_t reach_ns)
{
    int64_t from_ns = *io_from_ns < *io_to_ns ? *io_from_ns : *io_to_ns;
    int64_t to_ns = *io_from_ns < *io_to_ns ? *io_to_ns : *io_from_ns;
    *io_from_ns = from_ns < now_ns - reach_ns ? now_ns - reach_ns : from_ns;
    *io_to_ns = to_ns > now_ns - NOW_NS ? now_ns : to_ns;
    return *io_to_ns - *io_from_ns >= SHORTEST_NS;
}
