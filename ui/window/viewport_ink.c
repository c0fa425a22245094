#include "window/viewport_inside.h"
#include "window/theme.h"
#include "window/viewport_labels.h"

#include <math.h>
#include <stdio.h>

static const float margin = 12.0f, dot_radius = 5.0f;
static const uint32_t plate = 0x101113c8u; /* below words that lie on the face */

static void write_on_plate(ui *on, float x, float y, uint32_t colour, const char *text)
{
    float width = ui_text_width(on, UI_STYLE_BODY, text);
    float height = ui_text_height(on, UI_STYLE_BODY);
    ui_draw_box(on, (ui_rectangle){x - 4.0f, y - 1.0f, width + 8.0f, height + 2.0f}, plate, 3.0f);
    ui_draw_text(on, x, y, UI_STYLE_BODY, colour, 0.0f, text);
}

/* ---- contacts ---- */

static const char *name_of(const viewport *self, uint32_t contact)
{
    return studio_view(self->of)->about->contacts[contact].name;
}

static bool add_label(const viewport *self, const ui *on, uint32_t contact, viewport_label *out)
{
    float at[3];
    viewport_contact_at(self, contact, at);
    if (!viewport_contact_is_seen(self, contact) || !viewport_to_points(self, at, &out->x, &out->y))
        return false;
    out->width = ui_text_width(on, UI_STYLE_BODY, name_of(self, contact)) + 8.0f;
    out->height = ui_text_height(on, UI_STYLE_BODY) + 2.0f;
    return true;
}

/* The name under the pointer comes first: it has room whatever the others want. */
static void ink_contacts(const viewport *self, ui *on)
{
    const live_view *view = studio_view(self->of);
    bool shows = studio_looks_of(self->of)->shows_contacts;
    if (!self->has_face || !self->face.rig || !view->about || (!shows && !self->contact))
        return;
    viewport_label label[VIEWPORT_LABELS_MAX];
    uint32_t contact[VIEWPORT_LABELS_MAX], count = 0;
    if (self->contact && add_label(self, on, self->contact - 1, &label[count]))
        contact[count++] = self->contact - 1;
    uint32_t all = view->contact_count < self->face.rig->contact_count
                       ? view->contact_count
                       : self->face.rig->contact_count;
    for (uint32_t i = 0; shows && i < all && count < VIEWPORT_LABELS_MAX; ++i)
        if (i + 1 != self->contact && add_label(self, on, i, &label[count]))
            contact[count++] = i;
    const ui_rectangle within = {4.0f, 4.0f, self->where.width - 8.0f, self->where.height - 8.0f};
    viewport_labels_place(label, count, within, dot_radius);
    for (uint32_t i = 0; i < count; ++i) {
        bool is_pointed_at = contact[i] + 1 == self->contact;
        if (label[i].is_placed)
            write_on_plate(on, self->where.x + label[i].at_x + 4.0f,
                           self->where.y + label[i].at_y + 1.0f,
                           is_pointed_at ? THEME_ACCENT : THEME_DIM, name_of(self, contact[i]));
        if (is_pointed_at)
            ui_draw_ring(on, self->where.x + label[i].x, self->where.y + label[i].y, 7.5f,
                         THEME_ACCENT, 2.0f);
    }
}

/* ---- the pointer on the skin ---- */

enum { RING_POINTS = 48 };

static void smooth_normal(const viewport *self, float out[3])
{
    float squared = 0.0f;
    for (int i = 0; i < 3; ++i) {
        out[i] = 0.0f;
        for (int corner = 0; corner < 3; ++corner)
            out[i] += self->hit.share[corner] *
                      self->normal[(size_t)self->hit.vertex[corner] * 3 + (size_t)i];
        squared += out[i] * out[i];
    }
    for (int i = 0; i < 3; ++i)
        out[i] = squared > 1e-8f ? out[i] / sqrtf(squared) : self->hit.normal[i];
}

