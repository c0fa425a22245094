/* window/rig/model.h - the rig editor without drawing: undo states, the worker that binds each
 * state to the mesh, the path for saving, and the recovery file for unsaved changes. Leaves out
 * strokes (brush.h), single edits (face/rig_edit.h) and the stage. [main] */
#ifndef MAROTTE_UI_WINDOW_RIG_MODEL_H
#define MAROTTE_UI_WINDOW_RIG_MODEL_H
#include "window/rig/brush.h"
#include "face/face.h"
#include "face/rig_check.h"
#include "stage/perform/face_file.h"

typedef struct rig_model rig_model;

typedef struct rig_work { /* result of the worker for one state of the rig */
    uint64_t number;      /* number of the state */
    rig rig;
    mrt_result result; /* < 0: the rig cannot be performed, see findings */
    face_file *file;   /* complete copy for the stage; NULL: result < 0, or already fetched */
    face *face; /* for trying movements, made from `rig` and the mesh of the model; NULL: result < 0
                 */
    rig_findings findings;
    uint32_t *region_size; /* rig.region_count: number of selected vertices */
    mrt_result kept;       /* result of writing the recovery file */
    error err, keep_err;   /* errors of binding and of writing */
} rig_work;

#define RIG_MODEL_WAIT_S 0.3 /* delay between a change and its binding */

/* Creates a model with a copy of the face. path: a rig file, or a mesh file without a rig, which
 * needs rig_model_draft first. keep_folder: folder of recovery files with its final '/'; "": no
 * recovery file. */
CHECKED mrt_result rig_model_create(rig_model **out, const face_file *of, const char *path,
                                    const char *keep_folder, error *err);
/* Destroys the model. Unsaved changes stay in the recovery file. */
void rig_model_destroy(rig_model *self); /* NULL is fine */
/* Requests the binding of the opened rig, because the panel is visible. Without this call only
 * changes are bound. */
void rig_model_request_binding(rig_model *self);
/* Starts the worker RIG_MODEL_WAIT_S after the last change. Call it in each frame. Returns true if
 * rig_model_work has a new result. */
bool rig_model_update(rig_model *self, double dt_s);
/* Returns whether a thread works for the model or will start soon. The caller should then update it
 * again soon. */
bool rig_model_is_busy(const rig_model *self);

const rig *rig_model_rig(const rig_model *self); /* NULL: no rig yet; valid until the next change */
const mesh *
rig_model_mesh(const rig_model *self); /* a cut mouth changes the result of these three functions */
const topology *rig_model_topology(const rig_model *self);
brush *rig_model_brush(rig_model *self);
/* Returns the result for the newest bound state, or NULL. Valid until the next update. */
const rig_work *rig_model_work(const rig_model *self);
bool rig_model_is_laid(const rig_model *self); /* whether the newest state is bound */
/* Returns whether a change is still being bound, or its face has not been fetched. */
bool rig_model_is_pending(const rig_model *self);
/* Returns the face for the stage, once for each valid state. The caller owns it. NULL: none. */
face_file *rig_model_pop_face(rig_model *self);

/* ---- changes ---- */

/* Returns a copy to edit. Finish with rig_model_commit or rig_model_abandon. NULL: no memory, or no
 * rig yet. */
rig *rig_model_begin(rig_model *self, error *err);
/* Returns the number of the new state. Number minus 1 is the state before. */
uint64_t rig_model_commit(rig_model *self);
void rig_model_abandon(rig_model *self);
uint64_t rig_model_number(const rig_model *self);
bool rig_model_go(rig_model *self,
                  uint64_t number); /* undo, redo; false: no longer in the history */
/* Starts to draft a first rig for a mesh in a separate thread. This can take seconds. */
CHECKED mrt_result rig_model_draft(rig_model *self, error *err);
bool rig_model_is_drafting(const rig_model *self);
typedef struct rig_model_drafted {
    mrt_result result; /* < 0: failed, see `err` */
    error err;
    char *confirm;   /* lines for the user to check; the caller frees it */
    uint64_t number; /* number of the new state */
    bool has_cut;    /* a mouth was cut */
} rig_model_drafted;
/* Returns true once when the draft is done. */
bool rig_model_pop_draft(rig_model *self, rig_model_drafted *out);
/* Returns whether the user must decide about the mouth: the draft has no slit between the lips, but
 * one can be cut. Answer with rig_model_cut_mouth, which drafts again, or rig_model_leave_clay. */
bool rig_model_asks_mouth(const rig_model *self);
CHECKED mrt_result rig_model_cut_mouth(rig_model *self, error *err);
void rig_model_leave_clay(rig_model *self);

/* ---- files ---- */

const char *rig_model_path(const rig_model *self); /* path for saving: NAME.rig.json */
/* For a mesh without a rig: an existing rig file beside it, or NULL. */
const char *rig_model_beside(const rig_model *self);
bool rig_model_is_saved(const rig_model *self);
CHECKED mrt_result rig_model_save(rig_model *self, error *err);
/* Saves the rig under another name in the folder of its mesh or in a folder above it, because a rig
 * may only refer to files below its folder. The caller then opens the new file. */
CHECKED mrt_result rig_model_save_as(rig_model *self, const char *path, error *err);
/* Returns whether unsaved changes of an earlier session exist. */
bool rig_model_has_recovered(const rig_model *self);
/* Restores the unsaved changes as a new state. */
CHECKED mrt_result rig_model_restore_recovered(rig_model *self, uint64_t *out_number, error *err);
void rig_model_discard_recovered(rig_model *self); /* discards these changes */
void rig_model_leave(rig_model *self);             /* discards all unsaved changes */

#endif
