#include "show/sound_render.h"
#include "show/sound_pcm.h"
#include "show/sound_rate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the time of each frame ---- */

/* Interval of the knots, and the reach and minimum number of the anchors for each knot. */
static const double knot_span_s = 10.0, reach_s = 15.0;
enum { ANCHORS_MIN = 4 };
/* Anchors that deviate from the nominal rate by more than this belong to different pieces. One part
 * is fixed, for jitter. The other grows with the time between them, for drift. */
static const double jump_ns = 3e6, jump_part = 1e-3;
/* No clock drifts more than this. A steeper line comes from noise. */
static const double drift_max = 2e-3;
static const double local_max_ns = 2 * 86400e9;

typedef struct point { /* an anchor in local time */
    int64_t frame;
    double time_ns;
} point;

typedef struct builder {
    sound_map *map;
    double nominal_ns; /* per frame */
    point *points;
    size_t count;
} builder;

static double nominal_of(uint32_t rate_hz)
{
    return 1e9 / (double)rate_hz;
}

/* ---- anchors ---- */

static int64_t origin_of(const show_audio *audio, const show_audio_anchor *anchors)
{
    /* Uses the start time of the sound, unless the anchors contradict it. */
    double away_ns = (double)anchors[0].time_ns - (double)audio->start_ns -
                     (double)anchors[0].frame * nominal_of(audio->rate_hz);
    return fabs(away_ns) < 1e9 ? audio->start_ns
                               : anchors[0].time_ns - (int64_t)((double)anchors[0].frame *
                                                                nominal_of(audio->rate_hz));
}

static bool is_usable(const builder *self, const show_audio_anchor *anchor, double time_ns)
{
    const point *last = self->count ? &self->points[self->count - 1] : NULL;
    if (anchor->frame < 0 || anchor->frame >= self->map->frame_count ||
        fabs(time_ns) > local_max_ns)
        return false;
    return !last || (anchor->frame > last->frame && time_ns > last->time_ns);
}

static void take_points(builder *self, const show_audio *audio, const show_audio_anchor *anchors,
                        size_t count)
{
    /* Differences of impossible times would overflow as integers, so they are doubles. */
    bool is_sane = count > 0 && anchors[0].frame >= 0 &&
                   anchors[0].frame < self->map->frame_count &&
                   anchors[0].time_ns > INT64_MIN / 4 && anchors[0].time_ns < INT64_MAX / 4 &&
                   audio->start_ns > INT64_MIN / 4 && audio->start_ns < INT64_MAX / 4;
    if (!is_sane)
        return;
    int64_t origin_ns = origin_of(audio, anchors);
    for (size_t i = 0; i < count; ++i) {
        double time_ns = anchors[i].time_ns > INT64_MIN / 4 && anchors[i].time_ns < INT64_MAX / 4
                             ? (double)(anchors[i].time_ns - origin_ns)
                             : 2 * local_max_ns;
        if (is_usable(self, &anchors[i], time_ns))
            self->points[self->count++] = (point){anchors[i].frame, time_ns};
    }
}

/* Returns the first point after `from` that begins another piece. */
static size_t piece_end(const builder *self, size_t from)
{
    size_t i = from + 1;
    for (; i < self->count; ++i) {
        const point *a = &self->points[i - 1], *b = &self->points[i];
        double nominal_ns = (double)(b->frame - a->frame) * self->nominal_ns;
        if (fabs(b->time_ns - a->time_ns - nominal_ns) > jump_ns + jump_part * nominal_ns)
            break;
    }
    return i;
}

/* ---- lines ---- */

/* Returns the first point of [from, to) at or after the frame. */
static size_t point_at(const builder *self, size_t from, size_t to, double frame)
{
    while (from < to) {
        size_t middle = from + (to - from) / 2;
        if ((double)self->points[middle].frame < frame)
            from = middle + 1;
        else
            to = middle;
    }
    return from;
}

