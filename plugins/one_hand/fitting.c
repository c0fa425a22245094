#include "fitting.h"

#include "mapping.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof *(array)))

/* ---- finding ---- */

static uint32_t find_contact(const mrt_face *face, const char *name)
{
    for (uint32_t i = 0; i < face->contact_count; ++i)
        if (face->contacts[i].name && strcmp(face->contacts[i].name, name) == 0)
            return i;
    return FITTING_NONE;
}

static uint32_t find_dof(const mrt_face *face, const char *name)
{
    for (uint32_t i = 0; i < face->dof_count && i < MRT_MAX_DOFS; ++i)
        if (face->dofs[i].name && strcmp(face->dofs[i].name, name) == 0)
            return i;
    return FITTING_NONE;
}

static bool has_pair(const fitting *self, int landmark)
{
    return self->contact[landmark] != FITTING_NONE && self->contact[landmark + 1] != FITTING_NONE;
}

static double apart(const fitting *self, int landmark)
{
    mrt_vec3 a = self->start[landmark], b = self->start[landmark + 1];
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y,
           z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}

static void insert(double *sorted, int count, double value)
{
    for (; count > 0 && sorted[count - 1] > value; --count)
        sorted[count] = sorted[count - 1];
    sorted[count] = value;
}

/* Scale relative to a head whose pupils are 63 mm apart: the median of the available measures.
 * Puppets may have wide mouths or high foreheads, but rarely are all measures unusual. */
static double scale_of(const fitting *self, const mrt_face *face)
{
    static const struct measure {
        int landmark;
        double mm;
    } measures[] = {{LANDMARK_MOUTH_CORNER, 52},
                    {LANDMARK_BROW_MID, 66},
                    {LANDMARK_BROW_INNER, 30},
                    {LANDMARK_BROW_OUTER, 100}};
    double scales[1 + COUNT_OF(measures)];
    int count = 0;
    double height = ((double)face->high.y - (double)face->low.y) / 240.0;
    if (isfinite(height) && height > 0.0)
        insert(scales, count++, height);
    for (int i = 0; i < COUNT_OF(measures); ++i) {
        double mm = has_pair(self, measures[i].landmark) ? apart(self, measures[i].landmark) : 0.0;
        if (isfinite(mm) && mm > 0.0)
            insert(scales, count++, mm / measures[i].mm);
    }
    return count > 0 ? 0.5 * (scales[(count - 1) / 2] + scales[count / 2]) : 1.0;
}

static bool is_lid(int dof)
{
    return dof >= DOF_LID_UPPER && dof < DOF_SEAL;
}

static bool is_length(int dof)
{
    return dof == DOF_JAW_LATERAL || dof == DOF_JAW_FORWARD;
}

/* Limits of a pose's values. A missing degree of freedom has no limit, because its substitute has
 * its own range. */
static void limit_dofs(fitting *self, const mrt_face *face)
{
    for (int i = 0; i < DOF_COUNT; ++i) {
        double most = is_lid(i) || i == DOF_SEAL ? 1.0 : is_length(i) ? 30.0 : 1.5;
        self->low[i] =
            is_lid(i) || i == DOF_JAW_OPEN || i == DOF_SEAL || i == DOF_TONGUE ? 0.0 : -most;
        self->high[i] = most;
        self->lowest[i] = self->low[i];
        if (self->dof[i] == FITTING_NONE)
            continue;
        const mrt_dof *dof = &face->dofs[self->dof[i]];
        double min = fmin((double)dof->min, 0.0), max = fmax((double)dof->max, 0.0);
        if (is_lid(i)) {
            self->closed[i] = isfinite(max) ? max : 0.0;
            self->lowest[i] = self->closed[i] > 0.0 ? fmax(-1.0, min / self->closed[i]) : 0.0;
        } else {
            double unit = is_length(i) ? self->scale : 1.0;
            self->low[i] = self->lowest[i] = fmax(self->low[i], min / unit);
            self->high[i] = fmin(self->high[i], max / unit);
        }
    }
}

bool fitting_find(fitting *out, const mrt_face *face)
{
    *out = (fitting){.scale = 1.0};
    for (int i = 0; i < LANDMARK_COUNT; ++i) {
        out->contact[i] = find_contact(face, pose_landmark_names[i]);
        if (out->contact[i] == FITTING_NONE)
            continue;
        out->start[i] = face->contacts[out->contact[i]].rest;
        out->contact_count += 1;
    }
    for (int i = 0; i < DOF_COUNT; ++i) {
        out->dof[i] = find_dof(face, pose_dof_names[i]);
        out->dof_count += out->dof[i] != FITTING_NONE;
    }
    out->scale = scale_of(out, face);
    limit_dofs(out, face);
    return out->contact_count + out->dof_count > 0;
}

