/* A pose of a drafted head is one face: performed with all contacts held, it is its portrait. Heads
 * of
 * ../shared/data. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/rig/rig_poses.h"
#include "face/rig_draft.h"
#include "mesh/position.h"
#include "stage/perform/face_file.h"

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
static void show(rig_poses_stage *stage, float *out, uint32_t pose, double stretch_most,
                 uint32_t count)
{
    error err = {""};
    stage->solver.stretch_most = stretch_most;
    must(rig_poses_show(stage, pose, &err), stage->rig.pose[pose].name, &err);
    memcpy(out, stage->position, (size_t)3 * count * sizeof *out);
}

/* Of each vertex: whether it is within 12 mm of a contact of lips, brows or lids. */
static bool *find_seen(const rig *r, const mesh *m)
{
    static const char *const seen[] = {"lip", "mouth", "brow", "lid"};
    bool *out = calloc((size_t)m->vertex_count + 1, sizeof *out);
    assert_non_null(out);
    for (uint32_t k = 0; k < r->contact_count; ++k)
        for (size_t i = 0; i < sizeof seen / sizeof *seen; ++i) {
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
    must(rig_poses_carry(file.rig, &file.mesh, puppet.rig, &puppet.mesh, &err), name, &err);
    must(rig_poses_ease(file.rig, first, &file.mesh, &file.topology, &err), name, &err);
    must(rig_poses_stage_init(&stage, file.rig, &file.mesh, &file.topology, &err), name, &err);
    const uint32_t count = file.mesh.vertex_count;
    float *portrait = calloc((size_t)6 * count, sizeof *portrait);
    float *performed = portrait + (size_t)3 * count;
    bool *is_seen = find_seen(&stage.rig, &file.mesh);
    assert_non_null(portrait);
    for (uint32_t i = 0; i < stage.rig.pose_count; ++i) {
        show(&stage, portrait, i, -1.0, count);
        show(&stage, performed, i, file.rig->solver.stretch_most, count);
        double apart = apart_mm(portrait, performed, is_seen, face_binding(stage.face));
        worst = apart > most ? stage.rig.pose[i].name : worst;
        most = fmax(most, apart);
    }
    print_message("  %-24s %2u poses, beside the portrait by %.2f mm at most %s\n", name,
                  stage.rig.pose_count, most, worst);
    assert_true(stage.rig.pose_count > 0);
    assert_true(most <= apart_most_mm);
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
    for (size_t i = 0; i < sizeof heads / sizeof *heads; ++i)
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
