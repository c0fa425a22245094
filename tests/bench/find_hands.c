/* Writes hands.c: how a hand is held for each face, for each kind of device. Each hand pose begins
 * where the meaning of the joints puts it (thumb: jaw, spread: width ...), then poses are moved
 * apart: so far that a face moves at most 0.45 mm a degree, and never nearer than the device's
 * noise allows. Poses stay comfortable. Usage: find_hands RIG >hands.c; figures go to stderr. */
#include "faces.h"
#include "speak.h"

#include "stage/perform/composer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static pose face_of[FACE_COUNT];
static bool has_face[FACE_COUNT];
static double mm_scale;

static double sq(double x)
{
    return x * x;
}

/* ---- how far two faces are apart, mm: lips, or brows, lids and gaze ---- */

static void landmark(double out[3], const pose *p, int index, double rides_on_jaw)
{
    const double open = rides_on_jaw * p->value[POSE_DOFS + DOF_JAW_OPEN];
    for (int axis = 0; axis < 3; ++axis)
        out[axis] = mm_scale * p->value[3 * index + axis];
    out[1] -= 100.0 * sin(open);
    out[2] -= 100.0 * (1.0 - cos(open));
}

static double mouth_apart(const pose *a, const pose *b)
{
    static const struct {
        int landmark;
        double rides_on_jaw;
    } lips[] = {{LANDMARK_MOUTH_CORNER, 0.4},    {LANDMARK_MOUTH_CORNER + 1, 0.4},
                {LANDMARK_LIP_UPPER_SIDE, 0.05}, {LANDMARK_LIP_UPPER_SIDE + 1, 0.05},
                {LANDMARK_LIP_LOWER_SIDE, 0.9},  {LANDMARK_LIP_LOWER_SIDE + 1, 0.9},
                {LANDMARK_LIP_UPPER_MID, 0.0},   {LANDMARK_LIP_LOWER_MID, 0.95}};
    enum { COUNT = sizeof lips / sizeof *lips };
    double sum = 0.0;
    for (int i = 0; i < COUNT; ++i) {
        double at[2][3];
        landmark(at[0], a, lips[i].landmark, lips[i].rides_on_jaw);
        landmark(at[1], b, lips[i].landmark, lips[i].rides_on_jaw);
        for (int axis = 0; axis < 3; ++axis)
            sum += sq(at[0][axis] - at[1][axis]) / COUNT;
    }
    const double *x = a->value + POSE_DOFS, *y = b->value + POSE_DOFS;
    return sqrt(sum + sq(3.0 * (x[DOF_SEAL] - y[DOF_SEAL])) +
                sq(30.0 * (x[DOF_TONGUE] - y[DOF_TONGUE])));
}

static double upper_apart(const pose *a, const pose *b)
{
    double sum = 0.0;
    for (int i = LANDMARK_BROW_INNER; i < LANDMARK_CHEEK; ++i)
        for (int axis = 0; axis < 3; ++axis)
            sum += sq(mm_scale * (a->value[3 * i + axis] - b->value[3 * i + axis]));
    const double *x = a->value + POSE_DOFS, *y = b->value + POSE_DOFS;
    for (int side = 0; side < 2; ++side) {
        sum += sq(24.0 * (x[DOF_LID_UPPER + side] - y[DOF_LID_UPPER + side]));
        sum += sq(9.0 * (x[DOF_LID_LOWER + side] - y[DOF_LID_LOWER + side]));
        sum += sq(25.0 * (x[DOF_EYE_YAW + side] - y[DOF_EYE_YAW + side]));
        sum += sq(25.0 * (x[DOF_EYE_PITCH + side] - y[DOF_EYE_PITCH + side]));
    }
    return sqrt(sum / 12.0);
}

static double apart(face_half which, const pose *a, const pose *b)
{
    return which == HALF_MOUTH ? mouth_apart(a, b) : upper_apart(a, b);
}

/* ---- where the meaning of the joints puts a hand ---- */

