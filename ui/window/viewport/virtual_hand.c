#include "window/viewport/virtual_hand.h"

#include "hand/sensor.h"
#include "stage/input/feed.h"
#include "stage/mapping/isolate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t virtual_hand_key_code[VIRTUAL_KEYS] = {
    [VIRTUAL_THUMB_DOWN] = ' ',
    [VIRTUAL_THUMB_UP] = 'B',
    [VIRTUAL_INDEX_DOWN] = 'J',
    [VIRTUAL_MIDDLE_DOWN] = 'K',
    [VIRTUAL_RING_DOWN] = 'L',
    [VIRTUAL_LITTLE_DOWN] = ';',
    [VIRTUAL_INDEX_UP] = 'U',
    [VIRTUAL_MIDDLE_UP] = 'I',
    [VIRTUAL_RING_UP] = 'O',
    [VIRTUAL_LITTLE_UP] = 'P',
    [VIRTUAL_SPREAD] = 'N',
    [VIRTUAL_NARROW] = 'M',
    [VIRTUAL_WRIST_UP] = UI_KEY_UP,
    [VIRTUAL_WRIST_DOWN] = UI_KEY_DOWN,
    [VIRTUAL_WRIST_LEFT] = UI_KEY_LEFT,
    [VIRTUAL_WRIST_RIGHT] = UI_KEY_RIGHT,
};

enum { PAD_LEFT_X, PAD_LEFT_Y, PAD_RIGHT_X, PAD_RIGHT_Y, PAD_LEFT_TRIGGER, PAD_RIGHT_TRIGGER };
enum { PAD_LEFT_BUMPER = 4, PAD_RIGHT_BUMPER = 5 };
static const float dead_zone = 0.14f;

static void add(float *intent, float more)
{
    *intent = fminf(fmaxf(*intent + more, -1.0f), 1.0f);
}

static float between(const bool is_down[VIRTUAL_KEYS], virtual_hand_key more, virtual_hand_key less)
{
    return (is_down[more] ? 1.0f : 0.0f) - (is_down[less] ? 1.0f : 0.0f);
}

void virtual_hand_add_keys(virtual_hand_intent *intent, const bool is_down[VIRTUAL_KEYS])
{
    add(&intent->finger[0], between(is_down, VIRTUAL_THUMB_DOWN, VIRTUAL_THUMB_UP));
    for (int finger = 0; finger < 4; ++finger)
        add(&intent->finger[1 + finger],
            between(is_down, (virtual_hand_key)(VIRTUAL_INDEX_DOWN + finger),
                    (virtual_hand_key)(VIRTUAL_INDEX_UP + finger)));
    add(&intent->spread, between(is_down, VIRTUAL_SPREAD, VIRTUAL_NARROW));
    add(&intent->pitch, between(is_down, VIRTUAL_WRIST_DOWN, VIRTUAL_WRIST_UP));
    add(&intent->yaw, between(is_down, VIRTUAL_WRIST_RIGHT, VIRTUAL_WRIST_LEFT));
}

/* Returns -1..1 with a dead zone in the middle, because worn sticks do not centre. */
static float stick(const window_gamepad *pad, int axis)
{
    float value = pad->axis[axis];
    if (!(fabsf(value) > dead_zone))
        return 0.0f;
    return copysignf(fminf((fabsf(value) - dead_zone) / (1.0f - dead_zone), 1.0f), value);
}

/* Returns 0..1. */
static float trigger(const window_gamepad *pad, int axis)
{
    float value = 0.5f * (pad->axis[axis] + 1.0f);
    return value > dead_zone ? fminf((value - dead_zone) / (1.0f - dead_zone), 1.0f) : 0.0f;
}

