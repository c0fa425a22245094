/* The scene around the face: looks, lights that are dragged, the wall, camera views; kept with the
 * show, and in what is exported of it. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/scene.h"
#include "window/app/kept_scenery.h"
#include "window/viewport/viewport.h"

#include "base/file.h"

#include <png.h>

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const demo_inputs[] = {demo};

/* ---- pictures ---- */

/* How bright a picture is in a rectangle of shares of it, 0..255. */
static double brightness(const char *path, double x0, double y0, double x1, double y1)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&image, path))
        fail_msg("%s: %s", path, image.message);
    image.format = PNG_FORMAT_RGB;
    uint8_t *rgb = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(rgb);
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    double sum = 0.0;
    size_t count = 0;
    for (uint32_t y = (uint32_t)(y0 * image.height); y < (uint32_t)(y1 * image.height); ++y)
        for (uint32_t x = (uint32_t)(x0 * image.width); x < (uint32_t)(x1 * image.width); ++x) {
            const uint8_t *at = rgb + 3 * ((size_t)y * image.width + x);
            sum += (at[0] + at[1] + at[2]) / 3.0;
            count += 1;
        }
    free(rgb);
    return count ? sum / (double)count : 0.0;
}

/* What a picture has at a place of shares of it. */
static void pixel(const char *path, double x, double y, uint8_t out[3])
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&image, path))
        fail_msg("%s: %s", path, image.message);
    image.format = PNG_FORMAT_RGB;
    uint8_t *rgb = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(rgb);
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    const size_t at = (size_t)(y * image.height) * image.width + (size_t)(x * image.width);
    memcpy(out, rgb + 3 * at, 3);
    free(rgb);
}

/* Whether there is more than twice as much of a colour (0 red, 2 blue) as of the two others. */
static void assert_tinted(const char *path, double x, double y, int of)
{
    uint8_t at[3];
    pixel(path, x, y, at);
    for (int i = 0; i < 3; ++i)
        if (i != of && at[of] <= 2 * at[i] + 40)
            fail_msg("%s at %.2f %.2f is %u %u %u", path, x, y, at[0], at[1], at[2]);
}

/* A PNG, red above and blue below. */
static void write_two_tones(const char *path, uint32_t width, uint32_t height)
{
    uint8_t *rgb = calloc((size_t)width * height, 3);
    assert_non_null(rgb);
    for (size_t i = 0; i < (size_t)width * height; ++i)
        rgb[3 * i + (i < (size_t)width * (height / 2) ? 0 : 2)] = 220;
    png_image image = {
        .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGB};
    assert_true(png_image_write_to_file(&image, path, 0, rgb, 0, NULL));
    free(rgb);
}

static double wall_brightness(scene *s, const char *name)
{
    char path[512];
    scene_picture(s, name);
    (void)snprintf(path, sizeof path, "%s/out/%s.png", BUILD_DIR, name);
    return brightness(path, 0.01, 0.12, 0.06, 0.3);
}

/* ---- conditions ---- */

static bool has_samples(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->sample_count > 50;
}

static bool is_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->recorded_ns > 300 * NS_PER_MS;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return !app_status(s->app)->is_recording && app_take_id(s->app) != 0;
}

static void open_stage(scene *s)
{
    const scene_options same = {.show_path = s->show, .inputs = demo_inputs, .input_count = 1};
    scene_open_again(s, &same);
    scene_click_word(s, "Scene");
}

static bool has_backdrop(scene *s, void *data)
{
    uint64_t number;
    (void)data;
    return kept_scenery_picture(app_scenery(s->app), &number)->rgba != NULL;
}

static bool reads_nothing(scene *s, void *data)
{
    (void)data;
    return !kept_scenery_is_reading(app_scenery(s->app));
}

static void open_panel(scene *s)
{
    const scene_options options = {
        .width_px = 1280, .height_px = 800, .scale = 1.0f, .inputs = demo_inputs, .input_count = 1};
    scene_open_with(s, &options);
    scene_let_cut(s, "demo_hand");
    scene_click_word(s, "Scene");
    assert_int_equal(app_looks_of(s->app)->layouts.now.current, APP_SCENE);
}

/* ---- what is done ---- */

