/* The calibration of a glove and of a bare hand, from the first pose to the file that is used. The
 * samples are the test's, in their own time: nothing waits. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "panel_stand.h"
#include "unit/hand_guide_poses.h"

#include "hand/calibration_file.h"
#include "hand/guide.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const int64_t period_ns = 6666667; /* 150 Hz */

typedef struct fixture {
    stand stand;
    char root[64];
    uint32_t glove; /* index of its input */
    int64_t time_ns;
    uint32_t noise, sequence;
    double pose[MRT_ANGLES]; /* degrees, where the hand is now */
} fixture;

/* ---- a glove: raw = zero + counts * degrees; a bare hand: too little of what it does ---- */

static void give(fixture *d)
{
    stand *s = &d->stand;
    uint32_t count;
    const mrt_channel *channel = input_channels(s->input[d->glove], &count);
    mrt_sample sample = {.time_ns = d->time_ns, .sequence = d->sequence++, .count = count};
    for (uint32_t c = 0; c < count; ++c) {
        uint32_t i = channel[c].semantic - MRT_CH_ANGLE;
        if (i >= MRT_ANGLES)
            continue;
        bool is_spread = sensor_table[i].kind == SENSOR_SPREAD;
        double zero = is_spread ? 190.0 - i : 60.0 + i, gain = is_spread ? -1.9 : 1.1;
        d->noise = d->noise * 1664525u + 1013904223u;
        double jitter = (double)(d->noise >> 24) / 256.0 - 0.5;
        sample.value[c] = strcmp(channel[c].unit, "rad") == 0
                              ? (float)(0.0174533 * (4.0 + 0.7 * d->pose[i] + 3.0 * jitter))
                              : (float)floor(zero + gain * d->pose[i] + 0.5 + jitter);
    }
    d->time_ns += period_ns;
    assert_true(s->tap_count < 4096);
    s->tap[s->tap_count++] = sample;
}

/* Half a second of moving there, then a hold. */
static void go(fixture *d, const double *to, double hold_s)
{
    double from[MRT_ANGLES];
    memcpy(from, d->pose, sizeof from);
    d->stand.tap_count = d->stand.tap_taken = 0;
    for (int k = 1; k <= 75; ++k) {
        for (int i = 0; i < MRT_ANGLES; ++i)
            d->pose[i] = from[i] + (to[i] - from[i]) * k / 75.0;
        give(d);
    }
    for (int k = 0; k < (int)(hold_s * 150.0); ++k)
        give(d);
    stand_settle(&d->stand);
}

static void perform(fixture *d, guide_step step, double hold_s)
{
    double pose[MRT_ANGLES];
    pose_of(pose, step);
    go(d, pose, hold_s);
}

/* ---- the fixture ---- */

static void open_fixture_behind(fixture *d, float scale, const char *other)
{
    char path[256], command[1024], text[512];
    memset(d, 0, sizeof *d);
    d->time_ns = 5000000000;
    d->noise = 1;
    (void)snprintf(d->root, sizeof d->root, "/tmp/panel_calibrate_XXXXXX");
    assert_non_null(mkdtemp(d->root));
    setenv("XDG_CONFIG_HOME", d->root, 1);
    (void)snprintf(path, sizeof path, "%s/glove.csv", d->root);
    (void)snprintf(command, sizeof command, "awk -f '%s/tests/e2e/calibrate_glove.awk' >'%s'",
                   SOURCE_DIR, path);
    assert_int_equal(system(command), 0);
    stand_open(&d->stand, &panel_devices, scale);
    stand_plugin(&d->stand, "plugins/log");
    if (other)
        stand_input(&d->stand, other);
    d->glove = d->stand.input_count;
    (void)snprintf(text, sizeof text, "log:%s,loop=1", path);
    stand_input(&d->stand, text);
    stand_wait_for(&d->stand, "Calibrate\xe2\x80\xa6");
    stand_click(&d->stand, "Calibrate\xe2\x80\xa6");
    assert_true(stand_shows(&d->stand, "Calibrate the right hand"));
    assert_int_equal(d->stand.tapped, d->glove);
}

/* Of the fingers of a sender. */
static void open_bare_fixture(fixture *d)
{
    char text[64];
    memset(d, 0, sizeof *d);
    d->time_ns = 5000000000;
    d->noise = 1;
    (void)snprintf(d->root, sizeof d->root, "/tmp/panel_calibrate_XXXXXX");
    assert_non_null(mkdtemp(d->root));
    setenv("XDG_CONFIG_HOME", d->root, 1);
    stand_open(&d->stand, &panel_devices, 1.0f);
    stand_plugin(&d->stand, "plugins/osc");
    (void)snprintf(text, sizeof text, "osc:127.0.0.1:%d", 20000 + (int)(getpid() % 20000));
    stand_input(&d->stand, text);
    stand_wait_for(&d->stand, "Calibrate\xe2\x80\xa6");
    stand_click(&d->stand, "Calibrate\xe2\x80\xa6");
    assert_true(stand_shows(&d->stand, "Calibrate the right hand"));
}

