/* What the window measures of itself, by the machine's time. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

static const char *const hand[] = {"log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1"};

static bool has_samples(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->sample_count > 50;
}

static void figures_are_told(void **state)
{
    scene s;
    workspace_counts counts;
    (void)state;
    const scene_options options = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = hand, .input_count = 1};
    scene_open_with(&s, &options);
    assert_true(scene_until(&s, has_samples, NULL));
    scene_frames(&s, 40);
    workspace_counted(s.workspace, &counts);
    assert_true(counts.frame_count >= 40);
    assert_true(counts.first_face_s > 0.0);
    assert_true(counts.fast.panels_p50_ms > 0.0);
    assert_true(counts.fast.latency_p50_ms > 0.0);
    assert_true(counts.fast.latency_p99_ms >= counts.fast.latency_p50_ms);
    assert_true(app_notes_of(s.app)->figures.draw_p50_ms > 0.0);
    print_message("panels %.3f ms, 99 %% %.3f ms\n", counts.fast.panels_p50_ms,
                  counts.fast.panels_p99_ms);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
