#include "window/timeline/worker.h"

#include "base/clock.h"
#include "base/condition.h"
#include "base/slot.h"
#include "stage/playback/kept_solver.h"
#include "show/edit_store.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { WORKER_CURVES_MAX = 32, WORKER_SAMPLES = 512, WORKER_FRAMES = 1 << 18, WORKER_PATH = 4096 };

typedef struct worker_curve { /* curve of a part of a performance */
    int64_t performance, from_ns;
    take_part part;
    activity *curve; /* NULL: cannot be performed */
    bool is_done;
    uint64_t used; /* time of the last request */
} worker_curve;

typedef struct worker_reader { /* [thread] */
    const plugin_list *plugins;
    log_queue *log; /* discards messages, which were already reported during the recording */
    char show_path[WORKER_PATH], face_path[WORKER_PATH]; /* opened paths; "": none */
    show *show;
    face_file face;
    bool has_face, is_face_open; /* is_face_open: opening was tried */
    performer *scratch;
    replay_world world;
    worker_curve curve[WORKER_CURVES_MAX];
    uint32_t curve_count;
    uint64_t uses;
    waveform *wave;
    int64_t wave_of;
    show_audio about;
    int64_t comps_of;
    uint64_t comps_edition, spans_edition;
    uint32_t span_count;
    timeline_span span[TIMELINE_SPANS_MAX];
    char note[256];
} worker_reader;

typedef struct order {                                   /* order from [main] */
    char show_path[WORKER_PATH], face_path[WORKER_PATH]; /* "": none */
    timeline_request request;
    uint64_t number; /* increases with each change */
    bool ends;
} order;

struct timeline_worker {
    pthread_mutex_t lock; /* held for copies and swaps only */
    pthread_cond_t wake;
    pthread_t thread;
    bool has_thread; /* [main] */
    order wanted;    /* written by [main] under the lock */
    order taken;     /* [thread] */
    publish_slot slot;
    timeline_result result[3];   /* triple buffer to [main] */
    timeline_comps *comps_ready; /* to [main]; under the lock */
    bool has_comps;
    timeline_comps *comps; /* [main] */
    worker_reader reader;  /* [thread] */
};

/* ---- reader ---- */

static void note(worker_reader *self, const error *err)
{
    (void)snprintf(self->note, sizeof self->note, "%.255s", err->text);
}

/* Opens the face only when a curve is needed, because binding takes 0.1 s. */
static void open_face(worker_reader *self)
{
    error err = {""};
    if (self->is_face_open)
        return;
    self->is_face_open = true;
    if (!self->face_path[0] ||
        face_file_read(&self->face, self->face_path, NULL, FACE_FILE_USABLE, &err) < 0) {
        note(self, &err);
        return;
    }
    self->has_face = true;
    const performer_settings as = {.solver = kept_solver_for(self->show, &self->face, NULL)};
    if (performer_create(&self->scratch, &self->face, NULL, &as, &err) < 0)
        note(self, &err);
    self->world.scratch = self->scratch;
}

/* Opens the show. Notes errors. */
static void worker_reader_open(worker_reader *self, const order *now)
{
    error err = {""};
    memcpy(self->show_path, now->show_path, sizeof self->show_path);
    memcpy(self->face_path, now->face_path, sizeof self->face_path);
    if (!self->show_path[0])
        return;
    if (show_open(&self->show, self->show_path, SHOW_READ, &err) < 0) {
        self->show = NULL;
        note(self, &err);
        return;
    }
    self->world = (replay_world){.show = self->show, .plugins = self->plugins, .log = self->log};
}

static void drop_news(worker_reader *self)
{
    log_record record;
    while (log_pop(self->log, &record))
        continue;
}

static void worker_reader_close(worker_reader *self)
{
    for (uint32_t i = 0; i < self->curve_count; ++i)
        activity_destroy(self->curve[i].curve);
    waveform_destroy(self->wave);
    performer_destroy(self->scratch);
    if (self->has_face)
        face_file_destroy(&self->face);
    show_close(self->show);
    *self = (worker_reader){.plugins = self->plugins, .log = self->log};
}

/* ---- curves ---- */

