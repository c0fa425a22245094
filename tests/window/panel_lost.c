/* The device panel while a device is away: it is not for long, by a clock of the test's own. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "panel_stand.h"

static void a_lost_device_is_said_calmly_and_comes_back(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "tests/plugin/flaky");
    stand_input(&s, "flaky:port:1-2,run=0.2,away=1.5,losses=1");
    stand_wait_for(&s, "disconnected for 1 s, retrying");
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_devices_lost");
    stand_wait_for(&s, "running");
    assert_false(stand_shows(&s, "disconnected for"));
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lost_device_is_said_calmly_and_comes_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
