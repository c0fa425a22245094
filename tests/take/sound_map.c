/* A recorded sound ran on its device's clock: its anchors say when its frames were, and the
 * timeline hears them then. Each frame of the sound is its own number. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show_scene.h"
#include "show/sqlite.h"
#include "show/sound_file.h"
#include "show/sound_render.h"

#include <math.h>

enum { RATE = 48000, PIECE = 1536, SCALE = 1 << 22 };

/* Anchors of a device that runs ppm fast and tells times up to jitter_ns wrong. */
static size_t make_anchors(show_audio_anchor *out, int64_t frames, double ppm, int64_t jitter_ns)
{
    size_t count = 0;
    for (int64_t frame = 0; frame < frames; frame += PIECE, ++count) {
        int64_t wrong =
            jitter_ns
                ? (int64_t)(scene_random((uint64_t)frame) % (uint64_t)(2 * jitter_ns)) - jitter_ns
                : 0;
        out[count] = (show_audio_anchor){
            frame,
            scene_utc_ns + wrong + (int64_t)((double)frame * 1e9 / (RATE * (1.0 + ppm * 1e-6)))};
    }
    return count;
}

static show_audio audio_of(int64_t frames)
{
    return (show_audio){.start_ns = scene_utc_ns,
                        .rate_hz = RATE,
                        .channel_count = 1,
                        .format = "f32",
                        .frame_count = frames};
}

static double time_of(const sound_map *map, int64_t frame)
{
    size_t i = map->knot_count - 1;
    while (i > 0 && map->knot[i].frame > frame)
        --i;
    return map->knot[i].time_ns + (double)(frame - map->knot[i].frame) * map->knot[i].ns_per_frame;
}

static void a_sound_from_a_file_runs_at_its_rate(void **state)
{
    error err = {""};
    sound_map map;
    show_audio audio = audio_of(1000000);
    (void)state;
    audio.start_ns = 0;
    scene_must(sound_map_init(&map, &audio, NULL, 0, &err), &err);
    assert_true(sound_map_is_plain(&map));
    assert_true(fabs(time_of(&map, 480000) - 1e10) < 1e-3);
    sound_map_finish(&map);
}

static void noisy_anchors_give_smooth_times(void **state)
{
    static show_audio_anchor anchors[600 * RATE / PIECE + 1];
    static const double ppm[] = {0, 120, -200};
    (void)state;
    for (int p = 0; p < 3; ++p) {
        error err = {""};
        sound_map map;
        int64_t frames = 600 * RATE;
        double worst_ns = 0;
        show_audio audio = audio_of(frames);
        size_t count = make_anchors(anchors, frames, ppm[p], 1000000);
        scene_must(sound_map_init(&map, &audio, anchors, count, &err), &err);
        for (int64_t frame = 0; frame < frames; frame += 997)
            worst_ns = fmax(worst_ns, fabs(time_of(&map, frame) -
                                           (double)frame * 1e9 / (RATE * (1 + ppm[p] * 1e-6))));
        print_message("%+.0f ppm, anchors 1 ms wrong: times at worst %.3f ms\n", ppm[p],
                      worst_ns / 1e6);
        assert_true(worst_ns < 0.3e6);
        sound_map_finish(&map);
    }
}

static void lost_frames_part_the_sound(void **state)
{
    static show_audio_anchor anchors[60 * RATE / PIECE + 1];
    error err = {""};
    sound_map map;
    int64_t frames = 60 * RATE, gap = 1000 * PIECE;
    show_audio audio = audio_of(frames);
    size_t count = make_anchors(anchors, frames, 50, 0);
    (void)state;
    for (size_t i = 1000; i < count; ++i)
        anchors[i].time_ns += 300000000;
    scene_must(sound_map_init(&map, &audio, anchors, count, &err), &err);
    double gap_ns = (double)gap * 1e9 / (RATE * (1 + 50e-6));
    const sound_knot *before = sound_map_knot_at(&map, gap_ns - 1e6);
    const sound_knot *behind = sound_map_knot_at(&map, gap_ns + 301e6);
    assert_int_equal(before->piece_first, 0);
    assert_int_equal(before->piece_end, gap);
    assert_int_equal(behind->piece_first, gap);
    assert_int_equal(behind->piece_end, frames);
    assert_true(fabs(time_of(&map, gap - 1) - gap_ns) < 1e5);
    assert_true(fabs(time_of(&map, gap) - gap_ns - 300e6) < 1e5);
    sound_map_finish(&map);
}

