#include "stage/sound/sound_record.h"
#include "base/clock.h"
#include "base/ring.h"
#include "stage/input/wake.h"
#include "stage/sound/sound_clock.h"
#include "show/sound_pcm.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PACKET_SAMPLES = 512, CHANNELS_MAX = 2, RING_PACKETS = 4096, SAMPLE_BYTES = 3 };
static const int64_t tick_ns = 20 * NS_PER_MS;
static const double piece_s = 0.02;
static const sound_pcm format = SOUND_PCM_S24;

typedef struct packet {
    int64_t first;   /* frame of the device */
    int64_t time_ns; /* time of the first frame; 0: not at the start of a block */
    uint32_t count;
    bool is_broken;
    float samples[PACKET_SAMPLES];
} packet;

struct sound_record {
    show *show;
    writer *writer;
    sound_threads threads;
    ring *packets;
    pthread_t thread;
    wake wake;
    bool has_thread;
    _Atomic bool is_stopping;
    /* owned by the device */
    sound_stream stream; /* of the first opening */
    int64_t device_frame;
    bool is_reopened;
    _Atomic uint32_t is_open; /* `stream` is set */
    _Atomic uint32_t peak;    /* bits of a float >= 0 */
    /* [main] */
    int64_t audio_made;
    bool has_failed; /* the row cannot be created */
    uint32_t marked_gaps;
    uint64_t marked_frames;
    int64_t marked_ns;
    /* owned by the recorder */
    sound_clock clock;
    int64_t expected; /* frame of the device */
    bool has_begun;
    unsigned char *piece;
    size_t piece_frames, piece_least, piece_room;
    int64_t piece_first; /* frame of the device */
    /* gap_ns: time of the last gap */
    _Atomic int64_t audio, first_time_ns, frame_count, gap_ns; /* gap: where the last one is */
    _Atomic uint64_t lost_frames;
    _Atomic uint32_t gap_count;
    _Atomic int32_t drift_ppb;
    pthread_mutex_t lock;
    error trouble; /* first error */
};

static void note(sound_record *self, const error *why)
{
    pthread_mutex_lock(&self->lock);
    if (!self->trouble.text[0])
        self->trouble = *why;
    pthread_mutex_unlock(&self->lock);
}

/* ---- [opener] [device] ---- */

mrt_result sound_record_opened(void *data, const sound_stream *stream, error *err)
{
    sound_record *self = data;
    if (stream->channel_count < 1 || stream->channel_count > CHANNELS_MAX || stream->rate_hz == 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "sound: '%.80s' has %u channels: only 1 or 2 can be recorded",
                         stream->name, stream->channel_count);
    if (!atomic_load(&self->is_open)) {
        self->stream = *stream;
        atomic_store(&self->is_open, 1);
        return MRT_OK;
    }
    if (stream->rate_hz != self->stream.rate_hz ||
        stream->channel_count != self->stream.channel_count)
        return error_set(
            err, MRT_ERR_UNSUPPORTED,
            "sound: '%.80s' reconnected with %u Hz and %u channels instead of %u Hz and "
            "%u: arm the microphone again",
            stream->name, stream->rate_hz, stream->channel_count, self->stream.rate_hz,
            self->stream.channel_count);
    self->is_reopened = true;
    return MRT_OK;
}

static void raise_peak(sound_record *self, const float *samples, size_t count)
{
    float peak = 0.0f;
    for (size_t i = 0; i < count; ++i)
        peak = fmaxf(peak, fabsf(samples[i]));
    uint32_t bits, before = atomic_load_explicit(&self->peak, memory_order_relaxed);
    memcpy(&bits, &peak, sizeof bits); /* floats >= 0 have the same order as their bits */
    if (bits > before)
        (void)atomic_compare_exchange_strong(&self->peak, &before, bits);
}

void sound_record_block(void *data, const sound_block *block)
{
    sound_record *self = data;
    uint32_t channels = self->stream.channel_count, room = PACKET_SAMPLES / channels;
    packet out;
    if (!block->in)
        return;
    for (uint32_t at = 0; at < block->frame_count; at += out.count) {
        out.first = self->device_frame + at;
        out.time_ns = at == 0 ? block->time_ns : 0;
        out.count = block->frame_count - at < room ? block->frame_count - at : room;
        out.is_broken = at == 0 && (block->is_broken || self->is_reopened);
        memcpy(out.samples, block->in + (size_t)at * channels,
               (size_t)out.count * channels * sizeof *out.samples);
        if (ring_push(self->packets, &out) && at == 0)
            self->is_reopened = false;
    }
    self->device_frame += block->frame_count;
    raise_peak(self, block->in, (size_t)block->frame_count * channels);
}

