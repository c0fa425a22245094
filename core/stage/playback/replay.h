/* stage/playback/replay.h - a performance that was recorded, performed again: its tracks are
 * sources of samples like any other, its parameters change where they changed then, and its mapping
 * gives the same pulls, bit for bit. Leaves out what of it a take shows (sequencer.h). Opened,
 * brought to an instant and closed on [main] or any one thread that may read the show; not for two
 * threads at once. */
#ifndef MAROTTE_STAGE_REPLAY_H
#define MAROTTE_STAGE_REPLAY_H
#include "stage/mapping/plugins.h"
#include "stage/mapping/taught.h"
#include "stage/perform/frame.h"
#include "show/show.h"

/* What all of a take share; must outlive them. */
typedef struct replay_world {
    show *show;
    const plugin_list *plugins;
    log_queue *log;
    performer *scratch; /* performs alone what has to be brought to some instant */
    size_t ahead_bytes; /* bound of what each reads ahead; 0: 64 MiB */
} replay_world;

/* How stored states are told from those of another way to keep them (show_checkpoint.version). */
enum {
    REPLAY_CHECKPOINT_VERSION = 3,
    REPLAY_CHECKPOINT_BYTES = 4 << 20 /* and what the face takes: no state is larger */
};
/* [frame] The state of a performance that is recorded, for replay_recall: what its mapping was
 * taught, and of a performer that alone moves its face all that frames to come depend on; NULL:
 * others move it too. show_offset_ns: what its clock lacks to show time. Returns the size that it
 * takes, at most `capacity` are written; 0: there is nothing to keep. */
enum { REPLAY_STATE_MIN = TAUGHT_BYTES_MAX + 64 }; /* room for what was taught alone */
size_t replay_keep(const instance *mapping, performer *of, int64_t show_offset_ns, void *bytes,
                   size_t capacity);

typedef struct replay replay;

/* The performance's mapping is looked for by its id; another version of it is used with a note. */
CHECKED mrt_result replay_open(replay **out, const replay_world *world, int64_t performance,
                               error *err);
void replay_close(replay *self); /* NULL is fine */

int64_t replay_performance(const replay *self);
layer *replay_layer(replay *self);
/* What is not as it was when it was recorded; "" nothing. */
const char *replay_note(const replay *self);

/* An error that says why its mapping's process failed, if it has: the face was held. */
CHECKED mrt_result replay_check(const replay *self, error *err);

/* Its tracks become sources of `into`: as->voice, due_ns and clock are theirs. Asked for a sample,
 * they read the show, or what was read ahead. */
void replay_schedule(replay *self, scheduler *into, const sample_source *as);
/* [frame] Before its layer performs a step of those: what was changed before it then. */
void replay_prepare(replay *self, const sample_step *s);
/* Show time of the step performed last; INT64_MIN: none since the start. */
int64_t replay_now_ns(const replay *self);

/* By itself: its next step on voice 0 of the scratch performer, up to the guard: the pull, without
 * the face. MRT_END: none is left before that show time. */
CHECKED mrt_result replay_pull(replay *self, int64_t before_ns, error *err);
/* As if it had performed from its start, all samples before time_ns. The scratch performer's face
 * is then as that performance left it. */
CHECKED mrt_result replay_seek(replay *self, int64_t time_ns, error *err);

/* To the last state that was kept while it was recorded, of samples before time_ns and not before
 * least_ns; voice 0 of `into` is its layer then, and the face the one that it had. MRT_HOLD: there
 * is none, and nothing has changed. */
CHECKED mrt_result replay_recall(replay *self, int64_t time_ns, int64_t least_ns, performer *into,
                                 error *err);

/* ---- performed from memory: where nothing may be read and no process asked ---- */

/* From now on it performs from memory alone: what it needs from this show time to that one is read
 * now, as far as the bound reaches; where that ends it stays as it is. A mapping in a process of
 * its own is not asked any more, but answers nothing yet. Where it is stays. */
CHECKED mrt_result replay_read_ahead(replay *self, int64_t from_ns, int64_t to_ns, error *err);
/* What such a mapping answers over all of that is asked for now, until the clock says until_ns:
 * where it fails, or there are more answers than the bound, it ends too. It is somewhere then, and
 * has to be sought or loaded. */
CHECKED mrt_result replay_answer_ahead(replay *self, int64_t until_ns, error *err);
/* Why less is in memory than was asked for; "" all of it is. */
const char *replay_missing(const replay *self);
/* It asks the show and its process again; it has to be sought or loaded. */
void replay_forget_ahead(replay *self);

/* Where it is, as bytes (as layer_save); 0: its mapping cannot say. */
size_t replay_save(replay *self, void *bytes, size_t capacity);
CHECKED mrt_result replay_load(replay *self, const void *bytes, size_t size, error *err);

#endif
