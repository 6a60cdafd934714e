/* SPDX-License-Identifier: MIT */
#include "encoder/enc_distance.h"

static void minus(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* From a stretch that begins at the point which x is `from` away from. */
static double from_edge(const double from[3], const double along[3])
{
    const double length = dot(along, along), reach = dot(from, along);
    double off[3];

    const double t = reach <= 0 ? 0 : reach >= length ? 1 : reach / length;
    for (int i = 0; i < 3; i++)
        off[i] = from[i] - t * along[i];
    return dot(off, off);
}

static double least(double a, double b)
{
    return a < b ? a : b;
}

/* Above the triangle it is the height, else the distance of an edge. */
double enc_distance_square(const double x[3], const double a[3],
                           const double b[3], const double c[3])
{
    double u[3], v[3], w[3], p[3], q[3];

    minus(b, a, u);
    minus(c, a, v);
    minus(x, a, p);
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
    const double pu = dot(p, u), pv = dot(p, v);
    const double det = uu * vv - uv * uv;
    const double s = vv * pu - uv * pv, t = uu * pv - uv * pu;

    if (s > 0 && t > 0 && s + t < det) { /* so det > 0 */
        for (int i = 0; i < 3; i++)
            p[i] -= (s * u[i] + t * v[i]) / det;
        return dot(p, p);
    }
    minus(c, b, w);
    minus(x, b, q);
    return least(least(from_edge(p, u), from_edge(p, v)), from_edge(q, w));
}
