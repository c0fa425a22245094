/* The studio without a window: what is opened, what is kept with a show and between runs. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/file.h"
#include "studio_room.h"

/* ---- what is opened ---- */

static void a_show_that_another_one_writes_is_read(void **state)
{
    room r;
    studio *second = NULL;
    error err = {0};
    const char *why = "";
    (void)state;
    open_room(&r, false);
    const studio_options with = {
        .show_path = r.show, .face_path = puppet, .inputs = no_inputs, .settings_path = ""};
    assert_int_equal(studio_create(&second, &with, &err), MRT_OK);
    assert_false(show_is_writable(studio_show(second)));
    assert_int_not_equal(news_list_count(studio_news(second)), 0);
    assert_false(studio_can(second, ACTION_RECORD, &why));
    assert_true(why[0]);
    studio_destroy(second);
    close_room(&r);
}

static void without_a_show_one_of_today_is_made(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    (void)setenv("XDG_DOCUMENTS_DIR", r.folder, 1);
    const studio_options with = {.face_path = puppet, .settings_path = r.settings};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    assert_non_null(studio_show(r.studio));
    assert_non_null(strstr(show_path(studio_show(r.studio)), "/marotte/20"));
    char first[512];
    (void)snprintf(first, sizeof first, "%s", show_path(studio_show(r.studio)));
    studio_destroy(r.studio);
    (void)setenv("XDG_DOCUMENTS_DIR", "/dev/null", 1);
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    assert_string_equal(show_path(studio_show(r.studio)), first);
    close_room(&r);
    (void)unsetenv("XDG_DOCUMENTS_DIR");
}

static void a_last_show_that_is_no_show_stops_nothing(void **state)
{
    room r;
    error err = {0};
    char text[300];
    (void)state;
    make_room(&r);
    assert_int_equal(file_write(r.show, "no show", 7, &err), MRT_OK);
    (void)snprintf(text, sizeof text, "{\"last\": {\"show\": \"%s\", \"mapping\": \"gone\"}}",
                   r.show);
    assert_int_equal(file_write(r.settings, text, strlen(text), &err), MRT_OK);
    (void)setenv("XDG_DOCUMENTS_DIR", r.folder, 1);
    const studio_options with = {.face_path = puppet, .settings_path = r.settings};
    if (open_with(&r, &with, &err) < 0)
        fail_msg("%s", err.text);
    assert_non_null(studio_show(r.studio));
    assert_string_not_equal(show_path(studio_show(r.studio)), r.show);
    assert_true(was_said(r.studio, "night.marotte"));
    close_room(&r);
    (void)unsetenv("XDG_DOCUMENTS_DIR");
}

static void what_was_asked_for_and_cannot_be_opened_is_an_error(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const studio_options no_face = {.show_path = r.show, .face_path = "/nowhere/face.rig.json"};
    assert_true(open_with(&r, &no_face, &err) < 0);
    assert_non_null(strstr(err.text, "/nowhere/face.rig.json"));
    const studio_options no_map = {
        .show_path = r.show, .face_path = puppet, .mapping = "no_such_mapping"};
    assert_true(open_with(&r, &no_map, &err) < 0);
    assert_non_null(strstr(err.text, "no_such_mapping"));
    const studio_options with = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    close_room(&r);
}

static void a_mapping_that_does_not_fit_leaves_the_face_at_rest(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const studio_options with = {.show_path = r.show,
                                 .face_path = SOURCE_DIR "/rigs/moai/moai.glb",
                                 .mapping = "one_hand,smile=8"};
    if (open_with(&r, &with, &err) < 0)
        fail_msg("%s", err.text);
    assert_true(was_said(r.studio, "org.marotte.one_hand cannot be used on this face"));
    assert_true(was_said(r.studio, "At rest; these fit it: "));
    assert_true(was_said(r.studio, "anchored"));
    assert_null(live_mapping(studio_live(r.studio)));
    if (live_set_mapping(studio_live(r.studio), "anchored", &err) < 0)
        fail_msg("%s", err.text);
    studio_destroy(r.studio);
    const studio_options misspelt = {.show_path = r.show,
                                     .face_path = SOURCE_DIR "/rigs/moai/moai.glb",
                                     .mapping = "one_hand,smile=999"};
    assert_true(open_with(&r, &misspelt, &err) < 0);
    assert_non_null(strstr(err.text, "smile=999"));
    r.studio = NULL;
    close_room(&r);
}

static void another_face_and_another_show_are_opened_on_a_running_stage(void **state)
{
    room r;
    char other[160];
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    assert_int_equal(studio_open_face(r.studio, SOURCE_DIR "/rigs/moai/moai.rig.json"), MRT_OK);
    assert_non_null(strstr(studio_face_path(r.studio), "moai"));
    assert_true(studio_open_face(r.studio, "/nowhere.rig.json") < 0);
    assert_non_null(strstr(studio_face_path(r.studio), "moai"));
    (void)snprintf(other, sizeof other, "%s/other.marotte", r.folder);
    assert_int_equal(studio_open_show(r.studio, other), MRT_OK);
    studio_update(r.studio, 0.01);
    assert_int_equal(count_takes(r.studio), 0);
    assert_int_equal(studio_take_id(r.studio), 0);
    const char *why;
    assert_false(studio_can(r.studio, ACTION_UNDO, &why));
    assert_true(studio_open_show(r.studio, "/dev/null/x.marotte") < 0);
    assert_string_equal(show_path(studio_show(r.studio)), other);
    close_room(&r);
}

