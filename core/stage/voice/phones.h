/* stage/voice/phones.h - the sounds of a voice with their times, which "Mouth from this voice"
 * turns into visemes (mouth.h). Pocketsphinx finds them, with the words that are said or without.
 * Where it is not built in or its model is missing, loudness and bands of the spectrum give a
 * coarser result. Memory is bounded: the voice is read in parts of at most 15 s that end at pauses.
 * Leaves out where the voice comes from. Any thread that may block; one call at a time in a
 * program, because pocketsphinx has global state. */
#ifndef MAROTTE_STAGE_VOICE_PHONES_H
#define MAROTTE_STAGE_VOICE_PHONES_H
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

typedef struct phones_source { /* one channel at PHONES_RATE_HZ */
    int64_t frame_count;
    mrt_result (*read)(void *data, int64_t first, float *out, size_t count, error *err);
    void *data;
} phones_source;

typedef struct phones_settings {
    const char *words; /* that are said; NULL or "": not known */
    /* Progress, 0..1; false cancels. NULL: none. */
    bool (*goes_on)(void *data, double part);
    void *data;
} phones_settings;

typedef struct phones_report {
    uint32_t sound_count; /* without pauses */
    uint32_t word_count, unknown_count;
    char unknown[160]; /* words that the dictionary lacks: "snood, marotte" */
    char note[320];    /* a sentence about a coarser result; "" */
} phones_report;

/* Finds the sounds. MRT_END: cancelled. Refuses silence and what is no voice. */
CHECKED mrt_result phones_find(phone_list *out, phones_report *report, const phones_source *from,
                               const phones_settings *settings, error *err);

#endif
