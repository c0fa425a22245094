/* What a live stage records: everything, whatever the window does; and that it plays as it was
 * seen. */
#include "window/live_seen.h"

static const writer_slate slate = {.scene = "1", .shot = "a"};

static void demo_input(char *out, size_t capacity, const char *more)
{
    snprintf(out, capacity, "log:%s/plugins/log/demo_hand.csv%s", SOURCE_DIR, more);
}

static void release(live_fixture *d)
{
    const vec3 nowhere = {0, 0, 0};
    fixture_point(d, POINTER_AWAY, nowhere, nowhere, false);
}

/* Clay is slow: nothing waits for it. */
static void knead(live_fixture *d, seen_faces *s, uint32_t contact, vec3 way)
{
    vec3 rest = fixture_rest(d, contact), from = d->view->contact[contact];
    for (int i = 0; i <= 10; ++i) {
        fixture_point(d, POINTER_KNEADS, rest, vec3_add(from, vec3_scale(way, 0.1 * (double)i)),
                      false);
        fixture_frame(d);
        seen_remember(d, s);
    }
}

static void slow_window_loses_no_sample(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status before, after;
    uint32_t count;
    feed *hand;
    input *in;
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    static const mrt_channel channel[] = {
        {"index", "rad", MRT_CH_ANGLE + 4, MRT_RIGHT, -1.0f, 3.0f}};
    const feed_settings settings = {.id = "org.marotte.test.hand",
                                    .name = "hand",
                                    .channels = channel,
                                    .channel_count = 1,
                                    .rate_hz = 150.0};
    const float bent[1] = {0.5f};
    fixture_must(feed_create(&hand, &settings, &err), &err);
    fixture_must(input_create(&in, feed_type(hand), "", "", CLOCK_REAL, d.log, &err), &err);
    fixture_must(live_add_input(d.live, in, "hand", &err), &err);
    live_status_of(d.live, &before);
    feed_push(hand, bent, FEED_MOVES);
    int64_t until_ns = clock_now_ns() + 2 * NS_PER_S;
    while (clock_now_ns() < until_ns) { /* 5 frames a second */
        live_update(d.live);
        (void)live_read_view(d.live, &d.view);
        clock_sleep_until_ns(clock_now_ns() + NS_PER_S / 5);
    }
    feed_push(hand, bent, FEED_RESTS);
    fixture_pass(&d, 0.2);
    live_status_of(d.live, &after);
    health_report health;
    input_health(live_input(d.live, 0), &health);
    assert_int_equal(health.dropped_count, 0);
    assert_true(health.sample_count > 100);
    count = (uint32_t)(after.sample_count - before.sample_count);
    if (count < health.sample_count - 2)
        fail_msg("%u of %u samples were performed", count, (uint32_t)health.sample_count);
    fixture_stop_live(&d);
    feed_destroy(hand);
    /* and recorded */
    int64_t *tracks;
    size_t track_count;
    uint64_t recorded = 0;
    fixture_must(show_track_ids(d.show, &tracks, &track_count, &err), &err);
    for (size_t i = 0; i < track_count; ++i) {
        show_track track;
        show_reader *reader;
        mrt_sample sample;
        fixture_must(show_track_read(d.show, tracks[i], &track, &err), &err);
        if (strcmp(track.track.input, "hand") == 0) {
            fixture_must(show_reader_open(&reader, d.show, tracks[i], INT64_MIN, INT64_MAX, &err),
                         &err);
            while (show_reader_next(reader, &sample, &err) == MRT_OK)
                recorded += 1;
            show_reader_close(reader);
        }
        show_track_finish(&track);
    }
    free(tracks);
    assert_int_equal(recorded, health.sample_count);
    fixture_finish(&d);
}

static void recorded_hand_plays_as_it_was_seen(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char text[FIXTURE_PATH];
    seen_faces *s = calloc(1, sizeof *s);
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    demo_input(text, sizeof text, ",start=2,end=4");
    fixture_must(fixture_add_input(&d, text, &err), &err);
    fixture_pass(&d, 0.2); /* it does not begin at rest */
    fixture_must(live_record(d.live, &slate, &err), &err);
    seen_watch(&d, s, 2.2); /* to the end of the record, and a little more */
    int64_t id = seen_record_end(&d);
    uint32_t compared = seen_compare(&d, id, s);
    if (compared < 5)
        fail_msg("only %u faces were compared", compared);
    free(s);
    fixture_finish(&d);
}