static void a_look_is_a_click_and_is_the_shows(void **state)
{
    scene s;
    (void)state;
    open_panel(&s);
    const double studio = wall_brightness(&s, "scene_studio");
    scene_check_words(&s);
    scene_click_word(&s, "Theatre");
    const double theatre = wall_brightness(&s, "scene_theatre");
    scene_click_word(&s, "Daylight");
    const double daylight = wall_brightness(&s, "scene_daylight");
    assert_true(theatre < studio && daylight > studio + 80.0);
    open_stage(&s);
    assert_float_equal(kept_scenery_now(app_scenery(s.app))->light.room,
                       lighting_looks[2].light.room, 1e-4f);
    assert_true(wall_brightness(&s, "scene_again") > studio + 80.0);
    scene_close(&s);
}

static void a_light_is_dragged_and_turned_behind(void **state)
{
    scene s;
    (void)state;
    open_panel(&s);
    const lighting_lamp before = kept_scenery_now(app_scenery(s.app))->light.lamp[LIGHTING_KEY];
    const ui_word *key = scene_word(&s, "K");
    assert_non_null(key);
    const float x = key->where.x + 0.5f * key->where.width;
    const float y = key->where.y + 0.5f * key->where.height;
    scene_drag(&s, x, y, x + 60.0f, y + 10.0f, 6);
    const lighting_lamp *now = &kept_scenery_now(app_scenery(s.app))->light.lamp[LIGHTING_KEY];
    assert_true(now->direction[0] > before.direction[0] + 0.5f);
    assert_true(now->direction[1] < before.direction[1]);
    assert_true(now->direction[2] > 0.0f);
    scene_look(&s, "scene_dragged");
    key = scene_word(&s, "K");
    const float to_x = key->where.x + 0.5f * key->where.width;
    const float to_y = key->where.y + 0.5f * key->where.height;
    scene_click(&s, to_x, to_y);
    scene_click(&s, to_x, to_y); /* the second of a double click */
    assert_true(kept_scenery_now(app_scenery(s.app))->light.lamp[LIGHTING_KEY].direction[2] < 0.0f);
    scene_look(&s, "scene_behind");
    const float kept = kept_scenery_now(app_scenery(s.app))->light.lamp[LIGHTING_KEY].direction[0];
    open_stage(&s);
    assert_float_equal(kept_scenery_now(app_scenery(s.app))->light.lamp[LIGHTING_KEY].direction[0],
                       kept, 1e-3f);
    scene_close(&s);
}

static void a_view_of_the_camera_is_kept_and_come_back_to(void **state)
{
    scene s;
    draw_camera_view there, here;
    (void)state;
    open_panel(&s);
    scene_do(&s, ACTION_VIEW_SIDE);
    scene_frames(&s, 60);
    there = viewport_view(app_viewport(s.app));
    scene_click_word(&s, "Save view");
    assert_int_equal(kept_scenery_now(app_scenery(s.app))->view_count, 1);
    scene_do(&s, ACTION_VIEW_FRONT);
    scene_frames(&s, 60);
    here = viewport_view(app_viewport(s.app));
    assert_true(fabs(here.number[0] - there.number[0]) > 0.5);
    open_stage(&s);
    scene_click_word(&s, "View 1");
    scene_frames(&s, 60);
    here = viewport_view(app_viewport(s.app));
    for (int i = 0; i < DRAW_VIEW_NUMBERS; ++i)
        assert_true(fabs(here.number[i] - there.number[i]) < 1e-3);
    scene_check_words(&s);
    scene_move(&s, 300.0f, 300.0f); /* the hint goes away */
    scene_frames(&s, 30);
    scene_click_word(&s, "Remove");
    assert_int_equal(kept_scenery_now(app_scenery(s.app))->view_count, 0);
    scene_close(&s);
}

static void what_is_exported_is_lit_as_the_stage_is(void **state)
{
    scene s;
    char command[1200], path[256];
    (void)state;
    open_panel(&s);
    scene_click_word(&s, "Daylight");
    assert_true(scene_until(&s, has_samples, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recorded, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, NULL));
    scene_end(&s); /* its show is free for the program */
    (void)snprintf(command, sizeof command,
                   BUILD_DIR
                   "/marotte take export '%s' last --export '%s/pictures/' --size 320x180 "
                   "--fps 5 >'%s/said' 2>&1",
                   s.show, s.folder, s.folder);
    if (system(command) != 0) {
        (void)snprintf(command, sizeof command, "cat '%s/said'", s.folder);
        (void)!system(command);
        fail_msg("it was not exported");
    }
    (void)snprintf(path, sizeof path, "%s/pictures/00001.png", s.folder);
    assert_true(brightness(path, 0.0, 0.0, 0.1, 1.0) > 110.0); /* the bright wall */
    open_stage(&s);
    scene_close(&s);
}

