/* A pose of a drafted head is one face: performed with all contacts held, it is its portrait. And
 * one hand says the visemes on it: each is nearer to its own portrait than to any other. Heads of
 * ../shared/data. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "faces.h"
#include "face/rig/rig_poses.h"
#include "face/rig_draft.h"
#include "mesh/position.h"
#include "stage/perform/composer.h"
#include "unit/one_hand_bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double apart_most_mm = 0.5;
static char shared[1024];
static face_file puppet;

static void must(mrt_result result, const char *of, const error *err)
{
    if (result < 0)
        fail_msg("%s: %s", of, err->text);
}

/* stretch_most < 0: nothing is held back. */
static void show(rig_poses_stage *stage, float *out, uint32_t index, double stretch_most,
                 uint32_t count)
{
    error err = {""};
    stage->solver.stretch_most = stretch_most;
    must(rig_poses_show(stage, index, &err), stage->rig.pose[index].name, &err);
    memcpy(out, stage->position, (size_t)3 * count * sizeof *out);
}

/* Of each vertex: whether it is within 12 mm of a contact of lips, brows or lids; the first two
 * kinds are the lips. */
static const char *const seen_kinds[] = {"lip", "mouth", "brow", "lid"};
static bool *find_seen(const rig *r, const mesh *m, const char *const *seen, size_t kinds)
{
    bool *out = calloc((size_t)m->vertex_count + 1, sizeof *out);
    assert_non_null(out);
    for (uint32_t k = 0; k < r->contact_count; ++k)
        for (size_t i = 0; i < kinds; ++i) {
            if (strncmp(r->contact[k].name, seen[i], strlen(seen[i])) != 0)
                continue;
            const vec3 at = mesh_position(m, r->contact[k].vertex);
            for (uint32_t v = 0; v < m->vertex_count; ++v)
                out[v] = out[v] || vec3_length(vec3_sub(mesh_position(m, v), at)) <= 12.0;
        }
    return out;
}

static double apart_mm(const float *portrait, const float *performed, const bool *is_seen,
                       const binding *b)
{
    double most = 0.0;
    for (uint32_t v = 0; v < b->vertex_count; ++v) {
        const float *p = portrait + (size_t)3 * v, *q = performed + (size_t)3 * v;
        if (is_seen[v] && b->mobility[v] > 0.0f)
            most = fmax(most, vec3_length((vec3){(double)(p[0] - q[0]), (double)(p[1] - q[1]),
                                                 (double)(p[2] - q[2])}));
    }
    return most;
}

/* ---- said by a hand ---- */

enum { VISEMES = 14 }; /* with lips of their own */
static const int visemes_least = 12;

static void hold_hand(bench *b, const posed_hand *hand)
{
    static const int sensor[JOINT_COUNT] = {3, 1, 2, 5, 8, -1, 11, 12, 15, 16, 4, 7, 0, 19};
    float angle[MRT_ANGLES];
    memcpy(angle, bench_talk, sizeof angle);
    for (int i = 0; i < JOINT_COUNT; ++i)
        if (sensor[i] >= 0)
            angle[sensor[i]] += RAD((float)hand->deg[i]);
    angle[10] += RAD((float)hand->deg[JOINT_SPREAD]);
    angle[14] += RAD((float)hand->deg[JOINT_SPREAD]);
    angle[18] += RAD((float)hand->deg[JOINT_SPREAD]);
    for (int n = 0; n < 30; ++n)
        bench_step(b, MRT_RIGHT, angle);
}

static double lips_apart(const float *a, const float *b, const bool *is_lip, uint32_t count)
{
    double sum = 0.0;
    for (uint32_t v = 0; v < count; ++v)
        for (size_t axis = 0; axis < 3 && is_lip[v]; ++axis) {
            const double by = (double)a[3 * (size_t)v + axis] - (double)b[3 * (size_t)v + axis];
            sum += by * by;
        }
    return sum;
}

/* By the rig's pose, or by the head's own shape. */
static void draw_viseme(float *out, rig_poses_stage *stage, const mesh *m, const char *viseme)
{
    char name[32];
    (void)snprintf(name, sizeof name, "viseme_%s", viseme);
    for (uint32_t i = 0; i < stage->rig.pose_count; ++i)
        if (strcmp(stage->rig.pose[i].name, name) == 0) {
            show(stage, out, i, -1.0, m->vertex_count);
            return;
        }
    for (uint32_t t = 0; t < m->target_count; ++t)
        if (strcmp(m->target[t].name, name) == 0) {
            for (size_t i = 0; i < (size_t)3 * m->vertex_count; ++i)
                out[i] = m->position[i] + m->target[t].offset[i];
            return;
        }
    fail_msg("neither pose nor shape is called %s", name);
}

