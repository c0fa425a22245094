#include "hand/guide.h"

#include "hand/guide_poses.h"
#include "hand/guide_solve.h"
#include "hand/sensor.h"
#include "hand/still.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double NS_PER_SECOND = 1e9;
static const int64_t AWAY_NS = 1000000000;

const char *const guide_wait_words[GUIDE_WAITS_FOR_NOTHING + 1] = {
    [GUIDE_WAITS_FOR_SAMPLES] = "waiting for the glove",
    [GUIDE_WAITS_FOR_MOVEMENT] = "move into the pose",
    [GUIDE_WAITS_FOR_STILLNESS] = "hold still",
    [GUIDE_WAITS_FOR_NOTHING] = "all poses are done",
};

struct guide {
    guide_settings settings;
    guide_poses poses;
    guide_step step;
    guide_step next; /* after this one */
    bool is_again;   /* its pose is taken already */
    still_window window;
    bool has_sample, has_step_start;
    int64_t step_start_ns, last_ns;
    bool has_left; /* the hand has left the pose below since the step began */
    bool has_held; /* a pose was taken or refused: the step waits until the hand leaves it */
    float held[MRT_ANGLES];
    float low[MRT_ANGLES], high[MRT_ANGLES];
    char reason[512];
};

guide_settings guide_settings_usual(uint32_t side, uint32_t sensors)
{
    return (guide_settings){.side = side,
                            .sensors = sensors,
                            .still_s = 0.7,
                            .lead_s = 1.0,
                            .still_counts = 1.5,
                            .moved_counts = 10.0};
}

guide *guide_create(const guide_settings *settings)
{
    guide *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->settings = *settings;
    self->poses.sensors = settings->sensors;
    self->next = GUIDE_RELAXED + 1;
    still_init(&self->window, (int64_t)(settings->still_s * NS_PER_SECOND), settings->sensors);
    return self;
}

void guide_destroy(guide *self)
{
    free(self);
}

/* ---- steps ---- */

static void begin_step(guide *self, guide_step step)
{
    self->step = step;
    self->next = step + 1;
    self->is_again = false;
    self->has_step_start = false;
    self->has_left = false;
}

/* The step waits until the hand is elsewhere. */
static void hold(guide *self, const float *raw)
{
    memcpy(self->held, raw, sizeof self->held);
    self->has_held = true;
    self->has_left = false;
}

static guide_news take(guide *self)
{
    guide_step step = self->step;
    still_median(&self->window, self->poses.raw[step]);
    hold(self, self->poses.raw[step]);
    bool refused = false;
    if (!guide_pose_check(&self->poses, step, self->reason, sizeof self->reason, &refused))
        self->reason[0] = '\0';
    if (refused)
        return GUIDE_REFUSED;
    self->poses.has[step] = true;
    begin_step(self, self->next);
    return GUIDE_TAKEN;
}

guide_news guide_next(guide *self)
{
    self->reason[0] = '\0';
    if (self->step == GUIDE_STEPS)
        return GUIDE_NOTHING;
    if (self->window.count > 0)
        return take(self);
    (void)snprintf(self->reason, sizeof self->reason, "the glove gives no samples");
    return GUIDE_REFUSED;
}

guide_news guide_skip(guide *self)
{
    self->reason[0] = '\0';
    if (self->step == GUIDE_STEPS)
        return GUIDE_NOTHING;
    if (self->step == GUIDE_FLAT && !self->is_again) {
        (void)snprintf(self->reason, sizeof self->reason,
                       "the flat hand cannot be skipped: all other poses are measured from it");
        return GUIDE_REFUSED;
    }
    if (!self->is_again)
        self->poses.has[self->step] = false;
    begin_step(self, self->next);
    return GUIDE_SKIPPED;
}

void guide_again(guide *self, guide_step step)
{
    float now[MRT_ANGLES];
    guide_step next = self->step;
    self->reason[0] = '\0';
    begin_step(self, step);
    self->next = next;
    self->is_again = true;
    if (self->window.count == 0)
        return;
    still_median(&self->window, now);
    hold(self, now);
}

void guide_repeat(guide *self)
{
    self->reason[0] = '\0';
    guide_step step = self->step > GUIDE_RELAXED ? self->step - 1 : GUIDE_RELAXED;
    self->poses.has[step] = false;
    begin_step(self, step);
}

/* ---- samples ---- */

