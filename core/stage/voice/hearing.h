/* stage/voice/hearing.h - the sounds of a voice without its words, from its spectrum alone: a small
 * network with fixed weights says how likely each of a few groups of sounds is, every 10 ms, and
 * the likeliest sequence that does not flap is taken. Looks 0.15 s ahead and back. The groups are
 * those that a mouth tells apart: p, b and m are one. Leaves out parts, pauses and loudness
 * (phones.h). Its weights: tests/bench/voice_fit.c. Pure; any thread. */
#ifndef MAROTTE_STAGE_VOICE_HEARING_H
#define MAROTTE_STAGE_VOICE_HEARING_H
#include "stage/voice/phone_list.h"

typedef enum hearing_group {
    HEARING_REST = 0,
    HEARING_LIPS,  /* p b m */
    HEARING_TEETH, /* f v */
    HEARING_TONGUE,
    HEARING_TIP, /* t d */
    HEARING_BACK,
    HEARING_HUSH, /* sh zh ch jh */
    HEARING_HISS, /* s z */
    HEARING_NASAL,
    HEARING_R,
    HEARING_A,
    HEARING_SCHWA,
    HEARING_E,
    HEARING_I,
    HEARING_O,
    HEARING_U,
    HEARING_GROUPS
} hearing_group;

enum {
    HEARING_HOP = PHONES_RATE_HZ / 100,
    HEARING_WINDOW = 2 * HEARING_HOP, /* around the middle of the hop */
    HEARING_BANDS = 14,
    HEARING_MOMENTS = 15,
    HEARING_INPUTS = HEARING_BANDS * HEARING_MOMENTS,
    HEARING_HIDDEN = 56
};

/* One hop. hearing_measure gives dB; hearing_level makes them relative to the voice. */
typedef struct hearing_frame {
    float band[HEARING_BANDS];
} hearing_frame;

void hearing_measure(hearing_frame *out, const float sound[HEARING_WINDOW]);
/* Takes out the loudness of a whole voice and the colour of its microphone, in place. */
void hearing_level(hearing_frame *frame, size_t count);
/* What the network sees around a levelled frame. Beyond the ends the voice is silent. */
void hearing_look(float out[HEARING_INPUTS], const hearing_frame *frame, size_t count, size_t at);
/* The group of a sound; a short AH is a schwa. */
hearing_group hearing_group_of(phone_sound sound, double length_s);
/* Appends the sounds of the levelled frames from..end-1; their times are those of the voice. hints:
 * what another recogniser heard there, which counts as well; may be empty. */
CHECKED mrt_result hearing_listen(phone_list *out, const hearing_frame *frame, size_t count,
                                  size_t from, size_t end, const phone_list *hints, error *err);

#endif
