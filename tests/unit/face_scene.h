/* unit/face_scene.h - a small face for tests, made by hand: a sheet of skin with a slit for the
 * mouth (both lips are at y = 0, each with its own vertices), teeth behind it, an eyeball, a lid
 * that is part of the sheet. Bones: skull, jaw, an eye and its lid. mm; the sheet looks along +z.
 */
#ifndef MAROTTE_TESTS_FACE_SCENE_H
#define MAROTTE_TESTS_FACE_SCENE_H
#include "face/face.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SKULL, JAW, EYE, LID, SCENE_BONES };
enum { SCENE_SIDE = 49, SCENE_HALF = SCENE_SIDE / 2, SCENE_SLIT = 10, SCENE_TEETH = 6 };
enum {
    SCENE_SHEET = SCENE_SIDE * SCENE_SIDE,
    SCENE_LOWER = SCENE_SHEET, /* the lower lip's twins of the slit's vertices */
    SCENE_UPPER_TEETH = SCENE_LOWER + 2 * SCENE_SLIT - 1,
    SCENE_LOWER_TEETH = SCENE_UPPER_TEETH + 2 * SCENE_TEETH,
    SCENE_EYE = SCENE_LOWER_TEETH + 2 * SCENE_TEETH,
    SCENE_VERTICES = SCENE_EYE + 6
};
enum { UPPER_LIP, LOWER_LIP, CHIN, CORNER, CHEEK, BROW, JAW_LEFT, JAW_RIGHT, SCENE_CONTACTS };
#define SCENE_STEP 2.5 /* mm between vertices of the sheet */

typedef struct face_scene {
    mesh mesh;
    rig rig;
    rig_bone bone[SCENE_BONES];
    rig_contact contact[SCENE_CONTACTS];
    rig_proxy proxy[2];
    float position[SCENE_VERTICES][3];
    uint32_t triangle[2 * SCENE_SHEET + 64][3];
    face *face;
} face_scene;

/* Column and row from the middle; row > 0 is above the mouth. */
static inline uint32_t scene_at(int column, int row)
{
    return (uint32_t)((row + SCENE_HALF) * SCENE_SIDE + column + SCENE_HALF);
}

static inline bool scene_in_slit(int column)
{
    return column > -SCENE_SLIT && column < SCENE_SLIT;
}

/* The vertex that a triangle below the mouth uses. */
static inline uint32_t scene_below(int column, int row)
{
    if (row == 0 && scene_in_slit(column))
        return (uint32_t)(SCENE_LOWER + column + SCENE_SLIT - 1);
    return scene_at(column, row);
}

static inline void scene_set(face_scene *s, uint32_t vertex, double x, double y, double z)
{
    s->position[vertex][0] = (float)x;
    s->position[vertex][1] = (float)y;
    s->position[vertex][2] = (float)z;
}

static inline void scene_place(face_scene *s)
{
    for (int row = -SCENE_HALF; row <= SCENE_HALF; ++row)
        for (int column = -SCENE_HALF; column <= SCENE_HALF; ++column) {
            double x = SCENE_STEP * column, y = SCENE_STEP * row;
            scene_set(s, scene_at(column, row), x, y, 85.0 - (x * x + y * y) / 200.0);
            if (row == 0 && scene_in_slit(column))
                scene_set(s, scene_below(column, 0), x, y, 85.0 - x * x / 200.0);
        }
    for (uint32_t i = 0; i < SCENE_TEETH; ++i)
        for (uint32_t j = 0; j < 2; ++j) {
            double x = 4.0 * i - 10.0, y = 1.0 + 7.0 * j;
            scene_set(s, SCENE_UPPER_TEETH + 2 * i + j, x, y, 78.0);
            scene_set(s, SCENE_LOWER_TEETH + 2 * i + j, x, -y, 77.0);
        }
    for (uint32_t i = 0; i < 6; ++i) {
        double at[3] = {30.0, 40.0, 60.0};
        at[i / 2] += i % 2 ? 10.0 : -10.0;
        scene_set(s, SCENE_EYE + i, at[0], at[1], at[2]);
    }
}

static inline void scene_quad(face_scene *s, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    const uint32_t corner[2][3] = {{a, b, c}, {a, c, d}};
    memcpy(s->triangle[s->mesh.triangle_count], corner, sizeof corner);
    s->mesh.triangle_count += 2;
}

