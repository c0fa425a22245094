#include "take/sound_file.h"
#include "take/show_file.h"
#include "take/sound_pcm.h"
#include "take/sound_whole.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHANNELS_MAX = 64, RATE_MIN = 1000, RATE_MAX = 768000, DAY_S = 86400 };
/* So much is decoded and kept at a time. */
enum { BLOCK_SAMPLES = 65536, PIECE_BYTES = 65536 };

bool sound_file_goes_on(const sound_file_watch *watch, double part)
{
    return !watch || !watch->goes_on || watch->goes_on(watch->data, part < 1.0 ? part : 1.0);
}

/* ---- a file that is read ---- */

typedef struct source {
    const char *path;
    int fd;
    SNDFILE *file;
    SF_INFO info;
    double *block;
    size_t block_frames;
    int64_t frame; /* that comes next */
} source;

static void source_finish(source *self)
{
    if (self->file)
        sf_close(self->file);
    if (self->fd >= 0)
        close(self->fd);
    free(self->block);
}

static mrt_result open_regular(source *self, error *err)
{
    struct stat status;
    /* O_NONBLOCK: opening a FIFO must not hang. */
    self->fd = open(self->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (self->fd < 0 || fstat(self->fd, &status) != 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", self->path, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is not a file; a sound was expected", self->path);
    if (status.st_size == 0)
        return error_set(err, MRT_ERR_FORMAT, "%s: is empty; a sound was expected", self->path);
    return MRT_OK;
}

static mrt_result check_info(const source *self, error *err)
{
    const SF_INFO *info = &self->info;
    if (info->channels < 1 || info->channels > CHANNELS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: has %d channels, 1 to %d can be kept",
                         self->path, info->channels, CHANNELS_MAX);
    if (info->samplerate < RATE_MIN || info->samplerate > RATE_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: has a rate of %d Hz, %d to %d can be kept",
                         self->path, info->samplerate, RATE_MIN, RATE_MAX);
    if (info->frames > 0 && info->frames / info->samplerate >= DAY_S &&
        info->frames != SF_COUNT_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: is %.1f h long, at most 24 h can be kept",
                         self->path, (double)info->frames / info->samplerate / 3600.0);
    return MRT_OK;
}

static mrt_result check_whole(const source *self, sound_file_cut cut, error *err)
{
    int64_t promised, there;
    if (cut == SOUND_FILE_CUT_KEEP || sound_whole(self->fd, &promised, &there))
        return MRT_OK;
    if (promised > 0)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: was cut: %lld of the %lld bytes that it says are there; copy it "
                         "again, or keep what there is",
                         self->path, (long long)there, (long long)promised);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: was cut: it has no end; copy it again, or keep what there is",
                     self->path);
}

static mrt_result source_open(source *self, const char *path, sound_file_cut cut, error *err)
{
    *self = (source){.path = path, .fd = -1};
    mrt_result result = open_regular(self, err);
    if (result >= 0)
        result = check_whole(self, cut, err);
    if (result < 0)
        return result;
    self->file = sf_open_fd(self->fd, SFM_READ, &self->info, SF_FALSE);
    if (!self->file) {
        char why[128];
        snprintf(why, sizeof why, "%.127s", sf_strerror(NULL));
        why[strcspn(why, "\r\n")] = '\0';
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: is not a sound that can be read (%s); WAV, FLAC and Ogg are", path,
                         why);
    }
    result = check_info(self, err);
    if (result < 0)
        return result;
    self->block_frames = (size_t)(BLOCK_SAMPLES / self->info.channels);
    self->block = malloc(BLOCK_SAMPLES * sizeof *self->block);
    return self->block ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
}

/* The frames that come next, into the block; 0: there are none. */
static mrt_result source_next(source *self, sound_file_cut cut, size_t *out_frames, error *err)
{
    sf_count_t got = sf_readf_double(self->file, self->block, (sf_count_t)self->block_frames);
    *out_frames = got > 0 ? (size_t)got : 0;
    self->frame += (int64_t)*out_frames;
    if (self->frame / self->info.samplerate >= DAY_S)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: is longer than 24 h; cut it", self->path);
    bool is_short = *out_frames < self->block_frames && self->info.frames != SF_COUNT_MAX &&
                    self->frame < self->info.frames;
    if ((is_short || sf_error(self->file) != SF_ERR_NO_ERROR) && cut == SOUND_FILE_CUT_REFUSE)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: was cut or is damaged: %.3f of the %.3f s that it says can be read; "
                         "copy it again, or keep what there is",
                         self->path, (double)self->frame / self->info.samplerate,
                         (double)self->info.frames / self->info.samplerate);
    return MRT_OK;
}

