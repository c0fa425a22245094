#include "cholesky.h"

#include <math.h>

bool cholesky_factor(cholesky *self, int count)
{
    for (int i = 0; i < count; ++i)
        for (int j = 0; j <= i; ++j) {
            double sum = self->at[i][j];
            for (int k = 0; k < j; ++k)
                sum -= self->at[i][k] * self->at[j][k];
            if (i != j)
                self->at[i][j] = sum / self->at[j][j];
            else if (sum > 1e-12)
                self->at[i][i] = sqrt(sum);
            else
                return false;
        }
    return true;
}

void cholesky_solve(const cholesky *self, int count, double *x)
{
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < i; ++k)
            x[i] -= self->at[i][k] * x[k];
        x[i] /= self->at[i][i];
    }
    for (int i = count - 1; i >= 0; --i) {
        for (int k = i + 1; k < count; ++k)
            x[i] -= self->at[k][i] * x[k];
        x[i] /= self->at[i][i];
    }
}
