/* SPDX-License-Identifier: MIT */
#include "format/cut.h"

#include "format/star.h"

enum {
    LANES = 8, /* options are weighed so many at a time, for SIMD's sake */
    MAX_OPTIONS = PMESH_MAX_RING * (PMESH_MAX_RING + 1), /* in full rows */
    GHOST = 255,     /* as a wing */
    SUM_BITS = 13,   /* of the largest coordinate times the ring's size */
    SHARE_BITS = 15, /* of 1 / members */
    LEAST_SIZE = 1 << 15,
    TERMS = PMESH_CUT_TERMS,
    TERM_LIMIT = INT16_MAX, /* terms have 1/256 of the ring's size, squared */
    WEIGHT_BITS = 8,  /* weights have 1/4096 bit, costs 1/16 bit */
    SHARE_ONE = 4096,
    LEAST_ERROR = 4,    /* of a share: less is not worth learning */
    LEARN_PLACE = 1,    /* error / this changes a weight of a place, */
    LEARN_SHAPE = 512,   /* error x term / this one of the shape */
    LARGEST_PLACE = 1 << 26,
    LARGEST_SHAPE = 1 << 17, /* so that the sum of all terms fits 32 bits */
    TAKEN = INT32_MAX
};

/* The ring relative to v, in coordinates scaled such that every sum of them
 * stays below 2^13: all that follows fits 32 bits (SPEC appendix A). The
 * members of a closed ring come twice, those of an open one are followed by
 * zeros; a row of lanes may read beyond what counts. */
enum { MEMBERS = 2 * PMESH_MAX_RING + LANES };
typedef struct shape {
    uint32_t count;
    bool open;
    int16_t x[3][MEMBERS];
    int16_t sum[3][MEMBERS + 1]; /* of the members before */
    int32_t square[MEMBERS + 1];
    int32_t per_size; /* 2^27 / mean square distance from v, <= 2^12 */
    int16_t drift[3];    /* mean displacement of newborn members ... */
    int32_t drift_count; /* ... if there are any */
    pmesh_cut_weights *weights;
    /* Weights of a member as wing a, b: of its degree, of the states around;
     * and the sum of both. */
    int32_t *degree[2][PMESH_MAX_RING], *state[2][PMESH_MAX_RING];
    int32_t wing[2][MEMBERS];
} shape;

/* The ways to cut, by the wings' ring positions, in rows of lanes; lanes
 * without an option are TAKEN from the start. */
typedef struct options {
    uint32_t count; /* a multiple of LANES */
    uint8_t a[MAX_OPTIONS], b[MAX_OPTIONS];
    int32_t cost[MAX_OPTIONS]; /* 1/16 bit, up to a constant */
    uint32_t share[MAX_OPTIONS];
    int16_t term[MAX_OPTIONS / LANES][TERMS][LANES];
} options;

uint64_t pmesh_cut_room(void)
{
    return sizeof(options);
}

/* 2^15 / n; members of a ring, v itself, and two wings more. */
#define R(n) ((1 << SHARE_BITS) / (n))
#define R4(n) R(n), R((n) + 1), R((n) + 2), R((n) + 3)
static const int16_t share_of[] = {
    0,      R(2) * 2 - 1, R(2),   R(3),   R4(4),  R4(8),  R4(12), R4(16),
    R4(20), R4(24),       R4(28), R4(32), R4(36), R4(40), R4(44), R4(48),
};

/* ---- the ring ----------------------------------------------------------- */

