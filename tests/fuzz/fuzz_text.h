/* fuzz/fuzz_text.h - what every message must be, whatever file it speaks of: one line that says
 * something and cannot steer a terminal. */
#ifndef MAROTTE_FUZZ_TEXT_H
#define MAROTTE_FUZZ_TEXT_H
#include <stdbool.h>

/* A letter that a fixed width has cut in half is no harm. */
static inline bool fuzz_is_shown(const char *text)
{
    const unsigned char *at = (const unsigned char *)text;
    for (; *at; ++at)
        if (*at < 0x20 || *at == 0x7f || (at[0] == 0xc2 && at[1] >= 0x80 && at[1] < 0xa0))
            return false;
    return true;
}

static inline bool fuzz_is_reason(const char *text)
{
    return text[0] != '\0' && fuzz_is_shown(text);
}

#endif
