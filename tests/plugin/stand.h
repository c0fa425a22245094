/* What the tests of isolation and of reloading share: a mapping on a face, and a hand whose every
 * sample is known from its number and moves without a jump. */
#ifndef MAROTTE_TESTS_PLUGIN_STAND_H
#define MAROTTE_TESTS_PLUGIN_STAND_H
#include "stage/mapping/isolate.h"
#include "unit/resume_scene.h"

static const int64_t stand_period_ns = 11111111; /* 90 a second */

typedef struct stand {
    plugin_list plugins;
    log_queue *log;
    face_file face;
    isolate *isolate; /* NULL: in this process */
    instance mapping;
    performer *performer;
    channel_route route;
} stand;

static inline const mrt_plugin_type *stand_load(stand *s, const char *path)
{
    error err = {""};
    const mrt_plugin_type *type = NULL;
    scene_must(plugin_list_choose(&s->plugins, path, MRT_MAPPING, &type, &err), &err);
    return type;
}

/* settings NULL: in this process. */
static inline void stand_up_on(stand *out, const char *face_name, const char *library,
                               const char *params, const isolate_settings *settings)
{
    error err = {""};
    mrt_channel channel[MRT_MAX_CHANNELS];
    *out = (stand){.log = log_queue_create()};
    scene_face(&out->face, face_name);
    const mrt_plugin_type *type = stand_load(out, library);
    if (settings) {
        scene_must(isolate_create_mapping(&out->isolate, type, library, settings, &err), &err);
        type = isolate_type(out->isolate);
    }
    scene_must(instance_create(&out->mapping, type, CLOCK_REAL, out->log, &err), &err);
    scene_must(instance_set_list(&out->mapping, params, &err), &err);
    const performer_settings as = {.hand_length_mm = 190};
    scene_must(performer_create(&out->performer, &out->face, &out->mapping, &as, &err), &err);
    channel_route_init(&out->route, channel, scene_channels(channel, 0));
}

static inline void stand_up(stand *out, const char *library, const char *params,
                            const isolate_settings *settings)
{
    stand_up_on(out, "plane", library, params, settings);
}

static inline void stand_lie_down(stand *s)
{
    performer_destroy(s->performer);
    instance_destroy(&s->mapping);
    isolate_destroy(s->isolate);
    plugin_list_destroy(&s->plugins);
    face_file_destroy(&s->face);
    log_queue_destroy(s->log);
}

static inline mrt_sample stand_sample(uint32_t n)
{
    mrt_sample out = {.sequence = n, .count = MRT_ANGLES, .time_ns = (int64_t)n * stand_period_ns};
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        out.value[i] = scene_talk[i] + 0.3f * scene_wave(n + 5 * i, 120 + 2 * i);
    return out;
}

static inline void stand_step(stand *s, uint32_t n)
{
    mrt_sample sample = stand_sample(n);
    const sample_step next = sample_step_of(&s->route, &sample);
    frame_run(s->performer, &next);
}

static inline void stand_set(stand *s, const char *list)
{
    error err = {""};
    scene_must(instance_set_list(s->performer->voice[0].layer->mapping, list, &err), &err);
}

static inline isolate_counts stand_counts(stand *s)
{
    return isolate_counted(s->mapping.self);
}

/* Of a busy machine. */
static const int64_t stand_patience_ns = 60 * NS_PER_S;

/* Until so many processes have failed and been replaced. */
static inline void stand_wait_for(stand *s, uint32_t restarted)
{
    int64_t end_ns = clock_now_ns() + stand_patience_ns;
    while (stand_counts(s).restarted < restarted && clock_now_ns() < end_ns)
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    assert_int_equal(stand_counts(s).restarted, restarted);
}

/* Whether something that contains `text` has been logged. */
static inline bool stand_has_heard(stand *s, const char *text)
{
    log_record line;
    while (log_pop(s->log, &line))
        if (strstr(line.text, text))
            return true;
    return false;
}

