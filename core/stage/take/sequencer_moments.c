/* Instants that are kept, so that scrubbing need not play from the start. A state that is taken up
 * again goes on with the same bits. */
#include "base/bytes.h"
#include "base/clock.h"
#include "stage/take/sequencer_state.h"

#include <stdlib.h>
#include <string.h>

static const int64_t span_min_ns = NS_PER_S / 2;

/* What opening takes (a file's hash, a process) is done once for all the clips of a performance. */
mrt_result sequencer_open(sequencer *self, int64_t performance, source **out, error *err)
{
    for (uint32_t i = 0; i < self->spare_count; ++i) {
        if (source_performance(self->spare[i]) != performance)
            continue;
        *out = self->spare[i];
        self->spare_count -= 1;
        memmove(&self->spare[i], &self->spare[i + 1],
                (self->spare_count - i) * sizeof *self->spare);
        return MRT_OK;
    }
    return source_open(out, &self->world, performance, err);
}

static void keep_spare(sequencer *self, source *s)
{
    if (self->spare_count == SEQUENCER_SPARES) {
        source_close(self->spare[0]);
        self->spare_count -= 1;
        memmove(&self->spare[0], &self->spare[1], self->spare_count * sizeof *self->spare);
    }
    self->spare[self->spare_count++] = s;
}

void sequencer_close_spares(sequencer *self)
{
    for (uint32_t i = 0; i < self->spare_count; ++i)
        source_close(self->spare[i]);
    self->spare_count = 0;
}

void sequencer_close_play(sequencer *self, play *p)
{
    error why = {""};
    bool has_failed = p->source && source_check(p->source, &why) < 0;
    if (has_failed && !self->failed.text[0])
        self->failed = why;
    if (has_failed)
        source_close(p->source);
    else if (p->source)
        keep_spare(self, p->source);
    *p = (play){0};
}

void sequencer_close_plays(sequencer *self)
{
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot)
        sequencer_close_play(self, &self->play[slot]);
}

mrt_result sequencer_check(const sequencer *self, error *err)
{
    mrt_result result = MRT_OK;
    if (self->failed.text[0])
        return error_set(err, MRT_ERR_FORMAT, "%s", self->failed.text);
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX && result >= 0; ++slot)
        if (self->play[slot].source)
            result = source_check(self->play[slot].source, err);
    return result;
}

bool sequencer_reserve(sequencer *self, size_t size)
{
    if (size <= self->scratch_capacity)
        return true;
    unsigned char *bytes = realloc(self->scratch_bytes, size + size / 2);
    if (!bytes)
        return false;
    self->scratch_bytes = bytes;
    self->scratch_capacity = size + size / 2;
    return true;
}

void sequencer_forget_checkpoints(sequencer *self)
{
    for (size_t i = 0; i < self->moment_count; ++i)
        free(self->moment[i].bytes);
    free(self->moment);
    self->moment = NULL;
    self->moment_count = self->moment_capacity = self->moment_bytes = 0;
    self->moment_span_ns = 0;
    self->is_unkeepable = false;
}

/* ---- bytes ---- */

static bool put_play(sequencer *self, bytes_out *out, uint32_t slot)
{
    const play *p = &self->play[slot];
    size_t size = source_save(p->source, NULL, 0);
    if (size == 0)
        return false;
    bytes_put_u32(out, slot);
    bytes_put_u32(out, p->layer);
    bytes_put_u32(out, p->clip->id);
    bytes_put_u32(out, p->has_smooth);
    if (p->has_smooth) {
        bytes_put(out, &p->smooth_ns, sizeof p->smooth_ns);
        bytes_put(out, &p->smooth, sizeof p->smooth);
    }
    bytes_put_u32(out, (uint32_t)size);
    if (out->data && out->size + size <= out->capacity)
        source_save(p->source, out->data + out->size, size);
    out->size += size;
    return true;
}

