/* What the tests of states that are kept share: faces, mappings as loaded from the build, hands
 * whose every sample is known from its number, and what is done to them meanwhile. */
#ifndef MAROTTE_TESTS_RESUME_SCENE_H
#define MAROTTE_TESTS_RESUME_SCENE_H
#include "base/clock.h"
#include "frame_run.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCENE_GRID = 24, SCENE_INPUTS = 2, SCENE_ACTS = 12 };

static inline void scene_must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* ---- faces ---- */

/* 150 mm wide, 200 mm high, a little round. */
static inline void scene_plane(face_file *file)
{
    error err = {""};
    mesh *out = &file->mesh;
    *file = (face_file){0};
    scene_must(
        mesh_create(out, SCENE_GRID * SCENE_GRID, 2 * (SCENE_GRID - 1) * (SCENE_GRID - 1), &err),
        &err);
    for (uint32_t i = 0; i < SCENE_GRID * SCENE_GRID; ++i) {
        float x = (float)(i % SCENE_GRID) * 6.5f - 75.0f, y = (float)(i / SCENE_GRID) * 8.7f;
        out->position[3 * i] = x;
        out->position[3 * i + 1] = y;
        out->position[3 * i + 2] = 60.0f - 0.004f * x * x;
    }
    uint32_t *t = out->triangle;
    for (uint32_t y = 0; y + 1 < SCENE_GRID; ++y)
        for (uint32_t x = 0; x + 1 < SCENE_GRID; ++x, t += 6) {
            uint32_t a = y * SCENE_GRID + x, b = a + 1, c = a + SCENE_GRID, d = c + 1;
            const uint32_t quad[6] = {a, b, d, a, d, c};
            memcpy(t, quad, sizeof quad);
        }
}

static inline void scene_rig(face_file *file, const char *name)
{
    error err = {""};
    char path[512];
    *file = (face_file){0};
    snprintf(path, sizeof path, "%s/rigs/%s/%s.rig.json", SOURCE_DIR, name, name);
    scene_must(face_file_read(file, path, NULL, FACE_FILE_USABLE, &err), &err);
}

/* "plane", "moai" or "puppet" */
static inline void scene_face(face_file *file, const char *name)
{
    if (strcmp(name, "plane") == 0)
        scene_plane(file);
    else
        scene_rig(file, name);
}

/* Of the bits of the shape shown. */
static inline uint64_t scene_hash(const face *f)
{
    const points *p = face_shown(f);
    const float *const stream[3] = {p->x, p->y, p->z};
    uint64_t hash = 14695981039346656037u;
    for (int axis = 0; axis < 3; ++axis)
        for (uint32_t i = 0; i < p->count; ++i) {
            uint32_t bits;
            memcpy(&bits, &stream[axis][i], sizeof bits);
            hash = (hash ^ bits) * 1099511628211u;
        }
    return hash;
}

/* How far the shapes are from each other at most, mm. */
static inline double scene_distance(const points *a, const points *b)
{
    double most = 0;
    assert_int_equal(a->count, b->count);
    for (uint32_t i = 0; i < a->count; ++i) {
        double x = (double)a->x[i] - (double)b->x[i], y = (double)a->y[i] - (double)b->y[i],
               z = (double)a->z[i] - (double)b->z[i];
        most = fmax(most, sqrt(x * x + y * y + z * z));
    }
    return most;
}

/* ---- hands: a right one, and a left one with its wrist and four pedals ---- */

static const float scene_talk[MRT_ANGLES] = {
    1.45f, 0.15f, 0.20f, 0.34f,  0.62f, 0.52f, 0.25f, 0.68f,  0.60f, 0.3f,   -0.04f,
    0.72f, 0.64f, 0.3f,  -0.05f, 0.70f, 0.60f, 0.3f,  -0.04f, 0.12f, -0.08f, 0.0f};

static inline uint32_t scene_channels(mrt_channel *out, uint32_t from)
{
    uint32_t side = from == 0 ? MRT_RIGHT : MRT_LEFT, count = 0;
    for (uint32_t i = 0; i < (from == 0 ? MRT_ANGLES : 21u); ++i)
        out[count++] = (mrt_channel){"angle", "rad", MRT_CH_ANGLE + i, side, -3, 3};
    for (uint32_t i = 0; i < 7 && from == 1; ++i)
        out[count++] = (mrt_channel){"wrist", "1", MRT_CH_WRIST + i, side, -500, 500};
    for (uint32_t i = 0; i < MRT_MAX_PEDALS && from == 1; ++i)
        out[count++] = (mrt_channel){"pedal", "1", MRT_CH_PEDAL + i, MRT_NO_HAND, 0, 1};
    return count;
}

/* 0 to 1 and back. */
static inline float scene_wave(uint32_t n, uint32_t period)
{
    uint32_t at = n % period, half = period / 2;
    return (float)(at < half ? at : period - at) / (float)half;
}

