/* rigs/moai/moai.c - generate_moai: writes moai.glb, the head of a Moai as a closed mesh of 7152
 * triangles, exactly symmetric in x, the same bytes on every run. */
#include "io/export.h"
#include "nets.h"
#include "remesh.h"
#include "sculpt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HALF_TRIANGLES = 7152 / 2, ADAPT_ROUNDS = 14 };

/* Gives a few triangles more than wanted, which remesh_reduce takes away. */
static const double EDGE_SCALE = 1.12;
static const double GRID_CELL_MM = 2.0;

static const mesh_material STONE = {
    .base_colour = {0.255f, 0.225f, 0.185f, 1.0f}, .roughness = 0.95f, .metallic = 0.0f};

/* The half at x >= 0. */
static mrt_result carve(skin *out, error *err)
{
    const form shape = {sculpt_distance, sculpt_edge_mm, EDGE_SCALE};
    mrt_result result =
        nets_half(out, sculpt_rough_distance, SCULPT_LOW, SCULPT_HIGH, GRID_CELL_MM, err);
    if (result < 0)
        return result;
    for (int i = 0; i < SCULPT_LINES && result >= 0; ++i)
        result = remesh_cut_level(out, SCULPT_LINE_END[i], err);
    if (result >= 0)
        result = remesh_adapt(out, &shape, ADAPT_ROUNDS, err);
    if (result >= 0)
        result = remesh_reduce(out, &shape, HALF_TRIANGLES, err);
    if (result < 0)
        skin_destroy(out);
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

static void place_triangles(mesh *m, const skin *half, const uint32_t *image)
{
    size_t count = (size_t)half->triangle_count;
    for (size_t t = 0; t < count; ++t) {
        const int32_t *corner = half->origin + 3 * t;
        uint32_t *left = m->triangle + 3 * t, *right = left + 3 * count;
        for (int k = 0; k < 3; ++k) {
            left[k] = (uint32_t)corner[k];
            right[k] = image[corner[2 - k]];
        }
    }
}

static mrt_result name_stone(mesh *m, error *err)
{
    char *material = strdup("stone"), *part = strdup("moai");
    if (!material || !part) {
        free(material);
        free(part);
        return error_set(err, MRT_ERR_MEMORY, "no memory for two names");
    }
    free(m->material[0].name);
    free(m->part[0].name);
    m->material[0] = STONE;
    m->material[0].name = material;
    m->part[0].name = part;
    return MRT_OK;
}

static mrt_result double_up(mesh *out, const skin *half, error *err)
{
    uint32_t *image = malloc(((size_t)half->vertex_count + 1) * sizeof *image);
    if (!image)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %d vertices", half->vertex_count);
    int32_t vertex_count = 2 * half->vertex_count - middle_count(half);
    mrt_result result =
        mesh_create(out, (uint32_t)vertex_count, 2 * (uint32_t)half->triangle_count, err);
    if (result < 0)
        goto done;
    place_vertices(out, half, image);
    place_triangles(out, half, image);
    result = name_stone(out, err);
    if (result < 0)
        mesh_destroy(out);
done:
    free(image);
    return result;
}

static mrt_result generate(const char *path, error *err)
{
    skin half;
    mesh whole;
    mrt_result result = carve(&half, err);
    if (result < 0)
        return result;
    result = double_up(&whole, &half, err);
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
