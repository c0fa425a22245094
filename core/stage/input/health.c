#include "stage/input/health.h"
#include "base/clock.h"
#include "stage/input/channel_table.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>

static const int64_t slice_ns = 250 * NS_PER_MS;
static const int64_t window_ns = 2 * NS_PER_S;

/* A larger jump of the sequence number means that the device restarted its count, not that samples
 * were lost. */
static const uint32_t gap_max = 100000;

enum { DRIFT_WINDOWS_MIN = 5 };

static double ms_of(int64_t ns)
{
    return (double)ns / (double)NS_PER_MS;
}

static double seconds_of(int64_t ns)
{
    return (double)ns / (double)NS_PER_S;
}

static void learn_ranges(health_meter *self, const mrt_channel *channels, uint32_t count)
{
    self->counted.channel_count = count < MRT_MAX_CHANNELS ? count : MRT_MAX_CHANNELS;
    for (uint32_t i = 0; i < self->counted.channel_count; ++i) {
        const mrt_channel *channel = &channels[i];
        self->is_ranged[i] = !channel_is_pedal(channel) && channel->min < channel->max;
        self->low[i] = channel->min;
        self->high[i] = channel->max;
    }
}

void health_init(health_meter *out, const mrt_channel *channels, uint32_t count, int64_t now_ns)
{
    *out = (health_meter){.start_ns = now_ns};
    out->counted.state_since_ns = now_ns;
    learn_ranges(out, channels, count);
}

void health_reopened(health_meter *self, const mrt_channel *channels, uint32_t count)
{
    self->has_last = false;
    self->has_open = false;
    self->window_count = 0;
    memset(self->slice, 0, sizeof self->slice);
    learn_ranges(self, channels, count);
}

/* ---- the last two seconds ---- */

static health_slice *slice_at(health_meter *self, int64_t arrival_ns)
{
    int64_t index = arrival_ns / slice_ns;
    health_slice *slice = &self->slice[(uint64_t)index % HEALTH_SLICES];
    if (slice->index != index)
        *slice = (health_slice){.index = index};
    return slice;
}

static void count_interval(health_meter *self, health_slice *slice, const mrt_sample *sample)
{
    if (!self->has_last)
        return;
    uint32_t missing = sample->sequence - self->last_sequence - 1;
    double interval_ms = ms_of(sample->time_ns - self->last_time_ns);
    slice->interval_count += 1;
    slice->interval_ms += interval_ms;
    if (missing == 0) {
        slice->steady_count += 1;
        slice->steady_ms += interval_ms;
        slice->steady_square_ms += interval_ms * interval_ms;
    } else if (missing <= gap_max) {
        self->counted.gap_count += missing;
    }
}

static void count_saturation(const health_meter *self, health_slice *slice,
                             const mrt_sample *sample)
{
    for (uint32_t i = 0; i < self->counted.channel_count && i < sample->count; ++i)
        if (self->is_ranged[i] &&
            (sample->value[i] <= self->low[i] || sample->value[i] >= self->high[i]))
            slice->saturated[i] += 1;
}

/* ---- the lower envelope of lateness ---- */

static void close_window(health_meter *self)
{
    if (self->window_count == HEALTH_WINDOWS) {
        memmove(self->window_s, self->window_s + 1, (HEALTH_WINDOWS - 1) * sizeof(double));
        memmove(self->window_least_ms, self->window_least_ms + 1,
                (HEALTH_WINDOWS - 1) * sizeof(double));
        self->window_count -= 1;
    }
    self->window_s[self->window_count] = self->open_s;
    self->window_least_ms[self->window_count] = self->open_least_ms;
    self->window_count += 1;
    self->has_open = false;
}

static void sort(double *values, uint32_t count)
{
    for (uint32_t i = 1; i < count; ++i) {
        double value = values[i];
        uint32_t at = i;
        for (; at > 0 && values[at - 1] > value; --at)
            values[at] = values[at - 1];
        values[at] = value;
    }
}

/* Returns the median of the slopes between all pairs (Theil-Sen), so that one late window does not
 * change it. */
static double envelope_slope_ms_per_s(const health_meter *self)
{
    double slope[HEALTH_WINDOWS * (HEALTH_WINDOWS - 1) / 2];
    uint32_t count = 0;
    for (uint32_t b = 1; b < self->window_count; ++b)
        for (uint32_t a = 0; a < b; ++a) {
            double span_s = self->window_s[b] - self->window_s[a];
            if (span_s > 0)
                slope[count++] = (self->window_least_ms[b] - self->window_least_ms[a]) / span_s;
        }
    if (count == 0)
        return 0;
    sort(slope, count);
    return count % 2 ? slope[count / 2] : 0.5 * (slope[count / 2 - 1] + slope[count / 2]);
}

static void follow_envelope(health_meter *self, double lateness_ms, int64_t arrival_ns)
{
    int64_t index = (arrival_ns - self->start_ns) / window_ns;
    if (self->has_open && index != self->window_index) {
        close_window(self);
        self->counted.has_drift = self->window_count >= DRIFT_WINDOWS_MIN;
        if (self->counted.has_drift)
            self->counted.drift_ppm = -1000.0 * envelope_slope_ms_per_s(self);
    }
    if (!self->has_open || lateness_ms < self->open_least_ms) {
        self->open_s = seconds_of(arrival_ns - self->start_ns);
        self->open_least_ms = lateness_ms;
    }
    self->has_open = true;
    self->window_index = index;
}

/* ---- feeding ---- */