/* How many of the visemes are nearest to their own portrait. */
static int count_said(const face_file *file, rig_poses_stage *stage, const bool *is_lip)
{
    const uint32_t count = file->mesh.vertex_count;
    const csrbf_settings of_rig = {0};
    float *portrait[VISEMES], *said = calloc((size_t)3 * count, sizeof *said);
    composer *of;
    bench b;
    error err = {""};
    int right = 0;
    assert_non_null(said);
    for (int i = 0; i < VISEMES; ++i) {
        portrait[i] = calloc((size_t)3 * count, sizeof *portrait[i]);
        assert_non_null(portrait[i]);
        draw_viseme(portrait[i], stage, &file->mesh, face_recipes[i].name);
    }
    must(composer_create(&of, file, &of_rig, &err), "composer", &err);
    bench_create(&b, "mode=speaking,device=every_joint,samples=1");
    b.face = composer_about(of);
    must(instance_activate(&b.plugin, composer_mapped(of), &err), "one_hand", &err);
    b.functions->reset(b.plugin.self);
    bench_step(&b, MRT_RIGHT, bench_talk);
    for (int i = 0; i < VISEMES; ++i) {
        hold_hand(&b, &posed_hands[DEVICE_JOINTS][i]);
        const composer_part part = {.weight = 1.0, .gain = 1.0, .is_fresh = true, .pull = &b.pull};
        composer_move(of, &part, 1, 0.01);
        composer_draw(of);
        points_to_rows(said, face_shown(composer_face(of)), face_order(composer_face(of)));
        int nearest = 0;
        for (int other = 1; other < VISEMES; ++other)
            if (lips_apart(said, portrait[other], is_lip, count) <
                lips_apart(said, portrait[nearest], is_lip, count))
                nearest = other;
        right += nearest == i;
    }
    bench_tear_down(&b);
    composer_destroy(of);
    for (int i = 0; i < VISEMES; ++i)
        free(portrait[i]);
    free(said);
    return right;
}

static void check_head(const char *name)
{
    char path[2048], *confirm = NULL;
    const char *worst = "";
    face_file file;
    rig_poses_stage stage;
    error err = {""};
    double most = 0.0;
    (void)snprintf(path, sizeof path, "%s/data/%s", shared, name);
    must(face_file_read(&file, path, NULL, FACE_FILE_ANY, &err), name, &err);
    file.rig = calloc(1, sizeof *file.rig);
    assert_non_null(file.rig);
    must(rig_draft_make(file.rig, &confirm, &file.mesh, &file.topology, path, NULL, 0, &err), name,
         &err);
    const uint32_t first = file.rig->pose_count;
    must(rig_poses_stage_init(&stage, file.rig, &file.mesh, &file.topology, &err), name, &err);
    must(rig_poses_transfer(file.rig, &file.mesh, stage.face, puppet.rig, &puppet.mesh,
                            &puppet.topology, &err),
         name, &err);
    must(rig_poses_reduce(file.rig, first, &stage, &err), name, &err);
    rig_poses_stage_finish(&stage);
    must(rig_poses_stage_init(&stage, file.rig, &file.mesh, &file.topology, &err), name, &err);
    const uint32_t count = file.mesh.vertex_count;
    float *portrait = calloc((size_t)6 * count, sizeof *portrait);
    float *performed = portrait + (size_t)3 * count;
    bool *is_seen = find_seen(&stage.rig, &file.mesh, seen_kinds, 4);
    bool *is_lip = find_seen(&stage.rig, &file.mesh, seen_kinds, 2);
    assert_non_null(portrait);
    for (uint32_t i = 0; i < stage.rig.pose_count; ++i) {
        show(&stage, portrait, i, -1.0, count);
        show(&stage, performed, i, file.rig->solver.stretch_most, count);
        double apart = apart_mm(portrait, performed, is_seen, face_binding(stage.face));
        worst = apart > most ? stage.rig.pose[i].name : worst;
        most = fmax(most, apart);
    }
    const int right = count_said(&file, &stage, is_lip);
    print_message("  %-24s %2u poses, beside the portrait by %.2f mm at most %s; %d of %d visemes "
                  "are said\n",
                  name, stage.rig.pose_count, most, worst, right, VISEMES);
    assert_true(stage.rig.pose_count > 0);
    assert_true(most <= apart_most_mm);
    assert_true(right >= visemes_least);
    free(is_lip);
    free(portrait);
    free(is_seen);
    free(confirm);
    rig_poses_stage_finish(&stage);
    face_file_destroy(&file);
}

static void a_pose_is_performed_as_it_is_drawn(void **state)
{
    (void)state;
    static const char *const heads[] = {
        "heads/bust.gltf",      "heads/girl.glb",      "heads/homer.obj",
        "heads/reyn_head.glb",  "heads/rpm_arkit.glb", "heads/leeperry_draco.glb",
        "heads/suzanne.glb",    "faces/ict_face.glb",  "heads2/brunette_t.glb",
        "heads2/makehuman.obj",
    };
    error err = {""};
    must(face_file_read(&puppet, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                        &err),
         "the puppet", &err);
    /* A generated head, three scans and sculptures, one with shapes of its own; all with
     * MAROTTE_TEST_LONG. */
    const size_t step = getenv("MAROTTE_TEST_LONG") ? 1 : 2;
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i += step)
        check_head(heads[i]);
    face_file_destroy(&puppet);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_pose_is_performed_as_it_is_drawn)};
    const char *given = getenv("MAROTTE_SHARED");
    char path[2048];
    (void)snprintf(shared, sizeof shared, "%s", given ? given : SOURCE_DIR "/../shared");
    (void)snprintf(path, sizeof path, "%s/data/heads/bust.gltf", shared);
    if (access(path, R_OK) != 0) {
        printf("SKIPPED: %s is not there; set MAROTTE_SHARED to the folder with data/\n", path);
        return 77;
    }
    (void)setenv("MAROTTE_FILE_FOLDERS", shared, 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
