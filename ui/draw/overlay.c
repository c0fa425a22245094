#include "draw/overlay.h"

#include "draw/camera.h"
#include "draw/face.h"
#include "draw/gl.h"
#include "draw/target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- where a ray hits the face ---- */

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

static const float edge = 1e-4f; /* tolerance, so that no ray passes between two triangles */

/* Möller and Trumbore 1997, for triangles that face the eye. share: barycentric coordinates of the
 * second and third corner. NaN gives no hit. */
static bool meets(const ray *r, const float *a, const float *b, const float *c, float share[2],
                  float *out_distance)
{
    float ab[3], ac[3], across[3], from[3], turned[3];
    subtract3(ab, b, a);
    subtract3(ac, c, a);
    cross3(across, r->way, ac);
    float facing = dot3(ab, across); /* twice the area of the triangle, seen along the ray */
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

/* ---- items ---- */

static void set_point(float out[3], vec3 at)
{
    out[0] = (float)at.x;
    out[1] = (float)at.y;
    out[2] = (float)at.z;
}

overlay_item overlay_line(vec3 from, vec3 to, float width_px, const float rgba[4])
{
    overlay_item out = {.kind = OVERLAY_LINE, .width_px = width_px};
    set_point(out.from, from);
    set_point(out.to, to);
    memcpy(out.rgba, rgba, sizeof out.rgba);
    return out;
}

overlay_item overlay_dot(vec3 at, float width_px, const float rgba[4])
{
    overlay_item out = overlay_line(at, at, width_px, rgba);
    out.kind = OVERLAY_DOT;
    return out;
}

typedef struct overlays_view { /* values of one drawing */
    draw_camera camera;        /* with valid numbers */
    matrix4 projection;        /* the same as that of the face */
    uint32_t width, height;    /* size of the rectangle */
    float lift_mm;             /* offset of lines and dots towards the eye */
    float to_light[3];
} overlays_view;

enum { SIDES = 16, RINGS = 5, RING_POINTS = 64, SPHERE_RINGS = 3 };
enum { CAPSULE_ROWS = 2 * RINGS, CAPSULE_VERTICES = CAPSULE_ROWS * SIDES };
enum { CAPSULE_INDICES = (CAPSULE_ROWS - 1) * SIDES * 6 };

/* Opacity of items that the face hides. */
static const float hidden_solid = 0.22f, hidden_line = 0.45f, hidden_ring = 0.15f;
static const float bone_taper = 0.7f;

typedef struct line_instance {
    float from[3], to[3], width_px[2], ink[4], is_cut;
} line_instance;

typedef struct solid_instance {
    float from[3], to[3], radius_mm[2], ink[4], is_skin;
} solid_instance;

typedef struct overlays_program {
    GLuint program, vertex_array, instance_buffer;
    GLint projection, eye, strength, lift_mm, size, to_light;
} overlays_program;

struct overlays {
    overlays_program line, solid;
    GLuint shape_buffer, index_buffer;
    line_instance *lines;
    solid_instance *solids;                         /* bones and balls first, then skins */
    uint32_t line_count, ring_count, line_capacity; /* pieces of rings first */
    uint32_t solid_count, skin_count, solid_capacity;
};

/* ---- creation ---- */

static mrt_result create_program(overlays_program *out, const gl_source *stages, error *err)
{
    out->program = gl_program_create(stages, "", err);
    if (!out->program)
        return MRT_ERR_UNSUPPORTED;
    out->projection = glGetUniformLocation(out->program, "projection");
    out->eye = glGetUniformLocation(out->program, "eye");
    out->strength = glGetUniformLocation(out->program, "strength");
    out->lift_mm = glGetUniformLocation(out->program, "lift_mm");
    out->size = glGetUniformLocation(out->program, "size");
    out->to_light = glGetUniformLocation(out->program, "to_light");
    glGenVertexArrays(1, &out->vertex_array);
    glBindVertexArray(out->vertex_array);
    glGenBuffers(1, &out->instance_buffer);
    glBindBuffer(GL_ARRAY_BUFFER, out->instance_buffer);
    return MRT_OK;
}

static void add_attribute(GLuint index, GLint component_count, size_t stride, size_t offset)
{
    glVertexAttribPointer(index, component_count, GL_FLOAT, GL_FALSE, (GLsizei)stride,
                          (const void *)offset);
    glVertexAttribDivisor(index, 1);
    glEnableVertexAttribArray(index);
}

static void point_at_lines(size_t start)
{
    size_t stride = sizeof(line_instance);
    add_attribute(0, 3, stride, start + offsetof(line_instance, from));
    add_attribute(1, 3, stride, start + offsetof(line_instance, to));
    add_attribute(2, 2, stride, start + offsetof(line_instance, width_px));
    add_attribute(3, 4, stride, start + offsetof(line_instance, ink));
    add_attribute(4, 1, stride, start + offsetof(line_instance, is_cut));
}

static void point_at_solids(size_t start)
{
    size_t stride = sizeof(solid_instance);
    add_attribute(1, 3, stride, start + offsetof(solid_instance, from));
    add_attribute(2, 3, stride, start + offsetof(solid_instance, to));
    add_attribute(3, 2, stride, start + offsetof(solid_instance, radius_mm));
    add_attribute(4, 4, stride, start + offsetof(solid_instance, ink));
    add_attribute(5, 1, stride, start + offsetof(solid_instance, is_skin));
}

/* Makes rows of vertices from the pole behind `from` to the one beyond `to`. The row of the equator
 * is doubled. */
static void shape_capsule(float (*out)[4], uint16_t *out_index)
{
    const double pi = 3.14159265358979;
    for (int row = 0; row < CAPSULE_ROWS; ++row) {
        int ring = row < RINGS ? row : row - 1;
        double up = pi * ring / (CAPSULE_ROWS - 2) - 0.5 * pi;
        for (int side = 0; side < SIDES; ++side) {
            double around = 2.0 * pi * side / SIDES;
            float *vertex = out[row * SIDES + side];
            vertex[0] = (float)(cos(up) * cos(around));
            vertex[1] = (float)(cos(up) * sin(around));
            vertex[2] = (float)sin(up);
            vertex[3] = row < RINGS ? 0.0f : 1.0f;
        }
    }
    for (int row = 0; row + 1 < CAPSULE_ROWS; ++row)
        for (int side = 0; side < SIDES; ++side) {
            int here = row * SIDES + side, next = row * SIDES + (side + 1) % SIDES;
            const int corner[6] = {here, next, here + SIDES, next, next + SIDES, here + SIDES};
            for (int i = 0; i < 6; ++i)
                *out_index++ = (uint16_t)corner[i];
        }
}

static void create_capsule(overlays *self)
{
    float shape[CAPSULE_VERTICES][4];
    uint16_t index[CAPSULE_INDICES];
    shape_capsule(shape, index);
    glGenBuffers(1, &self->shape_buffer);
    glBindBuffer(GL_ARRAY_BUFFER, self->shape_buffer);
    glBufferData(GL_ARRAY_BUFFER, sizeof shape, shape, GL_STATIC_DRAW);
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof shape[0], NULL);
    glEnableVertexAttribArray(0);
    glGenBuffers(1, &self->index_buffer);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, self->index_buffer);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof index, index, GL_STATIC_DRAW);
}

