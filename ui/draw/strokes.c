#include "draw/strokes.h"
#include "draw/gl.h"
#include "draw/shaders.h"
#include "draw/target.h"

#include <stdlib.h>

struct strokes {
    GLuint program, vertex_array, vertex_buffer;
    GLint target_size;
};

static void add_attribute(GLuint index, GLint component_count, size_t offset)
{
    glVertexAttribPointer(index, component_count, GL_FLOAT, GL_FALSE, sizeof(draw_stroke),
                          (const void *)offset);
    glVertexAttribDivisor(index, 1);
    glEnableVertexAttribArray(index);
}

static mrt_result create_drawing(strokes *self, error *err)
{
    const gl_source stages[] = {shaders_strokes_vert, shaders_strokes_frag};
    self->program = gl_program_create(stages, "", err);
    if (!self->program)
        return MRT_ERR_UNSUPPORTED;
    self->target_size = glGetUniformLocation(self->program, "target_size");
    glGenVertexArrays(1, &self->vertex_array);
    glBindVertexArray(self->vertex_array);
    glGenBuffers(1, &self->vertex_buffer);
    glBindBuffer(GL_ARRAY_BUFFER, self->vertex_buffer);
    add_attribute(0, 4, offsetof(draw_stroke, from)); /* from and to */
    add_attribute(1, 1, offsetof(draw_stroke, width_px));
    add_attribute(2, 4, offsetof(draw_stroke, rgba));
    return gl_check_error("the strokes", err);
}

strokes *strokes_create(error *err)
{
    strokes *self = calloc(1, sizeof *self);
    if (!self) {
        error_set(err, MRT_ERR_MEMORY, "no memory for strokes");
        return NULL;
    }
    if (create_drawing(self, err) == MRT_OK)
        return self;
    strokes_destroy(self);
    return NULL;
}

void strokes_destroy(strokes *self)
{
    if (!self)
        return;
    glDeleteProgram(self->program);
    glDeleteBuffers(1, &self->vertex_buffer);
    glDeleteVertexArrays(1, &self->vertex_array);
    free(self);
}

void strokes_draw(strokes *self, draw_target *target, const draw_stroke *stroke, uint32_t count)
{
    if (count == 0)
        return;
    gl_state before;
    gl_state_enter(&before);
    gl_bind_framebuffer(GL_FRAMEBUFFER, target->framebuffer);
    glViewport(0, 0, (GLsizei)target->width, (GLsizei)target->height);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glUseProgram(self->program);
    glUniform2f(self->target_size, (GLfloat)target->width, (GLfloat)target->height);
    glBindVertexArray(self->vertex_array);
    glBindBuffer(GL_ARRAY_BUFFER, self->vertex_buffer);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *stroke), stroke, GL_STREAM_DRAW);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)count);
    target->stale = true;
    gl_state_leave(&before);
}
