/* SPDX-License-Identifier: MIT */
#include "format/cut.h"

enum {
    MAX_CUTS = PMESH_MAX_RING * (PMESH_MAX_RING - 1),
    GHOST = 255,     /* as a wing */
    SHAPE_BITS = 12, /* coordinates are scaled to this magnitude */
    TERMS = 5,
    WEIGHT_ONE = 256, /* weights have 1/4096 bit, costs 1/16 bit */
    SHARE_ONE = 4096,
    LEAST_ERROR = 16,   /* of a share: less is not worth learning */
    LEARN_PLACE = 8,    /* error / this changes a weight of a place, */
    LEARN_SHAPE = 1024, /* error x term / this one of the shape */
    LARGEST_WEIGHT = 1 << 24,
    TAKEN = INT32_MAX
};

/* Terms have 1/256 of the ring's size: x 2^40 / size / 2^32. */
#define SIZE_ONE ((int64_t)1 << 40)
#define TERM_ONE ((int64_t)1 << 32)

/* The ring in coordinates relative to v and scaled so that the largest lies in
 * 2^12 .. 2^13: then every sum below stays under 2^46 (SPEC appendix A). */
typedef struct shape {
    uint32_t count;
    bool open;
    int32_t x[PMESH_MAX_RING][3];
    int64_t sum[2 * PMESH_MAX_RING + 1][3]; /* of the first members, twice
                                               round if closed */
    int64_t square[2 * PMESH_MAX_RING + 1];
    int64_t per_size;    /* SIZE_ONE / mean square distance from v */
    int64_t drift[3];    /* mean displacement of newborn members ... */
    int32_t drift_count; /* ... if there are any */
    pmesh_cut_weights *weights;
    int32_t *degree[PMESH_MAX_RING];   /* weights of a member as a wing: its */
    int32_t *state[2][PMESH_MAX_RING]; /* degree, the states around wing a, b */
} shape;

static int64_t dot(const int64_t a[3], const int64_t b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static unsigned bit_length(uint32_t value)
{
    unsigned n = 0;
    for (; value; value >>= 1)
        n++;
    return n;
}

static int32_t scaled(int32_t value, int shift)
{
    return shift >= 0 ? value * (1 << shift) : value / (1 << -shift);
}

static void shape_points(shape *s, const pmesh_codec *c, uint32_t v,
                         const pmesh_ring *ring)
{
    const int32_t *at = c->mesh.position[v];
    uint32_t largest = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        for (int k = 0; k < 3; k++) {
            const int32_t d = c->mesh.position[ring->vertex[i]][k] - at[k];
            s->x[i][k] = d;
            largest |= (uint32_t)(d < 0 ? -d : d);
        }
    }
    const int shift = SHAPE_BITS + 1 - (int)bit_length(largest);
    for (uint32_t i = 0; i < ring->count; i++)
        for (int k = 0; k < 3; k++)
            s->x[i][k] = scaled(s->x[i][k], shift);

    int64_t drift[3] = { 0, 0, 0 };
    s->drift_count = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t x = ring->vertex[i];
        if (c->state[x] != PMESH_NEWBORN)
            continue;
        const int32_t *p = c->mesh.position[c->mesh.parent[x]];
        for (int k = 0; k < 3; k++)
            drift[k] += scaled(c->mesh.position[x][k] - p[k], shift);
        s->drift_count++;
    }
    for (int k = 0; k < 3; k++)
        s->drift[k] = s->drift_count ? drift[k] / s->drift_count : 0;
}

static void shape_sums(shape *s)
{
    const uint32_t n = s->count, rounds = s->open ? n : 2 * n;
    for (int k = 0; k < 3; k++)
        s->sum[0][k] = 0;
    s->square[0] = 0;
    for (uint32_t i = 0; i < rounds; i++) {
        const int32_t *x = s->x[i < n ? i : i - n];
        int64_t square = 0;
        for (int k = 0; k < 3; k++) {
            s->sum[i + 1][k] = s->sum[i][k] + x[k];
            square += (int64_t)x[k] * x[k];
        }
        s->square[i + 1] = s->square[i] + square;
    }
    const int64_t size = s->square[n] / n;
    s->per_size = SIZE_ONE / (size ? size : 1);
}

/* What the states of three consecutive members and the degree of the middle
 * one say about a wing there; a ghost lies before the first and behind the
 * last member of an open ring. */
