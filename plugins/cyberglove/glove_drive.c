#include "glove_drive.h"
#include "device_io.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static const int64_t NS_PER_MS = 1000000, NS_PER_S = 1000000000;
static const int64_t quiet_ms = 1000, stop_pause_ms = 50, poll_again_ms = 250;
static const int64_t silence_ms = 25, silence_limit_ms = 100; /* a USB adapter may wait for 16 ms */
/* Records that waited for us to begin are old: at most so many bytes of them are thrown away. */
static const size_t stale_limit = 65536;
/* A started record is waited for without looking for most of the time that its bytes take. */
static const int64_t nap_least_ns = 300000;

static int64_t scaled_ns(const glove_drive *self, int64_t limit_ms)
{
    return (int64_t)((double)(limit_ms * NS_PER_MS) * self->settings.patience);
}

void glove_drive_tell(glove_drive *self, uint32_t once, int32_t level, const char *format, ...)
{
    if (self->told & once)
        return;
    self->told |= once;
    char text[512];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    self->host->log(self->host, level, text);
}

void glove_drive_begin(glove_drive *self)
{
    const glove_unit *unit = &self->unit;
    glove_timing timing = unit->layout.has_time ? GLOVE_BY_STAMP
                          : unit->is_polled     ? GLOVE_BY_ARRIVAL
                                                : GLOVE_BY_RATE;
    glove_clock_init(&self->clock, timing, unit->is_polled ? 0 : unit->period_ns);
    self->has_read = false;
    self->has_restarted = false;
    self->is_lost = false;
    self->has_asked = false;
    self->skipped = 0;
    self->unplugged = 0;
    self->resume_ns = 0;
    self->asked_ns = 0;
    self->bytes_since_good = 0;
    self->status = 0;
    self->doubtful_status = 0;
    self->good_ns = device_clock_ns();
}

/* The port's old settings may echo: what is still coming would go back to the glove as orders. */
static void let_fall_silent(glove_drive *self)
{
    unsigned char ignored[256];
    int64_t now_ns = device_clock_ns();
    int64_t limit_ns = now_ns + silence_limit_ms * NS_PER_MS;
    while (now_ns < limit_ns && glove_port_read(&self->port, ignored, sizeof ignored,
                                                now_ns + silence_ms * NS_PER_MS) > 0)
        now_ns = device_clock_ns();
}

void glove_drive_end(glove_drive *self)
{
    const char stop = GLOVE_CTRL_C;
    if (self->port.file < 0)
        return;
    if (glove_port_write(&self->port, &stop, 1)) {
        glove_port_drain(&self->port);
        let_fall_silent(self);
    }
    glove_port_close(&self->port);
}

bool glove_drive_switch(const glove_drive *self)
{
    return (self->status & GLOVE_STATUS_SWITCH) != 0;
}

/* ---- what a record says ---- */

/* A status in which only what people switch has changed is believed at once, another when it comes
 * twice: one damaged byte must not press a pedal. */
static void believe_status(glove_drive *self, uint8_t status)
{
    uint8_t changed = status ^ self->status;
    bool is_usual = (changed & ~(GLOVE_STATUS_SWITCH | GLOVE_STATUS_LIGHT)) == 0;
    if (status == 0)
        return;
    if (is_usual || status == self->doubtful_status)
        self->status = status;
    self->doubtful_status = status;
}

static void say_complaints(glove_drive *self, const glove_record *record)
{
    if (record->is_too_fast)
        glove_drive_tell(self, GLOVE_TOLD_TOO_FAST, MRT_LOG_WARNING,
                         "%.60s: the glove cannot measure so often: lower its rate",
                         self->port.name);
    bool is_out = self->status && !(self->status & GLOVE_STATUS_IN);
    if (record->is_unplugged || is_out)
        glove_drive_tell(self, GLOVE_TOLD_UNPLUGGED, MRT_LOG_WARNING,
                         "%.60s: the glove is not plugged into its box", self->port.name);
    if (self->clock.distrusts_stamps)
        glove_drive_tell(self, GLOVE_TOLD_STAMPS, MRT_LOG_WARNING,
                         "%.60s: the glove's time stamps do not go with time: its rate is used",
                         self->port.name);
}

