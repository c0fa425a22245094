#include "glove_reply.h"

#include <stdbool.h>
#include <string.h>

enum { TEXT_MAX = 24 };

static bool is_small_text(unsigned char byte)
{
    return byte == ' ' || byte == '\r' || byte == '\n' || (byte >= '0' && byte <= '9');
}

/* Whether spaces, ends of line, numbers and then a NUL follow. */
static bool ends_soon(const unsigned char *bytes, size_t count)
{
    for (size_t i = 0; i < count && i < TEXT_MAX; ++i) {
        if (bytes[i] == 0)
            return true;
        if (!is_small_text(bytes[i]))
            return false;
    }
    return false;
}

/* An answer stands at the start, or after what ended another. */
static bool may_start(const unsigned char *bytes, size_t at)
{
    return at == 0 || bytes[at - 1] == 0 || is_small_text(bytes[at - 1]);
}

static bool is_refusal(const unsigned char *bytes, size_t count, size_t at)
{
    return count - at > 2 && bytes[at] == 'e' && bytes[at + 1] != 0 &&
           strchr("?nysg", bytes[at + 1]) && may_start(bytes, at) &&
           ends_soon(bytes + at + 2, count - at - 2);
}

glove_reply glove_reply_value(const unsigned char *bytes, size_t count, char letter,
                              unsigned char *out_value, size_t value_size)
{
    for (size_t i = 0; i < count; ++i) {
        if (is_refusal(bytes, count, i))
            return GLOVE_REFUSED;
        if (bytes[i] != '?' || count - i < value_size + 3)
            continue;
        if (bytes[i + 1] != (unsigned char)letter || bytes[i + 2 + value_size] != 0)
            continue;
        memcpy(out_value, bytes + i + 2, value_size);
        return GLOVE_ANSWERED;
    }
    return GLOVE_SILENT;
}

glove_reply glove_reply_done(const unsigned char *bytes, size_t count, char letter)
{
    const unsigned char small = (unsigned char)(letter | 0x20), large = small & 0xDFu;
    for (size_t i = 0; i < count; ++i) {
        if (is_refusal(bytes, count, i))
            return GLOVE_REFUSED;
        if ((bytes[i] == small || bytes[i] == large) && may_start(bytes, i) &&
            ends_soon(bytes + i + 1, count - i - 1))
            return GLOVE_ANSWERED;
    }
    return GLOVE_SILENT;
}
