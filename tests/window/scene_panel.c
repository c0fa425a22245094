/* The scene around the face: looks, lights that are dragged, the wall, camera views; kept with the
 * show, and in what is exported of it. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/scene.h"
#include "window/viewport/viewport.h"

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

static void close_stage(scene *s)
{
    workspace_destroy(s->workspace);
    app_destroy(s->app);
}

static void open_stage(scene *s)
{
    const scene_options same = {.show_path = s->show, .inputs = demo_inputs, .input_count = 1};
    scene_open_again(s, &same);
    scene_click_word(s, "Scene");
}

static void open_again(scene *s)
{
    close_stage(s);
    open_stage(s);
}

static void open_panel(scene *s)
{
    const scene_options options = {
        .width_px = 1280, .height_px = 800, .scale = 1.0f, .inputs = demo_inputs, .input_count = 1};
    scene_open_with(s, &options);
    scene_let_cut(s, "demo_hand");
    scene_click_word(s, "Scene");
    assert_int_equal(app_looks_of(s->app)->panel, APP_SCENE);
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
    open_again(&s);
    assert_float_equal(app_scene_of(s.app)->light.room, lighting_looks[2].light.room, 1e-4f);
    assert_true(wall_brightness(&s, "scene_again") > studio + 80.0);
    scene_close(&s);
}

static void a_light_is_dragged_and_turned_behind(void **state)
{
    scene s;
    (void)state;
    open_panel(&s);
    const lighting_lamp before = app_scene_of(s.app)->light.lamp[LIGHTING_KEY];
    const ui_word *key = scene_word(&s, "K");
    assert_non_null(key);
    const float x = key->where.x + 0.5f * key->where.width;
    const float y = key->where.y + 0.5f * key->where.height;
    scene_drag(&s, x, y, x + 60.0f, y + 10.0f, 6);
    const lighting_lamp *now = &app_scene_of(s.app)->light.lamp[LIGHTING_KEY];
    assert_true(now->direction[0] > before.direction[0] + 0.5f);
    assert_true(now->direction[1] < before.direction[1]);
    assert_true(now->direction[2] > 0.0f);
    scene_picture(&s, "scene_dragged");
    key = scene_word(&s, "K");
    const float to_x = key->where.x + 0.5f * key->where.width;
    const float to_y = key->where.y + 0.5f * key->where.height;
    scene_click(&s, to_x, to_y);
    scene_click(&s, to_x, to_y); /* the second of a double click */
    assert_true(app_scene_of(s.app)->light.lamp[LIGHTING_KEY].direction[2] < 0.0f);
    scene_picture(&s, "scene_behind");
    const float kept = app_scene_of(s.app)->light.lamp[LIGHTING_KEY].direction[0];
    open_again(&s);
    assert_float_equal(app_scene_of(s.app)->light.lamp[LIGHTING_KEY].direction[0], kept, 1e-3f);
    scene_close(&s);
}

static void a_view_of_the_camera_is_kept_and_come_back_to(void **state)
{
    scene s;
    double there[APP_VIEW_NUMBERS], here[APP_VIEW_NUMBERS];
    (void)state;
    open_panel(&s);
    scene_do(&s, ACTION_VIEW_SIDE);
    scene_frames(&s, 60);
    viewport_view(app_viewport(s.app), there);
    scene_click_word(&s, "Keep this view");
    assert_int_equal(app_scene_of(s.app)->view_count, 1);
    scene_do(&s, ACTION_VIEW_FRONT);
    scene_frames(&s, 60);
    viewport_view(app_viewport(s.app), here);
    assert_true(fabs(here[0] - there[0]) > 0.5);
    open_again(&s);
    scene_click_word(&s, "View 1");
    scene_frames(&s, 60);
    viewport_view(app_viewport(s.app), here);
    for (int i = 0; i < APP_VIEW_NUMBERS; ++i)
        assert_true(fabs(here[i] - there[i]) < 1e-3);
    scene_check_words(&s);
    scene_click_word(&s, "Remove");
    assert_int_equal(app_scene_of(s.app)->view_count, 0);
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
    close_stage(&s); /* its show is free for the program */
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
        cmocka_unit_test(the_text_of_a_scene_comes_back_and_nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
