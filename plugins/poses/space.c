#include "space.h"

#include <math.h>
#include <string.h>

/* Smallest spread of an angle between poses, which limits its weight. */
/* A larger one for the wrist, which moves with the arm. */
static const double least_spread_rad = 0.12, least_wrist_rad = 0.6;
enum { WRIST = 20 };

void space_show(space_shown *self, unsigned pose, const float angle[MRT_ANGLES])
{
    unsigned at = self->count[pose];
    if (at < SPACE_SHOWN_MAX)
        self->count[pose] += 1;
    else
        at = self->next[pose];
    self->next[pose] = (at + 1) % SPACE_SHOWN_MAX;
    memcpy(self->angle[pose][at], angle, sizeof self->angle[pose][at]);
}

/* exp(-x) for x >= 0: the power series of x/64, then squared six times. */
static double exp_minus(double x)
{
    if (!(x < 60.0))
        return 0.0;
    double y = x / 64.0, term = 1.0, sum = 1.0;
    for (int n = 1; n < 16; ++n) {
        term *= y / n;
        sum += term;
    }
    for (int i = 0; i < 6; ++i)
        sum *= sum;
    return 1.0 / sum;
}

static double distance2(const double a[MRT_ANGLES], const double b[MRT_ANGLES])
{
    double sum = 0.0;
    for (int i = 0; i < MRT_ANGLES; ++i)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum / MRT_ANGLES;
}

/* ---- demonstrations ---- */

static void gather(space_fit *out, const space_shown *shown)
{
    out->count = 0;
    for (int pose = 0; pose < SPACE_POSES; ++pose)
        for (unsigned k = 0; k < shown->count[pose]; ++k) {
            out->pose[out->count] = pose;
            for (int i = 0; i < MRT_ANGLES; ++i)
                out->centre[out->count][i] = (double)shown->angle[pose][k][i];
            out->count += 1;
        }
}

/* Divides each angle by its standard deviation over the demonstrations. */
static void normalise(space_fit *out)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        double mean = 0.0, variance = 0.0;
        for (int k = 0; k < out->count; ++k)
            mean += out->centre[k][i] / out->count;
        for (int k = 0; k < out->count; ++k)
            variance += (out->centre[k][i] - mean) * (out->centre[k][i] - mean) / out->count;
        double least = i < WRIST ? least_spread_rad : least_wrist_rad;
        out->per_spread[i] = 1.0 / fmax(sqrt(variance), least);
        for (int k = 0; k < out->count; ++k)
            out->centre[k][i] *= out->per_spread[i];
    }
}

static double mean_distance(const space_fit *self)
{
    double sum = 0.0, count = 0.0;
    for (int a = 0; a < self->count; ++a)
        for (int b = 0; b < a; ++b)
            if (self->pose[a] != self->pose[b]) {
                sum += sqrt(distance2(self->centre[a], self->centre[b]));
                count += 1.0;
            }
    return count > 0.0 && sum > 0.0 ? sum / count : 1.0;
}

/* ---- the solution ---- */

typedef struct matrix {
    double at[SPACE_MAX][SPACE_MAX];
} matrix;

/* Computes the lower Cholesky factor, in place. The ridge keeps the matrix positive definite. */
static void factor(matrix *m, int count)
{
    for (int i = 0; i < count; ++i)
        for (int j = 0; j <= i; ++j) {
            double sum = m->at[i][j];
            for (int k = 0; k < j; ++k)
                sum -= m->at[i][k] * m->at[j][k];
            m->at[i][j] = i == j ? sqrt(fmax(sum, 1e-12)) : sum / m->at[j][j];
        }
}

static void solve(const matrix *m, int count, double x[SPACE_MAX])
{
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < i; ++k)
            x[i] -= m->at[i][k] * x[k];
        x[i] /= m->at[i][i];
    }
    for (int i = count - 1; i >= 0; --i) {
        for (int k = i + 1; k < count; ++k)
            x[i] -= m->at[k][i] * x[k];
        x[i] /= m->at[i][i];
    }
}

/* Leave-one-out error: coefficient / diagonal of the inverse, without solving again (Rippa 1999,
 * with each pose as one right-hand side). */
static double left_out(const space_fit *self, const matrix *m, const space_shown *shown)
{
    double sum = 0.0, count = 0.0;
    for (int i = 0; i < self->count; ++i) {
        double column[SPACE_MAX] = {0.0};
        if (shown->count[self->pose[i]] < 2)
            continue;
        column[i] = 1.0;
        solve(m, self->count, column);
        for (int pose = 0; pose < SPACE_POSES; ++pose) {
            double error = self->coefficient[i][pose] / column[i];
            sum += error * error;
            count += 1.0;
        }
    }
    return count > 0.0 ? sqrt(sum / count) : -1.0;
}

void space_find(space_fit *out, const space_shown *shown, double ridge, double width)
{
    matrix m;
    memset(out, 0, sizeof *out);
    gather(out, shown);
    normalise(out);
    double sigma = width * mean_distance(out);
    out->steepness = 0.5 / (sigma * sigma);
    for (int i = 0; i < out->count; ++i)
        for (int j = 0; j <= i; ++j)
            m.at[i][j] = exp_minus(out->steepness * distance2(out->centre[i], out->centre[j])) +
                         (i == j ? ridge : 0.0);
    factor(&m, out->count);
    for (int pose = 0; pose < SPACE_POSES; ++pose) {
        double column[SPACE_MAX] = {0.0};
        for (int i = 0; i < out->count; ++i)
            column[i] = out->pose[i] == pose ? 1.0 : 0.0;
        solve(&m, out->count, column);
        for (int i = 0; i < out->count; ++i)
            out->coefficient[i][pose] = column[i];
    }
    out->left_out = left_out(out, &m, shown);
}

void space_weights(const space_fit *self, const float angle[MRT_ANGLES], double out[SPACE_POSES])
{
    double at[MRT_ANGLES], sum = 0.0;
    memset(out, 0, SPACE_POSES * sizeof *out);
    for (int i = 0; i < MRT_ANGLES; ++i)
        at[i] = (double)angle[i] * self->per_spread[i];
    for (int k = 0; k < self->count; ++k) {
        double felt = exp_minus(self->steepness * distance2(at, self->centre[k]));
        for (int pose = 0; pose < SPACE_POSES; ++pose)
            out[pose] += felt * self->coefficient[k][pose];
    }
    for (int pose = 0; pose < SPACE_POSES; ++pose) {
        out[pose] = fmax(out[pose], 0.0);
        sum += out[pose];
    }
    for (int pose = 0; pose < SPACE_POSES && sum > 1.0; ++pose)
        out[pose] /= sum;
}
