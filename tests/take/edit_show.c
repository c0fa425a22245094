/* core/show/edit_store.h: edits of a take in a show: they are there again when it is opened again.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"
#include "show_scene.h"

#include "show/edit_store.h"

static int64_t noon_ms(void)
{
    return 1780000000000;
}

typedef struct editing { /* a show with a take of 2 s, open for editing */
    scene scene;
    show *show;
    int64_t take_id, performance;
    edit_store *store;
    history *history;
} editing;

static void open_editing(editing *e)
{
    error err = {""};
    scene_must(show_open(&e->show, e->scene.path, SHOW_WRITE, &err), &err);
    scene_must(edit_store_open(&e->store, e->show, e->take_id, noon_ms, &err), &err);
    history_store list = edit_store_list(e->store);
    scene_must(history_open(&e->history, edit_store_bare(e->store), &list, &err), &err);
}

static void close_editing(editing *e)
{
    history_close(e->history);
    edit_store_close(e->store);
    show_close(e->show);
}

static int make_take(void **state)
{
    static editing e;
    error err = {""};
    scene_recording recording;
    writer_options options = scene_options();
    writer_slate slate = {.scene = "1", .shot = "a"};
    e = (editing){.take_id = 0};
    scene_make(&e.scene);
    scene_must(show_create(&e.show, e.scene.path, &err), &err);
    scene_record(&recording, e.show, &options);
    scene_must(writer_take_begin(recording.writer, 0, &slate, &e.take_id, &err), &err);
    scene_give(&recording, 0, 300);
    scene_must(writer_take_end(recording.writer, e.take_id, 2 * help_s, &err), &err);
    scene_must(writer_stop(recording.writer, &err), &err);
    e.performance = recording.performance;
    show_close(e.show);
    open_editing(&e);
    *state = &e;
    return 0;
}

static int remove_take(void **state)
{
    editing *e = *state;
    close_editing(e);
    scene_remove(&e->scene);
    return 0;
}

static mrt_result try_edit(editing *e, const char *brief, error *err)
{
    char json[HELP_JSON];
    edit one;
    help_json(json, brief);
    scene_must(edit_parse(&one, json, strlen(json), err), err);
    mrt_result result = history_do(e->history, &one, err);
    edit_finish(&one);
    return result;
}

static void make_edit(editing *e, const char *brief)
{
    error err = {""};
    scene_must(try_edit(e, brief, &err), &err);
}

static void a_recorded_take_can_be_edited(void **state)
{
    editing *e = *state;
    const take *t = history_take(e->history);
    assert_int_equal(t->layer_count, 1);
    assert_int_equal(t->layer[0].clip_count, 1);
    help_check(t);
    make_edit(e, "{'op':'clip.trim','clip':2,'start_ns':500m,'end_ns':1500m}");
    assert_string_equal(help_shown(history_take(e->history)->layer, help_s), "2@1*1");
    assert_string_equal(history_words(e->history, 1), "trim 'performance' to 0.5 .. 1.5 s");
}

static void edits_are_there_when_the_show_is_opened_again(void **state)
{
    editing *e = *state;
    error err = {""};
    take first, second, shown;
    make_edit(e, "{'op':'clip.split','clip':2,'at_ns':1000m}");
    assert_int_equal(take_copy(&first, history_take(e->history), NULL), MRT_OK);
    make_edit(e, "{'op':'clip.remove','clip':3}");
    assert_int_equal(take_copy(&second, history_take(e->history), NULL), MRT_OK);
    assert_int_equal(history_undo(e->history, NULL), MRT_OK);
    close_editing(e);
    open_editing(e);
    assert_true(help_same(history_take(e->history), &first));
    scene_must(edit_store_take(&shown, e->show, e->take_id, &err), &err);
    assert_true(help_same(&shown, &first));
    assert_int_equal(history_redo(e->history, NULL), MRT_OK);
    assert_true(help_same(history_take(e->history), &second));
    take_finish(&first);
    take_finish(&second);
    take_finish(&shown);
}

