/* window/timeline_snap.h - to which instant a drag is drawn: the play head, ends of clips, markers,
 * the range, else the grid of frames. Pure. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_SNAP_H
#define MAROTTE_UI_WINDOW_TIMELINE_SNAP_H
#include "window/timeline_ticks.h"

typedef struct timeline_snap {
    const take *take;
    timeline_code code;
    int64_t head_ns;        /* INT64_MIN: none */
    int64_t in_ns, out_ns;  /* the range; in >= out: none */
    int64_t reach_ns;       /* how near things are that draw; <= 0: nothing does, nor the grid */
    uint32_t without_clip;  /* its ends do not draw; 0 */
    int32_t without_marker; /* -1 */
} timeline_snap;

/* *out_to (may be NULL): the thing that it was drawn to, to be shown; INT64_MIN: none or the grid.
 */
int64_t timeline_snap_to(const timeline_snap *snap, int64_t at_ns, int64_t *out_to);
/* A span that keeps its length: by whichever end is nearer to something. The start comes back. */
int64_t timeline_snap_span(const timeline_snap *snap, int64_t start_ns, int64_t length_ns,
                           int64_t *out_to);

#endif
