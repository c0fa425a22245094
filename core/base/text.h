/* base/text.h - strict reading of numbers and lines from bytes that nobody has checked.
 * Independent of the locale; never reads past `end`; bytes need not be 0-ended. Pure. */
#ifndef MAROTTE_BASE_TEXT_H
#define MAROTTE_BASE_TEXT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A piece of text inside somebody else's bytes. */
typedef struct text_view {
    const char *at, *end;
} text_view;

text_view text_view_of(const void *data, size_t size);

/* Takes the next line (ended by \n, \r\n or the end) off `rest`; false at the end. */
bool text_next_line(text_view *rest, text_view *out_line);
/* Takes the next run of non-blank bytes off `rest`; false when only blanks are left. */
bool text_next_word(text_view *rest, text_view *out_word);
/* Takes what is before the next `separator` (or the rest) off `rest`, trimmed of blanks; false
 * once the rest is used up. "a,,b" gives "a", "", "b". */
bool text_next_field(text_view *rest, char separator, text_view *out_field);
text_view text_trim(text_view text);
bool text_equals(text_view text, const char *word);

/* What came from outside (a file, a device, the network) and will be shown to a person passes one
 * of these where it is read. Printable is UTF-8 without what steers a terminal or a reader's eye:
 * control characters (C0, DEL, C1; so newlines and tabs too), marks and overrides of the writing
 * direction, line and paragraph separators, invisible tags. */
bool text_is_printable(text_view text);
/* Cuts the text into a 0-ended buffer, at a whole letter; each letter that is not printable and
 * each byte that is no UTF-8 becomes a '?'. */
void text_copy(char *out, size_t capacity, text_view text);
void text_make_printable(char *text); /* the same in place; it never grows */

/* The whole word must be one decimal number, finite, within double (no hex, inf, nan). */
bool text_double(text_view word, double *out);
bool text_float(text_view word, float *out); /* finite as float */
/* The whole word must be a decimal integer within [-2^63, 2^63). */
bool text_int(text_view word, int64_t *out);

#endif
