/* hand/calibration_file.h and calibration_folder.h: a person's calibration, read strictly and
 * written whole. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/calibration_folder.h"
#include "hand/sensor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char good[] =
    "{\"marotte_calibration\": 1, \"name\": \"anna\", \"date\": \"2026-03-01T18:00:00Z\","
    " \"hand\": \"left\", \"sensor_count\": 2, \"hand_length_mm\": 182.5, \"shoe\": [7],"
    " \"sensors\": {"
    "  \"index.mpj\": {\"source\": \"measured\", \"points\": [[62, 0], [148, 1.571], [200, 1.6]],"
    "   \"neutral_rad\": 0.42, \"raw_range\": [58, 150], \"rad_range\": [-0.07, 1.6],"
    "   \"residual_rad\": 0.03, \"cross_talk\": {\"middle.mpj\": 0.21}, \"colour\": \"red\"},"
    "  \"middle.abd\": {\"source\": \"zeroed\", \"points\": [[100, 0.3], [150, 0]]}}}";

static mrt_result parse(calibration_file *out, const char *text, error *err)
{
    return calibration_file_parse(out, text, strlen(text), "anna.json", err);
}

static void reads_all_that_is_there(void **state)
{
    (void)state;
    calibration_file file;
    error err = {""};
    assert_int_equal(parse(&file, good, &err), MRT_OK);
    assert_string_equal(file.name, "anna");
    assert_string_equal(file.date, "2026-03-01T18:00:00Z");
    assert_int_equal(file.side, MRT_LEFT);
    assert_true(file.hand_length_mm == 182.5);
    assert_int_equal(calibration_file_sensor_count(&file), 2);
    const calibration_sensor *sensor = &file.sensor[SENSOR_INDEX_MPJ];
    assert_int_equal(sensor->source, CALIBRATION_MEASURED);
    assert_int_equal(sensor->table.count, 3);
    assert_true(sensor->table.raw[1] == 148.0f && sensor->table.rad[1] == 1.571f);
    assert_true(sensor->has_range && sensor->raw_range[1] == 150.0f);
    assert_true(sensor->has_residual && sensor->residual_rad == 0.03f);
    assert_true(sensor->cross_talk[SENSOR_MIDDLE_MPJ] == 0.21f);
    assert_true(sensor->neutral_rad == 0.42f);
    sensor = &file.sensor[SENSOR_MIDDLE_INDEX_SPREAD];
    assert_false(sensor->has_range || sensor->has_residual);
    assert_true(sensor->neutral_rad == sensor_table[SENSOR_MIDDLE_INDEX_SPREAD].neutral_rad);
    assert_non_null(strstr(file.note, "anna.json: $.shoe: unknown key"));
    assert_non_null(strstr(file.note, "$.sensors[\"index.mpj\"].colour"));
    calibration_file_finish(&file);
}

static void what_is_written_reads_the_same_and_keeps_unknown_keys(void **state)
{
    (void)state;
    calibration_file file, again;
    error err = {""};
    assert_int_equal(parse(&file, good, &err), MRT_OK);
    file.sensor[SENSOR_INDEX_MPJ].table.rad[1] = 0.6f;
    file.sensor[SENSOR_MIDDLE_INDEX_SPREAD].table.count = 0; /* another glove */
    (void)snprintf(file.name, sizeof file.name, "bea \"b\"");
    char *text = calibration_file_text(&file);
    assert_non_null(text);
    assert_non_null(strstr(text, "\"shoe\": [7]"));
    assert_non_null(strstr(text, "\"colour\": \"red\""));
    assert_non_null(strstr(text, "[148.0, 0.6]"));
    assert_null(strstr(text, "middle.abd"));
    assert_int_equal(parse(&again, text, &err), MRT_OK);
    assert_string_equal(again.name, "bea \"b\"");
    assert_memory_equal(&again.sensor, &file.sensor, sizeof file.sensor[0] * SENSOR_INDEX_MPJ);
    assert_memory_equal(again.sensor[SENSOR_INDEX_MPJ].table.rad,
                        file.sensor[SENSOR_INDEX_MPJ].table.rad, sizeof(float) * 3);
    char *twice = calibration_file_text(&again);
    assert_string_equal(twice, text);
    free(text);
    free(twice);
    calibration_file_finish(&file);
    calibration_file_finish(&again);
}

