/* check/child/pull.h - what a pull may hold, and whether two are the same. Findings are told. */
#ifndef MAROTTE_CHECK_CHILD_PULL_H
#define MAROTTE_CHECK_CHILD_PULL_H
#include <marotte/plugin.h>

typedef struct pull_limits {
    const mrt_face *face;
    const double *centre; /* mm, three */
    double reach_mm;
} pull_limits;

/* False: it breaks a rule, which was told. `where`: "frame 12 of a random walk". */
bool pull_judge(const mrt_pull *pull, const pull_limits *limits, const char *where);
/* Both anchored: starts stay while anchor stays. */
void pull_judge_anchor(const mrt_pull *before, const mrt_pull *now, const char *where);
/* now: the first pull of a new hold; before: the last of the one before, or NULL. */
void pull_judge_hold(const mrt_pull *before, const mrt_pull *now, double max_jump_mm,
                     const char *where);

uint64_t pull_sum(const mrt_pull *pull);
/* "vector 3 ends at (1, 2, 3) and (1, 2, 4)"; "": they are the same, bit for bit. */
void pull_difference(const mrt_pull *a, const mrt_pull *b, char *out, size_t capacity);

#endif
