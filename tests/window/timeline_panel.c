/* The timeline under the pointer: what is pressed, dragged and double-clicked becomes edits, one
 * step of undo each. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "take/edit_help.h"
#include "base/clock.h"
#include "timeline_stand.h"

#include <math.h>

/* Layers 'face' (clip 2: 0..10 s) and above it 'mouth' (clips 4: 1..4 s, 5: 4..7 s). */
static take two_layers(void)
{
    take t = help_take();
    t.fps = 25.0;
    help_do(&t, "{'op':'layer.add','name':'mouth','own':['mouth']}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':7,'source_ns':1000m,'start_ns':1000m,"
                "'end_ns':7000m}");
    help_do(&t, "{'op':'clip.split','clip':4,'at_ns':4000m}");
    return t;
}

static stand *open_stand(void)
{
    static stand s;
    stand_open(&s, 1200.0f, 300.0f, 1.0f);
    stand_choose(&s, two_layers());
    return &s;
}

static int64_t seek_ns(const stand *s)
{
    return transport_at(&s->transport, s->clock_ns).at_ns;
}

static void near_s(int64_t found_ns, double expected_s, double within_s)
{
    if (fabs((double)found_ns * 1e-9 - expected_s) > within_s)
        fail_msg("%.4f s, expected %.4f s", (double)found_ns * 1e-9, expected_s);
}

static bool has_words(stand *s, const char *part)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strstr(words[i].text, part))
            return true;
    return false;
}

static void right_click(stand *s, float x, float y)
{
    stand_move(s, x, y);
    stand_settle(s);
    stand_button(s, 1, true);
    stand_button(s, 1, false);
    stand_settle(s);
}

static void pass_half_a_second(stand *s)
{
    for (int i = 0; i < 40; ++i)
        stand_frame(s);
}

/* ---- clips ---- */

static void a_clip_is_dragged_in_time_in_one_step(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_drag(s, stand_x(s, 5.5), stand_y(s, 0), stand_x(s, 7.5), stand_y(s, 0));
    assert_int_equal(s->step_count, 1);
    assert_string_equal(s->edited[0], "clip.move");
    assert_int_equal(s->last.clip, 5);
    near_s(s->take.layer[1].clip[1].start_ns, 6.0, 0.05);
    assert_int_equal(s->take.layer[1].clip[1].start_ns % (40 * help_ms), 0); /* a frame */
    stand_close(s);
}

static void a_click_chooses_and_changes_nothing(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_click(s, stand_x(s, 5.5), stand_y(s, 0));
    assert_int_equal(s->step_count, 0);
    assert_int_equal(s->choice.clip, 5);
    assert_int_equal(s->choice.layer, 3);
    stand_close(s);
}

static void escape_cancels_a_drag(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_move(s, stand_x(s, 5.5), stand_y(s, 0));
    stand_button(s, 0, true);
    stand_move(s, stand_x(s, 7.5), stand_y(s, 0));
    near_s(timeline_take(s->panel)->layer[1].clip[1].start_ns, 6.0, 0.05); /* is shown */
    near_s(s->preview.layer[1].clip[1].start_ns, 6.0, 0.05);               /* by the face, too */
    assert_int_equal(s->take.layer[1].clip[1].start_ns, 4 * help_s);       /* is not made */
    stand_key(s, UI_KEY_ESCAPE, true);
    stand_key(s, UI_KEY_ESCAPE, false);
    stand_move(s, stand_x(s, 7.7), stand_y(s, 0));
    stand_button(s, 0, false);
    assert_int_equal(s->step_count, 0);
    assert_ptr_equal(timeline_take(s->panel), &s->take);
    assert_int_equal(s->preview.id, 0);
    stand_close(s);
}

static void hold_drag(stand *s, float x0, float y0, float x1, float y1)
{
    stand_move(s, x0, y0);
    stand_settle(s);
    stand_button(s, 0, true);
    stand_move(s, 0.5f * (x0 + x1), 0.5f * (y0 + y1));
    stand_move(s, x1, y1);
    stand_settle(s);
}

