/* The contact sheet: which moments, and that each is there to be seen. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/draw.h"
#include "draw/sheet.h"
#include "draw_help.h"

#include <png.h>
#include <stdio.h>
#include <string.h>

static bool drawable;
static const char path[] = BUILD_DIR "/draw_sheet_test.png";

/* A ball that is shift_mm[f] to the left in frame f. */
static clip *shifted_clip(const mesh *m, const float *shift_mm, uint32_t frame_count, double fps)
{
    error err;
    clip *c = clip_create(m, fps, NULL, &err);
    float *position = malloc(m->vertex_count * 3 * sizeof *position);
    assert_true(c && position);
    for (uint32_t f = 0; f < frame_count; ++f) {
        memcpy(position, m->position, m->vertex_count * 3 * sizeof *position);
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            position[v * 3] += shift_mm[f];
        assert_int_equal(clip_add_free(c, position, &err), MRT_OK);
    }
    free(position);
    return c;
}

static void moments_are_the_furthest_of_each_eighth(void **state)
{
    (void)state;
    error err;
    mesh m = shapes_wall(10, 0);
    const float shift_mm[20] = {0, 3, -5, 1, 1, 2, 2, 9, 0, 0, -1, 4, 4, 3, 8, 8, 0, 0, 0, -7};
    /* eighths: 0-1, 2-4, 5-6, 7-9, 10-11, 12-14, 15-16, 17-19 */
    const uint32_t expected[8] = {1, 2, 5, 7, 11, 14, 15, 19};
    const double distance_mm[8] = {3, 5, 2, 9, 4, 8, 8, 7};
    clip *c = shifted_clip(&m, shift_mm, 20, 30.0);
    thumbnail found[THUMBNAILS_MAX];
    uint32_t count = 0;
    assert_int_equal(thumbnails_choose(found, &count, c, &err), MRT_OK);
    assert_int_equal(count, 8);
    for (int i = 0; i < 8; ++i) {
        assert_int_equal(found[i].frame, expected[i]);
        assert_near(found[i].distance_mm, distance_mm[i], 1e-5);
    }
    clip_destroy(c);
    mesh_destroy(&m);
}

static void short_clips_have_fewer_moments(void **state)
{
    (void)state;
    error err;
    mesh m = shapes_wall(10, 0);
    const float shift_mm[7] = {1, 2, 3, 4, 5, 6, 7};
    for (uint32_t frames = 0; frames <= 7; ++frames) {
        clip *c = shifted_clip(&m, shift_mm, frames, 30.0);
        thumbnail found[THUMBNAILS_MAX];
        uint32_t count = 99;
        assert_int_equal(thumbnails_choose(found, &count, c, &err), MRT_OK);
        assert_int_equal(count, frames);
        for (uint32_t i = 0; i < count; ++i)
            assert_int_equal(found[i].frame, i);
        clip_destroy(c);
    }
    mesh_destroy(&m);
}

static void a_long_clip_shows_what_lasts(void **state)
{
    (void)state;
    enum { FRAMES = 8 * 500 };
    error err;
    mesh m = shapes_wall(10, 0);
    float *shift_mm = calloc(FRAMES, sizeof *shift_mm);
    assert_non_null(shift_mm);
    for (uint32_t f = 0; f < FRAMES; ++f)
        if (f % 500 >= 200 && f % 500 < 230)
            shift_mm[f] = 4.0f;
    clip *c = shifted_clip(&m, shift_mm, FRAMES, 60.0);
    thumbnail found[THUMBNAILS_MAX];
    uint32_t count = 0;
    assert_int_equal(thumbnails_choose(found, &count, c, &err), MRT_OK);
    assert_int_equal(count, 8);
    for (uint32_t i = 0; i < count; ++i) {
        assert_in_range(found[i].frame, i * 500 + 200, i * 500 + 229);
        assert_near(found[i].distance_mm, 4.0, 1e-5);
    }
    clip_destroy(c);
    free(shift_mm);
    mesh_destroy(&m);
}

typedef struct picture {
    uint32_t width, height;
    uint8_t *rgba;
} picture;

