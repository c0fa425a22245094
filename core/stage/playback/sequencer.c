#include "stage/playback/sequencer.h"
#include "base/bytes.h"
#include "base/clock.h"
#include "base/trace.h"
#include "stage/playback/kept_solver.h"
#include "show/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PLAYS_MAX = PERFORMER_VOICES_MAX - 1,  /* the index of a play is its voice */
    LIVE_VOICE = PERFORMER_VOICES_MAX - 1, /* the live performer of an overdub */
    SPARES_KEPT = 16,                      /* replays that stay open */
    OPEN_MAX = 64,                         /* open replays in total, while an overdub is prepared */
    SOURCES_MAX = PLAYS_MAX * TAKE_TRACKS_MAX,
    BEFORE_ALL = -1 /* value of now_ns before the first instant */
};

static const size_t checkpoint_bytes_default = (size_t)256 << 20;
static const int64_t span_min_ns = NS_PER_S / 2;
/* Timeout for all isolated mappings together, see replay_answer_ahead. */
static const int64_t answers_patience_ns = 30 * NS_PER_S;
static const char unprepared[] = "too many clips to open together: some clips are not played";

typedef struct play { /* a clip that plays now */
    const sequencer *of;
    const take_clip *clip;
    uint32_t lane;  /* index of its layer */
    replay *replay; /* NULL: this play is unused */
    bool is_wanted; /* used by cross_boundary */
} play;

typedef struct checkpoint { /* saved state at one instant */
    int64_t at_ns;
    unsigned char *bytes;
    size_t size;
} checkpoint;

struct sequencer {
    sequencer_settings settings;
    replay_world world;
    take take;
    performer *performer, *scratch;
    stage_frame frame;   /* the step that plays */
    scheduler scheduler; /* tracks of all plays, due in timeline time */
    scheduler_entry *entry;
    play play[PLAYS_MAX];
    replay *spare[OPEN_MAX]; /* open replays that no clip uses, oldest first */
    uint32_t spare_count;
    int64_t *boundary; /* ascending: starts and ends of the clips of audible layers */
    size_t boundary_count;
    uint8_t *owned; /* layer_count rows */
    size_t owned_row;
    int64_t now_ns;
    uint64_t sample_count;
    char note[1024];
    error failed;     /* of a mapping whose clip has ended */
    bool is_touched;  /* a live layer has moved the face, or the replays lost their state: do not
                         continue from here */
    bool is_prepared; /* files and processes must not be opened, read or closed */
    bool is_ahead;    /* the replays play from memory */
    checkpoint start; /* state at the start of the prepared span; size 0: none */

    checkpoint *checkpoint; /* sorted by at_ns */
    size_t checkpoint_count, checkpoint_capacity, checkpoint_bytes;
    int64_t checkpoint_span_ns; /* minimum distance between checkpoints; 0: not chosen yet */
    bool is_unkeepable;         /* a mapping cannot save its state */
    unsigned char *scratch_bytes;
    size_t scratch_capacity;
};

static void add_note(sequencer *self, const char *text)
{
    size_t used = strlen(self->note);
    if (text[0] && !strstr(self->note, text) && used + strlen(text) + 2 < sizeof self->note)
        snprintf(self->note + used, sizeof self->note - used, "%s\n", text);
}

static bool reserve(sequencer *self, size_t size) /* of scratch_bytes; false: out of memory */
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

/* ---- open and close replays ---- */

static replay *take_spare(sequencer *self, uint32_t index)
{
    replay *out = self->spare[index];
    self->spare_count -= 1;
    memmove(&self->spare[index], &self->spare[index + 1],
            (self->spare_count - index) * sizeof *self->spare);
    return out;
}

/* Returns a spare replay of the performance or opens a new one. The caller must then seek or load
 * it. The cost of opening (hash of a file, start of a process) is paid once for all clips of a
 * performance. MRT_HOLD: no replay was prepared. */
static mrt_result open_replay(sequencer *self, const take_clip *clip, replay **out, error *err)
{
    for (uint32_t i = 0; i < self->spare_count; ++i)
        if (replay_is_of(self->spare[i], clip)) {
            *out = take_spare(self, i);
            return MRT_OK;
        }
    *out = NULL;
    return self->is_prepared ? MRT_HOLD
                             : replay_open(out, &self->world, clip->performance, clip->part, err);
}

static void keep_spare(sequencer *self, replay *r)
{
    error ignored = {""};
    self->spare[self->spare_count++] = r;
    if (self->is_prepared)
        return;
    if (replay_check(r, &ignored) < 0) /* its process has failed: start another one next time */
        replay_close(take_spare(self, self->spare_count - 1));
    while (self->spare_count > SPARES_KEPT)
        replay_close(take_spare(self, 0));
}

static void close_spares(sequencer *self)
{
    for (uint32_t i = 0; i < self->spare_count; ++i)
        replay_close(self->spare[i]);
    self->spare_count = 0;
}

