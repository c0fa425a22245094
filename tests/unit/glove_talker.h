/* A CyberGlove for tests: answers on the master side of a pty, by the virtual clock
 * (device/virtual_clock.h), or over TCP from a thread, by the system's. It does only what the
 * plugin's tests want; tests/device has the emulator. */
#ifndef GLOVE_TALKER_H
#define GLOVE_TALKER_H
#include "device/terminal.h"
#include "device/virtual_clock.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include <pty.h>

typedef enum talker_habit {
    TALKER_GLOVE = 0,
    TALKER_SILENT,        /* never says anything */
    TALKER_OTHER_DEVICE,  /* answers every byte with "OK\r\n" */
    TALKER_HANGS_UP_ON_S, /* gone when it is asked ?S */
    TALKER_STUCK          /* says nothing until it is restarted by Ctrl-R */
} talker_habit;

typedef struct talker {
    int master, slave; /* slave: kept open, so that the pty lives between two clients */
    char path[64];
    pthread_t thread;
    _Atomic bool stopping;
    talker_habit habit;
    uint32_t sensors;        /* 18 or 22 */
    bool is_left, refuses;   /* D, T, N: as a CyberGlove II */
    bool has_status_unasked; /* adds the status byte although U is refused */
    int period_ms;
    _Atomic uint32_t hang_up_after, silent_after; /* records; 0: never */
    _Atomic unsigned char status;
    _Atomic bool is_out_of_box; /* records say so */
    _Atomic bool babbles;       /* records make no sense; until it is stopped */
    /* its state */
    int64_t next_ns; /* when it says the next record */
    char pending[256];
    size_t pending_count;
    _Atomic bool streams;
    bool streams_words, has_time, has_status;
    int listener; /* over TCP, else -1 */
    _Atomic uint32_t sent, asked_polled;
    _Atomic uint32_t restarts;
} talker;

static void talker_put(talker *self, const void *bytes, size_t size)
{
    int slave = self->listener < 0 ? open(self->path, O_RDWR | O_NOCTTY | O_NONBLOCK) : -1;
    int before = slave < 0 ? 0 : terminal_readable(slave);
    ssize_t written = write(self->master, bytes, size);
    if (slave >= 0 && written > 0)
        terminal_await(slave, before + (int)written);
    if (slave >= 0)
        close(slave);
}

static void talker_refuse(talker *self)
{
    talker_put(self, " e?\r\n", 6);
}

static void talker_record(talker *self, char head)
{
    unsigned char record[40] = {(unsigned char)head};
    size_t size = 1;
    for (uint32_t i = 0; i < self->sensors; ++i)
        record[size++] = (unsigned char)(i == 0 ? 1 + self->sent % 250 : 10 + i);
    if (self->has_time) {
        struct timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        uint32_t ticks =
            (uint32_t)((uint64_t)now.tv_sec * 115200u + (uint64_t)now.tv_nsec * 9 / 78125);
        unsigned char *stamp = record + size;
        stamp[0] = 128;
        for (uint32_t i = 0; i < 4; ++i) {
            unsigned char byte = (unsigned char)(ticks >> (8 * i));
            stamp[1 + i] = byte ? byte : 1;
            stamp[0] = (unsigned char)(stamp[0] | (byte ? 0u : 1u << i));
        }
        size += 5;
    }
    if (self->has_status || self->has_status_unasked)
        record[size++] = self->status;
    if (self->is_out_of_box) {
        record[size++] = 'e';
        record[size++] = 'g';
    }
    if (self->babbles)
        memset(record, 'x', size);
    record[size++] = 0;
    talker_put(self, record, size);
    self->sent += 1;
}

/* Of the stream of words: 1001, 1002 ... */
static void talker_words(talker *self)
{
    unsigned char frame[14 + 2 * 22 + 3];
    memcpy(frame, "10:59:07:29:3S", 14);
    size_t size = 14;
    for (uint32_t i = 0; i < self->sensors; ++i) {
        frame[size++] = (unsigned char)((1001 + i) >> 8);
        frame[size++] = (unsigned char)(1001 + i);
    }
    memcpy(frame + size, "\r\n", 3);
    talker_put(self, frame, size + 3);
    self->sent += 1;
}

