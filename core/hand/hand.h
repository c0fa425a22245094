/* hand/hand.h - from what a glove measures to where the fingertips are: calibrate (raw -> rad),
 * filter (filter.h, landmark_filter.h), pose (rad -> mm by forward kinematics).
 * Angles are in the sensor order of plugin.h (MRT_CH_ANGLE), rad:
 *   flexion positive towards the palm; abduction positive = fingers spread; thumb roll positive =
 *   across the palm; wrist pitch positive = flexion (palm side), wrist yaw positive = radial side.
 *   The three spreads are between neighbours: middle-index, ring-middle, little-ring.
 *   All zero is a flat hand with straight, parallel fingers and the thumb in the plane of the palm
 *   beside the index finger; a relaxed thumb has a roll of about 0.6.
 * The hand frame of plugin.h: origin wrist, +z along the fingers, +y out of the back of the hand,
 * so the right thumb is at +x and the left one at -x. [frame] everything but load: no allocation.
 */
#ifndef MAROTTE_HAND_HAND_H
#define MAROTTE_HAND_HAND_H
#include "base/error.h"
#include "base/rigid.h"

/* Piecewise-linear table per sensor, extended by its end slopes. */
enum { HAND_TABLE_MAX = 16 };
typedef struct hand_table {
    uint32_t count;                                 /* 0: raw is already rad */
    float raw[HAND_TABLE_MAX], rad[HAND_TABLE_MAX]; /* raw strictly ascending */
} hand_table;

enum { HAND_INPUT = 32 };
typedef struct hand_calibration {
    /* Whose angles in rad it is made from, "camera": the first word of the input's name (input.h).
     * "": from the counts of a glove. */
    char input[HAND_INPUT];
    hand_table sensor[MRT_ANGLES];
    /* false: the distal joint (index..little) is estimated from the middle one. Both functions
     * below say true: who knows that the glove has 18 sensors says otherwise. */
    bool has_distal[4];
    float neutral_rad[MRT_ANGLES]; /* the hand relaxed, ready to talk: what a re-zero leads to */
} hand_calibration;

/* Raw is rad: recorded logs. */
void hand_calibration_identity(hand_calibration *out);
/* The plausible hand for an uncalibrated glove that gives counts. */
void hand_calibration_default(hand_calibration *out);

/* raw: MRT_ANGLES values; out_rad likewise, within +-pi. Non-finite raw gives the sensor's middle
 * value. */
void hand_calibrate(const hand_calibration *calibration, const float *raw, float *out_rad);

/* The table alone, as hand_calibrate reads it; count > 0. */
double hand_table_value(const hand_table *table, double raw);
/* What a finger's end joint does when its middle joint does so. */
float hand_distal_from_middle(float middle_rad);

/* Lengths and rest positions of one hand: the default shape, which nothing changes afterwards.
 * hand_length_mm: wrist to the tip of the straight middle finger. */
enum { HAND_LENGTH_MIN_MM = 50, HAND_LENGTH_MM = 190, HAND_LENGTH_MAX_MM = 400 };
typedef struct hand_skeleton hand_skeleton;
/* side: MRT_LEFT, MRT_RIGHT. NULL: no memory, or a length or side that is none. */
hand_skeleton *hand_skeleton_create(uint32_t side, double hand_length_mm);
void hand_skeleton_destroy(hand_skeleton *skeleton);

/* Joints and palm points in mm for the angles, the hand moved by `wrist` (identity: untracked).
 * Always from the default shape. A left hand is the exact mirror image (x -> -x) of a right one.
 * Non-finite angles count as 0.
 * out_joint: MRT_JOINTS: wrist, then CMC, MCP, IP, tip of the thumb and MCP, PIP, DIP, tip of the
 * index .. little finger. out_palm: MRT_PALM points of the palmar skin: heel of the hand, thenar
 * eminence, hypothenar eminence, hollow, and the pads below index, middle, ring, little finger. */
void hand_pose(const hand_skeleton *skeleton, const float *angle_rad, const rigid *wrist,
               mrt_vec3 *out_joint, mrt_vec3 *out_palm);

/* ---- and back: from points that a camera or a headset sees to angles ---- */

/* The joints of hand_pose, seen in any frame and unit: MediaPipe's 21 landmarks in their order;
 * OpenXR's and WebXR's without the palm and the metacarpals of index to little. */
typedef struct hand_landmarks {
    mrt_vec3 at[MRT_JOINTS];
    uint32_t doubtful; /* bit i: joint i is hidden or guessed and is not used; as if not finite */
} hand_landmarks;

typedef struct hand_reading {
    float angle_rad[MRT_ANGLES]; /* the wrist's two are 0: no forearm is seen */
    rigid wrist;                 /* from the hand frame to the landmarks': their unit */
    double size;                 /* of the palm, over the skeleton's */
    double misfit;               /* how far the palm is off the skeleton's, root mean square, over
                                    its size: about 0.03 for 2 mm */
    /* 0..1; below 0.5 nothing of this should move a face: hold it. 0 when the palm cannot be told,
     * is nothing like a palm, or bends like one of the other side. */
    double confidence;
} hand_reading;

/* In closed form and without bone lengths, so a hand of any size and proportions will do: the palm
 * is laid on the skeleton's six points (wrist, base of the thumb, four knuckles), the arch being
 * free; then each finger is read in its own frame. `reading` holds what was read last, or zeros,
 * and what cannot be told now is kept: joints beside doubtful landmarks, the spread of a finger
 * that is bent beyond 70 degrees, the roll of a thumb that lies at the index finger. Nothing but
 * the confidence changes when that is 0. */
void hand_read(const hand_skeleton *skeleton, const hand_landmarks *seen, hand_reading *reading);

#endif
