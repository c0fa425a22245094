#include "face/fit/fit_solve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POSE_STEPS = 24, DAMPING_TRIES = 8 };

mrt_result fit_solver_create(fit_solver *out, const bones *b, const fit_gram *gram, double ridge,
                             error *err)
{
    size_t column_count = gram->column_count, unknown = 3 * (size_t)gram->control_count;
    *out = (fit_solver){.bones = b, .gram = gram, .ridge = ridge, .unknown = (uint32_t)unknown};
    arrays *a = &out->arrays;
    out->weight = arrays_add(a, 3 * column_count, sizeof *out->weight);
    out->slope = arrays_add(a, MRT_MAX_DOFS * 3 * column_count, sizeof *out->slope);
    out->matrix = arrays_add(a, unknown * unknown, sizeof *out->matrix);
    out->vector = arrays_add(a, unknown, sizeof *out->vector);
    out->cross = arrays_add(a, MRT_MAX_DOFS * unknown, sizeof *out->cross);
    out->product = arrays_add(a, 3 * column_count, sizeof *out->product);
    out->control_column = arrays_add(a, column_count, sizeof *out->control_column);
    out->control_start = arrays_add(a, gram->control_count + (size_t)1, sizeof *out->control_start);
    if (a->failed) {
        fit_solver_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory to fit %u controls", gram->control_count);
    }
    uint32_t at = 0;
    for (uint32_t k = 0; k < gram->control_count; k++) {
        for (uint32_t j = 0; j < gram->column_count; j++)
            if (gram->column[j].control == k)
                out->control_column[at++] = j;
        out->control_start[k + 1] = at;
    }
    return MRT_OK;
}

void fit_solver_destroy(fit_solver *s)
{
    arrays_free(&s->arrays);
    *s = (fit_solver){0};
}

/* ---- dense symmetric systems ---- */

/* Computes the lower Cholesky factor in place. Returns false if `a` is not positive definite. */
static bool factor(double *a, uint32_t count)
{
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = a[i * count + j];
            for (size_t k = 0; k < j; k++)
                sum -= a[i * count + k] * a[j * count + k];
            if (i != j)
                a[i * count + j] = sum / a[j * count + j];
            else if (sum > 0)
                a[i * count + i] = sqrt(sum);
            else
                return false;
        }
    return true;
}

static void solve_forward(const double *a, double *x, uint32_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < i; k++)
            x[i] -= a[i * count + k] * x[k];
        x[i] /= a[i * count + i];
    }
}

static void solve_backward(const double *a, double *x, uint32_t count)
{
    for (size_t i = count; i-- > 0;) {
        for (size_t k = i + 1; k < count; k++)
            x[i] -= a[k * count + i] * x[k];
        x[i] /= a[i * count + i];
    }
}

static double dot(const double *a, const double *b, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* ---- weights of the columns ---- */

static void set_row(double *out, vec3 v)
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

static vec3 row(const double *from)
{
    return (vec3){from[0], from[1], from[2]};
}

static vec3 motion_weight(const rigid *pose, uint32_t axis)
{
    if (axis == 3)
        return pose->t;
    return (vec3){pose->r[0][axis] - (axis == 0), pose->r[1][axis] - (axis == 1),
                  pose->r[2][axis] - (axis == 2)};
}

/* pull NULL: no control is pulled. */
static void weigh(const fit_solver *s, double *out, const rigid *pose, const double *pull)
{
    for (size_t j = 0; j < s->gram->column_count; j++) {
        const fit_column *c = &s->gram->column[j];
        vec3 weight = {0, 0, 0};
        if (c->control == RIG_NONE)
            weight = motion_weight(&pose[c->bone], c->axis);
        else if (pull != NULL)
            weight = rigid_rotate(&pose[c->bone], row(pull + 3 * (size_t)c->control));
        set_row(out + 3 * j, weight);
    }
}

/* out := gram weight */
static void multiply(const fit_solver *s, double *out, const double *weight)
{
    size_t count = s->gram->column_count;
    memset(out, 0, 3 * count * sizeof *out);
    for (size_t j = 0; j < count; j++) {
        const double *w = weight + 3 * j, *entry = s->gram->gram + j * count;
        if (w[0] == 0 && w[1] == 0 && w[2] == 0)
            continue;
        for (size_t i = 0; i < count; i++)
            for (size_t axis = 0; axis < 3; axis++)
                out[3 * i + axis] += entry[i] * w[axis];
    }
}

/* Sums a control's columns, each rotated back into the rest frame of its bone. */
static void gather(const fit_solver *s, double *out, const rigid *pose, const double *from)
{
    for (uint32_t k = 0; k < s->gram->control_count; k++) {
        vec3 sum = {0, 0, 0};
        for (uint32_t i = s->control_start[k]; i < s->control_start[k + 1]; i++) {
            size_t j = s->control_column[i];
            rigid back = rigid_inverse(&pose[s->gram->column[j].bone]);
            sum = vec3_add(sum, rigid_rotate(&back, row(from + 3 * j)));
        }
        set_row(out + 3 * (size_t)k, sum);
    }
}

/* ---- the pulls ---- */

static void add_block(double *at, uint32_t stride, const rigid *a, const rigid *b, double scale)
{
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++) {
            double sum = 0;
            for (size_t k = 0; k < 3; k++)
                sum += a->r[k][i] * b->r[k][j];
            at[i * stride + j] += scale * sum;
        }
}

