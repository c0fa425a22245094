/* A rig's poses on its face: bones turn, contacts land where their pulls ride to, nothing of one
 * pose is left in the next; and the puppet's expressions are sound. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "rig_help.h"
#include "face/rig/rig_poses.h"
#include "mesh/position.h"
#include "stage/perform/composer.h"
#include "stage/perform/patch_bay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A plane that rides on a head, which turns about +z; one contact at (10, 10, 0), one in the
 * middle. */
static const char plane_rig[] =
    "\"unit\": \"mm\", \"bones\": [{\"name\": \"skull\", \"ball\": {\"centre\": [0, 0, 0]}, "
    "\"turns\": [{\"name\": \"turn\", \"axis\": [0, 0, 1], \"deg\": [-120, 120]}]}], "
    "\"contacts\": [{\"name\": \"corner\", \"vertex\": 18}, {\"name\": \"middle\", \"vertex\": "
    "12}], \"poses\": ["
    "{\"name\": \"turned\", \"dofs\": {\"skull.turn\": 90}, \"pulls\": {\"corner\": [4, 0, 3]}}, "
    "{\"name\": \"rest\"}, "
    "{\"name\": \"folded\", \"pulls\": {\"middle\": [35, 0, 0]}}], "
    "\"solver\": {\"kernel\": \"wendland_c2\", \"radius_mm\": 30, \"polynomial\": \"none\"}";
enum { TURNED, REST, FOLDED, CORNER = 18, MIDDLE = 12 };

typedef struct plane {
    rig rig;
    mesh mesh;
    topology topology;
    rig_poses_stage stage;
} plane;

static void open_plane(plane *out)
{
    error err = {""};
    if (rig_with(&out->rig, plane_rig, &err) < 0)
        fail_msg("%s", err.text);
    out->mesh = make_sheet();
    out->topology = make_topology(&out->mesh);
    if (rig_poses_stage_init(&out->stage, &out->rig, &out->mesh, &out->topology, &err) < 0)
        fail_msg("%s", err.text);
}

static void close_plane(plane *p)
{
    rig_poses_stage_finish(&p->stage);
    topology_destroy(&p->topology);
    mesh_destroy(&p->mesh);
    rig_destroy(&p->rig);
}

static void show(rig_poses_stage *stage, uint32_t pose)
{
    error err = {""};
    if (rig_poses_show(stage, pose, &err) < 0)
        fail_msg("%s", err.text);
}

static void assert_at(const rig_poses_stage *stage, uint32_t vertex, float x, float y, float z)
{
    const float *p = stage->position + (size_t)vertex * 3;
    const float apart = fabsf(p[0] - x) + fabsf(p[1] - y) + fabsf(p[2] - z);
    if (!(apart < 1e-3f))
        fail_msg("vertex %u is at %g %g %g", vertex, (double)p[0], (double)p[1], (double)p[2]);
}

static void pulls_ride_on_turned_bones(void **state)
{
    (void)state;
    plane p;
    open_plane(&p);
    show(&p.stage, TURNED);
    assert_at(&p.stage, CORNER, -10.0f, 14.0f, 3.0f); /* (14, 10, 3), a quarter turn on */
    rig_poses_measure m = rig_poses_measured(&p.stage);
    assert_true(m.furthest_mm > 39.9 && m.furthest_mm < 42.0); /* the sheet's corners: 40 */
    assert_true(m.least_determinant > 0.0 && m.least_determinant <= 1.0);
    close_plane(&p);
}

static void no_pose_is_left_in_the_next(void **state)
{
    (void)state;
    plane p;
    open_plane(&p);
    show(&p.stage, FOLDED);
    show(&p.stage, TURNED);
    show(&p.stage, REST);
    for (uint32_t i = 0; i < p.mesh.vertex_count * 3; ++i)
        assert_true(fabsf(p.stage.position[i] - p.mesh.position[i]) < 1e-5f);
    rig_poses_measure m = rig_poses_measured(&p.stage);
    assert_true(m.furthest_mm < 1e-4 && fabs(m.least_determinant - 1.0) < 1e-6);
    close_plane(&p);
}

