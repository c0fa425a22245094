/* window/camera_card.h - the camera in a corner of the stage: downloads the hand tracker, opens the
 * camera and its page, shows the hand as the page sees it, and calibrates it. [main] */
#ifndef MAROTTE_UI_WINDOW_CAMERA_CARD_H
#define MAROTTE_UI_WINDOW_CAMERA_CARD_H
#include "window/app/app.h"
#include "window/gui/ui.h"

typedef struct camera_card camera_card;
camera_card *camera_card_create(app *of);    /* NULL: no memory */
void camera_card_destroy(camera_card *self); /* NULL is fine */

/* Takes APP_CALL_CAMERA, and follows the camera. Call it in each frame. */
void camera_card_update(camera_card *self, double dt_s);
/* Of the column that the card takes at the left of a small stage; 0: there is no card, or it lies
 * over a corner of a large one. */
float camera_card_width(const camera_card *self, ui_rectangle stage);
/* Draws the card, if there is anything to say or to see, at the upper left of the stage. Returns
 * whether it lies over the face. */
bool camera_card_draw(camera_card *self, ui *on, ui_rectangle stage);

#endif
