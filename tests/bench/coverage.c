/* Measures which faces one hand reaches through a mapping, which is a black box here. For each
 * device and each target face (visemes, closed lips, expressions, sums of both), a search over
 * hands that a person can hold finds the nearest face that the mapping gives. The program prints
 * the distance to that face, the effect of noise, and properties of the way to it. It gates
 * nothing. Faces are compared in the skull's frame, mm. The same build gives the same numbers.
 *
 * coverage [--map NAME[,key=value...]] [--face NAME.rig.json] [--device NAME]... [--quick]
 *          [--neutral DEG,...] [--json FILE] [--sheet FILE.png]
 *
 * The search runs on a linear model of the face: how each contact and each degree of freedom moves
 * the points of the regions, measured with the engine once. The engine then corrects the result. */
#include "coverage_face.h"
#include "stage/perform/frame.h"
#include "cli/rigpicture.h"

#include "draw/offscreen.h"
#include "face/rig/rig_poses.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT_OF(array) ((uint32_t)(sizeof(array) / sizeof *(array)))

enum { TARGETS_MAX = 256, STARTS = 6, TITLE = 64 };

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts `value`. share 0.5: the median. Returns NaN if count is 0. */
static double percentile(double *value, uint32_t count, double share)
{
    if (count == 0)
        return (double)NAN;
    qsort(value, count, sizeof *value, by_size);
    return value[(uint32_t)(share * (double)(count - 1) + 0.5)];
}

/* ---- targets ---- */

typedef enum target_kind {
    VISEME = 0,
    CLOSURE,
    EXPRESSION,
    LOOK,
    TONGUE_OUT,
    UPPER,
    SUM,
    KINDS
} target_kind;

/* Weight of the squared distance of each region in the search. */
static const double kind_weight[KINDS][REGIONS] = {
    [VISEME] = {1, 0.01, 0.01, 0.01, 0.005, 0.001},
    [CLOSURE] = {1, 0.01, 0.01, 0.01, 0.001, 0.001},
    [EXPRESSION] = {1, 1, 1, 1, 0, 0.001},
    [LOOK] = {1, 1, 1, 1, 0, 1},
    [TONGUE_OUT] = {0.5, 0.01, 0.01, 0.01, 0.5, 0.001},
    [UPPER] = {1, 1, 1, 1, 0, 0.001},
    [SUM] = {1, 1, 1, 1, 0, 0.001},
};
/* Bit set of the regions that judge a face. */
static const unsigned kind_judged[KINDS] = {
    [VISEME] = 1u << LIPS,
    [CLOSURE] = 1u << LIPS,
    [EXPRESSION] = 1u << LIPS | 1u << BROWS | 1u << LIDS | 1u << IRIS,
    [LOOK] = 1u << LIPS | 1u << BROWS | 1u << LIDS | 1u << IRIS | 1u << HEAD,
    [TONGUE_OUT] = 1u << LIPS | 1u << TONGUE,
    [UPPER] = 1u << LIPS | 1u << BROWS | 1u << LIDS | 1u << IRIS,
    [SUM] = 1u << LIPS | 1u << BROWS | 1u << LIDS | 1u << IRIS,
};

typedef struct target {
    char name[TITLE];
    target_kind kind;
    uint32_t part[2]; /* SUM: the targets that it is a sum of */
    double param[PARAMS_MAX];
    double *point;  /* as the engine shows it */
    float *feature; /* of those */
} target;

typedef struct targets {
    target of[TARGETS_MAX];
    uint32_t count, viseme_count, shown_count; /* shown: all before UPPER and SUM */
} targets;

static const char *const viseme_names[] = {
    "viseme_PP", "viseme_FF", "viseme_TH",  "viseme_DD",      "viseme_kk", "viseme_CH",
    "viseme_SS", "viseme_nn", "viseme_RR",  "viseme_aa",      "viseme_E",  "viseme_I",
    "viseme_O",  "viseme_U",  "viseme_sil", "viseme_laughter"};
static const char *const expression_names[] = {"joy",  "sadness",   "anger",      "surprise",
                                               "fear", "disgust",   "contempt",   "sleepy",
                                               "smug", "wink_left", "wink_right", "brow_up"};
static const double aside_rad = 25.0 / 57.29577951308232, open_rad = 8.0 / 57.29577951308232;

static const rig_pose *find_pose(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (strcmp(r->pose[i].name, name) == 0)
            return &r->pose[i];
    return NULL;
}

/* Returns false if the face has no such degree of freedom. */
static bool set_dof(const scene *s, double *param, const char *name, double value)
{
    const bones *b = face_bones(composer_face(s->still->composer));
    for (uint32_t i = 0; i < b->dof_count; ++i)
        if (strcmp(b->dof[i].name, name) == 0) {
            param[3 * s->contact_count + i] = value;
            return true;
        }
    return false;
}

/* Writes the parameters of a pose. only_upper: part of each contact; then only the upper half is
 * written. NULL: all of it. Returns false if the face has no such pose. */
static bool read_pose(const scene *s, const char *name, const rig_pose_part *only_upper,
                      double *out)
{
    const rig_pose *pose = find_pose(composer_rig(s->still->composer), name);
    memset(out, 0, s->param_count * sizeof *out);
    if (!pose)
        return false;
    for (uint32_t i = 0; i < pose->pull_count + pose->follow_count; ++i) {
        const uint32_t contact = pose->pull_contact[i];
        if (only_upper && only_upper[contact] != POSE_UPPER)
            continue;
        set_row(out, contact, pose->pull_mm[i]);
    }
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        if (!only_upper || rig_poses_dof_part(pose->dof_name[i]) == POSE_UPPER)
            (void)set_dof(s, out, pose->dof_name[i], pose->dof_value[i]);
    return true;
}

static target *add_target(targets *out, const char *name, target_kind kind)
{
    target *t = &out->of[out->count++];
    *t = (target){.kind = kind};
    (void)snprintf(t->name, sizeof t->name, "%s", name);
    return t;
}

static void add_posed(targets *out, const scene *s, const char *name,
                      const rig_pose_part *only_upper, target_kind kind)
{
    char title[TITLE];
    double param[PARAMS_MAX];
    if (!read_pose(s, name, only_upper, param))
        return;
    (void)snprintf(title, sizeof title, "%s%s", starts(name, "viseme_") ? name + 7 : name,
                   only_upper ? " (upper half)" : "");
    memcpy(add_target(out, title, kind)->param, param, sizeof param);
}

/* A target made of two degrees of freedom. A face that lacks one gets no such target. */
static void add_driven(targets *out, const scene *s, const char *name, target_kind kind,
                       const char *const dof[2], const double value[2])
{
    double param[PARAMS_MAX] = {0};
    if (set_dof(s, param, dof[0], value[0]) && set_dof(s, param, dof[1], value[1]))
        memcpy(add_target(out, name, kind)->param, param, sizeof param);
}

static void add_sums(targets *out, const scene *s)
{
    const uint32_t first = out->shown_count, end = out->count;
    for (uint32_t v = 0; v < out->viseme_count; ++v)
        for (uint32_t u = first; u < end; ++u) {
            char title[TITLE];
            (void)snprintf(title, sizeof title, "%.20s + %.*s", out->of[v].name,
                           (int)strcspn(out->of[u].name, " "), out->of[u].name);
            target *t = add_target(out, title, SUM);
            t->part[0] = v;
            t->part[1] = u;
            for (uint32_t i = 0; i < s->param_count; ++i)
                t->param[i] = out->of[v].param[i] + out->of[u].param[i];
        }
}