/* The value under the hand, before it is let go; a pointer that rests changes nothing again. */
static void gain_speed_and_fades_are_on_the_face_while_they_are_dragged(void **state)
{
    (void)state;
    stand *s = open_stand();
    const ui_rectangle box = timeline_gain_box(&s->panel->rows, &s->panel->rows.row[0]);
    const float top = s->panel->rows.row[0].y + 6.0f;
    hold_drag(s, box.x + 40.0f, box.y + 8.0f, box.x + 10.0f, box.y + 8.0f);
    assert_float_equal(s->preview.layer[1].gain, 0.75, 1e-9);
    assert_float_equal(s->take.layer[1].gain, 1.0, 1e-9);
    const uint32_t before = s->preview_count;
    stand_settle(s);
    assert_int_equal(s->preview_count, before);
    assert_int_equal(s->step_count, 0);
    stand_button(s, 0, false);
    assert_int_equal(s->step_count, 1);
    assert_int_equal(s->preview.id, 0);
    hold_drag(s, stand_x(s, 1.06), top, stand_x(s, 2.06), top);
    near_s(s->preview.layer[1].clip[0].fade_in_ns, 1.0, 0.06);
    stand_button(s, 0, false);
    assert_int_equal(s->step_count, 2);
    stand_key(s, UI_KEY_CONTROL, true);
    hold_drag(s, stand_x(s, 6.97), stand_y(s, 0), stand_x(s, 8.97), stand_y(s, 0));
    near_s(s->preview.layer[1].clip[1].end_ns, 9.0, 0.05);
    stand_key(s, UI_KEY_CONTROL, false);
    stand_key(s, UI_KEY_ESCAPE, true);
    stand_key(s, UI_KEY_ESCAPE, false);
    stand_button(s, 0, false);
    assert_int_equal(s->preview.id, 0);
    assert_int_equal(s->step_count, 2);
    stand_close(s);
}

/* As dragging does: one step at Change, none at Esc; what is not possible is said there. */
static void the_sliders_of_a_clip_are_on_the_face_too(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_double_click(s, stand_x(s, 5.5), stand_y(s, 0));
    const ui_word *gain = stand_word(s, "Gain");
    assert_non_null(gain);
    const float x = gain->where.x + 150.0f, y = gain->where.y + 8.0f;
    hold_drag(s, x, y, x + 60.0f, y);
    assert_true(s->preview.layer[1].clip[1].gain > 1.05);
    assert_int_equal(s->step_count, 0);
    stand_button(s, 0, false);
    stand_key(s, UI_KEY_ESCAPE, true);
    stand_key(s, UI_KEY_ESCAPE, false);
    stand_settle(s);
    assert_int_equal(s->preview.id, 0);
    assert_int_equal(s->step_count, 0);
    stand_double_click(s, stand_x(s, 5.5), stand_y(s, 0));
    hold_drag(s, x, y, x + 60.0f, y);
    stand_button(s, 0, false);
    stand_click_word(s, "Change");
    assert_int_equal(s->step_count, 1);
    assert_true(s->take.layer[1].clip[1].gain > 1.05);
    stand_double_click(s, stand_x(s, 5.5), stand_y(s, 0));
    s->panel->number[3] = 5000.0; /* longer than the clip */
    stand_settle(s);
    assert_true(has_words(s, "longer"));
    stand_close(s);
}

static const char trim_status[] = "Trims. With Ctrl: stretch.";

static void edges_trim_and_with_ctrl_retime(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_drag(s, stand_x(s, 6.97), stand_y(s, 0), stand_x(s, 8.97), stand_y(s, 0));
    assert_string_equal(s->edited[0], "clip.trim");
    near_s(s->take.layer[1].clip[1].end_ns, 9.0, 0.05);
    stand_key(s, UI_KEY_CONTROL, true);
    stand_drag(s, stand_x(s, 8.97), stand_y(s, 0), stand_x(s, 6.5), stand_y(s, 0));
    stand_key(s, UI_KEY_CONTROL, false);
    assert_string_equal(s->edited[1], "clip.speed");
    assert_false(has_words(s, trim_status));
    stand_move(s, stand_x(s, 6.5), stand_y(s, 0));
    stand_button(s, 0, true);
    stand_move(s, stand_x(s, 6.8), stand_y(s, 0));
    assert_true(has_words(s, trim_status)); /* the status line, while it is dragged */
    stand_move(s, stand_x(s, 6.5), stand_y(s, 0));
    stand_key(s, UI_KEY_ESCAPE, true);
    stand_key(s, UI_KEY_ESCAPE, false);
    stand_button(s, 0, false);
    assert_false(has_words(s, trim_status));
    near_s(s->take.layer[1].clip[1].end_ns, 6.52, 0.05);
    assert_int_equal(s->step_count, 2);
    stand_close(s);
}

