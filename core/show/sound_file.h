/* show/sound_file.h - sound from files into a show, and the sound of a take into a WAV. Only
 * sound_file.c sees libsndfile: WAV, FLAC, Ogg, AIFF and whatever else it
 * reads. What comes in is kept sample by sample at its own rate; what goes out is at the sound's
 * rate unless another is asked for by name. Memory is bounded whatever the file says. [main], or
 * any thread that may block and has the show. */
#ifndef MAROTTE_TAKE_SOUND_FILE_H
#define MAROTTE_TAKE_SOUND_FILE_H
#include "show/show.h"

/* Asked now and then, `part` 0..1 of the work done; false: give it up. All NULL: nobody watches. */
typedef struct sound_file_watch {
    bool (*goes_on)(void *data, double part);
    void *data;
} sound_file_watch;

/* Into the narrowest of s16, s24 and f32 that keeps every sample; a file that none of them keeps is
 * refused, and one that ends early. MRT_END: given up; then, and on failure, nothing of it stays in
 * the show. */
CHECKED mrt_result sound_file_import(int64_t *out_audio, show *s, const char *path,
                                     const sound_file_watch *watch, error *err);

typedef struct sound_file_export {
    const take *take;       /* its audio, start and time code */
    int64_t from_ns, to_ns; /* of its timeline */
    uint32_t rate_hz;       /* 0: the sound's own; another one: it is resampled */
} sound_file_export;

typedef struct sound_file_report {
    uint32_t rate_hz, channel_count;
    char format[8]; /* "s16", "s24", "f32": the show's where frames are as they were, else >= s24 */
    int64_t frame_count;
    int64_t cut_count;     /* samples that were too loud for the format */
    uint64_t splice_count; /* frames left out or repeated to keep with the samples' clock */
    int64_t damaged_count; /* pieces of the show that could not be read and are silent */
} sound_file_report;

/* A range of a take: frame 0 is the frame of the timeline nearest to from_ns; silence where there
 * is no sound. The time of the range is in its bext chunk: UTC, and since midnight the time code
 * where the take has one, else UTC. MRT_END: given up; then, and on failure, what was there before
 * is. */
CHECKED mrt_result sound_file_write(sound_file_report *out, show *s, const sound_file_export *what,
                                    const char *path, const sound_file_watch *watch, error *err);

/* A range of a sound file as a WAV of 24 bits at the same rate, in which the sound is followed by
 * silence where it ends earlier. */
CHECKED mrt_result sound_file_cut(const char *out_path, const char *path, double start_s,
                                  double length_s, error *err);

#endif
