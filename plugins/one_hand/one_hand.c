/* Mapping: one hand performs a face. Joint angles move its jaw, brows, lids, mouth and head,
 * through the named contacts and degrees of freedom of the rig. A vector starts at the contact's
 * rest; end = start means that the contact only follows the bones that carry it. All changes in
 * time depend on dt_s only. */
#include "card.h"
#include "own_hands.h"
#include "mapping.h"
#include "speak.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- pedals and buttons: immediate, without waiting for a possible second tap ---- */

enum { PEDAL_ANCHOR = 0, PEDAL_HOLD, PEDAL_LAYER, PEDAL_COUNT };

typedef struct pedal {
    bool is_down;
    double since_press_s; /* limited to a minute */
} pedal;

typedef struct pedals {
    pedal pedal[PEDAL_COUNT];
    bool is_latched;     /* the hold continues without the pedal */
    bool is_hold_spent;  /* this press of the hold pedal was part of a chord */
    bool is_layer_spent; /* this press of the layer pedal has locked the layer */
    bool can_revert;     /* the next tap of the anchor pedal can be the second of two */
    double intensity;    /* from the intensity pedal, smoothed; 1 without a pedal */
    bool has_intensity;
} pedals;

/* For a memory_list. */
#define PEDAL_MEMORY(pedal) MEMORY_BOOLS((pedal).is_down), MEMORY_DOUBLES((pedal).since_press_s)
#define PEDALS_MEMORY(pedals)                                                                      \
    PEDAL_MEMORY((pedals).pedal[PEDAL_ANCHOR]), PEDAL_MEMORY((pedals).pedal[PEDAL_HOLD]),          \
        PEDAL_MEMORY((pedals).pedal[PEDAL_LAYER]), MEMORY_BOOLS((pedals).is_latched),              \
        MEMORY_BOOLS((pedals).is_hold_spent), MEMORY_BOOLS((pedals).is_layer_spent),               \
        MEMORY_BOOLS((pedals).can_revert), MEMORY_DOUBLES((pedals).intensity),                     \
        MEMORY_BOOLS((pedals).has_intensity)

typedef struct pedals_events {
    bool anchor, revert, to_neutral; /* in this frame; at most one */
    bool lock_layer;                 /* in this frame */
    bool hold, other_layer;          /* true as long as it lasts */
} pedals_events;

static const double long_ago_s = 60.0;
static const double single_hold_s = 0.3;     /* one pedal for both: longer than a tap */
static const double intensity_time_s = 0.06; /* smooths the steps of the foot */
static const double intensity_most = 1.5;

static void pedals_reset(pedals *self)
{
    *self = (pedals){.intensity = 1.0};
    for (int i = 0; i < PEDAL_COUNT; ++i)
        self->pedal[i].since_press_s = long_ago_s;
}

static bool has_pedal(const mrt_frame *frame, int set)
{
    int number = (int)frame->params[set];
    return number >= 1 && number <= MRT_MAX_PEDALS;
}

/* Returns 0 up .. 1 down; 0 without a pedal. */
static double position(const mrt_frame *frame, int set)
{
    if (!has_pedal(frame, set))
        return 0.0;
    double value = (double)frame->pedal[(int)frame->params[set] - 1];
    return value > 0.0 ? (value < 1.0 ? value : 1.0) : 0.0;
}

/* Returns true in the frame of the press. A pedal that is half down keeps its state. */
static bool step_pedal(pedal *p, double position, double dt_s)
{
    bool was_down = p->is_down;
    p->is_down = position > (was_down ? 0.4 : 0.6);
    p->since_press_s += dt_s;
    if (p->since_press_s > long_ago_s)
        p->since_press_s = long_ago_s;
    return p->is_down && !was_down;
}

static void step_intensity(pedals *self, const mrt_frame *frame, double dt_s)
{
    bool has = has_pedal(frame, SET_INTENSITY_PEDAL);
    double wanted = has ? intensity_most * position(frame, SET_INTENSITY_PEDAL) : 1.0;
    if (has && !self->has_intensity && dt_s <= 0.0)
        self->intensity = wanted; /* state in the first frame */
    self->has_intensity = has;
    self->intensity += dt_s / (dt_s + intensity_time_s) * (wanted - self->intensity);
}

/* A press of a pedal and the previous one; since_s is the time since then. */
typedef struct press {
    bool is_now;
    double since_s;
} press;

static void step_anchor(pedals *self, press anchor, double tap_s, pedals_events *out)
{
    if (!anchor.is_now)
        return;
    out->revert = self->can_revert && anchor.since_s <= tap_s;
    out->anchor = !out->revert;
    self->can_revert = out->anchor;
}

static void step_hold(pedals *self, press hold, double tap_s)
{
    if (!hold.is_now)
        return;
    self->is_latched = !self->is_latched && !self->is_hold_spent && hold.since_s <= tap_s;
    self->is_hold_spent = false;
}

static void step_layer(pedals *self, press layer, double tap_s, pedals_events *out)
{
    if (!layer.is_now)
        return;
    out->lock_layer = !self->is_layer_spent && layer.since_s <= tap_s;
    self->is_layer_spent = out->lock_layer;
}