static void absurd_anchors_do_no_harm(void **state)
{
    show_audio_anchor anchors[200];
    (void)state;
    for (uint64_t i = 0; i < 500; ++i) {
        error err = {""};
        sound_map map;
        show_audio audio = audio_of(i % 3 == 0 ? (int64_t)1 << 60 : 100000);
        uint64_t kind = scene_random(i * 7);
        for (uint64_t k = 0; k < 200; ++k) {
            uint64_t random = scene_random(i * 1000 + k);
            int64_t around = (int64_t)(random % 100000);
            anchors[k].frame = kind & 1 ? (int64_t)(k * 500) : (int64_t)(random % 100000) - 1000;
            anchors[k].time_ns = kind & 2   ? scene_utc_ns + around * 100000
                                 : kind & 4 ? (int64_t)random
                                            : scene_utc_ns + (int64_t)k * 10416667 + around;
        }
        if (kind & 8)
            audio.start_ns = (int64_t)scene_random(i);
        scene_must(sound_map_init(&map, &audio, anchors, 200, &err), &err);
        assert_true(map.knot_count >= 1);
        for (size_t k = 0; k < map.knot_count; ++k) {
            assert_true(isfinite(map.knot[k].time_ns));
            assert_true(map.knot[k].ns_per_frame > 0.98e9 / RATE);
            assert_true(map.knot[k].ns_per_frame < 1.02e9 / RATE);
            assert_true(k == 0 || map.knot[k].time_ns > map.knot[k - 1].time_ns);
            assert_true(k == 0 || map.knot[k].frame > map.knot[k - 1].frame);
        }
        sound_map_finish(&map);
    }
}

/* ---- rendered ---- */

typedef struct fixture {
    scene scene;
    show *show;
    int64_t audio;
} fixture;

/* 60 s recorded by a device that runs ppm fast; from piece 1000 on (32 s) lost_ns later. */
static void record(fixture *d, double ppm, int64_t lost_ns)
{
    static show_audio_anchor anchors[60 * RATE / PIECE + 1];
    static float samples[PIECE];
    error err = {""};
    show_audio audio = audio_of(0);
    size_t count = make_anchors(anchors, (int64_t)60 * RATE, ppm, 0);
    scene_must(show_audio_create(d->show, &audio, &d->audio, &err), &err);
    for (size_t i = 0; i < count; ++i) {
        for (int k = 0; k < PIECE; ++k)
            samples[k] = (float)(anchors[i].frame + k) / SCALE;
        scene_must(show_audio_write(d->show, d->audio,
                                    anchors[i].time_ns + (i < 1000 ? 0 : lost_ns), samples,
                                    sizeof samples, &err),
                   &err);
    }
}

static int fixture_make(void **state)
{
    error err = {""};
    fixture *d = calloc(1, sizeof *d);
    assert_non_null(d);
    scene_make(&d->scene);
    scene_must(show_create(&d->show, d->scene.path, &err), &err);
    *state = d;
    return 0;
}

static int fixture_clear(void **state)
{
    fixture *d = *state;
    show_close(d->show);
    scene_remove(&d->scene);
    free(d);
    return 0;
}

static sound_render *render_of(const fixture *d, int64_t offset_ns, double gain)
{
    error err = {""};
    sound_render *render;
    take_audio audio = {.audio = d->audio, .offset_ns = offset_ns, .gain = gain};
    scene_must(sound_render_create(&render, d->show, &audio, 0, &err), &err);
    return render;
}

static void a_recorded_sound_is_heard_when_it_was_said(void **state)
{
    static float out[4800];
    static const double ppm[] = {150, -200};
    fixture *d = *state;
    for (int p = 0; p < 2; ++p) {
        error err = {""};
        double worst = 0, uncorrected = 0;
        record(d, ppm[p], 0);
        sound_render *render = render_of(d, NS_PER_S / 2, 1.0);
        for (int64_t at = 0; at < 59 * RATE; at += 4800) {
            scene_must(sound_render_frames(render, at, out, 4800, &err), &err);
            for (int64_t i = 0; i < 4800; ++i) {
                double local_s = (double)(at + i) / RATE - 0.5;
                double number = (double)out[i] * SCALE;
                if (local_s < 0.001)
                    continue;
                worst = fmax(worst, fabs(number - local_s * RATE * (1 + ppm[p] * 1e-6)));
                uncorrected = fmax(uncorrected, fabs(local_s * RATE * ppm[p] * 1e-6));
            }
        }
        print_message("%+.0f ppm: off by %.2f frames at worst, %.0f were it not corrected, %llu "
                      "spliced in 58.5 s\n",
                      ppm[p], worst, uncorrected,
                      (unsigned long long)sound_render_splice_count(render));
        assert_true(worst < 1.1);
        assert_true(uncorrected > 400);
        double needed = fabs(ppm[p]) * 1e-6 * 58.5 * RATE;
        assert_true(fabs((double)sound_render_splice_count(render) - needed) < 3.0);
        sound_render_destroy(render);
    }
}

