#include "draw/camera.h"
#include "draw/overlay.h"

#include <math.h>

typedef struct ray {
    float eye[3], way[3]; /* way: unit */
} ray;

static bool ray_through(ray *out, const draw_camera *safe, const uint32_t rectangle[4],
                        const float pixel[2])
{
    if (rectangle[2] == 0 || rectangle[3] == 0 || !isfinite(pixel[0]) || !isfinite(pixel[1]))
        return false;
    float width = (float)rectangle[2], height = (float)rectangle[3];
    const float on_screen[2] = {(pixel[0] - (float)rectangle[0]) / width * 2.0f - 1.0f,
                                1.0f - (pixel[1] - (float)rectangle[1]) / height * 2.0f};
    camera_eye(safe, out->eye);
    camera_ray(safe, width / height, on_screen, out->way);
    return true;
}

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross3(float out[3], const float a[3], const float b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void subtract3(float out[3], const float a[3], const float b[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = a[i] - b[i];
}

static const float edge = 1e-4f; /* triangles overlap a little: no ray slips through between two */

/* Moeller and Trumbore 1997, for triangles that face the eye. share: of the second and third
 * corner. Comparisons are such that NaN is no hit. */
static bool meets(const ray *r, const float *a, const float *b, const float *c, float share[2],
                  float *out_distance)
{
    float ab[3], ac[3], across[3], from[3], turned[3];
    subtract3(ab, b, a);
    subtract3(ac, c, a);
    cross3(across, r->way, ac);
    float facing = dot3(ab, across); /* twice the area seen along the ray */
    if (!(facing > 0.0f))
        return false;
    subtract3(from, r->eye, a);
    share[0] = dot3(from, across);
    float least = -edge * facing, most = facing - least;
    if (!(share[0] >= least && share[0] <= most))
        return false;
    cross3(turned, from, ab);
    share[1] = dot3(r->way, turned);
    if (!(share[1] >= least && share[0] + share[1] <= most))
        return false;
    *out_distance = dot3(ac, turned) / facing;
    share[0] = fmaxf(share[0] / facing, 0.0f);
    share[1] = fminf(fmaxf(share[1] / facing, 0.0f), 1.0f - fminf(share[0], 1.0f));
    return *out_distance > 0.0f;
}

static void describe(draw_hit *hit, const ray *r, const mesh *m, const float *position)
{
    const float *corner[3];
    float ab[3], ac[3];
    for (int i = 0; i < 3; ++i) {
        hit->vertex[i] = m->triangle[(size_t)hit->triangle * 3 + (size_t)i];
        corner[i] = position + (size_t)hit->vertex[i] * 3;
    }
    for (int i = 0; i < 3; ++i)
        hit->at[i] = r->eye[i] + hit->distance_mm * r->way[i];
    subtract3(ab, corner[1], corner[0]);
    subtract3(ac, corner[2], corner[0]);
    cross3(hit->normal, ab, ac);
    float length = sqrtf(dot3(hit->normal, hit->normal));
    for (int i = 0; i < 3; ++i)
        hit->normal[i] = length > 0.0f ? hit->normal[i] / length : -r->way[i];
}

bool draw_pick(draw_hit *out, const mesh *m, const float *position, const draw_camera *camera,
               const uint32_t rectangle[4], const float pixel[2])
{
    draw_camera safe = camera_made_safe(camera);
    ray r;
    if (!ray_through(&r, &safe, rectangle, pixel))
        return false;
    bool found = false;
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        const uint32_t *corner = m->triangle + (size_t)t * 3;
        float share[2], distance;
        if (!meets(&r, position + (size_t)corner[0] * 3, position + (size_t)corner[1] * 3,
                   position + (size_t)corner[2] * 3, share, &distance) ||
            (found && distance >= out->distance_mm))
            continue;
        found = true;
        *out = (draw_hit){.triangle = t,
                          .share = {fmaxf(1.0f - share[0] - share[1], 0.0f), share[0], share[1]},
                          .distance_mm = distance};
    }
    if (found)
        describe(out, &r, m, position);
    return found;
}

bool draw_unproject(float out[3], const draw_camera *camera, const uint32_t rectangle[4],
                    const float pixel[2], const float through[3])
{
    draw_camera safe = camera_made_safe(camera);
    ray r;
    if (!ray_through(&r, &safe, rectangle, pixel))
        return false;
    float right[3], up[3], back[3], to_eye[3];
    camera_axes_of(&safe, right, up, back);
    subtract3(to_eye, r.eye, through);
    float depth = dot3(to_eye, back), along = -dot3(r.way, back);
    if (!(depth > 0.0f && along > 0.0f))
        return false;
    for (int i = 0; i < 3; ++i)
        out[i] = r.eye[i] + r.way[i] * (depth / along);
    return true;
}