static double positive(double x)
{
    return x > 0.0 ? x : 0.0;
}

static double beyond(double x, double dead)
{
    return x > dead ? x - dead : x < -dead ? x + dead : 0.0;
}

static double pull(const pose *p, int index, int axis)
{
    return mm_scale * p->value[3 * index + axis];
}

static bool is_sealed(const pose *p)
{
    return p->value[POSE_DOFS + DOF_SEAL] > 0.9;
}

static void mean_mouth(double deg[JOINT_COUNT], const pose *p, device_kind device)
{
    const double *dof = p->value + POSE_DOFS;
    const double jaw = dof[DOF_JAW_OPEN] / 0.5585, tongue = dof[DOF_TONGUE] / 0.2269;
    const double width =
        0.5 * (pull(p, LANDMARK_MOUTH_CORNER, 0) - pull(p, LANDMARK_MOUTH_CORNER + 1, 0));
    /* a corner that comes in comes down, too: that is no frown */
    const double level = 0.35 * positive(-width);
    const double left = beyond(pull(p, LANDMARK_MOUTH_CORNER, 1) + level, 3.0),
                 right = beyond(pull(p, LANDMARK_MOUTH_CORNER + 1, 1) + level, 3.0);
    const double forward =
        positive(0.5 * (pull(p, LANDMARK_LIP_UPPER_MID, 2) + pull(p, LANDMARK_LIP_LOWER_MID, 2)));
    const double raised = pull(p, LANDMARK_LIP_UPPER_MID, 1);
    const double seal = is_sealed(p) ? 1.0 : 0.0;
    const double hook = (1.0 - seal) * positive(-pull(p, LANDMARK_LIP_LOWER_MID, 2) - 4.0) / 6.0;
    const double round = 0.9 * positive(-width) + 0.6 * forward;
    if (device == DEVICE_CURLS) {
        deg[JOINT_THUMB_MIDDLE] = seal > 0.0 ? 20.0 - 6.0 * jaw : -23.0 * jaw + 8.0 * hook;
        deg[JOINT_RING_KNUCKLE] = round - 1.5 * positive(width) + 4.0 * hook;
        deg[JOINT_LITTLE_KNUCKLE] = -0.8 * (left + right) + 40.0 * tongue + 14.0 * hook;
        return;
    }
    /* a thumb that bends backwards is badly told from points */
    const bool bends_back = device != DEVICE_POINTS;
    deg[JOINT_THUMB_DROP] = seal > 0.0 ? 60.0 * jaw - 4.0 : 30.0 * jaw;
    deg[JOINT_THUMB_MIDDLE] = seal > 0.0 ? 18.0 : (bends_back ? -20.0 : -6.0) * jaw;
    deg[JOINT_THUMB_TIP] = (seal > 0.0 ? 0.0 : (bends_back ? -14.0 : -6.0) * jaw) + 30.0 * hook;
    deg[JOINT_SPREAD] = positive(width) - 0.12 * positive(-width);
    deg[JOINT_INDEX_CURL] = round - 0.8 * positive(width) - 1.5 * raised;
    deg[JOINT_MIDDLE_CURL] = round - 0.8 * positive(width) + 1.5 * raised;
    deg[JOINT_RING_KNUCKLE] = -1.5 * left;
    deg[JOINT_LITTLE_KNUCKLE] = -1.5 * right;
    deg[JOINT_RING_CURL] = -0.8 * left + 20.0 * tongue;
    deg[JOINT_LITTLE_CURL] = -0.8 * right + 45.0 * tongue;
}

