/* base/suggest.h - "Did you mean": the known name that is nearest to a word that a person typed.
 * Pure, except suggest_file, which lists a folder. Any thread that may block. */
#ifndef MAROTTE_BASE_SUGGEST_H
#define MAROTTE_BASE_SUGGEST_H
#include <stddef.h>
#include <stdint.h>

enum { SUGGEST_LENGTH = 256 };

typedef struct suggest {
    const char *word;          /* the typed word; the caller's, until suggest_question */
    uint32_t distance;         /* of `best` */
    char best[SUGGEST_LENGTH]; /* "": nothing is near enough */
} suggest;

/* Edits that turn one word into the other: insert, delete, replace, swap two neighbours
 * (Damerau-Levenshtein, optimal string alignment). Letters differ by more than their case. Words
 * over 63 letters: UINT32_MAX. */
uint32_t suggest_distance(const char *a, const char *b);

void suggest_begin(suggest *self, const char *word);
/* Keeps the name if it is nearer than all before. Near enough is an edit for each three letters, at
 * most three, or a name that begins with three letters or more that were typed. */
void suggest_consider(suggest *self, const char *name);

/* To follow a message: ". Did you mean \"puppet\"?"; "" without a name. */
typedef struct suggest_text {
    char text[SUGGEST_LENGTH + 32];
} suggest_text;
suggest_text suggest_question(const suggest *self);

/* The same for a path that leads nowhere: the nearest name in its folder, or "". */
suggest_text suggest_file(const char *path);
/* Considers every name in the folder ("": the working directory). */
void suggest_folder(suggest *self, const char *folder);

#endif