/* As a line and in words; Shift for one drag, the switch for good. */
static void what_a_drag_snaps_to_is_told(void **state)
{
    (void)state;
    stand *s = open_stand();
    help_do(&s->take, "{'op':'marker.add','at_ns':8000m,'text':'cue'}");
    app_seek(NULL, 9 * help_s);
    s->edition += 1;
    stand_settle(s);
    hold_drag(s, stand_x(s, 6.97), stand_y(s, 0), stand_x(s, 7.98), stand_y(s, 0));
    assert_true(has_words(s, "Snaps to marker 'cue'  Shift: do not snap"));
    assert_int_equal(timeline_snapped(s->panel).at_ns, 8 * help_s);
    stand_picture(s, "snapped");
    window_hidden_put_away(s->window, true);
    stand_move(s, stand_x(s, 8.99), stand_y(s, 0));
    stand_settle(s);
    assert_true(has_words(s, "Snaps to the playhead"));
    stand_key(s, UI_KEY_SHIFT, true);
    stand_move(s, stand_x(s, 7.985), stand_y(s, 0));
    stand_settle(s);
    assert_false(has_words(s, "Snaps to"));
    assert_true(has_words(s, "Does not snap while Shift is held"));
    assert_int_equal(timeline_snapped(s->panel).kind, TIMELINE_TARGET_NONE);
    stand_key(s, UI_KEY_SHIFT, false);
    s->looks.is_snapping = false;
    stand_move(s, stand_x(s, 7.98), stand_y(s, 0));
    stand_settle(s);
    assert_true(has_words(s, "Snap is off"));
    stand_button(s, 0, false);
    assert_true(s->take.layer[1].clip[1].end_ns != 8 * help_s);
    stand_click_word(s, "Snap");
    assert_int_equal(s->done, ACTION_SNAP);
    s->looks.is_snapping = true;
    const float y = s->panel->rows.y + 8.0f; /* a range too */
    hold_drag(s, stand_x(s, 2.0), y, stand_x(s, 3.99), y);
    assert_true(has_words(s, "Snaps to the"));
    stand_button(s, 0, false);
    stand_close(s);
}

/* Later clips of all layers, markers and the end of the take move along, in one step. */
static void with_ripple_what_follows_moves_and_the_status_says_so(void **state)
{
    (void)state;
    stand *s = open_stand();
    help_do(&s->take, "{'op':'marker.add','at_ns':8000m,'text':'cue'}");
    help_do(&s->take, "{'op':'marker.add','at_ns':2000m,'text':'before'}");
    help_do(&s->take, "{'op':'clip.trim','clip':2,'end_ns':3000m}");
    s->edition += 1;
    stand_click_word(s, "Ripple");
    assert_int_equal(s->done, ACTION_RIPPLE);
    s->looks.is_rippling = true;
    stand_settle(s);
    hold_drag(s, stand_x(s, 3.95), stand_y(s, 0), stand_x(s, 2.95), stand_y(s, 0));
    assert_true(has_words(s, "Ripple: what follows moves too."));
    near_s(s->preview.layer[1].clip[1].start_ns, 3.0, 0.06);
    stand_picture(s, "rippled");
    window_hidden_put_away(s->window, true);
    stand_button(s, 0, false);
    assert_int_equal(s->step_count, 1);
    assert_string_equal(s->edited[0], "clip.trim");
    const int64_t by_ns = s->take.layer[1].clip[0].end_ns - 4 * help_s;
    near_s(by_ns, -1.0, 0.06);
    assert_int_equal(s->take.layer[1].clip[1].start_ns, 4 * help_s + by_ns);
    assert_int_equal(s->take.layer[0].clip[0].start_ns, 0);
    assert_int_equal(s->take.marker[0].at_ns, 2 * help_s);
    assert_int_equal(s->take.marker[1].at_ns, 8 * help_s + by_ns);
    assert_int_equal(s->take.duration_ns, 10 * help_s + by_ns);
    right_click(s, stand_x(s, 2.0), stand_y(s, 0));
    stand_click_word(s, "Remove and close gap");
    assert_int_equal(s->step_count, 2);
    near_s(s->take.layer[1].clip[0].start_ns, 1.0, 0.06);
    stand_close(s);
}

