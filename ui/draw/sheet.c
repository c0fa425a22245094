#include "draw/sheet.h"
#include "draw/draw.h"
#include "draw/gl.h"
#include "draw/moments.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { /* pixels */
       MARGIN = 28,
       TITLE_TOP = 20,
       TITLE_SIZE = 34,
       LEGEND_TOP = 60,
       LEGEND_SIZE = 19,
       GRID_TOP = 98,
       GAP = 16, /* between moments */
       VIEW_WIDTH = 200,
       VIEW_HEIGHT = 326,
       LABEL_SIZE = 20,
       ROW_HEIGHT = VIEW_HEIGHT + LABEL_SIZE + 24,
       COLUMNS = 4,
       REST_WIDTH = 480, /* of a sheet without moments */
       REST_HEIGHT = 690
};
static const float ink_strong[4] = {0.92f, 0.93f, 0.95f, 1.0f};
static const float ink_calm[4] = {0.62f, 0.64f, 0.68f, 1.0f};

typedef struct sheet {
    const clip *clip;
    const mesh *mesh;
    moment moment[MOMENTS_MAX];
    uint32_t moment_count;
    float *position; /* of one frame */
    uint8_t *pixels;
    draw_context *context; /* NULL: somebody else's is in use */
    draw_target *target;
    draw_renderer *renderer;
    draw_face *face;
} sheet;

static void sheet_finish(sheet *s)
{
    draw_face_destroy(s->face);
    draw_renderer_destroy(s->renderer);
    draw_target_destroy(s->target);
    draw_context_destroy(s->context);
    free(s->position);
    free(s->pixels);
}

static bool create_drawing(sheet *s, error *err)
{
    if (!gl_is_current()) {
        s->context = draw_context_create(err);
        if (!s->context)
            return false;
    }
    s->target = draw_target_create(SHEET_WIDTH, SHEET_HEIGHT, err);
    s->renderer = s->target ? draw_renderer_create(err) : NULL;
    s->face = s->renderer ? draw_face_create(s->mesh, err) : NULL;
    return s->face != NULL;
}

static mrt_result sheet_init(sheet *s, const clip *c, error *err)
{
    *s = (sheet){.clip = c, .mesh = clip_mesh(c)};
    s->position = malloc(((size_t)s->mesh->vertex_count * 3 + 1) * sizeof *s->position);
    s->pixels = malloc((size_t)SHEET_WIDTH * SHEET_HEIGHT * 4);
    if (!s->position || !s->pixels)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the contact sheet");
    mrt_result result = moments_choose(s->moment, &s->moment_count, c, err);
    if (result != MRT_OK)
        return result;
    return create_drawing(s, err) ? MRT_OK : MRT_ERR_UNSUPPORTED;
}

/* Grows the box by the shape, at most by `limit` beyond its first size: one wild moment must not
 * make all the others tiny. */
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

