#include "bench/bench.h"

#include "base/clock.h"
#include "base/isa.h"
#include "base/large.h"
#include "base/pool.h"
#include "cli/command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* ---- measurement ---- */

static double time_one(bench_work *work)
{
    if (work->before)
        work->before(work->data);
    else
        work->run(work->data); /* loads its data into the caches, in place of the others' */
    int64_t start_ns = clock_now_ns();
    work->run(work->data);
    return (double)(clock_now_ns() - start_ns);
}

uint32_t bench_measure(bench_work *work, uint32_t count, uint32_t rounds, double seconds)
{
    uint32_t round = 0;
    for (uint32_t i = 0; i < count; ++i) {
        (void)time_one(&work[i]);
        work[i].least_ns = 0.0;
    }
    int64_t end_ns = clock_now_ns() + (int64_t)(seconds * 1e9);
    while (round < rounds && (round < 3 || clock_now_ns() < end_ns)) {
        for (uint32_t i = 0; i < count; ++i) {
            double took_ns = time_one(&work[i]);
            if (round == 0 || took_ns < work[i].least_ns)
                work[i].least_ns = took_ns;
            if (work[i].took_ns)
                work[i].took_ns[round] = took_ns;
        }
        ++round;
    }
    return round;
}

/* ---- goals ---- */

/* A machine is quiet while other programs use at most this share of one processor. */
static const double quiet_share = 0.1;

/* Other programs affect ratios too, so a gate requires half of the goal. */
static const double gate_share = 0.5;

static void note(bench *self, const bench_promise *promise)
{
    if (self->promise_count < BENCH_PROMISES)
        self->promise[self->promise_count++] = *promise;
}

void bench_at_least(bench *self, const char *what, double measured, double promised)
{
    note(self, &(bench_promise){what, "", measured, promised, false, true});
}

void bench_at_most(bench *self, const char *what, double measured, double promised)
{
    note(self, &(bench_promise){what, "", measured, promised, true, true});
}

void bench_at_most_ms(bench *self, const char *what, double measured_ms, double promised_ms)
{
    note(self, &(bench_promise){what, " ms", measured_ms, promised_ms, true, false});
}

static bool is_kept(const bench_promise *p, double share)
{
    return p->is_most ? p->measured * share <= p->promised : p->measured >= p->promised * share;
}

/* Prints the results. Returns the number of ratios that miss half of their goal. */
static uint32_t bench_promises(bench *self)
{
    uint32_t broken = 0;
    if (self->promise_count > 0)
        bench_title(self, "Goals, for a quiet machine with two processors");
    if (self->promise_count > 0 && self->others_busy > quiet_share)
        facts_warning(self->told, "others_busy_processors",
                      "the machine is busy, so that figures may be too slow: other programs use",
                      self->others_busy, 1, "processors");
    for (uint32_t i = 0; i < self->promise_count; ++i) {
        const bench_promise *p = &self->promise[i];
        char line[160];
        bool is_broken = p->is_gated && !is_kept(p, gate_share);
        broken += is_broken;
        const char *verdict = is_kept(p, 1.0)                   ? "kept"
                              : is_broken                       ? "far missed"
                              : self->others_busy > quiet_share ? "not judged"
                                                                : "missed";
        snprintf(line, sizeof line, "%-40s %9.3f%s, goal: at %s %g%s", p->what, p->measured,
                 p->unit, p->is_most ? "most" : "least", p->promised, p->unit);
        const facts_cell cells[] = {
            {"what", p->what, 0.0, 0},
            {"measured", NULL, p->measured, 6},
            {p->is_most ? "at_most" : "at_least", NULL, p->promised, 6},
            {"is_kept", NULL, is_kept(p, 1.0), -1},
            {"is_half_kept", NULL, is_kept(p, gate_share), -1},
            {"is_gated", NULL, p->is_gated, -1},
        };
        facts_row(self->told, "promises", verdict, line, cells, sizeof cells / sizeof cells[0]);
    }
    return broken;
}

/* ---- limits of the machine ---- */

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { ALIGNMENT = 64, STAGGER = 80 * sizeof(float) };

mrt_result bench_roof_create(bench_roof *out, size_t bytes, error *err)
{
    bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    *out = (bench_roof){.bytes = bytes, .used = bytes};
    out->from = large_alloc(bytes);
    out->to = large_alloc(bytes + STAGGER);
    out->other = large_alloc(bytes + 2 * STAGGER);
    if (!out->from || !out->to || !out->other) {
        bench_roof_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory to measure the machine with");
    }
    for (size_t i = 0; i < bytes / sizeof(float); ++i)
        out->from[i] = 1.0f + (float)(i % 1000) * 0.01f;
    memset(out->to, 0, bytes);
    memset(out->other, 0, bytes);
    return MRT_OK;
}

void bench_roof_destroy(bench_roof *self)
{
    large_free(self->from);
    large_free(self->to);
    large_free(self->other);
    *self = (bench_roof){0};
}

void bench_roof_copy(void *roof)
{
    const bench_roof *self = roof;
    memcpy(self->to, self->from, self->used / 2);
}

