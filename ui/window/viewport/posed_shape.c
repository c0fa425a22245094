#include "window/viewport/posed_shape.h"

#include "face/rig/rig_poses.h"
#include "mesh/arkit.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { SHAPE_NAME = 64 };
typedef struct wish { /* requested poses */
    char pose[POSED_TOGETHER][SHAPE_NAME];
} wish;

typedef struct model { /* model of one face; owned by the thread until `is_ready` */
    rig rig;
    mesh mesh;
    topology topology;
    rig_poses_stage stage;
} model;

struct posed_shape {
    /* source of the copy; may no longer exist and is only compared */
    const face_file *file;
    const rig *of_rig;
    const float *of_position;
    bool has_thread;
    pthread_t thread;
    pthread_mutex_t lock; /* guards all fields below except the model */
    pthread_cond_t news;
    bool is_ending, is_ready; /* is_ready: the model is complete and its rig is constant */
    bool is_wished, is_shown;
    wish wished, shown;
    model *model;
    float *found, *taken; /* vertex_count by 3; taken: copy of the shape for [main] */
};

/* ---- the thread ---- */

static uint32_t index_of(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (strcmp(r->pose[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

/* Adds the head's own shape of that name, which is a pose too (live_poses). */
static void add_target(const mesh *m, const char *name, float *out)
{
    for (uint32_t i = 0; i < m->target_count; ++i)
        if (arkit_is_same_name(m->target[i].name, name)) {
            for (size_t k = 0; k < (size_t)m->vertex_count * 3; ++k)
                out[k] += m->target[i].offset[k];
            return;
        }
}

/* Computes the sum of the poses. */
static void find_shape(model *of, const wish *wanted, float *out)
{
    const size_t size = (size_t)of->mesh.vertex_count * 3;
    error ignored = {""};
    memcpy(out, of->mesh.position, size * sizeof *out);
    for (int k = 0; k < POSED_TOGETHER && wanted->pose[k][0]; ++k) {
        const uint32_t pose = index_of(&of->stage.rig, wanted->pose[k]);
        if (pose == RIG_NONE)
            add_target(&of->mesh, wanted->pose[k], out);
        if (pose == RIG_NONE || rig_poses_show(&of->stage, pose, &ignored) < 0)
            continue;
        for (size_t i = 0; i < size; ++i)
            out[i] += of->stage.position[i] - of->mesh.position[i];
    }
}

static void *run(void *given)
{
    posed_shape *self = given;
    error ignored = {""};
    model *of = self->model;
    const bool is_laid =
        rig_poses_stage_init(&of->stage, &of->rig, &of->mesh, &of->topology, &ignored) >= 0;
    (void)pthread_mutex_lock(&self->lock);
    self->is_ready = is_laid;
    while (is_laid && !self->is_ending) {
        if (!self->is_wished) {
            (void)pthread_cond_wait(&self->news, &self->lock);
            continue;
        }
        const wish wanted = self->wished;
        self->is_wished = false;
        if (self->is_shown && memcmp(&self->shown, &wanted, sizeof wanted) == 0)
            continue; /* the request has changed during the computation */
        self->is_shown = false;
        (void)pthread_mutex_unlock(&self->lock);
        find_shape(of, &wanted, self->found);
        (void)pthread_mutex_lock(&self->lock);
        self->shown = wanted;
        self->is_shown = true;
    }
    (void)pthread_mutex_unlock(&self->lock);
    return NULL;
}

/* ---- [main] ---- */

posed_shape *posed_shape_create(void)
{
    posed_shape *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    (void)pthread_mutex_init(&self->lock, NULL);
    (void)pthread_cond_init(&self->news, NULL);
    return self;
}

static void drop(posed_shape *self)
{
    if (self->has_thread) {
        (void)pthread_mutex_lock(&self->lock);
        self->is_ending = true;
        (void)pthread_cond_signal(&self->news);
        (void)pthread_mutex_unlock(&self->lock);
        (void)pthread_join(self->thread, NULL);
    }
    self->has_thread = self->is_ending = self->is_ready = self->is_wished = self->is_shown = false;
    if (self->model) {
        rig_poses_stage_finish(&self->model->stage);
        rig_destroy(&self->model->rig);
        mesh_destroy(&self->model->mesh);
        topology_destroy(&self->model->topology);
    }
    free(self->model);
    free(self->found);
    free(self->taken);
    self->model = NULL;
    self->found = self->taken = NULL;
}

void posed_shape_destroy(posed_shape *self)
{
    if (!self)
        return;
    drop(self);
    (void)pthread_cond_destroy(&self->news);
    (void)pthread_mutex_destroy(&self->lock);
    free(self);
}

static void begin(posed_shape *self, const face_file *of)
{
    error ignored = {""};
    const size_t size = (size_t)of->mesh.vertex_count * 3 * sizeof(float);
    self->model = calloc(1, sizeof *self->model);
    self->found = malloc(size + 1);
    self->taken = malloc(size + 1);
    if (!self->model || !self->found || !self->taken ||
        rig_copy(&self->model->rig, of->rig, &ignored) < 0 ||
        mesh_copy(&self->model->mesh, &of->mesh, &ignored) < 0 ||
        topology_copy(&self->model->topology, &of->topology, &ignored) < 0 ||
        pthread_create(&self->thread, NULL, run, self) != 0) {
        drop(self);
        return;
    }
    self->has_thread = true;
}

void posed_shape_follow(posed_shape *self, const face_file *of)
{
    const rig *r = of ? of->rig : NULL;
    const float *position = of ? of->mesh.position : NULL;
    if (of == self->file && r == self->of_rig && position == self->of_position)
        return;
    self->file = of;
    self->of_rig = r;
    self->of_position = position;
    drop(self);
    if (r)
        begin(self, of);
}

const rig *posed_shape_rig(posed_shape *self)
{
    (void)pthread_mutex_lock(&self->lock);
    const bool is_ready = self->is_ready;
    (void)pthread_mutex_unlock(&self->lock);
    return is_ready ? &self->model->stage.rig : NULL;
}

const float *posed_shape_of(posed_shape *self, const char *const pose[POSED_TOGETHER],
                            uint32_t *out_vertex_count)
{
    wish wanted = {{{0}}}; /* zeroed, so that memcmp can compare it */
    if (!self->model)
        return NULL;
    for (int k = 0; k < POSED_TOGETHER && pose[k]; ++k)
        for (size_t i = 0; i + 1 < SHAPE_NAME && pose[k][i]; ++i)
            wanted.pose[k][i] = pose[k][i];
    (void)pthread_mutex_lock(&self->lock);
    const bool is_it = self->is_shown && memcmp(&self->shown, &wanted, sizeof wanted) == 0;
    if (is_it) {
        memcpy(self->taken, self->found,
               (size_t)self->model->mesh.vertex_count * 3 * sizeof *self->taken);
    } else {
        self->wished = wanted;
        self->is_wished = true;
        (void)pthread_cond_signal(&self->news);
    }
    (void)pthread_mutex_unlock(&self->lock);
    *out_vertex_count = self->model->mesh.vertex_count;
    return is_it ? self->taken : NULL;
}