/* Chooses the points of [from, to) around a frame. */
static void choose(const builder *self, size_t from, size_t to, int64_t frame, size_t *out_from,
                   size_t *out_to)
{
    double reach = reach_s * (double)self->map->rate_hz, at = (double)frame;
    size_t low = point_at(self, from, to, at - reach), high = point_at(self, low, to, at + reach);
    while (high - low < ANCHORS_MIN && (low > from || high < to)) {
        bool is_below = high == to || (low > from && at - (double)self->points[low - 1].frame <=
                                                         (double)self->points[high].frame - at);
        if (is_below)
            low -= 1;
        else
            high += 1;
    }
    *out_from = low;
    *out_to = high;
}

/* Fits a line by least squares. Sums are relative to the first point to avoid rounding errors. */
static sound_knot line_at(const builder *self, size_t from, size_t to, int64_t frame)
{
    const point *first = &self->points[from];
    double n = (double)(to - from), x = 0, y = 0, xx = 0, xy = 0;
    for (size_t i = from; i < to; ++i) {
        double dx = (double)(self->points[i].frame - first->frame);
        double dy = self->points[i].time_ns - first->time_ns - dx * self->nominal_ns;
        x += dx;
        y += dy;
        xx += dx * dx;
        xy += dx * dy;
    }
    double spread = xx - x * x / n;
    double slope = spread > 0.0 ? (xy - x * y / n) / spread : 0.0;
    if (fabs(slope) > drift_max * self->nominal_ns)
        slope = 0.0;
    double at = (double)(frame - first->frame);
    return (sound_knot){.frame = frame,
                        .time_ns =
                            first->time_ns + at * self->nominal_ns + y / n + slope * (at - x / n),
                        .ns_per_frame = self->nominal_ns + slope};
}

/* ---- knots ---- */

static mrt_result add_knot(sound_map *map, const sound_knot *knot, error *err)
{
    /* Where pieces overlap in time, the later one is played. */
    while (map->knot_count > 0 && map->knot[map->knot_count - 1].time_ns >= knot->time_ns)
        map->knot_count -= 1;
    if ((map->knot_count & (map->knot_count - 1)) == 0) {
        size_t room = map->knot_count ? 2 * map->knot_count : 1;
        sound_knot *larger = realloc(map->knot, room * sizeof *larger);
        if (!larger)
            return error_set(err, MRT_ERR_MEMORY, "no memory for the times of a sound");
        map->knot = larger;
    }
    map->knot[map->knot_count++] = *knot;
    return MRT_OK;
}

static void join_knots(sound_map *map, size_t first, double nominal_ns)
{
    for (size_t i = first; i + 1 < map->knot_count; ++i) {
        sound_knot *a = &map->knot[i];
        const sound_knot *b = &map->knot[i + 1];
        double slope = (b->time_ns - a->time_ns) / (double)(b->frame - a->frame);
        if (fabs(slope - nominal_ns) <= 2 * drift_max * nominal_ns)
            a->ns_per_frame = slope;
    }
}

static mrt_result add_piece(builder *self, size_t from, size_t to, error *err)
{
    sound_map *map = self->map;
    int64_t first = from == 0 ? 0 : self->points[from].frame;
    int64_t end = to == self->count ? map->frame_count : self->points[to].frame;
    int64_t step = (int64_t)(knot_span_s * (double)map->rate_hz);
    size_t before = map->knot_count;
    for (int64_t frame = first; frame < end; frame += step) {
        size_t low, high;
        choose(self, from, to, frame, &low, &high);
        sound_knot knot = line_at(self, low, high, frame);
        knot.piece_first = first;
        knot.piece_end = end;
        mrt_result result = add_knot(map, &knot, err);
        if (result < 0)
            return result;
        before = before < map->knot_count - 1 ? before : map->knot_count - 1;
    }
    join_knots(map, before, self->nominal_ns);
    return MRT_OK;
}

mrt_result sound_map_init(sound_map *out, const show_audio *audio, const show_audio_anchor *anchors,
                          size_t anchor_count, error *err)
{
    int64_t frames_max = (int64_t)(local_max_ns / nominal_of(audio->rate_hz));
    *out = (sound_map){.rate_hz = audio->rate_hz, .frame_count = audio->frame_count};
    out->frame_count = out->frame_count < 0            ? 0
                       : out->frame_count > frames_max ? frames_max
                                                       : out->frame_count;
    builder self = {.map = out, .nominal_ns = nominal_of(audio->rate_hz)};
    mrt_result result = MRT_OK;
    self.points = calloc(anchor_count + 1, sizeof *self.points);
    if (!self.points)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the times of a sound");
    take_points(&self, audio, anchors, anchor_count);
    for (size_t from = 0; from < self.count && result >= 0;) {
        size_t to = piece_end(&self, from);
        result = add_piece(&self, from, to, err);
        from = to;
    }
    if (result >= 0 && out->knot_count == 0) {
        sound_knot plain = {.ns_per_frame = self.nominal_ns, .piece_end = out->frame_count};
        result = add_knot(out, &plain, err);
    }
    free(self.points);
    if (result < 0)
        sound_map_finish(out);
    return result;
}

