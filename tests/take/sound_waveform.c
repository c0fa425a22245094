/* The outline of a sound is exact at every zoom, while it is computed and while the sound grows. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show_scene.h"
#include "show/sound_pcm.h"
#include "show/waveform.h"

typedef struct fixture {
    scene scene;
    show *show;
    int64_t audio, frames;
    int16_t *samples; /* what was written: 2 channels */
    waveform *wave;
} fixture;

static void write_frames(fixture *d, int64_t count)
{
    error err = {""};
    d->samples = realloc(d->samples, (size_t)(d->frames + count) * 4);
    assert_non_null(d->samples);
    for (int64_t i = 0; i < 2 * count; ++i) {
        int64_t n = 2 * d->frames + i;
        int64_t loud = 1 + (n / 5000) % 32768;
        d->samples[n] = (int16_t)((int64_t)(scene_random((uint64_t)n) % (uint64_t)loud) - loud / 3);
    }
    for (int64_t at = 0; at < count; at += 5003) {
        int64_t piece = count - at < 5003 ? count - at : 5003;
        scene_must(show_audio_write(d->show, d->audio, 0, d->samples + 2 * (d->frames + at),
                                    (size_t)piece * 4, &err),
                   &err);
    }
    d->frames += count;
}

static int fixture_make(void **state)
{
    error err = {""};
    fixture *d = calloc(1, sizeof *d);
    show_audio audio = {.rate_hz = 48000, .channel_count = 2, .format = "s16"};
    assert_non_null(d);
    scene_make(&d->scene);
    scene_must(show_create(&d->show, d->scene.path, &err), &err);
    scene_must(show_audio_create(d->show, &audio, &d->audio, &err), &err);
    scene_must(waveform_create(&d->wave, d->show, d->audio, &err), &err);
    *state = d;
    return 0;
}

static int fixture_clear(void **state)
{
    fixture *d = *state;
    waveform_destroy(d->wave);
    show_close(d->show);
    scene_remove(&d->scene);
    free(d->samples);
    free(d);
    return 0;
}

static void step_to_end(fixture *d, int64_t frames_at_a_time)
{
    error err = {""};
    mrt_result result;
    while ((result = waveform_step(d->wave, d->show, frames_at_a_time, &err)) == MRT_OK)
        continue;
    assert_int_equal(result, MRT_END);
    assert_int_equal(waveform_known_frames(d->wave), d->frames);
}

static void expect_exact(fixture *d, int64_t from, int64_t to, size_t pairs_max)
{
    static waveform_view view;
    error err = {""};
    int64_t known = waveform_known_frames(d->wave);
    scene_must(waveform_read(d->wave, d->show, from, to, pairs_max, &view, &err), &err);
    to = to < known ? to : known;
    assert_true(view.count >= 1 && view.count <= pairs_max);
    assert_int_equal(view.frames_per_pair & (view.frames_per_pair - 1), 0);
    assert_int_equal(view.first_frame % view.frames_per_pair, 0);
    assert_true(view.first_frame <= from && from < view.first_frame + view.frames_per_pair);
    assert_true(view.first_frame + (int64_t)view.count * view.frames_per_pair >= to);
    /* With half of it they would be too many. */
    int64_t half = view.frames_per_pair / 2;
    assert_true(half == 0 || (to - 1) / half - from / half + 1 > (int64_t)pairs_max);
    for (size_t p = 0; p < view.count; ++p) {
        int64_t first = view.first_frame + (int64_t)p * view.frames_per_pair;
        int64_t end = first + view.frames_per_pair < known ? first + view.frames_per_pair : known;
        int16_t least = d->samples[2 * first], greatest = least;
        for (int64_t i = 2 * first; i < 2 * end; ++i) {
            least = d->samples[i] < least ? d->samples[i] : least;
            greatest = d->samples[i] > greatest ? d->samples[i] : greatest;
        }
        if (view.pair[p].least != (float)least / 32768.0f ||
            view.pair[p].greatest != (float)greatest / 32768.0f)
            fail_msg("pair %zu of %lld..%lld by %zu differs", p, (long long)from, (long long)to,
                     pairs_max);
    }
}

static void every_zoom_is_exact(void **state)
{
    fixture *d = *state;
    write_frames(d, 1234567);
    step_to_end(d, 10000);
    expect_exact(d, 0, d->frames, 4096);
    expect_exact(d, 0, d->frames, 1);
    expect_exact(d, 777, 778, 1);
    for (uint64_t i = 0; i < 60; ++i) {
        uint64_t random = scene_random(i);
        int64_t length = 1 + (int64_t)((random >> 8) % ((uint64_t)1 << (1 + random % 20)));
        int64_t from = (int64_t)(scene_random(i + 1000) % (uint64_t)(d->frames - length));
        expect_exact(d, from, from + length, 1 + (size_t)((random >> 40) % 4096));
    }
}

static void what_is_known_so_far_is_exact(void **state)
{
    fixture *d = *state;
    error err = {""};
    static waveform_view view;
    write_frames(d, 50001);
    scene_must(waveform_read(d->wave, d->show, 0, 50001, 100, &view, &err), &err);
    assert_int_equal(view.count, 0);
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(waveform_step(d->wave, d->show, 7777, &err), MRT_OK);
        expect_exact(d, 0, d->frames, 64);
        expect_exact(d, 300, d->frames, 4096);
    }
}

static void a_sound_that_grows_is_followed(void **state)
{
    fixture *d = *state;
    for (int i = 0; i < 20; ++i) {
        write_frames(d, 1111 + 97 * i);
        step_to_end(d, 4000);
        expect_exact(d, 0, d->frames, 50);
        expect_exact(d, d->frames - 900, d->frames, 20);
    }
}

/* The finest levels are let go as the sound gets longer. */
static void a_sound_too_long_for_the_finest_level_is_exact_too(void **state)
{
    fixture *d = *state;
    waveform_limit(d->wave, 256);
    for (int i = 0; i < 12; ++i) {
        write_frames(d, 100000);
        step_to_end(d, 30000);
        expect_exact(d, 0, d->frames, 4096);
        expect_exact(d, 0, d->frames, 200);
        expect_exact(d, 0, d->frames, 1);
        expect_exact(d, d->frames - 70000, d->frames, 512);
    }
}

static void nonsense_is_refused(void **state)
{
    static waveform_view view;
    fixture *d = *state;
    error err = {""};
    waveform *none;
    write_frames(d, 1000);
    step_to_end(d, 1000);
    assert_true(waveform_read(d->wave, d->show, 0, 10, 0, &view, &err) < 0);
    assert_true(waveform_read(d->wave, d->show, 0, 10, 4097, &view, &err) < 0);
    scene_must(waveform_read(d->wave, d->show, 10, 10, 5, &view, &err), &err);
    assert_int_equal(view.count, 0);
    scene_must(waveform_read(d->wave, d->show, -50, INT64_MAX, 5, &view, &err), &err);
    assert_true(view.count > 0);
    scene_must(waveform_read(d->wave, d->show, 5000, 6000, 5, &view, &err), &err);
    assert_int_equal(view.count, 0);
    assert_true(waveform_create(&none, d->show, 12345, &err) < 0);
    assert_null(none);
}

#define WITH_FIXTURE(test) cmocka_unit_test_setup_teardown(test, fixture_make, fixture_clear)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_FIXTURE(every_zoom_is_exact),
        WITH_FIXTURE(what_is_known_so_far_is_exact),
        WITH_FIXTURE(a_sound_that_grows_is_followed),
        WITH_FIXTURE(a_sound_too_long_for_the_finest_level_is_exact_too),
        WITH_FIXTURE(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
