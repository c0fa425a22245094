/* tests/unit/export_gltf_reader.h - a reader of .glb files that shares nothing with the writer or
 * with the program's own reader: what another tool would make of the bytes. It reads one mesh with
 * its targets and one weights animation; anything unexpected ends the test. */
#ifndef MAROTTE_TESTS_EXPORT_GLTF_READER_H
#define MAROTTE_TESTS_EXPORT_GLTF_READER_H
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct glb {
    unsigned char *file;
    size_t size;
    const unsigned char *binary;
    size_t binary_size;
    json_t *root;
} glb;

static inline void glb_expect(int holds, const char *what)
{
    if (!holds)
        fail_msg("the .glb: %s", what);
}

static inline uint32_t glb_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static inline float glb_float(const unsigned char *at)
{
    uint32_t bits = glb_u32(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline glb glb_open(const char *path)
{
    glb g = {0};
    FILE *stream = fopen(path, "rb");
    glb_expect(stream != NULL, "is not there");
    (void)fseek(stream, 0, SEEK_END);
    g.size = (size_t)ftell(stream);
    rewind(stream);
    g.file = malloc(g.size);
    glb_expect(g.file && fread(g.file, 1, g.size, stream) == g.size, "cannot be read");
    (void)fclose(stream);
    glb_expect(g.size > 28 && memcmp(g.file, "glTF", 4) == 0, "magic");
    glb_expect(glb_u32(g.file + 4) == 2 && glb_u32(g.file + 8) == g.size, "version or length");
    size_t json_size = glb_u32(g.file + 12);
    glb_expect(memcmp(g.file + 16, "JSON", 4) == 0 && json_size % 4 == 0, "JSON chunk");
    glb_expect(json_size + 28 <= g.size, "JSON chunk's size");
    const unsigned char *chunk = g.file + 20 + json_size;
    g.binary_size = glb_u32(chunk);
    g.binary = chunk + 8;
    glb_expect(memcmp(chunk + 4, "BIN\0", 4) == 0 && g.binary_size % 4 == 0, "BIN chunk");
    glb_expect(g.binary + g.binary_size == g.file + g.size, "BIN chunk's size");
    g.root = json_loadb((const char *)g.file + 20, json_size, JSON_REJECT_DUPLICATES, NULL);
    glb_expect(g.root != NULL, "JSON");
    return g;
}

static inline void glb_close(glb *g)
{
    json_decref(g->root);
    free(g->file);
}

/* "meshes", 0, "primitives", 2: glb_at(glb_at(...)). */
static inline json_t *glb_at(const json_t *array, size_t index)
{
    json_t *item = json_array_get(array, index);
    glb_expect(item != NULL, "an index is out of range");
    return item;
}

static inline size_t glb_number(const json_t *object, const char *key, size_t otherwise)
{
    const json_t *value = json_object_get(object, key);
    if (!value)
        return otherwise;
    glb_expect(json_is_integer(value) && json_integer_value(value) >= 0, key);
    return (size_t)json_integer_value(value);
}

static inline const unsigned char *glb_view(const glb *g, size_t index, size_t offset, size_t size)
{
    const json_t *view = glb_at(json_object_get(g->root, "bufferViews"), index);
    size_t start = glb_number(view, "byteOffset", 0), length = glb_number(view, "byteLength", 0);
    glb_expect(glb_number(view, "buffer", 1) == 0, "buffer");
    glb_expect(start % 4 == 0 && start + length <= g->binary_size, "a view leaves the buffer");
    glb_expect(offset + size <= length, "an accessor leaves its view");
    return g->binary + start + offset;
}

static inline size_t glb_components(const json_t *accessor)
{
    const char *type = json_string_value(json_object_get(accessor, "type"));
    glb_expect(type != NULL, "accessor type");
    if (strcmp(type, "SCALAR") == 0)
        return 1;
    glb_expect(strncmp(type, "VEC", 3) == 0 && type[3] >= '2' && type[3] <= '4', type);
    return (size_t)(type[3] - '0');
}

static inline void glb_apply_sparse(const glb *g, const json_t *sparse, float *value, size_t count,
                                    size_t width)
{
    size_t changed = glb_number(sparse, "count", 0), before = 0;
    const json_t *index = json_object_get(sparse, "indices");
    const json_t *values = json_object_get(sparse, "values");
    size_t index_size = glb_number(index, "componentType", 0) == 5123 ? 2 : 4;
    glb_expect(changed > 0 && changed <= count, "sparse count");
    const unsigned char *at = glb_view(g, glb_number(index, "bufferView", 1u << 30),
                                       glb_number(index, "byteOffset", 0), changed * index_size);
    const unsigned char *from = glb_view(g, glb_number(values, "bufferView", 1u << 30),
                                         glb_number(values, "byteOffset", 0), changed * width * 4);
    for (size_t i = 0; i < changed; ++i) {
        const unsigned char *p = at + i * index_size;
        size_t vertex = index_size == 2 ? (size_t)(p[0] | p[1] << 8) : glb_u32(p);
        glb_expect(vertex < count && (i == 0 || vertex > before), "sparse index");
        before = vertex;
        for (size_t k = 0; k < width; ++k)
            value[vertex * width + k] = glb_float(from + (i * width + k) * 4);
    }
}

/* The bounds that the accessor states are exactly those of its values. */
static inline void glb_check_bounds(const json_t *accessor, const float *value, size_t count,
                                    size_t width)
{
    const json_t *low = json_object_get(accessor, "min"), *high = json_object_get(accessor, "max");
    if (!low)
        return;
    for (size_t k = 0; k < width; ++k) {
        float least = value[k], greatest = value[k];
        for (size_t i = 0; i < count; ++i) {
            least = fminf(least, value[i * width + k]);
            greatest = fmaxf(greatest, value[i * width + k]);
        }
        glb_expect(json_number_value(json_array_get(low, k)) == (double)least, "min");
        glb_expect(json_number_value(json_array_get(high, k)) == (double)greatest, "max");
    }
}

/* A float accessor as it is to be read: free it. */
static inline float *glb_floats(const glb *g, size_t index, size_t *out_count, size_t width)
{
    const json_t *accessor = glb_at(json_object_get(g->root, "accessors"), index);
    size_t count = glb_number(accessor, "count", 0);
    glb_expect(glb_number(accessor, "componentType", 0) == 5126, "not float");
    glb_expect(glb_components(accessor) == width && count > 0, "accessor shape");
    float *value = calloc(count * width, sizeof *value);
    glb_expect(value != NULL, "memory");
    if (json_object_get(accessor, "bufferView")) {
        const unsigned char *from =
            glb_view(g, glb_number(accessor, "bufferView", 0),
                     glb_number(accessor, "byteOffset", 0), count * width * 4);
        for (size_t i = 0; i < count * width; ++i)
            value[i] = glb_float(from + i * 4);
    }
    const json_t *sparse = json_object_get(accessor, "sparse");
    if (sparse)
        glb_apply_sparse(g, sparse, value, count, width);
    glb_check_bounds(accessor, value, count, width);
    *out_count = count;
    return value;
}

/* ---- the performance that the file shows ---- */

typedef struct glb_face {
    size_t vertex_count, target_count, key_count, primitive_count;
    float *position;       /* V by 3, metres */
    float *normal;         /* V by 3 */
    float **target;        /* target_count: V by 3 */
    float **target_normal; /* target_count: V by 3 */
    float *time_s;         /* key_count; NULL without an animation */
    float *weight;         /* key_count by target_count */
} glb_face;

static inline const json_t *glb_mesh(const glb *g)
{
    return glb_at(json_object_get(g->root, "meshes"), 0);
}

static inline const json_t *glb_primitive(const glb *g, size_t index)
{
    return glb_at(json_object_get(glb_mesh(g), "primitives"), index);
}

static inline void glb_read_targets(const glb *g, glb_face *face)
{
    const json_t *targets = json_object_get(glb_primitive(g, 0), "targets");
    size_t count;
    face->target_count = json_array_size(targets);
    face->target = calloc(face->target_count + 1, sizeof *face->target);
    face->target_normal = calloc(face->target_count + 1, sizeof *face->target_normal);
    for (size_t i = 0; i < face->target_count; ++i) {
        const json_t *target = glb_at(targets, i);
        face->target[i] = glb_floats(g, glb_number(target, "POSITION", 1u << 30), &count, 3);
        glb_expect(count == face->vertex_count, "target size");
        face->target_normal[i] = glb_floats(g, glb_number(target, "NORMAL", 1u << 30), &count, 3);
        glb_expect(count == face->vertex_count, "normal target size");
    }
    const json_t *names = json_object_get(json_object_get(glb_mesh(g), "extras"), "targetNames");
    glb_expect(json_array_size(names) == face->target_count, "targetNames");
    const json_t *weights = json_object_get(glb_mesh(g), "weights");
    glb_expect(json_array_size(weights) == face->target_count, "mesh.weights");
}

static inline void glb_read_animation(const glb *g, glb_face *face)
{
    const json_t *animations = json_object_get(g->root, "animations");
    if (!animations)
        return;
    const json_t *animation = glb_at(animations, 0);
    const json_t *channel = glb_at(json_object_get(animation, "channels"), 0);
    const json_t *sampler =
        glb_at(json_object_get(animation, "samplers"), glb_number(channel, "sampler", 1u << 30));
    const char *path =
        json_string_value(json_object_get(json_object_get(channel, "target"), "path"));
    const char *interpolation = json_string_value(json_object_get(sampler, "interpolation"));
    glb_expect(path && strcmp(path, "weights") == 0, "channel path");
    glb_expect(!interpolation || strcmp(interpolation, "LINEAR") == 0, "interpolation");
    size_t count;
    face->time_s = glb_floats(g, glb_number(sampler, "input", 1u << 30), &face->key_count, 1);
    face->weight = glb_floats(g, glb_number(sampler, "output", 1u << 30), &count, 1);
    glb_expect(count == face->key_count * face->target_count, "weights per key");
}

static inline glb_face glb_read_face(const glb *g)
{
    glb_face face = {0};
    size_t count;
    const json_t *attributes = json_object_get(glb_primitive(g, 0), "attributes");
    face.primitive_count = json_array_size(json_object_get(glb_mesh(g), "primitives"));
    face.position =
        glb_floats(g, glb_number(attributes, "POSITION", 1u << 30), &face.vertex_count, 3);
    face.normal = glb_floats(g, glb_number(attributes, "NORMAL", 1u << 30), &count, 3);
    glb_expect(count == face.vertex_count, "normals");
    for (size_t i = 1; i < face.primitive_count; ++i) {
        const json_t *other = glb_primitive(g, i);
        glb_expect(json_equal(json_object_get(other, "attributes"), attributes),
                   "primitives do not share their vertices");
        glb_expect(json_equal(json_object_get(other, "targets"),
                              json_object_get(glb_primitive(g, 0), "targets")),
                   "primitives do not share their targets");
    }
    glb_read_targets(g, &face);
    glb_read_animation(g, &face);
    return face;
}

static inline void glb_face_finish(glb_face *face)
{
    for (size_t i = 0; i < face->target_count; ++i) {
        free(face->target[i]);
        free(face->target_normal[i]);
    }
    free(face->target);
    free(face->target_normal);
    free(face->position);
    free(face->normal);
    free(face->time_s);
    free(face->weight);
}

/* Greatest distance in mm between what the file shows at a key and a shape in mm. */
static inline double glb_key_error_mm(const glb_face *face, size_t key, const float *shape_mm)
{
    double greatest = 0.0;
    const float *weight = face->weight + key * face->target_count;
    for (size_t j = 0; j < face->target_count; ++j) /* as far as programs that play it let them */
        assert_true(weight[j] >= 0.0f && weight[j] <= 1.0f);
    for (size_t v = 0; v < face->vertex_count; ++v) {
        double square = 0.0;
        for (size_t i = v * 3; i < v * 3 + 3; ++i) {
            double at = (double)face->position[i];
            for (size_t j = 0; j < face->target_count; ++j)
                if (weight[j] != 0.0f)
                    at += (double)weight[j] * (double)face->target[j][i];
            double difference = at * 1000.0 - (double)shape_mm[i];
            square += difference * difference;
        }
        greatest = fmax(greatest, sqrt(square));
    }
    return greatest;
}

static inline size_t glb_target_index(const glb *g, const char *name)
{
    const json_t *names = json_object_get(json_object_get(glb_mesh(g), "extras"), "targetNames");
    for (size_t i = 0; i < json_array_size(names); ++i)
        if (strcmp(json_string_value(json_array_get(names, i)), name) == 0)
            return i;
    fail_msg("the .glb has no target \"%s\"", name);
    return 0;
}

#endif
