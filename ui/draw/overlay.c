#include "draw/overlay.h"
#include "draw/face.h"
#include "draw/renderer.h"
#include "draw/target.h"

static const float lift_share = 0.008f; /* of the face's height */

void draw_overlay(draw_renderer *self, draw_target *target, const draw_face *face,
                  const draw_camera *camera, const uint32_t rectangle[4], const overlay_item *item,
                  uint32_t count)
{
    uint32_t width = rectangle[2], height = rectangle[3];
    if (count == 0 || width == 0 || height == 0 || rectangle[0] >= target->width ||
        rectangle[1] >= target->height || width > SIDE_LIMIT || height > SIDE_LIMIT)
        return;
    overlays_view view = {.camera = camera_made_safe(camera),
                          .width = width,
                          .height = height,
                          .lift_mm = lift_share * face->height_mm};
    view.projection = camera_projection(&view.camera, (float)width / (float)height, face->centre,
                                        face->radius_mm);
    renderer_light(view.to_light, RENDERER_KEY, view.camera.yaw_rad);
    GLint x = (GLint)rectangle[0];
    GLint y = (GLint)target->height - (GLint)rectangle[1] - (GLint)height;
    gl_state before;
    gl_state_enter(&before);
    gl_bind_framebuffer(GL_FRAMEBUFFER, target->framebuffer);
    glViewport(x, y, (GLsizei)width, (GLsizei)height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(x, y, (GLsizei)width, (GLsizei)height);
    overlays_draw(self->overlays, &view, item, count);
    target->stale = true;
    gl_state_leave(&before);
}
