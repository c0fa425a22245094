#include "mirror.h"
#include "io/export.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void place_points(mesh *m, const vec3 *point, const uint8_t *hold, int32_t point_count,
                         uint32_t *out_image)
{
    uint32_t next = (uint32_t)point_count;
    for (int32_t v = 0; v < point_count; ++v) {
        int is_middle = hold[v] & MIRROR_MIDDLE;
        out_image[v] = is_middle ? (uint32_t)v : next++;
        float *left = m->position + 3 * (size_t)v, *right = m->position + 3 * (size_t)out_image[v];
        left[0] = is_middle ? 0.0f : (float)point[v].x;
        left[1] = (float)point[v].y, left[2] = (float)point[v].z;
        right[0] = is_middle ? 0.0f : -left[0], right[1] = left[1], right[2] = left[2];
    }
}

/* In the place of the one part that a new mesh has. */
static mrt_result make_room_for_parts(mesh *m, uint32_t part_capacity, error *err)
{
    free(m->part[0].name);
    free(m->part);
    free(m->material[0].name);
    free(m->material);
    m->part_count = m->material_count = 0;
    m->part = calloc(part_capacity, sizeof *m->part);
    m->material = calloc(part_capacity, sizeof *m->material);
    if (!m->part || !m->material)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u parts", part_capacity);
    return MRT_OK;
}

mrt_result mirror_points(mesh *out, const vec3 *point, const uint8_t *hold, int32_t point_count,
                         int32_t half_triangle_count, uint32_t part_capacity, uint32_t *out_image,
                         error *err)
{
    int32_t vertex_count = 2 * point_count;
    for (int32_t v = 0; v < point_count; ++v)
        vertex_count -= (hold[v] & MIRROR_MIDDLE) != 0;
    mrt_result result =
        mesh_create(out, (uint32_t)vertex_count, 2 * (uint32_t)half_triangle_count, err);
    if (result < 0)
        return result;
    place_points(out, point, hold, point_count, out_image);
    result = make_room_for_parts(out, part_capacity, err);
    if (result < 0)
        mesh_destroy(out);
    return result;
}

/* The range of vertices that the part's triangles use. */
static void span_vertices(const mesh *m, mesh_part *part)
{
    uint32_t low = UINT32_MAX, high = 0;
    const uint32_t *first = m->triangle + 3 * (size_t)part->first_triangle;
    for (size_t i = 0; i < 3 * (size_t)part->triangle_count; ++i) {
        low = first[i] < low ? first[i] : low;
        high = first[i] > high ? first[i] : high;
    }
    part->first_vertex = part->triangle_count ? low : 0;
    part->vertex_count = part->triangle_count ? high - low + 1 : 0;
}

mrt_result mirror_add_part(mesh *out, const char *name, const mesh_material *look,
                           uint32_t triangle_count, error *err)
{
    uint32_t index = out->part_count;
    const mesh_part *before = index > 0 ? &out->part[index - 1] : NULL;
    mesh_part *part = &out->part[index];
    *part =
        (mesh_part){.name = strdup(name),
                    .material = index,
                    .first_triangle = before ? before->first_triangle + before->triangle_count : 0,
                    .triangle_count = triangle_count};
    out->material[index] = *look;
    out->material[index].name = strdup(name);
    out->part_count = out->material_count = index + 1;
    if (!part->name || !out->material[index].name)
        return error_set(err, MRT_ERR_MEMORY, "no memory for two names");
    span_vertices(out, part);
    return MRT_OK;
}

int mirror_main(int argc, char **argv, const char *program,
                mrt_result (*build)(mesh *out, error *err))
{
    mesh whole;
    error err = {0};
    if (argc != 2) {
        (void)fprintf(stderr, "usage: %s OUT.glb\n", program);
        return 2;
    }
    mrt_result result = build(&whole, &err);
    if (result >= 0) {
        result = gltf_write_mesh(argv[1], &whole, &err);
        mesh_destroy(&whole);
    }
    if (result < 0)
        (void)fprintf(stderr, "%s: %s\n", program, err.text);
    return result < 0 ? 1 : 0;
}
