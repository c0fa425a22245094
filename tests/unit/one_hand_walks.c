/* plugins/one_hand at length: random hands and feet, the recorded hands, and no allocation. Nothing
 * is ever infinite, out of reach, or further in a frame than hand and easing explain. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/filter.h"
#include "log_parse.h"
#include "one_hand_bench.h"
#include "unit/allocation_count.h"

static const char *const modes[] = {"mode=classic,eyes=40", "mode=mask", "mode=layered_waldo"};

/* ---- what every frame must be ---- */

static float float_random(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (float)(*state >> 40) * (1.0f / 16777216.0f);
}

static void assert_sane(const bench *b)
{
    assert_int_equal(b->pull.mode, MRT_ANCHORED);
    assert_int_equal(b->pull.count, BENCH_PERFORMED);
    assert_int_equal(b->pull.anchor, 1);
    for (uint32_t i = 0; i < b->pull.count; ++i) {
        const mrt_vector *v = &b->pull.vector[i];
        mrt_vec3 d = {v->end.x - v->start.x, v->end.y - v->start.y, v->end.z - v->start.z};
        assert_true(bench_length(d) < 28.01f); /* the reach; false for NaN */
    }
    for (size_t i = 1; i < BENCH_DOFS; ++i)
        assert_true(b->pull.dof[i] >= bench_dofs[i].min && b->pull.dof[i] <= bench_dofs[i].max);
    assert_true(isnan(b->pull.dof[0]));
}

/* ---- random walks ---- */

typedef struct walk {
    float angle[MRT_ANGLES], speed[MRT_ANGLES]; /* rad, rad/s */
    uint64_t random;
} walk;

static void walk_start(walk *w, uint64_t seed)
{
    memcpy(w->angle, bench_talk, sizeof w->angle);
    memset(w->speed, 0, sizeof w->speed);
    w->random = seed;
}

/* Pulled home, pushed at random, braked: within some 40 deg of the talk pose, up to 400 deg/s. */
static void walk_on(walk *w, float dt_s)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        float push = 900.0f * (float_random(&w->random) - 0.5f);
        w->speed[i] += dt_s * (push - 20.0f * (w->angle[i] - bench_talk[i]) - 3.0f * w->speed[i]);
        w->speed[i] = fminf(fmaxf(w->speed[i], -7.0f), 7.0f);
        w->angle[i] += dt_s * w->speed[i];
        w->angle[i] = fminf(fmaxf(w->angle[i], bench_talk[i] - 1.0f), bench_talk[i] + 1.0f);
    }
}

static void stamp_pedals(bench *b, uint64_t *random)
{
    for (int i = 0; i < 3; ++i)
        if (float_random(random) < 0.02f)
            b->frame.pedal[i] = 1.0f - b->frame.pedal[i];
}

static void random_walks_stay_finite_and_bounded(void **state)
{
    (void)state;
    enum { FRAMES = 100000 };
    for (size_t m = 0; m < COUNT_OF(modes); ++m) {
        bench b;
        walk w;
        bench_set_up(&b, modes[m]);
        walk_start(&w, 7 + m);
        float most = 0, furthest = 0, most_dof = 0;
        for (int i = 0; i < FRAMES; ++i) {
            mrt_pull before = b.pull;
            b.dt_s = i % 1000 == 999 ? 0.1 : 0.002 + 0.016 * (double)float_random(&w.random);
            walk_on(&w, (float)b.dt_s);
            stamp_pedals(&b, &w.random);
            bench_step(&b, MRT_RIGHT, w.angle);
            assert_sane(&b);
            if (i > 0) {
                most = fmaxf(most, bench_jump(&before, &b.pull) / (float)b.dt_s);
                most_dof = fmaxf(most_dof, bench_dof_jump(&before, &b.pull) / (float)b.dt_s);
            }
            for (uint32_t k = 0; k < b.pull.count; ++k)
                furthest =
                    fmaxf(furthest, fabsf(b.pull.vector[k].end.y - b.pull.vector[k].start.y));
        }
        print_message("%s: %d frames, at most %.0f mm/s, %.1f of a degree of freedom per s, "
                      "%.1f mm from rest\n",
                      modes[m], FRAMES, (double)most, (double)most_dof, (double)furthest);
        assert_true(furthest > 5.0f); /* it did perform */
        /* 400 deg/s times the gains of all that can add up, and easing over 200 ms of 56 mm */
        assert_true(most < 3000.0f);
        bench_tear_down(&b);
    }
}