static void close_play(sequencer *self, play *p) /* its replay stays open as a spare */
{
    error why = {""};
    if (p->replay && replay_check(p->replay, &why) < 0 && !self->failed.text[0])
        self->failed = why;
    if (p->replay)
        keep_spare(self, p->replay);
    *p = (play){0};
    self->performer->voice[(uint32_t)(p - self->play)] = (performer_voice){0};
}

static void close_plays(sequencer *self)
{
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot)
        close_play(self, &self->play[slot]);
}

static uint32_t list_open(const sequencer *self, replay *out[OPEN_MAX + PLAYS_MAX])
{
    uint32_t count = 0;
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot)
        if (self->play[slot].replay)
            out[count++] = self->play[slot].replay;
    for (uint32_t i = 0; i < self->spare_count; ++i)
        out[count++] = self->spare[i];
    return count;
}

mrt_result sequencer_check(const sequencer *self, error *err)
{
    mrt_result result = MRT_OK;
    if (self->failed.text[0])
        return error_set(err, MRT_ERR_FORMAT, "%s", self->failed.text);
    for (uint32_t slot = 0; slot < PLAYS_MAX && result >= 0; ++slot)
        if (self->play[slot].replay)
            result = replay_check(self->play[slot].replay, err);
    return result;
}

/* ---- schedule and voices ---- */

/* Returns the time on the timeline at which a sample of the clip's performance is due. */
static int64_t due_ns(void *clock, int64_t show_ns)
{
    const play *p = clock;
    const take_clip *clip = p->clip;
    if (show_ns > clip->to_ns)
        return INT64_MAX;
    int64_t at_ns = take_warp_to_timeline(clip, show_ns - clip->from_ns);
    if (at_ns >= clip->end_ns)
        return INT64_MAX;
    at_ns += p->of->take.layer[p->lane].offset_ns;
    return at_ns > p->of->now_ns ? at_ns : p->of->now_ns;
}

static void schedule_plays(sequencer *self)
{
    scheduler_clear(&self->scheduler);
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot) {
        const sample_source as = {.voice = slot, .due_ns = due_ns, .clock = &self->play[slot]};
        if (self->play[slot].replay)
            replay_schedule(self->play[slot].replay, &self->scheduler, &as);
    }
}

/* Sets the voice of a play. weigh_voices decides whether it is seen. The smoothing of the previous
 * play is discarded. */
static void cast_play(sequencer *self, const play *p)
{
    self->performer->voice[(uint32_t)(p - self->play)].layer = replay_layer(p->replay);
}

static play *find_play(sequencer *self, uint32_t lane, uint32_t clip)
{
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot) {
        play *p = &self->play[slot];
        if (p->replay && p->lane == lane && p->clip->id == clip)
            return p;
    }
    return NULL;
}

/* Sets the weight of each voice at an instant. */
static void weigh_voices(sequencer *self, int64_t at_ns)
{
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot)
        self->performer->voice[slot].is_seen = false;
    for (uint32_t i = 0; i < self->take.layer_count; ++i) {
        const take_layer *l = &self->take.layer[i];
        take_voice heard[2];
        uint32_t count = take_at(heard, l, at_ns);
        for (uint32_t j = 0; j < count; ++j) {
            const play *p = find_play(self, i, heard[j].clip->id);
            if (!p)
                continue;
            performer_voice *v = &self->performer->voice[(uint32_t)(p - self->play)];
            v->is_seen = true;
            v->lane = i;
            v->rank = j;
            v->is_additive = l->is_additive;
            v->weight = heard[j].weight;
            v->gain = l->gain * p->clip->gain;
            v->smooth_s = p->clip->smooth_s;
            v->owns = l->own_count > 0 ? self->owned + i * self->owned_row : NULL;
        }
    }
    performer_voice *live = &self->performer->voice[LIVE_VOICE];
    live->is_seen = live->weight > 0.0;
    live->lane = self->take.layer_count;
}

/* ---- start and end of clips ---- */

static int64_t show_time_ns(const take_clip *clip, int64_t source_ns)
{
    return clip->from_ns + source_ns;
}

/* Returns the play that a clip continues: the same performance, without a gap, as after a split. */
static play *find_predecessor(sequencer *self, uint32_t lane, const take_clip *clip,
                              int64_t show_ns)
{
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot) {
        play *p = &self->play[slot];
        if (!p->replay || p->lane != lane || !replay_is_of(p->replay, clip) ||
            p->clip->end_ns != clip->start_ns)
            continue;
        int64_t end_ns = show_time_ns(p->clip, take_warp_to_source(p->clip, p->clip->end_ns));
        if (end_ns == show_ns)
            return p;
    }
    return NULL;
}

static play *free_play(sequencer *self)
{
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot)
        if (!self->play[slot].replay)
            return &self->play[slot];
    return NULL;
}

/* At the start of a take, the lowest clip also restores the face shape that its performance started
 * with. */
static bool begins_with_its_shape(const sequencer *self, const play *p)
{
    return self->now_ns == BEFORE_ALL && p == &self->play[0];
}

