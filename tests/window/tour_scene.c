/* The tour: it goes on when the person did what its card says, and lies beside the face. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"
#include "window/tour.h"

static scene s;

static bool says(scene *of, void *part)
{
    return scene_word_with(of, part) != NULL;
}

/* The card wraps its sentence: some words that are in one line. */
static void expect(const char *part)
{
    char text[64];
    (void)snprintf(text, sizeof text, "%s", part);
    if (!scene_until(&s, says, text))
        fail_msg("the tour does not say \"%s\"", part);
}

static void drag_mouth(void)
{
    const float x = 0.37f * s.width, y = 0.45f * s.height;
    scene_drag(&s, x, y, x + 10.0f, y + 15.0f, 8);
}

static bool has_recorded_some(scene *of, void *data)
{
    (void)data;
    return app_status(of->app)->is_recording && app_status(of->app)->recorded_ns > NS_PER_S;
}

static bool has_take(scene *of, void *data)
{
    (void)data;
    return app_take(of->app) != NULL;
}

/* The middle of the picture is free, and so is the bar. */
static void check_place(void)
{
    static const char *const words[] = {"Tour, ", "Skip step", "End"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; ++i) {
        const ui_word *word = scene_word_with(&s, words[i]);
        assert_non_null(word);
        const float middle = 0.5f * (s.width - app_looks_of(s.app)->layouts.now.width[PLACE_RIGHT]);
        const float nearest =
            fminf(fabsf(word->where.x - middle), fabsf(word->where.x + word->where.width - middle));
        assert_true(nearest > 0.18f * s.height); /* half of the puppet's head */
        assert_true(word->where.y > THEME_BAR_HEIGHT);
    }
    scene_check_words(&s);
}

static void export_take(void)
{
    scene_do(&s, ACTION_EXPORT);
    scene_look(&s, "tour_export");
    scene_click_word(&s, "Export");
}

static void each_step_is_done_when_the_person_did_it(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    assert_null(scene_word_with(&s, "Tour, ")); /* of a test nobody is new */
    scene_let_cut(&s, "No takes yet");
    scene_do(&s, ACTION_TOUR);
    expect("Drag the mouth");
    check_place();
    scene_look(&s, "tour_pull");
    scene_frames(&s, 120);
    assert_non_null(scene_word(&s, "Tour, 1 of 6")); /* not by waiting */
    drag_mouth();
    expect("Done");
    expect("Click \"Try a demo");
    check_place();
    scene_look(&s, "tour_demo");
    scene_click_word(&s, "Try a demo hand");
    expect("Use your own hand");
    check_place();
    scene_look(&s, "tour_own");
    scene_click_word(&s, "Keyboard hand");
    expect("Click the red circle");
    assert_null(scene_word_with(&s, "(R)")); /* its keys are those of the hand */
    scene_key(&s, UI_KEY_ESCAPE, 0);         /* the hand first */
    expect("(R)");
    scene_let_cut(&s, "demo_hand");
    check_place();
    scene_look(&s, "tour_record");
    scene_do(&s, ACTION_RECORD);
    expect("red square");
    assert_true(scene_until(&s, has_recorded_some, NULL));
    scene_do(&s, ACTION_RECORD);
    expect("Drag an end of the clip");
    assert_true(scene_until(&s, has_take, NULL));
    check_place();
    scene_look(&s, "tour_trim");
    const float end =
        s.width - app_looks_of(s.app)->layouts.now.width[PLACE_RIGHT] - 13.0f; /* of the clip */
    scene_drag(&s, end, 0.87f * s.height, end - 150.0f, 0.87f * s.height, 10);
    scene_move(&s, 0.4f * s.width, 20.0f); /* away from the hints of the timeline */
    expect("(Ctrl+E)");
    check_place();
    export_take();
    expect("That is all");
    scene_look(&s, "tour_end");
    scene_click_word(&s, "Close");
    assert_null(scene_word_with(&s, "That is all"));
    scene_close(&s);
}

static void a_step_may_be_skipped_and_esc_ends_the_tour(void **state)
{
    char begun[96];
    scene_options again = {.width_px = 800, .height_px = 500, .scale = 1.0f};
    (void)state;
    scene_prepare(&s, &again);
    (void)snprintf(begun, sizeof begun, "%s/window.json", s.folder);
    again.settings_path = begun;
    scene_open_again(&s, &again);
    assert_true(tour_is_new(s.app));
    scene_let_cut(&s, "No takes yet");
    scene_let_cut(&s, "night");
    scene_let_cut(&s, "puppet");
    scene_do(&s, ACTION_TOUR);
    for (uint32_t step = 1; step <= 6; ++step) {
        char title[32], name[32];
        (void)snprintf(title, sizeof title, "Tour, %u of 6", step);
        (void)snprintf(name, sizeof name, "tour_small_%u", step);
        assert_non_null(scene_word(&s, title));
        check_place();
        scene_look(&s, name);
        scene_click_word(&s, "Skip step");
    }
    assert_non_null(scene_word_with(&s, "That is all"));
    scene_do(&s, ACTION_TOUR); /* from the start, any time */
    assert_non_null(scene_word(&s, "Tour, 1 of 6"));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_null(scene_word_with(&s, "Tour, "));
    scene_open_again(&s, &again);
    assert_false(tour_is_new(s.app)); /* it never comes again by itself */
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_step_is_done_when_the_person_did_it),
        cmocka_unit_test(a_step_may_be_skipped_and_esc_ends_the_tour),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