static void mean_upper(double deg[JOINT_COUNT], const pose *p, device_kind device)
{
    const double *dof = p->value + POSE_DOFS;
    double brow[2];
    for (int side = 0; side < 2; ++side)
        brow[side] =
            (pull(p, LANDMARK_BROW_INNER + side, 1) + pull(p, LANDMARK_BROW_MID + side, 1) +
             pull(p, LANDMARK_BROW_OUTER + side, 1)) /
            3.0;
    const double tilt =
        0.5 * (pull(p, LANDMARK_BROW_INNER, 1) + pull(p, LANDMARK_BROW_INNER + 1, 1) -
               pull(p, LANDMARK_BROW_OUTER, 1) - pull(p, LANDMARK_BROW_OUTER + 1, 1));
    const double lid = 0.5 * (dof[DOF_LID_UPPER] + dof[DOF_LID_UPPER + 1]) +
                       0.2 * (dof[DOF_LID_LOWER] + dof[DOF_LID_LOWER + 1]);
    const double lid_aside = dof[DOF_LID_UPPER] - dof[DOF_LID_UPPER + 1];
    const double look = 0.5 * (dof[DOF_EYE_YAW] + dof[DOF_EYE_YAW + 1]) / 0.506;
    const double look_up = 0.5 * (dof[DOF_EYE_PITCH] + dof[DOF_EYE_PITCH + 1]) / 0.3665;
    deg[JOINT_INDEX_KNUCKLE] = -1.1 * (brow[0] + brow[1]) - 5.0 * look_up;
    deg[JOINT_MIDDLE_KNUCKLE] = 20.0 * lid - 10.0 * look_up;
    if (device == DEVICE_CURLS)
        return;
    /* one eye, one brow or a look aside: a position of the switch */
    const double aside = 16.0 * look + 10.0 * lid_aside - 0.6 * (brow[0] - brow[1]);
    const double rolled_deg = roll_switch_of[device].pose_deg;
    deg[JOINT_THUMB_ROLL] = aside > 4.0 ? rolled_deg : aside < -4.0 ? -rolled_deg : 0.0;
    if (device == DEVICE_JOINTS)
        deg[JOINT_ARCH] = 0.5 * tilt;
}

/* ---- comfort: what a human hand can hold ---- */

static void closer(double *a, double *b, double most)
{
    const double over = *a - *b;
    if (over > most || over < -most) {
        const double by = 0.5 * (over - (over > 0.0 ? most : -most));
        *a -= by;
        *b += by;
    }
}

static void make_comfortable(double deg[JOINT_COUNT], int f, device_kind device)
{
    const bool is_mouth = face_recipes[f].half == HALF_MOUTH;
    const bool sealed = is_sealed(&face_of[f]);
    if (device != DEVICE_CURLS && is_mouth) {
        closer(&deg[JOINT_INDEX_CURL], &deg[JOINT_MIDDLE_CURL], 18.0);
        closer(&deg[JOINT_RING_CURL], &deg[JOINT_LITTLE_CURL], 26.0);
        closer(&deg[JOINT_MIDDLE_CURL], &deg[JOINT_RING_CURL], 40.0);
        closer(&deg[JOINT_RING_KNUCKLE], &deg[JOINT_LITTLE_KNUCKLE], 26.0);
    }
    for (int i = half_first_joint[face_recipes[f].half];
         i < half_first_joint[face_recipes[f].half + 1]; ++i) {
        const joint_traits *traits = &joint_traits_of[device][i];
        deg[i] =
            traits->noise_deg > 0.0 ? fmin(fmax(deg[i], traits->least_deg), traits->most_deg) : 0.0;
    }
    if (is_mouth) {
        double *press = &deg[JOINT_THUMB_MIDDLE];
        const bool is_half_sealed = face_of[f].value[POSE_DOFS + DOF_SEAL] > 0.3;
        const double most = is_half_sealed && device == DEVICE_CURLS ? 5.0 : 3.0;
        *press = sealed ? fmin(fmax(*press, 16.0), 22.0) : fmin(*press, most);
    }
}

/* ---- the search ---- */

typedef struct search {
    device_kind device;
    face_half half;
    int count, face[FACE_COUNT]; /* that are themselves */
    double mean[FACE_COUNT][JOINT_COUNT], deg[FACE_COUNT][JOINT_COUNT];
    double weight[JOINT_COUNT]; /* of a degree: by the device's noise */
} search;

