/* Inputs, outputs, face outputs, and lists of devices. */
#include "base/clock.h"
#include "base/percentile.h"
#include "check/child/cases.h"
#include "check/child/fixture.h"
#include "check/child/tell.h"
#include "check/child/trap.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- shared by everything that opens an address ---- */

/* Returns the number of errors logged before. */
static uint32_t begin_open(const host *of, const char *address)
{
    tell_doing(RULE_COUNT, "open(\"%s\")", address);
    watch_next();
    return of->error_count;
}

static mrt_result judge_open(const host *of, const char *address, uint32_t errors_before,
                             mrt_result result)
{
    if (result < 0 && of->error_count == errors_before)
        tell_failed(RULE_RUN_EXPLAINED, "open(\"%s\") returned %d, but logged no error", address,
                    result);
    return result;
}

/* Returns whether the text has letters and a blank, so that it is more than a code. */
static bool is_sentence(const char *words)
{
    return strlen(words) >= 12 && strchr(words, ' ');
}

/* Judges the result of open() for an address without a device. */
static void judge_absent(check_rule rule, const host *of, const char *address, mrt_result result)
{
    if (result >= 0)
        tell_skipped(rule, "it opens any address, even \"%s\"", address);
    else if (!is_sentence(of->last_log))
        tell_failed(rule, "open(\"%s\") says \"%s\": write a sentence that helps the user", address,
                    of->last_log);
    else
        tell_ok(rule, "\"%s\"", of->last_log);
}

/* ---- inputs, as far as they can be opened here: missing devices, channels, samples, waiting
 * ---- */

enum { SAMPLES_RECORDED = 3000, READS_LIVE = 400, ROUNDS = 30, STOP_READS = 4, STOP_WAITS = 200 };
static const int64_t live_ns = 1500 * NS_PER_MS, span_ns = 20 * NS_PER_MS;
static const int64_t late_ns = 250 * NS_PER_MS; /* tolerance for a busy machine */
static const int64_t early_ns = 1 * NS_PER_MS;
enum { LATE_READS = 3, EARLY_READS = 3 };

/* An address that no device has. */
static const char nowhere[] = "/nowhere/there-is-no-such-device";

typedef struct reader {
    const examination *e;
    const mrt_input *functions;
    mrt_plugin *self;
    host host;
    double param[TYPES_PARAMS_MAX];
    mrt_channel channel[MRT_MAX_CHANNELS];
    uint32_t channel_count;
    bool has_last;
    mrt_sample last;
    uint32_t late_reads, early_reads, sample_count;
    int64_t waited_ns, cpu_ns; /* during reads without a sample */
} reader;

static bool make(reader *out, const examination *e, host_clock clock, int64_t start_ns)
{
    *out = (reader){.e = e, .functions = types_interface(e->type, MRT_INPUT)};
    for (uint32_t i = 0; i < e->type->param_count; ++i)
        out->param[i] = e->type->params[i].initial;
    host_init(&out->host, clock, start_ns);
    tell_doing(RULE_COUNT, "create()");
    watch_next();
    out->self = e->type->create(&out->host.plugin);
    return out->self != NULL;
}

static void finish(reader *self)
{
    tell_doing(RULE_COUNT, "destroy()");
    watch_next();
    self->e->type->destroy(self->self);
}

static mrt_result open_at(reader *self, const char *address)
{
    uint32_t before = begin_open(&self->host, address);
    mrt_result result = self->functions->open(self->self, address, self->param);
    return judge_open(&self->host, address, before, result);
}

static void close_input(reader *self)
{
    tell_doing(RULE_COUNT, "close()");
    watch_next();
    self->functions->close(self->self);
}

static mrt_result open_named(reader *self)
{
    return open_at(self, self->e->input_address ? self->e->input_address : "");
}

void cases_absent(const examination *e)
{
    reader input;
    if (!make(&input, e, HOST_REAL, 0))
        return;
    mrt_result result = open_at(&input, nowhere);
    judge_absent(RULE_INPUT_ABSENT, &input.host, nowhere, result);
    if (result >= 0)
        close_input(&input);
    finish(&input);
}

/* ---- channels ---- */

