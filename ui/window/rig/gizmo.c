#include "window/rig/gizmo.h"
#include "window/gui/theme.h"

#include <math.h>
#include <string.h>

enum { ARC_STEPS = 12, LAYERS = 3 };
static const float axis_rgba[4] = {0.95f, 0.45f, 0.70f, 0.95f};
static const float end_rgba[4] = {0.90f, 0.42f, 0.66f, 1.0f};
static const float rim_rgba[4] = {0.06f, 0.06f, 0.07f, 0.9f};
static const float held_rgba[4] = {0.98f, 0.80f, 0.40f, 1.0f};
static const float arc_rgba[4] = {0.95f, 0.75f, 0.45f, 0.85f};

/* ---- the pointer ---- */

static double angle_to(const rig_ray *ray, vec3 at)
{
    vec3 way = vec3_sub(at, ray->eye);
    double along = vec3_dot(way, ray->ray);
    vec3 aside = vec3_sub(way, vec3_scale(ray->ray, along));
    return along > 0.0 ? vec3_length(aside) / along : (double)INFINITY;
}

uint32_t rig_gizmo_nearest(const rig_ray *ray, const vec3 *at, uint32_t count, double reach_points)
{
    uint32_t best = RIG_NONE;
    double best_rad = reach_points * ray->point_rad;
    for (uint32_t i = 0; i < count; ++i) {
        double away_rad = angle_to(ray, at[i]);
        if (away_rad > best_rad)
            continue;
        best = i;
        best_rad = away_rad;
    }
    return best;
}

bool rig_gizmo_reach(vec3 *out, const rig_ray *ray, vec3 through)
{
    double depth = vec3_dot(vec3_sub(through, ray->eye), ray->forward);
    double slope = vec3_dot(ray->ray, ray->forward);
    if (!(slope > 1e-6) || !(depth > 0.0))
        return false;
    *out = vec3_add(ray->eye, vec3_scale(ray->ray, depth / slope));
    return true;
}

double rig_gizmo_points_between(const rig_ray *a, const rig_ray *b)
{
    return vec3_length(vec3_sub(a->ray, b->ray)) / fmax(a->point_rad, 1e-9);
}

/* ---- the jaw ---- */

void rig_gizmo_positions(vec3 out[RIG_HANDLES], const rig_edit_jaw *jaw)
{
    out[RIG_HANDLE_LEFT] = jaw->left;
    out[RIG_HANDLE_RIGHT] = jaw->right;
    out[RIG_HANDLE_INCISOR] = jaw->incisor;
}

static vec3 mirrored(vec3 at, double middle_mm)
{
    return (vec3){2.0 * middle_mm - at.x, at.y, at.z};
}

void rig_gizmo_move(rig_edit_jaw *jaw, rig_handle handle, vec3 to, bool is_even, double middle_mm)
{
    if (handle == RIG_HANDLE_INCISOR) {
        jaw->incisor = is_even ? (vec3){middle_mm, to.y, to.z} : to;
        jaw->has_incisor = true;
        return;
    }
    vec3 *moved = handle == RIG_HANDLE_LEFT ? &jaw->left : &jaw->right;
    vec3 *other = handle == RIG_HANDLE_LEFT ? &jaw->right : &jaw->left;
    *moved = to;
    if (is_even)
        *other = mirrored(to, middle_mm);
}

/* ---- drawing of the axis ---- */

static uint32_t draw_handle(overlay_item *out, vec3 at, float width_px, const float rgba[4])
{
    uint32_t count = 0;
    for (int i = 0; i < LAYERS; ++i)
        out[count++] = overlay_dot(at, width_px + 3.0f, rim_rgba);
    for (int i = 0; i < LAYERS; ++i)
        out[count++] = overlay_dot(at, width_px, rgba);
    return count;
}

/* Draws the path of the incisor around the axis, from closed to fully open. */
static uint32_t draw_arc(overlay_item *out, const rig_edit_jaw *jaw)
{
    const vec3 across = {
        1.0, 0.0, 0.0}; /* a right-handed turn around this axis moves the chin down and back */
    vec3 axis = vec3_normalised(vec3_sub(jaw->left, jaw->right), across), before = jaw->incisor;
    for (uint32_t i = 0; i < ARC_STEPS; ++i) {
        double angle = jaw->open_max_rad * (double)(i + 1) / ARC_STEPS;
        rigid rotation = rigid_turn(jaw->left, axis, angle);
        vec3 now = rigid_apply(&rotation, jaw->incisor);
        out[i] = overlay_line(before, now, 2.0f, arc_rgba);
        before = now;
    }
    return ARC_STEPS;
}

