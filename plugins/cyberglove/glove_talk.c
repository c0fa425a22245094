#include "glove_talk.h"

#include <string.h>

static const int64_t NS_PER_MS = 1000000;
/* How long a wait may take before the host is asked whether it is stopping. */
static const int64_t slice_ns = 50000000;
static const int64_t settle_quiet_ms = 40, settle_most_ms = 200;

void glove_talk_init(glove_talk *self, glove_port *port, const mrt_host *host, double patience,
                     int64_t limit_ms)
{
    *self = (glove_talk){.port = port, .host = host, .patience = patience};
    self->deadline_ns = INT64_MAX;
    self->deadline_ns = glove_talk_until(self, limit_ms);
}

int64_t glove_talk_until(const glove_talk *self, int64_t limit_ms)
{
    int64_t limit_ns = (int64_t)((double)(limit_ms * NS_PER_MS) * self->patience);
    int64_t until_ns = glove_port_now_ns() + limit_ns;
    return until_ns < self->deadline_ns ? until_ns : self->deadline_ns;
}

bool glove_talk_goes_on(const glove_talk *self)
{
    return !self->is_gone && !self->is_stopping && glove_port_now_ns() < self->deadline_ns;
}

void glove_talk_say(glove_talk *self, const void *bytes, size_t size)
{
    if (!self->is_gone && !glove_port_write(self->port, bytes, size))
        self->is_gone = true;
}

/* A host that stops returns before the time is up. */
static void look_for_stop(glove_talk *self)
{
    int64_t soon_ns = self->host->now_ns(self->host) + NS_PER_MS;
    if (self->host->wait_until_ns(self->host, soon_ns) < soon_ns)
        self->is_stopping = true;
}

static void remember(glove_talk *self, const unsigned char *bytes, size_t count)
{
    size_t room = GLOVE_HEARD_MAX - self->heard_count;
    if (count > room) {
        size_t dropped = count - room;
        memmove(self->heard, self->heard + dropped, self->heard_count - dropped);
        self->heard_count -= dropped;
    }
    memcpy(self->heard + self->heard_count, bytes, count);
    self->heard_count += count;
    self->heard_ever += count;
}

size_t glove_talk_hear(glove_talk *self, int64_t until_ns)
{
    unsigned char bytes[256];
    while (!self->is_gone && !self->is_stopping) {
        int64_t now_ns = glove_port_now_ns();
        bool is_last = until_ns - now_ns <= slice_ns;
        int got = glove_port_read(self->port, bytes, sizeof bytes,
                                  is_last ? until_ns : now_ns + slice_ns);
        if (got < 0)
            self->is_gone = true;
        if (got > 0) {
            remember(self, bytes, (size_t)got);
            return (size_t)got;
        }
        if (glove_port_now_ns() >= until_ns)
            return 0;
        look_for_stop(self);
    }
    return 0;
}

bool glove_talk_listen(glove_talk *self, int64_t limit_ms)
{
    int64_t until_ns = glove_talk_until(self, limit_ms);
    while (glove_talk_goes_on(self) && glove_port_now_ns() < until_ns)
        glove_talk_hear(self, until_ns);
    return glove_talk_goes_on(self);
}

void glove_talk_settle(glove_talk *self)
{
    int64_t most_ns = glove_talk_until(self, settle_most_ms);
    while (glove_talk_goes_on(self) && glove_port_now_ns() < most_ns)
        if (glove_talk_hear(self, glove_talk_until(self, settle_quiet_ms)) == 0)
            break;
    self->heard_count = 0;
}

/* Each byte of an order that the glove does not know may be refused on its own. */
static glove_reply conclude(glove_talk *self, glove_reply reply)
{
    if (reply == GLOVE_REFUSED)
        glove_talk_settle(self);
    return reply;
}

glove_reply glove_talk_ask(glove_talk *self, char letter, unsigned char *out_value,
                           size_t value_size, int64_t limit_ms)
{
    int64_t until_ns = glove_talk_until(self, limit_ms);
    const char question[2] = {'?', letter};
    self->heard_count = 0;
    glove_talk_say(self, question, sizeof question);
    glove_reply reply = GLOVE_SILENT;
    while (reply == GLOVE_SILENT && glove_talk_goes_on(self) && glove_port_now_ns() < until_ns)
        if (glove_talk_hear(self, until_ns) > 0)
            reply =
                glove_reply_value(self->heard, self->heard_count, letter, out_value, value_size);
    return conclude(self, reply);
}

glove_reply glove_talk_order(glove_talk *self, const void *bytes, size_t size, char letter,
                             int64_t limit_ms)
{
    int64_t until_ns = glove_talk_until(self, limit_ms);
    self->heard_count = 0;
    glove_talk_say(self, bytes, size);
    glove_reply reply = GLOVE_SILENT;
    while (reply == GLOVE_SILENT && glove_talk_goes_on(self) && glove_port_now_ns() < until_ns)
        if (glove_talk_hear(self, until_ns) > 0)
            reply = glove_reply_done(self->heard, self->heard_count, letter);
    return conclude(self, reply);
}
