#include "trace.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LINE_BYTES = 4096, BYTES_PER_LINE = 1024 };

void trace_open(trace *self, const mrt_host *host, const char *source)
{
    *self = (trace){.file = -1};
    snprintf(self->source, sizeof self->source, "%s", source);
    const char *path = getenv("MAROTTE_TRACE");
    if (!path || path[0] == '\0')
        return;
    self->file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY, 0644);
    if (self->file >= 0)
        return;
    char text[256];
    snprintf(text, sizeof text, "MAROTTE_TRACE: cannot write %.160s: tracing is off", path);
    host->log(host, MRT_LOG_WARNING, text);
}

/* Writes each line with one call, so that lines of several threads do not mix. A full disk loses
 * lines. */
static void put(const trace *self, const char *line, size_t size)
{
    ssize_t written = write(self->file, line, size);
    (void)written;
}

static void put_bytes(const trace *self, int64_t time_ns, char way, const unsigned char *bytes,
                      size_t size)
{
    char line[LINE_BYTES];
    size_t used =
        (size_t)snprintf(line, sizeof line, "%" PRId64 " %s %c", time_ns, self->source, way);
    for (size_t i = 0; i < size; ++i)
        used += (size_t)snprintf(line + used, sizeof line - used, " %02x", bytes[i]);
    line[used++] = '\n';
    put(self, line, used);
}

static void put_transfer(const trace *self, int64_t time_ns, char way, const void *bytes,
                         size_t size)
{
    if (self->file < 0)
        return;
    const unsigned char *from = bytes;
    do {
        size_t part = size < BYTES_PER_LINE ? size : BYTES_PER_LINE;
        put_bytes(self, time_ns, way, from, part);
        from += part;
        size -= part;
    } while (size > 0);
}

void trace_sent(trace *self, int64_t time_ns, const void *bytes, size_t size)
{
    put_transfer(self, time_ns, '>', bytes, size);
}

void trace_received(trace *self, int64_t time_ns, const void *bytes, size_t size)
{
    put_transfer(self, time_ns, '<', bytes, size);
}

void trace_note(trace *self, int64_t time_ns, const char *text)
{
    if (self->file < 0)
        return;
    char line[LINE_BYTES];
    int used =
        snprintf(line, sizeof line, "%" PRId64 " %s # %.2000s\n", time_ns, self->source, text);
    put(self, line, (size_t)used);
}

void trace_close(trace *self)
{
    if (self->file >= 0)
        close(self->file);
    self->file = -1;
}
