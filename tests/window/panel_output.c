/* The panel that says where the face goes: what is open with its light and how it does, what is
 * wrong, another one opened and closed. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "panel_stand.h"

#include <string.h>

/* ---- the application's part ---- */

static outputs *sent;
static error trouble;

outputs *live_outputs(live *self)
{
    (void)self;
    return sent;
}

mrt_result app_add_output(app *self, const char *text)
{
    (void)self;
    trouble = (error){""};
    return outputs_add(sent, text, &trouble);
}

void app_remove_output(app *self, uint32_t index)
{
    (void)self;
    outputs_remove(sent, index);
}

const char *app_output_trouble(const app *self)
{
    (void)self;
    return trouble.text;
}

/* ---- tests ---- */

static log_queue *said;

static void open_panel(stand *s)
{
    error err = {""};
    trouble = (error){""};
    said = log_queue_create();
    const outputs_settings of = {.plugins = &s->plugins, .log = said, .isolation = ISOLATE_NONE};
    if (outputs_create(&sent, &of, &err) < 0)
        fail_msg("%s", err.text);
    stand_open(s, &panel_output, 1.0f);
    stand_plugin(s, "tests/plugin/troubled_output");
    stand_settle(s);
}

static void close_panel(stand *s)
{
    while (outputs_count(sent) > 0) /* before their plugins go */
        outputs_remove(sent, 0);
    stand_close(s);
    outputs_destroy(sent);
    log_queue_destroy(said);
}

static void it_begins_with_what_it_is_for(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_panel(&s);
    assert_true(stand_shows(&s, "Nothing is sent."));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_output_none");
    close_panel(&s);
}

static void one_is_added_says_how_it_does_and_is_closed(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_panel(&s);
    stand_click(&s, "Start sending");
    assert_int_equal(outputs_count(sent), 1);
    stand_wait_for(&s, "Opening");
    assert_false(stand_shows(&s, "Nothing is sent"));
    assert_true(outputs_add(sent, "troubled_output:9,trouble=4", &trouble) >= 0);
    stand_wait_for(&s, "the door is locked. Retrying.");
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_output");
    stand_click(&s, "Close");
    assert_int_equal(outputs_count(sent), 1);
    close_panel(&s);
}

static void what_is_refused_is_said(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_panel(&s);
    assert_true(app_add_output(NULL, "troubled_output:9,colour=3") < 0);
    stand_wait_for(&s, "colour");
    assert_int_equal(outputs_count(sent), 0);
    close_panel(&s);
}

/* ---- receivers by the names of their programs ---- */

static void choose(stand *s, const char *from, const char *to)
{
    stand_click(s, from);
    stand_click_last(s, to);
    stand_settle(s);
}

static void write_into(stand *s, const char *field, const char *text)
{
    stand_settle(s);
    const ui_word *label = stand_word(s, field);
    if (!label)
        fail_msg("no field %s", field);
    const float x = label->where.x, y = label->where.y + 0.5f * label->where.height;
    stand_click_at(s, x + 80.0f, y);
    stand_key(s, UI_KEY_BACKSPACE);
    stand_type(s, text);
    stand_click_at(s, x + 2.0f, y); /* beside it: Tab would go on to the next field */
}

static const char *text_of(uint32_t index)
{
    static output_status s;
    outputs_status(sent, index, &s);
    return s.text;
}

static void open_receivers(stand *s)
{
    open_panel(s);
    stand_plugin(s, "plugins/livelink");
    stand_plugin(s, "plugins/vmc");
    stand_plugin(s, "plugins/vts");
    stand_plugin(s, "plugins/ifacialmocap");
    stand_plugin(s, "plugins/face_osc");
    stand_settle(s);
}

static void a_program_is_chosen_by_its_name_and_its_fields_are_filled_in(void **state)
{
    static const struct {
        const char *name, *port, *rate, *setup, *text;
    } of[] = {
        {"Unreal (Live Link)", "11111", "60", "Apple ARKit",
         "org.marotte.livelink:127.0.0.1:11111,rate=60"},
        {"VSeeFace, Warudo, Blender (VMC)", "39540", NULL, "VMC receiver",
         "org.marotte.vmc:127.0.0.1:39540"},
        {"EVMC4U, whole person (VMC)", "39539", NULL, "EVMC4U to",
         "org.marotte.vmc:127.0.0.1:39539,role=performer"},
        {"VTube Studio", "8001", "60", "plugin API", "org.marotte.vts:127.0.0.1:8001,rate=60"},
        {"iFacialMocap receivers", "49983", "60", "0.0.0.0",
         "org.marotte.ifacialmocap:127.0.0.1:49983,rate=60"},
        {"OSC", "9106", NULL, "/marotte/1/face", "org.marotte.face_osc:127.0.0.1:9106"},
    };
    (void)state;
    stand s = {.input_count = 0};
    open_receivers(&s);
    for (uint32_t i = 0; i < sizeof of / sizeof *of; ++i) {
        if (i > 0) /* after a start the form keeps its receiver */
            choose(&s, of[i - 1].name, of[i].name);
        assert_non_null(stand_word(&s, "127.0.0.1"));
        assert_non_null(stand_word(&s, of[i].port));
        assert_non_null(stand_word(&s, of[i].rate ? of[i].rate : "every face"));
        assert_true(stand_shows(&s, of[i].setup));
        stand_check_words(&s, NULL);
        stand_click(&s, "Start sending");
        assert_int_equal(outputs_count(sent), 1);
        assert_string_equal(text_of(0), of[i].text);
        outputs_remove(sent, 0);
        stand_settle(&s);
    }
    assert_false(stand_shows(&s, "org.marotte"));
    stand_picture(&s, "panel_output_receivers");
    close_panel(&s);
}

static void the_fields_are_what_is_sent_to(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_receivers(&s);
    write_into(&s, "Address", "192.0.2.7");
    write_into(&s, "Port", "11112");
    write_into(&s, "Rate", "30");
    stand_click(&s, "Start sending");
    assert_int_equal(outputs_count(sent), 1);
    assert_string_equal(text_of(0), "org.marotte.livelink:192.0.2.7:11112,rate=30");
    stand_wait_for(&s, "192.0.2.7:11112");
    stand_check_words(&s, NULL);
    close_panel(&s);
}

static void wrong_fields_are_refused_in_a_sentence_that_goes_away(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_receivers(&s);
    write_into(&s, "Port", "70000");
    stand_click(&s, "Start sending");
    assert_true(stand_shows(&s, "Write a port from 1 to 65535."));
    assert_int_equal(outputs_count(sent), 0);
    write_into(&s, "Port", "11111");
    write_into(&s, "Rate", "900");
    stand_click(&s, "Start sending");
    assert_true(stand_shows(&s, "Write a rate from 1 to 240 faces per second."));
    assert_int_equal(outputs_count(sent), 0);
    write_into(&s, "Rate", "24");
    stand_click(&s, "Start sending");
    assert_int_equal(outputs_count(sent), 1);
    stand_settle(&s);
    assert_false(stand_shows(&s, "Write a"));
    close_panel(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_begins_with_what_it_is_for),
        cmocka_unit_test(one_is_added_says_how_it_does_and_is_closed),
        cmocka_unit_test(what_is_refused_is_said),
        cmocka_unit_test(a_program_is_chosen_by_its_name_and_its_fields_are_filled_in),
        cmocka_unit_test(the_fields_are_what_is_sent_to),
        cmocka_unit_test(wrong_fields_are_refused_in_a_sentence_that_goes_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
