/* Life: how often and how fast it blinks, that it leaves alone what the hand moves, and that its
 * state continues with the same bits, or is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stage/mapping/null_mapping.h"
#include "stage/perform/frame.h"
#include "stage/perform/life.h"
#include "unit/frame_run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LID_L = 0, LOWER_L, LID_R, LOWER_R, YAW_L, PITCH_L, YAW_R, PITCH_R, TURN, NOD, TILT, DOFS };
static const mrt_dof dofs[DOFS] = {
    {"lid_upper.l.close", "rad", -0.2f, 0.9f}, {"lid_lower.l.close", "rad", -0.1f, 0.35f},
    {"lid_upper.r.close", "rad", -0.2f, 0.9f}, {"lid_lower.r.close", "rad", -0.1f, 0.35f},
    {"eye.l.yaw", "rad", -0.6f, 0.6f},         {"eye.l.pitch", "rad", -0.4f, 0.4f},
    {"eye.r.yaw", "rad", -0.6f, 0.6f},         {"eye.r.pitch", "rad", -0.4f, 0.4f},
    {"skull.turn", "rad", -0.9f, 0.9f},        {"skull.nod", "rad", -0.5f, 0.5f},
    {"skull.tilt", "rad", -0.4f, 0.4f}};
static const mapped_face mapped = {.about = {NULL, dofs, 0, DOFS, {-80, -120, -80}, {80, 120, 80}}};
static const guard reach = {.reach_mm = 300.0};
static const double deg = 3.14159265358979 / 180.0;
static const int64_t tick_ns = (int64_t)(1e9 / LIFE_RATE_HZ);

typedef struct fixture {
    life life;
    channel_route route;
    int64_t time_ns;
    float seed, strength[LIFE_KINDS];
    float dof[DOFS]; /* what the hand does */
} fixture;

static void begin(fixture *f, float seed, float strength)
{
    memset(f, 0, sizeof *f);
    life_init(&f->life, &mapped);
    channel_route_init(&f->route, life_channels(), LIFE_CHANNELS);
    f->seed = seed;
    for (int i = 0; i < LIFE_KINDS; ++i)
        f->strength[i] = strength;
}

static void tick(fixture *f)
{
    f->time_ns += tick_ns;
    sample_step s = {.time_ns = f->time_ns, .count = 1};
    s.of[0] = (step_sample){.route = &f->route,
                            .sample = {.time_ns = f->time_ns, .count = LIFE_CHANNELS}};
    memcpy(s.of[0].sample.value, f->strength, sizeof f->strength);
    s.of[0].sample.value[LIFE_SEED] = f->seed;
    life_watch(&s, &f->life.body, f->dof);
    (void)life_read(&f->life, &reach, &s);
    assert_null(guard_fault(&reach, &f->life.pull));
}

static double pulled(const fixture *f, uint32_t dof)
{
    return isnan(f->life.pull.dof[dof]) ? 0.0 : (double)f->life.pull.dof[dof];
}

/* ---- blinks ---- */

typedef struct blinks {
    uint32_t count, doubles;
    double closing_ms, opening_ms; /* means; from 5 % to 95 % and back */
} blinks;

static blinks count_blinks(fixture *f, double minutes)
{
    blinks out = {0};
    const int64_t count = (int64_t)(minutes * 60.0 * LIFE_RATE_HZ);
    int64_t open_at = 0, closed_at = 0, ended_at = -1000;
    bool was_closed = false, is_running = false;
    for (int64_t i = 0; i < count; ++i) {
        tick(f);
        const double left = pulled(f, LID_L) / (double)dofs[LID_L].max,
                     right = pulled(f, LID_R) / (double)dofs[LID_R].max;
        assert_true(fabs(left - right) < 1e-6); /* both lids */
        assert_true(left <= 1.0 + 1e-6);
        if (left > 0.05 && !is_running) {
            out.doubles += i - ended_at < (int64_t)(0.3 * LIFE_RATE_HZ);
            out.count += 1;
            is_running = true;
            was_closed = false;
            open_at = i;
        }
        if (is_running && !was_closed && left > 0.95) {
            was_closed = true;
            closed_at = i;
            out.closing_ms += (double)(i - open_at) * 1e3 / LIFE_RATE_HZ;
        }
        if (is_running && left <= 0.05) {
            assert_true(was_closed); /* each blink closes the eye */
            is_running = false;
            ended_at = i;
            out.opening_ms += (double)(i - closed_at) * 1e3 / LIFE_RATE_HZ;
        }
    }
    out.closing_ms /= fmax(out.count, 1.0);
    out.opening_ms /= fmax(out.count, 1.0);
    return out;
}

