/* The timeline in the whole window: a performance is recorded, chosen, edited, undone, kept; and
 * looked at. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

#include <math.h>
#include <sqlite3.h>

static bool has_take(scene *s, void *data)
{
    const app_take_line *line;
    uint32_t count = app_takes(s->app, &line);
    return count == *(uint32_t *)data && !line[count - 1].is_recording;
}

static bool has_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording && app_status(s->app)->recorded_ns > 2 * NS_PER_S;
}

static bool has_journal(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->journal_ns > 3 * NS_PER_S;
}

static bool has_journal_of(scene *s, void *data)
{
    return app_status(s->app)->journal_ns > *(int64_t *)data;
}

static bool is_chosen(scene *s, void *data)
{
    (void)data;
    return app_take(s->app) != NULL;
}

static bool has_clips(scene *s, void *data)
{
    const take *t = app_take(s->app);
    return t && t->layer_count > 0 && t->layer[0].clip_count == *(uint32_t *)data;
}

static void open_hand(scene *s, float scale)
{
    static char hand[512];
    static const char *const inputs[] = {hand};
    (void)snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    const scene_options options = {.width_px = (uint32_t)(1280.0f * scale),
                                   .height_px = (uint32_t)(720.0f * scale),
                                   .scale = scale,
                                   .inputs = inputs,
                                   .input_count = 1};
    scene_open_with(s, &options);
    scene_let_cut(s, "demo_hand");
    scene_let_cut(s, "(");
}

static void record_one(scene *s)
{
    uint32_t count = 1;
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_recorded, NULL));
    scene_look(s, "timeline_scene_recording");
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_take, &count));
}

static void choose_newest(scene *s)
{
    const app_take_line *line;
    uint32_t count = app_takes(s->app, &line);
    assert_int_equal(app_choose_take(s->app, line[count - 1].id), MRT_OK);
    assert_true(scene_until(s, is_chosen, NULL));
}

static void a_performance_is_recorded_chosen_split_and_undone(void **state)
{
    (void)state;
    scene s;
    uint32_t one = 1, two = 2;
    open_hand(&s, 1.0f);
    record_one(&s);
    choose_newest(&s);
    const take *t = app_take(s.app);
    live_seek(app_live(s.app), t->duration_ns / 2);
    app_chosen(s.app)->layer = t->layer[0].id;
    app_chosen(s.app)->clip = t->layer[0].clip[0].id;
    scene_do(&s, ACTION_SPLIT);
    assert_true(scene_until(&s, has_clips, &two));
    for (int i = 0; i < 120; ++i)
        scene_frame(&s); /* the curve comes */
    scene_look(&s, "timeline_scene_split");
    scene_check_words(&s);
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, has_clips, &one));
    scene_click_word(&s, "History");
    scene_settle(&s);
    scene_look(&s, "timeline_scene_history");
    assert_non_null(scene_word_with(&s, "split"));
    scene_close(&s);
}

static bool is_shown_at(scene *s, void *data)
{
    return live_shown_take(app_live(s->app)) == app_take_id(s->app) &&
           app_view(s->app)->mode == LIVE_SHOWS && app_view(s->app)->at_ns > *(int64_t *)data;
}

/* What was just recorded is on the timeline while the hands are on the stage. */
static void the_ruler_brings_the_chosen_take_to_the_stage(void **state)
{
    (void)state;
    scene s;
    int64_t half_s = NS_PER_S / 2;
    open_hand(&s, 1.0f);
    record_one(&s);
    assert_true(scene_until(&s, is_chosen, NULL));
    assert_int_equal(app_view(s.app)->mode, LIVE_PERFORMS);
    const ui_word *snap = scene_word(&s, "Snap");
    assert_non_null(snap);
    const float top = snap->where.y + 4.0f, ruler = snap->where.y + 24.0f;
    scene_click(&s, 700.0f, ruler);
    assert_true(scene_until(&s, is_shown_at, &half_s));
    scene_do(&s, ACTION_LIVE);
    scene_drag(&s, 500.0f, top, 700.0f, top, 6);
    assert_true(live_transport(app_live(s.app))->loop_in_ns <
                live_transport(app_live(s.app))->loop_out_ns);
    scene_close(&s);
}

