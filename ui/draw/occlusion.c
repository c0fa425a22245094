#include "draw/occlusion.h"
#include "draw/camera.h"
#include "draw/shaders.h"

#include <math.h>
#include <stdlib.h>

/* MAP: side of the depth pictures in pixels. */
enum { MAP = 256, VIEWS_MIN = 12, VIEWS_MAX = 32, SMOOTHING_PASSES = 2 };
static const uint32_t triangles_per_bake = 12u * 1000 * 1000;

typedef struct bake {
    GLuint program, texture, framebuffer;
    float *depth;           /* MAP by MAP */
    float *seen, *possible; /* vertex_count: sums of cosines */
} bake;

static mrt_result bake_init(bake *self, uint32_t vertex_count, error *err)
{
    *self = (bake){.depth = malloc(sizeof(float) * MAP * MAP),
                   .seen = calloc((size_t)vertex_count + 1, sizeof(float)),
                   .possible = calloc((size_t)vertex_count + 1, sizeof(float))};
    if (!self->depth || !self->seen || !self->possible)
        return error_set(err, MRT_ERR_MEMORY, "no memory to shade the mesh");
    const gl_source stages[] = {shaders_depth_vert, shaders_depth_frag};
    self->program = gl_program_create(stages, "", err);
    if (!self->program)
        return MRT_ERR_UNSUPPORTED;
    glGenTextures(1, &self->texture);
    glBindTexture(GL_TEXTURE_2D, self->texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, MAP, MAP, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                 NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glGenFramebuffers(1, &self->framebuffer);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, self->texture, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    return gl_check_error("the shading of the mesh", err);
}

static void bake_finish(bake *self)
{
    glDeleteProgram(self->program);
    glDeleteTextures(1, &self->texture);
    glDeleteFramebuffers(1, &self->framebuffer);
    free(self->depth);
    free(self->seen);
    free(self->possible);
}

/* Spread evenly over the sphere (Fibonacci). */
static void view_direction(float out[3], uint32_t view, uint32_t view_count)
{
    double up = 1.0 - (2.0 * view + 1.0) / view_count;
    double around = 2.399963229728653 * view, level = sqrt(1.0 - up * up);
    out[0] = (float)(level * cos(around));
    out[1] = (float)up;
    out[2] = (float)(level * sin(around));
}

static void draw_depth(const bake *self, const draw_face *face, const matrix4 *projection)
{
    glClear(GL_DEPTH_BUFFER_BIT);
    glUniformMatrix4fv(glGetUniformLocation(self->program, "projection"), 1, GL_FALSE,
                       projection->m);
    face_draw_all(face);
    gl_end_scene();
    glReadPixels(0, 0, MAP, MAP, GL_DEPTH_COMPONENT, GL_FLOAT, self->depth);
}

/* How much of the four pixels around a place in the map is not before the depth. */
static float map_visibility(const float *map, float x, float y, float depth)
{
    float fx = x * MAP - 0.5f, fy = y * MAP - 0.5f;
    if (!(fx >= 0.0f && fy >= 0.0f && fx < MAP - 1 && fy < MAP - 1))
        return 1.0f;
    int column = (int)fx, row = (int)fy;
    float tx = fx - (float)column, ty = fy - (float)row;
    const float *at = map + row * MAP + column;
    float low = (at[0] >= depth ? 1.0f - tx : 0.0f) + (at[1] >= depth ? tx : 0.0f);
    float high = (at[MAP] >= depth ? 1.0f - tx : 0.0f) + (at[MAP + 1] >= depth ? tx : 0.0f);
    return low * (1.0f - ty) + high * ty;
}

static void add_view(bake *self, const draw_face *face, const float *position,
                     const float direction[3], const matrix4 *to_map)
{
    float lift_mm = 3.0f * 2.0f * face->radius_mm / MAP; /* off its own surface */
    const float *m = to_map->m;
    for (uint32_t v = 0; v < face->vertex_count; ++v) {
        const float *p = position + (size_t)v * 3, *n = face->normal + (size_t)v * 3;
        float cosine = n[0] * direction[0] + n[1] * direction[1] + n[2] * direction[2];
        if (!(cosine > 0.0f))
            continue;
        float at[3], in_map[3];
        for (int i = 0; i < 3; ++i)
            at[i] = p[i] + n[i] * lift_mm;
        for (int i = 0; i < 3; ++i)
            in_map[i] = m[i] * at[0] + m[4 + i] * at[1] + m[8 + i] * at[2] + m[12 + i];
        self->possible[v] += cosine;
        self->seen[v] += cosine * map_visibility(self->depth, in_map[0], in_map[1], in_map[2]);
    }
}

/* Each vertex becomes the mean of itself and its triangles' corners. */
static void smooth(float *value, float *sum, float *weight, const draw_face *face)
{
    for (uint32_t v = 0; v < face->vertex_count; ++v) {
        sum[v] = 2.0f * value[v];
        weight[v] = 2.0f;
    }
    for (size_t i = 0; i < face->triangle_count; ++i) {
        const uint32_t *corner = face->triangle + i * 3;
        float mean = (value[corner[0]] + value[corner[1]] + value[corner[2]]) / 3.0f;
        for (int k = 0; k < 3; ++k) {
            sum[corner[k]] += mean;
            weight[corner[k]] += 1.0f;
        }
    }
    for (uint32_t v = 0; v < face->vertex_count; ++v)
        value[v] = sum[v] / weight[v];
}

static void look_from_all_sides(bake *self, const draw_face *face, const float *position)
{
    uint32_t view_count = triangles_per_bake / (face->triangle_count + 1);
    view_count = view_count > VIEWS_MAX   ? VIEWS_MAX
                 : view_count < VIEWS_MIN ? VIEWS_MIN
                                          : view_count;
    glUseProgram(self->program);
    glBindVertexArray(face->vertex_array);
    glViewport(0, 0, MAP, MAP);
    glEnable(GL_DEPTH_TEST);
    for (uint32_t view = 0; view < view_count; ++view) {
        float direction[3];
        view_direction(direction, view, view_count);
        matrix4 projection =
            camera_light_projection(direction, face->centre, face->radius_mm * 1.02f);
        matrix4 to_map = camera_to_texture(&projection);
        draw_depth(self, face, &projection);
        add_view(self, face, position, direction, &to_map);
    }
}

mrt_result occlusion_bake(float *out_openness, const draw_face *face, const float *position,
                          error *err)
{
    for (uint32_t v = 0; v < face->vertex_count; ++v)
        out_openness[v] = 1.0f;
    if (face->triangle_count == 0)
        return MRT_OK;
    bake self;
    mrt_result result = bake_init(&self, face->vertex_count, err);
    if (result == MRT_OK) {
        look_from_all_sides(&self, face, position);
        for (uint32_t v = 0; v < face->vertex_count; ++v)
            if (self.possible[v] > 0.0f)
                out_openness[v] = self.seen[v] / self.possible[v];
        for (int pass = 0; pass < SMOOTHING_PASSES; ++pass)
            smooth(out_openness, self.seen, self.possible, face);
        result = gl_check_error("the shading of the mesh", err);
    }
    bake_finish(&self);
    return result;
}
