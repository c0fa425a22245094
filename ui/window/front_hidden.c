/* The stage with no window: framebuffers in a context without a display. */
#include "base/clock.h"
#include "draw/draw.h"
#include "draw/gl.h"
#include "window/front_hidden.h"
#include "window/front_inside.h"

#include <stdlib.h>

enum { OUTPUT_WIDTH = 1280, OUTPUT_HEIGHT = 720, REAL_FPS = 60 };

typedef struct hidden {
    front base;
    draw_context *context;
    front_sheet stage, output;
    front_fill fill;
    float scale;
    double dt_s; /* 0: as the clock goes, at most REAL_FPS frames a second */
    int64_t began_ns;
    bool has_output;
    front_gamepad gamepad;
    bool has_gamepad;
} hidden;

static hidden *hidden_of(front *self)
{
    return (hidden *)self;
}

static void hidden_close(front *base)
{
    hidden *self = hidden_of(base);
    if (self->context) {
        front_fill_finish(&self->fill);
        front_sheet_finish(&self->output);
        front_sheet_finish(&self->stage);
    }
    draw_context_destroy(self->context);
    free(self);
}

static double real_dt_s(hidden *self)
{
    const int64_t next_ns = self->began_ns + NS_PER_S / REAL_FPS;
    if (self->began_ns && clock_now_ns() < next_ns)
        clock_sleep_until_ns(next_ns);
    const int64_t now_ns = clock_now_ns();
    const double dt_s = self->began_ns ? 1e-9 * (double)(now_ns - self->began_ns) : 0.0;
    self->began_ns = now_ns;
    return dt_s;
}

static bool hidden_begin(front *base, ui *to, ui_screen *out_screen)
{
    hidden *self = hidden_of(base);
    (void)to;
    *out_screen = (ui_screen){.width = (float)base->width_px / self->scale,
                              .height = (float)base->height_px / self->scale,
                              .scale = self->scale,
                              .dt_s = self->dt_s > 0.0 ? self->dt_s : real_dt_s(self)};
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    front_clear(base->width_px, base->height_px);
    return true;
}

static void hidden_end(front *base, ui *from)
{
    (void)base;
    (void)from;
    gl_end_scene();
    glFlush();
}

static mrt_result hidden_picture(front *base, const char *png_path, error *err)
{
    gl_bind_framebuffer(GL_FRAMEBUFFER, hidden_of(base)->stage.framebuffer);
    return front_write_picture(base->width_px, base->height_px, png_path, err);
}

static bool hidden_read_gamepad(front *base, front_gamepad *out)
{
    *out = hidden_of(base)->gamepad;
    return hidden_of(base)->has_gamepad;
}

static mrt_result hidden_open_output(front *base, error *err)
{
    hidden *self = hidden_of(base);
    mrt_result result = self->fill.program ? MRT_OK : front_fill_init(&self->fill, err);
    if (result == MRT_OK)
        result = front_sheet_init(&self->output, OUTPUT_WIDTH, OUTPUT_HEIGHT, err);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    self->has_output = result == MRT_OK;
    if (!self->has_output)
        front_sheet_finish(&self->output);
    return result;
}

static void hidden_close_output(front *base)
{
    front_sheet_finish(&hidden_of(base)->output);
    hidden_of(base)->has_output = false;
}

static bool hidden_has_output(const front *base)
{
    return ((const hidden *)base)->has_output;
}

static void hidden_output_size(const front *base, uint32_t *out_width, uint32_t *out_height)
{
    *out_width = ((const hidden *)base)->output.width_px;
    *out_height = ((const hidden *)base)->output.height_px;
}

static void hidden_show_output(front *base, uint32_t texture, bool is_mirrored)
{
    hidden *self = hidden_of(base);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->output.framebuffer);
    front_fill_draw(&self->fill, texture, is_mirrored, self->output.width_px,
                    self->output.height_px);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    glViewport(0, 0, (GLsizei)base->width_px, (GLsizei)base->height_px);
}

static const front_type type = {
    .close = hidden_close,
    .begin = hidden_begin,
    .end = hidden_end,
    .picture = hidden_picture,
    .read_gamepad = hidden_read_gamepad,
    .open_output = hidden_open_output,
    .close_output = hidden_close_output,
    .has_output = hidden_has_output,
    .output_size = hidden_output_size,
    .show_output = hidden_show_output,
};

mrt_result front_open_hidden(front **out, uint32_t width, uint32_t height, float scale, double dt_s,
                             error *err)
{
    *out = NULL;
    if (width == 0 || height == 0 || width > 16384 || height > 16384 || !(scale >= 0.25f) ||
        !(scale <= 8.0f))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a stage of %u x %u pixels at scale %.2f: expected 1 to 16384 pixels a "
                         "side, and a scale of 0.25 to 8",
                         width, height, (double)scale);
    hidden *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    self->base = (front){.type = &type, .width_px = width, .height_px = height};
    self->scale = scale;
    self->dt_s = dt_s;
    self->context = draw_context_create(err);
    mrt_result result =
        self->context ? front_sheet_init(&self->stage, width, height, err) : MRT_ERR_UNSUPPORTED;
    if (result < 0) {
        hidden_close(&self->base);
        return result;
    }
    *out = &self->base;
    return MRT_OK;
}

void front_hidden_gamepad(front *base, const front_gamepad *now)
{
    hidden *self = hidden_of(base);
    self->has_gamepad = now != NULL;
    self->gamepad = now ? *now : (front_gamepad){0};
}

mrt_result front_hidden_output_picture(front *base, const char *png_path, error *err)
{
    hidden *self = hidden_of(base);
    if (!self->has_output)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the output is not open", png_path);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->output.framebuffer);
    mrt_result result =
        front_write_picture(self->output.width_px, self->output.height_px, png_path, err);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    return result;
}
