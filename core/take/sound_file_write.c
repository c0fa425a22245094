#include "take/sound_file.h"
#include "base/file.h"
#include "take/sound_pcm.h"
#include "take/sound_rate.h"
#include "take/sound_render.h"
#include "take/timecode.h"

#include <errno.h>
#include <math.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { OUT_FRAMES = 4096, RATE_MIN = 1000, RATE_MAX = 768000, DAY_S = 86400 };

static const int64_t start_max_ns = INT64_MAX / 2, timecode_max = 1000000000000;

typedef struct sink {
    sound_render *render;
    sound_rate *rate; /* NULL: frames are not resampled */
    int64_t first;    /* frame of the timeline that is frame 0 */
    sound_pcm format;
    uint32_t channel_count;
    float *samples, *needed;
    size_t needed_frames; /* room */
    unsigned char *bytes;
    int *integers;
    file_writer writer;
    SNDFILE *file;
} sink;

static void sink_finish(sink *self)
{
    if (self->file)
        sf_close(self->file);
    file_writer_abandon(&self->writer);
    sound_render_destroy(self->render);
    sound_rate_destroy(self->rate);
    free(self->samples);
    free(self->needed);
    free(self->bytes);
    free(self->integers);
}

static mrt_result check_export(const sound_file_export *what, error *err)
{
    const take *t = what->take;
    if (t->audio.audio == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld: has no sound: attach one first",
                         (long long)t->id);
    if (what->to_ns <= what->from_ns || (double)what->to_ns - (double)what->from_ns > DAY_S * 1e9 ||
        fabs((double)what->from_ns) > 1e15)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "take %lld: sound from %.3f to %.3f s: a range of at most 24 h is expected",
            (long long)t->id, (double)what->from_ns / 1e9, (double)what->to_ns / 1e9);
    if (t->start_ns < -start_max_ns || t->start_ns > start_max_ns ||
        t->timecode_frame < -timecode_max || t->timecode_frame > timecode_max)
        return error_set(err, MRT_ERR_FORMAT, "take %lld: starts at a time that cannot be",
                         (long long)t->id);
    if (what->rate_hz != 0 && (what->rate_hz < RATE_MIN || what->rate_hz > RATE_MAX))
        return error_set(err, MRT_ERR_ARGUMENT, "sound at %u Hz: %d to %d are possible",
                         what->rate_hz, RATE_MIN, RATE_MAX);
    return MRT_OK;
}

/* Frames that are as they were keep their format; sums of them need more than 16 bits. */
static sound_pcm format_of(const sink *self, const sound_file_export *what)
{
    sound_pcm format = sound_pcm_of(sound_render_audio(self->render)->format);
    bool is_as_it_was = what->take->audio.gain == 1.0 && !self->rate &&
                        sound_map_is_plain(sound_render_map(self->render));
    return format == SOUND_PCM_S16 && !is_as_it_was ? SOUND_PCM_S24 : format;
}

static mrt_result make_buffers(sink *self, error *err)
{
    int64_t first;
    size_t samples = (size_t)OUT_FRAMES * self->channel_count;
    self->samples = malloc(samples * sizeof *self->samples);
    self->bytes = malloc(samples * 4);
    self->integers = malloc(samples * sizeof *self->integers);
    if (self->rate) {
        sound_rate_needs(self->rate, 0, OUT_FRAMES, &first, &self->needed_frames);
        self->needed_frames += 1; /* as frames fall */
        self->needed = malloc(self->needed_frames * self->channel_count * sizeof *self->needed);
    }
    if (self->samples && self->bytes && self->integers && (self->needed || !self->rate))
        return MRT_OK;
    return error_set(err, MRT_ERR_MEMORY, "no memory for sound");
}

static mrt_result prepare(sink *self, sound_file_report *out, show *s,
                          const sound_file_export *what, error *err)
{
    mrt_result result = check_export(what, err);
    if (result >= 0)
        result = sound_render_create(&self->render, s, &what->take->audio, err);
    if (result < 0)
        return result;
    const show_audio *audio = sound_render_audio(self->render);
    self->channel_count = out->channel_count = audio->channel_count;
    out->rate_hz = what->rate_hz ? what->rate_hz : audio->rate_hz;
    if (out->rate_hz != audio->rate_hz)
        result =
            sound_rate_create(&self->rate, audio->rate_hz, out->rate_hz, audio->channel_count, err);
    if (result < 0)
        return result;
    self->first = sound_render_frame(audio->rate_hz, what->from_ns);
    self->format = format_of(self, what);
    snprintf(out->format, sizeof out->format, "%s", sound_pcm_name(self->format));
    out->frame_count = sound_render_frame(out->rate_hz, what->to_ns - what->from_ns);
    if (out->frame_count < 1)
        out->frame_count = 1;
    return make_buffers(self, err);
}

/* A sound of more than 4 GB needs RF64. */
static int container_of(const sink *self, const sound_file_report *report)
{
    static const int subtype[] = {[SOUND_PCM_NONE] = 0,
                                  [SOUND_PCM_S16] = SF_FORMAT_PCM_16,
                                  [SOUND_PCM_S24] = SF_FORMAT_PCM_24,
                                  [SOUND_PCM_F32] = SF_FORMAT_FLOAT};
    int64_t bytes =
        report->frame_count * (int64_t)(self->channel_count * sound_pcm_bytes(self->format));
    int container = self->channel_count > 2 ? SF_FORMAT_WAVEX : SF_FORMAT_WAV;
    return (bytes > (int64_t)4290000000 ? SF_FORMAT_RF64 : container) | subtype[self->format];
}

