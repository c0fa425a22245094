/* check/child/actor.h - runs a mapping as the stage does, and watches it: forbidden calls on the
 * frame thread, invalid values in a pull, writes to memory that it must not change. Findings are
 * reported. */
#ifndef MAROTTE_CHECK_CHILD_ACTOR_H
#define MAROTTE_CHECK_CHILD_ACTOR_H
#include "check/child/cases.h"
#include "check/child/fixture.h"
#include "check/rules.h"

enum { ACTOR_CANARIES = 64 };
typedef struct actor {
    const mrt_plugin_type *type;
    const mrt_mapping *functions;
    const mrt_rig_poses *rig_poses; /* NULL: the mapping does not have this interface */
    mrt_plugin *self;
    host host;
    const mrt_face *face; /* NULL: not active */
    face_poses poses;     /* poses of the rig, valid until deactivation */
    uint64_t poses_sum;
    double centre[3], reach_mm;
    double max_jump_mm; /* limit at a new hold; 0: not judged */
    mrt_frame frame;
    struct { /* guard bytes around the pull */
        unsigned char before[ACTOR_CANARIES];
        mrt_pull pull;
        unsigned char after[ACTOR_CANARIES];
    } room;
    mrt_pull good;     /* last valid pull */
    mrt_pull anchored; /* last pull in MRT_ANCHORED; count 0: none since reset */
    bool has_anchored;
    mrt_result result; /* result of the last process() */
    int64_t cpu_ns;    /* duration of the last process(); 0 unless measured */
    bool is_measured;
    uint32_t frame_count;
} actor;

/* Creates the mapping, activates it on the face, and resets it. Returns false on failure; the
 * broken rule was reported (life.create, run.explained), or *out_refused is set for a rejected
 * face. */
bool actor_open(actor *out, const mrt_plugin_type *type, const mrt_face *face, bool *out_refused);
/* The same with these poses instead of those of the face, if the type supports poses. */
bool actor_open_posed(actor *out, const mrt_plugin_type *type, const mrt_face *face,
                      face_poses poses, bool *out_refused);
void actor_close(actor *self);

/* Deactivates, and activates on another face. Results as for actor_open. */
bool actor_move(actor *self, const mrt_face *face, bool *out_refused);
/* The two halves of actor_move; the second one also resets. If it returns false, the mapping is not
 * active. */
void actor_deactivate(actor *self);
bool actor_activate(actor *self, const mrt_face *face, face_poses poses, bool *out_refused);

void actor_reset(actor *self);
/* Calls process() for self->frame. */
void actor_step(actor *self);

/* Returns a checksum of the last valid pull, over everything that the host reads. */
uint64_t actor_sum(const actor *self);

/* Call them before and after a [frame] function. Forbidden calls in between are reported for
 * `function`. */
void actor_frame_enter(void);
void actor_frame_leave(const char *function);

/* ---- playing a part of a stream ---- */

enum { PLAY_SPAN = 500 };

/* Opens on the usual face with that stream. Returns false if it could not be created: nothing can
 * be judged. */
bool play_open(actor *out, stream *out_hands, const examination *e, stream_kind kind,
               uint64_t seed);
void play_frames(actor *mapping, stream *hands, uint32_t count);
/* Runs both for that many frames, each with its own copy of the same stream. At the first
 * difference `rule` fails, with "TEXT: frame 12: vector 3 ends at ...", and the result is false. */
bool play_same(actor *a, stream *a_hands, actor *b, stream *b_hands, uint32_t count,
               check_rule rule, const char *text);
/* Reports that the rules of frames and pulls were judged. */
void play_judged(void);

#endif
