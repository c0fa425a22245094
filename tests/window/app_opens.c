/* The application without a window: what is opened, what is kept with a show and between runs. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/file.h"
#include "app_fixture.h"

#include <sys/stat.h>

/* ---- what is opened ---- */

static void a_show_that_another_one_writes_is_read(void **state)
{
    room r;
    app *second = NULL;
    error err = {0};
    const char *why = "";
    (void)state;
    open_room(&r, false);
    const app_options with = {
        .show_path = r.show, .face_path = puppet, .inputs = no_inputs, .settings_path = ""};
    assert_int_equal(app_create(&second, &with, &err), MRT_OK);
    assert_false(show_is_writable(app_show(second)));
    assert_int_not_equal(news_list_count(app_news(second)), 0);
    assert_false(app_can(second, ACTION_RECORD, &why));
    assert_true(why[0]);
    app_destroy(second);
    close_room(&r);
}

static void without_a_show_one_of_today_is_made(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    (void)setenv("XDG_DOCUMENTS_DIR", r.folder, 1);
    const app_options with = {.face_path = puppet, .settings_path = r.settings};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    assert_non_null(app_show(r.app));
    assert_non_null(strstr(show_path(app_show(r.app)), "/marotte/20"));
    char first[512];
    (void)snprintf(first, sizeof first, "%s", show_path(app_show(r.app)));
    app_destroy(r.app);
    (void)setenv("XDG_DOCUMENTS_DIR", "/dev/null", 1);
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    assert_string_equal(show_path(app_show(r.app)), first);
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
    assert_int_equal(file_write(r.show, "not a show", 7, &err), MRT_OK);
    (void)snprintf(text, sizeof text,
                   "{\"looks\": {}, \"last\": {\"show\": \"%s\", \"mapping\": \"gone\"}}", r.show);
    assert_int_equal(file_write(r.settings, text, strlen(text), &err), MRT_OK);
    (void)setenv("XDG_DOCUMENTS_DIR", r.folder, 1);
    const app_options with = {.face_path = puppet, .settings_path = r.settings};
    if (open_with(&r, &with, &err) < 0)
        fail_msg("%s", err.text);
    assert_non_null(app_show(r.app));
    assert_string_not_equal(show_path(app_show(r.app)), r.show);
    assert_true(was_said(r.app, "night.marotte"));
    close_room(&r);
    (void)unsetenv("XDG_DOCUMENTS_DIR");
}

static void what_was_asked_for_and_cannot_be_opened_is_an_error(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const app_options no_face = {.show_path = r.show, .face_path = "/nowhere/face.rig.json"};
    assert_true(open_with(&r, &no_face, &err) < 0);
    assert_non_null(strstr(err.text, "/nowhere/face.rig.json"));
    const app_options no_map = {
        .show_path = r.show, .face_path = puppet, .mapping = "no_such_mapping"};
    assert_true(open_with(&r, &no_map, &err) < 0);
    assert_non_null(strstr(err.text, "no_such_mapping"));
    const app_options with = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    close_room(&r);
}

static void a_mapping_that_does_not_fit_leaves_the_face_at_rest(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const app_options with = {.show_path = r.show,
                              .face_path = SOURCE_DIR "/rigs/moai/moai.glb",
                              .mapping = "one_hand,smile_gain=130"};
    if (open_with(&r, &with, &err) < 0)
        fail_msg("%s", err.text);
    assert_true(was_said(r.app, "This face has no rig yet"));
    assert_true(was_said(r.app, "The face stays neutral. Mappings that fit it: "));
    assert_true(was_said(r.app, "anchored"));
    assert_null(live_mapping(app_live(r.app)));
    if (live_set_mapping(app_live(r.app), "anchored", &err) < 0)
        fail_msg("%s", err.text);
    app_destroy(r.app);
    const app_options misspelt = {.show_path = r.show,
                                  .face_path = SOURCE_DIR "/rigs/moai/moai.glb",
                                  .mapping = "one_hand,smile_gain=999"};
    assert_true(open_with(&r, &misspelt, &err) < 0);
    assert_non_null(strstr(err.text, "smile_gain=999"));
    r.app = NULL;
    close_room(&r);
}

