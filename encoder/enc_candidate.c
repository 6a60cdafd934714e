/* SPDX-License-Identifier: MIT */
#include "encoder/enc_candidate.h"

#include <string.h>

#include "encoder/enc_star.h"
#include "format/alloc.h"

/* An optimal place may be this many squared edge lengths from the midpoint. */
#define MAX_REACH_SQUARED 4.0

/* The place that keeps the volume may cost this much more than the best. */
#define VOLUME_GUARD 2.0

/* Of equally good grid points the nearer one; relative to the trace. */
#define ROUNDING_PULL 1e-2

pmesh_status enc_pricing_create(const enc_mesh *mesh,
                                const pmesh_encoder_config *config,
                                enc_pricing *out)
{
    const pmesh_allocator *a = &mesh->allocator;

    *out = (enc_pricing){ .metric = config->metric,
                          .placement = config->placement,
                          .rule = { .cost = config->cost,
                                    .hook = config->cost_hook,
                                    .user = config->cost_user,
                                    .unit = mesh->grid.step } };
    memcpy(out->rule.camera, config->camera, sizeof config->camera);
    memcpy(out->rule.origin, mesh->grid.origin, sizeof out->rule.origin);
    const pmesh_status status = enc_looks_create(mesh, &out->looks);
    if (status != PMESH_OK)
        return status;
    out->planes = pmesh_alloc(a, mesh->vertex_count, sizeof *out->planes);
    if (config->metric == PMESH_ACCUMULATED)
        out->moved =
            pmesh_alloc_zero(a, mesh->vertex_count, sizeof *out->moved);
    out->unevenness =
        pmesh_alloc(a, mesh->vertex_count, sizeof *out->unevenness);
    if (!out->planes || !out->unevenness ||
        (config->metric == PMESH_ACCUMULATED && !out->moved)) {
        enc_pricing_destroy(mesh, out);
        return PMESH_E_MEMORY;
    }
    return PMESH_OK;
}

void enc_pricing_destroy(const enc_mesh *mesh, enc_pricing *p)
{
    const pmesh_allocator *a = &mesh->allocator;

    pmesh_release(a, p->planes, mesh->vertex_count, sizeof *p->planes);
    pmesh_release(a, p->moved, mesh->vertex_count, sizeof *p->moved);
    pmesh_release(a, p->unevenness, mesh->vertex_count, sizeof *p->unevenness);
    enc_looks_destroy(mesh, &p->looks);
    *p = (enc_pricing){ 0 };
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void difference(const int32_t a[3], const int32_t b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)(a[i] - b[i]);
}

static inline enc_quadric recall(const enc_pricing *p, uint32_t v)
{
    enc_quadric q = { .c = 0 };

    memcpy(q.a, p->planes[v].a, sizeof q.a);
    q.weight = p->planes[v].weight;
    if (p->moved) {
        memcpy(q.b, p->moved[v].b, sizeof q.b);
        q.c = p->moved[v].c;
    }
    return q;
}

void enc_pricing_begin(enc_pricing *p, const enc_surface *s, enc_taste taste,
                       bool first_time)
{
    double sum = 0;

    p->taste = taste;
    enc_looks_begin(&p->looks, s);
    if (first_time || p->metric == PMESH_MEMORYLESS)
        enc_star_all_planes(s, p->planes);
    for (uint32_t v = 0; v < s->mesh->vertex_count; v++) {
        double length;

        if (s->first[v] == ENC_NONE)
            continue;
        p->unevenness[v] = (float)enc_star_unevenness(s, v, &length);
        sum += length;
    }
    p->edge_square = sum / (3.0 * s->face_count);
}

/* The quadrics of both ends about the midpoint, and half of the edge. */
static void sum_about_midpoint(const enc_quadric *child,
                               const enc_quadric *parent, const double half[3],
                               enc_quadric *sum)
{
    const double back[3] = { -half[0], -half[1], -half[2] };

    memset(sum, 0, sizeof *sum);
    enc_quadric_add(sum, child, half);
    enc_quadric_add(sum, parent, back);
}

/* True if x is close enough to the midpoint to be trusted. */
static bool within_reach(const double x[3], const double half[3])
{
    return dot(x, x) <= MAX_REACH_SQUARED * 4 * dot(half, half);
}

