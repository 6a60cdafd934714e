/* SPDX-License-Identifier: MIT */
#include "format/cut.h"

#include <string.h>

#include "format/lanes.h"
#include "format/star.h"

enum {
    MAX_LANES = (PMESH_MAX_RING - 1) * PMESH_MAX_RING,
    MAX_ROWS = PMESH_MAX_RING + 1,
    ROOM = PMESH_MAX_RING + LANES,
    MEMBERS = 2 * PMESH_MAX_RING + 2 * LANES,
    LARGEST_BITS = 14, /* of the largest coordinate */
    DRIFT_LIMIT = 1 << 13,
    LEAST_SIZE = 513,
    TERM_LIMIT = 2047,  /* terms have 1/256 of the ring's size, squared */
    PLACE_LIMIT = 5000, /* of what makes up a cost besides, in 1/64 bit */
    TAKEN = INT16_MAX,  /* costs are below it by twice NO_SHARE at least */
    NO_SHARE = 64 * 16, /* so far above the least cost a share is 0 */
    GOOD_ODDS = 13,     /* 7 : 5 or better */
    ERROR_ONE = 4096,
    LEARN_SHAPE = 512, /* error x term / this changes a weight of the shape */
    LARGEST_SHAPE = (1 << 16) - 1 /* so that costs fit 16 bits */
};

typedef enum wing_set { BOTH, A_ONLY, B_ONLY } wing_set;

/* Options with as many members between their wings: the first wing of lane i is
 * member i. Those with one wing, at member i, differ in that. Lanes from `live`
 * on are none, and TAKEN. */
typedef struct row {
    uint32_t lane, live, span;
    wing_set wings;
} row;

/* All rows, one behind the other; those with one wing last. */
typedef struct options {
    uint32_t count, one_wing, row_count;
    struct row row[MAX_ROWS];
    int16_t term[PMESH_CUT_TERMS][MAX_LANES];
    int16_t cost[MAX_LANES]; /* 1/64 bit, up to a constant */
    int16_t share[MAX_LANES];
    uint32_t share_sum;
} options;

/* The ring relative to v, scaled such that the largest coordinate lies in 2^13
 * .. 2^14, and a second time by 2^-bits(n), such that sums fit 16 bits. What is
 * kept of members comes twice for a closed ring, that of an open one is
 * followed by zeros; a row may read beyond what counts. */
typedef struct cutter {
    uint32_t n;
    bool open;
    unsigned drop;         /* bits(n) */
    int16_t x[3][MEMBERS]; /* without the last bits(n) bits */
    int16_t all[3];        /* sum of the members, modulo 2^16 */
    int16_t square[ROOM];  /* of the whole coordinates, / 2^16 */
    int16_t reach[ROOM];   /* the terms of the squares */
    int16_t per_size;      /* 2^24 / mean square */
    int16_t far;           /* squares up to this count */
    int16_t drift[3];      /* mean displacement of newborn members, */
    uint32_t newborn;      /* if there are any */
    pmesh_cut_weights *weights;
    /* What a member costs as wing a, b: by its degree, by the states around,
     * and together with its reach. */
    int32_t *degree[PMESH_MAX_RING], *state[PMESH_MAX_RING];
    int16_t wing[2][MEMBERS];
    int16_t wing_error[2][MEMBERS];
    options *list;
} cutter;

uint64_t pmesh_cut_room(void)
{
    return sizeof(options);
}

/* 2^16 / n as far as it fits; members of a ring, v itself, and a wing more. */
#define R(n)  ((1 << 16) / (n))
#define R4(n) R(n), R((n) + 1), R((n) + 2), R((n) + 3)
static const int16_t share_of[] = {
    0,      INT16_MAX, INT16_MAX, R(3),   R4(4),  R4(8),  R4(12), R4(16),
    R4(20), R4(24),    R4(28),    R4(32), R4(36), R4(40), R4(44), R4(48),
};

static int32_t within(int32_t value, int32_t limit)
{
    return value < -limit ? -limit : value > limit ? limit : value;
}

