#include "draw/annotations.h"
#include "base/installed.h"
#include "draw/gl.h"
#include "draw/target.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Begins drawing over the face, in pixels of the target. */
static void begin_over(gl_state *before, draw_target *target, GLuint program, GLint target_size)
{
    gl_state_enter(before);
    gl_bind_framebuffer(GL_FRAMEBUFFER, target->framebuffer);
    glViewport(0, 0, (GLsizei)(target->width * target->side),
               (GLsizei)(target->height * target->side));
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glUseProgram(program);
    glUniform2f(target_size, (GLfloat)target->width, (GLfloat)target->height);
    target_change(target);
}

/* ---- words ---- */

enum {
    ATLAS = 1024,       /* side in texels */
    GLYPHS_MAX = 2048,  /* a power of two; at most three quarters are used */
    QUADS_MAX = 256,    /* per draw call */
    LETTERS_MAX = 4096, /* per text; the rest is cut */
    SHIFTS = 4          /* subpixel positions of a glyph */
};
static const float size_min_px = 4.0f, size_max_px = 256.0f;

const char *const letters_fonts[] = {
    "fonts/Inter-Medium.otf", /* installed with the portable folder */
    "/usr/share/fonts/opentype/inter/Inter-Medium.otf",
    "/usr/share/fonts/opentype/inter/Inter-Regular.otf",
    "/usr/share/fonts/inter/Inter-Regular.otf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    NULL};

typedef struct glyph {
    bool used;
    FT_UInt index;
    FT_F26Dot6 em;           /* size */
    int shift;               /* offset to the right, in 1/SHIFTS pixel */
    int left, top;           /* of the bitmap, relative to the pen, upwards */
    int x, y, width, height; /* in the atlas */
} glyph;

typedef struct corner {
    GLfloat position[2], texel[2];
} corner;

struct letters {
    FT_Library library;
    FT_Face face;                /* NULL: no font */
    char path[INSTALLED_LENGTH]; /* of its font; "": none */
    GLuint program, atlas, vertex_array, vertex_buffer;
    GLint target_size, ink;
    glyph glyphs[GLYPHS_MAX];
    uint32_t glyph_count;
    int shelf_x, shelf_y, shelf_height; /* position of the next bitmap */
    corner corners[QUADS_MAX * 6];
    uint32_t quad_count;
};

static void open_font(letters *self, const char *const *paths)
{
    for (; *paths; ++paths) {
        if (**paths == '/')
            (void)snprintf(self->path, sizeof self->path, "%s", *paths);
        else if (!installed_data(self->path, *paths))
            continue;
        if (FT_New_Face(self->library, self->path, 0, &self->face) != 0) {
            self->face = NULL;
            continue;
        }
        if (FT_IS_SCALABLE(self->face) && self->face->units_per_EM > 0 &&
            self->face->ascender > self->face->descender) {
            return;
        }
        FT_Done_Face(self->face);
        self->face = NULL;
    }
    self->path[0] = '\0';
}

static mrt_result create_letter_program(letters *self, error *err)
{
    const gl_source stages[] = {shaders_letters_vert, shaders_letters_frag};
    self->program = gl_program_create(stages, "", err);
    if (!self->program)
        return MRT_ERR_UNSUPPORTED;
    self->target_size = glGetUniformLocation(self->program, "target_size");
    self->ink = glGetUniformLocation(self->program, "ink");
    glGenTextures(1, &self->atlas);
    glBindTexture(GL_TEXTURE_2D, self->atlas);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, ATLAS, ATLAS, 0, GL_RED, GL_UNSIGNED_BYTE, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glGenVertexArrays(1, &self->vertex_array);
    glBindVertexArray(self->vertex_array);
    glGenBuffers(1, &self->vertex_buffer);
    glBindBuffer(GL_ARRAY_BUFFER, self->vertex_buffer);
    glBufferData(GL_ARRAY_BUFFER, sizeof self->corners, NULL, GL_STREAM_DRAW);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(corner),
                          (const void *)offsetof(corner, position));
    glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(corner),
                          (const void *)offsetof(corner, texel));
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    return gl_check_error("the letters", err);
}

letters *letters_create(const char *const *paths, error *err)
{
    letters *self = calloc(1, sizeof *self);
    if (!self || FT_Init_FreeType(&self->library) != 0) {
        error_set(err, MRT_ERR_MEMORY, "no memory for letters");
        free(self);
        return NULL;
    }
    open_font(self, paths);
    if (create_letter_program(self, err) == MRT_OK)
        return self;
    letters_destroy(self);
    return NULL;
}

