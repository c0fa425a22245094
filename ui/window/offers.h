/* window/offers.h - what an empty stage offers to perform with, one click each: the camera, the
 * keyboard, a recorded hand to try, the mouse, gone as soon as anything performs; and a first rig
 * for a mesh that has none, where the mapping needs one. [main] */
#ifndef MAROTTE_UI_WINDOW_OFFERS_H
#define MAROTTE_UI_WINDOW_OFFERS_H
#include "window/app/app.h"
#include "window/gui/ui.h"

typedef enum offers_when {
    OFFERS_WHEN_EMPTY = 0, /* ways to perform are offered while nothing performs */
    OFFERS_DEMO,           /* the demo hand, even then */
    OFFERS_OWN_HAND,       /* camera and keyboard, even then */
    OFFERS_NEVER
} offers_when;
typedef struct offers { /* zeroed at first */
    offers_when when;   /* set by the caller */
    bool has_camera;    /* set by the caller: the camera's card is at the left of the face */
    bool is_gone;       /* they were answered in this run */
} offers;
/* Draws them at the lower edge of the face. Ways to perform are in its left corner, or in the right
 * one beside the camera. Returns the height that they take in that corner; 0: none. */
float offers_draw(offers *self, app *of, ui *on, ui_rectangle over);

#endif
