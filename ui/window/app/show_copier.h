/* window/app/show_copier.h - a whole copy of a show, with the faces that are packed beside it, made
 * on a thread of its own while the show goes on. Leaves out what becomes of it. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_SHOW_COPIER_H
#define MAROTTE_UI_WINDOW_APP_SHOW_COPIER_H
#include "base/error.h"

typedef struct show_copier show_copier;

/* Of what is committed now. The new file must not exist: it is never written over. */
CHECKED mrt_result show_copier_begin(show_copier **out, const char *from, const char *to,
                                     error *err);
/* MRT_END: it goes on; else how it ended: it is to be destroyed then. */
CHECKED mrt_result show_copier_look(show_copier *self, error *err);
const char *show_copier_path(const show_copier *self); /* of the copy */
void show_copier_destroy(show_copier *self);           /* waits for it; NULL is fine */

#endif
