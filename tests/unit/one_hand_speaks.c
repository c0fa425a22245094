/* plugins/one_hand, speaking: each face of the rig is met at its hand pose, halves do not touch
 * each other, the thumb closes the lips, a hand at rest is a face at rest, and answers are learned.
 * On the puppet, through the plugin as it is loaded. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "own_hands.h"
#include "mapping.h"
#include "one_hand_bench.h"
#include "speak.h"
#include "stage/perform/composer.h"

static face_file puppet;
static composer *stage;
static const mapped_face *puppet_face;
static const char *const device_params[DEVICE_KINDS] = {
    "samples=1,mode=speaking,device=every_joint", "samples=1,mode=speaking,device=points",
    "samples=1,mode=speaking,device=five_curls"};

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static int open_puppet(void **state)
{
    (void)state;
    error err = {""};
    const csrbf_settings of_rig = {0};
    must(face_file_read(&puppet, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                        &err),
         &err);
    must(composer_create(&stage, &puppet, &of_rig, &err), &err);
    puppet_face = composer_mapped(stage);
    return 0;
}

static int close_puppet(void **state)
{
    (void)state;
    composer_destroy(stage);
    face_file_destroy(&puppet);
    return 0;
}

static void set_up_with(bench *b, const mapped_face *mapped, const char *params)
{
    error err = {""};
    bench_create(b, params);
    b->face = &mapped->about;
    must(instance_activate(&b->plugin, mapped, &err), &err);
    b->functions->reset(b->plugin.self);
    bench_step(b, MRT_RIGHT, bench_talk); /* neutral */
}

static void set_up(bench *b, const char *params)
{
    set_up_with(b, puppet_face, params);
}

static const int sensor_of[JOINT_COUNT] = {3, 1, 2, 5, 8, -1, 11, 12, 15, 16, 4, 7, 0, 19};

static void bend_by(float angle[MRT_ANGLES], const double deg[JOINT_COUNT])
{
    static const int spreads[] = {10, 14, 18};
    memcpy(angle, bench_talk, MRT_ANGLES * sizeof *angle);
    for (int i = 0; i < JOINT_COUNT; ++i)
        for (int k = 0; k < 3; ++k)
            if (i == JOINT_SPREAD)
                angle[spreads[k]] += RAD((float)deg[i]);
            else if (k == 0)
                angle[sensor_of[i]] += RAD((float)deg[i]);
}

/* Goes there in small steps and stays until all that takes time has come to rest. */
static void hold(bench *b, const double deg[JOINT_COUNT])
{
    float from[MRT_ANGLES], to[MRT_ANGLES], angle[MRT_ANGLES];
    memcpy(from, b->frame.hand[MRT_RIGHT].angle, sizeof from);
    bend_by(to, deg);
    for (int n = 1; n <= 60; ++n) {
        for (int i = 0; i < MRT_ANGLES; ++i)
            angle[i] = from[i] + (to[i] - from[i]) * fminf((float)n / 20.0f, 1.0f);
        bench_step(b, MRT_RIGHT, angle);
    }
}

static void hand_of(double out[JOINT_COUNT], device_kind device, int f)
{
    for (int i = 0; i < JOINT_COUNT; ++i)
        out[i] = (double)posed_hands[device][f].deg[i];
}

/* mm, with weights for degrees of freedom: mm of lip, iris and lid. */
typedef struct faces_apart {
    double worst_mm, mean_mm; /* mean: root mean square over the contacts of the half */
} faces_apart;

static fitting fit_puppet(void)
{
    fitting out;
    assert_true(fitting_find(&out, &puppet_face->about));
    return out;
}

static void pose_of_pull(pose *out, const bench *b, const fitting *fit)
{
    mrt_vec3 way[MRT_MAX_VECTORS] = {{0, 0, 0}};
    for (uint32_t i = 0; i < b->pull.count; ++i) {
        const mrt_vector *v = &b->pull.vector[i];
        way[v->contact - 1] = vec_difference(v->end, v->start);
    }
    const mrt_rig_pose as = {"", way, b->pull.dof, MRT_POSE_WHOLE};
    memset(out, 0, sizeof *out);
    fitting_add(out, fit, &as, 1.0);
}

