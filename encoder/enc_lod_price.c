/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_price.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_lod_place.h"
#include "format/alloc.h"

/* Decides between contractions that cost nothing: short edges first. Far above
 * the rounding of sums, far below what can be seen. */
#define LENGTH_TIE 1e-12

/* The factor f of the camera cost. */
#define CAMERA_FACTOR 0.01

pmesh_status enc_lod_pricer_create(enc_lod *lod,
                                   const pmesh_simplify_options *options,
                                   const enc_lod_frame *frame,
                                   pmesh_place placement,
                                   const enc_lod_channels *channels,
                                   double *value, enc_lod_pricer *out)
{
    const pmesh_allocator *a = &lod->allocator;
    const size_t n = lod->vertex_count;
    const size_t values = channels->active + channels->passive;
    const size_t tail = enc_joint_tail(channels->active);

    *out = (enc_lod_pricer){ .lod = lod,
                             .options = options,
                             .frame = *frame,
                             .placement = placement,
                             .active = channels->active,
                             .passive = channels->passive,
                             .channels = *channels,
                             .value = value };
    /* Areas are to weigh as much as their roots on the whole. */
    if (options->metric == PMESH_MEMORYLESS)
        out->recall = options->memory / sqrt(lod->faces);
    out->memory = pmesh_alloc(a, n, sizeof *out->memory);
    out->quadric = pmesh_alloc(a, n, sizeof *out->quadric);
    out->tail = pmesh_alloc(a, n * tail, sizeof *out->tail);
    out->wedge = pmesh_alloc(a, n, sizeof *out->wedge);
    out->fate = pmesh_alloc(a, n, sizeof *out->fate);
    out->choice = pmesh_alloc(a, n, sizeof *out->choice);
    out->stamp = pmesh_alloc_zero(a, n, sizeof *out->stamp);
    out->next = pmesh_alloc(a, n * values, sizeof *out->next);
    if (!out->value || !out->quadric || !out->tail || !out->memory || !out->wedge ||
        !out->fate || !out->choice || !out->stamp || !out->next) {
        enc_lod_pricer_destroy(out);
        return PMESH_E_MEMORY;
    }
    return PMESH_OK;
}

void enc_lod_pricer_destroy(enc_lod_pricer *p)
{
    if (!p->lod)
        return;
    const pmesh_allocator *a = &p->lod->allocator;
    const size_t n = p->lod->vertex_count, values = p->active + p->passive;

    pmesh_release(a, p->value, n * values, sizeof *p->value);
    pmesh_release(a, p->quadric, n, sizeof *p->quadric);
    pmesh_release(a, p->tail, n * enc_joint_tail(p->active), sizeof *p->tail);
    pmesh_release(a, p->memory, n, sizeof *p->memory);
    pmesh_release(a, p->wedge, n, sizeof *p->wedge);
    pmesh_release(a, p->fate, n, sizeof *p->fate);
    pmesh_release(a, p->choice, n, sizeof *p->choice);
    pmesh_release(a, p->stamp, n, sizeof *p->stamp);
    pmesh_release(a, p->next, n * values, sizeof *p->next);
    *p = (enc_lod_pricer){ 0 };
}

static size_t stride(const enc_lod_pricer *p)
{
    return p->active + p->passive;
}

static const double *value_of(const enc_lod_pricer *p, uint32_t wedge)
{
    return &p->value[wedge * stride(p)];
}

