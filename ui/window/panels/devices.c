#include "window/panels/devices.h"
#include "window/panels/calibrate.h"
#include "window/gui/theme.h"
#include "window/gui/ui.h"
#include "window/panels/panels.h"
#include "window/panels/shown_unit.h"
#include "window/app/app.h"
#include "window/app/camera_page.h"
#include "window/panels/calibrate_guide.h"

#include "base/clock.h"
#include "base/condition.h"
#include "base/file.h"
#include "hand/calibration_folder.h"
#include "stage/input/device_list.h"
#include "stage/input/glove_channels.h"
#include "stage/input/input.h"

#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- text ---- */

static const double silent_s = 1.0, late_ms = 20.0, odd_drift_ppm = 500.0;
static const float saturated_share = 0.5f;

/* ---- the state ---- */

/* Writes "3 s" or "2 min". */
static void write_duration(char out[32], double seconds)
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
    write_duration(duration, health->silence_s);
    (void)snprintf(out, DEVICES_WORDS, "open, no samples for %s", duration);
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
        write_duration(duration, health->state_s);
        (void)snprintf(out, DEVICES_WORDS, "disconnected for %s, retrying", duration);
        return DEVICES_WAITS;
    case INPUT_FAILED:
        break;
    }
    (void)snprintf(out, DEVICES_WORDS, "failed");
    return DEVICES_FAILED;
}

/* ---- statistics ---- */

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
        fact(&out[count++], "Gaps",
             "Samples that are missing, by the sequence numbers of the device.", "%llu of %llu",
             (unsigned long long)h->gap_count, (unsigned long long)(h->gap_count + h->sample_count))
            ->is_odd = h->gap_count * 1000 > h->sample_count;
    if (h->refused_count > 0)
        fact(&out[count++], "Refused", "Samples with invalid values.", "%llu",
             (unsigned long long)h->refused_count)
            ->is_odd = true;
    if (h->dropped_count > 0)
        fact(&out[count++], "Dropped", "Samples that were lost because this computer was too slow.",
             "%llu", (unsigned long long)h->dropped_count)
            ->is_odd = true;
    if (h->loss_count > 0)
        fact(&out[count++], "Disconnects", "Number of times that the device was disconnected.",
             "%u times", h->loss_count);
    return count;
}

