/* show/step_rule.h - which measured samples belong to one step: they are performed at once, and
 * recorded with one time. For who performs them (stage/perform/scheduler.h) and for who finds them
 * after a kill (writer_store.c). Leaves out who gives them, and waiting. Pure; any thread. */
#ifndef MAROTTE_TAKE_STEP_RULE_H
#define MAROTTE_TAKE_STEP_RULE_H
#include <stdbool.h>
#include <stdint.h>

typedef struct step_rhythm { /* of one input's samples */
    uint32_t measures;       /* step_measures of its channels; 0: no hand */
    int64_t last_ns;         /* when its newest sample that is in a step was measured */
    int64_t period_ns;       /* between its samples; 0: not known */
    uint64_t last_step;      /* number of the step that had it, from 1; 0: none */
} step_rhythm;

/* Bits: angles and wrist of each hand. */
uint32_t step_measures(uint32_t semantic, uint32_t hand);
/* Different hands, or of one hand what only the other measures. */
bool step_may_pair(const step_rhythm *a, const step_rhythm *b);
int64_t step_shorter_period_ns(const step_rhythm *a, const step_rhythm *b);
/* How far apart two samples of one step may be. */
int64_t step_window_ns(const step_rhythm *a, const step_rhythm *b);
/* A sample of that time is in the step of that number. */
void step_rhythm_take(step_rhythm *self, int64_t time_ns, uint64_t number);

/* The step of an earliest sample: first all that pair with it are asked, then what measures no
 * hand. */
typedef struct step_choice {
    const step_rhythm *first;
    int64_t first_ns, until_ns; /* until: the last one's time, which is the step's */
    uint32_t measures;
} step_choice;
step_choice step_choice_of(const step_rhythm *first, int64_t first_ns);
/* True: the sample goes with the first one, and is in the step from now on. */
bool step_choice_pairs(step_choice *self, const step_rhythm *other, int64_t time_ns);
/* Of no hand: what was measured up to the last of them goes with them. */
bool step_choice_covers(const step_choice *self, const step_rhythm *other, int64_t time_ns);

#endif
