/* One hand performs a face: joint angles move its jaw, brows, lids, mouth and head, by the names of
 * the rig's contacts and degrees of freedom. A vector's start is the contact's rest; end = start
 * says that the contact only rides along with the bones that carry it. */
#include "attach.h"
#include "blink.h"
#include "curve.h"
#include "fitting.h"
#include "maps.h"
#include "memory.h"
#include "pedals.h"
#include "stored.h"

#include <stdlib.h>
#include <string.h>

static const double dt_max_s = 0.1;

typedef struct anchor { /* what an anchor replaces, for the second tap */
    bool is_known;
    uint32_t side;
    reading neutral;
    pose offset;
} anchor;

struct mrt_plugin {
    const mrt_host *host;
    fitting fitting;
    neutral stored[2];  /* loaded */
    bool is_stored_new; /* loaded since the last frame */

    /* ---- since reset ---- */
    bool has_performed, has_told_no_neutral;
    bool wanted_stored; /* in the frame before */
    uint32_t side;      /* of the hand that performs */
    neutral neutral[2];
    uint32_t sample_count[2]; /* of a neutral pose that is not known yet */
    anchor before;
    pedals pedals;
    blink blink;
    attach attach;
    int mode, layer; /* of the frame before */
    int layer_shift; /* by locks */
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

/* ---- whose hand, and what is neutral for it ---- */

/* MRT_NO_HAND: none that is wanted and makes sense. */
static uint32_t take_reading(reading *out, const mrt_frame *frame)
{
    static const uint32_t wanted[][2] = {[HAND_EITHER] = {MRT_RIGHT, MRT_LEFT},
                                         [HAND_LEFT] = {MRT_LEFT, MRT_LEFT},
                                         [HAND_RIGHT] = {MRT_RIGHT, MRT_RIGHT}};
    const uint32_t *sides = wanted[(int)frame->params[SET_HAND]];
    for (int i = 0; i < 2; ++i) {
        const mrt_hand *hand = &frame->hand[sides[i]];
        if (hand->present && reading_take(out, hand, sides[i]))
            return sides[i];
    }
    return MRT_NO_HAND;
}

static void change_hand(mrt_plugin *self, uint32_t side, const double *params)
{
    self->side = side;
    self->has_performed = true;
    self->pedals.can_revert = false;
    blink_forget_hand(&self->blink);
    attach_change(&self->attach, params[SET_REATTACH]);
}

static void set_neutral(mrt_plugin *self, const reading *as)
{
    self->neutral[self->side] = (neutral){true, *as};
    self->blink.droop = 0.0;
}

/* The stored pose, or the mean of the first samples; until it is known the face rests. */
static void find_neutral(mrt_plugin *self, const reading *now, const double *params)
{
    neutral *own = &self->neutral[self->side];
    const neutral *stored = &self->stored[self->side];
    bool wants_stored = (int)params[SET_NEUTRAL_FROM] == NEUTRAL_STORED;
    if (wants_stored && stored->is_known &&
        (!own->is_known || self->is_stored_new || !self->wanted_stored)) {
        set_neutral(self, &stored->pose);
        attach_forget(&self->attach, params[SET_REATTACH]);
    }
    self->is_stored_new = false;
    self->wanted_stored = wants_stored;
    if (own->is_known)
        return;
    if (wants_stored && !self->has_told_no_neutral) {
        self->has_told_no_neutral = true;
        self->host->log(self->host, MRT_LOG_WARNING,
                        "no neutral pose is stored for this hand: takes the pose at engage");
    }
    uint32_t *count = &self->sample_count[self->side];
    *count += 1;
    if (*count == 1)
        own->pose = *now;
    else
        reading_average(&own->pose, now, *count);
    if ((double)*count < params[SET_NEUTRAL_SAMPLES])
        return;
    set_neutral(self, &own->pose);
    attach_change(&self->attach, params[SET_REATTACH]);
}

/* ---- what the feet ask for ---- */

static void set_anchor(mrt_plugin *self, const reading *now, const double *params)
{
    const neutral *own = &self->neutral[self->side];
    self->before = (anchor){own->is_known, self->side, own->pose, self->attach.offset};
    attach_keep(&self->attach, 1.5 * params[SET_REACH], self->fitting.low, self->fitting.high);
    attach_change(&self->attach, params[SET_REATTACH]);
    set_neutral(self, now);
}

static void revert_anchor(mrt_plugin *self, const double *params)
{
    if (!self->before.is_known || self->before.side != self->side)
        return;
    self->neutral[self->side].pose = self->before.neutral;
    self->attach.offset = self->before.offset;
    self->before.is_known = false;
    attach_change(&self->attach, params[SET_REATTACH]);
}

static void ease_to_neutral(mrt_plugin *self, const reading *now, const double *params)
{
    self->before.is_known = false;
    set_neutral(self, now);
    attach_forget(&self->attach, params[SET_NEUTRAL_TIME]);
}

static void apply_events(mrt_plugin *self, const pedals_events *events, const reading *now,
                         const double *params)
{
    int mode = (int)params[SET_MODE], layer = (int)params[SET_LAYER];
    if (events->to_neutral)
        ease_to_neutral(self, now, params);
    else if (events->revert)
        revert_anchor(self, params);
    else if (events->anchor)
        set_anchor(self, now, params);
    if (mode != self->mode)
        attach_change(&self->attach, params[SET_REATTACH]);
    if (mode != self->mode || layer != self->layer)
        self->layer_shift = 0;
    self->mode = mode;
    self->layer = layer;
    if (events->lock_layer)
        self->layer_shift = (self->layer_shift + 1) % (mode == MODE_WALDO ? LAYER_COUNT : 2);
}

/* ---- the face that follows ---- */

enum { LAYER_ALL = -1 };

/* The layer that the hand moves as a waldo; LAYER_ALL: the whole face by the mode's map. */
static int live_layer(const mrt_plugin *self, const pedals_events *events, const double *params)
{
    int shift = self->layer_shift + events->other_layer;
    if (self->mode == MODE_WALDO)
        return (self->layer + shift) % LAYER_COUNT;
    return shift % 2 ? (int)params[SET_OTHER_LAYER] : LAYER_ALL;
}

static void find_holds(unsigned held_by[LAYER_COUNT], int live, const pedals_events *events,
                       bool is_present, const double *params)
{
    int region = (int)params[SET_HOLD_REGION] - 1; /* -1: the whole face */
    for (int layer = 0; layer < LAYER_COUNT; ++layer) {
        held_by[layer] = live == LAYER_ALL || live == layer ? 0 : HELD_BY_LAYER;
        if (events->hold && (region < 0 || region == layer))
            held_by[layer] |= HELD_BY_PEDAL;
        if (!is_present)
            held_by[layer] |= HELD_BY_ABSENCE;
    }
}

/* Lids in time. A frozen face does not blink on. */
static void step_lids(mrt_plugin *self, const reading *now, double droop, unsigned held_by,
                      double dt_s, const double *params)
{
    bool is_frozen = held_by & (HELD_BY_PEDAL | HELD_BY_ABSENCE);
    bool is_struck =
        blink_is_struck(&self->blink, now->value[READING_MIDDLE_KNUCKLE], dt_s, params);
    bool has_reason =
        params[SET_BLINK] > 0.5 || (is_struck && held_by == 0 && self->mode != MODE_MASK);
    if (is_frozen)
        return;
    if (has_reason)
        blink_start(&self->blink);
    blink_step(&self->blink, droop, dt_s, params);
}

static void find_target(const mrt_plugin *self, const reading *difference, int live,
                        double intensity, const double *params, pose *out)
{
    if (live != LAYER_ALL)
        maps_waldo(out, difference, live, params);
    else if (self->mode == MODE_MASK)
        maps_mask(out, difference, params);
    else
        maps_muppet(out, difference, intensity, self->blink.droop, params);
    if (self->side == MRT_LEFT)
        pose_mirror(out);
}

/* Where the hand wants the face, the lids having moved on. */
static void follow(mrt_plugin *self, const reading *now, int live, unsigned lids_held_by,
                   double dt_s, const double *params, pose *out)
{
    const neutral *own = &self->neutral[self->side];
    reading difference = reading_difference(now, own->is_known ? &own->pose : now);
    double intensity = 0.01 * params[SET_INTENSITY] * self->pedals.intensity;
    step_lids(self, now, maps_droop(&difference, intensity, params), lids_held_by, dt_s, params);
    find_target(self, &difference, live, intensity, params, out);
}

/* ---- the mapping ---- */

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    if (!fitting_find(&self->fitting, face)) {
        self->host->log(
            self->host, MRT_LOG_ERROR,
            "the face has no contact and no degree of freedom that one hand could move "
            "(mouth.corner.l, jaw.open ...): take a face with a rig, see rigs/README.md");
        return MRT_ERR_UNSUPPORTED;
    }
    fitting_report(&self->fitting, self->host);
    return MRT_OK;
}