static mrt_result sound_map_read(sound_map *out, show *s, const show_audio *audio, error *err)
{
    *out = (sound_map){0};
    show_audio_anchor *anchors = NULL;
    size_t count = 0;
    mrt_result result = show_audio_anchors(s, audio->id, &anchors, &count, err);
    if (result >= 0)
        result = sound_map_init(out, audio, anchors, count, err);
    free(anchors);
    return result;
}

void sound_map_finish(sound_map *map)
{
    if (!map)
        return;
    free(map->knot);
    *map = (sound_map){0};
}

/* ---- queries ---- */

bool sound_map_is_plain(const sound_map *map)
{
    return map->knot_count == 1 && map->knot[0].frame == 0 && map->knot[0].time_ns == 0.0 &&
           map->knot[0].ns_per_frame == nominal_of(map->rate_hz);
}

const sound_knot *sound_map_knot_at(const sound_map *map, double time_ns)
{
    size_t low = 0, high = map->knot_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (map->knot[middle].time_ns <= time_ns)
            low = middle;
        else
            high = middle;
    }
    return &map->knot[low];
}

/* ---- the sound on the timeline ---- */

enum { HELD_FRAMES = 8192, BEHIND_FRAMES = 1024, CHANNELS_MAX = 64 };
/* Distance after damage at which reading is tried again. */
enum { DAMAGE_FRAMES = 256 };
static const double fade_s = 0.005;
static const double time_max_ns = 1e15;

struct sound_render {
    show *show;
    show_audio audio;
    sound_map map;
    sound_pcm format;
    double offset_ns, in_ns, out_ns; /* out_ns is beyond its end if it is not trimmed */
    float gain;
    int64_t fade_frames;
    /* frames of the sound in memory */
    int64_t held_first, held_count;
    float *held;
    unsigned char *bytes;
    mrt_result trouble; /* of this call */
    error *err;
    /* where it is */
    int64_t next; /* frame of the timeline */
    bool is_sounding;
    int64_t piece_first;         /* of the current piece */
    int64_t shift, shift_before; /* frame of the sound = frame of the timeline + shift */
    int64_t fade_left;
    uint64_t splice_count;
    sound_rate *rate; /* NULL: the output has the rate of the sound */
    uint32_t rate_hz; /* output rate */
};

int64_t sound_render_frame(uint32_t rate_hz, int64_t at_ns)
{
    int64_t s = at_ns / 1000000000, ns = at_ns % 1000000000;
    return s * (int64_t)rate_hz + (int64_t)floor((double)ns * (double)rate_hz / 1e9 + 0.5);
}

/* ---- frames of the sound ---- */

static void hold(sound_render *self, int64_t frame)
{
    size_t channels = self->audio.channel_count, size = 0;
    size_t frame_size = channels * sound_pcm_bytes(self->format);
    self->held_first = frame > BEHIND_FRAMES ? frame - BEHIND_FRAMES : 0;
    self->held_count = HELD_FRAMES;
    for (size_t at = 0; at < HELD_FRAMES;) {
        error why = {""};
        mrt_result result = show_audio_read(
            self->show, self->audio.id, self->held_first + (int64_t)at,
            self->bytes + at * frame_size, (HELD_FRAMES - at) * frame_size, &size, &why);
        size_t got = size / frame_size;
        sound_pcm_unpack(self->held + at * channels, self->bytes + at * frame_size, got * channels,
                         self->format);
        at += got;
        if (result < 0 && self->trouble >= 0)
            self->trouble = error_set(self->err, result, "%s", why.text);
        size_t silent = result < 0 ? DAMAGE_FRAMES : HELD_FRAMES;
        silent = silent < HELD_FRAMES - at ? silent : HELD_FRAMES - at;
        memset(self->held + at * channels, 0, silent * channels * sizeof *self->held);
        at += silent;
    }
}