void virtual_hand_add_pad(virtual_hand_intent *intent, const window_gamepad *pad)
{
    add(&intent->finger[0], trigger(pad, PAD_RIGHT_TRIGGER));
    add(&intent->finger[3], -trigger(pad, PAD_LEFT_TRIGGER));
    add(&intent->finger[4], -trigger(pad, PAD_LEFT_TRIGGER));
    float up = -stick(pad, PAD_LEFT_Y);
    add(&intent->finger[1], -up);
    add(&intent->finger[2], -0.6f * up);
    if (pad->button[PAD_LEFT_BUMPER] || pad->button[PAD_RIGHT_BUMPER])
        add(&intent->finger[2], 1.0f);
    add(&intent->spread, stick(pad, PAD_LEFT_X));
    add(&intent->pitch, stick(pad, PAD_RIGHT_Y));
    add(&intent->yaw, stick(pad, PAD_RIGHT_X));
    for (int pedal = 0; pedal < MRT_MAX_PEDALS; ++pedal)
        intent->pedal[pedal] = intent->pedal[pedal] || pad->button[pedal];
}

bool virtual_hand_pad_is_used(const window_gamepad *pad)
{
    for (int axis = PAD_LEFT_X; axis <= PAD_RIGHT_Y; ++axis)
        if (stick(pad, axis) != 0.0f)
            return true;
    for (int button = 0; button <= PAD_RIGHT_BUMPER; ++button)
        if (pad->button[button])
            return true;
    return trigger(pad, PAD_LEFT_TRIGGER) > 0.0f || trigger(pad, PAD_RIGHT_TRIGGER) > 0.0f;
}

/* Angle of a joint from rest with the finger fully down and fully up, rad. */
typedef struct way {
    int sensor;
    float down_rad, up_rad;
} way;
static const way thumb_ways[] = {{SENSOR_THUMB_ROLL, 0.06f, -0.04f},
                                 {SENSOR_THUMB_MPJ, -0.45f, 0.30f},
                                 {SENSOR_THUMB_IJ, -0.25f, 0.45f},
                                 {SENSOR_THUMB_ABDUCTION, 0.24f, -0.12f}};
static const way finger_ways[] = {{0, 0.75f, -0.52f}, {1, 0.55f, -0.22f}, {2, 0.30f, -0.05f}};
static const int finger_first[4] = {SENSOR_INDEX_MPJ, SENSOR_MIDDLE_MPJ, SENSOR_RING_MPJ,
                                    SENSOR_LITTLE_MPJ};
static const way spread_ways[] = {{SENSOR_MIDDLE_INDEX_SPREAD, 0.15f, -0.06f},
                                  {SENSOR_RING_MIDDLE_SPREAD, 0.13f, -0.06f},
                                  {SENSOR_LITTLE_RING_SPREAD, 0.20f, -0.08f}};
static const way pitch_way = {SENSOR_WRIST_PITCH, 0.55f, -0.50f};
static const float yaw_rad = 0.35f;

static void bend(float *angle_rad, const way *w, int first, float intent)
{
    angle_rad[first + w->sensor] += intent > 0.0f ? intent * w->down_rad : -intent * w->up_rad;
}

void virtual_hand_rest(float out_rad[MRT_ANGLES])
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        out_rad[i] = sensor_table[i].neutral_rad;
}

void virtual_hand_goal(float out_rad[MRT_ANGLES], const virtual_hand_intent *intent,
                       float to_radial)
{
    virtual_hand_rest(out_rad);
    for (size_t i = 0; i < sizeof thumb_ways / sizeof *thumb_ways; ++i)
        bend(out_rad, &thumb_ways[i], 0, intent->finger[0]);
    for (int finger = 0; finger < 4; ++finger)
        for (size_t i = 0; i < sizeof finger_ways / sizeof *finger_ways; ++i)
            bend(out_rad, &finger_ways[i], finger_first[finger], intent->finger[1 + finger]);
    for (size_t i = 0; i < sizeof spread_ways / sizeof *spread_ways; ++i)
        bend(out_rad, &spread_ways[i], 0, intent->spread);
    bend(out_rad, &pitch_way, 0, intent->pitch);
    out_rad[SENSOR_WRIST_YAW] += intent->yaw * to_radial * yaw_rad;
}

/* ---- easing ---- */

static const double bend_s = 0.080, lift_s = 0.120;
static const float still_rad = 0.002f, still_rad_s = 0.02f;

void virtual_hand_motion_begin(virtual_hand_motion *out)
{
    *out = (virtual_hand_motion){{0}, {0}};
    virtual_hand_rest(out->angle_rad);
}

