/* hand/virtualhand.h: calibrations of VirtualHand 1.x, and what is none. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/sensor.h"
#include "hand/virtualhand.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char calibration[] = "VHv1.6\n"
                                  "! Virtex CbGlove (TM) -> Virtual Hand calibration file\r\n"
                                  "!\n"
                                  "GLOVE CALIBRATION follows:\n"
                                  "! joint, offset, gain, gesture\n"
                                  "FINGER 0:\n"
                                  "  0     74    0.01600     0\n"
                                  "  1     80    0.01420     0\n"
                                  "  2    100    0.01850     0\n"
                                  "  3    200    0.00900     0\n"
                                  "FINGER 1:\n"
                                  "  0     79    0.01480     0\n"
                                  "  1     67   -0.01300     0\n"
                                  "  2     50    0.40000     0\n"
                                  "  3     50    0.00500     0\n"
                                  "FINGER 2:\n"
                                  "  0     99    0.01940     0\n"
                                  "  1     70    0.01620     0\n"
                                  "  2     74    0.01230     0\n"
                                  "  3    169    0.50000     0\n"
                                  "FINGER 3:\n"
                                  "  0     87    0.02170     0\n"
                                  "  1     65    0.01860     0\n"
                                  "  2     62    0.01260     0\n"
                                  "  3    188    0.00570     0\n"
                                  "FINGER 4:\n"
                                  "  0     91    0.02660     0\n"
                                  "  1     70    0.01780     0\n"
                                  "  2     98    0.01240     0\n"
                                  "  3    140    0.01030\n"
                                  "FINGER 5:\n"
                                  "  0    103    0.00900     0\n"
                                  "  1   -122    0.01480     0\n" /* 134 in its lowest byte */
                                  "  2     90    0.00680     0\n"
                                  "  3     50    0.40000     0\n"
                                  "! E_O_CAL\n!\n";

static const char geometry_before[] = "3D HAND GEOMETRY follows:\n"
                                      "! This geometry is for a:\n"
                                      "LEFT HAND.\n"
                                      "  0.00   0.00  -5.00\n"
                                      "     5      4  45.00   0.00\n";

/* Every finger alike: knuckle 9 cm from the wrist, then 4, 3 and 2 cm. */
static const char finger[] = "! Finger\n1\n"
                             "  0.00   9.00   0.00   1.00\n"
                             "  0.00  13.00   0.00   0.90\n"
                             "  0.00  13.00   3.00   0.80\n"
                             "  0.00  15.00   3.00   0.70\n";

static const char geometry_after[] = "! pisiform\n  1 2 3\n  1 2 3\n  1 2 3\n  1 2 3\n  1 2 3\n"
                                     "  1 2 3\n  1 2 3\n  1 2 3\n! E_O_GEO\n!\n";

static char *whole(void)
{
    char *text = malloc(8192);
    assert_non_null(text);
    (void)snprintf(text, 8192, "%s%s%s%s%s%s%s%s", calibration, geometry_before, finger, finger,
                   finger, finger, finger, geometry_after);
    return text;
}

static mrt_result parse(calibration_file *out, const char *text, uint32_t side, error *err)
{
    return virtualhand_parse(out, text, strlen(text), "user.cal", side, err);
}

static float read_angle(const calibration_file *file, int sensor, double raw)
{
    return (float)hand_table_value(&file->sensor[sensor].table, raw);
}

/* angle = gain * (raw - offset), flexion counting up and spreads counting down; the thumb's roll is
 * 0 for a thumb at rest, which is 0.6 rad for us. */