static uint32_t padded(uint32_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

/* ---- the ring ------------------------------------------------------------ */

static void place_drift(cutter *s, const int64_t drift[3], int shift)
{
    for (int k = 0; k < 3; k++) {
        const int64_t all = pmesh_scale(drift[k], shift);
        const int32_t most = DRIFT_LIMIT * (int32_t)s->newborn;
        const int32_t sum = (int32_t)(all < -most  ? -most
                                      : all > most ? most
                                                   : all);
        s->drift[k] = (int16_t)(pmesh_share(sum, s->newborn) >> s->drop);
    }
}

/* The members relative to v, then zeros; returns the or of all sizes. */
static uint32_t gather(cutter *s, const pmesh_codec *c, uint32_t v,
                       const pmesh_ring *ring, quads d[ROOM], int64_t drift[3])
{
    const int32_t(*position)[3] = (const int32_t(*)[3])c->mesh.position;
    const quads from = quads_triple(position[v]);
    quads all = quads_of(0);
    uint32_t newborn[PMESH_MAX_RING];
    s->newborn = 0;
    const uint32_t end = padded(s->n);
    for (uint32_t i = end - LANES; i < end; i++) /* a number known beforehand */
        d[i] = quads_of(0);
    for (uint32_t i = 0; i < s->n; i++) {
        const uint32_t x = ring->vertex[i];
        d[i] = quads_sub(quads_triple(position[x]), from);
        all = quads_or(all, quads_size(d[i]));
        newborn[s->newborn] = x;
        s->newborn += c->state[x] == PMESH_NEWBORN;
    }
    for (uint32_t i = 0; i < s->newborn; i++) {
        const int32_t *x = position[newborn[i]];
        const int32_t *parent = position[c->mesh.parent[newborn[i]]];
        for (int k = 0; k < 3; k++)
            drift[k] += x[k] - parent[k];
    }
    return quads_any(all);
}

/* LANES members. */
static void place_lanes(cutter *s, uint32_t at, const quads d[LANES], int up,
                        int down)
{
    quads scaled[LANES];
    lanes y[3], square = lanes_of(0);
    for (int i = 0; i < LANES; i++)
        scaled[i] = quads_right(quads_left(d[i], up), down);
    lanes_columns(scaled, y);
    for (int k = 0; k < 3; k++) {
        const lanes x = lanes_right(y[k], (int)s->drop);
        lanes_store(s->x[k] + at, x);
        square = lanes_add(square, lanes_high(y[k], y[k]));
        s->all[k] = (int16_t)(s->all[k] + lanes_total(x));
    }
    lanes_store(s->square + at, square);
}

/* What is kept of n members comes again, or zeros. */
static void go_around(const cutter *s, int16_t *x)
{
    const uint32_t n = s->n, end = 2 * n + LANES;
    const uint32_t step = n < LANES ? n : LANES;
    if (s->open) {
        lanes_store(x + n, lanes_of(0));
        return;
    }
    for (uint32_t i = n; i < end; i += step)
        lanes_store(x + i, lanes_load(x + i - n));
}

static void place_points(cutter *s, const pmesh_codec *c, uint32_t v,
                         const pmesh_ring *ring)
{
    quads d[ROOM];
    int64_t drift[3] = { 0, 0, 0 };
    const uint32_t all = gather(s, c, v, ring, d, drift);
    const int shift = LARGEST_BITS - (int)pmesh_bit_length(all);
    const int up = shift > 0 ? shift : 0, down = up - shift;
    memset(s->all, 0, sizeof s->all);
    for (uint32_t i = 0; i < s->n; i += LANES)
        place_lanes(s, i, d + i, up, down);
    for (int k = 0; k < 3; k++)
        go_around(s, s->x[k]);
    memset(s->drift, 0, sizeof s->drift);
    if (s->newborn)
        place_drift(s, drift, shift);
}

/* min(square, far) x per_size / 2^16 */
static lanes terms_of(lanes square, lanes far, lanes per_size)
{
    return lanes_high(lanes_min(square, far), per_size);
}

static void measure(cutter *s)
{
    const uint32_t count = padded(s->n);
    quads sum = quads_of(0);
    for (uint32_t i = 0; i < count; i += LANES)
        sum = quads_add(sum, quads_dot(lanes_load(s->square + i), lanes_of(1)));
    const int32_t mean = pmesh_share(quads_total(sum), s->n);
    const int32_t size = mean > LEAST_SIZE ? mean : LEAST_SIZE;
    const int32_t per = (1 << 24) / size;
    const int32_t far = TERM_LIMIT * size >> 8;
    s->per_size = (int16_t)per;
    s->far = (int16_t)(far < INT16_MAX ? far : INT16_MAX);
    for (uint32_t i = 0; i < count; i += LANES)
        lanes_store(s->reach + i,
                    terms_of(lanes_load(s->square + i), lanes_of(s->far),
                             lanes_of(s->per_size)));
}

/* What the states of three consecutive members and the degree of the middle
 * one say about a wing there; a ghost lies before the first and behind the
 * last member of an open ring. */
static void look_up_wings(cutter *s, const pmesh_codec *c,
                          const pmesh_ring *ring, int32_t sum[2][ROOM])
{
    pmesh_cut_weights *w = s->weights;
    const uint32_t n = s->n;
    const uint32_t ghost = PMESH_GHOST;
    uint32_t before = s->open ? ghost : pmesh_state(c, ring->vertex[n - 1]);
    uint32_t here = pmesh_state(c, ring->vertex[0]);
    const uint32_t after = s->open ? ghost : here;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t many = c->near[ring->vertex[i]].degree;
        const uint32_t degree =
            many < PMESH_CUT_DEGREES ? many : PMESH_CUT_DEGREES - 1;
        const uint32_t behind =
            i + 1 < n ? pmesh_state(c, ring->vertex[i + 1]) : after;
        s->degree[i] = w->degree[degree];
        s->state[i] = w->state[before][here][behind];
        for (int side = 0; side < 2; side++)
            sum[side][i] = (int32_t)((uint32_t)s->degree[i][side] +
                                     (uint32_t)s->state[i][side]);
        before = here;
        here = behind;
    }
}

