/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_inspect.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_eigen.h"
#include "encoder/enc_import.h"
#include "encoder/enc_quadric.h"
#include "format/alloc.h"

/* A place further than this from the middle, in edges, is no place. */
#define REACH 2.0

static pmesh_status check(const pmesh_mesh_input *in)
{
    if ((in->vertex_count > 0 && !in->positions) ||
        (in->face_count > 0 && !in->indices))
        return PMESH_E_ARGUMENT;
    for (size_t c = 0; c < 3 * in->face_count; c++)
        if (in->indices[c] >= in->vertex_count)
            return PMESH_E_INDEX;
    return PMESH_OK;
}

static void difference(const pmesh_mesh_input *in, uint32_t from, uint32_t to,
                       double out[3])
{
    double p[3];

    enc_load_position(in, false, from, p);
    enc_load_position(in, false, to, out);
    for (int k = 0; k < 3; k++)
        out[k] -= p[k];
}

/* The planes of all faces, about each vertex; NULL: out of memory. */
static enc_quadric *make_quadrics(const pmesh_mesh_input *in,
                                  const pmesh_allocator *a)
{
    enc_quadric *q = pmesh_alloc_zero(a, in->vertex_count, sizeof *q);

    for (size_t f = 0; q && f < in->face_count; f++) {
        const uint32_t *v = &in->indices[3 * f];
        double ab[3], ac[3], square = 0, n[3];
        difference(in, v[0], v[1], ab);
        difference(in, v[0], v[2], ac);
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            n[k] = ab[i] * ac[j] - ab[j] * ac[i];
            square += n[k] * n[k];
        }
        if (!(square > 0 && square < INFINITY))
            continue;
        for (int k = 0; k < 3; k++)
            enc_quadric_add_plane(&q[v[k]], n, 0.5 * sqrt(square));
    }
    return q;
}

/* Of the edge's two quadrics at their best place, or the best of ends and
 * middle. */
static double edge_cost(const pmesh_mesh_input *in, const enc_quadric *q,
                        uint32_t u, uint32_t v)
{
    double half[3], back[3], x[3], far = 0, length = 0;
    enc_quadric sum = { .c = 0 };

    difference(in, u, v, half);
    for (int k = 0; k < 3; k++) {
        half[k] /= 2;
        back[k] = -half[k];
    }
    enc_quadric_add(&sum, &q[u], back);
    enc_quadric_add(&sum, &q[v], half);
    const bool found = enc_quadric_minimum(&sum, NULL, x);
    for (int k = 0; k < 3; k++) {
        far += x[k] * x[k];
        length += 4 * half[k] * half[k];
    }
    if (found && far <= REACH * REACH * length)
        return enc_quadric_value(&sum, x);
    const double middle[3] = { 0, 0, 0 };
    return fmin(enc_quadric_value(&sum, middle),
                fmin(enc_quadric_value(&sum, half),
                     enc_quadric_value(&sum, back)));
}

pmesh_status pmesh_inspect_costs(const pmesh_mesh_input *in,
                                 const pmesh_allocator *allocator, double *cost)
{
    const pmesh_allocator a = pmesh_allocator_resolve(
        allocator ? *allocator : (pmesh_allocator){ 0 });
    const pmesh_status status = check(in);

    if (status != PMESH_OK)
        return status;
    enc_quadric *q = make_quadrics(in, &a);
    if (!q)
        return PMESH_E_MEMORY;
    for (size_t v = 0; v < in->vertex_count; v++)
        cost[v] = INFINITY;
    for (size_t c = 0; c < 3 * in->face_count; c++) {
        const uint32_t u = in->indices[c];
        const uint32_t v = in->indices[c % 3 == 2 ? c - 2 : c + 1];
        if (u == v)
            continue;
        const double e = edge_cost(in, q, u, v);
        cost[u] = fmin(cost[u], e);
        cost[v] = fmin(cost[v], e);
    }
    for (size_t v = 0; v < in->vertex_count; v++)
        if (!(cost[v] < INFINITY))
            cost[v] = 0;
    pmesh_release(&a, q, in->vertex_count, sizeof *q);
    return PMESH_OK;
}

/* x'Ax = weight * distance^2 along an axis of A. */
static void make_ellipsoid(const enc_quadric *q, double distance, double limit,
                           pmesh_ellipsoid *out)
{
    double value[3];

    enc_eigen(q->a, value, out->axis);
    for (int k = 0; k < 3; k++) {
        const double square = q->weight * distance * distance;
        out->radius[k] = value[k] > 0 ? fmin(limit, sqrt(square / value[k]))
                                      : limit;
    }
}

pmesh_status pmesh_inspect_ellipsoids(const pmesh_mesh_input *in,
                                      const pmesh_allocator *allocator,
                                      const uint32_t *vertices, size_t count,
                                      double distance, double limit,
                                      pmesh_ellipsoid *out)
{
    const pmesh_allocator a = pmesh_allocator_resolve(
        allocator ? *allocator : (pmesh_allocator){ 0 });
    const pmesh_status status = check(in);

    if (status != PMESH_OK)
        return status;
    if (!(distance > 0) || !(limit > 0))
        return PMESH_E_ARGUMENT;
    for (size_t i = 0; i < count; i++)
        if (vertices[i] >= in->vertex_count)
            return PMESH_E_INDEX;
    enc_quadric *q = make_quadrics(in, &a);
    if (!q)
        return PMESH_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        enc_load_position(in, false, vertices[i], out[i].center);
        make_ellipsoid(&q[vertices[i]], distance, limit, &out[i]);
    }
    pmesh_release(&a, q, in->vertex_count, sizeof *q);
    return PMESH_OK;
}