static void what_rests_performs_again_on_a_face_that_it_fits_after_a_restart_too(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    app_options with = {.show_path = r.show,
                        .settings_path = r.settings,
                        .face_path = SOURCE_DIR "/rigs/moai/moai.glb",
                        .mapping = "one_hand,smile_gain=130"};
    for (int run = 0; run < 2; ++run) {
        if (open_with(&r, &with, &err) < 0)
            fail_msg("%s", err.text);
        assert_null(live_mapping(app_live(r.app)));
        assert_true(was_said(r.app, "This face has no rig yet"));
        assert_false(was_said(r.app, "cannot be used"));
        if (run == 0)
            app_destroy(r.app);
        with.mapping = NULL; /* as it was kept */
    }
    assert_int_equal(app_open_face(r.app, puppet), MRT_OK);
    const instance *mapping = live_mapping(app_live(r.app));
    assert_non_null(mapping);
    double smile = 0.0;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        if (strcmp(mapping->type->params[i].name, "Smile gain") == 0)
            smile = instance_value(mapping, i);
    assert_true(smile == 130.0);
    close_room(&r);
}

/* As at the start; what it did before is there for a face that it fits. */
static void a_face_that_the_mapping_does_not_fit_is_opened_at_rest(void **state)
{
    room r;
    (void)state;
    open_room(&r, false);
    assert_int_equal(app_open_face(r.app, SOURCE_DIR "/rigs/moai/moai.glb"), MRT_OK);
    assert_non_null(strstr(app_face_path(r.app), "moai.glb"));
    assert_null(live_mapping(app_live(r.app)));
    assert_true(was_said(r.app, "This face has no rig yet"));
    assert_true(was_said(r.app, "The face stays neutral. Mappings that fit it: "));
    assert_true(app_open_face(r.app, "/nowhere.rig.json") < 0);
    close_room(&r);
}

static void another_face_and_another_show_are_opened_on_a_running_stage(void **state)
{
    room r;
    char other[160];
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    assert_int_equal(app_open_face(r.app, SOURCE_DIR "/rigs/moai/moai.rig.json"), MRT_OK);
    assert_non_null(strstr(app_face_path(r.app), "moai"));
    assert_true(app_open_face(r.app, "/nowhere.rig.json") < 0);
    assert_non_null(strstr(app_face_path(r.app), "moai"));
    (void)snprintf(other, sizeof other, "%s/other.marotte", r.folder);
    assert_int_equal(app_open_show(r.app, other), MRT_OK);
    app_update(r.app, 0.01);
    assert_int_equal(count_takes(r.app), 0);
    assert_int_equal(app_take_id(r.app), 0);
    const char *why;
    assert_false(app_can(r.app, ACTION_UNDO, &why));
    assert_true(app_open_show(r.app, "/dev/null/x.marotte") < 0);
    assert_string_equal(show_path(app_show(r.app)), other);
    close_room(&r);
}

static bool has_input(app *of)
{
    return live_input_count(app_live(of)) == 1;
}

/* The program says so with its exit code, and the recording lies with the person's data. */
static void a_show_whose_folder_is_removed_is_not_well_at_the_end(void **state)
{
    (void)state;
    room r;
    error err = {0};
    char folder[96], copy[160];
    make_room(&r);
    (void)snprintf(folder, sizeof folder, "%s/gone", r.folder);
    (void)snprintf(copy, sizeof copy, "%s/marotte/rescued/night.rescued.marotte", r.folder);
    assert_int_equal(mkdir(folder, 0700), 0);
    (void)snprintf(r.show, sizeof r.show, "%s/gone/night.marotte", r.folder);
    const app_options with = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    char command[128];
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    assert_int_equal(system(command), 0);
    assert_true(app_destroy(r.app) < 0);
    assert_int_equal(access(copy, F_OK), 0);
    r.app = NULL;
    close_room(&r);
}