/* With the switch instead of the thumb's roll (speak.h): hands are apart where lids and brows are.
 */
static double hands_apart(const search *s, const double *a, const double *b)
{
    double sum = 0.0;
    if (s->half == HALF_UPPER)
        sum = sq(speak_switch_way * (eye_side(s->device, a) - eye_side(s->device, b)));
    for (int i = half_first_joint[s->half]; i < half_first_joint[s->half + 1]; ++i)
        sum += sq(s->weight[i] * (a[i] - b[i]));
    return sqrt(sum);
}

/* Weighted degrees: a degree of a device that is twice as noisy counts half. */
static const double least_apart[DEVICE_KINDS][HALF_COUNT] = {{15.0, 9.0}, {12.0, 8.0}, {9.0, 9.0}};
static const double degrees_per_mm[DEVICE_KINDS] = {2.4, 2.8, 2.4};

static double wanted_apart(const search *s, const pose *a, const pose *b)
{
    const double least = least_apart[s->device][s->half];
    return fmin(fmax(degrees_per_mm[s->device] * apart(s->half, a, b), least), 4.0 * least);
}

static void push(search *s, double *move_a, double *move_b, const double *a, const double *b,
                 double wanted)
{
    const double now = hands_apart(s, a, b);
    if (now >= wanted || now < 1e-9)
        return;
    for (int i = half_first_joint[s->half]; i < half_first_joint[s->half + 1]; ++i) {
        const double by = 0.25 * (wanted - now) / now * sq(s->weight[i]) * (a[i] - b[i]);
        move_a[i] += by;
        if (move_b)
            move_b[i] -= by;
    }
}

/* A little aside, each face elsewhere: two that begin at one place part. */
static void nudge(double deg[JOINT_COUNT], int f, face_half which)
{
    uint32_t random = 2654435761u * (uint32_t)(f + 1);
    for (int i = half_first_joint[which]; i < half_first_joint[which + 1]; ++i) {
        if (i == JOINT_THUMB_ROLL)
            continue;
        random = random * 1664525u + 1013904223u;
        deg[i] += 2.0 * ((double)(random >> 8) / 16777216.0 - 0.5);
    }
}

/* Faces that show what one joint does stay nearly where its meaning puts them. */
static double stiffness(device_kind device, int f)
{
    static const char *const clear[] = {
        "jaw open",  "aa",        "lips closed", "smile",       "frown",        "wide",
        "tongue",    "brows up",  "brows down",  "eyes closed", "left brow up", "right brow up",
        "look left", "look right"};
    for (size_t i = 0; i < sizeof clear / sizeof *clear; ++i)
        if (strcmp(face_recipes[f].name, clear[i]) == 0)
            return device == DEVICE_CURLS ? 0.6 : 0.15;
    return 0.03;
}

static void find(search *s)
{
    enum { ROUNDS = 6000 };
    static const double rest[JOINT_COUNT];
    const pose rest_pose = {{0}};
    const double well = 1.5 * speak_settings_of[s->device][s->half].well;
    for (int k = 0; k < s->count; ++k) {
        memcpy(s->deg[k], s->mean[k], sizeof s->deg[k]);
        nudge(s->deg[k], s->face[k], s->half);
    }
    for (int round = 0; round < ROUNDS; ++round) {
        double move[FACE_COUNT][JOINT_COUNT] = {{0}};
        const double pace = round < ROUNDS / 2 ? 0.5 : 0.2;
        for (int k = 0; k < s->count; ++k) {
            const pose *p = &face_of[s->face[k]];
            push(s, move[k], NULL, s->deg[k], rest, well + wanted_apart(s, p, &rest_pose));
            for (int other = 0; other < k; ++other)
                push(s, move[k], move[other], s->deg[k], s->deg[other],
                     wanted_apart(s, p, &face_of[s->face[other]]));
            for (int i = 0; i < JOINT_COUNT; ++i)
                move[k][i] += stiffness(s->device, s->face[k]) * (s->mean[k][i] - s->deg[k][i]);
        }
        for (int k = 0; k < s->count; ++k) {
            for (int i = 0; i < JOINT_COUNT; ++i)
                s->deg[k][i] += pace * move[k][i];
            make_comfortable(s->deg[k], s->face[k], s->device);
        }
    }
}