static void recorded_drags_play_as_they_were_seen(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    seen_faces *s = calloc(1, sizeof *s);
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    uint32_t left = fixture_contact(&d, "mouth.corner.l"),
             right = fixture_contact(&d, "mouth.corner.r");
    const vec3 up = {0.0, 6.0, 2.0}, out = {-5.0, 0.0, 3.0};
    fixture_drag(&d, POINTER_PULLS, right, out,
                 true); /* before the take: it does not begin at rest */
    fixture_let_go(&d);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_drag(&d, POINTER_PULLS, left, up, false);
    seen_watch(&d, s, 0.1);
    release(&d);
    seen_watch(&d, s, 0.4);
    knead(&d, s, left, up);
    release(&d);
    seen_watch(&d, s, 0.1);
    fixture_drag(&d, POINTER_PULLS, right, up, true);
    seen_watch(&d, s, 0.1);
    release(&d);
    seen_watch(&d, s, 0.2);
    live_neutral(d.live);
    seen_watch(&d, s, 0.5);
    int64_t id = seen_record_end(&d);
    uint32_t compared = seen_compare(&d, id, s);
    if (compared < 5)
        fail_msg("only %u faces were compared", compared);
    free(s);
    fixture_finish(&d);
}

/* Two samples of the same instant lie a nanosecond apart. */
static void lasts(const take *t, int64_t least_ns)
{
    if (t->duration_ns < least_ns - 1)
        fail_msg("%.9f s of %.9f s", (double)t->duration_ns / 1e9, (double)least_ns / 1e9);
}

static void still_face_has_a_take_of_its_length(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    fixture_must(live_record(d.live, &slate, &err), &err);
    int64_t begun_ns = clock_now_ns();
    fixture_pass(&d, 0.5);
    int64_t least_ns = clock_now_ns() - begun_ns;
    int64_t id = seen_record_end(&d);
    fixture_pass(&d, 0.1);
    fixture_take(&d, id, &t);
    lasts(&t, least_ns);
    take_finish(&t);
    fixture_finish(&d);
}

static void last_seconds_are_kept(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    int64_t id;
    take t = {0};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    uint32_t left = fixture_contact(&d, "mouth.corner.l");
    fixture_drag(&d, POINTER_PULLS, left, (vec3){0, 5, 0}, false);
    fixture_let_go(&d);
    fixture_pass(&d, 0.3);
    fixture_must(
        live_keep(d.live, clock_now_ns() - 30 * NS_PER_S, clock_now_ns(), &slate, &id, &err), &err);
    assert_true(id > 0);
    fixture_pass(&d, 0.2);
    fixture_take(&d, id, &t);
    assert_int_equal(t.layer_count, 1);
    assert_true(t.duration_ns > NS_PER_S / 2);
    take_finish(&t);
    fixture_finish(&d);
}

static void take_is_kept_when_the_stage_ends(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    take t = {0};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.3);
    live_status_of(d.live, &status);
    assert_true(status.is_recording);
    fixture_stop_live(&d);
    fixture_take(&d, status.take, &t);
    assert_false(t.is_recording);
    lasts(&t, 3 * NS_PER_S / 10);
    take_finish(&t);
    fixture_finish(&d);
}

static void without_a_show_it_says_why_nothing_is_recorded(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    fixture_start(&d, "puppet", NULL, FIXTURE_NO_SHOW);
    live_status_of(d.live, &status);
    assert_false(status.can_record);
    assert_true(strstr(status.why_not, "create a show") != NULL);
    assert_true(live_record(d.live, &slate, &err) < 0);
    assert_true(strstr(err.text, "create a show") != NULL);
    fixture_must(show_create(&d.show, d.show_path, &err), &err);
    fixture_must(live_set_show(d.live, d.show, &err), &err);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.1);
    assert_true(seen_record_end(&d) > 0);
    fixture_finish(&d);
}

static void changes_are_refused_while_a_take_is_recorded(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char text[FIXTURE_PATH];
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    demo_input(text, sizeof text, "");
    fixture_must(live_record(d.live, &slate, &err), &err);
    assert_true(fixture_add_input(&d, text, &err) < 0);
    assert_true(strstr(err.text, "not possible while a take is recorded") != NULL);
    assert_true(live_set_mapping(d.live, "anchored", &err) < 0);
    assert_true(live_set_face(d.live, &d.face, d.face_path, 0.0, &err) < 0);
    assert_true(live_calibrate(d.live, MRT_LEFT, NULL, &err) < 0);
    assert_true(live_record(d.live, &slate, &err) < 0);
    (void)seen_record_end(&d);
    fixture_must(fixture_add_input(&d, text, &err), &err);
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slow_window_loses_no_sample),
        cmocka_unit_test(recorded_hand_plays_as_it_was_seen),
        cmocka_unit_test(recorded_drags_play_as_they_were_seen),
        cmocka_unit_test(still_face_has_a_take_of_its_length),
        cmocka_unit_test(last_seconds_are_kept),
        cmocka_unit_test(take_is_kept_when_the_stage_ends),
        cmocka_unit_test(without_a_show_it_says_why_nothing_is_recorded),
        cmocka_unit_test(changes_are_refused_while_a_take_is_recorded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