uint32_t rig_gizmo_draw(overlay_item out[RIG_GIZMO_ITEMS], const rig_edit_jaw *jaw, rig_handle held)
{
    uint32_t count = 0;
    vec3 position[RIG_HANDLES];
    rig_gizmo_positions(position, jaw);
    for (int i = 0; i < LAYERS; ++i)
        out[count++] = overlay_line(jaw->right, jaw->left, 3.0f, axis_rgba);
    if (jaw->has_incisor)
        count += draw_arc(out + count, jaw);
    for (int i = 0; i < RIG_HANDLES; ++i) {
        float width_px = i == RIG_HANDLE_INCISOR ? 11.0f : 16.0f;
        if (i != RIG_HANDLE_INCISOR || jaw->has_incisor)
            count += draw_handle(out + count, position[i], width_px,
                                 i == (int)held ? held_rgba : end_rgba);
    }
    return count;
}

/* ---- colours ---- */

static const float plain[3] = {0.20f, 0.195f, 0.19f};
static const float mobile[3] = {0.10f, 0.42f, 0.24f};
static const float still_part = 0.25f; /* share of the colour at mobility 0 */

void rig_tint_of_bone(float out[3], const rig *r, uint32_t bone)
{
    static const float skull[3] = {0.07f, 0.20f, 0.50f}, jaw[3] = {0.60f, 0.12f, 0.07f};
    static const float others[][3] = {{0.46f, 0.26f, 0.03f}, {0.26f, 0.09f, 0.44f},
                                      {0.04f, 0.34f, 0.36f}, {0.44f, 0.07f, 0.24f},
                                      {0.26f, 0.32f, 0.05f}, {0.40f, 0.30f, 0.24f}};
    const float *found = mobile;
    if (bone != RIG_NONE && strcmp(r->bone[bone].name, "skull") == 0)
        found = skull;
    else if (bone != RIG_NONE && r->bone[bone].kind == BONE_JAW)
        found = jaw;
    else if (bone != RIG_NONE)
        found = others[bone % (sizeof others / sizeof *others)];
    memcpy(out, found, 3 * sizeof *out);
}

uint32_t rig_tint_chip(const rig *r, uint32_t bone)
{
    float rgb[3];
    uint32_t out = 0;
    rig_tint_of_bone(rgb, r, bone);
    for (int i = 0; i < 3; ++i)
        out = out << 8 | theme_coded((double)rgb[i]);
    return out << 8 | 0xffu;
}

void rig_tint_mix(float rgb[3], const float colour[3], float share)
{
    for (int i = 0; i < 3; ++i)
        rgb[i] += share * (colour[i] - rgb[i]);
}

void rig_tint_bones(float *rgb, const rig *r, const binding *b)
{
    float colour[RIG_BONES_MAX][3];
    for (uint32_t bone = 0; bone < b->bone_count; ++bone)
        rig_tint_of_bone(colour[bone], r, bone);
    for (uint32_t v = 0; v < b->vertex_count; ++v) {
        float mixed[3] = {0.0f, 0.0f, 0.0f}, *out = rgb + (size_t)v * 3;
        for (uint32_t bone = 0; bone < b->bone_count; ++bone)
            for (int i = 0; i < 3; ++i)
                mixed[i] += b->weight[(size_t)bone * b->vertex_count + v] * colour[bone][i];
        memcpy(out, plain, sizeof plain);
        rig_tint_mix(out, mixed, still_part + (1.0f - still_part) * b->mobility[v]);
    }
}

void rig_tint_mobility(float *rgb, const binding *b)
{
    rig_tint_share(rgb, b->mobility, b->vertex_count, mobile);
}

void rig_tint_plain(float *rgb, uint32_t vertex_count)
{
    for (uint32_t v = 0; v < vertex_count; ++v)
        memcpy(rgb + (size_t)v * 3, plain, sizeof plain);
}

void rig_tint_share(float *rgb, const float *share, uint32_t vertex_count, const float colour[3])
{
    rig_tint_plain(rgb, vertex_count);
    for (uint32_t v = 0; v < vertex_count; ++v)
        rig_tint_mix(rgb + (size_t)v * 3, colour, share[v]);
}