static void gains_become_tables_in_our_directions(void **state)
{
    (void)state;
    char *text = whole();
    calibration_file file;
    error err = {""};
    assert_int_equal(parse(&file, text, MRT_NO_HAND, &err), MRT_OK);
    assert_float_equal(read_angle(&file, SENSOR_INDEX_MPJ, 79), 0.0f, 1e-6f);
    assert_float_equal(read_angle(&file, SENSOR_INDEX_MPJ, 129), 0.74f, 1e-5f);
    assert_float_equal(read_angle(&file, 5, 117), 0.65f, 1e-5f);
    assert_float_equal(read_angle(&file, SENSOR_THUMB_ROLL, 74), 0.6f, 1e-6f);
    assert_float_equal(read_angle(&file, SENSOR_THUMB_ROLL, 84), 0.76f, 1e-5f);
    assert_float_equal(read_angle(&file, SENSOR_THUMB_ABDUCTION, 150), 0.45f, 1e-5f);
    assert_float_equal(read_angle(&file, SENSOR_RING_MIDDLE_SPREAD, 178), 0.057f, 1e-5f);
    assert_float_equal(read_angle(&file, SENSOR_WRIST_PITCH, 144), 0.148f, 1e-5f);
    assert_float_equal(read_angle(&file, SENSOR_WRIST_YAW, 80), 0.068f, 1e-5f);
    assert_int_equal(file.sensor[SENSOR_INDEX_MPJ].source, CALIBRATION_IMPORTED);
    free(text);
}

/* The index finger's line holds it; the offset is the middle finger's. */
static void middle_spread_takes_its_gain_from_the_index_finger(void **state)
{
    (void)state;
    char *text = whole();
    calibration_file file;
    error err = {""};
    assert_int_equal(parse(&file, text, MRT_NO_HAND, &err), MRT_OK);
    assert_float_equal(read_angle(&file, SENSOR_MIDDLE_INDEX_SPREAD, 169), 0.0f, 1e-6f);
    assert_float_equal(read_angle(&file, SENSOR_MIDDLE_INDEX_SPREAD, 149), 0.1f, 1e-5f);
    free(text);
}

static void placeholders_are_left_out_and_said(void **state)
{
    (void)state;
    char *text = whole();
    calibration_file file;
    error err = {""};
    assert_int_equal(parse(&file, text, MRT_NO_HAND, &err), MRT_OK);
    assert_int_equal(file.sensor[6].table.count, 0); /* index end joint: estimated */
    assert_int_equal(calibration_file_sensor_count(&file), 21);
    assert_non_null(strstr(file.note, "index.dij: a gain of 0.4 rad per count is impossible"));
    free(text);
}

static void angles_stop_beyond_what_a_joint_can_do(void **state)
{
    (void)state;
    char *text = whole();
    calibration_file file;
    error err = {""};
    assert_int_equal(parse(&file, text, MRT_NO_HAND, &err), MRT_OK);
    /* Knuckles: -45 to 90 degrees and 15 more; 1.8326 and -1.0472 rad. */
    assert_float_equal(read_angle(&file, SENSOR_LITTLE_MPJ, 255), 1.8325957f, 1e-5f);
    assert_float_equal(read_angle(&file, SENSOR_LITTLE_MPJ, 1), -1.0471976f, 1e-5f);
    free(text);
}

static void geometry_gives_the_side_and_the_length(void **state)
{
    (void)state;
    char *text = whole();
    calibration_file file;
    error err = {""};
    assert_int_equal(parse(&file, text, MRT_RIGHT, &err), MRT_OK);
    assert_int_equal(file.side, MRT_LEFT); /* the file says so */
    assert_float_equal((float)file.hand_length_mm, 180.0f, 1e-3f);
    free(text);
}

static void without_geometry_somebody_has_to_say_the_side(void **state)
{
    (void)state;
    calibration_file file;
    error err = {""};
    assert_int_equal(parse(&file, calibration, MRT_RIGHT, &err), MRT_OK);
    assert_int_equal(file.side, MRT_RIGHT);
    assert_true(file.hand_length_mm == 0.0);
    assert_true(parse(&file, calibration, MRT_NO_HAND, &err) < 0);
    assert_non_null(strstr(err.text, "Use --hand left or --hand right"));
}

static void dcu_files_are_refused_with_the_reason(void **state)
{
    (void)state;
    calibration_file file;
    error err = {""};
    static const char dcu[] = "2.0 right\n0 1 2 3 4 5 74 7 8 0.016\n";
    assert_int_equal(parse(&file, dcu, MRT_RIGHT, &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "user.cal: line 1: expected \"VHv...\", found \"2.0 right\""));
    assert_non_null(strstr(err.text, "Device Configuration Utility"));
    assert_true(parse(&file, "", MRT_RIGHT, &err) < 0);
}