/* 0: it cannot be kept. */
static size_t put_all(sequencer *self, unsigned char *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = capacity};
    uint32_t count = 0;
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot)
        count += self->play[slot].source != NULL;
    bytes_put_u32(&out, count);
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot)
        if (self->play[slot].source && !put_play(self, &out, slot))
            return 0;
    size_t size = composer_save(self->composer, NULL, 0);
    if (out.data && out.size + size <= out.capacity)
        composer_save(self->composer, out.data + out.size, size);
    return out.size + size;
}

static const take_clip *find_clip(const take *t, uint32_t lane, uint32_t id)
{
    for (uint32_t j = 0; lane < t->layer_count && j < t->layer[lane].clip_count; ++j)
        if (t->layer[lane].clip[j].id == id)
            return &t->layer[lane].clip[j];
    return NULL;
}

static mrt_result take_play(sequencer *self, bytes_in *in, error *err)
{
    uint32_t slot = bytes_take_u32(in), lane = bytes_take_u32(in);
    const take_clip *clip = find_clip(&self->take, lane, bytes_take_u32(in));
    if (in->failed || slot >= SEQUENCER_PLAYS_MAX || !clip)
        return error_set(err, MRT_ERR_FORMAT, "a kept instant of the take is damaged");
    play *p = &self->play[slot];
    *p = (play){.clip = clip, .layer = lane};
    p->has_smooth = bytes_take_u32(in) != 0;
    if (p->has_smooth) {
        bytes_take(in, &p->smooth_ns, sizeof p->smooth_ns);
        bytes_take(in, &p->smooth, sizeof p->smooth);
    }
    size_t size = bytes_take_u32(in);
    if (in->failed || size > (size_t)(in->end - in->at))
        return error_set(err, MRT_ERR_FORMAT, "a kept instant of the take is damaged");
    mrt_result result = sequencer_open(self, clip->performance, &p->source, err);
    if (result >= 0)
        result = source_load(p->source, in->at, size, err);
    in->at += size;
    return result;
}

static mrt_result take_up(sequencer *self, const moment *m, error *err)
{
    bytes_in in = {.at = m->bytes, .end = m->bytes + m->size};
    sequencer_close_plays(self);
    uint32_t count = bytes_take_u32(&in);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = take_play(self, &in, err);
    if (result >= 0)
        result = composer_load(self->composer, in.at, (size_t)(in.end - in.at), err);
    self->now_ns = m->at_ns;
    self->is_touched = false;
    return result;
}

/* ---- kept ---- */

/* Every second one goes; those to come are twice as far apart. */
static void thin_out(sequencer *self)
{
    size_t kept = 0;
    for (size_t i = 0; i < self->moment_count; ++i) {
        if (i % 2 == 0) {
            self->moment[kept++] = self->moment[i];
            continue;
        }
        self->moment_bytes -= self->moment[i].size;
        free(self->moment[i].bytes);
    }
    self->moment_count = kept;
    self->moment_span_ns *= 2;
}

