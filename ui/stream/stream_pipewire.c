/* A PipeWire camera: a Video/Source node of RGBA frames with straight alpha. The only file that
 * uses libpipewire. Without a viewer it only copies each frame. It never waits for the daemon. */
#include "stream/stream.h"

#include <pipewire/pipewire.h>
#include <spa/param/video/format-utils.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct camera {
    stream_look look;
    struct pw_thread_loop *loop;
    struct pw_context *context;
    struct pw_core *core;
    struct pw_stream *stream;
    struct spa_hook core_listener, stream_listener;
    uint8_t *frame; /* guarded by the lock of the loop, like the members below */
    bool is_gone, is_streaming;
    char why[128];
} camera;

/* ---- callbacks of PipeWire: on its loop, with the lock ---- */

static void on_core_error(void *data, uint32_t id, int sequence, int result, const char *message)
{
    camera *self = data;
    (void)sequence, (void)result;
    if (id != PW_ID_CORE)
        return;
    self->is_gone = true;
    (void)snprintf(self->why, sizeof self->why, "%.100s", message ? message : "");
}

static void on_state(void *data, enum pw_stream_state old, enum pw_stream_state state,
                     const char *message)
{
    camera *self = data;
    (void)old;
    self->is_streaming = state == PW_STREAM_STATE_STREAMING;
    if (state != PW_STREAM_STATE_ERROR && state != PW_STREAM_STATE_UNCONNECTED)
        return;
    self->is_gone = true;
    (void)snprintf(self->why, sizeof self->why, "%.100s", message ? message : "disconnected");
}

static void on_param(void *data, uint32_t id, const struct spa_pod *param)
{
    camera *self = data;
    uint8_t bytes[512];
    struct spa_pod_builder builder = SPA_POD_BUILDER_INIT(bytes, sizeof bytes);
    if (!param || id != SPA_PARAM_Format)
        return;
    const int stride = (int)self->look.width * 4;
    const struct spa_pod *wanted[1] = {spa_pod_builder_add_object(
        &builder, SPA_TYPE_OBJECT_ParamBuffers, SPA_PARAM_Buffers, SPA_PARAM_BUFFERS_buffers,
        SPA_POD_CHOICE_RANGE_Int(4, 2, 8), SPA_PARAM_BUFFERS_blocks, SPA_POD_Int(1),
        SPA_PARAM_BUFFERS_size, SPA_POD_Int(stride * (int)self->look.height),
        SPA_PARAM_BUFFERS_stride, SPA_POD_Int(stride), SPA_PARAM_BUFFERS_dataType,
        SPA_POD_CHOICE_FLAGS_Int((1 << SPA_DATA_MemPtr) | (1 << SPA_DATA_MemFd)))};
    (void)pw_stream_update_params(self->stream, wanted, 1);
}

static void on_process(void *data)
{
    camera *self = data;
    const uint32_t stride = self->look.width * 4, size = stride * self->look.height;
    struct pw_buffer *to = pw_stream_dequeue_buffer(self->stream);
    if (!to) /* the viewers hold all buffers */
        return;
    struct spa_data *at = &to->buffer->datas[0];
    const bool fits = at->data && at->maxsize >= size;
    if (fits)
        memcpy(at->data, self->frame, size);
    at->chunk->offset = 0;
    at->chunk->size = fits ? size : 0;
    at->chunk->stride = (int32_t)stride;
    (void)pw_stream_queue_buffer(self->stream, to);
}

static const struct pw_core_events core_events = {.version = PW_VERSION_CORE_EVENTS,
                                                  .error = on_core_error};
static const struct pw_stream_events stream_events = {.version = PW_VERSION_STREAM_EVENTS,
                                                      .state_changed = on_state,
                                                      .param_changed = on_param,
                                                      .process = on_process};

/* ---- opening and closing ---- */

static void pipewire_close(void *data, error *why)
{
    camera *self = data;
    (void)why;
    if (self->loop)
        pw_thread_loop_stop(self->loop);
    if (self->stream)
        pw_stream_destroy(self->stream);
    if (self->core)
        (void)pw_core_disconnect(self->core);
    if (self->context)
        pw_context_destroy(self->context);
    if (self->loop)
        pw_thread_loop_destroy(self->loop);
    free(self->frame);
    free(self);
    pw_deinit();
}

