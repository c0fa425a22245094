/* Mappings at work, as loaded from the build, on the face and with the hands of one_hand_bench.h:
 * what the tests of several plugins share. Included after cmocka.h. */
#ifndef MAROTTE_TESTS_UNIT_MAPPING_BENCH_H
#define MAROTTE_TESTS_UNIT_MAPPING_BENCH_H
#include "one_hand_bench.h"
#include "resume_scene.h"

#include "base/log.h"
#include "hand/filter.h"
#include "log_parse.h"

/* No contact, no degree of freedom. */
static const mrt_face bench_bare = {.low = {-75, 0, -75}, .high = {75, 300, 75}};

static inline void bench_open(bench *b, const char *name, const mrt_face *about, const char *params)
{
    error err = {""};
    char path[1024];
    const mrt_plugin_type *type;
    *b = (bench){.dt_s = 0.01, .face = about};
    b->log = log_queue_create();
    (void)snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, name);
    scene_must(plugin_list_add(&b->plugins, path, &err), &err);
    scene_must(plugin_list_find(&b->plugins, name, MRT_MAPPING, &type, &err), &err);
    scene_must(instance_create(&b->plugin, type, CLOCK_VIRTUAL, b->log, &err), &err);
    bench_set(b, params);
    b->functions = plugin_interface(type, MRT_MAPPING);
    b->state = plugin_interface(type, MRT_STATE);
    for (uint32_t side = 0; side < 2; ++side)
        b->skeleton[side] = hand_skeleton_create(side, 190);
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        b->pull.dof[i] = NAN;
    assert_int_equal(b->functions->activate(b->plugin.self, about), MRT_OK);
    b->functions->reset(b->plugin.self);
    b->frame.near = true;
}

/* Gives the mapping one pose, "joy", which lifts the left corner of the mouth by 7 mm. */
static inline void bench_give_joy(bench *b)
{
    static mrt_vec3 pulls[BENCH_CONTACTS];
    static float dofs[BENCH_DOFS];
    static const mrt_rig_pose joy = {"joy", pulls, dofs, MRT_POSE_WHOLE};
    const mrt_rig_poses *poses = plugin_interface(b->plugin.type, MRT_RIG_POSES);
    assert_non_null(poses);
    for (uint32_t i = 0; i < BENCH_CONTACTS; ++i)
        if (strcmp(bench_contacts[i].name, "mouth.corner.l") == 0)
            pulls[i].y = 7.0f;
    poses->set(b->plugin.self, b->face, &joy, 1);
}

/* Whether activate refuses the face, and says why. */
static inline bool bench_refuses(const char *name, const mrt_face *about)
{
    bench b;
    log_record record;
    bench_open(&b, name, &bench_face, "");
    b.functions->deactivate(b.plugin.self);
    while (log_pop(b.log, &record)) {
    }
    bool refused = b.functions->activate(b.plugin.self, about) == MRT_ERR_UNSUPPORTED;
    bool explained = log_pop(b.log, &record) && record.level == MRT_LOG_ERROR;
    bench_tear_down(&b);
    return refused && explained;
}

/* `steps` frames from one pose of the hand to another; the greatest step of an end, mm. */
static inline float bench_move(bench *b, const float *from, const float *to, int steps)
{
    float angle[MRT_ANGLES], most = 0;
    for (int i = 1; i <= steps; ++i) {
        mrt_pull before = b->pull;
        for (int k = 0; k < MRT_ANGLES; ++k)
            angle[k] = from[k] + (to[k] - from[k]) * (float)i / (float)steps;
        bench_step(b, MRT_RIGHT, angle);
        most = fmaxf(most, bench_jump(&before, &b->pull));
    }
    return most;
}

static inline float bench_longest(const mrt_pull *pull)
{
    float most = 0;
    for (uint32_t i = 0; i < pull->count; ++i) {
        mrt_vec3 a = pull->vector[i].start, e = pull->vector[i].end;
        most = fmaxf(most, bench_length((mrt_vec3){e.x - a.x, e.y - a.y, e.z - a.z}));
    }
    return most;
}

/* A walk of 10^4 frames with pedals and triggers: everything finite, no vector longer than
 * most_mm. Twice, the second time after a reset: the same bits. */
