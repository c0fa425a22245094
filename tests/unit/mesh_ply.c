#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/mesh_file.h"

#include <stdio.h>
#include <string.h>

#define VERTEX "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define FACE   "element face 1\nproperty list uchar int vertex_indices\n"
#define TEXT   "ply\nformat ascii 1.0\n"
#define GOOD   TEXT VERTEX FACE "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"

static mesh read_good(const void *data, size_t size)
{
    mesh m;
    error err = {""};
    if (ply_parse(&m, data, size, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(mesh_validate(&m, &err), MRT_OK);
    return m;
}

static void assert_refused(const void *data, size_t size, const char *reason)
{
    mesh m;
    error err = {""};
    if (ply_parse(&m, data, size, &err) >= 0)
        fail_msg("accepted, though \"%s\" was expected", reason);
    assert_null(m.position);
    if (!strstr(err.text, reason))
        fail_msg("\"%s\" does not say \"%s\"", err.text, reason);
}

static void text_is_read(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2};
    mesh m = read_good(GOOD, strlen(GOOD));
    assert_int_equal(m.vertex_count, 3);
    assert_int_equal(m.triangle_count, 1);
    assert_memory_equal(m.triangle, expected, sizeof expected);
    assert_true(m.position[3] == 1.0f && m.position[7] == 1.0f);
    assert_null(m.normal);
    assert_null(m.note);
    mesh_destroy(&m);
}

/* Appends `size` bytes of a little-endian value, in the byte order asked for. */
static size_t put(unsigned char *at, const void *value, size_t size, int big)
{
    const unsigned char *bytes = value;
    for (size_t i = 0; i < size; ++i)
        at[i] = bytes[big ? size - 1 - i : i];
    return size;
}

/* Two triangles; x as double, a list among the vertex properties, a list of another type. */
static size_t write_binary(unsigned char *out, int big)
{
    size_t used = (size_t)sprintf(
        (char *)out,
        "ply\r\nformat binary_%s_endian 1.0\r\ncomment made here\r\nelement vertex 4\r\n"
        "property double x\r\nproperty float y\r\nproperty float z\r\n"
        "property list uchar short ignored\r\nproperty float weight\r\n"
        "element face 2\r\nproperty uchar flag\r\nproperty list ushort uint vertex_index\r\n"
        "end_header\r\n",
        big ? "big" : "little");
    for (int v = 0; v < 4; ++v) {
        double x = v;
        float y = 0.5f * (float)v, z = -1.0f, weight = 0.25f * (float)v;
        int16_t ignored = -7;
        used += put(out + used, &x, 8, big);
        used += put(out + used, &y, 4, big);
        used += put(out + used, &z, 4, big);
        out[used++] = (unsigned char)(v % 2);
        if (v % 2)
            used += put(out + used, &ignored, 2, big);
        used += put(out + used, &weight, 4, big);
    }
    for (uint32_t f = 0; f < 2; ++f) {
        uint16_t count = 3;
        out[used++] = 9;
        used += put(out + used, &count, 2, big);
        for (uint32_t i = 0; i < 3; ++i) {
            uint32_t index = f + i;
            used += put(out + used, &index, 4, big);
        }
    }
    return used;
}

static void binary_of_both_byte_orders_is_read(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2, 1, 2, 3};
    for (int big = 0; big < 2; ++big) {
        unsigned char data[1024];
        size_t size = write_binary(data, big);
        mesh m = read_good(data, size);
        assert_int_equal(m.vertex_count, 4);
        assert_int_equal(m.triangle_count, 2);
        assert_memory_equal(m.triangle, expected, sizeof expected);
        assert_true(m.position[9] == 3.0f && m.position[10] == 1.5f && m.position[11] == -1.0f);
        assert_int_equal(m.attribute_count, 1);
        assert_string_equal(m.attribute[0].name, "weight");
        assert_int_equal(m.attribute[0].component_count, 1);
        assert_true(m.attribute[0].value[3] == 0.75f);
        mesh_destroy(&m);
    }
}

static void binary_cut_anywhere_is_refused(void **state)
{
    (void)state;
    unsigned char data[1024];
    size_t size = write_binary(data, 0);
    for (size_t cut = 0; cut < size; ++cut)
        assert_refused(data, cut, "");
}

