#include "video.h"

#include "draw/easel.h"
#include "video_ffmpeg.h"
#include "video_folder.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

enum { QUEUE = 4 };

typedef struct sink { /* one of them */
    video_folder *folder;
    video_ffmpeg *ffmpeg;
} sink;

typedef struct frame { /* that waits to be drawn */
    float *position;   /* vertex_count by 3, the file's order */
    uint32_t repeats;  /* of its picture */
} frame;

typedef enum video_state {
    VIDEO_OPENS = 0,
    VIDEO_RUNS,
    VIDEO_ENDS, /* draws what waits, then ends */
    VIDEO_GIVES_UP
} video_state;

struct video {
    video_settings settings;
    video_file file[VIDEO_FILES_MAX];
    uint32_t file_count;
    pthread_t thread;
    bool has_thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    /* under the lock */
    video_state state;
    frame queue[QUEUE];
    uint32_t first, count;
    mrt_result result; /* < 0: failed, for `why` */
    error why;
    /* of the thread; [main] after it */
    easel easel;
    draw_camera camera;
    sink sink[VIDEO_FILES_MAX];
    video_report report;
};

mrt_result video_check(const video_file *file, uint32_t count, const video_look *look, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        if (file[i].is_folder) {
            result = video_folder_check(file[i].path, err);
            continue;
        }
        result = video_look_check_mp4(look, file[i].path, err);
        if (result >= 0)
            result = video_ffmpeg_check(file[i].path, err);
    }
    return result;
}

/* ---- the thread ---- */

static mrt_result open_sinks(video *self, error *err)
{
    const video_settings *s = &self->settings;
    const video_folder_about folder = {s->look.width, s->look.height,
                                       s->look.ground == VIDEO_NOTHING, s->rate, s->timecode};
    const video_ffmpeg_about film = {s->look.width, s->look.height, s->rate, s->timecode, s->sound};
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->file_count && result >= 0; ++i) {
        const char *path = self->file[i].path;
        result = self->file[i].is_folder
                     ? video_folder_open(&self->sink[i].folder, path, &folder, err)
                     : video_ffmpeg_open(&self->sink[i].ffmpeg, path, &film, err);
    }
    return result;
}

static mrt_result open_drawing(video *self, error *err)
{
    const video_look *look = &self->settings.look;
    float low[3], high[3];
    mesh_bounds(self->settings.mesh, low, high);
    self->camera = video_look_camera(look, low, high);
    mrt_result result =
        easel_init(&self->easel, self->settings.mesh, look->width, look->height, err);
    if (result < 0)
        return result;
    draw_ground(self->easel.renderer, look->ground == VIDEO_WALL ? NULL : look->rgba);
    return open_sinks(self, err);
}

static void draw_picture(video *self, const float *position)
{
    const video_look *look = &self->settings.look;
    easel *e = &self->easel;
    draw_face_update(e->face, position, NULL);
    draw_render(e->renderer, e->target, e->face, &self->camera, 0, 0, look->width, look->height);
    draw_read(e->target, e->pixels);
    if (look->is_mirrored)
        video_look_mirror(e->pixels, look->width, look->height);
}

static mrt_result write_picture(video *self, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->file_count && result >= 0; ++i)
        result = self->sink[i].folder
                     ? video_folder_add(self->sink[i].folder, self->easel.pixels, err)
                     : video_ffmpeg_add(self->sink[i].ffmpeg, self->easel.pixels, err);
    self->report.picture_count += result >= 0;
    return result;
}

static mrt_result commit(video *self, error *err)
{
    mrt_result result = MRT_OK;
    if (self->report.picture_count == 0)
        return error_set(err, MRT_ERR_FORMAT, "%s: there is no frame to show", self->file[0].path);
    for (uint32_t i = 0; i < self->file_count && result >= 0; ++i) {
        sink s = self->sink[i];
        self->sink[i] = (sink){0};
        result = s.folder ? video_folder_commit(s.folder, err) : video_ffmpeg_commit(s.ffmpeg, err);
    }
    return result;
}

/* Waits for a frame; false: there is none to come. */
static bool take_frame(video *self, frame *out)
{
    pthread_mutex_lock(&self->lock);
    while (self->count == 0 && self->state == VIDEO_RUNS)
        pthread_cond_wait(&self->changed, &self->lock);
    bool is_there = self->count > 0 && self->state != VIDEO_GIVES_UP;
    if (is_there)
        *out = self->queue[self->first];
    pthread_mutex_unlock(&self->lock);
    return is_there;
}

static void give_back(video *self)
{
    pthread_mutex_lock(&self->lock);
    self->first = (self->first + 1) % QUEUE;
    self->count -= 1;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
}

static mrt_result work(video *self, error *err)
{
    frame next;
    mrt_result result = MRT_OK;
    while (result >= 0 && take_frame(self, &next)) {
        draw_picture(self, next.position);
        for (uint32_t i = 0; i <= next.repeats && result >= 0; ++i)
            result = write_picture(self, err);
        give_back(self);
    }
    if (result >= 0 && self->state == VIDEO_ENDS)
        result = commit(self, err);
    return result;
}

