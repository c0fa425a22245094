#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_scene.h"

#include <png.h>

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
                                       cmocka_unit_test(sizes_that_make_no_sense_are_refused)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
