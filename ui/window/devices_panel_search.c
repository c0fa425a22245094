#include "window/devices_panel_search.h"

#include "base/clock.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

static const int64_t period_ns = 2 * NS_PER_S, interest_ns = 5 * NS_PER_S;

typedef struct findings {
    device_list devices;
    calibration_list calibrations;
    error note;
} findings;

struct devices_search {
    const plugin_list *plugins;
    log_queue *log;
    pthread_t thread;
    pthread_mutex_t mutex; /* guards what follows up to is_stopping */
    pthread_cond_t change;
    findings posted;
    bool has_posted, is_asked, is_stopping;
    int64_t wanted_ns;
    findings shown; /* [main] */
    bool is_known;
    log_once hush; /* the thread's */
    findings made;
};

/* ---- the thread ---- */

static void look(devices_search *self)
{
    error err = {""};
    findings *made = &self->made;
    *made = (findings){.devices = {.count = 0}};
    if (device_list_look(&made->devices, self->plugins, self->log, &self->hush, &err) < 0)
        made->note = err;
    error note = {""};
    if (calibration_folder_list(&made->calibrations, &note, &err) < 0)
        note = err;
    if (!made->note.text[0])
        made->note = note;
}

static bool is_due(const devices_search *self, int64_t next_ns)
{
    int64_t now_ns = clock_now_ns();
    bool is_wanted = now_ns - self->wanted_ns < interest_ns;
    return self->is_asked || (is_wanted && now_ns >= next_ns);
}

static void wait_until(devices_search *self, int64_t time_ns)
{
    const struct timespec until = {.tv_sec = (time_t)(time_ns / NS_PER_S),
                                   .tv_nsec = (long)(time_ns % NS_PER_S)};
    (void)pthread_cond_timedwait(&self->change, &self->mutex, &until);
}

static void post(devices_search *self)
{
    calibration_list_finish(&self->posted.calibrations);
    self->posted = self->made;
    self->has_posted = true;
}

static void *search(void *data)
{
    devices_search *self = data;
    int64_t next_ns = 0;
    pthread_mutex_lock(&self->mutex);
    while (!self->is_stopping) {
        if (!is_due(self, next_ns)) {
            wait_until(self, clock_now_ns() + period_ns);
            continue;
        }
        self->is_asked = false;
        pthread_mutex_unlock(&self->mutex);
        look(self);
        pthread_mutex_lock(&self->mutex);
        post(self);
        next_ns = clock_now_ns() + period_ns;
    }
    pthread_mutex_unlock(&self->mutex);
    return NULL;
}

/* ---- main ---- */

devices_search *devices_search_create(const plugin_list *plugins, log_queue *log)
{
    devices_search *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->plugins = plugins;
    self->log = log;
    self->wanted_ns = INT64_MIN / 2;
    log_once_reset(&self->hush);
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&self->change, &attributes);
    pthread_condattr_destroy(&attributes);
    pthread_mutex_init(&self->mutex, NULL);
    if (pthread_create(&self->thread, NULL, search, self) == 0)
        return self;
    pthread_cond_destroy(&self->change);
    pthread_mutex_destroy(&self->mutex);
    free(self);
    return NULL;
}

void devices_search_destroy(devices_search *self)
{
    if (!self)
        return;
    pthread_mutex_lock(&self->mutex);
    self->is_stopping = true;
    pthread_cond_signal(&self->change);
    pthread_mutex_unlock(&self->mutex);
    pthread_join(self->thread, NULL);
    pthread_cond_destroy(&self->change);
    pthread_mutex_destroy(&self->mutex);
    calibration_list_finish(&self->posted.calibrations);
    calibration_list_finish(&self->shown.calibrations);
    free(self);
}

/* The mutex is never held for long: what takes time is done without it. */
void devices_search_want(devices_search *self)
{
    int64_t now_ns = clock_now_ns();
    pthread_mutex_lock(&self->mutex);
    bool was_idle = now_ns - self->wanted_ns >= interest_ns;
    self->wanted_ns = now_ns;
    if (was_idle)
        pthread_cond_signal(&self->change);
    pthread_mutex_unlock(&self->mutex);
}

void devices_search_again(devices_search *self)
{
    pthread_mutex_lock(&self->mutex);
    self->is_asked = true;
    pthread_cond_signal(&self->change);
    pthread_mutex_unlock(&self->mutex);
}

devices_seen devices_search_look(devices_search *self)
{
    pthread_mutex_lock(&self->mutex);
    if (self->has_posted) {
        calibration_list_finish(&self->shown.calibrations);
        self->shown = self->posted;
        self->posted.calibrations = (calibration_list){.count = 0};
        self->has_posted = false;
        self->is_known = true;
    }
    pthread_mutex_unlock(&self->mutex);
    return (devices_seen){self->is_known, &self->shown.devices, &self->shown.calibrations,
                          self->shown.note.text};
}
