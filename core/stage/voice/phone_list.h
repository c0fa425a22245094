/* stage/voice/phone_list.h - sounds of speech with their times. Leaves out how they are found
 * (phones.h) and what a mouth makes of them (mouth.h). Pure; any thread. */
#ifndef MAROTTE_STAGE_VOICE_PHONE_LIST_H
#define MAROTTE_STAGE_VOICE_PHONE_LIST_H
#include "base/error.h"

enum { PHONES_RATE_HZ = 16000, PHONES_WORDS_BYTES = 1 << 16 };

/* The sounds of the CMU dictionary; PHONE_REST is a pause. */
typedef enum phone_sound {
    PHONE_REST = 0, /* clang-format off */
    PHONE_AA, PHONE_AE, PHONE_AH, PHONE_AO, PHONE_AW, PHONE_AY, PHONE_B, PHONE_CH, PHONE_D, PHONE_DH,
    PHONE_EH, PHONE_ER, PHONE_EY, PHONE_F, PHONE_G, PHONE_HH, PHONE_IH, PHONE_IY, PHONE_JH, PHONE_K,
    PHONE_L, PHONE_M, PHONE_N, PHONE_NG, PHONE_OW, PHONE_OY, PHONE_P, PHONE_R, PHONE_S, PHONE_SH,
    PHONE_T, PHONE_TH, PHONE_UH, PHONE_UW, PHONE_V, PHONE_W, PHONE_Y, PHONE_Z, PHONE_ZH,
    PHONE_COUNT /* clang-format on */
} phone_sound;

extern const char *const phone_name[PHONE_COUNT]; /* "AA"; PHONE_REST: "_" */
bool phone_is_vowel(phone_sound sound);

typedef struct phone {
    double start_s, end_s;
    phone_sound sound;
    double effort; /* loudness, relative to the median of the voice's vowels: -1..1 is 12 dB */
} phone;

typedef struct phone_list { /* in time order, without gaps between the first and the last */
    phone *phone;           /* owned */
    uint32_t count;
} phone_list;
void phone_list_finish(phone_list *list); /* accepts zeroed */
CHECKED mrt_result phone_list_add(phone_list *list, phone_sound sound, double start_s, double end_s,
                                  error *err);

#endif