static void a_pose_that_folds_is_measured_as_one(void **state)
{
    (void)state;
    plane p;
    open_plane(&p);
    show(&p.stage, FOLDED);
    rig_poses_measure m = rig_poses_measured(&p.stage);
    assert_true(m.least_determinant < 0.0);
    assert_int_equal(m.furthest_vertex, MIDDLE);
    assert_true(fabs(m.furthest_mm - 35.0) < 1e-3);
    close_plane(&p);
}

/* What is seen becomes a pose, and that pose is seen as the same. */
static void a_shape_becomes_a_pose_that_gives_the_shape(void **state)
{
    (void)state;
    plane p;
    error err = {""};
    rig_pose made;
    open_plane(&p);
    show(&p.stage, TURNED);
    const bones *b = face_bones(p.stage.face);
    float dof[MRT_MAX_DOFS] = {0.0f};
    vec3 at[2] = {face_contact_now(p.stage.face, 1), face_contact_now(p.stage.face, 2)};
    dof[0] = (float)p.rig.pose[TURNED].dof_value[0];
    assert_int_equal(b->dof_count, 1);
    if (rig_poses_of(&made, "again", p.stage.face, 1, &p.rig, &p.stage.solver, at, dof, &err) < 0)
        fail_msg("%s", err.text);
    assert_string_equal(made.name, "again");
    assert_int_equal(made.dof_count, 1);
    assert_string_equal(made.dof_name[0], "skull.turn");
    assert_true(fabs(made.dof_value[0] - p.rig.pose[TURNED].dof_value[0]) < 1e-6);
    assert_true(made.pull_count >= 1 && made.pull_contact[0] == 0);
    const vec3 meant = p.rig.pose[TURNED].pull_mm[0];
    assert_true(vec3_length(vec3_sub(made.pull_mm[0], meant)) < 0.01);
    rig_pose_finish(&made);
    close_plane(&p);
}

/* ---- a pose is one face ---- */

enum { PUPPET, MOAI, FACES };

typedef struct known {
    face_file file;
    rig_poses_stage stage;
    composer *composer;
} known;
static known faces[FACES];

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static int open_faces(void **state)
{
    (void)state;
    static const char *const path[FACES] = {SOURCE_DIR "/rigs/puppet/puppet.rig.json",
                                            SOURCE_DIR "/rigs/moai/moai.rig.json"};
    const csrbf_settings of_rig = {.radius = 0};
    for (int n = 0; n < FACES; ++n) {
        known *k = &faces[n];
        error err = {""};
        must(face_file_read(&k->file, path[n], NULL, FACE_FILE_USABLE, &err), &err);
        must(rig_poses_stage_init(&k->stage, k->file.rig, &k->file.mesh, &k->file.topology, &err),
             &err);
        k->stage.solver.stretch_most = k->file.rig->solver.stretch_most; /* as it is performed */
        must(composer_create(&k->composer, &k->file, &of_rig, &err), &err);
    }
    return 0;
}

static int close_faces(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        composer_destroy(faces[n].composer);
        rig_poses_stage_finish(&faces[n].stage);
        face_file_destroy(&faces[n].file);
    }
    return 0;
}

static uint32_t pose_named(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (strcmp(r->pose[i].name, name) == 0)
            return i;
    fail_msg("no pose %s", name);
    return RIG_NONE;
}

static double apart_mm(const known *k, const float *a, const float *b)
{
    double most = 0.0;
    for (size_t v = 0; v < k->file.mesh.vertex_count; ++v)
        most = fmax(most, vec3_length((vec3){(double)(a[3 * v] - b[3 * v]),
                                             (double)(a[3 * v + 1] - b[3 * v + 1]),
                                             (double)(a[3 * v + 2] - b[3 * v + 2])}));
    return most;
}

static float *copy_shown(const known *k)
{
    const size_t size = (size_t)3 * k->file.mesh.vertex_count * sizeof(float);
    float *out = malloc(size);
    assert_non_null(out);
    memcpy(out, k->stage.position, size);
    return out;
}