/* False: a record that is only counted. One complaint is a loose contact and its record is given;
 * after several in a row there is no hand in what is measured. */
static bool accept(glove_drive *self, glove_record *record, int64_t *out_time_ns)
{
    believe_status(self, record->status);
    say_complaints(self, record);
    self->has_asked = false;
    self->unplugged = record->is_unplugged ? self->unplugged + 1 : 0;
    if (self->unplugged > 1) {
        self->skipped += record->lost + 1;
        return false;
    }
    record->lost += self->skipped;
    *out_time_ns = glove_clock_time(&self->clock, record, self->arrival_ns);
    self->skipped = 0;
    self->bytes_since_good = 0;
    self->has_restarted = false;
    self->good_ns = device_clock_ns();
    return true;
}

static bool next_record(glove_drive *self, glove_record *out, int64_t *out_time_ns)
{
    while (glove_parse_next(&self->parse, out))
        if (accept(self, out, out_time_ns))
            return true;
    return false;
}

/* ---- bytes ---- */

/* As glove_port_read, into the parser. */
static int take_bytes(glove_drive *self, int64_t until_ns)
{
    unsigned char bytes[GLOVE_PARSE_BYTES];
    int got = glove_port_read(&self->port, bytes, glove_parse_room(&self->parse), until_ns);
    if (got <= 0)
        return got;
    self->arrival_ns = self->host->now_ns(self->host);
    if (self->resume_ns == 0) {
        self->bytes_since_good += (size_t)got;
        glove_parse_put(&self->parse, bytes, (size_t)got);
    }
    return got;
}

/* What piled up between open() and the first read() was measured then, not now. */
static void skip_stale(glove_drive *self)
{
    glove_record ignored;
    self->has_read = true;
    for (size_t all = 0; all < stale_limit;) {
        int got = take_bytes(self, 0);
        if (got <= 0)
            break;
        all += (size_t)got;
        while (glove_parse_next(&self->parse, &ignored))
            believe_status(self, ignored.status);
    }
    self->good_ns = device_clock_ns();
    self->bytes_since_good = 0;
}

static void nap(const glove_drive *self, int64_t until_ns)
{
    size_t missing = glove_parse_missing(&self->parse);
    int64_t nap_ns = glove_port_wire_ns(&self->port, missing) * 7 / 10;
    int64_t left_ns = until_ns - device_clock_ns();
    if (missing == 0 || nap_ns < nap_least_ns || nap_ns > left_ns || nap_ns >= NS_PER_S)
        return;
    const struct timespec wait = {.tv_nsec = (long)nap_ns};
    nanosleep(&wait, NULL);
}

/* ---- silence, garbage, loss ---- */

static mrt_result lose(glove_drive *self, const char *reason)
{
    self->is_lost = true;
    glove_why_set(&self->loss, MRT_ERR_IO, "%.160s: %s", self->port.name, reason);
    trace_note(&self->trace, device_clock_ns(), self->loss.text);
    return MRT_ERR_IO;
}

static const char *reason_of_silence(const glove_drive *self)
{
    if (self->unplugged > 1)
        return "the glove is not plugged into its box";
    if (self->bytes_since_good == 0)
        return "the glove has fallen silent: is it switched off, or out of reach?";
    return "what the glove sends makes no sense any more: is the cable loose?";
}

static int64_t quiet_limit_ns(const glove_drive *self)
{
    int64_t limit_ns = scaled_ns(self, quiet_ms);
    int64_t periods_ns = 3 * self->unit.period_ns;
    return periods_ns > limit_ns ? periods_ns : limit_ns;
}

/* Ctrl-C now, and once it has had its effect (resume_ns) the order to send again. */
static mrt_result restart(glove_drive *self, int64_t now_ns)
{
    const char stop = GLOVE_CTRL_C;
    trace_note(&self->trace, now_ns, "no records: asked to start again");
    self->has_restarted = true;
    self->restarted_ns = now_ns;
    self->resume_ns = now_ns + scaled_ns(self, stop_pause_ms);
    return glove_port_write(&self->port, &stop, 1) ? MRT_OK : lose(self, "the port is gone");
}