static void widen_range(guide *self, const float *raw)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        self->low[i] = self->has_sample ? fminf(self->low[i], raw[i]) : raw[i];
        self->high[i] = self->has_sample ? fmaxf(self->high[i], raw[i]) : raw[i];
    }
}

static bool is_elsewhere(const guide *self, const float *raw)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (guide_poses_has_sensor(&self->poses, i) &&
            fabs((double)raw[i] - (double)self->held[i]) >= self->settings.moved_counts)
            return true;
    return false;
}

static double step_age_s(const guide *self)
{
    return (double)(self->last_ns - self->step_start_ns) / NS_PER_SECOND;
}

static void say_timeout(guide *self, const still_state *still)
{
    char what[160] = "the hand did not move into another pose";
    if (self->has_left || !self->has_held) {
        const char *label =
            still->worst_channel >= 0 ? sensor_table[still->worst_channel].label : "no sensor";
        (void)snprintf(what, sizeof what, "the hand was not still (%s, deviation %.1f counts)",
                       label, still->worst);
    }
    (void)snprintf(self->reason, sizeof self->reason, "%s: nothing was taken within %.0f s: %s",
                   guide_step_name[self->step], self->settings.timeout_s, what);
}

/* The step's clock starts with its first sample and stands still while the device is away. */
static void follow_time(guide *self, int64_t time_ns)
{
    bool goes_on = self->has_step_start && time_ns >= self->last_ns;
    uint64_t since_ns = goes_on ? (uint64_t)time_ns - (uint64_t)self->last_ns : 0;
    if (!goes_on)
        self->step_start_ns = time_ns;
    else if (since_ns > (uint64_t)AWAY_NS)
        self->step_start_ns = time_ns - (self->last_ns - self->step_start_ns);
    self->has_step_start = true;
    self->last_ns = time_ns;
}

static bool is_finite_pose(const guide *self, const float *raw, float *out)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        bool has = guide_poses_has_sensor(&self->poses, i);
        if (has && !isfinite(raw[i]))
            return false;
        out[i] = has ? raw[i] : 0.0f;
    }
    return true;
}

guide_news guide_sample(guide *self, const float *raw, int64_t time_ns)
{
    float pose[MRT_ANGLES];
    self->reason[0] = '\0';
    if (!is_finite_pose(self, raw, pose))
        return GUIDE_NOTHING;
    widen_range(self, pose);
    self->has_sample = true;
    follow_time(self, time_ns);
    still_add(&self->window, pose, time_ns);
    if (self->step == GUIDE_STEPS)
        return GUIDE_NOTHING;
    if (self->has_held && is_elsewhere(self, pose))
        self->has_left = true;
    still_state still = still_measure(&self->window);
    bool may_take =
        (self->has_left || !self->has_held) && step_age_s(self) >= self->settings.lead_s;
    if (may_take && still.is_full && still.worst <= self->settings.still_counts)
        return take(self);
    if (self->settings.timeout_s > 0 && step_age_s(self) > self->settings.timeout_s) {
        say_timeout(self, &still);
        self->has_step_start = false;
        return GUIDE_TIMED_OUT;
    }
    return GUIDE_NOTHING;
}

/* ---- what it is at ---- */

const guide_poses *guide_poses_of(const guide *self)
{
    return &self->poses;
}

guide_step guide_current(const guide *self)
{
    return self->step;
}

guide_wait guide_waiting(const guide *self)
{
    if (self->step == GUIDE_STEPS)
        return GUIDE_WAITS_FOR_NOTHING;
    if (self->window.count == 0)
        return GUIDE_WAITS_FOR_SAMPLES;
    return self->has_left || !self->has_held ? GUIDE_WAITS_FOR_STILLNESS : GUIDE_WAITS_FOR_MOVEMENT;
}

const char *guide_reason(const guide *self)
{
    return self->reason;
}

bool guide_has(const guide *self, guide_step step)
{
    return step < GUIDE_STEPS && self->poses.has[step];
}

void guide_range(const guide *self, float *out_low, float *out_high)
{
    memcpy(out_low, self->low, sizeof self->low);
    memcpy(out_high, self->high, sizeof self->high);
}

mrt_result guide_result(const guide *self, calibration_file *out, error *err)
{
    calibration_file_init(out, self->settings.side);
    if (!self->poses.has[GUIDE_FLAT])
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the flat hand was not taken: nothing can be calibrated without it");
    guide_solve(&self->poses, self->settings.side, self->low, self->high, out);
    return MRT_OK;
}
