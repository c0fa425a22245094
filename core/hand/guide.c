#include "hand/guide.h"

#include "base/angle.h"
#include "hand/sensor.h"
#include "hand/still.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct guide_poses {
    uint32_t sensors; /* bit i: the glove has sensor i */
    bool is_bare;     /* raw is rad */
    bool has[GUIDE_STEPS];
    float raw[GUIDE_STEPS][MRT_ANGLES];
} guide_poses;

/* ---- the poses, in angles ---- */

static const double RADIANS_PER_DEGREE = ANGLE_PI / 180.0;

const char *const guide_step_name[GUIDE_STEPS] = {
    "relaxed hand", "flat hand",   "fist",         "thumb across", "fingers spread",
    "thumb alone",  "index alone", "middle alone", "ring alone",   "little alone"};

static const char *const glove_words[GUIDE_STEPS] = {
    "Hold your hand relaxed, as you will when the face is at rest.",
    "Lay your hand flat on the table: wrist, fingers and thumb straight and together.",
    "Make a tight fist, the thumb outside.",
    "Open the hand; lay the bent thumb across the palm, its tip at the root of the little finger.",
    "Lay your hand flat again and spread fingers and thumb as wide as you can.",
    "Fingers straight and together; bend only the thumb.",
    "Bend only the index finger, all the way; thumb and other fingers straight.",
    "Bend only the middle finger, all the way; thumb and other fingers straight.",
    "Bend only the ring finger, all the way; thumb and other fingers straight.",
    "Bend only the little finger, all the way; thumb and other fingers straight."};

static const char *const bare_words[GUIDE_STEPS] = {
    [GUIDE_FLAT] = "Hold your hand up flat: fingers and thumb straight and together.",
    [GUIDE_FIST] = "Make a tight fist, the thumb outside.",
    [GUIDE_SPREAD] = "Open the hand and spread fingers and thumb as wide as you can."};

static bool has_sensor(const guide_poses *poses, int sensor)
{
    return (poses->sensors >> sensor & 1u) != 0;
}

/* Returns the step that defines the end of the sensor's range; the other end is the flat hand.
 * GUIDE_STEPS: none. */
static guide_step pose_end(int sensor)
{
    const sensor_facts *facts = &sensor_table[sensor];
    if (facts->kind == SENSOR_PALM || facts->kind == SENSOR_WRIST)
        return GUIDE_STEPS;
    if (facts->kind == SENSOR_SPREAD)
        return GUIDE_SPREAD;
    return facts->finger == 0 ? GUIDE_THUMB_ACROSS : GUIDE_FIST;
}

/* A pose moves each joint to the end of its clinical range (sensor.c, hardware.md 2.3). Fist:
 * knuckles 90, middle joints 100, end joints 80 degrees. Thumb across the palm: base 80, knuckle
 * 50, end joint 80. Widest spread: 17, 14, 32, and 53 for the thumb. */
static double pose_end_rad(int sensor)
{
    return (double)sensor_table[sensor].high_deg * RADIANS_PER_DEGREE;
}

/* Returns the only finger that is bent in the step, 0 thumb .. 4 little; -1: none. */
static int pose_finger(guide_step step)
{
    return step >= GUIDE_THUMB_ALONE && step < GUIDE_STEPS ? (int)step - (int)GUIDE_THUMB_ALONE
                                                           : -1;
}

/* A bent finger moves its neighbours and the spreads beside it, so these are not measured. The
 * thumb and the index finger do not affect each other. */
static bool is_dragged(int finger, int bent)
{
    if (finger == bent)
        return true;
    return finger > 0 && bent > 0 && abs(finger - bent) == 1;
}

/* Returns whether this sensor must be 0 in the pose, as in the flat hand. */
static bool pose_is_zero(guide_step step, int sensor)
{
    const sensor_facts *facts = &sensor_table[sensor];
    if (step == GUIDE_FLAT)
        return true;
    if (facts->kind == SENSOR_PALM || facts->kind == SENSOR_WRIST)
        return false;
    if (step == GUIDE_SPREAD)
        return facts->kind != SENSOR_SPREAD && facts->finger > 0;
    int bent = pose_finger(step);
    if (bent < 0)
        return false;
    if (facts->finger == 0)
        return bent > 0 && facts->kind != SENSOR_ROLL;
    if (facts->kind == SENSOR_SPREAD)
        return !is_dragged(facts->finger, bent) && !is_dragged(facts->finger - 1, bent);
    return !is_dragged(facts->finger, bent);
}

