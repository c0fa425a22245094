#include "stage/record/recorder.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/trace.h"
#include "stage/mapping/isolate.h"
#include "stage/perform/patch_file.h"
#include "stage/playback/replay.h"
#include "show/hash.h"

#include <limits.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RECORDER_INPUTS_MAX = TAKE_TRACKS_MAX };

/* Passes the samples of one input to the writer as soon as they arrive. [main] except `writer` and
 * `place`, which are [any]. */
typedef struct recorder_arrivals {
    input *of; /* NULL: unused */
    writer *writer;
    uint32_t place, user_count; /* user_count: number of casts */
} recorder_arrivals;
enum { ARRIVALS_MAX = 2 * RECORDER_INPUTS_MAX }; /* for two casts */

struct recorder_cast { /* the performing parts and how they are recorded */
    input *inputs[RECORDER_INPUTS_MAX];
    recorder_arrivals *arrivals[RECORDER_INPUTS_MAX]; /* NULL: virtual clock */
    const char *input_text[RECORDER_INPUTS_MAX];
    uint32_t input_count;
    char *calibration[2];
    layer *layer;
    performer *performer;
    int64_t track[RECORDER_INPUTS_MAX];
    uint32_t version[RECORDER_INPUTS_MAX];
    int32_t code[RECORDER_INPUTS_MAX], code_rate[RECORDER_INPUTS_MAX]; /* channel; -1: none */
    bool is_kept[RECORDER_INPUTS_MAX]; /* the track continues in another cast */
    /* Prepared on [main] and constant, so that the frame thread can begin a track or
     * performance. */
    take_track described[RECORDER_INPUTS_MAX]; /* without channels */
    take_texts *track_texts[RECORDER_INPUTS_MAX], *texts;
    take_performance performance; /* owned by the frame thread */
    char rebuilt[TAKE_IDENTITY];  /* identity of the mapping after a reload; "": unchanged */
};

struct recorder {
    recorder_settings settings;
    size_t state_capacity;
    writer *writer;
    recorder_cast *cast;
    recorder_arrivals arrivals[ARRIVALS_MAX];
    bool has_begun;   /* a performance has begun */
    bool is_to_begin; /* another performance begins with the next sample */
    layer *watched;
    int64_t last_ns, checkpoint_ns;
    recorder_code code;
    int64_t begun_ns, take_from_ns; /* start of the performance; wanted start of the take, 0: now */
    uint32_t current;               /* first input of the current step */
    uint32_t ahead;
    bool is_take_wanted, is_take_open;
    writer_slate slate;
    char scene[TAKE_NAME], shot[TAKE_NAME];
    int64_t take;
    uint32_t rezero; /* one bit per side: granted and not recorded yet */
    error problem;
    _Atomic int32_t problem_state; /* an enum problem_state */
};

/* Only the first problem is stored, from any thread. */
enum problem_state { PROBLEM_NONE = 0, PROBLEM_IS_WRITTEN, PROBLEM_STANDS };

/* [any] Stores and logs the problem if it is the first. */
static void note_problem(recorder *self, const error *err)
{
    int32_t none = PROBLEM_NONE;
    if (!atomic_compare_exchange_strong(&self->problem_state, &none, PROBLEM_IS_WRITTEN))
        return;
    self->problem = *err;
    atomic_store(&self->problem_state, PROBLEM_STANDS);
    log_push(self->settings.log, MRT_LOG_ERROR, "recorder", err->text);
}

/* ---- identity of plugins and faces ---- */

enum { RIG_BYTES_MAX = 16 << 20 };

char *recorder_plugin_identity(const plugin_list *plugins, const mrt_plugin_type *type)
{
    char hash[TAKE_HASH] = "-";
    error ignored = {""};
    type = isolate_inner(type);
    const char *path = plugin_list_path_of(plugins, type);
    if (path && hash_file(hash, path, &ignored) < 0)
        snprintf(hash, sizeof hash, "-");
    size_t size = strlen(type->id) + strlen(type->version) + sizeof hash + 3;
    char *out = malloc(size);
    if (out)
        snprintf(out, size, "%s %s %s", type->id, type->version, hash);
    return out;
}

