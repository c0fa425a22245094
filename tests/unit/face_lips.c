/* Lips meet, and never pass through each other: the seal of the puppet's mouth under bones, pulls
 * and poses; and rims that cannot be sealed. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/face.h"
#include "face/rig_check.h"
#include "mesh/position.h"
#include "slit.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HANDS = 60 };

typedef struct actor {
    face_file file;
    face *face;
    csrbf_settings settings;
} actor;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void make_face(actor *a)
{
    error err = {""};
    must(
        face_create(&a->face, a->file.rig, &a->file.mesh, &a->file.topology, MRT_MAX_VECTORS, &err),
        &err);
    a->settings = a->file.rig->solver;
}

static void read_puppet(actor *out)
{
    error err = {""};
    *out = (actor){0};
    must(face_file_read(&out->file, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL,
                        FACE_FILE_USABLE, &err),
         &err);
}

static void open_puppet(actor *out)
{
    read_puppet(out);
    make_face(out);
}

static void close_actor(actor *a)
{
    face_destroy(a->face);
    face_file_destroy(&a->file);
}

static vec3 shown(const actor *a, uint32_t vertex)
{
    return slit_shown(a->face, vertex);
}

static uint32_t dof_named(const actor *a, const char *name)
{
    const uint32_t dof = slit_dof(a->face, name);
    assert_true(dof != RIG_NONE);
    return dof;
}

static const rig_pose *pose_named(const actor *a, const char *name)
{
    for (uint32_t i = 0; name && i < a->file.rig->pose_count; ++i)
        if (strcmp(a->file.rig->pose[i].name, name) == 0)
            return &a->file.rig->pose[i];
    if (name)
        fail_msg("there is no pose %s", name);
    return NULL;
}

/* All contacts are held. pull: contact_count by 3, with the bones at rest. */
static void hold(actor *a, const double *pull, const float *dof)
{
    error err = {""};
    const rig *r = a->file.rig;
    const uint32_t count = r->contact_count;
    face_control *control = calloc(count, sizeof *control);
    double *end = calloc((size_t)3 * count, sizeof *end);
    uint8_t *rides = calloc(count, 1);
    assert_true(control && end && rides);
    for (uint32_t i = 0; i < count; ++i) {
        control[i] = (face_control){.start = mesh_position(&a->file.mesh, r->contact[i].vertex),
                                    .contact = 1 + i};
        rides[i] = 1;
    }
    memcpy(end, pull, (size_t)3 * count * sizeof *end);
    face_reset(a->face);
    must(face_engage(a->face, &a->settings, control, count, &err), &err);
    face_ride(a->face, end, rides, dof);
    must(face_pull(a->face, end, dof, &err), &err);
    free(control);
    free(end);
    free(rides);
}

/* A pose (NULL: rest) over a jaw that is opened further. */
static void perform(actor *a, const rig_pose *pose, double jaw_deg, double seal)
{
    double *pull = calloc((size_t)3 * a->file.rig->contact_count, sizeof *pull);
    float dof[MRT_MAX_DOFS] = {0};
    assert_non_null(pull);
    for (uint32_t i = 0; pose && i < pose->pull_count; ++i) {
        double *to = pull + (size_t)3 * pose->pull_contact[i];
        to[0] = pose->pull_mm[i].x;
        to[1] = pose->pull_mm[i].y;
        to[2] = pose->pull_mm[i].z;
    }
    for (uint32_t i = 0; pose && i < pose->dof_count; ++i)
        dof[dof_named(a, pose->dof_name[i])] = (float)pose->dof_value[i];
    dof[dof_named(a, "jaw.open")] += (float)(jaw_deg * 3.14159265358979 / 180.0);
    if (seal > 0.0)
        dof[dof_named(a, "lips.seal")] = (float)seal;
    hold(a, pull, dof);
    free(pull);
}

/* In the frame of the skull. */
static vec3 unturned(const actor *a, uint32_t vertex)
{
    rigid pose[RIG_BONES_MAX];
    bones_pose(pose, face_bones(a->face), face_metered(a->face)->dof);
    const rigid back = rigid_inverse(&pose[rig_find_bone(a->file.rig, "skull")]);
    return rigid_apply(&back, shown(a, vertex));
}

static vec3 unturned_place(const void *of, uint32_t vertex)
{
    return unturned(of, vertex);
}

static slit measure(const actor *a)
{
    slit out;
    if (!slit_measure(&out, &a->file.rig->mouth, unturned_place, a))
        fail_msg("a rim does not go from corner to corner");
    return out;
}