/* In a fist, the thumb is outside, over the fingers. */
static const double fist_thumb_deg[3] = {62.0, 35.0, 45.0};
static const double dragged_share = 0.18; /* share of its range that a finger is dragged */

static double pose_rad(guide_step step, int sensor)
{
    const sensor_facts *facts = &sensor_table[sensor];
    const bool is_spread = facts->kind == SENSOR_SPREAD;
    const int bent = pose_finger(step);
    if (step == GUIDE_RELAXED)
        return (double)facts->neutral_rad;
    if (facts->kind == SENSOR_PALM || facts->kind == SENSOR_WRIST)
        return 0.0;
    if (step == GUIDE_SPREAD)
        return is_spread ? pose_end_rad(sensor) : 0.0;
    if (is_spread)
        return 0.0;
    if (step == GUIDE_FIST)
        return facts->finger == 0 ? fist_thumb_deg[sensor] * RADIANS_PER_DEGREE
                                  : pose_end_rad(sensor);
    if (step == GUIDE_THUMB_ACROSS)
        return facts->finger == 0 ? pose_end_rad(sensor) : 0.0;
    if (bent < 0 || !is_dragged(facts->finger, bent))
        return 0.0;
    return facts->kind == SENSOR_ROLL ? 0.0
           : facts->finger == bent    ? pose_end_rad(sensor)
                                      : dragged_share * pose_end_rad(sensor);
}

void guide_pose(guide_step step, float *out_rad)
{
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
        out_rad[sensor] = step < GUIDE_STEPS ? (float)pose_rad(step, sensor) : 0.0f;
}

/* Returns the least change of a working sensor. It uses twice the greatest gains of hardware.md 2.1
 * (0.027 rad a count of flexion, 0.010 of abduction): a sensor with a smaller change over the whole
 * range of its joint is not working. For a bare hand, the joint was not seen if its change is less
 * than a third of the true angle. */
static double least_raw(const guide_poses *poses, int sensor)
{
    if (poses->is_bare)
        return pose_end_rad(sensor) / 3.0;
    double most = sensor_table[sensor].kind == SENSOR_SPREAD ? 0.025 : 0.055;
    return pose_end_rad(sensor) / most;
}

/* Counts of a glove may go either way, angles only up. */
static double moved_raw(const guide_poses *poses, int sensor, guide_step from, guide_step to)
{
    double moved = (double)poses->raw[to][sensor] - (double)poses->raw[from][sensor];
    return poses->is_bare ? moved : fabs(moved);
}

/* Returns whether the sensor changed enough between two poses to reach its end angle, with any
 * glove. */
static bool pose_has_moved(const guide_poses *poses, int sensor, guide_step from, guide_step to)
{
    return moved_raw(poses, sensor, from, to) >= least_raw(poses, sensor);
}

static const char *not_moved(const guide_poses *poses, guide_step step, char *out, size_t capacity,
                             bool *out_refused)
{
    const double shown = poses->is_bare ? 1.0 / RADIANS_PER_DEGREE : 1.0;
    char names[256] = "";
    size_t used = 0;
    uint32_t asked = 0, still = 0;
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        if (!has_sensor(poses, sensor) || pose_end(sensor) != step)
            continue;
        asked += 1;
        if (pose_has_moved(poses, sensor, GUIDE_FLAT, step))
            continue;
        still += 1;
        int added = snprintf(names + used, sizeof names - used, "%s%s by %.0f (of %.0f)",
                             still > 1 ? "; " : "", sensor_table[sensor].label,
                             shown * moved_raw(poses, sensor, GUIDE_FLAT, step),
                             shown * least_raw(poses, sensor));
        used += added > 0 && used + (size_t)added < sizeof names ? (size_t)added : 0;
    }
    if (still == 0)
        return NULL;
    *out_refused = 2 * still > asked;
    (void)snprintf(out, capacity, "%u of %u %s hardly moved from the flat hand, in %s: %s%s", still,
                   asked, poses->is_bare ? "joints" : "sensors",
                   poses->is_bare ? "degrees" : "counts", names,
                   *out_refused     ? ""
                   : poses->is_bare ? ". They are used as seen"
                                    : ". They keep the shipped gain");
    return out;
}

static const char *const finger_name[5] = {"thumb", "index", "middle", "ring", "little"};