/* Solves a critically damped spring exactly: x = (a + (v + w a) t) e^(-w t). It covers 63 % of the
 * distance after 2.146 / w. */
static void ease(float *angle_rad, float *speed_rad_s, float goal_rad, double dt_s)
{
    bool is_bending = goal_rad > *angle_rad;
    double w = 2.146 / (is_bending ? bend_s : lift_s);
    double away = (double)*angle_rad - (double)goal_rad, speed = (double)*speed_rad_s;
    double drive = speed + w * away, left = exp(-w * dt_s);
    *angle_rad = (float)((double)goal_rad + (away + drive * dt_s) * left);
    *speed_rad_s = (float)((speed - w * drive * dt_s) * left);
}

void virtual_hand_motion_step(virtual_hand_motion *self, const float goal_rad[MRT_ANGLES],
                              double dt_s)
{
    if (!(dt_s > 0.0))
        return;
    for (int i = 0; i < MRT_ANGLES; ++i)
        ease(&self->angle_rad[i], &self->speed_rad_s[i], goal_rad[i], dt_s);
}

bool virtual_hand_motion_is_still(const virtual_hand_motion *self, const float goal_rad[MRT_ANGLES])
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (fabsf(self->angle_rad[i] - goal_rad[i]) > still_rad ||
            fabsf(self->speed_rad_s[i]) > still_rad_s)
            return false;
    return true;
}

/* ---- an input of the stage ---- */

enum { CHANNELS = MRT_ANGLES + MRT_MAX_PEDALS };
static const double rate_hz = 125.0;
static const double attach_s = 0.5; /* mappings use the first samples as the rest of the hand */
static const double settle_s = 1.0; /* later filters need more samples to settle */
static const char side_key[] = "virtual_hand.side";
static const char *const feed_id[2] = {"org.marotte.virtual_left", "org.marotte.virtual_right"};
static const char *const input_text[2] = {"virtual left hand", "virtual right hand"};
static const char *const feed_name[2] = {"Virtual left hand", "Virtual right hand"};

struct virtual_hand {
    app *of;
    uint32_t side;
    feed *feed[2];   /* NULL: not used yet */
    input *made[2];  /* owned by live; only compared */
    bool is_refused; /* joining failed; retried when one of the next two fields changes */
    bool was_recording;
    uint32_t input_count;
    double joined_s; /* time since it joined the stage */
    double still_s;  /* time at rest without input */
    bool has_keys, gave;
    virtual_hand_intent intent;
    virtual_hand_motion motion;
};

virtual_hand *virtual_hand_create(app *of)
{
    virtual_hand *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of = of;
    double side = settings_number(app_settings(of), side_key, MRT_RIGHT);
    self->side = (uint32_t)(side < 0.5 ? MRT_LEFT : MRT_RIGHT);
    virtual_hand_motion_begin(&self->motion);
    return self;
}

/* Returns the index of this side's input on the stage, or UINT32_MAX. */
static uint32_t index_of(const virtual_hand *self, uint32_t side)
{
    live *stage = app_live(self->of);
    for (uint32_t i = 0; stage && self->made[side] && i < live_input_count(stage); ++i)
        if (live_input(stage, i) == self->made[side])
            return i;
    return UINT32_MAX;
}

/* Removes the input of a side. If this fails because a take is being recorded, ends the take first.
 */
static void leave(virtual_hand *self, uint32_t side)
{
    live *stage = app_live(self->of);
    uint32_t index = index_of(self, side);
    if (index == UINT32_MAX)
        return;
    error err = {{0}};
    if (live_remove_input(stage, index, &err) >= 0)
        return;
    if (live_record_end(stage, &err) < 0 || live_remove_input(stage, index, &err) < 0) {
        news_list_add(app_news(self->of), MRT_LOG_WARNING, feed_name[side], err.text);
        self->feed[side] = NULL; /* the input is still in use and needs the feed */
    }
}

void virtual_hand_destroy(virtual_hand *self)
{
    if (!self)
        return;
    for (uint32_t side = 0; side < 2; ++side) {
        leave(self, side);
        feed_destroy(self->feed[side]);
    }
    free(self);
}