static void sealed_lips_meet_over_an_open_jaw(void **state)
{
    (void)state;
    static const char *const over[] = {
        NULL, "mouthSmileLeft", "mouthFrownLeft", "mouthStretchLeft", "mouthPucker", "jawLeft"};
    static const double jaw_deg[] = {0, 3, 6, 10};
    slit worst = {0.0, 0.0};
    actor a;
    open_puppet(&a);
    for (size_t p = 0; p < sizeof over / sizeof *over; ++p)
        for (size_t j = 0; j < sizeof jaw_deg / sizeof *jaw_deg; ++j) {
            perform(&a, pose_named(&a, over[p]), jaw_deg[j], 1.0);
            slit now = measure(&a);
            worst.gap = fmax(worst.gap, now.gap);
            worst.overlap = fmax(worst.overlap, now.overlap);
            assert_true(face_min_determinant(a.face) > 0.0);
        }
    print_message("sealed, jaw at 0 to 10 degrees: gap %.3f, overlap %.3f mm at most\n", worst.gap,
                  worst.overlap);
    assert_true(worst.gap < 0.3 && worst.overlap < 0.3);
    close_actor(&a);
}

static void lips_close_bit_by_bit_and_never_jump(void **state)
{
    (void)state;
    actor a;
    open_puppet(&a);
    double last = -1.0;
    for (int k = 0; k <= 50; ++k) {
        perform(&a, NULL, 8.0, k / 50.0);
        double gap = measure(&a).gap;
        if (last >= 0.0)
            assert_true(gap < last + 0.05 && gap > last - 1.5);
        last = gap;
    }
    assert_true(last < 0.1);
    close_actor(&a);
}

static void no_pose_makes_the_lips_cross(void **state)
{
    (void)state;
    double worst = 0.0;
    const char *of = "";
    actor a;
    open_puppet(&a);
    for (uint32_t i = 0; i < a.file.rig->pose_count; ++i) {
        perform(&a, &a.file.rig->pose[i], 0.0, 0.0);
        double overlap = measure(&a).overlap;
        of = overlap > worst ? a.file.rig->pose[i].name : of;
        worst = fmax(worst, overlap);
    }
    print_message("in all poses the lips overlap by %.3f mm at most (%s)\n", worst, of);
    assert_true(worst < 0.3);
    close_actor(&a);
}

static double random_within(uint64_t *state, double low, double high)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(*state >> 11) / 9007199254740992.0;
}

/* Each contact anywhere within 12 mm, the jaw anywhere, sealed or not. */
static void nothing_that_is_pulled_makes_the_lips_cross(void **state)
{
    (void)state;
    uint64_t random = 36;
    double worst = 0.0;
    actor a;
    open_puppet(&a);
    const uint32_t count = a.file.rig->contact_count;
    double *pull = calloc((size_t)3 * count, sizeof *pull);
    assert_non_null(pull);
    for (int hand = 0; hand < HANDS; ++hand) {
        float dof[MRT_MAX_DOFS] = {0};
        for (size_t i = 0; i < (size_t)3 * count; ++i)
            pull[i] = random_within(&random, -12.0, 12.0);
        dof[dof_named(&a, "jaw.open")] = (float)random_within(&random, 0.0, 0.3);
        dof[dof_named(&a, "jaw.lateral")] = (float)random_within(&random, -6.0, 6.0);
        dof[dof_named(&a, "lips.seal")] = hand % 2 ? (float)random_within(&random, 0.0, 1.0) : 0.0f;
        hold(&a, pull, dof);
        worst = fmax(worst, measure(&a).overlap);
        assert_true(face_min_determinant(a.face) > 0.0);
    }
    print_message("random pulls: the lips overlap by %.3f mm at most\n", worst);
    assert_true(worst < 0.3);
    free(pull);
    close_actor(&a);
}

/* How far its foremost point is before the edge of the lips, in the middle. */
static double tongue_before_lips(const actor *a)
{
    const uint32_t bone = rig_find_bone(a->file.rig, "tongue");
    const binding *b = face_binding(a->face);
    const rig_mouth *mouth = &a->file.rig->mouth;
    double tip = -INFINITY;
    for (uint32_t v = 0; v < b->vertex_count; ++v)
        if (b->weight[(size_t)bone * b->vertex_count + v] > 0.99f)
            tip = fmax(tip, unturned(a, v).z);
    return tip - fmin(unturned(a, mouth->upper[mouth->upper_count / 2]).z,
                      unturned(a, mouth->lower[mouth->lower_count / 2]).z);
}

/* One lip far to the left and up, the other to the right: what faces each other now is far apart at
 * rest. */
