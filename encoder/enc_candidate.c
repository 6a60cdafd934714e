/* SPDX-License-Identifier: MIT */
#include "encoder/enc_candidate.h"

#include <string.h>

#include "encoder/enc_star.h"

/* An optimal place may be this many squared edge lengths from the midpoint. */
#define MAX_REACH_SQUARED 4.0

/* The place that keeps the volume may cost this much more than the best. */
#define VOLUME_GUARD 2.0

/* Of equally good grid points the nearer one; relative to the trace. */
#define ROUNDING_PULL 1e-2

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void difference(const int32_t a[3], const int32_t b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)(a[i] - b[i]);
}

static void scale(enc_quadric *q, double factor)
{
    for (int i = 0; i < 6; i++)
        q->a[i] *= factor;
    for (int i = 0; i < 3; i++)
        q->b[i] *= factor;
    q->c *= factor;
    q->weight *= factor;
}

static double factor_of(const enc_pricing *p, uint32_t v)
{
    return p->factor ? (double)p->factor[v] : 1;
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

static bool is_pulled(const enc_pricing *p, const enc_pair *pair)
{
    return p->pull && (p->pulled[pair->child] || p->pulled[pair->parent]);
}

/* The constraints of both ends about the midpoint; none is all zero. */
static void sum_pulls(const enc_pricing *p, const enc_pair *pair,
                      const double half[3], enc_quadric *sum)
{
    sum->weight = 0;
    if (is_pulled(p, pair))
        sum_about_midpoint(&p->pull[pair->child], &p->pull[pair->parent], half,
                           sum);
}

static double pull_at(const enc_quadric *pull, const double x[3])
{
    return pull->weight > 0 ? enc_quadric_value(pull, x) / pull->weight : 0;
}

/* Of the two ends the one that the constraints like better. */
static void constrained_end(const enc_quadric *pull, const double half[3],
                            double x[3])
{
    const double child[3] = { half[0], half[1], half[2] };
    const double parent[3] = { -half[0], -half[1], -half[2] };
    const bool better =
        enc_quadric_value(pull, child) < enc_quadric_value(pull, parent);

    memcpy(x, better ? child : parent, sizeof child);
}

/* The best place of all within reach; else, false, one of the ends or halfway.
 * Constraints that are not to be met together, as two lines of a curve are
 * not, leave an end: that has met its own. `solved`: of the sum; or NULL, there
 * is none. */
static bool free_place(const enc_quadric *sum,
                       const enc_quadric_solution *solved,
                       const enc_quadric *pull, const double half[3],
                       double x[3])
{
    const bool found = solved && within_reach(solved->least, half);

    if (found)
        memcpy(x, solved->least, sizeof solved->least);
    else
        best_of_three(sum, half, x);
    if (pull_at(pull, x) <= ENC_CONTENT)
        return found;
    if (enc_quadric_pulled_minimum(sum, pull, x) && within_reach(x, half) &&
        pull_at(pull, x) <= ENC_CONTENT)
        return true;
    constrained_end(pull, half, x);
    return false;
}

/* An inner vertex goes to the boundary, never the other way. */
static bool parent_moves(const enc_pricing *p, const enc_surface *s,
                         const enc_pair *pair)
{
    return p->placement == PMESH_OPTIMAL &&
           !(p->lock && p->lock[pair->parent]) &&
           enc_on_boundary(s, pair->child) == enc_on_boundary(s, pair->parent);
}

static double regularity(const enc_pricing *p, const enc_pair *pair,
                         double edge_square)
{
    double sum = p->taste.length * edge_square;

    if (p->taste.uneven > 0)
        sum += p->taste.uneven * p->unevenness[pair->child];
    return p->edge_square * sum;
}

/* Of what is no quadric, which has its factors already. */
static double mean_factor(const enc_pricing *p, const enc_pair *pair)
{
    return 0.5 * (factor_of(p, pair->child) + factor_of(p, pair->parent));
}

static double plain_cost(const enc_pricing *p, const enc_pair *pair,
                         double edge_square, double quadric)
{
    return p->taste.quadric * quadric +
           mean_factor(p, pair) * regularity(p, pair, edge_square);
}

/* By another rule than quadrics; the parent goes to `middle` + x. */
static double cost_by_rule(const enc_pricing *p, const enc_surface *s,
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
    const double cost = enc_cost(&p->rule, &told);
    const bool shape_apart = p->rule.cost == PMESH_COST_LENGTH ||
                             p->rule.cost == PMESH_COST_CAMERA;
    return shape_apart ? mean_factor(p, pair) * cost : cost;
}

/* `half` points from the middle to the child. */
static double cost_of(const enc_pricing *p, const enc_surface *s,
                      const enc_pair *pair, const double middle[3],
                      const double half[3], const double x[3],
                      const enc_offer *offer)
{
    return p->rule.cost == PMESH_COST_QUADRIC
               ? plain_cost(p, pair, 4 * dot(half, half), offer->quadric)
               : cost_by_rule(p, s, pair, middle, x, offer);
}

/* Both ends' quadrics about the midpoint: without attributes and factors, and
 * with them. The pair is expected. */
static void sum_both(const enc_pricing *p, const enc_surface *s,
                     const enc_pair *pair, enc_quadric ends[2],
                     const double half[3], bool now, enc_quadric *shape,
                     enc_quadric *sum)
{
    sum_about_midpoint(&ends[0], &ends[1], half, shape);
    *sum = *shape;
    const bool neutral =
        factor_of(p, pair->child) == 1 && factor_of(p, pair->parent) == 1;
    if (p->looks.count == 0 && neutral)
        return;
    enc_looks_add_child(&p->looks, s, pair->child, now, &ends[0]);
    if (parent_moves(p, s, pair))
        enc_looks_add_parent(&p->looks, s, pair->parent, now, &ends[1]);
    if (!neutral) {
        scale(&ends[0], factor_of(p, pair->child));
        scale(&ends[1], factor_of(p, pair->parent));
    }
    sum_about_midpoint(&ends[0], &ends[1], half, sum);
}

/* The quadric of v at x, as seen from it: enc_quadric_value() of recall(), read
 * where it is. */
static inline double stored_value(const enc_pricing *p, uint32_t v,
                                  const double x[3])
{
    const double *a = p->planes[v].a;
    double s[3] = { a[0] * x[0] + a[1] * x[1] + a[2] * x[2],
                    a[1] * x[0] + a[3] * x[1] + a[4] * x[2],
                    a[2] * x[0] + a[4] * x[1] + a[5] * x[2] };
    double c = 0;

    if (p->moved) {
        const enc_moved *m = &p->moved[v];
        for (int i = 0; i < 3; i++)
            s[i] = s[i] + m->b[i] + m->b[i];
        c = m->c;
    }
    const double value = x[0] * s[0] + x[1] * s[1] + x[2] * s[2] + c;
    return value > 0 ? value : 0;
}

/* Quadrics alone are asked for. */
static bool is_plain(const enc_pricing *p)
{
    return p->looks.count == 0 && p->rule.cost == PMESH_COST_QUADRIC;
}

/* A parent that stays, by quadrics alone: what most pairs are; `edge` leads from
 * the parent to the child. */
static enc_offer estimate_plain(const enc_pricing *p, const enc_pair *pair,
                                const double edge[3])
{
    const double back[3] = { -edge[0], -edge[1], -edge[2] };
    const double rest = p->moved ? p->moved[pair->parent].c : 0;
    enc_offer offer = { .cost = 0 };

    offer.quadric = factor_of(p, pair->child) *
                        stored_value(p, pair->child, back) +
                    factor_of(p, pair->parent) * rest;
    offer.cost = plain_cost(p, pair, dot(edge, edge), offer.quadric);
    return offer;
}

enc_offer enc_pricing_estimate(const enc_pricing *p, const enc_surface *s,
                               const enc_pair *pair)
{
    double edge[3], half[3], middle[3], x[3];

    difference(s->position[pair->child], s->position[pair->parent], edge);
    if (is_plain(p) && p->placement == PMESH_SUBSET)
        return estimate_plain(p, pair, edge);
    enc_quadric ends[2] = { recall(p, pair->child), recall(p, pair->parent) };
    const double weight = ends[0].weight + ends[1].weight;
    enc_offer offer = { .cost = 0 };
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
        offer.quadric =
            factor_of(p, pair->child) * enc_quadric_value(&ends[0], back) +
            factor_of(p, pair->parent) * ends[1].c;
    } else {
        enc_quadric_solution solved;
        enc_quadric shape, sum, pull;
        sum_both(p, s, pair, ends, half, false, &shape, &sum);
        sum_pulls(p, pair, half, &pull);
        const bool found = enc_quadric_solve(&sum, &solved);
        free_place(&sum, found ? &solved : NULL, &pull, half, x);
        offer.distance = enc_quadric_value(&shape, x);
        offer.quadric = enc_quadric_value(&sum, x);
    }
    enc_looks_forget(&p->looks, s, pair);
    offer.distance = weight > 0 ? offer.distance / weight : 0;
    offer.cost = cost_of(p, s, pair, middle, half, x, &offer);
    return offer;
}