/* A fader that is connected to the pose and pushed all the way, over hands that hold no contact
 * (0), or all of them. */
static void patch_to(known *k, uint32_t pose, bool adds, bool hold_all)
{
    static const mrt_channel fader = {"fader", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1};
    static const float pushed = 1.0f;
    const mrt_face *about = composer_about(k->composer);
    const mrt_channels input = {"box", &fader, &pushed, 0, 1};
    const mrt_frame frame = {.dt_s = 1.0, .inputs = &input, .input_count = 1};
    const guard fence = {.contact_count = about->contact_count, .reach_mm = 2000.0};
    mrt_pull below = {.mode = MRT_ANCHORED};
    error err = {""};
    patch of = {.count = 1};
    patch_plan *plan, *old;
    patch_bay bay;
    composer_part part[3];
    uint32_t count = 0;
    of.connection[0] = patch_connection_of(PATCH_POSE);
    (void)snprintf(of.connection[0].channel, sizeof of.connection[0].channel, "fader");
    (void)snprintf(of.connection[0].target, sizeof of.connection[0].target, "%s",
                   k->file.rig->pose[pose].name);
    of.connection[0].in[0] = of.connection[0].out[0] = 0.0;
    of.connection[0].in[1] = of.connection[0].out[1] = 1.0;
    of.connection[0].adds = adds;
    of.connection[0].picks_up = false;
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        below.dof[i] = hold_all && i < about->dof_count ? 0.0f : NAN;
    for (uint32_t i = 0; hold_all && i < about->contact_count; ++i)
        below.vector[below.count++] =
            (mrt_vector){about->contacts[i].rest, about->contacts[i].rest, 1 + i};
    patch_bay_init(&bay, &fence);
    must(patch_plan_create(&plan, &of, about, composer_rig(k->composer), composer_face(k->composer),
                           &err),
         &err);
    assert_true(patch_bay_set(&bay, plan, &old));
    for (int step = 0; step < 4; ++step)
        patch_bay_step(&bay, &frame, NULL, NULL, &below);
    const mrt_pull *pull[3] = {&below, &bay.pull[PATCH_INSTEAD], &bay.pull[PATCH_ADDED]};
    for (uint32_t i = 0; i < 3; ++i)
        if (pull[i]->mode == MRT_ANCHORED)
            part[count++] = (composer_part){.slot = i,
                                            .layer = i,
                                            .is_additive = i == 2,
                                            .is_fresh = true,
                                            .weight = 1.0,
                                            .gain = 1.0,
                                            .pull = pull[i]};
    composer_reset(k->composer);
    composer_move(k->composer, part, count, 0.01);
    composer_draw(k->composer);
    patch_bay_finish(&bay);
}

/* Whoever makes it: the portrait, a fader, alone or over a mapping that holds all contacts. */
static void a_pose_is_one_face(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        known *k = &faces[n];
        float *patched = malloc((size_t)3 * k->file.mesh.vertex_count * sizeof *patched);
        double worst = 0.0;
        assert_non_null(patched);
        for (uint32_t i = 0; i < k->file.rig->pose_count; ++i) {
            if (strcmp(k->file.rig->pose[i].name, "mouthClose") == 0)
                continue; /* its portrait has the jaw open */
            show(&k->stage, i);
            for (int way = 0; way < 4; way += 3) {
                patch_to(k, i, way & 1, way & 2);
                face *f = composer_face(k->composer);
                points_to_rows(patched, face_shown(f), face_order(f));
                const double apart = apart_mm(k, patched, k->stage.position);
                worst = fmax(worst, apart);
                if (!(apart < 0.05))
                    fail_msg("%s, way %d: %.2f mm", k->file.rig->pose[i].name, way, apart);
            }
        }
        print_message("  %s: at most %.4f mm apart\n", k->file.rig->name, worst);
        free(patched);
    }
}

