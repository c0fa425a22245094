/* pedal/layouts.h, descriptor.h: the literal reports of every device in the table, and reports that
 * are none. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "descriptor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bit n of `held`: switch n is down. */
static void expect(uint16_t vendor, uint16_t product, const uint8_t *bytes, size_t size,
                   uint32_t held)
{
    const layout *known = layouts_find(vendor, product);
    assert_non_null(known);
    float value[LAYOUT_SWITCHES] = {0.5f, 0.5f, 0.5f, 0.5f};
    assert_true(decode_report(known, bytes, size, value));
    for (uint32_t i = 0; i < known->switch_count; ++i)
        assert_float_equal(value[i], (float)(held >> i & 1u), 0);
    for (uint32_t i = known->switch_count; i < LAYOUT_SWITCHES; ++i)
        assert_float_equal(value[i], 0.5f, 0);
}
#define EXPECT(vendor, product, held, ...)                                                         \
    expect(vendor, product, (const uint8_t[]){__VA_ARGS__},                                        \
           sizeof((const uint8_t[]){__VA_ARGS__}), held)

static void a_vec_pedal_is_three_bits(void **state)
{
    (void)state;
    for (uint8_t held = 0; held < 8; ++held)
        EXPECT(0x05f3, 0x00ff, held, held, 0);
    EXPECT(0x05f3, 0x00ff, 2, 0xfa, 0xff); /* the other bits are constant by the descriptor */
}

static void pcsensor_pedals_are_keys(void **state)
{
    static const uint16_t ids[][2] = {
        {0x0c45, 0x7403}, {0x0c45, 0x7404}, {0x413d, 0x2107}, {0x1a86, 0xe026}, {0x3553, 0xb001}};
    (void)state;
    for (size_t i = 0; i < sizeof ids / sizeof *ids; ++i) {
        EXPECT(ids[i][0], ids[i][1], 0, 1, 0, 0, 0, 0, 0, 0, 0);
        EXPECT(ids[i][0], ids[i][1], 1, 1, 0, 0, 4, 0, 0, 0, 0);
        EXPECT(ids[i][0], ids[i][1], 2, 1, 0, 0, 5, 0, 0, 0, 0);
        EXPECT(ids[i][0], ids[i][1], 4, 1, 0, 0, 6, 0, 0, 0, 0);
        EXPECT(ids[i][0], ids[i][1], 5, 1, 0, 0, 3, 1, 0, 0, 0); /* programmed to codes 1 2 3 */
        EXPECT(ids[i][0], ids[i][1], 0, 1, 0xff, 0xff, 9, 10, 11, 12, 13);
    }
}

static void olympus_pedals_use_the_third_byte(void **state)
{
    (void)state;
    EXPECT(0x07b4, 0x0202, 1, 0, 0, 8, 0, 0, 0, 0, 0);
    EXPECT(0x07b4, 0x0202, 2, 0, 0, 2, 0, 0, 0, 0, 0);
    EXPECT(0x07b4, 0x0218, 4, 0, 0, 4, 0, 0, 0, 0, 0);
    EXPECT(0x07b4, 0x0218, 7, 0xff, 0xff, 14, 0, 0, 0, 0, 0);
    assert_int_equal(layouts_find(0x07b4, 0x0202)->endpoint, 0x83);
}

static void philips_pedals_are_joysticks_of_four(void **state)
{
    (void)state;
    EXPECT(0x0911, 0x1844, 1, 1);
    EXPECT(0x0911, 0x1844, 2, 2);
    EXPECT(0x0911, 0x091a, 4, 4);
    EXPECT(0x0911, 0x091a, 15, 15, 0);
}

static void an_xkeys_pedal_has_a_head(void **state)
{
    (void)state;
    EXPECT(0x05f3, 0x042c, 1, 0, 1, 2);
    EXPECT(0x05f3, 0x042c, 2, 0, 1, 4);
    EXPECT(0x05f3, 0x042c, 4, 0, 1, 8, 0, 0);
    float value[LAYOUT_SWITCHES] = {0};
    const uint8_t other[] = {0, 2, 14};
    assert_false(decode_report(layouts_find(0x05f3, 0x042c), other, sizeof other, value));
}

static void an_elgato_pedal_is_a_byte_each(void **state)
{
    (void)state;
    EXPECT(0x0fd9, 0x0086, 1, 1, 0, 3, 0, 1, 0, 0);
    EXPECT(0x0fd9, 0x0086, 2, 1, 0, 3, 0, 0, 1, 0);
    EXPECT(0x0fd9, 0x0086, 7, 1, 0, 3, 0, 1, 1, 255);
}

