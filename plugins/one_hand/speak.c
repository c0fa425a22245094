#include "speak.h"

#include "cholesky.h"

#include <math.h>
#include <string.h>

/* The weight of a joint depends on how precisely the device measures it. */
static const double noise_of_weight_1_deg = 1.4;

/* Waypoints are only used with points. With every joint, lips that close for an "m" over an open
 * jaw would move further. With five curls, the lips would pass through other faces more often. */
const speak_settings speak_settings_of[DEVICE_KINDS][HALF_COUNT] = {
    [DEVICE_JOINTS] = {{5.0, 30.0, 9.0}, {4.0, 30.0, 9.0}},
    [DEVICE_POINTS] = {{4.5, 20.0, 9.0, true}, {3.5, 20.0, 9.0}},
    [DEVICE_CURLS] = {{4.0, 30.0, 9.0}, {4.0, 30.0, 9.0}},
};

const double speak_switch_way = 16.0;

/* Wendland's C2 function that is positive definite in n dimensions: l = floor(n/2) + 2,
 * (1 - r)^(l + 1) ((l + 1) r + 1). */
static double wendland(double r, int dimension)
{
    if (r >= 1.0)
        return 0.0;
    const int power = dimension / 2 + 3;
    double out = (double)power * r + 1.0;
    for (int i = 0; i < power; ++i)
        out *= 1.0 - r;
    return out;
}

static double length(const double *v, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; ++i)
        sum += v[i] * v[i];
    return sqrt(sum);
}

static double distance(const double *a, const double *b, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; ++i)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(sum);
}

/* Weighted coordinates without the well: 0 within it, and shorter by 1.5 of its radius beyond 2 of
 * it. */
static bool place(double *out, const speak_half *self, speak_space space,
                  const double deg[JOINT_COUNT])
{
    for (int i = 0; i < self->joint_count; ++i)
        out[i] = self->per_deg[i] * deg[self->first + i];
    if (space == SPEAK_SWITCHED)
        out[JOINT_THUMB_ROLL - self->first] = speak_switch_way * eye_side(self->device, deg);
    const double far = length(out, self->joint_count), beyond = far - self->well;
    if (!(beyond > 0.0)) {
        memset(out, 0, SPEAK_JOINTS_MAX * sizeof *out);
        return false;
    }
    const double left =
        beyond < self->well ? 0.5 * beyond * beyond / self->well : far - 1.5 * self->well;
    for (int i = 0; i < self->joint_count; ++i)
        out[i] *= left / far;
    return true;
}

/* ---- the fit ---- */

/* The seal of the lips and the tongue only act near their own faces. */
static bool is_linear(int value)
{
    return value != POSE_DOFS + DOF_SEAL && value != POSE_DOFS + DOF_TONGUE;
}

/* The mouth uses only the first space. */
static int space_count(const speak_half *self)
{
    return self->half == HALF_UPPER ? SPEAK_SPACES : 1;
}

static speak_space space_of(int value, face_half half)
{
    const int dof = value - POSE_DOFS;
    const bool is_gaze = dof >= DOF_EYE_YAW && dof < DOF_LID_UPPER;
    return half == HALF_UPPER && !is_gaze ? SPEAK_SWITCHED : SPEAK_JOINTS;
}

static void list_values(speak_half *out, const speak_face *faces, int count)
{
    for (int v = 0; v < POSE_COUNT; ++v) {
        bool is_moved = false;
        for (int i = 0; i < count && half_of_value(v) == out->half; ++i)
            is_moved = is_moved || faces[i].pose.value[v] < 0.0 || faces[i].pose.value[v] > 0.0;
        if (!is_moved)
            continue;
        out->space[out->value_count] = space_of(v, out->half);
        out->value[out->value_count++] = v;
    }
}

static double pull_length(const pose *p, int landmark)
{
    return length(p->value + 3 * landmark, 3);
}

static void find_longest(speak_half *out, const speak_face *faces, int count)
{
    for (int landmark = 0; landmark < LANDMARK_COUNT; ++landmark)
        for (int i = 0; i < count; ++i)
            out->longest[landmark] =
                fmax(out->longest[landmark], pull_length(&faces[i].pose, landmark));
}