static void shape_points(shape *s, const pmesh_codec *c, uint32_t v,
                         const pmesh_ring *ring)
{
    const int32_t *at = c->mesh.position[v];
    const uint32_t n = ring->count;
    int32_t d[PMESH_MAX_RING][3];
    uint32_t largest = 0;
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            d[i][k] = c->mesh.position[ring->vertex[i]][k] - at[k];
            largest |= (uint32_t)(d[i][k] < 0 ? -d[i][k] : d[i][k]);
        }
    const int shift = SUM_BITS - (int)pmesh_bit_length(n) -
                      (int)pmesh_bit_length(largest);
    int64_t drift[3] = { 0, 0, 0 };
    s->drift_count = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t x = ring->vertex[i];
        for (int k = 0; k < 3; k++)
            s->x[k][i] = (int16_t)pmesh_scale(d[i][k], shift);
        if (c->state[x] != PMESH_NEWBORN)
            continue;
        const int32_t *p = c->mesh.position[c->mesh.parent[x]];
        for (int k = 0; k < 3; k++)
            drift[k] += c->mesh.position[x][k] - p[k];
        s->drift_count++;
    }
    const int64_t far = 1 << SUM_BITS;
    for (int k = 0; k < 3; k++) {
        const int64_t to = s->drift_count
                               ? pmesh_scale(drift[k], shift) / s->drift_count
                               : 0;
        s->drift[k] = (int16_t)(to < -far ? -far : to > far ? far : to);
    }
}

static void shape_sums(shape *s)
{
    const uint32_t n = s->count, end = (s->open ? n : 2 * n) + LANES;
    for (int k = 0; k < 3; k++) {
        int16_t *x = s->x[k], *sum = s->sum[k];
        for (uint32_t i = n; i < end; i++)
            x[i] = s->open ? 0 : x[i - n];
        sum[0] = 0;
        for (uint32_t i = 0; i < end; i++)
            sum[i + 1] = (int16_t)(sum[i] + x[i]);
    }
    s->square[0] = 0;
    for (uint32_t i = 0; i < end; i++)
        s->square[i + 1] = s->square[i] + s->x[0][i] * s->x[0][i] +
                           s->x[1][i] * s->x[1][i] + s->x[2][i] * s->x[2][i];
    const int32_t size = s->square[n] / (int32_t)n;
    s->per_size = (1 << 27) / (size > LEAST_SIZE ? size : LEAST_SIZE);
}

/* What the states of three consecutive members and the degree of the middle
 * one say about a wing there; a ghost lies before the first and behind the
 * last member of an open ring. */
static void shape_topology(shape *s, const pmesh_codec *c,
                           const pmesh_ring *ring)
{
    pmesh_cut_weights *w = s->weights;
    const uint32_t n = s->count;
    uint8_t state[PMESH_MAX_RING + 2];
    for (uint32_t i = 0; i < n; i++)
        state[i + 1] = c->state[ring->vertex[i]];
    state[0] = ring->open ? PMESH_GHOST : state[n];
    state[n + 1] = ring->open ? PMESH_GHOST : state[1];
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t many = c->degree[ring->vertex[i]];
        const uint32_t degree =
            many < PMESH_CUT_DEGREES ? many : PMESH_CUT_DEGREES - 1;
        s->degree[0][i] = &w->degree[0][degree];
        s->degree[1][i] = &w->degree[1][degree];
        s->state[0][i] = &w->state[0][state[i]][state[i + 1]][state[i + 2]];
        s->state[1][i] = &w->state[1][state[i + 2]][state[i + 1]][state[i]];
        for (int side = 0; side < 2; side++)
            s->wing[side][i] = *s->degree[side][i] + *s->state[side][i];
    }
    const uint32_t end = (s->open ? n : 2 * n) + LANES;
    for (uint32_t i = n; i < end; i++)
        for (int side = 0; side < 2; side++)
            s->wing[side][i] = s->open ? 0 : s->wing[side][i - n];
}

/* ---- options and their costs --------------------------------------------- */

static int32_t *span_weight(const shape *s, bool ghost, uint32_t span)
{
    const uint32_t n = s->count;
    return &s->weights->span[ghost]
                            [n < PMESH_CUT_RINGS ? n : PMESH_CUT_RINGS - 1]
                            [span < PMESH_CUT_SPANS ? span
                                                    : PMESH_CUT_SPANS - 1];
}

static int32_t *shape_weights(const shape *s, bool ghost)
{
    return s->weights->shape[ghost ? 2 : s->open][s->drift_count ? 1 : 0];
}