void letters_destroy(letters *self)
{
    if (!self)
        return;
    glDeleteProgram(self->program);
    glDeleteTextures(1, &self->atlas);
    glDeleteBuffers(1, &self->vertex_buffer);
    glDeleteVertexArrays(1, &self->vertex_array);
    if (self->face)
        FT_Done_Face(self->face);
    FT_Done_FreeType(self->library);
    free(self);
}

const char *letters_font(const letters *self)
{
    return self->path[0] ? self->path : NULL;
}

/* Returns the next code point of UTF-8, or U+FFFD for invalid bytes. Never passes the final 0. */
static FT_ULong next_letter(const char **at)
{
    const unsigned char *c = (const unsigned char *)*at;
    int more = c[0] < 0x80   ? 0
               : c[0] < 0xc2 ? -1
               : c[0] < 0xe0 ? 1
               : c[0] < 0xf0 ? 2
               : c[0] < 0xf5 ? 3
                             : -1;
    FT_ULong letter = more <= 0 ? c[0] : c[0] & (0x3fu >> more);
    int used = 1;
    for (; used <= more && (c[used] & 0xc0) == 0x80; ++used)
        letter = letter << 6 | (c[used] & 0x3fu);
    *at += used;
    if (more < 0 || used <= more)
        return 0xfffd;
    return letter < 0x20 ? ' ' : letter;
}

/* Sets the size of the font. Returns the distance in pixels from the top of the line to its
 * baseline. */
static float set_size(letters *self, float size_px, FT_F26Dot6 *out_em)
{
    float size = size_px >= size_min_px ? size_px : size_min_px; /* also for NaN */
    size = size <= size_max_px ? size : size_max_px;
    float line = (float)(self->face->ascender - self->face->descender);
    *out_em = (FT_F26Dot6)lrintf(64.0f * size * (float)self->face->units_per_EM / line);
    (void)FT_Set_Char_Size(self->face, *out_em, *out_em, 72, 72);
    return size * (float)self->face->ascender / line;
}

static float advance_px(const letters *self)
{
    return (float)self->face->glyph->linearHoriAdvance / 65536.0f;
}

float letters_width(letters *self, const char *words, float size_px)
{
    if (!self->face)
        return 0.0f;
    FT_F26Dot6 em;
    set_size(self, size_px, &em);
    float width = 0.0f;
    for (int i = 0; *words && i < LETTERS_MAX; ++i) {
        FT_UInt index = FT_Get_Char_Index(self->face, next_letter(&words));
        if (FT_Load_Glyph(self->face, index, FT_LOAD_NO_BITMAP | FT_LOAD_TARGET_LIGHT) == 0)
            width += advance_px(self);
    }
    return width;
}

static void flush(letters *self)
{
    if (self->quad_count == 0)
        return;
    glBindBuffer(GL_ARRAY_BUFFER, self->vertex_buffer);
    glBufferData(GL_ARRAY_BUFFER, sizeof self->corners, NULL, GL_STREAM_DRAW);
    glBufferSubData(GL_ARRAY_BUFFER, 0, (GLsizeiptr)(self->quad_count * 6 * sizeof *self->corners),
                    self->corners);
    glDrawArrays(GL_TRIANGLES, 0, (GLsizei)(self->quad_count * 6));
    self->quad_count = 0;
}

/* Removes all glyphs. Draws the waiting quads first, because they use them. */
static void clear_atlas(letters *self)
{
    flush(self);
    memset(self->glyphs, 0, sizeof self->glyphs);
    self->glyph_count = 0;
    self->shelf_x = self->shelf_y = self->shelf_height = 0;
}

static bool allocate_in_atlas(letters *self, int width, int height, glyph *out)
{
    if (width > ATLAS || height > ATLAS)
        return false;
    if (self->shelf_x + width > ATLAS) {
        self->shelf_y += self->shelf_height;
        self->shelf_x = self->shelf_height = 0;
    }
    if (self->shelf_y + height > ATLAS)
        return false;
    out->x = self->shelf_x;
    out->y = self->shelf_y;
    self->shelf_x += width;
    if (height > self->shelf_height)
        self->shelf_height = height;
    return true;
}

