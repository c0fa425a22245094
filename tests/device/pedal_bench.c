#include "pedal_bench.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const uint8_t vec_descriptor[] = {0x05, 0x0c, 0x09, 0x03, 0xa1, 0x01, 0x05, 0x09, 0x19,
                                         0x01, 0x29, 0x03, 0x15, 0x00, 0x25, 0x01, 0x35, 0x00,
                                         0x45, 0x01, 0x65, 0x00, 0x55, 0x00, 0x75, 0x01, 0x95,
                                         0x03, 0x81, 0x02, 0x95, 0x0d, 0x81, 0x03, 0xc1, 0x00};
const pedal_model VEC = {.vendor = 0x05f3,
                         .product = 0x00ff,
                         .name = "VEC USB Footpedal",
                         .endpoint = 0x81,
                         .packet_bytes = 8,
                         .report_descriptor = vec_descriptor,
                         .report_descriptor_bytes = sizeof vec_descriptor};

/* A keyboard with report number 1: modifiers, a constant byte, five keys. */
static const uint8_t pcsensor_descriptor[] = {
    0x05, 0x01, 0x09, 0x06, 0xa1, 0x01, 0x85, 0x01, 0x05, 0x07, 0x19, 0xe0, 0x29, 0xe7, 0x15,
    0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0x95, 0x01, 0x75, 0x08, 0x81, 0x01,
    0x95, 0x05, 0x75, 0x08, 0x15, 0x00, 0x25, 0x65, 0x19, 0x00, 0x29, 0x65, 0x81, 0x00, 0xc0};
const pedal_model PCSENSOR = {.vendor = 0x0c45,
                              .product = 0x7403,
                              .name = "FootSwitchV1.0",
                              .boot_protocol = 1,
                              .endpoint = 0x81,
                              .packet_bytes = 8,
                              .report_descriptor = pcsensor_descriptor,
                              .report_descriptor_bytes = sizeof pcsensor_descriptor};

/* ---- a host ---- */

int64_t bench_now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void host_log(const mrt_host *host, int32_t level, const char *text)
{
    pedal_bench *self = host->data;
    memmove(self->text[1], self->text[0], (BENCH_TEXTS - 1) * sizeof self->text[0]);
    memmove(self->level + 1, self->level, (BENCH_TEXTS - 1) * sizeof self->level[0]);
    snprintf(self->text[0], BENCH_TEXT, "%s", text);
    self->level[0] = level;
    if (self->text_count < BENCH_TEXTS)
        self->text_count += 1;
}

static int64_t host_now_ns(const mrt_host *host)
{
    (void)host;
    return bench_now_ns();
}

static int64_t host_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    pedal_bench *self = host->data;
    struct timespec until = {.tv_sec = (time_t)(time_ns / 1000000000),
                             .tv_nsec = (long)(time_ns % 1000000000)};
    self->wait_count += 1;
    if (!self->is_stopping)
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
    return bench_now_ns();
}

static void host_request_restart(const mrt_host *host)
{
    pedal_bench *self = host->data;
    self->restart_count += 1;
}

static const void *host_service(const mrt_host *host, const char *id)
{
    (void)host;
    (void)id;
    return NULL;
}

static const void *interface_of(const mrt_plugin_type *type, const char *id)
{
    for (const mrt_interface *i = type->interfaces; i->id; ++i)
        if (strcmp(i->id, id) == 0)
            return i->functions;
    fail_msg("no interface %s", id);
    return NULL;
}

void bench_create(pedal_bench *out)
{
    memset(out, 0, sizeof *out);
    void *library = dlopen(BUILD_DIR "/plugins/pedal.so", RTLD_NOW | RTLD_LOCAL);
    if (!library)
        fail_msg("%s", dlerror());
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    assert_non_null(types);
    out->type = types[0];
    assert_int_equal(out->type->param_count, BENCH_PARAMS);
    out->input = interface_of(out->type, MRT_INPUT);
    out->devices = interface_of(out->type, MRT_DEVICES);
    out->host = (mrt_host){
        out, host_log, host_now_ns, host_wait_until_ns, host_request_restart, host_service};
    out->plugin = out->type->create(&out->host);
    assert_non_null(out->plugin);
    for (int i = 0; i < BENCH_PARAMS; ++i)
        out->params[i] = out->type->params[i].initial;
}

void bench_destroy(pedal_bench *self)
{
    self->type->destroy(self->plugin);
}

mrt_result bench_open(pedal_bench *self, const char *address)
{
    return self->input->open(self->plugin, address, self->params);
}

void bench_close(pedal_bench *self)
{
    self->input->close(self->plugin);
}