static void a_take_is_named_and_deleted_in_the_list(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    record_one(&s);
    choose_newest(&s);
    scene_frames(&s, 10);
    const ui_word *word = scene_word(&s, "1");
    assert_non_null(word);
    float x = word->where.x + 4.0f, y = word->where.y + 6.0f;
    scene_click_with(&s, x, y, 1);
    scene_look(&s, "timeline_scene_menu");
    scene_click_word(&s, "Name, slate, note \u2026");
    scene_settle(&s);
    scene_look(&s, "timeline_scene_take");
    scene_type(&s, "night ride"); /* the name has the keys at once */
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_null(scene_word(&s, "Change"));
    scene_frames(&s, 10);
    assert_string_equal(app_take(s.app)->name, "night ride");
    assert_int_equal(history_last(app_history(s.app)), 1);
    scene_click_with(&s, x, y, 1);
    scene_click_word(&s, "Delete");
    scene_frames(&s, 10);
    scene_click_word(&s, "Deleted");
    scene_frames(&s, 5);
    assert_non_null(scene_word_with(&s, "night ride"));
    scene_close(&s);
}

/* As small as a window can be made. */
static void nothing_covers_undo_in_the_smallest_window(void **state)
{
    (void)state;
    scene s;
    scene_open(&s, 800, 500, 1.0f);
    const ui_word *edits = scene_word(&s, "History"), *keep = scene_word(&s, "Keep 30 s");
    assert_non_null(edits);
    const float signs = 2.0f * 32.0f; /* undo and redo, before it */
    assert_true(!keep || keep->where.x + keep->where.width < edits->where.x - signs);
    scene_look(&s, "timeline_scene_smallest");
    scene_close(&s);
}

static void the_journal_is_seen_live_and_at_twice_the_size(void **state)
{
    (void)state;
    for (int scale = 1; scale <= 2; ++scale) {
        scene s;
        open_hand(&s, (float)scale);
        assert_true(scene_until(&s, has_journal, NULL));
        scene_look(&s, scale == 1 ? "timeline_scene_live" : "timeline_scene_live_2x");
        scene_check_words(&s);
        scene_close(&s);
    }
}

static bool is_in_list(scene *s, void *data)
{
    uint32_t one = 1;
    (void)data;
    return has_take(s, &one) && app_take_id(s->app) != 0;
}

/* No take is there yet; the hand goes on while it is swiped. */
static void a_swipe_over_what_was_always_recorded_is_a_take_of_that_length(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    assert_true(scene_until(&s, has_journal, NULL));
    const ui_word *now = scene_word(&s, "now"), *before = scene_word_with(&s, "\u221220 s");
    assert_non_null(now);
    assert_non_null(before);
    const float end = now->where.x + now->where.width + 4.0f, y = now->where.y + 50.0f;
    const float second = (end - before->where.x - before->where.width - 4.0f) / 20.0f;
    const uint32_t said = news_list_count(app_news(s.app));
    scene_drag(&s, end - 2.5f * second, y, end - second, y, 6);
    assert_true(scene_until(&s, is_in_list, NULL));
    for (uint32_t i = said; i < news_list_count(app_news(s.app)); ++i)
        assert_int_equal(news_list_at(app_news(s.app), i)->level, MRT_LOG_INFO);
    scene_look(&s, "timeline_scene_kept");
    /* while it is dragged the strip rolls on, by at most the time that it takes */
    assert_in_range(app_take(s.app)->duration_ns, NS_PER_S, 2 * NS_PER_S);
    scene_close(&s);
}

/* The show's name in the bar, then the only file. A click chooses it, a second one opens it. */
static void the_show_that_is_open_is_opened_again_and_records_on(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    record_one(&s);
    assert_true(scene_until(&s, is_chosen, NULL));
    const int64_t chosen = app_take_id(s.app);
    scene_click_word(&s, "night");
    const ui_word *file = scene_word(&s, "night.marotte");
    assert_non_null(file);
    const float x = file->where.x + 10.0f, y = file->where.y + 8.0f;
    scene_click(&s, x, y);
    assert_non_null(scene_word(&s, "Cancel"));
    scene_click(&s, x, y);
    assert_null(scene_word(&s, "Cancel"));
    assert_true(show_is_writable(app_show(s.app)));
    assert_true(app_status(s.app)->can_record);
    assert_int_equal(app_take_id(s.app), chosen);
    assert_non_null(
        strstr(news_list_at(app_news(s.app), news_list_count(app_news(s.app)) - 1)->text,
               "is already open"));
    scene_do(&s, ACTION_LIVE);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_recorded, NULL));
    scene_close(&s);
}

