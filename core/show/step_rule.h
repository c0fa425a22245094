/* show/step_rule.h - which samples belong to one step: they are performed together, and recorded
 * with one time. Used by the scheduler (stage/perform/scheduler.h), and by writer_store.c for
 * samples that are found after a kill. Leaves out the inputs, and waiting for samples. Pure; any
 * thread. */
#ifndef MAROTTE_TAKE_STEP_RULE_H
#define MAROTTE_TAKE_STEP_RULE_H
#include <stdbool.h>
#include <stdint.h>

typedef struct step_rhythm { /* timing of one input's samples */
    uint32_t measures;       /* step_measures of its channels; 0: no hand */
    int64_t last_ns;         /* time of its newest sample that is in a step */
    int64_t period_ns;       /* interval between its samples; 0: unknown */
    uint64_t last_step;      /* number of that step, from 1; 0: none */
} step_rhythm;

/* Returns a bit set of what the channels measure: angles and wrist of each hand. */
uint32_t step_measures(uint32_t semantic, uint32_t hand);
/* Returns true if the two inputs measure different hands, or different parts of one hand. */
bool step_may_pair(const step_rhythm *a, const step_rhythm *b);
int64_t step_shorter_period_ns(const step_rhythm *a, const step_rhythm *b);
/* Returns the maximum time between two samples of one step. */
int64_t step_window_ns(const step_rhythm *a, const step_rhythm *b);
/* Records that the sample at time_ns is in step `number`. */
void step_rhythm_record(step_rhythm *self, int64_t time_ns, uint64_t number);

/* Builds the step of the earliest sample. First test all inputs that may pair with it, then the
 * inputs without a hand. */
typedef struct step_choice {
    const step_rhythm *first;
    int64_t first_ns,
        until_ns; /* until_ns: time of the last sample, which is the time of the step */
    uint32_t measures;
} step_choice;
step_choice step_choice_of(const step_rhythm *first, int64_t first_ns);
/* Returns true if the sample belongs to the step, and adds it. */
bool step_choice_pairs(step_choice *self, const step_rhythm *other, int64_t time_ns);
/* For inputs without a hand: returns true if the sample was measured no later than the last sample
 * of the step. */
bool step_choice_covers(const step_choice *self, const step_rhythm *other, int64_t time_ns);

#endif
