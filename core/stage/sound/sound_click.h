/* stage/sound/sound_click.h - a click on each beat of the timeline, added to the blocks of a
 * loudspeaker: each begins with the frame that is heard at that instant, the first of a bar higher.
 * Beats count from 0 of the timeline on, and back from there: so a count-in falls on them too.
 * Never waits, allocates or calls the system. [device] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_CLICK_H
#define MAROTTE_STAGE_SOUND_CLICK_H
#include "stage/sound/sound_follow.h"

typedef struct sound_click {
    const sound_board *board; /* not owned */
    sound_motion motion;
    sound_clock clock;
    int64_t device_frame, beat; /* the last frame's beat; INT64_MIN: none */
    double at_ns;               /* on the timeline: of the last frame */
    uint32_t rate_hz, left;     /* frames of the click that is heard */
    double phase, step;         /* of its sine, radians */
    _Atomic uint64_t count;     /* [any] clicks since it was made */
} sound_click;

/* [opener] Before the first block of each opening. */
void sound_click_reset(sound_click *self, uint32_t rate_hz);
/* Adds what is heard to count frames of channels each, the first of which is heard at time_ns. */
void sound_click_add(sound_click *self, float *out, uint32_t count, uint32_t channels,
                     int64_t time_ns, sound_break is_broken);

#endif