/* ---- reporting ---- */

enum { LINE = 200 }; /* hosts may cut longer ones */

/* Logs "misses X: a, b" in lines of readable length. */
static void report_missing(const mrt_host *host, const char *what, const char *const *names,
                           const uint32_t *found, int count)
{
    char line[LINE];
    size_t head = (size_t)snprintf(line, sizeof line, "the face has no %s", what), used = head;
    for (int i = 0; i < count; ++i) {
        if (found[i] != FITTING_NONE)
            continue;
        if (used + strlen(names[i]) + 3 > sizeof line) {
            host->log(host, MRT_LOG_INFO, line);
            used = head;
        }
        used += (size_t)snprintf(line + used, sizeof line - used, "%s %s", used > head ? "," : "",
                                 names[i]);
    }
    if (used > head)
        host->log(host, MRT_LOG_INFO, line);
}

/* Logs missing parts of a face with everyday names; the exact names are for the author of the
 * rig. */
static void report_parts(const fitting *self, const mrt_host *host)
{
    static const struct {
        const char *name;
        int first, last; /* degrees of freedom */
    } parts[] = {{"jaw", DOF_JAW_OPEN, DOF_JAW_FORWARD},
                 {"neck", DOF_NOD, DOF_TURN},
                 {"eyes", DOF_EYE_YAW, DOF_EYE_PITCH + 1},
                 {"lids", DOF_LID_UPPER, DOF_LID_LOWER + 1}};
    char line[LINE] = "this face has no ";
    uint32_t count = 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
        bool is_there = false;
        for (int dof = parts[i].first; dof <= parts[i].last; ++dof)
            is_there |= self->dof[dof] != FITTING_NONE;
        const size_t used = strlen(line);
        if (!is_there)
            (void)snprintf(line + used, sizeof line - used, "%s%s", count++ > 0 ? ", no " : "",
                           parts[i].name);
    }
    const size_t used = strlen(line);
    (void)snprintf(line + used, sizeof line - used, ": the hand moves the other parts");
    if (count > 0)
        host->log(host, MRT_LOG_WARNING, line);
}

void fitting_report(const fitting *self, const mrt_host *host)
{
    char line[LINE];
    snprintf(
        line, sizeof line,
        "moves %u of %d contacts and %u of %d degrees of freedom; movements are scaled by %.2f "
        "to the size of this face",
        self->contact_count, LANDMARK_COUNT, self->dof_count, DOF_COUNT, self->scale);
    host->log(host, MRT_LOG_INFO, line);
    report_parts(self, host);
    report_missing(host, "contact", pose_landmark_names, self->contact, LANDMARK_COUNT);
    report_missing(host, "degree of freedom", pose_dof_names, self->dof, DOF_COUNT);
}

/* ---- writing ---- */

/* Movement of the skin in place of a missing jaw bone, per mm at the incisors. */
static const pose_part drop_parts[] = {
    {LANDMARK_CHIN, 0, -1, -0.3},
    {LANDMARK_LIP_LOWER_MID, 0, -0.9, -0.2},
    {LANDMARK_LIP_LOWER_SIDE, 0, -0.75, -0.2},
    {LANDMARK_JAW_ANGLE, 0, -0.25, -0.1},
    {LANDMARK_MOUTH_CORNER, 0, -0.35, -0.05},
    {LANDMARK_CHEEK_LOWER, 0, -0.3, 0},
};
static const struct carried {
    int landmark;
    double share;
} carried[] = {{LANDMARK_CHIN, 1},
               {LANDMARK_LIP_LOWER_MID, 1},
               {LANDMARK_LIP_LOWER_SIDE, 0.85},
               {LANDMARK_LIP_LOWER_SIDE + 1, 0.85},
               {LANDMARK_JAW_ANGLE, 0.5},
               {LANDMARK_JAW_ANGLE + 1, 0.5}};

static double dof_value(const fitting *self, const pose *p, const double *low, int dof)
{
    return clamp(p->value[POSE_DOFS + dof], low[dof], self->high[dof]);
}

static void carry(pose *p, int axis, double mm)
{
    for (int i = 0; i < COUNT_OF(carried); ++i)
        p->value[3 * carried[i].landmark + axis] += carried[i].share * mm;
}

