#include "hand/guide_judge.h"

#include "base/angle.h"
#include "hand/guide_poses.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double DEGREES_PER_RADIAN = 180.0 / ANGLE_PI;
/* A known pose held again is read within 3 degrees by a glove that fits. Cloth that slips makes a
 * few degrees more; from 10 on a person sees that the finger was not where it was asked to be. */
static const double LOOSE_DEG = 3.0, OFF_DEG = 10.0;

/* ---- a sensor that should read 0 ---- */

typedef struct readings {
    int count;
    double least_rad, greatest_rad;
    double worst_rad; /* magnitude */
    guide_step worst;
} readings;

static double angle_in(const guide_poses *poses, guide_step step, int sensor,
                       const calibration_file *file)
{
    return hand_table_value(&file->sensor[sensor].table, (double)poses->raw[step][sensor]);
}

static readings read_zeros(const guide_poses *poses, int sensor, const calibration_file *file)
{
    readings out = {.worst = GUIDE_STEPS};
    for (guide_step step = GUIDE_FIST; step < GUIDE_STEPS; ++step) {
        if (!poses->has[step] || !guide_pose_is_zero(step, sensor))
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

/* Two and more poses agree with each other, and none with the flat hand. */
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
    guide_flaw out = {.sensor = sensor, .step = GUIDE_STEPS, .off_rad = made->residual_rad};
    if (!made->has_residual)
        return out;
    double worst_deg = residual_deg;
    if (poses) {
        readings zeros = read_zeros(poses, sensor, file);
        worst_deg = zeros.worst_rad * DEGREES_PER_RADIAN;
        out.step = is_flat_hand_wrong(&zeros) ? GUIDE_FLAT : zeros.worst;
    }
    if (worst_deg > OFF_DEG) {
        out.kind = GUIDE_FLAW_OFF;
        out.off_rad = (float)(worst_deg / DEGREES_PER_RADIAN);
    } else if (residual_deg > LOOSE_DEG) {
        out.kind = GUIDE_FLAW_LOOSE;
    }
    return out;
}

/* ---- a sensor that should go as far as in the pose that ends its range ---- */

static bool goes_beyond(const guide_poses *poses, int sensor, const calibration_file *file)
{
    const hand_table *table = &file->sensor[sensor].table;
    double end_rad = fmax((double)table->rad[0], (double)table->rad[table->count - 1]) - 1e-6;
    for (guide_step step = GUIDE_FIST; step < GUIDE_STEPS; ++step)
        if (poses->has[step] && !guide_pose_is_zero(step, sensor) &&
            angle_in(poses, step, sensor, file) >= end_rad)
            return true;
    return false;
}

static guide_flaw judge_range(const guide_poses *poses, int sensor, const calibration_file *file)
{
    guide_step end = guide_pose_end(sensor);
    guide_flaw out = {.sensor = sensor, .step = end};
    if (end == GUIDE_STEPS || !poses->has[end])
        return out;
    if (file->sensor[sensor].source == CALIBRATION_ZEROED)
        out.kind = GUIDE_FLAW_DEAD;
    /* A fist is as far as a finger goes; thumbs differ in how far they bend alone. */
    else if (end == GUIDE_FIST && goes_beyond(poses, sensor, file))
        out.kind = GUIDE_FLAW_BEYOND;
    return out;
}

/* ---- all ---- */

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
    /* A gain that is too great makes every reading too great: the range first. */
    bool is_zero_wrong = zero.kind != GUIDE_FLAW_NONE && zero.step == GUIDE_FLAT;
    return range.kind != GUIDE_FLAW_NONE && !is_zero_wrong ? range : zero;
}

void guide_judge(guide_judgement *out, const guide *self, const calibration_file *made)
{
    const guide_poses *poses = self ? guide_poses_of(self) : NULL;
    *out = (guide_judgement){.flaw_count = 0};
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        if (made->sensor[sensor].table.count == 0)
            continue;
        guide_flaw flaw = judge_sensor(poses, sensor, made);
        if (flaw.kind != GUIDE_FLAW_NONE)
            out->flaw[out->flaw_count++] = flaw;
    }
    qsort(out->flaw, out->flaw_count, sizeof *out->flaw, compare);
    for (int step = 0; poses && step < GUIDE_STEPS; ++step)
        out->left_out += !poses->has[step];
}

bool guide_flaw_is_wrong(const guide_flaw *flaw)
{
    return flaw->kind > GUIDE_FLAW_LOOSE;
}

/* ---- words ---- */

static void say_off(const guide_flaw *flaw, char *out, size_t capacity)
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
        (void)snprintf(out, capacity,
                       "%s: reads %.1f degrees apart when held again. Is the glove tight?%s%s",
                       label, off_deg, step[0] ? " Repeat: " : "", step);
        break;
    case GUIDE_FLAW_DEAD:
        (void)snprintf(out, capacity,
                       "%s: hardly moved, so it keeps the shipped gain. Repeat: %s. If it stays "
                       "so, the sensor is broken.",
                       label, step);
        break;
    case GUIDE_FLAW_BEYOND:
        (void)snprintf(out, capacity, "%s: was bent much further later on. Repeat: %s, tightly.",
                       label, step);
        break;
    case GUIDE_FLAW_OFF:
        say_off(flaw, out, capacity);
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
        (void)snprintf(out, capacity, "Done, but %u of %d poses %s left out.", judgement->left_out,
                       GUIDE_STEPS, judgement->left_out == 1 ? "was" : "were");
    else
        (void)snprintf(out, capacity, "All poses are done.");
}
