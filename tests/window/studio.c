/* The studio without a window: what is opened, recorded, chosen, edited, undone and kept. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "base/file.h"
#include "window/studio.h"
#include "window/studio_export.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATIENCE_S = 30 };

typedef struct room {
    char folder[64], show[96], settings[96];
    studio *studio;
} room;

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const demo_inputs[] = {demo}, *const no_inputs[] = {NULL};
static const char puppet[] = SOURCE_DIR "/rigs/puppet/puppet.rig.json";

static void make_room(room *r)
{
    (void)unsetenv("MAROTTE_PLUGIN_PATH"); /* they lie beside the test, as beside the program */
    (void)snprintf(r->folder, sizeof r->folder, "/tmp/marotte_studio_XXXXXX");
    assert_non_null(mkdtemp(r->folder));
    (void)setenv("XDG_DATA_HOME", r->folder, 1);
    (void)snprintf(r->show, sizeof r->show, "%s/night.marotte", r->folder);
    (void)snprintf(r->settings, sizeof r->settings, "%s/window.json", r->folder);
}

static mrt_result open_with(room *r, const studio_options *with, error *err)
{
    studio_options options = *with;
    if (!options.settings_path)
        options.settings_path = "";
    if (!options.inputs)
        options.inputs = no_inputs;
    return studio_create(&r->studio, &options, err);
}

static void open_room(room *r, bool has_hand)
{
    error err = {0};
    make_room(r);
    const studio_options with = {.show_path = r->show,
                                 .face_path = puppet,
                                 .mapping = "one_hand",
                                 .inputs = has_hand ? demo_inputs : NULL,
                                 .input_count = has_hand ? 1 : 0};
    if (open_with(r, &with, &err) < 0)
        fail_msg("%s", err.text);
}

static void close_room(room *r)
{
    char command[96];
    studio_destroy(r->studio);
    (void)snprintf(command, sizeof command, "rm -rf %s", r->folder);
    assert_int_equal(system(command), 0);
}

typedef bool condition(studio *of);
static bool until(room *r, condition *holds)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    do {
        studio_update(r->studio, 0.005);
        if (holds(r->studio))
            return true;
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    } while (clock_now_ns() < end_ns);
    return false;
}

static bool has_samples(studio *of)
{
    return studio_status(of)->sample_count > 100;
}

static bool is_recording(studio *of)
{
    return studio_status(of)->is_recording;
}

static bool is_recorded(studio *of)
{
    return studio_status(of)->is_recording && studio_status(of)->recorded_ns > 300 * NS_PER_MS;
}

static bool has_ended(studio *of)
{
    return !studio_status(of)->is_recording && studio_take_id(of) != 0;
}

static bool shows_take(studio *of)
{
    return studio_view(of)->mode == LIVE_SHOWS;
}

static uint32_t count_takes(studio *of)
{
    const studio_take_line *line;
    return studio_takes(of, &line);
}

static bool was_said(studio *of, const char *part)
{
    const news_list *news = studio_news(of);
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        if (strstr(news_list_at(news, i)->text, part))
            return true;
    return false;
}

static void record_a_take(room *r)
{
    assert_true(until(r, has_samples));
    studio_do(r->studio, ACTION_RECORD);
    assert_true(until(r, is_recorded));
    studio_do(r->studio, ACTION_RECORD);
    assert_true(until(r, has_ended));
}

/* ---- recording ---- */

static void a_take_that_ends_is_chosen_and_the_stage_stays_live(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    assert_int_equal(count_takes(r.studio), 1);
    assert_non_null(studio_take(r.studio));
    assert_true(studio_take(r.studio)->duration_ns > 200 * NS_PER_MS);
    assert_int_equal(studio_view(r.studio)->mode, LIVE_PERFORMS);
    close_room(&r);
}

static void a_take_that_is_recorded_is_in_the_list_while_it_grows(void **state)
{
    room r;
    const studio_take_line *line;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    assert_true(until(&r, is_recording));
    assert_int_equal(studio_takes(r.studio, &line), 1);
    assert_true(line[0].is_recording);
    assert_true(line[0].duration_ns > 0);
    close_room(&r);
}

