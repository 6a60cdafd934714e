/* SPDX-License-Identifier: MIT */
#include "format/cut.h"

#include <string.h>

#include "format/star.h"

enum {
    LANES = 8, /* rows are padded to a multiple, for SIMD's sake */
    MAX_LANES = (PMESH_MAX_RING - 1) * PMESH_MAX_RING,
    MAX_ROWS = PMESH_MAX_RING + 1,
    MEMBERS = 2 * PMESH_MAX_RING + LANES,

    LARGEST_BITS = 14, /* of the largest coordinate */
    DRIFT_LIMIT = 1 << 13,
    LEAST_SIZE = 513,
    TERM_LIMIT = 2047,  /* terms have 1/256 of the ring's size, squared */
    PLACE_LIMIT = 5000, /* of what makes up a cost besides, in 1/64 bit */
    TAKEN = INT16_MAX,

    SHARE_ONE = 1 << 15, /* of the cheapest option */
    ERROR_ONE = 4096,
    LEARN_SHAPE = 512, /* error x term / this changes a weight of the shape */
    LARGEST_PLACE = 1 << 26,
    LARGEST_SHAPE = (1 << 16) - 1 /* so that costs fit 16 bits */
};

typedef enum wing_set { BOTH, A_ONLY, B_ONLY } wing_set;

/* Options with as many members between their wings: the first wing of lane i is
 * member i. Those with one wing, at member i, differ in that. Lanes from `live`
 * on are none, and TAKEN. */
typedef struct row {
    uint32_t lane, live;
    uint32_t span;
    wing_set wings;
} row;

/* All rows, one behind the other; those with one wing last. */
typedef struct options {
    uint32_t count, one_wing, row_count;
    struct row row[MAX_ROWS];
    int16_t part[3][MAX_LANES]; /* sum of the members that u gets */
    int16_t rest[3][MAX_LANES]; /* of those that v keeps, and the wings */
    int16_t to_u[MAX_LANES], to_v[MAX_LANES]; /* 2^16 / size of both rings */
    int16_t term[PMESH_CUT_TERMS][MAX_LANES];
    int16_t cost[MAX_LANES]; /* 1/64 bit, up to a constant */
    uint16_t share[MAX_LANES];
    uint32_t share_sum;
} options;

/* The ring relative to v, scaled such that the largest coordinate lies in 2^13
 * .. 2^14, and a second time by 2^-bits(n), such that sums fit 16 bits. What is
 * kept of members comes twice for a closed ring, that of an open one is
 * followed by zeros; a row may read beyond what counts. */
