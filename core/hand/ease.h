/* hand/ease.h - smooths jumps within a quarter of a second: angles and a tracked wrist after a gap
 * in their samples (a device was lost and came back), and the offsets of a re-zero. Smoothstep in
 * sample time: a function of the samples alone. Also defines what a gap in the samples is. [frame];
 * no allocation. */
#ifndef MAROTTE_HAND_EASE_H
#define MAROTTE_HAND_EASE_H
#include <marotte/plugin.h>

/* After a longer gap the earlier samples are obsolete. */
#define HAND_GAP_NS 250000000LL

/* A step backwards in time also counts as a gap. */
static inline bool hand_is_gap(int64_t last_ns, int64_t time_ns)
{
    return time_ns < last_ns || (uint64_t)time_ns - (uint64_t)last_ns > (uint64_t)HAND_GAP_NS;
}

#define EASE_SPAN_NS 250000000LL /* duration of an ease */

enum { EASE_WRIST = 7 }; /* x y z in mm, orientation x y z w: as MRT_CH_WRIST */

/* Returns the progress of an ease: 0 up to time 0, 1 from EASE_SPAN_NS on, 3 s^2 - 2 s^3
 * between. */
double ease_share(int64_t elapsed_ns);

/* The start of an ease, and whether one is active. Zeroed: nothing was shown yet. */
typedef struct ease_clock {
    bool has_shown, is_easing;
    int64_t last_ns, start_ns;
} ease_clock;

typedef struct ease_angles {
    ease_clock clock;
    float last[MRT_ANGLES], from[MRT_ANGLES];
} ease_angles;
/* Replaces measured values by shown values, in place. The first sample is shown unchanged. The
 * first one after a gap is shown like the last one before it. */
void ease_angles_apply(ease_angles *ease, float *angle_rad, int64_t time_ns);

typedef struct ease_wrist {
    ease_clock clock;
    float last[EASE_WRIST], from[EASE_WRIST];
} ease_wrist;
/* The same for a wrist. Orientations are interpolated along the shorter arc and normalised. An
 * orientation without length is replaced by the last one. */
void ease_wrist_apply(ease_wrist *ease, float *wrist, int64_t time_ns);

/* Offsets that are set at one time and reached after one ease. Zeroed: none. */
typedef struct ease_offset {
    int64_t start_ns;
    float from_rad[MRT_ANGLES], to_rad[MRT_ANGLES];
} ease_offset;
void ease_offset_set(ease_offset *offset, const float *to_rad, int64_t time_ns);
void ease_offset_add(const ease_offset *offset, float *angle_rad, int64_t time_ns);

#endif