static void open_fixture(fixture *d, float scale)
{
    open_fixture_behind(d, scale, NULL);
}

static void close_fixture(fixture *d)
{
    char command[256];
    stand_close(&d->stand);
    (void)snprintf(command, sizeof command, "rm -r '%s'", d->root);
    assert_int_equal(system(command), 0);
}

static void ten_poses_become_a_calibration_that_is_used(void **state)
{
    (void)state;
    fixture d;
    open_fixture(&d, 1.0f);
    stand *s = &d.stand;
    for (guide_step step = GUIDE_RELAXED; step < GUIDE_STEPS; ++step) {
        assert_true(stand_shows(s, "pose "));
        perform(&d, step, 1.5);
        if (step == GUIDE_FIST) {
            stand_check_words(s, NULL);
            stand_picture(s, "panel_calibrate_pose");
        }
    }
    assert_true(stand_shows(s, "All poses are done."));
    assert_true(stand_shows(s, "ring knuckle changes when middle knuckle moves: 50 %"));
    stand_check_words(s, NULL);
    stand_picture(s, "panel_calibrate_result");
    stand_key(s, UI_KEY_ESCAPE);
    stand_settle(s);
    assert_true(stand_shows(s, "10 poses were recorded. They are not saved yet."));
    stand_picture(s, "panel_calibrate_giving_up");
    stand_key(s, UI_KEY_ESCAPE);
    stand_settle(s);
    assert_true(stand_shows(s, "All poses are done."));
    stand_click(s, "right hand");
    stand_type(s, "anna");
    stand_key(s, UI_KEY_ENTER); /* saves and uses it */
    assert_false(stand_shows(s, "All poses are done."));
    assert_int_equal(s->tapped, UINT32_MAX);
    assert_non_null(strstr(s->calibration[MRT_RIGHT], "/marotte/calibrations/anna.json"));
    calibration_file *file = calloc(1, sizeof *file);
    error err = {""};
    assert_int_equal(calibration_file_read(file, s->calibration[MRT_RIGHT], &err), MRT_OK);
    assert_string_equal(file->name, "anna");
    assert_int_equal(file->sensor[SENSOR_INDEX_MPJ].source, CALIBRATION_MEASURED);
    calibration_file_finish(file);
    free(file);
    stand_wait_for(s, "anna, ");
    close_fixture(&d);
}

static void the_hand_that_is_drawn_makes_the_poses_that_are_taken(void **state)
{
    (void)state;
    fixture d;
    open_fixture(&d, 1.0f);
    for (guide_step step = GUIDE_RELAXED; step < GUIDE_STEPS; ++step) {
        float angle_rad[MRT_ANGLES];
        double pose[MRT_ANGLES];
        char name[64];
        (void)snprintf(name, sizeof name, "panel_calibrate_figure_%d", (int)step);
        stand_picture(&d.stand, name);
        guide_pose(step, angle_rad);
        for (int i = 0; i < MRT_ANGLES; ++i)
            pose[i] = (double)angle_rad[i] / 0.017453292519943295;
        stand_check_words(&d.stand, NULL);
        go(&d, pose, 1.5);
        (void)snprintf(name, sizeof name, "pose %d of 10", (int)step + 2);
        assert_true(step + 1 == GUIDE_STEPS || stand_shows(&d.stand, name));
    }
    assert_true(stand_shows(&d.stand, "All poses are done."));
    close_fixture(&d);
}

static void a_bare_hand_is_calibrated_by_three_poses(void **state)
{
    (void)state;
    static const guide_step steps[] = {GUIDE_FLAT, GUIDE_FIST, GUIDE_SPREAD};
    fixture d;
    open_bare_fixture(&d);
    stand *s = &d.stand;
    for (int k = 0; k < 3; ++k) {
        char words[32];
        (void)snprintf(words, sizeof words, "pose %d of 3", k + 1);
        assert_true(stand_shows(s, words));
        perform(&d, steps[k], 1.5);
        if (k == 0) {
            assert_true(stand_shows(s, "Make a tight fist, the thumb outside."));
            stand_check_words(s, NULL);
            stand_picture(s, "panel_calibrate_bare");
        }
    }
    assert_true(stand_shows(s, "All poses are done."));
    assert_true(stand_shows(s, "Every joint matches the poses."));
    stand_check_words(s, NULL);
    stand_click(s, "Save and use");
    assert_non_null(
        strstr(s->calibration[MRT_RIGHT], "/marotte/calibrations/right hand, osc.json"));
    stand_wait_for(s, "right hand, 20");
    close_fixture(&d);
}

