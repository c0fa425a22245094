/* The microphone into a show: frames with the times at which they were said, whatever its clock
 * does, and what is lost is counted. Frames are their own numbers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show_scene.h"
#include "sound_help.h"
#include "stage/sound/sound.h"
#include "show/sound_render.h"

enum { RATE = 48000, SCALE = 1 << 22 }; /* exact in 24 bits */
static const int64_t begin_ns = 5000000000000;

typedef struct stage {
    scene scene;
    show *show;
    writer *writer;
    fake_host host;
    sound_backend backend;
    sound *sound;
    int64_t said; /* frames of the device */
} stage;

static int stage_make(void **state)
{
    error err = {""};
    stage *s = calloc(1, sizeof *s);
    writer_options options = scene_options();
    assert_non_null(s);
    scene_make(&s->scene);
    scene_must(show_create(&s->show, s->scene.path, &err), &err);
    scene_must(writer_start(&s->writer, s->show, &options, &err), &err);
    s->host.device[SOUND_IN] = (fake_device){
        .is_there = true,
        .rate_hz = RATE,
        .channel_count = 2,
        .clock = {.start_ns = begin_ns, .ppm = -130, .rate_hz = RATE, .jitter_ns = 1000000}};
    s->backend = fake_backend(&s->host);
    sound_settings settings = {.show = s->show, .backend = &s->backend, .threads = SOUND_BY_CALLER};
    scene_must(sound_create(&s->sound, &settings, &err), &err);
    *state = s;
    return 0;
}

static int stage_clear(void **state)
{
    stage *s = *state;
    error err = {""};
    sound_destroy(s->sound);
    scene_must(writer_stop(s->writer, &err), &err);
    show_close(s->show);
    scene_remove(&s->scene);
    free(s);
    return 0;
}

static int64_t now_ns(const stage *s)
{
    const fake_device *in = &s->host.device[SOUND_IN];
    return in->clock.start_ns + (int64_t)fake_time_ns(&in->clock, in->frame);
}

static void arm(stage *s)
{
    error err = {""};
    scene_must(sound_arm(s->sound, s->writer, 1, &err), &err);
    assert_true(sound_is_armed(s->sound));
}

static void speak_block(stage *s)
{
    fake_device *in = &s->host.device[SOUND_IN];
    for (int i = 0; i < FAKE_BLOCK; ++i)
        in->block[i] = (float)(in->frame + i + 1) / SCALE;
    fake_run(in, SOUND_IN);
}

static void speak(stage *s, double seconds)
{
    for (int64_t n = (int64_t)(seconds * RATE / FAKE_BLOCK); n > 0; --n) {
        sound_work(s->sound, now_ns(s));
        speak_block(s);
        sound_update(s->sound);
    }
}

static sound_record_status disarm(stage *s)
{
    error err = {""};
    sound_in_status status;
    sound_disarm(s->sound);
    for (int i = 0; i < 10 && sound_is_armed(s->sound); ++i) {
        sound_work(s->sound, now_ns(s));
        sound_update(s->sound);
    }
    assert_false(sound_is_armed(s->sound));
    scene_must(writer_flush(s->writer, &err), &err);
    sound_in_read_status(s->sound, &status);
    return status.record;
}

/* Silent or fading: its number cannot be read. */
static bool is_near_silence(const float *all, int64_t at, int64_t count)
{
    int64_t from = at > 300 ? at - 300 : 0, to = at + 300 < count ? at + 300 : count - 1;
    return all[at] == 0.0f || all[from] == 0.0f || all[to] == 0.0f;
}

