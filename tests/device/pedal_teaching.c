/* plugins/pedal: a device that nobody knows is taught once, and is a pedal from then on. */
#include "pedal_bench.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>

/* Four bytes of the maker's own: nothing says what they are. */
static const uint8_t vendor_descriptor[] = {0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01,
                                            0x09, 0x02, 0x15, 0x00, 0x26, 0xff, 0x00,
                                            0x75, 0x08, 0x95, 0x04, 0x81, 0x02, 0xc0};
static const pedal_model UNKNOWN = {.vendor = 0x1234,
                                    .product = 0x0001,
                                    .name = "Foot Controller",
                                    .endpoint = 0x82,
                                    .packet_bytes = 4,
                                    .report_descriptor = vendor_descriptor,
                                    .report_descriptor_bytes = sizeof vendor_descriptor};

/* Reads until the log says this: 3 s at most. */
static void read_until(pedal_bench *bench, const char *part)
{
    mrt_sample sample;
    int64_t until_ns = bench_now_ns() + 3000 * BENCH_MS;
    while (!bench_has_said(bench, part)) {
        if (bench_now_ns() > until_ns)
            fail_msg("expected \"%s\" after: %s", part, bench->text[0]);
        mrt_result result = bench_read(bench, 20 * BENCH_MS, &sample);
        assert_true(result >= 0);
        for (uint32_t i = 0; result == MRT_OK && i < sample.count; ++i)
            assert_float_equal(sample.value[i], 0, 0); /* nothing is performed meanwhile */
        bench->params[BENCH_LEARN] = 0;                /* a trigger is 1 for one call */
    }
    bench_forget(bench);
}

static void begin(pedal_bench *bench)
{
    bench_forget(bench);
    bench->params[BENCH_LEARN] = 1;
    read_until(bench, "learn: take your feet off");
    read_until(bench, "learn: press and release switch 1");
}

static void teach_two(pedal_bench *bench, pedal_unit *unit)
{
    begin(bench);
    REPORT(unit, 9, 0, 0x10, 0);
    REPORT(unit, 9, 0, 0, 0);
    read_until(bench, "press and release switch 2");
    REPORT(unit, 9, 0, 0x01, 0);
    REPORT(unit, 9, 0, 0, 0);
    read_until(bench, "press and release switch 3");
    REPORT(unit, 9, 0, 0x10, 0);
    REPORT(unit, 9, 0, 0, 0);
    read_until(bench, "learn: done: 2 switches of Foot Controller");
}

static void an_unknown_device_is_taught_and_then_known(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &UNKNOWN);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_ERR_IO);
    assert_int_equal(bench_open(&bench, "usb:1234:0001"), MRT_OK);
    assert_true(bench_has_said(&bench, "devices --learn pedal:usb:1-2"));
    uint32_t count;
    const mrt_channel *channels = bench.input->channels(bench.plugin, &count);
    assert_int_equal(count, 1);
    assert_int_equal(channels[0].semantic, MRT_CH_OTHER);
    teach_two(&bench, unit);
    assert_int_equal(bench.restart_count, 1); /* it has other channels now */
    bench_close(&bench);
    bench_destroy(&bench);

    bench_create(&bench); /* the next day */
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    channels = bench.input->channels(bench.plugin, &count);
    assert_int_equal(count, 2);
    assert_int_equal(channels[1].semantic, MRT_CH_PEDAL + 1);
    assert_string_equal(channels[1].name, "switch 2");
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 9, 0, 0x01, 0);
    bench_expect(&bench, 0, 1, 0);
    REPORT(unit, 9, 0, 0x11, 0);
    bench_expect(&bench, 1, 1, 0);
    bench_destroy(&bench);
}

static void a_stored_lesson_that_was_damaged_is_named(void **state)
{
    pedal_bench bench;
    mrt_device device;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &UNKNOWN);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, "usb:1-2"), MRT_OK);
    teach_two(&bench, unit);
    bench_close(&bench);
    char path[600];
    snprintf(path, sizeof path, "%s/marotte/pedals/1234_0001.layout", bench_config());
    FILE *file = fopen(path, "ab");
    assert_non_null(file);
    fputs("and so on\n", file);
    fclose(file);
    assert_int_equal(bench.devices->list(bench.plugin, &device, 1), 1);
    assert_int_equal(device.state, MRT_DEVICE_UNSURE);
    assert_non_null(strstr(device.advice, "1234_0001.layout: line 7"));
    bench_destroy(&bench);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_ERR_IO);
    assert_true(bench_has_said(&bench, "1234_0001.layout: line 7"));
    assert_int_equal(bench_open(&bench, "usb:1-2"), MRT_OK); /* to be taught again */
    bench_destroy(&bench);
}

static void a_keyboard_pedal_with_other_keys_is_taught(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &PCSENSOR);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    begin(&bench);
    static const uint8_t keys[] = {0x3a, 0x3b, 0x3c, 0x3a}; /* F1 F2 F3, F1 again */
    static const char *const news[] = {"press and release switch 2", "press and release switch 3",
                                       "press and release switch 4", "learn: done: 3"};
    for (int i = 0; i < 4; ++i) {
        REPORT(unit, 1, 2, 0, keys[i], 0, 0, 0, 0); /* with shift: the key says more */
        REPORT(unit, 1, 0, 0, 0, 0, 0, 0, 0);
        read_until(&bench, news[i]);
    }
    assert_int_equal(bench.restart_count, 0); /* three as before: it goes on at once */
    REPORT(unit, 1, 0, 0, 0x3c, 0, 0, 0, 0);
    bench_expect(&bench, 0, 0, 1);
    bench_destroy(&bench);
}

static void a_device_that_goes_while_it_is_taught_ends_it(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    begin(&bench);
    pedal_unit_unplug(unit, EPROTO);
    while (bench_read(&bench, 100 * BENCH_MS, &sample) != MRT_ERR_IO)
        ;
    assert_true(bench_has_said(&bench, "learn: given up"));
    bench_destroy(&bench);
}

static void a_held_switch_is_up_while_switches_are_taught(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = bench_begin(&bench, *state);
    REPORT(unit, 1, 0);
    bench_expect(&bench, 1, 0, 0);
    bench.params[BENCH_LEARN] = 1;
    bench_expect(&bench, 0, 0, 0);
    bench_destroy(&bench);
}

static void a_lesson_can_be_asked_for_with_the_address(void **state)
{
    pedal_bench bench;
    pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    bench.params[BENCH_LEARN] = 1;
    assert_int_equal(bench_open(&bench, "usb:1-2"), MRT_OK);
    bench.params[BENCH_LEARN] = 0;
    bench_expect(&bench, 0, 0, 0);
    assert_true(bench_has_said(&bench, "learn: take your feet off"));
    bench_destroy(&bench);
}

static const struct CMUnitTest tests[] = {
    TEST(an_unknown_device_is_taught_and_then_known),
    TEST(a_stored_lesson_that_was_damaged_is_named),
    TEST(a_keyboard_pedal_with_other_keys_is_taught),
    TEST(a_device_that_goes_while_it_is_taught_ends_it),
    TEST(a_lesson_can_be_asked_for_with_the_address),
    TEST(a_held_switch_is_up_while_switches_are_taught),
};
BENCH_MAIN(tests)
