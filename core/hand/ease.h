/* hand/ease.h - values that change in one step are shown going there smoothly within a quarter of a
 * second: angles and a tracked wrist after a gap in their samples (a device was lost and came
 * back), and the offsets of a re-zero. Smoothstep in sample time: a function of the samples
 * alone. And when the samples of a hand have broken off. [frame]; no allocation. */
#ifndef MAROTTE_HAND_EASE_H
#define MAROTTE_HAND_EASE_H
#include <marotte/plugin.h>

/* After a longer silence what was before says nothing about now. */
#define HAND_GAP_NS 250000000LL

/* A step backwards in time is as much a break as a silence. */
static inline bool hand_is_gap(int64_t last_ns, int64_t time_ns)
{
    return time_ns < last_ns || (uint64_t)time_ns - (uint64_t)last_ns > (uint64_t)HAND_GAP_NS;
}

#define EASE_SPAN_NS 250000000LL /* how long it takes */

enum { EASE_WRIST = 7 }; /* x y z in mm, orientation x y z w: as MRT_CH_WRIST */

/* How far an ease has come: 0 at 0 and before, 1 from EASE_SPAN_NS on, 3 s^2 - 2 s^3 between. */
double ease_share(int64_t elapsed_ns);

/* When an ease began, and whether one goes on. All zero: nothing was shown yet. */
typedef struct ease_clock {
    bool has_shown, is_easing;
    int64_t last_ns, start_ns;
} ease_clock;

typedef struct ease_angles {
    ease_clock clock;
    float last[MRT_ANGLES], from[MRT_ANGLES];
} ease_angles;
/* In place: what is measured becomes what is shown. The first sample is shown as it is; the first
 * after a gap is shown as the last one was. */
void ease_angles_apply(ease_angles *ease, float *angle_rad, int64_t time_ns);

typedef struct ease_wrist {
    ease_clock clock;
    float last[EASE_WRIST], from[EASE_WRIST];
} ease_wrist;
/* As above; orientations the short way round, normalised. One of no length is shown as the last. */
void ease_wrist_apply(ease_wrist *ease, float *wrist, int64_t time_ns);

/* Offsets that were set at one moment and are reached an ease later. All zero: none. */
typedef struct ease_offset {
    int64_t start_ns;
    float from_rad[MRT_ANGLES], to_rad[MRT_ANGLES];
} ease_offset;
void ease_offset_set(ease_offset *offset, const float *to_rad, int64_t time_ns);
void ease_offset_add(const ease_offset *offset, float *angle_rad, int64_t time_ns);

#endif
