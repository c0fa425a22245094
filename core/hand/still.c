#include "hand/still.h"

#include "hand/ease.h"

#include <math.h>
#include <string.h>

enum { SAMPLES_LEAST = 4 };

void still_init(still_window *window, int64_t span_ns, uint32_t channels)
{
    memset(window, 0, sizeof *window);
    window->span_ns = span_ns;
    window->channels = channels;
}

static void still_reset(still_window *window)
{
    window->count = 0;
}

static uint32_t slot(const still_window *window, uint32_t index)
{
    return (window->first + index) % STILL_SAMPLES;
}

static int64_t newest_ns(const still_window *window)
{
    return window->time_ns[slot(window, window->count - 1)];
}

static void drop_oldest(still_window *window)
{
    window->first = slot(window, 1);
    window->count -= 1;
}

void still_add(still_window *window, const float *value, int64_t time_ns)
{
    if (window->count > 0) {
        int64_t last_ns = newest_ns(window);
        if (hand_is_gap(last_ns, time_ns))
            still_reset(window);
        else if (time_ns - last_ns <= window->span_ns / STILL_SAMPLES)
            return;
    }
    if (window->count == STILL_SAMPLES)
        drop_oldest(window);
    window->count += 1;
    uint32_t at = slot(window, window->count - 1);
    window->time_ns[at] = time_ns;
    memcpy(window->value[at], value, sizeof window->value[at]);
    while (time_ns - window->time_ns[window->first] > window->span_ns)
        drop_oldest(window);
}

static bool counts(const still_window *window, int channel)
{
    return (window->channels >> channel & 1u) != 0;
}

static double mean_of(const still_window *window, int channel)
{
    double sum = 0;
    for (uint32_t i = 0; i < window->count; ++i)
        sum += (double)window->value[slot(window, i)][channel];
    return window->count > 0 ? sum / window->count : 0.0;
}

static double deviation_of(const still_window *window, int channel)
{
    double mean = mean_of(window, channel), sum = 0;
    for (uint32_t i = 0; i < window->count; ++i) {
        double from_mean = (double)window->value[slot(window, i)][channel] - mean;
        sum += from_mean * from_mean;
    }
    return window->count > 0 ? sqrt(sum / window->count) : 0.0;
}

/* Samples arrive at whole periods, so the oldest stored one may be one period younger than the
 * span. */
static bool reaches_over_span(const still_window *window)
{
    if (window->count < SAMPLES_LEAST)
        return false;
    int64_t reach_ns = newest_ns(window) - window->time_ns[window->first];
    return reach_ns + reach_ns / (window->count - 1) >= window->span_ns;
}

still_state still_measure(const still_window *window)
{
    still_state out = {.is_full = reaches_over_span(window), .worst_channel = -1};
    for (int channel = 0; channel < MRT_ANGLES; ++channel) {
        if (!counts(window, channel))
            continue;
        double deviation = deviation_of(window, channel);
        if (out.worst_channel >= 0 && !(deviation > out.worst))
            continue;
        out.worst = deviation;
        out.worst_channel = channel;
    }
    return out;
}

double still_share(const still_window *window, double most)
{
    double sum[MRT_ANGLES] = {0}, squares[MRT_ANGLES] = {0};
    int64_t since_ns = 0, newest = 0;
    uint32_t held = 0;
    bool is_still = window->count > 0;
    if (is_still)
        since_ns = newest = newest_ns(window);
    for (uint32_t i = window->count; is_still && i-- > 0;) {
        const uint32_t at = slot(window, i), last = slot(window, window->count - 1);
        held += 1;
        for (int channel = 0; is_still && channel < MRT_ANGLES; ++channel) {
            /* Relative to the newest value, so that the squares stay exact. */
            const double off =
                (double)window->value[at][channel] - (double)window->value[last][channel];
            sum[channel] += off;
            squares[channel] += off * off;
            const double mean = sum[channel] / held;
            is_still =
                !counts(window, channel) || squares[channel] / held - mean * mean <= most * most;
        }
        if (is_still)
            since_ns = window->time_ns[at];
    }
    const double share = (double)(newest - since_ns) / (double)window->span_ns;
    return is_still && reaches_over_span(window) ? 1.0 : share;
}

void still_mean(const still_window *window, float *out)
{
    for (int channel = 0; channel < MRT_ANGLES; ++channel)
        out[channel] = counts(window, channel) ? (float)mean_of(window, channel) : 0.0f;
}

static float median_of(const still_window *window, int channel)
{
    float sorted[STILL_SAMPLES] = {0};
    for (uint32_t i = 0; i < window->count; ++i) {
        float value = window->value[slot(window, i)][channel];
        uint32_t at = i;
        for (; at > 0 && sorted[at - 1] > value; --at)
            sorted[at] = sorted[at - 1];
        sorted[at] = value;
    }
    uint32_t half = window->count / 2;
    if (window->count % 2 == 1)
        return sorted[half];
    return window->count > 0 ? 0.5f * (sorted[half - 1] + sorted[half]) : 0.0f;
}

void still_median(const still_window *window, float *out)
{
    for (int channel = 0; channel < MRT_ANGLES; ++channel)
        out[channel] = counts(window, channel) ? median_of(window, channel) : 0.0f;
}
