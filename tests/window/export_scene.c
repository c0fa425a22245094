/* The export dialog in the whole window: what already exists is asked about, what goes on says
 * how far it is and can be cancelled. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "scene.h"
#include "window/app/exporter.h"

static bool has_recorded(scene *s, void *data)
{
    return app_status(s->app)->recorded_ns > *(const int64_t *)data;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return app_take(s->app) != NULL && !app_status(s->app)->is_recording;
}

static bool are_exports(scene *s, void *data)
{
    return exporter_count(app_exporter(s->app)) == *(uint32_t *)data;
}

static void open_sized(scene *s, uint32_t width_px, uint32_t height_px, float scale)
{
    static char hand[512];
    static const char *const inputs[] = {hand};
    (void)snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    const scene_options options = {.width_px = width_px,
                                   .height_px = height_px,
                                   .scale = scale,
                                   .inputs = inputs,
                                   .input_count = 1};
    scene_open_with(s, &options);
    scene_let_cut(s, "/tmp/");
    scene_let_cut(s, "demo_hand");
}

static void open_with_a_hand(scene *s)
{
    open_sized(s, 1280, 720, 1.0f);
}

static void record(scene *s, int64_t duration_ns)
{
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_recorded, &duration_ns));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_take, NULL));
}

static void record_a_take(scene *s)
{
    record(s, 3 * NS_PER_S); /* the hand rests for the first */
}

static void open_with_a_take(scene *s)
{
    open_with_a_hand(s);
    record_a_take(s);
}

static void ask_for_an_export(scene *s, const char *format)
{
    scene_do(s, ACTION_EXPORT);
    scene_click_word(s, "glTF, for Blender, Unity, Unreal (.glb)");
    scene_click_word(s, format);
    scene_click_word(s, "Export");
}

static void what_is_there_is_replaced_when_asked_twice(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Table (.csv)");
    assert_true(scene_until(&s, are_exports, &none));
    scene_do(&s, ACTION_EXPORT);
    scene_click_word(&s, "Export");
    assert_int_equal(exporter_count(app_exporter(s.app)), 0);
    assert_non_null(scene_word_with(&s, "already exists"));
    scene_look(&s, "export_replaces");
    scene_check_words(&s);
    scene_click_word(&s, "Export");
    assert_null(scene_word(&s, "Cancel"));
    assert_true(scene_until(&s, are_exports, &none));
    scene_close(&s);
}

static void what_goes_on_is_seen_and_cancelled(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Pictures, a folder of PNG");
    assert_int_equal(exporter_count(app_exporter(s.app)), 1);
    const ui_word *word = scene_word_with(&s, "Exporting");
    assert_non_null(word);
    scene_click(&s, word->where.x + 4.0f, word->where.y + 4.0f);
    scene_look(&s, "export_goes_on");
    scene_check_words(&s);
    scene_click_word(&s, "Cancel");
    assert_true(scene_until(&s, are_exports, &none));
    scene_frames(&s, 3);
    assert_null(scene_word_with(&s, "Exporting"));
    assert_null(scene_word(&s, "Exports"));
    scene_close(&s);
}

/* A picture is drawn in software, below all other work: where it is slow, it is waited for. */
static bool have_exports_ended(scene *s)
{
    uint32_t none = 0;
    bool over = false;
    for (uint32_t i = 0; i < 10 && !over; ++i)
        over = scene_until(s, are_exports, &none);
    return over;
}

/* Size and colour of the first picture of the folder that was exported last. */
static void look_at_picture(scene *s, uint32_t *out_width, uint32_t *out_height, uint8_t rgba[4])
{
    static const char said[] = "exported ";
    const news_list *news = app_news(s->app);
    char path[EXPORT_FILE + 32] = "";
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        if (strncmp(news_list_at(news, i)->text, said, sizeof said - 1) == 0)
            (void)snprintf(path, sizeof path, "%s/00001.png",
                           news_list_at(news, i)->text + sizeof said - 1);
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_int_not_equal(png_image_begin_read_from_file(&image, path), 0);
    image.format = PNG_FORMAT_RGBA;
    uint8_t *pixels = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(pixels);
    assert_int_not_equal(png_image_finish_read(&image, NULL, pixels, 0, NULL), 0);
    *out_width = image.width;
    *out_height = image.height;
    memcpy(rgba, pixels, 4);
    free(pixels);
}

/* What is chosen in the dialog is what the pictures are, and is there when it is asked again;
 * what a format cannot hold is said before, and cannot be chosen. */