static bool plays_the_chosen(scene *s, void *data)
{
    (void)data;
    return app_is_take_shown(s->app) && live_transport(app_live(s->app))->is_playing;
}

static bool is_performed(scene *s, void *data)
{
    (void)data;
    return app_view(s->app)->mode == LIVE_PERFORMS;
}

static bool is_on_stage(scene *s, void *data)
{
    (void)data;
    return app_view(s->app)->mode == LIVE_SHOWS;
}

static bool has_ended(scene *s, void *data)
{
    (void)data;
    return !app_status(s->app)->is_recording;
}

static bool records(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording;
}

static bool performs_over(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording && app_view(s->app)->mode == LIVE_OVERDUBS;
}

/* Whoever presses R to end it, and comes a moment late, begins nothing. */
static void an_r_just_after_recording_ended_by_itself_begins_no_take(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    record_one(&s);
    choose_newest(&s);
    assert_true(scene_until(&s, is_on_stage, NULL)); /* else R would record the live hands */
    app_chosen(s.app)->armed = app_take(s.app)->layer[0].id;
    app_set_range(s.app, NS_PER_S / 2, 3 * NS_PER_S / 2);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, records, NULL));
    assert_true(scene_until(&s, has_ended, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_false(app_status(s.app)->is_recording);
    const news_list *news = app_news(s.app);
    assert_non_null(
        strstr(news_list_at(news, news_list_count(news) - 1)->text, "the overdub has ended"));
    scene_look(&s, "timeline_scene_punched");
    scene_close(&s);
}

static bool has_raw(scene *s, void *data)
{
    const app_take_line *line;
    const uint32_t count = app_takes(s->app, &line);
    (void)data;
    return count == 2 && !line[1].is_recording && line[1].over == line[0].id;
}

static void click_fold(scene *s, const char *title)
{
    const ui_word *word = scene_word(s, title);
    if (!word)
        fail_msg("\"%s\" is not in the list", title);
    else
        scene_click(s, word->where.x - 10.0f, word->where.y + 0.5f * word->where.height);
}

/* Each says where it was performed, not that it begins at 0 s. */
static void what_was_performed_over_a_take_is_folded_under_it(void **state)
{
    (void)state;
    scene s;
    char title[200];
    const app_take_line *line;
    open_hand(&s, 1.0f);
    record_one(&s);
    choose_newest(&s);
    assert_true(scene_until(&s, is_on_stage, NULL));
    app_chosen(s.app)->armed = app_take(s.app)->layer[0].id;
    app_set_range(s.app, NS_PER_S / 2, 3 * NS_PER_S / 2);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, records, NULL));
    assert_true(scene_until(&s, has_ended, NULL));
    assert_true(scene_until(&s, has_raw, NULL));
    assert_true(scene_until(&s, is_on_stage, NULL));
    (void)app_takes(s.app, &line);
    assert_int_equal(line[1].over_at_ns, NS_PER_S / 2);
    (void)snprintf(title, sizeof title, "%s", line[0].title);
    const int64_t raw = line[1].id;
    assert_int_equal(app_take_id(s.app), line[0].id);
    scene_frames(&s, 3);
    assert_null(scene_word_with(&s, "at 0.5 s"));
    click_fold(&s, title);
    assert_non_null(scene_word_with(&s, "at 0.5 s"));
    scene_look(&s, "timeline_scene_unfolded");
    scene_check_words(&s);
    assert_int_equal(app_take_id(s.app), line[0].id); /* the fold chooses nothing */
    click_fold(&s, title);
    assert_null(scene_word_with(&s, "at 0.5 s"));
    assert_int_equal(app_select_take(s.app, raw), MRT_OK); /* what is chosen is seen */
    scene_frames(&s, 3);
    assert_non_null(scene_word_with(&s, "at 0.5 s"));
    edit e; /* without its take it is one like all */
    edit_init(&e, EDIT_TAKE_DELETE);
    assert_int_equal(app_edit_take(s.app, line[0].id, &e), MRT_OK);
    edit_finish(&e);
    scene_frames(&s, 5);
    assert_null(scene_word_with(&s, "at 0.5 s"));
    (void)app_takes(s.app, &line);
    assert_non_null(scene_word(&s, line[1].title));
    scene_close(&s);
}