/* The answer to "?LETTER" at `command`. */
static void talker_answer(talker *self, char letter)
{
    static const unsigned char mask_22[3] = {0x7f, 0xff, 0x7f}, mask_18[3] = {0x3f, 0xbb, 0x7b};
    unsigned char reply[8] = {'?', (unsigned char)letter};
    size_t size = 1;
    const unsigned char *mask = self->sensors == 22 ? mask_22 : mask_18;
    switch (letter) {
    case 'G':
        reply[2] = 3;
        break;
    case 'S':
        reply[2] = (unsigned char)self->sensors;
        break;
    case 'R':
        reply[2] = self->is_left ? 0 : 1;
        break;
    case 'K':
    case 'M':
        memcpy(reply + 2, mask, size = 3);
        break;
    case 'T':
        size = 4;
        if (!self->refuses)
            memcpy(reply + 2, "\x03\x00\x00\x01", 4); /* 768, 1 */
        break;
    default:
        talker_refuse(self);
        return;
    }
    talker_put(self, reply, size + 3);
}

/* Returns how many bytes it took; 0: more are needed. */
static size_t talker_command(talker *self, const char *c, size_t count)
{
    switch (c[0]) {
    case 0x03:
        self->streams = false;
        self->babbles = false;
        talker_put(self, "\x03", 2);
        return 1;
    case 0x12:
        self->restarts += 1;
        talker_put(self, "\x12", 2);
        return 1;
    case '?':
        if (count < 2)
            return 0;
        if (c[1] == 'S' && self->habit == TALKER_HANGS_UP_ON_S)
            self->stopping = true;
        else
            talker_answer(self, c[1]);
        return 2;
    case 'D':
    case 'U':
        if (self->refuses && (c[0] == 'D' || self->has_status_unasked)) {
            talker_refuse(self);
            return 1;
        }
        if (count < 2)
            return 0;
        *(c[0] == 'D' ? &self->has_time : &self->has_status) = c[1] == 1;
        talker_put(self, (char[]){c[0], 0}, 2);
        return 2;
    case 't': {
        const char *end = memchr(c, '\r', count);
        if (self->refuses) {
            talker_refuse(self);
            return 1;
        }
        if (!end)
            return 0;
        talker_put(self, "t", 2);
        return (size_t)(end - c) + 1;
    }
    case 'S':
        self->streams = true;
        return 1;
    case '1':
        if (count < 2)
            return 0;
        self->streams = self->streams_words = c[1] == 'S';
        return c[1] == 'S' ? 2 : count < 3 ? 0 : 3; /* "1S", "1eu" */
    case 'G':
        self->asked_polled += 1;
        talker_record(self, 'G');
        return 1;
    case '\r':
    case '\n':
        return 1;
    default:
        talker_refuse(self);
        return 1;
    }
}

static size_t talker_obey(talker *self, char *bytes, size_t count)
{
    size_t used = 0;
    if (self->habit == TALKER_STUCK && memchr(bytes, 0x12, count))
        self->habit = TALKER_GLOVE;
    if (self->habit == TALKER_SILENT || self->habit == TALKER_STUCK)
        return 0;
    if (self->habit == TALKER_OTHER_DEVICE) {
        talker_put(self, "OK\r\n", 4);
        return 0;
    }
    while (used < count && !self->stopping) {
        size_t taken = talker_command(self, bytes + used, count - used);
        if (taken == 0)
            break;
        used += taken;
    }
    memmove(bytes, bytes + used, count - used);
    return count - used;
}

static bool talker_says_records(const talker *self)
{
    return self->streams && !(self->silent_after && self->sent >= self->silent_after);
}

static void talker_say_record(talker *self)
{
    if (talker_says_records(self))
        self->streams_words ? talker_words(self) : talker_record(self, 'S');
}

