#include "draw/sheet.h"
#include "draw/easel.h"
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
    easel easel;
} sheet;

static void sheet_finish(sheet *s)
{
    easel_finish(&s->easel);
    free(s->position);
}

static mrt_result sheet_init(sheet *s, const clip *c, error *err)
{
    *s = (sheet){.clip = c, .mesh = clip_mesh(c)};
    s->position = malloc(((size_t)s->mesh->vertex_count * 3 + 1) * sizeof *s->position);
    if (!s->position)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the contact sheet");
    mrt_result result = moments_choose(s->moment, &s->moment_count, c, err);
    if (result != MRT_OK)
        return result;
    return easel_init(&s->easel, s->mesh, SHEET_WIDTH, SHEET_HEIGHT, err);
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
        easel_words(&s->easel, title, MARGIN, TITLE_TOP, TITLE_SIZE, width, ink_strong);
    if (frame_count == 0)
        snprintf(legend, sizeof legend, "The face at rest: the performance has no frames.");
    else
        snprintf(legend, sizeof legend,
                 "%u frame%s at %g per second, %.2f s.  In each eighth of it the moment furthest "
                 "from rest: its time, and how far the vertices are (root mean square).",
                 frame_count, frame_count == 1 ? "" : "s", clip_fps(s->clip),
                 frame_count / clip_fps(s->clip));
    easel_words(&s->easel, legend, MARGIN, LEGEND_TOP, LEGEND_SIZE, width, ink_calm);
}

static void draw_rest(sheet *s, const draw_camera *front)
{
    draw_camera turned = three_quarter(front);
    const float width = VIEW_WIDTH;
    draw_render(s->easel.renderer, s->easel.target, s->easel.face, front, MARGIN, GRID_TOP,
                VIEW_WIDTH, VIEW_HEIGHT);
    draw_render(s->easel.renderer, s->easel.target, s->easel.face, &turned, MARGIN,
                GRID_TOP + ROW_HEIGHT, VIEW_WIDTH, VIEW_HEIGHT);
    for (int row = 0; row < 2; ++row)
        easel_words(&s->easel, "at rest", MARGIN,
                    (float)(GRID_TOP + row * ROW_HEIGHT + VIEW_HEIGHT + 6), LABEL_SIZE, width,
                    ink_calm);
}

static mrt_result draw_moment(sheet *s, uint32_t i, const draw_camera *front, error *err)
{
    mrt_result result = clip_read(s->clip, s->moment[i].frame, s->position, err);
    if (result != MRT_OK)
        return result;
    draw_face_update(s->easel.face, s->position, NULL);
    draw_camera turned = three_quarter(front);
    uint32_t column = i % COLUMNS, row = i / COLUMNS;
    uint32_t x = MARGIN + VIEW_WIDTH + GAP + column * (2 * VIEW_WIDTH + GAP);
    uint32_t y = GRID_TOP + row * ROW_HEIGHT;
    draw_render(s->easel.renderer, s->easel.target, s->easel.face, front, x, y, VIEW_WIDTH,
                VIEW_HEIGHT);
    draw_render(s->easel.renderer, s->easel.target, s->easel.face, &turned, x + VIEW_WIDTH, y,
                VIEW_WIDTH, VIEW_HEIGHT);
    char label[64];
    format_time(label, sizeof label, s->clip, s->moment[i].frame);
    float top = (float)(y + VIEW_HEIGHT + 6);
    easel_words(&s->easel, label, (float)x, top, LABEL_SIZE, VIEW_WIDTH, ink_strong);
    float right = (float)x + draw_text_width(s->easel.renderer, label, LABEL_SIZE) + 14.0f;
    snprintf(label, sizeof label, "%.1f mm from rest", s->moment[i].distance_mm);
    easel_words(&s->easel, label, right, top, LABEL_SIZE, 2 * VIEW_WIDTH - 100, ink_calm);
    return MRT_OK;
}

static mrt_result draw_moments(sheet *s, error *err)
{
    draw_camera front;
    mrt_result result = frame_all(s, (float)VIEW_WIDTH / VIEW_HEIGHT, &front, err);
    if (result != MRT_OK)
        return result;
    draw_face_update(s->easel.face, s->mesh->position, NULL); /* shaded as the moments are */
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
    draw_render(s->easel.renderer, s->easel.target, s->easel.face, &front, x, GRID_TOP, REST_WIDTH,
                REST_HEIGHT);
    draw_render(s->easel.renderer, s->easel.target, s->easel.face, &turned, x + REST_WIDTH,
                GRID_TOP, REST_WIDTH, REST_HEIGHT);
    easel_words(&s->easel, "at rest", (float)x, GRID_TOP + REST_HEIGHT + 8, LABEL_SIZE, REST_WIDTH,
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
        result = easel_save(&s.easel, path, err);
    }
    if (result == MRT_OK)
        error_set(err, MRT_OK, "%s",
                  draw_text_font(s.easel.renderer)
                      ? ""
                      : "the contact sheet has no words: no font was found, install fonts-inter");
    sheet_finish(&s);
    return result;
}