static mrt_result begin_with_its_shape(sequencer *self, int64_t show_ns, error *err)
{
    composer *then = self->scratch->composer;
    size_t size = composer_save(then, NULL, 0);
    if (!reserve(self, size))
        return error_set(err, MRT_ERR_MEMORY, "no memory for the face shape");
    composer_save(then, self->scratch_bytes, size);
    mrt_result result = composer_load(self->performer->composer, self->scratch_bytes, size, err);
    composer_shift_time(self->performer->composer, -show_ns);
    return result;
}

/* What the parts of a performance that have layers of their own moved before the take also swings
 * loose parts. So the swing at the start is that of the whole performance. */
static mrt_result begin_with_its_swing(sequencer *self, const take_clip *clip, int64_t show_ns,
                                       error *err)
{
    face *shown = composer_face(self->performer->composer);
    take_clip whole = *clip;
    replay *all;
    whole.part = TAKE_WHOLE;
    if (clip->part != TAKE_HANDS || !face_has_springs(shown))
        return MRT_OK;
    mrt_result result = open_replay(self, &whole, &all, err);
    if (result == MRT_HOLD)
        return MRT_OK; /* not prepared: the swing of the hands is a good start, too */
    if (result >= 0)
        result = replay_seek(all, show_ns, err);
    if (result >= 0) {
        face_copy_swing(shown, composer_face(self->scratch->composer));
        composer_shift_time(self->performer->composer, -show_ns);
    }
    replay_close(all);
    return result;
}

static mrt_result start_play(sequencer *self, uint32_t lane, const take_clip *clip,
                             int64_t source_ns, error *err)
{
    int64_t show_ns = show_time_ns(clip, source_ns);
    play *p = find_predecessor(self, lane, clip, show_ns);
    if (p) {
        p->clip = clip;
        p->is_wanted = true;
        return MRT_OK;
    }
    p = free_play(self);
    if (!p) {
        add_note(self, "too many clips at the same time: some clips are not played");
        return MRT_OK;
    }
    *p = (play){.of = self, .clip = clip, .lane = lane, .is_wanted = true};
    mrt_result result = open_replay(self, clip, &p->replay, err);
    if (result == MRT_HOLD) {
        *p = (play){0};
        add_note(self, unprepared);
        log_push(self->world.log, MRT_LOG_WARNING, "take", unprepared);
        return MRT_OK;
    }
    if (result >= 0)
        result = replay_seek(p->replay, show_ns, err);
    if (result >= 0 && begins_with_its_shape(self, p))
        result = begin_with_its_shape(self, show_ns, err);
    if (result >= 0 && begins_with_its_shape(self, p))
        result = begin_with_its_swing(self, clip, show_ns, err);
    if (result < 0)
        return result;
    cast_play(self, p);
    add_note(self, replay_note(p->replay));
    return MRT_OK;
}

/* Starts and ends plays so that exactly the clips at at_ns play. *out_changed: the face must be
 * solved again. */
static mrt_result cross_boundary(sequencer *self, int64_t at_ns, bool *out_changed, error *err)
{
    mrt_result result = MRT_OK;
    uint32_t fresh_count = 0;
    *out_changed = false;
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot)
        self->play[slot].is_wanted = false;
    for (uint32_t i = 0; i < self->take.layer_count && result >= 0; ++i) {
        take_voice voice[2];
        uint32_t count =
            own_layer_is_active(&self->take, i) ? take_at(voice, &self->take.layer[i], at_ns) : 0;
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
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot) {
        play *p = &self->play[slot];
        if (p->replay && !p->is_wanted) {
            close_play(self, p);
            *out_changed = true;
        } else if (p->replay && fresh_count > 0 && self->now_ns != BEFORE_ALL) {
            *out_changed |= layer_pull(replay_layer(p->replay))->mode != MRT_IDLE;
        }
        /* A pose that is held has no samples, so it shows at once; life does, too. */
        if (p->replay && (fresh_count > 0 || self->now_ns == BEFORE_ALL))
            *out_changed |= replay_layer(p->replay)->palette.pull.mode != MRT_IDLE ||
                            replay_layer(p->replay)->life.pull.mode != MRT_IDLE;
    }
    schedule_plays(self);
    return result;
}

/* Marks the face as the take's alone. The live layer stays hidden until its next step. */
static void be_untouched(sequencer *self)
{
    self->is_touched = false;
    self->performer->voice[LIVE_VOICE].weight = 0.0;
}

/* Goes before the first instant and starts the clips of instant 0. */
static mrt_result restart(sequencer *self, error *err)
{
    bool is_changed;
    close_plays(self);
    composer_reset(self->performer->composer);
    self->now_ns = BEFORE_ALL;
    be_untouched(self);
    return cross_boundary(self, 0, &is_changed, err);
}

/* ---- checkpoints: saved states, so that scrubbing need not play from the start. Playback from a
 * checkpoint gives the same bits ---- */

