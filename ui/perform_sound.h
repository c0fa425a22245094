/* perform_sound.h - the microphone beside a performance: what was said becomes the sound of its
 * take. A microphone that is missing or fails stops nothing. [main] */
#ifndef MAROTTE_UI_PERFORM_SOUND_H
#define MAROTTE_UI_PERFORM_SOUND_H
#include "facts.h"
#include "progress.h"
#include "stage/sound/sound.h"

typedef struct perform_sound {
    sound *sound; /* NULL: nothing is recorded */
    show *show;
    char told[256]; /* the last thing that was said of it */
} perform_sound;

/* Arms the microphone; the show and the writer must outlive it. To be finished whatever comes. */
CHECKED mrt_result perform_sound_start(perform_sound *out, show *s, writer *w, error *err);
void perform_sound_update(perform_sound *self); /* some times a second; says what is wrong, once */
/* The microphone is off, and all of it is with the writer. */
void perform_sound_stop(perform_sound *self);
/* What was recorded becomes the take's sound; the writer has been flushed or stopped. */
CHECKED mrt_result perform_sound_attach(perform_sound *self, int64_t take_id, facts *told,
                                        error *err);
/* The take's sound from its start on as a WAV beside a file, for exports_video_sound_remove; NULL:
 * it has none. */
CHECKED mrt_result perform_sound_write(perform_sound *self, int64_t take_id, double length_s,
                                       const char *beside, char **out_path, progress *shown,
                                       error *err);
void perform_sound_finish(perform_sound *self); /* zeroed is fine */

#endif
