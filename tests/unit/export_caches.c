#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_scene.h"
#include "io/curves.h"

#include <locale.h>

static char folder[256], path[300];

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "cache");
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder);
}

static unsigned char *read_back(size_t *out_size)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    (void)fseek(stream, 0, SEEK_END);
    *out_size = (size_t)ftell(stream);
    rewind(stream);
    unsigned char *bytes = calloc(*out_size + 1, 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *out_size, stream), *out_size);
    (void)fclose(stream);
    return bytes;
}

static uint32_t little(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint32_t big(const unsigned char *at)
{
    return (uint32_t)at[3] | (uint32_t)at[2] << 8 | (uint32_t)at[1] << 16 | (uint32_t)at[0] << 24;
}

static float as_float(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static clip *mixed_clip(const mesh *m)
{
    error err;
    clip *c = clip_create(m, 25.0, NULL, &err);
    scene_begin_segment(c, m->position, &err);
    scene_add_anchored(c, 4, 0.3);
    scene_add_free(c, 3, 1.0, 2);
    return c;
}

static void expect_frames(const clip *c, const unsigned char *at,
                          uint32_t (*number)(const unsigned char *))
{
    error err;
    size_t count = (size_t)clip_mesh(c)->vertex_count * 3;
    float *shape = malloc(count * sizeof *shape);
    assert_non_null(shape);
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame) {
        assert_int_equal(clip_read(c, frame, shape, &err), MRT_OK);
        for (size_t i = 0; i < count; ++i, at += 4)
            assert_true(as_float(number(at)) == shape[i]);
    }
    free(shape);
}

static void pc2_holds_every_frame(void **state)
{
    (void)state;
    error err = {""};
    size_t size;
    mesh m = scene_sheet(6);
    clip *c = mixed_clip(&m);
    assert_int_equal(pc2_write(path, c, NULL, NULL, &err), MRT_OK);
    unsigned char *bytes = read_back(&size);
    assert_int_equal(size, 32 + 7 * m.vertex_count * 12);
    assert_memory_equal(bytes, "POINTCACHE2\0", 12);
    assert_int_equal(little(bytes + 12), 1);
    assert_int_equal(little(bytes + 16), m.vertex_count);
    assert_true(as_float(little(bytes + 20)) == 0.0f);
    assert_true(as_float(little(bytes + 24)) == 1.0f);
    assert_int_equal(little(bytes + 28), 7);
    expect_frames(c, bytes + 32, little);
    free(bytes);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void mdd_holds_every_frame(void **state)
{
    (void)state;
    error err = {""};
    size_t size;
    mesh m = scene_sheet(6);
    clip *c = mixed_clip(&m);
    assert_int_equal(mdd_write(path, c, NULL, NULL, &err), MRT_OK);
    unsigned char *bytes = read_back(&size);
    assert_int_equal(size, 8 + 7 * 4 + 7 * m.vertex_count * 12);
    assert_int_equal(big(bytes), 7);
    assert_int_equal(big(bytes + 4), m.vertex_count);
    for (size_t frame = 0; frame < 7; ++frame)
        assert_true(as_float(big(bytes + 8 + frame * 4)) == (float)((double)frame / 25.0));
    expect_frames(c, bytes + 8 + 7 * 4, big);
    free(bytes);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void csv_has_a_row_per_frame(void **state)
{
    (void)state;
    error err = {""};
    size_t size;
    mesh m;
    assert_int_equal(mesh_create(&m, 1, 0, &err), MRT_OK);
    clip *c = clip_create(&m, 4.0, NULL, &err);
    const float base[3] = {0}, moved[3] = {0, 0, 1.5f};
    char open[] = "jaw.open", odd[] = "a,b\"c", rad[] = "rad";
    const double control[6] = {1.0, 2.0, 3.0, 1.5, 2.0, 2.75};
    const double value[3][2] = {{0.25, (double)NAN}, {-1e-3, 2.0}, {0.0, 0.0}};
    assert_int_equal(clip_add_curve(c, &(clip_curve){.name = open, .unit = rad}, &err), MRT_OK);
    assert_int_equal(clip_add_curve(c, &(clip_curve){.name = odd, .unit = rad}, &err), MRT_OK);
    assert_int_equal(clip_begin_segment(c, base, NULL, NULL, 0, &err), MRT_OK);
    assert_int_equal(clip_add_anchored(c, NULL, &err), MRT_OK);
    assert_int_equal(clip_add_named(c, value[0], NULL, &err), MRT_OK);
    assert_int_equal(clip_add_controls(c, control, 1, &err), MRT_OK);
    assert_int_equal(clip_add_free(c, moved, &err), MRT_OK);
    assert_int_equal(clip_add_named(c, value[1], NULL, &err), MRT_OK);
    assert_int_equal(clip_begin_segment(c, moved, NULL, NULL, 0, &err), MRT_OK);
    assert_int_equal(clip_add_anchored(c, NULL, &err), MRT_OK);
    assert_int_equal(clip_add_named(c, value[2], NULL, &err), MRT_OK);
    assert_int_equal(clip_add_free(c, base, &err), MRT_OK); /* at rest, and says nothing */
    assert_int_equal(csv_write(path, c, NULL, &err), MRT_OK);
    unsigned char *bytes = read_back(&size);
    assert_string_equal((const char *)bytes,
                        "frame,timecode,time_s,shape,jaw.open,a_b_c,control1.start.x,"
                        "control1.start.y,control1.start.z,control1.end.x,control1.end.y,"
                        "control1.end.z\n"
                        "0,00:00:00:00,0,anchored,0.25,,1,2,3,1.5,2,2.75\n"
                        "1,00:00:00:01,0.25,free,-0.001,2,,,,,,\n"
                        "2,00:00:00:02,0.5,committed,0,0,,,,,,\n"
                        "3,00:00:00:03,0.75,anchored,,,,,,,,\n");
    curve_table t;
    assert_int_equal(curve_table_parse(&t, bytes, size, path, &err), MRT_OK);
    assert_int_equal(t.row_count, 4);
    assert_int_equal(t.column_count, 12);
    assert_int_equal(t.other_shapes, 2);
    assert_string_equal(t.timecode, "00:00:00:00");
    assert_true(t.value[1 * 12 + curve_table_find(&t, "jaw.open")] == -1e-3);
    assert_true(isnan(t.value[0 * 12 + curve_table_find(&t, "a_b_c")]));
    curve_table_finish(&t);
    free(bytes);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void csv_counts_time_code_on(void **state)
{
    (void)state;
    error err = {""};
    size_t size;
    mesh m;
    assert_int_equal(mesh_create(&m, 1, 0, &err), MRT_OK);
    clip *c = clip_create(&m, 30000.0 / 1001.0, NULL, &err);
    clip_set_start(
        c, &(clip_start){
               .timecode = "00:00:59;28", .frame = 1798, .rate_num = 30000, .rate_den = 1001});
    for (int frame = 0; frame < 3; ++frame)
        assert_int_equal(clip_add_free(c, m.position, &err), MRT_OK);
    assert_int_equal(csv_write(path, c, NULL, &err), MRT_OK);
    char *text = (char *)read_back(&size);
    assert_non_null(strstr(text, "\n0,00:00:59;28,0,anchored\n"));
    assert_non_null(strstr(text, "\n2,00:01:00;02,0.0667333333,anchored\n"));
    free(text);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void expect_table(const char *text, uint32_t rows, const char *reason)
{
    error err = {""};
    curve_table t;
    mrt_result result = curve_table_parse(&t, text, strlen(text), "t.csv", &err);
    if (!reason)
        assert_int_equal(result, MRT_OK);
    else if (result != MRT_ERR_FORMAT || !strstr(err.text, reason))
        fail_msg("\"%s\": %s", text, err.text);
    assert_int_equal(t.row_count, rows);
    curve_table_finish(&t);
}

static void tables_are_read_as_people_and_spreadsheets_write_them(void **state)
{
    (void)state;
    expect_table("jaw.open\n0.5\n", 1, NULL);
    expect_table(
        "\xEF\xBB\xBF# of a spreadsheet\r\n\"jaw.open\" ; note\r\n0.5;left as it was\r\n\r\n1;\r\n",
        2, NULL);
    expect_table("a,b\n1,2\n3\n", 0, "t.csv:3: 1 cells, the line of names has 2");
    expect_table("a,a\n1,2\n", 0, "two columns have the name \"a\"");
    expect_table("a,b\n", 0, "no rows");
    expect_table("# nothing\n\n", 0, "no line with the names");
}

static void csv_has_decimal_points_in_every_locale(void **state)
{
    (void)state;
    static const char *const with_commas[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"};
    bool found = false;
    for (size_t i = 0; !found && i < sizeof with_commas / sizeof *with_commas; ++i)
        found = setlocale(LC_NUMERIC, with_commas[i]) != NULL;
    if (!found) {
        print_message("SKIPPED: no locale with decimal commas is installed\n");
        skip();
    }
    csv_has_a_row_per_frame(state);
    (void)setlocale(LC_NUMERIC, "C");
}

static void caches_without_frames_are_refused(void **state)
{
    (void)state;
    error err = {""};
    mesh m = scene_sheet(4);
    (void)unlink(path);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    assert_int_equal(pc2_write(path, c, NULL, NULL, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(mdd_write(path, c, NULL, NULL, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "no frames"));
    assert_int_equal(access(path, F_OK), -1);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void caches_refuse_shapes_that_are_not_finite(void **state)
{
    (void)state;
    error err = {""};
    mesh m = scene_sheet(4);
    (void)unlink(path);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    double displacement[SCENE_CONTROLS * 3] = {1e300, 1e300, 1e300, 1e300};
    assert_int_equal(clip_add_anchored(c, displacement, &err), MRT_OK);
    assert_int_equal(pc2_write(path, c, NULL, NULL, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(mdd_write(path, c, NULL, NULL, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "frame 0"));
    assert_memory_equal(err.text, path, strlen(path));
    assert_int_equal(access(path, F_OK), -1);
    clip_destroy(c);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pc2_holds_every_frame),
        cmocka_unit_test(mdd_holds_every_frame),
        cmocka_unit_test(csv_has_a_row_per_frame),
        cmocka_unit_test(csv_counts_time_code_on),
        cmocka_unit_test(tables_are_read_as_people_and_spreadsheets_write_them),
        cmocka_unit_test(csv_has_decimal_points_in_every_locale),
        cmocka_unit_test(caches_without_frames_are_refused),
        cmocka_unit_test(caches_refuse_shapes_that_are_not_finite)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