/* What makes no sense was records as well. */
static void count_garbage(glove_drive *self)
{
    size_t size = glove_layout_size(&self->unit.layout);
    self->skipped += (uint32_t)((self->parse.garbage + self->parse.count + size / 2) / size);
}

static mrt_result resume(glove_drive *self)
{
    self->resume_ns = 0;
    count_garbage(self);
    glove_port_flush(&self->port);
    glove_parse_restart(&self->parse);
    glove_clock_restart(&self->clock);
    self->has_asked = false;
    if (!self->unit.is_polled && !glove_start_sending(&self->port, &self->unit))
        return lose(self, "the port is gone");
    return MRT_OK;
}

static mrt_result check_silence(glove_drive *self, int64_t now_ns)
{
    int64_t limit_ns = quiet_limit_ns(self);
    if (self->resume_ns > 0)
        return now_ns >= self->resume_ns ? resume(self) : MRT_OK;
    if (!self->has_restarted)
        return now_ns - self->good_ns >= limit_ns ? restart(self, now_ns) : MRT_OK;
    if (now_ns - self->restarted_ns >= limit_ns)
        return lose(self, reason_of_silence(self));
    return MRT_OK;
}

static int64_t next_check_ns(const glove_drive *self)
{
    if (self->resume_ns > 0)
        return self->resume_ns;
    return (self->has_restarted ? self->restarted_ns : self->good_ns) + quiet_limit_ns(self);
}

/* ---- asking for each record ---- */

static int64_t next_ask_ns(const glove_drive *self)
{
    return self->asked_ns +
           (self->has_asked ? scaled_ns(self, poll_again_ms) : self->unit.period_ns);
}

static mrt_result ask(glove_drive *self, int64_t now_ns)
{
    if (!self->unit.is_polled || self->resume_ns > 0 || now_ns < next_ask_ns(self))
        return MRT_OK;
    /* Keeps the rhythm, unless it was lost. */
    int64_t due_ns = next_ask_ns(self);
    bool is_late = self->has_asked || now_ns - due_ns > self->unit.period_ns;
    self->asked_ns = is_late ? now_ns : due_ns;
    self->has_asked = true;
    return glove_start_sending(&self->port, &self->unit) ? MRT_OK : lose(self, "the port is gone");
}

/* ---- reading ---- */

/* The deadline in the time of the port. */
static int64_t port_deadline_ns(const glove_drive *self, int64_t deadline_ns)
{
    int64_t now_ns = self->host->now_ns(self->host);
    int64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
    return device_clock_ns() + (left_ns < 60 * NS_PER_S ? left_ns : 60 * NS_PER_S);
}

static int64_t earliest(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static mrt_result read_until(glove_drive *self, int64_t deadline_ns, glove_record *out_record,
                             int64_t *out_time_ns)
{
    for (;;) {
        if (next_record(self, out_record, out_time_ns))
            return MRT_OK;
        int64_t now_ns = device_clock_ns();
        mrt_result result = ask(self, now_ns);
        if (result < 0)
            return result;
        int64_t until_ns = earliest(deadline_ns, next_check_ns(self));
        if (self->unit.is_polled && self->resume_ns == 0)
            until_ns = earliest(until_ns, next_ask_ns(self));
        int got = take_bytes(self, until_ns);
        if (got < 0)
            return lose(self, "the glove was unplugged, or its adapter");
        if (got > 0 && next_record(self, out_record, out_time_ns))
            return MRT_OK;
        now_ns = device_clock_ns();
        result = check_silence(self, now_ns);
        if (result < 0)
            return result;
        if (now_ns >= deadline_ns)
            return MRT_TIMEOUT;
        if (got > 0)
            nap(self, until_ns);
    }
}

mrt_result glove_drive_read(glove_drive *self, int64_t deadline_ns, glove_record *out_record,
                            int64_t *out_time_ns)
{
    if (!self->has_read)
        skip_stale(self);
    return read_until(self, port_deadline_ns(self, deadline_ns), out_record, out_time_ns);
}