/* Both pedals go down within the time of a tap, in either order. */
static bool is_chord(const pedals *self, press anchor, press hold, double tap_s)
{
    const pedal *p = self->pedal;
    return (anchor.is_now || hold.is_now) && p[PEDAL_ANCHOR].is_down && p[PEDAL_HOLD].is_down &&
           p[PEDAL_ANCHOR].since_press_s <= tap_s && p[PEDAL_HOLD].since_press_s <= tap_s;
}

static void use_buttons(const mrt_frame *frame, pedals_events *out)
{
    const double *params = frame->params;
    out->lock_layer = out->lock_layer || params[SET_NEXT_LAYER] > 0.5;
    out->to_neutral = out->to_neutral || params[SET_TO_NEUTRAL] > 0.5;
    out->revert = !out->to_neutral && (out->revert || params[SET_REVERT] > 0.5);
    out->anchor = !out->to_neutral && !out->revert && (out->anchor || params[SET_ANCHOR] > 0.5);
}

static pedals_events pedals_step(pedals *self, const mrt_frame *frame, double dt_s)
{
    static const int sets[PEDAL_COUNT] = {SET_ANCHOR_PEDAL, SET_HOLD_PEDAL, SET_LAYER_PEDAL};
    const double *params = frame->params;
    double tap_s = params[SET_DOUBLE_TAP];
    bool is_single = has_pedal(frame, SET_HOLD_PEDAL) &&
                     (int)params[SET_ANCHOR_PEDAL] == (int)params[SET_HOLD_PEDAL];
    press presses[PEDAL_COUNT];
    pedals_events out = {0};
    for (int i = 0; i < PEDAL_COUNT; ++i) {
        pedal *p = &self->pedal[i];
        presses[i].is_now = step_pedal(p, position(frame, sets[i]), dt_s);
        presses[i].since_s = p->since_press_s;
        if (presses[i].is_now)
            p->since_press_s = 0.0;
    }
    step_intensity(self, frame, dt_s);
    step_anchor(self, presses[PEDAL_ANCHOR], tap_s, &out);
    step_layer(self, presses[PEDAL_LAYER], tap_s, &out);
    const pedal *hold = &self->pedal[PEDAL_HOLD];
    if (is_single) {
        out.hold = hold->is_down && hold->since_press_s > single_hold_s;
    } else {
        step_hold(self, presses[PEDAL_HOLD], tap_s);
        if (is_chord(self, presses[PEDAL_ANCHOR], presses[PEDAL_HOLD], tap_s)) {
            out.to_neutral = true;
            self->is_hold_spent = true;
            self->is_latched = self->can_revert = false;
        }
        out.hold = self->is_latched || (hold->is_down && !self->is_hold_spent);
    }
    out.hold = out.hold || params[SET_HOLD] > 0.5;
    out.other_layer = self->pedal[PEDAL_LAYER].is_down && !self->is_layer_spent;
    use_buttons(frame, &out);
    return out;
}

/* ---- lids in time: a quick bend of the middle finger blinks, a slow one droops the lids ---- */

typedef enum blink_phase { BLINK_NONE = 0, BLINK_CLOSING, BLINK_OPENING } blink_phase;

typedef struct blink {
    blink_phase phase;
    double time_s;  /* in the phase */
    double from;    /* closure at the beginning of the phase */
    double closure; /* 0 .. 1 */
    double droop;   /* smoothed, follows the requested droop */

    bool has_bend, is_spent; /* spent: this stroke has blinked */
    double bend_deg, speed_deg_s;
    double stroke_from_deg;
} blink;

/* For a memory_list. */
#define BLINK_MEMORY(blink)                                                                        \
    MEMORY_WHOLES((blink).phase, BLINK_OPENING), MEMORY_DOUBLES((blink).time_s),                   \
        MEMORY_DOUBLES((blink).from), MEMORY_DOUBLES((blink).closure),                             \
        MEMORY_DOUBLES((blink).droop), MEMORY_BOOLS((blink).has_bend),                             \
        MEMORY_BOOLS((blink).is_spent), MEMORY_DOUBLES((blink).bend_deg),                          \
        MEMORY_DOUBLES((blink).speed_deg_s), MEMORY_DOUBLES((blink).stroke_from_deg)

static const double speed_time_s = 0.015; /* smoothing of the finger's speed */
static const double arrived = 1e-5;       /* of the droop: then the lids take the exact value */
static const double gap_s = 0.1;          /* limit of dt_s: a longer gap has an unknown length */

static void blink_reset(blink *self)
{
    *self = (blink){0};
}

/* For another hand, or one that was away: its earlier movement does not give a speed. */
static void blink_forget_hand(blink *self)
{
    self->has_bend = false;
}

/* bend_deg: of the middle finger's knuckle, not relative to neutral. Returns true for a quick
 * bend. */
