#include "glove_start.h"
#include "device_io.h"

#include <stdio.h>
#include <string.h>

/* ---- questions and commands: each has its own time limit, and all share one; cancelled when the
 * host stops ---- */

enum { HEARD_MAX = 1024 };

typedef struct glove_talk {
    glove_port *port;
    const mrt_host *host;
    double patience;     /* factor for all timeouts */
    int64_t deadline_ns; /* of the whole start-up; device_clock_ns */
    bool is_gone, is_stopping;
    unsigned char heard[HEARD_MAX]; /* bytes since the last question; the newest ones if full */
    size_t heard_count, heard_ever;
} glove_talk;

static const int64_t NS_PER_MS = 1000000;
/* Longest wait before checking whether the host is stopping. */
static const int64_t slice_ns = 50000000;
static const int64_t settle_quiet_ms = 40, settle_most_ms = 200;

static int64_t talk_until(const glove_talk *self, int64_t limit_ms)
{
    int64_t limit_ns = (int64_t)((double)(limit_ms * NS_PER_MS) * self->patience);
    int64_t until_ns = device_clock_ns() + limit_ns;
    return until_ns < self->deadline_ns ? until_ns : self->deadline_ns;
}

static void talk_init(glove_talk *self, glove_port *port, const mrt_host *host, double patience,
                      int64_t limit_ms)
{
    *self = (glove_talk){.port = port, .host = host, .patience = patience};
    self->deadline_ns = INT64_MAX;
    self->deadline_ns = talk_until(self, limit_ms);
}

/* Returns true while the start-up can continue: port open, host running, time left. */
static bool can_continue(const glove_talk *self)
{
    return !self->is_gone && !self->is_stopping && device_clock_ns() < self->deadline_ns;
}

static void talk_say(glove_talk *self, const void *bytes, size_t size)
{
    if (!self->is_gone && !glove_port_write(self->port, bytes, size))
        self->is_gone = true;
}

/* The wait of a stopping host returns early. */
static void look_for_stop(glove_talk *self)
{
    int64_t soon_ns = self->host->now_ns(self->host) + NS_PER_MS;
    if (self->host->wait_until_ns(self->host, soon_ns) < soon_ns)
        self->is_stopping = true;
}

static void remember(glove_talk *self, const unsigned char *bytes, size_t count)
{
    size_t room = HEARD_MAX - self->heard_count;
    if (count > room) {
        size_t dropped = count - room;
        memmove(self->heard, self->heard + dropped, self->heard_count - dropped);
        self->heard_count -= dropped;
    }
    memcpy(self->heard + self->heard_count, bytes, count);
    self->heard_count += count;
    self->heard_ever += count;
}

/* Receives until bytes arrive or the time is over. Returns their number. */
static size_t talk_receive(glove_talk *self, int64_t until_ns)
{
    unsigned char bytes[256];
    while (!self->is_gone && !self->is_stopping) {
        int64_t now_ns = device_clock_ns();
        bool is_last = until_ns - now_ns <= slice_ns;
        int got = glove_port_read(self->port, bytes, sizeof bytes,
                                  is_last ? until_ns : now_ns + slice_ns);
        if (got < 0)
            self->is_gone = true;
        if (got > 0) {
            remember(self, bytes, (size_t)got);
            return (size_t)got;
        }
        if (device_clock_ns() >= until_ns)
            return 0;
        look_for_stop(self);
    }
    return 0;
}

/* Receives for this time. Returns false if the start-up must end. */
static bool talk_listen(glove_talk *self, int64_t limit_ms)
{
    int64_t until_ns = talk_until(self, limit_ms);
    while (can_continue(self) && device_clock_ns() < until_ns)
        talk_receive(self, until_ns);
    return can_continue(self);
}

/* Receives until nothing arrives for 40 ms, at most 200 ms, and discards the bytes. */
static void talk_settle(glove_talk *self)
{
    int64_t most_ns = talk_until(self, settle_most_ms);
    while (can_continue(self) && device_clock_ns() < most_ns)
        if (talk_receive(self, talk_until(self, settle_quiet_ms)) == 0)
            break;
    self->heard_count = 0;
}

/* The glove may reject each byte of an unknown command separately. */
static glove_reply conclude(glove_talk *self, glove_reply reply)
{
    if (reply == GLOVE_REFUSED)
        talk_settle(self);
    return reply;
}