static void normals_and_float_properties_are_kept(void **state)
{
    (void)state;
    static const char text[] =
        TEXT "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
             "property double mobility\n" FACE "end_header\n"
             "0 0 0 0 0 2 255 0.5\n1 0 0 0 0 2 255 0.25\n0 1 0 0 0 2 255 1\n3 0 1 2\n";
    mesh m = read_good(text, strlen(text));
    assert_non_null(m.normal);
    assert_true(m.normal[2] == 1.0f);
    assert_int_equal(m.attribute_count, 1);
    assert_string_equal(m.attribute[0].name, "mobility");
    assert_true(m.attribute[0].value[1] == 0.25f);
    assert_non_null(strstr(m.note, "1 vertex properties"));
    mesh_destroy(&m);
}

static void other_elements_are_skipped_with_a_note(void **state)
{
    (void)state;
    static const char text[] =
        TEXT "element edge 2\nproperty int a\nproperty int b\n" VERTEX FACE
             "element range_grid 1\nproperty list int int vertex_indices\nend_header\n"
             "0 1\n1 2\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n4 0 1 2 -1\n";
    mesh m = read_good(text, strlen(text));
    assert_int_equal(m.triangle_count, 1);
    assert_non_null(strstr(m.note, "\"edge\" was skipped"));
    assert_non_null(strstr(m.note, "\"range_grid\" was skipped"));
    mesh_destroy(&m);
}

/* Two strips, and a vertex said twice to join two more. */
static void binary_triangle_strips_are_read(void **state)
{
    (void)state;
    static const char *const formats[] = {"binary_little_endian", "binary_big_endian"};
    static const float position[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}};
    static const int32_t strip[] = {0, 1, 2, 3, -1, 2, 3, 4, 4, 0, 1, 2};
    static const uint32_t expected[] = {0, 1, 2, 2, 1, 3, 2, 3, 4, 0, 4, 1, 0, 1, 2};
    for (int big = 0; big < 2; ++big) {
        unsigned char data[1024];
        size_t used = (size_t)snprintf((char *)data, sizeof data,
                                       "ply\nformat %s 1.0\nelement vertex 5\nproperty float x\n"
                                       "property float y\nproperty float z\nelement tristrips 1\n"
                                       "property list int int vertex_indices\nend_header\n",
                                       formats[big]);
        for (size_t i = 0; i < 15; ++i)
            used += put(data + used, &position[i / 3][i % 3], 4, big);
        int32_t count = 12;
        used += put(data + used, &count, 4, big);
        for (size_t i = 0; i < 12; ++i)
            used += put(data + used, &strip[i], 4, big);
        mesh m = read_good(data, used);
        assert_int_equal(m.triangle_count, 5);
        assert_memory_equal(m.triangle, expected, sizeof expected);
        assert_null(m.note);
        mesh_destroy(&m);
        for (size_t cut = 1; cut < used; cut += 7)
            assert_refused(data, used - cut, "");
        int32_t lie = 99;
        (void)put(data + used - 4, &lie, 4, big);
        assert_refused(data, used, "uses vertex 99");
    }
}

static void vertex_colours_are_read(void **state)
{
    (void)state;
    static const char text[] =
        TEXT "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\n" FACE "end_header\n"
             "0 0 0 255 0 0\n1 0 0 0 128 0\n0 1 0 0 0 0\n3 0 1 2\n";
    mesh m = read_good(text, strlen(text));
    assert_non_null(m.colour);
    assert_true(m.colour[0] == 1.0f && m.colour[1] == 0.0f && m.colour[3] == 1.0f);
    assert_true(m.colour[5] > 0.2158f && m.colour[5] < 0.2160f); /* sRGB 128, in linear light */
    assert_null(m.note);
    mesh_destroy(&m);
}

