#include "window/panels/hand_card.h"
#include "window/gui/hand_figure.h"
#include "window/gui/theme.h"
#include "window/panels/hand_lights.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float hand_least = 96.0f, hand_most = 230.0f; /* width of the hand */
static const float text_least = 190.0f, text_most = 340.0f;
static const float text_share = 0.6f;   /* share of the width; the hand uses the rest */
static const float leader_room = 16.0f; /* between hand and text */
static const float gap_least = 3.0f, row_gap = 0.0f, word_gap = 9.0f;
static const float light_radius = 4.5f, dot_radius = 2.5f;

/* ---- wrapped text ---- */

/* Returns the length of the first row: up to the last space that fits. */
static size_t row_end(const ui *on, ui_style style, const char *text, float width)
{
    char part[256];
    size_t fits = 0;
    if (ui_text_width(on, style, text) <= width)
        return strlen(text);
    for (const char *c = strchr(text, ' '); c; c = strchr(c + 1, ' ')) {
        (void)snprintf(part, sizeof part, "%.*s", (int)(c - text), text);
        if (ui_text_width(on, style, part) > width)
            break;
        fits = (size_t)(c - text);
    }
    return fits > 0 ? fits : strlen(text);
}

static float text_rows(const ui *on, ui_style style, const char *text, float width)
{
    float high = 0.0f;
    while (*text) {
        const size_t end = row_end(on, style, text, width);
        text += end + (text[end] == ' ');
        high += ui_text_height(on, style) + row_gap;
    }
    return high;
}

static float draw_rows(ui *on, float x, float y, ui_style style, uint32_t colour, const char *text,
                       float width)
{
    char row[256];
    while (*text) {
        const size_t end = row_end(on, style, text, width);
        (void)snprintf(row, sizeof row, "%.*s", (int)end, text);
        ui_draw_text(on, x, y, style, colour, width + 1.0f, row);
        text += end + (text[end] == ' ');
        y += ui_text_height(on, style) + row_gap;
    }
    return y;
}

/* ---- colours ---- */

static uint32_t between(uint32_t dark, uint32_t lit, float level)
{
    uint32_t out = 0;
    for (int shift = 0; shift < 32; shift += 8) {
        const float a = (float)(dark >> shift & 255u), b = (float)(lit >> shift & 255u);
        out |= (uint32_t)(a + (b - a) * level + 0.5f) << shift;
    }
    return out;
}

/* ---- layout ---- */

typedef struct column {
    uint32_t line[HAND_LIGHTS_MAX]; /* from top to bottom */
    uint32_t count;
    float high[HAND_LIGHTS_MAX]; /* height of each line of the card, by its index there */
    float x, width;              /* of the text */
    bool is_left;                /* left of the hand */
} column;

typedef struct layout {
    ui_rectangle hand;
    column column[2]; /* the second column may be empty */
    float high;       /* of the higher column, without gaps */
} layout;

/* Returns whether the texts of hand and face fit in one row. */
static bool is_one_row(const ui *on, const hand_card *card, const mrt_card_line *line, float width)
{
    return card->is_dense && ui_text_width(on, UI_STYLE_STRONG, line->hand) + word_gap +
                                     ui_text_width(on, UI_STYLE_BODY, line->face) <=
                                 width;
}

static float block_height(const ui *on, const hand_card *card, const mrt_card_line *line,
                          float width)
{
    if (is_one_row(on, card, line, width))
        return ui_text_height(on, UI_STYLE_STRONG) + row_gap;
    return text_rows(on, UI_STYLE_STRONG, line->hand, width) +
           text_rows(on, UI_STYLE_BODY, line->face, width);
}

static void measure_column(column *of, const ui *on, const hand_card *card)
{
    for (uint32_t i = 0; i < of->count; ++i)
        of->high[of->line[i]] = block_height(on, card, &card->line[of->line[i]], of->width);
}

static float column_height(const column *of)
{
    float high = 0.0f;
    for (uint32_t i = 0; i < of->count; ++i)
        high += of->high[of->line[i]];
    return high;
}

static uint32_t joint_of(const mrt_card_line *line)
{
    return line->joint < MRT_JOINTS ? line->joint : 0;
}

/* Computes the y of the top of each line. */
static void find_tops(float out_y[HAND_LIGHTS_MAX], ui_rectangle where, const column *of)
{
    const float room = where.height - column_height(of);
    const float gap = fmaxf(fminf(room / (float)(of->count > 0 ? of->count : 1), 18.0f), 0.0f);
    float y = where.y + 0.5f * fmaxf(room - gap * (float)of->count, 0.0f);
    for (uint32_t i = 0; i < of->count; ++i) {
        out_y[i] = y;
        y += of->high[of->line[i]] + gap;
    }
}

/* ---- leaders: from the first row of a line's text over a knee to its joint ---- */

typedef struct leader {
    float x, y, knee_x, joint[2];
} leader;