/* ---- figures ---- */

static void report(const search *s)
{
    static speak_face faces[FACE_COUNT];
    static speak_half fit;
    double nearest = 1e9, steepest = 0.0, backwards = 0.0;
    int pair[2] = {0, 0}, steep = 0, back = 0;
    for (int k = 0; k < s->count; ++k) {
        memcpy(faces[k].deg, s->deg[k], sizeof faces[k].deg);
        faces[k].pose = face_of[s->face[k]];
        for (int other = 0; other < k; ++other) {
            const double now = hands_apart(s, s->deg[k], s->deg[other]);
            if (now < nearest) {
                nearest = now;
                pair[0] = k;
                pair[1] = other;
            }
        }
    }
    if (!speak_find(&fit, s->half, s->device, faces, s->count)) {
        (void)fprintf(stderr, "two faces have one hand pose\n");
        exit(EXIT_FAILURE);
    }
    for (int k = 0; k < s->count; ++k) {
        enum { STEPS = 60 };
        pose before = {{0}};
        const pose rest = {{0}};
        double far = 0.0, length = 0.0;
        for (int i = 0; i < JOINT_COUNT; ++i)
            length += sq(s->deg[k][i]);
        for (int n = 1; n <= STEPS; ++n) {
            double at[JOINT_COUNT];
            pose now = {{0}};
            for (int i = 0; i < JOINT_COUNT; ++i)
                at[i] = s->deg[k][i] * n / STEPS;
            speak_value(&fit, at, &now);
            const double slope = apart(s->half, &now, &before) * STEPS / sqrt(length);
            const double out = apart(s->half, &now, &rest);
            if (slope > steepest) {
                steepest = slope;
                steep = k;
            }
            if (far - out > backwards) {
                backwards = far - out;
                back = k;
            }
            far = fmax(far, out);
            before = now;
        }
        if (apart(s->half, &before, &face_of[s->face[k]]) > 1e-6)
            (void)fprintf(stderr, "%s is missed\n", face_recipes[s->face[k]].name);
    }
    (void)fprintf(stderr,
                  "device %d, half %d: %d faces; nearest %.1f (%s, %s); at most %.2f mm a degree "
                  "(%s), %.2f mm backwards (%s)\n",
                  (int)s->device, (int)s->half, s->count, nearest,
                  face_recipes[s->face[pair[0]]].name, face_recipes[s->face[pair[1]]].name,
                  steepest, face_recipes[s->face[steep]].name, backwards,
                  face_recipes[s->face[back]].name);
}

/* ---- which faces a device can say, and all of it ---- */

static const double told_apart_mm[DEVICE_KINDS][HALF_COUNT] = {{0.7, 0.7}, {1.2, 3.0}, {2.5, 3.5}};

/* Two fingers are too few for single lids and brows, and for the eyes' turns. */
static bool is_left_out(device_kind device, int f)
{
    static const char *const names[] = {
        "left eye closed", "right eye closed", "look left",     "look right",     "look up",
        "look down",       "left brow up",     "right brow up", "inner brows up", "smile left",
        "smile right",     "frown left",       "frown right",   "sneer",          "cheeks puffed"};
    for (size_t i = 0; device == DEVICE_CURLS && i < sizeof names / sizeof *names; ++i)
        if (strcmp(face_recipes[f].name, names[i]) == 0)
            return true;
    return false;
}

static int same_as(const search *s, int f)
{
    for (int k = 0; k < s->count; ++k)
        if (apart(s->half, &face_of[f], &face_of[s->face[k]]) < told_apart_mm[s->device][s->half])
            return s->face[k];
    return FACE_IS_ITSELF;
}

