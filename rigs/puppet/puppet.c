/* rigs/puppet/puppet.c - generate_puppet: writes puppet.glb, a puppet's head made for performing,
 * exactly symmetric in x, the same bytes on every run. */
#include "mirror.h"
#include "pieces.h"
#include "plan.h"
#include "skin.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CAPACITY = 16384, PART_NAME = 32 };

typedef struct part_look {
    const char *name;
    float red, green, blue, roughness;
} part_look;

static const part_look LOOK[PLAN_PART_COUNT] = {
    [PLAN_PART_SKIN] = {"skin", 0.035f, 0.330f, 0.370f, 0.88f},
    [PLAN_PART_LIPS] = {"skin.lips", 0.300f, 0.080f, 0.090f, 0.88f},
    [PLAN_PART_NOSE] = {"nose", 0.800f, 0.190f, 0.060f, 0.80f},
    [PLAN_PART_MOUTH_BAG] = {"mouth_bag", 0.110f, 0.007f, 0.016f, 0.85f},
    [PLAN_PART_TEETH_UPPER] = {"teeth_upper", 0.950f, 0.840f, 0.640f, 0.35f},
    [PLAN_PART_GUM_UPPER] = {"teeth_upper.gum", 0.560f, 0.100f, 0.110f, 0.50f},
    [PLAN_PART_TEETH_LOWER] = {"teeth_lower", 0.950f, 0.840f, 0.640f, 0.35f},
    [PLAN_PART_GUM_LOWER] = {"teeth_lower.gum", 0.560f, 0.100f, 0.110f, 0.50f},
    [PLAN_PART_TONGUE] = {"tongue", 0.720f, 0.130f, 0.140f, 0.60f},
    [PLAN_PART_HAIR] = {"hair", 0.850f, 0.250f, 0.030f, 0.95f},
    [PLAN_PART_COLLAR] = {"collar.wool", 0.780f, 0.560f, 0.260f, 0.95f},
    [PLAN_PART_EYE] = {"eye", 0.880f, 0.860f, 0.800f, 0.15f},
    [PLAN_PART_IRIS] = {"eye.iris", 0.360f, 0.130f, 0.020f, 0.12f},
    [PLAN_PART_PUPIL] = {"eye.pupil", 0.006f, 0.006f, 0.008f, 0.08f},
    [PLAN_PART_LID_UPPER] = {"lid_upper", 0.110f, 0.520f, 0.500f, 0.88f},
    [PLAN_PART_LID_LOWER] = {"lid_lower", 0.110f, 0.520f, 0.500f, 0.88f},
    [PLAN_PART_LASH_UPPER] = {"lid_upper.lash", 0.014f, 0.010f, 0.016f, 0.60f},
    [PLAN_PART_LASH_LOWER] = {"lid_lower.lash", 0.014f, 0.010f, 0.016f, 0.60f},
    [PLAN_PART_BROW] = {"brow", 0.850f, 0.250f, 0.030f, 0.95f},
    [PLAN_PART_EAR] = {"ear", 0.035f, 0.330f, 0.370f, 0.88f},
};
enum { FIRST_SIDED = PLAN_PART_EYE, PARTS = 2 * PLAN_PART_COUNT - FIRST_SIDED };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the puppet");
}

/* "eye.iris" on the left becomes "eye.l.iris"; side 0: it has none. */
static void name_part(char out[PART_NAME], const char *name, char side)
{
    int stem = (int)strcspn(name, ".");
    if (side)
        (void)snprintf(out, PART_NAME, "%.*s.%c%s", stem, name, side, name + stem);
    else
        (void)snprintf(out, PART_NAME, "%s", name);
}

static mrt_result add_attributes(mesh *m, const sheet *half, const uint32_t *image, error *err)
{
    static const char *const NAME[] = {"_SKULL", "_JAW"};
    m->attribute = calloc(2, sizeof *m->attribute);
    if (!m->attribute)
        return no_memory(err);
    m->attribute_count = 2;
    for (int i = 0; i < 2; ++i) {
        float *value = calloc(m->vertex_count, sizeof *value);
        m->attribute[i] =
            (mesh_attribute){.name = strdup(NAME[i]), .component_count = 1, .value = value};
        if (!m->attribute[i].name || !value)
            return no_memory(err);
        for (int32_t v = 0; v < half->point_count; ++v)
            value[v] = value[image[v]] = half->bone[v] == i + SHEET_SKULL ? 1.0f : 0.0f;
    }
    return MRT_OK;
}