static worker_curve *slot_for_curve(worker_reader *self)
{
    if (self->curve_count < WORKER_CURVES_MAX)
        return &self->curve[self->curve_count++];
    worker_curve *oldest = self->curve;
    for (uint32_t i = 1; i < self->curve_count; ++i)
        if (self->curve[i].used < oldest->used)
            oldest = &self->curve[i];
    activity_destroy(oldest->curve);
    return oldest;
}

static void begin_curve(worker_reader *self, worker_curve *out, const timeline_strip *of)
{
    error err = {""};
    show_performance about;
    *out = (worker_curve){.performance = of->performance, .part = of->part, .is_done = true};
    if (show_performance_read(self->show, of->performance, &about, &err) < 0) {
        note(self, &err);
        return;
    }
    out->from_ns = about.from_ns;
    show_performance_finish(&about);
    open_face(self);
    if (!self->scratch)
        return;
    if (activity_create(&out->curve, &self->world, of->performance, of->part, &err) < 0) {
        out->curve = NULL;
        note(self, &err);
    }
    out->is_done = out->curve == NULL;
}

static worker_curve *curve_of(worker_reader *self, const timeline_strip *of)
{
    worker_curve *curve = NULL;
    for (uint32_t i = 0; i < self->curve_count && !curve; ++i)
        if (self->curve[i].performance == of->performance && self->curve[i].part == of->part)
            curve = &self->curve[i];
    if (!curve) {
        curve = slot_for_curve(self);
        begin_curve(self, curve, of);
    }
    curve->used = ++self->uses;
    return curve;
}

static bool step_curve(worker_reader *self, worker_curve *curve)
{
    error err = {""};
    if (!curve->curve)
        return false;
    mrt_result result = activity_step(curve->curve, WORKER_SAMPLES, &err);
    drop_news(self);
    if (result < 0)
        note(self, &err);
    curve->is_done = result != MRT_OK;
    return !curve->is_done;
}

/* Continues the first unfinished curve. Then marks all curves as unfinished, because their
 * recordings can grow. */
static bool step_curves(worker_reader *self, const timeline_request *request)
{
    for (uint32_t i = 0; i < request->strip_count; ++i) {
        worker_curve *curve = curve_of(self, &request->strip[i]);
        if (!curve->is_done && step_curve(self, curve))
            return true;
    }
    for (uint32_t i = 0; i < self->curve_count; ++i)
        self->curve[i].is_done = self->curve[i].curve == NULL;
    return false;
}

/* ---- the sound ---- */

static void begin_wave(worker_reader *self, int64_t audio)
{
    error err = {""};
    waveform_destroy(self->wave);
    self->wave = NULL;
    self->wave_of = audio;
    self->about = (show_audio){0};
    if (!audio)
        return;
    if (show_audio_info(self->show, audio, &self->about, &err) < 0 ||
        waveform_create(&self->wave, self->show, audio, &err) < 0) {
        self->wave = NULL;
        note(self, &err);
    }
}

static bool step_wave(worker_reader *self)
{
    error err = {""};
    if (!self->wave)
        return false;
    mrt_result result = waveform_step(self->wave, self->show, WORKER_FRAMES, &err);
    if (result < 0)
        note(self, &err);
    return result != MRT_END;
}

/* Returns a number that changes when more data is known. */
static int64_t worker_reader_known(const worker_reader *self)
{
    int64_t known = self->wave ? waveform_known_frames(self->wave) : 0;
    for (uint32_t i = 0; i < self->curve_count; ++i)
        known += self->curve[i].curve ? activity_known_ns(self->curve[i].curve) : 0;
    return known + self->curve_count;
}

/* ---- times of takes ---- */

static void read_spans(worker_reader *self, uint64_t edition)
{
    error err = {""};
    show_take *takes;
    size_t count;
    self->spans_edition = edition;
    if (show_takes(self->show, &takes, &count, &err) < 0) {
        note(self, &err);
        return;
    }
    self->span_count = 0;
    for (size_t i = count; i-- > 0 && self->span_count < TIMELINE_SPANS_MAX;)
        self->span[self->span_count++] =
            (timeline_span){takes[i].id, takes[i].start_ns, takes[i].end_ns};
    free(takes);
}

