/* SPDX-License-Identifier: MIT */
#include "encoder/enc_batch.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_parallel.h"
#include "encoder/enc_wedges.h"

/* What is known of an edge from before the batch, kept at the lower numbered
 * of its half-edges. "Forth" contracts its start into its end. */
enum {
    MAY_FORTH = 1,
    MAY_BACK = 2,
    UNCLEAN_FORTH = 4,
    UNCLEAN_BACK = 8,
    TURNED = 16, /* the second direction has been queued as well */
    GENERAL = 32, /* a pair for enc_join.h */
    LATE = 64     /* may spoil faces, when there is little else */
};

/* Puts a pair parallel to a chosen one before all that are not. */
#define PARALLEL_FACTOR 0.001

/* But not what costs so many times the median. */
#define PARALLEL_LIMIT 30.0

/* An entry whose cost has grown by more than this goes back to the queue. */
#define STALE_FACTOR 1.1

/* Unclean pairs are for meshes that leave no other choice: they come last, and
 * a batch that is full to this share takes none. */
#define CLEAN_SHARE 0.5

/* Sheets are joined from where this share of the vertices wants it. */
#define SHEETS_SHARE 0.5

enum { PROGRESS_INTERVAL = 1 << 16 };

bool enc_run_done(const enc_run *run)
{
    return run->cancelled || run->starved ||
           run->surface.face_count <= run->face_target ||
           run->surface.vertex_count <= run->vertex_target;
}

static void report_progress(enc_run *run)
{
    const pmesh_encoder_config *config = run->config;
    const double all = run->mesh->face_count;

    if (run->tick++ % PROGRESS_INTERVAL != 0 || !config->progress)
        return;
    const double done =
        (all - run->surface.face_count) / (all - run->face_target + 1);
    if (config->progress(config->progress_user, "contract", done) != 0)
        run->cancelled = true;
}

/* An id names a half-edge of the pair and which of its ends is the child. */
static uint32_t entry_id(uint32_t h, bool back)
{
    return h << 1 | (uint32_t)back;
}

static bool may(uint8_t state, bool back)
{
    return state & (back ? MAY_BACK : MAY_FORTH);
}

static bool unclean(uint8_t state, bool back)
{
    return state & (back ? UNCLEAN_BACK : UNCLEAN_FORTH);
}

/* A number h beyond the half-edges stands for a pair without edge. */
static enc_pair pair_of(const enc_run *run, uint32_t h, bool back)
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

/* Its estimated quadric goes to *quadric; the largest key: forbidden. */
static enc_entry make_entry(const enc_run *run, uint32_t h, bool back,
                            double *quadric)
{
    const enc_surface *s = &run->surface;
    const enc_pair pair = pair_of(run, h, back);
    const uint32_t last = unclean(run->edge_state[h], back) ? ENC_KEY_LAST : 0;
    const enc_offer offer = enc_pricing_estimate(&run->pricing, s, &pair);

    *quadric = offer.quadric;
    if (!(offer.cost < INFINITY))
        return (enc_entry){ UINT32_MAX, entry_id(h, back) };
    return (enc_entry){ last | enc_key(offer.cost), entry_id(h, back) };
}

/* What the edge of h may do; the ring of its start is marked. */
static uint8_t examine_edge(const enc_surface *s, uint32_t h)
{
    if (!enc_surface_can_join(s, h))
        return 0;
    const enc_pair forth = enc_surface_pair(s, h, false);
    const enc_pair back = enc_surface_pair(s, h, true);
    const bool start_outer = enc_on_boundary(s, forth.child);
    const bool end_outer = enc_on_boundary(s, forth.parent);
    unsigned state = 0;

    /* The boundary keeps its vertices unless contracted along itself. */
    if (!start_outer || end_outer)
        state |=
            enc_wedges_clean(s, &forth) ? MAY_FORTH : MAY_FORTH | UNCLEAN_FORTH;
    if (!end_outer || start_outer)
        state |=
            enc_wedges_clean(s, &back) ? MAY_BACK : MAY_BACK | UNCLEAN_BACK;
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

/* Without it its segment would have less than its share of what is left. */
static bool has_to_stay(const enc_run *run, uint32_t v)
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
    run->edge_state[h] = state; /* of which pair_of() takes the kind */
    const enc_pair pair = pair_of(run, h, false);
    const unsigned allowed =
        enc_guide_directions(guide, pair.child, pair.parent);
    unsigned lost = (allowed & ENC_GUIDE_FORTH ? 0 : MAY_FORTH) |
                    (allowed & ENC_GUIDE_BACK ? 0 : MAY_BACK);
    if (has_to_stay(run, pair.child)) /* and the parent is of its segment */
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
    double best_quadric = 0;

    if (run->mesh->guide && state)
        state = guided_state(run, h, state);
    run->edge_state[h] = state;
    for (int back = 0; back < 2; back++) {
        if (!may(state, back != 0))
            continue;
        double quadric;
        const enc_entry entry = make_entry(run, h, back, &quadric);
        if (entry.key < best.key) {
            best = entry;
            best_quadric = quadric;
        }
    }
    if (best.key < UINT32_MAX) {
        enc_queue_add(&run->queue, best);
        enc_quantile_add(&run->quadrics, best_quadric);
    }
}

