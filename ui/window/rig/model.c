#include "window/rig/model.h"

#include "base/file.h"
#include "face/rig.h"
#include "face/rig/rig_poses.h"
#include "face/rig_draft.h"
#include "face/rig_edit.h"
#include "mesh/mesh.h"
#include "stage/perform/face_file.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct rig_keep {
    char *path;       /* current recovery file; NULL: none */
    char *old_path;   /* recovery file of an earlier session; NULL: none */
    char *taken_path; /* restored earlier file, not saved since; NULL: none */
    bool is_begun;
} rig_keep;

/* ---- recovery file ---- */

/* Returns the FNV-1a hash of the rig's folder, so that rigs with the same name in different folders
 * have separate files. */
static uint32_t hash_of(const char *text, size_t length)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < length; ++i)
        hash = (hash ^ (unsigned char)text[i]) * 16777619u;
    return hash;
}

static char *join(const char *folder, const char *rig_path)
{
    char *real = realpath(rig_path, NULL);
    const char *whole = real ? real : rig_path;
    const char *slash = strrchr(whole, '/'), *name = slash ? slash + 1 : whole;
    size_t size = strlen(folder) + strlen(name) + 32;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%s%s.%08x.unsaved", folder, name,
                       hash_of(whole, (size_t)(name - whole)));
    free(real);
    return out;
}

static char *with_ending(const char *path, const char *ending)
{
    size_t size = strlen(path) + strlen(ending) + 1;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%s%s", path, ending);
    return out;
}

static bool is_there(const char *path)
{
    return path && access(path, F_OK) == 0;
}

/* Frees the paths and leaves the files. */
static void rig_keep_close(rig_keep *self)
{
    free(self->path);
    free(self->old_path);
    free(self->taken_path);
    *self = (rig_keep){0};
}

