/* SPDX-License-Identifier: MIT */
#include "encoder/enc_collect.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_wedges.h"

/* Parallel pairs are not preferred if they cost so many times the median. */
#define PARALLEL_LIMIT 30.0

/* Sheets are joined from where this share of the vertices wants it. */
#define SHEETS_SHARE 0.5

enum { PROGRESS_INTERVAL = 1 << 16 };

void enc_run_progress(enc_run *run, uint32_t seen)
{
    const pmesh_encoder_config *config = run->config;
    const double all = run->mesh->face_count;
    const uint32_t before = run->tick;

    run->tick += seen;
    if (!config->progress ||
        (before > 0 &&
         before / PROGRESS_INTERVAL == run->tick / PROGRESS_INTERVAL))
        return;
    const double done =
        (all - run->surface.face_count) / (all - run->face_target + 1);
    if (config->progress(config->progress_user, "contract", done) != 0)
        run->cancelled = true;
}

enc_pair enc_run_pair(const enc_run *run, uint32_t h, bool back)
{
    const uint32_t edges = 3 * run->mesh->face_count;
    enc_pair pair;
    if (h < edges) {
        pair = enc_surface_pair(&run->surface, h, back);
    } else {
        const uint32_t *end = run->near.pair[h - edges];
        pair = (enc_pair){ end[back], end[!back], ENC_NONE, ENC_NONE };
    }
    if (run->edge_state[h] & GENERAL)
        pair.left = pair.right = ENC_NONE;
    return pair;
}

static enc_entry entry_of(uint8_t state, uint32_t h, bool back,
                          const enc_offer *offer)
{
    const uint32_t last = unclean(state, back) ? ENC_KEY_LAST : 0;
    const uint32_t key = offer->cost < INFINITY ? last | enc_key(offer->cost)
                                                : UINT32_MAX;
    return (enc_entry){ key, enc_entry_id(h, back) };
}

enc_entry enc_run_entry(const enc_run *run, uint32_t h, bool back,
                        double *quadric)
{
    const enc_pair pair = enc_run_pair(run, h, back);
    const enc_offer offer =
        enc_pricing_estimate(&run->pricing, &run->surface, &pair);

    *quadric = offer.quadric;
    return entry_of(run->edge_state[h], h, back, &offer);
}

/* A vertex with several fans is not what signatures are for. */
static bool is_signed(const enc_run *run)
{
    return run->pricing.sign && !run->surface.fan;
}

static bool can_join(const enc_run *run, uint32_t h)
{
    const enc_surface *s = &run->surface;
    return is_signed(run)
               ? enc_surface_can_join_signed(s, run->pricing.sign, h)
               : enc_surface_can_join(s, h);
}

/* What the edge of h may do. */
static uint8_t examine_edge(const enc_run *run, uint32_t h)
{
    const enc_surface *s = &run->surface;
    if (!can_join(run, h))
        return 0;
    const bool start_outer = enc_on_boundary(s, s->vertex[h]);
    const bool end_outer = enc_on_boundary(s, s->vertex[enc_next(h)]);

    /* The boundary keeps its vertices unless contracted along itself. */
    unsigned state = (!start_outer || end_outer ? MAY_FORTH : 0) |
                     (!end_outer || start_outer ? MAY_BACK : 0);
    if (s->wedge) {
        const enc_pair forth = enc_surface_pair(s, h, false);
        const enc_pair back = enc_surface_pair(s, h, true);
        if ((state & MAY_FORTH) && !enc_wedges_clean(s, &forth))
            state |= UNCLEAN_FORTH;
        if ((state & MAY_BACK) && !enc_wedges_clean(s, &back))
            state |= UNCLEAN_BACK;
    }
    return (uint8_t)state;
}

static uint8_t examine_general(const enc_surface *s, uint32_t u, uint32_t v)
{
    const bool u_outer = enc_on_boundary(s, u), v_outer = enc_on_boundary(s, v);
    enc_link link;
    if (!enc_join_link(s, u, v, &link))
        return 0;
    return (uint8_t)(
        GENERAL |
        ((!u_outer || v_outer) && !link.held[0] ? MAY_FORTH : 0) |
        ((!v_outer || u_outer) && !link.held[1] ? MAY_BACK : 0));
}