static picture read_picture(void)
{
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = PNG_FORMAT_RGBA;
    picture p = {image.width, image.height, malloc(PNG_IMAGE_SIZE(image))};
    assert_non_null(p.rgba);
    assert_true(png_image_finish_read(&image, NULL, p.rgba, 0, NULL));
    return p;
}

/* Pixels of a rectangle that are brighter than a third of white. */
static uint32_t bright_count(const picture *p, uint32_t x, uint32_t y, uint32_t width,
                             uint32_t height)
{
    uint32_t count = 0;
    for (uint32_t row = y; row < y + height; ++row)
        for (uint32_t column = x; column < x + width; ++column) {
            const uint8_t *c = p->rgba + ((size_t)row * p->width + column) * 4;
            count += c[0] + c[1] + c[2] > 255;
        }
    return count;
}

/* The mean column of what is bright, or -1. */
static double bright_middle(const picture *p, uint32_t x, uint32_t y, uint32_t width,
                            uint32_t height)
{
    double sum = 0.0, count = 0.0;
    for (uint32_t column = x; column < x + width; ++column) {
        uint32_t here = bright_count(p, column, y, 1, height);
        sum += (column - x + 0.5) * here;
        count += here;
    }
    return count > 0.0 ? sum / count : -1.0;
}

static const sheet_grid *usual_grid(void)
{
    static sheet_grid grid;
    grid = sheet_lay_out(SHEET_WIDTH, SHEET_HEIGHT, 0.0f);
    return &grid;
}

/* What is bright in a view of the usual layout, and below it. */
static uint32_t bright_in_view(const picture *p, uint32_t which, uint32_t view)
{
    uint32_t at[2];
    sheet_place(at, usual_grid(), which, view);
    return bright_count(p, at[0], at[1], usual_grid()->view_width, usual_grid()->view_height);
}

static double bright_middle_of(const picture *p, uint32_t which, uint32_t view)
{
    uint32_t at[2];
    sheet_place(at, usual_grid(), which, view);
    return bright_middle(p, at[0], at[1], usual_grid()->view_width, usual_grid()->view_height);
}

static void check_words(const picture *p, uint32_t which, bool has_font)
{
    const sheet_grid *g = usual_grid();
    uint32_t at[2];
    sheet_place(at, g, which, 0);
    if (has_font)
        assert_true(bright_count(p, at[0], at[1] + g->view_height, g->view_width,
                                 g->row_height - g->view_height) > 40);
}

/* A rectangle of a layout that must not touch another. */
typedef struct part {
    float low[2], high[2];
} part;

static bool overlap(const part *a, const part *b)
{
    const float hair = 0.01f;
    return a->low[0] + hair < b->high[0] && b->low[0] + hair < a->high[0] &&
           a->low[1] + hair < b->high[1] && b->low[1] + hair < a->high[1];
}

static void nothing_overlaps_at_any_size(void **state)
{
    (void)state;
    static const uint32_t side[] = {120, 160, 333, 480, 640, 720, 1080, 1920, 3000, 8192};
    enum { SIDES = sizeof side / sizeof side[0], PLACES = 9 };
    for (int w = 0; w < SIDES; ++w)
        for (int h = 0; h < SIDES; ++h) {
            const float made_px = 0.2f * (float)side[h];
            sheet_grid g = sheet_lay_out(side[w], side[h], made_px);
            part parts[2 * PLACES + 1] = {
                {{0, 0}, {(float)side[w], g.header > 0 ? g.header + made_px : 0}}};
            for (uint32_t i = 0; i < PLACES; ++i)
                for (uint32_t view = 0; view < 2; ++view) {
                    uint32_t at[2];
                    sheet_place(at, &g, i < 8 ? i : SHEET_REST, view);
                    part *p = &parts[1 + 2 * i + view];
                    p->low[0] = (float)at[0];
                    p->low[1] = (float)at[1];
                    p->high[0] = p->low[0] + (float)g.view_width;
                    p->high[1] = p->low[1] + (float)g.row_height; /* with its words */
                    assert_true(p->high[0] <= (float)side[w] && p->high[1] <= (float)side[h]);
                }
            for (int i = 0; i <= 2 * PLACES; ++i)
                for (int k = 0; k < i; ++k)
                    assert_false(overlap(&parts[i], &parts[k]));
        }
}

