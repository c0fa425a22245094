#include "stage/take/sequencer.h"
#include "base/bytes.h"
#include "base/clock.h"
#include "stage/take/kept_solver.h"
#include "take/own.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SEQUENCER_PLAYS_MAX = PERFORMER_SLOTS - 1,
    SEQUENCER_LIVE_SLOT = PERFORMER_SLOTS - 1,
    SEQUENCER_SPARES = 16,  /* sources kept open */
    SEQUENCER_PREPARED = 8, /* so that none need be closed while a take is played */
    SEQUENCER_BEFORE = -1   /* now_ns before the first instant */
};

typedef struct play { /* a clip that is shown now; its index is its slot in the composer */
    const take_clip *clip;
    uint32_t layer; /* index */
    source *source; /* NULL: free */
    bool is_wanted; /* within cross_boundary() */
    bool has_smooth;
    int64_t smooth_ns;
    mrt_pull smooth;
} play;

typedef struct checkpoint { /* what is kept of an instant */
    int64_t at_ns;
    unsigned char *bytes;
    size_t size;
} checkpoint;

struct sequencer {
    sequencer_settings settings;
    source_world world;
    take take;
    composer *composer, *scratch;
    play play[SEQUENCER_PLAYS_MAX];
    source *spare[SEQUENCER_SPARES]; /* open, of no clip: the oldest first */
    uint32_t spare_count;
    int64_t *boundary; /* ascending: when clips of heard layers start and end */
    size_t boundary_count;
    uint8_t *owned; /* layer_count rows */
    size_t owned_row;
    int64_t now_ns;
    uint64_t sample_count;
    char note[1024];
    error failed; /* of a mapping whose clip has ended */

    sequencer_live live;
    double live_weight;
    bool is_live_fresh;
    bool is_touched; /* by somebody live: the face is not the take's alone */

    checkpoint *checkpoint; /* by at_ns */
    size_t checkpoint_count, checkpoint_capacity, checkpoint_bytes;
    int64_t checkpoint_span_ns; /* at least so far apart; 0: not chosen yet */
    bool is_unkeepable;         /* some mapping cannot say its state */
    unsigned char *scratch_bytes;
    size_t scratch_capacity;
};

/* ---- sequencer.c ---- */
/* Before the first instant, its clips ready. */
CHECKED static mrt_result sequencer_restart(sequencer *self, error *err);
static void sequencer_note_text(sequencer *self, const char *text);

/* ---- sequencer_moments.c ---- */
/* One that is open already, or a new one; wherever it is: to be sought or loaded. */
CHECKED static mrt_result sequencer_open(sequencer *self, int64_t performance, source **out,
                                         error *err);
static void sequencer_close_play(sequencer *self, play *p); /* its source stays open for a while */
static void sequencer_close_spares(sequencer *self);
static void sequencer_close_plays(sequencer *self);
static bool sequencer_reserve(sequencer *self, size_t size); /* scratch_bytes; false: no memory */
static void sequencer_forget_checkpoints(sequencer *self);
/* Now and then: after a sample. */
CHECKED static mrt_result sequencer_keep_checkpoint(sequencer *self, error *err);
/* To the last instant at or before at_ns from which playing on is quickest. */
CHECKED static mrt_result sequencer_go_near(sequencer *self, int64_t at_ns, error *err);

/* Instants that are kept, so that scrubbing need not play from the start. A state that is taken up
 * again goes on with the same bits. */

static const int64_t span_min_ns = NS_PER_S / 2;

/* What opening takes (a file's hash, a process) is done once for all the clips of a performance. */
static mrt_result sequencer_open(sequencer *self, int64_t performance, source **out, error *err)
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

static void sequencer_close_spares(sequencer *self)
{
    for (uint32_t i = 0; i < self->spare_count; ++i)
        source_close(self->spare[i]);
    self->spare_count = 0;
}

