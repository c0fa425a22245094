/* bits [--update]: what the engine, a hand and a face compute has the recorded bits on every
 * processor, compiler and system. Each line of golden/BITS is a result and the FNV-1a of its bytes.
 * --update records them anew, which is right only when a computation has changed on purpose. */
#include "base/file.h"
#include "base/hash.h"
#include "cli/deform_case.h"
#include "hand/filter.h"
#include "hand/hand.h"
#include "mesh/normals.h"
#include "unit/face_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RESULTS_MOST = 64, POSES = 500, FRAMES = 40, FILE_MOST = 1 << 20 };

typedef struct bits_result {
    char name[40];
    uint64_t hash;
} bits_result;
static bits_result result[RESULTS_MOST];
static size_t result_count;

static void must(mrt_result done, const error *err)
{
    if (done >= 0)
        return;
    printf("FAILED: %s\n", err->text);
    exit(1);
}

static void add(const char *what, const char *part, uint64_t hash)
{
    bits_result *to = &result[result_count++];
    (void)snprintf(to->name, sizeof to->name, "%s.%s", what, part);
    to->hash = hash;
}

/* -1 .. 1, the same numbers everywhere. */
static float next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 8388608.0f - 1.0f;
}

/* ---- the engine: every golden case in both precisions ---- */

static void run_case(const char *name)
{
    static const char *const precision[] = {[DEFORM_F64] = "f64", [DEFORM_F32] = "f32"};
    char path[512];
    error err = {""};
    file_bytes bytes;
    deform_case c;
    (void)snprintf(path, sizeof path, "%s/tests/golden/%s.json", SOURCE_DIR, name);
    must(file_read(&bytes, path, FILE_MOST, &err), &err);
    must(deform_case_read(&c, bytes.data, bytes.size, path, &err), &err);
    const size_t count = (size_t)3 * c.frame_count * c.point_count;
    double *position = calloc(count, sizeof *position);
    for (int i = DEFORM_F64; position && i <= DEFORM_F32; ++i) {
        must(deform_case_run(&c, (deform_precision)i, position, &err), &err);
        add(name, precision[i], hash_bytes(HASH_START, position, count * sizeof *position));
    }
    free(position);
    deform_case_destroy(&c);
    file_bytes_finish(&bytes);
}