/* good with `from` replaced by `to` is refused, and the message says `words`. */
static void refused(const char *from, const char *to, const char *words)
{
    char text[2048];
    calibration_file file;
    error err = {""};
    const char *at = strstr(good, from);
    assert_non_null(at);
    (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
    mrt_result result = parse(&file, text, &err);
    if (result >= 0 || !strstr(err.text, words))
        print_message("%s -> %s: %d %s\n", from, to, result, err.text);
    assert_true(result < 0);
    assert_non_null(strstr(err.text, words));
    assert_null(strchr(err.text, '\n'));
    assert_null(file.document);
}

static void errors_name_the_file_the_place_and_what_was_expected(void **state)
{
    (void)state;
    refused("{\"marotte", "[\"marotte", "anna.json: line 1, column");
    refused("ion\": 1", "ion\": 2",
            "anna.json: $.marotte_calibration: was made by a newer marotte");
    refused("ion\": 1,", "ion\": 1, \"name\": \"x\",", "duplicate");
    refused("\"anna\"", "7", "$.name: expected a text of at most 63 bytes");
    refused("\"anna\"", "\"a\\nb\"", "$.name: expected a text");
    refused("\"left\"", "\"both\"", "$.hand: expected \"left\" or \"right\", found \"both\"");
    refused("count\": 2", "count\": 3", "$.sensor_count: expected 2");
    refused("182.5", "18", "$.hand_length_mm: expected a number from 50 to 400, found 18");
    refused("\"index.mpj\"", "\"toe\"", "$.sensors.toe: unknown sensor");
    refused("\"measured\"", "\"guessed\"",
            "$.sensors[\"index.mpj\"].source: expected \"shipped\", \"zeroed\", \"measured\" or "
            "\"imported\", found \"guessed\"");
    refused("[62, 0], [148, 1.571], [200, 1.6]", "[62, 0]",
            "$.sensors[\"index.mpj\"].points: expected an array of 2 to 16 points");
    refused("[148, 1.571]", "[62, 1.571]",
            "$.sensors[\"index.mpj\"].points[1]: expected a raw value above the one before it, 62");
    refused("[148, 1.571]", "[148]", "points[1]: expected two numbers [a, b], found an array of 1");
    refused("[148, 1.571]", "[148, 4]", "points[1][1]: expected a number from -3.14159");
    refused("[148, 1.571]", "[1e30, 1]", "points[1][0]: expected a number from -1e+06");
    refused("[148, 1.571]", "[62.0000000001, 1]", "a raw value above"); /* the same as a float */
    refused("0.03", "-1", "$.sensors[\"index.mpj\"].residual_rad: expected a number from 0");
    refused("\"rad_range\": [-0.07, 1.6],", "", "expected both raw_range and rad_range");
    refused("\"middle.mpj\": 0.21", "\"nose\": 1", "cross_talk.nose: unknown sensor");
    refused("{\"source\": \"zeroed\", \"points\": [[100, 0.3], [150, 0]]}", "null",
            "$.sensors[\"middle.abd\"]: expected an object, found null");
}

static void use_fills_the_table_and_estimates_missing_end_joints(void **state)
{
    (void)state;
    calibration_file file;
    error err = {""};
    hand_calibration use;
    assert_int_equal(parse(&file, good, &err), MRT_OK);
    calibration_file_use(&file, &use);
    float raw[MRT_ANGLES] = {0}, out[MRT_ANGLES];
    raw[SENSOR_INDEX_MPJ] = 105;          /* halfway from 62 to 148 */
    raw[SENSOR_MIDDLE_INDEX_SPREAD] = 50; /* beyond 100: 0.3 + 50 * 0.006 */
    raw[SENSOR_LITTLE_MPJ] = 140;         /* not in the file: (140 - 90) * 0.020 */
    hand_calibrate(&use, raw, out);
    assert_float_equal(out[SENSOR_INDEX_MPJ], 0.7855f, 1e-5f);
    assert_float_equal(out[SENSOR_MIDDLE_INDEX_SPREAD], 0.6f, 1e-5f);
    assert_float_equal(out[SENSOR_LITTLE_MPJ], 1.0f, 1e-5f);
    assert_true(use.neutral_rad[SENSOR_INDEX_MPJ] == 0.42f);
    for (int finger = 0; finger < SENSOR_DISTAL_COUNT; ++finger)
        assert_false(use.has_distal[finger]);
    calibration_file_finish(&file);
}

/* ---- files and the folder ---- */

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "/tmp/marotte-calibration-XXXXXX");
    return mkdtemp(folder) && setenv("XDG_CONFIG_HOME", folder, 1) == 0 ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    (void)snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command);
}