/* Returns how far a finger is bent, as a share of its angle in the fist (for the thumb: in the
 * thumb across). */
static double bend_of(const guide_poses *poses, guide_step step, int finger)
{
    guide_step end = finger == 0 ? GUIDE_THUMB_ACROSS : GUIDE_FIST;
    double sum = 0;
    int count = 0;
    for (int sensor = 0; poses->has[end] && sensor < MRT_ANGLES; ++sensor) {
        const sensor_facts *facts = &sensor_table[sensor];
        if (facts->finger != finger || facts->kind == SENSOR_SPREAD || facts->kind == SENSOR_ROLL ||
            !has_sensor(poses, sensor) || !pose_has_moved(poses, sensor, GUIDE_FLAT, end))
            continue;
        double flat = (double)poses->raw[GUIDE_FLAT][sensor];
        sum += ((double)poses->raw[step][sensor] - flat) / ((double)poses->raw[end][sensor] - flat);
        count += 1;
    }
    return count > 0 ? sum / count : (double)NAN;
}

static const char *wrong_finger(const guide_poses *poses, guide_step step, char *out,
                                size_t capacity, bool *out_refused)
{
    static const double least_bend = 0.3;
    int asked = pose_finger(step), most = asked;
    double bend = bend_of(poses, step, asked), most_bend = bend;
    if (isnan(bend))
        return NULL;
    for (int finger = 0; finger < 5; ++finger) {
        double other = bend_of(poses, step, finger);
        if (finger != asked && other > most_bend) {
            most = finger;
            most_bend = other;
        }
    }
    *out_refused = true;
    if (most != asked)
        (void)snprintf(out, capacity, "the %s finger is bent more than the %s finger",
                       finger_name[most], finger_name[asked]);
    else if (bend < least_bend)
        (void)snprintf(out, capacity, "the %s finger is bent by only %.0f %% of its range",
                       finger_name[asked], 100.0 * bend);
    else
        *out_refused = false;
    return *out_refused ? out : NULL;
}

/* The angles of a bare hand are about right from the start. So a hand that rests on the edge of the
 * table or on the mouse is still, but can be rejected because it is not flat. */
static const char *bent_finger(const guide_poses *poses, guide_step step, char *out,
                               size_t capacity, bool *out_refused)
{
    static const double straight_deg = 75.0; /* sum over three joints */
    for (int finger = 1; finger < 5; ++finger) {
        double bent_deg = 0;
        for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
            if (sensor_table[sensor].finger == finger &&
                sensor_table[sensor].kind != SENSOR_SPREAD && has_sensor(poses, sensor))
                bent_deg += (double)poses->raw[step][sensor] / RADIANS_PER_DEGREE;
        if (bent_deg <= straight_deg)
            continue;
        *out_refused = true;
        (void)snprintf(out, capacity,
                       "the %s finger is not straight: its joints are bent by %.0f degrees",
                       finger_name[finger], bent_deg);
        return out;
    }
    return NULL;
}

/* Returns NULL if the pose looks right, else a message in out_reason. *out_refused: the pose is
 * impossible and must be refused. */
static const char *pose_check(const guide_poses *poses, guide_step step, char *out_reason,
                              size_t capacity, bool *out_refused)
{
    *out_refused = false;
    if (poses->is_bare && (step == GUIDE_FLAT || step == GUIDE_SPREAD) &&
        bent_finger(poses, step, out_reason, capacity, out_refused))
        return out_reason;
    if (!poses->has[GUIDE_FLAT] || step <= GUIDE_FLAT)
        return NULL;
    if (pose_finger(step) >= 0)
        return wrong_finger(poses, step, out_reason, capacity, out_refused);
    return not_moved(poses, step, out_reason, capacity, out_refused);
}

/* ---- from poses to a calibration ---- */

/* Smaller values are noise: they count neither as motion of a driving joint nor as cross-talk. */
static const double DRIVEN_RAD = 0.3, CROSS_TALK_LEAST = 0.02;

/* ---- tables ---- */

static void solve_table(const guide_poses *poses, int sensor, calibration_sensor *out)
{
    double zero = (double)poses->raw[GUIDE_FLAT][sensor];
    double gain = poses->is_bare ? 1.0 : (double)sensor_table[sensor].gain;
    guide_step end = pose_end(sensor);
    out->source = CALIBRATION_ZEROED;
    if (end < GUIDE_STEPS && poses->has[end] && pose_has_moved(poses, sensor, GUIDE_FLAT, end)) {
        out->source = CALIBRATION_MEASURED;
        gain = pose_end_rad(sensor) / ((double)poses->raw[end][sensor] - zero);
    }
    out->table = calibration_line(sensor, gain, zero, 0.0);
}

