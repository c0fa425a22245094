/* What stands between a glove and the face: device_latency [--seconds N] [--gate TIMES]
 * An emulated CyberGlove streams at 150 Hz to the plugin cyberglove; its hand performs the puppet
 * through the real player, with one_hand. Prints for a plain line, for one that bunches by 16 ms
 * and for one that spoils a record in 50: what was lost, how well samples are timed, how long a
 * record takes from the write that held its last byte until process() has made its pull of it, and
 * what the reading thread costs; each with its bound. --gate: exits 1 when a figure is worse than
 * TIMES its bound: a busy machine may miss it. 77: there are no pseudo terminals. */
#include "base/clock.h"
#include "base/text.h"
#include "glove_child.h"
#include "glove_motion.h"
#include "glove_truth.h"
#include "glove_watch.h"
#include "unit/player_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RATE_HZ = 150, SECONDS_MAX = 400, OPTIONS_MAX = 12, EXIT_SKIPPED = 77 };
static const double settling_s = 1.0;   /* the two clocks meet */
static const double SECONDS_OTHER = 10; /* at most, for all but the plain line */

typedef struct journey {
    int32_t number;
    int64_t sample_ns, done_ns;
    uint8_t value[GLOVE_SENSORS];
    uint32_t value_count;
} journey;

typedef struct journeys {
    journey *at;
    uint32_t capacity, read_count, done_count;
} journeys;

static void see_sample(void *data, const mrt_channel *channels, const mrt_sample *sample)
{
    journeys *self = data;
    if (self->read_count == self->capacity)
        return;
    journey *j = &self->at[self->read_count++];
    j->number = glove_motion_number_in(channels, sample);
    j->sample_ns = sample->time_ns;
    for (uint32_t i = 0; i < sample->count && j->value_count < GLOVE_SENSORS; ++i)
        if (channels[i].semantic - MRT_CH_ANGLE < MRT_ANGLES)
            j->value[j->value_count++] = (uint8_t)sample->value[i];
}

/* Samples are performed in the order in which they were read. */
static void see_pull(void *data, const mrt_frame *frame, const mrt_pull *pull, int64_t done_ns)
{
    (void)frame;
    (void)pull;
    journeys *self = data;
    if (self->done_count < self->capacity)
        self->at[self->done_count++].done_ns = done_ns;
}

static mrt_result see_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    (void)data;
    (void)index;
    (void)time_s;
    (void)work_ns;
    (void)err;
    return MRT_OK;
}

typedef struct figures {
    uint32_t sent, spoiled, lost, bad;
    glove_spread time_error_ms, latency_ms;
    double reader_cpu;
} figures;

/* Between the first and the last record that arrived. */
static void count_losses(figures *out, const journeys *seen, const glove_truth *truth)
{
    int32_t last = seen->at[0].number - 1;
    for (uint32_t i = 0; i < seen->done_count; ++i) {
        const journey *j = &seen->at[i];
        for (int32_t number = last + 1; number <= j->number; ++number) {
            const glove_truth_row *row = glove_truth_find(truth, (uint32_t)number);
            bool is_spoiled = row && row->is_spoiled;
            out->sent += 1;
            out->spoiled += is_spoiled;
            out->lost += number < j->number && !is_spoiled;
        }
        const glove_truth_row *row = glove_truth_find(truth, (uint32_t)j->number);
        out->bad += !row || row->is_spoiled || j->number <= last ||
                    memcmp(j->value, row->record + 1, j->value_count) != 0;
        last = j->number;
    }
}

static mrt_result measure_times(figures *out, const journeys *seen, const glove_truth *truth,
                                error *err)
{
    double *error_ms = calloc(seen->capacity, sizeof *error_ms);
    double *latency_ms = calloc(seen->capacity, sizeof *latency_ms);
    size_t count = 0;
    for (uint32_t i = (uint32_t)(settling_s * RATE_HZ);
         error_ms && latency_ms && i < seen->done_count; ++i) {
        const journey *j = &seen->at[i];
        const glove_truth_row *row = glove_truth_find(truth, (uint32_t)j->number);
        if (!row)
            continue;
        error_ms[count] = (double)(j->sample_ns - row->sample_ns) * 1e-6;
        latency_ms[count++] = (double)(j->done_ns - row->written_ns) * 1e-6;
    }
    if (count > 0) {
        out->time_error_ms = glove_spread_of(error_ms, count);
        out->latency_ms = glove_spread_of(latency_ms, count);
    }
    free(error_ms);
    free(latency_ms);
    return count > 0 ? MRT_OK : error_set(err, MRT_ERR_IO, "no records have arrived");
}

static void print_log(log_queue *log)
{
    log_record record;
    while (log_pop(log, &record))
        if (record.level >= MRT_LOG_WARNING)
            fprintf(stderr, "%s: %s\n", record.source, record.text);
}

