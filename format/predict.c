/* SPDX-License-Identifier: MIT */
#include "format/predict.h"

#include <string.h>

#include "format/star.h"

enum {
    FRACTION_BITS = 4,
    WEIGHT_BITS = 16,
    TERM_LIMIT = 1 << 14, /* four times what a ring can span */
    SUM_LIMIT = 1 << 22,
    FIT_DROP = 1 /* bits of terms that learning does without */
};

static int64_t limited(int64_t value, int64_t limit)
{
    return value < -limit ? -limit : value > limit ? limit : value;
}

static int32_t within(int32_t value, int32_t limit)
{
    return value < -limit ? -limit : value > limit ? limit : value;
}

/* x 2^shift within SUM_LIMIT; shift <= PMESH_STAR_BITS. */
static int32_t scaled(int32_t value, int shift)
{
    if (shift < 0)
        return within(value >> -shift, SUM_LIMIT);
    return within(value, SUM_LIMIT >> shift) * (1 << shift);
}

static uint32_t index_of(const pmesh_ring *ring, uint32_t vertex)
{
    uint32_t i = 0;
    while (i + 1 < ring->count && ring->vertex[i] != vertex)
        i++;
    return i;
}

/* ---- terms, from the ring's mean ---------------------------------------- */

/* Mean over the ring of (mean of a member's other neighbours - member): how
 * the surface bends around here. Sums of positions relative to `base` fit 32
 * bits. */
static void bend(const pmesh_codec *c, const pmesh_star *s,
                 const pmesh_ring *ring, uint32_t x, const int32_t base[3],
                 int32_t out[3])
{
    const int32_t *at = c->mesh.position[x];
    int32_t sum[3] = { 0, 0, 0 };
    uint32_t used = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t y = ring->vertex[i], others = c->degree[y] - 1;
        if (others < 2 || others >= PMESH_MAX_RING)
            continue;
        for (int k = 0; k < 3; k++) {
            const uint32_t all =
                c->around[y][k] - (uint32_t)at[k] - others * (uint32_t)base[k];
            sum[k] += pmesh_share(scaled((int32_t)all, s->shift), others) -
                      s->point[k][i];
        }
        used++;
    }
    for (int k = 0; k < 3; k++)
        out[k] = used ? pmesh_share(sum[k], used) : 0;
}

/* Straight on from the member behind half-edge h, away from where h starts:
 * twice the member less what lies opposite in its ring. */
static void straight_on(const pmesh_codec *c, const pmesh_star *s, uint32_t h,
                        const int32_t base[3], int32_t out[3])
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t y = m->vertex[pmesh_next(h)], n = c->degree[y];
    uint32_t back = m->twin[h], far[2] = { 0, 0 };
    if (n > PMESH_MAX_RING || back == PMESH_NONE)
        return;
    for (uint32_t i = 0; i < (n + 1) / 2; i++) {
        far[0] = m->vertex[pmesh_next(back)];
        back = pmesh_turn_left(m, back);
        if (back == PMESH_NONE)
            return;
    }
    far[1] = m->vertex[pmesh_next(back)];
    if (n % 2 == 0)
        far[0] = far[1];
    for (int k = 0; k < 3; k++) {
        const int32_t twice = 4 * m->position[y][k] - m->position[far[0]][k] -
                              m->position[far[1]][k] - 2 * base[k];
        out[k] = (scaled(twice, s->shift) >> 1) - s->mean[k];
    }
}

static void make_terms(const pmesh_codec *c, const pmesh_star *s,
                       const pmesh_ring *ring, uint32_t x, uint32_t partner,
                       pmesh_prediction *p)
{
    const uint32_t n = s->count, at = index_of(ring, partner);
    const uint32_t half = at + n / 2, half2 = at + (n + 1) / 2;
    const uint32_t far = half < n ? half : half - n;
    const uint32_t far2 = half2 < n ? half2 : half2 - n;
    /* Of an open ring the ends say more than what lies opposite. */
    const uint32_t a = s->open ? 0 : far, b = s->open ? n - 1 : far2;
    for (int k = 0; k < 3; k++) {
        const int16_t *point = s->point[k];
        p->term[0][k] = -s->mean[k]; /* the partner is the base point */
        p->term[1][k] = ((point[a] + point[b]) >> 1) - s->mean[k];
    }
    bend(c, s, ring, x, p->base, p->term[2]);
    pmesh_star_centres(s, p->term[3], p->term[4]);
    memset(p->term[5], 0, 2 * sizeof p->term[5]);
    if (at < ring->face_count)
        straight_on(c, s, ring->edge[at], p->base, p->term[5]);
    if (far < ring->face_count)
        straight_on(c, s, ring->edge[far], p->base, p->term[6]);

    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        int32_t height = 0;
        for (int k = 0; k < 3; k++) {
            p->term[t][k] = within(p->term[t][k], TERM_LIMIT);
            height += p->term[t][k] * s->normal[k];
        }
        p->height[t] = height >> PMESH_NORMAL_BITS;
    }
}

