#include "stage/sound/sound_follow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double fade_s = 0.005, band_s = 0.0002, jump_s = 0.005;
/* Frames that are kept behind the cursor for small jumps back. */
enum { BEHIND_FRAMES = 4096 };

/* ---- the board ---- */

uint64_t sound_motion_key(const sound_motion *motion)
{
    return (uint64_t)motion->edition << 32 | motion->revision;
}

void sound_board_post(sound_board *self, const sound_motion *motion)
{
    uint32_t sequence = atomic_load_explicit(&self->sequence, memory_order_relaxed);
    uint64_t word[SOUND_BOARD_WORDS] = {motion->revision};
    memcpy(&word[1], &motion->host_ns, sizeof word[1]);
    memcpy(&word[2], &motion->at_ns, sizeof word[2]);
    memcpy(&word[3], &motion->speed, sizeof word[3]);
    memcpy(&word[4], &motion->loop_from_ns, sizeof word[4]);
    memcpy(&word[5], &motion->loop_to_ns, sizeof word[5]);
    memcpy(&word[6], &motion->beat_ns, sizeof word[6]);
    word[7] = (uint64_t)motion->bar << 32 | motion->beats << 1 | motion->is_mute;
    atomic_store(&self->sequence, sequence + 1);
    for (int i = 0; i < SOUND_BOARD_WORDS; ++i)
        atomic_store(&self->word[i], word[i]);
    atomic_store(&self->sequence, sequence + 2);
}

bool sound_board_read(const sound_board *self, sound_motion *out)
{
    uint64_t word[SOUND_BOARD_WORDS];
    uint32_t sequence = atomic_load(&self->sequence);
    for (int i = 0; i < SOUND_BOARD_WORDS; ++i)
        word[i] = atomic_load(&self->word[i]);
    if ((sequence & 1) != 0 || atomic_load(&self->sequence) != sequence)
        return false;
    out->revision = (uint32_t)word[0];
    out->edition = atomic_load(&self->edition);
    memcpy(&out->host_ns, &word[1], sizeof word[1]);
    memcpy(&out->at_ns, &word[2], sizeof word[2]);
    memcpy(&out->speed, &word[3], sizeof word[3]);
    memcpy(&out->loop_from_ns, &word[4], sizeof word[4]);
    memcpy(&out->loop_to_ns, &word[5], sizeof word[5]);
    memcpy(&out->beat_ns, &word[6], sizeof word[6]);
    out->bar = (uint32_t)(word[7] >> 32);
    out->beats = (uint32_t)word[7] >> 1;
    out->is_mute = (word[7] & 1) != 0;
    return true;
}

/* ---- the motion ---- */

static void add_one(_Atomic uint32_t *count)
{
    atomic_fetch_add_explicit(count, 1, memory_order_relaxed);
}

bool sound_motion_is_heard(const sound_motion *self)
{
    return self->revision != 0 && self->speed == 1.0 && !self->is_mute;
}

static void adopt_motion(sound_follow *self)
{
    self->motion = self->newest;
    self->window_first = self->window_end = 0;
    self->is_ending = self->is_sounding = self->is_leaving = false;
    self->is_correcting = false;
    self->fade_left = 0;
}

static void look_for_motion(sound_follow *self)
{
    /* if it fails, the next block tries again */
    (void)sound_board_read(self->board, &self->newest);
    if (sound_motion_key(&self->newest) == sound_motion_key(&self->motion))
        return;
    if (self->is_sounding)
        self->is_ending = true;
    else
        adopt_motion(self);
}

/* Returns the frame of the stream that belongs to a frame of the device. */
static double target_of(const sound_follow *self, int64_t device_frame)
{
    int64_t time_ns = sound_clock_time_ns(&self->clock, device_frame);
    return (double)(time_ns - self->motion.host_ns) * (double)self->rate_hz / 1e9;
}

/* ---- the window ---- */

static const float *frame_at(const sound_follow *self, int64_t frame)
{
    return self->window + (size_t)(frame & (SOUND_WINDOW - 1)) * self->channel_count;
}

static bool is_held(const sound_follow *self, int64_t first, int64_t count)
{
    return first >= self->window_first && first + count <= self->window_end;
}

static void drop_before(sound_follow *self, int64_t frame)
{
    if (self->window_first < frame)
        self->window_first = frame < self->window_end ? frame : self->window_end;
}

