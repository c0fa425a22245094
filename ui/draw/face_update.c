/* A face takes another shape: what of it has changed goes to the graphics card. */
#include "draw/face.h"

#include <math.h>

enum { BRIDGED = 2 }; /* parts that have not changed and go along, so that fewer runs are sent */

static uint32_t min_of(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

uint32_t face_parts(const draw_face *self)
{
    return self->vertex_count / DRAW_ROWS + (self->vertex_count % DRAW_ROWS != 0);
}

/* ---- the ball around it ---- */

static void measure_part(draw_face *self, const float *position, uint32_t part)
{
    uint32_t first = part * DRAW_ROWS, end = min_of(first + DRAW_ROWS, self->vertex_count);
    face_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t v = first; v < end; ++v) {
        const float *p = position + (size_t)v * 3;
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
            continue;
        for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = p[axis] < box.low[axis] ? p[axis] : box.low[axis];
            box.high[axis] = p[axis] > box.high[axis] ? p[axis] : box.high[axis];
        }
    }
    self->box[part] = box;
}

void face_measure(draw_face *self, const float *position, const stamps *changed)
{
    float square = 0.0f;
    for (uint32_t part = 0; part < face_parts(self); ++part)
        if (!changed || stamps_is_new(&self->seen, changed, part))
            measure_part(self, position, part);
    for (int axis = 0; axis < 3; ++axis) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t part = 0; part < face_parts(self); ++part) {
            const face_box *box = &self->box[part];
            low = box->low[axis] < low ? box->low[axis] : low;
            high = box->high[axis] > high ? box->high[axis] : high;
        }
        bool is_there = low <= high;
        float half = is_there ? 0.5f * (high - low) : 0.0f;
        self->centre[axis] = is_there ? low + half : 0.0f;
        square += half * half;
    }
    self->radius_mm = square > 1e-6f && isfinite(square) ? sqrtf(square) : 1e-3f;
}

/* ---- to the graphics card ---- */

static void replace(GLuint buffer, const float *value, uint32_t vertex_count)
{
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)((size_t)vertex_count * 3 * sizeof *value), value,
                 GL_STREAM_DRAW);
}

/* The end of a run of parts of which the first has changed. */
static uint32_t end_of_run(const draw_face *self, const stamps *changed, uint32_t first)
{
    uint32_t end = first + 1;
    for (uint32_t part = end; part < face_parts(self) && part <= end + BRIDGED; ++part)
        if (stamps_is_new(&self->seen, changed, part))
            end = part + 1;
    return end;
}

static void replace_changed(const draw_face *self, GLuint buffer, const float *value,
                            const stamps *changed)
{
    const size_t row_size = 3 * sizeof *value;
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    for (uint32_t part = 0; part < face_parts(self); ++part) {
        if (!stamps_is_new(&self->seen, changed, part))
            continue;
        uint32_t first = part * DRAW_ROWS;
        part = end_of_run(self, changed, part);
        uint32_t end = min_of(part * DRAW_ROWS, self->vertex_count);
        glBufferSubData(GL_ARRAY_BUFFER, (GLintptr)(first * row_size),
                        (GLsizeiptr)((end - first) * row_size), value + (size_t)first * 3);
    }
}

void draw_face_update(draw_face *self, const float *position, const float *normal)
{
    GLint bound = 0;
    glGetIntegerv(GL_ARRAY_BUFFER_BINDING, &bound);
    face_measure(self, position, NULL);
    if (!normal) {
        face_compute_normals(self, position);
        normal = self->normal;
    }
    replace(self->position_buffer, position, self->vertex_count);
    replace(self->normal_buffer, normal, self->vertex_count);
    self->seen = (stamps_reader){.seen = 0};
    glBindBuffer(GL_ARRAY_BUFFER, (GLuint)bound);
}

static uint32_t count_new(const draw_face *self, const stamps *changed)
{
    uint32_t count = 0;
    for (uint32_t part = 0; part < changed->count; ++part)
        count += stamps_is_new(&self->seen, changed, part);
    return count;
}

bool draw_face_follow(draw_face *self, const float *position, const float *normal,
                      const stamps *changed)
{
    uint32_t count = count_new(self, changed);
    if (count == 0) {
        stamps_read(&self->seen, changed);
        return false;
    }
    if (count > changed->count / 2) { /* a new buffer: nobody waits for who still draws the old */
        draw_face_update(self, position, normal);
        stamps_read(&self->seen, changed);
        return true;
    }
    GLint bound = 0;
    glGetIntegerv(GL_ARRAY_BUFFER_BINDING, &bound);
    face_measure(self, position, changed);
    replace_changed(self, self->position_buffer, position, changed);
    replace_changed(self, self->normal_buffer, normal, changed);
    stamps_read(&self->seen, changed);
    glBindBuffer(GL_ARRAY_BUFFER, (GLuint)bound);
    return true;
}