static void weigh_wings(cutter *s, const pmesh_codec *c, const pmesh_ring *ring)
{
    int32_t sum[2][ROOM];
    const uint32_t count = padded(s->n);
    const lanes none = lanes_of(0),
                by = lanes_of(
                    (int16_t)(s->weights->reach[s->open][s->newborn > 0] >> 4));
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < LANES; i += QUADS)
            quads_store(sum[side] + count - LANES + i, quads_of(0));
    look_up_wings(s, c, ring, sum);
    for (int side = 0; side < 2; side++) {
        for (uint32_t i = 0; i < count; i += LANES) {
            const lanes reach = lanes_load(s->reach + i);
            const quads first = quads_add(quads_first(by, none, reach, none),
                                          quads_load(sum[side] + i));
            const quads last = quads_add(quads_last(by, none, reach, none),
                                         quads_load(sum[side] + i + QUADS));
            lanes wing =
                lanes_within(quads_right(first, 10), quads_right(last, 10));
            wing = lanes_max(wing, lanes_of(-PLACE_LIMIT));
            lanes_store(s->wing[side] + i,
                        lanes_min(wing, lanes_of(PLACE_LIMIT)));
        }
        go_around(s, s->wing[side]);
    }
}

/* ---- options and their costs --------------------------------------------- */

static int32_t *span_weight(const cutter *s, bool ghost, uint32_t span)
{
    const uint32_t n = s->n;
    return &s->weights
                ->span[ghost][n < PMESH_CUT_RINGS ? n : PMESH_CUT_RINGS - 1]
                      [span < PMESH_CUT_SPANS ? span : PMESH_CUT_SPANS - 1];
}

static int16_t span_cost(const cutter *s, bool ghost, uint32_t span)
{
    return (int16_t)within(*span_weight(s, ghost, span) >> 10, PLACE_LIMIT);
}

static int32_t *shape_weights(const cutter *s, bool ghost)
{
    return s->weights->shape[ghost ? 2 : s->open][s->newborn > 0];
}

