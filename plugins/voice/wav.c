#include "wav.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

enum { FORMAT_PCM = 1, FORMAT_FLOAT = 3, FORMAT_EXTENSIBLE = 0xFFFE, CHUNKS_MAX = 1000 };
enum { RATE_LEAST_HZ = 8000, RATE_MOST_HZ = 192000 };

static uint32_t number(const unsigned char *bytes, int count)
{
    uint32_t out = 0;
    for (int i = count - 1; i >= 0; --i)
        out = out << 8 | bytes[i];
    return out;
}

/* ---- opening ---- */

/* Reads the fields of the chunk "fmt ". Returns false if the format is not one of those above. */
static bool read_format(wav *self, uint32_t size)
{
    unsigned char b[40] = {0};
    if (size < 16 || fread(b, 1, size < sizeof b ? size : sizeof b, self->file) < 16)
        return false;
    uint32_t format = number(b, 2);
    if (format == FORMAT_EXTENSIBLE && size >= 40)
        format = number(b + 24, 2);
    self->channel_count = number(b + 2, 2);
    self->rate_hz = number(b + 4, 4);
    self->sample_bytes = number(b + 14, 2) / 8;
    self->is_float = format == FORMAT_FLOAT;
    const bool is_known = self->is_float ? self->sample_bytes == 4
                                         : format == FORMAT_PCM &&
                                               (self->sample_bytes == 2 || self->sample_bytes == 3);
    return is_known && (self->channel_count == 1 || self->channel_count == 2) &&
           self->rate_hz >= RATE_LEAST_HZ && self->rate_hz <= RATE_MOST_HZ;
}

/* Finds the frames. Returns the reason why there are none; NULL: found. */
static const char *find_frames(wav *self, int64_t file_size)
{
    unsigned char head[12];
    bool has_format = false;
    if (fread(head, 1, 12, self->file) != 12 || memcmp(head, "RIFF", 4) != 0 ||
        memcmp(head + 8, "WAVE", 4) != 0)
        return "is not a WAV file";
    for (int i = 0; i < CHUNKS_MAX && fread(head, 1, 8, self->file) == 8; ++i) {
        const int64_t size = number(head + 4, 4), at = ftello(self->file);
        if (memcmp(head, "fmt ", 4) == 0) {
            has_format = read_format(self, (uint32_t)size);
            if (!has_format)
                return "has another format than mono or stereo with 16 bit, 24 bit or float";
        } else if (memcmp(head, "data", 4) == 0 && has_format) {
            const int64_t left = file_size - at, frame = self->channel_count * self->sample_bytes;
            self->frame_count = (size < left ? size : left) / frame;
            return self->frame_count > 0 ? NULL : "has no sound";
        }
        if (fseeko(self->file, at + size + size % 2, SEEK_SET) != 0)
            break;
    }
    return "has no sound";
}

bool wav_open(wav *self, const char *path, char out_reason[WAV_REASON])
{
    struct stat about;
    const char *reason = "cannot be read";
    *self = (wav){.file = fopen(path, "rbe")};
    if (self->file && fstat(fileno(self->file), &about) == 0 && S_ISREG(about.st_mode))
        reason = find_frames(self, about.st_size);
    if (reason) {
        (void)snprintf(out_reason, WAV_REASON,
                       "%.100s %s: choose a WAV file, or convert it with ffmpeg", path, reason);
        wav_close(self);
    }
    return !reason;
}

/* ---- frames ---- */

static float sample_of(const wav *self, const unsigned char *bytes)
{
    const uint32_t bits = number(bytes, (int)self->sample_bytes);
    float out;
    if (!self->is_float) /* the highest bit is the sign */
        return (float)(int32_t)(bits << (32 - 8 * self->sample_bytes)) / 2147483648.0f;
    memcpy(&out, &bits, sizeof out);
    return isfinite(out) ? fminf(fmaxf(out, -8.0f), 8.0f) : 0.0f;
}

bool wav_read(wav *self, float *out)
{
    const uint32_t frame = self->channel_count * self->sample_bytes;
    if (!self->file || self->next >= self->frame_count)
        return false;
    if (self->at + frame > self->size) {
        self->at = 0;
        self->size = (uint32_t)(fread(self->bytes, frame, WAV_FRAMES, self->file) * frame);
        if (self->size == 0)
            return false;
    }
    const unsigned char *bytes = self->bytes + self->at;
    *out = sample_of(self, bytes);
    if (self->channel_count == 2)
        *out = 0.5f * (*out + sample_of(self, bytes + self->sample_bytes));
    self->at += frame;
    self->next += 1;
    return true;
}

void wav_close(wav *self)
{
    if (self->file)
        fclose(self->file);
    self->file = NULL;
}