/* Sends "?LETTER". Waits for all bytes of a rejection. */
static glove_reply talk_ask(glove_talk *self, char letter, unsigned char *out_value,
                            size_t value_size, int64_t limit_ms)
{
    int64_t until_ns = talk_until(self, limit_ms);
    const char question[2] = {'?', letter};
    self->heard_count = 0;
    talk_say(self, question, sizeof question);
    glove_reply reply = GLOVE_SILENT;
    while (reply == GLOVE_SILENT && can_continue(self) && device_clock_ns() < until_ns)
        if (talk_receive(self, until_ns) > 0)
            reply =
                glove_reply_value(self->heard, self->heard_count, letter, out_value, value_size);
    return conclude(self, reply);
}

/* Sends a command that the glove answers with its letter. */
static glove_reply talk_order(glove_talk *self, const void *bytes, size_t size, char letter,
                              int64_t limit_ms)
{
    int64_t until_ns = talk_until(self, limit_ms);
    self->heard_count = 0;
    talk_say(self, bytes, size);
    glove_reply reply = GLOVE_SILENT;
    while (reply == GLOVE_SILENT && can_continue(self) && device_clock_ns() < until_ns)
        if (talk_receive(self, until_ns) > 0)
            reply = glove_reply_done(self->heard, self->heard_count, letter);
    return conclude(self, reply);
}

/* ---- the start ---- */

enum { ASK_TRIES = 4, RATE_MOST_HZ = 1000 };
static const int64_t whole_ms = 6000, ask_ms = 500, order_ms = 300, pause_ms = 50;
static const int64_t restart_ms = 2500, first_record_ms = 1000, poll_again_ms = 200;
static const double ticks_per_s = 115200.0;
/* Lowest rate of gloves that keep their own rate: a lower rate needs polling. */
static const double slowest_native_hz = 90.0;
/* Usable share of the line's capacity; the rest is reserved for clock differences. */
static const double line_share = 0.95;

/* ---- identifying the device ---- */

static mrt_result report_silence(const glove_talk *talk, glove_error *why)
{
    const glove_port *port = talk->port;
    if (port->baud == 0)
        return glove_error_set(why, MRT_ERR_IO, "%s: connected, but no answer", port->name);
    return glove_error_set(
        why, MRT_ERR_IO,
        "%s: no answer at %u baud: is the glove's box switched on and set to this "
        "speed? Old boxes need baud=38400",
        port->name, port->baud);
}

static mrt_result report_other_device(const glove_talk *talk, const unsigned char *bytes,
                                      size_t count, glove_error *why)
{
    char hex[50];
    glove_error_hex(hex, sizeof hex, bytes, count);
    return glove_error_set(why, MRT_ERR_UNSUPPORTED,
                           "%s: not a CyberGlove at %u baud; it answers \"?G\" with %s. It is "
                           "another device, or a glove set to another speed",
                           talk->port->name, talk->port->baud, hex);
}

/* Returns the reason if the start-up ended. */
static mrt_result end_of(const glove_talk *talk, glove_error *why)
{
    if (talk->is_stopping)
        return glove_error_set(why, MRT_ERR_IO, "%s: cancelled because the program quits",
                               talk->port->name);
    if (talk->is_gone && talk->port->baud == 0)
        return glove_error_set(
            why, MRT_ERR_IO,
            "%s closed the connection during start-up: is the glove in use by another program?",
            talk->port->name);
    if (talk->is_gone)
        return glove_error_set(why, MRT_ERR_IO, "%s disappeared during start-up: was it unplugged?",
                               talk->port->name);
    if (!can_continue(talk))
        return glove_error_set(why, MRT_ERR_IO,
                               "%s answers too slowly. If it is a CyberGlove, switch it off and on",
                               talk->port->name);
    return MRT_OK;
}

/* Stops whatever the glove is sending. */
static void stop_sending(glove_talk *talk)
{
    const char stop = GLOVE_CTRL_C;
    talk_say(talk, &stop, 1);
    talk_listen(talk, pause_ms);
    if (!talk->is_gone)
        glove_port_flush(talk->port);
    talk->heard_count = 0;
}

typedef struct first_words {
    unsigned char bytes[16];
    size_t count;
} first_words;