static bool is_meaning(uint32_t semantic)
{
    return semantic == MRT_CH_OTHER || semantic == MRT_CH_BUTTON ||
           (semantic >= MRT_CH_ANGLE && semantic < MRT_CH_ANGLE + MRT_ANGLES) ||
           (semantic >= MRT_CH_WRIST && semantic < MRT_CH_WRIST + 7) ||
           (semantic >= MRT_CH_PEDAL && semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS) ||
           semantic == MRT_CH_TIMECODE || semantic == MRT_CH_TIMECODE + 1;
}

/* Channels with other meanings are identified by their names. */
static bool means_one_thing(uint32_t semantic)
{
    return semantic != MRT_CH_OTHER && semantic != MRT_CH_BUTTON;
}

static bool judge_channel(const mrt_channel *all, uint32_t i)
{
    const mrt_channel *c = &all[i];
    if (!c->name || !c->name[0] || !c->unit) {
        tell_failed(RULE_INPUT_CHANNELS, "channel %u has no name or no unit", i);
        return false;
    }
    if (!is_meaning(c->semantic) || c->hand > MRT_NO_HAND) {
        tell_failed(RULE_INPUT_CHANNELS, "channel %u \"%.60s\" has semantic %u, hand %u", i,
                    c->name, c->semantic, c->hand);
        return false;
    }
    if (!isfinite(c->min) || !isfinite(c->max) || c->min > c->max) {
        tell_failed(RULE_INPUT_CHANNELS, "channel %u \"%.60s\" goes from %g to %g", i, c->name,
                    (double)c->min, (double)c->max);
        return false;
    }
    for (uint32_t k = 0; k < i; ++k)
        if (means_one_thing(c->semantic) && all[k].semantic == c->semantic &&
            all[k].hand == c->hand) {
            tell_failed(RULE_INPUT_CHANNELS, "channels %u and %u \"%.60s\" have the same meaning",
                        k, i, c->name);
            return false;
        }
    return true;
}

static bool take_channels(reader *self)
{
    tell_doing(RULE_COUNT, "channels()");
    watch_next();
    const mrt_channel *channels = self->functions->channels(self->self, &self->channel_count);
    if (!channels || self->channel_count == 0 || self->channel_count > MRT_MAX_CHANNELS) {
        tell_failed(RULE_INPUT_CHANNELS, "channels() returned %u%s, but 1 to %d are possible",
                    self->channel_count, channels ? "" : " and NULL", MRT_MAX_CHANNELS);
        return false;
    }
    for (uint32_t i = 0; i < self->channel_count; ++i)
        if (!judge_channel(channels, i))
            return false;
    memcpy(self->channel, channels, self->channel_count * sizeof *channels);
    return true;
}

static bool has_same_channels(reader *self, const mrt_channel *as, uint32_t count)
{
    uint32_t now_count = 0;
    const mrt_channel *now = self->functions->channels(self->self, &now_count);
    if (!now || now_count != count)
        return false;
    for (uint32_t i = 0; i < count; ++i)
        if (now[i].semantic != as[i].semantic || now[i].hand != as[i].hand ||
            now[i].min < as[i].min || now[i].min > as[i].min || now[i].max < as[i].max ||
            now[i].max > as[i].max)
            return false;
    return true;
}

/* ---- samples ---- */

static void judge_values(const reader *self, const mrt_sample *sample)
{
    if (sample->count != self->channel_count) {
        tell_failed(RULE_INPUT_COUNT, "sample %u has %u values, but channels() returned %u",
                    self->sample_count, sample->count, self->channel_count);
        return;
    }
    for (uint32_t i = 0; i < sample->count; ++i)
        if (!isfinite(sample->value[i])) {
            tell_failed(RULE_INPUT_FINITE, "sample %u: value %u is %g", self->sample_count, i,
                        (double)sample->value[i]);
            return;
        }
}

static void judge_order(const reader *self, const mrt_sample *sample, int64_t now_ns)
{
    if (sample->time_ns > now_ns)
        tell_failed(RULE_INPUT_FUTURE, "the time of sample %u is %.6f s in the future",
                    self->sample_count, (double)(sample->time_ns - now_ns) / 1e9);
    if (!self->has_last)
        return;
    if (sample->time_ns < self->last.time_ns)
        tell_failed(RULE_INPUT_ORDER,
                    "the time of sample %u is %.6f s before that of the last "
                    "one",
                    self->sample_count, (double)(self->last.time_ns - sample->time_ns) / 1e9);
    uint32_t ahead = sample->sequence - self->last.sequence;
    if (ahead == 0 || ahead > UINT32_MAX / 2)
        tell_failed(RULE_INPUT_ORDER, "the sequence of sample %u goes from %u to %u",
                    self->sample_count, self->last.sequence, sample->sequence);
}

