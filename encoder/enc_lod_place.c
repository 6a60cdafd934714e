/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_place.h"

#include <string.h>

/* An optimal place may be this many squared edge lengths from the middle. */
#define MAX_REACH_SQUARED 4.0

/* The place that keeps the volume may cost this much more than the best. */
#define VOLUME_GUARD 1.2

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void scaled(const double half[3], double t, double x[3])
{
    for (int i = 0; i < 3; i++)
        x[i] = t * half[i];
}

/* The middle wins where all are equal. Returns the value. */
static double best_of_three(const enc_quadric *q, const double half[3],
                            double x[3])
{
    double best = 0;

    for (int i = 0; i < 3; i++) {
        static const double sides[3] = { 0, -1, 1 };
        double y[3];
        scaled(half, sides[i], y);
        const double value = enc_quadric_value(q, y);
        if (i == 0 || value < best) {
            best = value;
            memcpy(x, y, sizeof y);
        }
    }
    return best;
}

/* The least value between the ends: a parabola's. */
static bool on_line(const enc_quadric *q, const double half[3], double x[3])
{
    const double none[3] = { 0, 0, 0 };
    double at_middle[3], at_end[3];

    enc_quadric_slope(q, none, at_middle);
    enc_quadric_slope(q, half, at_end);
    const double rise = dot(half, at_end) - dot(half, at_middle);
    if (!(rise > 0))
        return false;
    const double t = -dot(half, at_middle) / rise;
    scaled(half, t < -1 ? -1 : t > 1 ? 1 : t, x);
    return true;
}

static bool within_reach(const double x[3], const double half[3])
{
    return dot(x, x) <= MAX_REACH_SQUARED * 4 * dot(half, half);
}

static bool optimal(const enc_quadric *q, const double half[3],
                    const enc_plane *keep, double limit, double x[3])
{
    enc_quadric_solution s;
    double y[3];

    if (!enc_quadric_solve(q, &s) || !within_reach(s.least, half))
        return false;
    memcpy(x, s.least, sizeof s.least);
    const double least = enc_quadric_value(q, x);
    if (!(least <= limit))
        return false;
    if (keep && enc_quadric_least_on(&s, keep, y) && within_reach(y, half)) {
        const double value = enc_quadric_value(q, y);
        if (value <= VOLUME_GUARD * least && value <= limit)
            memcpy(x, y, sizeof y);
    }
    return true;
}

bool enc_lod_place(pmesh_place rule, const enc_quadric *q, const double half[3],
                   const enc_plane *keep, double x[3])
{
    double y[3];

    if (rule == PMESH_PLACE_MIDPOINT) {
        scaled(half, 0, x);
        return true;
    }
    if (rule == PMESH_PLACE_VOLUME && keep)
        return enc_quadric_minimum(q, keep, x) && within_reach(x, half);
    const double limit = best_of_three(q, half, x);
    if (rule == PMESH_PLACE_ENDPOINT)
        return true;
    if (rule != PMESH_PLACE_LINE && optimal(q, half, keep, limit, y))
        memcpy(x, y, sizeof y);
    else if (on_line(q, half, y) && enc_quadric_value(q, y) <= limit)
        memcpy(x, y, sizeof y);
    return true;
}
