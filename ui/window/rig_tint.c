#include "window/rig_tint.h"

#include <math.h>
#include <string.h>

static const float plain[3] = {0.20f, 0.195f, 0.19f};
static const float mobile[3] = {0.10f, 0.42f, 0.24f};
static const float still_part = 0.25f; /* of its colour, where nothing can be pulled */

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

static uint32_t to_screen(float linear)
{
    float coded =
        linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f;
    return (uint32_t)(coded * 255.0f + 0.5f);
}

uint32_t rig_tint_chip(const rig *r, uint32_t bone)
{
    float rgb[3];
    rig_tint_of_bone(rgb, r, bone);
    return to_screen(rgb[0]) << 24 | to_screen(rgb[1]) << 16 | to_screen(rgb[2]) << 8 | 0xffu;
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