static bool put_play(sequencer *self, bytes_out *out, uint32_t slot)
{
    const play *p = &self->play[slot];
    const performer_voice *v = &self->performer->voice[slot];
    size_t size = replay_save(p->replay, NULL, 0);
    if (size == 0)
        return false;
    bytes_write_u32(out, slot);
    bytes_write_u32(out, p->lane);
    bytes_write_u32(out, p->clip->id);
    bytes_write_u32(out, v->has_smooth);
    if (v->has_smooth) {
        bytes_write(out, &v->smooth_ns, sizeof v->smooth_ns);
        bytes_write(out, &v->smooth, sizeof v->smooth);
    }
    bytes_write_u32(out, (uint32_t)size);
    if (out->data && out->size + size <= out->capacity)
        replay_save(p->replay, out->data + out->size, size);
    out->size += size;
    return true;
}

/* Returns the size of the state. 0: it cannot be saved. */
static size_t put_all(sequencer *self, unsigned char *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = capacity};
    uint32_t count = 0;
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot)
        count += self->play[slot].replay != NULL;
    bytes_write_u32(&out, count);
    for (uint32_t slot = 0; slot < PLAYS_MAX; ++slot)
        if (self->play[slot].replay && !put_play(self, &out, slot))
            return 0;
    composer *shown = self->performer->composer;
    size_t size = composer_save(shown, NULL, 0);
    if (out.data && out.size + size <= out.capacity)
        composer_save(shown, out.data + out.size, size);
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
    uint32_t slot = bytes_read_u32(in), lane = bytes_read_u32(in);
    const take_clip *clip = find_clip(&self->take, lane, bytes_read_u32(in));
    if (in->failed || slot >= PLAYS_MAX || !clip)
        return error_set(err, MRT_ERR_FORMAT, "a checkpoint of the take is damaged");
    play *p = &self->play[slot];
    performer_voice *v = &self->performer->voice[slot];
    *p = (play){.of = self, .clip = clip, .lane = lane};
    v->has_smooth = bytes_read_u32(in) != 0;
    if (v->has_smooth) {
        bytes_read(in, &v->smooth_ns, sizeof v->smooth_ns);
        bytes_read(in, &v->smooth, sizeof v->smooth);
    }
    size_t size = bytes_read_u32(in);
    if (in->failed || size > (size_t)(in->end - in->at))
        return error_set(err, MRT_ERR_FORMAT, "a checkpoint of the take is damaged");
    mrt_result result = open_replay(self, clip, &p->replay, err);
    if (result == MRT_HOLD)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s", unprepared);
    if (result >= 0)
        result = replay_load(p->replay, in->at, size, err);
    if (result >= 0)
        cast_play(self, p);
    in->at += size;
    return result;
}

static mrt_result take_up(sequencer *self, const checkpoint *m, error *err)
{
    bytes_in in = {.at = m->bytes, .end = m->bytes + m->size};
    close_plays(self);
    uint32_t count = bytes_read_u32(&in);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = take_play(self, &in, err);
    if (result >= 0)
        result = composer_load(self->performer->composer, in.at, (size_t)(in.end - in.at), err);
    schedule_plays(self);
    self->now_ns = m->at_ns;
    be_untouched(self);
    return result;
}

/* Removes every second checkpoint and doubles the distance between later ones. */
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

static mrt_result insert_checkpoint(sequencer *self, size_t at, size_t size, error *err)
{
    if (self->checkpoint_count == self->checkpoint_capacity) {
        size_t capacity = self->checkpoint_capacity * 2 + 16;
        checkpoint *grown = realloc(self->checkpoint, capacity * sizeof *grown);
        if (!grown)
            return error_set(err, MRT_ERR_MEMORY, "no memory for checkpoints");
        self->checkpoint = grown;
        self->checkpoint_capacity = capacity;
    }
    unsigned char *bytes = malloc(size);
    if (!bytes)
        return error_set(err, MRT_ERR_MEMORY, "no memory for checkpoints");
    put_all(self, bytes, size);
    memmove(self->checkpoint + at + 1, self->checkpoint + at,
            (self->checkpoint_count - at) * sizeof *self->checkpoint);
    self->checkpoint[at] = (checkpoint){self->now_ns, bytes, size};
    self->checkpoint_count += 1;
    self->checkpoint_bytes += size;
    return MRT_OK;
}

static mrt_result keep_checkpoint(sequencer *self, error *err)
{
    if (self->is_unkeepable || self->is_touched || self->is_prepared)
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
    mrt_result result = insert_checkpoint(self, at, size, err);
    TRACE(TRACE_PLAYBACK, "checkpoint at %.3f s, %zu bytes, %zu kept", 1e-9 * (double)self->now_ns,
          size, self->checkpoint_count);
    while (self->checkpoint_bytes > self->settings.checkpoint_bytes && self->checkpoint_count > 1)
        thin_out(self);
    return result;
}

static void forget_checkpoints(sequencer *self)
{
    for (size_t i = 0; i < self->checkpoint_count; ++i)
        free(self->checkpoint[i].bytes);
    free(self->checkpoint);
    self->checkpoint = NULL;
    self->checkpoint_count = self->checkpoint_capacity = self->checkpoint_bytes = 0;
    self->checkpoint_span_ns = 0;
    self->is_unkeepable = false;
}

