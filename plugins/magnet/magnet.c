/* Mapping: bending the fingers charges a large magnet in front of the face that draws the skin out
 * or drives it in. The wrist moves the magnet. The hand's movement is relative to its pose at
 * engage. */
#include "mapping.h"

#include <math.h>
#include <stdlib.h>

enum {
    HAND,
    FIST,
    ACROSS,
    UP,
    RADIUS,
    STRENGTH,
    INWARD,
    GATHER,
    TRAVEL,
    WANDER,
    EASE,
    CLUTCH,
    PARAM_COUNT = CLUTCH + CLUTCH_COUNT
};
enum { WRIST_PITCH = 20, WRIST_YAW = 21, GRID = 6, POINTS_MAX = MRT_MAX_VECTORS };
static const double rad_per_deg = 0.017453292519943295;

typedef struct magnet {
    double strength; /* -1 .. 1: drives in .. draws out */
    double x, y;     /* from the position of the parameters, in heights of the face */
} magnet;

typedef struct held { /* the pose of a hand */
    double bend, pitch, yaw;
} held;

struct mrt_plugin {
    mrt_vec3 low, size; /* of the face, mm */
    uint32_t count;
    mrt_vec3 point[POINTS_MAX]; /* points of the field: contacts, or a grid in front of a face
                                   without contacts */
    uint32_t contact[POINTS_MAX];
    clutch clutch;
    bool is_engaged, has_neutral, has_held;
    held neutral;
    magnet shown;
};

static mrt_plugin *create(const mrt_host *host)
{
    (void)host;
    return calloc(1, sizeof(mrt_plugin));
}

/* ---- points of the field ---- */

/* Points on the front of an ellipsoid that fills the bounds. */
static void lay_grid(mrt_plugin *self)
{
    for (int row = 0; row < GRID; ++row)
        for (int column = 0; column < GRID; ++column) {
            float x = ((float)column + 0.5f) / GRID - 0.5f, y = ((float)row + 0.5f) / GRID - 0.5f;
            float beyond = 1.0f - 4.0f * (x * x + y * y);
            float z = 0.5f * sqrtf(beyond > 0.0f ? beyond : 0.0f);
            self->point[self->count] = (mrt_vec3){self->low.x + (0.5f + x) * self->size.x,
                                                  self->low.y + (0.5f + y) * self->size.y,
                                                  self->low.z + (0.5f + z) * self->size.z};
            self->contact[self->count++] = 0;
        }
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    self->low = face->low;
    self->size = vec_difference(face->high, face->low);
    self->count = 0;
    for (uint32_t i = 0; i < face->contact_count && self->count < POINTS_MAX; ++i) {
        self->point[self->count] = face->contacts[i].rest;
        self->contact[self->count++] = i + 1;
    }
    if (self->count == 0)
        lay_grid(self);
    return MRT_OK;
}

static void reset(mrt_plugin *self)
{
    clutch_reset(&self->clutch);
    self->is_engaged = self->has_neutral = self->has_held = false;
    self->neutral = (held){0, 0, 0};
    self->shown = (magnet){0, 0, 0};
}

static double height_of(const mrt_plugin *self)
{
    return self->size.y > 1.0f ? (double)self->size.y : 1.0;
}

/* ---- the magnet follows the hand ---- */

static magnet wanted(const mrt_plugin *self, const held *now, const double *params)
{
    double charge = (now->bend - self->neutral.bend) / (rad_per_deg * params[TRAVEL]);
    double per_rad = 0.01 * params[WANDER] / (30.0 * rad_per_deg);
    return (magnet){
        .strength = soft_limit(params[FIST] < 0.5 ? charge : -charge, 1.0),
        .x = soft_limit(per_rad * (now->yaw - self->neutral.yaw), 0.5),
        .y = soft_limit(per_rad * (self->neutral.pitch - now->pitch), 0.5),
    };
}

static void follow(magnet *shown, const magnet *to, double share)
{
    shown->strength += share * (to->strength - shown->strength);
    shown->x += share * (to->x - shown->x);
    shown->y += share * (to->y - shown->y);
}

/* ---- the field ---- */

/* Wendland's C2 function: 1 in the middle, 0 from 1 on. */
static double bump(double r)
{
    double rest = r < 1.0 ? 1.0 - r : 0.0;
    return rest * rest * rest * rest * (4.0 * r + 1.0);
}

/* Displacement of a point: out of the face, and in part to the magnet's axis. */
static mrt_vec3 drawn(const mrt_plugin *self, mrt_vec3 at, const double *params)
{
    double height = height_of(self), radius = 0.01 * params[RADIUS] * height;
    double x = (double)at.x - (double)self->low.x - 0.01 * params[ACROSS] * (double)self->size.x;
    double y = (double)at.y - (double)self->low.y - 0.01 * params[UP] * (double)self->size.y;
    x -= self->shown.x * height;
    y -= self->shown.y * height;
    double felt = bump(sqrt(x * x + y * y) / radius) * self->shown.strength;
    if (self->shown.strength < 0.0)
        felt *= 0.01 * params[INWARD];
    double out_mm = felt * 0.01 * params[STRENGTH] * height;
    double aside = -0.01 * params[GATHER] * felt;
    return (mrt_vec3){(float)(aside * x), (float)(aside * y), (float)out_mm};
}