static void targets_init(targets *out, scene *s, const model *m, bool is_quick)
{
    const rig *r = composer_rig(s->still->composer);
    vec3 *at = allocate(s->contact_count, sizeof *at);
    rig_pose_part *half = allocate(s->contact_count, sizeof *half);
    *out = (targets){.count = 0};
    for (uint32_t i = 0; i < s->contact_count; ++i) {
        const mrt_vec3 rest = s->contact[i].rest;
        at[i] = (vec3){to_double(rest.x), to_double(rest.y), to_double(rest.z)};
    }
    rig_poses_contact_parts(half, r, at);
    for (uint32_t i = 0; i < COUNT_OF(viseme_names); ++i)
        add_posed(out, s, viseme_names[i], NULL, VISEME);
    out->viseme_count = out->count;
    add_posed(out, s, "mouthClose", NULL, CLOSURE);
    add_driven(out, s, "m over an open jaw", CLOSURE,
               (const char *const[2]){"jaw.open", RIG_LIPS_SEAL}, (const double[2]){open_rad, 1.0});
    for (uint32_t i = 0; i < COUNT_OF(expression_names); ++i)
        add_posed(out, s, expression_names[i], NULL, EXPRESSION);
    add_driven(out, s, "look aside", LOOK, (const char *const[2]){"eye.l.yaw", "eye.r.yaw"},
               (const double[2]){aside_rad, aside_rad});
    add_posed(out, s, "tongueOut", NULL, TONGUE_OUT);
    out->shown_count = out->count;
    for (uint32_t i = 0; i < COUNT_OF(expression_names) && (!is_quick || i < 1); ++i)
        add_posed(out, s, expression_names[i], half, UPPER);
    add_sums(out, s);
    free(at);
    free(half);
    for (uint32_t i = 0; i < out->count; ++i) {
        target *t = &out->of[i];
        const mrt_pull pull = pull_of_params(s, t->param);
        t->point = allocate(point_numbers(s), sizeof *t->point);
        t->feature = allocate(m->first[REGIONS], sizeof *t->feature);
        (void)perform(s, &pull, t->point);
        model_of_points(m, t->point, t->feature);
    }
}

static void targets_finish(targets *self)
{
    for (uint32_t i = 0; i < self->count; ++i) {
        free(self->of[i].point);
        free(self->of[i].feature);
    }
}

/* Distance of a face from a target: root mean square of the worst judging region, mm. */
static double judge(const scene *s, const target *t, const double *point)
{
    double worst = 0.0;
    for (region of = 0; of < REGIONS; ++of)
        if (kind_judged[t->kind] >> of & 1u)
            worst = fmax(worst, region_rms(s, of, point, t->point));
    return worst;
}

/* ---- the search ---- */

typedef struct hand {
    float angle_rad[MRT_ANGLES];
} hand;

typedef struct reach { /* the nearest face that was found */
    hand hand;
    mrt_pull pull;
    double *point;
    double judged_mm; /* the worst region by which the target is judged, rms */
} reach;

typedef struct search {
    scene *s;
    const model *m;
    const targets *targets;
    hand *hand; /* hand_count: random ones, the neutral one first */
    float *feature;
    uint32_t hand_count;
    int sensor[MRT_ANGLES]; /* that the device sees */
    uint32_t sensor_count;
    reach reach[TARGETS_MAX];
    hand relaxed[TARGETS_MAX]; /* the same; joints that do not matter are as in the neutral hand */
} search;

static void evaluate(search *q, const hand *h, float *out_feature)
{
    mrt_pull pull;
    double param[PARAMS_MAX];
    map_hand(q->s, h->angle_rad, &pull);
    read_params(q->s, &pull, param);
    model_of_params(q->m, q->s, param, out_feature);
}

static float random_angle(random_source *random, int sensor)
{
    const human_joint *j = &human_joints[sensor];
    return human_rad(j->low_deg + (j->high_deg - j->low_deg) * (float)random_uniform(random));
}

/* Groups of joints that a hand usually moves together. */
enum { GROUPS = 6, GROUP_MOST = 5 };
static const int group_sensor[GROUPS][GROUP_MOST] = {
    {SENSOR_THUMB_MPJ, SENSOR_THUMB_MPJ + 1, SENSOR_NONE},
    {SENSOR_INDEX_MPJ, SENSOR_MIDDLE_MPJ, SENSOR_RING_MPJ, SENSOR_LITTLE_MPJ, SENSOR_NONE},
    {SENSOR_RING_MPJ, SENSOR_LITTLE_MPJ, SENSOR_NONE},
    {SENSOR_INDEX_MPJ, SENSOR_MIDDLE_MPJ, SENSOR_NONE},
    {SENSOR_INDEX_MPJ + 1, SENSOR_MIDDLE_MPJ + 1, SENSOR_RING_MPJ + 1, SENSOR_LITTLE_MPJ + 1,
     SENSOR_NONE},
    {SENSOR_MIDDLE_INDEX_SPREAD, SENSOR_RING_MIDDLE_SPREAD, SENSOR_LITTLE_RING_SPREAD, SENSOR_NONE},
};

static void draw_groups(random_source *random, hand *out)
{
    for (int g = 0; g < GROUPS; ++g) {
        const bool moves = random_uniform(random) < 0.5;
        const float share = (float)random_uniform(random);
        for (int i = 0; moves && group_sensor[g][i] != SENSOR_NONE; ++i) {
            const human_joint *j = &human_joints[group_sensor[g][i]];
            out->angle_rad[group_sensor[g][i]] =
                human_rad(j->low_deg + (j->high_deg - j->low_deg) * share);
        }
    }
}

/* One hand of three bends all joints, one bends groups of joints, one bends a few joints. */
static void draw_hand(const search *q, random_source *random, uint32_t number, hand *out)
{
    const uint32_t few = 1 + (uint32_t)(random_uniform(random) * 8.0);
    memcpy(out->angle_rad, q->s->neutral_rad, sizeof out->angle_rad);
    if (number % 3 == 1)
        draw_groups(random, out);
    for (uint32_t i = 0; number % 3 == 0 && i < q->sensor_count; ++i)
        out->angle_rad[q->sensor[i]] = random_angle(random, q->sensor[i]);
    for (uint32_t i = 0; number % 3 == 2 && i < few; ++i) {
        const uint32_t at = (uint32_t)(random_uniform(random) * q->sensor_count);
        out->angle_rad[q->sensor[at]] = random_angle(random, q->sensor[at]);
    }
    human_hand_limit(out->angle_rad);
}

static void search_init(search *out, scene *s, const model *m, const targets *t,
                        uint32_t hand_count)
{
    random_source random = {7};
    *out = (search){.s = s, .m = m, .targets = t, .hand_count = hand_count};
    out->hand = allocate(hand_count, sizeof *out->hand);
    out->feature = allocate((size_t)hand_count * m->first[REGIONS], sizeof *out->feature);
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (device_has(s->device.kind, i))
            out->sensor[out->sensor_count++] = i;
    memcpy(out->hand[0].angle_rad, s->neutral_rad, sizeof s->neutral_rad);
    for (uint32_t i = 1; i < hand_count; ++i)
        draw_hand(out, &random, i, &out->hand[i]);
    for (uint32_t i = 0; i < hand_count; ++i)
        evaluate(out, &out->hand[i], out->feature + (size_t)i * m->first[REGIONS]);
    for (uint32_t i = 0; i < t->count; ++i)
        out->reach[i] =
            (reach){.point = allocate(point_numbers(s), sizeof(double)), .judged_mm = INFINITY};
}

static void search_finish(search *q)
{
    for (uint32_t i = 0; i < q->targets->count; ++i)
        free(q->reach[i].point);
    free(q->hand);
    free(q->feature);
}