void health_sample(health_meter *self, const mrt_sample *sample, int64_t arrival_ns)
{
    health_slice *slice = slice_at(self, arrival_ns);
    double lateness_ms = ms_of(arrival_ns - sample->time_ns);
    if (slice->sample_count == 0 || lateness_ms > slice->lateness_worst_ms)
        slice->lateness_worst_ms = lateness_ms;
    slice->sample_count += 1;
    slice->lateness_ms += lateness_ms;
    count_interval(self, slice, sample);
    count_saturation(self, slice, sample);
    follow_envelope(self, lateness_ms, arrival_ns);
    self->counted.sample_count += 1;
    self->counted.last_arrival_ns = arrival_ns;
    self->has_last = true;
    self->last_sequence = sample->sequence;
    self->last_time_ns = sample->time_ns;
}

void health_refused(health_meter *self)
{
    self->counted.refused_count += 1;
}

void health_dropped(health_meter *self)
{
    self->counted.dropped_count += 1;
}

void health_lost(health_meter *self)
{
    self->counted.loss_count += 1;
}

void health_state(health_meter *self, int32_t state, const char *words, int64_t now_ns)
{
    if (state != self->counted.state)
        self->counted.state_since_ns = now_ns;
    self->counted.state = state;
    snprintf(self->counted.words, sizeof self->counted.words, "%s", words);
}

/* ---- measure ---- */

static health_slice sum_of_slices(const health_meter *self, int64_t now_ns)
{
    health_slice sum = {0};
    int64_t newest = now_ns / slice_ns;
    for (int k = 0; k < HEALTH_SLICES; ++k) {
        const health_slice *slice = &self->slice[k];
        if (slice->sample_count == 0 || slice->index <= newest - HEALTH_SLICES)
            continue;
        if (sum.sample_count == 0 || slice->lateness_worst_ms > sum.lateness_worst_ms)
            sum.lateness_worst_ms = slice->lateness_worst_ms;
        sum.sample_count += slice->sample_count;
        sum.interval_count += slice->interval_count;
        sum.steady_count += slice->steady_count;
        sum.interval_ms += slice->interval_ms;
        sum.steady_ms += slice->steady_ms;
        sum.steady_square_ms += slice->steady_square_ms;
        sum.lateness_ms += slice->lateness_ms;
        for (uint32_t i = 0; i < self->counted.channel_count; ++i)
            sum.saturated[i] += slice->saturated[i];
    }
    return sum;
}

/* Returns the rate. Silence that lasts longer than the mean interval reduces it. */
static double rate_hz(const health_slice *sum, double silence_s)
{
    if (sum->interval_count == 0 || !(sum->interval_ms > 0))
        return 0;
    double mean_ms = sum->interval_ms / sum->interval_count;
    double pause_ms = fmax(0.0, 1000.0 * silence_s - mean_ms);
    return 1000.0 * sum->interval_count / (sum->interval_ms + pause_ms);
}

void health_measure(const health_meter *self, int64_t now_ns, health_report *out)
{
    health_slice sum = sum_of_slices(self, now_ns);
    *out = self->counted;
    if (out->last_arrival_ns == 0)
        out->silence_s = seconds_of(now_ns - self->start_ns);
    health_age(out, now_ns);
    out->rate_hz = rate_hz(&sum, out->silence_s);
    if (sum.steady_count > 1) {
        double mean = sum.steady_ms / sum.steady_count;
        double variance = sum.steady_square_ms / sum.steady_count - mean * mean;
        out->jitter_ms = sqrt(fmax(variance, 0.0));
    }
    if (sum.sample_count > 0)
        out->lateness_ms = sum.lateness_ms / sum.sample_count;
    out->lateness_worst_ms = sum.lateness_worst_ms;
    for (uint32_t i = 0; i < out->channel_count && sum.sample_count > 0; ++i)
        out->saturated[i] = (float)sum.saturated[i] / (float)sum.sample_count;
}

void health_age(health_report *self, int64_t now_ns)
{
    if (self->last_arrival_ns != 0)
        self->silence_s = seconds_of(now_ns - self->last_arrival_ns);
    self->state_s = seconds_of(now_ns - self->state_since_ns);
}

/* ---- the board ---- */

void health_board_init(health_board *out)
{
    atomic_init(&out->sequence, 0);
    for (int i = 0; i < HEALTH_BOARD_WORDS; ++i)
        atomic_init(&out->word[i], 0);
}

/* A sequence lock without fences: each word is stored after the odd number and loaded before the
 * number is read again. */
void health_post(health_board *board, const health_report *report)
{
    uint64_t words[HEALTH_BOARD_WORDS] = {0};
    memcpy(words, report, sizeof *report);
    uint32_t sequence = atomic_load_explicit(&board->sequence, memory_order_relaxed);
    atomic_store_explicit(&board->sequence, sequence + 1, memory_order_relaxed);
    for (int i = 0; i < HEALTH_BOARD_WORDS; ++i)
        atomic_store_explicit(&board->word[i], words[i], memory_order_release);
    atomic_store_explicit(&board->sequence, sequence + 2, memory_order_release);
}

void health_read(const health_board *board, health_report *out)
{
    uint64_t words[HEALTH_BOARD_WORDS];
    for (;;) {
        uint32_t sequence = atomic_load_explicit(&board->sequence, memory_order_acquire);
        for (int i = 0; i < HEALTH_BOARD_WORDS; ++i)
            words[i] = atomic_load_explicit(&board->word[i], memory_order_acquire);
        if (sequence % 2 == 0 &&
            atomic_load_explicit(&board->sequence, memory_order_relaxed) == sequence)
            break;
        sched_yield();
    }
    memcpy(out, words, sizeof *out);
}
