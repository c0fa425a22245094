/* perform_hands.h - whose hands perform: which calibration each gets, what is said of that, and the
 * keys of a live performance. [main] */
#ifndef MAROTTE_UI_PERFORM_HANDS_H
#define MAROTTE_UI_PERFORM_HANDS_H
#include "facts.h"
#include "hand/calibration_file.h"
#include "perform_options.h"
#include "progress.h"
#include "stage/perform/player.h"

typedef struct perform_hands {
    char *path[2]; /* left, right: of the calibration in use; NULL: none */
    double length_mm[2];
    hand_calibration use[2];
} perform_hands;

/* The calibrations asked for, else for every hand that comes in counts the newest of the user's
 * folder. Says on stderr what is used, and what an uncalibrated hand can do. Owned by `out`, which
 * can be finished whatever the result. */
CHECKED mrt_result perform_hands_choose(perform_hands *out, const perform_options *options,
                                        input *const *inputs, uint32_t input_count, error *err);
void perform_hands_finish(perform_hands *self); /* zeroed is fine */

/* NULL: shipped defaults. */
const hand_calibration *perform_hands_calibration(const perform_hands *self, uint32_t side);

/* A calibration's file as text, to be freed. */
CHECKED mrt_result perform_hands_text(char **out, const char *path, error *err);

void perform_hands_report(const perform_hands *self, const performer *p, facts *told);

/* Takes the keys that were pressed: z re-zeroes the hands, q sets *stop. Returns which hands were
 * re-zeroed: bits by side. Says what it did. */
uint32_t perform_hands_keys(performer *p, _Atomic bool *stop, progress *shown);

#endif
