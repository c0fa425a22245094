/* window/panels/simon.h - the lesson "Simon says": the panel shows faces in rounds, and the user
 * answers each with a hand pose. Computes the next face, the spread of the answers to a face, and
 * pairs of faces with similar answers. Rounds after the second ask only for faces with inconsistent
 * answers. Leaves out the learning of the mapping, and drawing. Pure; no allocation. */
#ifndef MAROTTE_UI_WINDOW_PANELS_SIMON_H
#define MAROTTE_UI_WINDOW_PANELS_SIMON_H
#include <marotte/plugin.h>

enum { SIMON_FACES_MAX = 16, SIMON_ROUNDS = 2, SIMON_ROUNDS_MAX = 4, SIMON_PAIRS_MAX = 8 };
#define SIMON_TWINS_DEG  6.0  /* two hand poses that are closer count as the same */
#define SIMON_SPREAD_DEG 12.0 /* a face with a larger spread of answers is asked again */

typedef struct simon {
    uint32_t face_count;
    bool counts[MRT_ANGLES]; /* angles that the card names, without the wrist */
    uint32_t round;          /* from 0 */
    uint32_t place;          /* in the round; face_count: the round is over */
    uint32_t answered[SIMON_FACES_MAX];
    float angle_rad[SIMON_FACES_MAX][SIMON_ROUNDS_MAX][MRT_ANGLES];
} simon;

/* line: of the mapping's card for the device. */
void simon_begin(simon *self, uint32_t face_count, const mrt_card_line *line, uint32_t line_count);
/* Returns the current face, or face_count if the round is over. The order differs in each round. */
uint32_t simon_asked(const simon *self);
void simon_answer(simon *self, const float angle_rad[MRT_ANGLES]);
void simon_skip(simon *self);
/* Removes the answers to one face, or all answers. */
void simon_forget(simon *self, uint32_t face);
void simon_forget_all(simon *self);

/* Returns the number of faces in the next round; 0: the lesson is over. */
uint32_t simon_left(const simon *self);
void simon_next_round(simon *self);

/* Returns the root mean square over the joints between the two most different answers, deg. 0:
 * fewer than two answers. */
double simon_spread_deg(const simon *self, uint32_t face);
typedef struct simon_pair {
    uint32_t a, b; /* faces */
    double deg;    /* between the means of their answers */
} simon_pair;
/* Finds pairs of faces with similar answers, most similar first. Returns the number of pairs in
 * `out`. */
uint32_t simon_twins(const simon *self, simon_pair out[SIMON_PAIRS_MAX]);

#endif
