/* hand/hand.h - from the measurements of a glove to the positions of the fingertips: calibrate (raw
 * -> rad), filter (filter.h, landmark_filter.h), pose (rad -> mm by forward kinematics).
 * Angles are in the sensor order of plugin.h (MRT_CH_ANGLE), rad:
 *   flexion positive towards the palm; abduction positive = fingers spread; thumb roll positive =
 * across the palm; wrist pitch positive = flexion (palm side), wrist yaw positive = radial side.
 *   The three spreads are between neighbours: middle-index, ring-middle, little-ring.
 *   All zero is a flat hand with straight, parallel fingers and the thumb in the plane of the palm
 * beside the index finger; a relaxed thumb has a roll of about 0.6.
 * The hand frame of plugin.h: origin wrist, +z along the fingers, +y out of the back of the hand,
 * so the right thumb is at +x and the left one at -x. [frame] everything except loading: no
 * allocation. */
#ifndef MAROTTE_HAND_HAND_H
#define MAROTTE_HAND_HAND_H
#include "base/error.h"
#include "base/rigid.h"

/* A piecewise-linear table per sensor, extended by its end slopes. */
enum { HAND_TABLE_MAX = 16 };
typedef struct hand_table {
    uint32_t count;                                 /* 0: raw is already rad */
    float raw[HAND_TABLE_MAX], rad[HAND_TABLE_MAX]; /* raw strictly ascending */
} hand_table;

enum { HAND_INPUT = 32 };
typedef struct hand_calibration {
    /* Input whose angles in rad it corrects, "camera": the first word of the input's name
     * (input.h). "": the counts of a glove. */
    char input[HAND_INPUT];
    hand_table sensor[MRT_ANGLES];
    /* false: the distal joint (index..little) is estimated from the middle one. Both functions
     * below set true; a caller that knows of a glove with 18 sensors sets false. */
    bool has_distal[4];
    float neutral_rad[MRT_ANGLES]; /* the relaxed hand, ready to talk: the target of a re-zero */
} hand_calibration;

/* Makes a calibration for raw values in rad: recorded logs. */
void hand_calibration_identity(hand_calibration *out);
/* Makes a plausible calibration for an uncalibrated glove that delivers counts. */
void hand_calibration_default(hand_calibration *out);

/* raw, out_rad: MRT_ANGLES values; out_rad within +-pi. Non-finite raw gives the middle value of
 * the sensor. */
void hand_calibrate(const hand_calibration *calibration, const float *raw, float *out_rad);

/* Reads the table of one sensor like hand_calibrate; count > 0. */
double hand_table_value(const hand_table *table, double raw);
/* Returns the bend of a finger's end joint that belongs to this bend of its middle joint. */
float hand_distal_from_middle(float middle_rad);

/* Lengths and rest positions of one hand: the default shape, constant after creation.
 * hand_length_mm: from the wrist to the tip of the straight middle finger. */
enum { HAND_LENGTH_MIN_MM = 50, HAND_LENGTH_MM = 190, HAND_LENGTH_MAX_MM = 400 };
typedef struct hand_skeleton hand_skeleton;
/* side: MRT_LEFT, MRT_RIGHT. NULL: no memory, or an invalid length or side. */
hand_skeleton *hand_skeleton_create(uint32_t side, double hand_length_mm);
void hand_skeleton_destroy(hand_skeleton *skeleton);

/* Computes joints and palm points in mm for the angles. wrist moves the hand (identity: untracked).
 * The result depends only on the default shape and the arguments. A left hand is the exact mirror
 * image (x -> -x) of a right one. Non-finite angles count as 0.
 * out_joint: MRT_JOINTS: wrist, then CMC, MCP, IP, tip of the thumb and MCP, PIP, DIP, tip of the
 * index .. little finger. out_palm: MRT_PALM points on the skin of the palm: heel of the hand,
 * thenar eminence, hypothenar eminence, hollow, and the pads below index, middle, ring, little
 * finger. */
void hand_pose(const hand_skeleton *skeleton, const float *angle_rad, const rigid *wrist,
               mrt_vec3 *out_joint, mrt_vec3 *out_palm);

/* ---- the inverse: from points that a camera or a headset sees to angles ---- */

/* The joints of hand_pose, in any frame and unit: MediaPipe's 21 landmarks in their order; those of
 * OpenXR and WebXR without the palm and the metacarpals of index to little. */
typedef struct hand_landmarks {
    mrt_vec3 at[MRT_JOINTS];
    uint32_t doubtful; /* bit i: joint i is hidden or guessed, and is ignored like one that is not
                          finite */
} hand_landmarks;

typedef struct hand_reading {
    float angle_rad[MRT_ANGLES]; /* the two of the wrist are 0: the forearm is not seen */
    rigid wrist;                 /* from the hand frame to that of the landmarks, in their unit */
    double size;                 /* size of the palm, relative to the skeleton's */
    double misfit; /* root mean square distance from the skeleton's palm, relative to its size:
                      about 0.03 for 2 mm */
    /* 0..1; if it is below 0.5, hold the face. 0 if the palm is unknown, does not look like a palm,
     * or bends like one of the other side. */
    double confidence;
} hand_reading;

/* Reads the angles in closed form and without bone lengths, so a hand of any size and proportions
 * is possible. First it fits the six points of the skeleton's palm (wrist, base of the thumb, four
 * knuckles), with a free arch. Then it reads each finger in its own frame. `reading` holds the
 * previous result, or zeros. Angles that cannot be determined keep their previous values: joints
 * beside doubtful landmarks, the spread of a finger that is bent beyond 70 degrees, the roll of a
 * thumb beside the index finger. If the confidence is 0, only the confidence changes. */
void hand_read(const hand_skeleton *skeleton, const hand_landmarks *seen, hand_reading *reading);

#endif
