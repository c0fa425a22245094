/* stage/take/sequencer_state.h - what a sequencer is made of. Inside sequencer*.c. */
#ifndef MAROTTE_STAGE_SEQUENCER_STATE_H
#define MAROTTE_STAGE_SEQUENCER_STATE_H
#include "stage/sequencer.h"

enum {
    SEQUENCER_PLAYS_MAX = PERFORMER_SLOTS - 1,
    SEQUENCER_LIVE_SLOT = PERFORMER_SLOTS - 1,
    SEQUENCER_SPARES = 16,  /* sources kept open */
    SEQUENCER_PREPARED = 8, /* so that none need be closed while a take is played */
    SEQUENCER_BEFORE = -1   /* now_ns before the first instant */
};

typedef struct play { /* a clip that is shown now; its index is its slot in the composer */
    const take_clip *clip;
    uint32_t layer; /* index */
    source *source; /* NULL: free */
    bool is_wanted; /* within turn() */
    bool has_smooth;
    int64_t smooth_ns;
    mrt_pull smooth;
} play;

typedef struct moment { /* what is kept of an instant */
    int64_t at_ns;
    unsigned char *bytes;
    size_t size;
} moment;

struct sequencer {
    sequencer_settings settings;
    source_world world;
    take take;
    composer *composer, *scratch;
    play play[SEQUENCER_PLAYS_MAX];
    source *spare[SEQUENCER_SPARES]; /* open, of no clip: the oldest first */
    uint32_t spare_count;
    int64_t *turn; /* ascending: when clips of heard layers start and end */
    size_t turn_count;
    uint8_t *owned; /* layer_count rows */
    size_t owned_row;
    int64_t now_ns;
    uint64_t sample_count;
    char note[1024];
    error failed; /* of a mapping whose clip has ended */

    sequencer_live live;
    double live_weight;
    bool is_live_fresh;
    bool is_touched; /* by somebody live: the face is not the take's alone */

    moment *moment; /* by at_ns */
    size_t moment_count, moment_capacity, moment_bytes;
    int64_t moment_span_ns; /* at least so far apart; 0: not chosen yet */
    bool is_unkeepable;     /* some mapping cannot say its state */
    unsigned char *scratch_bytes;
    size_t scratch_capacity;
};

/* ---- sequencer.c ---- */
/* Before the first instant, its clips ready. */
CHECKED mrt_result sequencer_restart(sequencer *self, error *err);
void sequencer_note_text(sequencer *self, const char *text);

/* ---- sequencer_moments.c ---- */
/* One that is open already, or a new one; wherever it is: to be sought or loaded. */
CHECKED mrt_result sequencer_open(sequencer *self, int64_t performance, source **out, error *err);
void sequencer_close_play(sequencer *self, play *p); /* its source stays open for a while */
void sequencer_close_spares(sequencer *self);
void sequencer_close_plays(sequencer *self);
bool sequencer_reserve(sequencer *self, size_t size); /* scratch_bytes; false: no memory */
void sequencer_forget_checkpoints(sequencer *self);
/* Now and then: after a sample. */
CHECKED mrt_result sequencer_keep_checkpoint(sequencer *self, error *err);
/* To the last instant at or before at_ns from which playing on is quickest. */
CHECKED mrt_result sequencer_go_near(sequencer *self, int64_t at_ns, error *err);

#endif
