/* stage/playback/sequencer.h - plays a take: at each instant of its timeline the clips of its
 * layers say which performances are shown, and at which of their own instants; their samples are
 * performed in the order of the timeline, and the pulls become one face. A function of the take and
 * of what was recorded: the same at every speed and frame rate, whether played, scrubbed or
 * exported. Leaves out the clock (transport.h) and where frames go. Its memory grows with what is
 * shown at a time, not with the take's length, but for checkpoints, which are thinned to a bound.
 * [main], or any one thread that may read the show. */
#ifndef MAROTTE_STAGE_SEQUENCER_H
#define MAROTTE_STAGE_SEQUENCER_H
#include "stage/playback/replay.h"

typedef struct sequencer sequencer;

typedef struct sequencer_settings {
    show *show;
    const plugin_list *plugins;
    log_queue *log;
    const face_file *face;
    const csrbf_settings *solver; /* read by create; NULL: as the show says (kept_solver.h); radius
                                     0: the rig's */
    size_t checkpoint_bytes;      /* bound of what is kept to scrub; 0: 256 MiB */
    size_t ahead_bytes;           /* as of replay_world */
} sequencer_settings;

/* The settings' things must outlive it; the take is copied. */
CHECKED mrt_result sequencer_create(sequencer **out, const sequencer_settings *settings,
                                    const take *t, error *err);
void sequencer_destroy(sequencer *self); /* NULL is fine */
/* After an edit: goes on at the same instant. */
CHECKED mrt_result sequencer_set_take(sequencer *self, const take *t, error *err);

/* Brings the face to an instant, as if the take had been played from its start: every sample whose
 * time is not after it has been performed. */
CHECKED mrt_result sequencer_seek(sequencer *self, int64_t at_ns, error *err);
/* Plays on to a later instant; an earlier one is a seek. */
CHECKED mrt_result sequencer_play_to(sequencer *self, int64_t at_ns, error *err);
/* It stands at from_ns. What clips of this span perform with is opened and read now, and what their
 * mappings in processes of their own answer is asked for, so that to play it, and to seek to
 * from_ns, takes no file and no process: from then on nothing is opened, read, asked or closed,
 * until nobody performs over it any more (sequencer_set_live) or the take changes. What does not
 * fit is left out or held, and noted. */
CHECKED mrt_result sequencer_prepare(sequencer *self, int64_t from_ns, int64_t to_ns, error *err);
/* To the next step of any clip shown, or (MRT_END) none is left before the take's end. */
CHECKED mrt_result sequencer_step(sequencer *self, error *err);
int64_t sequencer_now_ns(const sequencer *self);        /* -1: before the first instant */
uint64_t sequencer_sample_count(const sequencer *self); /* performed since create */
size_t sequencer_kept_bytes(const sequencer *self);     /* of checkpoints */

/* Who performs all of it; composer_draw or frame_draw draws its face. */
performer *sequencer_performer(sequencer *self);
/* An error that says which mapping's process has failed, if one has: the face is held. */
CHECKED mrt_result sequencer_check(const sequencer *self, error *err);
/* What is not as it was when it was recorded, lines ended by \n; "" nothing. */
const char *sequencer_note(const sequencer *self);

/* ---- live: somebody performs over what is played ---- */

/* A layer that is performed now lies above all others: a voice of the same performer. It must
 * outlive that, as what it owns (composer_part). of: NULL: nobody performs. */
void sequencer_set_live(sequencer *self, layer *of, const uint8_t *owns, bool is_additive);
/* From frame.record: the layer performs this step at the instant that has been played to. weight:
 * how much of it is seen from then on, 0..1. */
void sequencer_perform_over(sequencer *self, stage_frame *f, double weight);
/* What a layer of these patterns owns: as composer_part, for composer_about's face. `out` has
 * contact_count + dof_count + 1 places. */
void sequencer_mark_owned(const composer *shown, const take_layer *l, uint8_t *out);

#endif