static faces_apart apart(const pose *a, const pose *b, face_half which)
{
    faces_apart out = {0.0, 0.0};
    int count = 0;
    for (int v = 0; v < POSE_COUNT; ++v) {
        if (half_of_value(v) != which)
            continue;
        static const double mm_of_dof[DOF_COUNT] = {60, 1,  1,  0, 0, 12, 12, 12,
                                                    12, 24, 24, 9, 9, 5,  60};
        const double by =
            (v < POSE_DOFS ? 1.0 : mm_of_dof[v - POSE_DOFS]) * fabs(a->value[v] - b->value[v]);
        out.worst_mm = fmax(out.worst_mm, by);
        out.mean_mm += by * by;
        count += 1;
    }
    out.mean_mm = sqrt(out.mean_mm / count);
    return out;
}

static bool face_of(pose *out, int f, const fitting *fit)
{
    return face_find(out, &face_recipes[f], fit, puppet_face->pose, puppet_face->pose_count);
}

static void every_face_is_met_at_its_hand_pose(void **state)
{
    (void)state;
    const fitting fit = fit_puppet();
    for (int device = 0; device < DEVICE_KINDS; ++device) {
        bench b;
        double worst = 0.0;
        int count = 0;
        set_up(&b, device_params[device]);
        for (int f = 0; f < FACE_COUNT; ++f) {
            pose wanted, found;
            double deg[JOINT_COUNT];
            if (posed_hands[device][f].same_as != FACE_IS_ITSELF)
                continue;
            assert_true(face_of(&wanted, f, &fit));
            hand_of(deg, (device_kind)device, f);
            hold(&b, deg);
            pose_of_pull(&found, &b, &fit);
            const double off = apart(&wanted, &found, face_recipes[f].half).worst_mm;
            if (!(off < 0.05))
                fail_msg("%s is missed by %.2f mm", face_recipes[f].name, off);
            worst = fmax(worst, off);
            count += 1;
        }
        print_message("  device %d: %d faces, missed by %.3f mm at most\n", device, count, worst);
        assert_true(count >= (device == DEVICE_CURLS ? 40 : 60));
        bench_tear_down(&b);
    }
}

/* Bit for bit. */
static void mouth_and_upper_half_do_not_touch_each_other(void **state)
{
    (void)state;
    const fitting fit = fit_puppet();
    for (int device = 0; device < DEVICE_KINDS; ++device) {
        bench b;
        set_up(&b, device_params[device]);
        for (int mouth = 0; mouth < FACE_COUNT; mouth += 3)
            for (int upper = 0; upper < FACE_COUNT; upper += 5) {
                pose alone[HALF_COUNT], both;
                double deg[HALF_COUNT][JOINT_COUNT], sum[JOINT_COUNT];
                if (face_recipes[mouth].half != HALF_MOUTH ||
                    face_recipes[upper].half != HALF_UPPER)
                    continue;
                hand_of(deg[0], (device_kind)device, mouth);
                hand_of(deg[1], (device_kind)device, upper);
                for (int which = 0; which < HALF_COUNT; ++which) {
                    hold(&b, deg[which]);
                    pose_of_pull(&alone[which], &b, &fit);
                }
                for (int i = 0; i < JOINT_COUNT; ++i)
                    sum[i] = deg[0][i] + deg[1][i];
                hold(&b, sum);
                pose_of_pull(&both, &b, &fit);
                for (int which = 0; which < HALF_COUNT; ++which)
                    assert_true(apart(&alone[which], &both, (face_half)which).worst_mm < 1e-4);
            }
        bench_tear_down(&b);
    }
}