static void blinks_come_eleven_to_nineteen_times_a_minute(void **state)
{
    static const float strengths[] = {0.05f, 0.5f, 1.0f};
    (void)state;
    for (uint32_t k = 0; k < 3; ++k) {
        const double minutes = 30.0;
        fixture f;
        begin(&f, 7.0f + (float)k, strengths[k]);
        const blinks seen = count_blinks(&f, minutes);
        const double rate = seen.count / minutes;
        printf("strength %.2f: %.1f blinks a minute, %u of %u twice; closing %.0f ms, closed and "
               "opening %.0f ms\n",
               (double)strengths[k], rate, seen.doubles, seen.count, seen.closing_ms,
               seen.opening_ms);
        assert_true(rate > 11.0 && rate < 19.0);
        assert_true(seen.doubles > 0);
        assert_true(seen.closing_ms > 40.0 && seen.closing_ms < 95.0); /* of 78 ms, 5 to 95 % */
        assert_true(seen.opening_ms > 1.4 * seen.closing_ms);
    }
}

static void the_intervals_of_blinks_differ(void **state)
{
    (void)state;
    fixture f;
    begin(&f, 3.0f, 0.5f);
    double least_s = 100.0, most_s = 0.0;
    int64_t last_ns = 0;
    double before_s = -1.0;
    for (int i = 0; i < 36000; ++i) {
        tick(&f);
        if (before_s < 0.0 && f.life.blink_s >= 0.0) {
            const double since_s = (double)(f.time_ns - last_ns) * 1e-9;
            least_s = last_ns ? fmin(least_s, since_s) : least_s;
            most_s = last_ns ? fmax(most_s, since_s) : most_s;
            last_ns = f.time_ns;
        }
        before_s = f.life.blink_s;
    }
    assert_true(least_s < 1.5 && most_s > 6.0);
}

static void a_blink_never_begins_soon_after_the_hand_moved_a_lid(void **state)
{
    (void)state;
    fixture f;
    double moved_s = 100.0, before_s = -1.0;
    uint32_t begun = 0;
    begin(&f, 5.0f, 1.0f);
    for (int i = 0; i < 60 * 600; ++i) {
        const bool is_moved = i % 480 < 90; /* 1.5 s of each 8 */
        f.dof[LID_L] = is_moved ? 0.6f * (float)sin((double)(i % 480) * 3.14159 / 90.0) : 0.0f;
        tick(&f);
        moved_s = fabsf(f.dof[LID_L]) > 0.15f ? 0.0 : moved_s + 1.0 / LIFE_RATE_HZ;
        if (before_s < 0.0 && f.life.blink_s >= 0.0) {
            begun += 1;
            assert_true(moved_s >= LIFE_LIDS_QUIET_S - 2.0 / LIFE_RATE_HZ);
        }
        before_s = f.life.blink_s;
    }
    assert_true(begun > 30);
}

static void lids_never_close_further_than_shut(void **state)
{
    (void)state;
    fixture f;
    begin(&f, 9.0f, 1.0f);
    for (int i = 0; i < 36000; ++i) {
        /* a hand that closes its lids as soon as a blink runs, and raises them otherwise */
        f.dof[LID_L] = f.dof[LID_R] = f.life.blink_s >= 0.0 ? 0.5f : -0.1f;
        tick(&f);
        assert_true((double)f.dof[LID_L] + pulled(&f, LID_L) <= (double)dofs[LID_L].max + 4e-3);
        if (life_closure(&f.life) >= 1.0)
            assert_true((double)f.dof[LID_L] + pulled(&f, LID_L) > 0.88);
    }
}

/* ---- gaze ---- */

static void eyes_look_at_the_camera_mostly_and_dart_fast(void **state)
{
    (void)state;
    fixture f;
    begin(&f, 11.0f, 0.0f);
    f.strength[LIFE_GAZE] = 1.0f;
    uint32_t at_camera = 0, saccades = 0, ticks = 60 * 1200;
    double furthest = 0.0, took_most_s = 0.0, fastest = 0.0;
    for (uint32_t i = 0; i < ticks; ++i) {
        const double before = f.life.saccade_s;
        const double was = pulled(&f, YAW_L);
        tick(&f);
        const double yaw = pulled(&f, YAW_L), pitch = pulled(&f, PITCH_L);
        assert_true(fabs(yaw - pulled(&f, YAW_R)) < 1e-9); /* eyes turn together */
        at_camera += fabs(yaw) < 4.0 * deg && fabs(pitch) < 4.0 * deg;
        saccades += f.life.saccade_s < before;
        furthest = fmax(furthest, fabs(yaw));
        took_most_s = fmax(took_most_s, f.life.saccade_took_s);
        fastest = fmax(fastest, fabs(yaw - was) * LIFE_RATE_HZ);
    }
    const double rate = saccades / (ticks / LIFE_RATE_HZ);
    printf("gaze: %.0f %% at the camera, %.2f saccades a second, %.0f degrees at most, %.0f ms at "
           "most, %.0f degrees a second\n",
           100.0 * at_camera / ticks, rate, furthest / deg, 1e3 * took_most_s, fastest / deg);
    assert_true(at_camera > ticks * 0.6);
    assert_true(rate > 0.5 && rate < 2.0); /* fixations of 0.3 to 2 s */
    assert_true(furthest > 10.0 * deg && furthest < 21.0 * deg);
    assert_true(took_most_s < 0.12 && fastest > 250.0 * deg);
}

