/* What a mapping that did not come with the program has performed is on the stage: its take is
 * performed again, and whatever it does then, the stage goes on. */
#include "window/live_fixture.h"

static const writer_slate slate = {.scene = "1", .shot = "a"};

static void set_trouble(live_fixture *d, const char *kind)
{
    error err = {""};
    fixture_must(instance_set_text(live_mapping(d->live), "trouble", kind, &err), &err);
}

/* The mapping goes wrong in the middle of it. */
static void record(live_fixture *d, const char *kind, take *out)
{
    error err = {""};
    live_status status;
    set_trouble(d, "None");
    fixture_must(live_record(d->live, &slate, &err), &err);
    fixture_perform(d, 0.3);
    set_trouble(d, kind);
    fixture_perform(d, 0.3);
    set_trouble(d, "None");
    fixture_must(live_record_end(d->live, &err), &err);
    live_status_of(d->live, &status);
    fixture_take(d, status.take, out);
}

static bool stands_at(live_fixture *d, void *data)
{
    const int64_t *at_ns = data;
    return d->view->mode == LIVE_SHOWS && d->view->at_ns == *at_ns;
}

static void take_of_a_mapping_that_goes_wrong_is_shown(const char *kind)
{
    live_fixture d;
    error err = {""};
    char hand[FIXTURE_PATH];
    take t = {0};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    fixture_must(plugin_list_add(&d.plugins, BUILD_DIR "/tests/plugin/troubled.so", &err), &err);
    fixture_must(live_set_mapping(d.live, "troubled", &err), &err);
    snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(&d, hand, &err), &err);
    fixture_perform(&d, 0.3);
    record(&d, kind, &t);
    fixture_must(live_show_take(d.live, &t, &err), &err);
    live_seek(d.live, t.duration_ns);
    assert_true(fixture_until(&d, stands_at, &t.duration_ns));
    live_seek(d.live, 0);
    assert_true(fixture_until(&d, stands_at, &(int64_t){0}));
    live_show_hands(d.live);
    fixture_perform(&d, 0.2);
    take_finish(&t);
    fixture_finish(&d);
}

static void take_of_a_mapping_that_crashes_is_shown(void **state)
{
    (void)state;
    take_of_a_mapping_that_goes_wrong_is_shown("Crash");
}

static void take_of_a_mapping_that_hangs_is_shown(void **state)
{
    (void)state;
    take_of_a_mapping_that_goes_wrong_is_shown("Hang");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(take_of_a_mapping_that_crashes_is_shown),
        cmocka_unit_test(take_of_a_mapping_that_hangs_is_shown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
