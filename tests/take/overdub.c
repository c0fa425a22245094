/* stage/record/overdub.h: performing over a take. On the puppet, with one hand, on a virtual clock.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stage/record/overdub.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const int64_t S = 1000000000;
static const char demo[] = SOURCE_DIR "/plugins/log/demo_hand.csv";
static const char puppet[] = SOURCE_DIR "/rigs/puppet/puppet.rig.json";
enum { FPS = 25, FRAMES_MAX = 400 };

typedef struct house { /* made once */
    plugin_list plugins;
    log_queue *log;
    face_file face;
    char folder[64];
} house;
static house the;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* A hand that performs: the demo's, from `start` on. */
typedef struct hand {
    input *input;
    instance mapping;
    char text[256];
    const char *texts[1];
} hand;

static void hand_open(hand *h, const char *params)
{
    error err = {""};
    const mrt_plugin_type *type;
    must(plugin_list_find(&the.plugins, "log", MRT_INPUT, &type, &err), &err);
    must(input_create(&h->input, type, demo, params, CLOCK_VIRTUAL, the.log, &err), &err);
    must(plugin_list_find(&the.plugins, "one_hand", MRT_MAPPING, &type, &err), &err);
    must(instance_create(&h->mapping, type, CLOCK_VIRTUAL, the.log, &err), &err);
    snprintf(h->text, sizeof h->text, "log:demo_hand.csv,%s", params);
    h->texts[0] = h->text;
}

static void hand_close(hand *h)
{
    instance_destroy(&h->mapping);
    input_destroy(h->input);
}

/* ---- frames: the furthest vertex from rest, and a sum over all vertices' bits ---- */

typedef struct seen {
    uint32_t count;
    uint64_t bits[FRAMES_MAX];
    float lip[FRAMES_MAX], brow[FRAMES_MAX]; /* mm, height of two contacts */
} seen;

static uint64_t sum_of(const points *p)
{
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    const float *const stream[3] = {p->x, p->y, p->z};
    for (int axis = 0; axis < 3; ++axis)
        for (uint32_t i = 0; i < p->count; ++i) {
            uint32_t bits;
            memcpy(&bits, &stream[axis][i], sizeof bits);
            sum = (sum ^ bits) * UINT64_C(0x100000001b3);
        }
    return sum;
}

static float height_of(composer *c, const char *name)
{
    const mrt_face *about = composer_about(c);
    for (uint32_t i = 0; i < about->contact_count; ++i)
        if (strcmp(about->contacts[i].name, name) == 0)
            return (float)(face_contact_now(composer_face(c), i + 1).y -
                           (double)about->contacts[i].rest.y);
    fail_msg("no contact %s", name);
    return 0;
}

static void look(seen *out, composer *c)
{
    assert_true(out->count < FRAMES_MAX);
    out->bits[out->count] = sum_of(face_shown(composer_face(c)));
    out->lip[out->count] = height_of(c, "lip.lower.mid");
    out->brow[out->count] = height_of(c, "brow.mid.l");
    out->count += 1;
}

/* The take from the show, frame by frame. */
static void play(seen *out, show *s, int64_t take_id)
{
    error err = {""};
    take t;
    sequencer *q;
    sequencer_settings settings = {
        .show = s, .plugins = &the.plugins, .log = the.log, .face = &the.face};
    *out = (seen){0};
    must(edit_store_take(&t, s, take_id, &err), &err);
    must(sequencer_create(&q, &settings, &t, &err), &err);
    assert_string_equal(sequencer_note(q), "");
    for (int64_t at = 0; at < t.duration_ns; at += S / FPS) {
        must(sequencer_play_to(q, at, &err), &err);
        composer_draw(sequencer_performer(q)->composer);
        look(out, sequencer_performer(q)->composer);
    }
    sequencer_destroy(q);
    take_finish(&t);
}

/* ---- the take that is performed over: four seconds ---- */

static mrt_result no_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    (void)data;
    (void)index;
    (void)time_s;
    (void)work_ns;
    (void)err;
    return MRT_OK;
}

static mrt_result record_step(void *data, stage_frame *f, error *err)
{
    (void)err;
    recorder_step(data, &f->step);
    return MRT_OK;
}

static void performed(void *data, const stage_frame *f)
{
    recorder_performed(data, &f->step);
}