uint32_t devices_words_facts(const health_report *h, devices_fact out[DEVICES_FACTS_MAX])
{
    uint32_t count = 0;
    fact(&out[count++], "Rate", "Samples per second, measured by their time stamps.", "%.1f Hz",
         h->rate_hz);
    fact(&out[count++], "Jitter", "Standard deviation of the interval between samples.", "%.2f ms",
         h->jitter_ms);
    fact(&out[count++], "Lateness",
         "Time from the measurement to the arrival of a sample: mean and maximum over 2 s.",
         "%.1f ms, worst %.1f ms", h->lateness_ms, h->lateness_worst_ms)
        ->is_odd = h->lateness_ms > late_ms;
    if (h->has_drift)
        fact(&out[count++], "Clock drift",
             "How much faster the clock of the device runs than the clock of this computer.",
             "%+.0f ppm", h->drift_ppm)
            ->is_odd = fabs(h->drift_ppm) > odd_drift_ppm;
    else
        fact(&out[count++], "Clock drift", "Available 10 s after the device was opened.",
             "not measured yet");
    fact(&out[count++], "Samples", "Number of samples since the device was opened.", "%llu",
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

/* ---- open devices ---- */

static bool is_named(const char *name, size_t length, const mrt_plugin_type *type)
{
    const char *own = plugin_short_name(type);
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
    int length =
        snprintf(out, capacity, "%s:%s", plugin_short_name(device->type), device->device.address);
    return length > 0 && (size_t)length < capacity && !strchr(device->device.address, ',');
}

/* ---- background search for devices ---- */

static const int64_t period_ns = 2 * NS_PER_S, interest_ns = 5 * NS_PER_S;

typedef struct findings {
    bool is_known; /* the first search is done */
    device_list devices;
    calibration_list calibrations;
    error note; /* error of the search; may be "" */
} findings;

typedef struct devices_search {
    const plugin_list *plugins;
    log_queue *log;
    pthread_t thread;
    pthread_mutex_t mutex; /* guards the fields from change to wanted_ns */
    pthread_cond_t change;
    findings posted;
    bool has_posted, is_asked, is_stopping;
    int64_t wanted_ns;
    findings shown;          /* [main] */
    log_once already_logged; /* [thread] */
    findings made;
} devices_search;

/* ---- the thread ---- */

static void look(devices_search *self)
{
    error err = {""};
    findings *made = &self->made;
    *made = (findings){.is_known = true};
    if (device_list_scan(&made->devices, self->plugins, self->log, &self->already_logged, &err) < 0)
        made->note = err;
    error note = {""};
    if (calibration_folder_list(&made->calibrations, &note, &err) < 0)
        note = err;
    if (!made->note.text[0])
        made->note = note;
}

static bool is_due(const devices_search *self, int64_t next_ns)
{
    int64_t now_ns = clock_now_ns();
    bool is_wanted = now_ns - self->wanted_ns < interest_ns;
    return self->is_asked || (is_wanted && now_ns >= next_ns);
}

static void post(devices_search *self)
{
    calibration_list_finish(&self->posted.calibrations);
    self->posted = self->made;
    self->has_posted = true;
}

static void *search(void *data)
{
    devices_search *self = data;
    int64_t next_ns = 0;
    pthread_mutex_lock(&self->mutex);
    while (!self->is_stopping) {
        if (!is_due(self, next_ns)) {
            (void)condition_wait(&self->change, &self->mutex, clock_now_ns() + period_ns);
            continue;
        }
        self->is_asked = false;
        pthread_mutex_unlock(&self->mutex);
        look(self);
        pthread_mutex_lock(&self->mutex);
        post(self);
        next_ns = clock_now_ns() + period_ns;
    }
    pthread_mutex_unlock(&self->mutex);
    return NULL;
}

/* ---- main ---- */

/* plugins and log must outlive the search. Returns NULL without memory or a thread. */
static devices_search *devices_search_create(const plugin_list *plugins, log_queue *log)
{
    devices_search *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->plugins = plugins;
    self->log = log;
    self->wanted_ns = INT64_MIN / 2;
    log_once_reset(&self->already_logged);
    condition_init(&self->change);
    pthread_mutex_init(&self->mutex, NULL);
    if (pthread_create(&self->thread, NULL, search, self) == 0)
        return self;
    pthread_cond_destroy(&self->change);
    pthread_mutex_destroy(&self->mutex);
    free(self);
    return NULL;
}

/* Waits for a search in progress. Accepts NULL. */
static void devices_search_destroy(devices_search *self)
{
    if (!self)
        return;
    pthread_mutex_lock(&self->mutex);
    self->is_stopping = true;
    pthread_cond_signal(&self->change);
    pthread_mutex_unlock(&self->mutex);
    pthread_join(self->thread, NULL);
    pthread_cond_destroy(&self->change);
    pthread_mutex_destroy(&self->mutex);
    calibration_list_finish(&self->posted.calibrations);
    calibration_list_finish(&self->shown.calibrations);
    free(self);
}

/* Starts a search as soon as possible, after a device was connected, opened or saved. */
static void devices_search_again(devices_search *self)
{
    pthread_mutex_lock(&self->mutex);
    self->is_asked = true;
    pthread_cond_signal(&self->change);
    pthread_mutex_unlock(&self->mutex);
}

/* Returns the newest findings, valid until the next call. Each call keeps the search running for 5
 * s. The search does not hold the mutex while it reads devices and files. */
static const findings *devices_search_look(devices_search *self)
{
    const int64_t now_ns = clock_now_ns();
    pthread_mutex_lock(&self->mutex);
    const bool was_idle = now_ns - self->wanted_ns >= interest_ns;
    self->wanted_ns = now_ns;
    if (was_idle)
        pthread_cond_signal(&self->change);
    if (self->has_posted) {
        calibration_list_finish(&self->shown.calibrations);
        self->shown = self->posted;
        self->posted.calibrations = (calibration_list){.count = 0};
        self->has_posted = false;
    }
    pthread_mutex_unlock(&self->mutex);
    return &self->shown;
}

/* ---- the panel ---- */

enum { DEVICES_PATH = 1024 };

/* State of an input as the panel shows it. It is read four times a second, and in each frame while
 * the face moves. */
typedef struct input_meter {
    const input *of; /* NULL: not read yet */
    int64_t read_ns;
    uint64_t face; /* number of the face at that time */
    health_report health;
    bool has_sample;
    mrt_sample sample;
} input_meter;

enum { METERS = PLAYER_INPUTS_MAX };
static const double meter_every_s = 0.25;

struct panel {
    app *app;
    devices_search *search; /* NULL: the search is not available */
    calibrate_panel *calibrate;
    const findings *found; /* of this frame */
    char path[DEVICES_PATH], osc[128];
    input_opening opening[INPUT_OPENINGS_MAX]; /* of this frame */
    uint32_t opening_count, input_count;
    input_meter meter[METERS];
    bool repeats;                    /* loop recordings */
    char remote[APP_REMOTE_ADDRESS]; /* address as typed */
    char streams[512];
    char trouble[1024];    /* error of the last action; may be "" */
    rezero_counts rezeros; /* of the previous frame */
    bool was_refused;
};

/* ---- actions ---- */

/* Reports an error in the panel and in the log panel. */
static void report_trouble(panel *self, const char *text)
{
    (void)snprintf(self->trouble, sizeof self->trouble, "%s", text);
    if (text[0])
        news_list_add(app_news(self->app), MRT_LOG_ERROR, "devices", text);
}

/* Opens an input in the background. */
static void open_input(panel *self, const char *text)
{
    self->trouble[0] = '\0';
    (void)!app_open_input(self->app, text); /* the function reports its own errors */
}

static void remove_input(panel *self, uint32_t index)
{
    error err = {""};
    mrt_result result = live_remove_input(app_live(self->app), index, &err);
    report_trouble(self, result < 0 ? err.text : "");
}

/* path "": default calibration. */
static void calibrate(panel *self, uint32_t side, const char *path)
{
    error err = {""};
    mrt_result result = calibrate_use(self->app, side, path, &err);
    report_trouble(self, result < 0 ? err.text : "");
}

/* ---- open inputs ---- */

static const float label_width = 104.0f, strip_height = 30.0f;
static const char *const side_name[2] = {"Left hand", "Right hand"};
static const uint32_t light_colour[] = {[DEVICES_OVER] = THEME_DIM,
                                        [DEVICES_WELL] = THEME_GOOD,
                                        [DEVICES_WAITS] = THEME_WARNING,
                                        [DEVICES_FAILED] = THEME_BAD};
static const ui_style light_style[] = {[DEVICES_OVER] = UI_STYLE_DIM,
                                       [DEVICES_WELL] = UI_STYLE_DIM,
                                       [DEVICES_WAITS] = UI_STYLE_WARNING,
                                       [DEVICES_FAILED] = UI_STYLE_BAD};

/* ---- header of a card ---- */

/* Returns false if the button at the right end was pressed. */
static bool draw_head(ui *on, const char *name, devices_light light, const char *button,
                      const char *hint)
{
    ui_canvas at;
    const float remove = 74.0f;
    ui_canvas_begin(on, "head", ui_available_width(on) - remove, ui_row_height(on), &at);
    float middle = at.where.y + 0.5f * at.where.height;
    ui_draw_disc(on, at.where.x + 6.0f, middle, 4.5f, light_colour[light]);
    ui_draw_text(on, at.where.x + 18.0f, middle - 0.5f * ui_text_height(on, UI_STYLE_STRONG),
                 UI_STYLE_STRONG, THEME_TEXT, at.where.width - 22.0f, name);
    ui_canvas_end(on);
    ui_hint(on, name);
    ui_same_line(on);
    ui_width(on, -0.001f);
    bool stays = !ui_button(on, button, UI_QUIET);
    ui_hint(on, hint);
    return stays;
}

static void draw_state(ui *on, const health_report *health, devices_light light, const char *state,
                       const char *why)
{
    char rate[32];
    ui_text(on, light_style[light], state);
    if (light == DEVICES_WELL && health->rate_hz > 0.0) {
        (void)snprintf(rate, sizeof rate, "%.0f Hz", health->rate_hz);
        ui_same_line(on);
        ui_at(on, label_width + 60.0f);
        ui_text(on, UI_STYLE_BODY, rate);
    }
    if (why[0])
        ui_text_wrapped(on, UI_STYLE_DIM, why);
}

/* ---- bars of all channels ---- */

static float share_of(const mrt_channel *channel, float value)
{
    float span = channel->max - channel->min;
    float share = span > 0.0f ? (value - channel->min) / span : 0.0f;
    return isfinite(share) ? fminf(fmaxf(share, 0.0f), 1.0f) : 0.0f;
}

static uint32_t colour_of(const mrt_channel *channel)
{
    if (channel->hand == MRT_LEFT)
        return THEME_LEFT;
    return channel->hand == MRT_RIGHT ? THEME_RIGHT : THEME_ACCENT;
}

static void draw_channel(ui *on, const ui_canvas *at, const mrt_channel *channel, float value,
                         uint32_t index, float wide)
{
    float high = at->where.height * share_of(channel, value);
    float x = at->where.x + wide * (float)index;
    ui_rectangle well = {x, at->where.y, wide - 2.0f, at->where.height};
    ui_rectangle bar = {x, at->where.y + at->where.height - high, wide - 2.0f, high};
    ui_draw_box(on, well, THEME_WELL, 1.0f);
    ui_draw_box(on, bar, colour_of(channel), 1.0f);
}

/* sample NULL: none yet. */
static void draw_strip(ui *on, const mrt_channel *channels, uint32_t count,
                       const mrt_sample *sample)
{
    ui_canvas at;
    char hint[128];
    ui_canvas_begin(on, "strip", 0.0f, strip_height, &at);
    float wide = fminf(at.where.width / (float)(count ? count : 1), 40.0f);
    uint32_t known = !sample ? 0 : sample->count < count ? sample->count : count;
    for (uint32_t i = 0; i < count; ++i)
        draw_channel(on, &at, &channels[i], i < known ? sample->value[i] : channels[i].min, i,
                     wide);
    uint32_t pointed = at.x >= 0.0f ? (uint32_t)(at.x / wide) : count;
    ui_canvas_end(on);
    if (!at.is_hovered || pointed >= known)
        return;
    const shown_unit unit = shown_unit_of(channels[pointed].unit);
    (void)snprintf(hint, sizeof hint, "%.60s: %.4g %.16s", channels[pointed].name,
                   unit.factor * (double)sample->value[pointed], unit.name);
    ui_hint(on, hint);
}

/* ---- calibration ---- */

enum { CALIBRATIONS_MAX = 64 };

/* tracker: like the field input of hand_calibration. */
static void draw_calibration(panel *self, ui *on, uint32_t index, uint32_t side,
                             const char *tracker)
{
    const char *items[CALIBRATIONS_MAX + 2] = {tracker[0] ? "not calibrated" : "default"};
    const char *paths[CALIBRATIONS_MAX + 2] = {""};
    const char *used = live_calibration(app_live(self->app), side);
    uint32_t count = 1, chosen = used ? UINT32_MAX : 0;
    for (uint32_t i = 0; i < self->found->calibrations.count && count <= CALIBRATIONS_MAX; ++i) {
        const calibration_entry *entry = &self->found->calibrations.entry[i];
        const bool is_used = used && strcmp(used, entry->path) == 0;
        if (entry->side != side || strcmp(entry->input, tracker) != 0) {
            chosen = is_used ? 0 : chosen; /* the calibration belongs to another kind of input */
            continue;
        }
        if (is_used)
            chosen = count;
        items[count] = entry->label;
        paths[count++] = entry->path;
    }
    if (chosen == UINT32_MAX) { /* the file is in another folder */
        chosen = count;
        items[count] = file_name_of(used);
        paths[count++] = used;
    }
    if (ui_choice(on, side_name[side], label_width, items, count, &chosen))
        calibrate(self, side, paths[chosen]);
    ui_hint(on, "Choose the calibration for this hand.");
    ui_id_begin(on, side_name[side]);
    ui_text(on, UI_STYLE_DIM, "");
    ui_at(on, label_width);
    if (ui_button(on, "Calibrate\xe2\x80\xa6", UI_PLAIN)) {
        error why = {""};
        if (!calibrate_panel_open(self->calibrate, index, side, &why))
            report_trouble(self, why.text);
    }
    ui_hint(on, tracker[0] ? "Calibrate with three poses (flat, fist, spread), about 10 s."
                           : "Calibrate with ten poses, about 90 s.");
    ui_id_end(on);
}

/* ---- details and settings ---- */

static void draw_details(ui *on, const health_report *health, const mrt_channel *channels,
                         uint32_t count)
{
    devices_fact fact[DEVICES_FACTS_MAX];
    char names[DEVICES_WORDS];
    uint32_t facts = devices_words_facts(health, fact);
    for (uint32_t i = 0; i < facts; ++i) {
        ui_fact(on, fact[i].label, label_width, fact[i].is_odd ? UI_STYLE_WARNING : UI_STYLE_BODY,
                fact[i].value);
        ui_hint(on, fact[i].help);
    }
    if (devices_words_saturated(health, channels, count, names) > 0) {
        ui_text(on, UI_STYLE_WARNING, "At the end of the range:");
        ui_text_wrapped(on, UI_STYLE_DIM, names);
    }
}

static void set_value(panel *self, input *of, uint32_t index, double value)
{
    char key[128], text[64];
    error err = {""};
    instance_key(input_plugin(of), index, key, sizeof key);
    (void)snprintf(text, sizeof text, "%.9g", value);
    report_trouble(self, input_set(of, key, text, &err) < 0 ? err.text : "");
}

static uint32_t label_count(const mrt_param *p)
{
    uint32_t count = 0;
    while (p->labels && p->labels[count])
        count += 1;
    return count;
}

static void draw_param(panel *self, ui *on, input *of, uint32_t index)
{
    const mrt_param *p = &input_plugin(of)->params[index];
    double value = input_value(of, index);
    if (p->flags & MRT_PARAM_TRIGGER) {
        if (ui_button(on, p->name, UI_PLAIN))
            set_value(self, of, index, 1.0);
    } else if (p->labels) {
        uint32_t chosen = (uint32_t)(value - p->min);
        if (ui_choice(on, p->name, label_width, p->labels, label_count(p), &chosen))
            set_value(self, of, index, p->min + (double)chosen);
    } else {
        ui_range range = {p->min,
                          p->max,
                          p->unit,
                          p->max - p->min < 20.0 ? 2u : 0u,
                          (p->flags & MRT_PARAM_STEPPED) != 0,
                          p->initial};
        if (ui_slider(on, p->name, label_width, &range, &value))
            set_value(self, of, index, value);
    }
    ui_hint(on, p->help);
}

static bool has_params(const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (!(type->params[i].flags & MRT_PARAM_HIDDEN))
            return true;
    return false;
}

static void draw_params(panel *self, ui *on, input *of)
{
    const mrt_plugin_type *type = input_plugin(of);
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (!(type->params[i].flags & MRT_PARAM_HIDDEN))
            draw_param(self, on, of, i);
}

/* Returns whether the program itself makes the input, such as the keyboard as a hand. It sends no
 * samples while nothing moves it. */
static bool is_made(const panel *self, const input *of)
{
    return !plugin_list_path_of(app_plugins(self->app), input_plugin(of));
}

static bool is_recorded(const input *of)
{
    const mrt_input *functions = plugin_interface(input_plugin(of), MRT_INPUT);
    return functions->flags & MRT_INPUT_RECORDED;
}

/* ---- the camera ---- */

static bool is_camera(const input *of)
{
    return strcmp(input_plugin(of)->id, CAMERA_PAGE_PLUGIN) == 0;
}

/* The card on the stage does all of it. port 0: of the open camera, which is opened if necessary.
 */
static void ask_camera(panel *self, uint16_t port)
{
    app_notes_of(self->app)->camera_port = port;
    app_ask(self->app, APP_CALL_CAMERA);
}

static void draw_camera_card(panel *self, ui *on, const char *input_text)
{
    settings *kept = app_settings(self->app);
    bool is_shown = settings_number(kept, APP_CAMERA_PREVIEW, 1.0) > 0.0;
    const bool has_tracker = app_notes_of(self->app)->has_tracker;
    if (ui_button(on, has_tracker ? "Open camera page" : "Download hand tracking", UI_PLAIN))
        ask_camera(self, camera_page_port(input_text));
    ui_hint(on,
            has_tracker
                ? "Open the page in your browser, then start the camera there and show a hand."
                : "Download the hand tracker once (13 MB), then open the page in your browser.");
    if (ui_check(on, "Show the hand on the stage", &is_shown))
        settings_set_number(kept, APP_CAMERA_PREVIEW, is_shown ? 1.0 : 0.0);
    ui_hint(on, "Show in a corner of the stage how the camera sees your hand.");
}

static void draw_use_camera(panel *self, ui *on)
{
    if (ui_button(on, "Use the camera", UI_PLAIN))
        ask_camera(self, 0);
    ui_hint(on, "Track a bare hand with a webcam, on a page in your browser.");
    ui_space(on, 4.0f);
}

static const input_meter *read_meter(panel *self, ui *on, uint32_t index)
{
    input *of = live_input(app_live(self->app), index);
    input_meter *out = &self->meter[index % METERS];
    const int64_t now_ns = clock_now_ns();
    const uint64_t number = app_view(self->app)->number;
    ui_want_frame(on, meter_every_s);
    if (out->of == of && out->face == number &&
        (double)(now_ns - out->read_ns) < 0.9 * meter_every_s * (double)NS_PER_S)
        return out;
    *out = (input_meter){.of = of, .read_ns = now_ns, .face = number};
    input_health(of, &out->health);
    out->has_sample = live_input_sample(app_live(self->app), index, &out->sample);
    return out;
}

/* Draws an open input. Returns false if the user removes it. */
static bool devices_card_draw(panel *self, ui *on, uint32_t index)
{
    live *stage = app_live(self->app);
    input *of = live_input(stage, index);
    uint32_t count;
    const mrt_channel *channels = input_channels(of, &count);
    char state[DEVICES_WORDS], why[DEVICES_WORDS];
    const input_meter *now = read_meter(self, on, index);
    const health_report *health = &now->health;
    devices_light light = devices_words_state(health, state, why);
    if (is_made(self, of) && light == DEVICES_WAITS) {
        light = DEVICES_WELL;
        (void)snprintf(state, sizeof state, "at rest");
    }
    bool stays = draw_head(on, is_made(self, of) ? input_plugin(of)->name : input_name(of), light,
                           "Remove", "Close this input. Its recorded performances are kept.");
    draw_state(on, health, light, state, why);
    draw_strip(on, channels, count, now->has_sample ? &now->sample : NULL);
    if (is_camera(of))
        draw_camera_card(self, on, live_input_text(stage, index));
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        const glove_channels_kind kind = glove_channels_of(channels, count, side);
        char tracker[HAND_INPUT] = "";
        if (kind == GLOVE_CHANNELS_RAD)
            glove_channels_input(tracker, input_name(of));
        if (kind == GLOVE_CHANNELS_COUNT ||
            (kind == GLOVE_CHANNELS_RAD && !is_recorded(of) && !is_made(self, of)))
            draw_calibration(self, on, index, side, tracker);
    }
    if (ui_section(on, "Details", false))
        draw_details(on, health, channels, count);
    if (has_params(input_plugin(of)) && ui_section(on, "Settings", false))
        draw_params(self, on, of);
    return stays;
}

/* Draws an input that is being opened. Returns false if the user cancels it. */
static bool devices_card_draw_opening(ui *on, const input_opening *one)
{
    bool stays = draw_head(on, one->name, DEVICES_OVER, "Cancel", "Cancel opening this input.");
    ui_text(on, UI_STYLE_DIM,
            one->is_open ? "open, used after the current take ends" : "opening\u2026");
    return stays;
}

/* ---- inputs that can be opened ---- */

static const float button = 64.0f;

static const char *const state_words[] = {[MRT_DEVICE_READY] = "ready",
                                          [MRT_DEVICE_BUSY] = "in use by another program",
                                          [MRT_DEVICE_DENIED] = "no permission to open it",
                                          [MRT_DEVICE_UNSURE] = "a device may be connected"};

/* ---- connected devices ---- */

static bool is_open(const panel *self, const device_found *device, bool is_first)
{
    const live *stage = app_live(self->app);
    for (uint32_t i = 0; i < live_input_count(stage); ++i)
        if (devices_is_open(live_input_text(stage, i), device, is_first))
            return true;
    for (uint32_t i = 0; i < self->opening_count; ++i)
        if (devices_is_open(self->opening[i].text, device, is_first))
            return true;
    return false;
}

static bool is_first_of_plugin(const device_list *list, uint32_t index)
{
    for (uint32_t i = 0; i < index; ++i)
        if (list->one[i].type == list->one[index].type)
            return false;
    return true;
}

static void draw_device(panel *self, ui *on, const device_found *found)
{
    const mrt_device *device = &found->device;
    char text[256];
    bool is_known = device->state >= MRT_DEVICE_READY && device->state <= MRT_DEVICE_UNSURE;
    bool can_open = device->state == MRT_DEVICE_READY || device->state == MRT_DEVICE_UNSURE;
    ui_text(on, UI_STYLE_STRONG, device->name[0] ? device->name : device->address);
    const char *words = is_known ? state_words[device->state] : "unknown";
    if (can_open && devices_input_text(found, text, sizeof text)) {
        ui_label(on, "state", ui_available_width(on) - button - 8.0f, THEME_DIM, words);
        ui_width(on, button);
        if (ui_button(on, "Open", UI_PLAIN))
            open_input(self, text);
        ui_hint(on, text);
    } else {
        ui_text(on, UI_STYLE_WARNING, words);
    }
    if (device->advice[0])
        ui_text_wrapped(on, UI_STYLE_DIM, device->advice);
    ui_space(on, 6.0f);
}

static void draw_found(panel *self, ui *on)
{
    const device_list *list = &self->found->devices;
    uint32_t shown = 0;
    for (uint32_t i = 0; self->found->is_known && i < list->count; ++i) {
        if (is_open(self, &list->one[i], is_first_of_plugin(list, i)))
            continue;
        ui_id_begin(on, list->one[i].device.address);
        draw_device(self, on, &list->one[i]);
        ui_id_end(on);
        shown += 1;
    }
    if (!self->search)
        ui_text_wrapped(on, UI_STYLE_DIM, "Cannot search for devices. Restart marotte.");
    else if (!self->found->is_known)
        ui_text(on, UI_STYLE_DIM, "Searching\xe2\x80\xa6");
    else if (shown == 0 && list->count > 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "All connected devices are open.");
    else if (shown == 0)
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "No devices found. Connect a glove or a pedal, and it appears here.");
    if (self->found->note.text[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, self->found->note.text);
}

/* ---- recordings and network ---- */

static void open_recording(panel *self)
{
    char text[DEVICES_PATH + 32];
    if (!self->path[0])
        app_ask(self->app, APP_CALL_RECORDING);
    else if (strchr(self->path, ','))
        report_trouble(self, "Cannot open a path that contains a comma. Rename the file.");
    else {
        (void)snprintf(text, sizeof text, "log:%s%s", self->path, self->repeats ? ",loop=1" : "");
        open_input(self, text);
    }
}

static void open_demo_hand(panel *self)
{
    char text[APP_DEMO_TEXT];
    if (app_demo_hand(text))
        open_input(self, text);
    else
        report_trouble(self, "The demo hand is not installed. Open a recording instead.");
}

static void draw_recording(panel *self, ui *on)
{
    ui_text(on, UI_STYLE_DIM, "Recording of a hand");
    ui_width(on, -(button + 8.0f));
    (void)ui_input(on, "##path", "path of a log file", self->path, sizeof self->path);
    const bool is_entered = ui_input_is_entered(on) && self->path[0];
    ui_hint(on, "Open a .csv table of joint angles or sensor counts, or a recording of GraspDB14.");
    ui_same_line(on);
    ui_width(on, button);
    const bool is_pressed =
        ui_button(on, self->path[0] ? "Open##recording" : "Browse##recording", UI_PLAIN);
    ui_hint(on, self->path[0] ? "Open this recording." : "Choose a recording of a hand.");
    if (is_pressed || is_entered)
        open_recording(self);
    (void)ui_check(on, "Loop", &self->repeats);
    ui_hint(on, "Play the recording again from the start when it ends.");
    ui_same_line(on);
    ui_at(on, 92.0f);
    if (ui_button(on, "Demo hand", UI_PLAIN))
        open_demo_hand(self);
    ui_hint(on, "Open a recorded hand that performs in a loop until you remove it.");
}

static void draw_network(panel *self, ui *on)
{
    char text[160];
    ui_text(on, UI_STYLE_DIM, "Over the network (OSC)");
    ui_width(on, -(button + 8.0f));
    (void)ui_input(on, "##osc", "9105", self->osc, sizeof self->osc);
    const bool is_entered = ui_input_is_entered(on);
    ui_hint(on, "PORT receives from this computer only, 0.0.0.0:PORT from all computers. A device "
                "that another marotte forwards is found, PORT/NAME chooses one of several.");
    ui_same_line(on);
    ui_width(on, button);
    if (!ui_button(on, "Open##osc", UI_PLAIN) && !is_entered)
        return;
    (void)snprintf(text, sizeof text, "osc:%s", self->osc[0] ? self->osc : "9105");
    open_input(self, text);
}

/* Draws the inputs that can be opened. */
static void devices_open_draw(panel *self, ui *on)
{
    ui_text(on, UI_STYLE_TITLE, "Devices found");
    ui_space(on, 2.0f);
    draw_found(self, on);
    ui_space(on, 6.0f);
    ui_rule(on);
    draw_recording(self, on);
    ui_space(on, 4.0f);
    draw_network(self, on);
}

/* ---- re-zero ---- */

static const char *const pedal_items[MRT_MAX_PEDALS + 1] = {"no pedal", "pedal 1", "pedal 2",
                                                            "pedal 3", "pedal 4"};

/* Remembers whether the last re-zero was refused. */
static void follow_rezeros(panel *self)
{
    const rezero_counts *now = &app_status(self->app)->rezeros;
    if (now->refused != self->rezeros.refused)
        self->was_refused = true;
    if (now->done != self->rezeros.done)
        self->was_refused = false;
    self->rezeros = *now;
}

static void draw_rezero(panel *self, ui *on)
{
    uint32_t pedal = (uint32_t)settings_number(app_settings(self->app), APP_REZERO_PEDAL, 0.0);
    if (ui_button(on, "Re-zero", UI_PLAIN))
        app_do(self->app, ACTION_REZERO);
    ui_hint(on, "Make the current pose of the hands their rest (Z). Hold the hands still.");
    ui_same_line(on);
    ui_at(on, 92.0f);
    if (ui_choice(on, "also by", 58.0f, pedal_items, MRT_MAX_PEDALS + 1, &pedal)) {
        settings_set_number(app_settings(self->app), APP_REZERO_PEDAL, (double)pedal);
        live_set_rezero_pedal(app_live(self->app), pedal);
    }
    ui_hint(on, "Re-zero with this pedal too. Mappings then ignore it.");
    if (self->was_refused && self->rezeros.refusal.text[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, self->rezeros.refusal.text);
}

/* ---- remote control ---- */

static void draw_remote(panel *self, ui *on)
{
    static const char usual[] = "9110";
    const app_remote_status now = app_remote_now(self->app);
    bool is_on = now.address[0] != '\0';
    char line[96];
    if (!ui_section(on, "Remote control", false))
        return;
    if (ui_check(on, "Allow a phone, a Stream Deck or a script", &is_on))
        app_set_remote(self->app, !is_on ? "" : self->remote[0] ? self->remote : usual);
    ui_hint(on, "Record, stop, mark, keep, go to neutral and choose presets and expressions by OSC "
                "or WebSocket.");
    ui_width(on, -1.0f);
    if (ui_input(on, "##remote", "port, or 0.0.0.0:9110 for all computers", self->remote,
                 sizeof self->remote) &&
        is_on)
        app_set_remote(self->app, self->remote[0] ? self->remote : usual);
    if (now.trouble[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, now.trouble);
    else if (now.is_listening) {
        (void)snprintf(line, sizeof line, "listening, %u connected by WebSocket", now.clients);
        ui_text_wrapped(on, UI_STYLE_DIM, line);
    }
    if (now.code[0]) {
        (void)snprintf(line, sizeof line, "pairing code: %s", now.code);
        ui_text_wrapped(on, UI_STYLE_BODY, line);
        ui_hint(on, "Use this code in OSC (/marotte/remote/CODE/record) and WebSocket "
                    "(ws://HOST:9110/CODE/). Remote control is off at the next start.");
        if (ui_button(on, "New code", UI_QUIET))
            app_renew_remote_code(self->app);
    }
    if (is_on && now.last[0])
        ui_text_wrapped(on, UI_STYLE_DIM, now.last);
}

/* ---- the picture for other programs ---- */

static void draw_picture(panel *self, ui *on)
{
    static const char *const words[] = {"studio wall", "transparent", "green", "blue"};
    static const char *const colours[] = {"", "transparent", "#00b140", "#0047bb"};
    app_picture wanted = *app_picture_now(self->app);
    uint32_t ground = 0, count;
    bool is_new = false;
    if (!ui_section(on, "Video for other programs", false))
        return;
    for (uint32_t i = 0; i < 4; ++i)
        if (strcmp(wanted.background, colours[i]) == 0)
            ground = i;
    if (ui_choice(on, "Backdrop", 66.0f, words, 4, &ground)) {
        (void)snprintf(wanted.background, sizeof wanted.background, "%s", colours[ground]);
        is_new = true;
    }
    char hint[256], keys[KEY_WORDS + 4];
    key_map_after(&app_looks_of(self->app)->keys, ACTION_OUTPUT, keys);
    (void)snprintf(hint, sizeof hint,
                   "Set the background of the output window%s and of streams. Transparent shows "
                   "the desktop or the lower layers of OBS.",
                   keys);
    ui_hint(on, hint);
    is_new |= ui_check(on, "Output in a window, even with a second screen", &wanted.is_window);
    is_new |= ui_check(on, "Output window always on top", &wanted.is_on_top);
    ui_width(on, -1.0f);
    if (ui_input(on, "##streams", "pipewire  /dev/video10  srt://HOST:PORT", self->streams,
                 sizeof self->streams)) {
        (void)snprintf(wanted.targets, sizeof wanted.targets, "%s", self->streams);
        is_new = true;
    }
    ui_hint(on, "Send the video to PipeWire, a v4l2loopback device or an ffmpeg stream. Separate "
                "several targets with spaces.");
    const char *says = app_picture_says(self->app, &count);
    if (count > 0)
        ui_text_wrapped(on, says[0] ? UI_STYLE_WARNING : UI_STYLE_DIM,
                        says[0] ? says : "sending video");
    if (is_new)
        app_set_picture(self->app, &wanted);
}

/* ---- the panel ---- */

/* Searches for devices again when an input was opened or closed. */
static void follow_inputs(panel *self)
{
    const uint32_t count = live_input_count(app_live(self->app));
    if (count != self->input_count && self->search)
        devices_search_again(self->search);
    if (count > self->input_count)
        self->trouble[0] = '\0'; /* of what was tried before */
    self->input_count = count;
}

static void draw_inputs(panel *self, ui *on)
{
    live *stage = app_live(self->app);
    uint32_t removed = UINT32_MAX, drawn = 0;
    char id[32];
    for (uint32_t i = 0; i < live_input_count(stage); ++i) {
        if (live_input_is_own(stage, i)) /* in the panel Poses */
            continue;
        drawn += 1;
        (void)snprintf(id, sizeof id, "input %u", i);
        ui_id_begin(on, id);
        if (!devices_card_draw(self, on, i))
            removed = i;
        ui_id_end(on);
        ui_space(on, 2.0f);
        ui_rule(on);
        ui_space(on, 2.0f);
    }
    for (uint32_t i = 0; i < self->opening_count; ++i) {
        (void)snprintf(id, sizeof id, "opening %u", i);
        ui_id_begin(on, id);
        if (!devices_card_draw_opening(on, &self->opening[i]))
            app_give_up_opening(self->app, self->opening[i].id);
        ui_id_end(on);
        ui_space(on, 2.0f);
        ui_rule(on);
        ui_space(on, 2.0f);
    }
    if (drawn == 0 && self->opening_count == 0) {
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "No input is open. Drag the face with the mouse, or open an input below.");
        ui_space(on, 4.0f);
        draw_use_camera(self, on);
    }
    if (removed != UINT32_MAX)
        remove_input(self, removed);
}

static void draw_trouble(const panel *self, ui *on)
{
    const char *words = self->trouble[0] ? self->trouble : app_opening_trouble(self->app);
    if (!words[0])
        return;
    ui_space(on, 4.0f);
    ui_text_wrapped(on, UI_STYLE_BAD, words);
}

static void draw(panel *self, ui *on, ui_rectangle where)
{
    static const findings nothing;
    self->found = self->search ? devices_search_look(self->search) : &nothing;
    self->opening_count = app_openings(self->app, self->opening);
    ui_panel_begin(on, "devices", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    draw_inputs(self, on);
    draw_rezero(self, on);
    draw_trouble(self, on);
    ui_space(on, 6.0f);
    ui_rule(on);
    devices_open_draw(self, on);
    draw_remote(self, on);
    draw_picture(self, on);
    ui_scroll_end(on);
    calibrate_panel_draw(self->calibrate, on);
    ui_panel_end(on);
}

static void update(panel *self, double dt_s)
{
    uint32_t side;
    (void)dt_s;
    follow_rezeros(self);
    follow_inputs(self);
    calibrate_panel_update(self->calibrate);
    const char *kept = calibrate_panel_pop_saved(self->calibrate, &side);
    if (!kept)
        return;
    calibrate(self, side, kept);
    if (self->search)
        devices_search_again(self->search);
}

/* Restores the re-zero pedal and the calibrations of the previous run. */
static void use_settings(panel *self)
{
    const settings *kept = app_settings(self->app);
    live *stage = app_live(self->app);
    double pedal = settings_number(kept, APP_REZERO_PEDAL, 0.0);
    if (pedal >= 1.0 && pedal <= MRT_MAX_PEDALS)
        live_set_rezero_pedal(stage, (uint32_t)pedal);
    calibrate_use_kept(self->app);
}

static void destroy(panel *self)
{
    if (!self)
        return;
    devices_search_destroy(self->search);
    calibrate_panel_destroy(self->calibrate);
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->repeats = true;
    self->calibrate = calibrate_panel_create(of);
    self->search = devices_search_create(app_plugins(of), app_log(of));
    if (!self->calibrate) {
        destroy(self);
        return NULL;
    }
    use_settings(self);
    (void)snprintf(self->streams, sizeof self->streams, "%s", app_picture_now(of)->targets);
    (void)snprintf(self->remote, sizeof self->remote, "%s", app_remote_now(of).address);
    self->rezeros = app_status(of)->rezeros;
    return self;
}

const panel_type panel_devices = {create, destroy, draw, update};
