/* Derives the jaw pose from the ends of controls: least squares by Gauss-Newton within a box. The
 * data of the controls is summed first, so that each pose costs only a few small products. */
#include "face/bones.h"

#include <math.h>

enum { OPENINGS = 6, POSES = 10, SWEEPS = 16, NEWTON = 5, JAW_DOFS = 3 };
static const double difference_rad = 1e-5, difference_mm = 1e-3;
static const double settled_rad = 1e-9, settled_mm = 1e-7;
static const double negligible = 1e-12; /* of the requested motion */

/* Sums over the controls. s is the start relative to the middle of the hinge, and d = end -
 * start. */
typedef struct evidence {
    double weight;
    double s[3], d[3];         /* sum of w s, w d */
    double ss[3][3], ds[3][3]; /* sum of w s s^T, w d s^T */
    double dd;                 /* sum of w d . d */
    uint32_t rider_count;      /* controls with any share on the jaw */
} evidence;

/* x -> x + r x + t, relative to the middle of the hinge. */
typedef struct motion {
    double r[3][3], t[3];
} motion;

static evidence gather(const bones *b, const double *start, const double *end, const double *weight,
                       uint32_t count)
{
    evidence e = {0};
    const double middle[3] = {b->hinge.middle.x, b->hinge.middle.y, b->hinge.middle.z};
    for (size_t k = 0; k < count; ++k) {
        double w = weight[k], s[3], d[3];
        if (!(w > 0.0))
            continue;
        for (size_t i = 0; i < 3; ++i) {
            s[i] = start[3 * k + i] - middle[i];
            d[i] = end[3 * k + i] - start[3 * k + i];
        }
        e.rider_count += 1;
        e.weight += w;
        for (size_t i = 0; i < 3; ++i) {
            e.s[i] += w * s[i];
            e.d[i] += w * d[i];
            e.dd += w * (d[i] * d[i]);
            for (size_t j = 0; j < 3; ++j) {
                e.ss[i][j] += w * (s[i] * s[j]);
                e.ds[i][j] += w * (d[i] * s[j]);
            }
        }
    }
    return e;
}

