#include "assembly.h"
#include "plan.h"

#include <stdlib.h>
#include <string.h>

typedef struct part_look {
    const char *name;
    float red, green, blue, roughness;
} part_look;

static const part_look LOOK[PLAN_PART_COUNT] = {
    [PLAN_PART_SKIN] = {"skin", 0.035f, 0.330f, 0.370f, 0.88f},
    [PLAN_PART_NOSE] = {"nose", 0.800f, 0.190f, 0.060f, 0.80f},
    [PLAN_PART_MOUTH_BAG] = {"mouth_bag", 0.200f, 0.012f, 0.030f, 0.75f},
    [PLAN_PART_TEETH_UPPER] = {"teeth_upper", 0.860f, 0.820f, 0.700f, 0.35f},
    [PLAN_PART_GUM_UPPER] = {"teeth_upper.gum", 0.560f, 0.100f, 0.110f, 0.50f},
    [PLAN_PART_TEETH_LOWER] = {"teeth_lower", 0.860f, 0.820f, 0.700f, 0.35f},
    [PLAN_PART_GUM_LOWER] = {"teeth_lower.gum", 0.560f, 0.100f, 0.110f, 0.50f},
    [PLAN_PART_TONGUE] = {"tongue", 0.720f, 0.130f, 0.140f, 0.60f},
    [PLAN_PART_HAIR] = {"hair", 0.850f, 0.250f, 0.030f, 0.95f},
    [PLAN_PART_EYE] = {"eye", 0.880f, 0.860f, 0.800f, 0.15f},
    [PLAN_PART_IRIS] = {"eye.iris", 0.360f, 0.130f, 0.020f, 0.12f},
    [PLAN_PART_PUPIL] = {"eye.pupil", 0.006f, 0.006f, 0.008f, 0.08f},
    [PLAN_PART_LID_UPPER] = {"lid_upper", 0.025f, 0.220f, 0.270f, 0.85f},
    [PLAN_PART_LID_LOWER] = {"lid_lower", 0.025f, 0.220f, 0.270f, 0.85f},
    [PLAN_PART_BROW] = {"brow", 0.850f, 0.250f, 0.030f, 0.95f},
    [PLAN_PART_EAR] = {"ear", 0.035f, 0.330f, 0.370f, 0.88f},
};
enum { FIRST_SIDED = PLAN_PART_EYE, MESH_PARTS = 2 * PLAN_PART_COUNT - FIRST_SIDED };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the puppet");
}

/* "eye.iris" on the left becomes "eye.l.iris"; NULL: no memory. */
static char *sided_name(const char *name, char side)
{
    size_t stem = strcspn(name, "."), length = strlen(name);
    char *out = malloc(length + 3);
    if (!out)
        return NULL;
    memcpy(out, name, stem);
    out[stem] = '.';
    out[stem + 1] = side;
    memcpy(out + stem + 2, name + stem, length - stem + 1);
    return out;
}

static mrt_result add_attributes(mesh *m, error *err)
{
    static const char *const NAME[] = {"_SKULL", "_JAW"};
    m->attribute = calloc(2, sizeof *m->attribute);
    if (!m->attribute)
        return no_memory(err);
    m->attribute_count = 2;
    for (int i = 0; i < 2; ++i) {
        m->attribute[i] = (mesh_attribute){.name = strdup(NAME[i]),
                                           .component_count = 1,
                                           .value = calloc(m->vertex_count, sizeof(float))};
        if (!m->attribute[i].name || !m->attribute[i].value)
            return no_memory(err);
    }
    return MRT_OK;
}

static int32_t middle_count(const sheet *half)
{
    int32_t count = 0;
    for (int32_t v = 0; v < half->point_count; ++v)
        count += (half->hold[v] & SHEET_MIDDLE) != 0;
    return count;
}

/* First the points of the half, then the images of those off the middle. */
static void place_vertices(mesh *m, const sheet *half, uint32_t *out_image)
{
    uint32_t next = (uint32_t)half->point_count;
    for (int32_t v = 0; v < half->point_count; ++v) {
        int is_middle = half->hold[v] & SHEET_MIDDLE;
        out_image[v] = is_middle ? (uint32_t)v : next++;
        vec3 p = half->point[v];
        float *left = m->position + 3 * (size_t)v, *right = m->position + 3 * (size_t)out_image[v];
        left[0] = is_middle ? 0.0f : (float)p.x, left[1] = (float)p.y, left[2] = (float)p.z;
        right[0] = is_middle ? 0.0f : -left[0], right[1] = left[1], right[2] = left[2];
        for (uint32_t bone = 0; bone < 2; ++bone) {
            float value = half->bone[v] == bone + SHEET_SKULL ? 1.0f : 0.0f;
            m->attribute[bone].value[v] = m->attribute[bone].value[out_image[v]] = value;
        }
    }
}