static void nothing_moves_within_the_well(void **state)
{
    (void)state;
    const fitting fit = fit_puppet();
    const pose rest = {{0}};
    bench b;
    uint32_t random = 3;
    set_up(&b, device_params[DEVICE_JOINTS]);
    for (int n = 0; n < 300; ++n) {
        double deg[JOINT_COUNT];
        float angle[MRT_ANGLES];
        pose found;
        for (int i = 0; i < JOINT_COUNT; ++i) { /* within 1.4 degrees */
            random = random * 1664525u + 1013904223u;
            deg[i] = 1.4 * ((double)(random >> 8) / 8388608.0 - 1.0);
        }
        bend_by(angle, deg);
        bench_step(&b, MRT_RIGHT, angle);
        pose_of_pull(&found, &b, &fit);
        assert_true(memcmp(&found, &rest, sizeof rest) == 0);
    }
    bench_tear_down(&b);
}

static double seal_of(bench *b, double press_deg, double jaw_deg)
{
    double deg[JOINT_COUNT] = {[JOINT_THUMB_MIDDLE] = press_deg, [JOINT_THUMB_DROP] = jaw_deg};
    hold(b, deg);
    return (double)bench_dof(b, "lips.seal");
}

/* Closed from 11 degrees on, and until less than half of it is left. */
static void a_pressed_thumb_closes_the_lips(void **state)
{
    (void)state;
    bench b;
    set_up(&b, device_params[DEVICE_JOINTS]);
    assert_true(seal_of(&b, 8.0, 0.0) < 0.6);
    assert_true(seal_of(&b, 12.0, 0.0) >= 1.0);
    assert_true(seal_of(&b, 8.0, 0.0) >= 1.0);
    assert_true(seal_of(&b, 4.0, 0.0) < 0.3);
    assert_true(seal_of(&b, 20.0, 16.0) >= 1.0);
    print_message("  pressed over an open jaw: %.1f degrees\n",
                  57.3 * (double)bench_dof(&b, "jaw.open"));
    assert_true(bench_dof(&b, "jaw.open") > RAD(5.0f));
    bench_tear_down(&b);
}

/* As recorded hands talk: the thumb goes 14 degrees away from the palm while its joints stretch by
 * 11 and 5. */
static void a_talking_thumb_opens_the_jaw_and_nothing_else(void **state)
{
    (void)state;
    const double talk[JOINT_COUNT] = {
        [JOINT_THUMB_DROP] = 14.0, [JOINT_THUMB_MIDDLE] = -11.0, [JOINT_THUMB_TIP] = -5.0};
    static const double least_deg[] = {[DEVICE_JOINTS] = 6.0, [DEVICE_POINTS] = 9.0};
    for (int device = 0; device < DEVICE_CURLS; ++device) {
        bench b;
        set_up(&b, device_params[device]);
        hold(&b, talk);
        const double open_deg = 57.3 * (double)bench_dof(&b, "jaw.open");
        print_message("  a talking thumb: jaw %.1f degrees\n", open_deg);
        assert_true(open_deg > least_deg[device] && open_deg < 20.0);
        assert_true(fabsf(bench_dof(&b, "eye.l.yaw")) < 1e-6f);
        assert_true(fabsf(bench_dof(&b, "lid_upper.l.close")) < 1e-6f);
        bench_tear_down(&b);
    }
}

/* By points half of the way opens it by 0.4 at least, and a twentieth of the way by 0.073 at most.
 */
static void the_jaw_opens_evenly_by_points(void **state)
{
    (void)state;
    enum { STEPS = 20 };
    bench b;
    int widest = 0;
    double open_rad[STEPS + 1] = {0.0}, steepest = 0.0;
    while (strcmp(face_recipes[widest].name, "jaw open") != 0)
        widest += 1;
    set_up(&b, device_params[DEVICE_POINTS]);
    for (int n = 1; n <= STEPS; ++n) {
        double deg[JOINT_COUNT];
        hand_of(deg, DEVICE_POINTS, widest);
        for (int i = 0; i < JOINT_COUNT; ++i)
            deg[i] *= (double)n / STEPS;
        hold(&b, deg);
        open_rad[n] = (double)bench_dof(&b, "jaw.open");
        steepest = fmax(steepest, open_rad[n] - open_rad[n - 1]);
    }
    print_message("  half of the way opens %.2f, a step at most %.3f\n",
                  open_rad[STEPS / 2] / open_rad[STEPS], steepest / open_rad[STEPS]);
    assert_true(open_rad[STEPS / 2] > 0.4 * open_rad[STEPS]);
    assert_true(steepest < 0.073 * open_rad[STEPS]);
    bench_tear_down(&b);
}