static double angle_in(const guide_poses *poses, guide_step step, int sensor,
                       const calibration_file *file)
{
    return hand_table_value(&file->sensor[sensor].table, (double)poses->raw[step][sensor]);
}

/* ---- residuals ---- */

/* RMS of the sensor's readings in all poses where it should be 0. */
static void solve_residual(const guide_poses *poses, int sensor, calibration_file *file)
{
    double sum = 0;
    int count = 0;
    for (guide_step step = GUIDE_FIST; step < GUIDE_STEPS; ++step) {
        if (!poses->has[step] || !pose_is_zero(step, sensor))
            continue;
        double angle_rad = angle_in(poses, step, sensor, file);
        sum += angle_rad * angle_rad;
        count += 1;
    }
    calibration_sensor *out = &file->sensor[sensor];
    out->has_residual = count > 0;
    out->residual_rad = count > 0 ? (float)sqrt(sum / count) : 0.0f;
}

/* ---- cross-talk ---- */

static int joint_of(int finger, sensor_kind kind)
{
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
        if (sensor_table[sensor].finger == finger && sensor_table[sensor].kind == kind)
            return sensor;
    return SENSOR_NONE;
}

/* Returns the joint of the bent finger that is assumed to move this joint: the same joint.
 * Exceptions: the thumb has no middle joint; spreads, roll and arch follow the knuckle. */
static int driver_of(int finger, int sensor)
{
    sensor_kind kind = sensor_table[sensor].kind;
    if (kind == SENSOR_WRIST || sensor_table[sensor].finger == finger)
        return SENSOR_NONE;
    if (kind == SENSOR_END_JOINT && sensor_table[sensor].finger == 0)
        return joint_of(finger, SENSOR_MIDDLE_JOINT);
    if (kind == SENSOR_MIDDLE_JOINT || kind == SENSOR_END_JOINT)
        return joint_of(finger, finger == 0 ? SENSOR_END_JOINT : kind);
    return joint_of(finger, SENSOR_KNUCKLE);
}

static double moved_rad(const guide_poses *poses, guide_step step, int sensor,
                        const calibration_file *file)
{
    return angle_in(poses, step, sensor, file) - angle_in(poses, GUIDE_FLAT, sensor, file);
}

static void solve_cross_talk(const guide_poses *poses, guide_step step, calibration_file *file)
{
    int finger = pose_finger(step);
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        int driver = driver_of(finger, sensor);
        if (driver < 0 || !has_sensor(poses, sensor) || !has_sensor(poses, driver))
            continue;
        double driven_rad = moved_rad(poses, step, driver, file);
        if (!(driven_rad >= DRIVEN_RAD))
            continue;
        double share = moved_rad(poses, step, sensor, file) / driven_rad;
        if (fabs(share) >= CROSS_TALK_LEAST)
            file->sensor[driver].cross_talk[sensor] = (float)share;
    }
}

/* ---- all parts together ---- */

static void solve_sensor(const guide_poses *poses, int sensor, const float *low, const float *high,
                         calibration_file *file)
{
    calibration_sensor *out = &file->sensor[sensor];
    solve_table(poses, sensor, out);
    out->neutral_rad = poses->has[GUIDE_RELAXED]
                           ? (float)angle_in(poses, GUIDE_RELAXED, sensor, file)
                           : sensor_table[sensor].neutral_rad;
    out->has_range = true;
    out->raw_range[0] = low[sensor];
    out->raw_range[1] = high[sensor];
    double first = hand_table_value(&out->table, (double)low[sensor]);
    double last = hand_table_value(&out->table, (double)high[sensor]);
    out->rad_range[0] = (float)fmin(first, last);
    out->rad_range[1] = (float)fmax(first, last);
    solve_residual(poses, sensor, file);
}

/* Computes tables, residuals, cross-talk and the neutral pose, and sets the sensors of `out`. Needs
 * the flat hand. low, high: MRT_ANGLES observed raw values. */