static mrt_result create_feed(virtual_hand *self, uint32_t side, error *err)
{
    mrt_channel channels[CHANNELS];
    static const char *const pedal_name[MRT_MAX_PEDALS] = {"pedal 1", "pedal 2", "pedal 3",
                                                           "pedal 4"};
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        channels[i] =
            (mrt_channel){sensor_table[i].label, "rad", MRT_CH_ANGLE + i, side, -3.1416f, 3.1416f};
    for (uint32_t i = 0; i < MRT_MAX_PEDALS; ++i)
        channels[MRT_ANGLES + i] =
            (mrt_channel){pedal_name[i], "", MRT_CH_PEDAL + i, MRT_NO_HAND, 0.0f, 1.0f};
    const feed_settings wanted = {.id = feed_id[side],
                                  .name = feed_name[side],
                                  .channels = channels,
                                  .channel_count = CHANNELS,
                                  .rate_hz = rate_hz};
    return feed_create(&self->feed[side], &wanted, err);
}

static void give(virtual_hand *self, uint32_t side, feed_activity activity)
{
    float value[CHANNELS];
    memcpy(value, self->motion.angle_rad, sizeof self->motion.angle_rad);
    for (int i = 0; i < MRT_MAX_PEDALS; ++i)
        value[MRT_ANGLES + i] = self->intent.pedal[i] ? 1.0f : 0.0f;
    feed_push(self->feed[side], value, activity);
    self->gave = activity == FEED_MOVES;
}

static mrt_result join(virtual_hand *self, uint32_t side, error *err)
{
    mrt_result result = self->feed[side] ? MRT_OK : create_feed(self, side, err);
    if (result < 0)
        return result;
    input *made = NULL;
    result = input_create(&made, feed_type(self->feed[side]), "", "", CLOCK_REAL, app_log(self->of),
                          err);
    if (result < 0)
        return result;
    virtual_hand_motion_begin(&self->motion);
    give(self, side, FEED_MOVES); /* starts at rest, before any reader */
    result = live_add_input(app_live(self->of), made, input_text[side], err);
    if (result < 0)
        return result; /* the stage has destroyed it */
    self->made[side] = made;
    self->joined_s = 0.0;
    self->is_refused = false;
    return MRT_OK;
}

/* Returns whether the hand may try to join. After a refusal it waits until a recording starts or
 * ends or the inputs change, because a running take or too many inputs can be the reason. */
static bool may_join(const virtual_hand *self)
{
    return !self->is_refused || self->was_recording != app_status(self->of)->is_recording ||
           self->input_count != live_input_count(app_live(self->of));
}

static bool has_joined(virtual_hand *self)
{
    if (!app_live(self->of))
        return false;
    if (index_of(self, self->side) != UINT32_MAX)
        return true;
    error err = {{0}};
    self->made[self->side] = NULL;
    if (!may_join(self))
        return false;
    if (join(self, self->side, &err) >= 0)
        return true;
    news_list_add(app_news(self->of), MRT_LOG_ERROR, feed_name[self->side], err.text);
    self->is_refused = true;
    self->was_recording = app_status(self->of)->is_recording;
    self->input_count = live_input_count(app_live(self->of));
    return false;
}

static void change_side(virtual_hand *self)
{
    if (index_of(self, self->side) != UINT32_MAX) {
        memset(&self->intent, 0, sizeof self->intent);
        virtual_hand_motion_begin(&self->motion);
        give(self, self->side, FEED_RESTS);
    }
    self->side = 1 - self->side;
    self->is_refused = false;
    settings_set_number(app_settings(self->of), side_key, self->side);
    char text[64];
    snprintf(text, sizeof text, "The keyboard and the gamepad now control the %s hand",
             self->side == MRT_LEFT ? "left" : "right");
    news_list_add(app_news(self->of), MRT_LOG_INFO, "virtual hand", text);
}

