/* A take that was recorded is played again: the same face, bit for bit, after every sample, as when
 * it was performed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/sequencer_scene.h"

/* Sample by sample. */
static void expect_film(film *f, const take *t)
{
    error err = {""};
    sequencer *s = film_project(f, t, 0);
    assert_string_equal(sequencer_note(s), "");
    for (uint32_t n = 0; n < f->count; ++n) {
        mrt_result result = sequencer_step(s, &err);
        scene_must(result, &err);
        assert_int_equal(result, MRT_OK);
        if (sequencer_now_ns(s) != f->at_ns[n])
            fail_msg("%s on the %s: sample %u is shown at %lld instead of %lld ns",
                     f->play->mapping, f->play->face, n, (long long)sequencer_now_ns(s),
                     (long long)f->at_ns[n]);
        if (film_face_of(s) != f->hash[n])
            fail_msg("%s on the %s: the face of sample %u of %u differs", f->play->mapping,
                     f->play->face, n, f->count);
    }
    assert_int_equal(sequencer_step(s, &err), MRT_END);
    assert_int_equal(sequencer_sample_count(s), f->sample_count);
    sequencer_destroy(s);
}

/* How many re-zeros were granted. */
static uint32_t check_play(const scene_play *play, film_inputs which, const char *span)
{
    take t = {0};
    film *f = film_shoot(play, which, span, 5.0);
    film_take(f, &t);
    expect_film(f, &t);
    uint32_t rezeroed = f->rezeros.done;
    take_finish(&t);
    film_burn(f);
    return rezeroed;
}

static void anchored_is_played_as_it_was_performed(void **state)
{
    (void)state;
    (void)check_play(&(scene_play){.mapping = "anchored",
                                   .face = "puppet",
                                   .params = "gate=on,on_release=spring_back",
                                   .act = {{.at = 90, .set = "gain=0.9"},
                                           {.at = 150, .press = "Commit"},
                                           {.at = 260, .set = "up=45,leak=2"},
                                           {.at = 300, .press = "Engage"},
                                           {.at = 420, .press = "Release"}}},
                     FILM_DEMO, "start=3,end=9");
}

static void unanchored_is_played_as_it_was_performed(void **state)
{
    (void)state;
    (void)check_play(&(scene_play){.mapping = "unanchored",
                                   .face = "moai",
                                   .params = "gate=on,gain=0.6",
                                   .act = {{.at = 90, .set = "gain=0.9"},
                                           {.at = 150, .press = "Commit"},
                                           {.at = 300, .set = "leak=2"},
                                           {.at = 420, .press = "Release"}}},
                     FILM_DEMO, "start=3,end=9");
}

static void one_hand_is_played_as_it_was_performed(void **state)
{
    (void)state;
    (void)check_play(&(scene_play){.mapping = "one_hand",
                                   .face = "puppet",
                                   .params = "samples=30",
                                   .act = {{.at = 90, .set = "jaw.gain=1.4"},
                                           {.at = 95, .press = "Blink"},
                                           {.at = 200, .rezero = 2}, /* in motion: refused */
                                           {.at = 260, .press = "Anchor"},
                                           {.at = 262, .set = "mode=mask"}}},
                     FILM_DEMO, "start=1,end=7");
}

static void two_inputs_are_played_in_the_order_in_which_they_came(void **state)
{
    (void)state;
    (void)check_play(
        &(scene_play){.mapping = "anchored",
                      .face = "plane",
                      .params = "gate=off,commit_pedal=1,engage_pedal=2,release_pedal=3"},
        FILM_BOTH, "start=3,end=8");
    (void)check_play(&(scene_play){.mapping = "unanchored",
                                   .face = "plane",
                                   .params = "gate=on,commit_pedal=1,engage_pedal=2,gain=0.4"},
                     FILM_BOTH, "start=3,end=8");
    (void)check_play(&(scene_play){.mapping = "one_hand", .face = "moai", .params = "samples=20"},
                     FILM_BOTH, "start=3,end=8");
}

