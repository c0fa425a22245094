/* window/rig_worker.h - lays a rig that is being edited on its mesh and checks it, beside the
 * window, and keeps it in a file that outlives the program. Only the newest that was asked for is
 * worked on. [main] all of it; it has one thread of its own. */
#ifndef MAROTTE_UI_WINDOW_RIG_WORKER_H
#define MAROTTE_UI_WINDOW_RIG_WORKER_H
#include "face/face.h"
#include "face/rig_check.h"
#include "stage/face_file.h"

typedef struct rig_work { /* about one state of the rig */
    uint64_t number;      /* as asked */
    rig rig;
    mrt_result result; /* < 0: it cannot be performed; the findings say why */
    face_file *file;   /* for the stage, a copy of everything; NULL: result < 0, or it was taken */
    face *face;        /* to try it; NULL: result < 0. Of `rig` here and of the worker's mesh */
    rig_findings findings;
    uint32_t *region_size; /* rig.region_count: vertices that it selects */
    mrt_result kept;       /* of writing the file */
    error err, keep_err;   /* of laying, of writing */
} rig_work;
void rig_work_destroy(rig_work *work); /* NULL is fine */

typedef struct rig_worker rig_worker;
/* The mesh must outlive it. */
CHECKED mrt_result rig_worker_create(rig_worker **out, const mesh *m, const topology *t,
                                     error *err);
void rig_worker_destroy(rig_worker *self); /* waits for what is being worked on; NULL is fine */

/* Takes the rig over, also on error. keep_path NULL: no file is written. */
CHECKED mrt_result rig_worker_ask(rig_worker *self, rig *r, uint64_t number, const char *keep_path,
                                  error *err);
/* The newest that is done, once; it is the caller's. NULL: nothing new. */
rig_work *rig_worker_take(rig_worker *self);
bool rig_worker_is_busy(rig_worker *self); /* something is asked and not done */

#endif
