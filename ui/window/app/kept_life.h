/* window/app/kept_life.h - the life of the face as the open show keeps it: four switches, their
 * strengths and the seed. Each change is saved in the show, as one undo step. Leaves out the panel
 * (panels/poses.c) and what life does (stage/perform/life.h). [main] */
#ifndef MAROTTE_UI_WINDOW_APP_KEPT_LIFE_H
#define MAROTTE_UI_WINDOW_APP_KEPT_LIFE_H
#include "window/app/app.h"

typedef struct kept_life kept_life;
/* lives: the face lives in a new show. NULL: no memory */
kept_life *kept_life_create(app *of, bool lives);
void kept_life_destroy(kept_life *self); /* NULL is fine */

/* Another show is open: its life, and no steps of undo. */
void kept_life_read(kept_life *self);
const life_settings *kept_life_now(const kept_life *self);
/* words: describe the change, "blinks on". */
void kept_life_change(kept_life *self, const life_settings *to, const char *words);
/* Switches all four off if one is on, otherwise on. */
void kept_life_toggle(kept_life *self);

#endif
