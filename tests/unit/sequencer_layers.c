/* What a take shows of its performances: layers, what they own, gains, fades, offsets, solo, and
 * somebody who performs over it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/sequencer_scene.h"

/* An edit with the performance's own numbers: %p its id, %f and %t its span. */
static void edit_film(take *t, const film *f, const char *brief)
{
    char text[HELP_JSON] = "";
    const take_clip *clip = &t->layer[0].clip[0];
    size_t used = 0;
    for (const char *at = brief; *at; ++at) {
        long long number = at[1] == 'p'   ? f->performance
                           : at[1] == 'f' ? clip->from_ns
                                          : clip->to_ns;
        if (*at != '%')
            text[used++] = *at;
        else
            used += (size_t)snprintf(text + used, sizeof text - used, "%lld", number);
        at += *at == '%';
    }
    text[used] = '\0';
    help_do(t, text);
}

#define OVER                                                                                       \
    "{'op':'clip.add','layer':3,'performance':%p,'from_ns':%f,'to_ns':%t,'source_ns':0,"           \
    "'start_ns':0}"

static const scene_play anchored_play = {
    .mapping = "anchored", .face = "plane", .params = "gate=off"};
static const scene_play one_hand_play = {
    .mapping = "one_hand", .face = "puppet", .params = "samples=20"};

static film *shoot(const scene_play *play)
{
    return film_shoot(play, FILM_DEMO, "start=2,end=6", 1.0);
}

static void expect_film(film *f, const take *t, int64_t later_ns)
{
    sequencer *s = film_project(f, t, 0);
    for (int64_t at_ns = later_ns > 0 ? later_ns : 0; at_ns < t->duration_ns; at_ns += 70000001)
        if (film_play_to(s, at_ns) != f->hash[film_sample_at(f, at_ns - later_ns)])
            fail_msg("the face at %lld ns differs", (long long)at_ns);
    sequencer_destroy(s);
}

static const face *face_at(sequencer *s, int64_t at_ns)
{
    (void)film_play_to(s, at_ns);
    return composer_face(sequencer_performer(s)->composer);
}

/* Checks shown(a) - rest = times (shown(b) - rest) at an instant; returns how far b goes, mm. */
static double expect_times(sequencer *a, sequencer *b, int64_t at_ns, double times)
{
    const points *is = face_shown(face_at(a, at_ns)), *was = face_shown(face_at(b, at_ns)),
                 *rest = face_rest(composer_face(sequencer_performer(a)->composer));
    const float *const i[3] = {is->x, is->y, is->z}, *const w[3] = {was->x, was->y, was->z},
                       *const r[3] = {rest->x, rest->y, rest->z};
    double most = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (uint32_t k = 0; k < rest->count; ++k) {
            double full = (double)w[axis][k] - (double)r[axis][k];
            double part = (double)i[axis][k] - (double)r[axis][k];
            most = fmax(most, fabs(full));
            if (!(fabs(part - times * full) < 1e-3))
                fail_msg("at %lld ns a vertex has gone %g instead of %g times %g mm",
                         (long long)at_ns, part, times, full);
        }
    return most;
}

static void a_layer_with_the_same_below_it_changes_nothing(void **state)
{
    (void)state;
    take t = {0};
    film *f = shoot(&one_hand_play);
    film_take(f, &t);
    help_do(&t, "{'op':'layer.add','name':'brows','own':['brow.*','lid_*']}");
    edit_film(&t, f, OVER);
    expect_film(f, &t, 0);
    help_do(&t, "{'op':'layer.own','layer':3,'own':[]}");
    expect_film(f, &t, 0);
    take_finish(&t);
    film_burn(f);
}

