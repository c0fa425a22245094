/* While it performs, a live stage allocates nothing: neither its frame thread, nor its inputs', nor
 * the window's that looks. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(performing_allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
