#include "window/timeline_snap.h"

#include <stddef.h>

typedef struct nearest {
    int64_t at_ns, away_ns, to_ns;
    bool is_found;
} nearest;

static void consider(nearest *n, int64_t to_ns)
{
    int64_t away_ns = to_ns > n->at_ns ? to_ns - n->at_ns : n->at_ns - to_ns;
    if (away_ns > n->away_ns || (n->is_found && away_ns == n->away_ns))
        return;
    *n = (nearest){n->at_ns, away_ns, to_ns, true};
}

static nearest find(const timeline_snap *snap, int64_t at_ns)
{
    const take *t = snap->take;
    nearest n = {.at_ns = at_ns, .away_ns = snap->reach_ns};
    if (snap->reach_ns <= 0)
        return n;
    if (snap->head_ns != INT64_MIN)
        consider(&n, snap->head_ns);
    if (snap->in_ns < snap->out_ns) {
        consider(&n, snap->in_ns);
        consider(&n, snap->out_ns);
    }
    consider(&n, 0);
    if (!t)
        return n;
    consider(&n, t->duration_ns);
    for (uint32_t i = 0; i < t->marker_count; ++i)
        if ((int32_t)i != snap->without_marker)
            consider(&n, t->marker[i].at_ns);
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k) {
            const take_clip *clip = &t->layer[i].clip[k];
            if (clip->id == snap->without_clip)
                continue;
            consider(&n, clip->start_ns + t->layer[i].offset_ns);
            consider(&n, clip->end_ns + t->layer[i].offset_ns);
        }
    return n;
}

/* Frames draw everything, if they are far enough from each other to be meant. */
static int64_t on_grid(const timeline_snap *snap, int64_t at_ns)
{
    if (snap->reach_ns <= 0)
        return at_ns;
    timecode_rate rate = snap->code.rate;
    return timecode_time_ns(rate, timecode_nearest_frame(rate, at_ns));
}

int64_t timeline_snap_to(const timeline_snap *snap, int64_t at_ns, int64_t *out_to)
{
    nearest n = find(snap, at_ns);
    if (out_to)
        *out_to = n.is_found ? n.to_ns : INT64_MIN;
    return n.is_found ? n.to_ns : on_grid(snap, at_ns);
}

int64_t timeline_snap_span(const timeline_snap *snap, int64_t start_ns, int64_t length_ns,
                           int64_t *out_to)
{
    nearest start = find(snap, start_ns), end = find(snap, start_ns + length_ns);
    if (out_to)
        *out_to = INT64_MIN;
    if (!start.is_found && !end.is_found)
        return on_grid(snap, start_ns);
    bool by_end = end.is_found && (!start.is_found || end.away_ns < start.away_ns);
    if (out_to)
        *out_to = by_end ? end.to_ns : start.to_ns;
    return by_end ? end.to_ns - length_ns : start.to_ns;
}