/* Differences between features and wanted ones, weighted by region. */
static void residual_of(const search *q, const double *weight_of, const float *feature,
                        const float *wanted, float *out)
{
    for (region of = 0; of < REGIONS; ++of) {
        const float weight = (float)sqrt(weight_of[of]);
        for (uint32_t i = q->m->first[of]; i < q->m->first[of + 1]; ++i)
            out[i] = weight * (feature[i] - wanted[i]);
    }
}

static double squares(const float *value, uint32_t count)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; ++i)
        sum += to_double(value[i]) * to_double(value[i]);
    return sum;
}

/* Cost of a bend away from neutral, mm^2 per rad^2: of two hands with one face the search prefers
 * the one nearer to neutral. */
static const double comfort = 0.03;

static double discomfort(const search *q, const hand *h)
{
    double sum = 0.0;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const double bent = to_double(h->angle_rad[i] - q->s->neutral_rad[i]);
        sum += bent * bent;
    }
    return comfort * sum;
}

typedef struct climb { /* a hand on its way to a target */
    search *q;
    const float *wanted;  /* features */
    const double *weight; /* of each region */
    hand hand;
    float residual[REGIONS * PARAMS_MAX];
    double cost;
} climb;

static double climb_try(const climb *c, const hand *h, float *out_residual)
{
    float feature[REGIONS * PARAMS_MAX];
    evaluate(c->q, h, feature);
    residual_of(c->q, c->weight, feature, c->wanted, out_residual);
    return squares(out_residual, c->q->m->first[REGIONS]) + discomfort(c->q, h);
}

static void climb_begin(climb *c, search *q, const double *weight, const float *wanted,
                        const hand *h)
{
    c->q = q;
    c->weight = weight;
    c->wanted = wanted;
    c->hand = *h;
    c->cost = climb_try(c, h, c->residual);
}

static bool climb_take(climb *c, const hand *h)
{
    float residual[REGIONS * PARAMS_MAX];
    const double cost = climb_try(c, h, residual);
    if (!(cost < c->cost))
        return false;
    c->hand = *h;
    c->cost = cost;
    memcpy(c->residual, residual, sizeof residual);
    return true;
}

/* Solves a x = b by Cholesky; a: n by n, symmetric, positive. Overwrites a; b becomes x. */
static void solve_symmetric(double *a, double *b, uint32_t n)
{
    for (uint32_t i = 0; i < n; ++i) {
        for (uint32_t k = 0; k <= i; ++k) {
            double sum = a[i * n + k];
            for (uint32_t j = 0; j < k; ++j)
                sum -= a[i * n + j] * a[k * n + j];
            a[i * n + k] = i == k ? sqrt(fmax(sum, 1e-12)) : sum / a[k * n + k];
        }
        for (uint32_t k = 0; k < i; ++k)
            b[i] -= a[i * n + k] * b[k];
        b[i] /= a[i * n + i];
    }
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t k = i + 1; k < n; ++k)
            b[i] -= a[k * n + i] * b[k];
        b[i] /= a[i * n + i];
    }
}

/* Levenberg-Marquardt over the joints that the device measures. Slopes are differences over 1.5
 * degrees, because smaller ones vanish in dead zones. */
static void climb_newton(climb *c, int iterations)
{
    const search *q = c->q;
    const uint32_t n = q->sensor_count, rows = q->m->first[REGIONS];
    const float step = human_rad(1.5f);
    float *slope = allocate((size_t)n * rows, sizeof *slope);
    double damping = 0.1;
    for (int k = 0; k < iterations && damping < 1e4; ++k) {
        double normal[MRT_ANGLES * MRT_ANGLES], right[MRT_ANGLES];
        for (uint32_t i = 0; i < n; ++i) {
            hand h = c->hand;
            float *at = &h.angle_rad[q->sensor[i]], *row = slope + i * rows;
            const float before = *at;
            *at += before + step <= human_rad(human_joints[q->sensor[i]].high_deg) ? step : -step;
            const float by = *at - before;
            (void)climb_try(c, &h, row);
            for (uint32_t j = 0; j < rows; ++j)
                row[j] = (row[j] - c->residual[j]) / by;
        }
        for (uint32_t i = 0; i < n; ++i) {
            for (uint32_t j = 0; j <= i; ++j) {
                double sum = 0.0;
                for (uint32_t r = 0; r < rows; ++r)
                    sum += to_double(slope[i * rows + r]) * to_double(slope[j * rows + r]);
                normal[i * n + j] = normal[j * n + i] = sum;
            }
            right[i] = -comfort *
                       to_double(c->hand.angle_rad[q->sensor[i]] - q->s->neutral_rad[q->sensor[i]]);
            for (uint32_t r = 0; r < rows; ++r)
                right[i] -= to_double(slope[i * rows + r]) * to_double(c->residual[r]);
        }
        bool is_better = false;
        for (int attempt = 0; attempt < 4 && !is_better; ++attempt) {
            double a[MRT_ANGLES * MRT_ANGLES], b[MRT_ANGLES];
            memcpy(a, normal, sizeof a);
            memcpy(b, right, sizeof b);
            for (uint32_t i = 0; i < n; ++i)
                a[i * n + i] += comfort + damping * (a[i * n + i] + 1.0);
            solve_symmetric(a, b, n);
            hand h = c->hand;
            for (uint32_t i = 0; i < n; ++i)
                h.angle_rad[q->sensor[i]] += (float)fmin(fmax(b[i], -0.5), 0.5);
            human_hand_limit(h.angle_rad);
            const double before = c->cost;
            is_better = climb_take(c, &h);
            damping = is_better ? fmax(0.2 * damping, 1e-6) : 6.0 * damping;
            if (is_better && before - c->cost < 1e-4 * (before + 1e-3))
                damping = 1e9; /* it has arrived */
        }
        if (!is_better)
            break;
    }
    free(slope);
}

static bool climb_turn(climb *c, const int *sensor, float by_deg)
{
    hand h = c->hand;
    for (; *sensor != SENSOR_NONE; ++sensor)
        h.angle_rad[*sensor] += human_rad(by_deg);
    human_hand_limit(h.angle_rad);
    return climb_take(c, &h);
}

/* Pattern search over joints and groups with shrinking steps, for places where all slopes are 0. */
static void climb_pattern(climb *c, float from_deg, int rounds)
{
    for (int round = 0; round < rounds; ++round, from_deg *= 0.4f) {
        for (uint32_t i = 0; i < c->q->sensor_count; ++i) {
            const int sensor[2] = {c->q->sensor[i], SENSOR_NONE};
            if (!climb_turn(c, sensor, from_deg))
                (void)climb_turn(c, sensor, -from_deg);
        }
        for (int g = 0; g < GROUPS; ++g)
            if (!climb_turn(c, group_sensor[g], from_deg))
                (void)climb_turn(c, group_sensor[g], -from_deg);
    }
}

/* Copies some joints of random hands: leaves local minima. */
static void climb_mix(climb *c, random_source *random, uint32_t tries)
{
    const search *q = c->q;
    for (uint32_t n = 0; n < tries; ++n) {
        const hand *from = &q->hand[(uint32_t)(random_uniform(random) * q->hand_count)];
        const uint32_t count = 1 + (uint32_t)(random_uniform(random) * 6.0);
        const float share = n % 2 ? 1.0f : (float)random_uniform(random);
        hand h = c->hand;
        for (uint32_t i = 0; i < count; ++i) {
            const int sensor = q->sensor[(uint32_t)(random_uniform(random) * q->sensor_count)];
            h.angle_rad[sensor] += share * (from->angle_rad[sensor] - h.angle_rad[sensor]);
        }
        human_hand_limit(h.angle_rad);
        (void)climb_take(c, &h);
    }
}

