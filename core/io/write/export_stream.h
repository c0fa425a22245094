/* io/write/export_stream.h - what writers of clips share: whether a format can count it, its time
 * code, how far it is, files of text. */
#ifndef MAROTTE_IO_EXPORT_STREAM_H
#define MAROTTE_IO_EXPORT_STREAM_H
#include "base/file.h"
#include "base/timecode.h"
#include "io/clip.h"
#include "io/export.h"

#include <locale.h>
#include <stdint.h>

/* Refuses a clip without frames, or with more frames or vertices than an int32 can count. */
CHECKED mrt_result export_check_size(const clip *c, const char *path, error *err);

/* Time code of the frames: of clip_start_of, else from 00:00:00:00; num 0: the rate has none. */
void export_timecode(timecode_rate *out_rate, int64_t *out_first, const clip *c);

void export_step(const export_progress *progress, double done);

/* A file of text: until it is closed this thread writes decimal points, whatever the person's
 * locale. */
typedef struct export_text {
    file_writer writer; /* write to its stream; errors are found when it is closed */
    locale_t plain, kept;
} export_text;
CHECKED mrt_result export_text_open(export_text *out, const char *path, error *err);
/* Commits the file, or leaves nothing behind where `result` is a failure, which is given back. */
CHECKED mrt_result export_text_close(export_text *self, mrt_result result, error *err);

#endif
