/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_price.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_lod_hull.h"
#include "encoder/enc_lod_place.h"
#include "format/alloc.h"

pmesh_status enc_lod_pricer_create(enc_lod *lod,
                                   const pmesh_simplify_options *options,
                                   const enc_lod_frame *frame,
                                   pmesh_place placement,
                                   const enc_lod_channels *channels,
                                   double *value, enc_lod_pricer *out)
{
    *out = (enc_lod_pricer){
        .lod = lod,
        .placement = placement,
        .rule = { .cost = options->cost,
                  .hook = options->hook,
                  .user = options->user,
                  .unit = frame->extent },
    };
    memcpy(out->rule.camera, options->camera, sizeof options->camera);
    memcpy(out->rule.origin, frame->origin, sizeof frame->origin);
    /* Areas are to weigh as much as their roots on the whole. */
    if (options->metric == PMESH_MEMORYLESS)
        out->recall = options->memory / sqrt(lod->faces);
    pmesh_status status = enc_lod_wedges_create(
        lod, channels, options->boundary, options->seam, value, &out->wedges);
    if (status != PMESH_OK)
        return status;
    out->memory =
        pmesh_alloc(&lod->allocator, lod->vertex_count, sizeof *out->memory);
    return out->memory ? PMESH_OK : PMESH_E_MEMORY;
}

