#include "window/front_inside.h"

#include "draw/gl.h"
#include "io/export.h"
#include "window/theme.h"

#include <stdlib.h>
#include <string.h>

/* ---- what both do ---- */

static float part_of(uint32_t colour, uint32_t shift)
{
    return (float)(colour >> shift & 0xffu) / 255.0f;
}

void front_clear(uint32_t width_px, uint32_t height_px)
{
    glViewport(0, 0, (GLsizei)width_px, (GLsizei)height_px);
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClearColor(part_of(THEME_STAGE, 24), part_of(THEME_STAGE, 16), part_of(THEME_STAGE, 8), 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
}

/* OpenGL's first row is the lowest; nothing is seen through a window. */
static void turn_over(uint8_t *rgba, uint32_t width, uint32_t height)
{
    const size_t row_size = (size_t)width * 4;
    for (uint32_t row = 0; row < height / 2; ++row) {
        uint8_t *above = rgba + row * row_size, *below = rgba + (height - 1 - row) * row_size;
        for (size_t i = 0; i < row_size; ++i) {
            const uint8_t kept = above[i];
            above[i] = below[i];
            below[i] = kept;
        }
    }
    for (size_t i = 3; i < row_size * height; i += 4)
        rgba[i] = 255;
}

mrt_result front_sheet_init(front_sheet *out, uint32_t width, uint32_t height, error *err)
{
    *out = (front_sheet){.width_px = width, .height_px = height};
    glGenTextures(1, &out->colour);
    glBindTexture(GL_TEXTURE_2D, out->colour);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)width, (GLsizei)height, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glBindTexture(GL_TEXTURE_2D, 0);
    glGenFramebuffers(1, &out->framebuffer);
    gl_bind_framebuffer(GL_FRAMEBUFFER, out->framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, out->colour, 0);
    mrt_result result = gl_check_error("a picture", err);
    if (result == MRT_OK && glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "a picture of %u x %u pixels cannot be drawn here", width, height);
    return result;
}

void front_sheet_finish(front_sheet *self)
{
    if (self->framebuffer)
        glDeleteFramebuffers(1, &self->framebuffer);
    if (self->colour)
        glDeleteTextures(1, &self->colour);
    *self = (front_sheet){0};
}

mrt_result front_write_picture(uint32_t width_px, uint32_t height_px, const char *png_path,
                               error *err)
{
    uint8_t *rgba = malloc((size_t)width_px * height_px * 4);
    if (!rgba)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory for a picture of %u x %u", png_path,
                         width_px, height_px);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glReadPixels(0, 0, (GLsizei)width_px, (GLsizei)height_px, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    turn_over(rgba, width_px, height_px);
    mrt_result result = png_write(png_path, rgba, width_px, height_px, err);
    free(rgba);
    return result;
}

/* ---- a texture over everything ---- */

static const char fill_vertex[] =
    "out vec2 place;\n"
    "uniform float mirror;\n"
    "void main() {\n"
    "    vec2 corner = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);\n"
    "    place = vec2(mix(corner.x, 1.0 - corner.x, mirror), corner.y);\n"
    "    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);\n"
    "}\n";
static const char fill_fragment[] =
    "in vec2 place;\n"
    "out vec4 colour;\n"
    "uniform sampler2D picture;\n"
    "void main() { colour = vec4(texture(picture, place).rgb, 1.0); }\n";

mrt_result front_fill_init(front_fill *out, error *err)
{
    const gl_source stages[GL_STAGE_COUNT] = {
        {"fill.vert", fill_vertex, sizeof fill_vertex - 1},
        {"fill.frag", fill_fragment, sizeof fill_fragment - 1}};
    *out = (front_fill){0};
    out->program = gl_program_create(stages, "", err);
    if (!out->program)
        return MRT_ERR_UNSUPPORTED;
    glUseProgram(out->program);
    glUniform1i(glGetUniformLocation(out->program, "picture"), 0);
    glUseProgram(0);
    out->mirror = glGetUniformLocation(out->program, "mirror");
    glGenVertexArrays(1, &out->vertex_array);
    return gl_check_error("the output", err);
}

void front_fill_finish(front_fill *self)
{
    if (self->vertex_array)
        glDeleteVertexArrays(1, &self->vertex_array);
    if (self->program)
        glDeleteProgram(self->program);
    *self = (front_fill){0};
}

void front_fill_draw(const front_fill *self, uint32_t texture, bool is_mirrored, uint32_t width_px,
                     uint32_t height_px)
{
    front_clear(width_px, height_px);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glUseProgram(self->program);
    glUniform1f(self->mirror, is_mirrored ? 1.0f : 0.0f);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, texture);
    glBindVertexArray(self->vertex_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    glUseProgram(0);
}

/* ---- each its own way ---- */

void front_close(front *self)
{
    if (self)
        self->type->close(self);
}

bool front_begin(front *self, ui *to, ui_screen *out_screen)
{
    return self->type->begin(self, to, out_screen);
}

void front_end(front *self, ui *from)
{
    self->type->end(self, from);
}

mrt_result front_picture(front *self, const char *png_path, error *err)
{
    return self->type->picture(self, png_path, err);
}

void front_set_title(front *self, const char *title)
{
    if (self->type->set_title)
        self->type->set_title(self, title);
}

uint32_t front_width_px(const front *self)
{
    return self->width_px;
}

uint32_t front_height_px(const front *self)
{
    return self->height_px;
}

bool front_read_gamepad(front *self, front_gamepad *out)
{
    *out = (front_gamepad){0};
    return self->type->read_gamepad(self, out);
}

mrt_result front_open_output(front *self, error *err)
{
    return front_has_output(self) ? MRT_OK : self->type->open_output(self, err);
}

void front_close_output(front *self)
{
    if (front_has_output(self))
        self->type->close_output(self);
}

bool front_has_output(const front *self)
{
    return self->type->has_output(self);
}

void front_output_size(const front *self, uint32_t *out_width, uint32_t *out_height)
{
    *out_width = *out_height = 0;
    if (front_has_output(self))
        self->type->output_size(self, out_width, out_height);
}

void front_show_output(front *self, uint32_t texture, bool is_mirrored)
{
    if (front_has_output(self))
        self->type->show_output(self, texture, is_mirrored);
}