static void sequencer_close_play(sequencer *self, play *p)
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

static void sequencer_close_plays(sequencer *self)
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

static bool sequencer_reserve(sequencer *self, size_t size)
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

static void sequencer_forget_checkpoints(sequencer *self)
{
    for (size_t i = 0; i < self->checkpoint_count; ++i)
        free(self->checkpoint[i].bytes);
    free(self->checkpoint);
    self->checkpoint = NULL;
    self->checkpoint_count = self->checkpoint_capacity = self->checkpoint_bytes = 0;
    self->checkpoint_span_ns = 0;
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

static mrt_result take_up(sequencer *self, const checkpoint *m, error *err)
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
    for (size_t i = 0; i < self->checkpoint_count; ++i) {
        if (i % 2 == 0) {
            self->checkpoint[kept++] = self->checkpoint[i];
            continue;
        }
        self->checkpoint_bytes -= self->checkpoint[i].size;
        free(self->checkpoint[i].bytes);
    }
    self->checkpoint_count = kept;
    self->checkpoint_span_ns *= 2;
}

static size_t count_until(const sequencer *self, int64_t at_ns)
{
    size_t low = 0, high = self->checkpoint_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (self->checkpoint[middle].at_ns <= at_ns)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static mrt_result insert(sequencer *self, size_t at, size_t size, error *err)
{
    if (self->checkpoint_count == self->checkpoint_capacity) {
        size_t capacity = self->checkpoint_capacity * 2 + 16;
        checkpoint *grown = realloc(self->checkpoint, capacity * sizeof *grown);
        if (!grown)
            return error_set(err, MRT_ERR_MEMORY, "no memory for kept instants");
        self->checkpoint = grown;
        self->checkpoint_capacity = capacity;
    }
    unsigned char *bytes = malloc(size);
    if (!bytes)
        return error_set(err, MRT_ERR_MEMORY, "no memory for kept instants");
    put_all(self, bytes, size);
    memmove(self->checkpoint + at + 1, self->checkpoint + at,
            (self->checkpoint_count - at) * sizeof *self->checkpoint);
    self->checkpoint[at] = (checkpoint){self->now_ns, bytes, size};
    self->checkpoint_count += 1;
    self->checkpoint_bytes += size;
    return MRT_OK;
}

static mrt_result sequencer_keep_checkpoint(sequencer *self, error *err)
{
    if (self->is_unkeepable || self->is_touched)
        return MRT_OK;
    if (self->checkpoint_span_ns == 0)
        self->checkpoint_span_ns = span_min_ns;
    size_t at = count_until(self, self->now_ns);
    if (at > 0 && self->now_ns - self->checkpoint[at - 1].at_ns < self->checkpoint_span_ns)
        return MRT_OK;
    if (at < self->checkpoint_count &&
        self->checkpoint[at].at_ns - self->now_ns < self->checkpoint_span_ns)
        return MRT_OK;
    size_t size = put_all(self, NULL, 0);
    self->is_unkeepable = size == 0;
    if (size == 0)
        return MRT_OK;
    mrt_result result = insert(self, at, size, err);
    while (self->checkpoint_bytes > self->settings.checkpoint_bytes && self->checkpoint_count > 1)
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

static mrt_result sequencer_go_near(sequencer *self, int64_t at_ns, error *err)
{
    size_t count = count_until(self, at_ns);
    const checkpoint *best = count > 0 ? &self->checkpoint[count - 1] : NULL;
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

static const size_t checkpoint_bytes_default = (size_t)256 << 20;

/* ---- the timeline's instants at which clips come and go ---- */

static int compare_times(const void *a, const void *b)
{
    const int64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static mrt_result list_boundaries(sequencer *self, error *err)
{
    size_t count = 0;
    for (uint32_t i = 0; i < self->take.layer_count; ++i)
        count += (size_t)self->take.layer[i].clip_count * 2;
    free(self->boundary);
    self->boundary_count = 0;
    self->boundary = malloc((count + 1) * sizeof *self->boundary);
    if (!self->boundary)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the take");
    for (uint32_t i = 0; i < self->take.layer_count; ++i) {
        const take_layer *l = &self->take.layer[i];
        for (uint32_t j = 0; own_layer_is_heard(&self->take, i) && j < l->clip_count; ++j) {
            self->boundary[self->boundary_count++] = l->clip[j].start_ns + l->offset_ns;
            self->boundary[self->boundary_count++] = l->clip[j].end_ns + l->offset_ns;
        }
    }
    qsort(self->boundary, self->boundary_count, sizeof *self->boundary, compare_times);
    return MRT_OK;
}

static int64_t next_boundary_ns(const sequencer *self)
{
    size_t low = 0, high = self->boundary_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (self->boundary[middle] <= self->now_ns)
            low = middle + 1;
        else
            high = middle;
    }
    return low < self->boundary_count ? self->boundary[low] : INT64_MAX;
}

/* ---- what a layer may move ---- */

void sequencer_mark_owned(const composer *shown, const take_layer *l, uint8_t *out)
{
    const mrt_face *about = composer_about(shown);
    for (uint32_t i = 0; i < about->contact_count; ++i)
        out[i] = own_layer_owns(l, about->contacts[i].name);
    for (uint32_t i = 0; i < about->dof_count; ++i)
        out[about->contact_count + i] = own_layer_owns(l, about->dofs[i].name);
    out[about->contact_count + about->dof_count] = l->own_count == 0; /* free points */
}

static mrt_result list_owned(sequencer *self, error *err)
{
    const mrt_face *about = composer_about(self->composer);
    size_t row = about->contact_count + about->dof_count + 1;
    free(self->owned);
    self->owned = calloc(row, (size_t)self->take.layer_count + 1);
    self->owned_row = row;
    if (!self->owned)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the take");
    for (uint32_t i = 0; i < self->take.layer_count; ++i)
        sequencer_mark_owned(self->composer, &self->take.layer[i], self->owned + i * row);
    return MRT_OK;
}

/* ---- made and unmade ---- */

static void sequencer_note_text(sequencer *self, const char *text)
{
    size_t used = strlen(self->note);
    if (text[0] && !strstr(self->note, text) && used + strlen(text) + 2 < sizeof self->note)
        snprintf(self->note + used, sizeof self->note - used, "%s\n", text);
}

mrt_result sequencer_create(sequencer **out, const sequencer_settings *settings, const take *t,
                            error *err)
{
    *out = NULL;
    sequencer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    self->settings = *settings;
    if (self->settings.checkpoint_bytes == 0)
        self->settings.checkpoint_bytes = checkpoint_bytes_default;
    self->now_ns = SEQUENCER_BEFORE;
    self->settings.solver = NULL;
    const csrbf_settings solver =
        settings->solver ? *settings->solver
                         : kept_solver_for(settings->show, settings->face, settings->log);
    mrt_result result = composer_create(&self->composer, settings->face, &solver, err);
    if (result >= 0)
        result = composer_create(&self->scratch, settings->face, &solver, err);
    self->world = (source_world){settings->show, settings->plugins, settings->log, self->scratch};
    if (result >= 0)
        result = sequencer_set_take(self, t, err);
    if (result < 0) {
        sequencer_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void sequencer_destroy(sequencer *self)
{
    if (!self)
        return;
    sequencer_close_plays(self);
    sequencer_close_spares(self);
    sequencer_forget_checkpoints(self);
    composer_destroy(self->composer);
    composer_destroy(self->scratch);
    take_finish(&self->take);
    free(self->boundary);
    free(self->owned);
    free(self->scratch_bytes);
    free(self);
}

mrt_result sequencer_set_take(sequencer *self, const take *t, error *err)
{
    take fresh = {0};
    mrt_result result = take_copy(&fresh, t, err);
    if (result < 0)
        return result;
    int64_t at_ns = self->now_ns;
    sequencer_close_plays(self);
    sequencer_close_spares(self); /* performances may have become longer */
    sequencer_forget_checkpoints(self);
    take_finish(&self->take);
    self->take = fresh;
    self->note[0] = '\0';
    result = list_boundaries(self, err);
    if (result >= 0)
        result = list_owned(self, err);
    if (result >= 0)
        result = sequencer_restart(self, err);
    return result >= 0 && at_ns >= 0 ? sequencer_seek(self, at_ns, err) : result;
}

/* ---- clips come and go ---- */

static play *find_play(sequencer *self, uint32_t lane, uint32_t clip)
{
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot) {
        play *p = &self->play[slot];
        if (p->source && p->layer == lane && p->clip->id == clip)
            return p;
    }
    return NULL;
}

static int64_t source_show_ns(const take_clip *clip, int64_t source_ns)
{
    return clip->from_ns + source_ns;
}

/* A clip that goes on where another of its layer ended, as after a split, takes over from it. */
static play *find_predecessor(sequencer *self, uint32_t lane, const take_clip *clip,
                              int64_t show_ns)
{
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot) {
        play *p = &self->play[slot];
        if (!p->source || p->layer != lane || p->clip->performance != clip->performance ||
            p->clip->end_ns != clip->start_ns)
            continue;
        int64_t end_ns = source_show_ns(p->clip, take_warp_to_source(p->clip, p->clip->end_ns));
        if (end_ns == show_ns)
            return p;
    }
    return NULL;
}

static play *free_play(sequencer *self)
{
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot)
        if (!self->play[slot].source)
            return &self->play[slot];
    return NULL;
}

/* The very first clip of the lowest layer brings the shape along that its performance had. */
static bool brings_shape(const sequencer *self, const play *p)
{
    return self->now_ns == SEQUENCER_BEFORE && p == &self->play[0];
}

static mrt_result bring_shape(sequencer *self, error *err)
{
    size_t size = composer_save(self->scratch, NULL, 0);
    if (!sequencer_reserve(self, size))
        return error_set(err, MRT_ERR_MEMORY, "no memory for the shape");
    composer_save(self->scratch, self->scratch_bytes, size);
    return composer_load(self->composer, self->scratch_bytes, size, err);
}

static mrt_result start_play(sequencer *self, uint32_t lane, const take_clip *clip,
                             int64_t source_ns, error *err)
{
    int64_t show_ns = source_show_ns(clip, source_ns);
    play *p = find_predecessor(self, lane, clip, show_ns);
    if (p) {
        p->clip = clip;
        p->is_wanted = true;
        return MRT_OK;
    }
    p = free_play(self);
    if (!p) {
        sequencer_note_text(self, "more clips at an instant than can be played: some are left out");
        return MRT_OK;
    }
    *p = (play){.clip = clip, .layer = lane, .is_wanted = true};
    mrt_result result = sequencer_open(self, clip->performance, &p->source, err);
    if (result >= 0)
        result = source_seek(p->source, show_ns, err);
    if (result >= 0 && brings_shape(self, p))
        result = bring_shape(self, err);
    if (result >= 0)
        sequencer_note_text(self, source_note(p->source));
    return result;
}

/* The clips of this instant play, and no others. True in out_changed: the face is concerned. */
static mrt_result cross_boundary(sequencer *self, int64_t at_ns, bool *out_changed, error *err)
{
    mrt_result result = MRT_OK;
    uint32_t fresh_count = 0;
    *out_changed = false;
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot)
        self->play[slot].is_wanted = false;
    for (uint32_t i = 0; i < self->take.layer_count && result >= 0; ++i) {
        take_voice voice[2];
        uint32_t count =
            own_layer_is_heard(&self->take, i) ? take_at(voice, &self->take.layer[i], at_ns) : 0;
        for (uint32_t j = 0; j < count && result >= 0; ++j) {
            play *p = find_play(self, i, voice[j].clip->id);
            if (p) {
                p->is_wanted = true;
                continue;
            }
            result = start_play(self, i, voice[j].clip, voice[j].source_ns, err);
            fresh_count += 1;
        }
    }
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot) {
        play *p = &self->play[slot];
        if (p->source && !p->is_wanted) {
            sequencer_close_play(self, p);
            *out_changed = true;
        } else if (p->source && fresh_count > 0 && self->now_ns != SEQUENCER_BEFORE) {
            *out_changed |= layer_pull(source_layer(p->source))->mode != MRT_IDLE;
        }
    }
    return result;
}