static mrt_result create_drawing(overlays *self, error *err)
{
    const gl_source line[] = {shaders_overlay_line_vert, shaders_overlay_line_frag};
    const gl_source solid[] = {shaders_overlay_solid_vert, shaders_overlay_solid_frag};
    mrt_result result = create_program(&self->line, line, err);
    if (result != MRT_OK)
        return result;
    point_at_lines(0);
    result = create_program(&self->solid, solid, err);
    if (result != MRT_OK)
        return result;
    point_at_solids(0);
    create_capsule(self);
    return gl_check_error("the overlays", err);
}

overlays *overlays_create(error *err)
{
    overlays *self = calloc(1, sizeof *self);
    if (!self) {
        error_set(err, MRT_ERR_MEMORY, "no memory for overlays");
        return NULL;
    }
    if (create_drawing(self, err) == MRT_OK)
        return self;
    overlays_destroy(self);
    return NULL;
}

static void destroy_program(overlays_program *program)
{
    glDeleteProgram(program->program);
    glDeleteBuffers(1, &program->instance_buffer);
    glDeleteVertexArrays(1, &program->vertex_array);
}

void overlays_destroy(overlays *self)
{
    if (!self)
        return;
    destroy_program(&self->line);
    destroy_program(&self->solid);
    glDeleteBuffers(1, &self->shape_buffer);
    glDeleteBuffers(1, &self->index_buffer);
    free(self->lines);
    free(self->solids);
    free(self);
}

/* ---- from items to instances ---- */

/* Returns false if there is no memory. Items that do not fit are then left out. */
static bool reserve(void **array, uint32_t *capacity, uint32_t wanted, size_t size)
{
    if (wanted <= *capacity)
        return true;
    uint32_t more = wanted + wanted / 2 + 64;
    void *grown = realloc(*array, more * size);
    if (!grown)
        return false;
    *array = grown;
    *capacity = more;
    return true;
}

