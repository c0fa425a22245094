/* The devices panel, as a person sees and uses it: cards of inputs, what could be opened, re-zero.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "camera_lock.h"
#include "panel_stand.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const names[] = {"log demo_hand.csv", NULL};

static void with_nothing_it_says_what_to_do(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_wait_for(&s, "No devices found");
    assert_true(stand_shows(&s, "No input is open"));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_devices_nothing");
    stand_close(&s);
}

/* The card on the stage does what the button asks for (camera_scene.c). */
static void use_the_camera_is_one_click(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte_panel_XXXXXX";
    assert_non_null(mkdtemp(folder));
    setenv("XDG_CONFIG_HOME", folder, 1);
    stand s = {.input_count = 0};
    camera_lock();
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/camera");
    stand_wait_for(&s, "Use the camera");
    stand_click(&s, "Use the camera");
    assert_int_equal(s.asked[APP_CALL_CAMERA], 1);
    stand_input(&s, "camera");
    stand_wait_for(&s, "Download hand tracking");
    assert_false(stand_shows(&s, "Use the camera"));
    assert_false(stand_shows(&s, "in a terminal"));
    stand_click(&s, "Download hand tracking");
    assert_int_equal(s.asked[APP_CALL_CAMERA], 2);
    assert_int_equal(s.notes.camera_port, 9130);
    s.notes.has_tracker = true;
    stand_wait_for(&s, "Open camera page");
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_devices_camera");
    stand_click(&s, "Show the hand on the stage");
    assert_true(settings_number(s.settings, APP_CAMERA_PREVIEW, 1.0) == 0.0);
    stand_close(&s);
}

static void a_recording_runs_and_shows_its_figures(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    stand_input(&s, demo);
    stand_wait_for(&s, "running");
    stand_click(&s, "Details");
    stand_wait_for(&s, "Jitter");
    stand_check_words(&s, names);
    stand_picture(&s, "panel_devices_running");
    stand_close(&s);
}

static void its_settings_are_set_while_it_runs(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    stand_input(&s, demo);
    stand_wait_for(&s, "running");
    stand_click(&s, "Settings");
    const ui_word *speed = stand_word(&s, "Speed");
    if (!speed)
        speed = stand_word(&s, "speed");
    assert_non_null(speed);
    float x = speed->where.x + 130.0f, y = speed->where.y + 5.0f;
    const double before = input_value(s.input[0], 0);
    stand_drag(&s, x, y, x + 80.0f, y);
    assert_true(input_value(s.input[0], 0) > before + 0.5);
    stand_picture(&s, "panel_devices_settings");
    stand_close(&s);
}

static void remove_closes_the_input(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    stand_input(&s, demo);
    stand_wait_for(&s, "running");
    stand_click(&s, "Remove");
    assert_int_equal(s.input_count, 0);
    assert_true(stand_shows(&s, "No input is open"));
    stand_close(&s);
}

static void what_is_refused_is_said_in_the_panel_and_in_the_news(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    stand_input(&s, demo);
    stand_wait_for(&s, "running");
    s.refusal = "a take is being recorded: stop it first";
    stand_click(&s, "Remove");
    assert_int_equal(s.input_count, 1);
    assert_true(stand_shows(&s, "a take is being recorded"));
    assert_true(news_list_count(s.news) > 0);
    stand_close(&s);
}

static void a_recording_is_opened_by_its_path(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    assert_false(s.asked[APP_CALL_RECORDING]);
    stand_click(&s, "Browse"); /* without a path it asks for one */
    assert_true(s.asked[APP_CALL_RECORDING]);
    stand_click(&s, "path of a log file");
    stand_type(&s, "/a, comma.csv");
    stand_key(&s, UI_KEY_ENTER);
    assert_int_equal(s.input_count, 0);
    assert_true(stand_shows(&s, "contains a comma"));
    stand_click(&s, "/a, comma.csv");
    stand_type(&s, SOURCE_DIR "/plugins/log/demo_hand.csv");
    stand_key(&s, UI_KEY_ENTER); /* opens */
    assert_int_equal(s.input_count, 1);
    stand_settle(&s);
    assert_false(stand_shows(&s, "contains a comma"));
    assert_true(strstr(s.input_text[0], ",loop=1") != NULL);
    stand_wait_for(&s, "running");
    stand_close(&s);
}

