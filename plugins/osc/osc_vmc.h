/* plugins/osc/osc_vmc.h - finger bones of the VMC protocol as the angles of a glove. A bone's turn
 * counts from the VRM T-pose in Unity's left-handed axes: +y up, +z forward, the palms down, the
 * right fingers along +x and the left ones along -x, thumbs level and half way between fingers and
 * +z. There a right finger bends about -z and turns to the thumb's side about -y; a right thumb
 * bends about +y, and its base goes across the palm about +x; a left hand mirrors this (x and the
 * turns about y and z change sign).
 * Taken: wrist flexion and deviation, flexion of every joint, the knuckles' spread, the base of the
 * thumb (across and aside). Not taken: positions, twists of fingers and wrist. Pure. */
#ifndef MAROTTE_OSC_VMC_H
#define MAROTTE_OSC_VMC_H
#include <marotte/plugin.h>

enum {
    OSC_VMC_THUMB = 0,
    OSC_VMC_INDEX,
    OSC_VMC_MIDDLE,
    OSC_VMC_RING,
    OSC_VMC_LITTLE,
    OSC_VMC_HAND
};
typedef struct osc_vmc_bone {
    uint32_t side;   /* MRT_LEFT, MRT_RIGHT */
    uint32_t finger; /* OSC_VMC_* */
    uint32_t joint;  /* 0 Proximal, 1 Intermediate, 2 Distal; 0 for the hand;
                        OSC_VMC_METACARPAL of a thumb, until it is settled */
} osc_vmc_bone;
enum { OSC_VMC_METACARPAL = 3 };

/* "LeftIndexProximal", "RightHand"; case counts. False: not a bone of a hand. */
bool osc_vmc_bone_find(osc_vmc_bone *out, const char *name);

/* What a hand is by its bones: the sensors' angles, and where each knuckle points. */
typedef struct osc_vmc_pose {
    double aside_rad[4]; /* index..little: turned to the thumb's side */
    bool is_vrm1;        /* the thumb's bones are called Metacarpal, Proximal, Distal */
} osc_vmc_pose;

/* VRM 1 calls the thumb's Proximal Metacarpal and its Intermediate Proximal: which is meant is told
 * by the names that are heard. Afterwards joint is 0..2. */
void osc_vmc_settle(osc_vmc_pose *pose, osc_vmc_bone *bone);

/* xyzw: of a length that is not near 0. angle_rad: MRT_ANGLES, those that depend on the bone. */
void osc_vmc_apply(osc_vmc_pose *pose, const osc_vmc_bone *bone, const float *xyzw,
                   float *angle_rad);

#endif
