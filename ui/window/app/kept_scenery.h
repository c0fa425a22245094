/* window/app/kept_scenery.h - the scene of the open show. Changes appear on the stage immediately,
 * and are saved in the show as one undo step when the user has finished. The background picture is
 * read and decoded on a thread. Leaves out drawing and the panel. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_KEPT_SCENERY_H
#define MAROTTE_UI_WINDOW_APP_KEPT_SCENERY_H
#include "window/app/app.h"

kept_scenery *kept_scenery_create(app *of); /* NULL: no memory */
void kept_scenery_destroy(kept_scenery *self);

/* Another show is open: its scene, and no steps of undo. */
void kept_scenery_read(kept_scenery *self);
const scenery *kept_scenery_now(const kept_scenery *self);
void kept_scenery_set(kept_scenery *self, const scenery *to);
/* The user has finished a change: saves it, as one undo step. */
void kept_scenery_keep(kept_scenery *self);

/* Starts to read a PNG or JPEG for the background, which is then saved in the show. Errors while
 * reading are reported as messages; this returns an error only if it cannot start. */
CHECKED mrt_result kept_scenery_choose(kept_scenery *self, const char *path, error *err);
/* Each frame. */
void kept_scenery_update(kept_scenery *self);
/* What is behind the face; its number is another one for each. rgba NULL: the wall, or it is still
 * being read. */
const scenery_picture *kept_scenery_picture(const kept_scenery *self, uint64_t *out_number);
bool kept_scenery_is_reading(const kept_scenery *self);

#endif
