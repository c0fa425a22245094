/* window/timeline/drag.h - what a drag on the timeline means: from where it began and where the
 * pointer is now to the edit that it will be, seen at once on a copy of the take. One drag is one
 * step of undo; where an edit is not possible the last possible one stays, and why is said. Leaves
 * out drawing and who makes the edit. [main] or any one thread. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_DRAG_H
#define MAROTTE_UI_WINDOW_TIMELINE_DRAG_H
#include "show/own.h"
#include "window/timeline/layout.h"
#include "window/timeline/axis.h"

typedef enum timeline_drag_kind {
    TIMELINE_DRAG_NONE = 0,
    TIMELINE_DRAG_MOVE,  /* a clip, in time and between layers */
    TIMELINE_DRAG_START, /* trims */
    TIMELINE_DRAG_END,
    TIMELINE_DRAG_SPEED_START, /* retimes: the other end stays */
    TIMELINE_DRAG_SPEED_END,
    TIMELINE_DRAG_FADE_IN,
    TIMELINE_DRAG_FADE_OUT,
    TIMELINE_DRAG_MARKER,
    TIMELINE_DRAG_SOUND,       /* its offset */
    TIMELINE_DRAG_SOUND_START, /* trims it */
    TIMELINE_DRAG_SOUND_END,
    TIMELINE_DRAG_GAIN, /* of a layer, or of the sound where layer is 0; in points */
    TIMELINE_DRAG_ORDER /* of a layer */
} timeline_drag_kind;

enum { TIMELINE_DRAG_EDITS = OWN_REGION_COUNT };
typedef struct timeline_drag {
    timeline_drag_kind kind;
    uint32_t layer, clip; /* that are dragged */
    uint32_t marker;
    int64_t grabbed_ns; /* where it was taken hold of */
    double initial;     /* of a gain */
    int64_t sound_ns;   /* how long the take's sound is; 0: not known */
    take preview;       /* the take as the edit makes it; id 0: nothing has changed */
    edit made;          /* EDIT_NONE: nothing would change */
    int64_t snapped_ns; /* to be shown; INT64_MIN */
    error why;          /* why it goes no further; "" */
} timeline_drag;

const take_layer *timeline_layer(const take *t, uint32_t id); /* NULL: none */
const take_clip *timeline_clip(const take *t, uint32_t id, const take_layer **out_layer);
bool timeline_moves(const take_layer *layer, own_region region); /* something of it */

/* What a press on a part begins; is_retiming: with Alt on an edge. */
timeline_drag_kind timeline_drag_kind_of(timeline_part part, bool is_retiming);
void timeline_drag_begin(timeline_drag *out, timeline_drag_kind kind, const take *t,
                         timeline_hit hit, int64_t at_ns, int64_t sound_ns);
/* at_ns: the pointer's instant; onto_layer: id of the layer under it, 0 none; points: moved across
 * since it began (gains). */
void timeline_drag_to(timeline_drag *self, const take *t, const timeline_snap *snap, int64_t at_ns,
                      uint32_t onto_layer, float points);
/* The take to draw. */
const take *timeline_drag_shown(const timeline_drag *self, const take *t);
void timeline_drag_finish(timeline_drag *self); /* accepts zeroed */

/* ---- comping: a span of another take, for some parts of the face ---- */

#define TIMELINE_ALL_REGIONS ((1u << OWN_REGION_COUNT) - 1u)
/* The edits that show `from`'s span in..out in `t`, their timelines laid on each other (`from` so
 * much later): each of the regions from the layer that moves it there; all of them at once, from
 * the lowest layer, punched into the lowest. Returns how many; 0: `err` says why.
 * in..out become what is possible. Each is to be finished. */
uint32_t timeline_comp_edits(edit out[TIMELINE_DRAG_EDITS], const take *t, const take *from,
                             int64_t later_ns, uint32_t regions, int64_t *in_ns, int64_t *out_ns,
                             error *err);

#endif
