/* core/show/history.h: the list of edits, undo and redo, and edits in words. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

static const take bare = {.id = 1, .start_ns = 1000000000000, .duration_ns = 10000000000};

static help_list base_list(void)
{
    help_list list = {.base_count = 0};
    help_list_base(&list, "{'op':'layer.add','name':'face'}");
    help_list_base(&list, "{'op':'clip.add','layer':1,'performance':7}");
    return list;
}

static history *open_history(help_list *list)
{
    history *h;
    error err;
    history_store store = help_store(list);
    if (history_open(&h, &bare, &store, &err) < 0)
        fail_msg("%s", err.text);
    return h;
}

static mrt_result try_edit(history *h, const char *brief, error *err)
{
    char json[HELP_JSON];
    edit e;
    help_json(json, brief);
    mrt_result result = edit_parse(&e, json, strlen(json), err);
    if (result >= 0)
        result = history_do(h, &e, err);
    edit_finish(&e);
    return result;
}

static void make_edit(history *h, const char *brief)
{
    error err;
    if (try_edit(h, brief, &err) < 0)
        fail_msg("%s", err.text);
}

static void base_edits_make_the_take_and_cannot_be_undone(void **state)
{
    (void)state;
    help_list list = base_list();
    history *h = open_history(&list);
    assert_int_equal(history_take(h)->layer[0].clip[0].id, 2);
    assert_int_equal(history_head(h), 0);
    assert_int_equal(history_undo(h, NULL), MRT_END);
    assert_int_equal(history_redo(h, NULL), MRT_END);
    assert_string_equal(history_words(h, 0), "");
    history_close(h);
    help_list_finish(&list);
}

static void undo_and_redo_move_the_head(void **state)
{
    (void)state;
    help_list list = base_list();
    history *h = open_history(&list);
    take step[3];
    assert_int_equal(take_copy(&step[0], history_take(h), NULL), MRT_OK);
    make_edit(h, "{'op':'clip.split','clip':2,'at_ns':5000m}");
    assert_int_equal(take_copy(&step[1], history_take(h), NULL), MRT_OK);
    make_edit(h, "{'op':'clip.remove','clip':2}");
    assert_int_equal(take_copy(&step[2], history_take(h), NULL), MRT_OK);
    for (int round = 0; round < 2; ++round) {
        assert_int_equal(history_undo(h, NULL), MRT_OK);
        assert_true(help_same(history_take(h), &step[1]));
        assert_int_equal(history_undo(h, NULL), MRT_OK);
        assert_true(help_same(history_take(h), &step[0]));
        assert_int_equal(history_undo(h, NULL), MRT_END);
        assert_int_equal(history_redo(h, NULL), MRT_OK);
        assert_true(help_same(history_take(h), &step[1]));
        assert_int_equal(history_redo(h, NULL), MRT_OK);
        assert_true(help_same(history_take(h), &step[2]));
    }
    assert_int_equal(history_go(h, 0, NULL), MRT_OK);
    assert_true(help_same(history_take(h), &step[0]));
    assert_int_equal(history_go(h, 2, NULL), MRT_OK);
    assert_true(help_same(history_take(h), &step[2]));
    assert_int_equal(history_go(h, 3, NULL), MRT_ERR_ARGUMENT);
    assert_int_equal(history_go(h, -1, NULL), MRT_ERR_ARGUMENT);
    for (int i = 0; i < 3; ++i)
        take_finish(&step[i]);
    history_close(h);
    help_list_finish(&list);
}

static void every_step_of_a_long_undo_is_the_fold_up_to_there(void **state)
{
    (void)state;
    enum { STEPS = 100 };
    help_list list = base_list();
    history_store store = help_store(&list);
    history *h = open_history(&list);
    for (int i = 0; i < STEPS; ++i) {
        char brief[96];
        (void)snprintf(brief, sizeof brief, "{'op':'clip.split','clip':%d,'at_ns':%dm}",
                       i < 1 ? 2 : i + 2, (i + 1) * 90);
        make_edit(h, brief);
    }
    for (int walk = 0; walk < 3; ++walk)
        for (int i = 0; i < STEPS; ++i) {
            int64_t head = walk == 1 ? i + 1 : walk == 2 ? (i * 37) % STEPS : STEPS - 1 - i;
            take folded;
            error err;
            if (history_go(h, head, &err) < 0 ||
                history_fold(&folded, &bare, &store, head, NULL, &err) < 0)
                fail_msg("%s", err.text);
            assert_true(help_same(history_take(h), &folded));
            assert_int_equal(history_take(h)->layer->clip_count, head + 1);
            take_finish(&folded);
        }
    make_edit(h, "{'op':'take.rate','rating':1}");
    int64_t head = history_head(h);
    assert_int_equal(history_undo(h, NULL), MRT_OK);
    assert_int_equal(history_redo(h, NULL), MRT_OK);
    assert_int_equal(history_take(h)->rating, 1);
    assert_true(history_head(h) == head && history_last(h) == head);
    history_close(h);
    help_list_finish(&list);
}

static void undo_survives_closing(void **state)
{
    (void)state;
    help_list list = base_list();
    history *h = open_history(&list);
    make_edit(h, "{'op':'take.rate','rating':1}");
    make_edit(h, "{'op':'take.rate','rating':2}");
    make_edit(h, "{'op':'take.rate','rating':3}");
    assert_int_equal(history_undo(h, NULL), MRT_OK);
    history_close(h);
    h = open_history(&list);
    assert_int_equal(history_take(h)->rating, 2);
    assert_int_equal(history_head(h), 2);
    assert_int_equal(history_last(h), 3);
    assert_string_equal(history_words(h, 3), "rate the take 3 of 5");
    assert_int_equal(history_undo(h, NULL), MRT_OK);
    assert_int_equal(history_take(h)->rating, 1);
    assert_int_equal(history_redo(h, NULL), MRT_OK);
    assert_int_equal(history_redo(h, NULL), MRT_OK);
    assert_int_equal(history_take(h)->rating, 3);
    history_close(h);
    help_list_finish(&list);
}

static void an_edit_after_undo_abandons_the_later_ones(void **state)
{
    (void)state;
    help_list list = base_list();
    history *h = open_history(&list);
    make_edit(h, "{'op':'take.rate','rating':1}");
    make_edit(h, "{'op':'take.rate','rating':2}");
    assert_int_equal(history_undo(h, NULL), MRT_OK);
    make_edit(h, "{'op':'take.rate','rating':5}");
    assert_int_equal(history_last(h), 2);
    assert_int_equal(history_redo(h, NULL), MRT_END);
    assert_string_equal(history_words(h, 2), "rate the take 5 of 5");
    history_close(h);
    h = open_history(&list);
    assert_int_equal(history_take(h)->rating, 5);
    history_close(h);
    help_list_finish(&list);
}

static void what_fails_changes_nothing(void **state)
{
    (void)state;
    help_list list = base_list();
    history *h = open_history(&list);
    error err;
    make_edit(h, "{'op':'take.rate','rating':1}");
    assert_int_equal(try_edit(h, "{'op':'clip.remove','clip':9}", &err), MRT_ERR_ARGUMENT);
    assert_int_equal(history_last(h), 1);
    list.is_full = true;
    assert_int_equal(try_edit(h, "{'op':'take.rate','rating':2}", &err), MRT_ERR_IO);
    assert_string_equal(err.text, "the disk is full");
    assert_int_equal(history_take(h)->rating, 1);
    assert_int_equal(history_undo(h, &err), MRT_ERR_IO);
    assert_int_equal(history_take(h)->rating, 1);
    assert_int_equal(history_head(h), 1);
    list.is_full = false;
    assert_int_equal(history_undo(h, &err), MRT_OK);
    assert_int_equal(history_take(h)->rating, 0);
    history_close(h);
    help_list_finish(&list);
}

static void an_edit_of_a_newer_version_is_named_and_the_take_before_it_shown(void **state)
{
    (void)state;
    help_list list = base_list();
    history_store store = help_store(&list);
    error err = {""};
    history *h;
    take t;
    int64_t reached;
    assert_int_equal(help_list_append(&list, "{\"op\":\"take.rate\",\"rating\":1}", NULL, &err),
                     MRT_OK);
    assert_int_equal(help_list_append(&list, "{\"op\":\"clip.warble\"}", NULL, &err), MRT_OK);
    assert_int_equal(help_list_append(&list, "{\"op\":\"take.rate\",\"rating\":2}", NULL, &err),
                     MRT_OK);
    assert_int_equal(history_open(&h, &bare, &store, &err), MRT_ERR_UNSUPPORTED);
    assert_null(h);
    assert_int_equal(history_fold(&t, &bare, &store, 3, &reached, &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "edit 2: $.op: unknown edit \"clip.warble\""));
    assert_int_equal(reached, 1);
    assert_int_equal(t.rating, 1);
    assert_int_equal(t.layer_count, 1);
    take_finish(&t);
    list.head = 1;
    h = open_history(&list);
    assert_non_null(strstr(history_words(h, 2), "clip.warble"));
    assert_int_equal(history_redo(h, &err), MRT_ERR_UNSUPPORTED);
    assert_int_equal(history_take(h)->rating, 1);
    history_close(h);
    help_list_finish(&list);
}

static void an_edit_that_does_not_apply_leaves_the_take_before_it(void **state)
{
    (void)state;
    help_list list = base_list();
    history_store store = help_store(&list);
    error err = {""};
    take t, before;
    int64_t reached;
    assert_int_equal(help_list_append(&list,
                                      "{\"op\":\"clip.split\",\"clip\":2,\"at_ns\":3000000000}",
                                      NULL, &err),
                     MRT_OK);
    assert_int_equal(history_fold(&before, &bare, &store, 1, NULL, &err), MRT_OK);
    assert_int_equal(help_list_append(&list,
                                      "{\"op\":\"clip.move\",\"clip\":3,\"start_ns\":-1000000000}",
                                      NULL, &err),
                     MRT_OK);
    assert_int_equal(history_fold(&t, &bare, &store, 2, &reached, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "edit 2: "));
    assert_int_equal(reached, 1);
    assert_true(help_same(&t, &before));
    take_finish(&before);
    take_finish(&t);
    help_list_finish(&list);
}

static void an_edit_says_which_recording_it_shows(void **state)
{
    (void)state;
    help_list list = base_list();
    history *h = open_history(&list);
    make_edit(h, "{'op':'clip.trim','clip':2,'end_ns':9000m}");
    assert_true(list.shows.performance == 0);
    make_edit(h, "{'op':'clip.perform','clip':2,'performance':8}");
    assert_true(list.shows.performance == 8 && list.shows.from_ns == 1000 * help_s &&
                list.shows.to_ns == 1010 * help_s);
    make_edit(h, "{'op':'punch','layer':1,'performance':9,'from_ns':5,'to_ns':5000m,'in_ns':0,"
                 "'out_ns':1000m,'fade_ns':0}");
    assert_true(list.shows.performance == 9 && list.shows.from_ns == 5 &&
                list.shows.to_ns == 5 * help_s);
    make_edit(h, "{'op':'layer.add','name':'x'}");
    make_edit(h, "{'op':'clip.add','layer':4,'performance':10}");
    assert_true(list.shows.performance == 10 && list.shows.to_ns == 1010 * help_s);
    history_close(h);
    help_list_finish(&list);
}

static void a_fold_stops_where_it_is_told(void **state)
{
    (void)state;
    help_list list = base_list();
    history_store store = help_store(&list);
    error err;
    take t;
    int64_t reached;
    assert_int_equal(help_list_append(&list, "{\"op\":\"take.rate\",\"rating\":1}", NULL, &err),
                     MRT_OK);
    assert_int_equal(history_fold(&t, &bare, &store, -2, &reached, &err), MRT_OK);
    assert_true(reached == -2 && t.layer_count == 0);
    take_finish(&t);
    assert_int_equal(history_fold(&t, &bare, &store, 99, &reached, &err), MRT_OK);
    assert_true(reached == 1 && t.rating == 1);
    take_finish(&t);
    help_list_finish(&list);
}

static void a_list_that_makes_no_sense_is_refused(void **state)
{
    (void)state;
    help_list list = base_list();
    history_store store = help_store(&list);
    error err;
    history *h;
    list.head = 1;
    assert_int_equal(history_open(&h, &bare, &store, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "the show is damaged"));
    list.head = list.last = 1;
    list.text[0] = help_copy("");
    assert_int_equal(history_open(&h, &bare, &store, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "edit 1: "));
    help_list_finish(&list);
}

/* ---- words ---- */

