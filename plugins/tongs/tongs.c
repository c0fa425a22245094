/* Mapping: thumb and index finger are tongs. Closing them grips the face where they are, moving
 * them pulls it, opening them a little stretches it, and opening them wide lets it go. */
#include "mapping.h"
#include "placement.h"

#include <math.h>
#include <stdlib.h>

enum {
    GAIN = PLACEMENT_COUNT,
    RADIUS,
    REACH,
    STRETCH,
    CLOSE,
    OPEN,
    CLUTCH,
    PARAM_COUNT = CLUTCH + CLUTCH_COUNT
};
enum { THUMB_TIP = 4, INDEX_TIP = 8, MIDDLE_KNUCKLE = 9, TIPS_PER_HAND = 5 };
typedef enum phase { LOOSE = 0, GRIPPING, SPRINGING } phase;

/* Share of the radius: smallest distance of the two gripped points. The stretch to either side is
 * at most a quarter of their distance. */
static const float apart_least = 0.5f;

typedef struct tips {      /* face frame, mm */
    mrt_vec3 middle, half; /* half: vector from the middle to the index finger's tip */
    double gap;            /* distance of the tips, in lengths of the palm */
} tips;

struct mrt_plugin {
    placement placement;
    clutch clutch;
    bool is_armed, is_closed; /* closed: gripping, if the face allows it */
    phase phase;
    uint32_t side; /* of the last hand that gripped; MRT_NO_HAND: none */
    bool was_there;
    mrt_vec3 middle, half;           /* of the tips at the grip */
    mrt_vec3 last_middle, last_half; /* in the last frame with the hand */
    mrt_vec3 way[2];                 /* displacement of the two points at release */
    double sprung;                   /* progress of springing back, 0 .. 1 */
};

static float length(mrt_vec3 v)
{
    return sqrtf(v.x * v.x + v.y * v.y + v.z * v.z);
}

/* Returns v limited to most, smoothly, and nearly v for short v. */
static mrt_vec3 limited(mrt_vec3 v, float most)
{
    float q = (v.x * v.x + v.y * v.y + v.z * v.z) / (most * most);
    return vec_sum((mrt_vec3){0, 0, 0}, 1.0f / sqrtf(sqrtf(1.0f + q * q)), v);
}

static mrt_plugin *create(const mrt_host *host)
{
    (void)host;
    return calloc(1, sizeof(mrt_plugin));
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    placement_activate(&self->placement, face);
    return MRT_OK;
}

static void reset(mrt_plugin *self)
{
    placement_reset(&self->placement);
    clutch_reset(&self->clutch);
    self->is_armed = self->is_closed = self->was_there = false;
    self->phase = LOOSE;
    self->side = MRT_NO_HAND;
    self->sprung = 0.0;
}

/* ---- the tongs ---- */

static double gap_of(const mrt_hand *hand)
{
    mrt_vec3 palm = vec_difference(hand->joint[MIDDLE_KNUCKLE], hand->joint[0]);
    mrt_vec3 gap = vec_difference(hand->joint[INDEX_TIP], hand->joint[THUMB_TIP]);
    return (double)length(gap) / fmax((double)length(palm), 1.0);
}

/* points: from placement_points; its number of points per pulling hand. */
static tips tips_of(const mrt_hand *hand, const mrt_vec3 *point)
{
    mrt_vec3 half = vec_sum((mrt_vec3){0, 0, 0}, 0.5f, vec_difference(point[1], point[0]));
    return (tips){vec_sum(point[0], 1.0f, half), half, gap_of(hand)};
}

/* Finds the tips of the gripping hand, else of the more closed hand. Returns false if there is
 * none. */