static void solve(const guide_poses *poses, const float *low, const float *high,
                  calibration_file *out)
{
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
        if (has_sensor(poses, sensor))
            solve_sensor(poses, sensor, low, high, out);
    for (guide_step step = GUIDE_THUMB_ALONE; step < GUIDE_STEPS; ++step)
        if (poses->has[step])
            solve_cross_talk(poses, step, out);
}

/* ---- the guide ---- */

static const double NS_PER_SECOND = 1e9;
static const int64_t AWAY_NS = 1000000000;

const char *const guide_wait_text[GUIDE_WAITS_FOR_NOTHING + 1] = {
    [GUIDE_WAITS_FOR_SAMPLES] = "waiting for the hand",
    [GUIDE_WAITS_FOR_MOVEMENT] = "move into the pose",
    [GUIDE_WAITS_FOR_STILLNESS] = "hold still",
    [GUIDE_WAITS_FOR_NOTHING] = "all poses are done",
};

struct guide {
    guide_settings settings;
    guide_poses poses;
    guide_step step;
    guide_step next; /* the step after the current one */
    bool is_again;   /* the pose of the step was taken before */
    still_window window;
    bool has_sample, has_step_start;
    int64_t step_start_ns, last_ns;
    bool has_left; /* the hand has left the pose below since the beginning of the step */
    bool has_held; /* a pose was taken or refused: the step waits until the hand leaves it */
    float held[MRT_ANGLES];
    float low[MRT_ANGLES], high[MRT_ANGLES];
    char reason[512];
};

guide_settings guide_settings_default(uint32_t side, uint32_t sensors)
{
    return (guide_settings){.side = side,
                            .sensors = sensors,
                            .steps = (1u << GUIDE_STEPS) - 1,
                            .still_s = 0.7,
                            .lead_s = 1.0,
                            .still_raw = 1.5,
                            .moved_raw = 10.0};
}

guide_settings guide_settings_bare(uint32_t side, uint32_t sensors, const char *input)
{
    /* Devices that do not see the forearm measure the wrist relative to the pose in which they
     * first saw the hand, which differs each time. */
    const bool has_forearm = strcmp(input, "camera") != 0 && strcmp(input, "openxr") != 0;
    const uint32_t untold = has_forearm ? 0u : 1u << SENSOR_WRIST_PITCH | 1u << SENSOR_WRIST_YAW;
    guide_settings out = {.side = side,
                          .sensors = sensors & ~(1u << SENSOR_THUMB_ROLL | untold),
                          .steps = 1u << GUIDE_FLAT | 1u << GUIDE_FIST | 1u << GUIDE_SPREAD,
                          .still_s = 1.0,
                          .lead_s = 0.6,
                          .still_raw = 0.08,
                          .moved_raw = 0.35};
    (void)snprintf(out.input, sizeof out.input, "%s", input);
    return out;
}

bool guide_is_requested(const guide *self, guide_step step)
{
    return step < GUIDE_STEPS && (self->settings.steps >> step & 1u);
}

/* Returns the next requested step, beginning with `step` itself. */
static guide_step next_asked(const guide *self, guide_step step)
{
    while (step < GUIDE_STEPS && !guide_is_requested(self, step))
        ++step;
    return step;
}

guide *guide_create(const guide_settings *settings)
{
    guide *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->settings = *settings;
    self->settings.steps |= 1u << GUIDE_FLAT;
    self->poses.sensors = settings->sensors;
    self->poses.is_bare = settings->input[0] != '\0';
    self->step = next_asked(self, GUIDE_RELAXED);
    self->next = next_asked(self, self->step + 1);
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
    self->next = next_asked(self, step + 1);
    self->is_again = false;
    self->has_step_start = false;
    self->has_left = false;
}

/* Makes the step wait until the hand moves to another pose. */
static void hold(guide *self, const float *raw)
{
    memcpy(self->held, raw, sizeof self->held);
    self->has_held = true;
    self->has_left = false;
}

static guide_news take_pose(guide *self)
{
    guide_step step = self->step;
    still_median(&self->window, self->poses.raw[step]);
    hold(self, self->poses.raw[step]);
    bool refused = false;
    if (!pose_check(&self->poses, step, self->reason, sizeof self->reason, &refused))
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
        return take_pose(self);
    (void)snprintf(self->reason, sizeof self->reason, "%s gives no samples",
                   self->poses.is_bare ? "the hand" : "the glove");
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
    guide_step step = self->step;
    for (int back = (int)self->step - 1; back >= 0 && step == self->step; --back)
        if (guide_is_requested(self, (guide_step)back))
            step = (guide_step)back;
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
        if (has_sensor(&self->poses, i) &&
            fabs((double)raw[i] - (double)self->held[i]) >= self->settings.moved_raw)
            return true;
    return false;
}

