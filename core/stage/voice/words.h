/* stage/voice/words.h - a typed text as words with pronunciations by the rules of English spelling.
 * Leaves out the dictionary (recogniser.h). Pure; any thread. */
#ifndef MAROTTE_STAGE_VOICE_WORDS_H
#define MAROTTE_STAGE_VOICE_WORDS_H
#include "stage/voice/phone_list.h"

enum { WORD_BYTES = 40, WORDS_MAX = 8192, WORD_SOUNDS = 64 };

typedef struct word_list {
    char (*word)[WORD_BYTES]; /* lower case, a to z and '; owned */
    uint32_t count;
} word_list;

/* Splits a text. Digits become words; marks and letters of other scripts separate words. Refuses a
 * text of more than PHONES_WORDS_BYTES or WORDS_MAX words, and one without a word. */
CHECKED mrt_result word_list_parse(word_list *out, const char *text, error *err);
void word_list_finish(word_list *list); /* accepts zeroed */

/* Spells a word as sounds, by rules. Returns their number, at least 1. */
uint32_t word_spell(phone_sound out[WORD_SOUNDS], const char *word);

#endif