/* Left less right: lids (1: one is closed), and brows in mm. */
typedef struct asides {
    double lid, brow_mm;
} asides;

static asides asides_of(bench *b, const double deg[JOINT_COUNT], const fitting *fit)
{
    pose found;
    hold(b, deg);
    pose_of_pull(&found, b, fit);
    return (asides){
        found.value[POSE_DOFS + DOF_LID_UPPER] - found.value[POSE_DOFS + DOF_LID_UPPER + 1],
        found.value[3 * LANDMARK_BROW_MID + 1] - found.value[3 * (LANDMARK_BROW_MID + 1) + 1]};
}

/* The same before the passage and behind it, however far the thumb is rolled; and on the way back.
 */
static void a_wink_and_one_brow_are_nearly_switches(void **state)
{
    (void)state;
    const fitting fit = fit_puppet();
    for (int device = 0; device < DEVICE_CURLS; ++device) {
        const roll_switch *with = &roll_switch_of[device];
        bench b;
        set_up(&b, device_params[device]);
        for (int side = -1; side <= 1; side += 2) {
            enum { FURTHEST = 20 };
            double wink[2 * FURTHEST + 1], brow[2 * FURTHEST + 1];
            for (int n = 0; n <= 2 * FURTHEST; ++n) { /* there and back */
                const double roll = side * (n <= FURTHEST ? n : 2 * FURTHEST - n);
                wink[n] =
                    side * asides_of(&b,
                                     (double[JOINT_COUNT]){
                                         [JOINT_MIDDLE_KNUCKLE] = 19.0, [JOINT_THUMB_ROLL] = roll},
                                     &fit)
                               .lid;
            }
            for (int n = 0; n <= 2 * FURTHEST; ++n) {
                const double roll = side * (n <= FURTHEST ? n : 2 * FURTHEST - n);
                brow[n] =
                    side * asides_of(&b,
                                     (double[JOINT_COUNT]){
                                         [JOINT_INDEX_KNUCKLE] = -11.0, [JOINT_THUMB_ROLL] = roll},
                                     &fit)
                               .brow_mm;
            }
            print_message("  device %d, side %d: lid %.2f to %.2f, brow %.1f to %.1f mm\n", device,
                          side, wink[0], wink[FURTHEST], brow[0], brow[FURTHEST]);
            for (int n = 0; n <= FURTHEST; ++n) {
                const bool is_off = n <= with->least_deg, is_on = n >= with->most_deg;
                const int end = is_off ? 0 : FURTHEST;
                assert_true(fabs(wink[n] - wink[2 * FURTHEST - n]) < 1e-4);
                assert_true(fabs(brow[n] - brow[2 * FURTHEST - n]) < 1e-2);
                assert_true(n == 0 ||
                            (wink[n] > wink[n - 1] - 0.01 && brow[n] < brow[n - 1] + 0.1));
                if (is_off || is_on)
                    assert_true(fabs(wink[n] - wink[end]) < 0.01 &&
                                fabs(brow[n] - brow[end]) < 0.1);
            }
            assert_true(wink[FURTHEST] > 0.7 && brow[FURTHEST] < -4.0);
            assert_true(fabs(wink[0]) < 0.1 && fabs(brow[0]) < 2.0);
        }
        bench_tear_down(&b);
    }
}