static void copy3(float out[3], const float in[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = in[i];
}

static void add_line(overlays *self, const overlay_item *item, const float from[3],
                     const float to[3], float width_from, float width_to)
{
    line_instance *line = &self->lines[self->line_count++];
    copy3(line->from, from);
    copy3(line->to, to);
    line->width_px[0] = width_from;
    line->width_px[1] = width_to;
    line->is_cut = item->kind == OVERLAY_SPHERE;
    for (int i = 0; i < 4; ++i)
        line->ink[i] = item->rgba[i];
}

static float mm_per_pixel(const overlays_view *view, const float at[3])
{
    float right[3], up[3], back[3], eye[3], depth = 0.0f;
    camera_axes_of(&view->camera, right, up, back);
    camera_eye(&view->camera, eye);
    for (int i = 0; i < 3; ++i)
        depth += (eye[i] - at[i]) * back[i];
    float slope = tanf(0.5f * view->camera.field_of_view_rad);
    return 2.0f * slope * fmaxf(depth, 0.0f) / (float)view->height;
}

static void add_arrow(overlays *self, const overlays_view *view, const overlay_item *item)
{
    float way[3], neck[3], squared = 0.0f;
    for (int i = 0; i < 3; ++i) {
        way[i] = item->to[i] - item->from[i];
        squared += way[i] * way[i];
    }
    float length = sqrtf(squared);
    float head = (3.0f * item->width_px + 3.0f) * mm_per_pixel(view, item->to);
    float share = length > 0.0f ? fminf(head / length, 0.7f) : 0.0f;
    for (int i = 0; i < 3; ++i)
        neck[i] = item->to[i] - share * way[i];
    add_line(self, item, item->from, neck, item->width_px, item->width_px);
    add_line(self, item, neck, item->to, 3.4f * item->width_px, 0.0f);
}

static void add_rings(overlays *self, const overlay_item *item)
{
    const float step = 6.28318531f / RING_POINTS;
    for (int ring = 0; ring < SPHERE_RINGS; ++ring) {
        float from[3], to[3];
        for (int i = 0; i <= RING_POINTS; ++i) {
            copy3(from, to);
            copy3(to, item->from);
            to[(ring + 1) % 3] += item->radius_mm * cosf(step * (float)i);
            to[(ring + 2) % 3] += item->radius_mm * sinf(step * (float)i);
            if (i > 0)
                add_line(self, item, from, to, item->width_px, item->width_px);
        }
    }
}

static void add_solid(overlays *self, const overlay_item *item)
{
    solid_instance *solid = &self->solids[self->solid_count++];
    bool is_bone = item->kind == OVERLAY_BONE;
    copy3(solid->from, item->from);
    copy3(solid->to, is_bone ? item->to : item->from);
    solid->radius_mm[0] = item->radius_mm;
    solid->radius_mm[1] = is_bone ? bone_taper * item->radius_mm : item->radius_mm;
    for (int i = 0; i < 4; ++i)
        solid->ink[i] = item->rgba[i];
    solid->is_skin = item->kind == OVERLAY_SPHERE;
}

static void add_lines_of(overlays *self, const overlays_view *view, const overlay_item *item)
{
    if (item->kind == OVERLAY_ARROW)
        add_arrow(self, view, item);
    else if (item->kind == OVERLAY_LINE)
        add_line(self, item, item->from, item->to, item->width_px, item->width_px);
    else if (item->kind == OVERLAY_DOT)
        add_line(self, item, item->from, item->from, item->width_px, item->width_px);
}

static uint32_t lines_at_most(const overlay_item *item, uint32_t count)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < count; ++i)
        most += item[i].kind == OVERLAY_SPHERE ? SPHERE_RINGS * RING_POINTS : 2;
    return most;
}

static void make_instances(overlays *self, const overlays_view *view, const overlay_item *item,
                           uint32_t count)
{
    self->line_count = self->ring_count = self->solid_count = self->skin_count = 0;
    if (!reserve((void **)&self->lines, &self->line_capacity, lines_at_most(item, count),
                 sizeof *self->lines) ||
        !reserve((void **)&self->solids, &self->solid_capacity, count, sizeof *self->solids))
        return;
    for (uint32_t i = 0; i < count; ++i)
        if (item[i].kind == OVERLAY_SPHERE)
            add_rings(self, &item[i]);
    self->ring_count = self->line_count;
    for (uint32_t i = 0; i < count; ++i) {
        if (item[i].kind == OVERLAY_BONE || item[i].kind == OVERLAY_BALL)
            add_solid(self, &item[i]);
        add_lines_of(self, view, &item[i]);
    }
    uint32_t opaque_count = self->solid_count;
    for (uint32_t i = 0; i < count; ++i)
        if (item[i].kind == OVERLAY_SPHERE)
            add_solid(self, &item[i]);
    self->skin_count = self->solid_count - opaque_count;
}