/* ---- the face of an instant ---- */

/* Eases the ends of the vectors and the degrees of freedom towards what the mapping says. */
static const mrt_pull *smoothed(play *p, const mrt_pull *pull, int64_t at_ns)
{
    bool goes_on = p->has_smooth && p->smooth.count == pull->count &&
                   p->smooth.anchor == pull->anchor && p->smooth.mode == pull->mode;
    if (!(p->clip->smooth_s > 0.0) || pull->mode != MRT_ANCHORED)
        return pull;
    double dt_s = (double)(at_ns - p->smooth_ns) * 1e-9;
    double share = dt_s > 0.0 ? dt_s / (p->clip->smooth_s + dt_s) : 0.0;
    mrt_pull before = p->smooth;
    p->smooth = *pull;
    p->smooth_ns = at_ns;
    p->has_smooth = true;
    for (uint32_t i = 0; goes_on && i < pull->count; ++i) {
        mrt_vec3 *to = &p->smooth.vector[i].end;
        const mrt_vec3 *from = &before.vector[i].end;
        to->x = (float)((double)from->x + share * ((double)to->x - (double)from->x));
        to->y = (float)((double)from->y + share * ((double)to->y - (double)from->y));
        to->z = (float)((double)from->z + share * ((double)to->z - (double)from->z));
    }
    for (uint32_t i = 0; goes_on && i < MRT_MAX_DOFS; ++i)
        if (!isnan(before.dof[i]) && !isnan(pull->dof[i]))
            p->smooth.dof[i] = (float)((double)before.dof[i] +
                                       share * ((double)pull->dof[i] - (double)before.dof[i]));
    return &p->smooth;
}