void enc_lod_pricer_destroy(enc_lod_pricer *p)
{
    if (!p->lod)
        return;
    pmesh_release(&p->lod->allocator, p->memory, p->lod->vertex_count,
                  sizeof *p->memory);
    enc_lod_wedges_destroy(&p->wedges);
    *p = (enc_lod_pricer){ 0 };
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void difference(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static enc_lod_edge edge_between(const enc_lod *lod, uint32_t gone,
                                 uint32_t kept)
{
    enc_lod_edge e = { .gone = gone, .kept = kept };

    for (int i = 0; i < 3; i++) {
        const double a = lod->position[gone][i], b = lod->position[kept][i];
        e.middle[i] = 0.5 * (a + b);
        e.half[i] = 0.5 * (a - b);
    }
    return e;
}

/* ---- memory -------------------------------------------------------------- */

/* The plane that stands upright on a face over its edge to `far`, if that is a
 * rim: v was surveyed. */
static void remember_rim(enc_lod_pricer *p, uint32_t v, uint32_t far,
                         const double n[3])
{
    const enc_lod *lod = p->lod;
    double along[3];

    if (lod->mark[far].faces != 1 || !(p->wedges.boundary > 0))
        return;
    difference(lod->position[far], lod->position[v], along);
    const double upright[3] = { along[1] * n[2] - along[2] * n[1],
                                along[2] * n[0] - along[0] * n[2],
                                along[0] * n[1] - along[1] * n[0] };
    if (dot(upright, upright) > 0)
        enc_quadric_add_plane(&p->memory[v], upright, sqrt(dot(along, along)));
}

/* Weighted by the root of the area: by the area, thin limbs would count for
 * too little, and with equal weights, flat parts of few faces. */
void enc_lod_pricer_remember(enc_lod_pricer *p, uint32_t v)
{
    const enc_lod *lod = p->lod;
    uint32_t c = lod->first_corner[v];

    p->memory[v] = (enc_quadric){ .c = 0 };
    do {
        double n[3];
        enc_lod_normal(lod, c, lod->position[v], n);
        const double square = dot(n, n);
        if (!(square > 0))
            continue;
        enc_quadric_add_plane(&p->memory[v], n, sqrt(0.5 * sqrt(square)));
        remember_rim(p, v, lod->corner_vertex[enc_lod_after(c)], n);
        remember_rim(p, v, lod->corner_vertex[enc_lod_before(c)], n);
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

/* What both ends remember, about the middle. */
static void sum_memory(const enc_lod_pricer *p, const enc_lod_edge *e,
                       enc_quadric *sum)
{
    const double back[3] = { -e->half[0], -e->half[1], -e->half[2] };

    *sum = (enc_quadric){ .c = 0 };
    enc_quadric_add(sum, &p->memory[e->gone], e->half);
    enc_quadric_add(sum, &p->memory[e->kept], back);
}

static void add_recalled(const enc_lod_pricer *p, const enc_quadric *memory,
                         enc_quadric *total)
{
    for (int i = 0; i < 6; i++)
        total->a[i] += p->recall * memory->a[i];
    for (int i = 0; i < 3; i++)
        total->b[i] += p->recall * memory->b[i];
    total->c += p->recall * memory->c;
    total->weight += p->recall * memory->weight;
}

static void carry_memory(enc_lod_pricer *p, const enc_lod_offer *offer)
{
    double from_gone[3], from_kept[3];
    enc_quadric sum = { .c = 0 };

    difference(p->lod->position[offer->gone], offer->place, from_gone);
    difference(p->lod->position[offer->kept], offer->place, from_kept);
    enc_quadric_add(&sum, &p->memory[offer->gone], from_gone);
    enc_quadric_add(&sum, &p->memory[offer->kept], from_kept);
    p->memory[offer->kept] = sum;
}

/* ---- costs --------------------------------------------------------------- */

/* By area times squared distance alone, small features go too early: area
 * counts to the power of 3/4. A smaller power lowers the largest distance
 * further, and raises the mean. */
static double balance(double value, double weight)
{
    return weight > 0 ? value / sqrt(sqrt(weight)) : value;
}

/* x: relative to the middle. */
static double cost_of(const enc_lod_pricer *p, const enc_lod_edge *e,
                      const double x[3], double value, double weight,
                      double distance)
{
    enc_cost_pair pair = {
        .kept = e->kept,
        .gone = e->gone,
        .ends = { p->lod->position[e->kept], p->lod->position[e->gone] },
        .quadric = value,
        .distance = distance,
    };

    if (p->rule.cost == PMESH_COST_QUADRIC)
        pair.quadric = balance(value, weight);
    for (int i = 0; i < 3; i++) {
        pair.middle[i] = e->middle[i];
        pair.half[i] = e->half[i];
        pair.place[i] = e->middle[i] + x[i];
    }
    return enc_cost(&p->rule, &pair);
}

/* n'x of both ends' faces, each once, is the volume that they gain. */
static bool volume_plane(const enc_lod_pricer *p, const enc_lod_edge *e,
                         enc_plane *keep)
{
    const enc_lod *lod = p->lod;
    const double *at = lod->position[e->gone];
    uint32_t c = lod->first_corner[e->gone];
    double rest[3]; /* of `kept` without the faces of both */

    if ((lod->lines[e->gone] | lod->lines[e->kept]) & ENC_LOD_RIM)
        return false;
    memcpy(rest, lod->normal[e->kept], sizeof rest);
    do {
        double n[3];
        if (enc_lod_corner_of(lod, c, e->kept) == ENC_NONE)
            continue;
        enc_lod_normal(lod, c, at, n);
        for (int i = 0; i < 3; i++)
            rest[i] -= n[i];
    } while ((c = lod->corner_next[c]) != lod->first_corner[e->gone]);
    const double *own = lod->normal[e->gone];
    for (int i = 0; i < 3; i++)
        keep->n[i] = own[i] + rest[i];
    keep->offset = dot(own, e->half) - dot(rest, e->half);
    return true;
}

/* False: nowhere. */
static bool find_place(const enc_lod_pricer *p, const enc_lod_edge *e,
                       const enc_quadric *total, double x[3])
{
    enc_plane keep;
    bool held = false;

    if (p->placement == PMESH_PLACE_HULL)
        return enc_lod_hull_place(p->lod, e, total, x);
    if (p->placement == PMESH_PLACE_OPTIMAL ||
        p->placement == PMESH_PLACE_VOLUME)
        held = volume_plane(p, e, &keep);
    return enc_lod_place(p->placement, total, e->half, held ? &keep : NULL, x);
}

/* The offer of letting `gone` go; with values only if it is to be taken. */
static enc_lod_offer make_offer(enc_lod_pricer *p, uint32_t gone, uint32_t kept,
                                bool full)
{
    const enc_lod_edge e = edge_between(p->lod, gone, kept);
    enc_lod_offer offer = { .gone = gone, .kept = kept };
    double x[3] = { -e.half[0], -e.half[1], -e.half[2] };
    double weight = 0;
    enc_quadric memory;

    const bool plain = !full && p->placement != PMESH_PLACE_ENDPOINT &&
                       enc_lod_is_plain(&p->wedges, gone, kept);

    if (!plain)
        enc_lod_gather(&p->wedges, gone, kept);
    sum_memory(p, &e, &memory);
    if (p->placement == PMESH_PLACE_ENDPOINT) {
        offer.quadric = enc_lod_onto_kept(&p->wedges, &e, p->break_seams) +
                        p->recall * enc_quadric_value(&memory, x);
        weight = enc_lod_weight(&p->wedges) + p->recall * memory.weight;
        memcpy(offer.place, p->lod->position[kept], sizeof offer.place);
        if (full && offer.quadric < INFINITY)
            enc_lod_choose(&p->wedges);
    } else {
        enc_quadric total;
        if (plain)
            enc_lod_sum_plain(&p->wedges, &e, &total);
        else
            enc_lod_sum(&p->wedges, &e, &total);
        add_recalled(p, &memory, &total);
        const bool placed = find_place(p, &e, &total, x);
        offer.quadric = placed ? enc_quadric_value(&total, x) : INFINITY;
        weight = total.weight;
        for (int i = 0; i < 3; i++)
            offer.place[i] = e.middle[i] + x[i];
        if (full && enc_lod_stride(&p->wedges) > 0)
            enc_lod_solve(&p->wedges, &e, x);
    }
    if (memory.weight > 0)
        offer.distance = enc_quadric_value(&memory, x) / memory.weight;
    offer.cost = cost_of(p, &e, x, offer.quadric, weight, offer.distance);
    return offer;
}

static bool directed(const enc_lod_pricer *p)
{
    return p->placement == PMESH_PLACE_ENDPOINT;
}

double enc_lod_pricer_cost(enc_lod_pricer *p, uint32_t u, uint32_t v, bool turn)
{
    const double forth = make_offer(p, u, v, false).cost;

    if (!directed(p))
        return forth;
    const double back = make_offer(p, v, u, false).cost;
    return (back < forth) != turn ? back : forth;
}

enc_lod_offer enc_lod_pricer_offer(enc_lod_pricer *p, uint32_t u, uint32_t v,
                                   bool turn)
{
    bool back = turn;

    if (directed(p))
        back = turn != (make_offer(p, v, u, false).cost <
                        make_offer(p, u, v, false).cost);
    return back ? make_offer(p, v, u, true) : make_offer(p, u, v, true);
}

void enc_lod_pricer_move(enc_lod_pricer *p, const enc_lod_offer *offer)
{
    carry_memory(p, offer);
    enc_lod_merge(&p->wedges, offer->gone, offer->kept, offer->place);
    memcpy(p->lod->position[offer->kept], offer->place, sizeof offer->place);
}
