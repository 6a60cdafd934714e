/* SPDX-License-Identifier: MIT */
#include "encoder/enc_batch.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_collect.h"
#include "encoder/enc_parallel.h"
#include "encoder/enc_wedges.h"

/* Puts a pair parallel to a chosen one before all that are not. */
#define PARALLEL_FACTOR 0.001

/* An entry whose cost has grown by more than this goes back to the queue. */
#define STALE_FACTOR 1.1

/* Unclean pairs are for meshes that leave no other choice: they come last, and
 * a batch that is full to this share takes none. */
#define CLEAN_SHARE 0.5

bool enc_run_done(const enc_run *run)
{
    return run->cancelled || run->starved ||
           run->surface.face_count <= run->face_target ||
           run->surface.vertex_count <= run->vertex_target;
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
        out[count++] = (enc_entry){ enc_key(PARALLEL_FACTOR * price),
                                    enc_entry_id(h, back) };
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
    if (out->reach->later)
        enc_reach_note(out->reach, index, pair, link, offer->place);
    out->vertex_end[pair->child] = index;
    end_face(out, pair->left, index);
    end_face(out, pair->right, index);
    for (uint32_t i = 0; link && i < link->count; i++)
        end_face(out, link->edge[i], index);
    if (run->drift)
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
    enc_looks_contract(&run->pricing.looks, s, pair->parent);
}

/* How far the original may be once the pair is one, in steps: what went before
 * is added. Only if there is a limit. */
static double total_error(const enc_run *run, const enc_pair *pair,
                          const enc_offer *offer)
{
    if (!run->drift)
        return 0;
    const double child = (double)run->drift[pair->child];
    const double parent = (double)run->drift[pair->parent];
    return enc_reach_of_pair(&run->surface, pair, offer->place) +
           (child > parent ? child : parent);
}

static void queue_again(enc_run *run, uint32_t h, bool back)
{
    double quadric;
    const enc_entry entry = enc_run_entry(run, h, back, &quadric);
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
    const enc_pair pair = enc_run_pair(run, h, back);
    if (!is_free(run, pair.child) || !is_free(run, pair.parent) ||
        enc_run_has_to_stay(run, pair.child))
        return false;
    if (general)
        return try_general(run, plan, entry, &pair);
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

#if defined(__GNUC__)
#define FETCH(address) __builtin_prefetch(address)
#else
#define FETCH(address) ((void)(address))
#endif

/* How many entries ahead the memory of their edges, ends and rings is asked
 * for. Costs visit a large mesh in any order: half the time was waiting. */
enum { EDGE_AHEAD = 32, ENDS_AHEAD = 20, RING_AHEAD = 8 };

static bool is_edge(const enc_run *run, uint32_t ahead, uint32_t *h)
{
    const enc_queue *q = &run->queue;

    if (q->list_count - q->list_next <= ahead)
        return false;
    *h = q->list[q->list_next + ahead].id >> 1;
    return *h < 3 * run->mesh->face_count;
}

static void fetch_ahead(const enc_run *run)
{
    const enc_surface *s = &run->surface;
    uint32_t h;

    if (is_edge(run, EDGE_AHEAD, &h)) {
        FETCH(&run->edge_state[h]);
        FETCH(&s->vertex[h]);
        FETCH(&s->twin[h]);
    }
    if (is_edge(run, ENDS_AHEAD, &h) && s->vertex[h] != ENC_NONE) {
        const uint32_t end[2] = { s->vertex[h], s->vertex[enc_next(h)] };
        for (int k = 0; k < 2; k++) {
            FETCH(&run->taken[end[k]]);
            FETCH(&s->first[end[k]]);
            FETCH(&s->position[end[k]]);
        }
    }
    if (is_edge(run, RING_AHEAD, &h) && s->vertex[h] != ENC_NONE) {
        const uint32_t end[2] = { s->vertex[h], s->vertex[enc_next(h)] };
        for (int k = 0; k < 2; k++) {
            const uint32_t first = s->first[end[k]];
            if (!is_free(run, end[0]) || !is_free(run, end[1]) ||
                first == ENC_NONE)
                continue;
            FETCH(&s->vertex[first]);
            FETCH(&s->twin[first]);
            FETCH(&s->degree[end[k]]);
            FETCH(&run->pricing.unevenness[end[k]]);
        }
    }
}

static uint32_t contract_pairs(enc_run *run, const enc_batch_plan *plan)
{
    uint32_t accepted = 0;
    enc_entry entry;

    while (accepted < plan->limit && !enc_run_done(run) &&
           enc_queue_pop(&run->queue, &entry)) {
        fetch_ahead(run);
        if ((entry.key & ENC_KEY_LAST) && accepted >= CLEAN_SHARE * plan->limit)
            break;
        accepted += try_entry(run, plan, entry);
        enc_run_progress(run, 1);
    }
    return accepted;
}

uint32_t enc_batch_contract(enc_run *run, const enc_batch_plan *plan)
{
    run->too_far = false;
    run->pricing.sign = enc_queue_scratch(
        &run->queue, run->mesh->vertex_count * sizeof(enc_sign));
    enc_pricing_begin(&run->pricing, &run->surface, plan->taste,
                      run->out->contraction_count == 0);
    enc_collect(run, plan->guard);
    return contract_pairs(run, plan);
}
