/* Loose parts: the frequency and damping that the rig promises, at every sample rate; limits,
 * collision shapes, jumps and gaps; the stored state. The eye of the scene is the loose part: its
 * mass is 40 mm before its centre, and the head turns about the neck. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/face_scene.h"

static const double arm_mm = 40.0;
static char turn_name[] = "turn", nod_name[] = "nod";

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static rig_spring usual(double frequency_hz, double damping)
{
    return (rig_spring){.tip = {30, 40, 60 + arm_mm}, frequency_hz, damping, 1.0, 0.0, 0.0};
}

static void make(face_scene *s, rig_spring spring)
{
    error err = {""};
    scene_init(s);
    s->bone[SKULL].kind = BONE_BALL;
    s->bone[SKULL].centre = (vec3){0, -60, -10};
    s->bone[SKULL].turn_count = 2;
    s->bone[SKULL].turn[0] = (rig_turn){turn_name, {0, 1, 0}, -1.2, 1.2, {0}};
    s->bone[SKULL].turn[1] = (rig_turn){nod_name, {1, 0, 0}, -0.8, 0.8, {0}};
    s->bone[EYE].spring = spring;
    s->rig.springs = 1.0;
    must(scene_finish(s, &err), &err);
}

/* One sample: how the head is turned, and when. Returns the swing to the side, rad. */
static double perform(face_scene *s, double turn_rad, double nod_rad, int64_t time_ns)
{
    error err = {""};
    float dof[MRT_MAX_DOFS] = {0};
    dof[scene_dof(s, "skull.turn")] = (float)turn_rad;
    dof[scene_dof(s, "skull.nod")] = (float)nod_rad;
    must(face_aim(s->face, NULL, dof, &err), &err);
    (void)face_swing(s->face, time_ns);
    face_show(s->face);
    return (double)face_metered(s->face)->dof[scene_dof(s, "eye.yaw")];
}

static int64_t ns_of(double time_s)
{
    return (int64_t)(time_s * 1e9 + 0.5);
}

/* ---- what the rig promises ---- */

/* After a small push of the head the part crosses its rest, and its peaks decay. */
static void it_swings_at_its_frequency_and_its_damping(void **state)
{
    (void)state;
    static const double frequency_hz[] = {0.5, 3.0, 8.0, 20.0}, damping[] = {0.05, 0.1, 0.3, 0.1};
    for (int i = 0; i < 4; ++i) {
        static face_scene s;
        const double damped_hz = frequency_hz[i] * sqrt(1.0 - damping[i] * damping[i]);
        double before = 0.0, crossed_s[3] = {0}, peak[3] = {0};
        int crossing_count = 0;
        make(&s, usual(frequency_hz[i], damping[i]));
        for (int n = 0; crossing_count < 3 && n < 20000; ++n) {
            const double time_s = n / 1000.0, pushed_s = 0.1 / frequency_hz[i];
            const double turn_rad = 0.01 * fmin(time_s / pushed_s, 1.0);
            const double now = perform(&s, turn_rad, 0.0, ns_of(time_s));
            if (time_s > pushed_s + 0.25 / frequency_hz[i]) {
                const bool is_crossing = (before < 0.0) != (now < 0.0);
                if (is_crossing)
                    crossed_s[crossing_count++] = time_s - 0.001 * now / (now - before);
                else if (crossing_count > 0)
                    peak[crossing_count] = fmax(peak[crossing_count], fabs(now));
            }
            before = now;
        }
        assert_int_equal(crossing_count, 3);
        const double measured_hz = 1.0 / (crossed_s[2] - crossed_s[0]);
        const double decay = log(peak[1] / peak[2]) / 3.14159265358979;
        const double measured = decay / sqrt(1.0 + decay * decay);
        print_message("  %g Hz, damping %g: swings at %.3f Hz, damping %.3f\n", damped_hz,
                      damping[i], measured_hz, measured);
        assert_true(fabs(measured_hz / damped_hz - 1.0) < 0.03);
        assert_true(fabs(measured / damping[i] - 1.0) < 0.08);
        face_destroy(s.face);
    }
}

