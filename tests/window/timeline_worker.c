/* What is read beside the timeline, of a show that was really recorded: curves, sound, other takes.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "unit/sequencer_scene.h"
#include "window/timeline/worker.h"

static film *shot;
static const int64_t patience_ns = 600 * NS_PER_S;

static char face_path[512];

static int shoot(void **state)
{
    (void)state;
    static const scene_play play = {.mapping = "one_hand", .face = "puppet", .params = ""};
    snprintf(face_path, sizeof face_path, "%s/rigs/puppet/puppet.rig.json", SOURCE_DIR);
    shot = film_shoot(&play, FILM_DEMO, "start=3,end=7", 0.0);
    return 0;
}

static int burn(void **state)
{
    (void)state;
    film_burn(shot);
    return 0;
}

static timeline_worker *open_worker(void)
{
    timeline_worker *worker = timeline_worker_create(&shot->plugins);
    assert_non_null(worker);
    timeline_worker_set_show(worker, shot->path, face_path);
    return worker;
}

/* Of the whole take, in 200 bins. */
static void request_of_take(timeline_request *out, const take *t, uint32_t lanes)
{
    const take_clip *clip = &t->layer[0].clip[0];
    timeline_strip strip = {.clip = clip->id,
                            .performance = clip->performance,
                            .from_ns = clip->from_ns,
                            .to_ns = clip->to_ns,
                            .lanes = lanes,
                            .bin_count = 200};
    timeline_request_clear(out);
    assert_true(timeline_request_add(out, &strip));
}

/* What there is once nothing more comes. */
static const timeline_result *wait_for(timeline_worker *worker, const timeline_request *request)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    timeline_worker_request(worker, request);
    while (clock_now_ns() < until_ns) {
        const timeline_result *result = timeline_worker_result(worker);
        if (result->is_complete && result->strip_count == request->strip_count &&
            memcmp(result->strip, request->strip, request->strip_count * sizeof *request->strip) ==
                0 &&
            result->audio == request->audio)
            return result;
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
    fail_msg("nothing came in %d s", (int)(patience_ns / NS_PER_S));
    return NULL;
}

static void the_curve_of_a_take_becomes_known(void **state)
{
    (void)state;
    static timeline_request request;
    take t;
    film_take(shot, &t);
    timeline_worker *worker = open_worker();
    request_of_take(&request, &t, 1u << (ACTIVITY_LANES - 1));
    const timeline_result *result = wait_for(worker, &request);
    assert_string_equal(result->note, "");
    const timeline_strip *strip = timeline_result_strip(result, 0, t.layer[0].clip[0].id);
    assert_non_null(strip);
    float most = 0.0f, least = 1e9f;
    uint32_t unknown = 0;
    for (uint32_t i = 0; i < strip->bin_count; ++i) {
        const activity_bin *bin = &result->bin[strip->first_bin + i];
        unknown += bin->least > bin->greatest;
        most = fmaxf(most, bin->greatest);
        least = fminf(least, bin->least);
    }
    assert_in_range(unknown, 0, 2);
    assert_true(most > 0.01f && most < 20.0f);
    assert_true(least >= 0.0f && least < most);
    timeline_worker_destroy(worker);
    take_finish(&t);
}

static void parts_of_the_face_have_curves_of_their_own(void **state)
{
    (void)state;
    static timeline_request request;
    take t;
    film_take(shot, &t);
    timeline_worker *worker = open_worker();
    float sum[2] = {0.0f, 0.0f};
    static const uint32_t lanes[2] = {1u << OWN_JAW, 1u << OWN_BROWS};
    for (int k = 0; k < 2; ++k) {
        request_of_take(&request, &t, lanes[k]);
        const timeline_result *result = wait_for(worker, &request);
        for (uint32_t i = 0; i < 200; ++i)
            sum[k] += fmaxf(result->bin[i].greatest, 0.0f);
    }
    assert_true(sum[0] > 0.5f);
    assert_true(sum[1] < 0.01f * sum[0]);
    timeline_worker_destroy(worker);
    take_finish(&t);
}

