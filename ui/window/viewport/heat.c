#include "window/viewport/heat.h"
#include "window/gui/theme.h"

#include <math.h>
#include <stdlib.h>

enum { BONE_COLORS = 8 };

struct viewport_heat {
    const face_file *file;
    binding binding;
    float *rest_area; /* vertex_count; area of the triangles around each vertex, mm2 */
    float *area;      /* scratch */
};

/* sRGB colours; drawing converts them to linear. */
static const uint32_t bone_color[BONE_COLORS] = {0x4f7fb8ffu, 0xc96a55ffu, 0x6fae8cffu,
                                                 0xb98fc4ffu, 0xd2b45affu, 0x5fb0b5ffu,
                                                 0xc98aa0ffu, 0x8f9a5fffu};
static const viewport_heat_legend legends[APP_HEATS] = {
    [APP_HEAT_NONE] = {.title = ""},
    [APP_HEAT_WEIGHTS] = {.title = "Bones"},
    [APP_HEAT_MOBILITY] = {.title = "Mobility",
                           .low = "0 % rigid",
                           .high = "100 % free",
                           .stop = {0x2b2f38ffu, 0x4b4a4dffu, 0x7c6b4dffu, 0xb08b46ffu,
                                    0xe8c46bffu}},
    [APP_HEAT_STRAIN] = {.title = "Strain",
                         .low = "50 % area",
                         .mid = "100 %",
                         .high = "200 %",
                         .stop = {0x3f7fd6ffu, 0x5f86b4ffu, 0x83868cffu, 0xc08a55ffu, 0xe8843affu}},
    [APP_HEAT_PENETRATION] = {.title = "Approach to skull",
                              .low = "0 % at rest",
                              .high = "100 % touches",
                              .stop = {0x5f6670ffu, 0x847a62ffu, 0xb98a48ffu, 0xd9683fffu,
                                       0xe23a34ffu}},
};

static const double floor_part = 0.4, floor_most_mm = 2.0, proxy_reach_mm = 60.0;

static float channel(uint32_t colour, int index)
{
    return (float)theme_linear(colour >> (24 - 8 * index));
}

static void set_colour(float out[3], uint32_t colour)
{
    for (int i = 0; i < 3; ++i)
        out[i] = channel(colour, i);
}

typedef struct ramp {
    float stop[VIEWPORT_HEAT_STOPS][3];
} ramp;

static ramp ramp_of(app_heat kind)
{
    ramp r;
    for (int i = 0; i < VIEWPORT_HEAT_STOPS; ++i)
        set_colour(r.stop[i], legends[kind].stop[i]);
    return r;
}

/* Interpolates a ramp. share: 0..1; NaN counts as 0. */
static void ramp_at(float out[3], const ramp *r, float share)
{
    float position =
        (share > 0.0f ? share < 1.0f ? share : 1.0f : 0.0f) * (VIEWPORT_HEAT_STOPS - 1);
    int low = position < VIEWPORT_HEAT_STOPS - 1 ? (int)position : VIEWPORT_HEAT_STOPS - 2;
    float part = position - (float)low;
    for (int i = 0; i < 3; ++i)
        out[i] = r->stop[low][i] + part * (r->stop[low + 1][i] - r->stop[low][i]);
}

/* ---- creation ---- */

static void add_areas(float *out, const mesh *m, const float *position)
{
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        out[v] = 0.0f;
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        const uint32_t *corner = m->triangle + (size_t)t * 3;
        const float *a = position + (size_t)corner[0] * 3, *b = position + (size_t)corner[1] * 3;
        const float *c = position + (size_t)corner[2] * 3;
        float x = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
        float y = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
        float z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        float area = 0.5f * sqrtf(x * x + y * y + z * z);
        for (int i = 0; i < 3; ++i)
            out[corner[i]] += area;
    }
}

mrt_result viewport_heat_create(viewport_heat **out, const face_file *file, error *err)
{
    *out = NULL;
    viewport_heat *self = calloc(1, sizeof *self);
    size_t vertices = (size_t)file->mesh.vertex_count + 1;
    if (self) {
        self->file = file;
        self->rest_area = malloc(vertices * sizeof *self->rest_area);
        self->area = malloc(vertices * sizeof *self->area);
    }
    mrt_result result = MRT_OK;
    if (!self || !self->rest_area || !self->area)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the colours of the face");
    else
        result = binding_create(&self->binding, file->rig, &file->mesh, &file->topology, err);
    if (result < 0) {
        viewport_heat_destroy(self);
        return result;
    }
    add_areas(self->rest_area, &file->mesh, file->mesh.position);
    *out = self;
    return MRT_OK;
}

void viewport_heat_destroy(viewport_heat *self)
{
    if (!self)
        return;
    binding_destroy(&self->binding);
    free(self->rest_area);
    free(self->area);
    free(self);
}

/* ---- colours ---- */

