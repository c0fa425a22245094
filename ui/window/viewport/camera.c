#include "window/viewport/camera.h"
#include "draw/camera.h"
#include "draw/overlay.h"

#include <math.h>

static const float rad_per_point = 0.0075f, steepest_rad = 1.45f, zoom_per_notch = 0.88f;
static const float nearest = 0.12f, furthest = 5.0f; /* distance limits, relative to home */
static const float widest_target = 0.6f;             /* limit of the target, relative to home */
static const float turn_rad_s = 0.4f;
static const float side_rad = 1.5707963f, quarter_rad = 0.62f, quarter_pitch_rad = 0.10f;
static const double pi = 3.14159265358979;

static float within(float value, float low, float high)
{
    return value < low ? low : value > high ? high : value;
}

/* Normalises an angle to -pi..pi. */
static float turned_back(float angle_rad)
{
    return (float)remainder((double)angle_rad, 2.0 * pi);
}

static void limit(viewport_camera *self)
{
    draw_camera *now = &self->now;
    const draw_camera *home = &self->home;
    now->yaw_rad = turned_back(now->yaw_rad);
    now->pitch_rad = within(now->pitch_rad, -steepest_rad, steepest_rad);
    now->distance_mm =
        within(now->distance_mm, nearest * home->distance_mm, furthest * home->distance_mm);
    float reach = widest_target * home->distance_mm;
    for (int i = 0; i < 3; ++i)
        now->target[i] = within(now->target[i], home->target[i] - reach, home->target[i] + reach);
}

void viewport_camera_init(viewport_camera *out, const float low[3], const float high[3],
                          float aspect)
{
    out->home = out->now = draw_camera_framing(low, high, aspect);
    out->glided_s = -1.0;
}

void viewport_camera_fit(viewport_camera *self, const float low[3], const float high[3],
                         float aspect)
{
    const draw_camera_view kept = viewport_camera_keep(self);
    viewport_camera_init(self, low, high, aspect);
    viewport_camera_recall(self, &kept);
}

void viewport_camera_orbit(viewport_camera *self, float right, float down)
{
    self->glided_s = -1.0;
    self->now.yaw_rad -= right * rad_per_point;
    self->now.pitch_rad += down * rad_per_point;
    limit(self);
}

void viewport_camera_pan(viewport_camera *self, float right, float down, float height)
{
    if (!(height > 0.0f))
        return;
    self->glided_s = -1.0;
    draw_camera *now = &self->now;
    float mm = 2.0f * tanf(0.5f * now->field_of_view_rad) * now->distance_mm / height;
    float to_right[3], to_top[3], back[3];
    camera_axes_of(now, to_right, to_top, back);
    for (int i = 0; i < 3; ++i)
        now->target[i] += mm * (down * to_top[i] - right * to_right[i]);
    limit(self);
}

void viewport_camera_zoom(viewport_camera *self, float notches, const uint32_t rectangle[4],
                          const float pixel[2])
{
    self->glided_s = -1.0;
    draw_camera *now = &self->now;
    float under[3], before = now->distance_mm;
    bool is_seen = draw_unproject(under, now, rectangle, pixel, now->target);
    now->distance_mm *= powf(zoom_per_notch, within(notches, -20.0f, 20.0f));
    limit(self);
    float share = 1.0f - now->distance_mm / before;
    for (int i = 0; is_seen && i < 3; ++i)
        now->target[i] += share * (under[i] - now->target[i]);
    limit(self);
}

/* ---- glides ---- */

static void glide_to(viewport_camera *self, draw_camera to)
{
    to.yaw_rad = self->now.yaw_rad + turned_back(to.yaw_rad - self->now.yaw_rad);
    self->from = self->now;
    self->to = to;
    self->glided_s = 0.0;
}

void viewport_camera_glide(viewport_camera *self, viewport_side side)
{
    draw_camera to = self->glided_s >= 0.0 ? self->to : self->now;
    float yaw = side == VIEWPORT_SIDE ? side_rad : side == VIEWPORT_THREE_QUARTER ? quarter_rad : 0;
    bool is_there = fabsf(turned_back(to.yaw_rad - yaw)) < 0.05f;
    to.yaw_rad = is_there ? -yaw : yaw;
    to.pitch_rad = side == VIEWPORT_THREE_QUARTER ? quarter_pitch_rad : 0.0f;
    glide_to(self, to);
}

void viewport_camera_frame(viewport_camera *self)
{
    draw_camera to = self->home;
    to.yaw_rad = self->glided_s >= 0.0 ? self->to.yaw_rad : self->now.yaw_rad;
    to.pitch_rad = self->glided_s >= 0.0 ? self->to.pitch_rad : self->now.pitch_rad;
    glide_to(self, to);
}

void viewport_camera_turn(viewport_camera *self, double dt_s)
{
    if (self->glided_s >= 0.0)
        return;
    self->now.yaw_rad = turned_back(self->now.yaw_rad + turn_rad_s * (float)dt_s);
}

static float blend(float from, float to, float share)
{
    return from + share * (to - from);
}

void viewport_camera_update(viewport_camera *self, double dt_s)
{
    if (self->glided_s < 0.0)
        return;
    self->glided_s += dt_s;
    float t = (float)fmin(self->glided_s / VIEWPORT_GLIDE_S, 1.0),
          share = t * t * (3.0f - 2.0f * t);
    const draw_camera *from = &self->from, *to = &self->to;
    draw_camera *now = &self->now;
    for (int i = 0; i < 3; ++i)
        now->target[i] = blend(from->target[i], to->target[i], share);
    now->distance_mm = blend(from->distance_mm, to->distance_mm, share);
    now->yaw_rad = blend(from->yaw_rad, to->yaw_rad, share);
    now->pitch_rad = blend(from->pitch_rad, to->pitch_rad, share);
    if (t < 1.0f)
        return;
    self->glided_s = -1.0;
    limit(self);
}

/* ---- saved views ---- */

draw_camera_view viewport_camera_keep(const viewport_camera *self)
{
    return draw_camera_keep(self->glided_s >= 0.0 ? &self->to : &self->now, &self->home);
}

void viewport_camera_recall(viewport_camera *self, const draw_camera_view *kept)
{
    self->glided_s = -1.0;
    self->now = draw_camera_recall(kept, &self->home);
    limit(self);
}