static uint32_t list_parts(sequencer *self, int64_t at_ns, const play *fresh,
                           composer_part out[COMPOSER_PARTS_MAX])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < self->take.layer_count; ++i) {
        const take_layer *l = &self->take.layer[i];
        take_voice voice[2];
        uint32_t voices = take_at(voice, l, at_ns);
        for (uint32_t j = 0; j < voices; ++j) {
            play *p = find_play(self, i, voice[j].clip->id);
            if (!p || count + PERFORMER_PARTS_MAX > COMPOSER_PARTS_MAX)
                continue;
            const composer_part whole = {
                .slot = (uint32_t)(p - self->play),
                .layer = i,
                .is_additive = l->is_additive,
                .is_fresh = p == fresh,
                .weight = voice[j].weight,
                .gain = l->gain * p->clip->gain,
                .pull = smoothed(p, layer_pull(source_layer(p->source)), at_ns),
                .owns = l->own_count > 0 ? self->owned + i * self->owned_row : NULL};
            count += performer_parts(source_layer(p->source), &whole, out + count);
        }
    }
    if (self->live.layer && self->live_weight > 0.0 &&
        count + PERFORMER_PARTS_MAX <= COMPOSER_PARTS_MAX) {
        const composer_part whole = {.slot = SEQUENCER_LIVE_SLOT,
                                     .layer = self->take.layer_count,
                                     .is_additive = self->live.is_additive,
                                     .is_fresh = self->is_live_fresh,
                                     .weight = self->live_weight,
                                     .gain = 1.0,
                                     .pull = layer_pull(self->live.layer),
                                     .owns = self->live.owns};
        count += performer_parts(self->live.layer, &whole, out + count);
    }
    return count;
}