static bool is_ready(glove_talk *talk, int tries, uint32_t *out, first_words *heard)
{
    for (int i = 0; i < tries && can_continue(talk); ++i) {
        unsigned char value = 0;
        glove_reply reply = talk_ask(talk, 'G', &value, 1, ask_ms);
        *out = value;
        if (reply == GLOVE_ANSWERED)
            return true;
        if (talk->heard_count > 0 && heard->count == 0) {
            heard->count = talk->heard_count < 16 ? talk->heard_count : 16;
            memcpy(heard->bytes, talk->heard, heard->count);
        }
    }
    return false;
}

static mrt_result find_glove(glove_talk *talk, glove_effort effort, uint32_t *out_readiness,
                             glove_error *why)
{
    first_words heard = {.count = 0};
    bool ready = is_ready(talk, effort == GLOVE_MAY_RESTART ? ASK_TRIES : 2, out_readiness, &heard);
    if (!ready && effort == GLOVE_MAY_RESTART && can_continue(talk)) {
        const char restart = GLOVE_CTRL_R;
        talk_say(talk, &restart, 1);
        if (talk_listen(talk, restart_ms))
            ready = is_ready(talk, 1, out_readiness, &heard);
    }
    if (ready)
        return MRT_OK;
    if (talk->is_gone || talk->is_stopping)
        return end_of(talk, why);
    return heard.count > 0 ? report_other_device(talk, heard.bytes, heard.count, why)
                           : report_silence(talk, why);
}