/* A row of options in lanes: what is to be known of each. */
typedef struct row {
    int16_t part[3][LANES];   /* sum of the members that u gets, */
    int32_t square[LANES];    /* and of their squares */
    int16_t a[3][LANES], b[3][LANES]; /* the wings */
    int16_t to_u[LANES], to_v[LANES]; /* 2^15 / size of both rings */
    int32_t place[LANES];     /* weights that do not depend on shape */
} row;

/* A term of all lanes and, weighed, its part of their costs. */
static void add_term(const int32_t square[LANES], int32_t per_size,
                     int16_t weight, int16_t *restrict term,
                     int32_t *restrict cost)
{
    for (int i = 0; i < LANES; i++) {
        int32_t t = (square[i] >> 10) * per_size >> 9;
        t = t > TERM_LIMIT ? TERM_LIMIT : t;
        t = t < -TERM_LIMIT ? -TERM_LIMIT : t;
        term[i] = (int16_t)t;
        cost[i] += weight * (int16_t)t;
    }
}

/* Spread of u's ring, off-centre of v, reach of the wings, their angle, and
 * how far u strays from its newborn neighbours' displacement. */
static void weigh(const shape *s, const row *r, const int32_t w[TERMS],
                  int16_t out[TERMS][LANES], int32_t cost[LANES])
{
    const int32_t per = s->per_size, drifts = s->drift_count ? per : 0;
    int32_t square[TERMS][LANES] = { { 0 } };

    for (int k = 0; k < 3; k++) {
        const int16_t all = s->sum[k][s->count], drift = s->drift[k];
        const int16_t *part = r->part[k], *a = r->a[k], *b = r->b[k];
        for (int i = 0; i < LANES; i++) {
            const int16_t mean = (int16_t)(part[i] * r->to_u[i] >> SHARE_BITS);
            const int16_t sum = (int16_t)(all - part[i] + a[i] + b[i] + mean);
            const int16_t rest = (int16_t)(sum * r->to_v[i] >> SHARE_BITS);
            const int16_t stray = (int16_t)(mean - drift);
            square[0][i] -= mean * mean;
            square[1][i] += rest * rest;
            square[2][i] += a[i] * a[i] + b[i] * b[i];
            square[3][i] += a[i] * b[i];
            square[4][i] += stray * stray;
        }
    }
    for (int i = 0; i < LANES; i++)
        square[0][i] += (r->square[i] >> 9) * r->to_u[i] >> (SHARE_BITS - 9);
    int32_t sum[LANES] = { 0 };
    for (int t = 0; t < TERMS; t++)
        add_term(square[t], t == TERMS - 1 ? drifts : per,
                 (int16_t)(w[t] >> 4), out[t], sum);
    for (int i = 0; i < LANES; i++)
        cost[i] = ((sum[i] >> 4) + (r->place[i] >> 4)) >> WEIGHT_BITS;
}

/* Weighs a row whose first `live` lanes are options and appends it. */
static void append(const shape *s, options *list, const row *r, uint32_t live,
                   bool ghost)
{
    int32_t *cost = &list->cost[list->count];
    weigh(s, r, shape_weights(s, ghost), list->term[list->count / LANES],
          cost);
    for (uint32_t i = live; i < LANES; i++)
        cost[i] = TAKEN;
    list->count += LANES;
}

/* Options whose wings are members `first` + lane and `span` further. */
static void append_inner(const shape *s, options *list, uint32_t first,
                         uint32_t span, uint32_t live)
{
    const uint32_t n = s->count, end = first + span;
    const int32_t place = *span_weight(s, false, span);
    row r;
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 0; i < LANES; i++) {
            r.part[k][i] = (int16_t)(s->sum[k][end + 1 + i] -
                                     s->sum[k][first + i]);
            r.a[k][i] = s->x[k][first + i];
            r.b[k][i] = s->x[k][end + i];
        }
    for (uint32_t i = 0; i < LANES; i++) {
        r.square[i] = s->square[end + 1 + i] - s->square[first + i];
        r.to_u[i] = share_of[span + 2];
        r.to_v[i] = share_of[n - span + 2];
        r.place[i] =
            place + s->wing[0][first + i] + s->wing[1][end + i];
        list->a[list->count + i] = (uint8_t)(first + i);
        list->b[list->count + i] =
            (uint8_t)(end + i < n ? end + i : end + i - n);
    }
    append(s, list, &r, live, false);
}