static void write_field(const mrt_plugin *self, const double *params, mrt_pull *pull)
{
    mrt_vector vector[POINTS_MAX];
    for (uint32_t i = 0; i < self->count; ++i) {
        mrt_vec3 start = self->point[i], way = drawn(self, start, params);
        vector[i] = (mrt_vector){start, vec_sum(start, 1.0f, way), self->contact[i]};
    }
    mapping_pull(pull, vector, self->count, (float)(0.01 * params[RADIUS] * height_of(self)));
}

/* ---- the mapping ---- */

/* Makes the current shape the base, without a displacement. */
static void commit(mrt_plugin *self, mrt_pull *pull)
{
    pull->commit += 1;
    pull->anchor += 1;
    self->shown.strength = 0.0;
}

static void apply_events(mrt_plugin *self, const clutch_events *events)
{
    if (events->engage || events->commit) {
        self->is_engaged = true;
        self->has_neutral = false;
    }
    if (events->release)
        self->is_engaged = false;
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const double *params = frame->params;
    const mrt_hand *hand = performing_hand(frame, params[HAND]);
    clutch_events events = clutch_step(&self->clutch, frame, params + CLUTCH);
    apply_events(self, &events);
    self->has_held = self->has_held || (self->is_engaged && hand);
    if (!self->has_held)
        return MRT_HOLD;
    if (events.commit)
        commit(self, pull);
    magnet to = self->shown;
    double time_s = params[EASE];
    if (self->is_engaged && hand) {
        held now = {finger_bend(hand), (double)hand->angle[WRIST_PITCH],
                    (double)hand->angle[WRIST_YAW]};
        if (!self->has_neutral)
            self->neutral = now;
        self->has_neutral = true;
        to = wanted(self, &now, params);
    } else if (!self->is_engaged && clutch_springs_back(params + CLUTCH)) {
        to.strength = 0.0;
        time_s =
            params[CLUTCH + CLUTCH_RELEASE_TIME] / 3.0; /* after 3 time constants 95 % are gone */
    }
    follow(&self->shown, &to, smoothing_share(frame->dt_s, time_s));
    write_field(self, params, pull);
    return MRT_OK;
}

/* ---- resume ---- */

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.magnet",
                         .version = 1,
                         .parts = {
                             CLUTCH_MEMORY(self->clutch),
                             MEMORY_BOOLS(self->is_engaged),
                             MEMORY_BOOLS(self->has_neutral),
                             MEMORY_BOOLS(self->has_held),
                             MEMORY_DOUBLES(self->neutral),
                             MEMORY_DOUBLES(self->shown),
                         }};
}

MEMORY_RESUME(memory_of);

static const char *const fist_labels[] = {"Draws out", "Drives in", NULL};

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    PERFORMING_HAND_PARAM(1),
    {2, MRT_PARAM_STEPPED, "Fist", "Magnet", "",
     "Effect of bending the fingers; stretching them has the opposite effect.",
     0, 1, 0, fist_labels},
    {3, 0, "Across", "Magnet", "%",
     "Position of the magnet: 0 the subject's right edge of the face, 100 the left.",
     0, 100, 50, NULL},
    {4, 0, "Up", "Magnet", "%",
     "Position of the magnet: 0 the lower edge of the face, 100 the top.",
     0, 100, 50, NULL},
    {5, 0, "Radius", "Magnet", "%", "Radius of the magnet, in per cent of the face's height.",
     10, 200, 55, NULL},
    {6, 0, "Strength", "Magnet", "%",
     "Largest movement of the face, in per cent of its height.", 0, 30, 10, NULL},
    {11, 0, "Inward", "Magnet", "%",
     "Strength when the magnet pushes inwards, where the teeth and eyes are.",
     0, 100, 20, NULL},
    {7, 0, "Gather", "Magnet", "%",
     "Pull of the points around the magnet to its axis, in per cent of their distance.",
     0, 40, 10, NULL},
    {8, 0, "Travel", "Hand", "deg",
     "Mean bend of the finger joints for most of the strength.",
     5, 120, 35, NULL},
    {9, 0, "Wander", "Hand", "%",
     "Movement of the magnet when the wrist turns by 30 deg, in per cent of the face's height.",
     0, 200, 40, NULL},
    {10, 0, "Ease", "Hand", "s", "Time in which the magnet follows the hand.", 0.02, 2, 0.06, NULL},
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
    "org.marotte.magnet",
    "Magnet",
    "1.0",
    "Bending the fingers charges one large magnet that draws the face out or in.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