static bool blink_is_struck(blink *self, double bend_deg, double dt_s, const double *params)
{
    if (!self->has_bend || dt_s >= gap_s) {
        self->has_bend = true;
        self->is_spent = false;
        self->bend_deg = self->stroke_from_deg = bend_deg;
        self->speed_deg_s = 0.0;
        return false;
    }
    if (!(dt_s > 0.0))
        return false;
    double speed = (bend_deg - self->bend_deg) / dt_s, least = params[SET_BLINK_SPEED];
    double before_deg = self->bend_deg;
    self->bend_deg = bend_deg;
    self->speed_deg_s += dt_s / (dt_s + speed_time_s) * (speed - self->speed_deg_s);
    if (self->speed_deg_s < 0.5 * least) { /* the stroke begins where the finger becomes fast */
        self->stroke_from_deg = speed < 0.5 * least ? bend_deg : before_deg;
        self->is_spent = false;
        return false;
    }
    bool is_struck = !self->is_spent && self->speed_deg_s > least &&
                     bend_deg - self->stroke_from_deg >= params[SET_BLINK_STROKE];
    self->is_spent = self->is_spent || is_struck;
    return is_struck;
}

static void blink_start(blink *self)
{
    if (self->phase == BLINK_CLOSING)
        return;
    self->phase = BLINK_CLOSING;
    self->time_s = 0.0;
    self->from = self->closure;
}

/* The rest of a step that ends a phase counts for the next phase, so a blink does not depend on the
 * frame rate. */
static void move_lids(blink *self, double dt_s, const double *params)
{
    double close_s = 0.001 * params[SET_BLINK_CLOSE], open_s = 0.001 * params[SET_BLINK_OPEN];
    self->time_s += dt_s;
    if (self->phase == BLINK_CLOSING && self->time_s >= close_s) {
        self->phase = BLINK_OPENING;
        self->time_s -= close_s;
    }
    if (self->phase == BLINK_OPENING && self->time_s >= open_s)
        self->phase = BLINK_NONE;
    if (self->phase == BLINK_CLOSING)
        self->closure = self->from + (1.0 - self->from) * minimum_jerk(self->time_s / close_s);
    else if (self->phase == BLINK_OPENING)
        self->closure = 1.0 - minimum_jerk(self->time_s / open_s);
    else
        self->closure = 0.0;
}

/* droop: requested by the hand; it waits during a blink. */
static void blink_step(blink *self, double droop, double dt_s, const double *params)
{
    if (self->phase != BLINK_NONE) {
        move_lids(self, dt_s, params);
        return;
    }
    double time_s = params[SET_DROOP_TIME];
    double part = time_s > 0.0 ? dt_s / (dt_s + time_s) : 1.0;
    self->droop += part * (droop - self->droop);
    double left = droop - self->droop;
    if (left > -arrived && left < arrived)
        self->droop = droop;
}

/* ---- lips closed by the thumb: pressed or not, with a hysteresis larger than the device's noise.
 * The face follows in time, so that it does not jump ---- */

typedef struct seal {
    bool is_pressed;
    double closure; /* 0 .. 1 */
} seal;

/* For a memory_list. */
#define SEAL_MEMORY(seal) MEMORY_BOOLS((seal).is_pressed), MEMORY_DOUBLES((seal).closure)

static const double seal_time_s = 0.06; /* a closure of /p/ */

/* press_deg: bend of the thumb beyond neutral. */
static void seal_step(seal *self, double press_deg, double dt_s, const double *params)
{
    const double at = params[SET_PRESS];
    self->is_pressed = press_deg > (self->is_pressed ? 0.5 * at : at);
    const double way = dt_s / seal_time_s;
    self->closure = clamp(self->closure + (self->is_pressed ? way : -way), 0.0, 1.0);
}

/* ---- attachment of the shown face to the hand: live, held, or easing from one to the other. A
 * change never makes the face jump: the difference at that moment fades away ---- */

/* Reasons why a layer does not follow the hand; 0: it does. */
enum { HELD_BY_LAYER = 1, HELD_BY_PEDAL = 2, HELD_BY_ABSENCE = 4 };

typedef struct attach {
    pose shown;  /* the face to show, before limits */
    pose offset; /* kept by an anchor: added to the pose of the hand */
    pose held;   /* of layers that do not follow */
    pose rest;   /* difference between the shown and the target face at the last change */
    unsigned held_by[LAYER_COUNT];
    bool has_changed; /* the next step starts a new transition */
    double time_s, duration_s;
} attach;

/* For a memory_list. */
#define ATTACH_MEMORY(attach)                                                                      \
    MEMORY_DOUBLES((attach).shown), MEMORY_DOUBLES((attach).offset),                               \
        MEMORY_DOUBLES((attach).held), MEMORY_DOUBLES((attach).rest),                              \
        MEMORY_WHOLES((attach).held_by, HELD_BY_LAYER | HELD_BY_PEDAL | HELD_BY_ABSENCE),          \
        MEMORY_BOOLS((attach).has_changed), MEMORY_DOUBLES((attach).time_s),                       \
        MEMORY_DOUBLES((attach).duration_s)

static void attach_reset(attach *self)
{
    memset(self, 0, sizeof *self);
}

/* Eases to a new target, starting with the next step. */
static void attach_change(attach *self, double duration_s)
{
    self->has_changed = true;
    self->duration_s = duration_s;
}

static void shorten(double v[3], double most)
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (length <= most)
        return;
    for (int axis = 0; axis < 3; ++axis)
        v[axis] *= most / length;
}

/* Keeps the shown face when the hand's target becomes zero in the next step. most_mm, low, high
 * (DOF_COUNT): limits of the visible face; the part beyond them is not kept. */