/* Adds pulls in place of the jaw's missing degrees of freedom. */
static void stand_in(const fitting *self, pose *p, double lever_mm)
{
    if (self->dof[DOF_JAW_OPEN] == FITTING_NONE)
        pose_add(p, drop_parts, COUNT_OF(drop_parts),
                 lever_mm * dof_value(self, p, self->low, DOF_JAW_OPEN));
    if (self->dof[DOF_JAW_LATERAL] == FITTING_NONE)
        carry(p, 0, dof_value(self, p, self->low, DOF_JAW_LATERAL));
    if (self->dof[DOF_JAW_FORWARD] == FITTING_NONE)
        carry(p, 2, dof_value(self, p, self->low, DOF_JAW_FORWARD));
}

static void limit_pulls(pose *p, double reach_mm)
{
    for (int landmark = 0; landmark < LANDMARK_COUNT; ++landmark) {
        double *v = p->value + 3 * landmark;
        double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        double most = curve_limit(length, reach_mm, reach_mm);
        if (most < length)
            for (int axis = 0; axis < 3; ++axis)
                v[axis] *= most / length;
    }
}

/* Settings of writing a face. The classic modes never widen the eyes, and use neither the seal of
 * the lips nor the tongue. */
typedef struct writing {
    const double *low;
    int dof_count;
    double size; /* mm of this face per mm of a pose */
    double closure, lower_share;
} writing;

static void write_dofs(const fitting *self, const pose *p, const writing *how, mrt_pull *pull)
{
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
    for (int i = 0; i < how->dof_count; ++i) {
        if (self->dof[i] == FITTING_NONE)
            continue;
        double value = dof_value(self, p, how->low, i);
        if (is_lid(i)) {
            double share = i >= DOF_LID_LOWER ? how->lower_share : 1.0;
            value = (1.0 - (1.0 - value) * (1.0 - share * how->closure)) * self->closed[i];
        } else if (is_length(i)) {
            value =
                clamp(value * how->size, self->low[i] * self->scale, self->high[i] * self->scale);
        }
        pull->dof[self->dof[i]] = (float)(value + 0.0); /* never -0 */
    }
}

static void write_pull(const fitting *self, const pose *p, const writing *how, mrt_pull *pull)
{
    mrt_vector vector[LANDMARK_COUNT];
    uint32_t count = 0;
    for (int landmark = 0; landmark < LANDMARK_COUNT; ++landmark) {
        if (self->contact[landmark] == FITTING_NONE)
            continue;
        const double *v = p->value + 3 * landmark;
        mrt_vec3 start = self->start[landmark];
        mrt_vec3 end = {start.x + (float)(how->size * v[0]), start.y + (float)(how->size * v[1]),
                        start.z + (float)(how->size * v[2])};
        vector[count++] = (mrt_vector){start, end, 1 + self->contact[landmark]};
    }
    write_dofs(self, p, how, pull);
    mapping_pull(pull, vector, count, 0.0f);
}

static double size_of(const fitting *self, const double *params)
{
    return self->scale * 0.01 * params[SET_SIZE];
}

void fitting_write(const fitting *self, const pose *shown, double closure, const double *params,
                   mrt_pull *pull)
{
    pose p = *shown;
    const writing how = {self->lowest, DOF_COUNT, size_of(self, params), closure, 1.0};
    stand_in(self, &p, params[SET_LEVER]);
    write_pull(self, &p, &how, pull);
}

void fitting_write_classic(const fitting *self, const pose *shown, double closure,
                           const double *params, mrt_pull *pull)
{
    pose p = *shown;
    const writing how = {self->low, DOF_SEAL, size_of(self, params), closure,
                         0.01 * params[SET_LOWER_LID]};
    limit_pulls(&p, params[SET_REACH]);
    stand_in(self, &p, params[SET_LEVER]);
    write_pull(self, &p, &how, pull);
}

void fitting_add(pose *out, const fitting *self, const mrt_rig_pose *from, double share)
{
    for (int i = 0; i < LANDMARK_COUNT; ++i) {
        if (self->contact[i] == FITTING_NONE)
            continue;
        const mrt_vec3 mm = from->pulls[self->contact[i]];
        out->value[3 * i] += share * (double)mm.x / self->scale;
        out->value[3 * i + 1] += share * (double)mm.y / self->scale;
        out->value[3 * i + 2] += share * (double)mm.z / self->scale;
    }
    for (int i = 0; i < DOF_COUNT; ++i) {
        if (self->dof[i] == FITTING_NONE)
            continue;
        double unit = is_length(i) ? self->scale : is_lid(i) ? self->closed[i] : 1.0;
        if (unit > 0.0)
            out->value[POSE_DOFS + i] += share * (double)from->dofs[self->dof[i]] / unit;
    }
}