/* Searches for a recovery file of the rig at rig_path. folder "": recovery is off. */
static mrt_result rig_keep_open(rig_keep *out, const char *folder, const char *rig_path, error *err)
{
    *out = (rig_keep){0};
    if (!folder[0])
        return MRT_OK;
    out->path = join(folder, rig_path);
    char *moved = out->path ? with_ending(out->path, ".before") : NULL;
    if (!moved) {
        rig_keep_close(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory to keep the rig");
    }
    if (is_there(out->path)) {
        out->old_path = strdup(out->path);
    } else if (is_there(moved)) {
        out->old_path = moved;
        moved = NULL;
    }
    free(moved);
    return MRT_OK;
}

/* Renames the old file if it has the name of the new one. */
static void make_way(rig_keep *self)
{
    if (!self->old_path || strcmp(self->old_path, self->path) != 0)
        return;
    char *moved = with_ending(self->path, ".before");
    if (!moved || rename(self->path, moved) != 0) {
        free(moved);
        return;
    }
    free(self->old_path);
    self->old_path = moved;
}

/* Returns the path for the recovery file, or NULL. Moves an earlier file out of the way. Valid
 * until rig_keep_close. */
static const char *rig_keep_begin(rig_keep *self)
{
    if (!self->path)
        return NULL;
    make_way(self);
    self->is_begun = true;
    return self->path;
}

/* Deletes the recovery file after a save or discard. The worker must not be writing it. */
static void rig_keep_end(rig_keep *self)
{
    if (self->is_begun)
        (void)unlink(self->path);
    if (self->taken_path)
        (void)unlink(self->taken_path);
    free(self->taken_path);
    self->taken_path = NULL;
    self->is_begun = false;
}

/* Refuses a rig for another mesh. */
static mrt_result rig_keep_take(rig_keep *self, const rig *r, const mesh *m, error *err)
{
    if (r->mesh_vertex_count != 0 && r->mesh_vertex_count != m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: made for a mesh of %u vertices, but this mesh has %u", self->old_path,
                         r->mesh_vertex_count, m->vertex_count);
    free(self->taken_path);
    self->taken_path = self->old_path;
    self->old_path = NULL;
    return MRT_OK;
}

/* ---- the worker: binds a state to the mesh and checks it ---- */

typedef struct order { /* work order for the worker */
    rig rig;
    const mesh *m; /* outlives the worker */
    const topology *t;
    uint64_t number;
    char *keep_path; /* NULL: no file is written */
} order;

typedef struct rig_worker {
    pthread_t thread;
    pthread_mutex_t lock; /* guards all fields below */
    pthread_cond_t news;
    order *waiting;
    rig_work *done;
    bool is_working, is_ending;
} rig_worker;

static void destroy_order(order *o)
{
    if (!o)
        return;
    rig_destroy(&o->rig);
    free(o->keep_path);
    free(o);
}

static void free_file(face_file *file)
{
    face_file_destroy(file);
    free(file);
}

/* NULL is fine */
static void rig_work_destroy(rig_work *work)
{
    if (!work)
        return;
    face_destroy(work->face);
    free_file(work->file);
    rig_findings_finish(&work->findings);
    rig_destroy(&work->rig);
    free(work->region_size);
    free(work);
}

/* ---- the work [worker] ---- */

/* Copies the binding, so that the stage does not compute it again. */
static mrt_result copy_binding(face_file *file, const binding *b, error *err)
{
    file->bound = calloc(1, sizeof *file->bound);
    return file->bound ? binding_copy(file->bound, b, file->rig->contact_count, err)
                       : error_set(err, MRT_ERR_MEMORY, "no memory for the face");
}

static mrt_result copy_for_stage(rig_work *work, const order *o, error *err)
{
    face_file *file = calloc(1, sizeof *file);
    work->file = file;
    rig *copy = file ? calloc(1, sizeof *copy) : NULL;
    if (!copy)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the face");
    file->rig = copy;
    mrt_result result = rig_copy(copy, &work->rig, err);
    if (result >= 0)
        result = mesh_copy(&file->mesh, o->m, err);
    if (result >= 0)
        bind_focus(&file->mesh, copy, o->t);
    if (result >= 0)
        result = topology_copy(&file->topology, o->t, err);
    return result < 0 ? result : copy_binding(file, face_binding(work->face), err);
}

/* Takes ownership of the binding. */
static mrt_result make_face(rig_work *work, const order *o, binding *b, error *err)
{
    const csrbf_settings solver = rig_poses_solver(&work->rig, o->m);
    mrt_result result = face_create_bound(&work->face, &work->rig, o->m, b, MRT_MAX_VECTORS, err);
    if (result >= 0)
        result = rig_poses_complete(&work->rig, 0, work->face, &solver, err);
    return result < 0 ? result : copy_for_stage(work, o, err);
}

static mrt_result lay(rig_work *work, const order *o, error *err)
{
    binding b = {0};
    error check_err = {""};
    const rig *r = &work->rig;
    mrt_result result = rig_validate(r, o->m, o->t, err);
    if (result >= 0)
        result = binding_create(&b, r, o->m, o->t, err);
    mrt_result checked =
        rig_check(&work->findings, r, o->m, o->t, result >= 0 ? &b : NULL, &check_err);
    if (result >= 0)
        result = make_face(work, o, &b, err);
    if (result >= 0 && checked < 0) {
        *err = check_err;
        result = checked;
    }
    binding_destroy(&b);
    return result;
}

static void count_regions(rig_work *work, const order *o)
{
    uint32_t vertex_count = o->m->vertex_count;
    float *share = calloc((size_t)vertex_count + 1, sizeof *share);
    work->region_size = calloc(work->rig.region_count + 1u, sizeof *work->region_size);
    for (uint32_t i = 0; share && work->region_size && i < work->rig.region_count; ++i) {
        if (bind_select(share, &work->rig.region[i].select, o->m, o->t, NULL) < 0)
            continue;
        for (uint32_t v = 0; v < vertex_count; ++v)
            work->region_size[i] += share[v] > 0.0f;
    }
    free(share);
}

static void drop_what_failed(rig_work *work)
{
    face_destroy(work->face);
    free_file(work->file);
    work->face = NULL;
    work->file = NULL;
}

static rig_work *work_on(order *o)
{
    rig_work *work = calloc(1, sizeof *work);
    if (!work)
        return NULL;
    work->number = o->number;
    work->rig = o->rig;
    o->rig = (rig){0};
    if (o->keep_path)
        work->kept = rig_write(&work->rig, o->keep_path, &work->keep_err);
    work->result = lay(work, o, &work->err);
    if (work->result < 0)
        drop_what_failed(work);
    count_regions(work, o);
    return work;
}

static void *run(void *given)
{
    rig_worker *self = given;
    (void)pthread_mutex_lock(&self->lock);
    while (!self->is_ending) {
        order *o = self->waiting;
        if (!o) {
            (void)pthread_cond_wait(&self->news, &self->lock);
            continue;
        }
        self->waiting = NULL;
        self->is_working = true;
        (void)pthread_mutex_unlock(&self->lock);
        rig_work *work = work_on(o);
        destroy_order(o);
        (void)pthread_mutex_lock(&self->lock);
        rig_work *before = self->done;
        self->done = work ? work : before;
        self->is_working = false;
        if (work)
            rig_work_destroy(before);
    }
    (void)pthread_mutex_unlock(&self->lock);
    return NULL;
}

/* ---- [main] ---- */

static mrt_result rig_worker_create(rig_worker **out, error *err)
{
    rig_worker *self = calloc(1, sizeof *self);
    *out = NULL;
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to check the rig");
    (void)pthread_mutex_init(&self->lock, NULL);
    (void)pthread_cond_init(&self->news, NULL);
    if (pthread_create(&self->thread, NULL, run, self) == 0) {
        *out = self;
        return MRT_OK;
    }
    (void)pthread_cond_destroy(&self->news);
    (void)pthread_mutex_destroy(&self->lock);
    free(self);
    return error_set(err, MRT_ERR_MEMORY, "no thread to check the rig");
}

/* Waits for the current order. Accepts NULL. */
static void rig_worker_destroy(rig_worker *self)
{
    if (!self)
        return;
    (void)pthread_mutex_lock(&self->lock);
    self->is_ending = true;
    (void)pthread_cond_signal(&self->news);
    (void)pthread_mutex_unlock(&self->lock);
    (void)pthread_join(self->thread, NULL);
    destroy_order(self->waiting);
    rig_work_destroy(self->done);
    (void)pthread_cond_destroy(&self->news);
    (void)pthread_mutex_destroy(&self->lock);
    free(self);
}

/* Takes ownership of the order, also on error. */
static mrt_result rig_worker_ask(rig_worker *self, order *all, error *err)
{
    order *o = malloc(sizeof *o);
    if (!o) {
        rig_destroy(&all->rig);
        free(all->keep_path);
        return error_set(err, MRT_ERR_MEMORY, "no memory to check the rig");
    }
    *o = *all;
    (void)pthread_mutex_lock(&self->lock);
    order *before = self->waiting;
    self->waiting = o;
    (void)pthread_cond_signal(&self->news);
    (void)pthread_mutex_unlock(&self->lock);
    destroy_order(before);
    return MRT_OK;
}

/* Returns the newest result once, or NULL. The caller owns it. */
static rig_work *rig_worker_take(rig_worker *self)
{
    (void)pthread_mutex_lock(&self->lock);
    rig_work *out = self->done;
    self->done = NULL;
    (void)pthread_mutex_unlock(&self->lock);
    return out;
}

/* Returns whether an order is not finished. */
static bool rig_worker_is_busy(rig_worker *self)
{
    (void)pthread_mutex_lock(&self->lock);
    bool is_busy = self->waiting || self->is_working;
    (void)pthread_mutex_unlock(&self->lock);
    return is_busy;
}

/* ---- the model ---- */

typedef enum draft_state {
    DRAFT_GOES = 0,
    DRAFT_DONE,
    DRAFT_LEFT /* abandoned by the model */
} draft_state;

/* A draft takes seconds, and closing a face does not wait for it. Therefore the thread owns copies
 * of its input. Whichever of model and thread finishes last frees the struct. */
typedef struct drafting {
    face_file file;  /* mesh without a rig */
    uint32_t *chain; /* NULL: none. Before the draft: the chain along which a mouth is cut first. */
    uint32_t chain_count; /* After the draft of a head without a mouth: the chain along which one
                             can be cut. */
    bool cuts;
    char *mesh_path;
    _Atomic draft_state state; /* once done, [main] owns the following fields */
    rig rig;
    rig_model_drafted made;
} drafting;

typedef struct surface {
    mesh mesh;
    topology topology;
    brush *brush;
} surface;

struct rig_model {
    surface whole;          /* face as opened */
    surface cut;            /* face with a cut mouth; brush NULL: no rig cuts a mouth */
    uint32_t *chain;        /* chain of the mouth that the user is asked to cut; NULL: none */
    uint32_t chain_count;   /* length of chain */
    uint64_t asked_number;  /* number of the state that asks */
    char *mesh_path, *path; /* path: path for saving the rig */
    char *beside_path;      /* NULL: none */
    rig_history *history;
    rig *changing; /* copy between begin and commit, or NULL */
    rig_worker *worker;
    drafting *draft;      /* NULL: no draft in progress */
    rig_work *work;       /* NULL: none yet */
    face_file *for_stage; /* NULL: nothing new */
    double waits_s;       /* time until the worker starts; < 0: started or not needed */
    uint64_t edition;     /* increases with each change, also with undo */
    uint64_t saved_number;
    bool is_saved_known; /* saved_number is valid */
    bool is_left;        /* the user discarded unsaved changes */
    bool is_looked_at;
    rig_keep keep;
    char *keep_folder;
    bool is_moved; /* saved under another path, so the recovery file must belong to that path */
};

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to edit the rig");
}