static double step_age_s(const guide *self)
{
    return (double)(self->last_ns - self->step_start_ns) / NS_PER_SECOND;
}

static void explain_timeout(guide *self, const still_state *still)
{
    char what[160] = "the hand did not move into another pose";
    if (self->has_left || !self->has_held) {
        const char *label =
            still->worst_channel >= 0 ? sensor_table[still->worst_channel].label : "no sensor";
        (void)snprintf(what, sizeof what, "the hand was not still (%s, deviation %.1f %s)", label,
                       self->poses.is_bare ? still->worst / RADIANS_PER_DEGREE : still->worst,
                       self->poses.is_bare ? "degrees" : "counts");
    }
    (void)snprintf(self->reason, sizeof self->reason, "%s: nothing was taken within %.0f s: %s",
                   guide_step_name[self->step], self->settings.timeout_s, what);
}

/* The clock of a step starts with its first sample, and stops while the device is disconnected. */
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
        bool has = has_sensor(&self->poses, i);
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
    if (may_take && still.is_full && still.worst <= self->settings.still_raw)
        return take_pose(self);
    if (self->settings.timeout_s > 0 && step_age_s(self) > self->settings.timeout_s) {
        explain_timeout(self, &still);
        self->has_step_start = false;
        return GUIDE_TIMED_OUT;
    }
    return GUIDE_NOTHING;
}

/* ---- current state ---- */

guide_step guide_current(const guide *self)
{
    return self->step;
}

const char *guide_instruction(const guide *self)
{
    if (self->step == GUIDE_STEPS)
        return "";
    const char *bare = self->poses.is_bare ? bare_words[self->step] : NULL;
    return bare ? bare : glove_words[self->step];
}

int guide_number(const guide *self, int *out_of)
{
    int number = 0;
    *out_of = 0;
    for (int step = 0; step < GUIDE_STEPS; ++step) {
        *out_of += guide_is_requested(self, (guide_step)step);
        number += guide_is_requested(self, (guide_step)step) && step <= (int)self->step;
    }
    return number;
}

guide_wait guide_waiting(const guide *self)
{
    if (self->step == GUIDE_STEPS)
        return GUIDE_WAITS_FOR_NOTHING;
    if (self->window.count == 0)
        return GUIDE_WAITS_FOR_SAMPLES;
    return self->has_left || !self->has_held ? GUIDE_WAITS_FOR_STILLNESS : GUIDE_WAITS_FOR_MOVEMENT;
}

double guide_held(const guide *self)
{
    if (guide_waiting(self) != GUIDE_WAITS_FOR_STILLNESS)
        return 0.0;
    const double held = still_share(&self->window, self->settings.still_raw);
    return fmin(held, fmax(step_age_s(self) / self->settings.lead_s, 0.0));
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
    memcpy(out->input, self->settings.input, sizeof out->input);
    if (!self->poses.has[GUIDE_FLAT])
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the flat hand was not taken. All other poses are measured from it");
    solve(&self->poses, self->low, self->high, out);
    return MRT_OK;
}

/* ---- quality of a calibration ---- */

static const double DEGREES_PER_RADIAN = 180.0 / ANGLE_PI;
/* A glove that fits repeats a known pose within 3 degrees. Slipping cloth adds a few degrees. At 10
 * degrees and more, the finger was visibly in another pose. Landmarks of a camera have a mean error
 * of 5 degrees, more if a finger hides another (research/camera.md). */
static const double LOOSE_DEG[2] = {3.0, 8.0}, OFF_DEG[2] = {10.0, 20.0}; /* glove, bare hand */

/* ---- a sensor that should read 0 ---- */

typedef struct readings {
    int count;
    double least_rad, greatest_rad;
    double worst_rad; /* magnitude */
    guide_step worst;
} readings;

