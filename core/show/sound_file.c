#include "show/sound_file.h"

#include "base/file.h"
#include "show/show_file.h"
#include "show/sound_pcm.h"
#include "show/sound_render.h"
#include "base/timecode.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- checking for truncated files ---- */

enum { HEADER = 12, CHUNK = 8, CHUNKS_MAX = 1000, OGG_PAGE_MAX = 65307, OGG_HEADER = 27 };

typedef struct sound_bytes {
    int fd;
    int64_t size;
    bool is_big_endian;
} sound_bytes;

static uint32_t number_of(const sound_bytes *self, const unsigned char *b)
{
    return self->is_big_endian
               ? (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3]
               : (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static int64_t data_size(const sound_bytes *self, const unsigned char *chunk, int64_t wide_size)
{
    uint32_t size = number_of(self, chunk + 4);
    if (size == UINT32_MAX)
        return wide_size; /* 0: RF64, or a recorder did not write the size at its end */
    return (int64_t)size;
}

/* Reads the length of the sound from an RF64 header. */
static int64_t read_wide_size(const sound_bytes *self, int64_t at)
{
    unsigned char b[16];
    if (os_read_at(self->fd, b, sizeof b, at + CHUNK) != (ssize_t)sizeof b)
        return 0;
    uint64_t size = (uint64_t)number_of(self, b + 12) << 32 | number_of(self, b + 8);
    return size <= INT64_MAX / 2 ? (int64_t)size : 0;
}

static bool is_whole_riff(const sound_bytes *self, int64_t *out_promised)
{
    unsigned char chunk[CHUNK];
    int64_t at = HEADER, wide_size = 0;
    for (int i = 0; i < CHUNKS_MAX; ++i) {
        if (os_read_at(self->fd, chunk, sizeof chunk, at) != (ssize_t)sizeof chunk)
            return true; /* no sound; the later reading reports it */
        int64_t size = (int64_t)number_of(self, chunk + 4);
        if (memcmp(chunk, "ds64", 4) == 0)
            wide_size = read_wide_size(self, at);
        if (memcmp(chunk, "data", 4) == 0 || memcmp(chunk, "SSND", 4) == 0) {
            size = data_size(self, chunk, wide_size);
            *out_promised = at + CHUNK + size;
            return size == 0 || *out_promised <= self->size;
        }
        at += CHUNK + size + (size & 1);
    }
    return true;
}

/* Returns true if the last page has the end-of-stream flag. */
static bool is_whole_ogg(const sound_bytes *self)
{
    static unsigned char const mark[4] = {'O', 'g', 'g', 'S'};
    unsigned char tail[OGG_PAGE_MAX + OGG_HEADER];
    int64_t from = self->size > (int64_t)sizeof tail ? self->size - (int64_t)sizeof tail : 0;
    ssize_t got = os_read_at(self->fd, tail, sizeof tail, from);
    for (ssize_t at = got - OGG_HEADER; at >= 0; --at) {
        if (memcmp(tail + at, mark, sizeof mark) != 0 || tail[at + 4] != 0)
            continue;
        int64_t segments = tail[at + 26], end = at + OGG_HEADER + segments;
        if (end > got)
            return false;
        for (int64_t i = 0; i < segments; ++i)
            end += tail[at + OGG_HEADER + i];
        return (tail[at + 5] & 4) != 0 && end <= got;
    }
    return false;
}

/* Returns false if a file is truncated. libsndfile reads truncated files without an error. RIFF
 * (WAV), RF64 and FORM (AIFF) store their length, and Ogg marks its end. Other formats are checked
 * during decoding. `fd` is at the start of a regular file, before and after the call. If truncated,
 * *out_there of *out_promised bytes exist; *out_promised 0: unknown. */
static bool sound_whole(int fd, int64_t *out_promised, int64_t *out_there)
{
    struct stat status;
    unsigned char head[HEADER];
    sound_bytes self = {.fd = fd};
    *out_promised = *out_there = 0;
    if (fstat(fd, &status) != 0 || os_read_at(fd, head, sizeof head, 0) != (ssize_t)sizeof head)
        return true;
    self.size = *out_there = (int64_t)status.st_size;
    self.is_big_endian = memcmp(head, "FORM", 4) == 0 || memcmp(head, "RIFX", 4) == 0;
    if (memcmp(head, "OggS", 4) == 0)
        return is_whole_ogg(&self);
    if (memcmp(head, "RIFF", 4) == 0 || memcmp(head, "RF64", 4) == 0 || self.is_big_endian)
        return is_whole_riff(&self, out_promised);
    return true;
}

/* ---- reading a file ---- */

enum { CHANNELS_MAX = 64, RATE_MIN = 1000, RATE_MAX = 768000, DAY_S = 86400 };
/* Sizes of one decoded block and one stored piece. */
enum { BLOCK_SAMPLES = 65536, PIECE_BYTES = 65536 };

static bool sound_file_goes_on(const sound_file_watch *watch, double part)
{
    return !watch || !watch->goes_on || watch->goes_on(watch->data, part < 1.0 ? part : 1.0);
}

typedef struct sound_input {
    const char *path;
    int fd;
    SNDFILE *file;
    SF_INFO info;
    double *block;
    size_t block_frames;
    int64_t frame; /* next frame */
} sound_input;

static void input_finish(sound_input *self)
{
    if (self->file)
        sf_close(self->file);
    if (self->fd >= 0)
        close(self->fd);
    free(self->block);
}

static mrt_result open_regular(sound_input *self, error *err)
{
    struct stat status;
    /* O_NONBLOCK: opening a FIFO must not hang. */
    self->fd = os_open(self->path, OS_READ);
    if (self->fd < 0 || fstat(self->fd, &status) != 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", self->path, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is not a file; a sound was expected", self->path);
    if (status.st_size == 0)
        return error_set(err, MRT_ERR_FORMAT, "%s: is empty; a sound was expected", self->path);
    return MRT_OK;
}

static mrt_result check_info(const sound_input *self, error *err)
{
    const SF_INFO *info = &self->info;
    if (info->channels < 1 || info->channels > CHANNELS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: has %d channels; 1 to %d are supported",
                         self->path, info->channels, CHANNELS_MAX);
    if (info->samplerate < RATE_MIN || info->samplerate > RATE_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: has a rate of %d Hz; %d to %d are supported", self->path,
                         info->samplerate, RATE_MIN, RATE_MAX);
    if (info->frames > 0 && info->frames / info->samplerate >= DAY_S &&
        info->frames != SF_COUNT_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: is %.1f h long; at most 24 h are supported",
                         self->path, (double)info->frames / info->samplerate / 3600.0);
    return MRT_OK;
}

static mrt_result check_whole(const sound_input *self, error *err)
{
    int64_t promised, there;
    if (sound_whole(self->fd, &promised, &there))
        return MRT_OK;
    if (promised > 0)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: is truncated: it has %lld of %lld bytes; copy it again", self->path,
                         (long long)there, (long long)promised);
    return error_set(err, MRT_ERR_FORMAT, "%s: is truncated: its end is missing; copy it again",
                     self->path);
}

static mrt_result input_open(sound_input *self, const char *path, error *err)
{
    *self = (sound_input){.path = path, .fd = -1};
    mrt_result result = open_regular(self, err);
    if (result >= 0)
        result = check_whole(self, err);
    if (result < 0)
        return result;
    self->file = sf_open_fd(self->fd, SFM_READ, &self->info, SF_FALSE);
    if (!self->file) {
        char why[128];
        snprintf(why, sizeof why, "%.127s", sf_strerror(NULL));
        why[strcspn(why, "\r\n")] = '\0';
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: is not a supported sound file (%s); use WAV, FLAC or Ogg", path, why);
    }
    result = check_info(self, err);
    if (result < 0)
        return result;
    self->block_frames = (size_t)(BLOCK_SAMPLES / self->info.channels);
    self->block = malloc(BLOCK_SAMPLES * sizeof *self->block);
    return self->block ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
}

/* Reads the next frames into the block; 0: none are left. */
static mrt_result input_next(sound_input *self, size_t *out_frames, error *err)
{
    sf_count_t got = sf_readf_double(self->file, self->block, (sf_count_t)self->block_frames);
    *out_frames = got > 0 ? (size_t)got : 0;
    self->frame += (int64_t)*out_frames;
    if (self->frame / self->info.samplerate >= DAY_S)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: is longer than 24 h; cut it", self->path);
    bool is_short = *out_frames < self->block_frames && self->info.frames != SF_COUNT_MAX &&
                    self->frame < self->info.frames;
    if (is_short || sf_error(self->file) != SF_ERR_NO_ERROR)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: is truncated or damaged: only %.3f of %.3f s can be read; "
                         "copy it again",
                         self->path, (double)self->frame / self->info.samplerate,
                         (double)self->info.frames / self->info.samplerate);
    return MRT_OK;
}