/* As in shared/data/hands/02_i_r_ex02-rad-021, a hand that grasps. */
static void a_grasp_does_not_wink(void **state)
{
    (void)state;
    const fitting fit = fit_puppet();
    const double grasp[JOINT_COUNT] = {
        [JOINT_THUMB_DROP] = -34.0,  [JOINT_THUMB_TIP] = 28.0,     [JOINT_RING_KNUCKLE] = 60.0,
        [JOINT_LITTLE_KNUCKLE] = 82, [JOINT_INDEX_KNUCKLE] = 44.0, [JOINT_MIDDLE_KNUCKLE] = 32.0,
        [JOINT_THUMB_ROLL] = 67.0,   [JOINT_ARCH] = -26.0};
    for (int device = 0; device < DEVICE_CURLS; ++device) {
        bench b;
        set_up(&b, device_params[device]);
        const asides found = asides_of(&b, grasp, &fit);
        print_message("  device %d: lids differ by %.2f, brows by %.1f mm\n", device, found.lid,
                      found.brow_mm);
        assert_true(fabs(found.lid) < 0.1 && fabs(found.brow_mm) < 2.0);
        bench_tear_down(&b);
    }
}

/* From neutral to each face: never back towards the rest by more than 0.3 mm. */
static void ways_to_faces_are_monotone(void **state)
{
    (void)state;
    const fitting fit = fit_puppet();
    const pose rest = {{0}};
    for (int device = 0; device < DEVICE_KINDS; ++device) {
        bench b;
        double steepest = 0.0, backwards = 0.0;
        const char *steep = "", *back = "";
        set_up(&b, device_params[device]);
        for (int f = 0; f < FACE_COUNT; ++f) {
            enum { STEPS = 50 };
            double deg[JOINT_COUNT], far = 0.0, way = 0.0, side_before = 0.0;
            pose before = {{0}};
            if (posed_hands[device][f].same_as != FACE_IS_ITSELF)
                continue;
            hand_of(deg, (device_kind)device, f);
            for (int i = 0; i < JOINT_COUNT; ++i)
                way += deg[i] * deg[i];
            const double zero[JOINT_COUNT] = {0.0};
            hold(&b, zero);
            for (int n = 1; n <= STEPS; ++n) {
                double at[JOINT_COUNT];
                pose now;
                for (int i = 0; i < JOINT_COUNT; ++i)
                    at[i] = deg[i] * n / STEPS;
                float angle[MRT_ANGLES];
                bend_by(angle, at);
                for (int k = 0; k < 12; ++k)
                    bench_step(&b, MRT_RIGHT, angle);
                pose_of_pull(&now, &b, &fit);
                now.value[POSE_DOFS + DOF_SEAL] = 0.0; /* a step, by intent */
                const double side = eye_side((device_kind)device, at);
                const bool is_step = side < side_before || side > side_before; /* as well */
                side_before = side;
                const double out = apart(&now, &rest, face_recipes[f].half).mean_mm;
                const double slope =
                    apart(&now, &before, face_recipes[f].half).mean_mm * STEPS / sqrt(way);
                if (slope > steepest && !is_step) {
                    steepest = slope;
                    steep = face_recipes[f].name;
                }
                if (far - out > backwards) {
                    backwards = far - out;
                    back = face_recipes[f].name;
                }
                far = fmax(far, out);
                before = now;
            }
        }
        print_message("  device %d: at most %.2f mm a degree (%s), %.2f mm backwards (%s)\n",
                      device, steepest, steep, backwards, back);
        if (device == DEVICE_JOINTS)
            assert_true(backwards < 0.3 && steepest < 0.5);
        bench_tear_down(&b);
    }
}

static void names_are_those_of_the_faces(void **state)
{
    (void)state;
    bool is_used[FACE_NAMES] = {false};
    for (int f = 0; f < FACE_COUNT; ++f) {
        assert_in_range(face_name_of(f), 0, FACE_NAMES - 1);
        is_used[face_name_of(f)] = true;
    }
    for (int name = 0; name < FACE_NAMES; ++name)
        assert_true(is_used[name]);
    assert_null(face_names[FACE_NAMES]);
}

