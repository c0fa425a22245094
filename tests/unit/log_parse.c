/* plugins/log: what the parser takes, skips and refuses. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "log_parse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A recording's line at a time, all angles 0 but those named; 23 of them. */
#define ZEROS_10   "0 0 0 0 0 0 0 0 0 0 "
#define AT(second) "2014 11 28 08 33 " second " 1 " ZEROS_10 ZEROS_10 "0 0 0\n"

static const float TOLERANCE = 1e-6f;

static char reason[LOG_REASON];

static log_data *parsed_hand(const char *text, uint32_t hand)
{
    static log_data data;
    mrt_result result = log_parse(&data, text, strlen(text), hand, reason);
    if (result < 0)
        print_message("%s\n", reason);
    assert_int_equal(result, MRT_OK);
    return &data;
}

static log_data *parsed(const char *text)
{
    return parsed_hand(text, MRT_RIGHT);
}

static void assert_refused_bytes(const char *bytes, size_t size, const char *part_of_reason)
{
    log_data data;
    reason[0] = '\0';
    assert_true(log_parse(&data, bytes, size, MRT_RIGHT, reason) < 0);
    if (!strstr(reason, part_of_reason))
        fail_msg("expected \"%s\" in \"%s\"", part_of_reason, reason);
    assert_int_equal(data.record_count, 0);
    assert_null(data.value);
    log_data_finish(&data);
}

static void assert_refused(const char *text, const char *part_of_reason)
{
    assert_refused_bytes(text, strlen(text), part_of_reason);
}

/* ---- the log table ---- */

static void table_gives_channels_and_records(void **state)
{
    (void)state;
    log_data *d = parsed("# a comment\n"
                         "\n"
                         "time_s,right.index.mpj, left.thumb.roll ,pedal.2,right.wrist.qw,mood\n"
                         "0.5,0.25,-0.125,1,0.5,7e2\n"
                         "# another\n"
                         "0.51,0.5,.125,0,+1.,-3\n");
    assert_int_equal(d->channel_count, 5);
    assert_string_equal(d->channel[0].name, "right.index.mpj");
    assert_string_equal(d->channel[0].unit, "rad");
    assert_int_equal(d->channel[0].semantic, MRT_CH_ANGLE + 4);
    assert_int_equal(d->channel[0].hand, MRT_RIGHT);
    assert_int_equal(d->channel[1].semantic, MRT_CH_ANGLE + 0);
    assert_int_equal(d->channel[1].hand, MRT_LEFT);
    assert_int_equal(d->channel[2].semantic, MRT_CH_PEDAL + 1);
    assert_int_equal(d->channel[2].hand, MRT_NO_HAND);
    assert_int_equal(d->channel[3].semantic, MRT_CH_WRIST + 6);
    assert_int_equal(d->channel[4].semantic, MRT_CH_OTHER);
    assert_int_equal(d->record_count, 2);
    assert_int_equal(d->time_ns[0], 0);
    assert_int_equal(d->time_ns[1], 10000000);
    static const float expected[10] = {0.25f, -0.125f, 1, 0.5f, 700, 0.5f, 0.125f, 0, 1, -3};
    for (int i = 0; i < 10; ++i)
        assert_float_equal(d->value[i], expected[i], TOLERANCE);
    assert_int_equal(d->damaged_count, 0);
    log_data_finish(d);
}

static void all_sensors_have_their_place(void **state)
{
    (void)state;
    static const char *const names[MRT_ANGLES] = {
        "thumb.roll", "thumb.mpj",  "thumb.ij",    "thumb.abd",  "index.mpj",  "index.pij",
        "index.dij",  "middle.mpj", "middle.pij",  "middle.dij", "middle.abd", "ring.mpj",
        "ring.pij",   "ring.dij",   "ring.abd",    "little.mpj", "little.pij", "little.dij",
        "little.abd", "palm.arch",  "wrist.pitch", "wrist.yaw"};
    for (uint32_t i = 0; i < MRT_ANGLES; ++i) {
        char text[100];
        snprintf(text, sizeof text, "time_s,left.%s\n0,0\n", names[i]);
        log_data *d = parsed(text);
        assert_int_equal(d->channel[0].semantic, MRT_CH_ANGLE + i);
        assert_int_equal(d->channel[0].hand, MRT_LEFT);
        log_data_finish(d);
    }
}