/* A quad is cut along its shorter diagonal: both halves alike. */
static void cut_quad(const sheet *half, const sheet_quad *q, uint32_t out_corner[6])
{
    const int32_t *c = q->corner;
    const vec3 *at = half->point;
    double first = vec3_length(vec3_sub(at[c[0]], at[c[2]]));
    double second = vec3_length(vec3_sub(at[c[1]], at[c[3]]));
    int turn = second < first ? 1 : 0;
    const int pick[6] = {0, 1, 2, 0, 2, 3};
    for (int k = 0; k < 6; ++k)
        out_corner[k] = (uint32_t)c[(pick[k] + turn) % 4];
}

static void place_quad(uint32_t *out, const uint32_t corner[6], const uint32_t *image)
{
    for (int k = 0; k < 6; ++k)
        out[k] = image ? image[corner[k / 3 * 3 + 2 - k % 3]] : corner[k];
}

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

/* Each part has a material of its own, of the same name: that is what readers keep. */
static mrt_result name_part(mesh *m, const part_look *look, char side, error *err)
{
    uint32_t index = m->part_count;
    char *part = side ? sided_name(look->name, side) : strdup(look->name);
    char *material = part ? strdup(part) : NULL;
    if (!material) {
        free(part);
        return no_memory(err);
    }
    m->part[index] = (mesh_part){.name = part, .material = index};
    m->material[index] = (mesh_material){.name = material,
                                         .base_colour = {look->red, look->green, look->blue, 1.0f},
                                         .roughness = look->roughness};
    m->part_count = m->material_count = index + 1;
    return MRT_OK;
}

/* side 'l': the half itself; 'r': its image; 0: both. */
static mrt_result place_part(mesh *m, const sheet *half, const uint32_t *image, int part, char side,
                             uint32_t *next_triangle, error *err)
{
    mesh_part *out = &m->part[m->part_count];
    mrt_result result = name_part(m, &LOOK[part], side, err);
    if (result < 0)
        return result;
    out->first_triangle = *next_triangle;
    for (int32_t q = 0; q < half->quad_count; ++q) {
        uint32_t corner[6];
        if (half->quad[q].part != part)
            continue;
        cut_quad(half, &half->quad[q], corner);
        for (int is_image = 0; is_image < 2; ++is_image) {
            if (side == (is_image ? 'l' : 'r'))
                continue;
            place_quad(m->triangle + 3 * (size_t)*next_triangle, corner, is_image ? image : NULL);
            *next_triangle += 2;
        }
    }
    out->triangle_count = *next_triangle - out->first_triangle;
    span_vertices(m, out);
    return MRT_OK;
}

static mrt_result place_parts(mesh *m, const sheet *half, const uint32_t *image, error *err)
{
    mesh_part *part_room = calloc(MESH_PARTS, sizeof *part_room);
    mesh_material *material_room = calloc(MESH_PARTS, sizeof *material_room);
    if (!part_room || !material_room) {
        free(part_room);
        free(material_room);
        return no_memory(err);
    }
    free(m->part[0].name);
    free(m->part);
    free(m->material[0].name);
    free(m->material);
    m->part = part_room;
    m->material = material_room;
    m->part_count = m->material_count = 0;
    uint32_t next_triangle = 0;
    for (int part = 0; part < PLAN_PART_COUNT; ++part) {
        int is_sided = part >= FIRST_SIDED;
        mrt_result result =
            place_part(m, half, image, part, is_sided ? 'l' : 0, &next_triangle, err);
        if (result >= 0 && is_sided)
            result = place_part(m, half, image, part, 'r', &next_triangle, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

mrt_result assembly_build(mesh *out, const sheet *half, error *err)
{
    uint32_t *image = malloc(((size_t)half->point_count + 1) * sizeof *image);
    if (!image)
        return no_memory(err);
    uint32_t vertex_count = (uint32_t)(2 * half->point_count - middle_count(half));
    mrt_result result = mesh_create(out, vertex_count, 4 * (uint32_t)half->quad_count, err);
    if (result < 0)
        goto done;
    result = add_attributes(out, err);
    if (result >= 0) {
        place_vertices(out, half, image);
        result = place_parts(out, half, image, err);
    }
    if (result < 0)
        mesh_destroy(out);
done:
    free(image);
    return result;
}
