#include "window/app/camera_setup.h"
#include "window/app/camera_package.h"
#include "window/app/camera_page.h"

#include <pthread.h>
#include <stdlib.h>

struct camera_setup {
    pthread_t thread;
    camera_fetch going;    /* of the download that goes on */
    pthread_mutex_t mutex; /* guards all fields below */
    pthread_cond_t changed;
    bool is_ending, is_fetch_wanted, is_show_wanted;
    uint16_t port;
    camera_setup_state state;
};

/* ---- the thread ---- */

static void look(camera_setup *self)
{
    const bool has_tracker = camera_package_is_there(), has_browser = camera_page_has_browser();
    (void)pthread_mutex_lock(&self->mutex);
    self->state.has_tracker = has_tracker;
    self->state.has_browser = has_browser;
    self->state.is_known = true;
    (void)pthread_mutex_unlock(&self->mutex);
}

static void fetch(camera_setup *self)
{
    error err = {""};
    const mrt_result result = camera_package_fetch(&self->going, &err);
    const bool is_cancelled = atomic_load(&self->going.is_cancelled);
    (void)pthread_mutex_lock(&self->mutex);
    self->state.is_fetching = false;
    self->state.has_tracker = result >= 0;
    self->state.trouble = result < 0 && !is_cancelled ? err : (error){""};
    (void)pthread_mutex_unlock(&self->mutex);
}

static void show(camera_setup *self, uint16_t port)
{
    error err = {""};
    const mrt_result result = camera_page_show(port, &err);
    (void)pthread_mutex_lock(&self->mutex);
    self->state.trouble = result < 0 ? err : (error){""};
    (void)pthread_mutex_unlock(&self->mutex);
}

static void *run(void *given)
{
    camera_setup *self = given;
    look(self);
    (void)pthread_mutex_lock(&self->mutex);
    while (!self->is_ending) {
        const bool is_fetch = self->is_fetch_wanted, is_show = self->is_show_wanted;
        const uint16_t port = self->port;
        if (!is_fetch && !is_show) {
            (void)pthread_cond_wait(&self->changed, &self->mutex);
            continue;
        }
        if (is_fetch)
            self->is_fetch_wanted = false;
        else
            self->is_show_wanted = false;
        (void)pthread_mutex_unlock(&self->mutex);
        if (is_fetch)
            fetch(self);
        else
            show(self, port);
        (void)pthread_mutex_lock(&self->mutex);
    }
    (void)pthread_mutex_unlock(&self->mutex);
    return NULL;
}

/* ---- [main] ---- */

camera_setup *camera_setup_create(void)
{
    camera_setup *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    (void)pthread_mutex_init(&self->mutex, NULL);
    (void)pthread_cond_init(&self->changed, NULL);
    if (pthread_create(&self->thread, NULL, run, self) == 0)
        return self;
    (void)pthread_cond_destroy(&self->changed);
    (void)pthread_mutex_destroy(&self->mutex);
    free(self);
    return NULL;
}

void camera_setup_destroy(camera_setup *self)
{
    if (!self)
        return;
    atomic_store(&self->going.is_cancelled, true);
    (void)pthread_mutex_lock(&self->mutex);
    self->is_ending = true;
    (void)pthread_cond_signal(&self->changed);
    (void)pthread_mutex_unlock(&self->mutex);
    (void)pthread_join(self->thread, NULL);
    (void)pthread_cond_destroy(&self->changed);
    (void)pthread_mutex_destroy(&self->mutex);
    free(self);
}

camera_setup_state camera_setup_now(camera_setup *self)
{
    (void)pthread_mutex_lock(&self->mutex);
    camera_setup_state out = self->state;
    (void)pthread_mutex_unlock(&self->mutex);
    out.done = atomic_load(&self->going.done);
    out.whole = atomic_load(&self->going.whole);
    return out;
}

void camera_setup_fetch(camera_setup *self)
{
    (void)pthread_mutex_lock(&self->mutex);
    if (!self->state.is_fetching) {
        atomic_store(&self->going.is_cancelled, false);
        atomic_store(&self->going.done, 0);
        atomic_store(&self->going.whole, 0);
        self->state.is_fetching = self->is_fetch_wanted = true;
        self->state.trouble = (error){""};
        (void)pthread_cond_signal(&self->changed);
    }
    (void)pthread_mutex_unlock(&self->mutex);
}

void camera_setup_cancel(camera_setup *self)
{
    atomic_store(&self->going.is_cancelled, true);
}

void camera_setup_show(camera_setup *self, uint16_t port)
{
    (void)pthread_mutex_lock(&self->mutex);
    self->is_show_wanted = true;
    self->port = port;
    (void)pthread_cond_signal(&self->changed);
    (void)pthread_mutex_unlock(&self->mutex);
}

void camera_setup_forget_trouble(camera_setup *self)
{
    (void)pthread_mutex_lock(&self->mutex);
    self->state.trouble = (error){""};
    (void)pthread_mutex_unlock(&self->mutex);
}