/* What is on the stage, held by whatever contacts, is the pose that is made of it. */
static void a_pose_that_is_made_of_a_shape_is_that_shape(void **state)
{
    (void)state;
    static const char *const shown[] = {"viseme_U", "browInnerUp", "contempt"};
    for (int n = 0; n < FACES; ++n)
        for (size_t i = 0; i < sizeof shown / sizeof *shown; ++i) {
            known *k = &faces[n];
            rig *r = &k->stage.rig;
            const uint32_t pose = pose_named(r, shown[i]);
            error err = {""};
            rig_pose made;
            vec3 at[MRT_MAX_VECTORS];
            float dof[MRT_MAX_DOFS];
            show(&k->stage, pose);
            memcpy(dof, face_metered(k->stage.face)->dof, sizeof dof);
            float *was = copy_shown(k);
            for (uint32_t c = 0; c < r->contact_count; ++c)
                at[c] = face_contact_now(k->stage.face, 1 + c);
            must(rig_poses_of(&made, "made", k->stage.face, MRT_MAX_VECTORS, r, &k->stage.solver,
                              at, dof, &err),
                 &err);
            rig_pose had = r->pose[pose];
            r->pose[pose] = made;
            rig one = *r;
            one.pose = &r->pose[pose];
            one.pose_count = 1;
            must(rig_poses_complete(&one, 0, k->stage.face, &k->stage.solver, &err), &err);
            show(&k->stage, pose);
            const double apart = apart_mm(k, was, k->stage.position);
            print_message("  %s: %s: %u contacts are named, %.2f mm apart\n", r->name, shown[i],
                          r->pose[pose].pull_count, apart);
            assert_true(apart < 0.5);
            rig_pose_finish(&r->pose[pose]);
            r->pose[pose] = had;
            free(was);
        }
}

/* It is refused when it is performed; the face is there. */
static void a_pose_beyond_all_reach_stays_as_it_is(void **state)
{
    (void)state;
    known *k = &faces[MOAI];
    rig *r = &k->stage.rig;
    const uint32_t pose = pose_named(r, "joy");
    const vec3 had = r->pose[pose].pull_mm[0];
    error err = {""};
    r->pose[pose].pull_mm[0] = (vec3){1e15, 0, 0};
    must(rig_poses_complete(r, 0, k->stage.face, &k->stage.solver, &err), &err);
    assert_int_equal(r->pose[pose].follow_count, 0);
    assert_true(rig_poses_show(&k->stage, pose, &err) < 0);
    r->pose[pose].pull_mm[0] = had;
    must(rig_poses_complete(r, 0, k->stage.face, &k->stage.solver, &err), &err);
    assert_true(r->pose[pose].follow_count > 0);
}

/* And it is the face of the contacts that it names, to which the others are carried. */
static void what_a_pose_does_not_name_goes_with_what_it_names(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        known *k = &faces[n];
        error err = {""};
        const double stretch_most = k->stage.solver.stretch_most;
        k->stage.solver.stretch_most = -1.0;
        for (uint32_t i = 0; i < k->file.rig->pose_count; ++i) {
            const rig_pose *pose = &k->stage.rig.pose[i];
            show(&k->stage, i);
            float *complete = copy_shown(k);
            must(rig_poses_show_named(&k->stage, i, &err), &err);
            const double apart = apart_mm(k, complete, k->stage.position);
            if (!(apart < 1.0))
                fail_msg("%s: %.2f mm", pose->name, apart);
            free(complete);
        }
        k->stage.solver.stretch_most = stretch_most;
    }
}

/* ---- carried to another head ---- */

/* A rig of that face without poses, on that mesh, gets the face's poses. radius_mm 0: as it is. */
static void carry(rig *out, const known *k, const mesh *to, double radius_mm)
{
    error err = {""};
    rig_poses_stage stage;
    must(rig_copy(out, k->file.rig, &err), &err);
    for (uint32_t i = 0; i < out->pose_count; ++i)
        rig_pose_finish(&out->pose[i]);
    out->pose_count = 0;
    out->solver.radius = radius_mm > 0.0 ? radius_mm : out->solver.radius;
    must(rig_poses_stage_init(&stage, out, to, &k->file.topology, &err), &err);
    must(rig_poses_transfer(out, to, stage.face, k->file.rig, &k->file.mesh, &k->file.topology,
                            &err),
         &err);
    rig_poses_stage_finish(&stage);
}