/* ---- create and destroy ---- */

/* Returns "head.rig.json" for "head.glb". If that file exists, returns "head.2.rig.json" and sets
 * *out_beside to the existing file, so that a draft never overwrites a rig. */
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
    mrt_result result = mesh_copy(&self->whole.mesh, &of->mesh, err);
    if (result >= 0)
        result = topology_copy(&self->whole.topology, &of->topology, err);
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
    self->waits_s = -1.0;
    if (result >= 0)
        result = rig_keep_open(&self->keep, keep_folder, self->path, err);
    if (result >= 0 && !(self->keep_folder = strdup(keep_folder)))
        result = no_memory(err);
    if (result >= 0)
        result = brush_create(&self->whole.brush, &self->whole.mesh, &self->whole.topology, err);
    if (result >= 0)
        result = rig_worker_create(&self->worker, err);
    if (result < 0)
        rig_model_destroy(self);
    else
        *out = self;
    return result;
}

/* Writes the last changes that the worker has not written yet. */
static void keep_last_changes(rig_model *self)
{
    const char *path = self->history ? rig_keep_begin(&self->keep) : NULL;
    if (path && rig_write(rig_model_rig(self), path, NULL) < 0)
        return; /* the earlier recovery file still exists */
}

static void surface_finish(surface *self)
{
    brush_destroy(self->brush);
    mesh_destroy(&self->mesh);
    topology_destroy(&self->topology);
    *self = (surface){.brush = NULL};
}

