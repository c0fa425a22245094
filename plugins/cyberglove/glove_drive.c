#include "glove_drive.h"
#include "device_io.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static const int64_t NS_PER_MS = 1000000, NS_PER_S = 1000000000;
static const int64_t quiet_ms = 1000, stop_pause_ms = 50, poll_again_ms = 250;
static const int64_t silence_ms = 25,
                     silence_limit_ms = 100; /* a USB adapter may hold bytes for 16 ms */
/* Records that arrived before reading began are old: at most this many bytes of them are
 * discarded. */
static const size_t stale_limit = 65536;
/* For most of the transfer time of a started record, the port is not polled. */
static const int64_t nap_least_ns = 300000;

static int64_t scaled_ns(const glove_drive *self, int64_t limit_ms)
{
    return (int64_t)((double)(limit_ms * NS_PER_MS) * self->settings.patience);
}

void glove_drive_log_once(glove_drive *self, uint32_t once, int32_t level, const char *format, ...)
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

static void begin(glove_drive *self)
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

/* Discards pending bytes. With the port's old settings the system may echo them to the glove as
 * commands. */
static void discard_pending(glove_drive *self)
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
        discard_pending(self);
    }
    glove_port_close(&self->port);
}

bool glove_drive_switch(const glove_drive *self)
{
    return (self->status & GLOVE_STATUS_SWITCH) != 0;
}

/* ---- checking a record ---- */

/* Updates the status. A change of switch or light only is accepted immediately. Any other change
 * must come twice, because one damaged byte must not press a pedal. */
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

static void report_warnings(glove_drive *self, const glove_record *record)
{
    if (record->is_too_fast)
        glove_drive_log_once(self, GLOVE_LOGGED_TOO_FAST, MRT_LOG_WARNING,
                             "%.60s: the glove cannot measure at this rate: lower it",
                             self->port.name);
    bool is_out = self->status && !(self->status & GLOVE_STATUS_IN);
    if (record->is_unplugged || is_out)
        glove_drive_log_once(self, GLOVE_LOGGED_UNPLUGGED, MRT_LOG_WARNING,
                             "%.60s: the glove is not plugged into its box", self->port.name);
    if (self->clock.distrusts_stamps)
        glove_drive_log_once(
            self, GLOVE_LOGGED_STAMPS, MRT_LOG_WARNING,
            "%.60s: the glove's time stamps do not match the computer's clock: its "
            "rate is used instead",
            self->port.name);
}

/* Returns false for a record that is only counted. One "not plugged in" flag is a loose contact,
 * and its record is used. After several in a row the values are not of a hand. */
static bool accept(glove_drive *self, glove_record *record, int64_t *out_time_ns)
{
    believe_status(self, record->status);
    report_warnings(self, record);
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

/* Like glove_port_read, but into the parser. */
static int take_bytes(glove_drive *self, int64_t until_ns)
{
    unsigned char bytes[GLOVE_PARSE_BYTES];
    int got = glove_port_read(&self->port, bytes, glove_parse_room(&self->parse), until_ns);
    if (got <= 0)
        return got;
    self->arrival_ns = self->host->now_ns(self->host);
    if (self->resume_ns == 0) {
        self->bytes_since_good += (size_t)got;
        glove_parse_append(&self->parse, bytes, (size_t)got);
    }
    return got;
}

/* Discards bytes that arrived between open() and the first read(), because they were measured
 * then. */
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
    glove_error_set(&self->loss, MRT_ERR_IO, "%.160s: %s", self->port.name, reason);
    trace_note(&self->trace, device_clock_ns(), self->loss.text);
    return MRT_ERR_IO;
}

static const char *reason_of_silence(const glove_drive *self)
{
    if (self->unplugged > 1)
        return "the glove is not plugged into its box";
    if (self->bytes_since_good == 0)
        return "the glove stopped sending: is it switched off or out of range?";
    return "the glove sends invalid data: is the cable loose?";
}

static int64_t quiet_limit_ns(const glove_drive *self)
{
    int64_t limit_ns = scaled_ns(self, quiet_ms);
    int64_t periods_ns = 3 * self->unit.period_ns;
    return periods_ns > limit_ns ? periods_ns : limit_ns;
}

/* Sends Ctrl-C now, and the start command after it has taken effect (resume_ns). */
static mrt_result restart(glove_drive *self, int64_t now_ns)
{
    const char stop = GLOVE_CTRL_C;
    trace_note(&self->trace, now_ns, "no records: start command sent again");
    self->has_restarted = true;
    self->restarted_ns = now_ns;
    self->resume_ns = now_ns + scaled_ns(self, stop_pause_ms);
    return glove_port_write(&self->port, &stop, 1) ? MRT_OK : lose(self, "the port was closed");
}

