/* plugins/cyberglove: answers among bytes, sensors by masks (glove_parse.h). */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "glove_parse.h"

#include <string.h>

/* A string without its final 0. */
#define BYTES(text) (const unsigned char *)(text), sizeof(text) - 1

static void a_value_has_a_fixed_length_and_may_be_zero(void **state)
{
    (void)state;
    unsigned char value[4] = {9, 9, 9, 9};
    assert_int_equal(glove_reply_value(BYTES("?R\0\0"), 'R', value, 1), GLOVE_ANSWERED);
    assert_int_equal(value[0], 0);
    assert_int_equal(glove_reply_value(BYTES("?K\x7f\xff\x7f\0"), 'K', value, 3), GLOVE_ANSWERED);
    assert_memory_equal(value, "\x7f\xff\x7f", 3);
    assert_int_equal(glove_reply_value(BYTES("?T\0\0\0\0\0"), 'T', value, 4), GLOVE_ANSWERED);
    assert_int_equal(glove_reply_value(BYTES("?K\x7f\xff\x7f"), 'K', value, 3), GLOVE_SILENT);
    assert_int_equal(glove_reply_value(BYTES("?R\1"), 'R', value, 1), GLOVE_SILENT);
    assert_int_equal(glove_reply_value(BYTES(""), 'R', value, 1), GLOVE_SILENT);
}

static void an_answer_is_found_after_other_bytes(void **state)
{
    (void)state;
    unsigned char value[1];
    assert_int_equal(glove_reply_value(BYTES("S\x41\x42?\0\x03\0?G\x03\0"), 'G', value, 1),
                     GLOVE_ANSWERED);
    assert_int_equal(value[0], 3);
    assert_int_equal(glove_reply_value(BYTES("?R\1\0"), 'G', value, 1), GLOVE_SILENT);
}

static void refusals_are_understood(void **state)
{
    (void)state;
    unsigned char value[1];
    assert_int_equal(glove_reply_value(BYTES(" e?\r\n\0"), 'N', value, 1), GLOVE_REFUSED);
    assert_int_equal(glove_reply_done(BYTES(" e?\r\n\0"), 'D'), GLOVE_REFUSED);
    assert_int_equal(glove_reply_done(BYTES("e?\0"), 'D'), GLOVE_REFUSED);
    assert_int_equal(glove_reply_done(BYTES("en\r\n\0"), 't'), GLOVE_REFUSED);
    assert_int_equal(glove_reply_done(BYTES(" e?\r\n"), 'D'), GLOVE_SILENT);
    assert_int_equal(glove_reply_done(BYTES("the?\0"), 'D'), GLOVE_SILENT);
}

static void an_order_is_answered_by_its_letter(void **state)
{
    (void)state;
    assert_int_equal(glove_reply_done(BYTES("D\0"), 'D'), GLOVE_ANSWERED);
    assert_int_equal(glove_reply_done(BYTES("t\0"), 't'), GLOVE_ANSWERED);
    assert_int_equal(glove_reply_done(BYTES("T\0"), 't'), GLOVE_ANSWERED);
    assert_int_equal(glove_reply_done(BYTES("t 768 1\r\n\0"), 't'), GLOVE_ANSWERED);
    assert_int_equal(glove_reply_done(BYTES("t 768 1\r\n"), 't'), GLOVE_SILENT);
    assert_int_equal(glove_reply_done(BYTES("\x03\0U\0"), 'U'), GLOVE_ANSWERED);
    assert_int_equal(glove_reply_done(BYTES("D\0"), 'U'), GLOVE_SILENT);
}

/* ---- sensors ---- */

static glove_sensors sensors_of(glove_reported census)
{
    glove_sensors out = {0};
    assert_true(glove_sensors_find(&census, &out));
    return out;
}

static void masks_name_the_sensors(void **state)
{
    (void)state;
    glove_sensors all = sensors_of((glove_reported){22, GLOVE_MASK_22, GLOVE_MASK_22, 22});
    assert_int_equal(all.count, 22);
    for (uint32_t i = 0; i < 22; ++i)
        assert_int_equal(all.semantic[i], MRT_CH_ANGLE + i);
    glove_sensors fewer = sensors_of((glove_reported){18, GLOVE_MASK_18, 0, 0});
    assert_int_equal(fewer.count, 18);
    assert_int_equal(fewer.semantic[6], MRT_CH_ANGLE + 7);
    assert_int_equal(fewer.semantic[14], MRT_CH_ANGLE + 18);
    assert_int_equal(fewer.semantic[17], MRT_CH_ANGLE + 21);
}

static void the_software_mask_and_the_number_sent_leave_sensors_out(void **state)
{
    (void)state;
    glove_sensors thumb = sensors_of((glove_reported){22, GLOVE_MASK_22, 0x00000f, 22});
    assert_int_equal(thumb.count, 4);
    glove_sensors ten = sensors_of((glove_reported){22, GLOVE_MASK_22, GLOVE_MASK_22, 10});
    assert_int_equal(ten.count, 10);
    assert_int_equal(ten.semantic[9], MRT_CH_ANGLE + 9);
}

static void a_mask_in_the_other_byte_order_is_recognised(void **state)
{
    (void)state;
    glove_sensors s = sensors_of((glove_reported){18, 0x3FBB7B, 0x3FBB7B, 0});
    assert_int_equal(s.count, 18);
    assert_int_equal(s.semantic[6], MRT_CH_ANGLE + 7);
}

static void without_masks_the_number_tells(void **state)
{
    (void)state;
    assert_int_equal(sensors_of((glove_reported){18, 0, 0, 0}).count, 18);
    assert_int_equal(sensors_of((glove_reported){22, 0x000fff, 0, 0}).count, 22);
    glove_sensors out;
    const glove_reported unknown = {7, 0, 0, 0}, nothing = {0, 0, 0, 0};
    assert_false(glove_sensors_find(&unknown, &out));
    assert_false(glove_sensors_find(&nothing, &out));
}

static void unknown_sensors_have_no_meaning(void **state)
{
    (void)state;
    glove_sensors s = sensors_of((glove_reported){24, 0xFFFFFF, 0, 0});
    assert_int_equal(s.count, 24);
    assert_int_equal(s.semantic[7], MRT_CH_OTHER);
    assert_int_equal(s.semantic[23], MRT_CH_OTHER);
    assert_int_equal(s.semantic[22], MRT_CH_ANGLE + 21);
    assert_string_equal(glove_sensor_name(s.semantic[7]), "extra");
    assert_string_equal(glove_sensor_name(s.semantic[22]), "wrist.yaw");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_value_has_a_fixed_length_and_may_be_zero),
        cmocka_unit_test(an_answer_is_found_after_other_bytes),
        cmocka_unit_test(refusals_are_understood),
        cmocka_unit_test(an_order_is_answered_by_its_letter),
        cmocka_unit_test(masks_name_the_sensors),
        cmocka_unit_test(the_software_mask_and_the_number_sent_leave_sensors_out),
        cmocka_unit_test(a_mask_in_the_other_byte_order_is_recognised),
        cmocka_unit_test(without_masks_the_number_tells),
        cmocka_unit_test(unknown_sensors_have_no_meaning),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