/* The chip of a colour in the menu that is open. */
static void click_colour(stand *s, take_colour colour)
{
    const ui_word *word = stand_word(s, "Colour");
    assert_non_null(word);
    stand_click(s, word->where.x - 7.0f + UI_CHIP_LABEL + UI_CHIP * ((float)colour + 0.5f),
                word->where.y + 8.0f);
    stand_settle(s);
}

/* By right click; a part of a split has it too. */
static void clips_and_layers_have_colours(void **state)
{
    (void)state;
    stand *s = open_stand();
    right_click(s, stand_x(s, 5.5), stand_y(s, 0));
    stand_picture(s, "colours_menu");
    window_hidden_put_away(s->window, true);
    click_colour(s, TAKE_COLOUR_VIOLET);
    assert_null(stand_word(s, "Colour")); /* it is done */
    assert_int_equal(s->step_count, 1);
    assert_string_equal(s->edited[0], "clip.colour");
    assert_int_equal(s->take.layer[1].clip[1].colour, TAKE_COLOUR_VIOLET);
    assert_int_equal(s->take.layer[1].clip[0].colour, TAKE_COLOUR_NONE);
    right_click(s, 280.0f, s->panel->rows.row[1].y + 8.0f);
    click_colour(s, TAKE_COLOUR_GREEN);
    assert_string_equal(s->edited[1], "layer.colour");
    assert_int_equal(s->take.layer[0].colour, TAKE_COLOUR_GREEN);
    stand_key(s, UI_KEY_CONTROL, true);
    stand_double_click(s, stand_x(s, 5.5), stand_y(s, 0));
    stand_key(s, UI_KEY_CONTROL, false);
    assert_int_equal(s->take.layer[1].clip[2].colour, TAKE_COLOUR_VIOLET);
    stand_picture(s, "colours");
    window_hidden_put_away(s->window, true);
    right_click(s, stand_x(s, 5.0), stand_y(s, 0));
    click_colour(s, TAKE_COLOUR_NONE);
    assert_int_equal(s->take.layer[1].clip[1].colour, TAKE_COLOUR_NONE);
    stand_close(s);
}

/* A long name is read by pulling the edge of the list, or by resting on it. */
static void the_list_of_takes_is_as_wide_as_it_is_pulled(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_list(s, 4);
    (void)snprintf(s->line[3].title, sizeof s->line[3].title,
                   "1/a 4 the second try of the night ride 2026-11-28 20:40");
    stand_settle(s);
    const float x = s->panel->rows.x - 1.0f, y = 150.0f;
    assert_null(stand_word(s, s->line[3].title)); /* it is cut */
    stand_move(s, 60.0f, stand_word(s, "All")->where.y + 36.0f);
    pass_half_a_second(s);
    assert_ptr_equal(strstr(s->panel->hint_words, s->line[3].title), s->panel->hint_words);
    stand_drag(s, x, y, x + 250.0f, y);
    stand_settle(s);
    assert_float_equal(s->looks.takes_width, 500.0f, 4.0f);
    assert_float_equal(s->panel->rows.x, x + 251.0f, 4.0f);
    assert_non_null(stand_word(s, s->line[3].title));
    stand_picture(s, "wide_list");
    window_hidden_put_away(s->window, true);
    stand_drag(s, s->panel->rows.x - 1.0f, y, 5.0f, y);
    stand_settle(s);
    assert_true(s->panel->rows.x >= 150.0f); /* it does not vanish */
    stand_close(s);
}

static void upper_corners_fade(void **state)
{
    (void)state;
    stand *s = open_stand();
    float top = s->panel->rows.row[0].y + 6.0f;
    stand_drag(s, stand_x(s, 1.06), top, stand_x(s, 2.06), top);
    assert_string_equal(s->edited[0], "clip.fade");
    near_s(s->take.layer[1].clip[0].fade_in_ns, 1.0, 0.06);
    stand_close(s);
}

static void a_clip_goes_to_another_layer(void **state)
{
    (void)state;
    stand *s = open_stand();
    help_do(&s->take, "{'op':'clip.trim','clip':2,'end_ns':3000m}");
    s->edition += 1;
    stand_drag(s, stand_x(s, 5.5), stand_y(s, 0), stand_x(s, 5.5), stand_y(s, 1));
    assert_string_equal(s->edited[0], "clip.move");
    assert_int_equal(s->take.layer[0].clip_count, 2);
    assert_int_equal(s->take.layer[0].clip[1].start_ns, 4 * help_s);
    stand_close(s);
}