static show *record_base(const char *name, int64_t *out_take)
{
    error err = {""};
    show *s;
    hand h;
    performer *p;
    recorder *r;
    char path[128];
    snprintf(path, sizeof path, "%s/%s.marotte", the.folder, name);
    must(show_create(&s, path, &err), &err);
    hand_open(&h, "end=4");
    performer_settings settings = {0};
    must(performer_create(&p, &the.face, &h.mapping, &settings, &err), &err);
    recorder_settings record = {.show = s,
                                .plugins = &the.plugins,
                                .log = the.log,
                                .clock = CLOCK_VIRTUAL,
                                .inputs = &h.input,
                                .input_text = h.texts,
                                .input_count = 1,
                                .layer = p->voice[0].layer,
                                .performer = p,
                                .face_path = puppet,
                                .face = &the.face};
    must(recorder_start(&r, &record, &err), &err);
    const writer_slate slate = {.scene = "1", .shot = "a"};
    recorder_take_next(r, &slate, 0);
    player_settings playing = {.fps = FPS, .clock = CLOCK_VIRTUAL};
    player_events events = {.frame = no_frame};
    stage_frame f = {.performer = p, .self = r, .record = record_step, .performed = performed};
    player_report report;
    must(player_run_stage(&f, &h.input, 1, &playing, &events, &report, &err), &err);
    must(recorder_take_end(r, &err), &err);
    *out_take = recorder_take(r);
    must(recorder_stop(r, &err), &err);
    performer_destroy(p);
    hand_close(&h);
    return s;
}

/* ---- performing over it ---- */

typedef struct over {
    overdub *overdub;
    seen *seen;
} over;

static mrt_result see_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    over *o = data;
    (void)index;
    (void)time_s;
    (void)work_ns;
    (void)err;
    if (o->seen)
        look(o->seen, overdub_performer(o->overdub)->composer);
    return MRT_OK;
}

static overdub_settings settings_of(show *s, int64_t take_id, hand *h, overdub_plan plan)
{
    return (overdub_settings){.recorder = {.show = s,
                                           .plugins = &the.plugins,
                                           .log = the.log,
                                           .face = &the.face,
                                           .face_path = puppet,
                                           .clock = CLOCK_VIRTUAL,
                                           .inputs = &h->input,
                                           .input_text = h->texts,
                                           .input_count = 1,
                                           .mapping = &h->mapping},
                              .take = take_id,
                              .plan = plan};
}

static overdub_made perform_over(show *s, int64_t take_id, overdub_plan plan, const char *params,
                                 seen *out_live)
{
    error err = {""};
    hand h;
    hand_open(&h, params);
    if (plan.passes == 0)
        plan.passes = 1;
    if (!(plan.speed > 0))
        plan.speed = 1.0;
    const overdub_settings settings = settings_of(s, take_id, &h, plan);
    over o = {.seen = out_live};
    if (out_live)
        *out_live = (seen){0};
    must(overdub_create(&o.overdub, &settings, &err), &err);
    player_settings playing = {.fps = FPS, .clock = CLOCK_VIRTUAL};
    player_events events = {.frame = see_frame, .data = &o};
    player_report report;
    must(player_run_stage(overdub_frame(o.overdub), &h.input, 1, &playing, &events, &report, &err),
         &err);
    overdub_made result;
    must(overdub_finish(o.overdub, &result, &err), &err);
    overdub_destroy(o.overdub);
    hand_close(&h);
    return result;
}

static void a_layer_is_added_and_plays_as_it_was_performed(void **state)
{
    (void)state;
    int64_t id;
    show *s = record_base("layer", &id);
    seen *before = malloc(sizeof *before), *live = malloc(sizeof *live),
         *after = malloc(sizeof *after);
    char own[1][TAKE_NAME] = {"brow.*"};
    play(before, s, id);
    overdub_plan plan = {.own = own, .own_count = 1};
    overdub_made result = perform_over(s, id, plan, "start=6,end=9.9", live);
    assert_int_equal(result.layer_count, 1);
    play(after, s, id);
    error err = {""};
    take t;
    must(edit_store_take(&t, s, id, &err), &err);
    assert_int_equal(t.layer_count, 2);
    assert_int_equal(t.layer[1].own_count, 1);
    take_finish(&t);
    uint32_t frames = live->count < after->count ? live->count : after->count;
    assert_true(frames > 90);
    float brow_change = 0;
    for (uint32_t i = 0; i < frames; ++i) {
        assert_true(fabsf(live->brow[i] - after->brow[i]) < 1e-3f); /* as it was performed */
        assert_true(fabsf(live->lip[i] - after->lip[i]) < 1e-3f);
        assert_true(fabsf(before->lip[i] - after->lip[i]) < 0.5f); /* the rest is as before */
        brow_change = fmaxf(brow_change, fabsf(before->brow[i] - after->brow[i]));
    }
    assert_true(brow_change > 2.0f);
    show_close(s);
    free(before);
    free(live);
    free(after);
}