/* ---- a picture behind ---- */

static void drop(scene *s, const char *path)
{
    window_drop(s->window, path);
    scene_frames(s, 3);
}

static void record_a_take(scene *s)
{
    assert_true(scene_until(s, has_samples, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, is_recorded, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_take, NULL));
}

static int run_marotte(const scene *s, const char *arguments)
{
    char command[1400];
    (void)snprintf(command, sizeof command, "cd '%s' && " BUILD_DIR "/marotte %s >said 2>&1",
                   s->folder, arguments);
    return system(command);
}

static void must_run(const scene *s, const char *arguments)
{
    char command[256];
    if (run_marotte(s, arguments) == 0)
        return;
    (void)snprintf(command, sizeof command, "cat '%s/said'", s->folder);
    (void)!system(command);
    fail_msg("marotte %s", arguments);
}

static void a_picture_behind_is_the_shows_in_the_window_and_in_exports(void **state)
{
    scene s;
    char path[256], arguments[700];
    (void)state;
    open_panel(&s);
    (void)snprintf(path, sizeof path, "%s/two tones.png", s.folder);
    write_two_tones(path, 600, 300);
    drop(&s, path);
    assert_true(scene_until(&s, has_backdrop, NULL));
    scene_frames(&s, 2);
    assert_non_null(scene_word(&s, "two tones.png"));
    scene_check_words(&s);
    scene_picture(&s, "scene_backdrop");
    assert_tinted(BUILD_DIR "/out/scene_backdrop.png", 0.03, 0.12, 0);
    assert_tinted(BUILD_DIR "/out/scene_backdrop.png", 0.03, 0.60, 2);
    record_a_take(&s);
    assert_int_equal(unlink(path), 0); /* it is in the show */
    open_stage(&s);
    assert_true(scene_until(&s, has_backdrop, NULL));
    scene_picture(&s, "scene_backdrop_again");
    assert_tinted(BUILD_DIR "/out/scene_backdrop_again.png", 0.03, 0.12, 0);
    scene_do(&s, ACTION_VIEW_SIDE);
    scene_frames(&s, 60);
    scene_click_word(&s, "Save view");
    scene_end(&s);

    (void)snprintf(arguments, sizeof arguments,
                   "take export '%s' last --export tall/ --export sheet.png --size 180x320 --fps 5",
                   s.show);
    must_run(&s, arguments);
    (void)snprintf(path, sizeof path, "%s/tall/00001.png", s.folder);
    assert_tinted(path, 0.02, 0.02, 0);
    assert_tinted(path, 0.02, 0.98, 2);
    (void)snprintf(path, sizeof path, "%s/sheet.png", s.folder);
    bool is_red = false;
    for (double y = 0.05; y < 0.95 && !is_red; y += 0.02) { /* wherever its first view begins */
        uint8_t at[3];
        pixel(path, 0.06, y, at);
        is_red = at[0] > 120 && at[1] < 60 && at[2] < 60;
    }
    assert_true(is_red);
    (void)snprintf(arguments, sizeof arguments,
                   "take export '%s' last --export view/ --view 1 --look daylight --size 320x180 "
                   "--fps 5",
                   s.show);
    must_run(&s, arguments);
    (void)snprintf(path, sizeof path, "%s/view/00001.png", s.folder);
    assert_tinted(path, 0.02, 0.02, 0); /* other lights, the picture behind stays */
    (void)snprintf(arguments, sizeof arguments,
                   "take export '%s' last --export no/ --view 4 --size 320x180", s.show);
    assert_int_not_equal(run_marotte(&s, arguments), 0); /* one view is kept */
    open_stage(&s);
    scene_close(&s);
}