/* Two gloves of one rate: one step a tick, and one solve; the take that was recorded is the same.
 */
static void two_gloves_are_one_performer(void **state)
{
    (void)state;
    take t = {0};
    const scene_play play = {.mapping = "anchored",
                             .face = "plane",
                             .params = "gate=off,commit_pedal=1,engage_pedal=2,release_pedal=3"};
    film *f = film_shoot(&play, FILM_PAIR, "start=0,end=4", 4.0);
    assert_int_equal(f->sample_count, 801); /* the demo hand: both ends */
    assert_true(f->count <= 404);
    assert_true(f->solves <= f->count + 40); /* and what commits and takes hold anew */
    film_take(f, &t);
    expect_film(f, &t);
    take_finish(&t);
    film_burn(f);
}

static void rezeros_are_played_at_the_same_sample(void **state)
{
    (void)state;
    const scene_play by_hand = {.mapping = "anchored",
                                .face = "plane",
                                .params = "gate=off",
                                .act = {{.at = 90, .rezero = 2}}};
    const scene_play by_pedal = {
        .mapping = "anchored", .face = "plane", .params = "gate=off", .rezero_pedal = 3};
    assert_int_equal(check_play(&by_hand, FILM_DEMO, "start=0,end=4"), 1);
    assert_true(check_play(&by_pedal, FILM_BOTH, "start=0,end=4") >= 1);
}

/* At every frame rate, forwards in any steps. */
static void frames_show_every_sample_up_to_their_time(void **state)
{
    (void)state;
    static const int64_t steps_ns[] = {41708333, 1000000000, 3333333};
    const scene_play play = {.mapping = "unanchored", .face = "plane", .params = "gate=off"};
    take t = {0};
    film *f = film_shoot(&play, FILM_DEMO, "start=3,end=7", 1.0);
    film_take(f, &t);
    for (int i = 0; i < 3; ++i) {
        sequencer *s = film_project(f, &t, 0);
        for (int64_t at_ns = 0; at_ns < t.duration_ns; at_ns += steps_ns[i])
            assert_true(film_play_to(s, at_ns) == f->hash[film_sample_at(f, at_ns)]);
        sequencer_destroy(s);
    }
    take_finish(&t);
    film_burn(f);
}

static void split_clips_change_nothing(void **state)
{
    (void)state;
    static const char *const mappings[] = {"anchored", "unanchored"};
    for (int i = 0; i < 2; ++i) {
        const scene_play play = {.mapping = mappings[i],
                                 .face = "plane",
                                 .params = "gate=off",
                                 .act = {{.at = 110, .set = "gain=0.8"}}};
        take t = {0};
        film *f = film_shoot(&play, FILM_DEMO, "start=3,end=7", 1.0);
        film_take(f, &t);
        help_do(&t, "{'op':'clip.split','clip':2,'at_ns':1234567891}");
        help_do(&t, "{'op':'clip.split','clip':3,'at_ns':2000m}"); /* at a sample */
        help_do(&t, "{'op':'clip.split','clip':2,'at_ns':1000m}");
        assert_int_equal(t.layer[0].clip_count, 4);
        expect_film(f, &t);
        take_finish(&t);
        film_burn(f);
    }
}

/* A take that begins in the middle of a performance shows what that had made by then. */
static void a_trimmed_take_shows_the_same_faces(void **state)
{
    (void)state;
    static const char *const mappings[] = {"anchored", "unanchored"};
    for (int i = 0; i < 2; ++i) {
        const scene_play play = {
            .mapping = mappings[i], .face = "plane", .params = "gate=off,gain=0.5"};
        take t = {0};
        film *f = film_shoot(&play, FILM_DEMO, "start=3,end=9", 1.0);
        film_take(f, &t);
        help_do(&t, "{'op':'range.keep','in_ns':2503m,'out_ns':5001m}");
        sequencer *s = film_project(f, &t, 0);
        for (int64_t at_ns = 0; at_ns < t.duration_ns; at_ns += 33333333) {
            uint64_t shown = film_play_to(s, at_ns);
            if (shown != f->hash[film_sample_at(f, at_ns + 2503 * help_ms)])
                fail_msg("%s: the face at %lld ns differs", mappings[i], (long long)at_ns);
        }
        sequencer_destroy(s);
        take_finish(&t);
        film_burn(f);
    }
}

