/* io/export_stream.h - what the vertex-cache writers share: numbers in a fixed byte order and the
 * frames of a clip into a file that is being written. On failure the writer is abandoned. */
#ifndef MAROTTE_IO_EXPORT_STREAM_H
#define MAROTTE_IO_EXPORT_STREAM_H
#include "base/file.h"
#include "base/timecode.h"
#include "io/clip.h"
#include "io/export.h"

#include <stddef.h>
#include <stdint.h>

typedef enum export_order { EXPORT_LITTLE_ENDIAN = 0, EXPORT_BIG_ENDIAN } export_order;

/* Four bytes; returns where the next number goes. */
uint8_t *export_pack_u32(uint8_t *out, uint32_t value, export_order order);
uint8_t *export_pack_float(uint8_t *out, float value, export_order order);

CHECKED mrt_result export_put(file_writer *writer, const void *data, size_t size, error *err);
typedef struct export_points { /* which vertices, and in what unit */
    uint32_t *vertex;          /* count, ascending */
    uint32_t count;
    double per_mm;
} export_points;
CHECKED mrt_result export_points_choose(export_points *out, const clip *c,
                                        const cache_options *options, error *err);
void export_points_finish(export_points *points); /* accepts zeroed */
/* Their positions in all frames, x y z per vertex; non-finite ones are an error. */
CHECKED mrt_result export_put_frames(file_writer *writer, const clip *c,
                                     const export_points *points, export_order order,
                                     const export_progress *progress, error *err);

/* Refuses a clip without frames, or with more frames or vertices than an int32 can count. */
CHECKED mrt_result export_check_cache(const clip *c, const char *path, error *err);

/* Time code of the frames: of clip_start_of, else from 00:00:00:00; num 0: the rate has none. */
void export_timecode(timecode_rate *out_rate, int64_t *out_first, const clip *c);

void export_step(const export_progress *progress, double done);

#endif
