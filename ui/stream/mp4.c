#include "stream/mp4.h"

#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

#define CODE(a, b, c, d) ((uint32_t)(a) << 24 | (uint32_t)(b) << 16 | (uint32_t)(c) << 8 | (d))

enum {
    BOXES_MAX = 4096, /* limit for one file; our films have a few dozen */
    DEPTH_MAX = 8
};

typedef struct box {
    uint32_t type;
    uint64_t begin, end; /* of its content in the file, bytes */
} box;

typedef struct reader {
    int fd;
    uint32_t boxes_left;
    bool has_index;
    uint32_t handler; /* of the current track */
    uint32_t samples; /* of the current track */
    mp4_facts *out;
} reader;

static bool read_at(int fd, uint64_t at, uint8_t *out, size_t size)
{
    while (size > 0) {
        const ssize_t got = pread(fd, out, size, (off_t)at);
        if (got == 0 || (got < 0 && errno != EINTR))
            return false;
        const size_t step = got > 0 ? (size_t)got : 0;
        out += step;
        at += step;
        size -= step;
    }
    return true;
}

static uint32_t number_of(const uint8_t bytes[4])
{
    return CODE(bytes[0], bytes[1], bytes[2], bytes[3]);
}

static bool read_number(const reader *self, const box *in, uint64_t offset, uint32_t *out)
{
    uint8_t bytes[4];
    if (in->end - in->begin < offset + sizeof bytes ||
        !read_at(self->fd, in->begin + offset, bytes, sizeof bytes))
        return false;
    *out = number_of(bytes);
    return true;
}

/* Reads the header of a box. Size 0 means "to the end of the file"; writers use it until they know
 * the size. */
static bool read_box(box *out, int fd, uint64_t at, uint64_t end)
{
    uint8_t head[16];
    uint64_t head_size = 8;
    if (end - at < head_size || !read_at(fd, at, head, 8))
        return false;
    uint64_t size = number_of(head);
    if (size == 1) {
        head_size = 16;
        if (end - at < head_size || !read_at(fd, at + 8, head + 8, 8))
            return false;
        size = (uint64_t)number_of(head + 8) << 32 | number_of(head + 12);
    }
    if (size < head_size || size > end - at)
        return false;
    *out = (box){.type = number_of(head + 4), .begin = at + head_size, .end = at + size};
    return true;
}

static void note_track(reader *self)
{
    if (self->handler == CODE('v', 'i', 'd', 'e'))
        self->out->picture_count += self->samples;
    self->out->has_sound |= self->handler == CODE('s', 'o', 'u', 'n') && self->samples > 0;
    self->handler = self->samples = 0;
}

static bool read_boxes(reader *self, uint64_t at, uint64_t end, int depth)
{
    box one;
    while (at < end) {
        if (self->boxes_left == 0 || depth == DEPTH_MAX || !read_box(&one, self->fd, at, end))
            return false;
        self->boxes_left -= 1;
        at = one.end;
        switch (one.type) {
        case CODE('m', 'o', 'o', 'v'):
        case CODE('t', 'r', 'a', 'k'):
        case CODE('m', 'd', 'i', 'a'):
        case CODE('m', 'i', 'n', 'f'):
        case CODE('s', 't', 'b', 'l'):
            if (!read_boxes(self, one.begin, one.end, depth + 1))
                return false;
            if (one.type == CODE('t', 'r', 'a', 'k'))
                note_track(self);
            self->has_index |= one.type == CODE('m', 'o', 'o', 'v');
            break;
        case CODE('h', 'd', 'l', 'r'): /* version and flags, pre_defined, handler_type */
            if (self->handler == 0 && !read_number(self, &one, 8, &self->handler))
                return false;
            break;
        case CODE('s', 't', 's', 'z'): /* version and flags, sample_size, sample_count */
            if (!read_number(self, &one, 8, &self->samples))
                return false;
            break;
        default:
            break;
        }
    }
    return true;
}

void mp4_read(mp4_facts *out, int fd)
{
    struct stat status;
    reader self = {.fd = fd, .boxes_left = BOXES_MAX, .out = out};
    *out = (mp4_facts){.is_complete = false};
    if (fstat(fd, &status) != 0 || status.st_size <= 0)
        return;
    out->is_complete = read_boxes(&self, 0, (uint64_t)status.st_size, 0) && self.has_index;
}
