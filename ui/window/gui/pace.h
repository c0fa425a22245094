/* window/gui/pace.h - decides when the next frame of the stage is due, and why. No other file
 * decides it. While nothing moves, the window sleeps and wakes twice a second. Which parts of a
 * frame are drawn: ui_damage.hpp. [main], except for the signal. */
#ifndef MAROTTE_UI_WINDOW_GUI_PACE_H
#define MAROTTE_UI_WINDOW_GUI_PACE_H
#include "stage/input/wake.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum pace_reason { /* the first that applies */
                           PACE_NOT_DUE = 0,
                           PACE_EVENT,    /* a key, the pointer, the window itself */
                           PACE_SIGNAL,   /* another thread has a new face, or other news */
                           PACE_SETTLING, /* the previous frame changed something: show the results
                                           */
                           PACE_ASKED,    /* an animation, a countdown, work that is watched */
                           PACE_LOOK,     /* twice a second, for changes that no thread reports */
                           PACE_REASONS
} pace_reason;
/* "event": one word each. */
extern const char *const pace_reason_names[PACE_REASONS];

typedef struct pace {
    wake signal;
    uint32_t seen;    /* count of the signal when the last frame began */
    int64_t began_ns; /* start of the last frame; 0: no frame yet */
    int64_t asked_ns; /* the earliest requested time; INT64_MAX: none */
    pace_reason why;  /* of this frame */
    uint32_t settles; /* frames that still follow without a pause */
    bool has_rested;  /* the window slept before this frame */
    uint64_t count[PACE_REASONS];
} pace;

void pace_init(pace *self);
/* Requests a frame at that time or earlier; a time in the past: the next frame. */
void pace_ask(pace *self, int64_t at_ns);
/* The picture of this frame differs from the previous one. */
void pace_note_change(pace *self);
/* Whether a frame is due now. */
pace_reason pace_due(const pace *self, int64_t now_ns, bool has_event);
/* Time until which the window may sleep without an event or a signal. */
int64_t pace_until_ns(const pace *self);
/* A frame begins, and earlier requests end. Returns true if an event ended a rest: this frame then
 * only advances the clock by the rest, and the next frame, which follows immediately, handles the
 * event. Otherwise an animation that the event starts would be ahead by the length of the rest. */
bool pace_begin(pace *self, pace_reason why, bool has_rested, int64_t now_ns);

#endif
