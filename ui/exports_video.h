/* exports_video.h - the videos among the exports of a performance: opened before it, fed with each
 * frame, there when it is over; and the sound that belongs to them. [main] */
#ifndef MAROTTE_UI_EXPORTS_VIDEO_H
#define MAROTTE_UI_EXPORTS_VIDEO_H
#include "exports.h"
#include "stage/composer.h"
#include "take/show.h"
#include "video.h"

typedef struct exports_video {
    video *video; /* NULL: no video is wanted */
    video_file file[VIDEO_FILES_MAX];
    uint32_t count;
    video_look look;
    bool is_told; /* that it has failed */
} exports_video;

/* The videos among the files. */
void exports_video_choose(exports_video *out, const exports_file *file, uint32_t count,
                          const video_look *look);
const char *exports_video_mp4(const exports_video *self); /* the first one; NULL: none */
CHECKED mrt_result exports_video_check(const exports_video *self, error *err);
CHECKED mrt_result exports_video_open(exports_video *self, const video_settings *settings,
                                      error *err);
/* The face as drawn. Live, a failure is said once on stderr, and the performance goes on. */
CHECKED mrt_result exports_video_add(exports_video *self, composer *from, error *err);
CHECKED mrt_result exports_video_finish(exports_video *self, facts *told, error *err);
/* Removes what is not finished. */
void exports_video_close(exports_video *self);

/* The sound of a range of a take as a WAV without a name of its own; to be removed. */
CHECKED mrt_result exports_video_sound(char **out_path, show *s, const take *t, int64_t from_ns,
                                       int64_t to_ns, const char *beside, progress *shown,
                                       error *err);
void exports_video_sound_remove(char *path); /* NULL is fine */
/* Into the .mp4 files that are there already. */
CHECKED mrt_result exports_video_add_sound(const exports_video *self, const char *sound,
                                           error *err);

#endif