static void require_words(const take *t, const char *brief, const char *words)
{
    char json[HELP_JSON], text[EDIT_TEXT];
    edit e;
    error err;
    help_json(json, brief);
    if (edit_parse(&e, json, strlen(json), &err) < 0)
        fail_msg("%s", err.text);
    edit_describe(text, &e, t);
    assert_string_equal(text, words);
    edit_finish(&e);
}

static void edits_are_said_in_words(void **state)
{
    (void)state;
    take t = help_take();
    require_words(&t, "{'op':'clip.trim','clip':2,'start_ns':2100m,'end_ns':8000m}",
                  "trim 'face' to 2.1 .. 8 s");
    require_words(&t, "{'op':'clip.trim','clip':2,'start_ns':2100400001}",
                  "trim 'face' to 2.1 .. 10 s");
    require_words(&t, "{'op':'clip.trim','clip':9,'end_ns':0}", "trim clip 9 to 0 .. 0 s");
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':2500m}");
    require_words(&t, "{'op':'clip.remove','clip':3}", "remove 'face' at 2.5 s");
    require_words(&t, "{'op':'clip.move','clip':3,'start_ns':-1500m}",
                  "move 'face' at 2.5 s to -1.5 s");
    require_words(&t, "{'op':'clip.speed','clip':3,'speed':1.5}",
                  "play 'face' at 2.5 s at 1.5 times its speed");
    require_words(&t, "{'op':'clip.fade','clip':3,'fade_out_ns':200m}",
                  "fade 'face' at 2.5 s out 0.2 s");
    require_words(&t, "{'op':'layer.mute','layer':1,'muted':false}", "unmute 'face'");
    require_words(&t, "{'op':'layer.own','layer':1,'own':['jaw.*','lip.*']}",
                  "'face' owns jaw.*, lip.*");
    require_words(&t, "{'op':'layer.remove','layer':8}", "remove layer 8");
    require_words(&t, "{'op':'range.cut','in_ns':1000m,'out_ns':2000m,'layers':[1]}",
                  "cut 1 .. 2 s of 'face', leaving a gap");
    require_words(&t,
                  "{'op':'comp','performance':8,'from_ns':0,'to_ns':9,'in_ns':1000m,"
                  "'out_ns':2000m,'fade_ns':0,'regions':['mouth','nose']}",
                  "mouth, nose from performance 8 at 1 .. 2 s");
    require_words(&t, "{'op':'take.note','note':'a\\nb'}", "note 'a b'");
    require_words(&t, "{'op':'take.timecode','frame':90000}", "time code from frame 90000");
    t.fps = 25;
    require_words(&t, "{'op':'take.timecode','frame':90000}", "time code from 01:00:00:00");
    take_finish(&t);
}

