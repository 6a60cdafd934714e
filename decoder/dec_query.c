/* SPDX-License-Identifier: MIT */
/*
 * dec_query.c - questions about the shape that is visible: its box, and what a
 * ray meets.
 */
#include <float.h>

#include "decoder/dec_internal.h"

pmesh_status pmesh_decoder_bounds(const pmesh_decoder *dec, double minimum[3],
                                  double maximum[3])
{
    pmesh_view view;
    const pmesh_status status = pmesh_decoder_mesh(dec, &view);
    if (status != PMESH_OK)
        return status;
    const pmesh_grid *grid = &dec->header.grid;
    for (int k = 0; k < 3; k++) {
        int32_t low = view.positions[k], high = low;
        for (uint32_t v = 1; v < view.mesh_vertex_count; v++) {
            const int32_t q = view.positions[3 * (size_t)v + (size_t)k];
            low = q < low ? q : low;
            high = q > high ? q : high;
        }
        minimum[k] = grid->origin[k] + grid->step * low;
        maximum[k] = grid->origin[k] + grid->step * high;
    }
    return PMESH_OK;
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void corner_of(const pmesh_view *v, uint32_t f, int k, double out[3])
{
    const uint32_t w = v->indices[3 * (size_t)f + (size_t)k];
    const uint32_t u = v->positions_of ? v->positions_of[w] : w;
    for (int i = 0; i < 3; i++)
        out[i] = v->positions[3 * (size_t)u + (size_t)i];
}

/* Moller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997:
 * solves origin + t * direction = a + u * (b - a) + v * (c - a). */
static bool meets(const pmesh_view *view, uint32_t f, const double origin[3],
                  const double direction[3], pmesh_hit *hit)
{
    double a[3], ab[3], ac[3], p[3], q[3], s[3];
    corner_of(view, f, 0, a);
    corner_of(view, f, 1, ab);
    corner_of(view, f, 2, ac);
    for (int k = 0; k < 3; k++) {
        ab[k] -= a[k];
        ac[k] -= a[k];
        s[k] = origin[k] - a[k];
    }
    cross(p, direction, ac);
    const double det = dot(ab, p);
    if (det == 0)
        return false; /* along the plane, or no area */
    const double u = dot(s, p) / det;
    cross(q, s, ab);
    const double v = dot(direction, q) / det, t = dot(ac, q) / det;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t < hit->distance))
        return false;
    *hit = (pmesh_hit){ f, t, { 1 - u - v, u, v } };
    return true;
}

int pmesh_decoder_raycast(const pmesh_decoder *dec, const double origin[3],
                          const double direction[3], pmesh_hit *hit)
{
    pmesh_view view;
    if (pmesh_decoder_mesh(dec, &view) != PMESH_OK)
        return 0;
    const pmesh_grid *grid = &dec->header.grid;
    double from[3], along[3];
    for (int k = 0; k < 3; k++) { /* into grid units: distances stay */
        from[k] = (origin[k] - grid->origin[k]) / grid->step;
        along[k] = direction[k] / grid->step;
    }
    pmesh_hit best = { 0, DBL_MAX, { 0, 0, 0 } };
    int found = 0;
    for (uint32_t f = 0; f < view.face_count; f++)
        if (meets(&view, f, from, along, &best))
            found = 1;
    if (found)
        *hit = best;
    return found;
}