static void move(sequencer *self, int64_t at_ns, const play *fresh, double dt_s)
{
    composer_part part[COMPOSER_PARTS_MAX];
    uint32_t count = list_parts(self, at_ns, fresh, part);
    composer_move(self->composer, part, count, dt_s);
}

/* ---- time goes on ---- */

/* Timeline time of the next sample of a clip that plays; INT64_MAX: none before its end. */
static mrt_result next_sample_ns(const sequencer *self, const play *p, int64_t *out_ns, error *err)
{
    const take_clip *clip = p->clip;
    int64_t show_ns;
    mrt_result result = source_next_ns(p->source, &show_ns, err);
    *out_ns = INT64_MAX;
    if (result < 0 || show_ns == INT64_MAX || show_ns > clip->to_ns)
        return result;
    int64_t at_ns = take_warp_to_timeline(clip, show_ns - clip->from_ns);
    if (at_ns >= clip->end_ns)
        return result;
    at_ns += self->take.layer[p->layer].offset_ns;
    *out_ns = at_ns > self->now_ns ? at_ns : self->now_ns;
    return result;
}

static mrt_result find_next(sequencer *self, play **out_play, int64_t *out_ns, error *err)
{
    *out_play = NULL;
    *out_ns = INT64_MAX;
    for (uint32_t slot = 0; slot < SEQUENCER_PLAYS_MAX; ++slot) {
        play *p = &self->play[slot];
        int64_t at_ns;
        if (!p->source)
            continue;
        mrt_result result = next_sample_ns(self, p, &at_ns, err);
        if (result < 0)
            return result;
        if (at_ns < *out_ns) {
            *out_ns = at_ns;
            *out_play = p;
        }
    }
    return MRT_OK;
}