static mrt_result keep_rig(take_performance *out, const char *path, error *err)
{
    file_bytes text;
    mrt_result result = file_read(&text, path, RIG_BYTES_MAX, err);
    if (result < 0)
        return result;
    hash_bytes(out->rig_hash, text.data, text.size);
    out->rig_json = strdup((const char *)text.data);
    file_bytes_finish(&text);
    return out->rig_json ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
}

mrt_result recorder_face_identity(take_performance *out, const face_file *file, const char *path,
                                  double unit_mm, error *err)
{
    char absolute[PATH_MAX];
    const char *whole = realpath(path, absolute);
    free(out->rig);
    free(out->rig_json);
    out->rig_json = NULL;
    out->rig_hash[0] = '\0';
    out->unit_mm = unit_mm;
    out->rig = strdup(whole ? whole : path);
    if (!out->rig)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
    mrt_result result = hash_file(out->mesh_hash, file->rig ? file->rig->mesh_path : path, err);
    return result < 0 || !file->rig ? result : keep_rig(out, path, err);
}

void recorder_param_values(take_performance *out, const instance *mapping)
{
    const mrt_plugin_type *type = mapping->type;
    out->param_count = 0;
    for (uint32_t i = 0; i < type->param_count && i < TAKE_PARAMS_MAX; ++i)
        if (!(type->params[i].flags & MRT_PARAM_TRIGGER))
            out->param[out->param_count++] =
                (take_param){type->params[i].id, atomic_load(&mapping->wanted[i])};
}

/* ---- the performance ---- */

static mrt_result describe_performance(const recorder *self, recorder_cast *cast,
                                       const recorder_settings *of, error *err)
{
    take_performance *p = &cast->performance;
    instance *mapping = of->mapping ? of->mapping : cast->layer->mapping;
    mrt_result result = recorder_face_identity(p, of->face, of->face_path, of->unit_mm, err);
    if (result < 0)
        return result;
    p->mapping = recorder_plugin_identity(self->settings.plugins, mapping->type);
    if (!p->mapping)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record");
    p->hand_length_mm = of->hand_length_mm;
    p->rezero_pedal = of->rezero_pedal;
    p->track_count = cast->input_count;
    memcpy(p->track, cast->track, sizeof p->track);
    recorder_param_values(p, mapping);
    return of->patch ? patch_file_write(&p->patch, of->patch, err) : MRT_OK;
}

