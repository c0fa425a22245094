#include "draw/easel.h"

#include "draw/gl.h"
#include "io/export.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool create_drawing(easel *self, const mesh *m, error *err)
{
    if (!gl_is_current()) {
        self->context = draw_context_create(err);
        if (!self->context)
            return false;
    }
    self->target = draw_target_create(self->width, self->height, err);
    self->renderer = self->target ? draw_renderer_create(err) : NULL;
    self->face = self->renderer ? draw_face_create(m, err) : NULL;
    return self->face != NULL;
}

mrt_result easel_init(easel *out, const mesh *m, uint32_t width, uint32_t height, error *err)
{
    mrt_result result = MRT_OK;
    *out = (easel){.width = width, .height = height};
    out->pixels = malloc((size_t)width * height * 4 + 1);
    if (!out->pixels)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a picture of %u by %u pixels", width,
                           height);
    else if (!create_drawing(out, m, err))
        result = MRT_ERR_UNSUPPORTED;
    if (result < 0)
        easel_finish(out);
    return result;
}

void easel_finish(easel *self)
{
    if (!self)
        return;
    draw_face_destroy(self->face);
    draw_renderer_destroy(self->renderer);
    draw_target_destroy(self->target);
    draw_context_destroy(self->context);
    free(self->pixels);
    *self = (easel){0};
}

void easel_words(easel *self, const char *words, float x, float y, float size_px, float width_px,
                 const float rgba[4])
{
    char line[512];
    (void)snprintf(line, sizeof line - 4, "%s", words);
    size_t length = strlen(line);
    while (length > 0 && draw_text_width(self->renderer, line, size_px) > width_px) {
        do
            --length;
        while (length > 0 && ((unsigned char)line[length] & 0xc0) == 0x80); /* whole letters */
        memcpy(line + length, "…", sizeof "…");
    }
    draw_text(self->renderer, self->target, line, x, y, size_px, rgba);
}

mrt_result easel_save(easel *self, const char *path, error *err)
{
    draw_read(self->target, self->pixels);
    return png_write(path, self->pixels, self->width, self->height, err);
}
