#include "rigportraits.h"

#include "draw/offscreen.h"

#include <math.h>

/* Shares of a panel's width, and of a header's height. */
static const float name_size = 0.065f, name_top = 0.0175f, name_margin = 0.04f;
static const float title_size = 0.28f, made_size = 0.16f, header_margin = 0.13f;
static const float least_px = 9; /* smaller letters cannot be read */
static const double field_of_view_rad = 0.42;
static const double air = 0.025; /* of a panel, at each edge that the faces come near */
static const float ink[4] = {0.92f, 0.93f, 0.95f, 1.0f}, calm[4] = {0.62f, 0.64f, 0.68f, 1.0f};

rigpicture_view rigportraits_usual_view(void)
{
    return (rigpicture_view){.yaw_rad = 0.349f, .pitch_rad = 0.035f}; /* 20 and 2 degrees */
}

/* ---- framing ---- */

typedef struct view_axes {
    vec3 axis[3]; /* right, up, towards the eye */
} view_axes;

static view_axes axes_of(rigpicture_view view)
{
    double yaw = (double)view.yaw_rad, pitch = (double)view.pitch_rad;
    return (view_axes){{{cos(yaw), 0.0, -sin(yaw)},
                        {-sin(yaw) * sin(pitch), cos(pitch), -cos(yaw) * sin(pitch)},
                        {sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch)}}};
}

rigportraits_frame rigportraits_frame_empty(rigpicture_view view)
{
    const double slope = tan(0.5 * field_of_view_rad) * (1.0 - 2.0 * air);
    return (rigportraits_frame){.view = view,
                                .slope = {slope * RIGPORTRAITS_WIDTH / RIGPORTRAITS_HEIGHT, slope},
                                .reach = {-INFINITY, -INFINITY, -INFINITY, -INFINITY},
                                .depth = {INFINITY, -INFINITY}};
}

/* A point is within the right edge of a view from distance d if right <= slope (d - depth), so it
 * is the greatest right + slope depth that counts; the other edges likewise. */
void rigportraits_frame_add(rigportraits_frame *self, const float *position, uint32_t vertex_count)
{
    view_axes axes = axes_of(self->view);
    for (uint32_t v = 0; v < vertex_count; ++v) {
        const float *p = position + (size_t)v * 3;
        vec3 at = {(double)p[0], (double)p[1], (double)p[2]};
        double depth = vec3_dot(at, axes.axis[2]);
        for (int i = 0; i < 2; ++i) {
            double along = vec3_dot(at, axes.axis[i]), nearer = self->slope[i] * depth;
            self->reach[2 * i] = fmax(self->reach[2 * i], nearer + along);
            self->reach[2 * i + 1] = fmax(self->reach[2 * i + 1], nearer - along);
        }
        self->depth[0] = fmin(self->depth[0], depth);
        self->depth[1] = fmax(self->depth[1], depth);
    }
}

draw_camera rigportraits_frame_camera(const rigportraits_frame *self)
{
    draw_camera camera = {.distance_mm = 1.0f,
                          .yaw_rad = self->view.yaw_rad,
                          .pitch_rad = self->view.pitch_rad,
                          .field_of_view_rad = (float)field_of_view_rad};
    if (!(self->depth[1] >= self->depth[0]))
        return camera; /* nothing to show */
    view_axes axes = axes_of(self->view);
    double middle = 0.5 * (self->depth[0] + self->depth[1]), eye = self->depth[1] + 1.0;
    vec3 target = vec3_scale(axes.axis[2], middle);
    for (int i = 0; i < 2; ++i) {
        const double *reach = self->reach + (size_t)2 * (size_t)i;
        target = vec3_add(target, vec3_scale(axes.axis[i], 0.5 * (reach[0] - reach[1])));
        eye = fmax(eye, 0.5 * (reach[0] + reach[1]) / self->slope[i]);
    }
    camera.target[0] = (float)target.x;
    camera.target[1] = (float)target.y;
    camera.target[2] = (float)target.z;
    camera.distance_mm = (float)(eye - middle);
    return camera;
}

/* ---- the picture ---- */

