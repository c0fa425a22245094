/* Mapping: four learned hand gestures trigger actions of the face, such as a blink, a nod or a
 * smile. It recognises the nearest gesture when the hand has held it for a moment. */
#include "expressions.h"
#include "mapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- recogniser: finds the nearest learned gesture when the hand has held it for a moment, and
 * keeps the recent hand poses for teaching. + - * / and sqrt only ---- */

enum { GESTURES = 4, NO_GESTURE = GESTURES, RECOGNISER_WINDOW = 64 };

typedef struct centroid {
    float angle[MRT_ANGLES]; /* rad */
} centroid;

typedef struct recogniser {
    centroid taught[GESTURES];
    float past[RECOGNISER_WINDOW][MRT_ANGLES]; /* ring of samples */
    double past_s[RECOGNISER_WINDOW];          /* of each */
    unsigned at, filled;                       /* next index to write; number of samples */
    double now_s;                              /* since reset */
    unsigned current, candidate;               /* gestures; NO_GESTURE: none */
    double candidate_s;                        /* time for which it has been held */
} recogniser;

/* For a memory_list. */
#define RECOGNISER_MEMORY(of)                                                                      \
    MEMORY_FLOATS((of).taught), MEMORY_FLOATS((of).past), MEMORY_DOUBLES((of).past_s),             \
        MEMORY_WHOLES((of).at, RECOGNISER_WINDOW - 1),                                             \
        MEMORY_WHOLES((of).filled, RECOGNISER_WINDOW), MEMORY_DOUBLES((of).now_s),                 \
        MEMORY_WHOLES((of).current, NO_GESTURE), MEMORY_WHOLES((of).candidate, NO_GESTURE),        \
        MEMORY_DOUBLES((of).candidate_s)

/* Teaching stores the mean of the last 0.3 s, from samples at least 5 ms apart. */
static const double window_s = 0.3, apart_s = 0.005;
/* Weights: thumb, palm and spread move less than the bend of fingers. Estimated angles (distal
 * joints) and the wrist do not count. */
static const double weight[MRT_ANGLES] = {1, 1.5, 1.5, 1.5, 1, 1, 0, 1,   1, 0, 1.5,
                                          1, 1,   0,   1.5, 1, 1, 0, 1.5, 1, 0, 0};
enum { COUNTED = 16 };
static const double deg_per_rad = 57.295779513082321;

/* Default gestures: a fist, a pointing index finger, a flat spread hand, a hand with only ring and
 * little finger stretched. */
static const centroid shipped[GESTURES] = {
    {{1.90f, 0.19f, 0.59f, 0.66f,  1.26f, 1.68f, 0, 1.35f,  1.75f, 0, -0.04f,
      1.39f, 1.81f, 0,     -0.04f, 1.36f, 1.75f, 0, -0.05f, 0.13f, 0, 0}},
    {{1.44f, 0.15f, 0.20f, 0.35f,  0.0f,  0.16f, 0, 0.59f,  0.54f, 0, -0.04f,
      0.69f, 0.63f, 0,     -0.06f, 0.70f, 0.60f, 0, -0.04f, 0.12f, 0, 0}},
    {{0.74f, 0.15f, 0.20f, 0.63f, -0.05f, 0.06f, 0, 0.02f, 0.13f, 0, 0.26f,
      0.05f, 0.18f, 0,     0.21f, 0.03f,  0.15f, 0, 0.36f, 0.13f, 0, 0}},
    {{1.70f, 0.15f, 0.20f, 0.55f,  0.60f, 0.52f, 0, 0.50f,  0.45f, 0, -0.05f,
      0.09f, 0.18f, 0,     -0.05f, 0.12f, 0.15f, 0, -0.05f, 0.30f, 0, 0}},
};

static void recogniser_reset(recogniser *self, const centroid taught[GESTURES])
{
    memset(self, 0, sizeof *self);
    memcpy(self->taught, taught, sizeof self->taught);
    self->current = self->candidate = NO_GESTURE;
}

/* Computes the mean of the recent hand poses. Returns false if there was no hand. */
static bool find_mean(const recogniser *self, centroid *out)
{
    double sum[MRT_ANGLES] = {0.0}, count = 0.0;
    for (unsigned k = 1; k <= self->filled; ++k) {
        unsigned i = (self->at + RECOGNISER_WINDOW - k) % RECOGNISER_WINDOW;
        if (self->now_s - self->past_s[i] > window_s)
            break;
        for (int a = 0; a < MRT_ANGLES; ++a)
            sum[a] += (double)self->past[i][a];
        count += 1.0;
    }
    for (int a = 0; a < MRT_ANGLES && count > 0.0; ++a)
        out->angle[a] = (float)(sum[a] / count);
    return count > 0.0;
}