/* Half as fast: each sample is shown when its time has come; dt is the performance's own. */
static void a_retimed_take_shows_the_same_faces_at_other_times(void **state)
{
    (void)state;
    const scene_play play = {
        .mapping = "unanchored", .face = "plane", .params = "gate=off,leak=1,gain=0.5"};
    take t = {0};
    film *f = film_shoot(&play, FILM_DEMO, "start=3,end=6", 1.0);
    static const struct speed {
        const char *edit;
        int64_t times, over;
    } speeds[] = {{"{'op':'clip.speed','clip':2,'speed':0.5}", 1, 2},
                  {"{'op':'clip.speed','clip':2,'speed':2}", 2, 1}};
    for (int i = 0; i < 2; ++i) {
        film_take(f, &t);
        help_do(&t, speeds[i].edit);
        sequencer *s = film_project(f, &t, 0);
        int64_t end_ns = t.layer[0].clip[0].end_ns;
        for (int64_t at_ns = 0; at_ns < end_ns && at_ns < t.duration_ns; at_ns += 20123457)
            assert_true(film_play_to(s, at_ns) ==
                        f->hash[film_sample_at(f, at_ns * speeds[i].times / speeds[i].over)]);
        sequencer_destroy(s);
        take_finish(&t);
    }
    film_burn(f);
}

static void after_the_end_and_where_it_is_muted_the_face_rests(void **state)
{
    (void)state;
    const scene_play play = {.mapping = "anchored", .face = "plane", .params = "gate=off"};
    take t = {0};
    film *f = film_shoot(&play, FILM_DEMO, "start=3,end=6", 1.0);
    scene_stand rest;
    scene_stand_up(&rest, &play, &f->file);
    composer_draw(rest.performer->composer);
    uint64_t at_rest = scene_hash(composer_face(rest.performer->composer));
    scene_lay_down(&rest);
    film_take(f, &t);
    sequencer *s = film_project(f, &t, 0);
    assert_true(film_play_to(s, t.duration_ns - 1) == f->hash[f->count - 1]);
    assert_true(f->hash[f->count - 1] != at_rest);
    assert_true(film_play_to(s, t.duration_ns) == at_rest);
    static const char *const mutes[] = {"{'op':'clip.mute','clip':2,'muted':true}",
                                        "{'op':'layer.mute','layer':1,'muted':true}"};
    for (int i = 0; i < 2; ++i) {
        take muted = {0};
        film_take(f, &muted);
        help_do(&muted, mutes[i]);
        error err = {""};
        scene_must(sequencer_set_take(s, &muted, &err), &err);
        assert_true(film_seek(s, 1500 * help_ms) == at_rest);
        take_finish(&muted);
    }
    sequencer_destroy(s);
    take_finish(&t);
    film_burn(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anchored_is_played_as_it_was_performed),
        cmocka_unit_test(unanchored_is_played_as_it_was_performed),
        cmocka_unit_test(one_hand_is_played_as_it_was_performed),
        cmocka_unit_test(two_inputs_are_played_in_the_order_in_which_they_came),
        cmocka_unit_test(two_gloves_are_one_performer),
        cmocka_unit_test(rezeros_are_played_at_the_same_sample),
        cmocka_unit_test(frames_show_every_sample_up_to_their_time),
        cmocka_unit_test(split_clips_change_nothing),
        cmocka_unit_test(a_trimmed_take_shows_the_same_faces),
        cmocka_unit_test(a_retimed_take_shows_the_same_faces_at_other_times),
        cmocka_unit_test(after_the_end_and_where_it_is_muted_the_face_rests),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
