#include "glove_port.h"

#include <errno.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { EMPTY_READS_MAX = 3, BITS_PER_BYTE = 10 };
static const int64_t NS_PER_S = 1000000000, NS_PER_MS = 1000000;
static const int64_t write_limit_ns = 250000000, drain_limit_ns = 100000000;
static const size_t flush_limit = 65536;

int64_t glove_port_now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

/* Rounded up, so that a wait that is over is over; a minute at most. */
static int poll_ms(int64_t wait_ns)
{
    if (wait_ns <= 0)
        return 0;
    if (wait_ns > 60 * NS_PER_S)
        wait_ns = 60 * NS_PER_S;
    return (int)((wait_ns + NS_PER_MS - 1) / NS_PER_MS);
}

/* revents; 0: nothing before the deadline; -1: error. */
static int wait_for(const glove_port *self, short events, int64_t deadline_ns)
{
    for (;;) {
        struct pollfd wanted = {.fd = self->file, .events = events};
        int64_t now_ns = glove_port_now_ns();
        int ready = poll(&wanted, 1, poll_ms(deadline_ns - now_ns));
        if (ready > 0)
            return wanted.revents;
        if (ready < 0 && errno != EINTR)
            return -1;
        if (glove_port_now_ns() >= deadline_ns)
            return 0;
    }
}

/* What a read without bytes means. A port that is ready and has none, again and again, is gone. */
static int without_bytes(glove_port *self, ssize_t got, int ready)
{
    bool would_wait = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
    if (ready & (POLLHUP | POLLERR | POLLNVAL))
        return -1;
    if (got < 0 && !would_wait)
        return -1;
    if (got == 0 && self->baud == 0)
        return -1;
    self->empty_reads += 1;
    return self->empty_reads > EMPTY_READS_MAX ? -1 : 0;
}

int glove_port_read(glove_port *self, unsigned char *out, size_t capacity, int64_t deadline_ns)
{
    if (self->file < 0)
        return -1;
    int ready = wait_for(self, POLLIN, deadline_ns);
    if (ready == 0)
        return 0;
    if (ready < 0)
        return -1;
    ssize_t got = read(self->file, out, capacity);
    if (got <= 0)
        return without_bytes(self, got, ready);
    self->empty_reads = 0;
    trace_received(self->trace, glove_port_now_ns(), out, (size_t)got);
    return (int)got;
}

/* A peer that has gone must not end the program with SIGPIPE. */
static ssize_t send_some(const glove_port *self, const unsigned char *bytes, size_t size)
{
    return self->baud == 0 ? send(self->file, bytes, size, MSG_NOSIGNAL)
                           : write(self->file, bytes, size);
}

bool glove_port_write(glove_port *self, const void *bytes, size_t size)
{
    if (self->file < 0)
        return false;
    const unsigned char *from = bytes;
    trace_sent(self->trace, glove_port_now_ns(), bytes, size);
    int64_t deadline_ns = glove_port_now_ns() + write_limit_ns;
    while (size > 0) {
        int ready = wait_for(self, POLLOUT, deadline_ns);
        if (ready <= 0 || !(ready & POLLOUT))
            return false;
        ssize_t sent = send_some(self, from, size);
        if (sent < 0 && errno != EAGAIN && errno != EINTR)
            return false;
        if (sent > 0) {
            from += sent;
            size -= (size_t)sent;
        } else if (glove_port_now_ns() >= deadline_ns) {
            return false;
        }
    }
    return true;
}

void glove_port_flush(glove_port *self)
{
    if (self->file < 0)
        return;
    if (self->baud > 0) {
        tcflush(self->file, TCIOFLUSH);
        return;
    }
    unsigned char bytes[512];
    for (size_t all = 0; all < flush_limit;) {
        ssize_t got = recv(self->file, bytes, sizeof bytes, MSG_DONTWAIT);
        if (got <= 0)
            return;
        all += (size_t)got;
    }
}

void glove_port_drain(const glove_port *self)
{
    if (self->file < 0 || self->baud == 0)
        return;
    int64_t deadline_ns = glove_port_now_ns() + drain_limit_ns;
    int waiting = 0;
    while (ioctl(self->file, TIOCOUTQ, &waiting) == 0 && waiting > 0 &&
           glove_port_now_ns() < deadline_ns) {
        const struct timespec moment = {.tv_nsec = NS_PER_MS};
        nanosleep(&moment, NULL);
    }
}

int64_t glove_port_wire_ns(const glove_port *self, size_t bytes)
{
    return self->baud > 0 ? (int64_t)bytes * BITS_PER_BYTE * NS_PER_S / self->baud : 0;
}

void glove_port_close(glove_port *self)
{
    if (self->file < 0)
        return;
    if (self->baud > 0) {
        /* Bytes that nobody takes would hold up close() for half a minute. */
        int waiting = 0;
        bool is_stuck = ioctl(self->file, TIOCOUTQ, &waiting) == 0 && waiting > 0;
        tcflush(self->file, is_stuck ? TCIOFLUSH : TCIFLUSH);
        if (self->has_before)
            tcsetattr(self->file, TCSANOW, &self->before);
        if (self->is_exclusive)
            ioctl(self->file, TIOCNXCL);
    }
    close(self->file);
    self->file = -1;
}
