#include "stage/recorder.h"
#include "base/clock.h"
#include "stage/identity.h"
#include "stage/source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* How far apart states are kept: so much of an anchored take is performed again in some
 * milliseconds, of an unanchored one in some tens. */
static const int64_t anchored_span_ns = 5 * NS_PER_S;
static const int64_t unanchored_span_ns = 2 * NS_PER_S;
/* Faster than life: so many samples are handed over before it waits for the writer. */
enum { SAMPLES_AHEAD = 256, INPUTS_MAX = TAKE_TRACKS_MAX };
/* Room for a state beside its shapes. */
static const size_t state_bytes = (size_t)256 << 10;

struct recorder {
    recorder_settings settings;
    writer *writer;
    int64_t track[INPUTS_MAX];
    uint32_t version[INPUTS_MAX];
    take_performance performance;
    bool has_begun; /* the performance */
    int64_t last_ns, checkpoint_ns;
    uint32_t current; /* input whose sample is performed */
    uint32_t ahead;
    bool is_take_wanted, is_take_open;
    writer_slate slate;
    char scene[TAKE_NAME], shot[TAKE_NAME];
    int64_t take;
    uint32_t rezero;        /* bits by side: granted, and not yet told */
    bool has_other_mapping; /* from the next sample on */
    error problem;
};

static void note_problem(recorder *self, const error *err)
{
    if (self->problem.text[0])
        return;
    self->problem = *err;
    log_push(self->settings.log, MRT_LOG_ERROR, "recorder", err->text);
}

/* ---- what is performed ---- */

static char *copy_text(const char *text)
{
    size_t size = strlen(text) + 1;
    char *out = malloc(size);
    if (out)
        memcpy(out, text, size);
    return out;
}

static mrt_result describe_performance(recorder *self, error *err)
{
    take_performance *p = &self->performance;
    instance *mapping = layer_mapping(self->settings.layer);
    mrt_result result = identity_of_face(p, self->settings.face, self->settings.face_path,
                                         self->settings.unit_mm, err);
    if (result < 0)
        return result;
    p->mapping = identity_of_plugin(self->settings.plugins, mapping->type);
    if (!p->mapping)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record");
    p->hand_length_mm = self->settings.hand_length_mm;
    p->rezero_pedal = self->settings.rezero_pedal;
    p->track_count = self->settings.input_count;
    memcpy(p->track, self->track, sizeof p->track);
    identity_of_params(p, mapping);
    return MRT_OK;
}

static void describe_channels(take_track *out, const mrt_channel *channel, uint32_t count)
{
    out->channel_count = count;
    for (uint32_t i = 0; i < count; ++i) {
        take_channel *c = &out->channel[i];
        snprintf(c->name, sizeof c->name, "%s", channel[i].name);
        snprintf(c->unit, sizeof c->unit, "%s", channel[i].unit);
        c->semantic = channel[i].semantic;
        c->hand = channel[i].hand;
        c->min = channel[i].min;
        c->max = channel[i].max;
    }
}

static mrt_result add_track(recorder *self, uint32_t i, uint32_t version, error *err)
{
    const recorder_settings *s = &self->settings;
    take_track track = {0};
    uint32_t count;
    const mrt_channel *channel = input_channels_of(s->inputs[i], version, &count);
    describe_channels(&track, channel, count);
    track.input = copy_text(s->input_text[i]);
    track.device = copy_text(input_name(s->inputs[i]));
    track.plugin = identity_of_plugin(s->plugins, input_plugin(s->inputs[i]));
    mrt_result result = MRT_OK;
    if (!track.input || !track.device || !track.plugin)
        result = error_set(err, MRT_ERR_MEMORY, "no memory to record");
    for (int side = 0; side < 2 && result >= 0; ++side) {
        if (!s->calibration[side])
            continue;
        track.calibration[side] = copy_text(s->calibration[side]);
        if (!track.calibration[side])
            result = error_set(err, MRT_ERR_MEMORY, "no memory to record");
    }
    if (result >= 0)
        result = writer_add_track(self->writer, &track, err);
    self->track[i] = track.id;
    self->version[i] = version;
    take_track_finish(&track);
    return result;
}

/* ---- started and stopped ---- */

static size_t checkpoint_capacity(const recorder_settings *s)
{
    if (!s->performer)
        return 0;
    const points *rest = face_rest(performer_face(s->performer));
    return state_bytes + (size_t)rest->padded_count * 2 * 3 * sizeof(float);
}