static void what_is_not_possible_says_why_and_changes_nothing(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_drag(s, stand_x(s, 5.5), stand_y(s, 0), stand_x(s, 5.5), stand_y(s, 1));
    assert_int_equal(s->edit_count, 0);
    assert_int_equal(news_list_count(s->news), 1);
    assert_non_null(strstr(news_list_at(s->news, 0)->text, "would lie within"));
    stand_close(s);
}

static void an_edit_from_elsewhere_ends_a_drag(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_move(s, stand_x(s, 5.5), stand_y(s, 0));
    stand_button(s, 0, true);
    stand_move(s, stand_x(s, 7.5), stand_y(s, 0));
    help_do(&s->take, "{'op':'clip.remove','clip':5}");
    s->edition += 1;
    stand_move(s, stand_x(s, 8.0), stand_y(s, 0));
    stand_button(s, 0, false);
    assert_int_equal(s->step_count, 0);
    stand_close(s);
}

static void control_and_a_double_click_split(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_key(s, UI_KEY_CONTROL, true);
    stand_double_click(s, stand_x(s, 5.5), stand_y(s, 0));
    stand_key(s, UI_KEY_CONTROL, false);
    assert_string_equal(s->edited[0], "clip.split");
    near_s(s->last.at_ns, 5.5, 0.05);
    assert_int_equal(s->step_count, 1);
    stand_close(s);
}

/* ---- the ruler ---- */

static void the_lower_ruler_and_empty_lanes_scrub(void **state)
{
    (void)state;
    stand *s = open_stand();
    float y = s->panel->rows.y + 30.0f;
    stand_drag(s, stand_x(s, 2.0), y, stand_x(s, 6.0), y);
    near_s(seek_ns(s), 6.0, 0.02);
    assert_true(s->seeks >= 4);
    stand_click(s, stand_x(s, 8.5), stand_y(s, 0));
    near_s(seek_ns(s), 8.5, 0.02);
    assert_int_equal(s->choice.clip, 0);
    stand_drag(s, stand_x(s, 8.5), y, stand_x(s, 99.0), y);
    assert_int_equal(seek_ns(s), 10 * help_s);
    assert_int_equal(s->edit_count, 0);
    stand_close(s);
}

static void the_upper_ruler_makes_a_range_and_moves_its_ends(void **state)
{
    (void)state;
    stand *s = open_stand();
    float y = s->panel->rows.y + 8.0f;
    stand_drag(s, stand_x(s, 6.0), y, stand_x(s, 3.0), y);
    near_s(s->transport.loop_in_ns, 3.0, 0.05);
    near_s(s->transport.loop_out_ns, 6.0, 0.05);
    stand_drag(s, stand_x(s, 6.0), y, stand_x(s, 8.0), y);
    near_s(s->transport.loop_in_ns, 3.0, 0.05);
    near_s(s->transport.loop_out_ns, 8.0, 0.05);
    stand_close(s);
}

static void a_double_click_on_the_ruler_asks_for_a_marker(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_double_click(s, stand_x(s, 6.0), s->panel->rows.y + 8.0f);
    stand_settle(s);
    stand_type(s, "breath");
    stand_click_word(s, "Add");
    assert_string_equal(s->edited[0], "marker.add");
    assert_string_equal(s->take.marker[0].text, "breath");
    near_s(s->take.marker[0].at_ns, 6.0, 0.03);
    assert_int_equal(s->step_count, 1);

    stand_drag(s, stand_x(s, 6.0) + 4.0f, s->panel->rows.y + 8.0f, stand_x(s, 8.0) + 4.0f,
               s->panel->rows.y + 8.0f);
    assert_string_equal(s->edited[1], "marker.move");
    near_s(s->take.marker[0].at_ns, 8.0, 0.03);
    stand_close(s);
}

static void enter_names_a_marker_and_leaving_does_not(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_double_click(s, stand_x(s, 6.0), s->panel->rows.y + 8.0f);
    stand_type(s, "no");
    stand_click_word(s, "Cancel");
    assert_int_equal(s->edit_count, 0);
    assert_null(stand_word(s, "Cancel"));
    stand_double_click(s, stand_x(s, 7.0), s->panel->rows.y + 8.0f);
    stand_type(s, "yes");
    stand_key(s, UI_KEY_ENTER, true);
    stand_key(s, UI_KEY_ENTER, false);
    assert_int_equal(s->edit_count, 1);
    assert_string_equal(s->take.marker[0].text, "yes");
    assert_null(stand_word(s, "Cancel"));
    stand_close(s);
}