static double *tail_of(const enc_lod_pricer *p, uint32_t wedge)
{
    return &p->tail[wedge * enc_joint_tail(p->active)];
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

/* ---- quadrics of the current surface ------------------------------------- */

static void add_corner(const enc_lod_pricer *p, uint32_t c)
{
    const enc_lod *lod = p->lod;
    const uint32_t corner[3] = { c, enc_lod_after(c), enc_lod_before(c) };
    const double *at = lod->position[lod->corner_vertex[c]];
    const uint32_t wedge = lod->corner_wedge[c];
    double place[2][3], value[2][ENC_JOINT_MAX];

    for (int k = 0; k < 2; k++) {
        const uint32_t other = corner[k + 1];
        const double *v = value_of(p, lod->corner_wedge[other]);
        difference(lod->position[lod->corner_vertex[other]], at, place[k]);
        for (unsigned i = 0; i < p->active; i++)
            value[k][i] = v[i] - value_of(p, wedge)[i];
    }
    enc_joint_add_face(&p->quadric[wedge], tail_of(p, wedge), p->active,
                       place[0], value[0], place[1], value[1]);
}

/* The plane through the edge from corner c to `far` that stands upright on its
 * face, if the edge is a line to be held. */
static void hold_edge(const enc_lod_pricer *p, uint32_t c, uint32_t far)
{
    const enc_lod *lod = p->lod;
    const enc_lod_mark *m = &lod->mark[lod->corner_vertex[far]];
    const double weight = m->faces == 1                 ? p->options->boundary
                          : m->breaks || m->faces != 2 ? p->options->seam
                                                        : 0;
    const double *from = lod->position[lod->corner_vertex[c]];
    double along[3], n[3];

    if (!(weight > 0))
        return;
    difference(lod->position[lod->corner_vertex[far]], from, along);
    enc_lod_normal(lod, c, from, n);
    const double upright[3] = { along[1] * n[2] - along[2] * n[1],
                                along[2] * n[0] - along[0] * n[2],
                                along[0] * n[1] - along[1] * n[0] };
    if (dot(upright, upright) > 0)
        enc_quadric_add_plane(&p->quadric[lod->corner_wedge[c]], upright,
                              weight * dot(along, along));
}

void enc_lod_pricer_renew(enc_lod_pricer *p, uint32_t v)
{
    enc_lod *lod = p->lod;
    uint32_t c = lod->first_corner[v];

    enc_lod_survey(lod, v);
    do {
        const uint32_t wedge = lod->corner_wedge[c];
        p->quadric[wedge] = (enc_quadric){ .c = 0 };
        if (p->active)
            memset(tail_of(p, wedge), 0,
                   enc_joint_tail(p->active) * sizeof *p->tail);
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    do {
        add_corner(p, c);
        if (lod->lines[v]) {
            hold_edge(p, c, enc_lod_after(c));
            hold_edge(p, c, enc_lod_before(c));
        }
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
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
        if (square > 0)
            enc_quadric_add_plane(&p->memory[v], n,
                                  sqrt(0.5 * sqrt(square)));
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

/* ---- which wedges become one --------------------------------------------- */

static void see_wedge(enc_lod_pricer *p, uint32_t wedge)
{
    if (p->stamp[wedge] == p->now)
        return;
    p->stamp[wedge] = p->now;
    p->fate[wedge] = wedge;
    p->wedge[p->wedge_count++] = wedge;
}

static void see_all(enc_lod_pricer *p, uint32_t v)
{
    const enc_lod *lod = p->lod;
    uint32_t c = lod->first_corner[v];

    if (lod->lone[v] != ENC_NONE) {
        see_wedge(p, lod->lone[v]);
        return;
    }
    do
        see_wedge(p, lod->corner_wedge[c]);
    while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

static uint32_t find(const enc_lod_pricer *p, uint32_t wedge)
{
    while (p->fate[wedge] != wedge)
        wedge = p->fate[wedge];
    return wedge;
}

/* Lists the wedges at both ends, those of `kept` first, and joins those that
 * belong together: their fate is one of `kept` if there is one. */
static void gather(enc_lod_pricer *p, uint32_t gone, uint32_t kept)
{
    const enc_lod *lod = p->lod;
    const uint32_t single = lod->lone[gone];
    uint32_t c = lod->first_corner[gone];

    if (++p->now == 0) {
        memset(p->stamp, 0, lod->vertex_count * sizeof *p->stamp);
        p->now = 1;
    }
    p->wedge_count = 0;
    see_all(p, kept);
    p->kept_count = p->wedge_count;
    see_all(p, gone);
    if (single != ENC_NONE && lod->lone[kept] != ENC_NONE) {
        p->fate[single] = lod->lone[kept];
        return;
    }
    do {
        const uint32_t d = enc_lod_corner_of(lod, c, kept);
        if (d == ENC_NONE)
            continue;
        const uint32_t a = find(p, lod->corner_wedge[c]);
        const uint32_t b = find(p, lod->corner_wedge[d]);
        p->fate[a] = b;
    } while ((c = lod->corner_next[c]) != lod->first_corner[gone]);
    for (uint32_t i = 0; i < p->wedge_count; i++)
        p->fate[p->wedge[i]] = find(p, p->wedge[i]);
}

/* ---- one place for both ends --------------------------------------------- */

/* The ends as seen from the middle between them. */
typedef struct enc_lod_edge {
    double middle[3], half[3]; /* the latter leads to the end that goes */
    uint32_t gone, kept;
} enc_lod_edge;

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

/* Both ends' quadrics of the wedges whose fate is `fate`, about the middle of
 * the edge and the mean of their values, which goes to `center`. */
static void sum_group(const enc_lod_pricer *p, const enc_lod_edge *e,
                      uint32_t fate, enc_quadric *q, double *tail,
                      double *center)
{
    const double back[3] = { -e->half[0], -e->half[1], -e->half[2] };
    unsigned count = 0;

    *q = (enc_quadric){ .c = 0 };
    memset(tail, 0, enc_joint_tail(p->active) * sizeof *tail);
    for (unsigned i = 0; i < p->active; i++)
        center[i] = 0;
    for (uint32_t w = 0; w < p->wedge_count && p->active; w++) {
        if (p->fate[p->wedge[w]] != fate)
            continue;
        count++;
        for (unsigned i = 0; i < p->active; i++)
            center[i] += value_of(p, p->wedge[w])[i];
    }
    for (unsigned i = 0; i < p->active; i++)
        center[i] /= count;
    for (uint32_t w = 0; w < p->wedge_count; w++) {
        const uint32_t wedge = p->wedge[w];
        double away[ENC_JOINT_MAX];
        if (p->fate[wedge] != fate)
            continue;
        for (unsigned i = 0; i < p->active; i++)
            away[i] = value_of(p, wedge)[i] - center[i];
        enc_joint_add(q, tail, &p->quadric[wedge], tail_of(p, wedge), p->active,
                      w < p->kept_count ? back : e->half, away);
    }
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
}

/* All wedges together, as a quadric of the place alone. */
static void sum_all(const enc_lod_pricer *p, const enc_lod_edge *e,
                    enc_quadric *total)
{
    *total = (enc_quadric){ .c = 0 };
    for (uint32_t w = 0; w < p->wedge_count; w++) {
        double tail[ENC_JOINT_TAIL_MAX], center[ENC_JOINT_MAX];
        const double none[3] = { 0, 0, 0 };
        enc_joint_solver solver;
        enc_quadric q;
        if (p->fate[p->wedge[w]] != p->wedge[w])
            continue;
        sum_group(p, e, p->wedge[w], &q, tail, center);
        enc_joint_reduce(&q, tail, p->active, &solver);
        enc_quadric_add(total, &q, none);
    }
}

/* How far from `kept` to `gone` the place is, 0 to 1. */
static double share_of_gone(const enc_lod_edge *e, const double x[3])
{
    const double square = dot(e->half, e->half);
    const double t = square > 0 ? 0.5 + 0.5 * dot(x, e->half) / square : 0.5;

    return t < 0 ? 0 : t > 1 ? 1 : t;
}

static void interpolate(const enc_lod_pricer *p, const enc_lod_edge *e,
                        uint32_t fate, const double x[3], double *out)
{
    const double t = share_of_gone(e, x);
    double sum[2][ENC_JOINT_MAX] = { { 0 } };
    unsigned count[2] = { 0, 0 };

    for (uint32_t w = 0; w < p->wedge_count; w++) {
        const bool from_gone = w >= p->kept_count;
        if (p->fate[p->wedge[w]] != fate)
            continue;
        count[from_gone]++;
        for (unsigned i = 0; i < p->passive; i++)
            sum[from_gone][i] += value_of(p, p->wedge[w])[p->active + i];
    }
    const double share = count[0] == 0 ? 1 : count[1] == 0 ? 0 : t;
    for (unsigned i = 0; i < p->passive; i++) {
        out[i] = 0;
        if (count[0] > 0)
            out[i] += (1 - share) * sum[0][i] / count[0];
        if (count[1] > 0)
            out[i] += share * sum[1][i] / count[1];
    }
}

/* The values of all fates at x. */
static void solve_values(enc_lod_pricer *p, const enc_lod_edge *e,
                         const double x[3])
{
    for (uint32_t w = 0; w < p->wedge_count; w++) {
        const uint32_t fate = p->wedge[w];
        double tail[ENC_JOINT_TAIL_MAX], center[ENC_JOINT_MAX];
        double *next = &p->next[fate * stride(p)];
        enc_joint_solver solver;
        enc_quadric q;
        if (p->fate[fate] != fate)
            continue;
        if (p->active) {
            sum_group(p, e, fate, &q, tail, center);
            enc_joint_reduce(&q, tail, p->active, &solver);
            enc_joint_attributes(&solver, p->active, x, next);
            for (unsigned i = 0; i < p->active; i++)
                next[i] += center[i];
        }
        if (p->passive)
            interpolate(p, e, fate, x, next + p->active);
        enc_lod_channels_tidy(&p->channels, next);
    }
}

/* Faces around both ends, each once, move through volume n'x. */
static bool volume_plane(const enc_lod_pricer *p, const enc_lod_edge *e,
                         enc_plane *keep)
{
    const enc_lod *lod = p->lod;

    *keep = (enc_plane){ { 0, 0, 0 }, 0 };
    if ((lod->lines[e->gone] | lod->lines[e->kept]) & ENC_LOD_RIM)
        return false;
    for (int side = 0; side < 2; side++) {
        const uint32_t v = side ? e->kept : e->gone;
        const double sign = side ? -1 : 1;
        uint32_t c = lod->first_corner[v];
        do {
            double n[3];
            if (side && enc_lod_corner_of(lod, c, e->gone) != ENC_NONE)
                continue;
            enc_lod_normal(lod, c, lod->position[v], n);
            for (int i = 0; i < 3; i++)
                keep->n[i] += n[i];
            keep->offset += sign * dot(n, e->half);
        } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    }
    return true;
}

/* ---- onto one of the ends ------------------------------------------------ */

/* Which wedge at the other end suits `wedge` best, of those that it belongs to
 * or of all; infinite if there is none. */
static double best_choice(enc_lod_pricer *p, uint32_t wedge,
                          const double way[3], bool any)
{
    double best = INFINITY;

    for (uint32_t w = 0; w < p->kept_count; w++) {
        const uint32_t to = p->wedge[w];
        double away[ENC_JOINT_MAX];
        if (!any && p->fate[to] != p->fate[wedge])
            continue;
        for (unsigned i = 0; i < p->active; i++)
            away[i] = value_of(p, to)[i] - value_of(p, wedge)[i];
        const double value =
            enc_joint_value(&p->quadric[wedge], tail_of(p, wedge), p->active,
                            way, away);
        if (value < best) {
            best = value;
            p->choice[wedge] = to;
        }
    }
    return best;
}

/*
 * The value of letting `gone` go to `kept`, and the choices: a wedge that goes
 * takes on the best of the wedges at `kept` that it belongs to. Where there is
 * none it is infinite, or any will do.
 */
static double onto_kept(enc_lod_pricer *p, const enc_lod_edge *e)
{
    const double way[3] = { -2 * e->half[0], -2 * e->half[1], -2 * e->half[2] };
    double sum = 0;

    for (uint32_t w = 0; w < p->kept_count; w++)
        sum += p->quadric[p->wedge[w]].c;
    for (uint32_t w = p->kept_count; w < p->wedge_count; w++) {
        double best = best_choice(p, p->wedge[w], way, false);
        if (p->break_seams && !(best < INFINITY))
            best = best_choice(p, p->wedge[w], way, true);
        sum += best;
    }
    return sum;
}

static void choose(enc_lod_pricer *p)
{
    for (uint32_t w = 0; w < p->wedge_count; w++) {
        const uint32_t wedge = p->wedge[w];
        p->fate[wedge] = w < p->kept_count ? wedge : p->choice[wedge];
        memcpy(&p->next[wedge * stride(p)], value_of(p, wedge),
               stride(p) * sizeof *p->next);
    }
}

/* ---- costs --------------------------------------------------------------- */

static void to_model(const enc_lod_pricer *p, const double x[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = p->frame.origin[i] + p->frame.extent * x[i];
}

static double camera_distance(const enc_lod_pricer *p, const double x[3])
{
    double at[3], d[3];

    to_model(p, x, at);
    difference(at, p->options->camera, d);
    const double far = sqrt(dot(d, d)), least = 1e-6 * p->frame.extent;
    return far > least ? far : least;
}

static double ask_hook(const enc_lod_pricer *p, const enc_lod_edge *e,
                       const double at[3], double value, double distance)
{
    const double extent = p->frame.extent, square = extent * extent;
    double ends[2][3];
    pmesh_simplify_pair pair = {
        .vertices = { e->kept, e->gone },
        .positions = { ends[0], ends[1] },
        .quadric = value * square * square,
        .distance = sqrt(distance) * extent,
    };

    to_model(p, p->lod->position[e->kept], ends[0]);
    to_model(p, p->lod->position[e->gone], ends[1]);
    to_model(p, at, pair.place);
    const double cost = p->options->hook(p->options->user, &pair);
    return cost >= 0 ? cost : INFINITY;
}

/* x: relative to the middle. */
static double cost_of(const enc_lod_pricer *p, const enc_lod_edge *e,
                      const double x[3], double value, double distance)
{
    const double square = dot(e->half, e->half), half = sqrt(square);
    const double tie = LENGTH_TIE * 16 * square * square;
    const double at[3] = { e->middle[0] + x[0], e->middle[1] + x[1],
                           e->middle[2] + x[2] };

    if (!(value < INFINITY))
        return INFINITY;
    switch (p->options->cost) {
    case PMESH_COST_LENGTH:
        return half * p->frame.extent;
    case PMESH_COST_CAMERA:
        return half * p->frame.extent /
               (CAMERA_FACTOR * camera_distance(p, e->middle));
    case PMESH_COST_QUADRIC_CAMERA: {
        const double far = camera_distance(p, at) / p->frame.extent;
        return (value + tie) / (far * far * far * far);
    }
    case PMESH_COST_CUSTOM:
        return ask_hook(p, e, at, value, distance);
    case PMESH_COST_QUADRIC:
        break;
    }
    return value + tie;
}

/* The offer of letting `gone` go; with values only if it is to be taken. */
static enc_lod_offer make_offer(enc_lod_pricer *p, uint32_t gone, uint32_t kept,
                                bool full)
{
    const enc_lod_edge e = edge_between(p->lod, gone, kept);
    enc_lod_offer offer = { .gone = gone, .kept = kept };
    double x[3] = { -e.half[0], -e.half[1], -e.half[2] };
    enc_quadric memory;

    gather(p, gone, kept);
    sum_memory(p, &e, &memory);
    if (p->placement == PMESH_PLACE_ENDPOINT) {
        offer.quadric =
            onto_kept(p, &e) + p->recall * enc_quadric_value(&memory, x);
        memcpy(offer.place, p->lod->position[kept], sizeof offer.place);
        if (full && offer.quadric < INFINITY)
            choose(p);
    } else {
        enc_quadric total;
        enc_plane keep;
        sum_all(p, &e, &total);
        add_recalled(p, &memory, &total);
        const bool held = p->placement == PMESH_PLACE_OPTIMAL &&
                          volume_plane(p, &e, &keep);
        enc_lod_place(p->placement, &total, e.half, held ? &keep : NULL, x);
        offer.quadric = enc_quadric_value(&total, x);
        for (int i = 0; i < 3; i++)
            offer.place[i] = e.middle[i] + x[i];
        if (full && stride(p) > 0)
            solve_values(p, &e, x);
    }
    if (memory.weight > 0)
        offer.distance = enc_quadric_value(&memory, x) / memory.weight;
    offer.cost = cost_of(p, &e, x, offer.quadric, offer.distance);
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

/* ---- contraction --------------------------------------------------------- */

/* The sum of the quadrics of one fate, about its new place and values. */
static void carry_over(enc_lod_pricer *p, const enc_lod_offer *offer,
                       uint32_t fate, enc_quadric *q, double *tail)
{
    const double *to = &p->next[fate * stride(p)];

    *q = (enc_quadric){ .c = 0 };
    memset(tail, 0, enc_joint_tail(p->active) * sizeof *tail);
    for (uint32_t w = 0; w < p->wedge_count; w++) {
        const uint32_t wedge = p->wedge[w];
        const uint32_t v = w < p->kept_count ? offer->kept : offer->gone;
        double way[3], away[ENC_JOINT_MAX];
        if (p->fate[wedge] != fate)
            continue;
        difference(p->lod->position[v], offer->place, way);
        for (unsigned i = 0; i < p->active; i++)
            away[i] = value_of(p, wedge)[i] - to[i];
        enc_joint_add(q, tail, &p->quadric[wedge], tail_of(p, wedge), p->active,
                      way, away);
    }
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

void enc_lod_pricer_move(enc_lod_pricer *p, const enc_lod_offer *offer)
{
    carry_memory(p, offer);
    for (uint32_t w = 0; w < p->wedge_count; w++) {
        const uint32_t wedge = p->wedge[w];
        double tail[ENC_JOINT_TAIL_MAX];
        enc_quadric q;
        if (p->fate[wedge] != wedge)
            continue;
        carry_over(p, offer, wedge, &q, tail);
        p->quadric[wedge] = q;
        memcpy(tail_of(p, wedge), tail,
               enc_joint_tail(p->active) * sizeof *tail);
    }
    for (uint32_t w = 0; w < p->wedge_count; w++)
        if (p->fate[p->wedge[w]] == p->wedge[w])
            memcpy(&p->value[p->wedge[w] * stride(p)],
                   &p->next[p->wedge[w] * stride(p)],
                   stride(p) * sizeof *p->value);
    memcpy(p->lod->position[offer->kept], offer->place, sizeof offer->place);
}

void enc_lod_pricer_settle(enc_lod_pricer *p, const enc_lod_offer *offer)
{
    enc_lod *lod = p->lod;
    uint32_t c = lod->first_corner[offer->kept];

    if (c == ENC_NONE)
        return;
    do
        lod->corner_wedge[c] = p->fate[lod->corner_wedge[c]];
    while ((c = lod->corner_next[c]) != lod->first_corner[offer->kept]);
}
