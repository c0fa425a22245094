/* Every golden case, through the code of `marotte deform`, within the tolerances of its file. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "cli/deform_case.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const case_names[] = {
    "o01_single_tip",
    "o02_two_tips",
    "o03_ten_tips_anchored",
    "o04_ten_tips_unanchored",
    "o05_five_tips_constant",
    "o06_ten_tips_linear",
    "o07_ten_tips_linear_unanchored",
    "o08_four_tips_linear_is_affine",
    "o09_twelve_tips_large_radius",
    "o10_ten_tips_disjoint_supports",
    "o11_tips_and_skull",
    "o12_tips_skull_jaw_anchored",
    "o13_tips_skull_jaw_unanchored",
    "o14_coplanar_linear",
    "o15_coincident_and_on_skull",
};
enum { CASE_COUNT = sizeof case_names / sizeof *case_names };

static double expected_at(const json_t *expected, size_t frame, size_t point, size_t axis)
{
    const json_t *row = json_array_get(json_array_get(expected, frame), point);
    const json_t *value = json_array_get(row, axis);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static double largest_difference(const deform_case *c, const double *position,
                                 const json_t *expected)
{
    double largest = 0.0;
    assert_int_equal(json_array_size(expected), c->frame_count);
    for (size_t f = 0; f < c->frame_count; ++f) {
        assert_int_equal(json_array_size(json_array_get(expected, f)), c->point_count);
        for (size_t p = 0; p < c->point_count; ++p)
            for (size_t axis = 0; axis < 3; ++axis, ++position) {
                double difference = fabs(*position - expected_at(expected, f, p, axis));
                assert_true(isfinite(difference));
                largest = difference > largest ? difference : largest;
            }
    }
    return largest;
}

/* The largest difference, over the file's tolerance. */
static double check_precision(const deform_case *c, const json_t *file, deform_precision precision,
                              const char *tolerance_key)
{
    error err = {""};
    double tolerance = json_number_value(json_object_get(file, tolerance_key));
    double *position = calloc((size_t)3 * c->frame_count * c->point_count, sizeof *position);
    assert_non_null(position);
    assert_true(tolerance > 0.0);
    if (deform_case_run(c, precision, position, &err) < 0)
        fail_msg("%s", err.text);
    double ratio = largest_difference(c, position, json_object_get(file, "expected")) / tolerance;
    free(position);
    return ratio;
}

static void check_case(const char *name, double worst[2])
{
    char path[512];
    error err = {""};
    file_bytes bytes;
    deform_case c;
    (void)snprintf(path, sizeof path, "%s/tests/golden/%s.json", SOURCE_DIR, name);
    if (file_read(&bytes, path, 1 << 20, &err) < 0 ||
        deform_case_read(&c, bytes.data, bytes.size, path, &err) < 0)
        fail_msg("%s", err.text);
    assert_string_equal(c.unknown, "");
    json_t *file = json_loadb((const char *)bytes.data, bytes.size, 0, NULL);
    assert_non_null(file);
    double f64 = check_precision(&c, file, DEFORM_F64, "tol_f64");
    double f32 = check_precision(&c, file, DEFORM_F32, "tol_f32");
    print_message("%-32s of its tolerance: f64 %.6f, f32 %.3f\n", name, f64, f32);
    if (f64 > 1.0 || f32 > 1.0)
        fail_msg("%s: out of tolerance", name);
    worst[0] = f64 > worst[0] ? f64 : worst[0];
    worst[1] = f32 > worst[1] ? f32 : worst[1];
    json_decref(file);
    deform_case_destroy(&c);
    file_bytes_finish(&bytes);
}

static void every_case_is_within_its_tolerances(void **state)
{
    (void)state;
    double worst[2] = {0.0, 0.0};
    for (size_t i = 0; i < CASE_COUNT; ++i)
        check_case(case_names[i], worst);
    print_message("worst: f64 %.6f, f32 %.3f of the tolerance\n", worst[0], worst[1]);
}

