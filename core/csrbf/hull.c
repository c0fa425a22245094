#include "csrbf/hull.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 16 };

/* Rotates rows and columns p, q of a so that a[p][q] becomes 0, and the rows of v likewise. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
    if (a[p][q] == 0.0)
        return;
    double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    double t = 1.0 / (fabs(theta) + sqrt(theta * theta + 1.0));
    if (theta < 0.0)
        t = -t;
    double c = 1.0 / sqrt(t * t + 1.0);
    double s = t * c;
    int other = 3 - p - q;
    double pq = a[p][q], po = a[p][other], qo = a[q][other];
    a[p][p] -= t * pq;
    a[q][q] += t * pq;
    a[p][q] = a[q][p] = 0.0;
    a[p][other] = a[other][p] = c * po - s * qo;
    a[q][other] = a[other][q] = s * po + c * qo;
    for (int k = 0; k < 3; ++k) {
        double vp = v[p][k], vq = v[q][k];
        v[p][k] = c * vp - s * vq;
        v[q][k] = s * vp + c * vq;
    }
}

/* Replaces the rows of v by the eigenvectors of a, and a by the diagonal matrix. */
static void diagonalise(double a[3][3], double v[3][3])
{
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        if (a[0][1] == 0.0 && a[0][2] == 0.0 && a[1][2] == 0.0)
            return;
        rotate(a, v, 0, 1);
        rotate(a, v, 0, 2);
        rotate(a, v, 1, 2);
    }
}

static void make_largest_positive(double v[3])
{
    int largest = 0;
    for (int k = 1; k < 3; ++k)
        if (fabs(v[k]) > fabs(v[largest]))
            largest = k;
    if (v[largest] >= 0.0)
        return;
    for (int k = 0; k < 3; ++k)
        v[k] = -v[k];
}

static void symmetric3_eigen(double value[3], matrix3 *vector, const matrix3 *a)
{
    double d[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    memcpy(d, a->at, sizeof d);
    diagonalise(d, v);
    int rank[3] = {0, 1, 2};
    for (int i = 1; i < 3; ++i)
        for (int j = i; j > 0 && d[rank[j]][rank[j]] > d[rank[j - 1]][rank[j - 1]]; --j) {
            int swap = rank[j];
            rank[j] = rank[j - 1];
            rank[j - 1] = swap;
        }
    for (int i = 0; i < 3; ++i) {
        value[i] = d[rank[i]][rank[i]];
        memcpy(vector->at[i], v[rank[i]], sizeof vector->at[i]);
        make_largest_positive(vector->at[i]);
    }
}

double symmetric3_largest(const matrix3 *a)
{
    double value[3];
    matrix3 vector;
    symmetric3_eigen(value, &vector, a);
    return value[0];
}

static const double flat_ratio = 1e-3;
static const double float_steps = 16.0 / 16777216.0; /* 16 x 2^-24 */

static void mean_of(double out[3], const double *point, uint32_t count)
{
    for (int axis = 0; axis < 3; ++axis) {
        double sum = 0.0;
        for (uint32_t i = 0; i < count; ++i)
            sum += point[3 * i + (uint32_t)axis];
        out[axis] = sum / (double)count;
    }
}

static void scatter_of(matrix3 *out, const double centre[3], const double *point, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        double d[3];
        for (int axis = 0; axis < 3; ++axis)
            d[axis] = point[3 * i + (uint32_t)axis] - centre[axis];
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out->at[a][b] += d[a] * d[b];
    }
}

static double largest_size(const double *value, uint32_t count)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < count; ++i)
        largest = fabs(value[i]) > largest ? fabs(value[i]) : largest;
    return largest;
}

void hull_fit(hull *out, const double *point, uint32_t count)
{
    matrix3 scatter = {{{0}}};
    double spread[3];
    mean_of(out->centre, point, count);
    scatter_of(&scatter, out->centre, point, count);
    symmetric3_eigen(spread, &out->axis, &scatter);
    double extent = sqrt(spread[0] > 0.0 ? spread[0] : 0.0);
    double input_step = float_steps * largest_size(point, 3 * count);
    double flat = flat_ratio * extent > input_step ? flat_ratio * extent : input_step;
    out->dimension = 0;
    while (out->dimension < 3 && spread[out->dimension] > flat * flat)
        ++out->dimension;
}