/* One framing for all moments. */
static mrt_result frame_all(sheet *s, float aspect, draw_camera *out, error *err)
{
    float low[3], high[3], least[3], most[3];
    mesh_bounds(s->mesh, low, high);
    float side = fmaxf(fmaxf(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    for (int axis = 0; axis < 3; ++axis) {
        least[axis] = low[axis] - 0.3f * side;
        most[axis] = high[axis] + 0.3f * side;
    }
    for (uint32_t i = 0; i < s->moment_count; ++i) {
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

/* Words in at most `width_px`, cut with an ellipsis. */
static void write_words(sheet *s, const char *words, float x, float y, float size_px,
                        float width_px, const float ink[4])
{
    char line[512];
    snprintf(line, sizeof line - 4, "%s", words);
    size_t length = strlen(line);
    while (length > 0 && draw_text_width(s->renderer, line, size_px) > width_px) {
        do
            --length;
        while (length > 0 && ((unsigned char)line[length] & 0xc0) == 0x80); /* whole letters */
        memcpy(line + length, "…", sizeof "…");
    }
    draw_text(s->renderer, s->target, line, x, y, size_px, ink);
}

/* "1.25 s" within the first minute of a short clip, "2:01.25" in longer ones. */
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

static void write_header(sheet *s, const char *title)
{
    char legend[256];
    const float width = SHEET_WIDTH - 2 * MARGIN;
    uint32_t frame_count = clip_frame_count(s->clip);
    if (title)
        write_words(s, title, MARGIN, TITLE_TOP, TITLE_SIZE, width, ink_strong);
    if (frame_count == 0)
        snprintf(legend, sizeof legend, "The face at rest: the performance has no frames.");
    else
        snprintf(legend, sizeof legend,
                 "%u frame%s at %g per second, %.2f s.  In each eighth of it the moment furthest "
                 "from rest: its time, and how far the vertices are (root mean square).",
                 frame_count, frame_count == 1 ? "" : "s", clip_fps(s->clip),
                 frame_count / clip_fps(s->clip));
    write_words(s, legend, MARGIN, LEGEND_TOP, LEGEND_SIZE, width, ink_calm);
}

static void draw_rest(sheet *s, const draw_camera *front)
{
    draw_camera turned = three_quarter(front);
    const float width = VIEW_WIDTH;
    draw_render(s->renderer, s->target, s->face, front, MARGIN, GRID_TOP, VIEW_WIDTH, VIEW_HEIGHT);
    draw_render(s->renderer, s->target, s->face, &turned, MARGIN, GRID_TOP + ROW_HEIGHT, VIEW_WIDTH,
                VIEW_HEIGHT);
    for (int row = 0; row < 2; ++row)
        write_words(s, "at rest", MARGIN, (float)(GRID_TOP + row * ROW_HEIGHT + VIEW_HEIGHT + 6),
                    LABEL_SIZE, width, ink_calm);
}

static mrt_result draw_moment(sheet *s, uint32_t i, const draw_camera *front, error *err)
{
    mrt_result result = clip_read(s->clip, s->moment[i].frame, s->position, err);
    if (result != MRT_OK)
        return result;
    draw_face_update(s->face, s->position, NULL);
    draw_camera turned = three_quarter(front);
    uint32_t column = i % COLUMNS, row = i / COLUMNS;
    uint32_t x = MARGIN + VIEW_WIDTH + GAP + column * (2 * VIEW_WIDTH + GAP);
    uint32_t y = GRID_TOP + row * ROW_HEIGHT;
    draw_render(s->renderer, s->target, s->face, front, x, y, VIEW_WIDTH, VIEW_HEIGHT);
    draw_render(s->renderer, s->target, s->face, &turned, x + VIEW_WIDTH, y, VIEW_WIDTH,
                VIEW_HEIGHT);
    char label[64];
    format_time(label, sizeof label, s->clip, s->moment[i].frame);
    float top = (float)(y + VIEW_HEIGHT + 6);
    write_words(s, label, (float)x, top, LABEL_SIZE, VIEW_WIDTH, ink_strong);
    float right = (float)x + draw_text_width(s->renderer, label, LABEL_SIZE) + 14.0f;
    snprintf(label, sizeof label, "%.1f mm from rest", s->moment[i].distance_mm);
    write_words(s, label, right, top, LABEL_SIZE, 2 * VIEW_WIDTH - 100, ink_calm);
    return MRT_OK;
}

static mrt_result draw_moments(sheet *s, error *err)
{
    draw_camera front;
    mrt_result result = frame_all(s, (float)VIEW_WIDTH / VIEW_HEIGHT, &front, err);
    if (result != MRT_OK)
        return result;
    draw_face_update(s->face, s->mesh->position, NULL); /* shaded as the moments are */
    draw_rest(s, &front);
    for (uint32_t i = 0; i < s->moment_count && result == MRT_OK; ++i)
        result = draw_moment(s, i, &front, err);
    return result;
}

static mrt_result draw_rest_alone(sheet *s, error *err)
{
    draw_camera front;
    mrt_result result = frame_all(s, (float)REST_WIDTH / REST_HEIGHT, &front, err);
    if (result != MRT_OK)
        return result;
    draw_camera turned = three_quarter(&front);
    const uint32_t x = (SHEET_WIDTH - 2 * REST_WIDTH) / 2;
    draw_render(s->renderer, s->target, s->face, &front, x, GRID_TOP, REST_WIDTH, REST_HEIGHT);
    draw_render(s->renderer, s->target, s->face, &turned, x + REST_WIDTH, GRID_TOP, REST_WIDTH,
                REST_HEIGHT);
    write_words(s, "at rest", (float)x, GRID_TOP + REST_HEIGHT + 8, LABEL_SIZE, REST_WIDTH,
                ink_calm);
    return MRT_OK;
}

mrt_result sheet_write(const char *path, const clip *c, const char *title, error *err)
{
    sheet s;
    mrt_result result = sheet_init(&s, c, err);
    if (result == MRT_OK)
        result = s.moment_count ? draw_moments(&s, err) : draw_rest_alone(&s, err);
    if (result == MRT_OK) {
        write_header(&s, title);
        draw_read(s.target, s.pixels);
        result = png_write(path, s.pixels, SHEET_WIDTH, SHEET_HEIGHT, err);
    }
    if (result == MRT_OK)
        error_set(err, MRT_OK, "%s",
                  draw_text_font(s.renderer)
                      ? ""
                      : "the contact sheet has no words: no font was found, install fonts-inter");
    sheet_finish(&s);
    return result;
}