static void a_pose_that_is_carried_to_its_own_face_stays_as_it_is(void **state)
{
    (void)state;
    const known *k = &faces[PUPPET];
    const rig *was = k->file.rig;
    rig r;
    carry(&r, k, &k->file.mesh, 0.0);
    assert_int_equal(r.pose_count, was->pose_count);
    for (uint32_t i = 0; i < r.pose_count; ++i) {
        assert_string_equal(r.pose[i].name, was->pose[i].name);
        assert_int_equal(r.pose[i].pull_count, was->pose[i].pull_count);
        for (uint32_t n = 0; n < r.pose[i].pull_count; ++n) {
            assert_int_equal(r.pose[i].pull_contact[n], was->pose[i].pull_contact[n]);
            assert_true(vec3_length(vec3_sub(r.pose[i].pull_mm[n], was->pose[i].pull_mm[n])) <
                        1e-6);
        }
    }
    rig_destroy(&r);
}

/* Fields that reach twice as far are what a mouth of half the size sees: a lip that rises would
 * lift the other one and the nose. */
static void what_a_carried_pose_does_not_name_goes_as_on_the_model(void **state)
{
    (void)state;
    known *k = &faces[PUPPET];
    const rig *was = &k->stage.rig;
    error err = {""};
    rig_poses_stage wide;
    rig r;
    double most = 0.0;
    carry(&r, k, &k->file.mesh, 2.0 * k->file.rig->solver.radius);
    must(rig_poses_stage_init(&wide, &r, &k->file.mesh, &k->file.topology, &err), &err);
    for (uint32_t i = 0; i < was->pose_count; ++i) {
        const rig_pose *pose = &was->pose[i];
        show(&k->stage, i);
        must(rig_poses_show(&wide, pose_named(&r, pose->name), &err), &err);
        for (uint32_t n = 0; n < was->contact_count; ++n) {
            const size_t v = was->contact[n].vertex;
            const float *a = k->stage.position + 3 * v, *b = wide.position + 3 * v;
            most = fmax(most, vec3_length((vec3){(double)(a[0] - b[0]), (double)(a[1] - b[1]),
                                                 (double)(a[2] - b[2])}));
            if (!(most < 1.0))
                fail_msg("%s, %s: %.2f mm", pose->name, was->contact[n].name, most);
        }
    }
    print_message("  contacts go as on the model within %.2f mm\n", most);
    rig_poses_stage_finish(&wide);
    rig_destroy(&r);
}

static vec3 pull_of(const rig *r, const char *pose, const char *contact)
{
    const rig_pose *found = &r->pose[pose_named(r, pose)];
    for (uint32_t i = 0; i < found->pull_count; ++i)
        if (found->pull_contact[i] == rig_find_contact(r, contact))
            return found->pull_mm[i];
    return (vec3){(double)NAN, (double)NAN, (double)NAN};
}