static inline float scene_angle(uint32_t n, uint32_t sensor, float phase)
{
    uint32_t moved = n < 90 ? n : n < 190 ? 90 : n - 100; /* from 90 to 190 it holds still */
    uint32_t at = moved + sensor * 5 + (uint32_t)phase;
    return scene_talk[sensor] + 0.5f * (scene_wave(at, 34 + 2 * sensor) - 0.4f);
}

/* Sample n of the performance; of which input: *out_from. After sample 200 the right hand is away
 * for 0.6 s, which is a gap; pedals go down and up one after the other. */
static inline mrt_sample scene_sample(uint32_t n, uint32_t *out_from)
{
    mrt_sample out = {.sequence = n};
    uint32_t from = n % 3 == 2 && n > 40 ? 1 : 0, k = 0;
    out.time_ns = (int64_t)n * 7 * NS_PER_MS + (n > 200 ? 600 * NS_PER_MS : 0) + n % 5;
    for (uint32_t i = 0; i < (from == 0 ? MRT_ANGLES : 21u); ++i)
        out.value[k++] = scene_angle(n, i, from == 0 ? 0.0f : 11.0f);
    const float wrist[7] = {4.0f * scene_wave(n, 60), 2, 3.0f * scene_wave(n, 40), 0.1f, 0, 0, 1};
    for (uint32_t i = 0; i < 7 && from == 1; ++i)
        out.value[k++] = wrist[i];
    for (uint32_t i = 0; i < MRT_MAX_PEDALS && from == 1; ++i)
        out.value[k++] = n / 12 % (MRT_MAX_PEDALS + 2) == i ? 1.0f : 0.0f;
    out.count = k;
    *out_from = from;
    return out;
}

/* ---- a mapping on a face ---- */

/* What is done before a sample: a button, "key=value,...", a re-zero of a hand (1 + side). */
typedef struct scene_act {
    uint32_t at;
    const char *press, *set;
    uint32_t rezero;
} scene_act;

typedef struct scene_play {
    const char *mapping, *face, *params;
    uint32_t rezero_pedal;
    scene_act act[SCENE_ACTS]; /* at 0: none */
} scene_play;

typedef struct scene_stand {
    plugin_list plugins;
    log_queue *log;
    instance mapping;
    performer *performer;
    channel_route route[SCENE_INPUTS];
} scene_stand;

static inline const mrt_plugin_type *scene_type(plugin_list *list, const char *mapping)
{
    char path[1024];
    error err = {""};
    const mrt_plugin_type *type;
    snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, mapping);
    scene_must(plugin_list_add(list, path, &err), &err);
    scene_must(plugin_list_find(list, mapping, MRT_MAPPING, &type, &err), &err);
    return type;
}

static inline void scene_stand_up(scene_stand *out, const scene_play *play, const face_file *file)
{
    error err = {""};
    *out = (scene_stand){.log = log_queue_create()};
    const mrt_plugin_type *type = scene_type(&out->plugins, play->mapping);
    scene_must(instance_create(&out->mapping, type, CLOCK_VIRTUAL, out->log, &err), &err);
    scene_must(instance_set_list(&out->mapping, play->params, &err), &err);
    performer_settings settings = {.rezero_pedal = play->rezero_pedal};
    scene_must(performer_create(&out->performer, file, &out->mapping, &settings, &err), &err);
    for (uint32_t i = 0; i < SCENE_INPUTS; ++i) {
        mrt_channel channel[MRT_MAX_CHANNELS];
        uint32_t count = scene_channels(channel, i);
        channel_route_init(&out->route[i], channel, count);
    }
}

static inline void scene_lay_down(scene_stand *s)
{
    performer_destroy(s->performer);
    instance_destroy(&s->mapping);
    plugin_list_destroy(&s->plugins);
    log_queue_destroy(s->log);
}

static inline void scene_press(instance *mapping, const char *name)
{
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        if (strcmp(mapping->type->params[i].name, name) == 0) {
            instance_trigger(mapping, i);
            return;
        }
    fail_msg("%s has no %s", mapping->type->id, name);
}

/* Returns whether a re-zero was asked for and granted: of which hands, a bit each. */
static inline uint32_t scene_act_on(performer *p, const scene_play *play, uint32_t n)
{
    error err = {""};
    uint32_t granted = 0;
    layer *of = p->voice[0].layer;
    instance *mapping = of->mapping;
    for (int i = 0; i < SCENE_ACTS; ++i) {
        const scene_act *act = &play->act[i];
        if (act->at == 0 || act->at != n)
            continue;
        if (act->press)
            scene_press(mapping, act->press);
        if (act->set)
            scene_must(instance_set_list(mapping, act->set, &err), &err);
        if (act->rezero &&
            hands_rezero(of->hands, act->rezero - 1, of->frame.time_ns, &err) == MRT_OK)
            granted |= 1u << (act->rezero - 1);
    }
    return granted;
}

static inline void scene_step(scene_stand *s, const scene_play *play, uint32_t n)
{
    uint32_t from;
    mrt_sample sample = scene_sample(n, &from);
    (void)scene_act_on(s->performer, play, n);
    const sample_step next = sample_step_of(&s->route[from], &sample);
    frame_run(s->performer, &next);
}

#endif
