#include "window/gui/ui_notes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SURFACES_MAX = 64,
    BOXES_MAX = 16384,
    WORDS_MAX = 8192,
    CONTROLS_MAX = 512,
    TEXT_MAX = 1 << 19
};

typedef struct surface {
    ui_rectangle where;
    bool is_popup;
} surface;
typedef struct box {
    ui_rectangle where;
    uint32_t surface, colour;
} box;

struct ui_notes {
    bool is_on;
    surface surface[SURFACES_MAX];
    uint32_t surface_count;
    box box[BOXES_MAX];
    uint32_t box_count;
    ui_word word[WORDS_MAX];
    uint32_t word_surface[WORDS_MAX];
    uint32_t word_count;
    ui_control control[CONTROLS_MAX];
    uint32_t control_count;
    bool is_of_control; /* the next hint */
    char text[TEXT_MAX];
    size_t text_size;
};

ui_notes *ui_notes_create(void)
{
    return calloc(1, sizeof(ui_notes));
}

void ui_notes_destroy(ui_notes *self)
{
    free(self);
}

void ui_notes_set(ui_notes *self, bool is_noting)
{
    self->is_on = is_noting;
}

bool ui_notes_is_on(const ui_notes *self)
{
    return self->is_on;
}

void ui_notes_begin(ui_notes *self)
{
    self->surface_count = self->box_count = self->word_count = self->control_count = 0;
    self->text_size = 0;
}

uint32_t ui_notes_surface(ui_notes *self, ui_rectangle where, bool is_popup)
{
    if (!self->is_on || self->surface_count == SURFACES_MAX)
        return SURFACES_MAX - 1;
    self->surface[self->surface_count] = (surface){where, is_popup};
    return self->surface_count++;
}

void ui_notes_box(ui_notes *self, uint32_t on, ui_rectangle where, uint32_t colour)
{
    if (self->is_on && self->box_count < BOXES_MAX)
        self->box[self->box_count++] = (box){where, on, colour};
}

void ui_notes_control(ui_notes *self, const char *label)
{
    self->is_of_control = self->is_on && self->control_count < CONTROLS_MAX;
    if (!self->is_of_control)
        return;
    ui_control *control = &self->control[self->control_count++];
    *control = (ui_control){.has_hint = false};
    (void)snprintf(control->label, sizeof control->label, "%s", label);
}

void ui_notes_other(ui_notes *self)
{
    self->is_of_control = false;
}

void ui_notes_hint(ui_notes *self)
{
    if (self->is_of_control)
        self->control[self->control_count - 1].has_hint = true;
}

uint32_t ui_notes_controls(const ui_notes *self, const ui_control **out)
{
    *out = self->control;
    return self->control_count;
}

static uint32_t channel(uint32_t colour, uint32_t shift)
{
    return colour >> shift & 0xffu;
}

/* `over` on opaque `under`. */
static uint32_t blend(uint32_t under, uint32_t over)
{
    uint32_t alpha = channel(over, 0), out = 0xffu;
    for (uint32_t shift = 8; shift < 32; shift += 8) {
        uint32_t mixed =
            (channel(over, shift) * alpha + channel(under, shift) * (255u - alpha)) / 255u;
        out |= mixed << shift;
    }
    return out;
}

/* 0: nobody knows. */
static uint32_t ground_at(const ui_notes *self, uint32_t on, float x, float y)
{
    uint32_t ground = 0;
    for (uint32_t i = 0; i < self->box_count; ++i) {
        const box *b = &self->box[i];
        if (b->surface > on || !ui_rectangle_has(b->where, x, y))
            continue;
        uint32_t alpha = channel(b->colour, 0);
        if (alpha == 0)
            ground = 0;
        else if (alpha == 255)
            ground = b->colour;
        else if (ground)
            ground = blend(ground, b->colour);
    }
    return ground;
}

void ui_notes_word(ui_notes *self, uint32_t on, const ui_word *word)
{
    size_t size = strlen(word->text) + 1;
    if (!self->is_on || self->word_count == WORDS_MAX || self->text_size + size > TEXT_MAX ||
        word->where.width <= 0.0f)
        return;
    ui_word *kept = &self->word[self->word_count];
    *kept = *word;
    kept->text = memcpy(self->text + self->text_size, word->text, size);
    self->text_size += size;
    kept->ground = ground_at(self, on, word->where.x + 0.5f * word->where.width,
                             word->where.y + 0.5f * word->where.height);
    self->word_surface[self->word_count++] = on;
}

/* Whether a popup or an opaque part of a panel above covers the text. */
static bool is_hidden(const ui_notes *self, uint32_t index)
{
    const uint32_t on = self->word_surface[index];
    const ui_rectangle where = self->word[index].where;
    for (uint32_t i = on + 1; i < self->surface_count; ++i)
        if (self->surface[i].is_popup && ui_rectangles_meet(self->surface[i].where, where))
            return true;
    for (uint32_t i = 0; i < self->box_count && !self->surface[on].is_popup; ++i)
        if (self->box[i].surface > on && channel(self->box[i].colour, 0) == 255 &&
            ui_rectangle_is_within(where, self->box[i].where))
            return true;
    return false;
}

void ui_notes_end(ui_notes *self)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < self->word_count; ++i) {
        if (is_hidden(self, i))
            continue;
        self->word[kept] = self->word[i];
        self->word_surface[kept++] = self->word_surface[i];
    }
    self->word_count = kept;
}

uint32_t ui_notes_words(const ui_notes *self, const ui_word **out)
{
    *out = self->word;
    return self->word_count;
}