/* ---- prediction --------------------------------------------------------- */

/* A ring beyond the bound: splits of its neighbours made it so large. */
static void predict_blindly(const int32_t at[3], pmesh_prediction *out)
{
    *out = (pmesh_prediction){ .size = 64 << FRACTION_BITS,
                               .ring_class = 7,
                               .unknown = 2,
                               .irregular = PMESH_IRREGULAR - 1,
                               .rough = PMESH_ROUGH - 1 };
    for (int k = 0; k < 3; k++)
        out->position[k] = (int64_t)at[k] * (1 << FRACTION_BITS);
}

static uint8_t ring_class(const pmesh_ring *ring)
{
    if (ring->open)
        return PMESH_PREDICT_CLASSES - 1;
    const uint32_t n = ring->count < 3 ? 3 : ring->count;
    return (uint8_t)(n < 10 ? n - 3 : 7);
}

/* Two classes an octave of height against size, from 1/256 on. */
static uint8_t roughness(const pmesh_star *s)
{
    const uint32_t part = 256 * (uint32_t)s->height / (uint32_t)(s->size + 1);
    const unsigned bits = pmesh_bit_length((uint64_t)part * part);
    return (uint8_t)(bits < PMESH_ROUGH ? bits : PMESH_ROUGH - 1);
}

/* The contexts: what is known of the ring's members. */
static void classify(const pmesh_codec *c, const pmesh_star *s,
                     const pmesh_ring *ring, uint32_t partner,
                     uint32_t provisional, pmesh_prediction *p)
{
    uint32_t unknown = 0, irregular = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t y = ring->vertex[i];
        irregular += c->degree[y] != 6;
        unknown += y >= provisional && y != partner;
    }
    p->ring_class = ring_class(ring);
    p->unknown = (uint8_t)(unknown < 2 ? unknown : 2);
    p->irregular = (uint8_t)(irregular < PMESH_IRREGULAR ? irregular
                                                         : PMESH_IRREGULAR - 1);
    p->rough = roughness(s);
    const int64_t size = pmesh_scale(s->size, FRACTION_BITS - s->shift);
    p->size = size < 16 ? 16 : (uint32_t)size;
    p->shift = s->shift;
    for (int k = 0; k < 3; k++) {
        p->normal[k] = s->normal[k];
        p->mean[k] = s->mean[k];
    }
}

/* The mean and the weighted terms, within the bounds, as every vertex is. */
static void add_terms(pmesh_prediction *p, const int32_t bounds[3])
{
    const int32_t *along = p->fit[0].weight, *across = p->fit[1].weight;
    int64_t sum[3] = { 0, 0, 0 }, height = 0;
    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        for (int k = 0; k < 3; k++)
            sum[k] += (int64_t)along[t] * p->term[t][k];
        height += (int64_t)(across[t] - along[t]) * p->height[t];
    }
    for (int k = 0; k < 3; k++) {
        const int64_t by =
            (sum[k] + (height * p->normal[k] >> PMESH_NORMAL_BITS)) >>
            WEIGHT_BITS;
        p->corrected[k] = p->mean[k] + (int32_t)by;
        const int64_t x =
            (int64_t)p->base[k] * (1 << FRACTION_BITS) +
            pmesh_scale(p->corrected[k], FRACTION_BITS - p->shift);
        const int64_t limit = (int64_t)bounds[k] << FRACTION_BITS;
        p->position[k] = x < 0 ? 0 : x > limit ? limit : x;
    }
}

void pmesh_predict(pmesh_codec *c, pmesh_predict_kind kind, uint32_t x,
                   const pmesh_ring *ring, uint32_t partner,
                   const int32_t partner_position[3], uint32_t provisional,
                   pmesh_prediction *out)
{
    pmesh_star s;
    if (!ring) {
        predict_blindly(partner_position, out);
        return;
    }
    pmesh_star_make(&s, c, ring, partner_position);
    memcpy(out->base, partner_position, sizeof out->base);
    classify(c, &s, ring, partner, provisional, out);
    make_terms(c, &s, ring, x, partner, out);
    out->fit = c->models.predict[kind][out->ring_class][out->unknown];
    add_terms(out, c->bounds);
}

/* ---- learning ----------------------------------------------------------- */

enum {
    LARGEST_WEIGHT = 1 << 18,
    /* What a sample counts: 2^26 / (squares of expected and actual error). */
    WEIGHT_SCALE = 1 << 26
};

#define PULL_ALONG  ((int64_t)1 << 24)
#define PULL_ACROSS ((int64_t)1 << 27)

static int32_t sample_weight(int64_t square)
{
    const int64_t w = WEIGHT_SCALE / (square + 1);
    return (int32_t)(w < LARGEST_WEIGHT ? w : LARGEST_WEIGHT);
}

/* An expected error in the units of learning, squared. */
static int64_t expected_square(const pmesh_prediction *p, uint32_t error)
{
    const int64_t e = limited(
        pmesh_scale(error, p->shift - FRACTION_BITS - FIT_DROP), TERM_LIMIT);
    return e * e;
}