static void closing_while_recording_keeps_the_take(void **state)
{
    room r;
    error err = {0};
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    studio_destroy(r.studio);
    const studio_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    const studio_take_line *line;
    assert_int_equal(studio_takes(r.studio, &line), 1);
    assert_true(line[0].duration_ns > 200 * NS_PER_MS);
    close_room(&r);
}

static void what_nobody_recorded_can_be_kept(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    studio_do(r.studio, ACTION_KEEP);
    assert_true(until(&r, has_ended));
    assert_int_equal(count_takes(r.studio), 1);
    assert_true(was_said(r.studio, "kept the last"));
    close_room(&r);
}

static bool has_two_takes(studio *of)
{
    return count_takes(of) == 2;
}

/* Whole, both of them, and as long as they were. */
static bool has_two_whole_takes(studio *of)
{
    const studio_take_line *line;
    return studio_takes(of, &line) == 2 && !line[0].is_recording && !line[1].is_recording &&
           line[0].duration_ns > 200 * NS_PER_MS && line[1].duration_ns > 200 * NS_PER_MS;
}

static void keeping_while_recording_leaves_the_recording_alone(void **state)
{
    room r;
    const studio_take_line *line;
    (void)state;
    open_room(&r, true);
    assert_true(until(&r, has_samples));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, is_recorded));
    studio_do(r.studio, ACTION_KEEP);
    assert_true(until(&r, has_two_takes));
    assert_true(until(&r, is_recording));
    (void)studio_takes(r.studio, &line);
    assert_true(line[0].is_recording);
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, has_two_whole_takes));
    close_room(&r);
}

static bool has_a_third_beside_whole_ones(studio *of)
{
    const studio_take_line *line;
    const uint32_t count = studio_takes(of, &line);
    assert_false(line[0].is_recording || line[1].is_recording);
    return count == 3;
}

static void what_is_performed_over_a_take_leaves_others_in_the_list(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    studio_do(r.studio, ACTION_KEEP);
    assert_true(until(&r, has_two_whole_takes));
    studio_do(r.studio, ACTION_TAKE_BEFORE);
    assert_true(until(&r, shows_take));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, has_a_third_beside_whole_ones));
    close_room(&r);
}

/* ---- playing ---- */

static void space_shows_the_chosen_take_and_plays_it(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    studio_do(r.studio, ACTION_PLAY);
    assert_true(until(&r, shows_take));
    assert_true(live_transport(studio_live(r.studio))->is_playing);
    studio_do(r.studio, ACTION_PLAY);
    assert_false(live_transport(studio_live(r.studio))->is_playing);
    studio_do(r.studio, ACTION_STOP);
    assert_int_equal(live_place(studio_live(r.studio)).at_ns, 0);
    studio_do(r.studio, ACTION_FRAME_FORWARD);
    assert_true(live_place(studio_live(r.studio)).at_ns > 0);
    studio_do(r.studio, ACTION_FASTER);
    assert_float_equal(live_transport(studio_live(r.studio))->speed, 1.5, 1e-9);
    studio_do(r.studio, ACTION_LOOP);
    assert_true(live_transport(studio_live(r.studio))->is_looping);
    studio_do(r.studio, ACTION_LIVE);
    assert_int_equal(live_shown_take(studio_live(r.studio)), 0);
    close_room(&r);
}

static bool performs_over(studio *of)
{
    return studio_view(of)->is_recording_over && studio_view(of)->at_ns > 150 * NS_PER_MS;
}

static bool has_two_layers(studio *of)
{
    return studio_take(of) && studio_take(of)->layer_count == 2;
}

static void what_is_performed_over_a_take_becomes_a_layer_in_one_step(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t id = studio_take_id(r.studio);
    assert_int_equal(studio_take(r.studio)->layer_count, 1);
    assert_int_equal(studio_choose_take(r.studio, id), MRT_OK);
    assert_true(until(&r, shows_take));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, performs_over));
    studio_do(r.studio, ACTION_RECORD);
    assert_true(until(&r, has_two_layers));
    assert_int_equal(studio_take_id(r.studio), id);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(studio_take(r.studio)->layer_count, 1);
    studio_do(r.studio, ACTION_REDO);
    assert_int_equal(studio_take(r.studio)->layer_count, 2);
    close_room(&r);
}

