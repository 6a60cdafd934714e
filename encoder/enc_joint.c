/* SPDX-License-Identifier: MIT */
#include "encoder/enc_joint.h"

#include <math.h>

/* Relative to the mean of D's diagonal; see PULL in enc_quadric.c. */
#define PULL 1e-6

typedef struct tail_view {
    const double *m, *d, *t;
} tail_view;

static tail_view view(const double *tail, unsigned m)
{
    return (tail_view){ tail, tail + 3 * m, tail + 3 * m + m * (m + 1) / 2 };
}

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double dot_n(const double *a, const double *b, unsigned n)
{
    double sum = 0;
    for (unsigned i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

bool enc_joint_frame(unsigned m, const double p[3], const double *s,
                     const double q[3], const double *t, double e[],
                     double f[])
{
    const unsigned n = 3 + m;

    for (unsigned i = 0; i < n; i++) {
        e[i] = i < 3 ? p[i] : s[i - 3];
        f[i] = i < 3 ? q[i] : t[i - 3];
    }
    const double long_e = sqrt(dot_n(e, e, n));
    if (!(long_e > 0))
        return false;
    for (unsigned i = 0; i < n; i++)
        e[i] /= long_e;
    const double along = dot_n(e, f, n);
    for (unsigned i = 0; i < n; i++)
        f[i] -= along * e[i];
    const double long_f = sqrt(dot_n(f, f, n));
    if (!(long_f > 0))
        return false;
    for (unsigned i = 0; i < n; i++)
        f[i] /= long_f;
    return true;
}

void enc_joint_add_face(enc_quadric *sum, double *tail, unsigned m,
                        const double p[3], const double *s, const double q[3],
                        const double *t)
{
    const double normal[3] = { p[1] * q[2] - p[2] * q[1],
                               p[2] * q[0] - p[0] * q[2],
                               p[0] * q[1] - p[1] * q[0] };
    const double square = dot3(normal, normal);
    double e[3 + ENC_JOINT_MAX], f[3 + ENC_JOINT_MAX];

    if (!(square > 0))
        return;
    const double area = 0.5 * sqrt(square);
    if (m == 0) { /* I - ee' - ff' is nn', and this is the exact one */
        enc_quadric_add_plane(sum, normal, area);
        return;
    }
    if (!enc_joint_frame(m, p, s, q, t, e, f))
        return;
    double *d = tail + 3 * m;
    for (unsigned i = 0, k = 0; i < 3; i++)
        for (unsigned j = i; j < 3; j++)
            sum->a[k++] += area * ((i == j) - e[i] * e[j] - f[i] * f[j]);
    for (unsigned i = 0, k = 0; i < m; i++) {
        const double ei = e[3 + i], fi = f[3 + i];
        for (unsigned j = 0; j < 3; j++)
            tail[3 * i + j] -= area * (ei * e[j] + fi * f[j]);
        for (unsigned j = 0; j <= i; j++)
            d[k++] += area * ((i == j) - ei * e[3 + j] - fi * f[3 + j]);
    }
    sum->weight += area;
}

/* out = M x + D s + t */
static void attribute_slope(const double *tail, unsigned m, const double x[3],
                            const double *s, double *out)
{
    const tail_view q = view(tail, m);

    for (unsigned i = 0; i < m; i++)
        out[i] = q.t[i] + dot3(&q.m[3 * i], x);
    for (unsigned i = 0, k = 0; i < m; i++)
        for (unsigned j = 0; j <= i; j++, k++) {
            out[i] += q.d[k] * s[j];
            if (j < i)
                out[j] += q.d[k] * s[i];
        }
}

/* out = S x + M's + b */
static void place_slope(const enc_quadric *q, const double *tail, unsigned m,
                        const double x[3], const double *s, double out[3])
{
    enc_quadric_slope(q, x, out);
    for (unsigned i = 0; i < m; i++)
        for (unsigned k = 0; k < 3; k++)
            out[k] += tail[3 * i + k] * s[i];
}

void enc_joint_add(enc_quadric *sum, double *sum_tail, const enc_quadric *q,
                   const double *tail, unsigned m, const double x[3],
                   const double *s)
{
    double back[ENC_JOINT_MAX], rise[ENC_JOINT_MAX], slope[3];
    const double away[3] = { -x[0], -x[1], -x[2] };

    if (m == 0) {
        enc_quadric_add(sum, q, x);
        return;
    }
    for (unsigned i = 0; i < m; i++)
        back[i] = -s[i];
    place_slope(q, tail, m, away, back, slope);
    attribute_slope(tail, m, away, back, rise);
    for (unsigned i = 0; i < 6; i++)
        sum->a[i] += q->a[i];
    for (unsigned i = 0; i < 3; i++) {
        sum->b[i] += slope[i];
        sum->c += away[i] * (slope[i] + q->b[i]);
    }
    const size_t squares = (size_t)m * 3 + (size_t)m * (m + 1) / 2;
    const double *t = tail + squares;
    for (size_t i = 0; i < squares; i++)
        sum_tail[i] += tail[i];
    for (unsigned i = 0; i < m; i++) {
        sum_tail[squares + i] += rise[i];
        sum->c += back[i] * (rise[i] + t[i]);
    }
    sum->c += q->c;
    sum->weight += q->weight;
}

double enc_joint_value(const enc_quadric *q, const double *tail, unsigned m,
                       const double x[3], const double *s)
{
    double slope[3], rise[ENC_JOINT_MAX];

    if (m == 0)
        return enc_quadric_value(q, x);
    place_slope(q, tail, m, x, s, slope);
    attribute_slope(tail, m, x, s, rise);
    const tail_view v = view(tail, m);
    double value = q->c;
    for (unsigned i = 0; i < 3; i++)
        value += x[i] * (slope[i] + q->b[i]);
    for (unsigned i = 0; i < m; i++)
        value += s[i] * (rise[i] + v.t[i]);
    return value > 0 ? value : 0;
}

/* L L' = D + pull, row by row. */
static void factorise(const double *d, unsigned m, double *l)
{
    double trace = 0;

    for (unsigned i = 0; i < m; i++)
        trace += d[i * (i + 1) / 2 + i];
    const double pull = trace > 0 ? PULL * trace / m : 1;
    for (unsigned i = 0; i < m; i++) {
        double *row = l + i * (i + 1) / 2;
        for (unsigned j = 0; j <= i; j++) {
            const double *other = l + j * (j + 1) / 2;
            const double rest = d[i * (i + 1) / 2 + j] - dot_n(row, other, j);
            if (j < i)
                row[j] = rest / other[j];
            else /* at least the pull, whatever rounding did */
                row[i] = sqrt(rest > 0 ? rest + pull : pull);
        }
    }
}

void enc_joint_reduce(enc_quadric *q, const double *tail, unsigned m,
                      enc_joint_solver *out)
{
    if (m == 0)
        return;
    const tail_view v = view(tail, m);
    factorise(v.d, m, out->factor);
    for (unsigned i = 0; i < m; i++) {
        const double *row = out->factor + i * (i + 1) / 2;
        double mixed[3] = { v.m[3 * i], v.m[3 * i + 1], v.m[3 * i + 2] };
        double own = v.t[i];
        for (unsigned j = 0; j < i; j++) {
            for (unsigned k = 0; k < 3; k++)
                mixed[k] -= row[j] * out->mixed[j][k];
            own -= row[j] * out->own[j];
        }
        for (unsigned k = 0; k < 3; k++)
            out->mixed[i][k] = mixed[k] / row[i];
        out->own[i] = own / row[i];

        const double *y = out->mixed[i];
        for (unsigned r = 0, k = 0; r < 3; r++) {
            q->b[r] -= y[r] * out->own[i];
            for (unsigned c = r; c < 3; c++)
                q->a[k++] -= y[r] * y[c];
        }
        q->c -= out->own[i] * out->own[i];
    }
}

void enc_joint_attributes(const enc_joint_solver *solver, unsigned m,
                          const double x[3], double *s)
{
    for (unsigned i = m; i-- > 0;) {
        double rest = -(dot3(solver->mixed[i], x) + solver->own[i]);
        for (unsigned j = i + 1; j < m; j++)
            rest -= solver->factor[j * (j + 1) / 2 + i] * s[j];
        s[i] = rest / solver->factor[i * (i + 1) / 2 + i];
    }
}
