/* hand_guide_bench.h - a glove on a hand that goes through the poses of the guided calibration, for
 * the tests of hand/guide.h and hand/guide_judge.h. After cmocka.h. */
#ifndef MAROTTE_TEST_HAND_GUIDE_BENCH_H
#define MAROTTE_TEST_HAND_GUIDE_BENCH_H
#include "hand/guide.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a glove: raw = zero + counts * degrees ---- */

enum { ALL_22 = (1 << MRT_ANGLES) - 1 };
static const uint32_t ALL_18 = (uint32_t)ALL_22 & ~(1u << 6 | 1u << 9 | 1u << 13 | 1u << 17);
static const int64_t PERIOD_NS = 6666667; /* 150 Hz */

typedef struct glove {
    guide *guide;
    int64_t time_ns;
    uint32_t noise;
    double zero[MRT_ANGLES], counts[MRT_ANGLES];
    double pose[MRT_ANGLES]; /* degrees, where the hand is now */
    guide_news news;         /* the last that was not GUIDE_NOTHING */
    guide_step step;         /* in which it came */
    char reason[512];
} glove;

static inline glove put_on(const guide_settings *settings)
{
    glove out = {.guide = guide_create(settings), .noise = 1, .time_ns = 5000000000};
    assert_non_null(out.guide);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        bool is_spread = sensor_table[i].kind == SENSOR_SPREAD;
        out.zero[i] = is_spread ? 190 - i : 60 + i;
        out.counts[i] = is_spread ? -1.9 + 0.02 * i : 1.0 + 0.02 * i;
    }
    return out;
}

static inline void sample(glove *g)
{
    float raw[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i) {
        g->noise = g->noise * 1664525u + 1013904223u;
        double jitter = (double)(g->noise >> 24) / 256.0 - 0.5; /* within half a count */
        raw[i] = (float)floor(g->zero[i] + g->counts[i] * g->pose[i] + 0.5 + jitter);
    }
    guide_step step = guide_current(g->guide);
    guide_news news = guide_sample(g->guide, raw, g->time_ns);
    g->time_ns += PERIOD_NS;
    if (news == GUIDE_NOTHING)
        return;
    g->news = news;
    g->step = step;
    memcpy(g->reason, guide_reason(g->guide), strlen(guide_reason(g->guide)) + 1);
}

/* Half a second of moving there, then a hold. */
static inline void go(glove *g, const double *pose, double hold_s)
{
    double from[MRT_ANGLES];
    memcpy(from, g->pose, sizeof from);
    g->news = GUIDE_NOTHING;
    for (int k = 1; k <= 75; ++k) {
        for (int i = 0; i < MRT_ANGLES; ++i)
            g->pose[i] = from[i] + (pose[i] - from[i]) * k / 75.0;
        sample(g);
    }
    for (int k = 0; k < (int)(hold_s * 150.0); ++k)
        sample(g);
}

/* ---- the poses, degrees ---- */

static inline void set_finger(double *pose, int finger, double knuckle, double middle, double end)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (sensor_table[i].finger != finger)
            continue;
        if (sensor_table[i].kind == SENSOR_KNUCKLE)
            pose[i] = knuckle;
        if (sensor_table[i].kind == SENSOR_MIDDLE_JOINT)
            pose[i] = middle;
        if (sensor_table[i].kind == SENSOR_END_JOINT)
            pose[i] = end;
    }
}

/* What a person does in the step; the middle finger drags the ring finger's knuckle by half. */
static inline void pose_of(double *pose, guide_step step)
{
    memset(pose, 0, MRT_ANGLES * sizeof *pose);
    if (step == GUIDE_RELAXED) {
        for (int finger = 1; finger < 5; ++finger)
            set_finger(pose, finger, 30, 25, 10);
        pose[SENSOR_THUMB_ROLL] = 40;
        pose[SENSOR_ARCH] = 8;
    } else if (step == GUIDE_FIST) {
        for (int finger = 1; finger < 5; ++finger)
            set_finger(pose, finger, 90, 100, 80);
    } else if (step == GUIDE_THUMB_ACROSS) {
        set_finger(pose, 0, 50, 0, 80);
        pose[SENSOR_THUMB_ROLL] = 80;
    } else if (step == GUIDE_SPREAD) {
        pose[SENSOR_THUMB_ABDUCTION] = 53;
        pose[SENSOR_MIDDLE_INDEX_SPREAD] = 17;
        pose[SENSOR_RING_MIDDLE_SPREAD] = 14;
        pose[SENSOR_LITTLE_RING_SPREAD] = 32;
    } else if (step >= GUIDE_THUMB_ALONE) {
        set_finger(pose, (int)step - GUIDE_THUMB_ALONE, 80, 90, 60);
        if (step == GUIDE_MIDDLE_ALONE)
            pose[SENSOR_RING_MPJ] = 40;
    }
}

static inline void perform(glove *g, guide_step step)
{
    double pose[MRT_ANGLES];
    pose_of(pose, step);
    go(g, pose, 1.5);
}

static inline void perform_until(glove *g, guide_step end)
{
    while (guide_current(g->guide) < end) {
        guide_step step = guide_current(g->guide);
        perform(g, step);
        assert_int_equal(g->news, GUIDE_TAKEN);
        assert_int_equal(g->step, step);
    }
}

#endif