static void what_is_nonsense_is_said_with_the_pose_that_mends_it(void **state)
{
    (void)state;
    fixture d;
    double pose[MRT_ANGLES];
    open_fixture(&d, 1.0f);
    stand *s = &d.stand;
    for (guide_step step = GUIDE_RELAXED; step < GUIDE_INDEX_ALONE; ++step)
        perform(&d, step, 1.5);
    pose_of(pose, GUIDE_INDEX_ALONE);
    pose[12] = 70; /* the ring finger's middle joint, which should be straight */
    go(&d, pose, 1.5);
    for (guide_step step = GUIDE_MIDDLE_ALONE; step < GUIDE_STEPS; ++step)
        perform(&d, step, 1.5);
    assert_true(stand_shows(s, "All poses are done, but 1 sensor is not right."));
    assert_true(stand_shows(s, "ring finger, middle joint: reads "));
    stand_check_words(s, NULL);
    stand_picture(s, "panel_calibrate_wrong");
    stand_click(s, "Repeat: index alone");
    assert_true(stand_shows(s, "pose 7 of 10"));
    stand_click(s, "Skip"); /* as it was */
    assert_true(stand_shows(s, "All poses are done, but 1 sensor is not right."));
    stand_click(s, "Repeat: index alone");
    stand_check_words(s, NULL);
    perform(&d, GUIDE_FLAT, 0.0);
    perform(&d, GUIDE_INDEX_ALONE, 1.5);
    assert_true(stand_shows(s, "All poses are done."));
    assert_false(stand_shows(s, "Repeat: index alone"));
    close_fixture(&d);
}

static void buttons_take_skip_and_go_back(void **state)
{
    (void)state;
    fixture d;
    open_fixture(&d, 1.0f);
    stand *s = &d.stand;
    perform(&d, GUIDE_RELAXED, 0.3); /* not long enough by itself */
    assert_true(stand_shows(s, "pose 1 of 10"));
    stand_click(s, "Record now");
    assert_true(stand_shows(s, "pose 2 of 10"));
    stand_click(s, "Skip");
    assert_true(stand_shows(s, "pose 2 of 10"));
    assert_true(stand_shows(s, "the flat hand cannot be skipped"));
    stand_click(s, "Back");
    assert_true(stand_shows(s, "pose 1 of 10"));
    stand_click(s, "Skip");
    assert_true(stand_shows(s, "pose 2 of 10"));
    perform(&d, GUIDE_FLAT, 0.3);
    stand_key(s, UI_KEY_ENTER);
    assert_true(stand_shows(s, "pose 3 of 10"));
    close_fixture(&d);
}

static void escape_leaves_and_keeps_nothing(void **state)
{
    (void)state;
    fixture d;
    char path[256];
    open_fixture(&d, 2.0f);
    stand *s = &d.stand;
    perform(&d, GUIDE_RELAXED, 1.5);
    stand_check_words(s, NULL);
    stand_picture(s, "panel_calibrate_2x");
    stand_key(s, UI_KEY_ESCAPE);
    stand_settle(s);
    assert_false(stand_shows(s, "pose "));
    assert_int_equal(s->tapped, UINT32_MAX);
    (void)snprintf(path, sizeof path, "%s/marotte/calibrations", d.root);
    assert_int_not_equal(access(path, F_OK), 0);
    assert_string_equal(s->calibration[MRT_RIGHT], "");
    close_fixture(&d);
}

static void a_glove_that_is_removed_closes_it(void **state)
{
    (void)state;
    fixture d;
    error err = {""};
    open_fixture(&d, 1.0f);
    assert_int_equal(live_remove_input(NULL, 0, &err), MRT_OK);
    stand_settle(&d.stand);
    stand_settle(&d.stand);
    assert_false(stand_shows(&d.stand, "pose "));
    close_fixture(&d);
}

static void it_goes_on_when_an_input_before_the_glove_is_removed(void **state)
{
    (void)state;
    fixture d;
    error err = {""};
    open_fixture_behind(&d, 1.0f, "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1");
    assert_int_equal(d.glove, 1);
    assert_int_equal(live_remove_input(NULL, 0, &err), MRT_OK);
    d.glove = 0;
    stand_settle(&d.stand);
    assert_true(stand_shows(&d.stand, "pose 1 of 10"));
    assert_int_equal(d.stand.tapped, 0);
    perform(&d, GUIDE_RELAXED, 1.5);
    assert_true(stand_shows(&d.stand, "pose 2 of 10"));
    close_fixture(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ten_poses_become_a_calibration_that_is_used),
        cmocka_unit_test(the_hand_that_is_drawn_makes_the_poses_that_are_taken),
        cmocka_unit_test(a_bare_hand_is_calibrated_by_three_poses),
        cmocka_unit_test(what_is_nonsense_is_said_with_the_pose_that_mends_it),
        cmocka_unit_test(buttons_take_skip_and_go_back),
        cmocka_unit_test(escape_leaves_and_keeps_nothing),
        cmocka_unit_test(a_glove_that_is_removed_closes_it),
        cmocka_unit_test(it_goes_on_when_an_input_before_the_glove_is_removed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
