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

/* The hand performs from a recording, and poses are played over it. before_s: the time until the
 * take begins, in which states may be stored. */
static void play_a_take(double before_s)
{
    live_fixture d;
    error err = {""};
    char text[FIXTURE_PATH];
    seen_faces *s = calloc(1, sizeof *s);
    assert_non_null(s);
    start(&d, "one_hand");
    play(&d, "browInnerUp", 0.5, 0.2); /* held since before the take */
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(&d, text, &err), &err);
    fixture_pass(&d, before_s);
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
    assert_int_equal(t.layer[0].clip[0].part, TAKE_HANDS);
    assert_int_equal(t.layer[1].clip[0].part, TAKE_PALETTE);
    assert_true(t.layer[1].is_additive);
    take_finish(&t);
    const uint32_t compared = seen_compare(&d, id, s);
    if (compared < 10)
        fail_msg("only %u faces were compared", compared);
    free(s);
    fixture_finish(&d);
}

static void take_shows_hand_and_poses_as_they_were_seen(void **state)
{
    (void)state;
    play_a_take(0.3);
}

/* Its replay begins with a state of the recording, in which a pose is held. */
static void take_from_a_stored_state_shows_them_too(void **state)
{
    (void)state;
    play_a_take(6.5);
}

/* Plays the take to an instant, and returns how far the chin is from its rest. */
static double chin_in_take(live_fixture *d, const take *t, int64_t at_ns, char *note,
                           size_t capacity)
{
    error err = {""};
    sequencer *plays;
    const sequencer_settings settings = {
        .show = d->show, .plugins = &d->plugins, .log = d->log, .face = &d->face};
    fixture_must(sequencer_create(&plays, &settings, t, &err), &err);
    fixture_must(sequencer_seek(plays, at_ns, &err), &err);
    composer *shown = sequencer_performer(plays)->composer;
    composer_draw(shown);
    const mrt_face *about = composer_about(shown);
    uint32_t chin = 0;
    while (strcmp(about->contacts[chin].name, "chin") != 0)
        chin += 1;
    const vec3 now = face_contact_now(composer_face(shown), chin + 1);
    const mrt_vec3 rest = about->contacts[chin].rest;
    snprintf(note, capacity, "%s", sequencer_note(plays));
    sequencer_destroy(plays);
    return vec3_length(vec3_sub(now, (vec3){(double)rest.x, (double)rest.y, (double)rest.z}));
}

static void held_pose_without_samples_is_in_the_take(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char note[512];
    start(&d, NULL);
    play(&d, "jawOpen", 1.0, 0.1);
    wait_until_settled(&d);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.5);
    const double held_mm = jaw_of(&d);
    const int64_t id = seen_record_end(&d);
    take t;
    fixture_take(&d, id, &t);
    const double taken_mm = chin_in_take(&d, &t, t.duration_ns / 2, note, sizeof note);
    if (fabs(taken_mm - held_mm) > 0.01)
        fail_msg("the chin is %.2f mm low in the take, and was %.2f mm", taken_mm, held_mm);
    assert_string_equal(note, "");
    take_finish(&t);
    fixture_finish(&d);
}

/* Records a pose that is held for a second. */
static int64_t record_a_pose(live_fixture *d, take *out)
{
    error err = {""};
    start(d, NULL);
    fixture_must(live_record(d->live, &slate, &err), &err);
    play(d, "jawOpen", 1.0, 0.1);
    fixture_pass(d, 1.0);
    const int64_t id = seen_record_end(d);
    fixture_take(d, id, out);
    assert_int_equal(out->layer_count, 2);
    return id;
}

