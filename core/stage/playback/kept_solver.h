/* stage/playback/kept_solver.h - how the surface is solved in a show: what was chosen for it is kept
 * with it, so that it performs tomorrow as it did today, wherever it is performed. Leaves out what
 * a rig says: that holds where a show says nothing. [main], or any one thread that may read the
 * show. */
#ifndef MAROTTE_STAGE_KEPT_SOLVER_H
#define MAROTTE_STAGE_KEPT_SOLVER_H
#include "base/log.h"
#include "csrbf/csrbf.h"
#include "stage/perform/face_file.h"
#include "show/show.h"

typedef struct kept_solver {
    bool is_kept;      /* false: all of it is the rig's */
    csrbf_settings as; /* radius 0: the rig's */
} kept_solver;

/* of: NULL: none is kept. An error, and none, when what the show says is not known here. */
CHECKED mrt_result kept_solver_read(kept_solver *out, show *of, error *err);
CHECKED mrt_result kept_solver_write(show *into, const kept_solver *kept, error *err);

/* For composers of that face: radius > 0, or 0: all of it is the rig's. */
csrbf_settings kept_solver_on(const kept_solver *kept, const face_file *file);
/* The same of a show: what is not known here is logged, and the rig's is taken. */
csrbf_settings kept_solver_for(show *of, const face_file *file, log_queue *log);

#endif