static void attach_keep(attach *self, double most_mm, const double *low, const double *high)
{
    self->offset = self->shown;
    for (int landmark = 0; landmark < LANDMARK_COUNT; ++landmark)
        shorten(self->offset.value + 3 * landmark, most_mm);
    double *dof = self->offset.value + POSE_DOFS;
    for (int i = 0; i < DOF_COUNT; ++i)
        dof[i] = clamp(dof[i], low[i], high[i]);
}

/* Eases everything to rest, except the hand's current pose. */
static void attach_forget(attach *self, double duration_s)
{
    memset(&self->offset, 0, sizeof self->offset);
    memset(&self->held, 0, sizeof self->held);
    attach_change(self, duration_s);
}

/* A layer that stops following, or gets another reason for that, keeps its visible state. */
static void take_holds(attach *self, const unsigned held_by[LAYER_COUNT], double reattach_s)
{
    bool is_stopped[LAYER_COUNT];
    bool is_other = false;
    for (int layer = 0; layer < LAYER_COUNT; ++layer) {
        unsigned added = held_by[layer] & ~self->held_by[layer];
        bool follows = self->held_by[layer] == 0;
        is_stopped[layer] = (added & (HELD_BY_PEDAL | HELD_BY_ABSENCE)) || (added && follows);
        is_other = is_other || held_by[layer] != self->held_by[layer];
        self->held_by[layer] = held_by[layer];
    }
    for (int i = 0; i < POSE_COUNT; ++i)
        if (is_stopped[pose_layer(i)])
            self->held.value[i] = self->shown.value[i];
    if (is_other && !self->has_changed)
        attach_change(self, reattach_s);
}

/* held_by: per layer. reattach_s: duration of the return after a hold. */
static void attach_step(attach *self, const pose *target, const unsigned held_by[LAYER_COUNT],
                        double reattach_s, double dt_s)
{
    take_holds(self, held_by, reattach_s);
    self->time_s = self->has_changed ? 0.0 : self->time_s + dt_s;
    double left =
        self->time_s < self->duration_s ? 1.0 - minimum_jerk(self->time_s / self->duration_s) : 0.0;
    for (int i = 0; i < POSE_COUNT; ++i) {
        double goal = self->held_by[pose_layer(i)] ? self->held.value[i]
                                                   : target->value[i] + self->offset.value[i];
        if (self->has_changed)
            self->rest.value[i] = self->shown.value[i] - goal;
        self->shown.value[i] = left > 0.0 ? goal + left * self->rest.value[i] : goal;
    }
    self->has_changed = false;
}

/* ---- neutral poses in the format of earlier versions: little-endian, with a checksum ---- */

typedef struct neutral {
    bool is_known;
    reading pose;
} neutral;

typedef struct stored_neutrals {
    char magic[8];
    uint32_t version, known; /* known: one bit per side; the pose of an unknown side is 0 */
    reading pose[2];
    uint64_t sum; /* FNV-1a of all bytes before it */
} stored_neutrals;
_Static_assert(sizeof(stored_neutrals) == 24 + 2 * sizeof(reading), "stored so");

/* Returns false, without a change, if the bytes are not in this format. */
static bool stored_read(neutral hands[2], const void *in, size_t size)
{
    static const char magic[8] = {'M', 'R', 'T', '1', 'H', 'A', 'N', 'D'};
    stored_neutrals then;
    if (!in || size != sizeof then)
        return false;
    memcpy(&then, in, sizeof then);
    if (memcmp(then.magic, magic, sizeof magic) != 0 || then.version != 1 || then.known > 3 ||
        then.sum != memory_sum(MEMORY_SUM_START, &then, offsetof(stored_neutrals, sum)) ||
        !reading_is_plausible(&then.pose[0]) || !reading_is_plausible(&then.pose[1]))
        return false;
    for (int side = 0; side < 2; ++side)
        hands[side] = (neutral){then.known >> side & 1, then.pose[side]};
    return true;
}

/* ---- the instance ---- */

static const double dt_max_s = 0.1;

typedef struct anchor { /* neutral pose that an anchor replaced, for the second tap */
    bool is_known;
    uint32_t side;
    reading neutral;
    pose offset;
} anchor;

struct mrt_plugin {
    const mrt_host *host;
    fitting fitting;
    own_hands stored_answers; /* loaded answers: restored by a reset */
    own_hands answers;
    own_hands before_change;        /* restored by an undo */
    double steady_deg[JOINT_COUNT]; /* recent hand pose, used as an answer */
    const mrt_rig_pose *rig_poses;  /* of the face, until deactivate */
    uint32_t rig_pose_count;
    bool can_speak; /* true if the rig has poses that this mapping uses */
    speak_half speak[DEVICE_KINDS][HALF_COUNT];
    double furthest_deg[DEVICE_KINDS][JOINT_COUNT]; /* of any hand pose, either way */
    neutral stored[2];                              /* loaded */
    bool is_stored_new;                             /* loaded since the last frame */

