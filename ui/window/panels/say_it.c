#include "window/panels/say_it.h"

#include "face/rig/rig_poses.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define VISEME(name)                                                                               \
    {                                                                                              \
        name,                                                                                      \
        {                                                                                          \
            "viseme_" name                                                                         \
        }                                                                                          \
    }

/* clang-format off */
const goal goals[GOAL_COUNT] = {
    {"PP", {VISEME("PP")}},
    {"FF", {VISEME("FF")}},
    {"aa", {VISEME("aa")}},
    {"I", {VISEME("I")}},
    {"O", {VISEME("O")}},
    {"U", {VISEME("U")}},
    {"smile", {{"smile", {"mouthSmileLeft", "mouthSmileRight"}}}},
    {"joy", {{"joy", {"joy"}}}},
    {"sadness", {{"sadness", {"sadness"}}}},
    {"anger", {{"anger", {"anger"}}}},
    {"surprise", {{"surprise", {"surprise"}}}},
    {"wink left", {{"wink left", {"wink_left"}}}},

    {"oh", {VISEME("O")}},
    {"you", {VISEME("I"), VISEME("U")}},
    {"mama", {VISEME("PP"), VISEME("aa"), VISEME("PP"), VISEME("aa")}},
    {"bee", {VISEME("PP"), VISEME("I")}},
    {"boo", {VISEME("PP"), VISEME("U")}},
    {"five", {VISEME("FF"), VISEME("aa"), VISEME("I"), VISEME("FF")}},
    {"hello", {VISEME("E"), VISEME("nn"), VISEME("O")}},
    {"oh boy", {VISEME("O"), VISEME("PP"), VISEME("O"), VISEME("I")}},
    {"moon", {VISEME("PP"), VISEME("U"), VISEME("nn")}},
    {"fish", {VISEME("FF"), VISEME("I"), VISEME("CH")}},
};
/* clang-format on */

static const double hold_s = 0.25, hold_in_word_s = 0.08;
static const double near_mm = 2.0, near_share = 0.15, near_most_share = 0.5;
static const double moved_mm = 0.5; /* smaller movements do not belong to the goal */

uint32_t goal_step_count(const goal *of)
{
    uint32_t count = 0;
    while (count < GOAL_STEPS && of->step[count].name)
        count += 1;
    return count;
}

static const rig_pose *pose_named(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (strcmp(r->pose[i].name, name) == 0)
            return &r->pose[i];
    return NULL;
}

bool goal_is_available(const goal *of, const rig *r)
{
    bool is_there = r != NULL;
    for (uint32_t i = 0; is_there && i < goal_step_count(of); ++i)
        for (uint32_t k = 0; k < GOAL_POSES && of->step[i].pose[k]; ++k)
            is_there = is_there && pose_named(r, of->step[i].pose[k]);
    return is_there;
}

/* ---- faces ---- */

/* Returns the visible movement of a degree of freedom on an adult head, mm per unit. */
static double mm_of_dof(const mrt_dof *dof)
{
    static const struct {
        const char *starts;
        double mm;
    } levers[] = {{"jaw.", 60.0}, {"lid_upper", 24.0}, {"lid_lower", 9.0},
                  {"eye", 12.0},  {"lips.seal", 5.0},  {"tongue", 40.0}};
    if (strcmp(dof->unit, "mm") == 0)
        return 1.0;
    for (size_t i = 0; i < sizeof levers / sizeof *levers; ++i)
        if (strncmp(dof->name, levers[i].starts, strlen(levers[i].starts)) == 0)
            return levers[i].mm;
    return 0.0; /* head rotation is not part of an expression */
}

static void count_parts(goal_face *out, const mrt_face *about)
{
    out->contact_count =
        about->contact_count < LIVE_CONTACTS_MAX ? about->contact_count : LIVE_CONTACTS_MAX;
    out->dof_count = about->dof_count < MRT_MAX_DOFS ? about->dof_count : MRT_MAX_DOFS;
}

static void add_pose(goal_face *out, const rig_pose *pose, const mrt_face *about)
{
    for (uint32_t i = 0; i < pose->pull_count + pose->follow_count; ++i)
        if (pose->pull_contact[i] < out->contact_count) {
            vec3 *to = &out->pull_mm[pose->pull_contact[i]];
            *to = vec3_add(*to, pose->pull_mm[i]);
        }
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        for (uint32_t d = 0; d < out->dof_count; ++d)
            if (strcmp(about->dofs[d].name, pose->dof_name[i]) == 0)
                out->dof_mm[d] += mm_of_dof(&about->dofs[d]) * pose->dof_value[i];
}

static bool is_of_part(rig_pose_part part, rig_pose_part wanted)
{
    return wanted == POSE_WHOLE || part == POSE_WHOLE || part == wanted;
}

bool goal_face_of_rig(goal_face *out, const goal_step *step, const rig *r, const mrt_face *about)
{
    rig_pose_part part[LIVE_CONTACTS_MAX];
    vec3 at[LIVE_CONTACTS_MAX];
    memset(out, 0, sizeof *out);
    count_parts(out, about);
    if (r->contact_count != about->contact_count || r->contact_count > LIVE_CONTACTS_MAX)
        return false; /* the stage shows another face */
    for (uint32_t i = 0; i < out->contact_count; ++i)
        at[i] = (vec3){(double)about->contacts[i].rest.x, (double)about->contacts[i].rest.y,
                       (double)about->contacts[i].rest.z};
    rig_poses_contact_parts(part, r, at);
    for (uint32_t k = 0; k < GOAL_POSES && step->pose[k]; ++k) {
        const rig_pose *pose = pose_named(r, step->pose[k]);
        if (!pose)
            return false;
        add_pose(out, pose, about);
        for (uint32_t i = 0; i < out->contact_count; ++i)
            out->has_contact[i] = out->has_contact[i] || is_of_part(part[i], pose->part);
        for (uint32_t d = 0; d < out->dof_count; ++d)
            out->has_dof[d] =
                out->has_dof[d] || is_of_part(rig_poses_dof_part(about->dofs[d].name), pose->part);
    }
    return true;
}