static bool talker_hangs_up(const talker *self)
{
    return self->stopping || (self->hang_up_after && self->sent >= self->hang_up_after);
}

/* ---- over TCP: a thread ---- */

static void *talker_thread(void *data)
{
    talker *self = data;
    self->master = accept(self->listener, NULL, NULL);
    while (!talker_hangs_up(self)) {
        struct pollfd wanted = {.fd = self->master, .events = POLLIN};
        int ready = poll(&wanted, 1, self->period_ms);
        if (ready > 0) {
            ssize_t got = read(self->master, self->pending + self->pending_count,
                               sizeof self->pending - self->pending_count);
            if (got <= 0)
                break;
            self->pending_count =
                talker_obey(self, self->pending, self->pending_count + (size_t)got);
        } else if (ready == 0) {
            talker_say_record(self);
        }
    }
    close(self->master);
    return NULL;
}

/* ---- at a pty: as the virtual clock calls it ---- */

static void talker_hang_up_if_due(talker *self)
{
    if (self->master < 0 || !talker_hangs_up(self))
        return;
    close(self->master);
    self->master = -1;
}

static int64_t talker_due_ns(const talker *self)
{
    return self->master >= 0 && talker_says_records(self) ? self->next_ns : INT64_MAX;
}

static void talker_run(talker *self, int64_t now_ns)
{
    while (talker_due_ns(self) <= now_ns) {
        talker_say_record(self);
        self->next_ns += 1000000 * (int64_t)self->period_ms;
        talker_hang_up_if_due(self);
    }
}

static void talker_written(talker *self, int64_t now_ns, int file, size_t size)
{
    if (self->master < 0 || !terminal_is(self->path, file))
        return;
    if (size > sizeof self->pending - self->pending_count)
        size = sizeof self->pending - self->pending_count;
    size =
        terminal_receive(self->master, (unsigned char *)self->pending + self->pending_count, size);
    bool did_stream = self->streams;
    self->pending_count = talker_obey(self, self->pending, self->pending_count + size);
    if (!did_stream)
        self->next_ns = now_ns + 1000000 * (int64_t)self->period_ms;
    talker_hang_up_if_due(self);
}

static void talker_start(talker *self)
{
    self->listener = -1;
    assert_int_equal(openpty(&self->master, &self->slave, self->path, NULL, NULL), 0);
    struct termios raw;
    assert_int_equal(tcgetattr(self->slave, &raw), 0);
    cfmakeraw(&raw);
    assert_int_equal(tcsetattr(self->slave, TCSANOW, &raw), 0);
    fcntl(self->master, F_SETFL, O_NONBLOCK);
    self->period_ms = self->period_ms ? self->period_ms : 3;
    self->status = 0x81;
}

/* At 127.0.0.1, for one client; path becomes "127.0.0.1:PORT". */
__attribute__((unused)) static void talker_start_tcp(talker *self)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof at;
    self->slave = -1;
    self->listener = socket(AF_INET, SOCK_STREAM, 0);
    assert_true(self->listener >= 0);
    assert_int_equal(bind(self->listener, (const struct sockaddr *)&at, sizeof at), 0);
    assert_int_equal(listen(self->listener, 1), 0);
    assert_int_equal(getsockname(self->listener, (struct sockaddr *)&at, &size), 0);
    snprintf(self->path, sizeof self->path, "127.0.0.1:%d", (int)ntohs(at.sin_port));
    self->period_ms = 3;
    self->status = 0x81;
    assert_int_equal(pthread_create(&self->thread, NULL, talker_thread, self), 0);
}

static void talker_stop(talker *self)
{
    self->stopping = true;
    if (self->listener >= 0) {
        shutdown(self->listener, SHUT_RDWR);
        pthread_join(self->thread, NULL);
        close(self->listener);
    } else {
        talker_hang_up_if_due(self);
    }
    if (self->slave >= 0)
        close(self->slave);
}

#endif