static void eyes_that_the_hand_moves_are_left_alone(void **state)
{
    (void)state;
    fixture f;
    begin(&f, 13.0f, 0.0f);
    f.strength[LIFE_GAZE] = 1.0f;
    for (int i = 0; i < 3600; ++i) {
        f.dof[YAW_L] = 0.4f * (float)sin(i * 0.05);
        tick(&f);
        if (i > 120)
            assert_true(fabs(pulled(&f, YAW_L)) < 0.002 && fabs(pulled(&f, PITCH_L)) < 0.002);
    }
}

/* ---- breath and lean ---- */

static void the_head_breathes_fourteen_times_a_minute(void **state)
{
    (void)state;
    fixture f;
    begin(&f, 17.0f, 0.0f);
    f.strength[LIFE_BREATH] = 1.0f;
    uint32_t breaths = 0;
    double before = f.life.breath, most = 0.0;
    for (int i = 0; i < 60 * 600; ++i) {
        tick(&f);
        breaths += f.life.breath < before;
        before = f.life.breath;
        most = fmax(most, fabs(pulled(&f, NOD)));
    }
    printf("breath: %.1f a minute, nod %.2f degrees at most\n", breaths / 10.0, most / deg);
    assert_true(breaths > 130 && breaths < 150);
    assert_true(most > 0.3 * deg && most < 2.0 * deg); /* small */
}

static void the_head_leans_into_a_turn_and_settles_without_overshoot(void **state)
{
    (void)state;
    fixture f;
    begin(&f, 19.0f, 0.0f);
    f.strength[LIFE_LEAN] = 1.0f;
    double lead = 0.0, tilt = 0.0, back = 0.0;
    for (int i = 0; i < 60; ++i)
        tick(&f);
    assert_true(f.life.pull.mode == MRT_IDLE); /* nothing moves a head that rests */
    for (int i = 0; i < 240; ++i) {
        f.dof[TURN] = 0.5f * fminf((float)i / 30.0f, 1.0f); /* 29 degrees to the left in 0.5 s */
        tick(&f);
        lead = fmax(lead, pulled(&f, YAW_L));
        tilt = fmin(tilt, pulled(&f, TILT));
        back = fmin(back, pulled(&f, YAW_L));
    }
    printf("lean: eyes lead by %.1f degrees, the head tilts by %.1f\n", lead / deg, tilt / deg);
    assert_true(lead > 2.0 * deg && lead < 10.0 * deg);
    assert_true(tilt < -1.0 * deg && tilt > -6.0 * deg);
    assert_true(back >= 0.0);
    assert_true(f.life.pull.mode == MRT_IDLE);
}

/* ---- the same bits ---- */

static void hand(fixture *f, int i)
{
    f->dof[TURN] = 0.3f * (float)sin(i * 0.03);
    f->dof[LID_L] = i % 700 < 40 ? 0.4f : 0.0f;
    f->dof[YAW_L] = i % 900 < 100 ? 0.2f : 0.0f;
}

static void the_same_ticks_give_the_same_bits_and_another_seed_does_not(void **state)
{
    (void)state;
    fixture a, b, c;
    bool differs = false;
    begin(&a, 1.0f, 0.5f);
    begin(&b, 1.0f, 0.5f);
    begin(&c, 2.0f, 0.5f);
    for (int i = 0; i < 3600; ++i) {
        hand(&a, i);
        hand(&b, i);
        hand(&c, i);
        tick(&a);
        tick(&b);
        tick(&c);
        assert_memory_equal(a.life.pull.dof, b.life.pull.dof, sizeof a.life.pull.dof);
        differs |= memcmp(a.life.pull.dof, c.life.pull.dof, sizeof a.life.pull.dof) != 0;
    }
    assert_true(differs);
}

