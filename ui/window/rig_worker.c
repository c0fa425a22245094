#include "window/rig_worker.h"

#include "mesh/copy.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef struct order { /* what is asked */
    rig rig;
    uint64_t number;
    char *keep_path;
} order;

struct rig_worker {
    const mesh *m;
    const topology *t;
    pthread_t thread;
    pthread_mutex_t lock; /* of all below */
    pthread_cond_t news;
    order *waiting;
    rig_work *done;
    bool is_working, is_ending;
};

static void destroy_order(order *o)
{
    if (!o)
        return;
    rig_destroy(&o->rig);
    free(o->keep_path);
    free(o);
}

void rig_work_destroy(rig_work *work)
{
    if (!work)
        return;
    face_destroy(work->face);
    face_file_destroy(work->file);
    free(work->file);
    rig_findings_finish(&work->findings);
    rig_destroy(&work->rig);
    free(work->region_size);
    free(work);
}

/* ---- the work [worker] ---- */

/* So that the stage need not find it again. */
static mrt_result copy_binding(face_file *file, const binding *b, error *err)
{
    file->bound = calloc(1, sizeof *file->bound);
    return file->bound ? binding_copy(file->bound, b, file->rig->contact_count, err)
                       : error_set(err, MRT_ERR_MEMORY, "no memory for the face");
}

static mrt_result copy_for_stage(rig_work *work, const rig_worker *self, error *err)
{
    face_file *file = calloc(1, sizeof *file);
    work->file = file;
    rig *copy = file ? calloc(1, sizeof *copy) : NULL;
    if (!copy)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the face");
    file->rig = copy;
    mrt_result result = rig_copy(copy, &work->rig, err);
    if (result >= 0)
        result = mesh_copy(&file->mesh, self->m, err);
    if (result >= 0)
        result = topology_copy(&file->topology, self->t, err);
    return result < 0 ? result : copy_binding(file, face_binding(work->face), err);
}

/* binding: taken over. */
static mrt_result make_face(rig_work *work, const rig_worker *self, binding *b, error *err)
{
    mrt_result result =
        face_create_bound(&work->face, &work->rig, self->m, b, MRT_MAX_VECTORS, err);
    return result < 0 ? result : copy_for_stage(work, self, err);
}

static mrt_result lay(rig_work *work, const rig_worker *self, error *err)
{
    binding b = {0};
    error check_err = {""};
    const rig *r = &work->rig;
    mrt_result result = rig_validate(r, self->m, self->t, err);
    if (result >= 0)
        result = binding_create(&b, r, self->m, self->t, err);
    mrt_result checked =
        rig_check(&work->findings, r, self->m, self->t, result >= 0 ? &b : NULL, &check_err);
    if (result >= 0)
        result = make_face(work, self, &b, err);
    if (result >= 0 && checked < 0) {
        *err = check_err;
        result = checked;
    }
    binding_destroy(&b);
    return result;
}

static void count_regions(rig_work *work, const rig_worker *self)
{
    uint32_t vertex_count = self->m->vertex_count;
    float *share = calloc((size_t)vertex_count + 1, sizeof *share);
    work->region_size = calloc(work->rig.region_count + 1u, sizeof *work->region_size);
    for (uint32_t i = 0; share && work->region_size && i < work->rig.region_count; ++i) {
        if (bind_select(share, &work->rig.region[i].select, self->m, self->t, NULL) < 0)
            continue;
        for (uint32_t v = 0; v < vertex_count; ++v)
            work->region_size[i] += share[v] > 0.0f;
    }
    free(share);
}

static void drop_what_failed(rig_work *work)
{
    face_destroy(work->face);
    face_file_destroy(work->file);
    free(work->file);
    work->face = NULL;
    work->file = NULL;
}

static rig_work *work_on(const rig_worker *self, order *o)
{
    rig_work *work = calloc(1, sizeof *work);
    if (!work)
        return NULL;
    work->number = o->number;
    work->rig = o->rig;
    o->rig = (rig){0};
    if (o->keep_path)
        work->kept = rig_write(&work->rig, o->keep_path, &work->keep_err);
    work->result = lay(work, self, &work->err);
    if (work->result < 0)
        drop_what_failed(work);
    count_regions(work, self);
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
        rig_work *work = work_on(self, o);
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

mrt_result rig_worker_create(rig_worker **out, const mesh *m, const topology *t, error *err)
{
    rig_worker *self = calloc(1, sizeof *self);
    *out = NULL;
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to check the rig");
    self->m = m;
    self->t = t;
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

void rig_worker_destroy(rig_worker *self)
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

mrt_result rig_worker_ask(rig_worker *self, rig *r, uint64_t number, const char *keep_path,
                          error *err)
{
    order *o = calloc(1, sizeof *o);
    char *path = keep_path ? strdup(keep_path) : NULL;
    if (!o || (keep_path && !path)) {
        rig_destroy(r);
        free(o);
        free(path);
        return error_set(err, MRT_ERR_MEMORY, "no memory to check the rig");
    }
    *o = (order){*r, number, path};
    *r = (rig){0};
    (void)pthread_mutex_lock(&self->lock);
    order *before = self->waiting;
    self->waiting = o;
    (void)pthread_cond_signal(&self->news);
    (void)pthread_mutex_unlock(&self->lock);
    destroy_order(before);
    return MRT_OK;
}

rig_work *rig_worker_take(rig_worker *self)
{
    (void)pthread_mutex_lock(&self->lock);
    rig_work *out = self->done;
    self->done = NULL;
    (void)pthread_mutex_unlock(&self->lock);
    return out;
}

bool rig_worker_is_busy(rig_worker *self)
{
    (void)pthread_mutex_lock(&self->lock);
    bool is_busy = self->waiting || self->is_working;
    (void)pthread_mutex_unlock(&self->lock);
    return is_busy;
}