static void an_edit_after_undo_abandons_the_undone_in_the_show(void **state)
{
    editing *e = *state;
    make_edit(e, "{'op':'take.rate','rating':1}");
    make_edit(e, "{'op':'take.rate','rating':2}");
    make_edit(e, "{'op':'take.rate','rating':3}");
    assert_int_equal(history_go(e->history, 1, NULL), MRT_OK);
    make_edit(e, "{'op':'take.rate','rating':5}");
    assert_int_equal(history_last(e->history), 2);
    close_editing(e);
    open_editing(e);
    assert_int_equal(history_last(e->history), 2);
    assert_int_equal(history_take(e->history)->rating, 5);
    assert_int_equal(history_undo(e->history, NULL), MRT_OK);
    assert_int_equal(history_take(e->history)->rating, 1);
}

static bool holds_on_to(editing *e, int64_t from_ns, int64_t to_ns)
{
    error err = {""};
    show_span *spans;
    size_t count;
    bool found = false;
    scene_must(show_take_spans(e->show, e->take_id, &spans, &count, &err), &err);
    for (size_t i = 0; i < count; ++i)
        found |= spans[i].performance == e->performance && spans[i].from_ns == from_ns &&
                 spans[i].to_ns == to_ns && !spans[i].is_shown;
    free(spans);
    return found;
}

static void what_an_edit_shows_is_held_on_to(void **state)
{
    editing *e = *state;
    char brief[256];
    int64_t from_ns = scene_utc_ns + 100 * help_ms, to_ns = scene_utc_ns + 900 * help_ms;
    assert_false(holds_on_to(e, from_ns, to_ns));
    (void)snprintf(brief, sizeof brief,
                   "{'op':'punch','layer':1,'performance':%lld,'from_ns':%lld,'to_ns':%lld,"
                   "'in_ns':500m,'out_ns':1000m,'fade_ns':50m}",
                   (long long)e->performance, (long long)from_ns, (long long)to_ns);
    make_edit(e, brief);
    assert_true(holds_on_to(e, from_ns, to_ns));
}

static void an_edit_of_a_performance_that_is_not_there_changes_nothing(void **state)
{
    editing *e = *state;
    error err = {""};
    assert_true(try_edit(e, "{'op':'clip.perform','clip':2,'performance':999}", &err) < 0);
    assert_true(err.text[0] != '\0');
    assert_int_equal(history_last(e->history), 0);
    make_edit(e, "{'op':'take.rate','rating':4}");
    assert_int_equal(history_take(e->history)->layer->clip->performance, e->performance);
}

/* ---- copies ---- */

static void fold(editing *e, int64_t id, take *out)
{
    error err = {""};
    scene_must(edit_store_take(out, e->show, id, &err), &err);
}

static void set_head(editing *e, int64_t id, int32_t head)
{
    error err = {""};
    scene_must(show_edit_head(e->show, id, head, &err), &err);
}

static int64_t duplicate(editing *e, int64_t id)
{
    error err = {""};
    int64_t copy = 0;
    scene_must(edit_store_duplicate(e->show, id, noon_ms, &copy, &err), &err);
    assert_true(copy > 0 && copy != id);
    return copy;
}

static void a_copy_shows_what_its_original_shows(void **state)
{
    editing *e = *state;
    take original, copy;
    make_edit(e, "{'op':'clip.split','clip':2,'at_ns':1000m}");
    make_edit(e, "{'op':'take.slate','scene':'7','shot':'c','number':4}");
    make_edit(e, "{'op':'take.rate','rating':3}");
    make_edit(e, "{'op':'take.rate','rating':5}");
    assert_int_equal(history_undo(e->history, NULL), MRT_OK);
    fold(e, e->take_id, &original);
    fold(e, duplicate(e, e->take_id), &copy);
    help_check(&copy);
    assert_int_equal(copy.layer_count, 1);
    assert_int_equal(copy.layer[0].clip_count, 2);
    assert_string_equal(help_shown(copy.layer, help_s), help_shown(original.layer, help_s));
    assert_int_equal(copy.duration_ns, original.duration_ns);
    assert_int_equal(copy.rating, 3);
    assert_string_equal(copy.name, "copy of 4");
    assert_string_equal(copy.scene, "7");
    assert_string_equal(copy.shot, "c");
    assert_int_equal(copy.number, 1);
    assert_false(copy.is_deleted);
    take_finish(&original);
    take_finish(&copy);
}

