#include "draw/sheet.h"

#include "draw/offscreen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- choosing the frames ---- */

enum { TRIED_MAX = 32 }; /* maximum of frames examined in each eighth: more would look the same */

static double distance_from_rest_mm(const mesh *m, const float *position)
{
    double square = 0.0;
    size_t count = (size_t)m->vertex_count * 3;
    for (size_t i = 0; i < count; ++i) {
        double d = (double)position[i] - (double)m->position[i];
        square += d * d;
    }
    return m->vertex_count ? sqrt(square / m->vertex_count) : 0.0;
}

/* first <= frame < end; scratch: vertex_count by 3. */
static mrt_result find_furthest(thumbnail *out, const clip *c, uint32_t first, uint32_t end,
                                float *scratch, error *err)
{
    uint32_t tried = end - first < TRIED_MAX ? end - first : TRIED_MAX;
    *out = (thumbnail){.frame = first, .distance_mm = -1.0};
    for (uint32_t i = 0; i < tried; ++i) {
        uint32_t frame = first + (uint32_t)((uint64_t)(end - first) * i / tried);
        mrt_result result = clip_read(c, frame, scratch, err);
        if (result != MRT_OK)
            return result;
        double distance_mm = distance_from_rest_mm(clip_mesh(c), scratch);
        if (distance_mm > out->distance_mm)
            *out = (thumbnail){.frame = frame, .distance_mm = distance_mm};
    }
    return MRT_OK;
}

mrt_result thumbnails_choose(thumbnail out[THUMBNAILS_MAX], uint32_t *out_count, const clip *c,
                             error *err)
{
    *out_count = 0;
    float *scratch = malloc(((size_t)clip_mesh(c)->vertex_count * 3 + 1) * sizeof *scratch);
    if (!scratch)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a frame of the performance");
    uint64_t frame_count = clip_frame_count(c);
    mrt_result result = MRT_OK;
    for (uint64_t eighth = 0; eighth < THUMBNAILS_MAX && result == MRT_OK; ++eighth) {
        uint32_t first = (uint32_t)(frame_count * eighth / THUMBNAILS_MAX);
        uint32_t end = (uint32_t)(frame_count * (eighth + 1) / THUMBNAILS_MAX);
        if (first < end)
            result = find_furthest(&out[(*out_count)++], c, first, end, scratch, err);
    }
    free(scratch);
    return result;
}

/* ---- the sheet ---- */

/* Pixels of a sheet of SHEET_WIDTH by SHEET_HEIGHT; scaled for other sizes. */
static const float margin_px = 28, title_px = 34, legend_px = 19, small_px = 16, label_px = 20,
                   gap_px = 16;
/* Smaller letters are unreadable: text is left out then. */
static const float least_px = 9;
static const float view_aspect = 200.0f / 326.0f;
/* Shares of the height of the sheet. header_share: limit for the header, above which text is left
 * out. made_share: limit for made_from, above which it is shrunk and then cut. */
static const float header_share = 0.24f, made_share = 0.2f;

static const float ink_strong[4] = {0.92f, 0.93f, 0.95f, 1.0f};
static const float ink_calm[4] = {0.62f, 0.64f, 0.68f, 1.0f};

typedef struct sheet {
    const clip *clip;
    const mesh *mesh;
    thumbnail moment[THUMBNAILS_MAX];
    uint32_t moment_count;
    float *position; /* positions of one frame */
    offscreen offscreen;
    const sheet_about *about;
    sheet_grid grid;
} sheet;

static void sheet_finish(sheet *s)
{
    offscreen_finish(&s->offscreen);
    free(s->position);
}

static mrt_result sheet_init(sheet *s, const clip *c, const sheet_about *about, error *err)
{
    const uint32_t width = about->width ? about->width : SHEET_WIDTH,
                   height = about->height ? about->height : SHEET_HEIGHT;
    *s = (sheet){.clip = c, .mesh = clip_mesh(c), .about = about};

    s->position = malloc(((size_t)s->mesh->vertex_count * 3 + 1) * sizeof *s->position);
    if (!s->position)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the contact sheet");
    mrt_result result = thumbnails_choose(s->moment, &s->moment_count, c, err);
    if (result != MRT_OK)
        return result;
    result = offscreen_init(&s->offscreen, s->mesh, width, height, err);
    if (result != MRT_OK || !about->scene)
        return result;
    static const scenery_picture none = {0};
    return offscreen_set_scene(&s->offscreen, about->scene, about->picture ? about->picture : &none,
                               err);
}

