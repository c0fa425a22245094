/* window/app/voice_import.h - the sound of a file into the show that is open, on a thread of its
 * own while the show goes on. Leaves out which take gets it. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_VOICE_IMPORT_H
#define MAROTTE_UI_WINDOW_APP_VOICE_IMPORT_H
#include "take/show.h"

typedef struct voice_import voice_import;

/* The show outlives it. */
CHECKED mrt_result voice_import_begin(voice_import **out, show *into, const char *path, error *err);
/* MRT_END: it goes on; else how it ended, and the sound: it is to be destroyed then. */
CHECKED mrt_result voice_import_look(voice_import *self, int64_t *out_audio, error *err);
double voice_import_part(const voice_import *self); /* 0..1 of it is done */
/* What has not ended is given up, with nothing of it left in the show. NULL is fine. */
void voice_import_destroy(voice_import *self);

#endif
