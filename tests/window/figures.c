/* The figures that the window measures of itself: first face, latency, panels, drawing. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

static const char *const hand[] = {"log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1"};

/* A hand at rest publishes no face, and a busy machine draws few frames: the figures arrive when
 * the recorded hand has moved the face and the panels have been updated. */
static bool has_figures(scene *s, void *data)
{
    workspace_counts *counts = data;
    workspace_counted(s->workspace, counts);
    return counts->fast.latency_p50_ms > 0.0 && counts->fast.panels_p50_ms > 0.0 &&
           app_notes_of(s->app)->figures.draw_p50_ms > 0.0;
}

static void the_window_measures_itself(void **state)
{
    scene s;
    workspace_counts counts;
    (void)state;
    const scene_options options = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = hand, .input_count = 1};
    scene_open_with(&s, &options);
    assert_true(scene_until(&s, has_figures, &counts));
    assert_true(counts.first_face_s > 0.0);
    assert_true(counts.fast.panels_p99_ms >= counts.fast.panels_p50_ms);
    assert_true(counts.fast.latency_p99_ms >= counts.fast.latency_p50_ms);
    print_message("panels %.3f ms, 99 %% %.3f ms\n", counts.fast.panels_p50_ms,
                  counts.fast.panels_p99_ms);
    scene_close(&s);
}

/* Prints the cost of each panel. The limit is ten times what an idle machine needs. */
static void each_panel_is_quick(void **state)
{
    scene s;
    workspace_counts counts;
    (void)state;
    const scene_options options = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = hand, .input_count = 1};
    scene_open_with(&s, &options);
    ui_note_words(s.ui, false); /* of tests alone */
    for (int i = ACTION_PANEL_DEVICES; i < ACTION_PANEL_DEVICES + (int)APP_PANELS; ++i) {
        app_do(s.app, (action)i);
        scene_frames(&s, 300); /* more than the figures keep */
        workspace_counted(s.workspace, &counts);
        print_message("%-8s %.3f ms, 99 %% %.3f ms\n", action_of((action)i)->title,
                      counts.fast.panels_p50_ms, counts.fast.panels_p99_ms);
        assert_true(counts.fast.panels_p50_ms < 5.0);
    }
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_window_measures_itself),
        cmocka_unit_test(each_panel_is_quick),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