static inline void bench_walk(bench *b, const char *const *triggers, float most_mm)
{
    enum { FRAMES = 10000 };
    uint64_t sums[2];
    for (int run = 0; run < 2; ++run) {
        float longest = 0, angle[MRT_ANGLES];
        uint32_t random = 7;
        uint64_t sum = 14695981039346656037u;
        b->functions->reset(b->plugin.self);
        b->frame = (mrt_frame){.near = true};
        b->pull = (mrt_pull){.mode = MRT_IDLE};
        for (int i = 0; i < MRT_MAX_DOFS; ++i)
            b->pull.dof[i] = NAN;
        for (uint32_t n = 0; n < FRAMES; ++n) {
            random = random * 1664525u + 1013904223u;
            for (uint32_t k = 0; k < MRT_ANGLES; ++k)
                angle[k] = scene_angle(n, k, 0.0f) + 0.5f * (scene_wave(n, 230 + 10 * k) - 0.5f);
            for (int k = 0; k < MRT_MAX_PEDALS; ++k)
                b->frame.pedal[k] = random >> (20 + k) & 63 ? 0.0f : 1.0f;
            for (uint32_t k = 0; triggers[k]; ++k)
                if ((random >> 8) % 400 == k)
                    bench_trigger(b, triggers[k]);
            bench_pose(b, MRT_RIGHT, angle);
            b->frame.hand[MRT_RIGHT].present = n % 1000 < 900;
            assert_true(bench_frame(b) >= 0);
            assert_true(b->pull.count <= MRT_MAX_VECTORS);
            for (uint32_t v = 0; v < b->pull.count; ++v)
                for (size_t byte = 0; byte < sizeof(mrt_vec3); ++byte)
                    sum = (sum ^ ((const unsigned char *)&b->pull.vector[v].end)[byte]) *
                          1099511628211u;
            float now = bench_longest(&b->pull);
            assert_true(isfinite(now));
            longest = fmaxf(longest, now);
            for (uint32_t k = 0; k < b->face->dof_count; ++k)
                assert_true(isnan(b->pull.dof[k]) || isfinite(b->pull.dof[k]));
        }
        print_message("the longest vector of %d frames: %.1f mm\n", FRAMES, (double)longest);
        assert_true(longest > 0.5f && longest <= most_mm);
        sums[run] = sum;
    }
    assert_true(sums[0] == sums[1]);
}

/* The demo's hand as the stage would give it: calibrated and filtered; `on_frame` after each. */
typedef void bench_on_frame(const bench *b, double time_s, void *data);
static inline void bench_demo(bench *b, bench_on_frame *on_frame, void *data)
{
    char reason[LOG_REASON];
    log_file file;
    log_data log;
    hand_calibration calibration;
    hand_filter filter;
    if (log_file_read(&file, SOURCE_DIR "/plugins/log/demo_hand.csv", reason) < 0 ||
        log_parse(&log, file.data, file.size, MRT_RIGHT, reason) < 0)
        fail_msg("%s", reason);
    free(file.data);
    hand_calibration_identity(&calibration);
    memset(calibration.has_distal, 0, sizeof calibration.has_distal);
    hand_filter_init(&filter);
    for (size_t r = 0; r < log.record_count; ++r) {
        float raw[MRT_ANGLES] = {0}, angle[MRT_ANGLES];
        for (uint32_t i = 0; i < log.channel_count; ++i)
            raw[log.channel[i].semantic - MRT_CH_ANGLE] = log.value[r * log.channel_count + i];
        hand_calibrate(&calibration, raw, angle);
        hand_filter_apply(&filter, angle, log.time_ns[r]);
        bench_step(b, MRT_RIGHT, angle);
        on_frame(b, (double)(log.time_ns[r] - log.time_ns[0]) * 1e-9, data);
    }
    log_data_finish(&log);
}

/* The least determinant of a shipped face while the mapping performs what scene_sample plays, two
 * hands and four pedals: > 0, nothing folds. */
static inline double bench_least_determinant(const char *name, const char *on, const char *params,
                                             uint32_t frames)
{
    face_file file;
    scene_stand s;
    const scene_play play = {.mapping = name, .face = on, .params = params};
    double least = 1.0, moved = 0.0;
    scene_face(&file, on);
    scene_stand_up(&s, &play, &file);
    for (uint32_t n = 0; n < frames; ++n) {
        scene_step(&s, &play, n);
        moved = fmax(moved, (double)bench_longest(layer_pull(s.performer->voice[0].layer)));
        if (n % 10 == 9 && composer_is_anchored(s.performer->composer)) {
            composer_draw(s.performer->composer);
            least = fmin(least, face_min_determinant(composer_face(s.performer->composer)));
        }
    }
    const composer_counts *counts = s.performer->counts;
    assert_int_equal(counts->bad_pulls, 0);
    assert_int_equal(counts->held_pulls, 0);
    assert_int_equal(counts->folded_steps, 0);
    assert_true(moved > 0.5);
    least = fmin(least, counts->min_determinant);
    print_message("%s on the %s: least determinant %.3f in %u frames\n", name, on, least, frames);
    scene_lay_down(&s);
    face_file_destroy(&file);
    return least;
}

#endif
