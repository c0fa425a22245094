#include "maps.h"

#include "curve.h"

#include <math.h>
#include <string.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof *(array)))

static const double rad_per_deg = 0.017453292519943295;

/* ---- muppet+ ---- */

/* params from `first` on: gain, dead zone, range. */
static double channel(double signal, const double *params, int first)
{
    double range = params[first + 2];
    return curve_limit(params[first] * curve_dead_zone(signal, params[first + 1]), range, range);
}

/* Channels that act only one way: the dead zone's other side stays at rest. */
static double upward(double x)
{
    return x > 0.0 ? x : 0.0;
}

static double jaw_open(double drop, const double *params)
{
    double range = params[SET_JAW_RANGE];
    double travel = params[SET_JAW_GAIN] * curve_dead_zone(drop, params[SET_JAW_DEAD]) / range;
    double knee_x = 0.01 * params[SET_JAW_KNEE_TRAVEL], knee_y = 0.01 * params[SET_JAW_KNEE_GAPE];
    return rad_per_deg * range * curve_knee(travel, knee_x, knee_y);
}

static double brow(double lift, const double *params)
{
    return curve_limit(params[SET_BROW_GAIN] * curve_dead_zone(lift, params[SET_BROW_DEAD]),
                       params[SET_BROW_UP], params[SET_BROW_DOWN]);
}

static double corner(double lift, const double *params)
{
    return curve_limit(params[SET_CORNER_GAIN] * curve_dead_zone(lift, params[SET_CORNER_DEAD]),
                       params[SET_CORNER_SMILE], params[SET_CORNER_FROWN]);
}

static double width(double spread, const double *params)
{
    double moved = curve_dead_zone(spread, params[SET_WIDTH_DEAD]);
    double gain = moved < 0.0 ? params[SET_NARROW_GAIN] : params[SET_WIDE_GAIN];
    return curve_limit(gain * moved, params[SET_WIDE_RANGE], params[SET_NARROW_RANGE]);
}

static double head(double wrist, double range_deg, const double *params)
{
    double turned = params[SET_HEAD_GAIN] * curve_dead_zone(wrist, params[SET_HEAD_DEAD]);
    return curve_limit(turned, range_deg, range_deg);
}

double maps_droop(const reading *difference, double intensity, const double *params)
{
    double bend = difference->value[READING_MIDDLE_KNUCKLE];
    double range = params[SET_DROOP_RANGE];
    double percent = curve_limit(
        params[SET_DROOP_GAIN] * curve_dead_zone(bend, params[SET_DROOP_DEAD]), range, range);
    return intensity * 0.01 * percent;
}

void maps_muppet(pose *out, const reading *difference, double intensity, double droop,
                 const double *params)
{
    reading_signals s = reading_signals_of(difference, params);
    double head_up = params[SET_LIP_HEAD] * upward(curve_dead_zone(s.reach, params[SET_LIP_DEAD]));
    double nod_deg = head(s.wrist_pitch, params[SET_HEAD_NOD], params);
    double turn_deg = head(s.wrist_yaw, params[SET_HEAD_TURN], params);
    nod_deg = curve_clamp(nod_deg - head_up, -params[SET_HEAD_NOD], params[SET_HEAD_NOD]);
    double eyes = 0.01 * params[SET_HEAD_EYES] * rad_per_deg;
    pose_axes axes = {
        .jaw_open = jaw_open(s.thumb_drop, params),
        .jaw_lateral = channel(s.thumb_aside, params, SET_ASIDE_GAIN),
        .brow = intensity * brow(s.index_lift, params),
        .tilt = intensity * channel(s.index_middle, params, SET_TILT_GAIN),
        .lid = droop,
        .corner = intensity * corner(s.little_lift, params),
        .smirk = intensity * channel(s.ring_little, params, SET_SMIRK_GAIN),
        .width = intensity * width(s.spread, params),
        .sneer = intensity * upward(channel(s.arch, params, SET_SNEER_GAIN)),
        .lip = upward(channel(s.reach, params, SET_LIP_GAIN)),
        .nod = rad_per_deg * nod_deg,
        .turn = rad_per_deg * turn_deg,
        .gaze_yaw = eyes * turn_deg,
        .gaze_pitch = -eyes * nod_deg,
    };
    pose_from_axes(out, &axes, params);
}

/* ---- mask ---- */

/* Out is across the face, to the subject's left, for both sides. */
typedef struct follower {
    int landmark;
    double share;
} follower;

static const follower brow_followers[] = {
    {LANDMARK_BROW_INNER, 0.8}, {LANDMARK_BROW_MID, 1}, {LANDMARK_BROW_OUTER, 0.8}};
static const follower corner_followers[] = {{LANDMARK_MOUTH_CORNER, 1},
                                            {LANDMARK_NASOLABIAL, 0.4},
                                            {LANDMARK_CHEEK_LOWER, 0.4},
                                            {LANDMARK_LIP_UPPER_SIDE, 0.45},
                                            {LANDMARK_LIP_LOWER_SIDE, 0.45}};
static const follower cheek_followers[] = {{LANDMARK_CHEEK, 1}};
static const follower chin_followers[] = {{LANDMARK_CHIN, 1}, {LANDMARK_LIP_LOWER_MID, 0.8}};

static void follow(pose *p, const follower *followers, int count, int side, const double pull[3])
{
    for (int i = 0; i < count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            p->value[3 * (followers[i].landmark + side) + axis] += followers[i].share * pull[axis];
}

/* A point's movement scaled, its dead zone a ball, softly stopped. */
static void scaled(double out[3], const double *moved, double gain, double most_mm,
                   const double *params)
{
    double length = sqrt(moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2]);
    double pulled =
        curve_limit(gain * curve_dead_zone(length, params[SET_MASK_DEAD]), most_mm, most_mm);
    for (int axis = 0; axis < 3; ++axis)
        out[axis] = length > 0.0 ? pulled * (moved[axis] / length) : 0.0;
}

