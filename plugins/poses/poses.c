/* Mapping: hand poses that were demonstrated once or a few times make poses of the face; hand poses
 * between them make faces between. Defaults apply until others are taught. */
#include "expressions.h"
#include "mapping.h"
#include "space.h"

#include <stdlib.h>
#include <string.h>

enum {
    HAND,
    TEACH,
    FORGET = TEACH + SPACE_POSES,
    AMOUNT,
    EASE,
    WIDTH,
    RIDGE,
    SHOWN, /* the pose of the face for each pose of the hand but the first, which is neutral */
    PARAM_COUNT = SHOWN + SPACE_POSES - 1
};

static const expression expressions_of[SPACE_POSES] = {
    EXPRESSION_NEUTRAL,  EXPRESSION_SMILE,      EXPRESSION_FROWN,  EXPRESSION_JAW_OPEN,
    EXPRESSION_BROWS_UP, EXPRESSION_BROWS_DOWN, EXPRESSION_PUCKER, EXPRESSION_BLINK};

/* Distal joints are estimated as half of the middle ones. The wrist is at rest. */
#define FINGERS(thumb_roll, thumb_mpj, thumb_ij, thumb_abduction, i1, i2, m1, m2, r1, r2, l1, l2,  \
                spread, arch)                                                                      \
    {                                                                                              \
        thumb_roll, thumb_mpj, thumb_ij, thumb_abduction, i1, i2, 0.5f * (i2), m1, m2,             \
            0.5f * (m2), spread, r1, r2, 0.5f * (r2), spread, l1, l2, 0.5f * (l2), spread, arch,   \
            -0.08f, 0.0f                                                                           \
    }
/* clang-format off */
static const float shipped[SPACE_POSES][MRT_ANGLES] = {
    FINGERS(1.45f, 0.15f, 0.20f, 0.34f, 0.61f, 0.53f, 0.67f, 0.60f, 0.72f, 0.64f, 0.70f, 0.60f, -0.04f, 0.12f), /* at rest */
    FINGERS(0.74f, 0.15f, 0.20f, 0.63f, -0.05f, 0.06f, 0.02f, 0.13f, 0.05f, 0.18f, 0.05f, 0.15f, 0.26f, 0.13f), /* spread */
    FINGERS(1.90f, 0.19f, 0.59f, 0.66f, 1.26f, 1.68f, 1.35f, 1.75f, 1.39f, 1.81f, 1.36f, 1.75f, -0.04f, 0.13f), /* fist */
    FINGERS(1.44f, -0.25f, 0.02f, 0.75f, 0.55f, 0.53f, 0.62f, 0.60f, 0.67f, 0.64f, 0.67f, 0.60f, -0.05f, 0.12f), /* thumb dropped */
    FINGERS(1.44f, 0.15f, 0.20f, 0.35f, 0.00f, 0.16f, 0.59f, 0.54f, 0.69f, 0.63f, 0.70f, 0.60f, -0.05f, 0.12f), /* index lifted */
    FINGERS(1.44f, 0.15f, 0.20f, 0.35f, 1.25f, 1.20f, 0.80f, 0.75f, 0.75f, 0.66f, 0.72f, 0.62f, -0.04f, 0.12f), /* index bent */
    FINGERS(1.80f, 0.35f, 0.50f, 0.20f, 0.95f, 0.40f, 0.95f, 0.40f, 0.95f, 0.40f, 0.95f, 0.40f, -0.12f, 0.30f), /* beak */
    FINGERS(1.77f, 0.15f, 0.20f, 0.55f, 0.55f, 0.48f, 0.22f, 0.25f, 0.09f, 0.18f, 0.12f, 0.15f, -0.05f, 0.46f), /* three stretched */
};
/* clang-format on */

typedef struct lessons {
    space_shown shown;
    bool is_taught[SPACE_POSES]; /* false: as shipped */
} lessons;

struct mrt_plugin {
    const mrt_host *host;
    expressions expressions;
    expression_poses poses;
    lessons stored; /* default or loaded demonstrations: restored by a reset */
    lessons now;
    double weight[SPACE_POSES]; /* of the face shown */

    /* ---- derived from the demonstrations and the parameters ---- */
    space_fit fit;
    bool is_fit;
    double ridge, width; /* that it was found with */
};

static void show_shipped(lessons *out)
{
    memset(out, 0, sizeof *out);
    for (unsigned pose = 0; pose < SPACE_POSES; ++pose)
        space_show(&out->shown, pose, shipped[pose]);
}

static void reset(mrt_plugin *self)
{
    self->now = self->stored;
    self->is_fit = false;
    memset(self->weight, 0, sizeof self->weight);
}

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    show_shipped(&self->stored);
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

/* ---- lessons ---- */

/* [frame]: without printf, which may allocate. */
static void append(char *line, const char *text)
{
    memcpy(line + strlen(line), text, strlen(text) + 1);
}