static void what_cannot_be_done_says_why(void **state)
{
    room r;
    const char *why = NULL;
    (void)state;
    open_room(&r, false);
    assert_false(studio_can(r.studio, ACTION_PLAY, &why));
    assert_string_equal(why, "no take is chosen");
    assert_false(studio_can(r.studio, ACTION_SPLIT, &why));
    assert_false(studio_can(r.studio, ACTION_UNDO, &why));
    assert_string_equal(why, "there is nothing to undo");
    studio_do(r.studio, ACTION_UNDO);
    assert_true(was_said(r.studio, "nothing to undo"));
    assert_true(studio_can(r.studio, ACTION_HELP, &why));
    assert_string_equal(why, "");
    close_room(&r);
}

/* ---- edits and undo ---- */

static uint32_t rating(room *r)
{
    return studio_take(r->studio)->rating;
}

static void edits_are_undone_and_done_again(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const uint64_t edition = studio_take_edition(r.studio);
    studio_do(r.studio, ACTION_RATE_4);
    assert_int_equal(rating(&r), 4);
    assert_true(studio_take_edition(r.studio) > edition);
    studio_do(r.studio, ACTION_RATE_2);
    assert_true(studio_undo_words(r.studio)[0]);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(rating(&r), 4);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(rating(&r), 0);
    assert_string_equal(studio_undo_words(r.studio), "");
    studio_do(r.studio, ACTION_REDO);
    studio_do(r.studio, ACTION_REDO);
    assert_int_equal(rating(&r), 2);
    studio_update(r.studio, 0.01);
    const studio_take_line *line;
    (void)studio_takes(r.studio, &line);
    assert_int_equal(line[0].rating, 2);
    close_room(&r);
}

static void undo_goes_on_with_what_an_earlier_run_did(void **state)
{
    room r;
    error err = {0};
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    studio_do(r.studio, ACTION_RATE_1);
    studio_do(r.studio, ACTION_RATE_5);
    const int64_t id = studio_take_id(r.studio);
    studio_destroy(r.studio);
    const studio_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    assert_int_equal(studio_choose_take(r.studio, id), MRT_OK);
    assert_int_equal(rating(&r), 5);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(rating(&r), 1);
    studio_do(r.studio, ACTION_RATE_3);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(rating(&r), 1);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(rating(&r), 0);
    studio_do(r.studio, ACTION_REDO);
    studio_do(r.studio, ACTION_REDO);
    assert_int_equal(rating(&r), 3);
    close_room(&r);
}

static void several_edits_are_one_step_and_all_or_none(void **state)
{
    room r;
    edit rate, name, wrong;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    edit_init(&rate, EDIT_TAKE_RATE);
    rate.rating = 3;
    edit_init(&name, EDIT_TAKE_RENAME);
    (void)snprintf(name.name, sizeof name.name, "night ride");
    edit_init(&wrong, EDIT_LAYER_REMOVE);
    wrong.layer = 99;
    const edit *both[] = {&rate, &name}, *bad[] = {&rate, &wrong};
    assert_int_equal(studio_edit_all(r.studio, both, 2), MRT_OK);
    assert_string_equal(studio_take(r.studio)->name, "night ride");
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(rating(&r), 0);
    assert_string_equal(studio_take(r.studio)->name, "");
    assert_true(studio_edit_all(r.studio, bad, 2) < 0);
    assert_int_equal(rating(&r), 0);
    close_room(&r);
}

typedef struct counter {
    int undone, redone;
    uint64_t number;
} counter;

static void count_undo(void *owner, uint64_t number)
{
    ((counter *)owner)->undone += 1;
    ((counter *)owner)->number = number;
}

static void count_redo(void *owner, uint64_t number)
{
    ((counter *)owner)->redone += 1;
    ((counter *)owner)->number = number;
}