/* Computes a part of the request. Returns false if nothing is left to do. */
static bool worker_reader_step(worker_reader *self, const timeline_request *request)
{
    if (!self->show)
        return false;
    if (request->audio != self->wave_of)
        begin_wave(self, request->audio);
    if (request->spans_edition && request->spans_edition != self->spans_edition)
        read_spans(self, request->spans_edition);
    bool has_more = step_wave(self);
    return step_curves(self, request) || has_more;
}

/* ---- results ---- */

static void read_strip(const worker_curve *curve, const timeline_strip *strip, activity_bin *out,
                       activity_bin *scratch)
{
    bool is_first = true;
    for (uint32_t lane = 0; lane < ACTIVITY_LANES; ++lane) {
        if (!(strip->lanes & 1u << lane))
            continue;
        activity_bin *into = is_first ? out : scratch;
        activity_read(curve->curve, lane, strip->from_ns - curve->from_ns,
                      strip->to_ns - curve->from_ns, strip->bin_count, into);
        for (uint32_t i = 0; !is_first && i < strip->bin_count; ++i) {
            out[i].least = scratch[i].least > out[i].least ? scratch[i].least : out[i].least;
            out[i].greatest =
                scratch[i].greatest > out[i].greatest ? scratch[i].greatest : out[i].greatest;
        }
        is_first = false;
    }
}

static void fill_strips(worker_reader *self, const timeline_request *request, timeline_result *out)
{
    activity_bin *scratch = calloc(request->bin_count + (size_t)1, sizeof *scratch);
    out->strip_count = request->strip_count;
    memcpy(out->strip, request->strip, request->strip_count * sizeof *request->strip);
    for (uint32_t i = 0; i < request->bin_count; ++i)
        out->bin[i] = (activity_bin){1.0f, 0.0f};
    for (uint32_t i = 0; scratch && self->show && i < request->strip_count; ++i) {
        const timeline_strip *strip = &request->strip[i];
        const worker_curve *curve = curve_of(self, strip);
        if (curve->curve)
            read_strip(curve, strip, out->bin + strip->first_bin, scratch);
    }
    free(scratch);
}

static void fill_wave(worker_reader *self, const timeline_request *request, timeline_result *out)
{
    error err = {""};
    out->audio = self->wave_of;
    out->about = self->about;
    out->has_wave = self->wave && request->audio == self->wave_of && request->audio_pairs > 0 &&
                    request->audio_from < request->audio_to &&
                    waveform_read(self->wave, self->show, request->audio_from, request->audio_to,
                                  request->audio_pairs, &out->wave, &err) >= 0;
    if (err.text[0])
        note(self, &err);
}

static void worker_reader_fill(worker_reader *self, const timeline_request *request,
                               timeline_result *out)
{
    fill_strips(self, request, out);
    fill_wave(self, request, out);
    out->span_count = self->span_count;
    memcpy(out->span, self->span, self->span_count * sizeof *self->span);
    memcpy(out->note, self->note, sizeof out->note);
}

/* ---- other takes ---- */

static bool is_of_slate(const take *t, const timeline_request *request)
{
    return !t->is_deleted && !t->is_recording && t->layer_count > 0 &&
           strcmp(t->scene, request->scene) == 0 && strcmp(t->shot, request->shot) == 0;
}

static void look_at(worker_reader *self, const show_take *of, const timeline_request *request,
                    timeline_comps *out)
{
    error err = {""};
    take *t = &out->take[out->count];
    bool may_be = of->edit_count > 0 || of->base_edit_count > 0 ||
                  (strcmp(of->scene, request->scene) == 0 && strcmp(of->shot, request->shot) == 0);
    if (of->id == request->comps_of || !may_be || of->is_recording)
        return;
    if (edit_store_take_of(t, self->show, of, &err) < 0 && t->id == 0)
        return;
    if (is_of_slate(t, request))
        out->count += 1;
    else
        take_finish(t);
}

/* Reads the other takes if the request needs them again. The caller frees the result with
 * timeline_comps_free. */
