/* stage/voice/phones.h - the sounds of a voice with their times, which "Mouth from this voice"
 * turns into visemes (mouth.h). Where the words are known, pocketsphinx finds them (recogniser.h).
 * Without words its sounds and the spectrum (hearing.h) count together; where it is not built in or
 * its model is missing, the spectrum alone. Memory is some 60 bytes for each 10 ms: the voice is
 * read in parts of at most 15 s that end at pauses.
 * Leaves out where the voice comes from. Any thread that may block; one call at a time in a
 * program, because pocketsphinx has global state. */
#ifndef MAROTTE_STAGE_VOICE_PHONES_H
#define MAROTTE_STAGE_VOICE_PHONES_H
#include "stage/voice/phone_list.h"

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