static void append_number(char *line, unsigned number)
{
    char digits[12] = "", *at = digits + sizeof digits - 1;
    do
        *--at = (char)('0' + number % 10);
    while ((number /= 10) > 0);
    append(line, at);
}

static void report(const mrt_plugin *self, unsigned pose)
{
    char line[200] = "taught: ";
    append(line, expression_names[expressions_of[pose]]);
    append(line, ", demonstrations: ");
    append_number(line, self->now.shown.count[pose]);
    if (self->fit.left_out < 0.0) {
        append(line, "; show a pose twice to measure how well the poses can be distinguished");
    } else {
        append(line, "; leave-one-out error of the weights: ");
        append_number(line, (unsigned)(100.0 * clamp(self->fit.left_out, 0.0, 99.0) + 0.5));
        append(line, " %");
    }
    self->host->log(self->host, MRT_LOG_INFO, line);
}

static void fit_again(mrt_plugin *self, const double *params)
{
    self->ridge = params[RIDGE];
    self->width = params[WIDTH];
    self->is_fit = true;
    space_find(&self->fit, &self->now.shown, self->ridge, 0.01 * self->width);
}

static void learn(mrt_plugin *self, unsigned pose, const mrt_hand *hand, const double *params)
{
    if (!self->now.is_taught[pose]) /* the first demonstration replaces the default one */
        self->now.shown.count[pose] = self->now.shown.next[pose] = 0;
    self->now.is_taught[pose] = true;
    space_show(&self->now.shown, pose, hand->angle);
    fit_again(self, params);
    report(self, pose);
}

static void attend(mrt_plugin *self, const mrt_hand *hand, const double *params)
{
    if (params[FORGET] > 0.5) {
        show_shipped(&self->now);
        self->is_fit = false;
    }
    for (unsigned pose = 0; pose < SPACE_POSES; ++pose) {
        if (params[TEACH + pose] < 0.5)
            continue;
        if (hand)
            learn(self, pose, hand, params);
        else
            self->host->log(self->host, MRT_LOG_WARNING,
                            "no hand detected: hold the pose, then press Teach");
    }
    bool is_other = params[RIDGE] < self->ridge || params[RIDGE] > self->ridge ||
                    params[WIDTH] < self->width || params[WIDTH] > self->width;
    if (!self->is_fit || is_other)
        fit_again(self, params);
}

/* ---- the mapping ---- */

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const double *params = frame->params;
    const mrt_hand *hand = performing_hand(frame, params[HAND]);
    double wanted[SPACE_POSES], part[EXPRESSION_COUNT] = {0.0};
    expression_played played[SPACE_POSES] = {{NULL, 0.0}};
    attend(self, hand, params);
    if (!hand)
        return MRT_HOLD;
    space_weights(&self->fit, hand->angle, wanted);
    double share = smoothing_share(frame->dt_s, params[EASE]);
    for (int pose = 0; pose < SPACE_POSES; ++pose) {
        self->weight[pose] += share * (wanted[pose] - self->weight[pose]);
        const double amount = 0.01 * params[AMOUNT] * self->weight[pose];
        if (pose > 0)
            played[pose].pose = expression_poses_find(&self->poses, params[SHOWN + pose - 1]);
        played[pose].strength = amount;
        part[expressions_of[pose]] = played[pose].pose ? 0.0 : amount;
    }
    expressions_write(&self->expressions, part, &self->poses, played, SPACE_POSES, pull);
    return MRT_OK;
}

/* ---- storing the demonstrations ---- */

#define LESSONS_MEMORY(lessons)                                                                    \
    MEMORY_WHOLES((lessons).shown.count, SPACE_SHOWN_MAX),                                         \
        MEMORY_WHOLES((lessons).shown.next, SPACE_SHOWN_MAX - 1),                                  \
        MEMORY_FLOATS((lessons).shown.angle), MEMORY_BOOLS((lessons).is_taught)

static size_t save_lessons(mrt_plugin *self, void *out, size_t capacity)
{
    const memory_list list = {
        .type = "org.marotte.poses/taught", .version = 1, .parts = {LESSONS_MEMORY(self->now)}};
    return memory_save(&list, out, capacity);
}

static mrt_result load_lessons(mrt_plugin *self, const void *bytes, size_t size)
{
    const memory_list list = {
        .type = "org.marotte.poses/taught", .version = 1, .parts = {LESSONS_MEMORY(self->stored)}};
    if (!memory_load(&list, bytes, size)) {
        self->host->log(self->host, MRT_LOG_ERROR,
                        "the stored hand poses are damaged: teach them again");
        return MRT_ERR_FORMAT;
    }
    self->now = self->stored;
    self->is_fit = false;
    return MRT_OK;
}