static void on_param(void *data, const mrt_sample *sample, uint32_t param_id, double value)
{
    recorder *self = data;
    take_event event = {.time_ns = sample->time_ns,
                        .kind = TAKE_EVENT_PARAM,
                        .param = param_id,
                        .track = self->track[self->current],
                        .value = value};
    writer_event(self->writer, &event);
}

static mrt_result start(recorder *self, error *err)
{
    const recorder_settings *s = &self->settings;
    struct timespec utc;
    clock_gettime(CLOCK_REALTIME, &utc);
    writer_options options = {
        .utc_ns = (int64_t)utc.tv_sec * NS_PER_S + utc.tv_nsec,
        .monotonic_ns = s->clock == CLOCK_VIRTUAL ? 0 : clock_now_ns(),
        .program = "marotte " MAROTTE_VERSION,
        .journal_ns = s->journal_ns,
        .checkpoint_bytes = checkpoint_capacity(s),
    };
    mrt_result result = writer_start(&self->writer, s->show, &options, err);
    for (uint32_t i = 0; i < s->input_count && result >= 0; ++i)
        result = add_track(self, i, 0, err);
    if (result >= 0)
        result = describe_performance(self, err);
    return result;
}

mrt_result recorder_start(recorder **out, const recorder_settings *settings, error *err)
{
    *out = NULL;
    if (settings->input_count > INPUTS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%u inputs: %d can be recorded",
                         settings->input_count, INPUTS_MAX);
    recorder *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record");
    self->settings = *settings;
    self->checkpoint_ns = INT64_MIN;
    mrt_result result = start(self, err);
    if (result < 0) {
        error ignored = {""};
        if (recorder_stop(self, &ignored) < 0)
            return result;
        return result;
    }
    layer_watch_params(settings->layer, on_param, self);
    *out = self;
    return MRT_OK;
}

mrt_result recorder_stop(recorder *self, error *err)
{
    mrt_result result = MRT_OK;
    if (!self)
        return MRT_OK;
    layer_watch_params(self->settings.layer, NULL, NULL);
    if (self->is_take_open)
        result = recorder_take_end(self, err);
    if (self->writer && self->has_begun && result >= 0)
        result = writer_end_performance(self->writer, self->last_ns + 1, err);
    error later = {""};
    if (self->writer && writer_stop(self->writer, &later) < 0 && result >= 0)
        result = error_set(err, MRT_ERR_IO, "%s", later.text);
    take_performance_finish(&self->performance);
    free(self);
    return result;
}

/* ---- takes ---- */

void recorder_take_next(recorder *self, const writer_slate *slate)
{
    snprintf(self->scene, sizeof self->scene, "%s", slate->scene ? slate->scene : "");
    snprintf(self->shot, sizeof self->shot, "%s", slate->shot ? slate->shot : "");
    self->slate = (writer_slate){self->scene, self->shot, slate->number};
    self->is_take_wanted = true;
}

mrt_result recorder_take_end(recorder *self, error *err)
{
    self->is_take_wanted = false;
    if (!self->is_take_open)
        return MRT_OK;
    self->is_take_open = false;
    return writer_take_end(self->writer, self->take, self->last_ns + 1, err);
}

mrt_result recorder_keep(recorder *self, double seconds, const writer_slate *slate,
                         int64_t *out_take, error *err)
{
    if (!(seconds > 0) || !(seconds <= 1e6))
        return error_set(err, MRT_ERR_ARGUMENT, "%g s cannot be kept", seconds);
    if (!self->has_begun)
        return error_set(err, MRT_ERR_ARGUMENT, "nothing was performed yet");
    mrt_result result =
        writer_keep(self->writer, self->last_ns - (int64_t)(seconds * (double)NS_PER_S),
                    self->last_ns + 1, slate, out_take, err);
    if (result >= 0)
        self->take = *out_take;
    return result;
}

int64_t recorder_performance(const recorder *self)
{
    return self->has_begun ? self->performance.id : 0;
}

int64_t recorder_take(const recorder *self)
{
    return self->take;
}

const char *recorder_problem(const recorder *self)
{
    return self->problem.text;
}

writer *recorder_writer(recorder *self)
{
    return self->writer;
}

/* ---- while it happens ---- */