typedef struct cutter {
    uint32_t n;
    bool open;
    unsigned drop;                  /* bits(n) */
    int16_t x[3][MEMBERS];          /* without the last bits(n) bits */
    int16_t sum[3][MEMBERS + 1];    /* of the members before, modulo 2^16 */
    int16_t square[PMESH_MAX_RING]; /* of the whole coordinates, / 2^16 */
    int16_t reach[PMESH_MAX_RING];  /* the terms of the squares */
    int16_t per_size;               /* 2^24 / mean square */
    int16_t far;                    /* squares up to this count */
    int16_t drift[3];               /* mean displacement of newborn members, */
    uint32_t newborn;               /* if there are any */
    pmesh_cut_weights *weights;
    /* What a member costs as wing a, b: by its degree, by the states around,
     * and together with its reach. */
    int32_t *degree[2][PMESH_MAX_RING], *state[2][PMESH_MAX_RING];
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

/* ---- the ring ------------------------------------------------------------ */

static int32_t scaled(int32_t value, int shift)
{
    return shift >= 0 ? value * (1 << shift) : value >> -shift;
}

static int16_t square_of(int16_t y)
{
    return (int16_t)(y * y >> 16);
}

/* `far` is such that terms are at most TERM_LIMIT. */
static int16_t term_of(int16_t square, int16_t far, int16_t per_size)
{
    const int16_t near = square < far ? square : far;
    return (int16_t)(near * per_size >> 16);
}

static void place_drift(cutter *s, const int64_t drift[3], int shift)
{
    for (int k = 0; k < 3; k++) {
        const int64_t to = pmesh_scale(drift[k], shift) / s->newborn;
        s->drift[k] = (int16_t)((to < -DRIFT_LIMIT  ? -DRIFT_LIMIT
                                 : to > DRIFT_LIMIT ? DRIFT_LIMIT
                                                    : to) >>
                                s->drop);
    }
}

static void place_points(cutter *s, const pmesh_codec *c, uint32_t v,
                         const pmesh_ring *ring)
{
    const int32_t(*position)[3] = (const int32_t(*)[3])c->mesh.position;
    int32_t d[PMESH_MAX_RING][3];
    int64_t drift[3] = { 0, 0, 0 };
    uint32_t all = 0;
    s->newborn = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        const uint32_t x = ring->vertex[i];
        for (int k = 0; k < 3; k++) {
            d[i][k] = position[x][k] - position[v][k];
            all |= (uint32_t)(d[i][k] < 0 ? -d[i][k] : d[i][k]);
        }
        if (c->state[x] != PMESH_NEWBORN)
            continue;
        for (int k = 0; k < 3; k++)
            drift[k] += position[x][k] - position[c->mesh.parent[x]][k];
        s->newborn++;
    }
    const int shift = LARGEST_BITS - (int)pmesh_bit_length(all);
    for (uint32_t i = 0; i < s->n; i++) {
        s->square[i] = 0;
        for (int k = 0; k < 3; k++) {
            const int16_t y = (int16_t)scaled(d[i][k], shift);
            s->x[k][i] = (int16_t)(y >> s->drop);
            s->square[i] = (int16_t)(s->square[i] + square_of(y));
        }
    }
    memset(s->drift, 0, sizeof s->drift);
    if (s->newborn)
        place_drift(s, drift, shift);
}

static void sum_up(cutter *s)
{
    const uint32_t n = s->n, end = (s->open ? n : 2 * n) + LANES;
    int32_t size = 0;
    for (uint32_t i = 0; i < n; i++)
        size += s->square[i];
    size /= (int32_t)n;
    const int32_t per = (1 << 24) / (size > LEAST_SIZE ? size : LEAST_SIZE);
    const int32_t far = (TERM_LIMIT << 16) / per;
    s->per_size = (int16_t)per;
    s->far = (int16_t)(far < INT16_MAX ? far : INT16_MAX);
    for (uint32_t i = 0; i < n; i++)
        s->reach[i] = term_of(s->square[i], s->far, s->per_size);
    for (int k = 0; k < 3; k++) {
        int16_t *x = s->x[k], *sum = s->sum[k];
        uint16_t so_far = 0;
        for (uint32_t i = n; i < end; i++)
            x[i] = s->open ? 0 : x[i - n];
        for (uint32_t i = 0; i < end; i++) {
            sum[i] = (int16_t)so_far;
            so_far = (uint16_t)(so_far + (uint16_t)x[i]);
        }
        sum[end] = (int16_t)so_far;
    }
}

/* What the states of three consecutive members and the degree of the middle
 * one say about a wing there; a ghost lies before the first and behind the
 * last member of an open ring. */
static void weigh_wings(cutter *s, const pmesh_codec *c, const pmesh_ring *ring)
{
    pmesh_cut_weights *w = s->weights;
    const uint32_t n = s->n;
    const int32_t reach = w->reach[s->open][s->newborn > 0] >> 4;
    uint8_t state[PMESH_MAX_RING + 2];
    for (uint32_t i = 0; i < n; i++)
        state[i + 1] = c->state[ring->vertex[i]];
    state[0] = s->open ? PMESH_GHOST : state[n];
    state[n + 1] = s->open ? PMESH_GHOST : state[1];
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t many = c->degree[ring->vertex[i]];
        const uint32_t degree =
            many < PMESH_CUT_DEGREES ? many : PMESH_CUT_DEGREES - 1;
        const uint8_t *at = &state[i];
        s->degree[0][i] = &w->degree[0][degree];
        s->degree[1][i] = &w->degree[1][degree];
        s->state[0][i] = &w->state[0][at[0]][at[1]][at[2]];
        s->state[1][i] = &w->state[1][at[2]][at[1]][at[0]];
        for (int side = 0; side < 2; side++)
            s->wing[side][i] =
                (int16_t)within((reach * s->reach[i] + *s->degree[side][i] +
                                 *s->state[side][i]) >>
                                    10,
                                PLACE_LIMIT);
    }
    const uint32_t end = (s->open ? n : 2 * n) + LANES;
    for (uint32_t i = n; i < end; i++)
        for (int side = 0; side < 2; side++)
            s->wing[side][i] = s->open ? 0 : s->wing[side][i - n];
}