void bench_roof_triad(void *roof)
{
    const bench_roof *self = roof;
    size_t count = self->used / 3 / ALIGNMENT * (ALIGNMENT / sizeof(float));
    const float *a = self->from, *b = self->other;
    float *out = self->to;
#ifdef __SSE2__
    const __m128 scale = _mm_set1_ps(0.5f);
    for (size_t i = 0; i < count; i += 4)
        _mm_stream_ps(out + i,
                      _mm_add_ps(_mm_load_ps(a + i), _mm_mul_ps(scale, _mm_load_ps(b + i))));
    _mm_sfence();
#else
    for (size_t i = 0; i < count; ++i)
        out[i] = a[i] + 0.5f * b[i];
#endif
}

static void bench_roof_roots(void *roof)
{
    const bench_roof *self = roof;
    const float *restrict from = self->from;
    float *restrict to = self->to;
    for (int i = 0; i < BENCH_ROOTS; ++i)
        to[i] = sqrtf(from[i]);
}

void bench_roof_flush(void *roof)
{
    const bench_roof *self = roof;
    volatile float sink = 0.0f;
    float sum = 0.0f;
    for (size_t i = 0; i < self->bytes / sizeof(float); i += ALIGNMENT / sizeof(float))
        sum += self->other[i]; /* only read: written data would be written back to memory later */
    sink = sum;
    (void)sink;
}

/* ---- other programs ---- */

/* Reads the ticks of all processors since the start of the system: busy, and in total. Returns
 * false if unknown. */
static bool read_ticks(double *out_busy, double *out_all)
{
    unsigned long long t[8] = {0};
    FILE *stream = fopen("/proc/stat", "re");
    int count = stream ? fscanf(stream, "cpu %llu %llu %llu %llu %llu %llu %llu %llu", &t[0], &t[1],
                                &t[2], &t[3], &t[4], &t[5], &t[6], &t[7])
                       : 0;
    if (stream)
        fclose(stream);
    *out_all = 0.0;
    for (int i = 0; i < 8; ++i)
        *out_all += (double)t[i];
    *out_busy = *out_all - (double)t[3] - (double)t[4]; /* minus idle, and waiting for a disk */
    return count == 8;
}

/* Returns how many processors other programs use while this one sleeps for half a second. */
static double others_busy(void)
{
    double busy[2], all[2];
    if (!read_ticks(&busy[0], &all[0]))
        return 0.0;
    clock_sleep_until_ns(clock_now_ns() + NS_PER_S / 2);
    if (!read_ticks(&busy[1], &all[1]) || !(all[1] > all[0]))
        return 0.0;
    return (busy[1] - busy[0]) / (all[1] - all[0]) * (double)sysconf(_SC_NPROCESSORS_ONLN);
}

static void note_others(bench *self)
{
    const double busy = others_busy();
    self->others_busy = busy > self->others_busy ? busy : self->others_busy;
}

/* ---- the command ---- */

static const char help[] =
    "marotte bench [--quick] [--gate] [--json] [--only PART] [--face FACE]\n"
    "\n"
    "Measures the engine on this machine, on one thread if not stated otherwise. Each time is\n"
    "compared with a plain copy of memory, with square roots and with naive code, measured in\n"
    "turns in the same run. Times are the least of many rounds; compare ratios only within a\n"
    "run. The numbers that the paper printed in 2005 are from another computer, with display.\n"
    "\n"
    "  --quick      under 20 s: fewer rounds, cold caches only where they matter\n"
    "  --gate       exit code 1 if a ratio misses half of its goal\n"
    "  --only PART  grid, bones, factor, threads, frame or stage\n"
    "  --face FACE  the face that performs the frames; if not given, the puppet\n"
    "  --json       print the results as one JSON object\n"
    "\n"
    "Environment: MAROTTE_ISA=generic|v2|v3|v4 chooses the instruction set, MAROTTE_THREADS=N\n"
    "the number of threads.\n";

typedef struct part {
    const char *name;
    mrt_result (*run)(bench *self, error *err);
} part;
static const part parts[] = {
    {"grid", bench_grid},       {"bones", bench_bones}, {"factor", bench_factor},
    {"threads", bench_threads}, {"frame", bench_frame}, {"stage", bench_stage},
};
enum { PARTS = sizeof parts / sizeof parts[0] };

void bench_title(const bench *self, const char *title)
{
    if (!self->is_json)
        printf("\n%s\n", title);
}

static long cache_bytes(int name)
{
    long size = sysconf(name);
    return size > 0 ? size : 0;
}

void bench_processor(char *out, size_t capacity)
{
    char line[256];
    FILE *stream = fopen("/proc/cpuinfo", "re");
    snprintf(out, capacity, "unknown");
    while (stream && fgets(line, sizeof line, stream))
        if (strncmp(line, "model name", 10) == 0 && strchr(line, ':')) {
            snprintf(out, capacity, "%.100s", strchr(line, ':') + 2);
            out[strcspn(out, "\n")] = '\0';
            break;
        }
    if (stream)
        fclose(stream);
}

