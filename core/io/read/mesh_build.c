#include "io/read/mesh_build.h"

#include "base/hash.h"
#include "base/srgb.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const uint32_t UNKNOWN_PART = UINT32_MAX;
enum { COUNT_MAX = INT32_MAX / 3, LINE_LENGTH_MAX = 1 << 20 };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the mesh");
}

mrt_result mesh_build_grow(void **array, size_t *capacity, size_t needed, size_t size, error *err)
{
    if (needed <= *capacity)
        return MRT_OK;
    size_t wanted = *capacity + *capacity / 2 + 64;
    if (wanted < needed)
        wanted = needed;
    if (wanted > SIZE_MAX / size)
        return no_memory(err);
    void *grown = realloc(*array, wanted * size);
    if (!grown)
        return no_memory(err);
    *array = grown;
    *capacity = wanted;
    return MRT_OK;
}

static uint32_t *table_slot(const mesh_build_table *t, const char *text, uint32_t material)
{
    uint64_t hash =
        hash_bytes(hash_bytes(HASH_START, &material, sizeof material), text, strlen(text));
    uint32_t at = (uint32_t)(hash >> 32) & (t->slot_count - 1);
    while (t->slot[at]) {
        const mesh_build_name *item = &t->item[t->slot[at] - 1];
        if (item->material == material && strcmp(item->text, text) == 0)
            break;
        at = (at + 1) & (t->slot_count - 1);
    }
    return &t->slot[at];
}

static mrt_result table_grow(mesh_build_table *t, error *err)
{
    uint32_t slot_count = t->slot_count ? t->slot_count * 2 : 32;
    uint32_t *slot = calloc(slot_count, sizeof *slot);
    mesh_build_name *item = realloc(t->item, slot_count / 2 * sizeof *item);
    if (item)
        t->item = item;
    if (!slot || !item) {
        free(slot);
        return no_memory(err);
    }
    free(t->slot);
    t->slot = slot;
    t->slot_count = slot_count;
    for (uint32_t i = 0; i < t->count; ++i)
        *table_slot(t, item[i].text, item[i].material) = i + 1;
    return MRT_OK;
}

/* Finds a name or adds it. */
static mrt_result table_find(mesh_build_table *t, const char *text, uint32_t material,
                             uint32_t *out_item, error *err)
{
    if (t->count == t->slot_count / 2) {
        mrt_result result = table_grow(t, err);
        if (result < 0)
            return result;
    }
    uint32_t *slot = table_slot(t, text, material);
    if (*slot == 0) {
        if (t->count == MESH_BUILD_NAMES_MAX)
            return error_set(err, MRT_ERR_UNSUPPORTED,
                             "\"%s\": more than %d groups or materials are not accepted", text,
                             MESH_BUILD_NAMES_MAX);
        char *copy = strdup(text);
        if (!copy)
            return no_memory(err);
        t->item[t->count] = (mesh_build_name){copy, material};
        t->count += 1;
        *slot = t->count;
    }
    *out_item = *slot - 1;
    return MRT_OK;
}

static void table_free(mesh_build_table *t)
{
    for (uint32_t i = 0; i < t->count; ++i)
        free(t->item[i].text);
    free(t->item);
    free(t->slot);
}

mrt_result mesh_text_unexpected(error *err, const char *expected, text_view found)
{
    char text[48];
    text_copy(text, sizeof text, found);
    return error_set(err, MRT_ERR_FORMAT, "%s was expected, \"%s\" was found", expected, text);
}

bool mesh_text_is_not_finite(text_view word)
{
    static const char *const whole[] = {"nan", "inf", "infinity"}, *const begins[] = {"nan(",
                                                                                      "1.#"};
    word.at += word.at < word.end && (*word.at == '-' || *word.at == '+');
    size_t size = (size_t)(word.end - word.at);
    for (size_t i = 0; i < sizeof whole / sizeof *whole; ++i)
        if (size == strlen(whole[i]) && strncasecmp(word.at, whole[i], size) == 0)
            return true;
    for (size_t i = 0; i < sizeof begins / sizeof *begins; ++i) /* "nan(ind)", "1.#QNAN" */
        if (size > strlen(begins[i]) && strncasecmp(word.at, begins[i], strlen(begins[i])) == 0)
            return true;
    return false;
}