static bool has_input(studio *of)
{
    return live_input_count(studio_live(of)) == 1;
}

static void looks_and_inputs_are_kept_between_runs(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const studio_options with = {.show_path = r.show,
                                 .face_path = puppet,
                                 .mapping = "one_hand,smile=8",
                                 .inputs = demo_inputs,
                                 .input_count = 1,
                                 .settings_path = r.settings};
    if (open_with(&r, &with, &err) < 0)
        fail_msg("%s", err.text);
    assert_true(until(&r, has_input));
    studio_do(r.studio, ACTION_SHOW_CONTACTS);
    studio_do(r.studio, ACTION_PANEL_ENGINE);
    const bool was_mirrored = studio_looks_of(r.studio)->is_mirrored;
    studio_do(r.studio, ACTION_VIEW_MIRROR);
    studio_update(r.studio, 0.01);
    studio_update(r.studio, 0.01);
    studio_destroy(r.studio);
    const studio_options again = {.settings_path = r.settings};
    const studio_options last = again;
    assert_int_equal(studio_create(&r.studio, &last, &err), MRT_OK);
    assert_true(until(&r, has_input));
    assert_string_equal(live_input_text(studio_live(r.studio), 0), demo);
    assert_true(studio_looks_of(r.studio)->shows_contacts);
    assert_int_equal(studio_looks_of(r.studio)->panel, STUDIO_ENGINE);
    assert_int_not_equal(studio_looks_of(r.studio)->is_mirrored, was_mirrored);
    assert_string_equal(show_path(studio_show(r.studio)), r.show);
    assert_string_equal(studio_face_path(r.studio), puppet);
    assert_non_null(
        strstr(settings_text(studio_settings(r.studio), "last.mapping", ""), "smile=8"));
    close_room(&r);
}

static void an_input_that_cannot_be_opened_is_said(void **state)
{
    static const char *const inputs[] = {"log:/nowhere.csv"};
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const studio_options with = {
        .show_path = r.show, .face_path = puppet, .inputs = inputs, .input_count = 1};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    while (!was_said(r.studio, "/nowhere.csv") && clock_now_ns() < end_ns) {
        studio_update(r.studio, 0.005);
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
    assert_true(was_said(r.studio, "/nowhere.csv"));
    assert_int_equal(live_input_count(studio_live(r.studio)), 0);
    close_room(&r);
}

/* ---- how it is solved ---- */

static const csrbf_settings sharp = {CSRBF_WENDLAND_C0, CSRBF_CONSTANT, 0.0, 0.0};

static bool is_sharp(studio *of)
{
    return studio_view(of)->number > 0 && studio_view(of)->solver.kernel == CSRBF_WENDLAND_C0 &&
           studio_view(of)->solver.polynomial == CSRBF_CONSTANT;
}

static bool is_as_rig_says(studio *of)
{
    return studio_view(of)->solver.kernel == CSRBF_WENDLAND_C2 &&
           studio_view(of)->solver.polynomial == CSRBF_NONE;
}

static void a_show_is_solved_tomorrow_as_it_was_today(void **state)
{
    room r;
    error err = {0};
    char other[160];
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    assert_null(studio_solver(r.studio));
    const double radius_mm = studio_view(r.studio)->solver.radius;
    assert_int_equal(studio_set_solver(r.studio, &sharp, &err), MRT_OK);
    assert_true(until(&r, is_sharp));
    assert_float_equal(studio_view(r.studio)->solver.radius, radius_mm, 1e-9);
    (void)snprintf(other, sizeof other, "%s/other.marotte", r.folder);
    assert_int_equal(studio_open_show(r.studio, other), MRT_OK);
    assert_true(until(&r, is_as_rig_says));
    assert_null(studio_solver(r.studio));
    assert_int_equal(studio_open_show(r.studio, r.show), MRT_OK);
    assert_true(until(&r, is_sharp));
    studio_destroy(r.studio);
    const studio_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    assert_true(until(&r, is_sharp));
    assert_non_null(studio_solver(r.studio));
    assert_float_equal(studio_solver(r.studio)->radius, 0.0, 1e-9);
    assert_int_equal(studio_set_solver(r.studio, NULL, &err), MRT_OK);
    assert_true(until(&r, is_as_rig_says));
    close_room(&r);
}

static void a_solver_that_is_not_known_is_said_and_the_rigs_is_taken(void **state)
{
    room r;
    error err = {0};
    (void)state;
    open_room(&r, false);
    assert_int_equal(show_note_write(studio_show(r.studio), "solver", "thin_plate none 3", &err),
                     MRT_OK);
    studio_destroy(r.studio);
    const studio_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    assert_true(was_said(r.studio, "thin_plate"));
    assert_null(studio_solver(r.studio));
    close_room(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_show_that_another_one_writes_is_read),
        cmocka_unit_test(without_a_show_one_of_today_is_made),
        cmocka_unit_test(a_last_show_that_is_no_show_stops_nothing),
        cmocka_unit_test(what_was_asked_for_and_cannot_be_opened_is_an_error),
        cmocka_unit_test(a_mapping_that_does_not_fit_leaves_the_face_at_rest),
        cmocka_unit_test(another_face_and_another_show_are_opened_on_a_running_stage),
        cmocka_unit_test(looks_and_inputs_are_kept_between_runs),
        cmocka_unit_test(an_input_that_cannot_be_opened_is_said),
        cmocka_unit_test(a_show_is_solved_tomorrow_as_it_was_today),
        cmocka_unit_test(a_solver_that_is_not_known_is_said_and_the_rigs_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