static bool font_exists(void)
{
    error err;
    draw_context *context = draw_context_create(&err);
    draw_renderer *renderer = draw_renderer_create(&err);
    bool found = renderer && draw_text_font(renderer);
    draw_renderer_destroy(renderer);
    draw_context_destroy(context);
    return found;
}

static void sheet_shows_rest_and_every_moment(void **state)
{
    (void)state;
    if (!drawable)
        skip();
    bool has_font = font_exists();
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    float shift_mm[16];
    for (int f = 0; f < 16; ++f)
        shift_mm[f] = (float)(f / 2 * 12 + f % 2);
    clip *c = shifted_clip(&m, shift_mm, 16, 25.0);
    error err = {{0}};
    assert_int_equal(sheet_write(path, c, &(sheet_about){.title = "A ball goes left"}, &err),
                     MRT_OK);
    assert_true(has_font == (err.text[0] == '\0'));
    picture p = read_picture();
    assert_int_equal(p.width, SHEET_WIDTH);
    assert_int_equal(p.height, SHEET_HEIGHT);
    check_words(&p, SHEET_REST, has_font);
    if (has_font)
        assert_true(bright_count(&p, 28, 16, 400, 40) > 300); /* the title */
    double before = bright_middle_of(&p, SHEET_REST, 0);
    assert_near(bright_middle_of(&p, SHEET_REST, 1), before, 12.0);
    for (uint32_t i = 0; i < 8; ++i) {
        assert_true(bright_in_view(&p, i, 0) > 2000 && bright_in_view(&p, i, 1) > 2000);
        double middle = bright_middle_of(&p, i, 0);
        assert_true(i == 0 || middle > before + 2.0); /* one framing: the motion is seen */
        assert_true(i == 0 || middle < usual_grid()->view_width);
        before = middle;
        check_words(&p, i, has_font);
    }
    free(p.rgba);
    clip_destroy(c);
    mesh_destroy(&m);
}

