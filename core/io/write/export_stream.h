/* io/export_stream.h - what writers of clips share: whether a format can count it, its time code,
 * how far it is. */
#ifndef MAROTTE_IO_EXPORT_STREAM_H
#define MAROTTE_IO_EXPORT_STREAM_H
#include "base/timecode.h"
#include "io/clip.h"
#include "io/export.h"

#include <stdint.h>

/* Refuses a clip without frames, or with more frames or vertices than an int32 can count. */
CHECKED mrt_result export_check_size(const clip *c, const char *path, error *err);

/* Time code of the frames: of clip_start_of, else from 00:00:00:00; num 0: the rate has none. */
void export_timecode(timecode_rate *out_rate, int64_t *out_first, const clip *c);

void export_step(const export_progress *progress, double done);

#endif