/* Returns whether an overdub has ended while its prepared data is still loaded. */
static bool is_left(const sequencer *self)
{
    return self->is_ahead && !self->is_prepared;
}

/* Drops the prepared data. The replays read the show and call their processes again, and must be
 * sought. */
static void forget_ahead(sequencer *self)
{
    replay *open[OPEN_MAX + PLAYS_MAX];
    uint32_t open_count = list_open(self, open);
    for (uint32_t i = 0; i < open_count; ++i)
        replay_forget_ahead(open[i]);
    free(self->start.bytes);
    self->start = (checkpoint){0};
    self->is_prepared = self->is_ahead = false;
    self->is_touched = true;
}

/* Saves the state at the start. The state of a mapping that is played from stored answers is left
 * out. */
static mrt_result keep_start(sequencer *self, error *err)
{
    size_t size = put_all(self, NULL, 0);
    if (size == 0)
        return MRT_OK;
    self->start = (checkpoint){self->now_ns, malloc(size), size};
    if (!self->start.bytes) {
        self->start.size = 0;
        return error_set(err, MRT_ERR_MEMORY, "no memory for checkpoints");
    }
    put_all(self, self->start.bytes, size);
    return MRT_OK;
}

/* Returns the clip of a take that plays one unedited performance. NULL: other takes. For such a
 * take the checkpoints of the recording are usable too. */
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

/* Goes to a checkpoint of the recording. MRT_HOLD: it would not help. */
static mrt_result recall(sequencer *self, int64_t at_ns, int64_t better_than_ns, error *err)
{
    const take_clip *clip = only_clip(self);
    if (!clip || !self->play[0].replay)
        return MRT_HOLD;
    int64_t offset_ns = self->take.layer[0].offset_ns;
    int64_t then_ns = clip->from_ns + take_warp_to_source(clip, at_ns - offset_ns);
    int64_t least_ns = clip->from_ns + take_warp_to_source(clip, better_than_ns - offset_ns);
    mrt_result result =
        replay_restore(self->play[0].replay, then_ns + 1, least_ns, self->performer, err);
    if (result != MRT_OK)
        return result;
    self->now_ns =
        take_warp_to_timeline(clip, replay_now_ns(self->play[0].replay) - clip->from_ns) +
        offset_ns;
    composer_shift_time(self->performer->composer,
                        self->now_ns - replay_now_ns(self->play[0].replay));
    be_untouched(self);
    return MRT_OK;
}

/* Returns the last checkpoint at or before at_ns. NULL: none. */
static const checkpoint *kept_before(const sequencer *self, int64_t at_ns)
{
    size_t count = count_until(self, at_ns);
    const checkpoint *best = count > 0 ? &self->checkpoint[count - 1] : NULL;
    bool is_start = self->start.size > 0 && self->start.at_ns <= at_ns;
    return is_start && (!best || best->at_ns <= self->start.at_ns) ? &self->start : best;
}

/* Goes to an instant at or before at_ns from which playback to at_ns is fastest. */
static mrt_result go_near(sequencer *self, int64_t at_ns, error *err)
{
    if (is_left(self))
        forget_ahead(self);
    const checkpoint *best = kept_before(self, at_ns);
    int64_t from_ns = best ? best->at_ns : 0;
    bool may_go_on = self->now_ns <= at_ns && !self->is_touched;
    if (may_go_on && (self->now_ns >= from_ns || at_ns - self->now_ns < span_min_ns))
        from_ns = self->now_ns;
    else
        may_go_on = false;
    if (at_ns - from_ns > span_min_ns) {
        if (!self->play[0].replay) {
            mrt_result started = restart(self, err);
            if (started < 0)
                return started;
            may_go_on = false;
        }
        int64_t before_ns = self->play[0].replay ? replay_now_ns(self->play[0].replay) : 0;
        mrt_result result = recall(self, at_ns, from_ns > 0 ? from_ns : 0, err);
        if (result != MRT_HOLD)
            return result;
        if (self->play[0].replay && replay_now_ns(self->play[0].replay) != before_ns)
            may_go_on = false; /* the checkpoint of the recording was damaged */
    }
    if (may_go_on)
        return MRT_OK;
    error ignored = {""};
    if (best && take_up(self, best, &ignored) >= 0)
        return MRT_OK;
    return restart(self, err);
}

/* ---- clip boundaries ---- */

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
        for (uint32_t j = 0; own_layer_is_active(&self->take, i) && j < l->clip_count; ++j) {
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

/* ---- contacts and degrees of freedom that a layer owns ---- */

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
    const mrt_face *about = composer_about(self->performer->composer);
    size_t row = about->contact_count + about->dof_count + 1;
    free(self->owned);
    self->owned = calloc(row, (size_t)self->take.layer_count + 1);
    self->owned_row = row;
    if (!self->owned)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the take");
    for (uint32_t i = 0; i < self->take.layer_count; ++i)
        sequencer_mark_owned(self->performer->composer, &self->take.layer[i],
                             self->owned + i * row);
    return MRT_OK;
}

