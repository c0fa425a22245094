#include "window/app/kept_scenery.h"

#include "base/file.h"
#include "base/text.h"
#include "show/hash.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A picture that is read and decoded on a thread of its own. */
typedef struct reading {
    pthread_t thread;
    atomic_bool is_done;
    char *path; /* NULL: the bytes are there */
    void *bytes;
    size_t size;
    char hash[TAKE_HASH], name[SCENERY_NAME];
    scenery_picture picture;
    mrt_result result;
    error err;
} reading;

struct kept_scenery {
    app *of;
    scenery now, kept;
    reading *reading;        /* NULL: none being read */
    char tried[TAKE_HASH];   /* the show's picture that was asked for last */
    scenery_picture picture; /* of `tried`, if it could be had */
    uint64_t picture_number;
};

/* ---- undo ---- */

static const char *words_of(const scenery *a, const scenery *b)
{
    if (strcmp(a->picture, b->picture) != 0 || a->fit != b->fit)
        return "the background picture";
    if (a->view_count != b->view_count || memcmp(a->view, b->view, sizeof a->view) != 0)
        return "a camera view";
    if (memcmp(a->light.lamp, b->light.lamp, sizeof a->light.lamp) == 0 &&
        a->light.room == b->light.room)
        return "the wall";
    return "the light";
}

static void write_scene(kept_scenery *self)
{
    show *into = app_show(self->of);
    error err = {""};
    self->kept = self->now;
    if (into && show_is_writable(into) && scenery_write(&self->now, into, &err) < 0)
        news_list_add(app_news(self->of), MRT_LOG_ERROR, "scene", err.text);
}

static mrt_result set(void *owner, const void *value)
{
    kept_scenery *self = owner;
    self->now = *(const scenery *)value;
    write_scene(self);
    return MRT_OK;
}

void kept_scenery_keep(kept_scenery *self)
{
    if (memcmp(&self->now, &self->kept, sizeof self->now) == 0)
        return;
    undo_change made = {.owner = self, .set = set};
    (void)snprintf(made.words, sizeof made.words, "%s", words_of(&self->now, &self->kept));
    app_add_copied_change(self->of, &made, &self->kept, &self->now, sizeof self->now);
    write_scene(self);
}

/* ---- the picture ---- */

static void *run(void *data)
{
    reading *job = data;
    file_bytes file = {0};
    job->result = MRT_OK;
    if (job->path) {
        job->result = file_read(&file, job->path, SHOW_PICTURE_BYTES, &job->err);
        job->bytes = file.data;
        job->size = file.size;
    }
    if (job->result >= 0 && job->path)
        hash_bytes(job->hash, job->bytes, job->size);
    if (job->result >= 0)
        job->result =
            scenery_picture_decode(&job->picture, job->bytes, job->size, job->name, &job->err);
    atomic_store_explicit(&job->is_done, true, memory_order_release);
    return NULL;
}

static void reading_free(reading *job)
{
    scenery_picture_finish(&job->picture);
    free(job->path);
    free(job->bytes);
    free(job);
}

/* Takes the path or the bytes over. */
static mrt_result start(kept_scenery *self, char *path, void *bytes, size_t size, const char *hash,
                        const char *name, error *err)
{
    reading *job = calloc(1, sizeof *job);
    if (!job || (!path && !bytes)) {
        free(path);
        free(bytes);
        free(job);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a picture");
    }
    job->path = path;
    job->bytes = bytes;
    job->size = size;
    (void)snprintf(job->hash, sizeof job->hash, "%s", hash);
    text_copy(job->name, sizeof job->name, text_view_of(name, strlen(name)));
    if (pthread_create(&job->thread, NULL, run, job) == 0) {
        self->reading = job;
        return MRT_OK;
    }
    reading_free(job);
    return error_set(err, MRT_ERR_IO, "no thread to read a picture");
}

mrt_result kept_scenery_choose(kept_scenery *self, const char *path, error *err)
{
    show *into = app_show(self->of);
    if (!into || !show_is_writable(into))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a background picture is saved in the show: open a writable show first");
    if (self->reading)
        return error_set(err, MRT_ERR_ARGUMENT, "another picture is being read");
    return start(self, strdup(path), NULL, 0, "", file_name_of(path), err);
}

