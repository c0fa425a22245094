#include "draw/target.h"

#include <stdlib.h>

enum { SIDE_MAX = 16384, SAMPLES_WANTED = 4 };
static const uint64_t area_max = 36u << 20; /* 36 Mpixel: 1.3 GB of samples and depth */

static mrt_result check_size(uint32_t width, uint32_t height, error *err)
{
    if (width == 0 || height == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "a picture of %u x %u pixels cannot be drawn",
                         width, height);
    GLint side = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    uint32_t most = side > SIDE_MAX ? SIDE_MAX : side > 0 ? (uint32_t)side : 0;
    if (width > most || height > most || (uint64_t)width * height > area_max)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a picture of %u x %u pixels is too large: at most %u on a side and %u "
                         "million in all",
                         width, height, most, (unsigned)(area_max >> 20));
    return MRT_OK;
}

static GLint samples_offered(void)
{
    GLint colour = 1, depth = 1;
    glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &colour);
    glGetIntegerv(GL_MAX_SAMPLES, &depth);
    GLint offered = colour < depth ? colour : depth;
    return offered > SAMPLES_WANTED ? SAMPLES_WANTED : offered < 1 ? 1 : offered;
}

static mrt_result check_framebuffer(const char *what, error *err)
{
    GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE)
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "the graphics driver cannot draw into %s (status 0x%04x)", what, status);
}

static GLsizei framebuffer_width(const draw_target *self)
{
    return (GLsizei)(self->width * self->side);
}

static GLsizei framebuffer_height(const draw_target *self)
{
    return (GLsizei)(self->height * self->side);
}

static void attach_pixels(draw_target *self)
{
    GLsizei width = framebuffer_width(self), height = framebuffer_height(self);
    glBindTexture(GL_TEXTURE_2D, self->samples);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, self->samples, 0);
}

static void attach_samples(draw_target *self)
{
    GLsizei width = (GLsizei)self->width, height = (GLsizei)self->height;
    self->sample_count = samples_offered();
    glBindTexture(GL_TEXTURE_2D_MULTISAMPLE, self->samples);
    glTexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, self->sample_count, GL_RGBA8, width, height,
                            GL_TRUE);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, self->sample_count, GL_DEPTH_COMPONENT24,
                                     width, height);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D_MULTISAMPLE,
                           self->samples, 0);
}

static mrt_result create_samples(draw_target *self, error *err)
{
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    uint32_t longer = self->width > self->height ? self->width : self->height;
    self->side = gl_is_llvmpipe() && 2 * longer <= (uint32_t)most ? 2 : 1;
    glGenTextures(1, &self->samples);
    glGenRenderbuffers(1, &self->depth);
    glBindRenderbuffer(GL_RENDERBUFFER, self->depth);
    glGenFramebuffers(1, &self->framebuffer);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->framebuffer);
    if (self->side > 1)
        attach_pixels(self);
    else
        attach_samples(self);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, self->depth);
    mrt_result result = gl_check_error("the samples of a picture", err);
    return result == MRT_OK ? check_framebuffer("the samples of a picture", err) : result;
}

static mrt_result create_picture(draw_target *self, error *err)
{
    glGenTextures(1, &self->picture);
    glBindTexture(GL_TEXTURE_2D, self->picture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)self->width, (GLsizei)self->height, 0,
                 GL_RGBA, GL_UNSIGNED_BYTE, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glGenFramebuffers(1, &self->picture_framebuffer);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->picture_framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, self->picture, 0);
    mrt_result result = gl_check_error("a picture", err);
    return result == MRT_OK ? check_framebuffer("a picture", err) : result;
}

static mrt_result create_resolve(draw_target *self, error *err)
{
    const gl_source stages[] = {shaders_screen_vert, shaders_resolve_frag};
    self->resolve_program =
        gl_program_create(stages, self->side > 1 ? "#define PIXELS\n" : "", err);
    if (!self->resolve_program)
        return MRT_ERR_UNSUPPORTED;
    glUseProgram(self->resolve_program);
    glUniform1i(glGetUniformLocation(self->resolve_program, "samples"), 0);
    glUniform1i(glGetUniformLocation(self->resolve_program, "sample_count"), self->sample_count);
    self->keeps_alpha = glGetUniformLocation(self->resolve_program, "keeps_alpha");
    glGenVertexArrays(1, &self->vertex_array);
    return gl_check_error("the resolve program", err);
}

