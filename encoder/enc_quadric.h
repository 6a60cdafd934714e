/* SPDX-License-Identifier: MIT */
/*
 * enc_quadric.h - sums of squared distances to planes (Garland, Heckbert 1997).
 *
 * A quadric is kept about a centre, in practice the position of its vertex:
 * far from the origin the constant terms would cancel catastrophically, and
 * the planes of a vertex's own faces all pass through the centre, so that b
 * and c are zero until the vertex moves. Lengths are in grid steps.
 */
#ifndef ENC_QUADRIC_H
#define ENC_QUADRIC_H

#include <stdbool.h>

/* The value at x is x'Ax + 2 b'x + c, with x relative to the centre. */
typedef struct enc_quadric {
    double a[6]; /* xx xy xz yy yz zz */
    double b[3];
    double c;
    double weight; /* of all planes: value / weight is a squared distance */
} enc_quadric;

/* The plane { x : n'x = offset }: the places that keep the volume. */
typedef struct enc_plane {
    double n[3];
    double offset;
} enc_plane;

/* Adds the plane through the centre with normal n (of any length but 0). */
static inline void enc_quadric_add_plane(enc_quadric *q, const double n[3],
                                         double weight)
{
    const double w = weight / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

    q->a[0] += w * n[0] * n[0];
    q->a[1] += w * n[0] * n[1];
    q->a[2] += w * n[0] * n[2];
    q->a[3] += w * n[1] * n[1];
    q->a[4] += w * n[1] * n[2];
    q->a[5] += w * n[2] * n[2];
    q->weight += weight;
}

/* out = A x + b */
static inline void enc_quadric_slope(const enc_quadric *q, const double x[3],
                                     double out[3])
{
    const double *a = q->a;

    out[0] = a[0] * x[0] + a[1] * x[1] + a[2] * x[2] + q->b[0];
    out[1] = a[1] * x[0] + a[3] * x[1] + a[4] * x[2] + q->b[1];
    out[2] = a[2] * x[0] + a[4] * x[1] + a[5] * x[2] + q->b[2];
}

/* Rounding may turn a zero into a tiny negative value; never returned. */
static inline double enc_quadric_value(const enc_quadric *q, const double x[3])
{
    double s[3];

    enc_quadric_slope(q, x, s);
    const double value = x[0] * (s[0] + q->b[0]) + x[1] * (s[1] + q->b[1]) +
                         x[2] * (s[2] + q->b[2]) + q->c;
    return value > 0 ? value : 0;
}

/* sum += q, whose centre lies at `offset` as seen from the sum's. */
static inline void enc_quadric_add(enc_quadric *sum, const enc_quadric *q,
                                   const double offset[3])
{
    const double back[3] = { -offset[0], -offset[1], -offset[2] };
    double s[3];

    enc_quadric_slope(q, back, s);
    for (int i = 0; i < 6; i++)
        sum->a[i] += q->a[i];
    for (int i = 0; i < 3; i++) {
        sum->b[i] += s[i];
        sum->c += back[i] * (s[i] + q->b[i]);
    }
    sum->c += q->c;
    sum->weight += q->weight;
}

/* The size of a quadric, whatever its directions. */
static inline double enc_quadric_trace(const enc_quadric *q)
{
    return q->a[0] + q->a[3] + q->a[5];
}

/* *out becomes the sum of two quadrics about one centre. */
static inline void enc_quadric_add_here(const enc_quadric *q,
                                        const enc_quadric *r, enc_quadric *out)
{
    const double here[3] = { 0, 0, 0 };

    *out = *q;
    enc_quadric_add(out, r, here);
}

/*
 * The place of the least value, with a pull to the centre so weak that it
 * decides only along directions in which the quadric is flat.
 *
 * keep: NULL, or a plane on which the place must lie.
 *
 * Returns false, with x = 0, if the system has no solution that means
 * anything: an empty quadric, or a plane without a normal.
 */
bool enc_quadric_minimum(const enc_quadric *q, const enc_plane *keep,
                         double x[3]);

/* For several planes: what depends on the quadric alone. */
typedef struct enc_quadric_solution {
    double inverse[6]; /* up to a factor */
    double least[3];   /* the place without a plane */
} enc_quadric_solution;

/* False: none that means anything, see above. */
bool enc_quadric_solve(const enc_quadric *q, enc_quadric_solution *out);
/* False, with x as it was: a plane without a normal. */
bool enc_quadric_least_on(const enc_quadric_solution *s, const enc_plane *keep,
                          double x[3]);

/* Of the sum of both; the weak pull is measured by q alone, so that a strong
 * `pull` moves nothing along the directions that it leaves free. */
bool enc_quadric_pulled_minimum(const enc_quadric *q, const enc_quadric *pull,
                                double x[3]);

#endif