static void what_is_heard_does_not_depend_on_where_one_begins(void **state)
{
    enum { FROM = 30 * RATE, COUNT = 5 * RATE };
    static float whole[COUNT], part[1000];
    fixture *d = *state;
    error err = {""};
    record(d, 170, 100000000);
    sound_render *render = render_of(d, 123456789, 0.8);
    scene_must(sound_render_frames(render, FROM, whole, COUNT, &err), &err);
    for (uint64_t i = 0; i < 300; ++i) {
        int64_t at = (int64_t)(scene_random(i) % (COUNT - 1000));
        scene_must(sound_render_frames(render, FROM + at, part, 1000, &err), &err);
        assert_memory_equal(part, whole + at, sizeof part);
    }
    sound_render_destroy(render);
}

static void lost_frames_are_silence_with_soft_edges(void **state)
{
    static float out[RATE];
    fixture *d = *state;
    error err = {""};
    record(d, 0, 300000000);
    sound_render *render = render_of(d, 0, 1.0);
    scene_must(sound_render_frames(render, 1000 * PIECE - 4800, out, RATE, &err), &err);
    int silent = 0;
    float steepest = 0;
    for (int i = 1; i < RATE; ++i) {
        silent += out[i] == 0.0f;
        steepest = fmaxf(steepest, fabsf(out[i] - out[i - 1]));
    }
    assert_true(abs(silent - 14400) < 3); /* 0.3 s */
    assert_true(steepest < 0.0025f);      /* of 0.37, over 5 ms */
    /* Behind the gap it is where its times say. */
    assert_true(fabs((double)out[30000] * SCALE - (1000 * PIECE - 4800 + 30000 - 14400)) < 1.1);
    sound_render_destroy(render);
}

static void its_wav_is_corrected_too_and_says_how_often(void **state)
{
    fixture *d = *state;
    error err = {""};
    char path[SCENE_PATH];
    sound_file_report report;
    record(d, 100, 0);
    take t = {.start_ns = scene_utc_ns, .audio = {.audio = d->audio, .gain = 1.0}};
    sound_file_export what = {.take = &t, .to_ns = 50 * NS_PER_S};
    snprintf(path, sizeof path, "%s/out.wav", d->scene.folder);
    scene_must(sound_file_write(&report, d->show, &what, path, NULL, &err), &err);
    assert_int_equal(report.rate_hz, RATE);
    assert_int_equal(report.frame_count, 50 * RATE);
    assert_true(report.splice_count >= 238 && report.splice_count <= 242);
}

static void damage_is_silence_and_is_told(void **state)
{
    static float out[RATE];
    fixture *d = *state;
    error err = {""};
    sqlite *db;
    record(d, 0, 0);
    show_close(d->show);
    d->show = NULL;
    scene_must(sqlite_open(&db, d->scene.path, SQLITE_MODE_WRITE, &err), &err);
    scene_must(sqlite_change(db, &err, "UPDATE audio_chunk SET crc = crc + 1 WHERE first_frame = ?",
                             "i", (int64_t)(5 * PIECE)),
               &err);
    sqlite_close(db);
    scene_must(show_open(&d->show, d->scene.path, SHOW_WRITE, &err), &err);
    sound_render *render = render_of(d, 0, 1.0);
    assert_true(sound_render_frames(render, 0, out, RATE, &err) < 0);
    assert_non_null(strstr(err.text, "damaged"));
    assert_true(fabs((double)out[5 * PIECE - 1] * SCALE - (5 * PIECE - 1)) < 1e-3);
    assert_true(out[5 * PIECE] == 0.0f && out[6 * PIECE - 1] == 0.0f);
    assert_true(fabs((double)out[6 * PIECE + 256] * SCALE - (6 * PIECE + 256)) < 1e-3);
    sound_render_destroy(render);
}

#define WITH_FIXTURE(test) cmocka_unit_test_setup_teardown(test, fixture_make, fixture_clear)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_from_a_file_runs_at_its_rate),
        cmocka_unit_test(noisy_anchors_give_smooth_times),
        cmocka_unit_test(lost_frames_part_the_sound),
        cmocka_unit_test(absurd_anchors_do_no_harm),
        WITH_FIXTURE(a_recorded_sound_is_heard_when_it_was_said),
        WITH_FIXTURE(what_is_heard_does_not_depend_on_where_one_begins),
        WITH_FIXTURE(lost_frames_are_silence_with_soft_edges),
        WITH_FIXTURE(its_wav_is_corrected_too_and_says_how_often),
        WITH_FIXTURE(damage_is_silence_and_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