static double hands_apart_rad(const hand *a, const hand *b)
{
    double most = 0.0;
    for (int i = 0; i < MRT_ANGLES; ++i)
        most = fmax(most, fabs(to_double(a->angle_rad[i] - b->angle_rad[i])));
    return most;
}

/* The nearest random hands. Any two differ by more than 0.3 rad in some joint. */
static uint32_t find_starts(search *q, const target *t, hand *out, uint32_t most)
{
    const uint32_t rows = q->m->first[REGIONS];
    double *cost = allocate(q->hand_count, sizeof *cost);
    float residual[REGIONS * PARAMS_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < q->hand_count; ++i) {
        residual_of(q, kind_weight[t->kind], q->feature + (size_t)i * rows, t->feature, residual);
        cost[i] = squares(residual, rows) + discomfort(q, &q->hand[i]);
    }
    for (uint32_t tries = 0; tries < 40 * most && count < most; ++tries) {
        uint32_t best = 0;
        for (uint32_t i = 1; i < q->hand_count; ++i)
            best = cost[i] < cost[best] ? i : best;
        cost[best] = INFINITY;
        bool is_new = true;
        for (uint32_t k = 0; k < count; ++k)
            is_new = is_new && hands_apart_rad(&out[k], &q->hand[best]) > 0.3;
        if (is_new)
            out[count++] = q->hand[best];
    }
    free(cost);
    return count;
}

/* Performs that hand. Keeps it if its face is nearer than the one reached before. */
static void consider(search *q, uint32_t number, const hand *h, double *point)
{
    reach *r = &q->reach[number];
    mrt_pull pull;
    map_hand(q->s, h->angle_rad, &pull);
    (void)perform(q->s, &pull, point);
    const double mm = judge(q->s, &q->targets->of[number], point);
    if (!(mm < r->judged_mm))
        return;
    r->hand = *h;
    r->pull = pull;
    r->judged_mm = mm;
    memcpy(r->point, point, point_numbers(q->s) * sizeof *point);
}

/* Adds the difference between engine and model to the target, then searches again from `h`. The
 * weight of the worst judging region grows. */
static void correct(search *q, uint32_t number, hand *h, double *weight, double *point)
{
    const target *t = &q->targets->of[number];
    float shown[REGIONS * PARAMS_MAX], expected[REGIONS * PARAMS_MAX], wanted[REGIONS * PARAMS_MAX];
    region worst = LIPS;
    climb c;
    model_of_points(q->m, point, shown);
    evaluate(q, h, expected);
    for (uint32_t i = 0; i < q->m->first[REGIONS]; ++i)
        wanted[i] = t->feature[i] - shown[i] + expected[i];
    for (region of = LIPS; of < REGIONS; ++of)
        if (kind_judged[t->kind] >> of & 1u &&
            region_rms(q->s, of, point, t->point) > region_rms(q->s, worst, point, t->point))
            worst = of;
    weight[worst] *= 1.6;
    climb_begin(&c, q, weight, wanted, h);
    climb_newton(&c, 6);
    climb_pattern(&c, 3.0f, 2);
    *h = c.hand;
    consider(q, number, h, point);
}

/* Takes joints back to the neutral hand where the face stays as near to the target. */
static void relax(search *q, uint32_t number)
{
    static const double may_lose_mm = 0.02;
    double *point = allocate(point_numbers(q->s), sizeof *point);
    hand *h = &q->relaxed[number];
    *h = q->reach[number].hand;
    for (uint32_t i = 0; i < q->sensor_count; ++i) {
        mrt_pull pull;
        float *angle = &h->angle_rad[q->sensor[i]];
        const float was = *angle;
        *angle = q->s->neutral_rad[q->sensor[i]];
        map_hand(q->s, h->angle_rad, &pull);
        (void)perform(q->s, &pull, point);
        if (judge(q->s, &q->targets->of[number], point) > q->reach[number].judged_mm + may_lose_mm)
            *angle = was;
    }
    free(point);
}

static hand sum_of_hands(const search *q, const hand *a, const hand *b)
{
    hand out;
    for (int i = 0; i < MRT_ANGLES; ++i)
        out.angle_rad[i] = a->angle_rad[i] + b->angle_rad[i] - q->s->neutral_rad[i];
    human_hand_limit(out.angle_rad);
    return out;
}

typedef struct effort {
    uint32_t starts, tries; /* tries: of climb_mix, for each start */
    int corrections;
} effort;

static void search_target(search *q, uint32_t number, const effort *e)
{
    const target *t = &q->targets->of[number];
    random_source random = {17 + number};
    hand start[STARTS + 2];
    uint32_t count = find_starts(q, t, start, e->starts);
    double *point = allocate(point_numbers(q->s), sizeof *point);
    if (t->kind == SUM) {
        start[count++] = sum_of_hands(q, &q->reach[t->part[0]].hand, &q->reach[t->part[1]].hand);
        start[count++] = sum_of_hands(q, &q->relaxed[t->part[0]], &q->relaxed[t->part[1]]);
    }
    consider(q, number, &q->hand[0], point);
    for (uint32_t i = 0; i < count; ++i) {
        double weight[REGIONS];
        climb c;
        memcpy(weight, kind_weight[t->kind], sizeof weight);
        climb_begin(&c, q, weight, t->feature, &start[i]);
        climb_newton(&c, 8);
        climb_mix(&c, &random, e->tries);
        climb_pattern(&c, 10.0f, 3);
        climb_newton(&c, 8);
        hand h = c.hand;
        consider(q, number, &h, point);
        for (int k = 0; k < e->corrections; ++k)
            correct(q, number, &h, weight, point);
    }
    if (t->kind != SUM)
        relax(q, number);
    free(point);
}

/* ---- figures ---- */

enum {
    STATIC_DRAWS = 6,
    WHITE_FRAMES = 40,
    REST_FRAMES = 150,
    FOLD_HANDS = 300,
    NOISES_MAX = 8192
};
static const double tight_rms_mm = 1.5, tight_most_mm = 4.0, near_mm = 2.5, rough_mm = 4.0;
static const double told_apart_mm = 1.5, may_fall_mm = 0.3;

typedef struct cross_talk {
    double most_mm;
    int sensor; /* SENSOR_NONE: none */
} cross_talk;

typedef struct figures {
    double judged_mm[TARGETS_MAX], lips_most_mm[TARGETS_MAX], rms_mm[TARGETS_MAX][REGIONS];
    uint32_t visemes_tight, visemes_near, told_by_lips, told_with_tongue;
    double viseme_mean_mm;
    uint32_t expressions, expressions_near, expressions_rough; /* the look aside is one */
    uint32_t sums, sums_near;
    double sum_mean_mm;
    double rest_noise_mm;                   /* median */
    double static_noise_mm, static_most_mm; /* median, greatest */
    double white_noise_mm, white_most_mm;
    double process_us;
    double viseme_noise_mm[TARGETS_MAX]; /* white, median */
    double steepest_lips, steepest_face; /* mm for a degree */
    uint32_t ways, ways_monotone;
    double fall_mm;
    cross_talk to_upper, to_lips; /* of mouth joints, of joints of the upper half, each alone */
    cross_talk pulled_to_upper, pulled_to_lips; /* and with the fingers that follow */
    double least_determinant, held_back_mm;
    uint64_t evaluations, performances;
} figures;