static leader leader_of(const ui *on, const hand_card *card, const column *of, uint32_t i,
                        float top_y, float xy[MRT_JOINTS][2])
{
    const float *joint = xy[joint_of(&card->line[of->line[i]])];
    const float x = of->is_left ? of->x + of->width + 2.0f : of->x - 3.0f;
    return (leader){x,
                    top_y + 0.5f * ui_text_height(on, UI_STYLE_STRONG),
                    x + (of->is_left ? 6.0f : -6.0f),
                    {joint[0], joint[1]}};
}

/* Returns twice the signed area of the triangle. The sign is the side of the line a, b on which the
 * point is. */
static float side_of(const float a[2], const float b[2], const float point[2])
{
    return (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
}

/* Returns whether two leaders cross. Leaders that end at the same joint do not. */
static bool do_cross(const leader *a, const leader *b)
{
    const float from_a[2] = {a->knee_x, a->y}, from_b[2] = {b->knee_x, b->y};
    return side_of(from_a, a->joint, from_b) * side_of(from_a, a->joint, b->joint) < 0.0f &&
           side_of(from_b, b->joint, from_a) * side_of(from_b, b->joint, a->joint) < 0.0f;
}

/* Swaps two lines whose leaders cross. Each swap shortens the sum of both leaders, so the loop
 * ends. The number of passes is limited because lines differ in height. */
static void uncross(column *of, const ui *on, const hand_card *card, ui_rectangle where,
                    float xy[MRT_JOINTS][2])
{
    bool has_swapped = true;
    for (uint32_t pass = 0; pass < 4 * HAND_LIGHTS_MAX && has_swapped; ++pass) {
        has_swapped = false;
        for (uint32_t i = 0; i < of->count; ++i)
            for (uint32_t k = 0; k < i; ++k) {
                float top_y[HAND_LIGHTS_MAX];
                find_tops(top_y, where, of);
                const leader a = leader_of(on, card, of, i, top_y[i], xy),
                             b = leader_of(on, card, of, k, top_y[k], xy);
                if (!do_cross(&a, &b))
                    continue;
                const uint32_t line = of->line[i];
                of->line[i] = of->line[k];
                of->line[k] = line;
                has_swapped = true;
            }
    }
}

/* Sorts the lines of a column by the height of their joints. Lines of one joint keep the order of
 * the card. */
static void sort_column(column *of, const hand_card *card, float xy[MRT_JOINTS][2])
{
    for (uint32_t i = 1; i < of->count; ++i) {
        const uint32_t line = of->line[i];
        const float y = xy[joint_of(&card->line[line])][1];
        uint32_t at = i;
        for (; at > 0 && xy[joint_of(&card->line[of->line[at - 1]])][1] > y; --at)
            of->line[at] = of->line[at - 1];
        of->line[at] = line;
    }
}

/* Puts the half of the lines with the leftmost joints in the left column. */
static void split(layout *out, const hand_card *card, uint32_t count, float xy[MRT_JOINTS][2])
{
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t before = 0;
        for (uint32_t k = 0; k < count; ++k) {
            const float a = xy[joint_of(&card->line[k])][0], b = xy[joint_of(&card->line[i])][0];
            before += a < b || (!(a > b) && k < i);
        }
        column *to = &out->column[before < count / 2 ? 1 : 0];
        to->line[to->count++] = i;
    }
}

/* Returns false if the hand does not fit. */
static bool lay_out(layout *out, const ui *on, const hand_card *card, ui_rectangle where)
{
    const uint32_t count = card->count < HAND_LIGHTS_MAX ? card->count : HAND_LIGHTS_MAX;
    const float both = 2.0f * (text_least + leader_room) + hand_most * 0.7f;
    const uint32_t columns = where.width >= both ? 2 : 1;
    float xy[MRT_JOINTS][2];
    memset(out, 0, sizeof *out);
    const float sides = (float)columns;
    const float room = where.width / sides - leader_room;
    const float text = fminf(fmaxf(text_share * room, text_least), text_most);
    if (where.width - sides * (text + leader_room) < hand_least)
        return false;
    const float hand = fminf(where.width - sides * (text + leader_room), hand_most);
    const float used = hand + sides * (text + leader_room);
    const float left = where.x + 0.5f * (where.width - used);
    out->hand = (ui_rectangle){left + (columns == 2 ? text + leader_room : 0.0f), where.y, hand,
                               where.height};
    out->column[0] = (column){.x = out->hand.x + hand + leader_room, .width = text};
    out->column[1] = (column){.x = left, .width = text, .is_left = true};
    hand_figure_joints(out->hand, card->skeleton, card->rest_rad, xy);
    if (columns == 2)
        split(out, card, count, xy);
    else
        for (uint32_t i = 0; i < count; ++i)
            out->column[0].line[out->column[0].count++] = i;
    for (int k = 0; k < 2; ++k) {
        sort_column(&out->column[k], card, xy);
        measure_column(&out->column[k], on, card);
        uncross(&out->column[k], on, card, where, xy);
        out->high = fmaxf(out->high, column_height(&out->column[k]));
    }
    return true;
}

