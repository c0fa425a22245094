/* window/viewport/picture.h - a face and what lies over it (hands, control vectors, their reach,
 * contacts, the jaw's axis) as a texture that is drawn anew only when something of it has changed.
 * [main]; drawing with the context, the rest without allocation. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_PICTURE_H
#define MAROTTE_UI_WINDOW_VIEWPORT_PICTURE_H
#include "draw/overlay.h"
#include "window/app/app.h"

#include "face/bones.h"

enum { VIEWPORT_ITEMS_MAX = 1024 };
typedef struct viewport_scene {
    overlay_item item[VIEWPORT_ITEMS_MAX]; /* zeroed where unset, so that memcmp compares */
    uint32_t count;
} viewport_scene;

typedef struct viewport_scene_of {
    const live_view *view;
    const face_file *file;
    const app_looks *looks;
    const draw_camera *camera;
    float aspect;                  /* of the picture, width to height */
    float px_per_point;            /* of the screen */
    const float *contact_position; /* vertex_count by 3, mm: the shape that is shown */
    bool stands_in; /* another shape is shown than the stage's, without control vectors */
} viewport_scene_of;
void viewport_scene_make(viewport_scene *out, const viewport_scene_of *of);
/* What does not fit is left out. */
void viewport_scene_add(viewport_scene *self, const overlay_item *item);

/* The radius at which a kernel is one half, in the support's. */
double viewport_half_radius(csrbf_kernel kernel);

typedef struct viewport_picture viewport_picture;

/* The renderer must outlive it. NULL: no memory. */
viewport_picture *viewport_picture_create(draw_renderer *renderer);
void viewport_picture_destroy(viewport_picture *self); /* NULL is fine */

/* Another face, at rest and in its own colours: takes a tenth of a second. NULL: none. */
CHECKED mrt_result viewport_picture_face(viewport_picture *self, const mesh *m, error *err);
/* Before the shape of a frame that is drawn is given: another tenth, once for each face. m: its
 * mesh. */
CHECKED mrt_result viewport_picture_shade(viewport_picture *self, const mesh *m, error *err);
/* vertex_count by 3, mm; normal NULL: computed. Copied. */
void viewport_picture_shape(viewport_picture *self, const float *position, const float *normal);
/* The same of the stage's face: only what has changed of it is copied. */
void viewport_picture_follow(viewport_picture *self, const live_view *view);
/* vertex_count by 3, linear; NULL: the face's own. Copied. */
void viewport_picture_colour(viewport_picture *self, const float *rgb);

typedef struct viewport_picture_look {
    uint32_t width, height; /* pixels */
    draw_camera camera;
    const viewport_scene *scene;   /* NULL: nothing over the face */
    const scenery *scenery;        /* its light and fit; NULL: the studio */
    const draw_backdrop *backdrop; /* NULL: the wall */
    uint64_t backdrop_number;      /* another one for each */
    const float *ground;           /* rgba behind it in place of both, as draw_ground; NULL: none */
} viewport_picture_look;
/* 0: there is nothing to be shown, err says why. The texture lives until the next call. */
uint32_t viewport_picture_draw(viewport_picture *self, const viewport_picture_look *look,
                               error *err);
uint64_t viewport_picture_shapes(const viewport_picture *self); /* grows with each other shape */
uint64_t viewport_picture_count(const viewport_picture *self);  /* how often it was drawn */

#endif
