#include "window/app/show_copier.h"

#include "take/pack.h"
#include "take/show.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct show_copier {
    char *from, *to;
    pthread_t thread;
    atomic_bool has_ended;
    mrt_result result; /* once it has ended, as the error */
    error err;
};

static mrt_result copy_faces(show *of, const char *to, error *err)
{
    int64_t *id = NULL;
    size_t count = 0;
    mrt_result result = show_performance_ids(of, &id, &count, err);
    for (size_t i = 0; i < count && result >= 0; ++i) {
        show_performance one = {0};
        result = show_performance_read(of, id[i], &one, err);
        if (result >= 0)
            result = pack_copy(show_path(of), to, &one.performance, err);
        show_performance_finish(&one);
    }
    free(id);
    return result < 0 ? result : MRT_OK;
}

static void *copy(void *data)
{
    show_copier *self = data;
    show *of = NULL;
    mrt_result result = show_open(&of, self->from, SHOW_READ, &self->err);
    if (result >= 0)
        result = show_rescue(of, self->to, &self->err);
    if (result >= 0) {
        result = copy_faces(of, self->to, &self->err);
        if (result < 0)
            (void)unlink(self->to);
    }
    show_close(of);
    self->result = result;
    atomic_store(&self->has_ended, true);
    return NULL;
}

mrt_result show_copier_begin(show_copier **out, const char *from, const char *to, error *err)
{
    *out = NULL;
    if (access(to, F_OK) == 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s is there already: a show is never written over, choose another name",
                         to);
    show_copier *self = calloc(1, sizeof *self);
    if (self) {
        self->from = strdup(from);
        self->to = strdup(to);
    }
    if (self && self->from && self->to && pthread_create(&self->thread, NULL, copy, self) == 0) {
        *out = self;
        return MRT_OK;
    }
    if (self) {
        free(self->from);
        free(self->to);
    }
    free(self);
    return error_set(err, MRT_ERR_MEMORY, "no memory to copy the show");
}

mrt_result show_copier_look(show_copier *self, error *err)
{
    if (!atomic_load(&self->has_ended))
        return MRT_END;
    if (self->result < 0)
        *err = self->err;
    return self->result < 0 ? self->result : MRT_OK;
}

const char *show_copier_path(const show_copier *self)
{
    return self->to;
}

void show_copier_destroy(show_copier *self)
{
    if (!self)
        return;
    (void)pthread_join(self->thread, NULL);
    free(self->from);
    free(self->to);
    free(self);
}
