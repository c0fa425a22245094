/* cyberglove/glove_why.h - one line that says what failed and what to do. Any thread. */
#ifndef MAROTTE_CYBERGLOVE_WHY_H
#define MAROTTE_CYBERGLOVE_WHY_H
#include <marotte/plugin.h>

typedef struct glove_why {
    char text[800];
} glove_why;

/* Writes the text, cut if too long, and returns `code`. */
__attribute__((format(printf, 3, 4))) mrt_result glove_why_set(glove_why *out, mrt_result code,
                                                               const char *format, ...);
/* "53 12 ff": as many of the bytes as fit, "nothing" if there are none. */
void glove_why_hex(char *out, size_t capacity, const unsigned char *bytes, size_t count);

#endif