/* ---- playback ---- */

/* Performs the next sample or clip boundary up to to_ns. MRT_END: all are performed. */
static mrt_result happen(sequencer *self, int64_t to_ns, bool *out_is_sample, error *err)
{
    sample_step *next = &self->frame.step;
    int64_t ignored_ns, boundary_ns = next_boundary_ns(self);
    *out_is_sample = false;
    mrt_result result = scheduler_next(&self->scheduler, 0, next, &ignored_ns, err);
    if (result < 0)
        return result;
    int64_t sample_ns = result == MRT_OK ? next->due_ns : INT64_MAX;
    int64_t first_ns = boundary_ns < sample_ns ? boundary_ns : sample_ns;
    if (first_ns > to_ns || first_ns == INT64_MAX)
        return MRT_END;
    if (boundary_ns <= sample_ns) { /* boundary first: a clip does not show a sample at its end */
        bool is_changed;
        result = cross_boundary(self, boundary_ns, &is_changed, err);
        self->now_ns = boundary_ns;
        weigh_voices(self, boundary_ns);
        if (result >= 0 && is_changed)
            frame_recompose(self->performer, boundary_ns);
        return result;
    }
    replay_prepare(self->play[next->voice].replay, next);
    self->now_ns = sample_ns;
    self->sample_count += next->count;
    weigh_voices(self, sample_ns);
    *out_is_sample = true;
    result = frame_step(&self->frame, err);
    return result < 0 ? result : keep_checkpoint(self, err);
}

/* ---- prepare an overdub ---- */

static bool is_shown(const sequencer *self, uint32_t lane, const take_clip *c, int64_t from_ns,
                     int64_t to_ns)
{
    int64_t offset_ns = self->take.layer[lane].offset_ns;
    return own_layer_is_active(&self->take, lane) && !c->is_muted &&
           c->start_ns + offset_ns < to_ns && c->end_ns + offset_ns > from_ns;
}

/* Counts the clips of the same performance that play at at_ns (including their ends) and are shown
 * in from_ns..to_ns. */
static uint32_t count_playing(const sequencer *self, const take_clip *of, int64_t at_ns,
                              int64_t from_ns, int64_t to_ns)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < self->take.layer_count; ++i) {
        const take_layer *l = &self->take.layer[i];
        for (uint32_t j = 0; j < l->clip_count; ++j)
            count += l->clip[j].performance == of->performance && l->clip[j].part == of->part &&
                     is_shown(self, i, &l->clip[j], from_ns, to_ns) &&
                     l->clip[j].start_ns + l->offset_ns <= at_ns &&
                     l->clip[j].end_ns + l->offset_ns >= at_ns;
    }
    return count;
}

static void close_what_is_not_shown(sequencer *self, int64_t from_ns, int64_t to_ns)
{
    for (uint32_t k = self->spare_count; k-- > 0;) {
        bool is_needed = false;
        for (uint32_t i = 0; i < self->take.layer_count; ++i)
            for (uint32_t j = 0; j < self->take.layer[i].clip_count; ++j) {
                const take_clip *c = &self->take.layer[i].clip[j];
                is_needed |=
                    replay_is_of(self->spare[k], c) && is_shown(self, i, c, from_ns, to_ns);
            }
        if (!is_needed)
            replay_close(take_spare(self, k));
    }
}

/* Opens enough replays for all clips that play together with this one, and reads their samples of
 * the span. */
static mrt_result prepare_clip(sequencer *self, uint32_t lane, const take_clip *clip,
                               int64_t from_ns, int64_t to_ns, error *err)
{
    replay *open[OPEN_MAX + PLAYS_MAX];
    int64_t offset_ns = self->take.layer[lane].offset_ns;
    int64_t first_ns = from_ns - offset_ns > clip->start_ns ? from_ns - offset_ns : clip->start_ns;
    int64_t last_ns = to_ns - offset_ns < clip->end_ns ? to_ns - offset_ns : clip->end_ns;
    uint32_t missing = count_playing(self, clip, clip->start_ns + offset_ns, from_ns, to_ns);
    uint32_t open_count = list_open(self, open);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < open_count && missing > 0; ++i)
        missing -= replay_is_of(open[i], clip);
    for (; missing > 0 && result >= 0 && open_count < OPEN_MAX; --missing) {
        result = replay_open(&open[open_count], &self->world, clip->performance, clip->part, err);
        if (result >= 0)
            self->spare[self->spare_count++] = open[open_count++];
    }
    for (uint32_t i = 0; i < open_count && result >= 0; ++i)
        if (replay_is_of(open[i], clip))
            result = replay_read_ahead(
                open[i], show_time_ns(clip, take_warp_to_source(clip, first_ns)),
                show_time_ns(clip, take_warp_to_source(clip, last_ns)) + NS_PER_S, err);
    return result;
}

