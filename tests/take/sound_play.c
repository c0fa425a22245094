/* The sound of a take by a loudspeaker, from the show to the ear: in time with the transport,
 * around loops, through edits, and whatever the device does. Frames are their own numbers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show_scene.h"
#include "sound_help.h"
#include "stage/sound/sound.h"

enum { RATE = 48000, SCALE = 1 << 22, FRAMES = 30 * RATE };
static const int64_t begin_ns = 5000000000000;

typedef struct stage {
    scene scene;
    show *show;
    int64_t audio;
    fake_host host;
    sound_backend backend;
    sound *sound;
    sound_motion motion;
    double worst_ms;
    int64_t heard, silent;
} stage;

static int64_t make_sound(show *s, uint32_t rate_hz, uint32_t channels, int64_t frames)
{
    static float piece[8192];
    error err = {""};
    int64_t id;
    show_audio audio = {.rate_hz = rate_hz, .channel_count = channels, .format = "f32"};
    scene_must(show_audio_create(s, &audio, &id, &err), &err);
    int64_t step = 8192 / channels;
    for (int64_t at = 0; at < frames; at += step) {
        for (int64_t i = 0; i < step * channels; ++i)
            piece[i] = (float)(at + i / channels + 1) / SCALE;
        scene_must(
            show_audio_write(s, id, 0, piece, (size_t)(step * channels) * sizeof *piece, &err),
            &err);
    }
    return id;
}

static int stage_make(void **state)
{
    error err = {""};
    stage *s = calloc(1, sizeof *s);
    assert_non_null(s);
    scene_make(&s->scene);
    scene_must(show_create(&s->show, s->scene.path, &err), &err);
    s->audio = make_sound(s->show, RATE, 1, FRAMES);
    s->host.device[SOUND_OUT] = (fake_device){
        .is_there = true,
        .channel_count = 2,
        .clock = {.start_ns = begin_ns, .ppm = 100, .rate_hz = RATE, .jitter_ns = 500000}};
    s->backend = fake_backend(&s->host);
    sound_settings settings = {.show = s->show, .backend = &s->backend, .threads = SOUND_BY_CALLER};
    scene_must(sound_create(&s->sound, &settings, &err), &err);
    *state = s;
    return 0;
}

static int stage_clear(void **state)
{
    stage *s = *state;
    sound_destroy(s->sound);
    show_close(s->show);
    scene_remove(&s->scene);
    free(s);
    return 0;
}

static void load(stage *s, int64_t audio, int64_t offset_ns, double gain)
{
    error err = {""};
    take_audio what = {.audio = audio, .offset_ns = offset_ns, .gain = gain};
    scene_must(sound_load(s->sound, &what, &err), &err);
}

static int64_t now_ns(const stage *s)
{
    const fake_device *out = &s->host.device[SOUND_OUT];
    return out->clock.start_ns + (int64_t)fake_time_ns(&out->clock, out->frame);
}

static void move(stage *s, double speed, int64_t at_ns)
{
    s->motion.host_ns = now_ns(s);
    s->motion.at_ns = at_ns;
    s->motion.speed = speed;
    sound_move(s->sound, &s->motion);
}

/* Where the timeline is when frame i of the block is heard. */
static double timeline_ns(const stage *s, int64_t i)
{
    const fake_device *out = &s->host.device[SOUND_OUT];
    double at_ns = fake_time_ns(&out->clock, out->frame - FAKE_BLOCK + i) +
                   (double)(out->clock.start_ns - s->motion.host_ns) + (double)s->motion.at_ns;
    double length_ns = (double)(s->motion.loop_to_ns - s->motion.loop_from_ns);
    if (length_ns > 0 && at_ns >= (double)s->motion.loop_to_ns)
        at_ns =
            (double)s->motion.loop_from_ns + fmod(at_ns - (double)s->motion.loop_to_ns, length_ns);
    return at_ns;
}

static bool is_near_a_seam(const stage *s, double at_ns)
{
    return s->motion.loop_to_ns > s->motion.loop_from_ns &&
           (fabs(at_ns - (double)s->motion.loop_from_ns) < 15e6 ||
            fabs(at_ns - (double)s->motion.loop_to_ns) < 15e6);
}