static void pictures_are_as_the_dialog_says(void **state)
{
    (void)state;
    scene s;
    uint32_t width, height;
    uint8_t corner[4];
    open_with_a_hand(&s);
    record(&s, NS_PER_S / 4); /* some pictures are enough */
    scene_do(&s, ACTION_EXPORT);
    assert_non_null(scene_word_with(&s, "Holds: the face with all that its file has"));
    assert_null(scene_word(&s, "Background"));
    scene_click_word(&s, "glTF, for Blender, Unity, Unreal (.glb)");
    scene_click_word(&s, "Pictures, a folder of PNG");
    assert_non_null(scene_word_with(&s, "Not: sound."));
    scene_click_word(&s, "As in the take");
    scene_click_word(&s, "24");
    scene_click_word(&s, "1280 x 720");
    scene_click_word(&s, "640 x 360");
    scene_click_word(&s, "From the front");
    scene_click_word(&s, "Three-quarter view");
    scene_click_word(&s, "The wall of the stage");
    scene_click_word(&s, "Transparent");
    scene_look(&s, "export_pictures");
    scene_check_words(&s);
    scene_click_word(&s, "Export");
    assert_true(have_exports_ended(&s));
    look_at_picture(&s, &width, &height, corner);
    assert_int_equal(width, 640);
    assert_int_equal(height, 360);
    assert_int_equal(corner[3], 0);
    scene_do(&s, ACTION_EXPORT);
    assert_non_null(scene_word(&s, "640 x 360"));
    assert_non_null(scene_word(&s, "Transparent"));
    scene_click_word(&s, "Pictures, a folder of PNG");
    scene_click_word(&s, "Video (.mp4)");
    assert_null(scene_word(&s, "Transparent"));
    scene_click_word(&s, "The wall of the stage");
    assert_non_null(scene_word(&s, "Green, for keying"));
    assert_null(scene_word(&s, "Transparent"));
    scene_close(&s);
}

static bool is_over(scene *s, void *data)
{
    (void)data;
    return s->is_over;
}

/* Nothing is lost by going home: the program says what goes on, and waits when it is told to. */
static void quitting_asks_about_an_export_that_goes_on(void **state)
{
    (void)state;
    scene s;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Pictures, a folder of PNG");
    assert_int_equal(exporter_count(app_exporter(s.app)), 1);
    scene_do(&s, ACTION_QUIT);
    scene_frames(&s, 3);
    assert_false(s.is_over);
    assert_non_null(scene_word(&s, "An export is running"));
    scene_look(&s, "export_quits");
    scene_check_words(&s);
    scene_click_word(&s, "Stay");
    scene_frames(&s, 3);
    assert_null(scene_word(&s, "An export is running"));
    assert_int_equal(exporter_count(app_exporter(s.app)), 1);
    scene_do(&s, ACTION_QUIT);
    scene_frames(&s, 3);
    scene_click_word(&s, "Quit when done");
    scene_frames(&s, 3);
    assert_false(s.is_over);
    scene_click_word(&s, "Cancel"); /* the export: it is done with so */
    assert_true(scene_until(&s, is_over, NULL));
    scene_close(&s);
}

static void an_export_is_given_up_with_the_program(void **state)
{
    (void)state;
    scene s;
    open_with_a_take(&s);
    ask_for_an_export(&s, "Pictures, a folder of PNG");
    scene_do(&s, ACTION_QUIT);
    scene_frames(&s, 3);
    scene_click_word(&s, "Cancel and quit");
    assert_true(scene_until(&s, is_over, NULL));
    scene_close(&s);
}

static bool has_in_file(const char *path, const char *word)
{
    error err = {0};
    file_bytes got;
    bool has = false;
    if (file_read(&got, path, 1 << 30, &err) < 0)
        fail_msg("%s", err.text);
    for (size_t i = 0; i + strlen(word) <= got.size && !has; ++i)
        has = memcmp(got.data + i, word, strlen(word)) == 0;
    file_bytes_finish(&got);
    return has;
}

/* A pinch of clay before, and the curves of what is performed then have their names. */
static void clay_leaves_the_curves_their_names(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0;
    char path[160];
    open_with_a_hand(&s);
    scene_frames(&s, 30);
    scene_modifiers(&s, UI_CONTROL, true);
    scene_drag(&s, 460.0f, 260.0f, 480.0f, 300.0f, 12);
    scene_modifiers(&s, UI_CONTROL, false);
    scene_frames(&s, 30);
    assert_non_null(scene_word(&s, "Held pulls. Press N to clear them"));
    scene_look(&s, "export_clay");
    record_a_take(&s);
    scene_do(&s, ACTION_EXPORT);
    scene_click_word(&s, "Export");
    assert_true(scene_until(&s, are_exports, &none));
    (void)snprintf(path, sizeof path, "%s/night_1.glb", s.folder);
    assert_true(has_in_file(path, "jaw.open"));
    assert_true(has_in_file(path, "mouth.corner.l"));
    assert_false(has_in_file(path, "component1"));
    scene_do(&s, ACTION_LIVE);
    scene_do(&s, ACTION_NEUTRAL);
    scene_frames(&s, 3);
    assert_null(scene_word(&s, "Held pulls. Press N to clear them"));
    scene_modifiers(&s, UI_SHIFT, true);
    scene_drag(&s, 460.0f, 260.0f, 480.0f, 300.0f, 12);
    scene_modifiers(&s, UI_SHIFT, false);
    scene_click_word(&s, "Held pulls. Press N to clear them"); /* so does a click */
    assert_null(scene_word(&s, "Held pulls. Press N to clear them"));
    scene_close(&s);
}

