/* Events of a window, a frame's worth at a time. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/gui/ui_queue.h"

#include <math.h>
#include <string.h>

static ui_queue queue;
static ui_frame_input now;

static int fresh(void **state)
{
    (void)state;
    ui_queue_init(&queue);
    memset(&now, 0, sizeof now);
    return 0;
}

static void push(ui_event event)
{
    ui_queue_push(&queue, &event);
}

static void key(uint32_t code, bool is_down)
{
    push((ui_event){.kind = UI_EVENT_KEY, .code = code, .is_down = is_down});
}

static void button(uint32_t code, bool is_down)
{
    push((ui_event){.kind = UI_EVENT_BUTTON, .code = code, .is_down = is_down});
}

static void move(float x, float y)
{
    push((ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
}

static void text(uint32_t code)
{
    push((ui_event){.kind = UI_EVENT_TEXT, .code = code});
}

static void twenty_taps_are_twenty_presses(void **state)
{
    (void)state;
    for (int i = 0; i < 20; ++i) {
        key('R', true);
        key('R', false);
    }
    uint32_t presses = 0, frames = 0;
    for (; !ui_queue_is_empty(&queue); ++frames) {
        ui_queue_take(&queue, &now);
        presses += now.pressed['R'];
    }
    assert_int_equal(presses, 20);
    assert_int_equal(frames, 40);
}

static void different_keys_share_a_frame(void **state)
{
    (void)state;
    key('A', true);
    key('B', true);
    key('C', true);
    ui_queue_take(&queue, &now);
    assert_true(now.pressed['A'] && now.pressed['B'] && now.pressed['C']);
    assert_true(ui_queue_is_empty(&queue));
    ui_queue_take(&queue, &now);
    assert_true(now.key['A'] && !now.pressed['A']);
}

static void a_shortcut_keeps_its_modifier(void **state)
{
    (void)state;
    key(UI_KEY_CONTROL, true);
    key('Z', true);
    key('Z', false);
    key(UI_KEY_CONTROL, false);
    ui_queue_take(&queue, &now);
    assert_true(now.pressed['Z']);
    assert_int_equal(ui_frame_modifiers(&now), UI_CONTROL);
    ui_queue_take(&queue, &now);
    ui_queue_take(&queue, &now);
    assert_int_equal(ui_frame_modifiers(&now), 0);
    assert_true(ui_queue_is_empty(&queue));
}

static void a_press_is_where_the_pointer_was(void **state)
{
    (void)state;
    move(10, 10);
    button(0, true);
    move(50, 50);
    ui_queue_take(&queue, &now);
    assert_true(now.button[0]);
    assert_float_equal(now.x, 10.0f, 0.0f);
    ui_queue_take(&queue, &now);
    assert_float_equal(now.x, 50.0f, 0.0f);
}

static void what_is_dragged_arrives_before_it_is_let_go(void **state)
{
    (void)state;
    button(0, true);
    ui_queue_take(&queue, &now);
    move(30, 40);
    button(0, false);
    ui_queue_take(&queue, &now);
    assert_true(now.button[0]);
    assert_float_equal(now.y, 40.0f, 0.0f);
    ui_queue_take(&queue, &now);
    assert_false(now.button[0]);
}

static void moves_become_one(void **state)
{
    (void)state;
    for (int i = 0; i < 100000; ++i)
        move((float)i, 1.0f);
    ui_queue_take(&queue, &now);
    assert_float_equal(now.x, 99999.0f, 0.0f);
    assert_true(ui_queue_is_empty(&queue));
}

static void letters_and_keys_that_change_them_stay_in_order(void **state)
{
    (void)state;
    text('a');
    key(UI_KEY_BACKSPACE, true);
    key(UI_KEY_BACKSPACE, false);
    text('b');
    ui_queue_take(&queue, &now);
    assert_int_equal(now.text_count, 1);
    assert_false(now.pressed[UI_KEY_BACKSPACE]);
    ui_queue_take(&queue, &now);
    assert_true(now.pressed[UI_KEY_BACKSPACE]);
    assert_int_equal(now.text_count, 0);
    ui_queue_take(&queue, &now);
    ui_queue_take(&queue, &now);
    assert_int_equal(now.text_count, 1);
    assert_int_equal(now.text[0], 'b');
}

/* As fast as hands write, where a frame takes a third of a second. */
static void a_word_is_typed_within_one_frame(void **state)
{
    (void)state;
    static const char word[] = "Mississippi";
    now.is_typing = true;
    for (const char *c = word; *c; ++c) {
        const uint32_t of = (uint32_t)(*c >= 'a' ? *c - 'a' + 'A' : *c);
        if (*c < 'a')
            key(UI_KEY_SHIFT, true);
        key(of, true);
        text((uint32_t)*c);
        key(of, false);
        if (*c < 'a')
            key(UI_KEY_SHIFT, false);
    }
    key(UI_KEY_BACKSPACE, true);
    ui_queue_take(&queue, &now);
    assert_int_equal(now.text_count, strlen(word));
    for (uint32_t i = 0; i < now.text_count; ++i)
        assert_int_equal(now.text[i], word[i]);
    assert_false(now.key['I'] || now.key[UI_KEY_SHIFT] || now.key[UI_KEY_BACKSPACE]);
    ui_queue_take(&queue, &now);
    assert_true(now.pressed[UI_KEY_BACKSPACE]);
}