static void free_draft(drafting *self)
{
    face_file_destroy(&self->file);
    free(self->chain);
    free(self->mesh_path);
    rig_destroy(&self->rig);
    free(self->made.confirm);
    free(self);
}

static void leave_draft(rig_model *self)
{
    if (self->draft && atomic_exchange(&self->draft->state, DRAFT_LEFT) == DRAFT_DONE)
        free_draft(self->draft);
    self->draft = NULL;
}

void rig_model_destroy(rig_model *self)
{
    if (!self)
        return;
    rig_model_abandon(self);
    leave_draft(self);
    rig_worker_destroy(self->worker);
    if (self->history && (rig_model_is_saved(self) || self->is_left))
        rig_keep_end(&self->keep);
    else
        keep_last_changes(self);
    rig_work_destroy(self->work);
    free_file(self->for_stage);
    surface_finish(&self->whole);
    surface_finish(&self->cut);
    free(self->chain);
    rig_history_destroy(self->history);
    rig_keep_close(&self->keep);
    free(self->mesh_path);
    free(self->keep_folder);
    free(self->path);
    free(self->beside_path);
    free(self);
}

/* ---- current state ---- */

const rig *rig_model_rig(const rig_model *self)
{
    const rig *now = rig_history_current(self->history);
    return now->bone_count > 0 ? now : NULL;
}

