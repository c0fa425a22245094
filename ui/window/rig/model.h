/* window/rig/model.h - a rig that a person edits, without looks: its states and what is undone, the
 * worker that lays each on the mesh, where it is saved, and the file that keeps what is not saved
 * yet. Leaves out strokes (brush.h), single changes (face/rig_edit.h), and the stage. [main]
 */
#ifndef MAROTTE_UI_WINDOW_RIG_MODEL_H
#define MAROTTE_UI_WINDOW_RIG_MODEL_H
#include "window/rig/brush.h"
#include "face/face.h"
#include "face/rig_check.h"
#include "stage/perform/face_file.h"

typedef struct rig_model rig_model;

typedef struct rig_work { /* about one state of the rig */
    uint64_t number;      /* as asked */
    rig rig;
    mrt_result result; /* < 0: it cannot be performed; the findings say why */
    face_file *file;   /* for the stage, a copy of everything; NULL: result < 0, or it was taken */
    face *face;        /* to try it; NULL: result < 0. Of `rig` here and of the model's mesh */
    rig_findings findings;
    uint32_t *region_size; /* rig.region_count: vertices that it selects */
    mrt_result kept;       /* of writing the file */
    error err, keep_err;   /* of laying, of writing */
} rig_work;

#define RIG_MODEL_WAIT_S 0.3 /* after a change, before it is laid */

/* Copies the face. path: the rig's file, or of a mesh alone: then nothing is there to be edited
 * before rig_model_draft. keep_folder: with its final '/'; "": nothing is kept. */
CHECKED mrt_result rig_model_create(rig_model **out, const face_file *of, const char *path,
                                    const char *keep_folder, error *err);
/* What is not saved stays kept. */
void rig_model_destroy(rig_model *self); /* NULL is fine */
/* Somebody looks: the rig as it was opened is laid, too. Without that only changes of it are. */
void rig_model_look(rig_model *self);
/* Each frame: asks the worker a while after the last change. True: rig_model_work is another. */
bool rig_model_update(rig_model *self, double dt_s);
/* A thread is at work for it, or will be soon: update it again in a moment. */
bool rig_model_is_busy(const rig_model *self);

const rig *rig_model_rig(const rig_model *self);   /* NULL: a mesh alone; until the next change */
const mesh *rig_model_mesh(const rig_model *self); /* these three: another where a mouth is cut */
const topology *rig_model_topology(const rig_model *self);
brush *rig_model_brush(rig_model *self);
/* About the newest state that is laid; NULL: none yet. Until the next update. */
const rig_work *rig_model_work(const rig_model *self);
bool rig_model_is_laid(const rig_model *self); /* that is the newest state */
/* A change is still being laid, or its face has not been taken. */
bool rig_model_is_pending(const rig_model *self);
/* The face for the stage, once for each state that can be performed; the caller's. NULL: none. */
face_file *rig_model_take_face(rig_model *self);

/* ---- changes ---- */

/* A copy to be changed; then one of the two below. NULL: no memory, or a mesh alone. */
rig *rig_model_begin(rig_model *self, error *err);
/* The state's number: it is undone by going to the one before. */
uint64_t rig_model_commit(rig_model *self);
void rig_model_abandon(rig_model *self);
uint64_t rig_model_number(const rig_model *self);
bool rig_model_go(rig_model *self, uint64_t number); /* undo, redo; false: too long ago */
/* A first rig for a mesh alone is begun, in a thread of its own: it can take seconds. */
CHECKED mrt_result rig_model_draft(rig_model *self, error *err);
bool rig_model_is_drafting(const rig_model *self);
typedef struct rig_model_drafted {
    mrt_result result; /* < 0: `err` says why there is none */
    error err;
    char *confirm;   /* to be freed; lines to look at */
    uint64_t number; /* of the change that it is */
    bool has_cut;    /* a mouth */
} rig_model_drafted;
/* True once, when it is done. */
bool rig_model_take_draft(rig_model *self, rig_model_drafted *out);
/* The rig is a draft of a head without a slit between its lips, where a mouth can be cut: it is
 * drafted again with one, as it was drafted, or stays clay. */
bool rig_model_asks_mouth(const rig_model *self);
CHECKED mrt_result rig_model_cut_mouth(rig_model *self, error *err);
void rig_model_leave_clay(rig_model *self);

/* ---- files ---- */

const char *rig_model_path(const rig_model *self); /* where it is saved: NAME.rig.json */
/* Of a mesh alone: a rig that lies beside it. NULL: none did. */
const char *rig_model_beside(const rig_model *self);
bool rig_model_is_saved(const rig_model *self);
CHECKED mrt_result rig_model_save(rig_model *self, error *err);
/* Under another name: in the folder of its mesh, or one above it (a rig names nothing that did not
 * come with it). Where it is saved from now on is the caller's to open. */
CHECKED mrt_result rig_model_save_as(rig_model *self, const char *path, error *err);
/* Unsaved work of another time is there. */
bool rig_model_has_kept(const rig_model *self);
/* It becomes the rig: a change. */
CHECKED mrt_result rig_model_take_kept(rig_model *self, uint64_t *out_number, error *err);
void rig_model_drop_kept(rig_model *self); /* that is given up */
void rig_model_leave(rig_model *self);     /* what is not saved is given up */

#endif