static void a_state_of_any_moment_continues_with_the_same_bits(void **state)
{
    (void)state;
    fixture a, b;
    unsigned char bytes[1024];
    begin(&a, 23.0f, 0.7f);
    for (int at = 0; at < 40; ++at) {
        for (int i = 0; i < 37 + 11 * at; ++i) {
            hand(&a, i);
            tick(&a);
        }
        const size_t size = life_save(&a.life, bytes, sizeof bytes);
        assert_true(size > 0 && size <= sizeof bytes);
        b = a;
        life_reset(&b.life);
        assert_true(life_load(&b.life, &reach, bytes, size));
        assert_memory_equal(a.life.pull.dof, b.life.pull.dof, sizeof a.life.pull.dof);
        fixture onward = a;
        for (int i = 0; i < 600; ++i) {
            hand(&onward, i);
            hand(&b, i);
            tick(&onward);
            tick(&b);
            assert_memory_equal(onward.life.pull.dof, b.life.pull.dof, sizeof b.life.pull.dof);
        }
    }
}

static void damaged_states_are_refused(void **state)
{
    (void)state;
    fixture a;
    life b;
    unsigned char bytes[1024], changed[1024];
    begin(&a, 29.0f, 0.7f);
    for (int i = 0; i < 500; ++i)
        tick(&a);
    const size_t size = life_save(&a.life, bytes, sizeof bytes);
    life_init(&b, &mapped);
    for (size_t cut = 0; cut < size; ++cut)
        assert_false(life_load(&b, &reach, bytes, cut));
    for (size_t i = 0; i < size; ++i)
        for (int bit = 0; bit < 8; ++bit) {
            memcpy(changed, bytes, size);
            changed[i] ^= (unsigned char)(1 << bit);
            (void)life_load(&b, &reach, changed, size);
            assert_null(guard_fault(&reach, &b.pull));
            assert_true(life_closure(&b) >= 0.0 && life_closure(&b) <= 1.0);
        }
}

/* ---- odd faces, odd values ---- */

static void a_face_lives_as_far_as_it_can(void **state)
{
    static const mrt_vec3 no_pulls[1] = {{0, 0, 0}};
    static const float open[1] = {0.3f};
    static const mrt_dof jaw[1] = {{"jaw.open", "rad", 0, 0.5f}};
    static const mrt_rig_pose smile[1] = {{"smile", no_pulls, open, MRT_POSE_MOUTH}};
    static const mapped_face bare = {.about = {NULL, jaw, 0, 1, {-80, -120, -80}, {80, 120, 80}},
                                     .pose = smile,
                                     .pose_count = 1};
    (void)state;
    fixture f;
    begin(&f, 1.0f, 1.0f);
    for (int kind = 0; kind < LIFE_KINDS; ++kind)
        assert_null(life_missing(&f.life.body, (life_kind)kind));
    life_init(&f.life, &bare);
    assert_string_equal(life_missing(&f.life.body, LIFE_BLINK),
                        "This face has no lids, so it cannot blink.");
    for (int kind = 0; kind < LIFE_KINDS; ++kind)
        assert_non_null(life_missing(&f.life.body, (life_kind)kind));
    for (int i = 0; i < 3600; ++i) {
        tick(&f);
        assert_true(f.life.pull.mode == MRT_IDLE);
    }
}

/* Lids that only a pose with contacts closes. */
static void lids_without_bones_blink_by_their_pose(void **state)
{
    static const mrt_contact lids[] = {{"lid.l", "skull", {10, 0, 50}, {0, 0, 1}},
                                       {"chin", "skull", {0, -40, 50}, {0, 0, 1}}};
    static const mrt_vec3 pulls[] = {{0, -6, 0}, {0, 0, 0}};
    static const mrt_rig_pose blink[1] = {{"eyeBlinkLeft", pulls, NULL, MRT_POSE_UPPER}};
    static const mapped_face soft = {.about = {lids, NULL, 2, 0, {-80, -120, -80}, {80, 120, 80}},
                                     .pose = blink,
                                     .pose_count = 1};
    static const guard two = {.contact_count = 2, .reach_mm = 300.0};
    (void)state;
    fixture f;
    double furthest = 0.0;
    begin(&f, 1.0f, 1.0f);
    life_init(&f.life, &soft);
    for (int i = 0; i < 3600; ++i) {
        f.time_ns += tick_ns;
        sample_step s = {.time_ns = f.time_ns, .count = 1};
        s.of[0] =
            (step_sample){.route = &f.route, .sample = {.count = LIFE_CHANNELS, .value = {1.0f}}};
        (void)life_read(&f.life, &two, &s);
        assert_int_equal(f.life.pull.count, 1); /* the same contact in each step */
        furthest = fmax(furthest, -(double)f.life.pull.vector[0].end.y);
    }
    assert_true(furthest > 5.9 && furthest < 6.1);
}