static void shape_topology(shape *s, const pmesh_codec *c,
                           const pmesh_ring *ring)
{
    pmesh_cut_weights *w = s->weights;
    const uint32_t n = ring->count;
    uint8_t state[PMESH_MAX_RING + 2];
    for (uint32_t i = 0; i < n; i++)
        state[i + 1] = c->state[ring->vertex[i]];
    state[0] = ring->open ? PMESH_GHOST : state[n];
    state[n + 1] = ring->open ? PMESH_GHOST : state[1];
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t degree = c->degree[ring->vertex[i]];
        s->degree[i] = &w->degree[degree < PMESH_CUT_DEGREES
                                      ? degree
                                      : PMESH_CUT_DEGREES - 1];
        s->state[0][i] = &w->state[state[i]][state[i + 1]][state[i + 2]];
        s->state[1][i] = &w->state[state[i + 2]][state[i + 1]][state[i]];
    }
}

/* One way to cut, by ring positions. */
typedef struct option {
    uint8_t a, b; /* wings: the first and the last member that u gets */
} option;

/* Both ends of what u gets; a ghost stands beyond either end. */
static uint32_t option_span(const shape *s, option o, uint32_t *first)
{
    const uint32_t last = o.b == GHOST ? s->count - 1 : o.b;
    *first = o.a == GHOST ? 0 : o.a;
    return *first <= last ? last - *first : s->count - *first + last;
}

static int32_t *shape_weights(const shape *s, option o)
{
    const int kind = o.a == GHOST || o.b == GHOST ? 2 : s->open ? 1 : 0;
    return s->weights->shape[kind][s->drift_count ? 1 : 0];
}

/* Spread of u's ring, off-centre of v, reach of the wings, their angle, and
 * how far u strays from its newborn neighbours' displacement. */
static void weigh_shape(const shape *s, option o, int32_t term[TERMS])
{
    uint32_t first;
    const uint32_t n = s->count, span = option_span(s, o, &first);
    const int64_t members = span + 2; /* and v itself, which is at 0 */
    const int64_t others =
        n - span + (o.a != GHOST) + (o.b != GHOST); /* v's ring after */
    int64_t mean[3], a[3] = { 0 }, b[3] = { 0 };
    int64_t off = 0, stray = 0;

    for (int k = 0; k < 3; k++) {
        const int64_t part = s->sum[first + span + 1][k] - s->sum[first][k];
        mean[k] = part / members;
        if (o.a != GHOST)
            a[k] = s->x[o.a][k];
        if (o.b != GHOST)
            b[k] = s->x[o.b][k];
        const int64_t rest =
            (s->sum[n][k] - part + a[k] + b[k] + mean[k]) / others;
        off += rest * rest;
        stray += (mean[k] - s->drift[k]) * (mean[k] - s->drift[k]);
    }
    const int64_t spread =
        (s->square[first + span + 1] - s->square[first]) / members -
        dot(mean, mean);
    const int64_t terms[TERMS] = { spread, off, dot(a, a) + dot(b, b),
                                   dot(a, b), s->drift_count ? stray : 0 };
    for (int t = 0; t < TERMS; t++)
        term[t] = (int32_t)(terms[t] * s->per_size / TERM_ONE);
}

/* The weights of places: of the span, then two for each wing. */
static uint32_t list_places(const shape *s, option o, int32_t *place[5])
{
    uint32_t first, count = 0;
    const uint32_t span = option_span(s, o, &first);
    const uint32_t n = s->count;
    place[count++] =
        &s->weights->span[o.a == GHOST || o.b == GHOST ? 1 : 0]
                         [n < PMESH_CUT_RINGS ? n : PMESH_CUT_RINGS - 1]
                         [span < PMESH_CUT_SPANS ? span : PMESH_CUT_SPANS - 1];
    if (o.a != GHOST) {
        place[count++] = s->degree[o.a];
        place[count++] = s->state[0][o.a];
    }
    if (o.b != GHOST) {
        place[count++] = s->degree[o.b];
        place[count++] = s->state[1][o.b];
    }
    return count;
}

/* In 1/16 bit, up to a constant. */
static int32_t option_cost(const shape *s, option o)
{
    int32_t term[TERMS], *place[5];
    const int32_t *w = shape_weights(s, o);
    int64_t cost = 0;
    weigh_shape(s, o, term);
    for (int t = 0; t < TERMS; t++)
        cost += (int64_t)w[t] * term[t];
    cost /= 256;
    for (uint32_t i = list_places(s, o, place); i-- > 0;)
        cost += *place[i];
    return (int32_t)(cost / WEIGHT_ONE);
}

/* All legal cuts in a fixed order: by first, then end; the ghost last. */
static uint32_t list_options(const shape *s, option *options)
{
    const uint32_t n = s->count;
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t spans = s->open ? n - 1 - i : n - 1;
        for (uint32_t d = 1; d <= spans; d++) {
            const uint32_t j = i + d < n ? i + d : i + d - n;
            options[count++] = (option){ (uint8_t)i, (uint8_t)j };
        }
    }
    for (uint32_t i = 0; s->open && i < n; i++) {
        options[count++] = (option){ (uint8_t)i, GHOST };
        options[count++] = (option){ GHOST, (uint8_t)i };
    }
    return count;
}