static int is_triangle(const sheet_quad *q)
{
    return q->corner[2] == q->corner[3];
}

static int32_t count_triangles(const sheet *half)
{
    int32_t count = 0;
    for (int32_t q = 0; q < half->quad_count; ++q)
        count += is_triangle(&half->quad[q]) ? 1 : 2;
    return count;
}

/* A quad is cut along its shorter diagonal: both halves alike. */
static void cut_quad(const sheet *half, const sheet_quad *q, uint32_t out_corner[6])
{
    const int32_t *c = q->corner;
    const vec3 *at = half->point;
    double first = vec3_length(vec3_sub(at[c[0]], at[c[2]]));
    double second = vec3_length(vec3_sub(at[c[1]], at[c[3]]));
    int turn = second < first && !is_triangle(q) ? 1 : 0;
    const int pick[6] = {0, 1, 2, 0, 2, 3};
    for (int k = 0; k < 6; ++k)
        out_corner[k] = (uint32_t)c[(pick[k] + turn) % 4];
}

static void place_triangles(uint32_t *out, const uint32_t corner[6], int count,
                            const uint32_t *image)
{
    for (int k = 0; k < 3 * count; ++k)
        out[k] = image ? image[corner[k / 3 * 3 + 2 - k % 3]] : corner[k];
}

/* side 'l': the half itself; 'r': its image; 0: both. */
static mrt_result place_part(mesh *m, const sheet *half, const uint32_t *image, int part, char side,
                             uint32_t *next_triangle, error *err)
{
    const part_look *look = &LOOK[part];
    const mesh_material material = {.base_colour = {look->red, look->green, look->blue, 1.0f},
                                    .roughness = look->roughness};
    uint32_t first_triangle = *next_triangle;
    char name[PART_NAME];
    for (int32_t q = 0; q < half->quad_count; ++q) {
        uint32_t corner[6];
        if (half->quad[q].part != part)
            continue;
        cut_quad(half, &half->quad[q], corner);
        int count = is_triangle(&half->quad[q]) ? 1 : 2;
        for (int is_image = 0; is_image < 2; ++is_image) {
            if (side == (is_image ? 'l' : 'r'))
                continue;
            place_triangles(m->triangle + 3 * (size_t)*next_triangle, corner, count,
                            is_image ? image : NULL);
            *next_triangle += (uint32_t)count;
        }
    }
    name_part(name, look->name, side);
    return mirror_add_part(m, name, &material, *next_triangle - first_triangle, err);
}

static mrt_result place_parts(mesh *m, const sheet *half, const uint32_t *image, error *err)
{
    uint32_t next_triangle = 0;
    mrt_result result = MRT_OK;
    for (int part = 0; part < PLAN_PART_COUNT && result >= 0; ++part) {
        int is_sided = part >= FIRST_SIDED;
        result = place_part(m, half, image, part, is_sided ? 'l' : 0, &next_triangle, err);
        if (result >= 0 && is_sided)
            result = place_part(m, half, image, part, 'r', &next_triangle, err);
    }
    return result;
}

/* The half with its mirror image as a mesh with parts, materials and the attributes _SKULL and
 * _JAW. */
static mrt_result assemble(mesh *out, const sheet *half, error *err)
{
    uint32_t *image = malloc(((size_t)half->point_count + 1) * sizeof *image);
    if (!image)
        return no_memory(err);
    mrt_result result = mirror_points(out, half->point, half->hold, half->point_count,
                                      count_triangles(half), PARTS, image, err);
    if (result >= 0) {
        result = add_attributes(out, half, image, err);
        if (result >= 0)
            result = place_parts(out, half, image, err);
        if (result < 0)
            mesh_destroy(out);
    }
    free(image);
    return result;
}

static mrt_result sew(sheet *half, error *err)
{
    mrt_result result = skin_build(half, err);
    if (result < 0)
        return result;
    pieces_build(half);
    if (half->is_full)
        return error_set(err, MRT_ERR_ARGUMENT, "the half puppet has more than %d points or quads",
                         CAPACITY);
    return MRT_OK;
}

static mrt_result build(mesh *out, error *err)
{
    sheet half;
    mrt_result result = sheet_create(&half, CAPACITY, err);
    if (result < 0)
        return result;
    result = sew(&half, err);
    if (result >= 0)
        result = assemble(out, &half, err);
    sheet_destroy(&half);
    return result;
}

int main(int argc, char **argv)
{
    return mirror_main(argc, argv, "generate_puppet", build);
}