/* Returns the surface to which this rig is bound. rig NULL: mesh without a rig. */
static const surface *surface_of(const rig_model *self, const rig *r)
{
    return r && r->cut_mouth && self->cut.brush ? &self->cut : &self->whole;
}

static const surface *surface_now(const rig_model *self)
{
    return surface_of(self, rig_model_rig(self));
}

const mesh *rig_model_mesh(const rig_model *self)
{
    return &surface_now(self)->mesh;
}

const topology *rig_model_topology(const rig_model *self)
{
    return &surface_now(self)->topology;
}

brush *rig_model_brush(rig_model *self)
{
    return surface_now(self)->brush;
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

bool rig_model_is_pending(const rig_model *self)
{
    return self->edition > 0 &&
           (self->waits_s >= 0.0 || rig_worker_is_busy(self->worker) || self->for_stage);
}

/* ---- binding ---- */

/* Offers the mesh without a rig to the stage after the draft was undone. */
static void offer_mesh_alone(rig_model *self)
{
    face_file *file = calloc(1, sizeof *file);
    error err;
    if (file && mesh_copy(&file->mesh, &self->whole.mesh, &err) >= 0 &&
        topology_copy(&file->topology, &self->whole.topology, &err) >= 0) {
        self->for_stage = file;
        return;
    }
    free_file(file);
}

static void ask(rig_model *self)
{
    const surface *on = surface_now(self);
    order all = {.m = &on->mesh, .t = &on->topology, .number = self->edition};
    error err;
    const rig *now = rig_model_rig(self);
    bool keeps = now && !rig_model_is_saved(self);
    self->waits_s = -1.0;
    if (!now) {
        offer_mesh_alone(self);
        return;
    }
    if (rig_copy(&all.rig, now, &err) < 0)
        return;
    const char *keep_path = keeps ? rig_keep_begin(&self->keep) : NULL;
    all.keep_path = keep_path ? strdup(keep_path) : NULL;
    if (rig_worker_ask(self->worker, &all, &err) < 0)
        self->waits_s = RIG_MODEL_WAIT_S; /* retry later, when memory may be available */
}

/* Drops a result whose face has another vertex count than the shown face. */
static void drop_work_elsewhere(rig_model *self)
{
    if (!self->work || surface_of(self, &self->work->rig) == surface_now(self))
        return;
    rig_work_destroy(self->work);
    self->work = NULL;
}

static bool take_work(rig_model *self)
{
    rig_work *work = rig_worker_take(self->worker);
    if (!work)
        return false;
    rig_work_destroy(self->work);
    self->work = work;
    drop_work_elsewhere(self);
    if (!self->work)
        return true;
    if (work->file && rig_model_is_laid(self) &&
        self->edition > 0) { /* the stage already has edition 0 */
        free_file(self->for_stage);
        self->for_stage = work->file;
        work->file = NULL;
    }
    return true;
}

/* Must not run while the worker may write the file. */
static void end_keeping(rig_model *self)
{
    bool is_wanted = !rig_model_is_saved(self) && !self->is_left;
    if (is_wanted || self->waits_s >= 0.0 || rig_worker_is_busy(self->worker))
        return;
    rig_keep_end(&self->keep);
    if (!self->is_moved)
        return;
    rig_keep_close(&self->keep);
    self->is_moved = rig_keep_open(&self->keep, self->keep_folder, self->path, NULL) < 0;
}

void rig_model_request_binding(rig_model *self)
{
    if (!self->is_looked_at && self->edition == 0 && rig_model_rig(self))
        self->waits_s = 0.0;
    self->is_looked_at = true;
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

face_file *rig_model_pop_face(rig_model *self)
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
    leave_draft(self); /* the draft belongs to the previous state */
    drop_work_elsewhere(self);
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
    if (before < self->saved_number) /* the saved state is no longer in the history */
        self->is_saved_known = false;
    rig_history_push(self->history, self->changing);
    free(self->changing);
    self->changing = NULL;
    if (rig_model_number(self) <= self->asked_number)
        self->asked_number = 0; /* this state no longer exists */
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
    if (!rig_history_restore(self->history, number))
        return false;
    has_changed(self);
    return true;
}

/* Commits a rig and takes ownership. */
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

/* Tests whether the mouth can be cut, so that the user is only asked if it can. Consumes the mesh.
 */
static void try_cut(drafting *self)
{
    error ignored;
    const face_file *file = &self->file;
    if (rig_draft_mouth(&self->chain, &self->chain_count, NULL, &file->mesh, &file->topology,
                        &ignored) < 0)
        self->chain = NULL;
    if (!self->chain ||
        face_file_cut_mouth(&self->file, self->chain, self->chain_count, &ignored) >= 0)
        return;
    free(self->chain);
    self->chain = NULL;
}

static void *make_draft(void *given)
{
    drafting *self = given;
    rig_model_drafted *made = &self->made;
    if (self->cuts)
        made->result = face_file_cut_mouth(&self->file, self->chain, self->chain_count, &made->err);
    if (made->result >= 0)
        made->result =
            face_file_draft(&self->rig, &made->confirm, &self->file.mesh, &self->file.topology,
                            self->mesh_path, self->chain, self->chain_count, &made->err);
    if (made->result < 0)
        self->rig = (rig){0};
    else if (!self->cuts && rig_draft_is_clay(&self->rig))
        try_cut(self);
    if (atomic_exchange(&self->state, DRAFT_DONE) == DRAFT_LEFT)
        free_draft(self);
    return NULL;
}

static mrt_result begin_draft(drafting *made, error *err)
{
    pthread_t thread;
    if (pthread_create(&thread, NULL, make_draft, made) != 0)
        return error_set(err, MRT_ERR_MEMORY, "no thread to draft the rig");
    (void)pthread_detach(thread);
    return MRT_OK;
}

/* chain: line along which to cut a mouth; the draft takes ownership. NULL: no cut. */
static mrt_result draft(rig_model *self, uint32_t *chain, uint32_t count, error *err)
{
    drafting *made = calloc(1, sizeof *made);
    if (!made) {
        free(chain);
        return no_memory(err);
    }
    made->cuts = chain != NULL;
    made->chain = chain;
    made->chain_count = count;
    mrt_result result = mesh_copy(&made->file.mesh, &self->whole.mesh, err);
    if (result >= 0)
        result = topology_copy(&made->file.topology, &self->whole.topology, err);
    if (result >= 0 && !(made->mesh_path = strdup(self->mesh_path)))
        result = no_memory(err);
    if (result >= 0)
        result = begin_draft(made, err);
    if (result < 0)
        free_draft(made);
    else
        self->draft = made;
    return result;
}

mrt_result rig_model_draft(rig_model *self, error *err)
{
    return self->draft ? MRT_OK : draft(self, NULL, 0, err);
}

bool rig_model_asks_mouth(const rig_model *self)
{
    return self->asked_number > 0 && self->asked_number == rig_model_number(self);
}

void rig_model_leave_clay(rig_model *self)
{
    self->asked_number = 0;
}

mrt_result rig_model_cut_mouth(rig_model *self, error *err)
{
    if (self->draft || !rig_model_asks_mouth(self))
        return MRT_OK;
    const size_t size = self->chain_count * sizeof *self->chain;
    uint32_t *chain = malloc(size);
    if (!chain)
        return no_memory(err);
    memcpy(chain, self->chain, size);
    return draft(self, chain, self->chain_count, err);
}

bool rig_model_is_drafting(const rig_model *self)
{
    return self->draft != NULL;
}

bool rig_model_is_busy(const rig_model *self)
{
    return self->draft || self->waits_s >= 0.0 || rig_worker_is_busy(self->worker) ||
           self->for_stage;
}

/* Keeps the surface for rigs with a cut mouth and takes ownership. A head is cut in one place only.
 */
static mrt_result keep_cut(rig_model *self, face_file *file, error *err)
{
    if (self->cut.brush)
        return MRT_OK;
    self->cut.mesh = file->mesh;
    self->cut.topology = file->topology;
    file->mesh = (mesh){0};
    file->topology = (topology){0};
    mrt_result result = brush_create(&self->cut.brush, &self->cut.mesh, &self->cut.topology, err);
    if (result < 0)
        surface_finish(&self->cut);
    return result;
}

bool rig_model_pop_draft(rig_model *self, rig_model_drafted *out)
{
    drafting *made = self->draft;
    if (!made || atomic_load(&made->state) != DRAFT_DONE)
        return false;
    self->draft = NULL;
    *out = made->made;
    out->has_cut = made->cuts;
    made->made.confirm = NULL;
    if (out->result >= 0 && made->cuts)
        out->result = keep_cut(self, &made->file, &out->err);
    if (out->result >= 0) {
        out->result = commit_rig(self, &made->rig, &out->number, &out->err);
        made->rig = (rig){0}; /* ownership moved to the state */
    }
    if (out->result >= 0 && !made->cuts && made->chain) {
        free(self->chain);
        self->chain = made->chain;
        self->chain_count = made->chain_count;
        self->asked_number = out->number;
        made->chain = NULL;
    }
    free_draft(made);
    return true;
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

mrt_result rig_model_save_as(rig_model *self, const char *path, error *err)
{
    char *folder = file_directory(path), *copy = strdup(path);
    mrt_result result = folder && copy ? MRT_OK : no_memory(err);
    if (result >= 0 && file_check_below(folder, self->mesh_path, NULL) < 0)
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "save the rig in the folder of its mesh or in a folder above it: %s",
                           self->mesh_path);
    char *before = self->path;
    if (result >= 0) {
        self->path = copy;
        result = rig_model_save(self, err);
        self->path = result >= 0 ? copy : before;
        self->is_moved |= result >= 0;
    }
    free(result >= 0 ? before : copy);
    free(folder);
    return result;
}

bool rig_model_has_recovered(const rig_model *self)
{
    return self->keep.old_path != NULL;
}

/* Makes the cut surface for a restored rig that cuts the mouth of this mesh. */
static mrt_result cut_for(rig_model *self, const rig *r, error *err)
{
    face_file file = {.rig = NULL};
    if (!r->cut_mouth || self->cut.brush || r->mesh_vertex_count == self->whole.mesh.vertex_count)
        return MRT_OK;
    mrt_result result = mesh_copy(&file.mesh, &self->whole.mesh, err);
    if (result >= 0)
        result = face_file_cut_mouth(&file, r->cut_mouth, r->cut_mouth_count, err);
    if (result >= 0)
        result = keep_cut(self, &file, err);
    face_file_destroy(&file);
    return result;
}

mrt_result rig_model_restore_recovered(rig_model *self, uint64_t *out_number, error *err)
{
    rig kept;
    if (!self->keep.old_path)
        return error_set(err, MRT_ERR_ARGUMENT, "no unsaved changes of this rig were found");
    mrt_result result = rig_read_trusted(&kept, self->keep.old_path, err);
    if (result < 0)
        return result;
    result = cut_for(self, &kept, err);
    if (result >= 0)
        result = rig_keep_take(&self->keep, &kept, &surface_of(self, &kept)->mesh, err);
    if (result < 0)
        rig_destroy(&kept);
    return result < 0 ? result : commit_rig(self, &kept, out_number, err);
}

void rig_model_discard_recovered(rig_model *self)
{
    if (self->keep.old_path)
        (void)unlink(self->keep.old_path);
    free(self->keep.old_path);
    self->keep.old_path = NULL;
}

void rig_model_leave(rig_model *self)
{
    self->is_left = true;
}
