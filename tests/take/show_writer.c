/* core/show/writer.h: what goes in while it happens is what the show gives back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "take/show_scene.h"
#include "show/writer_store.h"

#include <pthread.h>

static void samples_come_back_bit_for_bit(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    scene_record(&r, s, &options);
    scene_give(&r, 0, 3000);
    scene_flush(&r);
    scene_expect(s, r.track, 0, 3000);
    writer_status status = writer_status_of(r.writer);
    assert_int_equal(status.state, WRITER_OK);
    assert_int_equal(status.committed_count, 3000);
    assert_int_equal(status.backlog, 0);
    assert_int_equal(status.lost_count, 0);
    assert_int_equal(status.committed_ns, scene_sample(r.track, 2999).time_ns);
    scene_stop(&r);
    show_close(s);
    s = scene_open(*state, SHOW_READ);
    assert_string_equal(show_notice(s), "");
    scene_expect(s, r.track, 0, 3000);
    show_close(s);
}

/* Chunks that are committed half full grow; a reader that has seen half of one goes on in it. */
static void a_reader_follows_what_is_recorded(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    scene_record(&r, s, &options);
    show_reader *reader;
    error err = {""};
    mrt_sample got;
    scene_flush(&r);
    scene_must(show_reader_open(&reader, s, r.track, INT64_MIN, INT64_MAX, &err), &err);
    int64_t given = 0, read = 0;
    for (int step = 1; step < 40; ++step) {
        scene_give(&r, given, given + step);
        given += step;
        scene_flush(&r);
        mrt_result result;
        while ((result = show_reader_next(reader, &got, &err)) == MRT_OK) {
            mrt_sample expected = scene_shown(r.track, read++);
            assert_true(scene_is_same(&got, &expected));
        }
        assert_int_equal(result, MRT_END);
        assert_int_equal(read, given);
    }
    show_reader_close(reader);
    scene_stop(&r);
    scene_expect(s, r.track, 0, given);
    show_close(s);
}

static void tracks_and_performances_come_back(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    scene_record(&r, s, &options);
    scene_give(&r, 0, 10);
    scene_stop(&r);
    show_track track;
    scene_must(show_track_read(s, r.track, &track, &err), &err);
    take_track expected = scene_track("test:");
    assert_string_equal(track.track.input, "test:");
    assert_string_equal(track.track.device, expected.device);
    assert_string_equal(track.track.plugin, expected.plugin);
    assert_null(track.track.calibration[0]);
    assert_string_equal(track.track.calibration[1], expected.calibration[1]);
    assert_int_equal(track.track.channel_count, SCENE_CHANNELS);
    assert_memory_equal(track.track.channel, expected.channel,
                        SCENE_CHANNELS * sizeof expected.channel[0]);
    assert_int_equal(track.from_ns, scene_shown(r.track, 0).time_ns);
    assert_int_equal(track.to_ns, scene_shown(r.track, 9).time_ns);
    show_track_finish(&track);

    show_performance performance;
    scene_must(show_performance_read(s, r.performance, &performance, &err), &err);
    take_performance made = scene_performance(r.track);
    assert_string_equal(performance.performance.mapping, made.mapping);
    assert_string_equal(performance.performance.rig, made.rig);
    assert_string_equal(performance.performance.rig_hash, "11");
    assert_string_equal(performance.performance.mesh_hash, "22");
    assert_null(performance.performance.rig_json);
    assert_true(performance.performance.unit_mm == 1.5);
    assert_true(performance.performance.hand_length_mm == 190);
    assert_int_equal(performance.performance.rezero_pedal, 2);
    assert_int_equal(performance.performance.track_count, 1);
    assert_int_equal(performance.performance.track[0], r.track);
    assert_int_equal(performance.performance.param_count, 2);
    assert_int_equal(performance.performance.param[1].id, 9);
    assert_true(performance.performance.param[1].value == -1e300);
    assert_int_equal(performance.from_ns, scene_utc_ns);
    assert_int_equal(performance.to_ns, scene_shown(r.track, 9).time_ns);
    show_performance_finish(&performance);
    assert_int_equal(show_track_read(s, 77, &track, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "77"));
    assert_int_equal(show_performance_read(s, 77, &performance, &err), MRT_ERR_ARGUMENT);
    show_close(s);
}