/* ---- rigs that lack poses ---- */

static bool has_logged(bench *b, const char *part)
{
    log_record record;
    bool has = false;
    while (log_pop(b->log, &record))
        has = has || strstr(record.text, part) != NULL;
    return has;
}

static void a_rig_without_poses_is_performed_as_before(void **state)
{
    (void)state;
    bench b;
    mapped_face bare = *puppet_face;
    bare.pose_count = 0;
    set_up_with(&b, &bare, device_params[DEVICE_JOINTS]);
    assert_true(has_logged(&b, "has no poses"));
    bench_bend(&b, MRT_RIGHT, (bends){{{THUMB_MPJ, -20}}}, 30);
    assert_true(bench_dof(&b, "jaw.open") > 0.1f);
    bench_tear_down(&b);
}

/* Some poses only, one of them twice and one with a part of no contact. */
static void a_rig_with_few_poses_meets_those(void **state)
{
    (void)state;
    const fitting fit = fit_puppet();
    mrt_rig_pose few[3];
    uint32_t count = 0;
    bench b;
    for (uint32_t i = 0; i < puppet_face->pose_count && count < 2; ++i)
        if (strcmp(puppet_face->pose[i].name, "viseme_U") == 0 ||
            strcmp(puppet_face->pose[i].name, "viseme_aa") == 0)
            few[count++] = puppet_face->pose[i];
    few[2] = few[0];
    const mapped_face some = {puppet_face->about, few, 3};
    set_up_with(&b, &some, device_params[DEVICE_JOINTS]);
    for (int f = 0; f < FACE_COUNT; ++f) {
        pose wanted, found;
        double deg[JOINT_COUNT];
        if (strcmp(face_recipes[f].name, "U") != 0 && strcmp(face_recipes[f].name, "aa") != 0)
            continue;
        hand_of(deg, DEVICE_JOINTS, f);
        hold(&b, deg);
        pose_of_pull(&found, &b, &fit);
        assert_true(face_of(&wanted, f, &fit));
        assert_true(apart(&wanted, &found, HALF_MOUTH).worst_mm < 0.05);
    }
    bench_tear_down(&b);
}

static void a_neutral_fist_is_reported(void **state)
{
    (void)state;
    bench b;
    float fist[MRT_ANGLES];
    set_up(&b, device_params[DEVICE_JOINTS]);
    assert_false(has_logged(&b, "is a fist"));
    b.functions->reset(b.plugin.self);
    memcpy(fist, bench_talk, sizeof fist);
    for (int i = 0; i < 4; ++i)
        fist[(int[]){5, 8, 12, 16}[i]] = RAD(95.0f);
    bench_step(&b, MRT_RIGHT, fist);
    assert_true(has_logged(&b, "is a fist"));
    bench_tear_down(&b);
}

/* ---- answers of simulated performers ---- */

/* A performer holds the hand a little otherwise as a whole, moves each joint further or less far,
 * has habits for single faces, and never answers twice the same. */
typedef struct performer_traits {
    double noise_deg, quirk_deg;
} performer_traits;
typedef struct simulated {
    double offset[JOINT_COUNT], gain[JOINT_COUNT], quirk[FACE_NAMES][JOINT_COUNT];
    double noise_deg;
    uint32_t random;
} simulated;

static double normal(uint32_t *random)
{
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) {
        *random = *random * 1664525u + 1013904223u;
        sum += (double)(*random >> 8) / 16777216.0;
    }
    return sum;
}

static void simulate(simulated *out, const performer_traits *traits, uint32_t seed)
{
    out->random = seed;
    out->noise_deg = traits->noise_deg;
    for (int i = 0; i < JOINT_COUNT; ++i) {
        out->offset[i] = 3.0 * normal(&out->random);
        out->gain[i] = 1.0 + 0.2 * normal(&out->random);
        for (int name = 0; name < FACE_NAMES; ++name)
            out->quirk[name][i] = traits->quirk_deg * normal(&out->random);
    }
}

