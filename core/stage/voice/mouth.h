/* stage/voice/mouth.h - a mouth that says sounds: how much of each viseme at each time, and how
 * much the jaw and the lips make of it. Leaves out where the sounds come from (phones.h) and the
 * show (voice_mouth.h).
 *
 * Each sound becomes a key: a mixture of visemes that is reached some 60 to 120 ms before the
 * middle of the sound, held, and left for the next one (smoothstep between). Weak keys take on what
 * their neighbours are (coarticulation). Lips that close (m b p) and teeth on the lip (f v) are
 * reached in full whatever surrounds them. Pauses return to rest. Vowels open the jaw more where
 * the voice is louder: jaw and lips are two axes, as in JALI (Edwards et al., 2016). Pure. */
#ifndef MAROTTE_STAGE_VOICE_MOUTH_H
#define MAROTTE_STAGE_VOICE_MOUTH_H
#include "stage/voice/phone_list.h"

typedef enum mouth_viseme { /* without "sil", which is rest */
                            MOUTH_PP = 0,
                            MOUTH_FF,
                            MOUTH_TH,
                            MOUTH_DD,
                            MOUTH_KK,
                            MOUTH_CH,
                            MOUTH_SS,
                            MOUTH_NN,
                            MOUTH_RR,
                            MOUTH_AA,
                            MOUTH_E,
                            MOUTH_I,
                            MOUTH_O,
                            MOUTH_U,
                            MOUTH_VISEMES
} mouth_viseme;
extern const char *const mouth_pose_name[MOUTH_VISEMES]; /* "viseme_PP" */

typedef struct mouth_key {
    double reached_s, left_s;
    double firmness; /* 0: as its neighbours are; 1: as it is */
    bool is_closure; /* m b p f v */
    double jaw;
    double amount[MOUTH_VISEMES]; /* 0..1 each, at most 1 together */
} mouth_key;

typedef struct mouth {
    mouth_key *key; /* in time order; owned */
    uint32_t count;
} mouth;

typedef struct mouth_shape {
    double amount[MOUTH_VISEMES];
    double jaw, lips; /* channels of a palette, 1: as the poses are */
} mouth_shape;

CHECKED mrt_result mouth_create(mouth *out, const phone_list *sounds, error *err);
void mouth_finish(mouth *self); /* accepts zeroed */
/* jaw, lips: 0..2, how much of the two axes. Closures close whatever they are. */
mouth_shape mouth_at(const mouth *self, double time_s, double jaw, double lips);

#endif
