/* The paper's anchored mapping: at engage each fingertip grips the point of the face where it is.
 * After that it moves this point by its own displacement since engage. */
#include "mapping.h"
#include "placement.h"

#include <math.h>
#include <stdlib.h>

enum {
    GAIN = PLACEMENT_COUNT,
    RADIUS,
    REACH,
    GATE,
    LEAK,
    SOLVER,
    CLUTCH = SOLVER + SOLVER_COUNT,
    CONTACTS = CLUTCH + CLUTCH_COUNT, /* right thumb .. little, then the left hand's */
    PARAM_COUNT = CONTACTS + 10
};
enum { FINGERS = 5, CONTACT_MOST = 256 };

typedef enum phase { LOOSE = 0, SEEKING, HOLDING, SPRINGING } phase;

/* The paper does not limit a pull. Beyond this many heights of the face a hand counts as lost,
 * because the host would reject the pull (plugin.h: ten sizes). */
static const float paper_reach = 4.0f;

struct mrt_plugin {
    const mrt_host *host;
    const mrt_face *face;
    placement placement;
    clutch clutch;
    phase phase;
    uint32_t count;                           /* of points held */
    mrt_vec3 reference[PLACEMENT_POINTS_MAX]; /* reference of each hand point */
    mrt_vec3 let_go[PLACEMENT_POINTS_MAX];    /* springing back: displacement at release */
    uint32_t leader[PLACEMENT_POINTS_MAX];    /* group of each point (placement_share) */
    double spring_s;                          /* since release */
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

/* Returns d limited to reach: d (1 + (|d| / reach)^4)^(-1/4), smooth, and nearly d for short d. */
static mrt_vec3 limited(mrt_vec3 d, float reach_mm)
{
    float q = (d.x * d.x + d.y * d.y + d.z * d.z) / (reach_mm * reach_mm);
    float s = 1.0f / sqrtf(sqrtf(1.0f + q * q));
    return vec_scaled(s, d);
}

/* Returns d truncated at reach, and unchanged if shorter. */
static mrt_vec3 cut_off(mrt_vec3 d, float reach_mm)
{
    float length_mm = sqrtf(d.x * d.x + d.y * d.y + d.z * d.z);
    float s = length_mm > reach_mm ? reach_mm / length_mm : 1.0f;
    return vec_scaled(s, d);
}

/* Finds the contact that each point pulls, 1 + its index; 0: the point where the finger is. Points
 * as from placement_points. */
static void find_contacts(const mrt_plugin *self, const mrt_frame *frame, uint32_t count,
                          uint32_t out_contact[PLACEMENT_POINTS_MAX])
{
    for (uint32_t i = 0; i < count; ++i)
        out_contact[i] = 0;
    uint32_t first = 0;
    uint32_t per_hand = FINGERS + (frame->params[PLACEMENT_PALM] > 0.5 ? MRT_PALM : 0);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        if (!placement_pulls(frame, side))
            continue;
        const double *wanted = frame->params + CONTACTS + (side == MRT_RIGHT ? 0 : FINGERS);
        for (uint32_t finger = 0; finger < FINGERS && first + finger < count; ++finger)
            if (wanted[finger] <= (double)self->face->contact_count)
                out_contact[first + finger] = (uint32_t)wanted[finger];
        first += per_hand;
    }
}

static mrt_vector vector_at(const mrt_plugin *self, mrt_vec3 point, uint32_t contact)
{
    mrt_vec3 start = contact ? self->face->contacts[contact - 1].rest : point;
    return (mrt_vector){start, start, contact};
}

static bool has_other_contacts(const mrt_pull *pull, const uint32_t *contact, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (pull->vector[i].contact != contact[i])
            return true;
    return false;
}

/* Groups the points with the current radius. A finger linked to a contact is not grouped. */
static void share_places(mrt_plugin *self, const mrt_pull *pull, const mrt_vec3 *point,
                         const uint32_t *contact, uint32_t count)
{
    mrt_vec3 free_point[PLACEMENT_POINTS_MAX];
    uint32_t index[PLACEMENT_POINTS_MAX], leader[PLACEMENT_POINTS_MAX], free_count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        self->leader[i] = i;
        if (contact[i])
            continue;
        free_point[free_count] = point[i];
        index[free_count++] = i;
    }
    placement_share(&self->placement, self->host, free_point, free_count, pull->radius_mm, leader);
    for (uint32_t k = 0; k < free_count; ++k)
        self->leader[index[k]] = index[leader[k]];
}