/* ---- options and their costs ----------------------------------------------
 */

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

static uint32_t padded(uint32_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

static row *add_row(options *list, wing_set wings, uint32_t span, uint32_t live)
{
    row *r = &list->row[list->row_count++];
    *r = (row){ list->count, live, span, wings };
    list->count += padded(live);
    return r;
}

static void add_inner(cutter *s, uint32_t span, uint32_t live)
{
    options *list = s->list;
    const row *r = add_row(list, BOTH, span, live);
    const uint32_t lanes = list->count - r->lane;
    for (int k = 0; k < 3; k++) {
        const int16_t *a = s->x[k], *b = a + span;
        const int16_t *from = s->sum[k], *end = from + span + 1;
        const int16_t all = s->sum[k][s->n];
        int16_t *restrict part = list->part[k] + r->lane;
        int16_t *restrict rest = list->rest[k] + r->lane;
        for (uint32_t i = 0; i < lanes; i++) {
            part[i] = (int16_t)(end[i] - from[i]);
            rest[i] = (int16_t)(all - part[i] + a[i] + b[i]);
        }
    }
    const int16_t place = span_cost(s, false, span);
    const int16_t *a = s->wing[0], *b = s->wing[1] + span;
    const int16_t to_u = share_of[span + 2], to_v = share_of[s->n - span + 2];
    int16_t *restrict u_size = list->to_u + r->lane;
    int16_t *restrict v_size = list->to_v + r->lane;
    int16_t *restrict cost = list->cost + r->lane;
    for (uint32_t i = 0; i < lanes; i++) {
        u_size[i] = to_u;
        v_size[i] = to_v;
        cost[i] = (int16_t)(place + a[i] + b[i]);
    }
}

/* Of an open ring: one wing is a member, the other the ghost. */
static void add_outer(cutter *s, wing_set wings)
{
    options *list = s->list;
    const uint32_t n = s->n;
    const row *r = add_row(list, wings, 0, n);
    for (uint32_t i = 0; i < list->count - r->lane; i++) {
        const uint32_t x = i < n ? i : n - 1, at = r->lane + i;
        const uint32_t from = wings == B_ONLY ? 0 : x;
        const uint32_t span = wings == B_ONLY ? x : n - 1 - x;
        for (int k = 0; k < 3; k++) {
            const int16_t *sum = s->sum[k];
            list->part[k][at] = (int16_t)(sum[from + span + 1] - sum[from]);
            list->rest[k][at] =
                (int16_t)(sum[n] - list->part[k][at] + s->x[k][x]);
        }
        list->to_u[at] = share_of[span + 2];
        list->to_v[at] = share_of[n - span + 1];
        list->cost[at] =
            (int16_t)(span_cost(s, true, span) + s->wing[wings == B_ONLY][x]);
    }
}

/* All legal cuts in a fixed order: by span, then first; the ghost last. */
static void list_options(cutter *s)
{
    const uint32_t n = s->n;
    s->list->count = s->list->row_count = 0;
    for (uint32_t span = 1; span < n; span++)
        add_inner(s, span, s->open ? n - span : n);
    s->list->one_wing = s->list->count;
    if (s->open) {
        add_outer(s, A_ONLY);
        add_outer(s, B_ONLY);
    }
}

static int16_t scaled_by(int16_t x, int16_t by)
{
    return (int16_t)(x * by >> 16);
}

/* Squares of v's way off the centre of its ring, where u is at the mean of its
 * own, and of u's from its newborn neighbours' displacement. */
static void square_up(const cutter *s, const options *list, int k,
                      int16_t *restrict off, int16_t *restrict stray)
{
    const int16_t *part = list->part[k], *rest = list->rest[k];
    const int16_t *to_u = list->to_u, *to_v = list->to_v;
    const int16_t drift = s->drift[k], by = (int16_t)(1 << s->drop);
    for (uint32_t i = 0; i < list->count; i++) {
        const int16_t mean = scaled_by(part[i], to_u[i]);
        const int16_t sum = (int16_t)(rest[i] + mean);
        const int16_t v = (int16_t)(scaled_by(sum, to_v[i]) * by);
        const int16_t u = (int16_t)((int16_t)(mean - drift) * by);
        off[i] = (int16_t)(off[i] + square_of(v));
        stray[i] = (int16_t)(stray[i] + square_of(u));
    }
}

static void make_costs(const cutter *s, const int32_t *weight, uint32_t count,
                       int16_t *restrict off, int16_t *restrict stray,
                       int16_t *restrict cost)
{
    const int16_t per = s->per_size, far = s->far;
    const int16_t w0 = (int16_t)(weight[0] >> 2);
    const int16_t w1 = (int16_t)(weight[1] >> 2);
    const int16_t farther = s->newborn ? far : 0;
    for (uint32_t i = 0; i < count; i++) {
        off[i] = term_of(off[i], far, per);
        stray[i] = term_of(stray[i], farther, per);
        cost[i] = (int16_t)(cost[i] + scaled_by((int16_t)(off[i] * 16), w0) +
                            scaled_by((int16_t)(stray[i] * 16), w1));
    }
}

static void weigh(cutter *s)
{
    options *list = s->list;
    const uint32_t inner = list->one_wing, outer = list->count - inner;
    int16_t *off = list->term[0], *stray = list->term[1], *cost = list->cost;
    memset(off, 0, list->count * sizeof *off);
    memset(stray, 0, list->count * sizeof *stray);
    for (int k = 0; k < 3; k++)
        square_up(s, list, k, off, stray);
    make_costs(s, shape_weights(s, false), inner, off, stray, cost);
    if (outer)
        make_costs(s, shape_weights(s, true), outer, off + inner, stray + inner,
                   cost + inner);
    for (uint32_t k = 0; k < list->row_count; k++) {
        const row *r = &list->row[k];
        const uint32_t end = k + 1 < list->row_count ? r[1].lane : list->count;
        for (uint32_t i = r->lane + r->live; i < end; i++)
            list->cost[i] = TAKEN;
    }
}

static uint32_t count_options(const cutter *s)
{
    const uint32_t n = s->n;
    return s->open ? n * (n - 1) / 2 + 2 * n : n * (n - 1);
}

/* ---- coding ---------------------------------------------------------------
 */

static uint32_t cheapest(const options *list)
{
    int16_t least = TAKEN;
    uint32_t i = 0;
    for (uint32_t k = 0; k < list->count; k++)
        least = list->cost[k] < least ? list->cost[k] : least;
    while (list->cost[i] != least)
        i++;
    return i;
}

/* 2^15 x 2^(-i / 16), rounded. */
static const uint32_t part_of[16] = {
    32768, 31379, 30048, 28774, 27554, 26386, 25268, 24196,
    23170, 22188, 21247, 20347, 19484, 18658, 17867, 17109,
};

/* 2^(-cost) of every option, the least cost as 2^15. */
static void make_shares(options *list, int32_t least)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        uint32_t over = (uint32_t)(list->cost[i] - least);
        over = over < 64 * 16 ? over : 64 * 16; /* for a share of 0 */
        const uint32_t share = part_of[over / 4 % 16] >> over / 64;
        list->share[i] = (uint16_t)share;
        sum += share;
    }
    list->share_sum = sum;
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
 * cheapest left" is asked in the context of that option's odds. */