static void faders_and_buttons_say_where_they_end(void **state)
{
    (void)state;
    log_data *d = parsed("time_s,fader 1,pitch,button.play,odd,worse\n"
                         "unit,0..1,-1..1,1,1..0,0..x\n"
                         "0,0.5,-0.5,1,3,4\n");
    assert_int_equal(d->channel[0].semantic, MRT_CH_OTHER);
    assert_float_equal(d->channel[0].min, 0.0f, 0);
    assert_float_equal(d->channel[0].max, 1.0f, 0);
    assert_float_equal(d->channel[1].min, -1.0f, 0);
    assert_int_equal(d->channel[2].semantic, MRT_CH_BUTTON);
    assert_float_equal(d->channel[2].max, 1.0f, 0);
    assert_string_equal(d->unit[3], "1..0"); /* no range: a unit like any other */
    assert_string_equal(d->unit[4], "0..x");
    log_data_finish(d);
}

static void units_are_turned_into_ours(void **state)
{
    (void)state;
    log_data *d = parsed("time_ns,right.index.mpj,left.index.mpj,right.wrist.x,pedal.1,heat\n"
                         "unit,deg,count,mm,,K\n"
                         "1000000000000000007,90,127,12.5,1,300\n"
                         "1000000000000000008,-180,255,-3,0,301\n");
    assert_string_equal(d->channel[0].unit, "rad");
    assert_string_equal(d->channel[1].unit, "count");
    assert_float_equal(d->channel[1].max, 255.0f, 0.0f);
    assert_string_equal(d->channel[2].unit, "mm");
    assert_string_equal(d->channel[4].unit, "K");
    assert_float_equal(d->value[0], 1.5707963f, TOLERANCE);
    assert_float_equal(d->value[5], -3.1415927f, TOLERANCE);
    assert_float_equal(d->value[1], 127.0f, 0.0f);
    assert_int_equal(d->time_ns[1], 1); /* ns are not rounded through a double */
    log_data_finish(d);
}

/* A camera's track that `marotte take log` wrote is filtered as the camera's. */
static void landmarks_keep_their_unit(void **state)
{
    (void)state;
    log_data *d = parsed("time_s,right.index.mpj,right.index.pij\n"
                         "unit,rad landmarks,rad landmarks\n"
                         "0,0.5,0.25\n");
    assert_string_equal(d->channel[0].unit, MRT_UNIT_LANDMARKS);
    assert_float_equal(d->value[0], 0.5f, 0.0f);
    log_data_finish(d);
    assert_refused("time_s,right.index.mpj,right.index.pij\nunit,rad,rad landmarks\n0,0,0\n",
                   "use two units: rad and rad landmarks");
}

static void line_ends_and_a_byte_order_mark_make_no_difference(void **state)
{
    (void)state;
    log_data *d = parsed("\xEF\xBB\xBFtime_s,pedal.1\r\nunit,1\r\n0,1\r\n\r\n1,0.5\r\n2,0");
    assert_int_equal(d->record_count, 3);
    assert_int_equal(d->damaged_count, 0);
    assert_float_equal(d->value[1], 0.5f, 0.0f);
    log_data_finish(d);
}

static void damaged_lines_are_left_out_and_counted(void **state)
{
    (void)state;
    log_data *d = parsed("time_s,right.index.mpj\n"
                         "0,0.1\n"
                         "1,zero\n" /* line 3 */
                         "2,0.2,0.3\n"
                         "3\n"
                         "4,\n"
                         "5,0.5\n"
                         "6,nan\n"
                         "seven,0.7\n"
                         "8,0x10\n"
                         "9,0.9\n"
                         "10,1\n11,1\n12,1\n13,1\n14,1\n");
    assert_int_equal(d->record_count, 8);
    assert_int_equal(d->damaged_count, 7);
    assert_int_equal(d->first_damaged_line, 3);
    assert_non_null(strstr(d->first_damage, "right.index.mpj"));
    log_data_finish(d);
}