static void a_picture_is_shown_whole_when_it_is_asked_for_and_removed(void **state)
{
    scene s;
    char path[256];
    (void)state;
    open_panel(&s);
    (void)snprintf(path, sizeof path, "%s/narrow.png", s.folder);
    write_two_tones(path, 40, 400);
    drop(&s, path);
    assert_true(scene_until(&s, has_backdrop, NULL));
    scenery whole = *kept_scenery_now(app_scenery(s.app));
    whole.fit = DRAW_CONTAIN;
    kept_scenery_set(app_scenery(s.app), &whole);
    kept_scenery_keep(app_scenery(s.app));
    scene_picture(&s, "scene_contain");
    uint8_t at[3];
    pixel(BUILD_DIR "/out/scene_contain.png", 0.03, 0.12, at);
    assert_true(at[0] < 60); /* the wall beside it */
    scene_click_word(&s, "Remove");
    scene_frames(&s, 3);
    assert_string_equal(kept_scenery_now(app_scenery(s.app))->picture, "");
    assert_false(has_backdrop(&s, NULL));
    scene_close(&s);
}

static bool has_news(scene *s, void *data)
{
    const news_list *news = app_news(s->app);
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        if (strstr(news_list_at(news, i)->text, data))
            return true;
    return false;
}

/* What is no picture, is cut off, or claims to be huge leaves the wall, and is said. */
static void a_hostile_picture_harms_nothing(void **state)
{
    static const uint8_t huge[] = {0x89, 'P',  'N', 'G', '\r', '\n', 0x1a, '\n', 0,    0,    0,
                                   13,   'I',  'H', 'D', 'R',  0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff,
                                   0xff, 0xff, 8,   6,   0,    0,    0,    0x32, 0x32, 0x32, 0x32};
    static const struct {
        const char *name;
        const void *bytes;
        size_t size;
    } hostile[] = {{"letter.png", "Dear Sir,", 9},
                   {"huge.png", huge, sizeof huge},
                   {"cut.jpg", "\xff\xd8\xff\xe0\0\x10JFIF", 10},
                   {"%s%n.png", "\x89PNG\r\n\x1a\n", 8}};
    scene s;
    (void)state;
    open_panel(&s);
    const double before = wall_brightness(&s, "scene_hostile_before");
    for (size_t i = 0; i < sizeof hostile / sizeof hostile[0]; ++i) {
        char path[256], said[64];
        error err = {0};
        (void)snprintf(path, sizeof path, "%s/%s", s.folder, hostile[i].name);
        assert_int_equal(file_write(path, hostile[i].bytes, hostile[i].size, &err), MRT_OK);
        drop(&s, path);
        (void)snprintf(said, sizeof said, "%s cannot be shown", hostile[i].name);
        assert_true(scene_until(&s, has_news, said));
        assert_true(scene_until(&s, reads_nothing, NULL));
        assert_string_equal(kept_scenery_now(app_scenery(s.app))->picture, "");
    }
    assert_float_equal(wall_brightness(&s, "scene_hostile"), before, 2.0);
    scene_close(&s);
}

static void a_picture_that_the_show_has_lost_is_said(void **state)
{
    scene s;
    char path[256];
    error err = {0};
    (void)state;
    open_panel(&s);
    (void)snprintf(path, sizeof path, "%s/lost.png", s.folder);
    write_two_tones(path, 60, 30);
    drop(&s, path);
    assert_true(scene_until(&s, has_backdrop, NULL));
    assert_int_equal(show_pictures_forget(app_show(s.app), "", &err), MRT_OK);
    open_stage(&s);
    assert_true(scene_until(&s, has_news, "lost.png is no longer in the show"));
    assert_false(has_backdrop(&s, NULL));
    scene_close(&s);
}

/* ---- undo ---- */

static void read_notes(scene *s, char out[3][1024])
{
    static const char *const keys[3] = {"lighting", "background", "views"};
    error err = {0};
    for (int i = 0; i < 3; ++i)
        assert_int_equal(show_note_read(app_show(s->app), keys[i], out[i], 1024, &err), MRT_OK);
}