mrt_result mesh_text_check_line(text_view line, error *err)
{
    if (line.end - line.at <= LINE_LENGTH_MAX)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT, "the line is longer than %d bytes", LINE_LENGTH_MAX);
}

void mesh_text_at_line(error *err, uint64_t line_number)
{
    char prefix[32];
    (void)snprintf(prefix, sizeof prefix, "line %llu", (unsigned long long)line_number);
    error_prefix(err, prefix);
}

void mesh_build_init(mesh_build *b)
{
    *b = (mesh_build){.part = UNKNOWN_PART};
}

void mesh_build_finish(mesh_build *b)
{
    if (!b)
        return;
    table_free(&b->parts);
    table_free(&b->materials);
    free(b->position);
    free(b->normal);
    free(b->triangle);
    free(b->part_of);
    free(b->corner);
    free(b->corner_uv);
    free(b->triangle_uv);
    free(b->uv);
    free(b->origin);
    *b = (mesh_build){0};
}

mrt_result mesh_build_vertex(mesh_build *b, const float position[3], error *err)
{
    if (b->vertex_count == COUNT_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "at most %d vertices are allowed", COUNT_MAX);
    mrt_result result = mesh_build_grow((void **)&b->position, &b->vertex_capacity,
                                        b->vertex_count + 1, 3 * sizeof *b->position, err);
    if (result < 0)
        return result;
    memcpy(b->position + b->vertex_count * 3, position, 3 * sizeof *position);
    b->vertex_count += 1;
    return MRT_OK;
}

mrt_result mesh_build_normal(mesh_build *b, const float normal[3], error *err)
{
    mrt_result result = mesh_build_grow((void **)&b->normal, &b->normal_capacity,
                                        b->normal_count + 1, 3 * sizeof *b->normal, err);
    if (result < 0)
        return result;
    memcpy(b->normal + b->normal_count * 3, normal, 3 * sizeof *normal);
    b->normal_count += 1;
    return MRT_OK;
}

void mesh_build_group(mesh_build *b, text_view name)
{
    text_copy(b->group, sizeof b->group, name);
    b->part = UNKNOWN_PART;
}

void mesh_build_material(mesh_build *b, text_view name)
{
    text_copy(b->material, sizeof b->material, name);
    b->part = UNKNOWN_PART;
}

static mrt_result find_part(mesh_build *b, error *err)
{
    if (b->part != UNKNOWN_PART)
        return MRT_OK;
    uint32_t material;
    mrt_result result = table_find(&b->materials, b->material, 0, &material, err);
    if (result < 0)
        return result;
    return table_find(&b->parts, b->group, material, &b->part, err);
}

mrt_result mesh_build_corner(mesh_build *b, int64_t vertex, error *err)
{
    if (vertex < 0 || (uint64_t)vertex >= b->vertex_count)
        return error_set(err, MRT_ERR_FORMAT,
                         "a face uses vertex %lld (counted from 0), but %zu are defined so far",
                         (long long)vertex, b->vertex_count);
    mrt_result result = mesh_build_grow((void **)&b->corner, &b->corner_capacity,
                                        b->corner_count + 1, sizeof *b->corner, err);
    if (result >= 0 && b->keeps_uv)
        result = mesh_build_grow((void **)&b->corner_uv, &b->corner_uv_capacity,
                                 b->corner_count + 1, 2 * sizeof *b->corner_uv, err);
    if (result < 0)
        return result;
    b->corner[b->corner_count] = (uint32_t)vertex;
    if (b->keeps_uv)
        b->corner_uv[b->corner_count * 2] = b->corner_uv[b->corner_count * 2 + 1] = NAN;
    b->corner_count += 1;
    return MRT_OK;
}

void mesh_build_corner_uv(mesh_build *b, const float uv[2])
{
    memcpy(b->corner_uv + (b->corner_count - 1) * 2, uv, 2 * sizeof *uv);
}

static double squared_distance(const mesh_build *b, uint32_t v, uint32_t w)
{
    double sum = 0.0;
    for (size_t axis = 0; axis < 3; ++axis) {
        double d =
            (double)b->position[(size_t)v * 3 + axis] - (double)b->position[(size_t)w * 3 + axis];
        sum += d * d;
    }
    return sum;
}