static size_t count_until(const sequencer *self, int64_t at_ns)
{
    size_t low = 0, high = self->moment_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (self->moment[middle].at_ns <= at_ns)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static mrt_result insert(sequencer *self, size_t at, size_t size, error *err)
{
    if (self->moment_count == self->moment_capacity) {
        size_t capacity = self->moment_capacity * 2 + 16;
        moment *grown = realloc(self->moment, capacity * sizeof *grown);
        if (!grown)
            return error_set(err, MRT_ERR_MEMORY, "no memory for kept instants");
        self->moment = grown;
        self->moment_capacity = capacity;
    }
    unsigned char *bytes = malloc(size);
    if (!bytes)
        return error_set(err, MRT_ERR_MEMORY, "no memory for kept instants");
    put_all(self, bytes, size);
    memmove(self->moment + at + 1, self->moment + at,
            (self->moment_count - at) * sizeof *self->moment);
    self->moment[at] = (moment){self->now_ns, bytes, size};
    self->moment_count += 1;
    self->moment_bytes += size;
    return MRT_OK;
}

mrt_result sequencer_keep_checkpoint(sequencer *self, error *err)
{
    if (self->is_unkeepable || self->is_touched)
        return MRT_OK;
    if (self->moment_span_ns == 0)
        self->moment_span_ns = span_min_ns;
    size_t at = count_until(self, self->now_ns);
    if (at > 0 && self->now_ns - self->moment[at - 1].at_ns < self->moment_span_ns)
        return MRT_OK;
    if (at < self->moment_count && self->moment[at].at_ns - self->now_ns < self->moment_span_ns)
        return MRT_OK;
    size_t size = put_all(self, NULL, 0);
    self->is_unkeepable = size == 0;
    if (size == 0)
        return MRT_OK;
    mrt_result result = insert(self, at, size, err);
    while (self->moment_bytes > self->settings.checkpoint_bytes && self->moment_count > 1)
        thin_out(self);
    return result;
}

/* A take that shows one performance as it was: what was kept while it was recorded serves too. */
static const take_clip *only_clip(const sequencer *self)
{
    const take *t = &self->take;
    const take_layer *l = t->layer;
    if (t->layer_count != 1 || l->clip_count != 1 || l->is_muted || l->own_count > 0 ||
        l->gain < 1.0 || l->gain > 1.0 || l->is_additive)
        return NULL;
    const take_clip *c = l->clip;
    bool is_plain = !c->is_muted && c->warp_count == 1 && c->fade_in_ns == 0 &&
                    c->fade_out_ns == 0 && !(c->gain < 1.0) && !(c->gain > 1.0) &&
                    !(c->smooth_s > 0.0) && c->start_ns + l->offset_ns <= 0;
    return is_plain ? c : NULL;
}

/* MRT_HOLD: nothing that was recorded helps. */
static mrt_result recall(sequencer *self, int64_t at_ns, int64_t better_than_ns, error *err)
{
    const take_clip *clip = only_clip(self);
    if (!clip || !self->play[0].source)
        return MRT_HOLD;
    int64_t offset_ns = self->take.layer[0].offset_ns;
    int64_t then_ns = clip->from_ns + take_warp_to_source(clip, at_ns - offset_ns);
    int64_t least_ns = clip->from_ns + take_warp_to_source(clip, better_than_ns - offset_ns);
    mrt_result result =
        source_recall(self->play[0].source, then_ns + 1, least_ns, self->composer, err);
    if (result != MRT_OK)
        return result;
    self->now_ns =
        take_warp_to_timeline(clip, source_now_ns(self->play[0].source) - clip->from_ns) +
        offset_ns;
    self->is_touched = false;
    return MRT_OK;
}

mrt_result sequencer_go_near(sequencer *self, int64_t at_ns, error *err)
{
    size_t count = count_until(self, at_ns);
    const moment *best = count > 0 ? &self->moment[count - 1] : NULL;
    int64_t from_ns = best ? best->at_ns : 0;
    bool may_go_on = self->now_ns <= at_ns && !self->is_touched;
    if (may_go_on && (self->now_ns >= from_ns || at_ns - self->now_ns < span_min_ns))
        from_ns = self->now_ns;
    else
        may_go_on = false;
    if (at_ns - from_ns > span_min_ns) {
        if (!self->play[0].source) {
            mrt_result started = sequencer_restart(self, err);
            if (started < 0)
                return started;
            may_go_on = false;
        }
        int64_t before_ns = self->play[0].source ? source_now_ns(self->play[0].source) : 0;
        mrt_result result = recall(self, at_ns, from_ns > 0 ? from_ns : 0, err);
        if (result != MRT_HOLD)
            return result;
        if (self->play[0].source && source_now_ns(self->play[0].source) != before_ns)
            may_go_on = false; /* what was kept was damaged */
    }
    if (may_go_on)
        return MRT_OK;
    error ignored = {""};
    if (best && take_up(self, best, &ignored) >= 0)
        return MRT_OK;
    return sequencer_restart(self, err);
}
