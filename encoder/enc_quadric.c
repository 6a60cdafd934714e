/* SPDX-License-Identifier: MIT */
#include "encoder/enc_quadric.h"

#include <stddef.h>
#include <string.h>

/* Relative to the trace, so that the result does not depend on the unit. A
 * hundred times more costs a tenth of the accuracy on smooth meshes; without
 * any, planar regions throw vertices far away. */
#define PULL 1e-5

/* The adjugate of the symmetric matrix m; returns the determinant. */
static double adjugate(const double m[6], double out[6])
{
    out[0] = m[3] * m[5] - m[4] * m[4];
    out[1] = m[2] * m[4] - m[1] * m[5];
    out[2] = m[1] * m[4] - m[2] * m[3];
    out[3] = m[0] * m[5] - m[2] * m[2];
    out[4] = m[1] * m[2] - m[0] * m[4];
    out[5] = m[0] * m[3] - m[1] * m[1];
    return m[0] * out[0] + m[1] * out[1] + m[2] * out[2];
}

static void multiply(const double m[6], const double x[3], double out[3])
{
    out[0] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
    out[1] = m[1] * x[0] + m[3] * x[1] + m[4] * x[2];
    out[2] = m[2] * x[0] + m[4] * x[1] + m[5] * x[2];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* `weak`: the pull to the centre, as a share of the trace. */
static bool solve(const enc_quadric *q, double weak, enc_quadric_solution *out)
{
    const double trace = enc_quadric_trace(q);
    double m[6];

    if (!(trace > 0))
        return false;
    /* Scaled to trace 1: the determinant is then at least weak^3. */
    for (int i = 0; i < 6; i++)
        m[i] = q->a[i] / trace;
    m[0] += weak;
    m[3] += weak;
    m[5] += weak;
    const double det = adjugate(m, out->inverse);
    const double scale = 1 / (det * trace);
    const double goal[3] = { -q->b[0] * scale, -q->b[1] * scale,
                             -q->b[2] * scale };

    if (!(det > 0))
        return false;
    multiply(out->inverse, goal, out->least);
    return true;
}

bool enc_quadric_solve(const enc_quadric *q, enc_quadric_solution *out)
{
    return solve(q, PULL, out);
}

bool enc_quadric_least_on(const enc_quadric_solution *s, const enc_plane *keep,
                          double x[3])
{
    double step[3];

    multiply(s->inverse, keep->n, step);
    const double slope = dot(keep->n, step);
    if (!(slope > 0))
        return false;
    const double t = (keep->offset - dot(keep->n, s->least)) / slope;
    for (int i = 0; i < 3; i++)
        x[i] = s->least[i] + t * step[i];
    return true;
}

static bool minimum(const enc_quadric *q, double weak, const enc_plane *keep,
                    double x[3])
{
    enc_quadric_solution s;

    x[0] = x[1] = x[2] = 0;
    if (!solve(q, weak, &s))
        return false;
    if (keep)
        return enc_quadric_least_on(&s, keep, x);
    memcpy(x, s.least, sizeof s.least);
    return true;
}

bool enc_quadric_minimum(const enc_quadric *q, const enc_plane *keep,
                         double x[3])
{
    return minimum(q, PULL, keep, x);
}

bool enc_quadric_pulled_minimum(const enc_quadric *q, const enc_quadric *pull,
                                double x[3])
{
    const double trace = enc_quadric_trace(q);
    const double both = trace + enc_quadric_trace(pull);
    enc_quadric sum;

    enc_quadric_add_here(q, pull, &sum);
    return minimum(&sum, trace > 0 ? PULL * trace / both : PULL, NULL, x);
}