static void keep_state(recorder *self, int64_t time_ns)
{
    if (!self->settings.performer)
        return;
    void *buffer = writer_checkpoint_buffer(self->writer);
    size_t capacity = checkpoint_capacity(&self->settings);
    if (!buffer)
        return; /* the disk does not keep up: the next one then */
    int64_t offset_ns = writer_show_ns(self->writer, 0);
    size_t size = source_keep(self->settings.performer, offset_ns, buffer, capacity);
    bool fits = size > 0 && size <= capacity;
    writer_checkpoint(self->writer, self->performance.id, time_ns, SOURCE_CHECKPOINT_VERSION,
                      buffer, fits ? size : 0);
    self->checkpoint_ns = time_ns;
}

static mrt_result begin_performance(recorder *self, int64_t time_ns, error *err)
{
    bool goes_on = self->has_begun;
    mrt_result result = writer_begin_performance(self->writer, &self->performance, time_ns, err);
    if (result < 0)
        return result;
    self->has_begun = true;
    self->checkpoint_ns = time_ns;
    if (goes_on) /* it does not start at rest */
        keep_state(self, time_ns - 1);
    return MRT_OK;
}

/* A plugin that was restarted may give other channels: another track, another performance. */
static mrt_result follow_version(recorder *self, uint32_t i, int64_t time_ns, error *err)
{
    uint32_t version = input_version(self->settings.inputs[i]);
    if (version == self->version[i] && self->has_begun && !self->has_other_mapping)
        return MRT_OK;
    mrt_result result = MRT_OK;
    if (self->has_other_mapping)
        identity_of_params(&self->performance, layer_mapping(self->settings.layer));
    self->has_other_mapping = false;
    if (version != self->version[i]) {
        result = writer_end_track(self->writer, self->track[i], err);
        if (result >= 0)
            result = add_track(self, i, version, err);
        memcpy(self->performance.track, self->track, sizeof self->performance.track);
        identity_of_params(&self->performance, layer_mapping(self->settings.layer));
    }
    return result < 0 ? result : begin_performance(self, time_ns, err);
}

static mrt_result begin_take(recorder *self, int64_t time_ns, error *err)
{
    if (!self->is_take_wanted)
        return MRT_OK;
    self->is_take_wanted = false;
    mrt_result result = writer_take_begin(self->writer, time_ns, &self->slate, &self->take, err);
    self->is_take_open = result >= 0;
    return result;
}

static void tell_rezeros(recorder *self, int64_t time_ns)
{
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        take_event event = {.time_ns = time_ns,
                            .kind = TAKE_EVENT_REZERO,
                            .hand = side,
                            .track = self->track[self->current]};
        if (self->rezero & (1u << side))
            writer_event(self->writer, &event);
    }
    self->rezero = 0;
}

void recorder_sample(recorder *self, uint32_t from, const mrt_sample *sample)
{
    error err = {""};
    self->current = from;
    mrt_result result = follow_version(self, from, sample->time_ns, &err);
    if (result >= 0)
        result = begin_take(self, sample->time_ns, &err);
    if (result < 0)
        note_problem(self, &err);
    tell_rezeros(self, sample->time_ns);
    writer_sample(self->writer, self->track[from], sample);
    self->last_ns = sample->time_ns;
    if (self->settings.clock != CLOCK_VIRTUAL || ++self->ahead < SAMPLES_AHEAD)
        return;
    self->ahead = 0;
    if (writer_flush(self->writer, &err) < 0)
        note_problem(self, &err);
}

void recorder_performed(recorder *self, uint32_t from, const mrt_sample *sample)
{
    (void)from;
    if (!self->settings.performer)
        return;
    int64_t span_ns =
        performer_is_anchored(self->settings.performer) ? anchored_span_ns : unanchored_span_ns;
    if (self->has_begun && sample->time_ns - self->checkpoint_ns >= span_ns)
        keep_state(self, sample->time_ns);
}

void recorder_rezero(recorder *self, uint32_t side)
{
    self->rezero |= 1u << side;
}

void recorder_change_mapping(recorder *self, const char *identity)
{
    char *copy = copy_text(identity);
    error err = {""};
    if (!copy) {
        (void)error_set(&err, MRT_ERR_MEMORY, "no memory to record the rebuilt mapping");
        note_problem(self, &err);
        return;
    }
    free(self->performance.mapping);
    self->performance.mapping = copy;
    self->has_other_mapping = true;
}

void recorder_incident(recorder *self, uint32_t from, const input_incident *what)
{
    take_event event = {.time_ns = what->time_ns,
                        .kind = what->kind == INPUT_WENT ? TAKE_EVENT_WENT : TAKE_EVENT_CAME,
                        .track = self->track[from]};
    snprintf(event.text, sizeof event.text, "%.90s", what->text);
    writer_event(self->writer, &event);
}
