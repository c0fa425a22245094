#include "rigportraits.h"

#include "draw/easel.h"

#include <math.h>

enum { NAME_SIZE = 26, NAME_TOP = 7, NAME_MARGIN = 16 }; /* pixels */
static const double field_of_view_rad = 0.42;
static const double air = 0.025; /* of a panel, at each edge that the faces come near */
static const float ink[4] = {0.92f, 0.93f, 0.95f, 1.0f};

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

static mrt_result draw_portrait(easel *e, rigpose_stage *stage, uint32_t pose,
                                const draw_camera *camera, error *err)
{
    mrt_result result = rigpose_show(stage, pose, err);
    if (result < 0)
        return result;
    const uint32_t x = pose % RIGPORTRAITS_COLUMNS * RIGPORTRAITS_WIDTH;
    const uint32_t y = pose / RIGPORTRAITS_COLUMNS * (RIGPORTRAITS_HEIGHT + RIGPORTRAITS_CAPTION);
    const char *name = stage->rig->pose[pose].name;
    const float room = RIGPORTRAITS_WIDTH - 2 * NAME_MARGIN;
    draw_face_update(e->face, stage->position, NULL);
    draw_render(e->renderer, e->target, e->face, camera, x, y, RIGPORTRAITS_WIDTH,
                RIGPORTRAITS_HEIGHT);
    float width = fminf(draw_text_width(e->renderer, name, NAME_SIZE), room);
    easel_words(e, name, (float)x + 0.5f * (RIGPORTRAITS_WIDTH - width),
                (float)(y + RIGPORTRAITS_HEIGHT + NAME_TOP), NAME_SIZE, room, ink);
    return MRT_OK;
}

mrt_result rigportraits_write(const char *path, rigpose_stage *stage,
                              const rigportraits_frame *frame, error *err)
{
    uint32_t count = stage->rig->pose_count;
    if (count > RIGPORTRAITS_MAX)
        count = RIGPORTRAITS_MAX;
    uint32_t across = count < RIGPORTRAITS_COLUMNS ? count : RIGPORTRAITS_COLUMNS;
    uint32_t down = (count + RIGPORTRAITS_COLUMNS - 1) / RIGPORTRAITS_COLUMNS;
    draw_camera camera = rigportraits_frame_camera(frame);
    easel e;
    mrt_result result = easel_init(&e, stage->mesh, across * RIGPORTRAITS_WIDTH,
                                   down * (RIGPORTRAITS_HEIGHT + RIGPORTRAITS_CAPTION), err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; result >= 0 && i < count; ++i)
        result = draw_portrait(&e, stage, i, &camera, err);
    if (result >= 0)
        result = easel_save(&e, path, err);
    easel_finish(&e);
    return result;
}
