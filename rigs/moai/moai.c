/* rigs/moai/moai.c - generate_moai: writes moai.glb, the head of a Moai as a closed mesh of 7152
 * triangles with a mouth that opens, exactly symmetric in x, the same bytes on every run. */
#include "io/export.h"
#include "mouth.h"
#include "nets.h"
#include "remesh.h"
#include "sculpt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HALF_TRIANGLES = 7152 / 2, ADAPT_ROUNDS = 14 };

/* Gives a few triangles more than wanted, which remesh_reduce takes away. */
static const double EDGE_SCALE = 1.135;
static const double GRID_CELL_MM = 2.0;

/* The parts, each of a material of its name: readers keep names of materials. */
typedef struct look {
    const char *name;
    mesh_material material;
} look;

enum { STONE, MOUTH, PARTS };
static const look LOOK[PARTS] = {
    {"stone", {.base_colour = {0.255f, 0.225f, 0.185f, 1.0f}, .roughness = 0.95f}},
    {"mouth", {.base_colour = {0.008f, 0.0065f, 0.0055f, 1.0f}, .roughness = 0.95f}},
};

/* The half at x >= 0; its triangles from *out_first_mouth on are the mouth. */
static mrt_result carve(skin *out, int32_t *out_first_mouth, error *err)
{
    const form shape = {sculpt_distance, sculpt_edge_mm, EDGE_SCALE};
    skin half;
    int32_t mouth_count = 0;
    mrt_result result =
        nets_half(&half, sculpt_rough_distance, SCULPT_LOW, SCULPT_HIGH, GRID_CELL_MM, err);
    if (result < 0)
        return result;
    for (int i = 0; i < SCULPT_LINES && result >= 0; ++i)
        result = remesh_cut_level(&half, SCULPT_LINE_END[i], err);
    if (result >= 0)
        result = remesh_adapt(&half, &shape, ADAPT_ROUNDS, err);
    if (result >= 0)
        result = mouth_triangle_count(&mouth_count, &half, err);
    if (result >= 0) {
        mouth_hold_line(&half);
        result = remesh_reduce(&half, &shape, HALF_TRIANGLES - mouth_count, err);
    }
    if (result >= 0)
        result = mouth_open(out, &half, out_first_mouth, err);
    skin_destroy(&half);
    return result;
}

static int32_t middle_count(const skin *half)
{
    int32_t count = 0;
    for (int32_t v = 0; v < half->vertex_count; ++v)
        count += (half->hold[v] & SKIN_MIDDLE) != 0;
    return count;
}

/* First the vertices of the half, then the mirror images of those that are off the middle. */
static void place_vertices(mesh *m, const skin *half, uint32_t *out_image)
{
    uint32_t next = (uint32_t)half->vertex_count;
    for (int32_t v = 0; v < half->vertex_count; ++v) {
        vec3 p = half->point[v];
        float *at = m->position + 3 * (size_t)v;
        at[0] = (float)p.x, at[1] = (float)p.y, at[2] = (float)p.z;
        out_image[v] = half->hold[v] & SKIN_MIDDLE ? (uint32_t)v : next++;
        float *mirrored = m->position + 3 * (size_t)out_image[v];
        mirrored[0] = out_image[v] == (uint32_t)v ? 0.0f : -at[0];
        mirrored[1] = at[1], mirrored[2] = at[2];
    }
}

/* A part's triangles of the half and their mirror images, from *next on. */
static void place_part(mesh *m, const skin *half, const uint32_t *image, int32_t first,
                       int32_t count, uint32_t *next)
{
    uint32_t *left = m->triangle + 3 * (size_t)*next, *right = left + 3 * (size_t)count;
    for (int32_t t = 0; t < count; ++t) {
        const int32_t *corner = half->origin + 3 * (size_t)(first + t);
        for (int k = 0; k < 3; ++k) {
            left[3 * t + k] = (uint32_t)corner[k];
            right[3 * t + k] = image[corner[2 - k]];
        }
    }
    *next += 2 * (uint32_t)count;
}

static mrt_result name_part(mesh *m, int part, uint32_t first, uint32_t end, error *err)
{
    uint32_t low = UINT32_MAX, high = 0;
    for (size_t i = 3 * (size_t)first; i < 3 * (size_t)end; ++i) {
        low = m->triangle[i] < low ? m->triangle[i] : low;
        high = m->triangle[i] > high ? m->triangle[i] : high;
    }
    m->material[part] = LOOK[part].material;
    m->material[part].name = strdup(LOOK[part].name);
    m->part[part] = (mesh_part){.name = strdup(LOOK[part].name),
                                .material = (uint32_t)part,
                                .first_triangle = first,
                                .triangle_count = end - first,
                                .first_vertex = low,
                                .vertex_count = high - low + 1};
    if (!m->material[part].name || !m->part[part].name)
        return error_set(err, MRT_ERR_MEMORY, "no memory for two names");
    return MRT_OK;
}

static mrt_result make_room_for_parts(mesh *m, error *err)
{
    free(m->material[0].name);
    free(m->part[0].name);
    free(m->material);
    free(m->part);
    m->material = calloc(PARTS, sizeof *m->material);
    m->part = calloc(PARTS, sizeof *m->part);
    m->material_count = m->material ? PARTS : 0;
    m->part_count = m->part ? PARTS : 0;
    if (!m->material || !m->part)
        return error_set(err, MRT_ERR_MEMORY, "no memory for two parts");
    return MRT_OK;
}

static mrt_result place_parts(mesh *m, const skin *half, const uint32_t *image, int32_t first_mouth,
                              error *err)
{
    uint32_t next = 0, first = 0;
    mrt_result result = make_room_for_parts(m, err);
    place_part(m, half, image, 0, first_mouth, &next);
    if (result >= 0)
        result = name_part(m, STONE, first, next, err);
    first = next;
    place_part(m, half, image, first_mouth, half->triangle_count - first_mouth, &next);
    if (result >= 0)
        result = name_part(m, MOUTH, first, next, err);
    return result;
}

static mrt_result double_up(mesh *out, const skin *half, int32_t first_mouth, error *err)
{
    uint32_t *image = malloc(((size_t)half->vertex_count + 1) * sizeof *image);
    if (!image)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %d vertices", half->vertex_count);
    int32_t vertex_count = 2 * half->vertex_count - middle_count(half);
    mrt_result result =
        mesh_create(out, (uint32_t)vertex_count, 2 * (uint32_t)half->triangle_count, err);
    if (result >= 0) {
        place_vertices(out, half, image);
        result = place_parts(out, half, image, first_mouth, err);
        if (result < 0)
            mesh_destroy(out);
    }
    free(image);
    return result;
}

static mrt_result generate(const char *path, error *err)
{
    skin half;
    mesh whole;
    int32_t first_mouth;
    mrt_result result = carve(&half, &first_mouth, err);
    if (result < 0)
        return result;
    result = double_up(&whole, &half, first_mouth, err);
    skin_destroy(&half);
    if (result < 0)
        return result;
    result = gltf_write_mesh(path, &whole, err);
    mesh_destroy(&whole);
    return result;
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        (void)fputs("usage: generate_moai OUT.glb\n", stderr);
        return 2;
    }
    error err = {0};
    if (generate(argv[1], &err) < 0) {
        (void)fprintf(stderr, "generate_moai: %s\n", err.text);
        return 1;
    }
    return 0;
}
