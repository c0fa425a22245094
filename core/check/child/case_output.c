/* Lists of devices, and outputs. */
#include "check/child/cases.h"
#include "check/child/host.h"
#include "check/child/tell.h"
#include "check/child/trap.h"
#include "check/child/watch.h"

#include <string.h>

enum { DEVICES_MAX = 32, GUARD_BYTE = 0x7b, SAMPLES = 200, ROUNDS = 20 };
static const char nowhere[] = "no place to send to";

static double params[TYPES_PARAMS_MAX];
static host with;

static mrt_plugin *make(const examination *e)
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
        return "a text without an end";
    if (d->address[0] == '\0' || d->name[0] == '\0')
        return "no address or no name";
    if (d->state < MRT_DEVICE_READY || d->state > MRT_DEVICE_UNSURE)
        return "a state that is none";
    if (d->state != MRT_DEVICE_READY && d->advice[0] == '\0')
        return "no advice, and is not ready";
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
    mrt_plugin *self = make(e);
    if (!self)
        return;
    judge_list(functions, self);
    tell_doing(RULE_COUNT, "current()");
    watch_next();
    if (functions->current(self, &current))
        tell_failed(RULE_DEVICES_CURRENT, "current() names a device, and none was opened");
    tell_ok(RULE_DEVICES_CURRENT, "%s", "");
    tell_doing(RULE_COUNT, "destroy()");
    e->type->destroy(self);
}

/* ---- outputs ---- */

static mrt_result open_at(const mrt_output *functions, mrt_plugin *self, const char *address)
{
    tell_doing(RULE_COUNT, "open(\"%s\")", address);
    uint32_t before = with.error_count;
    watch_next();
    mrt_result result = functions->open(self, address, params);
    if (result < 0 && with.error_count == before)
        tell_failed(RULE_RUN_EXPLAINED, "open(\"%s\") returned %d, and logged no error", address,
                    result);
    return result;
}

static void close_output(const mrt_output *functions, mrt_plugin *self)
{
    tell_doing(RULE_COUNT, "close()");
    watch_next();
    functions->close(self);
}

static void judge_absent(const mrt_output *functions, mrt_plugin *self)
{
    if (open_at(functions, self, nowhere) >= 0) {
        tell_skipped(RULE_OUTPUT_ABSENT, "it opens any address, \"%s\" too", nowhere);
        close_output(functions, self);
    } else if (strlen(with.said) < 12 || !strchr(with.said, ' ')) {
        tell_failed(RULE_OUTPUT_ABSENT, "open(\"%s\") says \"%s\": no sentence that helps", nowhere,
                    with.said);
    } else {
        tell_ok(RULE_OUTPUT_ABSENT, "\"%s\"", with.said);
    }
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
        trap_enter(1u << TRAP_SLEEP | 1u << TRAP_HOST);
        mrt_result result = functions->write(self, "check", channels, &sample);
        trap_leave();
        if (trap_caught(TRAP_SLEEP, caught, sizeof caught))
            tell_failed(RULE_OUTPUT_WAIT, "write() called %s", caught);
        if (result < 0)
            tell_failed(RULE_OUTPUT_WRITE, "write() returned %d for sample %u: %s", result, i,
                        with.said);
    }
    tell_ok(RULE_OUTPUT_WAIT, "%d samples", SAMPLES);
    tell_ok(RULE_OUTPUT_WRITE, "%d samples", SAMPLES);
}

static void judge_reopening(const mrt_output *functions, mrt_plugin *self, const char *address)
{
    size_t before = 0;
    for (int i = 0; i < ROUNDS; ++i) {
        close_output(functions, self);
        if (open_at(functions, self, address) < 0) {
            tell_failed(RULE_OUTPUT_REOPEN, "closed and opened again it says: %s", with.said);
            return;
        }
        if (i == 1)
            before = trap_heap_bytes();
    }
    long heap = (long)trap_heap_bytes() - (long)before;
    if (heap > 64 * ROUNDS)
        tell_failed(RULE_OUTPUT_REOPEN, "each open() and close() leaves %ld bytes",
                    heap / (ROUNDS - 2));
    tell_ok(RULE_OUTPUT_REOPEN, "%d times", ROUNDS);
}

void cases_output(const examination *e)
{
    static const check_rule rules[] = {RULE_OUTPUT_WRITE, RULE_OUTPUT_WAIT, RULE_OUTPUT_REOPEN};
    const mrt_output *functions = types_interface(e->type, MRT_OUTPUT);
    const char *address = e->output_address ? e->output_address : "";
    mrt_plugin *self = make(e);
    if (!self)
        return;
    judge_absent(functions, self);
    if (open_at(functions, self, address) < 0) {
        for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
            tell_skipped(rules[i],
                         "nothing could be opened (%.300s): name a place with --output "
                         "ADDRESS",
                         with.said);
    } else {
        write_samples(functions, self);
        judge_reopening(functions, self, address);
        close_output(functions, self);
    }
    tell_doing(RULE_COUNT, "destroy()");
    e->type->destroy(self);
}