/* The best of the ends and the midpoint; `half` points to the child. */
static void best_of_three(const enc_quadric *q, const double half[3],
                          double x[3])
{
    double best = 0;

    for (int side = -1; side <= 1; side++) {
        const double y[3] = { side * half[0], side * half[1], side * half[2] };
        const double value = enc_quadric_value(q, y);
        if (side == -1 || value < best) {
            best = value;
            memcpy(x, y, sizeof y);
        }
    }
}

/* An inner vertex goes to the boundary, never the other way. */
static bool parent_moves(const enc_pricing *p, const enc_surface *s,
                         const enc_pair *pair)
{
    return p->placement == PMESH_OPTIMAL &&
           enc_on_boundary(s, pair->child) == enc_on_boundary(s, pair->parent);
}

static double regularity(const enc_pricing *p, const enc_pair *pair,
                         double edge_square)
{
    return p->edge_square * (p->taste.length * edge_square +
                             p->taste.uneven * p->unevenness[pair->child]);
}

/* Of a pair whose parent goes to `middle` + x. */
static double cost_of(const enc_pricing *p, const enc_surface *s,
                      const enc_pair *pair, const double middle[3],
                      const double x[3], const enc_offer *offer)
{
    const uint32_t ends[2] = { pair->parent, pair->child };
    const uint32_t *source = s->mesh->source;
    double at[2][3];
    enc_cost_pair told = {
        .kept = source ? source[pair->parent] : pair->parent,
        .gone = source ? source[pair->child] : pair->child,
        .ends = { at[0], at[1] },
        .quadric = offer->quadric,
        .distance = offer->distance,
    };

    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 2; k++)
            at[k][i] = s->position[ends[k]][i];
        told.middle[i] = middle[i];
        told.half[i] = at[1][i] - middle[i];
        told.place[i] = middle[i] + x[i];
    }
    if (p->rule.cost != PMESH_COST_QUADRIC)
        return enc_cost(&p->rule, &told);
    return p->taste.quadric * offer->quadric +
           regularity(p, pair, 4 * dot(told.half, told.half));
}

/* Both ends' quadrics about the midpoint: without attributes, and with them.
 * The pair is expected. */
static void sum_both(const enc_pricing *p, const enc_surface *s,
                     const enc_pair *pair, enc_quadric ends[2],
                     const double half[3], bool now, enc_quadric *shape,
                     enc_quadric *sum)
{
    sum_about_midpoint(&ends[0], &ends[1], half, shape);
    *sum = *shape;
    if (p->looks.count == 0)
        return;
    enc_looks_add_child(&p->looks, s, pair->child, now, &ends[0]);
    if (parent_moves(p, s, pair))
        enc_looks_add_parent(&p->looks, s, pair->parent, now, &ends[1]);
    sum_about_midpoint(&ends[0], &ends[1], half, sum);
}

enc_offer enc_pricing_estimate(const enc_pricing *p, const enc_surface *s,
                               const enc_pair *pair)
{
    enc_quadric ends[2] = { recall(p, pair->child), recall(p, pair->parent) };
    const double weight = ends[0].weight + ends[1].weight;
    double edge[3], half[3], middle[3], x[3];
    enc_offer offer = { .cost = 0 };

    difference(s->position[pair->child], s->position[pair->parent], edge);
    for (int i = 0; i < 3; i++) {
        half[i] = edge[i] / 2;
        middle[i] = s->position[pair->parent][i] + half[i];
        x[i] = -half[i];
    }
    enc_looks_expect(&p->looks, s, pair);
    if (!parent_moves(p, s, pair)) {
        const double back[3] = { -edge[0], -edge[1], -edge[2] };
        offer.distance = enc_quadric_value(&ends[0], back) + ends[1].c;
        enc_looks_add_child(&p->looks, s, pair->child, false, &ends[0]);
        offer.quadric = enc_quadric_value(&ends[0], back) + ends[1].c;
    } else {
        enc_quadric shape, sum;
        sum_both(p, s, pair, ends, half, false, &shape, &sum);
        if (!enc_quadric_minimum(&sum, NULL, x) || !within_reach(x, half))
            best_of_three(&sum, half, x);
        offer.distance = enc_quadric_value(&shape, x);
        offer.quadric = enc_quadric_value(&sum, x);
    }
    enc_looks_forget(&p->looks, s, pair);
    offer.distance = weight > 0 ? offer.distance / weight : 0;
    offer.cost = cost_of(p, s, pair, middle, x, &offer);
    return offer;
}