static void run_cases(void)
{
    static const char *const names[] = {"o01_single_tip",
                                        "o02_two_tips",
                                        "o03_ten_tips_anchored",
                                        "o04_ten_tips_unanchored",
                                        "o05_five_tips_constant",
                                        "o06_ten_tips_linear",
                                        "o07_ten_tips_linear_unanchored",
                                        "o08_four_tips_linear_is_affine",
                                        "o09_twelve_tips_large_radius",
                                        "o10_ten_tips_disjoint_supports",
                                        "o11_tips_and_skull",
                                        "o12_tips_skull_jaw_anchored",
                                        "o13_tips_skull_jaw_unanchored",
                                        "o14_coplanar_linear",
                                        "o15_coincident_and_on_skull"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
        run_case(names[i]);
}

/* ---- a hand: counts of a glove to filtered angles to joints ---- */

static void run_hand(uint32_t side, const char *name)
{
    hand_calibration calibration;
    hand_filter filter;
    hand_skeleton *skeleton = hand_skeleton_create(side, HAND_LENGTH_MM);
    const rigid wrist = rigid_identity();
    uint64_t angles = HASH_START, joints = HASH_START;
    uint32_t random = 4;
    if (!skeleton)
        exit(1);
    hand_calibration_default(&calibration);
    hand_filter_init(&filter);
    for (int i = 0; i < POSES; ++i) {
        float raw[MRT_ANGLES], angle_rad[MRT_ANGLES];
        mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
        for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
            raw[sensor] = 128.0f + 90.0f * next_random(&random);
        hand_calibrate(&calibration, raw, angle_rad);
        hand_filter_apply(&filter, angle_rad, (int64_t)i * 11111111);
        hand_pose(skeleton, angle_rad, &wrist, joint, palm);
        angles = hash_bytes(angles, angle_rad, sizeof angle_rad);
        joints = hash_bytes(hash_bytes(joints, joint, sizeof joint), palm, sizeof palm);
    }
    hand_skeleton_destroy(skeleton);
    add(name, "angles", angles);
    add(name, "joints", joints);
}

/* ---- a face: bones and pulls, anchored and unanchored; its normals ---- */

static uint64_t hash_points(uint64_t hash, const points *p)
{
    const size_t size = p->count * sizeof(float);
    return hash_bytes(hash_bytes(hash_bytes(hash, p->x, size), p->y, size), p->z, size);
}

static uint64_t hash_normals(uint64_t hash, const face_scene *s, const points *p)
{
    static float normal[3][SCENE_VERTICES], at[3][SCENE_VERTICES];
    const uint32_t *slot = face_order(s->face)->slot_of_file;
    for (uint32_t v = 0; v < SCENE_VERTICES; ++v) {
        at[0][v] = p->x[slot[v]];
        at[1][v] = p->y[slot[v]];
        at[2][v] = p->z[slot[v]];
    }
    normals_smooth(normal[0], normal[1], normal[2], at[0], at[1], at[2], SCENE_VERTICES,
                   s->triangle[0], s->mesh.triangle_count);
    return hash_bytes(hash, normal, sizeof normal);
}

static void run_face(bool is_anchored, const char *name)
{
    static const csrbf_settings settings = {.radius = 30.0, .stretch_most = -1.0};
    static face_scene s;
    static const char *const driven[] = {"jaw.open", "jaw.lateral", "eye.yaw", "lid.close"};
    static const float reach[] = {0.4f, 3.0f, 0.4f, 0.4f};
    error err = {""};
    shape_step step;
    double start[SCENE_CONTACTS][3], end[SCENE_CONTACTS][3];
    uint64_t shown = HASH_START, normals = HASH_START;
    uint32_t random = 9;
    scene_init(&s);
    must(scene_finish(&s, &err), &err);
    must(scene_hold(&s, &settings, start, &err), &err);
    for (int frame = 0; frame < FRAMES; ++frame) {
        float dof[MRT_MAX_DOFS];
        for (int i = 0; i < MRT_MAX_DOFS; ++i)
            dof[i] = 0.0f;
        for (size_t i = 0; i < sizeof reach / sizeof reach[0]; ++i)
            dof[scene_dof(&s, driven[i])] = reach[i] * next_random(&random);
        for (int i = 0; i < SCENE_CONTACTS; ++i)
            for (int axis = 0; axis < 3; ++axis)
                end[i][axis] = start[i][axis] + 4.0 * (double)next_random(&random);
        if (is_anchored)
            must(face_pull(s.face, end[0], dof, &err), &err);
        else
            must(face_drag(s.face, &settings, start[0], end[0], SCENE_CONTACTS, dof, start[0],
                           &step, &err),
                 &err);
        shown = hash_points(shown, face_shown(s.face));
        normals = hash_normals(normals, &s, face_shown(s.face));
    }
    face_destroy(s.face);
    add(name, "shown", shown);
    add(name, "normals", normals);
}

/* ---- comparison with the recorded ones ---- */

static void record(const char *path)
{
    char text[RESULTS_MOST * 64];
    size_t used = 0;
    error err = {""};
    for (size_t i = 0; i < result_count; ++i)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s %016llx\n", result[i].name,
                                 (unsigned long long)result[i].hash);
    must(file_write(path, text, used, &err), &err);
}

static size_t count_equal(const char *path)
{
    size_t equal = 0, lines = 0;
    error err = {""};
    file_bytes bytes;
    must(file_read(&bytes, path, FILE_MOST, &err), &err);
    for (const char *line = (const char *)bytes.data; *line; ++lines) {
        char name[sizeof result->name];
        unsigned long long hash;
        const bits_result *r = &result[lines];
        if (lines == result_count || sscanf(line, "%39s %llx", name, &hash) != 2)
            break;
        if (strcmp(name, r->name) != 0 || hash != r->hash)
            printf("FAILED: %s is %016llx, recorded is %s %016llx\n", r->name,
                   (unsigned long long)r->hash, name, hash);
        else
            ++equal;
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    file_bytes_finish(&bytes);
    return equal;
}

int main(int count, char **word)
{
    static const char path[] = SOURCE_DIR "/tests/golden/BITS";
    run_cases();
    run_hand(MRT_RIGHT, "hand_right");
    run_hand(MRT_LEFT, "hand_left");
    run_face(true, "face_anchored");
    run_face(false, "face_unanchored");
    if (count > 1 && strcmp(word[1], "--update") == 0)
        record(path);
    const size_t equal = count_equal(path);
    printf("%zu results, %zu with the recorded bits\n", result_count, equal);
    return equal == result_count ? 0 : 1;
}