static uint32_t cheapest(const int32_t *costs, uint32_t count)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < count; i++)
        if (costs[i] < costs[best])
            best = i;
    return best;
}

/* 2^(-cost / 16) of every option, the least cost as 65536; returns the sum. */
static uint32_t make_shares(const int32_t *costs, uint32_t count, int32_t least,
                            uint32_t *shares)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        const int64_t excess = (int64_t)costs[i] - least;
        shares[i] = excess < 16 * 17
                        ? pmesh_cut_share[excess % 16] >> (excess / 16)
                        : 0;
        sum += shares[i];
    }
    return sum;
}

static int half_octave(uint64_t value)
{
    int n = 0;
    for (uint64_t square = value * value; square >>= 1;)
        n++;
    return n;
}

/* The odds of a share against the rest of the sum. */
static unsigned odds_class(uint32_t share, uint32_t sum)
{
    const int k = half_octave(share) - half_octave(sum - share) + 12;
    return k < 0 ? 0 : k >= PMESH_CUT_ODDS ? PMESH_CUT_ODDS - 1 : (unsigned)k;
}

static void adjust(int32_t *weight, int64_t change)
{
    const int64_t w = *weight - change;
    *weight = (int32_t)(w > LARGEST_WEIGHT    ? LARGEST_WEIGHT
                        : w < -LARGEST_WEIGHT ? -LARGEST_WEIGHT
                                              : w);
}

/* One step down the gradient of the true cut's code length, as if it had been
 * coded by the shares: each option is off by its share, less 1 for the true
 * one. */
static void learn(shape *s, const option *options, uint32_t count,
                  const uint32_t *shares, uint32_t sum, uint32_t truth)
{
    const uint64_t per_sum = ((uint64_t)SHARE_ONE << 28) / sum;
    for (uint32_t i = 0; i < count; i++) {
        const int32_t error = (i == truth ? SHARE_ONE : 0) -
                              (int32_t)(shares[i] * per_sum >> 28);
        if (error > -LEAST_ERROR && error < LEAST_ERROR)
            continue;
        int32_t term[TERMS], *place[5];
        int32_t *w = shape_weights(s, options[i]);
        weigh_shape(s, options[i], term);
        for (int t = 0; t < TERMS; t++)
            adjust(&w[t], (int64_t)error * term[t] / LEARN_SHAPE);
        for (uint32_t k = list_places(s, options[i], place); k-- > 0;)
            adjust(place[k], error / LEARN_PLACE);
    }
}

/* The rank of the true option among all by cost; each question "is it the
 * cheapest left" is asked in the context of that option's odds. */
static uint32_t code_rank(pmesh_codec *c, pmesh_coder *coder, bool open,
                          int32_t *costs, const uint32_t *shares, uint32_t sum,
                          uint32_t count, uint32_t truth)
{
    for (uint32_t rank = 0; rank + 1 < count; rank++) {
        const uint32_t best = cheapest(costs, count);
        pmesh_bit *m = &c->models.cut[open]
                            [rank < PMESH_CUT_RANKS ? rank
                                                    : PMESH_CUT_RANKS - 1]
                            [odds_class(shares[best], sum)];
        if (!pmesh_code_bit(coder, m, best != truth))
            return best;
        costs[best] = TAKEN;
        sum -= shares[best];
    }
    return cheapest(costs, count);
}

void pmesh_cut_code(pmesh_codec *c, pmesh_coder *coder, uint32_t v,
                    const pmesh_ring *ring, pmesh_cut *cut)
{
    shape s;
    option options[MAX_CUTS];
    int32_t costs[MAX_CUTS];
    uint32_t shares[MAX_CUTS], truth = 0;

    s.count = ring->count;
    s.open = ring->open;
    s.weights = &c->models.cut_weights;
    shape_points(&s, c, v, ring);
    shape_sums(&s);
    shape_topology(&s, c, ring);
    const uint32_t count = list_options(&s, options);
    for (uint32_t i = 0; i < count; i++) {
        costs[i] = option_cost(&s, options[i]);
        if (options[i].a == (uint8_t)cut->first &&
            options[i].b == (uint8_t)cut->end)
            truth = i; /* PMESH_NONE and GHOST agree in their low bytes */
    }
    const uint32_t sum =
        make_shares(costs, count, costs[cheapest(costs, count)], shares);
    truth = code_rank(c, coder, s.open, costs, shares, sum, count, truth);
    learn(&s, options, count, shares, sum, truth);

    const option o = options[truth];
    cut->first = o.a == GHOST ? PMESH_NONE : o.a;
    cut->end = o.b == GHOST ? PMESH_NONE : o.b;
}