static readings read_zeros(const guide_poses *poses, int sensor, const calibration_file *file)
{
    readings out = {.worst = GUIDE_STEPS};
    for (guide_step step = GUIDE_FIST; step < GUIDE_STEPS; ++step) {
        if (!poses->has[step] || !pose_is_zero(step, sensor))
            continue;
        double angle_rad = angle_in(poses, step, sensor, file);
        out.least_rad = out.count > 0 ? fmin(out.least_rad, angle_rad) : angle_rad;
        out.greatest_rad = out.count > 0 ? fmax(out.greatest_rad, angle_rad) : angle_rad;
        out.count += 1;
        if (fabs(angle_rad) > out.worst_rad) {
            out.worst_rad = fabs(angle_rad);
            out.worst = step;
        }
    }
    return out;
}

/* Two or more poses agree with each other, but none of them with the flat hand. */
static bool is_flat_hand_wrong(const readings *zeros)
{
    double apart_rad = zeros->greatest_rad - zeros->least_rad;
    double nearest_rad = fmax(zeros->least_rad, -zeros->greatest_rad);
    return zeros->count >= 2 && nearest_rad > apart_rad;
}

static guide_flaw judge_zero(const guide_poses *poses, int sensor, const calibration_file *file)
{
    const calibration_sensor *made = &file->sensor[sensor];
    double residual_deg = (double)made->residual_rad * DEGREES_PER_RADIAN;
    const bool is_bare = file->input[0] != '\0';
    guide_flaw out = {
        .sensor = sensor, .step = GUIDE_STEPS, .is_bare = is_bare, .off_rad = made->residual_rad};
    if (!made->has_residual)
        return out;
    double worst_deg = residual_deg;
    if (poses) {
        readings zeros = read_zeros(poses, sensor, file);
        worst_deg = zeros.worst_rad * DEGREES_PER_RADIAN;
        out.step = is_flat_hand_wrong(&zeros) ? GUIDE_FLAT : zeros.worst;
    }
    if (worst_deg > OFF_DEG[is_bare]) {
        out.kind = GUIDE_FLAW_OFF;
        out.off_rad = (float)(worst_deg / DEGREES_PER_RADIAN);
    } else if (residual_deg > LOOSE_DEG[is_bare]) {
        out.kind = GUIDE_FLAW_LOOSE;
    }
    return out;
}

/* ---- a sensor that should reach the end of its range ---- */

static bool goes_beyond(const guide_poses *poses, int sensor, const calibration_file *file)
{
    const hand_table *table = &file->sensor[sensor].table;
    double end_rad = fmax((double)table->rad[0], (double)table->rad[table->count - 1]) - 1e-6;
    for (guide_step step = GUIDE_FIST; step < GUIDE_STEPS; ++step)
        if (poses->has[step] && !pose_is_zero(step, sensor) &&
            angle_in(poses, step, sensor, file) >= end_rad)
            return true;
    return false;
}

static guide_flaw judge_range(const guide_poses *poses, int sensor, const calibration_file *file)
{
    guide_step end = pose_end(sensor);
    guide_flaw out = {.sensor = sensor, .step = end, .is_bare = file->input[0] != '\0'};
    if (end == GUIDE_STEPS || !poses->has[end])
        return out;
    if (file->sensor[sensor].source == CALIBRATION_ZEROED)
        out.kind = GUIDE_FLAW_DEAD;
    /* A finger cannot bend further than in a fist, but thumbs differ in how far they bend alone. */
    else if (end == GUIDE_FIST && goes_beyond(poses, sensor, file))
        out.kind = GUIDE_FLAW_BEYOND;
    return out;
}

/* ---- all sensors ---- */

static int compare(const void *a, const void *b)
{
    const guide_flaw *first = a, *second = b;
    if ((first->step == GUIDE_FLAT) != (second->step == GUIDE_FLAT))
        return first->step == GUIDE_FLAT ? -1 : 1;
    if (first->kind != second->kind)
        return first->kind > second->kind ? -1 : 1;
    return first->sensor - second->sensor;
}

static guide_flaw judge_sensor(const guide_poses *poses, int sensor, const calibration_file *file)
{
    guide_flaw zero = judge_zero(poses, sensor, file);
    guide_flaw range = {.kind = GUIDE_FLAW_NONE};
    if (poses && poses->has[GUIDE_FLAT])
        range = judge_range(poses, sensor, file);
    /* A gain that is too large makes all readings too large, so the range is reported first. */
    bool is_zero_wrong = zero.kind != GUIDE_FLAW_NONE && zero.step == GUIDE_FLAT;
    return range.kind != GUIDE_FLAW_NONE && !is_zero_wrong ? range : zero;
}