/* As far as brows go: beyond it the skin between them and the sockets folds. */
static void pull_brow(pose *p, int side, const double pull[3], const double *params)
{
    double aside_mm = params[SET_MASK_BROW_ASIDE];
    double kept[3] = {curve_limit(pull[0], aside_mm, aside_mm),
                      curve_limit(pull[1], params[SET_BROW_UP], params[SET_BROW_DOWN]),
                      curve_limit(pull[2], aside_mm, aside_mm)};
    follow(p, brow_followers, COUNT_OF(brow_followers), side, kept);
}

/* The thumb holds the jaw by the chin: what a jaw can do it does, only up is left to the skin. */
static void pull_jaw(pose *p, const double pull[3], const double *params)
{
    double *dof = p->value + POSE_DOFS;
    double range = rad_per_deg * params[SET_JAW_RANGE];
    double up_mm = curve_limit(upward(pull[1]), params[SET_REACH], params[SET_REACH]);
    double up[3] = {0.0, up_mm, 0.0};
    dof[DOF_JAW_OPEN] = curve_limit(upward(-pull[1]) / params[SET_LEVER], range, range);
    dof[DOF_JAW_LATERAL] = curve_limit(pull[0], params[SET_ASIDE_RANGE], params[SET_ASIDE_RANGE]);
    dof[DOF_JAW_FORWARD] = curve_limit(pull[2], params[SET_ARC_FORWARD], params[SET_ARC_FORWARD]);
    follow(p, chin_followers, COUNT_OF(chin_followers), 0, up);
}

void maps_mask(pose *out, const reading *difference, const double *params)
{
    enum { THUMB, INDEX, MIDDLE, RING, LITTLE };
    enum { LEFT, RIGHT };
    double pull[5][3], palm[3], reach_mm = params[SET_REACH];
    double jaw_mm = rad_per_deg * params[SET_JAW_RANGE] * params[SET_LEVER];
    memset(out, 0, sizeof *out);
    for (int finger = THUMB; finger <= LITTLE; ++finger)
        scaled(pull[finger], difference->value + READING_TIPS + 3 * finger,
               params[SET_MASK_THUMB + finger], finger == THUMB ? 1.5 * jaw_mm : reach_mm, params);
    scaled(palm, difference->value + READING_PALM, params[SET_MASK_PALM], reach_mm, params);
    pull_jaw(out, pull[THUMB], params);
    pull_brow(out, LEFT, pull[INDEX], params);
    pull_brow(out, RIGHT, pull[MIDDLE], params);
    follow(out, corner_followers, COUNT_OF(corner_followers), LEFT, pull[RING]);
    follow(out, corner_followers, COUNT_OF(corner_followers), RIGHT, pull[LITTLE]);
    follow(out, cheek_followers, COUNT_OF(cheek_followers), RIGHT, palm);
    palm[0] = -palm[0];
    follow(out, cheek_followers, COUNT_OF(cheek_followers), LEFT, palm);
}

/* ---- layered waldo ---- */

/* -1 .. 1 over the arc. */
static double along_arc(double signal, int arc, const double *params)
{
    return curve_limit(curve_dead_zone(signal, params[SET_ARC_DEAD]) / params[arc], 1.0, 1.0);
}

/* -1 .. 1 to -down .. up. */
static double spanned(double part, double up, double down)
{
    return part < 0.0 ? part * down : part * up;
}

void maps_waldo(pose *out, const reading *difference, int layer, const double *params)
{
    reading_signals s = reading_signals_of(difference, params);
    double thumb = along_arc(s.thumb_drop, SET_ARC_THUMB, params);
    double index = along_arc(s.index_lift, SET_ARC_INDEX, params);
    double spread = along_arc(s.spread, SET_ARC_SPREAD, params);
    double little = along_arc(s.little_lift, SET_ARC_LITTLE, params);
    double pitch = along_arc(s.wrist_pitch, SET_ARC_WRIST, params);
    double yaw = along_arc(s.wrist_yaw, SET_ARC_WRIST, params);
    pose_axes axes = {0};
    if (layer == LAYER_MOUTH) {
        axes.jaw_open = thumb * rad_per_deg * params[SET_JAW_RANGE];
        axes.lip = upward(index) * params[SET_LIP_RANGE];
        axes.sneer = upward(-index) * params[SET_SNEER_RANGE];
        axes.width = spanned(spread, params[SET_WIDE_RANGE], params[SET_NARROW_RANGE]);
        axes.corner = spanned(little, params[SET_CORNER_SMILE], params[SET_CORNER_FROWN]);
        axes.jaw_lateral = yaw * params[SET_ASIDE_RANGE];
        axes.jaw_forward = pitch * params[SET_ARC_FORWARD];
    } else if (layer == LAYER_BROWS) {
        axes.lid = thumb;
        axes.brow = spanned(index, params[SET_BROW_UP], params[SET_BROW_DOWN]);
        axes.tilt = spread * params[SET_TILT_RANGE];
        axes.squint = upward(little);
        axes.gaze_yaw = yaw * rad_per_deg * params[SET_ARC_GAZE_YAW];
        axes.gaze_pitch = -pitch * rad_per_deg * params[SET_ARC_GAZE_PITCH];
    } else {
        double both = curve_limit(pitch - index, 1.0, 1.0);
        axes.nod = both * rad_per_deg * params[SET_HEAD_NOD];
        axes.turn = yaw * rad_per_deg * params[SET_HEAD_TURN];
    }
    pose_from_axes(out, &axes, params);
}
