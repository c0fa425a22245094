/* Mapping: the paper's palm that covers a face, as tools for clay. Fingertips and palm push, pull,
 * smooth or grab the skin near them, each sample on the shape of the previous one. */
#include "mapping.h"
#include "placement.h"

#include <math.h>
#include <stdlib.h>

enum {
    TOOL = PLACEMENT_COUNT,
    TOOL_PEDAL,
    RADIUS,
    STRENGTH,
    LEAK,
    CLUTCH,
    PARAM_COUNT = CLUTCH + CLUTCH_COUNT
};
typedef enum tool { TOOL_PUSH = 0, TOOL_PULL, TOOL_SMOOTH, TOOL_GRAB, TOOL_COUNT } tool;

/* Fastest rate at which a smoothing hand eases the shape back, and the speed of the hand at which
 * the rate is half of that. */
static const double smooth_per_s = 8.0, smooth_heights_per_s = 0.3;
/* Smallest depth of a face, as a share of its height, so that "out of the face" is always
 * defined. */
static const float least_depth = 0.1f;

struct mrt_plugin {
    placement placement;
    mrt_vec3 centre, half; /* of the face, mm */
    clutch clutch;
    bool is_touching, was_tool_down;
    uint32_t count, who;                  /* points and hands that touched in the previous frame */
    mrt_vec3 hand[PLACEMENT_POINTS_MAX];  /* their positions */
    float slack_mm[PLACEMENT_POINTS_MAX]; /* distance of each point behind the clay */
    tool with;
    int tool, tool_shift; /* the parameter in the previous frame; steps by the pedal */
};

static mrt_plugin *create(const mrt_host *host)
{
    (void)host;
    return calloc(1, sizeof(mrt_plugin));
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    placement_activate(&self->placement, face);
    float least = 0.5f * least_depth * placement_face_height(&self->placement);
    mrt_vec3 low = face->low, high = face->high;
    self->centre =
        (mrt_vec3){0.5f * (low.x + high.x), 0.5f * (low.y + high.y), 0.5f * (low.z + high.z)};
    self->half =
        (mrt_vec3){fmaxf(0.5f * (high.x - low.x), least), fmaxf(0.5f * (high.y - low.y), least),
                   fmaxf(0.5f * (high.z - low.z), least)};
    return MRT_OK;
}

static void reset(mrt_plugin *self)
{
    placement_reset(&self->placement);
    clutch_reset(&self->clutch);
    self->is_touching = self->was_tool_down = false;
    self->count = self->who = 0;
    self->with = TOOL_PUSH;
    self->tool = self->tool_shift = 0;
}

/* ---- tools ---- */

static tool tool_now(mrt_plugin *self, const mrt_frame *frame)
{
    int chosen = (int)frame->params[TOOL], pedal = (int)frame->params[TOOL_PEDAL] - 1;
    bool is_down = pedal >= 0 && frame->pedal[pedal] > 0.5f;
    if (chosen != self->tool)
        self->tool_shift = 0;
    else if (is_down && !self->was_tool_down)
        self->tool_shift = (self->tool_shift + 1) % TOOL_COUNT;
    self->tool = chosen;
    self->was_tool_down = is_down;
    return (tool)((chosen + self->tool_shift) % TOOL_COUNT);
}

/* Returns the direction out of the face at p, as on an ellipsoid that fills its bounds. */
static mrt_vec3 outward(const mrt_plugin *self, mrt_vec3 p)
{
    mrt_vec3 c = self->centre, h = self->half;
    mrt_vec3 n = {(p.x - c.x) / (h.x * h.x), (p.y - c.y) / (h.y * h.y), (p.z - c.z) / (h.z * h.z)};
    float length = sqrtf(n.x * n.x + n.y * n.y + n.z * n.z);
    if (!(length > 0.0f))
        return (mrt_vec3){0.0f, 0.0f, 1.0f};
    return (mrt_vec3){n.x / length, n.y / length, n.z / length};
}

/* Returns the effective movement of a tool that moves by `way_mm` in its working direction. Like a
 * finger in clay, it must first return to the depth that the clay already has. */
static float advance(float *slack_mm, float way_mm)
{
    float beyond = way_mm - *slack_mm;
    *slack_mm = beyond < 0.0f ? -beyond : 0.0f;
    return beyond < 0.0f ? 0.0f : beyond;
}

/* Returns the effective part of a point's movement. Into or out of the face: straight. */
static mrt_vec3 stroke(mrt_plugin *self, uint32_t i, mrt_vec3 way)
{
    mrt_vec3 n = outward(self, self->hand[i]);
    float out = way.x * n.x + way.y * n.y + way.z * n.z, done = 0.0f;
    if (self->with == TOOL_GRAB)
        return way;
    if (self->with == TOOL_PUSH)
        done = -advance(&self->slack_mm[i], -out);
    else if (self->with == TOOL_PULL)
        done = advance(&self->slack_mm[i], out);
    return vec_scaled(done, n);
}

/* Each tool works at its point of the hand, so a tool that slips does not drift away from the
 * hand. */
static void work(mrt_plugin *self, mrt_pull *pull, const mrt_vec3 *point, float strength)
{
    for (uint32_t i = 0; i < self->count; ++i) {
        mrt_vec3 at = self->hand[i];
        mrt_vec3 done = stroke(self, i, vec_difference(point[i], at));
        mrt_vec3 end = vec_sum(at, strength, done);
        pull->vector[i] = (mrt_vector){placement_within_reach(&self->placement, at),
                                       placement_within_reach(&self->placement, end), 0};
    }
    pull->count = self->count;
}

