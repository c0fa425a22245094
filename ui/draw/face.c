#include "draw/face.h"
#include "mesh/normals.h"
#include "draw/occlusion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIANGLES_MAX = 200 * 1000 * 1000 }; /* index counts must fit GLsizei */
static const float seam_cosine_given = 0.9f, seam_cosine_computed = 0.5f;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to draw the mesh");
}

static mrt_result allocate(draw_face *self, uint32_t material_count, error *err)
{
    size_t vertices = (size_t)self->vertex_count + 1;
    self->triangle = malloc(((size_t)self->triangle_count * 3 + 1) * sizeof *self->triangle);
    self->batch = calloc((size_t)material_count + 1, sizeof *self->batch);
    self->normal = malloc(vertices * 3 * sizeof *self->normal);
    self->box = malloc(((size_t)face_parts(self) + 1) * sizeof *self->box);
    bool enough = self->triangle && self->batch && self->normal && self->box;
    for (int i = 0; i < 6; ++i) {
        self->lane[i] = malloc(vertices * sizeof *self->lane[i]);
        enough = enough && self->lane[i];
    }
    return enough ? MRT_OK : no_memory(err);
}

/* Where each material's batch begins; index_count is left 0. */
static void lay_out_batches(draw_face *self, const mesh *m)
{
    self->batch_count = m->material_count;
    for (uint32_t i = 0; i < m->part_count; ++i)
        self->batch[m->part[i].material].first_index += (size_t)m->part[i].triangle_count * 3;
    size_t next = 0;
    for (uint32_t i = 0; i < m->material_count; ++i) {
        const mesh_material *look = &m->material[i];
        face_batch *batch = &self->batch[i];
        size_t index_count = batch->first_index;
        *batch = (face_batch){.first_index = next,
                              .roughness = look->roughness,
                              .metallic = look->metallic,
                              .surface = surface_of(look)};
        memcpy(batch->base_colour, look->base_colour, sizeof batch->base_colour);
        next += index_count;
    }
}

/* One batch per material, in their order; triangles keep the file's order in it. */
static void sort_by_material(draw_face *self, const mesh *m)
{
    lay_out_batches(self, m);
    for (uint32_t i = 0; i < m->part_count; ++i) {
        const mesh_part *part = &m->part[i];
        face_batch *batch = &self->batch[part->material];
        size_t first = batch->first_index + (size_t)batch->index_count;
        memcpy(self->triangle + first, m->triangle + (size_t)part->first_triangle * 3,
               (size_t)part->triangle_count * 3 * sizeof *self->triangle);
        batch->index_count += (GLsizei)(part->triangle_count * 3);
    }
    if (m->triangle_count == 0) { /* points */
        self->batch_count = 1;
        self->batch[0] = (face_batch){.base_colour = {0.6f, 0.6f, 0.6f, 1.0f}, .roughness = 0.7f};
    }
}

void face_compute_normals(draw_face *self, const float *position)
{
    float *const *lane = self->lane;
    for (uint32_t v = 0; v < self->vertex_count; ++v)
        for (int axis = 0; axis < 3; ++axis)
            lane[axis][v] = position[(size_t)v * 3 + (size_t)axis];
    normals_smooth(lane[3], lane[4], lane[5], lane[0], lane[1], lane[2], self->vertex_count,
                   self->triangle, self->triangle_count);
    seams_join(&self->seam, lane[3], lane[4], lane[5]);
    for (uint32_t v = 0; v < self->vertex_count; ++v)
        for (int axis = 0; axis < 3; ++axis)
            self->normal[(size_t)v * 3 + (size_t)axis] = lane[3 + axis][v];
}

static GLuint add_buffer(GLenum target, size_t size, const void *data, GLenum usage)
{
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    glBindBuffer(target, buffer);
    glBufferData(target, (GLsizeiptr)size, data, usage);
    return buffer;
}

static GLuint add_attribute(GLuint index, GLint component_count, uint32_t vertex_count,
                            const float *value, GLenum usage)
{
    size_t size = (size_t)vertex_count * (size_t)component_count * sizeof *value;
    GLuint buffer = add_buffer(GL_ARRAY_BUFFER, size, value, usage);
    glVertexAttribPointer(index, component_count, GL_FLOAT, GL_FALSE, 0, NULL);
    glEnableVertexAttribArray(index);
    return buffer;
}

