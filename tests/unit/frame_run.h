/* unit/frame_run.h - a step performed by one performer, as all ways perform it, without sinks. */
#ifndef MAROTTE_TESTS_FRAME_RUN_H
#define MAROTTE_TESTS_FRAME_RUN_H
#include "stage/perform/frame.h"

static inline void frame_run(performer *p, const sample_step *s)
{
    error err = {""};
    stage_frame f = {.performer = p, .step = *s};
    assert_int_equal(frame_step(&f, &err), MRT_OK);
}

#endif