/* Call first in each frame; hand: NULL if not present. */
static void recogniser_watch(recogniser *self, const mrt_hand *hand, double dt_s)
{
    self->now_s += dt_s;
    unsigned last = (self->at + RECOGNISER_WINDOW - 1) % RECOGNISER_WINDOW;
    if (!hand)
        self->filled = 0;
    else if (self->filled == 0 || self->now_s - self->past_s[last] >= apart_s) {
        memcpy(self->past[self->at], hand->angle, sizeof self->past[0]);
        self->past_s[self->at] = self->now_s;
        self->at = (self->at + 1) % RECOGNISER_WINDOW;
        self->filled += self->filled < RECOGNISER_WINDOW;
    }
}

/* Learns the gesture from the hand pose of the last 0.3 s. The gesture is being made now, so it
 * only begins when it is made again. Returns false if there was no hand. */
static bool recogniser_teach(recogniser *self, unsigned gesture)
{
    centroid now;
    if (!find_mean(self, &now))
        return false;
    self->taught[gesture] = now;
    self->current = gesture;
    return true;
}

/* Returns the root mean square over the joints, deg. */
static double distance_deg(const centroid *to, const mrt_hand *hand)
{
    double sum = 0.0;
    for (int a = 0; a < MRT_ANGLES; ++a) {
        double d = weight[a] * ((double)hand->angle[a] - (double)to->angle[a]);
        sum += d * d;
    }
    return deg_per_rad * sqrt(sum / COUNTED);
}

typedef struct recogniser_limits {
    double reject_deg, leave_deg, dwell_s;
} recogniser_limits;
/* Returns the gesture that begins in this frame; NO_GESTURE: none. */
static unsigned recogniser_step(recogniser *self, const mrt_hand *hand, double dt_s,
                                const recogniser_limits *limits)
{
    unsigned nearest = NO_GESTURE;
    double least = limits->reject_deg, most = fmax(limits->leave_deg, limits->reject_deg);
    for (unsigned g = 0; g < GESTURES && hand; ++g) {
        double d = distance_deg(&self->taught[g], hand);
        if (d < least) {
            least = d;
            nearest = g;
        }
        if (g == self->current && d > most)
            self->current = NO_GESTURE;
    }
    if (!hand)
        self->current = NO_GESTURE;
    self->candidate_s = nearest == self->candidate ? self->candidate_s + dt_s : 0.0;
    self->candidate = nearest;
    if (nearest == NO_GESTURE || nearest == self->current || self->candidate_s < limits->dwell_s)
        return NO_GESTURE;
    self->current = nearest;
    return nearest;
}

/* ---- the instance ---- */

enum {
    HAND,
    TEACH,
    FORGET = TEACH + GESTURES,
    ACTION,
    ATTACK = ACTION + GESTURES,
    HOLD,
    RELEASE,
    SUSTAIN,
    AMOUNT,
    REJECT,
    LEAVE,
    DWELL,
    POSE,
    PARAM_COUNT = POSE + GESTURES
};
/* What plays: an expression, or the pose that was chosen for a gesture. */
enum { ACTIONS = EXPRESSION_COUNT + GESTURES };
typedef enum phase { QUIET = 0, RISING, HOLDING, FALLING } phase;
typedef struct envelopes { /* of each action */
    phase phase[ACTIONS];
    double progress[ACTIONS];             /* progress of the phase, 0 .. 1 */
    double from[ACTIONS], level[ACTIONS]; /* level at the start of the phase, and now: 0 .. 1 */
    unsigned gesture[ACTIONS];            /* gesture that triggered it */
} envelopes;

struct mrt_plugin {
    const mrt_host *host;
    expressions expressions;
    expression_poses poses;
    centroid stored[GESTURES]; /* default or loaded gestures: restored by a reset */
    recogniser recogniser;
    envelopes play;
};

static void reset(mrt_plugin *self)
{
    recogniser_reset(&self->recogniser, self->stored);
    memset(&self->play, 0, sizeof self->play);
}

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    memcpy(self->stored, shipped, sizeof self->stored);
    reset(self);
    return self;
}

static void set_poses(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses,
                      uint32_t count)
{
    expression_poses_set(&self->poses, face, poses, count);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    return expressions_find(&self->expressions, face, self->host) ? MRT_OK : MRT_ERR_UNSUPPORTED;
}

/* ---- teaching ---- */

