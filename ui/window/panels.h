/* window/panels.h - the panels of the desk, each a room of its own: made once, drawn each frame
 * into the rectangle it is given. What they have done is the studio's. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_H
#define MAROTTE_UI_WINDOW_PANELS_H
#include "draw/draw.h"
#include "window/studio.h"
#include "window/ui.h"

typedef struct panel panel;
typedef struct panel_type {
    panel *(*create)(studio *of); /* NULL: no memory */
    void (*destroy)(panel *self); /* NULL is fine */
    /* [main] each frame in which it is seen */
    void (*draw)(panel *self, ui *on, ui_rectangle where);
    /* [main] each frame, seen or not; may be NULL */
    void (*update)(panel *self, double dt_s);
} panel_type;
extern const panel_type panel_devices, panel_mapping, panel_rig, panel_engine, panel_log,
    panel_timeline;

/* ---- between the rig panel and the viewport ---- */

/* What the pointer does on the face: the viewport gives it to whoever asked for it. */
typedef enum viewport_use {
    VIEWPORT_PERFORMS = 0, /* the mouse pulls */
    VIEWPORT_PAINTS,       /* the rig panel's brush */
    VIEWPORT_PICKS         /* a contact or a vertex is chosen: learn mode, contact placing */
} viewport_use;
typedef struct viewport_stroke { /* one place under the pointer, of this frame */
    bool is_on_face, is_pressed, is_dragging, is_released;
    uint32_t modifiers;
    uint32_t vertex;  /* nearest to the place; mesh file */
    float rest[3];    /* mm: that place of the rest face */
    float at[3];      /* mm: of the face shown */
    uint32_t contact; /* 1 + index: within reach of the pointer; 0: none */
    /* The pointer's ray, on the face or not: from the eye, and where the eye looks; mm, unit. */
    float eye[3], ray[3], forward[3];
    float point_rad; /* the angle that a point of the screen covers */
} viewport_stroke;
typedef struct viewport viewport;
viewport *viewport_create(studio *of, error *err);
void viewport_destroy(viewport *self);
struct front_gamepad;
/* Each frame, before it is drawn: time goes on for the camera and the virtual hand, whose keys and
 * gamepad (NULL: none) these are. */
void viewport_update(viewport *self, const ui *keys, const struct front_gamepad *pad, double dt_s);
void viewport_draw(viewport *self, ui *on, ui_rectangle where, float scale);
void viewport_set_use(viewport *self, viewport_use use, float brush_mm); /* for this frame and on */
const viewport_stroke *viewport_stroke_now(const viewport *self);        /* of this frame */
/* Colours over the face, vertex_count by 3, linear; NULL: as the looks say. Copied. */
void viewport_paint(viewport *self, const float *rgb);
/* A face shown instead of the stage's (at rest while it is painted, a jaw that is tried): position
 * and normal vertex_count by 3, mm, as live_view's; the stage performs on. NULL: the stage's again.
 * Copied. */
void viewport_stand_in(viewport *self, const float *position, const float *normal);
/* Extra things in space (a gizmo): copied, until said again. Their width_px are points here. */
struct overlay_item;
void viewport_add(viewport *self, const struct overlay_item *item, uint32_t count);
/* The face alone as a texture for the output window. */
uint32_t viewport_output(viewport *self, uint32_t width, uint32_t height);
uint64_t
viewport_drawn(const viewport *self); /* how often it drew the face: not while all is still */
/* The one of the desk; NULL: none (a test of a panel alone). */
viewport *studio_viewport(studio *self);
void studio_set_viewport(studio *self, viewport *v);

#endif