static mrt_result upload(draw_face *self, const float *position, error *err)
{
    uint32_t count = self->vertex_count;
    glGenVertexArrays(1, &self->vertex_array);
    glBindVertexArray(self->vertex_array);
    self->position_buffer = add_attribute(FACE_POSITION, 3, count, position, GL_STREAM_DRAW);
    self->normal_buffer = add_attribute(FACE_NORMAL, 3, count, self->normal, GL_STREAM_DRAW);
    self->rest_buffer = add_attribute(FACE_REST, 3, count, position, GL_STATIC_DRAW);
    self->index_buffer = add_buffer(GL_ELEMENT_ARRAY_BUFFER,
                                    (size_t)self->triangle_count * 3 * sizeof *self->triangle,
                                    self->triangle, GL_STATIC_DRAW);
    return gl_check_error("the mesh", err);
}

static mrt_result add_openness(draw_face *self, const float *position, error *err)
{
    float *openness = malloc(((size_t)self->vertex_count + 1) * sizeof *openness);
    if (!openness)
        return no_memory(err);
    mrt_result result = occlusion_bake(openness, self, position, err);
    if (result == MRT_OK) {
        glBindVertexArray(self->vertex_array);
        self->openness_buffer =
            add_attribute(FACE_OPENNESS, 1, self->vertex_count, openness, GL_STATIC_DRAW);
        result = gl_check_error("the mesh", err);
    }
    free(openness);
    return result;
}

static mrt_result fill(draw_face *self, const mesh *m, error *err)
{
    mrt_result result = allocate(self, m->material_count, err);
    if (result != MRT_OK)
        return result;
    sort_by_material(self, m);
    face_measure(self, m->position, NULL);
    float low[3], high[3];
    mesh_bounds(m, low, high);
    self->height_mm = high[1] - low[1] > self->radius_mm ? high[1] - low[1] : self->radius_mm;
    face_compute_normals(self, m->position); /* no seams yet */
    const float *normal = m->normal ? m->normal : self->normal;
    result = seams_init(&self->seam, m->position, normal, m->vertex_count,
                        m->normal ? seam_cosine_given : seam_cosine_computed, err);
    if (result != MRT_OK)
        return result;
    if (m->normal)
        memcpy(self->normal, m->normal, (size_t)m->vertex_count * 3 * sizeof *self->normal);
    else
        face_compute_normals(self, m->position);
    result = upload(self, m->position, err);
    return result == MRT_OK ? add_openness(self, m->position, err) : result;
}

draw_face *draw_face_create(const mesh *m, error *err)
{
    if (gl_check_current(err) != MRT_OK || mesh_validate(m, err) != MRT_OK)
        return NULL;
    if (m->triangle_count > TRIANGLES_MAX) {
        error_set(err, MRT_ERR_UNSUPPORTED, "a mesh of %u triangles cannot be drawn: at most %d",
                  m->triangle_count, TRIANGLES_MAX);
        return NULL;
    }
    draw_face *self = calloc(1, sizeof *self);
    if (!self) {
        no_memory(err);
        return NULL;
    }
    self->vertex_count = m->vertex_count;
    self->triangle_count = m->triangle_count;
    gl_state before;
    gl_state_enter(&before);
    mrt_result result = fill(self, m, err);
    gl_state_leave(&before);
    if (result == MRT_OK)
        return self;
    draw_face_destroy(self);
    return NULL;
}

void draw_face_destroy(draw_face *self)
{
    if (!self)
        return;
    GLuint buffers[] = {self->position_buffer, self->normal_buffer, self->rest_buffer,
                        self->openness_buffer, self->index_buffer,  self->colour_buffer};
    if (self->vertex_array) {
        glDeleteVertexArrays(1, &self->vertex_array);
        glDeleteBuffers((GLsizei)(sizeof buffers / sizeof *buffers), buffers);
    }
    seams_finish(&self->seam);
    for (int i = 0; i < 6; ++i)
        free(self->lane[i]);
    free(self->box);
    free(self->normal);
    free(self->triangle);
    free(self->batch);
    free(self);
}

void draw_face_colour(draw_face *self, const float *rgb)
{
    gl_state before;
    gl_state_enter(&before);
    glBindVertexArray(self->vertex_array);
    glDisableVertexAttribArray(FACE_COLOUR);
    glDeleteBuffers(1, &self->colour_buffer);
    self->colour_buffer = 0;
    if (rgb)
        self->colour_buffer =
            add_attribute(FACE_COLOUR, 3, self->vertex_count, rgb, GL_STATIC_DRAW);
    gl_state_leave(&before);
}

void face_draw_all(const draw_face *face)
{
    if (face->triangle_count)
        glDrawElements(GL_TRIANGLES, (GLsizei)(face->triangle_count * 3), GL_UNSIGNED_INT, NULL);
    else
        glDrawArrays(GL_POINTS, 0, (GLsizei)face->vertex_count);
}