/* The jaw of later over the brows of now: each is where its layer's own face has it. */
static void parts_of_different_times_stand_side_by_side(void **state)
{
    (void)state;
    take t = {0}, plain = {0}, late = {0};
    film *f = shoot(&one_hand_play);
    film_take(f, &plain);
    film_take(f, &late);
    film_take(f, &t);
    help_do(&late, "{'op':'layer.offset','layer':1,'offset_ns':-900m}");
    help_do(&t, "{'op':'layer.add','name':'jaw','own':['jaw']}");
    edit_film(&t, f,
              "{'op':'clip.add','layer':3,'performance':%p,'from_ns':%f,'to_ns':%t,"
              "'source_ns':900m,'start_ns':0}");
    sequencer *s = film_project(f, &t, 0), *now = film_project(f, &plain, 0),
              *then = film_project(f, &late, 0);
    const mrt_face *about = composer_about(sequencer_performer(s)->composer);
    double most = 0;
    for (int64_t at_ns = 100 * help_ms; at_ns < 2900 * help_ms; at_ns += 100 * help_ms) {
        const float *is = face_metered(face_at(s, at_ns))->dof,
                    *above = face_metered(face_at(then, at_ns))->dof,
                    *below = face_metered(face_at(now, at_ns))->dof;
        for (uint32_t d = 0; d < about->dof_count; ++d) {
            bool is_jaw = strncmp(about->dofs[d].name, "jaw.", 4) == 0;
            float wanted = is_jaw ? above[d] : below[d];
            most = fmax(most, fabs((double)above[d] - (double)below[d]));
            if (!(fabsf(is[d] - wanted) < 1e-6f))
                fail_msg("%s is %g instead of %g at %lld ns", about->dofs[d].name, (double)is[d],
                         (double)wanted, (long long)at_ns);
        }
    }
    assert_true(most > 0.02); /* they do differ */
    sequencer_destroy(s);
    sequencer_destroy(now);
    sequencer_destroy(then);
    take_finish(&t);
    take_finish(&plain);
    take_finish(&late);
    film_burn(f);
}

static void an_offset_shows_it_later(void **state)
{
    (void)state;
    take t = {0};
    film *f = shoot(&anchored_play);
    film_take(f, &t);
    help_do(&t, "{'op':'layer.offset','layer':1,'offset_ns':700m}");
    expect_film(f, &t, 700 * help_ms);
    sequencer *s = film_project(f, &t, 0);
    uint64_t before = film_play_to(s, 699 * help_ms);
    assert_true(scene_distance(face_shown(composer_face(sequencer_performer(s)->composer)),
                               face_rest(composer_face(sequencer_performer(s)->composer))) <= 0.0);
    assert_true(film_seek(s, 2000 * help_ms) != before);
    assert_true(film_seek(s, 300 * help_ms) == before);
    sequencer_destroy(s);
    help_do(&t, "{'op':'layer.offset','layer':1,'offset_ns':-700m}"); /* its start is not seen */
    s = film_project(f, &t, 0);
    for (int64_t at_ns = 0; at_ns < 2000 * help_ms; at_ns += 90000001)
        assert_true(film_play_to(s, at_ns) == f->hash[film_sample_at(f, at_ns + 700 * help_ms)]);
    sequencer_destroy(s);
    take_finish(&t);
    film_burn(f);
}

static void gains_multiply_what_is_pulled(void **state)
{
    (void)state;
    take plain = {0}, half = {0}, clip = {0};
    film *f = shoot(&anchored_play);
    film_take(f, &plain);
    film_take(f, &half);
    film_take(f, &clip);
    help_do(&half, "{'op':'layer.gain','layer':1,'gain':0.5}");
    help_do(&clip, "{'op':'clip.gain','clip':2,'gain':1.25}");
    sequencer *a = film_project(f, &half, 0), *b = film_project(f, &plain, 0),
              *c = film_project(f, &clip, 0);
    double most = 0;
    for (int64_t at_ns = 0; at_ns < plain.duration_ns; at_ns += 150000001) {
        most = fmax(most, expect_times(a, b, at_ns, 0.5));
        (void)expect_times(c, b, at_ns, 1.25);
    }
    assert_true(most > 3.0);
    sequencer_destroy(a);
    sequencer_destroy(b);
    sequencer_destroy(c);
    take_finish(&plain);
    take_finish(&half);
    take_finish(&clip);
    film_burn(f);
}