/* Each frame heard when it was said: at worst so many ms off; the number of silent ones. */
static double listen(stage *s, int64_t audio, int64_t *out_silent)
{
    enum { ALL = 80 * RATE, EDGE = 4800 };
    static float all[ALL];
    error err = {""};
    show_audio info;
    sound_render *render;
    double worst_ms = 0;
    const fake_clock *clock = &s->host.device[SOUND_IN].clock;
    take_audio what = {.audio = audio, .gain = 1.0};
    scene_must(show_audio_info(s->show, audio, &info, &err), &err);
    scene_must(sound_render_create(&render, s->show, &what, 0, &err), &err);
    const sound_map *map = sound_render_map(render);
    const sound_knot *last = &map->knot[map->knot_count - 1];
    double end_ns = last->time_ns + (double)(info.frame_count - last->frame) * last->ns_per_frame;
    int64_t count = (int64_t)(end_ns / 1e9 * RATE) - 2 * EDGE;
    assert_true(count > 0 && count <= ALL);
    scene_must(sound_render_frames(render, EDGE, all, (size_t)count, &err), &err);
    *out_silent = 0;
    for (int64_t i = 0; i < count; ++i) {
        double said_ns = fake_time_ns(clock, (int64_t)((double)all[i] * SCALE + 0.5) - 1);
        double heard_ns = (double)(i + EDGE) * 1e9 / RATE +
                          (double)(info.start_ns - scene_utc_ns - clock->start_ns);
        *out_silent += all[i] == 0.0f;
        if (!is_near_silence(all, i, count))
            worst_ms = fmax(worst_ms, fabs(said_ns - heard_ns) / 1e6);
    }
    sound_render_destroy(render);
    return worst_ms;
}

static void what_was_said_is_heard_when_it_was_said(void **state)
{
    stage *s = *state;
    error err = {""};
    show_audio info;
    int64_t silent;
    sound_in_status status;
    arm(s);
    speak(s, 60.0);
    sound_in_read_status(s->sound, &status);
    assert_true(fabs(status.record.drift_ppm + 130.0) < 10.0);
    assert_true(fabsf(status.record.peak - 60.0f * RATE / SCALE) < 0.01f);
    sound_record_status done = disarm(s);
    assert_string_equal(done.text, "");
    assert_int_equal(done.lost_frames + done.gap_count, 0);
    scene_must(show_audio_info(s->show, done.audio, &info, &err), &err);
    assert_string_equal(info.format, "s24");
    assert_string_equal(info.name, "fake");
    assert_int_equal(info.rate_hz, RATE);
    assert_int_equal(info.channel_count, 1);
    assert_int_equal(info.frame_count, done.frame_count);
    assert_true(info.frame_count > 59 * RATE);
    assert_true(llabs(info.start_ns - scene_utc_ns - begin_ns) < 20 * NS_PER_MS);
    double worst_ms = listen(s, done.audio, &silent);
    print_message("60 s at -130 ppm, told 1 ms wrong: off by %.3f ms at worst\n", worst_ms);
    assert_true(worst_ms < 1.0);
    assert_int_equal(silent, 0);
}

static void samples_are_kept_as_they_were(void **state)
{
    static unsigned char bytes[3 * RATE];
    stage *s = *state;
    error err = {""};
    size_t size;
    arm(s);
    speak(s, 1.0);
    sound_record_status done = disarm(s);
    scene_must(show_audio_read(s->show, done.audio, 0, bytes, sizeof bytes, &size, &err), &err);
    assert_true(size > 3 * RATE * 9 / 10);
    uint32_t first = bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16;
    for (size_t i = 0; i < size / 3; ++i) {
        const unsigned char *b = bytes + 3 * i;
        assert_int_equal(b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16, first + 2 * i);
    }
}

static void expect_mark(stage *s, const char *words, int64_t near_ns)
{
    error err = {""};
    take_event *events;
    size_t count;
    scene_must(show_events(s->show, scene_utc_ns, INT64_MAX, &events, &count, &err), &err);
    assert_int_equal(count, 1);
    assert_int_equal(events[0].kind, TAKE_EVENT_MARK);
    assert_memory_equal(events[0].text, words, strlen(words));
    assert_true(llabs(events[0].time_ns - scene_utc_ns - near_ns) < 50 * NS_PER_MS);
    free(events);
}

static void frames_lost_by_the_device_are_a_gap(void **state)
{
    stage *s = *state;
    int64_t silent;
    arm(s);
    speak(s, 20.0);
    s->host.device[SOUND_IN].frame += 24000; /* half a second that nobody took */
    s->host.device[SOUND_IN].is_broken = true;
    speak(s, 20.0);
    sound_record_status done = disarm(s);
    assert_int_equal(done.gap_count, 1);
    assert_true(llabs((int64_t)done.lost_frames - 24000) < 200);
    double worst_ms = listen(s, done.audio, &silent);
    assert_true(worst_ms < 1.5); /* around the gap only its own blocks are known */
    assert_true(llabs(silent - 24000) < 200);
    expect_mark(s, "microphone: 0.5", begin_ns + 20 * NS_PER_S + NS_PER_S / 2);
}

