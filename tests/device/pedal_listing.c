/* plugins/pedal: what is plugged in is listed without being touched, with what to do about it. */
#include "pedal_bench.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>
#include <stdlib.h>

static const uint8_t mouse_descriptor[] = {
    0x05, 0x01, 0x09, 0x02, 0xa1, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x03, 0x15, 0x00, 0x25,
    0x01, 0x95, 0x03, 0x75, 0x01, 0x81, 0x02, 0x95, 0x01, 0x75, 0x05, 0x81, 0x01, 0x05, 0x01,
    0x09, 0x30, 0x09, 0x31, 0x15, 0x81, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x02, 0x81, 0x06, 0xc0};
static const pedal_model MOUSE = {.vendor = 0x046d,
                                  .product = 0xc077,
                                  .name = "USB Optical Mouse",
                                  .endpoint = 0x81,
                                  .packet_bytes = 4,
                                  .report_descriptor = mouse_descriptor,
                                  .report_descriptor_bytes = sizeof mouse_descriptor};
static const uint8_t joystick_descriptor[] = {0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x05, 0x09,
                                              0x19, 0x01, 0x29, 0x08, 0x15, 0x00, 0x25, 0x01,
                                              0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0};
static const pedal_model JOYSTICK = {.vendor = 0x1234,
                                     .product = 0x0001,
                                     .name = "Eight Buttons",
                                     .endpoint = 0x81,
                                     .packet_bytes = 1,
                                     .report_descriptor = joystick_descriptor,
                                     .report_descriptor_bytes = sizeof joystick_descriptor};

static void pedals_are_listed_and_mice_are_not(void **state)
{
    pedal_bench bench;
    mrt_device device[4];
    pedal_model held = PCSENSOR;
    held.is_held = true;
    pedal_unit *unit = pedal_double_plug(*state, "1-10", 2, &VEC);
    pedal_double_plug(*state, "1-2", 3, &held);
    pedal_double_plug(*state, "1-3", 4, &MOUSE);
    pedal_double_plug(*state, "1-4", 5, &JOYSTICK);
    bench_create(&bench);
    assert_int_equal(bench.devices->list(bench.plugin, device, 4), 3);
    assert_string_equal(device[0].address, "usb:1-2");
    assert_int_equal(device[0].state, MRT_DEVICE_BUSY);
    assert_non_null(strstr(device[0].advice, "in use by"));
    assert_string_equal(device[1].address, "usb:1-4");
    assert_string_equal(device[1].name, "Eight Buttons");
    assert_int_equal(device[1].state, MRT_DEVICE_UNSURE);
    assert_non_null(strstr(device[1].advice, "devices --learn pedal:usb:1-4"));
    assert_string_equal(device[2].address, "usb:1-10");
    assert_string_equal(device[2].name, "VEC USB Footpedal");
    assert_int_equal(device[2].state, MRT_DEVICE_READY);
    assert_string_equal(device[2].advice, "");
    assert_int_equal(pedal_unit_state(unit).asked, 0);
    assert_true(pedal_unit_state(unit).has_kernel_driver);
    bench_destroy(&bench);
}

static void a_short_list_says_how_many_there_are(void **state)
{
    pedal_bench bench;
    mrt_device device = {.address = "untouched"};
    pedal_double_plug(*state, "1-2", 2, &VEC);
    pedal_double_plug(*state, "1-3", 3, &VEC);
    bench_create(&bench);
    assert_int_equal(bench.devices->list(bench.plugin, &device, 0), 2);
    assert_string_equal(device.address, "untouched");
    assert_int_equal(bench.devices->list(bench.plugin, &device, 1), 2);
    assert_string_equal(device.address, "usb:1-2");
    bench_destroy(&bench);
}

static void what_is_listed_can_be_opened_and_stays_ready(void **state)
{
    pedal_bench bench;
    mrt_device device, now;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    assert_false(bench.devices->current(bench.plugin, &now));
    assert_int_equal(bench.devices->list(bench.plugin, &device, 1), 1);
    assert_int_equal(bench_open(&bench, device.address), MRT_OK);
    assert_true(bench.devices->current(bench.plugin, &now));
    assert_string_equal(now.address, device.address);
    bench_expect(&bench, 0, 0, 0);
    uint32_t asked = pedal_unit_state(unit).asked;
    assert_int_equal(bench.devices->list(bench.plugin, &device, 1), 1);
    assert_int_equal(device.state, MRT_DEVICE_READY);
    assert_int_equal(pedal_unit_state(unit).asked, asked);
    REPORT(unit, 1, 0);
    bench_expect(&bench, 1, 0, 0);
    bench_destroy(&bench);
}

static void an_unknown_joystick_is_read_by_its_descriptor(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-4", 5, &JOYSTICK);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, "usb:1-4"), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 2);
    bench_expect(&bench, 0, 1, 0);
    bench_destroy(&bench);
}

/* An accelerator of ten bits, a brake of eight: what the device itself says. */
static void analogue_pedals_are_read_by_their_descriptor(void **state)
{
    static const uint8_t descriptor[] = {0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x05, 0x02, 0x09,
                                         0xc4, 0x15, 0x00, 0x26, 0xff, 0x03, 0x75, 0x0a, 0x95,
                                         0x01, 0x81, 0x02, 0x75, 0x06, 0x81, 0x03, 0x09, 0xc5,
                                         0x26, 0xff, 0x00, 0x75, 0x08, 0x81, 0x02, 0xc0};
    pedal_model pedals = {.vendor = 0x1209,
                          .product = 0x3100,
                          .name = "OpenSimHardware",
                          .endpoint = 0x81,
                          .packet_bytes = 8,
                          .report_descriptor = descriptor,
                          .report_descriptor_bytes = sizeof descriptor,
                          .is_unread = true};
    pedal_bench bench;
    mrt_sample sample;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &pedals);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    uint32_t count;
    const mrt_channel *channels = bench.input->channels(bench.plugin, &count);
    assert_int_equal(count, 2);
    assert_string_equal(channels[1].name, "brake");
    bench_expect(&bench, 0, 0, 0);
    for (int i = 1; i <= 4; ++i) { /* no debouncing holds an axis back */
        REPORT(unit, (uint8_t)(i * 255), (uint8_t)(i * 255 >> 8), (uint8_t)(i * 51));
        assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_OK);
        assert_float_equal(sample.value[0], (float)i * 255 / 1023, 1e-6f);
        assert_float_equal(sample.value[1], (float)i / 5, 1e-6f);
    }
    bench_destroy(&bench);
}

/* What went over the wire is written down on request. */
static void a_trace_holds_every_report(void **state)
{
    char path[600], text[4096] = "";
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    snprintf(path, sizeof path, "%s.trace.tmp", bench_config());
    setenv("MAROTTE_TRACE", path, 1);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 4, 0);
    bench_expect(&bench, 0, 0, 1);
    bench_destroy(&bench);
    unsetenv("MAROTTE_TRACE");
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    assert_non_null(strstr(text, " pedal < 04 00\n"));
    assert_non_null(strstr(text, " pedal < 05 0c 09 03 a1 01")); /* the report descriptor */
    remove(path);
}

static const struct CMUnitTest tests[] = {
    TEST(pedals_are_listed_and_mice_are_not),
    TEST(a_short_list_says_how_many_there_are),
    TEST(what_is_listed_can_be_opened_and_stays_ready),
    TEST(an_unknown_joystick_is_read_by_its_descriptor),
    TEST(analogue_pedals_are_read_by_their_descriptor),
    TEST(a_trace_holds_every_report),
};
BENCH_MAIN(tests)