/* However little time is between them: the newest face is still that of the live hands. */
static void an_r_just_after_a_take_is_shown_performs_over_it(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    record_one(&s);
    assert_true(scene_until(&s, is_chosen, NULL));
    assert_int_equal(app_view(s.app)->mode, LIVE_PERFORMS);
    assert_int_equal(app_choose_take(s.app, app_take_id(s.app)), MRT_OK);
    app_do(s.app, ACTION_RECORD);
    assert_true(scene_until(&s, performs_over, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_ended, NULL));
    scene_close(&s);
}

/* ---- what comes before a recording ---- */

/* A right click on the record button of the bar, before its state. */
static void open_record_menu(scene *s)
{
    const ui_word *state = scene_word(s, "Live");
    assert_non_null(state);
    scene_click_with(s, state->where.x - 31.0f, 0.5f * THEME_BAR_HEIGHT, 1);
}

static void a_count_in_is_seen_given_up_and_then_records(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    const ui_word *microphone = scene_word(&s, "Mic");
    assert_non_null(microphone);
    scene_click_with(&s, microphone->where.x, microphone->where.y + 4.0f, 1);
    assert_null(scene_word(&s, "Count-in 3 s")); /* the menu of another button */
    open_record_menu(&s);
    scene_look(&s, "timeline_scene_lead_in_menu");
    scene_click_word(&s, "Count-in 3 s");
    assert_true(app_lead_in_of(s.app).count_in_s == 3.0);
    assert_true(app_lead_in_of(s.app).preroll_s == 0.0);
    scene_do(&s, ACTION_RECORD);
    assert_false(app_status(s.app)->is_recording);
    assert_true(app_leads_in_s(s.app) > 0.0);
    assert_non_null(scene_word_with(&s, "to cancel the count-in"));
    scene_look(&s, "timeline_scene_count_in");
    scene_check_words(&s);
    assert_false(app_press(s.app, PATCH_RECORD)); /* a pedal that says record: it is begun */
    scene_do(&s, ACTION_RECORD);
    assert_true(app_leads_in_s(s.app) == 0.0);
    assert_false(app_status(s.app)->is_recording);
    open_record_menu(&s);
    scene_click_word(&s, "Click in the count-in");
    open_record_menu(&s);
    scene_look(&s, "timeline_scene_click_menu");
    scene_click_word(&s, "Count-in 2 bars");
    assert_true(app_lead_in_of(s.app).count_in_s == 4.0);
    assert_true(app_click(s.app).when == LIVE_CLICK_COUNT_IN && app_click(s.app).bpm == 120.0);
    open_record_menu(&s);
    scene_click_word(&s, "Tempo \u2026");
    scene_look(&s, "timeline_scene_tempo");
    scene_check_words(&s);
    scene_click_word(&s, "Close");
    app_set_lead_in(s.app, (app_lead_in){.count_in_s = 0.2});
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, records, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_chosen, NULL));
    scene_close(&s);
}

static bool plays_before(scene *s, void *data)
{
    (void)data;
    return app_view(s->app)->mode == LIVE_OVERDUBS && !app_view(s->app)->is_recording_over;
}

static bool is_over(scene *s, void *data)
{
    (void)data;
    return app_view(s->app)->is_recording_over;
}