static inline void scene_weave(face_scene *s)
{
    for (int row = -SCENE_HALF; row < SCENE_HALF; ++row)
        for (int column = -SCENE_HALF; column < SCENE_HALF; ++column) {
            uint32_t top[2] = {scene_at(column, row + 1), scene_at(column + 1, row + 1)};
            if (row == -1) {
                top[0] = scene_below(column, 0);
                top[1] = scene_below(column + 1, 0);
            }
            scene_quad(s, scene_at(column, row), scene_at(column + 1, row), top[1], top[0]);
        }
    for (uint32_t i = 0; i + 1 < SCENE_TEETH; ++i) {
        uint32_t up = SCENE_UPPER_TEETH + 2 * i, low = SCENE_LOWER_TEETH + 2 * i;
        scene_quad(s, up, up + 2, up + 3, up + 1);
        scene_quad(s, low + 1, low + 3, low + 2, low);
    }
}

static inline double scene_clamp(double x)
{
    return x < 0.0 ? 0.0 : (x > 1.0 ? 1.0 : x);
}

/* Of the sheet; below: of the lower lip's vertices. */
static inline double scene_jaw_weight(double x, double y, bool below)
{
    double beside = fabs(x) - SCENE_STEP * (SCENE_SLIT - 1);
    if (beside <= 0.0)
        return below || y < 0.0 ? 1.0 : 0.0;
    return scene_clamp(0.5 - y / (2.0 + beside));
}

static inline void scene_bind(const face_scene *s, binding *out)
{
    *out = (binding){.vertex_count = SCENE_VERTICES, .bone_count = SCENE_BONES};
    out->weight = calloc((size_t)SCENE_BONES * SCENE_VERTICES, sizeof(float));
    out->mobility = calloc(SCENE_VERTICES, sizeof(float));
    out->contact_position = calloc(SCENE_CONTACTS, sizeof(vec3));
    out->contact_normal = calloc(SCENE_CONTACTS, sizeof(vec3));
    for (uint32_t v = 0; v < SCENE_VERTICES; ++v) {
        double x = (double)s->position[v][0], y = (double)s->position[v][1];
        double lid = 0.0, jaw = scene_jaw_weight(x, y, v >= SCENE_LOWER && v < SCENE_UPPER_TEETH);
        float *weight = out->weight + v;
        if (v < SCENE_UPPER_TEETH) {
            double edge = SCENE_STEP * SCENE_HALF - fmax(fabs(x), fabs(y));
            double from_eye = (x - 30.0) * (x - 30.0) + (y - 40.0) * (y - 40.0);
            lid = 0.75 * scene_clamp(1.0 - from_eye / 144.0);
            out->mobility[v] = (float)scene_clamp(edge / 15.0);
        } else {
            jaw = v >= SCENE_LOWER_TEETH && v < SCENE_EYE ? 1.0 : 0.0;
        }
        weight[(size_t)EYE * SCENE_VERTICES] = v >= SCENE_EYE ? 1.0f : 0.0f;
        weight[(size_t)LID * SCENE_VERTICES] = (float)lid;
        weight[(size_t)JAW * SCENE_VERTICES] = (float)(jaw * (1.0 - lid));
        weight[(size_t)SKULL * SCENE_VERTICES] =
            v >= SCENE_EYE ? 0.0f : (float)((1.0 - jaw) * (1.0 - lid));
    }
    for (uint32_t i = 0; i < SCENE_CONTACTS; ++i)
        out->contact_normal[i] = (vec3){0, 0, 1};
}

