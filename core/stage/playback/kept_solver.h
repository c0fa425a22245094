/* stage/playback/kept_solver.h - the surface solver that was chosen for a show. It is stored in the
 * show, so that the show performs the same later and on other computers. Without it the rig's
 * solver is used, which this file leaves out. [main], or any one thread that may read the show. */
#ifndef MAROTTE_STAGE_KEPT_SOLVER_H
#define MAROTTE_STAGE_KEPT_SOLVER_H
#include "base/log.h"
#include "csrbf/csrbf.h"
#include "stage/perform/face_file.h"
#include "show/show.h"

typedef struct kept_solver {
    bool is_kept;      /* false: the rig's solver */
    csrbf_settings as; /* radius 0: the rig's */
} kept_solver;

/* Reads the solver of a show. of NULL: none. Returns an error and no solver if the stored text is
 * unknown. */
CHECKED mrt_result kept_solver_read(kept_solver *out, show *of, error *err);
CHECKED mrt_result kept_solver_write(show *into, const kept_solver *kept, error *err);

/* Returns the solver for composers of this face. radius 0: the rig's solver. */
csrbf_settings kept_solver_on(const kept_solver *kept, const face_file *file);
/* Same for a show. An unknown solver is logged, and the rig's solver is used. */
csrbf_settings kept_solver_for(show *of, const face_file *file, log_queue *log);

#endif