static void a_punch_changes_nothing_outside_in_and_out(void **state)
{
    (void)state;
    int64_t id;
    error err = {""};
    show *s = record_base("punch", &id);
    seen *before = malloc(sizeof *before), *after = malloc(sizeof *after);
    take t;
    play(before, s, id);
    must(edit_store_take(&t, s, id, &err), &err);
    overdub_plan plan = {.into_layer = t.layer[0].id,
                         .in_ns = S,
                         .out_ns = 5 * S / 2,
                         .fade_ns = S / 5,
                         .preroll_ns = S / 2};
    take_finish(&t);
    overdub_made result = perform_over(s, id, plan, "start=10,end=16", NULL);
    assert_int_equal(result.layer_count, 1);
    play(after, s, id);
    assert_int_equal(before->count, after->count);
    uint32_t changed = 0;
    for (uint32_t i = 0; i < before->count; ++i) {
        int64_t at = (int64_t)i * S / FPS;
        if (at < S)
            assert_true(before->bits[i] == after->bits[i]);
        else if (at > 5 * S / 2 + S / FPS)
            assert_true(fabsf(before->lip[i] - after->lip[i]) < 1e-3f);
        else
            changed += before->bits[i] != after->bits[i];
    }
    assert_true(changed > 20);
    show_close(s);
    free(before);
    free(after);
}

static void a_loop_stacks_layers_of_which_the_last_is_heard(void **state)
{
    (void)state;
    int64_t id;
    error err = {""};
    size_t count;
    show_take *takes;
    show *s = record_base("loop", &id);
    overdub_plan plan = {
        .in_ns = S, .out_ns = 2 * S, .passes = 3, .preroll_ns = S / 2, .count_in_ns = S};
    overdub_made result = perform_over(s, id, plan, "start=0,end=20", NULL);
    assert_int_equal(result.layer_count, 3);
    take t;
    must(edit_store_take(&t, s, id, &err), &err);
    assert_int_equal(t.layer_count, 4);
    for (uint32_t i = 1; i < 4; ++i) {
        assert_int_equal(t.layer[i].is_muted, i < 3);
        assert_int_equal(t.layer[i].clip_count, 1);
        assert_int_equal(t.layer[i].clip[0].start_ns, S);
        assert_int_equal(t.layer[i].clip[0].end_ns, 2 * S);
    }
    assert_int_equal(t.layer[3].id, result.last_layer);
    /* each shows its own pass: a second of count-in, then passes of 1.5 s */
    int64_t first = t.layer[1].clip[0].warp[0].source_ns;
    int64_t second = t.layer[2].clip[0].warp[0].source_ns;
    assert_true(llabs(second - first - 3 * S / 2) < S / 50);
    take_finish(&t);
    must(show_takes(s, &takes, &count, &err), &err);
    assert_int_equal(count, 4); /* each pass is a take by itself too */
    for (size_t i = 0; i < count; ++i) {
        assert_false(takes[i].is_recording);
        assert_int_equal(takes[i].over, takes[i].id == id ? 0 : id);
        assert_int_equal(takes[i].over_at_ns, takes[i].id == id ? 0 : S);
    }
    free(takes);
    show_close(s);
}

static void a_loop_that_is_left_in_a_pass_keeps_the_last_whole_one_heard(void **state)
{
    (void)state;
    int64_t id;
    error err = {""};
    take t;
    show *s = record_base("left", &id);
    overdub_plan plan = {.in_ns = S, .out_ns = 2 * S, .passes = 3, .fade_ns = S / 4};
    overdub_made result = perform_over(s, id, plan, "start=0,end=1.2", NULL);
    assert_int_equal(result.layer_count, 2);
    must(edit_store_take(&t, s, id, &err), &err);
    assert_int_equal(t.layer_count, 3);
    assert_false(t.layer[1].is_muted);
    assert_true(t.layer[2].is_muted);
    assert_int_equal(t.layer[1].id, result.last_layer);
    assert_int_equal(t.layer[1].clip[0].fade_in_ns, S / 4);
    const take_clip *left =
        &t.layer[2].clip[0]; /* 0.2 s: the fades that were asked for are longer */
    assert_true(left->end_ns < 13 * S / 10);
    assert_int_equal(left->fade_in_ns, (left->end_ns - left->start_ns) / 2);
    assert_int_equal(result.edit_count, 7); /* layer, clip and fade twice, and muted */
    take_finish(&t);
    show_close(s);
}

