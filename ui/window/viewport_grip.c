#include "window/viewport_grip.h"

#include <math.h>
#include <string.h>

/* Away from what is held the camera is its own business: at most so much of its distance. */
static const float most_lift = 0.5f;

static void towards_eye(float out[3], const draw_camera *camera)
{
    float sy = sinf(camera->yaw_rad), cy = cosf(camera->yaw_rad);
    float sp = sinf(camera->pitch_rad), cp = cosf(camera->pitch_rad);
    out[0] = sy * cp;
    out[1] = sp;
    out[2] = cy * cp;
}

/* The place under the pointer in the plane of what is held, lifted. */
static bool place_under(float out[3], const viewport_grip *self, const viewport_grip_view *view)
{
    float back[3];
    if (!draw_unproject(out, view->camera, view->rectangle, view->pixel, self->begin))
        return false;
    towards_eye(back, view->camera);
    for (int i = 0; i < 3; ++i)
        out[i] += self->depth_mm * back[i];
    return true;
}

void viewport_grip_take(viewport_grip *self, pointer_grip how, const float rest[3],
                        const float shown[3], const viewport_grip_view *view)
{
    *self = (viewport_grip){.holds = true, .how = how};
    memcpy(self->rest, rest, sizeof self->rest);
    memcpy(self->begin, shown, sizeof self->begin);
    memcpy(self->at, shown, sizeof self->at);
    float under[3];
    if (!place_under(under, self, view))
        return;
    for (int i = 0; i < 3; ++i)
        self->offset[i] = shown[i] - under[i];
}

void viewport_grip_drag(viewport_grip *self, const viewport_grip_view *view)
{
    float under[3];
    if (!self->holds || !place_under(under, self, view))
        return;
    for (int i = 0; i < 3; ++i)
        self->at[i] = under[i] + self->offset[i];
}

void viewport_grip_lift(viewport_grip *self, float towards_mm, const viewport_grip_view *view)
{
    if (!self->holds)
        return;
    float most = most_lift * view->camera->distance_mm;
    self->depth_mm = fminf(fmaxf(self->depth_mm + towards_mm, -most), most);
    viewport_grip_drag(self, view);
}

void viewport_grip_let_go(viewport_grip *self)
{
    self->holds = false;
}
