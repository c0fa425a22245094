/* base/text.h - strict reading of numbers and lines from untrusted bytes. Independent of the
 * locale. Never reads past `end`; the bytes need not be 0-ended. Pure. */
#ifndef MAROTTE_BASE_TEXT_H
#define MAROTTE_BASE_TEXT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A part of untrusted bytes. */
typedef struct text_view {
    const char *at, *end;
} text_view;

text_view text_view_of(const void *data, size_t size);
/* Copies at most `length` letters; the caller frees it. NULL: no memory. */
char *text_duplicate(const char *text, size_t length);

/* Removes the next line (ended by \n, \r\n or the end) from `rest`. Returns false at the end. */
bool text_next_line(text_view *rest, text_view *out_line);
/* Removes the next run of non-blank bytes from `rest`. Returns false if only blanks are left. */
bool text_next_word(text_view *rest, text_view *out_word);
/* Removes the text before the next `separator` (or the rest) from `rest`, and trims blanks. Returns
 * false after the last field. "a,,b" gives "a", "", "b". */
bool text_next_field(text_view *rest, char separator, text_view *out_field);
text_view text_trim(text_view text);
bool text_equals(text_view text, const char *word);

/* Text from outside (a file, a device, the network) must pass one of these functions where it is
 * read, before it is shown. Printable text is UTF-8 without characters that control a terminal or
 * mislead a reader: control characters (C0, DEL, C1, so also newlines and tabs), marks and
 * overrides of the writing direction, line and paragraph separators, invisible tags. */
bool text_is_printable(text_view text);
/* Copies the text into a 0-ended buffer, cut at a whole letter. Replaces each unprintable letter
 * and each invalid byte by '?'. */
void text_copy(char *out, size_t capacity, text_view text);
void text_make_printable(char *text); /* the same in place; the text never grows */

/* Accepts a word that is one finite decimal number in the range of double (no hex, inf, nan). */
bool text_double(text_view word, double *out);
bool text_float(text_view word, float *out); /* must be finite as float */
/* Accepts a word that is a decimal integer within [-2^63, 2^63). */
bool text_int(text_view word, int64_t *out);

#endif