/* Limits the pulls: exact up to the longest pull of a face, and never longer than 1.3 times
 * that. */
static void limit_pulls(const speak_half *self, pose *p)
{
    for (int landmark = 0; landmark < LANDMARK_COUNT; ++landmark) {
        const double most = self->longest[landmark], now = pull_length(p, landmark);
        if (half_of_value(3 * landmark) != self->half || !(now > most))
            continue;
        const double shown = most + curve_limit(now - most, 0.3 * most, 0.3 * most);
        for (int axis = 0; axis < 3; ++axis)
            p->value[3 * landmark + axis] *= shown / now;
    }
}

/* Returns the mean distance of a face to its neighbour, without waypoints. */
static double mean_nearest(const speak_half *self, speak_space space, int face_count)
{
    const double(*centre)[SPEAK_JOINTS_MAX] = self->centre[space];
    double sum = 0.0;
    for (int i = 0; i <= face_count; ++i) {
        double nearest = 1e9;
        for (int j = 0; j <= face_count; ++j)
            if (i != j)
                nearest = fmin(nearest, distance(centre[i], centre[j], self->joint_count));
        sum += nearest;
    }
    return sum / (face_count + 1);
}

/* Ridge regression without a constant, so that the rest pose stays at rest. */
static void find_linear(speak_half *out, speak_space space, const speak_face *faces, int count,
                        double ridge)
{
    cholesky m;
    double(*centre)[SPEAK_JOINTS_MAX] = out->centre[space];
    const int joints = out->joint_count;
    for (int a = 0; a < joints; ++a)
        for (int b = 0; b <= a; ++b) {
            m.at[a][b] = a == b ? ridge * count : 0.0;
            for (int i = 1; i <= count; ++i)
                m.at[a][b] += centre[i][a] * centre[i][b];
        }
    (void)cholesky_factor(&m, joints); /* the ridge makes it positive definite */
    for (int v = 0; v < out->value_count; ++v) {
        double column[CHOLESKY_MAX] = {0.0};
        if (out->space[v] != space || !is_linear(out->value[v]))
            continue;
        for (int a = 0; a < joints; ++a)
            for (int i = 1; i <= count; ++i)
                column[a] += centre[i][a] * faces[i - 1].pose.value[out->value[v]];
        cholesky_solve(&m, joints, column);
        memcpy(out->linear[v], column, sizeof out->linear[v]);
    }
}

static double linear_value(const speak_half *self, int v, const double *at)
{
    double sum = 0.0;
    for (int a = 0; a < self->joint_count; ++a)
        sum += self->linear[v][a] * at[a];
    return sum;
}

/* ---- waypoints ---- */

typedef struct waypoint { /* a point on the way from the rest pose to a face */
    int face;             /* index */
    double share;
} waypoint;

static bool is_free(const speak_half *self, const double *at)
{
    static const double least = 2.0; /* weighted degrees: nearer centres would conflict */
    for (int i = 0; i < self->centre_count; ++i)
        if (distance(at, self->centre[SPEAK_JOINTS][i], self->joint_count) < least)
            return false;
    return true;
}

/* Finds the two faces with the widest jaws. Returns their number. */
static int find_widest(int out[2], const speak_face *faces, int count)
{
    int found = 0;
    for (int n = 0; n < 2; ++n) {
        double widest = 0.0;
        for (int i = 0; i < count; ++i) {
            const double open = faces[i].pose.value[POSE_DOFS + DOF_JAW_OPEN];
            if (open > widest && (n == 0 || i != out[0])) {
                widest = open;
                out[n] = i;
                found = n + 1;
            }
        }
    }
    return found;
}

/* Adds centres that make the jaw open evenly. The jaw of most faces is nearly closed, so it would
 * otherwise open late and then quickly. */
