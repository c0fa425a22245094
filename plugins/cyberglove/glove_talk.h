/* cyberglove/glove_talk.h - questions and orders to a glove, each with a limit of its own and all
 * with one in common; given up early when the host stops. Leaves out what is asked. [main] [input].
 */
#ifndef MAROTTE_CYBERGLOVE_TALK_H
#define MAROTTE_CYBERGLOVE_TALK_H
#include "glove_port.h"
#include "glove_parse.h"

enum { GLOVE_HEARD_MAX = 1024, GLOVE_CTRL_C = 0x03, GLOVE_CTRL_R = 0x12 };

typedef struct glove_talk {
    glove_port *port;
    const mrt_host *host;
    double patience;     /* all limits, times this */
    int64_t deadline_ns; /* of the whole talk; glove_port_now_ns */
    bool is_gone, is_stopping;
    unsigned char heard[GLOVE_HEARD_MAX]; /* since the last question; the newest when it is full */
    size_t heard_count, heard_ever;
} glove_talk;

void glove_talk_init(glove_talk *self, glove_port *port, const mrt_host *host, double patience,
                     int64_t limit_ms);
/* Whether it makes sense to go on: neither gone, nor stopping, nor out of time. */
bool glove_talk_goes_on(const glove_talk *self);

void glove_talk_say(glove_talk *self, const void *bytes, size_t size);
/* Listens for so long; false: the talk is over. */
bool glove_talk_listen(glove_talk *self, int64_t limit_ms);
/* Listens until bytes have come or the limit is over; how many came. */
size_t glove_talk_hear(glove_talk *self, int64_t until_ns);
/* Listens until nothing has come for 40 ms, 200 ms at most, and forgets what was heard. */
void glove_talk_settle(glove_talk *self);

/* "?LETTER". A refusal is waited out. */
glove_reply glove_talk_ask(glove_talk *self, char letter, unsigned char *out_value,
                           size_t value_size, int64_t limit_ms);
/* The bytes of an order that is answered with its letter. */
glove_reply glove_talk_order(glove_talk *self, const void *bytes, size_t size, char letter,
                             int64_t limit_ms);

int64_t glove_talk_until(const glove_talk *self, int64_t limit_ms);

#endif