/* ---- heads ---- */

static void click_switch(stand *s, uint32_t index)
{
    ui_rectangle box = timeline_switch_box(&s->panel->rows, &s->panel->rows.row[0], index);
    stand_click(s, box.x + 8.0f, box.y + 8.0f);
}

static void switches_mute_solo_add_and_arm(void **state)
{
    (void)state;
    stand *s = open_stand();
    click_switch(s, 0);
    assert_true(s->take.layer[1].is_muted);
    click_switch(s, 0);
    assert_false(s->take.layer[1].is_muted);
    click_switch(s, 1);
    assert_true(s->take.layer[1].is_solo);
    click_switch(s, 2);
    assert_true(s->take.layer[1].is_additive);
    click_switch(s, 3);
    assert_int_equal(s->choice.armed, 3);
    click_switch(s, 3);
    assert_int_equal(s->choice.armed, 0);
    assert_int_equal(s->step_count, 4);
    stand_close(s);
}

static void gain_is_dragged_and_names_are_dragged_into_another_order(void **state)
{
    (void)state;
    stand *s = open_stand();
    ui_rectangle box = timeline_gain_box(&s->panel->rows, &s->panel->rows.row[0]);
    stand_drag(s, box.x + 40.0f, box.y + 8.0f, box.x + 10.0f, box.y + 8.0f);
    assert_string_equal(s->edited[0], "layer.gain");
    assert_float_equal(s->take.layer[1].gain, 0.75, 1e-9);
    stand_drag(s, 280.0f, s->panel->rows.row[0].y + 8.0f, 280.0f, s->panel->rows.row[1].y + 20.0f);
    assert_string_equal(s->edited[1], "layer.order");
    assert_int_equal(s->take.layer[0].id, 3);
    stand_close(s);
}

static void a_layer_is_renamed_and_given_parts(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_double_click(s, 280.0f, s->panel->rows.row[0].y + 8.0f);
    stand_click_word(s, "jaw");
    stand_click_word(s, "Change");
    assert_string_equal(s->edited[0], "layer.own");
    const own_part *mouth = own_part_of(OWN_MOUTH), *jaw = own_part_of(OWN_JAW);
    /* "mouth" was the person's own pattern, not the region's: it stays */
    assert_true(s->take.layer[1].own_count >= jaw->pattern_count);
    assert_true(own_layer_owns(&s->take.layer[1], "jaw.open"));
    assert_true(own_layer_owns(&s->take.layer[1], "mouth.corner.l"));
    (void)mouth;
    stand_close(s);
}

/* ---- the axis ---- */

static void the_wheel_zooms_about_the_pointer_and_shift_pans(void **state)
{
    (void)state;
    stand *s = open_stand();
    float x = stand_x(s, 3.0);
    double before = s->panel->axis.ns_per_point;
    stand_wheel(s, x, stand_y(s, 0), 2.0f);
    assert_true(s->panel->axis.ns_per_point < before * 0.7);
    assert_float_equal(stand_x(s, 3.0), x, 0.5f);
    stand_key(s, UI_KEY_SHIFT, true);
    stand_wheel(s, x, stand_y(s, 0), -1.0f);
    stand_key(s, UI_KEY_SHIFT, false);
    assert_float_equal(stand_x(s, 3.0), x - 60.0f, 0.5f);
    s->asked = ACTION_TIMELINE_FIT;
    stand_settle(s);
    assert_float_equal((float)(s->panel->axis.ns_per_point / before), 1.0f, 1e-4f);
    stand_close(s);
}