static bool find_tips(mrt_plugin *self, const mrt_frame *frame, tips *out)
{
    mrt_vec3 point[PLACEMENT_POINTS_MAX];
    uint32_t count = placement_points(&self->placement, frame, point), at = 0;
    uint32_t per_hand = TIPS_PER_HAND + (frame->params[PLACEMENT_PALM] > 0.5 ? MRT_PALM : 0);
    bool is_held = self->phase == GRIPPING, is_found = false;
    uint32_t held_by = self->side;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT && at < count; ++side) {
        bool pulls = placement_pulls(frame, side);
        if (pulls && (!is_held || side == held_by)) {
            tips these = tips_of(&frame->hand[side], point + at);
            if (!is_found || these.gap < out->gap) {
                *out = these;
                self->side = side;
            }
            is_found = true;
        }
        at += pulls ? per_hand : 0;
    }
    return is_found;
}

/* ---- the gripped face ---- */

static void probe(const tips *now, mrt_pull *pull)
{
    pull->vector[0] = (mrt_vector){now->middle, now->middle, 0};
    pull->count = 1;
    pull->mode = MRT_IDLE;
}

/* Grips two neighbouring points, without a movement. */
static void grip(mrt_plugin *self, const tips *now, mrt_pull *pull)
{
    float least = 0.5f * apart_least * pull->radius_mm, is = length(now->half);
    mrt_vec3 half = is > 1e-3f ? now->half : (mrt_vec3){0, 1e-3f, 0};
    half = vec_sum((mrt_vec3){0, 0, 0}, fmaxf(least, is) / fmaxf(is, 1e-3f), half);
    for (int i = 0; i < 2; ++i) {
        mrt_vec3 at = vec_sum(now->middle, i ? 1.0f : -1.0f, half);
        pull->vector[i] = (mrt_vector){at, at, 0};
    }
    self->middle = now->middle;
    self->half = now->half;
    self->phase = GRIPPING;
    pull->mode = MRT_ANCHORED;
    pull->count = 2;
    pull->anchor += 1;
}

static void take_along(const mrt_plugin *self, const tips *now, const double *params,
                       mrt_pull *pull)
{
    float reach = pull->radius_mm * (float)(0.01 * params[REACH]);
    mrt_vec3 between = vec_difference(pull->vector[1].start, pull->vector[0].start);
    mrt_vec3 moved = vec_sum((mrt_vec3){0, 0, 0}, (float)params[GAIN],
                             vec_difference(now->middle, self->middle));
    mrt_vec3 opened =
        vec_sum((mrt_vec3){0, 0, 0}, (float)params[STRETCH], vec_difference(now->half, self->half));
    moved = limited(moved, reach);
    opened = limited(opened, fminf(0.25f * length(between), 0.5f * reach));
    for (int i = 0; i < 2; ++i)
        pull->vector[i].end =
            vec_sum(vec_sum(pull->vector[i].start, 1.0f, moved), i ? 1.0f : -1.0f, opened);
}

static void let_go(mrt_plugin *self, const double *params, const mrt_pull *pull)
{
    self->phase = clutch_springs_back(params + CLUTCH) ? SPRINGING : LOOSE;
    self->sprung = 0.0;
    for (int i = 0; i < 2; ++i)
        self->way[i] = vec_difference(pull->vector[i].end, pull->vector[i].start);
}

static void spring_back(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    self->sprung += frame->dt_s / frame->params[CLUTCH + CLUTCH_RELEASE_TIME];
    float rest = (float)(1.0 - minimum_jerk(self->sprung));
    for (int i = 0; i < 2; ++i)
        pull->vector[i].end = vec_sum(pull->vector[i].start, rest, self->way[i]);
    if (self->sprung >= 1.0)
        self->phase = LOOSE;
}

/* ---- the mapping ---- */

/* Closed below one gap, open above the other; between them the state does not change. */
static void feel(mrt_plugin *self, const tips *now, const double *params)
{
    double close = 0.01 * params[CLOSE], open = fmax(0.01 * params[OPEN], close);
    if (now->gap < close)
        self->is_closed = true;
    else if (now->gap > open)
        self->is_closed = false;
}

