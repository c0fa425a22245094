/* constraint_cost.h - what bones and constraints cost a frame: the anchored frame of a face with
 * its rig, and of the same mesh with the same controls without one, timed side by side. [main] */
#ifndef MAROTTE_UI_CONSTRAINT_COST_H
#define MAROTTE_UI_CONSTRAINT_COST_H
#include "stage/perform/performer.h"

typedef struct constraint_cost {
    double constrained_ms, unconstrained_ms; /* median of a frame's steps 6 and 7 without normals */
} constraint_cost;

/* Takes the pull that the performer shows last as the example; zeros when it is not anchored. */
CHECKED mrt_result constraint_cost_measure(constraint_cost *out, const face_file *file,
                                           performer *p, error *err);

#endif