static void while_it_plays_the_page_turns(void **state)
{
    (void)state;
    stand *s = open_stand();
    for (int i = 0; i < 8; ++i)
        stand_wheel(s, stand_x(s, 0.5), stand_y(s, 0), 1.0f);
    int64_t from_ns = s->panel->axis.from_ns, turns = 0;
    transport_seek(&s->transport, s->clock_ns, from_ns < 0 ? 0 : from_ns);
    transport_play(&s->transport, s->clock_ns);
    for (int i = 0; i < 500; ++i) {
        stand_frame(s);
        turns += s->panel->axis.from_ns != from_ns;
        from_ns = s->panel->axis.from_ns;
        float x = timeline_axis_x(&s->panel->axis, timeline_head_ns(s->panel));
        assert_true(x >= s->panel->axis.x - 1.0f);
        assert_true(x <= s->panel->axis.x + s->panel->axis.width + 1.0f);
    }
    assert_in_range(turns, 2, 12);
    stand_close(s);
}

/* ---- takes ---- */

static void stars_are_given_with_a_click(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_list(s, 4);
    stand_settle(s);
    const ui_word *word = stand_word(s, "1/a 4 again");
    assert_non_null(word);
    float y = word->where.y + 8.0f;
    float right = 250.0f - 8.0f - 8.0f - 50.0f - 4.0f; /* of the stars */
    stand_click(s, right - 60.0f + 3.5f * 12.0f, y); /* of a take that is not chosen: it is then */
    pass_half_a_second(s);
    assert_int_equal(s->selected_id, 4);
    assert_int_equal(s->rated, 0);
    s->take.id = 4;
    stand_settle(s);
    stand_click(s, right - 60.0f + 3.5f * 12.0f, y);
    pass_half_a_second(s);
    assert_int_equal(s->take.rating, 4);
    s->line[3].rating = 4;
    stand_click(s, right - 60.0f + 3.5f * 12.0f, y);
    pass_half_a_second(s);
    assert_int_equal(s->take.rating, 3);
    stand_close(s);
}

/* Where the stars are, too. */
static void a_double_click_on_a_star_rates_nothing(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_list(s, 4);
    stand_settle(s);
    const uint32_t before = s->line[3].rating;
    const float y = stand_word(s, "1/a 4 again")->where.y + 8.0f;
    stand_double_click(s, 250.0f - 8.0f - 8.0f - 50.0f - 4.0f - 60.0f + 3.5f * 12.0f, y);
    pass_half_a_second(s);
    assert_int_equal(s->done, ACTION_COUNT); /* it was shown */
    assert_int_equal(s->rated, 0);
    assert_int_equal(s->line[3].rating, before);
    stand_close(s);
}

static void a_click_chooses_a_take_for_the_keys(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_list(s, 4);
    stand_settle(s);
    const ui_word *word = stand_word(s, "1/a 2");
    assert_non_null(word);
    stand_click(s, word->where.x + 8.0f, word->where.y + 8.0f);
    assert_int_equal(s->selected_id, 2);
    assert_true(s->choice.is_take);
    stand_click(s, stand_x(s, 2.0), stand_y(s, 1)); /* of the timeline something else is chosen */
    assert_false(s->choice.is_take);
    stand_close(s);
}

static void the_strip_of_what_was_always_recorded_is_a_click_away(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_list(s, 4);
    stand_settle(s);
    stand_click_word(s, "Always recorded");
    assert_int_equal(s->rated_id, 0);
    assert_int_equal(s->done, ACTION_COUNT);
    stand_check_words(s);
    stand_picture(s, "back");
    stand_close(s);
}

/* A second right click beside an open menu is about what is there; Escape closes the menu. */
static void a_menu_is_that_of_what_was_clicked_last(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_settle(s);
    right_click(s, stand_x(s, 2.0), stand_y(s, 1));
    assert_non_null(stand_word(s, "Speed, gain, fades \u2026"));
    right_click(s, 250.0f + 30.0f, stand_y(s, 1)); /* the header of the layer */
    assert_null(stand_word(s, "Speed, gain, fades \u2026"));
    assert_non_null(stand_word(s, "Name and parts \u2026"));
    stand_key(s, UI_KEY_ESCAPE, true);
    stand_key(s, UI_KEY_ESCAPE, false);
    stand_settle(s);
    assert_null(stand_word(s, "Name and parts \u2026"));
    stand_close(s);
}

static void a_double_click_shows_a_take(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_list(s, 4);
    stand_settle(s);
    const ui_word *word = stand_word(s, "1/a 2");
    assert_non_null(word);
    float x = word->where.x + 8.0f, y = word->where.y + 8.0f;
    stand_click(s, x, y);
    assert_int_equal(s->done, ACTION_NONE);
    stand_double_click(s, x, y);
    assert_int_equal(s->rated_id, 2);
    stand_close(s);
}