/* What many options have in common. */
typedef struct common {
    lanes to_u, to_v; /* 2^16 / size of both rings */
    lanes place;      /* what the span costs */
    lanes drift[3], all[3];
    lanes shape[PMESH_CUT_TERMS];
    lanes per_size, far;
    int drop;
} common;

static void make_common(const cutter *s, bool ghost, common *o)
{
    const int32_t *weight = shape_weights(s, ghost);
    for (int t = 0; t < PMESH_CUT_TERMS; t++)
        o->shape[t] = lanes_of((int16_t)(weight[t] >> 2));
    for (int k = 0; k < 3; k++) {
        o->drift[k] = lanes_of(s->drift[k]);
        o->all[k] = lanes_of(s->all[k]);
    }
    o->per_size = lanes_of(s->per_size);
    o->far = lanes_of(s->far);
    o->drop = (int)s->drop;
}

/* Sizes of both rings, u's with `span` between its wings; what that costs. */
static inline void make_span(const cutter *s, bool ghost, uint32_t span,
                             common *o)
{
    o->to_u = lanes_of(share_of[span + 2]);
    o->to_v = lanes_of(share_of[s->n - span + (ghost ? 1 : 2)]);
    o->place = lanes_of(span_cost(s, ghost, span));
}

/* Of options, up to their third axis: squares of v's way off the centre of its
 * ring, where u is at the mean of its own, and of u's way off its newborn
 * neighbours' displacement. */
typedef struct squares { lanes off, stray; } squares;

/* One axis: u gets `part`, v keeps what is left of all, and the wings. */
static inline void add_axis(const common *o, int k, lanes part, lanes wings,
                            bool drifts, squares *q)
{
    const lanes mean = lanes_high(part, o->to_u);
    const lanes rest =
        lanes_add(lanes_sub(o->all[k], part), lanes_add(wings, mean));
    const lanes v = lanes_left(lanes_high(rest, o->to_v), o->drop);
    q->off = lanes_add(q->off, lanes_high(v, v));
    if (!drifts)
        return;
    const lanes u = lanes_left(lanes_sub(mean, o->drift[k]), o->drop);
    q->stray = lanes_add(q->stray, lanes_high(u, u));
}

/* The terms go to the list, costs are returned; `wings` is what those cost. */
static inline lanes weigh_shape(options *list, const common *o, uint32_t lane,
                                squares q, lanes wings, bool drifts)
{
    const lanes off = terms_of(q.off, o->far, o->per_size);
    lanes cost = lanes_add(o->place, wings);
    lanes_store(list->term[0] + lane, off);
    cost = lanes_add(cost, lanes_high(lanes_left(off, 4), o->shape[0]));
    if (!drifts)
        return cost;
    const lanes stray = terms_of(q.stray, o->far, o->per_size);
    lanes_store(list->term[1] + lane, stray);
    return lanes_add(cost, lanes_high(lanes_left(stray, 4), o->shape[1]));
}

/* In a row's first `live` lanes nothing, in the others TAKEN. */
#define X7(x)  x, x, x, x, x, x, x
#define X8(x)  X7(x), x
#define X24(x) X8(x), X8(x), X8(x)
static const int16_t barrier[] = { X24(INT16_MIN), X24(INT16_MIN), X24(TAKEN),
                                   X24(TAKEN) };

static row *add_row(options *list, wing_set wings, uint32_t span, uint32_t live)
{
    row *r = &list->row[list->row_count++];
    *r = (row){ list->count, live, span, wings };
    list->count += padded(live);
    return r;
}

/* The options whose first wing is one of members at .. at + 7, in all rows:
 * with each span u gets another member, its wing b. */
