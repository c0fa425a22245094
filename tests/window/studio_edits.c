/* The studio without a window: takes are edited, copied, undone and done again. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "studio_room.h"

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

/* ---- copies ---- */

static const studio_take_line *line_of(studio *of, int64_t id)
{
    const studio_take_line *line;
    const uint32_t count = studio_takes(of, &line);
    for (uint32_t i = 0; i < count; ++i)
        if (line[i].id == id)
            return &line[i];
    fail_msg("take %lld is not in the list", (long long)id);
    return NULL;
}

static void a_take_is_duplicated_and_the_copy_is_taken_back(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t first = studio_take_id(r.studio);
    studio_do(r.studio, ACTION_RATE_4);
    studio_do(r.studio, ACTION_DUPLICATE);
    const int64_t copy = studio_take_id(r.studio);
    assert_int_not_equal(copy, first);
    assert_int_equal(rating(&r), 4);
    assert_int_equal(studio_view(r.studio)->mode, LIVE_PERFORMS); /* the hands stay on the stage */
    studio_do(r.studio, ACTION_RATE_1);
    studio_update(r.studio, 0.01);
    assert_int_equal(line_of(r.studio, first)->rating, 4);
    assert_int_equal(line_of(r.studio, copy)->rating, 1);
    assert_non_null(strstr(line_of(r.studio, copy)->title, "copy of 1"));
    studio_do(r.studio, ACTION_UNDO);
    assert_non_null(strstr(studio_undo_words(r.studio), "duplicate take"));
    studio_do(r.studio, ACTION_UNDO);
    studio_update(r.studio, 0.01);
    assert_int_equal(studio_take_id(r.studio), first);
    assert_true(line_of(r.studio, copy)->is_deleted);
    assert_non_null(strstr(studio_redo_words(r.studio), "duplicate take"));
    studio_do(r.studio, ACTION_REDO);
    studio_do(r.studio, ACTION_REDO);
    studio_update(r.studio, 0.01);
    assert_int_equal(studio_take_id(r.studio), copy);
    assert_false(line_of(r.studio, copy)->is_deleted);
    assert_int_equal(line_of(r.studio, copy)->rating, 1);
    close_room(&r);
}

static void a_copy_of_the_take_on_the_stage_takes_its_place(void **state)
{
    room r;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    const int64_t first = studio_take_id(r.studio);
    assert_int_equal(studio_choose_take(r.studio, first), MRT_OK);
    assert_true(until(&r, shows_take));
    studio_do(r.studio, ACTION_DUPLICATE);
    const int64_t copy = studio_take_id(r.studio);
    assert_int_equal(live_shown_take(studio_live(r.studio)), copy);
    studio_do(r.studio, ACTION_UNDO);
    assert_int_equal(live_shown_take(studio_live(r.studio)), first);
    close_room(&r);
}

static void what_is_recorded_cannot_be_duplicated_yet(void **state)
{
    room r;
    const char *why = "";
    (void)state;
    open_room(&r, true);
    assert_false(studio_can(r.studio, ACTION_DUPLICATE, &why));
    assert_string_equal(why, "no take is chosen");
    close_room(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edits_are_undone_and_done_again),
        cmocka_unit_test(undo_goes_on_with_what_an_earlier_run_did),
        cmocka_unit_test(several_edits_are_one_step_and_all_or_none),
        cmocka_unit_test(steps_of_panels_lie_between_edits_of_takes),
        cmocka_unit_test(more_steps_than_are_kept_are_no_trouble),
        cmocka_unit_test(a_take_is_duplicated_and_the_copy_is_taken_back),
        cmocka_unit_test(a_copy_of_the_take_on_the_stage_takes_its_place),
        cmocka_unit_test(what_is_recorded_cannot_be_duplicated_yet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
