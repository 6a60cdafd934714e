/* SPDX-License-Identifier: MIT */
/* SPEC 6.4: cuts, ranked by a cost that learns. */
#include "tests/reference/ref.h"

#include <math.h>

typedef struct option {
    ref_cut cut;
    int span;
    int64_t term[5], cost, share;
    int32_t *place[5]; /* weights that hold for this option */
    int places;
} option;

typedef struct options {
    const ref *r;
    const ref_ring *ring;
    bool newborn; /* is a neighbour? */
    ref_vec x[REF_MEMBERS], drift;
    int64_t square[REF_MEMBERS]; /* |x|^2 */
    int64_t per;
    int count;
    option option[REF_MEMBERS * REF_MEMBERS];
} options;

/* ---- the list ----------------------------------------------------------- */

static void list_one(options *o, int first, int end, int span)
{
    o->option[o->count++] = (option){ .cut = { first, end }, .span = span };
}

static void list_options(options *o)
{
    const int n = o->ring->count;
    o->count = 0;
    for (int span = 1; span < n; span++)
        for (int first = 0; first < n; first++) {
            if (first + span < n)
                list_one(o, first, first + span, span);
            else if (!o->ring->open)
                list_one(o, first, first + span - n, span);
        }
    for (int i = 0; o->ring->open && i < n; i++)
        list_one(o, i, REF_GHOST_WING, n - 1 - i);
    for (int i = 0; o->ring->open && i < n; i++)
        list_one(o, REF_GHOST_WING, i, i);
}

/* ---- geometry ----------------------------------------------------------- */

static void scale_ring(options *o, uint32_t v)
{
    const ref *r = o->r;
    const int n = o->ring->count;
    const ref_vec at = r->vertex[v].at;
    uint64_t all = 0;
    for (int i = 0; i < n; i++) {
        o->x[i] = ref_sub(r->vertex[o->ring->vertex[i]].at, at);
        all |= ref_or(o->x[i]);
    }
    const int s = 13 - ref_bits((uint64_t)n) - ref_bits(all);
    ref_vec drift = { 0 };
    int64_t newborn = 0, sum = 0;
    for (int i = 0; i < n; i++) {
        const ref_vertex *z = &r->vertex[o->ring->vertex[i]];
        o->x[i] = ref_vscale(o->x[i], s);
        o->square[i] = ref_dot(o->x[i], o->x[i]);
        sum += o->square[i];
        if (z->state == REF_NEWBORN) {
            newborn++;
            drift = ref_add(drift,
                            ref_sub(z->at, r->vertex[z->parent].at));
        }
    }
    o->newborn = newborn > 0;
    if (o->newborn)
        o->drift =
            ref_vwithin(ref_over(ref_vscale(drift, s), newborn), 1 << 13);
    const int64_t size = sum / n;
    o->per = (1 << 27) / (size > 1 << 15 ? size : 1 << 15);
}

static int64_t cut_term(const options *o, int64_t square)
{
    const int64_t t = ref_shift(ref_shift(square, 10) * o->per, 9);
    return ref_within(t, 32767);
}

static void set_terms(const options *o, option *p)
{
    const int n = o->ring->count;
    const int from = p->cut.first == REF_GHOST_WING ? 0 : p->cut.first;
    const ref_vec zero = { 0 };
    const bool wing_a = p->cut.first != REF_GHOST_WING;
    const bool wing_b = p->cut.end != REF_GHOST_WING;
    const ref_vec xa = wing_a ? o->x[p->cut.first] : zero;
    const ref_vec xb = wing_b ? o->x[p->cut.end] : zero;
    ref_vec all = zero, part = zero;
    int64_t squares = 0;
    for (int i = 0; i < n; i++)
        all = ref_add(all, o->x[i]);
    for (int i = 0; i <= p->span; i++) {
        part = ref_add(part, o->x[(from + i) % n]);
        squares += o->square[(from + i) % n];
    }
    const int64_t inside = 32768 / (p->span + 2);
    const int64_t outside = 32768 / (n - p->span + wing_a + wing_b);
    const ref_vec mean = ref_vshift(ref_times(part, inside), 15);
    ref_vec rest = ref_sub(all, part);
    rest = ref_add(ref_add(rest, xa), ref_add(xb, mean));
    rest = ref_vshift(ref_times(rest, outside), 15);
    const int64_t spread = ref_shift(ref_shift(squares, 9) * inside, 6);
    const ref_vec off = ref_sub(mean, o->drift);
    p->term[0] = cut_term(o, spread - ref_dot(mean, mean));
    p->term[1] = cut_term(o, ref_dot(rest, rest));
    p->term[2] = cut_term(o, ref_dot(xa, xa) + ref_dot(xb, xb));
    p->term[3] = cut_term(o, ref_dot(xa, xb));
    p->term[4] = o->newborn ? cut_term(o, ref_dot(off, off)) : 0;
}

/* ---- cost --------------------------------------------------------------- */

