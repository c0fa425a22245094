/* device/pedal_bench.h - plugins/pedal as a host sees it, beside a double of the machine's USB: for
 * the tests pedal_*.c. */
#ifndef MAROTTE_TESTS_PEDAL_BENCH_H
#define MAROTTE_TESTS_PEDAL_BENCH_H
#include "pedal_double.h"

#include <marotte/plugin.h>

enum { BENCH_TEXTS = 32, BENCH_TEXT = 600, BENCH_PARAMS = 8 };
enum { BENCH_FIRST, BENCH_SWITCH_1, BENCH_DEBOUNCE = 6, BENCH_LEARN = 7 };
static const int64_t BENCH_MS = 1000000;
static const int64_t BENCH_PATIENCE = 60000000000; /* of a busy machine */

typedef struct pedal_bench {
    mrt_host host;
    const mrt_plugin_type *type;
    const mrt_input *input;
    const mrt_devices *devices;
    mrt_plugin *plugin;
    uint32_t wait_count; /* that the plugin has asked of the host */
    double params[BENCH_PARAMS];
    char text[BENCH_TEXTS][BENCH_TEXT]; /* what was logged last, newest first */
    int32_t level[BENCH_TEXTS];
    uint32_t text_count, restart_count;
    bool is_stopping; /* waits end at once */
    mrt_sample last;
} pedal_bench;

void bench_create(pedal_bench *out);
void bench_destroy(pedal_bench *self);

int64_t bench_now_ns(void);
/* A VEC pedal in the socket 1-2 of this machine (pedal_double), opened as "", all up. */
pedal_unit *bench_begin(pedal_bench *out, void *machine);
mrt_result bench_open(pedal_bench *self, const char *address);
/* As a host does when a device has gone: closes and opens until it is back, 3 s at most. */
void bench_reopen(pedal_bench *self, const char *address);
void bench_close(pedal_bench *self);
mrt_result bench_read(pedal_bench *self, int64_t span_ns, mrt_sample *out);
/* A sample within a second has these values (of as many channels); before it there is at most what
 * was known. */
void bench_expect(pedal_bench *self, float first, float second, float third);
/* No sample within 30 ms, but for a repeated state. */
void bench_expect_silence(pedal_bench *self);
/* A line of the log says this; since bench_forget. */
bool bench_has_said(const pedal_bench *self, const char *part);
void bench_forget(pedal_bench *self);

uint32_t bench_open_files(void);
/* What is open has come down to this, perhaps after a while: umockdev closes when it finds time. */
bool bench_has_open_files(uint32_t count);
int64_t bench_cpu_ns(void); /* that this thread has used */

/* Every test's own: a machine without pedals, and a folder for the user's configuration. */
const char *bench_config(void); /* the folder */
int bench_set_up(void **state); /* *state: pedal_double */
int bench_tear_down(void **state);
#define TEST(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
/* main of such tests; needs <cmocka.h>. */
#define BENCH_MAIN(tests)                                                                          \
    int main(int argc, char **argv)                                                                \
    {                                                                                              \
        (void)argc;                                                                                \
        int left_out = pedal_double_enter(argv);                                                   \
        return left_out != 0 ? left_out : cmocka_run_group_tests(tests, NULL, NULL);               \
    }

extern const pedal_model VEC, PCSENSOR;
#define REPORT(unit, ...)                                                                          \
    pedal_unit_report((unit), (const uint8_t[]){__VA_ARGS__},                                      \
                      sizeof((const uint8_t[]){__VA_ARGS__}))

#endif
