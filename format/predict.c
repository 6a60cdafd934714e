/* SPDX-License-Identifier: MIT */
#include "format/predict.h"

#include <string.h>

#include "format/lanes.h"
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

/* The factor 2^shift within SUM_LIMIT; shift <= PMESH_STAR_BITS. */
typedef struct scale {
    int up, down;
    int32_t limit;
} scale;

static scale make_scale(int shift)
{
    const int up = shift > 0 ? shift : 0;
    return (scale){ up, up - shift, SUM_LIMIT >> up };
}

static inline quads scaled(const scale *by, quads x)
{
    const quads limit = quads_of(by->limit), low = quads_of(-by->limit);
    x = quads_min(quads_max(quads_right(x, by->down), low), limit);
    return quads_left(x, by->up);
}

/* ---- guesses ------------------------------------------------------------ */

/* If its parent stays, the mean of the ring, moved against the way that the
 * surface bends around it: by 5/8 of the mean difference between its members'
 * other neighbours and themselves. If both part, it lies close to where the
 * parent was. Sums are modulo 2^32. */
void pmesh_guess(const pmesh_codec *c, uint32_t x, const pmesh_ring *ring,
                 int32_t position[3])
{
    const int32_t(*at)[3] = (const int32_t(*)[3])c->mesh.position;
    const int32_t *parent = at[c->mesh.parent[x]];
    const quads here = quads_triple(at[x]);
    quads sum = quads_of(0), bend = quads_of(0);
    int32_t sums[QUADS], bends[QUADS];
    uint32_t count = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const pmesh_near *near = &c->near[ring->vertex[i]];
        const quads member = quads_triple(at[ring->vertex[i]]);
        const uint32_t others = near->degree - 1;
        sum = quads_add(sum, member);
        if (others >= PMESH_MAX_RING)
            continue;
        const quads around = quads_sub(pmesh_near_load(near), here);
        bend = quads_add(bend, quads_sub(around, quads_times(member, others)));
        count += others;
    }
    quads_store(sums, sum);
    quads_store(bends, bend);
    const int64_t by = count ? ((int64_t)5 << 29) / count : 0;
    for (int k = 0; k < 3; k++) {
        const int64_t mean = sums[k] * pmesh_reciprocal[ring->count];
        const int64_t there = parent[k] * ((int64_t)1 << 32);
        const int64_t to = c->sizes.moves ? (mean + 3 * there) >> 2
                                          : mean - bends[k] * by;
        const int64_t p = (to + ((int64_t)1 << 31)) >> 32;
        position[k] = (int32_t)(p < 0               ? 0
                                : p > c->bounds[k] ? c->bounds[k]
                                                   : p);
    }
}

/* ---- terms, from the ring's mean ---------------------------------------- */

/* Member `steps` places behind the partner. */
static uint32_t behind_partner(const pmesh_site *s, uint32_t steps)
{
    const uint32_t i = s->partner + steps, n = s->ring.count;
    return i < n ? i : i - n;
}

/* What a walk over the ring's members tells. */
typedef struct walk {
    uint32_t unknown, irregular;
    /* Mean over the ring of (mean of a member's other neighbours - member): how
     * the surface bends around here. */
    int32_t bend[QUADS];
} walk;

/* Sums of positions relative to `base` fit 32 bits. */
static void walk_ring(const pmesh_codec *c, const pmesh_star *s,
                      const scale *by, const pmesh_ring *ring, uint32_t x,
                      const int32_t base[3], uint32_t provisional, walk *w)
{
    const quads at = quads_triple(c->mesh.position[x]);
    const quads from = quads_triple(base);
    quads sum = quads_of(0);
    int32_t total[QUADS];
    uint32_t used = 0, unknown = 0, irregular = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t y = ring->vertex[i];
        const pmesh_near *near = &c->near[y];
        const uint32_t others = near->degree - 1;
        irregular += near->degree != 6;
        unknown += y >= provisional;
        if (others < 2 || others >= PMESH_MAX_RING)
            continue;
        const quads all = quads_sub(pmesh_near_load(near),
                                    quads_add(at, quads_times(from, others)));
        const quads share = quads_high(scaled(by, all),
                                       (uint32_t)pmesh_reciprocal[others]);
        sum = quads_add(sum, quads_sub(share, s->row[i]));
        used++;
    }
    quads_store(total, sum);
    w->unknown = unknown;
    w->irregular = irregular;
    for (int k = 0; k < QUADS; k++)
        w->bend[k] = used ? pmesh_share(total[k], used) : 0;
}