/* A circle on the skin, in the plane that touches it. */
static void ink_ring(const viewport *self, ui *on, float radius_mm, uint32_t colour)
{
    float normal[3], side[3], other[3], xy[2 * (RING_POINTS + 1)], squared = 0.0f;
    smooth_normal(self, normal);
    int least = fabsf(normal[0]) < fabsf(normal[1]) ? 0 : 1;
    for (int i = 0; i < 3; ++i) {
        side[i] = (i == least ? 1.0f : 0.0f) - normal[least] * normal[i];
        squared += side[i] * side[i];
    }
    for (int i = 0; i < 3; ++i)
        side[i] /= sqrtf(squared);
    for (int i = 0; i < 3; ++i)
        other[i] =
            normal[(i + 1) % 3] * side[(i + 2) % 3] - normal[(i + 2) % 3] * side[(i + 1) % 3];
    for (int p = 0; p <= RING_POINTS; ++p) {
        float around = 6.2831853f * (float)p / RING_POINTS, at[3], x, y;
        for (int i = 0; i < 3; ++i)
            at[i] =
                self->hit.at[i] + radius_mm * (cosf(around) * side[i] + sinf(around) * other[i]);
        if (!viewport_to_points(self, at, &x, &y))
            return;
        xy[2 * p] = self->where.x + x;
        xy[2 * p + 1] = self->where.y + y;
    }
    ui_draw_lines(on, xy, RING_POINTS + 1, colour, 1.5f);
}

/* Beside the pointer, and within the picture. */
static void write_beside(const viewport *self, ui *on, const float at[3], const char *text)
{
    float x, y;
    if (!viewport_to_points(self, at, &x, &y))
        return;
    float width = ui_text_width(on, UI_STYLE_BODY, text);
    float height = ui_text_height(on, UI_STYLE_BODY);
    x = fminf(x + 18.0f, self->where.width - width - 8.0f);
    y = fminf(y + 18.0f, self->where.height - height - 8.0f);
    write_on_plate(on, self->where.x + fmaxf(x, 8.0f), self->where.y + fmaxf(y, 8.0f), THEME_TEXT,
                   text);
}

/* At the picture's upper edge, away from what the pointer is at. */
static void write_at_edge(const viewport *self, ui *on, const char *text)
{
    float width = ui_text_width(on, UI_STYLE_BODY, text);
    write_on_plate(on, self->where.x + 0.5f * (self->where.width - width), self->where.y + 12.0f,
                   THEME_DIM, text);
}

static void ink_hold(const viewport *self, ui *on)
{
    float x, y;
    if (!viewport_to_points(self, self->grip.at, &x, &y))
        return;
    ui_draw_ring(on, self->where.x + x, self->where.y + y, 7.5f, THEME_ACCENT, 2.0f);
    write_at_edge(self, on,
                  self->grip.how == POINTER_KNEADS ? "Clay: it stays. Wheel: nearer, further"
                                                   : "Shift: it stays. Wheel: nearer, further");
}

static void ink_pointer(const viewport *self, ui *on)
{
    if (self->drag == VIEWPORT_HOLDS) {
        ink_hold(self, on);
        return;
    }
    bool is_busy = self->drag == VIEWPORT_ORBITS || self->drag == VIEWPORT_PANS;
    if (is_busy || !self->is_over)
        return;
    if (self->is_on_face && self->use == VIEWPORT_PAINTS)
        ink_ring(self, on, self->brush_mm, THEME_ACCENT);
    if (self->use != VIEWPORT_PERFORMS || !self->is_on_face)
        return;
    if (self->is_off_stage) {
        write_at_edge(self, on, "A take is shown. L: back to the live hands");
        return;
    }
    double half = viewport_half_radius(studio_view(self->of)->solver.kernel);
    if (!self->contact || self->radius_shown_s > 0.0)
        ink_ring(self, on, (float)(half * viewport_radius_mm(self)), 0xd9a441a0u);
    if (self->radius_shown_s > 0.0) {
        char text[64];
        snprintf(text, sizeof text, "Reach %.0f mm", viewport_radius_mm(self));
        write_beside(self, on, self->hit.at, text);
    }
}

static void set_cursor(const viewport *self, ui *on)
{
    if (self->drag == VIEWPORT_ORBITS || self->drag == VIEWPORT_PANS)
        ui_set_cursor(on, UI_CURSOR_MOVE);
    else if (self->is_over && self->use != VIEWPORT_PERFORMS && self->is_on_face)
        ui_set_cursor(on, UI_CURSOR_CROSS);
    else if (self->is_over && (self->is_on_face || self->contact) && !self->is_off_stage)
        ui_set_cursor(on, UI_CURSOR_HAND);
}

