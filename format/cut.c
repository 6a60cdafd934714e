/* SPDX-License-Identifier: MIT */
#include "format/cut.h"

#include "format/tables.h"

enum {
    MAX_CUTS = PMESH_MAX_RING * (PMESH_MAX_RING - 1),
    SHAPE_BITS = 12, /* coordinates are scaled to this magnitude */
    TAKEN = INT32_MAX
};

/* The ring in coordinates relative to v and scaled so that the largest lies in
 * 2^12 .. 2^13: then every sum below stays under 2^46 (SPEC appendix A). */
typedef struct shape {
    uint32_t count;
    bool open;
    int32_t x[PMESH_MAX_RING][3];
    int64_t sum[2 * PMESH_MAX_RING + 1][3]; /* of the first members, twice
                                               round if closed */
    int64_t square[2 * PMESH_MAX_RING + 1];
    int64_t size;        /* mean square distance of the ring from v */
    int64_t drift[3];    /* mean displacement of newborn members ... */
    int32_t drift_count; /* ... if there are any */
    int32_t topology[2][PMESH_MAX_RING]; /* cost of a member as wing a, b */
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
    s->size = s->square[n] / n;
    if (s->size == 0)
        s->size = 1;
}

/* What the states of three consecutive members and the degree of the middle
 * one say about a wing there; a ghost lies before the first and behind the
 * last member of an open ring. */
static void shape_topology(shape *s, const pmesh_codec *c,
                           const pmesh_ring *ring)
{
    const uint32_t n = ring->count;
    uint8_t state[PMESH_MAX_RING + 2];
    for (uint32_t i = 0; i < n; i++)
        state[i + 1] = c->state[ring->vertex[i]];
    state[0] = ring->open ? PMESH_GHOST : state[n];
    state[n + 1] = ring->open ? PMESH_GHOST : state[1];
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t degree = c->degree[ring->vertex[i]];
        const int32_t common =
            pmesh_cut_degree[degree < PMESH_CUT_DEGREES
                                 ? degree : PMESH_CUT_DEGREES - 1];
        s->topology[0][i] =
            common + pmesh_cut_state[state[i]][state[i + 1]][state[i + 2]];
        s->topology[1][i] =
            common + pmesh_cut_state[state[i + 2]][state[i + 1]][state[i]];
    }
}

/* Cost in 1/16 bit, up to a constant, of giving u the members first .. first +
 * span (wings included); `a` and `b` are the wings or PMESH_NONE. */
static int32_t cut_cost(const shape *s, uint32_t first, uint32_t span,
                        uint32_t a, uint32_t b)
{
    const uint32_t n = s->count, last = first + span;
    const int64_t members = span + 2; /* and v itself, which is at 0 */
    int64_t mean[3], rest[3], part[3], wings[2][3] = { { 0 } };
    int64_t off = 0, stray = 0, reach = 0;
    const int64_t others =
        n - span + (a != PMESH_NONE) + (b != PMESH_NONE); /* v's ring after */

    for (int k = 0; k < 3; k++) {
        part[k] = s->sum[last + 1][k] - s->sum[first][k];
        mean[k] = part[k] / members;
        if (a != PMESH_NONE)
            wings[0][k] = s->x[a][k];
        if (b != PMESH_NONE)
            wings[1][k] = s->x[b][k];
        rest[k] = (s->sum[n][k] - part[k] + wings[0][k] + wings[1][k] +
                   mean[k]) / others;
        off += rest[k] * rest[k];
        stray += (mean[k] - s->drift[k]) * (mean[k] - s->drift[k]);
        reach += wings[0][k] * wings[0][k] + wings[1][k] * wings[1][k];
    }
    const int64_t spread =
        (s->square[last + 1] - s->square[first]) / members - dot(mean, mean);

    const bool ghost = a == PMESH_NONE || b == PMESH_NONE;
    const int16_t *w =
        pmesh_cut_shape[ghost ? 2 : s->open ? 1 : 0]
                       [s->drift_count ? 1 : 0];
    int64_t cost = w[0] * spread + w[1] * off + w[2] * reach +
                   w[3] * dot(wings[0], wings[1]);
    if (s->drift_count)
        cost += w[4] * stray;
    cost /= s->size;

    const uint32_t span_class =
        span < PMESH_CUT_SPANS ? span : PMESH_CUT_SPANS - 1;
    const uint32_t ring_class = n < PMESH_CUT_RINGS ? n : PMESH_CUT_RINGS - 1;
    cost += pmesh_cut_span[ghost ? 1 : 0][ring_class][span_class];
    if (a != PMESH_NONE)
        cost += s->topology[0][a];
    if (b != PMESH_NONE)
        cost += s->topology[1][b];
    return (int32_t)cost;
}

/* All legal cuts in a fixed order: by first, then end; the ghost last. */
static uint32_t list_cuts(const shape *s, pmesh_cut *cuts, int32_t *costs)
{
    const uint32_t n = s->count;
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t spans = s->open ? n - 1 - i : n - 1;
        for (uint32_t d = 1; d <= spans; d++) {
            const uint32_t j = i + d < n ? i + d : i + d - n;
            cuts[count] = (pmesh_cut){ i, j };
            costs[count++] = cut_cost(s, i, d, i, j);
        }
    }
    for (uint32_t i = 0; s->open && i < n; i++) {
        cuts[count] = (pmesh_cut){ i, PMESH_NONE };
        costs[count++] = cut_cost(s, i, n - 1 - i, i, PMESH_NONE);
        cuts[count] = (pmesh_cut){ PMESH_NONE, i };
        costs[count++] = cut_cost(s, 0, i, PMESH_NONE, i);
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

/* Logarithmic class of the lead of the cheapest cut over the next. */
static unsigned gap_class(int64_t gap)
{
    unsigned k = 0;
    while (k < PMESH_CUT_GAPS - 1 && gap >= (3 << k >> 1))
        k++;
    return k;
}

void pmesh_cut_code(pmesh_codec *c, pmesh_coder *coder, uint32_t v,
                    const pmesh_ring *ring, pmesh_cut *cut)
{
    shape s;
    pmesh_cut cuts[MAX_CUTS];
    int32_t costs[MAX_CUTS];

    s.count = ring->count;
    s.open = ring->open;
    shape_points(&s, c, v, ring);
    shape_sums(&s);
    shape_topology(&s, c, ring);
    const uint32_t count = list_cuts(&s, cuts, costs);

    uint32_t best = cheapest(costs, count);
    for (uint32_t rank = 0; rank + 1 < count; rank++) {
        const int32_t cost = costs[best];
        costs[best] = TAKEN;
        const uint32_t next = cheapest(costs, count);
        const bool hit = coder->encoding && cuts[best].first == cut->first &&
                         cuts[best].end == cut->end;
        pmesh_bit *m = &c->models.cut[ring->open]
                            [rank < PMESH_CUT_RANKS ? rank
                                                    : PMESH_CUT_RANKS - 1]
                            [gap_class((int64_t)costs[next] - cost)];
        if (!pmesh_code_bit(coder, m, !hit)) {
            *cut = cuts[best];
            return;
        }
        best = next;
    }
    *cut = cuts[best];
}