static void judge(stage *s, double offset_s, double gain, double since_ns)
{
    const float *out = s->host.device[SOUND_OUT].block;
    for (int i = 0; i < FAKE_BLOCK; ++i) {
        double at_ns = timeline_ns(s, i), expected = (at_ns / 1e9 - offset_s) * RATE + 1;
        s->silent += out[2 * i] == 0.0f;
        s->heard += out[2 * i] != 0.0f;
        assert_true(out[2 * i] == out[2 * i + 1]);
        if (at_ns < since_ns || expected < 1000 || expected > FRAMES || is_near_a_seam(s, at_ns))
            continue;
        double off = (double)out[2 * i] * SCALE / gain - expected;
        s->worst_ms = fmax(s->worst_ms, fabs(off) * 1000.0 / RATE);
    }
}

static void run_blind(stage *s, double seconds)
{
    for (int64_t n = (int64_t)(seconds * RATE / FAKE_BLOCK); n > 0; --n) {
        sound_work(s->sound, now_ns(s));
        memset(s->host.device[SOUND_OUT].block, 0, sizeof s->host.device[SOUND_OUT].block);
        fake_run(&s->host.device[SOUND_OUT], SOUND_OUT);
        sound_update(s->sound);
    }
}

static void run(stage *s, double seconds, double offset_s, double gain, double since_ns)
{
    for (int64_t n = (int64_t)(seconds * RATE / FAKE_BLOCK); n > 0; --n) {
        run_blind(s, (FAKE_BLOCK + 1.0) / RATE);
        judge(s, offset_s, gain, since_ns);
    }
}

/* ---- the click ---- */

static void beat(stage *s, double speed, int64_t at_ns, uint32_t beats)
{
    s->motion.beat_ns = 0.5e9;
    s->motion.bar = 4;
    s->motion.beats = beats;
    move(s, speed, at_ns);
}

typedef struct clicks {
    double at_ns[64];              /* where the timeline is as each begins */
    uint32_t count, crossings[64]; /* of zero: the higher, the more */
    int quiet, since;
    float last;
} clicks;

/* Of silence and clicks: each begins behind a hundredth of a second of silence. */
static void listen(stage *s, double seconds, clicks *to)
{
    for (int64_t n = (int64_t)(seconds * RATE / FAKE_BLOCK); n > 0; --n) {
        run_blind(s, (FAKE_BLOCK + 1.0) / RATE);
        const float *out = s->host.device[SOUND_OUT].block;
        for (int i = 0; i < FAKE_BLOCK; ++i) {
            const float sample = out[2 * i];
            assert_true(sample == out[2 * i + 1]);
            if (sample != 0.0f && to->quiet > RATE / 100) {
                assert_true(to->count < 64);
                to->crossings[to->count] = 0;
                to->at_ns[to->count++] = timeline_ns(s, i);
            } else if (to->count && to->last * sample < 0.0f) {
                to->crossings[to->count - 1] += 1;
            }
            to->quiet = sample == 0.0f ? to->quiet + 1 : 0;
            to->last = sample;
        }
    }
}

/* The first frame of a click is 0: it is heard with the next. */
static void must_be_beats(const clicks *heard, uint32_t count, int64_t first)
{
    assert_int_equal(heard->count, count);
    for (uint32_t i = 0; i < count; ++i) {
        const int64_t beat_now = first + i;
        assert_true(fabs(heard->at_ns[i] - (double)beat_now * 0.5e9) < 0.5e6);
        assert_int_equal(heard->crossings[i] > 70, beat_now % 4 == 0);
    }
}

static void beats_are_heard_in_time_without_a_sound(void **state)
{
    stage *s = *state;
    clicks heard = {.quiet = RATE};
    sound_play_status status;
    sound_want_beats(s->sound);
    run_blind(s, 1.0);
    beat(s, 1.0, 100000000, SOUND_BEATS_AFTER);
    listen(s, 10.0, &heard);
    must_be_beats(&heard, 20, 1);
    sound_play_read_status(s->sound, &status);
    assert_int_equal(status.click_count, 20);
    beat(s, 0.0, 0, SOUND_BEATS_AFTER); /* what stands still has none */
    listen(s, 2.0, &heard);
    assert_int_equal(heard.count, 20);
}

static void a_count_in_falls_on_the_beats_before_the_start(void **state)
{
    stage *s = *state;
    clicks heard = {.quiet = RATE};
    sound_want_beats(s->sound);
    run_blind(s, 1.0);
    s->motion = (sound_motion){.host_ns = now_ns(s) + 2 * NS_PER_S + 100000000,
                               .speed = 1.0,
                               .is_mute = true,
                               .beat_ns = 0.5e9,
                               .bar = 4,
                               .beats = SOUND_BEATS_BEFORE};
    sound_move(s->sound, &s->motion);
    listen(s, 6.0, &heard);
    must_be_beats(&heard, 4, -4);
}