static double ramp(double time_s, double from_s, double to_s)
{
    const double part = fmin(fmax((time_s - from_s) / (to_s - from_s), 0.0), 1.0);
    return part * part * (3.0 - 2.0 * part);
}

/* The head turns 30 degrees in 0.4 s, and back. The swing at each tenth of a second. */
enum { TENTHS = 30 };
static void swing_at_rate(double out[TENTHS], int rate_hz)
{
    static face_scene s;
    make(&s, usual(3.0, 0.3));
    for (int n = 0; n < TENTHS * rate_hz / 10; ++n) {
        const double time_s = (double)n / rate_hz;
        const double turn_rad = 0.5 * (ramp(time_s, 0.2, 0.6) - ramp(time_s, 1.3, 1.6));
        const double swing = perform(&s, turn_rad, 0.0, ns_of(time_s));
        if (n * 10 % rate_hz == 0)
            out[n * 10 / rate_hz] = swing;
    }
    face_destroy(s.face);
}

static void it_swings_the_same_at_every_sample_rate(void **state)
{
    (void)state;
    static const int rate_hz[] = {30, 60, 90, 200};
    double fine[TENTHS], coarse[TENTHS], most = 0.0;
    swing_at_rate(fine, 1000);
    for (int i = 0; i < TENTHS; ++i)
        most = fmax(most, fabs(fine[i]));
    assert_true(most > 0.1);
    for (int r = 0; r < 4; ++r) {
        double apart = 0.0;
        swing_at_rate(coarse, rate_hz[r]);
        for (int i = 0; i < TENTHS; ++i)
            apart = fmax(apart, fabs(coarse[i] - fine[i]));
        print_message("  %d Hz: %.2f degrees from 1000 Hz, of %.1f\n", rate_hz[r], 57.29578 * apart,
                      57.29578 * most);
        assert_true(apart < (rate_hz[r] < 60 ? 0.06 : 0.02) * most);
    }
}

/* A part that stands up falls backwards when the head leans back. */
static void it_hangs_when_the_head_tilts(void **state)
{
    (void)state;
    static face_scene s;
    rig_spring heavy = usual(3.0, 0.5);
    heavy.tip = (vec3){30, 40 + arm_mm, 60};
    heavy.gravity = 0.2;
    make(&s, heavy);
    for (int n = 0; n < 600; ++n)
        (void)perform(&s, 0.0, -0.5 * fmin(n / 30.0, 1.0), ns_of(n / 60.0));
    const double hangs_rad = -(double)face_metered(s.face)->dof[scene_dof(&s, "eye.pitch")];
    const double angular_hz = 2.0 * 3.14159265358979 * 3.0;
    const double expected_rad = 0.2 * 9810.0 * sin(0.5) / arm_mm / (angular_hz * angular_hz);
    print_message("  hangs by %.2f degrees, expected %.2f\n", 57.29578 * hangs_rad,
                  57.29578 * expected_rad);
    assert_true(fabs(hangs_rad / expected_rad - 1.0) < 0.03);
    face_destroy(s.face);
}

/* ---- bounds ---- */

static void expect_within(const face_scene *s)
{
    const float *dof = face_metered(s->face)->dof;
    const double yaw = (double)dof[scene_dof(s, "eye.yaw")],
                 pitch = (double)dof[scene_dof(s, "eye.pitch")];
    assert_true(yaw > -0.6 && yaw < 0.6 && pitch > -0.5 && pitch < 0.5);
    for (uint32_t i = 0; i < 6; ++i)
        assert_true(isfinite(scene_shown(s, SCENE_EYE + i).x));
}

static double unit_of(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 40) / (double)(1u << 24);
}