static void answer_of(double out[JOINT_COUNT], simulated *who, int f)
{
    hand_of(out, DEVICE_JOINTS, f);
    for (int i = 0; i < JOINT_COUNT; ++i)
        out[i] = who->offset[i] + who->gain[i] * out[i] + who->quirk[face_name_of(f)][i] +
                 who->noise_deg * normal(&who->random);
}

static void both_halves(double out[JOINT_COUNT], simulated *who, int name)
{
    double deg[JOINT_COUNT];
    memset(out, 0, JOINT_COUNT * sizeof *out);
    for (int f = 0; f < FACE_COUNT; ++f) {
        if (face_name_of(f) != name)
            continue;
        answer_of(deg, who, f);
        for (int i = half_first_joint[face_recipes[f].half];
             i < half_first_joint[face_recipes[f].half + 1]; ++i)
            out[i] = deg[i];
    }
}

static void fit_half(speak_half *out, const own_hands *own, face_half which, const fitting *fit,
                     int shown[FACE_COUNT], int *count)
{
    double deg[FACE_COUNT][JOINT_COUNT];
    static speak_face faces[FACE_COUNT];
    *count = 0;
    (void)own_hands_bend(deg, own, DEVICE_JOINTS, which);
    for (int f = 0; f < FACE_COUNT; ++f) {
        if (face_recipes[f].half != which || !face_of(&faces[*count].pose, f, fit))
            continue;
        memcpy(faces[*count].deg, deg[f], sizeof deg[f]);
        shown[(*count)++] = f;
    }
    assert_true(speak_find(out, which, DEVICE_JOINTS, faces, *count));
}

typedef struct score {
    double off, right;
} score;

/* Of a fresh answer to each face shown: how far the face is off, over its own way, and whether it
 * is nearer to the face meant than to any other that was shown. */
static score judge(const own_hands *own, const char *const *names, int name_count, simulated *who,
                   const fitting *fit)
{
    static speak_half halves[HALF_COUNT];
    const pose rest = {{0}};
    score out = {0.0, 0.0};
    int shown[FACE_COUNT], count, judged = 0;
    for (int which = 0; which < HALF_COUNT; ++which)
        fit_half(&halves[which], own, (face_half)which, fit, shown, &count);
    for (int f = 0; f < FACE_COUNT; ++f) {
        pose meant, said = {{0}};
        double deg[JOINT_COUNT];
        bool is_shown = false;
        for (int n = 0; n < name_count; ++n)
            is_shown = is_shown || strcmp(face_recipes[f].name, names[n]) == 0;
        if (!is_shown)
            continue;
        const face_half which = face_recipes[f].half;
        assert_true(face_of(&meant, f, fit));
        answer_of(deg, who, f);
        speak_value(&halves[which], deg, &said);
        const double off = apart(&said, &meant, which).mean_mm;
        bool is_right = true;
        for (int other = 0; other < FACE_COUNT; ++other) {
            pose p;
            bool is_other = other != f && face_recipes[other].half == which;
            for (int n = 0; n < name_count && is_other; ++n)
                if (strcmp(face_recipes[other].name, names[n]) == 0 && face_of(&p, other, fit))
                    is_right = is_right && off <= apart(&said, &p, which).mean_mm;
        }
        out.off += off / apart(&meant, &rest, which).mean_mm;
        out.right += is_right;
        judged += 1;
    }
    out.off /= judged;
    out.right /= judged;
    return out;
}

static const char *const twelve[] = {"PP",    "FF",  "aa",      "I",     "O",        "U",
                                     "smile", "joy", "sadness", "anger", "surprise", "wink left"};
enum { TWELVE = COUNT_OF(twelve) };

static int name_index(const char *name)
{
    for (int i = 0; i < FACE_NAMES; ++i)
        if (strcmp(face_names[i], name) == 0)
            return i;
    fail_msg("no face %s", name);
    return 0;
}

