/* window/rig/brush.h - painting on a face: a brush on the surface of a mesh at rest says how
 * strongly a stroke has touched each vertex, and a stroke with an ink says what that does to the
 * rig. mm; pure but for its own memory. [main] */
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
    brush_sides sides; /* the mirror image of the stroke too */
} brush_shape;

/* The mesh and its topology must outlive it. */
CHECKED mrt_result brush_create(brush **out, const mesh *m, const topology *t, error *err);
void brush_destroy(brush *self); /* NULL is fine */

/* A stroke: nothing is touched yet. */
void brush_begin(brush *self, const brush_shape *shape);
/* Moves on to `position`, whose nearest vertex is `vertex`; touches what lies between it and the
 * position before, where a surface connects them. */
CHECKED mrt_result brush_move(brush *self, uint32_t vertex, const float position[3], error *err);

enum { BRUSH_HERE = 0, BRUSH_THERE = 1 }; /* where the pointer was; its mirror image */
/* vertex_count: 0 not touched .. 1. Until the next stroke. */
const float *brush_touch(const brush *self, uint32_t side);
/* Which vertices any of the two is above 0 at, in the order in which they were touched. */
const uint32_t *brush_touched(const brush *self, uint32_t *out_count);

/* The vertex that is the mirror image, or nearest to it; where two lie there, the one that faces
 * alike. UINT32_MAX: none is near. */
uint32_t brush_mirror_of(const brush *self, uint32_t vertex);
const float *brush_normals(const brush *self); /* vertex_count by 3: of the mesh at rest */
/* Smooth ones at other positions of a mesh: both vertex_count by 3; scratch: 6 by vertex_count. */
void brush_find_normals(float *out, const mesh *m, const float *position, float *scratch);
double brush_middle_mm(const brush *self); /* x of the plane of symmetry */

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
/* The ink at a vertex, 0..255; of an eraser what is left there. */
uint8_t rig_stroke_value(const rig_stroke *self, uint32_t vertex);
/* Which bone the ink is of, here and on the other side; RIG_NONE: none. */
uint32_t rig_stroke_bone(const rig_stroke *self, uint32_t side);
/* Into the rig that it began with, or a copy of it; out_changed: how many vertices. */
CHECKED mrt_result rig_stroke_end(rig_stroke *self, rig *changed, uint32_t *out_changed,
                                  error *err);

#endif
