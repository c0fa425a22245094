/* Life on a live stage: that the face moves by itself and rests when life is switched off, and that
 * a take shows it as a layer of its own, bit for bit as it was seen, from any instant. */
#include "window/live_seen.h"

#include <stdio.h>

static const writer_slate slate = {.scene = "1", .shot = "a"};

static life_settings all_at(double strength)
{
    life_settings out = {.seed = 4};
    for (int i = 0; i < LIFE_KINDS; ++i) {
        out.is_on[i] = true;
        out.strength[i] = strength;
    }
    return out;
}

static void live_at(live_fixture *d, double strength)
{
    const life_settings to = all_at(strength);
    live_set_life(d->live, &to);
}

static const life *life_of(const live_fixture *d)
{
    return &d->live->scene->performer->voice[0].layer->life;
}

static void add_hand(live_fixture *d)
{
    error err = {""};
    char text[FIXTURE_PATH];
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(d, text, &err), &err);
}

static bool has_lived(live_fixture *d, void *data)
{
    (void)data;
    return fixture_apart_mm(d, d->first) > 0.3;
}

static void face_lives_and_rests(void **state)
{
    (void)state;
    live_fixture d;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    live_at(&d, 1.0);
    assert_true(fixture_until(&d, has_lived, NULL));
    assert_string_equal(live_life_trouble(d.live), "");
    for (int kind = 0; kind < LIFE_KINDS; ++kind)
        assert_null(live_life_missing(d.live, (life_kind)kind));
    live_at(&d, 0.0);
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    fixture_pass(&d, 1.5);
    const int64_t last_ns = life_of(&d)->time_ns;
    fixture_pass(&d, 0.4);
    assert_true(life_of(&d)->time_ns == last_ns); /* no more ticks, so nothing is recorded */
    live_at(&d, 1.0);
    assert_true(fixture_until(&d, has_lived, NULL));
    fixture_finish(&d);
}

/* Rows of the face of a take at an instant, sought from the states of the show. */
static uint64_t hash_swung(live_fixture *d, const take *t, int64_t at_ns, double swing)
{
    error err = {""};
    sequencer *plays;
    const size_t size = (size_t)d->view->vertex_count * 3;
    const sequencer_settings settings = {
        .show = d->show, .plugins = &d->plugins, .log = d->log, .face = &d->face};
    float *rows = malloc(size * sizeof *rows);
    assert_non_null(rows);
    fixture_must(sequencer_create(&plays, &settings, t, &err), &err);
    face_set_springs(composer_face(sequencer_performer(plays)->composer), swing);
    fixture_must(sequencer_seek(plays, at_ns, &err), &err);
    composer *shown = sequencer_performer(plays)->composer;
    composer_draw(shown);
    points_to_rows(rows, face_shown(composer_face(shown)), face_order(composer_face(shown)));
    const uint64_t hash = fixture_hash(rows, size);
    sequencer_destroy(plays);
    free(rows);
    return hash;
}

static uint64_t hash_at(live_fixture *d, const take *t, int64_t at_ns)
{
    return hash_swung(d, t, at_ns, 1.0);
}

/* The hand performs from a recording, and the face lives. before_s: the time until the take begins,
 * in which states may be stored. */
static void live_a_take(const char *mapping, double before_s)
{
    live_fixture d;
    error err = {""};
    seen_faces *s = calloc(1, sizeof *s);
    assert_non_null(s);
    fixture_start(&d, "puppet", mapping, FIXTURE_SHOW);
    live_at(&d, 1.0);
    add_hand(&d);
    fixture_pass(&d, before_s);
    fixture_must(live_record(d.live, &slate, &err), &err);
    seen_watch(&d, s, 4.0);
    live_at(&d, 0.3);
    seen_watch(&d, s, 2.0);
    const int64_t id = seen_record_end(&d);
    take t;
    fixture_take(&d, id, &t);
    assert_int_equal(t.layer_count, 2);
    assert_string_equal(t.layer[1].name, "life");
    assert_int_equal(t.layer[0].clip[0].part, TAKE_HANDS);
    assert_int_equal(t.layer[1].clip[0].part, TAKE_LIFE);
    assert_true(t.layer[1].is_additive);
    const uint32_t compared = seen_compare(&d, id, s);
    if (compared < 20)
        fail_msg("only %u faces were compared", compared);
    /* Each instant is sought by a sequencer of its own, which knows only the show. */
    for (uint32_t i = 3; i < s->count; i += s->count / 7 + 1) {
        const int64_t at_ns = s->sample_ns[i] - d.live->take_begun_ns;
        if (at_ns > 0 && at_ns < t.duration_ns && hash_at(&d, &t, at_ns) != s->hash[i])
            fail_msg("the face at %.3f s is another one when it is sought", (double)at_ns * 1e-9);
    }
    take_finish(&t);
    free(s);
    fixture_finish(&d);
}

