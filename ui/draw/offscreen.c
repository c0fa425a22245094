#include "draw/offscreen.h"

#include "draw/gl.h"
#include "io/export.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool create_drawing(offscreen *self, const mesh *m, error *err)
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

mrt_result offscreen_init(offscreen *out, const mesh *m, uint32_t width, uint32_t height,
                          error *err)
{
    mrt_result result = MRT_OK;
    *out = (offscreen){.width = width, .height = height};
    out->pixels = malloc((size_t)width * height * 4 + 1);
    if (!out->pixels)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a picture of %u by %u pixels", width,
                           height);
    else if (!create_drawing(out, m, err))
        result = MRT_ERR_UNSUPPORTED;
    if (result < 0)
        offscreen_finish(out);
    return result;
}

void offscreen_finish(offscreen *self)
{
    if (!self)
        return;
    draw_face_destroy(self->face);
    draw_backdrop_destroy(self->backdrop);
    draw_renderer_destroy(self->renderer);
    draw_target_destroy(self->target);
    draw_context_destroy(self->context);
    free(self->pixels);
    *self = (offscreen){0};
}

mrt_result offscreen_set_scene(offscreen *self, const scenery *scene,
                               const scenery_picture *picture, error *err)
{
    draw_light(self->renderer, &scene->light);
    draw_behind(self->renderer, NULL, scene->fit);
    draw_backdrop_destroy(self->backdrop);
    self->backdrop = NULL;
    if (!picture->rgba)
        return MRT_OK;
    self->backdrop = draw_backdrop_create(picture->width, picture->height, picture->rgba, err);
    if (!self->backdrop)
        return MRT_ERR_UNSUPPORTED;
    draw_behind(self->renderer, self->backdrop, scene->fit);
    return MRT_OK;
}

void offscreen_words(offscreen *self, const char *words, float x, float y, float size_px,
                     float width_px, const float rgba[4])
{
    char line[512];
    (void)snprintf(line, sizeof line - 4, "%s", words);
    size_t length = strlen(line);
    while (length > 0 && draw_text_width(self->renderer, line, size_px) > width_px) {
        do
            --length;
        while (length > 0 &&
               ((unsigned char)line[length] & 0xc0) == 0x80); /* keeps whole letters */
        memcpy(line + length, "…", sizeof "…");
    }
    draw_text(self->renderer, self->target, line, x, y, size_px, rgba);
}

float offscreen_line_px(float size_px)
{
    return ceilf(1.3f * size_px);
}

enum { LINE_MAX = 512 };

static size_t letter_bytes(const char *at)
{
    size_t bytes = 1;
    while (((unsigned char)at[bytes] & 0xc0) == 0x80)
        ++bytes;
    return bytes;
}

/* There is no kerning (annotations.h), so widths can be added. */
static float letter_width(offscreen *self, const char *at, size_t bytes, float size_px)
{
    char letter[8];
    (void)snprintf(letter, sizeof letter, "%.*s", (int)bytes, at);
    return draw_text_width(self->renderer, letter, size_px);
}

/* Returns how many bytes of the text fit on one line; at least one letter. */
static size_t line_length(offscreen *self, const char *words, float size_px, float width_px)
{
    size_t length = 0, broken = 0;
    float width = 0.0f;
    while (words[length]) {
        size_t more = letter_bytes(words + length);
        width += letter_width(self, words + length, more, size_px);
        if (length + more >= LINE_MAX || width > width_px)
            break;
        length += more;
        if (words[length] == ' ' || words[length - 1] == ',')
            broken = length;
    }
    if (!words[length])
        return length;
    if (broken > 0)
        return broken;
    return length > 0 ? length : letter_bytes(words);
}

uint32_t offscreen_paragraph(offscreen *self, const char *words, float x, float y, float size_px,
                             float width_px, uint32_t max_lines, const float rgba[4])
{
    uint32_t count = 0;
    while (*words && count < max_lines) {
        char line[LINE_MAX];
        size_t length = line_length(self, words, size_px, width_px);
        bool is_cut = count + 1 == max_lines && words[length];
        (void)snprintf(line, sizeof line, "%.*s%s", (int)length, words, is_cut ? " …" : "");
        if (rgba)
            offscreen_words(self, line, x, y, size_px, width_px, rgba);
        y += offscreen_line_px(size_px);
        ++count;
        words += length;
        while (*words == ' ')
            ++words;
    }
    return count;
}

mrt_result offscreen_save(offscreen *self, const char *path, error *err)
{
    draw_read(self->target, self->pixels);
    return png_write(path, self->pixels, self->width, self->height, err);
}