/* Of a joined mesh, what the rules for manifolds forbid may still do. */
static void queue_edge(enc_run *run, uint32_t h)
{
    const enc_surface *s = &run->surface;
    const bool general = s->fan && enc_join_is_general(s, h);
    uint8_t state = general ? 0 : examine_edge(s, h);
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
static bool are_linked(enc_surface *s, uint32_t v, uint32_t w)
{
    enc_surface_mark_ring(s, v);
    return s->mark[w] == s->stamp;
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

static void collect(enc_run *run, const enc_batch_plan *plan)
{
    enc_surface *s = &run->surface;

    enc_queue_clear(&run->queue);
    enc_quantile_clear(&run->quadrics);
    for (uint32_t v = 0; v < run->mesh->vertex_count; v++) {
        uint32_t start = s->first[v];
        if (start == ENC_NONE)
            continue;
        enc_surface_mark_ring(s, v);
        for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
            if (h < s->twin[h]) /* ENC_NONE is the largest */
                queue_edge(run, h);
        report_progress(run);
    }
    if (s->fan)
        queue_near(run);
    enc_queue_sort(&run->queue);
    run->parallel_limit = PARALLEL_LIMIT * enc_queue_median(&run->queue);
    run->guard = enc_quantile_at(&run->quadrics, plan->guard);
}

static bool is_free(const enc_run *run, uint32_t v)
{
    return run->taken[v] != run->out->batch_count + 1;
}

static bool is_stamped(const enc_run *run, uint8_t stamp)
{
    return stamp == run->out->batch_count + 1;
}

static uint32_t wing_of(const enc_surface *s, uint32_t edge)
{
    return s->vertex[enc_prev(edge)];
}

/* See enc_batch.h; the pair's own ends are free. */
static bool general_fits(const enc_run *run, const enc_pair *pair,
                         const enc_link *link)
{
    const enc_role *child = &run->role[pair->child];
    const enc_role *parent = &run->role[pair->parent];
    if (link->count == 0)
        return !is_stamped(run, child->general_wing) &&
               !is_stamped(run, parent->general_wing);
    for (uint32_t i = 0; i < link->count; i++)
        if (!is_free(run, wing_of(&run->surface, link->edge[i])))
            return false;
    return !is_stamped(run, child->wing) && !is_stamped(run, parent->wing);
}

static bool simple_fits(const enc_run *run, const enc_pair *pair)
{
    const uint32_t edge[2] = { pair->left, pair->right };
    if (!run->role)
        return true;
    for (int i = 0; i < 2; i++)
        if (edge[i] != ENC_NONE &&
            is_stamped(run,
                       run->role[wing_of(&run->surface, edge[i])].general))
            return false;
    return !is_stamped(run, run->role[pair->child].general_wing) &&
           !is_stamped(run, run->role[pair->parent].general_wing);
}

/* Before they are contracted. `link`: of a general pair. */
static void stamp_roles(enc_run *run, const enc_pair *pair,
                        const enc_link *link)
{
    const uint32_t sides[2] = { pair->left, pair->right };
    const uint32_t *edge = link ? link->edge : sides;
    const uint32_t count = link ? link->count : 2;
    const uint8_t stamp = (uint8_t)(run->out->batch_count + 1);
    for (uint32_t i = 0; i < count; i++) {
        if (edge[i] == ENC_NONE)
            continue;
        enc_role *wing = &run->role[wing_of(&run->surface, edge[i])];
        wing->wing = stamp;
        if (link)
            wing->general_wing = stamp;
    }
    if (link && link->count > 0)
        run->role[pair->child].general = run->role[pair->parent].general =
            stamp;
}

/* Finds the pairs to be preferred next to this one, before it goes. */
static unsigned find_parallel(const enc_run *run, const enc_pair *pair,
                              double turn, enc_entry out[4])
{
    const enc_surface *s = &run->surface;
    enc_direction found[4];
    unsigned count = 0;

    enc_parallel_pairs(s, pair, found);
    for (int i = 0; i < 4; i++) {
        uint32_t h = found[i].edge;
        bool back = found[i].child_is_end;
        if (h == ENC_NONE)
            continue;
        if (s->twin[h] < h) {
            h = s->twin[h];
            back = !back;
        }
        const enc_pair other = enc_surface_pair(s, h, back);
        const uint8_t state = run->edge_state[h];
        if (!may(state, back) || unclean(state, back) || state & GENERAL ||
            !is_free(run, other.child) || !is_free(run, other.parent))
            continue;
        const enc_offer offer = enc_pricing_estimate(&run->pricing, s, &other);
        if (offer.cost > run->parallel_limit || offer.quadric > run->guard)
            continue;
        double off = 0;
        for (int k = 0; k < 3; k++) {
            const int32_t d =
                s->position[pair->child][k] - s->position[pair->parent][k] -
                s->position[other.child][k] + s->position[other.parent][k];
            off += (double)d * d;
        }
        const double price =
            offer.cost + turn * run->pricing.edge_square * off;
        out[count++] =
            (enc_entry){ enc_key(PARALLEL_FACTOR * price), entry_id(h, back) };
    }
    return count;
}

static void end_face(enc_schedule *out, uint32_t edge, uint32_t index)
{
    if (edge == ENC_NONE)
        return;
    out->face_end[edge / 3] = index;
    if (out->face_side)
        out->face_side[edge / 3] = (uint8_t)(edge % 3);
}

/* `link`: NULL unless the pair is a general one. */
static void contract(enc_run *run, const enc_pair *pair, const enc_link *link,
                     const enc_offer *offer, double error)
{
    enc_schedule *out = run->out;
    enc_surface *s = &run->surface;
    const uint32_t index = out->contraction_count++;
    const int32_t *before = s->position[pair->parent];

    out->contraction[index] = (enc_contraction){
        .child = pair->child,
        .parent = pair->parent,
        .before = { before[0], before[1], before[2] },
    };
    out->vertex_end[pair->child] = index;
    end_face(out, pair->left, index);
    end_face(out, pair->right, index);
    for (uint32_t i = 0; link && i < link->count; i++)
        end_face(out, link->edge[i], index);
    run->drift[pair->parent] = (float)error;
    if (run->segment_size)
        run->segment_size[run->mesh->guide->segment[pair->child]]--;
    run->taken[pair->child] = run->taken[pair->parent] =
        (uint8_t)(out->batch_count + 1);
    if (run->role)
        stamp_roles(run, pair, link);
    if (s->wedge && link)
        enc_wedges_map_link(s, pair, link, out->wedge_parent);
    else if (s->wedge)
        enc_wedges_map(s, pair, out->wedge_parent);
    enc_pricing_contract(&run->pricing, s, pair, offer->place);
    if (link)
        enc_join_contract(s, pair->child, pair->parent, link, offer->place,
                          out->wedge_parent);
    else
        enc_surface_contract(s, pair, offer->place, out->wedge_parent);
}

/* How far the original may be once the pair is one, in steps: what went before
 * is added. Only if there is a limit. */
static double total_error(const enc_run *run, const enc_pair *pair,
                          const enc_offer *offer)
{
    const double child = (double)run->drift[pair->child];
    const double parent = (double)run->drift[pair->parent];

    if (!(run->error_limit < INFINITY))
        return 0;
    return enc_reach_of_pair(&run->surface, pair, offer->place) +
           (child > parent ? child : parent);
}

static void queue_again(enc_run *run, uint32_t h, bool back)
{
    double quadric;
    const enc_entry entry = make_entry(run, h, back, &quadric);
    if (entry.key < UINT32_MAX)
        enc_queue_push(&run->queue, entry);
}

static bool is_too_far(enc_run *run, double error)
{
    const bool far = error > run->error_limit;
    run->too_far |= far;
    return far;
}

/* What it costs now, and whether it may go at that: not if that has grown (then
 * it goes back into the queue) or a face would flip or double (then perhaps the
 * other way, or at the very end). `link`: of a general pair. The pair is
 * expected. */
static bool is_expected_acceptable(enc_run *run, const enc_batch_plan *plan,
                          enc_entry entry, const enc_pair *pair,
                          const enc_link *link, enc_offer *offer)
{
    enc_surface *s = &run->surface;
    const uint32_t h = entry.id >> 1;
    const bool back = entry.id & 1;

    *offer = enc_pricing_offer(&run->pricing, s, pair);
    if (offer->quadric > run->guard || !(offer->cost < INFINITY))
        return false;
    if (!plan->coherent &&
        offer->cost > STALE_FACTOR * enc_key_cost(entry.key)) {
        const uint32_t key = enc_key(offer->cost) | (entry.key & ENC_KEY_LAST);
        if (key > entry.key) {
            enc_queue_push(&run->queue, (enc_entry){ key, entry.id });
            return false;
        }
    }
    const bool doubles = link && link->doubles;
    const bool turns = !run->lets_turn && !doubles &&
                       enc_looks_turn(&run->pricing.looks, s, pair);
    if (!doubles && !turns && !enc_surface_flips(s, pair, offer->place))
        return true;
    if (may(run->edge_state[h], !back) && !(run->edge_state[h] & TURNED)) {
        run->edge_state[h] |= TURNED;
        queue_again(run, h, !back);
    } else if (run->joins_sheets && link) {
        if (run->edge_state[h] & LATE)
            return true;
        run->edge_state[h] |= LATE;
        enc_queue_push(&run->queue, (enc_entry){ entry.key | ENC_KEY_LAST,
                                                 entry.id });
    }
    return false;
}

static bool is_acceptable(enc_run *run, const enc_batch_plan *plan,
                          enc_entry entry, const enc_pair *pair,
                          const enc_link *link, enc_offer *offer)
{
    const enc_looks *looks = &run->pricing.looks;
    enc_looks_expect(looks, &run->surface, pair);
    const bool good =
        is_expected_acceptable(run, plan, entry, pair, link, offer);
    enc_looks_forget(looks, &run->surface, pair);
    return good;
}

static bool try_general(enc_run *run, const enc_batch_plan *plan,
                        enc_entry entry, const enc_pair *pair)
{
    const enc_surface *s = &run->surface;
    enc_link link;
    enc_offer offer;
    if (s->first[pair->child] == ENC_NONE || s->first[pair->parent] == ENC_NONE)
        return false;
    if (!enc_join_link(s, pair->child, pair->parent, &link) || link.held[0])
        return false;
    if (!general_fits(run, pair, &link))
        return false;
    if (!is_acceptable(run, plan, entry, pair, &link, &offer))
        return false;
    const double error = total_error(run, pair, &offer);
    if (is_too_far(run, error))
        return false;
    contract(run, pair, &link, &offer, error);
    return true;
}

/* Contracts the pair of an entry if that is possible now. */
static bool try_entry(enc_run *run, const enc_batch_plan *plan, enc_entry entry)
{
    enc_surface *s = &run->surface;
    const uint32_t h = entry.id >> 1;
    const bool back = entry.id & 1, general = run->edge_state[h] & GENERAL;

    if (h < 3 * run->mesh->face_count && s->vertex[h] == ENC_NONE)
        return false;
    const enc_pair pair = pair_of(run, h, back);
    if (!is_free(run, pair.child) || !is_free(run, pair.parent) ||
        has_to_stay(run, pair.child))
        return false;
    if (general)
        return try_general(run, plan, entry, &pair);
    enc_surface_mark_ring(s, s->vertex[h]);
    if (!enc_surface_can_join(s, h) || !simple_fits(run, &pair))
        return false;

    enc_offer offer;
    if (!is_acceptable(run, plan, entry, &pair, NULL, &offer))
        return false;
    const double error = total_error(run, &pair, &offer);
    if (is_too_far(run, error))
        return false;

    enc_entry parallel[4];
    const unsigned count =
        plan->coherent ? find_parallel(run, &pair, plan->turn, parallel) : 0;
    contract(run, &pair, NULL, &offer, error);
    for (unsigned i = 0; i < count; i++)
        enc_queue_push(&run->queue, parallel[i]);
    return true;
}

uint32_t enc_batch_contract(enc_run *run, const enc_batch_plan *plan)
{
    uint32_t accepted = 0;
    enc_entry entry;

    run->too_far = false;
    enc_pricing_begin(&run->pricing, &run->surface, plan->taste,
                      run->out->contraction_count == 0);
    collect(run, plan);
    while (accepted < plan->limit && !enc_run_done(run) &&
           enc_queue_pop(&run->queue, &entry)) {
        if ((entry.key & ENC_KEY_LAST) && accepted >= CLEAN_SHARE * plan->limit)
            break;
        accepted += try_entry(run, plan, entry);
        report_progress(run);
    }
    return accepted;
}