static void the_demo_hand_is_always_offered(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    stand_click(&s, "Demo hand");
    assert_int_equal(s.input_count, 1);
    assert_non_null(strstr(s.input_text[0], "demo_hand.csv,loop=1"));
    stand_wait_for(&s, "running");
    assert_true(stand_shows(&s, "Demo hand"));
    stand_check_words(&s, (const char *const[]){"log demo_hand.csv", NULL});
    stand_close(&s);
}

/* Something else that was opened, by whatever way, ends what was said of a failure. */
static void an_error_goes_away_when_an_input_is_opened(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    stand_click(&s, "path of a log file");
    stand_type(&s, "/a, comma.csv");
    stand_key(&s, UI_KEY_ENTER);
    assert_true(stand_shows(&s, "contains a comma"));
    stand_input(&s, demo);
    stand_settle(&s);
    assert_false(stand_shows(&s, "contains a comma"));
    stand_close(&s);
}

static void a_refused_rezero_says_why_until_one_works(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_click(&s, "Re-zero");
    assert_int_equal(s.done, ACTION_REZERO);
    s.status.rezeros.refused = 1;
    (void)snprintf(s.status.rezeros.refusal.text, sizeof s.status.rezeros.refusal.text,
                   "the right hand moves: hold it still");
    stand_settle(&s);
    assert_true(stand_shows(&s, "the right hand moves"));
    s.status.rezeros.done = 1;
    stand_settle(&s);
    assert_false(stand_shows(&s, "the right hand moves"));
    stand_close(&s);
}

static void the_rezero_pedal_is_kept_between_runs(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 1.0f);
    stand_click(&s, "no pedal");
    stand_click(&s, "pedal 3");
    assert_int_equal(s.rezero_pedal, 3);
    s.rezero_pedal = 0;
    stand_reopen_panel(&s);
    assert_int_equal(s.rezero_pedal, 3);
    assert_true(stand_shows(&s, "pedal 3"));
    stand_close(&s);
}

/* ---- calibrations ---- */

static void write_glove_log(const char *path)
{
    char command[2048];
    (void)snprintf(command, sizeof command, "awk -f '%s/tests/e2e/calibrate_glove.awk' >'%s'",
                   SOURCE_DIR, path);
    assert_int_equal(system(command), 0);
}

static void write_calibration(const char *folder, const char *name, const char *hand)
{
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/%s.json", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "{\"marotte_calibration\": 1, \"name\": \"%s\", \"date\": \"2026-03-01T18:00:00Z\", "
            "\"hand\": \"%s\", \"sensor_count\": 1, \"sensors\": {\"index.mpj\": {\"source\": "
            "\"measured\", \"points\": [[62, 0], [148, 1.571]], \"neutral_rad\": 0.4}}}",
            name, hand);
    fclose(file);
}