static inline void weigh_column(cutter *s, common *o, uint32_t at, bool drifts)
{
    options *list = s->list;
    const lanes wing = lanes_load(s->wing[0] + at);
    lanes a[3], part[3];
    for (int k = 0; k < 3; k++)
        a[k] = part[k] = lanes_load(s->x[k] + at);
    for (const row *r = list->row; r < list->row + list->row_count; r++) {
        const uint32_t lane = r->lane + at, end = at + r->span;
        squares q = { lanes_of(0), lanes_of(0) };
        if (at >= r->live)
            break;
        make_span(s, false, r->span, o);
        for (int k = 0; k < 3; k++) {
            const lanes b = lanes_load(s->x[k] + end);
            part[k] = lanes_add(part[k], b);
            add_axis(o, k, part[k], lanes_add(a[k], b), drifts, &q);
        }
        const lanes cost =
            weigh_shape(list, o, lane, q,
                        lanes_add(wing, lanes_load(s->wing[1] + end)), drifts);
        lanes_store(list->cost + lane,
                    lanes_max(cost, lanes_load(barrier + PMESH_MAX_RING -
                                               r->live + at)));
    }
}

static void weigh_inner(cutter *s)
{
    common o;
    make_common(s, false, &o);
    for (uint32_t at = 0; at < s->n; at += LANES)
        if (s->newborn)
            weigh_column(s, &o, at, true);
        else
            weigh_column(s, &o, at, false);
}

/* Of an open ring: one wing is member x, the other the ghost. All lanes hold
 * this option, all but the first will be written over. */
static void weigh_outer(cutter *s, common *o, const row *r, uint32_t x,
                        const int16_t part[3])
{
    const uint32_t n = s->n, at = r->lane + x;
    const uint32_t span = r->wings == B_ONLY ? x : n - 1 - x;
    squares q = { lanes_of(0), lanes_of(0) };
    make_span(s, true, span, o);
    for (int k = 0; k < 3; k++)
        add_axis(o, k, lanes_of(part[k]), lanes_of(s->x[k][x]), s->newborn, &q);
    const lanes wing = lanes_of(s->wing[r->wings == B_ONLY][x]);
    lanes_store(s->list->cost + at,
                weigh_shape(s->list, o, at, q, wing, s->newborn));
}

static void add_outer(cutter *s, common *o, wing_set wings)
{
    options *list = s->list;
    row *r = add_row(list, wings, 0, s->n);
    int16_t before[3] = { 0, 0, 0 }; /* sums */
    for (uint32_t x = 0; x < s->n; x++) {
        int16_t part[3];
        for (int k = 0; k < 3; k++) {
            const int16_t here = s->x[k][x];
            part[k] = (int16_t)(wings == B_ONLY ? before[k] + here
                                                : s->all[k] - before[k]);
            before[k] = (int16_t)(before[k] + here);
        }
        weigh_outer(s, o, r, x, part);
    }
    for (uint32_t at = r->lane + s->n; at < list->count; at++)
        list->cost[at] = TAKEN;
}

/* All legal cuts in a fixed order: by span, then first; the ghost last. */
static void list_options(cutter *s)
{
    const uint32_t n = s->n;
    options *list = s->list;
    list->count = list->row_count = 0;
    for (uint32_t span = 1; span < n; span++)
        add_row(list, BOTH, span, s->open ? n - span : n);
    list->one_wing = list->count;
    weigh_inner(s);
    if (s->open) {
        common o;
        make_common(s, true, &o);
        add_outer(s, &o, A_ONLY);
        add_outer(s, &o, B_ONLY);
    }
}

static uint32_t count_options(const cutter *s)
{
    const uint32_t n = s->n;
    return s->open ? n * (n - 1) / 2 + 2 * n : n * (n - 1);
}

/* ---- coding -------------------------------------------------------------- */

/* All lanes around the option are stored: loads that follow wait for a part. */
static void take(options *list, uint32_t option)
{
    static const int16_t only[] = { X7(INT16_MIN), TAKEN, X7(INT16_MIN) };
    const uint32_t lane = option % LANES;
    int16_t *cost = list->cost + (option - lane);
    lanes_store(cost,
                lanes_max(lanes_load(cost), lanes_load(only + 7 - lane)));
}

/* About 2^(-cost) of every option, that of the least cost as 2^15: (1 - x)^16,
 * where 16 x = cost ln 2. */
