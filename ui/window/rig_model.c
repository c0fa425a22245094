#include "window/rig_model.h"

#include "base/file.h"
#include "face/rig_draft.h"
#include "face/rig_history.h"
#include "mesh/copy.h"
#include "window/rig_keep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct rig_model {
    mesh mesh;
    topology topology;
    char *mesh_path, *path; /* path: where the rig is saved */
    char *beside_path;      /* NULL: none */
    brush *brush;
    rig_history *history;
    rig *changing; /* between begin and commit; NULL: none */
    rig_worker *worker;
    rig_work *work;       /* NULL: none yet */
    face_file *for_stage; /* NULL: nothing new */
    double waits_s;       /* until the worker is asked; < 0: it was, or need not be */
    uint64_t edition;     /* grows with every change, undone ones too */
    uint64_t saved_number;
    bool is_saved_known; /* some state is what the file has */
    bool is_left;        /* what is not saved is not wanted */
    rig_keep keep;
};

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to edit the rig");
}

/* ---- made ---- */

/* "head.glb" gives "head.rig.json", or where there is one already "head.2.rig.json": a draft never
 * takes the place of somebody's rig, which is *out_beside then. */
static char *rig_path_for(const char *mesh_path, char **out_beside)
{
    const char *slash = strrchr(mesh_path, '/'), *dot = strrchr(mesh_path, '.');
    size_t length = dot && (!slash || dot > slash) ? (size_t)(dot - mesh_path) : strlen(mesh_path);
    size_t size = length + sizeof ".4294967295.rig.json";
    char *out = malloc(size);
    if (!out)
        return NULL;
    (void)snprintf(out, size, "%.*s.rig.json", (int)length, mesh_path);
    *out_beside = access(out, F_OK) == 0 ? strdup(out) : NULL;
    for (uint32_t number = 2; access(out, F_OK) == 0; ++number)
        (void)snprintf(out, size, "%.*s.%u.rig.json", (int)length, mesh_path, number);
    return out;
}

static mrt_result copy_face(rig_model *self, const face_file *of, const char *path, error *err)
{
    rig first = {0};
    mrt_result result = mesh_copy(&self->mesh, &of->mesh, err);
    if (result >= 0)
        result = topology_copy(&self->topology, &of->topology, err);
    if (result >= 0 && of->rig)
        result = rig_copy(&first, of->rig, err);
    if (result < 0)
        return result;
    self->mesh_path = strdup(of->rig ? of->rig->mesh_path : path);
    self->path = of->rig ? strdup(path) : rig_path_for(path, &self->beside_path);
    result = rig_history_create(&self->history, &first, err);
    return result >= 0 && (!self->mesh_path || !self->path) ? no_memory(err) : result;
}

mrt_result rig_model_create(rig_model **out, const face_file *of, const char *path,
                            const char *keep_folder, error *err)
{
    rig_model *self = calloc(1, sizeof *self);
    *out = NULL;
    if (!self)
        return no_memory(err);
    mrt_result result = copy_face(self, of, path, err);
    self->is_saved_known = true;
    self->waits_s = of->rig ? 0.0 : -1.0;
    if (result >= 0)
        result = rig_keep_open(&self->keep, keep_folder, self->path, err);
    if (result >= 0)
        result = brush_create(&self->brush, &self->mesh, &self->topology, err);
    if (result >= 0)
        result = rig_worker_create(&self->worker, &self->mesh, &self->topology, err);
    if (result < 0)
        rig_model_destroy(self);
    else
        *out = self;
    return result;
}

static void free_file(face_file *file)
{
    face_file_destroy(file);
    free(file);
}

/* Changes of the last moment, which the worker has not written. */
static void keep_last_changes(rig_model *self)
{
    const char *path = self->history ? rig_keep_begin(&self->keep) : NULL;
    if (path && rig_write(rig_model_rig(self), path, NULL) < 0)
        return; /* what was kept before is still there */
}

void rig_model_destroy(rig_model *self)
{
    if (!self)
        return;
    rig_model_abandon(self);
    rig_worker_destroy(self->worker);
    if (self->history && (rig_model_is_saved(self) || self->is_left))
        rig_keep_end(&self->keep);
    else
        keep_last_changes(self);
    rig_work_destroy(self->work);
    free_file(self->for_stage);
    brush_destroy(self->brush);
    rig_history_destroy(self->history);
    rig_keep_close(&self->keep);
    mesh_destroy(&self->mesh);
    topology_destroy(&self->topology);
    free(self->mesh_path);
    free(self->path);
    free(self->beside_path);
    free(self);
}

/* ---- what there is ---- */

const rig *rig_model_rig(const rig_model *self)
{
    const rig *now = rig_history_now(self->history);
    return now->bone_count > 0 ? now : NULL;
}

const mesh *rig_model_mesh(const rig_model *self)
{
    return &self->mesh;
}

const topology *rig_model_topology(const rig_model *self)
{
    return &self->topology;
}

brush *rig_model_brush(rig_model *self)
{
    return self->brush;
}

const rig_work *rig_model_work(const rig_model *self)
{
    return self->work;
}

uint64_t rig_model_number(const rig_model *self)
{
    return rig_history_number(self->history);
}

const char *rig_model_path(const rig_model *self)
{
    return self->path;
}

const char *rig_model_beside(const rig_model *self)
{
    return self->beside_path;
}

bool rig_model_is_laid(const rig_model *self)
{
    return self->work && self->work->number == self->edition;
}

/* ---- laid on the mesh ---- */

