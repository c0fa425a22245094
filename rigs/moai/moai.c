/* rigs/moai/moai.c - generate_moai: writes moai.glb, the head of a Moai. It is a closed mesh of
 * 7152 triangles with a mouth that opens, exactly symmetric in x. Each run writes the same
 * bytes. */
#include "mirror.h"
#include "mouth.h"
#include "nets.h"
#include "remesh.h"
#include "sculpt.h"

#include <stdlib.h>

enum { HALF_TRIANGLES = 7152 / 2, ADAPT_ROUNDS = 14 };

/* Gives slightly more triangles than wanted. remesh_reduce removes them. */
static const double EDGE_SCALE = 1.135;
static const double GRID_CELL_MM = 2.0;

static const mesh_material STONE = {.base_colour = {0.255f, 0.225f, 0.185f, 1.0f},
                                    .roughness = 0.95f};
static const mesh_material MOUTH = {.base_colour = {0.008f, 0.0065f, 0.0055f, 1.0f},
                                    .roughness = 0.95f};

/* Makes the half at x >= 0. Its triangles from *out_first_mouth on are the mouth. */
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

/* Adds the half's triangles from `first` on, and their mirror images, as the mesh's next part. */
static mrt_result place_part(mesh *m, const skin *half, const uint32_t *image, int32_t first,
                             int32_t count, const char *name, const mesh_material *look, error *err)
{
    uint32_t *left = m->triangle + 6 * (size_t)first, *right = left + 3 * (size_t)count;
    for (int32_t t = 0; t < count; ++t) {
        const int32_t *corner = half->origin + 3 * (size_t)(first + t);
        for (int k = 0; k < 3; ++k) {
            left[3 * t + k] = (uint32_t)corner[k];
            right[3 * t + k] = image[corner[2 - k]];
        }
    }
    return mirror_add_part(m, name, look, 2 * (uint32_t)count, err);
}

static mrt_result double_up(mesh *out, const skin *half, int32_t first_mouth, error *err)
{
    uint32_t *image = malloc(((size_t)half->vertex_count + 1) * sizeof *image);
    if (!image)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %d vertices", half->vertex_count);
    mrt_result result = mirror_points(out, half->point, half->hold, half->vertex_count,
                                      half->triangle_count, 2, image, err);
    if (result >= 0) {
        result = place_part(out, half, image, 0, first_mouth, "stone", &STONE, err);
        if (result >= 0)
            result = place_part(out, half, image, first_mouth, half->triangle_count - first_mouth,
                                "mouth", &MOUTH, err);
        if (result < 0)
            mesh_destroy(out);
    }
    free(image);
    return result;
}

static mrt_result build(mesh *out, error *err)
{
    skin half;
    int32_t first_mouth;
    mrt_result result = carve(&half, &first_mouth, err);
    if (result < 0)
        return result;
    result = double_up(out, &half, first_mouth, err);
    skin_destroy(&half);
    return result;
}

int main(int argc, char **argv)
{
    return mirror_main(argc, argv, "generate_moai", build);
}