static timeline_comps *worker_reader_comps(worker_reader *self, const timeline_request *request)
{
    error err = {""};
    show_take *takes;
    size_t count;
    if (!self->show ||
        (request->comps_of == self->comps_of && request->comps_edition == self->comps_edition))
        return NULL;
    self->comps_of = request->comps_of;
    self->comps_edition = request->comps_edition;
    timeline_comps *out = calloc(1, sizeof *out);
    if (!out || !request->comps_of || show_takes(self->show, &takes, &count, &err) < 0)
        return out;
    out->of = request->comps_of;
    for (size_t i = count; i-- > 0 && out->count < TIMELINE_COMPS_MAX;)
        look_at(self, &takes[i], request, out);
    free(takes);
    return out;
}

#define PUBLISH_NS (80 * NS_PER_MS)  /* publish interval during computation */
#define AGAIN_NS   (400 * NS_PER_MS) /* poll interval for growing recordings */
enum { NICENESS = 10 };

/* ---- requests ---- */

void timeline_request_clear(timeline_request *request)
{
    memset(request, 0, sizeof *request);
}

bool timeline_request_add(timeline_request *request, const timeline_strip *strip)
{
    if (request->strip_count >= TIMELINE_STRIPS_MAX || strip->bin_count == 0 ||
        strip->bin_count > TIMELINE_BINS_MAX - request->bin_count)
        return false;
    request->strip[request->strip_count] = *strip;
    request->strip[request->strip_count++].first_bin = request->bin_count;
    request->bin_count += strip->bin_count;
    return true;
}

const timeline_strip *timeline_result_strip(const timeline_result *result, uint32_t owner,
                                            uint32_t clip)
{
    for (uint32_t i = 0; i < result->strip_count; ++i)
        if (result->strip[i].clip == clip && result->strip[i].owner == owner)
            return &result->strip[i];
    return NULL;
}

/* Accepts NULL. */
static void timeline_comps_free(timeline_comps *comps)
{
    for (uint32_t i = 0; comps && i < comps->count; ++i)
        take_finish(&comps->take[i]);
    free(comps);
}

/* ---- the thread ---- */

/* Reads the newest request. While idle, waits for a request or until a recording may have grown.
 * Returns true if there is a new request. */
static bool take_order(timeline_worker *self, bool is_idle)
{
    pthread_mutex_lock(&self->lock);
    if (is_idle && self->wanted.number == self->taken.number)
        (void)condition_wait(&self->wake, &self->lock, clock_now_ns() + AGAIN_NS);
    const bool is_new = self->wanted.number != self->taken.number;
    if (is_new)
        self->taken = self->wanted;
    pthread_mutex_unlock(&self->lock);
    return is_new;
}

static void publish(timeline_worker *self, bool is_complete)
{
    timeline_result *result = &self->result[slot_back(&self->slot)];
    worker_reader_fill(&self->reader, &self->taken.request, result);
    result->is_complete = is_complete;
    result->number = self->taken.number;
    slot_publish(&self->slot);
}

static void publish_comps(timeline_worker *self, timeline_comps *comps)
{
    if (!comps)
        return;
    pthread_mutex_lock(&self->lock);
    timeline_comps *old = self->comps_ready;
    self->comps_ready = comps;
    self->has_comps = true;
    pthread_mutex_unlock(&self->lock);
    timeline_comps_free(old);
}

static void change_show(worker_reader *self, const order *now)
{
    if (strcmp(self->show_path, now->show_path) == 0 &&
        strcmp(self->face_path, now->face_path) == 0)
        return;
    worker_reader_close(self);
    worker_reader_open(self, now);
}

static void *run(void *data)
{
    timeline_worker *self = data;
    const timeline_request *request = &self->taken.request;
    bool is_idle = false, was_idle = false;
    int64_t published_ns = 0, known_then = -1;
    (void)setpriority(PRIO_PROCESS, 0,
                      NICENESS); /* on Linux this applies to the calling thread only */
    for (;;) {
        const bool is_new = take_order(self, is_idle);
        if (self->taken.ends)
            break;
        change_show(&self->reader, &self->taken);
        publish_comps(self, worker_reader_comps(&self->reader, request));
        is_idle = !worker_reader_step(&self->reader, request);
        int64_t now_ns = clock_now_ns(), known = worker_reader_known(&self->reader);
        bool is_due = is_idle || now_ns - published_ns > PUBLISH_NS;
        if (is_new || (is_due && (known != known_then || is_idle != was_idle))) {
            publish(self, is_idle);
            published_ns = now_ns;
            known_then = known;
            was_idle = is_idle;
        }
    }
    worker_reader_close(&self->reader);
    return NULL;
}