static void a_take_exists_from_its_first_instant(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    int64_t id;
    show_take got;
    scene_record(&r, s, &options);
    scene_give(&r, 0, 100);
    int64_t start_ns = scene_sample(r.track, 99).time_ns;
    scene_must(writer_take_begin(r.writer, start_ns, &(writer_slate){.scene = "7", .shot = "B"},
                                 &id, &err),
               &err);
    scene_flush(&r);
    scene_must(show_take_read(s, id, &got, &err), &err);
    assert_true(got.is_recording && !got.is_recovered);
    assert_int_equal(got.start_ns, scene_utc_ns + start_ns);
    scene_give(&r, 100, 200);
    scene_flush(&r);
    scene_must(show_take_read(s, id, &got, &err), &err);
    assert_int_equal(got.end_ns, scene_shown(r.track, 199).time_ns);
    scene_must(writer_take_end(r.writer, id, start_ns + NS_PER_S, &err), &err);
    scene_flush(&r);
    scene_must(show_take_read(s, id, &got, &err), &err);
    assert_false(got.is_recording);
    assert_int_equal(got.end_ns, scene_utc_ns + start_ns + NS_PER_S);
    assert_string_equal(got.scene, "7");
    assert_string_equal(got.shot, "B");
    assert_int_equal(got.number, 1);
    assert_string_equal(got.origin, "recorded");

    take base;
    scene_must(show_take_base(s, id, &base, &err), &err);
    assert_int_equal(base.duration_ns, NS_PER_S);
    assert_int_equal(base.layer_count, 1);
    assert_int_equal(base.layer[0].clip_count, 1);
    const take_clip *clip = &base.layer[0].clip[0];
    assert_int_equal(clip->performance, r.performance);
    assert_int_equal(clip->from_ns, got.start_ns);
    assert_int_equal(clip->to_ns, got.end_ns);
    assert_int_equal(clip->start_ns, 0);
    assert_int_equal(clip->end_ns, NS_PER_S);
    assert_int_equal(take_warp_to_source(clip, 5), 5);
    take_finish(&base);
    scene_stop(&r);
    show_close(s);
}

static void slates_count_up_by_scene_and_shot(void **state)
{
    static const struct slating {
        const char *scene, *shot;
        uint32_t number, expected;
    } slatings[] = {{"1", "A", 0, 1}, {"1", "A", 0, 2}, {"1", "B", 0, 1},   {"1", "A", 7, 7},
                    {"1", "A", 0, 8}, {"2", "A", 0, 1}, {NULL, NULL, 0, 1}, {"", "", 0, 2}};
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    int64_t id;
    scene_record(&r, s, &options);
    for (size_t i = 0; i < sizeof slatings / sizeof slatings[0]; ++i) {
        writer_slate slate = {
            .scene = slatings[i].scene, .shot = slatings[i].shot, .number = slatings[i].number};
        scene_must(writer_take_begin(r.writer, 0, &slate, &id, &err), &err);
        scene_must(writer_take_end(r.writer, id, 10, &err), &err);
    }
    scene_stop(&r);
    show_take *takes;
    size_t count;
    scene_must(show_takes(s, &takes, &count, &err), &err);
    assert_int_equal(count, sizeof slatings / sizeof slatings[0]);
    for (size_t i = 0; i < count; ++i)
        assert_int_equal(takes[i].number, slatings[i].expected);
    free(takes);
    show_close(s);
}

static void keeping_makes_a_take_of_what_nobody_recorded(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    int64_t id;
    scene_record(&r, s, &options);
    scene_give(&r, 0, 3000);
    int64_t to_ns = scene_sample(r.track, 2999).time_ns, from_ns = to_ns - 10 * NS_PER_S;
    scene_must(writer_keep(r.writer, from_ns, to_ns, &(writer_slate){0}, &id, &err), &err);
    scene_stop(&r);
    show_take got;
    show_span *spans;
    size_t count;
    scene_must(show_take_read(s, id, &got, &err), &err);
    assert_int_equal(got.start_ns, scene_utc_ns + from_ns);
    assert_int_equal(got.end_ns, scene_utc_ns + to_ns);
    assert_string_equal(got.origin, "kept from the journal");
    scene_must(show_take_spans(s, id, &spans, &count, &err), &err);
    assert_int_equal(count, 1);
    assert_int_equal(spans[0].performance, r.performance);
    assert_int_equal(spans[0].from_ns, got.start_ns);
    free(spans);
    assert_int_equal(writer_keep(r.writer, 5, 5, &(writer_slate){0}, &id, &err), MRT_ERR_ARGUMENT);
    show_close(s);
}

