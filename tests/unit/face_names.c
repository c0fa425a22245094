/* face/face_weights.h on the faces that come with marotte. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/face_weights.h"
#include "face/rig/rig_poses.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct named_face {
    face_file file;
    face_weights *weights;
    rig_poses_stage stage;
    rig with_mixture; /* the file's rig, and one pose more */
    rig_pose mixture;
} named_face;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void open_face(named_face *out, const char *path)
{
    error err = {""};
    must(face_file_read(&out->file, path, NULL, FACE_FILE_USABLE, &err), &err);
    must(face_file_weights(&out->weights, &out->file, &err), &err);
    const rig *r = out->file.rig;
    out->with_mixture = *r;
    out->with_mixture.pose = calloc((size_t)r->pose_count + 1, sizeof(rig_pose));
    memcpy(out->with_mixture.pose, r->pose, r->pose_count * sizeof(rig_pose));
    out->mixture = (rig_pose){.name = strdup("mixture"),
                              .dof_name = calloc(MRT_MAX_DOFS, sizeof(char *)),
                              .dof_value = calloc(MRT_MAX_DOFS, sizeof(double)),
                              .pull_contact = calloc(r->contact_count, sizeof(uint32_t)),
                              .pull_mm = calloc(r->contact_count, sizeof(vec3))};
    must(rig_poses_stage_init(&out->stage, r, &out->file.mesh, &out->file.topology, &err), &err);
}

static void close_face(named_face *of)
{
    rig_poses_stage_finish(&of->stage);
    free(of->mixture.name);
    free(of->mixture.dof_name);
    free(of->mixture.dof_value);
    free(of->mixture.pull_contact);
    free(of->mixture.pull_mm);
    free(of->with_mixture.pose);
    face_weights_destroy(of->weights);
    face_file_destroy(&of->file);
}

static const rig_pose *pose_of(const rig *r, uint32_t arkit)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (arkit_find(r->pose[i].name) == arkit)
            return &r->pose[i];
    return NULL;
}

static void add_to_mixture(named_face *of, const rig_pose *pose, double weight)
{
    rig_pose *to = &of->mixture;
    for (uint32_t i = 0; i < pose->dof_count; ++i) {
        uint32_t at = 0;
        while (at < to->dof_count && strcmp(to->dof_name[at], pose->dof_name[i]) != 0)
            at += 1;
        to->dof_count += at == to->dof_count;
        to->dof_name[at] = pose->dof_name[i];
        to->dof_value[at] += weight * pose->dof_value[i];
    }
    for (uint32_t i = 0; i < pose->pull_count + pose->follow_count; ++i) {
        uint32_t at = 0;
        while (at < to->pull_count && to->pull_contact[at] != pose->pull_contact[i])
            at += 1;
        to->pull_count += at == to->pull_count;
        to->pull_contact[at] = pose->pull_contact[i];
        to->pull_mm[at] = vec3_add(to->pull_mm[at], vec3_scale(pose->pull_mm[i], weight));
    }
}

/* What is said of the face that so much of each shape makes, pulled and turned as a hand would. */
static const face_channels *perform(named_face *of, const double weight[ARKIT_SHAPES])
{
    rig *r = &of->with_mixture;
    csrbf_settings solver = of->stage.solver;
    error err = {""};
    of->mixture.dof_count = of->mixture.pull_count = 0;
    memset(of->mixture.dof_value, 0, MRT_MAX_DOFS * sizeof(double));
    memset(of->mixture.pull_mm, 0, r->contact_count * sizeof(vec3));
    for (uint32_t i = 0; i < ARKIT_SHAPES; ++i)
        if (weight[i] > 0.0 && pose_of(&of->stage.rig, i))
            add_to_mixture(of, pose_of(&of->stage.rig, i), weight[i]);
    r->pose_count = of->file.rig->pose_count + 1;
    r->pose[r->pose_count - 1] = of->mixture;
    solver.stretch_most = of->file.rig->solver.stretch_most;
    must(rig_poses_show_on(of->stage.face, r, r->pose_count - 1, &solver, &err), &err);
    points_to_rows(of->stage.position, face_shown(of->stage.face), face_order(of->stage.face));
    return face_weights_solve(of->weights, of->stage.position, face_metered(of->stage.face)->dof);
}