void target_change(draw_target *self)
{
    self->stale = true;
    self->has_scene = false;
    self->changed[0] = self->changed[1] = 0;
    self->changed[2] = framebuffer_width(self);
    self->changed[3] = framebuffer_height(self);
}

static void clear(draw_target *self)
{
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->framebuffer);
    glViewport(0, 0, framebuffer_width(self), framebuffer_height(self));
    glClearColor(0.052f, 0.055f, 0.062f, 1.0f); /* slightly darker than the wall */
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    target_change(self);
}

draw_target *draw_target_create(uint32_t width, uint32_t height, error *err)
{
    if (gl_check_current(err) != MRT_OK || check_size(width, height, err) != MRT_OK)
        return NULL;
    draw_target *self = calloc(1, sizeof *self);
    if (!self) {
        error_set(err, MRT_ERR_MEMORY, "no memory for a picture");
        return NULL;
    }
    self->width = width;
    self->height = height;
    gl_state before;
    gl_state_enter(&before);
    bool made = create_samples(self, err) == MRT_OK && create_picture(self, err) == MRT_OK &&
                create_resolve(self, err) == MRT_OK;
    if (made)
        clear(self);
    gl_state_leave(&before);
    if (made)
        return self;
    draw_target_destroy(self);
    return NULL;
}

void draw_target_destroy(draw_target *self)
{
    if (!self)
        return;
    glDeleteFramebuffers(1, &self->framebuffer);
    glDeleteFramebuffers(1, &self->picture_framebuffer);
    glDeleteTextures(1, &self->samples);
    glDeleteTextures(1, &self->picture);
    glDeleteRenderbuffers(1, &self->depth);
    glDeleteVertexArrays(1, &self->vertex_array);
    glDeleteProgram(self->resolve_program);
    free(self);
}

static void resolve(draw_target *self)
{
    if (!self->stale)
        return;
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->picture_framebuffer);
    const GLint side = (GLint)self->side, *at = self->changed;
    const GLint left = at[0] / side, bottom = at[1] / side;
    glViewport(0, 0, (GLsizei)self->width, (GLsizei)self->height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(left, bottom, (at[2] + side - 1) / side - left, (at[3] + side - 1) / side - bottom);
    glUseProgram(self->resolve_program);
    glUniform1i(self->keeps_alpha, self->is_clear);
    glBindVertexArray(self->vertex_array);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(self->side > 1 ? GL_TEXTURE_2D : GL_TEXTURE_2D_MULTISAMPLE, self->samples);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_SCISSOR_TEST);
    self->stale = false;
}

enum { RECTANGLE_MAX = 32768 };

bool target_viewport(GLint out[4], const draw_target *self, const uint32_t rectangle[4])
{
    const uint32_t width = rectangle[2], height = rectangle[3];
    const GLint side = (GLint)self->side;
    if (width == 0 || height == 0 || rectangle[0] >= self->width || rectangle[1] >= self->height ||
        width > RECTANGLE_MAX || height > RECTANGLE_MAX)
        return false;
    out[0] = (GLint)rectangle[0] * side;
    out[1] = ((GLint)self->height - (GLint)rectangle[1] - (GLint)height) * side;
    out[2] = (GLint)width * side;
    out[3] = (GLint)height * side;
    return true;
}

void target_begin(draw_target *self, const GLint viewport[4])
{
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->framebuffer);
    glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
    glEnable(GL_SCISSOR_TEST);
    glScissor(viewport[0], viewport[1], viewport[2], viewport[3]);
    target_change(self);
}

uint32_t draw_target_texture(draw_target *self)
{
    gl_state before;
    gl_state_enter(&before);
    resolve(self);
    gl_state_leave(&before);
    return self->picture;
}

uint32_t draw_target_copy(draw_target *self)
{
    gl_state before;
    GLuint texture = 0;
    gl_state_enter(&before);
    resolve(self);
    gl_end_scene();
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, self->picture_framebuffer);
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glCopyTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 0, 0, (GLsizei)self->width, (GLsizei)self->height,
                     0);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl_state_leave(&before);
    return texture;
}

void draw_texture_destroy(uint32_t texture)
{
    if (texture)
        glDeleteTextures(1, &texture);
}

void draw_read(draw_target *self, uint8_t *out_rgba)
{
    gl_state before;
    gl_state_enter(&before);
    resolve(self);
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, self->picture_framebuffer);
    gl_read_picture(out_rgba, self->width, self->height);
    gl_state_leave(&before);
}