static void teach(mrt_plugin *self, const double *params)
{
    static const char *const told[GESTURES] = {"gesture 1 learned", "gesture 2 learned",
                                               "gesture 3 learned", "gesture 4 learned"};
    recogniser *r = &self->recogniser;
    if (params[FORGET] > 0.5)
        memcpy(r->taught, shipped, sizeof r->taught);
    for (unsigned g = 0; g < GESTURES; ++g) {
        if (params[TEACH + g] < 0.5)
            continue;
        if (recogniser_teach(r, g))
            self->host->log(self->host, MRT_LOG_INFO, told[g]);
        else
            self->host->log(self->host, MRT_LOG_WARNING,
                            "no hand detected: hold the gesture, then press Teach");
    }
}

/* ---- performing ---- */

static void enter(envelopes *e, int which, phase to)
{
    e->phase[which] = to;
    e->progress[which] = 0.0;
    e->from[which] = e->level[which];
}

static void step(envelopes *e, int which, unsigned current, double dt_s, const double *params)
{
    static const int time_of[] = {[RISING] = ATTACK, [HOLDING] = HOLD, [FALLING] = RELEASE};
    static const phase after[] = {[RISING] = HOLDING, [HOLDING] = FALLING, [FALLING] = QUIET};
    phase now = e->phase[which];
    if (now == QUIET)
        return;
    if (now != HOLDING || params[SUSTAIN] < 0.5 || current != e->gesture[which])
        e->progress[which] += dt_s / params[time_of[now]];
    double eased = minimum_jerk(e->progress[which]);
    if (now == RISING)
        e->level[which] = e->from[which] + (1.0 - e->from[which]) * eased;
    else if (now == FALLING)
        e->level[which] = e->from[which] * (1.0 - eased);
    if (e->progress[which] >= 1.0)
        enter(e, which, after[now]);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const double *params = frame->params;
    const mrt_hand *hand = performing_hand(frame, params[HAND]);
    double part[EXPRESSION_COUNT];
    expression_played played[GESTURES];
    const recogniser_limits limits = {params[REJECT], params[LEAVE], params[DWELL]};
    recogniser_watch(&self->recogniser, hand, frame->dt_s);
    teach(self, params);
    unsigned begun = recogniser_step(&self->recogniser, hand, frame->dt_s, &limits);
    if (begun != NO_GESTURE) {
        const bool has_pose = expression_poses_find(&self->poses, params[POSE + begun]) != NULL;
        int which = has_pose ? EXPRESSION_COUNT + (int)begun : (int)params[ACTION + begun];
        enter(&self->play, which, RISING);
        self->play.gesture[which] = begun;
    }
    for (int i = 0; i < ACTIONS; ++i) {
        const double amount = 0.01 * params[AMOUNT];
        step(&self->play, i, self->recogniser.current, frame->dt_s, params);
        if (i < EXPRESSION_COUNT)
            part[i] = amount * self->play.level[i];
        else
            played[i - EXPRESSION_COUNT] = (expression_played){
                expression_poses_find(&self->poses, params[POSE + i - EXPRESSION_COUNT]),
                amount * self->play.level[i]};
    }
    expressions_write(&self->expressions, part, &self->poses, played, GESTURES, pull);
    return MRT_OK;
}

/* ---- storing the gestures ---- */

static memory_list list_of(centroid all[GESTURES])
{
    return (memory_list){.type = "org.marotte.gesture/taught",
                         .version = 1,
                         .parts = {{MEMORY_FLOAT, all, GESTURES * sizeof *all, (double)FLT_MAX}}};
}

static size_t save_taught(mrt_plugin *self, void *out, size_t capacity)
{
    const memory_list list = list_of(self->recogniser.taught);
    return memory_save(&list, out, capacity);
}

static mrt_result load_taught(mrt_plugin *self, const void *bytes, size_t size)
{
    const memory_list list = list_of(self->stored);
    if (!memory_load(&list, bytes, size)) {
        self->host->log(self->host, MRT_LOG_ERROR,
                        "the stored gestures are damaged: teach them again");
        return MRT_ERR_FORMAT;
    }
    memcpy(self->recogniser.taught, self->stored, sizeof self->stored);
    return MRT_OK;
}

static mrt_result pose(const void *bytes, size_t size, uint32_t param, float *out_rad)
{
    centroid all[GESTURES];
    const memory_list list = list_of(all);
    const unsigned teach_id = 2, gesture = param - teach_id;
    if (!memory_load(&list, bytes, size))
        return MRT_ERR_FORMAT;
    if (param < teach_id || gesture >= GESTURES)
        return MRT_END;
    memcpy(out_rad, all[gesture].angle, sizeof all[gesture].angle);
    return MRT_OK;
}