/* Rows of the face of a take at an instant. The caller frees them. */
static float *rows_of(live_fixture *d, const take *t, int64_t at_ns)
{
    error err = {""};
    sequencer *plays;
    const sequencer_settings settings = {
        .show = d->show, .plugins = &d->plugins, .log = d->log, .face = &d->face};
    fixture_must(sequencer_create(&plays, &settings, t, &err), &err);
    fixture_must(sequencer_seek(plays, at_ns, &err), &err);
    composer *shown = sequencer_performer(plays)->composer;
    composer_draw(shown);
    float *rows = malloc((size_t)d->view->vertex_count * 3 * sizeof *rows);
    assert_non_null(rows);
    points_to_rows(rows, face_shown(composer_face(shown)), face_order(composer_face(shown)));
    sequencer_destroy(plays);
    return rows;
}

/* So nothing jumps when a pose begins over a hand: at a hundredth it moves the face by about a
 * hundredth of its 12 mm. */
static void faint_pose_hardly_moves_the_face(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char text[FIXTURE_PATH];
    take t;
    start(&d, "one_hand");
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(&d, text, &err), &err);
    fixture_pass(&d, 5.0);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.3);
    play(&d, "browInnerUp", 0.01, 0.05);
    fixture_pass(&d, 1.2);
    fixture_take(&d, seen_record_end(&d), &t);
    double most_mm = 0.0;
    for (int64_t at_ns = NS_PER_S / 2; at_ns < 14 * NS_PER_S / 10; at_ns += 150 * NS_PER_MS) {
        t.layer[1].is_muted = false;
        float *with = rows_of(&d, &t, at_ns);
        t.layer[1].is_muted = true;
        float *without = rows_of(&d, &t, at_ns);
        for (size_t i = 0; i < (size_t)d.view->vertex_count * 3; ++i)
            most_mm = fmax(most_mm, fabs((double)with[i] - (double)without[i]));
        free(with);
        free(without);
    }
    if (most_mm < 0.01 || most_mm > 0.25)
        fail_msg("the pose moves the face by %g mm", most_mm);
    take_finish(&t);
    fixture_finish(&d);
}

static void clip_that_ends_with_a_pose_lets_it_go(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char note[512];
    take t;
    edit e;
    (void)record_a_pose(&d, &t);
    edit_init(&e, EDIT_CLIP_TRIM);
    e.clip = t.layer[1].clip[0].id;
    e.end_ns = NS_PER_S / 2;
    fixture_must(edit_apply(&t, &e, &err), &err);
    assert_true(chin_in_take(&d, &t, 4 * NS_PER_S / 10, note, sizeof note) > 5.0);
    assert_true(chin_in_take(&d, &t, 7 * NS_PER_S / 10, note, sizeof note) < 0.01);
    take_finish(&t);
    fixture_finish(&d);
}

static void pose_that_the_rig_lost_moves_nothing_and_is_noted(void **state)
{
    (void)state;
    live_fixture d;
    char note[512];
    take t;
    (void)record_a_pose(&d, &t);
    fixture_stop_live(&d);
    for (uint32_t i = 0; i < d.face.rig->pose_count; ++i)
        if (strcmp(d.face.rig->pose[i].name, "jawOpen") == 0)
            d.face.rig->pose[i].name[0] = 'J';
    assert_true(chin_in_take(&d, &t, 7 * NS_PER_S / 10, note, sizeof note) < 0.01);
    if (!strstr(note, "The face lacks the pose \"jawOpen\""))
        fail_msg("the note is \"%s\"", note);
    take_finish(&t);
    fixture_finish(&d);
}