static void no_span_of_time_makes_it_wild(void **state)
{
    (void)state;
    static face_scene s;
    uint64_t seed = 1;
    int64_t now_ns = INT64_MIN;
    for (int frequency = 0; frequency < 3; ++frequency) {
        make(&s, usual(frequency == 0 ? 0.2 : frequency == 1 ? 3.0 : 20.0, 0.02));
        for (int n = 0; n < 3000; ++n) {
            const double spans_s[] = {0.0, 1e-9, 1e-3, 0.02, 0.1, 1e3, 1e9, -1.0};
            const double span_s = spans_s[(int)(unit_of(&seed) * 8.0)];
            now_ns = (int64_t)((uint64_t)now_ns + (uint64_t)ns_of(span_s));
            (void)perform(&s, 2.0 * unit_of(&seed) - 1.0, unit_of(&seed) - 0.5, now_ns);
            expect_within(&s);
        }
        face_destroy(s.face);
    }
}

/* 90 degrees between two samples are a cut, not a motion: the part is carried along. */
static void a_jump_of_the_head_does_not_whip_it(void **state)
{
    (void)state;
    static face_scene s;
    make(&s, usual(3.0, 0.1));
    for (int n = 0; n < 60; ++n) {
        const double swing = perform(&s, n < 10 ? -0.8 : 0.8, 0.0, ns_of(n / 60.0));
        assert_true(fabs(swing) < 1e-6);
    }
    /* The same way after a gap is a fast motion, and the swing stays within its limits. */
    double most = 0.0;
    for (int n = 0; n < 60; ++n) {
        most = fmax(most, fabs(perform(&s, -0.8, 0.0, ns_of(5.0 + n / 60.0))));
        expect_within(&s);
    }
    assert_true(most > 0.1);
    face_destroy(s.face);
}

static vec3 tip_of(const face_scene *s)
{
    const rigid *pose;
    static rigid all[RIG_BONES_MAX];
    float dof[MRT_MAX_DOFS] = {0};
    bones_unlimit(dof, face_bones(s->face), face_metered(s->face)->dof);
    bones_pose(all, face_bones(s->face), dof);
    pose = &all[EYE];
    const rigid back = rigid_inverse(&all[SKULL]);
    const vec3 tip = rigid_apply(pose, s->bone[EYE].spring.tip);
    return rigid_apply(&back, tip); /* as seen from the skull */
}

static double reach_to_the_left(bool has_shape)
{
    static face_scene s;
    double most_mm = 0.0;
    make(&s, usual(3.0, 0.1));
    if (has_shape) {
        s.proxy[0] = (rig_proxy){.bone = SKULL, .centre = {64, 40, 100}, .radii = {30, 30, 30}};
        s.rig.proxy_count = 1;
    }
    for (int n = 0; n < 120; ++n) {
        (void)perform(&s, -0.5 * ramp(n / 60.0, 0.1, 0.4), 0.0, ns_of(n / 60.0));
        most_mm = fmax(most_mm, tip_of(&s).x - 30.0);
    }
    face_destroy(s.face);
    return most_mm;
}

static void it_stays_out_of_the_skull(void **state)
{
    (void)state;
    const double free_mm = reach_to_the_left(false), stopped_mm = reach_to_the_left(true);
    print_message("  goes %.1f mm freely, %.1f mm with a shape 4 mm away\n", free_mm, stopped_mm);
    assert_true(free_mm > 8.0);
    assert_true(stopped_mm > 1.0 && stopped_mm < 4.5);
}

/* ---- rest ---- */

static void it_begins_at_rest_and_comes_to_rest(void **state)
{
    (void)state;
    static face_scene s;
    make(&s, usual(3.0, 0.3));
    for (int n = 0; n < 20; ++n)
        assert_true(perform(&s, 0.0, 0.0, ns_of(n / 60.0)) == 0.0);
    assert_true(scene_same_bits(face_shown(s.face), face_rest(s.face)));
    for (int n = 20; n < 60; ++n)
        (void)perform(&s, 0.4 * ramp(n / 60.0, 0.4, 0.6) - 0.4 * ramp(n / 60.0, 0.6, 0.8), 0.0,
                      ns_of(n / 60.0));
    assert_true(!scene_same_bits(face_shown(s.face), face_rest(s.face)));
    for (int n = 60; n < 600; ++n)
        (void)perform(&s, 0.0, 0.0, ns_of(n / 60.0));
    assert_true(scene_same_bits(face_shown(s.face), face_rest(s.face)));
    face_destroy(s.face);
}