static void tell(video *self, video_state state, mrt_result result, const error *why)
{
    pthread_mutex_lock(&self->lock);
    if (self->state == VIDEO_OPENS)
        self->state = state;
    if (result < 0) {
        self->result = result;
        self->why = *why;
    }
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
}

static void *run(void *data)
{
    video *self = data;
    error err = {""};
    mrt_result result = open_drawing(self, &err);
    tell(self, VIDEO_RUNS, result, &err);
    if (result >= 0)
        result = work(self, &err);
    for (uint32_t i = 0; i < self->file_count; ++i) {
        video_folder_abandon(self->sink[i].folder);
        video_ffmpeg_abandon(self->sink[i].ffmpeg);
    }
    easel_finish(&self->easel);
    tell(self, VIDEO_RUNS, result, &err);
    return NULL;
}

/* Signals are for others; a pipe that nobody reads is an error like any other. */
static mrt_result start_thread(video *self, error *err)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    int failed = pthread_create(&self->thread, NULL, run, self);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed)
        return error_set(err, MRT_ERR_IO, "no thread for the video: %s", strerror(failed));
    self->has_thread = true;
    pthread_mutex_lock(&self->lock);
    while (self->state == VIDEO_OPENS)
        pthread_cond_wait(&self->changed, &self->lock);
    mrt_result result = self->result;
    if (result < 0 && err)
        *err = self->why;
    pthread_mutex_unlock(&self->lock);
    return result;
}

/* ---- [main] ---- */

static mrt_result make_queue(video *self, error *err)
{
    for (int i = 0; i < QUEUE; ++i) {
        self->queue[i].position =
            malloc(((size_t)self->settings.mesh->vertex_count * 3 + 1) * sizeof(float));
        if (!self->queue[i].position)
            return error_set(err, MRT_ERR_MEMORY, "no memory for the video");
    }
    return MRT_OK;
}

mrt_result video_create(video **out, const video_file *file, uint32_t count,
                        const video_settings *settings, error *err)
{
    *out = NULL;
    video *self = count <= VIDEO_FILES_MAX ? calloc(1, sizeof *self) : NULL;
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the video");
    self->settings = *settings;
    self->file_count = count;
    memcpy(self->file, file, count * sizeof *file);
    pthread_mutex_init(&self->lock, NULL);
    pthread_cond_init(&self->changed, NULL);
    mrt_result result = make_queue(self, err);
    if (result >= 0)
        result = start_thread(self, err);
    if (result < 0)
        video_destroy(self);
    else
        *out = self;
    return result;
}

static void end_thread(video *self, video_state state)
{
    if (!self->has_thread)
        return;
    pthread_mutex_lock(&self->lock);
    self->state = state;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
    pthread_join(self->thread, NULL);
    self->has_thread = false;
}

void video_destroy(video *self)
{
    if (!self)
        return;
    end_thread(self, VIDEO_GIVES_UP);
    for (int i = 0; i < QUEUE; ++i)
        free(self->queue[i].position);
    pthread_cond_destroy(&self->changed);
    pthread_mutex_destroy(&self->lock);
    free(self);
}

/* Under the lock. NULL: nowhere to put a frame; it failed, or it is live and late. */
static frame *room(video *self)
{
    bool waits = self->settings.pace == VIDEO_EVERY_FRAME;
    while (waits && self->count == QUEUE && self->result >= 0)
        pthread_cond_wait(&self->changed, &self->lock);
    if (self->result < 0)
        return NULL;
    if (self->count < QUEUE)
        return &self->queue[(self->first + self->count) % QUEUE];
    self->queue[(self->first + QUEUE - 1) % QUEUE].repeats += 1;
    self->report.repeated_count += 1;
    return NULL;
}

mrt_result video_add(video *self, const points *shape, const points_order *order, error *err)
{
    pthread_mutex_lock(&self->lock);
    frame *next = room(self);
    mrt_result result = self->settings.pace == VIDEO_LIVE ? MRT_OK : self->result;
    if (result < 0 && err)
        *err = self->why;
    pthread_mutex_unlock(&self->lock);
    if (!next)
        return result;
    points_to_rows(next->position, shape, order);
    next->repeats = 0;
    pthread_mutex_lock(&self->lock);
    self->count += 1;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
    return result;
}

bool video_has_failed(video *self, error *out_why)
{
    pthread_mutex_lock(&self->lock);
    bool has_failed = self->result < 0;
    if (has_failed)
        *out_why = self->why;
    pthread_mutex_unlock(&self->lock);
    return has_failed;
}

mrt_result video_finish(video *self, error *err)
{
    end_thread(self, VIDEO_ENDS);
    if (self->result < 0 && err)
        *err = self->why;
    return self->result;
}

video_report video_reported(const video *self)
{
    return self->report;
}