static void a_colour_that_is_not_a_number_is_white(void **state)
{
    (void)state;
    static const char text[] =
        TEXT "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property float red\nproperty float green\nproperty float blue\n" FACE "end_header\n"
             "0 0 0 1 0 0\n1 0 0 nan 0.5 0\n0 1 0 0 0 -Infinity\n3 0 1 2\n";
    static const float expected[12] = {1, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    mesh m = read_good(text, strlen(text));
    assert_memory_equal(m.colour, expected, sizeof expected);
    assert_non_null(strstr(m.note, "the colours of 2 vertices are not numbers"));
    mesh_destroy(&m);
}

/* As text and in both byte orders; the faces may also be strips. */
static void faces_may_come_before_the_vertices(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2};
    static const char text[] = TEXT
        "element edge 1\nproperty int a\n" FACE
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float red\nproperty float green\nproperty float blue\nproperty list uchar int "
        "faces\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
        "7\n3 0 1 2\n0 0 0 nan 1 1 1 0\n1 0 0 1 1 1 0\n0 1 0 1 1 1 2 0 1\n3 0 1 2\n";
    mesh m = read_good(text, strlen(text));
    assert_int_equal(m.triangle_count, 2);
    assert_memory_equal(m.triangle, expected, sizeof expected);
    assert_memory_equal(m.triangle + 3, expected, sizeof expected);
    assert_true(m.position[3] == 1.0f);
    mesh_destroy(&m);
    for (int big = 0; big < 2; ++big) {
        unsigned char data[512];
        size_t used =
            (size_t)snprintf((char *)data, sizeof data, "ply\nformat binary_%s_endian 1.0\n%s",
                             big ? "big" : "little", FACE VERTEX "end_header\n");
        data[used++] = 3;
        for (uint32_t i = 0; i < 3; ++i)
            used += put(data + used, &expected[i], 4, big);
        for (int i = 0; i < 9; ++i) {
            float number = i == 3 || i == 7 ? 1.0f : 0.0f;
            used += put(data + used, &number, 4, big);
        }
        m = read_good(data, used);
        assert_memory_equal(m.triangle, expected, sizeof expected);
        assert_true(m.position[3] == 1.0f && m.position[7] == 1.0f);
        assert_null(m.note);
        mesh_destroy(&m);
        for (size_t cut = 0; cut < used; ++cut)
            assert_refused(data, cut, "");
    }
}

static void lines_of_old_macs_are_read(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2};
    char text[] = GOOD;
    for (char *c = text; *c; ++c)
        *c = *c == '\n' ? '\r' : *c;
    mesh m = read_good(text, strlen(text));
    assert_memory_equal(m.triangle, expected, sizeof expected);
    assert_null(m.note);
    mesh_destroy(&m);
    for (char *c = strstr(text, "0 0 0"); *c; ++c) /* only the header */
        *c = *c == '\r' ? '\n' : *c;
    m = read_good(text, strlen(text));
    assert_memory_equal(m.triangle, expected, sizeof expected);
    mesh_destroy(&m);
    /* The first bytes of a binary body may look like the end of a line. */
    unsigned char data[1024];
    size_t used =
        (size_t)snprintf((char *)data, sizeof data, "ply\rformat binary_little_endian 1.0\r%s",
                         VERTEX FACE "end_header\r");
    for (size_t i = 0; i < used; ++i)
        data[i] = data[i] == '\n' ? '\r' : data[i];
    for (uint32_t i = 0; i < 9; ++i) {
        uint32_t bits = i == 0 ? 0x3f800d0a : i;
        used += put(data + used, &bits, 4, 0);
    }
    data[used++] = 3;
    for (uint32_t i = 0; i < 3; ++i)
        used += put(data + used, &expected[i], 4, 0);
    m = read_good(data, used);
    assert_true(m.position[0] > 1.0003f && m.position[0] < 1.0004f);
    assert_memory_equal(m.triangle, expected, sizeof expected);
    assert_null(m.note);
    mesh_destroy(&m);
}