static void read_intent(virtual_hand *self, const ui *keys, const window_gamepad *pad)
{
    memset(&self->intent, 0, sizeof self->intent);
    if (self->has_keys && !(ui_modifiers(keys) & (UI_CONTROL | UI_ALT))) {
        bool is_down[VIRTUAL_KEYS];
        for (int i = 0; i < VIRTUAL_KEYS; ++i)
            is_down[i] = ui_is_down(keys, virtual_hand_key_code[i]);
        virtual_hand_add_keys(&self->intent, is_down);
    }
    if (pad)
        virtual_hand_add_pad(&self->intent, pad);
}

/* Returns to_radial. Right in the picture is the subject's left (+x), where a right hand has its
 * thumb. A mirrored view reverses this. */
static float to_radial_of(const virtual_hand *self)
{
    bool is_radial = (self->side == MRT_RIGHT) != app_looks_of(self->of)->is_mirrored;
    return is_radial ? 1.0f : -1.0f;
}

void virtual_hand_update(virtual_hand *self, const ui *keys, const window_gamepad *pad, double dt_s)
{
    if (ui_pressed(keys, 'Y', UI_SHIFT))
        change_side(self);
    self->has_keys = app_has_hand_keys(self->of);
    bool is_used = self->has_keys || (pad && virtual_hand_pad_is_used(pad));
    if (pad || is_used || self->gave) /* a gamepad sends no events */
        app_want_frame(self->of, 0.0);
    if (!is_used && !self->gave)
        return;
    if (!has_joined(self)) {
        self->gave = false;
        return;
    }
    read_intent(self, keys, pad);
    float goal[MRT_ANGLES];
    virtual_hand_goal(goal, &self->intent, to_radial_of(self));
    self->joined_s += dt_s;
    if (self->joined_s >= attach_s)
        virtual_hand_motion_step(&self->motion, goal, dt_s);
    bool is_still =
        !is_used && self->joined_s >= attach_s && virtual_hand_motion_is_still(&self->motion, goal);
    self->still_s = is_still ? self->still_s + dt_s : 0.0;
    give(self, self->side, self->still_s >= settle_s ? FEED_RESTS : FEED_MOVES);
}

bool virtual_hand_has_key(uint32_t key)
{
    for (int i = 0; i < VIRTUAL_KEYS; ++i)
        if (virtual_hand_key_code[i] == key)
            return true;
    return false;
}

/* ---- display of the keys: a strip above the picture ---- */

enum { CAPS = 4, EFFECT = 96, MAPPING_VALUES = 256 };
typedef struct key_cell {
    const char *name;
    const char *cap[CAPS]; /* NULL: fewer */
    int key[CAPS];         /* virtual_hand_key of the cap; -1: another key */
} key_cell;
static const key_cell cells[] = {
    {"Thumb", {"Space", "B"}, {VIRTUAL_THUMB_DOWN, VIRTUAL_THUMB_UP}},
    {"Index", {"J", "U"}, {VIRTUAL_INDEX_DOWN, VIRTUAL_INDEX_UP}},
    {"Middle", {"K", "I"}, {VIRTUAL_MIDDLE_DOWN, VIRTUAL_MIDDLE_UP}},
    {"Ring", {"L", "O"}, {VIRTUAL_RING_DOWN, VIRTUAL_RING_UP}},
    {"Little", {";", "P"}, {VIRTUAL_LITTLE_DOWN, VIRTUAL_LITTLE_UP}},
    {"Spread", {"N", "M"}, {VIRTUAL_SPREAD, VIRTUAL_NARROW}},
    {"Wrist",
     {"\u2191", "\u2193", "\u2190", "\u2192"},
     {VIRTUAL_WRIST_UP, VIRTUAL_WRIST_DOWN, VIRTUAL_WRIST_LEFT, VIRTUAL_WRIST_RIGHT}},
    {"Other hand", {"Shift+Y"}, {-1}},
    {"End", {"Esc"}, {-1}}};
enum { CELLS = sizeof cells / sizeof *cells };
static const float cell_gap = 14.0f, cap_gap = 4.0f;
static const float strip_most = 0.3f; /* share of the height; above it the effects are left out */

/* ---- what a key moves in the face ---- */