/* ---- [recorder] ---- */

static void count_gap(sound_record *self, double frames, int64_t time_ns)
{
    atomic_store(&self->gap_ns, time_ns);
    if (frames > 0.0 && frames < 1e15)
        atomic_fetch_add(&self->lost_frames, (uint64_t)(frames + 0.5));
    atomic_fetch_add(&self->gap_count, 1);
}

static void flush_piece(sound_record *self)
{
    error why = {""};
    if (self->piece_frames == 0)
        return;
    int64_t time_ns = sound_clock_time_ns(&self->clock, self->piece_first);
    mrt_result result =
        writer_audio(self->writer, atomic_load(&self->audio), time_ns, self->piece,
                     self->piece_frames * self->stream.channel_count * SAMPLE_BYTES, &why);
    if (result < 0) {
        count_gap(self, (double)self->piece_frames, time_ns);
        note(self, &why);
    } else {
        atomic_fetch_add(&self->frame_count, (int64_t)self->piece_frames);
    }
    self->piece_frames = 0;
}

/* Updates the clock. The current piece belongs to the clock before a jump. */
static void update_clock(sound_record *self, const packet *from)
{
    double late_ns = (double)(from->time_ns - sound_clock_time_ns(&self->clock, from->first));
    if (from->is_broken && self->clock.count > 0) {
        flush_piece(self);
        count_gap(self, late_ns / self->clock.nominal_ns, from->time_ns);
        sound_clock_break(&self->clock, from->first, from->time_ns);
        return;
    }
    sound_clock before = self->clock;
    if (!sound_clock_block(&self->clock, from->first, from->time_ns))
        return;
    sound_clock now = self->clock;
    self->clock = before;
    flush_piece(self);
    self->clock = now;
    count_gap(self, late_ns / self->clock.nominal_ns, from->time_ns);
}

static void append_packet(sound_record *self, const packet *from)
{
    uint32_t channels = self->stream.channel_count;
    if (self->has_begun && from->first != self->expected) {
        flush_piece(self);
        count_gap(self, (double)(from->first - self->expected),
                  sound_clock_time_ns(&self->clock, self->expected));
    }
    if (from->time_ns != 0)
        update_clock(self, from);
    if (self->piece_frames == 0)
        self->piece_first = from->first;
    (void)sound_pcm_pack(self->piece + self->piece_frames * channels * SAMPLE_BYTES, from->samples,
                         (size_t)from->count * channels, format);
    self->piece_frames += from->count;
    self->expected = from->first + from->count;
    self->has_begun = true;
    if (self->piece_frames + PACKET_SAMPLES > self->piece_room)
        flush_piece(self);
}

/* Returns whether the show has a row for the sound, which [main] creates before the first packet is
 * read. */
static bool is_ready(sound_record *self)
{
    packet first;
    if (atomic_load(&self->audio) != 0)
        return true;
    if (!atomic_load(&self->is_open) || !ring_peek(self->packets, &first))
        return false;
    atomic_store(&self->first_time_ns, first.time_ns != 0 ? first.time_ns : 1);
    return false;
}

static mrt_result prepare(sound_record *self)
{
    if (self->piece)
        return MRT_OK;
    sound_clock_init(&self->clock, (double)self->stream.rate_hz);
    self->piece_least = (size_t)(piece_s * (double)self->stream.rate_hz);
    self->piece_room = 2 * self->piece_least + 2 * PACKET_SAMPLES;
    self->piece = malloc(self->piece_room * self->stream.channel_count * SAMPLE_BYTES);
    return self->piece ? MRT_OK : MRT_ERR_MEMORY;
}

void sound_record_work(sound_record *self)
{
    packet next;
    if (!is_ready(self) || prepare(self) < 0)
        return;
    while (ring_pop(self->packets, &next))
        append_packet(self, &next);
    if (self->piece_frames >= self->piece_least)
        flush_piece(self);
    atomic_store(&self->drift_ppb, (int32_t)(sound_clock_drift_ppm(&self->clock) * 1000.0));
}