/* The take plays, then the hands take over where the play head stood. */
static void a_preroll_plays_before_what_is_performed_over_a_take(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    record_one(&s);
    choose_newest(&s);
    assert_true(scene_until(&s, is_on_stage, NULL));
    const int64_t in_ns = app_take(s.app)->duration_ns / 2;
    app_seek(s.app, in_ns);
    scene_settle(&s);
    app_set_lead_in(s.app, (app_lead_in){.preroll_s = 0.4});
    scene_do(&s, ACTION_RECORD);
    assert_true(app_leads_in_s(s.app) > 0.0);
    assert_true(scene_until(&s, plays_before, NULL));
    assert_true(scene_until(&s, is_over, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_ended, NULL));
    const take *t = app_take(s.app);
    assert_int_equal(t->layer_count, 2);
    assert_int_equal(t->layer[1].clip_count, 1);
    assert_true(t->layer[1].clip[0].start_ns >= in_ns - NS_PER_S / 1000);
    scene_close(&s);
}

/* The large one of the strip; the ruler says instants too. */
static bool is_clock_at_start(scene *s)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (words[i].where.height > 24.0f && strchr(words[i].text, ':'))
            return strcmp(words[i].text, "00:00:00:00") == 0;
    fail_msg("there is no clock");
    return false;
}

/* Of a take that is beside: neither its instant nor its end is that of what is performed. */
static void the_clock_is_that_of_what_is_recorded_and_then_of_the_take(void **state)
{
    (void)state;
    scene s;
    uint32_t two = 2;
    open_hand(&s, 1.0f);
    record_one(&s);
    choose_newest(&s);
    app_seek(s.app, NS_PER_S);
    scene_frames(&s, 3);
    assert_false(is_clock_at_start(&s));
    scene_do(&s, ACTION_LIVE);
    assert_true(scene_until(&s, is_performed, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_recorded, NULL));
    assert_false(is_clock_at_start(&s));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, &two));
    assert_true(scene_until(&s, is_chosen, NULL));
    scene_frames(&s, 3);
    assert_true(is_clock_at_start(&s)); /* it is at its start */
    scene_close(&s);
}

static void a_click_in_the_list_chooses_what_space_plays_and_del_deletes(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    record_one(&s);
    assert_true(scene_until(&s, is_chosen, NULL));
    scene_click_word(&s, "Always recorded");
    assert_null(app_take(s.app));
    scene_click_word(&s, "1");
    assert_non_null(app_take(s.app));
    assert_int_equal(app_view(s.app)->mode, LIVE_PERFORMS);
    scene_do(&s, ACTION_LIVE); /* live again already: back to what was always recorded */
    assert_null(app_take(s.app));
    scene_click_word(&s, "1");
    scene_do(&s, ACTION_PLAY);
    assert_true(scene_until(&s, plays_the_chosen, NULL));
    scene_do(&s, ACTION_PLAY);
    scene_click_word(&s, "1");
    scene_do(&s, ACTION_REMOVE);
    assert_true(app_take(s.app)->is_deleted);
    scene_look(&s, "timeline_scene_deleted");
    scene_do(&s, ACTION_UNDO);
    assert_false(app_take(s.app)->is_deleted);
    scene_close(&s);
}

static bool has_markers(scene *s, void *data)
{
    const take *t = app_take(s->app);
    return t && t->marker_count == *(uint32_t *)data;
}

static bool has_recorded_more(scene *s, void *data)
{
    return app_status(s->app)->recorded_ns > *(int64_t *)data;
}

static void a_mark_set_while_recording_is_on_the_timeline_and_in_history(void **state)
{
    (void)state;
    scene s;
    uint32_t none = 0, one = 1, two = 2;
    int64_t later_ns = 3 * NS_PER_S, last_ns = 4 * NS_PER_S;
    open_hand(&s, 1.0f);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_recorded, NULL));
    assert_null(scene_word(&s, "mark"));
    scene_do(&s, ACTION_MARK);
    scene_frames(&s, 3);
    assert_non_null(scene_word(&s, "mark")); /* at once, on what is always recorded */
    assert_true(scene_until(&s, has_recorded_more, &later_ns));
    scene_do(&s, ACTION_MARK);
    assert_true(scene_until(&s, has_recorded_more, &last_ns));
    scene_look(&s, "timeline_scene_marks_live");
    scene_check_words(&s);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, &one));
    assert_true(scene_until(&s, has_markers, &two));
    const take *t = app_take(s.app);
    assert_true(t->marker[0].at_ns > 1900 * NS_PER_MS && t->marker[0].at_ns < 2900 * NS_PER_MS);
    assert_true(t->marker[1].at_ns > 2900 * NS_PER_MS && t->marker[1].at_ns < 3900 * NS_PER_MS);
    assert_int_equal(app_view(s.app)->mode, LIVE_PERFORMS);
    scene_click_word(&s, "History");
    assert_non_null(scene_word_with(&s, "mark 2."));
    scene_look(&s, "timeline_scene_marks");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, has_markers, &none));
    scene_do(&s, ACTION_REDO);
    assert_true(scene_until(&s, has_markers, &two));
    scene_close(&s);
}

