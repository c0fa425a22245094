#include "pad.h"

#include <linux/input-event-codes.h>
#include <math.h>

const char *const pad_name[PAD_CHANNELS] = {
    "left.x",  "left.y", "right.x", "right.y",    "left.trigger", "right.trigger", "cross.x",
    "cross.y", "south",  "east",    "west",       "north",        "left.shoulder", "right.shoulder",
    "select",  "start",  "mode",    "left.stick", "right.stick",
};

_Static_assert(PAD_AXES == ABS_CNT && PAD_KEYS == KEY_CNT, "as linux/input.h has them");

static bool has_bit(const uint8_t *bits, uint16_t code)
{
    return code < PAD_KEYS && (bits[code / 8] >> code % 8 & 1);
}

static bool has_key(const pad_model *model, uint16_t code)
{
    return has_bit(model->key, code);
}

bool pad_is_pad(const pad_model *model)
{
    return model->axis[ABS_X].is_there && model->axis[ABS_Y].is_there &&
           (has_key(model, BTN_SOUTH) || has_key(model, BTN_TRIGGER)) &&
           !has_key(model, BTN_TOUCH) && !has_key(model, BTN_TOOL_PEN);
}

void pad_set_axis(pad_state *state, uint16_t code, int32_t value)
{
    if (code < PAD_AXES)
        state->axis[code] = value;
}

void pad_set_key(pad_state *state, uint16_t code, bool is_down)
{
    const uint8_t bit = (uint8_t)(1u << code % 8);
    if (code < PAD_KEYS && is_down)
        state->key[code / 8] |= bit;
    else if (code < PAD_KEYS)
        state->key[code / 8] &= (uint8_t)~bit;
}

/* Returns 0 at the low end, 1 at the high one; NAN if the axis does not exist. */
static float share_of(const pad_model *model, const pad_state *state, uint16_t code)
{
    const pad_axis *axis = &model->axis[code];
    if (!axis->is_there || axis->high <= axis->low)
        return NAN;
    const double span = (double)axis->high - (double)axis->low;
    const double share = ((double)state->axis[code] - (double)axis->low) / span;
    return (float)(share < 0.0 ? 0.0 : share > 1.0 ? 1.0 : share);
}

static float key_of(const pad_state *state, uint16_t code)
{
    return has_bit(state->key, code) ? 1.0f : 0.0f;
}

/* Linux uses positive values for down. */
static void read_stick(const pad_model *model, const pad_state *state, uint16_t x_code,
                       uint16_t y_code, float dead, float out[2])
{
    const float x = 2.0f * share_of(model, state, x_code) - 1.0f;
    const float y = 1.0f - 2.0f * share_of(model, state, y_code);
    out[0] = out[1] = 0.0f;
    if (isnan(x) || isnan(y))
        return;
    const float radius = sqrtf(x * x + y * y);
    if (radius <= dead)
        return;
    const float gain = (radius - dead) / (radius * (1.0f - dead));
    out[0] = fmaxf(-1.0f, fminf(1.0f, x * gain));
    out[1] = fmaxf(-1.0f, fminf(1.0f, y * gain));
}

static float read_trigger(const pad_model *model, const pad_state *state, int axis, uint16_t button,
                          float dead)
{
    const float pressed = axis >= 0 ? share_of(model, state, (uint16_t)axis) : NAN;
    if (isnan(pressed))
        return key_of(state, button);
    return pressed <= dead ? 0.0f : (pressed - dead) / (1.0f - dead);
}

static float read_cross(const pad_model *model, const pad_state *state, uint16_t axis, uint16_t low,
                        uint16_t high)
{
    const float share = share_of(model, state, axis);
    if (isnan(share))
        return key_of(state, high) - key_of(state, low);
    return share < 0.25f ? -1.0f : share > 0.75f ? 1.0f : 0.0f;
}

/* Drivers differ in the axes of the right stick and the triggers. Pads with two sticks use either
 * RX and RY for the stick and Z and RZ for the triggers, or Z and RZ for the stick and GAS and
 * BRAKE for the triggers. */
void pad_read(const pad_model *model, const pad_state *state, float dead, float out[PAD_CHANNELS])
{
    static const uint16_t microsoft = 0x045e;
    static const uint16_t button[][2] = {
        {PAD_SOUTH, BTN_SOUTH},       {PAD_EAST, BTN_EAST},         {PAD_LEFT_SHOULDER, BTN_TL},
        {PAD_RIGHT_SHOULDER, BTN_TR}, {PAD_SELECT, BTN_SELECT},     {PAD_START, BTN_START},
        {PAD_MODE, BTN_MODE},         {PAD_LEFT_STICK, BTN_THUMBL}, {PAD_RIGHT_STICK, BTN_THUMBR}};
    const bool has_r = model->axis[ABS_RX].is_there && model->axis[ABS_RY].is_there;
    const bool is_joystick = !has_key(model, BTN_SOUTH);
    read_stick(model, state, ABS_X, ABS_Y, dead, out + PAD_LEFT_X);
    read_stick(model, state, has_r ? ABS_RX : ABS_Z, has_r ? ABS_RY : ABS_RZ, dead,
               out + PAD_RIGHT_X);
    out[PAD_LEFT_TRIGGER] = read_trigger(model, state, has_r ? ABS_Z : ABS_BRAKE, BTN_TL2, dead);
    out[PAD_RIGHT_TRIGGER] = read_trigger(model, state, has_r ? ABS_RZ : ABS_GAS, BTN_TR2, dead);
    out[PAD_CROSS_X] = read_cross(model, state, ABS_HAT0X, BTN_DPAD_LEFT, BTN_DPAD_RIGHT);
    out[PAD_CROSS_Y] = -read_cross(model, state, ABS_HAT0Y, BTN_DPAD_UP, BTN_DPAD_DOWN);
    for (uint32_t i = 0; i < sizeof button / sizeof *button; ++i)
        out[button[i][0]] = key_of(state, button[i][1]);
    /* On these pads X is the west button and Y the north one. Linux assigns the codes by letter,
     * and there BTN_X means north and BTN_Y west. */
    const bool is_lettered = model->vendor == microsoft;
    out[PAD_WEST] = key_of(state, is_lettered ? BTN_X : BTN_WEST);
    out[PAD_NORTH] = key_of(state, is_lettered ? BTN_Y : BTN_NORTH);
    /* The buttons of a joystick are numbered starting at the trigger. */
    for (uint16_t i = 0; is_joystick && i < PAD_CHANNELS - PAD_BUTTONS; ++i)
        out[PAD_BUTTONS + i] = key_of(state, (uint16_t)(BTN_TRIGGER + i));
}
