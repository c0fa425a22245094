/* window/rig_stroke.h - what a stroke of the brush does to a rig. Each ink has a region of its own,
 * behind all others, named after it ("painted jaw"): made when it is first used, so that what the
 * rig said before is still there below the paint, and comes back where it is erased. Inks that
 * exclude each other make room. Where nothing was painted a share begins with what the rig fills in
 * there, so that a soft edge passes over into it. Pure but for its own memory. [main] */
#ifndef MAROTTE_UI_WINDOW_RIG_STROKE_H
#define MAROTTE_UI_WINDOW_RIG_STROKE_H
#include "face/bind.h"
#include "window/brush.h"

typedef enum rig_ink {
    RIG_INK_RIDES = 0, /* a share of a bone */
    RIG_INK_RIGID,     /* all on a bone, cannot be pulled */
    RIG_INK_FREE,      /* mobility */
    RIG_INK_STILL,     /* no mobility */
    RIG_INK_REGION,    /* the vertices of one region, whatever it says */
    RIG_INK_ERASER,    /* of all paint */
    RIG_INKS
} rig_ink;
typedef struct rig_stroke_ink {
    rig_ink ink;
    uint32_t bone, region; /* where the ink is of one */
    double strength;       /* 0..1: the share that full touch gives */
    bool takes_away;       /* out of the region */
} rig_stroke_ink;

typedef struct rig_stroke rig_stroke;
/* sides: a bone NAME.l is NAME.r on the other side. A region of the ink RIG_INK_REGION must be one
 * that rig_edit_can_paint. filled: of this rig on its mesh, or of the one before the last stroke;
 * NULL: not known, shares begin with 0. */
CHECKED mrt_result rig_stroke_begin(rig_stroke **out, const rig *r, uint32_t vertex_count,
                                    const rig_stroke_ink *ink, const binding *filled, error *err);
void rig_stroke_destroy(rig_stroke *self); /* NULL is fine */
/* After each brush_move. */
void rig_stroke_update(rig_stroke *self, const brush *b);
/* What of the ink is at a vertex now, 0..255; of an eraser: what it leaves. */
uint8_t rig_stroke_value(const rig_stroke *self, uint32_t vertex);
/* Which bone the ink is of, here and on the other side; RIG_NONE: none. */
uint32_t rig_stroke_bone(const rig_stroke *self, uint32_t side);
/* Into the rig that it began with, or a copy of it; out_changed: how many vertices. */
CHECKED mrt_result rig_stroke_end(rig_stroke *self, rig *changed, uint32_t *out_changed,
                                  error *err);

#endif