/* Reads the picture behind the face from the show. */
static mrt_result fetch(kept_scenery *self, error *err)
{
    void *bytes = NULL;
    size_t size = 0;
    mrt_result result =
        show_picture_read(app_show(self->of), self->now.picture, &bytes, &size, err);
    if (result == MRT_END)
        return error_set(err, MRT_ERR_FORMAT,
                         "the background picture %s is no longer in the show. The wall is shown: "
                         "choose the picture again",
                         self->now.picture_name);
    return result < 0
               ? result
               : start(self, NULL, bytes, size, self->now.picture, self->now.picture_name, err);
}

static void take_picture(kept_scenery *self, reading *job)
{
    scenery_picture_finish(&self->picture);
    self->picture = job->picture;
    job->picture = (scenery_picture){0};
    (void)snprintf(self->tried, sizeof self->tried, "%s", job->hash);
    self->picture_number += 1;
}

static mrt_result end_reading(kept_scenery *self, reading *job, error *err)
{
    if (job->result < 0)
        return error_set(err, job->result, "%s", job->err.text);
    if (!job->path) { /* the user may have chosen another one in the meantime */
        if (strcmp(job->hash, self->now.picture) == 0)
            take_picture(self, job);
        return MRT_OK;
    }
    mrt_result result =
        show_picture_write(app_show(self->of), job->hash, job->bytes, job->size, err);
    if (result < 0)
        return result;
    take_picture(self, job);
    memset(self->now.picture_name, 0, sizeof self->now.picture_name);
    (void)snprintf(self->now.picture, sizeof self->now.picture, "%s", job->hash);
    (void)snprintf(self->now.picture_name, sizeof self->now.picture_name, "%s", job->name);
    kept_scenery_keep(self);
    return MRT_OK;
}

static void drop_picture(kept_scenery *self)
{
    if (self->picture.rgba)
        self->picture_number += 1;
    scenery_picture_finish(&self->picture);
}

void kept_scenery_update(kept_scenery *self)
{
    error err = {""};
    mrt_result result = MRT_OK;
    if (self->reading && !atomic_load_explicit(&self->reading->is_done, memory_order_acquire))
        return;
    if (self->reading) {
        reading *job = self->reading;
        self->reading = NULL;
        (void)pthread_join(job->thread, NULL);
        result = end_reading(self, job, &err);
        reading_free(job);
    } else if (strcmp(self->now.picture, self->tried) != 0) {
        drop_picture(self);
        (void)snprintf(self->tried, sizeof self->tried, "%s", self->now.picture);
        if (self->now.picture[0])
            result = fetch(self, &err);
    }
    if (result < 0)
        news_list_add(app_news(self->of), MRT_LOG_WARNING, "scene", err.text);
}

const scenery_picture *kept_scenery_picture(const kept_scenery *self, uint64_t *out_number)
{
    *out_number = self->picture_number;
    return &self->picture;
}

bool kept_scenery_is_reading(const kept_scenery *self)
{
    return self->reading != NULL;
}

/* ---- the scene ---- */

/* Discards what is being read: it was for another show. */
static void end_thread(kept_scenery *self)
{
    if (!self->reading)
        return;
    (void)pthread_join(self->reading->thread, NULL);
    reading_free(self->reading);
    self->reading = NULL;
}

void kept_scenery_read(kept_scenery *self)
{
    show *from = app_show(self->of);
    error err = {""};
    end_thread(self);
    app_forget_changes(self->of, self);
    drop_picture(self);
    self->tried[0] = '\0';
    mrt_result result = scenery_read(&self->now, from, &err);
    self->kept = self->now;
    /* Undo of an earlier run may have had others. */
    if (result >= 0 && from && show_is_writable(from))
        result = show_pictures_forget(from, self->now.picture, &err);
    if (result < 0)
        news_list_add(app_news(self->of), MRT_LOG_WARNING, "scene", err.text);
}

const scenery *kept_scenery_now(const kept_scenery *self)
{
    return &self->now;
}

void kept_scenery_set(kept_scenery *self, const scenery *to)
{
    self->now = *to;
}

kept_scenery *kept_scenery_create(app *of)
{
    kept_scenery *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of = of;
    self->now = self->kept = scenery_default();
    return self;
}

void kept_scenery_destroy(kept_scenery *self)
{
    if (!self)
        return;
    app_forget_changes(self->of, self);
    end_thread(self);
    scenery_picture_finish(&self->picture);
    free(self);
}
