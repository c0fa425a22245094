/* log_text.h - lines, fields and decimal numbers out of bytes that nobody has checked. Does not
 * depend on the locale, as strtod does; never reads past `end`. Pure. */
#ifndef MAROTTE_LOG_TEXT_H
#define MAROTTE_LOG_TEXT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LOG_REASON = 200 }; /* bytes of a text that says why something is refused */

typedef struct log_text {
    const char *at, *end;
} log_text;

/* Takes the next line off `rest`, trimmed of blanks and of its \r\n or \n; false at the end. */
bool log_text_line(log_text *rest, log_text *out_line);
/* Takes the next run of non-blank bytes off `rest`; false when only blanks are left. */
bool log_text_word(log_text *rest, log_text *out_word);
/* Takes what is before the next comma (or the rest) off `rest`, trimmed of blanks; false once the
 * rest is used up. "a,,b" gives "a", "", "b". */
bool log_text_field(log_text *rest, log_text *out_field);

bool log_text_starts_number(log_text text); /* with a digit, sign or point */
bool log_text_is(log_text text, const char *word);
/* Copies into a 0-ended buffer, cut to fit; bytes that do not print become '?'. */
void log_text_copy(char *out, size_t capacity, log_text text);

/* The whole text must be one decimal number: [+-]digits[.digits][e[+-]digits]. At most 17
 * significant digits count; the magnitude must be below 1e30. */
bool log_text_number(log_text text, double *out);
/* Within +-LOG_INTEGER_MAX: the difference of any two is an int64_t. */
bool log_text_integer(log_text text, int64_t *out);
#define LOG_INTEGER_MAX INT64_C(4000000000000000000)

#endif
