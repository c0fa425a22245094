/* video_folder.h - a PNG sequence: FOLDER/00001.png and on, and FOLDER/frames.json, which says how
 * many there are and at what rate. The pictures come into the folder when all are there: until
 * then, and when something fails, an earlier sequence is as it was. Only a sequence of ours is
 * replaced. One thread. */
#ifndef MAROTTE_UI_VIDEO_FOLDER_H
#define MAROTTE_UI_VIDEO_FOLDER_H
#include "take/timecode.h"

typedef struct video_folder video_folder;

typedef struct video_folder_about {
    uint32_t width, height;
    bool has_alpha;
    timecode_rate rate;
    const char *timecode; /* of the first frame; "" none */
} video_folder_about;

/* Whether a sequence may be written there: the folder is not there yet, empty, or has one of ours.
 */
CHECKED mrt_result video_folder_check(const char *path, error *err);
CHECKED mrt_result video_folder_open(video_folder **out, const char *path,
                                     const video_folder_about *about, error *err);
CHECKED mrt_result video_folder_add(video_folder *self, const uint8_t *rgba, error *err);
/* Freed whatever the result. */
CHECKED mrt_result video_folder_commit(video_folder *self, error *err);
void video_folder_abandon(video_folder *self); /* NULL is fine */

#endif