/* One end's share of the sum about the midpoint, which lies at `back`. */
typedef struct share {
    double b[3], c[4]; /* the terms of c in their order: sums round */
} share;

static inline share share_of(const enc_pricing *p, uint32_t v,
                             const double back[3])
{
    static const enc_moved none = { { 0, 0, 0 }, 0 };
    const double *a = p->planes[v].a;
    const enc_moved *m = p->moved ? &p->moved[v] : &none;
    share out = {
        { a[0] * back[0] + a[1] * back[1] + a[2] * back[2] + m->b[0],
          a[1] * back[0] + a[3] * back[1] + a[4] * back[2] + m->b[1],
          a[2] * back[0] + a[4] * back[1] + a[5] * back[2] + m->b[2] },
        { 0, 0, 0, m->c }
    };

    for (int i = 0; i < 3; i++)
        out.c[i] = back[i] * (out.b[i] + m->b[i]);
    return out;
}

/* As enc_quadric_add() sums them up, one end after the other. */
static double sum_rests(const share *first, const share *second)
{
    double c = 0;

    for (int i = 0; i < 4; i++)
        c += first->c[i];
    for (int i = 0; i < 4; i++)
        c += second->c[i];
    return c;
}

/* As enc_quadric_value() begins. */
static double value_but_rest(const enc_quadric *q, const double x[3])
{
    double s[3];

    enc_quadric_slope(q, x, s);
    return x[0] * (s[0] + q->b[0]) + x[1] * (s[1] + q->b[1]) +
           x[2] * (s[2] + q->b[2]);
}