static void takes_are_found_by_words_stars_and_fate(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_list(s, 5000);
    stand_settle(s);
    assert_int_equal(s->panel->takes.count, 5000 - 454);
    stand_click_word(s, "Deleted");
    assert_int_equal(s->panel->takes.count, 454);
    stand_click_word(s, "3 stars +");
    for (uint32_t i = 0; i < s->panel->takes.count; ++i)
        assert_true(s->line[s->panel->takes.row[i].line].rating >= 3);
    stand_click_word(s, "All");
    stand_click_word(s, "Search");
    stand_type(s, "QUIET letter");
    for (uint32_t i = 0; i < s->panel->takes.count; ++i)
        assert_non_null(strstr(s->line[s->panel->takes.row[i].line].title, "quiet"));
    assert_in_range(s->panel->takes.count, 1000, 1250);
    stand_close(s);
}

/* ---- the journal ---- */

static void a_swipe_over_the_journal_keeps_that_span(void **state)
{
    (void)state;
    stand *s = open_stand();
    stand_choose(s, (take){0});
    s->choice = (app_choice){.marker = -1};
    float x = s->panel->axis.x, width = s->panel->axis.width; /* 60 s */
    int64_t begun_ns = clock_now_ns();                        /* the strip rolls on meanwhile */
    stand_drag(s, x + width * 0.5f, 150.0f, x + width * 0.75f, 150.0f);
    double took_s = (double)(clock_now_ns() - begun_ns) * 1e-9;
    near_s(begun_ns - s->kept_from_ns, 30.0 - 0.5 * took_s, 1.0 + 0.5 * took_s);
    near_s(s->kept_to_ns - s->kept_from_ns, 15.0 + 0.5 * took_s, 1.0 + 0.5 * took_s);
    assert_int_equal(s->last.kind, EDIT_NONE);
    stand_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clip_is_dragged_in_time_in_one_step),
        cmocka_unit_test(a_click_chooses_and_changes_nothing),
        cmocka_unit_test(escape_cancels_a_drag),
        cmocka_unit_test(the_list_of_takes_is_as_wide_as_it_is_pulled),
        cmocka_unit_test(clips_and_layers_have_colours),
        cmocka_unit_test(what_a_drag_snaps_to_is_told),
        cmocka_unit_test(with_ripple_what_follows_moves_and_the_status_says_so),
        cmocka_unit_test(gain_speed_and_fades_are_on_the_face_while_they_are_dragged),
        cmocka_unit_test(the_sliders_of_a_clip_are_on_the_face_too),
        cmocka_unit_test(edges_trim_and_with_ctrl_retime),
        cmocka_unit_test(upper_corners_fade),
        cmocka_unit_test(a_clip_goes_to_another_layer),
        cmocka_unit_test(what_is_not_possible_says_why_and_changes_nothing),
        cmocka_unit_test(an_edit_from_elsewhere_ends_a_drag),
        cmocka_unit_test(control_and_a_double_click_split),
        cmocka_unit_test(the_lower_ruler_and_empty_lanes_scrub),
        cmocka_unit_test(the_upper_ruler_makes_a_range_and_moves_its_ends),
        cmocka_unit_test(a_double_click_on_the_ruler_asks_for_a_marker),
        cmocka_unit_test(enter_names_a_marker_and_leaving_does_not),
        cmocka_unit_test(switches_mute_solo_add_and_arm),
        cmocka_unit_test(gain_is_dragged_and_names_are_dragged_into_another_order),
        cmocka_unit_test(a_layer_is_renamed_and_given_parts),
        cmocka_unit_test(the_wheel_zooms_about_the_pointer_and_shift_pans),
        cmocka_unit_test(while_it_plays_the_page_turns),
        cmocka_unit_test(stars_are_given_with_a_click),
        cmocka_unit_test(a_double_click_on_a_star_rates_nothing),
        cmocka_unit_test(a_click_chooses_a_take_for_the_keys),
        cmocka_unit_test(the_strip_of_what_was_always_recorded_is_a_click_away),
        cmocka_unit_test(a_menu_is_that_of_what_was_clicked_last),
        cmocka_unit_test(a_double_click_shows_a_take),
        cmocka_unit_test(takes_are_found_by_words_stars_and_fate),
        cmocka_unit_test(a_swipe_over_the_journal_keeps_that_span),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
