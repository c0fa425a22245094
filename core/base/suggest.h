/* base/suggest.h - "Did you mean": finds the known name that is most similar to a typed word. Pure,
 * except suggest_file, which lists a folder. [any thread that may block] */
#ifndef MAROTTE_BASE_SUGGEST_H
#define MAROTTE_BASE_SUGGEST_H
#include <stddef.h>
#include <stdint.h>

enum { SUGGEST_LENGTH = 256 };

typedef struct suggest {
    const char *word;          /* the typed word; the caller keeps it until suggest_question */
    uint32_t distance;         /* of `best` */
    char best[SUGGEST_LENGTH]; /* "": no name is similar enough */
} suggest;

/* Returns the number of edits that turn one word into the other: insert, delete, replace, swap two
 * neighbours (Damerau-Levenshtein, optimal string alignment). Ignores case. Returns UINT32_MAX for
 * words over 63 letters. */
uint32_t suggest_distance(const char *a, const char *b);

void suggest_begin(suggest *self, const char *word);
/* Keeps the name if it is more similar than all before. Similar enough: one edit for each three
 * letters, at most three edits. A name is also similar if it begins with the typed word, which must
 * have at least three letters. */
void suggest_consider(suggest *self, const char *name);

/* A text to append to a message: ". Did you mean \"puppet\"?"; "" without a name. */
typedef struct suggest_text {
    char text[SUGGEST_LENGTH + 32];
} suggest_text;
suggest_text suggest_question(const suggest *self);

/* The same for a path that does not exist: the most similar name in its folder, or "". */
suggest_text suggest_file(const char *path);
/* Considers all names in the folder ("": the working directory). */
void suggest_folder(suggest *self, const char *folder);

#endif