/* Both directions of a pair whose parent moves, without constraints: they have
 * one place and, but for rounding, one cost. */
static void estimate_moving(const enc_pricing *p, const enc_pair ways[2],
                            const double edge[3], enc_offer out[2])
{
    const double half[2][3] = {
        { edge[0] / 2, edge[1] / 2, edge[2] / 2 },
        { -edge[0] / 2, -edge[1] / 2, -edge[2] / 2 }
    };
    const enc_planes *child = &p->planes[ways[0].child];
    const enc_planes *parent = &p->planes[ways[0].parent];
    const share a = share_of(p, ways[0].child, half[1]);
    const share b = share_of(p, ways[0].parent, half[0]);
    enc_quadric sum = { .weight = child->weight + parent->weight };
    double x[3];

    for (int i = 0; i < 6; i++)
        sum.a[i] = child->a[i] + parent->a[i];
    for (int i = 0; i < 3; i++)
        sum.b[i] = a.b[i] + b.b[i];
    const double rest[2] = { sum_rests(&a, &b), sum_rests(&b, &a) };
    const bool found =
        enc_quadric_minimum(&sum, NULL, x) && within_reach(x, half[0]);
    const double found_value = found ? value_but_rest(&sum, x) : 0;
    for (int k = 0; k < 2; k++) {
        double value = found_value + rest[k];
        if (!found) {
            sum.c = rest[k];
            best_of_three(&sum, half[k], x);
            value = enc_quadric_value(&sum, x);
        }
        out[k].quadric = value > 0 ? value : 0;
        out[k].cost = plain_cost(p, &ways[k], 4 * dot(half[k], half[k]),
                                 out[k].quadric);
    }
}

