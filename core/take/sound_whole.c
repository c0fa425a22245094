#include "take/sound_whole.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { HEADER = 12, CHUNK = 8, CHUNKS_MAX = 1000, OGG_PAGE_MAX = 65307, OGG_HEADER = 27 };

typedef struct reader {
    int fd;
    int64_t size;
    bool is_big_endian;
} reader;

static uint32_t number_of(const reader *self, const unsigned char *b)
{
    return self->is_big_endian
               ? (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3]
               : (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static int64_t data_size(const reader *self, const unsigned char *chunk, int64_t wide_size)
{
    uint32_t size = number_of(self, chunk + 4);
    if (size == UINT32_MAX)
        return wide_size; /* RF64, or a recorder that never came to write it: 0 */
    return (int64_t)size;
}

/* The length of the sound as RF64 says it. */
static int64_t read_wide_size(const reader *self, int64_t at)
{
    unsigned char b[16];
    if (pread(self->fd, b, sizeof b, (off_t)(at + CHUNK)) != (ssize_t)sizeof b)
        return 0;
    uint64_t size = (uint64_t)number_of(self, b + 12) << 32 | number_of(self, b + 8);
    return size <= INT64_MAX / 2 ? (int64_t)size : 0;
}

static bool is_whole_riff(const reader *self, int64_t *out_promised)
{
    unsigned char chunk[CHUNK];
    int64_t at = HEADER, wide_size = 0;
    for (int i = 0; i < CHUNKS_MAX; ++i) {
        if (pread(self->fd, chunk, sizeof chunk, (off_t)at) != (ssize_t)sizeof chunk)
            return true; /* no sound in it: whoever reads it says so */
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

/* The last page says that it is the last. */
static bool is_whole_ogg(const reader *self)
{
    static unsigned char const mark[4] = {'O', 'g', 'g', 'S'};
    unsigned char tail[OGG_PAGE_MAX + OGG_HEADER];
    int64_t from = self->size > (int64_t)sizeof tail ? self->size - (int64_t)sizeof tail : 0;
    ssize_t got = pread(self->fd, tail, sizeof tail, (off_t)from);
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

bool sound_whole(int fd, int64_t *out_promised, int64_t *out_there)
{
    struct stat status;
    unsigned char head[HEADER];
    reader self = {.fd = fd};
    *out_promised = *out_there = 0;
    if (fstat(fd, &status) != 0 || pread(fd, head, sizeof head, 0) != (ssize_t)sizeof head)
        return true;
    self.size = *out_there = (int64_t)status.st_size;
    self.is_big_endian = memcmp(head, "FORM", 4) == 0 || memcmp(head, "RIFX", 4) == 0;
    if (memcmp(head, "OggS", 4) == 0)
        return is_whole_ogg(&self);
    if (memcmp(head, "RIFF", 4) == 0 || memcmp(head, "RF64", 4) == 0 || self.is_big_endian)
        return is_whole_riff(&self, out_promised);
    return true;
}
