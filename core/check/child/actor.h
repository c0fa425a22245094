/* check/child/actor.h - a mapping at work, as the stage runs it, under close watch: what it may not
 * do on the frame thread, what a pull may not hold, what it may not write to. Findings are told. */
#ifndef MAROTTE_CHECK_CHILD_ACTOR_H
#define MAROTTE_CHECK_CHILD_ACTOR_H
#include "check/child/cases.h"
#include "check/child/fixture.h"
#include "check/rules.h"

enum { ACTOR_CANARIES = 64 };
typedef struct actor {
    const mrt_plugin_type *type;
    const mrt_mapping *functions;
    const mrt_rig_poses *rig_poses; /* NULL: it has no such functions */
    mrt_plugin *self;
    host host;
    const mrt_face *face; /* NULL: not active */
    face_poses poses;     /* of the rig, until it is deactivated */
    uint64_t poses_sum;
    double centre[3], reach_mm;
    double max_jump_mm; /* at a new hold; 0: not judged */
    mrt_frame frame;
    struct { /* what lies around the pull must stay */
        unsigned char before[ACTOR_CANARIES];
        mrt_pull pull;
        unsigned char after[ACTOR_CANARIES];
    } room;
    mrt_pull good;     /* the last that made sense */
    mrt_pull anchored; /* the last one in MRT_ANCHORED; count 0: none since reset */
    bool has_anchored;
    mrt_result result; /* of the last process() */
    int64_t cpu_ns;    /* that it took; 0 unless measured */
    bool is_measured;
    uint32_t frame_count;
} actor;

/* Made, activated on the face, reset. False: it is not, and the rule that this breaks was told
 * (life.create, run.explained; for a refused face: *out_refused). */
bool actor_open(actor *out, const mrt_plugin_type *type, const mrt_face *face, bool *out_refused);
/* With these poses instead of the face's own, if the type asks for any. */
bool actor_open_posed(actor *out, const mrt_plugin_type *type, const mrt_face *face,
                      face_poses poses, bool *out_refused);
void actor_close(actor *self);

/* Deactivates, and activates on another face. As actor_open. */
bool actor_move(actor *self, const mrt_face *face, bool *out_refused);
/* Both halves of it; the second one also resets. A false one is not active. */
void actor_deactivate(actor *self);
bool actor_activate(actor *self, const mrt_face *face, face_poses poses, bool *out_refused);

void actor_reset(actor *self);
/* process() for self->frame. */
void actor_step(actor *self);

/* What the face shows of it now: a sum over all that the host looks at. */
uint64_t actor_sum(const actor *self);

/* Before and after a call that is [frame]: what is caught in between is told for `function`. */
void actor_frame_enter(void);
void actor_frame_leave(const char *function);

/* ---- a stretch of a stream ---- */

enum { PLAY_SPAN = 500 };

/* On the usual face, with that stream. False: it could not be made; nothing to judge. */
bool play_open(actor *out, stream *out_hands, const examination *e, stream_kind kind,
               uint64_t seed);
void play_frames(actor *mapping, stream *hands, uint32_t count);
/* Both go on by that many frames, each with its own copy of the same stream. Fails `rule` at the
 * first difference: "TEXT: frame 12: vector 3 ends at ..."; false then. */
bool play_same(actor *a, stream *a_hands, actor *b, stream *b_hands, uint32_t count,
               check_rule rule, const char *text);
/* Tells that the rules of frames and pulls were judged. */
void play_judged(void);

#endif
