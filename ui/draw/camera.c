#include "draw/camera.h"

#include <math.h>

typedef struct axes {
    double right[3], up[3], back[3]; /* orthonormal; the camera looks along -back */
} axes;

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross3(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static axes camera_axes(const draw_camera *camera)
{
    double sy = sin((double)camera->yaw_rad), cy = cos((double)camera->yaw_rad);
    double sp = sin((double)camera->pitch_rad), cp = cos((double)camera->pitch_rad);
    return (axes){
        .right = {cy, 0.0, -sy}, .up = {-sy * sp, cp, -cy * sp}, .back = {sy * cp, sp, cy * cp}};
}

static float within(float value, float low, float high, float fallback)
{
    if (!isfinite(value))
        return fallback;
    return value < low ? low : value > high ? high : value;
}

draw_camera camera_made_safe(const draw_camera *camera)
{
    draw_camera safe = *camera;
    for (int i = 0; i < 3; ++i)
        safe.target[i] = within(safe.target[i], -1e7f, 1e7f, 0.0f);
    safe.distance_mm = within(safe.distance_mm, 1e-3f, 1e8f, 1000.0f);
    safe.yaw_rad = within(safe.yaw_rad, -1e4f, 1e4f, 0.0f);
    safe.pitch_rad = within(safe.pitch_rad, -1e4f, 1e4f, 0.0f);
    safe.field_of_view_rad = within(safe.field_of_view_rad, 0.01f, 2.5f, 0.4f);
    return safe;
}

static void eye_of(const draw_camera *camera, const axes *a, double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = (double)camera->target[i] + (double)camera->distance_mm * a->back[i];
}

void camera_eye(const draw_camera *camera, float out[3])
{
    axes a = camera_axes(camera);
    double eye[3];
    eye_of(camera, &a, eye);
    for (int i = 0; i < 3; ++i)
        out[i] = (float)eye[i];
}

void camera_axes_of(const draw_camera *camera, float right[3], float up[3], float back[3])
{
    axes a = camera_axes(camera);
    for (int i = 0; i < 3; ++i) {
        right[i] = (float)a.right[i];
        up[i] = (float)a.up[i];
        back[i] = (float)a.back[i];
    }
}

void camera_ray(const draw_camera *camera, float aspect, const float on_screen[2], float out[3])
{
    axes a = camera_axes(camera);
    double slope = tan(0.5 * (double)camera->field_of_view_rad);
    double across = (double)on_screen[0] * slope * (double)aspect,
           upward = (double)on_screen[1] * slope;
    double way[3], squared = 0.0;
    for (int i = 0; i < 3; ++i) {
        way[i] = across * a.right[i] + upward * a.up[i] - a.back[i];
        squared += way[i] * way[i];
    }
    for (int i = 0; i < 3; ++i)
        out[i] = (float)(way[i] / sqrt(squared));
}

/* Returns rows (x - origin) + offset as one matrix. rows: scaled view directions. */
static matrix4 from_rows(const double rows[4][3], const double origin[3], const double offset[4])
{
    matrix4 out;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 3; ++column)
            out.m[column * 4 + row] = (float)rows[row][column];
        out.m[12 + row] = (float)(offset[row] - dot3(rows[row], origin));
    }
    return out;
}

matrix4 camera_projection(const draw_camera *camera, float aspect, const float centre[3],
                          float radius_mm)
{
    axes a = camera_axes(camera);
    double eye[3], to_centre[3];
    eye_of(camera, &a, eye);
    for (int i = 0; i < 3; ++i)
        to_centre[i] = eye[i] - (double)centre[i];
    double middle = dot3(to_centre, a.back), radius = (double)radius_mm * 1.01 + 1e-3;
    double far = fmax(middle + radius, (double)camera->distance_mm * 0.1);
    double near = fmax(middle - radius, far * 1e-3);
    double focal = 1.0 / tan(0.5 * (double)camera->field_of_view_rad);
    double depth = (far + near) / (far - near);
    double rows[4][3];
    for (int i = 0; i < 3; ++i) {
        rows[0][i] = a.right[i] * focal / (double)aspect;
        rows[1][i] = a.up[i] * focal;
        rows[2][i] = -a.back[i] * depth;
        rows[3][i] = -a.back[i];
    }
    double offset[4] = {0.0, 0.0, -2.0 * far * near / (far - near), 0.0};
    return from_rows((const double(*)[3])rows, eye, offset);
}