    /* ---- since reset ---- */
    bool has_performed, has_told_no_neutral;
    bool wanted_stored; /* in the frame before */
    uint32_t side;      /* of the hand that performs */
    neutral neutral[2];
    uint32_t sample_count[2]; /* of a neutral pose that is not known yet */
    anchor before;
    pedals pedals;
    blink blink;
    seal seal;
    attach attach;
    device_kind device; /* of the frame before */
    int mode, layer;    /* of the frame before */
    int layer_shift;    /* by locks */
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

/* The mode Speaking needs poses that the hand can match. Without them, Classic is used. */
static int mode_of(const mrt_plugin *self, const double *params)
{
    const int mode = (int)params[SET_MODE];
    return mode == MODE_SPEAKING && !self->can_speak ? MODE_CLASSIC : mode;
}

static bool speaks(const mrt_plugin *self, const double *params)
{
    return mode_of(self, params) == MODE_SPEAKING;
}

/* ---- the performing hand and its neutral pose ---- */

/* Returns MRT_NO_HAND if no wanted and plausible hand is present. */
static uint32_t take_reading(reading *out, const mrt_frame *frame)
{
    static const uint32_t wanted[][2] = {[HAND_EITHER] = {MRT_RIGHT, MRT_LEFT},
                                         [HAND_LEFT] = {MRT_LEFT, MRT_LEFT},
                                         [HAND_RIGHT] = {MRT_RIGHT, MRT_RIGHT}};
    const uint32_t *sides = wanted[(int)frame->params[SET_HAND]];
    for (int i = 0; i < 2; ++i) {
        const mrt_hand *hand = &frame->hand[sides[i]];
        if (hand->present && reading_from_hand(out, hand, sides[i]))
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

/* A neutral pose with a fist leaves no range to curl further. */
static void judge_neutral(const mrt_plugin *self, const reading *as, const double *params)
{
    static const int middle_joints[4] = {5, 8, 12, 16};
    static const double fist_deg = 75.0;
    double bend_deg = 0.0;
    for (int i = 0; i < 4; ++i)
        bend_deg += 0.25 * as->value[READING_ANGLES + middle_joints[i]];
    if (speaks(self, params) && bend_deg > fist_deg)
        self->host->log(self->host, MRT_LOG_WARNING,
                        "The neutral pose is a fist: the fingers cannot curl further. Relax the "
                        "hand, then press Anchor.");
}

/* Finds the neutral pose: the stored one, or the mean of the first samples. Until it is known the
 * face is at rest. */
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
                        "no neutral pose is stored for this hand: the pose at engage is used");
    }
    uint32_t *count = &self->sample_count[self->side];
    *count += 1;
    if (*count == 1)
        own->pose = *now;
    else
        reading_average(&own->pose, now, *count);
    if ((double)*count < params[SET_NEUTRAL_SAMPLES])
        return;
    judge_neutral(self, &own->pose, params);
    set_neutral(self, &own->pose);
    attach_change(&self->attach, params[SET_REATTACH]);
}

/* ---- the device that measures the hand ---- */

static device_kind device_of(const mrt_frame *frame, uint32_t side)
{
    const mrt_channels *input = NULL;
    for (uint32_t i = 0; i < frame->input_count && !input; ++i)
        if (device_measures(&frame->inputs[i], side))
            input = &frame->inputs[i];
    return device_of_input(frame->params, input, side);
}

/* ---- pedals ---- */

/* Longer than any pull of a speaking face. */
static const double spoken_reach_mm = 60.0;