/* ---- drawing ---- */

static void load(const overlays_program *program, const overlays_view *view, const void *instances,
                 size_t size)
{
    float eye[3];
    camera_eye(&view->camera, eye);
    glUseProgram(program->program);
    glUniformMatrix4fv(program->projection, 1, GL_FALSE, view->projection.m);
    glUniform3fv(program->eye, 1, eye);
    glUniform3fv(program->to_light, 1, view->to_light);
    glUniform1f(program->lift_mm, view->lift_mm);
    glUniform2f(program->size, (GLfloat)view->width, (GLfloat)view->height);
    glBindBuffer(GL_ARRAY_BUFFER, program->instance_buffer);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)size, instances, GL_STREAM_DRAW);
}

static void draw_lines(const overlays *self, uint32_t first, uint32_t count, float strength)
{
    if (count == 0)
        return;
    glUseProgram(self->line.program);
    glUniform1f(self->line.strength, strength);
    glBindVertexArray(self->line.vertex_array);
    glBindBuffer(GL_ARRAY_BUFFER, self->line.instance_buffer);
    point_at_lines(first * sizeof(line_instance));
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)count);
}

static void draw_solids(const overlays *self, uint32_t first, uint32_t count, float strength)
{
    if (count == 0)
        return;
    glUseProgram(self->solid.program);
    glUniform1f(self->solid.strength, strength);
    glBindVertexArray(self->solid.vertex_array);
    glBindBuffer(GL_ARRAY_BUFFER, self->solid.instance_buffer);
    point_at_solids(first * sizeof(solid_instance));
    glDrawElementsInstanced(GL_TRIANGLES, CAPSULE_INDICES, GL_UNSIGNED_SHORT, NULL, (GLsizei)count);
}

static void draw_hidden(const overlays *self, uint32_t opaque_count)
{
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_GREATER);
    glEnable(GL_CULL_FACE);
    draw_solids(self, 0, opaque_count, hidden_solid);
    glDisable(GL_CULL_FACE);
    draw_lines(self, 0, self->ring_count, hidden_ring);
    draw_lines(self, self->ring_count, self->line_count - self->ring_count, hidden_line);
}

/* Writes the depth of the solids first, so that a transparent one does not show its own back. */
static void draw_visible(const overlays *self, uint32_t opaque_count)
{
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LEQUAL);
    glEnable(GL_CULL_FACE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_solids(self, 0, opaque_count, 1.0f);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    draw_solids(self, 0, opaque_count, 1.0f);
    glDepthMask(GL_FALSE);
    draw_solids(self, opaque_count, self->skin_count, 1.0f);
    glDisable(GL_CULL_FACE);
    draw_lines(self, 0, self->line_count, 1.0f);
}

static const float lift_share = 0.008f; /* share of the height of the face */

void overlays_draw(overlays *self, draw_target *target, const draw_face *face,
                   const draw_camera *camera, const float to_light[3], const uint32_t rectangle[4],
                   const overlay_item *item, uint32_t count)
{
    GLint viewport[4];
    if (count == 0 || !target_viewport(viewport, target, rectangle))
        return;
    overlays_view view = {.camera = *camera,
                          .width = rectangle[2],
                          .height = rectangle[3],
                          .lift_mm = lift_share * face->height_mm,
                          .to_light = {to_light[0], to_light[1], to_light[2]}};
    view.projection = camera_projection(camera, (float)view.width / (float)view.height,
                                        face->centre, face->radius_mm);
    gl_state before;
    gl_state_enter(&before);
    target_begin(target, viewport);
    make_instances(self, &view, item, count);
    uint32_t opaque_count = self->solid_count - self->skin_count;
    load(&self->line, &view, self->lines, self->line_count * sizeof *self->lines);
    load(&self->solid, &view, self->solids, self->solid_count * sizeof *self->solids);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_DEPTH_CLAMP);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glCullFace(GL_BACK);
    draw_hidden(self, opaque_count);
    draw_visible(self, opaque_count);
    gl_state_leave(&before);
}