static void beats_go_on_around_a_loop(void **state)
{
    stage *s = *state;
    clicks heard = {.quiet = RATE};
    sound_want_beats(s->sound);
    run_blind(s, 1.0);
    s->motion.loop_from_ns = 250000000; /* between two beats */
    s->motion.loop_to_ns = 750000000;
    beat(s, 1.0, 250000000, SOUND_BEATS_AFTER);
    listen(s, 5.0, &heard);
    assert_int_equal(heard.count, 10);
    for (uint32_t i = 0; i < heard.count; ++i)
        assert_true(fabs(heard.at_ns[i] - 0.5e9) < 0.5e6);
}

static void the_sound_is_not_heard_while_only_beats_are(void **state)
{
    stage *s = *state;
    clicks heard = {.quiet = RATE};
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    s->motion.is_mute = true;
    beat(s, 1.0, 100000000, SOUND_BEATS_AFTER);
    listen(s, 3.0, &heard);
    must_be_beats(&heard, 6, 1);
    s->motion.is_mute = false;
    beat(s, 1.0, 0, 0);
    run(s, 3.0, 0.0, 1.0, 0);
    assert_true(s->heard > 2 * RATE);
}

static void a_take_is_heard_in_time(void **state)
{
    stage *s = *state;
    sound_play_status status;
    load(s, s->audio, NS_PER_S / 2, 0.5);
    run_blind(s, 1.0);
    move(s, 1.0, 0);
    run(s, 20.0, 0.5, 0.5, 0);
    sound_play_read_status(s->sound, &status);
    print_message("20 s at +100 ppm: off by %.3f ms at worst, %llu spliced\n", s->worst_ms,
                  (unsigned long long)status.spliced_count);
    assert_true(s->worst_ms < 0.6);
    assert_true(s->heard > 19 * RATE);
    assert_int_equal(status.device.state, SOUND_DEVICE_RUNNING);
    assert_true(status.is_heard);
    assert_string_equal(status.text, "");
    assert_true(fabs(status.drift_ppm - 100.0) < 10.0);
    assert_int_equal(status.jumped_count + status.starved_count + status.broken_count, 0);
}

static void pause_seek_and_play_again(void **state)
{
    stage *s = *state;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    move(s, 1.0, 0);
    run_blind(s, 2.0);
    move(s, 0.0, 2 * NS_PER_S);
    run_blind(s, 0.1);
    s->heard = 0;
    run(s, 1.0, 0, 1.0, 1e18);
    assert_int_equal(s->heard, 0);
    move(s, 1.0, 20 * NS_PER_S);
    run(s, 3.0, 0, 1.0, 20.05e9);
    assert_true(s->worst_ms < 0.6);
    move(s, 1.0, 3 * NS_PER_S); /* while it plays */
    run(s, 3.0, 0, 1.0, 3.05e9);
    assert_true(s->worst_ms < 0.6);
    s->silent = 0;
    run(s, 1.0, 0, 1.0, 0);
    assert_int_equal(s->silent, 0);
}

/* The transport says it with every frame; what is no change is none. */
static void saying_the_same_again_changes_nothing(void **state)
{
    stage *s = *state;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    move(s, 1.0, 0);
    run_blind(s, 1.0);
    sound_motion first = s->motion;
    for (int i = 0; i < 100; ++i) {
        sound_motion again = first;
        again.host_ns = now_ns(s);
        again.at_ns = first.at_ns + again.host_ns - first.host_ns + (i % 3 - 1) * 100000;
        sound_move(s->sound, &again);
        s->silent = 0;
        run(s, 0.02, 0, 1.0, 0);
        assert_int_equal(s->silent, 0);
    }
    assert_true(s->worst_ms < 0.6);
}

static void a_loop_is_played_around_without_being_told(void **state)
{
    stage *s = *state;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    s->motion.loop_from_ns = 4 * NS_PER_S;
    s->motion.loop_to_ns = 4 * NS_PER_S + 777777777;
    move(s, 1.0, 3 * NS_PER_S);
    run(s, 0.5, 0, 1.0, 3.2e9);
    s->silent = 0;
    run(s, 30.0, 0, 1.0, 0);
    assert_true(s->worst_ms < 0.6);
    assert_true(s->silent < 100); /* an instant at each of 38 seams */
    sound_play_status status;
    sound_play_read_status(s->sound, &status);
    assert_int_equal(status.starved_count, 0);
    assert_int_equal(status.jumped_count, 0);
}