static void refused(const char *from, const char *to, const char *words)
{
    char *text = whole(), changed[8192];
    calibration_file file;
    error err = {""};
    const char *at = strstr(text, from);
    assert_non_null(at);
    (void)snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, to,
                   at + strlen(from));
    mrt_result result = parse(&file, changed, MRT_NO_HAND, &err);
    if (result >= 0 || !strstr(err.text, words))
        print_message("%s -> %s: %d %s\n", from, to, result, err.text);
    assert_true(result < 0);
    assert_non_null(strstr(err.text, words));
    assert_int_equal(calibration_file_sensor_count(&file), 0);
    free(text);
}

static void errors_name_the_line_and_what_was_expected(void **state)
{
    (void)state;
    refused(
        "FINGER 3:", "FINGER 2:", "line 21: expected \"FINGER 0:\" to \"FINGER 5:\", each once");
    refused("FINGER 3:", "FINGER 9:", "line 21: expected \"FINGER 0:\"");
    refused("FINGER 3:", "FINGER 3", "line 21: expected \"FINGER 0:\"");
    refused("FINGER 3:", "FIN", "line 21: expected GLOVE CALIBRATION, FINGER k:");
    refused("  1     80", "  2     80", "line 8: expected \"joint offset gain gesture\"");
    refused("  1     80    0.01420", "  1     80.5  0.01420", "line 8: expected \"joint offset");
    refused("0.01420     0", "nan     0", "line 8: expected \"joint offset");
    refused("0.01420     0", "1e9     0", "line 8: expected a gain");
    refused("0.01420     0", "0.01420 0 0", "line 8: expected \"joint offset");
    refused("GLOVE CAL", "! CAL", "line 6: expected GLOVE CALIBRATION");
    refused("LEFT HAND", "NO HAND", "line 40: expected \"RIGHT HAND.\" or \"LEFT HAND.\"");
    refused("     5      4", "     9      4", "line 42: expected fingers (5 or 6)");
    refused("     5      4", "     5     40", "joints (2 to 4)");
    refused("  0.00   9.00   0.00   1.00", "  0.00   9.00   0.00",
            "line 45: expected a joint's \"x y z radius\" in cm");
    refused("! E_O_GEO", "nonsense", "expected GLOVE CALIBRATION");
}

static void a_file_cut_short_is_refused(void **state)
{
    (void)state;
    char *text = whole();
    size_t calibrated = strlen(calibration), geometry = (size_t)(strstr(text, "! pisiform") - text);
    for (size_t size = 0; size < strlen(text); ++size) {
        calibration_file file;
        error err = {""};
        mrt_result result = virtualhand_parse(&file, text, size, "user.cal", MRT_RIGHT, &err);
        if (result >= 0) /* complete but for what follows what we need */
            assert_true((size > calibrated - 30 && size <= calibrated + 1) || size >= geometry - 8);
        else
            assert_true(err.text[0] != '\0');
    }
    free(text);
}

static void a_hand_that_was_never_calibrated_is_refused(void **state)
{
    (void)state;
    char text[2048] = "VHv1.6\nGLOVE CALIBRATION follows:\n";
    for (int k = 0; k < 6; ++k) {
        char part[160];
        (void)snprintf(part, sizeof part,
                       "FINGER %d:\n0 50 0.4 0\n1 50 0.4 0\n2 50 0.4 0\n3 50 0.4 0\n", k);
        (void)strncat(text, part, sizeof text - strlen(text) - 1);
    }
    calibration_file file;
    error err = {""};
    assert_true(parse(&file, text, MRT_RIGHT, &err) < 0);
    assert_non_null(strstr(err.text, "never calibrated"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gains_become_tables_in_our_directions),
        cmocka_unit_test(middle_spread_takes_its_gain_from_the_index_finger),
        cmocka_unit_test(placeholders_are_left_out_and_said),
        cmocka_unit_test(angles_stop_beyond_what_a_joint_can_do),
        cmocka_unit_test(geometry_gives_the_side_and_the_length),
        cmocka_unit_test(without_geometry_somebody_has_to_say_the_side),
        cmocka_unit_test(dcu_files_are_refused_with_the_reason),
        cmocka_unit_test(errors_name_the_line_and_what_was_expected),
        cmocka_unit_test(a_file_cut_short_is_refused),
        cmocka_unit_test(a_hand_that_was_never_calibrated_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
