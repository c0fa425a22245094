/* plugins/one_hand at work: the plugin as loaded from the build, a face made of its names, and
 * hands that a test bends. Included by the tests of that plugin after cmocka.h. */
#ifndef MAROTTE_TESTS_UNIT_ONE_HAND_BENCH_H
#define MAROTTE_TESTS_UNIT_ONE_HAND_BENCH_H
#include "hand/hand.h"
#include "stage/mapping/instance.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))
#define RAD(deg)        ((deg)*0.017453292519943295f)

/* In an order of its own: the plugin goes by names. A head of an adult: 1 mm is 1 mm. */
static const mrt_contact bench_contacts[] = {
    {"chin", "jaw", {0, -60, 95}, {0, 0, 1}},
    {"lip.lower.mid", "jaw", {0, -38, 102}, {0, 0, 1}},
    {"lip.upper.mid", "skull", {0, -30, 104}, {0, 0, 1}},
    {"nose.tip", "skull", {0, 0, 115}, {0, 0, 1}},
    {"forehead.mid", "skull", {0, 70, 95}, {0, 0, 1}},
    {"mouth.corner.l", "skull", {26, -34, 88}, {0, 0, 1}},
    {"mouth.corner.r", "skull", {-26, -34, 88}, {0, 0, 1}},
    {"brow.inner.l", "skull", {14, 45, 96}, {0, 0, 1}},
    {"brow.inner.r", "skull", {-14, 45, 96}, {0, 0, 1}},
    {"brow.mid.l", "skull", {33, 50, 90}, {0, 0, 1}},
    {"brow.mid.r", "skull", {-33, 50, 90}, {0, 0, 1}},
    {"brow.outer.l", "skull", {50, 46, 76}, {0, 0, 1}},
    {"brow.outer.r", "skull", {-50, 46, 76}, {0, 0, 1}},
    {"cheek.l", "skull", {42, 5, 80}, {0, 0, 1}},
    {"cheek.r", "skull", {-42, 5, 80}, {0, 0, 1}},
    {"cheek.lower.l", "skull", {45, -30, 70}, {0, 0, 1}},
    {"cheek.lower.r", "skull", {-45, -30, 70}, {0, 0, 1}},
    {"nasolabial.l", "skull", {30, -12, 90}, {0, 0, 1}},
    {"nasolabial.r", "skull", {-30, -12, 90}, {0, 0, 1}},
    {"nose.wing.l", "skull", {16, -5, 98}, {0, 0, 1}},
    {"nose.wing.r", "skull", {-16, -5, 98}, {0, 0, 1}},
    {"lip.upper.side.l", "skull", {13, -31, 100}, {0, 0, 1}},
    {"lip.upper.side.r", "skull", {-13, -31, 100}, {0, 0, 1}},
    {"lip.lower.side.l", "jaw", {13, -37, 99}, {0, 0, 1}},
    {"lip.lower.side.r", "jaw", {-13, -37, 99}, {0, 0, 1}},
    {"jaw.angle.l", "jaw", {55, -45, 30}, {1, 0, 0}},
    {"jaw.angle.r", "jaw", {-55, -45, 30}, {-1, 0, 0}},
    {"ear.lobe.l", "skull", {75, 0, 0}, {1, 0, 0}}, /* nothing of one hand's */
};
static const mrt_dof bench_dofs[] = {
    {"tongue.curl", "rad", -1, 1},
    {"skull.nod", "rad", -0.6f, 0.6f},
    {"skull.turn", "rad", -0.9f, 0.9f},
    {"jaw.open", "rad", 0, 0.6f},
    {"jaw.lateral", "mm", -10, 10},
    {"jaw.forward", "mm", 0, 8},
    {"eye.l.yaw", "rad", -0.6f, 0.6f},
    {"eye.l.pitch", "rad", -0.5f, 0.5f},
    {"eye.r.yaw", "rad", -0.6f, 0.6f},
    {"eye.r.pitch", "rad", -0.5f, 0.5f},
    {"lid_upper.l.close", "rad", -0.2f, 0.8f},
    {"lid_lower.l.close", "rad", 0, 0.3f},
    {"lid_upper.r.close", "rad", -0.2f, 0.8f},
    {"lid_lower.r.close", "rad", 0, 0.3f},
};
enum { BENCH_CONTACTS = COUNT_OF(bench_contacts), BENCH_DOFS = COUNT_OF(bench_dofs) };
enum { BENCH_PERFORMED = BENCH_CONTACTS - 1 };
static const mrt_face bench_face = {bench_contacts, bench_dofs,       BENCH_CONTACTS,
                                    BENCH_DOFS,     {-80, -110, -90}, {80, 130, 115}};