/* From the rest and back to it, in control space. */
static void fades_go_from_the_rest_and_back(void **state)
{
    (void)state;
    take plain = {0}, faded = {0};
    film *f = shoot(&anchored_play);
    film_take(f, &plain);
    film_take(f, &faded);
    help_do(&faded, "{'op':'clip.fade','clip':2,'fade_in_ns':1500m,'fade_out_ns':1000m}");
    sequencer *a = film_project(f, &faded, 0), *b = film_project(f, &plain, 0);
    int64_t end_ns = plain.duration_ns;
    for (uint32_t n = 0; n < f->count; n += 13) {
        int64_t at_ns = f->at_ns[n]; /* weights are those of the last sample */
        double in = (double)at_ns / (1500.0 * (double)help_ms);
        double out = (double)(end_ns - at_ns) / (1000.0 * (double)help_ms);
        (void)expect_times(a, b, at_ns, fmin(1.0, fmin(in, out)));
    }
    sequencer_destroy(a);
    sequencer_destroy(b);
    take_finish(&plain);
    take_finish(&faded);
    film_burn(f);
}

/* Two clips that overlap, of the same material: the cross-fade is not to be seen. */
static void a_cross_fade_of_the_same_is_not_seen(void **state)
{
    (void)state;
    take plain = {0}, t = {0};
    film *f = shoot(&one_hand_play);
    film_take(f, &plain);
    film_take(f, &t);
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':2500m}");
    edit_film(&t, f,
              "{'op':'clip.add','layer':1,'performance':%p,'from_ns':%f,'to_ns':%t,"
              "'source_ns':1500m,'start_ns':1500m}");
    sequencer *a = film_project(f, &t, 0), *b = film_project(f, &plain, 0);
    double most = 0;
    for (int64_t at_ns = 1000 * help_ms; at_ns < 3900 * help_ms; at_ns += 60000001)
        most = fmax(most, expect_times(a, b, at_ns, 1.0));
    assert_true(most > 3.0);
    sequencer_destroy(a);
    sequencer_destroy(b);
    take_finish(&plain);
    take_finish(&t);
    film_burn(f);
}

static void muted_layers_are_not_heard_and_solo_ones_alone(void **state)
{
    (void)state;
    static const char *const silences[] = {
        "{'op':'layer.mute','layer':3,'muted':true}", "{'op':'layer.solo','layer':1,'solo':true}",
        "{'op':'clip.mute','clip':4,'muted':true}", "{'op':'clip.remove','clip':4}"};
    film *f = shoot(&anchored_play);
    for (int i = 0; i < 4; ++i) {
        take t = {0};
        film_take(f, &t);
        help_do(&t, "{'op':'layer.add','name':'more'}");
        edit_film(&t, f,
                  "{'op':'clip.add','layer':3,'performance':%p,'from_ns':%f,'to_ns':%t,"
                  "'source_ns':1100m,'start_ns':0}");
        sequencer *s = film_project(f, &t, 0);
        assert_true(film_seek(s, 2000 * help_ms) !=
                    f->hash[film_sample_at(f, 2000 * help_ms)]); /* it is heard */
        sequencer_destroy(s);
        help_do(&t, silences[i]);
        expect_film(f, &t, 0);
        take_finish(&t);
    }
    film_burn(f);
}

static double most_speed(film *f, const take *t)
{
    sequencer *s = film_project(f, t, 0);
    const points *now = face_shown(composer_face(sequencer_performer(s)->composer));
    float *before = calloc(now->padded_count, sizeof *before);
    double most = 0;
    for (int64_t at_ns = 0; at_ns < t->duration_ns; at_ns += 20 * help_ms) {
        (void)film_play_to(s, at_ns);
        for (uint32_t i = 0; i < now->count; ++i) {
            if (at_ns > 0)
                most = fmax(most, fabs((double)now->z[i] - (double)before[i]));
            before[i] = now->z[i];
        }
    }
    free(before);
    sequencer_destroy(s);
    return most;
}

static void smoothing_slows_the_face_down(void **state)
{
    (void)state;
    take t = {0};
    film *f = shoot(&anchored_play);
    film_take(f, &t);
    double sharp = most_speed(f, &t);
    help_do(&t, "{'op':'clip.smooth','clip':2,'smooth_s':0.2}");
    double smooth = most_speed(f, &t);
    assert_true(smooth > 0.02 * sharp && smooth < 0.7 * sharp);
    help_do(&t, "{'op':'clip.smooth','clip':2,'smooth_s':0}");
    expect_film(f, &t, 0);
    take_finish(&t);
    film_burn(f);
}

/* ---- somebody performs over it ---- */

