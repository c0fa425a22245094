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
    assert_true(stand_shows(&s, "No output is open."));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_output_none");
    close_panel(&s);
}

static void one_is_added_says_how_it_does_and_is_closed(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_panel(&s);
    stand_click(&s, "Add");
    assert_int_equal(outputs_count(sent), 1);
    stand_wait_for(&s, "Opening");
    assert_false(stand_shows(&s, "No output is open"));
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_begins_with_what_it_is_for),
        cmocka_unit_test(one_is_added_says_how_it_does_and_is_closed),
        cmocka_unit_test(what_is_refused_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
