#include "log_text.h"

#include <string.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static log_text trimmed(log_text text)
{
    while (text.at < text.end && is_blank(*text.at))
        text.at += 1;
    while (text.end > text.at && is_blank(text.end[-1]))
        text.end -= 1;
    return text;
}

/* Takes what is before the next `separator` off `rest`. */
static log_text taken(log_text *rest, char separator)
{
    const char *stop = memchr(rest->at, separator, (size_t)(rest->end - rest->at));
    log_text piece = {rest->at, stop ? stop : rest->end};
    rest->at = stop ? stop + 1 : NULL;
    return trimmed(piece);
}

bool log_text_line(log_text *rest, log_text *out_line)
{
    if (!rest->at || rest->at == rest->end)
        return false;
    *out_line = taken(rest, '\n');
    return true;
}

bool log_text_field(log_text *rest, log_text *out_field)
{
    if (!rest->at)
        return false;
    *out_field = taken(rest, ',');
    return true;
}

bool log_text_word(log_text *rest, log_text *out_word)
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

bool log_text_starts_number(log_text text)
{
    return text.at < text.end && (is_digit(*text.at) || strchr("+-.", *text.at));
}

bool log_text_is(log_text text, const char *word)
{
    size_t length = strlen(word);
    return (size_t)(text.end - text.at) == length && memcmp(text.at, word, length) == 0;
}

void log_text_copy(char *out, size_t capacity, log_text text)
{
    size_t length = (size_t)(text.end - text.at);
    if (length > capacity - 1)
        length = capacity - 1;
    for (size_t i = 0; i < length; ++i)
        out[i] = text.at[i] >= 32 && text.at[i] < 127 ? text.at[i] : '?';
    out[length] = '\0';
}

/* ---- numbers: digits * 10^exponent ---- */

enum { DIGITS_MAX = 17, EXPONENT_MAX = 400 };

typedef struct decimal {
    uint64_t digits;
    int32_t digit_count, exponent;
} decimal;

/* A run of digits; those that no double could tell apart only move the exponent. False: none. */
static bool take_digits(log_text *text, decimal *number, int32_t exponent_per_digit)
{
    const char *first = text->at;
    for (; text->at < text->end && is_digit(*text->at); text->at += 1) {
        uint64_t digit = (uint64_t)(*text->at - '0');
        if (number->digit_count < DIGITS_MAX) {
            number->digits = number->digits * 10 + digit;
            number->digit_count += number->digits > 0;
            number->exponent += exponent_per_digit;
        } else if (number->exponent < EXPONENT_MAX) {
            number->exponent += exponent_per_digit + 1;
        }
    }
    return text->at > first;
}

static bool take_sign(log_text *text)
{
    bool negative = text->at < text->end && *text->at == '-';
    if (text->at < text->end && (*text->at == '-' || *text->at == '+'))
        text->at += 1;
    return negative;
}

static bool take_exponent(log_text *text, decimal *number)
{
    text->at += 1;
    bool negative = take_sign(text);
    int32_t exponent = 0;
    const char *first = text->at;
    for (; text->at < text->end && is_digit(*text->at); text->at += 1)
        if (exponent < EXPONENT_MAX)
            exponent = exponent * 10 + (*text->at - '0');
    number->exponent += negative ? -exponent : exponent;
    return text->at > first;
}

/* Exact for up to 15 digits and exponents within +-22, so that "0.1" is the double 0.1. */
static double decimal_value(const decimal *number)
{
    double value = (double)number->digits, power = 1.0;
    int32_t exponent = number->exponent;
    if (exponent < -60 || number->digits == 0)
        return 0.0;
    for (int32_t i = 0; i < (exponent < 0 ? -exponent : exponent); ++i)
        power *= 10.0;
    return exponent < 0 ? value / power : value * power;
}

bool log_text_number(log_text text, double *out)
{
    decimal number = {0, 0, 0};
    bool negative = take_sign(&text);
    bool has_digits = take_digits(&text, &number, 0);
    if (text.at < text.end && *text.at == '.') {
        text.at += 1;
        has_digits = take_digits(&text, &number, -1) || has_digits;
    }
    if (!has_digits)
        return false;
    if (text.at < text.end && (*text.at == 'e' || *text.at == 'E') &&
        !take_exponent(&text, &number))
        return false;
    if (text.at != text.end)
        return false;
    if (number.digits > 0 && number.digit_count + number.exponent > 30)
        return false;
    double value = decimal_value(&number);
    *out = negative ? -value : value;
    return true;
}

bool log_text_integer(log_text text, int64_t *out)
{
    bool negative = take_sign(&text);
    int64_t value = 0;
    const char *first = text.at;
    for (; text.at < text.end && is_digit(*text.at); text.at += 1) {
        int64_t digit = *text.at - '0';
        if (value > (LOG_INTEGER_MAX - digit) / 10)
            return false;
        value = value * 10 + digit;
    }
    *out = negative ? -value : value;
    return text.at == text.end && text.at > first;
}