/* The draft was undone: the mesh alone is the face again. */
static void offer_mesh_alone(rig_model *self)
{
    face_file *file = calloc(1, sizeof *file);
    error err;
    if (file && mesh_copy(&file->mesh, &self->mesh, &err) >= 0 &&
        topology_copy(&file->topology, &self->topology, &err) >= 0) {
        self->for_stage = file;
        return;
    }
    free_file(file);
}

static void ask(rig_model *self)
{
    rig copy;
    error err;
    const rig *now = rig_model_rig(self);
    bool keeps = now && !rig_model_is_saved(self);
    self->waits_s = -1.0;
    if (!now) {
        offer_mesh_alone(self);
        return;
    }
    if (rig_copy(&copy, now, &err) < 0)
        return;
    const char *keep_path = keeps ? rig_keep_begin(&self->keep) : NULL;
    if (rig_worker_ask(self->worker, &copy, self->edition, keep_path, &err) < 0)
        self->waits_s = RIG_MODEL_WAIT_S; /* later, with more memory */
}

static bool take_work(rig_model *self)
{
    rig_work *work = rig_worker_take(self->worker);
    if (!work)
        return false;
    rig_work_destroy(self->work);
    self->work = work;
    if (work->file && rig_model_is_laid(self) && self->edition > 0) { /* 0 is there already */
        free_file(self->for_stage);
        self->for_stage = work->file;
        work->file = NULL;
    }
    return true;
}

/* Not while the worker may write it. */
static void end_keeping(rig_model *self)
{
    bool is_wanted = !rig_model_is_saved(self) && !self->is_left;
    if (!is_wanted && self->waits_s < 0.0 && !rig_worker_is_busy(self->worker))
        rig_keep_end(&self->keep);
}

bool rig_model_update(rig_model *self, double dt_s)
{
    if (self->waits_s >= 0.0) {
        self->waits_s -= dt_s;
        if (self->waits_s < 0.0)
            ask(self);
    }
    end_keeping(self);
    return take_work(self);
}

face_file *rig_model_take_face(rig_model *self)
{
    face_file *out = self->for_stage;
    self->for_stage = NULL;
    return out;
}

/* ---- changes ---- */

static void has_changed(rig_model *self)
{
    free_file(self->for_stage);
    self->for_stage = NULL;
    self->edition += 1;
    self->is_left = false;
    self->waits_s = RIG_MODEL_WAIT_S;
}

rig *rig_model_begin(rig_model *self, error *err)
{
    const rig *now = rig_model_rig(self);
    rig_model_abandon(self);
    if (!now) {
        (void)error_set(err, MRT_ERR_ARGUMENT, "this mesh has no rig yet; draft one first");
        return NULL;
    }
    rig *copy = calloc(1, sizeof *copy);
    if (!copy || rig_copy(copy, now, err) < 0) {
        free(copy);
        (void)no_memory(err);
        return NULL;
    }
    self->changing = copy;
    return copy;
}

uint64_t rig_model_commit(rig_model *self)
{
    uint64_t before = rig_model_number(self);
    if (before < self->saved_number) /* the state that is saved can no longer be gone to */
        self->is_saved_known = false;
    rig_history_push(self->history, self->changing);
    free(self->changing);
    self->changing = NULL;
    has_changed(self);
    return rig_model_number(self);
}

void rig_model_abandon(rig_model *self)
{
    rig_destroy(self->changing);
    free(self->changing);
    self->changing = NULL;
}

bool rig_model_go(rig_model *self, uint64_t number)
{
    if (!rig_history_go(self->history, number))
        return false;
    has_changed(self);
    return true;
}

/* Takes the rig over. */
static mrt_result commit_rig(rig_model *self, rig *r, uint64_t *out_number, error *err)
{
    rig_model_abandon(self);
    self->changing = calloc(1, sizeof *self->changing);
    if (!self->changing) {
        rig_destroy(r);
        return no_memory(err);
    }
    *self->changing = *r;
    *out_number = rig_model_commit(self);
    return MRT_OK;
}

mrt_result rig_model_draft(rig_model *self, char **out_confirm, uint64_t *out_number, error *err)
{
    rig drafted;
    mrt_result result = rig_draft_make(&drafted, out_confirm, &self->mesh, self->mesh_path, err);
    return result < 0 ? result : commit_rig(self, &drafted, out_number, err);
}

/* ---- files ---- */

bool rig_model_is_saved(const rig_model *self)
{
    bool is_same = self->is_saved_known && self->saved_number == rig_model_number(self);
    return is_same || !rig_model_rig(self);
}

mrt_result rig_model_save(rig_model *self, error *err)
{
    const rig *now = rig_model_rig(self);
    if (!now)
        return error_set(err, MRT_ERR_ARGUMENT, "this mesh has no rig yet; draft one first");
    mrt_result result = rig_write(now, self->path, err);
    if (result < 0)
        return result;
    self->saved_number = rig_model_number(self);
    self->is_saved_known = true;
    return result;
}

bool rig_model_has_kept(const rig_model *self)
{
    return rig_keep_has_old(&self->keep);
}

mrt_result rig_model_take_kept(rig_model *self, uint64_t *out_number, error *err)
{
    rig kept;
    mrt_result result = rig_keep_read(&self->keep, &kept, &self->mesh, err);
    return result < 0 ? result : commit_rig(self, &kept, out_number, err);
}

void rig_model_drop_kept(rig_model *self)
{
    rig_keep_drop_old(&self->keep);
}

void rig_model_leave(rig_model *self)
{
    self->is_left = true;
}
