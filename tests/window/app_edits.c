/* The application without a window: takes are edited, copied, undone and done again. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "app_fixture.h"

/* ---- edits and undo ---- */

static uint32_t rating(room *r)
{
    return app_take(r->app)->rating;
}

static void edits_are_undone_and_done_again(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const uint64_t edition = app_take_edition(r.app);
    app_do(r.app, ACTION_RATE_4);
    assert_int_equal(rating(&r), 4);
    assert_true(app_take_edition(r.app) > edition);
    app_do(r.app, ACTION_RATE_2);
    assert_true(app_undo_words(r.app)[0]);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(rating(&r), 4);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(rating(&r), 0);
    assert_string_equal(app_undo_words(r.app), "");
    app_do(r.app, ACTION_REDO);
    app_do(r.app, ACTION_REDO);
    assert_int_equal(rating(&r), 2);
    app_update(r.app, 0.01);
    const app_take_line *line;
    (void)app_takes(r.app, &line);
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
    app_do(r.app, ACTION_RATE_1);
    app_do(r.app, ACTION_RATE_5);
    const int64_t id = app_take_id(r.app);
    app_destroy(r.app);
    const app_options again = {.show_path = r.show, .face_path = puppet};
    assert_int_equal(open_with(&r, &again, &err), MRT_OK);
    assert_int_equal(app_choose_take(r.app, id), MRT_OK);
    assert_int_equal(rating(&r), 5);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(rating(&r), 1);
    app_do(r.app, ACTION_RATE_3);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(rating(&r), 1);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(rating(&r), 0);
    app_do(r.app, ACTION_REDO);
    app_do(r.app, ACTION_REDO);
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
    assert_int_equal(app_edit_all(r.app, both, 2), MRT_OK);
    assert_string_equal(app_take(r.app)->name, "night ride");
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(rating(&r), 0);
    assert_string_equal(app_take(r.app)->name, "");
    assert_true(app_edit_all(r.app, bad, 2) < 0);
    assert_int_equal(rating(&r), 0);
    close_room(&r);
}

typedef struct counter {
    int undone, redone;
    uint64_t number;
} counter;

/* The values of a change are the number and the one after it. */
static mrt_result count(void *owner, const void *value)
{
    counter *self = owner;
    const uint64_t number = *(const uint64_t *)value;
    self->undone += number % 2 == 0;
    self->redone += number % 2 == 1;
    self->number = number / 2;
    return MRT_OK;
}

static undo_change change_of(counter *of, const char *words, uint64_t number)
{
    const uint64_t before = 2 * number, after = 2 * number + 1;
    undo_change out = {.owner = of, .set = count};
    (void)snprintf(out.words, sizeof out.words, "%s", words);
    assert_true(undo_change_copy(&out, &before, &after, sizeof after));
    return out;
}

static void steps_of_panels_lie_between_edits_of_takes(void **state)
{
    room r;
    counter c = {0};
    const undo_change step = change_of(&c, "set smile to 8", 42);
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    app_do(r.app, ACTION_RATE_1);
    app_add_change(r.app, &step);
    app_do(r.app, ACTION_RATE_2);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(c.undone, 0);
    assert_string_equal(app_undo_words(r.app), "set smile to 8");
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(c.undone, 1);
    assert_int_equal(c.number, 42);
    assert_int_equal(rating(&r), 1);
    app_do(r.app, ACTION_REDO);
    assert_int_equal(c.redone, 1);
    app_forget_changes(r.app, &c);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(c.undone, 1);
    assert_int_equal(rating(&r), 0);
    close_room(&r);
}

static const app_take_line *line_of(app *of, int64_t id)
{
    const app_take_line *line;
    const uint32_t count = app_takes(of, &line);
    for (uint32_t i = 0; i < count; ++i)
        if (line[i].id == id)
            return &line[i];
    fail_msg("take %lld is not in the list", (long long)id);
    return NULL;
}

static const char *newest(room *r)
{
    const news_list *news = app_news(r->app);
    return news_list_at(news, news_list_count(news) - 1)->text;
}

static int64_t before_it;

static bool has_another(app *of)
{
    return has_ended(of) && app_take_id(of) != before_it;
}

/* Of a take that is not seen nothing is changed: it comes in front first. */
static void undo_stops_where_another_take_begins(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t first = app_take_id(r.app);
    app_do(r.app, ACTION_RATE_1);
    before_it = first;
    record_a_take(&r);
    assert_true(until(&r, has_another));
    const int64_t second = app_take_id(r.app);
    assert_int_not_equal(second, first);
    app_do(r.app, ACTION_RATE_2);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(app_take_id(r.app), second);
    assert_int_equal(rating(&r), 0);
    assert_non_null(strstr(newest(&r), "undone: "));
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(app_take_id(r.app), first);
    assert_int_equal(rating(&r), 1);
    assert_non_null(strstr(newest(&r), "is shown again"));
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(rating(&r), 0);
    assert_non_null(strstr(newest(&r), "undone: "));
    app_do(r.app, ACTION_REDO);
    assert_int_equal(rating(&r), 1);
    assert_non_null(strstr(newest(&r), "redone: "));
    app_do(r.app, ACTION_REDO); /* the border again */
    assert_int_equal(app_take_id(r.app), second);
    assert_int_equal(rating(&r), 0);
    app_do(r.app, ACTION_REDO);
    assert_int_equal(rating(&r), 2);
    edit e; /* in the list, of another take than the chosen one: that is seen */
    edit_init(&e, EDIT_TAKE_RATE);
    e.rating = 5;
    assert_int_equal(app_edit_take(r.app, first, &e), MRT_OK);
    edit_finish(&e);
    app_do(r.app, ACTION_UNDO);
    app_update(r.app, 0.01);
    assert_int_equal(line_of(r.app, first)->rating, 1);
    close_room(&r);
}