/* The relaxed talk pose, rad, in sensor order. */
static const float bench_talk[MRT_ANGLES] = {
    1.45f, 0.15f, 0.20f, 0.34f,  0.62f, 0.52f, 0.25f, 0.68f,  0.60f, 0.3f,   -0.04f,
    0.72f, 0.64f, 0.3f,  -0.05f, 0.70f, 0.60f, 0.3f,  -0.04f, 0.12f, -0.08f, 0.0f};

enum { /* sensor order */
       ROLL = 0,
       THUMB_MPJ,
       THUMB_IJ,
       THUMB_ABD,
       INDEX_MPJ,
       INDEX_PIJ,
       MIDDLE_MPJ = 7,
       MIDDLE_PIJ,
       MIDDLE_ABD = 10,
       RING_MPJ,
       RING_PIJ,
       RING_ABD = 14,
       LITTLE_MPJ,
       LITTLE_PIJ,
       LITTLE_ABD = 18,
       ARCH,
       PITCH,
       YAW
};

typedef struct bench {
    plugin_list plugins;
    instance plugin;
    log_queue *log;
    const mrt_mapping *functions;
    const mrt_state *state;
    const mrt_face *face;
    mrt_frame frame;
    mrt_pull pull;
    hand_skeleton *skeleton[2];
    double dt_s; /* of the next steps */
} bench;

static inline void bench_create(bench *b, const char *params)
{
    error err = {""};
    const mrt_plugin_type *type;
    *b = (bench){.dt_s = 0.01, .face = &bench_face};
    b->log = log_queue_create();
    assert_int_equal(plugin_list_add(&b->plugins, BUILD_DIR "/plugins/one_hand.so", &err), MRT_OK);
    assert_int_equal(plugin_list_find(&b->plugins, "one_hand", MRT_MAPPING, &type, &err), MRT_OK);
    assert_int_equal(instance_create(&b->plugin, type, CLOCK_VIRTUAL, b->log, &err), MRT_OK);
    if (instance_set_list(&b->plugin, "mode=classic", &err) < 0 ||
        instance_set_list(&b->plugin, params, &err) < 0)
        fail_msg("%s", err.text);
    b->functions = plugin_interface(type, MRT_MAPPING);
    b->state = plugin_interface(type, MRT_STATE);
    for (uint32_t side = 0; side < 2; ++side)
        b->skeleton[side] = hand_skeleton_create(side, 190);
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        b->pull.dof[i] = NAN;
}

static inline void bench_set_up_on(bench *b, const mrt_face *about, const char *params)
{
    bench_create(b, params);
    b->face = about;
    assert_int_equal(b->functions->activate(b->plugin.self, about), MRT_OK);
    b->functions->reset(b->plugin.self);
}

/* Neutral is the first sample. */
static inline void bench_set_up(bench *b, const char *params)
{
    char all[512];
    snprintf(all, sizeof all, "samples=1%s%s", params[0] ? "," : "", params);
    bench_set_up_on(b, &bench_face, all);
}

static inline void bench_tear_down(bench *b)
{
    b->functions->deactivate(b->plugin.self);
    instance_destroy(&b->plugin);
    plugin_list_destroy(&b->plugins);
    log_queue_destroy(b->log);
    for (int side = 0; side < 2; ++side)
        hand_skeleton_destroy(b->skeleton[side]);
}

static inline void bench_set(bench *b, const char *list)
{
    error err = {""};
    if (instance_set_list(&b->plugin, list, &err) < 0)
        fail_msg("%s", err.text);
}

static inline void bench_trigger(bench *b, const char *name)
{
    for (uint32_t i = 0; i < b->plugin.type->param_count; ++i)
        if (strcmp(b->plugin.type->params[i].name, name) == 0) {
            instance_trigger(&b->plugin, i);
            return;
        }
    fail_msg("no trigger %s", name);
}

/* A frame with whatever hands it holds. */
static inline mrt_result bench_frame(bench *b)
{
    b->frame.dt_s = b->frame.time_ns ? b->dt_s : 0.0;
    b->frame.time_ns += (int64_t)(b->dt_s * 1e9);
    instance_latch(&b->plugin);
    b->frame.params = b->plugin.params;
    return b->functions->process(b->plugin.self, &b->frame, &b->pull);
}

static inline void bench_pose(bench *b, uint32_t side, const float *angle_rad)
{
    mrt_hand *hand = &b->frame.hand[side];
    rigid wrist = rigid_identity();
    memcpy(hand->angle, angle_rad, sizeof hand->angle);
    hand_pose(b->skeleton[side], hand->angle, &wrist, hand->joint, hand->palm);
    hand->present = true;
    hand->time_ns = b->frame.time_ns;
}

static inline void bench_step(bench *b, uint32_t side, const float *angle_rad)
{
    bench_pose(b, side, angle_rad);
    assert_int_equal(bench_frame(b), MRT_OK);
}

