/* The engine and the log panel, as a person sees and uses them. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "panel_stand.h"

#include "base/isa.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const mrt_face about = {.low = {-75, 0, -75}, .high = {75, 300, 75}};

static void say_frames(stand *s)
{
    live_status *status = &s->status;
    for (uint32_t i = 0; i < LIVE_HISTORY; ++i)
        status->frame_ms[i] = 1.2f + 0.6f * sinf(0.2f * (float)i) + (i % 53 == 0 ? 17.0f : 0.0f);
    status->frame_count = LIVE_HISTORY;
    status->frame_p50_ms = 1.21;
    status->frame_p99_ms = 18.4;
    for (int i = 0; i < LIVE_PHASES; ++i) {
        status->phase_p50_ms[i] = 0.1 * (i + 1);
        status->phase_p99_ms[i] = 0.9 * (i + 1);
    }
    status->lag_p99_ms = 2.4;
    s->notes.figures = (app_figures){0.31, 0.72, 16.7, 22.3, 14.2, 19.9, 12.1, 21.4};
}

static void it_shows_times_and_what_they_mean(void **state)
{
    (void)state;
    static const float scales[] = {1.0f, 2.0f};
    for (int i = 0; i < 2; ++i) {
        stand s = {.input_count = 0};
        stand_open(&s, &panel_engine, scales[i]);
        stand_face(&s, &about);
        say_frames(&s);
        s.view.penetration_mm = 0.12;
        s.view.min_determinant = 0.63;
        stand_settle(&s);
        assert_true(stand_shows(&s, "nothing folds"));
        assert_true(stand_shows(&s, "p99 18.4 ms"));
        assert_true(stand_shows(&s, "12.1 ms"));
        assert_non_null(stand_word(&s, "Instructions"));
        assert_true(stand_shows(&s, isa_name(isa_now())));
        assert_non_null(stand_word(&s, "Threads"));
        stand_check_words(&s, NULL);
        stand_picture(&s, i == 0 ? "panel_engine" : "panel_engine_2x");
        stand_close(&s);
    }
}

static void a_fold_is_said_in_words(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_engine, 1.0f);
    s.view.min_determinant = -0.2;
    stand_settle(&s);
    assert_non_null(stand_word(&s, "folds"));
    s.view.min_determinant = NAN;
    stand_settle(&s);
    assert_non_null(stand_word(&s, "folds"));
    s.view.min_determinant = 0.05;
    stand_settle(&s);
    assert_non_null(stand_word(&s, "nearly folds"));
    s.view.skin = (surface_state){.stretch = 3.5, .bend_deg = 71.0, .inside_out_count = 4};
    s.view.meter.held_back_mm = 12.25;
    stand_settle(&s);
    assert_true(stand_shows(&s, "3.50 times"));
    assert_true(stand_shows(&s, "71 degrees"));
    assert_true(stand_shows(&s, "4 triangles"));
    assert_true(stand_shows(&s, "by 12.2 mm"));
    stand_close(&s);
}

static void a_kernel_is_chosen_and_taken_back(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_engine, 1.0f);
    stand_face(&s, &about);
    stand_click(&s, "Frame time");
    stand_click(&s, "Wendland C2");
    stand_click(&s, "Wendland C4");
    assert_int_equal(s.solver.kernel, CSRBF_WENDLAND_C4);
    assert_true(s.solver.radius <= 0.0); /* the rig's */
    assert_int_equal(s.step_count, 1);
    (void)s.step[0].set(s.step[0].owner, s.step[0].before);
    assert_int_equal(s.solver.kernel, CSRBF_WENDLAND_C2);
    stand_settle(&s);
    assert_true(stand_shows(&s, "Wendland C2"));
    stand_close(&s);
}

static void a_refused_solver_is_not_shown_as_chosen(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_engine, 1.0f);
    stand_click(&s, "Frame time"); /* folded: there is room for the solver */
    s.refusal = "too many controls for a linear polynomial";
    stand_click(&s, "none (local)");
    stand_click(&s, "constant");
    assert_true(stand_shows(&s, "none (local)"));
    assert_true(stand_shows(&s, "too many controls"));
    assert_int_equal(s.step_count, 0);
    stand_close(&s);
}

static void a_radius_is_dragged_in_one_step(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_engine, 1.0f);
    stand_face(&s, &about);
    stand_click(&s, "Frame time");
    stand_click(&s, "Use the radius of the rig");
    assert_float_equal(s.solver.radius, 60.0, 1e-9);
    const ui_word *label = stand_word(&s, "Radius");
    float x = label->where.x + 160.0f, y = label->where.y + 6.0f;
    uint32_t before = s.solver_count;
    stand_drag(&s, x, y, x + 60.0f, y);
    assert_int_equal(s.solver_count, before + 1);
    assert_true(s.solver.radius > 80.0);
    assert_int_equal(s.step_count, 2);
    stand_close(&s);
}