/* A hand that reappears continues from its last state, so the face does not jump. */
static void remember(mrt_plugin *self, const tips *now)
{
    if (!self->was_there) {
        self->middle = vec_sum(self->middle, 1.0f, vec_difference(now->middle, self->last_middle));
        self->half = vec_sum(self->half, 1.0f, vec_difference(now->half, self->last_half));
    }
    self->last_middle = now->middle;
    self->last_half = now->half;
}

/* Applies the clutch: whether to grip again, or to release. */
static void apply_events(mrt_plugin *self, const clutch_events *events, const double *params,
                         mrt_pull *pull)
{
    if (events->commit)
        pull->commit += 1;
    if (events->engage)
        self->is_armed = true;
    if (events->release)
        self->is_armed = false;
    if (self->phase == GRIPPING && (!self->is_armed || !self->is_closed))
        let_go(self, params, pull);
    else if (events->commit && self->phase != LOOSE)
        self->phase = LOOSE; /* the stretched shape is the base now */
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const double *params = frame->params;
    tips now;
    bool is_there = find_tips(self, frame, &now);
    if (!is_there && self->phase == LOOSE)
        return MRT_HOLD;
    clutch_events events = clutch_step(&self->clutch, frame, params + CLUTCH);
    if (is_there) {
        feel(self, &now, params);
        remember(self, &now);
    }
    self->was_there = is_there;
    apply_events(self, &events, params, pull);
    pull->gate = 1;
    if (self->phase == SPRINGING) {
        spring_back(self, frame, pull);
    } else if (self->phase == GRIPPING && is_there) {
        take_along(self, &now, params, pull);
    } else if (self->phase == LOOSE && is_there && self->is_armed) {
        pull->radius_mm = placement_face_height(&self->placement) * (float)(0.01 * params[RADIUS]);
        if (self->is_closed && frame->near)
            grip(self, &now, pull);
        else
            probe(&now, pull);
    }
    return MRT_OK;
}

/* ---- resume ---- */

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.tongs",
                         .version = 1,
                         .parts = {
                             CLUTCH_MEMORY(self->clutch),
                             PLACEMENT_MEMORY(self->placement),
                             MEMORY_BOOLS(self->is_armed),
                             MEMORY_BOOLS(self->is_closed),
                             MEMORY_BOOLS(self->was_there),
                             MEMORY_WHOLES(self->phase, SPRINGING),
                             MEMORY_WHOLES(self->side, MRT_NO_HAND),
                             MEMORY_FLOATS(self->middle),
                             MEMORY_FLOATS(self->half),
                             MEMORY_FLOATS(self->last_middle),
                             MEMORY_FLOATS(self->last_half),
                             MEMORY_FLOATS(self->way),
                             MEMORY_DOUBLES(self->sprung),
                         }};
}

MEMORY_RESUME(memory_of);

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    PLACEMENT_PARAMS_WITH(0, 0, 90, 40, 92, 50, -45),
    {12, 0, "Gain", "Pull", "", "Movement of the face for a movement of 1 of the tongs.",
     0, 4, 0.8, NULL},
    {13, 0, "Radius", "Pull", "%",
     "Support radius of each tip, in per cent of the face's height. Read at each grip.",
     2, 200, 24, NULL},
    {14, 0, "Reach", "Pull", "%",
     "Soft limit of a pull, in per cent of the radius.", 1, 60, 20, NULL},
    {15, 0, "Stretch", "Pull", "", "Stretch of the face when the tongs open by 1.",
     0, 4, 0.8, NULL},
    {16, 0, "Close", "Tongs", "%",
     "Distance of the tips below which the tongs grip, in per cent of the palm's length.",
     5, 150, 40, NULL},
    {17, 0, "Open", "Tongs", "%",
     "Distance of the tips above which the tongs let go, in per cent of the palm's length.",
     5, 200, 90, NULL},
    CLUTCH_PARAMS_WITH(1),
};
/* clang-format on */

static const mrt_mapping mapping = {activate, mapping_deactivate, reset, process};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.tongs",
    "Tongs",
    "1.0",
    "Thumb and index finger grip the face, pull and stretch it, and let it go.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
