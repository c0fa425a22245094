#include "window/devices_panel_words.h"

#include "stage/input.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const double silent_s = 1.0, late_ms = 20.0, odd_drift_ppm = 500.0;
static const float saturated_share = 0.5f;

/* ---- the state ---- */

/* "3 s", "2 min" */
static void say_duration(char out[32], double seconds)
{
    if (seconds < 100.0)
        (void)snprintf(out, 32, "%.0f s", floor(seconds));
    else if (seconds < 6000.0)
        (void)snprintf(out, 32, "%.0f min", floor(seconds / 60.0));
    else
        (void)snprintf(out, 32, "%.0f h", floor(seconds / 3600.0));
}

static devices_light running(const health_report *health, char out[DEVICES_WORDS])
{
    char duration[32];
    if (health->silence_s <= silent_s) {
        (void)snprintf(out, DEVICES_WORDS, "running");
        return DEVICES_WELL;
    }
    say_duration(duration, health->silence_s);
    (void)snprintf(out, DEVICES_WORDS, "open, silent for %s", duration);
    return DEVICES_WAITS;
}

devices_light devices_words_state(const health_report *health, char out[DEVICES_WORDS],
                                  char out_why[DEVICES_WORDS])
{
    char duration[32];
    (void)snprintf(out_why, DEVICES_WORDS, "%s", health->words);
    switch ((input_state)health->state) {
    case INPUT_RUNNING:
        return running(health, out);
    case INPUT_ENDED:
        (void)snprintf(out, DEVICES_WORDS, "over");
        return DEVICES_OVER;
    case INPUT_LOST:
        say_duration(duration, health->state_s);
        (void)snprintf(out, DEVICES_WORDS, "away for %s, tried again", duration);
        return DEVICES_WAITS;
    case INPUT_FAILED:
        break;
    }
    (void)snprintf(out, DEVICES_WORDS, "failed");
    return DEVICES_FAILED;
}

/* ---- figures ---- */

__attribute__((format(printf, 4, 5))) static devices_fact *
fact(devices_fact *at, const char *label, const char *help, const char *format, ...)
{
    va_list arguments;
    *at = (devices_fact){.label = label, .help = help};
    va_start(arguments, format);
    (void)vsnprintf(at->value, sizeof at->value, format, arguments);
    va_end(arguments);
    return at;
}

static uint32_t count_losses(const health_report *h, devices_fact *out)
{
    uint32_t count = 0;
    if (h->gap_count > 0)
        fact(&out[count++], "Gaps", "Samples that are missing in the device's own numbers.",
             "%llu of %llu", (unsigned long long)h->gap_count,
             (unsigned long long)(h->gap_count + h->sample_count))
            ->is_odd = h->gap_count * 1000 > h->sample_count;
    if (h->refused_count > 0)
        fact(&out[count++], "Refused", "Samples that made no sense.", "%llu",
             (unsigned long long)h->refused_count)
            ->is_odd = true;
    if (h->dropped_count > 0)
        fact(&out[count++], "Dropped", "Samples that this computer was too slow for.", "%llu",
             (unsigned long long)h->dropped_count)
            ->is_odd = true;
    if (h->loss_count > 0)
        fact(&out[count++], "Went away", "How often the device was lost.", "%u times",
             h->loss_count);
    return count;
}

uint32_t devices_words_facts(const health_report *h, devices_fact out[DEVICES_FACTS_MAX])
{
    uint32_t count = 0;
    fact(&out[count++], "Rate", "Samples a second, by their own times.", "%.1f Hz", h->rate_hz);
    fact(&out[count++], "Jitter", "How unevenly they follow each other: one standard deviation.",
         "%.2f ms", h->jitter_ms);
    fact(&out[count++], "Lateness", "From measured to arrived: mean, and the worst of 2 s.",
         "%.1f ms, worst %.1f ms", h->lateness_ms, h->lateness_worst_ms)
        ->is_odd = h->lateness_ms > late_ms;
    if (h->has_drift)
        fact(&out[count++], "Clock drift", "How much faster the device's clock runs than ours.",
             "%+.0f ppm", h->drift_ppm)
            ->is_odd = fabs(h->drift_ppm) > odd_drift_ppm;
    else
        fact(&out[count++], "Clock drift", "Known 10 s after the device was opened.",
             "not known yet");
    fact(&out[count++], "Samples", "Since it was opened.", "%llu",
         (unsigned long long)h->sample_count);
    return count + count_losses(h, out + count);
}

uint32_t devices_words_saturated(const health_report *health, const mrt_channel *channels,
                                 uint32_t count, char out[DEVICES_WORDS])
{
    uint32_t found = 0;
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < count && i < health->channel_count && i < MRT_MAX_CHANNELS; ++i) {
        if (!(health->saturated[i] >= saturated_share))
            continue;
        int length = used < DEVICES_WORDS ? snprintf(out + used, DEVICES_WORDS - used, "%s%s",
                                                     found ? ", " : "", channels[i].name)
                                          : 0;
        used += length > 0 ? (size_t)length : 0;
        found += 1;
    }
    return found;
}

/* ---- which are open ---- */

static bool is_named(const char *name, size_t length, const mrt_plugin_type *type)
{
    const char *own = device_list_plugin_name(type);
    return (strlen(type->id) == length && strncmp(type->id, name, length) == 0) ||
           (strlen(own) == length && strncmp(own, name, length) == 0);
}

bool devices_is_open(const char *input_text, const device_found *device, bool is_first)
{
    size_t plugin_length = strcspn(input_text, ":,");
    if (!is_named(input_text, plugin_length, device->type))
        return false;
    const char *address = input_text + plugin_length;
    address += *address == ':';
    size_t length = strcspn(address, ",");
    if (input_text[plugin_length] != ':' || length == 0)
        return is_first;
    return strlen(device->device.address) == length &&
           strncmp(device->device.address, address, length) == 0;
}

bool devices_input_text(const device_found *device, char *out, size_t capacity)
{
    int length = snprintf(out, capacity, "%s:%s", device_list_plugin_name(device->type),
                          device->device.address);
    return length > 0 && (size_t)length < capacity && !strchr(device->device.address, ',');
}