static int64_t process_cpu_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

static void judge_punctual(reader *self, mrt_result result, int64_t deadline_ns, int64_t now_ns)
{
    bool is_exact = self->host.clock != HOST_REAL; /* that clock moves only by waiting */
    int64_t slack_ns = is_exact ? 0 : late_ns;
    if (self->host.clock != HOST_LATE && now_ns > deadline_ns + slack_ns &&
        (is_exact || ++self->late_reads >= LATE_READS))
        tell_failed(RULE_INPUT_DEADLINE, "read() returned %.1f ms after its deadline",
                    (double)(now_ns - deadline_ns) / 1e6);
    if (result == MRT_TIMEOUT && now_ns < deadline_ns - (is_exact ? 0 : early_ns) &&
        (is_exact || ++self->early_reads >= EARLY_READS))
        tell_failed(RULE_INPUT_TIMEOUT, "read() returned MRT_TIMEOUT %.1f ms before its deadline",
                    (double)(deadline_ns - now_ns) / 1e6);
}

/* MRT_OK: *out is a sample. */
static mrt_result read_one(reader *self, int64_t deadline_ns, mrt_sample *out)
{
    char words[300];
    uint32_t errors_before = self->host.error_count;
    *out = (mrt_sample){.time_ns = INT64_MAX};
    int64_t cpu_before_ns = process_cpu_ns(), began_ns = host_now_ns(&self->host);
    watch_next();
    mrt_result result = self->functions->read(self->self, self->param, deadline_ns, out);
    int64_t now_ns = host_now_ns(&self->host);
    if (result == MRT_TIMEOUT) {
        self->waited_ns += now_ns - began_ns;
        self->cpu_ns += process_cpu_ns() - cpu_before_ns;
    }
    judge_punctual(self, result, deadline_ns, now_ns);
    if (result > MRT_END)
        tell_failed(RULE_INPUT_RESULT, "read() returned %d", result);
    if (result < 0 && self->host.error_count == errors_before)
        tell_failed(RULE_RUN_EXPLAINED, "read() returned %d, but logged no error", result);
    else if (result < 0 && result != MRT_ERR_IO)
        tell_failed(RULE_INPUT_RESULT, "read() returned %d%s", result,
                    host_words(&self->host, words));
    if (result != MRT_OK)
        return result;
    judge_values(self, out);
    judge_order(self, out, now_ns);
    self->last = *out;
    self->has_last = true;
    self->sample_count += 1;
    return result;
}

static bool is_recorded(const reader *self)
{
    return self->functions->flags & MRT_INPUT_RECORDED;
}

static void read_all(reader *self)
{
    mrt_sample sample;
    int64_t began_ns = clock_now_ns();
    int count = is_recorded(self) ? SAMPLES_RECORDED : READS_LIVE;
    tell_doing(RULE_COUNT, "read()");
    for (int i = 0; i < count; ++i) {
        int64_t span = is_recorded(self) ? (i % 5 + 1) * 3 * NS_PER_MS : span_ns;
        mrt_result result = read_one(self, host_now_ns(&self->host) + span, &sample);
        if (result < 0 || result == MRT_END ||
            (!is_recorded(self) && clock_now_ns() - began_ns > live_ns))
            return;
    }
}

/* Compares processor time with the time waited: a wait uses almost none, a spin uses all. */
static void judge_spin(const reader *self)
{
    if (self->host.clock != HOST_REAL || self->waited_ns < 100 * NS_PER_MS)
        return;
    if (self->cpu_ns > self->waited_ns / 10)
        tell_failed(RULE_INPUT_SPIN, "in %.0f ms of waiting it used %.0f ms of processor time",
                    (double)self->waited_ns / 1e6, (double)self->cpu_ns / 1e6);
}

