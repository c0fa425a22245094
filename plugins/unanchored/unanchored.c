/* The paper's unanchored mapping: fingertips near the face move the skin along, in each sample by
 * their own movement. The change stays, as in clay. */
#include "mapping.h"
#include "placement.h"

#include <math.h>
#include <stdlib.h>

enum {
    GAIN = PLACEMENT_COUNT,
    RADIUS,
    GATE,
    LEAK,
    SOLVER,
    CLUTCH = SOLVER + SOLVER_COUNT,
    PARAM_COUNT = CLUTCH + CLUTCH_COUNT
};

struct mrt_plugin {
    const mrt_host *host;
    placement placement;
    clutch clutch;
    bool is_touching;
    uint32_t count;
    mrt_vec3 hand[PLACEMENT_POINTS_MAX];   /* points of the hand in the previous frame */
    uint32_t leader[PLACEMENT_POINTS_MAX]; /* group of each point (placement_share) */
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
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
    self->is_touching = false;
    self->count = 0;
}

/* Starts the points of the pull at the hand's position: the first frame of a touch does not move
 * the face. */
static void touch(mrt_plugin *self, mrt_pull *pull, mrt_vec3 *point, uint32_t count)
{
    placement_share(&self->placement, self->host, point, count, pull->radius_mm, self->leader);
    placement_blend(point, count, self->leader);
    for (uint32_t i = 0; i < count; ++i) {
        mrt_vec3 p = placement_within_reach(&self->placement, point[i]);
        pull->vector[i] = (mrt_vector){p, p, 0};
    }
    self->count = count;
    self->is_touching = true;
}

/* Moves each point from its last end by the hand's movement times gain. */
static void drag(const mrt_plugin *self, mrt_pull *pull, const mrt_vec3 *point, float gain)
{
    for (uint32_t i = 0; i < self->count; ++i) {
        mrt_vector *v = &pull->vector[i];
        mrt_vec3 end = vec_sum(v->end, gain, vec_difference(point[i], self->hand[i]));
        v->start = v->end;
        v->end = placement_within_reach(&self->placement, end);
    }
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    mrt_vec3 point[PLACEMENT_POINTS_MAX];
    const double *params = frame->params;
    uint32_t count = placement_points(&self->placement, frame, point);
    clutch_events events = clutch_step(&self->clutch, frame, params + CLUTCH);
    pull->mode = MRT_UNANCHORED;
    pull->gate = params[GATE] > 0.5;
    solver_set(pull, params + SOLVER,
               placement_face_height(&self->placement) * (float)(0.01 * params[RADIUS]));
    pull->commit += events.commit;
    if (events.release)
        self->is_touching = false;
    else if (count > 0 && (events.engage || (self->is_touching && count != self->count)))
        touch(self, pull, point, count);
    else if (self->is_touching && count > 0) {
        placement_blend(point, count, self->leader);
        drag(self, pull, point, solver_is_paper(params + SOLVER) ? 1.0f : (float)params[GAIN]);
    }
    for (uint32_t i = 0; i < count; ++i)
        self->hand[i] = point[i];

    pull->count = self->is_touching && count > 0 ? self->count : 0;
    pull->leak_per_s = params[LEAK] > 0.0 ? (float)(1.0 / params[LEAK]) : 0.0f;
    if (!self->is_touching && clutch_springs_back(params + CLUTCH))
        pull->leak_per_s = clutch_release_rate(params + CLUTCH);
    return MRT_OK;
}

/* ---- resume ---- */

enum { MEMORY_VERSION = 2 };

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.unanchored",
                         .version = MEMORY_VERSION,
                         .parts = {
                             CLUTCH_MEMORY(self->clutch),
                             PLACEMENT_MEMORY(self->placement),
                             MEMORY_BOOLS(self->is_touching),
                             MEMORY_WHOLES(self->count, PLACEMENT_POINTS_MAX),
                             MEMORY_FLOATS(self->hand),
                             MEMORY_WHOLES(self->leader, PLACEMENT_POINTS_MAX - 1),
                         }};
}

MEMORY_RESUME(memory_of);

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    PLACEMENT_PARAMS,
    {12, 0, "Gain", "Pull", "", "Movement of the points for a movement of 1 of the hand.",
     0, 4, 0.35, NULL},
    {13, 0, "Radius", "Pull", "%",
     "Support radius of each point, in per cent of the face's height.", 2, 200, 25, NULL},
    {14, MRT_PARAM_STEPPED, "Gate", "Pull", "",
     "Move the face only while a point is within its radius of it.",
     0, 1, 1, placement_off_on_labels},
    {15, 0, "Leak", "Pull", "s",
     "Time in which the shape eases back to its base. 0: never, like clay.", 0, 60, 0, NULL},
    SOLVER_PARAMS,
    CLUTCH_PARAMS,
};
/* clang-format on */

static const mrt_mapping mapping = {activate, mapping_deactivate, reset, process};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {NULL, NULL}};
static const mrt_plugin_type unanchored = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.unanchored",
    "Unanchored",
    "1.0",
    "Fingertips move the skin near them, and it stays there like clay.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&unanchored, NULL};