/* ---- resume ---- */

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.gesture",
                         .version = 2,
                         .parts = {
                             MEMORY_FLOATS(self->stored),
                             RECOGNISER_MEMORY(self->recogniser),
                             MEMORY_WHOLES(self->play.phase, FALLING),
                             MEMORY_DOUBLES(self->play.progress),
                             MEMORY_DOUBLES(self->play.from),
                             MEMORY_DOUBLES(self->play.level),
                             MEMORY_WHOLES(self->play.gesture, GESTURES - 1),
                         }};
}

MEMORY_RESUME(memory_of);

static const char *const off_on[] = {"Off", "On", NULL};
static const char *const action_labels[EXPRESSION_COUNT + 1] = {
    "Nothing", "Smile", "Frown", "Jaw drop", "Brows up", "Brows down",
    "Pucker",  "Blink", "Wink",  "Nod",      NULL};

#define TEACH_PARAM(id, name, what)                                                                \
    {                                                                                              \
        id, MRT_PARAM_TRIGGER, name, "Teach", "",                                                  \
            "Learn this gesture from the hand pose of the last 0.3 s. Default: " what ".", 0, 1,   \
            0, NULL                                                                                \
    }
#define POSE_PARAM(id, name)                                                                       \
    {                                                                                              \
        id, MRT_PARAM_STEPPED | MRT_PARAM_POSE, name, "Pose", "",                                  \
            "Pose of the rig for this gesture, instead of its action.", 0, MRT_POSE_VALUES, 0,     \
            NULL                                                                                   \
    }
#define ACTION_PARAM(id, name, initial)                                                            \
    {                                                                                              \
        id, MRT_PARAM_STEPPED, name, "Action", "", "Action of the face for this gesture.", 0,      \
            EXPRESSION_COUNT - 1, initial, action_labels                                           \
    }

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    PERFORMING_HAND_PARAM(1),
    TEACH_PARAM(2, "Teach 1", "a fist"),
    TEACH_PARAM(3, "Teach 2", "a pointing index finger"),
    TEACH_PARAM(4, "Teach 3", "a flat hand, spread"),
    TEACH_PARAM(5, "Teach 4", "ring and little finger stretched"),
    {6, MRT_PARAM_TRIGGER, "Forget", "Teach", "", "Reset all gestures to their defaults.",
     0, 1, 0, NULL},
    ACTION_PARAM(7, "Gesture 1", EXPRESSION_JAW_OPEN),
    ACTION_PARAM(8, "Gesture 2", EXPRESSION_BROWS_UP),
    ACTION_PARAM(9, "Gesture 3", EXPRESSION_SMILE),
    ACTION_PARAM(10, "Gesture 4", EXPRESSION_BLINK),
    {11, 0, "Attack", "Action", "s", "Time in which the action fades in.", 0.01, 3, 0.15, NULL},
    {12, 0, "Hold", "Action", "s", "Time for which the action stays.", 0.01, 10, 0.2, NULL},
    {13, 0, "Release", "Action", "s", "Time in which the action fades out.", 0.01, 5, 0.35, NULL},
    {14, MRT_PARAM_STEPPED, "Sustain", "Action", "",
     "Keep the action while the gesture is held.", 0, 1, 1, off_on},
    {15, 0, "Amount", "Action", "%", "Strength of the action.", 0, 120, 100, NULL},
    {16, 0, "Reject", "Recognition", "deg",
     "Largest distance from a gesture that still makes it: root mean square of the joint angles.",
     1, 40, 8, NULL},
    {17, 0, "Leave", "Recognition", "deg",
     "Distance from a gesture at which it ends.", 1, 60, 10, NULL},
    {18, 0, "Dwell", "Recognition", "s", "Time for which a gesture must be held before it counts.",
     0, 2, 0.1, NULL},
    POSE_PARAM(19, "Pose 1"),
    POSE_PARAM(20, "Pose 2"),
    POSE_PARAM(21, "Pose 3"),
    POSE_PARAM(22, "Pose 4"),
};
/* clang-format on */

static const mrt_mapping mapping = {activate, mapping_deactivate, reset, process};
static const mrt_rig_poses rig_poses = {set_poses};
static const mrt_state state = {save_taught, load_taught};
static const mrt_taught_poses taught_poses = {pose};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping},           {MRT_RIG_POSES, &rig_poses}, {MRT_STATE, &state},
    {MRT_TAUGHT_POSES, &taught_poses}, {MRT_RESUME, &resume},       {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.gesture",
    "Gesture",
    "1.0",
    "Learned hand gestures trigger a blink, a nod or a smile.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