static void count_residuals(figures *out, const search *q)
{
    const scene *s = q->s;
    for (uint32_t i = 0; i < q->targets->count; ++i) {
        const target *t = &q->targets->of[i];
        const double mm = q->reach[i].judged_mm;
        const double most = region_most(s, LIPS, q->reach[i].point, t->point);
        out->judged_mm[i] = mm;
        for (region of = LIPS; of < REGIONS; ++of)
            out->rms_mm[i][of] = region_rms(s, of, q->reach[i].point, t->point);
        out->lips_most_mm[i] = most;
        if (t->kind == VISEME) {
            out->visemes_tight += mm <= tight_rms_mm && most <= tight_most_mm;
            out->visemes_near += mm <= near_mm;
            out->viseme_mean_mm += mm / q->targets->viseme_count;
        } else if (t->kind == EXPRESSION || t->kind == LOOK) {
            out->expressions += 1;
            out->expressions_near += mm <= near_mm;
            out->expressions_rough += mm <= rough_mm;
        } else if (t->kind == SUM) {
            out->sums += 1;
            out->sums_near += mm <= near_mm;
            out->sum_mean_mm += mm;
        }
    }
    out->sum_mean_mm /= out->sums ? out->sums : 1;
}

/* Size of a set of visemes that all differ from each other beyond the noise. The set is greedy: a
 * viseme joins in order if it differs from all members. */
static uint32_t count_told_apart(const search *q, const double *noise_mm, bool by_tongue)
{
    uint32_t taken[TARGETS_MAX], count = 0;
    for (uint32_t i = 0; i < q->targets->viseme_count; ++i) {
        bool is_new = true;
        for (uint32_t k = 0; k < count; ++k) {
            const double *a = q->reach[i].point, *b = q->reach[taken[k]].point;
            double apart = region_rms(q->s, LIPS, a, b);
            if (by_tongue)
                apart = fmax(apart, region_rms(q->s, TONGUE, a, b));
            is_new = is_new && apart > told_apart_mm + fmax(noise_mm[i], noise_mm[taken[k]]);
        }
        if (is_new)
            taken[count++] = i;
    }
    return count;
}

/* Each measured angle is off by device_noise_deg, with a random sign. */
static void measure_static_noise(figures *out, const search *q)
{
    random_source random = {11};
    scene *s = q->s;
    double *point = allocate(point_numbers(s), sizeof *point);
    double *mm = allocate(NOISES_MAX, sizeof *mm);
    uint32_t count = 0;
    for (uint32_t i = 0; i < q->targets->viseme_count; ++i)
        for (int n = 0; n < STATIC_DRAWS; ++n) {
            hand h = q->reach[i].hand;
            mrt_pull pull;
            for (uint32_t k = 0; k < q->sensor_count; ++k)
                h.angle_rad[q->sensor[k]] += human_rad(
                    (float)(random_uniform(&random) < 0.5 ? -device_noise_deg : device_noise_deg));
            map_hand(s, h.angle_rad, &pull);
            (void)perform(s, &pull, point);
            mm[count++] = region_rms(s, LIPS, point, q->reach[i].point);
        }
    out->static_noise_mm = percentile(mm, count, 0.5);
    out->static_most_mm = count ? mm[count - 1] : (double)NAN;
    free(point);
    free(mm);
}

/* ---- live: samples at the device's rate through the stage's own hands ---- */

typedef struct live {
    scene *s;
    int64_t time_ns;
    uint32_t sequence;
    hand_reading reading; /* of points: the one before */
} live;

static void live_step(live *l, const float *angle_rad, random_source *noise)
{
    device *d = &l->s->device;
    mrt_sample sample = {.time_ns = l->time_ns, .sequence = l->sequence++, .count = d->count};
    device_measure(d, angle_rad, noise, &l->reading, sample.value);
    const sample_step step = sample_step_of(&d->route, &sample);
    stage_frame f = {.performer = l->s->live, .step = step};
    error ignored = {""};
    (void)!frame_step(&f, &ignored);
    l->time_ns += (int64_t)(1e9 / device_table[d->kind].rate_hz);
}

static void live_go(live *l, const float *from_rad, const float *to_rad, double for_s,
                    random_source *noise)
{
    const uint32_t steps = (uint32_t)(for_s * device_table[l->s->device.kind].rate_hz);
    for (uint32_t n = 1; n <= steps; ++n) {
        float angle_rad[MRT_ANGLES];
        for (int i = 0; i < MRT_ANGLES; ++i)
            angle_rad[i] = from_rad[i] + (to_rad[i] - from_rad[i]) * (float)n / (float)steps;
        live_step(l, angle_rad, noise);
    }
}

/* From neutral to the pose, and rests there. */
static live live_hold(scene *s, const float *angle_rad, random_source *noise)
{
    live l = {.s = s, .time_ns = 1000000000, .reading = s->device.neutral};
    layer_reset(s->live->voice[0].layer);
    composer_reset(s->live->composer);
    live_go(&l, s->neutral_rad, s->neutral_rad, 1.0, noise);
    live_go(&l, s->neutral_rad, angle_rad, 0.5, noise);
    live_go(&l, angle_rad, angle_rad, 0.9, noise);
    return l;
}

static void live_read_view(const live *l, double *out)
{
    composer_draw(l->s->live->composer);
    measure_points(l->s, composer_face(l->s->live->composer), out);
}

/* Writes, for `count` frames in which the hand rests at the pose, how far noise moves the lips from
 * where they are without it: root mean square, mm. The noise is there from the start, as in life.
 */
static void live_noise(double *out_mm, uint32_t count, scene *s, const float *angle_rad,
                       random_source *noise)
{
    double *still = allocate(point_numbers(s), sizeof *still),
           *now = allocate(point_numbers(s), sizeof *now);
    live l = live_hold(s, angle_rad, NULL);
    live_read_view(&l, still);
    l = live_hold(s, angle_rad, noise);
    for (uint32_t n = 0; n < count; ++n) {
        live_step(&l, angle_rad, noise);
        live_read_view(&l, now);
        out_mm[n] = region_rms(s, LIPS, still, now);
    }
    free(still);
    free(now);
}

static void measure_white_noise(figures *out, const search *q)
{
    random_source random = {13};
    double *mm = allocate(NOISES_MAX, sizeof *mm);
    uint32_t count = 0;
    live_noise(mm, REST_FRAMES, q->s, q->s->neutral_rad, &random);
    out->rest_noise_mm = percentile(mm, REST_FRAMES, 0.5);
    for (uint32_t i = 0; i < q->targets->viseme_count; ++i, count += WHITE_FRAMES) {
        live_noise(mm + count, WHITE_FRAMES, q->s, q->reach[i].hand.angle_rad, &random);
        out->viseme_noise_mm[i] = percentile(mm + count, WHITE_FRAMES, 0.5);
    }
    out->white_noise_mm = percentile(mm, count, 0.5);
    for (uint32_t i = 0; i < q->targets->viseme_count; ++i)
        out->process_us += process_us(q->s, q->reach[i].hand.angle_rad) / q->targets->viseme_count;
    out->white_most_mm = count ? mm[count - 1] : (double)NAN;
    free(mm);
}

/* ---- ways ---- */

static void blend_hands(float *out_rad, const float *from_rad, const float *to_rad, float share)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        out_rad[i] = from_rad[i] + share * (to_rad[i] - from_rad[i]);
}

/* Distance of two hands: root of the sum of squares over the joints that the device measures,
 * degrees. */
static double way_of_hands_deg(const search *q, const hand *a, const hand *b)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < q->sensor_count; ++i) {
        const double bent = to_double(a->angle_rad[q->sensor[i]] - b->angle_rad[q->sensor[i]]);
        sum += bent * bent;
    }
    return sqrt(sum) * 57.29577951308232;
}

