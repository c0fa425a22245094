/* pedal/descriptor.h: report descriptors of real devices, and bytes that are none. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "descriptor.h"

#include <stdio.h>
#include <string.h>

#define BYTES(...) (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__})

static descriptor parsed(const uint8_t *bytes, size_t size)
{
    descriptor out;
    char reason[DESCRIPTOR_REASON] = "";
    if (descriptor_parse(&out, bytes, size, reason) < 0)
        fail_msg("%s", reason);
    return out;
}

static void refused(const uint8_t *bytes, size_t size, const char *part)
{
    descriptor out;
    char reason[DESCRIPTOR_REASON] = "";
    assert_int_equal(descriptor_parse(&out, bytes, size, reason), MRT_ERR_FORMAT);
    if (!strstr(reason, part))
        fail_msg("expected \"%s\" in: %s", part, reason);
    assert_int_equal(out.field_count, 0);
}

/* The one with an output report of 35 bytes before its buttons. */
static void the_vec_descriptor_has_three_buttons(void **state)
{
    (void)state;
    descriptor d =
        parsed(BYTES(0x05, 0x0c, 0x09, 0x03, 0xa1, 0x01, 0x05, 0x08, 0x09, 0x4b, 0x75, 0x08, 0x95,
                     0x23, 0x91, 0x02, 0xc0, 0xa1, 0x02, 0x05, 0x09, 0x19, 0x01, 0x29, 0x03, 0x15,
                     0x00, 0x25, 0x01, 0x95, 0x03, 0x75, 0x01, 0x81, 0x02, 0x95, 0x01, 0x75, 0x05,
                     0x81, 0x01, 0x95, 0x01, 0x75, 0x08, 0x81, 0x01, 0xc0));
    assert_int_equal(d.field_count, 3);
    for (uint16_t i = 0; i < 3; ++i) {
        assert_int_equal(d.field[i].bit, i);
        assert_int_equal(d.field[i].width, 1);
        assert_int_equal(d.field[i].page, 9);
        assert_int_equal(d.field[i].usage, i + 1);
    }
    layout l = {0};
    assert_true(describe_switches(&l, &d));
    assert_int_equal(l.switch_count, 3);
    assert_string_equal(l.switches[2].name, "button 3");
    assert_true(describe_may_be_pedal(&d));
}

static void a_keyboards_keys_are_found(void **state)
{
    (void)state;
    descriptor d = parsed(BYTES(
        0x05, 0x01, 0x09, 0x06, 0xa1, 0x01, 0x85, 0x01, 0x05, 0x07, 0x19, 0xe0, 0x29, 0xe7, 0x15,
        0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0x95, 0x01, 0x75, 0x08, 0x81, 0x01,
        0x95, 0x05, 0x75, 0x08, 0x15, 0x00, 0x25, 0x65, 0x19, 0x00, 0x29, 0x65, 0x81, 0x00, 0xc0));
    assert_int_equal(d.field_count, 9);
    assert_int_equal(d.field[0].bit, 8); /* behind the report's number */
    assert_int_equal(d.field[0].usage, 0xe0);
    layout l = {0};
    assert_true(describe_keys(&l, &d));
    assert_int_equal(l.key_report_id, 1);
    assert_int_equal(l.key_at, 3);
    assert_int_equal(l.key_count, 5);
    assert_false(describe_switches(&l, &d));
    assert_false(describe_may_be_pedal(&d));
}

/* A wheel of 16 bits, then accelerator, brake and clutch that the device calls y, z and rz. */
static void the_axes_after_a_wheel_are_the_pedals(void **state)
{
    (void)state;
    descriptor d = parsed(BYTES(0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x15, 0x00, 0x25, 0x01, 0x75,
                                0x01, 0x95, 0x20, 0x05, 0x09, 0x19, 0x01, 0x29, 0x20, 0x81, 0x02,
                                0x05, 0x01, 0x27, 0xff, 0xff, 0x00, 0x00, 0x75, 0x10, 0x95, 0x04,
                                0x09, 0x30, 0x09, 0x31, 0x09, 0x32, 0x09, 0x35, 0x81, 0x02, 0xc0));
    layout l = {.axis_skip = 1};
    assert_true(describe_switches(&l, &d));
    assert_int_equal(l.switch_count, 4);
    for (uint16_t i = 0; i < 3; ++i) {
        assert_int_equal(l.switches[i].bit, 8 * (6 + 2 * i));
        assert_int_equal(l.switches[i].width, 16);
        assert_int_equal(l.switches[i].down, 65535);
    }
    assert_string_equal(l.switches[0].name, "axis y");
    assert_string_equal(l.switches[3].name, "button 1");
}

static void pedals_that_are_named_come_before_all_else(void **state)
{
    (void)state;
    descriptor d =
        parsed(BYTES(0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x15, 0x81, 0x25, 0x7f, 0x75, 0x08, 0x95,
                     0x01, 0x09, 0x30, 0x81, 0x02, 0x05, 0x02, 0x15, 0x00, 0x26, 0xff, 0x00, 0x09,
                     0xc5, 0x81, 0x02, 0x09, 0xc4, 0x81, 0x02, 0xc0));
    assert_int_equal(d.field[0].low, -127);
    assert_true(d.field[0].is_signed);
    layout l = {0};
    assert_true(describe_switches(&l, &d));
    assert_int_equal(l.switch_count, 2);
    assert_string_equal(l.switches[0].name, "brake");
    assert_string_equal(l.switches[1].name, "accelerator");
}