/* What moves does so in time: a jump would stay as large however fine the frames are. */
static void an_eighth_of_the_time_makes_a_small_part_of_the_way(void **state)
{
    (void)state;
    for (size_t m = 0; m < COUNT_OF(modes); ++m) {
        float most[2] = {0, 0}, most_dof[2] = {0, 0};
        for (int fine = 0; fine < 2; ++fine) {
            bench b;
            int per_step = fine ? 8 : 1;
            walk w;
            float from[MRT_ANGLES], angle[MRT_ANGLES];
            bench_set_up(&b, modes[m]);
            walk_start(&w, 99);
            bench_step(&b, MRT_RIGHT, w.angle);
            b.dt_s = 0.008 / per_step;
            for (int i = 0; i < 6000; ++i) {
                memcpy(from, w.angle, sizeof from);
                walk_on(&w, 0.008f);
                b.frame.pedal[0] = i % 700 > 690;
                b.frame.pedal[1] = i % 300 > 250;
                b.frame.pedal[2] = i % 500 > 400;
                for (int k = 1; k <= per_step; ++k) {
                    mrt_pull before = b.pull;
                    for (int s = 0; s < MRT_ANGLES; ++s)
                        angle[s] = from[s] + (w.angle[s] - from[s]) * (float)k / (float)per_step;
                    bench_step(&b, MRT_RIGHT, angle);
                    most[fine] = fmaxf(most[fine], bench_jump(&before, &b.pull));
                    most_dof[fine] = fmaxf(most_dof[fine], bench_dof_jump(&before, &b.pull));
                }
            }
            bench_tear_down(&b);
        }
        print_message("%s: steps of at most %.3f mm, an eighth of the time: %.3f mm\n", modes[m],
                      (double)most[0], (double)most[1]);
        assert_true(most[0] > 0.5f && most[1] < 0.25f * most[0]);
        assert_true(most_dof[0] > 0.05f && most_dof[1] < 0.25f * most_dof[0]);
    }
}

static void steady_performance_does_not_allocate(void **state)
{
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED) {
        print_message("SKIPPED: the sanitizer has an allocator of its own\n");
        skip();
    }
    for (size_t m = 0; m < COUNT_OF(modes); ++m) {
        bench b;
        walk w;
        bench_set_up(&b, modes[m]);
        walk_start(&w, 3);
        bench_step(&b, MRT_RIGHT, w.angle);
        uint64_t before = atomic_load(&allocation_count);
        for (int i = 0; i < 3000; ++i) {
            walk_on(&w, 0.01f);
            stamp_pedals(&b, &w.random);
            if (i % 500 == 10)
                bench_trigger(&b, "Anchor");
            if (i % 500 == 20)
                bench_trigger(&b, "Blink");
            b.frame.hand[MRT_RIGHT].present = true;
            bench_step(&b, MRT_RIGHT, w.angle);
        }
        b.functions->reset(b.plugin.self);
        bench_step(&b, MRT_RIGHT, w.angle);
        assert_true(before > 0); /* the count counts */
        assert_int_equal(atomic_load(&allocation_count) - before, 0);
        bench_tear_down(&b);
    }
}

/* ---- recorded hands ---- */

/* A log as the stage would give it: calibrated, filtered, posed. */
static void perform_log(const log_data *log, const char *name, size_t mode)
{
    /* mm per deg: the steepest sum of what the joints do at one contact. Mask: fingertips. */
    static const float steepest[] = {1.2f, 1.6f, 0.8f};
    const float easing_mm_per_s = 1.875f * 56.0f / 0.2f; /* at first: the way from rest */
    hand_calibration calibration;
    hand_filter filter;
    hand_calibration_identity(&calibration);
    for (int finger = 0; finger < 4; ++finger)
        calibration.has_distal[finger] = false;
    hand_filter_init(&filter);
    bench b;
    bench_set_up(&b, modes[mode]);
    float most = 0, worst = 0;
    float last[MRT_ANGLES] = {0};
    for (size_t r = 0; r < log->record_count; ++r) {
        float raw[MRT_ANGLES] = {0}, angle[MRT_ANGLES], moved_deg = 0;
        for (uint32_t i = 0; i < log->channel_count; ++i)
            raw[log->channel[i].semantic - MRT_CH_ANGLE] = log->value[r * log->channel_count + i];
        hand_calibrate(&calibration, raw, angle);
        hand_filter_apply(&filter, angle, log->time_ns[r]);
        mrt_pull before = b.pull;
        if (r > 0)
            b.dt_s = fmin((double)(log->time_ns[r] - log->time_ns[r - 1]) * 1e-9, 0.1);
        bench_step(&b, MRT_RIGHT, angle);
        assert_sane(&b);
        for (int i = 0; i < MRT_ANGLES; ++i)
            moved_deg = fmaxf(moved_deg, fabsf(angle[i] - last[i]) / RAD(1.0f));
        memcpy(last, angle, sizeof last);
        if (r == 0) {
            assert_true(bench_is_rest(&b));
            continue;
        }
        float jump = bench_jump(&before, &b.pull);
        float allowed =
            steepest[mode] * moved_deg + easing_mm_per_s * (float)b.dt_s * (r < 60) + 1e-3f;
        if (jump > allowed)
            fail_msg("%s, record %zu: a contact jumps by %g mm while the hand moves by %g deg",
                     name, r, (double)jump, (double)moved_deg);
        most = fmaxf(most, jump);
        worst = fmaxf(worst, jump / allowed);
    }
    print_message("%s, %s: %zu records, steps of at most %.2f mm, %.0f %% of what is allowed\n",
                  name, modes[mode], log->record_count, (double)most, 100.0 * (double)worst);
    assert_true(most > 0.2f);
    bench_tear_down(&b);
}

