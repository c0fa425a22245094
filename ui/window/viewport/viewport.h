/* window/viewport/viewport.h - the face on the screen: camera, what lies over it, and what the
 * pointer does on it, which it gives to whoever asks (the rig panel, learn mode). [main], with the
 * context. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_VIEWPORT_H
#define MAROTTE_UI_WINDOW_VIEWPORT_VIEWPORT_H
#include "window/app/app.h"
#include "window/gui/ui.h"

/* What the pointer does on the face: the viewport gives it to whoever asked for it. */
typedef enum viewport_use {
    VIEWPORT_PERFORMS = 0, /* the mouse pulls */
    VIEWPORT_PAINTS,       /* the rig panel's brush */
    VIEWPORT_PICKS         /* a contact or a vertex is chosen: learn mode, contact placing */
} viewport_use;
typedef struct viewport_stroke { /* what is under the pointer in this frame */
    bool is_on_face, is_pressed, is_dragging, is_released;
    uint32_t modifiers;
    uint32_t vertex;  /* nearest to that point; of the mesh file */
    float rest[3];    /* mm: that point of the rest face */
    float at[3];      /* mm: of the face shown */
    uint32_t contact; /* 1 + index: within reach of the pointer; 0: none */
    /* The pointer's ray, on the face or not: from the eye, and where the eye looks; mm, unit. */
    float eye[3], ray[3], forward[3];
    float point_rad; /* the angle that a point of the screen covers */
} viewport_stroke;
typedef struct viewport viewport;
viewport *viewport_create(app *of, error *err);
void viewport_destroy(viewport *self);
struct window_gamepad;
/* Each frame, before it is drawn: time goes on for the camera and the virtual hand, whose keys and
 * gamepad (NULL: none) these are. */
void viewport_update(viewport *self, const ui *keys, const struct window_gamepad *pad, double dt_s);
void viewport_draw(viewport *self, ui *on, ui_rectangle where, float scale);
/* The camera, as it is kept; and a glide to one that was. */
draw_camera_view viewport_view(const viewport *self);
void viewport_go_to(viewport *self, const draw_camera_view *view);
void viewport_set_use(viewport *self, viewport_use use, float brush_mm); /* for this frame and on */
const viewport_stroke *viewport_stroke_now(const viewport *self);        /* of this frame */
/* Colours over the face, vertex_count by 3, linear; NULL: as the looks say. Copied. */
void viewport_paint(viewport *self, const float *rgb);
/* A face shown instead of the stage's (at rest while it is painted, a jaw that is tried): position
 * and normal vertex_count by 3, mm, as live_view's; the stage performs on. NULL: the stage's again.
 * Copied. */
void viewport_stand_in(viewport *self, const float *position, const float *normal);
/* Extra things in space (a gizmo); copied, and shown until the next call. Their width_px are points
 * here. */
struct overlay_item;
void viewport_add(viewport *self, const struct overlay_item *item, uint32_t count);
/* The face alone as a texture, straight alpha: for the output window, for those who take pictures.
 */
typedef enum viewport_taker {
    VIEWPORT_WINDOW = 0,
    VIEWPORT_STREAM,
    VIEWPORT_PORTRAIT,
    VIEWPORT_TAKERS
} viewport_taker;
uint32_t viewport_output(viewport *self, viewport_taker to, uint32_t width, uint32_t height);
/* How many times it was drawn for it: the version of that texture's pixels. */
uint64_t viewport_output_drawn(const viewport *self, viewport_taker to);
/* The face in another shape, from the front, before one colour (as draw_ground). position:
 * vertex_count by 3, mm. 0: it cannot be drawn. Until the next call. */
uint32_t viewport_portrait(viewport *self, const float *position, uint32_t vertex_count,
                           const float ground[4], uint32_t width, uint32_t height);
/* What is behind the output: as draw_ground. Copied. */
void viewport_set_ground(viewport *self, const float rgba[4]);
/* How many times the face was drawn: not while nothing changes. */
uint64_t viewport_drawn(const viewport *self);

/* ---- names beside dots: pure; lengths in points ---- */

enum { VIEWPORT_LABELS_MAX = 256 };
typedef struct viewport_label {
    float x, y;          /* of the dot */
    float width, height; /* of the name */
    float at_x, at_y;    /* out: the top left of the name */
    bool is_placed;      /* out */
} viewport_label;

/* The first come first: none covers another's name or dot, or leaves the rectangle. dot: radius of
 * each dot. */
void viewport_labels_place(viewport_label *label, uint32_t count, ui_rectangle within, float dot);

#endif