static uint32_t code_rank(cutter *s, pmesh_codec *c, pmesh_coder *coder,
                          uint32_t truth)
{
    options *list = s->list;
    const uint32_t count = count_options(s);
    uint32_t best = cheapest(list);
    make_shares(list, list->cost[best]);
    uint32_t sum = list->share_sum;
    for (uint32_t rank = 0; rank + 1 < count; rank++) {
        pmesh_bit *m =
            &c->models.cut[s->open]
                          [rank < PMESH_CUT_RANKS ? rank : PMESH_CUT_RANKS - 1]
                          [odds_class(list->share[best], sum)];
        if (!pmesh_code_bit(coder, m, best != truth))
            break;
        list->cost[best] = TAKEN;
        sum -= list->share[best];
        best = cheapest(list);
    }
    return best;
}

/* ---- learning -------------------------------------------------------------
 */

static void adjust(int32_t *weight, int32_t change, int32_t largest)
{
    *weight = within(*weight - change, largest);
}

/* Of each option: 0 less its share, 1 for the true one; takes the room of
 * costs. */
static void make_errors(options *list, uint32_t truth)
{
    const uint16_t per_sum =
        (uint16_t)(((uint32_t)ERROR_ONE << 16) / list->share_sum);
    int16_t *restrict error = list->cost;
    const uint16_t *restrict share = list->share;
    for (uint32_t i = 0; i < list->count; i++)
        error[i] = (int16_t)(0 - (int32_t)((uint32_t)share[i] * per_sum >> 16));
    error[truth] = (int16_t)(error[truth] + ERROR_ONE);
}

