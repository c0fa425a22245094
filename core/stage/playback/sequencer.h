/* stage/playback/sequencer.h - plays a take. At each instant of the timeline, the clips of the
 * layers select the performances and their source times. Their samples are performed in timeline
 * order, and the pulls become one face. The result depends only on the take and its recordings: it
 * is the same at every speed and frame rate, whether played, scrubbed or exported. Leaves out the
 * clock (transport.h) and the output of frames. Memory grows with the number of clips that play
 * together, not with the length of the take. Checkpoints are thinned to a limit. [main], or any one
 * thread that may read the show. */
#ifndef MAROTTE_STAGE_SEQUENCER_H
#define MAROTTE_STAGE_SEQUENCER_H
#include "stage/playback/replay.h"

typedef struct sequencer sequencer;

typedef struct sequencer_settings {
    show *show;
    const plugin_list *plugins;
    log_queue *log;
    const face_file *face;
    /* read by create; NULL: the show's solver (kept_solver.h); radius 0: the rig's */
    const csrbf_settings *solver;
    size_t checkpoint_bytes; /* memory limit of the checkpoints; 0: 256 MiB */
    size_t ahead_bytes;      /* see replay_world */
} sequencer_settings;

/* Everything that the settings point to must outlive the sequencer. The take is copied. */
CHECKED mrt_result sequencer_create(sequencer **out, const sequencer_settings *settings,
                                    const take *t, error *err);
void sequencer_destroy(sequencer *self); /* accepts NULL */
/* Call after an edit. The sequencer stays at its instant. */
CHECKED mrt_result sequencer_set_take(sequencer *self, const take *t, error *err);
/* As sequencer_set_take, for an edit that is still being dragged: it plays nothing, and keeps the
 * checkpoints before the first instant that changes. Call sequencer_seek next. The recordings must
 * be those of the take before. */
CHECKED mrt_result sequencer_preview_take(sequencer *self, const take *t, error *err);

/* Brings the face to an instant, as if the take had been played from its start. All samples up to
 * and including at_ns have been performed. */
CHECKED mrt_result sequencer_seek(sequencer *self, int64_t at_ns, error *err);
/* Plays to a later instant. An earlier instant is a seek. */
CHECKED mrt_result sequencer_play_to(sequencer *self, int64_t at_ns, error *err);
/* Prepares an overdub of from_ns..to_ns. The sequencer must be at from_ns. Opens and reads the
 * performances of this span now, and stores the answers of isolated mappings. After this call,
 * playing the span and seeking to from_ns use no file and no process. This lasts until the overdub
 * ends (sequencer_set_live with NULL) or the take changes. Clips that exceed a limit are not played
 * or keep their last pose, and sequencer_note reports them. */
CHECKED mrt_result sequencer_prepare(sequencer *self, int64_t from_ns, int64_t to_ns, error *err);
/* Plays to the next step of any clip. MRT_END: the take has no more steps. */
CHECKED mrt_result sequencer_step(sequencer *self, error *err);
int64_t sequencer_now_ns(const sequencer *self);        /* -1: before the first instant */
uint64_t sequencer_sample_count(const sequencer *self); /* performed since create */
size_t sequencer_kept_bytes(const sequencer *self);     /* size of the checkpoints */

/* Returns the performer of all layers. */
performer *sequencer_performer(sequencer *self);
/* Returns an error if the process of a mapping has failed. The face keeps its last pose then. */
CHECKED mrt_result sequencer_check(const sequencer *self, error *err);
/* Returns what changed since the recording, one line each, ended by \n. "": nothing. */
const char *sequencer_note(const sequencer *self);

/* ---- live layer of an overdub ---- */

/* Sets the live layer. It is a voice of the same performer, above all other layers. The layer and
 * `owns` (see composer_part) must stay valid until it is replaced. of NULL: no live layer. */
void sequencer_set_live(sequencer *self, layer *of, const uint8_t *owns, bool is_additive);
/* From stage_frame.record: the live layer performs this step at the current instant. weight: its
 * visible share until the next step, 0..1. */
void sequencer_perform_over(sequencer *self, stage_frame *f, double weight);
/* Marks the contacts and degrees of freedom that a layer owns, for the face of composer_about (see
 * composer_part). `out` has contact_count + dof_count + 1 elements. */
void sequencer_mark_owned(const composer *shown, const take_layer *l, uint8_t *out);

#endif