static void huge_numbers_are_damage(void **state)
{
    (void)state;
    log_data *d =
        parsed("time_s,right.index.mpj,pedal.1\n"
               "0,0,0\n"
               "1,1e999999999,0\n"
               "2,7,0\n" /* more than a turn */
               "3,0,123456789012345678901234567890\n"
               "1e300,0,0\n"
               "4,0,0\n5,1e-400,0\n6,0,0.00000000000000000000000000000000000001\n7,0,0\n");
    assert_int_equal(d->record_count, 5);
    assert_int_equal(d->damaged_count, 4);
    for (size_t i = 0; i < d->record_count * d->channel_count; ++i)
        assert_true(isfinite(d->value[i]));
    assert_float_equal(d->value[4], 0.0f, 0.0f);
    log_data_finish(d);
}

static void time_running_backwards_is_damage_and_equal_times_are_not(void **state)
{
    (void)state;
    log_data *d = parsed("time_s,pedal.1\n1,0\n2,0.25\n2,0.5\n1.5,1\n2,0.75\n3,1\n");
    assert_int_equal(d->record_count, 5);
    assert_int_equal(d->damaged_count, 1);
    assert_int_equal(d->first_damaged_line, 5);
    assert_int_equal(d->time_ns[1], d->time_ns[2]);
    assert_float_equal(d->value[1], 0.25f, 0.0f);
    assert_float_equal(d->value[2], 0.5f, 0.0f);
    assert_float_equal(d->value[3], 0.75f, 0.0f);
    log_data_finish(d);
}

static void time_far_ahead_is_damage(void **state)
{
    (void)state;
    log_data *d = parsed("time_s,pedal.1\n0,0\n99999999,1\n1,0\n");
    assert_int_equal(d->record_count, 2);
    assert_int_equal(d->damaged_count, 1);
    log_data_finish(d);
    d = parsed(
        "time_ns,pedal.1\n-4000000000000000000,0\n4000000000000000000,0\n-3999999999999999999,0\n");
    assert_int_equal(d->record_count, 2);
    log_data_finish(d);
}

static void more_than_half_damaged_is_refused(void **state)
{
    (void)state;
    log_data *d = parsed("time_s,pedal.1\n0,0\n1,x\n");
    assert_int_equal(d->damaged_count, 1);
    log_data_finish(d);
    assert_refused("time_s,pedal.1\n0,0\n1,x\n2,x\n", "2 of 3 records are damaged, first line 3");
}

static void too_many_columns_are_refused(void **state)
{
    (void)state;
    char text[2000] = "time_s", record[200] = "\n0";
    for (int i = 0; i < MRT_MAX_CHANNELS; ++i) {
        char column[20];
        snprintf(column, sizeof column, ",column%d", i);
        strcat(text, column);
        strcat(record, ",0");
    }
    char whole[2300];
    snprintf(whole, sizeof whole, "%s%s\n", text, record);
    log_data *d = parsed(whole);
    assert_int_equal(d->channel_count, MRT_MAX_CHANNELS);
    log_data_finish(d);
    snprintf(whole, sizeof whole, "%s,one_more%s,0\n", text, record);
    assert_refused(whole, "more than 64 columns");
    assert_refused(whole, "one_more");
}

static void headers_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    assert_refused("right.index.mpj,time_s\n0,0\n", "time_s or time_ns, not \"right.index.mpj\"");
    assert_refused("time_s\n0\n", "no column besides the time");
    assert_refused("time_s,pedal.1,pedal.1\n0,0,0\n", "two columns have the name \"pedal.1\"");
    assert_refused("time_s,,pedal.1\n0,0,0\n", "column 2");
    assert_refused("time_s,a_name_that_is_quite_a_bit_longer_than_allowed\n0,0\n", "39 letters");
    assert_refused("0,0\n1,0\n", "header row");
}

static void units_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    assert_refused("time_s,right.index.mpj\nunit,furlong\n0,0\n",
                   "rad, deg, count or rad landmarks");
    assert_refused("time_s,right.index.mpj\nunit\n0,0\n", "0 units for 1 columns");
    assert_refused("time_s,right.index.mpj\nunit,rad,rad\n0,0\n", "more units than columns");
    assert_refused("time_s,right.wrist.x\nunit,inch\n0,0\n", "right.wrist.x");
    assert_refused("time_s,right.index.mpj,right.index.pij\nunit,rad,count\n0,0,0\n", "one hand");
}