static bool has_two_takes(scene *s, void *data)
{
    const app_take_line *line;
    (void)data;
    return app_takes(s->app, &line) == 2 && line[0].duration_ns > 0 && line[1].duration_ns > 0 &&
           !line[1].is_recording;
}

/* What cannot be written is said, and the others are written. */
static void several_takes_are_exported_and_one_that_fails_stops_no_other(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0;
    struct stat status;
    char path[2][160];
    open_with_a_take(&s);
    assert_int_equal(app_duplicate_take(s.app, app_take_id(s.app)), MRT_OK);
    assert_true(scene_until(&s, has_two_takes, NULL));
    assert_true(scene_until(&s, has_take, NULL));
    for (int i = 0; i < 2; ++i)
        (void)snprintf(path[i], sizeof path[i], "%s/night_%d.csv", s.folder, i + 1);
    assert_int_equal(mkdir(path[0], 0700), 0);
    scene_do(&s, ACTION_EXPORT);
    scene_click_word(&s, "glTF, for Blender, Unity, Unreal (.glb)");
    scene_click_word(&s, "Table (.csv)");
    scene_click_word(&s, "All takes");
    scene_look(&s, "export_several");
    assert_non_null(scene_word(&s, "Writes night_1.csv and 1 more"));
    scene_check_words(&s);
    scene_click_word(&s, "Export");
    assert_int_equal(exporter_count(app_exporter(s.app)), 0);
    assert_non_null(scene_word_with(&s, "already exists"));
    scene_click_word(&s, "Export");
    assert_int_equal(exporter_count(app_exporter(s.app)), 2);
    assert_true(scene_until(&s, are_exports, &none));
    assert_int_equal(app_exports_failed(s.app), 1);
    assert_int_equal(stat(path[1], &status), 0);
    assert_true(S_ISREG(status.st_mode) && status.st_size > 0);
    scene_close(&s);
}

static void a_preset_chooses_and_what_is_typed_is_checked(void **state)
{
    (void)state;
    scene s;
    open_with_a_take(&s);
    assert_int_equal(app_select_take(s.app, 0), MRT_OK); /* the newest is ticked then */
    scene_do(&s, ACTION_EXPORT);
    scene_click_word(&s, "No preset");
    scene_click_word(&s, "Pictures to lay over a film");
    assert_non_null(scene_word(&s, "Pictures, a folder of PNG"));
    assert_non_null(scene_word(&s, "1920 x 1080"));
    assert_non_null(scene_word(&s, "Transparent"));
    assert_non_null(scene_word(&s, "Writes night_1/"));
    scene_click_word(&s, "1920 x 1080");
    scene_click_word(&s, "Custom size");
    scene_click_word(&s, "Export");
    assert_int_equal(exporter_count(app_exporter(s.app)), 0);
    assert_non_null(scene_word_with(&s, "The size"));
    scene_look(&s, "export_own");
    scene_check_words(&s);
    scene_close(&s);
}

static void the_page_is_whole(uint32_t width_px, uint32_t height_px, float scale, const char *name)
{
    scene s;
    open_sized(&s, width_px, height_px, scale);
    record_a_take(&s);
    scene_do(&s, ACTION_EXPORT);
    scene_click_word(&s, "No preset");
    scene_click_word(&s, "Video, square");
    scene_look(&s, name);
    assert_int_equal(scene_word_faults(&s), 0);
    scene_close(&s);
}

static void nothing_of_the_page_is_cut_in_any_size(void **state)
{
    (void)state;
    the_page_is_whole(800, 500, 1.0f, "export_small");
    the_page_is_whole(3840, 2160, 2.0f, "export_large");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clay_leaves_the_curves_their_names),
        cmocka_unit_test(what_is_there_is_replaced_when_asked_twice),
        cmocka_unit_test(what_goes_on_is_seen_and_cancelled),
        cmocka_unit_test(pictures_are_as_the_dialog_says),
        cmocka_unit_test(several_takes_are_exported_and_one_that_fails_stops_no_other),
        cmocka_unit_test(a_preset_chooses_and_what_is_typed_is_checked),
        cmocka_unit_test(nothing_of_the_page_is_cut_in_any_size),
        cmocka_unit_test(quitting_asks_about_an_export_that_goes_on),
        cmocka_unit_test(an_export_is_given_up_with_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