static void lips_that_are_pulled_far_aside_do_not_cross(void **state)
{
    (void)state;
    static const char *const lip[2][3] = {
        {"lip.upper.side.l", "lip.upper.mid", "lip.upper.side.r"},
        {"lip.lower.side.l", "lip.lower.mid", "lip.lower.side.r"}};
    actor a;
    open_puppet(&a);
    double *pull = calloc((size_t)3 * a.file.rig->contact_count, sizeof *pull);
    const float dof[MRT_MAX_DOFS] = {0};
    assert_non_null(pull);
    for (int side = -1; side <= 1; side += 2) {
        for (int rim = 0; rim < 2; ++rim)
            for (int i = 0; i < 3; ++i) {
                const uint32_t contact = rig_find_contact(a.file.rig, lip[rim][i]);
                pull[3 * contact] = (rim ? 18.0 : -18.0) * side;
                pull[3 * contact + 1] = rim ? 8.0 : -4.0;
            }
        hold(&a, pull, dof);
        const double overlap = measure(&a).overlap;
        print_message("pulled aside, the lips overlap by %.3f mm\n", overlap);
        assert_true(overlap < 0.3);
    }
    free(pull);
    close_actor(&a);
}

static void put_tongue_out(actor *a, double jaw_deg, double seal, float out)
{
    const rig_bone *bone = &a->file.rig->bone[rig_find_bone(a->file.rig, "tongue")];
    double *pull = calloc((size_t)3 * a->file.rig->contact_count, sizeof *pull);
    float dof[MRT_MAX_DOFS] = {0};
    assert_non_null(pull);
    dof[dof_named(a, "tongue.out")] = out * (float)bone->turn[0].max_rad;
    dof[dof_named(a, "jaw.open")] = (float)(jaw_deg * 3.14159265358979 / 180.0);
    dof[dof_named(a, "lips.seal")] = (float)seal;
    hold(a, pull, dof);
    free(pull);
}

static void the_tongue_stays_behind_closed_lips(void **state)
{
    (void)state;
    actor a;
    double last = 0.0, step = 0.0;
    open_puppet(&a);
    for (double jaw_deg = 0.0; jaw_deg <= 10.0; jaw_deg += 2.0) {
        put_tongue_out(&a, jaw_deg, 1.0, 1.0f);
        assert_true(tongue_before_lips(&a) < -1.5);
    }
    put_tongue_out(&a, 0.0, 0.0, 1.0f);
    assert_true(tongue_before_lips(&a) < -1.5);
    for (double jaw_deg = 0.0; jaw_deg <= 20.0; jaw_deg += 0.25) { /* it comes out with the gap */
        put_tongue_out(&a, jaw_deg, 0.0, 1.0f);
        double before = tongue_before_lips(&a);
        if (jaw_deg > 0.0)
            step = fmax(step, fabs(before - last));
        last = before;
    }
    print_message(
        "jaw at 20 degrees: the tongue is %.1f mm before the lips, %.2f mm a step at most\n", last,
        step);
    assert_true(last > 15.0 && step < 1.0);
    put_tongue_out(&a, 20.0, 1.0, 1.0f);
    float full = (float)a.file.rig->bone[rig_find_bone(a.file.rig, "tongue")].turn[0].max_rad;
    /* what a recording and an export have */
    assert_true(face_metered(a.face)->dof[dof_named(&a, "tongue.out")] < 0.9f * full);
    close_actor(&a);
}

static void at_rest_nothing_moves(void **state)
{
    (void)state;
    error err = {""};
    actor a;
    open_puppet(&a);
    must(face_pull(a.face, NULL, NULL, &err), &err);
    const points *now = face_shown(a.face), *rest = face_rest(a.face);
    assert_memory_equal(now->x, rest->x, rest->count * sizeof(float));
    assert_memory_equal(now->y, rest->y, rest->count * sizeof(float));
    assert_memory_equal(now->z, rest->z, rest->count * sizeof(float));
    assert_true(face_columns_now(a.face).is_exact);
    close_actor(&a);
}

static void the_same_frame_has_the_same_bits_whatever_came_before(void **state)
{
    (void)state;
    actor a, b;
    open_puppet(&a);
    open_puppet(&b);
    perform(&a, pose_named(&a, "mouthPucker"), 12.0, 0.4);
    perform(&a, pose_named(&a, "mouthSmileLeft"), 7.0, 0.9);
    perform(&b, pose_named(&b, "mouthSmileLeft"), 7.0, 0.9);
    const points *p = face_shown(a.face), *q = face_shown(b.face);
    assert_memory_equal(p->x, q->x, p->count * sizeof(float));
    assert_memory_equal(p->y, q->y, p->count * sizeof(float));
    assert_memory_equal(p->z, q->z, p->count * sizeof(float));
    assert_false(face_columns_now(a.face).is_exact);
    close_actor(&a);
    close_actor(&b);
}