/* Another mapping begins while a take is recorded: the take shows both, one after the other. */
static void a_take_goes_on_in_the_next_performance(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    int64_t id;
    scene_record(&r, s, &options);
    scene_must(writer_take_begin(r.writer, 100, &(writer_slate){0}, &id, &err), &err);
    take_performance next = scene_performance(r.track);
    scene_must(writer_begin_performance(r.writer, &next, 1000, &err), &err);
    scene_must(writer_take_end(r.writer, id, 3000, &err), &err);
    scene_stop(&r);
    take base;
    scene_must(show_take_base(s, id, &base, &err), &err);
    const take_layer *layer = &base.layer[0];
    assert_int_equal(layer->clip_count, 2);
    assert_int_equal(layer->clip[0].end_ns, 900);
    assert_int_equal(layer->clip[0].performance, r.performance);
    assert_int_equal(layer->clip[1].start_ns, 900);
    assert_int_equal(layer->clip[1].end_ns, 2900);
    assert_int_equal(layer->clip[1].performance, next.id);
    assert_int_equal(base.id_count, 3);
    take_finish(&base);
    show_close(s);
}

static void events_and_checkpoints_come_back(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    scene_record(&r, s, &options);
    take_event event = {.time_ns = 50, .kind = TAKE_EVENT_PARAM, .param = 3, .value = 0.125};
    writer_event(r.writer, &event);
    event = (take_event){.time_ns = 60, .kind = TAKE_EVENT_REZERO, .hand = MRT_RIGHT};
    writer_event(r.writer, &event);
    scene_must(writer_mark(r.writer, 55, "good one", &err), &err);
    for (uint8_t i = 1; i <= 3; ++i) {
        uint8_t *buffer = writer_checkpoint_buffer(r.writer);
        assert_non_null(buffer);
        memset(buffer, i, 5000);
        writer_checkpoint(r.writer, r.performance, i * 1000, i, buffer, 5000);
    }
    scene_stop(&r);
    take_event *events;
    size_t count;
    scene_must(show_events(s, scene_utc_ns, scene_utc_ns + 59, &events, &count, &err), &err);
    assert_int_equal(count, 2);
    assert_int_equal(events[0].kind, TAKE_EVENT_PARAM);
    assert_true(events[0].value == 0.125);
    assert_int_equal(events[1].kind, TAKE_EVENT_MARK);
    assert_string_equal(events[1].text, "good one");
    free(events);
    show_checkpoint got;
    scene_must(show_checkpoint_before(s, r.performance, scene_utc_ns + 2999, 0, &got, &err), &err);
    assert_int_equal(got.time_ns, scene_utc_ns + 2000);
    assert_int_equal(got.version, 2);
    assert_int_equal(got.size, 5000);
    for (size_t i = 0; i < got.size; ++i)
        assert_int_equal(((uint8_t *)got.bytes)[i], 2);
    show_checkpoint_finish(&got);
    scene_must(show_checkpoint_before(s, r.performance, scene_utc_ns + 999, 0, &got, &err), &err);
    assert_null(got.bytes);
    show_close(s);
}

enum { SPEAKERS = 4, SAID = 100 };

typedef struct speaker {
    pthread_t thread;
    writer *to;
    int number;
} speaker;

static void *speak(void *data)
{
    const speaker *self = data;
    error err = {""};
    for (int i = 0; i < SAID; ++i) {
        char text[32];
        snprintf(text, sizeof text, "%d %d", self->number, i);
        if (writer_mark(self->to, 77, text, &err) < 0)
            return "not taken";
    }
    return NULL;
}