/* Adds a triangle of three corners of the face. */
static void add_triangle(mesh_build *b, size_t i, size_t j, size_t k)
{
    const size_t corner[3] = {i, j, k};
    for (size_t n = 0; n < 3; ++n) {
        size_t at = b->triangle_count * 3 + n;
        b->triangle[at] = b->corner[corner[n]];
        if (b->keeps_uv)
            memcpy(b->triangle_uv + at * 2, b->corner_uv + corner[n] * 2,
                   2 * sizeof *b->triangle_uv);
    }
    b->part_of[b->triangle_count] = b->part;
    b->triangle_count += 1;
}

static mrt_result reserve_triangles(mesh_build *b, size_t added, error *err)
{
    if (added > COUNT_MAX - b->triangle_count)
        return error_set(err, MRT_ERR_UNSUPPORTED, "at most %d triangles are allowed", COUNT_MAX);
    size_t needed = b->triangle_count + added;
    size_t capacity = b->triangle_capacity;
    mrt_result result =
        mesh_build_grow((void **)&b->triangle, &capacity, needed, 3 * sizeof *b->triangle, err);
    if (result >= 0 && b->keeps_uv)
        result = mesh_build_grow((void **)&b->triangle_uv, &b->triangle_uv_capacity, needed,
                                 6 * sizeof *b->triangle_uv, err);
    if (result < 0)
        return result;
    return mesh_build_grow((void **)&b->part_of, &b->triangle_capacity, needed, sizeof *b->part_of,
                           err);
}

mrt_result mesh_build_face(mesh_build *b, error *err)
{
    const uint32_t *c = b->corner;
    size_t count = b->corner_count;
    b->corner_count = 0;
    if (count < 3)
        return error_set(err, MRT_ERR_FORMAT, "a face has %zu corners, at least 3 are needed",
                         count);
    mrt_result result = find_part(b, err);
    if (result < 0)
        return result;
    result = reserve_triangles(b, count - 2, err);
    if (result < 0)
        return result;
    if (count > 4)
        b->polygon_count += 1;
    if (count == 4 && squared_distance(b, c[1], c[3]) < squared_distance(b, c[0], c[2])) {
        add_triangle(b, 0, 1, 3);
        add_triangle(b, 1, 2, 3);
        return MRT_OK;
    }
    for (size_t i = 2; i < count; ++i)
        add_triangle(b, 0, i - 1, i);
    return MRT_OK;
}

void mesh_build_part_ranges(mesh *m)
{
    for (uint32_t i = 0; i < m->part_count; ++i) {
        mesh_part *part = &m->part[i];
        const uint32_t *at = m->triangle + (size_t)part->first_triangle * 3;
        const uint32_t *end = at + (size_t)part->triangle_count * 3;
        uint32_t low = at < end ? *at : 0, high = low;
        for (const uint32_t *v = at; v < end; ++v) {
            if (*v < low)
                low = *v;
            if (*v > high)
                high = *v;
        }
        part->first_vertex = low;
        part->vertex_count = at < end ? high - low + 1 : 0;
    }
}

void mesh_build_unit_normals(mesh *m)
{
    for (size_t v = 0; m->normal && v < m->vertex_count; ++v) {
        float *n = m->normal + v * 3;
        double x = (double)n[0], y = (double)n[1], z = (double)n[2];
        double length = sqrt(x * x + y * y + z * z);
        if (!(length > 1e-30) || !isfinite(length)) {
            mesh_note(m,
                      "the normal of vertex %zu has no direction: the file's normals are not "
                      "used",
                      v);
            free(m->normal);
            m->normal = NULL;
            return;
        }
        n[0] = (float)(x / length);
        n[1] = (float)(y / length);
        n[2] = (float)(z / length);
    }
}

bool mesh_build_colour(float out_rgba[4], const float srgb[3])
{
    bool is_colour = isfinite(srgb[0]) && isfinite(srgb[1]) && isfinite(srgb[2]);
    for (int i = 0; i < 4; ++i) {
        float coded = i < 3 && is_colour ? srgb[i] : 1.0f;
        double c = coded > 0.0f ? (coded < 1.0f ? (double)coded : 1.0) : 0.0;
        out_rgba[i] = (float)srgb_to_linear(c);
    }
    return is_colour;
}