/* Expresses a rigid motion relative to the middle of the hinge. */
static motion motion_of(const bones *b, const rigid *m)
{
    vec3 t = vec3_sub(rigid_apply(m, b->hinge.middle), b->hinge.middle);
    motion out = {.t = {t.x, t.y, t.z}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.r[i][j] = m->r[i][j] - (i == j ? 1.0 : 0.0);
    return out;
}

/* Returns the jaw opened and moved aside, with the condyles at rest. The first unknown is the turn
 * about the hinge, including the opening that the cusps add. If the guidance were part of the
 * model, pulls that press the teeth together would have two best answers, one to each side. */
static rigid jaw_at(const bones *b, double turn_rad, double lateral_mm)
{
    rigid opening = rigid_turn(b->hinge.middle, b->hinge.left, turn_rad);
    rigid aside = bones_aside(b, lateral_mm, turn_rad);
    return rigid_compose(&aside, &opening);
}

static motion slope_between(const bones *b, const rigid *before, const rigid *after, double step)
{
    motion low = motion_of(b, before), out = motion_of(b, after);
    for (int i = 0; i < 3; ++i) {
        out.t[i] = (out.t[i] - low.t[i]) / step;
        for (int j = 0; j < 3; ++j)
            out.r[i][j] = (out.r[i][j] - low.r[i][j]) / step;
    }
    return out;
}

static motion slope_of_opening(const bones *b, const double p[JAW_DOFS])
{
    rigid before = jaw_at(b, p[0] - difference_rad, p[1]);
    rigid after = jaw_at(b, p[0] + difference_rad, p[1]);
    return slope_between(b, &before, &after, 2.0 * difference_rad);
}

/* Differentiates towards one side, since at 0 the axis changes from one condyle to the other. */
static motion slope_of_lateral(const bones *b, const double p[JAW_DOFS], double side)
{
    rigid before = jaw_at(b, p[0], p[1]);
    rigid after = jaw_at(b, p[0], p[1] + side * difference_mm);
    return slope_between(b, &before, &after, side * difference_mm);
}

/* Returns the opening that the cusps guide to this turn, by Newton's method. The cusps never take
 * more than half of an opening's slope. Returns the least opening if they alone turn further. */
static double opening_of(const bones *b, double turn_rad, double lateral_mm)
{
    const rig_bone *jaw = &b->rig->bone[b->jaw];
    double open_rad = turn_rad;
    for (int i = 0; i < NEWTON; ++i) {
        double over = bones_guided_opening(b, open_rad, lateral_mm) - turn_rad;
        if (!(fabs(over) > 1e-15))
            break;
        double beyond = bones_guided_opening(b, open_rad + difference_rad, lateral_mm) - turn_rad;
        open_rad -= over * difference_rad / (beyond - over);
    }
    return open_rad > jaw->open_min_rad ? open_rad : jaw->open_min_rad;
}

/* Returns the jaw's motion at p, and its derivatives by the first `count` degrees of freedom with
 * fixed condyles. */
static motion motion_at(const bones *b, const double p[JAW_DOFS], double side,
                        motion slope[JAW_DOFS], int count)
{
    rigid jaw = jaw_at(b, p[0], p[1]);
    slope[0] = slope_of_opening(b, p);
    if (count > 1) {
        const vec3 path = b->hinge.path;
        slope[1] = slope_of_lateral(b, p, side);
        slope[2] = (motion){.t = {path.x, path.y, path.z}};
    }
    double slide_mm = bones_slide(b, opening_of(b, p[0], p[1]));
    jaw.t = vec3_add(jaw.t, vec3_scale(b->hinge.path, slide_mm + p[2]));
    return motion_of(b, &jaw);
}

/* sum of w (a.r s + a.t) . (b.r s + b.t) */
static double product(const evidence *e, const motion *a, const motion *b)
{
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        double a_mean = a->t[i] * e->weight, b_mean = 0.0;
        for (int j = 0; j < 3; ++j) {
            double column = 0.0;
            for (int k = 0; k < 3; ++k)
                column += a->r[i][k] * e->ss[k][j];
            sum += column * b->r[i][j];
            a_mean += a->r[i][j] * e->s[j];
            b_mean += b->r[i][j] * e->s[j];
        }
        sum += a_mean * b->t[i] + a->t[i] * b_mean;
    }
    return sum;
}

/* sum of w d . (a.r s + a.t) */
static double asked(const evidence *e, const motion *a)
{
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        sum += e->d[i] * a->t[i];
        for (int j = 0; j < 3; ++j)
            sum += e->ds[i][j] * a->r[i][j];
    }
    return sum;
}

/* Minimises 1/2 x H x + g x for the first `count` unknowns, low <= x <= high, by coordinate
 * descent. */
static void solve_in_box(double x[JAW_DOFS], double h[JAW_DOFS][JAW_DOFS], const double *g,
                         const double *low, const double *high, int count)
{
    for (int sweep = 0; sweep < SWEEPS; ++sweep)
        for (int i = 0; i < count; ++i) {
            double slope = g[i];
            for (int j = 0; j < JAW_DOFS; ++j)
                slope += h[i][j] * x[j];
            if (!(h[i][i] > 1e-12))
                continue;
            double next = x[i] - slope / h[i][i];
            x[i] = next < low[i] ? low[i] : (next > high[i] ? high[i] : next);
        }
}

/* Makes one step of Gauss-Newton for the first `count` degrees of freedom, with lateral motion to
 * one side only (1: the subject's left). Returns the residual of p before the step: sum of w |d -
 * motion of the jaw|^2. */
static double improve(const bones *b, const evidence *e, double p[JAW_DOFS], double side, int count)
{
    const rig_bone *jaw = &b->rig->bone[b->jaw];
    double open_rad = opening_of(b, p[0], p[1]);
    double lateral = bones_lateral_limit(b, open_rad), forward = bones_forward_limit(b, open_rad);
    double low[JAW_DOFS] = {jaw->open_min_rad - p[0], (side > 0.0 ? 0.0 : -lateral) - p[1], -p[2]};
    double high[JAW_DOFS] = {jaw->open_max_rad - p[0], (side > 0.0 ? lateral : 0.0) - p[1],
                             forward - p[2]};
    double h[JAW_DOFS][JAW_DOFS] = {{0}}, g[JAW_DOFS] = {0}, step[JAW_DOFS] = {0};
    motion slope[JAW_DOFS], now = motion_at(b, p, side, slope, count);
    double left_over = product(e, &now, &now) - 2.0 * asked(e, &now) + e->dd;
    for (int i = 0; i < count; ++i) {
        g[i] = product(e, &now, &slope[i]) - asked(e, &slope[i]);
        for (int j = 0; j <= i; ++j)
            h[i][j] = h[j][i] = product(e, &slope[i], &slope[j]);
    }
    solve_in_box(step, h, g, low, high, count);
    for (int i = 0; i < count; ++i)
        p[i] += step[i];
    return left_over > 0.0 ? left_over : 0.0;
}