/* A case that is right but for one text put in place of another. */
static void refuses(const char *from, const char *to, const char *message)
{
    static const char good[] =
        "{\"kernel\": \"wendland_c2\", \"radius\": 1, \"polynomial\": \"none\", "
        "\"mode\": \"anchored\", \"starts\": [[0, 0, 0]], \"frames\": [[[0, 0.5, 0]]], "
        "\"skull\": [[2, 0, 0]], \"jaw\": {\"centres\": [[0, -1, 0]], \"axis_point\": [0, 0, 0], "
        "\"axis_dir\": [1, 0, 0], \"poses\": [{\"angle\": 0.25, \"translation\": [0, 0, 0]}]}, "
        "\"points\": [[0, 0, 0]]}";
    char text[1024];
    const char *at = strstr(good, from);
    assert_non_null(at);
    (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
    error err = {""};
    deform_case c;
    mrt_result result = deform_case_read(&c, text, strlen(text), "case.json", &err);
    if (message == NULL) {
        if (result < 0)
            fail_msg("%s", err.text);
        deform_case_destroy(&c);
        return;
    }
    assert_int_equal(result < 0, 1);
    if (!strstr(err.text, message) || strncmp(err.text, "case.json: ", 11) != 0)
        fail_msg("\"%s\" does not say \"%s\"", err.text, message);
    assert_null(strchr(err.text, '\n'));
}

static void bad_cases_are_refused_by_their_place(void **state)
{
    (void)state;
    refuses("\"radius\": 1", "\"radius\": 1", NULL);
    refuses("\"radius\": 1", "\"radius\": 0", "$.radius: expected a number > 0");
    refuses("\"radius\": 1", "\"radius\": -1", "$.radius");
    refuses("\"radius\": 1", "\"radius\": \"1\"",
            "$.radius: expected a number > 0, from 1e-14 "
            "to 1e14, found \"1\"");
    refuses("\"radius\": 1", "\"radius\": 1e999", "line 1, column");
    refuses("\"radius\": 1", "\"radius\": NaN", "line 1, column");
    refuses("\"radius\": 1, ", "",
            "$.radius: expected a number > 0, from 1e-14 to 1e14, found "
            "nothing");
    refuses("\"radius\": 1", "\"radius\": 1, \"radius\": 2", "duplicate object key");
    refuses("wendland_c2", "gauss\\n", "$.kernel: expected \"wendland_c2\"");
    refuses("\"none\"", "\"quadratic\"", "$.polynomial: expected \"none\"");
    refuses("\"anchored\"", "3", "$.mode: expected \"anchored\" or \"unanchored\", found 3");
    refuses("\"starts\": [[0, 0, 0]], ", "", "$.starts: expected an array");
    refuses("[[0, 0, 0]], \"frames\"", "[[0, 0]], \"frames\"",
            "$.starts[0]: expected three numbers [x, y, z], found an array of 2");
    refuses("[[[0, 0.5, 0]]]", "[[[0, 0.5, 0], [1, 1, 1]]]",
            "$.frames[0]: expected an array of 1 points");
    refuses("[[[0, 0.5, 0]]]", "[[[0, 0.5, 0]], [[0, true, 0]]]",
            "$.frames[1][0][1]: expected a number from -1e+15 to 1e+15, found true");
    refuses("[[[0, 0.5, 0]]]", "[[[0, 1e16, 0]]]", "$.frames[0][0][1]: expected a number");
    refuses("[[[0, 0.5, 0]]]", "[]", "$.frames: expected an array of at least one frame");
    refuses("[[2, 0, 0]]", "null", "$.skull: expected an array");
    refuses("[[0, -1, 0]]", "[[0, -1]]", "$.jaw.centres[0]: expected three numbers");
    refuses("\"axis_dir\": [1, 0, 0]", "\"axis_dir\": [0, 0, 0]", "$.jaw.axis_dir: expected a");
    refuses("\"axis_point\": [0, 0, 0], ", "", "$.jaw.axis_point: expected three numbers");
    refuses("[{\"angle\": 0.25, \"translation\": [0, 0, 0]}]", "[]",
            "$.jaw.poses: expected an array of 1 poses");
    refuses("\"angle\": 0.25, ", "", "$.jaw.poses[0].angle: expected a number");
    refuses("\"translation\": [0, 0, 0]", "\"translation\": 0", "$.jaw.poses[0].translation");
    refuses("\"points\": [[0, 0, 0]]", "\"points\": {}", "$.points: expected an array");
    refuses("\"points\": [[0, 0, 0]]}", "", "line 1, column");
}

static void unknown_keys_are_named(void **state)
{
    (void)state;
    static const char text[] =
        "{\"kernel\": \"wendland_c2\", \"radius\": 1, \"polynomial\": \"none\", \"radios\": 1, "
        "\"mode\": \"anchored\", \"starts\": [], \"frames\": [[]], \"points\": []}";
    error err = {""};
    deform_case c;
    assert_int_equal(deform_case_read(&c, text, strlen(text), "case.json", &err), MRT_OK);
    assert_string_equal(c.unknown, "$.radios");
    deform_case_destroy(&c);
}

static void no_tips_move_nothing(void **state)
{
    (void)state;
    static const char text[] =
        "{\"kernel\": \"wendland_c4\", \"radius\": 1, \"polynomial\": \"linear\", "
        "\"mode\": \"unanchored\", \"starts\": [], \"frames\": [[], []], "
        "\"points\": [[1, -2, 0.5]]}";
    error err = {""};
    deform_case c;
    double position[6];
    assert_int_equal(deform_case_read(&c, text, strlen(text), "case.json", &err), MRT_OK);
    for (int precision = DEFORM_F64; precision <= DEFORM_F32; ++precision) {
        assert_int_equal(deform_case_run(&c, (deform_precision)precision, position, &err), MRT_OK);
        for (int frame = 0; frame < 2; ++frame)
            assert_true(position[3 * frame] == 1.0 && position[3 * frame + 1] == -2.0 &&
                        position[3 * frame + 2] == 0.5);
    }
    deform_case_destroy(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_case_is_within_its_tolerances),
        cmocka_unit_test(bad_cases_are_refused_by_their_place),
        cmocka_unit_test(unknown_keys_are_named),
        cmocka_unit_test(no_tips_move_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