enum { PUPPET, MOAI, FACES };
static named_face faces[FACES];

static int open_faces(void **state)
{
    (void)state;
    open_face(&faces[PUPPET], SOURCE_DIR "/rigs/puppet/puppet.rig.json");
    open_face(&faces[MOAI], SOURCE_DIR "/rigs/moai/moai.rig.json");
    return 0;
}

static int close_faces(void **state)
{
    (void)state;
    for (int i = 0; i < FACES; ++i)
        close_face(&faces[i]);
    return 0;
}

/* ---- what there is ---- */

static void all_names_are_there_but_what_a_face_has_not(void **state)
{
    (void)state;
    static const char *const lacking[FACES] = {
        "", "EyeLookDownLeft EyeLookInLeft EyeLookOutLeft EyeLookUpLeft "
            "EyeLookDownRight EyeLookInRight EyeLookOutRight EyeLookUpRight "
            "TongueOut"};
    for (int n = 0; n < FACES; ++n) {
        const named_face *of = &faces[n];
        char none[1024] = "";
        size_t used = 0;
        uint32_t visemes = 0;
        for (uint32_t i = 0; i < ARKIT_SHAPES; ++i)
            if (face_weights_source(of->weights, i) == FACE_NAME_NONE)
                used += (size_t)snprintf(none + used, sizeof none - used, "%s%s",
                                         used > 0 ? " " : "", arkit_name[i]);
        assert_string_equal(none, lacking[n]);
        for (uint32_t i = 0; i < of->file.rig->pose_count; ++i)
            visemes += strncmp(of->file.rig->pose[i].name, "viseme_", 7) == 0;
        assert_int_equal(visemes, FACE_VISEMES);
    }
}

/* By height, and how far apart the lips are: what is left is left, and what opens opens. */
static void poses_do_what_they_are_called(void **state)
{
    (void)state;
    static const struct {
        const char *pose, *contact;
        int axis;
        double least_mm;
        const char *still; /* the other side's stays nearly where it is */
    } expected[] = {{"mouthSmileLeft", "mouth.corner.l", 1, 8.0, "mouth.corner.r"},
                    {"mouthFrownRight", "mouth.corner.r", 1, -8.0, "mouth.corner.l"},
                    {"browOuterUpLeft", "brow.outer.l", 1, 8.0, "brow.outer.r"},
                    {"browDownRight", "brow.inner.r", 1, -8.0, "brow.outer.l"},
                    {"browInnerUp", "brow.inner.l", 1, 8.0, NULL},
                    {"jawOpen", "lip.lower.mid", 1, -25.0, "lip.upper.mid"},
                    {"jawLeft", "chin", 0, 4.0, NULL},
                    {"jawRight", "chin", 0, -4.0, NULL},
                    {"mouthLeft", "lip.upper.mid", 0, 6.0, NULL},
                    {"mouthPucker", "mouth.corner.l", 0, -8.0, NULL},
                    {"mouthStretchLeft", "mouth.corner.l", 0, 8.0, "mouth.corner.r"},
                    {"mouthFunnel", "lip.upper.mid", 2, 5.0, NULL},
                    {"mouthRollLower", "lip.lower.mid", 2, -4.0, "lip.upper.mid"},
                    {"mouthUpperUpRight", "lip.upper.side.r", 1, 6.0, "lip.lower.mid"},
                    {"mouthLowerDownLeft", "lip.lower.side.l", 1, -6.0, "lip.upper.mid"},
                    {"noseSneerLeft", "nose.wing.l", 1, 5.0, "nose.wing.r"},
                    {"cheekPuff", "cheek.lower.l", 0, 6.0, NULL},
                    {"cheekSquintRight", "cheek.r", 1, 6.0, "cheek.l"}};
    for (int n = 0; n < FACES; ++n) {
        named_face *of = &faces[n];
        error err = {""};
        const rig *r = of->file.rig;
        for (size_t i = 0; i < sizeof expected / sizeof *expected; ++i) {
            uint32_t pose = 0, moved = rig_find_contact(r, expected[i].contact);
            while (strcmp(r->pose[pose].name, expected[i].pose) != 0)
                pose += 1;
            must(rig_poses_show(&of->stage, pose, &err), &err);
            size_t v = (size_t)3 * r->contact[moved].vertex + (size_t)expected[i].axis;
            double way = (double)of->stage.position[v] - (double)of->file.mesh.position[v];
            double least = expected[i].least_mm;
            if (!(least > 0.0 ? way > least : way < least))
                fail_msg("%s: %s goes %.1f mm", expected[i].pose, expected[i].contact, way);
            if (!expected[i].still)
                continue;
            v = (size_t)3 * r->contact[rig_find_contact(r, expected[i].still)].vertex + 1;
            double other = (double)of->stage.position[v] - (double)of->file.mesh.position[v];
            if (!(fabs(other) < 0.35 * fabs(way)))
                fail_msg("%s: %s goes %.1f mm", expected[i].pose, expected[i].still, other);
        }
    }
}

