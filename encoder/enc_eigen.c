/* SPDX-License-Identifier: MIT */
#include "encoder/enc_eigen.h"

#include <math.h>

/* Jacobi's rotations converge quadratically: more is noise. */
enum { ROUNDS = 12 };

/* One rotation that makes m[i][j] 0; axes are rows. */
static void rotate(double m[3][3], double axes[3][3], int i, int j)
{
    if (m[i][j] == 0)
        return;
    const double theta = (m[j][j] - m[i][i]) / (2 * m[i][j]);
    const double t =
        (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;

    for (int k = 0; k < 3; k++) {
        const double a = m[k][i], b = m[k][j];
        m[k][i] = c * a - s * b;
        m[k][j] = s * a + c * b;
    }
    for (int k = 0; k < 3; k++) {
        const double a = m[i][k], b = m[j][k];
        m[i][k] = c * a - s * b;
        m[j][k] = s * a + c * b;
    }
    for (int k = 0; k < 3; k++) {
        const double a = axes[i][k], b = axes[j][k];
        axes[i][k] = c * a - s * b;
        axes[j][k] = s * a + c * b;
    }
}

void enc_eigen(const double v[6], double value[3], double axis[3][3])
{
    double m[3][3] = { { v[0], v[1], v[2] },
                       { v[1], v[3], v[4] },
                       { v[2], v[4], v[5] } };
    double axes[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    int order[3] = { 0, 1, 2 };

    for (int round = 0; round < ROUNDS; round++) {
        rotate(m, axes, 0, 1);
        rotate(m, axes, 0, 2);
        rotate(m, axes, 1, 2);
    }
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && m[order[j]][order[j]] >
                                     m[order[j - 1]][order[j - 1]]; j--) {
            const int k = order[j];
            order[j] = order[j - 1];
            order[j - 1] = k;
        }
    for (int i = 0; i < 3; i++) {
        value[i] = m[order[i]][order[i]];
        for (int k = 0; k < 3; k++)
            axis[i][k] = axes[order[i]][k];
    }
    for (int k = 0; k < 3; k++)
        axis[2][k] = axis[0][(k + 1) % 3] * axis[1][(k + 2) % 3] -
                     axis[0][(k + 2) % 3] * axis[1][(k + 1) % 3];
}