/* Follows the straight way from the neutral hand in steps of a degree. */
static void measure_way(figures *out, const search *q, const hand *to)
{
    scene *s = q->s;
    const hand from = q->hand[0];
    const double way_deg = way_of_hands_deg(q, &from, to);
    const uint32_t steps = (uint32_t)ceil(way_deg);
    double *rest = allocate(point_numbers(s), sizeof *rest),
           *last = allocate(point_numbers(s), sizeof *last);
    double *now = allocate(point_numbers(s), sizeof *now);
    double furthest = 0.0, fall = 0.0;
    mrt_pull pull;
    map_hand(s, from.angle_rad, &pull);
    (void)perform(s, &pull, rest);
    memcpy(last, rest, point_numbers(s) * sizeof *rest);
    for (uint32_t n = 1; n <= steps; ++n) {
        float angle_rad[MRT_ANGLES];
        blend_hands(angle_rad, from.angle_rad, to->angle_rad, (float)n / (float)steps);
        map_on(s, angle_rad, &pull);
        (void)perform(s, &pull, now);
        const double step_deg = way_deg / steps;
        for (region of = LIPS; of < TONGUE; ++of) {
            const double slope = region_rms(s, of, now, last) / step_deg;
            out->steepest_face = fmax(out->steepest_face, slope);
            if (of == LIPS)
                out->steepest_lips = fmax(out->steepest_lips, slope);
        }
        const double away = region_rms(s, LIPS, now, rest);
        furthest = fmax(furthest, away);
        fall = fmax(fall, furthest - away);
        double *spare = last;
        last = now;
        now = spare;
    }
    out->ways += 1;
    out->ways_monotone += fall <= may_fall_mm;
    out->fall_mm = fmax(out->fall_mm, fall);
    free(rest);
    free(last);
    free(now);
}

/* ---- cross-talk ---- */

static const float cross_talk_deg = 20.0f;

/* Greatest distances that lips and upper half move when one joint bends both ways, mm. */
typedef struct moved {
    double lips_mm, upper_mm;
} moved;

static moved measure_bend(const search *q, int sensor, bool with_neighbours, const double *rest,
                          double *scratch)
{
    const human_joint *j = &human_joints[sensor];
    moved out = {0.0, 0.0};
    for (int way = -1; way <= 1; way += 2) {
        const float by_rad = (float)way * human_rad(cross_talk_deg);
        hand h = q->hand[0];
        mrt_pull pull;
        if (with_neighbours)
            human_hand_bend(h.angle_rad, sensor, by_rad);
        else
            h.angle_rad[sensor] = human_clamp(h.angle_rad[sensor] + by_rad, human_rad(j->low_deg),
                                              human_rad(j->high_deg));
        map_hand(q->s, h.angle_rad, &pull);
        (void)perform(q->s, &pull, scratch);
        out.lips_mm = fmax(out.lips_mm, region_most(q->s, LIPS, scratch, rest));
        out.upper_mm = fmax(out.upper_mm, upper_most(q->s, scratch, rest));
    }
    return out;
}

static void note_cross_talk(cross_talk *out, double mm, int sensor)
{
    if (mm > out->most_mm && mm > 0.005)
        *out = (cross_talk){mm, sensor};
}

/* A joint that moves the lips further than the upper half is a mouth joint. The wrist turns the
 * head and belongs to neither half. */
static void measure_cross_talk(figures *out, const search *q)
{
    const size_t numbers = point_numbers(q->s);
    double *rest = allocate(numbers, sizeof *rest), *scratch = allocate(numbers, sizeof *scratch);
    mrt_pull pull;
    map_hand(q->s, q->s->neutral_rad, &pull);
    (void)perform(q->s, &pull, rest);
    out->to_upper = out->to_lips = (cross_talk){0.0, SENSOR_NONE};
    out->pulled_to_upper = out->pulled_to_lips = out->to_upper;
    for (uint32_t k = 0; k < q->sensor_count; ++k) {
        const int sensor = q->sensor[k];
        if (sensor_table[sensor].kind == SENSOR_WRIST)
            continue;
        const moved alone = measure_bend(q, sensor, false, rest, scratch);
        const moved pulled = measure_bend(q, sensor, true, rest, scratch);
        if (alone.lips_mm > alone.upper_mm) {
            note_cross_talk(&out->to_upper, alone.upper_mm, sensor);
            note_cross_talk(&out->pulled_to_upper, pulled.upper_mm, sensor);
        } else if (alone.upper_mm > alone.lips_mm) {
            note_cross_talk(&out->to_lips, alone.lips_mm, sensor);
            note_cross_talk(&out->pulled_to_lips, pulled.lips_mm, sensor);
        }
    }
    free(rest);
    free(scratch);
}

static void measure_folds(figures *out, const search *q)
{
    scene *s = q->s;
    out->least_determinant = 1.0;
    for (uint32_t i = 0; i < FOLD_HANDS && i < q->hand_count; ++i) {
        mrt_pull pull;
        map_hand(s, q->hand[i].angle_rad, &pull);
        const face *f = perform(s, &pull, NULL);
        out->least_determinant = fmin(out->least_determinant, face_min_determinant(f));
        out->held_back_mm = fmax(out->held_back_mm, face_metered(f)->held_back_mm);
    }
}

static void figures_measure(figures *out, search *q)
{
    *out = (figures){.ways = 0};
    count_residuals(out, q);
    measure_static_noise(out, q);
    measure_white_noise(out, q);
    out->told_by_lips = count_told_apart(q, out->viseme_noise_mm, false);
    out->told_with_tongue = count_told_apart(q, out->viseme_noise_mm, true);
    for (uint32_t i = 0; i < q->targets->shown_count; ++i)
        measure_way(out, q, &q->reach[i].hand);
    measure_cross_talk(out, q);
    measure_folds(out, q);
    out->evaluations = q->s->evaluations;
    out->performances = q->s->performances;
}

/* ---- the run ---- */

typedef struct options {
    const char *map, *face, *json, *sheet;
    float neutral_rad[MRT_ANGLES];
    bool is_quick, uses[DEVICES];
} options;

typedef struct run { /* of one device */
    device_kind kind;
    figures figures;
    hand hand[TARGETS_MAX];
    float *surface[TARGETS_MAX]; /* of the targets that are shown; NULL: no sheet is asked for */
} run;

static float *copy_surface(const face *f, uint32_t vertex_count)
{
    float *out = allocate((size_t)3 * vertex_count, sizeof *out);
    points_to_rows(out, face_shown(f), face_order(f));
    return out;
}

static void run_device(run *out, scene *s, const model *m, const targets *t, const options *o)
{
    static const effort quick = {1, 60, 1}, of_sums = {1, 150, 2}, of_others = {STARTS, 500, 4};
    search *q = allocate(1, sizeof *q);
    *out = (run){.kind = out->kind};
    s->evaluations = s->performances = 0;
    use_device(s, out->kind);
    search_init(q, s, m, t, o->is_quick ? 1500 : 13000);
    for (uint32_t i = 0; i < t->count; ++i)
        search_target(q, i, o->is_quick ? &quick : t->of[i].kind == SUM ? &of_sums : &of_others);
    figures_measure(&out->figures, q);
    for (uint32_t i = 0; i < t->count; ++i) {
        out->hand[i] = q->reach[i].hand;
        if (o->sheet && i < t->shown_count)
            out->surface[i] =
                copy_surface(perform(s, &q->reach[i].pull, NULL), s->file.mesh.vertex_count);
    }
    search_finish(q);
    free(q);
}

/* ---- printed ---- */

typedef struct row {
    const char *words;
    int decimals;
    double value[DEVICES];
} row;

static void print_row(const row *r, uint32_t run_count)
{
    printf("%-58s", r->words);
    for (uint32_t i = 0; i < run_count; ++i)
        printf(" %12.*f", r->decimals, r->value[i]);
    printf("\n");
}