static void what_threads_say_at_once_keeps_the_order_of_each(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    speaker of[SPEAKERS];
    scene_record(&r, s, &options);
    for (int n = 0; n < SPEAKERS; ++n) {
        of[n] = (speaker){.to = r.writer, .number = n};
        assert_int_equal(pthread_create(&of[n].thread, NULL, speak, &of[n]), 0);
    }
    for (int n = 0; n < SPEAKERS; ++n) {
        void *failed;
        assert_int_equal(pthread_join(of[n].thread, &failed), 0);
        assert_null(failed);
    }
    scene_stop(&r);
    take_event *events;
    size_t count;
    int said[SPEAKERS] = {0};
    scene_must(show_events(s, scene_utc_ns, scene_utc_ns + 100, &events, &count, &err), &err);
    assert_int_equal(count, SPEAKERS * SAID);
    for (size_t i = 0; i < count; ++i) {
        char *end;
        const long number = strtol(events[i].text, &end, 10), at = strtol(end, NULL, 10);
        assert_in_range(number, 0, SPEAKERS - 1);
        assert_int_equal(at, said[number]++);
    }
    free(events);
    show_close(s);
}

/* It says so, and what was taken is there; the next look of the writer's makes room. */
static void more_at_once_than_can_wait_is_refused(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    size_t taken = 0;
    scene_record(&r, s, &options);
    scene_flush(&r);
    for (int i = 0; i < 4 * WRITER_WAITING_MAX; ++i)
        taken += writer_mark(r.writer, 5, "a mark", &err) >= 0;
    assert_in_range(taken, WRITER_WAITING_MAX / 2, 4 * WRITER_WAITING_MAX);
    if (taken < 4 * WRITER_WAITING_MAX)
        assert_non_null(strstr(err.text, "cannot keep up"));
    scene_flush(&r);
    scene_must(writer_mark(r.writer, 5, "the last", &err), &err);
    scene_stop(&r);
    take_event *events;
    size_t count;
    scene_must(show_events(s, scene_utc_ns, scene_utc_ns + 100, &events, &count, &err), &err);
    assert_int_equal(count, taken + 1);
    assert_string_equal(events[taken].text, "the last");
    free(events);
    show_close(s);
}

static void checkpoint_buffers_run_out_and_come_back(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    scene_record(&r, s, &options);
    void *buffer[WRITER_CHECKPOINTS];
    for (int i = 0; i < WRITER_CHECKPOINTS; ++i)
        assert_non_null(buffer[i] = writer_checkpoint_buffer(r.writer));
    assert_null(writer_checkpoint_buffer(r.writer));
    writer_checkpoint(r.writer, r.performance, 0, 1, buffer[0], options.checkpoint_bytes + 1);
    assert_ptr_equal(writer_checkpoint_buffer(r.writer), buffer[0]);
    writer_checkpoint(r.writer, r.performance, 0, 1, buffer[2], 10);
    scene_flush(&r);
    assert_ptr_equal(writer_checkpoint_buffer(r.writer), buffer[2]);
    scene_stop(&r);
    show_close(s);
}

static void what_is_no_sample_of_a_track_is_counted_as_lost(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    scene_record(&r, s, &options);
    scene_give(&r, 0, 10);
    mrt_sample early = scene_sample(r.track, 3), narrow = scene_sample(r.track, 11);
    mrt_sample infinite = narrow;
    mrt_sample never = narrow;
    never.time_ns = INT64_MAX;
    narrow.count = 21;
    infinite.value[2] = 1.0f / 0.0f;
    writer_sample(r.writer, r.track, &early);
    writer_sample(r.writer, r.track, &narrow);
    writer_sample(r.writer, r.track, &infinite);
    writer_sample(r.writer, r.track, &never);
    writer_sample(r.writer, 99, &early);
    writer_event(r.writer, &(take_event){.time_ns = INT64_MIN, .kind = TAKE_EVENT_MARK});
    scene_give(&r, 10, 20);
    scene_flush(&r);
    assert_int_equal(writer_status_of(r.writer).lost_count, 5);
    assert_int_equal(writer_status_of(r.writer).backlog, 0);
    char message[300];
    writer_message(r.writer, message, sizeof message);
    assert_non_null(strstr(message, "5 samples were lost"));
    scene_expect(s, r.track, 0, 20);
    take_event *events;
    size_t count;
    error err = {""};
    scene_must(show_events(s, INT64_MIN, INT64_MAX, &events, &count, &err), &err);
    double told = 0;
    for (size_t i = 0; i < count; ++i)
        if (events[i].kind == TAKE_EVENT_LOST && events[i].track == r.track)
            told += events[i].value;
    assert_true(told == 4);
    free(events);
    scene_stop(&r);
    show_close(s);
}

