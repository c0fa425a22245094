/* take/recorder_state.h - what a recorder is made of: recorder.c (started, asked, while it
 * happens), recorder_cast.c (who performs, and as what it is recorded). For those two. */
#ifndef MAROTTE_STAGE_TAKE_RECORDER_STATE_H
#define MAROTTE_STAGE_TAKE_RECORDER_STATE_H
#include "stage/recorder.h"

#include <stdatomic.h>

enum { RECORDER_INPUTS_MAX = TAKE_TRACKS_MAX };

struct recorder_cast { /* who performs, and as what it is recorded */
    input *inputs[RECORDER_INPUTS_MAX];
    const char *input_text[RECORDER_INPUTS_MAX];
    uint32_t input_count;
    char *calibration[2];
    layer *layer;
    performer *performer;
    int64_t track[RECORDER_INPUTS_MAX];
    uint32_t version[RECORDER_INPUTS_MAX];
    bool is_kept[RECORDER_INPUTS_MAX]; /* the track goes on in another cast */
    take_performance performance;
};

struct recorder {
    recorder_settings settings;
    size_t state_capacity;
    writer *writer;
    recorder_cast *cast;
    bool has_begun;   /* a performance */
    bool is_to_begin; /* another one, with the next sample */
    layer *watched;
    int64_t last_ns, checkpoint_ns;
    uint32_t current; /* input of the step that is performed: its first */
    uint32_t ahead;
    bool is_take_wanted, is_take_open;
    writer_slate slate;
    char scene[TAKE_NAME], shot[TAKE_NAME];
    int64_t take;
    uint32_t rezero; /* bits by side: granted, and not yet told */
    error problem;
    _Atomic int32_t problem_state; /* of a problem_state */
};

/* The first one counts, whichever thread has it. */
enum problem_state { PROBLEM_NONE = 0, PROBLEM_IS_WRITTEN, PROBLEM_STANDS };

/* [any] Kept if it is the first, and logged. */
void recorder_note_problem(recorder *self, const error *err);

/* ---- recorder_cast.c ---- */

/* Begins the track of an input of that version of its channels. */
CHECKED mrt_result recorder_cast_add_track(recorder *self, recorder_cast *cast, uint32_t i,
                                           uint32_t version, error *err);
void recorder_cast_destroy(recorder_cast *cast); /* its tracks go on; NULL is fine */

#endif
