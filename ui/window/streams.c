#include "window/streams.h"
#include "window/viewport/viewport.h"

#include "draw/gl.h"
#include "stream/stream.h"
#include "stream/video.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { READS = 3 };

typedef struct reading { /* a picture on its way from the graphics card */
    GLuint buffer;
    GLsync done; /* NULL: none being read */
} reading;

struct streams {
    app *of;
    viewport *from;
    uint64_t edition; /* of what is open */
    stream_target *target[STREAM_TARGETS_MAX];
    uint32_t count;
    bool is_ending; /* the targets were stopped and have not all ended */
    stream_look look;
    double wait_s;
    GLuint framebuffer;
    reading reading[READS];
    uint32_t first, going; /* of the readings */
};

bool streams_ground(const char *text, float out[4])
{
    video_look look = video_look_default();
    if (!text[0] || !video_look_ground(&look, text) || look.picture_path)
        return false;
    memcpy(out, look.rgba, 4 * sizeof *out);
    return true;
}

streams *streams_create(app *of, viewport *from)
{
    streams *self = calloc(1, sizeof *self);
    if (self) {
        self->of = of;
        self->from = from;
    }
    return self;
}

/* Stops all streams together, so that several that hang take their timeout only once. */
static void stop_targets(streams *self)
{
    for (uint32_t i = 0; i < self->count; ++i)
        stream_stop(self->target[i]);
    self->is_ending = true;
}

static bool have_ended(const streams *self)
{
    bool have = true;
    for (uint32_t i = 0; i < self->count; ++i)
        have &= stream_status_of(self->target[i]).has_ended;
    return have;
}

static void close_targets(streams *self)
{
    for (uint32_t i = 0; i < self->count; ++i) {
        const stream_status last = stream_status_of(self->target[i]);
        if (last.says[0])
            news_list_add(app_news(self->of), MRT_LOG_WARNING, "stream", last.says);
        stream_close(self->target[i]);
    }
    self->count = 0;
    self->is_ending = false;
    for (int i = 0; i < READS; ++i) {
        if (self->reading[i].done)
            glDeleteSync(self->reading[i].done);
        if (self->reading[i].buffer)
            glDeleteBuffers(1, &self->reading[i].buffer);
        self->reading[i] = (reading){0};
    }
    self->first = self->going = 0;
}

void streams_destroy(streams *self)
{
    if (!self)
        return;
    stop_targets(self);
    close_targets(self);
    if (self->framebuffer)
        glDeleteFramebuffers(1, &self->framebuffer);
    free(self);
}

bool streams_are_on(const streams *self)
{
    return self->count > 0;
}

/* ---- what is wanted ---- */

static void open_targets(streams *self, const app_picture *wanted)
{
    char text[sizeof wanted->targets], *rest = NULL;
    error err = {""};
    self->look = (stream_look){wanted->width, wanted->height, wanted->fps};
    (void)snprintf(text, sizeof text, "%s", wanted->targets);
    for (char *one = strtok_r(text, " ", &rest); one && self->count < STREAM_TARGETS_MAX;
         one = strtok_r(NULL, " ", &rest))
        if (stream_open(&self->target[self->count], one, &self->look, &err) >= 0)
            self->count += 1;
        else
            news_list_add(app_news(self->of), MRT_LOG_WARNING, "stream", err.text);
    const size_t size = (size_t)self->look.width * self->look.height * 4;
    for (int i = 0; i < READS && self->count > 0; ++i) {
        glGenBuffers(1, &self->reading[i].buffer);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, self->reading[i].buffer);
        glBufferData(GL_PIXEL_PACK_BUFFER, (GLsizeiptr)size, NULL, GL_STREAM_READ);
    }
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    if (self->framebuffer == 0)
        glGenFramebuffers(1, &self->framebuffer);
}

static void tell(streams *self)
{
    char says[STREAM_MESSAGE] = "";
    for (uint32_t i = 0; i < self->count; ++i) {
        const stream_status now = stream_status_of(self->target[i]);
        if (now.says[0])
            (void)snprintf(says, sizeof says, "%s", now.says);
    }
    app_note_picture(self->of, says, self->count);
}

/* ---- read back ---- */

/* The oldest, if it has come; OpenGL's first row is the lowest. */
static void collect(streams *self)
{
    reading *one = &self->reading[self->first];
    if (self->going == 0 || glClientWaitSync(one->done, 0, 0) == GL_TIMEOUT_EXPIRED)
        return;
    const size_t row = (size_t)self->look.width * 4, size = row * self->look.height;
    glDeleteSync(one->done);
    one->done = NULL;
    self->first = (self->first + 1) % READS;
    self->going -= 1;
    glBindBuffer(GL_PIXEL_PACK_BUFFER, one->buffer);
    const uint8_t *rgba =
        glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0, (GLsizeiptr)size, GL_MAP_READ_BIT);
    for (uint32_t i = 0; rgba && i < self->count; ++i) {
        uint8_t *to = stream_picture(self->target[i]);
        for (uint32_t y = 0; y < self->look.height; ++y)
            memcpy(to + y * row, rgba + (self->look.height - 1 - y) * row, row);
        stream_give(self->target[i]);
    }
    if (rgba)
        (void)glUnmapBuffer(GL_PIXEL_PACK_BUFFER);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

static void begin(streams *self)
{
    if (self->going == READS) /* the card is behind: this one is left out */
        return;
    const uint32_t texture =
        viewport_output(self->from, VIEWPORT_STREAM, self->look.width, self->look.height);
    if (!texture)
        return;
    reading *one = &self->reading[(self->first + self->going) % READS];
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, self->framebuffer);
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, one->buffer);
    glReadPixels(0, 0, (GLsizei)self->look.width, (GLsizei)self->look.height, GL_RGBA,
                 GL_UNSIGNED_BYTE, NULL);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, 0);
    one->done = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    self->going += 1;
}

void streams_update(streams *self, double dt_s)
{
    const app_picture *wanted = app_picture_now(self->of);
    if (wanted->edition != self->edition && !self->is_ending)
        stop_targets(self);
    if (self->is_ending) { /* what comes next may want the same port or device */
        app_want_frame(self->of, 0.05);
        if (!have_ended(self))
            return;
        close_targets(self);
        open_targets(self, wanted);
        self->edition = wanted->edition;
        tell(self);
    }
    if (self->count == 0)
        return;
    app_want_frame(self->of, 0.0); /* a picture is on its way, or soon due */
    collect(self);
    self->wait_s -= dt_s;
    if (self->wait_s > 0.0)
        return;
    self->wait_s += 1.0 / self->look.fps;
    if (self->wait_s < 0.0) /* frames are slower than that: every one */
        self->wait_s = 0.0;
    begin(self);
    tell(self);
}
