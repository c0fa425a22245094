#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_scene.h"

#include <png.h>
#include <signal.h>
#include <sys/resource.h>

static char folder[256], path[300];

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "picture.png");
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder);
}

static void a_picture_comes_back_pixel_by_pixel(void **state)
{
    (void)state;
    error err = {""};
    uint8_t rgba[7 * 5 * 4], back[7 * 5 * 4] = {0};
    for (size_t i = 0; i < sizeof rgba; ++i)
        rgba[i] = (uint8_t)(i * 53 + i / 9);
    assert_int_equal(png_write(path, rgba, 7, 5, &err), MRT_OK);
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&image, path));
    assert_int_equal(image.width, 7);
    assert_int_equal(image.height, 5);
    image.format = PNG_FORMAT_RGBA;
    assert_true(png_image_finish_read(&image, NULL, back, 0, NULL));
    assert_memory_equal(rgba, back, sizeof rgba);
}

static void without_alpha_the_colours_come_back(void **state)
{
    (void)state;
    error err = {""};
    uint8_t rgba[7 * 5 * 4], back[7 * 5 * 4] = {0};
    for (size_t i = 0; i < sizeof rgba; ++i)
        rgba[i] = (uint8_t)(i * 53 + i / 9);
    assert_int_equal(png_write_as(path, rgba, 7, 5, PNG_OPAQUE, &err), MRT_OK);
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&image, path));
    assert_int_equal(image.format & PNG_FORMAT_FLAG_ALPHA, 0);
    image.format = PNG_FORMAT_RGBA;
    assert_true(png_image_finish_read(&image, NULL, back, 0, NULL));
    for (size_t i = 0; i < sizeof rgba; ++i)
        assert_int_equal(back[i], i % 4 == 3 ? 255 : rgba[i]);
}

static void a_full_disk_is_said_and_leaves_nothing(void **state)
{
    (void)state;
    static uint8_t rgba[400 * 400 * 4];
    error err = {""};
    struct rlimit before, small;
    (void)unlink(path);
    uint32_t noise = 1;
    for (size_t i = 0; i < sizeof rgba; ++i) {
        noise = noise * 1664525u + 1013904223u;
        rgba[i] = (uint8_t)(noise >> 24);
    }
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = (struct rlimit){1 << 14, before.rlim_max};
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    mrt_result result = png_write(path, rgba, 400, 400, &err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(result, MRT_ERR_IO);
    assert_non_null(strstr(err.text, "picture.png: cannot write"));
    assert_int_equal(access(path, F_OK), -1);
}

static void sizes_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    error err = {""};
    const uint8_t rgba[4] = {0};
    (void)unlink(path);
    assert_int_equal(png_write(path, rgba, 0, 1, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(png_write(path, rgba, 1, 0, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(png_write(path, rgba, 100000, 1, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "100000 by 1"));
    assert_int_equal(access(path, F_OK), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_picture_comes_back_pixel_by_pixel),
                                       cmocka_unit_test(without_alpha_the_colours_come_back),
                                       cmocka_unit_test(a_full_disk_is_said_and_leaves_nothing),
                                       cmocka_unit_test(sizes_that_make_no_sense_are_refused)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
