/* stage/mapping/answers.h - what a mapping answered step by step, to be given again where it may
 * not be asked: on the frame thread, when it runs in a process of its own. Leaves out who asks
 * (layer.h), and for which steps (replay.h). */
#ifndef MAROTTE_STAGE_ANSWERS_H
#define MAROTTE_STAGE_ANSWERS_H
#include "base/bytes.h"

#include <marotte/plugin.h>

/* A pull as bytes. The mapping sees the whole array: also vectors beyond `count` are kept, up to
 * the last one that is not zero; take returns how many. */
void answers_put_pull(bytes_out *out, const mrt_pull *pull);
uint32_t answers_take_pull(bytes_in *in, mrt_pull *out);

typedef struct answers_step {
    int64_t time_ns;
    size_t at; /* of its pull in `bytes` */
    mrt_result result;
    bool is_taught; /* in this step it said what it was taught, if it was asked */
} answers_step;

typedef struct answers { /* zeroed memory: none, to be written down */
    bool is_given;       /* the mapping is not asked */
    bool is_taught;      /* of the step that is written down */
    bool is_full;        /* there was no memory: the last ones are missing */
    answers_step *of;    /* by time */
    size_t count, capacity, next;
    unsigned char *bytes;
    size_t size, bytes_capacity;
} answers;

void answers_finish(answers *self);
/* [main] The answer to the next step. */
void answers_add(answers *self, int64_t time_ns, mrt_result result, const mrt_pull *pull);
/* [frame] NULL: it was not asked at this time. */
const answers_step *answers_find(answers *self, int64_t time_ns);
/* [frame] Of that step, once; where it was not asked it holds. */
mrt_result answers_take(answers *self, int64_t time_ns, mrt_pull *pull);
size_t answers_size(const answers *self); /* bytes in use */

#endif
