/* window/app/expressions.h - fades named poses of the rig in and out over the performance. They
 * arrive like a device: as an input with a channel for each pose, which is recorded, and as
 * connections of the patch. So a take performs them again. The input exists only after
 * expressions_want. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_EXPRESSIONS_H
#define MAROTTE_UI_WINDOW_APP_EXPRESSIONS_H
#include "stage/perform/patch.h"

struct app;
typedef struct expressions expressions;
expressions *expressions_create(struct app *of); /* NULL: no memory */
void expressions_destroy(expressions *self);     /* after the stage ended; NULL is fine */

/* Adds the input to the stage, so that expressions can be requested. */
void expressions_want(expressions *self);
/* Once a frame. True: the connections are others than before. */
bool expressions_update(expressions *self, double dt_s);
/* Behind those of the patch; those that it has no room for are left out. */
void expressions_connect(const expressions *self, patch *p);

/* All of them ease out. */
void expressions_release(expressions *self, double fade_s);
/* To `amount` (0..1) within fade_s. An error names what the face has. */
CHECKED mrt_result expressions_set(expressions *self, const char *name, double amount,
                                   double fade_s, error *err);
uint32_t expressions_count(const expressions *self);
const char *expressions_name(const expressions *self, uint32_t index);

#endif