void guide_judge(guide_judgement *out, const guide *self, const calibration_file *made)
{
    const guide_poses *poses = self ? &self->poses : NULL;
    *out = (guide_judgement){.flaw_count = 0};
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        if (made->sensor[sensor].table.count == 0)
            continue;
        guide_flaw flaw = judge_sensor(poses, sensor, made);
        if (flaw.kind != GUIDE_FLAW_NONE)
            out->flaw[out->flaw_count++] = flaw;
    }
    qsort(out->flaw, out->flaw_count, sizeof *out->flaw, compare);
    for (guide_step step = 0; self && step < GUIDE_STEPS; ++step) {
        out->asked += guide_is_requested(self, step);
        out->left_out += guide_is_requested(self, step) && !self->poses.has[step];
    }
}

bool guide_flaw_is_wrong(const guide_flaw *flaw)
{
    return flaw->kind > GUIDE_FLAW_LOOSE;
}

/* ---- messages ---- */

static void describe_off(const guide_flaw *flaw, char *out, size_t capacity)
{
    double off_deg = (double)flaw->off_rad * DEGREES_PER_RADIAN;
    const char *should = sensor_table[flaw->sensor].kind == SENSOR_SPREAD ? "closed" : "straight";
    const char *label = sensor_table[flaw->sensor].label;
    if (flaw->step == GUIDE_FLAT)
        (void)snprintf(out, capacity,
                       "%s: reads %.0f degrees wherever it is %s: the flat hand was not flat. "
                       "Repeat: flat hand.",
                       label, off_deg, should);
    else if (flaw->step < GUIDE_STEPS)
        (void)snprintf(out, capacity, "%s: reads %.0f degrees where it should be %s. Repeat: %s.",
                       label, off_deg, should, guide_step_name[flaw->step]);
    else
        (void)snprintf(out, capacity,
                       "%s: reads %.0f degrees where it should be %s. Calibrate again.", label,
                       off_deg, should);
}

void guide_flaw_text(const guide_flaw *flaw, char *out, size_t capacity)
{
    double off_deg = (double)flaw->off_rad * DEGREES_PER_RADIAN;
    const char *label = sensor_table[flaw->sensor].label;
    const char *step = flaw->step < GUIDE_STEPS ? guide_step_name[flaw->step] : "";
    switch (flaw->kind) {
    case GUIDE_FLAW_NONE:
        (void)snprintf(out, capacity, "%s: good.", label);
        break;
    case GUIDE_FLAW_LOOSE:
        (void)snprintf(out, capacity, "%s: reads %.1f degrees apart when held again. %s%s%s", label,
                       off_deg, flaw->is_bare ? "Could it be seen well?" : "Is the glove tight?",
                       step[0] ? " Repeat: " : "", step);
        break;
    case GUIDE_FLAW_DEAD:
        if (flaw->is_bare)
            (void)snprintf(
                out, capacity,
                "%s: hardly moved, so it is used as seen. Repeat: %s, turned so that it can be "
                "seen.",
                label, step);
        else
            (void)snprintf(out, capacity,
                           "%s: hardly moved, so it keeps the shipped gain. Repeat: %s. If that "
                           "does not help, the sensor is broken.",
                           label, step);
        break;
    case GUIDE_FLAW_BEYOND:
        (void)snprintf(out, capacity,
                       "%s: was bent much further in a later pose. Repeat: %s, "
                       "tightly.",
                       label, step);
        break;
    case GUIDE_FLAW_OFF:
        describe_off(flaw, out, capacity);
        break;
    }
}

void guide_judgement_text(const guide_judgement *judgement, char *out, size_t capacity)
{
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < judgement->flaw_count; ++i)
        wrong += guide_flaw_is_wrong(&judgement->flaw[i]);
    if (wrong > 0)
        (void)snprintf(out, capacity, "All poses are done, but %u %s not right.", wrong,
                       wrong == 1 ? "sensor is" : "sensors are");
    else if (judgement->flaw_count > 0)
        (void)snprintf(out, capacity, "All poses are done, but %u %s loosely.",
                       judgement->flaw_count,
                       judgement->flaw_count == 1 ? "sensor fits" : "sensors fit");
    else if (judgement->left_out > 0)
        (void)snprintf(out, capacity, "Done, but %u of %u poses %s left out.", judgement->left_out,
                       judgement->asked, judgement->left_out == 1 ? "was" : "were");
    else
        (void)snprintf(out, capacity, "All poses are done.");
}