/* Of an open ring: wing a (side 0) is a member and b the ghost, or the other
 * way round (side 1). */
static void append_outer(const shape *s, options *list, uint32_t first,
                         int side)
{
    const uint32_t n = s->count;
    const uint32_t live = n - first < LANES ? n - first : LANES;
    row r = { .place = { 0 } };
    for (uint32_t i = 0; i < live; i++) {
        const uint32_t x = first + i;
        const uint32_t from = side ? 0 : x, end = side ? x : n - 1;
        for (int k = 0; k < 3; k++) {
            r.part[k][i] = (int16_t)(s->sum[k][end + 1] - s->sum[k][from]);
            (side ? r.b : r.a)[k][i] = s->x[k][x];
        }
        r.square[i] = s->square[end + 1] - s->square[from];
        r.to_u[i] = share_of[end - from + 2];
        r.to_v[i] = share_of[n - (end - from) + 1];
        r.place[i] = *span_weight(s, true, end - from) + s->wing[side][x];
        list->a[list->count + i] = (uint8_t)(side ? GHOST : x);
        list->b[list->count + i] = (uint8_t)(side ? x : GHOST);
    }
    append(s, list, &r, live, true);
}

/* All legal cuts in a fixed order: by span, then first; the ghost last. */
static void list_options(const shape *s, options *list)
{
    const uint32_t n = s->count;
    list->count = 0;
    for (uint32_t span = 1; span < n; span++) {
        const uint32_t firsts = s->open ? n - span : n;
        for (uint32_t i = 0; i < firsts; i += LANES)
            append_inner(s, list, i, span,
                         firsts - i < LANES ? firsts - i : LANES);
    }
    for (int side = 0; s->open && side < 2; side++)
        for (uint32_t i = 0; i < n; i += LANES)
            append_outer(s, list, i, side);
}

/* ---- coding -------------------------------------------------------------- */

static uint32_t cheapest(const options *list)
{
    int32_t least = TAKEN;
    uint32_t i = 0;
    for (uint32_t k = 0; k < list->count; k++)
        least = list->cost[k] < least ? list->cost[k] : least;
    while (i + 1 < list->count && list->cost[i] != least)
        i++;
    return i;
}

/* 65536 x 2^(-i / 16), rounded. */
static const uint32_t part_of[16] = {
    65536, 62757, 60097, 57549, 55109, 52773, 50535, 48393,
    46341, 44376, 42495, 40693, 38968, 37316, 35734, 34219,
};

/* 2^(-cost / 16) of every option, the least cost as 65536; returns the sum. */
static uint32_t make_shares(options *list, int32_t least)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        const uint32_t excess = (uint32_t)list->cost[i] - (uint32_t)least;
        list->share[i] = excess < 16 * 17
                             ? part_of[excess % 16] >> (excess / 16)
                             : 0;
        sum += list->share[i];
    }
    return sum;
}

static int half_octave(uint64_t value)
{
    return value ? (int)pmesh_bit_length(value * value) - 1 : 0;
}

/* The odds of a share against the rest of the sum. */
static unsigned odds_class(uint32_t share, uint32_t sum)
{
    const int k = half_octave(share) - half_octave(sum - share) + 12;
    return k < 0 ? 0 : k >= PMESH_CUT_ODDS ? PMESH_CUT_ODDS - 1 : (unsigned)k;
}

static void adjust(int32_t *weight, int32_t change, int32_t largest)
{
    const int32_t w = *weight - change;
    *weight = w > largest ? largest : w < -largest ? -largest : w;
}

