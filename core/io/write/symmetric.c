#include "io/write/symmetric.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MAX_SWEEPS = 64 }; /* maximum number of QL sweeps per eigenvalue; usually two suffice */

static double dot(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i)
        sum += a[i] * b[i];
    return sum;
}

/* Divides the matrix by its greatest magnitude, and returns that. */
static double normalise_scale(double *a, size_t n)
{
    double scale = 0.0;
    for (size_t i = 0; i < n * n; ++i)
        if (fabs(a[i]) > scale)
            scale = fabs(a[i]);
    for (size_t i = 0; scale > 0.0 && i < n * n; ++i)
        a[i] /= scale;
    return scale;
}

/* Reflects column k below the diagonal to a multiple of its first unit vector. Stores the reflector
 * v in row k, right of the diagonal. Returns 2 / v.v; 0: the column needs no reflection. */
static double reflect_column(double *a, double *diagonal, double *off_diagonal, double *p, size_t n,
                             size_t k)
{
    double *v = a + k * n + k + 1;
    size_t size = n - k - 1;
    diagonal[k] = a[k * n + k];
    double length = sqrt(dot(v, v, size));
    if (length == 0.0 || size == 1) {
        off_diagonal[k] = v[0];
        memset(v, 0, size * sizeof *v);
        return 0.0;
    }
    off_diagonal[k] = v[0] > 0.0 ? -length : length;
    v[0] -= off_diagonal[k];
    double factor = 2.0 / dot(v, v, size);
    double *rest = a + (k + 1) * n + k + 1; /* size by size, stride n */
    for (size_t i = 0; i < size; ++i)
        p[i] = factor * dot(rest + i * n, v, size);
    double half = 0.5 * factor * dot(p, v, size);
    for (size_t i = 0; i < size; ++i)
        p[i] -= half * v[i];
    for (size_t i = 0; i < size; ++i)
        for (size_t j = 0; j < size; ++j)
            rest[i * n + j] -= v[i] * p[j] + p[i] * v[j];
    return factor;
}

/* Computes q, the product of the reflectors: matrix = q tridiagonal q^T. */
static void multiply_reflectors(double *q, const double *a, const double *factor, double *row,
                                size_t n)
{
    memset(q, 0, n * n * sizeof *q);
    for (size_t i = 0; i < n; ++i)
        q[i * n + i] = 1.0;
    for (size_t k = n - 1; k-- > 0;) {
        if (factor[k] == 0.0)
            continue;
        const double *v = a + k * n + k + 1;
        size_t size = n - k - 1;
        double *rest = q + (k + 1) * n + k + 1;
        memset(row, 0, size * sizeof *row);
        for (size_t i = 0; i < size; ++i)
            for (size_t j = 0; j < size; ++j)
                row[j] += v[i] * rest[i * n + j];
        for (size_t i = 0; i < size; ++i)
            for (size_t j = 0; j < size; ++j)
                rest[i * n + j] -= factor[k] * v[i] * row[j];
    }
}

static void rotate_rows(double *upper, double *lower, double sine, double cosine, size_t n)
{
    for (size_t k = 0; k < n; ++k) {
        double a = upper[k], b = lower[k];
        lower[k] = sine * a + cosine * b;
        upper[k] = cosine * a - sine * b;
    }
}

/* Performs one implicit QL sweep over rows l..m of the tridiagonal matrix. The vectors are in the
 * rows of z. */
static void sweep(double *d, double *e, double *z, size_t l, size_t m, size_t n)
{
    double g = (d[l + 1] - d[l]) / (2.0 * e[l]);
    double r = sqrt(g * g + 1.0);
    g = d[m] - d[l] + e[l] / (g + (g < 0.0 ? -r : r));
    double sine = 1.0, cosine = 1.0, p = 0.0;
    for (size_t i = m; i-- > l;) {
        double f = sine * e[i], b = cosine * e[i];
        r = sqrt(f * f + g * g);
        e[i + 1] = r;
        if (r == 0.0) {
            d[i + 1] -= p;
            e[m] = 0.0;
            return;
        }
        sine = f / r;
        cosine = g / r;
        g = d[i + 1] - p;
        r = (d[i] - g) * sine + 2.0 * cosine * b;
        p = sine * r;
        d[i + 1] = g + p;
        g = cosine * r - b;
        rotate_rows(z + i * n, z + (i + 1) * n, sine, cosine, n);
    }
    d[l] -= p;
    e[l] = g;
    e[m] = 0.0;
}

static mrt_result diagonalise(double *d, double *e, double *z, size_t n, error *err)
{
    double norm = 0.0;
    for (size_t i = 0; i < n; ++i)
        if (fabs(d[i]) + fabs(e[i]) > norm)
            norm = fabs(d[i]) + fabs(e[i]);
    double negligible = DBL_EPSILON * norm;
    for (size_t l = 0; l < n; ++l) {
        for (int count = 0;; ++count) {
            size_t m = l;
            while (m + 1 < n && fabs(e[m]) > negligible)
                ++m;
            if (m == l)
                break;
            if (count == MAX_SWEEPS)
                return error_set(err, MRT_ERR_ARGUMENT,
                                 "eigenvalue %zu of %zu did not converge: are all values finite?",
                                 l + 1, n);
            sweep(d, e, z, l, m, n);
        }
    }
    return MRT_OK;
}

static void sort_descending(double *value, double *vector, size_t n)
{
    for (size_t i = 0; i + 1 < n; ++i) {
        size_t best = i;
        for (size_t j = i + 1; j < n; ++j)
            if (value[j] > value[best])
                best = j;
        if (best == i)
            continue;
        double kept = value[i];
        value[i] = value[best];
        value[best] = kept;
        rotate_rows(vector + i * n, vector + best * n, 1.0, 0.0, n);
    }
}

mrt_result symmetric_eigen(double *matrix, double *out_value, double *work, uint32_t count,
                           error *err)
{
    size_t n = count;
    if (n == 0)
        return MRT_OK;
    double *q = work, *off_diagonal = work + n * n, *factor = off_diagonal + n, *row = factor + n;
    double scale = normalise_scale(matrix, n);
    for (size_t k = 0; k + 1 < n; ++k)
        factor[k] = reflect_column(matrix, out_value, off_diagonal, row, n, k);
    out_value[n - 1] = matrix[n * n - 1];
    off_diagonal[n - 1] = 0.0;
    multiply_reflectors(q, matrix, factor, row, n);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j)
            matrix[i * n + j] = q[j * n + i];
    mrt_result result = diagonalise(out_value, off_diagonal, matrix, n, err);
    if (result < 0)
        return result;
    sort_descending(out_value, matrix, n);
    for (size_t i = 0; i < n; ++i)
        out_value[i] *= scale;
    return MRT_OK;
}
