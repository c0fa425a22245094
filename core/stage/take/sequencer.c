#include "stage/take/sequencer_state.h"
#include "stage/take/kept_solver.h"
#include "take/own.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t checkpoint_bytes_default = (size_t)256 << 20;

/* ---- the timeline's instants at which clips come and go ---- */

static int compare_times(const void *a, const void *b)
{
    const int64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static mrt_result list_turns(sequencer *self, error *err)
{
    size_t count = 0;
    for (uint32_t i = 0; i < self->take.layer_count; ++i)
        count += (size_t)self->take.layer[i].clip_count * 2;
    free(self->turn);
    self->turn_count = 0;
    self->turn = malloc((count + 1) * sizeof *self->turn);
    if (!self->turn)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the take");
    for (uint32_t i = 0; i < self->take.layer_count; ++i) {
        const take_layer *l = &self->take.layer[i];
        for (uint32_t j = 0; own_layer_is_heard(&self->take, i) && j < l->clip_count; ++j) {
            self->turn[self->turn_count++] = l->clip[j].start_ns + l->offset_ns;
            self->turn[self->turn_count++] = l->clip[j].end_ns + l->offset_ns;
        }
    }
    qsort(self->turn, self->turn_count, sizeof *self->turn, compare_times);
    return MRT_OK;
}

static int64_t next_turn_ns(const sequencer *self)
{
    size_t low = 0, high = self->turn_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (self->turn[middle] <= self->now_ns)
            low = middle + 1;
        else
            high = middle;
    }
    return low < self->turn_count ? self->turn[low] : INT64_MAX;
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

void sequencer_note_text(sequencer *self, const char *text)
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
    free(self->turn);
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
    result = list_turns(self, err);
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
static mrt_result turn(sequencer *self, int64_t at_ns, bool *out_changed, error *err)
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
    int64_t sample_ns, turn_ns = next_turn_ns(self);
    *out_is_sample = false;
    mrt_result result = find_next(self, &p, &sample_ns, err);
    if (result < 0)
        return result;
    if ((turn_ns < sample_ns ? turn_ns : sample_ns) > to_ns || (turn_ns == INT64_MAX && !p))
        return MRT_END;
    if (turn_ns <= sample_ns) { /* a clip that ends does not show what comes then */
        bool is_changed;
        result = turn(self, turn_ns, &is_changed, err);
        self->now_ns = turn_ns;
        if (result >= 0 && is_changed)
            move(self, turn_ns, NULL, 0.0);
        return result;
    }
    layer *l = source_layer(p->source);
    self->sample_count += source_step(p->source, composer_is_near(self->composer, layer_pull(l)));
    self->now_ns = sample_ns;
    *out_is_sample = true;
    move(self, sample_ns, p, layer_frame(l)->dt_s);
    return sequencer_keep_checkpoint(self, err);
}

mrt_result sequencer_restart(sequencer *self, error *err)
{
    bool is_changed;
    sequencer_close_plays(self);
    composer_reset(self->composer);
    self->now_ns = SEQUENCER_BEFORE;
    self->is_touched = false;
    return turn(self, 0, &is_changed, err);
}

static bool is_open(const sequencer *self, int64_t performance)
{
    bool out = false;
    for (uint32_t i = 0; i < self->spare_count; ++i)
        out |= source_performance(self->spare[i]) == performance;
    return out;
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
            if (!is_shown || is_open(self, c->performance) ||
                self->spare_count >= SEQUENCER_PREPARED)
                continue;
            result =
                source_open(&self->spare[self->spare_count], &self->world, c->performance, err);
            if (result < 0)
                return result;
            self->spare_count += 1;
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
    return self->moment_bytes;
}

composer *sequencer_composer(sequencer *self)
{
    return self->composer;
}

const char *sequencer_note(const sequencer *self)
{
    return self->note;
}