/* ---- what the colours mean ---- */

static float hand_keys_height(const ui *on)
{
    return 2.0f * (ui_text_height(on, UI_STYLE_BODY) + 4.0f) + 18.0f;
}

static uint32_t mixed(uint32_t a, uint32_t b, float share)
{
    uint32_t out = 0xffu;
    for (int shift = 8; shift <= 24; shift += 8) {
        float from = (float)(a >> shift & 255u), to = (float)(b >> shift & 255u);
        out |= (uint32_t)lrintf(from + share * (to - from)) << shift;
    }
    return out;
}

static void ink_scale(ui *on, float x, float y, float width, const viewport_heat_legend *legend)
{
    enum { PARTS = 40 };
    for (int i = 0; i < PARTS; ++i) {
        float place = ((float)i + 0.5f) / PARTS * (VIEWPORT_HEAT_STOPS - 1);
        int low = (int)place;
        ui_rectangle part = {x + width * (float)i / PARTS, y, width / PARTS + 0.5f, 8.0f};
        ui_draw_box(on, part, mixed(legend->stop[low], legend->stop[low + 1], place - (float)low),
                    0.0f);
    }
}

static void ink_scale_words(ui *on, float x, float y, float width,
                            const viewport_heat_legend *legend)
{
    ui_draw_text(on, x, y, UI_STYLE_BODY, THEME_DIM, 0.0f, legend->low);
    float high = ui_text_width(on, UI_STYLE_BODY, legend->high);
    ui_draw_text(on, x + width - high, y, UI_STYLE_BODY, THEME_DIM, 0.0f, legend->high);
    if (!legend->mid)
        return;
    float mid = ui_text_width(on, UI_STYLE_BODY, legend->mid);
    ui_draw_text(on, x + 0.5f * (width - mid), y, UI_STYLE_BODY, THEME_DIM, 0.0f, legend->mid);
}

static void ink_bones(const viewport *self, ui *on, float x, float y, uint32_t count)
{
    float row = ui_text_height(on, UI_STYLE_BODY) + 3.0f;
    for (uint32_t bone = 0; bone < count; ++bone) {
        const char *name;
        uint32_t colour = viewport_heat_bone(self->heat, bone, &name);
        float top = y + row * (float)bone;
        ui_draw_box(on, (ui_rectangle){x, top + 3.0f, 12.0f, 12.0f}, colour, 2.0f);
        ui_draw_text(on, x + 20.0f, top, UI_STYLE_BODY, THEME_TEXT, 0.0f, name);
    }
}

static void ink_heat(const viewport *self, ui *on)
{
    if (!self->heat || self->heat_shown == STUDIO_HEAT_NONE || self->has_paint)
        return;
    viewport_heat_legend legend;
    viewport_heat_legend_of(self->heat, self->heat_shown, &legend);
    float line = ui_text_height(on, UI_STYLE_BODY) + 3.0f;
    float wide = legend.bone_count ? 150.0f : 250.0f;
    bool has_depth = self->heat_shown == STUDIO_HEAT_PENETRATION;
    float high = 16.0f + line * (legend.bone_count ? (float)(1 + legend.bone_count)
                                 : has_depth       ? 3.0f
                                                   : 2.0f);
    high += legend.bone_count ? 4.0f : 16.0f;
    float below = virtual_hand_has_keys(self->hand) ? hand_keys_height(on) : 0.0f;
    ui_rectangle box = {self->where.x + margin, self->where.y + margin + below, wide, high};
    ui_draw_box(on, box, plate, 4.0f);
    float x = box.x + 10.0f, y = box.y + 8.0f, inner = wide - 20.0f;
    ui_draw_text(on, x, y, UI_STYLE_BODY, THEME_TEXT, inner, legend.title);
    y += line + 3.0f;
    if (legend.bone_count) {
        ink_bones(self, on, x, y, legend.bone_count);
        return;
    }
    ink_scale(on, x, y, inner, &legend);
    ink_scale_words(on, x, y + 12.0f, inner, &legend);
    if (!has_depth)
        return;
    char text[80];
    snprintf(text, sizeof text, "Held back now: %.1f mm", studio_view(self->of)->penetration_mm);
    ui_draw_text(on, x, y + 12.0f + line, UI_STYLE_BODY, THEME_TEXT, inner, text);
}