static double source_part(const source *self)
{
    return self->info.frames > 0 ? (double)self->frame / (double)self->info.frames : 0.0;
}

static mrt_result sample_refused(const source *self, size_t frames, size_t at, error *err)
{
    double value = self->block[at];
    int64_t frame = self->frame - (int64_t)frames + (int64_t)at / self->info.channels;
    if (!isfinite(value))
        return error_set(err, MRT_ERR_FORMAT, "%s: frame %lld is not a number", self->path,
                         (long long)frame);
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "%s: frame %lld has more than 24 bits and is no 32-bit float: it cannot be "
                     "kept as it is; save it as 24 bits or 32-bit float",
                     self->path, (long long)frame);
}

/* ---- in ---- */

/* Looks at every sample: what keeps them all? */
static mrt_result find_format(sound_pcm *out, const char *path, sound_file_cut cut,
                              const sound_file_watch *watch, error *err)
{
    source in;
    size_t frames = 0, at;
    *out = SOUND_PCM_S16;
    mrt_result result = source_open(&in, path, cut, err);
    while (result == MRT_OK) {
        result = source_next(&in, cut, &frames, err);
        if (result < 0 || frames == 0)
            break;
        sound_pcm format =
            sound_pcm_narrowest(in.block, frames * (size_t)in.info.channels, *out, &at);
        if (format == SOUND_PCM_NONE)
            result = sample_refused(&in, frames, at, err);
        else if (!sound_file_goes_on(watch, 0.5 * source_part(&in)))
            result = MRT_END;
        *out = format;
    }
    if (result == MRT_OK && in.frame == 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: has no frames of sound in it", path);
    source_finish(&in);
    return result;
}

static mrt_result keep_block(source *in, size_t frames, show *s, int64_t audio, sound_pcm format,
                             error *err)
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

static mrt_result keep_frames(source *in, show *s, int64_t audio, sound_pcm format,
                              sound_file_cut cut, const sound_file_watch *watch, error *err)
{
    for (;;) {
        size_t frames;
        mrt_result result = source_next(in, cut, &frames, err);
        if (result < 0 || frames == 0)
            return result;
        result = keep_block(in, frames, s, audio, format, err);
        if (result < 0)
            return result;
        if (!sound_file_goes_on(watch, 0.5 + 0.5 * source_part(in)))
            return MRT_END;
    }
}

/* What never became a whole sound, and nobody refers to. In small steps: others write too. */
static void take_back(show *s, int64_t audio)
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
    (void)result; /* it stays as a sound that no take has */
}

static void name_of(char *out, size_t capacity, const char *path)
{
    const char *slash = strrchr(path, '/');
    size_t length = strlen(slash ? slash + 1 : path);
    length = length < capacity ? length : capacity - 1;
    memcpy(out, slash ? slash + 1 : path, length);
    while (length > 0 && length == capacity - 1 && ((unsigned char)out[length - 1] & 0x80) != 0)
        length -= 1; /* not in the midst of a letter */
    out[length] = '\0';
}

mrt_result sound_file_import(int64_t *out_audio, show *s, const char *path, sound_file_cut cut,
                             const sound_file_watch *watch, error *err)
{
    source in = {.fd = -1};
    sound_pcm format;
    show_audio audio = {0};
    *out_audio = 0;
    mrt_result result = show_check_writable(s, err);
    if (result >= 0)
        result = find_format(&format, path, cut, watch, err);
    if (result != MRT_OK)
        return result;
    result = source_open(&in, path, cut, err);
    if (result < 0)
        goto done;
    audio.rate_hz = (uint32_t)in.info.samplerate;
    audio.channel_count = (uint32_t)in.info.channels;
    name_of(audio.name, sizeof audio.name, path);
    snprintf(audio.format, sizeof audio.format, "%s", sound_pcm_name(format));
    result = show_audio_create(s, &audio, &audio.id, err);
    if (result < 0)
        goto done;
    result = keep_frames(&in, s, audio.id, format, cut, watch, err);
    if (result == MRT_OK)
        *out_audio = audio.id;
    else
        take_back(s, audio.id);
done:
    source_finish(&in);
    return result;
}