static void append_packet(sound_follow *self, const sound_packet *packet, const float *samples)
{
    size_t frame_size = self->channel_count * sizeof *samples;
    if (packet->first != self->window_end)
        self->window_first = self->window_end = packet->first;
    for (uint32_t i = 0; i < packet->count; ++i, ++self->window_end)
        memcpy(self->window + (size_t)(self->window_end & (SOUND_WINDOW - 1)) * self->channel_count,
               samples + (size_t)i * self->channel_count, frame_size);
}

/* Returns false if the packet must stay in the ring. */
static bool accept_packet(sound_follow *self, const sound_packet *packet, int64_t keep_from)
{
    const float *samples = (const float *)(const void *)(self->record + sizeof *packet);
    int64_t end = packet->first + packet->count;
    int32_t newer = (int32_t)(packet->revision - self->motion.revision);
    int32_t newer_edition = (int32_t)(packet->edition - self->motion.edition);
    if (packet->rate_hz != self->rate_hz)
        return true;
    if (newer != 0 || newer_edition != 0)
        return newer < 0 || newer_edition < 0;
    if (packet->count > SOUND_PACKET_FRAMES || end <= keep_from)
        return true;
    bool follows = packet->first == self->window_end;
    if (follows && end - self->window_first > SOUND_WINDOW)
        return false;
    append_packet(self, packet, samples);
    return true;
}

static void collect(sound_follow *self, double target)
{
    int64_t keep_from = self->is_sounding ? self->cursor : (int64_t)floor(target);
    sound_packet packet;
    keep_from -= BEHIND_FRAMES;
    drop_before(self, keep_from);
    for (uint32_t i = 0; i < 2 * SOUND_PACKETS && ring_peek(self->packets, self->record); ++i) {
        memcpy(&packet, self->record, sizeof packet);
        if (!accept_packet(self, &packet, keep_from))
            break;
        (void)ring_pop(self->packets, self->record);
    }
}

/* ---- the cursor ---- */

static void start(sound_follow *self, double target)
{
    int64_t frame = (int64_t)floor(target + 0.5);
    if (self->is_ending || !sound_motion_is_heard(&self->motion) ||
        !sound_clock_is_settled(&self->clock) || !is_held(self, frame, self->fade_frames + 1))
        return;
    self->cursor = frame;
    self->gain = 0.0f;
    self->fade_left = 0;
    self->is_sounding = true;
    self->is_leaving = self->is_correcting = false;
}

static void move_cursor(sound_follow *self, int64_t to)
{
    self->cursor_before = self->cursor;
    self->cursor = to;
    self->fade_left = self->fade_frames;
}

static void jump(sound_follow *self, double target)
{
    int64_t to = (int64_t)floor(target + 0.5);
    if (is_held(self, to, self->fade_frames + 1)) {
        move_cursor(self, to);
        add_one(&self->count.jumped);
    } else {
        self->is_leaving = true;
    }
}

static void step(sound_follow *self, double off)
{
    int64_t to = self->cursor + (off > 0.0 ? 1 : -1);
    if (!is_held(self, to, self->fade_frames + 1))
        return;
    move_cursor(self, to);
    atomic_fetch_add_explicit(&self->count.spliced, 1, memory_order_relaxed);
}

/* Makes one correction at a time, because each has its own crossfade. */
static void steer(sound_follow *self, double target)
{
    double off = target - (double)self->cursor;
    if (self->fade_left > 0 || self->is_leaving)
        return;
    if (fabs(off) > self->jump_frames) {
        jump(self, target);
        return;
    }
    if (fabs(off) > self->band_frames)
        self->is_correcting = true;
    else if (fabs(off) < 1.0)
        self->is_correcting = false;
    if (self->is_correcting)
        step(self, off);
}

/* ---- frames ---- */

static float clip(float sample)
{
    return sample > 1.0f ? 1.0f : sample < -1.0f ? -1.0f : sample;
}

static float sample_of(const sound_follow *self, uint32_t channel)
{
    float now = frame_at(self, self->cursor)[channel];
    if (self->fade_left == 0)
        return now;
    float before = (float)self->fade_left / (float)(self->fade_frames + 1);
    return before * frame_at(self, self->cursor_before)[channel] + (1.0f - before) * now;
}

/* Mixes the channels: one channel goes to the first two, several channels to one are averaged,
 * otherwise each channel goes to its own. */