static void learn_option(shape *s, const options *list, uint32_t i,
                         int32_t error)
{
    const uint32_t n = s->count, a = list->a[i], b = list->b[i];
    const bool ghost = a == GHOST || b == GHOST;
    const uint32_t from = a == GHOST ? 0 : a, end = b == GHOST ? n - 1 : b;
    const uint32_t span = from <= end ? end - from : n - from + end;
    const int32_t change = error / LEARN_PLACE;
    int32_t *w = shape_weights(s, ghost);
    for (int t = 0; t < TERMS; t++)
        adjust(&w[t], error * list->term[i / LANES][t][i % LANES] / LEARN_SHAPE,
               LARGEST_SHAPE);
    adjust(span_weight(s, ghost, span), change, LARGEST_PLACE);
    if (a != GHOST) {
        adjust(s->degree[0][a], change, LARGEST_PLACE);
        adjust(s->state[0][a], change, LARGEST_PLACE);
    }
    if (b != GHOST) {
        adjust(s->degree[1][b], change, LARGEST_PLACE);
        adjust(s->state[1][b], change, LARGEST_PLACE);
    }
}

/* One step down the gradient of the true cut's code length, as if it had been
 * coded by the shares: each option is off by its share, less 1 for the true
 * one. */
static void learn(shape *s, const options *list, uint32_t sum, uint32_t truth)
{
    const uint64_t per_sum = ((uint64_t)SHARE_ONE << 28) / sum;
    const uint64_t least = ((uint64_t)LEAST_ERROR << 28) / per_sum;
    for (uint32_t i = 0; i < list->count; i++) {
        if (list->share[i] < least && i != truth)
            continue; /* the error is too small */
        const int32_t error = (i == truth ? SHARE_ONE : 0) -
                              (int32_t)(list->share[i] * per_sum >> 28);
        if (error <= -LEAST_ERROR || error >= LEAST_ERROR)
            learn_option(s, list, i, error);
    }
}

/* Options of the ring; rows have lanes that are none. */
static uint32_t count_options(const shape *s)
{
    const uint32_t n = s->count;
    return s->open ? n * (n - 1) / 2 + 2 * n : n * (n - 1);
}

/* The rank of the true option among all by cost; each question "is it the
 * cheapest left" is asked in the context of that option's odds. */
static uint32_t code_rank(pmesh_codec *c, pmesh_coder *coder, const shape *s,
                          options *list, uint32_t best, uint32_t sum,
                          uint32_t truth)
{
    const uint32_t count = count_options(s);
    for (uint32_t rank = 0; rank + 1 < count; rank++) {
        pmesh_bit *m = &c->models.cut[s->open]
                            [rank < PMESH_CUT_RANKS ? rank
                                                    : PMESH_CUT_RANKS - 1]
                            [odds_class(list->share[best], sum)];
        if (!pmesh_code_bit(coder, m, best != truth))
            return best;
        list->cost[best] = TAKEN;
        sum -= list->share[best];
        best = cheapest(list);
    }
    return best;
}

static uint32_t find(const options *list, const pmesh_cut *cut)
{
    for (uint32_t i = 0; i < list->count; i++)
        if (list->cost[i] != TAKEN && list->a[i] == (uint8_t)cut->first &&
            list->b[i] == (uint8_t)cut->end)
            return i; /* PMESH_NONE and GHOST agree in their low bytes */
    return 0;
}

void pmesh_cut_code(pmesh_codec *c, pmesh_coder *coder, uint32_t v,
                    const pmesh_ring *ring, pmesh_cut *cut)
{
    options *list = (options *)c->cut_room;
    shape s;

    s.count = ring->count;
    s.open = ring->open;
    s.weights = &c->models.cut_weights;
    shape_points(&s, c, v, ring);
    shape_sums(&s);
    shape_topology(&s, c, ring);
    list_options(&s, list);
    const uint32_t best = cheapest(list);
    const uint32_t sum = make_shares(list, list->cost[best]);
    const uint32_t truth = code_rank(c, coder, &s, list, best, sum,
                                     coder->encoding ? find(list, cut) : 0);
    learn(&s, list, sum, truth);

    cut->first = list->a[truth] == GHOST ? PMESH_NONE : list->a[truth];
    cut->end = list->b[truth] == GHOST ? PMESH_NONE : list->b[truth];
}