/* Returns the mean of the demonstrations of a pose. */
static mrt_result pose(const void *bytes, size_t size, uint32_t param, float *out_rad)
{
    lessons all;
    const memory_list list = {
        .type = "org.marotte.poses/taught", .version = 1, .parts = {LESSONS_MEMORY(all)}};
    const unsigned teach_id = 2, which = param - teach_id;
    if (!memory_load(&list, bytes, size))
        return MRT_ERR_FORMAT;
    if (param < teach_id || which >= SPACE_POSES || all.shown.count[which] == 0)
        return MRT_END;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        double sum = 0.0;
        for (unsigned k = 0; k < all.shown.count[which]; ++k)
            sum += (double)all.shown.angle[which][k][i];
        out_rad[i] = (float)(sum / all.shown.count[which]);
    }
    return MRT_OK;
}

/* ---- resume ---- */

static memory_list memory_of(mrt_plugin *self)
{
    return (memory_list){.type = "org.marotte.poses",
                         .version = 1,
                         .parts = {
                             LESSONS_MEMORY(self->stored),
                             LESSONS_MEMORY(self->now),
                             MEMORY_DOUBLES(self->weight),
                         }};
}

static size_t save(mrt_plugin *self, void *out, size_t capacity)
{
    const memory_list list = memory_of(self);
    return memory_save(&list, out, capacity);
}

static mrt_result load(mrt_plugin *self, const void *bytes, size_t size)
{
    const memory_list list = memory_of(self);
    if (!memory_load(&list, bytes, size))
        return MRT_ERR_FORMAT;
    self->is_fit = false;
    return MRT_OK;
}

#define TEACH_PARAM(id, name, pose, what)                                                          \
    {                                                                                              \
        id, MRT_PARAM_TRIGGER, name, "Teach", "",                                                  \
            "Learn the current hand pose as: " pose ". Default: " what ".", 0, 1, 0, NULL          \
    }

#define SHOWN_PARAM(id, name, pose)                                                                \
    {                                                                                              \
        id, MRT_PARAM_STEPPED | MRT_PARAM_POSE, name, "Pose", "",                                  \
            "Pose of the rig that the hand pose of " pose " makes instead.", 0, MRT_POSE_VALUES,   \
            0, NULL                                                                                \
    }

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    PERFORMING_HAND_PARAM(1),
    TEACH_PARAM(2, "Teach neutral", "neutral", "a relaxed hand"),
    TEACH_PARAM(3, "Teach smile", "smile", "a flat hand, spread"),
    TEACH_PARAM(4, "Teach frown", "frown", "a fist"),
    TEACH_PARAM(5, "Teach jaw open", "jaw open", "the thumb dropped"),
    TEACH_PARAM(6, "Teach brows up", "brows up", "the index finger stretched"),
    TEACH_PARAM(7, "Teach brows down", "brows down", "the index finger bent"),
    TEACH_PARAM(8, "Teach pucker", "pucker", "all fingertips together"),
    TEACH_PARAM(9, "Teach blink", "blink", "the other three fingers stretched"),
    {10, MRT_PARAM_TRIGGER, "Forget", "Teach", "", "Reset all hand poses to their defaults.",
     0, 1, 0, NULL},
    {11, 0, "Amount", "Face", "%", "Strength of each pose of the face.", 0, 120, 100, NULL},
    {12, 0, "Ease", "Face", "s", "Time in which the face follows the hand.", 0.01, 1, 0.05, NULL},
    {13, 0, "Width", "Learning", "%",
     "Radius of a demonstration, in per cent of the mean distance between poses.",
     10, 100, 40, NULL},
    {14, 0, "Ridge", "Learning", "",
     "Regularisation: 0.001 follows each demonstration exactly, 1 hardly.",
     0.001, 1, 0.01, NULL},
    SHOWN_PARAM(15, "Pose for smile", "smile"),
    SHOWN_PARAM(16, "Pose for frown", "frown"),
    SHOWN_PARAM(17, "Pose for jaw open", "jaw open"),
    SHOWN_PARAM(18, "Pose for brows up", "brows up"),
    SHOWN_PARAM(19, "Pose for brows down", "brows down"),
    SHOWN_PARAM(20, "Pose for pucker", "pucker"),
    SHOWN_PARAM(21, "Pose for blink", "blink"),
};
/* clang-format on */

static const mrt_mapping mapping = {activate, mapping_deactivate, reset, process};
static const mrt_rig_poses rig_poses = {set_poses};
static const mrt_state state = {save_lessons, load_lessons};
static const mrt_resume resume = {save, load};
static const mrt_taught_poses taught_poses = {pose};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping},           {MRT_RIG_POSES, &rig_poses}, {MRT_STATE, &state},
    {MRT_TAUGHT_POSES, &taught_poses}, {MRT_RESUME, &resume},       {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.poses",
    "Poses",
    "1.0",
    "Learned hand poses make poses of the face.",
    create,
    mapping_destroy,
};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
