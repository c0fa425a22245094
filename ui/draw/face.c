#include "draw/face.h"

#include "draw/camera.h"
#include "mesh/normals.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- ambient occlusion of each vertex ---- */

/* MAP: side of the depth pictures in pixels. */
enum { MAP = 256, VIEWS_MIN = 12, VIEWS_MAX = 32, SMOOTHING_PASSES = 2 };
static const uint32_t triangles_per_bake = 12u * 1000 * 1000;
static const float open_mouth = 0.7f; /* openness of teeth between parted lips */

typedef struct bake {
    GLuint program, texture, framebuffer;
    float *depth;              /* MAP by MAP */
    float *visible, *possible; /* vertex_count: sums of cosines */
} bake;

static mrt_result bake_init(bake *self, uint32_t vertex_count, error *err)
{
    *self = (bake){.depth = malloc(sizeof(float) * MAP * MAP),
                   .visible = calloc((size_t)vertex_count + 1, sizeof(float)),
                   .possible = calloc((size_t)vertex_count + 1, sizeof(float))};
    if (!self->depth || !self->visible || !self->possible)
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
    free(self->visible);
    free(self->possible);
}

/* Returns directions that are spread evenly over the sphere (Fibonacci). */
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

/* Returns the visible share of a point: how much of the four pixels around it is not nearer than
 * `depth`. */
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
    float lift_mm = 3.0f * 2.0f * face->radius_mm / MAP; /* lifts the point off its own surface */
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
        self->visible[v] += cosine * map_visibility(self->depth, in_map[0], in_map[1], in_map[2]);
    }
}

/* Replaces each vertex by the mean of itself and the corners of its triangles. */
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

static void light_mouth(float *openness, const draw_face *face)
{
    for (uint32_t i = 0; i < face->batch_count; ++i) {
        const face_batch *batch = &face->batch[i];
        const uint32_t *vertex = face->triangle + batch->first_index;
        for (GLsizei k = 0; batch->surface.is_in_mouth && k < batch->index_count; ++k)
            openness[vertex[k]] = fmaxf(openness[vertex[k]], open_mouth);
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
                out_openness[v] = self.visible[v] / self.possible[v];
        for (int pass = 0; pass < SMOOTHING_PASSES; ++pass)
            smooth(out_openness, self.visible, self.possible, face);
        light_mouth(out_openness, face);
        result = gl_check_error("the shading of the mesh", err);
    }
    bake_finish(&self);
    return result;
}

/* ---- the face ---- */

/* ---- surfaces ---- */

static const float dry_roughness = 0.8f;  /* rougher materials get a grain */
static const float hard_roughness = 0.4f; /* smoother materials let no light in */

static const char *const felt_words[] = {"felt",    "fleece", "wool",   "fur",  "hair",
                                         "cloth",   "foam",   "fabric", "skin", "brow",
                                         "eyebrow", "lid",    "eyelid", "ear"};
static const char *const shorn_words[] = {"lid", "eyelid", "lip"}; /* thin felt without fuzz */
static const char *const stone_words[] = {"stone", "rock", "moai", "clay", "plaster", "concrete"};
static const char *const mouth_words[] = {"tooth", "teeth", "gum", "tongue", "mouth"};
static const char *const eye_words[] = {"eye", "eyeball", "iris", "pupil", "sclera", "cornea"};

static bool is_letter(char c)
{
    return isalpha((unsigned char)c) != 0;
}

/* Returns whether a word is in a name: "lid" is in "lid_upper.l" and "Lids", but not in "solid". */
static bool has_word(const char *name, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = name; *at; ++at) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)at[i]) == word[i])
            ++i;
        bool begins = at == name || !is_letter(at[-1]);
        const char *end = at + i + (i == length && tolower((unsigned char)at[i]) == 's');
        if (i == length && begins && !is_letter(*end))
            return true;
    }
    return false;
}

