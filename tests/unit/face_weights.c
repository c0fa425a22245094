/* face/face_weights.h: a face comes back in the names of the shapes that it was made of. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/face_weights.h"
#include "face/rig/rig_poses.h"
#include "unit/allocation_count.h"
#include "unit/face_scene.h"

#include <stdio.h>

enum { JAW_OPEN, MOUTH_CLOSE, SMILE, BROW_UP, PUFF, BLINK, LOOK_UP, VISEME_AA, POSES };
static const csrbf_settings settings = {.radius = 30.0};
static const double look_rad = 0.4;

typedef struct posed {
    face_scene scene;
    rig_pose pose[POSES];
    char *dof_name[POSES];
    double dof_value[POSES];
    uint32_t contact[POSES][2];
    vec3 pull[POSES][2];
    face_weights *weights;
    float shown[SCENE_VERTICES][3];
} posed;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void add_dof(posed *p, int pose, const char *name, double value)
{
    p->dof_name[pose] = strdup(name);
    p->dof_value[pose] = value;
    p->pose[pose].dof_name = &p->dof_name[pose];
    p->pose[pose].dof_value = &p->dof_value[pose];
    p->pose[pose].dof_count = 1;
}

static void add_pull(posed *p, int pose, uint32_t contact, double x, double y, double z)
{
    rig_pose *to = &p->pose[pose];
    p->contact[pose][to->pull_count] = contact;
    p->pull[pose][to->pull_count++] = (vec3){x, y, z};
    to->pull_contact = p->contact[pose];
    to->pull_mm = p->pull[pose];
}

static void make(posed *p)
{
    static char *const names[POSES] = {"jawOpen",   "mouthClose",   "mouthSmileLeft", "browInnerUp",
                                       "cheekPuff", "eyeBlinkLeft", "eyeLookUpLeft",  "viseme_aa"};
    static char eye[] = "eye.l";
    error err = {""};
    memset(p, 0, sizeof *p);
    scene_init(&p->scene);
    p->scene.bone[EYE].name = eye;
    for (int i = 0; i < POSES; ++i)
        p->pose[i].name = names[i];
    add_dof(p, JAW_OPEN, "jaw.open", 0.35);
    add_pull(p, MOUTH_CLOSE, LOWER_LIP, 0, 9, 0);
    add_pull(p, MOUTH_CLOSE, UPPER_LIP, 0, -3, 0);
    add_pull(p, SMILE, CORNER, 5, 4, -1);
    add_pull(p, BROW_UP, BROW, 0, 5, 0);
    add_pull(p, PUFF, CHEEK, 1, 0, 5);
    add_dof(p, BLINK, "lid.close", 0.4);
    add_dof(p, LOOK_UP, "eye.l.pitch", -look_rad); /* down at its most, in this rig */
    add_dof(p, VISEME_AA, "jaw.open", 0.2);
    add_pull(p, VISEME_AA, CORNER, 2, 0, 0);
    p->scene.rig.solver = settings;
    p->scene.rig.pose = p->pose;
    p->scene.rig.pose_count = POSES;
    must(scene_finish(&p->scene, &err), &err);
    must(face_weights_create(&p->weights, p->scene.face, &p->scene.rig, &p->scene.mesh, &err),
         &err);
}

static void finish(posed *p)
{
    face_weights_destroy(p->weights);
    face_destroy(p->scene.face);
    for (int i = 0; i < POSES; ++i)
        free(p->dof_name[i]);
}

