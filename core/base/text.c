#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER_LENGTH_MAX = 127 };

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || c == '\0';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

text_view text_view_of(const void *data, size_t size)
{
    const char *at = data;
    return (text_view){at, at + size};
}

char *text_duplicate(const char *text, size_t length)
{
    const char *end = memchr(text, '\0', length);
    const size_t used = end ? (size_t)(end - text) : length;
    char *out = malloc(used + 1);
    if (!out)
        return NULL;
    memcpy(out, text, used);
    out[used] = '\0';
    return out;
}

bool text_next_line(text_view *rest, text_view *out_line)
{
    if (rest->at == rest->end)
        return false;
    const char *newline = memchr(rest->at, '\n', (size_t)(rest->end - rest->at));
    const char *stop = newline ? newline : rest->end;
    *out_line = (text_view){rest->at, stop};
    if (out_line->end > out_line->at && out_line->end[-1] == '\r')
        out_line->end -= 1;
    rest->at = newline ? newline + 1 : rest->end;
    return true;
}

bool text_next_word(text_view *rest, text_view *out_word)
{
    while (rest->at < rest->end && is_blank(*rest->at))
        rest->at += 1;
    if (rest->at == rest->end)
        return false;
    out_word->at = rest->at;
    while (rest->at < rest->end && !is_blank(*rest->at))
        rest->at += 1;
    out_word->end = rest->at;
    return true;
}

bool text_next_field(text_view *rest, char separator, text_view *out_field)
{
    if (!rest->at)
        return false;
    const char *stop =
        rest->at < rest->end ? memchr(rest->at, separator, (size_t)(rest->end - rest->at)) : NULL;
    *out_field = text_trim((text_view){rest->at, stop ? stop : rest->end});
    rest->at = stop ? stop + 1 : NULL;
    return true;
}

text_view text_trim(text_view text)
{
    while (text.at < text.end && is_blank(*text.at))
        text.at += 1;
    while (text.end > text.at && is_blank(text.end[-1]))
        text.end -= 1;
    return text;
}

bool text_equals(text_view text, const char *word)
{
    size_t length = strlen(word);
    return (size_t)(text.end - text.at) == length && memcmp(text.at, word, length) == 0;
}

/* ---- printable text ---- */

/* Returns the length in bytes of the letter at `at`, and the letter; 0: not UTF-8 (Unicode 15,
 * table 3-7). */
static size_t utf8_letter(const unsigned char *at, const unsigned char *end, uint32_t *out)
{
    size_t length = *at < 0x80                  ? 1
                    : *at >= 0xc2 && *at < 0xe0 ? 2
                    : *at >= 0xe0 && *at < 0xf0 ? 3
                    : *at >= 0xf0 && *at < 0xf5 ? 4
                                                : 0;
    if (length == 0 || (size_t)(end - at) < length)
        return 0;
    uint32_t letter = length == 1 ? *at : *at & (0x7fu >> length);
    for (size_t i = 1; i < length; ++i) {
        if ((at[i] & 0xc0) != 0x80)
            return 0;
        letter = letter << 6 | (at[i] & 0x3fu);
    }
    static const uint32_t shortest[] = {0, 0, 0x80, 0x800, 0x10000};
    if (letter < shortest[length] || letter > 0x10ffff || (letter >= 0xd800 && letter < 0xe000))
        return 0;
    *out = letter;
    return length;
}

static bool is_shown(uint32_t letter)
{
    static const struct {
        uint32_t first, last;
    } hidden[] = {
        {0x00, 0x1f},     {0x7f, 0x9f},     {0x061c, 0x061c}, {0x200e, 0x200f},   {0x2028, 0x202e},
        {0x2066, 0x2069}, {0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe007f},
    };
    for (size_t i = 0; i < sizeof hidden / sizeof hidden[0]; ++i)
        if (letter >= hidden[i].first && letter <= hidden[i].last)
            return false;
    return true;
}

/* Removes the next letter from `rest`. *out_kept: number of its bytes; 0: it is replaced by '?'. */
static void next_letter(text_view *rest, size_t *out_kept)
{
    uint32_t letter;
    size_t length =
        utf8_letter((const unsigned char *)rest->at, (const unsigned char *)rest->end, &letter);
    *out_kept = length > 0 && is_shown(letter) ? length : 0;
    rest->at += length > 0 ? length : 1;
}

bool text_is_printable(text_view text)
{
    size_t kept = 1;
    while (text.at < text.end && kept > 0)
        next_letter(&text, &kept);
    return kept > 0;
}

/* out may be the place of the text itself. */
static char *write_printable(char *out, const char *out_end, text_view text)
{
    while (text.at < text.end) {
        const char *from = text.at;
        size_t kept;
        next_letter(&text, &kept);
        if ((size_t)(out_end - out) < (kept ? kept : 1))
            break;
        if (kept > 0)
            memmove(out, from, kept);
        else
            *out = '?';
        out += kept ? kept : 1;
    }
    return out;
}

void text_copy(char *out, size_t capacity, text_view text)
{
    *write_printable(out, out + capacity - 1, text) = '\0';
}

void text_make_printable(char *text)
{
    size_t length = strlen(text);
    *write_printable(text, text + length, text_view_of(text, length)) = '\0';
}

/* Accepts [+-] digits [. digits] [eE [+-] digits], with at least one digit in the mantissa. */
static bool is_decimal(text_view word)
{
    const char *at = word.at;
    if (at < word.end && (*at == '+' || *at == '-'))
        at += 1;
    int digits = 0;
    while (at < word.end && is_digit(*at))
        at += 1, digits += 1;
    if (at < word.end && *at == '.')
        at += 1;
    while (at < word.end && is_digit(*at))
        at += 1, digits += 1;
    if (digits == 0)
        return false;
    if (at < word.end && (*at == 'e' || *at == 'E')) {
        at += 1;
        if (at < word.end && (*at == '+' || *at == '-'))
            at += 1;
        if (at == word.end)
            return false;
        while (at < word.end && is_digit(*at))
            at += 1;
    }
    return at == word.end;
}

bool text_double(text_view word, double *out)
{
    size_t length = (size_t)(word.end - word.at);
    if (length == 0 || length > NUMBER_LENGTH_MAX || !is_decimal(word))
        return false;
    char buffer[NUMBER_LENGTH_MAX + 1];
    memcpy(buffer, word.at, length);
    buffer[length] = '\0';
    double value = strtod(buffer, NULL);
    if (!isfinite(value))
        return false;
    *out = value;
    return true;
}

bool text_float(text_view word, float *out)
{
    double value;
    if (!text_double(word, &value) || !isfinite((float)value))
        return false;
    *out = (float)value;
    return true;
}

bool text_int(text_view word, int64_t *out)
{
    const char *at = word.at;
    bool negative = at < word.end && *at == '-';
    if (at < word.end && (*at == '+' || *at == '-'))
        at += 1;
    if (at == word.end)
        return false;
    uint64_t value = 0;
    uint64_t limit = negative ? (uint64_t)1 << 63 : ((uint64_t)1 << 63) - 1;
    for (; at < word.end; ++at) {
        if (!is_digit(*at))
            return false;
        uint64_t digit = (uint64_t)(*at - '0');
        if (value > (limit - digit) / 10)
            return false;
        value = value * 10 + digit;
    }
    *out = negative ? (value == limit ? INT64_MIN : -(int64_t)value) : (int64_t)value;
    return true;
}