static void sticky_lips_part_late(void **state)
{
    (void)state;
    actor plain, sticky;
    open_puppet(&plain);
    read_puppet(&sticky);
    sticky.file.rig->mouth.stickiness_mm = 6.0;
    make_face(&sticky);
    double last = 0.0;
    for (double jaw_deg = 0.0; jaw_deg <= 8.0; jaw_deg += 0.25) {
        perform(&plain, NULL, jaw_deg, 0.0);
        perform(&sticky, NULL, jaw_deg, 0.0);
        double free_gap = measure(&plain).gap, gap = measure(&sticky).gap;
        assert_true(gap < free_gap + 0.01 && gap > last - 0.01);
        if (free_gap > 1.0 && free_gap < 3.0)
            assert_true(gap < 0.6 * free_gap);
        if (free_gap > 7.0)
            assert_true(gap > free_gap - 0.1);
        last = gap;
    }
    close_actor(&plain);
    close_actor(&sticky);
}

/* ---- rims that cannot be sealed ---- */

static void turn_around(uint32_t *rim, uint32_t count)
{
    for (uint32_t i = 0; i < count / 2; ++i) {
        uint32_t first = rim[i];
        rim[i] = rim[count - 1 - i];
        rim[count - 1 - i] = first;
    }
}

static void turn_both(rig *r)
{
    turn_around(r->mouth.upper, r->mouth.upper_count);
    turn_around(r->mouth.lower, r->mouth.lower_count);
}
static void cut_lower(rig *r)
{
    r->mouth.lower_count /= 2;
}
static void double_vertex(rig *r)
{
    r->mouth.upper[4] = r->mouth.upper[7];
}
static void share_vertex(rig *r)
{
    r->mouth.upper[9] = r->mouth.lower[9];
}
static void close_ring(rig *r)
{
    r->mouth.upper[r->mouth.upper_count - 1] = r->mouth.upper[1] == 0 ? 1 : r->mouth.upper[1] - 1;
}
static void name_stranger(rig *r)
{
    r->mouth.lower[3] = UINT32_C(4000000);
}
static void name_an_eye(rig *r)
{
    r->mouth.lower[3] = r->mesh_vertex_count - 1;
}

static void rims_that_are_none_are_named_and_the_face_performs(void **state)
{
    (void)state;
    static const struct {
        void (*spoil)(rig *r);
        const char *says;
    } cases[] = {{turn_both, "reverse their lists"},
                 {cut_lower, "mm apart"},
                 {double_vertex, "are the same point"},
                 {share_vertex, "are the same point"},
                 {close_ring, "upper["},
                 {name_stranger, "does not exist, the mesh has"},
                 {name_an_eye, "another piece of surface"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        rig_findings findings = {0};
        error err = {""};
        actor a;
        bool is_said = false;
        read_puppet(&a);
        cases[i].spoil(a.file.rig);
        make_face(&a);
        perform(&a, NULL, 6.0, 1.0);
        assert_int_equal(face_binding(a.face)->lips.station_count, 0);
        assert_true(face_min_determinant(a.face) > 0.0);
        must(rig_check(&findings, a.file.rig, &a.file.mesh, &a.file.topology, face_binding(a.face),
                       &err),
             &err);
        for (uint32_t k = 0; k < findings.count; ++k)
            is_said = is_said || (strstr(findings.item[k].path, "mouth") &&
                                  strstr(findings.item[k].text, cases[i].says));
        if (!is_said)
            fail_msg("case %zu: %s", i, face_binding(a.face)->lips.why_not);
        rig_findings_finish(&findings);
        close_actor(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sealed_lips_meet_over_an_open_jaw),
        cmocka_unit_test(lips_close_bit_by_bit_and_never_jump),
        cmocka_unit_test(no_pose_makes_the_lips_cross),
        cmocka_unit_test(nothing_that_is_pulled_makes_the_lips_cross),
        cmocka_unit_test(lips_that_are_pulled_far_aside_do_not_cross),
        cmocka_unit_test(the_tongue_stays_behind_closed_lips),
        cmocka_unit_test(at_rest_nothing_moves),
        cmocka_unit_test(the_same_frame_has_the_same_bits_whatever_came_before),
        cmocka_unit_test(sticky_lips_part_late),
        cmocka_unit_test(rims_that_are_none_are_named_and_the_face_performs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