/* A take of a hand, with a pose or without one, over which poses alone are played. */
static void play_over_a_take(bool has_pose)
{
    live_fixture d;
    error err = {""};
    char text[FIXTURE_PATH];
    edit *edits;
    uint32_t count;
    take t;
    seen_faces *s = calloc(1, sizeof *s);
    assert_non_null(s);
    start(&d, "one_hand");
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(&d, text, &err), &err);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.2);
    if (has_pose)
        play(&d, "mouthSmileLeft", 1.0, 0.3);
    fixture_pass(&d, 1.3);
    fixture_take(&d, seen_record_end(&d), &t);
    const uint32_t below = has_pose ? 2 : 1;
    assert_int_equal(t.layer_count, below);
    play(&d, "mouthSmileLeft", 0.0, 0.1);
    fixture_must(live_remove_input(d.live, live_input_count(d.live) - 1, &err), &err);
    play(&d, "browInnerUp", 0.5, 0.1); /* held into the overdub */
    fixture_pass(&d, 0.3);
    fixture_must(live_show_take(d.live, &t, &err), &err);
    fixture_pass(&d, 1.0); /* the face has eased from the hands to the take */
    const overdub_plan over = {.passes = 1};
    fixture_must(live_overdub_start(d.live, &over, &err), &err);
    const int64_t until_ns = clock_now_ns() + 12 * NS_PER_S / 10;
    while (clock_now_ns() < until_ns) {
        if (s->count == 4)
            play(&d, "jawOpen", 0.8, 0.15);
        if (s->count == 14)
            play(&d, "jawOpen", 0.0, 0.15);
        fixture_frame(&d);
        const bool is_new = s->count == 0 || s->sample_ns[s->count - 1] != d.view->at_ns;
        if (d.view->mode != LIVE_OVERDUBS || !is_new || s->count == SEEN_MAX)
            continue;
        s->sample_ns[s->count] = d.view->at_ns;
        s->hash[s->count++] = fixture_hash(d.view->position, (size_t)d.view->vertex_count * 3);
    }
    fixture_must(live_record_end(d.live, &err), &err);
    if (!live_overdub_edits(d.live, &edits, &count, &err))
        fail_msg("nothing was performed: %s", err.text);
    for (uint32_t i = 0; i < count; ++i) {
        char *line;
        edit again;
        fixture_must(edit_write(&line, &edits[i], &err), &err); /* as it is stored */
        fixture_must(edit_parse(&again, line, strlen(line), &err), &err);
        fixture_must(edit_apply(&t, &again, &err), &err);
        free(line);
        edit_finish(&again);
        edit_finish(&edits[i]);
    }
    free(edits);
    assert_int_equal(t.layer_count, below + 1);
    const take_layer *top = &t.layer[below];
    assert_string_equal(top->name, "palette");
    assert_true(top->is_additive);
    assert_int_equal(top->clip[0].part, TAKE_PALETTE);
    uint32_t before = 0; /* faces before its first sample and after its last one */
    while (before < s->count && s->sample_ns[before] <= top->clip[0].start_ns)
        before += 1;
    s->count -= before;
    memmove(s->sample_ns, s->sample_ns + before, s->count * sizeof *s->sample_ns);
    memmove(s->hash, s->hash + before, s->count * sizeof *s->hash);
    while (s->count > 0 && s->sample_ns[s->count - 1] >= top->clip[0].end_ns)
        s->count -= 1;
    const uint32_t compared = seen_compare_take(&d, &t, 0, s);
    if (compared < 20)
        fail_msg("only %u faces were compared", compared);
    free(s);
    take_finish(&t);
    fixture_finish(&d);
}

static void poses_over_a_take_are_added_to_it(void **state)
{
    (void)state;
    play_over_a_take(false);
}

static void poses_over_poses_are_added_to_them(void **state)
{
    (void)state;
    play_over_a_take(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pose_fades_in_and_out),
        cmocka_unit_test(poses_add_up_and_all_at_once_stay_in_reach),
        cmocka_unit_test(take_shows_hand_and_poses_as_they_were_seen),
        cmocka_unit_test(take_from_a_stored_state_shows_them_too),
        cmocka_unit_test(held_pose_without_samples_is_in_the_take),
        cmocka_unit_test(faint_pose_hardly_moves_the_face),
        cmocka_unit_test(clip_that_ends_with_a_pose_lets_it_go),
        cmocka_unit_test(pose_that_the_rig_lost_moves_nothing_and_is_noted),
        cmocka_unit_test(poses_over_a_take_are_added_to_it),
        cmocka_unit_test(poses_over_poses_are_added_to_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