bool enc_run_has_to_stay(const enc_run *run, uint32_t v)
{
    const enc_guide *guide = run->mesh->guide;
    if (!run->segment_size)
        return false;
    return run->segment_size[guide->segment[v]] - 1 <
           guide->share[guide->segment[v]] * (run->surface.vertex_count - 1);
}

/* The subset placement has two places to choose from: the direction that leads
 * away from the constraints, if one does. */
static unsigned steer(const enc_run *run, const enc_pair *forth)
{
    double pull[2];

    enc_pricing_ends(&run->pricing, &run->surface, forth, pull);
    return pull[0] > pull[1] + ENC_CONTENT   ? MAY_FORTH
           : pull[1] > pull[0] + ENC_CONTENT ? MAY_BACK
                                             : 0;
}

/* What the guide leaves of the directions of a pair. */
static uint8_t guided_state(const enc_run *run, uint32_t h, uint8_t state)
{
    const enc_guide *guide = run->mesh->guide;

    if (!guide->lock && !guide->segment && !guide->pull)
        return state;
    run->edge_state[h] = state; /* of which enc_run_pair() takes the kind */
    const enc_pair pair = enc_run_pair(run, h, false);
    const unsigned allowed =
        enc_guide_directions(guide, pair.child, pair.parent);
    unsigned lost = (allowed & ENC_GUIDE_FORTH ? 0 : MAY_FORTH) |
                    (allowed & ENC_GUIDE_BACK ? 0 : MAY_BACK);
    /* The parent is of its segment. */
    if (enc_run_has_to_stay(run, pair.child))
        lost |= MAY_FORTH | MAY_BACK;
    if (run->pricing.pull && run->pricing.placement == PMESH_SUBSET &&
        (run->pricing.pulled[pair.child] || run->pricing.pulled[pair.parent]) &&
        (state & ~lost & (MAY_FORTH | MAY_BACK)) == (MAY_FORTH | MAY_BACK))
        lost |= steer(run, &pair);
    return (uint8_t)(state & ~lost);
}

static void queue_pair(enc_run *run, uint32_t h, uint8_t state)
{
    enc_entry best = { UINT32_MAX, 0 };
    double quadric = 0;

    if (run->mesh->guide && state)
        state = guided_state(run, h, state);
    run->edge_state[h] = state;
    if (may(state, false) && may(state, true)) {
        const enc_pair forth = enc_run_pair(run, h, false);
        const enc_pair ways[2] = { forth, enc_pair_back(forth) };
        enc_offer offer[2];
        enc_pricing_estimate_both(&run->pricing, &run->surface, ways, offer);
        const enc_entry entry[2] = { entry_of(state, h, false, &offer[0]),
                                     entry_of(state, h, true, &offer[1]) };
        const bool back = entry[1].key < entry[0].key;
        best = entry[back];
        quadric = offer[back].quadric;
    } else if (may(state, false) || may(state, true)) {
        best = enc_run_entry(run, h, may(state, true), &quadric);
    }
    if (best.key < UINT32_MAX) {
        enc_queue_add(&run->queue, best);
        enc_quantile_add(&run->quadrics, quadric);
    }
}

/* Of a joined mesh, what the rules for manifolds forbid may still do. */
static void queue_edge(enc_run *run, uint32_t h)
{
    const enc_surface *s = &run->surface;
    const bool general = s->fan && enc_join_is_general(s, h);
    uint8_t state = general ? 0 : examine_edge(run, h);
    if (s->fan && state == 0 && enc_join_is_lowest(s, h))
        state = examine_general(s, s->vertex[h], s->vertex[enc_next(h)]);
    queue_pair(run, h, state);
}

/* Where a vertex of the mesh is now. */
static uint32_t survivor(const enc_run *run, uint32_t v)
{
    const enc_schedule *out = run->out;
    while (out->vertex_end[v] != ENC_NONE)
        v = out->contraction[out->vertex_end[v]].parent;
    return v;
}