static void steps_of_panels_lie_between_edits_of_takes(void **state)
{
    room r;
    counter c = {0};
    const studio_step step = {&c, "set smile to 8", count_undo, count_redo, 42};
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    studio_do(r.studio, ACTION_RATE_1);
    studio_did(r.studio, &step);
    studio_do(r.studio, ACTION_RATE_2);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(c.undone, 0);
    assert_string_equal(studio_undo_words(r.studio), "set smile to 8");
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(c.undone, 1);
    assert_int_equal(c.number, 42);
    assert_int_equal(rating(&r), 1);
    studio_do(r.studio, ACTION_REDO);
    assert_int_equal(c.redone, 1);
    studio_forget_steps(r.studio, &c);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(c.undone, 1);
    assert_int_equal(rating(&r), 0);
    close_room(&r);
}

static void more_steps_than_are_kept_are_no_trouble(void **state)
{
    room r;
    counter c = {0};
    (void)state;
    open_room(&r, false);
    for (uint64_t i = 0; i < 1000; ++i) {
        const studio_step step = {&c, "step", count_undo, count_redo, i};
        studio_did(r.studio, &step);
    }
    const char *why;
    while (studio_can(r.studio, ACTION_UNDO, &why))
        studio_do(r.studio, ACTION_UNDO);
    assert_true(c.undone >= 200 && c.undone < 1000);
    while (studio_can(r.studio, ACTION_REDO, &why))
        studio_do(r.studio, ACTION_REDO);
    assert_int_equal(c.redone, c.undone);
    assert_int_equal(c.number, 999);
    close_room(&r);
}

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

/* ---- export ---- */

static bool exports_are_over(studio *of)
{
    return studio_exports_going(of) == 0;
}

static void a_take_is_exported_beside_the_stage(void **state)
{
    room r;
    export_wish wish = {.fps = 25.0};
    struct stat info;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    (void)snprintf(wish.file, sizeof wish.file, "%s/take.pc2", r.folder);
    assert_int_equal(studio_export_take(r.studio, &wish), MRT_OK);
    assert_true(until(&r, exports_are_over));
    if (stat(wish.file, &info) != 0) {
        const news_list *news = studio_news(r.studio);
        fail_msg("%s", news_list_at(news, news_list_count(news) - 1)->text);
    }
    assert_true(was_said(r.studio, "exported"));
    (void)snprintf(wish.file, sizeof wish.file, "%s/take.nonsense", r.folder);
    assert_int_equal(studio_export_take(r.studio, &wish), MRT_OK);
    assert_true(until(&r, exports_are_over));
    assert_true(was_said(r.studio, "was not exported"));
    close_room(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_take_that_ends_is_chosen_and_the_stage_stays_live),
        cmocka_unit_test(a_take_that_is_recorded_is_in_the_list_while_it_grows),
        cmocka_unit_test(closing_while_recording_keeps_the_take),
        cmocka_unit_test(keeping_while_recording_leaves_the_recording_alone),
        cmocka_unit_test(what_is_performed_over_a_take_leaves_others_in_the_list),
        cmocka_unit_test(what_nobody_recorded_can_be_kept),
        cmocka_unit_test(space_shows_the_chosen_take_and_plays_it),
        cmocka_unit_test(what_is_performed_over_a_take_becomes_a_layer_in_one_step),
        cmocka_unit_test(what_cannot_be_done_says_why),
        cmocka_unit_test(edits_are_undone_and_done_again),
        cmocka_unit_test(undo_goes_on_with_what_an_earlier_run_did),
        cmocka_unit_test(several_edits_are_one_step_and_all_or_none),
        cmocka_unit_test(steps_of_panels_lie_between_edits_of_takes),
        cmocka_unit_test(more_steps_than_are_kept_are_no_trouble),
        cmocka_unit_test(a_show_that_another_one_writes_is_read),
        cmocka_unit_test(without_a_show_one_of_today_is_made),
        cmocka_unit_test(a_last_show_that_is_no_show_stops_nothing),
        cmocka_unit_test(what_was_asked_for_and_cannot_be_opened_is_an_error),
        cmocka_unit_test(another_face_and_another_show_are_opened_on_a_running_stage),
        cmocka_unit_test(looks_and_inputs_are_kept_between_runs),
        cmocka_unit_test(an_input_that_cannot_be_opened_is_said),
        cmocka_unit_test(a_take_is_exported_beside_the_stage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
