/* io/curves.h - a performance as a table that users can read and edit, with a row per frame and a
 * column per curve of a clip (clip.h). Leaves out the effect of the values on a face. [main] or a
 * worker. */
#ifndef MAROTTE_IO_CURVES_H
#define MAROTTE_IO_CURVES_H
#include "io/export.h"

/* Writes one row per frame: frame (from 0), timecode, time_s, shape, then the clip's curves by
 * name, then the controls of clip_add_controls, "control1.start.x" to "control1.end.z", mm.
 * timecode counts from clip_start_of, else from 00:00:00:00; it is empty if the rate has none. An
 * unset value is empty. shape: "anchored": the values define the shape completely; "committed":
 * relative to a base that is not the rest shape; "free": the vertices depend on earlier samples. */
CHECKED mrt_result csv_write(const char *path, const clip *c, const export_progress *progress,
                             error *err);

typedef struct curve_table {
    char **name; /* column_count */
    uint32_t column_count, row_count;
    double *value;         /* row_count by column_count; NaN: empty, or a word */
    uint32_t *bad_row;     /* column_count: 1 + the first row whose cell is a word; 0: none */
    uint32_t *line;        /* row_count: in the file, from 1 */
    char timecode[32];     /* time code of the first row; "": none */
    uint32_t other_shapes; /* rows whose "shape" is not "anchored" */
} curve_table;

#define CURVE_TABLE_NONE UINT32_MAX

/* Parses any table of numbers with a header line. The separator is a comma, or a semicolon if the
 * header has no comma. Lines that begin with '#' are skipped. Refused are rows of different length,
 * a table without rows, and two columns of one name. Errors name the line. `path` is for messages.
 * */
CHECKED mrt_result curve_table_parse(curve_table *out, const void *data, size_t size,
                                     const char *path, error *err);
CHECKED mrt_result curve_table_read(curve_table *out, const char *path, error *err);
void curve_table_finish(curve_table *t);                             /* accepts zeroed */
uint32_t curve_table_find(const curve_table *t, const char *column); /* CURVE_TABLE_NONE */

#endif