static void split_terms(const pmesh_prediction *p,
                        int32_t along[PMESH_FIT_TERMS][3],
                        int32_t across[PMESH_FIT_TERMS])
{
    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        across[t] = (int32_t)(p->height[t] >> FIT_DROP);
        for (int k = 0; k < 3; k++)
            along[t][k] =
                (int32_t)((p->term[t][k] - (p->height[t] * p->normal[k] >>
                                            PMESH_NORMAL_BITS)) >>
                          FIT_DROP);
    }
}

static void learn_along(const pmesh_prediction *p,
                        int32_t f[PMESH_FIT_TERMS][3], const int32_t target[3],
                        int32_t weight)
{
    pmesh_sample s;
    int32_t *pair = s.pair;
    for (int i = 0; i < PMESH_FIT_TERMS; i++) {
        const int32_t *a = f[i];
        for (int j = 0; j <= i; j++)
            *pair++ = a[0] * f[j][0] + a[1] * f[j][1] + a[2] * f[j][2];
        s.target[i] = a[0] * target[0] + a[1] * target[1] + a[2] * target[2];
    }
    pmesh_fit_learn(&p->fit[0], &s, weight, PULL_ALONG);
}

static void learn_across(const pmesh_prediction *p,
                         const int32_t f[PMESH_FIT_TERMS], int32_t target,
                         int32_t weight)
{
    pmesh_sample s;
    int32_t *pair = s.pair;
    for (int i = 0; i < PMESH_FIT_TERMS; i++) {
        for (int j = 0; j <= i; j++)
            *pair++ = f[i] * f[j];
        s.target[i] = f[i] * target;
    }
    pmesh_fit_learn(&p->fit[1], &s, weight, PULL_ACROSS);
}

void pmesh_predict_learn(const pmesh_prediction *p, const int32_t position[3],
                         uint32_t along, uint32_t across)
{
    int32_t f[PMESH_FIT_TERMS][3], h[PMESH_FIT_TERMS], target[3];
    int64_t wanted[3], up = 0, error_up = 0, error = 0;
    if (!p->fit)
        return;
    for (int k = 0; k < 3; k++) {
        const int64_t to =
            pmesh_scale((int64_t)position[k] - p->base[k], p->shift);
        const int64_t off = limited(to - p->corrected[k], TERM_LIMIT);
        wanted[k] = limited(to - p->mean[k], TERM_LIMIT);
        up += wanted[k] * p->normal[k];
        error_up += off * p->normal[k];
        error += off * off;
    }
    up >>= PMESH_NORMAL_BITS;
    error_up >>= PMESH_NORMAL_BITS;
    const int64_t square_up = error_up * error_up >> 2 * FIT_DROP;
    const int64_t square_flat =
        limited((error >> 2 * FIT_DROP) - square_up, INT32_MAX);
    for (int k = 0; k < 3; k++)
        target[k] =
            (int32_t)((wanted[k] - (up * p->normal[k] >> PMESH_NORMAL_BITS)) >>
                      FIT_DROP);
    split_terms(p, f, h);
    learn_along(p, f, target,
                sample_weight(expected_square(p, along) +
                              (square_flat > 0 ? square_flat : 0)));
    learn_across(p, h, (int32_t)(up >> FIT_DROP),
                 sample_weight(expected_square(p, across) / 2 + square_up));
}

/* For rings of any size. */
static void shift_ring(pmesh_codec *c, uint32_t start, const uint32_t by[3])
{
    const pmesh_mesh *m = &c->mesh;
    uint32_t h = start, last;
    do {
        last = pmesh_prev(h);
        for (int k = 0; k < 3; k++)
            c->around[m->vertex[pmesh_next(h)]][k] += by[k];
        h = m->twin[last];
    } while (h != PMESH_NONE && h != start);
    for (int k = 0; k < 3 && h == PMESH_NONE; k++)
        c->around[m->vertex[last]][k] += by[k];
}

static void shift_neighbours(pmesh_codec *c, uint32_t x, const uint32_t by[3])
{
    const pmesh_mesh *m = &c->mesh;
    for (uint32_t fan = m->first[x]; fan != PMESH_NONE;
         fan = m->fan ? m->fan[fan] : PMESH_NONE)
        shift_ring(c, fan, by);
}

void pmesh_place(pmesh_codec *c, uint32_t x, const pmesh_ring *ring,
                 const int32_t position[3])
{
    int32_t *at = c->mesh.position[x];
    uint32_t by[3];
    for (int k = 0; k < 3; k++)
        by[k] = (uint32_t)position[k] - (uint32_t)at[k];
    if (!(by[0] | by[1] | by[2]))
        return;
    memcpy(at, position, sizeof *c->mesh.position);
    if (!ring || c->mesh.fan) {
        shift_neighbours(c, x, by);
        return;
    }
    for (uint32_t i = 0; i < ring->count; i++)
        for (int k = 0; k < 3; k++)
            c->around[ring->vertex[i]][k] += by[k];
}