/* The next thing that happens, if it is not after to_ns. MRT_END: nothing does. */
static mrt_result happen(sequencer *self, int64_t to_ns, bool *out_is_sample, error *err)
{
    play *p;
    int64_t sample_ns, boundary_ns = next_boundary_ns(self);
    *out_is_sample = false;
    mrt_result result = find_next(self, &p, &sample_ns, err);
    if (result < 0)
        return result;
    if ((boundary_ns < sample_ns ? boundary_ns : sample_ns) > to_ns ||
        (boundary_ns == INT64_MAX && !p))
        return MRT_END;
    if (boundary_ns <= sample_ns) { /* a clip that ends does not show what comes then */
        bool is_changed;
        result = cross_boundary(self, boundary_ns, &is_changed, err);
        self->now_ns = boundary_ns;
        if (result >= 0 && is_changed)
            move(self, boundary_ns, NULL, 0.0);
        return result;
    }
    layer *l = source_layer(p->source);
    self->sample_count += source_step(p->source, composer_is_near(self->composer, layer_pull(l)));
    self->now_ns = sample_ns;
    *out_is_sample = true;
    move(self, sample_ns, p, layer_frame(l)->dt_s);
    return sequencer_keep_checkpoint(self, err);
}

static mrt_result sequencer_restart(sequencer *self, error *err)
{
    bool is_changed;
    sequencer_close_plays(self);
    composer_reset(self->composer);
    self->now_ns = SEQUENCER_BEFORE;
    self->is_touched = false;
    return cross_boundary(self, 0, &is_changed, err);
}

