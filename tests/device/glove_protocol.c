/* device/glove_box.h: the emulated box says what the protocol's tables say, byte by byte. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "glove_box.h"

#include <string.h>

static const glove_model cg1 = {
    .sensor_count = 22, .is_right = true, .native_hz = 150, .baud = 115200};
static const glove_model cg2_left_18 = {
    .flavour = GLOVE_CG2, .sensor_count = 18, .native_hz = 90, .baud = 115200};

static glove_reply say(glove_box *box, const char *command, size_t size)
{
    glove_reply reply = {0};
    for (size_t i = 0; i < size; ++i)
        glove_box_receive(box, (uint8_t)command[i], &reply);
    return reply;
}

/* Command and reply are string literals that may hold zeros. */
#define ANSWERS(box, command, reply)                                                               \
    answers(box, command, sizeof(command) - 1, reply, sizeof(reply) - 1)

static void answers(glove_box *box, const char *command, size_t command_size, const char *expected,
                    size_t size)
{
    glove_reply reply = say(box, command, command_size);
    if (reply.size != size)
        fail_msg("%s: %zu bytes, not %zu", command, reply.size, size);
    assert_memory_equal(reply.bytes, expected, size);
}

static void queries_tell_what_the_glove_is(void **state)
{
    (void)state;
    glove_box box;
    glove_box_init(&box, &cg1);
    ANSWERS(&box, "?S", "?S\x16\0");
    ANSWERS(&box, "?K", "?K\x7f\xff\x7f\0");
    ANSWERS(&box, "?M", "?M\x7f\xff\x7f\0");
    ANSWERS(&box, "?N", "?N\x16\0");
    ANSWERS(&box, "?R", "?R\1\0");
    ANSWERS(&box, "?G", "?G\3\0");
    ANSWERS(&box, "?U", "?U\0\0");
    ANSWERS(&box, "?F", "?F\1\0");
    ANSWERS(&box, "?D", "?D\0\0");
    glove_box_init(&box, &cg2_left_18);
    ANSWERS(&box, "?S", "?S\x12\0");
    ANSWERS(&box, "?K", "?K\x3f\xbb\x7b\0");
    ANSWERS(&box, "?R", "?R\0\0");
}

static void the_old_unit_takes_every_setting(void **state)
{
    (void)state;
    glove_box box;
    glove_box_init(&box, &cg1);
    ANSWERS(&box, "D\1", "D\0");
    ANSWERS(&box, "?D", "?D\1\0");
    ANSWERS(&box, "u 1\r", "u\0");
    ANSWERS(&box, "?U", "?U\1\0");
    ANSWERS(&box, "t 768 1\r", "t\0");
    ANSWERS(&box, "?T", "?T\3\0\0\1\0");
    ANSWERS(&box, "T\4\x80\0\1", "T\0"); /* 1152 1 */
    assert_int_equal(glove_box_period_ns(&box), 10000000);
    ANSWERS(&box, "M\1\0\0", "M\0");
    uint32_t sent[GLOVE_SENSORS];
    assert_int_equal(glove_box_sent(&box, sent), 1);
    ANSWERS(&box, "P\0\x34\0", "P\0"); /* status, filter, time stamp */
    assert_true(box.status && box.filter && box.stamp && !box.switch_lights);
}

static void the_newer_gloves_refuse_what_their_tables_lack(void **state)
{
    (void)state;
    glove_box box;
    glove_box_init(&box, &cg2_left_18);
    ANSWERS(&box, "D\1", " e?\r\n\0");
    ANSWERS(&box, "N\x05", " e?\r\n\0");
    ANSWERS(&box, "t 768 1\r", " e?\r\n\0");
    ANSWERS(&box, "?T", "?T\0\0\0\0\0");
    ANSWERS(&box, "?N", " e?\r\n\0");
    ANSWERS(&box, "U\1", "U\0");
    assert_int_equal(glove_box_period_ns(&box), 1000000000 / 90);
}

static void control_characters_work_at_any_time(void **state)
{
    (void)state;
    glove_box box;
    glove_box_init(&box, &cg1);
    ANSWERS(&box, "t 76\3", "\3\0");
    ANSWERS(&box, "\t", "\t\0");
    ANSWERS(&box, "\r\n?G", "?G\3\0"); /* line ends alone are nothing */
    ANSWERS(&box, "U\1", "U\0");
    ANSWERS(&box, "\x12", "\x12\r\n\0");
    assert_false(box.status); /* restarted */
    assert_int_equal(say(&box, "\x12", 1).action, GLOVE_RESTART);
    glove_box_init(&box, &cg2_left_18);
    ANSWERS(&box, "\x12", "\x12\0");
}