static void a_level_and_narrow_mouth_is_neither_turned_down_nor_closed(void **state)
{
    (void)state;
    static const char *const corner[] = {"mouth.corner.l", "mouth.corner.r"};
    const known *k = &faces[PUPPET];
    const rig *was = k->file.rig;
    rig r;
    mesh narrow = k->file.mesh;
    const size_t size = (size_t)3 * narrow.vertex_count * sizeof(float);
    narrow.position = malloc(size);
    assert_non_null(narrow.position);
    memcpy(narrow.position, k->file.mesh.position, size);
    for (int side = 0; side < 2; ++side) {
        const uint32_t v = was->contact[rig_find_contact(was, corner[side])].vertex;
        narrow.position[(size_t)3 * v] *= 0.6f;
        narrow.position[(size_t)3 * v + 1] = -38.5f; /* the middle of the lips */
    }
    carry(&r, k, &narrow, 0.0);
    const vec3 u = pull_of(&r, "viseme_U", corner[0]), f = pull_of(&r, "viseme_FF", corner[0]);
    const vec3 frown = pull_of(&r, "mouthFrownLeft", corner[0]);
    const vec3 smile = pull_of(&r, "mouthSmileLeft", corner[0]);
    print_message("  corner in U: %.1f mm of 57, then %.1f of 34; in FF %.1f mm down, then %.1f\n",
                  -pull_of(was, "viseme_U", corner[0]).x, -u.x,
                  -pull_of(was, "viseme_FF", corner[0]).y, -f.y);
    assert_true(fabs(u.x - 0.6 * 0.6 * pull_of(was, "viseme_U", corner[0]).x) < 1e-3);
    assert_true(f.y <= 0.0 && f.y > -0.1);
    assert_true(frown.y < -12.0); /* what means a mouth that goes down is no correction */
    assert_true(fabs(smile.x - pull_of(was, "mouthSmileLeft", corner[0]).x) < 1e-3); /* has room */
    free(narrow.position);
    rig_destroy(&r);
}

/* ---- expressions ---- */

/* Between the middles of the lips, mm. */
static double lips_apart(const rig_poses_stage *stage)
{
    const rig *r = &stage->rig;
    uint32_t upper = rig_find_contact(r, "lip.upper.mid"),
             lower = rig_find_contact(r, "lip.lower.mid");
    assert_true(upper != RIG_NONE && lower != RIG_NONE);
    const float *a = stage->position + (size_t)3 * r->contact[upper].vertex;
    const float *b = stage->position + (size_t)3 * r->contact[lower].vertex;
    return vec3_length((vec3){(double)(a[0] - b[0]), (double)(a[1] - b[1]), (double)(a[2] - b[2])});
}

/* How much higher the contact to the subject's left goes than its mirror, mm. */
static double leans_left(const known *k, const char *left, const char *right)
{
    const rig *r = &k->stage.rig;
    const size_t a = (size_t)3 * r->contact[rig_find_contact(r, left)].vertex + 1,
                 b = (size_t)3 * r->contact[rig_find_contact(r, right)].vertex + 1;
    return (double)(k->stage.position[a] - k->file.mesh.position[a]) -
           (double)(k->stage.position[b] - k->file.mesh.position[b]);
}

/* Each far from rest and from the others, none held back, what is one-sided is on its side. */
static void expressions_are_sound_and_told_apart(void **state)
{
    (void)state;
    static const char *const names[] = {"joy",  "sadness",   "anger",      "surprise",
                                        "fear", "disgust",   "contempt",   "sleepy",
                                        "smug", "wink_left", "wink_right", "brow_up"};
    enum { COUNT = sizeof names / sizeof *names };
    for (int n = 0; n < FACES; ++n) {
        known *k = &faces[n];
        float *shown[COUNT + 1];
        show(&k->stage, pose_named(&k->stage.rig, "viseme_sil"));
        const double lips_at_rest = lips_apart(&k->stage);
        shown[COUNT] = copy_shown(k);
        for (int i = 0; i < COUNT; ++i) {
            assert_string_equal(k->file.rig->pose[i].name, names[i]);
            assert_int_equal(k->file.rig->pose[i].part, POSE_WHOLE);
            show(&k->stage, (uint32_t)i);
            rig_poses_measure m = rig_poses_measured(&k->stage);
            if (!(m.least_determinant > 0.1 && m.penetration_mm < 0.1))
                fail_msg("%s: least determinant %.3f, penetration %.2f mm", names[i],
                         m.least_determinant, m.penetration_mm);
            if (!(face_metered(k->stage.face)->held_back_mm < 0.5))
                fail_msg("%s is held back", names[i]);
            shown[i] = copy_shown(k);
            if (strcmp(names[i], "joy") == 0 || strcmp(names[i], "surprise") == 0)
                assert_true(lips_apart(&k->stage) > lips_at_rest + 15.0);
            else if (strcmp(names[i], "contempt") == 0)
                assert_true(leans_left(k, "mouth.corner.l", "mouth.corner.r") > 10.0);
            else if (strcmp(names[i], "wink_right") == 0)
                assert_true(leans_left(k, "mouth.corner.l", "mouth.corner.r") < -6.0);
            else if (strcmp(names[i], "brow_up") == 0)
                assert_true(leans_left(k, "brow.mid.l", "brow.mid.r") > 10.0);
        }
        for (int i = 0; i <= COUNT; ++i)
            for (int other = 0; other < i; ++other)
                if (!(apart_mm(k, shown[i], shown[other]) > 7.0))
                    fail_msg("%s: %s and %s are one", k->file.rig->name,
                             i < COUNT ? names[i] : "rest", names[other]);
        for (int i = 0; i <= COUNT; ++i)
            free(shown[i]);
    }
}