void mesh_build_note_colours(mesh *m, size_t count)
{
    if (count)
        mesh_note(m, "the colours of %zu vertices are not numbers: these vertices are white",
                  count);
}

void mesh_build_note_degenerate(mesh *m)
{
    size_t count = 0;
    for (const uint32_t *t = m->triangle, *end = t + (size_t)m->triangle_count * 3; t < end; t += 3)
        count += t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    if (count)
        mesh_note(m, "%zu triangles use a vertex twice and have no area", count);
}

/* Copies the triangles sorted by part, in file order within each part. */
static void sort_triangles(const mesh_build *b, mesh *out)
{
    uint32_t next = 0;
    for (size_t t = 0; t < b->triangle_count; ++t)
        out->part[b->part_of[t]].triangle_count += 1;
    for (uint32_t p = 0; p < out->part_count; ++p) {
        out->part[p].first_triangle = next;
        next += out->part[p].triangle_count;
        out->part[p].triangle_count = 0;
    }
    for (size_t t = 0; t < b->triangle_count; ++t) {
        mesh_part *part = &out->part[b->part_of[t]];
        memcpy(out->triangle + ((size_t)part->first_triangle + part->triangle_count) * 3,
               b->triangle + t * 3, 3 * sizeof *b->triangle);
        part->triangle_count += 1;
    }
}

static mrt_result take_names(mesh_build *b, mesh *out, error *err)
{
    mesh_material grey = out->material[0];
    free(grey.name);
    free(out->part[0].name);
    free(out->material);
    free(out->part);
    out->material_count = out->part_count = 0;
    out->material = calloc(b->materials.count, sizeof *out->material);
    out->part = calloc(b->parts.count, sizeof *out->part);
    if (!out->material || !out->part)
        return no_memory(err);
    for (uint32_t i = 0; i < b->materials.count; ++i) {
        out->material[i] = grey;
        out->material[i].name = b->materials.item[i].text;
        b->materials.item[i].text = NULL;
    }
    for (uint32_t i = 0; i < b->parts.count; ++i) {
        out->part[i] =
            (mesh_part){.name = b->parts.item[i].text, .material = b->parts.item[i].material};
        b->parts.item[i].text = NULL;
    }
    out->material_count = b->materials.count;
    out->part_count = b->parts.count;
    return MRT_OK;
}

/* ---- splitting vertices with several texture coordinates ---- */

enum {
    VERSIONS_MAX = 64
}; /* maximum number of versions of a vertex that are searched; later ones are not shared */

typedef struct splitting {
    mesh_build *b;
    uint32_t *next; /* per vertex: the next version of the same vertex; UINT32_MAX: the last */
    size_t count, uv_capacity, next_capacity, origin_capacity;
} splitting;

static mrt_result reserve_versions(splitting *s, size_t needed, error *err)
{
    mesh_build *b = s->b;
    if (needed > COUNT_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "at most %d vertices are allowed", COUNT_MAX);
    mrt_result result =
        mesh_build_grow((void **)&s->next, &s->next_capacity, needed, sizeof *s->next, err);
    if (result >= 0)
        result = mesh_build_grow((void **)&b->origin, &s->origin_capacity, needed,
                                 sizeof *b->origin, err);
    return result < 0
               ? result
               : mesh_build_grow((void **)&b->uv, &s->uv_capacity, needed, 2 * sizeof *b->uv, err);
}

static void add_version(splitting *s, uint32_t origin, uint32_t next, const float uv[2])
{
    s->b->origin[s->count] = origin;
    s->next[s->count] = next;
    memcpy(s->b->uv + s->count * 2, uv, 2 * sizeof *uv);
    s->count += 1;
}