static void find_all(posed_hand out[FACE_COUNT], device_kind device)
{
    for (int f = 0; f < FACE_COUNT; ++f)
        out[f].same_as = FACE_IS_MISSING;
    for (int which = 0; which < HALF_COUNT; ++which) {
        search s = {.device = device, .half = (face_half)which};
        for (int i = 0; i < JOINT_COUNT; ++i)
            if (joint_traits_of[device][i].noise_deg > 0.0 && i != JOINT_THUMB_ROLL)
                s.weight[i] = 1.4 / joint_traits_of[device][i].noise_deg;
        for (int f = 0; f < FACE_COUNT; ++f) {
            if (!has_face[f] || face_recipes[f].half != s.half || is_left_out(device, f))
                continue;
            out[f].same_as = same_as(&s, f);
            if (out[f].same_as != FACE_IS_ITSELF)
                continue;
            memset(s.mean[s.count], 0, sizeof s.mean[s.count]);
            if (which == HALF_MOUTH)
                mean_mouth(s.mean[s.count], &face_of[f], device);
            else
                mean_upper(s.mean[s.count], &face_of[f], device);
            s.face[s.count++] = f;
        }
        find(&s);
        report(&s);
        for (int k = 0; k < s.count; ++k)
            for (int i = 0; i < JOINT_COUNT; ++i)
                out[s.face[k]].deg[i] = (int8_t)lround(s.deg[k][i]);
    }
    for (int f = 0; f < FACE_COUNT; ++f)
        if (out[f].same_as >= 0)
            memcpy(out[f].deg, out[out[f].same_as].deg, sizeof out[f].deg);
}

static void print(device_kind device, const posed_hand poses[FACE_COUNT])
{
    static const char *const names[] = {"DEVICE_JOINTS", "DEVICE_POINTS", "DEVICE_CURLS"};
    (void)printf("    [%s] =\n        {\n", names[device]);
    for (int f = 0; f < FACE_COUNT; ++f) {
        (void)printf("            /* %s%s */ {{", face_recipes[f].name,
                     face_recipes[f].half == HALF_UPPER ? ", upper half" : "");
        for (int i = 0; i < JOINT_COUNT; ++i)
            (void)printf("%s%d", i > 0 ? ", " : "", poses[f].deg[i]);
        (void)printf("}, %d},\n", poses[f].same_as);
    }
    (void)printf("        },\n");
}

int main(int argument_count, char **arguments)
{
    error err = {""};
    face_file file;
    composer *of;
    const csrbf_settings solver = {0};
    if (argument_count != 2 ||
        face_file_read(&file, arguments[1], NULL, FACE_FILE_USABLE, &err) < 0 ||
        composer_create(&of, &file, &solver, &err) < 0) {
        (void)fprintf(stderr, "usage: find_hands RIG.rig.json >hands.c\n%s\n", err.text);
        return EXIT_FAILURE;
    }
    const mapped_face *mapped = composer_mapped(of);
    fitting fit;
    (void)fitting_find(&fit, &mapped->about);
    mm_scale = fit.scale;
    for (int f = 0; f < FACE_COUNT; ++f)
        has_face[f] =
            face_find(&face_of[f], &face_recipes[f], &fit, mapped->pose, mapped->pose_count);
    (void)printf("/* Written by find_hands from the poses of a rig: do not edit. */\n"
                 "#include \"faces.h\"\n\n/* clang-format off */\n"
                 "const posed_hand posed_hands[DEVICE_KINDS][FACE_COUNT] = {\n");
    for (int device = 0; device < DEVICE_KINDS; ++device) {
        posed_hand poses[FACE_COUNT] = {{{0}, 0}};
        find_all(poses, (device_kind)device);
        print((device_kind)device, poses);
    }
    (void)printf("};\n/* clang-format on */\n");
    composer_destroy(of);
    face_file_destroy(&file);
    return EXIT_SUCCESS;
}