/* Nonsense that was asked for is refused and said; what comes after it is written. */
static void a_request_that_cannot_be_done_keeps_nobody(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    scene_record(&r, s, &options);
    scene_flush(&r);
    scene_must(writer_audio(r.writer, 12345, 0, "1234", 4, &err), &err);
    scene_give(&r, 0, 10);
    assert_int_equal(writer_flush(r.writer, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "12345"));
    assert_int_equal(writer_status_of(r.writer).state, WRITER_OK);
    scene_flush(&r);
    scene_expect(s, r.track, 0, 10);
    scene_stop(&r);
    show_close(s);
}

static void tracks_end_and_others_begin(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    scene_record(&r, s, &options);
    for (int i = 0; i < 3 * WRITER_TRACKS_MAX; ++i) {
        take_track track = scene_track("next:");
        scene_must(writer_add_track(r.writer, &track, &err), &err);
        mrt_sample sample = scene_sample(track.id, i);
        writer_sample(r.writer, track.id, &sample);
        scene_must(writer_end_track(r.writer, track.id, &err), &err);
    }
    scene_stop(&r);
    int64_t *ids;
    size_t count;
    scene_must(show_track_ids(s, &ids, &count, &err), &err);
    assert_int_equal(count, 1 + 3 * WRITER_TRACKS_MAX);
    for (size_t i = 1; i < count; ++i)
        scene_expect(s, ids[i], (int64_t)i - 1, (int64_t)i);
    free(ids);
    show_close(s);
}

static void reading_seeks_and_stays_within_its_span(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    mrt_sample got;
    show_reader *reader;
    scene_record(&r, s, &options);
    scene_give(&r, 0, 2000);
    scene_stop(&r);
    int64_t from_ns = scene_shown(r.track, 500).time_ns, to_ns = scene_shown(r.track, 1500).time_ns;
    scene_must(show_reader_open(&reader, s, r.track, from_ns, to_ns, &err), &err);
    for (int64_t n = 500; n <= 1500; ++n) {
        mrt_sample expected = scene_shown(r.track, n);
        assert_int_equal(show_reader_next(reader, &got, &err), MRT_OK);
        assert_true(scene_is_same(&got, &expected));
    }
    assert_int_equal(show_reader_next(reader, &got, &err), MRT_END);
    for (int64_t i = 0; i < 300; ++i) {
        int64_t n = 500 + (int64_t)(scene_random((uint64_t)i) % 1001);
        mrt_sample expected = scene_shown(r.track, n);
        scene_must(show_reader_seek(reader, expected.time_ns, &err), &err);
        assert_int_equal(show_reader_next(reader, &got, &err), MRT_OK);
        assert_true(scene_is_same(&got, &expected));
    }
    /* a performance that is taken up behind its last sample is over, not wrong */
    scene_must(show_reader_seek(reader, to_ns + 1, &err), &err);
    assert_int_equal(show_reader_next(reader, &got, &err), MRT_END);
    assert_int_equal(show_reader_seek(reader, from_ns - 1, &err), MRT_ERR_ARGUMENT);
    show_reader_close(reader);
    assert_int_equal(show_reader_open(&reader, s, 44, 0, 1, &err), MRT_ERR_ARGUMENT);
    show_close(s);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scene_set_up, scene_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(samples_come_back_bit_for_bit),
        TEST(a_reader_follows_what_is_recorded),
        TEST(tracks_and_performances_come_back),
        TEST(a_take_exists_from_its_first_instant),
        TEST(slates_count_up_by_scene_and_shot),
        TEST(keeping_makes_a_take_of_what_nobody_recorded),
        TEST(a_take_goes_on_in_the_next_performance),
        TEST(events_and_checkpoints_come_back),
        TEST(what_threads_say_at_once_keeps_the_order_of_each),
        TEST(more_at_once_than_can_wait_is_refused),
        TEST(checkpoint_buffers_run_out_and_come_back),
        TEST(what_is_no_sample_of_a_track_is_counted_as_lost),
        TEST(a_request_that_cannot_be_done_keeps_nobody),
        TEST(tracks_end_and_others_begin),
        TEST(reading_seeks_and_stays_within_its_span),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