static void skip_all(const reader *self)
{
    static const check_rule rules[] = {RULE_INPUT_CHANNELS, RULE_INPUT_COUNT,    RULE_INPUT_FINITE,
                                       RULE_INPUT_ORDER,    RULE_INPUT_FUTURE,   RULE_INPUT_RESULT,
                                       RULE_INPUT_SPIN,     RULE_INPUT_DEADLINE, RULE_INPUT_TIMEOUT,
                                       RULE_INPUT_REOPEN,   RULE_INPUT_GROWTH};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_skipped(rules[i], "nothing could be opened (%.300s): name one with --input ADDRESS",
                     self->host.last_log);
}

static int open_files(void)
{
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    while (folder && readdir(folder))
        count += 1;
    if (folder)
        (void)closedir(folder);
    return count;
}

/* Closes and opens it repeatedly: channels must be the same, and nothing may leak. */
static void judge_reopening(reader *self)
{
    mrt_channel channel[MRT_MAX_CHANNELS];
    uint32_t count = self->channel_count;
    size_t heap_before = 0;
    int files_before = 0;
    memcpy(channel, self->channel, sizeof channel);
    int rounds = is_recorded(self) ? ROUNDS : 3;
    for (int i = 0; i < rounds; ++i) {
        mrt_sample sample;
        self->has_last = false;
        close_input(self);
        if (open_named(self) < 0) {
            tell_failed(RULE_INPUT_REOPEN, "after close(), open() says: %s", self->host.last_log);
            return;
        }
        if (!has_same_channels(self, channel, count))
            tell_failed(RULE_INPUT_REOPEN, "after close() and open() it has other channels");
        tell_doing(RULE_COUNT, "read(), opened again");
        (void)read_one(self, host_now_ns(&self->host) + span_ns, &sample);
        if (i == 1) {
            heap_before = trap_heap_bytes();
            files_before = open_files();
        }
    }
    if (rounds < ROUNDS) {
        tell_skipped(RULE_INPUT_GROWTH, "a device is not opened and closed that often");
        return;
    }
    long heap = (long)trap_heap_bytes() - (long)heap_before;
    if (heap >= 64 * (ROUNDS - 2))
        tell_failed(RULE_INPUT_GROWTH, "each open() and close() leaks %ld bytes",
                    heap / (ROUNDS - 2));
    else if (open_files() - files_before >= ROUNDS / 2)
        tell_failed(RULE_INPUT_GROWTH, "open() and close() leak open files");
    tell_ok(RULE_INPUT_GROWTH, "%d times", ROUNDS);
}

void cases_input(const examination *e)
{
    static const check_rule rules[] = {RULE_INPUT_COUNT,    RULE_INPUT_FINITE, RULE_INPUT_ORDER,
                                       RULE_INPUT_FUTURE,   RULE_INPUT_RESULT, RULE_INPUT_SPIN,
                                       RULE_INPUT_DEADLINE, RULE_INPUT_TIMEOUT};
    static reader input;
    const mrt_input *functions = types_interface(e->type, MRT_INPUT);
    host_clock clock = functions->flags & MRT_INPUT_RECORDED ? HOST_JUMPING : HOST_REAL;
    if (!make(&input, e, clock, 0))
        return;
    if (open_named(&input) < 0) {
        skip_all(&input);
        finish(&input);
        return;
    }
    if (take_channels(&input)) {
        read_all(&input);
        judge_spin(&input);
        if (!has_same_channels(&input, input.channel, input.channel_count))
            tell_failed(RULE_INPUT_CHANNELS, "channels() returns other channels after reading");
        tell_ok(RULE_INPUT_CHANNELS, "%u", input.channel_count);
        for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
            tell_ok(rules[i], "%u samples", input.sample_count);
        judge_reopening(&input);
        tell_ok(RULE_INPUT_REOPEN, "%s", "");
    }
    close_input(&input);
    finish(&input);
}

/* ---- recordings at any speed ---- */

/* Times are relative to the first sample. */
static bool is_same_sample(const mrt_sample *a, int64_t a_start_ns, const mrt_sample *b,
                           int64_t b_start_ns)
{
    return a->time_ns - a_start_ns == b->time_ns - b_start_ns && a->count == b->count &&
           memcmp(a->value, b->value, a->count * sizeof *a->value) == 0;
}