static bool is_settled(const double before[JAW_DOFS], const double now[JAW_DOFS])
{
    return fabs(now[0] - before[0]) < settled_rad && fabs(now[1] - before[1]) < settled_mm &&
           fabs(now[2] - before[2]) < settled_mm;
}

/* Combines the best poses to each side, since a turn about one condyle is not a turn about the
 * other. The weights depend on the residuals, so that the jaw passes from one pose to the other
 * without a jump. If one pose explains everything, it alone counts. */
static void weigh_sides(const bones *b, const evidence *e, double p[JAW_DOFS])
{
    double sum[JAW_DOFS] = {0}, weight_sum = 0.0;
    for (int k = 0; k < 2; ++k) {
        double side = k == 0 ? 1.0 : -1.0, q[JAW_DOFS] = {p[0], 0.0, 0.0}, left_over = 0.0;
        for (int i = 0; i <= POSES; ++i) {
            const double before[JAW_DOFS] = {q[0], q[1], q[2]};
            left_over = improve(b, e, q, side, JAW_DOFS);
            if (is_settled(before, q))
                break;
        }
        double rest = left_over + negligible * e->dd + 1e-30;
        double weight = 1.0 / (rest * rest);
        weight_sum += weight;
        for (int i = 0; i < JAW_DOFS; ++i)
            sum[i] += weight * q[i];
    }
    for (int i = 0; i < JAW_DOFS; ++i)
        p[i] = sum[i] / weight_sum;
}

/* Sets lateral and forward to their last values, limited at the current opening. */
static void hold(const bones *b, double p[JAW_DOFS], const float *dof)
{
    double lateral = bones_lateral_limit(b, p[0]), forward = bones_forward_limit(b, p[0]);
    p[1] = isfinite(dof[1]) ? bones_soft_limit((double)dof[1], -lateral, lateral) : 0.0;
    p[2] = isfinite(dof[2]) ? bones_soft_limit((double)dof[2], 0.0, forward) : 0.0;
}

static double clamped(double value, double min, double max)
{
    return value < min ? min : (value > max ? max : value);
}

void bones_derive_jaw(float *out_dof, const bones *b, const double *start, const double *end,
                      const double *weight, uint32_t count)
{
    if (b->jaw == RIG_NONE)
        return;
    evidence e = gather(b, start, end, weight, count);
    if (e.rider_count == 0)
        return;
    const rig_bone *jaw = &b->rig->bone[b->jaw];
    bool all = e.rider_count >= 2;
    double p[JAW_DOFS] = {0.0, 0.0, 0.0};
    for (int i = 0; i < OPENINGS; ++i) {
        if (!all)
            hold(b, p, out_dof);
        double before = p[0];
        (void)improve(b, &e, p, 1.0, 1);
        if (fabs(p[0] - before) < settled_rad)
            break;
    }
    if (all)
        weigh_sides(b, &e, p);
    p[0] = opening_of(b, p[0], p[1]);
    double lateral = bones_lateral_limit(b, p[0]), forward = bones_forward_limit(b, p[0]);
    p[1] = clamped(p[1], -lateral, lateral);
    p[2] = clamped(p[2], 0.0, forward);
    out_dof[0] = (float)bones_soft_limit_inverse(p[0], jaw->open_min_rad, jaw->open_max_rad);
    if (!all)
        return;
    out_dof[1] = (float)bones_soft_limit_inverse(p[1], -lateral, lateral);
    out_dof[2] = (float)bones_soft_limit_inverse(p[2], 0.0, forward);
}
