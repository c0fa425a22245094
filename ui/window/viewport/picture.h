/* window/viewport/picture.h - a texture of the face with its overlays: hands, control vectors,
 * their reach, contacts, the jaw axis. It is redrawn only after a change. [main]; drawing needs the
 * graphics context, the rest does not allocate. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_PICTURE_H
#define MAROTTE_UI_WINDOW_VIEWPORT_PICTURE_H
#include "draw/overlay.h"
#include "window/app/app.h"

#include "face/bones.h"

enum { VIEWPORT_ITEMS_MAX = 1024 };
typedef struct viewport_scene {
    overlay_item item[VIEWPORT_ITEMS_MAX]; /* zeroed, so that memcmp can compare it */
    uint32_t count;
} viewport_scene;

typedef struct viewport_scene_of {
    const live_view *view;
    const face_file *file;
    const app_looks *looks;
    const draw_camera *camera;
    float aspect;                  /* width / height of the picture */
    float px_per_point;            /* scale of the screen */
    const float *contact_position; /* vertex_count by 3, mm; the shown shape */
    bool stands_in;                /* shows another shape than the stage, without control vectors */
} viewport_scene_of;
void viewport_scene_make(viewport_scene *out, const viewport_scene_of *of);
/* Adds an item. Ignores it if the scene is full. */
void viewport_scene_add(viewport_scene *self, const overlay_item *item);

/* Returns the radius at which a kernel has the value 0.5, as share of its support. */
double viewport_half_radius(csrbf_kernel kernel);

typedef struct viewport_picture viewport_picture;

/* Creates a picture. The renderer must outlive it. NULL: no memory. */
viewport_picture *viewport_picture_create(draw_renderer *renderer);
void viewport_picture_destroy(viewport_picture *self); /* NULL is fine */

/* Sets another face, neutral and in its own colours. Takes 0.1 s. m NULL: none. */
CHECKED mrt_result viewport_picture_face(viewport_picture *self, const mesh *m, error *err);
/* Prepares the shading of a face. Call it once for each face, before the shape of the first drawn
 * frame. Takes 0.1 s. m: its mesh. */
CHECKED mrt_result viewport_picture_shade(viewport_picture *self, const mesh *m, error *err);
/* Sets the shape, which is copied: vertex_count by 3, mm. normal NULL: computed. */
void viewport_picture_shape(viewport_picture *self, const float *position, const float *normal);
/* Sets the shape from the stage. Copies only changed data. */
void viewport_picture_follow(viewport_picture *self, const live_view *view);
/* Sets the colours, which are copied: vertex_count by 3, linear. NULL: colours of the face. */
void viewport_picture_colour(viewport_picture *self, const float *rgb);

typedef struct viewport_picture_look {
    uint32_t width, height; /* pixels */
    draw_camera camera;
    const viewport_scene *scene;   /* NULL: no overlays */
    const scenery *scenery;        /* light and fit; NULL: studio */
    const draw_backdrop *backdrop; /* NULL: the wall */
    uint64_t backdrop_number;      /* version of the backdrop */
    const float *ground; /* rgba background that replaces both, as in draw_ground; NULL: none */
} viewport_picture_look;
/* Draws the picture if necessary and returns its texture, valid until the next call. Returns 0 with
 * the reason in err if nothing can be shown. */
uint32_t viewport_picture_draw(viewport_picture *self, const viewport_picture_look *look,
                               error *err);
/* Copies the last picture into a texture of its own, for draw_texture_destroy; 0: none was drawn.
 */
uint32_t viewport_picture_copy(viewport_picture *self);
uint64_t viewport_picture_shapes(const viewport_picture *self); /* increases with each new shape */
uint64_t viewport_picture_count(const viewport_picture *self);  /* number of draws */

#endif