void enc_pricing_estimate_both(const enc_pricing *p, const enc_surface *s,
                               const enc_pair ways[2], enc_offer out[2])
{
    double edge[3];

    if (is_plain(p) && p->placement == PMESH_SUBSET) {
        difference(s->position[ways[0].child], s->position[ways[0].parent],
                   edge);
        const double back[3] = { -edge[0], -edge[1], -edge[2] };
        out[0] = estimate_plain(p, &ways[0], edge);
        out[1] = estimate_plain(p, &ways[1], back);
    } else if (is_plain(p) && !p->factor && !p->pull && !p->lock &&
               parent_moves(p, s, &ways[0])) {
        difference(s->position[ways[0].child], s->position[ways[0].parent],
                   edge);
        estimate_moving(p, ways, edge, out);
    } else {
        out[0] = enc_pricing_estimate(p, s, &ways[0]);
        out[1] = enc_pricing_estimate(p, s, &ways[1]);
    }
}

/* Where the parent should go, relative to the midpoint. A constraint is worth
 * more than the volume. `keep`: the plane of constant volume; or NULL. */
static void optimal_place(const enc_quadric *sum, const enc_quadric *pull,
                          const double half[3], const enc_plane *keep,
                          double x[3])
{
    enc_quadric_solution solved;
    const bool found = enc_quadric_solve(sum, &solved);
    double y[3];

    if (!free_place(sum, found ? &solved : NULL, pull, half, x) || !keep)
        return;
    if (found && enc_quadric_least_on(&solved, keep, y) &&
        within_reach(y, half) &&
        pull_at(pull, y) <= ENC_CONTENT &&
        enc_quadric_value(sum, y) <= VOLUME_GUARD * enc_quadric_value(sum, x))
        memcpy(x, y, sizeof y);
}

/* The grid point beside x, of the eight around it, that costs least; `trace` is
 * of the surface's part of the quadric. */
