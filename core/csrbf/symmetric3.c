#include "csrbf/symmetric3.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 16 };

/* Turns rows and columns p, q of a so that a[p][q] vanishes; v collects the turns in its rows. */
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

/* Rows of v become the eigenvectors of what was in a, a its diagonal. */
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

void symmetric3_eigen(double value[3], matrix3 *vector, const matrix3 *a)
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