static mrt_result read_on(reader *self, mrt_sample *out, char *caught, size_t capacity)
{
    mrt_result result = MRT_TIMEOUT;
    for (int i = 0; i < 100000 && result == MRT_TIMEOUT; ++i) {
        watch_next();
        (void)trap_set(1u << TRAP_SLEEP | 1u << TRAP_CLOCK);
        result =
            self->functions->read(self->self, self->param, host_now_ns(&self->host) + span_ns, out);
        (void)trap_set(0);
        if (trap_caught(TRAP_SLEEP, caught, capacity) || trap_caught(TRAP_CLOCK, caught, capacity))
            tell_failed(RULE_INPUT_RECORDED, "read() called %s", caught);
    }
    return result;
}

void cases_recorded(const examination *e)
{
    static reader exact, late;
    char caught[320];
    mrt_sample a = {0}, b = {0};
    int64_t a_start_ns = 0, b_start_ns = 0;
    if (!make(&exact, e, HOST_JUMPING, 0) || !make(&late, e, HOST_LATE, 77 * NS_PER_S))
        return;
    if (open_named(&exact) < 0 || open_named(&late) < 0) {
        tell_skipped(RULE_INPUT_RECORDED,
                     "nothing could be opened (%.300s): name one with --input ADDRESS",
                     exact.host.last_log);
        return;
    }
    tell_doing(RULE_COUNT, "read() at two speeds");
    for (int i = 0; i < SAMPLES_RECORDED; ++i) {
        mrt_result of_exact = read_on(&exact, &a, caught, sizeof caught);
        mrt_result of_late = read_on(&late, &b, caught, sizeof caught);
        a_start_ns = i == 0 ? a.time_ns : a_start_ns;
        b_start_ns = i == 0 ? b.time_ns : b_start_ns;
        bool is_same = of_exact == of_late &&
                       (of_exact != MRT_OK || is_same_sample(&a, a_start_ns, &b, b_start_ns));
        if (!is_same)
            tell_failed(RULE_INPUT_RECORDED,
                        "sample %d is different when the host's clock runs at another speed", i);
        if (!is_same || of_exact != MRT_OK)
            break;
    }
    tell_ok(RULE_INPUT_RECORDED, "%s", "");
    close_input(&exact);
    close_input(&late);
    finish(&exact);
    finish(&late);
}

/* ---- a host that stops ---- */

void cases_stop(const examination *e)
{
    static reader input;
    mrt_sample sample;
    if (!make(&input, e, HOST_STOPPING, 0))
        return;
    int64_t began_ns = clock_now_ns();
    bool is_open = open_named(&input) >= 0;
    tell_doing(RULE_INPUT_STOP, "read() while the host stops");
    mrt_result result = MRT_OK;
    for (int i = 0; i < STOP_READS && is_open && result >= 0 && result != MRT_END; ++i) {
        watch_next();
        result = input.functions->read(input.self, input.param, clock_now_ns() + 50 * NS_PER_MS,
                                       &sample);
    }
    if (is_open)
        close_input(&input);
    double took_s = (double)(clock_now_ns() - began_ns) / 1e9;
    if (input.host.wait_count > STOP_WAITS)
        tell_failed(RULE_INPUT_STOP, "it continued to wait, %u times", input.host.wait_count);
    else if (took_s > 5)
        tell_failed(RULE_INPUT_STOP, "it took %.1f s to stop", took_s);
    if (!is_open && input.host.wait_count == 0)
        tell_skipped(RULE_INPUT_STOP,
                     "nothing could be opened (%.300s): name one with --input ADDRESS",
                     input.host.last_log);
    else
        tell_ok(RULE_INPUT_STOP, "%s", "");
    finish(&input);
}

enum { DEVICES_MAX = 32, GUARD_BYTE = 0x7b, SAMPLES = 200, OUTPUT_ROUNDS = 20 };
static const char no_receiver[] = "no address to send to";

static double params[TYPES_PARAMS_MAX];
static host with;

static mrt_plugin *make_plugin(const examination *e)
{
    for (uint32_t i = 0; i < e->type->param_count; ++i)
        params[i] = e->type->params[i].initial;
    host_init(&with, HOST_REAL, 0);
    tell_doing(RULE_COUNT, "create()");
    watch_next();
    return e->type->create(&with.plugin);
}