/* A change of some sensors, deg. */
typedef struct bend {
    int sensor;
    float deg;
} bend;
typedef struct bends {
    bend bend[6];
} bends;

static inline void bench_bent(float *out, const bends *by, float times)
{
    memcpy(out, bench_talk, sizeof bench_talk);
    for (size_t i = 0; i < COUNT_OF(by->bend); ++i)
        out[by->bend[i].sensor] += RAD(by->bend[i].deg) * times;
}

/* `steps` frames with the talk pose, bent. */
static inline void bench_bend(bench *b, uint32_t side, bends by, int steps)
{
    float angle[MRT_ANGLES];
    bench_bent(angle, &by, 1.0f);
    for (int i = 0; i < steps; ++i)
        bench_step(b, side, angle);
}

static inline void bench_talk_for(bench *b, uint32_t side, int steps)
{
    bench_bend(b, side, (bends){{{0, 0}}}, steps);
}

/* ---- what came of it ---- */

static inline mrt_vec3 bench_pulled(const bench *b, const char *contact)
{
    for (uint32_t i = 0; i < b->pull.count; ++i) {
        const mrt_vector *v = &b->pull.vector[i];
        assert_in_range(v->contact, 1, b->face->contact_count);
        if (strcmp(b->face->contacts[v->contact - 1].name, contact) == 0)
            return (mrt_vec3){v->end.x - v->start.x, v->end.y - v->start.y, v->end.z - v->start.z};
    }
    fail_msg("%s is not pulled", contact);
    return (mrt_vec3){NAN, NAN, NAN};
}

static inline float bench_dof(const bench *b, const char *name)
{
    for (uint32_t i = 0; i < b->face->dof_count; ++i)
        if (strcmp(b->face->dofs[i].name, name) == 0)
            return b->pull.dof[i];
    fail_msg("no %s", name);
    return NAN;
}

static inline float bench_length(mrt_vec3 v)
{
    return sqrtf(v.x * v.x + v.y * v.y + v.z * v.z);
}

/* The longest way of a contact between two pulls, mm. */
static inline float bench_jump(const mrt_pull *a, const mrt_pull *b)
{
    float most = 0;
    for (uint32_t i = 0; i < b->count; ++i) {
        mrt_vec3 p = a->vector[i].end, q = b->vector[i].end;
        most = fmaxf(most, bench_length((mrt_vec3){q.x - p.x, q.y - p.y, q.z - p.z}));
    }
    return most;
}

/* The greatest change of a degree of freedom; which are driven must not change. */
static inline float bench_dof_jump(const mrt_pull *a, const mrt_pull *b)
{
    float most = 0;
    for (int i = 0; i < MRT_MAX_DOFS; ++i) {
        assert_true(isnan(a->dof[i]) == isnan(b->dof[i]));
        if (!isnan(a->dof[i]))
            most = fmaxf(most, fabsf(a->dof[i] - b->dof[i]));
    }
    return most;
}

/* Bit for bit: ends at starts, driven degrees of freedom 0. */
static inline bool bench_is_rest(const bench *b)
{
    for (uint32_t i = 0; i < b->pull.count; ++i)
        if (memcmp(&b->pull.vector[i].start, &b->pull.vector[i].end, sizeof(mrt_vec3)) != 0)
            return false;
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        if (b->pull.dof[i] > 0.0f || b->pull.dof[i] < 0.0f)
            return false;
    return b->pull.count == BENCH_PERFORMED && b->pull.mode == MRT_ANCHORED;
}

/* ---- at work ---- */

/* From one pose to another in `steps` frames; returns the greatest step of a contact, mm. */
static inline float bench_sweep(bench *b, bends from, bends to, int steps)
{
    float most = 0, start[MRT_ANGLES], end[MRT_ANGLES], angle[MRT_ANGLES];
    bench_bent(start, &from, 1);
    bench_bent(end, &to, 1);
    for (int i = 1; i <= steps; ++i) {
        mrt_pull before = b->pull;
        for (int k = 0; k < MRT_ANGLES; ++k)
            angle[k] = start[k] + (end[k] - start[k]) * (float)i / (float)steps;
        bench_step(b, MRT_RIGHT, angle);
        most = fmaxf(most, bench_jump(&before, &b->pull));
    }
    return most;
}

static const bends bench_nothing = {{{0, 0}}};

static const bends bench_talking = {{{THUMB_MPJ, -20}, {RING_MPJ, -15}, {LITTLE_MPJ, -15}}};

/* Mouth open and smiling. */
static inline void bench_set_up_talking(bench *b, const char *params)
{
    bench_set_up(b, params);
    bench_talk_for(b, MRT_RIGHT, 3);
    (void)bench_sweep(b, bench_nothing, bench_talking, 50);
    assert_true(bench_dof(b, "jaw.open") > 0.15f);
}

#endif