/* So many pixels of the words between the header and the views: what a sheet was made from. */
static uint32_t made_from_pixels(const char *made_from, uint32_t width, uint32_t height)
{
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    const float shift_mm[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    clip *c = shifted_clip(&m, shift_mm, 8, 25.0);
    error err = {{0}};
    const sheet_about about = {
        .title = "A title", .made_from = made_from, .width = width, .height = height};
    assert_int_equal(sheet_write(path, c, &about, &err), MRT_OK);
    picture p = read_picture();
    assert_int_equal(p.width, width);
    assert_int_equal(p.height, height);
    const sheet_grid g = sheet_lay_out(width, height, 0.0f);
    const uint32_t top = (uint32_t)g.header, line = height / 48;
    uint32_t count = bright_count(&p, 0, top, width, line);
    assert_int_equal(bright_count(&p, width - 2, 0, 2, height), 0); /* nothing runs off the edge */
    free(p.rgba);
    clip_destroy(c);
    mesh_destroy(&m);
    return count;
}

static void a_sheet_says_what_it_was_made_from(void **state)
{
    (void)state;
    static char endless[4000];
    if (!drawable || !font_exists())
        skip();
    memset(endless, 'm', sizeof endless - 1);
    for (int i = 0; i < 3; ++i) {
        static const uint32_t size[3][2] = {{1920, 960}, {640, 360}, {600, 1200}};
        assert_true(made_from_pixels("marotte perform --face moai --map anchored\nanchored 1.0\n",
                                     size[i][0], size[i][1]) > 50);
        assert_true(made_from_pixels(endless, size[i][0], size[i][1]) > 50);
    }
}

static void sheet_of_three_frames_leaves_the_rest_empty(void **state)
{
    (void)state;
    if (!drawable)
        skip();
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    const float shift_mm[3] = {0, 5, 10};
    clip *c = shifted_clip(&m, shift_mm, 3, 25.0);
    error err = {{0}};
    assert_int_equal(sheet_write(path, c, &(sheet_about){0}, &err), MRT_OK);
    picture p = read_picture();
    for (uint32_t i = 0; i < 8; ++i)
        assert_true((bright_in_view(&p, i, 0) > 0) == (i < 3));
    assert_int_equal(bright_count(&p, 28, 16, 1800, 40), 0); /* no title */
    free(p.rgba);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void sheet_without_frames_shows_the_rest_face(void **state)
{
    (void)state;
    if (!drawable)
        skip();
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    error err = {{0}};
    clip *c = clip_create(&m, 60.0, NULL, &err);
    assert_int_equal(sheet_write(path, c, &(sheet_about){.title = "Nothing yet"}, &err), MRT_OK);
    picture p = read_picture();
    assert_int_equal(p.width, SHEET_WIDTH);
    const uint32_t top = (uint32_t)usual_grid()->top;
    assert_true(bright_count(&p, 480, top, 480, 700) > 30000);
    assert_true(bright_count(&p, 960, top, 480, 700) > 30000);
    free(p.rgba);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void wild_moments_and_titles_are_survived(void **state)
{
    (void)state;
    if (!drawable)
        skip();
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    const float shift_mm[2] = {1e6f, -40};
    clip *c = shifted_clip(&m, shift_mm, 2, 25.0);
    static char title[3000];
    for (size_t i = 0; i + 2 < sizeof title; i += 2)
        memcpy(title + i, "\xc3\xa9", 2);
    error err = {{0}};
    assert_int_equal(sheet_write(path, c, &(sheet_about){.title = title}, &err), MRT_OK);
    picture p = read_picture();
    assert_true(bright_in_view(&p, SHEET_REST, 0) > 500); /* rest is still to be seen */
    assert_true(bright_in_view(&p, 1, 0) > 500);
    assert_int_equal(bright_count(&p, 1900, 0, 20, 98), 0); /* the title ends in time */
    free(p.rgba);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void sheet_uses_the_context_that_is_current(void **state)
{
    (void)state;
    if (!drawable)
        skip();
    error err = {{0}};
    draw_context *context = draw_context_create(&err);
    draw_target *target = draw_target_create(8, 8, &err);
    mesh m = shapes_wall(50, 0);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    assert_int_equal(sheet_write(path, c, &(sheet_about){0}, &err), MRT_OK);
    uint8_t pixels[8 * 8 * 4];
    draw_read(target, pixels); /* the caller's context is current and whole */
    assert_int_equal(pixels[3], 255);
    clip_destroy(c);
    mesh_destroy(&m);
    draw_target_destroy(target);
    draw_context_destroy(context);
}

static void sheet_to_an_impossible_path_is_an_error(void **state)
{
    (void)state;
    if (!drawable)
        skip();
    mesh m = shapes_wall(50, 0);
    error err = {{0}};
    clip *c = clip_create(&m, 60.0, NULL, &err);
    assert_true(sheet_write("/dev/null/sheet.png", c, &(sheet_about){0}, &err) < 0);
    assert_non_null(strstr(err.text, "/dev/null"));
    clip_destroy(c);
    mesh_destroy(&m);
}

int main(void)
{
    error err = {{0}};
    draw_context *context = draw_context_create(&err);
    drawable = context != NULL;
    draw_context_destroy(context);
    if (!drawable)
        printf("SKIPPED: pictures are not tested: %s\n", err.text);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moments_are_the_furthest_of_each_eighth),
        cmocka_unit_test(short_clips_have_fewer_moments),
        cmocka_unit_test(a_long_clip_shows_what_lasts),
        cmocka_unit_test(nothing_overlaps_at_any_size),
        cmocka_unit_test(sheet_shows_rest_and_every_moment),
        cmocka_unit_test(a_sheet_says_what_it_was_made_from),
        cmocka_unit_test(sheet_of_three_frames_leaves_the_rest_empty),
        cmocka_unit_test(sheet_without_frames_shows_the_rest_face),
        cmocka_unit_test(wild_moments_and_titles_are_survived),
        cmocka_unit_test(sheet_uses_the_context_that_is_current),
        cmocka_unit_test(sheet_to_an_impossible_path_is_an_error),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    (void)remove(path);
    return failed;
}
