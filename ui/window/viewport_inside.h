/* window/viewport_inside.h - the inside of the viewport: its parts, and the steps of a frame that
 * are files of their own. [main] */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_INSIDE_H
#define MAROTTE_UI_WINDOW_VIEWPORT_INSIDE_H
#include "window/panels.h"
#include "window/viewport_camera.h"
#include "window/viewport_grip.h"
#include "window/viewport_heat.h"
#include "window/viewport_picture.h"
#include "window/virtual_hand.h"

typedef enum viewport_drag { /* what the button that is down does */
                             VIEWPORT_DRAGS_NOTHING = 0,
                             VIEWPORT_ORBITS,
                             VIEWPORT_PANS,
                             VIEWPORT_HOLDS, /* the face, by the grip */
                             VIEWPORT_GIVES  /* to whoever asked for the pointer */
} viewport_drag;

typedef struct viewport_face { /* which face is shown: another if any of these is */
    const face_file *file;
    const rig *rig;
    const float *position;
    const uint32_t *triangle;
    uint32_t vertex_count;
} viewport_face;

typedef struct viewport_quality { /* pixels are saved while a slow renderer must draw anew */
    uint32_t level;               /* of quality_scale; 0: all pixels */
    double slow_s, still_s;
    uint64_t count; /* of the picture, a frame ago */
} viewport_quality;

struct viewport {
    studio *of;
    draw_renderer *renderer;
    viewport_picture *picture, *output; /* output: the face alone; NULL: not asked for yet */
    viewport_face face;
    uint64_t surface; /* a hash of all of the mesh that is drawn */
    bool has_face, output_has_face;
    float low[3], high[3]; /* mm: of the face at rest */
    virtual_hand *hand;
    double dt_s;

    float *shape, *normal; /* vertex_count by 3: as shown */
    float *stand_in;       /* 2 by vertex_count by 3; used while stands_in */
    bool stands_in;
    viewport_heat *heat; /* NULL: not asked for yet */
    float *rgb, *paint;  /* vertex_count by 3 */
    bool has_paint, is_painted_anew;
    studio_heat heat_shown;
    uint64_t colours_of; /* which shape they were found for */
    bool has_colours, has_failed;
    overlay_item *extra;
    uint32_t extra_count, extra_capacity;

    viewport_camera camera;
    bool has_camera;
    double camera_kept[VIEWPORT_CAMERA_KEPT];

    viewport_scene scene;
    viewport_quality quality;
    ui_rectangle where; /* points, on the screen */
    float px_per_point;
    uint32_t rectangle[4]; /* of the whole picture, pixels: 0, 0, width, height */

    viewport_use use;
    float brush_mm;
    viewport_drag drag;
    viewport_grip grip;
    double radius_mm; /* of the pointer; 0: the rig's */
    double radius_shown_s;
    bool is_over, is_on_face; /* the pointer: over the viewport, on the face */
    float pointer_px[2];
    draw_hit hit;      /* while it is on the face */
    uint32_t contact;  /* 1 + index: in reach of the pointer; 0: none */
    bool is_off_stage; /* a take is shown: what is pulled would not be seen */
    viewport_stroke stroke;
};

/* ---- viewport.c ---- */

float viewport_aspect(const viewport *self);
void viewport_keep_camera(viewport *self);
void viewport_say(const viewport *self, int32_t level, const char *text);

/* ---- viewport_follow.c: which face, shape and colours are shown ---- */

void viewport_drop_face(viewport *self);
void viewport_follow_face(viewport *self);
void viewport_follow_shape(viewport *self);
void viewport_follow_colours(viewport *self);

/* ---- viewport_pointer.c: what the pointer finds and does ---- */

void viewport_point(viewport *self, const ui_canvas *canvas);
void viewport_let_go(viewport *self); /* of whatever is held */
/* Points from the canvas's top left; false: behind the eye. */
bool viewport_to_points(const viewport *self, const float at[3], float *out_x, float *out_y);
/* Where a contact is in the shape that is shown, and whether that side of it is seen. */
void viewport_contact_at(const viewport *self, uint32_t contact, float out[3]);
bool viewport_contact_is_seen(const viewport *self, uint32_t contact);
double viewport_radius_mm(const viewport *self); /* of the support of what is pulled */

/* ---- viewport_ink.c: what is written over the picture ---- */

void viewport_ink(const viewport *self, ui *on);

#endif