/* True if v and w have an edge. */
static bool are_linked(const enc_surface *s, uint32_t v, uint32_t w)
{
    uint32_t start = s->first[v];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
        if (s->vertex[enc_next(h)] == w || s->vertex[enc_prev(h)] == w)
            return true;
    return false;
}

/* Those by distance are followed to where they went; those between sheets are
 * made anew, if it is time for them. */
static void queue_near(enc_run *run)
{
    enc_surface *s = &run->surface;
    enc_near *near = &run->near;
    near->count = run->within;
    for (uint32_t i = 0; i < run->within; i++)
        for (int k = 0; k < 2; k++)
            near->pair[i][k] = survivor(run, near->pair[i][k]);
    run->starved = enc_near_sheets(s, near) != PMESH_OK;
    if (near->count - run->within > SHEETS_SHARE * s->vertex_count)
        run->joins_sheets = true;
    if (!run->joins_sheets)
        near->count = run->within;
    for (uint32_t i = 0; i < near->count; i++) {
        const uint32_t v = near->pair[i][0], w = near->pair[i][1];
        if (v != w && !are_linked(s, v, w))
            queue_pair(run, 3 * run->mesh->face_count + i,
                       examine_general(s, v, w));
    }
}

/* ---- blocks ---- */

/* What a worker takes for the run: all that it writes is its own, but for the
 * states of edges, which nobody else looks at meanwhile. */
static enc_run *view_of(enc_run *run, unsigned worker)
{
    return worker == 0 ? run : &run->views[worker - 1];
}

static void open_views(enc_run *run, unsigned workers)
{
    for (unsigned i = 1; i < workers; i++) {
        enc_run *view = view_of(run, i);
        const enc_scratch *own = &run->scratch[i - 1];
        *view = *run;
        view->pricing.looks.fate = own->fate;
    }
}

static void close_views(enc_run *run, unsigned workers)
{
    for (unsigned i = 1; i < workers; i++)
        enc_quantile_merge(&run->quadrics, &view_of(run, i)->quadrics);
}

static void collect_block(void *user, uint32_t part, unsigned worker)
{
    enc_run *run = view_of(user, worker);
    enc_surface *s = &run->surface;
    enc_block *block = &run->pricing.block[part];
    const uint32_t end = enc_block_end(s->mesh, part);

    run->queue.list_count = block->entry;
    for (uint32_t v = part * ENC_BLOCK; v < end; v++) {
        uint32_t start = s->first[v];
        if (start == ENC_NONE)
            continue;
        for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
            if (h < s->twin[h]) /* ENC_NONE is the largest */
                queue_edge(run, h);
    }
    block->count = run->queue.list_count - block->entry;
    if (worker == 0)
        enc_run_progress(run, end - part * ENC_BLOCK);
}

/* A block has room for all its edges, so there are gaps. */
static void close_gaps(enc_run *run)
{
    enc_entry *list = run->queue.list;
    uint32_t count = 0;

    for (uint32_t i = 0; i < enc_blocks(run->mesh); i++) {
        const enc_block *block = &run->pricing.block[i];
        if (block->entry != count)
            memmove(list + count, list + block->entry,
                    block->count * sizeof *list);
        count += block->count;
    }
    run->queue.list_count = count;
}

void enc_collect(enc_run *run, double guard)
{
    enc_pool *pool = enc_surface_pool(&run->surface);
    const unsigned workers = enc_pool_workers(pool);
    uint32_t room = 0;

    enc_queue_clear(&run->queue);
    enc_quantile_clear(&run->quadrics);
    for (uint32_t i = 0; i < enc_blocks(run->mesh); i++) {
        run->pricing.block[i].entry = room;
        room += run->pricing.block[i].edges;
    }
    open_views(run, workers);
    enc_pool_run(pool, enc_blocks(run->mesh), collect_block, run);
    close_views(run, workers);
    close_gaps(run);
    if (run->surface.fan)
        queue_near(run);
    enc_queue_sort(&run->queue);
    run->parallel_limit = PARALLEL_LIMIT * enc_queue_median(&run->queue);
    run->guard = enc_quantile_at(&run->quadrics, guard);
}