static void no_pose_folds(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        named_face *of = &faces[n];
        error err = {""};
        for (uint32_t i = 0; i < of->file.rig->pose_count; ++i) {
            must(rig_poses_show(&of->stage, i, &err), &err);
            rig_poses_measure m = rig_poses_measured(&of->stage);
            if (!(m.least_determinant > 0.1 && m.penetration_mm < 0.1))
                fail_msg("%s: least determinant %.3f, penetration %.2f mm",
                         of->file.rig->pose[i].name, m.least_determinant, m.penetration_mm);
        }
    }
}

/* ---- there and back ---- */

static double next_random(uint64_t *state) /* 0..1; splitmix64 */
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void each_pose_is_said_by_its_name(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        named_face *of = &faces[n];
        double sum = 0.0, worst = 0.0;
        uint32_t count = 0, worst_at = 0;
        for (uint32_t i = 0; i < ARKIT_SHAPES; ++i) {
            double weight[ARKIT_SHAPES] = {0};
            if (!pose_of(of->file.rig, i))
                continue;
            weight[i] = 1.0;
            weight[arkit_find("jawOpen")] =
                i == arkit_find("mouthClose") ? 1.0 : weight[arkit_find("jawOpen")];
            const face_channels *channels = perform(of, weight);
            for (uint32_t k = 0; k < ARKIT_SHAPES; ++k) {
                double off = fabs(channels->arkit[k] - weight[k]);
                sum += off;
                count += 1;
                if (off > worst) {
                    worst = off;
                    worst_at = i * ARKIT_SHAPES + k;
                }
            }
        }
        print_message("  %s: each pose alone: mean error %.4f, greatest %.3f (%s of %s)\n",
                      of->file.rig->name, sum / count, worst, arkit_name[worst_at % ARKIT_SHAPES],
                      arkit_name[worst_at / ARKIT_SHAPES]);
        assert_true(sum / count < 0.002 && worst < 0.05);
    }
}

/* Of one to four shapes, some of them open mouths. */
static void mixtures_come_back(void **state)
{
    (void)state;
    enum { MIXTURES = 60 };
    for (int n = 0; n < FACES; ++n) {
        named_face *of = &faces[n];
        uint64_t random = 7;
        double sum = 0.0, of_shapes = 0.0, worst = 0.0, residual = 0.0;
        uint32_t count = 0, shapes = 0;
        for (int m = 0; m < MIXTURES; ++m) {
            double weight[ARKIT_SHAPES] = {0};
            for (int part = 1 + (int)(4 * next_random(&random)); part > 0;) {
                uint32_t at = (uint32_t)(next_random(&random) * ARKIT_SHAPES);
                if (!pose_of(of->file.rig, at) || at == arkit_find("mouthClose"))
                    continue;
                weight[at] = 0.3 + 0.7 * next_random(&random);
                part -= 1;
            }
            const face_channels *channels = perform(of, weight);
            for (uint32_t k = 0; k < ARKIT_SHAPES; ++k) {
                double off = fabs(channels->arkit[k] - weight[k]);
                sum += off;
                count += 1;
                of_shapes += weight[k] > 0.0 ? off : 0.0;
                shapes += weight[k] > 0.0;
                worst = fmax(worst, off);
            }
            residual = fmax(residual, channels->residual_mm);
        }
        print_message(
            "  %s: %d mixtures: mean error %.4f (of shapes that are in it %.4f), greatest "
            "%.3f, residual at most %.2f mm\n",
            of->file.rig->name, MIXTURES, sum / count, of_shapes / shapes, worst, residual);
        assert_true(sum / count < 0.01 && of_shapes / shapes < 0.08);
    }
}

