/* Poses that are played on the palette of a live stage: how they move the face, and that a take
 * shows them as a layer of their own, bit for bit as they were seen. */
#include "window/live_seen.h"

static const writer_slate slate = {.scene = "1", .shot = "a"};

static void start(live_fixture *d, const char *mapping)
{
    error err = {""};
    fixture_start(d, "puppet", mapping, FIXTURE_SHOW);
    fixture_must(live_palette_open(d->live, &err), &err);
    assert_true(live_palette_count(d->live) > 60);
}

static uint32_t pose_of(const live_fixture *d, const char *name)
{
    uint32_t count;
    const mrt_rig_pose *pose = live_poses(d->live, &count);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(pose[i].name, name) == 0)
            return i;
    fail_msg("no pose %s", name);
    return 0;
}

static void play(live_fixture *d, const char *name, double strength, double fade_s)
{
    live_palette_set(d->live, pose_of(d, name), strength);
    live_palette_send(d->live, fade_s);
}

static double jaw_of(const live_fixture *d)
{
    return fixture_moved_mm(d, fixture_contact(d, "chin"));
}

static bool is_settled(live_fixture *d, void *data)
{
    const palette *p = &d->live->scene->performer->voice[0].layer->palette;
    const double *jaw_mm = data;
    fixture_frame(d);
    return palette_is_settled(p) && fabs(jaw_of(d) - *jaw_mm) < 1e-3;
}

static void wait_until_settled(live_fixture *d)
{
    fixture_perform(d, 0.0);
    double before_mm;
    do {
        before_mm = jaw_of(d);
        fixture_pass(d, 0.15);
    } while (!is_settled(d, &before_mm));
}

static void pose_fades_in_and_out(void **state)
{
    (void)state;
    live_fixture d;
    start(&d, NULL);
    play(&d, "jawOpen", 1.0, 0.4);
    double last_mm = 0.0, most_step_mm = 0.0;
    const int64_t until_ns = clock_now_ns() + NS_PER_S;
    while (clock_now_ns() < until_ns) {
        fixture_frame(&d);
        most_step_mm = fmax(most_step_mm, fabs(jaw_of(&d) - last_mm));
        last_mm = jaw_of(&d);
    }
    assert_true(last_mm > 5.0);
    if (most_step_mm > 0.25 * last_mm)
        fail_msg("the chin jumps by %.1f mm of %.1f mm", most_step_mm, last_mm);
    play(&d, "jawOpen", 0.5, 0.1);
    wait_until_settled(&d);
    assert_true(jaw_of(&d) > 0.35 * last_mm && jaw_of(&d) < 0.65 * last_mm);
    play(&d, "jawOpen", 0.0, 0.1);
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    fixture_finish(&d);
}

static void poses_add_up_and_all_at_once_stay_in_reach(void **state)
{
    (void)state;
    live_fixture d;
    live_status status;
    start(&d, NULL);
    play(&d, "jawOpen", 1.0, 0.0);
    wait_until_settled(&d);
    const double chin_mm = jaw_of(&d);
    const uint32_t brow = fixture_contact(&d, "brow.mid.l");
    const double still_mm = fixture_moved_mm(&d, brow);
    play(&d, "browInnerUp", 1.0, 0.0);
    wait_until_settled(&d);
    assert_true(fixture_moved_mm(&d, brow) > still_mm + 0.5);
    assert_true(fabs(jaw_of(&d) - chin_mm) < 0.5);
    for (uint32_t i = 0; i < live_palette_count(d.live); ++i)
        live_palette_set(d.live, i, 1.0);
    live_palette_send(d.live, 0.1);
    wait_until_settled(&d);
    live_status_of(d.live, &status);
    assert_int_equal(status.counts.bad_pulls, 0);
    const palette *p = &d.live->scene->performer->voice[0].layer->palette;
    for (uint32_t i = 0; i < p->count; ++i)
        assert_true(p->pose[i].strength <= 1.0);
    for (size_t i = 0; i < (size_t)d.view->vertex_count * 3; ++i)
        assert_true(isfinite(d.view->position[i]));
    for (uint32_t i = 0; i < live_palette_count(d.live); ++i)
        live_palette_set(d.live, i, 0.0);
    live_palette_send(d.live, 0.1);
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    fixture_finish(&d);
}

/* The hand performs from a recording, and poses are played over it. */
static void take_shows_hand_and_poses_as_they_were_seen(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char text[FIXTURE_PATH];
    seen_faces *s = calloc(1, sizeof *s);
    assert_non_null(s);
    start(&d, "one_hand");
    play(&d, "browInnerUp", 0.5, 0.2); /* held since before the take */
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,end=2", SOURCE_DIR);
    fixture_must(fixture_add_input(&d, text, &err), &err);
    seen_watch(&d, s, 0.3);
    fixture_must(live_record(d.live, &slate, &err), &err);
    seen_watch(&d, s, 0.3);
    play(&d, "jawOpen", 0.8, 0.15);
    seen_watch(&d, s, 0.3);
    play(&d, "mouthSmileLeft", 1.0, 0.3);
    seen_watch(&d, s, 0.2);
    play(&d, "jawOpen", 0.0, 0.2);
    seen_watch(&d, s, 1.4);
    play(&d, "mouthSmileLeft", 0.0, 0.2);
    seen_watch(&d, s, 0.4);
    const int64_t id = seen_record_end(&d);
    take t;
    fixture_take(&d, id, &t);
    assert_int_equal(t.layer_count, 2);
    assert_string_equal(t.layer[1].name, "palette");
    assert_int_equal(t.layer[0].clip[0].part, TAKE_WITHOUT_PALETTE);
    assert_int_equal(t.layer[1].clip[0].part, TAKE_PALETTE);
    assert_true(t.layer[1].is_additive);
    take_finish(&t);
    const uint32_t compared = seen_compare(&d, id, s);
    if (compared < 10)
        fail_msg("only %u faces were compared", compared);
    free(s);
    fixture_finish(&d);
}

static void held_pose_without_samples_is_in_the_take(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    seen_faces *s = calloc(1, sizeof *s);
    assert_non_null(s);
    start(&d, NULL);
    play(&d, "jawOpen", 1.0, 0.1);
    wait_until_settled(&d);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.5);
    const double held_mm = jaw_of(&d);
    const int64_t id = seen_record_end(&d);
    take t;
    fixture_take(&d, id, &t);
    sequencer *plays;
    const sequencer_settings settings = {
        .show = d.show, .plugins = &d.plugins, .log = d.log, .face = &d.face};
    fixture_must(sequencer_create(&plays, &settings, &t, &err), &err);
    fixture_must(sequencer_seek(plays, t.duration_ns / 2, &err), &err);
    composer *shown = sequencer_performer(plays)->composer;
    composer_draw(shown);
    const vec3 now = face_contact_now(composer_face(shown), fixture_contact(&d, "chin") + 1);
    const double taken_mm =
        vec3_length(vec3_sub(now, fixture_rest(&d, fixture_contact(&d, "chin"))));
    if (fabs(taken_mm - held_mm) > 0.01)
        fail_msg("the chin is %.2f mm low in the take, and was %.2f mm", taken_mm, held_mm);
    sequencer_destroy(plays);
    take_finish(&t);
    free(s);
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pose_fades_in_and_out),
        cmocka_unit_test(poses_add_up_and_all_at_once_stay_in_reach),
        cmocka_unit_test(take_shows_hand_and_poses_as_they_were_seen),
        cmocka_unit_test(held_pose_without_samples_is_in_the_take),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