/* The same, and waits for it. */
static inline bool stand_hears(stand *s, const char *text)
{
    int64_t end_ns = clock_now_ns() + stand_patience_ns;
    bool is_there;
    while (!(is_there = stand_has_heard(s, text)) && clock_now_ns() < end_ns)
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    return is_there;
}

/* ---- how far the face goes in a sample ---- */

typedef struct stand_shape {
    float *at; /* 3 streams */
    uint32_t count;
} stand_shape;

static inline void stand_copy(stand_shape *out, stand *s)
{
    composer_draw(s->performer->composer);
    const points *p = face_shown(composer_face(s->performer->composer));
    if (!out->at)
        out->at = malloc((size_t)p->count * 3 * sizeof *out->at);
    assert_non_null(out->at);
    out->count = p->count;
    memcpy(out->at, p->x, p->count * sizeof *p->x);
    memcpy(out->at + p->count, p->y, p->count * sizeof *p->y);
    memcpy(out->at + 2 * (size_t)p->count, p->z, p->count * sizeof *p->z);
}

static inline double stand_distance(const stand_shape *a, const stand_shape *b)
{
    double most = 0;
    size_t n = a->count;
    for (size_t i = 0; i < n; ++i) {
        double x = (double)a->at[i] - (double)b->at[i],
               y = (double)a->at[n + i] - (double)b->at[n + i],
               z = (double)a->at[2 * n + i] - (double)b->at[2 * n + i];
        most = fmax(most, sqrt(x * x + y * y + z * z));
    }
    return most;
}

/* Two mappings see the same hand, the other one in this process, without trouble. In a sample the
 * face may go twice as far as that one ever does by the hand's own motion, and by the share of a
 * fade of the most that the two have differed while a fade may have gone on. */
enum { STAND_FADE = 25 }; /* samples of a fade, and two */
typedef struct stand_watch {
    stand_shape face, before, ought, ought_before;
    double furthest_step_mm; /* of the other */
    double worst_excess_mm;  /* beyond what is allowed; <= 0: no jump */
    double differed_mm[STAND_FADE];
    uint32_t count;
} stand_watch;

/* What the hand alone makes of the face, in samples 0 to count. */
static inline double stand_furthest_step(const char *library, const char *params, uint32_t count)
{
    stand s;
    stand_shape now = {0}, before = {0};
    double most = 0;
    stand_up(&s, library, params, NULL);
    for (uint32_t n = 0; n < count; ++n) {
        stand_step(&s, n);
        stand_copy(&now, &s);
        if (n > 0)
            most = fmax(most, stand_distance(&now, &before));
        stand_shape kept = before;
        before = now;
        now = kept;
    }
    free(now.at);
    free(before.at);
    stand_lie_down(&s);
    return most;
}

static inline void stand_watch_begin(stand_watch *w, double furthest_step_mm)
{
    w->furthest_step_mm = furthest_step_mm;
    w->worst_excess_mm = -furthest_step_mm;
    memset(w->differed_mm, 0, sizeof w->differed_mm);
    w->count = 0;
}

static inline void stand_watch_step(stand_watch *w, stand *s, stand *other)
{
    stand_copy(&w->face, s);
    stand_copy(&w->ought, other);
    w->differed_mm[w->count % STAND_FADE] = stand_distance(&w->face, &w->ought);
    if (w->count++ > 0) {
        double share = (double)stand_period_ns * 1e-9 / LAYER_FADE_S, differ = 0;
        for (int i = 0; i < STAND_FADE; ++i)
            differ = fmax(differ, w->differed_mm[i]);
        double own = stand_distance(&w->ought, &w->ought_before);
        double may = 2 * fmax(w->furthest_step_mm, own) + share * differ;
        w->worst_excess_mm = fmax(w->worst_excess_mm, stand_distance(&w->face, &w->before) - may);
    }
    stand_shape kept = w->before, kept_ought = w->ought_before;
    w->before = w->face;
    w->ought_before = w->ought;
    w->face = kept;
    w->ought = kept_ought;
}

static inline void stand_watch_finish(stand_watch *w)
{
    free(w->face.at);
    free(w->before.at);
    free(w->ought.at);
    free(w->ought_before.at);
}

#endif