/* Adds the bitmap of the loaded glyph to the atlas. */
static void add_bitmap(letters *self, glyph *out)
{
    FT_GlyphSlot slot = self->face->glyph;
    FT_Outline_Translate(&slot->outline, out->shift * (64 / SHIFTS), 0);
    if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL) != 0 ||
        slot->bitmap.pixel_mode != FT_PIXEL_MODE_GRAY || slot->bitmap.pitch < 0)
        return;
    int width = (int)slot->bitmap.width, height = (int)slot->bitmap.rows;
    if (width == 0 || height == 0 || !allocate_in_atlas(self, width, height, out))
        return;
    gl_end_scene();
    glPixelStorei(GL_UNPACK_ROW_LENGTH, slot->bitmap.pitch);
    glTexSubImage2D(GL_TEXTURE_2D, 0, out->x, out->y, width, height, GL_RED, GL_UNSIGNED_BYTE,
                    slot->bitmap.buffer);
    out->width = width;
    out->height = height;
    out->left = slot->bitmap_left;
    out->top = slot->bitmap_top;
}

static bool atlas_is_full(const letters *self)
{
    return self->glyph_count >= GLYPHS_MAX / 4 * 3 ||
           self->shelf_y + self->shelf_height + (int)size_max_px * 2 > ATLAS;
}

static const glyph *find_glyph(letters *self, FT_UInt index, FT_F26Dot6 em, int shift)
{
    uint32_t slot = (uint32_t)index * 2654435761u ^ (uint32_t)em * 40503u ^ (uint32_t)shift * 977u;
    for (;; ++slot) {
        const glyph *g = &self->glyphs[slot % GLYPHS_MAX];
        if (!g->used)
            break;
        if (g->index == index && g->em == em && g->shift == shift)
            return g;
    }
    if (atlas_is_full(self)) {
        clear_atlas(self);
        slot = 0;
    }
    glyph *made = &self->glyphs[slot % GLYPHS_MAX];
    *made = (glyph){.used = true, .index = index, .em = em, .shift = shift};
    ++self->glyph_count;
    add_bitmap(self, made);
    return made;
}

static void add_quad(letters *self, const glyph *g, float pen_x, float baseline)
{
    if (self->quad_count == QUADS_MAX)
        flush(self);
    float left = pen_x + (float)g->left, top = baseline - (float)g->top;
    corner *out = self->corners + (size_t)self->quad_count++ * 6;
    static const int order[6] = {0, 1, 2, 2, 1, 3}; /* bit 0: right, bit 1: low */
    for (int i = 0; i < 6; ++i) {
        float across = (order[i] & 1) ? (float)g->width : 0.0f;
        float down = (order[i] & 2) ? (float)g->height : 0.0f;
        out[i] = (corner){{left + across, top + down}, {(float)g->x + across, (float)g->y + down}};
    }
}

static void write_line(letters *self, const char *words, float x, float y, float size_px)
{
    FT_F26Dot6 em;
    float baseline = roundf(y + set_size(self, size_px, &em));
    for (int i = 0; *words && i < LETTERS_MAX; ++i) {
        FT_UInt index = FT_Get_Char_Index(self->face, next_letter(&words));
        if (FT_Load_Glyph(self->face, index, FT_LOAD_NO_BITMAP | FT_LOAD_TARGET_LIGHT) != 0)
            continue;
        float advance = advance_px(self); /* read before find_glyph draws into the slot */
        float pen = floorf(x);
        int shift = (int)((x - pen) * SHIFTS);
        const glyph *g = find_glyph(self, index, em, shift < SHIFTS ? shift : SHIFTS - 1);
        if (g->width > 0)
            add_quad(self, g, pen, baseline);
        x += advance;
    }
}

void letters_draw(letters *self, draw_target *target, const char *words, float x, float y,
                  float size_px, const float rgba[4])
{
    if (!self->face || !(fabsf(x) < 1e6f) || !(fabsf(y) < 1e6f))
        return;
    gl_state before;
    begin_over(&before, target, self->program, self->target_size);
    glUniform4fv(self->ink, 1, rgba);
    glBindVertexArray(self->vertex_array);
    glBindTexture(GL_TEXTURE_2D, self->atlas);
    write_line(self, words, x, y, size_px);
    flush(self);
    gl_state_leave(&before);
}

/* ---- lines and dots ---- */

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

static mrt_result create_stroke_program(strokes *self, error *err)
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
    if (create_stroke_program(self, err) == MRT_OK)
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
    begin_over(&before, target, self->program, self->target_size);
    glBindVertexArray(self->vertex_array);
    glBindBuffer(GL_ARRAY_BUFFER, self->vertex_buffer);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *stroke), stroke, GL_STREAM_DRAW);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)count);
    gl_state_leave(&before);
}