/* ---- halves ---- */

static void contacts_belong_to_a_half_by_name_or_height(void **state)
{
    (void)state;
    static char *const names[] = {"lip.upper.mid", "brow.mid.l", "nose.tip", "nose.root",
                                  "high",          "low",        "lid.l",    "cheek.l"};
    static const double y[] = {-20, 40, 0, 20, 31, 10, 30, 5};
    static const rig_pose_part expected[] = {POSE_MOUTH, POSE_UPPER, POSE_MOUTH, POSE_UPPER,
                                             POSE_UPPER, POSE_MOUTH, POSE_UPPER, POSE_MOUTH};
    rig_contact contact[8] = {{0}};
    vec3 at[8];
    rig_pose_part part[8];
    for (int i = 0; i < 8; ++i) {
        contact[i].name = names[i];
        at[i] = (vec3){0, y[i], 0};
    }
    const rig r = {.contact = contact, .contact_count = 8};
    rig_poses_contact_parts(part, &r, at);
    for (int i = 0; i < 8; ++i)
        assert_int_equal(part[i], expected[i]);
    const rig unnamed = {.contact = contact + 4, .contact_count = 2};
    rig_poses_contact_parts(part, &unnamed, at + 4);
    assert_int_equal(part[0], POSE_WHOLE); /* nobody knows where the halves meet */
    assert_int_equal(rig_poses_dof_part("jaw.open"), POSE_MOUTH);
    assert_int_equal(rig_poses_dof_part("lid_upper.l.close"), POSE_UPPER);
    assert_int_equal(rig_poses_dof_part("skull.turn"), POSE_WHOLE);
}

static rig_pose sum_of(const rig_pose *a, const rig_pose *b)
{
    rig_pose out = {.name = strdup("sum"),
                    .dof_name = calloc(MRT_MAX_DOFS, sizeof *out.dof_name),
                    .dof_value = calloc(MRT_MAX_DOFS, sizeof *out.dof_value),
                    .pull_contact = calloc(MRT_MAX_VECTORS, sizeof *out.pull_contact),
                    .pull_mm = calloc(MRT_MAX_VECTORS, sizeof *out.pull_mm)};
    for (int of = 0; of < 2; ++of) {
        const rig_pose *from = of == 0 ? a : b;
        for (uint32_t i = 0; i < from->dof_count; ++i) {
            out.dof_name[out.dof_count] = strdup(from->dof_name[i]);
            out.dof_value[out.dof_count++] = from->dof_value[i];
        }
        for (uint32_t i = 0; i < from->pull_count + from->follow_count; ++i) {
            out.pull_contact[out.pull_count] = from->pull_contact[i];
            out.pull_mm[out.pull_count++] = from->pull_mm[i];
        }
    }
    return out;
}