static void colour_weights(const viewport_heat *self, float *out_rgb)
{
    const binding *b = &self->binding;
    for (uint32_t v = 0; v < b->vertex_count; ++v) {
        float *rgb = out_rgb + (size_t)v * 3;
        rgb[0] = rgb[1] = rgb[2] = 0.0f;
        for (uint32_t bone = 0; bone < b->bone_count; ++bone) {
            float weight = b->weight[(size_t)bone * b->vertex_count + v];
            for (int i = 0; i < 3 && weight > 0.0f; ++i)
                rgb[i] += weight * channel(bone_color[bone % BONE_COLORS], i);
        }
    }
}

static void colour_mobility(const viewport_heat *self, float *out_rgb)
{
    const ramp r = ramp_of(APP_HEAT_MOBILITY);
    for (uint32_t v = 0; v < self->binding.vertex_count; ++v)
        ramp_at(out_rgb + (size_t)v * 3, &r, self->binding.mobility[v]);
}

static void colour_strain(const viewport_heat *self, float *out_rgb, const float *position)
{
    const ramp r = ramp_of(APP_HEAT_STRAIN);
    add_areas(self->area, &self->file->mesh, position);
    for (uint32_t v = 0; v < self->binding.vertex_count; ++v) {
        float rest = self->rest_area[v], ratio = rest > 0.0f ? self->area[v] / rest : 1.0f;
        ramp_at(out_rgb + (size_t)v * 3, &r, 0.5f + 0.5f * log2f(ratio > 1e-6f ? ratio : 1e-6f));
    }
}

/* Returns the height above an ellipsoid along the line from its centre, mm. */
static double height_mm(const rig_proxy *proxy, vec3 at)
{
    vec3 from = vec3_sub(at, proxy->centre);
    double x = from.x / proxy->radii.x, y = from.y / proxy->radii.y, z = from.z / proxy->radii.z;
    double size = sqrt(x * x + y * y + z * z);
    return size > 1e-9 ? vec3_length(from) * (1.0 - 1.0 / size) : -proxy->radii.z;
}

static vec3 vertex_of(const float *position, uint32_t v)
{
    const float *p = position + (size_t)v * 3;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

/* Returns how far a vertex has moved from its neutral height towards the floor above this proxy, as
 * a share of that distance. Returns 0 if the proxy does not apply. */
static double share_gone(const rig_proxy *proxy, const rigid *into, vec3 rest, vec3 now)
{
    double at_rest = height_mm(proxy, rest);
    if (proxy->kind == PROXY_TEETH) /* not an ellipsoid */
        return 0.0;
    if (!(at_rest > 0.0 && at_rest < proxy_reach_mm))
        return 0.0;
    double floor = fmin(floor_part * at_rest, floor_most_mm);
    double height = height_mm(proxy, rigid_apply(into, now));
    return fmax((at_rest - height) / (at_rest - floor), 0.0);
}

static void colour_skull(const viewport_heat *self, float *out_rgb, const float *position,
                         const rigid *bone)
{
    const ramp colours = ramp_of(APP_HEAT_PENETRATION);
    const rig *r = self->file->rig;
    uint32_t proxy_count = r ? r->proxy_count : 0;
    rigid into[RIG_BONES_MAX];
    for (uint32_t b = 0; r && b < r->bone_count && b < RIG_BONES_MAX; ++b)
        into[b] = rigid_inverse(&bone[b]);
    for (uint32_t v = 0; v < self->binding.vertex_count; ++v) {
        float *rgb = out_rgb + (size_t)v * 3;
        vec3 rest = vertex_of(self->file->mesh.position, v), now = vertex_of(position, v);
        double most = 0.0;
        for (uint32_t p = 0; p < proxy_count && self->binding.mobility[v] > 0.0f; ++p) {
            const rig_proxy *proxy = &r->proxy[p];
            most = fmax(most, share_gone(proxy, &into[proxy->bone], rest, now));
        }
        ramp_at(rgb, &colours, (float)most);
    }
}

void viewport_heat_colour(const viewport_heat *self, float *out_rgb, app_heat kind,
                          const float *position, const rigid *bone)
{
    if (kind == APP_HEAT_WEIGHTS)
        colour_weights(self, out_rgb);
    else if (kind == APP_HEAT_MOBILITY)
        colour_mobility(self, out_rgb);
    else if (kind == APP_HEAT_STRAIN)
        colour_strain(self, out_rgb, position);
    else if (kind == APP_HEAT_PENETRATION)
        colour_skull(self, out_rgb, position, bone);
}

bool viewport_heat_is_fixed(app_heat kind)
{
    return kind == APP_HEAT_WEIGHTS || kind == APP_HEAT_MOBILITY;
}

/* ---- legends ---- */

void viewport_heat_legend_of(const viewport_heat *self, app_heat kind, viewport_heat_legend *out)
{
    *out = legends[kind];
    if (kind == APP_HEAT_WEIGHTS)
        out->bone_count = self->binding.bone_count;
}

uint32_t viewport_heat_bone(const viewport_heat *self, uint32_t bone, const char **out_name)
{
    const rig *r = self->file->rig;
    *out_name = r && bone < r->bone_count ? r->bone[bone].name : "face";
    return bone_color[bone % BONE_COLORS];
}
