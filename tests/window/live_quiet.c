/* While it performs, a live stage allocates nothing: neither its frame thread, nor its inputs', nor
 * the window's that looks. While nothing moves, whoever comes is told the face that is there. */
#include "unit/allocation_count.h"
#include "window/live_fixture.h"

static void performing_allocates_nothing(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    char text[FIXTURE_PATH];
    if (!ALLOCATIONS_ARE_COUNTED)
        skip();
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,start=3", SOURCE_DIR);
    fixture_must(fixture_add_input(&d, text, &err), &err);
    uint32_t corner = fixture_contact(&d, "mouth.corner.l");
    vec3 rest = fixture_rest(&d, corner);
    fixture_pass(&d, 0.5);
    uint64_t samples, before = atomic_load(&allocation_count);
    live_status_of(d.live, &status);
    samples = status.sample_count;
    for (int i = 0; i < 200; ++i) {
        fixture_frame(&d);
        live_status_of(d.live, &status);
        fixture_point(&d, i < 150 ? POINTER_PULLS : POINTER_AWAY, rest,
                      vec3_add(rest, (vec3){0, 0.02 * (double)i, 0}), false);
    }
    uint64_t count = atomic_load(&allocation_count) - before;
    assert_true(status.sample_count > samples + 100);
    assert_true(status.frame_count > 10);
    if (count > 0)
        fail_msg("%u allocations", (unsigned)count);
    fixture_finish(&d);
}

/* Nobody is at the socket: it is sent all the same. */
static bool is_sent(live_fixture *d, void *data)
{
    (void)data;
    output_status s;
    outputs_status(live_outputs(d->live), 0, &s);
    return s.sent > 0;
}

static void an_output_that_is_opened_on_a_still_face_sends_it(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char path[FIXTURE_PATH];
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    snprintf(path, sizeof path, "%s/plugins/vmc.so", BUILD_DIR);
    fixture_must(plugin_list_add(&d.plugins, path, &err), &err);
    fixture_pass(&d, 0.3); /* the first face has been shown */
    fixture_must(outputs_add(live_outputs(d.live), "vmc:127.0.0.1:9", &err), &err);
    assert_true(fixture_until(&d, is_sent, NULL));
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(performing_allocates_nothing),
        cmocka_unit_test(an_output_that_is_opened_on_a_still_face_sends_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