static void assemble(fit_solver *s, const rigid *pose)
{
    const fit_gram *g = s->gram;
    memset(s->matrix, 0, (size_t)s->unknown * s->unknown * sizeof *s->matrix);
    for (uint32_t a = 0; a < g->control_count; a++)
        for (uint32_t b = 0; b <= a; b++)
            for (uint32_t i = s->control_start[a]; i < s->control_start[a + 1]; i++)
                for (uint32_t j = s->control_start[b]; j < s->control_start[b + 1]; j++) {
                    size_t from = s->control_column[i], to = s->control_column[j];
                    add_block(s->matrix + 3 * (size_t)a * s->unknown + 3 * (size_t)b, s->unknown,
                              &pose[g->column[from].bone], &pose[g->column[to].bone],
                              g->gram[from * g->column_count + to]);
                }
    double trace = 0;
    for (size_t i = 0; i < s->unknown; i++)
        trace += s->matrix[i * s->unknown + i];
    double ridge = s->unknown > 0 && trace > 0 ? s->ridge * trace / s->unknown : 1;
    for (size_t i = 0; i < s->unknown; i++)
        s->matrix[i * s->unknown + i] += ridge;
}

/* Returns energy - 2 right . weight + weight . gram weight. Sets s->product to gram weight. */
static double squared_error(fit_solver *s, uint32_t target)
{
    uint32_t count = 3 * s->gram->column_count;
    multiply(s, s->product, s->weight);
    double error_squared = s->gram->energy[target] -
                           2 * dot(s->gram->right + (size_t)target * count, s->weight, count) +
                           dot(s->product, s->weight, count);
    return error_squared > 0 ? error_squared : 0;
}

static double solve_posed(fit_solver *s, double *pull, const rigid *pose, uint32_t target)
{
    uint32_t count = 3 * s->gram->column_count;
    weigh(s, s->weight, pose, NULL);
    multiply(s, s->product, s->weight);
    for (uint32_t i = 0; i < count; i++)
        s->product[i] = s->gram->right[(size_t)target * count + i] - s->product[i];
    gather(s, s->vector, pose, s->product);
    assemble(s, pose);
    memset(pull, 0, s->unknown * sizeof *pull);
    if (factor(s->matrix, s->unknown)) {
        memcpy(pull, s->vector, s->unknown * sizeof *pull);
        solve_forward(s->matrix, pull, s->unknown);
        solve_backward(s->matrix, pull, s->unknown);
    }
    weigh(s, s->weight, pose, pull);
    return squared_error(s, target);
}

double fit_solve_pulls(fit_solver *s, double *pull, const float *dof, uint32_t target)
{
    rigid pose[RIG_BONES_MAX];
    bones_pose(pose, s->bones, dof);
    return solve_posed(s, pull, pose, target);
}

/* ---- the pose around them ---- */

static double range_of(const bones_dof *dof)
{
    return (double)dof->max - (double)dof->min;
}

/* Computes the derivative of the weights by one degree of freedom, as a difference towards the
 * inside of its range. */
static void find_slope(fit_solver *s, const float *dof, uint32_t which, const double *pull)
{
    const bones_dof *of = &s->bones->dof[which];
    double step = 1e-3 * range_of(of);
    if ((double)dof[which] + step > (double)of->max)
        step = -step;
    float moved[MRT_MAX_DOFS];
    memcpy(moved, dof, s->bones->dof_count * sizeof *moved);
    moved[which] = (float)((double)dof[which] + step);
    double taken = (double)moved[which] - (double)dof[which];
    rigid pose[RIG_BONES_MAX];
    bones_pose(pose, s->bones, moved);
    size_t count = 3 * (size_t)s->gram->column_count;
    double *slope = s->slope + which * count;
    weigh(s, slope, pose, pull);
    for (size_t i = 0; i < count; i++)
        slope[i] = taken != 0 ? (slope[i] - s->weight[i]) / taken : 0;
}

