/* rigs/puppet/plan.h - the measures that several pieces of the puppet share, mm: where eyes, mouth
 * and hinge lie, the parts, and how fine the net of the skin is. Only numbers. */
#ifndef MAROTTE_RIGS_PUPPET_PLAN_H
#define MAROTTE_RIGS_PUPPET_PLAN_H
#include "base/angle.h"
#include "base/rigid.h"

typedef enum plan_part { /* in the order of the file; from EYE on left and right */
                         PLAN_PART_SKIN = 0,
                         PLAN_PART_LIPS,
                         PLAN_PART_NOSE,
                         PLAN_PART_MOUTH_BAG,
                         PLAN_PART_TEETH_UPPER,
                         PLAN_PART_GUM_UPPER,
                         PLAN_PART_TEETH_LOWER,
                         PLAN_PART_GUM_LOWER,
                         PLAN_PART_TONGUE,
                         PLAN_PART_HAIR,
                         PLAN_PART_COLLAR,
                         PLAN_PART_EYE,
                         PLAN_PART_IRIS,
                         PLAN_PART_PUPIL,
                         PLAN_PART_LID_UPPER,
                         PLAN_PART_LID_LOWER,
                         PLAN_PART_LASH_UPPER,
                         PLAN_PART_LASH_LOWER,
                         PLAN_PART_BROW,
                         PLAN_PART_EAR,
                         PLAN_PART_COUNT
} plan_part;

/* The half's net, in cells. The wall goes around the head from the middle of the face to the middle
 * of the nape, and up from the neck; the roof closes it like the lid of a box. */
enum {
    PLAN_FRONT = 20, /* columns from the middle of the face to the edge of the roof */
    PLAN_SIDE = 18,
    PLAN_AROUND = 2 * PLAN_FRONT + PLAN_SIDE,
    PLAN_MOUTH_COLUMNS = 18,
    PLAN_MOUTH_ROW = 20, /* its first row */
    PLAN_MOUTH_ROWS = 6,
    PLAN_NOSE_COLUMNS = 5,
    PLAN_NOSE_ROW = PLAN_MOUTH_ROW + PLAN_MOUTH_ROWS + 2,
    PLAN_NOSE_ROWS = 6,
    PLAN_EYE_COLUMN = 1,
    PLAN_EYE_CELLS = 14,
    PLAN_EYE_ROW = PLAN_NOSE_ROW + PLAN_NOSE_ROWS + 1,
    PLAN_UP = PLAN_EYE_ROW + PLAN_EYE_CELLS + 7
};

/* The left eye; lids turn about the line through it along x. */
static const vec3 PLAN_EYE = {37.5, 68.0, 62.0};
static const double PLAN_EYE_RADIUS = 25.0;
static const double PLAN_LID_INNER = 25.9, PLAN_LID_OUTER = 27.6;
static const double PLAN_SOCKET_RADIUS = 28.7;

/* The slit between the lips: its half width, and its height at the middle. */
static const double PLAN_MOUTH_REACH = 57.0, PLAN_MOUTH_Y = -38.0;
static const double PLAN_CORNER_RISE = 10.0; /* of the corners above the middle */

static const double PLAN_NECK_Y = -150.0, PLAN_NECK_Z = -27.0;

/* The way that the left socket opens. */
static inline vec3 plan_eye_axis(void)
{
    return vec3_normalised((vec3){0.05, 0.08, 1.0}, (vec3){0, 0, 1});
}

static inline angle_sincos plan_degrees(double angle_deg)
{
    return angle_sincos_of(angle_deg * (ANGLE_PI / 180.0));
}

#endif