static bool has_any(const char *name, const char *const *word, size_t count)
{
    for (size_t i = 0; name && i < count; ++i)
        if (has_word(name, word[i]))
            return true;
    return false;
}
#define HAS_ANY(name, words) has_any(name, words, sizeof words / sizeof *words)

/* Returns whether the file describes more than one colour. */
static bool is_painted(const mesh_material *m)
{
    return m->base.image || m->normal.image || m->emission.image || m->surface.image ||
           m->emission_colour[0] + m->emission_colour[1] + m->emission_colour[2] > 0.0f ||
           m->lighting != MESH_LIGHTING_FULL || m->alpha == MESH_ALPHA_MASK;
}

surface surface_of(const mesh_material *material)
{
    surface s = {.kind = SURFACE_SMOOTH, .is_in_mouth = HAS_ANY(material->name, mouth_words)};
    if (is_painted(material))
        s.kind = SURFACE_PAINTED;
    if (material->metallic >= 0.5f || s.kind == SURFACE_PAINTED)
        return s;
    if (material->roughness > dry_roughness) {
        if (HAS_ANY(material->name, stone_words))
            s.kind = SURFACE_STONE;
        else if (material->has_roughness && HAS_ANY(material->name, felt_words))
            s.kind = SURFACE_FELT;
        s.has_nap = s.kind == SURFACE_FELT && !HAS_ANY(material->name, shorn_words);
        return s;
    }
    bool is_wet = s.is_in_mouth || (material->name && has_word(material->name, "lip"));
    if (material->roughness > hard_roughness)
        s.softness = 1.0f;
    else if (is_wet)
        s.softness = 0.4f; /* teeth are not stone either */
    s.coat = is_wet ? 1.0f : 0.0f;
    s.cornea =
        material->roughness <= hard_roughness && HAS_ANY(material->name, eye_words) ? 1.0f : 0.0f;
    return s;
}

/* ---- seams ---- */

typedef struct seam_vertex {
    float at[3];
    uint32_t vertex;
} seam_vertex;

