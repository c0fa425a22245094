/* io/write/export_stream.h - helpers of the writers of clips: size checks, time code, progress,
 * text files. Does not cover the formats. Runs in the thread of the writer. */
#ifndef MAROTTE_IO_EXPORT_STREAM_H
#define MAROTTE_IO_EXPORT_STREAM_H
#include "base/file.h"
#include "base/timecode.h"
#include "io/clip.h"
#include "io/export.h"

#include <locale.h>
#include <stdint.h>

/* Refuses a clip without frames, or with more frames or vertices than an int32 can hold. */
CHECKED mrt_result export_check_size(const clip *c, const char *path, error *err);

/* Returns the time code of the frames: from clip_start_of, else from 00:00:00:00. num 0: the frame
 * rate has no time code. */
void export_timecode(timecode_rate *out_rate, int64_t *out_first, const clip *c);

void export_step(const export_progress *progress, double done);

/* A text file. Until it is closed, this thread writes decimal points in any locale. */
typedef struct export_text {
    file_writer writer; /* write to its stream; errors are found when it is closed */
    locale_t plain, kept;
} export_text;
CHECKED mrt_result export_text_open(export_text *out, const char *path, error *err);
/* Commits the file. If `result` is a failure, it removes the file and returns `result`. */
CHECKED mrt_result export_text_close(export_text *self, mrt_result result, error *err);

#endif