static double bandwidth(bench *self, void (*run)(void *), size_t used)
{
    self->roof.used = used;
    bench_work work = {.run = run, .data = &self->roof};
    bench_measure(&work, 1, 4 * self->rounds, self->seconds);
    return (double)used / work.least_ns;
}

static mrt_result bench_machine(bench *self, error *err)
{
    (void)err;
    char name[128], text[192];
    bench_processor(name, sizeof name);
    facts_text(self->told, "processor", "processor", name);
    snprintf(text, sizeof text, "%ld KiB first, %ld KiB second, %ld MiB last level",
             cache_bytes(_SC_LEVEL1_DCACHE_SIZE) / 1024, cache_bytes(_SC_LEVEL2_CACHE_SIZE) / 1024,
             cache_bytes(_SC_LEVEL3_CACHE_SIZE) / 1024 / 1024);
    facts_text(self->told, "caches", "caches", text);
    facts_text(self->told, "instruction_set", "instructions", isa_name(isa_now()));
    facts_number(self->told, "copy_hot_gb_per_s", "copy, 2 MiB",
                 bandwidth(self, bench_roof_copy, (size_t)2 << 20), 1, "GB/s");
    facts_number(self->told, "copy_far_gb_per_s", "copy, 64 MiB",
                 bandwidth(self, bench_roof_copy, (size_t)64 << 20), 1, "GB/s");
    facts_number(self->told, "triad_far_gb_per_s", "triad around caches",
                 bandwidth(self, bench_roof_triad, (size_t)64 << 20), 1, "GB/s");
    bench_work roots = {.run = bench_roof_roots, .data = &self->roof};
    bench_measure(&roots, 1, 40 * self->rounds, self->seconds);
    self->root_ns = roots.least_ns / BENCH_ROOTS;
    facts_number(self->told, "root_ns", "a square root", self->root_ns, 3, "ns");
    return MRT_OK;
}

/* latency from a device to the published face */
static void bench_memory(bench *self)
{
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        facts_number(self->told, "peak_memory_mb", "peak memory", (double)usage.ru_maxrss / 1024.0,
                     1, "MB");
}

typedef struct bench_options {
    bool is_quick, is_json, is_gate;
    const part *only; /* NULL: all */
    const char *face;
} bench_options;

static int read_part(void *to, const command *self, const char *name, const char *text)
{
    for (int i = 0; i < PARTS; ++i)
        if (strcmp(text, parts[i].name) == 0) {
            *(const part **)to = &parts[i];
            return COMMAND_DONE;
        }
    return command_usage(self, "--%s %s: choose grid, bones, factor, threads, frame or stage", name,
                         text);
}

#define AT(member) .offset = offsetof(bench_options, member)
static const command_option option_table[] = {
    {"quick", COMMAND_FLAG, AT(is_quick)},
    {"gate", COMMAND_FLAG, AT(is_gate)},
    {"only", COMMAND_READ, AT(only), .read = read_part},
    {"face", COMMAND_TEXT, AT(face)},
    {"json", COMMAND_FLAG, AT(is_json)},
    {.name = NULL},
};

static mrt_result measure(bench *self, const part *only, error *err)
{
    pool_share_from((double)INFINITY); /* one thread, except where threads are the subject */
    note_others(self);
    mrt_result result = bench_roof_create(&self->roof, (size_t)96 << 20, err);
    if (result >= 0)
        result = bench_machine(self, err);
    for (int i = 0; i < PARTS && result >= 0; ++i)
        if (!only || only == &parts[i])
            result = parts[i].run(self, err);
    if (result >= 0) {
        bench_memory(self);
        note_others(self);
        self->broken_count = bench_promises(self);
    }
    bench_roof_destroy(&self->roof);
    return result;
}

static int run(int argc, char **argv)
{
    bench_options options = {.only = NULL};
    error err = {""};
    int code = command_options(&options, &command_bench, option_table, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    bench self = {.rounds = options.is_quick ? 9 : 25,
                  .seconds = options.is_quick ? 0.08 : 0.6,
                  .is_quick = options.is_quick,
                  .is_json = options.is_json,
                  .face = options.face,
                  .told = facts_create(options.is_json ? FACTS_JSON : FACTS_LINES)};
    if (!self.told)
        return command_failed(&command_bench, &(error){"no memory"});
    progress_start(&self.shown, "measuring");
    mrt_result result = measure(&self, options.only, &err);
    progress_end(&self.shown);
    code = command_end(&command_bench, self.told, result, &err);
    if (code != COMMAND_DONE || !options.is_gate || self.broken_count == 0)
        return code;
    fprintf(stderr, "marotte bench: %u ratios miss half of their goal\n", self.broken_count);
    return COMMAND_FAILED;
}

const command command_bench = {
    .name = "bench",
    .summary = "measure the speed of the engine on this computer",
    .help = help,
    .examples = "bench --quick\n"
                "bench --quick --only frame\n",
    .run = run,
    .options = option_table,
};
