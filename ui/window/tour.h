/* window/tour.h - the tour: six steps from a pull of the face to an export, which the person
 * performs. A small card beside the face has one sentence for each step. Leaves out what a step
 * does: the tour only watches. It begins by itself once (tour_is_new), and by ACTION_TOUR. [main]
 */
#ifndef MAROTTE_UI_WINDOW_TOUR_H
#define MAROTTE_UI_WINDOW_TOUR_H
#include "window/app/app.h"
#include "window/gui/ui.h"
#include "window/offers.h"

typedef enum tour_step {
    TOUR_OFF = 0,
    TOUR_PULL,
    TOUR_DEMO,
    TOUR_OWN_HAND,
    TOUR_RECORD,
    TOUR_TRIM,
    TOUR_EXPORT,
    TOUR_DONE, /* the last card: how to start it again */
    TOUR_STEPS = TOUR_DONE - 1
} tour_step;

typedef struct tour { /* zeroed: off */
    tour_step step;
    double done_s;       /* since the step was done; 0: it is not done */
    uint32_t pull_count; /* app_pull_count as the tour began */
    bool has_recorded;   /* a recording was seen in this step */
    int64_t take;        /* whose clips were measured; 0: none */
    uint32_t clip_count;
    int64_t clips_ns; /* sum of the lengths of its clips */
} tour;

bool tour_is_new(app *of);            /* it never began on this computer */
void tour_begin(tour *self, app *of); /* from the first step; the settings note it */
void tour_end(tour *self);
/* When the ways to perform are offered that an empty stage has. */
offers_when tour_offers(const tour *self);
/* Goes on when the step is done. Call it in each frame, after what a step may do. */
void tour_update(tour *self, app *of, double dt_s);
typedef struct tour_room {
    ui_rectangle face;   /* the picture of it */
    float offers_height; /* that the offers take in a lower corner */
    bool has_camera;     /* the camera's card is in its upper left corner */
} tour_room;
/* Draws the card beside the face, near what the step is about. */
void tour_draw(tour *self, app *of, ui *on, const tour_room *room);

#endif