static void malformed_files_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *reason;
    } bad[] = {
        {"", "\"ply\" was expected"},
        {"plyx\n", "\"ply\" was expected"},
        {"ply\n", "line 2: the file ends before end_header"},
        {TEXT VERTEX FACE, "the file ends before end_header"},
        {"ply\nend_header\n", "no format"},
        {"ply\nformat ascii 2.0\n", "line 2: version 1.0"},
        {"ply\nformat binary 1.0\n", "line 2: format ascii"},
        {TEXT "property float x\nelement vertex 3\nend_header\n",
         "line 3: a property before the first element"},
        {TEXT "element vertex -3\n", "line 3: the number of elements"},
        {TEXT "element vertex\n", "line 3: the number of elements"},
        {TEXT "element vertex 3\nend_header\n", "has no properties"},
        {TEXT "element vertex 2000000000\nproperty float x\nproperty float y\nproperty float z\n"
              "end_header\n0 0 0\n",
         "2000000000 of \"vertex\" do not fit"},
        {TEXT VERTEX "element face 9223372036854775807\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0\n",
         "do not fit"},
        {TEXT "element vertex 3\nproperty quad x\n", "line 4: a type such as"},
        {TEXT "element vertex 3\nproperty list float int x\n", "line 4: a whole number type"},
        {TEXT "element vertex 3\nproperty float\n", "line 4: a name"},
        {TEXT "elephant vertex 3\n", "line 3: format, element"},
        {TEXT "element vertex 3\nproperty float x\nproperty float y\n" FACE
              "end_header\n0 0\n1 0\n0 1\n3 0 1 2\n",
         "no x, y and z"},
        {TEXT "element vertex 3\nproperty float x\nproperty float x\nproperty float z\n" FACE
              "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         "\"x\" appears twice"},
        {TEXT VERTEX VERTEX FACE "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         "\"vertex\" appears twice"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n",
         "line 11: \"z\" is not finite"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 nanny\n0 1 0\n3 0 1 2\n",
         "line 11: a finite number was expected, \"nanny\""},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 1e39\n0 1 0\n3 0 1 2\n",
         "line 11: \"z\" is not finite"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 11: fewer values"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 0 0\n0 1 0\n3 0 1 2\n", "line 11: more values"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 0\n0 1 0\n", "the file ends too early"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a face uses vertex 3"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "a face uses vertex -1"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "a face has 2 corners"},
        {TEXT VERTEX FACE "end_header\n0 0 0\n1 0 0\n0 1 0\n300 0 1 2\n",
         "a whole number of its type was expected, \"300\""},
        {TEXT VERTEX "element face 1\nproperty list uchar float vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         "must be whole numbers"},
        {TEXT FACE VERTEX "end_header\n3 0 1 3\n0 0 0\n1 0 0\n0 1 0\n",
         "line 10: a face uses vertex 3"},
        {TEXT FACE VERTEX "end_header\n3 0 1 x\n0 0 0\n1 0 0\n0 1 0\n", "line 10: a whole number"},
        {TEXT FACE VERTEX "end_header\n3 0 1 2\n0 0 0\n1 0 0\n", "the file ends too early"},
        {TEXT FACE VERTEX VERTEX "end_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n0 0 0\n1 0 0\n0 1 0\n",
         "\"vertex\" appears twice"},
        {TEXT FACE "end_header\n3 0 1 2\n", "but 0 are defined so far"},
        {"ply\rformat ascii 1.0\relement vertex x\r", "line 3: the number of elements"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_refused(bad[i].text, strlen(bad[i].text), bad[i].reason);
}

static void binary_lists_of_a_lying_length_are_refused(void **state)
{
    (void)state;
    static const char text[] =
        "ply\nformat binary_little_endian 1.0\n" VERTEX
        "element face 1\nproperty list uint int vertex_indices\nend_header\n";
    unsigned char data[512];
    size_t size = sizeof text - 1;
    memcpy(data, text, size);
    memset(data + size, 0, 36);
    memset(data + size + 36, 0xff, 4); /* 4294967295 corners */
    memset(data + size + 40, 0, 8);
    assert_refused(data, size + 48, "face 0: the file ends too early");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_is_read),
        cmocka_unit_test(binary_of_both_byte_orders_is_read),
        cmocka_unit_test(binary_cut_anywhere_is_refused),
        cmocka_unit_test(normals_and_float_properties_are_kept),
        cmocka_unit_test(other_elements_are_skipped_with_a_note),
        cmocka_unit_test(binary_triangle_strips_are_read),
        cmocka_unit_test(vertex_colours_are_read),
        cmocka_unit_test(a_colour_that_is_not_a_number_is_white),
        cmocka_unit_test(faces_may_come_before_the_vertices),
        cmocka_unit_test(lines_of_old_macs_are_read),
        cmocka_unit_test(malformed_files_are_refused),
        cmocka_unit_test(binary_lists_of_a_lying_length_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
