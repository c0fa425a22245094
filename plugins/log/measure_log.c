/* measure_log LOG... - measures the recordings of a glove. Per sensor: the range from the 1st to
 * the 99th percentile, the quantisation step, the noise at rest and the size of a change. Per log:
 * the rate and the share of records that repeat the previous one. It produced the tables of
 * plugins/log/README.md and the noise of the demos. */
#include "log_parse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOG_MAX = 16, WINDOW_RECORDS = 15 };

static const double SAME_LEVEL_RAD = 2e-4; /* the recordings round to five decimals */
static const double REST_STEPS = 2.5;      /* a window that moves by less is at rest */

static int compare_doubles(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

static double value_of(const log_data *log, size_t record, uint32_t channel)
{
    return (double)log->value[record * log->channel_count + channel];
}

static double percentile(const double *sorted, size_t count, double part)
{
    return sorted[(size_t)(part * (double)(count - 1) + 0.5)];
}

/* Returns the median gap between neighbouring levels, of gaps at most 1.5 times the smallest one;
 * larger gaps skip levels. Returns 0 if there are no two levels. Sorts `values`. */
static double step_of(double *values, size_t count, double *scratch)
{
    qsort(values, count, sizeof *values, compare_doubles);
    size_t gap_count = 0;
    for (size_t i = 1; i < count; ++i)
        if (values[i] - values[i - 1] > SAME_LEVEL_RAD)
            scratch[gap_count++] = values[i] - values[i - 1];
    if (gap_count == 0)
        return 0.0;
    qsort(scratch, gap_count, sizeof *scratch, compare_doubles);
    size_t single = 0;
    while (single < gap_count && scratch[single] <= 1.5 * scratch[0])
        ++single;
    return scratch[single / 2];
}

typedef struct rest {
    double square_sum;
    size_t record_count, window_count, all_window_count;
} rest;

static void measure_rest(rest *sum, const log_data *log, uint32_t channel, double step)
{
    for (size_t first = 0; first + WINDOW_RECORDS <= log->record_count; first += WINDOW_RECORDS) {
        double low = value_of(log, first, channel), high = low, mean = 0.0;
        for (size_t i = 0; i < WINDOW_RECORDS; ++i) {
            double x = value_of(log, first + i, channel);
            low = fmin(low, x);
            high = fmax(high, x);
            mean += x / WINDOW_RECORDS;
        }
        sum->all_window_count += 1;
        if (high - low > REST_STEPS * step)
            continue;
        sum->window_count += 1;
        sum->record_count += WINDOW_RECORDS;
        for (size_t i = 0; i < WINDOW_RECORDS; ++i) {
            double d = value_of(log, first + i, channel) - mean;
            sum->square_sum += d * d;
        }
    }
}

/* Returns the size of a change, in steps, that nine of ten changes reach. More than 1 shows a dead
 * band. */
static double usual_change(const log_data *logs, size_t log_count, uint32_t channel, double step,
                           double *scratch)
{
    size_t count = 0;
    for (size_t k = 0; k < log_count; ++k)
        for (size_t i = 1; i < logs[k].record_count; ++i) {
            double change =
                fabs(value_of(&logs[k], i, channel) - value_of(&logs[k], i - 1, channel));
            if (change > SAME_LEVEL_RAD)
                scratch[count++] = change;
        }
    if (count == 0 || step <= 0.0)
        return 0.0;
    qsort(scratch, count, sizeof *scratch, compare_doubles);
    return percentile(scratch, count, 0.1) / step;
}

static void print_sensor(const log_data *logs, size_t log_count, uint32_t channel, double *values,
                         double *scratch)
{
    double step = 0.0;
    rest at_rest = {0.0, 0, 0, 0};
    for (size_t k = 0; k < log_count; ++k) {
        for (size_t i = 0; i < logs[k].record_count; ++i)
            values[i] = value_of(&logs[k], i, channel);
        double own = step_of(values, logs[k].record_count, scratch);
        step = step > 0.0 && step < own ? step : own;
        measure_rest(&at_rest, &logs[k], channel, own);
    }
    size_t count = 0;
    for (size_t k = 0; k < log_count; ++k)
        for (size_t i = 0; i < logs[k].record_count; ++i)
            values[count++] = value_of(&logs[k], i, channel);
    qsort(values, count, sizeof *values, compare_doubles);
    double rms =
        at_rest.record_count > 0 ? sqrt(at_rest.square_sum / (double)at_rest.record_count) : 0.0;
    printf("| %s | %.2f .. %.2f | %.5f | %.4f | %.1f | %.0f %% |\n", logs[0].name[channel],
           percentile(values, count, 0.01), percentile(values, count, 0.99), step, rms,
           usual_change(logs, log_count, channel, step, scratch),
           100.0 * (double)at_rest.window_count / (double)at_rest.all_window_count);
}

static void print_log(const char *path, const log_data *log)
{
    size_t count = log->record_count - 1, repeated = 0;
    double mean_ms = 1e-6 * (double)log->time_ns[count] / (double)count, square_sum = 0.0;
    double low = 1e9, high = 0.0;
    for (size_t i = 1; i <= count; ++i) {
        double ms = 1e-6 * (double)(log->time_ns[i] - log->time_ns[i - 1]);
        square_sum += (ms - mean_ms) * (ms - mean_ms);
        low = fmin(low, ms);
        high = fmax(high, ms);
        repeated +=
            memcmp(log->value + i * log->channel_count, log->value + (i - 1) * log->channel_count,
                   log->channel_count * sizeof *log->value) == 0;
    }
    const char *slash = strrchr(path, '/');
    printf("| %s | %zu | %.2f | %.2f | %.0f .. %.0f | %.0f %% |\n", slash ? slash + 1 : path,
           log->record_count, mean_ms, sqrt(square_sum / (double)count), low, high,
           100.0 * (double)repeated / (double)count);
}

static int print_all(char **paths, const log_data *logs, size_t log_count)
{
    size_t count = 0;
    for (size_t k = 0; k < log_count; ++k)
        count += logs[k].record_count;
    double *values = malloc(count * sizeof *values), *scratch = malloc(count * sizeof *scratch);
    if (!values || !scratch) {
        free(values);
        free(scratch);
        return 1;
    }
    puts("| log | records | interval ms | jitter ms rms | from .. to ms | repeated |");
    puts("|---|---|---|---|---|---|");
    for (size_t k = 0; k < log_count; ++k)
        print_log(paths[k], &logs[k]);
    puts("\n| sensor | 1 .. 99 % rad | step rad | rest noise rad rms | least change, steps | at "
         "rest |");
    puts("|---|---|---|---|---|---|");
    for (uint32_t i = 0; i < logs[0].channel_count; ++i)
        print_sensor(logs, log_count, i, values, scratch);
    free(values);
    free(scratch);
    return 0;
}

static bool load(log_data *out, const char *path)
{
    char reason[LOG_REASON];
    log_file file;
    mrt_result result = log_file_read(&file, path, reason);
    if (result >= 0)
        result = log_parse(out, file.data, file.size, MRT_RIGHT, reason);
    free(file.data);
    if (result >= 0 && out->record_count >= 2)
        return true;
    fprintf(stderr, "%s: %s\n", path, result < 0 ? reason : "has fewer than two records");
    return false;
}

int main(int argument_count, char **arguments)
{
    static log_data logs[LOG_MAX];
    size_t log_count = 0;
    int status = argument_count < 2 || argument_count > LOG_MAX + 1 ? 2 : 0;
    if (status == 2)
        fprintf(stderr, "usage: measure_log LOG... (1 to %d logs of the same columns)\n", LOG_MAX);
    for (int i = 1; status == 0 && i < argument_count; ++i, ++log_count)
        if (!load(&logs[log_count], arguments[i]) ||
            logs[log_count].channel_count != logs[0].channel_count)
            status = 1;
    if (status == 0)
        status = print_all(arguments + 1, logs, log_count);
    for (size_t k = 0; k < LOG_MAX; ++k)
        log_data_finish(&logs[k]);
    return status;
}
