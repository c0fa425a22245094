/* plugins/gamepad: what the axes and buttons of differing pads are (pad.h). The layouts are those
 * of Linux' drivers: xpad, hid-playstation, hid-nintendo, hid-generic. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "pad.h"

#include <linux/input-event-codes.h>
#include <string.h>

static void add_axis(pad_model *model, uint16_t code, int32_t low, int32_t high)
{
    model->axis[code] = (pad_axis){true, low, high};
}

static void add_key(pad_model *model, uint16_t code)
{
    model->key[code / 8] |= (uint8_t)(1u << code % 8);
}

/* Sticks of 8 bits that rest in the middle, without a dead zone. */
static pad_model pad_of_bytes(const uint16_t *axes, uint32_t count, pad_state *state)
{
    pad_model model = {.vendor = 0x054c};
    memset(state, 0, sizeof *state);
    for (uint32_t i = 0; i < count; ++i) {
        add_axis(&model, axes[i], 0, 255);
        state->axis[axes[i]] = 128;
    }
    add_key(&model, BTN_SOUTH);
    return model;
}

static void sony_has_its_right_stick_on_rx_and_triggers_on_z(void **state)
{
    (void)state;
    static const uint16_t axes[] = {ABS_X, ABS_Y, ABS_Z, ABS_RX, ABS_RY, ABS_RZ};
    pad_state at;
    float out[PAD_CHANNELS];
    pad_model model = pad_of_bytes(axes, 6, &at);
    pad_set_axis(&at, ABS_RX, 255);
    pad_set_axis(&at, ABS_RY, 0);
    pad_set_axis(&at, ABS_Z, 255);
    pad_set_axis(&at, ABS_RZ, 0);
    pad_set_key(&at, BTN_WEST, true); /* the square */
    pad_read(&model, &at, 0, out);
    assert_float_equal(out[PAD_RIGHT_X], 1, 0);
    assert_float_equal(out[PAD_RIGHT_Y], 1, 0);
    assert_float_equal(out[PAD_LEFT_TRIGGER], 1, 0);
    assert_float_equal(out[PAD_RIGHT_TRIGGER], 0, 0);
    assert_float_equal(out[PAD_WEST], 1, 0);
    assert_float_equal(out[PAD_NORTH], 0, 0);
    model.vendor = 0x045e; /* the same code is the letter Y of Microsoft's, above */
    pad_read(&model, &at, 0, out);
    assert_float_equal(out[PAD_NORTH], 1, 0);
    assert_float_equal(out[PAD_WEST], 0, 0);
}

static void generic_pads_have_it_on_z_and_triggers_on_gas_or_buttons(void **state)
{
    (void)state;
    static const uint16_t axes[] = {ABS_X, ABS_Y, ABS_Z, ABS_RZ, ABS_GAS, ABS_BRAKE};
    pad_state at;
    float out[PAD_CHANNELS];
    pad_model model = pad_of_bytes(axes, 6, &at);
    pad_set_axis(&at, ABS_Z, 0);
    pad_set_axis(&at, ABS_RZ, 255);
    pad_set_axis(&at, ABS_GAS, 255);
    pad_set_axis(&at, ABS_BRAKE, 0);
    pad_read(&model, &at, 0, out);
    assert_float_equal(out[PAD_RIGHT_X], -1, 0);
    assert_float_equal(out[PAD_RIGHT_Y], -1, 0);
    assert_float_equal(out[PAD_RIGHT_TRIGGER], 1, 0);
    assert_float_equal(out[PAD_LEFT_TRIGGER], 0, 0);
    model = pad_of_bytes(axes, 4, &at); /* without GAS and BRAKE: buttons, as the cross */
    pad_set_key(&at, BTN_TL2, true);
    pad_set_key(&at, BTN_DPAD_UP, true);
    pad_set_key(&at, BTN_DPAD_LEFT, true);
    pad_read(&model, &at, 0, out);
    assert_float_equal(out[PAD_LEFT_TRIGGER], 1, 0);
    assert_float_equal(out[PAD_CROSS_Y], 1, 0);
    assert_float_equal(out[PAD_CROSS_X], -1, 0);
}

static void a_joystick_numbers_its_buttons(void **state)
{
    (void)state;
    pad_state at = {{0}, {0}};
    float out[PAD_CHANNELS];
    pad_model model = {.vendor = 1};
    add_axis(&model, ABS_X, 0, 1023);
    add_axis(&model, ABS_Y, 0, 1023);
    add_key(&model, BTN_TRIGGER);
    add_key(&model, BTN_THUMB);
    assert_true(pad_is_pad(&model));
    pad_set_key(&at, BTN_TRIGGER, true);
    pad_set_axis(&at, ABS_X, 1023);
    pad_read(&model, &at, 0.1f, out);
    assert_float_equal(out[PAD_SOUTH], 1, 0);
    assert_float_equal(out[PAD_EAST], 0, 0);
    assert_true(out[PAD_LEFT_X] > 0.7f && out[PAD_LEFT_Y] > 0.7f); /* a corner */
    assert_float_equal(out[PAD_RIGHT_X], 0, 0);                    /* there is none */
}

static void what_is_no_pad_is_left_out(void **state)
{
    (void)state;
    pad_model mouse = {0}, touchpad = {0}, motion = {0};
    add_key(&mouse, BTN_LEFT);
    add_axis(&touchpad, ABS_X, 0, 1000);
    add_axis(&touchpad, ABS_Y, 0, 1000);
    add_key(&touchpad, BTN_LEFT);
    add_key(&touchpad, BTN_TOUCH);
    add_axis(&motion, ABS_X, -1000, 1000);
    add_axis(&motion, ABS_Y, -1000, 1000);
    add_axis(&motion, ABS_Z, -1000, 1000);
    assert_false(pad_is_pad(&mouse));
    assert_false(pad_is_pad(&touchpad));
    assert_false(pad_is_pad(&motion));
}

static void an_axis_without_a_range_rests(void **state)
{
    (void)state;
    static const uint16_t axes[] = {ABS_X, ABS_Y, ABS_RX, ABS_RY, ABS_Z, ABS_RZ};
    pad_state at;
    float out[PAD_CHANNELS];
    pad_model model = pad_of_bytes(axes, 6, &at);
    for (uint32_t i = 0; i < 6; ++i)
        model.axis[axes[i]] = (pad_axis){true, 5, i % 2 ? 5 : -5};
    pad_read(&model, &at, 0.12f, out);
    for (int i = 0; i < PAD_CHANNELS; ++i)
        assert_float_equal(out[i], 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sony_has_its_right_stick_on_rx_and_triggers_on_z),
        cmocka_unit_test(generic_pads_have_it_on_z_and_triggers_on_gas_or_buttons),
        cmocka_unit_test(a_joystick_numbers_its_buttons),
        cmocka_unit_test(what_is_no_pad_is_left_out),
        cmocka_unit_test(an_axis_without_a_range_rests),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
