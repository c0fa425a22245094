/* The microphone and the loudspeaker beside a live stage: what was said while a take was recorded
 * becomes its sound; whoever performs hears a click. */
#include "window/live_fixture.h"

static const writer_slate slate = {.scene = "1", .shot = "a"};

/* ---- a microphone that hums, or a loudspeaker, by a thread of its own ---- */

enum { BLOCK = 480, RATE_HZ = 48000 };

typedef struct microphone {
    _Atomic bool is_there, is_closing;
    bool is_loudspeaker, has_thread;
    pthread_t thread;
    sound_callback *callback;
    void *data;
} microphone;

static void *hum(void *data)
{
    microphone *m = data;
    float frames[BLOCK], heard[2 * BLOCK];
    int64_t next_ns = clock_now_ns();
    for (int i = 0; i < BLOCK; ++i)
        frames[i] = 0.25f * sinf((float)i * 0.0654f);
    while (!atomic_load(&m->is_closing)) {
        const sound_block block = {.in = m->is_loudspeaker ? NULL : frames,
                                   .out = m->is_loudspeaker ? heard : NULL,
                                   .frame_count = BLOCK,
                                   .time_ns = next_ns};
        m->callback(m->data, &block);
        next_ns += (int64_t)BLOCK * NS_PER_S / RATE_HZ;
        clock_sleep_until_ns(next_ns);
    }
    return NULL;
}

static mrt_result microphone_open(void *self, sound_direction direction,
                                  const sound_request *request, sound_callback *callback,
                                  void *data, sound_stream *out, error *err)
{
    microphone *m = self;
    (void)request;
    if (direction != (m->is_loudspeaker ? SOUND_OUT : SOUND_IN) || !atomic_load(&m->is_there))
        return error_set(err, MRT_ERR_IO, "sound: nothing is plugged in: plug in a microphone");
    m->callback = callback;
    m->data = data;
    *out = (sound_stream){.handle = m,
                          .rate_hz = RATE_HZ,
                          .channel_count = m->is_loudspeaker ? 2 : 1,
                          .latency_ns = 10 * NS_PER_MS};
    snprintf(out->name, sizeof out->name, "hum");
    return MRT_OK;
}

static mrt_result microphone_start(void *self, void *handle, error *err)
{
    microphone *m = self;
    (void)handle;
    atomic_store(&m->is_closing, false);
    if (pthread_create(&m->thread, NULL, hum, m) != 0)
        return error_set(err, MRT_ERR_MEMORY, "no thread");
    m->has_thread = true;
    return MRT_OK;
}

static bool microphone_is_alive(void *self, void *handle)
{
    (void)self, (void)handle;
    return true;
}

static void microphone_close(void *self, void *handle)
{
    microphone *m = self;
    (void)handle;
    atomic_store(&m->is_closing, true);
    if (m->has_thread)
        pthread_join(m->thread, NULL);
    m->has_thread = false;
}

static sound_backend backend_of(microphone *m)
{
    return (sound_backend){.self = m,
                           .open = microphone_open,
                           .start = microphone_start,
                           .is_alive = microphone_is_alive,
                           .close = microphone_close};
}

static bool is_heard(live_fixture *d, void *data)
{
    live_status status;
    (void)data;
    live_status_of(d->live, &status);
    return status.listening.record.audio != 0;
}

static bool is_edited(live_fixture *d, void *data)
{
    int64_t id = live_take_edited(d->live);
    if (id != 0)
        *(int64_t *)data = id;
    return id != 0;
}

static void what_is_said_is_the_takes(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    take t = {0};
    show_audio audio;
    microphone m = {.is_there = true};
    const sound_backend backend = backend_of(&m);
    int64_t edited = 0;
    fixture_start_heard(&d, "puppet", NULL, FIXTURE_SHOW, &backend);
    fixture_must(live_arm_sound(d.live, 1, &err), &err);
    assert_true(fixture_until(&d, is_heard, NULL));
    for (int n = 0; n < 2; ++n) { /* it stays armed for the next take */
        fixture_must(live_record(d.live, &slate, &err), &err);
        fixture_pass(&d, 0.4);
        assert_true(fixture_until(&d, is_heard, NULL));
        fixture_must(live_record_end(d.live, &err), &err);
        assert_true(fixture_until(&d, is_edited, &edited));
        live_status_of(d.live, &status);
        assert_int_equal(edited, status.take);
        assert_true(status.is_sound_armed);
        fixture_take(&d, edited, &t);
        assert_true(t.audio.audio > 0);
        assert_true(t.audio.offset_ns < t.duration_ns);
        fixture_must(show_audio_info(d.show, t.audio.audio, &audio, &err), &err);
        int64_t length_ns = audio.frame_count * NS_PER_S / RATE_HZ;
        assert_true(t.audio.offset_ns + length_ns > t.duration_ns / 2);
        take_finish(&t);
    }
    live_disarm_sound(d.live);
    fixture_pass(&d, 0.1);
    live_status_of(d.live, &status);
    assert_false(status.is_sound_armed);
    fixture_finish(&d);
}