static void set_anchor(mrt_plugin *self, const reading *now, const double *params)
{
    const neutral *own = &self->neutral[self->side];
    self->before = (anchor){own->is_known, self->side, own->pose, self->attach.offset};
    if (speaks(self, params))
        attach_keep(&self->attach, spoken_reach_mm, self->fitting.lowest, self->fitting.high);
    else
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
    int mode = mode_of(self, params), layer = (int)params[SET_LAYER];
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

/* ---- the face that follows the hand ---- */

enum { LAYER_ALL = -1 };

/* Returns the layer that the hand moves in layered waldo; LAYER_ALL: the whole face, with the map
 * of the mode. */
static int live_layer(const mrt_plugin *self, const pedals_events *events, const double *params)
{
    int shift = self->layer_shift + events->other_layer;
    if (self->mode == MODE_SPEAKING)
        return LAYER_ALL;
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

/* Moves the lids in time. A frozen face does not blink. */
static void step_lids(mrt_plugin *self, const reading *now, double droop, unsigned held_by,
                      double dt_s, const double *params)
{
    bool is_frozen = held_by & (HELD_BY_PEDAL | HELD_BY_ABSENCE);
    bool is_struck =
        blink_is_struck(&self->blink, now->value[READING_MIDDLE_KNUCKLE], dt_s, params);
    const bool strikes = self->mode == MODE_CLASSIC || self->mode == MODE_WALDO;
    bool has_reason = params[SET_BLINK] > 0.5 || (is_struck && held_by == 0 && strikes);
    if (is_frozen)
        return;
    if (has_reason)
        blink_start(&self->blink);
    blink_step(&self->blink, droop, dt_s, params);
}

/* Scales a joint's movement by the gain of its axis, with a limit: exact up to twice the joint's
 * value in the furthest hand pose in range. */
static double scaled(const mrt_plugin *self, device_kind device, int joint, double deg,
                     const double *params)
{
    static const int axis_of[JOINT_COUNT] = {
        [JOINT_THUMB_DROP] = AXIS_JAW,       [JOINT_THUMB_MIDDLE] = AXIS_JAW,
        [JOINT_THUMB_TIP] = AXIS_LOWER_LIP,  [JOINT_INDEX_CURL] = AXIS_ROUND,
        [JOINT_MIDDLE_CURL] = AXIS_ROUND,    [JOINT_SPREAD] = AXIS_WIDTH,
        [JOINT_RING_KNUCKLE] = AXIS_SMILE,   [JOINT_RING_CURL] = AXIS_TONGUE,
        [JOINT_LITTLE_KNUCKLE] = AXIS_SMILE, [JOINT_LITTLE_CURL] = AXIS_TONGUE,
        [JOINT_INDEX_KNUCKLE] = AXIS_BROWS,  [JOINT_MIDDLE_KNUCKLE] = AXIS_LIDS,
        [JOINT_THUMB_ROLL] = AXIS_GAZE,      [JOINT_ARCH] = AXIS_TILT};
    const double gain = 0.01 * params[SET_GAIN + axis_of[joint]];
    const double range = 0.01 * params[SET_RANGE + axis_of[joint]];
    const double most = 2.0 * range * self->furthest_deg[device][joint];
    return curve_limit(gain * deg, most, most);
}

static void add_head(pose *out, const reading *difference, const double *params)
{
    static const double rad_per_deg = 0.017453292519943295;
    static const double per_deg = 0.8, dead_deg = 3.0, nod_deg = 20.0, turn_deg = 30.0;
    const double gain = 0.01 * params[SET_GAIN + AXIS_HEAD] * per_deg;
    const double range = 0.01 * params[SET_RANGE + AXIS_HEAD];
    const double *angle = difference->value + READING_ANGLES;
    double *dof = out->value + POSE_DOFS;
    dof[DOF_NOD] = rad_per_deg * curve_limit(gain * curve_dead_zone(angle[20], dead_deg),
                                             range * nod_deg, range * nod_deg);
    dof[DOF_TURN] = rad_per_deg * curve_limit(gain * curve_dead_zone(angle[21], dead_deg),
                                              range * turn_deg, range * turn_deg);
}

static bool is_expression(int value)
{
    const int dof = value - POSE_DOFS;
    return dof < 0 || (dof >= DOF_LID_UPPER && dof < DOF_SEAL);
}

static void speak(const mrt_plugin *self, const double deg[JOINT_COUNT], const reading *difference,
                  double intensity, const double *params, pose *out)
{
    double at[JOINT_COUNT];
    memset(out, 0, sizeof *out);
    for (int i = 0; i < JOINT_COUNT; ++i)
        at[i] = scaled(self, self->device, i, deg[i], params);
    for (int which = 0; which < HALF_COUNT; ++which)
        speak_value(&self->speak[self->device][which], at, out);
    for (int v = 0; v < POSE_COUNT; ++v)
        if (is_expression(v))
            out->value[v] *= intensity;
    add_head(out, difference, params);
    double *dof = out->value + POSE_DOFS;
    dof[DOF_SEAL] = fmax(dof[DOF_SEAL], self->seal.closure);
}

static void find_target(const mrt_plugin *self, const reading *difference, int live,
                        double intensity, const double *params, pose *out)
{
    double deg[JOINT_COUNT];
    if (live != LAYER_ALL) {
        maps_waldo(out, difference, live, params);
    } else if (self->mode == MODE_SPEAKING) {
        joints_of(deg, difference);
        speak(self, deg, difference, intensity, params, out);
    } else if (self->mode == MODE_MASK) {
        maps_mask(out, difference, params);
    } else {
        maps_muppet(out, difference, intensity, self->blink.droop, params);
    }
    if (self->side == MRT_LEFT)
        pose_mirror(out);
}

/* Computes the target face from the hand. The lids were moved before. */
static void follow(mrt_plugin *self, const reading *now, int live, unsigned lids_held_by,
                   double dt_s, const double *params, pose *out)
{
    const neutral *own = &self->neutral[self->side];
    reading difference = reading_difference(now, own->is_known ? &own->pose : now);
    double intensity = 0.01 * params[SET_INTENSITY] * self->pedals.intensity;
    const bool is_speaking = self->mode == MODE_SPEAKING;
    double droop = is_speaking ? 0.0 : maps_droop(&difference, intensity, params);
    step_lids(self, now, droop, lids_held_by, dt_s, params);
    if (is_speaking) {
        const double press_deg = difference.value[READING_ANGLES + 1];
        seal_step(&self->seal, 0.01 * params[SET_GAIN + AXIS_JAW] * press_deg, dt_s, params);
    }
    find_target(self, &difference, live, intensity, params, out);
}

/* ---- the mapping ---- */

/* ---- the faces of the rig ---- */

static void set_rig_poses(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses,
                          uint32_t count)
{
    (void)face;
    self->rig_poses = poses;
    self->rig_pose_count = count;
}

/* Fits one half to the faces that this device can distinguish, at their hand poses. */
static bool learn_half(mrt_plugin *self, device_kind device, face_half which)
{
    double deg[FACE_COUNT][JOINT_COUNT];
    speak_face faces[SPEAK_FACES_MAX];
    int count = 0;
    (void)own_hands_bend(deg, &self->answers, device, which);
    for (int f = 0; f < FACE_COUNT && count < SPEAK_FACES_MAX; ++f) {
        if (face_recipes[f].half != which || posed_hands[device][f].same_as != FACE_IS_ITSELF ||
            !face_find(&faces[count].pose, &face_recipes[f], &self->fitting, self->rig_poses,
                       self->rig_pose_count))
            continue;
        memcpy(faces[count].deg, deg[f], sizeof deg[f]);
        for (int i = 0; i < JOINT_COUNT; ++i)
            self->furthest_deg[device][i] = fmax(self->furthest_deg[device][i], fabs(deg[f][i]));
        count += 1;
    }
    return speak_find(&self->speak[device][which], which, device, faces, count) && count > 0;
}

static void learn_faces(mrt_plugin *self)
{
    self->can_speak = false;
    memset(self->furthest_deg, 0, sizeof self->furthest_deg);
    for (int device = 0; device < DEVICE_KINDS; ++device)
        for (int which = 0; which < HALF_COUNT; ++which)
            self->can_speak |= learn_half(self, (device_kind)device, (face_half)which);
}

/* ---- answers ---- */

static const char *const verdict_words[] = {
    [OWN_HANDS_NONE] = "The hand poses are the default ones.",
    [OWN_HANDS_TAKEN] = "Your hand poses are in use.",
    [OWN_HANDS_NONSENSE] = "Your hand poses do not match the faces, so the default ones stay in "
                           "use. Press Undo, or answer the same face again."};

/* [frame] Takes half a millisecond. */
static void follow_answers(mrt_plugin *self, device_kind device)
{
    double ignored[FACE_COUNT][JOINT_COUNT];
    const own_hands_verdict verdict[HALF_COUNT] = {
        own_hands_bend(ignored, &self->answers, device, HALF_MOUTH),
        own_hands_bend(ignored, &self->answers, device, HALF_UPPER)};
    learn_faces(self);
    attach_change(&self->attach, 0.25);
    self->host->log(self->host, MRT_LOG_INFO,
                    verdict_words[verdict[0] > verdict[1] ? verdict[0] : verdict[1]]);
}

/* Undoing twice is a redo. */
static void undo_answer(mrt_plugin *self)
{
    const own_hands now = self->answers;
    self->answers = self->before_change;
    self->before_change = now;
}

static void attend(mrt_plugin *self, const reading *now, const double *params, double dt_s)
{
    static const double steady_time_s = 0.15;
    const neutral *own = &self->neutral[self->side];
    const int name = (int)params[SET_ANSWERED_FACE];
    const bool is_undo = params[SET_UNDO_ANSWER] > 0.5, is_answer = params[SET_ANSWER] > 0.5,
               is_forget = params[SET_FORGET_ANSWER] > 0.5,
               is_forget_all = params[SET_FORGET_ANSWERS] > 0.5;
    reading difference = reading_difference(now, own->is_known ? &own->pose : now);
    double deg[JOINT_COUNT];
    joints_of(deg, &difference);
    for (int i = 0; i < JOINT_COUNT; ++i)
        self->steady_deg[i] +=
            smoothing_share(dt_s, steady_time_s) * (deg[i] - self->steady_deg[i]);
    if (!is_undo && !is_answer && !is_forget && !is_forget_all)
        return;
    if (is_undo)
        undo_answer(self);
    else
        self->before_change = self->answers;
    if (is_answer)
        own_hands_add(&self->answers, self->device, name, self->steady_deg);
    if (is_forget)
        own_hands_forget(&self->answers, name);
    if (is_forget_all)
        memset(&self->answers, 0, sizeof self->answers);
    follow_answers(self, self->device);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    if (!fitting_find(&self->fitting, face)) {
        self->host->log(
            self->host, MRT_LOG_ERROR,
            "the face has no contact or degree of freedom that one hand can move (mouth.corner.l, "
            "jaw.open ...): open a face with a rig");
        return MRT_ERR_UNSUPPORTED;
    }
    fitting_report(&self->fitting, self->host);
    learn_faces(self);
    if (!self->can_speak)
        self->host->log(self->host, MRT_LOG_WARNING,
                        "This rig has no poses that the hand can match. one_hand uses the classic "
                        "mode. To add poses, draft the rig again with \"marotte rig new\".");
    return MRT_OK;
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
    self->seal = (seal){.closure = 0.0};
    memset(self->steady_deg, 0, sizeof self->steady_deg);
    const bool has_learned =
        memcmp(&self->answers, &self->stored_answers, sizeof self->answers) != 0;
    self->answers = self->before_change =
        self->stored_answers; /* without it an undo has nothing to restore */
    if (has_learned)
        learn_faces(self);
    attach_reset(&self->attach);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const double *params = frame->params;
    double dt_s = clamp(frame->dt_s > 0.0 ? frame->dt_s : 0.0, 0.0, dt_max_s);
    reading now;
    uint32_t side = take_reading(&now, frame);
    bool is_present = side != MRT_NO_HAND;
    pedals_events events = pedals_step(&self->pedals, frame, dt_s);
    if (!is_present && !self->has_performed)
        return MRT_HOLD;
    pose target = {{0}};
    unsigned held_by[LAYER_COUNT];
    if (is_present) {
        const device_kind device = device_of(frame, side);
        if (side != self->side || device != self->device)
            change_hand(self, side, params);
        self->device = device;
        apply_events(self, &events, &now, params);
        find_neutral(self, &now, params);
        attend(self, &now, params, dt_s);
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
    if (self->mode == MODE_SPEAKING)
        fitting_write(&self->fitting, &self->attach.shown, self->blink.closure, params, pull);
    else
        fitting_write_classic(&self->fitting, &self->attach.shown, self->blink.closure, params,
                              pull);
    return MRT_OK;
}

/* ---- storing the neutral poses and the answers ---- */

#define NEUTRAL_MEMORY(neutral) MEMORY_BOOLS((neutral).is_known), MEMORY_DOUBLES((neutral).pose)
#define ANSWERS_MEMORY(answers)                                                                    \
    MEMORY_WHOLES((answers).device, DEVICE_KINDS - 1),                                             \
        MEMORY_WHOLES((answers).rounds, OWN_HANDS_ROUNDS_MAX), MEMORY_FLOATS((answers).deg)

typedef struct taught {
    neutral hand[2];
    own_hands answers;
} taught;

static memory_list memory_of_taught(taught *self)
{
    return (memory_list){.type = "org.marotte.one_hand/taught",
                         .version = 2,
                         .parts = {NEUTRAL_MEMORY(self->hand[0]), NEUTRAL_MEMORY(self->hand[1]),
                                   ANSWERS_MEMORY(self->answers)}};
}

static size_t save(mrt_plugin *self, void *out, size_t capacity)
{
    taught now = {.answers = self->answers};
    for (int side = 0; side < 2; ++side)
        now.hand[side] = self->neutral[side].is_known ? self->neutral[side] : self->stored[side];
    const memory_list list = memory_of_taught(&now);
    return memory_save(&list, out, capacity);
}

static bool read_taught(taught *out, const void *bytes, size_t size)
{
    const memory_list list = memory_of_taught(out);
    if (stored_read(out->hand, bytes, size)) {
        memset(&out->answers, 0, sizeof out->answers);
        return true;
    }
    return memory_load(&list, bytes, size) && reading_is_plausible(&out->hand[0].pose) &&
           reading_is_plausible(&out->hand[1].pose) && own_hands_are_plausible(&out->answers);
}

static mrt_result load(mrt_plugin *self, const void *bytes, size_t size)
{
    taught then;
    if (!read_taught(&then, bytes, size)) {
        self->host->log(self->host, MRT_LOG_ERROR,
                        "Cannot load the stored hand: the data is not from one_hand. The hand "
                        "poses are unchanged. Store the neutral pose again.");
        return MRT_ERR_FORMAT;
    }
    memcpy(self->stored, then.hand, sizeof self->stored);
    self->stored_answers = self->answers = self->before_change = then.answers;
    self->is_stored_new = true;
    learn_faces(self);
    return MRT_OK;
}

/* ---- resume ---- */

enum { MEMORY_VERSION = 2, NEUTRAL_SAMPLES_MOST = 1000000 };

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
                             SEAL_MEMORY(self->seal),
                             ANSWERS_MEMORY(self->stored_answers),
                             ANSWERS_MEMORY(self->answers),
                             ANSWERS_MEMORY(self->before_change),
                             MEMORY_DOUBLES(self->steady_deg),
                             ATTACH_MEMORY(self->attach),
                             MEMORY_WHOLES(self->device, DEVICE_KINDS - 1),
                             MEMORY_WHOLES(self->mode, MODE_COUNT - 1),
                             MEMORY_WHOLES(self->layer, LAYER_COUNT - 1),
                             MEMORY_WHOLES(self->layer_shift, LAYER_COUNT - 1),
                         }};
}

