/* What the lanes of a timeline show of a performance: where it moves the face, and when. */
#include "window/live_fixture.h"

#include "stage/playback/activity.h"
#include "stage/playback/sequencer.h"

static const writer_slate slate = {.scene = "1", .shot = "a"};

typedef struct lanes {
    show *show;
    performer *scratch;
    replay_world world;
    activity *of;
} lanes;

static void open_lanes(live_fixture *d, lanes *out, int64_t performance)
{
    error err = {""};
    const performer_settings of_rig = {.rezero_pedal = 0};
    fixture_must(show_open(&out->show, d->show_path, SHOW_READ, &err), &err);
    fixture_must(performer_create(&out->scratch, &d->face, NULL, &of_rig, &err), &err);
    out->world = (replay_world){
        .show = out->show, .plugins = &d->plugins, .log = d->log, .scratch = out->scratch};
    fixture_must(activity_create(&out->of, &out->world, performance, TAKE_WHOLE, &err), &err);
}

static void close_lanes(lanes *l)
{
    activity_destroy(l->of);
    performer_destroy(l->scratch);
    show_close(l->show);
}

static uint32_t step_all(lanes *l)
{
    error err = {""};
    uint32_t steps = 0;
    mrt_result result;
    while ((result = activity_step(l->of, 4, &err)) == MRT_OK)
        steps += 1;
    fixture_must(result, &err);
    return steps;
}

static float greatest(const lanes *l, uint32_t lane, int64_t from_ns, int64_t to_ns)
{
    activity_bin bin[50];
    float out = -INFINITY;
    activity_read(l->of, lane, from_ns, to_ns, 50, bin);
    for (int i = 0; i < 50; ++i)
        if (bin[i].least <= bin[i].greatest)
            out = fmaxf(out, bin[i].greatest);
    return out;
}

static void lanes_tell_when_and_where(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    live_status status;
    lanes l;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.5);
    int64_t drag_ns = clock_now_ns();
    fixture_drag(&d, POINTER_PULLS, fixture_contact(&d, "mouth.corner.l"), (vec3){0, 6, 0}, false);
    int64_t go_ns = clock_now_ns();
    fixture_let_go(&d);
    fixture_must(live_record_end(d.live, &err), &err);
    fixture_must(writer_flush(recorder_writer(d.live->recorder), &err), &err);
    live_status_of(d.live, &status);
    fixture_take(&d, status.take, &t);
    open_lanes(&d, &l, t.layer[0].clip[0].performance);
    assert_true(step_all(&l) >= 2);
    int64_t known_ns = activity_known_ns(l.of);
    show_performance p;
    fixture_must(show_performance_read(l.show, t.layer[0].clip[0].performance, &p, &err), &err);
    int64_t offset_ns = recorder_show_ns(d.live->recorder, 0) - p.from_ns;
    int64_t from_ns = drag_ns + offset_ns, to_ns = go_ns + offset_ns;
    show_performance_finish(&p);
    int64_t slack_ns = NS_PER_S / 20;
    assert_true(greatest(&l, OWN_MOUTH, from_ns, to_ns) > 0.1f);
    assert_true(greatest(&l, OWN_REGION_COUNT, from_ns, to_ns) > 0.1f);
    assert_true(greatest(&l, OWN_MOUTH, 0, from_ns - slack_ns) < 1e-3f);
    assert_true(greatest(&l, OWN_MOUTH, known_ns - slack_ns, known_ns) < 1e-3f);
    assert_true(greatest(&l, OWN_BROWS, 0, known_ns) < 1e-3f);
    activity_bin beyond;
    activity_read(l.of, OWN_MOUTH, known_ns + NS_PER_S, known_ns + 2 * NS_PER_S, 1, &beyond);
    assert_true(beyond.least > beyond.greatest);
    /* it goes on when the performance does */
    fixture_drag(&d, POINTER_PULLS, fixture_contact(&d, "brow.mid.l"), (vec3){0, 6, 0}, false);
    fixture_let_go(&d);
    fixture_must(writer_flush(recorder_writer(d.live->recorder), &err), &err);
    (void)step_all(&l);
    assert_true(activity_known_ns(l.of) > known_ns);
    assert_true(greatest(&l, OWN_BROWS, known_ns, activity_known_ns(l.of)) > 0.1f);
    close_lanes(&l);
    take_finish(&t);
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lanes_tell_when_and_where),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