static void what_is_no_log_is_refused(void **state)
{
    (void)state;
    assert_refused("", "empty");
    assert_refused("# only\n\n# comments\n", "empty");
    assert_refused("time_s,pedal.1\n", "no records");
    assert_refused("Dear Sir or Madam,\nthank you\n", "expected a log");
    assert_refused("<html>\n", "expected a log");
    assert_refused("1 2 3\n4 5 6\n", "expected 30 numbers");
    assert_refused_bytes("glTF\2\0\0\0data", 12, "not text");
    assert_refused_bytes("\0", 1, "not text");
}

/* ---- the recordings of GraspDB14 ---- */

static void recording_gives_22_angles_in_sensor_order(void **state)
{
    (void)state;
    log_data *d = parsed_hand(AT("09.90100") AT("09.91600"), MRT_LEFT);
    assert_int_equal(d->channel_count, MRT_ANGLES);
    assert_true(d->is_hand_assumed);
    for (uint32_t i = 0; i < MRT_ANGLES; ++i) {
        assert_int_equal(d->channel[i].semantic, MRT_CH_ANGLE + i);
        assert_int_equal(d->channel[i].hand, MRT_LEFT);
        assert_string_equal(d->channel[i].unit, "rad");
    }
    assert_string_equal(d->channel[3].name, "left.thumb.abd");
    assert_int_equal(d->time_ns[1], 15000000);
    log_data_finish(d);
}

/* a1 = 0.01, a2 = 0.02 .. a23 = 0.23, by the table of plugins/log/README.md. */
static void recording_has_our_signs_and_zeros(void **state)
{
    (void)state;
    char line[400] = "2014 11 28 08 33 09.901 1";
    for (int i = 1; i <= 23; ++i) {
        char word[20];
        snprintf(word, sizeof word, " %.2f", 0.01 * i);
        strcat(line, word);
    }
    static const float expected[MRT_ANGLES] = {
        -0.01f,        -0.02f,
        -0.03f,        0.04f + 0.55f, /* thumb: roll, MPJ, IJ, abduction */
        -0.05f,        -0.06f,
        -0.07f, /* index */
        -0.09f,        -0.10f,
        -0.11f,        0.2f - (0.08f - 0.12f), /* middle, middle-index */
        -0.13f,        -0.14f,
        -0.15f,        0.1f + (0.16f - 0.12f), /* ring, ring-middle */
        -0.17f,        -0.18f,
        -0.19f,        0.1f + (0.20f - 0.16f), /* little, little-ring */
        -0.21f - 0.3f, -0.22f - 0.2f,
        0.23f - 0.1f}; /* arch, wrist pitch, yaw */
    log_data *d = parsed(line);
    for (int i = 0; i < MRT_ANGLES; ++i)
        assert_float_equal(d->value[i], expected[i], TOLERANCE);
    log_data_finish(d);
}

static void recording_goes_on_over_midnight_and_new_year(void **state)
{
    (void)state;
    log_data *d = parsed("2014 11 28 23 59 59.990 1 " ZEROS_10 ZEROS_10 "0 0 0\n"
                         "2014 11 29 00 00 00.006 1 " ZEROS_10 ZEROS_10 "0 0 0\n");
    assert_int_equal(d->time_ns[1], 16000000);
    log_data_finish(d);
    d = parsed("2015 12 31 23 59 59.990 1 " ZEROS_10 ZEROS_10 "0 0 0\n"
               "2016 01 01 00 00 00.006 1 " ZEROS_10 ZEROS_10 "0 0 0\n");
    assert_int_equal(d->time_ns[1], 16000000);
    log_data_finish(d);
    d = parsed("2016 02 28 23 59 59.990 1 " ZEROS_10 ZEROS_10 "0 0 0\n"
               "2016 02 29 00 00 00.006 1 " ZEROS_10 ZEROS_10 "0 0 0\n"
               "2016 03 01 00 00 00.000 1 " ZEROS_10 ZEROS_10 "0 0 0\n");
    assert_int_equal(d->time_ns[1], 16000000);
    assert_int_equal(d->time_ns[2], INT64_C(86400010000000));
    log_data_finish(d);
}