void goal_face_of_pull(goal_face *out, const mrt_pull *pull, const float *posed_dof,
                       const mrt_face *about)
{
    memset(out, 0, sizeof *out);
    count_parts(out, about);
    for (uint32_t i = 0; i < pull->count && i < MRT_MAX_VECTORS && pull->mode != MRT_IDLE; ++i) {
        const mrt_vector *v = &pull->vector[i];
        if (v->contact == 0 || v->contact > out->contact_count)
            continue;
        out->pull_mm[v->contact - 1] =
            (vec3){(double)v->end.x - (double)v->start.x, (double)v->end.y - (double)v->start.y,
                   (double)v->end.z - (double)v->start.z};
    }
    for (uint32_t d = 0; d < out->dof_count; ++d) {
        const float value = isfinite(pull->dof[d]) ? pull->dof[d] : posed_dof[d];
        out->dof_mm[d] = mm_of_dof(&about->dofs[d]) * (double)value;
    }
}

/* Returns the sum of squared differences between two faces over the parts of the goal. `from` NULL:
 * neutral face. */
static double squares(const goal_face *wanted, const goal_face *from, uint32_t *out_moved)
{
    double sum = 0.0;
    *out_moved = 0;
    for (uint32_t i = 0; i < wanted->contact_count; ++i) {
        const vec3 zero = {0.0, 0.0, 0.0};
        if (!wanted->has_contact[i])
            continue;
        const double by = vec3_length(vec3_sub(wanted->pull_mm[i], from ? from->pull_mm[i] : zero));
        sum += by * by;
        *out_moved += vec3_length(wanted->pull_mm[i]) >= moved_mm;
    }
    for (uint32_t d = 0; d < wanted->dof_count; ++d) {
        if (!wanted->has_dof[d])
            continue;
        const double by = wanted->dof_mm[d] - (from ? from->dof_mm[d] : 0.0);
        sum += by * by;
        *out_moved += fabs(wanted->dof_mm[d]) >= moved_mm;
    }
    return sum;
}

goal_distance goal_measure(const goal_face *wanted, const goal_face *performed)
{
    uint32_t moved;
    const double size2 = squares(wanted, NULL, &moved), off2 = squares(wanted, performed, &moved);
    const double count = moved > 0 ? (double)moved : 1.0;
    const double size_mm = sqrt(size2 / count);
    goal_distance out = {.off_mm = sqrt(off2 / count),
                         .limit_mm =
                             fmin(fmax(near_mm, near_share * size_mm), near_most_share * size_mm)};
    const double way_mm = size_mm - out.limit_mm;
    out.closed = way_mm > 0.0 ? 1.0 - (out.off_mm - out.limit_mm) / way_mm : 0.0;
    out.closed = fmin(fmax(out.closed, 0.0), 1.0);
    return out;
}

/* ---- the exercise ---- */

static void show_goal(say_it *self, uint32_t at)
{
    self->at = at;
    self->step = 0;
    self->held_s = self->since_s = 0.0;
}

static uint32_t next_of(const say_it *self, uint32_t from)
{
    while (from < GOAL_COUNT && !self->is_there[from])
        from += 1;
    return from;
}

void say_it_begin(say_it *self, const rig *r)
{
    memset(self, 0, sizeof *self);
    for (uint32_t i = 0; i < GOAL_COUNT; ++i)
        self->is_there[i] = goal_is_available(&goals[i], r);
    show_goal(self, next_of(self, 0));
}

const goal_step *say_it_step(const say_it *self)
{
    return self->at < GOAL_COUNT ? &goals[self->at].step[self->step] : NULL;
}

bool say_it_update(say_it *self, const goal_distance *how, double dt_s)
{
    if (self->at >= GOAL_COUNT)
        return false;
    const uint32_t steps = goal_step_count(&goals[self->at]);
    self->since_s += dt_s;
    self->held_s = how->off_mm <= how->limit_mm ? self->held_s + dt_s : 0.0;
    if (self->held_s < (steps > 1 ? hold_in_word_s : hold_s))
        return false;
    self->held_s = 0.0;
    self->step += 1;
    if (self->step < steps)
        return true;
    self->is_met[self->at] = true;
    self->took_s[self->at] = self->since_s;
    show_goal(self, next_of(self, self->at + 1));
    return true;
}

void say_it_skip(say_it *self)
{
    if (self->at < GOAL_COUNT)
        show_goal(self, next_of(self, self->at + 1));
}

void say_it_back(say_it *self)
{
    for (uint32_t i = self->at; i > 0; --i)
        if (self->is_there[i - 1]) {
            show_goal(self, i - 1);
            return;
        }
    if (self->at < GOAL_COUNT)
        show_goal(self, self->at);
}

uint32_t say_it_progress(const say_it *self, uint32_t *out_of, double *out_s)
{
    uint32_t count = 0;
    *out_of = 0;
    *out_s = 0.0;
    for (uint32_t i = 0; i < GOAL_COUNT; ++i) {
        *out_of += self->is_there[i];
        count += self->is_met[i];
        *out_s += self->is_met[i] ? self->took_s[i] : 0.0;
    }
    return count;
}