static const float *frame_at(sound_render *self, int64_t frame)
{
    static const float silence[CHANNELS_MAX] = {0};
    if (frame < 0 || frame >= self->map.frame_count)
        return silence;
    if (frame < self->held_first || frame >= self->held_first + self->held_count)
        hold(self, frame);
    return self->held + (size_t)(frame - self->held_first) * self->audio.channel_count;
}

/* Returns the fade at an edge. The sound fades out before lost frames and in after them, but not at
 * its own ends. */
static float edge(const sound_render *self, const sound_knot *knot, int64_t frame)
{
    int64_t into = frame - knot->piece_first + 1, left = knot->piece_end - frame;
    float gain = 1.0f, length = (float)self->fade_frames;
    if (frame < knot->piece_first || frame >= knot->piece_end)
        return 0.0f;
    if (knot->piece_first > 0 && into < self->fade_frames)
        gain = (float)into / length;
    if (knot->piece_end < self->map.frame_count && left < self->fade_frames)
        gain = fminf(gain, (float)left / length);
    return gain;
}

/* ---- frames of the timeline ---- */

/* Returns the shift of frame n. `stretch` is exactly 0 for a sound at its nominal rate, so its
 * shift is constant. Otherwise the shift is monotone in n, so its rounded value never oscillates.
 * */
static int64_t shift_at(const sound_render *self, const sound_knot *knot, int64_t n)
{
    double nominal_ns = 1e9 / (double)self->audio.rate_hz;
    double stretch = nominal_ns / knot->ns_per_frame - 1.0;
    double start = (double)knot->frame - (self->offset_ns + knot->time_ns) / knot->ns_per_frame;
    return (int64_t)floor(start + (double)n * stretch + 0.5);
}

static void follow(sound_render *self, const sound_knot *knot, int64_t shift)
{
    if (!self->is_sounding || self->piece_first != knot->piece_first) {
        self->fade_left = 0;
    } else if (shift != self->shift) {
        self->shift_before = self->shift;
        self->fade_left = self->fade_frames;
        self->splice_count += (uint64_t)llabs(shift - self->shift);
    }
    self->shift = shift;
    self->piece_first = knot->piece_first;
    self->is_sounding = true;
}

/* Returns the fade at the trimmed ends; 0: silent. */
static float trim_at(const sound_render *self, double time_ns)
{
    const double fade_ns = fade_s * 1e9;
    double gain = (self->out_ns - time_ns) / fade_ns;
    if (self->in_ns > 0.0)
        gain = fmin(gain, (time_ns - self->in_ns) / fade_ns);
    return (float)fmax(0.0, fmin(gain, 1.0));
}

static void mix(sound_render *self, const sound_knot *knot, int64_t n, float loud, float *out)
{
    uint32_t channels = self->audio.channel_count;
    float before = 0.0f;
    if (self->fade_left > 0) {
        before = (float)self->fade_left / (float)(self->fade_frames + 1);
        const float *old = frame_at(self, n + self->shift_before);
        float old_gain = loud * before * edge(self, knot, n + self->shift_before);
        for (uint32_t c = 0; c < channels; ++c)
            out[c] = old_gain * old[c];
        self->fade_left -= 1;
    }
    const float *now = frame_at(self, n + self->shift);
    float gain = loud * (1.0f - before) * edge(self, knot, n + self->shift);
    for (uint32_t c = 0; c < channels; ++c)
        out[c] += gain * now[c];
}

/* Renders frame n. `out` NULL: only updates the position. */
static void render_frame(sound_render *self, int64_t n, float *out)
{
    double time_ns = (double)n * (1e9 / (double)self->audio.rate_hz) - self->offset_ns;
    const sound_knot *knot = sound_map_knot_at(&self->map, time_ns);
    int64_t shift = shift_at(self, knot, n);
    const float trim = trim_at(self, time_ns);
    if (n + shift < knot->piece_first || n + shift >= knot->piece_end || trim == 0.0f) {
        self->is_sounding = false;
        return;
    }
    follow(self, knot, shift);
    if (out)
        mix(self, knot, n, self->gain * trim, out);
    else if (self->fade_left > 0)
        self->fade_left -= 1;
}

