#include "hand/guide_poses.h"

#include "base/angle.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double RADIANS_PER_DEGREE = ANGLE_PI / 180.0;

const char *const guide_step_name[GUIDE_STEPS] = {
    "relaxed hand", "flat hand",   "fist",         "thumb across", "fingers spread",
    "thumb alone",  "index alone", "middle alone", "ring alone",   "little alone"};

const char *const guide_step_words[GUIDE_STEPS] = {
    "Hold your hand relaxed, as you will when the face is at rest.",
    "Lay your hand flat on the table: wrist, fingers and thumb straight and together.",
    "Make a tight fist, the thumb outside.",
    "Open the hand; lay the bent thumb across the palm, its tip at the root of the little finger.",
    "Lay your hand flat again and spread fingers and thumb as far as they go.",
    "Fingers straight and together; bend only the thumb.",
    "Bend only the index finger, all the way; thumb and other fingers straight.",
    "Bend only the middle finger, all the way; thumb and other fingers straight.",
    "Bend only the ring finger, all the way; thumb and other fingers straight.",
    "Bend only the little finger, all the way; thumb and other fingers straight."};

bool guide_poses_has_sensor(const guide_poses *poses, int sensor)
{
    return (poses->sensors >> sensor & 1u) != 0;
}

guide_step guide_pose_end(int sensor)
{
    const sensor_facts *facts = &sensor_table[sensor];
    if (facts->kind == SENSOR_PALM || facts->kind == SENSOR_WRIST)
        return GUIDE_STEPS;
    if (facts->kind == SENSOR_SPREAD)
        return GUIDE_SPREAD;
    return facts->finger == 0 ? GUIDE_THUMB_ACROSS : GUIDE_FIST;
}

/* A pose leads each joint to the end of its clinical range (sensor.c, hardware.md 2.3): the fist
 * the knuckles to 90, middle joints to 100, end joints to 80 degrees; the thumb across the palm its
 * base to 80, knuckle to 50, end joint to 80; the widest spread 17, 14, 32, and 53 of the thumb. */
double guide_pose_end_rad(int sensor)
{
    return (double)sensor_table[sensor].high_deg * RADIANS_PER_DEGREE;
}

int guide_pose_finger(guide_step step)
{
    return step >= GUIDE_THUMB_ALONE && step < GUIDE_STEPS ? (int)step - (int)GUIDE_THUMB_ALONE
                                                           : -1;
}

/* A bent finger drags its neighbours along, so they do not count; nor do the spreads beside it. The
 * thumb and the index finger are free of each other. */
static bool is_dragged(int finger, int bent)
{
    if (finger == bent)
        return true;
    return finger > 0 && bent > 0 && abs(finger - bent) == 1;
}

bool guide_pose_is_zero(guide_step step, int sensor)
{
    const sensor_facts *facts = &sensor_table[sensor];
    if (step == GUIDE_FLAT)
        return true;
    if (facts->kind == SENSOR_PALM || facts->kind == SENSOR_WRIST)
        return false;
    if (step == GUIDE_SPREAD)
        return facts->kind != SENSOR_SPREAD && facts->finger > 0;
    int bent = guide_pose_finger(step);
    if (bent < 0)
        return false;
    if (facts->finger == 0)
        return bent > 0 && facts->kind != SENSOR_ROLL;
    if (facts->kind == SENSOR_SPREAD)
        return !is_dragged(facts->finger, bent) && !is_dragged(facts->finger - 1, bent);
    return !is_dragged(facts->finger, bent);
}

/* Twice the greatest gains of hardware.md 2.1 (0.027 rad a count of flexion, 0.010 of abduction):
 * a sensor that says less over the whole range of its joint says nothing. */
static double least_counts(int sensor)
{
    double most = sensor_table[sensor].kind == SENSOR_SPREAD ? 0.025 : 0.055;
    return guide_pose_end_rad(sensor) / most;
}

static double moved_counts(const guide_poses *poses, int sensor, guide_step from, guide_step to)
{
    return fabs((double)poses->raw[to][sensor] - (double)poses->raw[from][sensor]);
}

bool guide_pose_has_moved(const guide_poses *poses, int sensor, guide_step from, guide_step to)
{
    return moved_counts(poses, sensor, from, to) >= least_counts(sensor);
}

static const char *not_moved(const guide_poses *poses, guide_step step, char *out, size_t capacity,
                             bool *out_refused)
{
    char names[256] = "";
    size_t used = 0;
    uint32_t asked = 0, still = 0;
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        if (!guide_poses_has_sensor(poses, sensor) || guide_pose_end(sensor) != step)
            continue;
        asked += 1;
        if (guide_pose_has_moved(poses, sensor, GUIDE_FLAT, step))
            continue;
        still += 1;
        int added = snprintf(names + used, sizeof names - used, "%s%s by %.0f (of %.0f)",
                             still > 1 ? "; " : "", sensor_table[sensor].label,
                             moved_counts(poses, sensor, GUIDE_FLAT, step), least_counts(sensor));
        used += added > 0 && used + (size_t)added < sizeof names ? (size_t)added : 0;
    }
    if (still == 0)
        return NULL;
    *out_refused = 2 * still > asked;
    (void)snprintf(out, capacity,
                   "%u of %u sensors hardly moved from the flat hand, in counts: %s%s", still,
                   asked, names, *out_refused ? "" : ". They keep the shipped gain");
    return out;
}

/* How far a finger is bent, as a share of its fist (the thumb: of the thumb across). */
static double bend_of(const guide_poses *poses, guide_step step, int finger)
{
    guide_step end = finger == 0 ? GUIDE_THUMB_ACROSS : GUIDE_FIST;
    double sum = 0;
    int count = 0;
    for (int sensor = 0; poses->has[end] && sensor < MRT_ANGLES; ++sensor) {
        const sensor_facts *facts = &sensor_table[sensor];
        if (facts->finger != finger || facts->kind == SENSOR_SPREAD || facts->kind == SENSOR_ROLL ||
            !guide_poses_has_sensor(poses, sensor) ||
            !guide_pose_has_moved(poses, sensor, GUIDE_FLAT, end))
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
    static const char *const finger_name[5] = {"thumb", "index", "middle", "ring", "little"};
    static const double least_bend = 0.3;
    int asked = guide_pose_finger(step), most = asked;
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

const char *guide_pose_check(const guide_poses *poses, guide_step step, char *out_reason,
                             size_t capacity, bool *out_refused)
{
    *out_refused = false;
    if (!poses->has[GUIDE_FLAT] || step <= GUIDE_FLAT)
        return NULL;
    if (guide_pose_finger(step) >= 0)
        return wrong_finger(poses, step, out_reason, capacity, out_refused);
    return not_moved(poses, step, out_reason, capacity, out_refused);
}
