/* marotte bench: how fast the engine is here, beside what this machine could do at most. */
#include "bench/bench.h"
#include "base/isa.h"
#include "base/pool.h"
#include "command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static const char help[] =
    "marotte bench [--quick] [--gate] [--json] [--only PART]\n\n"
    "Measures the engine on this machine, one thread unless it says more: every time beside the\n"
    "bandwidth of a plain copy, the rate of square roots and naive code, measured in turns in the\n"
    "same run. Times are the least of many rounds; ratios hold within a run. What a paper of 2005\n"
    "printed stands beside it for context: another computer, display included.\n\n"
    "  --quick      under 20 s: fewer rounds, cold caches only where they matter\n"
    "  --gate       fails when a ratio is not even half of what is promised\n"
    "  --only PART  grid, bones, factor, threads, frame, stage\n"
    "  --json       one object for machines\n\n"
    "MAROTTE_ISA=generic|v2|v3|v4 makes the engine use that instruction set, MAROTTE_THREADS=N so\n"
    "many threads.\n";

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
    bench_work work = {.name = "roof", .run = run, .data = &self->roof};
    bench_measure(&work, 1, 4 * self->rounds, self->seconds);
    return (double)used / work.least_ns;
}

mrt_result bench_machine(bench *self, error *err)
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
    bench_work roots = {.name = "roots", .run = bench_roof_roots, .data = &self->roof};
    bench_measure(&roots, 1, 40 * self->rounds, self->seconds);
    self->root_ns = roots.least_ns / BENCH_ROOTS;
    facts_number(self->told, "root_ns", "a square root", self->root_ns, 3, "ns");
    return MRT_OK;
}

void bench_memory(bench *self)
{
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        facts_number(self->told, "peak_memory_mb", "peak memory", (double)usage.ru_maxrss / 1024.0,
                     1, "MB");
}

static bool read_options(bench *self, int argc, char **argv, const part **out_only, error *err)
{
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--quick") == 0) {
            self->is_quick = true;
        } else if (strcmp(argv[i], "--json") == 0) {
            self->is_json = true;
        } else if (strcmp(argv[i], "--gate") == 0) {
            self->is_gate = true;
        } else if (strcmp(argv[i], "--only") == 0 && i + 1 < argc) {
            ++i;
            for (int k = 0; k < PARTS; ++k)
                if (strcmp(argv[i], parts[k].name) == 0)
                    *out_only = &parts[k];
            if (!*out_only) {
                error_set(err, MRT_ERR_ARGUMENT,
                          "--only %s: there are grid, bones, factor, threads, frame, stage",
                          argv[i]);
                return false;
            }
        } else {
            error_set(err, MRT_ERR_ARGUMENT, "\"%s\" is no option (marotte bench --help)", argv[i]);
            return false;
        }
    }
    return true;
}

static mrt_result measure(bench *self, const part *only, error *err)
{
    pool_share_from((double)INFINITY); /* one thread, but where threads are the subject */
    mrt_result result = bench_roof_create(&self->roof, (size_t)96 << 20, err);
    if (result >= 0)
        result = bench_machine(self, err);
    for (int i = 0; i < PARTS && result >= 0; ++i)
        if (!only || only == &parts[i])
            result = parts[i].run(self, err);
    if (result >= 0) {
        bench_memory(self);
        self->broken_count = bench_promises(self);
    }
    bench_roof_destroy(&self->roof);
    return result;
}

static int run(int argc, char **argv)
{
    bench self = {.rounds = 25, .seconds = 0.6};
    const part *only = NULL;
    error err = {""};
    if (!read_options(&self, argc, argv, &only, &err))
        return command_usage(&command_bench, "%s", err.text);
    if (self.is_quick) {
        self.rounds = 9;
        self.seconds = 0.08;
    }
    self.told = facts_create(self.is_json);
    if (!self.told) {
        (void)error_set(&err, MRT_ERR_MEMORY, "no memory");
        return command_failed(&command_bench, &err);
    }
    progress_start(&self.shown, "measuring");
    mrt_result result = measure(&self, only, &err);
    progress_end(&self.shown);
    if (result >= 0) {
        facts_finish(self.told);
        if (!self.is_gate || self.broken_count == 0)
            return COMMAND_DONE;
        fprintf(stderr, "marotte bench: %u of the ratios are not even half of what is promised\n",
                self.broken_count);
        return COMMAND_FAILED;
    }
    facts_abandon(self.told);
    return command_failed(&command_bench, &err);
}

const command command_bench = {"bench", "how fast the engine is here, and how fast it could be",
                               help, run};
