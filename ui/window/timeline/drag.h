/* window/timeline/drag.h - drags on the timeline. Computes the edit from the start of the drag and
 * the current pointer, with a preview on a copy of the take. One drag is one undo step. If an edit
 * is not possible, the last possible edit stays and `why` has the reason. Leaves out drawing and
 * applying the edit. [main] or any one thread. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_DRAG_H
#define MAROTTE_UI_WINDOW_TIMELINE_DRAG_H
#include "show/own.h"
#include "window/timeline/layout.h"
#include "window/timeline/axis.h"

typedef enum timeline_drag_kind {
    TIMELINE_DRAG_NONE = 0,
    TIMELINE_DRAG_MOVE,  /* moves a clip in time and between layers */
    TIMELINE_DRAG_START, /* trims the clip */
    TIMELINE_DRAG_END,
    TIMELINE_DRAG_SPEED_START, /* changes the speed; the other end stays */
    TIMELINE_DRAG_SPEED_END,
    TIMELINE_DRAG_FADE_IN,
    TIMELINE_DRAG_FADE_OUT,
    TIMELINE_DRAG_MARKER,
    TIMELINE_DRAG_SOUND,       /* moves the sound */
    TIMELINE_DRAG_SOUND_START, /* trims the sound */
    TIMELINE_DRAG_SOUND_END,
    TIMELINE_DRAG_GAIN, /* sets the gain of a layer (of the sound: layer 0), by points */
    TIMELINE_DRAG_ORDER /* moves a layer */
} timeline_drag_kind;

enum { TIMELINE_DRAG_EDITS = OWN_REGION_COUNT };
typedef struct timeline_drag {
    timeline_drag_kind kind;
    uint32_t layer, clip; /* dragged items */
    uint32_t marker;
    int64_t grabbed_ns;      /* time at the grabbed point */
    double initial;          /* gain at the start of the drag */
    int64_t sound_ns;        /* duration of the take's sound; 0: unknown */
    bool is_ripple;          /* what follows the clip moves along */
    take preview;            /* take after the edit; id 0: no change */
    edit made;               /* EDIT_NONE: no change */
    uint32_t edition;        /* grows with each change of `made` */
    timeline_target snapped; /* what it has snapped to */
    error why;               /* why the edit is not possible; may be "" */
} timeline_drag;

const take_layer *timeline_layer(const take *t, uint32_t id); /* NULL: none */
const take_clip *timeline_clip(const take *t, uint32_t id, const take_layer **out_layer);
bool timeline_moves(const take_layer *layer,
                    own_region region); /* whether the layer moves a part of the region */

/* Returns the drag that a press on a part starts. is_retiming: Ctrl is held on an edge. */
timeline_drag_kind timeline_drag_kind_of(timeline_part part, bool is_retiming);
void timeline_drag_begin(timeline_drag *out, timeline_drag_kind kind, const take *t,
                         timeline_hit hit, int64_t at_ns, int64_t sound_ns);
/* Updates the drag. at_ns: time at the pointer. onto_layer: id of the layer under the pointer, 0:
 * none. points: horizontal movement since the start (gain). */
void timeline_drag_to(timeline_drag *self, const take *t, const timeline_snap *snap, int64_t at_ns,
                      uint32_t onto_layer, float points);
/* Whether what follows moves with the drag. */
bool timeline_drag_ripples(const timeline_drag *self);
/* Whether the drag changes the face: not the sound or a marker. */
bool timeline_drag_moves_face(const timeline_drag *self);
/* Returns the take to draw. */
const take *timeline_drag_shown(const timeline_drag *self, const take *t);
void timeline_drag_finish(timeline_drag *self); /* accepts zeroed memory */

/* ---- comping: a span of another take, for some parts of the face ---- */

#define TIMELINE_ALL_REGIONS ((1u << OWN_REGION_COUNT) - 1u)
/* Makes the edits that copy the span in..out of the take `from` into `t`, with `from` shifted by
 * later_ns. Each region comes from the layer that moves it. All regions together come from the
 * lowest layer and are punched into the lowest layer. in..out are clamped to the available span.
 * The caller finishes each edit. Returns the number of edits; 0: failed, see `err`. */
uint32_t timeline_comp_edits(edit out[TIMELINE_DRAG_EDITS], const take *t, const take *from,
                             int64_t later_ns, uint32_t regions, int64_t *in_ns, int64_t *out_ns,
                             error *err);

#endif
