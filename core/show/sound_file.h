/* show/sound_file.h - imports sound files into a show, and exports the sound of a take as WAV. Only
 * sound_file.c uses libsndfile, which reads WAV, FLAC, Ogg, AIFF and others. Import keeps each
 * sample and the rate of the file. Export keeps the rate of the sound unless the caller sets
 * another one. Memory is bounded for any file. Leaves out rendering (sound_render.h). [main], or
 * any thread that may block and owns the show. */
#ifndef MAROTTE_TAKE_SOUND_FILE_H
#define MAROTTE_TAKE_SOUND_FILE_H
#include "show/show.h"

/* Progress callback: called repeatedly with `part`, the completed part of the work, 0..1. Returning
 * false cancels the work. All NULL: no callback. */
typedef struct sound_file_watch {
    bool (*goes_on)(void *data, double part);
    void *data;
} sound_file_watch;

/* Imports a file into the narrowest of s16, s24 and f32 that keeps every sample. A file that none
 * of them can keep is refused, and so is a truncated file. MRT_END: cancelled. After a failure or
 * MRT_END the show holds nothing of the file. */
CHECKED mrt_result sound_file_import(int64_t *out_audio, show *s, const char *path,
                                     const sound_file_watch *watch, error *err);

typedef struct sound_file_export {
    const take *take;       /* take with its audio, start and time code */
    int64_t from_ns, to_ns; /* range on its timeline */
    uint32_t rate_hz;       /* 0: the rate of the sound; any other rate resamples */
} sound_file_export;

typedef struct sound_file_report {
    uint32_t rate_hz, channel_count;
    char format[8]; /* "s16", "s24" or "f32": the format in the show if frames are unchanged, else
                       at least s24 */
    int64_t frame_count;
    int64_t cut_count;     /* samples that were clipped by the format */
    uint64_t splice_count; /* frames skipped or repeated to follow the clock of the samples */
    int64_t damaged_count; /* pieces of the show that could not be read and are silent */
} sound_file_report;

/* Exports a range of a take. Frame 0 is the frame of the timeline nearest to from_ns. Parts without
 * sound are silent. The bext chunk stores the time of the range: UTC, and the time since midnight
 * by the take's time code, or by UTC without one. MRT_END: cancelled. After a failure or MRT_END an
 * existing file is unchanged. */
CHECKED mrt_result sound_file_write(sound_file_report *out, show *s, const sound_file_export *what,
                                    const char *path, const sound_file_watch *watch, error *err);

/* Writes a range of a sound file as a 24-bit WAV at the same rate. If the sound ends before the
 * range, silence follows. */
CHECKED mrt_result sound_file_cut(const char *out_path, const char *path, double start_s,
                                  double length_s, error *err);

#endif
