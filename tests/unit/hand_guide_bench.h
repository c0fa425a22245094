/* hand_guide_bench.h - a glove on a hand that goes through the poses of the guided calibration, for
 * the tests of hand/guide.h. After cmocka.h. */
#ifndef MAROTTE_TEST_HAND_GUIDE_BENCH_H
#define MAROTTE_TEST_HAND_GUIDE_BENCH_H
#include "hand/guide.h"
#include "hand/sensor.h"

#include "unit/hand_guide_poses.h"

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

/* ---- through the poses ---- */

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