static int compare_positions(const void *left, const void *right)
{
    const seam_vertex *a = left, *b = right;
    for (int i = 0; i < 3; ++i)
        if (a->at[i] != b->at[i])
            return a->at[i] < b->at[i] ? -1 : 1;
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

static bool is_same_position(const seam_vertex *a, const seam_vertex *b)
{
    return a->at[0] == b->at[0] && a->at[1] == b->at[1] && a->at[2] == b->at[2];
}

static float cosine(const float *normal, uint32_t a, uint32_t b)
{
    const float *u = normal + (size_t)a * 3, *v = normal + (size_t)b * 3;
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Pairs each vertex with the first coincident vertex that faces the same way, its leader. Leaders
 * are few, because they differ by at least the angle of least_cosine. */
static void pair_vertices(seams *out, const seam_vertex *sorted, uint32_t count,
                          const float *normal, float least_cosine)
{
    enum { LEADERS_MAX = 32 };
    uint32_t leader[LEADERS_MAX], leader_count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t k = 0;
        while (k < leader_count && cosine(normal, leader[k], sorted[i].vertex) < least_cosine)
            ++k;
        if (k < leader_count) {
            out->vertex[out->pair_count] = sorted[i].vertex;
            out->leader[out->pair_count++] = leader[k];
        } else if (leader_count < LEADERS_MAX) {
            leader[leader_count++] = sorted[i].vertex;
        }
    }
}

mrt_result seams_init(seams *out, const float *position, const float *normal, uint32_t vertex_count,
                      float least_cosine, error *err)
{
    *out = (seams){0};
    seam_vertex *sorted = malloc(((size_t)vertex_count + 1) * sizeof *sorted);
    out->vertex = malloc(((size_t)vertex_count + 1) * sizeof *out->vertex);
    out->leader = malloc(((size_t)vertex_count + 1) * sizeof *out->leader);
    if (!sorted || !out->vertex || !out->leader) {
        free(sorted);
        seams_finish(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory to join the seams of the mesh");
    }
    for (uint32_t v = 0; v < vertex_count; ++v) {
        const float *p = position + (size_t)v * 3;
        sorted[v] = (seam_vertex){{p[0], p[1], p[2]}, v};
    }
    qsort(sorted, vertex_count, sizeof *sorted, compare_positions);
    for (uint32_t first = 0, next; first < vertex_count; first = next) {
        for (next = first + 1;
             next < vertex_count && is_same_position(&sorted[first], &sorted[next]);)
            ++next;
        if (next - first > 1)
            pair_vertices(out, sorted + first, next - first, normal, least_cosine);
    }
    free(sorted);
    return MRT_OK;
}

void seams_finish(seams *s)
{
    free(s->vertex);
    free(s->leader);
    *s = (seams){0};
}

void seams_join(const seams *s, float *nx, float *ny, float *nz)
{
    for (uint32_t i = 0; i < s->pair_count; ++i) {
        uint32_t v = s->vertex[i], leader = s->leader[i];
        nx[leader] += nx[v];
        ny[leader] += ny[v];
        nz[leader] += nz[v];
    }
    for (uint32_t i = 0; i < s->pair_count; ++i) {
        uint32_t leader = s->leader[i];
        float square = nx[leader] * nx[leader] + ny[leader] * ny[leader] + nz[leader] * nz[leader];
        float inverse = square > 1e-12f ? 1.0f / sqrtf(square) : 0.0f;
        nx[leader] *= inverse;
        ny[leader] *= inverse;
        nz[leader] *= inverse;
    }
    for (uint32_t i = 0; i < s->pair_count; ++i) {
        uint32_t v = s->vertex[i], leader = s->leader[i];
        nx[v] = nx[leader];
        ny[v] = ny[leader];
        nz[v] = nz[leader];
    }
}

/* ---- updating the shape ---- */

enum { BRIDGED = 2 }; /* unchanged parts sent along, so that fewer runs are sent */

static uint32_t min_of(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Returns the number of parts of DRAW_ROWS vertices; the last may be shorter. */
static uint32_t face_parts(const draw_face *self)
{
    return self->vertex_count / DRAW_ROWS + (self->vertex_count % DRAW_ROWS != 0);
}

/* ---- bounding ball ---- */

static void measure_part(draw_face *self, const float *position, uint32_t part)
{
    uint32_t first = part * DRAW_ROWS, end = min_of(first + DRAW_ROWS, self->vertex_count);
    face_box box = {
        {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, .is_whole = true};
    for (uint32_t v = first; v < end; ++v) {
        const float *p = position + (size_t)v * 3;
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) {
            box.is_whole = false;
            continue;
        }
        for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = p[axis] < box.low[axis] ? p[axis] : box.low[axis];
            box.high[axis] = p[axis] > box.high[axis] ? p[axis] : box.high[axis];
        }
    }
    self->box[part] = box;
}

/* Computes the ball around the shape. changed: parts that self->seen does not have yet; NULL:
 * all. */
static void face_measure(draw_face *self, const float *position, const stamps *changed)
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

/* Returns the end of a run of parts that begins with a changed part. */
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

/* Computes self->normal: smooth normals of the shape, joined at seams. */
static void face_compute_normals(draw_face *self, const float *position)
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

void draw_face_update(draw_face *self, const float *position, const float *normal)
{
    face_measure(self, position, NULL);
    if (!normal) {
        face_compute_normals(self, position);
        normal = self->normal;
    }
    replace(self->position_buffer, position, self->vertex_count);
    replace(self->normal_buffer, normal, self->vertex_count);
    self->seen = (stamps_reader){.seen = 0};
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
    if (count > changed->count / 2) { /* a new buffer: drawing may still use the old one */
        draw_face_update(self, position, normal);
        stamps_read(&self->seen, changed);
        return true;
    }
    face_measure(self, position, changed);
    replace_changed(self, self->position_buffer, position, changed);
    replace_changed(self, self->normal_buffer, normal, changed);
    stamps_read(&self->seen, changed);
    return true;
}

/* ---- the face ---- */

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

/* A mesh without blend mode may still have an alpha below 1. */
static bool is_clear(const mesh_material *look)
{
    return look->alpha == MESH_ALPHA_BLEND ||
           (look->alpha == MESH_ALPHA_OPAQUE && look->base_colour[3] < 0.999f);
}

/* Sets the beginning of each material's batch, transparent ones last. Leaves index_count at 0. */
static void lay_out_batches(draw_face *self, const mesh *m)
{
    self->batch_count = m->material_count;
    for (uint32_t i = 0; i < m->part_count; ++i)
        self->batch[m->part[i].material].first_index += (size_t)m->part[i].triangle_count * 3;
    size_t next = 0;
    for (int clear = 0; clear < 2; ++clear) {
        for (uint32_t i = 0; i < m->material_count; ++i) {
            const mesh_material *look = &m->material[i];
            if (is_clear(look) != (clear == 1))
                continue;
            face_batch *batch = &self->batch[i];
            size_t index_count = batch->first_index;
            *batch = (face_batch){.first_index = next,
                                  .look = *look,
                                  .surface = surface_of(look),
                                  .is_clear = clear == 1};
            if (m->colour) {
                batch->surface.kind = SURFACE_PAINTED;
                batch->surface.has_nap = false;
            }
            batch->look.name = NULL;
            next += index_count;
        }
        if (clear == 0)
            self->solid_count = (uint32_t)(next / 3);
    }
}

static void find_centre(face_batch *batch, const draw_face *self, const mesh *m)
{
    double sum[3] = {0};
    for (GLsizei i = 0; i < batch->index_count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            sum[axis] +=
                (double)m->position[(size_t)self->triangle[batch->first_index + (size_t)i] * 3 +
                                    (size_t)axis];
    for (int axis = 0; axis < 3 && batch->index_count > 0; ++axis)
        batch->centre[axis] = (float)(sum[axis] / (double)batch->index_count);
}

enum { LAYERS = 32 };

/* Returns how far a triangle is behind the frontmost point: 0 .. LAYERS - 1. */
static int layer_of(const draw_face *self, const mesh *m, const uint32_t *corner)
{
    float z = 0.0f;
    for (int k = 0; k < 3; ++k)
        z += m->position[(size_t)corner[k] * 3 + 2] / 3.0f;
    float depth = (self->centre[2] + self->radius_mm - z) / (2.0f * self->radius_mm);
    int layer = isfinite(depth) ? (int)(depth * LAYERS) : 0;
    return layer < 0 ? 0 : layer < LAYERS ? layer : LAYERS - 1;
}

/* Sorts the triangles of a batch from front to back, and keeps the order of the file at equal
 * depth. A face is mostly seen from the front, and hidden pixels are then not shaded. */
static mrt_result sort_by_depth(draw_face *self, const mesh *m, error *err)
{
    uint32_t *sorted = malloc(((size_t)self->triangle_count * 3 + 1) * sizeof *sorted);
    if (!sorted)
        return no_memory(err);
    for (uint32_t i = 0; i < self->batch_count; ++i) {
        const face_batch *batch = &self->batch[i];
        size_t first = batch->first_index, end = first + (size_t)batch->index_count;
        size_t next[LAYERS + 1] = {first};
        for (size_t at = first; at < end; at += 3)
            next[layer_of(self, m, self->triangle + at) + 1] += 3;
        for (int layer = 1; layer < LAYERS; ++layer)
            next[layer] += next[layer - 1];
        for (size_t at = first; at < end; at += 3) {
            size_t *to = &next[layer_of(self, m, self->triangle + at)];
            memcpy(sorted + *to, self->triangle + at, 3 * sizeof *sorted);
            *to += 3;
        }
    }
    free(self->triangle);
    self->triangle = sorted;
    return MRT_OK;
}

/* Makes one batch per material, in their order. Triangles keep the order of the file. */
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
    for (uint32_t i = 0; i < self->batch_count; ++i)
        if (self->batch[i].is_clear)
            find_centre(&self->batch[i], self, m);
    if (m->triangle_count == 0) { /* the mesh is drawn as points */
        self->batch_count = 1;
        self->batch[0] = (face_batch){.look = mesh_material_grey()};
    }
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

static GLenum wrap_of(mesh_wrap wrap)
{
    return wrap == MESH_WRAP_CLAMP    ? GL_CLAMP_TO_EDGE
           : wrap == MESH_WRAP_MIRROR ? GL_MIRRORED_REPEAT
                                      : GL_REPEAT;
}

static GLuint make_texture(const mesh_image *image, const face_texture *wanted)
{
    GLuint name = 0;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    glTexImage2D(GL_TEXTURE_2D, 0, wanted->is_colour ? GL_SRGB8_ALPHA8 : GL_RGBA8,
                 (GLsizei)image->width, (GLsizei)image->height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image->rgba);
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, (GLint)wrap_of(wanted->wrap[0]));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, (GLint)wrap_of(wanted->wrap[1]));
    return name;
}

/* Creates a texture, or reuses that of another material. Returns 0 if the picture does not
 * exist. */
static GLuint texture_of(draw_face *self, const mesh *m, const mesh_texture *wanted, bool is_colour)
{
    if (!wanted->image || !m->uv || !m->image[wanted->image - 1].rgba)
        return 0;
    face_texture made = {0, wanted->image, {wanted->wrap[0], wanted->wrap[1]}, is_colour};
    for (uint32_t i = 0; i < self->texture_count; ++i) {
        const face_texture *known = &self->texture[i];
        if (known->image == made.image && known->is_colour == made.is_colour &&
            known->wrap[0] == made.wrap[0] && known->wrap[1] == made.wrap[1])
            return known->name;
    }
    made.name = make_texture(&m->image[wanted->image - 1], &made);
    self->texture[self->texture_count++] = made;
    return made.name;
}

static mrt_result add_textures(draw_face *self, const mesh *m, error *err)
{
    self->texture = calloc((size_t)m->material_count * FACE_TEXTURES + 1, sizeof *self->texture);
    if (!self->texture)
        return no_memory(err);
    for (uint32_t i = 0; m->triangle_count > 0 && i < m->material_count; ++i) {
        const mesh_material *look = &m->material[i];
        GLuint *texture = self->batch[i].texture;
        if (self->batch[i].index_count == 0)
            continue;
        texture[FACE_BASE] = texture_of(self, m, &look->base, true);
        texture[FACE_NORMAL_MAP] = texture_of(self, m, &look->normal, false);
        texture[FACE_EMISSION] = texture_of(self, m, &look->emission, true);
        texture[FACE_ROUGH_METAL] = texture_of(self, m, &look->surface, false);
    }
    return gl_check_error("the textures of the mesh", err);
}

static mrt_result upload(draw_face *self, const mesh *m, error *err)
{
    uint32_t count = self->vertex_count;
    const float *position = m->position;
    glGenVertexArrays(1, &self->vertex_array);
    glBindVertexArray(self->vertex_array);
    self->position_buffer = add_attribute(FACE_POSITION, 3, count, position, GL_STREAM_DRAW);
    self->normal_buffer = add_attribute(FACE_NORMAL, 3, count, self->normal, GL_STREAM_DRAW);
    self->rest_buffer = add_attribute(FACE_REST, 3, count, position, GL_STATIC_DRAW);
    if (m->colour)
        self->tint_buffer = add_attribute(FACE_TINT, 4, count, m->colour, GL_STATIC_DRAW);
    if (m->uv)
        self->uv_buffer = add_attribute(FACE_UV, 2, count, m->uv, GL_STATIC_DRAW);
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
    result = sort_by_depth(self, m, err);
    if (result != MRT_OK)
        return result;
    float low[3], high[3];
    mesh_bounds(m, low, high);
    self->height_mm = high[1] - low[1] > self->radius_mm ? high[1] - low[1] : self->radius_mm;
    face_compute_normals(self, m->position); /* seams are not known yet */
    const float *normal = m->normal ? m->normal : self->normal;
    result = seams_init(&self->seam, m->position, normal, m->vertex_count,
                        m->normal ? seam_cosine_given : seam_cosine_computed, err);
    if (result != MRT_OK)
        return result;
    if (m->normal)
        memcpy(self->normal, m->normal, (size_t)m->vertex_count * 3 * sizeof *self->normal);
    else
        face_compute_normals(self, m->position);
    result = upload(self, m, err);
    return result == MRT_OK ? add_textures(self, m, err) : result;
}

draw_face *draw_face_create_unshaded(const mesh *m, error *err)
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

mrt_result draw_face_shade(draw_face *self, const mesh *m, error *err)
{
    gl_state before;
    if (m->normal)
        memcpy(self->normal, m->normal, (size_t)m->vertex_count * 3 * sizeof *self->normal);
    gl_state_enter(&before);
    draw_face_update(self, m->position, m->normal);
    mrt_result result = add_openness(self, m->position, err);
    gl_state_leave(&before);
    return result;
}

draw_face *draw_face_create(const mesh *m, error *err)
{
    draw_face *self = draw_face_create_unshaded(m, err);
    if (!self || draw_face_shade(self, m, err) >= 0)
        return self;
    draw_face_destroy(self);
    return NULL;
}

void draw_face_destroy(draw_face *self)
{
    if (!self)
        return;
    GLuint buffers[] = {self->position_buffer, self->normal_buffer, self->rest_buffer,
                        self->openness_buffer, self->index_buffer,  self->colour_buffer,
                        self->tint_buffer,     self->uv_buffer};
    if (self->vertex_array) {
        glDeleteVertexArrays(1, &self->vertex_array);
        glDeleteBuffers((GLsizei)(sizeof buffers / sizeof *buffers), buffers);
    }
    for (uint32_t i = 0; self->texture && i < self->texture_count; ++i)
        glDeleteTextures(1, &self->texture[i].name);
    free(self->texture);
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
        glDrawElements(GL_TRIANGLES, (GLsizei)(face->solid_count * 3), GL_UNSIGNED_INT, NULL);
    else
        glDrawArrays(GL_POINTS, 0, (GLsizei)face->vertex_count);
}

static bool include_corner(float out[4], const float m[16], const float corner[3])
{
    float clip[4];
    for (int row = 0; row < 4; ++row)
        clip[row] =
            m[row] * corner[0] + m[4 + row] * corner[1] + m[8 + row] * corner[2] + m[12 + row];
    if (!(clip[3] > 1e-3f))
        return false;
    for (int axis = 0; axis < 2; ++axis) {
        const float at = clip[axis] / clip[3];
        out[axis] = fminf(out[axis], at);
        out[2 + axis] = fmaxf(out[2 + axis], at);
    }
    return true;
}

bool face_find_rectangle(float out[4], const draw_face *face, const float projection[16])
{
    out[0] = out[1] = INFINITY;
    out[2] = out[3] = -INFINITY;
    bool is_known = face->triangle_count > 0;
    for (uint32_t part = 0; part < face_parts(face) && is_known; ++part) {
        const face_box *box = &face->box[part];
        is_known = box->is_whole;
        for (int k = 0; k < 8 && is_known; ++k) {
            const float corner[3] = {(k & 1 ? box->high : box->low)[0],
                                     (k & 2 ? box->high : box->low)[1],
                                     (k & 4 ? box->high : box->low)[2]};
            is_known = include_corner(out, projection, corner);
        }
    }
    return is_known;
}
