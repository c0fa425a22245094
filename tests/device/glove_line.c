#include "glove_line.h"

#include "base/clock.h"
#include "terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

enum { BITS_PER_BYTE = 10 }; /* start, eight, stop */

/* The link appears at its name complete, like a device node. */
static mrt_result make_link(const glove_line *line, error *err)
{
    char draft[1024];
    const char *link = line->settings.link;
    if (!link)
        return MRT_OK;
    int length = snprintf(draft, sizeof draft, "%s.%ld", link, (long)getpid());
    if (length < 0 || (size_t)length >= sizeof draft)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the path is too long", link);
    (void)unlink(draft);
    if (symlink(line->path, draft) != 0 || rename(draft, link) != 0)
        return error_set(err, MRT_ERR_IO, "%s: cannot make the link: %s", link, strerror(errno));
    return MRT_OK;
}

static mrt_result open_terminal(glove_line *line, error *err)
{
    line->master = posix_openpt(O_RDWR | O_NOCTTY);
    if (line->master < 0 || grantpt(line->master) != 0 || unlockpt(line->master) != 0)
        return error_set(err, MRT_ERR_UNSUPPORTED, "no pseudo terminal: %s", strerror(errno));
    const char *name = ptsname(line->master);
    if (!name)
        return error_set(err, MRT_ERR_IO, "the pseudo terminal has no name: %s", strerror(errno));
    snprintf(line->path, sizeof line->path, "%s", name);
    line->slave = open(line->path, O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (line->slave < 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", line->path, strerror(errno));
    struct termios settings;
    if (tcgetattr(line->slave, &settings) != 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", line->path, strerror(errno));
    if (!line->settings.is_cooked)
        cfmakeraw(&settings);
    if (tcsetattr(line->slave, TCSANOW, &settings) != 0 ||
        fcntl(line->master, F_SETFD, FD_CLOEXEC) != 0 ||
        fcntl(line->master, F_SETFL, O_NONBLOCK) != 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", line->path, strerror(errno));
    return MRT_OK;
}

mrt_result glove_line_revive(glove_line *line, error *err)
{
    mrt_result result = open_terminal(line, err);
    if (result >= 0)
        result = make_link(line, err);
    if (result < 0)
        glove_line_die(line);
    return result;
}

mrt_result glove_line_create(glove_line *out, const glove_line_settings *settings, uint32_t baud,
                             error *err)
{
    *out = (glove_line){.settings = *settings, .baud = baud, .master = -1, .slave = -1};
    out->queue = calloc(GLOVE_LINE_QUEUE, sizeof *out->queue);
    if (!out->queue)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the line");
    mrt_result result = glove_line_revive(out, err);
    if (result < 0)
        glove_line_destroy(out);
    return result;
}

void glove_line_destroy(glove_line *line)
{
    if (line->queue)
        glove_line_die(line);
    free(line->queue);
    *line = (glove_line){.master = -1, .slave = -1};
}

void glove_line_die(glove_line *line)
{
    if (line->settings.link && line->master >= 0)
        (void)unlink(line->settings.link);
    if (line->master >= 0)
        close(line->master);
    if (line->slave >= 0)
        close(line->slave);
    line->master = line->slave = -1;
    line->first = line->count = line->held_size = line->label_count = 0;
    line->free_ns = 0;
}

static speed_t speed_of(uint32_t baud)
{
    switch (baud) {
    case 9600:
        return B9600;
    case 19200:
        return B19200;
    case 38400:
        return B38400;
    case 57600:
        return B57600;
    default:
        return B115200;
    }
}

/* A terminal's two ends share their settings: this sees what the program has set. */
static bool is_baud_wrong(const glove_line *line)
{
    struct termios settings;
    return line->settings.minds_baud && tcgetattr(line->slave, &settings) == 0 &&
           cfgetospeed(&settings) != speed_of(line->baud);
}

static int64_t bytes_ns(const glove_line *line, uint32_t size)
{
    if (!line->settings.is_paced)
        return 0;
    return (int64_t)size * BITS_PER_BYTE * NS_PER_S / (int64_t)line->baud;
}

void glove_line_send(glove_line *line, const void *bytes, uint32_t size, int64_t start_ns,
                     int64_t label)
{
    uint32_t chunk = line->settings.chunk_bytes;
    if (chunk == 0 || chunk > GLOVE_LINE_BYTES)
        chunk = GLOVE_LINE_BYTES;
    if (line->free_ns < start_ns)
        line->free_ns = start_ns;
    for (uint32_t from = 0; from < size; from += chunk) {
        uint32_t part = size - from < chunk ? size - from : chunk;
        if (line->master < 0 || line->count == GLOVE_LINE_QUEUE) {
            line->lost_bytes += part;
            continue;
        }
        line->free_ns += bytes_ns(line, part);
        glove_parcel *parcel = &line->queue[(line->first + line->count++) % GLOVE_LINE_QUEUE];
        memcpy(parcel->bytes, (const uint8_t *)bytes + from, part);
        parcel->size = part;
        parcel->ready_ns = line->free_ns;
        parcel->label = from + part == size ? label : -1;
    }
}

/* The first beat of the latency timer at or after time_ns. */
static int64_t beat_after(const glove_line *line, int64_t time_ns)
{
    int64_t latency_ns = line->settings.latency_ns;
    return latency_ns == 0 ? time_ns : (time_ns + latency_ns - 1) / latency_ns * latency_ns;
}

int64_t glove_line_due_ns(const glove_line *line)
{
    int64_t due_ns = line->held_size > 0 ? line->flush_ns : INT64_MAX;
    if (line->count > 0 && line->queue[line->first].ready_ns < due_ns)
        due_ns = line->queue[line->first].ready_ns;
    return due_ns;
}

static uint32_t write_bytes(glove_line *line, uint32_t size)
{
    uint32_t done = 0;
    int before = line->settings.is_awaited ? terminal_readable(line->slave) : 0;
    while (done < size) {
        ssize_t written = write(line->master, line->held + done, size - done);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            break;
        done += (uint32_t)written;
    }
    if (line->settings.is_awaited)
        terminal_await(line->slave, before + (int)done);
    return done;
}

/* Writes the first `size` bytes of what is held. */
static void let_go(glove_line *line, uint32_t size, glove_written *on_written, void *data)
{
    if (is_baud_wrong(line))
        for (uint32_t i = 0; i < size; ++i)
            line->held[i] = (uint8_t)(0xF8u | (unsigned)line->held[i] << 3);
    int64_t time_ns = clock_now_ns();
    line->lost_bytes += size - write_bytes(line, size);
    uint32_t left = 0;
    for (uint32_t i = 0; i < line->label_count; ++i) {
        struct glove_label label = line->label[i];
        if (label.end <= size)
            on_written(data, label.label, time_ns);
        else
            line->label[left++] = (struct glove_label){label.label, label.end - size};
    }
    line->label_count = left;
    line->held_size -= size;
    memmove(line->held, line->held + size, line->held_size);
}

static void hold(glove_line *line, const glove_parcel *parcel)
{
    if (line->held_size == 0)
        line->flush_ns = beat_after(line, parcel->ready_ns);
    memcpy(line->held + line->held_size, parcel->bytes, parcel->size);
    line->held_size += parcel->size;
    if (parcel->label >= 0)
        line->label[line->label_count++] = (struct glove_label){parcel->label, line->held_size};
}

static bool is_full(const glove_line *line)
{
    return line->held_size + GLOVE_LINE_BYTES > GLOVE_LINE_HELD ||
           line->label_count == GLOVE_LINE_QUEUE;
}

/* Called late, it still does what was due in its order: what is ready only after a beat of the
 * timer does not travel with that beat's bytes. */
void glove_line_pump(glove_line *line, int64_t now_ns, glove_written *on_written, void *data)
{
    uint32_t packet = line->settings.packet_bytes;
    if (line->master < 0)
        return;
    while (line->count > 0 && line->queue[line->first].ready_ns <= now_ns) {
        const glove_parcel *next = &line->queue[line->first];
        if (line->held_size > 0 && next->ready_ns > line->flush_ns)
            let_go(line, line->held_size, on_written, data);
        hold(line, next);
        line->first = (line->first + 1) % GLOVE_LINE_QUEUE;
        line->count -= 1;
        while (packet > 0 && line->held_size >= packet)
            let_go(line, packet, on_written, data);
        if (is_full(line))
            let_go(line, line->held_size, on_written, data);
    }
    if (line->held_size > 0 && line->flush_ns <= now_ns)
        let_go(line, line->held_size, on_written, data);
}

/* What it has sent, as it is understood at this baud rate. */
static void garble(const glove_line *line, uint8_t *bytes, size_t size)
{
    if (is_baud_wrong(line))
        for (size_t i = 0; i < size; ++i)
            bytes[i] = (uint8_t)(0x80u | bytes[i] >> 1);
}

size_t glove_line_receive(glove_line *line, uint8_t *out, size_t capacity)
{
    if (line->master < 0)
        return 0;
    ssize_t size = read(line->master, out, capacity);
    if (size <= 0)
        return 0;
    garble(line, out, (size_t)size);
    return (size_t)size;
}

size_t glove_line_receive_all(glove_line *line, uint8_t *out, size_t size)
{
    size = terminal_receive(line->master, out, size);
    garble(line, out, size);
    return size;
}

bool glove_line_is_terminal(const glove_line *line, int file)
{
    return line->master >= 0 && terminal_is(line->path, file);
}
