/* stage/take/source.h - a performance that was recorded, performed again: its tracks' samples and
 * its parameters go through its mapping as they did then, sample by sample, so its pulls have the
 * same bits. Leaves out what of it a take shows (sequencer.h) and what pulls do to a face
 * (composer.h). [main], or any one thread that may read the show; not for two threads at once. */
#ifndef MAROTTE_STAGE_SOURCE_H
#define MAROTTE_STAGE_SOURCE_H
#include "stage/mapping/plugins.h"
#include "stage/mapping/taught.h"
#include "stage/perform/performer.h"
#include "take/show.h"

/* What all sources of a take share; must outlive them. */
typedef struct source_world {
    show *show;
    const plugin_list *plugins;
    log_queue *log;
    composer *scratch; /* its face is moved wherever a source has to be brought to some instant */
} source_world;

/* How stored states are told from those of another way to keep them (show_checkpoint.version). */
enum {
    SOURCE_CHECKPOINT_VERSION = 3,
    SOURCE_CHECKPOINT_BYTES = 4 << 20 /* and what the face takes: no state is larger */
};
/* [frame] The state of a performance that is recorded, for source_recall: what its mapping was
 * taught, and of a performer that alone moves its face all that frames to come depend on; NULL:
 * others move it too. show_offset_ns: what its clock lacks to show time. Returns the size that it
 * takes, at most `capacity` are written; 0: there is nothing to keep. */
enum { SOURCE_STATE_MIN = TAUGHT_BYTES_MAX + 64 }; /* room for what was taught alone */
size_t source_keep(const instance *mapping, performer *of, int64_t show_offset_ns, void *bytes,
                   size_t capacity);

typedef struct source source;

/* The performance's mapping is looked for by its id; another version of it is used with a note. */
CHECKED mrt_result source_open(source **out, const source_world *world, int64_t performance,
                               error *err);
void source_close(source *self); /* NULL is fine */

int64_t source_performance(const source *self);
layer *source_layer(source *self);
/* What is not as it was when it was recorded; "" nothing. */
const char *source_note(const source *self);

/* An error that says why its mapping's process failed, if it has: the face was held. */
CHECKED mrt_result source_check(const source *self, error *err);

/* Show time of the next step; INT64_MAX: none is left. */
CHECKED mrt_result source_next_ns(source *self, int64_t *out_ns, error *err);
/* Performs it; of how many samples. 0: none is left. */
uint32_t source_step(source *self, bool near);
/* Show time of the step performed last; INT64_MIN: none since the start. */
int64_t source_now_ns(const source *self);

/* As if it had performed from its start, all samples before time_ns. The scratch composer's face is
 * then as that performance left it. */
CHECKED mrt_result source_seek(source *self, int64_t time_ns, error *err);

/* To the last state that was kept while it was recorded, of samples before time_ns and not before
 * least_ns; `into` gets the face that it had. MRT_HOLD: there is none, and nothing has changed. */
CHECKED mrt_result source_recall(source *self, int64_t time_ns, int64_t least_ns, composer *into,
                                 error *err);

/* What it needs from this show time to that one is in memory from now on, as far as 64 MiB reach:
 * to perform and seek in between takes no reading. */
CHECKED mrt_result source_read_ahead(source *self, int64_t from_ns, int64_t to_ns, error *err);

/* Where it is, as bytes (as layer_save); 0: its mapping cannot say. */
size_t source_save(source *self, void *bytes, size_t capacity);
CHECKED mrt_result source_load(source *self, const void *bytes, size_t size, error *err);

#endif