static void a_thousand_changes_can_be_undone_and_older_ones_are_dropped(void **state)
{
    room r;
    counter c = {0};
    (void)state;
    open_room(&r, false);
    for (uint64_t i = 0; i < 3000; ++i) {
        const undo_change step = change_of(&c, "step", i);
        app_add_change(r.app, &step);
    }
    const size_t each = 2 * sizeof(uint64_t);
    assert_int_equal(app_undo_bytes(r.app), 1024 * each);
    const char *why;
    while (app_can(r.app, ACTION_UNDO, &why))
        app_do(r.app, ACTION_UNDO);
    assert_int_equal(c.undone, 1024);
    assert_int_equal(c.number, 3000 - 1024);
    while (app_can(r.app, ACTION_REDO, &why))
        app_do(r.app, ACTION_REDO);
    assert_int_equal(c.redone, c.undone);
    assert_int_equal(c.number, 2999);
    app_do(r.app, ACTION_UNDO);
    app_do(r.app, ACTION_UNDO);
    const undo_change last = change_of(&c, "another", 3000);
    app_add_change(r.app, &last);
    assert_int_equal(app_undo_bytes(r.app), (1024 - 2 + 1) * each);
    app_forget_changes(r.app, &c);
    assert_int_equal(app_undo_bytes(r.app), 0);
    close_room(&r);
}

static void steps_that_are_large_make_room_for_each_other(void **state)
{
    room r;
    counter c = {0};
    (void)state;
    open_room(&r, false);
    for (uint64_t i = 0; i < 9; ++i) {
        undo_change large = change_of(&c, "large", i);
        large.bytes = (size_t)100 << 20;
        app_add_change(r.app, &large);
    }
    const char *why;
    while (app_can(r.app, ACTION_UNDO, &why))
        app_do(r.app, ACTION_UNDO);
    assert_int_equal(c.undone, 5); /* of 512 MB */
    close_room(&r);
}

/* ---- copies ---- */

static void a_take_is_duplicated_and_the_copy_is_taken_back(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t first = app_take_id(r.app);
    app_do(r.app, ACTION_RATE_4);
    app_do(r.app, ACTION_DUPLICATE);
    const int64_t copy = app_take_id(r.app);
    assert_int_not_equal(copy, first);
    assert_int_equal(rating(&r), 4);
    assert_int_equal(app_view(r.app)->mode, LIVE_PERFORMS); /* the hands stay on the stage */
    app_do(r.app, ACTION_RATE_1);
    app_update(r.app, 0.01);
    assert_int_equal(line_of(r.app, first)->rating, 4);
    assert_int_equal(line_of(r.app, copy)->rating, 1);
    assert_non_null(strstr(line_of(r.app, copy)->title, "copy of 1"));
    app_do(r.app, ACTION_UNDO);
    assert_non_null(strstr(app_undo_words(r.app), "duplicate take"));
    app_do(r.app, ACTION_UNDO);
    app_update(r.app, 0.01);
    assert_int_equal(app_take_id(r.app), first);
    assert_true(line_of(r.app, copy)->is_deleted);
    assert_non_null(strstr(app_redo_words(r.app), "duplicate take"));
    app_do(r.app, ACTION_REDO);
    app_do(r.app, ACTION_REDO);
    app_update(r.app, 0.01);
    assert_int_equal(app_take_id(r.app), copy);
    assert_false(line_of(r.app, copy)->is_deleted);
    assert_int_equal(line_of(r.app, copy)->rating, 1);
    close_room(&r);
}

static void a_copy_of_the_take_on_the_stage_takes_its_place(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t first = app_take_id(r.app);
    assert_int_equal(app_choose_take(r.app, first), MRT_OK);
    assert_true(until(&r, shows_take));
    app_do(r.app, ACTION_DUPLICATE);
    const int64_t copy = app_take_id(r.app);
    assert_int_equal(live_shown_take(app_live(r.app)), copy);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(live_shown_take(app_live(r.app)), first);
    close_room(&r);
}

static void what_is_recorded_cannot_be_duplicated_yet(void **state)
{
    room r;
    const char *why = "";
    (void)state;
    open_room(&r, true);
    assert_false(app_can(r.app, ACTION_DUPLICATE, &why));
    assert_string_equal(why, "no take is selected");
    close_room(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edits_are_undone_and_done_again),
        cmocka_unit_test(undo_goes_on_with_what_an_earlier_run_did),
        cmocka_unit_test(several_edits_are_one_step_and_all_or_none),
        cmocka_unit_test(steps_of_panels_lie_between_edits_of_takes),
        cmocka_unit_test(undo_stops_where_another_take_begins),
        cmocka_unit_test(a_thousand_changes_can_be_undone_and_older_ones_are_dropped),
        cmocka_unit_test(steps_that_are_large_make_room_for_each_other),
        cmocka_unit_test(a_take_is_duplicated_and_the_copy_is_taken_back),
        cmocka_unit_test(a_copy_of_the_take_on_the_stage_takes_its_place),
        cmocka_unit_test(what_is_recorded_cannot_be_duplicated_yet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
