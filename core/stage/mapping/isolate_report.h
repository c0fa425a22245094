/* stage/mapping/isolate_report.h - what a mapping saw in its last two seconds, and a report of it
 * after it has failed: logs that the log input plays, and what was wrong. The memory is filled by
 * [frame] until it is given to whoever writes the report; never both at once. */
#ifndef MAROTTE_STAGE_ISOLATE_REPORT_H
#define MAROTTE_STAGE_ISOLATE_REPORT_H
#include "base/error.h"

enum { ISOLATE_REPORT_FRAMES = 512 }; /* 2 s at up to 256 samples a second */

typedef struct isolate_seen {
    int64_t time_ns;
    bool present[2];
    float angle[2][MRT_ANGLES], pedal[MRT_MAX_PEDALS];
} isolate_seen;

typedef struct isolate_memory {
    isolate_seen seen[ISOLATE_REPORT_FRAMES];
    uint64_t count; /* ever */
} isolate_memory;

void isolate_memory_add(isolate_memory *self, const mrt_frame *frame);

typedef struct isolate_report {
    const mrt_plugin_type *type;
    const char *library, *reason;
    const mrt_face *face;
    const double *params; /* in table order */
    const isolate_memory *memory;
} isolate_report;
/* [may block] Into a folder of its own in $XDG_DATA_HOME/marotte/reports; out_folder gets its path,
 * and "" when nothing was written. */
CHECKED mrt_result isolate_report_write(const isolate_report *report, char *out_folder,
                                        size_t capacity, error *err);

#endif