static void learn_shape(options *list, int32_t *weight, uint32_t begin,
                        uint32_t end)
{
    for (int t = 0; t < PMESH_CUT_TERMS; t++) {
        int32_t sum = 0;
        for (uint32_t i = begin; i < end; i++)
            sum += list->cost[i] * list->term[t][i];
        adjust(&weight[t], sum / LEARN_SHAPE, LARGEST_SHAPE);
    }
}

static void learn_row(cutter *s, const row *r)
{
    const int16_t *error = s->list->cost + r->lane;
    if (r->wings == BOTH) {
        int16_t *restrict a = s->wing_error[0];
        int16_t *restrict b = s->wing_error[1] + r->span;
        int32_t all = 0;
        const uint32_t lanes = padded(r->live);
        for (uint32_t i = 0; i < lanes; i++) {
            a[i] = (int16_t)(a[i] + error[i]);
            b[i] = (int16_t)(b[i] + error[i]);
            all += error[i];
        }
        adjust(span_weight(s, false, r->span), all, LARGEST_PLACE);
        return;
    }
    const int side = r->wings == B_ONLY;
    for (uint32_t i = 0; i < r->live; i++) {
        s->wing_error[side][i] = (int16_t)(s->wing_error[side][i] + error[i]);
        adjust(span_weight(s, true, side ? i : s->n - 1 - i), error[i],
               LARGEST_PLACE);
    }
}

static void learn_wings(cutter *s)
{
    int32_t reach = 0;
    for (uint32_t i = 0; i < s->n; i++)
        for (int side = 0; side < 2; side++) {
            const int16_t *error = s->wing_error[side];
            const int32_t e = error[i] + (s->open ? 0 : error[i + s->n]);
            adjust(s->degree[side][i], e, LARGEST_PLACE);
            adjust(s->state[side][i], e, LARGEST_PLACE);
            reach += e * s->reach[i];
        }
    adjust(&s->weights->reach[s->open][s->newborn > 0], reach / LEARN_SHAPE,
           LARGEST_SHAPE);
}

/* One step down the gradient of the true cut's code length, as if it had been
 * coded by the shares. */
static void learn(cutter *s, uint32_t truth)
{
    options *list = s->list;
    make_errors(list, truth);
    learn_shape(list, shape_weights(s, false), 0, list->one_wing);
    if (s->open)
        learn_shape(list, shape_weights(s, true), list->one_wing, list->count);
    for (int side = 0; side < 2; side++)
        memset(s->wing_error[side], 0, (2 * s->n + LANES) * sizeof(int16_t));
    for (uint32_t k = 0; k < list->row_count; k++)
        learn_row(s, &list->row[k]);
    learn_wings(s);
}

/* ---- between cuts and options ---------------------------------------------
 */

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
    s.list = (options *)c->cut_room;
    place_points(&s, c, v, ring);
    sum_up(&s);
    weigh_wings(&s, c, ring);
    list_options(&s);
    weigh(&s);
    const uint32_t truth =
        code_rank(&s, c, coder, coder->encoding ? find(&s, cut) : 0);
    learn(&s, truth);
    *cut = cut_of(&s, truth);
}