static void round_place(const enc_mesh *mesh, const enc_quadric *sum,
                        double trace,
                        const double middle[3], const double x[3],
                        int32_t place[3])
{
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

/* The quadrics of both ends as they are now, child first, each about its end;
 * and the plane of constant volume about the midpoint, unless keep is NULL. */
static void current_quadrics(const enc_pricing *p, const enc_surface *s,
                             const enc_pair *pair, const double half[3],
                             enc_quadric ends[2], enc_plane *keep)
{
    const uint32_t end[2] = { pair->child, pair->parent };
    const enc_star_keep keeps[2] = {
        { ENC_NONE, { half[0], half[1], half[2] }, keep },
        { pair->child, { -half[0], -half[1], -half[2] }, keep }
    };

    if (keep)
        *keep = (enc_plane){ .offset = 0 };
    for (int k = 0; k < 2; k++) {
        if (p->metric == PMESH_MEMORYLESS) {
            enc_star_quadric(s, end[k], &ends[k], keep ? &keeps[k] : NULL);
        } else {
            ends[k] = recall(p, end[k]);
            if (keep)
                enc_star_volume(s, end[k], &keeps[k]);
        }
    }
}

enc_offer enc_pricing_offer(const enc_pricing *p, const enc_surface *s,
                            const enc_pair *pair)
{
    const int32_t *from = s->position[pair->child];
    const int32_t *to = s->position[pair->parent];
    enc_quadric ends[2], shape, sum, pull, steered;
    enc_offer offer = { .place = { to[0], to[1], to[2] } };
    double edge[3], half[3], middle[3], x[3];

    const bool moves = parent_moves(p, s, pair);
    const bool keeps = moves && !enc_on_boundary(s, pair->parent);
    enc_plane keep;

    difference(from, to, edge);
    for (int i = 0; i < 3; i++) {
        half[i] = edge[i] / 2;
        middle[i] = to[i] + half[i];
    }
    current_quadrics(p, s, pair, half, ends, keeps ? &keep : NULL);
    sum_both(p, s, pair, ends, half, true, &shape, &sum);
    if (moves) {
        sum_pulls(p, pair, half, &pull);
        optimal_place(&sum, &pull, half, keeps ? &keep : NULL, x);
        if (pull.weight > 0)
            enc_quadric_add_here(&sum, &pull, &steered);
        round_place(s->mesh, pull.weight > 0 ? &steered : &sum,
                    enc_quadric_trace(&sum), middle, x, offer.place);
    }
    for (int i = 0; i < 3; i++)
        x[i] = offer.place[i] - middle[i];
    offer.quadric = enc_quadric_value(&sum, x);
    if (shape.weight > 0)
        offer.distance = enc_quadric_value(&shape, x) / shape.weight;
    offer.cost = cost_of(p, s, pair, middle, half, x, &offer);
    return offer;
}

void enc_pricing_ends(const enc_pricing *p, const enc_surface *s,
                      const enc_pair *pair, double pull[2])
{
    double half[3], back[3];
    enc_quadric sum;

    difference(s->position[pair->child], s->position[pair->parent], half);
    for (int i = 0; i < 3; i++) {
        half[i] /= 2;
        back[i] = -half[i];
    }
    sum_pulls(p, pair, half, &sum);
    pull[0] = pull_at(&sum, back);
    pull[1] = pull_at(&sum, half);
}

/* The factor of what two vertices become: the mean by area. */
static double sum_factors(const enc_pricing *p, const enc_pair *pair)
{
    const double child = p->planes[pair->child].weight;
    const double parent = p->planes[pair->parent].weight;
    const double mean = child * factor_of(p, pair->child) +
                        parent * factor_of(p, pair->parent);
    return child + parent > 0 ? mean / (child + parent) : 1;
}

void enc_pricing_contract(enc_pricing *p, const enc_surface *s,
                          const enc_pair *pair, const int32_t place[3])
{
    double from_child[3], from_parent[3];
    enc_quadric sum = { .c = 0 };

    difference(s->position[pair->child], place, from_child);
    difference(s->position[pair->parent], place, from_parent);
    if (is_pulled(p, pair)) {
        p->pulled[pair->parent] = 1;
        enc_quadric_add(&sum, &p->pull[pair->child], from_child);
        enc_quadric_add(&sum, &p->pull[pair->parent], from_parent);
        p->pull[pair->parent] = sum;
        sum = (enc_quadric){ .c = 0 };
    }
    const double both = sum_factors(p, pair);
    if (p->metric == PMESH_MEMORYLESS) {
        if (p->factor)
            p->factor[pair->parent] = (float)both;
        return;
    }
    enc_quadric child = recall(p, pair->child);
    enc_quadric parent = recall(p, pair->parent);
    if (p->factor) {
        scale(&child, (double)p->factor[pair->child]);
        scale(&parent, (double)p->factor[pair->parent]);
    }
    enc_quadric_add(&sum, &child, from_child);
    enc_quadric_add(&sum, &parent, from_parent);
    if (p->factor) { /* the stored one is without */
        p->factor[pair->parent] = (float)both;
        scale(&sum, 1 / (double)p->factor[pair->parent]);
    }
    memcpy(p->planes[pair->parent].a, sum.a, sizeof sum.a);
    p->planes[pair->parent].weight = sum.weight;
    memcpy(p->moved[pair->parent].b, sum.b, sizeof sum.b);
    p->moved[pair->parent].c = sum.c;
}