/* In so many columns; the panels as large as they can be. */
static rigportraits_grid lay_out_columns(rigportraits_grid g, uint32_t count, uint32_t column_count)
{
    const float caption = (float)RIGPORTRAITS_CAPTION / RIGPORTRAITS_WIDTH;
    const float aspect = (float)RIGPORTRAITS_HEIGHT / RIGPORTRAITS_WIDTH;
    g.columns = column_count;
    g.rows = (count + column_count - 1) / column_count;
    float across = (float)g.width / (float)column_count;
    float down = (float)(g.height - g.header) / (float)g.rows / (aspect + caption);
    float panel = floorf(fmaxf(fminf(across, down) + 1e-3f, 1.0f));
    g.panel_width = (uint32_t)panel;
    g.panel_height = (uint32_t)fmaxf(panel * aspect, 1.0f);
    g.caption = (uint32_t)(panel * caption);
    uint32_t used_across = g.columns * g.panel_width;
    uint32_t used_down = g.header + g.rows * (g.panel_height + g.caption);
    g.left = used_across < g.width ? (g.width - used_across) / 2 : 0;
    g.top = g.header + (used_down < g.height ? (g.height - used_down) / 2 : 0);
    return g;
}

rigportraits_grid rigportraits_lay_out(uint32_t count, uint32_t width, uint32_t height)
{
    rigportraits_grid g = {.width = width, .height = height};
    uint32_t usual = count < RIGPORTRAITS_COLUMNS ? count : RIGPORTRAITS_COLUMNS;
    if (width == 0) {
        uint32_t rows = (count + usual - 1) / usual;
        g.width = usual * RIGPORTRAITS_WIDTH;
        g.header = RIGPORTRAITS_HEADER;
        g.height = g.header + rows * (RIGPORTRAITS_HEIGHT + RIGPORTRAITS_CAPTION);
        return lay_out_columns(g, count, usual);
    }
    float header = fminf(RIGPORTRAITS_HEADER * (float)width / (4.0f * RIGPORTRAITS_WIDTH),
                         0.12f * (float)height);
    header = fmaxf(header, least_px / made_size);
    g.header = header < 0.25f * (float)height ? (uint32_t)header : 0;
    rigportraits_grid best = lay_out_columns(g, count, 1);
    for (uint32_t column_count = 2; column_count <= count; ++column_count) {
        rigportraits_grid other = lay_out_columns(g, count, column_count);
        best = other.panel_width > best.panel_width ? other : best;
    }
    return best;
}

/* The title, and in two lines how to make it again. */
static void write_header(offscreen *e, const rigportraits_grid *g, const rigportraits_about *about)
{
    const float unit = (float)g->header, margin = header_margin * unit;
    const float width = (float)g->width - 2 * margin;
    const float title = fmaxf(title_size * unit, least_px);
    if (g->header == 0)
        return;
    offscreen_words(e, about->title, margin, 0.5f * margin, title, width, ink);
    offscreen_paragraph(e, about->made_from, margin, 0.5f * margin + offscreen_line_px(title),
                        fmaxf(made_size * unit, least_px), width, 2, calm);
}

static mrt_result draw_portrait(offscreen *e, const rigportraits_grid *g, rigpose_stage *stage,
                                uint32_t pose, const draw_camera *camera, error *err)
{
    mrt_result result = rigpose_show(stage, pose, err);
    if (result < 0)
        return result;
    const uint32_t x = g->left + pose % g->columns * g->panel_width;
    const uint32_t y = g->top + pose / g->columns * (g->panel_height + g->caption);
    if (x + g->panel_width > g->width || y + g->panel_height > g->height)
        return MRT_OK; /* a tiny picture has no room for all */
    const char *name = stage->rig->pose[pose].name;
    const float panel = (float)g->panel_width, size = fmaxf(name_size * panel, least_px);
    const float room = (1.0f - 2.0f * name_margin) * panel;
    draw_face_update(e->face, stage->position, NULL);
    draw_render(e->renderer, e->target, e->face, camera, x, y, g->panel_width, g->panel_height);
    float width = fminf(draw_text_width(e->renderer, name, size), room);
    if ((float)g->caption >= size)
        offscreen_words(e, name, (float)x + 0.5f * (panel - width),
                        (float)(y + g->panel_height) + name_top * panel, size, room, ink);
    return MRT_OK;
}

mrt_result rigportraits_write(const char *path, rigpose_stage *stage,
                              const rigportraits_frame *frame, const rigportraits_about *about,
                              error *err)
{
    uint32_t count = stage->rig->pose_count;
    if (count > RIGPORTRAITS_MAX)
        count = RIGPORTRAITS_MAX;
    const rigportraits_grid g = rigportraits_lay_out(count, about->width, about->height);
    draw_camera camera = rigportraits_frame_camera(frame);
    offscreen e;
    mrt_result result = offscreen_init(&e, stage->mesh, g.width, g.height, err);
    if (result < 0)
        return result;
    write_header(&e, &g, about);
    for (uint32_t i = 0; result >= 0 && i < count; ++i)
        result = draw_portrait(&e, &g, stage, i, &camera, err);
    if (result >= 0)
        result = offscreen_save(&e, path, err);
    offscreen_finish(&e);
    return result;
}