static void keep(const char *name, const char *date, uint32_t side, const char *input)
{
    calibration_file file;
    error err = {""};
    char *path;
    assert_int_equal(calibration_folder_place(&path, name, input, &err), MRT_OK);
    assert_non_null(strstr(path, "/marotte/calibrations/"));
    assert_int_equal(parse(&file, good, &err), MRT_OK);
    (void)snprintf(file.name, sizeof file.name, "%s", name);
    (void)snprintf(file.date, sizeof file.date, "%s", date);
    (void)snprintf(file.input, sizeof file.input, "%s", input);
    file.side = side;
    assert_int_equal(calibration_file_write(&file, path, &err), MRT_OK);
    calibration_file_finish(&file);
    free(path);
}

static void newest_of_a_side_is_by_date(void **state)
{
    (void)state;
    calibration_file file;
    error err = {""}, note;
    char *path;
    assert_int_equal(calibration_folder_newest(&file, &path, MRT_LEFT, "", &note, &err), MRT_END);
    assert_null(path);
    keep("b", "2026-03-02T00:00:00Z", MRT_LEFT, "");
    keep("a", "2026-03-03T00:00:00Z", MRT_LEFT, "");
    keep("c", "2026-03-01T00:00:00Z", MRT_LEFT, "");
    keep("z", "2027-01-01T00:00:00Z", MRT_RIGHT, "");
    keep("a", "2027-02-01T00:00:00Z", MRT_LEFT, "camera");
    assert_int_equal(calibration_folder_newest(&file, &path, MRT_LEFT, "", &note, &err), MRT_OK);
    assert_string_equal(file.name, "a");
    assert_non_null(strstr(path, "/a.json"));
    assert_string_equal(note.text, "");
    free(path);
    calibration_file_finish(&file);
    /* the same person's hand before a camera */
    assert_int_equal(calibration_folder_newest(&file, &path, MRT_LEFT, "camera", &note, &err),
                     MRT_OK);
    assert_non_null(strstr(path, "/a, camera.json"));
    assert_string_equal(file.input, "camera");
    calibration_file other = file, glove = file;
    assert_int_equal(calibration_keep_fits(&other, &file, path, &err), MRT_OK);
    other.side = MRT_RIGHT;
    assert_int_equal(calibration_keep_fits(&other, &file, path, &err), MRT_ERR_ARGUMENT);
    glove.input[0] = '\0';
    assert_int_equal(calibration_keep_fits(&glove, &file, path, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "of camera"));
    free(path);
    calibration_file_finish(&file);
    assert_int_equal(calibration_folder_newest(&file, &path, MRT_LEFT, "openxr", &note, &err),
                     MRT_END);
}

static void a_damaged_file_in_the_folder_is_named_and_left_out(void **state)
{
    (void)state;
    calibration_file file;
    error err = {""}, note;
    char *path, damaged[128];
    (void)snprintf(damaged, sizeof damaged, "%s/marotte/calibrations/damaged.json", folder);
    FILE *stream = fopen(damaged, "w");
    assert_non_null(stream);
    assert_true(fputs("{", stream) >= 0 && fclose(stream) == 0);
    assert_int_equal(calibration_folder_newest(&file, &path, MRT_RIGHT, "", &note, &err), MRT_OK);
    assert_string_equal(file.name, "z");
    assert_non_null(strstr(note.text, "damaged.json"));
    free(path);
    calibration_file_finish(&file);
    assert_int_equal(unlink(damaged), 0);
}

static void names_cannot_leave_the_folder(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      ".",
                                      "..",
                                      "../up",
                                      "a/b",
                                      ".hidden",
                                      "a\nb",
                                      "01234567890123456789012345678901234567890123456789012345678"
                                      "90123"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        error err = {""};
        char *path;
        assert_int_equal(calibration_folder_place(&path, bad[i], "", &err), MRT_ERR_ARGUMENT);
        assert_null(path);
        assert_non_null(strstr(err.text, "1 to 63 letters"));
    }
}

static void a_file_that_cannot_be_read_is_named(void **state)
{
    (void)state;
    calibration_file file;
    error err = {""};
    assert_true(calibration_file_read(&file, "/nowhere/anna.json", &err) < 0);
    assert_non_null(strstr(err.text, "/nowhere/anna.json"));
    calibration_file_finish(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_all_that_is_there),
        cmocka_unit_test(what_is_written_reads_the_same_and_keeps_unknown_keys),
        cmocka_unit_test(errors_name_the_file_the_place_and_what_was_expected),
        cmocka_unit_test(use_fills_the_table_and_estimates_missing_end_joints),
        cmocka_unit_test(newest_of_a_side_is_by_date),
        cmocka_unit_test(a_damaged_file_in_the_folder_is_named_and_left_out),
        cmocka_unit_test(names_cannot_leave_the_folder),
        cmocka_unit_test(a_file_that_cannot_be_read_is_named),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