static void nonsense_is_refused_by_name(void **state)
{
    (void)state;
    glove_box box;
    glove_box_init(&box, &cg1);
    ANSWERS(&box, "X", "e?\0");
    ANSWERS(&box, "?X", "e?\0");
    ANSWERS(&box, "D\2", "en\0");
    ANSWERS(&box, "t 768\r", "en\0");
    ANSWERS(&box, "t 0 1\r", "en\0");
    glove_box_init(&box, &cg2_left_18);
    ANSWERS(&box, "X", " e?\r\n\0");
}

static void a_command_of_any_length_ends(void **state)
{
    (void)state;
    glove_box box;
    glove_box_init(&box, &cg1);
    for (int i = 0; i < 1000; ++i)
        (void)say(&box, "t 1", 3);
    ANSWERS(&box, "\3", "\3\0");
    ANSWERS(&box, "?G", "?G\3\0");
}

static void fill(uint8_t *sensor)
{
    for (uint8_t i = 0; i < GLOVE_SENSORS; ++i)
        sensor[i] = (uint8_t)(10 + i);
}

static void records_hold_the_sensors_of_the_glove(void **state)
{
    (void)state;
    static const uint8_t of_18[] = {'S', 10, 11, 12, 13, 14, 15, 17, 18, 20,
                                    21,  22, 24, 25, 26, 28, 29, 30, 31, 0};
    uint8_t sensor[GLOVE_SENSORS], record[GLOVE_RECORD_MAX];
    glove_box box;
    fill(sensor);
    glove_box_init(&box, &cg1);
    assert_int_equal(glove_box_record(&box, 'G', sensor, 0, 0, record), 24);
    assert_int_equal(record[0], 'G');
    assert_memory_equal(record + 1, sensor, GLOVE_SENSORS);
    assert_int_equal(record[23], 0);
    glove_box_init(&box, &cg2_left_18);
    assert_int_equal(glove_box_record(&box, 'S', sensor, 0, 0, record), sizeof of_18);
    assert_memory_equal(record, of_18, sizeof of_18);
}

static void stamps_hold_no_zero_and_say_where_one_was(void **state)
{
    (void)state;
    static const uint8_t stamp[] = {0x80 | 1 << 1 | 1 << 3, 0x34, 1, 0x12, 1};
    uint8_t sensor[GLOVE_SENSORS], record[GLOVE_RECORD_MAX];
    glove_box box;
    fill(sensor);
    sensor[3] = 0;
    glove_box_init(&box, &cg1);
    box.stamp = box.status = box.wrist_switch = true;
    assert_int_equal(glove_box_record(&box, 'S', sensor, 0x120034, 0, record), 30);
    assert_memory_equal(record + 23, stamp, sizeof stamp);
    assert_int_equal(record[28], 1 << 7 | 1 << 0 | 1 << 1 | 1 << 2);
    for (int i = 0; i < 29; ++i)
        assert_int_not_equal(record[i], 0);
    box.model.has_bare_stamp_flags = true;
    (void)glove_box_record(&box, 'S', sensor, 0x01020304, 0, record);
    assert_int_equal(record[23], 0); /* which is why a reader must know how long a record is */
}

static void marks_stand_before_the_end(void **state)
{
    (void)state;
    uint8_t sensor[GLOVE_SENSORS], record[GLOVE_RECORD_MAX];
    glove_box box;
    fill(sensor);
    glove_box_init(&box, &cg1);
    size_t size =
        glove_box_record(&box, 'S', sensor, 0, GLOVE_MARK_FAST | GLOVE_MARK_UNPLUGGED, record);
    assert_int_equal(size, 28);
    assert_memory_equal(record + 23, "eseg", 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(queries_tell_what_the_glove_is),
        cmocka_unit_test(the_old_unit_takes_every_setting),
        cmocka_unit_test(the_newer_gloves_refuse_what_their_tables_lack),
        cmocka_unit_test(control_characters_work_at_any_time),
        cmocka_unit_test(nonsense_is_refused_by_name),
        cmocka_unit_test(a_command_of_any_length_ends),
        cmocka_unit_test(records_hold_the_sensors_of_the_glove),
        cmocka_unit_test(stamps_hold_no_zero_and_say_where_one_was),
        cmocka_unit_test(marks_stand_before_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