/* The face of so much of each pose: all contacts held, theirs pulled, their bones turned. */
static void perform(posed *p, const double weight[POSES])
{
    error err = {""};
    double way[SCENE_CONTACTS][3] = {{0}}, end[SCENE_CONTACTS][3];
    face_control control[SCENE_CONTACTS];
    uint8_t rides[SCENE_CONTACTS];
    float dof[MRT_MAX_DOFS] = {0};
    uint32_t count = 0;
    for (int i = 0; i < POSES; ++i) {
        for (uint32_t k = 0; k < p->pose[i].dof_count; ++k)
            dof[scene_dof(&p->scene, p->dof_name[i])] += (float)(weight[i] * p->dof_value[i]);
        for (uint32_t k = 0; k < p->pose[i].pull_count && weight[i] > 0.0; ++k) {
            const uint32_t at = p->contact[i][k];
            way[at][0] += weight[i] * p->pull[i][k].x;
            way[at][1] += weight[i] * p->pull[i][k].y;
            way[at][2] += weight[i] * p->pull[i][k].z;
        }
    }
    face_reset(p->scene.face);
    for (uint32_t k = 0; k < SCENE_CONTACTS; ++k) {
        control[count] = (face_control){scene_rest(&p->scene, p->scene.contact[k].vertex), 1 + k};
        memcpy(end[count++], way[k], sizeof end[0]);
    }
    must(face_engage(p->scene.face, &settings, control, count, &err), &err);
    memset(rides, 1, sizeof rides);
    face_ride(p->scene.face, end[0], rides, dof);
    must(face_pull(p->scene.face, end[0], dof, &err), &err);
    points_to_rows(p->shown[0], face_shown(p->scene.face), face_order(p->scene.face));
}

static const face_channels *solve(posed *p)
{
    return face_weights_solve(p->weights, p->shown[0], face_metered(p->scene.face)->dof);
}

static double said(const face_channels *s, const posed *p, int pose)
{
    return s->arkit[arkit_find(p->pose[pose].name)];
}

static double expressed(const face_channels *s, const char *name)
{
    for (int i = 0; i < FACE_EXPRESSIONS; ++i)
        if (strcmp(face_expression_name[i], name) == 0)
            return s->expression[i];
    return -1.0;
}

static void a_pose_alone_is_said_alone(void **state)
{
    (void)state;
    posed p;
    make(&p);
    for (int i = 0; i < VISEME_AA; ++i) {
        double weight[POSES] = {0};
        weight[i] = 1.0;
        weight[JAW_OPEN] = i == MOUTH_CLOSE ? 1.0 : weight[JAW_OPEN];
        perform(&p, weight);
        const face_channels *s = solve(&p);
        for (int k = 0; k < VISEME_AA; ++k)
            if (!(fabs(said(s, &p, k) - weight[k]) < 0.02))
                fail_msg("%s: %s is %.4f", p.pose[i].name, p.pose[k].name, said(s, &p, k));
        for (uint32_t k = 0; k < ARKIT_SHAPES; ++k)
            assert_true(s->arkit[k] >= 0.0 && s->arkit[k] <= 1.0);
        assert_true(s->residual_mm < 0.05);
    }
    finish(&p);
}

static void mixtures_are_taken_apart(void **state)
{
    (void)state;
    static const double weight[][POSES] = {{0.3, 0, 0.6, 0.2, 0, 0.5, 0.25},
                                           {0.9, 0.4, 0, 0, 0.7, 0, 0},
                                           {0.1, 0.1, 0.9, 0.9, 0.3, 1.0, 1.0}};
    posed p;
    make(&p);
    for (size_t i = 0; i < sizeof weight / sizeof *weight; ++i) {
        perform(&p, weight[i]);
        const face_channels *s = solve(&p);
        for (int k = 0; k < VISEME_AA; ++k)
            if (!(fabs(said(s, &p, k) - weight[i][k]) < 0.04))
                fail_msg("mixture %zu: %s is %.4f, not %.2f", i, p.pose[k].name, said(s, &p, k),
                         weight[i][k]);
        if (!(fabs(expressed(s, "blinkLeft") - weight[i][BLINK]) < 0.03))
            fail_msg("mixture %zu: blinkLeft is %.4f", i, expressed(s, "blinkLeft"));
    }
    finish(&p);
}

static void lips_close_no_further_than_the_jaw_is_open(void **state)
{
    (void)state;
    posed p;
    make(&p);
    const double weight[POSES] = {0.2, 0.9};
    perform(&p, weight);
    const face_channels *s = solve(&p);
    assert_true(said(s, &p, MOUTH_CLOSE) <= said(s, &p, JAW_OPEN));
    assert_true(said(s, &p, MOUTH_CLOSE) > 0.1);
    assert_true(s->residual_mm > 0.1); /* and it says that something is left */
    finish(&p);
}