/* ---- devices ---- */

static bool ends(const char *text, size_t capacity)
{
    return memchr(text, '\0', capacity) != NULL;
}

static const char *device_fault(const mrt_device *d)
{
    if (!ends(d->address, sizeof d->address) || !ends(d->name, sizeof d->name) ||
        !ends(d->advice, sizeof d->advice))
        return "a text without a final 0";
    if (d->address[0] == '\0' || d->name[0] == '\0')
        return "no address or no name";
    if (d->state < MRT_DEVICE_READY || d->state > MRT_DEVICE_UNSURE)
        return "an invalid state";
    if (d->state != MRT_DEVICE_READY && d->advice[0] == '\0')
        return "no advice, although it is not ready";
    return NULL;
}

static bool is_guarded(const mrt_device *d)
{
    const unsigned char *at = (const unsigned char *)d;
    for (size_t i = 0; i < sizeof *d; ++i)
        if (at[i] != GUARD_BYTE)
            return false;
    return true;
}

static void judge_list(const mrt_devices *functions, mrt_plugin *self)
{
    static mrt_device found[DEVICES_MAX + 1];
    for (uint32_t capacity = 0; capacity <= DEVICES_MAX; capacity += capacity ? 31 : 1) {
        memset(found, GUARD_BYTE, sizeof found);
        tell_doing(RULE_COUNT, "list() with room for %u", capacity);
        watch_next();
        uint32_t count = functions->list(self, found, capacity);
        if (!is_guarded(&found[capacity]))
            tell_failed(RULE_DEVICES_LIST, "list() writes beyond its capacity of %u", capacity);
        for (uint32_t i = 0; i < count && i < capacity; ++i) {
            const char *fault = device_fault(&found[i]);
            if (fault)
                tell_failed(RULE_DEVICES_LIST, "device %u of %u has %s", i, count, fault);
        }
    }
    tell_ok(RULE_DEVICES_LIST, "%s", "");
}

void cases_devices(const examination *e)
{
    const mrt_devices *functions = types_interface(e->type, MRT_DEVICES);
    mrt_device current;
    mrt_plugin *self = make_plugin(e);
    if (!self)
        return;
    judge_list(functions, self);
    tell_doing(RULE_COUNT, "current()");
    watch_next();
    if (functions->current(self, &current))
        tell_failed(RULE_DEVICES_CURRENT, "current() returns a device, although none was opened");
    tell_ok(RULE_DEVICES_CURRENT, "%s", "");
    tell_doing(RULE_COUNT, "destroy()");
    e->type->destroy(self);
}

/* ---- outputs ---- */

typedef struct output {
    const mrt_output *plain; /* NULL: a face output */
    const mrt_face_output *face;
    mrt_plugin *self;
    mrt_face_wants wants; /* of face outputs */
} output;

static mrt_result open_output(output *self, const char *address)
{
    uint32_t before = begin_open(&with, address);
    self->wants = (mrt_face_wants){0};
    mrt_result result = self->plain ? self->plain->open(self->self, address, params)
                                    : self->face->open(self->self, address, params, &self->wants);
    return judge_open(&with, address, before, result);
}

static void close_output(output *self)
{
    tell_doing(RULE_COUNT, "close()");
    watch_next();
    if (self->plain)
        self->plain->close(self->self);
    else
        self->face->close(self->self);
}

static void judge_output_reopening(output *self, const char *address, check_rule rule)
{
    size_t before = 0;
    for (int i = 0; i < OUTPUT_ROUNDS; ++i) {
        close_output(self);
        if (open_output(self, address) < 0) {
            tell_failed(rule, "after close(), open() says: %s", with.last_log);
            return;
        }
        if (i == 1)
            before = trap_heap_bytes();
    }
    long heap = (long)trap_heap_bytes() - (long)before;
    if (heap > 64 * OUTPUT_ROUNDS)
        tell_failed(rule, "each open() and close() leaks %ld bytes", heap / (OUTPUT_ROUNDS - 2));
    tell_ok(rule, "%d times", OUTPUT_ROUNDS);
}