static bool connect_stream(camera *self, const char *name)
{
    uint8_t bytes[512];
    struct spa_pod_builder builder = SPA_POD_BUILDER_INIT(bytes, sizeof bytes);
    const struct spa_rectangle size = {self->look.width, self->look.height};
    const struct spa_fraction rate = {self->look.fps, 1};
    const struct spa_pod *format[1] = {spa_pod_builder_add_object(
        &builder, SPA_TYPE_OBJECT_Format, SPA_PARAM_EnumFormat, SPA_FORMAT_mediaType,
        SPA_POD_Id(SPA_MEDIA_TYPE_video), SPA_FORMAT_mediaSubtype,
        SPA_POD_Id(SPA_MEDIA_SUBTYPE_raw), SPA_FORMAT_VIDEO_format,
        SPA_POD_Id(SPA_VIDEO_FORMAT_RGBA), SPA_FORMAT_VIDEO_size, SPA_POD_Rectangle(&size),
        SPA_FORMAT_VIDEO_framerate, SPA_POD_Fraction(&rate))};
    self->stream = pw_stream_new(self->core, "marotte",
                                 pw_properties_new(PW_KEY_MEDIA_CLASS, "Video/Source",
                                                   PW_KEY_MEDIA_ROLE, "Camera", PW_KEY_NODE_NAME,
                                                   name, PW_KEY_NODE_DESCRIPTION, name, NULL));
    if (!self->stream)
        return false;
    pw_stream_add_listener(self->stream, &self->stream_listener, &stream_events, self);
    return pw_stream_connect(self->stream, PW_DIRECTION_OUTPUT, PW_ID_ANY,
                             PW_STREAM_FLAG_DRIVER | PW_STREAM_FLAG_MAP_BUFFERS, format, 1) >= 0;
}

static mrt_result pipewire_open(void **out, const char *target, const stream_look *look,
                                const _Atomic bool *stop, error *err)
{
    const char *colon = strchr(target, ':');
    (void)stop; /* this target never waits for the daemon */
    pw_init(NULL, NULL);
    camera *self = calloc(1, sizeof *self);
    if (!self) {
        pw_deinit();
        return error_set(err, MRT_ERR_MEMORY, "no memory for a PipeWire camera");
    }
    self->look = *look;
    self->frame = calloc((size_t)look->width * look->height, 4);
    self->loop = self->frame ? pw_thread_loop_new("marotte-camera", NULL) : NULL;
    self->context =
        self->loop ? pw_context_new(pw_thread_loop_get_loop(self->loop), NULL, 0) : NULL;
    self->core = self->context ? pw_context_connect(self->context, NULL, 0) : NULL;
    if (self->core)
        pw_core_add_listener(self->core, &self->core_listener, &core_events, self);
    if (self->core && connect_stream(self, colon && colon[1] ? colon + 1 : "marotte") &&
        pw_thread_loop_start(self->loop) >= 0) {
        *out = self;
        return MRT_OK;
    }
    const bool has_daemon = self->core != NULL;
    pipewire_close(self, NULL);
    return error_set(err, MRT_ERR_IO,
                     has_daemon ? "PipeWire refuses the camera"
                                : "PipeWire is not running. The camera appears when PipeWire "
                                  "starts");
}

static mrt_result pipewire_give(void *data, const uint8_t *rgba, error *err)
{
    camera *self = data;
    pw_thread_loop_lock(self->loop);
    const bool is_gone = self->is_gone;
    memcpy(self->frame, rgba, (size_t)self->look.width * self->look.height * 4);
    if (!is_gone && self->is_streaming)
        (void)pw_stream_trigger_process(self->stream);
    pw_thread_loop_unlock(self->loop);
    return is_gone ? error_set(err, MRT_ERR_IO,
                               "PipeWire was lost (%s). The camera returns when PipeWire is back",
                               self->why)
                   : MRT_OK;
}

const stream_way stream_pipewire = {pipewire_open, pipewire_give, pipewire_close};