static void a_transport_says_where_it_is(void **state)
{
    transport t;
    (void)state;
    transport_init(&t, 10 * NS_PER_S);
    assert_true(sound_motion_of(&t, 50).speed == 0.0);
    assert_true(transport_set_loop(&t, 100, NS_PER_S, 2 * NS_PER_S));
    transport_seek(&t, 100, NS_PER_S / 2);
    transport_play(&t, 1000);
    sound_motion motion = sound_motion_of(&t, 1000 + NS_PER_S / 4);
    assert_true(motion.speed == 1.0);
    assert_int_equal(motion.host_ns, 1000 + NS_PER_S / 4);
    assert_int_equal(motion.at_ns, 3 * NS_PER_S / 4);
    assert_int_equal(motion.loop_from_ns, NS_PER_S);
    assert_int_equal(motion.loop_to_ns, 2 * NS_PER_S);
    transport_end_loop(&t, 2000 + NS_PER_S / 4);
    motion = sound_motion_of(&t, 20 * NS_PER_S);
    assert_int_equal(motion.loop_to_ns, 0);
    assert_true(motion.speed == 0.0); /* it is at the end */
}

static void an_edit_of_the_offset_is_heard_at_once(void **state)
{
    stage *s = *state;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    move(s, 1.0, 0);
    run_blind(s, 5.0);
    uint32_t opened = s->host.device[SOUND_OUT].open_count;
    load(s, s->audio, -2 * NS_PER_S, 0.25);
    run_blind(s, 0.1);
    run(s, 5.0, -2.0, 0.25, 0);
    assert_true(s->worst_ms < 0.6);
    assert_int_equal(s->host.device[SOUND_OUT].open_count, opened);
    load(s, 0, 0, 1.0);
    run_blind(s, 0.1);
    s->heard = 0;
    run(s, 1.0, 0, 1.0, 1e18);
    assert_int_equal(s->heard, 0);
}

static void a_sound_of_another_rate_opens_the_device_anew(void **state)
{
    stage *s = *state;
    sound_play_status status;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    int64_t other = make_sound(s->show, 32000, 3, 100000);
    load(s, other, 0, 1.0);
    run_blind(s, 1.0);
    assert_int_equal(s->host.device[SOUND_OUT].open_count, 2);
    move(s, 1.0, 0);
    run_blind(s, 1.0);
    sound_play_read_status(s->sound, &status);
    assert_int_equal(status.device.stream.rate_hz, 32000);
    assert_true(status.is_heard);
    assert_non_null(strstr(status.text, "first 2 of 3 channels"));
}

static void at_other_speeds_it_says_that_it_is_muted(void **state)
{
    stage *s = *state;
    sound_play_status status;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    move(s, 0.5, 0);
    run(s, 1.0, 0, 1.0, 1e18);
    assert_int_equal(s->heard, 0);
    sound_play_read_status(s->sound, &status);
    assert_non_null(strstr(status.text, "muted at 0.5x"));
}

static void without_a_device_there_is_a_sentence_and_nothing_stops(void **state)
{
    stage *s = *state;
    fake_device *out = &s->host.device[SOUND_OUT];
    sound_play_status status;
    out->is_there = false;
    load(s, s->audio, 0, 1.0);
    move(s, 1.0, 0);
    run_blind(s, 3.0);
    sound_play_read_status(s->sound, &status);
    assert_int_equal(status.device.state, SOUND_DEVICE_AWAY);
    assert_string_equal(status.text, "sound: nothing was found");
    out->is_there = true;
    out->refusal = "it is busy";
    run_blind(s, 3.0);
    sound_play_read_status(s->sound, &status);
    assert_string_equal(status.text, "sound: it is busy");
    out->refusal = NULL;
    /* It is there, and what is played has gone on meanwhile. */
    run_blind(s, 3.0);
    sound_play_read_status(s->sound, &status);
    assert_string_equal(status.text, "");
    run(s, 2.0, 0, 1.0, 0);
    assert_true(s->worst_ms < 0.6);
    assert_true(s->heard > RATE * 19 / 10);
}