static void words_are_not_cut_within_a_letter(void **state)
{
    (void)state;
    take t = help_take();
    char note[512] = {0};
    for (int i = 0; i < 200; ++i)
        memcpy(note + i * 2, "\xc3\xa9", 2);
    for (int shift = 0; shift < 2; ++shift) {
        edit e;
        char text[EDIT_TEXT];
        edit_init(&e, EDIT_TAKE_NOTE);
        e.note[0] = 'x';
        memcpy(e.note + shift, note, 400);
        edit_describe(text, &e, &t);
        for (size_t i = 0; text[i]; ++i)
            assert_true((text[i] & 0x80) == 0 ||
                        ((unsigned char)text[i] == 0xc3 && (unsigned char)text[i + 1] == 0xa9) ||
                        (i > 0 && (unsigned char)text[i - 1] == 0xc3));
        assert_true(text[strlen(text) - 1] == '\'');
    }
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(base_edits_make_the_take_and_cannot_be_undone),
        cmocka_unit_test(undo_and_redo_move_the_head),
        cmocka_unit_test(every_step_of_a_long_undo_is_the_fold_up_to_there),
        cmocka_unit_test(undo_survives_closing),
        cmocka_unit_test(an_edit_after_undo_abandons_the_later_ones),
        cmocka_unit_test(what_fails_changes_nothing),
        cmocka_unit_test(an_edit_of_a_newer_version_is_named_and_the_take_before_it_shown),
        cmocka_unit_test(an_edit_that_does_not_apply_leaves_the_take_before_it),
        cmocka_unit_test(an_edit_says_which_recording_it_shows),
        cmocka_unit_test(a_fold_stops_where_it_is_told),
        cmocka_unit_test(a_list_that_makes_no_sense_is_refused),
        cmocka_unit_test(edits_are_said_in_words),
        cmocka_unit_test(words_are_not_cut_within_a_letter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
