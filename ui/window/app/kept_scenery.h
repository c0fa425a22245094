/* window/app/kept_scenery.h - the scene of the show that is open: on the stage at once, in the show
 * once it is as the person wants it, and a step of undo each time. Its picture is read and decoded
 * beside the window. Leaves out drawing and the panel. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_KEPT_SCENERY_H
#define MAROTTE_UI_WINDOW_APP_KEPT_SCENERY_H
#include "window/app/app.h"

kept_scenery *kept_scenery_create(app *of); /* NULL: no memory */
void kept_scenery_destroy(kept_scenery *self);

/* Another show is open: its scene, and no steps of undo. */
void kept_scenery_read(kept_scenery *self);
const scenery *kept_scenery_now(const kept_scenery *self);
void kept_scenery_set(kept_scenery *self, const scenery *to);
/* What was set is as it is wanted. */
void kept_scenery_keep(kept_scenery *self);

/* A PNG or JPEG behind the face: it comes into the show when it has been read; what is wrong with
 * it is in the news. An error is that it is not even tried. */
CHECKED mrt_result kept_scenery_choose(kept_scenery *self, const char *path, error *err);
/* Each frame. */
void kept_scenery_update(kept_scenery *self);
/* What is behind the face; its number is another one for each. rgba NULL: the wall, or it is still
 * being read. */
const scenery_picture *kept_scenery_picture(const kept_scenery *self, uint64_t *out_number);
bool kept_scenery_is_reading(const kept_scenery *self);

#endif
