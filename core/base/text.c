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

void text_copy(char *out, size_t capacity, text_view text)
{
    size_t length = (size_t)(text.end - text.at);
    if (length > capacity - 1)
        length = capacity - 1;
    for (size_t i = 0; i < length; ++i)
        out[i] = text.at[i] >= 32 && text.at[i] < 127 ? text.at[i] : '?';
    out[length] = '\0';
}

/* [+-] digits [. digits] [eE [+-] digits], with at least one digit in the mantissa. */
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