/* Engages: the new starts are the current positions of the hand, so the face does not jump. */
static void take_hold(mrt_plugin *self, mrt_pull *pull, mrt_vec3 *point, const uint32_t *contact,
                      uint32_t count)
{
    share_places(self, pull, point, contact, count);
    placement_blend(point, count, self->leader);
    for (uint32_t i = 0; i < count; ++i) {
        self->reference[i] = point[i];
        pull->vector[i] = vector_at(self, point[i], contact[i]);
    }
    self->count = pull->count = count;
    self->phase = HOLDING;
    pull->mode = MRT_ANCHORED;
    pull->anchor += 1;
}

static void probe(const mrt_plugin *self, mrt_pull *pull, const mrt_vec3 *point,
                  const uint32_t *contact, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        pull->vector[i] = vector_at(self, point[i], contact[i]);
    pull->count = count;
    pull->mode = MRT_IDLE;
}

/* The reference follows the hand with time constant leak_s, so a held pull eases away. */
static void leak(mrt_plugin *self, const mrt_vec3 *point, double leak_s, double dt_s)
{
    float part = (float)smoothing_share(dt_s, leak_s);
    for (uint32_t i = 0; i < self->count; ++i) {
        mrt_vec3 d = vec_difference(point[i], self->reference[i]);
        self->reference[i] = vec_sum(self->reference[i], part, d);
    }
}

static void hold(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull, mrt_vec3 *point)
{
    placement_blend(point, self->count, self->leader);
    const double *params = frame->params;
    bool is_paper = solver_is_paper(params + SOLVER);
    float gain = is_paper ? 1.0f : (float)params[GAIN];
    float reach_mm = is_paper ? paper_reach * placement_face_height(&self->placement)
                              : pull->radius_mm * (float)(0.01 * params[REACH]);
    if (params[LEAK] > 0.0 && frame->dt_s > 0.0)
        leak(self, point, params[LEAK], frame->dt_s);
    for (uint32_t i = 0; i < self->count; ++i) {
        mrt_vec3 d = vec_scaled(gain, vec_difference(point[i], self->reference[i]));
        mrt_vector *vector = &pull->vector[i];
        d = is_paper ? cut_off(d, reach_mm) : limited(d, reach_mm);
        vector->end = vec_sum(vector->start, 1.0f, d);
    }
}

static void let_go(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *pull)
{
    bool springs = clutch_springs_back(frame->params + CLUTCH);
    self->phase = springs && self->phase == HOLDING ? SPRINGING : LOOSE;
    self->spring_s = 0.0;
    for (uint32_t i = 0; i < self->count; ++i)
        self->let_go[i] = vec_difference(pull->vector[i].end, pull->vector[i].start);
}

/* Minimum-jerk movement back to the starts. */
static void spring_back(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    self->spring_s += frame->dt_s;
    double t = self->spring_s / frame->params[CLUTCH + CLUTCH_RELEASE_TIME];
    float rest = (float)(1.0 - minimum_jerk(t));
    for (uint32_t i = 0; i < self->count; ++i)
        pull->vector[i].end = vec_sum(pull->vector[i].start, rest, self->let_go[i]);
    if (t >= 1.0)
        self->phase = LOOSE;
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    self->face = face;
    placement_activate(&self->placement, face);
    return MRT_OK;
}