static void add_rows(row *out, uint32_t *count, const char *words, int decimals, const run *runs,
                     uint32_t run_count, double (*figure)(const figures *f))
{
    row *r = &out[(*count)++];
    *r = (row){.words = words, .decimals = decimals};
    for (uint32_t i = 0; i < run_count; ++i)
        r->value[i] = figure(&runs[i].figures);
}

#define FIGURE(name, expression)                                                                   \
    static double figure_##name(const figures *f)                                                  \
    {                                                                                              \
        return (double)(expression);                                                               \
    }
FIGURE(visemes_tight, f->visemes_tight)
FIGURE(visemes_near, f->visemes_near)
FIGURE(told_by_lips, f->told_by_lips)
FIGURE(told_with_tongue, f->told_with_tongue)
FIGURE(viseme_mean, f->viseme_mean_mm)
FIGURE(expressions_near, f->expressions_near)
FIGURE(expressions_rough, f->expressions_rough)
FIGURE(sums_near, f->sums ? 100.0 * f->sums_near / f->sums : 0.0)
FIGURE(sum_mean, f->sum_mean_mm)
FIGURE(rest_noise, f->rest_noise_mm)
FIGURE(static_noise, f->static_noise_mm)
FIGURE(static_most, f->static_most_mm)
FIGURE(white_noise, f->white_noise_mm)
FIGURE(white_most, f->white_most_mm)
FIGURE(process, f->process_us)
FIGURE(steepest_lips, f->steepest_lips)
FIGURE(steepest_face, f->steepest_face)
FIGURE(ways_monotone, f->ways_monotone)
FIGURE(fall, f->fall_mm)
FIGURE(to_upper, f->to_upper.most_mm)
FIGURE(to_lips, f->to_lips.most_mm)
FIGURE(pulled_to_upper, f->pulled_to_upper.most_mm)
FIGURE(pulled_to_lips, f->pulled_to_lips.most_mm)
FIGURE(determinant, f->least_determinant)
FIGURE(held_back, f->held_back_mm)

typedef struct figure_column {
    const char *key, *words;
    int decimals;
    double (*of)(const figures *f);
} figure_column;
static const figure_column figure_table[] = {
    {"visemes_tight", "visemes within 1.5 mm rms and 4 mm on the lips", 0, figure_visemes_tight},
    {"visemes_near", "visemes within 2.5 mm rms on the lips", 0, figure_visemes_near},
    {"told_by_lips", "visemes told apart by the lips", 0, figure_told_by_lips},
    {"told_with_tongue", "visemes told apart by lips and tongue", 0, figure_told_with_tongue},
    {"viseme_mean_mm", "mean residual of visemes on the lips, mm", 2, figure_viseme_mean},
    {"expressions_near", "expressions within 2.5 mm", 0, figure_expressions_near},
    {"expressions_rough", "expressions within 4 mm", 0, figure_expressions_rough},
    {"sums_near_percent", "sums within 2.5 mm, percent", 0, figure_sums_near},
    {"sum_mean_mm", "mean residual of sums, worst region, mm", 2, figure_sum_mean},
    {"rest_noise_mm", "lips at rest under the device's noise, median, mm", 2, figure_rest_noise},
    {"static_noise_mm", "lips in visemes, all joints 1.4 degrees off, median, mm", 2,
     figure_static_noise},
    {"static_most_mm", "  greatest, mm", 2, figure_static_most},
    {"white_noise_mm", "lips in visemes under the device's noise, median, mm", 2,
     figure_white_noise},
    {"white_most_mm", "  greatest, mm", 2, figure_white_most},
    {"process_us", "mean time of process() in visemes, microseconds", 1, figure_process},
    {"steepest_lips", "greatest mm of lips for a degree of hand on a way", 2, figure_steepest_lips},
    {"steepest_face", "  of lips, brows, lids or iris", 2, figure_steepest_face},
    {"ways_monotone", "ways on which the lips never come back", 0, figure_ways_monotone},
    {"fall_mm", "  furthest that they come back, mm", 2, figure_fall},
    {"to_upper_mm", "cross-talk: a mouth joint moves the upper half, mm", 2, figure_to_upper},
    {"pulled_to_upper_mm", "  and its neighbours follow: the upper half, mm", 2,
     figure_pulled_to_upper},
    {"to_lips_mm", "cross-talk: a joint of the upper half moves the lips, mm", 2, figure_to_lips},
    {"pulled_to_lips_mm", "  and its neighbours follow: the lips, mm", 2, figure_pulled_to_lips},
    {"least_determinant", "least determinant of 300 random hands", 3, figure_determinant},
    {"held_back_mm", "  held back by the fold guard at most, mm", 1, figure_held_back},
};

static const char *joint_label(const cross_talk *of)
{
    return of->sensor == SENSOR_NONE ? "no joint" : sensor_table[of->sensor].label;
}

static void print_figures(const run *runs, uint32_t run_count, const targets *t)
{
    const figures *f = &runs[0].figures;
    row rows[COUNT_OF(figure_table)];
    uint32_t count = 0;
    printf("%u visemes, %u expressions with a look aside, %u sums, %u ways\n\n%-58s",
           t->viseme_count, f->expressions, f->sums, f->ways, "");
    for (uint32_t i = 0; i < run_count; ++i)
        printf(" %12s", device_table[runs[i].kind].about);
    printf("\n");
    for (uint32_t i = 0; i < COUNT_OF(figure_table); ++i)
        add_rows(rows, &count, figure_table[i].words, figure_table[i].decimals, runs, run_count,
                 figure_table[i].of);
    for (uint32_t i = 0; i < count; ++i)
        print_row(&rows[i], run_count);
    for (uint32_t i = 0; i < run_count; ++i)
        printf("cross-talk with %s: to the upper half by %s (alone: %s), to the lips by %s (alone: "
               "%s)\n",
               device_table[runs[i].kind].about, joint_label(&runs[i].figures.pulled_to_upper),
               joint_label(&runs[i].figures.to_upper), joint_label(&runs[i].figures.pulled_to_lips),
               joint_label(&runs[i].figures.to_lips));
    for (uint32_t i = 0; i < run_count; ++i)
        printf("search with %s: %.0f thousand hands, %.0f thousand faces performed\n",
               device_table[runs[i].kind].about, 1e-3 * (double)runs[i].figures.evaluations,
               1e-3 * (double)runs[i].figures.performances);
    printf("\nresidual of each face, mm rms in its worst region; in brackets: greatest, on the "
           "lips\n");
    for (uint32_t n = 0; n < t->shown_count; ++n) {
        printf("%-30s", t->of[n].name);
        for (uint32_t i = 0; i < run_count; ++i)
            printf("   %6.2f (%5.1f)", runs[i].figures.judged_mm[n],
                   runs[i].figures.lips_most_mm[n]);
        printf("\n");
    }
}

static const char *const region_name[REGIONS] = {"lips", "brows", "lids", "iris", "tongue", "head"};

static void add_json(json_t *object, const char *key, json_t *value)
{
    if (json_object_set_new(object, key, value) != 0)
        must(MRT_ERR_MEMORY, &(error){"no memory for the JSON"});
}

static json_t *json_of_run(const run *r, const targets *t)
{
    json_t *out = json_object(), *faces = json_array();
    add_json(out, "device", json_string(device_table[r->kind].name));
    for (uint32_t i = 0; i < COUNT_OF(figure_table); ++i)
        add_json(out, figure_table[i].key, json_real(figure_table[i].of(&r->figures)));
    for (uint32_t n = 0; n < t->count; ++n) {
        json_t *one = json_object(), *regions = json_object(), *angles = json_array();
        add_json(one, "name", json_string(t->of[n].name));
        add_json(one, "judged_mm", json_real(r->figures.judged_mm[n]));
        for (region of = LIPS; of < REGIONS; ++of)
            add_json(regions, region_name[of], json_real(r->figures.rms_mm[n][of]));
        add_json(one, "rms_mm", regions);
        add_json(one, "lips_most_mm", json_real(r->figures.lips_most_mm[n]));
        for (int k = 0; k < MRT_ANGLES; ++k)
            (void)json_array_append_new(angles, json_real(to_double(r->hand[n].angle_rad[k])));
        add_json(one, "hand_rad", angles);
        (void)json_array_append_new(faces, one);
    }
    add_json(out, "faces", faces);
    return out;
}