static void deactivate(mrt_plugin *self)
{
    (void)self;
}

static void reset(mrt_plugin *self)
{
    self->has_performed = self->has_told_no_neutral = false;
    self->side = MRT_NO_HAND;
    self->before.is_known = false;
    self->layer_shift = 0;
    for (int side = 0; side < 2; ++side) {
        self->neutral[side].is_known = false;
        self->sample_count[side] = 0;
    }
    pedals_reset(&self->pedals);
    blink_reset(&self->blink);
    attach_reset(&self->attach);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const double *params = frame->params;
    double dt_s = curve_clamp(frame->dt_s > 0.0 ? frame->dt_s : 0.0, 0.0, dt_max_s);
    reading now;
    uint32_t side = take_reading(&now, frame);
    bool is_present = side != MRT_NO_HAND;
    pedals_events events = pedals_step(&self->pedals, frame, dt_s);
    if (!is_present && !self->has_performed)
        return MRT_HOLD;
    pose target = {{0}};
    unsigned held_by[LAYER_COUNT];
    if (is_present) {
        if (side != self->side)
            change_hand(self, side, params);
        apply_events(self, &events, &now, params);
        find_neutral(self, &now, params);
    } else {
        blink_forget_hand(&self->blink);
        if (events.to_neutral)
            attach_forget(&self->attach, params[SET_NEUTRAL_TIME]);
    }
    int live = live_layer(self, &events, params);
    find_holds(held_by, live, &events, is_present, params);
    if (is_present)
        follow(self, &now, live, held_by[LAYER_BROWS], dt_s, params, &target);
    attach_step(&self->attach, &target, held_by, params[SET_REATTACH], dt_s);
    fitting_write(&self->fitting, &self->attach.shown, self->blink.closure, params, pull);
    return MRT_OK;
}