static void a_viseme_of_the_rig_is_said_as_such(void **state)
{
    (void)state;
    posed p;
    make(&p);
    double weight[POSES] = {0};
    weight[VISEME_AA] = 0.8;
    perform(&p, weight);
    const face_channels *s = solve(&p);
    for (int i = 0; i < FACE_VISEMES; ++i) {
        double wanted = strcmp(face_viseme_name[i], "aa") == 0 ? 0.8 : 0.0;
        if (i > 0 && !(fabs(s->viseme[i] - wanted) < 0.1))
            fail_msg("viseme %s: %.3f", face_viseme_name[i], s->viseme[i]);
    }
    finish(&p);
}

static void what_no_one_says_is_0(void **state)
{
    (void)state;
    posed p;
    make(&p);
    const double weight[POSES] = {0.5, 0, 0.5, 0.5, 0.5};
    perform(&p, weight);
    const face_channels *s = solve(&p);
    for (uint32_t i = 0; i < ARKIT_SHAPES; ++i) {
        bool is_known = false;
        for (int k = 0; k < POSES; ++k)
            is_known = is_known || arkit_find(p.pose[k].name) == i;
        is_known = is_known || face_weights_source(p.weights, i) == FACE_NAME_BONES;
        assert_int_equal(face_weights_source(p.weights, i) != FACE_NAME_NONE, is_known);
        assert_true(is_known || s->arkit[i] == 0.0);
    }
    assert_int_equal(face_weights_source(p.weights, arkit_find("mouthSmileLeft")), FACE_NAME_POSE);
    finish(&p);
}

/* From a far face on, from nothing, and again: the same weights, and of the same calls the same
 * bits. */
static void the_frame_before_changes_nothing_that_is_seen(void **state)
{
    (void)state;
    posed p;
    const double far[POSES] = {0.9, 0.9, 0, 1, 1, 1}, here[POSES] = {0.3, 0.1, 0.7, 0, 0.2, 0.3};
    face_channels cold[2];
    for (int round = 0; round < 2; ++round) {
        make(&p);
        perform(&p, here);
        cold[round] = *solve(&p);
        if (round == 0)
            finish(&p);
    }
    assert_memory_equal(&cold[0], &cold[1], sizeof cold[0]);
    perform(&p, far);
    (void)solve(&p);
    perform(&p, here);
    const face_channels *warm = solve(&p);
    for (uint32_t i = 0; i < ARKIT_SHAPES; ++i)
        assert_true(fabs(warm->arkit[i] - cold[0].arkit[i]) < 1e-4);
    finish(&p);
}

static void nonsense_leaves_what_was_said(void **state)
{
    (void)state;
    posed p;
    make(&p);
    const double weight[POSES] = {0.3, 0, 0.7};
    perform(&p, weight);
    face_channels before = *solve(&p);
    for (int v = 0; v < SCENE_VERTICES; ++v)
        p.shown[v][1] = NAN;
    assert_memory_equal(solve(&p), &before, sizeof before);
    finish(&p);
}

static void a_frame_allocates_nothing(void **state)
{
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED)
        skip();
    posed p;
    make(&p);
    for (int i = 0; i < 20; ++i) {
        const double weight[POSES] = {0.05 * i, 0.02 * i, 0.5, 0.04 * i, 0, 1};
        perform(&p, weight);
        uint64_t before = atomic_load(&allocation_count);
        (void)solve(&p);
        assert_true(atomic_load(&allocation_count) == before);
    }
    finish(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pose_alone_is_said_alone),
        cmocka_unit_test(mixtures_are_taken_apart),
        cmocka_unit_test(lips_close_no_further_than_the_jaw_is_open),
        cmocka_unit_test(a_viseme_of_the_rig_is_said_as_such),
        cmocka_unit_test(what_no_one_says_is_0),
        cmocka_unit_test(the_frame_before_changes_nothing_that_is_seen),
        cmocka_unit_test(nonsense_leaves_what_was_said),
        cmocka_unit_test(a_frame_allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