static void a_copy_is_edited_by_itself(void **state)
{
    editing *e = *state;
    error err = {""};
    take original, copy;
    make_edit(e, "{'op':'take.rename','name':'night ride'}");
    int64_t id = duplicate(e, e->take_id);
    make_edit(e, "{'op':'clip.remove','clip':2}");
    fold(e, e->take_id, &original);
    fold(e, id, &copy);
    assert_int_equal(original.layer[0].clip_count, 0);
    assert_int_equal(copy.layer[0].clip_count, 1);
    assert_string_equal(copy.name, "night ride copy");
    take_finish(&original);
    take_finish(&copy);
    scene_must(show_check(e->show, &err), &err);
}

static void a_copy_is_taken_away_by_undoing_its_first_edit(void **state)
{
    editing *e = *state;
    take copy;
    int64_t id = duplicate(e, e->take_id);
    set_head(e, id, 0);
    fold(e, id, &copy);
    assert_true(copy.is_deleted);
    take_finish(&copy);
    set_head(e, id, 1);
    fold(e, id, &copy);
    assert_false(copy.is_deleted);
    take_finish(&copy);
}

static void a_copy_holds_on_to_all_that_its_original_does(void **state)
{
    editing *e = *state;
    error err = {""};
    show_span *spans, *own;
    size_t count, own_count;
    char brief[256];
    (void)snprintf(brief, sizeof brief,
                   "{'op':'punch','layer':1,'performance':%lld,'from_ns':%lld,'to_ns':%lld,"
                   "'in_ns':500m,'out_ns':1000m,'fade_ns':50m}",
                   (long long)e->performance, (long long)(scene_utc_ns + 100 * help_ms),
                   (long long)(scene_utc_ns + 900 * help_ms));
    make_edit(e, brief);
    int64_t id = duplicate(e, e->take_id);
    scene_must(show_take_spans(e->show, e->take_id, &spans, &count, &err), &err);
    scene_must(show_take_spans(e->show, id, &own, &own_count, &err), &err);
    assert_int_equal(own_count, count);
    for (size_t i = 0; i < count; ++i) {
        assert_int_equal(own[i].performance, spans[i].performance);
        assert_int_equal(own[i].from_ns, spans[i].from_ns);
        assert_int_equal(own[i].to_ns, spans[i].to_ns);
        assert_int_equal(own[i].is_shown, spans[i].is_shown);
    }
    free(spans);
    free(own);
}

/* "ü" is two bytes: a name is not cut within it. */
static void the_name_of_a_copy_of_a_copy_stays_within_its_room(void **state)
{
    editing *e = *state;
    take copy;
    int64_t id;
    make_edit(e, "{'op':'take.rename','name':"
                 "'\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc"
                 "\u00fc\u00fc"
                 "\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc"
                 "\u00fc\u00fcn'}");
    id = duplicate(e, e->take_id);
    fold(e, id, &copy);
    assert_int_equal(strlen(copy.name), 58 + 5);
    assert_string_equal(copy.name + 58, " copy");
    assert_int_equal((unsigned char)copy.name[56], 0xc3);
    take_finish(&copy);
    fold(e, duplicate(e, id), &copy);
    assert_true(strlen(copy.name) < TAKE_NAME);
    take_finish(&copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_recorded_take_can_be_edited, make_take, remove_take),
        cmocka_unit_test_setup_teardown(edits_are_there_when_the_show_is_opened_again, make_take,
                                        remove_take),
        cmocka_unit_test_setup_teardown(an_edit_after_undo_abandons_the_undone_in_the_show,
                                        make_take, remove_take),
        cmocka_unit_test_setup_teardown(what_an_edit_shows_is_held_on_to, make_take, remove_take),
        cmocka_unit_test_setup_teardown(an_edit_of_a_performance_that_is_not_there_changes_nothing,
                                        make_take, remove_take),
        cmocka_unit_test_setup_teardown(a_copy_shows_what_its_original_shows, make_take,
                                        remove_take),
        cmocka_unit_test_setup_teardown(a_copy_is_edited_by_itself, make_take, remove_take),
        cmocka_unit_test_setup_teardown(a_copy_is_taken_away_by_undoing_its_first_edit, make_take,
                                        remove_take),
        cmocka_unit_test_setup_teardown(a_copy_holds_on_to_all_that_its_original_does, make_take,
                                        remove_take),
        cmocka_unit_test_setup_teardown(the_name_of_a_copy_of_a_copy_stays_within_its_room,
                                        make_take, remove_take),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