/* The patch lies beside the settings: a file of that name that is no patch is somebody's. */
static void a_file_that_is_no_patch_is_not_written_over(void **state)
{
    (void)state;
    static const char text[] = "[{\"op\": \"remove\", \"path\": \"/a\"}]";
    room r;
    error err = {0};
    char path[128];
    file_bytes bytes;
    make_room(&r);
    (void)snprintf(path, sizeof path, "%s/patch.json", r.folder);
    assert_int_equal(file_write(path, text, strlen(text), &err), MRT_OK);
    const app_options with = {
        .show_path = r.show, .face_path = puppet, .settings_path = r.settings};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    const patch none = {.name = "none"};
    app_set_patch(r.app, &none);
    assert_int_equal(file_read(&bytes, path, 1 << 16, &err), MRT_OK);
    assert_string_equal((const char *)bytes.data, text);
    file_bytes_finish(&bytes);
    assert_int_equal(unlink(path), 0);
    app_set_patch(r.app, &none);
    assert_int_equal(access(path, F_OK), 0);
    app_set_patch(r.app, &none);
    close_room(&r);
}

static void looks_and_inputs_are_kept_between_runs(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const app_options with = {.show_path = r.show,
                              .face_path = puppet,
                              .mapping = "one_hand,smile_gain=130",
                              .inputs = demo_inputs,
                              .input_count = 1,
                              .settings_path = r.settings};
    if (open_with(&r, &with, &err) < 0)
        fail_msg("%s", err.text);
    assert_true(until(&r, has_input));
    app_do(r.app, ACTION_SHOW_CONTACTS);
    app_do(r.app, ACTION_PANEL_ENGINE);
    const bool was_mirrored = app_looks_of(r.app)->is_mirrored;
    app_do(r.app, ACTION_VIEW_MIRROR);
    app_update(r.app, 0.01);
    app_update(r.app, 0.01);
    app_destroy(r.app);
    const app_options again = {.settings_path = r.settings};
    const app_options last = again;
    assert_int_equal(app_create(&r.app, &last, &err), MRT_OK);
    assert_true(until(&r, has_input));
    assert_string_equal(live_input_text(app_live(r.app), 0), demo);
    assert_true(app_looks_of(r.app)->shows_contacts);
    assert_int_equal(app_looks_of(r.app)->layouts.now.current, APP_ENGINE);
    assert_int_not_equal(app_looks_of(r.app)->is_mirrored, was_mirrored);
    assert_string_equal(show_path(app_show(r.app)), r.show);
    assert_string_equal(app_face_path(r.app), puppet);
    assert_non_null(
        strstr(settings_text(app_settings(r.app), "last.mapping", ""), "smile_gain=130"));
    close_room(&r);
}

static void the_range_of_a_take_is_there_tomorrow(void **state)
{
    room r;
    error err = {0};
    const app_take_line *line;
    (void)state;
    make_room(&r);
    const app_options with = {.show_path = r.show,
                              .face_path = puppet,
                              .mapping = "one_hand",
                              .inputs = demo_inputs,
                              .input_count = 1,
                              .settings_path = r.settings};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    record_a_take(&r);
    (void)app_takes(r.app, &line);
    const int64_t id = line[0].id;
    assert_int_equal(app_choose_take(r.app, id), MRT_OK);
    app_set_range(r.app, NS_PER_S / 20, NS_PER_S / 10);
    assert_true(live_transport(app_live(r.app))->is_looping);
    app_destroy(r.app);
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    assert_int_equal(app_choose_take(r.app, id), MRT_OK);
    assert_true(live_transport(app_live(r.app))->is_looping);
    assert_int_equal(live_transport(app_live(r.app))->loop_in_ns, NS_PER_S / 20);
    assert_int_equal(live_transport(app_live(r.app))->loop_out_ns, NS_PER_S / 10);
    close_room(&r);
}

