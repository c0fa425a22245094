/* A picture behind the face, on the graphics card. */
#include "draw/renderer.h"

#include <stdlib.h>

draw_backdrop *draw_backdrop_create(uint32_t width, uint32_t height, const uint8_t *rgba,
                                    error *err)
{
    draw_backdrop *self = calloc(1, sizeof *self);
    gl_state before;
    if (!self) {
        (void)error_set(err, MRT_ERR_MEMORY, "no memory for the picture behind the face");
        return NULL;
    }
    self->aspect = (float)width / (float)height;
    gl_state_enter(&before);
    glGenTextures(1, &self->texture);
    glBindTexture(GL_TEXTURE_2D, self->texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)width, (GLsizei)height, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, rgba);
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    const mrt_result result = gl_check_error("the picture behind the face", err);
    gl_state_leave(&before);
    if (result >= 0)
        return self;
    draw_backdrop_destroy(self);
    return NULL;
}

void draw_backdrop_destroy(draw_backdrop *self)
{
    if (!self)
        return;
    glDeleteTextures(1, &self->texture);
    free(self);
}
