/* "Mouth from this voice": found on a thread of its own, then added to the take by one edit. */
#include "window/app/app_shared.h"

#include "stage/voice/voice_mouth.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct mouth_job {
    show *into; /* its own */
    take of;    /* a copy */
    char *words;
    voice_mouth_settings settings;
    pthread_t thread;
    bool has_thread;
    _Atomic bool is_given_up, has_ended;
    _Atomic uint32_t thousandths;
    edit edit; /* once it has ended, as the rest */
    voice_mouth_report report;
    mrt_result result;
    error err;
} mouth_job;

static bool goes_on(void *data, double part)
{
    mouth_job *self = data;
    atomic_store(&self->thousandths, (uint32_t)(part * 1000.0));
    return !atomic_load(&self->is_given_up);
}

static void *run(void *data)
{
    mouth_job *self = data;
    self->result =
        voice_mouth_make(&self->edit, &self->report, NULL, self->into, &self->settings, &self->err);
    atomic_store(&self->has_ended, true);
    return NULL;
}

static void mouth_job_free(mouth_job *self)
{
    if (self->has_thread)
        (void)pthread_join(self->thread, NULL);
    edit_finish(&self->edit);
    show_close(self->into);
    take_finish(&self->of);
    free(self->words);
    free(self);
}

static mrt_result begin(mouth_job **out, show *into, const take *of, const app_speech_wish *wish,
                        error *err)
{
    *out = NULL;
    mouth_job *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to read the voice");
    self->words = strdup(wish->words);
    mrt_result result = self->words ? take_copy(&self->of, of, err)
                                    : error_set(err, MRT_ERR_MEMORY, "no memory for the words");
    if (result >= 0)
        result = show_join(&self->into, into, err);
    self->settings = (voice_mouth_settings){.take = &self->of,
                                            .jaw = wish->jaw,
                                            .lips = wish->lips,
                                            .phones = {self->words, goes_on, self}};
    if (result >= 0) {
        self->has_thread = pthread_create(&self->thread, NULL, run, self) == 0;
        if (!self->has_thread)
            result = error_set(err, MRT_ERR_MEMORY, "no thread to read the voice");
    }
    if (result < 0) {
        mouth_job_free(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

mrt_result app_speech_begin(app *self, const app_speech_wish *wish)
{
    error err = {0};
    uint32_t count = 0;
    const mrt_rig_pose *poses = live_poses(self->live, &count);
    mrt_result result = voice_mouth_check_face(poses, count, &err);
    if (result >= 0 && (!app_take(self) || !show_is_writable(self->show)))
        result = error_set(&err, MRT_ERR_ARGUMENT, "select a take that can be changed first");
    if (result >= 0 && self->speech.job)
        result = error_set(&err, MRT_ERR_ARGUMENT,
                           "another voice is being read: wait until it is finished");
    if (result >= 0)
        result = begin(&self->speech.job, self->show, app_take(self), wish, &err);
    self->speech.result[0] = '\0';
    if (result < 0)
        (void)snprintf(self->speech.result, sizeof self->speech.result, "%.500s", err.text);
    return result;
}

double app_speech_part(const app *self)
{
    return self->speech.job ? 1e-3 * (double)atomic_load(&self->speech.job->thousandths) : -1.0;
}

void app_speech_cancel(app *self)
{
    if (self->speech.job)
        atomic_store(&self->speech.job->is_given_up, true);
}

const char *app_speech_result(const app *self)
{
    return self->speech.result;
}

void app_drop_speech(app *self)
{
    app_speech_cancel(self);
    if (self->speech.job)
        mouth_job_free(self->speech.job);
    self->speech = (app_speech){.job = NULL};
}

static void finish(app *self, mouth_job *job)
{
    char *line = self->speech.result;
    const size_t capacity = sizeof self->speech.result;
    if (job->result == MRT_END) {
        (void)snprintf(line, capacity, "cancelled. The take is unchanged");
        return;
    }
    if (job->result < 0) {
        (void)snprintf(line, capacity, "%.500s", job->err.text);
        (void)!app_report(self, job->result, &job->err);
        return;
    }
    if (self->takes.chosen != job->of.id && app_pick_take(self, job->of.id) < 0)
        return;
    if (app_edit(self, &job->edit) < 0)
        return;
    voice_mouth_describe(line, capacity, &job->report);
    app_say(self, MRT_LOG_INFO, "mouth from the voice: %.480s", line);
}

/* Does not disturb recording or playback. */
void app_follow_speech(app *self)
{
    mouth_job *job = self->speech.job;
    if (!job || self->status.is_recording || self->recording.over_take || self->awaited.take ||
        !atomic_load(&job->has_ended))
        return;
    self->speech.job = NULL;
    finish(self, job);
    mouth_job_free(job);
}
