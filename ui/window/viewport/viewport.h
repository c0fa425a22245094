/* window/viewport/viewport.h - the face on the screen: camera, overlays and pointer. It passes the
 * pointer to the rig panel or to learn mode on request. [main], with the graphics context. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_VIEWPORT_H
#define MAROTTE_UI_WINDOW_VIEWPORT_VIEWPORT_H
#include "window/app/app.h"
#include "window/gui/ui.h"

/* Use of the pointer on the face, as requested by a panel. */
typedef enum viewport_use {
    VIEWPORT_PERFORMS = 0, /* the mouse pulls */
    VIEWPORT_PAINTS,       /* the rig panel's brush */
    VIEWPORT_PICKS         /* picks a contact or vertex: learn mode, placing of contacts */
} viewport_use;
typedef struct viewport_stroke { /* point under the pointer in this frame */
    bool is_on_face, is_pressed, is_dragging, is_released;
    uint32_t modifiers;
    uint32_t vertex;  /* nearest vertex, index of the mesh file */
    float rest[3];    /* point on the neutral face, mm */
    float at[3];      /* point on the shown face, mm */
    uint32_t contact; /* 1 + index of the contact near the pointer; 0: none */
    /* Ray of the pointer, also when it is not on the face. eye: mm; ray, forward: unit vectors. */
    float eye[3], ray[3], forward[3];
    float point_rad; /* angle of one screen point */
} viewport_stroke;
typedef struct viewport viewport;
viewport *viewport_create(app *of, error *err);
void viewport_destroy(viewport *self);
struct window_gamepad;
/* Advances the camera and the virtual hand. Call it in each frame before drawing. keys, pad (NULL:
 * none): input for the virtual hand. */
void viewport_update(viewport *self, const ui *keys, const struct window_gamepad *pad, double dt_s);
void viewport_draw(viewport *self, ui *on, ui_rectangle where, float scale);
/* Returns the camera view for saving, and glides to a saved view. */
draw_camera_view viewport_view(const viewport *self);
void viewport_go_to(viewport *self, const draw_camera_view *view);
void viewport_set_use(viewport *self, viewport_use use, float brush_mm); /* from this frame on */
const viewport_stroke *viewport_stroke_now(const viewport *self);        /* of this frame */
/* Sets colours over the face, which are copied: vertex_count by 3, linear. NULL: colours of the
 * current look. */
void viewport_paint(viewport *self, const float *rgb);
/* Shows another shape in place of the stage, such as the neutral face for painting. The stage
 * continues to perform. position and normal: vertex_count by 3, mm, as in live_view; copied. NULL:
 * shows the stage again. */
void viewport_stand_in(viewport *self, const float *position, const float *normal);
/* Sets additional items in space, such as a gizmo. They are copied and shown until the next call.
 * width_px is in points here. */
struct overlay_item;
void viewport_add(viewport *self, const struct overlay_item *item, uint32_t count);
/* Texture of the face without overlays, straight alpha, for the output window and for streams. */
typedef enum viewport_taker {
    VIEWPORT_WINDOW = 0,
    VIEWPORT_STREAM,
    VIEWPORT_PORTRAIT,
    VIEWPORT_TAKERS
} viewport_taker;
uint32_t viewport_output(viewport *self, viewport_taker to, uint32_t width, uint32_t height);
/* Returns how often this texture was drawn, which is the version of its pixels. */
uint64_t viewport_output_drawn(const viewport *self, viewport_taker to);
/* Draws the face in another shape from the front, on a plain colour (as in draw_ground). position:
 * vertex_count by 3, mm. frame: low and high corner of the box that is shown, mm; NULL: the head.
 * Returns a texture, valid until the next call, or 0 on failure. */
uint32_t viewport_portrait(viewport *self, const float *position, uint32_t vertex_count,
                           const float ground[4], const float frame[6], uint32_t width,
                           uint32_t height);
/* Copies the last portrait into a texture of its own, for draw_texture_destroy; 0: there is none.
 */
uint32_t viewport_copy_portrait(viewport *self);
/* Sets the background of the output, as in draw_ground. Copied. */
void viewport_set_ground(viewport *self, const float rgba[4]);
/* Returns how often the face was drawn. It does not increase while nothing changes. */
uint64_t viewport_drawn(const viewport *self);

/* ---- names beside dots: pure; lengths in points ---- */

enum { VIEWPORT_LABELS_MAX = 256 };
typedef struct viewport_label {
    float x, y;          /* position of the dot */
    float width, height; /* size of the name */
    float at_x, at_y;    /* out: the top left of the name */
    bool is_placed;      /* out */
} viewport_label;

/* Places the names in order, so that no name covers another name or a dot or leaves the rectangle.
 * dot: radius of each dot. */
void viewport_labels_place(viewport_label *label, uint32_t count, ui_rectangle within, float dot);

#endif