static void a_glove_in_counts_is_read_with_a_calibration_of_its_hand(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    char root[] = "/tmp/panel_devices_XXXXXX", folder[256], glove[256], text[512];
    assert_non_null(mkdtemp(root));
    (void)snprintf(folder, sizeof folder, "%s/marotte", root);
    assert_int_equal(mkdir(folder, 0777), 0);
    (void)snprintf(folder, sizeof folder, "%s/marotte/calibrations", root);
    assert_int_equal(mkdir(folder, 0777), 0);
    setenv("XDG_CONFIG_HOME", root, 1);
    write_calibration(folder, "anna", "right");
    write_calibration(folder, "bertil", "left");
    (void)snprintf(glove, sizeof glove, "%s/glove.csv", root);
    write_glove_log(glove);
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "plugins/log");
    (void)snprintf(text, sizeof text, "log:%s,loop=1", glove);
    stand_input(&s, text);
    stand_wait_for(&s, "Right hand");
    assert_false(stand_shows(&s, "Left hand"));
    stand_picture(&s, "panel_devices_glove");
    stand_click(&s, "default");
    stand_wait_for(&s, "anna, 2026-03-01");
    assert_false(stand_shows(&s, "bertil"));
    stand_click(&s, "anna, 2026-03-01");
    assert_non_null(strstr(s.calibration[MRT_RIGHT], "/anna.json"));
    s.calibration[MRT_RIGHT][0] = '\0';
    stand_reopen_panel(&s); /* as when the program starts anew */
    assert_non_null(strstr(s.calibration[MRT_RIGHT], "/anna.json"));
    stand_close(&s);
    (void)snprintf(text, sizeof text, "rm -r '%s'", root);
    assert_int_equal(system(text), 0);
}

/* ---- what is plugged in ---- */

static void what_is_plugged_in_is_opened_or_says_what_to_do(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    char path[] = "/tmp/panel_plugged_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    setenv("MAROTTE_FLAKY", path, 1);
    stand_open(&s, &panel_devices, 1.0f);
    stand_plugin(&s, "tests/plugin/flaky");
    stand_wait_for(&s, "no permission to open it");
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_devices_plugged");
    uint32_t before = s.input_count;
    stand_click(&s, "Open");
    assert_int_equal(s.input_count, before + 1);
    assert_true(strncmp(s.input_text[0], "flaky:", 6) == 0);
    const char *address = strchr(s.input_text[0], ':') + 1;
    const ui_word *words;
    const uint32_t count = ui_words(s.ui, &words);
    for (uint32_t i = 0; i < count; ++i) /* it is not offered twice */
        assert_string_not_equal(words[i].text, address);
    assert_int_equal(unlink(path), 0);
    stand_click_at(&s, 10.0f, 10.0f); /* beside the panel, so that no hint lies over it */
    stand_wait_for(&s, "No devices found");
    unsetenv("MAROTTE_FLAKY");
    stand_close(&s);
}

static void many_inputs_scroll_and_stay_readable_at_scale_2(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_devices, 2.0f);
    stand_plugin(&s, "plugins/log");
    stand_plugin(&s, "tests/plugin/flaky");
    stand_input(&s, demo);
    stand_input(&s, "flaky:a very long address of a device that lies behind three hubs,pedal=1");
    stand_input(&s, demo);
    stand_wait_for(&s, "running");
    static const char *const cut[] = {"flaky a very long address of a device that lies behind "
                                      "three hubs",
                                      "log demo_hand.csv", NULL};
    stand_check_words(&s, cut);
    stand_picture(&s, "panel_devices_many_2x");
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_nothing_it_says_what_to_do),
        cmocka_unit_test(use_the_camera_is_one_click),
        cmocka_unit_test(a_recording_runs_and_shows_its_figures),
        cmocka_unit_test(its_settings_are_set_while_it_runs),
        cmocka_unit_test(remove_closes_the_input),
        cmocka_unit_test(what_is_refused_is_said_in_the_panel_and_in_the_news),
        cmocka_unit_test(a_recording_is_opened_by_its_path),
        cmocka_unit_test(the_demo_hand_is_always_offered),
        cmocka_unit_test(an_error_goes_away_when_an_input_is_opened),
        cmocka_unit_test(a_refused_rezero_says_why_until_one_works),
        cmocka_unit_test(the_rezero_pedal_is_kept_between_runs),
        cmocka_unit_test(a_glove_in_counts_is_read_with_a_calibration_of_its_hand),
        cmocka_unit_test(what_is_plugged_in_is_opened_or_says_what_to_do),
        cmocka_unit_test(many_inputs_scroll_and_stay_readable_at_scale_2),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