static void mix(const sound_follow *self, float *out, uint32_t out_channels)
{
    float sum = 0.0f;
    if (self->channel_count == 1) {
        out[0] = clip(self->gain * sample_of(self, 0));
        if (out_channels > 1)
            out[1] = out[0];
    } else if (out_channels == 1) {
        for (uint32_t c = 0; c < self->channel_count; ++c)
            sum += sample_of(self, c);
        out[0] = clip(self->gain * sum / (float)self->channel_count);
    } else {
        for (uint32_t c = 0; c < self->channel_count && c < out_channels; ++c)
            out[c] = clip(self->gain * sample_of(self, c));
    }
}

static void fade(sound_follow *self)
{
    bool is_going =
        self->is_ending || self->is_leaving || self->window_end - self->cursor <= self->fade_frames;
    float by = 1.0f / (float)self->fade_frames;
    self->gain = is_going ? fmaxf(0.0f, self->gain - by) : fminf(1.0f, self->gain + by);
}

static void advance(sound_follow *self)
{
    self->cursor += 1;
    self->cursor_before += 1;
    self->fade_left -= self->fade_left > 0;
    if (self->is_ending && self->gain <= 0.0f) {
        adopt_motion(self);
    } else if (self->cursor >= self->window_end ||
               (self->fade_left > 0 && self->cursor_before >= self->window_end)) {
        self->is_sounding = false;
        add_one(&self->count.starved);
    } else if (self->is_leaving && self->gain <= 0.0f) {
        self->is_sounding = false;
    }
}

static void play_frame(sound_follow *self, float *out, uint32_t out_channels, double target)
{
    if (!self->is_sounding)
        start(self, target);
    if (!self->is_sounding)
        return;
    steer(self, target);
    fade(self);
    mix(self, out, out_channels);
    advance(self);
}

/* ---- blocks ---- */

static void publish_state(sound_follow *self, double target)
{
    atomic_store_explicit(&self->wanted, (int64_t)floor(target), memory_order_relaxed);
    atomic_store_explicit(&self->wanted_key, sound_motion_key(&self->motion), memory_order_release);
    atomic_store_explicit(&self->count.drift_ppb,
                          (int32_t)(sound_clock_drift_ppm(&self->clock) * 1000.0),
                          memory_order_relaxed);
    atomic_store_explicit(&self->count.is_heard, self->is_sounding, memory_order_relaxed);
}

void sound_follow_fill(sound_follow *self, float *out, uint32_t count, uint32_t out_channels,
                       int64_t time_ns, sound_break is_broken)
{
    memset(out, 0, (size_t)count * out_channels * sizeof *out);
    if (is_broken == SOUND_BROKEN) {
        add_one(&self->count.broken);
        sound_clock_break(&self->clock, self->device_frame, time_ns);
    } else {
        (void)sound_clock_block(&self->clock, self->device_frame, time_ns);
    }
    look_for_motion(self);
    uint64_t key = 0;
    double target = 0.0, pace = 1.0 + self->clock.stretch;
    for (uint32_t i = 0; i < count; ++i, target += pace) {
        /* also after a change of the motion within the block */
        if (i == 0 || sound_motion_key(&self->motion) != key) {
            key = sound_motion_key(&self->motion);
            target = target_of(self, self->device_frame + i);
            collect(self, target);
        }
        play_frame(self, out + (size_t)i * out_channels, out_channels, target);
    }
    self->device_frame += count;
    publish_state(self, target);
}

/* ---- create and destroy ---- */

size_t sound_follow_record_size(uint32_t channel_count)
{
    return sizeof(sound_packet) + (size_t)SOUND_PACKET_FRAMES * channel_count * sizeof(float);
}

mrt_result sound_follow_init(sound_follow *self, uint32_t rate_hz, uint32_t channel_count,
                             ring *packets, const sound_board *board, error *err)
{
    *self = (sound_follow){.channel_count = channel_count, .packets = packets, .board = board};
    self->record = malloc(sound_follow_record_size(channel_count));
    self->window = calloc((size_t)SOUND_WINDOW * channel_count, sizeof *self->window);
    if (self->record && self->window) {
        sound_follow_reset(self, rate_hz);
        return MRT_OK;
    }
    sound_follow_finish(self);
    return error_set(err, MRT_ERR_MEMORY, "no memory to play sound");
}

void sound_follow_finish(sound_follow *self)
{
    if (!self)
        return;
    free(self->record);
    free(self->window);
    self->record = NULL;
    self->window = NULL;
}