static void take_shows_hand_and_life_as_they_were_seen(void **state)
{
    (void)state;
    live_a_take("one_hand", 0.3);
}

/* Its replay begins with a state of the recording. */
static void take_from_a_stored_state_shows_them_too(void **state)
{
    (void)state;
    live_a_take("anchored", 6.5);
}

/* Loose parts are held: those that swung when the take began settle without life, too. */
static void muted_life_leaves_the_hand_alone(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    live_at(&d, 1.0);
    fixture_pass(&d, 1.0);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 2.0);
    fixture_take(&d, seen_record_end(&d), &t);
    const uint32_t lane = t.layer_count - 1;
    assert_string_equal(t.layer[lane].name, "life");
    t.layer[lane].is_muted = true;
    const uint64_t still = hash_swung(&d, &t, NS_PER_S / 2, 0.0);
    assert_true(hash_swung(&d, &t, 3 * NS_PER_S / 2, 0.0) == still);
    t.layer[lane].is_muted = false;
    assert_true(hash_swung(&d, &t, 3 * NS_PER_S / 2, 0.0) != still);
    edit e;
    edit_init(&e, EDIT_CLIP_TRIM);
    e.clip = t.layer[lane].clip[0].id;
    e.end_ns = NS_PER_S;
    fixture_must(edit_apply(&t, &e, &err), &err);
    assert_true(hash_swung(&d, &t, 3 * NS_PER_S / 2, 0.0) == still);
    assert_true(hash_swung(&d, &t, NS_PER_S / 2, 0.0) != still);
    take_finish(&t);
    fixture_finish(&d);
}

/* A hand that was recorded without life gets one over it, which sees the hand. */
static void life_over_a_take_becomes_a_layer(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    edit *edits;
    uint32_t count;
    take t;
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    add_hand(&d);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 2.0);
    fixture_take(&d, seen_record_end(&d), &t);
    assert_int_equal(t.layer_count, 1);
    fixture_must(live_remove_input(d.live, live_input_count(d.live) - 1, &err), &err);
    live_at(&d, 1.0);
    fixture_pass(&d, 0.3); /* its input joins */
    fixture_must(live_show_take(d.live, &t, &err), &err);
    fixture_pass(&d, 1.0);
    const overdub_plan over = {.passes = 1};
    fixture_must(live_overdub_start(d.live, &over, &err), &err);
    fixture_pass(&d, 1.5);
    fixture_must(live_record_end(d.live, &err), &err);
    if (!live_overdub_edits(d.live, &edits, &count, &err))
        fail_msg("nothing was performed: %s", err.text);
    for (uint32_t i = 0; i < count; ++i) {
        fixture_must(edit_apply(&t, &edits[i], &err), &err);
        edit_finish(&edits[i]);
    }
    free(edits);
    assert_int_equal(t.layer_count, 2);
    assert_string_equal(t.layer[1].name, "life");
    assert_int_equal(t.layer[1].clip[0].part, TAKE_LIFE);
    assert_true(t.layer[1].is_additive);
    /* A take that lives gets no second life: nothing is performed over it. */
    fixture_must(live_show_take(d.live, &t, &err), &err);
    fixture_pass(&d, 1.5);
    fixture_must(live_overdub_start(d.live, &over, &err), &err);
    fixture_pass(&d, 0.8);
    const int64_t last_ns = life_of(&d)->time_ns;
    fixture_pass(&d, 0.3);
    assert_true(life_of(&d)->time_ns == last_ns);
    fixture_must(live_record_end(d.live, &err), &err);
    if (live_overdub_edits(d.live, &edits, &count, &err)) {
        for (uint32_t i = 0; i < count; ++i)
            edit_finish(&edits[i]);
        free(edits);
    }
    take_finish(&t);
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(face_lives_and_rests),
        cmocka_unit_test(take_shows_hand_and_life_as_they_were_seen),
        cmocka_unit_test(take_from_a_stored_state_shows_them_too),
        cmocka_unit_test(muted_life_leaves_the_hand_alone),
        cmocka_unit_test(life_over_a_take_becomes_a_layer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
