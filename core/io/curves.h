/* io/curves.h - a performance as numbers that people read and change: a table with a row for each
 * frame, and a column for each curve of a clip. What a clip's curves are: clip.h. Leaves out what
 * the numbers do to a face. [main] or a worker. */
#ifndef MAROTTE_IO_CURVES_H
#define MAROTTE_IO_CURVES_H
#include "io/export.h"

/* One row for each frame: frame (from 0), timecode (counted on from clip_start_of, else from
 * 00:00:00:00; empty where the rate has none), time_s, shape; then the clip's curves by their
 * names; then the controls of clip_add_controls, "control1.start.x" to "control1.end.z", mm. A
 * value that is not said is empty. shape: "anchored": the numbers say it all; "committed": on a
 * base that is not the rest shape; "free": the vertices are where earlier samples have left them.
 */
CHECKED mrt_result csv_write(const char *path, const clip *c, const export_progress *progress,
                             error *err);

typedef struct curve_table {
    char **name; /* column_count */
    uint32_t column_count, row_count;
    double *value;         /* row_count by column_count; NaN: empty, or a word */
    uint32_t *bad_row;     /* column_count: 1 + the first row whose cell is a word; 0: none */
    uint32_t *line;        /* row_count: in the file, from 1 */
    char timecode[32];     /* of the first row; "": none */
    uint32_t other_shapes; /* rows whose "shape" is another than "anchored" */
} curve_table;

#define CURVE_TABLE_NONE UINT32_MAX

/* Any table of numbers with a head: commas, or semicolons where its head has no comma; lines that
 * begin with '#' are left out. Refuses rows of another length, no rows, two columns of one name.
 * Errors name the line. `path` is for messages. */
CHECKED mrt_result curve_table_parse(curve_table *out, const void *data, size_t size,
                                     const char *path, error *err);
CHECKED mrt_result curve_table_read(curve_table *out, const char *path, error *err);
void curve_table_finish(curve_table *t);                             /* accepts zeroed */
uint32_t curve_table_find(const curve_table *t, const char *column); /* CURVE_TABLE_NONE */

#endif