/* Straight on over member y: twice the member less what lies beyond. */
static quads straight_on(const pmesh_codec *c, const scale *by, uint32_t y,
                         const uint32_t beyond[2], quads base, quads mean)
{
    const int32_t(*at)[3] = (const int32_t(*)[3])c->mesh.position;
    if (beyond[0] == PMESH_NONE)
        return quads_of(0);
    const quads far = quads_add(quads_triple(at[beyond[0]]),
                                quads_triple(at[beyond[1]]));
    const quads near = quads_sub(quads_left(quads_triple(at[y]), 2), far);
    const quads twice = quads_sub(near, quads_left(base, 1));
    return quads_sub(quads_right(scaled(by, twice), 1), mean);
}

/* Limits the terms and finds their heights. */
static void finish_terms(const pmesh_star *s, const quads term[LANES],
                         pmesh_prediction *p)
{
    const lanes low = lanes_of(-TERM_LIMIT), high = lanes_of(TERM_LIMIT);
    const lanes none = lanes_of(0);
    lanes t[3], n[3];
    lanes_columns(term, t);
    for (int k = 0; k < 3; k++) {
        t[k] = lanes_min(lanes_max(t[k], low), high);
        n[k] = lanes_of((int16_t)s->normal[k]);
        lanes_store(p->term[k], t[k]);
    }
    const quads first = quads_add(quads_first(t[0], t[1], n[0], n[1]),
                                  quads_first(t[2], none, n[2], none));
    const quads last = quads_add(quads_last(t[0], t[1], n[0], n[1]),
                                 quads_last(t[2], none, n[2], none));
    quads_store(p->height, quads_right(first, PMESH_NORMAL_BITS));
    quads_store(p->height + QUADS, quads_right(last, PMESH_NORMAL_BITS));
}

static void make_terms(const pmesh_codec *c, const pmesh_star *s,
                       const pmesh_site *site, const scale *by, const walk *w,
                       pmesh_prediction *p)
{
    const uint32_t *member = site->ring.vertex;
    const uint32_t n = s->count, far = behind_partner(site, n / 2);
    const uint32_t far2 = behind_partner(site, (n + 1) / 2);
    /* Of an open ring the ends say more than what lies opposite. */
    const uint32_t a = s->open ? 0 : far, b = s->open ? n - 1 : far2;
    const quads mean = quads_triple(s->mean), base = quads_triple(p->base);
    int32_t area[QUADS], spokes[QUADS];
    quads term[LANES];
    pmesh_star_centres(s, area, spokes);
    term[0] = quads_sub(quads_of(0), mean); /* the partner is the base point */
    term[1] = quads_right(quads_add(s->row[a], s->row[b]), 1);
    term[1] = quads_sub(term[1], mean);
    term[2] = quads_load(w->bend);
    term[3] = quads_load(area);
    term[4] = quads_load(spokes);
    term[5] = straight_on(c, by, member[site->partner], site->beyond[0], base,
                          mean);
    term[6] = straight_on(c, by, member[far], site->beyond[1], base, mean);
    term[7] = quads_of(0);
    finish_terms(s, term, p);
}

/* ---- prediction --------------------------------------------------------- */