typedef struct actor {
    instance mapping;
    layer *layer;
    channel_route route;
} actor;

static void enter(actor *out, film *f, sequencer *s)
{
    error err = {""};
    const mrt_plugin_type *type;
    mrt_channel channel[MRT_MAX_CHANNELS];
    const performer_settings as = {.hand_length_mm = 0};
    scene_must(plugin_list_find(&f->plugins, f->play->mapping, MRT_MAPPING, &type, &err), &err);
    scene_must(instance_create(&out->mapping, type, CLOCK_VIRTUAL, f->log, &err), &err);
    scene_must(instance_set_list(&out->mapping, f->play->params, &err), &err);
    scene_must(performer_make_layer(sequencer_performer(s), &out->mapping, &as, &out->layer, &err),
               &err);
    channel_route_init(&out->route, channel, scene_channels(channel, 0));
}

static void leave(actor *a)
{
    layer_destroy(a->layer);
    instance_destroy(&a->mapping);
}

/* Samples of the right hand alone. */
static mrt_sample live_sample(uint32_t n)
{
    uint32_t from;
    return scene_sample(n % 40, &from);
}

static void perform_over(sequencer *s, actor *a, int64_t at_ns)
{
    mrt_sample sample = live_sample((uint32_t)(at_ns / (20 * help_ms)));
    sample.time_ns = at_ns;
    error err = {""};
    stage_frame f = {.step = sample_step_of(&a->route, &sample)};
    sequencer_perform_over(s, &f, 1.0);
    scene_must(frame_step(&f, &err), &err);
}

static void who_performs_over_everything_is_all_that_is_seen(void **state)
{
    (void)state;
    take t = {0};
    film *f = shoot(&one_hand_play);
    film_take(f, &t);
    sequencer *s = film_project(f, &t, 0);
    actor a;
    scene_stand alone;
    enter(&a, f, s);
    scene_stand_up(&alone, f->play, &f->file);
    sequencer_set_live(s, a.layer, NULL, false);
    /* loose parts swing in the time of all steps, those of the take too */
    face_set_springs(composer_face(sequencer_performer(s)->composer), 0.0);
    face_set_springs(composer_face(alone.performer->composer), 0.0);
    for (int64_t at_ns = 0; at_ns < 2000 * help_ms; at_ns += 20 * help_ms) {
        (void)film_play_to(s, at_ns);
        perform_over(s, &a, at_ns);
        mrt_sample sample = live_sample((uint32_t)(at_ns / (20 * help_ms)));
        sample.time_ns = at_ns;
        const sample_step next = sample_step_of(&a.route, &sample);
        frame_run(alone.performer, &next);
        composer_draw(alone.performer->composer);
        composer_draw(sequencer_performer(s)->composer);
        assert_true(scene_distance(face_shown(composer_face(sequencer_performer(s)->composer)),
                                   face_shown(composer_face(alone.performer->composer))) < 1e-4);
    }
    scene_lay_down(&alone);
    sequencer_destroy(s);
    leave(&a);
    take_finish(&t);
    film_burn(f);
}

static void who_performs_and_goes_leaves_the_take_as_it_was(void **state)
{
    (void)state;
    static const scene_play plays[] = {
        {.mapping = "anchored", .face = "plane", .params = "gate=off"},
        {.mapping = "unanchored", .face = "plane", .params = "gate=off"}};
    for (int i = 0; i < 2; ++i) {
        take t = {0};
        film *f = film_shoot(&plays[i], FILM_DEMO, "start=2,end=9", 1.0);
        film_take(f, &t);
        sequencer *s = film_project(f, &t, 0);
        actor a;
        enter(&a, f, s);
        sequencer_set_live(s, a.layer, NULL, true);
        bool was_seen = false;
        for (int64_t at_ns = 0; at_ns < 5000 * help_ms; at_ns += 20 * help_ms) {
            (void)film_play_to(s, at_ns);
            if (at_ns == 2000 * help_ms)
                scene_press(&a.mapping, "Commit");
            perform_over(s, &a, at_ns);
            was_seen |= film_face_of(s) != f->hash[film_sample_at(f, at_ns)];
        }
        assert_true(was_seen);
        sequencer_set_live(s, NULL, NULL, false);
        static const int64_t sought_ms[] = {5100, 6500, 1000, 4900, 2500};
        for (int k = 0; k < 5; ++k) {
            int64_t at_ns = sought_ms[k] * help_ms;
            if (film_seek(s, at_ns) != f->hash[film_sample_at(f, at_ns)])
                fail_msg("%s: the face at %lld ms still has it", plays[i].mapping,
                         (long long)sought_ms[k]);
        }
        sequencer_destroy(s);
        leave(&a);
        take_finish(&t);
        film_burn(f);
    }
}