/* The source that a clip will perform with; NULL: there is no room for more. */
static mrt_result open_for(sequencer *self, uint32_t lane, const take_clip *clip, source **out,
                           error *err)
{
    play *p = find_play(self, lane, clip->id);
    *out = p ? p->source : NULL;
    for (uint32_t i = 0; i < self->spare_count && !*out; ++i)
        if (source_performance(self->spare[i]) == clip->performance)
            *out = self->spare[i];
    if (*out || self->spare_count >= SEQUENCER_PREPARED)
        return MRT_OK;
    mrt_result result = source_open(out, &self->world, clip->performance, err);
    if (result >= 0)
        self->spare[self->spare_count++] = *out;
    return result;
}

static mrt_result prepare_clip(sequencer *self, uint32_t lane, const take_clip *clip,
                               int64_t from_ns, int64_t to_ns, error *err)
{
    source *of;
    mrt_result result = open_for(self, lane, clip, &of, err);
    if (result < 0 || !of)
        return result;
    int64_t first_ns = from_ns > clip->start_ns ? from_ns : clip->start_ns;
    int64_t last_ns = to_ns < clip->end_ns ? to_ns : clip->end_ns;
    return source_read_ahead(of, source_show_ns(clip, take_warp_to_source(clip, first_ns)),
                             source_show_ns(clip, take_warp_to_source(clip, last_ns)) + NS_PER_S,
                             err);
}

mrt_result sequencer_prepare(sequencer *self, int64_t from_ns, int64_t to_ns, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->take.layer_count; ++i) {
        const take_layer *l = &self->take.layer[i];
        for (uint32_t j = 0; own_layer_is_heard(&self->take, i) && j < l->clip_count; ++j) {
            const take_clip *c = &l->clip[j];
            bool is_shown = !c->is_muted && c->start_ns + l->offset_ns < to_ns &&
                            c->end_ns + l->offset_ns > from_ns;
            if (is_shown && result >= 0)
                result =
                    prepare_clip(self, i, c, from_ns - l->offset_ns, to_ns - l->offset_ns, err);
        }
    }
    return result;
}

mrt_result sequencer_play_to(sequencer *self, int64_t at_ns, error *err)
{
    bool is_sample;
    if (at_ns < self->now_ns)
        return sequencer_seek(self, at_ns, err);
    mrt_result result = MRT_OK;
    while (result == MRT_OK)
        result = happen(self, at_ns, &is_sample, err);
    if (result == MRT_END && at_ns > self->now_ns)
        self->now_ns = at_ns;
    return result < 0 ? result : MRT_OK;
}

mrt_result sequencer_step(sequencer *self, error *err)
{
    bool is_sample = false;
    mrt_result result = MRT_OK;
    while (result == MRT_OK && !is_sample)
        result = happen(self, self->take.duration_ns, &is_sample, err);
    return result;
}

mrt_result sequencer_seek(sequencer *self, int64_t at_ns, error *err)
{
    mrt_result result = sequencer_go_near(self, at_ns, err);
    return result < 0 ? result : sequencer_play_to(self, at_ns, err);
}

/* ---- live ---- */

void sequencer_set_live(sequencer *self, const sequencer_live *live)
{
    self->live = *live;
    self->live_weight = 1.0;
}

void sequencer_weigh_live(sequencer *self, double weight)
{
    self->live_weight = weight;
}

void sequencer_live_step(sequencer *self, const sample_step *s)
{
    layer *live = self->live.layer;
    if (!live)
        return;
    layer_step(live, s, composer_is_near(self->composer, layer_pull(live)));
    self->is_live_fresh = self->is_touched = true;
    move(self, self->now_ns, NULL, layer_frame(live)->dt_s);
    self->is_live_fresh = false;
}

/* ---- what others see ---- */

int64_t sequencer_now_ns(const sequencer *self)
{
    return self->now_ns;
}

uint64_t sequencer_sample_count(const sequencer *self)
{
    return self->sample_count;
}

size_t sequencer_kept_bytes(const sequencer *self)
{
    return self->checkpoint_bytes;
}

composer *sequencer_composer(sequencer *self)
{
    return self->composer;
}

const char *sequencer_note(const sequencer *self)
{
    return self->note;
}