/* ---- which key moves which finger ---- */

typedef struct key_cell {
    const char *name, *down, *up; /* up NULL: one key */
    int finger;                   /* 0 thumb .. 4 little; -1: none */
} key_cell;
static const key_cell cells[] = {{"Thumb", "Space", "B", 0},    {"Index", "J", "U", 1},
                                 {"Middle", "K", "I", 2},       {"Ring", "L", "O", 3},
                                 {"Little", ";", "P", 4},       {"Spread", "N", "M", -1},
                                 {"Wrist", "arrows", NULL, -1}, {"Other hand", "Shift+Y", NULL, -1},
                                 {"End", "Esc", NULL, -1}};
enum { CELLS = sizeof cells / sizeof *cells };
static const float cell_gap = 16.0f, cap_gap = 4.0f;

static float cap_width(const ui *on, const char *key)
{
    return fmaxf(ui_text_width(on, UI_STYLE_BODY, key) + 12.0f, 24.0f);
}

static float cell_width(const ui *on, const key_cell *cell)
{
    float caps = cap_width(on, cell->down);
    if (cell->up)
        caps += cap_gap + cap_width(on, cell->up);
    return fmaxf(caps, ui_text_width(on, UI_STYLE_BODY, cell->name));
}

static void ink_cap(ui *on, float x, float y, const char *key, bool is_down)
{
    float width = cap_width(on, key), height = ui_text_height(on, UI_STYLE_BODY) + 4.0f;
    float words = ui_text_width(on, UI_STYLE_BODY, key);
    ui_draw_box(on, (ui_rectangle){x, y, width, height}, is_down ? THEME_ACCENT : THEME_RAISED,
                3.0f);
    ui_draw_text(on, x + 0.5f * (width - words), y + 2.0f, UI_STYLE_BODY,
                 is_down ? THEME_STAGE : THEME_TEXT, 0.0f, key);
}

static void ink_cell(const viewport *self, ui *on, float x, float y, const key_cell *cell)
{
    float wish = cell->finger < 0 ? 0.0f : virtual_hand_fingers(self->hand)[cell->finger];
    float line = ui_text_height(on, UI_STYLE_BODY) + 4.0f;
    ui_draw_text(on, x, y, UI_STYLE_BODY, THEME_DIM, 0.0f, cell->name);
    ink_cap(on, x, y + line, cell->down, wish > 0.1f);
    if (cell->up)
        ink_cap(on, x + cap_width(on, cell->down) + cap_gap, y + line, cell->up, wish < -0.1f);
}

static void ink_hand_keys(const viewport *self, ui *on)
{
    if (!virtual_hand_has_keys(self->hand))
        return;
    bool is_left = virtual_hand_side(self->hand) == MRT_LEFT;
    const char *title = is_left ? "Left hand" : "Right hand";
    float line = ui_text_height(on, UI_STYLE_BODY) + 4.0f;
    float wide = 24.0f + ui_text_width(on, UI_STYLE_BODY, title), high = hand_keys_height(on);
    for (int i = 0; i < CELLS; ++i)
        wide += cell_gap + cell_width(on, &cells[i]);
    ui_rectangle box = {self->where.x + 0.5f * (self->where.width - wide), self->where.y + 8.0f,
                        wide, high};
    ui_draw_box(on, box, plate | 0x20u, 5.0f);
    float x = box.x + 12.0f, y = box.y + 8.0f;
    ui_draw_text(on, x, y + 0.5f * line, UI_STYLE_BODY, is_left ? THEME_LEFT : THEME_RIGHT, 0.0f,
                 title);
    x += ui_text_width(on, UI_STYLE_BODY, title);
    for (int i = 0; i < CELLS; ++i) {
        x += cell_gap;
        ink_cell(self, on, x, y, &cells[i]);
        x += cell_width(on, &cells[i]);
    }
}

void viewport_ink(const viewport *self, ui *on)
{
    ink_contacts(self, on);
    ink_pointer(self, on);
    set_cursor(self, on);
    ink_heat(self, on);
    ink_hand_keys(self, on);
}