/* K keeps what was marked, too. */
static void what_is_kept_has_its_marks(void **state)
{
    (void)state;
    scene s;
    uint32_t one = 1;
    open_hand(&s, 1.0f);
    assert_true(scene_until(&s, has_journal, NULL));
    scene_do(&s, ACTION_MARK);
    assert_true(scene_until(&s, has_journal_of, &(int64_t){5 * NS_PER_S}));
    scene_do(&s, ACTION_KEEP);
    assert_true(scene_until(&s, has_take, &one));
    assert_true(scene_until(&s, has_markers, &one));
    scene_close(&s);
}

/* ---- an edit that is dragged ---- */

static float sum_of_face(const scene *s)
{
    const live_view *v = app_view(s->app);
    float out = 0.0f;
    for (uint32_t i = 0; i < 3 * v->vertex_count; ++i)
        out += v->position[i] * (float)(1 + i % 7);
    return out;
}

typedef struct face_sum { /* a face, by the sum of its numbers */
    float sum;
    bool is_wanted; /* false: any other one */
} face_sum;

static bool has_face(scene *s, void *data)
{
    const face_sum *of = data;
    return (sum_of_face(s) == of->sum) == of->is_wanted;
}

typedef struct same_face {
    float sum;
    uint32_t frames; /* that it has been for */
} same_face;

static bool has_same_face(scene *s, void *data)
{
    same_face *now = data;
    const float sum = sum_of_face(s);
    now->frames = sum == now->sum ? now->frames + 1 : 0;
    now->sum = sum;
    return now->frames > 30;
}

static float still_face(scene *s)
{
    same_face now = {0};
    assert_true(scene_until(s, has_same_face, &now));
    return now.sum;
}

static bool is_sought(scene *s, void *data)
{
    return app_view(s->app)->at_ns == *(int64_t *)data;
}

/* Goes to an instant at which the hand moves the face. */
static float seek_movement(scene *s)
{
    const float rest = still_face(s);
    for (int64_t k = 1; k < 40; ++k) {
        int64_t at_ns = app_take(s->app)->duration_ns * k / 40;
        app_seek(s->app, at_ns);
        assert_true(scene_until(s, is_sought, &at_ns));
        if (fabsf(sum_of_face(s) - rest) > 1e-4f * rest)
            return still_face(s);
    }
    fail_msg("the hand does not move the face");
    return rest;
}