static void a_maximum_of_255_in_one_byte_is_meant(void **state)
{
    (void)state;
    descriptor d = parsed(
        BYTES(0x05, 0x01, 0x09, 0x30, 0x15, 0x00, 0x25, 0xff, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02));
    assert_int_equal(d.field_count, 1);
    assert_int_equal(d.field[0].high, 255);
}

static void reports_with_numbers_are_counted_apart(void **state)
{
    (void)state;
    descriptor d = parsed(BYTES(0x05, 0x09, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x02, 0x85,
                                0x01, 0x81, 0x02, 0x85, 0x02, 0x81, 0x02, 0x85, 0x01, 0x81, 0x02));
    assert_int_equal(d.field_count, 6);
    assert_int_equal(d.field[2].report_id, 2);
    assert_int_equal(d.field[2].bit, 8);
    assert_int_equal(d.field[4].report_id, 1);
    assert_int_equal(d.field[4].bit, 10);
}

static void states_are_pushed_and_popped(void **state)
{
    (void)state;
    descriptor d =
        parsed(BYTES(0x05, 0x09, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x01, 0xa4, 0x75, 0x03,
                     0x25, 0x07, 0x09, 0x05, 0x81, 0x02, 0xb4, 0x09, 0x06, 0x81, 0x02));
    assert_int_equal(d.field[0].width, 3);
    assert_int_equal(d.field[1].width, 1);
    assert_int_equal(d.field[1].bit, 3);
    assert_int_equal(d.field[1].usage, 6);
}

static void long_items_are_passed_over(void **state)
{
    (void)state;
    descriptor d = parsed(BYTES(0xfe, 0x02, 0x77, 0x81, 0x02, 0x05, 0x09, 0x15, 0x00, 0x25, 0x01,
                                0x75, 0x01, 0x95, 0x01, 0x81, 0x02));
    assert_int_equal(d.field_count, 1);
}

static void bytes_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    refused(BYTES(0x26, 0xff), "longer than the descriptor");
    refused(BYTES(0xfe, 0x09, 0x00, 0x01), "long item");
    refused(BYTES(0xfe), "long item");
    refused(BYTES(0xc0), "without a beginning");
    refused(BYTES(0xa1, 0x01), "the last collection has no end");
    refused(BYTES(0xb4), "without a push item");
    refused(BYTES(0xa4, 0xa4, 0xa4, 0xa4, 0xa4), "more than 4");
    refused(BYTES(0x85, 0x00), "outside 1..255");
    refused(BYTES(0x86, 0x00, 0x01), "outside 1..255");
    refused(BYTES(0x75, 0x01, 0x95, 0x01, 0x81, 0x02, 0x85, 0x01), "no report number");
    refused(BYTES(0x75, 0x08, 0x96, 0xff, 0xff, 0x81, 0x02), "longer than USB allows");
    refused(BYTES(0x77, 0xff, 0xff, 0xff, 0xff, 0x97, 0xff, 0xff, 0xff, 0xff, 0x81, 0x02),
            "longer than USB allows");
    refused(BYTES(0x0c), "does not define");
    refused(BYTES(0xd0), "does not define");
}

static void more_than_fits_is_left_out(void **state)
{
    (void)state;
    descriptor d = parsed(BYTES(0x05, 0x09, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x96, 0x00, 0x10,
                                0x81, 0x02, 0x95, 0x01, 0x81, 0x02));
    assert_int_equal(d.field_count, DESCRIPTOR_FIELDS);
    layout l = {0};
    assert_true(describe_switches(&l, &d));
    assert_int_equal(l.switch_count, LAYOUT_SWITCHES);
    static uint8_t endless[DESCRIPTOR_BYTES + 1];
    refused(endless, sizeof endless, "longer than 4096");
}

static void nothing_is_no_pedal(void **state)
{
    (void)state;
    descriptor d = parsed(NULL, 0);
    layout l = {0};
    assert_false(describe_switches(&l, &d));
    assert_false(describe_keys(&l, &d));
    assert_false(describe_may_be_pedal(&d));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_vec_descriptor_has_three_buttons),
        cmocka_unit_test(a_keyboards_keys_are_found),
        cmocka_unit_test(the_axes_after_a_wheel_are_the_pedals),
        cmocka_unit_test(pedals_that_are_named_come_before_all_else),
        cmocka_unit_test(a_maximum_of_255_in_one_byte_is_meant),
        cmocka_unit_test(reports_with_numbers_are_counted_apart),
        cmocka_unit_test(states_are_pushed_and_popped),
        cmocka_unit_test(long_items_are_passed_over),
        cmocka_unit_test(bytes_that_make_no_sense_are_refused),
        cmocka_unit_test(more_than_fits_is_left_out),
        cmocka_unit_test(nothing_is_no_pedal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