static mrt_result make_performance(const recorder *self, recorder_cast *cast,
                                   const recorder_settings *of, error *err)
{
    mrt_result result = describe_performance(self, cast, of, err);
    cast->texts = result < 0 ? NULL : take_performance_texts(&cast->performance);
    if (cast->texts)
        return MRT_OK;
    take_performance_finish(&cast->performance);
    return result < 0 ? result : error_set(err, MRT_ERR_MEMORY, "no memory to record");
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

/* Describes what all tracks of an input have in common. */
static mrt_result describe_track(const recorder *self, recorder_cast *cast, uint32_t i, error *err)
{
    take_track *track = &cast->described[i];
    track->input = strdup(cast->input_text[i]);
    track->device = strdup(input_name(cast->inputs[i]));
    track->plugin = recorder_plugin_identity(self->settings.plugins, input_plugin(cast->inputs[i]));
    bool good = track->input && track->device && track->plugin;
    for (int side = 0; side < 2; ++side)
        if (cast->calibration[side]) {
            track->calibration[side] = strdup(cast->calibration[side]);
            good &= track->calibration[side] != NULL;
        }
    cast->track_texts[i] = good ? take_track_texts(track) : NULL;
    if (cast->track_texts[i])
        return MRT_OK;
    take_track_finish(track);
    return error_set(err, MRT_ERR_MEMORY, "no memory to record");
}

static int32_t channel_of(const mrt_channel *channel, uint32_t count, uint32_t semantic)
{
    for (uint32_t i = 0; i < count; ++i)
        if (channel[i].semantic == semantic)
            return (int32_t)i;
    return -1;
}

/* [frame] Begins a track with these channels and the prepared description. */
static mrt_result add_track(recorder *self, recorder_cast *cast, uint32_t i, uint32_t version,
                            error *err)
{
    take_track track = cast->described[i];
    uint32_t count;
    const mrt_channel *channel = input_channels_of(cast->inputs[i], version, &count);
    describe_channels(&track, channel, count);
    cast->code[i] = channel_of(channel, count, MRT_CH_TIMECODE);
    cast->code_rate[i] = channel_of(channel, count, MRT_CH_TIMECODE + 1);
    mrt_result result = writer_follow_track(self->writer, &track, cast->track_texts[i], err);
    if (result < 0)
        return result;
    cast->track[i] = track.id;
    cast->version[i] = version;
    return MRT_OK;
}

/* ---- arriving samples ---- */

static void keep_arrival(void *data, uint32_t number, uint32_t version, const mrt_sample *sample)
{
    const recorder_arrivals *self = data;
    writer_arrived(self->writer, self->place, number, version, sample);
}

/* NULL: all entries are in use. */
static recorder_arrivals *find_arrivals(recorder *self, const input *of)
{
    for (uint32_t i = 0; i < ARRIVALS_MAX; ++i)
        if (self->arrivals[i].of == of)
            return &self->arrivals[i];
    return NULL;
}

static void hold_arrivals(recorder *self, recorder_cast *cast, uint32_t i)
{
    input *of = cast->inputs[i];
    if (self->settings.clock == CLOCK_VIRTUAL)
        return;
    recorder_arrivals *found = find_arrivals(self, of);
    if (!found && (found = find_arrivals(self, NULL))) {
        *found = (recorder_arrivals){of, self->writer, writer_arrivals_open(self->writer), 0};
        input_set_keeper(of, (input_keeper){keep_arrival, found});
    }
    if (found)
        found->user_count += 1;
    cast->arrivals[i] = found;
}

/* Detaches from the input when the last cast releases it. */
static void drop_arrivals(recorder_arrivals *self)
{
    if (!self || --self->user_count > 0)
        return;
    input_set_keeper(self->of, (input_keeper){0});
    writer_arrivals_close(self->writer, self->place);
    self->of = NULL;
}

/* ---- casts ---- */

static void destroy_cast(recorder_cast *cast)
{
    if (!cast)
        return;
    for (uint32_t i = 0; i < cast->input_count; ++i)
        drop_arrivals(cast->arrivals[i]);
    free(cast->calibration[MRT_LEFT]);
    free(cast->calibration[MRT_RIGHT]);
    for (uint32_t i = 0; i < RECORDER_INPUTS_MAX; ++i)
        take_texts_drop(cast->track_texts[i]);
    take_texts_drop(cast->texts);
    free(cast);
}

static bool is_same_text(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

/* Reuses the description of an existing track of the input; share_tracks sets the track later.
 * [main], while the frame thread may change the tracks of `now`. */
static bool keep_track(const recorder_cast *now, recorder_cast *cast, uint32_t i)
{
    bool is_calibrated_alike = is_same_text(now->calibration[0], cast->calibration[0]) &&
                               is_same_text(now->calibration[1], cast->calibration[1]);
    for (uint32_t j = 0; j < now->input_count && is_calibrated_alike; ++j)
        if (now->inputs[j] == cast->inputs[i]) {
            cast->described[i] = now->described[j];
            cast->track_texts[i] = take_texts_hold(now->track_texts[j]);
            return true;
        }
    return false;
}

mrt_result recorder_prepare(recorder *self, const recorder_settings *of, recorder_cast **out,
                            error *err)
{
    *out = NULL;
    if (of->input_count > RECORDER_INPUTS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%u inputs: at most %d can be recorded",
                         of->input_count, RECORDER_INPUTS_MAX);
    recorder_cast *cast = calloc(1, sizeof *cast);
    if (!cast)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record");
    cast->input_count = of->input_count;
    cast->layer = of->layer;
    cast->performer = of->performer;
    mrt_result result = MRT_OK;
    for (int side = 0; side < 2 && result >= 0; ++side) {
        if (!of->calibration[side])
            continue;
        cast->calibration[side] = strdup(of->calibration[side]);
        if (!cast->calibration[side])
            result = error_set(err, MRT_ERR_MEMORY, "no memory to record");
    }
    for (uint32_t i = 0; i < of->input_count && result >= 0; ++i) {
        cast->inputs[i] = of->inputs[i];
        cast->input_text[i] = of->input_text[i];
        hold_arrivals(self, cast, i);
        cast->is_kept[i] = self->cast && keep_track(self->cast, cast, i);
        if (cast->is_kept[i])
            continue;
        result = describe_track(self, cast, i, err);
        if (result >= 0)
            result = add_track(self, cast, i, input_newest_version(cast->inputs[i]), err);
    }
    if (result >= 0)
        result = make_performance(self, cast, of, err);
    if (result < 0) {
        recorder_dismiss(self, cast);
        return result;
    }
    *out = cast;
    return MRT_OK;
}

/* Copies the shared tracks to the new cast. The old cast has their current version. */
static void share_tracks(recorder_cast *old, recorder_cast *cast)
{
    for (uint32_t j = 0; j < old->input_count; ++j) {
        old->is_kept[j] = false;
        for (uint32_t i = 0; i < cast->input_count; ++i) {
            if (!cast->is_kept[i] || cast->inputs[i] != old->inputs[j])
                continue;
            old->is_kept[j] = true;
            cast->track[i] = cast->performance.track[i] = old->track[j];
            cast->version[i] = old->version[j];
            cast->code[i] = old->code[j];
            cast->code_rate[i] = old->code_rate[j];
        }
    }
    memset(cast->is_kept, 0, sizeof cast->is_kept);
}

void recorder_unwatch(recorder *self)
{
    if (self->watched)
        self->watched->on_param = NULL;
    self->watched = NULL;
}

recorder_cast *recorder_change(recorder *self, recorder_cast *cast)
{
    recorder_cast *old = self->cast;
    share_tracks(old, cast);
    recorder_unwatch(self);
    self->cast = cast;
    self->is_to_begin = true;
    return old;
}

void recorder_dismiss(recorder *self, recorder_cast *cast)
{
    error ignored = {""};
    for (uint32_t i = 0; cast && i < cast->input_count; ++i)
        if (!cast->is_kept[i] && cast->track[i] != 0 &&
            writer_end_track(self->writer, cast->track[i], &ignored) < 0)
            note_problem(self, &ignored);
    destroy_cast(cast);
}

/* Interval between stored states. It limits the time to perform the samples after a state again.
 * That takes some milliseconds for an anchored mapping, and some tens of milliseconds for an
 * unanchored one. */
static const int64_t anchored_span_ns = 5 * NS_PER_S;
static const int64_t unanchored_span_ns = 2 * NS_PER_S;
/* On a virtual clock, the recorder waits for the writer after this many samples. */
enum { SAMPLES_AHEAD = 256 };
/* Room for a state without its shapes. */
static const size_t state_bytes = (size_t)256 << 10;

static void on_param(void *data, int64_t time_ns, uint32_t param_id, double value)
{
    recorder *self = data;
    take_event event = {.time_ns = time_ns,
                        .kind = TAKE_EVENT_PARAM,
                        .param = param_id,
                        .track = self->cast->track[self->current],
                        .value = value};
    writer_event(self->writer, &event);
}

/* ---- start and stop ---- */

static size_t state_capacity(const recorder_settings *s)
{
    if (!s->performer)
        return s->state_bytes;
    const points *rest = face_rest(composer_face(s->performer->composer));
    size_t size = state_bytes + (size_t)rest->padded_count * 2 * 3 * sizeof(float);
    return size > s->state_bytes ? size : s->state_bytes;
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
        .checkpoint_bytes = self->state_capacity,
    };
    mrt_result result = writer_start(&self->writer, s->show, &options, err);
    return result < 0 ? result : recorder_prepare(self, s, &self->cast, err);
}

mrt_result recorder_start(recorder **out, const recorder_settings *settings, error *err)
{
    *out = NULL;
    recorder *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record");
    self->settings = *settings;
    self->checkpoint_ns = INT64_MIN;
    self->state_capacity = state_capacity(settings);
    mrt_result result = start(self, err);
    if (result < 0) {
        error ignored = {""};
        if (recorder_stop(self, &ignored) < 0)
            return result;
        return result;
    }
    *out = self;
    return MRT_OK;
}

mrt_result recorder_stop(recorder *self, error *err)
{
    mrt_result result = MRT_OK;
    if (!self)
        return MRT_OK;
    recorder_unwatch(self);
    if (self->is_take_open)
        result = recorder_take_end(self, err);
    if (self->writer && self->has_begun && result >= 0)
        result = writer_end_performance(self->writer, self->last_ns + 1, err);
    destroy_cast(self->cast); /* needs the writer */
    error later = {""};
    if (self->writer && writer_stop(self->writer, &later) < 0 && result >= 0)
        result = error_set(err, MRT_ERR_IO, "%s", later.text);
    free(self);
    return result;
}

/* ---- external time code ---- */

static const int64_t code_lasts_ns = NS_PER_S / 2;
static const double fps_least = 10.0, fps_most = 120.0;

recorder_code recorder_latest_code(const recorder *self)
{
    return self->code;
}

static double code_frame(const recorder_code *self, int64_t time_ns)
{
    return self->frame + 1e-9 * (double)(time_ns - self->time_ns) * self->fps;
}

double recorder_code_at(const recorder_code *self, int64_t time_ns)
{
    const bool runs =
        self->time_ns != 0 && time_ns >= self->since_ns && time_ns - self->time_ns < code_lasts_ns;
    return runs ? code_frame(self, time_ns) : -1.0;
}

/* Updates the time code from a sample, if its input has time code channels. */
static void follow_code(recorder *self, const step_sample *of)
{
    const int32_t at = self->cast->code[of->input], rate_at = self->cast->code_rate[of->input];
    if (at < 0 || rate_at < 0 || (uint32_t)at >= of->sample.count ||
        (uint32_t)rate_at >= of->sample.count)
        return;
    const double rate = (double)of->sample.value[rate_at], fps = fabs(rate);
    const recorder_code before = self->code;
    recorder_code now = {of->sample.time_ns, of->sample.time_ns, (double)of->sample.value[at], fps,
                         rate < 0.0};
    if (!(fps >= fps_least && fps <= fps_most) || now.frame < 0.0)
        return;
    const double expected = recorder_code_at(&before, now.time_ns);
    if (before.fps == fps && expected >= 0.0 && fabs(expected - now.frame) < 1.0)
        now.since_ns = before.since_ns;
    self->code = now;
}

/* Sets the slate's time code and returns the start of the take. If allowed, the start moves back to
 * the beginning of the time code frame at from_ns. */
static int64_t lay_on_code(const recorder *self, int64_t from_ns, bool may_be_earlier,
                           writer_slate *slate)
{
    const recorder_code *code = &self->code;
    const double at = recorder_code_at(code, from_ns);
    if (slate->over || at < 0.0)
        return from_ns;
    const double frame = floor(at + 1e-3);
    const int64_t edge_ns = code->time_ns + (int64_t)ceil((frame - code->frame) * 1e9 / code->fps);
    slate->fps = code->fps;
    slate->timecode_frame = (int64_t)frame;
    slate->is_drop_frame = code->is_drop;
    return may_be_earlier && edge_ns >= self->begun_ns && edge_ns < from_ns ? edge_ns : from_ns;
}

/* ---- takes ---- */

void recorder_take_next(recorder *self, const writer_slate *slate, int64_t from_ns)
{
    self->take_from_ns = from_ns;
    snprintf(self->scene, sizeof self->scene, "%s", slate->scene ? slate->scene : "");
    snprintf(self->shot, sizeof self->shot, "%s", slate->shot ? slate->shot : "");
    self->slate = (writer_slate){.scene = self->scene,
                                 .shot = self->shot,
                                 .number = slate->number,
                                 .over = slate->over,
                                 .over_at_ns = slate->over_at_ns};
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

mrt_result recorder_keep(recorder *self, int64_t from_ns, int64_t to_ns, const writer_slate *slate,
                         int64_t *out_take, error *err)
{
    if (!self->has_begun)
        return error_set(err, MRT_ERR_ARGUMENT, "no sample was performed yet");
    int64_t end_ns = to_ns <= self->last_ns ? to_ns : self->last_ns + 1;
    writer_slate laid = *slate;
    const int64_t start_ns = lay_on_code(self, from_ns, true, &laid);
    return writer_keep(self->writer, start_ns, end_ns, &laid, out_take, err);
}

int64_t recorder_performance(const recorder *self)
{
    return self->has_begun ? self->cast->performance.id : 0;
}

int64_t recorder_take(const recorder *self)
{
    return self->take;
}

bool recorder_take_is_open(const recorder *self)
{
    return self->is_take_open;
}

int64_t recorder_show_ns(const recorder *self, int64_t time_ns)
{
    return writer_show_ns(self->writer, time_ns);
}

const char *recorder_problem(const recorder *self)
{
    return atomic_load(&self->problem_state) == PROBLEM_STANDS ? self->problem.text : "";
}

writer *recorder_writer(recorder *self)
{
    return self->writer;
}

/* ---- steps ---- */

static void store_state(recorder *self, int64_t time_ns)
{
    recorder_cast *cast = self->cast;
    void *buffer = writer_checkpoint_buffer(self->writer);
    size_t capacity = self->state_capacity;
    if (!buffer)
        return; /* the disk is too slow: skip this state */
    int64_t offset_ns = writer_show_ns(self->writer, 0);
    size_t size =
        replay_write_state(cast->layer->mapping, cast->performer, offset_ns, buffer, capacity);
    bool fits = size > 0 && size <= capacity;
    writer_checkpoint(self->writer, cast->performance.id, time_ns, REPLAY_CHECKPOINT_VERSION,
                      buffer, fits ? size : 0);
    self->checkpoint_ns = time_ns;
}

static mrt_result begin_performance(recorder *self, int64_t time_ns, error *err)
{
    recorder_cast *cast = self->cast;
    bool goes_on = self->has_begun;
    recorder_param_values(&cast->performance, cast->layer->mapping);
    mrt_result result =
        writer_follow_performance(self->writer, &cast->performance, cast->texts, time_ns, err);
    self->is_to_begin = result < 0; /* after an error, try again with the next sample */
    if (result < 0)
        return result;
    self->has_begun = true;
    self->begun_ns = self->checkpoint_ns = time_ns;
    TRACE(TRACE_RECORD, "performance begins at %.6f s", 1e-9 * (double)time_ns);
    bool is_taught = taught_save(self->cast->layer->mapping, NULL, 0) > 0;
    if (is_taught ||
        (goes_on && self->cast->performer)) /* the performance may begin away from neutral */
        store_state(self, time_ns - 1);
    return MRT_OK;
}

/* Begins a new track and a new performance after a restarted plugin has changed its channels. */
static mrt_result follow_version(recorder *self, uint32_t i, int64_t time_ns, error *err)
{
    recorder_cast *cast = self->cast;
    uint32_t version = input_version(cast->inputs[i]);
    if (version == cast->version[i] && self->has_begun && !self->is_to_begin)
        return MRT_OK;
    mrt_result result = MRT_OK;
    if (version != cast->version[i]) {
        const int64_t before = cast->track[i];
        result = add_track(self, cast, i, version, err);
        if (result >= 0)
            result = writer_end_track(self->writer, before, err);
        memcpy(cast->performance.track, cast->track, sizeof cast->performance.track);
    }
    return result < 0 ? result : begin_performance(self, time_ns, err);
}

static mrt_result begin_take(recorder *self, int64_t time_ns, error *err)
{
    if (!self->is_take_wanted)
        return MRT_OK;
    self->is_take_wanted = false;
    const bool is_counted = self->take_from_ns && self->take_from_ns < time_ns;
    if (is_counted)
        time_ns = self->take_from_ns > self->begun_ns ? self->take_from_ns : self->begun_ns;
    time_ns = lay_on_code(self, time_ns, !is_counted, &self->slate);
    mrt_result result = writer_take_begin(self->writer, time_ns, &self->slate, &self->take, err);
    self->is_take_open = result >= 0;
    TRACE(TRACE_RECORD, "take %lld begins at %.6f s", (long long)self->take,
          1e-9 * (double)time_ns);
    return result;
}

static void write_rezeros(recorder *self, int64_t time_ns)
{
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        take_event event = {.time_ns = time_ns,
                            .kind = TAKE_EVENT_REZERO,
                            .hand = side,
                            .track = self->cast->track[self->current]};
        if (self->rezero & (1u << side))
            writer_event(self->writer, &event);
    }
    self->rezero = 0;
}

/* Samples that arrive now belong to the tracks of the step's samples. */
static void follow_arrivals(recorder *self)
{
    const recorder_cast *cast = self->cast;
    for (uint32_t i = 0; i < cast->input_count; ++i)
        if (cast->arrivals[i])
            writer_arrivals_follow(self->writer, cast->arrivals[i]->place, cast->track[i],
                                   cast->version[i]);
}

static void note_performed(recorder *self)
{
    const recorder_cast *cast = self->cast;
    for (uint32_t i = 0; i < cast->input_count; ++i)
        if (cast->arrivals[i])
            writer_arrivals_performed(self->writer, cast->arrivals[i]->place,
                                      input_popped_count(cast->inputs[i]));
}

void recorder_step(recorder *self, const sample_step *s)
{
    error err = {""};
    mrt_result result = MRT_OK;
    if (s->count == 0)
        return;
    self->current = s->of[0].input;
    self->watched = self->cast->layer;
    self->watched->on_param = on_param;
    self->watched->on_param_data = self;
    for (uint32_t i = 0; i < s->count && result >= 0; ++i) {
        result = follow_version(self, s->of[i].input, s->time_ns, &err);
        follow_code(self, &s->of[i]);
    }
    if (result >= 0)
        result = begin_take(self, s->time_ns, &err);
    if (result < 0)
        note_problem(self, &err);
    write_rezeros(self, s->time_ns);
    follow_arrivals(self);
    for (uint32_t i = 0; i < s->count; ++i)
        writer_sample(self->writer, self->cast->track[s->of[i].input], &s->of[i].sample);
    note_performed(self);
    self->last_ns = s->time_ns;
    self->ahead += s->count;
    if (self->settings.clock != CLOCK_VIRTUAL || self->ahead < SAMPLES_AHEAD)
        return;
    self->ahead = 0;
    if (writer_flush(self->writer, &err) < 0)
        note_problem(self, &err);
}

void recorder_performed(recorder *self, const sample_step *s)
{
    if (!self->cast->performer)
        return;
    int64_t span_ns = composer_is_anchored(self->cast->performer->composer) ? anchored_span_ns
                                                                            : unanchored_span_ns;
    if (self->has_begun && s->time_ns - self->checkpoint_ns >= span_ns)
        store_state(self, s->time_ns);
}

void recorder_rezero(recorder *self, uint32_t side)
{
    self->rezero |= 1u << side;
}

void recorder_change_mapping(recorder *self, const char *identity)
{
    recorder_cast *cast = self->cast;
    (void)snprintf(cast->rebuilt, sizeof cast->rebuilt, "%s", identity);
    cast->performance.mapping = cast->rebuilt;
    self->is_to_begin = true;
}

void recorder_incident(recorder *self, uint32_t from, const input_incident *what)
{
    take_event event = {.time_ns = what->time_ns,
                        .kind = what->kind == INPUT_WAS_LOST ? TAKE_EVENT_WENT : TAKE_EVENT_CAME,
                        .track = self->cast->track[from]};
    snprintf(event.text, sizeof event.text, "%.90s", what->text);
    writer_event(self->writer, &event);
}