static void skip_output(const check_rule *rules, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        tell_skipped(rules[i],
                     "nothing could be opened (%.300s): name a place with --output ADDRESS",
                     with.last_log);
}

static void write_samples(const mrt_output *functions, mrt_plugin *self)
{
    static const mrt_channel channels[3] = {
        {"index knuckle", "rad", MRT_CH_ANGLE + 4, MRT_RIGHT, -1, 2},
        {"middle knuckle", "rad", MRT_CH_ANGLE + 7, MRT_RIGHT, -1, 2},
        {"pedal 1", "1", MRT_CH_PEDAL, MRT_NO_HAND, 0, 1}};
    char caught[320];
    tell_doing(RULE_COUNT, "write()");
    for (uint32_t i = 0; i < SAMPLES; ++i) {
        mrt_sample sample = {.time_ns = (int64_t)(i + 1) * 10000000, .sequence = i, .count = 3};
        sample.value[0] = 0.001f * (float)i;
        watch_next();
        (void)trap_set(1u << TRAP_SLEEP | 1u << TRAP_HOST);
        mrt_result result = functions->write(self, "check", channels, &sample);
        (void)trap_set(0);
        if (trap_caught(TRAP_SLEEP, caught, sizeof caught))
            tell_failed(RULE_OUTPUT_WAIT, "write() called %s", caught);
        if (result < 0)
            tell_failed(RULE_OUTPUT_WRITE, "write() returned %d for sample %u: %s", result, i,
                        with.last_log);
    }
    tell_ok(RULE_OUTPUT_WAIT, "%d samples", SAMPLES);
    tell_ok(RULE_OUTPUT_WRITE, "%d samples", SAMPLES);
}

void cases_output(const examination *e)
{
    static const check_rule rules[] = {RULE_OUTPUT_WRITE, RULE_OUTPUT_WAIT, RULE_OUTPUT_REOPEN};
    const char *address = e->output_address ? e->output_address : "";
    output self = {.plain = types_interface(e->type, MRT_OUTPUT), .self = make_plugin(e)};
    if (!self.self)
        return;
    mrt_result absent = open_output(&self, no_receiver);
    judge_absent(RULE_OUTPUT_ABSENT, &with, no_receiver, absent);
    if (absent >= 0)
        close_output(&self);
    if (open_output(&self, address) < 0) {
        skip_output(rules, sizeof rules / sizeof *rules);
    } else {
        write_samples(self.plain, self.self);
        judge_output_reopening(&self, address, RULE_OUTPUT_REOPEN);
        close_output(&self);
    }
    tell_doing(RULE_COUNT, "destroy()");
    e->type->destroy(self.self);
}

/* ---- face outputs ---- */

enum { BONES = 4, SHAPES = 3, WEIGHTS = 95, VERTICES = 12, CONTACTS_MAX = 64 };
static const double usual_ns = 20.0 * NS_PER_MS; /* maximum time of send() on a quiet machine */

static const char *const bone_name[BONES] = {"skull", "jaw", "eye.l", "eye.r"};
static const int32_t parent[BONES] = {-1, 0, 0, 0};
static const mrt_vec3 pivot[BONES] = {{0, -100, 0}, {0, -20, 0}, {30, 60, 60}, {-30, 60, 60}};
static const char *const shape_name[SHAPES] = {"jawOpen", "a shape with blanks", "\xc3\xa4"};
static char weight_text[WEIGHTS][16];
static const char *weight_name[WEIGHTS];

static mrt_face_names names_of(face_kind kind)
{
    bool is_bare = kind == FACE_BARE;
    for (int i = 0; i < WEIGHTS; ++i) {
        memcpy(weight_text[i], "Weight00", 9);
        weight_text[i][6] = (char)('0' + i / 10);
        weight_text[i][7] = (char)('0' + i % 10);
        weight_name[i] = weight_text[i];
    }
    return (mrt_face_names){.face = faces_of(kind),
                            .bones = bone_name,
                            .parents = parent,
                            .pivots = pivot,
                            .shapes = shape_name,
                            .weights = weight_name,
                            .bone_count = is_bare ? 0 : BONES,
                            .shape_count = is_bare ? 0 : SHAPES,
                            .weight_count = is_bare ? 0 : WEIGHTS,
                            .vertex_count = VERTICES};
}