static void reset(mrt_plugin *self)
{
    placement_reset(&self->placement);
    clutch_reset(&self->clutch);
    self->phase = LOOSE;
    self->count = 0;
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    mrt_vec3 point[PLACEMENT_POINTS_MAX];
    uint32_t contact[PLACEMENT_POINTS_MAX];
    const double *params = frame->params;
    uint32_t count = placement_points(&self->placement, frame, point);
    if (count == 0 && self->phase != SPRINGING)
        return MRT_HOLD;
    clutch_events events = clutch_step(&self->clutch, frame, params + CLUTCH);
    bool is_gated = params[GATE] > 0.5;
    if (self->phase != HOLDING && self->phase != SPRINGING)
        solver_set(pull, params + SOLVER,
                   placement_face_height(&self->placement) * (float)(0.01 * params[RADIUS]));
    pull->gate = is_gated;
    if (events.commit) {
        pull->commit += 1;
        events.engage = true;
    }
    find_contacts(self, frame, count, contact);
    bool has_changed =
        self->phase == HOLDING && /* a hand appeared or disappeared, or a finger was linked */
        (count != self->count || has_other_contacts(pull, contact, count));
    if (events.release)
        let_go(self, frame, pull);
    else if (events.engage || has_changed)
        self->phase = SEEKING;

    if (self->phase == SEEKING && count > 0) {
        if (!is_gated || has_changed || frame->near)
            take_hold(self, pull, point, contact, count);
        else
            probe(self, pull, point, contact, count);
    } else if (self->phase == HOLDING) {
        hold(self, frame, pull, point);
    } else if (self->phase == SPRINGING) {
        spring_back(self, frame, pull);
    }
    return MRT_OK;
}

/* ---- resume ---- */

enum { MEMORY_VERSION = 2 };

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.anchored",
                         .version = MEMORY_VERSION,
                         .parts = {
                             CLUTCH_MEMORY(self->clutch),
                             PLACEMENT_MEMORY(self->placement),
                             MEMORY_WHOLES(self->phase, SPRINGING),
                             MEMORY_WHOLES(self->count, PLACEMENT_POINTS_MAX),
                             MEMORY_FLOATS(self->reference),
                             MEMORY_FLOATS(self->let_go),
                             MEMORY_WHOLES(self->leader, PLACEMENT_POINTS_MAX - 1),
                             MEMORY_DOUBLES(self->spring_s),
                         }};
}

MEMORY_RESUME(memory_of);

/* clang-format off */
#define CONTACT_PARAM(id, hand, finger)                                                            \
    {id, MRT_PARAM_STEPPED, hand " " finger, "Contacts", "",                                       \
     "Contact that this finger pulls. 0: the point of the face that it touches.",             \
     0, CONTACT_MOST, 0, NULL}
static const mrt_param params[PARAM_COUNT] = {
    PLACEMENT_PARAMS,
    {12, 0, "Gain", "Pull", "", "Movement of the face for a movement of 1 of the hand.",
     0, 4, 0.6, NULL},
    {13, 0, "Radius", "Pull", "%",
     "Support radius of each point, in per cent of the face's height. Read at engage.",
     2, 200, 25, NULL},
    {14, 0, "Reach", "Pull", "%",
     "Soft limit of a pull, in per cent of the radius. Above 47 the surface folds.",
     1, 100, 30, NULL},
    {15, MRT_PARAM_STEPPED, "Gate", "Pull", "",
     "Engage a point only when the face is within its radius.", 0, 1, 1, placement_off_on_labels},
    {16, 0, "Leak", "Pull", "s",
     "Time in which a held pull eases back to the base shape. 0: never.", 0, 60, 0, NULL},
    SOLVER_PARAMS,
    CLUTCH_PARAMS,
    CONTACT_PARAM(30, "Right", "thumb"),
    CONTACT_PARAM(31, "Right", "index"),
    CONTACT_PARAM(32, "Right", "middle"),
    CONTACT_PARAM(33, "Right", "ring"),
    CONTACT_PARAM(34, "Right", "little"),
    CONTACT_PARAM(35, "Left", "thumb"),
    CONTACT_PARAM(36, "Left", "index"),
    CONTACT_PARAM(37, "Left", "middle"),
    CONTACT_PARAM(38, "Left", "ring"),
    CONTACT_PARAM(39, "Left", "little"),
};
/* clang-format on */

static const mrt_mapping mapping = {activate, mapping_deactivate, reset, process};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {NULL, NULL}};
static const mrt_plugin_type anchored = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.anchored",
    "Anchored",
    "1.0",
    "Each fingertip grips a point of the face and pulls it.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&anchored, NULL};