static void damaged_recording_lines_are_left_out(void **state)
{
    (void)state;
    log_data *d = parsed(AT("09.90") AT("09.91") AT("09.92") "2014 11 28 08 33 09.93 1 0 0 0\n" AT(
        "09.89") AT("61.5") AT("nine") AT("09.94"));
    assert_int_equal(d->record_count, 4);
    assert_int_equal(d->damaged_count, 4);
    assert_int_equal(d->first_damaged_line, 4);
    assert_non_null(strstr(d->first_damage, "not 10"));
    log_data_finish(d);
    d = parsed(AT("09.90") "2014 13 28 08 33 10 1 " ZEROS_10 ZEROS_10 "0 0 0\n");
    assert_non_null(strstr(d->first_damage, "date or time"));
    log_data_finish(d);
    d = parsed(AT("09.90") "2014 11 28 08 33 10 1 " ZEROS_10 ZEROS_10 "0 0 6.5\n");
    assert_non_null(strstr(d->first_damage, "angle 23"));
    log_data_finish(d);
}

static void cut_anywhere_a_log_is_read_or_refused(void **state)
{
    (void)state;
    static const char table[] = "time_s,right.index.mpj,pedal.1\nunit,deg,1\n0,-1.5e1,0\n1,2,1\n";
    static const char recording[] = AT("09.90") AT("09.91");
    const char *const texts[2] = {table, recording};
    for (int k = 0; k < 2; ++k)
        for (size_t size = 0; size <= strlen(texts[k]); ++size) {
            char *copy = malloc(size + 1); /* exactly as long: reading on would be seen */
            assert_non_null(copy);
            memcpy(copy, texts[k], size);
            log_data d;
            (void)log_parse(&d, copy, size, MRT_RIGHT, reason);
            log_data_finish(&d);
            free(copy);
        }
}

/* ---- numbers ---- */

static void assert_number(const char *text, double expected)
{
    double value = -1.0;
    assert_true(log_text_number((log_text){text, text + strlen(text)}, &value));
    if (value != expected)
        fail_msg("%s gave %.17g", text, value);
}

static void decimal_numbers_are_exact(void **state)
{
    (void)state;
    assert_number("0.1", 0.1);
    assert_number("-0.90288", -0.90288);
    assert_number("+12.5e-3", 0.0125);
    assert_number("1e22", 1e22);
    assert_number(".5", 0.5);
    assert_number("5.", 5.0);
    assert_number("000000000000000000000000000001.5", 1.5);
    assert_number("0.30000000000000000000000000000000000", 0.3);
    assert_number("-0", 0.0);
    static const char *const wrong[] = {"",    "-",   ".",   "e5",  "1e",  "1e+", "1.2.3",
                                        "0x1", "inf", "nan", "1 2", "--1", "1e31"};
    double value;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i)
        assert_false(log_text_number((log_text){wrong[i], wrong[i] + strlen(wrong[i])}, &value));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_gives_channels_and_records),
        cmocka_unit_test(all_sensors_have_their_place),
        cmocka_unit_test(faders_and_buttons_say_where_they_end),
        cmocka_unit_test(units_are_turned_into_ours),
        cmocka_unit_test(landmarks_keep_their_unit),
        cmocka_unit_test(line_ends_and_a_byte_order_mark_make_no_difference),
        cmocka_unit_test(damaged_lines_are_left_out_and_counted),
        cmocka_unit_test(huge_numbers_are_damage),
        cmocka_unit_test(time_running_backwards_is_damage_and_equal_times_are_not),
        cmocka_unit_test(time_far_ahead_is_damage),
        cmocka_unit_test(more_than_half_damaged_is_refused),
        cmocka_unit_test(too_many_columns_are_refused),
        cmocka_unit_test(headers_that_make_no_sense_are_refused),
        cmocka_unit_test(units_that_make_no_sense_are_refused),
        cmocka_unit_test(what_is_no_log_is_refused),
        cmocka_unit_test(recording_gives_22_angles_in_sensor_order),
        cmocka_unit_test(recording_has_our_signs_and_zeros),
        cmocka_unit_test(recording_goes_on_over_midnight_and_new_year),
        cmocka_unit_test(damaged_recording_lines_are_left_out),
        cmocka_unit_test(cut_anywhere_a_log_is_read_or_refused),
        cmocka_unit_test(decimal_numbers_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
