/* stage/mapping/isolate_report.h - records the last two seconds of a mapping's inputs. After a
 * failure it writes a report: the inputs as files for the log input, and the reason. [frame] fills
 * the memory. Before the report is written, the memory is handed over; two threads never use it
 * together. */
#ifndef MAROTTE_STAGE_ISOLATE_REPORT_H
#define MAROTTE_STAGE_ISOLATE_REPORT_H
#include "base/error.h"

enum { ISOLATE_REPORT_FRAMES = 512 }; /* 2 s at up to 256 samples per second */

typedef struct isolate_seen {
    int64_t time_ns;
    bool present[2];
    float angle[2][MRT_ANGLES], pedal[MRT_MAX_PEDALS];
} isolate_seen;

typedef struct isolate_memory {
    isolate_seen seen[ISOLATE_REPORT_FRAMES];
    uint64_t count; /* total number since the start */
} isolate_memory;

void isolate_memory_add(isolate_memory *self, const mrt_frame *frame);

typedef struct isolate_report {
    const mrt_plugin_type *type;
    const char *library, *reason;
    const mrt_face *face;
    const double *params; /* in table order */
    const isolate_memory *memory;
} isolate_report;
/* [may block] Writes a new folder in $XDG_DATA_HOME/marotte/reports. out_folder: its path, or "" if
 * nothing was written. */
CHECKED mrt_result isolate_report_write(const isolate_report *report, char *out_folder,
                                        size_t capacity, error *err);

#endif