void sound_follow_reset(sound_follow *self, uint32_t rate_hz)
{
    if (rate_hz != self->rate_hz) {
        self->window_first = self->window_end = 0;
        self->fade_frames = (int32_t)(fade_s * (double)rate_hz) + 1;
        self->band_frames = fmax(1.5, band_s * (double)rate_hz);
        self->jump_frames = jump_s * (double)rate_hz;
        /* stored before the rate, so that no thread combines the old key with the new rate */
        atomic_store(&self->wanted_key, 0);
        atomic_store(&self->rate_hz, rate_hz);
    }
    sound_clock_init(&self->clock, (double)rate_hz);
    self->device_frame = 0;
    self->is_sounding = self->is_leaving = self->is_ending = false;
    self->fade_left = 0;
}

/* ---- the click ---- */

static const double click_s = 0.03, beat_hz = 1000.0, bar_hz = 1600.0, loudness = 0.5;
/* A beat that is later than this is skipped, after a jump or at the end of a loop. */
static const double late_ns = 5e6;

void sound_click_reset(sound_click *self, uint32_t rate_hz)
{
    sound_clock_init(&self->clock, (double)rate_hz);
    self->rate_hz = rate_hz;
    self->device_frame = 0;
    self->left = 0;
    self->beat = INT64_MIN;
}

static void look_for_beats(sound_click *self)
{
    sound_motion newest;
    if (!sound_board_read(self->board, &newest) || newest.revision == self->motion.revision)
        return;
    self->motion = newest;
    self->beat = INT64_MIN;
}

static bool is_heard(const sound_motion *motion, double since_ns)
{
    const uint32_t when = since_ns < 0.0 ? SOUND_BEATS_BEFORE : SOUND_BEATS_AFTER;
    return motion->revision != 0 && motion->speed == 1.0 && motion->beat_ns > 0.0 &&
           (motion->beats & when) != 0;
}

/* Returns the position on the timeline at a time since the start of the motion. */
static double at_of(const sound_motion *motion, double since_ns)
{
    const double at_ns = (double)motion->at_ns + since_ns;
    const double lap_ns = (double)(motion->loop_to_ns - motion->loop_from_ns);
    if (lap_ns <= 0.0 || motion->at_ns >= motion->loop_to_ns || at_ns < (double)motion->loop_to_ns)
        return at_ns;
    return (double)motion->loop_from_ns + fmod(at_ns - (double)motion->loop_to_ns, lap_ns);
}

static void begin(sound_click *self)
{
    const int64_t bar = self->motion.bar > 0 ? self->motion.bar : 1;
    const double hz = self->beat % bar == 0 ? bar_hz : beat_hz;
    self->left = (uint32_t)(click_s * (double)self->rate_hz);
    self->phase = 0.0;
    self->step = 2.0 * 3.14159265358979323846 * hz / (double)self->rate_hz;
    atomic_fetch_add_explicit(&self->count, 1, memory_order_relaxed);
}

/* Starts each click once, even if the clock of the device is corrected a little. */
static void look_for_beat(sound_click *self, double since_ns)
{
    const double at_ns = at_of(&self->motion, since_ns);
    const int64_t beat = (int64_t)floor(at_ns / self->motion.beat_ns);
    const bool is_another = beat != self->beat || at_ns < self->at_ns - late_ns;
    self->at_ns = at_ns;
    self->beat = beat;
    if (is_another && self->left == 0 && at_ns - (double)beat * self->motion.beat_ns < late_ns)
        begin(self);
}

static void add_click(sound_click *self, float *out, uint32_t channels)
{
    const double fades = (double)self->left / (click_s * (double)self->rate_hz);
    const float sample = (float)(loudness * fades * fades * sin(self->phase));
    for (uint32_t c = 0; c < channels && c < 2; ++c)
        out[c] = fminf(1.0f, fmaxf(-1.0f, out[c] + sample));
    self->phase += self->step;
    self->left -= 1;
}

void sound_click_add(sound_click *self, float *out, uint32_t count, uint32_t channels,
                     int64_t time_ns, sound_break is_broken)
{
    if (is_broken == SOUND_BROKEN)
        sound_clock_break(&self->clock, self->device_frame, time_ns);
    else
        (void)sound_clock_block(&self->clock, self->device_frame, time_ns);
    look_for_beats(self);
    const int64_t first_ns = sound_clock_time_ns(&self->clock, self->device_frame);
    const double step_ns = (1.0 + self->clock.stretch) * 1e9 / (double)self->rate_hz;
    double since_ns = (double)(first_ns - self->motion.host_ns);
    for (uint32_t i = 0; i < count; ++i, since_ns += step_ns) {
        if (is_heard(&self->motion, since_ns))
            look_for_beat(self, since_ns);
        if (self->left > 0)
            add_click(self, out + (size_t)i * channels, channels);
    }
    self->device_frame += count;
}
