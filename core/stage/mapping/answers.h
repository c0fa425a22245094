/* stage/mapping/answers.h - stored answers of a mapping, one per step. They replace calls of an
 * isolated mapping where a call is not allowed, on the frame thread. Leaves out the caller
 * (layer.h) and the choice of the steps (replay.h). */
#ifndef MAROTTE_STAGE_ANSWERS_H
#define MAROTTE_STAGE_ANSWERS_H
#include "base/bytes.h"

#include <marotte/plugin.h>

/* Writes and reads a pull as bytes. The mapping sees the whole array, so vectors beyond `count` are
 * stored too, up to the last one that is not zero. answers_read_pull returns their number. */
void answers_write_pull(bytes_out *out, const mrt_pull *pull);
uint32_t answers_read_pull(bytes_in *in, mrt_pull *out);

typedef struct answers_step {
    int64_t time_ns;
    size_t at; /* position of the pull in `bytes` */
    mrt_result result;
    bool is_taught; /* the mapping reported its taught values in this step when it was called */
} answers_step;

typedef struct answers { /* zeroed memory: empty, ready for answers_add */
    bool is_given;       /* use the stored answers instead of calling the mapping */
    bool is_taught;      /* is_taught of the step that is being stored */
    bool is_full;        /* out of memory: the last answers are missing */
    answers_step *of;    /* by time */
    size_t count, capacity, next;
    unsigned char *bytes;
    size_t size, bytes_capacity;
} answers;

void answers_finish(answers *self);
/* [main] Appends the answer of the next step. */
void answers_add(answers *self, int64_t time_ns, mrt_result result, const mrt_pull *pull);
/* [frame] NULL: the answer for this time is missing. */
const answers_step *answers_find(answers *self, int64_t time_ns);
/* [frame] Reads the answer for this time, in time order. MRT_HOLD: it is missing. */
mrt_result answers_pop(answers *self, int64_t time_ns, mrt_pull *pull);
size_t answers_size(const answers *self); /* bytes in use */

#endif
