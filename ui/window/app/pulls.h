/* window/app/pulls.h - what the pointer left on the live face, as steps of undo: a pull with Shift,
 * clay, and what cleared them. Keeps the face as it was before each; leaves out how the pointer
 * pulls (stage/perform/pointer.h). [main] */
#ifndef MAROTTE_UI_WINDOW_APP_PULLS_H
#define MAROTTE_UI_WINDOW_APP_PULLS_H
#include "window/app/app.h"

typedef struct pulls pulls;
pulls *pulls_create(app *of); /* NULL: no memory */
void pulls_destroy(pulls *self);

/* Before the pointer takes hold, and before everything that is held is cleared: the face as it is.
 */
void pulls_begin(pulls *self);
/* What began has stayed: a step of undo. Without this, nothing has been done. */
void pulls_did(pulls *self, const char *words);
/* Another face: there is nothing to go back to. */
void pulls_forget(pulls *self);
/* The owner of its steps, as app_step. */
bool pulls_is_step(const pulls *self, const app_step *step);
bool pulls_is_held(const pulls *self); /* something is there to be cleared */
void pulls_clear(pulls *self);         /* Neutral; a step of undo if something was held */

#endif