/* Strength of a line for a change of the angles. A movement against the line counts less, because
 * another line usually names it. */
static float strength_of(const mrt_card_line *line, const float change_rad[MRT_ANGLES])
{
    static const float backwards = 0.35f;
    float sum = 0.0f;
    for (int i = 0; i < MRT_ANGLES; ++i)
        sum += line->per_rad[i] * change_rad[i];
    return sum < 0.0f ? -backwards * sum : sum;
}

/* Returns the line that a key moves most. NULL: none. */
static const mrt_card_line *line_of_key(const mrt_card_line *line, uint32_t count, int key)
{
    bool is_down[VIRTUAL_KEYS] = {false};
    float change[MRT_ANGLES], rest[MRT_ANGLES], most = 0.2f;
    virtual_hand_intent intent = {.spread = 0.0f};
    const mrt_card_line *found = NULL;
    is_down[key] = true;
    virtual_hand_add_keys(&intent, is_down);
    virtual_hand_goal(change, &intent, 1.0f);
    virtual_hand_rest(rest);
    for (int i = 0; i < MRT_ANGLES; ++i)
        change[i] -= rest[i];
    for (uint32_t i = 0; i < count; ++i)
        if (strength_of(&line[i], change) > most) {
            most = strength_of(&line[i], change);
            found = &line[i];
        }
    return found;
}

/* Returns the lines of the mapping that performs. NULL: it does not describe what it does. */
static const mrt_card_line *lines_of(const virtual_hand *self, uint32_t *out_count)
{
    live *stage = app_live(self->of);
    const instance *mapping = stage ? live_mapping(stage) : NULL;
    const mrt_hand_card *card =
        mapping ? plugin_interface(isolate_inner(mapping->type), MRT_HAND_CARD) : NULL;
    double value[MAPPING_VALUES];
    mrt_channels channels = {.name = input_text[self->side]};
    *out_count = 0;
    if (!card || mapping->type->param_count > MAPPING_VALUES)
        return NULL;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        value[i] = instance_value(mapping, i);
    const input *made = self->made[self->side];
    if (made)
        channels.channel = input_channels(made, &channels.count);
    return card->lines(value, made ? &channels : NULL, self->side, out_count);
}

/* The first part of a text, "jaw opens": up to a bracket or a semicolon. */
static int length_of(const char *text)
{
    size_t length = strcspn(text, ";(");
    while (length > 0 && text[length - 1] == ' ')
        length -= 1;
    return (int)length;
}

/* Writes what the first two keys of a cell move; "": unknown. */
static void write_effect(char out[EFFECT], const mrt_card_line *line, uint32_t count,
                         const key_cell *cell)
{
    const mrt_card_line *first = NULL, *second = NULL;
    out[0] = '\0';
    if (cell->key[0] >= 0)
        first = line_of_key(line, count, cell->key[0]);
    if (cell->key[0] >= 0 && cell->cap[1])
        second = line_of_key(line, count, cell->key[1]);
    if (!first || second == first)
        first = first ? first : second, second = NULL;
    if (first)
        (void)snprintf(out, EFFECT, "%.*s%s%.*s", length_of(first->face), first->face,
                       second ? "; " : "", second ? length_of(second->face) : 0,
                       second ? second->face : "");
}

/* ---- layout: cells flow in rows ---- */

typedef struct key_strip {
    float x[CELLS], y[CELLS], height; /* from the top left of the strip */
    char effect[CELLS][EFFECT];
} key_strip;

static float line_height(const ui *on)
{
    return ui_text_height(on, UI_STYLE_BODY) + 4.0f;
}

static float cap_width(const ui *on, const char *key)
{
    return fmaxf(ui_text_width(on, UI_STYLE_BODY, key) + 12.0f, 24.0f);
}

static float cell_width(const ui *on, const key_strip *strip, int index)
{
    const key_cell *cell = &cells[index];
    const char *effect = strip->effect[index];
    const float name = ui_text_width(on, UI_STYLE_BODY, cell->name);
    float width = -cap_gap;
    for (int i = 0; i < CAPS && cell->cap[i]; ++i)
        width += cap_gap + cap_width(on, cell->cap[i]);
    return effect[0]
               ? fmaxf(width + 2.0f * cap_gap + name, ui_text_width(on, UI_STYLE_BODY, effect))
               : fmaxf(width, name);
}