/* Finds the version of a vertex with these coordinates, or adds one. */
static mrt_result find_version(splitting *s, uint32_t *vertex, const float uv[2], error *err)
{
    const uint32_t origin = *vertex;
    float *own = s->b->uv + (size_t)origin * 2;
    if (isnan(uv[0]))
        return MRT_OK;
    if (isnan(own[0]))
        memcpy(own, uv, 2 * sizeof *uv);
    uint32_t at = origin;
    for (int i = 0; i < VERSIONS_MAX && at != UINT32_MAX; ++i, at = s->next[at])
        if (s->b->uv[(size_t)at * 2] == uv[0] && s->b->uv[(size_t)at * 2 + 1] == uv[1]) {
            *vertex = at;
            return MRT_OK;
        }
    mrt_result result = reserve_versions(s, s->count + 1, err);
    if (result < 0)
        return result;
    *vertex = (uint32_t)s->count;
    add_version(s, origin, s->next[origin], uv);
    s->next[origin] = *vertex;
    return MRT_OK;
}

/* version: triangle_count by 3. */
static mrt_result find_versions(splitting *s, uint32_t *version, error *err)
{
    static const float nothing[2] = {NAN, NAN};
    const mesh_build *b = s->b;
    mrt_result result = reserve_versions(s, b->vertex_count, err);
    for (uint32_t v = 0; result >= 0 && v < b->vertex_count; ++v)
        add_version(s, v, UINT32_MAX, nothing);
    for (size_t i = 0; result >= 0 && i < b->triangle_count * 3; ++i) {
        version[i] = b->triangle[i];
        result = find_version(s, &version[i], b->triangle_uv + i * 2, err);
    }
    return result;
}

static bool says_uv(const mesh_build *b)
{
    for (size_t i = 0; b->keeps_uv && i < b->triangle_count * 3; ++i)
        if (!isnan(b->triangle_uv[i * 2]))
            return true;
    return false;
}

static mrt_result split_vertices(mesh_build *b, error *err)
{
    splitting s = {.b = b};
    if (!says_uv(b))
        return MRT_OK;
    uint32_t *version = malloc(b->triangle_count * 3 * sizeof *version);
    mrt_result result = version ? find_versions(&s, version, err) : no_memory(err);
    size_t more = result >= 0 ? s.count - b->vertex_count : 0;
    if (result >= 0) {
        memcpy(b->triangle, version, b->triangle_count * 3 * sizeof *version);
        result = mesh_build_grow((void **)&b->position, &b->vertex_capacity, s.count,
                                 3 * sizeof *b->position, err);
        for (size_t v = b->vertex_count; result >= 0 && v < s.count; ++v)
            memcpy(b->position + v * 3, b->position + (size_t)b->origin[v] * 3,
                   3 * sizeof *b->position);
        b->vertex_count += result >= 0 ? more : 0;
        for (size_t i = 0; result >= 0 && i < b->vertex_count * 2; ++i)
            b->uv[i] = isnan(b->uv[i]) ? 0.0f : b->uv[i];
    }
    if (result >= 0 && more == 0) {
        free(b->origin);
        b->origin = NULL;
    }
    free(version);
    free(s.next);
    return result;
}

mrt_result mesh_build_take(mesh_build *b, mesh *out, error *err)
{
    *out = (mesh){0};
    mrt_result result = MRT_ERR_FORMAT;
    if (b->vertex_count == 0) {
        error_set(err, result, "it has no vertices");
        goto fail;
    }
    if (b->triangle_count == 0) {
        error_set(err, result, "%zu vertices but no faces: a surface is needed", b->vertex_count);
        goto fail;
    }
    result = split_vertices(b, err);
    if (result < 0)
        goto fail;
    result = mesh_create(out, (uint32_t)b->vertex_count, (uint32_t)b->triangle_count, err);
    if (result < 0)
        goto fail;
    result = take_names(b, out, err);
    if (result < 0)
        goto fail;
    memcpy(out->position, b->position, b->vertex_count * 3 * sizeof *b->position);
    if (b->normal_count == b->vertex_count) {
        out->normal = b->normal;
        b->normal = NULL;
        mesh_build_unit_normals(out);
    }
    sort_triangles(b, out);
    mesh_build_part_ranges(out);
    out->uv = b->uv;
    out->point = b->origin;
    b->uv = NULL;
    b->origin = NULL;
    if (b->polygon_count)
        mesh_note(out, "%zu faces of more than 4 corners were cut into fans", b->polygon_count);
    mesh_build_note_degenerate(out);
    mesh_build_finish(b);
    return MRT_OK;
fail:
    mesh_destroy(out);
    mesh_build_finish(b);
    return result;
}