static void all_of_the_scene_is_undone_and_done_again_bit_for_bit(void **state)
{
    scene s;
    char path[256], first[3][1024] = {""}, last[3][1024] = {""}, now[3][1024] = {""};
    (void)state;
    open_panel(&s);
    (void)snprintf(path, sizeof path, "%s/two.png", s.folder);
    write_two_tones(path, 60, 30);
    read_notes(&s, first);
    scene_click_word(&s, "Theatre");
    scene_click_word(&s, "Save view");
    drop(&s, path);
    assert_true(scene_until(&s, has_backdrop, NULL));
    scene_frames(&s, 2);
    const ui_word *fill = scene_word(&s, "F");
    assert_non_null(fill);
    scene_drag(&s, fill->where.x + 3.0f, fill->where.y + 3.0f, fill->where.x - 40.0f,
               fill->where.y + 20.0f, 5);
    scene_click_word(&s, "Remove"); /* of the picture */
    scene_frames(&s, 2);
    assert_string_equal(app_undo_words(s.app), "the background picture");
    read_notes(&s, last);
    assert_false(has_backdrop(&s, NULL));
    for (int i = 0; i < 5; ++i) {
        scene_do(&s, ACTION_UNDO);
        scene_frames(&s, 2);
        assert_true(i > 0 || scene_until(&s, has_backdrop, NULL)); /* out of the show again */
    }
    assert_string_equal(app_undo_words(s.app), "");
    read_notes(&s, now);
    assert_memory_equal(now, first, sizeof now);
    for (int i = 0; i < 5; ++i) {
        scene_do(&s, ACTION_REDO);
        scene_frames(&s, 2);
    }
    read_notes(&s, now);
    assert_memory_equal(now, last, sizeof now);
    open_stage(&s); /* what was kept comes back as it was written */
    kept_scenery_keep(app_scenery(s.app));
    assert_string_equal(app_undo_words(s.app), "");
    scene_close(&s);
}

/* ---- the text ---- */

static void the_text_of_a_scene_comes_back_and_nonsense_is_refused(void **state)
{
    static const char *const nonsense[] = {
        "", "1", "2 0 0 1", "1 nan", "1 0 0 0 1 1 1 1", "1 1e99 0 0 1 1 1 1", "studio"};
    char text[LIGHTING_TEXT], longer[LIGHTING_TEXT + 8];
    (void)state;
    for (int i = 0; i < LIGHTING_LOOKS; ++i) {
        lighting back = lighting_looks[0].light;
        lighting_write(&lighting_looks[i].light, text);
        assert_true(strlen(text) < LIGHTING_TEXT - 1);
        assert_true(lighting_parse(&back, text));
        for (int k = 0; k < 3; ++k)
            assert_float_equal(back.lamp[LIGHTING_RIM].direction[k],
                               lighting_looks[i].light.lamp[LIGHTING_RIM].direction[k], 1e-3f);
        assert_float_equal(back.wall_light[2], lighting_looks[i].light.wall_light[2], 1e-4f);
        (void)snprintf(longer, sizeof longer, "%s 1", text);
        assert_false(lighting_parse(&back, longer));
        for (char *c = text; (c = strchr(c, ' ')); ++c) { /* any number may be wrong */
            char wrong[LIGHTING_TEXT];
            (void)snprintf(wrong, sizeof wrong, "%.*s x%s", (int)(c - text), text, c + 1);
            assert_false(lighting_parse(&back, wrong));
        }
    }
    for (size_t i = 0; i < sizeof nonsense / sizeof nonsense[0]; ++i) {
        lighting back = lighting_looks[1].light;
        assert_false(lighting_parse(&back, nonsense[i]));
        assert_memory_equal(&back, &lighting_looks[1].light, sizeof back);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_look_is_a_click_and_is_the_shows),
        cmocka_unit_test(a_light_is_dragged_and_turned_behind),
        cmocka_unit_test(a_view_of_the_camera_is_kept_and_come_back_to),
        cmocka_unit_test(what_is_exported_is_lit_as_the_stage_is),
        cmocka_unit_test(a_picture_behind_is_the_shows_in_the_window_and_in_exports),
        cmocka_unit_test(a_picture_is_shown_whole_when_it_is_asked_for_and_removed),
        cmocka_unit_test(a_hostile_picture_harms_nothing),
        cmocka_unit_test(a_picture_that_the_show_has_lost_is_said),
        cmocka_unit_test(all_of_the_scene_is_undone_and_done_again_bit_for_bit),
        cmocka_unit_test(the_text_of_a_scene_comes_back_and_nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