static void an_input_that_cannot_be_opened_is_said(void **state)
{
    static const char *const inputs[] = {"log:/nowhere.csv"};
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const app_options with = {
        .show_path = r.show, .face_path = puppet, .inputs = inputs, .input_count = 1};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    while (!was_said(r.app, "/nowhere.csv") && clock_now_ns() < end_ns) {
        app_update(r.app, 0.005);
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
    assert_true(was_said(r.app, "/nowhere.csv"));
    assert_int_equal(live_input_count(app_live(r.app)), 0);
    close_room(&r);
}

/* ---- how it is solved ---- */

static const csrbf_settings sharp = {.kernel = CSRBF_WENDLAND_C0, .polynomial = CSRBF_CONSTANT};

static bool is_sharp(app *of)
{
    return app_view(of)->number > 0 && app_view(of)->solver.kernel == CSRBF_WENDLAND_C0 &&
           app_view(of)->solver.polynomial == CSRBF_CONSTANT;
}

static bool is_as_rig_says(app *of)
{
    return app_view(of)->solver.kernel == CSRBF_WENDLAND_C2 &&
           app_view(of)->solver.polynomial == CSRBF_NONE;
}

static void a_show_is_solved_tomorrow_as_it_was_today(void **state)
{
    room r;
    error err = {0};
    char other[160];
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    assert_null(app_solver(r.app));
    const double radius_mm = app_view(r.app)->solver.radius;
    assert_int_equal(app_set_solver(r.app, &sharp, &err), MRT_OK);
    assert_true(until(&r, is_sharp));
    assert_float_equal(app_view(r.app)->solver.radius, radius_mm, 1e-9);
    (void)snprintf(other, sizeof other, "%s/other.marotte", r.folder);
    assert_int_equal(app_open_show(r.app, other), MRT_OK);
    assert_true(until(&r, is_as_rig_says));
    assert_null(app_solver(r.app));
    assert_int_equal(app_open_show(r.app, r.show), MRT_OK);
    assert_true(until(&r, is_sharp));
    app_destroy(r.app);
    const app_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    assert_true(until(&r, is_sharp));
    assert_non_null(app_solver(r.app));
    assert_float_equal(app_solver(r.app)->radius, 0.0, 1e-9);
    assert_int_equal(app_set_solver(r.app, NULL, &err), MRT_OK);
    assert_true(until(&r, is_as_rig_says));
    close_room(&r);
}

static void a_solver_that_is_not_known_is_said_and_the_rigs_is_taken(void **state)
{
    room r;
    error err = {0};
    (void)state;
    open_room(&r, false);
    assert_int_equal(show_note_write(app_show(r.app), "solver", "thin_plate none 3", &err), MRT_OK);
    app_destroy(r.app);
    const app_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    assert_true(was_said(r.app, "thin_plate"));
    assert_null(app_solver(r.app));
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
        cmocka_unit_test(what_rests_performs_again_on_a_face_that_it_fits_after_a_restart_too),
        cmocka_unit_test(a_face_that_the_mapping_does_not_fit_is_opened_at_rest),
        cmocka_unit_test(another_face_and_another_show_are_opened_on_a_running_stage),
        cmocka_unit_test(a_show_whose_folder_is_removed_is_not_well_at_the_end),
        cmocka_unit_test(a_file_that_is_no_patch_is_not_written_over),
        cmocka_unit_test(looks_and_inputs_are_kept_between_runs),
        cmocka_unit_test(the_range_of_a_take_is_there_tomorrow),
        cmocka_unit_test(an_input_that_cannot_be_opened_is_said),
        cmocka_unit_test(a_show_is_solved_tomorrow_as_it_was_today),
        cmocka_unit_test(a_solver_that_is_not_known_is_said_and_the_rigs_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