/* An edit that is dragged: each version is the face that a sequencer of its own gives, and the
 * checkpoints before the change are kept. */
static void a_previewed_take_is_the_face_of_its_edit(void **state)
{
    (void)state;
    static const char *const versions[] = {
        "{'op':'clip.gain','clip':4,'gain':0.4}",
        "{'op':'clip.gain','clip':4,'gain':1.7}",
        "{'op':'clip.speed','clip':5,'speed':0.8}",
        "{'op':'clip.fade','clip':5,'fade_in_ns':500m,'fade_out_ns':300m}",
        "{'op':'clip.trim','clip':5,'start_ns':2400m}",
        "{'op':'clip.move','clip':5,'start_ns':1800m}",
        "{'op':'layer.gain','layer':3,'gain':0.5}",
        "{'op':'layer.mute','layer':3,'muted':true}",
    };
    film *f = shoot(
        &(scene_play){.mapping = "unanchored", .face = "plane", .params = "gate=off,gain=0.5"});
    error err = {""};
    take t = {0};
    film_take(f, &t);
    help_do(&t, "{'op':'layer.add','name':'over'}");
    edit_film(&t, f, OVER);
    help_do(&t, "{'op':'clip.split','clip':4,'at_ns':2000m}");
    help_do(&t, "{'op':'clip.trim','clip':4,'end_ns':1900m}");
    help_do(&t, "{'op':'clip.fade','clip':4,'fade_out_ns':200m}");
    sequencer *s = film_project(f, &t, 0);
    (void)film_play_to(s, t.duration_ns - 1);
    for (size_t i = 0; i < 2 * sizeof versions / sizeof *versions; ++i) {
        take version = {0};
        assert_int_equal(take_copy(&version, &t, &err), MRT_OK);
        if (i % 2 == 0) /* and back to what it was, as after Esc */
            help_do(&version, versions[i / 2]);
        scene_must(sequencer_preview_take(s, &version, &err), &err);
        sequencer *fresh = film_project(f, &version, 0);
        for (int64_t at_ms = 3500; at_ms > 0; at_ms -= 700)
            if (film_seek(s, at_ms * help_ms) != film_seek(fresh, at_ms * help_ms))
                fail_msg("%s: the face at %d ms differs", versions[i / 2], (int)at_ms);
        sequencer_destroy(fresh);
        take_finish(&version);
    }
    const size_t kept = sequencer_kept_bytes(s);
    take late = {0};
    assert_int_equal(take_copy(&late, &t, &err), MRT_OK);
    help_do(&late, "{'op':'clip.gain','clip':5,'gain':0.5}");
    scene_must(sequencer_preview_take(s, &late, &err), &err);
    assert_true(sequencer_kept_bytes(s) > 0 && sequencer_kept_bytes(s) < kept);
    take_finish(&late);
    sequencer_destroy(s);
    take_finish(&t);
    film_burn(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_previewed_take_is_the_face_of_its_edit),
        cmocka_unit_test(a_layer_with_the_same_below_it_changes_nothing),
        cmocka_unit_test(parts_of_different_times_stand_side_by_side),
        cmocka_unit_test(an_offset_shows_it_later),
        cmocka_unit_test(gains_multiply_what_is_pulled),
        cmocka_unit_test(fades_go_from_the_rest_and_back),
        cmocka_unit_test(a_cross_fade_of_the_same_is_not_seen),
        cmocka_unit_test(muted_layers_are_not_heard_and_solo_ones_alone),
        cmocka_unit_test(smoothing_slows_the_face_down),
        cmocka_unit_test(who_performs_over_everything_is_all_that_is_seen),
        cmocka_unit_test(who_performs_and_goes_leaves_the_take_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