/* At each vertex the way of the mouth and the way of the upper half. */
static void a_mouth_and_an_upper_half_add_without_touching(void **state)
{
    (void)state;
    static const char *const mouths[] = {"viseme_aa", "viseme_U", "viseme_PP", "mouthSmileLeft"};
    static const char *const uppers[] = {"browInnerUp", "browDownLeft", "eyeBlinkRight"};
    known *k = &faces[PUPPET];
    rig *r = &k->stage.rig;
    rig_pose *grown = realloc(r->pose, (r->pose_count + (size_t)1) * sizeof *grown);
    double worst = 0.0;
    assert_non_null(grown);
    r->pose = grown;
    k->stage.solver.stretch_most = -1.0;
    for (size_t m = 0; m < sizeof mouths / sizeof *mouths; ++m)
        for (size_t u = 0; u < sizeof uppers / sizeof *uppers; ++u) {
            const uint32_t mouth = pose_named(r, mouths[m]), upper = pose_named(r, uppers[u]);
            assert_int_equal(r->pose[mouth].part, POSE_MOUTH);
            assert_int_equal(r->pose[upper].part, POSE_UPPER);
            show(&k->stage, mouth);
            float *expected = copy_shown(k);
            show(&k->stage, upper);
            for (size_t i = 0; i < (size_t)3 * k->file.mesh.vertex_count; ++i)
                expected[i] += k->stage.position[i] - k->file.mesh.position[i];
            r->pose[r->pose_count] = sum_of(&r->pose[mouth], &r->pose[upper]);
            r->pose_count += 1;
            show(&k->stage, r->pose_count - 1);
            const double apart = apart_mm(k, expected, k->stage.position);
            worst = fmax(worst, apart);
            if (!(apart < 0.05))
                fail_msg("%s and %s: %.2f mm", mouths[m], uppers[u], apart);
            rig_pose_finish(&r->pose[--r->pose_count]);
            free(expected);
        }
    k->stage.solver.stretch_most = k->file.rig->solver.stretch_most;
    print_message("  sums: at most %.4f mm\n", worst);
}

/* Every pose with a mark keeps to its half. */
static void marks_of_the_faces_are_true(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        const rig *r = &faces[n].stage.rig;
        rig_pose_part part[MRT_MAX_VECTORS];
        vec3 at[MRT_MAX_VECTORS];
        uint32_t marked = 0;
        for (uint32_t i = 0; i < r->contact_count; ++i)
            at[i] = mesh_position(&faces[n].file.mesh, r->contact[i].vertex);
        rig_poses_contact_parts(part, r, at);
        for (uint32_t i = 0; i < r->pose_count; ++i) {
            const rig_pose *pose = &r->pose[i];
            marked += pose->part != POSE_WHOLE;
            for (uint32_t k = 0; k < pose->pull_count + pose->follow_count; ++k)
                if (pose->part != POSE_WHOLE && part[pose->pull_contact[k]] != pose->part)
                    fail_msg("%s pulls %s", pose->name, r->contact[pose->pull_contact[k]].name);
        }
        assert_true(marked > 50);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pulls_ride_on_turned_bones),
        cmocka_unit_test(a_pose_is_one_face),
        cmocka_unit_test(a_pose_that_is_made_of_a_shape_is_that_shape),
        cmocka_unit_test(a_pose_beyond_all_reach_stays_as_it_is),
        cmocka_unit_test(what_a_pose_does_not_name_goes_with_what_it_names),
        cmocka_unit_test(contacts_belong_to_a_half_by_name_or_height),
        cmocka_unit_test(a_mouth_and_an_upper_half_add_without_touching),
        cmocka_unit_test(marks_of_the_faces_are_true),
        cmocka_unit_test(no_pose_is_left_in_the_next),
        cmocka_unit_test(a_pose_that_folds_is_measured_as_one),
        cmocka_unit_test(a_shape_becomes_a_pose_that_gives_the_shape),
        cmocka_unit_test(a_pose_that_is_carried_to_its_own_face_stays_as_it_is),
        cmocka_unit_test(what_a_carried_pose_does_not_name_goes_as_on_the_model),
        cmocka_unit_test(a_level_and_narrow_mouth_is_neither_turned_down_nor_closed),
        cmocka_unit_test(expressions_are_sound_and_told_apart),
    };
    return cmocka_run_group_tests(tests, open_faces, close_faces);
}
