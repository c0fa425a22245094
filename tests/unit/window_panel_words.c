/* ui/window/panels/devices.h: how an input is doing, in words; which devices are open. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/memory.h"
#include "stage/input/input.h"
#include "window/panels/devices.h"
#include "window/panels/engine.h"
#include "window/panels/mapping.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void each_state_has_a_light_and_words(void **state)
{
    (void)state;
    char words[DEVICES_WORDS], why[DEVICES_WORDS];
    health_report health = {.state = INPUT_RUNNING};
    assert_int_equal(devices_words_state(&health, words, why), DEVICES_WELL);
    assert_string_equal(words, "running");
    health.silence_s = 4.7;
    assert_int_equal(devices_words_state(&health, words, why), DEVICES_WAITS);
    assert_string_equal(words, "open, no samples for 4 s");
    health = (health_report){.state = INPUT_LOST, .state_s = 185.0, .words = "no such device"};
    assert_int_equal(devices_words_state(&health, words, why), DEVICES_WAITS);
    assert_string_equal(words, "disconnected for 3 min, retrying");
    assert_string_equal(why, "no such device");
    health.state = INPUT_FAILED;
    assert_int_equal(devices_words_state(&health, words, why), DEVICES_FAILED);
    health.state = INPUT_ENDED;
    assert_int_equal(devices_words_state(&health, words, why), DEVICES_OVER);
}

static void losses_are_told_when_there_are_any(void **state)
{
    (void)state;
    devices_fact fact[DEVICES_FACTS_MAX];
    health_report health = {.sample_count = 1000, .rate_hz = 150.0};
    uint32_t before = devices_words_facts(&health, fact);
    for (uint32_t i = 0; i < before; ++i)
        assert_false(fact[i].is_odd);
    assert_string_equal(fact[0].value, "150.0 Hz");
    health.gap_count = 3;
    health.refused_count = health.dropped_count = health.loss_count = 1;
    health.has_drift = true;
    health.drift_ppm = -900.0;
    uint32_t count = devices_words_facts(&health, fact);
    assert_int_equal(count, before + 4);
    assert_true(count <= DEVICES_FACTS_MAX);
    bool is_drift_odd = false;
    for (uint32_t i = 0; i < count; ++i)
        is_drift_odd |= fact[i].is_odd && strcmp(fact[i].value, "-900 ppm") == 0;
    assert_true(is_drift_odd);
}

static void saturated_channels_are_named(void **state)
{
    (void)state;
    static const mrt_channel channel[3] = {
        {.name = "index MPJ"}, {.name = "ring MPJ"}, {.name = "palm arch"}};
    char names[DEVICES_WORDS];
    health_report health = {.channel_count = 3, .saturated = {0.9f, 0.1f, 1.0f}};
    assert_int_equal(devices_words_saturated(&health, channel, 3, names), 2);
    assert_string_equal(names, "index MPJ, palm arch");
    health.saturated[0] = NAN;
    assert_int_equal(devices_words_saturated(&health, channel, 3, names), 1);
    static const char longest[] = "a name that is very long and said by a device that is not to be "
                                  "believed in what it says of itself, and so goes on";
    mrt_channel many[MRT_MAX_CHANNELS];
    health.channel_count = MRT_MAX_CHANNELS;
    for (int i = 0; i < MRT_MAX_CHANNELS; ++i) {
        many[i] = (mrt_channel){.name = longest};
        health.saturated[i] = 1.0f;
    }
    assert_int_equal(devices_words_saturated(&health, many, MRT_MAX_CHANNELS, names),
                     MRT_MAX_CHANNELS);
    assert_int_equal(strlen(names), DEVICES_WORDS - 1);
}

static void open_devices_are_known_by_their_address(void **state)
{
    (void)state;
    static const mrt_plugin_type type = {.id = "org.marotte.cyberglove"};
    const device_found found = {.type = &type,
                                .device = {.address = "/dev/ttyUSB0", .name = "CyberGlove"}};
    assert_true(devices_is_open("cyberglove:/dev/ttyUSB0", &found, false));
    assert_true(devices_is_open("org.marotte.cyberglove:/dev/ttyUSB0,baud=38400", &found, false));
    assert_false(devices_is_open("cyberglove:/dev/ttyUSB1", &found, true));
    assert_false(devices_is_open("cyberglove:/dev/ttyUSB", &found, true));
    assert_true(devices_is_open("cyberglove", &found, true));
    assert_false(devices_is_open("cyberglove,baud=38400", &found, false));
    assert_true(devices_is_open("cyberglove:", &found, true));
    assert_false(devices_is_open("cyber:/dev/ttyUSB0", &found, true));
    assert_false(devices_is_open("", &found, true));
}

static void an_address_that_cannot_be_written_is_not(void **state)
{
    (void)state;
    static const mrt_plugin_type type = {.id = "org.marotte.pedal"};
    device_found found = {.type = &type, .device = {.address = "usb:1-2"}};
    char text[64];
    assert_true(devices_input_text(&found, text, sizeof text));
    assert_string_equal(text, "pedal:usb:1-2");
    assert_false(devices_input_text(&found, text, 8));
    (void)snprintf(found.device.address, sizeof found.device.address, "a,b");
    assert_false(devices_input_text(&found, text, sizeof text));
}

/* ---- pedals of a mapping ---- */