static void missing_microphone_stops_nothing(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    take t = {0};
    microphone m = {.is_there = false};
    const sound_backend backend = backend_of(&m);
    fixture_start_heard(&d, "puppet", NULL, FIXTURE_SHOW, &backend);
    fixture_must(live_arm_sound(d.live, 1, &err), &err);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.3);
    live_status_of(d.live, &status);
    assert_true(status.listening.device.text[0] != '\0');
    fixture_must(live_record_end(d.live, &err), &err);
    fixture_pass(&d, 0.1);
    fixture_take(&d, status.take, &t);
    assert_int_equal(t.audio.audio, 0);
    take_finish(&t);
    fixture_finish(&d);
}

static void sound_is_kept_when_the_stage_ends(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    take t = {0};
    microphone m = {.is_there = true};
    const sound_backend backend = backend_of(&m);
    fixture_start_heard(&d, "puppet", NULL, FIXTURE_SHOW, &backend);
    fixture_must(live_arm_sound(d.live, 1, &err), &err);
    fixture_must(live_record(d.live, &slate, &err), &err);
    assert_true(fixture_until(&d, is_heard, NULL));
    fixture_pass(&d, 0.3);
    live_status_of(d.live, &status);
    fixture_stop_live(&d);
    fixture_take(&d, status.take, &t);
    assert_true(t.audio.audio > 0);
    take_finish(&t);
    fixture_finish(&d);
}

static uint64_t clicks_of(live_fixture *d)
{
    live_status status;
    live_update(d->live);
    live_status_of(d->live, &status);
    return status.playing.click_count;
}

static bool has_loudspeaker(live_fixture *d, void *data)
{
    live_status status;
    (void)data;
    live_status_of(d->live, &status);
    return status.playing.device.state == SOUND_DEVICE_RUNNING;
}

/* Returns when it began, on the host's clock. */
static int64_t count_in_and_record(live_fixture *d, int64_t *out_start_ns)
{
    error err = {""};
    live_status status;
    take t = {0};
    const int64_t begin_ns = clock_now_ns() + 600 * NS_PER_MS;
    live_count_in(d->live, begin_ns);
    fixture_pass(d, 0.7); /* whoever asks for the recording is late */
    fixture_must(live_record(d->live, &slate, &err), &err);
    fixture_pass(d, 0.3);
    fixture_must(live_record_end(d->live, &err), &err);
    fixture_pass(d, 0.2);
    live_status_of(d->live, &status);
    fixture_take(d, status.take, &t);
    *out_start_ns = t.start_ns;
    take_finish(&t);
    return begin_ns;
}

static void a_counted_take_begins_on_its_beat_however_late_it_is_asked_for(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    microphone m = {.is_there = true, .is_loudspeaker = true};
    const sound_backend backend = backend_of(&m);
    live_click click = {.when = LIVE_CLICK_RECORDING, .bpm = 300.0, .bar = 3};
    int64_t start_ns[2], begin_ns[2];
    fixture_start_heard(&d, "puppet", NULL, FIXTURE_SHOW, &backend);
    fixture_must(live_set_click(d.live, &click, &err), &err);
    assert_true(fixture_until(&d, has_loudspeaker, NULL));
    fixture_pass(&d, 0.3);
    assert_int_equal(clicks_of(&d), 0); /* nothing is recorded */
    begin_ns[0] = count_in_and_record(&d, &start_ns[0]);
    assert_true(clicks_of(&d) >= 3);
    click.when = LIVE_CLICK_OFF;
    fixture_must(live_set_click(d.live, &click, &err), &err);
    const uint64_t before = clicks_of(&d);
    begin_ns[1] = count_in_and_record(&d, &start_ns[1]);
    assert_int_equal(clicks_of(&d), before);
    assert_true(start_ns[1] - start_ns[0] == begin_ns[1] - begin_ns[0]);
    click = (live_click){.when = LIVE_CLICK_ALWAYS, .bpm = 5000.0, .bar = 4};
    assert_true(live_set_click(d.live, &click, &err) < 0);
    assert_non_null(strstr(err.text, "5000"));
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_said_is_the_takes),
        cmocka_unit_test(missing_microphone_stops_nothing),
        cmocka_unit_test(sound_is_kept_when_the_stage_ends),
        cmocka_unit_test(a_counted_take_begins_on_its_beat_however_late_it_is_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