static double input_part(const sound_input *self)
{
    return self->info.frames > 0 ? (double)self->frame / (double)self->info.frames : 0.0;
}

static mrt_result sample_refused(const sound_input *self, size_t frames, size_t at, error *err)
{
    double value = self->block[at];
    int64_t frame = self->frame - (int64_t)frames + (int64_t)at / self->info.channels;
    if (!isfinite(value))
        return error_set(err, MRT_ERR_FORMAT, "%s: frame %lld is not a number", self->path,
                         (long long)frame);
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "%s: frame %lld has more than 24 bits and is not a 32-bit float: it cannot be "
                     "stored exactly; save it as 24 bits or 32-bit float",
                     self->path, (long long)frame);
}

/* ---- import ---- */

/* Finds the narrowest format that keeps every sample. */
static mrt_result find_format(sound_pcm *out, const char *path, const sound_file_watch *watch,
                              error *err)
{
    sound_input in;
    size_t frames = 0, at;
    *out = SOUND_PCM_S16;
    mrt_result result = input_open(&in, path, err);
    while (result == MRT_OK) {
        result = input_next(&in, &frames, err);
        if (result < 0 || frames == 0)
            break;
        sound_pcm format =
            sound_pcm_narrowest(in.block, frames * (size_t)in.info.channels, *out, &at);
        if (format == SOUND_PCM_NONE)
            result = sample_refused(&in, frames, at, err);
        else if (!sound_file_goes_on(watch, 0.5 * input_part(&in)))
            result = MRT_END;
        *out = format;
    }
    if (result == MRT_OK && in.frame == 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: contains no sound", path);
    input_finish(&in);
    return result;
}

static mrt_result keep_block(sound_input *in, size_t frames, show *s, int64_t audio,
                             sound_pcm format, error *err)
{
    size_t channels = (size_t)in->info.channels, frame_size = channels * sound_pcm_bytes(format);
    size_t piece = PIECE_BYTES / frame_size, at;
    float samples[PIECE_BYTES / 2];
    unsigned char bytes[PIECE_BYTES];
    if (sound_pcm_narrowest(in->block, frames * channels, format, &at) != format)
        return error_set(err, MRT_ERR_FORMAT, "%s: changed while it was read", in->path);
    for (size_t first = 0; first < frames; first += piece) {
        size_t count = frames - first < piece ? frames - first : piece;
        for (size_t i = 0; i < count * channels; ++i)
            samples[i] = (float)in->block[first * channels + i];
        (void)sound_pcm_pack(bytes, samples, count * channels, format);
        mrt_result result = show_audio_write(s, audio, 0, bytes, count * frame_size, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static mrt_result keep_frames(sound_input *in, show *s, int64_t audio, sound_pcm format,
                              const sound_file_watch *watch, error *err)
{
    for (;;) {
        size_t frames;
        mrt_result result = input_next(in, &frames, err);
        if (result < 0 || frames == 0)
            return result;
        result = keep_block(in, frames, s, audio, format, err);
        if (result < 0)
            return result;
        if (!sound_file_goes_on(watch, 0.5 + 0.5 * input_part(in)))
            return MRT_END;
    }
}

/* Deletes an incomplete sound, to which nothing refers. Works in small steps, because other threads
 * write too. */
static void delete_partial(show *s, int64_t audio)
{
    error none = {""};
    mrt_result result = MRT_OK;
    int64_t left = 1;
    while (result >= 0 && left > 0) {
        result = sqlite_change(s->db, &none,
                               "DELETE FROM audio_chunk WHERE id IN "
                               "(SELECT id FROM audio_chunk WHERE audio = ? LIMIT 64)",
                               "i", audio);
        left = sqlite_changes(s->db);
    }
    if (result >= 0)
        result = sqlite_change(s->db, &none, "DELETE FROM audio WHERE id = ?", "i", audio);
    (void)result; /* the sound stays, unused by any take */
}

static void name_of(char *out, size_t capacity, const char *path)
{
    const char *slash = strrchr(path, '/');
    size_t length = strlen(slash ? slash + 1 : path);
    length = length < capacity ? length : capacity - 1;
    memcpy(out, slash ? slash + 1 : path, length);
    while (length > 0 && length == capacity - 1 && ((unsigned char)out[length - 1] & 0x80) != 0)
        length -= 1; /* not within a UTF-8 character */
    out[length] = '\0';
}

mrt_result sound_file_import(int64_t *out_audio, show *s, const char *path,
                             const sound_file_watch *watch, error *err)
{
    sound_input in = {.fd = -1};
    sound_pcm format;
    show_audio audio = {0};
    *out_audio = 0;
    mrt_result result = show_check_writable(s, err);
    if (result >= 0)
        result = find_format(&format, path, watch, err);
    if (result != MRT_OK)
        return result;
    result = input_open(&in, path, err);
    if (result < 0)
        goto done;
    audio.rate_hz = (uint32_t)in.info.samplerate;
    audio.channel_count = (uint32_t)in.info.channels;
    name_of(audio.name, sizeof audio.name, path);
    snprintf(audio.format, sizeof audio.format, "%s", sound_pcm_name(format));
    result = show_audio_create(s, &audio, &audio.id, err);
    if (result < 0)
        goto done;
    result = keep_frames(&in, s, audio.id, format, watch, err);
    if (result == MRT_OK)
        *out_audio = audio.id;
    else
        delete_partial(s, audio.id);
done:
    input_finish(&in);
    return result;
}

/* ---- writing ---- */

enum { OUT_FRAMES = 4096 };

static const int64_t start_max_ns = INT64_MAX / 2, timecode_max = 1000000000000;

typedef struct sound_output {
    sound_render *render;
    int64_t first; /* frame of the timeline at frame 0 */
    sound_pcm format;
    uint32_t channel_count;
    float *samples;
    unsigned char *bytes;
    int *integers;
    file_writer writer;
    SNDFILE *file;
} sound_output;

static void output_finish(sound_output *self)
{
    if (self->file)
        sf_close(self->file);
    file_writer_abandon(&self->writer);
    sound_render_destroy(self->render);
    free(self->samples);
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
        return error_set(err, MRT_ERR_ARGUMENT, "sound at %u Hz: expected %d to %d", what->rate_hz,
                         RATE_MIN, RATE_MAX);
    return MRT_OK;
}

/* Unchanged frames keep their format. Mixed frames need more than 16 bits. */
static sound_pcm format_of(const sound_output *self, const sound_file_export *what,
                           uint32_t rate_hz)
{
    const show_audio *audio = sound_render_audio(self->render);
    sound_pcm format = sound_pcm_of(audio->format);
    bool is_as_it_was = what->take->audio.gain == 1.0 && rate_hz == audio->rate_hz &&
                        sound_map_is_plain(sound_render_map(self->render));
    return format == SOUND_PCM_S16 && !is_as_it_was ? SOUND_PCM_S24 : format;
}

static mrt_result make_buffers(sound_output *self, error *err)
{
    size_t samples = (size_t)OUT_FRAMES * self->channel_count;
    self->samples = malloc(samples * sizeof *self->samples);
    self->bytes = malloc(samples * 4);
    self->integers = malloc(samples * sizeof *self->integers);
    if (self->samples && self->bytes && self->integers)
        return MRT_OK;
    return error_set(err, MRT_ERR_MEMORY, "no memory for sound");
}

static mrt_result prepare(sound_output *self, sound_file_report *out, show *s,
                          const sound_file_export *what, error *err)
{
    mrt_result result = check_export(what, err);
    if (result >= 0)
        result = sound_render_create(&self->render, s, &what->take->audio, what->rate_hz, err);
    if (result < 0)
        return result;
    const show_audio *audio = sound_render_audio(self->render);
    self->channel_count = out->channel_count = audio->channel_count;
    out->rate_hz = what->rate_hz ? what->rate_hz : audio->rate_hz;
    self->first = sound_render_frame(out->rate_hz, what->from_ns);
    self->format = format_of(self, what, out->rate_hz);
    snprintf(out->format, sizeof out->format, "%s", sound_pcm_name(self->format));
    out->frame_count = sound_render_frame(out->rate_hz, what->to_ns - what->from_ns);
    if (out->frame_count < 1)
        out->frame_count = 1;
    return make_buffers(self, err);
}

/* A sound of more than 4 GB needs RF64. */
static int container_of(const sound_output *self, const sound_file_report *report)
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

static void describe(sound_output *self, const sound_file_report *report,
                     const sound_file_export *what)
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
    /* A field that the container does not support is left out. */
    (void)sf_command(self->file, SFC_SET_BROADCAST_INFO, &info, (int)sizeof info);
    (void)sf_set_string(self->file, SF_STR_TITLE, name);
    (void)sf_set_string(self->file, SF_STR_DATE, date);
}

static mrt_result open_output(sound_output *self, const sound_file_report *report,
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
    /* The PEAK chunk would contain the time of writing. */
    (void)sf_command(self->file, SFC_SET_ADD_PEAK_CHUNK, NULL, SF_FALSE);
    describe(self, report, what);
    return MRT_OK;
}

/* Renders frames. Damaged parts are silent, and counted. */
static void render(sound_output *self, int64_t at, size_t count, sound_file_report *report)
{
    error why = {""};
    if (sound_render_frames(self->render, self->first + at, self->samples, count, &why) < 0)
        report->damaged_count += 1;
}

/* The integers of libsndfile are left-aligned in 32 bits in every format. */
static sf_count_t write_integers(sound_output *self, size_t count)
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

static mrt_result write_frames(sound_output *self, sound_file_report *report, const char *path,
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

static mrt_result close_output(sound_output *self, const char *path, error *err)
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
    sound_output self = {0};
    *out = (sound_file_report){0};
    mrt_result result = prepare(&self, out, s, what, err);
    if (result >= 0)
        result = open_output(&self, out, what, path, err);
    if (result >= 0)
        result = write_frames(&self, out, path, watch, err);
    if (result == MRT_OK)
        result = close_output(&self, path, err);
    output_finish(&self);
    return result;
}

/* ---- a range of a file ---- */

/* Writes frames of the file from `first` on, then silence. */
static mrt_result write_range(sound_input *in, SNDFILE *out, const char *path, int64_t first,
                              int64_t count, error *err)
{
    const size_t channels = (size_t)in->info.channels;
    int64_t written = 0;
    size_t frames = 1;
    while (written < count) {
        if (frames > 0) {
            const mrt_result result = input_next(in, &frames, err);
            if (result < 0)
                return result;
        }
        if (frames == 0)
            memset(in->block, 0, in->block_frames * channels * sizeof *in->block);
        const int64_t at = in->frame - (int64_t)frames;
        const int64_t skip = frames > 0 && first > at ? first - at : 0;
        int64_t here = (int64_t)(frames > 0 ? frames : in->block_frames) - skip;
        if (here > count - written)
            here = count - written;
        if (here <= 0)
            continue;
        if (sf_writef_double(out, in->block + (size_t)skip * channels, (sf_count_t)here) != here)
            return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", path,
                             errno ? strerror(errno) : "write error");
        written += here;
    }
    return MRT_OK;
}

mrt_result sound_file_cut(const char *out_path, const char *path, double start_s, double length_s,
                          error *err)
{
    sound_input in = {.fd = -1};
    sound_output out = {0};
    assert(start_s >= 0.0 && start_s < DAY_S && length_s >= 0.0 && length_s < 10.0 * DAY_S);
    mrt_result result = input_open(&in, path, err);
    if (result >= 0)
        result = file_writer_open(&out.writer, out_path, err);
    if (result < 0)
        goto done;
    SF_INFO info = {.samplerate = in.info.samplerate,
                    .channels = in.info.channels,
                    .format = SF_FORMAT_RF64 | SF_FORMAT_PCM_24};
    out.file = sf_open_fd(fileno(out.writer.stream), SFM_WRITE, &info, SF_FALSE);
    if (!out.file) {
        result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", out_path, sf_strerror(NULL));
        goto done;
    }
    (void)sf_command(out.file, SFC_RF64_AUTO_DOWNGRADE, NULL, SF_TRUE);
    (void)sf_command(out.file, SFC_SET_CLIPPING, NULL, SF_TRUE);
    result = write_range(&in, out.file, out_path, llround(start_s * in.info.samplerate),
                         llround(length_s * in.info.samplerate), err);
    if (result >= 0)
        result = close_output(&out, out_path, err);
done:
    output_finish(&out);
    input_finish(&in);
    return result;
}