/* Extends the box by the shape, but at most to least and most: one extreme moment must not make all
 * the others tiny. */
static void include_shape(float low[3], float high[3], const float least[3], const float most[3],
                          const float *position, uint32_t vertex_count)
{
    for (uint32_t v = 0; v < vertex_count; ++v)
        for (int axis = 0; axis < 3; ++axis) {
            float value = position[(size_t)v * 3 + (size_t)axis];
            if (value < low[axis])
                low[axis] = value > least[axis] ? value : least[axis];
            if (value > high[axis])
                high[axis] = value < most[axis] ? value : most[axis];
        }
}

/* Computes one framing for all moments. */
static mrt_result frame_all(sheet *s, float aspect, draw_camera *out, error *err)
{
    float low[3], high[3], least[3], most[3];
    mesh_focus(s->mesh, low, high);
    float side = fmaxf(fmaxf(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    for (int axis = 0; axis < 3; ++axis) {
        least[axis] = low[axis] - 0.3f * side;
        most[axis] = high[axis] + 0.3f * side;
    }
    for (uint32_t i = 0; i < s->moment_count && !s->mesh->has_focus; ++i) {
        mrt_result result = clip_read(s->clip, s->moment[i].frame, s->position, err);
        if (result != MRT_OK)
            return result;
        include_shape(low, high, least, most, s->position, s->mesh->vertex_count);
    }
    *out = draw_camera_framing(low, high, aspect);
    return MRT_OK;
}

static draw_camera three_quarter(const draw_camera *front)
{
    draw_camera camera = *front;
    camera.yaw_rad = 0.6109f;   /* 35 degrees */
    camera.pitch_rad = 0.0873f; /* 5 degrees */
    return camera;
}

/* Writes "1.25 s" within the first minute of a short clip, "2:01.25" in longer ones. */
static void format_time(char *out, size_t capacity, const clip *c, uint32_t frame)
{
    double time_s = frame / clip_fps(c), end_s = clip_frame_count(c) / clip_fps(c);
    if (end_s < 60.0) {
        snprintf(out, capacity, "%.2f s", time_s);
        return;
    }
    double hundredths = floor(time_s * 100.0 + 0.5);
    double minutes = floor(hundredths / 6000.0);
    snprintf(out, capacity, "%.0f:%05.2f", minutes, (hundredths - minutes * 6000.0) / 100.0);
}

/* ---- layout ---- */

/* Lays out the pairs of views in this number of columns. */
static void lay_out_columns(sheet_grid *g, uint32_t width, uint32_t height, uint32_t columns)
{
    const float across_px = (float)width - 2 * g->margin;
    const float words = ceilf(1.9f * g->label);
    g->columns = columns;
    g->rows = THUMBNAILS_MAX / columns;
    g->rest_across = g->rows == 1 ? 2 : 1;
    const float views = (float)(2 * columns + g->rest_across), rows = (float)g->rows;
    float across = (across_px - gap_px * g->unit * (float)columns) / views;
    float down = ((float)height - g->top - (g->label > 0 ? 0 : g->margin)) / rows - words;
    float view = floorf(fmaxf(fminf(across, down * view_aspect), 1.0f));
    g->view_width = (uint32_t)view;
    g->view_height = (uint32_t)fmaxf(view / view_aspect, 1.0f);
    g->row_height = g->view_height + (uint32_t)words;
    g->gap = fmaxf(fminf((across_px - views * view) / (float)columns, view), 0.0f);
}

sheet_grid sheet_lay_out(uint32_t width, uint32_t height, float made_px)
{
    sheet_grid g = {.unit = fminf((float)width / SHEET_WIDTH, (float)height / SHEET_HEIGHT)};
    g.margin = ceilf(margin_px * g.unit);
    g.title = fmaxf(title_px * g.unit, least_px);
    g.legend = fmaxf(legend_px * g.unit, least_px);
    g.label = fmaxf(label_px * g.unit, least_px);
    g.header = 0.7f * g.margin + offscreen_line_px(g.title) + offscreen_line_px(g.legend);
    if (g.header > header_share * (float)height)
        g.title = g.legend = g.label = g.header = made_px = 0.0f;
    g.top = ceilf(g.header + made_px + 0.5f * g.margin);
    sheet_grid best = g;
    for (uint32_t columns = 1; columns <= THUMBNAILS_MAX; columns *= 2) {
        lay_out_columns(&g, width, height, columns);
        if (best.view_width < g.view_width)
            best = g;
    }
    return best;
}

void sheet_place(uint32_t out[2], const sheet_grid *of, uint32_t which, uint32_t view)
{
    uint32_t x = (uint32_t)of->margin, y = (uint32_t)of->top;
    if (which == SHEET_REST) {
        out[0] = x + (of->rest_across == 2 ? view * of->view_width : 0);
        out[1] = y + (of->rest_across == 2 ? 0 : view * of->row_height);
        return;
    }
    const float column = (float)(which % of->columns);
    x += of->rest_across * of->view_width + view * of->view_width;
    out[0] = x + (uint32_t)(of->gap + column * ((float)(2 * of->view_width) + of->gap));
    out[1] = y + which / of->columns * of->row_height;
}

/* ---- text at the top ---- */

/* Draws the lines, or only counts them if ink is NULL. */
static uint32_t write_lines(sheet *s, const char *lines, float top, float size_px,
                            uint32_t max_lines, const float *ink)
{
    const float width = (float)s->offscreen.width - 2 * s->grid.margin;
    uint32_t count = 0;
    while (lines && *lines && count < max_lines) {
        char line[4096];
        size_t length = strcspn(lines, "\n");
        (void)snprintf(line, sizeof line, "%.*s", (int)length, lines);
        count += offscreen_paragraph(&s->offscreen, line, s->grid.margin,
                                     top + (float)count * offscreen_line_px(size_px), size_px,
                                     width, max_lines - count, ink);
        lines += length + (lines[length] == '\n');
    }
    return count;
}

/* Shrinks the letters before cutting text. Returns the height of the text. */
static float write_made_from(sheet *s)
{
    const sheet_grid *g = &s->grid;
    const float room = made_share * (float)s->offscreen.height;
    float size_px = fmaxf(small_px * g->unit, least_px);
    uint32_t count = write_lines(s, s->about->made_from, 0, size_px, UINT32_MAX, NULL);
    while (size_px > least_px && (float)count * offscreen_line_px(size_px) > room) {
        size_px = fmaxf(size_px - 1.0f, least_px);
        count = write_lines(s, s->about->made_from, 0, size_px, UINT32_MAX, NULL);
    }
    const uint32_t lines = (uint32_t)(room / offscreen_line_px(size_px));
    count = write_lines(s, s->about->made_from, g->header, size_px, lines, ink_calm);
    return (float)count * offscreen_line_px(size_px);
}

static void describe_moments(char *out, size_t capacity, const clip *c)
{
    uint32_t frame_count = clip_frame_count(c);
    if (frame_count == 0)
        snprintf(out, capacity, "The face at rest: the performance has no frames.");
    else
        snprintf(out, capacity,
                 "%u frame%s at %g per second, %.2f s. Each moment is the frame of one eighth that "
                 "is furthest from rest, with its time and distance (root mean square).",
                 frame_count, frame_count == 1 ? "" : "s", clip_fps(c), frame_count / clip_fps(c));
}

/* Writes the header, and gives the rest of the sheet to the views. */
static void write_header(sheet *s)
{
    char legend[256];
    s->grid = sheet_lay_out(s->offscreen.width, s->offscreen.height, 0.0f);
    const sheet_grid *g = &s->grid;
    const float width = (float)s->offscreen.width - 2 * g->margin;
    if (g->header <= 0.0f || !draw_text_font(s->offscreen.renderer))
        return;
    if (s->about->title)
        offscreen_words(&s->offscreen, s->about->title, g->margin, 0.7f * g->margin, g->title,
                        width, ink_strong);
    describe_moments(legend, sizeof legend, s->clip);
    offscreen_words(&s->offscreen, legend, g->margin,
                    0.7f * g->margin + offscreen_line_px(g->title), g->legend, width, ink_calm);
    s->grid = sheet_lay_out(s->offscreen.width, s->offscreen.height, write_made_from(s));
}

/* ---- the faces ---- */

static void write_label(sheet *s, const char *words, float x, float y, float width,
                        const float ink[4])
{
    const float size = s->grid.label;
    if (size > 0.0f && draw_text_width(s->offscreen.renderer, words, size) <= width)
        draw_text(s->offscreen.renderer, s->offscreen.target, words, x, y, size, ink);
}

/* Skips views that do not fit on a tiny sheet. */
static void draw_view(sheet *s, const draw_camera *camera, uint32_t which, uint32_t view)
{
    const sheet_grid *g = &s->grid;
    uint32_t at[2];
    sheet_place(at, g, which, view);
    if (at[0] + g->view_width <= s->offscreen.width &&
        at[1] + g->view_height <= s->offscreen.height)
        draw_render(s->offscreen.renderer, s->offscreen.target, s->offscreen.face, camera, at[0],
                    at[1], g->view_width, g->view_height);
}

static void draw_pair(sheet *s, const draw_camera *front, uint32_t which)
{
    const draw_camera turned = three_quarter(front);
    draw_view(s, front, which, 0);
    draw_view(s, &turned, which, 1);
}

static float label_top(const sheet *s, uint32_t y)
{
    return (float)(y + s->grid.view_height) + 0.3f * s->grid.label;
}

static void draw_rest(sheet *s, const draw_camera *front)
{
    draw_pair(s, front, SHEET_REST);
    for (uint32_t view = 0; view < 2; ++view) {
        uint32_t at[2];
        sheet_place(at, &s->grid, SHEET_REST, view);
        write_label(s, "at rest", (float)at[0], label_top(s, at[1]), (float)s->grid.view_width,
                    ink_calm);
    }
}

static mrt_result draw_moment(sheet *s, uint32_t i, const draw_camera *front, error *err)
{
    mrt_result result = clip_read(s->clip, s->moment[i].frame, s->position, err);
    if (result != MRT_OK)
        return result;
    draw_face_update(s->offscreen.face, s->position, NULL);
    draw_pair(s, front, i);
    char label[64];
    uint32_t at[2];
    sheet_place(at, &s->grid, i, 0);
    const float size = s->grid.label, room = (float)(2 * s->grid.view_width);
    format_time(label, sizeof label, s->clip, s->moment[i].frame);
    write_label(s, label, (float)at[0], label_top(s, at[1]), room, ink_strong);
    const float used = draw_text_width(s->offscreen.renderer, label, size) + 0.7f * size;
    snprintf(label, sizeof label, "%.1f mm from rest", s->moment[i].distance_mm);
    if (draw_text_width(s->offscreen.renderer, label, size) > room - used)
        snprintf(label, sizeof label, "%.1f mm", s->moment[i].distance_mm);
    write_label(s, label, (float)at[0] + used, label_top(s, at[1]), room - used, ink_calm);
    return MRT_OK;
}

static mrt_result draw_moments(sheet *s, error *err)
{
    draw_camera front;
    mrt_result result = frame_all(s, view_aspect, &front, err);
    if (result != MRT_OK)
        return result;
    draw_face_update(s->offscreen.face, s->mesh->position, NULL); /* shaded like the moments */
    draw_rest(s, &front);
    for (uint32_t i = 0; i < s->moment_count && result == MRT_OK; ++i)
        result = draw_moment(s, i, &front, err);
    return result;
}

/* Draws two large views in the middle. */
static mrt_result draw_rest_alone(sheet *s, error *err)
{
    draw_camera front;
    sheet_grid *g = &s->grid;
    const float room = (float)s->offscreen.height - g->top - 1.9f * g->label - 0.5f * g->margin;
    const float height = fmaxf(room, 1.0f);
    const float width = fminf(0.7f * height, 0.5f * ((float)s->offscreen.width - 2 * g->margin));
    g->rest_across = 2;
    g->view_width = (uint32_t)fmaxf(width, 1.0f);
    g->view_height = (uint32_t)height;
    g->margin = 0.5f * (float)s->offscreen.width - (float)g->view_width;
    mrt_result result = frame_all(s, width / height, &front, err);
    if (result != MRT_OK)
        return result;
    draw_face_update(s->offscreen.face, s->mesh->position, NULL);
    draw_rest(s, &front);
    return MRT_OK;
}

mrt_result sheet_write(const char *path, const clip *c, const sheet_about *about, error *err)
{
    sheet s;
    mrt_result result = sheet_init(&s, c, about, err);
    if (result == MRT_OK) {
        write_header(&s);
        result = s.moment_count ? draw_moments(&s, err) : draw_rest_alone(&s, err);
    }
    if (result == MRT_OK)
        result = offscreen_save(&s.offscreen, path, err);
    if (result == MRT_OK)
        error_set(err, MRT_OK, "%s",
                  draw_text_font(s.offscreen.renderer)
                      ? ""
                      : "the contact sheet has no text, because no font was found. Install "
                        "fonts-inter");
    sheet_finish(&s);
    return result;
}