static void make_shares(options *list, int16_t least)
{
    enum { PER_COST = 44 }; /* 2^16 / 16 x ln 2 / 64 */
    const lanes low = lanes_of(least);
    const lanes high = lanes_of((int16_t)(least + NO_SHARE));
    quads sum = quads_of(0);
    for (uint32_t k = 0; k < list->count; k += LANES) {
        const lanes over =
            lanes_sub(lanes_min(lanes_load(list->cost + k), high), low);
        lanes x = lanes_sub(lanes_of(-1), lanes_times(over, PER_COST));
        for (int i = 0; i < 4; i++)
            x = lanes_high_unsigned(x, x);
        x = lanes_half_unsigned(x);
        lanes_store(list->share + k, x);
        sum = quads_add(sum, quads_dot(x, lanes_of(1)));
    }
    list->share_sum = (uint32_t)quads_total(sum);
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

/* The rank of the true option among all by cost; each question "is it the
 * cheapest left" is asked in the context of that option's odds. `expected`:
 * the true one is the cheapest, with good odds. */
static uint32_t code_rank(cutter *s, pmesh_codec *c, pmesh_coder *coder,
                          uint32_t truth, bool *expected)
{
    options *list = s->list;
    const uint32_t count = count_options(s);
    int16_t least;
    uint32_t best = lanes_first_least(list->cost, list->count, &least);
    make_shares(list, least);
    uint32_t sum = list->share_sum;
    *expected = false;
    for (uint32_t rank = 0; rank + 1 < count; rank++) {
        const uint32_t share = (uint32_t)list->share[best];
        const unsigned odds = odds_class(share, sum);
        pmesh_bit *m =
            &c->models.cut[s->open]
                          [rank < PMESH_CUT_RANKS ? rank : PMESH_CUT_RANKS - 1]
                          [odds];
        if (!pmesh_code_bit(coder, m, best != truth)) {
            *expected = rank == 0 && odds >= GOOD_ODDS;
            break;
        }
        take(list, best);
        sum -= share;
        best = lanes_first_least(list->cost, list->count, &least);
    }
    return best;
}

/* ---- learning ------------------------------------------------------------ */

/* Modulo 2^32: only a stream made for it goes that far. */
static void adjust(int32_t *weight, int32_t change)
{
    *weight = (int32_t)((uint32_t)*weight - (uint32_t)change);
}

static void adjust_shape(int32_t *weight, quads change)
{
    *weight = within(*weight - quads_total(change) / LEARN_SHAPE,
                     LARGEST_SHAPE);
}

/* Of each option: 0 less its share, 1 for the true one; takes the room of
 * costs. */
static void make_errors(options *list, uint32_t truth)
{
    const lanes per_sum =
        lanes_of((int16_t)(((uint32_t)ERROR_ONE << 16) / list->share_sum));
    for (uint32_t k = 0; k < list->count; k += LANES) {
        const lanes share = lanes_load(list->share + k);
        lanes_store(list->cost + k,
                    lanes_sub(lanes_of(0), lanes_high(share, per_sum)));
    }
    list->cost[truth] = (int16_t)(list->cost[truth] + ERROR_ONE);
}

static void learn_term(const options *list, int t, int32_t *weight,
                       uint32_t begin, uint32_t end)
{
    quads sum = quads_of(0);
    for (uint32_t k = begin; k < end; k += LANES)
        sum = quads_add(sum, quads_dot(lanes_load(list->cost + k),
                                       lanes_load(list->term[t] + k)));
    adjust_shape(&weight[t], sum);
}

static void learn_shape(const cutter *s, bool ghost, uint32_t begin,
                        uint32_t end)
{
    learn_term(s->list, 0, shape_weights(s, ghost), begin, end);
    if (s->newborn)
        learn_term(s->list, 1, shape_weights(s, ghost), begin, end);
}

static void learn_inner(cutter *s, const row *r)
{
    int16_t *a = s->wing_error[0], *b = s->wing_error[1] + r->span;
    quads all = quads_of(0);
    for (uint32_t i = 0; i < r->live; i += LANES) {
        const lanes error = lanes_load(s->list->cost + r->lane + i);
        lanes_store(a + i, lanes_add(lanes_load(a + i), error));
        lanes_store(b + i, lanes_add(lanes_load(b + i), error));
        all = quads_add(all, quads_dot(error, lanes_of(1)));
    }
    adjust(span_weight(s, false, r->span), quads_total(all));
}

static void learn_outer(cutter *s, const row *r)
{
    const int16_t *error = s->list->cost + r->lane;
    const int side = r->wings == B_ONLY;
    for (uint32_t i = 0; i < r->live; i++) {
        s->wing_error[side][i] = (int16_t)(s->wing_error[side][i] + error[i]);
        adjust(span_weight(s, true, side ? i : s->n - 1 - i), error[i]);
    }
}

static void learn_wings(cutter *s)
{
    int16_t error[2][ROOM];
    quads reach = quads_of(0);
    for (uint32_t i = 0; i < s->n; i += LANES)
        for (int side = 0; side < 2; side++) {
            lanes e = lanes_load(s->wing_error[side] + i);
            if (!s->open)
                e = lanes_add(e, lanes_load(s->wing_error[side] + i + s->n));
            lanes_store(error[side] + i, e);
            /* Behind the last member of a ring reach is 0. */
            reach = quads_add(reach, quads_dot(e, lanes_load(s->reach + i)));
        }
    for (uint32_t i = 0; i < s->n; i++)
        for (int side = 0; side < 2; side++) {
            adjust(&s->degree[i][side], error[side][i]);
            adjust(&s->state[i][side], error[side][i]);
        }
    adjust_shape(&s->weights->reach[s->open][s->newborn > 0], reach);
}

/* One step down the gradient of the true cut's code length, as if it had been
 * coded by the shares. */
static void learn(cutter *s, uint32_t truth)
{
    options *list = s->list;
    make_errors(list, truth);
    learn_shape(s, false, 0, list->one_wing);
    if (s->open)
        learn_shape(s, true, list->one_wing, list->count);
    for (int side = 0; side < 2; side++)
        memset(s->wing_error[side], 0, (2 * s->n + LANES) * sizeof(int16_t));
    for (uint32_t k = 0; k < list->row_count; k++)
        if (list->row[k].wings == BOTH)
            learn_inner(s, &list->row[k]);
        else
            learn_outer(s, &list->row[k]);
    learn_wings(s);
}

/* ---- between cuts and options -------------------------------------------- */

static uint32_t find(const cutter *s, const pmesh_cut *cut)
{
    const options *list = s->list;
    if (cut->first == PMESH_NONE)
        return list->row[list->row_count - 1].lane + cut->end;
    if (cut->end == PMESH_NONE)
        return list->row[list->row_count - 2].lane + cut->first;
    const uint32_t span = cut->first < cut->end ? cut->end - cut->first
                                                : s->n - cut->first + cut->end;
    return list->row[span - 1].lane + cut->first;
}

static pmesh_cut cut_of(const cutter *s, uint32_t option)
{
    const row *r = &s->list->row[s->list->row_count - 1];
    while (r->lane > option)
        r--;
    const uint32_t x = option - r->lane, end = x + r->span;
    if (r->wings == A_ONLY)
        return (pmesh_cut){ x, PMESH_NONE };
    if (r->wings == B_ONLY)
        return (pmesh_cut){ PMESH_NONE, x };
    return (pmesh_cut){ x, end < s->n ? end : end - s->n };
}

void pmesh_cut_code(pmesh_codec *c, pmesh_coder *coder, uint32_t v,
                    const pmesh_ring *ring, pmesh_cut *cut)
{
    cutter s;
    s.n = ring->count;
    s.open = ring->open;
    s.drop = pmesh_bit_length(s.n);
    s.weights = &c->models.cut_weights;
    s.list = (options *)(void *)c->scratch;
    place_points(&s, c, v, ring);
    measure(&s);
    weigh_wings(&s, c, ring);
    list_options(&s);
    bool expected;
    const uint32_t truth = code_rank(
        &s, c, coder, coder->encoding ? find(&s, cut) : 0, &expected);
    if (!expected)
        learn(&s, truth);
    *cut = cut_of(&s, truth);
}