/* A ring beyond the bound: splits of its neighbours made it so large. */
static void predict_blindly(const int32_t at[3], pmesh_prediction *out)
{
    *out = (pmesh_prediction){ .size = 64 << FRACTION_BITS,
                               .ring_class = 7,
                               .unknown = 2,
                               .irregular = PMESH_IRREGULAR - 1,
                               .rough = PMESH_ROUGH - 1,
                               .blind = true };
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
static void classify(const pmesh_star *s, const pmesh_ring *ring, const walk *w,
                     pmesh_prediction *p)
{
    const uint32_t unknown = w->unknown, irregular = w->irregular;
    p->ring_class = ring_class(ring);
    p->unknown = (uint8_t)(unknown < 2 ? unknown : 2);
    p->irregular = (uint8_t)(irregular < PMESH_IRREGULAR ? irregular
                                                         : PMESH_IRREGULAR - 1);
    p->rough = roughness(s);
    const int64_t size = pmesh_scale(s->size, FRACTION_BITS - s->shift);
    p->size = size < 16 ? 16 : (uint32_t)size;
    p->shift = s->shift;
    p->blind = false;
    for (int k = 0; k < 3; k++) {
        p->normal[k] = s->normal[k];
        p->mean[k] = s->mean[k];
    }
}

/* Sums of weight x term, axis by axis. Weights have 20 bits, of which lanes
 * take the last 12 apart. */
static void add_up(const int32_t weight[LANES], int16_t term[3][LANES],
                   int64_t sum[3])
{
    enum { LOW = 12 };
    const quads first = quads_load(weight), last = quads_load(weight + QUADS);
    const quads more = quads_right(first, LOW), more2 = quads_right(last, LOW);
    const lanes high = lanes_within(more, more2);
    const lanes low = lanes_within(quads_sub(first, quads_left(more, LOW)),
                                   quads_sub(last, quads_left(more2, LOW)));
    for (int k = 0; k < 3; k++) {
        const lanes t = lanes_load(term[k]);
        sum[k] = (int64_t)quads_total(quads_dot(high, t)) * (1 << LOW) +
                 quads_total(quads_dot(low, t));
    }
}

void pmesh_predict_weigh(const pmesh_place_models *models,
                         const int32_t bounds[3], pmesh_prediction *p)
{
    const pmesh_fit *fit = models->predict[p->ring_class][p->unknown];
    const int32_t *along = fit[0].weight, *across = fit[1].weight;
    int64_t sum[3], height = 0;
    if (p->blind)
        return;
    add_up(along, p->term, sum);
    for (int t = 0; t < PMESH_FIT_TERMS; t++)
        height += (int64_t)(across[t] - along[t]) * p->height[t];
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

void pmesh_predict(const pmesh_codec *c, uint32_t x, const pmesh_site *site,
                   const int32_t partner_position[3], uint32_t provisional,
                   pmesh_prediction *out)
{
    pmesh_star s;
    walk w;
    if (site->ring.count == 0) {
        predict_blindly(partner_position, out);
        return;
    }
    const pmesh_ring *ring = &site->ring;
    memcpy(out->base, partner_position, sizeof out->base);
    pmesh_star_make(&s, c, ring, out->base);
    const scale by = make_scale(s.shift);
    walk_ring(c, &s, &by, ring, x, out->base, provisional, &w);
    make_terms(c, &s, site, &by, &w, out);
    classify(&s, ring, &w, out);
}

/* ---- learning ----------------------------------------------------------- */

enum {
    LARGEST_WEIGHT = 1 << 18,
    /* What a sample counts: 2^26 / (squares of expected and actual error). */
    WEIGHT_SCALE = 1 << 26
};

#define PULL_ALONG  ((int64_t)1 << 24)
#define PULL_ACROSS ((int64_t)1 << 27)

/* square < 2^32 - 1 */
static int32_t sample_weight(int64_t square)
{
    const uint32_t w = WEIGHT_SCALE / ((uint32_t)square + 1);
    return (int32_t)(w < LARGEST_WEIGHT ? w : LARGEST_WEIGHT);
}

/* An expected error in the units of learning, squared. */
static int64_t expected_square(const pmesh_prediction *p, uint32_t error)
{
    const int64_t e = limited(
        pmesh_scale(error, p->shift - FRACTION_BITS - FIT_DROP), TERM_LIMIT);
    return e * e;
}

/* Vectors, by axis, and their heights; the last one is the target. */
typedef struct factors {
    lanes along[3], across;
} factors;

/* height x normal; heights are below 2^16, so lanes take their last bit apart.
 */
static quads lifted(lanes half, lanes odd, lanes n, bool last)
{
    const lanes none = lanes_of(0);
    return last ? quads_add(quads_last(half, odd, n, n),
                            quads_last(half, none, n, none))
                : quads_add(quads_first(half, odd, n, n),
                            quads_first(half, none, n, none));
}

/* Less their heights vectors are below 2^15. */
static lanes flattened(const int16_t *v, lanes half, lanes odd, int32_t normal)
{
    const lanes n = lanes_of((int16_t)normal), t = lanes_load(v);
    const lanes one = lanes_of(1), none = lanes_of(0);
    const quads first =
        quads_sub(quads_first(t, none, one, none),
                  quads_right(lifted(half, odd, n, false), PMESH_NORMAL_BITS));
    const quads last =
        quads_sub(quads_last(t, none, one, none),
                  quads_right(lifted(half, odd, n, true), PMESH_NORMAL_BITS));
    return lanes_within(quads_right(first, FIT_DROP),
                        quads_right(last, FIT_DROP));
}

/* Height 7 and vector 7 of the prediction are made the target's before. */
static factors make_factors(const pmesh_prediction *p)
{
    const quads first = quads_load(p->height);
    const quads last = quads_load(p->height + QUADS);
    const quads half = quads_right(first, 1), half2 = quads_right(last, 1);
    const lanes halves = lanes_within(half, half2);
    const lanes odd = lanes_within(quads_sub(first, quads_left(half, 1)),
                                   quads_sub(last, quads_left(half2, 1)));
    factors f = { .across = halves }; /* FIT_DROP is 1 */
    for (int k = 0; k < 3; k++)
        f.along[k] = flattened(p->term[k], halves, odd, p->normal[k]);
    return f;
}

static void learn_along(pmesh_fit *fit, const factors *f, int32_t weight)
{
    pmesh_sample s;
    int16_t x[LANES], y[LANES], z[LANES];
    const lanes none = lanes_of(0);
    lanes_store(x, f->along[0]);
    lanes_store(y, f->along[1]);
    lanes_store(z, f->along[2]);
    for (int i = 0; i < PMESH_FIT_TERMS; i++) {
        const lanes a = lanes_of(x[i]), b = lanes_of(y[i]), d = lanes_of(z[i]);
        quads_store(s.product[i],
                    quads_add(quads_first(f->along[0], f->along[1], a, b),
                              quads_first(f->along[2], none, d, none)));
        quads_store(s.product[i] + QUADS,
                    quads_add(quads_last(f->along[0], f->along[1], a, b),
                              quads_last(f->along[2], none, d, none)));
    }
    pmesh_fit_learn(fit, &s, weight, PULL_ALONG);
}

static void learn_across(pmesh_fit *fit, const factors *f, int32_t weight)
{
    pmesh_sample s;
    int16_t height[LANES];
    const lanes none = lanes_of(0);
    lanes_store(height, f->across);
    for (int i = 0; i < PMESH_FIT_TERMS; i++) {
        const lanes h = lanes_of(height[i]);
        quads_store(s.product[i], quads_first(f->across, none, h, none));
        quads_store(s.product[i] + QUADS, quads_last(f->across, none, h, none));
    }
    pmesh_fit_learn(fit, &s, weight, PULL_ACROSS);
}

void pmesh_predict_learn(pmesh_place_models *models, pmesh_prediction *p,
                         const int32_t position[3], uint32_t along,
                         uint32_t across)
{
    pmesh_fit *fit = models->predict[p->ring_class][p->unknown];
    int64_t up = 0, error_up = 0, error = 0;
    if (p->blind)
        return;
    for (int k = 0; k < 3; k++) {
        const int64_t to =
            pmesh_scale((int64_t)position[k] - p->base[k], p->shift);
        const int64_t off = limited(to - p->corrected[k], TERM_LIMIT);
        const int64_t wanted = limited(to - p->mean[k], TERM_LIMIT);
        p->term[k][PMESH_FIT_TERMS] = (int16_t)wanted;
        up += wanted * p->normal[k];
        error_up += off * p->normal[k];
        error += off * off;
    }
    p->height[PMESH_FIT_TERMS] = (int32_t)(up >> PMESH_NORMAL_BITS);
    error_up >>= PMESH_NORMAL_BITS;
    const int64_t square_up = error_up * error_up >> 2 * FIT_DROP;
    const int64_t square_flat =
        limited((error >> 2 * FIT_DROP) - square_up, INT32_MAX);
    const factors f = make_factors(p);
    learn_along(&fit[0], &f,
                sample_weight(expected_square(p, along) +
                              (square_flat > 0 ? square_flat : 0)));
    learn_across(&fit[1], &f,
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
            c->near[m->vertex[pmesh_next(h)]].sum[k] += by[k];
        h = m->twin[last];
    } while (h != PMESH_NONE && h != start);
    for (int k = 0; k < 3 && h == PMESH_NONE; k++)
        c->near[m->vertex[last]].sum[k] += by[k];
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
    if (ring->count == 0 || c->mesh.fan) {
        shift_neighbours(c, x, by);
        return;
    }
    const quads all = quads_triple((const int32_t *)by);
    for (uint32_t i = 0; i < ring->count; i++) {
        pmesh_near *near = &c->near[ring->vertex[i]];
        pmesh_near_store(near, quads_add(pmesh_near_load(near), all));
    }
}