static uint32_t ask_mask(glove_talk *talk, char letter, int64_t limit_ms)
{
    unsigned char b[3];
    if (talk_ask(talk, letter, b, sizeof b, limit_ms) != GLOVE_ANSWERED)
        return 0;
    return (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static uint32_t ask_byte(glove_talk *talk, char letter, int64_t limit_ms)
{
    unsigned char value = 0;
    return talk_ask(talk, letter, &value, 1, limit_ms) == GLOVE_ANSWERED ? value : 0;
}

static mrt_result find_sensors(glove_talk *talk, glove_unit *out, glove_error *why)
{
    glove_reported census = {.sensor_count = ask_byte(talk, 'S', ask_ms)};
    census.hardware_mask = ask_mask(talk, 'K', ask_ms);
    census.software_mask = ask_mask(talk, 'M', order_ms);
    census.sent_count = ask_byte(talk, 'N', order_ms);
    mrt_result result = end_of(talk, why);
    if (result < 0)
        return result;
    bool has_any = census.sensor_count > 0 || census.hardware_mask > 0;
    if (!has_any)
        return glove_error_set(
            why, MRT_ERR_IO,
            "%s answered the first question like a CyberGlove, but no later one: "
            "switch it off and on",
            talk->port->name);
    if (!glove_sensors_find(&census, &out->sensors))
        return glove_error_set(why, MRT_ERR_UNSUPPORTED,
                               "%s answers like a CyberGlove, but reports %u sensors and not which "
                               "ones: only gloves with 18 or 22 are supported",
                               talk->port->name, census.sensor_count);
    return MRT_OK;
}

static void find_hand(glove_talk *talk, const glove_settings *settings, glove_unit *out)
{
    unsigned char is_right = 1;
    out->reported_hand = talk_ask(talk, 'R', &is_right, 1, ask_ms) == GLOVE_ANSWERED;
    out->hand = is_right ? MRT_RIGHT : MRT_LEFT;
    if (settings->hand == GLOVE_HAND_LEFT)
        out->hand = MRT_LEFT;
    else if (settings->hand == GLOVE_HAND_RIGHT)
        out->hand = MRT_RIGHT;
}

/* ---- setting up the glove ---- */

static void note_refusal(glove_unit *unit, char letter)
{
    size_t used = strlen(unit->refused);
    if (used + 1 < sizeof unit->refused)
        unit->refused[used] = letter;
}

/* Sends a command with a byte, 0 or 1. */
static bool give_flag(glove_talk *talk, glove_unit *unit, char letter, bool on)
{
    const char order[2] = {letter, on ? 1 : 0};
    glove_reply reply = talk_order(talk, order, sizeof order, letter, order_ms);
    if (reply == GLOVE_ANSWERED)
        return true;
    if (on)
        note_refusal(unit, letter);
    return false;
}

static double rate_for_line(const glove_port *port, const glove_unit *unit, double requested_hz)
{
    if (port->baud == 0)
        return requested_hz;
    double record_bits = 10.0 * (double)glove_layout_size(&unit->layout);
    double most_hz = line_share * port->baud / record_bits;
    return requested_hz > most_hz ? most_hz : requested_hz;
}

/* Reads two words. Their byte order is not known, so the order that gives the requested value is
 * used. */
static uint32_t period_ticks(const unsigned char value[4], uint32_t asked)
{
    uint32_t high_first =
        (uint32_t)(value[0] << 8 | value[1]) * (uint32_t)(value[2] << 8 | value[3]);
    uint32_t low_first =
        (uint32_t)(value[1] << 8 | value[0]) * (uint32_t)(value[3] << 8 | value[2]);
    if (low_first == asked || high_first == asked)
        return asked;
    uint32_t least = (uint32_t)ticks_per_s / RATE_MOST_HZ;
    if (low_first >= least && low_first < high_first)
        return low_first;
    return high_first >= least ? high_first : 0;
}

static int64_t ask_period_ns(glove_talk *talk, uint32_t asked_ticks)
{
    unsigned char value[4];
    uint32_t ticks = asked_ticks;
    if (talk_ask(talk, 'T', value, sizeof value, order_ms) == GLOVE_ANSWERED)
        ticks = period_ticks(value, asked_ticks);
    return (int64_t)((double)ticks * 1e9 / ticks_per_s);
}

static void give_rate(glove_talk *talk, const glove_settings *settings, glove_unit *unit)
{
    if (settings->rate_hz <= 0) {
        unit->period_ns = ask_period_ns(talk, 0);
        return;
    }
    unit->asked_hz = rate_for_line(talk->port, unit, settings->rate_hz);
    uint32_t ticks = (uint32_t)(ticks_per_s / unit->asked_hz + 0.5);
    uint32_t factor = ticks > 65535 ? 2 : 1;
    char order[32];
    int length = snprintf(order, sizeof order, "t %u %u\r", ticks / factor, factor);
    if (talk_order(talk, order, (size_t)length, 't', order_ms) == GLOVE_ANSWERED) {
        unit->period_ns = ask_period_ns(talk, ticks / factor * factor);
        return;
    }
    note_refusal(unit, 'T');
    stop_sending(talk); /* ignore its answer to the digits */
}

/* Sets up records of bytes: D, U, F, T. Continues without the commands that the glove rejects. */
static mrt_result set_up(glove_talk *talk, const glove_settings *settings, glove_unit *out,
                         glove_error *why)
{
    out->layout.has_time = give_flag(talk, out, 'D', settings->stamps != GLOVE_STAMPS_OFF) &&
                           settings->stamps != GLOVE_STAMPS_OFF;
    out->layout.has_status = give_flag(talk, out, 'U', true);
    if (settings->filter != GLOVE_FILTER_AS_IT_IS)
        give_flag(talk, out, 'F', settings->filter == GLOVE_FILTER_ON);
    give_rate(talk, settings, out);
    if (settings->stamps == GLOVE_STAMPS_ON && !out->layout.has_time && can_continue(talk))
        return glove_error_set(why, MRT_ERR_UNSUPPORTED,
                               "%s has no time stamps, as most CyberGlove II and III: leave "
                               "time_stamps=auto",
                               talk->port->name);
    return end_of(talk, why);
}

static void choose_mode(const glove_settings *settings, glove_unit *unit)
{
    bool keeps_its_rate = strchr(unit->refused, 'T') != NULL;
    unit->is_polled = settings->form == GLOVE_BYTES &&
                      (settings->mode == GLOVE_MODE_POLLED ||
                       (settings->mode == GLOVE_MODE_AUTO && keeps_its_rate &&
                        settings->rate_hz > 0 && settings->rate_hz < slowest_native_hz));
    unit->layout.head = unit->is_polled ? 'G' : 'S';
    if (unit->is_polled)
        unit->period_ns = unit->asked_hz > 0 ? (int64_t)(1e9 / unit->asked_hz) : 0;
}

bool glove_start_sending(glove_port *port, const glove_unit *unit)
{
    if (unit->layout.form == GLOVE_WORDS)
        return glove_port_write(port, "1S", 2);
    return glove_port_write(port, &unit->layout.head, 1);
}

/* ---- the first record ---- */

static void adopt(glove_unit *unit, glove_parse *parse, const glove_layout *layout)
{
    if (layout->sensor_count != unit->layout.sensor_count)
        glove_sensors_of_count(layout->sensor_count, &unit->sensors);
    unit->layout = *layout;
    glove_parse_init(parse, layout);
}

typedef enum heard_records { HEARD_NONE = 0, HEARD_NO_GLOVE, HEARD_RECORD } heard_records;

/* Passes the last received bytes to the parser. */
static heard_records parse_received(const glove_talk *talk, size_t count, glove_parse *parse)
{
    const unsigned char *bytes = talk->heard + talk->heard_count - count;
    glove_record record;
    heard_records found = HEARD_NONE;
    while (count > 0) {
        size_t part = glove_parse_room(parse) < count ? glove_parse_room(parse) : count;
        glove_parse_append(parse, bytes, part);
        bytes += part;
        count -= part;
        while (glove_parse_next(parse, &record))
            if (found != HEARD_RECORD)
                found = record.is_unplugged ? HEARD_NO_GLOVE : HEARD_RECORD;
    }
    return found;
}

static mrt_result report_no_record(const glove_talk *talk, const glove_unit *unit, glove_error *why)
{
    char hex[98];
    const char *name = talk->port->name;
    glove_error_hex(hex, sizeof hex, talk->heard, talk->heard_count);
    if (talk->heard_count == 0)
        return glove_error_set(why, MRT_ERR_IO, "%s is a CyberGlove, but sends no records%s", name,
                               unit->readiness & 2
                                   ? ": switch it off and on"
                                   : ": it reports that the glove is not plugged into the box");
    return glove_error_set(
        why, MRT_ERR_FORMAT,
        "%s is a CyberGlove, but does not send records of %u sensors: %s: switch it off and on",
        name, unit->layout.sensor_count, hex);
}

static int64_t first_limit_ms(const glove_unit *unit)
{
    int64_t three_ms = 3 * unit->period_ns / 1000000;
    return three_ms > first_record_ms ? three_ms : first_record_ms;
}

static mrt_result report_no_hand(const glove_talk *talk, glove_error *why)
{
    return glove_error_set(why, MRT_ERR_IO,
                           "%s: the box answers, but the glove is not plugged into it: plug it in",
                           talk->port->name);
}

static mrt_result have_record(glove_talk *talk, glove_unit *unit, glove_parse *parse,
                              glove_error *why)
{
    glove_parse_init(parse, &unit->layout);
    talk->heard_count = 0;
    if (!glove_start_sending(talk->port, unit))
        talk->is_gone = true;
    int64_t until_ns = talk_until(talk, first_limit_ms(unit));
    heard_records found = HEARD_NONE;
    while (can_continue(talk) && device_clock_ns() < until_ns) {
        int64_t try_ns = unit->is_polled ? talk_until(talk, poll_again_ms) : until_ns;
        size_t count = talk_receive(talk, try_ns < until_ns ? try_ns : until_ns);
        bool asks_again = unit->is_polled && !talk->is_gone;
        heard_records now = parse_received(talk, count, parse);
        glove_layout other = unit->layout;
        if (now == HEARD_NONE && found == HEARD_NONE &&
            glove_layout_guess(talk->heard, talk->heard_count, &other)) {
            adopt(unit, parse, &other);
            now = parse_received(talk, talk->heard_count, parse);
        }
        if (now == HEARD_RECORD)
            return MRT_OK;
        if (now == HEARD_NO_GLOVE)
            found = now;
        if (asks_again && !glove_start_sending(talk->port, unit))
            talk->is_gone = true;
    }
    if (talk->is_gone || talk->is_stopping)
        return end_of(talk, why);
    return found == HEARD_NO_GLOVE ? report_no_hand(talk, why) : report_no_record(talk, unit, why);
}

mrt_result glove_start(glove_port *port, const mrt_host *host, const glove_settings *settings,
                       glove_effort effort, glove_unit *out, glove_parse *parse, glove_error *why)
{
    glove_talk talk;
    *out = (glove_unit){.layout = {.form = settings->form}};
    talk_init(&talk, port, host, settings->patience, whole_ms);
    stop_sending(&talk);
    mrt_result result = find_glove(&talk, effort, &out->readiness, why);
    if (result < 0)
        return result;
    result = find_sensors(&talk, out, why);
    if (result < 0)
        return result;
    out->layout.sensor_count = out->sensors.count;
    find_hand(&talk, settings, out);
    if (settings->form == GLOVE_BYTES)
        result = set_up(&talk, settings, out, why);
    else /* enable sending over USB; its answer is unknown */
        talk_order(&talk, "1eu", 3, '1', order_ms);
    if (result < 0)
        return result;
    choose_mode(settings, out);
    talk_settle(&talk);
    return have_record(&talk, out, parse, why);
}