/* Where the parent should go, relative to the midpoint. */
static void optimal_place(const enc_surface *s, const enc_pair *pair,
                          const enc_quadric *sum, const double half[3],
                          double x[3])
{
    const double back[3] = { -half[0], -half[1], -half[2] };
    const uint32_t none = ENC_NONE;
    enc_plane keep = { { 0, 0, 0 }, 0 };
    double y[3];

    if (!enc_quadric_minimum(sum, NULL, x) || !within_reach(x, half)) {
        best_of_three(sum, half, x);
        return;
    }
    if (enc_on_boundary(s, pair->parent))
        return;
    enc_star_volume(s, pair->child, none, half, &keep);
    enc_star_volume(s, pair->parent, pair->child, back, &keep);
    if (enc_quadric_minimum(sum, &keep, y) && within_reach(y, half) &&
        enc_quadric_value(sum, y) <= VOLUME_GUARD * enc_quadric_value(sum, x))
        memcpy(x, y, sizeof y);
}

/* The grid point beside x, of the eight around it, that costs least. */
static void round_place(const enc_mesh *mesh, const enc_quadric *sum,
                        const double middle[3], const double x[3],
                        int32_t place[3])
{
    const double trace = sum->a[0] + sum->a[3] + sum->a[5];
    double best = 0;

    for (unsigned corner = 0; corner < 8; corner++) {
        double y[3], far = 0;
        int32_t at[3];

        for (int i = 0; i < 3; i++) {
            const double g = middle[i] + x[i];
            at[i] = (g > 0 ? (int32_t)g : 0) + (int32_t)(corner >> i & 1);
            if (at[i] > mesh->bounds[i])
                at[i] = mesh->bounds[i];
            y[i] = at[i] - middle[i];
            far += (y[i] - x[i]) * (y[i] - x[i]);
        }
        const double value =
            enc_quadric_value(sum, y) + ROUNDING_PULL * trace * far;
        if (corner == 0 || value < best) {
            best = value;
            memcpy(place, at, sizeof at);
        }
    }
}

enc_offer enc_pricing_offer(const enc_pricing *p, const enc_surface *s,
                            const enc_pair *pair)
{
    const int32_t *from = s->position[pair->child];
    const int32_t *to = s->position[pair->parent];
    enc_quadric ends[2], shape, sum;
    enc_offer offer = { .place = { to[0], to[1], to[2] } };
    double edge[3], half[3], middle[3], x[3];

    if (p->metric == PMESH_MEMORYLESS) {
        enc_star_quadric(s, pair->child, &ends[0]);
        enc_star_quadric(s, pair->parent, &ends[1]);
    } else {
        ends[0] = recall(p, pair->child);
        ends[1] = recall(p, pair->parent);
    }
    difference(from, to, edge);
    for (int i = 0; i < 3; i++) {
        half[i] = edge[i] / 2;
        middle[i] = to[i] + half[i];
    }
    sum_both(p, s, pair, ends, half, true, &shape, &sum);
    if (parent_moves(p, s, pair)) {
        optimal_place(s, pair, &sum, half, x);
        round_place(s->mesh, &sum, middle, x, offer.place);
    }
    for (int i = 0; i < 3; i++)
        x[i] = offer.place[i] - middle[i];
    offer.quadric = enc_quadric_value(&sum, x);
    if (sum.weight > 0)
        offer.distance = enc_quadric_value(&shape, x) / sum.weight;
    offer.cost = cost_of(p, s, pair, middle, x, &offer);
    return offer;
}

void enc_pricing_contract(enc_pricing *p, const enc_surface *s,
                          const enc_pair *pair, const int32_t place[3])
{
    const enc_quadric child = recall(p, pair->child);
    const enc_quadric parent = recall(p, pair->parent);
    double from_child[3], from_parent[3];
    enc_quadric sum = { .c = 0 };

    if (p->metric == PMESH_MEMORYLESS)
        return;
    difference(s->position[pair->child], place, from_child);
    difference(s->position[pair->parent], place, from_parent);
    enc_quadric_add(&sum, &child, from_child);
    enc_quadric_add(&sum, &parent, from_parent);
    memcpy(p->planes[pair->parent].a, sum.a, sizeof sum.a);
    p->planes[pair->parent].weight = sum.weight;
    memcpy(p->moved[pair->parent].b, sum.b, sizeof sum.b);
    p->moved[pair->parent].c = sum.c;
}