matrix4 camera_light_projection(const float direction[3], const float centre[3], float radius_mm)
{
    double back[3] = {(double)direction[0], (double)direction[1], (double)direction[2]};
    double upright[3] = {0.0, fabs(back[1]) < 0.9 ? 1.0 : 0.0, fabs(back[1]) < 0.9 ? 0.0 : 1.0};
    double right[3], up[3], middle[3], rows[4][3];
    cross3(right, upright, back);
    double length = sqrt(dot3(right, right));
    for (int i = 0; i < 3; ++i)
        right[i] /= length;
    cross3(up, back, right);
    double scale = 1.0 / (double)radius_mm;
    for (int i = 0; i < 3; ++i) {
        middle[i] = (double)centre[i];
        rows[0][i] = right[i] * scale;
        rows[1][i] = up[i] * scale;
        rows[2][i] = -back[i] * scale;
        rows[3][i] = 0.0;
    }
    return from_rows((const double(*)[3])rows, middle, (const double[4]){0.0, 0.0, 0.0, 1.0});
}

matrix4 camera_to_texture(const matrix4 *projection)
{
    matrix4 out = *projection;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
            out.m[column * 4 + row] =
                0.5f * (projection->m[column * 4 + row] + projection->m[column * 4 + 3]);
    return out;
}

draw_camera draw_camera_framing(const float low[3], const float high[3], float aspect)
{
    const double air = 1.12, half_view = 0.5 * 0.42;
    double half[3];
    draw_camera camera = {.field_of_view_rad = (float)(2.0 * half_view)};
    for (int i = 0; i < 3; ++i) {
        double from = (double)low[i], to = (double)high[i];
        bool usable = isfinite(from) && isfinite(to) && to >= from;
        half[i] = usable ? 0.5 * (to - from) : 0.0;
        camera.target[i] = usable ? (float)(0.5 * (from + to)) : 0.0f;
    }
    double width = isfinite(aspect) && aspect > 0.0f ? (double)aspect : 1.0;
    double slope = tan(half_view);
    double tall = half[1] / slope;
    /* When the face turns to the side, depth and width are exchanged. Both must fit. */
    double front = fmax(tall, half[0] / (slope * width)) * air + half[2];
    double side = fmax(tall, half[2] / (slope * width)) * air + half[0];
    camera.distance_mm = (float)fmax(fmax(front, side), 1.0);
    return camera;
}

draw_camera_view draw_camera_keep(const draw_camera *camera, const draw_camera *home)
{
    const double unit = (double)home->distance_mm;
    draw_camera_view out = {
        {(double)camera->yaw_rad, (double)camera->pitch_rad, (double)camera->distance_mm / unit}};
    for (int i = 0; i < 3; ++i)
        out.number[3 + i] = ((double)camera->target[i] - (double)home->target[i]) / unit;
    return out;
}

draw_camera draw_camera_recall(const draw_camera_view *kept, const draw_camera *home)
{
    draw_camera out = *home;
    for (int i = 0; i < DRAW_VIEW_NUMBERS; ++i)
        if (!(fabs(kept->number[i]) <= 100.0))
            return out;
    if (!(kept->number[2] > 0.0))
        return out;
    out.yaw_rad = (float)kept->number[0];
    out.pitch_rad = (float)kept->number[1];
    out.distance_mm = (float)(kept->number[2] * (double)home->distance_mm);
    for (int i = 0; i < 3; ++i)
        out.target[i] += (float)(kept->number[3 + i] * (double)home->distance_mm);
    return out;
}