static int state_at(const options *o, int i)
{
    const int n = o->ring->count;
    if (o->ring->open && (i < 0 || i >= n))
        return REF_GHOST;
    return o->r->vertex[o->ring->vertex[(i + n) % n]].state;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* Wing i on a side: 0 looks forward around the ring, 1 back. */
static void add_wing(ref_cut_models *m, const options *o, option *p, int side,
                     int i)
{
    const int step = side == 0 ? 1 : -1;
    const uint32_t degree = ref_degree(o->r, o->ring->vertex[i]);
    p->place[p->places++] = &m->degree[side][degree < 11 ? degree : 11];
    p->place[p->places++] =
        &m->state[side][state_at(o, i - step)][state_at(o, i)]
                 [state_at(o, i + step)];
}

static bool has_ghost(const option *p)
{
    return p->cut.first == REF_GHOST_WING || p->cut.end == REF_GHOST_WING;
}

static int32_t *shape_of(ref_cut_models *m, const options *o, const option *p)
{
    const int g = has_ghost(p) ? 2 : o->ring->open ? 1 : 0;
    return m->shape[g][o->newborn];
}

static void set_cost(ref_cut_models *m, const options *o, option *p)
{
    const int32_t *w = shape_of(m, o, p);
    int64_t sum = 0, place = 0;
    p->place[p->places++] =
        &m->span[has_ghost(p)][least(o->ring->count, 13)][least(p->span, 9)];
    if (p->cut.first != REF_GHOST_WING)
        add_wing(m, o, p, 0, p->cut.first);
    if (p->cut.end != REF_GHOST_WING)
        add_wing(m, o, p, 1, p->cut.end);
    for (int t = 0; t < 5; t++)
        sum += ref_shift(w[t], 4) * p->term[t];
    for (int i = 0; i < p->places; i++)
        place += *p->place[i];
    p->cost = ref_shift(ref_shift(sum, 4) + ref_shift(place, 4), 8);
}

/* PART[i], the nearest integer of 65536 x 2^(-i / 16); no power is near a half,
 * so any machine's pow() gives it. */
static int64_t part_of(int i)
{
    return (int64_t)floor(65536 * pow(2, -i / 16.0) + 0.5);
}

static int64_t set_shares(options *o)
{
    int64_t lowest = o->option[0].cost, sum = 0;
    for (int i = 1; i < o->count; i++)
        if (o->option[i].cost < lowest)
            lowest = o->option[i].cost;
    for (int i = 0; i < o->count; i++) {
        const int64_t e = o->option[i].cost - lowest;
        o->option[i].share =
            e >= 272 ? 0 : part_of((int)(e % 16)) / ((int64_t)1 << e / 16);
        sum += o->option[i].share;
    }
    return sum;
}

/* ---- the choice --------------------------------------------------------- */

static int height(int64_t x)
{
    return x > 0 ? ref_bits((uint64_t)x * (uint64_t)x) - 1 : 0;
}

static int read_rank(ref *r, const options *o, int64_t left)
{
    bool taken[REF_MEMBERS * REF_MEMBERS] = { 0 };
    for (int rank = 0;; rank++) {
        int best = -1;
        for (int i = 0; i < o->count; i++)
            if (!taken[i] &&
                (best < 0 || o->option[i].cost < o->option[best].cost))
                best = i;
        if (rank == o->count - 1) {
            REF_SEEN(cut_only_one_left);
            return best;
        }
        const int64_t share = o->option[best].share;
        if (share == 0)
            REF_SEEN(cut_share_0);
        const int k = (int)ref_clamp(
            height(share) - height(left - share) + 12, 0, 31);
        if (rank > 3)
            REF_SEEN(cut_rank_above_3);
        if (!ref_bit(&r->in, &r->cut.rank[o->ring->open][least(rank, 3)][k]))
            return best;
        left -= share;
        taken[best] = true;
    }
}

static void learn(ref_cut_models *m, const options *o, int chosen, int64_t sum)
{
    for (int i = 0; i < o->count; i++) {
        const option *p = &o->option[i];
        const int64_t error =
            (i == chosen ? 4096 : 0) -
            ref_shift(p->share * (((int64_t)1 << 40) / sum), 28);
        if (error < 4 && error > -4)
            continue;
        int32_t *w = shape_of(m, o, p);
        for (int t = 0; t < 5; t++)
            w[t] = (int32_t)ref_within(w[t] - error * p->term[t] / 512,
                                       1 << 17);
        for (int k = 0; k < p->places; k++)
            *p->place[k] =
                (int32_t)ref_within(*p->place[k] - error, 1 << 26);
    }
}

ref_cut ref_read_cut(ref *r, uint32_t v, const ref_ring *ring)
{
    static options o; /* half a megabyte */
    o.r = r;
    o.ring = ring;
    o.drift = (ref_vec){ 0 };
    list_options(&o);
    scale_ring(&o, v);
    for (int i = 0; i < o.count; i++) {
        set_terms(&o, &o.option[i]);
        set_cost(&r->cut, &o, &o.option[i]);
    }
    if (o.newborn)
        REF_SEEN(cut_drift);
    const int64_t sum = set_shares(&o);
    const int chosen = read_rank(r, &o, sum);
    learn(&r->cut, &o, chosen, sum);
    return o.option[chosen].cut;
}