static int64_t midnight_ns(const take *t, int64_t from_ns)
{
    static const int64_t day_ns = DAY_S * (int64_t)1000000000;
    int64_t since_ns = t->start_ns + from_ns;
    timecode_rate rate;
    if (t->fps > 0.0 && timecode_rate_of(&rate, t->fps, NULL) >= 0)
        since_ns = timecode_time_ns(rate, t->timecode_frame) + from_ns;
    since_ns %= day_ns;
    return since_ns < 0 ? since_ns + day_ns : since_ns;
}

static void describe(sink *self, const sound_file_report *report, const sound_file_export *what)
{
    SF_BROADCAST_INFO info;
    const take *t = what->take;
    char name[3 * TAKE_NAME + 32], date[11] = "", clock[9] = "";
    time_t second = (time_t)((t->start_ns + what->from_ns) / 1000000000);
    struct tm utc;
    memset(&info, 0, sizeof info);
    snprintf(name, sizeof name, "%s%s%s%s%s take %u", t->name, t->name[0] ? ", " : "", t->scene,
             t->scene[0] ? " " : "", t->shot, t->number);
    if (gmtime_r(&second, &utc)) {
        (void)strftime(date, sizeof date, "%Y-%m-%d", &utc);
        (void)strftime(clock, sizeof clock, "%H:%M:%S", &utc);
    }
    int64_t frames = sound_render_frame(report->rate_hz, midnight_ns(t, what->from_ns));
    snprintf(info.description, sizeof info.description, "%s", name);
    snprintf(info.originator, sizeof info.originator, "marotte");
    memcpy(info.origination_date, date, sizeof info.origination_date);
    memcpy(info.origination_time, clock, sizeof info.origination_time);
    info.time_reference_low = (uint32_t)frames;
    info.time_reference_high = (uint32_t)((uint64_t)frames >> 32);
    info.version = 1;
    /* What a container cannot say is left out. */
    (void)sf_command(self->file, SFC_SET_BROADCAST_INFO, &info, (int)sizeof info);
    (void)sf_set_string(self->file, SF_STR_TITLE, name);
    (void)sf_set_string(self->file, SF_STR_DATE, date);
}

static mrt_result open_sink(sink *self, const sound_file_report *report,
                            const sound_file_export *what, const char *path, error *err)
{
    SF_INFO info = {.samplerate = (int)report->rate_hz,
                    .channels = (int)report->channel_count,
                    .format = container_of(self, report)};
    mrt_result result = file_writer_open(&self->writer, path, err);
    if (result < 0)
        return result;
    self->file = sf_open_fd(fileno(self->writer.stream), SFM_WRITE, &info, SF_FALSE);
    if (!self->file)
        return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", path, sf_strerror(NULL));
    /* It would hold the time of writing. */
    (void)sf_command(self->file, SFC_SET_ADD_PEAK_CHUNK, NULL, SF_FALSE);
    describe(self, report, what);
    return MRT_OK;
}

/* Damage is silence, and counted. */
static void render(sink *self, int64_t at, size_t count, sound_file_report *report)
{
    error why = {""};
    int64_t first = at;
    if (self->rate)
        sound_rate_needs(self->rate, at, count, &first, &self->needed_frames);
    float *into = self->rate ? self->needed : self->samples;
    size_t frames = self->rate ? self->needed_frames : count;
    if (sound_render_frames(self->render, self->first + first, into, frames, &why) < 0)
        report->damaged_count += 1;
    if (self->rate)
        sound_rate_convert(self->rate, self->samples, at, count, self->needed);
}

/* libsndfile's integers have their sign in bit 31 whatever the format. */
static sf_count_t write_integers(sink *self, size_t count)
{
    uint32_t size = sound_pcm_bytes(self->format);
    for (size_t i = 0; i < count * self->channel_count; ++i) {
        uint32_t value = 0;
        for (uint32_t byte = 0; byte < size; ++byte)
            value |= (uint32_t)self->bytes[i * size + byte] << (8 * (4 - size + byte));
        self->integers[i] = (int)(int32_t)value;
    }
    return sf_writef_int(self->file, self->integers, (sf_count_t)count);
}

static mrt_result write_frames(sink *self, sound_file_report *report, const char *path,
                               const sound_file_watch *watch, error *err)
{
    for (int64_t at = 0; at < report->frame_count; at += OUT_FRAMES) {
        int64_t left = report->frame_count - at;
        size_t count = left < OUT_FRAMES ? (size_t)left : OUT_FRAMES;
        if (!sound_file_goes_on(watch, (double)at / (double)report->frame_count))
            return MRT_END;
        render(self, at, count, report);
        report->cut_count += (int64_t)sound_pcm_pack(self->bytes, self->samples,
                                                     count * self->channel_count, self->format);
        sf_count_t written = self->format == SOUND_PCM_F32
                                 ? sf_writef_float(self->file, self->samples, (sf_count_t)count)
                                 : write_integers(self, count);
        if (written != (sf_count_t)count)
            return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", path,
                             errno ? strerror(errno) : "write error");
    }
    report->splice_count = sound_render_splice_count(self->render);
    return MRT_OK;
}

static mrt_result close_sink(sink *self, const char *path, error *err)
{
    int failed = sf_close(self->file);
    self->file = NULL;
    if (failed)
        return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", path, sf_error_number(failed));
    return file_writer_commit(&self->writer, err);
}

mrt_result sound_file_write(sound_file_report *out, show *s, const sound_file_export *what,
                            const char *path, const sound_file_watch *watch, error *err)
{
    sink self = {0};
    *out = (sound_file_report){0};
    mrt_result result = prepare(&self, out, s, what, err);
    if (result >= 0)
        result = open_sink(&self, out, what, path, err);
    if (result >= 0)
        result = write_frames(&self, out, path, watch, err);
    if (result == MRT_OK)
        result = close_sink(&self, path, err);
    sink_finish(&self);
    return result;
}