static void sound_is_outlined(void **state)
{
    (void)state;
    enum { FRAMES = 48000 };
    static int16_t frames[FRAMES];
    static timeline_request request;
    error err = {""};
    show_audio about = {.rate_hz = 48000, .channel_count = 1, .format = "s16"};
    int64_t id;
    snprintf(about.name, sizeof about.name, "boom");
    for (int i = 0; i < FRAMES; ++i)
        frames[i] = (int16_t)(i >= FRAMES / 2 ? (i % 2 ? 16384 : -16384) : 0);
    scene_must(show_audio_create(shot->show, &about, &id, &err), &err);
    scene_must(show_audio_write(shot->show, id, 0, frames, sizeof frames, &err), &err);
    timeline_worker *worker = open_worker();
    timeline_request_clear(&request);
    request.audio = id;
    request.audio_to = FRAMES;
    request.audio_pairs = 100;
    const timeline_result *result = wait_for(worker, &request);
    assert_true(result->has_wave);
    assert_string_equal(result->about.name, "boom");
    assert_int_equal(result->about.frame_count, FRAMES);
    assert_in_range(result->wave.count, 10, 100);
    assert_float_equal(result->wave.pair[0].greatest, 0.0f, 1e-6f);
    assert_float_equal(result->wave.pair[result->wave.count - 1].greatest, 0.5f, 1e-3f);
    assert_float_equal(result->wave.pair[result->wave.count - 1].least, -0.5f, 1e-3f);
    timeline_worker_destroy(worker);
}

static void other_takes_of_the_slate_are_found(void **state)
{
    (void)state;
    static timeline_request request;
    error err = {""};
    take t;
    int64_t other, elsewhere;
    film_take(shot, &t);
    show_span span = {.performance = shot->performance,
                      .from_ns = t.start_ns,
                      .to_ns = t.start_ns + t.duration_ns,
                      .is_shown = true};
    show_new_take made = {.created_ns = t.start_ns,
                          .start_ns = t.start_ns,
                          .end_ns = t.start_ns + t.duration_ns,
                          .scene = "1",
                          .shot = "a",
                          .origin = "again",
                          .spans = &span,
                          .span_count = 1};
    scene_must(show_take_create(shot->show, &made, &other, &err), &err);
    made.shot = "b";
    scene_must(show_take_create(shot->show, &made, &elsewhere, &err), &err);
    timeline_worker *worker = open_worker();
    timeline_request_clear(&request);
    request.comps_of = shot->take_id;
    request.comps_edition = 1;
    snprintf(request.scene, sizeof request.scene, "1");
    snprintf(request.shot, sizeof request.shot, "a");
    timeline_worker_request(worker, &request);
    const timeline_comps *comps = NULL;
    for (int64_t until_ns = clock_now_ns() + patience_ns; clock_now_ns() < until_ns && !comps;) {
        const timeline_comps *found = timeline_worker_comps(worker);
        comps = found && found->of == shot->take_id ? found : NULL;
    }
    assert_non_null(comps);
    assert_int_equal(comps->count, 1);
    assert_int_equal(comps->take[0].id, other);
    assert_int_equal(comps->take[0].layer[0].clip[0].performance, shot->performance);
    timeline_worker_destroy(worker);
    take_finish(&t);
}

static void what_cannot_be_read_is_noted(void **state)
{
    (void)state;
    static timeline_request request;
    take t;
    film_take(shot, &t);
    timeline_worker *worker = timeline_worker_create(&shot->plugins);
    assert_non_null(worker);
    timeline_worker_set_show(worker, "/nowhere/none.marotte", face_path);
    request_of_take(&request, &t, 1);
    const timeline_result *result = wait_for(worker, &request);
    assert_non_null(strstr(result->note, "/nowhere/none.marotte"));
    assert_true(result->bin[0].least > result->bin[0].greatest);
    timeline_worker_set_show(worker, shot->path, "/nowhere/none.rig.json");
    request_of_take(&request, &t, 2);
    (void)wait_for(worker, &request);
    timeline_worker_set_show(worker, NULL, NULL);
    timeline_worker_destroy(worker); /* at once */
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_curve_of_a_take_becomes_known),
        cmocka_unit_test(parts_of_the_face_have_curves_of_their_own),
        cmocka_unit_test(sound_is_outlined),
        cmocka_unit_test(other_takes_of_the_slate_are_found),
        cmocka_unit_test(what_cannot_be_read_is_noted),
    };
    return cmocka_run_group_tests(tests, shoot, burn);
}