static const mrt_param pedal_param[] = {
    {1, MRT_PARAM_STEPPED, "Anchor pedal", "Pedals", "", "", 0, 4, 1, NULL},
    {2, MRT_PARAM_STEPPED, "Hold pedal", "Pedals", "", "", 0, 4, 2, NULL},
    {3, 0, "Soft pedal", "Pedals", "", "", 0, 4, 2, NULL},
    {4, MRT_PARAM_STEPPED, "Bicycle pedal", "Pedals", "", "", 0, 40, 2, NULL},
    {5, MRT_PARAM_STEPPED, "pedal", "Pedals", "", "", 0, 4, 2, NULL},
};

static void pedal_parameters_are_known_by_name_and_range(void **state)
{
    (void)state;
    char meaning[PEDAL_MEANING];
    assert_true(pedal_table_meaning(&pedal_param[0], meaning));
    assert_string_equal(meaning, "Anchor");
    for (int i = 2; i < 5; ++i)
        assert_false(pedal_table_meaning(&pedal_param[i], meaning));
}

static void a_pedal_says_all_that_it_does(void **state)
{
    (void)state;
    static const mrt_plugin_type type = {.param_count = 5, .params = pedal_param};
    static const double values[5] = {3, 3, 3, 3, 3};
    char words[64], small[10];
    pedal_table_words(&type, values, 3, words, sizeof words);
    assert_string_equal(words, "Anchor, Hold");
    pedal_table_words(&type, values, 3, small, sizeof small);
    assert_string_equal(small, "Anchor, H");
    pedal_table_words(&type, values, 1, words, sizeof words);
    assert_string_equal(words, "");
}

/* ---- the engine ---- */

static void counters_that_are_zero_are_not_told(void **state)
{
    (void)state;
    engine_counter counter[ENGINE_COUNTERS_MAX];
    live_status *status = test_calloc(1, sizeof *status);
    assert_int_equal(engine_counters(status, counter), 0);
    status->counts.held_pulls = 2;
    status->counts.commits = 1;
    assert_int_equal(engine_counters(status, counter), 2);
    assert_string_equal(counter[0].label, "Held pulls");
    assert_true(counter[0].is_odd);
    assert_false(counter[1].is_odd);
    test_free(status);
}

static void times_take_three_digits(void **state)
{
    (void)state;
    static const double ms[] = {0.351, 9.996, 12.34, 99.96, 404.7, 1e9};
    static const char *const expected[] = {"0.35 ms", "10.0 ms", "12.3 ms",
                                           "100 ms",  "405 ms",  "minutes"};
    for (size_t i = 0; i < sizeof ms / sizeof ms[0]; ++i) {
        char words[ENGINE_MS];
        engine_ms(words, ms[i]);
        assert_string_equal(words, expected[i]);
    }
}

static void memory_is_known_here(void **state)
{
    (void)state;
    assert_true(memory_resident() > 1000000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_state_has_a_light_and_words),
        cmocka_unit_test(losses_are_told_when_there_are_any),
        cmocka_unit_test(saturated_channels_are_named),
        cmocka_unit_test(open_devices_are_known_by_their_address),
        cmocka_unit_test(an_address_that_cannot_be_written_is_not),
        cmocka_unit_test(pedal_parameters_are_known_by_name_and_range),
        cmocka_unit_test(a_pedal_says_all_that_it_does),
        cmocka_unit_test(counters_that_are_zero_are_not_told),
        cmocka_unit_test(times_take_three_digits),
        cmocka_unit_test(memory_is_known_here),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