/* At the play head, without an edit; Esc takes it back, letting go makes one step. */
static void the_face_shows_the_gain_that_is_dragged(void **state)
{
    (void)state;
    scene s;
    open_hand(&s, 1.0f);
    record_one(&s);
    choose_newest(&s);
    assert_true(scene_until(&s, is_on_stage, NULL));
    face_sum first = {seek_movement(&s), false};
    const char *undo = app_undo_words(s.app);
    char words[EDIT_TEXT];
    (void)snprintf(words, sizeof words, "%s", undo);
    const ui_word *gain = scene_word(&s, "100 %");
    assert_non_null(gain);
    const float x = gain->where.x + 4.0f, y = gain->where.y + 6.0f;
    scene_move(&s, x, y);
    scene_settle(&s);
    scene_button(&s, 0, true);
    scene_frames(&s, 2);
    scene_move(&s, x - 30.0f, y);
    scene_frames(&s, 2);
    scene_move(&s, x - 80.0f, y);
    assert_true(scene_until(&s, has_face, &first));
    assert_true(app_take(s.app)->layer[0].gain == 1.0);
    assert_string_equal(app_undo_words(s.app), words);
    face_sum quiet = {still_face(&s), true};
    scene_look(&s, "timeline_scene_gain_dragged");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    first.is_wanted = true;
    assert_true(scene_until(&s, has_face, &first));
    scene_button(&s, 0, false);
    scene_settle(&s);
    assert_true(app_take(s.app)->layer[0].gain == 1.0);
    scene_drag(&s, x, y, x - 80.0f, y, 4);
    assert_true(app_take(s.app)->layer[0].gain < 1.0);
    assert_true(scene_until(&s, has_face, &quiet));
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, has_face, &first));
    assert_true(app_take(s.app)->layer[0].gain == 1.0);
    assert_string_equal(app_undo_words(s.app), words);
    /* in a loop, too: without gain all its faces are one */
    const int64_t at_ns = app_view(s.app)->at_ns;
    app_set_range(s.app, at_ns - 200 * NS_PER_MS, at_ns + 200 * NS_PER_MS);
    scene_do(&s, ACTION_PLAY);
    assert_true(scene_until(&s, plays_the_chosen, NULL));
    scene_move(&s, x, y);
    scene_settle(&s);
    scene_button(&s, 0, true);
    scene_frames(&s, 2);
    scene_move(&s, x - 100.0f, y);
    scene_frames(&s, 2);
    scene_move(&s, x - 200.0f, y);
    (void)still_face(&s);
    assert_true(plays_the_chosen(&s, NULL));
    assert_true(app_take(s.app)->layer[0].gain == 1.0);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    first.is_wanted = true;
    assert_true(scene_until(&s, has_face, &first));
    scene_button(&s, 0, false);
    scene_close(&s);
}

/* The take is as after a crash: ended by whoever opens the show, and not edited. */
static void a_mark_of_a_recording_that_was_recovered_is_a_marker(void **state)
{
    (void)state;
    scene s;
    uint32_t one = 1;
    sqlite3 *db;
    open_hand(&s, 1.0f);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_recorded, NULL));
    scene_do(&s, ACTION_MARK);
    assert_true(scene_until(&s, has_recorded_more, &(int64_t){3 * NS_PER_S}));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, &one));
    assert_true(scene_until(&s, has_markers, &one));
    scene_end(&s);
    assert_int_equal(sqlite3_open(s.show, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db,
                                  "UPDATE take SET end_ns = NULL, edit_head = 0; DELETE FROM edit;",
                                  NULL, NULL, NULL),
                     SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    scene_open_again(&s, &(scene_options){.width_px = 1280, .height_px = 720, .scale = 1.0f});
    assert_true(scene_until(&s, has_take, &one));
    choose_newest(&s);
    assert_true(has_markers(&s, &one));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_face_shows_the_gain_that_is_dragged),
        cmocka_unit_test(a_performance_is_recorded_chosen_split_and_undone),
        cmocka_unit_test(the_ruler_brings_the_chosen_take_to_the_stage),
        cmocka_unit_test(a_take_is_named_and_deleted_in_the_list),
        cmocka_unit_test(a_swipe_over_what_was_always_recorded_is_a_take_of_that_length),
        cmocka_unit_test(what_was_performed_over_a_take_is_folded_under_it),
        cmocka_unit_test(an_r_just_after_a_take_is_shown_performs_over_it),
        cmocka_unit_test(an_r_just_after_recording_ended_by_itself_begins_no_take),
        cmocka_unit_test(a_count_in_is_seen_given_up_and_then_records),
        cmocka_unit_test(a_preroll_plays_before_what_is_performed_over_a_take),
        cmocka_unit_test(the_clock_is_that_of_what_is_recorded_and_then_of_the_take),
        cmocka_unit_test(a_click_in_the_list_chooses_what_space_plays_and_del_deletes),
        cmocka_unit_test(a_mark_set_while_recording_is_on_the_timeline_and_in_history),
        cmocka_unit_test(what_is_kept_has_its_marks),
        cmocka_unit_test(a_mark_of_a_recording_that_was_recovered_is_a_marker),
        cmocka_unit_test(the_show_that_is_open_is_opened_again_and_records_on),
        cmocka_unit_test(nothing_covers_undo_in_the_smallest_window),
        cmocka_unit_test(the_journal_is_seen_live_and_at_twice_the_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
