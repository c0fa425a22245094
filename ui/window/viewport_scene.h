/* window/viewport_scene.h - what lies over the face, as things in space: hands, control vectors,
 * their reach, contacts, the jaw's axis. From a live view to overlay items; leaves out drawing.
 * [main] no allocation */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_SCENE_H
#define MAROTTE_UI_WINDOW_VIEWPORT_SCENE_H
#include "draw/overlay.h"
#include "face/bones.h"
#include "window/studio.h"

enum { VIEWPORT_ITEMS_MAX = 1024 };
typedef struct viewport_scene {
    overlay_item item[VIEWPORT_ITEMS_MAX]; /* zeroed beyond what is said: may be compared */
    uint32_t count;
} viewport_scene;

typedef struct viewport_scene_of {
    const live_view *view;
    const face_file *file;
    const studio_looks *looks;
    const draw_camera *camera;
    float aspect;                  /* of the picture, width to height */
    float px_per_point;            /* of the screen */
    const float *contact_position; /* vertex_count by 3, mm: the shape that is shown */
    bool stands_in; /* another shape than the stage's: nothing of what pulls the stage's is shown */
} viewport_scene_of;
void viewport_scene_make(viewport_scene *out, const viewport_scene_of *of);
/* What does not fit is left out. */
void viewport_scene_add(viewport_scene *self, const overlay_item *item);

/* The radius at which a kernel is one half, in the support's. */
double viewport_half_radius(csrbf_kernel kernel);
/* Where vector `index` of the view's pull is in the face shown, mm: its contact's way is turned
 * with the bone that it rides on. False: it is none, or moves nothing to be seen. */
bool viewport_vector_shown(const viewport_scene_of *of, uint32_t index, float out_from[3],
                           float out_to[3]);

#endif