static mrt_face_sample sample_of(uint32_t index, const mrt_face_wants *wants)
{
    static mrt_bone_pose bone[BONES];
    static float dof[MRT_MAX_DOFS], shape[SHAPES], weight[WEIGHTS];
    static mrt_vec3 contact[CONTACTS_MAX], vertex[VERTICES];
    float part = (float)(index % 100) / 99.0f;
    for (int i = 0; i < BONES; ++i)
        bone[i] = (mrt_bone_pose){{0.6f * part, 0, 0, 0.8f}, {part, 0, 0}};
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        dof[i] = 0.2f * part;
    for (int i = 0; i < SHAPES; ++i)
        shape[i] = part;
    for (int i = 0; i < WEIGHTS; ++i)
        weight[i] = part;
    for (int i = 0; i < CONTACTS_MAX; ++i)
        contact[i] = (mrt_vec3){part, -part, 0};
    return (mrt_face_sample){.time_ns = host_now_ns(&with),
                             .take_ns = index % 2 ? -1 : (int64_t)index * 10000000,
                             .number = index / 2 + 1, /* each number has two entries */
                             .bones = bone,
                             .dofs = dof,
                             .contacts = contact,
                             .shapes = shape,
                             .weights = weight,
                             .vertices = wants->vertices ? vertex : NULL};
}

static void send_samples(output *self, face_kind kind)
{
    static mrt_face_names names;
    double took_ns[SAMPLES];
    names = names_of(kind);
    tell_doing(RULE_FACE_OUTPUT_FACES, "begin() of %s", faces_name(kind));
    watch_next();
    mrt_result result = self->face->begin(self->self, &names);
    if (result < 0)
        tell_failed(RULE_FACE_OUTPUT_FACES, "begin() of %s returned %d: %s", faces_name(kind),
                    result, with.last_log);
    tell_doing(RULE_COUNT, "send() of %s", faces_name(kind));
    for (uint32_t i = 0; i < SAMPLES; ++i) {
        const mrt_face_sample sample = sample_of(i, &self->wants);
        int64_t before_ns = host_now_ns(&with);
        watch_next();
        result = self->face->send(self->self, params, &sample);
        took_ns[i] = (double)(host_now_ns(&with) - before_ns);
        if (result != MRT_OK && result != MRT_TIMEOUT)
            tell_failed(RULE_FACE_OUTPUT_SEND, "send() returned %d for sample %u: %s", result, i,
                        with.last_log);
    }
    const double median_ns = percentile(took_ns, SAMPLES, 0.5);
    if (median_ns > usual_ns)
        tell_failed(RULE_FACE_OUTPUT_TIME, "send() takes %.1f ms in at least half of the calls",
                    median_ns / 1e6);
}

void cases_face_output(const examination *e)
{
    static const check_rule rules[] = {RULE_FACE_OUTPUT_FACES, RULE_FACE_OUTPUT_SEND,
                                       RULE_FACE_OUTPUT_TIME, RULE_FACE_OUTPUT_REOPEN};
    const char *address = e->output_address ? e->output_address : "";
    output self = {.face = types_interface(e->type, MRT_FACE_OUTPUT), .self = make_plugin(e)};
    if (!self.self)
        return;
    judge_absent(RULE_FACE_OUTPUT_ABSENT, &with, no_receiver, open_output(&self, no_receiver));
    close_output(&self);
    bool is_open = open_output(&self, address) >= 0;
    if (!is_open)
        skip_output(rules, sizeof rules / sizeof *rules);
    for (int kind = 0; kind < FACE_KINDS && is_open && !tell_has_failed_any(); ++kind)
        send_samples(&self, (face_kind)kind);
    if (is_open) {
        judge_output_reopening(&self, address, RULE_FACE_OUTPUT_REOPEN);
        tell_ok(RULE_FACE_OUTPUT_FACES, "%d faces", FACE_KINDS);
        tell_ok(RULE_FACE_OUTPUT_SEND, "%d samples", SAMPLES * FACE_KINDS);
        tell_ok(RULE_FACE_OUTPUT_TIME, "%d samples", SAMPLES * FACE_KINDS);
    }
    close_output(&self);
    tell_doing(RULE_COUNT, "destroy()");
    e->type->destroy(self.self);
}