static size_t resume_save(mrt_plugin *self, void *out, size_t capacity)
{
    const memory_list list = memory_of(self);
    return memory_save(&list, out, capacity);
}

static mrt_result resume_load(mrt_plugin *self, const void *bytes, size_t size)
{
    const memory_list list = memory_of(self);
    const own_hands before = self->answers;
    if (!memory_load(&list, bytes, size))
        return MRT_ERR_FORMAT;
    if (memcmp(&before, &self->answers, sizeof before) != 0)
        learn_faces(self);
    return MRT_OK;
}

static const mrt_mapping mapping = {activate, mapping_deactivate, reset, process};
static const mrt_state state = {save, load};
static const mrt_resume resume = {resume_save, resume_load};
static const mrt_rig_poses rig_poses = {set_rig_poses};
static const mrt_hand_card hand_card = {card_lines};
static const mrt_interface interfaces[] = {{MRT_MAPPING, &mapping},     {MRT_HAND_CARD, &hand_card},
                                           {MRT_RIG_POSES, &rig_poses}, {MRT_STATE, &state},
                                           {MRT_RESUME, &resume},       {NULL, NULL}};
static const mrt_plugin_type one_hand = {
    MRT_ABI,
    SET_COUNT,
    settings,
    interfaces,
    "org.marotte.one_hand",
    "One hand",
    "2.0",
    "One hand performs a whole face: jaw, brows, lids, mouth and head.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&one_hand, NULL};