/* Moves to frame n. A cross-fade may be running at n, so this starts one cross-fade length before
 * it. */
static void come_to(sound_render *self, int64_t n)
{
    uint64_t count = self->splice_count;
    self->is_sounding = false;
    for (int64_t i = n - self->fade_frames - 1; i < n; ++i)
        render_frame(self, i, NULL);
    self->splice_count = count;
}

/* Renders frames at the rate of the sound. */
static void render_frames(void *data, int64_t first, float *out, size_t count)
{
    sound_render *self = data;
    memset(out, 0, count * self->audio.channel_count * sizeof *out);
    if (first != self->next && !sound_map_is_plain(&self->map))
        come_to(self, first);
    else if (first != self->next)
        self->is_sounding = false;
    for (size_t i = 0; i < count; ++i)
        render_frame(self, first + (int64_t)i, out + i * self->audio.channel_count);
    self->next = first + (int64_t)count;
}

mrt_result sound_render_frames(sound_render *self, int64_t first, float *out, size_t count,
                               error *err)
{
    self->trouble = MRT_OK;
    self->err = err;
    if (fabs((double)first) / (double)self->rate_hz * 1e9 > time_max_ns)
        memset(out, 0, count * self->audio.channel_count * sizeof *out);
    else if (self->rate)
        sound_rate_frames(self->rate, first, out, count);
    else
        render_frames(self, first, out, count);
    self->err = NULL;
    return self->trouble;
}

/* ---- lifetime ---- */

static mrt_result check(const sound_render *self, const take_audio *audio, error *err)
{
    if (!isfinite(audio->gain) || fabs(audio->gain) > 1000.0 ||
        fabs((double)audio->offset_ns) > time_max_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: sound %lld with a gain of %g at %g s is invalid",
                         show_path(self->show), (long long)audio->audio, audio->gain,
                         (double)audio->offset_ns / 1e9);
    return MRT_OK;
}

mrt_result sound_render_create(sound_render **out, show *s, const take_audio *audio,
                               uint32_t rate_hz, error *err)
{
    *out = NULL;
    sound_render *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a sound");
    self->show = s;
    self->offset_ns = (double)audio->offset_ns;
    self->gain = (float)audio->gain;
    self->in_ns = (double)audio->in_ns;
    self->out_ns = audio->out_ns ? (double)audio->out_ns : (double)INFINITY;
    mrt_result result = check(self, audio, err);
    if (result >= 0)
        result = show_audio_info(s, audio->audio, &self->audio, err);
    if (result >= 0)
        result = sound_map_read(&self->map, s, &self->audio, err);
    if (result < 0)
        goto fail;
    self->format = sound_pcm_of(self->audio.format);
    self->fade_frames = (int64_t)(fade_s * (double)self->audio.rate_hz) + 1;
    self->next = INT64_MIN;
    size_t samples = (size_t)HELD_FRAMES * self->audio.channel_count;
    self->held = malloc(samples * sizeof *self->held);
    self->bytes = malloc(samples * sound_pcm_bytes(self->format));
    if (!self->held || !self->bytes) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a sound");
        goto fail;
    }
    self->rate_hz = rate_hz ? rate_hz : self->audio.rate_hz;
    if (self->rate_hz != self->audio.rate_hz)
        result = sound_rate_create(&self->rate, self->audio.rate_hz, self->rate_hz,
                                   self->audio.channel_count, render_frames, self, err);
    if (result < 0)
        goto fail;
    *out = self;
    return MRT_OK;
fail:
    sound_render_destroy(self);
    return result;
}

void sound_render_destroy(sound_render *self)
{
    if (!self)
        return;
    sound_rate_destroy(self->rate);
    sound_map_finish(&self->map);
    free(self->held);
    free(self->bytes);
    free(self);
}

const show_audio *sound_render_audio(const sound_render *self)
{
    return &self->audio;
}

const sound_map *sound_render_map(const sound_render *self)
{
    return &self->map;
}

uint64_t sound_render_splice_count(const sound_render *self)
{
    return self->splice_count;
}
