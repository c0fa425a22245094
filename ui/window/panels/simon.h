/* window/panels/simon.h - the lesson "Simon says": faces are shown in rounds, and each is answered
 * with a hand. Which face is asked, how far the answers to one face lie apart, and which two faces
 * were answered with nearly the same hand. Leaves out what the mapping learns from it, and drawing.
 * A round after the second asks only for faces whose answers lie apart. Pure; no allocation. */
#ifndef MAROTTE_UI_WINDOW_PANELS_SIMON_H
#define MAROTTE_UI_WINDOW_PANELS_SIMON_H
#include <marotte/plugin.h>

enum { SIMON_FACES_MAX = 16, SIMON_ROUNDS = 2, SIMON_ROUNDS_MAX = 4, SIMON_PAIRS_MAX = 8 };
#define SIMON_TWINS_DEG  6.0  /* two hands that are nearer are one */
#define SIMON_SPREAD_DEG 12.0 /* answers to one face that are further apart are asked again */

typedef struct simon {
    uint32_t face_count;
    bool counts[MRT_ANGLES]; /* angles that the card names, but not the wrist's */
    uint32_t round;          /* from 0 */
    uint32_t place;          /* in the round; face_count: the round is over */
    uint32_t answered[SIMON_FACES_MAX];
    float angle_rad[SIMON_FACES_MAX][SIMON_ROUNDS_MAX][MRT_ANGLES];
} simon;

/* line: of the mapping's card for the device. */
void simon_begin(simon *self, uint32_t face_count, const mrt_card_line *line, uint32_t line_count);
/* The face that is asked now; face_count: the round is over. Each round has another order. */
uint32_t simon_asked(const simon *self);
void simon_answer(simon *self, const float angle_rad[MRT_ANGLES]);
void simon_skip(simon *self);
/* Answers to one face are dropped, or all of them. */
void simon_forget(simon *self, uint32_t face);
void simon_forget_all(simon *self);

/* How many faces the next round would ask for; 0: the lesson is over. */
uint32_t simon_left(const simon *self);
void simon_next_round(simon *self);

/* Root mean square over the joints between the two answers that are furthest apart, deg; 0: fewer
 * than two. */
double simon_spread_deg(const simon *self, uint32_t face);
typedef struct simon_pair {
    uint32_t a, b; /* faces */
    double deg;    /* between the means of their answers */
} simon_pair;
/* Nearest first; returns how many are in `out`. */
uint32_t simon_twins(const simon *self, simon_pair out[SIMON_PAIRS_MAX]);

#endif