static inline void scene_rig(face_scene *s)
{
    static char skull[] = "skull", jaw[] = "jaw", eye[] = "eye", lid[] = "lid", yaw[] = "yaw",
                pitch[] = "pitch", close[] = "close", path[] = "scene.rig.json";
    static char *const names[SCENE_CONTACTS] = {"lip.upper", "lip.lower", "chin",  "corner.l",
                                                "cheek.l",   "brow.l",    "jaw.l", "jaw.r"};
    const uint32_t vertices[SCENE_CONTACTS] = {
        scene_at(0, 0),  scene_below(0, 0), scene_at(0, -10),  scene_at(SCENE_SLIT, 0),
        scene_at(14, 5), scene_at(9, 20),   scene_at(12, -10), scene_at(-12, -10)};
    s->bone[SKULL] = (rig_bone){.name = skull, .parent = RIG_NONE};
    s->bone[JAW] = (rig_bone){.name = jaw,
                              .kind = BONE_JAW,
                              .parent = SKULL,
                              .hinge_left = {50, 10, -10},
                              .hinge_right = {-50, 10, -10},
                              .open_max_rad = 0.55850536063818546, /* 32 degrees */
                              .lateral_mm = 10,
                              .forward_mm = 8,
                              .slide_mm = 12,
                              .incisor = {0, -1, 79.3},
                              .has_incisor = true};
    s->bone[EYE] = (rig_bone){.name = eye,
                              .kind = BONE_BALL,
                              .parent = SKULL,
                              .centre = {30, 40, 60},
                              .radius_mm = 12,
                              .turn_count = 2};
    s->bone[EYE].turn[0] = (rig_turn){yaw, {0, 1, 0}, -0.6, 0.6, {0}};
    s->bone[EYE].turn[1] = (rig_turn){pitch, {1, 0, 0}, -0.5, 0.5, {0}};
    s->bone[LID] = (rig_bone){.name = lid,
                              .kind = BONE_BALL,
                              .parent = SKULL,
                              .centre = {30, 40, 60},
                              .radius_mm = 12,
                              .turn_count = 1};
    s->bone[LID].turn[0] = (rig_turn){close, {1, 0, 0}, -0.1, 0.5, {0}};
    for (uint32_t i = 0; i < SCENE_CONTACTS; ++i)
        s->contact[i] = (rig_contact){
            .name = names[i], .bone = RIG_NONE, .vertex = vertices[i], .mirror = RIG_NONE};
    s->rig = (rig){.path = path,
                   .name = skull,
                   .mm_per_unit = 1.0,
                   .bone = s->bone,
                   .bone_count = SCENE_BONES,
                   .contact = s->contact,
                   .contact_count = SCENE_CONTACTS,
                   .proxy = s->proxy};
}

/* Without a face yet: the rig may be changed before scene_finish. */
static inline void scene_init(face_scene *s)
{
    memset(s, 0, sizeof *s);
    s->mesh.vertex_count = SCENE_VERTICES;
    s->mesh.position = s->position[0];
    s->mesh.triangle = s->triangle[0];
    scene_place(s);
    scene_weave(s);
    scene_rig(s);
}

static inline mrt_result scene_finish(face_scene *s, error *err)
{
    binding b;
    scene_bind(s, &b);
    return face_create_bound(&s->face, &s->rig, &s->mesh, &b, MRT_MAX_VECTORS, err);
}

/* Where a vertex of the file is shown. */
static inline vec3 scene_shown(const face_scene *s, uint32_t vertex)
{
    const points *p = face_shown(s->face);
    uint32_t slot = face_order(s->face)->slot_of_file[vertex];
    return (vec3){(double)p->x[slot], (double)p->y[slot], (double)p->z[slot]};
}

static inline vec3 scene_rest(const face_scene *s, uint32_t vertex)
{
    const float *at = s->position[vertex];
    return (vec3){(double)at[0], (double)at[1], (double)at[2]};
}

static inline double scene_distance(vec3 a, vec3 b)
{
    return vec3_length(vec3_sub(a, b));
}

/* All contacts, held where they are shown; end (SCENE_CONTACTS by 3): the same places. */
static inline mrt_result scene_hold(const face_scene *s, const csrbf_settings *settings,
                                    double end[SCENE_CONTACTS][3], error *err)
{
    face_control control[SCENE_CONTACTS];
    for (uint32_t i = 0; i < SCENE_CONTACTS; ++i) {
        vec3 at = scene_shown(s, s->contact[i].vertex);
        control[i] = (face_control){at, 1 + i};
        end[i][0] = at.x;
        end[i][1] = at.y;
        end[i][2] = at.z;
    }
    return face_engage(s->face, settings, control, SCENE_CONTACTS, err);
}

static inline uint32_t scene_dof(const face_scene *s, const char *name)
{
    const bones *b = face_bones(s->face);
    for (uint32_t i = 0; i < b->dof_count; ++i)
        if (strcmp(b->dof[i].name, name) == 0)
            return i;
    return UINT32_MAX;
}

static inline double scene_greatest_difference(const points *a, const points *b)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < a->count; ++i) {
        double d[3] = {(double)a->x[i] - (double)b->x[i], (double)a->y[i] - (double)b->y[i],
                       (double)a->z[i] - (double)b->z[i]};
        largest = fmax(largest, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    }
    return largest;
}

static inline bool scene_same_bits(const points *a, const points *b)
{
    size_t size = a->padded_count * sizeof(float);
    return memcmp(a->x, b->x, size) == 0 && memcmp(a->y, b->y, size) == 0 &&
           memcmp(a->z, b->z, size) == 0;
}

#endif
