/* stage/playback/replay.h - performs a recorded performance again. Its tracks are sources of
 * samples like any other. Its parameters change at the recorded times, and its mapping returns the
 * same pulls, bit for bit. Leaves out which part of it a take shows (sequencer.h). Open, seek and
 * close it on [main] or on any one thread that may read the show. Never use it on two threads at
 * the same time. */
#ifndef MAROTTE_STAGE_REPLAY_H
#define MAROTTE_STAGE_REPLAY_H
#include "stage/mapping/plugins.h"
#include "stage/mapping/taught.h"
#include "stage/perform/frame.h"
#include "show/show.h"

/* Shared by all replays of a take. Must outlive them. */
typedef struct replay_world {
    show *show;
    const plugin_list *plugins;
    log_queue *log;
    performer *scratch; /* performs one replay without the others during a seek */
    size_t ahead_bytes; /* memory limit of samples read ahead, and of answers, for each replay; 0:
                           64 MiB */
} replay_world;

/* Version and largest size of a stored state (show_checkpoint.version). */
enum {
    REPLAY_CHECKPOINT_VERSION = 5,
    REPLAY_CHECKPOINT_BYTES = 4 << 20 /* plus the size of the face */
};
/* [frame] Writes the state of a performance that is being recorded, for replay_restore. It holds
 * the taught values of the mapping and, if `of` is not NULL, the parts that a take performs alone
 * (take_own_part_of), and everything on which later frames of the performer depend. Pass NULL if
 * other layers move the face too. show_offset_ns: added to the clock, it gives show time. Writes at
 * most `capacity` bytes and returns the size. 0: nothing to store. */
enum { REPLAY_STATE_MIN = TAUGHT_BYTES_MAX + 64 }; /* enough for the taught values alone */
size_t replay_write_state(const instance *mapping, performer *of, int64_t show_offset_ns,
                          void *bytes, size_t capacity);

typedef struct replay replay;

/* Opens a performance, or a part of it. A part other than the hands needs no mapping. Its mapping
 * is found by id. A different version is used too, and replay_note reports it. */
CHECKED mrt_result replay_open(replay **out, const replay_world *world, int64_t performance,
                               take_part part, error *err);
void replay_close(replay *self); /* accepts NULL */

/* Whether it performs what the clip shows. */
bool replay_is_of(const replay *self, const take_clip *clip);
layer *replay_layer(replay *self);
/* Returns what changed since the recording. "": nothing. */
const char *replay_note(const replay *self);

/* Returns an error if the process of its mapping has failed. The face keeps its last pose then. */
CHECKED mrt_result replay_check(const replay *self, error *err);

/* Adds its tracks as sources to `into`, with the voice, due_ns and clock of `as`. A source reads
 * its samples from the show, or from memory after replay_read_ahead. */
void replay_schedule(replay *self, scheduler *into, const sample_source *as);
/* [frame] Call before its layer performs a step: applies the recorded changes up to that step. */
void replay_prepare(replay *self, const sample_step *s);
/* Returns the show time of the last performed step. INT64_MIN: none since the start. */
int64_t replay_now_ns(const replay *self);

/* Performs its next step on voice 0 of the scratch performer, up to the guard: the face does not
 * move. MRT_END: the next step is at or after before_ns (show time), or missing. */
CHECKED mrt_result replay_pull(replay *self, int64_t before_ns, error *err);
/* Seeks as if all samples before time_ns had been performed from the start. The scratch performer
 * then shows the face of this performance. */
CHECKED mrt_result replay_seek(replay *self, int64_t time_ns, error *err);

/* Restores the last state that was stored during the recording, for a time before time_ns and not
 * before least_ns. Afterwards voice 0 of `into` is its layer, and `into` has the face of that time.
 * MRT_HOLD: no such state exists, and nothing has changed. */
CHECKED mrt_result replay_restore(replay *self, int64_t time_ns, int64_t least_ns, performer *into,
                                  error *err);

/* ---- play from memory, where files and processes must not be used ---- */

/* Reads the samples of a span of show time into memory, up to the memory limit. Afterwards the
 * replay plays only from memory. After the last sample in memory it keeps its last pose. An
 * isolated mapping is not called any more: its steps give MRT_HOLD until replay_answer_ahead has
 * stored its answers. The current instant does not change. */
CHECKED mrt_result replay_read_ahead(replay *self, int64_t from_ns, int64_t to_ns, error *err);
/* Calls the isolated mapping for all these samples and stores its answers, until the clock reaches
 * until_ns. The usable span ends earlier if the mapping fails or the answers exceed the memory
 * limit. Seek or load the replay afterwards. */
CHECKED mrt_result replay_answer_ahead(replay *self, int64_t until_ns, error *err);
/* Returns why the span in memory is shorter than requested. "": it is complete. */
const char *replay_missing(const replay *self);
/* Drops the data in memory. The replay reads the show and calls its mapping again. Seek or load it
 * afterwards. */
void replay_forget_ahead(replay *self);

/* Writes the current state, like layer_save. 0: the mapping cannot save its state. */
size_t replay_save(replay *self, void *bytes, size_t capacity);
CHECKED mrt_result replay_load(replay *self, const void *bytes, size_t size, error *err);

#endif