static void a_punch_that_is_left_early_fades_as_far_as_it_goes(void **state)
{
    (void)state;
    int64_t id;
    error err = {""};
    take t;
    show *s = record_base("early", &id);
    must(edit_store_take(&t, s, id, &err), &err);
    overdub_plan plan = {
        .into_layer = t.layer[0].id, .in_ns = S / 2, .out_ns = 3 * S, .fade_ns = S};
    take_finish(&t);
    overdub_made result = perform_over(s, id, plan, "start=0,end=1", NULL);
    assert_int_equal(result.layer_count, 1);
    assert_int_equal(result.edit_count, 1);
    must(edit_store_take(&t, s, id, &err), &err);
    assert_int_equal(t.layer[0].clip_count, 3);
    assert_int_equal(t.layer[0].clip[1].start_ns, S / 2);
    assert_true(llabs(t.layer[0].clip[1].end_ns - 3 * S / 2) < S / 10);
    take_finish(&t);
    show_close(s);
}

static void at_half_speed_twice_as_much_is_performed(void **state)
{
    (void)state;
    int64_t id;
    error err = {""};
    take t;
    show *s = record_base("slow", &id);
    overdub_plan plan = {.in_ns = S, .out_ns = 3 * S, .speed = 0.5};
    perform_over(s, id, plan, "start=0,end=20", NULL);
    must(edit_store_take(&t, s, id, &err), &err);
    const take_clip *clip = &t.layer[1].clip[0];
    int64_t shown = take_warp_to_source(clip, clip->end_ns) - take_warp_to_source(clip, S);
    assert_true(llabs(shown - 4 * S) < S / 50);
    take_finish(&t);
    show_close(s);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    int64_t id;
    show *s = record_base("refused", &id);
    hand h;
    hand_open(&h, "end=1");
    const overdub_settings good = settings_of(s, id, &h, (overdub_plan){.passes = 1, .speed = 1.0});
    char nobody[1][TAKE_NAME] = {"nosuch.*"};
    overdub_settings bad[8];
    for (int i = 0; i < 8; ++i)
        bad[i] = good;
    bad[0].plan.in_ns = 3 * S, bad[0].plan.out_ns = 2 * S;
    bad[1].plan.in_ns = 100 * S;
    bad[2].plan.passes = 2; /* of what? */
    bad[3].plan.into_layer = 77, bad[3].plan.out_ns = S;
    bad[4].plan.fade_ns = S, bad[4].plan.out_ns = S;
    bad[5].plan.speed = 9;
    bad[6].take = 99;
    bad[7].plan.own = nobody, bad[7].plan.own_count = 1;
    for (int i = 0; i < 8; ++i) {
        overdub *o;
        error err = {""};
        assert_true(overdub_create(&o, &bad[i], &err) < 0);
        assert_null(o);
        assert_true(err.text[0]);
    }
    hand_close(&h);
    show_close(s);
}

static int set_up(void **state)
{
    (void)state;
    error err = {""};
    snprintf(the.folder, sizeof the.folder, "/tmp/marotte_overdub_XXXXXX");
    assert_non_null(mkdtemp(the.folder));
    the.log = log_queue_create();
    static const char *const names[] = {"log", "one_hand"};
    for (int i = 0; i < 2; ++i) {
        char path[1024];
        snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, names[i]);
        must(plugin_list_add(&the.plugins, path, &err), &err);
    }
    must(face_file_read(&the.face, puppet, NULL, FACE_FILE_USABLE, &err), &err);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    char command[128];
    face_file_destroy(&the.face);
    plugin_list_destroy(&the.plugins);
    log_queue_destroy(the.log);
    snprintf(command, sizeof command, "rm -r %s", the.folder);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_layer_is_added_and_plays_as_it_was_performed),
        cmocka_unit_test(a_punch_changes_nothing_outside_in_and_out),
        cmocka_unit_test(a_loop_stacks_layers_of_which_the_last_is_heard),
        cmocka_unit_test(a_loop_that_is_left_in_a_pass_keeps_the_last_whole_one_heard),
        cmocka_unit_test(a_punch_that_is_left_early_fades_as_far_as_it_goes),
        cmocka_unit_test(at_half_speed_twice_as_much_is_performed),
        cmocka_unit_test(what_makes_no_sense_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