static void a_device_that_is_unplugged_is_found_again(void **state)
{
    stage *s = *state;
    fake_device *out = &s->host.device[SOUND_OUT];
    sound_play_status status;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    move(s, 1.0, 0);
    run_blind(s, 2.0);
    out->is_dead = true;
    out->is_there = false;
    run_blind(s, 1.0);
    sound_play_read_status(s->sound, &status);
    assert_int_equal(status.device.state, SOUND_DEVICE_AWAY);
    assert_int_equal(status.device.lost_count, 1);
    assert_non_null(strstr(status.text, "unplugged"));
    assert_false(out->is_open);
    out->is_there = true;
    run_blind(s, 5.0);
    run(s, 3.0, 0, 1.0, 0);
    assert_true(s->worst_ms < 0.6);
    assert_true(s->heard > RATE * 29 / 10);
}

static void a_device_that_falls_silent_is_given_up(void **state)
{
    stage *s = *state;
    fake_device *out = &s->host.device[SOUND_OUT];
    sound_play_status status;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    out->is_running = false; /* and says that all is well */
    run_blind(s, 4.0);
    sound_play_read_status(s->sound, &status);
    assert_int_equal(status.device.lost_count, 1);
}

static void a_device_of_another_rate_is_heard_in_time(void **state)
{
    stage *s = *state;
    sound_play_status status;
    s->host.device[SOUND_OUT].rate_hz = 44100;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    move(s, 1.0, 0);
    run(s, 5.0, 0, 1.0, 0.05e9);
    sound_play_read_status(s->sound, &status);
    print_message("48 kHz by a device of 44.1: off by %.3f ms at worst\n", s->worst_ms);
    assert_int_equal(status.device.state, SOUND_DEVICE_RUNNING);
    assert_int_equal(status.device.stream.rate_hz, 44100);
    assert_string_equal(status.text, "");
    assert_true(s->worst_ms < 0.6);
    assert_true(s->heard > 49 * RATE / 10);
    assert_true(fabs(status.drift_ppm - 100.0) < 20.0);
    assert_int_equal(status.jumped_count + status.starved_count + status.broken_count, 0);
    move(s, 1.0, 20 * NS_PER_S); /* while it plays */
    run(s, 2.0, 0, 1.0, 20.05e9);
    assert_true(s->worst_ms < 0.6);
}

/* Unplugged, and what is plugged in instead runs at another rate. */
static void a_device_may_come_back_at_another_rate(void **state)
{
    stage *s = *state;
    load(s, s->audio, 0, 1.0);
    run_blind(s, 1.0);
    move(s, 1.0, 0);
    run(s, 2.0, 0, 1.0, 0.05e9);
    s->host.device[SOUND_OUT].is_dead = true;
    s->host.device[SOUND_OUT].rate_hz = 96000;
    run_blind(s, 6.0);
    s->heard = s->silent = 0;
    run(s, 4.0, 0, 1.0, 0);
    assert_int_equal(s->silent, 0);
    assert_true(s->worst_ms < 0.6);
}

static void a_sound_that_is_not_there_is_an_error(void **state)
{
    stage *s = *state;
    error err = {""};
    take_audio what = {.audio = 999, .gain = 1.0};
    assert_true(sound_load(s->sound, &what, &err) < 0);
    assert_non_null(strstr(err.text, "999"));
}

#define STAGE(test) cmocka_unit_test_setup_teardown(test, stage_make, stage_clear)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STAGE(a_take_is_heard_in_time),
        STAGE(pause_seek_and_play_again),
        STAGE(saying_the_same_again_changes_nothing),
        STAGE(a_loop_is_played_around_without_being_told),
        STAGE(beats_are_heard_in_time_without_a_sound),
        STAGE(a_count_in_falls_on_the_beats_before_the_start),
        STAGE(beats_go_on_around_a_loop),
        STAGE(the_sound_is_not_heard_while_only_beats_are),
        cmocka_unit_test(a_transport_says_where_it_is),
        STAGE(an_edit_of_the_offset_is_heard_at_once),
        STAGE(a_sound_of_another_rate_opens_the_device_anew),
        STAGE(at_other_speeds_it_says_that_it_is_muted),
        STAGE(without_a_device_there_is_a_sentence_and_nothing_stops),
        STAGE(a_device_that_is_unplugged_is_found_again),
        STAGE(a_device_that_falls_silent_is_given_up),
        STAGE(a_device_of_another_rate_is_heard_in_time),
        STAGE(a_device_may_come_back_at_another_rate),
        STAGE(a_sound_that_is_not_there_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
