#include "draw/annotations.h"
#include "base/installed.h"
#include "draw/gl.h"
#include "draw/system_font.h"
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
    SHIFTS = 4,         /* subpixel positions of a glyph */
    FACES = 8           /* our font, then those of the system for what it lacks */
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
    uint32_t face;
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
    FT_Face face[FACES]; /* the first is NULL: no font */
    system_font of[FACES];
    uint32_t face_count;
    FT_F26Dot6 em[FACES]; /* the size that is set; 0: none */
    system_fonts *system;
    char path[INSTALLED_LENGTH]; /* of the first font */
    GLuint program, atlas, vertex_array, vertex_buffer;
    GLint target_size, ink;
    glyph glyphs[GLYPHS_MAX];
    uint32_t glyph_count;
    int shelf_x, shelf_y, shelf_height; /* position of the next bitmap */
    corner corners[QUADS_MAX * 6];
    uint32_t quad_count;
};

static bool add_face(letters *self, system_font font)
{
    FT_Face face;
    if (FT_New_Face(self->library, font.path, (FT_Long)font.index, &face) != 0)
        return false;
    if (!FT_IS_SCALABLE(face) || face->units_per_EM == 0 || face->ascender <= face->descender) {
        FT_Done_Face(face);
        return false;
    }
    self->of[self->face_count] = font;
    self->face[self->face_count++] = face;
    return true;
}

static void open_font(letters *self, const char *const *paths)
{
    for (; *paths; ++paths) {
        if (**paths == '/')
            (void)snprintf(self->path, sizeof self->path, "%s", *paths);
        else if (!installed_data(self->path, *paths))
            continue;
        if (add_face(self, (system_font){self->path, 0}))
            return;
    }
}

/* Returns the face that has the character: ours, or one of the system. Ours where none has it. */
static uint32_t face_with(letters *self, FT_ULong letter)
{
    for (uint32_t i = 0; i < self->face_count; ++i)
        if (FT_Get_Char_Index(self->face[i], letter) != 0)
            return i;
    if (self->face_count == FACES || letter == 0xfffd)
        return 0;
    const system_font font = system_fonts_find(self->system, (uint32_t)letter);
    return font.path && add_face(self, font) ? self->face_count - 1 : 0;
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
    if (self)
        self->system = system_fonts_create();
    if (!self || !self->system || FT_Init_FreeType(&self->library) != 0) {
        error_set(err, MRT_ERR_MEMORY, "no memory for letters");
        if (self)
            system_fonts_destroy(self->system);
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
    for (uint32_t i = 0; i < self->face_count; ++i)
        FT_Done_Face(self->face[i]);
    FT_Done_FreeType(self->library);
    system_fonts_destroy(self->system);
    free(self);
}

const char *letters_font(const letters *self)
{
    return self->of[0].path;
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

/* Sets the size of the line; the fonts take theirs when they are used. Returns the distance in
 * pixels from the top of the line to its baseline. */
static float set_size(letters *self, float size_px, FT_F26Dot6 *out_em)
{
    const FT_Face own = self->face[0];
    float size = size_px >= size_min_px ? size_px : size_min_px; /* also for NaN */
    size = size <= size_max_px ? size : size_max_px;
    float line = (float)(own->ascender - own->descender);
    *out_em = (FT_F26Dot6)lrintf(64.0f * size * (float)own->units_per_EM / line);
    return size * (float)own->ascender / line;
}

/* Loads the glyph of the character in the font that has it. Returns its advance in pixels, or less
 * than 0 if it cannot be drawn. */
static float load_letter(letters *self, FT_ULong letter, FT_F26Dot6 em, uint32_t *out_face,
                         FT_UInt *out_index)
{
    const uint32_t at = face_with(self, letter);
    const FT_Face face = self->face[at];
    if (self->em[at] != em)
        (void)FT_Set_Char_Size(face, em, em, 72, 72);
    self->em[at] = em;
    *out_face = at;
    *out_index = FT_Get_Char_Index(face, letter);
    if (FT_Load_Glyph(face, *out_index, FT_LOAD_NO_BITMAP | FT_LOAD_TARGET_LIGHT) != 0)
        return -1.0f;
    return (float)face->glyph->linearHoriAdvance / 65536.0f;
}

float letters_width(letters *self, const char *words, float size_px)
{
    if (!letters_font(self))
        return 0.0f;
    FT_F26Dot6 em;
    uint32_t face;
    FT_UInt index;
    set_size(self, size_px, &em);
    float width = 0.0f;
    for (int i = 0; *words && i < LETTERS_MAX; ++i) {
        const float advance = load_letter(self, next_letter(&words), em, &face, &index);
        width += advance > 0.0f ? advance : 0.0f;
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
    FT_GlyphSlot slot = self->face[out->face]->glyph;
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

static const glyph *find_glyph(letters *self, uint32_t face, FT_UInt index, FT_F26Dot6 em,
                               int shift)
{
    uint32_t slot = (uint32_t)index * 2654435761u ^ (uint32_t)em * 40503u ^ (uint32_t)shift * 977u ^
                    face * 7919u;
    for (;; ++slot) {
        const glyph *g = &self->glyphs[slot % GLYPHS_MAX];
        if (!g->used)
            break;
        if (g->face == face && g->index == index && g->em == em && g->shift == shift)
            return g;
    }
    if (atlas_is_full(self)) {
        clear_atlas(self);
        slot = 0;
    }
    glyph *made = &self->glyphs[slot % GLYPHS_MAX];
    *made = (glyph){.used = true, .face = face, .index = index, .em = em, .shift = shift};
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
        uint32_t face;
        FT_UInt index;
        const float advance = load_letter(self, next_letter(&words), em, &face, &index);
        if (advance < 0.0f)
            continue;
        float pen = floorf(x);
        int shift = (int)((x - pen) * SHIFTS);
        const glyph *g = find_glyph(self, face, index, em, shift < SHIFTS ? shift : SHIFTS - 1);
        if (g->width > 0)
            add_quad(self, g, pen, baseline);
        x += advance;
    }
}

void letters_draw(letters *self, draw_target *target, const char *words, float x, float y,
                  float size_px, const float rgba[4])
{
    if (!letters_font(self) || !(fabsf(x) < 1e6f) || !(fabsf(y) < 1e6f))
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