static void nonsense_stays_in_range(void **state)
{
    static const float odd[] = {-5.0f, 7.0f, 1e30f, -1e30f};
    (void)state;
    fixture f;
    for (uint32_t k = 0; k < 4; ++k) {
        begin(&f, odd[k], odd[k]);
        for (int i = 0; i < 2000; ++i) {
            f.dof[TURN] = i % 2 ? odd[k] : 0.0f;
            f.dof[LID_L] = odd[k];
            tick(&f);
            for (uint32_t d = 0; d < DOFS; ++d)
                assert_true(fabs(pulled(&f, d)) < 3.2);
        }
    }
}

/* ---- cost ---- */

static void a_tick_costs_almost_nothing(void **state)
{
    (void)state;
    fixture f;
    begin(&f, 31.0f, 1.0f);
    const int count = 60 * 300;
    const int64_t from_ns = clock_now_ns();
    for (int i = 0; i < count; ++i) {
        hand(&f, i);
        tick(&f);
    }
    const double each_ms = (double)(clock_now_ns() - from_ns) / 1e6 / count;
    printf("a tick: %.5f ms\n", each_ms);
    assert_true(each_ms < 0.05);
}

/* The whole step, solve included, on the puppet. */
static void a_step_of_life_alone_is_cheap(void **state)
{
    (void)state;
    fixture f;
    error err = {""};
    face_file file;
    instance mapping;
    performer *p;
    log_queue *log = log_queue_create();
    const performer_settings as = {.rezero_pedal = 0};
    assert_non_null(log);
    const char *path = SOURCE_DIR "/rigs/puppet/puppet.rig.json";
    assert_true(face_file_read(&file, path, NULL, FACE_FILE_USABLE, &err) >= 0);
    assert_true(instance_create(&mapping, &null_mapping_type, CLOCK_VIRTUAL, log, &err) >= 0);
    assert_true(performer_create(&p, &file, &mapping, &as, &err) >= 0);
    begin(&f, 37.0f, 1.0f);
    const int count = 60 * 60;
    int64_t took_ns = 0;
    for (int i = 0; i < count; ++i) {
        f.time_ns += tick_ns;
        sample_step s = {.time_ns = f.time_ns, .due_ns = f.time_ns, .count = 1};
        s.of[0] = (step_sample){.route = &f.route,
                                .sample = {.time_ns = f.time_ns, .count = LIFE_CHANNELS}};
        memcpy(s.of[0].sample.value, f.strength, sizeof f.strength);
        const int64_t from_ns = clock_now_ns();
        frame_run(p, &s);
        took_ns += clock_now_ns() - from_ns;
    }
    const double each_ms = (double)took_ns / 1e6 / count;
    printf("a step of life alone, solve included: %.4f ms\n", each_ms);
    assert_true(p->counts->solves > (uint64_t)count / 2);
    assert_int_equal(p->counts->bad_pulls, 0);
    assert_true(each_ms < 0.5); /* 0.05 on a free machine */
    performer_destroy(p);
    instance_destroy(&mapping);
    face_file_destroy(&file);
    log_queue_destroy(log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blinks_come_eleven_to_nineteen_times_a_minute),
        cmocka_unit_test(the_intervals_of_blinks_differ),
        cmocka_unit_test(a_blink_never_begins_soon_after_the_hand_moved_a_lid),
        cmocka_unit_test(lids_never_close_further_than_shut),
        cmocka_unit_test(eyes_look_at_the_camera_mostly_and_dart_fast),
        cmocka_unit_test(eyes_that_the_hand_moves_are_left_alone),
        cmocka_unit_test(the_head_breathes_fourteen_times_a_minute),
        cmocka_unit_test(the_head_leans_into_a_turn_and_settles_without_overshoot),
        cmocka_unit_test(the_same_ticks_give_the_same_bits_and_another_seed_does_not),
        cmocka_unit_test(a_state_of_any_moment_continues_with_the_same_bits),
        cmocka_unit_test(damaged_states_are_refused),
        cmocka_unit_test(a_face_lives_as_far_as_it_can),
        cmocka_unit_test(lids_without_bones_blink_by_their_pose),
        cmocka_unit_test(nonsense_stays_in_range),
        cmocka_unit_test(a_tick_costs_almost_nothing),
        cmocka_unit_test(a_step_of_life_alone_is_cheap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