/* ---- [main] ---- */

timeline_worker *timeline_worker_create(const plugin_list *plugins)
{
    timeline_worker *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->reader.log = log_queue_create();
    self->reader.plugins = plugins;
    slot_init(&self->slot);
    (void)pthread_mutex_init(&self->lock, NULL);
    condition_init(&self->wake);
    if (self->reader.log)
        return self;
    timeline_worker_destroy(self);
    return NULL;
}

/* Wakes the thread after a change of `wanted` under the lock. */
static void end_order(timeline_worker *self)
{
    self->wanted.number += 1;
    (void)pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->lock);
}

void timeline_worker_destroy(timeline_worker *self)
{
    if (!self)
        return;
    pthread_mutex_lock(&self->lock);
    self->wanted.ends = true;
    end_order(self);
    if (self->has_thread)
        (void)pthread_join(self->thread, NULL);
    (void)pthread_cond_destroy(&self->wake);
    (void)pthread_mutex_destroy(&self->lock);
    timeline_comps_free(self->comps);
    timeline_comps_free(self->comps_ready);
    if (self->reader.log)
        log_queue_destroy(self->reader.log);
    free(self);
}

void timeline_worker_set_show(timeline_worker *self, const char *show_path, const char *face_path)
{
    order *wanted = &self->wanted;
    show_path = show_path ? show_path : "";
    face_path = face_path ? face_path : "";
    if (strcmp(wanted->show_path, show_path) == 0 && strcmp(wanted->face_path, face_path) == 0)
        return;
    pthread_mutex_lock(&self->lock);
    (void)snprintf(wanted->show_path, sizeof wanted->show_path, "%s", show_path);
    (void)snprintf(wanted->face_path, sizeof wanted->face_path, "%s", face_path);
    end_order(self);
}

static bool is_same_strips(const timeline_request *a, const timeline_request *b)
{
    return a->strip_count == b->strip_count &&
           memcmp(a->strip, b->strip, a->strip_count * sizeof *a->strip) == 0;
}

static bool is_same_request(const timeline_request *a, const timeline_request *b)
{
    return is_same_strips(a, b) && a->audio == b->audio && a->audio_from == b->audio_from &&
           a->audio_to == b->audio_to && a->audio_pairs == b->audio_pairs &&
           a->comps_of == b->comps_of && a->comps_edition == b->comps_edition &&
           a->spans_edition == b->spans_edition && strcmp(a->scene, b->scene) == 0 &&
           strcmp(a->shot, b->shot) == 0;
}

void timeline_worker_request(timeline_worker *self, const timeline_request *request)
{
    if (is_same_request(request, &self->wanted.request))
        return;
    pthread_mutex_lock(&self->lock);
    self->wanted.request = *request;
    end_order(self);
    if (!self->has_thread)
        self->has_thread = pthread_create(&self->thread, NULL, run, self) == 0;
}

const timeline_result *timeline_worker_result(timeline_worker *self)
{
    (void)slot_receive(&self->slot);
    return &self->result[slot_front(&self->slot)];
}

bool timeline_worker_is_busy(const timeline_worker *self)
{
    const timeline_result *result = &self->result[slot_front(&self->slot)];
    return self->has_thread && (!result->is_complete || result->number != self->wanted.number);
}

const timeline_comps *timeline_worker_comps(timeline_worker *self)
{
    timeline_comps *old = NULL;
    pthread_mutex_lock(&self->lock);
    if (self->has_comps) {
        old = self->comps;
        self->comps = self->comps_ready;
        self->comps_ready = NULL;
        self->has_comps = false;
    }
    pthread_mutex_unlock(&self->lock);
    timeline_comps_free(old);
    return self->comps;
}