static void place_cells(key_strip *out, const ui *on, float width)
{
    const float high = 2.0f * line_height(on) + 8.0f;
    float x = cell_gap, y = 6.0f;
    for (int i = 0; i < CELLS; ++i) {
        const float wide = cell_width(on, out, i);
        if (x > cell_gap && x + wide + cell_gap > width) {
            x = cell_gap;
            y += high;
        }
        out->x[i] = x;
        out->y[i] = y;
        x += wide + cell_gap;
    }
    out->height = y + high;
}

static void strip_of(key_strip *out, const virtual_hand *self, const ui *on, float width,
                     float height)
{
    uint32_t count;
    const mrt_card_line *line = lines_of(self, &count);
    for (int i = 0; i < CELLS; ++i)
        write_effect(out->effect[i], line, count, &cells[i]);
    place_cells(out, on, width);
    if (out->height <= strip_most * height)
        return;
    for (int i = 0; i < CELLS; ++i)
        out->effect[i][0] = '\0';
    place_cells(out, on, width);
}

float virtual_hand_keys_height(const virtual_hand *self, const ui *on, float width, float height)
{
    key_strip strip;
    if (!self->has_keys)
        return 0.0f;
    strip_of(&strip, self, on, width, height);
    return strip.height;
}

/* ---- drawing ---- */

static void ink_cap(ui *on, float x, float y, const char *key, bool is_down)
{
    float width = cap_width(on, key), height = ui_text_height(on, UI_STYLE_BODY) + 4.0f;
    float words = ui_text_width(on, UI_STYLE_BODY, key);
    ui_draw_box(on, (ui_rectangle){x, y, width, height}, is_down ? THEME_ACCENT : THEME_RAISED,
                3.0f);
    ui_draw_text(on, x + 0.5f * (width - words), y + 2.0f, UI_STYLE_BODY,
                 is_down ? THEME_STAGE : THEME_TEXT, 0.0f, key);
}

/* Whether a key is down, or the gamepad does the same. */
static bool is_lit(const virtual_hand *self, const ui *on, int key)
{
    if (key < 0)
        return false;
    if (key == VIRTUAL_THUMB_DOWN || key == VIRTUAL_THUMB_UP)
        return self->intent.finger[0] * (key == VIRTUAL_THUMB_DOWN ? 1.0f : -1.0f) > 0.1f;
    if (key >= VIRTUAL_INDEX_DOWN && key <= VIRTUAL_LITTLE_DOWN)
        return self->intent.finger[1 + key - VIRTUAL_INDEX_DOWN] > 0.1f;
    if (key >= VIRTUAL_INDEX_UP && key <= VIRTUAL_LITTLE_UP)
        return self->intent.finger[1 + key - VIRTUAL_INDEX_UP] < -0.1f;
    return ui_is_down(on, virtual_hand_key_code[key]);
}

void virtual_hand_draw_keys(const virtual_hand *self, ui *on, ui_rectangle where, float height)
{
    const float line = line_height(on);
    key_strip strip;
    strip_of(&strip, self, on, where.width, height);
    for (int i = 0; i < CELLS; ++i) {
        const key_cell *cell = &cells[i];
        const char *effect = strip.effect[i];
        float x = where.x + strip.x[i];
        const float y = where.y + strip.y[i];
        ui_draw_text(on, x, y, UI_STYLE_BODY, effect[0] ? THEME_TEXT : THEME_DIM, 0.0f,
                     effect[0] ? effect : cell->name);
        for (int k = 0; k < CAPS && cell->cap[k]; ++k) {
            ink_cap(on, x, y + line, cell->cap[k], is_lit(self, on, cell->key[k]));
            x += cap_width(on, cell->cap[k]) + cap_gap;
        }
        if (effect[0])
            ui_draw_text(on, x + cap_gap, y + line + 2.0f, UI_STYLE_BODY, THEME_DIM, 0.0f,
                         cell->name);
    }
}
