/* take_stage.h - a take performed without a window: its face, its sequencer, and which frames of it
 * are wanted. [main] */
#ifndef MAROTTE_UI_TAKE_STAGE_H
#define MAROTTE_UI_TAKE_STAGE_H
#include "stage/mapping/plugins.h"
#include "stage/take/sequencer.h"
#include "take.h"

typedef struct take_stage {
    log_queue *log;
    plugin_list plugins;
    face_file face;
    char *face_path; /* owned */
    sequencer *sequencer;
    take take; /* as its edits make it; owned */
} take_stage;

/* The take that `text` names, on the face `other` or (NULL) on the one that it was performed on:
 * which must be there; that it has changed is said. To be finished whatever the result. */
CHECKED mrt_result take_stage_open(take_stage *out, take_call *call, const char *text,
                                   const char *other, error *err);
void take_stage_finish(take_stage *self); /* zeroed is fine */
/* Tells what is not as it was when it was recorded, and the news of plugins. */
void take_stage_tell(take_stage *self);

/* The face of a take: of its first clip that is heard. */
CHECKED mrt_result take_face_read(face_file *out, char **out_path, take_call *call, const take *t,
                                  const char *other, error *err);

typedef struct take_frames { /* frame `first` + i begins at timecode_time_ns(rate, first + i) */
    timecode_rate rate;
    int64_t first, count;
} take_frames;
/* By --fps, --in and --out: the frames that begin in that range; of the whole take without. */
CHECKED mrt_result take_frames_of(take_frames *out, take_call *call, const take *t, error *err);

/* Brings the face to each frame in turn. `each` reads sequencer_performer, drawn. */
CHECKED mrt_result take_stage_play(take_stage *self, take_call *call, const take_frames *frames,
                                   mrt_result (*each)(void *data, take_stage *from, error *err),
                                   void *data, error *err);

#endif