static void a_strength_of_zero_holds_it_still(void **state)
{
    (void)state;
    static face_scene s;
    make(&s, usual(3.0, 0.3));
    face_set_springs(s.face, 0.0);
    for (int n = 0; n < 60; ++n)
        assert_true(perform(&s, 0.4 * ramp(n / 60.0, 0.1, 0.3), 0.0, ns_of(n / 60.0)) == 0.0);
    face_destroy(s.face);
}

/* ---- stored state ---- */

static void go_on(face_scene *s, int from, int to)
{
    for (int n = from; n < to; ++n)
        (void)perform(s, 0.5 * ramp(n / 60.0, 0.1, 0.4), 0.2 * ramp(n / 60.0, 0.3, 0.5),
                      ns_of(n / 60.0));
}

static void a_stored_swing_goes_on_with_the_same_bits(void **state)
{
    (void)state;
    static face_scene a, b;
    static unsigned char bytes[1 << 16];
    error err = {""};
    make(&a, usual(3.0, 0.3));
    make(&b, usual(3.0, 0.3));
    go_on(&a, 0, 25);
    const size_t size = face_save(a.face, bytes, sizeof bytes);
    assert_true(size <= sizeof bytes);
    go_on(&a, 25, 50);
    go_on(&b, 0, 7);
    must(face_load(b.face, bytes, size, &err), &err);
    go_on(&b, 25, 50);
    assert_true(scene_same_bits(face_shown(a.face), face_shown(b.face)));
    assert_memory_equal(face_metered(a.face)->dof, face_metered(b.face)->dof,
                        sizeof face_metered(a.face)->dof);
    for (size_t less = 0; less < size; ++less)
        assert_true(face_load(b.face, bytes, less, &err) < 0);
    for (size_t at = 0; at < size; ++at) { /* damaged: refused, or a face that goes on */
        bytes[at] ^= 0xa5;
        if (face_load(b.face, bytes, size, &err) >= 0) {
            go_on(&b, 25, 27);
            expect_within(&b);
        }
        bytes[at] ^= 0xa5;
    }
    face_destroy(a.face);
    face_destroy(b.face);
}

static void another_clock_changes_nothing(void **state)
{
    (void)state;
    static face_scene a, b;
    make(&a, usual(3.0, 0.3));
    make(&b, usual(3.0, 0.3));
    for (int n = 0; n < 60; ++n) {
        const double turn_rad = 0.5 * ramp(n / 60.0, 0.1, 0.4);
        if (n == 20)
            face_shift_time(b.face, INT64_C(7200000000000));
        const int64_t time_ns = ns_of(n / 60.0);
        const double is = perform(&a, turn_rad, 0.0, time_ns),
                     as = perform(&b, turn_rad, 0.0,
                                  n < 20 ? time_ns : time_ns + INT64_C(7200000000000));
        assert_true(memcmp(&is, &as, sizeof is) == 0);
    }
    face_destroy(a.face);
    face_destroy(b.face);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_swings_at_its_frequency_and_its_damping),
        cmocka_unit_test(it_swings_the_same_at_every_sample_rate),
        cmocka_unit_test(it_hangs_when_the_head_tilts),
        cmocka_unit_test(no_span_of_time_makes_it_wild),
        cmocka_unit_test(a_jump_of_the_head_does_not_whip_it),
        cmocka_unit_test(it_stays_out_of_the_skull),
        cmocka_unit_test(it_begins_at_rest_and_comes_to_rest),
        cmocka_unit_test(a_strength_of_zero_holds_it_still),
        cmocka_unit_test(a_stored_swing_goes_on_with_the_same_bits),
        cmocka_unit_test(another_clock_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