static mrt_result answer_ahead(sequencer *self, error *err)
{
    replay *open[OPEN_MAX + PLAYS_MAX];
    uint32_t open_count = list_open(self, open);
    int64_t until_ns = clock_now_ns() + answers_patience_ns;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < open_count && result >= 0; ++i) {
        result = replay_answer_ahead(open[i], until_ns, err);
        const char *missing = replay_missing(open[i]);
        add_note(self, missing);
        if (missing[0])
            log_push(self->world.log, MRT_LOG_WARNING, "take", missing);
    }
    return result;
}

mrt_result sequencer_prepare(sequencer *self, int64_t from_ns, int64_t to_ns, error *err)
{
    mrt_result result = MRT_OK;
    int64_t at_ns = self->now_ns;
    if (self->is_ahead) {
        forget_ahead(self);
        result = sequencer_seek(self, at_ns, err);
    }
    from_ns -= span_min_ns; /* the nearest checkpoint may lie this far before */
    self->is_ahead = true;
    close_what_is_not_shown(self, from_ns, to_ns);
    for (uint32_t i = 0; i < self->take.layer_count; ++i)
        for (uint32_t j = 0; j < self->take.layer[i].clip_count && result >= 0; ++j)
            if (is_shown(self, i, &self->take.layer[i].clip[j], from_ns, to_ns))
                result = prepare_clip(self, i, &self->take.layer[i].clip[j], from_ns, to_ns, err);
    if (result >= 0)
        result = keep_start(self, err);
    if (result >= 0)
        result = answer_ahead(self, err);
    self->is_prepared = result >= 0;
    self->is_touched = true;
    return result < 0 ? result : sequencer_seek(self, at_ns, err);
}

mrt_result sequencer_play_to(sequencer *self, int64_t at_ns, error *err)
{
    bool is_sample;
    if (at_ns < self->now_ns || is_left(self))
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
    mrt_result result = go_near(self, at_ns, err);
    TRACE(TRACE_PLAYBACK, "seek to %.3f s from %.3f s", 1e-9 * (double)at_ns,
          1e-9 * (double)self->now_ns);
    return result < 0 ? result : sequencer_play_to(self, at_ns, err);
}

/* ---- another version of the take ---- */

static bool is_same_clip(const take_clip *a, const take_clip *b)
{
    return a->performance == b->performance && a->part == b->part && a->from_ns == b->from_ns &&
           a->to_ns == b->to_ns && a->start_ns == b->start_ns && a->end_ns == b->end_ns &&
           a->warp_count == b->warp_count &&
           memcmp(a->warp, b->warp, a->warp_count * sizeof *a->warp) == 0 &&
           a->fade_in_ns == b->fade_in_ns && a->fade_out_ns == b->fade_out_ns &&
           !(a->gain < b->gain || a->gain > b->gain) &&
           !(a->smooth_s < b->smooth_s || a->smooth_s > b->smooth_s) && a->is_muted == b->is_muted;
}

static bool is_same_own(const take_layer *a, const take_layer *b)
{
    return a->own_count == b->own_count &&
           (a->own_count == 0 || memcmp(a->own, b->own, a->own_count * sizeof *a->own) == 0);
}

/* Returns the first start of a clip of `of` that `other` lacks or has in another form, in the
 * layer's time. INT64_MAX: none. */
static int64_t first_other_clip_ns(const take_layer *of, const take_layer *other)
{
    for (uint32_t i = 0; i < of->clip_count; ++i) {
        uint32_t k = i; /* most clips keep their place */
        if (k >= other->clip_count || other->clip[k].id != of->clip[i].id)
            for (k = 0; k < other->clip_count && other->clip[k].id != of->clip[i].id;)
                k += 1;
        if (k >= other->clip_count || !is_same_clip(&of->clip[i], &other->clip[k]))
            return of->clip[i].start_ns;
    }
    return INT64_MAX;
}

/* A clip fades out by itself where the next one no longer overlaps it. */
static int64_t with_fades_ns(const take_layer *of, int64_t from_ns)
{
    int64_t first_ns = from_ns;
    for (uint32_t i = 0; i < of->clip_count && of->clip[i].start_ns < from_ns; ++i) {
        const int64_t fade_ns = of->clip[i].end_ns - of->clip[i].fade_out_ns;
        if (of->clip[i].end_ns >= from_ns && fade_ns < first_ns)
            first_ns = fade_ns;
    }
    return first_ns;
}

/* Returns the instant before which both takes give the same face. INT64_MAX: everywhere. */
static int64_t differs_from_ns(const take *a, const take *b)
{
    int64_t first_ns = INT64_MAX;
    if (a->layer_count != b->layer_count)
        return INT64_MIN;
    for (uint32_t i = 0; i < a->layer_count; ++i) {
        const take_layer *x = &a->layer[i], *y = &b->layer[i];
        if (x->id != y->id || x->offset_ns != y->offset_ns || x->is_additive != y->is_additive ||
            own_layer_is_active(a, i) != own_layer_is_active(b, i) || !is_same_own(x, y))
            return INT64_MIN;
        const bool is_same_gain = !(x->gain < y->gain || x->gain > y->gain);
        int64_t at_ns = first_other_clip_ns(x, y), other_ns = first_other_clip_ns(y, x);
        at_ns = other_ns < at_ns ? other_ns : at_ns;
        if (!is_same_gain && x->clip_count > 0 && x->clip[0].start_ns < at_ns)
            at_ns = x->clip[0].start_ns;
        if (at_ns == INT64_MAX)
            continue;
        at_ns = with_fades_ns(x, at_ns);
        at_ns = with_fades_ns(y, at_ns) + x->offset_ns;
        first_ns = at_ns < first_ns ? at_ns : first_ns;
    }
    return first_ns;
}