static void a_shortcut_in_a_text_has_a_frame_of_its_own(void **state)
{
    (void)state;
    now.is_typing = true;
    text('x');
    key(UI_KEY_CONTROL, true);
    key('A', true);
    key('A', false);
    key(UI_KEY_CONTROL, false);
    key('B', true);
    text('b');
    ui_queue_take(&queue, &now); /* with Control held, letters are dropped */
    assert_int_equal(now.text_count, 1);
    assert_false(now.key[UI_KEY_CONTROL]);
    ui_queue_take(&queue, &now);
    assert_true(now.key['A'] && now.key[UI_KEY_CONTROL]);
    ui_queue_take(&queue, &now);
    assert_false(now.key['A']);
    assert_int_equal(now.text_count, 0);
    ui_queue_take(&queue, &now);
    assert_false(now.key[UI_KEY_CONTROL]);
    assert_int_equal(now.text[0], 'b');
}

/* What ends the typing does so before the next key is looked at. */
static void a_key_after_enter_waits(void **state)
{
    (void)state;
    now.is_typing = true;
    key(UI_KEY_ENTER, true);
    key(UI_KEY_ENTER, false);
    key('R', true);
    key('R', false);
    ui_queue_take(&queue, &now);
    assert_false(now.pressed['R']);
}

static void all_goes_up_when_the_window_is_left(void **state)
{
    (void)state;
    key('A', true);
    button(0, true);
    push((ui_event){.kind = UI_EVENT_FOCUS, .is_down = false});
    ui_queue_take(&queue, &now);
    assert_true(now.key['A'] && now.button[0]);
    ui_queue_take(&queue, &now);
    assert_false(now.key['A'] || now.button[0]);
}

static void a_flood_forgets_and_lets_go(void **state)
{
    (void)state;
    key('A', true);
    ui_queue_take(&queue, &now);
    for (uint32_t i = 0; i < UI_QUEUE_EVENTS + 10; ++i)
        key('B', i % 2 == 0);
    for (int i = 0; !ui_queue_is_empty(&queue); ++i) {
        assert_true(i < 2 * UI_QUEUE_EVENTS);
        ui_queue_take(&queue, &now);
    }
    assert_false(now.key['A']);
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    key(UI_KEY_COUNT, true);
    key(0, true);
    button(3, true);
    move(NAN, 0);
    text(7);
    text(0x110000);
    push((ui_event){.kind = UI_EVENT_WHEEL, .x = INFINITY});
    assert_true(ui_queue_is_empty(&queue));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(twenty_taps_are_twenty_presses, fresh),
        cmocka_unit_test_setup(different_keys_share_a_frame, fresh),
        cmocka_unit_test_setup(a_shortcut_keeps_its_modifier, fresh),
        cmocka_unit_test_setup(a_press_is_where_the_pointer_was, fresh),
        cmocka_unit_test_setup(what_is_dragged_arrives_before_it_is_let_go, fresh),
        cmocka_unit_test_setup(moves_become_one, fresh),
        cmocka_unit_test_setup(letters_and_keys_that_change_them_stay_in_order, fresh),
        cmocka_unit_test_setup(a_word_is_typed_within_one_frame, fresh),
        cmocka_unit_test_setup(a_shortcut_in_a_text_has_a_frame_of_its_own, fresh),
        cmocka_unit_test_setup(a_key_after_enter_waits, fresh),
        cmocka_unit_test_setup(all_goes_up_when_the_window_is_left, fresh),
        cmocka_unit_test_setup(a_flood_forgets_and_lets_go, fresh),
        cmocka_unit_test_setup(nonsense_is_refused, fresh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