void bench_reopen(pedal_bench *self, const char *address)
{
    int64_t until_ns = bench_now_ns() + 3000 * BENCH_MS;
    for (;;) {
        bench_close(self);
        if (bench_open(self, address) == MRT_OK)
            return;
        if (bench_now_ns() > until_ns)
            fail_msg("not back: %s", self->text[0]);
        host_wait_until_ns(&self->host, bench_now_ns() + 5 * BENCH_MS);
    }
}

mrt_result bench_read(pedal_bench *self, int64_t span_ns, mrt_sample *out)
{
    mrt_result result =
        self->input->read(self->plugin, self->params, bench_now_ns() + span_ns, out);
    if (result == MRT_OK)
        assert_true(out->time_ns <= bench_now_ns());
    return result;
}

static bool is_repeated(const pedal_bench *self, const mrt_sample *sample)
{
    return self->last.count == sample->count &&
           memcmp(self->last.value, sample->value, sizeof sample->value) == 0;
}

static bool shows(const mrt_sample *sample, const float expected[3])
{
    bool is_same = true;
    for (uint32_t i = 0; i < sample->count && i < 3; ++i)
        is_same = is_same && sample->value[i] == expected[i];
    return is_same;
}

void bench_expect(pedal_bench *self, float first, float second, float third)
{
    const float expected[] = {first, second, third};
    int64_t until_ns = bench_now_ns() + BENCH_PATIENCE;
    mrt_sample sample;
    for (;;) {
        assert_int_equal(bench_read(self, until_ns - bench_now_ns(), &sample), MRT_OK);
        bool was_known = is_repeated(self, &sample);
        self->last = sample;
        if (shows(&sample, expected))
            return;
        if (!was_known)
            fail_msg("%g %g %g, expected %g %g %g", (double)sample.value[0],
                     (double)sample.value[1], (double)sample.value[2], (double)first,
                     (double)second, (double)third);
    }
}

pedal_unit *bench_begin(pedal_bench *out, void *machine)
{
    pedal_unit *unit = pedal_double_plug(machine, "1-2", 2, &VEC);
    bench_create(out);
    assert_int_equal(bench_open(out, ""), MRT_OK);
    bench_expect(out, 0, 0, 0);
    return unit;
}

void bench_expect_silence(pedal_bench *self)
{
    int64_t until_ns = bench_now_ns() + 30 * BENCH_MS;
    mrt_sample sample;
    while (bench_read(self, until_ns - bench_now_ns(), &sample) != MRT_TIMEOUT) {
        assert_true(is_repeated(self, &sample));
        self->last = sample;
    }
}

bool bench_has_said(const pedal_bench *self, const char *part)
{
    for (uint32_t i = 0; i < self->text_count; ++i)
        if (strstr(self->text[i], part))
            return true;
    return false;
}

void bench_forget(pedal_bench *self)
{
    self->text_count = 0;
}

/* ---- what it costs ---- */

uint32_t bench_open_files(void)
{
    DIR *listing = opendir("/proc/self/fd");
    uint32_t count = 0;
    while (listing && readdir(listing))
        ++count;
    if (listing)
        closedir(listing);
    return count;
}

bool bench_has_open_files(uint32_t count)
{
    int64_t until_ns = bench_now_ns() + BENCH_PATIENCE;
    while (bench_open_files() > count && bench_now_ns() < until_ns)
        host_wait_until_ns(&(mrt_host){.data = &(pedal_bench){.restart_count = 0}},
                           bench_now_ns() + 10 * BENCH_MS);
    return bench_open_files() <= count;
}

int64_t bench_cpu_ns(void)
{
    struct timespec used;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return (int64_t)used.tv_sec * 1000000000 + used.tv_nsec;
}

/* ---- every test's own ---- */

const char *bench_config(void)
{
    static char folder[512];
    snprintf(folder, sizeof folder, "%s/tests/device/pedal_config.%ld.tmp", BUILD_DIR,
             (long)getpid());
    return folder;
}

static void remove_config(void)
{
    static const char *const parts[] = {"marotte/pedals/05f3_00ff.layout",
                                        "marotte/pedals/0c45_7403.layout",
                                        "marotte/pedals/1234_0001.layout",
                                        "marotte/pedals",
                                        "marotte",
                                        ""};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
        char path[600];
        snprintf(path, sizeof path, "%s/%s", bench_config(), parts[i]);
        remove(path);
    }
}

int bench_set_up(void **state)
{
    setenv("XDG_CONFIG_HOME", bench_config(), 1);
    *state = pedal_double_create();
    return 0;
}

int bench_tear_down(void **state)
{
    pedal_double_destroy(*state);
    remove_config();
    return 0;
}