static score judge_performers(const performer_traits *traits, int rounds)
{
    enum { PERFORMERS = 20 };
    const fitting fit = fit_puppet();
    score mean = {0.0, 0.0};
    for (uint32_t p = 0; p < PERFORMERS; ++p) {
        static simulated who;
        own_hands own = {.device = DEVICE_JOINTS};
        simulate(&who, traits, 100 + p);
        for (int round = 0; round < rounds; ++round)
            for (int n = 0; n < TWELVE; ++n) {
                double deg[JOINT_COUNT];
                both_halves(deg, &who, name_index(twelve[n]));
                own_hands_add(&own, DEVICE_JOINTS, name_index(twelve[n]), deg);
            }
        const score s = judge(&own, twelve, TWELVE, &who, &fit);
        mean.off += s.off / PERFORMERS;
        mean.right += s.right / PERFORMERS;
    }
    print_message("  noise %.1f, quirks %.1f degrees, %d rounds: %.0f %% off, right face %.0f %%\n",
                  traits->noise_deg, traits->quirk_deg, rounds, 100.0 * mean.off,
                  100.0 * mean.right);
    return mean;
}

static void answers_make_a_performers_hands_say_the_faces(void **state)
{
    (void)state;
    const performer_traits smooth = {1.0, 0.0}, careful = {1.5, 2.0};
    (void)judge_performers(&smooth, 0);
    const score smooth_score = judge_performers(&smooth, 2);
    (void)judge_performers(&careful, 0);
    const score careful_score = judge_performers(&careful, 2);
    (void)judge_performers(&careful, 4);
    assert_true(smooth_score.off <= 0.15 && smooth_score.right >= 0.98);
    assert_true(careful_score.off <= 0.23 && careful_score.right >= 0.97);
}

static void nonsense_is_not_learned(void **state)
{
    (void)state;
    own_hands own = {.device = DEVICE_JOINTS};
    double deg[FACE_COUNT][JOINT_COUNT];
    uint32_t random = 5;
    for (int round = 0; round < 10; ++round)
        for (int n = 0; n < TWELVE; ++n) {
            double any[JOINT_COUNT];
            for (int i = 0; i < JOINT_COUNT; ++i)
                any[i] = 20.0 * normal(&random);
            own_hands_add(&own, DEVICE_JOINTS, name_index(twelve[n]), any);
        }
    for (int which = 0; which < HALF_COUNT; ++which) {
        assert_int_equal(own_hands_bend(deg, &own, DEVICE_JOINTS, (face_half)which),
                         OWN_HANDS_NONSENSE);
        for (int f = 0; f < FACE_COUNT; ++f)
            for (int i = 0; i < JOINT_COUNT; ++i)
                assert_true(fabs(deg[f][i] - posed_hands[DEVICE_JOINTS][f].deg[i]) < 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_those_of_the_faces),
        cmocka_unit_test(every_face_is_met_at_its_hand_pose),
        cmocka_unit_test(mouth_and_upper_half_do_not_touch_each_other),
        cmocka_unit_test(nothing_moves_within_the_well),
        cmocka_unit_test(a_pressed_thumb_closes_the_lips),
        cmocka_unit_test(a_talking_thumb_opens_the_jaw_and_nothing_else),
        cmocka_unit_test(the_jaw_opens_evenly_by_points),
        cmocka_unit_test(a_wink_and_one_brow_are_nearly_switches),
        cmocka_unit_test(a_grasp_does_not_wink),
        cmocka_unit_test(ways_to_faces_are_monotone),
        cmocka_unit_test(a_rig_without_poses_is_performed_as_before),
        cmocka_unit_test(a_rig_with_few_poses_meets_those),
        cmocka_unit_test(a_neutral_fist_is_reported),
        cmocka_unit_test(answers_make_a_performers_hands_say_the_faces),
        cmocka_unit_test(nonsense_is_not_learned),
    };
    return cmocka_run_group_tests(tests, open_puppet, close_puppet);
}