static void write_json(const options *o, const run *runs, uint32_t run_count, const targets *t)
{
    json_t *all = json_object(), *list = json_array();
    add_json(all, "map", json_string(o->map));
    add_json(all, "visemes", json_integer(t->viseme_count));
    for (uint32_t i = 0; i < run_count; ++i)
        (void)json_array_append_new(list, json_of_run(&runs[i], t));
    add_json(all, "devices", list);
    const int failed = json_dump_file(all, o->json, JSON_INDENT(1) | JSON_REAL_PRECISION(6));
    json_decref(all);
    if (failed) {
        (void)fprintf(stderr, "coverage: cannot write %s\n", o->json);
        exit(1);
    }
}

/* ---- the sheet ---- */

enum { PANEL_WIDTH = 150, PANEL_HEIGHT = 180, CAPTION = 22, GAP = 24, HEADER = 40, BLOCKS = 3 };
static const float sheet_ink[4] = {0.92f, 0.93f, 0.95f, 1.0f};

static void draw_panel(offscreen *e, const float *surface, const draw_camera *camera,
                       const char *caption, uint32_t x, uint32_t y)
{
    draw_face_update(e->face, surface, NULL);
    draw_render(e->renderer, e->target, e->face, camera, x, y, PANEL_WIDTH, PANEL_HEIGHT);
    offscreen_words(e, caption, (float)x + 4.0f, (float)(y + PANEL_HEIGHT) + 1.0f, 15.0f,
                    PANEL_WIDTH - 8.0f, sheet_ink);
}

/* A row for each face: the target, then the nearest reached with each device. Rows stand in three
 * blocks side by side. */
static void write_sheet(const options *o, scene *s, const run *runs, uint32_t run_count,
                        const targets *t)
{
    const uint32_t rows = (t->shown_count + BLOCKS - 1) / BLOCKS, panels = 1 + run_count;
    const uint32_t block = panels * PANEL_WIDTH + GAP;
    rigportraits_frame frame = rigportraits_frame_empty((rigpicture_view){0.25f, 0.03f});
    float *surface[TARGETS_MAX];
    error err = {""};
    offscreen e;
    char words[160];
    for (uint32_t n = 0; n < t->shown_count; ++n) {
        const mrt_pull pull = pull_of_params(s, t->of[n].param);
        surface[n] = copy_surface(perform(s, &pull, NULL), s->file.mesh.vertex_count);
    }
    rigportraits_frame_add(&frame, s->file.mesh.position, s->file.mesh.vertex_count);
    const draw_camera camera = rigportraits_frame_camera(&frame);
    must(offscreen_init(&e, &s->file.mesh, BLOCKS * block, HEADER + rows * (PANEL_HEIGHT + CAPTION),
                        &err),
         &err);
    (void)snprintf(words, sizeof words, "%s: target, then the nearest face with", o->map);
    for (uint32_t i = 0; i < run_count; ++i)
        (void)snprintf(words + strlen(words), sizeof words - strlen(words), "%s %s", i ? "," : "",
                       device_table[runs[i].kind].about);
    offscreen_words(&e, words, 8.0f, 6.0f, 22.0f, (float)(BLOCKS * block) - 16.0f, sheet_ink);
    for (uint32_t n = 0; n < t->shown_count; ++n) {
        const uint32_t x = n / rows * block, y = HEADER + n % rows * (PANEL_HEIGHT + CAPTION);
        draw_panel(&e, surface[n], &camera, t->of[n].name, x, y);
        for (uint32_t i = 0; i < run_count; ++i) {
            (void)snprintf(words, sizeof words, "%.1f mm", runs[i].figures.judged_mm[n]);
            draw_panel(&e, runs[i].surface[n], &camera, words, x + (1 + i) * PANEL_WIDTH, y);
        }
        free(surface[n]);
    }
    must(offscreen_save(&e, o->sheet, &err), &err);
    offscreen_finish(&e);
}

/* ---- from the command line ---- */

static bool read_neutral(options *out, const char *words)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        char *end;
        out->neutral_rad[i] = human_rad(strtof(words, &end));
        if (end == words || (*end != ',' && *end != '\0') ||
            (*end == '\0') != (i + 1 == MRT_ANGLES))
            return false;
        words = end + 1;
    }
    return true;
}

static bool read_device(options *out, const char *name)
{
    for (int i = 0; i < DEVICES; ++i)
        if (strcmp(device_table[i].name, name) == 0)
            return out->uses[i] = true;
    return false;
}

static bool read_options(options *out, int argc, char **argv)
{
    *out = (options){.map = "one_hand", .face = SOURCE_DIR "/rigs/puppet/puppet.rig.json"};
    memcpy(out->neutral_rad, human_neutral_rad, sizeof out->neutral_rad);
    for (int i = 1; i < argc; ++i) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(argv[i], "--quick") == 0) {
            out->is_quick = true;
            continue;
        }
        if (!value)
            return false;
        if (strcmp(argv[i], "--map") == 0)
            out->map = value;
        else if (strcmp(argv[i], "--face") == 0)
            out->face = value;
        else if (strcmp(argv[i], "--json") == 0)
            out->json = value;
        else if (strcmp(argv[i], "--sheet") == 0)
            out->sheet = value;
        else if (!(strcmp(argv[i], "--device") == 0 && read_device(out, value)) &&
                 !(strcmp(argv[i], "--neutral") == 0 && read_neutral(out, value)))
            return false;
        ++i;
    }
    bool uses_any = false;
    for (int i = 0; i < DEVICES; ++i)
        uses_any = uses_any || out->uses[i];
    for (int i = 0; i < DEVICES && !uses_any; ++i)
        out->uses[i] = true;
    return true;
}

int main(int argc, char **argv)
{
    static scene s;
    static model m;
    static targets t;
    static run runs[DEVICES];
    options o;
    uint32_t run_count = 0;
    if (!read_options(&o, argc, argv)) {
        (void)fprintf(
            stderr,
            "usage: coverage [--map NAME[,key=value...]] [--face NAME.rig.json]\n"
            "                [--device sensors22|sensors18|points21|curls5]... [--quick]\n"
            "                [--neutral 22 DEGREES,...] [--json FILE] [--sheet FILE.png]\n");
        return 2;
    }
    if (!human_hand_can(o.neutral_rad))
        must(MRT_ERR_ARGUMENT, &(error){"--neutral: not a hand that a person can hold"});
    scene_init(&s, o.face, o.map, o.neutral_rad);
    model_init(&m, &s);
    targets_init(&t, &s, &m, o.is_quick);
    for (int i = 0; i < DEVICES; ++i)
        if (o.uses[i]) {
            runs[run_count].kind = (device_kind)i;
            run_device(&runs[run_count++], &s, &m, &t, &o);
        }
    print_figures(runs, run_count, &t);
    if (o.json)
        write_json(&o, runs, run_count, &t);
    if (o.sheet)
        write_sheet(&o, &s, runs, run_count, &t);
    for (uint32_t i = 0; i < run_count; ++i)
        for (uint32_t n = 0; n < t.shown_count; ++n)
            free(runs[i].surface[n]);
    targets_finish(&t);
    model_finish(&m);
    scene_finish(&s);
    return 0;
}
