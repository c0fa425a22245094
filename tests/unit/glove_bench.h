/* glove_bench.h - plugins/cyberglove as the host sees it, against a glove on a pty: for the tests
 * glove_plugin.c and glove_lost.c. Host, plugin and glove share a thread and the virtual clock.
 * Limits of waiting are a tenth of what they are in life (the parameter "patience"). Include after
 * cmocka.h. */
#ifndef MAROTTE_TESTS_UNIT_GLOVE_BENCH_H
#define MAROTTE_TESTS_UNIT_GLOVE_BENCH_H
#include <marotte/plugin.h>

#include "glove_talker.h"

#include <dlfcn.h>

enum { BAUD, RATE, MODE, STREAM, STAMPS, HAND, SWITCH, FILTER, PATIENCE, PARAM_COUNT };
static const int64_t MS = 1000000;

/* ---- the host ---- */

typedef struct bench {
    mrt_host host;
    bool stopping;
    int log_count[4];
    char last_error[1024], warnings[2048];
    int restarts;
    const mrt_plugin_type *type;
    const mrt_input *input;
    const mrt_devices *devices;
    mrt_plugin *plugin;
    double params[PARAM_COUNT];
    talker talker;
    bool has_talker;
    virtual_device device;
} bench;

static inline int64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static inline void host_log(const mrt_host *host, int32_t level, const char *text)
{
    bench *self = host->data;
    self->log_count[level] += 1;
    if (level == MRT_LOG_ERROR)
        snprintf(self->last_error, sizeof self->last_error, "%s", text);
    if (level == MRT_LOG_WARNING) {
        size_t used = strlen(self->warnings);
        snprintf(self->warnings + used, sizeof self->warnings - used, "%s\n", text);
    }
}

static inline int64_t host_now_ns(const mrt_host *host)
{
    (void)host;
    return now_ns();
}

static inline int64_t host_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    const bench *self = host->data;
    const struct timespec until = {(time_t)(time_ns / 1000000000), (long)(time_ns % 1000000000)};
    if (!self->stopping)
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
    return now_ns();
}

static inline void host_request_restart(const mrt_host *host)
{
    bench *self = host->data;
    self->restarts += 1;
}

static const void *host_service(const mrt_host *host, const char *id)
{
    (void)host;
    (void)id;
    return NULL;
}

static inline int64_t bench_due_ns(void *data)
{
    const bench *self = data;
    return self->has_talker ? talker_due_ns(&self->talker) : INT64_MAX;
}

static inline void bench_run(void *data, int64_t time_ns)
{
    talker_run(&((bench *)data)->talker, time_ns);
}

static inline void bench_written(void *data, int64_t time_ns, int file, size_t size)
{
    bench *self = data;
    if (self->has_talker)
        talker_written(&self->talker, time_ns, file, size);
}

static inline int glove_set_up(void **state)
{
    bench *b = calloc(1, sizeof *b);
    assert_non_null(b);
    b->device = (virtual_device){bench_due_ns, bench_run, bench_written, b};
    virtual_clock_take(&b->device, 1000 * 1000 * MS);
    b->host = (mrt_host){
        b, host_log, host_now_ns, host_wait_until_ns, host_request_restart, host_service};
    void *library = dlopen(BUILD_DIR "/plugins/cyberglove.so", RTLD_NOW | RTLD_LOCAL);
    if (!library)
        fail_msg("%s", dlerror());
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    assert_non_null(types);
    b->type = types[0];
    assert_string_equal(b->type->interfaces[0].id, MRT_INPUT);
    assert_string_equal(b->type->interfaces[1].id, MRT_DEVICES);
    b->input = b->type->interfaces[0].functions;
    b->devices = b->type->interfaces[1].functions;
    b->plugin = b->type->create(&b->host);
    assert_non_null(b->plugin);
    assert_int_equal(b->type->param_count, PARAM_COUNT);
    for (int i = 0; i < PARAM_COUNT; ++i)
        b->params[i] = b->type->params[i].initial;
    b->params[PATIENCE] = 0.1;
    b->talker = (talker){.sensors = 22};
    *state = b;
    return 0;
}

static inline int glove_tear_down(void **state)
{
    bench *b = *state;
    b->type->destroy(b->plugin);
    if (b->has_talker)
        talker_stop(&b->talker);
    virtual_clock_give_back();
    free(b);
    return 0;
}

static inline mrt_result open_path(bench *b, const char *path)
{
    char address[128];
    snprintf(address, sizeof address, "serial:%s", path);
    return b->input->open(b->plugin, address, b->params);
}

static inline mrt_result open_talker(bench *b)
{
    if (!b->has_talker)
        talker_start(&b->talker);
    b->has_talker = true;
    return open_path(b, b->talker.path);
}

static inline void assert_opens(bench *b)
{
    if (open_talker(b) != MRT_OK)
        fail_msg("%s", b->last_error);
}

static inline mrt_result read_within(bench *b, int64_t span_ns, mrt_sample *out)
{
    return b->input->read(b->plugin, b->params, now_ns() + span_ns, out);
}

static inline void assert_reads(bench *b, mrt_sample *out)
{
    mrt_result result = MRT_TIMEOUT;
    for (int i = 0; i < 20 && result == MRT_TIMEOUT; ++i)
        result = read_within(b, 50 * MS, out);
    if (result != MRT_OK)
        fail_msg("%d %s", result, b->last_error);
}

static inline void assert_error_says(const bench *b, const char *part)
{
    if (!strstr(b->last_error, part))
        fail_msg("\"%s\" lacks \"%s\"", b->last_error, part);
}

#define GLOVE_TEST(name) cmocka_unit_test_setup_teardown(name, glove_set_up, glove_tear_down)

#endif