/* Counts unreadable bytes as lost records. */
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
        return lose(self, "the port was closed");
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

/* ---- polling ---- */

static int64_t next_ask_ns(const glove_drive *self)
{
    return self->asked_ns +
           (self->has_asked ? scaled_ns(self, poll_again_ms) : self->unit.period_ns);
}

static mrt_result ask(glove_drive *self, int64_t now_ns)
{
    if (!self->unit.is_polled || self->resume_ns > 0 || now_ns < next_ask_ns(self))
        return MRT_OK;
    /* Keeps the polling interval, unless it was missed. */
    int64_t due_ns = next_ask_ns(self);
    bool is_late = self->has_asked || now_ns - due_ns > self->unit.period_ns;
    self->asked_ns = is_late ? now_ns : due_ns;
    self->has_asked = true;
    return glove_start_sending(&self->port, &self->unit) ? MRT_OK
                                                         : lose(self, "the port was closed");
}

/* ---- reading ---- */

/* Converts the deadline to the port's clock. */
static int64_t port_deadline_ns(const glove_drive *self, int64_t deadline_ns)
{
    int64_t now_ns = self->host->now_ns(self->host);
    int64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
    return device_clock_ns() + (left_ns < 60 * NS_PER_S ? left_ns : 60 * NS_PER_S);
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
        int64_t until_ns = device_earlier_ns(deadline_ns, next_check_ns(self));
        if (self->unit.is_polled && self->resume_ns == 0)
            until_ns = device_earlier_ns(until_ns, next_ask_ns(self));
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

/* ---- opening: from an address to a glove that sends ---- */

static const int64_t connect_limit_ms = 2000;

/* Parameters of one attempt to open a glove. */
typedef struct attempt {
    glove_drive *drive;
    const char *root;
    glove_effort effort;
    glove_error *why;
} attempt;

void glove_drive_address(const glove_found *port, char *out, size_t capacity)
{
    if (port->link[0])
        snprintf(out, capacity, "serial:%s", port->link);
    else if (port->usb_path[0])
        snprintf(out, capacity, "usb:%s", port->usb_path);
    else
        snprintf(out, capacity, "serial:%s", port->path);
}

/* ---- one port ---- */

static mrt_result start(const attempt *by)
{
    glove_drive *drive = by->drive;
    mrt_result result = glove_start(&drive->port, drive->host, &drive->settings, by->effort,
                                    &drive->unit, &drive->parse, by->why);
    if (result < 0)
        glove_drive_end(drive);
    else
        begin(drive);
    return result;
}

static mrt_result open_path(const attempt *by, const char *path)
{
    glove_drive *drive = by->drive;
    trace_note(&drive->trace, device_clock_ns(), path);
    mrt_result result =
        glove_port_open_serial(&drive->port, path, drive->settings.baud, &drive->trace, by->why);
    return result < 0 ? result : start(by);
}

static mrt_result open_tcp(const attempt *by, const char *address)
{
    glove_drive *drive = by->drive;
    int64_t limit_ns = (int64_t)((double)(connect_limit_ms * 1000000) * drive->settings.patience);
    mrt_result result = glove_port_open_tcp(&drive->port, address, device_clock_ns() + limit_ns,
                                            &drive->trace, by->why);
    return result < 0 ? result : start(by);
}

static mrt_result open_usb(const attempt *by, const char *usb_path, glove_memory *memory)
{
    if (!glove_find_usb(by->root, usb_path, &memory->port))
        return glove_error_set(by->why, MRT_ERR_IO,
                               "USB port %.60s is empty: plug the glove in there", usb_path);
    return open_path(by, memory->port.path);
}

/* ---- the first found ---- */

static void add_reason(glove_error *all, const char *reason)
{
    size_t used = strlen(all->text);
    snprintf(all->text + used, sizeof all->text - used, "%s%.300s", used ? "; " : "", reason);
}

/* Returns false, with the reason, if the port must not be used. */
static bool may_ask(const char *path, glove_error *why)
{
    char text[384];
    if (!glove_find_can_open(path)) {
        glove_find_advice(path, text, sizeof text);
        glove_error_set(why, MRT_ERR_IO, "%s: no permission: %s", path, text);
        return false;
    }
    if (glove_find_holder(path, text, sizeof text)) {
        glove_error_set(why, MRT_ERR_IO, "%s is in use by %s", path, text);
        return false;
    }
    return true;
}

static bool is_wanted_hand(const glove_drive *drive)
{
    int settings = drive->settings.hand;
    bool is_left = drive->unit.hand == MRT_LEFT;
    return settings == GLOVE_HAND_AUTO || (settings == GLOVE_HAND_LEFT) == is_left;
}

/* Checks the side. With several gloves, the side that the glove reports counts, not the requested
 * one. */
static mrt_result open_found(const attempt *by, const glove_found *port)
{
    int settings = by->drive->settings.hand;
    by->drive->settings.hand = GLOVE_HAND_AUTO;
    mrt_result result = open_path(by, port->path);
    by->drive->settings.hand = settings;
    if (result < 0 || is_wanted_hand(by->drive))
        return result;
    glove_drive_end(by->drive);
    return glove_error_set(
        by->why, MRT_ERR_UNSUPPORTED,
        "%s: this glove is for the other hand. To use it anyway, name it, as in serial:%s",
        port->path, port->path);
}

static mrt_result open_first(attempt *by, glove_memory *memory)
{
    glove_found ports[GLOVE_PORTS_MAX];
    uint32_t count = glove_find_ports(by->root, ports, GLOVE_PORTS_MAX);
    glove_error reasons = {""};
    by->effort = count > 1 ? GLOVE_JUST_ASK : GLOVE_MAY_RESTART;
    for (uint32_t i = 0; i < count; ++i) {
        if (may_ask(ports[i].path, by->why) && open_found(by, &ports[i]) == MRT_OK) {
            memory->port = ports[i];
            return MRT_OK;
        }
        add_reason(&reasons, by->why->text);
    }
    if (count == 0)
        return glove_error_set(
            by->why, MRT_ERR_IO,
            "no USB serial port found: connect the glove, or name its port, as in "
            "serial:/dev/ttyS0 or tcp:192.168.1.5:3000");
    return glove_error_set(by->why, MRT_ERR_IO, "no CyberGlove found: %s", reasons.text);
}

static mrt_result open_again(const attempt *by, glove_memory *memory)
{
    if (memory->port.usb_path[0])
        return open_usb(by, memory->port.usb_path, memory);
    return open_path(by, memory->port.path);
}

/* ---- addresses ---- */

/* Opens a port named by the user. A glove that was lost may have another port name now. */
static mrt_result open_named(const attempt *by, const char *path, bool is_again,
                             glove_memory *memory)
{
    glove_found now;
    bool is_there = glove_find_path(by->root, path, &now);
    if (!is_there && is_again && memory->port.usb_path[0])
        return open_usb(by, memory->port.usb_path, memory);
    mrt_result result = open_path(by, path);
    if (result < 0)
        return result;
    if (!is_there) {
        now = (glove_found){.likeliness = 0};
        snprintf(now.path, sizeof now.path, "%s", path);
    }
    memory->port = now;
    return MRT_OK;
}

static const char *after(const char *text, const char *prefix)
{
    size_t length = strlen(prefix);
    return strncmp(text, prefix, length) == 0 ? text + length : NULL;
}

static mrt_result open_address(attempt *by, const char *address, bool is_again,
                               glove_memory *memory)
{
    const char *rest;
    if (address[0] == '\0')
        return is_again ? open_again(by, memory) : open_first(by, memory);
    if ((rest = after(address, "tcp:")) != NULL)
        return open_tcp(by, rest);
    if ((rest = after(address, "usb:")) != NULL)
        return open_usb(by, rest, memory);
    rest = after(address, "serial:");
    const char *path = rest ? rest : address;
    if (path[0] == '/')
        return open_named(by, path, is_again, memory);
    return glove_error_set(by->why, MRT_ERR_ARGUMENT,
                           "\"%.80s\" is not the address of a glove: expected serial:/dev/ttyUSB0, "
                           "usb:1-1.4:1.0/0, tcp:192.168.1.5:3000, or nothing to look for one",
                           address);
}

mrt_result glove_drive_open(glove_drive *drive, const char *address, const char *root,
                            glove_memory *memory, glove_error *why)
{
    attempt by = {drive, root, GLOVE_MAY_RESTART, why};
    bool is_again = memory->has_had && strcmp(memory->address, address) == 0;
    mrt_result result = open_address(&by, address, is_again, memory);
    if (result < 0)
        return result;
    memory->has_had = true;
    snprintf(memory->address, sizeof memory->address, "%s", address);
    return MRT_OK;
}