static void keyboards_of_unknown_keys_are_one_switch(void **state)
{
    (void)state;
    EXPECT(0x0426, 0x3011, 1, 0, 0, 0x29, 0, 0, 0, 0, 0);
    EXPECT(0x055a, 0x0998, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    EXPECT(0x5131, 0x2019, 1, 0, 0, 0, 0, 0, 0, 0, 5);
}

static void what_is_too_short_says_nothing(void **state)
{
    (void)state;
    const uint8_t bytes[8] = {1, 0, 0, 4};
    size_t count;
    const layout *table = layouts_table(&count);
    for (size_t i = 0; i < count; ++i)
        for (size_t size = 0; size <= 8; ++size) {
            uint8_t *copy = malloc(size + 1); /* so that reading past the end is seen */
            memcpy(copy, bytes, size);
            float value[LAYOUT_SWITCHES] = {0};
            bool spoke = decode_report(&table[i], copy, size, value);
            assert_true(!spoke || size > 0);
            free(copy);
        }
    float value[LAYOUT_SWITCHES] = {1, 1, 1, 1};
    assert_false(decode_report(layouts_find(0x05f3, 0x00ff), bytes, 0, value));
    assert_false(decode_report(layouts_find(0x07b4, 0x0202), bytes, 2, value));
    assert_float_equal(value[0], 1, 0); /* what is not spoken of stays */
}

static void a_keyboard_that_has_lost_count_says_nothing(void **state)
{
    (void)state;
    const uint8_t lost[] = {1, 0, 0, 1, 1, 1, 1, 1}, other[] = {2, 0, 0, 4, 0, 0, 0, 0};
    float value[LAYOUT_SWITCHES] = {0};
    assert_false(decode_report(layouts_find(0x0c45, 0x7403), lost, sizeof lost, value));
    assert_false(decode_report(layouts_find(0x0c45, 0x7403), other, sizeof other, value));
}

static void numbers_are_little_endian_and_signed_where_said(void **state)
{
    (void)state;
    const uint8_t bytes[] = {0x12, 0xf4, 0xff, 0x80};
    int64_t number;
    assert_true(decode_number(bytes, 4, 4, 8, false, &number));
    assert_int_equal(number, 0x41);
    assert_true(decode_number(bytes, 4, 8, 12, true, &number));
    assert_int_equal(number, -12);
    assert_true(decode_number(bytes, 4, 0, 32, false, &number));
    assert_int_equal(number, 0x80fff412);
    assert_true(decode_number(bytes, 4, 0, 32, true, &number));
    assert_int_equal(number, (int64_t)0x80fff412 - 0x100000000);
    assert_false(decode_number(bytes, 4, 1, 32, false, &number));
    assert_false(decode_number(bytes, 4, UINT32_MAX, 8, false, &number));
    assert_false(decode_number(bytes, 4, 0, 33, false, &number));
    assert_false(decode_number(bytes, 4, 0, 0, false, &number));
}

static void an_axis_runs_from_up_to_down(void **state)
{
    (void)state;
    layout axis = {
        .switch_count = 1,
        .switches = {{.bit = 8, .width = 16, .is_signed = true, .up = 100, .down = -100}}};
    static const struct {
        uint8_t low, high;
        float value;
    } cases[] = {{100, 0, 0}, {0, 0, 0.5f}, {156, 255, 1}, {0xff, 0x7f, 0}, {0, 0x80, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const uint8_t bytes[] = {0, cases[i].low, cases[i].high};
        float value[LAYOUT_SWITCHES] = {0};
        assert_true(decode_report(&axis, bytes, sizeof bytes, value));
        assert_float_equal(value[0], cases[i].value, 1e-6f);
    }
    assert_true(layout_is_analogue(&axis.switches[0]));
    assert_false(layout_is_analogue(&layouts_find(0x0fd9, 0x0086)->switches[0]));
}

static void every_device_of_the_table_is_in_the_udev_rules(void **state)
{
    (void)state;
    static char rules[16384];
    FILE *file = fopen(SOURCE_DIR "/plugins/pedal/70-marotte.rules", "rb");
    assert_non_null(file);
    rules[fread(rules, 1, sizeof rules - 1, file)] = '\0';
    fclose(file);
    size_t count;
    const layout *table = layouts_table(&count);
    for (size_t i = 0; i < count; ++i) {
        char line[160];
        snprintf(line, sizeof line,
                 "\nSUBSYSTEM==\"usb\", ATTRS{idVendor}==\"%04x\", ATTRS{idProduct}==\"%04x\", "
                 "TAG+=\"uaccess\"\n",
                 table[i].vendor, table[i].product);
        if (!strstr(rules, line))
            fail_msg("missing in 70-marotte.rules: %s", line);
    }
}

static void the_table_says_things_once(void **state)
{
    (void)state;
    size_t count;
    const layout *table = layouts_table(&count);
    for (size_t i = 0; i < count; ++i) {
        assert_ptr_equal(layouts_find(table[i].vendor, table[i].product), &table[i]);
        assert_true(table[i].name[0] != '\0' && table[i].source != LAYOUT_OF_NOTHING);
        assert_true((table[i].switch_count > 0) == (table[i].source == LAYOUT_OF_TABLE));
        for (uint32_t k = 0; k < table[i].switch_count; ++k)
            assert_true(table[i].switches[k].name[0] != '\0');
    }
    assert_null(layouts_find(0x046d, 0xc077));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_vec_pedal_is_three_bits),
        cmocka_unit_test(pcsensor_pedals_are_keys),
        cmocka_unit_test(olympus_pedals_use_the_third_byte),
        cmocka_unit_test(philips_pedals_are_joysticks_of_four),
        cmocka_unit_test(an_xkeys_pedal_has_a_head),
        cmocka_unit_test(an_elgato_pedal_is_a_byte_each),
        cmocka_unit_test(keyboards_of_unknown_keys_are_one_switch),
        cmocka_unit_test(what_is_too_short_says_nothing),
        cmocka_unit_test(a_keyboard_that_has_lost_count_says_nothing),
        cmocka_unit_test(numbers_are_little_endian_and_signed_where_said),
        cmocka_unit_test(an_axis_runs_from_up_to_down),
        cmocka_unit_test(every_device_of_the_table_is_in_the_udev_rules),
        cmocka_unit_test(the_table_says_things_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