static void forget_checkpoints_from(sequencer *self, int64_t from_ns)
{
    while (self->checkpoint_count > 0 &&
           self->checkpoint[self->checkpoint_count - 1].at_ns >= from_ns) {
        self->checkpoint_count -= 1;
        self->checkpoint_bytes -= self->checkpoint[self->checkpoint_count].size;
        free(self->checkpoint[self->checkpoint_count].bytes);
    }
}

/* Replaces the take. No clip plays then, and their replays stay open. */
static mrt_result exchange_take(sequencer *self, const take *t, error *err)
{
    take fresh = {0};
    mrt_result result = take_copy(&fresh, t, err);
    if (result < 0)
        return result;
    forget_ahead(self);
    close_plays(self);
    take_finish(&self->take);
    self->take = fresh;
    self->note[0] = '\0';
    result = list_boundaries(self, err);
    return result < 0 ? result : list_owned(self, err);
}

/* ---- create and destroy ---- */

mrt_result sequencer_create(sequencer **out, const sequencer_settings *settings, const take *t,
                            error *err)
{
    *out = NULL;
    sequencer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    self->settings = *settings;
    self->entry = calloc(SOURCES_MAX, sizeof *self->entry);
    if (self->settings.checkpoint_bytes == 0)
        self->settings.checkpoint_bytes = checkpoint_bytes_default;
    self->now_ns = BEFORE_ALL;
    self->settings.solver = NULL;
    const csrbf_settings solver =
        settings->solver ? *settings->solver
                         : kept_solver_for(settings->show, settings->face, settings->log);
    const performer_settings as = {.solver = solver};
    scheduler_init(&self->scheduler, SCHEDULE_RECORDED, self->entry, NULL, SOURCES_MAX);
    mrt_result result =
        self->entry ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    if (result >= 0)
        result = performer_create(&self->performer, settings->face, NULL, &as, err);
    if (result >= 0)
        result = performer_create(&self->scratch, settings->face, NULL, &as, err);
    self->frame = (stage_frame){.performer = self->performer, .sources = &self->scheduler};
    self->world = (replay_world){.show = settings->show,
                                 .plugins = settings->plugins,
                                 .log = settings->log,
                                 .scratch = self->scratch,
                                 .ahead_bytes = settings->ahead_bytes};
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
    forget_ahead(self);
    close_plays(self);
    close_spares(self);
    forget_checkpoints(self);
    performer_destroy(self->performer);
    performer_destroy(self->scratch);
    free(self->entry);
    take_finish(&self->take);
    free(self->boundary);
    free(self->owned);
    free(self->scratch_bytes);
    free(self);
}

mrt_result sequencer_set_take(sequencer *self, const take *t, error *err)
{
    int64_t at_ns = self->now_ns;
    mrt_result result = exchange_take(self, t, err);
    if (result < 0)
        return result;
    close_spares(self); /* a performance may have become longer */
    forget_checkpoints(self);
    result = restart(self, err);
    return result >= 0 && at_ns >= 0 ? sequencer_seek(self, at_ns, err) : result;
}

mrt_result sequencer_preview_take(sequencer *self, const take *t, error *err)
{
    const int64_t same_until_ns = differs_from_ns(&self->take, t);
    mrt_result result = exchange_take(self, t, err);
    if (result < 0)
        return result;
    forget_checkpoints_from(self, same_until_ns);
    self->now_ns = BEFORE_ALL;
    self->is_touched = true;
    return MRT_OK;
}

/* ---- live layer ---- */

void sequencer_set_live(sequencer *self, layer *of, const uint8_t *owns, bool is_additive)
{
    self->performer->voice[LIVE_VOICE] =
        (performer_voice){.layer = of, .owns = owns, .is_additive = is_additive, .gain = 1.0};
    self->is_prepared = self->is_prepared && of;
}

void sequencer_perform_over(sequencer *self, stage_frame *f, double weight)
{
    performer_voice *live = &self->performer->voice[LIVE_VOICE];
    f->performer = self->performer;
    f->step.voice = LIVE_VOICE;
    f->step.due_ns = self->now_ns;
    live->weight = weight;
    self->is_touched = true;
    weigh_voices(self, self->now_ns);
}

/* ---- state ---- */

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

performer *sequencer_performer(sequencer *self)
{
    return self->performer;
}

const char *sequencer_note(const sequencer *self)
{
    return self->note;
}