/* ---- the neutral pose, kept ---- */

static size_t save(mrt_plugin *self, void *out, size_t capacity)
{
    neutral hands[2];
    for (int side = 0; side < 2; ++side)
        hands[side] = self->neutral[side].is_known ? self->neutral[side] : self->stored[side];
    return stored_write(out, capacity, hands);
}

static mrt_result load(mrt_plugin *self, const void *bytes, size_t size)
{
    if (!stored_read(self->stored, bytes, size)) {
        self->host->log(self->host, MRT_LOG_ERROR,
                        "what was stored is no neutral pose of one_hand: store it again");
        return MRT_ERR_FORMAT;
    }
    self->is_stored_new = true;
    return MRT_OK;
}

/* ---- resume ---- */

enum { MEMORY_VERSION = 1, NEUTRAL_SAMPLES_MOST = 1000000 };

#define NEUTRAL_MEMORY(neutral) MEMORY_BOOLS((neutral).is_known), MEMORY_DOUBLES((neutral).pose)
#define ANCHOR_MEMORY(anchor)                                                                      \
    MEMORY_BOOLS((anchor).is_known), MEMORY_WHOLES((anchor).side, MRT_NO_HAND),                    \
        MEMORY_DOUBLES((anchor).neutral), MEMORY_DOUBLES((anchor).offset)

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.one_hand",
                         .version = MEMORY_VERSION,
                         .parts = {
                             NEUTRAL_MEMORY(self->stored[0]),
                             NEUTRAL_MEMORY(self->stored[1]),
                             MEMORY_BOOLS(self->is_stored_new),
                             MEMORY_BOOLS(self->has_performed),
                             MEMORY_BOOLS(self->has_told_no_neutral),
                             MEMORY_BOOLS(self->wanted_stored),
                             MEMORY_WHOLES(self->side, MRT_NO_HAND),
                             NEUTRAL_MEMORY(self->neutral[0]),
                             NEUTRAL_MEMORY(self->neutral[1]),
                             MEMORY_WHOLES(self->sample_count, NEUTRAL_SAMPLES_MOST),
                             ANCHOR_MEMORY(self->before),
                             PEDALS_MEMORY(self->pedals),
                             BLINK_MEMORY(self->blink),
                             ATTACH_MEMORY(self->attach),
                             MEMORY_WHOLES(self->mode, MODE_COUNT - 1),
                             MEMORY_WHOLES(self->layer, LAYER_COUNT - 1),
                             MEMORY_WHOLES(self->layer_shift, LAYER_COUNT - 1),
                         }};
}

static size_t remember(mrt_plugin *self, void *out, size_t capacity)
{
    const memory_list list = memory_of(self);
    return memory_save(&list, out, capacity);
}

static mrt_result recall(mrt_plugin *self, const void *bytes, size_t size)
{
    const memory_list list = memory_of(self);
    return memory_load(&list, bytes, size) ? MRT_OK : MRT_ERR_FORMAT;
}

static const mrt_mapping mapping = {activate, deactivate, reset, process};
static const mrt_state state = {save, load};
static const mrt_resume resume = {remember, recall};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_STATE, &state}, {MRT_RESUME, &resume}, {NULL, NULL}};
static const mrt_plugin_type one_hand = {
    MRT_ABI,
    SET_COUNT,
    settings,
    interfaces,
    "org.marotte.one_hand",
    "One hand",
    "1.0",
    "One hand performs a whole face: jaw, brows, lids, mouth and head.",
    create,
    destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&one_hand, NULL};
