/* one_hand/reading.h - what a hand says, as if it were a right one: joint angles, and where the
 * fingertips and the outer palm are as seen from the palm, so that the wrist does not move them.
 * Leaves out what it means for a face. [frame] */
#ifndef MAROTTE_PLUGINS_ONE_HAND_READING_H
#define MAROTTE_PLUGINS_ONE_HAND_READING_H
#include <marotte/plugin.h>

enum {
    READING_ANGLES = 0,                         /* MRT_ANGLES, deg */
    READING_TIPS = READING_ANGLES + MRT_ANGLES, /* thumb to little: x, y, z each, mm */
    READING_PALM = READING_TIPS + 5 * 3,        /* x, y, z, mm */
    READING_COUNT = READING_PALM + 3,
    READING_MIDDLE_KNUCKLE = READING_ANGLES + 7
};
typedef struct reading {
    double value[READING_COUNT];
} reading;

/* side: MRT_LEFT or MRT_RIGHT; a left hand gives the reading of its mirror image. False when the
 * hand holds a number that is none. */
bool reading_take(reading *out, const mrt_hand *hand, uint32_t side);
/* mean becomes the mean of count samples, of which sample is the last. Equal samples: no change. */
void reading_average(reading *mean, const reading *sample, uint32_t count);
reading reading_difference(const reading *a, const reading *b);
/* Whether a hand can be like this at all: for what was stored. */
bool reading_is_plausible(const reading *r);

/* What the fingers do together, deg, from the difference to the neutral reading. */
typedef struct reading_signals {
    double thumb_drop;   /* stretched and turned: away from the fingers of a talking hand */
    double thumb_aside;  /* abduction that does not go along with the drop */
    double index_lift;   /* knuckle stretched */
    double index_middle; /* index lifted more than middle */
    double middle_bend;  /* knuckle */
    double little_lift;  /* ring and little finger, mean */
    double ring_little;  /* ring lifted more than little */
    double spread;       /* mean of the three */
    double arch;
    double reach; /* middle joints stretched, mean of four */
    double wrist_pitch, wrist_yaw;
} reading_signals;
/* params: mrt_frame.params. thumb_aside: the thumb's abduction less what may follow its drop. */
reading_signals reading_signals_of(const reading *difference, const double *params);

#endif