static void a_recorder_that_was_held_up_loses_what_the_ring_cannot_hold(void **state)
{
    stage *s = *state;
    int64_t silent;
    arm(s);
    speak(s, 10.0);
    for (int i = 0; i < 4500; ++i) /* 4096 fit */
        speak_block(s);
    speak(s, 10.0);
    sound_record_status done = disarm(s);
    assert_true(done.gap_count >= 1);
    assert_true(llabs((int64_t)done.lost_frames - 404 * FAKE_BLOCK) < 2 * FAKE_BLOCK);
    double worst_ms = listen(s, done.audio, &silent);
    assert_true(worst_ms < 1.0);
    assert_true(llabs(silent - 404 * FAKE_BLOCK) < 3 * FAKE_BLOCK);
}

static void a_microphone_that_is_unplugged_goes_on_in_the_same_sound(void **state)
{
    stage *s = *state;
    fake_device *in = &s->host.device[SOUND_IN];
    sound_in_status status;
    int64_t silent;
    arm(s);
    speak(s, 10.0);
    in->is_dead = true;
    in->is_there = false;
    speak(s, 1.0);
    sound_in_read_status(s->sound, &status);
    assert_int_equal(status.device.state, SOUND_DEVICE_AWAY);
    assert_non_null(strstr(status.device.text, "unplugged"));
    speak(s, 4.0);
    in->is_there = true;
    speak(s, 12.0);
    sound_in_read_status(s->sound, &status);
    assert_int_equal(status.device.state, SOUND_DEVICE_RUNNING);
    sound_record_status done = disarm(s);
    assert_int_equal(done.gap_count, 1);
    assert_true(listen(s, done.audio, &silent) < 1.5);
    assert_true(silent > 4 * RATE);
}

static void without_a_microphone_there_is_a_sentence(void **state)
{
    stage *s = *state;
    sound_in_status status;
    s->host.device[SOUND_IN].is_there = false;
    arm(s);
    speak(s, 3.0);
    sound_in_read_status(s->sound, &status);
    assert_int_equal(status.device.state, SOUND_DEVICE_AWAY);
    assert_string_equal(status.device.text, "sound: nothing was found");
    sound_record_status done = disarm(s);
    assert_int_equal(done.audio, 0);
}

static void armed_again_it_is_another_sound(void **state)
{
    stage *s = *state;
    error err = {""};
    int64_t *ids;
    size_t count;
    for (int i = 0; i < 3; ++i) {
        arm(s);
        assert_true(sound_arm(s->sound, s->writer, 1, &err) < 0);
        speak(s, 1.0);
        assert_true(disarm(s).audio > 0);
    }
    scene_must(show_audio_ids(s->show, &ids, &count, &err), &err);
    assert_int_equal(count, 3);
    free(ids);
}

static void a_program_that_ends_keeps_what_was_said(void **state)
{
    stage *s = *state;
    error err = {""};
    show_audio info;
    sound_in_status status;
    arm(s);
    speak(s, 2.0);
    sound_in_read_status(s->sound, &status);
    sound_destroy(s->sound);
    s->sound = NULL;
    scene_must(writer_flush(s->writer, &err), &err);
    scene_must(show_audio_info(s->show, status.record.audio, &info, &err), &err);
    assert_true(info.frame_count > RATE * 19 / 10);
}

#define STAGE(test) cmocka_unit_test_setup_teardown(test, stage_make, stage_clear)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STAGE(what_was_said_is_heard_when_it_was_said),
        STAGE(samples_are_kept_as_they_were),
        STAGE(frames_lost_by_the_device_are_a_gap),
        STAGE(a_recorder_that_was_held_up_loses_what_the_ring_cannot_hold),
        STAGE(a_microphone_that_is_unplugged_goes_on_in_the_same_sound),
        STAGE(without_a_microphone_there_is_a_sentence),
        STAGE(armed_again_it_is_another_sound),
        STAGE(a_program_that_ends_keeps_what_was_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
