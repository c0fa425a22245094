/* window/gui/pace.h - decides when the next frame of the stage is due, and why: the only place that
 * does. While nothing moves the window sleeps between its looks, twice a second. Leaves out what of
 * a frame is drawn (ui_damage.hpp). [main], but for the signal. */
#ifndef MAROTTE_UI_WINDOW_GUI_PACE_H
#define MAROTTE_UI_WINDOW_GUI_PACE_H
#include "stage/input/wake.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum pace_reason { /* the first that applies */
                           PACE_NOT_DUE = 0,
                           PACE_EVENT,    /* a key, the pointer, the window itself */
                           PACE_SIGNAL,   /* another thread has something new: a face */
                           PACE_SETTLING, /* a frame before was new: what follows from it */
                           PACE_ASKED,    /* an animation, a countdown, work that is watched */
                           PACE_LOOK,     /* for what nobody reports */
                           PACE_REASONS
} pace_reason;
/* "event": one word each. */
extern const char *const pace_reason_names[PACE_REASONS];

typedef struct pace {
    wake signal;
    uint32_t seen;    /* of the signal, as the last frame began */
    int64_t began_ns; /* the last frame; 0: there was none */
    int64_t asked_ns; /* the earliest time that was asked for; INT64_MAX: none */
    pace_reason why;  /* of this frame */
    uint32_t settles; /* frames that follow one another in any case */
    bool has_rested;  /* nothing was due before this frame, and the window slept */
    uint64_t count[PACE_REASONS];
} pace;

void pace_init(pace *self);
/* A frame at that time at the latest; a time that has passed: the next one. */
void pace_ask(pace *self, int64_t at_ns);
/* What was drawn in this frame differs from what was drawn before. */
void pace_note_change(pace *self);
/* Whether a frame is due now. */
pace_reason pace_due(const pace *self, int64_t now_ns, bool has_event);
/* Until when the window may sleep, unless an event or a signal comes. */
int64_t pace_until_ns(const pace *self);
/* A frame begins: what was asked for is forgotten. True: it is late for an event that ended a rest.
 * The time before the event passes in this frame, and the event is for the next one, which is due
 * at once: what the event sets going is not ahead by the rest. */
bool pace_begin(pace *self, pace_reason why, bool has_rested, int64_t now_ns);

#endif