static void *run(void *data)
{
    sound_record *self = data;
    while (!atomic_load(&self->is_stopping)) {
        uint32_t seen = wake_seen(&self->wake);
        sound_record_work(self);
        if (!atomic_load(&self->is_stopping))
            wake_wait_until_ns(&self->wake, seen, clock_now_ns() + tick_ns);
    }
    return NULL;
}

/* ---- [main] ---- */

/* Sets a mark at a gap, at most one per second. */
static void mark_gaps(sound_record *self)
{
    char text[96];
    error why = {""};
    uint32_t count = atomic_load(&self->gap_count);
    int64_t gap_ns = atomic_load(&self->gap_ns);
    uint64_t frames = atomic_load(&self->lost_frames);
    if (count == self->marked_gaps ||
        (self->marked_gaps > 0 && gap_ns - self->marked_ns < NS_PER_S))
        return;
    snprintf(text, sizeof text, "microphone: %.3f s lost",
             (double)(frames - self->marked_frames) / (double)self->stream.rate_hz);
    if (writer_mark(self->writer, gap_ns, text, &why) < 0)
        note(self, &why);
    self->marked_gaps = count;
    self->marked_frames = frames;
    self->marked_ns = gap_ns;
}

static void make_row(sound_record *self)
{
    error why = {""};
    int64_t time_ns = atomic_load(&self->first_time_ns);
    if (self->audio_made != 0 || self->has_failed || time_ns == 0)
        return;
    show_audio audio = {.start_ns = writer_show_ns(self->writer, time_ns),
                        .rate_hz = self->stream.rate_hz,
                        .channel_count = self->stream.channel_count};
    snprintf(audio.name, sizeof audio.name, "%s", self->stream.name);
    snprintf(audio.format, sizeof audio.format, "%s", sound_pcm_name(format));
    if (show_audio_create(self->show, &audio, &self->audio_made, &why) < 0) {
        self->has_failed = true; /* reported once; the sound is not recorded */
        note(self, &why);
        return;
    }
    atomic_store(&self->audio, self->audio_made);
    wake_signal(&self->wake);
}

void sound_record_update(sound_record *self)
{
    make_row(self);
    mark_gaps(self);
}

void sound_record_read_status(sound_record *self, sound_record_status *out)
{
    uint32_t bits = atomic_exchange(&self->peak, 0);
    *out = (sound_record_status){.audio = self->audio_made,
                                 .frame_count = atomic_load(&self->frame_count),
                                 .lost_frames = atomic_load(&self->lost_frames),
                                 .gap_count = atomic_load(&self->gap_count),
                                 .drift_ppm = (double)atomic_load(&self->drift_ppb) / 1000.0};
    memcpy(&out->peak, &bits, sizeof bits);
    pthread_mutex_lock(&self->lock);
    snprintf(out->text, sizeof out->text, "%.*s", (int)sizeof out->text - 1, self->trouble.text);
    pthread_mutex_unlock(&self->lock);
}

static void stop_thread(sound_record *self)
{
    atomic_store(&self->is_stopping, true);
    wake_signal(&self->wake);
    if (self->has_thread)
        pthread_join(self->thread, NULL);
    self->has_thread = false;
}

void sound_record_end(sound_record *self)
{
    stop_thread(self);
    sound_record_work(self); /* the row may not exist yet */
    sound_record_update(self);
    sound_record_work(self);
    flush_piece(self);
    mark_gaps(self);
}

mrt_result sound_record_create(sound_record **out, show *s, writer *w, sound_threads threads,
                               error *err)
{
    *out = NULL;
    sound_record *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record sound");
    self->show = s;
    self->writer = w;
    self->threads = threads;
    pthread_mutex_init(&self->lock, NULL);
    wake_init(&self->wake);
    self->packets = ring_create(sizeof(packet), RING_PACKETS);
    self->has_thread = self->packets && threads == SOUND_OWN_THREADS &&
                       pthread_create(&self->thread, NULL, run, self) == 0;
    if (self->packets && (self->has_thread || threads == SOUND_BY_CALLER)) {
        *out = self;
        return MRT_OK;
    }
    ring_destroy(self->packets);
    pthread_mutex_destroy(&self->lock);
    free(self);
    return error_set(err, MRT_ERR_MEMORY, "no memory to record sound");
}

void sound_record_destroy(sound_record *self)
{
    if (!self)
        return;
    sound_record_end(self);
    ring_destroy(self->packets);
    pthread_mutex_destroy(&self->lock);
    free(self->piece);
    free(self);
}
