/* window/rig/brush.h - painting on a face. A brush computes how strongly a stroke touches each
 * vertex of the neutral mesh. A rig_stroke applies an ink to the rig with these values. mm; pure
 * except for its own memory. [main] */
#ifndef MAROTTE_UI_WINDOW_RIG_BRUSH_H
#define MAROTTE_UI_WINDOW_RIG_BRUSH_H
#include "face/bind.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

typedef struct brush brush;

typedef enum brush_falloff { BRUSH_SMOOTH = 0, BRUSH_HARD } brush_falloff;
typedef enum brush_sides { BRUSH_ONE_SIDE = 0, BRUSH_BOTH_SIDES } brush_sides;
typedef struct brush_shape {
    double radius_mm;
    brush_falloff falloff;
    brush_sides sides; /* also paint the mirror image */
} brush_shape;

/* The mesh and its topology must outlive the brush. */
CHECKED mrt_result brush_create(brush **out, const mesh *m, const topology *t, error *err);
void brush_destroy(brush *self); /* NULL is fine */

/* Starts a stroke and clears all touch values. */
void brush_begin(brush *self, const brush_shape *shape);
/* Moves the brush to `position`, whose nearest vertex is `vertex`. Touches the surface between the
 * previous and the new position, if it is connected. */
CHECKED mrt_result brush_move(brush *self, uint32_t vertex, const float position[3], error *err);

enum { BRUSH_HERE = 0, BRUSH_THERE = 1 }; /* side of the pointer; mirrored side */
/* Returns vertex_count touch values, 0 (not touched) to 1. Valid until the next stroke. */
const float *brush_touch(const brush *self, uint32_t side);
/* Returns the vertices that are touched on any side, in the order of their first touch. */
const uint32_t *brush_touched(const brush *self, uint32_t *out_count);

/* Returns the vertex at or nearest to the mirror image. Of two at the same place, returns the one
 * with the matching normal. UINT32_MAX: none is near. */
uint32_t brush_mirror_of(const brush *self, uint32_t vertex);
const float *brush_normals(const brush *self); /* vertex_count by 3, of the neutral mesh */
/* Computes smooth normals for other positions of a mesh. out, position: vertex_count by 3; scratch:
 * 6 by vertex_count. */
void brush_find_normals(float *out, const mesh *m, const float *position, float *scratch);
double brush_middle_mm(const brush *self); /* x of the plane of symmetry */

typedef enum rig_ink {
    RIG_INK_RIDES = 0, /* adds weight of a bone */
    RIG_INK_RIGID,     /* full weight of a bone, cannot be pulled */
    RIG_INK_FREE,      /* full mobility */
    RIG_INK_STILL,     /* no mobility */
    RIG_INK_REGION,    /* adds vertices to one region, whatever its effect */
    RIG_INK_ERASER,    /* removes all paint */
    RIG_INKS
} rig_ink;
typedef struct rig_stroke_ink {
    rig_ink ink;
    uint32_t bone, region; /* bone or region of the ink, if it has one */
    double strength;       /* 0..1: weight at full touch */
    bool takes_away;       /* remove vertices from the region */
} rig_stroke_ink;

typedef struct rig_stroke rig_stroke;
/* Starts a stroke. On the mirrored side, a bone NAME.l becomes NAME.r. RIG_INK_REGION needs a
 * region that passes rig_edit_can_paint. filled: binding of this rig, or of the rig before the last
 * stroke; NULL: unknown, weights start at 0. */
CHECKED mrt_result rig_stroke_begin(rig_stroke **out, const rig *r, uint32_t vertex_count,
                                    const rig_stroke_ink *ink, const binding *filled, error *err);
void rig_stroke_destroy(rig_stroke *self); /* NULL is fine */
/* Updates the stroke. Call it after each brush_move. */
void rig_stroke_update(rig_stroke *self, const brush *b);
/* Returns the ink at a vertex, 0..255. For the eraser: the remaining ink. */
uint8_t rig_stroke_value(const rig_stroke *self, uint32_t vertex);
/* Returns the bone of the ink on a side, or RIG_NONE. */
uint32_t rig_stroke_bone(const rig_stroke *self, uint32_t side);
/* Writes the stroke into the rig that it started with, or into a copy. out_changed: number of
 * changed vertices. */
CHECKED mrt_result rig_stroke_end(rig_stroke *self, rig *changed, uint32_t *out_changed,
                                  error *err);

#endif
