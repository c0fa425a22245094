/* cyberglove/glove_reply.h - what a CyberGlove answers to a question or an order, found among the
 * bytes that came. Values may be 0, so answers have a fixed length. Pure. */
#ifndef MAROTTE_CYBERGLOVE_REPLY_H
#define MAROTTE_CYBERGLOVE_REPLY_H
#include <stddef.h>

typedef enum glove_reply {
    GLOVE_SILENT = 0, /* nothing so far that answers it */
    GLOVE_ANSWERED,
    GLOVE_REFUSED /* "e?", "en", "ey", "es" or "eg" */
} glove_reply;

/* The answer to "?LETTER": '?' LETTER value NUL. */
glove_reply glove_reply_value(const unsigned char *bytes, size_t count, char letter,
                              unsigned char *out_value, size_t value_size);
/* The answer to an order: its letter, large or small, perhaps with text, and NUL. */
glove_reply glove_reply_done(const unsigned char *bytes, size_t count, char letter);

#endif
