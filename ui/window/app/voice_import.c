#include "window/app/voice_import.h"
#include "take/sound_file.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct voice_import {
    show *into; /* its own */
    char *path;
    pthread_t thread;
    _Atomic bool is_given_up, has_ended;
    _Atomic uint32_t thousandths;
    int64_t audio; /* once it has ended, as the result and the error */
    mrt_result result;
    error err;
};

static bool goes_on(void *data, double part)
{
    voice_import *self = data;
    atomic_store(&self->thousandths, (uint32_t)(part * 1000.0));
    return !atomic_load(&self->is_given_up);
}

static void *import(void *data)
{
    voice_import *self = data;
    const sound_file_watch watch = {goes_on, self};
    self->result = sound_file_import(&self->audio, self->into, self->path, &watch, &self->err);
    atomic_store(&self->has_ended, true);
    return NULL;
}

static void release(voice_import *self)
{
    show_close(self->into);
    free(self->path);
    free(self);
}

mrt_result voice_import_begin(voice_import **out, show *into, const char *path, error *err)
{
    *out = NULL;
    voice_import *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to read %s", path);
    self->path = strdup(path);
    mrt_result result = show_join(&self->into, into, err);
    if (result >= 0 && (!self->path || pthread_create(&self->thread, NULL, import, self) != 0))
        result = error_set(err, MRT_ERR_MEMORY, "no memory to read %s", path);
    if (result < 0) {
        release(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

mrt_result voice_import_look(voice_import *self, int64_t *out_audio, error *err)
{
    if (!atomic_load(&self->has_ended))
        return MRT_END;
    *out_audio = self->audio;
    if (self->result < 0)
        *err = self->err;
    return self->result < 0 ? self->result : MRT_OK;
}

double voice_import_part(const voice_import *self)
{
    return 1e-3 * (double)atomic_load(&self->thousandths);
}

void voice_import_destroy(voice_import *self)
{
    if (!self)
        return;
    atomic_store(&self->is_given_up, true);
    (void)pthread_join(self->thread, NULL);
    release(self);
}