static void counters_that_are_not_zero_are_named(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_engine, 1.0f);
    assert_false(stand_shows(&s, "Held pulls"));
    s.status.counts.held_pulls = 3;
    s.status.counts.limited_steps = 12;
    s.status.isolated.late = 2;
    s.status.sample_count = 123456;
    (void)snprintf(s.status.counts.first_problem.text, sizeof s.status.counts.first_problem.text,
                   "the pull has a vector that is not finite");
    stand_settle(&s);
    assert_true(stand_shows(&s, "Held pulls"));
    assert_true(stand_shows(&s, "Limited steps"));
    assert_true(stand_shows(&s, "Mapping late"));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_engine_counters");
    stand_close(&s);
}

static void scroll(stand *s)
{
    ui_push(s->ui, &(ui_event){.kind = UI_EVENT_WHEEL, .y = -2.0f});
    stand_settle(s);
}

/* Until the word is seen, and once more, so that it is not cut. */
static void scroll_to(stand *s, const char *word)
{
    ui_push(s->ui, &(ui_event){.kind = UI_EVENT_MOVE, .x = 1150.0f, .y = 300.0f});
    for (int i = 0; i < 40 && !stand_shows(s, word); ++i)
        scroll(s);
    scroll(s);
    assert_true(stand_shows(s, word));
}

static void the_state_is_listed_with_its_names(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_engine, 1.0f);
    s.status.writer.backlog = 4711;
    scroll_to(&s, "State");
    assert_false(stand_shows(&s, "can_record"));
    stand_click(&s, "State");
    scroll_to(&s, "writer.backlog");
    assert_true(stand_shows(&s, "4711"));
    stand_picture(&s, "panel_engine_state");
    stand_close(&s);
}

/* ---- the log ---- */

static void fill_log(stand *s)
{
    log_push(s->log, MRT_LOG_INFO, "marotte", "the show night_ride.marotte was opened: 12 takes");
    log_push(s->log, MRT_LOG_WARNING, "org.marotte.cyberglove",
             "cyberglove /dev/ttyUSB0: the device went away; it is tried again until it is back");
    log_push(s->log, MRT_LOG_ERROR, "devices",
             "osc:9105: the port is in use by another program: end it, or choose another port");
    stand_settle(s);
}

static void the_log_tells_time_source_and_level(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_log, 1.0f);
    assert_true(stand_shows(&s, "No messages."));
    fill_log(&s);
    assert_true(stand_shows(&s, "night_ride"));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_log");
    stand_click(&s, "Warnings");
    assert_false(stand_shows(&s, "night_ride"));
    assert_true(stand_shows(&s, "org.marotte.cyberglove"));
    stand_click(&s, "Errors");
    assert_false(stand_shows(&s, "org.marotte.cyberglove"));
    assert_true(stand_shows(&s, "in use by another"));
    stand_close(&s);
}

static void the_log_is_cleared_and_goes_on(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_log, 1.0f);
    fill_log(&s);
    stand_click(&s, "Clear");
    assert_true(stand_shows(&s, "No messages."));
    for (int i = 0; i < 400 && !stand_shows(&s, "and on"); ++i) {
        log_push(s.log, MRT_LOG_INFO, "test", "and on");
        stand_frame(&s);
    }
    assert_true(stand_shows(&s, "and on"));
    assert_false(stand_shows(&s, "night_ride"));
    stand_close(&s);
}

static void the_log_is_a_text_to_copy(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    stand_open(&s, &panel_log, 1.0f);
    fill_log(&s);
    stand_click(&s, "As text");
    assert_true(stand_shows(&s, "error: devices: osc:9105"));
    stand_picture(&s, "panel_log_text");
    stand_close(&s);
}

static void a_full_log_is_drawn_in_pages(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    char text[64];
    stand_open(&s, &panel_log, 2.0f);
    for (int i = 0; i < 2 * NEWS_MAX; ++i) {
        (void)snprintf(text, sizeof text, "news number %d", i);
        news_list_add(s.news, MRT_LOG_INFO, "test", text);
    }
    stand_settle(&s);
    assert_true(stand_shows(&s, "news number 999"));
    assert_false(stand_shows(&s, "news number 900"));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_log_full_2x");
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_shows_times_and_what_they_mean),
        cmocka_unit_test(a_fold_is_said_in_words),
        cmocka_unit_test(a_kernel_is_chosen_and_taken_back),
        cmocka_unit_test(a_refused_solver_is_not_shown_as_chosen),
        cmocka_unit_test(a_radius_is_dragged_in_one_step),
        cmocka_unit_test(counters_that_are_not_zero_are_named),
        cmocka_unit_test(the_state_is_listed_with_its_names),
        cmocka_unit_test(the_log_tells_time_source_and_level),
        cmocka_unit_test(the_log_is_cleared_and_goes_on),
        cmocka_unit_test(the_log_is_a_text_to_copy),
        cmocka_unit_test(a_full_log_is_drawn_in_pages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
