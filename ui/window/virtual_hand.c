#include "window/virtual_hand.h"
#include "hand/sensor.h"
#include "stage/feed.h"
#include "window/virtual_hand_motion.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHANNELS = MRT_ANGLES + MRT_MAX_PEDALS };
static const double rate_hz = 125.0;
static const double attach_s = 0.5; /* mappings take the first samples as the hand's neutral pose */
static const double settle_s = 1.0; /* filters and eases behind it come to rest with samples only */
static const char side_key[] = "virtual_hand.side";
static const char *const feed_id[2] = {"org.marotte.virtual_left", "org.marotte.virtual_right"};
static const char *const input_text[2] = {"virtual left hand", "virtual right hand"};
static const char *const feed_name[2] = {"Virtual left hand", "Virtual right hand"};

struct virtual_hand {
    studio *of;
    uint32_t side;
    feed *feed[2];   /* NULL: not used yet */
    input *made[2];  /* live's; only to be compared */
    bool is_refused; /* it could not join, which was said; the stage was like that: */
    bool was_recording;
    uint32_t input_count;
    double joined_s; /* since it joined the stage */
    double still_s;  /* since it is at rest and nobody moves it */
    bool has_keys, gave;
    virtual_hand_wish wish;
    virtual_hand_motion motion;
};

virtual_hand *virtual_hand_create(studio *of)
{
    virtual_hand *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of = of;
    double side = settings_number(studio_settings(of), side_key, MRT_RIGHT);
    self->side = (uint32_t)(side < 0.5 ? MRT_LEFT : MRT_RIGHT);
    virtual_hand_motion_begin(&self->motion);
    return self;
}

/* Where the input of this side is among the stage's; UINT32_MAX: it is not there (any more). */
static uint32_t index_of(const virtual_hand *self, uint32_t side)
{
    live *stage = studio_live(self->of);
    for (uint32_t i = 0; stage && self->made[side] && i < live_input_count(stage); ++i)
        if (live_input(stage, i) == self->made[side])
            return i;
    return UINT32_MAX;
}

/* An input cannot leave while a take is recorded. */
static void leave(virtual_hand *self, uint32_t side)
{
    live *stage = studio_live(self->of);
    uint32_t index = index_of(self, side);
    if (index == UINT32_MAX)
        return;
    error err = {{0}};
    if (live_remove_input(stage, index, &err) >= 0)
        return;
    if (live_record_end(stage, &err) < 0 || live_remove_input(stage, index, &err) < 0) {
        news_list_add(studio_news(self->of), MRT_LOG_WARNING, feed_name[side], err.text);
        self->feed[side] = NULL; /* whoever still has the input needs it */
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
        value[MRT_ANGLES + i] = self->wish.pedal[i] ? 1.0f : 0.0f;
    feed_give(self->feed[side], value, activity);
    self->gave = activity == FEED_MOVES;
}

static mrt_result join(virtual_hand *self, uint32_t side, error *err)
{
    mrt_result result = self->feed[side] ? MRT_OK : create_feed(self, side, err);
    if (result < 0)
        return result;
    input *made = NULL;
    result = input_create(&made, feed_type(self->feed[side]), "", "", CLOCK_REAL,
                          studio_log(self->of), err);
    if (result < 0)
        return result;
    virtual_hand_motion_begin(&self->motion);
    give(self, side, FEED_MOVES); /* before anybody reads it: a hand at rest */
    result = live_add_input(studio_live(self->of), made, input_text[side], err);
    if (result < 0)
        return result; /* the stage has destroyed it */
    self->made[side] = made;
    self->joined_s = 0.0;
    self->is_refused = false;
    return MRT_OK;
}

/* What it was refused for may be over: a take, too many inputs. */
static bool may_join(const virtual_hand *self)
{
    return !self->is_refused || self->was_recording != studio_status(self->of)->is_recording ||
           self->input_count != live_input_count(studio_live(self->of));
}

static bool has_joined(virtual_hand *self)
{
    if (!studio_live(self->of))
        return false;
    if (index_of(self, self->side) != UINT32_MAX)
        return true;
    error err = {{0}};
    self->made[self->side] = NULL;
    if (!may_join(self))
        return false;
    if (join(self, self->side, &err) >= 0)
        return true;
    news_list_add(studio_news(self->of), MRT_LOG_ERROR, feed_name[self->side], err.text);
    self->is_refused = true;
    self->was_recording = studio_status(self->of)->is_recording;
    self->input_count = live_input_count(studio_live(self->of));
    return false;
}

static void change_side(virtual_hand *self)
{
    if (index_of(self, self->side) != UINT32_MAX) {
        memset(&self->wish, 0, sizeof self->wish);
        virtual_hand_motion_begin(&self->motion);
        give(self, self->side, FEED_RESTS);
    }
    self->side = 1 - self->side;
    self->is_refused = false;
    settings_set_number(studio_settings(self->of), side_key, self->side);
    char text[64];
    snprintf(text, sizeof text, "The keyboard and the gamepad are the %s hand now",
             self->side == MRT_LEFT ? "left" : "right");
    news_list_add(studio_news(self->of), MRT_LOG_INFO, "virtual hand", text);
}

static void read_wish(virtual_hand *self, const ui *keys, const front_gamepad *pad)
{
    memset(&self->wish, 0, sizeof self->wish);
    if (self->has_keys && !(ui_modifiers(keys) & (UI_CONTROL | UI_ALT))) {
        bool is_down[VIRTUAL_KEYS];
        for (int i = 0; i < VIRTUAL_KEYS; ++i)
            is_down[i] = ui_is_down(keys, virtual_hand_key_code[i]);
        virtual_hand_wish_keys(&self->wish, is_down);
    }
    if (pad)
        virtual_hand_wish_pad(&self->wish, pad);
}

/* To the right in the picture is the subject's left (+x), where a right hand has its thumb; a
 * mirror changes that. */
static float to_radial_of(const virtual_hand *self)
{
    bool is_radial = (self->side == MRT_RIGHT) != studio_looks_of(self->of)->is_mirrored;
    return is_radial ? 1.0f : -1.0f;
}

void virtual_hand_update(virtual_hand *self, const ui *keys, const front_gamepad *pad, double dt_s)
{
    if (ui_pressed(keys, 'Y', UI_SHIFT))
        change_side(self);
    self->has_keys = studio_has_hand_keys(self->of);
    bool is_used = self->has_keys || (pad && virtual_hand_pad_is_used(pad));
    if (!is_used && !self->gave)
        return;
    if (!has_joined(self)) {
        self->gave = false;
        return;
    }
    read_wish(self, keys, pad);
    float goal[MRT_ANGLES];
    virtual_hand_goal(goal, &self->wish, to_radial_of(self));
    self->joined_s += dt_s;
    if (self->joined_s >= attach_s)
        virtual_hand_motion_step(&self->motion, goal, dt_s);
    bool is_still =
        !is_used && self->joined_s >= attach_s && virtual_hand_motion_is_still(&self->motion, goal);
    self->still_s = is_still ? self->still_s + dt_s : 0.0;
    give(self, self->side, self->still_s >= settle_s ? FEED_RESTS : FEED_MOVES);
}

bool virtual_hand_has_keys(const virtual_hand *self)
{
    return self->has_keys;
}

uint32_t virtual_hand_side(const virtual_hand *self)
{
    return self->side;
}

const float *virtual_hand_fingers(const virtual_hand *self)
{
    return self->wish.finger;
}
