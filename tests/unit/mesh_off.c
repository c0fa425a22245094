#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/mesh_file.h"

#include <string.h>

static mesh read_good(const char *text)
{
    mesh m;
    error err = {""};
    if (off_parse(&m, text, strlen(text), &err) < 0)
        fail_msg("%s\n%s", err.text, text);
    assert_int_equal(mesh_validate(&m, &err), MRT_OK);
    return m;
}

static void the_variants_of_the_header_are_read(void **state)
{
    (void)state;
    static const char *const good[] = {
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF 3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
        "# made by hand\nOFF # really\n\n3 1\n0 0 0\n# a vertex\n1 0 0\n0 1 0\n3 0 1 2\r\n",
        "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 9 9 9 9\n3 0 1 2 0.5 0.5 0.5\n",
        "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 2\n0 1 0 0 0 1\n3 0 1 2\n",
        "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"};
    static const uint32_t expected[] = {0, 1, 2};
    for (size_t i = 0; i < sizeof good / sizeof *good; ++i) {
        mesh m = read_good(good[i]);
        assert_int_equal(m.vertex_count, 3);
        assert_int_equal(m.triangle_count, 1);
        assert_memory_equal(m.triangle, expected, sizeof expected);
        assert_true(m.position[3] == 1.0f);
        mesh_destroy(&m);
    }
}

static void a_face_may_run_over_several_lines(void **state)
{
    (void)state;
    static const char *const good[] = {
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4\n0 1\n\n2 # a comment\n3\n3 0 1 2\n",
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0\n1 2\n3 0.5 0.5 0.5\n3\n0\n1\n2 9"};
    static const uint32_t expected[] = {0, 1, 2, 0, 2, 3, 0, 1, 2};
    for (size_t i = 0; i < sizeof good / sizeof *good; ++i) {
        mesh m = read_good(good[i]);
        assert_int_equal(m.triangle_count, 3);
        assert_memory_equal(m.triangle, expected, sizeof expected);
        assert_null(m.note);
        mesh_destroy(&m);
    }
}

static void a_colour_that_is_not_a_number_is_passed_over(void **state)
{
    (void)state;
    mesh m = read_good("COFF\n3 1 0\n0 0 0 nan 0 0 1\n1 0 0 0 0 0 1\n0 1 0 0 0 inf 1\n"
                       "3 0 1 2 NaN 0 0\n");
    assert_int_equal(m.triangle_count, 1);
    mesh_destroy(&m);
}

static void normals_are_made_unit(void **state)
{
    (void)state;
    mesh m = read_good("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 3 0 4\n0 1 0 0 0 1\n3 0 1 2\n");
    assert_non_null(m.normal);
    assert_true(m.normal[3] == 0.6f && m.normal[4] == 0.0f && m.normal[5] == 0.8f);
    mesh_destroy(&m);
    m = read_good("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 0\n0 1 0 0 0 1\n3 0 1 2\n");
    assert_null(m.normal);
    assert_non_null(strstr(m.note, "normal of vertex 1"));
    mesh_destroy(&m);
}

static void malformed_text_is_refused_by_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *reason;
    } bad[] = {{"", "the file ends"},
               {"OFF\n", "the file ends"},
               {"OFF BINARY\n", "binary OFF"},
               {"4OFF\n3 1 0\n", "line 1: OFF, COFF"},
               {"solid x\n", "line 1: OFF, COFF"},
               {"OFF\n2000000000 1 0\n0 0 0\n", "line 2: 2000000000 vertices"},
               {"OFF\n3 2000000000 0\n0 0 0\n", "do not fit"},
               {"OFF\n9223372036854775807 9223372036854775807 0\n", "do not fit"},
               {"OFF\n-3 1 0\n", "line 2: vertex, face and edge count"},
               {"OFF\n3\n", "line 2: vertex, face and edge count"},
               {"OFF\n3 1 0 9\n", "line 2: vertex, face and edge count"},
               {"OFF\n3 1 0\n0 0 0\n1 0 0\n", "line 4: the file ends where a vertex"},
               {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "the file ends where a face"},
               {"OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "line 4: a finite number"},
               {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 4: a vertex has 2 numbers"},
               {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6: a face uses vertex 3"},
               {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "line 6: a face uses vertex -1"},
               {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "line 6: a face has 2 corners"},
               {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2000000000 0 1 2\n",
                "line 6: the file ends where corner 4 of a face of 2000000000 was expected"},
               {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n2 0 1 2\n", "the file ends where a face"},
               {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 red\n", "line 6: a colour"},
               {"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "no faces"},
               {"OFF\n0 0 0\n", "no vertices"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        mesh m;
        error err = {""};
        if (off_parse(&m, bad[i].text, strlen(bad[i].text), &err) >= 0)
            fail_msg("accepted: %s", bad[i].text);
        assert_null(m.position);
        if (!strstr(err.text, bad[i].reason))
            fail_msg("\"%s\" does not say \"%s\"", err.text, bad[i].reason);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_variants_of_the_header_are_read),
        cmocka_unit_test(a_face_may_run_over_several_lines),
        cmocka_unit_test(a_colour_that_is_not_a_number_is_passed_over),
        cmocka_unit_test(normals_are_made_unit),
        cmocka_unit_test(malformed_text_is_refused_by_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
