/* Left of the ruler: how drags behave, other takes, and which parts of the face a swipe takes. */
#include "window/timeline_state.h"

#define HEIGHT 18.0f

typedef struct place { /* along a row of the corner */
    ui *on;
    const ui_canvas *canvas;
    float x, y;
} place;

/* A small word that is on or off; true: clicked. */
static bool put_word(place *p, const char *word, float width, bool is_on, bool is_bright,
                     bool *out_over)
{
    float x = p->canvas->where.x + p->canvas->x, y = p->canvas->where.y + p->canvas->y;
    float text = ui_text_width(p->on, UI_STYLE_BODY, word);
    ui_rectangle box = {p->x, p->y, width > 0.0f ? width : text + 12.0f, HEIGHT};
    *out_over = p->canvas->is_hovered && x >= box.x && x < box.x + box.width && y >= box.y &&
                y < box.y + box.height;
    uint32_t ground = is_on && is_bright ? THEME_ACCENT : is_on ? THEME_RAISED : THEME_BAR;
    uint32_t ink = is_on && is_bright ? THEME_STAGE : is_on ? THEME_TEXT : THEME_DIM;
    if (!is_on && *out_over)
        ground = THEME_HOVER;
    ui_draw_box(p->on, box, ground, 4.0f);
    ui_draw_text(p->on, box.x + 0.5f * (box.width - text), box.y, UI_STYLE_BODY, ink, 0.0f, word);
    p->x += box.width + 3.0f;
    return *out_over && p->canvas->is_pressed && p->canvas->button == 0;
}

static void put_switch(panel *self, place *p, const char *word, const char *help, bool *value)
{
    bool is_over;
    if (put_word(p, word, 0.0f, *value, false, &is_over))
        *value = !*value;
    if (is_over)
        self->hint = help;
}

static void put_regions(panel *self, place *p)
{
    static const char *const letter[OWN_REGION_COUNT] = {"M", "J", "B", "L", "E", "C", "N", "H"};
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        bool is_on = (self->regions & 1u << region) != 0, is_over;
        if (put_word(p, letter[region], 18.0f, is_on, true, &is_over) &&
            self->regions != 1u << region)
            self->regions ^= 1u << region;
        if (is_over)
            self->hint = own_part_of((own_region)region)->name;
    }
}

/* Within a frame the ruler's labels do not say which: the corner does, of the left end. */
static void put_name(panel *self, place *p, const take *t)
{
    timeline_code code = timeline_code_now(self);
    char words[TIMECODE_TEXT];
    double frame_ns = 1e9 * code.rate.den / code.rate.num;
    bool is_within = frame_ns >= 0.5 * self->axis.ns_per_point * (double)self->axis.width;
    timeline_code_write(words, &code, self->axis.from_ns);
    if (is_within)
        ui_draw_text(p->on, p->x + 6.0f, p->y, UI_STYLE_NUMBER, THEME_DIM, 0.0f, words);
    else
        ui_draw_text(p->on, p->x + 6.0f, p->y, UI_STYLE_BODY, THEME_DIM,
                     TIMELINE_HEAD_WIDTH - 20.0f, t->name[0] ? t->name : "");
}

void timeline_paint_corner(panel *self, ui *on, const ui_canvas *canvas)
{
    place p = {.on = on, .canvas = canvas, .x = self->rows.x + 4.0f, .y = self->rows.y + 2.0f};
    put_switch(self, &p, "Snap",
               "Drags are drawn to the play head, clips, markers and frames. Alt: not this one.",
               &self->is_snapping);
    put_switch(self, &p, "Follow", "The page turns with the play head.", &self->is_following);
    put_switch(self, &p, "Takes",
               "Other takes of the same slate below: swipe over what is better there.",
               &self->has_comps);
    p.x = self->rows.x + 4.0f;
    p.y += HEIGHT + 2.0f;
    if (self->has_comps)
        put_regions(self, &p);
    else
        put_name(self, &p, studio_take(self->studio));
}