static mrt_result perform(figures *out, journeys *seen, const char *address, double seconds,
                          error *err)
{
    glove_stage stage;
    glove_watch watch = {see_sample, see_pull, seen};
    player_settings settings = {.fps = 60, .seconds = seconds, .clock = CLOCK_REAL};
    player_events events = {.frame = see_frame};
    player_report report;
    mrt_result result = glove_stage_create(
        &stage, BUILD_DIR, SOURCE_DIR "/rigs/puppet/puppet.rig.json", address, &watch, err);
    if (result < 0)
        return result;
    result = player_run(stage.performer, &stage.input, 1, &settings, &events, &report, err);
    if (result >= 0 && seen->done_count == 0)
        result = error_set(err, MRT_ERR_IO, "no records have arrived");
    if (result >= 0 && report.dropped + report.refused > 0) /* pulls are counted, not named */
        result = error_set(err, MRT_ERR_IO, "%u samples dropped and %u refused by the stage",
                           report.dropped, report.refused);
    if (stage.reader_time_s > 0)
        out->reader_cpu = stage.reader_cpu_s / stage.reader_time_s;
    print_log(stage.log);
    glove_stage_destroy(&stage);
    return result;
}

static mrt_result measure(figures *out, double seconds, const char *const *extra, error *err)
{
    const char *options[OPTIONS_MAX] = {"--numbered", "--motion",
                                        SOURCE_DIR "/plugins/log/demo_hand.csv"};
    for (int i = 0; extra[i]; ++i)
        options[3 + i] = extra[i];
    glove_child child;
    glove_truth truth = {0};
    journeys seen = {.capacity = (SECONDS_MAX + 10) * RATE_HZ};
    *out = (figures){0};
    mrt_result result =
        glove_child_start(&child, BUILD_DIR "/tests/device/glove_emulator", options, err);
    if (result < 0)
        return result;
    seen.at = calloc(seen.capacity, sizeof *seen.at);
    result = seen.at ? perform(out, &seen, child.address, seconds, err)
                     : error_set(err, MRT_ERR_MEMORY, "no memory");
    if (!glove_child_stop(&child) && result >= 0)
        result = error_set(err, MRT_ERR_IO, "the emulator failed");
    if (result >= 0)
        result = glove_truth_read(&truth, child.truth, err);
    if (result >= 0)
        result = measure_times(out, &seen, &truth, err);
    if (result >= 0)
        count_losses(out, &seen, &truth);
    glove_truth_finish(&truth);
    glove_child_finish(&child);
    free(seen.at);
    return result;
}

/* Returns how many times its bound the figure is; 0 for what is met. */
static double judge(const char *what, double value, double bound, const char *unit)
{
    printf("  %-34s %8.3f %-3s (bound %g%s%s) %s\n", what, value, unit, bound, *unit ? " " : "",
           unit, value <= bound ? "met" : "missed");
    return value <= bound ? 0 : bound > 0 ? value / bound : (double)INFINITY;
}

typedef struct line {
    const char *name;
    const char *const *options;
    bool is_plain; /* as the bytes come, not held back on purpose: latency is of interest */
} line;

/* The worst of them. */
static double report(const line *of, const figures *f)
{
    printf("%s: %u records, %u of them spoiled\n", of->name, f->sent, f->spoiled);
    double worst = judge("records lost", f->lost, 0, "");
    worst = fmax(worst, judge("records bad", f->bad, 0, ""));
    worst = fmax(worst, judge("sample time error, SD", f->time_error_ms.deviation, 0.5, "ms"));
    if (of->is_plain) {
        worst = fmax(worst, judge("written to pull, median", f->latency_ms.median, 1, "ms"));
        worst = fmax(worst, judge("written to pull, 99 %", f->latency_ms.p99, 4, "ms"));
    }
    worst = fmax(worst, judge("reading thread, of a core", 100 * f->reader_cpu, 2, "%"));
    return worst;
}

static const char *const no_options[] = {NULL};
static const char *const bunched[] = {"--latency-ms", "16", NULL};
static const char *const spoiled[] = {"--spoil-every", "50", NULL};
static const line lines[] = {
    {"150 Hz", no_options, true},
    {"150 Hz, bunched by 16 ms", bunched, false},
    {"150 Hz, one record in 50 spoiled", spoiled, true},
};
enum { LINES = sizeof lines / sizeof *lines };

static bool read_arguments(int argc, char **argv, double *out_seconds, double *out_gate)
{
    for (int i = 1; i + 1 < argc; i += 2) {
        double *number = strcmp(argv[i], "--seconds") == 0 ? out_seconds
                         : strcmp(argv[i], "--gate") == 0  ? out_gate
                                                           : NULL;
        if (!number || !text_double(text_view_of(argv[i + 1], strlen(argv[i + 1])), number))
            return false;
    }
    return argc % 2 == 1 && *out_seconds >= 2 && *out_seconds <= SECONDS_MAX;
}

int main(int argc, char **argv)
{
    double seconds = 10, gate = (double)INFINITY, worst = 0;
    error err = {""};
    if (!read_arguments(argc, argv, &seconds, &gate)) {
        fprintf(stderr, "usage: device_latency [--seconds 2..%d] [--gate TIMES]\n", SECONDS_MAX);
        return 2;
    }
    for (int i = 0; i < LINES; ++i) {
        figures f;
        double some = i == 0 || seconds < SECONDS_OTHER ? seconds : SECONDS_OTHER;
        mrt_result result = measure(&f, some, lines[i].options, &err);
        if (result == MRT_ERR_UNSUPPORTED) {
            printf("SKIPPED: there are no pseudo terminals here\n");
            return EXIT_SKIPPED;
        }
        if (result < 0) {
            fprintf(stderr, "%s: %s\n", lines[i].name, err.text);
            return 1;
        }
        worst = fmax(worst, report(&lines[i], &f));
    }
    return worst > gate;
}