static void find_waypoints(waypoint out[SPEAK_WAYPOINTS], speak_half *half, const speak_face *faces,
                           int count)
{
    static const double shares[] = {0.25, 0.5};
    int widest[2], found = 0;
    const int face_count = find_widest(widest, faces, count);
    for (int n = 0; n < 2 * face_count; ++n) {
        const waypoint to = {widest[n / 2], shares[n % 2]};
        double *at = half->centre[SPEAK_JOINTS][half->centre_count];
        for (int i = 0; i < half->joint_count; ++i)
            at[i] = to.share * half->centre[SPEAK_JOINTS][1 + to.face][i];
        if (!is_free(half, at))
            continue;
        out[found++] = to;
        half->centre_count += 1;
    }
}

static bool find_residual(speak_half *out, speak_space space, const speak_face *faces, int count,
                          const waypoint *waypoints)
{
    cholesky m;
    double(*centre)[SPEAK_JOINTS_MAX] = out->centre[space];
    for (int i = 0; i < out->centre_count; ++i)
        for (int j = 0; j <= i; ++j)
            m.at[i][j] =
                wendland(distance(centre[i], centre[j], out->joint_count) / out->radius[space],
                         out->joint_count);
    if (!cholesky_factor(&m, out->centre_count))
        return false;
    for (int v = 0; v < out->value_count; ++v) {
        double column[CHOLESKY_MAX] = {0.0};
        if (out->space[v] != space)
            continue;
        for (int i = 1; i < out->centre_count; ++i) {
            const waypoint to = i <= count ? (waypoint){i - 1, 1.0} : waypoints[i - count - 1];
            const double wanted = to.share * faces[to.face].pose.value[out->value[v]];
            column[i] = wanted - linear_value(out, v, centre[i]);
        }
        cholesky_solve(&m, out->centre_count, column);
        for (int i = 0; i < out->centre_count; ++i)
            out->residual[i][v] = column[i];
    }
    return true;
}

bool speak_find(speak_half *out, face_half which, device_kind device, const speak_face *faces,
                int count)
{
    const speak_settings *with = &speak_settings_of[device][which];
    memset(out, 0, sizeof *out);
    out->half = which;
    out->device = device;
    out->first = half_first_joint[which];
    out->joint_count = half_first_joint[which + 1] - out->first;
    out->well = with->well;
    for (int i = 0; i < out->joint_count; ++i) {
        const double noise = joint_traits_of[device][out->first + i].noise_deg;
        out->per_deg[i] = noise > 0.0 ? noise_of_weight_1_deg / noise : 0.0;
    }
    if (count > SPEAK_FACES_MAX)
        count = SPEAK_FACES_MAX;
    out->centre_count = 1 + count;
    list_values(out, faces, count);
    find_longest(out, faces, count);
    bool is_found = true;
    waypoint waypoints[SPEAK_WAYPOINTS];
    for (speak_space space = 0; (int)space < space_count(out); ++space) {
        for (int i = 1; i <= count; ++i)
            (void)place(out->centre[space][i], out, space, faces[i - 1].deg);
        out->radius[space] = with->radius * mean_nearest(out, space, count);
        if (with->has_waypoints && space == SPEAK_JOINTS)
            find_waypoints(waypoints, out, faces, count);
        find_linear(out, space, faces, count, with->ridge);
        is_found = find_residual(out, space, faces, count, waypoints) && is_found;
    }
    return is_found;
}

void speak_value(const speak_half *self, const double deg[JOINT_COUNT], pose *out)
{
    double at[SPEAK_SPACES][SPEAK_JOINTS_MAX], felt[SPEAK_SPACES][SPEAK_CENTRES_MAX];
    bool is_moved[SPEAK_SPACES];
    for (speak_space space = 0; (int)space < space_count(self); ++space) {
        is_moved[space] = place(at[space], self, space, deg);
        for (int i = 0; i < self->centre_count && is_moved[space]; ++i)
            felt[space][i] =
                wendland(distance(at[space], self->centre[space][i], self->joint_count) /
                             self->radius[space],
                         self->joint_count);
    }
    for (int v = 0; v < self->value_count; ++v) {
        const speak_space space = self->space[v];
        double sum = is_moved[space] ? linear_value(self, v, at[space]) : 0.0;
        for (int i = 0; i < self->centre_count && is_moved[space]; ++i)
            sum += felt[space][i] * self->residual[i][v];
        out->value[self->value[v]] = sum;
    }
    limit_pulls(self, out);
}