typedef struct normal { /* normal equations of the degrees of freedom, with the pulls eliminated */
    double matrix[MRT_MAX_DOFS * MRT_MAX_DOFS], gradient[MRT_MAX_DOFS];
} normal;

/* Builds the equations at s->weight. s->matrix holds the factor of the solved pulls. */
static void find_normal(fit_solver *s, normal *out, const float *dof, const double *pull,
                        uint32_t target)
{
    uint32_t dofs = s->bones->dof_count, count = 3 * s->gram->column_count;
    rigid pose[RIG_BONES_MAX];
    bones_pose(pose, s->bones, dof);
    const double *right = s->gram->right + (size_t)target * count;
    multiply(s, s->product, s->weight);
    for (uint32_t a = 0; a < dofs; a++) {
        find_slope(s, dof, a, pull);
        const double *slope = s->slope + (size_t)a * count;
        out->gradient[a] = dot(slope, right, count) - dot(slope, s->product, count);
    }
    for (uint32_t a = 0; a < dofs; a++) {
        multiply(s, s->product, s->slope + (size_t)a * count);
        gather(s, s->cross + (size_t)a * s->unknown, pose, s->product);
        solve_forward(s->matrix, s->cross + (size_t)a * s->unknown, s->unknown);
        for (uint32_t b = 0; b <= a; b++)
            out->matrix[a * dofs + b] = dot(s->product, s->slope + (size_t)b * count, count) -
                                        dot(s->cross + (size_t)a * s->unknown,
                                            s->cross + (size_t)b * s->unknown, s->unknown);
    }
}

/* Computes a damped step within the limits. Returns false if no step is possible. */
static bool damped_step(const fit_solver *s, float *out, const float *dof, const normal *n,
                        double damping)
{
    uint32_t dofs = s->bones->dof_count;
    double matrix[MRT_MAX_DOFS * MRT_MAX_DOFS], step[MRT_MAX_DOFS];
    memcpy(matrix, n->matrix, sizeof matrix);
    memcpy(step, n->gradient, sizeof step);
    for (uint32_t a = 0; a < dofs; a++) {
        double diagonal = n->matrix[a * dofs + a], range = range_of(&s->bones->dof[a]);
        bool is_idle = !(diagonal * range * range > 1e-9);
        if (is_idle)
            step[a] = 0;
        matrix[a * dofs + a] = is_idle ? 1 : diagonal * (1 + damping);
        for (uint32_t b = 0; b < dofs && is_idle; b++)
            if (a != b)
                matrix[(a > b ? a : b) * dofs + (a > b ? b : a)] = 0;
    }
    if (!factor(matrix, dofs))
        return false;
    solve_forward(matrix, step, dofs);
    solve_backward(matrix, step, dofs);
    bool is_moved = false;
    for (uint32_t a = 0; a < dofs; a++) {
        const bones_dof *of = &s->bones->dof[a];
        double to = (double)dof[a] + step[a];
        out[a] = (float)fmin(fmax(to, (double)of->min), (double)of->max);
        is_moved = is_moved || fabs((double)out[a] - (double)dof[a]) > 1e-5 * range_of(of);
    }
    return is_moved;
}

double fit_solve_pose(fit_solver *s, double *pull, float *dof, uint32_t target)
{
    double best = fit_solve_pulls(s, pull, dof, target), damping = 1e-3;
    for (int step = 0; step < POSE_STEPS && s->bones->dof_count > 0; step++) {
        normal n = {{0}, {0}};
        find_normal(s, &n, dof, pull, target);
        bool is_better = false;
        for (int attempt = 0; attempt < DAMPING_TRIES && !is_better; attempt++) {
            float next[MRT_MAX_DOFS];
            if (!damped_step(s, next, dof, &n, damping))
                break;
            double error_squared = fit_solve_pulls(s, pull, next, target);
            is_better = error_squared < best * (1 - 1e-6);
            damping = is_better ? damping / 10 : damping * 10;
            if (is_better) {
                best = error_squared;
                memcpy(dof, next, s->bones->dof_count * sizeof *dof);
            }
        }
        if (!is_better)
            break;
    }
    return fit_solve_pulls(s, pull, dof, target);
}