float hand_card_height(const ui *on, const hand_card *card, float width)
{
    layout at;
    if (!lay_out(&at, on, card, (ui_rectangle){0.0f, 0.0f, width, 400.0f}))
        return 0.0f;
    const uint32_t most =
        at.column[0].count > at.column[1].count ? at.column[0].count : at.column[1].count;
    return at.high + gap_least * (float)most;
}

/* ---- drawing ---- */

/* Returns the y of its end. */
static float draw_block(ui *on, const hand_card *card, uint32_t index, float x, float y,
                        float width)
{
    const mrt_card_line *line = &card->line[index];
    const uint32_t strong = between(THEME_TEXT, THEME_ACCENT, card->level[index]);
    const uint32_t body = between(THEME_DIM, THEME_ACCENT, card->level[index]);
    const bool is_short = is_one_row(on, card, line, width);
    const float behind = ui_text_width(on, UI_STYLE_STRONG, line->hand) + word_gap;
    const float second = draw_rows(on, x, y, UI_STYLE_STRONG, strong, line->hand, width);
    return is_short ? draw_rows(on, x + behind, y, UI_STYLE_BODY, body, line->face, width - behind)
                    : draw_rows(on, x, second, UI_STYLE_BODY, body, line->face, width);
}

static void draw_leader(ui *on, const leader *of, float level)
{
    const uint32_t ink = between(THEME_OFF, THEME_ACCENT, level);
    const float xy[6] = {of->x, of->y, of->knee_x, of->y, of->joint[0], of->joint[1]};
    ui_draw_lines(on, xy, 3, ink, 1.0f + level);
    ui_draw_disc(on, of->joint[0], of->joint[1], dot_radius + 3.0f * level, ink);
}

static void draw_column(ui *on, ui_rectangle where, const hand_card *card, const column *of,
                        float xy[MRT_JOINTS][2])
{
    float top_y[HAND_LIGHTS_MAX];
    find_tops(top_y, where, of);
    for (uint32_t i = 0; i < of->count; ++i) {
        const mrt_card_line *line = &card->line[of->line[i]];
        const leader to_joint = leader_of(on, card, of, i, top_y[i], xy);
        float x = of->x;
        if (of->is_left) { /* close to the hand */
            const float strong = ui_text_width(on, UI_STYLE_STRONG, line->hand);
            const float body = ui_text_width(on, UI_STYLE_BODY, line->face);
            const float own = is_one_row(on, card, line, of->width) ? strong + word_gap + body
                                                                    : fmaxf(strong, body);
            x += fmaxf(of->width - own, 0.0f);
        }
        (void)draw_block(on, card, of->line[i], x, top_y[i], of->x + of->width - x);
        draw_leader(on, &to_joint, card->level[of->line[i]]);
    }
}

uint32_t hand_card_crossings(const ui *on, ui_rectangle where, const hand_card *card)
{
    layout at;
    leader all[2 * HAND_LIGHTS_MAX];
    float xy[MRT_JOINTS][2];
    uint32_t count = 0, out = 0;
    if (!lay_out(&at, on, card, where))
        return 0;
    hand_figure_joints(at.hand, card->skeleton, card->angle_rad, xy);
    for (int k = 0; k < 2; ++k) {
        float top_y[HAND_LIGHTS_MAX];
        find_tops(top_y, where, &at.column[k]);
        for (uint32_t i = 0; i < at.column[k].count; ++i)
            all[count++] = leader_of(on, card, &at.column[k], i, top_y[i], xy);
    }
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t k = 0; k < i; ++k)
            out += do_cross(&all[i], &all[k]);
    return out;
}

void hand_card_draw(ui *on, ui_rectangle where, const hand_card *card)
{
    layout at;
    float xy[MRT_JOINTS][2];
    if (!lay_out(&at, on, card, where))
        return;
    hand_figure_draw_still(on, at.hand, card->skeleton, card->angle_rad, card->colour);
    hand_figure_joints(at.hand, card->skeleton, card->angle_rad, xy);
    for (int k = 0; k < 2; ++k)
        draw_column(on, where, card, &at.column[k], xy);
}

void hand_card_list(ui *on, const hand_card *card)
{
    for (uint32_t i = 0; i < card->count && i < HAND_LIGHTS_MAX; ++i) {
        const mrt_card_line *line = &card->line[i];
        const float width = ui_available_width(on) - 22.0f;
        char id[24];
        ui_canvas at;
        (void)snprintf(id, sizeof id, "card%u", i);
        ui_canvas_begin(on, id, 0.0f, block_height(on, card, line, width) + gap_least, &at);
        ui_draw_disc(on, at.where.x + 7.0f,
                     at.where.y + 0.5f * ui_text_height(on, UI_STYLE_STRONG) + 1.0f, light_radius,
                     between(THEME_RAISED, THEME_ACCENT, card->level[i]));
        (void)draw_block(on, card, i, at.where.x + 20.0f, at.where.y, width);
        ui_canvas_end(on);
    }
}