/* ---- eyes ---- */

/* VRM's presets of the eyes: the one that it looks to, by how much, and no other. */
static void the_presets_of_the_eyes_say_where_it_looks(void **state)
{
    (void)state;
    static const struct {
        const char *dofs[2], *preset;
        float part; /* of what the eye can */
    } way[] = {{{"eye.l.yaw", "eye.r.yaw"}, "lookLeft", 0.7f},
               {{"eye.l.yaw", "eye.r.yaw"}, "lookRight", -0.7f},
               {{"eye.l.pitch", "eye.r.pitch"}, "lookUp", 0.7f},
               {{"eye.l.pitch", "eye.r.pitch"}, "lookDown", -0.7f}};
    const named_face *of = &faces[PUPPET];
    bones b;
    error err = {""};
    assert_true(bones_init(&b, of->file.rig, (vec3){0, 0, 0}, &err) >= 0);
    for (size_t w = 0; w < sizeof way / sizeof way[0]; ++w) {
        float dof[MRT_MAX_DOFS] = {0};
        for (uint32_t d = 0; d < b.dof_count; ++d)
            for (int k = 0; k < 2; ++k)
                if (strcmp(b.dof[d].name, way[w].dofs[k]) == 0)
                    dof[d] = way[w].part * b.dof[d].max;
        const face_channels *s = face_weights_solve(of->weights, of->file.mesh.position, dof);
        for (uint32_t i = 0; i < FACE_EXPRESSIONS; ++i) {
            const char *name = face_expression_name[i];
            if (strncmp(name, "look", 4) == 0 && strcmp(name, way[w].preset) == 0)
                assert_true(s->expression[i] > 0.3 && s->expression[i] <= 1.0);
            else if (strncmp(name, "look", 4) == 0)
                assert_true(s->expression[i] == 0.0);
        }
    }
}

/* To its left, the head too: eyes are said beside the head. */
static void the_puppet_looks_where_its_eyes_are_turned(void **state)
{
    (void)state;
    const named_face *of = &faces[PUPPET];
    float dof[MRT_MAX_DOFS] = {0};
    bones b;
    error err = {""};
    assert_true(bones_init(&b, of->file.rig, (vec3){0, 0, 0}, &err) >= 0);
    for (uint32_t d = 0; d < b.dof_count; ++d) {
        const char *name = b.dof[d].name;
        dof[d] = strcmp(name, "eye.l.yaw") == 0 || strcmp(name, "eye.r.yaw") == 0 ? 0.25f : 0.0f;
        dof[d] = strcmp(name, "skull.turn") == 0 ? 0.5f : dof[d];
    }
    const face_channels *s = face_weights_solve(of->weights, of->file.mesh.position, dof);
    assert_int_equal(face_weights_source(of->weights, arkit_find("eyeLookOutLeft")),
                     FACE_NAME_BONES);
    assert_true(s->arkit[arkit_find("eyeLookOutLeft")] > 0.3);
    assert_true(s->arkit[arkit_find("eyeLookInRight")] > 0.3);
    assert_true(s->arkit[arkit_find("eyeLookInLeft")] == 0.0);
    assert_true(s->arkit[arkit_find("eyeLookUpLeft")] < 1e-3);
    assert_true(fabs(s->arkit[arkit_find("HeadYaw")] - 0.5) < 1e-6);
    assert_true(fabs(s->arkit[arkit_find("LeftEyeYaw")] - 0.25) < 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_names_are_there_but_what_a_face_has_not),
        cmocka_unit_test(poses_do_what_they_are_called),
        cmocka_unit_test(no_pose_folds),
        cmocka_unit_test(each_pose_is_said_by_its_name),
        cmocka_unit_test(mixtures_come_back),
        cmocka_unit_test(the_presets_of_the_eyes_say_where_it_looks),
        cmocka_unit_test(the_puppet_looks_where_its_eyes_are_turned),
    };
    return cmocka_run_group_tests(tests, open_faces, close_faces);
}