/* Starts new touches where the hand is: a new hand or tool does not move the face. */
static void touch(mrt_plugin *self, uint32_t count, uint32_t who, tool with, const mrt_vec3 *point)
{
    bool is_same_hand = count == self->count && who == self->who;
    for (uint32_t i = 0; i < count && (!is_same_hand || with != self->with); ++i)
        self->slack_mm[i] = 0.0f;
    for (uint32_t i = 0; i < count && !is_same_hand; ++i)
        self->hand[i] = point[i];
    self->count = count;
    self->who = who;
    self->with = with;
}

/* Returns the mean speed of the touching points, in heights of the face. */
static double heights_per_s(const mrt_plugin *self, const mrt_vec3 *point, double dt_s)
{
    double sum_mm = 0.0;
    if (self->count == 0 || !(dt_s > 0.0))
        return 0.0;
    for (uint32_t i = 0; i < self->count; ++i) {
        double x = (double)point[i].x - (double)self->hand[i].x;
        double y = (double)point[i].y - (double)self->hand[i].y;
        double z = (double)point[i].z - (double)self->hand[i].z;
        sum_mm += sqrt(x * x + y * y + z * z);
    }
    return sum_mm / ((double)self->count * dt_s * (double)placement_face_height(&self->placement));
}

static float leak_of(const mrt_plugin *self, const mrt_frame *frame, double speed)
{
    const double *params = frame->params;
    if (!self->is_touching && clutch_springs_back(params + CLUTCH))
        return clutch_release_rate(params + CLUTCH);
    double leak = params[LEAK] > 0.0 ? 1.0 / params[LEAK] : 0.0;
    if (self->with == TOOL_SMOOTH && frame->near)
        leak += 0.01 * params[STRENGTH] * smooth_per_s * speed / (speed + smooth_heights_per_s);
    return (float)leak;
}

/* ---- the mapping ---- */

static uint32_t present(const mrt_frame *frame)
{
    return (frame->hand[MRT_LEFT].present ? 1u : 0u) | (frame->hand[MRT_RIGHT].present ? 2u : 0u);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    mrt_vec3 point[PLACEMENT_POINTS_MAX];
    const double *params = frame->params;
    uint32_t count = placement_points(&self->placement, frame, point);
    clutch_events events = clutch_step(&self->clutch, frame, params + CLUTCH);
    tool with = tool_now(self, frame);
    if (events.release || events.engage) {
        self->is_touching = events.engage && !events.release;
        self->count = 0;
    }
    touch(self, self->is_touching ? count : 0, present(frame), with, point);
    work(self, pull, point, (float)(0.01 * params[STRENGTH]));
    pull->mode = MRT_UNANCHORED;
    pull->gate = 1;
    pull->commit += events.commit;
    pull->radius_mm = placement_face_height(&self->placement) * (float)(0.01 * params[RADIUS]);
    pull->leak_per_s = leak_of(self, frame, heights_per_s(self, point, frame->dt_s));
    for (uint32_t i = 0; i < self->count; ++i)
        self->hand[i] = point[i];
    return MRT_OK;
}

/* ---- resume ---- */

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.sculpt",
                         .version = 1,
                         .parts = {
                             CLUTCH_MEMORY(self->clutch),
                             PLACEMENT_MEMORY(self->placement),
                             MEMORY_BOOLS(self->is_touching),
                             MEMORY_BOOLS(self->was_tool_down),
                             MEMORY_WHOLES(self->count, PLACEMENT_POINTS_MAX),
                             MEMORY_WHOLES(self->who, 3),
                             MEMORY_FLOATS(self->hand),
                             MEMORY_FLOATS(self->slack_mm),
                             MEMORY_WHOLES(self->with, TOOL_COUNT - 1),
                             MEMORY_WHOLES(self->tool, TOOL_COUNT - 1),
                             MEMORY_WHOLES(self->tool_shift, TOOL_COUNT - 1),
                         }};
}

MEMORY_RESUME(memory_of);

static const char *const tool_labels[] = {"Push", "Pull", "Smooth", "Grab", NULL};

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    PLACEMENT_PARAMS_WITH(1, 1, 85, 78, 80, 50, 0),
    {12, MRT_PARAM_STEPPED, "Tool", "Tool", "",
     "Push: only deeper motion into the face. Pull: only out of it. "
     "Smooth: ease back near the moving hand. Grab: all motion.",
     0, TOOL_COUNT - 1, 0, tool_labels},
    {13, MRT_PARAM_STEPPED, "Tool pedal", "Tool", "", "Pedal that selects the next tool.",
     0, 4, 0, clutch_pedal_labels},
    {14, 0, "Radius", "Tool", "%",
     "Support radius of each point, in per cent of the face's height.", 2, 200, 30, NULL},
    {15, 0, "Strength", "Tool", "%",
     "Share of the hand's motion that the clay follows; when smoothing, speed of easing back.",
     0, 200, 80, NULL},
    {16, 0, "Leak", "Tool", "s",
     "Time in which the shape eases back to its base by itself. 0: never, like clay.",
     0, 60, 0, NULL},
    CLUTCH_PARAMS,
};
/* clang-format on */

static const mrt_mapping mapping = {activate, mapping_deactivate, reset, process};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {NULL, NULL}};
static const mrt_plugin_type sculpt = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.sculpt",
    "Sculpt",
    "1.0",
    "Palm and fingertips push, pull, smooth or grab the face like clay.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&sculpt, NULL};
