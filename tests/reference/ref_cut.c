/* SPDX-License-Identifier: MIT */
/* SPEC 6.4: cuts, ranked by a cost that learns. */
#include "tests/reference/ref.h"

typedef struct option {
    ref_cut cut;
    int span;
    int64_t term[2], cost, share;
} option;

typedef struct options {
    const ref *r;
    const ref_ring *ring;
    bool newborn; /* is a neighbour? */
    int b;        /* bits(n) */
    ref_vec y[REF_MEMBERS], x[REF_MEMBERS], drift;
    int64_t reach[REF_MEMBERS]; /* T(y) */
    int64_t per, far;
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

static int64_t sq(ref_vec v)
{
    int64_t sum = 0;
    for (int k = 0; k < 3; k++)
        sum += ref_shift(v.c[k] * v.c[k], 16);
    return sum;
}

static int64_t cut_term(const options *o, ref_vec v)
{
    const int64_t square = sq(v);
    return ref_shift((square < o->far ? square : o->far) * o->per, 16);
}

static void set_drift(options *o, int s)
{
    ref_vec sum = { 0 };
    int64_t newborn = 0;
    for (int i = 0; i < o->ring->count; i++) {
        const ref_vertex *z = &o->r->vertex[o->ring->vertex[i]];
        if (z->state != REF_NEWBORN)
            continue;
        newborn++;
        sum = ref_add(sum, ref_sub(z->at, o->r->vertex[z->parent].at));
    }
    o->newborn = newborn > 0;
    if (!o->newborn)
        return;
    sum = ref_vwithin(ref_vscale(sum, s), newborn << 13);
    o->drift = ref_vshift(ref_vshare(sum, newborn), o->b);
}

static void scale_ring(options *o, uint32_t v)
{
    const ref *r = o->r;
    const int n = o->ring->count;
    uint64_t all = 0;
    int64_t sum = 0;
    o->b = ref_bits((uint64_t)n);
    for (int i = 0; i < n; i++) {
        o->y[i] = ref_sub(r->vertex[o->ring->vertex[i]].at, r->vertex[v].at);
        all |= ref_or(o->y[i]);
    }
    const int s = 14 - ref_bits(all);
    for (int i = 0; i < n; i++) {
        o->y[i] = ref_vscale(o->y[i], s);
        o->x[i] = ref_vshift(o->y[i], o->b);
        sum += sq(o->y[i]);
    }
    const int64_t size = ref_share(sum, n) > 513 ? ref_share(sum, n) : 513;
    o->per = (1 << 24) / size;
    o->far = 2047 * size / 256;
    if (o->far > 32767)
        o->far = 32767;
    for (int i = 0; i < n; i++)
        o->reach[i] = cut_term(o, o->y[i]);
    set_drift(o, s);
}

static int64_t part_in(int64_t k)
{
    return 65536 / k < 32767 ? 65536 / k : 32767;
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
    for (int i = 0; i < n; i++)
        all = ref_add(all, o->x[i]);
    for (int i = 0; i <= p->span; i++)
        part = ref_add(part, o->x[(from + i) % n]);
    const ref_vec mean = ref_vshift(ref_times(part, part_in(p->span + 2)), 16);
    ref_vec rest = ref_sub(all, part);
    rest = ref_add(ref_add(rest, xa), ref_add(xb, mean));
    rest =
        ref_vshift(ref_times(rest, part_in(n - p->span + wing_a + wing_b)), 16);
    const int64_t up = (int64_t)1 << o->b;
    p->term[0] = cut_term(o, ref_times(rest, up));
    p->term[1] = 0;
    if (o->newborn)
        p->term[1] = cut_term(o, ref_times(ref_sub(mean, o->drift), up));
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

static int32_t *degree_of(ref_cut_models *m, const options *o, int side, int i)
{
    const uint32_t degree = ref_degree(o->r, o->ring->vertex[i]);
    return &m->degree[degree < 11 ? degree : 11][side];
}

static int32_t *states_of(ref_cut_models *m, const options *o, int side, int i)
{
    return &m->state[state_at(o, i - 1)][state_at(o, i)][state_at(o, i + 1)]
                    [side];
}

static bool has_ghost(const option *p)
{
    return p->cut.first == REF_GHOST_WING || p->cut.end == REF_GHOST_WING;
}

static int32_t *span_of(ref_cut_models *m, const options *o, const option *p)
{
    return &m->span[has_ghost(p)][least(o->ring->count, 13)][least(p->span, 9)];
}

static int wings_kind(const options *o, const option *p)
{
    return has_ghost(p) ? 2 : o->ring->open ? 1 : 0;
}

static int64_t wing_cost(ref_cut_models *m, const options *o, int side, int i)
{
    const int64_t reach =
        ref_shift(m->reach[o->ring->open][o->newborn], 4) * o->reach[i];
    const int64_t sum =
        reach + *degree_of(m, o, side, i) + *states_of(m, o, side, i);
    return ref_within(ref_shift((int32_t)(uint32_t)sum, 10), 5000);
}

static void set_cost(ref_cut_models *m, const options *o, option *p)
{
    const int32_t *w = m->shape[wings_kind(o, p)][o->newborn];
    p->cost = ref_within(ref_shift(*span_of(m, o, p), 10), 5000);
    if (p->cut.first != REF_GHOST_WING)
        p->cost += wing_cost(m, o, 0, p->cut.first);
    if (p->cut.end != REF_GHOST_WING)
        p->cost += wing_cost(m, o, 1, p->cut.end);
    for (int t = 0; t < 2; t++)
        p->cost += ref_shift(ref_shift(w[t], 2) * 16 * p->term[t], 16);
}

static int64_t share_of(int64_t e)
{
    int64_t u = 65535 - 44 * (e < 1024 ? e : 1024);
    for (int i = 0; i < 4; i++)
        u = u * u / 65536;
    return u / 2;
}

static int64_t set_shares(options *o)
{
    int64_t lowest = o->option[0].cost, sum = 0;
    for (int i = 1; i < o->count; i++)
        if (o->option[i].cost < lowest)
            lowest = o->option[i].cost;
    for (int i = 0; i < o->count; i++) {
        o->option[i].share = share_of(o->option[i].cost - lowest);
        sum += o->option[i].share;
    }
    return sum;
}

/* ---- the choice --------------------------------------------------------- */

static int height(int64_t x)
{
    return x > 0 ? ref_bits((uint64_t)x * (uint64_t)x) - 1 : 0;
}

/* `plain`: the cheapest it is, with good odds. */
static int read_rank(ref *r, const options *o, int64_t left, bool *plain)
{
    bool taken[REF_MEMBERS * REF_MEMBERS] = { 0 };
    *plain = false;
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
        const int k =
            (int)ref_clamp(height(share) - height(left - share) + 12, 0, 31);
        if (rank > 3)
            REF_SEEN(cut_rank_above_3);
        if (!ref_bit(&r->in, &r->cut.rank[o->ring->open][least(rank, 3)][k])) {
            *plain = rank == 0 && k >= 13;
            return best;
        }
        left -= share;
        taken[best] = true;
    }
}

/* ---- learning ----------------------------------------------------------- */

static void change(int32_t *weight, int64_t by)
{
    *weight = (int32_t)(uint32_t)(*weight - by); /* modulo 2^32 */
}

static void change_within(int32_t *weight, int64_t by)
{
    *weight = (int32_t)ref_within(*weight - by, 65535);
}

static void learn_shape(ref_cut_models *m, const options *o,
                        const int64_t *error)
{
    for (int g = 0; g < 3; g++)
        for (int t = 0; t < 2; t++) {
            int64_t sum = 0;
            for (int i = 0; i < o->count; i++)
                if (wings_kind(o, &o->option[i]) == g)
                    sum += error[i] * o->option[i].term[t];
            change_within(&m->shape[g][o->newborn][t], sum / 512);
        }
}

static void learn_spans(ref_cut_models *m, const options *o,
                        const int64_t *error)
{
    for (int span = 1; span < o->ring->count; span++) {
        const option *any = NULL;
        int64_t sum = 0;
        for (int i = 0; i < o->count; i++) {
            const option *p = &o->option[i];
            if (has_ghost(p) || p->span != span)
                continue;
            sum += error[i];
            any = p;
        }
        if (any)
            change(span_of(m, o, any), sum);
    }
    for (int i = 0; i < o->count; i++)
        if (has_ghost(&o->option[i]))
            change(span_of(m, o, &o->option[i]), error[i]);
}

static void learn_wings(ref_cut_models *m, const options *o,
                        const int64_t *error)
{
    int64_t reach = 0;
    for (int i = 0; i < o->ring->count; i++)
        for (int side = 0; side < 2; side++) {
            int64_t sum = 0;
            for (int k = 0; k < o->count; k++) {
                const ref_cut *cut = &o->option[k].cut;
                if ((side == 0 ? cut->first : cut->end) == i)
                    sum += error[k];
            }
            change(degree_of(m, o, side, i), sum);
            change(states_of(m, o, side, i), sum);
            reach += sum * o->reach[i];
        }
    change_within(&m->reach[o->ring->open][o->newborn], reach / 512);
}

static void learn(ref_cut_models *m, const options *o, int chosen, int64_t sum)
{
    int64_t error[REF_MEMBERS * REF_MEMBERS];
    for (int i = 0; i < o->count; i++)
        error[i] =
            (i == chosen ? 4096 : 0) -
            ref_shift(o->option[i].share * (((int64_t)1 << 28) / sum), 16);
    learn_shape(m, o, error);
    learn_spans(m, o, error);
    learn_wings(m, o, error);
}

ref_cut ref_read_cut(ref *r, uint32_t v, const ref_ring *ring)
{
    static options o; /* a tenth of a megabyte */
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
    bool plain;
    const int chosen = read_rank(r, &o, sum, &plain);
    if (plain)
        REF_SEEN(cut_plain);
    else
        learn(&r->cut, &o, chosen, sum);
    return o.option[chosen].cut;
}