static bool load(log_data *out, const char *path)
{
    char reason[LOG_REASON];
    log_file file;
    if (log_file_read(&file, path, reason) < 0) {
        print_message("SKIPPED: %s: %s\n", path, reason);
        return false;
    }
    mrt_result result = log_parse(out, file.data, file.size, MRT_RIGHT, reason);
    free(file.data);
    if (result < 0)
        fail_msg("%s: %s", path, reason);
    return true;
}

static void the_demo_performs_without_a_jump(void **state)
{
    (void)state;
    log_data log;
    if (!load(&log, SOURCE_DIR "/plugins/log/demo_hand.csv"))
        fail_msg("the demo is missing");
    for (size_t m = 0; m < COUNT_OF(modes); ++m)
        perform_log(&log, "demo_hand.csv", m);
    log_data_finish(&log);
}

static void recorded_hands_perform_without_a_jump(void **state)
{
    (void)state;
    static const char *const names[] = {"00_calib-rad-su01.txt",
                                        "02_i_r_ex02-rad-021-grasp-su01.txt",
                                        "10_ex01-rad-003-grasp-su04.txt"};
    const char *shared = getenv("MAROTTE_SHARED");
    for (size_t i = 0; i < COUNT_OF(names); ++i) {
        char path[1024];
        log_data log;
        snprintf(path, sizeof path, "%s/data/hands/%s", shared ? shared : SOURCE_DIR "/../shared",
                 names[i]);
        if (!load(&log, path))
            skip();
        for (size_t m = 0; m < COUNT_OF(modes); ++m)
            perform_log(&log, names[i], m);
        log_data_finish(&log);
    }
}

/* What ./run shows: a mouth that speaks by syllables, brows that lift, a head that lives. */
static void the_demo_is_a_performance(void **state)
{
    (void)state;
    log_data log;
    hand_calibration calibration;
    hand_filter filter;
    bench b;
    if (!load(&log, SOURCE_DIR "/plugins/log/demo_hand.csv"))
        fail_msg("the demo is missing");
    hand_calibration_identity(&calibration);
    memset(calibration.has_distal, 0, sizeof calibration.has_distal);
    hand_filter_init(&filter);
    bench_set_up_on(&b, &bench_face, "");
    int syllables = 0;
    bool is_open = false;
    float widest = 0, aside = 0, brow = 0, at_rest = 0;
    for (size_t r = 0; r < log.record_count; ++r) {
        float raw[MRT_ANGLES] = {0}, angle[MRT_ANGLES];
        double time_s = (double)(log.time_ns[r] - log.time_ns[0]) * 1e-9;
        for (uint32_t i = 0; i < log.channel_count; ++i)
            raw[log.channel[i].semantic - MRT_CH_ANGLE] = log.value[r * log.channel_count + i];
        hand_calibrate(&calibration, raw, angle);
        hand_filter_apply(&filter, angle, log.time_ns[r]);
        bench_step(&b, MRT_RIGHT, angle);
        float open_deg = bench_dof(&b, "jaw.open") / RAD(1.0f);
        float jaw_mm = fabsf(bench_dof(&b, "jaw.lateral"));
        if (time_s < 1.0)
            at_rest = fmaxf(at_rest, open_deg);
        if (time_s > 1.2 && time_s < 8.2) { /* the two sentences */
            if (!is_open && open_deg > 4.0f)
                syllables += 1, is_open = true;
            if (open_deg < 3.0f)
                is_open = false;
            widest = fmaxf(widest, open_deg);
            aside = fmaxf(aside, jaw_mm);
        }
        if (time_s > 8.4 && time_s < 9.2)
            brow = fmaxf(brow, bench_pulled(&b, "brow.mid.l").y);
    }
    print_message("demo: %d syllables, jaw to %.1f deg, aside %.2f mm, brows %.1f mm\n", syllables,
                  (double)widest, (double)aside, (double)brow);
    assert_true(at_rest <= 0.0f);
    assert_in_range(syllables, 18, 23); /* of 23; the quietest may melt together */
    assert_true(widest > 10.0f && widest < 30.0f);
    assert_true(aside < 0.5f); /* the thumb's abduction goes along with its drop */
    assert_true(brow > 7.0f);
    bench_tear_down(&b);
    log_data_finish(&log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_walks_stay_finite_and_bounded),
        cmocka_unit_test(an_eighth_of_the_time_makes_a_small_part_of_the_way),
        cmocka_unit_test(steady_performance_does_not_allocate),
        cmocka_unit_test(the_demo_performs_without_a_jump),
        cmocka_unit_test(recorded_hands_perform_without_a_jump),
        cmocka_unit_test(the_demo_is_a_performance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
