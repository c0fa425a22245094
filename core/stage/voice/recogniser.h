/* stage/voice/recogniser.h - speech recognition by pocketsphinx with the model of US English that
 * Debian has. Only recogniser.c uses pocketsphinx, and does nothing where that was missing when
 * marotte was built. Leaves out what becomes of the sounds. One thread at a time in a program. */
#ifndef MAROTTE_STAGE_VOICE_RECOGNISER_H
#define MAROTTE_STAGE_VOICE_RECOGNISER_H
#include "stage/voice/words.h"

#define RECOGNISER_PACKAGES "libpocketsphinx-dev and pocketsphinx-en-us"

typedef struct recogniser recogniser;

/* MRT_ERR_UNSUPPORTED: it was not built in, or its model is not installed; the error is half a
 * sentence that names the package. */
CHECKED mrt_result recogniser_open(recogniser **out, error *err);
void recogniser_close(recogniser *self); /* accepts NULL */

typedef struct recogniser_part { /* a part of a voice at PHONES_RATE_HZ */
    const int16_t *frame;
    size_t count;
    double at_s; /* time of its first frame */
} recogniser_part;

/* Appends the sounds of a part, without knowing its words. out_score: how well a frame fits them, a
 * logarithm. */
CHECKED mrt_result recogniser_listen(recogniser *self, const recogniser_part *part, phone_list *out,
                                     double *out_score, error *err);
/* Appends the sounds of a part in which words from `first` on are said: all of the rest where
 * `is_last`, else as many as fit. *out_next is the first word after it. MRT_END: the words do not
 * fit the part. */
CHECKED mrt_result recogniser_align(recogniser *self, const recogniser_part *part,
                                    const word_list *words, uint32_t first, bool is_last,
                                    uint32_t *out_next, phone_list *out, error *err);
/* Whether the dictionary has a word. */
bool recogniser_knows(recogniser *self, const char *word);

#endif
