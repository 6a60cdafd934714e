/* SPDX-License-Identifier: MIT */
/*
 * enc_distance.h - how far a point is from a triangle. All of it is inline: a
 * good part of a bake is this.
 */
#ifndef ENC_DISTANCE_H
#define ENC_DISTANCE_H

static inline void enc_minus(const double a[3], const double b[3],
                             double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static inline double enc_inner(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* From a stretch that begins at the point which x is `from` away from. */
static inline double enc_from_edge(const double from[3], const double along[3])
{
    const double length = enc_inner(along, along);
    const double reach = enc_inner(from, along);
    double off[3];

    const double t = reach <= 0 ? 0 : reach >= length ? 1 : reach / length;
    for (int i = 0; i < 3; i++)
        off[i] = from[i] - t * along[i];
    return enc_inner(off, off);
}

static inline double enc_least(double a, double b)
{
    return a < b ? a : b;
}

/* Squared; of any triangle, one without area too. Above the triangle it is the
 * height, else the distance of an edge. */
static inline double enc_distance_square(const double x[3], const double a[3],
                                         const double b[3], const double c[3])
{
    double u[3], v[3], w[3], p[3], q[3];

    enc_minus(b, a, u);
    enc_minus(c, a, v);
    enc_minus(x, a, p);
    const double uu = enc_inner(u, u), vv = enc_inner(v, v);
    const double uv = enc_inner(u, v);
    const double pu = enc_inner(p, u), pv = enc_inner(p, v);
    const double det = uu * vv - uv * uv;
    const double s = vv * pu - uv * pv, t = uu * pv - uv * pu;

    if (s > 0 && t > 0 && s + t < det) { /* so det > 0 */
        for (int i = 0; i < 3; i++)
            p[i] -= (s * u[i] + t * v[i]) / det;
        return enc_inner(p, p);
    }
    enc_minus(c, b, w);
    enc_minus(x, b, q);
    return enc_least(enc_least(enc_from_edge(p, u), enc_from_edge(p, v)),
                     enc_from_edge(q, w));
}

#endif
